//! Renders by many workers, as people run them: plans, units, merges, worker processes, and what kills them.

mod common;

use std::fs;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use common::Folder;

/// A small picture of several layers, and how it is cut.
const RENDER: &str =
    "ball.txt --size 64 48 --samples sobol 8 --integrator distribution --layers color,depth,normals";
const UNITS: &str = "--unit-tile 24 --unit-samples 3";

/// A folder with the picture of a plain render.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.succeed(&format!("render {RENDER} -o plain.exr"));
    folder
}

fn plan(folder: &Folder) -> u64 {
    let planned = folder.succeed(&format!("plan {RENDER} {UNITS} -o out.exr --job job --count"));
    planned.stdout.trim().parse().unwrap()
}

#[test]
fn units_of_a_plan_make_the_picture_of_a_plain_render() {
    let folder = folder();
    let units = plan(&folder);
    assert_eq!(units, 3 * 2 * 3);
    folder.fail("merge job", 3, &["18 of 18 units", "missing"]);
    folder.succeed("unit --job job --index 0");
    folder.succeed("unit --job job --index 0");
    folder.succeed("unit --job job --index 4 --of 5");
    folder.fail("unit --job job --index 18", 2, &["from 0 to 17"]);
    // Finished work is not planned away.
    let planned = folder.succeed(&format!("plan {RENDER} {UNITS} -o out.exr --job job"));
    assert!(planned.stdout.contains("4 of them finished"), "{}", planned.stdout);
    (0..4)
        .for_each(|share| _ = folder.succeed(&format!("unit --job job --index {share} --of 4 --threads 1")));
    folder.succeed("merge job");
    folder.succeed("merge job -o again.exr --quiet");
    let plain = folder.read("plain.exr");
    assert!(folder.read("out.exr") == plain && folder.read("again.exr") == plain);
    folder.fail("merge job -o again.png", 2, &["another format"]);
}

#[test]
fn worker_processes_make_the_picture_of_a_plain_render() {
    let folder = folder();
    for workers in [1, 2, 7] {
        folder.succeed(&format!("render {RENDER} {UNITS} -o out.exr --farm local:{workers}"));
        assert!(folder.read("out.exr") == folder.read("plain.exr"), "{workers} workers");
        fs::remove_file(folder.path("out.exr")).unwrap();
        assert!(!folder.path("out.exr.job").exists(), "the folder of a job that is over is gone");
    }
}

#[test]
fn goals_and_splats_can_be_shared() {
    let folder = Folder::new();
    for (i, options) in [
        "--samples sobol 24 --adaptive --integrator path",
        "--samples sobol 4096 --noise 0.2 --integrator path",
        "--samples sobol 5 --integrator bidirectional --aov variance",
    ]
    .into_iter()
    .enumerate()
    {
        let render = format!("ball.txt --size 40 30 {options}");
        folder.succeed(&format!("render {render} -o plain{i}.exr"));
        folder.succeed(&format!("render {render} -o out{i}.exr --farm local:2 --unit-samples 16"));
        assert!(folder.read(&format!("out{i}.exr")) == folder.read(&format!("plain{i}.exr")), "{options}");
    }
    // A goal has stages: each is planned by what the one before it showed.
    let render = "ball.txt --size 40 30 --samples sobol 24 --adaptive --integrator path";
    folder.succeed(&format!("plan {render} -o staged.exr --job job"));
    folder.succeed("unit --job job --index 0 --of 1");
    folder.fail("merge job", 3, &["units of stage 1 can be rendered now"]);
    folder.succeed("unit --job job --index 0 --of 1");
    folder.succeed("merge job");
    assert!(folder.read("staged.exr") == folder.read("plain0.exr"));
}

#[test]
fn what_cannot_be_shared_is_said() {
    let folder = Folder::new();
    for (options, said) in [
        ("--time 5", "no common one"),
        ("--checkpoint state", "takes the place of checkpoints"),
        ("--tev", "viewer"),
        ("-o -", "name it with -o FILE"),
        ("--farm head:1", "expected local:N"),
        ("--farm tls://head", "expected tls://HOST:PORT"),
        ("--farm tcp://:1", "expected tcp://HOST:PORT"),
        ("--preview out.txt", "names no format of pictures"),
        ("--farm local:0", "expected local:N"),
    ] {
        folder.fail(&format!("render ball.txt --size 8 8 --farm local:1 {options}"), 2, &[said]);
    }
    folder.fail("merge nowhere", 2, &["no plan in `nowhere`"]);
    folder.fail("unit --job nowhere --index 0", 2, &["no plan in `nowhere`"]);
    folder.write("job/plan.json", "{");
    folder.fail("merge job", 2, &["no plan of kajo"]);
}

#[test]
fn other_programs_and_changed_files_are_refused() {
    let folder = folder();
    plan(&folder);
    let text = String::from_utf8(folder.read("job/plan.json")).unwrap();
    assert!(text.contains("determinism epoch 1"));
    folder.write("job/plan.json", text.replace("determinism epoch 1", "determinism epoch 0"));
    folder.fail("unit --job job --index 0", 2, &["epoch 0", "epoch 1", "take the same version"]);
    folder.write("job/plan.json", &text);
    folder.write("ball.txt", common::BALL.replace("radius 1", "radius 1.01"));
    folder.fail("unit --job job --index 0", 2, &["ball.txt` has changed since the plan was made"]);
    folder.fail(&format!("plan {RENDER} {UNITS} -o out.exr --job job"), 2, &["belongs to another render"]);
    folder.write("ball.txt", common::BALL);
    folder.succeed("unit --job job --index 0");
    fs::remove_file(folder.path("ball.txt")).unwrap();
    folder.fail("unit --job job --index 1", 2, &["cannot be read"]);
}

