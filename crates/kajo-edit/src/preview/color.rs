//! One colour for a material, to tell things apart by.

use kajo_color::srgb;
use kajo_core::material::MaterialId;
use kajo_core::scene::Scene;
use kajo_core::texture::TextureContext;
use kajo_math::{Vec2, Vec3};

/// How dark anything may be: a black mirror is still to be seen.
const DARKEST: f32 = 0.03;

/// What a material looks like around the world-space point `p` and in the middle of its pictures, encoded in sRGB, and 255.
pub(super) fn of(scene: &Scene, material: MaterialId, p: Vec3) -> [u8; 4] {
    let phong = match scene.appearance.materials.constant(material) {
        Some(phong) => *phong,
        None => {
            let place = TextureContext { p, uv: Vec2::splat(0.5).into(), ..TextureContext::default() };
            scene.appearance.phong(material, &place)
        }
    };
    let rgb = (phong.diffuse + (phong.reflective + phong.transparent + phong.specular * 0.5) * 0.4).to_rgb();
    let [r, g, b] = rgb.map(|v| (srgb::encode(v.clamp(DARKEST, 1.0)) * 255.0).round() as u8);
    [r, g, b, 255]
}
