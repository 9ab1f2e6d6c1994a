//! Changing a scene's text and nothing else of it.

use std::fmt::{Display, LowerExp};
use std::ops::Range;

/// Why edits could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// A range that ends before it starts, lies past the end, or cuts a character.
    #[error("the edit of bytes {0:?} does not fit the text")]
    OutOfRange(Range<usize>),
    /// Two ranges share bytes, or two insertions share their place.
    #[error("the edits of bytes {0:?} and {1:?} overlap")]
    Overlap(Range<usize>, Range<usize>),
}

/// Replaces byte ranges of `text`, given in any order; every other byte stays as it is.
///
/// ```
/// use kajo_scene::{SceneDesc, apply_edits};
/// let text = "Sphere { radius 1 }  # a ball";
/// let parsed = SceneDesc::parse_str(text);
/// let radius = parsed.desc.roots().next().unwrap().children().next().unwrap();
/// let (_, span) = radius.numbers().next().unwrap();
/// let edited = apply_edits(text, &[(span.range(), "2.5".to_owned())]).unwrap();
/// assert_eq!(edited, "Sphere { radius 2.5 }  # a ball");
/// ```
///
/// # Errors
/// When a range does not fit the text or two of them overlap.
pub fn apply_edits(text: &str, edits: &[(Range<usize>, String)]) -> Result<String, EditError> {
    let mut sorted: Vec<&(Range<usize>, String)> = edits.iter().collect();
    sorted.sort_by_key(|(range, _)| (range.start, range.end));
    let mut out = String::with_capacity(text.len());
    let mut done = 0;
    for (i, (range, new)) in sorted.iter().enumerate() {
        if let Some((before, _)) = i.checked_sub(1).map(|i| sorted[i])
            && (range.start < before.end || range == before)
        {
            return Err(EditError::Overlap(before.clone(), range.clone()));
        }
        if text.get(range.clone()).is_none() {
            return Err(EditError::OutOfRange(range.clone()));
        }
        out.push_str(&text[done..range.start]);
        out.push_str(new);
        done = range.end;
    }
    out.push_str(&text[done..]);
    Ok(out)
}

/// The fewest digits that read back as the same number, for `f32` as for `f64`;
/// with an exponent below 1e-5 and from 1e7 on.
///
/// ```
/// use kajo_scene::format_number;
/// assert_eq!(format_number(0.1_f32), "0.1");
/// assert_eq!(format_number(1e300_f64), "1e300");
/// ```
pub fn format_number(number: impl Display + LowerExp) -> String {
    let with_exponent = format!("{number:e}");
    let exponent = with_exponent.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    match exponent {
        Some(-5..=6) => number.to_string(),
        _ => with_exponent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn edit(range: Range<usize>, new: &str) -> (Range<usize>, String) {
        (range, new.to_owned())
    }

    #[test]
    fn edits_apply_in_any_order() {
        let edits = [edit(5..6, "Z"), edit(0..0, "<"), edit(2..4, ""), edit(6..6, ">")];
        assert_eq!(apply_edits("abcdef", &edits).unwrap(), "<abeZ>");
        assert_eq!(apply_edits("é", &[]).unwrap(), "é");
    }

    #[test]
    fn edits_that_do_not_fit_are_refused() {
        assert_eq!(apply_edits("é", &[edit(1..2, "")]), Err(EditError::OutOfRange(1..2)));
        assert_eq!(apply_edits("ab", &[edit(1..3, "")]), Err(EditError::OutOfRange(1..3)));
        let backwards = Range { start: 2, end: 1 };
        assert_eq!(apply_edits("ab", &[edit(backwards.clone(), "")]), Err(EditError::OutOfRange(backwards)));
        let overlap = [edit(2..4, ""), edit(0..3, "")];
        assert_eq!(apply_edits("abcdef", &overlap), Err(EditError::Overlap(0..3, 2..4)));
        let twice = [edit(1..1, "a"), edit(1..1, "b")];
        assert_eq!(apply_edits("abc", &twice), Err(EditError::Overlap(1..1, 1..1)));
    }

    #[test]
    fn numbers_are_short() {
        for (number, text) in
            [(1.0, "1"), (-0.0, "-0"), (0.001, "0.001"), (1e6, "1000000"), (1e7, "1e7"), (1.5e-7, "1.5e-7")]
        {
            assert_eq!(format_number(number), text);
        }
    }

    proptest! {
        #[test]
        fn numbers_read_back_the_same(bits in any::<u64>()) {
            let double = f64::from_bits(bits);
            let single = f32::from_bits(bits as u32);
            if double.is_finite() {
                prop_assert_eq!(crate::lexer::number(&format_number(double)).map(f64::to_bits), Some(double.to_bits()));
            }
            if single.is_finite() {
                let read: f32 = format_number(single).parse().unwrap();
                prop_assert_eq!(read.to_bits(), single.to_bits());
            }
        }
    }
}
