//! Checkpoints: the state of a render in a file, from which it goes on to the same bits.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `kajofilm` |
//! | 4 | version of the format |
//! | 4, n | length of a text and the text: what the render is of |
//! | | the film's sums, see [`Film::save`] |
//! | | how far it is, see [`Position::save`] |
//! | 32 | BLAKE3 of everything before |
//!
//! Numbers are little-endian. The first line of the text is the [identity](crate::epoch) of the program: where it
//! differs, the picture may differ, be it by a single bit. The others name the scene by a digest of its files
//! and hold every setting that decides a bit of the picture. A checkpoint whose text differs is refused with the first
//! line that does.
//!
//! One thing may differ: the number of samples, where each of them is the same for any number
//! ([`SamplerKind::is_open_ended`](kajo_core::sampler::SamplerKind::is_open_ended)) and it does not decide where
//! they go. A render then goes on to more samples, to the bits of one that was asked for them at once.

use crate::SceneDigest;
use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use kajo_core::camera::Camera;
use kajo_core::scene::Scene;
use kajo_math::{Vec2, rng::Stream};
use kajo_render::{Film, FilmSpec, Goal, Position, Progress};

use crate::epoch::build_identity;
use crate::{Development, RenderSettings};

const MAGIC: &[u8; 8] = b"kajofilm";
const VERSION: u32 = 1;
const HASH_BYTES: u64 = 32;
const LONGEST_TEXT: u32 = 1 << 20;

/// Why a render cannot go on from a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("cannot read the checkpoint `{}`: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is something else.
    #[error("`{}` is no checkpoint of kajo", path.display())]
    NoCheckpoint {
        /// The file.
        path: PathBuf,
    },
    /// Another version of kajo wrote it.
    #[error("the checkpoint `{}` has version {found} of the format, and this kajo knows version {VERSION}", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// A program wrote it whose pictures may differ.
    #[error("the checkpoint `{}` was written by {then}, and this is {now}: go on with that program, or start afresh", path.display())]
    OtherBuild {
        /// The file.
        path: PathBuf,
        /// The first line of its description.
        then: String,
        /// That of this render.
        now: String,
    },
    /// Bytes are missing or wrong.
    #[error("the checkpoint `{}` is damaged; start afresh", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// It is of another scene, or was made with other settings.
    #[error("the checkpoint `{}` belongs to another render: it has `{then}` where this one has `{now}`", path.display())]
    OtherRender {
        /// The file.
        path: PathBuf,
        /// A line of its description.
        then: String,
        /// The line of this render's.
        now: String,
    },
    /// It was made with another number of samples, and they depend on that number.
    #[error(
        "the checkpoint `{}` is of {then}, and this render of {now}: {}",
        path.display(), in_words(*adaptive)
    )]
    OtherNumber {
        /// The file.
        path: PathBuf,
        /// "16 jittered samples a pixel".
        then: String,
        /// The same of this render.
        now: String,
        /// Whether the number decided how many samples go where, and not where in a pixel they lie.
        adaptive: bool,
    },
    /// It has more samples already than are asked for.
    #[error(
        "the checkpoint `{}` has {found} samples a pixel already, more than the {asked} of this render; \
         ask for {found} or more",
        path.display()
    )]
    MoreSamples {
        /// The file.
        path: PathBuf,
        /// Those it has, with those of a pass that was begun.
        found: u32,
        /// Those of this render.
        asked: u32,
    },
    /// Checkpoints are to be written over a file that is worth more than they are.
    #[error("the checkpoint would take the place of `{}`, which {kept}; choose another name", path.display())]
    Replaces {
        /// The file.
        path: PathBuf,
        /// What would be lost.
        kept: Kept,
    },
}

/// What a checkpoint is not written over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Kept {
    /// A file of some other kind.
    #[error("is no checkpoint of kajo")]
    NoCheckpoint,
    /// The state of a render of something else, or by another build of kajo.
    #[error("is the checkpoint of another render")]
    OtherRender,
    /// The state of this render, farther than it begins.
    #[error("is farther than this render begins")]
    Farther,
}

