//! Numbers on a grid, as densities and distances are written: in a file, or in the scene itself.

use kajo_math::Vec3;
use kajo_scene::{Args, Diagnostic, Params, RawVolume, VolumeEncoding, VolumeFile, read_volume};

use super::Compiler;
use super::fields::{
    At, FileName, Keys, Plain, Sources, Typed, choice, choices, file, keys, point, report_beside,
    report_without,
};
use crate::schema::{Around, FieldKind, FieldSpec, FieldValue};

choices! {
    VolumeEncoding {
        "f32" => VolumeEncoding::F32,
        "u16" => VolumeEncoding::U16,
        "u8" => VolumeEncoding::U8,
    }
}

/// How many numbers there are along x, y and z.
#[derive(Clone, Copy)]
pub struct GridSize([u32; 3]);

impl Plain<'_> for GridSize {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<GridSize, Diagnostic> {
        let mut size = [0; 3];
        for n in &mut size {
            *n = args.int_in(1..=i64::from(u32::MAX))? as u32;
        }
        Ok(GridSize(size))
    }
}

/// The numbers themselves.
pub struct GridValues(Vec<f32>);

impl Plain<'_> for GridValues {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<GridValues, Diagnostic> {
        let count = args.numbers_left().max(1);
        (0..count).map(|_| args.number()).collect::<Result<_, _>>().map(GridValues)
    }
}

keys! {
    /// Where numbers are from, and the box that they are in.
    GridKeys<'t> {
        file: Option<At<'t, FileName>> = file("file")
            .not_beside(&["values"])
            .placed()
            .option("its numbers: .vol of Mitsuba, .df3 of POV-Ray, or raw values"),
        values: Option<GridValues> = Typed::<GridValues>::new("values", FieldKind::Numbers(8))
            .not_beside(&["file", "encoding"])
            .unlike("those of `file`", "-1 -1 -1 -1 1 1 1 1", "its numbers, as many as `size` says, x first"),
        size: Option<GridSize> = Typed::<GridSize>::new("size", FieldKind::Wholes(3))
            .unlike("by the file", "2 2 2", "numbers along x, y and z, of `values` and of raw files"),
        encoding: Option<VolumeEncoding> = choice::<VolumeEncoding>("encoding")
            .only_beside("size")
            .unlike("by the file", "u8", "how a raw file stores numbers"),
        min: Option<Vec3> =
            point("min").ruled(low, "by the file, or -1 -1 -1", "the corner of its box with the smallest coordinates"),
        max: Option<Vec3> =
            point("max").ruled(high, "by the file, or 1 1 1", "the corner of its box with the largest coordinates"),
    }
}

/// Numbers, x first and then y, and the box that they are in.
pub struct Grid {
    pub size: [u32; 3],
    pub values: Vec<f32>,
    pub bounds: [Vec3; 2],
}

/// A file may say its own box.
fn low(around: &Around<'_>) -> Option<FieldValue> {
    (!(around.is_written)("file")).then(|| FieldValue::numbers([-1.0; 3]))
}

fn high(around: &Around<'_>) -> Option<FieldValue> {
    (!(around.is_written)("file")).then(|| FieldValue::numbers([1.0; 3]))
}

/// The keys of a block; that numbers are missing is reported.
pub fn grid_keys<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<GridKeys<'t>> {
    if params.contains("file") {
        report_beside(params, GridKeys::FIELDS, "file");
    } else if params.contains("encoding") {
        params.refuse("encoding", "without `file`");
    }
    if !params.contains("size") {
        report_without(params, GridKeys::FIELDS, "size");
    }
    let keys = GridKeys::read(params, sources)?;
    let missing = match (&keys.file, &keys.values, &keys.size) {
        (None, None, _) => "file",
        (None, Some(_), None) => "size",
        _ => return Some(keys),
    };
    params.report_missing(missing);
    None
}

impl Compiler<'_> {
    /// The numbers that keys ask for; why there are none is reported.
    pub(super) fn grid(&mut self, keys: GridKeys<'_>) -> Option<Grid> {
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
        let [low, high] = bounds.unwrap_or([[-1.0; 3], [1.0; 3]]);
        let bounds = [min.unwrap_or(low.into()), max.unwrap_or(high.into())];
        Some(Grid { size, values, bounds })
    }

    /// The grid of a file, whose memory is taken for good.
    fn volume(&mut self, file: &At<'_, FileName>, raw: Option<RawVolume>) -> Option<VolumeFile> {
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
