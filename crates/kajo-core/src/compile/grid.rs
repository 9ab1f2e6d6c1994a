//! Numbers on a grid, as densities and distances are written: in a file, or in the scene itself.

use kajo_math::Vec3;
use kajo_scene::{
    Args, AssetFile, Diagnostic, GridEntry, Item, Params, RawVolume, VolumeEncoding, VolumeFile, VoxelGrid,
    VoxelValue, is_vdb, list_vdb, nearest, read_vdb, read_volume,
};

use super::Compiler;
use super::fields::{
    At, FileName, Keys, Plain, Sources, Typed, choice, choices, file, keys, point, report_beside,
    report_without,
};
use crate::schema::{Around, FieldKind, FieldSpec, FieldValue, NumberRange};

choices! {
    VolumeEncoding {
        "f32" => VolumeEncoding::F32,
        "u16" => VolumeEncoding::U16,
        "u8" => VolumeEncoding::U8,
    }
}

/// What is behind the name of a vector in the names of the grids of its parts.
const PARTS_OF_VECTORS: [[&str; 3]; 5] =
    [[".x", ".y", ".z"], ["_x", "_y", "_z"], ["x", "y", "z"], ["_X", "_Y", "_Z"], ["X", "Y", "Z"]];

/// How many numbers there may be along an axis.
const COUNT: NumberRange = NumberRange { min: 1.0, max: u32::MAX as f64 };

/// How many numbers there are along x, y and z.
#[derive(Clone, Copy)]
pub struct GridSize([u32; 3]);

impl Plain<'_> for GridSize {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<GridSize, Diagnostic> {
        let mut size = [0; 3];
        for (i, n) in size.iter_mut().enumerate() {
            *n = args.int_in(spec.kind.range(i).wholes())? as u32;
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

/// The name of a grid of a file.
pub struct GridName(pub String);

impl Plain<'_> for GridName {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<GridName, Diagnostic> {
        args.text().map(|name| GridName(name.into_owned()))
    }
}

keys! {
    /// Where numbers are from, and the box that they are in.
    GridKeys<'t> {
        file: Option<At<'t, FileName>> = file("file")
            .not_beside(&["values"])
            .placed()
            .option("its numbers: .vdb of OpenVDB, .nvdb of NanoVDB, .vol of Mitsuba, .df3 of POV-Ray, or raw values"),
        grid: Option<At<'t, GridName>> = Typed::<GridName>::new("grid", FieldKind::Text)
            .only_beside("file")
            .not_beside(&["values", "size"])
            .placed()
            .unlike("`density`, or the first", "density", "name of the grid in a .vdb or .nvdb"),
        values: Option<GridValues> = Typed::<GridValues>::new("values", FieldKind::Groups(&[NumberRange::ANY; 1]))
            .not_beside(&["file", "encoding"])
            .unlike("those of `file`", "-1 -1 -1 -1 1 1 1 1", "its numbers, as many as `size` says, x first"),
        size: Option<GridSize> = Typed::<GridSize>::new("size", FieldKind::Wholes(&[COUNT; 3]))
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
pub struct VoxelValues {
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
    } else {
        params.refuse("encoding", "without `file`");
        report_without(params, GridKeys::FIELDS, "file");
    }
    if params.contains("size") {
        report_beside(params, GridKeys::FIELDS, "size");
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

/// What keys ask for.
pub enum GridSource<'t> {
    /// Numbers in a box.
    Dense(VoxelValues),
    /// A grid of a file that says where its voxels are.
    Voxels(Box<FileGrid<'t>>),
}

/// A grid of a file that says where its voxels are, not read yet.
pub struct FileGrid<'t> {
    pub file: At<'t, FileName>,
    entry: GridEntry,
    /// Its place in the file.
    index: usize,
    /// The corners that the scene gives to its box.
    corners: [Option<Vec3>; 2],
}

impl FileGrid<'_> {
    /// Whether its voxels hold colours.
    pub fn has_colors(&self) -> bool {
        self.entry.channels == Ok(<[f32; 3]>::CHANNELS)
    }
}

/// The voxels of a grid of a file.
pub struct FileVoxels<'t, T = f32> {
    pub grid: VoxelGrid<T>,
    pub file: At<'t, FileName>,
    /// The corners that the scene gives to its box.
    pub corners: [Option<Vec3>; 2],
}

impl<T: VoxelValue> FileVoxels<'_, T> {
    /// The box of the voxels in the world, by the file.
    ///
    /// * `margin`: what is left out on each side, in voxels
    pub fn file_corners(&self, margin: f64) -> [Vec3; 2] {
        let size = self.grid.voxels.size().map(f64::from);
        let ends = [[margin; 3], size.map(|n| n - margin)];
        let mut corners = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for k in 0..8 {
            let p = self.grid.map.point([0, 1, 2].map(|axis| ends[k >> axis & 1][axis]));
            for axis in 0..3 {
                corners[0][axis] = corners[0][axis].min(p[axis]);
                corners[1][axis] = corners[1][axis].max(p[axis]);
            }
        }
        corners.map(|corner| Vec3::from(corner.map(|x| x as f32)))
    }
}

