//! The colour of a material, to tell things apart by.

use kajo_color::srgb;
use kajo_core::bsdf::Phong;
use kajo_core::material::MaterialId;
use kajo_core::scene::{Interaction, Scene};
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
    encoded(reflected(&phong))
}

/// What a surface looks like at a point, in linear RGB.
pub(super) fn at(scene: &Scene, at: &Interaction) -> Vec3 {
    match scene.constant(at.material) {
        Some(phong) => reflected(phong),
        None => in_context(scene, at.material, &scene.texture_context(at)),
    }
}

/// What a material looks like where its textures are evaluated in a context, in linear RGB.
pub(crate) fn in_context(scene: &Scene, material: MaterialId, at: &TextureContext) -> Vec3 {
    reflected(&scene.appearance.phong(material, at))
}

/// A colour as it is shown: encoded in sRGB, and 255.
pub(super) fn encoded(rgb: Vec3) -> [u8; 4] {
    let [r, g, b] = rgb.to_array().map(|v| (srgb::encode(v.clamp(DARKEST, 1.0)) * 255.0).round() as u8);
    [r, g, b, 255]
}

fn reflected(phong: &Phong) -> Vec3 {
    let sum = phong.diffuse + (phong.reflective + phong.transparent + phong.specular * 0.5) * 0.4;
    Vec3::from(sum.to_rgb())
}
