//! glTF 2.0 models: meshes, the nodes that place them, and their materials.
//!
//! A file is JSON with buffers beside it or within (`.gltf`), or both in one (`.glb`). A mesh that several
//! nodes show is read once [Khronos 2021, "glTF 2.0 Specification"]; one with a skin or targets of morphs has the shape
//! that it has at rest, or at a moment of an animation. Of extensions, `EXT_mesh_gpu_instancing`, `EXT_meshopt_compression`, `KHR_lights_punctual`,
//! `KHR_mesh_quantization`, `KHR_texture_transform` and most of those of materials are read.
//!
//! ```text
//! scene -> nodes (a tree, each with a transform) -> mesh -> primitives -> accessors -> buffers
//! ```
//!
//! Nothing is taken on trust: every number is checked against what it points into, and the memory
//! that meshes may take is bounded by the bytes that were really read ([`Budget`]).

mod accessor;
mod animation;
mod camera;
mod container;
mod json;
mod light;
mod material;
mod meshopt;
mod nodes;
mod picture;
mod primitive;
mod skin;
mod texture;

use self::container::Buffers;
use self::skin::Poses;
use crate::assets::{AssetFile, Assets};
use crate::limits::Limits;
use crate::memory_budget::OverBudget;
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
use crate::tri_mesh::TriMesh;
use kajo_math::DAffine3;
use std::collections::BTreeMap;
use std::sync::Arc;

pub use self::animation::{ModelAnimation, ModelMoment};
pub use self::camera::{ModelCamera, ModelView};
pub use self::light::{ModelLight, ModelLightKind};
pub use self::material::{
    CoordinateSet, ModelAmount, ModelCover, ModelGlossiness, ModelMaterial, ModelTint, PictureUse,
    PictureWrap, VertexColors,
};
pub use self::picture::{PictureSource, read_gltf_picture};

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
    /// Lights, in the order in which nodes are met.
    pub lights: Vec<ModelLight>,
    /// Cameras, likewise.
    pub cameras: Vec<ModelCamera>,
    /// The animation that it was posed by, if it was.
    pub animation: Option<ModelAnimation>,
    /// What the file has that is not supported, one sentence each.
    pub left_out: Vec<String>,
}

/// Triangles, lines or points of one material.
#[derive(Debug, Default)]
pub struct ModelPart {
    /// The triangles. Texture coordinates have their origin at the lower left, unlike in the file; colours are linear, and
    /// there are none where all are white.
    pub mesh: TriMesh,
    /// Ends of lines, as vertices of the mesh.
    pub segments: Vec<[u32; 2]>,
    /// Vertices of the mesh that are points.
    pub points: Vec<u32>,
    /// An index into [`Model::materials`].
    pub material: Option<usize>,
    /// A second set of texture coordinates, one for each vertex; empty where the material asks for none.
    pub second_uvs: Vec<[f32; 2]>,
    /// For each vertex the direction in which the first texture coordinate grows, and the sign of the cross product of normal
    /// and that as a direction in which the second one does; empty where the file has none or the material asks for none.
    pub tangents: Vec<[f32; 4]>,
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
    read_gltf_at(file, assets, limits, None)
}

/// As [`read_gltf`], with everything where an animation puts it at a moment, where one is asked for.
///
/// # Errors
/// As for [`read_gltf`], and when there is no such animation.
pub fn read_gltf_at(
    file: AssetFile,
    assets: &dyn Assets,
    limits: &Limits,
    moment: Option<&ModelMoment>,
) -> Result<Model, MeshFileError> {
    read_with(file, assets, limits, |document, buffers, budget| {
        model(document, buffers, limits, budget, moment)
    })
}

