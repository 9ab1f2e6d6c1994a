//! Debian packages that the tests need.

use std::process::Command;

use crate::steps::{self, Report};

/// A program, and the package that brings it.
///
/// A linker is not in the list: this very program would not exist without one.
const NEEDED: [(&str, &str); 1] = [("git", "git")];

/// Installs what is missing where that is allowed, and says what was left out where not.
pub fn provide(report: &mut Report) {
    let missing = NEEDED.iter().filter(|(program, _)| !steps::has_program(program));
    for (program, package) in missing {
        if !may_install() {
            report.skip(program, format!("not installed; `apt-get install {package}` needs Debian and root"));
        } else if let Err(problem) = install(package) {
            report.skip(program, problem);
        }
    }
}

fn may_install() -> bool {
    let id = Command::new("id").arg("-u").output();
    let root = id.is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    root && steps::has_program("apt-get")
}

fn install(package: &str) -> Result<(), String> {
    let apt = |arguments: &[&str]| {
        let status =
            Command::new("apt-get").args(arguments).env("DEBIAN_FRONTEND", "noninteractive").status();
        match status {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(format!("apt-get {} ended with {status}", arguments.join(" "))),
            Err(error) => Err(format!("apt-get did not start: {error}")),
        }
    };
    apt(&["update"])?;
    apt(&["install", "--yes", "--no-install-recommends", package])
}
