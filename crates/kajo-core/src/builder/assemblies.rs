//! Assemblies: trees of their own that stand in many places.

use kajo_math::{DAffine3, Transform};

use super::{SceneBuilder, SceneError, check_finite};
use crate::ids::{AssemblyId, ObjectId};
use crate::material::MaterialId;
use crate::nested::{MOST_LEVELS, Member, PartContent, Placement};
use crate::objects::Label;
use crate::shape::Shapes;

/// A shape or another assembly in an assembly.
#[derive(Clone, Copy, Debug)]
pub struct AssemblyPart {
    /// What it is.
    pub content: PartContent,
    /// From its own space to that of the assembly; invertible.
    pub map: DAffine3,
    /// Of what brings none; without it that of the instance.
    pub material: Option<MaterialId>,
}

impl SceneBuilder {
    /// Makes an assembly of parts, none of which moves, gives light or is without bounds.
    ///
    /// It can stand in any number of places, each of which costs a hundred bytes, whatever it holds: use it for what stands in very
    /// many. What stands in few is faster as objects of their own.
    ///
    /// # Errors
    /// [`SceneError::UnknownShape`], [`SceneError::UnknownAssembly`], [`SceneError::UnknownMaterial`],
    /// [`SceneError::NotFinite`], [`SceneError::NoInverse`], [`SceneError::UnboundedPart`],
    /// [`SceneError::MovingPart`], [`SceneError::EmissivePart`], [`SceneError::TooManyLevels`], [`SceneError::TooManyObjects`].
    pub fn assembly(&mut self, parts: &[AssemblyPart]) -> Result<AssemblyId, SceneError> {
        let mut members = Vec::with_capacity(parts.len());
        for part in parts {
            let kind = match part.content {
                PartContent::Shape(shape) => {
                    self.check_shape(shape)?;
                    Shapes::type_name(shape)
                }
                PartContent::Assembly(assembly) => {
                    self.check_assembly(assembly)?;
                    "Assembly"
                }
            };
            part.material.map_or(Ok(()), |material| self.check_material(material))?;
            check_map(&part.map)?;
            let label = self.label(None, kind, members.len() as u32);
            members.push(self.member(part, label)?);
        }
        self.assemble(members)
    }

    /// Places an assembly in the scene.
    ///
    /// * `world_from_assembly`: invertible
    /// * `material`: of its parts that have none
    ///
    /// # Errors
    /// [`SceneError::UnknownAssembly`], [`SceneError::UnknownMaterial`], [`SceneError::NotFinite`],
    /// [`SceneError::NoInverse`], [`SceneError::NoMaterial`], [`SceneError::EmissivePart`],
    /// [`SceneError::TooManyObjects`].
    pub fn instance(
        &mut self,
        assembly: AssemblyId,
        world_from_assembly: &DAffine3,
        material: Option<MaterialId>,
    ) -> Result<(), SceneError> {
        self.check_assembly(assembly)?;
        material.map_or(Ok(()), |material| self.check_material(material))?;
        check_map(world_from_assembly)?;
        let placed_by = self.nested.placements.len() as u32;
        self.put_assembly(assembly, world_from_assembly, material, placed_by)
    }

    /// A part as a member of an assembly, if it can be one.
    pub(crate) fn member(&self, part: &AssemblyPart, label: Label) -> Result<Member, SceneError> {
        let &AssemblyPart { content, map, material } = part;
        let (takes_material, brings_materials) = match content {
            PartContent::Shape(shape) => {
                let bounds = self.geometry.shapes.bounds(shape);
                if !bounds.is_finite() && !bounds.is_empty() {
                    return Err(SceneError::UnboundedPart);
                }
                if self.geometry.shapes.has_moving_parts(shape) {
                    return Err(SceneError::MovingPart);
                }
                let own = self.own_materials_of(shape);
                if own.emit {
                    return Err(SceneError::EmissivePart);
                }
                (true, own.transmit)
            }
            PartContent::Assembly(assembly) => {
                let inner = self.nested.assembly(assembly);
                if inner.levels >= MOST_LEVELS {
                    return Err(SceneError::TooManyLevels);
                }
                (inner.inherits, false)
            }
        };
        if takes_material && material.is_some_and(|material| self.is_emissive(material)) {
            return Err(SceneError::EmissivePart);
        }
        Ok(Member { content, map, material, first: 0, label, brings_materials })
    }

    /// Makes an assembly of members.
    pub(crate) fn assemble(&mut self, members: Vec<Member>) -> Result<AssemblyId, SceneError> {
        let may_transmit = |material| self.appearance.may_transmit(material);
        let id = self.nested.assemble(members, &self.geometry.shapes, may_transmit, &self.trees);
        id.ok_or(SceneError::TooManyObjects(ObjectId::MOST as usize))
    }

    /// Places an assembly in the scene.
    ///
    /// * `placed_by`: see [`crate::Object::placed_by`]
    pub(crate) fn put_assembly(
        &mut self,
        assembly: AssemblyId,
        map: &DAffine3,
        material: Option<MaterialId>,
        placed_by: u32,
    ) -> Result<(), SceneError> {
        let part = self.nested.assembly(assembly);
        let (inherits, transmits) = (part.inherits, part.transmits);
        let material = material.filter(|_| inherits);
        if inherits && material.is_none() {
            return Err(SceneError::NoMaterial);
        }
        if material.is_some_and(|material| self.is_emissive(material)) {
            return Err(SceneError::EmissivePart);
        }
        let placement = Placement { assembly, map: *map, material, first: 0, placed_by };
        let room = ObjectId::MOST.saturating_sub(self.limits.objects.try_into().unwrap_or(ObjectId::MOST));
        if !self.nested.place(placement, room) {
            return Err(SceneError::TooManyObjects(ObjectId::MOST as usize));
        }
        let may_transmit = |material| self.appearance.may_transmit(material);
        self.nested_transmits |= transmits || material.is_some_and(may_transmit);
        Ok(())
    }

    /// Assemblies and their instances so far.
    pub(crate) fn nested(&self) -> &crate::nested::Nested {
        &self.nested
    }

    fn check_assembly(&self, assembly: AssemblyId) -> Result<(), SceneError> {
        let known = assembly.index() < self.nested.assemblies.len();
        known.then_some(()).ok_or(SceneError::UnknownAssembly(assembly))
    }
}

/// Refuses a map that nothing can stand under.
fn check_map(map: &DAffine3) -> Result<(), SceneError> {
    check_finite(map.is_finite(), "DAffine3")?;
    Transform::new(map).map(drop).ok_or(SceneError::NoInverse)
}
