//! Height fields: terrain over a rectangle.
//!
//! Heights `h` at the corners of a grid of cells, in each of which the surface is the bilinear patch
//!
//! ```text
//! y = (1 - u)(1 - v) h_00 + u (1 - v) h_10 + (1 - u) v h_01 + u v h_11,        u, v in [0, 1].
//! ```
//!
//! So the surface is the graph of one continuous function `h(x, z)`. Along a ray the gap `y(t) - h(x(t), z(t))` is a quadratic in
//! each cell, and crossings are where its sign changes. The sign is carried from cell to cell: where rounding lets two cells
//! disagree on the line between them, the crossing is on that line. No ray slips through, and of a solid one leaves as often as
//! it enters.
//!
//! A hierarchy of bounds, each over four of the level below, lets rays pass over and under blocks of cells
//! [Tevs, Ihrke and Seidel 2008]. Heights and bounds take 6.7 bytes a cell.
//!
//! With a base the shape is a solid: what of space is over the rectangle, above the base and below the surface.
//!
//! Scene: `HeightField { file hills.png  size 20 20  heights 0 4 }`

mod bounds;
mod walk;

use std::fmt;
use std::sync::Arc;

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3};

use self::bounds::HeightBounds;
use super::{Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, stored};
use crate::interaction::{Hit, SurfacePoint, Tangents};

/// Heights on a grid of points, one after the other along x, row by row along z.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightGrid {
    /// Points along x.
    pub columns: u32,
    /// Points along z.
    pub rows: u32,
    /// The heights.
    pub heights: Vec<f32>,
}

/// Why there is no height field of some numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightFieldError {
    /// A cell has four corners, and there are fewer, or not as many heights as columns and rows say.
    TooSmall {
        /// Points along x.
        columns: u32,
        /// Points along z.
        rows: u32,
    },
    /// A height is not finite.
    NotFinite {
        /// Counted from 0.
        column: u32,
        /// Counted from 0.
        row: u32,
    },
    /// The rectangle has no area or is not finite.
    NoArea,
    /// All of it is at the base or lower.
    BelowBase,
}

impl fmt::Display for HeightFieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            HeightFieldError::TooSmall { columns, rows } => {
                write!(f, "{columns} x {rows} heights make no surface; there must be 2 x 2 or more")
            }
            HeightFieldError::NotFinite { column, row } => {
                write!(f, "the height in column {} of row {} is not a finite number", column + 1, row + 1)
            }
            HeightFieldError::NoArea => f.write_str("both sides of the rectangle must be above zero"),
            HeightFieldError::BelowBase => f.write_str("no height is above the base"),
        }
    }
}

/// The surface, and the faces of a solid one.
const SURFACE: u32 = 0;
/// Faces at the least and the greatest x, then z, then the floor.
const FLOOR: u32 = 5;

/// A height field. A clone is the same.
#[derive(Clone, Debug)]
pub struct HeightField(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    grid: HeightGrid,
    bounds: HeightBounds,
    /// The corner with the least x and z, and the sides.
    corner: DVec2,
    size: DVec2,
    /// Sides of a cell.
    cell_size: DVec2,
    /// Lowest and highest y that rays are followed in.
    y_range: [f64; 2],
    base: Option<f64>,
    smooth: bool,
}

impl HeightField {
    /// * `corner`: least x and z of the rectangle
    /// * `size`: its sides along x and z, above zero
    /// * `base`: height of the floor of a solid, which has nothing of the surface where that is lower; `None` for the surface
    ///   alone
    /// * `smooth`: whether normals for shading are interpolated
    ///
    /// # Errors
    ///
    /// See [`HeightFieldError`].
    pub fn new(
        grid: HeightGrid,
        corner: DVec2,
        size: DVec2,
        base: Option<f64>,
        smooth: bool,
    ) -> Result<HeightField, HeightFieldError> {
        let (columns, rows) = (grid.columns, grid.rows);
        if columns < 2 || rows < 2 || grid.heights.len() as u64 != u64::from(columns) * u64::from(rows) {
            return Err(HeightFieldError::TooSmall { columns, rows });
        }
        if let Some(index) = grid.heights.iter().position(|h| !h.is_finite()) {
            let (column, row) = (index as u64 % u64::from(columns), index as u64 / u64::from(columns));
            return Err(HeightFieldError::NotFinite { column: column as u32, row: row as u32 });
        }
        let is_finite = corner.is_finite() && size.is_finite() && base.is_none_or(f64::is_finite);
        if !(is_finite && size.min_element() > 0.0) {
            return Err(HeightFieldError::NoArea);
        }
        let bounds = HeightBounds::new(&grid);
        if base.is_some_and(|base| base >= bounds.all()[1].into()) {
            return Err(HeightFieldError::BelowBase);
        }
        let [columns, rows] = grid.cells();
        let cell_size = size / DVec2::new(columns.into(), rows.into());
        let y_range = Parts::y_range(bounds.all().map(f64::from), base, cell_size);
        Ok(HeightField(Arc::new(Parts { grid, bounds, corner, size, cell_size, y_range, base, smooth })))
    }

