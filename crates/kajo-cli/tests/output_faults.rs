//! Files are written whole or not at all, and code 5 says that one could not be written.

mod common;

use std::io::{BufRead, BufReader, Read};

use common::Folder;

#[test]
fn places_that_cannot_be_written_are_found_before_rendering() {
    let folder = Folder::new();
    folder.write("part.txt", "");
    folder.write("scene.txt", format!("{} include \"part.txt\"", common::BALL));
    std::fs::create_dir(folder.path("folder.png")).unwrap();
    // A render of this size would take far longer than the test.
    let huge = "--size 20000 20000 --samples 1000 --memory 1000000";
    folder.fail(&format!("scene.txt -o nowhere/a.png {huge}"), 5, &["no folder `nowhere`"]);
    folder.fail(&format!("scene.txt -o folder.png {huge}"), 5, &["folder.png", "is a folder"]);
    folder.fail("-input scene.txt -output a.png -normals a.png", 5, &["twice"]);
    folder.fail("scene.txt -o a.tga --size 65536 20000 --samples 1000 --memory 1000000", 2, &["65535"]);
    assert_eq!(folder.names(), ["ball.txt", "folder.png", "part.txt", "scene.txt"]);
}

#[test]
fn the_scene_and_its_files_are_not_overwritten() {
    let folder = Folder::new();
    folder.write("mesh.png", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let mesh = "TriangleMesh { obj_file mesh.png }";
    folder.write("scene.png", common::BALL.replace("Sphere ball { center 0 0 0  radius 1 }", mesh));
    let before = (folder.read("scene.png"), folder.read("mesh.png"));
    folder.fail("render scene.png -o scene.png", 5, &["scene was read from it"]);
    folder.fail("render scene.png -o ./mesh.png", 5, &["scene was read from it"]);
    folder.fail("scene.png", 2, &["-o FILE"]);
    assert_eq!((folder.read("scene.png"), folder.read("mesh.png")), before);
}

#[test]
fn a_failed_render_leaves_the_old_file() {
    let folder = Folder::new();
    folder.write("out.png", "old");
    folder.write("wrong.txt", "Grup {}");
    folder.fail("wrong.txt -o out.png", 2, &[]);
    folder.fail("ball.txt -o out.png --size 1000000 1000000", 6, &[]);
    assert_eq!(folder.read("out.png"), b"old");
    folder.succeed("ball.txt -o out.png --size 4 4");
    assert!(folder.read("out.png").starts_with(b"\x89PNG"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_with_the_bytes_needed() {
    let folder = Folder::new();
    folder.fail("ball.txt --size 16 16 -o /dev/full", 5, &["/dev/full", "bytes", "No space left"]);
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let output =
        folder.command().args("ball.txt --size 16 16 -o -".split(' ')).stdout(full).output().unwrap();
    let ran = common::Ran::from(output);
    assert_eq!(ran.code, Some(5), "{}", ran.stderr);
    assert!(ran.stderr.contains("standard output") && ran.stderr.contains("No space left"), "{}", ran.stderr);
}

#[cfg(target_os = "linux")]
#[test]
fn a_pipe_is_written_by_its_name() {
    let folder = Folder::new();
    let output = folder.command().args("ball.txt --size 8 8 -o /dev/stdout".split(' ')).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.starts_with(b"\x89PNG"));
}

#[cfg(unix)]
#[test]
fn a_limit_on_the_size_of_files_leaves_the_old_file_and_no_other() {
    let folder = Folder::new();
    folder.write("out.exr", "old");
    // Blocks of 512 or 1024 bytes, by the shell; the picture has many more.
    let script = format!(
        "ulimit -f 4; exec {} ball.txt --size 200 200 --samples 1 -o out.exr",
        env!("CARGO_BIN_EXE_kajo")
    );
    let mut shell = std::process::Command::new("sh");
    let ran = common::Ran::from(shell.arg("-c").arg(script).current_dir(folder.path("")).output().unwrap());
    assert_eq!(ran.code, Some(5), "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stderr.contains("cannot write `out.exr`, which needs "), "{}", ran.stderr);
    assert_eq!(folder.read("out.exr"), b"old");
    assert_eq!(folder.names(), ["ball.txt", "out.exr"]);
}

/// What a render that ends does when it cannot be written, its folder having gone meanwhile.
#[cfg(unix)]
#[test]
fn a_finished_picture_is_put_elsewhere_when_its_folder_is_gone() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("renders")).unwrap();
    let line = "ball.txt -o renders/out.png --aov depth=depth.png --size 20 20 --samples sobol 1000000 --time 1 --show_progress";
    let mut child =
        folder.command().args(line.split(' ')).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    stderr.read_line(&mut said).unwrap();
    std::fs::remove_dir_all(folder.path("renders")).unwrap();
    stderr.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(5), "{said}");
    let (_, after) = said.split_once("; it is in `").unwrap_or_else(|| panic!("{said}"));
    let place = after.split('`').next().unwrap();
    assert!(place.starts_with("out.kajo-") && place.ends_with(".png"), "{said}");
    assert_eq!(common::picture(&folder.path(place)).width(), 20);
    assert!(folder.path("depth.png").exists(), "the other picture is written all the same");
}

#[cfg(unix)]
#[test]
fn a_picture_that_fits_nowhere_does_not_keep_others_from_being_written() {
    let folder = Folder::new();
    let line = "ball.txt --size 200 200 --samples 1 -o out.exr --aov object=small.png";
    let ran = folder.run_in_shell("ulimit -f 40", line);
    assert_eq!(ran.code, Some(5), "{}", ran.stderr);
    assert!(ran.stderr.contains("nor can any other folder take it"), "{}", ran.stderr);
    assert_eq!(folder.names(), ["ball.txt", "small.png"]);
}

/// Runs a script in which anything can be mounted; `None` where the system does not let one.
#[cfg(target_os = "linux")]
fn with_mounts(folder: &Folder, script: &str) -> Option<common::Ran> {
    let unshare = |script: &str| {
        let mut command = std::process::Command::new("unshare");
        command.args(["-Urm", "sh", "-c", script]).current_dir(folder.path("")).env("NO_COLOR", "1");
        command.env("KAJO", env!("CARGO_BIN_EXE_kajo")).output().ok().map(common::Ran::from)
    };
    let may_mount =
        unshare("mkdir probe; mount -t tmpfs -o size=4k none probe").is_some_and(|ran| ran.code == Some(0));
    if !may_mount {
        println!("skipped: nothing can be mounted here");
        return None;
    }
    unshare(script)
}

#[cfg(target_os = "linux")]
#[test]
fn a_mounted_file_is_found_before_rendering() {
    let folder = Folder::new();
    folder.write("real.png", "old");
    folder.write("out.png", "");
    let huge = "--size 20000 20000 --samples 1000 --memory 1000000";
    let script = format!("mount --bind real.png out.png && exec $KAJO ball.txt -o out.png {huge}");
    let Some(ran) = with_mounts(&folder, &script) else { return };
    assert_eq!(ran.code, Some(5), "{}", ran.stderr);
    assert!(ran.stderr.contains("`out.png`: it is mounted there"), "{}", ran.stderr);
    assert_eq!(folder.read("real.png"), b"old");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_does_not_lose_the_picture() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("small")).unwrap();
    let script = "mount -t tmpfs -o size=16k none small; echo old > small/out.exr
        $KAJO ball.txt -o small/out.exr --size 200 200 --samples 1; echo code $?; cat small/out.exr; ls -A small";
    let Some(ran) = with_mounts(&folder, script) else { return };
    assert_eq!(ran.stdout, "code 5\nold\nout.exr\n", "{}", ran.stderr);
    for part in ["No space left", "trying again", "bytes", "; it is in `out.kajo-"] {
        assert!(ran.stderr.contains(part), "{part}: {}", ran.stderr);
    }
    assert!(folder.names().iter().any(|name| name.starts_with("out.kajo-") && name.ends_with(".exr")));
}

