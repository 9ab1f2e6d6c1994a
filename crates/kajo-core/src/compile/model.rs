//! `Model` blocks: whole models from glTF files.
//!
//! A model is a definition that a file holds: its parts are placed like those of a `Define` block, and
//! read once however often the model is placed.

use std::collections::HashMap;

use kajo_math::{Motion, Vec2, Vec3};
use kajo_scene::{Args, AssetFile, Corners, Item, ModelInstance, ModelPart, Span, read_gltf};

use super::Compiler;
use super::definition::{Part, Parts};
use super::group::{Place, Walk};
use super::mesh::{corner_colors, corner_values, file_name};
use super::model_material::ModelPictures;
use crate::material::MaterialId;
use crate::nested::Content;
use crate::shape::{MeshData, ShapeId};

/// Models read so far.
pub(super) type ModelCache = HashMap<ModelKey, Option<Parts>>;

/// What makes two models the same.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct ModelKey {
    path: String,
    smooth: bool,
    own_materials: bool,
}

/// A part of a mesh: the triangles and their material.
type Stored = (ShapeId, Option<MaterialId>);

impl Compiler<'_> {
    pub(super) fn model(&mut self, item: Item<'_>, place: &mut Place, walk: &mut Walk) {
        let read = self.read(item, |params| {
            params.name();
            let file = file_name(params, "file");
            let smooth = params.or("smooth", true, Args::flag);
            let own_materials = params.or("materials", true, Args::flag);
            Some((file?, smooth, own_materials))
        });
        let Some(((name, at), smooth, own_materials)) = read else { return };
        let file = match self.assets.open(&name, item.path()) {
            Ok(file) => file,
            Err(error) => return self.cannot_read(&name, &error.to_string(), at),
        };
        let key = ModelKey { path: file.path.clone(), smooth, own_materials };
        let known = self.models.get(&key).cloned();
        let definition = known.unwrap_or_else(|| {
            let definition = self.read_model(file, &key, item, at);
            self.models.insert(key, definition.clone());
            definition
        });
        if let Some(definition) = definition {
            self.place_parts(&definition, item, place, walk);
        }
    }

    fn read_model(&mut self, file: AssetFile, key: &ModelKey, item: Item<'_>, at: Span) -> Option<Parts> {
        let _reading = self.memory_for_file(&file, at)?;
        let model = match read_gltf(file, self.assets, &self.options.limits) {
            Ok(model) => model,
            Err(error) => {
                self.file_errors.push((error, at));
                return None;
            }
        };
        for sentence in &model.left_out {
            self.warn_of_file(&key.path, sentence, at);
        }
        if model.instances.is_empty() {
            self.warn_of_file(&key.path, "it shows no meshes", at);
        }
        let pictures = ModelPictures { list: &model.pictures, path: &key.path, at };
        let own = model.materials.iter().filter(|_| key.own_materials);
        let materials: Vec<Option<MaterialId>> =
            own.map(|material| self.model_material(material, &pictures)).collect();
        let mut meshes: Vec<Vec<Stored>> = Vec::with_capacity(model.meshes.len());
        for parts in model.meshes {
            let mut stored = Vec::with_capacity(parts.len());
            for part in parts {
                let material = part.material.and_then(|m| materials.get(m).copied().flatten());
                let shape = self.build_mesh(mesh_data(part, key), &key.path, item, at)?;
                stored.push((shape, material));
            }
            meshes.push(stored);
        }
        let parts: Parts = self.model_parts(&model.instances, &meshes, item).into();
        self.parts_defined += parts.len();
        Some(parts)
    }

    fn model_parts(
        &mut self,
        instances: &[ModelInstance],
        meshes: &[Vec<Stored>],
        item: Item<'_>,
    ) -> Vec<Part> {
        let sizes = instances.iter().map(|instance| meshes[instance.mesh].len());
        let count = sizes.fold(0usize, usize::saturating_add);
        if !self.has_room(count, item.head_span(), 0) {
            return Vec::new();
        }
        let mut parts = Vec::with_capacity(count);
        for instance in instances {
            let label = self.objects.label(instance.name.clone(), "Model", item.index());
            let map = Motion::still(instance.model_from_mesh);
            parts.extend(meshes[instance.mesh].iter().map(|&(shape, material)| Part {
                content: Content::Shape(shape),
                map: map.clone(),
                material,
                label,
                brings_materials: false,
            }));
        }
        parts
    }
}

fn mesh_data(part: ModelPart, key: &ModelKey) -> MeshData {
    let mesh = part.mesh;
    let colors = if key.own_materials { mesh.face_colors } else { Corners::Absent };
    let normal = |n: [f32; 3]| Vec3::from(n).normalize_or_zero();
    let normals = if key.smooth { corner_values(mesh.normals, mesh.face_normals, normal) } else { None };
    MeshData {
        positions: mesh.positions.into_iter().map(Vec3::from).collect(),
        faces: mesh.faces,
        normals,
        uvs: corner_values(mesh.uvs, mesh.face_uvs, Vec2::from),
        colors: corner_colors(mesh.colors, colors, mesh.colors_are_srgb),
        material_slots: None,
    }
}
