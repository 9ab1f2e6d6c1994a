//! Ctrl-C ends a render at once and leaves no file.
#![cfg(unix)]

mod common;

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, Command, Stdio};

use common::Folder;

/// A render that would take hours.
struct Render {
    child: Child,
    said: BufReader<ChildStderr>,
}

impl Render {
    /// Starts it and waits until it tells that it has begun.
    fn start(folder: &Folder, more: &str) -> Render {
        let line = format!("ball.txt -o out.png --size 3000 3000 --samples 100000 --show_progress {more}");
        let mut child =
            folder.command().args(line.split_whitespace()).stderr(Stdio::piped()).spawn().unwrap();
        let mut said = BufReader::new(child.stderr.take().unwrap());
        let mut first = String::new();
        said.read_line(&mut first).unwrap();
        assert!(first.starts_with("0 %"), "{first}");
        Render { child, said }
    }

    /// Sends a signal and returns the exit code and what was said.
    fn end_by(mut self, signal: &str) -> (Option<i32>, String) {
        let sent = Command::new("kill")
            .args([&format!("-{signal}"), &self.child.id().to_string()])
            .status()
            .unwrap();
        assert!(sent.success());
        let mut said = String::new();
        self.said.read_to_string(&mut said).unwrap();
        (self.child.wait().unwrap().code(), said)
    }
}

#[test]
fn the_first_signal_stops_the_render_and_nothing_is_left() {
    for (name, expected) in [("HUP", 129), ("INT", 130), ("TERM", 143)] {
        let folder = Folder::new();
        folder.write("out.png", "old");
        let (code, said) = Render::start(&folder, "").end_by(name);
        assert_eq!(code, Some(expected), "{name}: {said}");
        assert!(said.contains("interrupted"), "{name}: {said}");
        assert_eq!(folder.names(), ["ball.txt", "out.png"]);
        assert_eq!(folder.read("out.png"), b"old");
    }
}

#[test]
fn what_there_is_can_be_kept() {
    let folder = Folder::new();
    let (code, said) = Render::start(&folder, "--keep-partial").end_by("INT");
    assert_eq!(code, Some(130), "{said}");
    let picture = common::picture(&folder.path("out.png"));
    assert_eq!((picture.width(), picture.height()), (3000, 3000));
    assert!(picture.data().iter().any(|&v| v > 0.0), "something was rendered");
}
