//! `Model` blocks: whole models from glTF files.
//!
//! A model is a definition that a file holds: its parts are placed like those of a `Define` block, and
//! read once however often the model is placed.

use std::collections::HashMap;
use std::rc::Rc;

use kajo_math::keyed::Outside;
use kajo_math::{Motion, Vec2, Vec3, Vec4};
use kajo_scene::{
    AssetFile, Corners, Diagnostic, Item, Model, ModelAnimation, ModelCamera, ModelInstance, ModelLight,
    ModelMoment, ModelPart, Span, read_gltf_at,
};

use super::Compiler;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::mesh::{corner_colors, corner_values};
use super::model_beads::{BeadMaterials, BeadRadii, Stored};
use super::model_files::{ModelFiles, RecordedAssets};
use super::model_material::ModelPictures;
use super::part::{Part, Parts};
use super::subdivision::{ReadFaces, Subdivision};
use crate::animation::AnimatedModel;
use crate::ids::LightGroup;
use crate::material::MaterialId;
use crate::nested::PartContent;
use crate::shape::{MeshData, VertexAttributes};

/// Models read so far.
pub(super) type ModelCache = HashMap<ModelKey, Option<CompiledModel>>;

/// What makes two models the same.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct ModelKey {
    path: String,
    smooth: bool,
    own_materials: bool,
    /// Bits of the radii of points and lines.
    radii: [Option<u32>; 2],
    subdivision: Option<Subdivision>,
    /// Which animation, the bits of its time, and whether it begins again; `None` for the model at rest.
    moment: Option<(Option<String>, u64, bool)>,
}

/// A model that has been read.
#[derive(Clone)]
pub(super) struct CompiledModel {
    parts: Parts,
    lights: Rc<[ModelLight]>,
    cameras: Rc<[ModelCamera]>,
    animation: Option<ModelAnimation>,
}

/// A model as a block asks for it.
pub(super) struct ModelRequest {
    /// The name of its file.
    pub name: String,
    /// Where that is named.
    pub at: Span,
    pub smooth: bool,
    pub own_materials: bool,
    pub radii: BeadRadii,
    pub lights: bool,
    pub light_scale: f32,
    pub group: LightGroup,
    /// Whether and how its meshes are subdivided.
    pub subdivision: Option<Subdivision>,
    /// The name of its animation, or its number.
    pub animation: Option<String>,
    /// Seconds from its beginning.
    pub animation_time: Option<f32>,
    /// Whether it begins again when it is over.
    pub animation_repeat: bool,
}

