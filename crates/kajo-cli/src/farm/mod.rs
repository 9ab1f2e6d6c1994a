//! Renders by many workers: the commands around [`kajo_farm`].

mod engine;
mod local;
mod pool;
mod python;
mod slurm;
mod worker;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use kajo::output::Target;
use kajo::{Loaded, Position, Rect, RenderRequest, RenderStats, Silent, SplitRender, WorkUnit};
use kajo_farm::{Bundle, FarmError, Job as Folder, Layout, Merged, Part, Plan, PlannedFile, Recording};

use crate::args::{
    BundleArgs, Cli, Command, FarmCommand, FarmCommandArgs, MergeArgs, PlanArgs, UnitArgs, Workers,
};
use crate::console;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
use crate::job::{Done, Job, Voice, has_errors};
use crate::output::Destination;
use crate::progress::Meter;

pub use python::{hand_over, words_for_python};
pub use worker::worker;

/// Does all of a job by workers.
///
/// # Errors
/// [`Failure`]; what is finished stays in the folder of the job.
pub fn render(
    job: &Job,
    workers: &Workers,
    meter: &Meter,
    interrupt: &Interrupt,
    voice: &mut Voice<'_>,
) -> Result<Done, Failure> {
    match workers {
        Workers::Local(n) => {
            pool::render(job, &local::Local::new(*n, job.resources.threads), meter, interrupt, voice)
        }
        Workers::Engine => pool::render(job, &engine::Machines::new()?, meter, interrupt, voice),
        Workers::Cluster(_) => {
            refuse(job)?;
            let words: Vec<OsString> = std::env::args_os().skip(1).collect();
            let render = words.first().is_none_or(|word| word != "render").then(|| OsString::from("render"));
            hand_over(&render.into_iter().chain(words).collect::<Vec<_>>())?;
            Err(Failure::Input("the cluster gave no picture".to_owned()))
        }
    }
}

