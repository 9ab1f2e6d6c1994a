//! The plane of a weak gravitational lens: galaxies and stars that turn the light of what is far behind them.
//!
//! All light passes, turned by the deflection at the place where it crosses the plane [Schneider et al. 1992, section 2.1]. Several lenses one
//! behind the other are several surfaces.
//!
//! Scene: `GravitationalLens galaxy { dispersion 0.05  axisRatio 0.7 }`

use kajo_math::gravity::ThinLens;
use kajo_math::{DVec2, Frame, Vec3};

use super::{Appearance, Material, ShadingPoint};
use crate::bsdf::{Bsdf, Deflector, Phong};
use crate::texture::{AnyTexture, TextureContext};

/// A lens in the plane of a flat surface.
#[derive(Clone, Debug)]
pub struct GravitationalLens {
    /// Its middle, in world space.
    pub center: Vec3,
    /// Along the longer axis of its ellipse, where that is seen in the plane; not zero.
    pub axis: Vec3,
    /// What it does to light.
    pub lens: ThinLens,
}

impl GravitationalLens {
    /// What is added to the direction of light at a world-space point of a plane with the unit normal `n`.
    fn deflection(&self, p: Vec3, n: Vec3) -> Vec3 {
        let n = n.as_dvec3();
        let from = p.as_dvec3() - self.center.as_dvec3();
        // Seen along the axis the ellipse may lie in any way.
        let along = self.axis.as_dvec3().reject_from_normalized(n).normalize_or(n.any_orthonormal_vector());
        let across = n.cross(along);
        let DVec2 { x, y } = self.lens.deflection(DVec2::new(from.dot(along), from.dot(across)));
        (x * along + y * across).as_vec3()
    }
}

impl Material for GravitationalLens {
    fn is_finite(&self) -> bool {
        self.center.is_finite() && self.axis.is_finite() && self.lens.is_finite()
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        Vec::new()
    }

    fn phong(&self, _appearance: &Appearance, _at: &TextureContext) -> Phong {
        Phong::CLEAR
    }

    fn constant(&self) -> Option<&Phong> {
        Some(&Phong::CLEAR)
    }

    fn may_transmit(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn is_thin_lens(&self) -> bool {
        true
    }

    fn bsdf<'a>(&'a self, _appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let n = at.context.n;
        let shift = Frame::from_normal(n).to_local(self.deflection(at.context.p, n));
        Bsdf::Deflector(Deflector { shift: shift.truncate() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(axis_ratio: f64) -> GravitationalLens {
        let lens = ThinLens::new([0.01, 0.1], axis_ratio, 0.05);
        GravitationalLens { center: Vec3::new(1.0, 2.0, 3.0), axis: Vec3::new(1.0, 1.0, 0.4), lens }
    }

    /// A turned scene is turned, and both sides of the plane are one.
    #[test]
    fn the_ellipse_lies_in_the_plane() {
        let galaxy = lens(0.5);
        let at = |x: f32, y: f32| {
            let d = std::f32::consts::FRAC_1_SQRT_2;
            galaxy.center + x * Vec3::new(d, d, 0.0) + y * Vec3::new(-d, d, 0.0)
        };
        for (x, y) in [(0.3, 0.1), (-1.0, 0.4), (0.02, -2.0)] {
            let found = galaxy.deflection(at(x, y), Vec3::Z);
            let expected = galaxy.lens.deflection(DVec2::new(x.into(), y.into())).as_vec2();
            let expected = at(expected.x, expected.y) - galaxy.center;
            assert!((found - expected).length() < 1e-6, "{x} {y}: {found} {expected}");
            assert!((galaxy.deflection(at(x, y), Vec3::NEG_Z) - found).length() < 1e-6);
        }
        assert_eq!(galaxy.deflection(galaxy.center, Vec3::Z), Vec3::ZERO);
    }
}
