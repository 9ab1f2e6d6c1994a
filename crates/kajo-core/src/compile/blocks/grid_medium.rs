//! `GridMedium`: a cloud or smoke whose density is given voxel by voxel.

use kajo_math::{Aabb, DAffine3, DMat3, Vec3};
use kajo_scene::{Diagnostic, Item, Params, VoxelGrid, VoxelValue};

use super::medium::{CoefficientKeys, coefficients};
use super::phase::PhaseKeys;
use crate::compile::Compiler;
use crate::compile::fields::{
    At, FileName, Keys, Sources, Typed, at_least, keys, number, report_beside, report_without,
};
use crate::compile::grid::{FileGrid, FileVoxels, GridKeys, GridName, GridSource, VoxelValues, grid_keys};
use crate::compile::member::{MediumMember, Member};
use crate::medium::{
    AlbedoGrid, AlbedoGridError, AnyMedium, Coefficients, DensityGrid, DensityVoxel, GridError, GridMedium,
    Heat, PlacedVoxels, SparseGridMedium, VelocityComponents, VelocityGrid, affine,
};
use crate::schema::{Block, Constant, FieldKind, Kind};

/// The name of another grid of the same file.
///
/// * `excluded`: keys that it is an error beside
const fn other_grid(keyword: &'static str, excluded: &'static [&'static str]) -> Typed<GridName> {
    Typed::<GridName>::new(keyword, FieldKind::Text).only_beside("file").not_beside(excluded)
}

keys! {
    /// What other grids of the same file say: temperatures, velocities and colours.
    OtherGridKeys<'t> {
        temperature: Option<At<'t, GridName>> = other_grid("temperature", &["emission", "values", "size"])
            .placed()
            .unlike("none", "temperature", "name of a grid in the same .vdb or .nvdb: it emits as a black body this hot"),
        temperature_scale: Option<f32> = number("temperatureScale")
            .unit("K")
            .only_beside("temperature")
            .presumed(Constant::Number(1.0), "kelvin of the number 1 more in that grid"),
        temperature_offset: Option<f32> = number("temperatureOffset")
            .unit("K")
            .only_beside("temperature")
            .presumed(Constant::Number(0.0), "kelvin of the number 0"),
        brightness: Option<f32> = at_least("brightness", 0.0)
            .unit("W/(m³ sr)")
            .only_beside("temperature")
            .presumed(Constant::Number(1.0), "luminance per length that it gives at 2000 K"),
        velocity: Option<At<'t, GridName>> = other_grid("velocity", &["values", "size"])
            .placed()
            .unlike("none", "vel", "name of a grid of velocities in the same .vdb, or of three: vel.x, vel.y and vel.z"),
        velocity_scale: Option<f32> = number("velocityScale")
            .unit("1/time")
            .only_beside("velocity")
            .presumed(Constant::Number(1.0), "units of the file that the number 1 goes in a unit of the shutter's time"),
        albedo_grid: Option<At<'t, GridName>> = other_grid("albedoGrid", &["values", "size"])
            .placed()
            .unlike("none", "Cd", "name of a grid of colours in the same .vdb: shares of what is scattered, times `albedo`"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "GridMedium",
        kind: Kind::Medium,
        about: "a cloud, smoke or fire, given voxel by voxel",
        groups: &[GridKeys::FIELDS, OtherGridKeys::FIELDS, CoefficientKeys::FIELDS, PhaseKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        let read = compiler.read_keys(item, |params, sources| {
            params.name();
            let others = other_grid_keys(params, sources);
            let (keys, coefficients) = (grid_keys(params, sources), coefficients(params, sources));
            Some((keys?, others?, coefficients?))
        });
        let (keys, others, coefficients) = read?;
        match compiler.grid_source(keys)? {
            GridSource::Dense(grid) => {
                if let Some(At { item, .. }) = others.temperature.or(others.velocity).or(others.albedo_grid) {
                    let message = "names a grid of a .vdb or .nvdb, and this file is another one";
                    let error = Diagnostic::error(format!("`{}` {message}", item.keyword()));
                    compiler.diagnostics.push(error.label(item.head_span(), "there is no such grid"));
                    return None;
                }
                let medium = compiler.grid_medium(item, grid, coefficients)?;
                let stored = compiler.scene.medium(medium);
                compiler.accepted(stored, item.head_span())
            }
            GridSource::Voxels(voxels) => {
                let medium = match voxels.has_colors() {
                    true => compiler.voxel_medium::<[f32; 3]>(item, *voxels, others, coefficients)?,
                    false => compiler.voxel_medium::<f32>(item, *voxels, others, coefficients)?,
                };
                let stored = compiler.scene.medium(medium);
                compiler.accepted(stored, item.head_span())
            }
        }
    },
};

fn other_grid_keys<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<OtherGridKeys<'t>> {
    for key in ["file", "temperature", "velocity"] {
        if !params.contains(key) {
            report_without(params, OtherGridKeys::FIELDS, key);
        }
    }
    for key in ["emission", "size", "values"] {
        if params.contains(key) {
            report_beside(params, OtherGridKeys::FIELDS, key);
        }
    }
    OtherGridKeys::read(params, sources)
}

impl Compiler<'_> {
    fn grid_medium(
        &mut self,
        item: Item<'_>,
        grid: VoxelValues,
        coefficients: Coefficients,
    ) -> Option<GridMedium> {
        let VoxelValues { size, values, bounds: [min, max] } = grid;
        let grid = DensityGrid::new(size, values).map_err(|error| self.no_medium(item, error)).ok()?;
        let medium = GridMedium::new(coefficients, grid, Aabb { min, max });
        if medium.is_none() {
            self.empty_box(item);
        }
        medium
    }

    fn voxel_medium<T: DensityVoxel>(
        &mut self,
        item: Item<'_>,
        voxels: FileGrid<'_>,
        others: OtherGridKeys<'_>,
        coefficients: Coefficients,
    ) -> Option<AnyMedium>
    where
        AnyMedium: From<SparseGridMedium<T>>,
    {
        let voxels: FileVoxels<'_, T> = self.file_voxels(voxels)?;
        let mut moved = DAffine3::IDENTITY;
        if voxels.corners != [None; 2] {
            let from = voxels.file_corners(0.0);
            let to = [0, 1].map(|k| voxels.corners[k].unwrap_or(from[k]));
            if !(to[1] - to[0]).cmpgt(Vec3::ZERO).all() {
                self.empty_box(item);
                return None;
            }
            moved = between(from, to);
        }
        let velocities = self.velocities(item, &voxels.file, &others, &moved)?;
        let coefficients = self.with_other_grids(item, &voxels.file, &others, &moved, coefficients)?;
        let placed = self.placed(item, voxels.grid, &moved)?;
        let medium = SparseGridMedium::new(coefficients, placed);
        let medium = medium.map_err(|error| self.no_medium(item, error)).ok()?;
        Some(match velocities {
            Some(velocities) => medium.with_velocities(velocities).into(),
            None => medium.into(),
        })
    }

    /// The coefficients with what grids of temperatures and of colours say of them.
    fn with_other_grids(
        &mut self,
        item: Item<'_>,
        file: &At<'_, FileName>,
        others: &OtherGridKeys<'_>,
        moved: &DAffine3,
        mut coefficients: Coefficients,
    ) -> Option<Coefficients> {
        if let Some(name) = &others.temperature {
            let grid = self.voxels(file, name)?;
            let placed = self.placed(item, grid, moved)?;
            if let Some((voxel, value)) = placed.not_finite() {
                self.no_medium(item, GridError::Temperature { voxel, value });
                return None;
            }
            let scale = [others.temperature_scale.unwrap_or(1.0), others.temperature_offset.unwrap_or(0.0)];
            coefficients = coefficients.with_heat(Heat::new(placed, scale, others.brightness.unwrap_or(1.0)));
        }
        if let Some(name) = &others.albedo_grid {
            let grid = self.voxels(file, name)?;
            let placed = self.placed(item, grid, moved)?;
            let report = |error: AlbedoGridError| {
                let error = Diagnostic::error(error.to_string());
                self.diagnostics.push(error.label(item.head_span(), "no such medium"));
            };
            let colors = AlbedoGrid::new(placed).map_err(report).ok()?;
            coefficients = coefficients.with_colors(colors);
        }
        Some(coefficients)
    }

    /// What the grids of velocities say, where there are any.
    fn velocities(
        &mut self,
        item: Item<'_>,
        file: &At<'_, FileName>,
        others: &OtherGridKeys<'_>,
        moved: &DAffine3,
    ) -> Option<Option<VelocityGrid>> {
        let Some(name) = &others.velocity else { return Some(None) };
        let components = match self.vector_names(file, name)? {
            None => {
                let grid = self.voxels(file, name)?;
                VelocityComponents::Together(self.placed(item, grid, moved)?)
            }
            Some(names) => {
                let [x, y, z] = names.map(|name| {
                    let grid = self.voxels(file, &name)?;
                    self.placed(item, grid, moved)
                });
                VelocityComponents::Apart(Box::new([x?, y?, z?]))
            }
        };
        if let Some((voxel, value)) = components.not_finite() {
            self.no_medium(item, GridError::Velocity { voxel, value });
            return None;
        }
        let scale = f64::from(others.velocity_scale.unwrap_or(1.0));
        Some(Some(VelocityGrid::new(components, &(moved.matrix3 * scale))))
    }

    /// The voxels of a file in the world; that they are flat there is reported.
    ///
    /// * `moved`: from where the file says that they are
    fn placed<T: VoxelValue>(
        &mut self,
        item: Item<'_>,
        grid: VoxelGrid<T>,
        moved: &DAffine3,
    ) -> Option<PlacedVoxels<T>> {
        let placed = PlacedVoxels::new(grid.voxels, &(*moved * affine(&grid.map)));
        if placed.is_none() {
            let message = format!("the voxels of the grid `{}` are flat", grid.name);
            self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "no such medium"));
        }
        placed
    }

    fn no_medium(&mut self, item: Item<'_>, error: GridError) {
        let is_negative = matches!(error, GridError::Voxel { value, .. } if value < 0.0);
        let mut error = Diagnostic::error(error.to_string()).label(item.head_span(), "no such medium");
        if is_negative {
            error = error
                .help("a level set holds distances: save it as a fog volume, or make a `DistanceGrid` of it");
        }
        self.diagnostics.push(error);
    }

    fn empty_box(&mut self, item: Item<'_>) {
        let message = "every coordinate of `min` must be less than that of `max`";
        self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "the box of this is empty"));
    }
}

/// Takes one box to another one.
fn between(from: [Vec3; 2], to: [Vec3; 2]) -> DAffine3 {
    let [from, to] = [from, to].map(|corners| corners.map(Vec3::as_dvec3));
    let scale = (to[1] - to[0]) / (from[1] - from[0]);
    DAffine3 { matrix3: DMat3::from_diagonal(scale), translation: to[0] - scale * from[0] }
}
