//! Materials of glTF: what they are like, and the JSON that says so. Names of the latter are those of the specification
//! and of its extensions `KHR_materials_*` and `KHR_texture_transform`.
//!
//! What the older extension `KHR_materials_pbrSpecularGlossiness` says of a surface is put into the terms of the
//! newer ones: with `f` the reflectance straight on, the index of refraction is `(1 + √f) / (1 - √f)`.

use super::texture::{Sampler, Texture};
use kajo_math::fmath;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use std::f32::consts::TAU;

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMaterial {
    /// Its name in the file.
    pub name: Option<String>,
    /// Red, green and blue, linear.
    pub base_color: [f32; 3],
    /// What the base colour is multiplied by over the surface.
    pub picture: Option<PictureUse>,
    /// What colours at vertices are another factor of.
    pub vertex_colors: VertexColors,
    /// Whether it has its base colour in any light.
    pub unlit: bool,
    /// What roughness, by its green, and metalness, by its blue channel, are multiplied by.
    pub metal_and_roughness: Option<PictureUse>,
    /// Normals of a fine relief, and the factor of their components across the surface.
    pub normals: Option<(PictureUse, f32)>,
    /// How much the surface covers what is behind it, in [0, 1], where [`ModelMaterial::cover`] is not
    /// [`ModelCover::Everything`]. The alpha of the picture is another factor.
    pub opacity: f32,
    /// What that means.
    pub cover: ModelCover,
    /// 1 for metals, 0 for everything else.
    pub metallic: f32,
    /// 0 for a mirror, 1 for chalk.
    pub roughness: f32,
    /// How much facets run one way, in [0, 1], and by how much the direction of the greater roughness is turned from the
    /// first texture coordinate, in full turns. The roughness that way is `mix(roughness², 1, strength²)`.
    pub anisotropy: (f32, f32),
    /// Index of refraction, at least 1.
    pub eta: f32,
    /// Abbe's number of the index, infinite where it is the same for all wavelengths.
    pub abbe: f32,
    /// Factor of what is reflected at normal incidence by what is no metal; it may be above 1.
    pub specular: ModelTint,
    /// Factor of that gloss at every angle, by the alpha channel.
    pub gloss: ModelAmount,
    /// Share of light that goes in where the surface is no metal, by the red channel.
    pub transmission: ModelAmount,
    /// What is behind the surface when light does: absorption per unit length in a body, or nothing, since the surface
    /// is a thin pane.
    pub body: Option<[f32; 3]>,
    /// Share of coat, by the red channel.
    pub coat: ModelAmount,
    /// Of the coat, by the green channel.
    pub coat_roughness: ModelAmount,
    /// Colour of fuzz, black where there are none.
    pub sheen: ModelTint,
    /// Of the fuzz, by the alpha channel.
    pub sheen_roughness: ModelAmount,
    /// Light that the surface gives off, linear.
    pub emissive: [f32; 3],
    /// What that is multiplied by over the surface.
    pub emissive_picture: Option<PictureUse>,
    /// Whether that leaves it on its inner side too.
    pub two_sided: bool,
    /// A surface in older terms, which stands in place of base colour, metalness, roughness and gloss.
    pub glossiness: Option<ModelGlossiness>,
}

/// A surface in terms of a diffuse base and of what it reflects straight on, where the latter is a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelGlossiness {
    /// Of the diffuse base, linear.
    pub diffuse: [f32; 3],
    /// Its factor.
    pub diffuse_picture: Option<PictureUse>,
    /// Straight on, linear.
    pub specular: [f32; 3],
    /// 1 for a mirror, 0 for chalk.
    pub glossiness: f32,
    /// Factors of the two: of what is reflected the colours, of the glossiness alpha.
    pub picture: PictureUse,
}

/// What colours at vertices are a factor of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum VertexColors {
    /// There are none.
    #[default]
    None,
    /// The base colour.
    Color,
    /// The base colour and the opacity.
    ColorAndOpacity,
}

