//! From the indices of voxels to the world.

use super::input::Input;
use crate::volume::VolumeError;

/// An affine map of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridMap {
    /// What the unit vectors of the three axes become.
    pub axes: [[f64; 3]; 3],
    /// What the origin becomes.
    pub origin: [f64; 3],
}

impl GridMap {
    fn scaled(scale: [f64; 3], origin: [f64; 3]) -> GridMap {
        let [x, y, z] = scale;
        GridMap { axes: [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], origin }
    }

    /// What a point becomes.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.origin[k] + (0..3).map(|axis| p[axis] * self.axes[axis][k]).sum::<f64>())
    }

    /// Refuses what cannot be worked with.
    pub(crate) fn check(&self) -> Result<(), VolumeError> {
        let mut numbers = self.axes.as_flattened().iter().chain(&self.origin);
        match numbers.all(|x| x.is_finite() && x.abs() < 1e30) {
            true => Ok(()),
            false => Err(VolumeError::Content("the places of its voxels are no numbers".to_owned())),
        }
    }

    /// The same map of points that are counted from the lower corner of a voxel.
    ///
    /// * `low`: the indices of this voxel, which are those of its middle
    pub(crate) fn counted_from(self, low: [i32; 3]) -> GridMap {
        GridMap { origin: self.point(low.map(|x| f64::from(x) - 0.5)), ..self }
    }
}

/// The map of a grid.
pub fn read(input: &mut Input) -> Result<GridMap, VolumeError> {
    let kind = input.text()?;
    let mut vector = || -> Result<[f64; 3], VolumeError> { Ok([input.f64()?, input.f64()?, input.f64()?]) };
    let map = match &*kind {
        // The scale, then the size of a voxel, and reciprocals.
        "UniformScaleMap" | "ScaleMap" => {
            let scale = vector()?;
            (0..4).try_for_each(|_| vector().map(drop))?;
            GridMap::scaled(scale, [0.0; 3])
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let [origin, scale] = [vector()?, vector()?];
            (0..4).try_for_each(|_| vector().map(drop))?;
            GridMap::scaled(scale, origin)
        }
        "TranslationMap" => GridMap::scaled([1.0; 3], vector()?),
        // Rows of four, for vectors that stand on the left.
        "AffineMap" | "UnitaryMap" => {
            let mut rows = [[0.0; 4]; 4];
            for row in &mut rows {
                for number in row {
                    *number = input.f64()?;
                }
            }
            let [x, y, z, origin] = rows.map(|[x, y, z, _]| [x, y, z]);
            GridMap { axes: [x, y, z], origin }
        }
        _ => {
            return Err(VolumeError::Content(format!(
                "its voxels are placed by a {kind}, which is not read"
            )));
        }
    };
    map.check()?;
    Ok(map)
}
