//! What materials of glTF files become.
//!
//! Layers of the same numbers: base colour, metalness, roughness and gloss, glass, varnish, fibres. Glass without a
//! volume is a pane.

use kajo_color::{Emission, Reflectance, Spectrum};
use kajo_math::Vec3;
use kajo_scene::{ModelAmount, ModelCover, ModelMaterial, PictureSource, PictureUse, PictureWrap, Span};

use super::Compiler;
use super::emitters::Glow;
use crate::bsdf::Phong;
use crate::family::Pooled;
use crate::light::Sides;
use crate::material::{Embossed, Grain, LayeredMaterial, Layers, MaterialId, PhongMaterial, Relief};
use crate::texture::{Channel, Encoding, Paint, PictureMap, Share, TexelFilter, Wrap};

/// The index of refraction of glTF's varnish.
const COAT_ETA: f32 = 1.5;

/// What the numbers of a picture mean that is none of colours.
const AMOUNTS: Option<Encoding> = Some(Encoding::Linear);

/// The pictures of a model.
pub(super) struct ModelPictures<'a> {
    pub list: &'a [Option<PictureSource>],
    /// Of the model's file.
    pub path: &'a str,
    /// Where the scene names it.
    pub at: Span,
}

impl Compiler<'_> {
    /// A material of layers, with relief, light and holes where the file has them; the classic integrator sees its
    /// colour.
    pub(super) fn model_material(
        &mut self,
        material: &ModelMaterial,
        pictures: &ModelPictures<'_>,
    ) -> Option<MaterialId> {
        let color = self.model_picture(material.picture, None, pictures);
        let layers = self.model_layers(material, color.as_ref(), pictures);
        let is_body = layers.transmission.range()[1] > 0.0 && !layers.thin;
        let opacity = opacity(material, color.as_ref()).filter(|_| !is_body);
        let look = PhongMaterial::from(phong(material)).with_picture(color);
        let mut id = LayeredMaterial::from(layers).with_look(look).store(&mut self.materials)?;
        if let Some((shown, scale)) = material.normals
            && let Some(map) = self.model_picture(Some(shown), AMOUNTS, pictures)
        {
            let relief = Relief::Normals { map, scale };
            id = Embossed { material: id, relief }.store(&mut self.materials)?;
        }
        let slide = self.model_picture(material.emissive_picture, None, pictures);
        let even = Glow::even(Emission::from_rgb(material.emissive));
        let sides = if material.two_sided { Sides::Both } else { Sides::Front };
        let glow = even.map(|glow| slide.into_iter().fold(glow.on(sides), Glow::through));
        self.lit_and_cut(id, glow, opacity)
    }

    /// * `color`: the picture of the base colour
    fn model_layers(
        &mut self,
        material: &ModelMaterial,
        color: Option<&PictureMap>,
        pictures: &ModelPictures<'_>,
    ) -> Layers {
        let mut amount = |ModelAmount { value, picture }, channel| {
            share(self.model_picture(picture, AMOUNTS, pictures), value, channel)
        };
        let part = |value| ModelAmount { value, picture: material.metal_and_roughness };
        let roughness = amount(part(material.roughness), Channel::Green);
        let metalness = amount(part(material.metallic), Channel::Blue);
        let transmission = amount(material.transmission, Channel::Red);
        let coat = amount(material.coat, Channel::Red);
        let coat_roughness = amount(material.coat_roughness, Channel::Green);
        let fuzz_roughness = amount(material.sheen_roughness, Channel::Alpha);
        let mut tint = |picture, color| paint(self.model_picture(picture, None, pictures), color);
        let fuzz = material.sheen.color.into_iter().fold(0.0, f32::max);
        let fuzz_color = material.sheen.color.map(|c| if fuzz > 0.0 { c / fuzz } else { 0.0 });
        Layers {
            color: paint(color.cloned(), material.base_color),
            specular_color: tint(material.specular.picture, material.specular.color),
            metalness,
            transmission,
            absorption: material.body.unwrap_or_default(),
            thin: material.body.is_none(),
            eta: material.eta,
            coat,
            coat_roughness,
            coat_eta: COAT_ETA,
            fuzz: fuzz.into(),
            fuzz_color: tint(material.sheen.picture, fuzz_color),
            fuzz_roughness,
            ..brushed(material, roughness)
        }
    }

    /// A picture that a material shows; one that cannot be read is left out.
    fn model_picture(
        &mut self,
        shown: Option<PictureUse>,
        encoding: Option<Encoding>,
        pictures: &ModelPictures<'_>,
    ) -> Option<PictureMap> {
        let PictureUse { picture: number, wrap, nearest, repeat, offset } = shown?;
        let &ModelPictures { list, path, at } = pictures;
        let map = match list.get(number)?.as_ref()? {
            PictureSource::File(name) => self.found_picture(name, path, encoding, at),
            PictureSource::Bytes(bytes) => {
                self.held_picture(bytes, &format!("{path}#images[{number}]"), encoding, at)
            }
        }?;
        let wrap = match wrap {
            PictureWrap::Repeat => Wrap::Repeat,
            PictureWrap::Mirror => Wrap::Mirror,
            PictureWrap::Clamp => Wrap::Clamp,
        };
        let filter = if nearest { TexelFilter::Nearest } else { TexelFilter::Bilinear };
        Some(PictureMap { wrap, filter, repeat: repeat.into(), offset: offset.into(), ..map })
    }
}

