//! Words to the user. A closed pipe or terminal is no reason to stop: such errors are dropped.
//!
//! Words may quote a file, and a file may hold what a terminal obeys. So control characters are shown as symbols.

use crate::failure::Failure;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};

/// Writes lines to standard error.
pub fn line(text: impl Display) {
    report(&printable(&text.to_string()));
}

/// Writes lines to standard error that are fit for a terminal already, and may be in colour.
pub fn report(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", text.trim_end());
}

/// The text with symbols for control characters other than the ends of lines.
pub fn printable(text: &str) -> String {
    text.split('\n').map(kajo::printable).collect::<Vec<_>>().join("\n")
}

/// Writes an error to standard error.
pub fn error(text: &str) {
    labelled("error", "1;31", text);
}

/// Writes a warning to standard error.
pub fn warning(text: &str) {
    labelled("warning", "1;33", text);
}

/// Writes an answer to standard output.
///
/// # Errors
/// As [`data`].
pub fn answer(text: &str) -> Result<(), Failure> {
    data(&printable(text))
}

/// Writes an answer for programs to standard output, as it is.
///
/// # Errors
/// When it cannot be written. A reader that has gone away, such as `head`, has all it wants: that is no failure.
pub fn data(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Output(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Whether messages may be in colour: on a terminal, unless the user objects (no-color.org).
pub fn in_color() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

fn labelled(label: &str, style: &str, text: &str) {
    let text = printable(text);
    if in_color() {
        report(&format!("\x1b[{style}m{label}\x1b[0m: {text}"));
    } else {
        report(&format!("{label}: {text}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_terminals_obey_is_shown() {
        let text = printable("a\u{1b}[2J\r\n\tb\u{7}\u{9b}31m\u{202e}");
        assert!(text.chars().all(|c| c == '\n' || !c.is_control()), "{text:?}");
        assert!(!text.contains('\u{202e}') && text.starts_with("a␛[2J"), "{text:?}");
        assert_eq!(text.lines().count(), 2);
        assert_eq!(printable("two\nlines\n"), "two\nlines\n");
    }
}
