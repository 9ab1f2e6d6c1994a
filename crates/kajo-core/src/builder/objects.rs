//! Shapes and where they stand.

use std::sync::Arc;

use kajo_math::{DAffine3, Motion, Transform};

use super::area_lights::double;
use super::frames::Frames;
use super::{OwnMaterials, SceneBuilder, SceneError, check_finite};
use crate::ids::{FrameId, MaterialSlot, MotionId, ObjectId, PoseId, TransformId};
use crate::material::MaterialId;
use crate::objects::Label;
use crate::scene::{Geometry, Primitive};
use crate::shape::{AnyShape, ShapeId, Shapes};

impl SceneBuilder {
    /// Adds a shape, which can stand in many places.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::UnknownMeshMaterial`], [`SceneError::TooMany`].
    pub fn shape(&mut self, shape: impl Into<AnyShape>) -> Result<ShapeId, SceneError> {
        let shape = shape.into();
        let name = shape.name();
        check_finite(shape.is_finite(), name)?;
        let own = match &shape {
            AnyShape::Mesh(mesh) => self.own_materials(mesh.material_slots().iter().copied())?,
            AnyShape::Csg(csg) => self.own_materials(csg.material_slots())?,
            _ => OwnMaterials::default(),
        };
        let own = (own.transmit || own.emit).then_some(own);
        let id = shape.store(&mut self.geometry.shapes).ok_or(SceneError::TooMany(name))?;
        self.own_materials.extend(own.map(|own| (id, own)));
        Ok(id)
    }

