//! Environments of Python with packages of their own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::steps;

/// Names of an interpreter, the first that is new enough is taken.
pub const PYTHONS: [&str; 3] = ["python3", "/usr/bin/python3", "python"];

/// An environment of Python with packages of its own, in `target/venv`.
pub struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// Makes it, or adds to the one that is there.
    ///
    /// # Errors
    /// Why it cannot be had, and the command that would make it.
    pub fn make(root: &Path, packages: &[&str]) -> Result<Environment, String> {
        let needs = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))";
        let python =
            PYTHONS.into_iter().find(|python| steps::answers(Command::new(python).args(["-c", needs])));
        let python = python.ok_or("no Python of 3.11 or later with venv: `apt-get install python3-venv`")?;
        Environment::of(python, root.join("target/venv"), packages)
    }

    /// The same of an interpreter, in a folder.
    ///
    /// # Errors
    /// As for [`Environment::make`].
    pub fn of(python: &str, folder: PathBuf, packages: &[&str]) -> Result<Environment, String> {
        let environment = Environment { folder };
        let pip = environment.program("python");
        if !pip.exists() {
            run(Command::new(python).args(["-m", "venv"]).arg(&environment.folder))?;
        }
        let known = environment.folder.join("packages.txt");
        let wanted = packages.join(" ");
        if fs::read_to_string(&known).is_ok_and(|known| known == wanted) {
            return Ok(environment);
        }
        let mut install = Command::new(&pip);
        run(install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(packages))?;
        // If it cannot be noted, pip is asked again next time.
        let _ = fs::write(known, wanted);
        Ok(environment)
    }

    /// One that somebody else has made.
    pub fn at(folder: PathBuf) -> Environment {
        Environment { folder }
    }

    /// One of its programs.
    pub fn program(&self, name: &str) -> PathBuf {
        let folder = if cfg!(windows) { "Scripts" } else { "bin" };
        self.folder.join(folder).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }
}

/// Runs a program to its end.
///
/// # Errors
/// How it ended, or that it did not start.
pub fn run(command: &mut Command) -> Result<(), String> {
    let line = format!("{command:?}").replace('"', "");
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("`{line}` ended with {status}; it needs the Python registry")),
        Err(error) => Err(format!("`{line}` did not start: {error}")),
    }
}
