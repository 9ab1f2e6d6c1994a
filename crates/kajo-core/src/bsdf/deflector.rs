//! A plane that turns light by an angle that depends on the place and not on the direction: a weak gravitational lens.
//!
//! The part of the direction in the plane is shifted, `p' = p + α`, for light from either side. In the phase space of places and these
//! parts of directions that is a shear, so that the étendue `dA dω |cos θ|` of light is what it was, and so is radiance.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::{BsdfSample, ScatterKind};

/// Light passes and is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deflector {
    /// What is added to the part of the direction of light in the plane; local.
    pub shift: Vec2,
}

impl Deflector {
    /// None for light that would not leave the plane.
    pub(super) fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        let p = self.shift - wo.truncate();
        let cos2 = 1.0 - p.length_squared();
        let wi = p.extend(-cos2.max(0.0).sqrt().copysign(wo.z));
        if cos2 > 0.0 { BsdfSample::new(wi, Spectrum::WHITE, 1.0, ScatterKind::DEFLECTED) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, Transport, tests::list::directions};

    fn through(shift: Vec2, wo: Vec3) -> Option<Vec3> {
        let bsdf = Bsdf::Deflector(Deflector { shift });
        bsdf.sample(wo, Vec2::ZERO, 0.0, Transport::Radiance).map(|sample| sample.wi)
    }

    #[test]
    fn light_comes_back_as_it_went() {
        let shift = Vec2::new(0.02, -0.03);
        for wo in directions(9).filter(|wo| wo.z.abs() > 0.3) {
            let wi = through(shift, wo).expect("it passes");
            assert!(wi.z * wo.z < 0.0 && (wi.length() - 1.0).abs() < 1e-6, "{wo} {wi}");
            assert!((wi.truncate() + wo.truncate() - shift).length() < 1e-6);
            let back = through(shift, wi).expect("it passes");
            assert!((back - wo).length() < 1e-5, "{wo} {back}");
        }
    }

    #[test]
    fn light_along_the_plane_is_lost() {
        assert_eq!(through(Vec2::new(-0.5, 0.0), Vec3::new(0.8, 0.0, 0.6)), None);
        assert_eq!(through(Vec2::new(f32::NAN, 0.0), Vec3::Z), None);
    }
}
