//! `GridMedium`: a cloud or smoke whose density is given voxel by voxel.

use kajo_math::{Aabb, Vec3};
use kajo_scene::{Args, Diagnostic, Item, Params, RawVolume, VolumeEncoding, VolumeFile, read_volume};

use super::medium::{CoefficientKeys, coefficients};
use crate::compile::Compiler;
use crate::compile::fields::{
    At, FileName, Keys, Plain, Sources, Typed, choice, choices, file, keys, point, report_beside,
    report_without,
};
use crate::compile::member::{MediumMember, Member};
use crate::medium::{Coefficients, DensityGrid, GridMedium};
use crate::schema::{Around, Block, FieldKind, FieldSpec, FieldValue, Kind};

choices! {
    VolumeEncoding {
        "f32" => VolumeEncoding::F32,
        "u16" => VolumeEncoding::U16,
        "u8" => VolumeEncoding::U8,
    }
}

/// How many voxels there are along x, y and z.
#[derive(Clone, Copy)]
pub(super) struct GridSize(pub [u32; 3]);

impl Plain<'_> for GridSize {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<GridSize, Diagnostic> {
        let mut size = [0; 3];
        for n in &mut size {
            *n = args.int_in(1..=i64::from(u32::MAX))? as u32;
        }
        Ok(GridSize(size))
    }
}

/// The densities themselves.
pub(super) struct Densities(pub Vec<f32>);

impl Plain<'_> for Densities {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Densities, Diagnostic> {
        let count = args.numbers_left().max(1);
        (0..count).map(|_| args.number()).collect::<Result<_, _>>().map(Densities)
    }
}

keys! {
    GridKeys<'t> {
        file: Option<At<'t, FileName>> = file("file")
            .not_beside(&["values"])
            .placed()
            .option("its densities: .vol of Mitsuba, .df3 of POV-Ray, or raw values"),
        values: Option<Densities> = Typed::<Densities>::new("values", FieldKind::Numbers(8))
            .not_beside(&["file", "encoding"])
            .unlike("those of `file`", "0 0 0 0 1 1 1 1", "its densities, as many as `size` says, x first"),
        size: Option<GridSize> = Typed::<GridSize>::new("size", FieldKind::Wholes(3))
            .unlike("by the file", "2 2 2", "voxels along x, y and z, of `values` and of raw files"),
        encoding: Option<VolumeEncoding> = choice::<VolumeEncoding>("encoding")
            .only_beside("size")
            .unlike("by the file", "u8", "how a raw file stores numbers"),
        min: Option<Vec3> = point("min").ruled(low, "by the file, or -1 -1 -1", "a corner of the box that it fills"),
        max: Option<Vec3> = point("max").ruled(high, "by the file, or 1 1 1", "the opposite corner"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "GridMedium",
        kind: Kind::Medium,
        about: "a cloud or smoke, given voxel by voxel",
        groups: &[GridKeys::FIELDS, CoefficientKeys::FIELDS],
    },
    read: |compiler, item| {
        let read = compiler.read_keys(item, |params, sources| {
            params.name();
            read(params, sources)
        });
        let (keys, coefficients) = read?;
        let medium = compiler.grid_medium(item, keys, coefficients)?;
        let stored = compiler.scene.medium(medium);
        compiler.accepted(stored, item.head_span())
    },
};

/// A file may say its own box.
pub(super) fn low(around: &Around<'_>) -> Option<FieldValue> {
    (!(around.is_written)("file")).then(|| FieldValue::numbers([-1.0; 3]))
}

pub(super) fn high(around: &Around<'_>) -> Option<FieldValue> {
    (!(around.is_written)("file")).then(|| FieldValue::numbers([1.0; 3]))
}

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<(GridKeys<'t>, Coefficients)> {
    if params.contains("file") {
        report_beside(params, GridKeys::FIELDS, "file");
    } else if params.contains("encoding") {
        params.refuse("encoding", "without `file`");
    }
    if !params.contains("size") {
        report_without(params, GridKeys::FIELDS, "size");
    }
    let keys = GridKeys::read(params, sources);
    let coefficients = coefficients(params, sources);
    let (keys, coefficients) = (keys?, coefficients?);
    if keys.file.is_none() && keys.values.is_none() {
        params.report_missing("file");
        return None;
    }
    if keys.values.is_some() && keys.size.is_none() {
        params.report_missing("size");
        return None;
    }
    Some((keys, coefficients))
}

impl Compiler<'_> {
    fn grid_medium(
        &mut self,
        item: Item<'_>,
        keys: GridKeys<'_>,
        coefficients: Coefficients,
    ) -> Option<GridMedium> {
        let GridKeys { file, values, size, encoding, min, max } = keys;
        let size = size.map(|GridSize(size)| size);
        let (size, values, bounds) = match (file, values) {
            (Some(file), _) => {
                let raw =
                    size.map(|size| RawVolume { size, encoding: encoding.unwrap_or(VolumeEncoding::F32) });
                let VolumeFile { size, values, bounds, .. } = self.volume(&file, raw)?;
                (size, values, bounds)
            }
            (None, values) => (size?, values?.0, None),
        };
        let grid = DensityGrid::new(size, values);
        let mut report = |message: String| {
            self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "no such medium"));
        };
        let grid = grid.map_err(|error| report(error.to_string())).ok()?;
        let [low, high] = bounds.unwrap_or([[-1.0; 3], [1.0; 3]]);
        let (min, max) = (min.unwrap_or(low.into()), max.unwrap_or(high.into()));
        let medium = GridMedium::new(coefficients, grid, Aabb { min, max });
        if medium.is_none() {
            let message = "every coordinate of `min` must be less than that of `max`";
            self.diagnostics
                .push(Diagnostic::error(message).label(item.head_span(), "the box of this is empty"));
        }
        medium
    }

    /// The grid of a file, whose memory is taken for good.
    pub(super) fn volume(&mut self, file: &At<'_, FileName>, raw: Option<RawVolume>) -> Option<VolumeFile> {
        let At { value: FileName(name), item } = file;
        let limits = &self.options.limits;
        let opened = self.assets.open(name, item.path()).map_err(|error| error.to_string());
        let read = opened.and_then(|file| read_volume(file, raw, limits).map_err(|error| error.to_string()));
        let kept = read.and_then(|file| {
            let bytes = size_of_val(&*file.values) as u64;
            let VolumeFile { size, values, bounds, memory } = file;
            drop(memory);
            limits.memory.take(bytes).map_err(|over| over.to_string())?;
            let memory = limits.memory.share(0).map_err(|over| over.to_string())?;
            Ok(VolumeFile { size, values, bounds, memory })
        });
        let report = |reason: String| {
            let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
            self.diagnostics.push(error.label(item.head_span(), "named here"));
        };
        kept.map_err(report).ok()
    }
}
