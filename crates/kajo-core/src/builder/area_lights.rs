//! Objects that give light: each patch of their surfaces becomes a light of its own.

use std::collections::HashMap;
use std::sync::Arc;

use kajo_color::Emission;
use kajo_math::{Affine3A, DAffine3, DMat3};
use kajo_scene::OverBudget;

use super::SceneBuilder;
use super::emission_density::EmissivePatch;
use super::frames::Frames;
use crate::background::Background;
use crate::emission::VariedEmission;
use crate::family::Pooled;
use crate::ids::{FrameId, LightGroup, LightIndex, ObjectId, PoseId, VariedEmissionId};
use crate::light::{AreaLight, LightSampler, PatchExtent, Sides, SkyLight};
use crate::material::MaterialId;
use crate::motion::MovingTransform;
use crate::scene::Primitive;
use crate::shape::Patch;

/// Memory of a light: itself, and its places in the lists and the tree by which lights are chosen.
const BYTES_PER_LIGHT: usize = size_of::<AreaLight>() + 96;

/// The emission of the material of patches.
struct PatchEmission {
    /// The radiance, or its mean.
    emission: Emission,
    /// Where it varies.
    varied: Option<VariedEmissionId>,
    sides: Sides,
    /// Whether light of the side turned away passes through the one that is turned to the receiver.
    seen_through: bool,
    group: LightGroup,
}

/// The materials and positions of patches.
struct Emissive {
    materials: HashMap<MaterialId, PatchEmission>,
    varied: Vec<VariedEmission>,
    /// How objects that move have moved since the shutter opened.
    drifts: HashMap<PoseId, Arc<MovingTransform>>,
}

impl SceneBuilder {
    /// Makes the lights of all emissive objects, and marks these; returns the light that varies.
    pub(super) fn area_lights(&mut self) -> Result<Vec<VariedEmission>, OverBudget> {
        let mut emissive = self.emissive();
        if emissive.materials.is_empty() {
            return Ok(emissive.varied);
        }
        for i in 0..self.geometry.primitives.len() {
            let primitive = self.geometry.primitives[i];
            if !self.emits(&primitive) {
                continue;
            }
            let lights = self.patches_of(ObjectId::from_index(i as u32), &primitive, &mut emissive);
            let densities = lights.iter().filter_map(|(light, _)| Some(light.density.as_ref()?.bytes()));
            let bytes = densities.sum::<usize>() + lights.len() * BYTES_PER_LIGHT;
            self.limits.memory.take(bytes as u64)?;
            self.geometry.primitives[i].emits = !lights.is_empty();
            for (light, group) in lights {
                let id = light.store(&mut self.lights);
                self.light_list.extend(id.map(|id| (id, group)));
            }
        }
        Ok(emissive.varied)
    }

    /// Whether any object would give light if it had an end.
    pub(crate) fn has_unbounded_emitters(&self) -> bool {
        let is_unbounded = |primitive: &Primitive| {
            let bounds = self.geometry.shapes.bounds(primitive.shape);
            !bounds.is_finite() && !bounds.is_empty()
        };
        self.geometry.primitives.iter().any(|primitive| self.emits(primitive) && is_unbounded(primitive))
    }

