//! What a job renders, and how it is cut.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use kajo::{Rect, SplitRender};
use serde::{Deserialize, Serialize};

use crate::{FarmError, Layout};

/// The format of plans, parts and sums of this program.
const FORMAT: u32 = 1;

/// Bytes of the longest plan.
pub(crate) const LONGEST: u64 = 64 << 20;

/// What a job renders. It never changes: another picture is another job.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// The version of the format.
    pub format: u32,
    /// Everything that decides a bit of the picture, see [`SplitRender::identity`]; the first line names the program.
    pub identity: String,
    /// The command line of the render, without the program's name.
    pub arguments: Vec<String>,
    /// The folder that names in the command line are looked up in.
    pub folder: String,
    /// Every file the scene was read from.
    pub files: Vec<PlannedFile>,
    /// Pixels that samples are taken of: left, top, and one past right and bottom.
    pub pixels: [u32; 4],
    /// Side of a unit's tile in pixels.
    pub tile: u32,
    /// Samples of each pixel in a unit.
    pub samples: u32,
    /// The digest of what all units of a pass share and no unit can work out alone; integrators without such state have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared: Option<String>,
}

/// A file that a scene is made of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedFile {
    /// Where it was.
    pub path: String,
    /// Its length.
    pub bytes: u64,
    /// The BLAKE3 of its content, in hexadecimal digits.
    pub blake3: String,
}

impl Plan {
    /// A plan for this split.
    ///
    /// * `tile`, `samples`: of a unit, at least 1
    ///
    /// # Errors
    /// When it would be too many units.
    pub fn new(
        split: &SplitRender<'_>,
        (arguments, folder): (Vec<String>, String),
        files: Vec<PlannedFile>,
        (tile, samples): (u32, u32),
    ) -> Result<Plan, FarmError> {
        let Rect { x0, y0, x1, y1 } = split.sampled();
        let plan = Plan {
            format: FORMAT,
            identity: split.identity(),
            arguments,
            folder,
            files,
            pixels: [x0, y0, x1, y1],
            tile: tile.max(1),
            samples: samples.max(1),
            shared: None,
        };
        let stage = split.stage(&kajo::Position::default()).unwrap_or_default();
        plan.layout(stage).map(|_| plan)
    }

    /// Reads a plan.
    ///
    /// # Errors
    /// When it is none, or one of another format.
    pub fn read(text: &str) -> Result<Plan, FarmError> {
        #[derive(Deserialize)]
        struct Format {
            format: u32,
        }
        let no_plan = |error| FarmError::Input(format!("this is no plan of kajo: {error}"));
        let Format { format } = serde_json::from_slice(text.as_bytes()).map_err(no_plan)?;
        if format != FORMAT {
            return Err(FarmError::Input(format!(
                "the plan has version {format} of the format, and this kajo knows version {FORMAT}"
            )));
        }
        let plan: Plan = serde_json::from_slice(text.as_bytes()).map_err(no_plan)?;
        let [x0, y0, x1, y1] = plan.pixels;
        if x1 <= x0 || y1 <= y0 || plan.tile == 0 || plan.samples == 0 {
            return Err(FarmError::Input("the plan is damaged: its units are empty".to_owned()));
        }
        Ok(plan)
    }

    /// The units of a stage with these samples.
    ///
    /// # Errors
    /// When there are too many.
    pub fn layout(&self, stage: Range<u32>) -> Result<Layout, FarmError> {
        let [x0, y0, x1, y1] = self.pixels;
        let layout = Layout::new(Rect { x0, y0, x1, y1 }, self.tile, stage, self.samples);
        match layout.units() {
            units if units > crate::layout::MOST_UNITS => Err(FarmError::Input(format!(
                "the picture would be {units} units; take more pixels (--unit-tile) or samples (--unit-samples) for each"
            ))),
            _ => Ok(layout),
        }
    }

