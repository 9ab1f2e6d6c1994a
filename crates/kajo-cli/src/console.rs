//! Words to the user. A closed pipe or terminal is no reason to stop: such errors are dropped.

use crate::failure::Failure;
use std::fmt::Display;
use std::io::{self, IsTerminal, Write};

/// Writes a line to standard error.
pub fn line(text: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{text}");
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
/// A reader that has gone away, such as `head`, has all it wants: that is no failure.
pub fn answer(text: &str) -> Result<(), Failure> {
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
    if in_color() {
        line(format_args!("\x1b[{style}m{label}\x1b[0m: {text}"));
    } else {
        line(format_args!("{label}: {text}"));
    }
}
