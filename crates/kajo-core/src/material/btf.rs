//! A surface by a bidirectional texture function: cloth, leather, whatever is too fine to be modelled and too coarse to be a BRDF.
//!
//! At each point one texel answers, drawn by the number `at.u` among the four around it, and with `filter trilinear` also among two
//! levels: the mean of the answers is the bilinear or trilinear mean [Pharr et al. 2024]. The frame has its x axis along `u`. The classic
//! integrator sees a diffuse surface of the mean albedo.
//!
//! Scene: `BTF { file cloth.btf  repeat 8 8 }`

use std::sync::Arc;

use kajo_color::RgbBasis;
use kajo_math::{Vec2, warp};

use super::{Appearance, Material, Orientation, ShadingPoint};
use crate::bsdf::{Bsdf, BtfLobe, Phong};
use crate::measured::btf::{Btf, Texel};
use crate::texture::{AnyTexture, FloatTexture, TextureContext};

/// A material by a bidirectional texture function.
#[derive(Clone, Debug)]
pub struct BtfMaterial {
    btf: Arc<Btf>,
    settings: BtfSettings,
    /// Where the classic integrator sees the same everywhere.
    constant: Option<Phong>,
}

/// How a bidirectional texture function is laid on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BtfSettings {
    /// A factor of all its values, at least 0.
    pub scale: FloatTexture,
    /// How often it fits into the unit square of surface coordinates.
    pub repeat: Vec2,
    /// By how much of itself it is moved, to the left and down.
    pub offset: Vec2,
    /// Whether smaller copies are shown where a sample covers more than a texel.
    pub is_filtered: bool,
}

impl Default for BtfSettings {
    fn default() -> BtfSettings {
        BtfSettings {
            scale: FloatTexture::Constant(1.0),
            repeat: Vec2::ONE,
            offset: Vec2::ZERO,
            is_filtered: false,
        }
    }
}

impl BtfMaterial {
    /// A surface that `btf` is laid on.
    pub fn new(btf: Arc<Btf>, settings: BtfSettings) -> BtfMaterial {
        let constant = match settings.scale {
            FloatTexture::Constant(scale) => Some(Phong::matte(btf.mean_albedo(), scale)),
            FloatTexture::Node(_) => None,
        };
        BtfMaterial { btf, settings, constant }
    }

    /// The texel that is shown at a point by the number `at.u`.
    fn texel(&self, at: &ShadingPoint<'_>) -> Texel {
        let BtfSettings { repeat, offset, is_filtered, .. } = self.settings;
        let mut chance = RemainingUniform(at.u);
        let level = if is_filtered { self.level(at.context, &mut chance) } else { 0 };
        let s = repeat * at.context.uv.first + offset;
        let [width, height] = self.btf.level_size(level);
        // Whole repetitions are dropped first, so that no digits are lost; the first row is on top.
        let s = Vec2::new(s.x - s.x.floor(), 1.0 - (s.y - s.y.floor()));
        let place = s * Vec2::new(width as f32, height as f32) - 0.5;
        let [x, y] = [place.x, place.y].map(|place| {
            let whole = place.floor();
            whole as i64 + i64::from(chance.is_below(place - whole))
        });
        self.btf.texel(level, x, y)
    }

    /// The level whose texels are as large as what a sample covers.
    fn level(&self, at: &TextureContext, chance: &mut RemainingUniform) -> usize {
        let [width, height] = self.btf.size();
        let texels = self.settings.repeat * Vec2::new(width as f32, height as f32);
        let squared = at.footprint.uv.map(|axis| (axis * texels).length_squared());
        let covered = squared[0].max(squared[1]);
        if covered <= 1.0 || !covered.is_finite() {
            return 0;
        }
        // Half the binary logarithm of the square.
        let level = 0.5 * std::f32::consts::LOG2_E * kajo_math::fmath::ln(covered);
        let whole = level.floor();
        let level = whole as usize + usize::from(chance.is_below(level - whole));
        level.min(self.btf.level_count() - 1)
    }
}

/// A uniform number that decides one thing after the other.
struct RemainingUniform(f32);

impl RemainingUniform {
    /// Whether something of this probability is so.
    fn is_below(&mut self, probability: f32) -> bool {
        let is_so;
        (is_so, self.0) = warp::choose(self.0, probability);
        is_so
    }
}

