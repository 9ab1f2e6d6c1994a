//! `Intersection`, `Difference` and `Merge`: solids made of others.

use kajo_scene::{Diagnostic, Item};

use super::Compiler;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::group::OBJECTS;
use super::part::Part;
use crate::material::MaterialId;
use crate::nested::PartContent;
use crate::shape::{AnyShape, Csg, CsgError, SetOperation, SolidPart};

/// An operand as it was read.
struct Operand<'t> {
    item: Item<'t>,
    parts: Vec<Part>,
}

impl Compiler<'_> {
    /// Makes an object of what a set operation makes of the objects in a block.
    pub(super) fn set_operation(
        &mut self,
        item: Item<'_>,
        operation: SetOperation,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let mut inner = GraphicsState {
            parts: Some(Vec::new()),
            is_operand: true,
            material: state.material,
            material_failed: state.material_failed,
        };
        let mut operands = Vec::new();
        for child in self.children(item) {
            self.object(child, item.keyword(), &mut CurrentTransform::origin(), &mut inner);
            let parts = inner.parts.replace(Vec::new()).unwrap_or_default();
            if OBJECTS.contains(&child.keyword()) {
                operands.push(Operand { item: child, parts });
            }
        }
        // As after a group, the material stays in force.
        (state.material, state.material_failed) = (inner.material, inner.material_failed);
        let solid = self.solid_of(item, operation, &operands);
        let shape = solid.and_then(|(solid, _)| self.shape(item, solid));
        self.put_shape(shape, item, ctm, state);
    }

    /// The solid, and the material that all of it has if that is one; why there is none is reported.
    fn solid_of(
        &mut self,
        item: Item<'_>,
        operation: SetOperation,
        operands: &[Operand<'_>],
    ) -> Option<(Csg, Option<MaterialId>)> {
        let mut materials = operands.iter().flat_map(|operand| &operand.parts).map(|part| part.material);
        let first = materials.next().flatten();
        let common = first.filter(|_| materials.all(|material| material == first));
        let solids: Option<Vec<Vec<SolidPart>>> = operands
            .iter()
            .map(|operand| {
                operand.parts.iter().map(|part| self.solid_part(operand.item, part, common)).collect()
            })
            .collect();
        let error = match Csg::new(operation, &solids?) {
            Ok(solid) => return Some((solid, common)),
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

    fn solid_part(&mut self, item: Item<'_>, part: &Part, common: Option<MaterialId>) -> Option<SolidPart> {
        let refuse = |compiler: &mut Self, message: &str, label: &str| {
            compiler.diagnostics.push(Diagnostic::error(message).label(item.head_span(), label));
        };
        let PartContent::Shape(shape) = part.content else {
            refuse(self, "an operand has too many parts to be one", "more than are kept one by one");
            return None;
        };
        let Some(&map) = part.map.constant() else {
            let message = "an operand cannot move by itself; the block around it can";
            refuse(self, message, "moves while the shutter is open");
            return None;
        };
        let own = part.material.filter(|_| common.is_none());
        let material = match own {
            Some(material) => Some(self.slot_of(material, item)?),
            None => None,
        };
        Some(SolidPart { shape: self.scene.geometry().shapes.any(shape), map, material })
    }

    /// The number by which shapes name a material.
    fn slot_of(&mut self, material: MaterialId, item: Item<'_>) -> Option<u32> {
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