    /// Adds a transform for objects to refer to.
    ///
    /// * `world_from_object`: invertible
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::NoInverse`], [`SceneError::TooMany`].
    pub fn transform(&mut self, world_from_object: &DAffine3) -> Result<PoseId, SceneError> {
        check_finite(world_from_object.is_finite(), "DAffine3")?;
        self.place(Transform::new(world_from_object).ok_or(SceneError::NoInverse)?)
    }

    /// A place for objects that changes with time; see [`SceneBuilder::shutter`].
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::NoInverse`], [`SceneError::TooMany`].
    pub fn motion(&mut self, world_from_object: Motion) -> Result<PoseId, SceneError> {
        if let Some(map) = world_from_object.constant() {
            return self.transform(map);
        }
        let start = world_from_object.at(0.0);
        check_finite(start.is_finite(), "Motion")?;
        Transform::new(&start).ok_or(SceneError::NoInverse)?;
        self.add_motion(world_from_object)
    }

    /// A place for an object with parts that move within it, whether it moves itself or not.
    pub(crate) fn add_motion(&mut self, world_from_object: Motion) -> Result<PoseId, SceneError> {
        let id = MotionId::new(self.motions.len()).ok_or(SceneError::TooMany("Motion"))?;
        self.motions.push(world_from_object);
        Ok(PoseId::moving(id))
    }

    /// A place for objects that does not change.
    pub(crate) fn place(&mut self, transform: Transform) -> Result<PoseId, SceneError> {
        if transform.is_identity() {
            return Ok(PoseId::IDENTITY);
        }
        let id = TransformId::new(self.geometry.transforms.len()).ok_or(SceneError::TooMany("DAffine3"))?;
        self.geometry.transforms.push(transform);
        Ok(PoseId::still(id))
    }

    /// Puts a shape into the scene. Of equally distant objects the one that was put there first is seen.
    ///
    /// * `material`: of all its parts that bring none
    /// * `pose`: its place; [`PoseId::IDENTITY`] where its space is the world's
    ///
    /// # Errors
    /// [`SceneError::UnknownShape`], [`SceneError::UnknownMaterial`], [`SceneError::UnknownPose`],
    /// [`SceneError::TooManyObjects`].
    pub fn object(
        &mut self,
        shape: ShapeId,
        material: MaterialId,
        pose: PoseId,
    ) -> Result<ObjectId, SceneError> {
        self.check_shape(shape)?;
        self.check_material(material)?;
        let is_known =
            pose.still_in(&self.geometry.transforms).is_some() || pose.moving_in(&self.motions).is_some();
        if !is_known {
            return Err(SceneError::UnknownPose(pose));
        }
        let number = self.geometry.primitives.len();
        if number >= self.limits.objects {
            return Err(SceneError::TooManyObjects(self.limits.objects));
        }
        // So that all that asks of what moves finds it.
        let pose = if self.geometry.shapes.has_moving_parts(shape) { self.own_motion(pose)? } else { pose };
        let kind = Shapes::type_name(shape);
        let label = self.geometry.objects.label(None, kind, number as u32);
        Ok(self.put(shape, material, pose, label, number as u32))
    }

    /// The same place as a motion that no other object has.
    fn own_motion(&mut self, pose: PoseId) -> Result<PoseId, SceneError> {
        let motion = match pose.still_in(&self.geometry.transforms) {
            Some(still) => Some(Motion::still(double(&still.world_from_object))),
            None => pose.moving_in(&self.motions).cloned(),
        };
        self.add_motion(motion.ok_or(SceneError::UnknownPose(pose))?)
    }

    /// Shows what has moving parts as the shutter sees it; see [`Surface::part_motion`](crate::shape::Surface::part_motion).
    pub(super) fn expose_moving_parts(&mut self) -> Result<(), SceneError> {
        let media = &mut self.appearance.media;
        media.expose(self.shutter);
        let is_lost = |id| media.velocities(id).is_some() && media.bounds(id).is_none_or(|b| !b.is_finite());
        if media.ids().any(is_lost) {
            return Err(SceneError::FastMedium);
        }
        let geometry = &mut self.geometry;
        geometry.shapes.expose(self.shutter);
        for primitive in &geometry.primitives {
            if !geometry.shapes.moves(primitive.shape) {
                continue;
            }
            debug_assert!(geometry.shapes.has_moving_parts(primitive.shape));
            if let Some(motion) = primitive.pose.moving_in_mut(&mut geometry.motions) {
                motion.hold_moving();
            }
        }
        Ok(())
    }

    /// Gives a name to an object, by which programs show it.
    ///
    /// # Errors
    /// [`SceneError::UnknownObject`].
    pub fn name_object(&mut self, object: ObjectId, name: &str) -> Result<(), SceneError> {
        let named = self.geometry.objects.rename(object.index(), name.into());
        named.then_some(()).ok_or(SceneError::UnknownObject(object.index()))
    }

    /// Puts a shape into the scene, with the user's words for it.
    ///
    /// * `placed_by`: see [`crate::Object::placed_by`]
    pub(crate) fn put(
        &mut self,
        shape: ShapeId,
        material: MaterialId,
        pose: PoseId,
        label: Label,
        placed_by: u32,
    ) -> ObjectId {
        let object = ObjectId::from_index(self.geometry.primitives.len() as u32);
        let transmits = self.appearance.may_transmit(material) || self.own_materials_of(shape).transmit;
        self.geometry.primitives.push(Primitive { shape, pose, material, transmits, emits: false });
        self.geometry.objects.push(label, placed_by);
        self.frames.add_object(object);
        object
    }

    /// What the scene's objects are called.
    pub(crate) fn label(&mut self, name: Option<Arc<str>>, keyword: &'static str, item: u32) -> Label {
        self.geometry.objects.label(name, keyword, item)
    }

    /// Shapes and objects so far, without trees.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    pub(super) fn check_shape(&self, shape: ShapeId) -> Result<(), SceneError> {
        self.geometry.shapes.contains(shape).then_some(()).ok_or(SceneError::UnknownShape(shape))
    }

    /// What is known of the materials that a shape brings.
    fn own_materials(&self, slots: impl Iterator<Item = MaterialSlot>) -> Result<OwnMaterials, SceneError> {
        let (mut own, mut latest) = (OwnMaterials::default(), MaterialSlot::NONE);
        for slot in slots {
            // Neighbours mostly have the same.
            if slot == latest || slot == MaterialSlot::NONE {
                continue;
            }
            let material = self.appearance.slots.get(slot.index());
            let &material = material.ok_or(SceneError::UnknownMeshMaterial(slot))?;
            own.transmit |= self.appearance.may_transmit(material);
            own.emit |= self.is_emissive(material);
            latest = slot;
        }
        Ok(own)
    }

    pub(super) fn own_materials_of(&self, shape: ShapeId) -> OwnMaterials {
        self.own_materials.get(&shape).copied().unwrap_or_default()
    }

    /// What is to be known of all objects together, and the trees over them.
    pub(super) fn finish_geometry(&mut self, frames: &Frames) {
        let geometry = &mut self.geometry;
        geometry.transmits = self.nested_transmits || geometry.primitives.iter().any(|p| p.transmits);
        let shapes = &geometry.shapes;
        geometry.has_vertex_colors = shapes.ids().any(|id| shapes.has_colors(id));
        let mut nested = std::mem::take(&mut self.nested);
        let nested = (!nested.placements.is_empty()).then(|| {
            nested.finish(&geometry.shapes, &self.trees);
            nested
        });
        geometry.build_trees(nested, |i| frames.of_object(i) == FrameId::WORLD, &self.trees);
    }
}