/// Why a render cannot go on to another number of samples, and what to do.
fn in_words(adaptive: bool) -> &'static str {
    if adaptive {
        "adaptive sampling decided by the number where samples go; go on with that number, or start afresh"
    } else {
        "where they lie depends on their number; go on with that number, or start afresh with sobol or uniform ones, \
         which can be continued"
    }
}

/// Which of its cameras takes a picture, by what it sees: the beginning of a digest of rays through places of the picture
/// and of the lens, at moments while the shutter is open.
pub(crate) fn camera_digest(camera: &Camera) -> String {
    let mut all = blake3::Hasher::new();
    for i in 0..64 {
        let stream = Stream::new(0, [i, 0], 0);
        let [x, y, u, v, time] = [0, 1, 2, 3, 4].map(|dimension| stream.uniform(dimension));
        let at = 2.0 * Vec2::new(x, y) - Vec2::ONE;
        all.update(format!("{:?}", camera.ray(at, 1.5, Vec2::new(u, v), time)).as_bytes());
    }
    all.finalize().to_hex()[..16].to_owned()
}

/// What a render is of: everything that decides a bit of its picture but the program, in lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Identity {
    text: String,
    /// See [`build_identity`].
    build: String,
    /// Whether noise decides where samples go.
    adaptive: bool,
}

impl Identity {
    pub fn new(
        digest: SceneDigest,
        (scene, camera): (&Scene, &Camera),
        settings: &RenderSettings,
        spec: &FilmSpec,
        goal: &Goal,
    ) -> Identity {
        // A picture may be developed otherwise when its render goes on, and the number of samples has a line of its own.
        let (kind, number) = settings.samples;
        let development = Development::default();
        let settings = RenderSettings { development, samples: (kind, 0), ..*settings };
        let number = if kind.is_open_ended() && !goal.adaptive {
            "any number of samples".to_owned()
        } else {
            format!("{number} {} samples a pixel", kind.name())
        };
        let digest = blake3::Hash::from_bytes(digest.0).to_hex();
        let adaptive = goal.adaptive.then_some(goal.noise);
        // The derived texts of numbers say all their digits.
        let camera = camera_digest(camera);
        let text = format!(
            "scene {digest}\ncamera {camera}\nadaptive {adaptive:?}\n{:#?}\ntexture_filter: {:?}\n{settings:#?}\n{spec:#?}\n{number}",
            scene.output.rules, scene.output.texture_filter
        );
        Identity { text, build: build_identity(), adaptive: goal.adaptive }
    }

    /// One that has this text, and is compared with others.
    pub fn of_text(text: &str) -> Identity {
        Identity { text: text.to_owned(), build: String::new(), adaptive: false }
    }

    /// The line of the program.
    pub fn build(&self) -> &str {
        &self.build
    }

    /// The text with the program's own line.
    pub fn whole_text(&self) -> String {
        format!("{}\n{}", self.build(), self.text)
    }

    /// The first line in which another identity differs: its line, and that of this one.
    pub fn difference(&self, other: &str) -> Option<(String, String)> {
        let (mut mine, mut others) = (self.text.lines(), other.lines());
        // The lines around the present one that have begun something, each with its depth.
        let mut around: Vec<(usize, &str)> = Vec::new();
        let depth = |line: &str| line.len() - line.trim_start().len();
        loop {
            match (others.next(), mine.next()) {
                (None, None) => return None,
                (then, now) if then != now => {
                    return Some((with_its_name(then, &around), with_its_name(now, &around)));
                }
                (Some(line), _) => {
                    around.retain(|&(outer, _)| outer < depth(line));
                    around.push((depth(line), line));
                }
                _ => {}
            }
        }
    }
}

/// A line of a description, behind the name of what it is a part of where it has none of its own.
///
/// * `around`: the lines before it that are no deeper than it is
fn with_its_name(line: Option<&str>, around: &[(usize, &str)]) -> String {
    let Some(line) = line else { return "nothing".to_owned() };
    let value = line.trim().trim_end_matches(',');
    let depth = line.len() - line.trim_start().len();
    let outer = around.iter().rev().filter(|&&(outer, _)| outer < depth);
    let name = outer.filter_map(|(_, line)| line.split_once(':')).map(|(name, _)| name.trim()).next();
    match name {
        Some(name) if !value.contains(": ") => format!("{name} {value}"),
        _ => value.to_owned(),
    }
}

