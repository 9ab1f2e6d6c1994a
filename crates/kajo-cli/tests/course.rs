//! The course's scenes against the images of its reference program.
//!
//! The files are not ours to copy; the test looks for them beside the repository and says when they are absent.

mod common;

use common::{Folder, workspace};
use kajo::compare::Difference;

/// Steps of 1/255 that a channel may be off.
const MAX_OFF: f64 = 2.0;

/// Share of the pixels that may be off by more.
const SHARE: f64 = 0.005;

#[test]
fn every_scene_looks_as_the_reference_program_shows_it() {
    let course = workspace().join("../shared/course");
    let Ok(table) = std::fs::read_to_string(course.join("commands.tsv")) else {
        println!("skipped: there is no {}", course.display());
        return;
    };
    let mut compared = 0;
    for line in table.lines().skip(1) {
        let columns: Vec<&str> = line.split('\t').collect();
        let [scene, arguments, references @ ..] = &columns[..] else { panic!("a line of the table: {line}") };
        let folder = Folder::new();
        let mut command = folder.command();
        command.arg("-input").arg(course.join(scene)).args(["-output", "rgb.png", "-normals", "normals.png"]);
        let mut words = arguments.split_whitespace();
        while let Some(word) = words.next() {
            command.arg(word);
            if word == "-depth" {
                command.args(words.by_ref().take(2)).arg("depth.png");
            }
        }
        let ran = common::Ran::from(command.output().unwrap());
        assert_eq!(ran.code, Some(0), "{scene}: {}", ran.stderr);
        for (reference, ours) in references.iter().zip(["rgb.png", "depth.png", "normals.png"]) {
            if reference.is_empty() {
                continue;
            }
            let difference = Difference::between(&course.join(reference), &folder.path(ours)).unwrap();
            let share = difference.share_above(MAX_OFF).unwrap();
            assert!(share <= SHARE, "{scene}, {ours}: {:.2} % of the pixels are off", share * 100.0);
            compared += 1;
        }
    }
    assert!(compared > 70, "only {compared} images were compared");
}
