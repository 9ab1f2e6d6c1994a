//! The broad part of what a surface does with light, and narrow lobes beside it.
//!
//! ```text
//! f(wo, wi) = f_broad + f_narrow
//! ```
//!
//! What is broad is estimated well from light of few directions, as photons bring it. Of highlights photons show a few dots, and
//! directions that are drawn by the lobe show all.

use kajo_color::Spectrum;
use kajo_math::Vec3;

use super::{Bsdf, Transport, same_side};

/// The least roughness `α` of lobes that are broad: about that of Phong's exponent 10.
pub(super) const LEAST_BROAD_ALPHA: f32 = 0.4;

/// The largest of Phong's exponents of lobes that are broad.
pub(super) const LARGEST_BROAD_EXPONENT: f32 = 10.0;

impl Bsdf<'_> {
    /// Whether it scatters some light about evenly.
    pub fn has_broad_part(&self) -> bool {
        match self {
            Bsdf::Lambert(_) | Bsdf::OrenNayar(_) | Bsdf::BumpedDiffuse(_) | Bsdf::Subsurface(_) => true,
            Bsdf::Phong(lobes) => lobes.has_diffuse(),
            Bsdf::Principled(layers) => layers.has_diffuse(),
            _ => false,
        }
    }

    /// Whether it has narrow lobes beside a broad part. Single directions are none.
    pub fn has_narrow_lobes(&self) -> bool {
        match self {
            Bsdf::Phong(lobes) => lobes.has_diffuse() && lobes.is_narrow(),
            Bsdf::Principled(layers) => layers.has_diffuse() && layers.has_narrow_lobes(),
            Bsdf::Subsurface(body) => body.reflecting().has_narrow_lobes(),
            _ => false,
        }
    }

    /// The part of [`Bsdf::eval`] that is no narrow lobe beside a broad part: all of it where there are no such lobes.
    ///
    /// * `wo`, `wi`: as for `eval`, of the radiance that a path from the camera gathers
    pub fn broad_part(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let mode = Transport::Radiance;
        match self {
            Bsdf::Phong(lobes) if self.has_narrow_lobes() => lobes.without_gloss().eval(wo, wi, mode),
            Bsdf::Principled(layers) if layers.has_diffuse() => layers.broad_value(wo, wi, mode),
            Bsdf::Subsurface(body) if same_side(wo, wi) && wo.z > 0.0 => {
                body.reflecting().broad_value(wo, wi, mode)
            }
            _ => self.eval(wo, wi, mode),
        }
    }

    /// The share of [`Bsdf::eval`] that is not its broad part, by lane in [0, 1].
    ///
    /// * `wo`, `wi`: as for [`Bsdf::broad_part`]
    pub fn narrow_share(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        let all = self.eval(wo, wi, Transport::Radiance);
        (all - self.broad_part(wo, wi)).safe_div(all).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, warp};

    use super::*;
    use crate::bsdf::{Base, Phong, PhongLobes, Principled, Subsurface};

    fn phong(exponent: f32) -> Bsdf<'static> {
        let color = Spectrum::rgb(0.4, 0.2, 0.0);
        let phong = Phong { diffuse: color, specular: Spectrum::grey(0.3), exponent, ..Phong::BLACK };
        Bsdf::Phong(PhongLobes::from(&phong))
    }

    fn layers(alpha: f32, coat: f32, coat_alpha: f32) -> Principled {
        Principled { alpha: Vec2::splat(alpha), coat, coat_alpha, ..Principled::default() }
    }

    fn directions(n: u32) -> impl Iterator<Item = Vec3> {
        (0..n).map(move |i| {
            let u = Vec2::new((i as f32 + 0.5) / n as f32, (i as f32 * 0.618).fract());
            warp::cosine_hemisphere(u)
        })
    }

    #[test]
    fn narrow_is_what_is_sharp_beside_a_diffuse_part() {
        let matt = Principled { base: Base::Metal, ..layers(0.1, 0.0, 0.0) };
        for (bsdf, is_broad, is_narrow) in [
            (phong(50.0), true, true),
            (phong(5.0), true, false),
            (Bsdf::Principled(layers(0.1, 0.0, 0.0)), true, true),
            (Bsdf::Principled(layers(0.5, 0.0, 0.0)), true, false),
            (Bsdf::Principled(layers(0.5, 0.7, 0.1)), true, true),
            (Bsdf::Principled(matt), false, false),
            (Bsdf::Subsurface(Subsurface::below(&layers(0.1, 0.0, 0.0), 0.5, false)), true, true),
        ] {
            assert_eq!([bsdf.has_broad_part(), bsdf.has_narrow_lobes()], [is_broad, is_narrow], "{bsdf:?}");
        }
    }

    /// Nothing is narrow far from the mirror direction, and nearly all in it.
    #[test]
    fn shares_are_those_of_lobes() {
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let mirror = Vec3::new(-0.6, 0.0, 0.8);
        let sharp = layers(0.05, 0.0, 0.0);
        let coated = layers(0.5, 1.0, 0.05);
        let body = Bsdf::Subsurface(Subsurface::below(&sharp, 0.5, false));
        for bsdf in [phong(500.0), Bsdf::Principled(sharp), Bsdf::Principled(coated), body] {
            assert!(bsdf.narrow_share(wo, mirror).to_rgb().into_iter().all(|v| v > 0.8), "{bsdf:?}");
            assert!(bsdf.narrow_share(wo, Vec3::new(0.6, 0.0, 0.8)).max_lane() < 0.05, "{bsdf:?}");
            assert!(bsdf.narrow_share(wo, -mirror).is_black());
            for wi in directions(200) {
                let share = bsdf.narrow_share(wo, wi);
                assert!(share.to_rgb().into_iter().all(|v| (0.0..=1.0).contains(&v)), "{share:?}");
            }
        }
        // What is broad is all but the lobe: that of a surface without one, darkened by what its lobe reflects.
        let base = Principled { specular: crate::bsdf::Specular::Factor(Spectrum::BLACK), ..sharp };
        for wi in directions(50) {
            let broad = sharp.broad_value(wo, wi, Transport::Radiance);
            let off = broad - base.eval(wo, wi, Transport::Radiance);
            assert!(off.map(f32::abs).max_lane() < 1e-6, "{off:?}");
        }
    }
}