    /// Makes sure that a split is that of the plan.
    ///
    /// # Errors
    /// [`FarmError::Input`] says the first difference.
    pub fn check(&self, split: &SplitRender<'_>) -> Result<(), FarmError> {
        if split.identity() == self.identity {
            return Ok(());
        }
        let build = |text: &str| text.lines().next().unwrap_or_default().to_owned();
        let (then, now) = (build(&self.identity), build(&split.identity()));
        if then != now {
            return Err(FarmError::Input(format!(
                "the plan was made by {then}, and this is {now}: their pictures may differ; take the same version \
                 everywhere"
            )));
        }
        let (then, now) = split.difference(&self.identity).unwrap_or_default();
        Err(FarmError::Input(format!(
            "the plan is of another render: it has `{then}` where this one has `{now}`"
        )))
    }

    /// Makes sure that no file of the scene has changed since.
    ///
    /// # Errors
    /// [`FarmError::Input`] names the first that has.
    pub fn check_files(&self) -> Result<(), FarmError> {
        for planned in &self.files {
            let found = PlannedFile::of(Path::new(&planned.path))
                .map_err(|error| FarmError::Input(format!("a file of the scene cannot be read: {error}")))?;
            if found.blake3 != planned.blake3 {
                return Err(FarmError::Input(format!(
                    "`{}` has changed since the plan was made; plan anew, in another folder",
                    planned.path
                )));
            }
        }
        Ok(())
    }
}

/// The hash of a plan's text, which names the plan in its parts.
pub fn plan_hash(text: &str) -> [u8; 32] {
    *blake3::hash(text.as_bytes()).as_bytes()
}

impl PlannedFile {
    /// Reads a file.
    ///
    /// # Errors
    /// When that fails, or its name is no text.
    pub fn of(path: &Path) -> Result<PlannedFile, FarmError> {
        let name = path.to_str().ok_or_else(|| {
            FarmError::Input(format!("`{}`: a plan can hold names in UTF-8 only", path.display()))
        })?;
        let mut file = File::open(path).map_err(FarmError::io(path))?;
        let (mut hasher, mut bytes, mut buffer) = (blake3::Hasher::new(), 0, vec![0; 1 << 16]);
        loop {
            let n = file.read(&mut buffer).map_err(FarmError::io(path))?;
            if n == 0 {
                break;
            }
            hasher.update(&buffer[..n]);
            bytes += n as u64;
        }
        Ok(PlannedFile { path: name.to_owned(), bytes, blake3: hasher.finalize().to_hex().to_string() })
    }

    /// Those of several files.
    ///
    /// # Errors
    /// As [`PlannedFile::of`].
    pub fn of_all(paths: &[PathBuf]) -> Result<Vec<PlannedFile>, FarmError> {
        paths.iter().map(|path| PlannedFile::of(path)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_plan_is_refused() {
        let said = |text: &str| Plan::read(text).unwrap_err().to_string();
        assert!(said("").contains("no plan"));
        assert!(said("{\"format\": 1}").contains("missing field"));
        assert!(said("{\"format\": 7, \"new\": 1}").contains("version 7"));
        let plan = |pixels: &str, tile: u64| {
            format!(
                "{{\"format\":1,\"identity\":\"\",\"arguments\":[],\"folder\":\"\",\"files\":[],\"pixels\":{pixels},\
                 \"tile\":{tile},\"samples\":1}}"
            )
        };
        assert!(said(&plan("[0,0,0,4]", 8)).contains("empty"));
        assert!(said(&plan("[0,0,4,4]", 0)).contains("empty"));
        assert!(said(&plan("[0,0,4,4]", 1 << 40)).contains("no plan"));
        let large = Plan::read(&plan("[0,0,4294967295,4294967295]", 1)).unwrap();
        assert!(large.layout(0..4_000_000_000).unwrap_err().to_string().contains("--unit-tile"));
    }
}
