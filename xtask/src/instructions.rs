//! Instructions that rays take, counted by valgrind: figures that other work on the machine cannot touch.
//!
//! `kajo-bvh`'s example `instructions` runs a kernel on a fixed scene, once with no round and once with one more; the
//! difference, over the number of rays, is what a ray takes. The known figures stand in a file, one line a kernel. They
//! hold for one kind of processor, since kernels are compiled for several; valgrind itself hides AVX-512 from programs.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::steps::{self, Report};

const FILE: &str = "crates/kajo-bvh/instructions.txt";
const NAME: &str = "instructions";
const KERNELS: [&str; 5] = ["primary", "bounce", "shadow", "packet", "build"];
/// Figures may be so much larger than the known ones: libraries of the system differ.
const TOLERANCE: f64 = 0.01;

/// Counts, prints and compares; with `bless` the new figures become the known ones.
pub fn check(root: &Path, report: &mut Report, bless: bool) {
    if !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        return report.skip(NAME, "known figures are for x86-64 Linux only");
    }
    if !steps::answers(Command::new("valgrind").arg("--version")) {
        return report.skip(NAME, "valgrind is not installed (Debian: `apt-get install valgrind`)");
    }
    println!("\n== {NAME}");
    let counted: Result<Vec<f64>, String> = KERNELS.iter().map(|kernel| per_ray(root, kernel)).collect();
    let outcome = counted.map_err(|problem| vec![problem]).and_then(|counted| {
        if bless {
            let lines: String =
                KERNELS.iter().zip(&counted).map(|(name, count)| format!("{name} {count:.1}\n")).collect();
            return fs::write(root.join(FILE), lines).map_err(|error| vec![format!("{FILE}: {error}")]);
        }
        let known = fs::read_to_string(root.join(FILE)).map_err(|error| vec![format!("{FILE}: {error}")])?;
        compare(&counted, &known)
    });
    report.add(NAME, outcome);
}

/// What is wrong with figures, one for each kernel, next to the known ones.
fn compare(counted: &[f64], known: &str) -> Result<(), Vec<String>> {
    let mut problems = Vec::new();
    for (name, count) in KERNELS.into_iter().zip(counted) {
        let Some(known) = figure(known, name) else {
            problems.push(format!("{FILE} has no figure for {name}"));
            continue;
        };
        let change = count / known - 1.0;
        println!("{name:8} {count:8.1} instructions, known {known:8.1}, {:+.1} %", 100.0 * change);
        if change > TOLERANCE {
            problems.push(format!("{name} takes {count:.1} instructions, {:.1} % more", 100.0 * change));
        } else if change < -TOLERANCE {
            println!("{name} takes fewer: `cargo xtask instructions --bless` keeps the new figure");
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

/// The figure on the line that begins with `name`.
fn figure(known: &str, name: &str) -> Option<f64> {
    let rest = known.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '))?;
    rest.trim().parse().ok()
}

/// Instructions of a kernel, for each ray or triangle.
fn per_ray(root: &Path, kernel: &str) -> Result<f64, String> {
    let [(without, _), (with, things)] = [count(root, kernel, "0")?, count(root, kernel, "1")?];
    Ok((with - without) / things)
}

/// Instructions of the whole program, and how many rays or triangles it says that a round has.
fn count(root: &Path, kernel: &str, rounds: &str) -> Result<(f64, f64), String> {
    let runner = "target.'cfg(unix)'.runner = 'valgrind --tool=callgrind --callgrind-out-file=/dev/null'";
    let output = Command::new("cargo")
        .current_dir(root)
        .args(["run", "--quiet", "--release", "--package", "kajo-bvh", "--features", "bench"])
        .args(["--example", "instructions", "--config", runner, "--", kernel, rounds])
        .output()
        .map_err(|error| format!("cargo did not start: {error}"))?;
    let (out, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let last = |text: &str, mark: &str| {
        let line = text.lines().find(|line| line.contains(mark))?;
        line.split_whitespace().next_back()?.parse::<f64>().ok()
    };
    match (output.status.success(), last(&log, "Collected :"), last(&out, "found of")) {
        (true, Some(instructions), Some(things)) => Ok((instructions, things)),
        _ => Err(format!("{kernel} did not run to its end under valgrind:\n{log}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: &str = "primary 400.0\nbounce 500.0\nshadow 300.0\npacket 100.0\nbuild 2000.0\n";

    #[test]
    fn more_instructions_fail_and_fewer_pass() {
        let mut counted = [400.0, 500.0, 300.0, 100.0, 2000.0];
        assert_eq!(compare(&counted, KNOWN), Ok(()));
        counted[2] = 290.0;
        assert_eq!(compare(&counted, KNOWN), Ok(()));
        counted[2] = 302.0;
        assert_eq!(compare(&counted, KNOWN), Ok(()));
        counted[2] = 304.0;
        let problems = compare(&counted, KNOWN).unwrap_err();
        assert_eq!(problems, ["shadow takes 304.0 instructions, 1.3 % more"]);
    }

    #[test]
    fn a_figure_that_is_missing_is_said() {
        let problems = compare(&[400.0, 500.0, 300.0, 100.0, 2000.0], "primary 400.0\n").unwrap_err();
        assert_eq!(problems.len(), 4);
        assert!(problems[0].contains("bounce"));
        assert_eq!(figure("packets 4\n", "packet"), None);
    }
}