    /// What an object is that would give light if there were patches to draw it from.
    pub(crate) fn emitter_without_patches(&self) -> Option<&'static str> {
        let shapes = &self.geometry.shapes;
        let emitters = self.geometry.primitives.iter().filter(|primitive| self.emits(primitive));
        emitters.map(|primitive| shapes.without_patches(primitive.shape)).find_map(|what| what)
    }

    /// Whether the material of an object, or one of its own, gives light.
    fn emits(&self, primitive: &Primitive) -> bool {
        self.is_emissive(primitive.material) || self.own_materials_of(primitive.shape).emit
    }

    /// The patches of an emissive object, and the group of each.
    fn patches_of(
        &self,
        object: ObjectId,
        primitive: &Primitive,
        emissive: &mut Emissive,
    ) -> Vec<(AreaLight, LightGroup)> {
        let &Primitive { shape, pose, material, .. } = primitive;
        let shapes = &self.geometry.shapes;
        let (map, drift) = self.start(pose, &mut emissive.drifts);
        let object_from_world = map.inverse();
        let mut n_patches = 0;
        if !emissive.varied.is_empty() {
            shapes.patches(shape, &mut |_, _| n_patches += 1);
        }
        let mut lights = Vec::new();
        shapes.patches(shape, &mut |part, patch| {
            let slot = shapes.material_slot(shape, part);
            let material = slot.map_or(material, |slot| self.appearance.slots[slot.index()]);
            let Some(of_material) = emissive.materials.get(&material) else { return };
            let &PatchEmission { ref emission, varied, sides, seen_through, group } = of_material;
            // The far side of a sphere, too, which is drawn otherwise by what one sees of it from outside.
            let patch = match patch {
                Patch::Sphere { .. } if seen_through => patch.by_area(),
                _ => Some(patch),
            };
            let Some(patch) = patch else { return };
            let patch = if pose.is_identity() { Some(patch) } else { patch.transformed(&map) };
            let drift = match shapes.part_motion(shape, part) {
                Some(inner) => Some(Arc::new(self.drift_of_part(pose, inner))),
                None => drift.clone(),
            };
            let patch = match &drift {
                Some(drift) => patch.and_then(|patch| patch.movable(drift.sampled_maps())),
                None => patch,
            };
            let Some(patch) = patch.filter(|patch| patch.area() > 0.0) else { return };
            let (emission, density) = match varied {
                None => (emission.clone(), None),
                Some(varied) => {
                    let varied = &emissive.varied[varied.index()];
                    let patch = EmissivePatch { varied, shape, part, patch: &patch, object_from_world };
                    self.emission_of_patch(emission, &patch, n_patches)
                }
            };
            let extent = match (shapes.is_partial(shape), shapes.is_inverted(shape, part)) {
                (false, _) => PatchExtent::Whole,
                (true, false) => PatchExtent::Part,
                (true, true) => PatchExtent::InvertedPart,
            };
            let light = AreaLight { patch, drift, emission, varied, density, sides, extent, object, part };
            lights.push((light, group));
        });
        lights
    }

    /// What patches have to know, of every material that gives light.
    fn emissive(&self) -> Emissive {
        let (mut materials, mut varied) = (HashMap::new(), Vec::new());
        for id in self.appearance.materials.ids() {
            let Some(of_surface) = self.emission(id) else { continue };
            let (sides, group) = (of_surface.sides, of_surface.group);
            let seen_through = sides != Sides::Front && self.appearance.has_passages(id);
            let of_patch = match of_surface.constant() {
                Some(emission) => {
                    PatchEmission { emission: emission.clone(), varied: None, sides, seen_through, group }
                }
                None => {
                    let textures = &self.appearance.textures;
                    let light = VariedEmission::new(of_surface.clone(), textures);
                    let (emission, id) = (light.mean(textures), VariedEmissionId::new(varied.len()));
                    varied.push(light);
                    PatchEmission { emission, varied: id, sides, seen_through, group }
                }
            };
            materials.insert(id, of_patch);
        }
        Emissive { materials, varied, drifts: HashMap::new() }
    }

    /// The map of an object as the shutter opens, and how it moves from there if it does; `drifts` has those of the
    /// objects before it.
    fn start(
        &self,
        pose: PoseId,
        drifts: &mut HashMap<PoseId, Arc<MovingTransform>>,
    ) -> (DAffine3, Option<Arc<MovingTransform>>) {
        if let Some(still) = pose.still_in(&self.geometry.transforms) {
            return (double(&still.world_from_object), None);
        }
        let motion = pose.moving_in(&self.geometry.motions);
        let Some(motion) = motion else { return (DAffine3::IDENTITY, None) };
        let drift = || Arc::new(motion.since_opening());
        let drift = motion.is_moving_map().then(|| Arc::clone(drifts.entry(pose).or_insert_with(drift)));
        (motion.map_at(0.0), drift)
    }

    /// How a part that moves within an object has moved since the shutter opened.
    fn drift_of_part(&self, pose: PoseId, inner: &MovingTransform) -> MovingTransform {
        let outer = pose.moving_in(&self.geometry.motions);
        outer.map_or_else(|| inner.since_opening(), |outer| outer.then(inner).since_opening())
    }

    /// The lights that integrators draw from: those of the file, emissive patches, and the background; of each frame those that rest
    /// in it.
    pub(super) fn light_samplers(
        &mut self,
        background: &Arc<Background>,
        frames: &Frames,
    ) -> Vec<LightSampler> {
        let mut list = self.light_list.clone();
        let first_area = list.len() - self.lights.areas.len();
        let mut sky = None;
        if !background.is_black()
            && let Some(id) = SkyLight::new(Arc::clone(background)).store(&mut self.lights)
        {
            sky = LightIndex::new(list.len());
            list.push((id, self.background_group));
        }
        if frames.has_one() {
            return vec![LightSampler::new(list, first_area, sky, &self.lights)];
        }
        let of_light = |light: LightIndex| match light
            .index()
            .checked_sub(first_area)
            .and_then(|i| self.lights.areas.get(i))
        {
            Some(area) => frames.of_object(area.object),
            None => frames.of_light(light),
        };
        let of_each: Vec<FrameId> = LightIndex::all(list.len()).map(of_light).collect();
        let sampler = |frame| {
            let elsewhere: Vec<bool> = of_each.iter().map(|&of| of != frame).collect();
            LightSampler::of_frame(list.clone(), first_area, sky, &self.lights, &elsewhere)
        };
        frames.ids().map(sampler).collect()
    }
}

/// The same map in double precision.
pub(super) fn double(m: &Affine3A) -> DAffine3 {
    let column = |v: kajo_math::Vec3A| kajo_math::Vec3::from(v).as_dvec3();
    let matrix3 =
        DMat3::from_cols(column(m.matrix3.x_axis), column(m.matrix3.y_axis), column(m.matrix3.z_axis));
    DAffine3 { matrix3, translation: column(m.translation) }
}
