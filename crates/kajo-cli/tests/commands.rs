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
fn help_explains_blocks_of_the_language() {
    let folder = Folder::new();
    let all = folder.succeed("help").stdout;
    assert!(all.contains("Usage:") && all.contains("    Principled  "), "{all}");
    let table = folder.succeed("help Principled").stdout;
    for part in ["field ", "  coatRoughness ", "number from 0 to 1, or a ", "  0.5 "] {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(folder.succeed("help bench rays").stdout.contains("Usage: kajo bench rays"));
    folder.fail(
        "help Principeld",
        2,
        &["no command and no block `Principeld`", "did you mean `Principled`?"],
    );
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
         elsewhere ball.txt -size 4 4 -output @.other.png\n",
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
fn a_list_from_a_stranger_is_kept_in_its_place() {
    let folder = Folder::new();
    folder.write("lists/ball.txt", BALL);
    folder.write("lists/needs_more.txt", "include \"../ball.txt\"");
    let absolute = folder.path("x.png").to_string_lossy().into_owned();
    std::fs::create_dir(folder.path("out")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.path("lists"), folder.path("out/link")).unwrap();
    let viewer = std::net::TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let tev = format!("ball.txt render --size 4 4 --tev {}", viewer.local_addr().unwrap());
    let outside = "the only folder that the list may write to";
    let command_line = "belongs to the command line of `kajo gallery`";
    for (line, said) in [
        (format!("ball.txt -size 4 4 -output {absolute}"), outside),
        ("ball.txt -size 4 4 -output x.png".to_owned(), outside),
        ("ball.txt -size 4 4 -normals @/../../x.png".to_owned(), ""),
        ("ball.txt -size 4 4 -normals out/../x.png".to_owned(), outside),
        ("ball.txt render --size 4 4 --aov depth=lists/x.png".to_owned(), outside),
        ("ball.txt render --size 4 4 --checkpoint state".to_owned(), outside),
        (
            "ball.txt render --size 4 4 --resume ball.txt".to_owned(),
            "there is no checkpoint `ball.txt` in `out`",
        ),
        ("ball.txt render -o -".to_owned(), "standard output"),
        ("ball.txt render -o /dev/null".to_owned(), outside),
        ("needs_more.txt render --allow-outside".to_owned(), command_line),
        ("needs_more.txt render --assets ..".to_owned(), command_line),
        ("needs_more.txt".to_owned(), "outside the scene's folder"),
        ("ball.txt -size 4 4 -memory 100000".to_owned(), command_line),
        (tev, "opens a connection"),
        ("../ball.txt -size 4 4".to_owned(), "outside the list's folder"),
        ("/etc/passwd -size 4 4".to_owned(), "outside the list's folder"),
        ("ball.txt -size 4 4 -input ball.txt".to_owned(), "one scene"),
        #[cfg(unix)]
        ("ball.txt -size 4 4 -output out/link/x.png".to_owned(), outside),
    ] {
        folder.write("lists/list.txt", format!("bad {line}\n"));
        let ran = folder.run("gallery lists/list.txt out -q");
        assert!(ran.code.is_some_and(|code| code == 2 || code == 5), "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{line}: {}", ran.stderr);
        assert_eq!(folder.names(), ["ball.txt", "lists", "out"], "{line}");
    }
    viewer.set_nonblocking(true).unwrap();
    assert!(viewer.accept().is_err(), "nobody has connected");
    let written = std::fs::read_dir(folder.path("lists")).unwrap().count();
    assert_eq!(written, 3, "ball.txt, needs_more.txt, list.txt");

    folder.write(
        "lists/list.txt",
        "a ../ball.txt render --size 4 4 --checkpoint @.state --aov depth=@.depth.png\n",
    );
    folder.succeed("gallery lists/list.txt out --allow-outside");
    folder.write("lists/list.txt", "b needs_more.txt -size 4 4\n");
    folder.succeed("gallery lists/list.txt out --assets .");
    for name in ["a.png", "a.state", "a.depth.png", "b.png"] {
        assert!(folder.path("out").join(name).exists(), "{name}");
    }
}

#[test]
fn a_quiet_gallery_still_says_what_is_wrong() {
    let folder = Folder::new();
    folder.write("wrong.txt", "Grup {}");
    folder.write("list.txt", "a ball.txt -size 4 4\nb wrong.txt\nc ball.txt -size 4 4 -specular_fix\n");
    let ran = folder.fail("gallery list.txt out -q", 2, &["did you mean `Group`", "1 of 3 pictures failed"]);
    assert!(ran.stderr.contains("warning: `-specular_fix` works"), "{}", ran.stderr);
    assert!(!ran.stderr.contains("1/3 a"), "{}", ran.stderr);
}

/// What terminals obey is in names and texts of files, and what is said quotes them.
#[test]
fn control_characters_of_files_never_reach_the_terminal() {
    let folder = Folder::new();
    let evil = "x\u{1b}[2J\u{1b}]0;t\u{7}\u{9b}31m\u{202e}";
    let named =
        BALL.replace("Sphere ball", &format!("Sphere \"{evil}\"")).replace("gold", &format!("\"{evil}\""));
    folder.write("named.txt", &named);
    folder.write("wrong.txt", BALL.replace("radius 1", &format!("radius {evil}")));
    folder.write("list.txt", format!("a ball.txt \"-{evil}\"\n\"b{evil}\" ball.txt\n"));
    folder.write(&format!("{evil}.txt"), BALL);
    let mut state = b"kajofilm\x01\0\0\0\x08\0\0\0evil\x1b[2J".to_vec();
    state.extend([0; 40]);
    folder.write("state", state);
    let odd = format!("{evil}.txt");
    for line in [
        &["info", "named.txt"][..],
        &["info", "--json", "named.txt"],
        &["check", "named.txt", "wrong.txt", &odd],
        &["check", "--short", "wrong.txt"],
        &["wrong.txt"],
        &["gallery", "list.txt", "out"],
        &["ball.txt", "-o", "a.png", "--resume", "state", "--size", "4", "4"],
        &["render", &odd, "--size", "4", "4"],
        &["diff", &odd, &odd],
        &[&odd, &odd],
    ] {
        let ran = common::Ran::from(folder.command().args(line).output().unwrap());
        for text in [&ran.stdout, &ran.stderr] {
            let found = text.chars().find(|&c| c.is_control() && c != '\n' || c == '\u{202e}');
            assert_eq!(found, None, "{line:?}: {text:?}");
        }
        assert!(ran.stdout.len() + ran.stderr.len() > 0, "{line:?}");
    }
}

#[test]
fn the_selftest_measures_what_is_asked_for() {
    let folder = Folder::new();
    let text = folder.succeed("selftest --seed 7 --quick --only absorber").stdout;
    for part in ["seed 7;", " pass   S9 absorber of 1.739 over a chord at -0.292 [path]", "rows pass"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let json = folder.succeed("selftest --seed 7 --quick --only absorber --json").stdout;
    assert!(json.starts_with(r#"{"seed":7,"batches":32,"noise":0.005,"pass":true,"rows":[{"#), "{json}");
    let list = folder.succeed("selftest --list --seed 7").stdout;
    assert!(list.lines().count() > 100 && list.contains("[distribution, uniform]"), "{list}");
    folder.fail("selftest --only nothing", 2, &["--list"]);
}