impl ModelMaterial {
    /// All pictures that it shows.
    pub fn pictures(&self) -> impl Iterator<Item = PictureUse> {
        let normals = self.normals.map(|(picture, _)| picture);
        let amounts = [self.gloss, self.transmission, self.coat, self.coat_roughness, self.sheen_roughness];
        let shown = [self.picture, self.metal_and_roughness, normals, self.emissive_picture];
        let older = self.glossiness.map_or([None; 2], |older| [older.diffuse_picture, Some(older.picture)]);
        let tints = [self.specular, self.sheen].map(|tint| tint.picture);
        shown.into_iter().chain(older).chain(tints).chain(amounts.map(|amount| amount.picture)).flatten()
    }
}

/// A colour, linear, and what it is multiplied by over the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelTint {
    /// In [0, 1], that of a gloss at least 0.
    pub color: [f32; 3],
    /// Its factor.
    pub picture: Option<PictureUse>,
}

/// A number in [0, 1], and what it is multiplied by over the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ModelAmount {
    /// The number.
    pub value: f32,
    /// Its factor, in one of the channels.
    pub picture: Option<PictureUse>,
}

/// How much of what is behind a surface it covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelCover {
    /// All of it.
    Everything,
    /// All of it where the opacity is this much or more, and nothing elsewhere.
    FromOn(f32),
    /// The share that is its opacity.
    Share,
}

/// A picture as a material shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureUse {
    /// An index into [`Model::pictures`](super::Model::pictures), which may lead nowhere.
    pub picture: usize,
    /// What is beside the picture, to its sides, and above and below.
    pub wrap: [PictureWrap; 2],
    /// Whether texels have edges, instead of running into each other.
    pub nearest: bool,
    /// Which of the two sets of coordinates of a part place it.
    pub set: CoordinateSet,
    /// How often it fits into the unit square of texture coordinates.
    pub repeat: [f32; 2],
    /// By how much the picture's own coordinates grow with the other one of the surface, for pictures that are turned.
    pub cross: [f32; 2],
    /// By how much of itself it is moved, to the left and down.
    pub offset: [f32; 2],
}

/// A set of texture coordinates of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CoordinateSet {
    /// That of its mesh.
    #[default]
    First,
    /// [`ModelPart::second_uvs`](super::ModelPart::second_uvs).
    Second,
}