/// What `read` makes of the parts of a file.
fn read_with<T>(
    file: AssetFile,
    assets: &dyn Assets,
    limits: &Limits,
    read: impl FnOnce(&mut json::Document, &mut Buffers<'_>, &mut Budget) -> Result<T, String>,
) -> Result<T, MeshFileError> {
    let path = file.path.clone();
    let container = container::read(file, limits)?;
    let mut memory = ReadMemory::new(&limits.memory);
    let mut document = container.document(&path, limits, &mut memory)?;
    let wrong = |message: String| MeshFileError::Content { path: path.clone(), message };
    check_version(&document).map_err(wrong)?;
    check_extensions(&document).map_err(wrong)?;
    let mut buffers = Buffers::load(&document, &container, &path, assets, limits, &mut memory)?;
    let mut budget = Budget::new(buffers.bytes_read(), memory);
    read(&mut document, &mut buffers, &mut budget).map_err(|message| match budget.over {
        Some(over) => MeshFileError::memory(&path, over),
        None => wrong(message),
    })
}

fn model(
    document: &mut json::Document,
    buffers: &mut Buffers<'_>,
    limits: &Limits,
    budget: &mut Budget,
    moment: Option<&ModelMoment>,
) -> Result<Model, String> {
    budget.take::<ModelMaterial>(document.materials.len())?;
    buffers.decode(document, budget)?;
    let posed = moment.map(|moment| animation::pose(document, buffers, moment, budget)).transpose()?;
    let document = &*document;
    let tree = nodes::read(document, buffers, limits, budget)?;
    let mut poses = Poses::new(document, buffers);
    let mut counts = primitive::Skipped::default();
    let mut meshes = Vec::new();
    for &shown in &tree.shown {
        let pose = poses.of(shown, &tree, budget)?;
        let mesh = shown.mesh;
        let parts = primitive::read_mesh(document, buffers, mesh, &pose, budget, &mut counts);
        meshes.push(parts.map_err(|said| format!("meshes[{mesh}]: {said}"))?);
    }
    let failed = poses.failed();
    let mut model = Model { meshes, ..tree.model };
    let understood =
        |material: &material::Material| material.understood(&document.textures, &document.samplers);
    model.materials = document.materials.iter().map(understood).collect();
    color_materials(&mut model);
    model.pictures = picture::pictures(document, &model.materials, buffers, budget)?;
    model.left_out.extend(counts.sentences());
    model.left_out.extend(left_out(document, posed.is_none()));
    if let Some(posed) = posed {
        model.animation = posed.animation;
        model.left_out.extend(posed.left_out);
    }
    if failed > 0 {
        model.left_out.push(format!("left out: {failed} skins with joints that are not in the scene"));
    }
    Ok(model)
}

/// Bytes that a model may still take: a multiple of what was read, so that a short file that says the same
/// thing over and over cannot take more, and what the scene has left.
pub(crate) struct Budget {
    left: u64,
    memory: ReadMemory,
    /// What the scene had too little for.
    over: Option<OverBudget>,
}

impl Budget {
    const FREE: u64 = 64 << 20;
    const FACTOR: u64 = 32;

    /// * `memory`: taken for reading so far
    fn new(bytes_read: u64, memory: ReadMemory) -> Budget {
        let left = Budget::FREE.saturating_add(bytes_read.saturating_mul(Budget::FACTOR));
        Budget { left, memory, over: None }
    }

    /// Takes room for `count` values of a type.
    fn take<T>(&mut self, count: usize) -> Result<(), String> {
        let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
        self.left =
            self.left.checked_sub(bytes).ok_or("what it holds is out of all proportion to its length")?;
        self.memory.take(usize::try_from(bytes).unwrap_or(usize::MAX)).map_err(|over| {
            self.over = Some(over);
            over.to_string()
        })
    }
}

/// Tells materials of the colours at the vertices that they are seen on, and gives the standard's own one to coloured parts
/// without any.
fn color_materials(model: &mut Model) {
    let plain = model.materials.len();
    let mut needs_plain = false;
    for part in model.meshes.iter_mut().flatten().filter(|part| !part.mesh.colors.is_empty()) {
        let number = *part.material.get_or_insert(plain);
        if number == plain && !std::mem::replace(&mut needs_plain, true) {
            model.materials.push(material::Material::default().understood(&[], &[]));
        }
        let is_clear = part.mesh.colors.iter().any(|color| color[3] < 1.0);
        let found = if is_clear { VertexColors::ColorAndOpacity } else { VertexColors::Color };
        let known = &mut model.materials[number].vertex_colors;
        *known = found.max(*known);
    }
}

fn check_version(document: &json::Document) -> Result<(), String> {
    let version = &document.asset.version;
    match version.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(container::unread_version(version)),
    }
}

fn check_extensions(document: &json::Document) -> Result<(), String> {
    /// These change how things look or sound, not where they are.
    const HARMLESS: [&str; 5] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_audio", "KHR_xmp"];
    const KNOWN: [&str; 9] = [
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "KHR_animation_pointer",
        "KHR_lights_punctual",
        "KHR_mesh_quantization",
        "KHR_meshopt_compression",
        "KHR_node_visibility",
        // Materials of converted files of version 1.
        "KHR_technique_webgl",
        "KHR_techniques_webgl",
    ];
    let is_known = |name: &str| KNOWN.contains(&name) || HARMLESS.iter().any(|start| name.starts_with(start));
    match document.extensions_required.iter().find(|name| !is_known(name)) {
        Some(name) if name == "KHR_draco_mesh_compression" => Err(format!(
            "its meshes are compressed by `{name}`, which is not supported: `gltf-transform copy OLD NEW` writes them plainly"
        )),
        Some(name) => Err(format!("it needs the extension `{name}`, which is not supported")),
        None => Ok(()),
    }
}

/// * `is_at_rest`: whether its animations count for nothing
fn left_out(document: &json::Document, is_at_rest: bool) -> Vec<String> {
    let textured = document.materials.iter().filter(|material| material.has_unused_textures()).count();
    let animations = if is_at_rest { document.animations.len() } else { 0 };
    let list = [(animations, "animations"), (textured, "materials with textures that are not shown")];
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
