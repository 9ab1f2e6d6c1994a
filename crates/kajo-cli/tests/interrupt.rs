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
        Render::start_by(folder.command(), more)
    }

    /// As `start`, by a command that runs the program with the words that are added to it.
    fn start_by(mut command: Command, more: &str) -> Render {
        let line = format!("ball.txt -o out.png --size 3000 3000 --samples 100000 --show_progress {more}");
        let mut child = command.args(line.split_whitespace()).stderr(Stdio::piped()).spawn().unwrap();
        let mut said = BufReader::new(child.stderr.take().unwrap());
        let mut first = String::new();
        said.read_line(&mut first).unwrap();
        assert!(first.starts_with("0 %"), "{first}");
        Render { child, said }
    }

    fn send(&self, signal: &str) {
        let kill = [&format!("-{signal}"), &self.child.id().to_string()];
        assert!(Command::new("kill").args(kill).status().unwrap().success());
    }

    /// Sends a signal and returns the exit code and what was said.
    fn end_by(mut self, signal: &str) -> (Option<i32>, String) {
        self.send(signal);
        let mut said = String::new();
        self.said.read_to_string(&mut said).unwrap();
        (self.child.wait().unwrap().code(), said)
    }
}

/// Whether this test may be stopped by a signal. One that is ignored here is ignored by whatever is started here.
fn is_heard(signal: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.is_none_or(|bits| u64::from_str_radix(bits.trim(), 16).unwrap() >> (signal - 1) & 1 == 0)
}

#[test]
fn the_first_signal_stops_the_render_and_nothing_is_left() {
    let signals = [("HUP", 129), ("INT", 130), ("TERM", 143)];
    for (name, expected) in signals.into_iter().filter(|(_, code)| is_heard(code - 128)) {
        let folder = Folder::new();
        folder.write("out.png", "old");
        let (code, said) = Render::start(&folder, "").end_by(name);
        assert_eq!(code, Some(expected as i32), "{name}: {said}");
        assert!(said.contains("interrupted"), "{name}: {said}");
        assert_eq!(folder.names(), ["ball.txt", "out.png"]);
        assert_eq!(folder.read("out.png"), b"old");
    }
}

#[test]
fn what_there_is_can_be_kept() {
    let folder = Folder::new();
    let (code, said) = Render::start(&folder, "--keep-partial").end_by("TERM");
    assert_eq!(code, Some(143), "{said}");
    let picture = common::picture(&folder.path("out.png"));
    assert_eq!((picture.width(), picture.height()), (3000, 3000));
    assert!(picture.data().iter().any(|&v| v > 0.0), "something was rendered");
}

#[test]
fn a_gallery_that_is_stopped_or_killed_has_a_page_of_what_is_finished() {
    for (signal, expected) in [("TERM", Some(143)), ("KILL", None)] {
        let folder = Folder::new();
        folder.write(
            "list.txt",
            "a ball.txt -size 20 10\nlong ball.txt -size 3000 3000 -jittered_samples 10000\nb ball.txt\n",
        );
        let mut command = folder.command();
        let line = ["gallery", "list.txt", "out", "--show-progress"];
        let mut child = command.args(line).stderr(Stdio::piped()).spawn().unwrap();
        let mut said = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        while !line.contains("1/3 a") {
            line.clear();
            assert!(said.read_line(&mut line).unwrap() > 0);
        }
        // The second picture has begun when it tells so, and the page is written by then.
        said.read_line(&mut line).unwrap();
        let (code, _) = Render { child, said }.end_by(signal);
        assert_eq!(code, expected);
        let page = String::from_utf8(folder.read("out/index.html")).unwrap();
        assert!(page.contains("a.png") && page.contains("1 of 3 pictures, 0 failed"), "{page}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_is_ignored_at_the_start_stays_ignored() {
    let folder = Folder::new();
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_kajo")]);
    shell.current_dir(folder.path("")).stdin(Stdio::null());
    let render = Render::start_by(shell, "");
    // Signals of lower number are delivered first, so that the hangup would decide the exit code.
    render.send("HUP");
    let (code, said) = render.end_by("TERM");
    assert_eq!(code, Some(143), "{said}");
}

#[test]
fn a_pipe_that_nobody_reads_is_waited_for_until_a_signal() {
    let folder = Folder::new();
    folder.pipe("pipe.png");
    let line = "ball.txt -o pipe.png --size 8 8 --samples 1 --show_progress";
    let mut child = folder.command().args(line.split(' ')).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let mut progress = String::new();
    while !progress.starts_with("100 %") {
        progress.clear();
        assert!(said.read_line(&mut progress).unwrap() > 0);
    }
    // Any moment will do; after a while it waits.
    std::thread::sleep(std::time::Duration::from_millis(300));
    let (code, said) = Render { child, said }.end_by("TERM");
    assert_eq!(code, Some(143), "{said}");
}

/// Each camera ray becomes thousands of rays, and the program waits two seconds for a render to stop.
#[test]
fn pixels_that_take_long_stop_too() {
    let folder = Folder::new();
    // Ambient light would be warned of.
    let around = common::BALL.replace("ambientLight 0.1 0.1 0.1", "").replace("radius 1 ", "radius 20 ");
    folder.write("ball.txt", around);
    let slow = "--keep-partial --integrator distribution --branches 16384 --threads 1";
    let (code, said) = Render::start(&folder, slow).end_by("TERM");
    assert_eq!(code, Some(143), "{said}");
    assert!(folder.names().contains(&"out.png".to_owned()), "the program gave up on the render: {said}");
}
