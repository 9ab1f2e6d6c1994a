//! A medium whose density is given at the points of a grid: a cloud, smoke of a simulation.
//!
//! Values belong to the middles of voxels that fill a box, and are interpolated linearly along the three axes between them; in
//! the outer half of the outermost voxels the nearest ones hold. Along a ray through a cell the density is a cubic.
//!
//! Scene: `Media { GridMedium cloud { file cloud.vol  density 20  albedo 1 } }`

use std::sync::Arc;

use kajo_math::{Aabb, Ray, Vec3};

use super::{Coefficients, MajorantGrid, Majorants, Medium};
use crate::texture::Textures;

/// Densities at the points of a box.
#[derive(Clone, Debug)]
pub struct DensityGrid {
    size: [u32; 3],
    /// x first, then y.
    values: Arc<Vec<f32>>,
}

/// Why there is no such grid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// No voxels.
    #[error("the grid has no voxels")]
    Empty,
    /// More or fewer values than voxels.
    #[error("a grid of {voxels} voxels has {values} values")]
    Count {
        /// As many as there should be.
        voxels: u64,
        /// As many as there are.
        values: u64,
    },
    /// A density that is none.
    #[error("value {index} of the grid is {value}: densities are finite and not negative")]
    Value {
        /// Its place among all, from 0.
        index: usize,
        /// What it is.
        value: f32,
    },
    /// A temperature that is none.
    #[error("voxel ({}, {}, {}) of the temperatures is {value}", voxel[0], voxel[1], voxel[2])]
    Temperature {
        /// Its place, from the corner of the box of the grid.
        voxel: [u32; 3],
        /// What it is.
        value: f32,
    },
    /// A velocity that is none.
    #[error("voxel ({}, {}, {}) of the velocities is {value}", voxel[0], voxel[1], voxel[2])]
    Velocity {
        /// Its place, from the corner of the box of the grid.
        voxel: [u32; 3],
        /// What it is.
        value: f32,
    },
    /// A density that is none, of a file with places.
    #[error("voxel ({}, {}, {}) of the grid is {value}: densities are finite and not negative", voxel[0], voxel[1], voxel[2])]
    Voxel {
        /// Its place, from the corner of the box of the grid.
        voxel: [u32; 3],
        /// What it is.
        value: f32,
    },
}

impl DensityGrid {
    /// * `size`: voxels along x, y and z
    /// * `values`: their densities, x first, then y
    ///
    /// # Errors
    /// [`GridError`].
    pub fn new(size: [u32; 3], values: Vec<f32>) -> Result<DensityGrid, GridError> {
        let voxels = size.into_iter().map(u64::from).try_fold(1, u64::checked_mul).unwrap_or(u64::MAX);
        if voxels == 0 {
            return Err(GridError::Empty);
        }
        if voxels != values.len() as u64 {
            return Err(GridError::Count { voxels, values: values.len() as u64 });
        }
        if let Some(index) = values.iter().position(|v| !v.is_finite() || *v < 0.0) {
            return Err(GridError::Value { index, value: values[index] });
        }
        Ok(DensityGrid { size, values: Arc::new(values) })
    }

    /// The density at a point of the unit cube.
    fn at(&self, p: Vec3) -> f32 {
        let size = Vec3::from(self.size.map(|n| n as f32));
        let last = self.size.map(|n| n - 1);
        let place = (p * size - 0.5).clamp(Vec3::ZERO, Vec3::from(last.map(|n| n as f32)));
        let low = place.to_array().map(|x| x as u32);
        let high = [0, 1, 2].map(|axis| (low[axis] + 1).min(last[axis]));
        let f = place - Vec3::from(low.map(|n| n as f32));
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let value = |x: u32, y: u32, z: u32| self.values[(z as usize * ny + y as usize) * nx + x as usize];
        let mix = |a: f32, b: f32, t: f32| a + t * (b - a);
        let row = |y: u32, z: u32| mix(value(low[0], y, z), value(high[0], y, z), f.x);
        let plane = |z: u32| mix(row(low[1], z), row(high[1], z), f.y);
        mix(plane(low[2]), plane(high[2]), f.z)
    }

    /// The least and the largest value that interpolation reads in a block of voxels, from `low` to before `high` along each axis.
    fn extremes(&self, low: [u32; 3], high: [u32; 3]) -> [f32; 2] {
        let [nx, ny, _] = self.size.map(|n| n as usize);
        let range = |axis: usize| low[axis].saturating_sub(1)..(high[axis] + 1).min(self.size[axis]);
        let (mut least, mut largest) = (f32::INFINITY, 0f32);
        for z in range(2) {
            for y in range(1) {
                let row = (z as usize * ny + y as usize) * nx;
                let values = &self.values[row + range(0).start as usize..row + range(0).end as usize];
                least = values.iter().copied().fold(least, f32::min);
                largest = values.iter().copied().fold(largest, f32::max);
            }
        }
        [least, largest]
    }