impl Material for BtfMaterial {
    fn is_finite(&self) -> bool {
        let BtfSettings { repeat, offset, .. } = self.settings;
        repeat.is_finite() && offset.is_finite()
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.settings.scale.into()]
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        let scale = || self.settings.scale.at(appearance.textures.evaluator(at));
        self.constant.unwrap_or_else(|| Phong::matte(self.btf.mean_albedo(), scale()))
    }

    fn constant(&self) -> Option<&Phong> {
        self.constant.as_ref()
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn wants_footprint(&self) -> bool {
        self.settings.is_filtered
    }

    fn is_mixture(&self) -> bool {
        true
    }

    fn orientation(&self, _appearance: &Appearance, _at: &ShadingPoint<'_>) -> Orientation {
        Orientation { turn: Some(0.0), lean: None }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let basis = RgbBasis::new(at.wavelengths);
        let scale = self.settings.scale.at(appearance.textures.evaluator(at.context));
        Bsdf::Btf(BtfLobe { btf: &self.btf, texel: self.texel(at), scale, basis })
    }
}

#[cfg(test)]
mod tests {
    use kajo_color::Wavelengths;
    use kajo_math::Vec3;

    use super::*;
    use crate::measured::btf::tests::cloth_texture;
    use crate::texture::{SurfaceUv, TextureFootprint};

    /// The mean, over the number that chooses texels, of what is scattered from one direction to another.
    fn mean(material: &BtfMaterial, uv: Vec2, footprint: [Vec2; 2]) -> f32 {
        let footprint = TextureFootprint { uv: footprint, ..TextureFootprint::POINT };
        let context = TextureContext {
            uv: SurfaceUv { first: uv, second: uv },
            footprint,
            ..TextureContext::default()
        };
        let (wo, wi) = (Vec3::new(0.3, 0.1, 0.9).normalize(), Vec3::new(-0.5, 0.2, 0.7).normalize());
        let n = 4096;
        let value = |i: u32| {
            let u = (i as f32 + 0.5) / n as f32;
            let at = ShadingPoint { context: &context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u };
            material.btf.value(material.texel(&at), wo, wi)[0]
        };
        (0..n).map(value).sum::<f32>() / n as f32
    }

    #[test]
    fn texels_are_mixed_bilinearly_and_there_is_no_seam() {
        let settings = BtfSettings { repeat: Vec2::new(2.0, 1.0), ..BtfSettings::default() };
        let material = BtfMaterial::new(Arc::new(cloth_texture()), settings);
        let at = |x: f32, y: f32| mean(&material, Vec2::new(x, y), [Vec2::ZERO; 2]);
        // Middles of texels, and between two of them; rows count from above.
        let (left, right) = (at(2.5 / 16.0, 0.3125), at(3.5 / 16.0, 0.3125));
        assert!((at(2.75 / 16.0, 0.3125) - (0.75 * left + 0.25 * right)).abs() < 1e-3 * left);
        for y in [0.1, 0.47] {
            let seam = at(0.4999, y);
            assert!((seam - at(0.5001, y)).abs() < 0.01 * seam, "{seam} {}", at(0.5001, y));
            let seam = at(y, 0.9999);
            assert!((seam - at(y, 0.0001)).abs() < 0.01 * seam, "{seam}");
            assert!((at(0.1, y) - at(0.6, y)).abs() < 1e-6);
        }
    }

    #[test]
    fn smaller_copies_are_shown_where_a_sample_covers_more() {
        let cloth = Arc::new(cloth_texture());
        let plain = BtfMaterial::new(Arc::clone(&cloth), BtfSettings::default());
        let filtered = BtfMaterial::new(cloth, BtfSettings { is_filtered: true, ..BtfSettings::default() });
        assert!(filtered.wants_footprint() && !plain.wants_footprint());
        let (uv, all) = (Vec2::new(0.3, 0.6), [Vec2::X, Vec2::Y]);
        let near = mean(&plain, uv, [Vec2::ZERO; 2]);
        assert_eq!(mean(&plain, uv, all), near);
        assert_eq!(mean(&filtered, uv, [0.1 * Vec2::X, 0.1 * Vec2::Y]), near);
        // One texel is left, wherever the point is.
        let far = mean(&filtered, uv, all);
        assert!((far - mean(&filtered, Vec2::new(0.9, 0.1), all)).abs() < 1e-6 && (far - near).abs() > 1e-3);
    }
}
