//! `kajo bench whitted`

use std::fs;
use std::path::Path;

use kajo::output::Target;
use kajo::{EncodeOptions, Format, encode};
use kajo_selftest::bench::Times;
use kajo_selftest::bench::whitted::{
    AntiAliasing, COUNT_TOLERANCE, MEAN_TOLERANCE, Report, Settings, WhittedError, WhittedScene,
    run as render,
};

use super::{header, machine_json, seconds, times_json};
use crate::args::WhittedArgs;
use crate::failure::Failure;
use crate::{console, json};

pub fn run(args: &WhittedArgs) -> Result<(), Failure> {
    if let Some(folder) = &args.peers {
        return args.scene.scenes().into_iter().try_for_each(|scene| write_for_peers(folder, scene));
    }
    if !args.json {
        console::answer(&header())?;
    }
    for scene in args.scene.scenes() {
        let settings = Settings {
            scene,
            aa: args.aa.into(),
            threads: args.threads.iter().map(|&n| n.into()).collect(),
            passes: args.passes.into(),
        };
        let report = render(&settings)?;
        if let Some(folder) = &args.pictures {
            write(&report, folder, scene)?;
        }
        console::answer(&if args.json { as_json(&settings, &report) } else { as_text(&settings, &report) })?;
    }
    Ok(())
}

/// A wrong picture is a difference from the known one.
impl From<WhittedError> for Failure {
    fn from(error: WhittedError) -> Failure {
        match error {
            WhittedError::Render(_) => Failure::Input(error.to_string()),
            WhittedError::Scene(_) => Failure::Bug(error.to_string()),
            WhittedError::Wrong(_) | WhittedError::Unstable { .. } => Failure::Different(error.to_string()),
        }
    }
}

fn write(report: &Report, folder: &Path, scene: WhittedScene) -> Result<(), Failure> {
    write_file(folder, scene, "png", &encode(&report.image, Format::Png, &EncodeOptions::default())?)
}

fn write_for_peers(folder: &Path, scene: WhittedScene) -> Result<(), Failure> {
    write_file(folder, scene, "pov", scene.povray().as_bytes())?;
    write_file(folder, scene, "dat", scene.tachyon().as_bytes())
}

fn write_file(folder: &Path, scene: WhittedScene, ending: &str, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |error| Failure::Output(format!("cannot make the folder `{}`: {error}", folder.display()));
    fs::create_dir_all(folder).map_err(failed)?;
    let target = Target::check(&folder.join(scene.name()).with_extension(ending), &[])?;
    Ok(target.write(bytes)?)
}

fn as_text(settings: &Settings, report: &Report) -> String {
    let [width, height] = report.size;
    let aa = match settings.aa {
        AntiAliasing::None => "no anti-aliasing",
        AntiAliasing::Grid => "centre and 2 x 2 grid, five camera rays a pixel",
    };
    let mut text = format!(
        "\n{}: {} spheres, {width} x {height}, {aa}, 5 bounces, medians of {} passes (least .. greatest)\n",
        settings.scene.name(),
        report.balls,
        settings.passes
    );
    let mut field = |name: &str, value: String| text += &format!("  {name:<20}{value}\n");
    let [r, g, b] = report.mean;
    field(
        "checked",
        format!(
            "mean colour ({r:.6}, {g:.6}, {b:.6}) within {MEAN_TOLERANCE}, ray counts within {} %, same bits in all passes",
            COUNT_TOLERANCE * 100.0
        ),
    );
    let rays = &report.rays;
    field(
        "rays",
        format!(
            "{} camera, {} shadow, {} mirror, {} refracted, {} in all",
            rays.camera,
            rays.shadow,
            rays.reflected,
            rays.refracted,
            rays.total()
        ),
    );
    field("parse", format!("{:.0} kB in {}", report.text_bytes as f64 / 1e3, seconds(&report.parse.wall)));
    field("compile", seconds(&report.compile.wall));
    for (threads, times) in &report.renders {
        let unit = if *threads == 1 { "thread" } else { "threads" };
        field(&format!("{threads} {unit}"), render_line(report, times));
    }
    text
}

/// Seconds by both clocks, rays a second, and how much faster than the first number of threads.
fn render_line(report: &Report, times: &Times) -> String {
    let mrays = report.rays.total() as f64 * 1e-6 / times.wall.median;
    let speed_up = report.renders.first().map_or(1.0, |(_, first)| first.wall.median / times.wall.median);
    format!(
        "wall {}, processor {}, {mrays:.2} Mray/s, {speed_up:.2} x",
        seconds(&times.wall),
        seconds(&times.cpu)
    )
}

fn as_json(settings: &Settings, report: &Report) -> String {
    let rays = &report.rays;
    let counts = [
        ("camera", rays.camera),
        ("shadow", rays.shadow),
        ("reflected", rays.reflected),
        ("refracted", rays.refracted),
        ("total", rays.total()),
    ];
    let renders = report.renders.iter().map(|(threads, times)| {
        json::object([("threads", threads.to_string()), ("render", times_json(times))])
    });
    json::object([
        ("scene", json::string(settings.scene.name())),
        ("machine", machine_json()),
        ("size", json::list(report.size.map(|n| n.to_string()))),
        ("samples", settings.aa.samples().to_string()),
        ("passes", settings.passes.to_string()),
        ("rays", json::object(counts.map(|(name, count)| (name, count.to_string())))),
        ("mean", json::list(report.mean.map(json::number))),
        ("parse", times_json(&report.parse)),
        ("compile", times_json(&report.compile)),
        ("renders", json::list(renders)),
    ]) + "\n"
}
