//! The self-test tested: rows pass, and rows that should not do not.

use std::collections::BTreeSet;

use kajo_testkit::is_deep;

use super::*;

/// Sharp enough to see a factor that was forgotten.
const COARSE: Effort = Effort { noise: 1e-2, most_samples: 1 << 22 };

/// The rows of a seed: all of them, or for each scene that of the method that came least often before. A scene that came
/// before is taken again only for a method that did not.
fn rows(seed: u64, is_in_full: bool) -> Vec<Trial> {
    if is_in_full {
        return trials(seed);
    }
    let (mut rows, mut scenes) = (Vec::new(), BTreeSet::new());
    for form in forms::pictures(seed) {
        let is_new = scenes.insert(form.scene.clone());
        let times = |row: &Trial| rows.iter().filter(|other: &&Trial| other.method == row.method).count();
        let rarest = of_form(form).into_iter().min_by_key(times);
        rows.extend(rarest.filter(|row| is_new || times(row) == 0));
    }
    rows.extend(trials(seed).into_iter().filter(|trial| trial.scene().is_none()));
    rows
}

/// Runs rows of a seed.
fn run_all(rows: impl Iterator<Item = Trial>, seed: u64, effort: Effort) {
    let mut failed = Vec::new();
    for trial in rows {
        let row = trial.run(seed, effort, 0);
        if row.verdict != Verdict::Pass {
            failed.push(format!("{row:?}"));
        }
    }
    assert!(failed.is_empty(), "seed {seed}:\n{}", failed.join("\n"));
}

/// No scene and no method is left out.
#[test]
fn a_part_of_the_rows_has_all_scenes_and_methods() {
    let scene =
        |row: &Trial| row.scene()?.split_once("\nSettings { samples").map(|(scene, _)| scene.to_owned());
    let scenes = |rows: &[Trial]| rows.iter().filter_map(scene).collect::<BTreeSet<_>>();
    let methods = |rows: &[Trial]| rows.iter().map(|row| row.method).collect::<BTreeSet<_>>();
    let [part, all] = [false, true].map(|is_in_full| rows(1, is_in_full));
    assert!(2 * part.len() < all.len() && scenes(&all).len() > 100);
    assert_eq!(scenes(&part), scenes(&all));
    assert_eq!(methods(&part), methods(&all));
}

#[test]
fn every_row_passes() {
    run_all(rows(1, is_deep()).into_iter(), 1, COARSE);
}

/// All rows at full effort take twelve hours of a core, so each run measures its share of them. The seed says which.
#[test]
fn rows_pass_in_full_with_numbers_that_nobody_chose() {
    const SHARES: usize = 8;
    if !is_deep() {
        return;
    }
    let clock = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let seed = clock.map_or(2, |time| time.as_secs());
    println!("seed {seed}");
    let turn = seed as usize % SHARES;
    run_all(trials(seed).into_iter().skip(turn).step_by(SHARES), seed, Effort::FULL);
}

#[test]
fn every_scene_is_sound_for_any_seed() {
    for seed in 0..4 {
        for trial in trials(seed) {
            if let Kind::Picture { exposure, expected, .. } = &trial.kind {
                assert!(*expected > 0.0 && expected.is_finite(), "{}: {expected}", trial.name);
                assert_eq!(
                    exposure.complaints().map(|said| said.chars().take(300).collect::<String>()),
                    None,
                    "{}",
                    trial.name
                );
            }
        }
    }
}

#[test]
fn the_seed_decides_the_numbers() {
    let names = |seed| trials(seed).into_iter().map(|trial| trial.name).collect::<Vec<_>>();
    assert_eq!(names(3), names(3));
    assert_ne!(names(3), names(4));
}

#[test]
fn a_wrong_value_a_noisy_one_and_a_broken_scene_are_told_apart() {
    let form = Form::new("", WALL.to_owned(), 2.0, &[method::PATH]).bounces(0);
    let verdict = |form: Form| of_form(form).remove(0).run(1, Effort::QUICK, 0).verdict;
    assert_eq!(verdict(form.clone()), Verdict::Pass);
    assert_eq!(verdict(Form { expected: 2.01, ..form.clone() }), Verdict::Wrong);
    let broken = Form { scene: form.scene.replace("Sphere", "Sphre"), ..form.clone() };
    assert!(matches!(verdict(broken), Verdict::Broken(why) if why.contains("Sphre")));
    // A light that is hardly ever met.
    let speck = form.scene.replace("radius 1", "radius 0.0001");
    let noisy = Form { scene: speck, expected: 1e-8, methods: &[method::PATH_SCATTERING], ..form };
    assert_ne!(verdict(noisy), Verdict::Pass);
}

/// Of 64 stratified samples 16.0064 meet the disk: 32 batches of 16 are likely, and their mean is off by 1.3e-4.
#[test]
fn batches_that_agree_by_chance_are_measured_on() {
    let scene = WALL
        .replace("color 0 0 0 }\n    Materials", "color 1 1 1 }\n    Materials")
        .replace(
            "Material m { diffuseColor 0 0 0  emission 2 2 2 }",
            "Matte m { color 0 0 0  opacity 0.2501 }",
        )
        .replace("Sphere { center 0 0 0 ", "Disk { center 0 0 0  normal 0 0 1 ");
    let form = Form::new("", scene, 1.0 - 0.2501, &[method::PATH_SCATTERING]);
    let row = |expected| of_form(Form { expected, ..form.clone() }).remove(0).run(1, COARSE, 0);
    let right = row(form.expected);
    assert_eq!(right.verdict, Verdict::Pass, "{right:?}");
    assert!(right.sigma > 0.0 && right.samples > 2048, "{right:?}");
    assert_eq!(row(form.expected * 1.001).verdict, Verdict::Wrong);
}

/// An emissive wall before the camera.
const WALL: &str = "PerspectiveCamera { center 0 0 5  direction 0 0 -1  up 0 1 0  angle 1 }
    Background { color 0 0 0 }
    Materials { Material m { diffuseColor 0 0 0  emission 2 2 2 } }
    Group { MaterialIndex m  Sphere { center 0 0 0  radius 1 } }";

#[test]
fn threads_change_nothing() {
    let trial = trials(1).remove(0);
    let [one, three] = [1, 3].map(|threads| trial.run(5, Effort::QUICK, threads));
    assert_eq!((one.measured, one.sigma, one.samples), (three.measured, three.sigma, three.samples));
}
