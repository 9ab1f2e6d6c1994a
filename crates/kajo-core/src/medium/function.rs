//! A medium whose density is a function of the place: layers of haze, a cloud of noise, a ball that thins outwards.
//!
//! The function is typed in the scene. Bounds on it come from interval arithmetic over the cells of its box before anything is
//! rendered, so that no part of it is missed. Where it is negative there is nothing.
//!
//! Scene: `Media { FunctionMedium layer { function = exp(-2 * y)  min -5 0 -5  max 5 4 5  density 1 } }`

use std::cell::RefCell;
use std::sync::Arc;

use kajo_math::interval::Interval;
use kajo_math::tape::Tape;
use kajo_math::{Aabb, Ray, Vec3};

use super::{Coefficients, MajorantGrid, Majorants, Medium};
use crate::texture::Textures;

/// Cells along each axis of the box.
const CELLS: u32 = 24;

thread_local! {
    /// Results of operations, kept from point to point.
    static SLOTS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// A medium by a function of the world-space point.
#[derive(Clone, Debug)]
pub struct FunctionMedium {
    coefficients: Coefficients,
    function: Arc<Tape>,
    majorants: MajorantGrid,
}

/// Why there is no such medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FunctionMediumError {
    /// A box that is none.
    #[error("every coordinate of `min` must be less than that of `max`")]
    Flat,
    /// The density has no bound.
    #[error("the function has no bound in the box from `min` to `max`")]
    Unbounded,
}

impl FunctionMedium {
    /// * `coefficients`: of the density 1
    /// * `bounds`: the world-space box outside of which there is nothing
    ///
    /// # Errors
    /// [`FunctionMediumError`].
    pub fn new(
        coefficients: Coefficients,
        function: Arc<Tape>,
        bounds: Aabb,
    ) -> Result<FunctionMedium, FunctionMediumError> {
        if !bounds.is_finite() || bounds.extent().min_element() <= 0.0 {
            return Err(FunctionMediumError::Flat);
        }
        let mut slots = Vec::new();
        let low = bounds.min.as_dvec3();
        let step = bounds.extent().as_dvec3() / f64::from(CELLS);
        let majorants = MajorantGrid::new(bounds, [CELLS; 3], |cell| {
            let range = |axis: usize| {
                // A little more than the cell, for points that rounding puts beside it.
                let at = |k: f64| low[axis] + k * step[axis];
                let k = f64::from(cell[axis]);
                Interval::new(at(k - 1e-3), at(k + 1.0 + 1e-3))
            };
            let Interval { lo, hi, .. } = function.at(&[range(0), range(1), range(2)], &mut slots);
            // Rounded up; where the function has no value the density is 0.
            let highest = if hi.is_nan() { f32::INFINITY } else { (hi.max(0.0) as f32).next_up() };
            [if lo > 0.0 { lo as f32 } else { 0.0 }, highest]
        });
        if !majorants.largest().is_finite() {
            return Err(FunctionMediumError::Unbounded);
        }
        Ok(FunctionMedium { coefficients, function, majorants })
    }
}

impl Medium for FunctionMedium {
    fn is_finite(&self) -> bool {
        true
    }

    #[inline]
    fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    fn density(&self, _textures: &Textures, p: Vec3) -> f32 {
        let place = p.as_dvec3().to_array();
        let value = SLOTS.with_borrow_mut(|slots| self.function.at(&place, slots));
        // Where the function has no value there is nothing.
        if value > 0.0 { value as f32 } else { 0.0 }
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(*self.majorants.bounds())
    }

    fn majorants(&self, ray: &Ray) -> Majorants<'_> {
        Majorants::cells(self.majorants.walk(ray))
    }
}
