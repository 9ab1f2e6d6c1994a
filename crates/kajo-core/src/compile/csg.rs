//! `Union`, `Intersection`, `Difference` and `Merge`: solids made of others.

use kajo_scene::{Diagnostic, Item, Params};

use super::Compiler;
use super::blocks::MATERIAL_INDEX;
use super::fields::Sources;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::group::OBJECTS;
use super::material_draft::Reference;
use super::part::Part;
use crate::ids::MaterialSlot;
use crate::material::MaterialId;
use crate::nested::PartContent;
use crate::shape::{AnyShape, Csg, CsgError, SetOperation, ShapeId, SolidPart};

/// An operand as it was read.
struct Operand<'t> {
    item: Item<'t>,
    parts: Vec<Part>,
}

/// The block of an operation as it was read.
struct Operation<'t> {
    /// The one of all faces, where the block says one; `None` within where that is a mistake, which was reported.
    material: Option<Option<MaterialId>>,
    children: Vec<Item<'t>>,
}

impl Compiler<'_> {
    /// Objects together, all of one material where the block has one.
    ///
    /// * `read`: reads that material
    pub(super) fn union<'t>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<Option<Reference<'t>>>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let Some(Operation { material, children }) = self.operation(item, read) else { return };
        let outer = state.of_all;
        if let Some(own) = material {
            state.of_all = outer.or(own);
            state.material_failed |= own.is_none();
        }
        self.members(item, children, ctm, state);
        state.of_all = outer;
    }

    /// Makes an object of what a set operation makes of the objects in a block.
    ///
    /// * `read`: reads the material of all faces, where the block has one
    pub(super) fn set_operation<'t>(
        &mut self,
        item: Item<'t>,
        operation: SetOperation,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<Option<Reference<'t>>>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let Some(Operation { material, children }) = self.operation(item, read) else { return };
        let mut inner = GraphicsState {
            parts: Some(Vec::new()),
            is_operand: true,
            material: state.material,
            material_failed: state.material_failed || material.is_some_and(|own| own.is_none()),
            of_all: state.of_all.or(material.flatten()),
        };
        let mut operands = Vec::new();
        for child in children {
            self.object(child, item.keyword(), &mut CurrentTransform::origin(), &mut inner);
            let parts = inner.parts.replace(Vec::new()).unwrap_or_default();
            if OBJECTS.contains(&child.keyword()) {
                operands.push(Operand { item: child, parts });
            }
        }
        // As after a group, the material stays in force.
        (state.material, state.material_failed) = (inner.material, inner.material_failed);
        let solid = self.solid_of(item, operation, &operands);
        let shape = solid.and_then(|solid| self.shape(item, solid));
        match material {
            Some(own) => self.put_made_of(own, shape, item, ctm, state),
            None => self.put_shape(shape, item, ctm, state),
        }
    }

    /// What the block of an operation says; `None` for one that has no block, which is reported.
    fn operation<'t>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<Option<Reference<'t>>>,
    ) -> Option<Operation<'t>> {
        let (material, children) = self.read_keys(item, |params, sources| {
            params.name();
            let material = read(params, sources);
            Some((material, params.rest()))
        })?;
        let material = match material {
            None => Some(None),
            Some(None) => None,
            Some(Some(reference)) => Some(self.material(&reference)),
        };
        if material.is_some() {
            for index in children.iter().filter(|child| child.keyword() == MATERIAL_INDEX) {
                let message = format!("this `{}` has a `material` for all its faces", item.keyword());
                let error =
                    Diagnostic::error(message).label(index.head_span(), "no face would have this one");
                self.diagnostics.push(error.help("leave out `material`, or `MaterialIndex`"));
            }
        }
        Some(Operation { material, children })
    }

    /// A part of another material, whatever it brings; `None` where it cannot be, which is reported.
    pub(super) fn repainted(&mut self, part: &Part, material: MaterialId, by: Item<'_>) -> Option<Part> {
        let PartContent::Shape(shape) = part.content else {
            return self.report_assembly(by);
        };
        let content = PartContent::Shape(self.without_materials(shape, by)?);
        Some(Part { content, material: Some(material), ..part.clone() })
    }

    /// A shape without the materials that it brings.
    fn without_materials(&mut self, shape: ShapeId, by: Item<'_>) -> Option<ShapeId> {
        if let Some(&known) = self.plain_shapes.get(&shape) {
            return Some(known);
        }
        let plain: AnyShape = match self.scene.geometry().shapes.any(shape) {
            AnyShape::Mesh(mesh) if !mesh.material_slots().is_empty() => mesh.of_one_material().into(),
            AnyShape::Csg(solid) if solid.material_slots().next().is_some() => solid.of_one_material().into(),
            _ => return Some(shape),
        };
        let plain = self.shape(by, plain)?;
        if self.clear_meshes.contains(&shape) {
            self.clear_meshes.insert(plain);
        }
        self.plain_shapes.insert(shape, plain);
        Some(plain)
    }

    /// Reports an operand of which there are no parts one by one.
    fn report_assembly<T>(&mut self, item: Item<'_>) -> Option<T> {
        let error = Diagnostic::error("an operand has too many parts to be one");
        self.diagnostics.push(error.label(item.head_span(), "more than are kept one by one"));
        None
    }

    /// The solid; why there is none is reported.
    fn solid_of(&mut self, item: Item<'_>, operation: SetOperation, operands: &[Operand<'_>]) -> Option<Csg> {
        let mut materials = operands.iter().flat_map(|operand| &operand.parts).map(|part| part.material);
        let first = materials.next().flatten();
        let is_even = first.is_some() && materials.all(|material| material == first);
        let solids: Option<Vec<Vec<SolidPart>>> = operands
            .iter()
            .map(|operand| {
                operand.parts.iter().map(|part| self.solid_part(operand.item, part, is_even)).collect()
            })
            .collect();
        let error = match Csg::new(operation, &solids?) {
            Ok(solid) => return Some(solid),
            Err(error) => error,
        };
        let (place, message) = match error {
            CsgError::NotClosed { operand, part } => {
                let Operand { item, parts } = &operands[operand];
                return self.report_open(item, &parts[part]);
            }
            CsgError::Empty => (item, format!("`{}` has no operands", item.keyword())),
            CsgError::NoInverse | CsgError::TooMany => (item, error.to_string()),
        };
        let error = Diagnostic::error(message).label(place.head_span(), "makes nothing");
        self.diagnostics.push(error.help("write the solids that it is made of into its block"));
        None
    }

    /// * `is_even`: whether the result has the same material everywhere, and names none by its parts
    fn solid_part(&mut self, item: Item<'_>, part: &Part, is_even: bool) -> Option<SolidPart> {
        let PartContent::Shape(shape) = part.content else {
            return self.report_assembly(item);
        };
        let own = part.material.filter(|_| !is_even);
        let material = match own {
            Some(material) => Some(self.slot_of(material, item)?),
            None => None,
        };
        let shape = self.scene.geometry().shapes.any(shape);
        // What is described elsewhere is known by what puts it here.
        let (described, here) = (part.label.item(), item.index()..item.next_index());
        let source = if here.contains(&described) { described } else { item.index() };
        Some(SolidPart { shape, map: part.map.clone(), material, source })
    }

    /// The slot by which shapes name a material.
    fn slot_of(&mut self, material: MaterialId, item: Item<'_>) -> Option<MaterialSlot> {
        if let Some(&known) = self.solid_slots.get(&material) {
            return Some(known);
        }
        let added = self.scene.mesh_material(material);
        let slot = self.accepted(added, item.head_span())?;
        self.solid_slots.insert(material, slot);
        Some(slot)
    }

    /// Reports an operand that encloses nothing.
    fn report_open<T>(&mut self, item: &Item<'_>, part: &Part) -> Option<T> {
        let PartContent::Shape(shape) = part.content else { return None };
        let open_edge = match self.scene.geometry().shapes.any(shape) {
            AnyShape::Mesh(mesh) => mesh.open_edge(),
            _ => None,
        };
        let message = "an operand of a set operation must have an inside, and this has none";
        let error = Diagnostic::error(message);
        let error = match open_edge {
            Some([a, b]) => error.label(
                item.head_span(),
                format!(
                    "the edge from {} {} {} to {} {} {} has a triangle on one side only",
                    a.x, a.y, a.z, b.x, b.y, b.z
                ),
            ),
            None => error.label(item.head_span(), "encloses nothing"),
        };
        self.diagnostics.push(error.help("solids are balls, boxes, tori, superellipsoids, capped cylinders and cones, height fields with a `base`, prisms, lathes whose profile is closed or ends on the axis, sphere sweeps, closed meshes, planes as half spaces, and what set operations make"));
        None
    }
}