/// What is beside a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureWrap {
    /// The same again.
    Repeat,
    /// Its mirror image.
    Mirror,
    /// Its last texels.
    Clamp,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material {
    name: Option<String>,
    pbr_metallic_roughness: MetallicRoughness,
    normal_texture: Option<TextureInfo>,
    emissive_texture: Option<TextureInfo>,
    emissive_factor: [f32; 3],
    double_sided: bool,
    alpha_mode: AlphaMode,
    alpha_cutoff: Option<f32>,
    extensions: Extensions,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct MetallicRoughness {
    base_color_factor: [f32; 4],
    base_color_texture: Option<TextureInfo>,
    metallic_factor: f32,
    roughness_factor: f32,
    metallic_roughness_texture: Option<TextureInfo>,
}

impl Default for MetallicRoughness {
    fn default() -> Self {
        MetallicRoughness {
            base_color_factor: [1.0; 4],
            base_color_texture: None,
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            metallic_roughness_texture: None,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum AlphaMode {
    #[default]
    Opaque,
    Mask,
    Blend,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct TextureInfo {
    index: usize,
    tex_coord: u32,
    /// Of normals only.
    scale: f32,
    extensions: TextureExtensions,
}

impl Default for TextureInfo {
    fn default() -> Self {
        TextureInfo { index: 0, tex_coord: 0, scale: 1.0, extensions: TextureExtensions::default() }
    }
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: TextureTransform,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct TextureTransform {
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
    tex_coord: Option<u32>,
}

impl Default for TextureTransform {
    fn default() -> Self {
        TextureTransform { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Extensions {
    #[serde(rename = "KHR_materials_anisotropy")]
    anisotropy: Anisotropy,
    #[serde(rename = "KHR_materials_clearcoat")]
    clearcoat: Clearcoat,
    #[serde(rename = "KHR_materials_dispersion")]
    dispersion: Dispersion,
    #[serde(rename = "KHR_materials_emissive_strength")]
    emissive_strength: EmissiveStrength,
    #[serde(rename = "KHR_materials_ior")]
    ior: Ior,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "KHR_materials_sheen")]
    sheen: Sheen,
    #[serde(rename = "KHR_materials_specular")]
    specular: Specular,
    #[serde(rename = "KHR_materials_transmission")]
    transmission: Transmission,
    #[serde(rename = "KHR_materials_unlit")]
    unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_volume")]
    volume: Volume,
    #[serde(flatten)]
    unknown: BTreeMap<String, IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Anisotropy {
    anisotropy_strength: f32,
    /// In radians.
    anisotropy_rotation: f32,
    anisotropy_texture: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<TextureInfo>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<TextureInfo>,
    clearcoat_normal_texture: Option<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Dispersion {
    /// 20 over Abbe's number.
    dispersion: f32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct EmissiveStrength {
    emissive_strength: f32,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        EmissiveStrength { emissive_strength: 1.0 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(default)]
struct Ior {
    ior: f32,
}

impl Default for Ior {
    fn default() -> Self {
        Ior { ior: 1.5 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct SpecularGlossiness {
    diffuse_factor: [f32; 4],
    diffuse_texture: Option<TextureInfo>,
    specular_factor: [f32; 3],
    glossiness_factor: f32,
    specular_glossiness_texture: Option<TextureInfo>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        SpecularGlossiness {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<TextureInfo>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Specular {
    specular_factor: f32,
    specular_texture: Option<TextureInfo>,
    specular_color_factor: [f32; 3],
    specular_color_texture: Option<TextureInfo>,
}

impl Default for Specular {
    fn default() -> Self {
        Specular {
            specular_factor: 1.0,
            specular_texture: None,
            specular_color_factor: [1.0; 3],
            specular_color_texture: None,
        }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Transmission {
    transmission_factor: f32,
    transmission_texture: Option<TextureInfo>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Volume {
    thickness_factor: f32,
    attenuation_distance: f32,
    attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Volume { thickness_factor: 0.0, attenuation_distance: f32::INFINITY, attenuation_color: [1.0; 3] }
    }
}

/// The largest factor of what is reflected at normal incidence.
const LARGEST_FACTOR: f32 = 1e6;

/// The largest index of refraction that a reflectance straight on may stand for.
const LARGEST_ETA: f32 = 4.0;

/// Abbe's number of the dispersion 1.
const ABBE_AT_1: f32 = 20.0;

/// The least share of light that a body's colour leaves after its distance.
const LEAST_COLOR: f32 = 1e-6;

impl Material {
    /// Its extensions that are not read.
    pub fn unknown_extensions(&self) -> impl Iterator<Item = &str> {
        self.extensions.unknown.keys().map(String::as_str)
    }

    /// Whether there are textures that are not shown: those of a third set of coordinates, and a few rare ones.
    ///
    /// Textures of occlusion are none of them: what they are drawn for comes of itself where light is followed.
    pub fn has_unused_textures(&self) -> bool {
        let sets = self.sets();
        let extensions = &self.extensions;
        let rare =
            [&extensions.anisotropy.anisotropy_texture, &extensions.clearcoat.clearcoat_normal_texture];
        self.textures().flatten().any(|texture| sets.find(texture.set()).is_none())
            || rare.into_iter().any(Option::is_some)
    }

    fn textures(&self) -> impl Iterator<Item = Option<&TextureInfo>> {
        let (pbr, extensions) = (&self.pbr_metallic_roughness, &self.extensions);
        let older = extensions.specular_glossiness.as_ref();
        [
            // Their set is the one that tangents come from.
            self.normal_texture.as_ref(),
            pbr.base_color_texture.as_ref(),
            pbr.metallic_roughness_texture.as_ref(),
            self.emissive_texture.as_ref(),
            extensions.clearcoat.clearcoat_texture.as_ref(),
            extensions.clearcoat.clearcoat_roughness_texture.as_ref(),
            extensions.sheen.sheen_color_texture.as_ref(),
            extensions.sheen.sheen_roughness_texture.as_ref(),
            extensions.specular.specular_texture.as_ref(),
            extensions.specular.specular_color_texture.as_ref(),
            extensions.transmission.transmission_texture.as_ref(),
            older.and_then(|older| older.diffuse_texture.as_ref()),
            older.and_then(|older| older.specular_glossiness_texture.as_ref()),
        ]
        .into_iter()
    }

    /// The sets of coordinates that its textures ask for.
    pub fn sets(&self) -> Sets {
        let mut asked = self.textures().flatten().map(TextureInfo::set);
        let first = asked.next().unwrap_or(0);
        Sets { first, second: asked.find(|&set| set != first) }
    }

    /// Whether it asks for the directions in which its coordinates grow.
    pub fn needs_tangents(&self) -> bool {
        self.normal_texture.is_some() || self.extensions.anisotropy.anisotropy_strength > 0.0
    }

    /// The material with its textures.
    pub fn understood(&self, textures: &[Texture], samplers: &[Sampler]) -> ModelMaterial {
        let (pbr, extensions) = (&self.pbr_metallic_roughness, &self.extensions);
        let sets = self.sets();
        let picture = |info: &Option<TextureInfo>| info.as_ref()?.shown(&sets, textures, samplers);
        let amount = |value: f32, info| ModelAmount { value: share(value), picture: picture(info) };
        let tint = |color: [f32; 3], info| ModelTint { color: color.map(share), picture: picture(info) };
        let Extensions { anisotropy, clearcoat, sheen, specular, transmission, volume, .. } = extensions;
        let strength = extensions.emissive_strength.emissive_strength;
        let scale = self.normal_texture.as_ref().map_or(1.0, |info| info.scale);
        let [r, g, b, a] = pbr.base_color_factor.map(share);
        let material = ModelMaterial {
            name: self.name.clone(),
            base_color: [r, g, b],
            picture: picture(&pbr.base_color_texture),
            vertex_colors: VertexColors::None,
            unlit: extensions.unlit.is_some(),
            metal_and_roughness: picture(&pbr.metallic_roughness_texture),
            normals: picture(&self.normal_texture).map(|picture| (picture, scale)),
            opacity: a,
            cover: match self.alpha_mode {
                AlphaMode::Opaque => ModelCover::Everything,
                AlphaMode::Mask => ModelCover::FromOn(self.alpha_cutoff.unwrap_or(0.5)),
                AlphaMode::Blend => ModelCover::Share,
            },
            metallic: share(pbr.metallic_factor),
            roughness: share(pbr.roughness_factor),
            anisotropy: (share(anisotropy.anisotropy_strength), anisotropy.anisotropy_rotation / TAU),
            // An index of 0 is for materials made for an older model, which this one cannot show.
            eta: if extensions.ior.ior >= 1.0 { extensions.ior.ior.min(LARGEST_ETA) } else { 1.5 },
            abbe: match extensions.dispersion.dispersion {
                dispersion if dispersion > 0.0 => ABBE_AT_1 / dispersion,
                _ => f32::INFINITY,
            },
            specular: ModelTint {
                color: specular.specular_color_factor.map(|x| x.clamp(0.0, LARGEST_FACTOR)),
                picture: picture(&specular.specular_color_texture),
            },
            gloss: amount(specular.specular_factor, &specular.specular_texture),
            transmission: amount(transmission.transmission_factor, &transmission.transmission_texture),
            body: volume.absorption(),
            coat: amount(clearcoat.clearcoat_factor, &clearcoat.clearcoat_texture),
            coat_roughness: amount(
                clearcoat.clearcoat_roughness_factor,
                &clearcoat.clearcoat_roughness_texture,
            ),
            sheen: tint(sheen.sheen_color_factor, &sheen.sheen_color_texture),
            sheen_roughness: amount(sheen.sheen_roughness_factor, &sheen.sheen_roughness_texture),
            emissive: self.emissive_factor.map(|x| (x * strength).max(0.0)),
            emissive_picture: picture(&self.emissive_texture),
            two_sided: self.double_sided,
            glossiness: None,
        };
        let Some(older) = &extensions.specular_glossiness else { return material };
        let diffuse = picture(&older.diffuse_texture);
        match picture(&older.specular_glossiness_texture) {
            Some(picture) => older.kept_in(material, diffuse, picture),
            None => older.put_into(material, diffuse),
        }
    }
}

/// Two sets of texture coordinates, as numbers of the file.
pub(super) struct Sets {
    pub first: u32,
    pub second: Option<u32>,
}

impl Sets {
    fn find(&self, set: u32) -> Option<CoordinateSet> {
        match set {
            _ if set == self.first => Some(CoordinateSet::First),
            _ if Some(set) == self.second => Some(CoordinateSet::Second),
            _ => None,
        }
    }
}

impl SpecularGlossiness {
    /// The material in these terms, as far as pictures do not say which of the newer ones they mean.
    fn kept_in(
        &self,
        material: ModelMaterial,
        diffuse_picture: Option<PictureUse>,
        picture: PictureUse,
    ) -> ModelMaterial {
        let [r, g, b, a] = self.diffuse_factor.map(share);
        let older = ModelGlossiness {
            diffuse: [r, g, b],
            diffuse_picture,
            specular: self.specular_factor.map(share),
            glossiness: share(self.glossiness_factor),
            picture,
        };
        ModelMaterial {
            base_color: older.diffuse,
            picture: diffuse_picture,
            metal_and_roughness: None,
            opacity: a,
            metallic: 0.0,
            roughness: 1.0 - older.glossiness,
            glossiness: Some(older),
            ..material
        }
    }

    fn put_into(&self, material: ModelMaterial, picture: Option<PictureUse>) -> ModelMaterial {
        let [r, g, b, a] = self.diffuse_factor.map(share);
        let specular = self.specular_factor.map(share);
        let largest = specular.into_iter().fold(0.0, f32::max);
        // Beyond what the largest index reflects it is a metal of that colour.
        let root = largest.sqrt();
        let eta = (1.0 + root) / (1.0 - root).max(1e-3);
        let is_metal = eta > LARGEST_ETA;
        ModelMaterial {
            base_color: if is_metal { specular } else { [r, g, b] },
            picture: picture.filter(|_| !is_metal),
            metal_and_roughness: None,
            opacity: a,
            metallic: f32::from(u8::from(is_metal)),
            roughness: 1.0 - share(self.glossiness_factor),
            eta: if is_metal { 1.5 } else { eta },
            specular: ModelTint {
                color: specular.map(|x| if largest > 0.0 { x / largest } else { 0.0 }),
                picture: None,
            },
            ..material
        }
    }
}

impl Volume {
    fn absorption(&self) -> Option<[f32; 3]> {
        let distance = self.attenuation_distance;
        let is_clear = !(distance > 0.0 && distance.is_finite());
        let absorption = |c: f32| if is_clear { 0.0 } else { -share(c).max(LEAST_COLOR).ln() / distance };
        (self.thickness_factor > 0.0).then(|| self.attenuation_color.map(absorption))
    }
}

impl TextureInfo {
    /// The number of its set of coordinates.
    fn set(&self) -> u32 {
        self.extensions.transform.tex_coord.unwrap_or(self.tex_coord)
    }

    fn shown(&self, sets: &Sets, textures: &[Texture], samplers: &[Sampler]) -> Option<PictureUse> {
        // The numbers of OpenGL.
        const CLAMP: u32 = 33071;
        const MIRROR: u32 = 33648;
        const NEAREST: [u32; 3] = [9728, 9984, 9986];
        let texture = textures.get(self.index)?;
        let sampler = texture.sampler.and_then(|i| samplers.get(i));
        let wrap = |code: Option<u32>| match code {
            Some(CLAMP) => PictureWrap::Clamp,
            Some(MIRROR) => PictureWrap::Mirror,
            _ => PictureWrap::Repeat,
        };
        let wrap = [sampler.and_then(|s| s.wrap_s), sampler.and_then(|s| s.wrap_t)].map(wrap);
        // There are no smaller copies of pictures here, so the filter for those counts where there is no other.
        let filter = sampler.and_then(|sampler| sampler.mag_filter.or(sampler.min_filter));
        let nearest = filter.is_some_and(|filter| NEAREST.contains(&filter));
        let TextureTransform { offset: [x, y], rotation, scale: [across, down], .. } =
            self.extensions.transform;
        // The extension turns about the upper left corner. Here the second coordinate points upwards.
        let (sin, cos) = fmath::sin_cos(rotation);
        Some(PictureUse {
            picture: texture.source()?,
            wrap,
            nearest,
            set: sets.find(self.set())?,
            repeat: [cos * across, cos * down],
            cross: [-sin * down, sin * across],
            offset: [x + sin * down, 1.0 - cos * down - y],
        })
    }
}

/// A number held to [0, 1].
fn share(x: f32) -> f32 {
    x.clamp(0.0, 1.0)
}