/// Calls `act` with the split of a render and what its scene was read from.
fn with_split_render<T>(
    job: &Job,
    bundle: Option<&Bundle>,
    quiet: bool,
    act: impl FnOnce(&SplitRender<'_>, &Loaded) -> Result<T, Failure>,
) -> Result<T, Failure> {
    refuse(job)?;
    let meter = Meter::new(true, false);
    let mut loaded = job.load_scene(&meter, bundle)?;
    if !loaded.diagnostics.is_empty() && (!quiet || loaded.scene.is_none()) {
        console::report(&loaded.report(console::in_color()));
    }
    let Some(scene) = loaded.scene.take() else { return Err(has_errors(&job.scene, &loaded)) };
    let mut say = |text: &str| {
        if !quiet {
            console::report(text)
        }
    };
    let settings = job.settings(&scene, &mut Voice { color: false, quiet, say: &mut say })?;
    let outputs = job.recorded();
    let request = RenderRequest::new(&scene, &settings, &outputs).with(job.resources);
    act(&SplitRender::new(&request, &job.passes.goal(), Job::scene_digest(&loaded)?)?, &loaded)
}

/// What cannot be shared among workers.
fn refuse(job: &Job) -> Result<(), Failure> {
    let passes = &job.passes;
    let why = if passes.time.is_some() {
        "`--time` ends a render by the clock of one machine, and workers have no common one; \
         take `--samples` or `--noise`"
    } else if passes.checkpoint.is_some() || passes.resume.is_some() {
        "what is finished is kept in the folder of the job (--job), which takes the place of checkpoints"
    } else if passes.tev.is_some() {
        "workers bring units and not pictures, so that there is nothing to show in a viewer yet"
    } else if job.outputs.iter().any(|output| matches!(output.destination, Destination::StandardOutput)) {
        "the picture of many workers goes to a file; name it with -o FILE"
    } else {
        return Ok(());
    };
    Err(Failure::Input(why.to_owned()))
}

/// What a render without workers has no use for, and would pass over in silence.
///
/// # Errors
/// [`Failure::Input`]
pub fn refuse_alone(job: &Job) -> Result<(), Failure> {
    let farm = &job.farm;
    let given = [
        ("--job", farm.job.is_some()),
        ("--preview", farm.preview.is_some()),
        ("--farm-config", farm.farm_config.is_some()),
        ("--unit-tile", farm.unit_tile.is_some()),
        ("--unit-samples", farm.unit_samples.is_some()),
    ];
    match given.into_iter().find(|&(_, is_given)| is_given) {
        Some((option, _)) => Err(Failure::Input(format!(
            "`{option}` is for renders by many workers: give `--farm local:N` too"
        ))),
        None => Ok(()),
    }
}

/// The command line of a job, without the program's name: for a frame of several that frame's own, where the last
/// word counts.
fn line_of(job: &Job) -> Vec<OsString> {
    let mut line: Vec<OsString> = std::env::args_os().skip(1).collect();
    let Some(frame) = job.load.frame else { return line };
    line.extend(["--frames".into(), frame.to_string().into()]);
    if let Some(Destination::File(path)) = job.outputs.first().map(|output| &output.destination) {
        line.extend(["--output".into(), path.clone().into()]);
    }
    line
}

/// `out.exr.job` for `out.exr`.
fn folder_of(job: &Job) -> PathBuf {
    if let Some(folder) = &job.farm.job {
        return folder.clone();
    }
    let output = job.outputs.iter().find_map(|output| match &output.destination {
        Destination::File(path) => Some(path.clone()),
        Destination::StandardOutput => None,
    });
    let mut name: OsString = output.unwrap_or_else(|| job.scene.with_extension("png")).into();
    name.push(".job");
    name.into()
}

/// Makes the folder of a job, or finds it.
///
/// * `line`: the command line of the render, without the program's name
fn folder(
    job: &Job,
    split: &SplitRender<'_>,
    loaded: &Loaded,
    line: Vec<OsString>,
) -> Result<Folder, Failure> {
    let arguments: Result<Vec<String>, OsString> = line.into_iter().map(OsString::into_string).collect();
    let here = std::env::current_dir().ok().and_then(|folder| folder.into_os_string().into_string().ok());
    let (Ok(arguments), Some(here)) = (arguments, here) else {
        return Err(Failure::Input("a plan can hold names in UTF-8 only".to_owned()));
    };
    let unit = unit_of(job, split)?;
    let plan = Plan::new(split, (arguments, here), PlannedFile::of_all(&loaded.files)?, unit)?;
    Ok(Folder::create(&folder_of(job), &plan, split)?)
}

/// Side of a tile and samples of a unit.
fn unit_of(job: &Job, split: &SplitRender<'_>) -> Result<(u32, u32), Failure> {
    /// Side of a tile.
    const TILE: u32 = 128;
    /// Seconds that a unit should take.
    const SECONDS: f64 = 10.0;
    /// Units that there should be, if there are samples enough.
    const UNITS: u64 = 64;
    let sampled = split.sampled();
    // Splats fall anywhere, so that a small tile would make results as large as the picture.
    let whole = sampled.width().max(sampled.height());
    let tile = job.farm.unit_tile.unwrap_or(if split.splats() { whole } else { TILE.min(whole) });
    let samples = match job.farm.unit_samples {
        Some(samples) => samples,
        None => {
            let stage = split.stage(&Position::default()).unwrap_or(0..1);
            let wanted = SECONDS * samples_per_second(split)? / (f64::from(tile) * f64::from(tile));
            let tiles = Layout::new(sampled, tile, 0..1, 1).tiles().max(1);
            let ranges = UNITS.div_ceil(tiles) as u32;
            let most = (stage.end - stage.start).div_ceil(ranges).max(1);
            (wanted.clamp(1.0, f64::from(u32::MAX)) as u32).min(most)
        }
    };
    Ok((tile, samples))
}

/// Renders a few small squares to see how long samples take.
fn samples_per_second(split: &SplitRender<'_>) -> Result<f64, Failure> {
    const SQUARES: u32 = 4;
    const SIDE: u32 = 16;
    let Rect { x0, y0, x1, y1 } = split.sampled();
    let at = |a: u32, b: u32, i: u32| a + ((b - a) as u64 * (2 * i as u64 + 1) / (2 * SQUARES as u64)) as u32;
    let (start, mut samples) = (Instant::now(), 0);
    for (i, j) in (0..SQUARES).flat_map(|i| (0..SQUARES).map(move |j| (i, j))) {
        let (x, y) = (at(x0, x1, i), at(y0, y1, j));
        let tile =
            Rect { x0: x, y0: y, x1: x.saturating_add(SIDE).min(x1), y1: y.saturating_add(SIDE).min(y1) };
        let (_, stats) = split.render(&Position::default(), &WorkUnit { tile, samples: 0..1 }, &Silent)?;
        samples += stats.samples;
        if start.elapsed().as_secs_f64() > 1.0 {
            break;
        }
    }
    Ok(samples as f64 / start.elapsed().as_secs_f64().max(1e-6))
}

/// The render that a plan is of.
fn job_of(plan: &Plan) -> Result<Job, Failure> {
    // Names in the command line are those of that folder; where it is not, a bundle has the scene.
    let _ = std::env::set_current_dir(&plan.folder);
    let line = std::iter::once("kajo".to_owned()).chain(plan.arguments.iter().cloned()).map(OsString::from);
    match Cli::read(line.collect()).map(|cli| cli.command) {
        Ok(Command::Render(args)) => args.job(),
        Ok(Command::Plan(args)) => args.render.job(),
        Ok(_) => Err(Failure::Input("the plan's command line is that of no render".to_owned())),
        Err(error) => Err(Failure::Input(format!("the plan's command line is wrong: {error}"))),
    }
}

/// Calls `act` with the split of a plan, once it is found to be what was planned.
fn with_planned<T>(
    plan: &Plan,
    job: &Job,
    bundle: Option<&Bundle>,
    act: impl FnOnce(&SplitRender<'_>, &Loaded) -> Result<T, Failure>,
) -> Result<T, Failure> {
    if bundle.is_none() {
        plan.check_files()?;
    }
    with_split_render(job, bundle, true, |split, loaded| {
        plan.check(split)?;
        act(split, loaded)
    })
}

fn read_bundle(path: Option<&Path>) -> Result<Option<Bundle>, Failure> {
    let Some(path) = path else { return Ok(None) };
    let bytes = std::fs::read(path)
        .map_err(|error| Failure::Input(format!("cannot read `{}`: {error}", path.display())))?;
    Ok(Some(Bundle::read(&bytes)?))
}

/// `kajo plan`
pub fn plan(args: &PlanArgs) -> Result<(), Failure> {
    let job = args.render.job()?;
    let line: Vec<OsString> = std::env::args_os().skip(1).collect();
    with_split_render(&job, None, args.render.run.quiet, |split, loaded| {
        let folder = folder(&job, split, loaded, line)?;
        let (stage, position) = folder.stage(split)?;
        let layout = folder.layout(split, &position)?;
        let done = folder.finished(&layout)?.iter().filter(|(of, _)| *of == stage).count();
        if args.count {
            return console::answer(&format!("{}\n", layout.units()));
        }
        console::answer(&format!(
            "{}: {} units of {} x {} pixels and {} samples, {done} of them finished\n",
            folder.folder().display(),
            layout.units(),
            folder.plan().tile,
            folder.plan().tile,
            folder.plan().samples
        ))
    })
}

/// `kajo unit`
pub fn unit(args: &UnitArgs, interrupt: &Interrupt) -> Result<(), Failure> {
    let folder = Folder::open(&args.job)?;
    let bundle = read_bundle(args.bundle.as_deref())?;
    let mut job = job_of(folder.plan())?;
    job.resources.threads = args.threads.into();
    with_planned(folder.plan(), &job, bundle.as_ref(), |split, _| {
        let (stage, position) = folder.stage(split)?;
        let layout = folder.layout(split, &position)?;
        if args.of.is_none() && args.index >= layout.units() {
            return Err(Failure::Input(format!(
                "there is no unit {}: they are counted from 0 to {}",
                args.index,
                layout.units() - 1
            )));
        }
        let step = args.of.unwrap_or(u64::MAX);
        let units = (0..).map_while(|i: u64| args.index.checked_add(i.checked_mul(step)?));
        for unit in units.take_while(|&unit| unit < layout.units()) {
            if folder.has(&layout, stage, unit) {
                continue;
            }
            let Some(work) = layout.work_unit(unit) else { break };
            let (rendered, stopped) = interrupt.during(Work::Render, || {
                split.render(&position, &work, &Meter::new(true, false).watched(interrupt))
            });
            if stopped {
                return Err(Failure::Unfinished(format!(
                    "interrupted in unit {unit}; those before it are kept"
                )));
            }
            let (film, _) = rendered?;
            let part = Part::new(folder.hash(), (stage, unit), &film, &kajo_farm::host())?;
            let (published, stopped) =
                interrupt.during(Work::Write, || folder.publish(&part, &layout, split));
            published?;
            if stopped {
                return Err(Failure::Unfinished(format!("interrupted after unit {unit}, which is kept")));
            }
        }
        Ok(())
    })
}

/// `kajo merge`
pub fn merge(args: &MergeArgs, interrupt: &Interrupt) -> Result<(), Failure> {
    let folder = Folder::open(&args.job)?;
    let bundle = read_bundle(args.bundle.as_deref())?;
    let output = args.output.as_ref().map(std::path::absolute).transpose();
    let output = output.map_err(|error| Failure::Input(format!("there is no current folder: {error}")))?;
    let mut job = job_of(folder.plan())?;
    if let (Some(path), Some(first)) = (output, job.outputs.first_mut()) {
        let destination = Destination::File(path);
        let format = destination.format()?;
        if format != first.format {
            return Err(Failure::Input(format!(
                "the plan is of a picture in another format; name one like `{}`",
                match &first.destination {
                    Destination::File(path) => path.display().to_string(),
                    Destination::StandardOutput => "a PNG".to_owned(),
                }
            )));
        }
        first.destination = destination;
    }
    with_planned(folder.plan(), &job, bundle.as_ref(), |split, loaded| match folder.merge(split)? {
        Merged::Next(stage) => Err(Failure::NotYet(format!(
            "the picture is not good enough yet; units of stage {stage} can be rendered now"
        ))),
        Merged::Complete(film) => {
            let picture = split.picture(*film, RenderStats::default());
            let mut say = |text: &str| console::report(text);
            let mut voice = Voice { color: false, quiet: args.quiet, say: &mut say };
            let done = job.write(picture, &loaded.files, interrupt, &mut voice)?;
            if !args.quiet {
                let [width, height] = done.size;
                console::line(format!("{width} x {height}, {} samples a pixel", done.samples));
            }
            Ok(())
        }
    })
}

/// `kajo bundle`
pub fn bundle(args: &BundleArgs) -> Result<(), Failure> {
    let options = args.scene_args.options();
    let assets = options.assets(&args.scene).map_err(Failure::Input)?;
    let recording = Recording::new(&assets, assets.scene_name());
    let loaded = kajo::load_from(assets.scene_name(), &recording, &options);
    if !loaded.diagnostics.is_empty() {
        console::report(&loaded.report(console::in_color()));
    }
    if loaded.scene.is_none() {
        return Err(has_errors(&args.scene, &loaded));
    }
    let path = args.output.clone().unwrap_or_else(|| args.scene.with_extension("kbundle"));
    let bundle = recording.bundle();
    let bytes = bundle.bytes()?;
    Target::check(&path, &assets.opened())?.write(&bytes)?;
    let (files, _) = bundle.size();
    console::line(format!(
        "{}: {files} file{}, {} bytes",
        path.display(),
        if files == 1 { "" } else { "s" },
        bytes.len()
    ));
    Ok(())
}

/// `kajo farm`
pub fn manage(args: &FarmCommandArgs) -> Result<(), Failure> {
    match &args.what {
        // Taken before, as they are written: their options are read by the package.
        FarmCommand::Init(args)
        | FarmCommand::Head(args)
        | FarmCommand::Join(args)
        | FarmCommand::Ssh(args) => hand_over(&args.words),
        FarmCommand::Slurm(args) => {
            // Better said here than by a log of the cluster.
            if !args.render.scene.is_file() {
                let name = console::printable(&args.render.scene.display().to_string());
                return Err(Failure::Input(format!("cannot read `{name}`: there is no such file")));
            }
            let job = args.render.job()?;
            refuse(&job)?;
            let line: Vec<OsString> = std::env::args_os().skip(1).collect();
            console::answer(&slurm::script(&line, args.array, &folder_of(&job))?)
        }
    }
}

/// The message of an error in the answer of a worker.
fn in_words(error: &FarmError) -> String {
    console::printable(&error.to_string())
}
