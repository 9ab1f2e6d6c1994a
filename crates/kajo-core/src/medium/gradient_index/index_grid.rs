//! An index of refraction through numbers on a grid, as measured or computed: air over a landscape, a lens that was printed.

use std::fmt;

use kajo_math::spline_grid::SplineGrid;
use kajo_math::{DVec3, Vec3};

/// An index by numbers on points that are evenly spread over a box, the outermost ones on its faces. Beyond the box it stays what
/// it is on the face.
#[derive(Clone, Debug)]
pub struct IndexGrid {
    spline: SplineGrid,
    min: DVec3,
    /// Steps between points per length, along each axis.
    per_length: DVec3,
}

/// Why numbers are no index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IndexGridError {
    /// Their count is not that of the points.
    Count {
        /// Points along each axis.
        size: [u32; 3],
        /// How many numbers there are.
        values: usize,
    },
    /// An index is above 0.
    Index {
        /// Which point.
        point: [u32; 3],
        /// What is there.
        index: f32,
    },
    /// The box has no inside.
    EmptyBox,
}

impl fmt::Display for IndexGridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            IndexGridError::Count { size: [x, y, z], values } => {
                write!(f, "{x} x {y} x {z} points need as many numbers, and there are {values}")
            }
            IndexGridError::Index { point: [x, y, z], index } => {
                write!(
                    f,
                    "an index of refraction is above 0, and at the point {x} {y} {z} of the grid it is {index}"
                )
            }
            IndexGridError::EmptyBox => {
                write!(f, "every coordinate of `min` must be less than that of `max`")
            }
        }
    }
}

impl IndexGrid {
    /// The smooth function through indices.
    ///
    /// * `values`: x first, then y
    /// * `bounds`: two corners of the box
    ///
    /// # Errors
    ///
    /// Numbers that are too many, too few, not finite or not above 0, and a box without inside.
    pub fn new(size: [u32; 3], values: &[f32], [min, max]: [Vec3; 2]) -> Result<IndexGrid, IndexGridError> {
        let count = size.iter().try_fold(1_usize, |count, &n| count.checked_mul(n as usize));
        if count != Some(values.len()) || values.is_empty() {
            return Err(IndexGridError::Count { size, values: values.len() });
        }
        if let Some(i) = values.iter().position(|&index| !(index > 0.0 && index.is_finite())) {
            let [nx, ny, _] = size.map(|n| n as usize);
            let point = [i % nx, i / nx % ny, i / (nx * ny)].map(|n| n as u32);
            return Err(IndexGridError::Index { point, index: values[i] });
        }
        let [min, max] = [min, max].map(Vec3::as_dvec3);
        if !(max - min).cmpgt(DVec3::ZERO).all() || !(max - min).is_finite() {
            return Err(IndexGridError::EmptyBox);
        }
        let steps = DVec3::from(size.map(|n| f64::from(n - 1)));
        Ok(IndexGrid { spline: SplineGrid::new(size, values), min, per_length: steps / (max - min) })
    }

    /// The index at a world-space place and its gradient.
    pub fn index(&self, p: DVec3) -> (f64, DVec3) {
        let (n, slope) = self.spline.at((p - self.min) * self.per_length);
        (n, slope * self.per_length)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.min.is_finite() && self.per_length.is_finite()
    }
}
