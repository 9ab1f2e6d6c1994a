//! glTF 2.0 models: meshes, the nodes that place them, and their materials.
//!
//! A file is JSON with buffers beside it or within (`.gltf`), or both in one (`.glb`). A mesh that several
//! nodes show is read once [Khronos 2021, "glTF 2.0 Specification"]. Of extensions,
//! `EXT_mesh_gpu_instancing`, `KHR_mesh_quantization`, `KHR_texture_transform` and most of those of materials are read.
//!
//! ```text
//! scene -> nodes (a tree, each with a transform) -> mesh -> primitives -> accessors -> buffers
//! ```
//!
//! Nothing is taken on trust: every number is checked against what it points into, and the memory
//! that meshes may take is bounded by the bytes that were really read ([`Budget`]).

mod accessor;
mod container;
mod json;
mod material;
mod nodes;
mod primitive;

use self::container::Buffers;
use crate::assets::{AssetFile, Assets};
use crate::limits::Limits;
use crate::line_reader::MeshFileError;
use crate::tri_mesh::TriMesh;
use kajo_math::DAffine3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

pub use self::material::{ModelAmount, ModelCover, ModelMaterial, ModelTint, PictureUse, PictureWrap};

/// What a glTF file describes, as far as it is read.
#[derive(Debug, Default)]
pub struct Model {
    /// Every mesh that a node shows, and no others: its parts.
    pub meshes: Vec<Vec<ModelPart>>,
    /// Materials, in the order of the file.
    pub materials: Vec<ModelMaterial>,
    /// Pictures that materials use, in the order of the file; `None` for those that none does.
    pub pictures: Vec<Option<PictureSource>>,
    /// Where the meshes stand.
    pub instances: Vec<ModelInstance>,
    /// What the file has and nobody uses, one sentence each.
    pub left_out: Vec<String>,
}

/// Triangles of one material.
#[derive(Debug)]
pub struct ModelPart {
    /// The triangles. Texture coordinates have their origin at the lower left, unlike in the file.
    pub mesh: TriMesh,
    /// An index into [`Model::materials`].
    pub material: Option<usize>,
}

/// Where a picture is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PictureSource {
    /// In a file of this name, beside the model's.
    File(String),
    /// The content of such a file, which the model holds.
    Bytes(Vec<u8>),
}

/// A mesh at its place.
#[derive(Clone, Debug)]
pub struct ModelInstance {
    /// The name of the node, or else of its mesh.
    pub name: Option<Arc<str>>,
    /// An index into [`Model::meshes`].
    pub mesh: usize,
    /// From the mesh's space to the model's.
    pub model_from_mesh: DAffine3,
}

/// Reads a glTF file and, through `assets`, the buffers that it names.
///
/// # Errors
/// When the file or a buffer cannot be read, when something in it is malformed or points where nothing is,
/// when it needs an extension that is not known, or exceeds a limit.
pub fn read_gltf(file: AssetFile, assets: &dyn Assets, limits: &Limits) -> Result<Model, MeshFileError> {
    let path = file.path.clone();
    let container = container::read(file, limits)?;
    let document = container.document(&path)?;
    let wrong = |message: String| MeshFileError::Content { path: path.clone(), message };
    check_version(&document).map_err(wrong)?;
    check_extensions(&document).map_err(wrong)?;
    let buffers = Buffers::load(&document, &container, &path, assets, limits)?;
    let mut budget = Budget::new(buffers.bytes_read());
    let mut model = nodes::read(&document, &buffers, limits, &mut budget).map_err(wrong)?;
    let shown = nodes::renumber(&mut model.instances);
    let mut counts = primitive::Skipped::default();
    for mesh in shown {
        let parts = primitive::read_mesh(&document, &buffers, mesh, &mut budget, &mut counts);
        model.meshes.push(parts.map_err(|said| wrong(format!("meshes[{mesh}]: {said}")))?);
    }
    let understood =
        |material: &material::Material| material.understood(&document.textures, &document.samplers);
    model.materials = document.materials.iter().map(understood).collect();
    model.pictures = pictures(&document, &model.materials, &buffers, &mut budget).map_err(wrong)?;
    model.left_out.extend(counts.sentences());
    model.left_out.extend(left_out(&document));
    Ok(model)
}

/// Bytes that meshes may still take: a multiple of what was read, so that a short file that says the same
/// thing over and over cannot take more.
pub(crate) struct Budget {
    left: u64,
}

