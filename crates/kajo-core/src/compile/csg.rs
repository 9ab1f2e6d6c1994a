//! `Intersection`, `Difference` and `Merge`: solids made of others.

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
use crate::shape::{AnyShape, Csg, CsgError, SetOperation, SolidPart};

/// An operand as it was read.
struct Operand<'t> {
    item: Item<'t>,
    parts: Vec<Part>,
}

impl Compiler<'_> {
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
        let keys = self.read_keys(item, |params, sources| {
            params.name();
            let material = read(params, sources);
            Some((material, params.rest()))
        });
        let Some((material, children)) = keys else { return };
        let has_own = material.as_ref().is_none_or(Option::is_some);
        let own = material.flatten().and_then(|reference| self.material(&reference));
        let mut inner = GraphicsState {
            parts: Some(Vec::new()),
            is_operand: true,
            material: state.material,
            material_failed: state.material_failed,
        };
        let mut operands = Vec::new();
        for child in children {
            if has_own && child.keyword() == MATERIAL_INDEX {
                let message = format!("this `{}` has a `material` for all its faces", item.keyword());
                let error =
                    Diagnostic::error(message).label(child.head_span(), "no face would have this one");
                self.diagnostics.push(error.help("leave out `material`, or `MaterialIndex`"));
            }
            self.object(child, item.keyword(), &mut CurrentTransform::origin(), &mut inner);
            let parts = inner.parts.replace(Vec::new()).unwrap_or_default();
            if OBJECTS.contains(&child.keyword()) {
                operands.push(Operand { item: child, parts });
            }
        }
        // As after a group, the material stays in force.
        (state.material, state.material_failed) = (inner.material, inner.material_failed);
        let solid = self.solid_of(item, operation, has_own, &operands);
        let shape = solid.and_then(|solid| self.shape(item, solid));
        if has_own {
            self.put_made_of(own, shape, item, ctm, state);
        } else {
            self.put_shape(shape, item, ctm, state);
        }
    }

    /// The solid; why there is none is reported.
    ///
    /// * `has_own`: whether it has one material, whatever its operands have
    fn solid_of(
        &mut self,
        item: Item<'_>,
        operation: SetOperation,
        has_own: bool,
        operands: &[Operand<'_>],
    ) -> Option<Csg> {
        let mut materials = operands.iter().flat_map(|operand| &operand.parts).map(|part| part.material);
        let first = materials.next().flatten();
        let is_even = has_own || (first.is_some() && materials.all(|material| material == first));
        let solids: Option<Vec<Vec<SolidPart>>> = operands
            .iter()
            .map(|operand| {
                operand.parts.iter().map(|part| self.solid_part(operand.item, part, is_even)).collect()
            })
            .collect();
        let error = match Csg::new(operation, &solids?) {
            Ok(solid) if has_own => return Some(solid.of_one_material()),
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
            let error = Diagnostic::error("an operand has too many parts to be one");
            self.diagnostics.push(error.label(item.head_span(), "more than are kept one by one"));
            return None;
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