/// Writes the state of a render.
///
/// * `threads`: to use at most; 0 for one on each core
pub(crate) fn save(
    threads: usize,
    identity: &Identity,
    film: &Film,
    position: &Position,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut out = Hashing { inner: out, hasher: blake3::Hasher::new() };
    out.write_all(MAGIC)?;
    out.write_all(&VERSION.to_le_bytes())?;
    let text = identity.whole_text();
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(text.as_bytes())?;
    film.save(threads, &mut out)?;
    position.save(&mut out)?;
    let hash = out.hasher.finalize();
    out.inner.write_all(hash.as_bytes())
}

/// Reads the state of a render that [`save`] wrote.
///
/// * `progress`: may cancel the reading
///
/// # Errors
/// [`CheckpointError`] when the file is not a whole checkpoint of this very render.
pub(crate) fn restore(
    path: &Path,
    identity: &Identity,
    spec: FilmSpec,
    schedule: &kajo_render::RenderSettings,
    progress: &dyn Progress,
) -> Result<(Film, Position), CheckpointError> {
    let failed = |source: io::Error| match source.kind() {
        ErrorKind::UnexpectedEof | ErrorKind::InvalidData => CheckpointError::Damaged { path: path.into() },
        _ => CheckpointError::Read { path: path.into(), source },
    };
    // A pipe would keep us waiting for somebody to write to it.
    if !fs::metadata(path).map_err(failed)?.is_file() {
        return Err(failed(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file")));
    }
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    let mut input = BufReader::with_capacity(1 << 16, Stoppable { inner: &file, progress });
    if bytes(&mut input).ok().as_ref() != Some(MAGIC) {
        return Err(CheckpointError::NoCheckpoint { path: path.into() });
    }
    let found = u32::from_le_bytes(bytes(&mut input).map_err(failed)?);
    if found != VERSION {
        return Err(CheckpointError::Version { path: path.into(), found });
    }
    // Nothing is believed before all of it is found whole.
    if !is_whole(&file, length, progress).map_err(failed)? {
        return Err(CheckpointError::Damaged { path: path.into() });
    }
    (&file).seek(SeekFrom::Start(12)).map_err(failed)?;
    let body = Stoppable { inner: (&file).take(length.saturating_sub(12 + HASH_BYTES)), progress };
    let mut input = BufReader::with_capacity(1 << 16, body);
    let text = text(&mut input).map_err(failed)?;
    let (then, text) = text.split_once('\n').unwrap_or((&text, ""));
    if then != identity.build() {
        let (then, now) = (then.to_owned(), identity.build().to_owned());
        return Err(CheckpointError::OtherBuild { path: path.into(), then, now });
    }
    if let Some((then, now)) = identity.difference(text) {
        if [&then, &now].iter().all(|line| line.ends_with(" samples a pixel")) {
            let adaptive = identity.adaptive;
            return Err(CheckpointError::OtherNumber { path: path.into(), then, now, adaptive });
        }
        return Err(CheckpointError::OtherRender { path: path.into(), then, now });
    }
    let film = Film::restore(spec, u64::MAX, &mut input).map_err(failed)?;
    let position = Position::restore(&film, schedule, &mut input).map_err(failed)?;
    if position.exceeds(schedule) {
        let (found, asked) = (position.samples_begun(), schedule.sampler.samples());
        return Err(CheckpointError::MoreSamples { path: path.into(), found, asked });
    }
    Ok((film, position))
}

/// Makes sure that nothing is lost when checkpoints of a render are written over the file at `path`.
///
/// * `samples`: of all pixels together, that the render begins with
/// * `resumed`: the checkpoint that it goes on from
///
/// # Errors
/// [`CheckpointError::Replaces`], and [`CheckpointError::Read`] when there is no telling.
pub(crate) fn check_replaced(
    path: &Path,
    identity: &Identity,
    samples: u64,
    resumed: Option<&Path>,
) -> Result<(), CheckpointError> {
    let is_same = |other| {
        fs::canonicalize(path).is_ok_and(|path| fs::canonicalize(other).is_ok_and(|other| path == other))
    };
    let is_empty = |metadata: fs::Metadata| !metadata.is_file() || metadata.len() == 0;
    if resumed.is_some_and(is_same) || fs::metadata(path).map_or(true, is_empty) {
        return Ok(());
    }
    let read = |source| CheckpointError::Read { path: path.into(), source };
    let mut input = BufReader::new(File::open(path).map_err(read)?);
    let replaces = |kept| Err(CheckpointError::Replaces { path: path.into(), kept });
    if bytes(&mut input).ok().as_ref() != Some(MAGIC) {
        return replaces(Kept::NoCheckpoint);
    }
    match samples_in(&mut input) {
        Ok((_, 0)) => Ok(()),
        Ok((text, found)) if text == identity.whole_text() => {
            if found > samples {
                replaces(Kept::Farther)
            } else {
                Ok(())
            }
        }
        // Another version's, or damaged: who knows.
        Ok(_) | Err(_) => replaces(Kept::OtherRender),
    }
}

/// What the rest of a checkpoint is of, and the number of all its samples, with which the film begins.
fn samples_in(input: &mut dyn Read) -> io::Result<(String, u64)> {
    if u32::from_le_bytes(bytes(input)?) != VERSION {
        return Err(ErrorKind::InvalidData.into());
    }
    let text = text(input)?;
    Ok((text, u64::from_le_bytes(bytes(input)?)))
}

/// Whether the last 32 bytes are the hash of all before them.
fn is_whole(mut file: &File, length: u64, progress: &dyn Progress) -> io::Result<bool> {
    let Some(body) = length.checked_sub(HASH_BYTES) else { return Ok(false) };
    file.seek(SeekFrom::Start(0))?;
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(Stoppable { inner: file.take(body), progress })?;
    let hash: [u8; 32] = bytes(&mut file)?;
    Ok(hasher.finalize() == hash)
}

fn text(input: &mut dyn Read) -> io::Result<String> {
    let length = u32::from_le_bytes(bytes(input)?);
    if length > LONGEST_TEXT {
        return Err(ErrorKind::InvalidData.into());
    }
    let mut text = String::new();
    input.take(length.into()).read_to_string(&mut text)?;
    Ok(text)
}

fn bytes<const N: usize>(input: &mut dyn Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// A reader that fails when a render is to stop.
struct Stoppable<'a, R> {
    inner: R,
    progress: &'a dyn Progress,
}

impl<R: Read> Read for Stoppable<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // Not `Interrupted`, at which readers try again.
        if self.progress.cancelled() { Err(io::Error::other("interrupted")) } else { self.inner.read(buffer) }
    }
}

