//! `Model` blocks: whole models from glTF files.
//!
//! A model is a definition that a file holds: its parts are placed like those of a `Define` block, and
//! read once however often the model is placed.

use std::collections::HashMap;

use kajo_color::{Emission, Reflectance, Spectrum};
use kajo_math::{Motion, Vec2, Vec3};
use kajo_scene::{
    Args, AssetFile, Item, ModelCover, ModelInstance, ModelMaterial, ModelPart, PictureSource, PictureUse,
    PictureWrap, Span, read_gltf,
};

use super::Compiler;
use super::definition::{Part, Parts};
use super::emitters::Glow;
use super::group::{Place, Walk};
use super::mesh::{corner_values, file_name};
use crate::bsdf::Phong;
use crate::family::Pooled;
use crate::light::Sides;
use crate::material::{Embossed, LayeredMaterial, Layers, MaterialId, PhongMaterial, Relief};
use crate::nested::Content;
use crate::shape::{MeshData, ShapeId};
use crate::texture::{Channel, Encoding, Paint, PictureMap, Share, TexelFilter, Wrap};

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
        let materials: Vec<Option<MaterialId>> = match key.own_materials {
            true => model
                .materials
                .iter()
                .map(|material| self.model_material(material, &model.pictures, &key.path, at))
                .collect(),
            false => Vec::new(),
        };
        let mut meshes: Vec<Vec<Stored>> = Vec::with_capacity(model.meshes.len());
        for parts in model.meshes {
            let mut stored = Vec::with_capacity(parts.len());
            for part in parts {
                let material = part.material.and_then(|m| materials.get(m).copied().flatten());
                let shape = self.build_mesh(mesh_data(part, key.smooth), &key.path, item, at)?;
                stored.push((shape, material));
            }
            meshes.push(stored);
        }
        let parts: Parts = self.model_parts(&model.instances, &meshes, item).into();
        self.parts_defined += parts.len();
        Some(parts)
    }

    /// A material of layers, with relief and holes where the file has them; the classic integrator sees its colour.
    fn model_material(
        &mut self,
        material: &ModelMaterial,
        pictures: &[Option<PictureSource>],
        path: &str,
        at: Span,
    ) -> Option<MaterialId> {
        let mut map = |shown: Option<PictureUse>, encoding| {
            shown.and_then(|shown| self.model_picture(shown, encoding, pictures, path, at))
        };
        let amounts = Some(Encoding::Linear);
        let color = map(material.picture, None);
        let metal_and_rough = map(material.metal_and_roughness, amounts);
        let slide = map(material.emissive_picture, None);
        let normals = material.normals.and_then(|(shown, scale)| Some((map(Some(shown), amounts)?, scale)));

        let ModelMaterial { base_color: base @ [r, g, b], metallic, roughness, .. } = *material;
        let opacity = opacity(material, color.as_ref());
        let paint = match &color {
            Some(map) => Paint::Picture(PictureMap { factor: [r, g, b, 1.0], ..map.clone() }),
            None => Reflectance::from_rgb(base).into(),
        };
        let share = |channel: Channel, value: f32| match &metal_and_rough {
            Some(map) => Share::Picture(PictureMap { factor: [value; 4], ..map.clone() }, channel),
            None => value.into(),
        };
        let layers = Layers {
            color: paint,
            metalness: share(Channel::Blue, metallic),
            roughness: share(Channel::Green, roughness),
            ..Layers::default()
        };
        let look = PhongMaterial::from(phong(material)).with_picture(color);
        let mut id = LayeredMaterial::from(layers).with_look(look).store(&mut self.materials)?;
        if let Some((map, scale)) = normals {
            let relief = Relief::Normals { map, scale };
            id = Embossed { material: id, relief }.store(&mut self.materials)?;
        }
        let even = Glow::even(Emission::from_rgb(material.emissive));
        let sides = if material.two_sided { Sides::Both } else { Sides::Front };
        let glow = even.map(|glow| slide.into_iter().fold(glow.on(sides), Glow::through));
        self.lit_and_cut(id, glow, opacity)
    }

    /// A picture that a material shows; one that cannot be read is left out.
    fn model_picture(
        &mut self,
        shown: PictureUse,
        encoding: Option<Encoding>,
        pictures: &[Option<PictureSource>],
        path: &str,
        at: Span,
    ) -> Option<PictureMap> {
        let PictureUse { picture: number, wrap, nearest } = shown;
        let map = match pictures.get(number)?.as_ref()? {
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
        Some(PictureMap { wrap, filter, ..map })
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

fn mesh_data(part: ModelPart, smooth: bool) -> MeshData {
    let mesh = part.mesh;
    let normal = |n: [f32; 3]| Vec3::from(n).normalize_or_zero();
    let normals = if smooth { corner_values(mesh.normals, mesh.face_normals, normal) } else { None };
    MeshData {
        positions: mesh.positions.into_iter().map(Vec3::from).collect(),
        faces: mesh.faces,
        normals,
        uvs: corner_values(mesh.uvs, mesh.face_uvs, Vec2::from),
        material_slots: None,
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

/// The opaque Phong material with the same colour.
fn phong(material: &ModelMaterial) -> Phong {
    let [r, g, b] = material.base_color;
    let diffuse = Spectrum::rgb(r, g, b);
    Phong { ambient: diffuse, diffuse, ..Phong::BLACK }
}
