//! The Python package, tested by a Python that has numpy and pytest.

use std::path::Path;
use std::process::Command;
use std::{fs, io};

use crate::steps::{self, Cargo, Report};

/// Names of an interpreter, the first that has what is needed is taken.
const PYTHONS: [&str; 3] = ["python3", "/usr/bin/python3", "python"];

/// Builds the native module with what the tests of Rust have built already, puts the package together and runs its tests.
pub fn test(root: &Path, report: &mut Report) {
    let needs = "import sys, numpy, pytest; sys.exit(sys.version_info < (3, 10))";
    let python = PYTHONS.into_iter().find(|python| steps::answers(Command::new(python).args(["-c", needs])));
    let Some(python) = python else {
        let why = "no Python of 3.10 or later with numpy and pytest: `pip install numpy pytest`";
        return report.skip("Python package", why);
    };
    // All of the workspace, so that the module is linked with crates that were built for the tests.
    report.run("Python module", Cargo::new(root, "build --profile test --workspace --lib --bins --tests"));
    let outcome = package(root).map_err(|error| vec![format!("the package cannot be put together: {error}")]);
    let outcome = outcome.and_then(|()| {
        let mut pytest = Command::new(python);
        pytest
            .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "crates/kajo-py/tests"])
            .env("PYTHONPATH", root.join("target/python"))
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .env("KAJO_PROGRAM", root.join("target/debug/kajo"))
            .current_dir(root);
        match pytest.status() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(vec![format!("pytest ended with {status}")]),
            Err(error) => Err(vec![format!("pytest did not start: {error}")]),
        }
    });
    report.add("Python package", outcome);
}

/// The package as a wheel has it, in `target/python`.
fn package(root: &Path) -> io::Result<()> {
    let to = root.join("target/python/kajo");
    copy(&root.join("crates/kajo-py/python/kajo"), &to)?;
    let libraries = ["libkajo_py.so", "libkajo_py.dylib", "kajo_py.dll"];
    let built =
        libraries.map(|name| root.join("target/debug").join(name)).into_iter().find(|path| path.exists());
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
