//! From the words a user may write to those that `clap` reads.
//!
//! * `SCENE ...` becomes `render SCENE ...`, and a line with `-input` becomes `classic ...`
//! * `-word` becomes `--word` where that is an option of the command; any other such word is an error here, since
//!   `clap` would take it for a row of one-letter options
//! * options may be written with `-` or `_` between their words
//! * values of two words become one: `--size 800 600`, `--samples jittered 16`, `--filter tent 1`

use std::ffi::{OsStr, OsString};

use clap::Command;
use clap::error::ErrorKind;
use kajo::nearest;

/// Rewrites a whole command line, the program's name first.
///
/// * `tree`: the commands, built
///
/// # Errors
/// When a word looks like an option and is none.
pub fn normalise(line: Vec<OsString>, tree: &Command) -> Result<Vec<OsString>, clap::Error> {
    let mut words = line.into_iter();
    let mut result: Vec<OsString> = words.next().into_iter().collect();
    let mut words: Vec<OsString> = words.collect();
    let Some(first) = words.first() else { return Ok(result) };
    // A scene's name may be any bytes, but no command's is.
    let first = first.to_str().unwrap_or_default().to_owned();
    if ["-h", "-help", "--help", "-V", "-version", "--version", "help"].contains(&first.as_str()) {
        result.push(
            if first.len() > 2 && first.starts_with('-') { with_two_dashes(&first) } else { first }.into(),
        );
        result.extend(words.drain(1..));
        return Ok(result);
    }
    let command = if tree.find_subcommand(&first).is_some() {
        words.remove(0);
        first
    } else {
        if words.iter().any(is_input) { "classic" } else { "render" }.to_owned()
    };
    let options = tree.find_subcommand(&command).map(Options::of).unwrap_or_default();
    result.push(command.into());
    options.rewrite(words, tree, &mut result)?;
    Ok(result)
}

fn with_two_dashes(word: &str) -> String {
    format!("--{}", word.trim_start_matches('-'))
}

fn is_input(word: &OsString) -> bool {
    let name = word.to_str().and_then(|word| word.split('=').next());
    matches!(name, Some("-input" | "--input"))
}

/// The long options of a command and of those within it.
#[derive(Default)]
struct Options {
    command: String,
    names: Vec<String>,
}

impl Options {
    fn of(command: &Command) -> Options {
        let nested = command.get_subcommands().flat_map(Command::get_arguments);
        let longs = command
            .get_arguments()
            .chain(nested)
            .filter_map(|arg| arg.get_long_and_visible_aliases())
            .flatten();
        Options { command: command.get_name().to_owned(), names: longs.map(str::to_owned).collect() }
    }

    fn rewrite(
        &self,
        words: Vec<OsString>,
        tree: &Command,
        result: &mut Vec<OsString>,
    ) -> Result<(), clap::Error> {
        let mut words = words.into_iter().peekable();
        while let Some(word) = words.next() {
            if word == "--" {
                result.push(word);
                break;
            }
            let Some(name) = option_name(&word) else {
                result.push(with_leading_zero(word));
                continue;
            };
            let known = self.known(name).ok_or_else(|| self.unknown(&word, name, tree))?;
            let value = word.to_str().and_then(|word| word.split_once('=')).map(|(_, value)| value);
            let text = |next: Option<&OsString>| next.and_then(|next| next.to_str()).map(str::to_owned);
            if let Some(value) = value {
                result.push(format!("--{known}={value}").into());
            } else if let Some(joined) = text(words.peek()).and_then(|next| first_half(known, &next)) {
                words.next();
                let second = text(words.peek()).filter(|second| is_number(second));
                words.next_if(|_| second.is_some());
                result.push(format!("--{known}={}", joined(second.as_deref())).into());
            } else {
                result.push(format!("--{known}").into());
            }
        }
        result.extend(words);
        Ok(())
    }

    /// The option's declared name; `-` and `_` count as the same.
    fn known(&self, name: &str) -> Option<&str> {
        let plain = |name: &str| name.replace('-', "_");
        self.names.iter().find(|known| plain(known) == plain(name)).map(String::as_str)
    }

    fn unknown(&self, word: &OsStr, name: &str, tree: &Command) -> clap::Error {
        let word = word.to_string_lossy();
        let dashes = if word.starts_with("--") { "--" } else { "-" };
        let similar = nearest(name, self.names.iter().map(String::as_str));
        let advice = match similar {
            Some(similar) => format!("did you mean `{dashes}{similar}`?"),
            None => format!("`kajo {} --help` lists what there is", self.command),
        };
        let message = format!("there is no option `{dashes}{name}`; {advice}\n");
        clap::Error::raw(ErrorKind::UnknownArgument, message).with_cmd(tree)
    }
}

/// The name in `-name`, `--name` or `--name=value`; `None` for single letters, numbers and everything else.
fn option_name(word: &OsStr) -> Option<&str> {
    // What follows `=` may be any bytes, but then clap knows what to do with it.
    let word = word.to_str()?;
    let name = word.strip_prefix("--").or_else(|| word.strip_prefix('-'))?;
    let name = name.split('=').next().unwrap_or(name);
    let is_name = name.len() > 1 && name.starts_with(|c: char| c.is_ascii_alphabetic());
    (is_name && !is_number(word)).then_some(name)
}

