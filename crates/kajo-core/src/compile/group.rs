//! `Group` and `Transform` blocks and the objects in them.

use kajo_math::{DAffine3, Motion, Transform};
use kajo_scene::{Args, Diagnostic, Item, Params, not_supported_yet, unknown_word};

use super::blocks::{self, MATERIAL_INDEX, OBJECTS as MEMBERS};
use super::fields::Sources;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::material_draft::Reference;
use super::member::keywords;
use super::misplaced::misplaced;
use super::part::{BYTES_PER_OBJECT, Part};
use super::{Compiler, motion, operations};
use crate::ids::PoseId;
use crate::material::MaterialId;
use crate::motion::MovingTransform;
use crate::nested::PartContent;
use crate::schema::{Block, Kind};
use crate::shape::{AnyShape, ShapeId};

/// The word that puts objects together.
const GROUP: &str = blocks::group::GROUP.block.keyword;

/// The word that says how many objects a group holds.
const COUNT: &str = blocks::group::OBJECT_COUNT.key;

/// The word that describes objects which are placed elsewhere.
const DEFINE: &str = blocks::group::DEFINE.keyword;

/// Words for objects, groups and transforms included.
pub(super) const OBJECTS: [&str; MEMBERS.len()] = keywords(&MEMBERS);
const LATER: [&str; 3] = ["BezierCurve", "BsplineCurve", "RevSurface"];

