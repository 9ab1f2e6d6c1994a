//! The commands but `gallery`, each from its arguments to its end.

mod bench;
mod btf;
mod convert;
mod diff;
mod frames;
mod help;
mod info;
mod selftest;
mod studio;
mod texture;

use std::path::Path;

use clap_complete::Shell;
use kajo::{Severity, load};

pub use bench::bench;
pub use btf::btf;
pub use convert::convert;
pub use diff::diff;
pub use frames::frames;
pub use help::help;
pub use info::info;
pub use selftest::selftest;
pub use studio::{alone, studio};
pub use texture::texture;

use crate::args::{CheckArgs, Cli, RunArgs};
use crate::console;
use crate::failure::Failure;
use crate::farm;
use crate::interrupt::Interrupt;
use crate::job::{Done, Job, Voice, has_errors, in_figures};
use crate::output::Destination;
use crate::progress::{Meter, in_short};

/// `kajo render` and `kajo classic`
pub fn render(job: &Job, run: &RunArgs, interrupt: &Interrupt) -> Result<(), Failure> {
    let meter = Meter::new(run.quiet, run.show_progress);
    let mut say = |text: &str| console::report(text);
    let mut voice = Voice { color: console::in_color(), quiet: run.quiet, say: &mut say };
    let done = match &job.farm.farm {
        Some(workers) => farm::render(job, workers, &meter, interrupt, &mut voice)?,
        None => {
            farm::refuse_alone(job)?;
            job.run(&meter, interrupt, &mut voice)?
        }
    };
    if !run.quiet {
        console::line(summary(job, &done));
    }
    if run.stats {
        console::line(statistics(&done));
    }
    Ok(())
}

/// `out.png: 800 x 600, 16 samples a pixel, 7.9 M rays in 1.20 s (6.6 M rays/s)`
fn summary(job: &Job, done: &Done) -> String {
    let names: Vec<String> = job
        .outputs
        .iter()
        .map(|output| match &output.destination {
            Destination::File(path) => path.display().to_string(),
            Destination::StandardOutput => "standard output".to_owned(),
        })
        .chain(job.diagrams.iter().map(|diagram| diagram.path.display().to_string()))
        .collect();
    let names = if names.is_empty() { "nothing written".to_owned() } else { names.join(", ") };
    let [width, height] = done.size;
    let rays = done.stats.rays.total() as f64;
    let seconds = done.stats.seconds;
    let samples =
        if done.samples.fract() == 0.0 { done.samples.to_string() } else { format!("{:.1}", done.samples) };
    let noise = done.noise.map_or(String::new(), |noise| format!(", noise {noise:.4}"));
    format!(
        "{names}: {width} x {height}, {samples} sample{} a pixel{noise}, {} rays in {seconds:.2} s ({} rays/s)",
        if samples == "1" { "" } else { "s" },
        in_short(rays),
        in_short(rays / seconds.max(1e-6))
    )
}

fn statistics(done: &Done) -> String {
    let stats = &done.stats;
    let rays = [
        ("camera rays", stats.rays.camera),
        ("rays from lights", stats.rays.light),
        ("shadow rays", stats.rays.shadow),
        ("mirror rays", stats.rays.reflected),
        ("refracted rays", stats.rays.refracted),
        ("all rays", stats.rays.total()),
        ("samples", stats.samples),
        ("threads", stats.threads as u64),
    ];
    let mut lines: Vec<String> =
        rays.iter().map(|(name, count)| format!("  {name:<16}{count:>16}")).collect();
    lines.extend(done.r_hat.map(|r_hat| format!("  {:<16}{:>16}", "R-hat of chains", in_figures(r_hat))));
    format!("{}\n  {:<16}{:>16.3}", lines.join("\n"), "seconds", stats.seconds)
}

/// `kajo check`
pub fn check(args: &CheckArgs) -> Result<(), Failure> {
    let mut first_failure = None;
    for scene in &args.scenes {
        if let Err(failure) = check_one(scene, args) {
            if !failure.message().is_empty() {
                console::error(failure.message());
            }
            // The scenes may be fine, for all that is known.
            let said = match failure {
                Failure::Memory(_) => Failure::Memory(String::new()),
                _ => Failure::Input(String::new()),
            };
            first_failure.get_or_insert(said);
        }
    }
    first_failure.map_or(Ok(()), Err)
}

fn check_one(scene: &Path, args: &CheckArgs) -> Result<(), Failure> {
    let loaded = load(scene, &args.scene_args.options());
    if args.short {
        loaded.lines().for_each(console::line);
    } else if !loaded.diagnostics.is_empty() {
        console::report(&loaded.report(console::in_color()));
    }
    if loaded.scene.is_none() {
        return Err(has_errors(scene, &loaded));
    }
    let warnings = match loaded.diagnostics.count(Severity::Warning) {
        0 => String::new(),
        1 => ", with 1 warning".to_owned(),
        n => format!(", with {n} warnings"),
    };
    console::answer(&format!("{}: fine{warnings}\n", scene.display()))?;
    Ok(())
}

/// `kajo completions`
pub fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::tree(), "kajo", &mut script);
    console::data(&String::from_utf8_lossy(&script))?;
    Ok(())
}