/// A writer that hashes what goes through.
struct Hashing<'a> {
    inner: &'a mut dyn Write,
    hasher: blake3::Hasher,
}

impl Write for Hashing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_core::sampler::{Sampler, SamplerKind};
    use kajo_render::Silent;

    fn identity(build: &str, text: &str) -> Identity {
        Identity { text: text.to_owned(), build: build.to_owned(), adaptive: false }
    }

    #[test]
    fn a_checkpoint_of_another_epoch_is_refused() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let film = Film::new(FilmSpec::new(4, 3), u64::MAX).unwrap();
        save(0, &identity("kajo 1, epoch 1", "size 4"), &film, &Position::default(), &mut file.as_file())
            .unwrap();
        let schedule = kajo_render::RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
        let restored = |build, text| {
            restore(file.path(), &identity(build, text), FilmSpec::new(4, 3), &schedule, &Silent)
                .map(|(_, position)| position)
                .map_err(|error| error.to_string())
        };
        assert_eq!(restored("kajo 1, epoch 1", "size 4"), Ok(Position::default()));
        let refused = restored("kajo 1, epoch 2", "size 5").unwrap_err();
        assert!(refused.contains("was written by kajo 1, epoch 1, and this is kajo 1, epoch 2"), "{refused}");
        let refused = restored("kajo 1, epoch 1", "size 5").unwrap_err();
        assert!(refused.contains("it has `size 4` where this one has `size 5`"), "{refused}");
    }

    #[test]
    fn what_is_worth_more_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let mine = identity("kajo 1, epoch 1", "size 4");
        let film = Film::new(FilmSpec::new(4, 3), u64::MAX).unwrap();
        let mut state = Vec::new();
        save(0, &mine, &film, &Position::default(), &mut state).unwrap();
        fs::write(path("begun"), &state).unwrap();
        let at = 16 + mine.whole_text().len();
        state[at] = 12;
        fs::write(path("state"), &state).unwrap();
        fs::write(path("cut"), &state[..20]).unwrap();
        state[8] += 1;
        fs::write(path("newer"), &state).unwrap();
        fs::write(path("notes"), "no checkpoint").unwrap();
        fs::write(path("empty"), "").unwrap();
        let check = |name: &str, identity: &Identity, samples, resumed: Option<&str>| match check_replaced(
            &path(name),
            identity,
            samples,
            resumed.map(path).as_deref(),
        ) {
            Ok(()) => None,
            Err(CheckpointError::Replaces { kept, .. }) => Some(kept),
            Err(other) => panic!("{other}"),
        };
        let other = identity("kajo 1, epoch 1", "size 5");
        let rebuilt = identity("kajo 1, epoch 2", "size 4");
        for free in ["nothing", "empty", "begun"] {
            assert_eq!(check(free, &other, 0, None), None, "{free}");
        }
        assert_eq!(check("state", &mine, 11, None), Some(Kept::Farther));
        assert_eq!(check("state", &mine, 11, Some("begun")), Some(Kept::Farther));
        assert_eq!(check("state", &mine, 12, None), None);
        assert_eq!(check("state", &other, 0, Some("./state")), None, "it goes on from it");
        for identity in [&other, &rebuilt] {
            assert_eq!(check("state", identity, 99, None), Some(Kept::OtherRender));
        }
        assert_eq!(check("cut", &mine, 0, None), Some(Kept::OtherRender));
        assert_eq!(check("newer", &mine, 99, None), Some(Kept::OtherRender));
        assert_eq!(check("notes", &mine, 99, None), Some(Kept::NoCheckpoint));
    }

    #[test]
    fn the_first_difference_is_told() {
        let identity = identity("kajo 1", "kajo 1\nsize 4\nseed 7");
        assert_eq!(identity.difference("kajo 1\nsize 4\nseed 7"), None);
        let pair = |a: &str, b: &str| Some((a.to_owned(), b.to_owned()));
        assert_eq!(identity.difference("kajo 1\n  size 5\nseed 8"), pair("size 5", "size 4"));
        assert_eq!(identity.difference("kajo 1\nsize 4"), pair("nothing", "seed 7"));
    }

    #[test]
    fn a_difference_says_what_it_is_of() {
        let text = "Settings {\n    size: [\n        40,\n        30,\n    ],\n    samples: (\n        Sobol,\n        \
                    64,\n    ),\n    seed: 7,\n}";
        let mine = identity("kajo 1", text);
        let pair = |a: &str, b: &str| Some((a.to_owned(), b.to_owned()));
        assert_eq!(mine.difference(&text.replace("30", "31")), pair("size 31", "size 30"));
        assert_eq!(mine.difference(&text.replace("64", "128")), pair("samples 128", "samples 64"));
        assert_eq!(mine.difference(&text.replace("Sobol", "Pmj")), pair("samples Pmj", "samples Sobol"));
        assert_eq!(mine.difference(&text.replace(": 7", ": 8")), pair("seed: 8", "seed: 7"));
        assert_eq!(mine.difference(text), None);
    }

    #[test]
    fn digests_follow_contents_and_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str, content: &str| {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            path
        };
        let (a, b, c) = (path("a", "one"), path("b", "two"), path("c", "one"));
        let of = |paths: &[&PathBuf]| {
            SceneDigest::of_files(&paths.iter().map(|&path| path.clone()).collect::<Vec<_>>()).unwrap()
        };
        assert_eq!(of(&[&a, &b]), of(&[&c, &b]));
        assert_ne!(of(&[&a, &b]), of(&[&b, &a]));
        assert_ne!(of(&[&a]), of(&[&a, &c]));
        assert!(SceneDigest::of_files(&[folder.path().join("nothing")]).is_err());
    }
}
