//! Bounds on a density from above and from below, cell by cell of a box.
//!
//! A ray steps through the cells in the order in which it meets them [Amanatides and Woo 1987], so that collisions are drawn by a
//! bound that is near the density where it is thin, and empty cells cost none.

use kajo_math::{Aabb, Ray, Vec3};

/// A stretch of a ray on which the density is between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Majorant {
    /// Where it begins.
    pub t_min: f32,
    /// Where it ends.
    pub t_max: f32,
    /// The density is nowhere more: the majorant.
    pub density: f32,
    /// Nor is it less, but for rounding.
    pub least: f32,
}

/// A box of equal cells with bounds for each.
#[derive(Clone, Debug)]
pub struct MajorantGrid {
    bounds: Aabb,
    size: [u32; 3],
    /// Cells per unit length along each axis.
    cells_per_length: Vec3,
    /// The least and the largest density, x first.
    ranges: Vec<[f32; 2]>,
}

impl MajorantGrid {
    /// * `bounds`: the box, not flat
    /// * `size`: cells along each axis, at least one
    /// * `range`: the least and the largest density of a cell
    pub fn new(bounds: Aabb, size: [u32; 3], mut range: impl FnMut([u32; 3]) -> [f32; 2]) -> MajorantGrid {
        let [nx, ny, nz] = size;
        let cells = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let ranges = cells.map(&mut range).collect();
        let cells_per_length = Vec3::from(size.map(|n| n as f32)) / bounds.extent();
        MajorantGrid { bounds, size, cells_per_length, ranges }
    }

    /// The box.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The largest of all.
    pub fn largest(&self) -> f32 {
        self.ranges.iter().map(|&[_, most]| most).fold(0.0, f32::max)
    }

    /// The least and the largest density in a part of space; outside of the box it is 0.
    pub fn range_in(&self, region: &Aabb) -> [f32; 2] {
        let last = self.size.map(|n| n as i64 - 1);
        let cell = |p: Vec3, pad: f32| {
            let place = ((p - self.bounds.min) * self.cells_per_length).to_array();
            // Where rounding might say the one beside, that one counts too.
            place.map(|x| (x + pad).floor() as i64)
        };
        let (low, high) = (cell(region.min, -1e-3), cell(region.max, 1e-3));
        if (0..3).any(|axis| high[axis] < 0 || low[axis] > last[axis]) {
            return [0.0; 2];
        }
        let is_within = (0..3).all(|axis| low[axis] >= 0 && high[axis] <= last[axis]);
        let range = |axis: usize| low[axis].max(0) as usize..=high[axis].min(last[axis]) as usize;
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let rows = range(2).flat_map(|z| range(1).map(move |y| (z * ny + y) * nx));
        let cells = rows.flat_map(|row| range(0).map(move |x| row + x));
        let start = if is_within { [f32::INFINITY, 0.0] } else { [0.0; 2] };
        let join = |[a, b]: [f32; 2], [c, d]: [f32; 2]| [a.min(c), b.max(d)];
        cells.map(|cell| self.ranges[cell]).fold(start, join)
    }

    /// The cells along a ray.
    pub fn walk(&self, ray: &Ray) -> GridWalk<'_> {
        let o = (ray.o - self.bounds.min) * self.cells_per_length;
        let d = ray.d * self.cells_per_length;
        let (t, end) = self.bounds.clip(ray).filter(|(t, end)| t < end).unwrap_or((0.0, -1.0));
        let start = (o + d * t.max(0.0)).to_array();
        let cell = [0, 1, 2].map(|axis| {
            let last = self.size[axis] as i32 - 1;
            // Numbers too large for a cell are those of rays that miss the box.
            (start[axis].floor() as i32).clamp(0, last)
        });
        let (o, d) = (o.to_array(), d.to_array());
        let crossings = [0, 1, 2].map(|axis| crossing(cell[axis], o[axis], d[axis]));
        GridWalk { grid: self, o, d, cell, crossings, t: t.max(0.0), end }
    }
}

/// A walk through the cells of a [`MajorantGrid`].
#[derive(Clone, Debug)]
pub struct GridWalk<'a> {
    grid: &'a MajorantGrid,
    /// The ray in units of cells.
    o: [f32; 3],
    d: [f32; 3],
    cell: [i32; 3],
    /// Where it leaves the cell across each axis.
    crossings: [f32; 3],
    t: f32,
    /// Where the ray leaves the box; less than `t` when the walk is done.
    end: f32,
}

/// Where a ray leaves a cell across one axis; `o` and `d` are in units of cells.
#[inline]
fn crossing(cell: i32, o: f32, d: f32) -> f32 {
    let ahead = cell + i32::from(d > 0.0);
    if d == 0.0 { f32::INFINITY } else { (ahead as f32 - o) / d }
}

