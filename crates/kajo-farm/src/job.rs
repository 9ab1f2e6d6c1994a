//! The folder of a job: what is finished, and nothing else counts.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use kajo::{Film, Position, SplitRender};

use crate::part::{PartError, Reader};
use crate::sums::TileSums;
use crate::{FarmError, Layout, Part, Plan, files, plan};

/// Parts of a tile that are there before they are put together.
const PARTS_OF_A_TILE: usize = 4;

/// No file of a job is longer.
const LONGEST: u64 = 1 << 40;

const STAGE_MAGIC: &[u8; 8] = b"kajostag";

/// The folder of a job.
#[derive(Debug)]
pub struct Job {
    folder: PathBuf,
    plan: Plan,
    text: String,
    hash: [u8; 32],
}

/// What became of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Published {
    /// It is the first.
    First,
    /// An equal one was there.
    Again,
}

/// What came of putting a stage together.
#[derive(Debug)]
pub enum Merged {
    /// The whole picture.
    Complete(Box<Film>),
    /// It goes on with this stage.
    Next(u32),
}

/// Nobody else coordinates a job while this is held.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Job {
    /// Makes a job's folder, or finds the one that is there already.
    ///
    /// # Errors
    /// [`FarmError::Input`] when the folder belongs to another render; [`FarmError::Io`].
    pub fn create(folder: &Path, plan: &Plan, split: &SplitRender<'_>) -> Result<Job, FarmError> {
        let io = FarmError::io(folder);
        for name in ["parts", "sums", "stages", "damaged", "logs"] {
            fs::create_dir_all(folder.join(name)).map_err(io)?;
        }
        let text = serde_json::to_string_pretty(plan).map_err(|error| FarmError::Input(error.to_string()))?;
        files::publish(&folder.join("plan.json"), text.as_bytes()).map_err(io)?;
        let job = Job::open(folder)?;
        job.plan.check(split).map_err(|error| {
            FarmError::Input(format!(
                "the folder `{}` belongs to another render: {error}; remove it, or name another with --job",
                folder.display()
            ))
        })?;
        ["parts", "sums", "stages"].iter().for_each(|name| files::sweep(&folder.join(name)));
        Ok(job)
    }

    /// Opens a job's folder.
    ///
    /// # Errors
    /// When there is no plan in it.
    pub fn open(folder: &Path) -> Result<Job, FarmError> {
        let path = folder.join("plan.json");
        let bytes = files::read(&path, plan::LONGEST).map_err(FarmError::io(&path))?.ok_or_else(|| {
            FarmError::Input(format!(
                "there is no plan in `{}`; `kajo plan SCENE --job {0}` makes one",
                folder.display()
            ))
        })?;
        let text = String::from_utf8(bytes)
            .map_err(|_| FarmError::Input(format!("`{}` is no plan of kajo", path.display())))?;
        let hash = plan::plan_hash(&text);
        let folder = fs::canonicalize(folder).map_err(FarmError::io(folder))?;
        Ok(Job { folder, plan: Plan::read(&text)?, text, hash })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The plan's text, as workers are told it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// BLAKE3 of the plan.
    pub fn hash(&self) -> &[u8; 32] {
        &self.hash
    }

    /// The folder, by its real path.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Makes sure that nobody else coordinates the job.
    ///
    /// # Errors
    /// [`FarmError::Input`] when somebody does.
    pub fn lock(&self) -> Result<Lock, FarmError> {
        let path = self.folder.join("lock");
        let mut file = open_lock(&path)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let who = fs::read_to_string(&path).unwrap_or_default();
                Err(FarmError::Input(format!(
                    "`{}` is being rendered by {} already",
                    self.folder.display(),
                    if who.trim().is_empty() { "another coordinator" } else { who.trim() }
                )))
            }
            // Some file systems have no locks. Two coordinators then only do some work twice.
            Err(TryLockError::Error(_)) | Ok(()) => {
                let _ = file.set_len(0).and_then(|()| file.write_all(crate::host().as_bytes()));
                Ok(Lock { _file: file })
            }
        }
    }

    /// The stage at hand and where it begins; the first unless another was begun.
    ///
    /// # Errors
    /// [`FarmError::Io`].
    pub fn stage(&self, split: &SplitRender<'_>) -> Result<(u32, Position), FarmError> {
        let bytes = self.stage_bytes()?;
        match bytes {
            None => Ok((0, Position::default())),
            Some((stage, bytes)) => Ok((stage, position(split, &bytes)?)),
        }
    }

    /// The number of the stage at hand and the bytes of its beginning, for workers; `None` for the first.
    ///
    /// # Errors
    /// [`FarmError::Io`]; [`FarmError::Input`] when the file is damaged.
    pub fn stage_bytes(&self) -> Result<Option<(u32, Vec<u8>)>, FarmError> {
        let folder = self.folder.join("stages");
        let names = files::names(&folder).map_err(FarmError::io(&folder))?;
        let number = |name: &String| name.strip_suffix(".kstage").and_then(|name| name.parse::<u32>().ok());
        let Some(stage) = names.iter().filter_map(number).max() else { return Ok(None) };
        let path = folder.join(stage_name(stage));
        let bytes = files::read(&path, LONGEST).map_err(FarmError::io(&path))?.unwrap_or_default();
        match self.stage_position(&bytes) {
            Some(position) => Ok(Some((stage, position.to_vec()))),
            None => {
                let damaged =
                    FarmError::Input(format!("`{}` is damaged and was removed; try again", path.display()));
                files::remove(&path).map_err(FarmError::io(&path))?;
                Err(damaged)
            }
        }
    }

    fn stage_position<'a>(&self, bytes: &'a [u8]) -> Option<&'a [u8]> {
        let (body, hash) = bytes.split_last_chunk::<32>()?;
        let mut rest = Reader(body);
        let is_ours = blake3::hash(body) == *hash
            && rest.take().ok()? == *STAGE_MAGIC
            && rest.take().ok()? == self.hash;
        is_ours.then_some(rest.0)
    }

    fn begin_stage(&self, stage: u32, split: &SplitRender<'_>, position: &Position) -> Result<(), FarmError> {
        let path = self.folder.join("stages").join(stage_name(stage));
        let mut bytes = [STAGE_MAGIC.as_slice(), &self.hash].concat();
        split.save_position(position, &mut bytes).map_err(FarmError::io(&path))?;
        bytes.extend(*blake3::hash(&bytes).as_bytes());
        files::publish(&path, &bytes).map(|_| ()).map_err(FarmError::io(&path))
    }

    /// The units of a stage.
    ///
    /// # Errors
    /// When there are too many.
    pub fn layout(&self, split: &SplitRender<'_>, position: &Position) -> Result<Layout, FarmError> {
        self.plan.layout(split.stage(position).unwrap_or_default())
    }

    /// The units that are finished, by stage, as far as files are found whole; others are set aside.
    ///
    /// # Errors
    /// [`FarmError::Io`].
    pub fn finished(&self, layout: &Layout) -> Result<BTreeSet<(u32, u64)>, FarmError> {
        let mut finished: BTreeSet<(u32, u64)> = BTreeSet::new();
        for tile in 0..layout.tiles() {
            if let Some((_, sums)) = self.sums(tile)? {
                finished.extend(sums.units.keys());
            }
        }
        for (path, _, _) in self.parts()? {
            finished.extend(self.part(&path)?.map(|part| (part.stage, part.unit)));
        }
        Ok(finished)
    }

    /// Whether a unit's result is there, by its name alone.
    pub fn has(&self, layout: &Layout, stage: u32, unit: u64) -> bool {
        self.part_path(stage, unit).exists()
            || self
                .sums(layout.tile_of(unit))
                .is_ok_and(|sums| sums.is_some_and(|(_, sums)| sums.units.contains_key(&(stage, unit))))
    }

    /// Publishes the result of a unit, and puts those of its tile together once there are several.
    ///
    /// # Errors
    /// [`FarmError::TwoResults`] when another result of the unit is there; [`FarmError::Io`].
    pub fn publish(
        &self,
        part: &Part,
        layout: &Layout,
        split: &SplitRender<'_>,
    ) -> Result<Published, FarmError> {
        let path = self.part_path(part.stage, part.unit);
        let tile = layout.tile_of(part.unit);
        if let Some((_, sums)) = self.sums(tile)?
            && let Some(&first) = sums.units.get(&(part.stage, part.unit))
        {
            return self.compare(part, first, "an earlier worker");
        }
        for _ in 0..3 {
            if files::publish(&path, part.bytes()).map_err(FarmError::io(&path))? {
                let of_tile =
                    self.parts()?.iter().filter(|(_, _, unit)| layout.tile_of(*unit) == tile).count();
                if of_tile >= PARTS_OF_A_TILE {
                    self.fold(tile, layout, split)?;
                }
                return Ok(Published::First);
            }
            // One that is damaged is set aside, and the name is free.
            if let Some(first) = self.part(&path)? {
                return self.compare(part, first.digest, &first.host);
            }
        }
        Ok(Published::Again)
    }

    fn compare(&self, part: &Part, first: [u8; 32], host: &str) -> Result<Published, FarmError> {
        if part.digest == first {
            return Ok(Published::Again);
        }
        let name = format!("{:03}-{:07}-second.kpart", part.stage, part.unit);
        let kept = self.folder.join("damaged").join(name);
        files::publish(&kept, part.bytes()).map_err(FarmError::io(&kept))?;
        let (first, second) = (host.to_owned(), part.host.clone());
        Err(FarmError::TwoResults { stage: part.stage, unit: part.unit, first, second, kept })
    }

    /// Puts the parts of a tile together into one file, unless somebody else does so.
    ///
    /// # Errors
    /// [`FarmError::TwoResults`]; [`FarmError::Io`].
    pub fn fold(&self, tile: u64, layout: &Layout, split: &SplitRender<'_>) -> Result<(), FarmError> {
        let lock = open_lock(&self.folder.join("sums").join("lock"))?;
        if let Err(TryLockError::WouldBlock) = lock.try_lock() {
            return Ok(());
        }
        let parts: Vec<PathBuf> = self
            .parts()?
            .into_iter()
            .filter(|(_, _, unit)| layout.tile_of(*unit) == tile)
            .map(|(path, _, _)| path)
            .collect();
        if parts.is_empty() {
            return Ok(());
        }
        let film = split.new_film()?;
        let (generation, mut units) = match self.tile_film(tile, split)? {
            Some((generation, sums, old)) => {
                add(&film, old)?;
                (generation + 1, sums.units)
            }
            None => (0, BTreeMap::new()),
        };
        for path in &parts {
            let Some(part) = self.part(path)? else { continue };
            match units.get(&(part.stage, part.unit)) {
                Some(&first) => _ = self.compare(&part, first, "an earlier worker")?,
                None => match part.film(split) {
                    Ok(more) => {
                        add(&film, more)?;
                        units.insert((part.stage, part.unit), part.digest);
                    }
                    Err(_) => self.set_aside(path)?,
                },
            }
        }
        let path = self.sums_path(tile, generation);
        let bytes = TileSums::new(units, &film)?.bytes(&self.hash, tile);
        // A process without locks may have been faster, and then it tidies up.
        if files::publish(&path, &bytes).map_err(FarmError::io(&path))? {
            self.tidy(tile, &parts)?;
        }
        Ok(())
    }

    /// Removes what is in the newest sums of a tile: older ones, and parts.
    fn tidy(&self, tile: u64, parts: &[PathBuf]) -> Result<(), FarmError> {
        let Some((newest, sums)) = self.sums(tile)? else { return Ok(()) };
        for path in parts {
            if self.part(path)?.is_some_and(|part| sums.units.contains_key(&(part.stage, part.unit))) {
                files::remove(path).map_err(FarmError::io(path))?;
            }
        }
        for generation in self.generations(tile)?.into_iter().filter(|&generation| generation < newest) {
            let path = self.sums_path(tile, generation);
            files::remove(&path).map_err(FarmError::io(&path))?;
        }
        Ok(())
    }

    /// Puts everything together; the render goes on if its goal is not reached.
    ///
    /// # Errors
    /// [`FarmError::NotYet`] when units are missing; [`FarmError::TwoResults`]; [`FarmError::Io`].
    pub fn merge(&self, split: &SplitRender<'_>) -> Result<Merged, FarmError> {
        let (stage, mut position) = self.stage(split)?;
        let layout = self.layout(split, &position)?;
        let (film, found) = {
            let lock = open_lock(&self.folder.join("sums").join("lock"))?;
            // Where there are no locks, a file that is tidied away meanwhile is found missing, and one tries again.
            let _ = lock.lock();
            self.sum(&layout, split)?
        };
        let missing: Vec<u64> = (0..layout.units()).filter(|&unit| !found.contains(&(stage, unit))).collect();
        if let Some(first) = missing.first() {
            return Err(FarmError::NotYet(format!(
                "{} of {} units of stage {stage} are missing, unit {first} the first of them",
                missing.len(),
                layout.units()
            )));
        }
        if split.end_stage(&mut position, &film) {
            return Ok(Merged::Complete(Box::new(film)));
        }
        self.begin_stage(stage + 1, split, &position)?;
        Ok(Merged::Next(stage + 1))
    }

    /// What there is of the picture so far, for a look at it: the sum of all that is finished.
    ///
    /// # Errors
    /// As [`Job::merge`].
    pub fn so_far(&self, split: &SplitRender<'_>) -> Result<Film, FarmError> {
        let (_, position) = self.stage(split)?;
        Ok(self.sum(&self.layout(split, &position)?, split)?.0)
    }

    /// The sum of all results, and whose they are.
    fn sum(
        &self,
        layout: &Layout,
        split: &SplitRender<'_>,
    ) -> Result<(Film, BTreeSet<(u32, u64)>), FarmError> {
        let film = split.new_film()?;
        let mut digests = BTreeMap::new();
        for tile in 0..layout.tiles() {
            if let Some((_, sums, of_tile)) = self.tile_film(tile, split)? {
                add(&film, of_tile)?;
                digests.extend(sums.units);
            }
        }
        for (path, _, _) in self.parts()? {
            let Some(part) = self.part(&path)? else { continue };
            match digests.get(&(part.stage, part.unit)) {
                Some(&first) => _ = self.compare(&part, first, "an earlier worker")?,
                None => match part.film(split) {
                    Ok(more) => {
                        add(&film, more)?;
                        digests.insert((part.stage, part.unit), part.digest);
                    }
                    Err(_) => self.set_aside(&path)?,
                },
            }
        }
        Ok((film, digests.into_keys().collect()))
    }

    /// The newest sums of a tile that are whole, with their film.
    fn tile_film(
        &self,
        tile: u64,
        split: &SplitRender<'_>,
    ) -> Result<Option<(u32, TileSums, Film)>, FarmError> {
        while let Some((generation, sums)) = self.sums(tile)? {
            match sums.film(split) {
                Ok(film) => return Ok(Some((generation, sums, film))),
                Err(_) => self.set_aside(&self.sums_path(tile, generation))?,
            }
        }
        Ok(None)
    }

    /// The newest sums of a tile that are whole, and their generation. Those that are not are set aside.
    fn sums(&self, tile: u64) -> Result<Option<(u32, TileSums)>, FarmError> {
        for generation in self.generations(tile)?.into_iter().rev() {
            let path = self.sums_path(tile, generation);
            let Some(bytes) = files::read(&path, LONGEST).map_err(FarmError::io(&path))? else { continue };
            match TileSums::read(&bytes, &self.hash, tile) {
                Ok(sums) => return Ok(Some((generation, sums))),
                Err(_) => self.set_aside(&path)?,
            }
        }
        Ok(None)
    }

    fn generations(&self, tile: u64) -> Result<Vec<u32>, FarmError> {
        let folder = self.folder.join("sums");
        let start = format!("{tile:07}.");
        let number = |name: &String| name.strip_prefix(&start)?.strip_suffix(".ksums")?.parse().ok();
        let names = files::names(&folder).map_err(FarmError::io(&folder))?;
        let mut generations: Vec<u32> = names.iter().filter_map(number).collect();
        generations.sort_unstable();
        Ok(generations)
    }

    /// Files of parts, with the stages and units in their names.
    fn parts(&self) -> Result<Vec<(PathBuf, u32, u64)>, FarmError> {
        let folder = self.folder.join("parts");
        let numbers = |name: &String| {
            let (stage, unit) = name.strip_suffix(".kpart")?.split_once('-')?;
            Some((folder.join(name), stage.parse().ok()?, unit.parse().ok()?))
        };
        let names = files::names(&folder).map_err(FarmError::io(&folder))?;
        Ok(names.iter().filter_map(numbers).collect())
    }

    /// A part, if it is there and whole; otherwise it is set aside.
    fn part(&self, path: &Path) -> Result<Option<Part>, FarmError> {
        let Some(bytes) = files::read(path, LONGEST).map_err(FarmError::io(path))? else { return Ok(None) };
        match Part::read(bytes, &self.hash) {
            Ok(part) if path == self.part_path(part.stage, part.unit) => Ok(Some(part)),
            Ok(_) | Err(PartError::Damaged | PartError::OtherPlan) => self.set_aside(path).map(|()| None),
        }
    }

    /// Puts a file where it counts no more.
    fn set_aside(&self, path: &Path) -> Result<(), FarmError> {
        let name = path.file_name().unwrap_or_default();
        match fs::rename(path, self.folder.join("damaged").join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(FarmError::io(path)(error)),
            _ => Ok(()),
        }
    }

    /// Writes what was said about a failed try.
    pub fn log(&self, stage: u32, unit: u64, attempt: usize, text: &str) {
        let path = self.folder.join("logs").join(format!("{stage:03}-{unit:07}-try{attempt}.txt"));
        // A log that cannot be written is no reason to stop.
        let _ = fs::write(path, text);
    }

    fn part_path(&self, stage: u32, unit: u64) -> PathBuf {
        self.folder.join("parts").join(format!("{stage:03}-{unit:07}.kpart"))
    }

    fn sums_path(&self, tile: u64, generation: u32) -> PathBuf {
        self.folder.join("sums").join(format!("{tile:07}.{generation:06}.ksums"))
    }
}

/// Reads where a stage begins.
///
/// # Errors
/// [`FarmError::Input`] when it is of another render.
pub(crate) fn position(split: &SplitRender<'_>, mut bytes: &[u8]) -> Result<Position, FarmError> {
    if bytes.is_empty() {
        return Ok(Position::default());
    }
    split
        .restore_position(&mut bytes)
        .map_err(|error| FarmError::Input(format!("this is no beginning of a stage: {error}")))
}

fn add(film: &Film, more: Film) -> Result<(), FarmError> {
    film.absorb(more).map_err(|error| FarmError::Input(error.to_string()))
}

fn stage_name(stage: u32) -> String {
    format!("{stage:03}.kstage")
}

fn open_lock(path: &Path) -> Result<File, FarmError> {
    File::options()
        .create(true)
        .truncate(false)
        .read(true)
        .write(true)
        .open(path)
        .map_err(FarmError::io(path))
}
