//! What materials of glTF files become.
//!
//! Layers of the same numbers: base colour, metalness, roughness and gloss, glass, coat, fuzz. Glass without a
//! volume is a pane.

use kajo_color::{Dispersion, Emission, Reflectance, Spectrum};
use kajo_math::Vec3;
use kajo_scene::{ModelAmount, ModelCover, ModelMaterial, ModelTint, PictureSource, Span, VertexColors};

use super::Compiler;
use super::model_files::ModelFiles;
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::light::Sides;
use crate::material::{
    Embossed, Grain, LayeredMaterial, Layers, MaterialId, PhongMaterial, Relief, SpecularLayer,
};
use crate::texture::{
    AnyFloatNode, Channel, ColorTexture, Encoding, FloatTexture, PictureChannel, PictureCut, PictureMap,
    VertexColor,
};

/// The index of refraction of glTF's coat.
const COAT_ETA: f32 = 1.5;

/// What the numbers of a picture mean that is none of colours.
const AMOUNTS: Option<Encoding> = Some(Encoding::Linear);

/// The pictures of a model.
pub(super) struct ModelPictures<'a> {
    pub list: &'a [Option<PictureSource>],
    /// Of the model's file.
    pub path: &'a str,
    /// What pictures that it holds are read from again, where that can be.
    pub files: Option<&'a ModelFiles>,
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
        let older = material.glossiness.as_ref().and_then(|older| self.glossiness_pictures(older, pictures));
        let (color, metal, plain) = match older {
            // The pictures are all there is.
            Some([color, metal]) => {
                let plain =
                    ModelMaterial { base_color: [1.0; 3], metallic: 1.0, roughness: 1.0, ..material.clone() };
                (Some(color), Some(metal), Some(plain))
            }
            None => {
                let metal = self.model_picture(material.metal_and_roughness, AMOUNTS, pictures);
                (self.model_picture(material.picture, None, pictures), metal, None)
            }
        };
        let material = plain.as_ref().unwrap_or(material);
        let layers = match material.unlit {
            true => black(),
            false => self.model_layers(material, color.as_ref(), metal, pictures),
        };
        let is_body = layers.transmission.share_range()[1] > 0.0 && !layers.thin;
        let opacity = if is_body { None } else { self.model_opacity(material, color.as_ref(), pictures.at) };
        let shown = color.clone().and_then(|map| self.color_picture(map, pictures.at));
        let look = PhongMaterial::from(phong(material)).with_picture(shown);
        let layered = LayeredMaterial::from(layers).with_look(look);
        let mut id = self.store_material(layered, pictures.at)?;
        if let Some((shown, scale)) = material.normals
            && let Some(map) = self.model_picture(Some(shown), AMOUNTS, pictures)
        {
            let normals = self.color_picture(map, pictures.at)?;
            let relief = Relief::Normals { normals, scale: scale.into() };
            id = self.store_material(Embossed { material: id, relief }, pictures.at)?;
        }
        let (slide, light) = match material.unlit {
            true => (color, material.base_color),
            false => (self.model_picture(material.emissive_picture, None, pictures), material.emissive),
        };
        let even = SurfaceEmission::from(Emission::from_rgb(light));
        let sides = if material.two_sided { Sides::Both } else { Sides::Front };
        let slide = slide.and_then(|map| self.color_picture(map, pictures.at));
        let is_tinted = material.unlit && material.vertex_colors > VertexColors::None;
        let tint = is_tinted.then(|| self.scene.color_texture(VertexColor).ok()).flatten();
        let emission = slide.iter().chain(&tint).fold(even.on(sides), SurfaceEmission::through);
        self.lit_and_cut(id, emission, opacity, pictures.at)
    }

    /// * `color`, `metal`: the pictures of the base colour, and of roughness and metalness
    fn model_layers(
        &mut self,
        material: &ModelMaterial,
        color: Option<&PictureMap>,
        metal: Option<PictureMap>,
        pictures: &ModelPictures<'_>,
    ) -> Layers {
        let roughness = self.number(metal.clone(), material.roughness, Channel::Green, pictures.at);
        let metalness = self.number(metal, material.metallic, Channel::Blue, pictures.at);
        let mut amount = |ModelAmount { value, picture }, channel| {
            let map = self.model_picture(picture, AMOUNTS, pictures);
            self.number(map, value, channel, pictures.at)
        };
        let transmission = amount(material.transmission, Channel::Red);
        let coat = amount(material.coat, Channel::Red);
        let coat_roughness = amount(material.coat_roughness, Channel::Green);
        let fuzz_roughness = amount(material.sheen_roughness, Channel::Alpha);
        let specular = self.model_specular(material, pictures);
        let fuzz = material.sheen.color.into_iter().fold(0.0, f32::max);
        let fuzz_color = material.sheen.color.map(|c| if fuzz > 0.0 { c / fuzz } else { 0.0 });
        let fuzz_map = self.model_picture(material.sheen.picture, None, pictures);
        Layers {
            color: self.color(color.cloned(), material.base_color, pictures.at),
            specular,
            metalness,
            transmission,
            absorption: material.body.unwrap_or_default(),
            thin: material.body.is_none(),
            eta: material.eta.into(),
            dispersion: material
                .abbe
                .is_finite()
                .then(|| Dispersion::from_abbe(material.eta.into(), material.abbe.into())),
            coat,
            coat_roughness,
            coat_eta: COAT_ETA.into(),
            fuzz: fuzz.into(),
            fuzz_color: self.color(fuzz_map, fuzz_color, pictures.at),
            fuzz_roughness,
            ..brushed(material, roughness)
        }
    }

    /// How the gloss of what is no metal differs from that of its index.
    fn model_specular(&mut self, material: &ModelMaterial, pictures: &ModelPictures<'_>) -> SpecularLayer {
        let ModelTint { color, picture } = material.specular;
        let gloss = self.model_picture(material.gloss.picture, AMOUNTS, pictures);
        let weight = self.number(gloss, material.gloss.value, Channel::Alpha, pictures.at);
        let map = self.model_picture(picture, None, pictures);
        if map.is_none() && color == [1.0; 3] && weight.share_range()[0] >= 1.0 {
            return SpecularLayer::default();
        }
        let scale = color.into_iter().fold(1.0, f32::max);
        SpecularLayer::F0 { factor: self.color(map, color.map(|c| c / scale), pictures.at), scale, weight }
    }

    /// The share of a surface that is there, where that is not all of it.
    ///
    /// * `color`: the picture of its colour
    fn model_opacity(
        &mut self,
        material: &ModelMaterial,
        color: Option<&PictureMap>,
        span: Span,
    ) -> Option<FloatTexture> {
        let value = material.opacity;
        // Most pictures have no holes, whatever the material says of them.
        let is_clear = material.vertex_colors == VertexColors::ColorAndOpacity;
        let map = color.filter(|map| is_clear || map.means()[Channel::Alpha as usize] < 1.0).cloned();
        // Vertices make holes of their own.
        let map = map.or_else(|| is_clear.then(PictureMap::white));
        let map = map.map(|map| PictureMap { factor: [1.0, 1.0, 1.0, value], ..map });
        let channel = Channel::Alpha;
        let node: AnyFloatNode = match (material.cover, map) {
            (ModelCover::Everything, _) => return None,
            (ModelCover::Share, None) => return hole(value),
            (ModelCover::FromOn(least), None) => return hole(if value < least { 0.0 } else { 1.0 }),
            (ModelCover::Share, Some(map)) => PictureChannel { map, channel }.into(),
            (ModelCover::FromOn(least), Some(map)) => PictureCut { map, channel, least }.into(),
        };
        let texture = self.scene.float_texture(node);
        self.accepted(texture, span)
    }

    /// A number or, where there is one, a channel of a picture times that.
    pub(super) fn number(
        &mut self,
        map: Option<PictureMap>,
        value: f32,
        channel: Channel,
        span: Span,
    ) -> FloatTexture {
        let Some(map) = map.filter(|_| value > 0.0) else { return value.into() };
        let node = PictureChannel { map: PictureMap { factor: [value; 4], ..map }, channel };
        let texture = self.scene.float_texture(node);
        self.accepted(texture, span).unwrap_or(FloatTexture::Constant(value))
    }

    /// A colour or, where there is one, a picture times that.
    pub(super) fn color(
        &mut self,
        map: Option<PictureMap>,
        color @ [r, g, b]: [f32; 3],
        span: Span,
    ) -> ColorTexture {
        let map = map.map(|map| PictureMap { factor: [r, g, b, 1.0], ..map });
        let texture = map.and_then(|map| self.color_picture(map, span));
        texture.unwrap_or_else(|| Reflectance::from_rgb(color).into())
    }

    /// The colours of a picture.
    pub(super) fn color_picture(&mut self, map: PictureMap, span: Span) -> Option<ColorTexture> {
        let texture = self.scene.color_texture(map);
        self.accepted(texture, span)
    }
}

/// An opacity that is the same everywhere, where it is less than all.
fn hole(opacity: f32) -> Option<FloatTexture> {
    (opacity < 1.0).then_some(FloatTexture::Constant(opacity))
}

/// A surface that reflects nothing.
fn black() -> Layers {
    let black = || ColorTexture::from(Reflectance::constant(0.0));
    Layers { color: black(), specular: SpecularLayer::Factor(black()), ..Layers::default() }
}

/// Layers of a roughness, with facets that run one way where the material has them.
///
/// The roughnesses of glTF are `α` across and `mix(α, 1, strength²)` along; here they are told by the root of their mean
/// square and by their proportion. Under a picture of the roughness the proportion is that of its factor.
fn brushed(material: &ModelMaterial, roughness: FloatTexture) -> Layers {
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
