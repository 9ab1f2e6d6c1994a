//! The wheel of the Python package: the native module, the package around it, and the program `kajo` as its command.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::environment::Environment;
use crate::steps::{Cargo, Report};

/// Most bytes that a wheel may have.
const LARGEST: u64 = 15 << 20;

/// How fast what is in it is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// For people.
    Release,
    /// For tests, of what these have built.
    Test,
}

impl Profile {
    fn name(self) -> &'static str {
        match self {
            Profile::Release => "release",
            Profile::Test => "test",
        }
    }

    fn folder(self) -> &'static str {
        match self {
            Profile::Release => "target/release",
            Profile::Test => "target/debug",
        }
    }
}

/// Builds the wheel for people, into `target/wheels`.
pub fn build(root: &Path, report: &mut Report) {
    let environment = match Environment::make(root, &["maturin"]) {
        Ok(environment) => environment,
        Err(why) => return report.add("wheel", Err(vec![why])),
    };
    report.run("program", Cargo::new(root, "build --release -p kajo-cli"));
    if !report.failed() {
        report.add(
            "wheel",
            with_maturin(root, &environment, Profile::Release).map(|path| println!("{}", path.display())),
        );
    }
}

/// Builds the wheel in an environment that has maturin. The program must have been built.
///
/// # Errors
/// What went wrong, in lines.
pub fn with_maturin(
    root: &Path,
    environment: &Environment,
    profile: Profile,
) -> Result<PathBuf, Vec<String>> {
    let told = |what: &str, error: std::io::Error| vec![format!("{what}: {error}")];
    let package = root.join("crates/kajo-py");
    let scripts = package.join("kajo.data/scripts");
    let program = format!("kajo{}", std::env::consts::EXE_SUFFIX);
    fs::create_dir_all(&scripts).map_err(|error| told("a folder cannot be made", error))?;
    fs::copy(root.join(profile.folder()).join(&program), scripts.join(&program))
        .map_err(|error| told("the program was not built", error))?;
    let folder = root.join("target/wheels").join(if profile == Profile::Test { "test" } else { "" });
    let _ = fs::remove_dir_all(&folder);
    let out: OsString = folder.clone().into();
    let mut maturin = Command::new(environment.program("maturin"));
    maturin.args(["build", "--profile", profile.name(), "--out"]).arg(out).current_dir(&package);
    let status = maturin.status().map_err(|error| told("maturin did not start", error))?;
    // What was put there for it is no part of the sources.
    let _ = fs::remove_file(scripts.join(&program));
    if !status.success() {
        return Err(vec![format!("maturin ended with {status}")]);
    }
    let found = fs::read_dir(&folder).ok().and_then(|mut files| files.next()).and_then(Result::ok);
    let wheel = found.map(|file| file.path()).ok_or_else(|| vec!["there is no wheel".to_owned()])?;
    let size = fs::metadata(&wheel).map_err(|error| told("the wheel cannot be read", error))?.len();
    // That of the tests holds what finds bugs, and names for backtraces.
    if profile == Profile::Release && size > LARGEST {
        return Err(vec![format!("the wheel has {size} bytes, and may have {LARGEST}")]);
    }
    Ok(wheel)
}
