//! Finished work into files, so that a file that cannot be written does not lose it.
//!
//! A write that fails is tried again where that may help, since disks become free and networks come back. What cannot be
//! written where it belongs after all is put beside it, into the current folder or into that for temporary files,
//! and the message says where. Where no folder takes it, there is a minute to make room.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use kajo::output::{self, OutputError, Target};
use kajo::{BitDepth, Format, ImageError, Picture, View};

use crate::console;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
use crate::output::{Destination, Output};

/// How long to wait before another attempt.
const PAUSES: [Duration; 2] = [Duration::from_millis(500), Duration::from_secs(2)];

/// How long a file is kept in memory that no folder takes.
const LAST_PAUSE: Duration = Duration::from_secs(60);

/// Bytes written between two checks whether to stop.
const CHUNK: usize = 1 << 20;

/// The bytes of a picture's file, or why there are none.
pub type Encoded = Result<Vec<u8>, ImageError>;

/// Writes the pictures of a render.
pub struct Keeper<'a> {
    pub interrupt: &'a Interrupt,
    /// Whether a signal is heard on the way. Otherwise everything is written to its end first.
    pub stoppable: bool,
    /// Bits a channel in PNG files.
    pub depth: BitDepth,
    /// After which a picture is named that has no file of its own.
    pub scene: &'a Path,
}

impl Keeper<'_> {
    /// Writes every picture, whether or not another one fails.
    ///
    /// * `targets`: for each output that is no standard output
    /// * `encoded`: what [`Picture::encode`] made of the first output, if it did already
    ///
    /// # Errors
    /// [`Failure::Output`], which says where the picture is instead, and [`Failure::Interrupted`] when a signal came.
    pub fn pictures(
        &self,
        picture: &Picture,
        outputs: &[Output],
        targets: &[Target],
        mut encoded: Option<Encoded>,
    ) -> Result<(), Failure> {
        let mut targets = targets.iter();
        let mut results = Vec::new();
        for output in outputs {
            let mut encode =
                || encoded.take().unwrap_or_else(|| picture.encode(&output.views, output.format, self.depth));
            let (encoded, interrupted) = match self.stoppable {
                true => (encode(), false),
                false => self.interrupt.during(Work::Write, encode),
            };
            let target = match &output.destination {
                Destination::File(_) => targets.next(),
                Destination::StandardOutput => None,
            };
            let result = match (encoded, target) {
                (Err(error), _) => Err(self.encoded_otherwise(picture, output, error.into())),
                (Ok(bytes), Some(target)) => self.file(target, &bytes),
                (Ok(bytes), None) => self.standard_output(&bytes),
            };
            match result {
                Err(stop @ Failure::Interrupted { .. }) if self.stoppable => return Err(stop),
                result => results.push(result),
            }
            if interrupted {
                results.push(Err(self.interrupt.failure()));
            }
        }
        Failure::all(results)
    }

    fn file(&self, target: &Target, bytes: &[u8]) -> Result<(), Failure> {
        let in_chunks = |out: &mut dyn Write| {
            bytes.chunks(CHUNK).try_for_each(|chunk| match self.stoppable && self.interrupt.is_stopping() {
                true => Err(io::Error::other("interrupted")),
                false => out.write_all(chunk),
            })
        };
        // A pipe may have no reader, and then it is for a signal to end the program; so no work is in progress.
        if target.is_stream() {
            return target.write(bytes).map_err(|error| put_elsewhere(&error, target.path(), in_chunks));
        }
        let write_it = || write(target, bytes.len(), self.stoppable, self.interrupt, in_chunks);
        let (result, interrupted) = self.interrupt.during(Work::Write, write_it);
        if interrupted { Failure::all([result, Err(self.interrupt.failure())]) } else { result }
    }

    fn standard_output(&self, bytes: &[u8]) -> Result<(), Failure> {
        let mut stdout = io::stdout().lock();
        stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(|error| {
            let needed = bytes.len();
            let error = format!("cannot write to standard output, which needs {needed} bytes: {error}");
            put_elsewhere(&error, &self.scene.with_extension("png"), |out| out.write_all(bytes))
        })
    }

    /// Puts a picture beside its file that cannot be made into what it was to be, and says so in the failure.
    fn encoded_otherwise(&self, picture: &Picture, output: &Output, failure: Failure) -> Failure {
        let path = match &output.destination {
            Destination::File(path) => path,
            Destination::StandardOutput => self.scene,
        };
        let other_formats =
            || [Format::Pfm, Format::Png].into_iter().filter(|&format| format != output.format);
        let another_file = |&view: &View| {
            other_formats().find_map(|format| {
                let bytes = picture.encode(&[view], format, BitDepth::Sixteen).ok()?;
                output::rescue(&path.with_extension(format.extension()), |out| out.write_all(&bytes))
            })
        };
        let files = output.views.iter().filter_map(another_file);
        let files: Vec<String> = files.map(|file| format!("`{}`", file.display())).collect();
        let kept = match files.is_empty() {
            true => "nor can it be kept in another format".to_owned(),
            false => format!("it is in {} instead", files.join(" and ")),
        };
        failure.with(|text| format!("cannot make `{}`: {text}; {kept}", path.display()))
    }
}

