//! `kajo farm slurm`: a batch script for Slurm.

use std::ffi::OsString;
use std::path::Path;

use crate::failure::Failure;

/// The script: it makes the plan and submits itself as an array of units, and after it as the job that puts them together.
/// That one submits the array again where units are missing or the render has a further stage.
///
/// * `line`: the words after the program's name, `farm slurm` first
/// * `array`: elements of the array
/// * `job`: the folder of the job
///
/// # Errors
/// When a name is not UTF-8.
pub fn script(line: &[OsString], array: u32, job: &Path) -> Result<String, Failure> {
    let not_text = || Failure::Input("a batch script can hold names in UTF-8 only".to_owned());
    let text = |path: std::io::Result<std::path::PathBuf>| {
        let path = path.map_err(|error| Failure::Input(error.to_string()))?;
        path.into_os_string().into_string().map(|text| quoted(&text)).map_err(|_| not_text())
    };
    let program = text(std::env::current_exe())?;
    let job = text(std::path::absolute(job))?;
    let folder = text(std::env::current_dir())?;
    let words = words_of_plan(line).ok_or_else(not_text)?.join(" ");
    let last = array - 1;
    Ok(format!(
        r#"#!/bin/bash
#SBATCH --job-name=kajo
#SBATCH --nodes=1 --ntasks=1
#SBATCH --requeue
# Renders by units of kajo. Submit it with sbatch; options such as --partition and --time can be added above.
set -u
kajo={program}
job={job}
cd {folder} || exit 2

# An array of units, and after it, however it ends, the job that puts them together.
submit() {{
    array=$(KAJO_STEP=unit sbatch --parsable --array=0-{last} "$job/slurm.sh") || exit 3
    KAJO_STEP=merge KAJO_ROUND=$((${{KAJO_ROUND:-0}} + 1)) \
        sbatch --parsable --dependency="afterany:${{array%%;*}}" "$job/slurm.sh"
}}

case "${{KAJO_STEP:-plan}}" in
plan)
    "$kajo" plan {words} --job "$job" || exit
    cp "$0" "$job/slurm.sh" && submit
    ;;
unit)
    exec "$kajo" unit --job "$job" --index "$SLURM_ARRAY_TASK_ID" --of {array} \
        --threads "${{SLURM_CPUS_PER_TASK:-0}}"
    ;;
merge)
    "$kajo" merge "$job"
    code=$?
    # Units are missing, or there is a further stage; a unit that fails every time ends it.
    if [ $code = 3 ] && [ "$KAJO_ROUND" -lt 20 ]; then submit; fi
    exit $code
    ;;
esac
"#
    ))
}

/// The words that the script is to plan with, quoted: all but those of the script itself. `None` where one is not UTF-8.
fn words_of_plan(line: &[OsString]) -> Option<Vec<String>> {
    let mut words = Vec::new();
    let mut rest = line.iter().skip(2);
    while let Some(word) = rest.next() {
        let word = word.to_str()?;
        match word.trim_start_matches('-').split_once('=') {
            Some(("array" | "job", _)) if word.starts_with('-') => {}
            None if word.starts_with('-') && ["array", "job"].contains(&word.trim_start_matches('-')) => {
                rest.next();
            }
            _ => words.push(quoted(word)),
        }
    }
    Some(words)
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=+:,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_the_shell() {
        assert_eq!(quoted("a/b.txt"), "a/b.txt");
        assert_eq!(quoted("my scene's.txt"), r"'my scene'\''s.txt'");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("$(rm)"), "'$(rm)'");
    }

    #[test]
    fn the_script_leaves_out_what_is_its_own() {
        let line = ["farm", "slurm", "a.txt", "--array", "7", "--size", "8", "8", "--job=j", "-o", "a.exr"];
        let script = script(&line.map(OsString::from), 7, Path::new("/tmp/j")).unwrap();
        assert!(script.contains(r#""$kajo" plan a.txt --size 8 8 -o a.exr --job "$job""#), "{script}");
        assert!(script.contains("--array=0-6") && script.contains("--of 7"), "{script}");
    }
}