    /// Bounds of blocks of voxels.
    fn majorants(&self, bounds: Aabb) -> MajorantGrid {
        // Blocks of whole voxels would not divide a box evenly where their number does not, so cells take what they touch.
        let cells = self.size.map(|n| n.div_ceil(LEAST_BLOCK).min(MOST_CELLS));
        MajorantGrid::new(bounds, cells, |cell| {
            let edge =
                |axis: usize, k: u32| (u64::from(self.size[axis]) * u64::from(k), u64::from(cells[axis]));
            let low = [0, 1, 2].map(|axis| {
                let (voxels, cells) = edge(axis, cell[axis]);
                (voxels / cells) as u32
            });
            let high = [0, 1, 2].map(|axis| {
                let (voxels, cells) = edge(axis, cell[axis] + 1);
                voxels.div_ceil(cells) as u32
            });
            self.extremes(low, high)
        })
    }
}

/// Voxels along an axis that share a bound, at least.
const LEAST_BLOCK: u32 = 4;

/// Bounds along an axis, at most.
const MOST_CELLS: u32 = 64;

/// A medium by a grid of densities in a box.
#[derive(Clone, Debug)]
pub struct GridMedium {
    coefficients: Coefficients,
    grid: DensityGrid,
    majorants: MajorantGrid,
    inverse_extent: Vec3,
}

impl GridMedium {
    /// * `coefficients`: of the density 1
    /// * `bounds`: the world-space box that the voxels fill; `None` is answered for one that is flat or infinite
    pub fn new(coefficients: Coefficients, grid: DensityGrid, bounds: Aabb) -> Option<GridMedium> {
        if !bounds.is_finite() || bounds.extent().min_element() <= 0.0 {
            return None;
        }
        let majorants = grid.majorants(bounds);
        Some(GridMedium { coefficients, grid, majorants, inverse_extent: bounds.extent().recip() })
    }
}

impl Medium for GridMedium {
    fn is_finite(&self) -> bool {
        self.inverse_extent.is_finite()
    }

    #[inline]
    fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    fn density(&self, _textures: &Textures, p: Vec3) -> f32 {
        self.grid.at((p - self.majorants.bounds().min) * self.inverse_extent)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(*self.majorants.bounds())
    }

    fn majorants(&self, ray: &Ray) -> Majorants<'_> {
        Majorants::cells(self.majorants.walk(ray))
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, rng::Stream, warp};

    use super::*;
    use crate::medium::Phase;

    fn random(size: [u32; 3]) -> Vec<f32> {
        let numbers = Stream::new(5, size[..2].try_into().unwrap(), size[2]);
        (0..size.iter().product()).map(|k| numbers.uniform(k).powi(3)).collect()
    }

    #[test]
    fn values_hold_in_the_middles_of_voxels() {
        let grid = DensityGrid::new([2, 3, 1], vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        let at = |x: f32, y: f32| grid.at(Vec3::new(x, y, 0.7));
        assert_eq!([at(0.25, 1.0 / 6.0), at(0.75, 0.5), at(0.0, 1.0)], [1.0, 4.0, 5.0]);
        assert!((at(0.5, 0.5) - 3.5).abs() < 1e-6);
    }

    #[test]
    fn all_densities_are_between_their_bounds() {
        for size in [[7, 1, 5], [33, 20, 9], [300, 2, 3]] {
            let grid = DensityGrid::new(size, random(size)).unwrap();
            let bounds = Aabb { min: Vec3::new(-2.0, 1.0, 0.0), max: Vec3::new(1.0, 2.0, 5.0) };
            let coefficients = Coefficients::new([0.0; 3], [1.0; 3], Phase::Isotropic).unwrap();
            let medium = GridMedium::new(coefficients, grid, bounds).unwrap();
            for i in 0..2000 {
                let number = Stream::new(8, [i, 1], 0);
                let u = |k| number.uniform(k);
                let d = warp::uniform_sphere(Vec2::new(u(0), u(1)));
                let middle = bounds.min + Vec3::new(u(2), u(3), u(4)) * bounds.extent();
                let ray = Ray::new(middle - 8.0 * d, d);
                for m in medium.majorants(&ray) {
                    for k in 0..8 {
                        let t = m.t_min + (k as f32 + 0.5) / 8.0 * (m.t_max - m.t_min);
                        let density = medium.density(&Textures::default(), ray.at(t));
                        assert!(density <= m.density * 1.0001 + 1e-5, "{size:?} {t}: {density} {m:?}");
                        assert!(density >= m.least * 0.9999 - 1e-5, "{size:?} {t}: {density} {m:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        let of = |size, values| DensityGrid::new(size, values).err();
        assert_eq!(of([0, 4, 4], vec![]), Some(GridError::Empty));
        assert_eq!(of([2, 1, 1], vec![1.0]), Some(GridError::Count { voxels: 2, values: 1 }));
        let huge = of([u32::MAX; 3], vec![1.0]);
        assert!(matches!(huge, Some(GridError::Count { voxels: u64::MAX, values: 1 })), "{huge:?}");
        assert_eq!(of([2, 1, 1], vec![1.0, -1.0]), Some(GridError::Value { index: 1, value: -1.0 }));
        assert!(of([1, 1, 1], vec![f32::NAN]).is_some() && of([1, 1, 1], vec![f32::INFINITY]).is_some());
    }
}
