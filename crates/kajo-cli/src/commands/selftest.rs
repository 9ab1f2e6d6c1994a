//! `kajo selftest`: scenes whose light is known, rendered and compared.

use std::time::{SystemTime, UNIX_EPOCH};

use kajo_selftest::{BATCHES, Effort, Row, Trial, Verdict, trials};

use crate::args::SelftestArgs;
use crate::failure::Failure;
use crate::{console, json};

pub fn selftest(args: &SelftestArgs) -> Result<(), Failure> {
    let seed = args.seed.unwrap_or_else(seed_of_today);
    let wanted: Vec<Trial> =
        trials(seed).into_iter().filter(|trial| args.wants(&trial.name, trial.method)).collect();
    if wanted.is_empty() {
        let only = args.only.as_deref().unwrap_or_default();
        return Err(Failure::Input(format!("no row's name or method holds `{only}`; --list shows all rows")));
    }
    if args.list {
        return wanted.iter().try_for_each(|trial| console::answer(&named(&trial.name, trial.method)));
    }
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    if !args.json {
        console::answer(&heading(seed, effort))?;
    }
    let mut rows = Vec::with_capacity(wanted.len());
    for trial in &wanted {
        let row = trial.run(seed, effort, args.threads.into());
        if !args.json {
            console::answer(&line(&row))?;
        }
        rows.push(row);
    }
    if args.json {
        console::data(&(as_json(seed, effort, &rows) + "\n"))?;
    }
    ended(&rows, args.json)
}

/// Another seed every time.
fn seed_of_today() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |time| time.as_secs())
}

fn ended(rows: &[Row], quiet: bool) -> Result<(), Failure> {
    let failed = rows.iter().filter(|row| row.verdict != Verdict::Pass).count();
    match failed {
        0 if quiet => Ok(()),
        0 => console::answer(&format!("all {} rows pass\n", rows.len())),
        n => Err(Failure::Different(format!("{n} of {} rows fail", rows.len()))),
    }
}

fn heading(seed: u64, effort: Effort) -> String {
    format!(
        "seed {seed}; {BATCHES} batches a row; a row passes within 4 sigma, sigma below {} % of the value\n\
         {:>12} {:>12} {:>9} {:>7}\n",
        100.0 * effort.noise,
        "expected",
        "measured",
        "sigma",
        "off"
    )
}

/// `    1.131768     1.131801   0.00031    0.1 s pass   S2 point light in a ball, albedo 0.8 [path]`
fn line(row: &Row) -> String {
    let off = (row.measured - row.expected).abs() / row.sigma;
    let off = if off.is_finite() { format!("{off:.1} s") } else { "-".to_owned() };
    let (verdict, why) = match &row.verdict {
        Verdict::Pass => ("pass", None),
        Verdict::Wrong => ("FAIL", None),
        Verdict::Noisy => ("NOISY", None),
        Verdict::Broken(why) => ("BROKEN", Some(why)),
    };
    let why = why.map_or(String::new(), |why| format!("       {why}\n"));
    format!(
        "{:>12.7} {:>12.7} {:>9.2e} {off:>7} {verdict:<6} {}{why}",
        row.expected,
        row.measured,
        row.sigma,
        named(&row.name, row.method)
    )
}

fn named(name: &str, method: &str) -> String {
    format!("{name} [{method}]\n")
}

fn as_json(seed: u64, effort: Effort, rows: &[Row]) -> String {
    let row = |row: &Row| {
        let why = match &row.verdict {
            Verdict::Pass => json::string("pass"),
            Verdict::Wrong => json::string("wrong"),
            Verdict::Noisy => json::string("noisy"),
            Verdict::Broken(why) => json::string(why),
        };
        json::object([
            ("name", json::string(&row.name)),
            ("method", json::string(row.method)),
            ("expected", json::number(row.expected)),
            ("measured", json::number(row.measured)),
            ("sigma", json::number(row.sigma)),
            ("samples", row.samples.to_string()),
            ("pass", (row.verdict == Verdict::Pass).to_string()),
            ("verdict", why),
        ])
    };
    json::object([
        ("seed", seed.to_string()),
        ("batches", BATCHES.to_string()),
        ("noise", json::number(effort.noise)),
        ("pass", rows.iter().all(|row| row.verdict == Verdict::Pass).to_string()),
        ("rows", json::list(rows.iter().map(row))),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(verdict: Verdict) -> Row {
        let (expected, measured, sigma) = (2.0, 2.1, 0.025);
        Row { name: "ball".into(), method: "path", expected, measured, sigma, samples: 9, verdict }
    }

    #[test]
    fn one_failing_row_fails_all() {
        assert!(ended(&[row(Verdict::Pass)], true).is_ok());
        let failure = ended(&[row(Verdict::Pass), row(Verdict::Noisy)], true).unwrap_err();
        assert_eq!((failure.code(), failure.message()), (1, "1 of 2 rows fail"));
    }

    #[test]
    fn a_row_says_how_far_off_it_is() {
        let text = line(&row(Verdict::Wrong));
        for part in ["2.0000000", "2.1000000", "2.50e-2", "4.0 s", "FAIL", "ball [path]"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(line(&row(Verdict::Broken("no picture".into()))).contains("no picture"));
    }

    #[test]
    fn json_has_every_row() {
        let text = as_json(7, Effort::QUICK, &[row(Verdict::Wrong)]);
        let expected =
            r#"{"seed":7,"batches":32,"noise":0.005,"pass":false,"rows":[{"name":"ball","method":"path","#;
        assert!(text.starts_with(expected), "{text}");
    }
}