/// The share of a surface that is there, where that is not all of it.
///
/// * `color`: the picture of its colour
fn opacity(material: &ModelMaterial, color: Option<&PictureMap>) -> Option<Share> {
    let value = material.opacity;
    // Most pictures have no holes, whatever the material says of them.
    let map = color.filter(|map| map.mean()[Channel::Alpha as usize] < 1.0);
    let map = map.map(|map| PictureMap { factor: [1.0, 1.0, 1.0, value], ..map.clone() });
    let share = match (material.cover, map) {
        (ModelCover::Everything, _) => return None,
        (ModelCover::Share, None) => Share::Plain(value),
        (ModelCover::Share, Some(map)) => Share::Picture(map, Channel::Alpha),
        (ModelCover::FromOn(least), None) => Share::Plain(if value < least { 0.0 } else { 1.0 }),
        (ModelCover::FromOn(least), Some(map)) => Share::Cut(map, Channel::Alpha, least),
    };
    (share.range()[0] < 1.0).then_some(share)
}

/// A number or, where there is one, a channel of a picture times that.
pub(super) fn share(map: Option<PictureMap>, value: f32, channel: Channel) -> Share {
    match map {
        Some(map) if value > 0.0 => Share::Picture(PictureMap { factor: [value; 4], ..map }, channel),
        _ => value.into(),
    }
}

/// A colour or, where there is one, a picture times that.
pub(super) fn paint(map: Option<PictureMap>, color @ [r, g, b]: [f32; 3]) -> Paint {
    match map {
        Some(map) => Paint::Picture(PictureMap { factor: [r, g, b, 1.0], ..map }),
        None => Reflectance::from_rgb(color).into(),
    }
}

/// Layers of a roughness, with facets that run one way where the material has them.
///
/// The roughnesses of glTF are `α` across and `mix(α, 1, strength²)` along; here they are told by the root of their mean
/// square and by their proportion. Under a picture of the roughness the proportion is that of its factor.
fn brushed(material: &ModelMaterial, roughness: Share) -> Layers {
    let (strength, turns) = material.anisotropy;
    if strength <= 0.0 {
        return Layers { roughness, ..Layers::default() };
    }
    let across = material.roughness * material.roughness;
    let along = across + (1.0 - across) * strength * strength;
    let grain = Grain { anisotropy: (1.0 - across / along).into(), rotation: turns.rem_euclid(1.0).into() };
    let whole = (0.5 * (across * across + along * along)).sqrt().sqrt();
    let roughness = if roughness.varies() { roughness } else { whole.into() };
    Layers { roughness, grain, ..Layers::default() }
}

/// The Phong material with the same colour, clear where the other one is.
fn phong(material: &ModelMaterial) -> Phong {
    let [r, g, b] = material.base_color;
    let color = Spectrum::rgb(r, g, b);
    let clear = (1.0 - material.metallic) * material.transmission.value;
    let diffuse = color * (1.0 - clear);
    let absorption = Vec3::from(material.body.unwrap_or_default()).into();
    let eta = if material.body.is_some() { material.eta } else { 1.0 };
    Phong { ambient: diffuse, diffuse, transparent: color * clear, absorption, eta, ..Phong::BLACK }
}