impl Compiler<'_> {
    /// The numbers that keys ask for, each of them; why there are none is reported.
    pub(super) fn grid(&mut self, item: Item<'_>, keys: GridKeys<'_>) -> Option<VoxelValues> {
        match self.grid_source(keys)? {
            GridSource::Dense(grid) => Some(grid),
            GridSource::Voxels(voxels) => {
                let voxels = self.file_voxels(*voxels)?;
                self.points(item, voxels)
            }
        }
    }

    /// Numbers on points whose outermost ones are on the faces of their box.
    fn points(&mut self, item: Item<'_>, voxels: FileVoxels<'_>) -> Option<VoxelValues> {
        let [low, high] = voxels.file_corners(0.5);
        let FileVoxels { grid, corners: [min, max], .. } = voxels;
        let size = grid.voxels.size();
        let count = size.into_iter().map(u64::from).product::<u64>();
        let is_upright = (0..3).all(|axis| {
            grid.map.axes[axis].iter().enumerate().all(|(k, &x)| if k == axis { x > 0.0 } else { x == 0.0 })
        });
        let bytes = count.saturating_mul(size_of::<f32>() as u64);
        let memory = &self.options.limits.memory;
        let mut values = Vec::new();
        let room = match is_upright || (min.is_some() && max.is_some()) {
            true => memory
                .take(bytes)
                .and_then(|()| {
                    let count = usize::try_from(count).unwrap_or(usize::MAX);
                    values.try_reserve_exact(count).map_err(|_| memory.exceeded(bytes))
                })
                .map_err(|over| over.to_string()),
            false => Err(format!("the grid `{}` is turned in the world: write `min` and `max`", grid.name)),
        };
        if let Err(message) = room {
            self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "no such surface"));
            return None;
        }
        for z in 0..size[2] {
            for y in 0..size[1] {
                values.extend((0..size[0]).map(|x| grid.voxels.at([x, y, z])));
            }
        }
        Some(VoxelValues { size, values, bounds: [min.unwrap_or(low), max.unwrap_or(high)] })
    }

    /// What keys ask for; why there is none is reported.
    pub(super) fn grid_source<'t>(&mut self, keys: GridKeys<'t>) -> Option<GridSource<'t>> {
        let GridKeys { file, values, size, encoding, min, max, grid } = keys;
        let size = size.map(|GridSize(size)| size);
        let (size, values, bounds) = match (file, values) {
            (Some(file), _) => {
                let raw =
                    size.map(|size| RawVolume { size, encoding: encoding.unwrap_or(VolumeEncoding::F32) });
                if raw.is_none() && self.has_grids(&file)? {
                    let (index, entry) = self.grid_of_file(&file, grid.as_ref())?;
                    let corners = [min, max];
                    return Some(GridSource::Voxels(Box::new(FileGrid { file, entry, index, corners })));
                }
                if let Some(At { item, .. }) = grid {
                    let message = format!("there is one grid in `{}`, and it has no name", file.value.0);
                    self.diagnostics.push(
                        Diagnostic::error(message)
                            .label(item.head_span(), "only a .vdb has grids with names"),
                    );
                    return None;
                }
                let VolumeFile { size, values, bounds, .. } = self.volume(&file, raw)?;
                (size, values, bounds)
            }
            (None, values) => (size?, values?.0, None),
        };
        let [low, high] = bounds.unwrap_or([[-1.0; 3], [1.0; 3]]);
        let bounds = [min.unwrap_or(low.into()), max.unwrap_or(high.into())];
        Some(GridSource::Dense(VoxelValues { size, values, bounds }))
    }

    /// Reports why a file cannot be read.
    fn unreadable(&mut self, file: &At<'_, FileName>, reason: String) {
        let error = Diagnostic::error(format!("cannot read `{}`: {reason}", file.value.0));
        self.diagnostics.push(error.label(file.item.head_span(), "named here"));
    }

    fn opened(&mut self, file: &At<'_, FileName>) -> Option<AssetFile> {
        let opened = self.assets.open(&file.value.0, file.item.path());
        opened.map_err(|error| self.unreadable(file, error.to_string())).ok()
    }

    /// Whether a file has grids with names and places.
    fn has_grids(&mut self, file: &At<'_, FileName>) -> Option<bool> {
        let head = self.opened(file)?.head(8);
        head.map_err(|error| self.unreadable(file, error.to_string())).map(|head| is_vdb(&head)).ok()
    }

    /// A grid of a file, whose memory is taken for good.
    pub(super) fn file_voxels<'t, T: VoxelValue>(&mut self, grid: FileGrid<'t>) -> Option<FileVoxels<'t, T>> {
        let FileGrid { file, index, corners, .. } = grid;
        Some(FileVoxels { grid: self.read_grid(&file, index)?, file, corners })
    }

    /// A grid of a file by its name, whose memory is taken for good.
    pub(super) fn voxels<T: VoxelValue>(
        &mut self,
        file: &At<'_, FileName>,
        name: &At<'_, GridName>,
    ) -> Option<VoxelGrid<T>> {
        let (index, _) = self.grid_of_file(file, Some(name))?;
        self.read_grid(file, index)
    }

    /// The names of three grids that hold the parts of vectors, where the file has these in place of one of the name itself.
    pub(super) fn vector_names<'t>(
        &mut self,
        file: &At<'t, FileName>,
        name: &At<'t, GridName>,
    ) -> Option<Option<[At<'t, GridName>; 3]>> {
        let entries = list_vdb(self.opened(file)?, &self.options.limits);
        let entries = entries.map_err(|error| self.unreadable(file, error.to_string())).ok()?;
        let has = |name: &str| entries.iter().any(|entry| entry.name == name);
        let GridName(own) = &name.value;
        if has(own) {
            return Some(None);
        }
        let ways = PARTS_OF_VECTORS.iter().map(|parts| parts.map(|part| format!("{own}{part}")));
        let found = ways.into_iter().find(|names| names.iter().all(|name| has(name)));
        Some(found.map(|names| names.map(|part| At { value: GridName(part), item: name.item })))
    }

    /// Which grid of a file it is, and what the file says of it.
    ///
    /// * `named`: its name; without one it is `density`, or the first one that has numbers
    fn grid_of_file(
        &mut self,
        file: &At<'_, FileName>,
        named: Option<&At<'_, GridName>>,
    ) -> Option<(usize, GridEntry)> {
        let limits = &self.options.limits;
        let entries = list_vdb(self.opened(file)?, limits).map_err(|error| error.to_string());
        let mut entries = entries.map_err(|reason| self.unreadable(file, reason)).ok()?;
        let index = match named {
            Some(At { value: GridName(name), item }) => {
                let index = entries.iter().position(|entry| entry.name == *name);
                if index.is_none() {
                    let mut error =
                        Diagnostic::error(format!("there is no grid `{name}` in `{}`", file.value.0))
                            .label(item.head_span(), "named here");
                    let near = nearest(name, entries.iter().map(|entry| &*entry.name));
                    error = match near {
                        Some(near) => error.help(format!("did you mean `{near}`?")),
                        None => error.help(format!("it has {}", names(&entries))),
                    };
                    self.diagnostics.push(error);
                }
                index?
            }
            None => {
                let is_usable = |entry: &GridEntry| entry.channels == Ok(1);
                let found = entries.iter().position(|entry| is_usable(entry) && entry.name == "density");
                let found = found.or_else(|| entries.iter().position(is_usable));
                if found.is_none() {
                    self.unreadable(
                        file,
                        format!("it has no grid of one number in a voxel, but {}", names(&entries)),
                    );
                }
                found?
            }
        };
        Some((index, entries.swap_remove(index)))
    }

    fn read_grid<T: VoxelValue>(&mut self, file: &At<'_, FileName>, index: usize) -> Option<VoxelGrid<T>> {
        let limits = &self.options.limits;
        let read = read_vdb(self.opened(file)?, index, limits).map_err(|error| error.to_string());
        let kept = read.and_then(|mut grid: VoxelGrid<T>| {
            grid.memory.keep(grid.voxels.bytes()).map_err(|over| over.to_string())?;
            Ok(grid)
        });
        kept.map_err(|reason| self.unreadable(file, reason)).ok()
    }

    /// The grid of a file, whose memory is taken for good.
    fn volume(&mut self, file: &At<'_, FileName>, raw: Option<RawVolume>) -> Option<VolumeFile> {
        let opened = self.opened(file)?;
        let limits = &self.options.limits;
        let read = read_volume(opened, raw, limits).map_err(|error| error.to_string());
        let kept = read.and_then(|mut read| {
            read.memory.keep(size_of_val(&*read.values) as u64).map_err(|over| over.to_string())?;
            Ok(read)
        });
        kept.map_err(|reason| self.unreadable(file, reason)).ok()
    }
}

/// The names of the grids of a file, as a message says them.
fn names(entries: &[GridEntry]) -> String {
    const SHOWN: usize = 8;
    let mut names: Vec<String> =
        entries.iter().take(SHOWN).map(|entry| format!("`{}`", entry.name)).collect();
    if entries.len() > SHOWN {
        names.push("others".to_owned());
    }
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
