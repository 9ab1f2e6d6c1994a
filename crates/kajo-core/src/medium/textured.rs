//! A medium whose density is a texture: a cloud of noise, smoke in wisps.
//!
//! A texture is nowhere less than 0 nor more than 1, which is all that is known of it along a ray, so the bound is 1 in all of the box. Textures
//! on surface coordinates have the same number everywhere, since there is no surface.
//!
//! Scene: `Textures { Clouds puffs { } } Media { TextureMedium cloud { texture puffs  min -2 0 -2  max 2 2 2  density 8 } }`

use kajo_math::{Aabb, Ray, Vec3};

use super::{Coefficients, MajorantGrid, Majorants, Medium};
use crate::texture::{AnyTexture, FloatTexture, TextureContext, Textures};

/// A medium by a texture at the world-space point.
#[derive(Clone, Debug)]
pub struct TextureMedium {
    coefficients: Coefficients,
    texture: FloatTexture,
    majorants: MajorantGrid,
}

impl TextureMedium {
    /// * `coefficients`: of the density 1
    /// * `texture`: the density; held to [0, 1]
    /// * `bounds`: the world-space box outside of which there is nothing
    ///
    /// `None` for a box that is flat, or has no bounds.
    pub fn new(coefficients: Coefficients, texture: FloatTexture, bounds: Aabb) -> Option<TextureMedium> {
        let has_inside = bounds.is_finite() && bounds.extent().min_element() > 0.0;
        let majorants = has_inside.then(|| MajorantGrid::new(bounds, [1; 3], |_| [0.0, 1.0]))?;
        Some(TextureMedium { coefficients, texture, majorants })
    }
}

impl Medium for TextureMedium {
    fn is_finite(&self) -> bool {
        true
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        vec![self.texture.into()]
    }

    #[inline]
    fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    fn density(&self, textures: &Textures, p: Vec3) -> f32 {
        let at = TextureContext { p, ..TextureContext::default() };
        let value = self.texture.at(textures.evaluator(&at));
        // What is no number is nothing.
        if value > 0.0 { value.min(1.0) } else { 0.0 }
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(*self.majorants.bounds())
    }

    fn majorants(&self, ray: &Ray) -> Majorants<'_> {
        Majorants::cells(self.majorants.walk(ray))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::medium::Phase;
    use crate::texture::PatternNode;
    use kajo_math::pattern::{SolidPattern, Turbulence};

    #[test]
    fn the_density_is_the_texture_and_bounds_hold() {
        let mut textures = Textures::default();
        let solid = SolidPattern::new(Turbulence::default());
        let texture = textures.float(PatternNode { solid, is_filtered: false }).unwrap();
        let coefficients = Coefficients::new([0.0; 3], [2.0; 3], Phase::Isotropic).unwrap();
        let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::new(3.0, 1.0, 1.0) };
        let medium = TextureMedium::new(coefficients.clone(), texture, bounds).unwrap();
        assert_eq!(medium.bounds(), Some(bounds));
        let ray = Ray::new(Vec3::new(-4.0, 0.25, 0.5), Vec3::X);
        let stretches: Vec<_> = medium.majorants(&ray).collect();
        assert_eq!((stretches[0].t_min, stretches[stretches.len() - 1].t_max), (3.0, 7.0));
        for i in 0..100 {
            let t = 3.0 + 0.04 * i as f32;
            let density = medium.density(&textures, ray.o + t * ray.d);
            assert_eq!(density, solid.at(ray.o + t * ray.d, 0.0));
            assert!(stretches.iter().any(|s| s.t_min <= t && t <= s.t_max && density <= s.density));
        }
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 0.0, 1.0) };
        assert!(TextureMedium::new(coefficients.clone(), texture, flat).is_none());
        let endless = Aabb { min: Vec3::ZERO, max: Vec3::splat(f32::INFINITY) };
        assert!(TextureMedium::new(coefficients, texture, endless).is_none());
    }
}
