//! Options of scenes that change with time: which frames, and how they are named.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::Args;
use kajo::LAST_FRAME;

use super::values;
use crate::failure::Failure;

/// The most frames of one command.
const MOST_FRAMES: u64 = 1_000_000;

/// Which frames of a scene that changes with time.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Frames")]
pub struct FrameArgs {
    /// Frames of a scene that changes with time: 12, 1..240, 1..240:10 for every tenth, several after commas, or all.
    /// `####` in the names of files becomes the number
    #[arg(long, value_name = "FRAMES")]
    pub frames: Option<Frames>,
    /// Frames of a second, in place of what the scene says
    #[arg(long, value_name = "RATE", value_parser = values::positive)]
    pub fps: Option<f64>,
    /// Keep the pictures of frames that are there already, and render the others
    #[arg(long, requires = "frames")]
    pub keep_frames: bool,
}

/// Some frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Frames {
    /// All that the scene says it has.
    All,
    /// These, in order and each once.
    List(Vec<i64>),
}

impl Frames {
    /// The frame, if it is one and known.
    pub fn single(&self) -> Option<i64> {
        match self {
            Frames::List(list) => list.first().copied().filter(|_| list.len() == 1),
            Frames::All => None,
        }
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Frames, String> {
        if text == "all" {
            return Ok(Frames::All);
        }
        let mut list = Vec::new();
        for part in text.split(',') {
            let (range, step) = match part.split_once(':') {
                Some((range, step)) => {
                    (range, step.parse().ok().filter(|&step: &usize| step > 0).ok_or_else(usage)?)
                }
                None => (part, 1),
            };
            let (first, last) = match range.split_once("..") {
                Some((first, last)) => (number(first)?, number(last)?),
                None => (number(range)?, number(range)?),
            };
            list.extend(self::range([first, last], step)?);
            if list.len() as u64 > MOST_FRAMES {
                return Err(too_many());
            }
        }
        list.sort_unstable();
        list.dedup();
        Ok(Frames::List(list))
    }
}

/// Every `step`-th of the frames from the first to the last.
///
/// # Errors
/// When the last comes before the first, or they are too many.
pub fn range([first, last]: [i64; 2], step: usize) -> Result<impl Iterator<Item = i64>, String> {
    if last < first {
        return Err(format!("the last frame of `{first}..{last}` comes before the first one"));
    }
    if last.abs_diff(first) / step as u64 >= MOST_FRAMES {
        return Err(too_many());
    }
    Ok((first..=last).step_by(step))
}

fn too_many() -> String {
    format!("there are at most {MOST_FRAMES} frames for one command")
}

fn number(text: &str) -> Result<i64, String> {
    let digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|n| digits && *n <= LAST_FRAME).ok_or_else(usage)
}

fn usage() -> String {
    format!("expected frames such as 12, 1..240, 1..240:10 or 5,10..20, numbered from 0 to {LAST_FRAME}")
}

/// The name of a frame's file: the run of `#` in it becomes the number, with zeros before it.
///
/// # Errors
/// When there are several runs of `#` in the name.
pub fn numbered(path: &Path, frame: i64) -> Result<PathBuf, Failure> {
    let Some((before, width, after)) = pattern(path)? else { return Ok(path.to_owned()) };
    let mut name = OsString::from(before);
    name.push(format!("{frame:0width$}"));
    name.push(after);
    Ok(path.with_file_name(name))
}

/// Whether a name has a place for the number of a frame.
///
/// # Errors
/// As for [`numbered`].
pub fn has_number(path: &Path) -> Result<bool, Failure> {
    Ok(pattern(path)?.is_some())
}

/// What stands before a run of `#`, how long it is, and what follows.
fn pattern(path: &Path) -> Result<Option<(&str, usize, &str)>, Failure> {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(None) };
    let Some(start) = name.find('#') else { return Ok(None) };
    let width = name[start..].bytes().take_while(|&byte| byte == b'#').count();
    let (before, after) = (&name[..start], &name[start + width..]);
    if after.contains('#') {
        return Err(Failure::Input(format!(
            "`{}` has two places for the number of a frame; one run of `#` is enough",
            path.display()
        )));
    }
    Ok(Some((before, width, after)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> Vec<i64> {
        match text.parse() {
            Ok(Frames::List(list)) => list,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn frames_are_lists_of_ranges() {
        assert_eq!(list("7"), [7]);
        assert_eq!(list("3..6"), [3, 4, 5, 6]);
        assert_eq!(list("1..10:4"), [1, 5, 9]);
        assert_eq!(list("5,10..12,1..3:2,5"), [1, 3, 5, 10, 11, 12]);
        assert_eq!("all".parse(), Ok(Frames::All));
        assert_eq!("0".parse::<Frames>().unwrap().single(), Some(0));
        assert_eq!("0..1".parse::<Frames>().unwrap().single(), None);
    }

    #[test]
    fn what_is_no_list_is_refused() {
        for text in [
            "",
            "9..3",
            "1..",
            "..3",
            "-1",
            "+1",
            "1..3:0",
            "1..3:",
            "1.5",
            "1,,2",
            "2000000000",
            "0..1000000",
        ] {
            assert!(text.parse::<Frames>().is_err(), "{text}");
        }
        assert!("9..3".parse::<Frames>().unwrap_err().contains("comes before"));
    }

    #[test]
    fn numbers_are_put_into_names() {
        let name = |pattern: &str, frame| numbered(Path::new(pattern), frame).unwrap();
        assert_eq!(name("a/out.####.png", 7), Path::new("a/out.0007.png"));
        assert_eq!(name("##.exr", 123), Path::new("123.exr"));
        assert_eq!(name("a#b/out.png", 7), Path::new("a#b/out.png"));
        assert!(numbered(Path::new("#.#.png"), 1).is_err());
        assert!(has_number(Path::new("#")).unwrap() && !has_number(Path::new("a#/b")).unwrap());
    }
}
