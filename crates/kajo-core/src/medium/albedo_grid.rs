//! A medium whose colour differs from place to place: the share of light that a collision scatters, voxel by voxel.
//!
//! The extinction stays what it is, so that bounds on it do:
//!
//! ```text
//! sigma_s(x) = sigma_s d(x) c(x),    sigma_a(x) = sigma_a d(x) + sigma_s d(x) (1 - c(x))
//! ```
//!
//! with the density `d` and colours `c` from 0 to 1, interpolated between voxels. Those that are black have no effect: files are
//! black where there is nothing, and what has an edge would have a dark one.
//!
//! Scene: `Media { GridMedium smoke { file smoke.vdb  density 8  albedoGrid Cd } }`

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::Vec3;

use super::PlacedVoxels;
use crate::texture::rgb_reflectance;

/// A colour that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("voxel ({}, {}, {}) of the colours is {} {} {}: each is from 0 to 1", voxel[0], voxel[1], voxel[2], color[0], color[1], color[2])]
pub struct AlbedoGridError {
    /// Its place, from the corner of the box of the grid.
    pub voxel: [u32; 3],
    /// What it is.
    pub color: [f32; 3],
}

/// Colours by place.
#[derive(Clone, Debug)]
pub struct AlbedoGrid {
    grid: PlacedVoxels<[f32; 3]>,
}

impl AlbedoGrid {
    /// * `grid`: linear red, green and blue
    ///
    /// # Errors
    /// [`AlbedoGridError`] for one that is not from 0 to 1.
    pub fn new(grid: PlacedVoxels<[f32; 3]>) -> Result<AlbedoGrid, AlbedoGridError> {
        match grid.find(|color: [f32; 3]| !color.iter().all(|share| (0.0..=1.0).contains(share))) {
            Some((voxel, color)) => Err(AlbedoGridError { voxel, color }),
            None => Ok(AlbedoGrid { grid }),
        }
    }

    /// What the albedo is multiplied by at a world-space point: 1 where no voxel has an effect.
    pub fn at(&self, p: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        rgb_reflectance(self.rgb(p).to_array(), wavelengths)
    }

    fn rgb(&self, p: Vec3) -> Vec3 {
        let mut known = 0.0;
        let mut sum = Vec3::ZERO;
        self.grid.around(p, |color: [f32; 3], weight| {
            if color != [0.0; 3] {
                known += weight;
                sum += weight * Vec3::from(color);
            }
        });
        if known > 0.0 { (sum / known).clamp(Vec3::ZERO, Vec3::ONE) } else { Vec3::ONE }
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::DAffine3;
    use kajo_scene::{Assets, Limits, MemoryAssets, VoxelGrid, read_vdb};
    use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

    use super::*;

    fn colors(voxels: &[([i32; 3], [f32; 3])]) -> Result<AlbedoGrid, AlbedoGridError> {
        let mut grid = VdbGrid::new("Cd", VdbKind::Vec3, VdbMap::Uniform(1.0));
        for &(place, color) in voxels {
            grid.set(place, color);
        }
        let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids: vec![grid] };
        let assets = MemoryAssets::new().with("v", file.to_bytes());
        let read: VoxelGrid<[f32; 3]> =
            read_vdb(assets.open("v", "").unwrap(), 0, &Limits::default()).unwrap();
        AlbedoGrid::new(PlacedVoxels::new(read.voxels, &DAffine3::IDENTITY).unwrap())
    }

    /// Between two voxels it is linear, and beside one that is black it is what the other one says.
    #[test]
    fn colours_are_interpolated_between_those_that_are_there() {
        let grid =
            colors(&[([0, 0, 0], [1.0, 0.5, 0.0]), ([1, 0, 0], [0.0, 0.5, 1.0]), ([3, 0, 0], [0.2; 3])]);
        let grid = grid.unwrap();
        for (x, expected) in [
            (0.5, [1.0, 0.5, 0.0]),
            (0.75, [0.75, 0.5, 0.25]),
            (1.25, [0.25, 0.5, 0.75]),
            (1.9, [0.0, 0.5, 1.0]),
            (2.5, [1.0; 3]),
            (2.6, [0.2; 3]),
            (-7.0, [1.0, 0.5, 0.0]),
        ] {
            let found = grid.at(Vec3::new(x, 0.5, 0.5), &Wavelengths::RGB).to_rgb();
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-6), "{x}: {found:?}");
        }
    }

    #[test]
    fn what_is_no_share_is_refused() {
        for wrong in [-0.1, 1.5, f32::NAN, f32::INFINITY] {
            let made = colors(&[([0, 0, 0], [0.5; 3]), ([2, 0, 0], [0.5, wrong, 0.5])]);
            let Err(AlbedoGridError { voxel, .. }) = made else { panic!("{wrong}: {made:?}") };
            assert_eq!(voxel, [2, 0, 0]);
        }
    }
}
