//! The commands beside rendering.

mod common;

use common::{BALL, Folder};

#[test]
fn help_and_version_are_answers() {
    let folder = Folder::new();
    for line in ["--help", "-h", "-help", "help", "render --help", "classic --help", "help render"] {
        let ran = folder.succeed(line);
        assert!(ran.stdout.contains("Usage:") && ran.stderr.is_empty(), "{line}: {}", ran.stderr);
    }
    assert!(folder.succeed("--help").stdout.contains("Examples:"));
    assert!(folder.succeed("--version").stdout.starts_with("kajo "));
}

#[test]
fn check_reports_on_every_scene() {
    let folder = Folder::new();
    folder.write("wrong.txt", BALL.replace("Sphere ball", "Sphre ball"));
    assert_eq!(folder.succeed("check ball.txt").stdout, "ball.txt: fine\n");
    let ran = folder.fail("check wrong.txt ball.txt missing.txt --short", 2, &["wrong.txt:9:24: error: "]);
    assert!(ran.stdout.contains("ball.txt: fine") && ran.stderr.contains("missing.txt"), "{}", ran.stderr);
    assert_eq!(folder.names(), ["ball.txt", "wrong.txt"]);
}

#[test]
fn info_tells_what_is_there() {
    let folder = Folder::new();
    let text = folder.succeed("info ball.txt").stdout;
    for part in ["PerspectiveCamera", "lights          1", "spheres", "1 Sphere ball", "2 Plane", "2 floor"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let json = folder.succeed("info ball.txt --json").stdout;
    for part in [
        r#""camera":"PerspectiveCamera""#,
        r#""materials":["gold","floor"]"#,
        r#"{"keyword":"Sphere","name":"ball"}"#,
    ] {
        assert!(json.contains(part), "{part}: {json}");
    }
    folder.fail("info missing.txt", 2, &["no such file"]);
}

#[test]
fn diff_compares_and_fails_on_request() {
    let folder = Folder::new();
    folder.succeed("-input ball.txt -output a.png");
    folder.succeed("-input ball.txt -output b.png -shadows");
    folder.succeed("-input ball.txt -output c.png -size 10 10");
    let same = folder.succeed("diff a.png a.png --share 0").stdout;
    for part in ["MSE      0.0", "FLIP     0.0", "relMSE   0.0", ": 0.0000 % of the pixels"] {
        assert!(same.contains(part), "{part}: {same}");
    }
    let ran = folder.succeed("diff a.png b.png -o d.png");
    assert!(!ran.stdout.contains(": 0.0000 %"), "{}", ran.stdout);
    let difference = common::picture(&folder.path("d.png"));
    assert!(difference.data().iter().any(|&v| v > 0.5), "the shadow is seen");
    folder.fail("diff a.png b.png --share 0.5", 1, &["% of the pixels are off by more than 2/255"]);
    folder.succeed("diff a.png b.png --share 0.5 --max-off 255");
    folder.fail("diff a.png c.png", 2, &["100 x 100", "10 x 10"]);
    folder.fail("diff a.png ball.txt", 2, &["ball.txt"]);
    folder.fail("diff a.png missing.png", 2, &["missing.png"]);
    folder.fail("diff a.png b.png -o a.png", 5, &["choose another name"]);
}

#[test]
fn completions_know_the_options() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.succeed(&format!("completions {shell}")).stdout;
        assert!(script.contains("transparent-shadows") && script.contains("gallery"), "{shell}");
    }
}

#[test]
fn a_gallery_shows_pictures_and_failures() {
    let folder = Folder::new();
    folder.write("scenes/ball.txt", BALL);
    folder.write("scenes/wrong.txt", "Grup {}");
    folder.write(
        "scenes/list.txt",
        "# what the course asks for\n\
         b+ll     ball.txt  -size 20 10 -depth 7 10 @.depth.png -normals @.normals.png\n\
         wrong    wrong.txt\n\
         typo     ball.txt  -szie 20 10\n\
         elsewhere ball.txt -size 4 4 -output other.png\n",
    );
    let ran = folder.fail(
        "gallery scenes/list.txt out/deep",
        2,
        &["2 of 4 pictures failed", "did you mean `-size`"],
    );
    assert!(ran.stderr.contains("1/4 b+ll: 20 x 10"), "{}", ran.stderr);
    let page = String::from_utf8(folder.read("out/deep/index.html")).unwrap();
    for part in
        ["b%2Bll.png", "b%2Bll.depth.png", "b%2Bll.normals.png", "did you mean `Group`", "<h1>scenes</h1>"]
    {
        assert!(page.contains(part), "{part}: {page}");
    }
    for file in ["b+ll.png", "b+ll.depth.png", "b+ll.normals.png"] {
        assert!(folder.path("out/deep").join(file).is_file(), "{file}");
    }
    folder.write("scenes/broken.txt", "ball");
    folder.fail("gallery scenes/broken.txt out", 2, &["line 1: `ball` needs a scene file"]);
    folder.fail("gallery missing.txt out", 2, &["missing.txt"]);
    folder.fail("gallery scenes/list.txt ball.txt", 5, &["ball.txt"]);
}

#[test]
fn the_selftest_measures_what_is_asked_for() {
    let folder = Folder::new();
    let text = folder.succeed("selftest --seed 7 --quick --only S7").stdout;
    for part in ["seed 7;", " pass   S7 clear ball of index 1.5 in even light [path]", "rows pass"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let json = folder.succeed("selftest --seed 7 --quick --only S7 --json").stdout;
    assert!(json.starts_with(r#"{"seed":7,"batches":32,"noise":0.005,"pass":true,"rows":[{"#), "{json}");
    let list = folder.succeed("selftest --list --seed 7").stdout;
    assert!(list.lines().count() > 100 && list.contains("[distribution, uniform]"), "{list}");
    folder.fail("selftest --only nothing", 2, &["--list"]);
}
