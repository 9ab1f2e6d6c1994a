//! `kajo gallery`: renders a list of scenes and writes a page that shows them.
//!
//! One picture after the other, each on all threads. A scene that fails is shown with its message, and the
//! others are rendered all the same. The page is written after each of them.
//!
//! A list may come from a stranger, as a scene may: it reads scenes in its own folder, writes to the gallery's, and
//! cannot lift a limit or reach the network. For more there is the command line.

mod manifest;
mod page;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use kajo::output::Target;
use kajo::{AssetError, FsAssets, Resources};

use crate::args::{Cli, Command, GalleryArgs};
use crate::console;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
use crate::job::{Done, Job, Voice};
use crate::output::Destination;
use crate::progress::Meter;
use manifest::Entry;
use page::{Card, Rendered};

pub fn run(args: &GalleryArgs, interrupt: &Interrupt) -> Result<(), Failure> {
    let entries = read_manifest(&args.manifest)?;
    fs::create_dir_all(&args.out).map_err(|error| {
        Failure::Output(format!("cannot make the folder `{}`: {error}", args.out.display()))
    })?;
    // What the list names is not overwritten, in whichever order it is read.
    let mut read: Vec<PathBuf> = entries.iter().filter_map(|entry| scene(entry, args).ok()).collect();
    read.push(args.manifest.clone());
    let page_file = Target::check(&args.out.join("index.html"), &read)?;
    let title = title(&args.manifest);
    let mut written = Ok(());
    let mut cards = Vec::new();
    let mut failures = Vec::new();
    for (i, entry) in entries.iter().enumerate() {
        let result = render(entry, args, &read, interrupt);
        if !args.run.quiet || !is_silent(&result) {
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
        // After each picture, so that there is a page of what is finished however the gallery ends.
        let html = page::page(&title, &cards, entries.len());
        let (result, interrupted) = interrupt.during(Work::Write, || page_file.write(html.as_bytes()));
        if interrupted {
            return Err(interrupt.failure());
        }
        written = result;
    }
    written?;
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

/// Whether there is neither an error nor a warning.
fn is_silent(result: &Result<Rendered, (Failure, String)>) -> bool {
    match result {
        Ok(rendered) => rendered.said.is_empty(),
        Err((failure, _)) => matches!(failure, Failure::Interrupted { .. }),
    }
}

/// Renders one picture; a failure comes with all diagnostics.
///
/// * `read`: files that must not be overwritten
fn render(
    entry: &Entry,
    args: &GalleryArgs,
    read: &[PathBuf],
    interrupt: &Interrupt,
) -> Result<Rendered, (Failure, String)> {
    let mut said = String::new();
    let result = job(entry, args).and_then(|job| {
        let job = Job { kept: read.to_vec(), ..job };
        let meter = Meter::new(args.run.quiet, args.run.show_progress);
        let mut say = |text: &str| said.push_str(text);
        let done =
            job.run(&meter, interrupt, &mut Voice { color: false, quiet: args.run.quiet, say: &mut say })?;
        Ok(rendered(&job, &done, &args.out))
    });
    match result {
        Ok(rendered) => Ok(Rendered { said, ..rendered }),
        Err(failure) => {
            let message = format!("{said}{}", failure.message());
            Err((failure, message))
        }
    }
}

/// The job that the command line of this entry asks for.
fn job(entry: &Entry, args: &GalleryArgs) -> Result<Job, Failure> {
    let scene = scene(entry, args)?;
    let mut line: Vec<OsString> = match entry.is_modern {
        true => vec!["kajo".into(), "render".into(), scene.clone().into()],
        false => vec!["kajo".into(), "classic".into(), "--input".into(), scene.clone().into()],
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
    if job.scene != scene {
        return Err(Failure::Input("a line of a list has one scene, which stands after the name".to_owned()));
    }
    let out = confine(&job, args)?;
    job.load.dialect = job.load.dialect.or(args.scene_args.dialect);
    job.load.folders.extend(args.scene_args.assets.iter().cloned());
    job.load.allow_outside |= args.scene_args.allow_outside;
    job.resources = args.run.resources();
    job.keep_partial = args.run.keep_partial;
    job.confined_to = Some(out);
    Ok(job)
}

/// The scene of this entry, which lies where a scene in the list's place could include it from.
fn scene(entry: &Entry, args: &GalleryArgs) -> Result<PathBuf, Failure> {
    let beside = args.manifest.parent().unwrap_or(Path::new("")).join(&entry.scene);
    let mut files = FsAssets::new(&args.manifest).map_err(|error| Failure::Input(error.to_string()))?;
    for folder in &args.scene_args.assets {
        files = files.with_folder(folder).map_err(|error| {
            Failure::Input(format!("cannot enter the folder `{}`: {error}", folder.display()))
        })?;
    }
    match files.allow_outside(args.scene_args.allow_outside).locate(&entry.scene) {
        Ok(path) => Ok(path),
        Err(AssetError::Outside) => Err(Failure::Input(format!(
            "`{}` lies outside the list's folder; --assets DIR or --allow-outside lets it be read",
            entry.scene
        ))),
        // The loader says more about it.
        Err(AssetError::NotFound | AssetError::Io(_)) => Ok(beside),
        Err(error) => Err(Failure::Input(format!("`{}`: {error}", entry.scene))),
    }
}

/// Refuses what a line of a list may not ask for. Returns the real path of the only folder it may write to.
fn confine(job: &Job, args: &GalleryArgs) -> Result<PathBuf, Failure> {
    let refuse =
        |what: &str| Err(Failure::Input(format!("{what} belongs to the command line of `kajo gallery`")));
    if job.load.allow_outside {
        return refuse("`--allow-outside`");
    }
    if !job.load.folders.is_empty() {
        return refuse("`--assets`");
    }
    if job.resources != Resources::default() {
        return refuse("what a render may use (`--memory`, `--threads`, `--tile`)");
    }
    if job.passes.tev.is_some() {
        return Err(Failure::Input("`--tev` opens a connection, which a list may not".to_owned()));
    }
    if job.outputs.iter().any(|output| matches!(output.destination, Destination::StandardOutput)) {
        return Err(Failure::Input("a list may not write to standard output".to_owned()));
    }
    let out = fs::canonicalize(&args.out).map_err(|error| {
        Failure::Output(format!("cannot enter the folder `{}`: {error}", args.out.display()))
    })?;
    let is_within = |path: &PathBuf| fs::canonicalize(path).is_ok_and(|path| path.starts_with(&out));
    match &job.passes.resume {
        Some(path) if !is_within(path) => Err(Failure::Input(format!(
            "there is no checkpoint `{}` in `{}`; `@` stands for the place and name of the picture",
            path.display(),
            args.out.display()
        ))),
        _ => Ok(out),
    }
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
        said: String::new(),
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
        Ok(Rendered { size: [width, height], seconds, said, .. }) => {
            let said = said.trim_end();
            let line_end = if said.is_empty() { "" } else { "\n" };
            format!("{number:>4}/{count} {name}: {width} x {height} in {seconds:.2} s{line_end}{said}")
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