impl Compiler<'_> {
    /// Everything in the scene's group.
    pub(super) fn objects(&mut self, group: Item<'_>) {
        self.group(group, &mut CurrentTransform::origin(), &mut GraphicsState::default());
        if let Some((count, first)) = self.flat_triangles {
            let message = match count {
                1 => "this triangle has no area and is left out".to_owned(),
                n => format!("{n} triangles have no area and are left out"),
            };
            let label = if count == 1 { "its corners lie on a line" } else { "the first one" };
            self.diagnostics.push(Diagnostic::warning(message).label(first, label));
        }
    }

    pub(super) fn group(&mut self, group: Item<'_>, ctm: &mut CurrentTransform, state: &mut GraphicsState) {
        let children = self.children(group);
        self.members(group, children, ctm, state);
    }

    /// Everything in a group.
    pub(super) fn members<'t>(
        &mut self,
        group: Item<'t>,
        children: Vec<Item<'t>>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let mut objects = 0;
        let mut count = None;
        for item in children {
            match item.keyword() {
                COUNT => count = Some(item),
                word => {
                    // A misspelt object was meant to be one.
                    let is_object = OBJECTS.contains(&word) || (item.has_block() && word != DEFINE);
                    objects += usize::from(is_object);
                    self.object(item, group.keyword(), ctm, state);
                }
            }
        }
        self.check_count(count, objects, "object");
    }

    pub(super) fn object(
        &mut self,
        item: Item<'_>,
        parent: &str,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        match item.keyword() {
            DEFINE => self.define(item, state),
            MATERIAL_INDEX => {
                let reference = Args::read(item, self.diagnostics, Reference::read);
                let material = reference.and_then(|reference| self.material(&reference));
                state.material_failed |= material.is_none();
                state.material = material.or(state.material);
            }
            word if let Some(member) = MEMBERS.iter().find(|member| member.block.keyword == word) => {
                (member.read)(self, item, ctm, state);
            }
            word if LATER.contains(&word) => self.diagnostics.push(not_supported_yet(item)),
            _ => {
                let of_parent = blocks::block_of(parent).filter(|block| block.kind == Kind::Group);
                let keys = of_parent.into_iter().flat_map(Block::fields).map(|field| field.key);
                let allowed = OBJECTS.into_iter().chain([DEFINE, MATERIAL_INDEX]).chain(keys);
                let error = misplaced(item, Some(GROUP));
                let error = error.unwrap_or_else(|| unknown_word(item, Some(parent), allowed));
                self.diagnostics.push(error);
            }
        }
    }

    pub(super) fn transform(&mut self, item: Item<'_>, ctm: &CurrentTransform, state: &mut GraphicsState) {
        let children = self.children(item);
        let (operations, objects) = self.operations_first(item, children);
        let mut there = self.moved(item, &operations, ctm);
        for object in objects {
            self.object(object, item.keyword(), &mut there, state);
        }
    }

    /// The operations among the children of an item, and the objects behind them.
    pub(super) fn operations_first<'t>(
        &mut self,
        item: Item<'t>,
        children: Vec<Item<'t>>,
    ) -> (Vec<Item<'t>>, Vec<Item<'t>>) {
        let mut operations = Vec::new();
        let mut objects = Vec::new();
        for child in children {
            if !operations::MOVING_OPERATIONS.contains(&child.keyword()) {
                objects.push(child);
            } else if objects.is_empty() {
                operations.push(child);
            } else {
                let message = format!("`{}` comes after the object it should move", child.keyword());
                let error = Diagnostic::error(message).label(child.head_span(), "too late");
                self.diagnostics.push(error.help("write the operations first, then the object"));
            }
        }
        if objects.is_empty() {
            let warning = Diagnostic::warning(format!("this `{}` holds no object", item.keyword()));
            self.diagnostics.push(warning.label(item.keyword_span(), "moves nothing"));
        }
        (operations, objects)
    }

    /// The transform that `operations` of `item` make of `ctm`; one that cannot be is reported.
    pub(super) fn moved(
        &mut self,
        item: Item<'_>,
        operations: &[Item<'_>],
        ctm: &CurrentTransform,
    ) -> CurrentTransform {
        let mut local = Motion::still(DAffine3::IDENTITY);
        let mut flattens = false;
        for &operation in operations {
            local = self.operate(local, operation);
            // Rounding in a later product could hide that there is no inverse.
            flattens |= local.at(0.0).matrix3.determinant() == 0.0;
        }
        let there = CurrentTransform::new(ctm.world.then(&local));
        if ctm.is_flat() {
            return there.flattened();
        }
        if flattens || there.is_flat() {
            let message =
                format!("this `{}` has no inverse, so what it holds cannot be seen", item.keyword());
            let warning = Diagnostic::warning(message);
            self.diagnostics.push(warning.label(item.keyword_span(), "flattens its object"));
            return there.flattened();
        }
        there
    }

    /// A map after one more operation.
    fn operate(&mut self, map: Motion, operation: Item<'_>) -> Motion {
        let by_rows = self.rules.matrix_by_rows;
        if operation.keyword() == operations::MOTION {
            let keys = motion::read(operation, by_rows, self.now(), self.diagnostics);
            return keys.map_or(map.clone(), |keys| map.then(&Motion::keyed(keys)));
        }
        if let Some(changing) = self.changing_operation(operation) {
            // `Matrix` multiplies from the left.
            let is_outer = operations::is_from_left(operation);
            return if is_outer { changing.then(&map) } else { map.then(&changing) };
        }
        let mut apply = |m| Motion::still(operations::apply(m, operation, by_rows, self.diagnostics));
        match map.constant() {
            Some(map) => apply(*map),
            // `Matrix` multiplies from the left.
            None if operations::is_from_left(operation) => apply(DAffine3::IDENTITY).then(&map),
            None => map.then(&apply(DAffine3::IDENTITY)),
        }
    }

    /// Makes an object of the shape that `read` makes of an item.
    pub(super) fn solid<'t, S: Into<AnyShape>>(
        &mut self,
        item: Item<'t>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<S>,
    ) {
        let shape = self.read_keys(item, |params, sources| {
            params.name();
            read(params, sources)
        });
        let shape = shape.and_then(|shape| self.shape(item, shape));
        self.put_shape(shape, item, ctm, state);
    }

    /// Makes an object of a shape; `None` for one that there is nothing of, which was reported.
    pub(super) fn put_shape(
        &mut self,
        shape: Option<ShapeId>,
        item: Item<'_>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        match shape {
            Some(shape) => self.put_one(shape, None, item, ctm, state),
            None => {
                self.material_for(item, state);
            }
        }
    }

    /// The same for a shape with a material of its own; `None` for one that there is not, which was reported.
    pub(super) fn put_made_of(
        &mut self,
        material: Option<MaterialId>,
        shape: Option<ShapeId>,
        item: Item<'_>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        if let (Some(material), Some(shape)) = (material, shape) {
            self.put_one(shape, Some(material), item, ctm, state);
        }
    }

    /// * `material`: its own, if it has one
    fn put_one(
        &mut self,
        shape: ShapeId,
        material: Option<MaterialId>,
        item: Item<'_>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let Some(keyword) = OBJECTS.into_iter().find(|word| *word == item.keyword()) else { return };
        if !self.has_memory(BYTES_PER_OBJECT, item.head_span()) {
            return;
        }
        let name = item.word().map(|word| word.text().into());
        let part = Part {
            content: PartContent::Shape(shape),
            map: Motion::still(DAffine3::IDENTITY),
            material,
            label: self.scene.label(name, keyword, item.index()),
        };
        self.put(&part, item, ctm, state);
    }

    /// Makes `part` an object at `ctm`: of the definition that is being read, else of the scene.
    ///
    /// * `by`: what puts it there
    pub(super) fn put(
        &mut self,
        part: &Part,
        by: Item<'_>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let repainted;
        let part = match state.of_all {
            Some(material) => {
                let Some(part) = self.repainted(part, material, by) else { return };
                repainted = part;
                &repainted
            }
            None => part,
        };
        if let Some(parts) = &mut state.parts {
            if !ctm.is_flat() && self.may_stand(part, by, ctm) {
                let own = part.material.or(state.material);
                let material = own.map(|material| self.see_through(part.content, material));
                parts.push(Part { map: ctm.world.clone(), material, ..part.clone() });
            }
            return;
        }
        let shape = match part.content {
            PartContent::Shape(shape) => shape,
            PartContent::Assembly(number) => {
                return self.place_assembly(number, part.material, by, ctm, state);
            }
        };
        let has_moving_parts = self.scene.geometry().shapes.has_moving_parts(shape);
        if !self.may_rest(ctm, has_moving_parts, by) {
            return;
        }
        let material = part.material.or_else(|| self.material_for(by, state));
        let pose = if has_moving_parts { self.own_pose(ctm, by) } else { self.pose(ctm, by) };
        let (Some(material), Some(pose)) = (material, pose) else { return };
        let material = self.see_through(part.content, material);
        self.check_filled(part.content, material, ctm, by);
        self.scene.put(shape, material, pose, part.label, by.index());
    }

    /// Reports a body that a medium would fill, and that has no inside.
    fn check_filled(
        &mut self,
        content: PartContent,
        material: MaterialId,
        ctm: &CurrentTransform,
        by: Item<'_>,
    ) {
        let PartContent::Shape(shape) = content else { return };
        let (appearance, shapes) = (self.scene.appearance(), &self.scene.geometry().shapes);
        let bends = appearance.bends_light(material);
        if bends && (ctm.world.constant().is_none() || shapes.has_moving_parts(shape)) {
            let error = Diagnostic::error("a body that bends light does not move");
            let error = error.label(by.keyword_span(), "moves while the shutter is open");
            self.diagnostics
                .push(error.help("place it without a `Motion`: its index is one of places in the world"));
        } else if bends && !shapes.bounds(shape).is_finite() {
            let error = Diagnostic::error("a body that bends light has bounds, and this one has none");
            let error = error.label(by.keyword_span(), "goes on for ever");
            self.diagnostics.push(error.help("make a `Box` of it, as large as need be"));
        } else if (bends || appearance.has_medium(material)) && !shapes.is_solid(shape) {
            let error = Diagnostic::error("a medium fills closed shapes, and this one is open");
            let error = error.label(by.keyword_span(), "has no inside");
            let help = "close it, or give it a material without `medium` and `subsurface`";
            self.diagnostics.push(error.help(help));
        }
    }

    /// The material of a part: one that is not everywhere, if the colours of a mesh say so.
    fn see_through(&mut self, content: PartContent, material: MaterialId) -> MaterialId {
        match content {
            PartContent::Shape(shape) if self.clear_meshes.contains(&shape) => {
                self.scene.see_through(material).unwrap_or(material)
            }
            _ => material,
        }
    }

    /// The material in force; its absence is reported.
    pub(super) fn material_for(&mut self, item: Item<'_>, state: &GraphicsState) -> Option<MaterialId> {
        let materials_failed = self.diagnostics.has_errors() && self.scene.appearance().list.is_empty();
        if state.material.is_none() && state.parts.is_none() && !state.material_failed && !materials_failed {
            let error = Diagnostic::error(format!("`{}` has no material", item.keyword()));
            let help = "write `MaterialIndex 0`, or the name of a material, before it";
            let error = error.label(item.keyword_span(), "no `MaterialIndex` before this");
            self.diagnostics.push(error.help(help));
        }
        state.material
    }

    /// The pose of a transform; `None` when it has no inverse and nothing there can be hit.
    fn pose(&mut self, ctm: &mut CurrentTransform, by: Item<'_>) -> Option<PoseId> {
        let transform = ctm.transform?;
        if ctm.pose.is_none() {
            let moves = ctm.world.constant().is_none();
            let bytes = if moves { size_of::<MovingTransform>() } else { size_of::<Transform>() };
            if !self.has_memory(bytes, by.head_span()) {
                return None;
            }
        }
        let pose = match (ctm.pose, ctm.world.constant()) {
            (Some(pose), _) => pose,
            (None, Some(_)) => self.scene.place(transform).ok()?,
            (None, None) => self.scene.motion(ctm.world.clone()).ok()?,
        };
        ctm.pose = Some(pose);
        Some(pose)
    }

    /// The pose of a place for one object alone, of which parts move.
    fn own_pose(&mut self, ctm: &CurrentTransform, by: Item<'_>) -> Option<PoseId> {
        ctm.transform?;
        if !self.has_memory(size_of::<MovingTransform>(), by.head_span()) {
            return None;
        }
        self.scene.add_motion(ctm.world.clone()).ok()
    }

    /// The items in a block; an item without a block is reported.
    pub(super) fn children<'t>(&mut self, item: Item<'t>) -> Vec<Item<'t>> {
        let mut params = Params::new(item, self.diagnostics);
        params.name();
        let children = params.rest();
        params.finish();
        children
    }
}
