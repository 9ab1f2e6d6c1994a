//! Debian packages that the tests need.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::steps::Report;

/// Something the tests need, and the packages that bring it.
struct Need {
    name: &'static str,
    is_there: fn() -> bool,
    packages: &'static [&'static str],
}

/// A linker is not in the list: this very program would not exist without one.
const NEEDS: [Need; 5] = [
    Need { name: "git", is_there: || has_program("git"), packages: &["git"] },
    Need {
        name: "a graphics card, or its stand-in on the processor",
        is_there: has_vulkan_driver,
        packages: &["mesa-vulkan-drivers", "libvulkan1", "libgl1", "libgl1-mesa-dri", "libegl1", "libgles2"],
    },
    Need {
        name: "a display without a screen",
        is_there: || has_program("Xvfb"),
        packages: &[
            "xvfb",
            "libxkbcommon0",
            "libxkbcommon-x11-0",
            "libxcursor1",
            "libxi6",
            "libxrandr2",
            "libx11-xcb1",
        ],
    },
    Need {
        name: "Python with numpy and pytest",
        is_there: || has_python("python3") || has_python("/usr/bin/python3"),
        packages: &["python3", "python3-venv", "python3-numpy", "python3-pytest"],
    },
    Need { name: "keys and mouse by script", is_there: || has_program("xdotool"), packages: &["xdotool"] },
];

/// Installs what is missing where that is allowed, and says what was left out where not.
pub fn provide(report: &mut Report) {
    let missing: Vec<&Need> = NEEDS.iter().filter(|need| !(need.is_there)()).collect();
    if missing.is_empty() {
        return;
    }
    let is_updated = may_install() && apt(&["update"]).is_ok();
    for need in missing {
        let packages = need.packages.join(" ");
        if !is_updated {
            let why =
                format!("not installed; `apt-get install {packages}` needs Debian, root and the network");
            report.skip(need.name, why);
        } else if let Err(problem) = install(need.packages) {
            report.skip(need.name, problem);
        }
    }
}

/// Whether a folder of `PATH` has this program.
fn has_program(name: &str) -> bool {
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path).any(|folder| folder.join(format!("{name}{}", env::consts::EXE_SUFFIX)).is_file())
}

/// Whether this Python can run the tests of the package.
fn has_python(program: &str) -> bool {
    crate::steps::answers(Command::new(program).args(["-c", "import numpy, pytest"]))
}

/// Whether anything draws with Vulkan here. Systems other than Linux always have something of their own.
fn has_vulkan_driver() -> bool {
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    let has_files =
        |folder: &&str| fs::read_dir(Path::new(folder)).is_ok_and(|mut files| files.next().is_some());
    !cfg!(target_os = "linux") || folders.iter().any(has_files)
}

fn may_install() -> bool {
    let id = Command::new("id").arg("-u").output();
    let root = id.is_ok_and(|id| id.stdout.trim_ascii() == b"0");
    root && has_program("apt-get")
}

fn install(packages: &[&str]) -> Result<(), String> {
    let arguments = ["install", "--yes", "--no-install-recommends"];
    apt(&[&arguments[..], packages].concat())
}

fn apt(arguments: &[&str]) -> Result<(), String> {
    let status = Command::new("apt-get").args(arguments).env("DEBIAN_FRONTEND", "noninteractive").status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("apt-get {} ended with {status}", arguments.join(" "))),
        Err(error) => Err(format!("apt-get did not start: {error}")),
    }
}
