//! Checkpoints: a render that is stopped or killed goes on to the same bytes.
#![cfg(unix)]

mod common;

use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use common::Folder;

const RENDER: &str =
    "ball.txt --size 150 100 --samples sobol 128 --layers color,samples -o out.exr --threads 2";

/// Light of any sample may fall on any pixel.
const SPLATS: &str = "ball.txt --size 150 100 --samples sobol 64 --integrator bidirectional --filter gaussian 0.7 --layers color,samples -o out.exr --threads 2";

/// The bytes of the picture that nobody disturbed.
fn expected(render: &str) -> Vec<u8> {
    let folder = Folder::new();
    folder.succeed(render);
    folder.read("out.exr")
}

/// Starts the render, sends a signal after a while, and returns the exit code, if there is one, and what was said.
fn disturbed(
    folder: &Folder,
    render: &str,
    more: &str,
    signal: &str,
    after: Duration,
) -> (Option<i32>, String) {
    let line = format!("{render} --checkpoint state --checkpoint-every 0 {more}");
    let child = folder.command().args(line.split_whitespace()).stderr(Stdio::piped()).spawn().unwrap();
    thread::sleep(after);
    // The render may be over by now, and then nobody hears it.
    let _ = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Kills a render at random times, with fewer and fewer passes left to do, and then lets it end.
fn kill_often(kills: u32) {
    let folder = Folder::new();
    let (mut resumed, mut patience) = (0, 1);
    for i in 0..kills {
        // Any times will do: what is tested holds for all of them.
        let millis = u64::from(i.wrapping_mul(2_654_435_761) >> 24);
        let more = if folder.path("state").exists() { "--resume state" } else { "" };
        resumed += u32::from(!more.is_empty());
        // A busy machine may not have come to a checkpoint yet.
        patience = if more.is_empty() { 64.min(2 * patience) } else { patience };
        let wait = Duration::from_millis((20 + millis) * patience);
        let (code, said) = disturbed(&folder, RENDER, more, "KILL", wait);
        assert!(code.is_none() || code == Some(0), "{said}");
    }
    assert!(resumed > 0, "no checkpoint was ever written");
    folder.succeed(&format!("{RENDER} --resume state"));
    assert!(folder.read("out.exr") == expected(RENDER), "the picture differs after {kills} kills");
}

#[test]
fn a_render_that_is_killed_goes_on_to_the_same_bytes() {
    kill_often(6);
}

#[test]
fn a_render_that_is_killed_twenty_times_does_too() {
    if std::env::var_os("KAJO_DEEP").is_some() {
        (0..5).for_each(|_| kill_often(20));
    }
}

#[test]
fn a_signal_leaves_a_checkpoint_and_the_picture_so_far() {
    let folder = Folder::new();
    let (code, said) = disturbed(&folder, RENDER, "", "TERM", Duration::from_millis(300));
    if code != Some(0) {
        assert_eq!(code, Some(143), "{said}");
        let picture = common::picture(&folder.path("out.exr"));
        assert_eq!((picture.width(), picture.height()), (150, 100));
    }
    folder.succeed(&format!("{RENDER} --resume state --threads 1 --tile 20"));
    assert!(folder.read("out.exr") == expected(RENDER));
}

#[test]
fn splats_go_on_to_the_same_bytes() {
    let folder = Folder::new();
    let (_, said) = disturbed(&folder, SPLATS, "", "TERM", Duration::from_millis(700));
    // Where the machine is busy there may be no checkpoint yet, and where it is fast nothing to go on from.
    let more = if folder.path("state").exists() { "--resume state" } else { "" };
    folder.succeed(&format!("{SPLATS} {more}"));
    assert!(folder.read("out.exr") == expected(SPLATS), "the picture differs: {said}");
}

#[test]
fn what_cannot_be_continued_is_refused() {
    let folder = Folder::new();
    folder.succeed("ball.txt --size 20 20 --samples 4 -o out.png --checkpoint state --checkpoint-every 0");
    let resume = "ball.txt --size 20 20 --samples 4 -o out.png --resume";
    folder.fail(&format!("{resume} nothing"), 2, &["cannot read the checkpoint `nothing`"]);
    folder.fail(&format!("{resume} ball.txt"), 2, &["`ball.txt` is no checkpoint of kajo"]);
    folder.fail(
        &format!("{resume} state --bounces 7"),
        2,
        &["`state` belongs to another render", "bounces: 4"],
    );
    let changed = common::BALL.replace("0.8 0.6 0.2", "0.8 0.6 0.3");
    folder.write("ball.txt", changed);
    folder.fail(&format!("{resume} state"), 2, &["belongs to another render: it has `scene "]);
    folder.fail("ball.txt --samples jittered 4 --adaptive -o a.png", 2, &["jittered", "sobol"]);
    folder.fail("ball.txt -o a.png --checkpoint a.png", 5, &["cannot write `a.png` twice"]);
    folder.fail("ball.txt -o a.png --noise 0", 2, &["--noise", "above 0"]);
}

#[test]
fn what_is_worth_more_is_not_replaced_by_a_checkpoint() {
    let folder = Folder::new();
    let render = "ball.txt --size 20 20 --samples sobol 4 -o out.png --checkpoint-every 0 --checkpoint";
    folder.write("notes", "all I know");
    folder.fail(
        &format!("{render} notes"),
        2,
        &["`notes`, which is no checkpoint", "--overwrite-checkpoint"],
    );
    folder.succeed(&format!("{render} state"));
    let before = folder.read("state");
    folder.fail(
        &format!("{render} state"),
        2,
        &["farther than this render begins", "--resume", "--overwrite-"],
    );
    folder.fail(&format!("{render} state --seed 7"), 2, &["checkpoint of another render", "--overwrite-"]);
    assert!(folder.read("state") == before && folder.read("notes") == b"all I know");
    folder.succeed(&format!("{render} state --resume state"));
    folder.succeed(&format!("{render} state --seed 7 --overwrite-checkpoint"));
    folder.succeed(&format!("{render} notes --overwrite-checkpoint"));
    assert!(folder.read("notes").starts_with(b"kajofilm"));
    folder.write("empty", "");
    folder.succeed(&format!("{render} empty"));
}

#[test]
fn a_checkpoint_is_a_file() {
    let folder = Folder::new();
    folder.pipe("pipe");
    folder.fail("ball.txt --size 4 4 -o a.png --resume pipe", 2, &["`pipe`", "not a regular file"]);
    folder.fail("ball.txt --size 4 4 -o a.png --checkpoint pipe", 5, &["`pipe`", "pipe or a device"]);
}

/// The state is far longer than the picture and than what a file may be here.
#[test]
fn a_checkpoint_that_cannot_be_written_does_not_lose_the_picture() {
    let folder = Folder::new();
    let render = "ball.txt --size 100 100 --samples sobol 16 -o out.png";
    folder.succeed(render);
    let expected = folder.read("out.png");
    std::fs::remove_file(folder.path("out.png")).unwrap();
    let ran =
        folder.run_in_shell("ulimit -f 80", &format!("{render} --checkpoint state --checkpoint-every 0"));
    assert_eq!(ran.code, Some(5), "{}", ran.stderr);
    assert_eq!(ran.stderr.matches("the render goes on and tries again").count(), 1, "{}", ran.stderr);
    let last = ran.stderr.lines().last().unwrap();
    assert!(last.contains("error: cannot write `state`, which needs "), "{}", ran.stderr);
    assert!(folder.read("out.png") == expected);
    assert_eq!(folder.names(), ["ball.txt", "out.png"]);
}

#[test]
fn goals_end_renders() {
    let folder = Folder::new();
    let ran = folder.succeed("ball.txt --size 40 30 --samples uniform 100000 --time 0 -o a.png");
    assert!(ran.stderr.contains(", 1 sample a pixel"), "{}", ran.stderr);
    let ran = folder.succeed("ball.txt --size 40 30 --samples uniform 100000 --noise 0.05 -o a.png");
    assert!(ran.stderr.contains(" samples a pixel, noise 0.0"), "{}", ran.stderr);
    let ran = folder.succeed("ball.txt --size 64 64 --samples sobol 64 --adaptive --layers all -o a.exr");
    assert!(ran.stderr.contains("noise 0."), "{}", ran.stderr);
}

#[test]
fn noise_of_light_from_lamps_counts() {
    let folder = Folder::new();
    let light = "ball.txt --size 40 30 --samples uniform 512 --integrator light -o a.png --noise 0.05";
    let ran = folder.succeed(light);
    assert!(!ran.stderr.contains(", 16 samples a pixel"), "it is noisy at first: {}", ran.stderr);
    let ran = folder.succeed(&format!("{light} --adaptive"));
    assert!(ran.stderr.contains("not by light from lamps; leave out `--adaptive`"), "{}", ran.stderr);
}

#[test]
fn a_render_leaves_its_state_however_it_ends() {
    let folder = Folder::new();
    let first = "ball.txt --size 150 100 --samples sobol 100000 -o a.exr --time 0.3 --checkpoint state";
    folder.succeed(first);
    folder.succeed("ball.txt --size 150 100 --samples sobol 100000 -o a.exr --time 0 --resume state");
    folder.succeed("ball.txt --size 20 20 --samples sobol 64 -o b.exr --checkpoint whole");
    let again = folder.succeed("ball.txt --size 20 20 --samples sobol 64 -o c.exr --resume whole");
    assert!(again.stderr.contains(" 64 samples a pixel, 0 rays"), "nothing is left to do: {}", again.stderr);
    assert!(folder.read("b.exr") == folder.read("c.exr"));
}

#[test]
fn a_time_beyond_all_clocks_is_no_end() {
    Folder::new().succeed("ball.txt --size 20 20 --samples sobol 4 -o a.png --time 1e19");
}

#[test]
fn a_viewer_that_is_not_there_is_a_warning() {
    let folder = Folder::new();
    let listener = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let ran = folder.succeed(&format!("ball.txt --size 20 20 --samples 4 -o a.png --tev {address}"));
    assert!(ran.stderr.contains("is not shown"), "{}", ran.stderr);
}
