//! A medium that is the same everywhere: milk, haze, coloured glass.
//!
//! Light is weakened by `T = exp(-sigma_t d)`, and free paths have the density `sigma_t exp(-sigma_t t)`.
//!
//! Scene: `Media { Medium milk { albedo 0.99  meanFreePath 0.05 } }`

use kajo_math::{Aabb, Ray, Vec3};

use super::{Coefficients, Majorant, Majorants, Medium};
use crate::texture::Textures;

/// A medium of the density 1 everywhere.
#[derive(Clone, Debug)]
pub struct HomogeneousMedium {
    /// What it does to light.
    pub coefficients: Coefficients,
}

impl Medium for HomogeneousMedium {
    fn is_finite(&self) -> bool {
        true
    }

    #[inline]
    fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    #[inline]
    fn density(&self, _textures: &Textures, _p: Vec3) -> f32 {
        1.0
    }

    #[inline]
    fn bounds(&self) -> Option<Aabb> {
        None
    }

    fn majorants(&self, ray: &Ray) -> Majorants<'_> {
        Majorants::one(Majorant { t_min: 0.0, t_max: ray.t_max, density: 1.0, least: 1.0 })
    }

    #[inline]
    fn is_homogeneous(&self) -> bool {
        true
    }
}
