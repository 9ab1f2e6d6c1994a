//! The squared error of path tracing by what a scene is made of, beside known figures.
//!
//! `scenes/bench/errors.sh` takes it. The same seeds give the same pictures on every machine, so a figure changes only with what draws
//! samples, and one that has grown says that something is noisier than it was.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::steps::{self, Cargo, Report};

const FILE: &str = "scenes/bench/errors_known.txt";
const NAME: &str = "squared errors";
/// Figures may be so much larger than the known ones.
const TOLERANCE: f64 = 0.05;

/// A scene and its squared error.
type Figure = (String, f64);

/// Measures, prints and compares; with `bless` the new figures become the known ones.
pub fn check(root: &Path, report: &mut Report, bless: bool) {
    if !steps::answers(Command::new("bash").arg("--version")) {
        return report.skip(NAME, "there is no bash");
    }
    report.run("a fast build", Cargo::new(root, "build --release --quiet --package kajo-cli"));
    println!("\n== {NAME}");
    let outcome = measure(root).map_err(|problem| vec![problem]).and_then(|figures| {
        if bless {
            let lines: String = figures.iter().map(|(name, error)| format!("{name} {error:.3e}\n")).collect();
            return fs::write(root.join(FILE), lines).map_err(|error| vec![format!("{FILE}: {error}")]);
        }
        let known = fs::read_to_string(root.join(FILE)).map_err(|error| vec![format!("{FILE}: {error}")])?;
        compare(&figures, &parse(&known))
    });
    report.add(NAME, outcome);
}

/// What the script prints for the program of the release build.
fn measure(root: &Path) -> Result<Vec<Figure>, String> {
    let program = steps::built(root, "release").join(format!("kajo{}", std::env::consts::EXE_SUFFIX));
    let script = root.join("scenes/bench/errors.sh");
    let output = Command::new("bash")
        .arg(script)
        .arg("--kajo")
        .arg(program)
        .output()
        .map_err(|error| format!("bash did not start: {error}"))?;
    let figures = parse(&String::from_utf8_lossy(&output.stdout));
    if output.status.success() && !figures.is_empty() {
        Ok(figures)
    } else {
        Err(format!("errors.sh ended with {}:\n{}", output.status, String::from_utf8_lossy(&output.stderr)))
    }
}

/// The lines `NAME NUMBER` of a text.
fn parse(text: &str) -> Vec<Figure> {
    let figure = |line: &str| {
        let (name, error) = line.trim().split_once(char::is_whitespace)?;
        Some((name.to_owned(), error.trim().parse().ok()?))
    };
    text.lines().filter_map(figure).collect()
}

/// What is wrong with figures next to the known ones.
fn compare(figures: &[Figure], known: &[Figure]) -> Result<(), Vec<String>> {
    let mut problems = Vec::new();
    for (name, error) in figures {
        let Some((_, before)) = known.iter().find(|(other, _)| other == name) else {
            problems.push(format!("{FILE} has no figure for {name}"));
            continue;
        };
        let change = error / before - 1.0;
        println!("{name:36} {error:10.3e}, known {before:10.3e}, {:+.1} %", 100.0 * change);
        if change > TOLERANCE {
            problems.push(format!("{name} has a squared error of {error:.3e}, {:.1} % more", 100.0 * change));
        } else if change < -TOLERANCE {
            println!("{name} has less: `cargo xtask errors --bless` keeps the new figure");
        }
    }
    let is_measured = |name: &str| figures.iter().any(|(other, _)| other == name);
    let missing = known.iter().filter(|(name, _)| !is_measured(name));
    problems.extend(missing.map(|(name, _)| format!("{name} was not measured")));
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_error_fails_and_less_passes() {
        let known = parse("box 1.0e-4\nroom  2e-3\n");
        assert_eq!(known, [("box".to_owned(), 1e-4), ("room".to_owned(), 2e-3)]);
        let with = |a: f64, b: f64| compare(&[("box".to_owned(), a), ("room".to_owned(), b)], &known);
        assert_eq!(with(1e-4, 2e-3), Ok(()));
        assert_eq!(with(1.04e-4, 1e-3), Ok(()));
        assert_eq!(with(1e-4, 2.2e-3).unwrap_err(), ["room has a squared error of 2.200e-3, 10.0 % more"]);
    }

    #[test]
    fn scenes_must_be_the_same() {
        let [one, other] = ["box 1e-4", "room 1e-4"].map(parse);
        let problems = compare(&one, &other).unwrap_err();
        assert!(problems[0].contains("no figure for box") && problems[1] == "room was not measured");
    }
}
