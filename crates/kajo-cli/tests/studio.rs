//! The command that starts the window, whose program may be missing.

mod common;

use std::path::PathBuf;
use std::process::Command;
use std::sync::{Mutex, MutexGuard, PoisonError};

use common::{Folder, Ran};

/// A copy of the program in the folder, so that nothing is beside it but what the test puts there.
///
/// No other test starts a program meanwhile: its process would hold the copy open for writing until it runs something
/// else, and what is open for writing cannot be started.
fn alone(folder: &Folder) -> (PathBuf, MutexGuard<'static, ()>) {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let program = folder.path(&format!("kajo{}", std::env::consts::EXE_SUFFIX));
    std::fs::copy(env!("CARGO_BIN_EXE_kajo"), &program).unwrap();
    (program, alone)
}

fn run(program: &PathBuf, words: &[&str]) -> Ran {
    Ran::from(Command::new(program).args(words).env("PATH", "").env("NO_COLOR", "1").output().unwrap())
}

#[test]
fn without_the_window_the_way_to_it_is_told() {
    let folder = Folder::new();
    let (program, _alone) = alone(&folder);
    let ran = run(&program, &["studio", "ball.txt"]);
    assert_eq!(ran.code, Some(2));
    assert!(ran.stderr.contains("cargo run --release -p kajo-studio -- ball.txt"), "{}", ran.stderr);
    let ran = run(&program, &[]);
    assert_eq!(ran.code, Some(2));
    for part in ["Usage:", "cargo run --release -p kajo-studio -- scene.txt"] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
}

#[cfg(unix)]
#[test]
fn the_window_gets_the_scene_and_its_end_is_passed_on() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::new();
    let (program, _alone) = alone(&folder);
    let window = folder.path("kajo-studio");
    std::fs::write(&window, "#!/bin/sh\necho \"window of $# $1\"\ntest \"$1\" != wrong.txt\n").unwrap();
    std::fs::set_permissions(&window, std::fs::Permissions::from_mode(0o755)).unwrap();
    let ran = run(&program, &["studio", "a scene.txt"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), "window of 1 a scene.txt\n"), "{}", ran.stderr);
    assert_eq!(run(&program, &[]).stdout, "window of 0 \n");
    assert_eq!(run(&program, &["studio", "wrong.txt"]).code, Some(2));
}
