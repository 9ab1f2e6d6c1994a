//! `kajo gallery`: renders a list of scenes and writes a page that shows them.
//!
//! One picture after the other, each on all threads. A scene that fails is shown with its message, and the
//! others are rendered all the same.

mod manifest;
mod page;

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use kajo::output::Target;

use crate::args::{Cli, Command, GalleryArgs};
use crate::console;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::job::{Destination, Done, Job, Voice};
use crate::progress::Meter;
use manifest::Entry;
use page::{Card, Rendered};

pub fn run(args: &GalleryArgs, interrupt: &Interrupt) -> Result<(), Failure> {
    let entries = read_manifest(&args.manifest)?;
    fs::create_dir_all(&args.out).map_err(|error| {
        Failure::Output(format!("cannot make the folder `{}`: {error}", args.out.display()))
    })?;
    let page_file = Target::check(&args.out.join("index.html"), &[])?;
    let mut cards = Vec::new();
    let mut failures = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        let result = render(entry, args, interrupt);
        if !args.run.quiet {
            console::line(progress_line(i + 1, entries.len(), entry, &result));
        }
        let result = match result {
            Err((stop @ Failure::Interrupted { .. }, _)) => return Err(stop),
            Err((failure, message)) => {
                failures.push(failure);
                Err(message)
            }
            Ok(rendered) => Ok(rendered),
        };
        let arguments = entry.arguments.join(" ");
        cards.push(Card { name: entry.name.clone(), scene: entry.scene.clone(), arguments, result });
    }
    page_file.write(page::page(&title(&args.manifest), &cards).as_bytes())?;
    if !args.run.quiet {
        console::line(format_args!("{}", page_file.path().display()));
    }
    summed_up(failures, entries.len())
}

/// The first failure decides the exit code; every message was shown already.
fn summed_up(failures: Vec<Failure>, pictures: usize) -> Result<(), Failure> {
    let count = failures.len();
    let message = format!("{count} of {pictures} pictures failed");
    match failures.into_iter().next() {
        None => Ok(()),
        Some(Failure::Output(_)) => Err(Failure::Output(message)),
        Some(Failure::Memory(_)) => Err(Failure::Memory(message)),
        Some(Failure::Bug(_)) => Err(Failure::Bug(message)),
        Some(_) => Err(Failure::Input(message)),
    }
}

fn read_manifest(path: &Path) -> Result<Vec<Entry>, Failure> {
    /// No list that people write is longer, in bytes.
    const LONGEST: u64 = 16 << 20;
    let problem = |problem: String| Failure::Input(format!("cannot read `{}`: {problem}", path.display()));
    let metadata = fs::metadata(path).map_err(|error| problem(error.to_string()))?;
    if !metadata.is_file() || metadata.len() > LONGEST {
        return Err(problem("it is no list of scenes".to_owned()));
    }
    let text = fs::read_to_string(path).map_err(|error| problem(error.to_string()))?;
    manifest::parse(&text).map_err(problem)
}

/// Renders one picture; a failure comes with everything there is to say about it.
fn render(entry: &Entry, args: &GalleryArgs, interrupt: &Interrupt) -> Result<Rendered, (Failure, String)> {
    let mut said = String::new();
    let result = job(entry, args).and_then(|job| {
        let meter = Meter::new(args.run.quiet, args.run.show_progress);
        let mut say = |text: &str| said.push_str(text);
        let done =
            job.run(&meter, interrupt, &mut Voice { color: false, quiet: args.run.quiet, say: &mut say })?;
        Ok(rendered(&job, &done, &args.out))
    });
    result.map_err(|failure| {
        let message = format!("{said}{}", failure.message());
        (failure, message)
    })
}

/// The job that the command line of this entry asks for.
fn job(entry: &Entry, args: &GalleryArgs) -> Result<Job, Failure> {
    let scene = args.manifest.parent().unwrap_or(Path::new("")).join(&entry.scene);
    let scene = scene.into_os_string();
    let mut line: Vec<OsString> = match entry.is_modern {
        true => vec!["kajo".into(), "render".into(), scene],
        false => vec!["kajo".into(), "classic".into(), "--input".into(), scene],
    };
    if !entry.names_output() {
        line.extend(["--output".into(), args.out.join(format!("{}.png", entry.name)).into_os_string()]);
    }
    line.extend(entry.arguments_in(&args.out));
    let cli = Cli::read(line).map_err(|error| Failure::Input(error.to_string()))?;
    let mut job = match cli.command {
        Command::Classic(classic) => classic.job()?,
        Command::Render(render) => render.job()?,
        _ => return Err(Failure::Input("these are no arguments that a picture is rendered by".to_owned())),
    };
    job.load.dialect = job.load.dialect.or(args.scene_args.dialect);
    job.load.folders.extend(args.scene_args.assets.iter().cloned());
    job.load.allow_outside |= args.scene_args.allow_outside;
    job.resources = args.run.resources();
    job.keep_partial = args.run.keep_partial;
    Ok(job)
}

fn rendered(job: &Job, done: &Done, out: &Path) -> Rendered {
    // A picture that the list sends elsewhere cannot be linked to from the page.
    let beside_page = |destination: &Destination| match destination {
        Destination::File(path) => {
            let parts: Option<Vec<&str>> =
                path.strip_prefix(out).ok()?.iter().map(|part| part.to_str()).collect();
            Some(parts?.join("/"))
        }
        Destination::StandardOutput => None,
    };
    Rendered {
        files: job.outputs.iter().filter_map(|output| beside_page(&output.destination)).collect(),
        size: done.size,
        samples: done.samples.round() as u32,
        rays: done.stats.rays.total(),
        seconds: done.stats.seconds,
    }
}

fn progress_line(
    number: usize,
    count: usize,
    entry: &Entry,
    result: &Result<Rendered, (Failure, String)>,
) -> String {
    let name = &entry.name;
    match result {
        Ok(Rendered { size: [width, height], seconds, .. }) => {
            format!("{number:>4}/{count} {name}: {width} x {height} in {seconds:.2} s")
        }
        Err((_, message)) => format!("{number:>4}/{count} {name}: failed\n{}", message.trim_end()),
    }
}

/// The folder of the list, as the heading of the page.
fn title(manifest: &Path) -> String {
    let folder =
        manifest.canonicalize().ok().and_then(|path| path.parent()?.file_name().map(|name| name.to_owned()));
    folder.map_or_else(|| "gallery".to_owned(), |name| name.to_string_lossy().into_owned())
}
