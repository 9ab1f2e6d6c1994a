//! The Python package: its tests, and those of its notebooks and farm.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;
use std::{fs, io};

use crate::environment::{Environment, PYTHONS};
use crate::steps::{self, Cargo, Report};

/// Packages of the Python registry that the tests and the wheel need.
pub const PACKAGES: [&str; 13] = [
    "maturin",
    "numpy",
    "pytest",
    "distributed",
    "cryptography",
    "nbclient",
    "nbformat",
    "ipykernel",
    "matplotlib",
    "tqdm",
    "trimesh",
    "mypy",
    "ruff",
];

/// Builds the native module with what the tests of Rust have built already, puts the package together and runs its tests:
/// with Dask, notebooks and checkers where the Python registry can be reached, and without otherwise.
pub fn test(root: &Path, report: &mut Report) {
    // All of the workspace, so that the module is linked with crates that were built for the tests.
    report.run("Python module", Cargo::new(root, "build --workspace --lib --bins --tests"));
    if let Err(error) = package(root) {
        let problem = format!("the package cannot be put together: {error}");
        return report.add("Python package", Err(vec![problem]));
    }
    match Environment::make(root, &PACKAGES) {
        Ok(environment) => {
            report.add("Python package", pytest(root, environment.program("python")));
            report.add(
                "Python types",
                check(root, &environment, "mypy", &["--config-file", "pyproject.toml", "python/kajo"]),
            );
            report.add(
                "Python lints",
                check(
                    root,
                    &environment,
                    "ruff",
                    &["check", "--no-cache", "python", "tests", "../../docs/notebooks"],
                ),
            );
        }
        Err(why) => {
            report.skip("farm of Dask, notebooks, types and lints of the Python package", why);
            let needs = "import sys, numpy, pytest; sys.exit(sys.version_info < (3, 11))";
            match PYTHONS.into_iter().find(|python| steps::answers(Command::new(python).args(["-c", needs])))
            {
                Some(python) => report.add("Python package", pytest(root, python)),
                None => report.skip("Python package", "no Python of 3.11 or later with numpy and pytest"),
            }
        }
    }
}

fn pytest(root: &Path, python: impl AsRef<OsStr>) -> Result<(), Vec<String>> {
    let mut pytest = Command::new(python);
    pytest
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "crates/kajo-py/tests"])
        .env("PYTHONPATH", root.join("target/python"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("KAJO_PROGRAM", steps::built(root, "debug").join("kajo"))
        .current_dir(root);
    ended("pytest", pytest)
}

fn check(root: &Path, environment: &Environment, program: &str, words: &[&str]) -> Result<(), Vec<String>> {
    let mut command = Command::new(environment.program(program));
    command
        .args(words)
        .current_dir(root.join("crates/kajo-py"))
        .env("MYPY_CACHE_DIR", root.join("target/mypy"))
        .env("MYPYPATH", root.join("target/python"));
    ended(program, command)
}

fn ended(name: &str, mut command: Command) -> Result<(), Vec<String>> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(vec![format!("{name} ended with {status}")]),
        Err(error) => Err(vec![format!("{name} did not start: {error}")]),
    }
}

/// The package as a wheel has it, in `target/python`.
fn package(root: &Path) -> io::Result<()> {
    let to = root.join("target/python/kajo");
    let _ = fs::remove_dir_all(&to);
    copy(&root.join("crates/kajo-py/python/kajo"), &to)?;
    let libraries = ["libkajo_py.so", "libkajo_py.dylib", "kajo_py.dll"];
    let built =
        libraries.map(|name| steps::built(root, "debug").join(name)).into_iter().find(|path| path.exists());
    let built =
        built.ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "the native module was not built"))?;
    let name = if cfg!(windows) { "_native.pyd" } else { "_native.abi3.so" };
    fs::copy(built, to.join(name)).map(|_| ())
}

/// Copies the files of a folder, and of those in it.
fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        match entry.file_type()? {
            kind if kind.is_file() => _ = fs::copy(entry.path(), to)?,
            kind if kind.is_dir() && entry.file_name() != "__pycache__" => copy(&entry.path(), &to)?,
            _ => {}
        }
    }
    Ok(())
}
