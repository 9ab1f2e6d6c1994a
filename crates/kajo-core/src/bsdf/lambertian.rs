//! The Lambertian part of what a surface does with light: the only part whose radiance is known once the irradiance is.
//!
//! ```text
//! f(wo, wi) = R/π + rest,        L(wo) = R/π E + integral of rest |cos| Li
//! ```
//!
//! Rough diffusion and what lies under a coat depend on both directions, and have no such part.

use kajo_color::Spectrum;
use kajo_math::Vec3;

use super::{Bsdf, Transport};

impl Bsdf<'_> {
    /// `R`: the share of light that is reflected evenly, in [0, 1]; `None` where that is nothing.
    #[inline]
    pub fn lambertian_reflectance(&self) -> Option<Spectrum> {
        let reflectance = match self {
            Bsdf::Lambert(lobe) => lobe.reflectance,
            Bsdf::BumpedDiffuse(lobe) => lobe.lambertian_reflectance(),
            Bsdf::Phong(lobes) => lobes.diffuse(),
            _ => Spectrum::BLACK,
        };
        (!reflectance.is_black()).then_some(reflectance)
    }

    /// Whether it scatters no light but by its Lambertian part.
    #[inline]
    pub fn is_lambertian(&self) -> bool {
        match self {
            Bsdf::Lambert(lobe) => lobe.transmittance.is_black(),
            Bsdf::Phong(lobes) => lobes.is_even(),
            _ => false,
        }
    }

    /// The share of [`Bsdf::eval`] that does not belong to the Lambertian part, by lane in [0, 1].
    ///
    /// * `wo`, `wi`: as for `eval`, of the radiance that a path from the camera gathers
    pub fn beside_lambertian(&self, wo: Vec3, wi: Vec3) -> Spectrum {
        if self.is_lambertian() {
            return Spectrum::BLACK;
        }
        let evenly = match self {
            Bsdf::Lambert(lobe) => lobe.without_transmission().eval(wo, wi),
            Bsdf::BumpedDiffuse(lobe) => match lobe.without_transmission() {
                Some(lobe) => lobe.eval(wo, wi, Transport::Radiance),
                None => return Spectrum::WHITE,
            },
            Bsdf::Phong(lobes) => lobes.without_gloss().eval(wo, wi, Transport::Radiance),
            _ => return Spectrum::WHITE,
        };
        let all = self.eval(wo, wi, Transport::Radiance);
        (all - evenly).safe_div(all).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Lambert, OrenNayar, Phong, PhongLobes};

    fn glossy() -> Bsdf<'static> {
        let phong = Phong {
            diffuse: Spectrum::rgb(0.4, 0.2, 0.0),
            specular: Spectrum::rgb(0.3, 0.3, 0.3),
            exponent: 5.0,
            ..Phong::BLACK
        };
        Bsdf::Phong(PhongLobes::from(&phong))
    }

    /// `eval = R |cos|/pi + share eval` above the surface, and all of it is the rest below.
    #[test]
    fn the_parts_add_up() {
        let leaf = Bsdf::Lambert(Lambert {
            reflectance: Spectrum::rgb(0.5, 0.3, 0.1),
            transmittance: Spectrum::rgb(0.2, 0.4, 0.1),
        });
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let matt = Bsdf::Lambert(Lambert::new(Spectrum::rgb(0.5, 0.0, 0.2)));
        for (bsdf, is_lambertian) in [(leaf, false), (glossy(), false), (matt, true)] {
            assert_eq!(bsdf.is_lambertian(), is_lambertian);
            let reflectance = bsdf.lambertian_reflectance().unwrap();
            for wi in [Vec3::new(0.0, 0.6, 0.8), Vec3::new(-0.6, 0.0, 0.8), Vec3::new(0.48, 0.36, -0.8)] {
                let all = bsdf.eval(wo, wi, Transport::Radiance);
                let evenly = reflectance * (wi.z.max(0.0) * std::f32::consts::FRAC_1_PI);
                let rest = all * bsdf.beside_lambertian(wo, wi);
                let sum = (evenly + rest - all).to_rgb();
                assert!(sum.into_iter().all(|v| v.abs() < 1e-6), "{bsdf:?} {wi}: {sum:?}");
            }
        }
    }

    #[test]
    fn what_is_even_has_no_rest_and_what_is_not_has_nothing_else() {
        let [wo, wi] = [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)];
        let matt = Bsdf::Lambert(Lambert::new(Spectrum::rgb(0.5, 0.4, 0.3)));
        assert!(matt.beside_lambertian(wo, wi).is_black());
        let classic = Phong { diffuse: Spectrum::rgb(0.4, 0.2, 0.0), ..Phong::BLACK };
        let classic = Bsdf::Phong(PhongLobes::from(&classic));
        assert!(classic.is_lambertian() && classic.lambertian_reflectance().is_some());
        assert!(classic.beside_lambertian(wo, wi).is_black());
        // Single directions are another part, though none of what is seen in others.
        let diffuse = Spectrum::rgb(0.4, 0.2, 0.0);
        let lacquer = Phong { diffuse, reflective: Spectrum::rgb(0.1, 0.1, 0.1), ..Phong::BLACK };
        let gauze = Phong { diffuse, transparent: Spectrum::rgb(0.1, 0.1, 0.1), ..Phong::BLACK };
        for classic in [lacquer, gauze].map(|phong| Bsdf::Phong(PhongLobes::from(&phong))) {
            assert!(!classic.is_lambertian() && classic.lambertian_reflectance().is_some());
            assert!(classic.beside_lambertian(wo, wi).is_black());
        }
        let clay = Bsdf::OrenNayar(OrenNayar { reflectance: Spectrum::rgb(0.5, 0.4, 0.3), roughness: 0.5 });
        for bsdf in [clay, Bsdf::Null] {
            assert_eq!(bsdf.lambertian_reflectance(), None);
            assert_eq!(bsdf.beside_lambertian(wo, wi), Spectrum::WHITE);
        }
    }
}