/// Neither the picture's folder nor any other has room, until somebody makes some.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_waits_for_room() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("small")).unwrap();
    let script = "mount -t tmpfs -o size=400k none small; cp ball.txt small; cd small
        head -c 1000000 /dev/zero > filler 2> ../full
        TMPDIR=$PWD $KAJO ball.txt -o out.exr --size 200 200 --samples 1 2> ../said & kajo=$!
        while kill -0 $kajo && ! grep -q minute ../said; do sleep 0.1; done
        rm filler; wait $kajo; ls *.exr | wc -l";
    let Some(ran) = with_mounts(&folder, script) else { return };
    let said = String::from_utf8(folder.read("said")).unwrap();
    assert!(said.contains("No space left") && said.contains("trying for another minute"), "{said}");
    assert_eq!(ran.stdout.trim(), "1", "{said}{}", ran.stderr);
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_found_before_rendering() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    std::fs::create_dir(folder.path("locked")).unwrap();
    std::fs::set_permissions(folder.path("locked"), std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(folder.path("locked/probe"), "").is_ok() {
        println!("skipped: this user may write anywhere");
        return;
    }
    folder.fail("ball.txt -o locked/out.png", 5, &["locked/out.png"]);
}

#[cfg(unix)]
#[test]
fn a_write_protected_file_is_kept() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    folder.write("out.png", "old");
    std::fs::set_permissions(folder.path("out.png"), std::fs::Permissions::from_mode(0o444)).unwrap();
    folder.fail("ball.txt --size 4 4 -o out.png", 5, &["write-protected"]);
    assert_eq!(folder.read("out.png"), b"old");
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_panic() {
    let folder = Folder::new();
    let kajo = env!("CARGO_BIN_EXE_kajo");
    for line in ["info ball.txt", "--help", "completions bash", "check ball.txt"] {
        let script = format!("{{ {kajo} {line}; echo \"code $?\" >&2; }} | true");
        let mut shell = std::process::Command::new("sh");
        let ran =
            common::Ran::from(shell.arg("-c").arg(script).current_dir(folder.path("")).output().unwrap());
        assert!(ran.stderr.contains("code 0"), "{line}: {}", ran.stderr);
        assert!(!ran.stderr.contains("panic") && !ran.stderr.contains("bug"), "{line}: {}", ran.stderr);
    }
}