    /// Bytes that a field of so many points takes.
    pub fn bytes(columns: u32, rows: u32) -> u64 {
        let points = u64::from(columns) * u64::from(rows);
        points * size_of::<f32>() as u64 + HeightBounds::bytes(columns, rows)
    }
}

impl HeightGrid {
    /// Cells along x and z.
    fn cells(&self) -> [u32; 2] {
        [self.columns - 1, self.rows - 1]
    }

    /// The height of a point.
    #[inline]
    fn at(&self, column: u32, row: u32) -> f32 {
        self.heights[row as usize * self.columns as usize + column as usize]
    }

    /// Heights at the corners of a cell: at its least x and z, then x first.
    #[inline(always)]
    fn corners(&self, [column, row]: [u32; 2]) -> [f32; 4] {
        let first = row as usize * self.columns as usize + column as usize;
        let (near, far) = (&self.heights[first..], &self.heights[first + self.columns as usize..]);
        [near[0], near[1], far[0], far[1]]
    }
}

/// The bilinear function in a cell: `h + a u + b v + c u v`.
#[derive(Clone, Copy)]
struct Cell {
    h: f64,
    a: f64,
    b: f64,
    c: f64,
}

impl Cell {
    #[inline]
    fn new(corners: [f32; 4]) -> Cell {
        let [h, x, z, both] = corners.map(f64::from);
        Cell { h, a: x - h, b: z - h, c: both - x - z + h }
    }

    #[inline]
    fn at(&self, u: f64, v: f64) -> f64 {
        self.h + self.a * u + (self.b + self.c * u) * v
    }

    /// The symmetric bilinear form that is `at` where both places are the same: the middle Bernstein coefficient of a line
    /// between them.
    #[inline]
    fn between(&self, [u0, v0]: [f64; 2], [u1, v1]: [f64; 2]) -> f64 {
        self.h + 0.5 * (self.a * (u0 + u1) + self.b * (v0 + v1) + self.c * (u0 * v1 + u1 * v0))
    }
}

impl Parts {
    /// The cell over which a point is, or the nearest one, and where in it.
    fn locate(&self, x: f64, z: f64) -> ([u32; 2], DVec2) {
        let g = (DVec2::new(x, z) - self.corner) / self.cell_size;
        let cell_of = |g: f64, cells: u32| {
            let cell = (g.max(0.0) as u32).min(cells - 1);
            (cell, (g - f64::from(cell)).clamp(0.0, 1.0))
        };
        let [columns, rows] = self.grid.cells();
        let ((i, u), (j, v)) = (cell_of(g.x, columns), cell_of(g.y, rows));
        ([i, j], DVec2::new(u, v))
    }

    fn height(&self, x: f64, z: f64) -> f64 {
        let (cell, uv) = self.locate(x, z);
        Cell::new(self.grid.corners(cell)).at(uv.x, uv.y)
    }

    /// Height, and its derivatives by x and z.
    fn height_and_slopes(&self, x: f64, z: f64) -> (f64, DVec2) {
        let (cell, uv) = self.locate(x, z);
        let cell = Cell::new(self.grid.corners(cell));
        let slopes = DVec2::new(cell.a + cell.c * uv.y, cell.b + cell.c * uv.x) / self.cell_size;
        (cell.at(uv.x, uv.y), slopes)
    }

    /// Derivatives by x and z that are continuous: those at the corners, by central differences, interpolated.
    fn smooth_slopes(&self, x: f64, z: f64) -> DVec2 {
        let ([i, j], uv) = self.locate(x, z);
        let slope = |lo: f32, hi: f32, steps: u32| (f64::from(hi) - f64::from(lo)) / f64::from(steps);
        let at = |i: u32, j: u32| {
            let (west, east) = (i.saturating_sub(1), (i + 1).min(self.grid.columns - 1));
            let (north, south) = (j.saturating_sub(1), (j + 1).min(self.grid.rows - 1));
            let across = slope(self.grid.at(west, j), self.grid.at(east, j), east - west);
            let along = slope(self.grid.at(i, north), self.grid.at(i, south), south - north);
            DVec2::new(across, along) / self.cell_size
        };
        let near = at(i, j).lerp(at(i + 1, j), uv.x);
        near.lerp(at(i, j + 1).lerp(at(i + 1, j + 1), uv.x), uv.y)
    }

    /// Lowest and highest y.
    fn extent(&self) -> [f64; 2] {
        let [low, high] = self.bounds.all().map(f64::from);
        [self.base.unwrap_or(low), high]
    }

    /// The largest coordinate.
    fn reach(&self) -> f64 {
        let far = self.corner + self.size;
        let [low, high] = self.extent();
        self.corner.abs().max(far.abs()).max_element().max(low.abs()).max(high.abs())
    }
}

/// The upward unit normal of a surface with these derivatives by x and z.
fn normal_of(slopes: DVec2) -> Vec3 {
    DVec3::new(-slopes.x, 1.0, -slopes.y).normalize().as_vec3()
}