impl Budget {
    const FREE: u64 = 64 << 20;
    const FACTOR: u64 = 32;

    fn new(bytes_read: u64) -> Budget {
        Budget { left: Budget::FREE.saturating_add(bytes_read.saturating_mul(Budget::FACTOR)) }
    }

    /// Takes room for `count` values of a type.
    fn take<T>(&mut self, count: usize) -> Result<(), String> {
        let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
        self.left = self.left.checked_sub(bytes).ok_or("the meshes are out of all proportion to the file")?;
        Ok(())
    }
}

/// The pictures that the materials use.
fn pictures(
    document: &json::Document,
    materials: &[ModelMaterial],
    buffers: &Buffers<'_>,
    budget: &mut Budget,
) -> Result<Vec<Option<PictureSource>>, String> {
    let used: BTreeSet<usize> =
        materials.iter().flat_map(ModelMaterial::pictures).map(|p| p.picture).collect();
    let mut read = |(i, image): (usize, &json::Image)| {
        if !used.contains(&i) {
            return Ok(None);
        }
        picture(image, document, buffers, budget).map(Some).map_err(|said| format!("images[{i}]: {said}"))
    };
    document.images.iter().enumerate().map(&mut read).collect()
}

fn picture(
    image: &json::Image,
    document: &json::Document,
    buffers: &Buffers<'_>,
    budget: &mut Budget,
) -> Result<PictureSource, String> {
    if let Some(uri) = &image.uri {
        return match uri.strip_prefix("data:") {
            Some(data) => {
                budget.take::<u8>(data.len())?;
                container::decode_data(data)
                    .map(PictureSource::Bytes)
                    .ok_or("its `data:` uri is not in base64".to_owned())
            }
            None => container::percent_decoded(uri)
                .map(PictureSource::File)
                .ok_or("its name is not UTF-8".to_owned()),
        };
    }
    let view = image.buffer_view.ok_or("it has neither a `uri` nor a `bufferView`")?;
    let view = document.buffer_views.get(view).ok_or("there is no such `bufferView`")?;
    let end = view.byte_offset.checked_add(view.byte_length);
    let bytes = buffers.get(view.buffer).and_then(|buffer| buffer.get(view.byte_offset..end?));
    let bytes = bytes.ok_or("its `bufferView` reaches beyond its buffer")?;
    budget.take::<u8>(bytes.len())?;
    Ok(PictureSource::Bytes(bytes.to_vec()))
}

fn check_version(document: &json::Document) -> Result<(), String> {
    let version = &document.asset.version;
    match version.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(format!("this is glTF {version}; version 2 is read")),
    }
}

fn check_extensions(document: &json::Document) -> Result<(), String> {
    /// These change how things look or sound, not where they are.
    const HARMLESS: [&str; 4] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_audio"];
    const KNOWN: [&str; 4] =
        ["EXT_mesh_gpu_instancing", "KHR_lights_punctual", "KHR_mesh_quantization", "KHR_animation_pointer"];
    let is_known = |name: &str| KNOWN.contains(&name) || HARMLESS.iter().any(|start| name.starts_with(start));
    match document.extensions_required.iter().find(|name| !is_known(name)) {
        Some(name) => Err(format!("it needs the extension `{name}`, which is not supported")),
        None => Ok(()),
    }
}

fn left_out(document: &json::Document) -> Vec<String> {
    let lights = document.extensions.as_ref().and_then(|e| e.lights.as_ref()).map_or(0, |l| l.lights.len());
    let textured = document.materials.iter().filter(|material| material.has_unused_textures()).count();
    let list = [
        (document.cameras.len(), "cameras"),
        (lights, "lights"),
        (document.animations.len(), "animations"),
        (document.skins.len(), "skins"),
        (textured, "materials with textures that are not shown"),
    ];
    let used = list.into_iter().filter(|&(count, _)| count > 0);
    let counted = used.map(|(count, what)| format!("left out: {count} {what}"));
    let mut unknown = BTreeMap::<&str, usize>::new();
    for name in document.materials.iter().flat_map(material::Material::unknown_extensions) {
        *unknown.entry(name).or_default() += 1;
    }
    let unknown = unknown.into_iter().map(|(name, count)| format!("left out: `{name}` of {count} materials"));
    counted.chain(unknown).collect()
}

#[cfg(test)]
mod tests;
