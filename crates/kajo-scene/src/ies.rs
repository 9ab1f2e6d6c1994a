//! IES files: how strongly a luminaire shines into which direction, as laboratories measure it [ANSI/IES LM-63-19].
//!
//! ```text
//! IESNA:LM-63-2002
//! [LUMCAT] any lines of keywords
//! TILT=NONE
//! lamps  lumens per lamp  multiplier  vertical angles  horizontal angles  type  unit  width  length  height
//! ballast factor  ballast-lamp factor  watts
//! vertical angles ...
//! horizontal angles ...
//! candela ..., for each horizontal angle all vertical ones
//! ```
//!
//! The editions of 1986, 1991, 1995, 2002 and 2019 are read. Of the three systems of angles only type C is, which
//! nearly all files use: vertical angles count from straight down, horizontal ones around the vertical axis,
//! counterclockwise seen from above. What a tilted lamp loses (`TILT`) is for a simulation of that lamp and is left out.

use std::str::{FromStr, SplitAsciiWhitespace};

/// More angles than this of either kind are refused.
const MOST_ANGLES: usize = 4096;

/// The intensities of a luminaire of type C.
#[derive(Clone, Debug, PartialEq)]
pub struct IesFile {
    /// Degrees from straight down, increasing, in [0, 180]. At least one.
    pub vertical_deg: Vec<f32>,
    /// Degrees around the vertical axis, increasing, in [0, 360]. One for a luminaire that looks alike from all
    /// sides. Else either from 0 to 90 or to 180, or from 90 to 270, the rest being mirrored; or from 0 to more
    /// than 180.
    pub horizontal_deg: Vec<f32>,
    /// Intensities in candela, all factors of the file included, not negative: the vertical angles of the first
    /// horizontal one, then of the next.
    pub candela: Vec<f32>,
    /// What all lamps give without the luminaire; `None` where the file is about the luminaire as a whole.
    pub lamp_lumens: Option<f32>,
    /// Electrical power.
    pub watts: f32,
}

/// Why bytes are not an IES file that can be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct IesError {
    /// Counted from 1.
    pub line: usize,
    /// What was found and what was expected.
    pub message: String,
}

/// Reads an IES file.
///
/// ```
/// let text = "TILT=NONE\n1 -1 1  2 1  1 2  0 0 0\n1 1 60\n0 90\n0\n800 0\n";
/// let file = kajo_scene::read_ies(text.as_bytes()).unwrap();
/// assert_eq!(file.candela, [800.0, 0.0]);
/// ```
///
/// # Errors
/// At the first thing that is not as the standard has it, that is not of type C, or that is too large.
pub fn read_ies(bytes: &[u8]) -> Result<IesFile, IesError> {
    // Names of manufacturers are written in many encodings, and are of no use here.
    let text = String::from_utf8_lossy(bytes);
    let (tilt, factor_is_real) = tilt(&text)?;
    let mut numbers = Numbers::after(&text, tilt);
    if text.lines().nth(tilt - 1).is_some_and(|line| line.trim().eq_ignore_ascii_case("TILT=INCLUDE")) {
        numbers.skip_tilt()?;
    }
    let n_lamps: f32 = numbers.next("the number of lamps")?;
    let per_lamp: f32 = numbers.next("lumens per lamp")?;
    let multiplier: f32 = numbers.next("the candela multiplier")?;
    let n_vertical = numbers.count("the number of vertical angles")?;
    let n_horizontal = numbers.count("the number of horizontal angles")?;
    numbers.check_type()?;
    for what in ["the unit of lengths", "the width", "the length", "the height"] {
        numbers.next::<f32>(what)?;
    }
    let ballast: f32 = numbers.next("the ballast factor")?;
    let ballast_lamp: f32 = numbers.next("the ballast-lamp factor")?;
    let watts = numbers.next("the input watts")?;
    let vertical_deg = numbers.angles("vertical", n_vertical, 180.0)?;
    let horizontal_deg = numbers.angles("horizontal", n_horizontal, 360.0)?;
    numbers.check_symmetry(&horizontal_deg)?;
    let factor = multiplier * ballast * if factor_is_real { ballast_lamp } else { 1.0 };
    let candela = (0..n_vertical * n_horizontal).map(|_| numbers.candela(factor));
    let candela = candela.collect::<Result<Vec<f32>, IesError>>()?;
    let lamp_lumens = (per_lamp >= 0.0).then_some(n_lamps * per_lamp);
    Ok(IesFile { vertical_deg, horizontal_deg, candela, lamp_lumens, watts })
}

/// The number of the line that begins with `TILT=`, and whether the edition has a ballast-lamp factor: since 2019
/// a code stands in its place.
fn tilt(text: &str) -> Result<(usize, bool), IesError> {
    let is_tilt =
        |line: &str| line.trim_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case("TILT="));
    let found = text.lines().position(is_tilt);
    let first = text.lines().next().unwrap_or_default();
    found.map(|i| (i + 1, !first.contains("LM-63-2019"))).ok_or_else(|| IesError {
        line: text.lines().count().max(1),
        message: "there is no line that begins with `TILT=`, so that this is no IES file".to_owned(),
    })
}

