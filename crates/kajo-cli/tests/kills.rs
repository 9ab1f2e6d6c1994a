//! What a killed process leaves, the next one clears; what a living one is writing stays.
#![cfg(unix)]

mod common;

use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

use common::Folder;

/// Writes many files and hardly renders, so that most kills meet a file in the making.
const RENDER: &str =
    "ball.txt --size 150 100 --samples sobol 4096 -o out.exr --checkpoint-every 0 --overwrite-checkpoint";

fn start(folder: &Folder, more: &str) -> Child {
    let line = format!("{RENDER} {more}");
    folder.command().args(line.split(' ')).stderr(Stdio::null()).spawn().unwrap()
}

#[test]
fn each_start_clears_what_a_kill_has_left() {
    let kills = if std::env::var_os("KAJO_DEEP").is_some() { 200 } else { 12 };
    let folder = Folder::new();
    let mut left = 0;
    for i in 0..kills {
        let mut child = start(&folder, "--checkpoint state");
        // Any times will do: what is tested holds for all of them.
        thread::sleep(Duration::from_millis(40 + u64::from(u32::wrapping_mul(i, 2_654_435_761) >> 25)));
        child.kill().unwrap();
        child.wait().unwrap();
        let parts = folder.parts();
        assert!(parts.len() <= 1, "those of earlier kills are gone: {parts:?}");
        left += parts.len();
    }
    println!("{left} of {kills} kills left a file in the making");
    folder.succeed("ball.txt --size 4 4 -o another.png");
    assert_eq!(folder.parts(), [""; 0]);
}

#[test]
fn processes_that_write_into_one_folder_leave_each_other_alone() {
    let folder = Folder::new();
    let render = "--time 1 --checkpoint";
    let children: Vec<Child> =
        (0..4).map(|i| start(&folder, &format!("-o {i}.png {render} {i}.state"))).collect();
    for _ in 0..10 {
        folder.succeed("ball.txt --size 4 4 -o other.png");
    }
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    assert_eq!(folder.parts(), [""; 0]);
    for i in 0..4 {
        assert!(folder.path(&format!("{i}.png")).exists() && folder.path(&format!("{i}.state")).exists());
    }
}
