//! Distance grids: where numbers on a grid of points, interpolated, are at a level.
//!
//! The numbers are signed distances or anything else that is lower inside than outside. Between the eight points around a *cell*
//! the function is trilinear,
//!
//! ```text
//! f(u, v, w) = sum over corners ijk of  u^i (1-u)^(1-i) v^j (1-v)^(1-j) w^k (1-w)^(1-k) f_ijk,
//! ```
//!
//! and along a ray, from `(u, v, w)` to `(u', v', w')` in the cell, it is a cubic whose Bernstein coefficients are values of its
//! blossom [Ramshaw 1989]: with one coordinate of the three taken from the end,
//!
//! ```text
//! b_0 = f(u, v, w)    b_1 = (f(u', v, w) + f(u, v', w) + f(u, v, w')) / 3
//! b_3 = f(u', v', w') b_2 = (f(u, v', w') + f(u', v, w') + f(u', v', w)) / 3.
//! ```
//!
//! Crossings are where the cubic changes its sign, isolated by those coefficients, and none is missed [Parker et al. 1998 solve the
//! same cubic]. Two cells have one value where a ray goes from one to the other, so crossings of a closed surface come in pairs. A
//! tree over the cells that the surface is in lets rays pass the others.
//!
//! Scene: `DistanceGrid { file statue.vol }`

use std::cell::Cell;
use std::fmt;
use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::{Aabb, DVec3, Ray, UVec3, Vec2, Vec3, roots};

use super::box_faces::{self, Corners, cap, face_at, face_point, faces, on_face};
use super::{Patch, Ray64, Surface, Tessellation, TracedPatch, in_range, stored};
use crate::interaction::{Hit, NO_UV, SurfacePoint, Tangents};

/// The surface of a grid. A clone is the same.
#[derive(Clone, Debug)]
pub struct DistanceGrid(Arc<Parts>);

/// Why numbers are no grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DistanceGridError {
    /// A cell has eight corners, and there are fewer, or not as many numbers as the size says.
    TooSmall {
        /// Points along x, y and z.
        size: [u32; 3],
    },
    /// A number is not finite.
    NotFinite {
        /// Its place, counted from 0 along x, y and z.
        at: [u32; 3],
    },
    /// The box has no volume or is not finite.
    NoVolume,
}

impl fmt::Display for DistanceGridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DistanceGridError::TooSmall { size: [x, y, z] } => {
                write!(
                    f,
                    "{x} x {y} x {z} numbers make no surface; there must be 2 x 2 x 2 or more, and all of them"
                )
            }
            DistanceGridError::NotFinite { at: [x, y, z] } => {
                write!(f, "the number at {x} {y} {z}, counted from 0, is not finite")
            }
            DistanceGridError::NoVolume => {
                f.write_str("every coordinate of `min` must be less than that of `max`")
            }
        }
    }
}

#[derive(Debug)]
struct Parts {
    size: UVec3,
    /// Less the level: negative inside. x runs first, then y.
    values: Vec<f32>,
    /// Along each axis, where the points are.
    planes: [Vec<f64>; 3],
    /// The lower corner of each cell that the surface is in.
    cells: Vec<UVec3>,
    tree: Bvh,
    bounds: Aabb,
    closed: bool,
    smooth: bool,
    /// The largest coordinate.
    reach: f64,
}

/// Memory that rays use again and again.
#[derive(Default)]
struct Scratch {
    /// What a ray has of each cell.
    intervals: Vec<([f64; 2], UVec3)>,
    hits: Vec<Hit>,
}

thread_local! {
    /// Taken while it is in use.
    static SCRATCH: Cell<Scratch> = Cell::default();
}

