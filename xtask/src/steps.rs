//! Runs the steps of a task one after another and remembers how each ended.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// One call of cargo, from the root of the workspace.
pub struct Cargo {
    command: Command,
    arguments: Vec<OsString>,
    toolchain: Option<&'static str>,
}

impl Cargo {
    /// `line` is cut at blanks.
    pub fn new(root: &Path, line: &str) -> Cargo {
        let mut command = Command::new("cargo");
        command.current_dir(root);
        Cargo { command, arguments: line.split_whitespace().map(OsString::from).collect(), toolchain: None }
    }

    pub fn argument(mut self, argument: impl AsRef<OsStr>) -> Cargo {
        self.arguments.push(argument.as_ref().to_owned());
        self
    }

    pub fn env(mut self, name: &str, value: &str) -> Cargo {
        self.command.env(name, value);
        self
    }

    /// Asks for another compiler than the one pinned by the workspace.
    pub fn toolchain(mut self, toolchain: &'static str) -> Cargo {
        self.toolchain = Some(toolchain);
        self
    }

    fn run(mut self) -> Result<(), Vec<String>> {
        if let Some(toolchain) = self.toolchain {
            // The compiler running this task is passed down by these; they would win over `+toolchain`.
            self.command.env_remove("RUSTUP_TOOLCHAIN").arg(format!("+{toolchain}"));
        }
        match self.command.args(&self.arguments).status() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(vec![format!("cargo ended with {status}")]),
            Err(error) => Err(vec![format!("cargo did not start: {error}")]),
        }
    }
}

/// The folder in which cargo leaves what it has built.
///
/// * `profile`: that folder of a profile, such as `debug` or `release`
pub fn built(root: &Path, profile: &str) -> PathBuf {
    built_below(root, std::env::var_os("CARGO_TARGET_DIR"), profile)
}

/// * `target`: what `CARGO_TARGET_DIR` says; cargo starts in the root
fn built_below(root: &Path, target: Option<OsString>, profile: &str) -> PathBuf {
    let target = target.filter(|target| !target.is_empty()).unwrap_or_else(|| "target".into());
    root.join(target).join(profile)
}

enum Outcome {
    Passed(Duration),
    Failed(Vec<String>),
    Skipped(String),
}

/// How the steps so far have ended.
#[derive(Default)]
pub struct Report {
    steps: Vec<(String, Outcome)>,
}

impl Report {
    /// Runs cargo as a step; later steps run whether it passes or not, so that all faults show at once.
    pub fn run(&mut self, name: &str, cargo: Cargo) {
        println!("\n== {name}");
        let start = Instant::now();
        let outcome = cargo.run();
        self.push(name, outcome, start.elapsed());
    }

    /// Runs cargo as a step that passes when cargo fails.
    pub fn run_to_fail(&mut self, name: &str, cargo: Cargo) {
        println!("\n== {name}");
        let start = Instant::now();
        let outcome = match cargo.run() {
            Ok(()) => Err(vec!["cargo should have failed, and did not".to_owned()]),
            Err(_) => Ok(()),
        };
        self.push(name, outcome, start.elapsed());
    }

    /// Records a step that needed no other program.
    pub fn add(&mut self, name: &str, outcome: Result<(), Vec<String>>) {
        self.push(name, outcome, Duration::ZERO);
    }

    /// Records what was left out, and why.
    pub fn skip(&mut self, name: &str, why: impl Into<String>) {
        self.steps.push((name.to_owned(), Outcome::Skipped(why.into())));
    }

    pub fn failed(&self) -> bool {
        self.steps.iter().any(|(_, outcome)| matches!(outcome, Outcome::Failed(_)))
    }

    /// One line a step: what ran, what was skipped and why.
    pub fn print(&self) {
        println!("\n== what ran");
        for (name, outcome) in &self.steps {
            match outcome {
                Outcome::Passed(time) => println!("  passed   {name} ({:.1} s)", time.as_secs_f64()),
                Outcome::Skipped(why) => println!("  skipped  {name}: {why}"),
                Outcome::Failed(problems) => {
                    println!("  FAILED   {name}");
                    problems.iter().for_each(|problem| println!("           {problem}"));
                }
            }
        }
    }

    fn push(&mut self, name: &str, outcome: Result<(), Vec<String>>, time: Duration) {
        let outcome = outcome.map_or_else(Outcome::Failed, |()| Outcome::Passed(time));
        self.steps.push((name.to_owned(), outcome));
    }
}

/// Whether `cargo NAME` exists.
pub fn has_cargo_command(name: &str) -> bool {
    answers(Command::new("cargo").args([name, "--version"]))
}

/// Whether a nightly compiler is installed.
pub fn has_nightly() -> bool {
    answers(Command::new("rustc").env_remove("RUSTUP_TOOLCHAIN").args(["+nightly", "--version"]))
}

/// Whether a program starts and ends well.
pub fn answers(command: &mut Command) -> bool {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_built_lies_where_cargo_leaves_it() {
        let built =
            |target: Option<&str>| built_below(Path::new("/kajo"), target.map(OsString::from), "release");
        assert_eq!(built(None), Path::new("/kajo/target/release"));
        assert_eq!(built(Some("")), Path::new("/kajo/target/release"));
        assert_eq!(built(Some("elsewhere")), Path::new("/kajo/elsewhere/release"));
        assert_eq!(built(Some("/tmp/built")), Path::new("/tmp/built/release"));
    }
}
