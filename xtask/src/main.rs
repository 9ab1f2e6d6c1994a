//! Tasks of the workspace, each one word: `cargo xtask test`.

mod cycles;
mod deep;
mod environment;
mod errors;
mod floors;
mod instructions;
mod lengths;
mod manifest;
mod mutants;
mod names;
mod packages;
mod python;
mod steps;
mod wheel;
mod words;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use steps::{Cargo, Report};

const HELP: &str = "\
Usage: cargo xtask <TASK>

  test             everything a change must pass: format, lints, docs, floors, words, all tests
  check            the quick part of it: format, lints, floors, words
  floors           only the floors: who may import whom, that no files need each other, and that no function is long
  words            only the words and names that no file may hold
  deep [PART...]   all tests with fast code, the slow ones in full, instructions, squared errors, and the wheel:
                   hours on two cores; a PART is the name of a crate, `examples`, `instructions`, `errors` or `wheel`
  errors           squared errors of path tracing beside known ones; with --bless keeps the figures
  fuzz [SECONDS]   every fuzz target for that long (60), where cargo-fuzz is installed
  instructions     counts what rays take in instructions, where valgrind is installed; with --bless keeps the figures
  mutants          puts bugs into a copy of the sources, one after the other, and runs the self-test on each
  gallery [OUT]    renders both galleries to OUT (out/)
  tables           writes the tables of fields into the pages of the manual, and the classes of the Python package
  wheel            builds the wheel of the Python package, into target/wheels, and tests it
  samplers         draws the pictures of the manual's page on sample patterns";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let root = workspace_root();
    let mut report = Report::default();
    match words[..] {
        ["test"] => test(&root, &mut report),
        ["check"] => check(&root, &mut report),
        ["floors"] => floors(&root, &mut report),
        ["words"] => no_banned_words(&root, &mut report),
        ["deep", ref parts @ ..] => match deep::Parts::of(&root, parts) {
            Ok(parts) => deep::check(&root, &mut report, &parts),
            Err(problem) => return usage(&problem),
        },
        ["fuzz"] => fuzz(&root, &mut report, 60),
        ["fuzz", seconds] => match seconds.parse() {
            Ok(seconds) => fuzz(&root, &mut report, seconds),
            Err(_) => return usage(&format!("`{seconds}` is not a number of seconds")),
        },
        ["instructions"] => instructions::check(&root, &mut report, false),
        ["instructions", "--bless"] => instructions::check(&root, &mut report, true),
        ["errors"] => errors::check(&root, &mut report, false),
        ["errors", "--bless"] => errors::check(&root, &mut report, true),
        ["mutants"] => mutants::check(&root, &mut report),
        ["tables"] => tables(&root, &mut report),
        ["wheel"] => wheel::build(&root, &mut report),
        ["samplers"] => samplers(&root, &mut report),
        ["gallery"] => gallery(&root, &mut report, Path::new("out")),
        ["gallery", out] => gallery(&root, &mut report, Path::new(out)),
        [] | ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            return ExitCode::SUCCESS;
        }
        _ => return usage(&format!("there is no task `{}`", words.join(" "))),
    }
    report.print();
    if report.failed() { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn usage(complaint: &str) -> ExitCode {
    eprintln!("{complaint}\n\n{HELP}");
    ExitCode::from(2)
}

/// The folder above this crate.
fn workspace_root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

fn test(root: &Path, report: &mut Report) {
    packages::provide(report);
    check(root, report);
    report.run(
        "documentation",
        Cargo::new(root, "doc --workspace --no-deps").env("RUSTDOCFLAGS", "-D warnings"),
    );
    if steps::has_cargo_command("nextest") {
        report.run("tests", Cargo::new(root, "nextest run --workspace --no-fail-fast"));
        report.run("examples in the documentation", Cargo::new(root, "test --workspace --doc"));
    } else {
        report.run("tests", Cargo::new(root, "test --workspace --no-fail-fast"));
    }
    python::test(root, report);
    if !root.join("../shared/course").is_dir() {
        report.skip("course set", "the course's files are not at ../shared/course");
    }
    report.skip("slow tests, and the wheel", "run `cargo xtask deep` for them");
}

fn check(root: &Path, report: &mut Report) {
    floors(root, report);
    no_banned_words(root, report);
    report.run("format", Cargo::new(root, "fmt --all --check"));
    report.run("lints", Cargo::new(root, "clippy --workspace --all-targets --keep-going -- -D warnings"));
}

fn floors(root: &Path, report: &mut Report) {
    report.add("floors", floors::check(root));
}

fn no_banned_words(root: &Path, report: &mut Report) {
    report.add("words", words::check(root));
}

fn fuzz(root: &Path, report: &mut Report, seconds: u64) {
    if !steps::has_cargo_command("fuzz") {
        return report.skip("fuzzing", "cargo-fuzz is not installed: `cargo install cargo-fuzz`");
    }
    if !steps::has_nightly() {
        return report.skip("fuzzing", "it needs a nightly compiler: `rustup toolchain install nightly`");
    }
    match manifest::binaries(&root.join("fuzz/Cargo.toml")) {
        Ok(targets) => {
            for target in targets {
                let line = format!("fuzz run {target} -- -max_total_time={seconds}");
                report.run(&format!("fuzz {target}"), Cargo::new(root, &line).toolchain("nightly"));
            }
        }
        Err(problem) => report.add("fuzzing", Err(vec![problem])),
    }
}

fn tables(root: &Path, report: &mut Report) {
    let tests = Cargo::new(root, "test --quiet --package kajo --lib language");
    report.run("tables of the manual", tests.env("KAJO_WRITE_TABLES", "1"));
}

fn samplers(root: &Path, report: &mut Report) {
    let example = "run --release --quiet --package kajo --example sample_patterns -- docs/src/images";
    report.run("pictures of sample patterns", Cargo::new(root, example));
}

fn gallery(root: &Path, report: &mut Report, out: &Path) {
    let render = |name: &str| {
        let manifest = format!("scenes/{name}/manifest.txt");
        let cargo = Cargo::new(root, "run --release --quiet --package kajo-cli -- gallery");
        cargo.argument(&manifest).argument(out.join(name))
    };
    report.run("classic gallery", render("classic"));
    report.run("gallery", render("gallery"));
}