impl DistanceGrid {
    /// * `values`: on points that are evenly spread from `min` to `max`, the outermost ones on its faces; x runs first, then y
    /// * `level`: what the surface is at; lower numbers are inside
    /// * `closed`: whether the faces of the box belong to it where they cut through the inside
    /// * `smooth`: whether normals for shading are interpolated between the points
    ///
    /// # Errors
    /// See [`DistanceGridError`].
    pub fn new(
        size: [u32; 3],
        mut values: Vec<f32>,
        [min, max]: [Vec3; 2],
        level: f32,
        [closed, smooth]: [bool; 2],
    ) -> Result<DistanceGrid, DistanceGridError> {
        let count: u64 = size.iter().map(|&n| u64::from(n)).fold(1, u64::saturating_mul);
        if size.iter().any(|&n| n < 2) || values.len() as u64 != count {
            return Err(DistanceGridError::TooSmall { size });
        }
        if !(min.is_finite() && max.is_finite() && min.cmplt(max).all()) {
            return Err(DistanceGridError::NoVolume);
        }
        for (i, value) in values.iter_mut().enumerate() {
            *value -= level;
            if !value.is_finite() {
                let (x, rest) = (i as u64 % u64::from(size[0]), i as u64 / u64::from(size[0]));
                let at = [x, rest % u64::from(size[1]), rest / u64::from(size[1])].map(|n| n as u32);
                return Err(DistanceGridError::NotFinite { at });
            }
        }
        let [low, high] = [min, max].map(Vec3::as_dvec3);
        let planes = [0, 1, 2].map(|axis| {
            let last = size[axis] - 1;
            let plane = |k: u32| {
                let share = f64::from(k) / f64::from(last);
                if k == last { high[axis] } else { low[axis] + share * (high[axis] - low[axis]) }
            };
            (0..=last).map(plane).collect()
        });
        let reach = low.abs().max(high.abs()).max_element();
        let mut parts = Parts {
            size: size.into(),
            values,
            planes,
            cells: Vec::new(),
            tree: Bvh::build(&[], &BuildSettings::default()),
            bounds: Aabb::EMPTY,
            closed,
            smooth,
            reach,
        };
        parts.find_cells();
        Ok(DistanceGrid(Arc::new(parts)))
    }

    /// Whether there is no surface in the box.
    pub fn is_empty(&self) -> bool {
        self.0.bounds.is_empty()
    }
}

impl Parts {
    fn corners(&self) -> Corners {
        [0, self.size.max_element()].map(|k| {
            DVec3::from_array([0, 1, 2].map(|axis| self.planes[axis][k.min(self.size[axis] - 1) as usize]))
        })
    }

    /// Finds the cells that the surface is in, and makes the tree over them.
    fn find_cells(&mut self) {
        let last = self.size - 1;
        let mut fills_faces = false;
        let mut cells = Vec::new();
        for z in 0..last.z {
            for y in 0..last.y {
                for x in 0..last.x {
                    let cell = UVec3::new(x, y, z);
                    let corners = self.cell_values(cell);
                    let inside = corners.iter().filter(|&&value| value < 0.0).count();
                    let touches = cell.cmpeq(UVec3::ZERO).any() || (cell + 1).cmpeq(last).any();
                    fills_faces |= inside > 0 && touches;
                    cells.extend((inside > 0 && inside < 8).then_some(cell));
                }
            }
        }
        let boxes: Vec<Aabb> = cells.iter().map(|&cell| self.cell_bounds(cell)).collect();
        let [low, high] = self.corners();
        self.bounds = if self.closed && fills_faces {
            Aabb { min: low.as_vec3(), max: high.as_vec3() }
        } else {
            boxes.iter().fold(Aabb::EMPTY, |all, cell| all.union(*cell))
        };
        self.tree = Bvh::build(&boxes, &BuildSettings::default());
        self.cells = cells;
    }

    fn stored_value(&self, at: UVec3) -> f64 {
        let [nx, ny] = [self.size.x, self.size.y].map(|n| n as usize);
        f64::from(self.values[(at.z as usize * ny + at.y as usize) * nx + at.x as usize])
    }

    /// The numbers at the corners of a cell: x first, then y.
    fn cell_values(&self, cell: UVec3) -> [f64; 8] {
        std::array::from_fn(|i| {
            self.stored_value(cell + UVec3::new(i as u32 & 1, i as u32 >> 1 & 1, i as u32 >> 2))
        })
    }

    /// The planes before and behind a cell.
    fn ends(&self, cell: UVec3, axis: usize) -> [f64; 2] {
        let k = cell[axis] as usize;
        [self.planes[axis][k], self.planes[axis][k + 1]]
    }

