//! `kajo render --frames`: the pictures of a film, one after the other.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo::{Animation, LoadOptions, MeshStore};

use super::{statistics, summary};
use crate::args::{FrameArgs, Frames, RenderArgs, Workers, has_number, range};
use crate::console;
use crate::failure::Failure;
use crate::farm;
use crate::film::Film;
use crate::interrupt::Interrupt;
use crate::job::{Done, Job, Voice};
use crate::output::Destination;
use crate::progress::Meter;

/// Renders the frames that are asked for.
///
/// # Errors
/// That of the first frame that could not be made, which it names. Pictures of frames before it stay.
pub fn frames(args: &RenderArgs, interrupt: &Interrupt) -> Result<(), Failure> {
    let load = args.scene_args.options();
    let animation = kajo::animation(&args.scene, &LoadOptions { fps: args.frames.fps, ..load });
    let list = list(&args.frames, animation, &args.scene)?;
    let film = match args.output.as_deref().filter(|path| Film::is_one(path)) {
        Some(path) => Some(Film::new(path, args.frames.fps.or(animation.map(|a| a.fps)), list.len())?),
        None => None,
    };
    let jobs = jobs(args, &list, film.as_ref())?;
    let (mut made, mut kept, mut heard) = (0, 0, HashSet::new());
    for (frame, job) in &jobs {
        if args.frames.keep_frames && is_complete(job) {
            kept += 1;
            continue;
        }
        let done = one(args, job, interrupt, &mut heard);
        let done = done.map_err(|failure| failure.with(|text| in_frame(*frame, text)))?;
        made += 1;
        if !args.run.quiet {
            let so_far = made + kept;
            console::line(format!("frame {frame} ({so_far} of {}): {}", list.len(), summary(job, &done)));
        }
        if args.run.stats {
            console::line(statistics(&done));
        }
    }
    if kept > 0 && !args.run.quiet {
        console::line(format!("{kept} frame{} kept as they were", if kept == 1 { "" } else { "s" }));
    }
    let Some(film) = film else { return Ok(()) };
    let pictures: Vec<PathBuf> = jobs.iter().flat_map(|(_, job)| files(job).take(1)).collect();
    film.join(&pictures)?;
    if !args.run.quiet {
        console::line(format!("{}: {} frames", film.path().display(), pictures.len()));
    }
    Ok(())
}

/// A message with the frame that it is about.
fn in_frame(frame: i64, text: &str) -> String {
    if text.is_empty() {
        format!("frame {frame} could not be made")
    } else {
        format!("frame {frame}: {text}")
    }
}

/// The numbers of the frames.
fn list(args: &FrameArgs, animation: Option<Animation>, scene: &Path) -> Result<Vec<i64>, Failure> {
    match &args.frames {
        Some(Frames::List(list)) => Ok(list.clone()),
        Some(Frames::All) | None => {
            let frames = animation.and_then(|animation| animation.frames).ok_or_else(|| {
                let text = "does not say which frames it has; write `Animation { frames 1 240 }` there, or give `--frames 1..240`";
                Failure::Input(format!("`{}` {text}", scene.display()))
            })?;
            range(frames, 1).map(Iterator::collect).map_err(Failure::Input)
        }
    }
}

/// What is to be rendered for each frame, once it is sure that no frame writes over the picture of another.
fn jobs(args: &RenderArgs, list: &[i64], film: Option<&Film>) -> Result<Vec<(i64, Job)>, Failure> {
    if list.len() > 1 {
        check_names(args, film, list.len())?;
    }
    let meshes = Some(Arc::new(MeshStore::default()));
    let mut jobs = Vec::with_capacity(list.len());
    let mut owners: HashMap<PathBuf, i64> = HashMap::new();
    for &frame in list {
        let mut job = args.job_of(Some(frame), film.map(Film::pattern))?;
        job.load.meshes.clone_from(&meshes);
        for path in files(&job).chain(job.passes.checkpoint.clone()) {
            if let Some(other) = owners.insert(path.clone(), frame).filter(|&other| other != frame) {
                return Err(Failure::Input(format!(
                    "frame {frame} would write over `{}`, which is a picture of frame {other}",
                    path.display()
                )));
            }
        }
        jobs.push((frame, job));
    }
    Ok(jobs)
}

/// Makes sure that every name has a place for the number of a frame.
fn check_names(args: &RenderArgs, film: Option<&Film>, count: usize) -> Result<(), Failure> {
    if matches!(args.farm.farm, Some(Workers::Cluster(_) | Workers::Engine)) {
        return Err(Failure::Input(
            "a cluster renders one frame a command, as in `--frames 12`; `--farm local:N` takes several"
                .to_owned(),
        ));
    }
    if args.passes.resume.is_some() {
        return Err(Failure::Input(
            "`--resume` goes on with the render of one picture; give its frame alone, as in `--frames 12`"
                .to_owned(),
        ));
    }
    let main = args.output.iter().filter(|_| film.is_none());
    let named = main.chain(args.aov.iter().filter_map(|aov| aov.path.as_ref()));
    for path in named.chain(&args.passes.checkpoint) {
        if path.as_os_str() == "-" {
            return Err(Failure::Input(format!(
                "{count} frames do not fit standard output: name files, as in `-o out.####.png`"
            )));
        }
        if !has_number(path)? {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let ending = path.extension().unwrap_or_default().to_string_lossy();
            return Err(Failure::Input(format!(
                "each of {count} frames would write over `{}`; write `#` where their numbers belong: {stem}.####.{ending}",
                path.display()
            )));
        }
    }
    Ok(())
}

/// The files that a job writes pictures to.
fn files(job: &Job) -> impl Iterator<Item = PathBuf> + '_ {
    job.outputs.iter().filter_map(|output| match &output.destination {
        Destination::File(path) => Some(path.clone()),
        Destination::StandardOutput => None,
    })
}

/// Whether all pictures of a frame are there; files are written whole or not at all.
fn is_complete(job: &Job) -> bool {
    files(job).all(|path| path.is_file())
}

/// Renders one frame.
///
/// * `heard`: what was said about the frames before
fn one(
    args: &RenderArgs,
    job: &Job,
    interrupt: &Interrupt,
    heard: &mut HashSet<String>,
) -> Result<Done, Failure> {
    let meter = Meter::new(args.run.quiet, args.run.show_progress);
    let mut say = |text: &str| {
        // What is to be said about all frames is said once.
        if heard.insert(text.to_owned()) {
            console::report(text);
        }
    };
    let mut voice = Voice { color: console::in_color(), quiet: args.run.quiet, say: &mut say };
    match &job.farm.farm {
        Some(workers) => farm::render(job, workers, &meter, interrupt, &mut voice),
        None => {
            farm::refuse_alone(job)?;
            job.run(&meter, interrupt, &mut voice)
        }
    }
}
