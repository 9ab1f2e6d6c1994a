//! How often media scatter light before it leaves them.

use kajo_color::Wavelengths;
use kajo_core::ObjectId;
use kajo_core::medium::MediumId;
use kajo_core::scene::Scene;
use kajo_math::{Aabb, Vec3};

/// Points along each axis at which a density is looked at.
const POINTS: u32 = 4;

/// Objects beyond which no others are looked at.
const MOST_OBJECTS: usize = 1000;

/// `-ln` of the share of light that may still be on its way.
const LEFT: f32 = 5.0;

/// Scatterings after which less than a hundredth of the light is still on its way in the medium of the scene that holds it the longest; 0 without
/// media.
///
/// In a box of the sides `s` the slowest mode of diffusion, whose constant is `1 / (3 sigma_s (1 - g))`, decays by the factor `exp(-a)` with each
/// scattering, where
///
/// ```text
/// a = pi^2 (1/s_x^2 + 1/s_y^2 + 1/s_z^2) / (3 sigma_s^2 (1 - g)) + sigma_a / sigma_s
/// ```
///
/// which is an upper bound where the box is that of a body within it.
pub fn most_scatterings(scene: &Scene) -> u32 {
    if !scene.has_media() {
        return 0;
    }
    let materials = &scene.appearance.materials;
    let bodies = scene.geometry.primitives.iter().take(MOST_OBJECTS).zip(0u32..).filter_map(|(body, i)| {
        let bounds = scene.geometry.object_bounds(ObjectId::from_index(i));
        Some((materials.medium(body.material)?, bounds))
    });
    let air = scene.lighting.air.map(|medium| (medium, scene.geometry.bounds()));
    let each = bodies.chain(air).map(|(medium, bounds)| scatterings(scene, medium, &bounds));
    each.fold(0.0, f32::max).ceil() as u32
}

/// The note of integrators that follow light this often, where media hold it for longer.
pub fn cut_off(scene: &Scene, bounces: u32) -> Option<&'static str> {
    const NOTE: &str = "media scatter light more often than `bounces` allows, and what is still on its way then is lost; \
         ask for more, or take `path`, which follows it to its end";
    (most_scatterings(scene) > bounces).then_some(NOTE)
}

/// The same of one medium in a box.
fn scatterings(scene: &Scene, medium: MediumId, bounds: &Aabb) -> f32 {
    let media = &scene.appearance.media;
    let coefficients = media.coefficients(medium);
    if media.bends_light(medium) || !coefficients.scatters() {
        return 0.0;
    }
    let own = media.bounds(medium).unwrap_or(Aabb::EVERYWHERE);
    let (min, max) = (bounds.min.max(own.min), bounds.max.min(own.max));
    let sides = max - min;
    if !(sides.is_finite() && sides.min_element() > 0.0) {
        return 0.0;
    }
    let density = mean_density(scene, medium, min, sides);
    let [sigma_s, sigma_a] =
        [coefficients.sigma_s(&Wavelengths::RGB), coefficients.sigma_a(&Wavelengths::RGB)];
    let g = coefficients.phase().mean_cosine();
    let lane = |i: usize| {
        let (s, a) = (sigma_s[i] * density, sigma_a[i] * density);
        let leaves = std::f32::consts::PI.powi(2) * (sides * sides).recip().element_sum()
            / (3.0 * s * s * (1.0 - g).max(1e-3));
        if s > 0.0 { LEFT / (leaves + a / s) } else { 0.0 }
    };
    [0, 1, 2].map(lane).into_iter().fold(0.0, f32::max).min(1e9)
}

/// The mean density at some points of a box.
fn mean_density(scene: &Scene, medium: MediumId, min: Vec3, sides: Vec3) -> f32 {
    if scene.appearance.media.is_homogeneous(medium) {
        return 1.0;
    }
    let at = |k: u32| (k as f32 + 0.5) / POINTS as f32;
    let points =
        (0..POINTS.pow(3)).map(|i| Vec3::new(at(i % POINTS), at(i / POINTS % POINTS), at(i / POINTS.pow(2))));
    points.map(|p| scene.appearance.density(medium, min + p * sides)).sum::<f32>() / POINTS.pow(3) as f32
}

#[cfg(test)]
mod tests {
    use kajo_scene::MemoryAssets;

    use super::*;
    use crate::integrator::tests::scene_with;

    /// A ball of a medium in a scene.
    fn scene(medium: &str, body: &str) -> Scene {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Media {{ {medium} }} Materials {{ Interface body {{ medium m }} }} Group {{ MaterialIndex body {body} }}"
        );
        scene_with(&text, &MemoryAssets::new())
    }

    /// A white cube of the optical depth 18 that scatters backwards keeps half a per cent of its light after 256 scatterings and a tenth after 64.
    #[test]
    fn thick_white_media_hold_light_for_long() {
        let cube = "Box { min -1 -1 -1 max 1 1 1 }";
        let white = most_scatterings(&scene("Medium m { sigma_s 9  g -0.5 }", cube));
        assert!((230..=260).contains(&white), "{white}");
        let grey = most_scatterings(&scene("Medium m { sigma_s 9  sigma_a 1  g -0.5 }", cube));
        assert!((37..=45).contains(&grey), "{grey}");
        let thin = most_scatterings(&scene("Medium m { sigma_s 0.2 }", cube));
        assert!(thin <= 1, "{thin}");
        let voxels =
            most_scatterings(&scene("FunctionMedium m { function = 1 + x  sigma_s 9  g -0.5 }", cube));
        assert!(white.abs_diff(voxels) <= 2, "{white} {voxels}");
        assert_eq!(most_scatterings(&scene("Medium m { sigma_a 9 }", cube)), 0);
    }

    #[test]
    fn what_bounces_cut_off_is_said() {
        let cube = "Box { min -1 -1 -1 max 1 1 1 }";
        let thick = scene("Medium m { sigma_s 9  g -0.5 }", cube);
        assert!(cut_off(&thick, 64).is_some() && cut_off(&thick, 300).is_none());
        assert!(cut_off(&scene("Medium m { sigma_s 0.2 }", cube), 16).is_none());
    }
}