/// The numbers of a file, between blanks or commas.
struct Numbers<'t> {
    lines: std::iter::Enumerate<std::str::Lines<'t>>,
    words: SplitAsciiWhitespace<'t>,
    /// The rest of a word with commas.
    rest: &'t str,
    /// Of the word read last.
    line: usize,
}

impl<'t> Numbers<'t> {
    /// The numbers from the line behind number `line` on.
    fn after(text: &'t str, line: usize) -> Numbers<'t> {
        let mut lines = text.lines().enumerate();
        lines.by_ref().take(line).for_each(drop);
        Numbers { lines, words: "".split_ascii_whitespace(), rest: "", line }
    }

    fn word(&mut self) -> Option<&'t str> {
        loop {
            self.rest = self.rest.trim_start_matches(',');
            if !self.rest.is_empty() {
                let end = self.rest.find(',').unwrap_or(self.rest.len());
                let (word, rest) = self.rest.split_at(end);
                self.rest = rest;
                return Some(word);
            }
            match self.words.next() {
                Some(word) => self.rest = word,
                None => {
                    let (i, line) = self.lines.next()?;
                    (self.line, self.words) = (i + 1, line.split_ascii_whitespace());
                }
            }
        }
    }

    fn error(&self, message: impl Into<String>) -> IesError {
        IesError { line: self.line, message: message.into() }
    }

    /// The next number, which is finite.
    fn next<T: FromStr + Into<f64> + Copy>(&mut self, what: &str) -> Result<T, IesError> {
        let Some(word) = self.word() else {
            return Err(self.error(format!("the file ends where {what} should be")));
        };
        let number = word.parse().ok().filter(|&number: &T| number.into().is_finite());
        number.ok_or_else(|| {
            let found: String = word.chars().take(40).collect();
            self.error(format!("expected {what}, found `{found}`"))
        })
    }

    fn count(&mut self, what: &str) -> Result<usize, IesError> {
        let n: f64 = self.next(what)?;
        if n.fract() != 0.0 || !(1.0..=MOST_ANGLES as f64).contains(&n) {
            return Err(self.error(format!("{what} is {n}, not between 1 and {MOST_ANGLES}")));
        }
        Ok(n as usize)
    }

    fn check_type(&mut self) -> Result<(), IesError> {
        let system: f32 = self.next("the photometric type")?;
        let name = match system {
            1.0 => return Ok(()),
            2.0 => "B",
            3.0 => "A",
            _ => return Err(self.error(format!("the photometric type is {system}, not 1, 2 or 3"))),
        };
        Err(self.error(format!("the angles are of type {name}, and only type C is supported")))
    }

    /// Increasing angles from 0 to `most` degrees.
    fn angles(&mut self, kind: &str, n: usize, most: f32) -> Result<Vec<f32>, IesError> {
        let mut angles: Vec<f32> = Vec::new();
        for _ in 0..n {
            let angle = self.next(&format!("a {kind} angle"))?;
            if !(0.0..=most).contains(&angle) {
                return Err(
                    self.error(format!("the {kind} angle {angle} is not between 0 and {most} degrees"))
                );
            }
            if angles.last().is_some_and(|&last| angle <= last) {
                return Err(self.error(format!("the {kind} angle {angle} is not larger than the one before")));
            }
            angles.push(angle);
        }
        Ok(angles)
    }

    /// Whether the other horizontal angles follow from these.
    fn check_symmetry(&self, horizontal: &[f32]) -> Result<(), IesError> {
        let ends = [horizontal[0], horizontal[horizontal.len() - 1]];
        match ends {
            _ if horizontal.len() == 1 => Ok(()),
            [0.0, last] if last == 90.0 || last >= 180.0 => Ok(()),
            [90.0, 270.0] => Ok(()),
            [first, last] => {
                let known = "from 0 to 90, 180 or 360 degrees, or from 90 to 270";
                Err(self.error(format!("horizontal angles go {known}, not from {first} to {last}")))
            }
        }
    }

    fn candela(&mut self, factor: f32) -> Result<f32, IesError> {
        let value = factor * self.next::<f32>("an intensity")?;
        if !(value >= 0.0 && value.is_finite()) {
            return Err(self.error(format!("an intensity of {value} candela cannot be")));
        }
        Ok(value)
    }

