//! `kajo bench rays`

use kajo_selftest::bench::rays::{
    BuildSettings, Gate, Quality, Rates, Report, Settings, check, mesh, run as cast,
};

use super::header;
use crate::args::RaysArgs;
use crate::failure::Failure;
use crate::{console, json};

pub fn run(args: &RaysArgs) -> Result<(), Failure> {
    let settings = Settings {
        threads: args.threads.into(),
        passes: args.passes.into(),
        builds: args.builds.into(),
        build: BuildSettings { quality: args.quality.into() },
    };
    if !args.json {
        console::answer(&(header() + &titles(&settings)))?;
    }
    for name in &args.meshes {
        let mesh = mesh(name).map_err(Failure::Input)?;
        let report = cast(&mesh, &settings).map_err(|error| Failure::Input(format!("{name}: {error}")))?;
        let gate = check(&report.mesh, report.triangles, &report.hits, report.sum_t)
            .map_err(|wrong| Failure::Different(format!("{name}: {wrong}")))?;
        console::answer(&if args.json { as_json(&report) } else { as_row(&report, gate) })?;
    }
    Ok(())
}

fn titles(settings: &Settings) -> String {
    let quality = if settings.build.quality == Quality::High { "high" } else { "medium" };
    format!(
        "threads: {}, tree: {}, medians of {} passes; 10^6 rays a second of processor time and thread / of wall clock\n\
         {:<12}{:>10}{:>16}{:>16}{:>16}{:>16}{:>10}{:>10}{:>9}  answers\n",
        settings.threads,
        quality,
        settings.passes,
        "mesh",
        "triangles",
        "primary",
        "eight at once",
        "bounce",
        "shadow",
        "build s",
        "cpu s",
        "MB"
    )
}

fn as_row(report: &Report, gate: Gate) -> String {
    let rate =
        |of: fn(&Rates) -> f64| format!("{:.2} / {:.2}", of(&report.mrays_cpu), of(&report.mrays_wall));
    let answers = match gate {
        Gate::Passed => "as known",
        Gate::Unknown => "not known",
    };
    format!(
        "{:<12}{:>10}{:>16}{:>16}{:>16}{:>16}{:>10.4}{:>10.4}{:>9.1}  {answers}\n",
        report.mesh,
        report.triangles,
        rate(|r| r.primary),
        rate(|r| r.primary_packet),
        rate(|r| r.bounce),
        rate(|r| r.shadow),
        report.build_wall_s,
        report.build_cpu_s,
        report.bytes as f64 / 1e6
    )
}

/// One object a line.
fn as_json(report: &Report) -> String {
    let rates = |r: &Rates| {
        json::object([
            ("primary", json::number(r.primary)),
            ("bounce", json::number(r.bounce)),
            ("shadow", json::number(r.shadow)),
            ("primary_packet", json::number(r.primary_packet)),
        ])
    };
    let hits =
        [("primary", report.hits.primary), ("bounce", report.hits.bounce), ("shadow", report.hits.shadow)];
    let [primary, bounce] = report.sum_t.map(json::number);
    json::object([
        ("mesh", json::string(&report.mesh)),
        ("triangles", report.triangles.to_string()),
        ("threads", report.threads.to_string()),
        ("build_wall_s", json::number(report.build_wall_s)),
        ("build_cpu_s", json::number(report.build_cpu_s)),
        ("bytes", report.bytes.to_string()),
        ("mrays_wall", rates(&report.mrays_wall)),
        ("mrays_cpu", rates(&report.mrays_cpu)),
        ("hits", json::object(hits.map(|(name, count)| (name, count.to_string())))),
        ("sum_t", json::object([("primary", primary), ("bounce", bounce)])),
    ]) + "\n"
}
