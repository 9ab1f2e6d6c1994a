//! `kajo studio`: starts the window, which is a program of its own.
//!
//! The plain renderer is built without any crate of the window, so that it stays small and quick to build. The
//! program `kajo-studio` is looked for beside this one, then in the folders of `PATH`.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::args::{Cli, StudioArgs};
use crate::console;
use crate::failure::Failure;

/// `kajo studio` and `kajo` alone
pub fn studio(args: &StudioArgs) -> Result<(), Failure> {
    let here = std::env::current_exe().ok();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let Some(program) = find(here.as_deref(), &path) else { return Err(Failure::Input(missing(args))) };
    let problem = |error| Failure::Input(format!("{}: {error}", program.display()));
    let status = Command::new(&program).args(&args.scene).status().map_err(problem)?;
    match status.code() {
        Some(0) => Ok(()),
        // It has said what was wrong.
        Some(_) => Err(Failure::Input(String::new())),
        None => Err(Failure::Bug(format!("{} ended with {status}", program.display()))),
    }
}

/// `kajo` alone: the window, or the help where there can be none.
pub fn alone() -> Result<(), Failure> {
    let result = studio(&StudioArgs::default());
    if matches!(&result, Err(Failure::Input(_))) {
        console::line(Cli::tree().render_help().to_string().trim_end());
    }
    result
}

/// The program beside `here`, the program that runs, or in a folder of `path`.
fn find(here: Option<&Path>, path: &OsStr) -> Option<PathBuf> {
    let name = format!("kajo-studio{}", std::env::consts::EXE_SUFFIX);
    let beside = here.and_then(Path::parent).map(Path::to_owned);
    let folders = beside.into_iter().chain(std::env::split_paths(path));
    folders.map(|folder| folder.join(&name)).find(|program| program.is_file())
}

fn missing(args: &StudioArgs) -> String {
    let scene = args.scene.as_ref().map_or("scene.txt".into(), |scene| scene.to_string_lossy());
    format!(
        "the window is a program of its own, `kajo-studio`, and it is neither beside `kajo` nor in PATH; \
         build and start it with\n  cargo run --release -p kajo-studio -- {scene}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_beside_wins_over_the_one_in_the_path() {
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let [beside, other] = [folders[0].path(), folders[1].path()];
        let name = format!("kajo-studio{}", std::env::consts::EXE_SUFFIX);
        let path = std::env::join_paths([other]).unwrap();
        let here = beside.join("kajo");
        assert_eq!(find(Some(&here), &path), None);
        std::fs::write(other.join(&name), "").unwrap();
        assert_eq!(find(Some(&here), &path), Some(other.join(&name)));
        assert_eq!(find(None, OsStr::new("")), None);
        std::fs::write(beside.join(&name), "").unwrap();
        assert_eq!(find(Some(&here), &path), Some(beside.join(&name)));
    }

    #[test]
    fn what_is_missing_is_said_with_the_scene() {
        let args = StudioArgs { scene: Some("my.txt".into()) };
        assert!(missing(&args).ends_with("cargo run --release -p kajo-studio -- my.txt"));
        assert!(missing(&StudioArgs::default()).ends_with("-- scene.txt"));
    }
}
