//! Everything there is to check, in full: hours on two cores. Parts of it run alone where they are named.

use std::path::Path;

use crate::steps::{self, Cargo, Report};
use crate::{errors, instructions, packages, wheel};

/// What is no crate.
const STEPS: [&str; 4] = ["examples", "instructions", "errors", "wheel"];

/// What was asked for; everything where nothing was named.
pub struct Parts<'a> {
    names: &'a [&'a str],
}

impl<'a> Parts<'a> {
    /// # Errors
    ///
    /// A name that is neither a crate of the workspace nor one of the other steps.
    pub fn of(root: &Path, names: &'a [&'a str]) -> Result<Parts<'a>, String> {
        let is_crate = |name: &str| name == "xtask" || root.join("crates").join(name).is_dir();
        match names.iter().find(|name| !STEPS.contains(name) && !is_crate(name)) {
            Some(name) => Err(format!("`{name}` is no crate, nor one of {}", STEPS.join(", "))),
            None => Ok(Parts { names }),
        }
    }

    fn has(&self, step: &str) -> bool {
        self.names.is_empty() || self.names.contains(&step)
    }

    fn crates(&self) -> impl Iterator<Item = &'a str> {
        self.names.iter().copied().filter(|name| !STEPS.contains(name))
    }

    /// Which tests run, in nextest's words; `None` where no test does.
    fn tests(&self) -> Option<String> {
        if self.names.is_empty() {
            return Some("all()".to_owned());
        }
        let packages: Vec<String> = self.crates().map(|name| format!("package(={name})")).collect();
        (!packages.is_empty()).then(|| packages.join(" or "))
    }
}

/// Runs the parts, the tests of all crates first.
pub fn check(root: &Path, report: &mut Report, parts: &Parts) {
    packages::provide(report);
    if let Some(filter) = parts.tests() {
        // What takes long runs in full where this is set.
        report
            .run("all tests with fast code, in full", all_tests(root, parts, &filter).env("KAJO_DEEP", "1"));
    }
    if parts.has("examples") {
        let examples = Cargo::new(root, "test --workspace --profile deep --doc");
        report.run("examples in the documentation", examples);
    }
    if parts.has("instructions") {
        instructions::check(root, report, false);
    }
    if parts.has("errors") {
        errors::check(root, report, false);
    }
    if parts.has("wheel") {
        wheel::build(root, report);
    }
}

/// Tests of all crates at once with nextest, so that one with a single thread does not leave the other cores idle.
fn all_tests(root: &Path, parts: &Parts, filter: &str) -> Cargo {
    if steps::has_cargo_command("nextest") {
        let line = "nextest run --workspace --cargo-profile deep --profile deep --no-fail-fast --filterset";
        return Cargo::new(root, line).argument(filter);
    }
    let all = Cargo::new(root, "test --profile deep --no-fail-fast --lib --bins --tests");
    if parts.names.is_empty() {
        return all.argument("--workspace");
    }
    parts.crates().fold(all, |cargo, name| cargo.argument("--package").argument(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace_root;

    #[test]
    fn everything_runs_where_nothing_is_named() {
        let parts = Parts::of(Path::new("."), &[]).expect("no name is wrong");
        assert_eq!(parts.tests().as_deref(), Some("all()"));
        assert!(STEPS.iter().all(|step| parts.has(step)));
    }

    #[test]
    fn named_parts_run_alone() {
        let root = workspace_root();
        let parts = Parts::of(&root, &["kajo-math", "wheel", "xtask"]).expect("all are there");
        assert_eq!(parts.tests().as_deref(), Some("package(=kajo-math) or package(=xtask)"));
        assert!(parts.has("wheel") && !parts.has("errors"));
        assert_eq!(Parts::of(&root, &["errors"]).expect("it is there").tests(), None);
        let problem = Parts::of(&root, &["kajo-moth"]).err();
        assert_eq!(
            problem.as_deref(),
            Some("`kajo-moth` is no crate, nor one of examples, instructions, errors, wheel")
        );
    }
}
