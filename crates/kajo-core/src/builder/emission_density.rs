//! Tables of what patches emit that do not emit the same everywhere, for points to be drawn by and lights to be chosen by.

use kajo_color::{Emission, Wavelengths};
use kajo_math::{Affine3, DAffine3, Vec2, Vec3};

use super::SceneBuilder;
use crate::emission::{Leaving, VariedEmission};
use crate::light::{EmissionDensity, TableDetail};
use crate::shape::{Patch, ShapeId};
use crate::texture::{SurfaceUv, TextureContext, TextureDetail};

/// The most cells of a table across or up, each about half a texel; beyond them a cell has several.
const MOST_CELLS: f32 = 512.0;

/// The same for all tables of an object, if they were one.
const MOST_OF_OBJECT: f32 = 2048.0;

/// Texels across that a pattern is taken to have.
const OF_PATTERN: f32 = 16.0;

/// Patches of an object that get tables of a pattern; one of more is taken to be too small to matter.
const PATCHES_WITH_PATTERN: usize = 16;

/// How far from the border of the coordinates points are asked for, since pictures go on beyond it.
const INSET: f32 = 1e-4;

/// A table whose cells are larger than half a texel by less than this factor has all that there is.
const FINE: f32 = 1.1;

/// Luminances over the coordinates of a patch.
struct Table {
    /// Columns and rows.
    cells: [usize; 2],
    /// At the corners of the cells.
    found: Vec<f32>,
    detail: TableDetail,
}

/// A patch of an emissive object.
pub(super) struct EmissivePatch<'a> {
    pub varied: &'a VariedEmission,
    pub shape: ShapeId,
    pub part: u32,
    /// In world space, as the shutter opens.
    pub patch: &'a Patch,
    pub object_from_world: DAffine3,
}

impl EmissivePatch<'_> {
    /// What is at coordinates of the patch.
    fn context(&self, builder: &SceneBuilder, at: Vec2) -> TextureContext {
        let p = self.patch.point_at(at).map_or(Vec3::ZERO, |drawn| drawn.at.p);
        let own = self.object_from_world.transform_point3(p.as_dvec3()).as_vec3();
        let shapes = &builder.geometry.shapes;
        let hit = shapes.hit_at(self.shape, self.part, own);
        let first = shapes.uv_at(self.shape, &hit, own);
        let second = shapes.second_uv_at(self.shape, &hit, own).unwrap_or(first);
        let (uv, tint) = (SurfaceUv { first, second }, shapes.color_at(self.shape, &hit));
        let DAffine3 { matrix3, translation } = self.object_from_world;
        let object_from_world = Affine3 { matrix3: matrix3.as_mat3(), translation: translation.as_vec3() };
        TextureContext { p, uv, tint, object_from_world, ..TextureContext::default() }
    }

    fn luminance(&self, builder: &SceneBuilder, at: Vec2) -> f32 {
        let context = self.context(builder, at);
        let leaving = Leaving { p: context.p, d: None };
        self.varied.at(&builder.appearance.textures, &context, leaving, &Wavelengths::RGB).luminance()
    }

    /// Texels of its pictures across and up.
    fn texels(&self, builder: &SceneBuilder) -> Vec2 {
        // Pictures lie evenly on what is flat and has edges.
        let is_even = matches!(self.patch, Patch::Triangle(_) | Patch::Rectangle(_) | Patch::Quad(_));
        let side = if is_even { 2 } else { 8 };
        let at = |i: u8, j: u8| (Vec2::new(i.into(), j.into()) + 0.5) / f32::from(side);
        let mut texels = Vec2::ZERO;
        for map in &self.varied.detail().pictures {
            let place = |i, j| map.in_texels(self.context(builder, at(i, j)).uv);
            let [across, up] = [[1, 0], [0, 1]].map(|[di, dj]| {
                let starts = (0..side - dj).flat_map(|j| (0..side - di).map(move |i| (i, j)));
                let step = |(i, j)| (place(i + di, j + dj) - place(i, j)).abs().max_element();
                let mut steps: Vec<f32> = starts.map(step).collect();
                steps.sort_by(f32::total_cmp);
                // Around a body coordinates jump back once.
                steps[(steps.len() - 1) * 4 / 5] * f32::from(side)
            });
            texels = texels.max(Vec2::new(across, up));
        }
        texels
    }
}

