//! Which primitives lie in which direction from a point.
//!
//! Camera rays of a pinhole camera start at one point, shadow rays of a point light end at one. The
//! directions from such an apex are divided into cells once, and each cell lists what can be met there,
//! nearest first. A ray then asks a short list instead of a tree [Weghorst, Hooper and Greenberg 1984],
//! [Haines and Greenberg 1986].
//!
//! The cells are those of six grids on a cube around the apex. A direction `d` whose largest coordinate is
//! `d_a` belongs to the face of that axis and sign, at
//!
//! ```text
//! u = d_b / |d_a|,    v = d_c / |d_a|,    a, b, c in cyclic order.
//! ```
//!
//! Each grid covers only the window of its face behind which there is anything ([`lists`] fills it). A cell remembers
//! from which distance on something opaque hides all of it: what is farther away is in its shadow, whatever else is
//! there. The finer the grid, the more is known without asking a single primitive.
//!
//! Lists are conservative: everything is taken for larger by `slack`, and only rays that keep to the lines through
//! the apex within half of that are answered. What a ray hits is therefore the same, bit for bit, with and without.

use kajo_math::{Aabb, Ray, Vec3};

use crate::ids::ObjectId;
use crate::shape::Sphere;

mod lists;

/// Longest list of a cell; where there is more, a tree is faster.
const LONGEST: usize = 24;

/// What everything is larger by, relative to the distance of the farthest primitive: above all rounding, far below
/// the size of a cell.
const SLACK: f64 = 1.0 / 8192.0;

/// Rays that start farther away than this many times the farthest primitive are not answered: their own rounding
/// comes near the slack.
const REACH: f64 = 16.0;

/// How far the squared length of a unit vector may be from 1.
const UNIT: f32 = 1e-5;

/// What is put into a buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BufferedObject {
    /// Its name.
    pub object: ObjectId,
    /// Finite bounds.
    pub bounds: Aabb,
    /// The shape, if it is a sphere.
    pub sphere: Option<Sphere>,
    /// Whether nothing behind it matters.
    pub opaque: bool,
}

/// An entry of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub object: ObjectId,
    /// No point of the primitive is nearer to the apex.
    pub near: f32,
}

/// For every direction from a point, what lies there.
#[derive(Clone, Debug)]
pub struct ItemBuffer {
    apex: Vec3,
    /// How far rays may end from the apex, squared.
    slack_squared: f32,
    /// How far from the apex they may start, squared.
    reach_squared: f32,
    /// By axis, and for each the positive direction first.
    faces: [Face; 6],
    cells: Vec<Cell>,
    items: Vec<Item>,
}

/// A grid over a window of a face.
#[derive(Clone, Copy, Debug, Default)]
struct Face {
    /// Smallest `u` and `v`.
    start: [f32; 2],
    /// Cells per unit of `u` and `v`.
    scale: [f32; 2],
    /// Cells across; 0 where there is nothing to see.
    side: u32,
    /// Number of the first cell.
    first: u32,
}

/// A list of items, or too many for one.
#[derive(Clone, Copy, Debug)]
struct Cell {
    first: u32,
    len: u32,
    /// The distance beyond which something opaque hides everything.
    hidden_beyond: f32,
}

/// What is between the apex and a point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Between<'a> {
    /// Something opaque, for sure.
    Blocked,
    /// None but the first of these, up to this distance from the apex.
    Items(&'a [Item], f32),
}

impl ItemBuffer {
    /// A buffer around `apex`, or `None` when there is nothing to put in, the apex is not finite, or squares of distances
    /// leave the range of single precision.
    ///
    /// * `cells`: how many directions to tell apart, about; more where the bodies are many
    pub(crate) fn new(apex: Vec3, bodies: &[BufferedObject], cells: usize) -> Option<ItemBuffer> {
        let center = apex.as_dvec3();
        let farthest = |b: &BufferedObject| {
            let (lo, hi) = (b.bounds.min.as_dvec3() - center, b.bounds.max.as_dvec3() - center);
            lo.abs().max(hi.abs()).length()
        };
        let extent = bodies.iter().map(farthest).fold(0.0, f64::max);
        let slack = (SLACK * extent).max(32.0 * f64::from(f32::EPSILON) * center.abs().max_element());
        if !(extent > 0.0 && slack.is_finite()) {
            return None;
        }
        let [slack_squared, reach_squared] = [0.5 * slack, REACH * extent].map(|v| (v * v) as f32);
        if slack_squared < f32::MIN_POSITIVE || !reach_squared.is_finite() {
            return None;
        }
        let (faces, cells, items) = lists::around(center, bodies, slack, cells);
        Some(ItemBuffer { apex, slack_squared, reach_squared, faces, cells, items })
    }

    /// What a ray may meet, nearest first; `None` where that is too much for a list, or the ray does not start at
    /// the apex with a direction of unit length.
    #[inline]
    pub(crate) fn seen_along(&self, ray: &Ray) -> Option<&[Item]> {
        let unit = (ray.d.length_squared() - 1.0).abs() < UNIT;
        if !(unit && ray.o == self.apex && ray.t_min >= 0.0) {
            return None;
        }
        self.cell(ray.d).map_or(Some(&[]), |cell| self.list(cell))
    }

    /// What a ray that ends at the apex may meet, those nearest to the apex first; `None` where that is too much for a
    /// list, or the ray does not end close enough to the apex.
    #[inline(always)]
    pub(crate) fn between(&self, ray: &Ray) -> Option<Between<'_>> {
        let from_apex = ray.o - self.apex;
        let miss = from_apex + ray.t_max * ray.d;
        let distance_squared = from_apex.length_squared();
        if !(miss.length_squared() <= self.slack_squared && distance_squared <= self.reach_squared) {
            return None;
        }
        let Some(cell) = self.cell(from_apex) else { return Some(Between::Items(&[], 0.0)) };
        let distance = distance_squared.sqrt();
        if distance > cell.hidden_beyond {
            return Some(Between::Blocked);
        }
        Some(Between::Items(self.list(cell)?, distance * (1.0 + 8.0 * f32::EPSILON)))
    }

    /// The cell of a direction; none where there is nothing.
    #[inline]
    fn cell(&self, d: Vec3) -> Option<&Cell> {
        let a = d.abs();
        let (axis, [w, u, v]) = if a.x >= a.y && a.x >= a.z {
            (0, [d.x, d.y, d.z])
        } else if a.y >= a.z {
            (1, [d.y, d.z, d.x])
        } else {
            (2, [d.z, d.x, d.y])
        };
        let face = &self.faces[2 * axis + usize::from(w < 0.0)];
        let inverse = 1.0 / w.abs();
        let x = (u * inverse - face.start[0]) * face.scale[0];
        let y = (v * inverse - face.start[1]) * face.scale[1];
        let side = face.side as f32;
        // Outside the window there is nothing, and no direction at all leads nowhere.
        if !(x >= 0.0 && y >= 0.0 && x < side && y < side) {
            return None;
        }
        // Sides are far below 2^31, and to signed numbers processors convert at once.
        let [x, y] = [x, y].map(|v| v as i32 as u32);
        self.cells.get((face.first + y * face.side + x) as usize)
    }

    /// The items of a cell, unless there are too many.
    #[inline]
    fn list(&self, cell: &Cell) -> Option<&[Item]> {
        let Cell { first, len, .. } = *cell;
        if len as usize > LONGEST {
            return None;
        }
        Some(&self.items[first as usize..(first + len) as usize])
    }

    /// Bytes kept.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.cells) + size_of_val(&*self.items)
    }
}

#[cfg(test)]
mod tests;