/// `-.5` as `-0.5`, which `clap` takes for a number too.
fn with_leading_zero(word: OsString) -> OsString {
    match word.to_str().and_then(|word| word.strip_prefix("-.")) {
        Some(digits) if is_number(&format!(".{digits}")) => format!("-0.{digits}").into(),
        _ => word,
    }
}

/// Joins the first word of a value of two with the second, if there is one.
type Join = Box<dyn Fn(Option<&str>) -> String>;

/// How a value that starts with `first` goes on, for options whose value may be two words.
fn first_half(option: &str, first: &str) -> Option<Join> {
    let separator = match option {
        "size" if is_number(first) => 'x',
        "samples" | "filter" if !is_number(first) && !first.starts_with('-') => ':',
        _ => return None,
    };
    let first = first.to_owned();
    Some(Box::new(move |second| match second {
        Some(second) => format!("{first}{separator}{second}"),
        None => first.clone(),
    }))
}

fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Cli;

    fn normal(line: &str) -> String {
        let words = format!("kajo {line}").split(' ').map(OsString::from).collect();
        let words = normalise(words, &Cli::tree()).unwrap();
        words[1..].join(OsStr::new(" ")).into_string().unwrap()
    }

    fn complaint(line: &str) -> String {
        let words = format!("kajo {line}").split(' ').map(OsString::from).collect();
        normalise(words, &Cli::tree()).unwrap_err().to_string()
    }

    #[test]
    fn a_bare_scene_is_rendered() {
        assert_eq!(normal("a.txt"), "render a.txt");
        assert_eq!(normal("a.txt -o b.png"), "render a.txt -o b.png");
        assert_eq!(normal("--quiet a.txt"), "render --quiet a.txt");
        assert_eq!(normal("render a.txt"), "render a.txt");
        assert_eq!(normal("./check"), "render ./check");
        assert_eq!(normal("check a.txt"), "check a.txt");
    }

    #[test]
    fn single_dashes_are_understood() {
        assert_eq!(
            normal("-input a.txt -size 200 100 -depth -5 10 d.png -regular_samples 9"),
            "classic --input a.txt --size=200x100 --depth -5 10 d.png --regular_samples 9"
        );
        assert_eq!(normal("-size 10 10 -input a.txt"), "classic --size=10x10 --input a.txt");
        assert_eq!(
            normal("-input a.txt -depth -.5 -1e1 d.png"),
            "classic --input a.txt --depth -0.5 -1e1 d.png"
        );
        assert_eq!(normal("a.txt -shade-back on"), "render a.txt --shade-back on");
        assert_eq!(normal("a.txt --shade_back=on"), "render a.txt --shade-back=on");
        assert_eq!(normal("-input a.txt -show_progress"), "classic --input a.txt --show-progress");
    }

    #[test]
    fn values_of_two_words_are_joined() {
        assert_eq!(normal("--size 800 600 a.txt"), "render --size=800x600 a.txt");
        assert_eq!(normal("--size 800x600 a.txt"), "render --size 800x600 a.txt");
        assert_eq!(normal("--size 800 a.txt"), "render --size=800 a.txt");
        assert_eq!(normal("a.txt --samples jittered 16"), "render a.txt --samples=jittered:16");
        assert_eq!(normal("--samples 16 a.txt"), "render --samples 16 a.txt");
        assert_eq!(normal("--filter tent 1.5 a.txt"), "render --filter=tent:1.5 a.txt");
        assert_eq!(normal("--filter tent a.txt"), "render --filter=tent a.txt");
    }

    #[test]
    fn help_and_version_are_left_to_clap() {
        assert_eq!(normal("-help"), "--help");
        assert_eq!(normal("--version"), "--version");
        assert_eq!(normal("-h"), "-h");
        assert_eq!(normal("help render"), "help render");
        assert_eq!(normal("render --help"), "render --help");
    }

    #[test]
    fn commands_within_commands_keep_their_options() {
        assert_eq!(normal("bench rays sphere -threads 2 --json"), "bench rays sphere --threads 2 --json");
        assert!(complaint("bench rays sphere --thread 2").contains("did you mean `--threads`?"));
    }

    #[test]
    fn unknown_options_name_their_neighbour() {
        assert!(complaint("-inptu a.txt").contains("there is no option `-inptu`"));
        assert!(complaint("-input a.txt -shadow").contains("did you mean `-shadows`?"));
        assert!(complaint("-input a.txt -ouput b.png").contains("did you mean `-output`?"));
        assert!(complaint("a.txt --bounce 4").contains("did you mean `--bounces`?"));
        assert!(complaint("a.txt -qqqqqqqqqqqq").contains("`kajo render --help`"));
        assert!(complaint("unit --quiet").contains("`kajo unit --help`"));
    }

    #[test]
    fn after_two_dashes_nothing_is_touched() {
        assert_eq!(normal("render -- -input"), "render -- -input");
    }
}