/// Writes a checkpoint at the end of a render, whatever signals come.
///
/// # Errors
/// [`Failure::Output`], which says where the state of the render is instead.
pub fn checkpoint(state: &kajo::Snapshot<'_>, target: &Target, interrupt: &Interrupt) -> Result<(), Failure> {
    write(target, state.bytes(), false, interrupt, |out| state.write(out))
}

fn write(
    target: &Target,
    bytes: usize,
    stoppable: bool,
    interrupt: &Interrupt,
    mut fill: impl FnMut(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut result = target.fill(bytes, &mut fill);
    for (i, pause) in PAUSES.into_iter().enumerate() {
        let Err(error) = &result else { return Ok(()) };
        if !may_pass(error, target) || interrupt.is_stopping() {
            break;
        }
        if i == 0 {
            console::warning(&format!("{error}; trying again"));
        }
        wait(pause, interrupt);
        result = target.fill(bytes, &mut fill);
    }
    let Err(error) = result else { return Ok(()) };
    let mut elsewhere = output::rescue(target.path(), &mut fill);
    if elsewhere.is_none() && may_pass(&error, target) {
        console::warning("no other folder can take it either; trying for another minute, or until a signal");
        let start = Instant::now();
        while elsewhere.is_none() && start.elapsed() < LAST_PAUSE && !interrupt.is_stopping() {
            wait(PAUSES[1], interrupt);
            if target.fill(bytes, &mut fill).is_ok() {
                return Ok(());
            }
            elsewhere = output::rescue(target.path(), &mut fill);
        }
    }
    match stoppable && interrupt.is_stopping() {
        true => Err(interrupt.failure()),
        false => Err(put_into(elsewhere, &error)),
    }
}

/// Whether another attempt may come to another end. Rights and limits stay what they are.
fn may_pass(error: &OutputError, target: &Target) -> bool {
    let OutputError::Write { source, .. } = error else { return false };
    match source.kind() {
        // Somebody took the file in the making for one that was left behind.
        ErrorKind::NotFound => target.has_folder(),
        ErrorKind::PermissionDenied
        | ErrorKind::ReadOnlyFilesystem
        | ErrorKind::FileTooLarge
        | ErrorKind::IsADirectory
        | ErrorKind::NotADirectory
        | ErrorKind::BrokenPipe => false,
        _ => true,
    }
}

/// Waits, unless a signal asks for the end.
fn wait(pause: Duration, interrupt: &Interrupt) {
    let start = Instant::now();
    while start.elapsed() < pause && !interrupt.is_stopping() {
        thread::sleep(Duration::from_millis(20));
    }
}

/// Writes what could not be written to a file into another one; the failure says where.
fn put_elsewhere(
    error: &dyn Display,
    path: &Path,
    fill: impl FnMut(&mut dyn Write) -> io::Result<()>,
) -> Failure {
    put_into(output::rescue(path, fill), error)
}

/// The failure of a file that was put into another one, if into any.
fn put_into(place: Option<PathBuf>, error: &dyn Display) -> Failure {
    Failure::Output(match place {
        Some(place) => format!("{error}; it is in `{}` instead", place.display()),
        None => format!("{error}; nor can any other folder take it"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{Job, Voice};
    use crate::progress::Meter;

    #[test]
    fn a_picture_that_does_not_fit_its_format_is_kept_in_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let camera = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 } Group { }";
        std::fs::write(path("scene.txt"), camera).unwrap();
        // Two things in a file that shows one, which the command line never asks for.
        let output = Output {
            destination: Destination::File(path("a.ppm")),
            format: Format::Ppm,
            views: vec![View::Color, View::Samples],
        };
        let plain = Output {
            destination: Destination::File(path("b.ppm")),
            format: Format::Ppm,
            views: vec![View::Color],
        };
        let job = Job::plain(path("scene.txt"), [4, 3], vec![output, plain]);
        let mut voice = Voice { color: false, quiet: true, say: &mut |_: &str| {} };
        let failure = job.run(&Meter::Silent, &Interrupt::default(), &mut voice).unwrap_err();
        assert!(matches!(&failure, Failure::Output(text) if text.contains("; it is in `")), "{failure:?}");
        let files = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
        let mut endings: Vec<String> =
            files.map(|name| name.to_string_lossy().rsplit('.').next().unwrap().to_owned()).collect();
        endings.sort();
        assert_eq!(endings, ["pfm", "pfm", "ppm", "txt"]);
    }
}
