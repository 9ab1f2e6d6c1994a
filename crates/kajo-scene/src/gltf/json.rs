//! The JSON of a glTF file, as far as it is read. Names are those of the specification.

use super::{ModelCover, ModelMaterial, PictureUse, PictureWrap};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use std::sync::Arc;

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Document {
    pub asset: Asset,
    pub extensions_required: Vec<String>,
    pub extensions: Option<DocumentExtensions>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub samplers: Vec<Sampler>,
    pub cameras: Vec<IgnoredAny>,
    pub animations: Vec<IgnoredAny>,
    pub skins: Vec<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    pub version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct DocumentExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: Option<Lights>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Lights {
    pub lights: Vec<IgnoredAny>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Scene {
    pub nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub name: Option<Arc<str>>,
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    /// Column by column.
    pub matrix: Option<Box<[f64; 16]>>,
    pub translation: Option<[f64; 3]>,
    /// A quaternion x, y, z, w.
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub extensions: Option<Box<NodeExtensions>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instancing {
    pub attributes: BTreeMap<String, usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub name: Option<Arc<str>>,
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    #[serde(default = "triangles")]
    pub mode: u32,
    #[serde(default)]
    pub targets: Vec<IgnoredAny>,
}

fn triangles() -> u32 {
    4
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: usize,
    pub r#type: String,
    pub sparse: Option<Box<Sparse>>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub count: usize,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Texture {
    pub source: Option<usize>,
    pub sampler: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Image {
    pub uri: Option<String>,
    pub buffer_view: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Sampler {
    pub wrap_s: Option<u32>,
    pub mag_filter: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct TextureInfo {
    pub index: usize,
    pub tex_coord: u32,
    /// Of normals only.
    pub scale: f32,
}

impl Default for TextureInfo {
    fn default() -> Self {
        TextureInfo { index: 0, tex_coord: 0, scale: 1.0 }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Material {
    pub name: Option<String>,
    pub pbr_metallic_roughness: MetallicRoughness,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<IgnoredAny>,
    pub emissive_texture: Option<TextureInfo>,
    pub emissive_factor: [f32; 3],
    pub double_sided: bool,
    pub alpha_mode: AlphaMode,
    pub alpha_cutoff: Option<f32>,
    pub extensions: MaterialExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub emissive_strength: EmissiveStrength,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct EmissiveStrength {
    pub emissive_strength: f32,
}

impl Default for EmissiveStrength {
    fn default() -> Self {
        EmissiveStrength { emissive_strength: 1.0 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct MetallicRoughness {
    pub base_color_factor: [f32; 4],
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: f32,
    pub roughness_factor: f32,
    pub metallic_roughness_texture: Option<TextureInfo>,
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
pub(super) enum AlphaMode {
    #[default]
    Opaque,
    Mask,
    Blend,
}

impl Material {
    /// Whether there are textures that are not shown: of occlusion, and those with other coordinates.
    pub fn has_unused_textures(&self) -> bool {
        let pbr = &self.pbr_metallic_roughness;
        let of_base = [&pbr.base_color_texture, &pbr.metallic_roughness_texture];
        let others = [&self.normal_texture, &self.emissive_texture];
        of_base.into_iter().chain(others).flatten().any(|texture| texture.tex_coord != 0)
            || self.occlusion_texture.is_some()
    }

    /// The material with its textures.
    pub fn understood(&self, textures: &[Texture], samplers: &[Sampler]) -> ModelMaterial {
        let pbr = &self.pbr_metallic_roughness;
        let [r, g, b, a] = pbr.base_color_factor.map(|x| x.clamp(0.0, 1.0));
        let picture = |info: &Option<TextureInfo>| picture(info.as_ref()?, textures, samplers);
        let strength = self.extensions.emissive_strength.emissive_strength;
        let scale = self.normal_texture.as_ref().map_or(1.0, |info| info.scale);
        ModelMaterial {
            name: self.name.clone(),
            base_color: [r, g, b],
            picture: picture(&pbr.base_color_texture),
            metal_and_roughness: picture(&pbr.metallic_roughness_texture),
            normals: picture(&self.normal_texture).map(|picture| (picture, scale)),
            opacity: a,
            cover: match self.alpha_mode {
                AlphaMode::Opaque => ModelCover::Everything,
                AlphaMode::Mask => ModelCover::FromOn(self.alpha_cutoff.unwrap_or(0.5)),
                AlphaMode::Blend => ModelCover::Share,
            },
            metallic: pbr.metallic_factor.clamp(0.0, 1.0),
            roughness: pbr.roughness_factor.clamp(0.0, 1.0),
            emissive: self.emissive_factor.map(|x| (x * strength).max(0.0)),
            emissive_picture: picture(&self.emissive_texture),
            two_sided: self.double_sided,
        }
    }
}

fn picture(info: &TextureInfo, textures: &[Texture], samplers: &[Sampler]) -> Option<PictureUse> {
    // The numbers of OpenGL.
    const CLAMP: u32 = 33071;
    const MIRROR: u32 = 33648;
    const NEAREST: u32 = 9728;
    let texture = textures.get(info.index).filter(|_| info.tex_coord == 0)?;
    let sampler = texture.sampler.and_then(|i| samplers.get(i));
    let wrap = match sampler.and_then(|sampler| sampler.wrap_s) {
        Some(CLAMP) => PictureWrap::Clamp,
        Some(MIRROR) => PictureWrap::Mirror,
        _ => PictureWrap::Repeat,
    };
    let nearest = sampler.and_then(|sampler| sampler.mag_filter) == Some(NEAREST);
    Some(PictureUse { picture: texture.source?, wrap, nearest })
}