impl SceneBuilder {
    /// The light of a patch whose points differ, for lights to be chosen by, and the density of its points if that is worth a table.
    ///
    /// Nine tenths of the light are what its points give, and a tenth what the material does on the whole, lest light between
    /// them be left undrawn.
    ///
    /// * `mean`: of all points of the material
    pub(super) fn emission_of_patch(
        &self,
        mean: &Emission,
        patch: &EmissivePatch<'_>,
        n_patches: usize,
    ) -> (Emission, Option<Box<EmissionDensity>>) {
        /// Points across and up where there is no table.
        const GRID: u8 = 4;
        const KNOWN: f32 = 0.9;
        // The mean of a pattern or function is that of a part of space, which may be another one: where it says that there is no
        // light, there may be some all the same.
        const LEAST: f32 = 1e-3;
        let of_luminance = |known: f32| Emission::from_rgb([known.clamp(LEAST, f32::MAX); 3]);
        let is_unknown =
            patch.varied.detail().has_pattern && !(LEAST..f32::INFINITY).contains(&mean.luminance());
        // What has no coordinates is asked for nothing.
        if matches!(patch.patch, Patch::Traced(_)) {
            return (if is_unknown { of_luminance(LEAST) } else { mean.clone() }, None);
        }
        let (found, density) = match self.table(patch, n_patches) {
            Some(Table { cells, found, detail }) => {
                let density = EmissionDensity::new(patch.patch, cells, &found, detail);
                (found, density.map(Box::new))
            }
            None => {
                let at = |i: u8| (Vec2::new((i % GRID).into(), (i / GRID).into()) + 0.5) / f32::from(GRID);
                ((0..GRID * GRID).map(|i| patch.luminance(self, at(i))).collect(), None)
            }
        };
        if is_unknown {
            return (of_luminance(found.iter().sum::<f32>() / found.len() as f32), density);
        }
        let share = found.iter().sum::<f32>() / (found.len() as f32 * mean.luminance());
        let share = if share.is_finite() { KNOWN * share + (1.0 - KNOWN) } else { 1.0 };
        (mean.clone().scaled(share), density)
    }

    /// The luminances at points half a texel apart; `None` for a patch of less than a texel.
    fn table(&self, patch: &EmissivePatch<'_>, n_patches: usize) -> Option<Table> {
        let mut texels = patch.texels(self);
        let &TextureDetail { has_pattern, jumps, .. } = patch.varied.detail();
        if has_pattern && n_patches <= PATCHES_WITH_PATTERN {
            texels = texels.max(Vec2::splat(OF_PATTERN));
        }
        if !texels.is_finite() || texels.max_element() < 1.0 {
            return None;
        }
        let wanted = (if jumps { 4.0 } else { 2.0 }) * texels;
        let most = (MOST_OF_OBJECT / (n_patches as f32).sqrt()).clamp(2.0, MOST_CELLS);
        let cells = wanted.round().clamp(Vec2::splat(2.0), Vec2::splat(most));
        // Between the nodes a table goes on linearly. Where emission does not, they have means.
        let coarseness = (wanted / cells).max_element();
        let places =
            if coarseness < FINE { 1 + u8::from(jumps) } else { (coarseness.ceil() as u8).clamp(2, 4) };
        let detail = if jumps || has_pattern || coarseness >= FINE {
            TableDetail::Sampled
        } else {
            TableDetail::Blended
        };
        let offset = |k: u8| (f32::from(k) + 0.5) / f32::from(places) - 0.5;
        let luminance = |node: Vec2| {
            let at = |k: u8| (node + Vec2::new(offset(k % places), offset(k / places))) / cells;
            let at = |k: u8| at(k).clamp(Vec2::splat(INSET), Vec2::splat(1.0 - INSET));
            (0..places * places).map(|k| patch.luminance(self, at(k))).sum::<f32>()
                / f32::from(places * places)
        };
        let [columns, rows] = [cells.x as usize, cells.y as usize];
        let nodes = (0..=rows).flat_map(|j| (0..=columns).map(move |i| Vec2::new(i as f32, j as f32)));
        Some(Table { cells: [columns, rows], found: nodes.map(luminance).collect(), detail })
    }
}
