//! Pictures of which there is one for each frame.
//!
//! ```text
//! color "waves.####.png"
//! color "flag.###.png" { frames 1 48  cycle on  frameOffset 12 }
//! ```
//!
//! A run of `#` in a name is the number of the frame, with zeros before it where it has fewer digits.

use kajo_scene::{Clock, Diagnostic, Params};

use super::picture_keys::SequenceKeys;
use super::{Keys, Sources};

/// Which files of a sequence there are, and which of them is shown when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PictureSequence {
    /// The first and the last that there are; before and after these they are shown.
    frames: Option<[i64; 2]>,
    /// What is shown is so many frames ahead.
    offset: i64,
    /// Whether it begins again after the last one.
    cycles: bool,
}

/// What stands around the run of `#` in a name, and how long it is; `None` where there is no such run.
fn parts(name: &str) -> Option<(&str, usize, &str)> {
    let start = name.find('#')?;
    let width = name[start..].bytes().take_while(|&byte| byte == b'#').count();
    Some((&name[..start], width, &name[start + width..]))
}

impl PictureSequence {
    /// Reads the keys of a sequence from the block of a picture.
    ///
    /// * `name`: of the picture; where it has no number they are of no use, which is said
    pub fn read(
        name: Option<&str>,
        params: &mut Params<'_, '_>,
        sources: &mut Sources<'_>,
    ) -> Option<PictureSequence> {
        if name.is_some_and(|name| parts(name).is_none()) {
            let keys: Vec<&str> = SequenceKeys::FIELDS.iter().map(|field| field.key).collect();
            params.idle(&keys, "where the name has no `####` for the number of a frame");
        }
        let SequenceKeys { frames, frame_offset, cycle } = SequenceKeys::read(params, sources)?;
        if cycle && frames.is_none() {
            params.refuse("cycle", "without `frames`, which say where it begins again");
        }
        let frames = frames.map(|frames| frames.0);
        Some(PictureSequence { frames, offset: frame_offset.into(), cycles: cycle })
    }

    /// The name of the file at a moment.
    ///
    /// # Errors
    /// Where a name has more than one run of `#`.
    pub fn name_at(&self, name: &str, clock: &Clock) -> Result<String, Diagnostic> {
        let Some((before, width, after)) = parts(name) else { return Ok(name.to_owned()) };
        if after.contains('#') {
            let message = format!("`{name}` has two places for the number of a frame");
            return Err(Diagnostic::error(message).help("one run of `#` is enough"));
        }
        let frame = clock.frame() + self.offset;
        let frame = match self.frames {
            None => frame,
            Some([first, last]) if self.cycles => first + (frame - first).rem_euclid(last - first + 1),
            Some([first, last]) => frame.clamp(first, last),
        };
        Ok(format!("{before}{frame:0width$}{after}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(sequence: PictureSequence, name: &str, frame: i64) -> String {
        sequence.name_at(name, &Clock::new(24.0, 1, frame)).unwrap()
    }

    #[test]
    fn the_run_is_the_number_of_the_frame() {
        let usual = PictureSequence::default();
        assert_eq!(named(usual, "a.####.png", 7), "a.0007.png");
        assert_eq!(named(usual, "in/a#.png", 123), "in/a123.png");
        assert_eq!(named(usual, "a.##.png", -3), "a.-3.png");
        assert_eq!(named(usual, "a.png", 7), "a.png");
        assert!(usual.name_at("a#b#.png", &Clock::default()).is_err());
    }

    #[test]
    fn beyond_its_frames_a_sequence_stands_still_or_begins_again() {
        let held = PictureSequence { frames: Some([3, 6]), ..PictureSequence::default() };
        let cycled = PictureSequence { cycles: true, ..held };
        let ahead = PictureSequence { offset: 10, ..cycled };
        for (frame, [a, b, c]) in
            [(1, [3, 5, 3]), (3, [3, 3, 5]), (6, [6, 6, 4]), (7, [6, 3, 5]), (-100, [3, 4, 6])]
        {
            for (sequence, expected) in [(held, a), (cycled, b), (ahead, c)] {
                assert_eq!(named(sequence, "#", frame), expected.to_string(), "{sequence:?} {frame}");
            }
        }
    }
}