    /// Passes over the table of a tilted lamp.
    fn skip_tilt(&mut self) -> Result<(), IesError> {
        self.next::<f32>("the geometry of the lamp")?;
        let n = self.count("the number of tilt angles")?;
        for _ in 0..2 * n {
            self.next::<f32>("a tilt angle or its factor")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A street lamp of two lamps of 1,000 lm, mirrored at both planes.
    const STREET: &str = "IESNA91\n[TEST] 123\n[MORE] Leuchte \u{fc}ber\nTILT=NONE\n2 1000 2.5 3 2 1 2 0 0 0\n\
        0.9 0.5 120\n0 45 90\n0,90\n100 80 0\n40 20\n0\n";

    fn error(text: &str) -> String {
        read_ies(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn a_file_is_read_with_its_factors() {
        let file = read_ies(STREET.as_bytes()).unwrap();
        assert_eq!((&*file.vertical_deg, &*file.horizontal_deg), (&[0.0, 45.0, 90.0][..], &[0.0, 90.0][..]));
        for (found, expected) in file.candela.iter().zip([112.5, 90.0, 0.0, 45.0, 22.5, 0.0]) {
            assert!((found - expected).abs() < 1e-4, "{:?}", file.candela);
        }
        assert_eq!((file.lamp_lumens, file.watts), (Some(2000.0), 120.0));
    }

    #[test]
    fn editions_differ_in_their_head() {
        let tail = &STREET[STREET.find("2 1000").unwrap()..];
        let expected = read_ies(STREET.as_bytes()).unwrap();
        for head in ["", "IESNA:LM-63-1995\n", "IESNA:LM-63-2002\r\n[MANUFAC] \\#\r\n"] {
            let read = read_ies(format!("{head}TILT=NONE\n{tail}").as_bytes()).unwrap();
            assert_eq!(read, expected, "{head}");
        }
        let tilted = format!("IESNA91\n Tilt=INCLUDE\n1 3\n0 45 90\n1 0.9 0.8\n{tail}");
        assert_eq!(read_ies(tilted.as_bytes()).unwrap(), expected);
        // Since 2019 the second factor is the code of how the file was made.
        let new = read_ies(format!("IES:LM-63-2019\nTILT=NONE\n{tail}").as_bytes()).unwrap();
        assert!((new.candela[0] - 225.0).abs() < 1e-4);
        let latin1: Vec<u8> = STREET.chars().map(|c| c as u8).collect();
        assert_eq!(read_ies(&latin1).unwrap(), expected);
    }

    #[test]
    fn mistakes_have_their_line() {
        let changed = |from: &str, to: &str| error(&STREET.replacen(from, to, 1));
        assert!(
            error("IESNA91\nSphere {}\n").starts_with("line 2: there is no line that begins with `TILT=`")
        );
        assert_eq!(
            error(""),
            "line 1: there is no line that begins with `TILT=`, so that this is no IES file"
        );
        assert_eq!(changed("1000", "many"), "line 5: expected lumens per lamp, found `many`");
        assert_eq!(changed("1000", "inf"), "line 5: expected lumens per lamp, found `inf`");
        assert!(changed("3 2 1 2", "3 2 2 2").contains("type B, and only type C"));
        assert!(changed("3 2 1 2", "3 2 3 2").contains("type A, and only type C"));
        assert!(changed("3 2 1 2", "3 2 7 2").contains("not 1, 2 or 3"));
        assert!(changed("3 2 1 2", "99999999 2 1 2").contains("not between 1 and 4096"));
        assert!(changed("3 2 1 2", "2.5 2 1 2").contains("not between 1 and 4096"));
        assert_eq!(
            changed("0 45 90", "0 95 90"),
            "line 7: the vertical angle 90 is not larger than the one before"
        );
        assert!(changed("0 45 90", "0 45 190").contains("is not between 0 and 180 degrees"));
        assert!(changed("0,90", "0,80").contains("not from 0 to 80"));
        assert_eq!(changed("40 20", "40 -20"), "line 10: an intensity of -22.5 candela cannot be");
        assert_eq!(changed("40 20\n0", "40"), "line 10: the file ends where an intensity should be");
    }

    proptest! {
        #[test]
        fn any_bytes_end_in_a_file_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = read_ies(&bytes);
            let _ = read_ies(&[b"TILT=NONE\n", &*bytes].concat());
        }

        #[test]
        fn files_with_changed_words_end_in_a_good_file_or_an_error(
            at in 0..24usize, word in "(-?[0-9]{1,9}(\\.[0-9])?|nan|1e39|x|)"
        ) {
            let head = STREET.find("2 1000").unwrap();
            let words: Vec<&str> = STREET[head..].split([' ', '\n', ',']).collect();
            let changed = |(i, old)| if i == at { word.as_str() } else { old };
            let words: Vec<&str> = words.into_iter().enumerate().map(changed).collect();
            if let Ok(file) = read_ies(format!("{}{}", &STREET[..head], words.join(" ")).as_bytes()) {
                prop_assert_eq!(file.candela.len(), file.vertical_deg.len() * file.horizontal_deg.len());
                prop_assert!(file.candela.iter().all(|v| *v >= 0.0 && v.is_finite()));
                let increasing = |angles: &[f32]| angles.is_sorted_by(|a, b| a < b);
                prop_assert!(increasing(&file.vertical_deg) && increasing(&file.horizontal_deg));
            }
        }
    }
}
