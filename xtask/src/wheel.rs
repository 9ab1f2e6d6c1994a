//! The wheel of the Python package: the native module, the package around it, and the program `kajo` as its command.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::environment::{Environment, run};
use crate::python::PACKAGES;
use crate::steps::{self, Cargo, Report};

/// Most bytes that a wheel may have.
const LARGEST: u64 = 15 << 20;

/// Interpreters without a global lock, which take no wheel but one that was built for them.
const FREE_THREADED: [&str; 4] = ["python3.15t", "python3.14t", "python3.13t", "python3t"];

/// Builds the wheel into `target/wheels`, and uses it as people do; and one for an interpreter without a global lock, where there is one.
pub fn build(root: &Path, report: &mut Report) {
    let environment = match Environment::make(root, &PACKAGES) {
        Ok(environment) => environment,
        Err(why) => return report.skip("wheel", why),
    };
    report.run("program of the wheel", Cargo::new(root, "build --profile wheel -p kajo-cli"));
    if report.failed() {
        return;
    }
    report.add("wheel", built_and_used(root, &environment, None));
    let has_no_lock = "import sys; sys.exit(sys._is_gil_enabled())";
    let free = FREE_THREADED
        .into_iter()
        .find(|python| steps::answers(Command::new(python).args(["-c", has_no_lock])));
    let name = "wheel for free-threaded Python";
    let Some(python) = free else {
        return report.skip(name, format!("none of {} is here", FREE_THREADED.join(", ")));
    };
    match Environment::of(python, root.join("target/venv-free-threaded"), &["numpy"]) {
        Ok(users) => report.add(name, built_and_used(root, &environment, Some(&users))),
        Err(why) => report.skip(name, why),
    }
}

/// Builds the wheel for the interpreter of an environment, and uses it there.
///
/// * `tools`: has maturin
/// * `users`: whose interpreter it is for; `None` for `tools` and all that understand the same wheel
fn built_and_used(root: &Path, tools: &Environment, users: Option<&Environment>) -> Result<(), Vec<String>> {
    let wheel = with_maturin(root, tools, users)?;
    println!("{}", wheel.display());
    installed(root, users.unwrap_or(tools), &wheel)
}

/// Builds the wheel in an environment that has maturin. The program must have been built.
fn with_maturin(
    root: &Path,
    tools: &Environment,
    users: Option<&Environment>,
) -> Result<PathBuf, Vec<String>> {
    let told = |what: &str, error: std::io::Error| vec![format!("{what}: {error}")];
    let package = root.join("crates/kajo-py");
    let scripts = package.join("kajo.data/scripts");
    let program = format!("kajo{}", std::env::consts::EXE_SUFFIX);
    fs::create_dir_all(&scripts).map_err(|error| told("a folder cannot be made", error))?;
    fs::copy(steps::built(root, "wheel").join(&program), scripts.join(&program))
        .map_err(|error| told("the program was not built", error))?;
    let folder = root.join(if users.is_some() { "target/wheels-free-threaded" } else { "target/wheels" });
    let _ = fs::remove_dir_all(&folder);
    let mut maturin = Command::new(tools.program("maturin"));
    maturin.args(["build", "--profile", "wheel", "--out"]).arg(&folder).current_dir(&package);
    if let Some(users) = users {
        maturin.arg("--interpreter").arg(users.program("python"));
    }
    let status = maturin.status().map_err(|error| told("maturin did not start", error))?;
    // What was put there for it is no part of the sources.
    let _ = fs::remove_file(scripts.join(&program));
    if !status.success() {
        return Err(vec![format!("maturin ended with {status}")]);
    }
    let found = fs::read_dir(&folder).ok().and_then(|mut files| files.next()).and_then(Result::ok);
    let wheel = found.map(|file| file.path()).ok_or_else(|| vec!["there is no wheel".to_owned()])?;
    let size = fs::metadata(&wheel).map_err(|error| told("the wheel cannot be read", error))?.len();
    if size > LARGEST {
        return Err(vec![format!("the wheel has {size} bytes, and may have {LARGEST}")]);
    }
    Ok(wheel)
}

/// Installs the wheel into an environment of its own and renders with it: in Python, and by the command that comes with it.
fn installed(root: &Path, environment: &Environment, wheel: &Path) -> Result<(), Vec<String>> {
    let folder = root.join("target/wheel-test");
    let _ = fs::remove_dir_all(&folder);
    let steps = || -> Result<(), String> {
        run(Command::new(environment.program("python"))
            .args(["-m", "venv", "--system-site-packages"])
            .arg(&folder))?;
        let fresh = Environment::at(folder.clone());
        let python = fresh.program("python");
        // numpy is there already.
        run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "--no-deps"]).arg(wheel))?;
        let script = root.join("crates/kajo-py/tests/wheel.py");
        run(Command::new(environment.program("python")).arg(script).arg(&folder).current_dir(&folder))
    };
    steps().map_err(|problem| vec![problem])
}