impl Compiler<'_> {
    pub(super) fn model(
        &mut self,
        item: Item<'_>,
        keys: ModelRequest,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let ModelRequest { ref name, at, .. } = keys;
        let file = match self.assets.open(name, item.path()) {
            Ok(file) => file,
            Err(error) => {
                self.lacks_a_model = true;
                return self.cannot_read(name, &error.to_string(), at);
            }
        };
        let key = ModelKey {
            path: file.path.clone(),
            smooth: keys.smooth,
            own_materials: keys.own_materials,
            radii: [keys.radii.points, keys.radii.lines].map(|radius| radius.map(f32::to_bits)),
            subdivision: keys.subdivision,
            moment: self.moment_of(&keys),
        };
        let known = self.models.get(&key).cloned();
        let model = known.unwrap_or_else(|| {
            let model = self.read_model(file, &key, keys.radii, item, at);
            self.models.insert(key, model.clone());
            model
        });
        let Some(model) = model else {
            self.lacks_a_model = true;
            return;
        };
        self.place_parts(&model.parts, item, ctm, state);
        if let Some(animation) = model.animation.filter(|_| keys.animation_time.is_none()) {
            let ModelAnimation { name, key_times } = animation;
            self.animated_models.push(AnimatedModel { item: item.index(), name, key_times });
        }
        let lights = if keys.lights { &model.lights[..] } else { &[] };
        if state.parts.is_none() {
            self.model_lights(lights, (keys.light_scale, keys.group), ctm, item);
            self.list_model_cameras(&model.cameras, ctm);
        } else if !lights.is_empty() {
            let warning = Diagnostic::warning("the lights of a model within a `Define` block are left out");
            let help = "write `lights off`, or the model outside of the definition";
            self.diagnostics.push(warning.label(item.keyword_span(), "brings lights").help(help));
        }
    }

    /// When a model is shown, where it is to move.
    fn moment_of(&self, keys: &ModelRequest) -> Option<(Option<String>, u64, bool)> {
        let is_asked = keys.animation.is_some() || keys.animation_time.is_some();
        if !is_asked && self.animation.is_none() {
            return None;
        }
        let seconds = keys.animation_time.map_or(self.now(), f64::from);
        Some((keys.animation.clone(), seconds.to_bits(), keys.animation_repeat))
    }

    fn read_model(
        &mut self,
        file: AssetFile,
        key: &ModelKey,
        radii: BeadRadii,
        item: Item<'_>,
        at: Span,
    ) -> Option<CompiledModel> {
        let _reading = self.memory_for_file(&file, at)?;
        let (model, files) = self.read_file_of_model(file, key, at)?;
        self.warn_of_beads(&model, radii, &key.path, at);
        let pictures = ModelPictures { list: &model.pictures, path: &key.path, files: files.as_ref(), at };
        let mut materials: Vec<Option<MaterialId>> = Vec::new();
        for material in model.materials.iter().filter(|_| key.own_materials) {
            materials.push(self.model_material(material, &pictures));
            if !self.has_memory_for_materials(at) {
                return None;
            }
        }
        let mut bead_materials = BeadMaterials::new();
        let (mut triangles, mut flat) = (0, 0);
        let mut loses_attributes = false;
        let mut meshes: Vec<Vec<Stored>> = Vec::with_capacity(model.meshes.len());
        for parts in model.meshes {
            let mut stored = Vec::with_capacity(parts.len());
            for mut part in parts {
                if !key.own_materials {
                    (part.mesh.colors, part.mesh.face_colors) = (Vec::new(), Corners::Absent);
                }
                let material = part.material.and_then(|m| materials.get(m).copied().flatten());
                if part.points.is_empty() && part.segments.is_empty() {
                    let mut data = mesh_data(part, key.smooth);
                    if let Some(how) = key.subdivision {
                        loses_attributes |= !data.attributes.is_empty();
                        let read = ReadFaces { data, polygons: Vec::new() };
                        data = self.subdivided(read, how, None, (key.smooth, &key.path, at))?;
                    }
                    let mesh = self.built_once(data, &key.path, at)?;
                    (triangles, flat) = (triangles + mesh.triangle_count(), flat + mesh.dropped());
                    stored.push((self.shape(item, mesh)?, material));
                    continue;
                }
                let said = part.material.and_then(|m| model.materials.get(m));
                let beads =
                    self.beads(&part, radii, material.zip(said), &mut bead_materials, (&pictures, item))?;
                stored.extend(beads);
            }
            meshes.push(stored);
        }
        self.warn_of_losses([flat, triangles], loses_attributes, &key.path, at);
        let parts: Parts = self.model_parts(&model.instances, &meshes, item).into();
        self.parts_defined += parts.len();
        Some(CompiledModel {
            parts,
            lights: model.lights.into(),
            cameras: model.cameras.into(),
            animation: model.animation,
        })
    }

    /// What a file says, with warnings of what is left out, and how it is read again.
    fn read_file_of_model(
        &mut self,
        file: AssetFile,
        key: &ModelKey,
        at: Span,
    ) -> Option<(Model, Option<ModelFiles>)> {
        let moment = key.moment.clone().map(|(animation, seconds, repeats)| ModelMoment {
            animation,
            seconds: f64::from_bits(seconds),
            outside: if repeats { Outside::Loop } else { Outside::Hold },
        });
        let (assets, reopen) = (RecordedAssets::new(self.assets), file.reopen.clone());
        let model = match read_gltf_at(file, &assets, &self.options.limits, moment.as_ref()) {
            Ok(model) => model,
            Err(error) => {
                self.file_errors.push((error, at));
                return None;
            }
        };
        for sentence in &model.left_out {
            self.warn_of_file(&key.path, sentence, at);
        }
        if model.instances.is_empty() && model.lights.is_empty() && model.cameras.is_empty() {
            self.warn_of_file(&key.path, "it shows no meshes", at);
        }
        let files = reopen.and_then(|reopen| assets.files_of(reopen, &self.options.limits));
        Some((model, files))
    }

    /// Warns of what a model has lost on its way into the scene.
    ///
    /// * `flat`, `triangles`: how many triangles have no area, and how many there are
    fn warn_of_losses(
        &mut self,
        [flat, triangles]: [usize; 2],
        loses_attributes: bool,
        path: &str,
        at: Span,
    ) {
        if flat > 0 {
            let message = format!("{flat} of its {triangles} triangles have no area and are left out");
            self.warn_of_file(path, &message, at);
        }
        if loses_attributes {
            let message = "its second texture coordinates and tangents are left out where it is subdivided";
            self.warn_of_file(path, message, at);
        }
    }

    /// Warns of points and lines that are not shown because no radius was given.
    fn warn_of_beads(&mut self, model: &Model, radii: BeadRadii, path: &str, at: Span) {
        let parts = || model.meshes.iter().flatten();
        let points: usize = parts().map(|part| part.points.len()).sum();
        let lines: usize = parts().map(|part| part.segments.len()).sum();
        let kinds = [(points, radii.points, "points"), (lines, radii.lines, "lines")];
        for (count, _, what) in kinds.into_iter().filter(|(count, radius, _)| *count > 0 && radius.is_none())
        {
            let message = format!("left out: {count} {what}; `{what} RADIUS` shows them");
            self.warn_of_file(path, &message, at);
        }
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
            let label = self.scene.label(instance.name.clone(), "Model", item.index());
            let map = Motion::still(instance.model_from_mesh);
            parts.extend(meshes[instance.mesh].iter().map(|&(shape, material)| Part {
                content: PartContent::Shape(shape),
                map: map.clone(),
                material,
                label,
            }));
        }
        parts
    }
}

fn mesh_data(part: ModelPart, smooth: bool) -> MeshData {
    let attributes = VertexAttributes {
        second_uvs: part.second_uvs.into_iter().map(Vec2::from).collect(),
        tangents: part.tangents.into_iter().map(Vec4::from).collect(),
    };
    let mesh = part.mesh;
    let normal = |n: [f32; 3]| Vec3::from(n).normalize_or_zero();
    let normals = if smooth { corner_values(mesh.normals, mesh.face_normals, normal) } else { None };
    MeshData {
        positions: mesh.positions.into_iter().map(Vec3::from).collect(),
        faces: mesh.faces,
        normals,
        uvs: corner_values(mesh.uvs, mesh.face_uvs, Vec2::from),
        colors: corner_colors(mesh.colors, mesh.face_colors, mesh.colors_are_srgb),
        attributes,
        material_slots: None,
    }
}