/// The outward normal of a face of a solid.
fn normal_of_face(part: u32) -> Vec3 {
    match part {
        1 => Vec3::NEG_X,
        2 => Vec3::X,
        3 => Vec3::NEG_Z,
        4 => Vec3::Z,
        _ => Vec3::NEG_Y,
    }
}

impl Surface for HeightField {
    fn bounds(&self) -> Aabb {
        let (low, high) = (self.0.corner, self.0.corner + self.0.size);
        let [bottom, top] = self.0.extent();
        let [min, max] = [DVec3::new(low.x, bottom, low.y), DVec3::new(high.x, top, high.y)];
        Aabb { min: min.as_vec3(), max: max.as_vec3() }.padded(f32::EPSILON)
    }

    fn is_finite(&self) -> bool {
        self.bounds().is_finite()
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let mut first = None;
        self.0.walk(ray, |t, part| {
            first = in_range(ray, t).map(|t| Hit { t, part, ..Hit::default() });
            first.is_some()
        });
        first
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        self.0.walk(ray, |t, part| {
            in_range(ray, t).into_iter().for_each(|t| visit(Hit { t, part, ..Hit::default() }));
            false
        });
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (parts, end) = (&self.0, self.0.corner + self.0.size);
        let mut p = Ray64::new(ray).at(hit.t.into());
        p.x = p.x.clamp(parts.corner.x, end.x);
        p.z = p.z.clamp(parts.corner.y, end.y);
        let reach = parts.reach();
        if hit.part == SURFACE {
            let (height, slopes) = parts.height_and_slopes(p.x, p.z);
            let (p, p_error) = stored(DVec3 { y: height, ..p }, reach);
            let ng = normal_of(slopes);
            let n = if parts.smooth { normal_of(parts.smooth_slopes(p.x.into(), p.z.into())) } else { ng };
            return SurfacePoint { p, p_error, n, ng };
        }
        match hit.part {
            1 => p.x = parts.corner.x,
            2 => p.x = end.x,
            3 => p.z = parts.corner.y,
            4 => p.z = end.y,
            _ => p.y = parts.extent()[0],
        }
        let (p, p_error) = stored(p, reach);
        SurfacePoint::flat(p, p_error, normal_of_face(hit.part))
    }

    /// As the picture lies: `u` along x and `v` against z. Walls continue their edges.
    fn uv_at(&self, _hit: &Hit, p: Vec3) -> Vec2 {
        let relative = (DVec2::new(p.x.into(), p.z.into()) - self.0.corner) / self.0.size;
        Vec2::new(relative.x as f32, (1.0 - relative.y) as f32).clamp(Vec2::ZERO, Vec2::ONE)
    }

    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents {
        let slopes = match hit.part {
            SURFACE => self.0.height_and_slopes(p.x.into(), p.z.into()).1,
            _ => DVec2::ZERO,
        };
        let (u, v) = match hit.part {
            1 | 2 => (0.0, self.0.size.y),
            3 | 4 => (self.0.size.x, 0.0),
            _ => (self.0.size.x, self.0.size.y),
        };
        let dpdu = u * DVec3::new(1.0, slopes.x, 0.0);
        let dpdv = -v * DVec3::new(0.0, slopes.y, 1.0);
        Tangents { dpdu: dpdu.as_vec3(), dpdv: dpdv.as_vec3() }
    }

    fn is_closed(&self) -> bool {
        self.0.base.is_some()
    }

    fn part_count(&self) -> u32 {
        if self.is_closed() { FLOOR + 1 } else { 1 }
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        for part in 0..self.part_count() {
            let patch = TracedPatch::new(self.clone(), part);
            patch.into_iter().for_each(|patch| visit(part, Patch::Traced(Box::new(patch))));
        }
    }

    /// As many cells as there are, or twice as many as segments around a circle.
    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let parts = &self.0;
        let cells = parts.grid.cells().map(|n| n.min(2 * around));
        let low = parts.base.unwrap_or(f64::NEG_INFINITY);
        let point = |x: f64, y: f64| {
            let at = parts.corner + DVec2::new(x, y) * parts.size;
            let (height, slopes) = parts.height_and_slopes(at.x, at.y);
            let slopes = if parts.smooth { parts.smooth_slopes(at.x, at.y) } else { slopes };
            (DVec3::new(at.x, height.max(low), at.y), normal_of(slopes).as_dvec3())
        };
        out.grid(SURFACE, cells, point);
        let Some(base) = parts.base else { return };
        let floor = |p: DVec3| DVec3 { y: base, ..p };
        for part in 1..FLOOR {
            let n = normal_of_face(part).as_dvec3();
            let across = if part < 3 { cells[1] } else { cells[0] };
            out.grid(part, [across, 1], |s, up| {
                let side = f64::from((part - 1) % 2);
                let top = if part < 3 { point(side, s).0 } else { point(s, side).0 };
                (floor(top).lerp(top, up), n)
            });
        }
        out.grid(FLOOR, [1, 1], |x, y| (floor(point(x, y).0), DVec3::NEG_Y));
    }

    fn heap_bytes(&self) -> usize {
        size_of::<Parts>() + HeightField::bytes(self.0.grid.columns, self.0.grid.rows) as usize
    }
}

#[cfg(test)]
mod tests;