impl Iterator for GridWalk<'_> {
    type Item = Majorant;

    fn next(&mut self) -> Option<Majorant> {
        while self.t < self.end {
            let crossings = self.crossings;
            let mut axis = usize::from(crossings[1] < crossings[0]);
            if crossings[2] < crossings[axis] {
                axis = 2;
            }
            let [x, y, z] = self.cell.map(|k| k as usize);
            let [nx, ny, _] = self.grid.size.map(|n| n as usize);
            let [least, density] = self.grid.ranges[(z * ny + y) * nx + x];
            let (t_min, t_max) = (self.t, crossings[axis].clamp(self.t, self.end));
            self.t = t_max;
            self.cell[axis] += if self.d[axis] > 0.0 { 1 } else { -1 };
            self.crossings[axis] = crossing(self.cell[axis], self.o[axis], self.d[axis]);
            if !(0..self.grid.size[axis] as i32).contains(&self.cell[axis]) {
                // The last cell reaches to the end, whatever rounding says.
                self.end = f32::NEG_INFINITY;
            }
            if density > 0.0 && t_min < t_max {
                return Some(Majorant { t_min, t_max, density, least });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, rng::Stream, warp};

    use super::*;

    fn grid() -> MajorantGrid {
        let bounds = Aabb { min: Vec3::new(-1.0, 0.0, 2.0), max: Vec3::new(3.0, 1.5, 4.0) };
        MajorantGrid::new(bounds, [5, 3, 4], |[x, y, z]| [x as f32, (1 + x + 10 * y + 100 * z) as f32])
    }

    /// The stretches are those of the cells that the ray is in, and fill all of its way through the box.
    #[test]
    fn a_walk_visits_the_cells_of_its_points() {
        let grid = grid();
        for i in 0..4000 {
            let number = Stream::new(3, [i, 0], 0);
            let u = |k| number.uniform(k);
            let o = Vec3::new(6.0 * u(0) - 2.0, 4.0 * u(1) - 1.0, 5.0 * u(2));
            let d = match i % 4 {
                0 => [Vec3::X, Vec3::Y, Vec3::NEG_Z][(i / 4 % 3) as usize],
                _ => warp::uniform_sphere(Vec2::new(u(3), u(4))),
            };
            let ray = Ray::new(o, d).over(0.0, if i % 3 == 0 { 1.5 } else { f32::INFINITY });
            let length: f32 = grid.walk(&ray).map(|m| m.t_max - m.t_min).sum();
            let expected = grid.bounds.clip(&ray).map_or(0.0, |(a, b)| b - a.max(0.0));
            assert!((length - expected).abs() < 1e-4, "{ray:?}: {length} {expected}");
            let mut last = 0.0;
            for m in grid.walk(&ray) {
                assert!(m.t_min >= last);
                last = m.t_max;
                let cell = (ray.at(0.5 * (m.t_min + m.t_max)) - grid.bounds.min) * grid.cells_per_length;
                let [x, y, z] = cell.to_array().map(|x| x.floor());
                if m.t_max - m.t_min > 1e-4 {
                    assert_eq!([m.least, m.density], [x, 1.0 + x + 10.0 * y + 100.0 * z], "{ray:?} {m:?}");
                }
            }
        }
    }

    /// A part of space has the bounds of the cells that it touches, and 0 where there are none.
    #[test]
    fn a_part_of_space_has_the_bounds_of_its_cells() {
        let grid = grid();
        let range = |min: [f32; 3], max: [f32; 3]| grid.range_in(&Aabb { min: min.into(), max: max.into() });
        assert_eq!(range([-0.9, 0.1, 2.1], [-0.8, 0.2, 2.2]), [0.0, 1.0]);
        assert_eq!(range([0.0, 0.6, 3.1], [1.0, 0.9, 3.2]), [1.0, 213.0]);
        assert_eq!(range([0.0, 0.6, 3.1], [1.0, 0.9, 9.0]), [0.0, 313.0]);
        assert_eq!(range([-9.0; 3], [9.0; 3]), [0.0, 325.0]);
        assert_eq!(range([5.0; 3], [9.0; 3]), [0.0; 2]);
    }

    #[test]
    fn a_ray_that_misses_finds_nothing() {
        assert_eq!(grid().walk(&Ray::new(Vec3::new(0.0, 9.0, 0.0), Vec3::X)).next(), None);
        assert_eq!(grid().walk(&Ray::new(Vec3::new(9.0, 1.0, 3.0), Vec3::X)).next(), None);
    }
}
