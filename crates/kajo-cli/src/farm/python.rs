//! Commands that the Python package does: it has what talks to Dask.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::failure::Failure;

/// What a command line says behind `kajo farm`, where that is for the package: it has options of its own.
pub fn words_for_python(line: &[OsString]) -> Option<&[OsString]> {
    let words = line.get(2..)?;
    let is_ours = line.get(1)? == "farm"
        && words
            .first()
            .is_some_and(|word| ["init", "head", "join", "ssh"].iter().any(|known| word == *known));
    is_ours.then_some(words)
}

/// Runs `python -m kajo.farm` with these words in place of this program.
///
/// # Errors
/// When there is no Python with the package and Dask, with the command that installs them; the exit code of what ran.
pub fn hand_over(words: &[OsString]) -> Result<(), Failure> {
    let python = python()?;
    let mut command = Command::new(python);
    command.args(["-m", "kajo.farm"]).args(words);
    if let Ok(program) = env::current_exe() {
        command.env("KAJO_PROGRAM", program);
    }
    run(command)
}

/// In place of this process, so that signals and exit codes are those of Python.
#[cfg(unix)]
fn run(mut command: Command) -> Result<(), Failure> {
    use std::os::unix::process::CommandExt;
    let error = command.exec();
    Err(Failure::Input(format!("Python cannot be started: {error}")))
}

#[cfg(not(unix))]
fn run(mut command: Command) -> Result<(), Failure> {
    match command.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(1)),
        Err(error) => Err(Failure::Input(format!("Python cannot be started: {error}"))),
    }
}

/// The first interpreter that has all that is needed.
fn python() -> Result<PathBuf, Failure> {
    const NEEDS: &str = "import importlib.util as u, sys; \
        sys.exit(next((2 + i for i, name in enumerate(['kajo', 'distributed']) if not u.find_spec(name)), 0))";
    let beside = env::current_exe().ok().and_then(|program| Some(program.parent()?.join("python3")));
    let named = env::var_os("KAJO_PYTHON").map(PathBuf::from);
    let candidates: Vec<PathBuf> = match named {
        Some(python) => vec![python],
        None => beside
            .into_iter()
            .filter(|path| path.exists())
            .chain(["python3".into(), "python".into()])
            .collect(),
    };
    let mut best = 0;
    for python in candidates {
        let quiet = Command::new(&python)
            .args(["-c", NEEDS])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        match quiet.ok().and_then(|status| status.code()) {
            Some(0) => return Ok(python),
            code => best = best.max(code.unwrap_or(0)),
        }
    }
    let what = match best {
        3 => "Dask is not installed",
        2 => "the Python package of kajo is not installed",
        _ => "there is no Python",
    };
    Err(Failure::Input(format!(
        "a cluster is reached by Dask, and {what}: `pip install \"kajo[dask]\"` installs what is needed \
         (KAJO_PYTHON names another interpreter)"
    )))
}