    /// A box of single precision around a cell.
    fn cell_bounds(&self, cell: UVec3) -> Aabb {
        let corner = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| self.ends(cell, axis)[i]));
        let [low, high] = [0, 1].map(corner);
        Aabb { min: low.as_vec3().map(f32::next_down), max: high.as_vec3().map(f32::next_up) }
    }

    /// The cell of a point, and where in it the point is, from 0 to 1: a point that rounding has put beside its cell is on its face.
    fn locate(&self, p: DVec3) -> (UVec3, DVec3) {
        let [low, high] = self.corners();
        let scaled = (p - low) / (high - low) * (self.size - 1).as_dvec3();
        let cell = scaled.max(DVec3::ZERO).as_uvec3().min(self.size - 2);
        (cell, self.within(cell, p).clamp(DVec3::ZERO, DVec3::ONE))
    }

    /// Where a point is in a cell, from 0 to 1 within it.
    fn within(&self, cell: UVec3, p: DVec3) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|axis| {
            let [a, b] = self.ends(cell, axis);
            (p[axis] - a) / (b - a)
        }))
    }

    /// The function at a point of the box.
    fn value(&self, p: DVec3) -> f64 {
        let (cell, at) = self.locate(p);
        trilinear(&self.cell_values(cell), at)
    }

    /// The function and its gradient in the cell of a point.
    fn gradient(&self, p: DVec3) -> (f64, DVec3) {
        let (cell, at) = self.locate(p);
        let corners = self.cell_values(cell);
        let slope = |axis: usize| {
            let [mut a, mut b] = [at; 2];
            (a[axis], b[axis]) = (0.0, 1.0);
            let [lo, hi] = self.ends(cell, axis);
            (trilinear(&corners, b) - trilinear(&corners, a)) / (hi - lo)
        };
        (trilinear(&corners, at), DVec3::new(slope(0), slope(1), slope(2)))
    }

    /// The gradient, by central differences at the points around a point, interpolated.
    fn smooth_gradient(&self, p: DVec3) -> DVec3 {
        let (cell, at) = self.locate(p);
        let last = self.size - 1;
        let slope = |axis: usize| {
            let corners = std::array::from_fn(|i| {
                let point = cell + UVec3::new(i as u32 & 1, i as u32 >> 1 & 1, i as u32 >> 2);
                let [mut before, mut behind] = [point; 2];
                before[axis] = point[axis].saturating_sub(1);
                behind[axis] = (point[axis] + 1).min(last[axis]);
                let [a, b] = [before, behind].map(|at| self.planes[axis][at[axis] as usize]);
                (self.stored_value(behind) - self.stored_value(before)) / (b - a)
            });
            trilinear(&corners, at)
        };
        DVec3::new(slope(0), slope(1), slope(2))
    }

    /// See [`box_faces::clip`].
    fn clip(&self, cell: UVec3, line: &Ray64, range: [f64; 2]) -> Option<[f64; 2]> {
        box_faces::clip(|axis| self.ends(cell, axis), line, range)
    }

    /// Visits the changes of sign of a line in a cell, in ascending order, until `visit` says that it is enough.
    fn cross(&self, cell: UVec3, line: &Ray64, [a, b]: [f64; 2], mut visit: impl FnMut(f64) -> bool) {
        let corners = self.cell_values(cell);
        let [p, q] = [a, b].map(|t| line.at(t));
        let [u, v] = [p, q].map(|p| self.within(cell, p));
        let f = |x: f64, y: f64, z: f64| trilinear(&corners, DVec3::new(x, y, z));
        let coefficients = [
            // What neighbours find too.
            self.value(p),
            (f(v.x, u.y, u.z) + f(u.x, v.y, u.z) + f(u.x, u.y, v.z)) / 3.0,
            (f(u.x, v.y, v.z) + f(v.x, u.y, v.z) + f(v.x, v.y, u.z)) / 3.0,
            self.value(q),
        ];
        roots::sign_changes_until(&coefficients, |s| visit(a + s * (b - a)));
    }

    fn is_inside(&self, p: DVec3) -> bool {
        self.value(p) < 0.0
    }
}

/// The value between eight corners, x first, then y.
#[inline]
fn trilinear(corners: &[f64; 8], at: DVec3) -> f64 {
    let mix = |a: f64, b: f64, s: f64| a * (1.0 - s) + b * s;
    let along = |i: usize| mix(corners[i], corners[i + 1], at.x);
    mix(mix(along(0), along(2), at.y), mix(along(4), along(6), at.y), at.z)
}

