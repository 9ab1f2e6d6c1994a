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
        assert_eq!(compression(&folder.read("out.exr")), 1, "runs of equal bytes");
    }
    folder.succeed(&format!("{RENDER} --resume state --threads 1 --tile 20"));
    assert_eq!(compression(&folder.read("out.exr")), 3, "ZIP, as always");
    assert!(folder.read("out.exr") == expected(RENDER));
}

/// The number of an OpenEXR file's kind of compression.
fn compression(file: &[u8]) -> u8 {
    let attribute = b"compression\0compression\0\x01\0\0\0";
    let at = file.windows(attribute.len()).position(|bytes| bytes == attribute).unwrap();
    file[at + attribute.len()]
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

/// What an option is to a render that goes on.
enum Role {
    /// It decides bits of the picture: the checkpoint of a render with the first words is refused by one that has the second
    /// ones as well.
    Decides(&'static str, &'static str),
    /// It decides bits of the picture of a model without a scene.
    DecidesOfModel(&'static str),
    /// A render with these words goes on to the picture of one that had them all along, for this reason.
    Harmless(&'static str, &'static str),
    /// A render with these words has no checkpoints, and says so with the second ones.
    Refused(&'static str, &'static str),
}

use Role::{Decides, DecidesOfModel, Harmless, Refused};

/// Every option of `kajo render`.
const ROLES: [(&str, Role); 79] = [
    ("output", Harmless("-o other.exr", "where the picture goes")),
    ("size", Decides("", "--size 21 14")),
    ("crop", Decides("", "--crop 1 1 5 5")),
    ("aov", Decides("", "--aov depth")),
    ("layers", Decides("", "--layers color,normals")),
    ("depth-range", Decides("--aov depth=depth.png", "--depth-range 1 9")),
    ("bits", Harmless("--bits 16", "of a PNG file, made of the film when it is finished")),
    ("samples", Decides("", "--samples uniform 8")),
    ("filter", Decides("", "--filter tent 2")),
    ("seed", Decides("", "--seed 3")),
    ("integrator", Decides("", "--integrator direct")),
    ("spectral", Decides("--integrator path", "--spectral on")),
    ("bounces", Decides("", "--bounces 2")),
    ("weight", Decides("", "--weight 0.25")),
    ("shadows", Decides("", "--shadows off")),
    ("transparent-shadows", Decides("", "--transparent-shadows surface")),
    ("shade-back", Decides("", "--shade-back on")),
    ("fresnel", Decides("", "--fresnel on")),
    ("total-reflection", Decides("", "--total-reflection on")),
    ("ray-offset", Decides("", "--ray-offset reference")),
    ("branches", Decides("--integrator distribution", "--branches 3")),
    ("guiding", Decides("--integrator path", "--guiding on")),
    ("training", Decides("--integrator path --guiding on", "--training 9")),
    ("photons", Decides("--integrator sppm", "--photons 500")),
    ("photon-map", Decides("--integrator photon", "--photon-map direct")),
    ("merging", Decides("--integrator vcm", "--merging off")),
    ("merge-radius", Decides("--integrator vcm", "--merge-radius 0.2")),
    ("merge-alpha", Decides("--integrator vcm", "--merge-alpha 0.5")),
    ("accuracy", Decides("--integrator irradiance", "--accuracy 0.5")),
    ("rays", Decides("--integrator irradiance", "--rays 100")),
    ("gradients", Decides("--integrator irradiance", "--gradients off")),
    ("show-records", Decides("--integrator irradiance", "--show-records on")),
    ("directions", Decides("--integrator path", "--directions uniform")),
    ("technique", Decides("--integrator path", "--technique lights")),
    ("caustics", Decides("--integrator path", "--caustics manifold")),
    ("light-choice", Decides("--integrator path", "--light-choice uniform")),
    ("roulette", Decides("--integrator path", "--roulette off")),
    ("clamp", Decides("--integrator path", "--clamp 3")),
    ("reach", Decides("--integrator occlusion", "--reach 2")),
    ("frames", Decides("", "--frames 3")),
    ("fps", Decides("--frames 3", "--fps 30")),
    ("keep-frames", Harmless("", "a picture that is kept is not rendered")),
    ("denoise", Decides("", "--denoise builtin")),
    ("exposure", Harmless("--exposure 1", "how the finished light is developed")),
    ("white-balance", Harmless("--white-balance 5000", "how the finished light is developed")),
    ("tone", Harmless("--tone aces", "how the finished light is developed")),
    ("gamut", Harmless("--gamut rec2020", "how the finished light is developed")),
    ("time", Harmless("--time 1000", "how long it goes on")),
    ("noise", Decides("", "--noise 0.001")),
    ("adaptive", Decides("", "--adaptive")),
    ("checkpoint", Harmless("--checkpoint other.state", "where the state goes")),
    (
        "overwrite-checkpoint",
        Harmless("--checkpoint other --overwrite-checkpoint", "whether it may go there"),
    ),
    ("checkpoint-every", Harmless("--checkpoint-every 0", "how often it goes there")),
    ("resume", Harmless("", "each of these renders has it")),
    ("texture-filter", Decides("", "--texture-filter ewa")),
    ("texture-folder", Harmless("--texture-folder tiles", "where copies are kept")),
    ("texture-memory", Harmless("--texture-memory 1 --texture-folder tiles", "the same texels")),
    ("tev", Harmless("--tev 127.0.0.1:1", "a viewer")),
    ("dialect", Decides("", "--dialect mit-2004")),
    ("assets", Harmless("--assets .", "where files are found; what they hold is in the digest of the scene")),
    ("allow-outside", Harmless("--allow-outside", "where files are found, too")),
    ("camera", Decides("", "--camera wide")),
    ("up", DecidesOfModel("--up -z")),
    ("ground", DecidesOfModel("--ground")),
    ("threads", Harmless("--threads 3", "a picture has the same bits for any number")),
    ("tile", Harmless("--tile 5", "a picture has the same bits for any tiles")),
    ("memory", Harmless("--memory 1000", "a bound")),
    ("quiet", Harmless("--quiet", "what is said")),
    ("stats", Harmless("--stats", "what is said")),
    ("show-progress", Harmless("--show-progress", "what is said")),
    ("keep-partial", Harmless("--keep-partial", "what is written when it is interrupted")),
    ("farm", Refused("--farm local:1", "which takes the place of checkpoints")),
    ("job", Refused("--job other.job", "`--job` is for renders by many workers")),
    ("farm-config", Refused("--farm-config folder", "`--farm-config` is for renders by many workers")),
    ("preview", Refused("--preview p.png", "`--preview` is for renders by many workers")),
    ("preview-every", Harmless("--preview-every 5", "how often the picture so far is written")),
    ("unit-tile", Refused("--unit-tile 8", "`--unit-tile` is for renders by many workers")),
    ("unit-samples", Refused("--unit-samples 2", "`--unit-samples` is for renders by many workers")),
    ("help", Harmless("", "no render")),
];

/// A new option fails here until somebody has said what it is to a checkpoint.
#[test]
fn every_option_that_decides_bits_is_in_the_identity_of_a_checkpoint() {
    let folder = Folder::new();
    let help = folder.succeed("render --help").stdout;
    let is_option = |word: &&str| word.starts_with("--") && word.len() > 2;
    let first_words = help.lines().filter(|line| line.trim_start().starts_with('-'));
    let mut options: Vec<&str> = first_words
        .filter_map(|line| line.split([' ', '[', '=']).find(is_option))
        .map(|word| word.trim_start_matches('-'))
        .collect();
    let mut known: Vec<&str> = ROLES.iter().map(|&(option, _)| option).collect();
    options.sort_unstable();
    known.sort_unstable();
    assert_eq!(options, known, "each has its line in this test");

    // Two cameras in one place, of which one has a lens.
    let lens = "aperture 0.5 focus 8";
    let [sharp, wide] = ["sharp {", &*format!("wide {{ {lens}")]
        .map(|begin| common::BALL.lines().next().unwrap().replace('{', begin));
    folder.write(
        "two.txt",
        common::BALL.replace(common::BALL.lines().next().unwrap(), &format!("{wide}\n{sharp}")),
    );
    folder.write("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    let render = |scene: &str| format!("{scene} --size 20 14 --samples sobol 8 -o {scene}.exr --threads 2");
    let (scene, model) = (render("two.txt"), render("model.obj"));
    folder.succeed(&format!("{scene} --checkpoint two.state"));
    folder.succeed(&format!("{model} --checkpoint model.state"));
    for (option, role) in &ROLES {
        match role {
            Decides(base, words) => {
                let before = again(&scene, base);
                let (line, state) = (again(&before, words), format!("{option}.state"));
                folder.succeed(&format!("{before} --checkpoint {state}"));
                folder.fail(&format!("{line} --resume {state}"), 2, &["belongs to another render"]);
                folder.succeed(&format!("{before} --resume {state}"));
            }
            DecidesOfModel(words) => {
                folder.fail(
                    &format!("{model} {words} --resume model.state"),
                    2,
                    &["belongs to another render"],
                );
            }
            Refused(words, why) => {
                folder.fail(&format!("{scene} {words} --checkpoint farm.state"), 2, &[why]);
            }
            Harmless(words, reason) => {
                let line = again(&scene, words);
                let picture = if words.contains("-o ") { "other.exr" } else { "two.txt.exr" };
                folder.succeed(&line);
                let expected = folder.read(picture);
                folder.succeed(&format!("{line} --resume two.state"));
                assert!(folder.read(picture) == expected, "--{option}, though it is {reason}");
            }
        }
    }
    folder.succeed(&format!("{model} --resume model.state"));
}

/// A command line with other words for some of its options.
fn again(line: &str, words: &str) -> String {
    let mut kept: Vec<&str> = Vec::new();
    let mut drops = false;
    for word in line.split(' ') {
        if word.starts_with('-') {
            drops = words.split(' ').any(|other| other == word);
        }
        if !drops {
            kept.push(word);
        }
    }
    format!("{} {words}", kept.join(" "))
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
fn noise_of_light_from_lights_counts() {
    let folder = Folder::new();
    let light = "ball.txt --size 40 30 --samples uniform 512 --integrator light -o a.png --noise 0.05";
    let ran = folder.succeed(light);
    assert!(!ran.stderr.contains(", 16 samples a pixel"), "it is noisy at first: {}", ran.stderr);
    let ran = folder.succeed(&format!("{light} --adaptive"));
    assert!(ran.stderr.contains("not by light from emitters; leave out `--adaptive`"), "{}", ran.stderr);
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
