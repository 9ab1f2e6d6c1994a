//! Scattering by a surface that leans from place to place, in more ways than can be seen.
//!
//! Slopes of the variance `σ²` along an axis and the facets of a surface itself have slopes of the sum of both variances. A roughness
//! `α` stands for `α²/2`, so
//!
//! ```text
//! α' = √(α² + 2 σ²)
//! ```
//!
//! which is exact where all slopes are Gaussian [Olano and Baker 2010]. About a mirrored direction, as Phong's highlight lies, angles are
//! twice as large: `1/n' = 1/n + 4 σ²`. Diffuse light is about the same from leaning facets, and left as it is.

use kajo_math::Vec2;

use super::{Bsdf, Conductor, Dielectric, Microfacets, Principled, Subsurface};

/// A roughness, wider by a variance of slopes.
fn wide(alpha: f32, variance: f32) -> f32 {
    (alpha * alpha + 2.0 * variance).sqrt().min(1.0)
}

impl Microfacets {
    fn widened(self, slopes: Vec2) -> Microfacets {
        let (alpha_x, alpha_y) = (wide(self.alpha_x, slopes.x), wide(self.alpha_y, slopes.y));
        Microfacets { shape: self.shape, alpha_x, alpha_y }
    }
}

impl Bsdf<'_> {
    /// The same of a surface that leans by such slopes from place to place; of panes and of what is measured it stays what it is.
    ///
    /// * `slopes`: variances along the x and the y axis of the shading frame
    #[must_use]
    pub fn widened(self, slopes: Vec2) -> Self {
        let mean = 0.5 * (slopes.x + slopes.y);
        let both = |alpha: Vec2| Vec2::new(wide(alpha.x, slopes.x), wide(alpha.y, slopes.y));
        match self {
            Bsdf::Conductor(metal) => {
                Bsdf::Conductor(Conductor { microfacets: metal.microfacets.widened(slopes), ..metal })
            }
            Bsdf::Dielectric(glass) => {
                Bsdf::Dielectric(Dielectric { microfacets: glass.microfacets.widened(slopes), ..glass })
            }
            Bsdf::Principled(layers) => Bsdf::Principled(Principled {
                alpha: both(layers.alpha),
                coat_alpha: wide(layers.coat_alpha, mean),
                ..layers
            }),
            Bsdf::Subsurface(layers) => Bsdf::Subsurface(Subsurface {
                alpha: both(layers.alpha),
                coat_alpha: wide(layers.coat_alpha, mean),
                ..layers
            }),
            Bsdf::Phong(lobes) => {
                Bsdf::Phong(lobes.widened(|exponent| 1.0 / (1.0 / exponent.max(1e-6) + 4.0 * mean)))
            }
            Bsdf::Lambert(_)
            | Bsdf::OrenNayar(_)
            | Bsdf::BumpedDiffuse(_)
            | Bsdf::ThinDielectric(_)
            | Bsdf::Btf(_)
            | Bsdf::Measured(_)
            | Bsdf::Deflector(_)
            | Bsdf::Null => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{MetalFresnel, Phong, PhongLobes, microfacet::NormalDistribution};
    use kajo_color::Spectrum;

    #[test]
    fn variances_of_slopes_add() {
        let fresnel = MetalFresnel::Tinted { f0: Spectrum::WHITE, f82: Spectrum::WHITE };
        let microfacets = Microfacets::new(NormalDistribution::Beckmann, 0.3);
        let metal = Conductor { fresnel, microfacets };
        let Bsdf::Conductor(wide) = Bsdf::Conductor(metal).widened(Vec2::new(0.08, 0.0)) else {
            panic!("another lobe");
        };
        assert!((wide.microfacets.alpha_x - 0.5).abs() < 1e-6 && wide.microfacets.alpha_y == 0.3);
        let Bsdf::Conductor(widest) = Bsdf::Conductor(metal).widened(Vec2::splat(1e9)) else {
            panic!("another lobe");
        };
        assert_eq!(widest.microfacets.alpha_x, 1.0);
        let mirror = Dielectric::new(1.5, Microfacets::new(NormalDistribution::Ggx, 0.0));
        assert!(Bsdf::Dielectric(mirror).is_delta());
        assert!(!Bsdf::Dielectric(mirror).widened(Vec2::splat(0.01)).is_delta());
        assert!(Bsdf::Dielectric(mirror).widened(Vec2::ZERO).is_delta());
    }

    /// Seen where it is mirrored, Phong's highlight becomes lower and its flank higher.
    #[test]
    fn highlights_become_wider() {
        let phong = Phong { specular: Spectrum::rgb(0.5, 0.5, 0.5), exponent: 200.0, ..Phong::BLACK };
        let lobes = Bsdf::Phong(PhongLobes::from(&phong));
        let wide = lobes.widened(Vec2::splat(0.01));
        let (wo, flank) = (kajo_math::Vec3::Z, kajo_math::Vec3::new(0.3, 0.0, 0.91f32.sqrt()));
        let value = |bsdf: &Bsdf<'_>, wi| bsdf.eval(wo, wi, crate::bsdf::Transport::Radiance).max_lane();
        // 1/n' = 1/200 + 0.04; values go with n + 2 at the middle, and with the cosine's power beside it.
        let middle = value(&wide, wo) / value(&lobes, wo);
        assert!((middle / (24.222 / 202.0) - 1.0).abs() < 1e-3, "{middle}");
        assert!(value(&wide, flank) > 50.0 * value(&lobes, flank));
    }
}
