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
    folder.fail(
        "render scene.png -o scene.png",
        5,
        &["cannot write `scene.png`: it is `scene.png`, which is read"],
    );
    folder.fail(
        "render scene.png -o ./mesh.png",
        5,
        &["cannot write `./mesh.png`: it is `mesh.png`, which is read"],
    );
    folder.fail("scene.png", 2, &["-o FILE"]);
    assert_eq!((folder.read("scene.png"), folder.read("mesh.png")), before);
}

/// Names under which a file of the folder can be reached.
fn names_of(folder: &Folder, file: &str) -> Vec<String> {
    let mut names = vec![file.to_owned(), format!("./{file}"), format!("sub/../{file}")];
    std::fs::create_dir_all(folder.path("sub")).unwrap();
    #[cfg(unix)]
    {
        let ending = std::path::Path::new(file).extension().unwrap().to_str().unwrap();
        let [symbolic, hard] = ["symbolic", "hard"].map(|kind| format!("{kind}.{ending}"));
        let _ = std::fs::remove_file(folder.path(&symbolic));
        let _ = std::fs::remove_file(folder.path(&hard));
        std::os::unix::fs::symlink(file, folder.path(&symbolic)).unwrap();
        std::fs::hard_link(folder.path(file), folder.path(&hard)).unwrap();
        names.extend([symbolic, hard]);
    }
    names
}

/// Runs the program with each name of a file where `OUT` stands, and makes sure that it is refused and nothing changes.
fn keeps(folder: &Folder, file: &str, line: &str) {
    for name in names_of(folder, file) {
        let before = (folder.names(), folder.read(file));
        let said = [&*format!("cannot write `{name}`: it is `{file}`, which is read")];
        folder.fail(&line.replace("OUT", &name), 5, &said);
        assert!((folder.names(), folder.read(file)) == before, "{line}: {name}");
    }
}

#[test]
fn a_checkpoint_is_not_replaced_by_a_picture() {
    let folder = Folder::new();
    let render = "ball.txt --size 8 8 --samples sobol 4";
    folder.succeed(&format!("{render} -o out.png --checkpoint state.png"));
    keeps(&folder, "state.png", &format!("{render} --resume state.png -o OUT"));
    keeps(&folder, "state.png", &format!("{render} --resume state.png -o out.png --aov depth=OUT"));
    folder.succeed(&format!("{render} --resume state.png -o out.png --checkpoint ./state.png"));
}

#[test]
fn a_model_and_its_files_are_not_replaced_by_its_scene() {
    let folder = Folder::new();
    folder.write("skin.ppm", "P3 1 1 255 255 0 0\n");
    folder.write("paint.mtl", "newmtl red\nKd 1 0 0\nmap_Kd skin.ppm\n");
    folder.write(
        "thing.obj",
        "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3\n",
    );
    let floats = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat();
    folder.write("points.bin", floats);
    folder.write(
        "leaf.gltf",
        r#"{ "asset": { "version": "2.0" }, "scenes": [ { "nodes": [0] } ], "nodes": [ { "mesh": 0 } ],
        "meshes": [ { "primitives": [ { "attributes": { "POSITION": 0 } } ] } ],
        "accessors": [ { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" } ],
        "bufferViews": [ { "buffer": 0, "byteLength": 36 } ],
        "buffers": [ { "uri": "points.bin", "byteLength": 36 } ] }"#,
    );
    folder.succeed("leaf.gltf --size 4 4 --samples 1 -o leaf.png");
    for (model, files) in [
        ("thing.obj", &["thing.obj", "paint.mtl", "skin.ppm"][..]),
        ("leaf.gltf", &["leaf.gltf", "points.bin"]),
    ] {
        for file in files {
            keeps(&folder, file, &format!("convert {model} OUT --force"));
            keeps(&folder, file, &format!("convert {model} OUT"));
        }
        folder.write("scene.txt", "old");
        folder.succeed(&format!("convert {model} scene.txt --force"));
    }
}

#[test]
fn compared_pictures_are_not_replaced_by_their_difference() {
    let folder = Folder::new();
    folder.succeed("ball.txt --size 8 8 --samples 1 -o a.png");
    folder.succeed("ball.txt --size 8 8 --samples 1 -o b.png --bounces 0");
    keeps(&folder, "a.png", "diff a.png b.png -o OUT");
    keeps(&folder, "b.png", "diff a.png b.png -o OUT");
}

#[test]
fn a_list_and_its_scenes_are_not_replaced_by_pictures() {
    let folder = Folder::new();
    folder.write("scene.png", common::BALL);
    folder.write("index.html", "a ball.txt -size 4 4\n");
    folder.fail("gallery index.html .", 5, &["it is `index.html`, which is read"]);
    folder.write("list.txt", "scene ball.txt -size 4 4\nother scene.png -size 4 4\n");
    folder.fail("gallery list.txt .", 5, &["1 of 2 pictures failed", "it is `scene.png`, which is read"]);
    assert!(folder.read("scene.png") == common::BALL.as_bytes());
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