#[test]
fn a_bundle_takes_the_place_of_the_files() {
    let folder = folder();
    folder.write("scene.txt", "include \"ball.txt\"");
    folder.succeed("bundle scene.txt -o s.kbundle");
    folder.succeed(&format!("render {} -o direct.exr", RENDER.replace("ball.txt", "s.kbundle")));
    assert!(folder.read("direct.exr") == folder.read("plain.exr"));
    fs::remove_file(folder.path("ball.txt")).unwrap();
    let render = RENDER.replace("ball.txt", "s.kbundle");
    folder.succeed(&format!("render {render} {UNITS} -o out.exr --farm local:2"));
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
    let mut bytes = folder.read("s.kbundle");
    bytes[60] ^= 1;
    folder.write("s.kbundle", bytes);
    folder.fail(&format!("render {render} -o out.exr"), 2, &["bundle is damaged"]);
    folder.fail("bundle nothing.txt", 2, &["no such file"]);
}

#[test]
fn a_full_disk_loses_nothing() {
    let folder = folder();
    let line = format!("render {RENDER} {UNITS} -o out.exr --farm local:1 --job job");
    // The plan and small files fit, sums of pictures do not.
    let ran = folder.run_in_shell("ulimit -f 16", &line);
    assert_eq!(ran.code, Some(5), "{}", ran.stderr);
    assert!(ran.stderr.contains("job"), "{}", ran.stderr);
    folder.succeed(&line);
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
    assert!(folder.path("job").exists(), "a folder that somebody named stays");
}

/// Processes whose parent is this one.
#[cfg(target_os = "linux")]
fn children_of(parent: u32) -> Vec<u32> {
    let path = format!("/proc/{parent}/task/{parent}/children");
    let of_thread = |entry: fs::DirEntry| fs::read_to_string(entry.path().join("children")).ok();
    let mut all = fs::read_to_string(path).unwrap_or_default();
    if let Ok(threads) = fs::read_dir(format!("/proc/{parent}/task")) {
        all.extend(threads.flatten().filter_map(of_thread));
    }
    let mut children: Vec<u32> = all.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    children.sort_unstable();
    children.dedup();
    children
}

/// Kills workers and coordinators at times that look random, and runs the same command until it succeeds.
#[cfg(target_os = "linux")]
#[test]
fn whatever_is_killed_the_same_command_goes_on() {
    let kills = if std::env::var_os("KAJO_DEEP").is_some() { 500 } else { 12 };
    let folder = Folder::new();
    let render = "ball.txt --size 150 100 --samples sobol 64 --integrator distribution";
    folder.succeed(&format!("render {render} -o plain.exr"));
    let line = format!("render {render} -o out.exr --farm local:2 --unit-tile 50 --unit-samples 4 --job job");
    let mut finished = 0;
    for i in 0..kills {
        let mut coordinator = folder
            .command()
            .args(line.split(' '))
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let wait = 30 + u64::from(u32::wrapping_mul(i, 2_654_435_761) >> 23);
        thread::sleep(Duration::from_millis(wait));
        let workers = children_of(coordinator.id());
        if let (0, Some(worker)) = (i % 3, workers.first()) {
            let kill = format!("kill -9 {worker}");
            let _ = std::process::Command::new("sh").arg("-c").arg(kill).stderr(Stdio::null()).status();
            thread::sleep(Duration::from_millis(wait));
        }
        // It may be complete already.
        let _ = coordinator.kill();
        finished += u32::from(coordinator.wait().unwrap().success());
        if finished > 0 && folder.path("out.exr").exists() {
            fs::remove_file(folder.path("out.exr")).unwrap();
        }
    }
    println!("{finished} of {kills} came to their end");
    folder.succeed(&line);
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
}

/// A stand-in for Slurm that runs everything at once, in order.
#[cfg(unix)]
#[test]
fn the_batch_script_renders_the_picture() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    folder.write(
        "bin/sbatch",
        "#!/bin/bash\nfor word; do case $word in --array=*) range=${word#--array=0-};; esac; script=$word; done\n\
         if [ -n \"${range:-}\" ]; then for i in $(seq 0 $range); do SLURM_ARRAY_TASK_ID=$i bash \"$script\" >&2; done\n\
         else bash \"$script\" >&2; fi\necho \"7;cluster\"\n",
    );
    fs::set_permissions(folder.path("bin/sbatch"), fs::Permissions::from_mode(0o755)).unwrap();
    let missing = folder.run("farm slurm nothing.txt -o out.exr --array 3");
    assert_eq!((missing.code, &*missing.stdout), (Some(2), ""), "{}", missing.stderr);
    assert!(missing.stderr.contains("cannot read `nothing.txt`"), "{}", missing.stderr);
    let script = folder.succeed(&format!("farm slurm {RENDER} {UNITS} -o out.exr --array 3")).stdout;
    folder.write("script.sh", &script);
    let path = format!("{}:{}", folder.path("bin").display(), std::env::var("PATH").unwrap());
    let mut bash = std::process::Command::new("bash");
    let ran =
        bash.arg(folder.path("script.sh")).current_dir(folder.path("")).env("PATH", path).output().unwrap();
    assert!(ran.status.success(), "{}{}", script, String::from_utf8_lossy(&ran.stderr));
    assert!(folder.read("out.exr") == folder.read("plain.exr"));
}