impl Surface for DistanceGrid {
    fn bounds(&self) -> Aabb {
        self.0.bounds
    }

    fn is_finite(&self) -> bool {
        true
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let sides = if parts.closed { faces(parts.corners(), &line) } else { None };
        let side = |side: (f64, u32)| cap(ray, &line, side, |p| parts.is_inside(p));
        if let Some(front) = sides.and_then(|[front, _]| side(front)) {
            return Some(front);
        }
        let mut nearest = None;
        parts.tree.closest(ray, |index, far| {
            let cell = parts.cells[index as usize];
            let range = [f64::from(ray.t_min), f64::from(far)];
            let Some(piece) = parts.clip(cell, &line, range) else { return far };
            let mut first = None;
            parts.cross(cell, &line, piece, |t| {
                first = in_range(ray, t);
                first.is_some()
            });
            match first {
                Some(t) if t < far => {
                    nearest = Some(Hit { t, ..Hit::default() });
                    t
                }
                _ => far,
            }
        });
        nearest.or_else(|| sides.and_then(|[_, back]| side(back)))
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let mut scratch = SCRATCH.take();
        let Scratch { intervals, hits } = &mut scratch;
        parts.tree.each(ray, |index| {
            let cell = parts.cells[index as usize];
            let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
            intervals.extend(parts.clip(cell, &line, everywhere).map(|interval| (interval, cell)));
        });
        intervals.sort_unstable_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        for (interval, cell) in intervals.drain(..) {
            parts.cross(cell, &line, interval, |t| {
                hits.extend(in_range(ray, t).map(|t| Hit { t, ..Hit::default() }));
                false
            });
        }
        let sides = if parts.closed { faces(parts.corners(), &line) } else { None };
        let sides = sides.into_iter().flatten();
        hits.extend(sides.filter_map(|side| cap(ray, &line, side, |p| parts.is_inside(p))));
        // `visit` may intersect another surface, which takes memory of its own.
        hits.drain(..).for_each(&mut visit);
        SCRATCH.set(scratch);
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let parts = &*self.0;
        let line = Ray64::new(ray);
        let p = line.at(hit.t.into());
        if let Some((p, n)) = face_point(parts.corners(), hit, p) {
            let (p, p_error) = stored(p, parts.reach);
            return SurfacePoint::flat(p, p_error, n.as_vec3());
        }
        // Onto the surface, by no more than rounding has moved it.
        let (value, gradient) = parts.gradient(p);
        let step = value / gradient.length_squared() * gradient;
        let p = if step.length() < 1e-4 * parts.reach { p - step } else { p };
        let ng = gradient.normalize_or(-line.d.normalize_or(DVec3::Z));
        let n = if parts.smooth { parts.smooth_gradient(p).normalize_or(ng) } else { ng };
        let (p, p_error) = stored(p, parts.reach);
        SurfacePoint { p, p_error, n: n.as_vec3(), ng: ng.as_vec3() }
    }

    /// A distance grid has no surface coordinates.
    fn uv_at(&self, _hit: &Hit, _p: Vec3) -> Vec2 {
        NO_UV
    }

    fn tangents_at(&self, _hit: &Hit, _p: Vec3) -> Tangents {
        Tangents::default()
    }

    fn is_closed(&self) -> bool {
        self.0.closed
    }

    fn hit_at(&self, _part: u32, p: Vec3) -> Hit {
        let face = face_at(self.0.corners(), p).filter(|_| self.0.closed);
        face.map_or(Hit::default(), |face| on_face(0.0, face))
    }

    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        let patch = TracedPatch::new(self.clone(), 0);
        patch.into_iter().for_each(|patch| visit(0, Patch::Traced(Box::new(patch))));
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        let corners = self.0.corners();
        box_faces::tessellate(corners, self.0.bounds, self.0.closed, around, out, |p| {
            let (value, gradient) = self.0.gradient(p.clamp(corners[0], corners[1]));
            (-value, gradient)
        });
    }

    fn heap_bytes(&self) -> usize {
        let parts = &*self.0;
        size_of::<Parts>()
            + size_of_val(&*parts.values)
            + size_of_val(&*parts.cells)
            + parts.planes.iter().map(|planes| size_of_val(&**planes)).sum::<usize>()
            + parts.tree.stats().bytes
    }
}

#[cfg(test)]
mod tests;
