//! `Define` and `Instance`: things described once and placed many times.
//!
//! A definition is a list of parts, each a shape with its place within the definition. An instance
//! makes an object of each part, so a definition may hold instances of others to any depth, and what comes
//! out is one flat list that one tree covers. A mesh is stored once, and an object of it takes
//! little over a hundred bytes. A definition can only use those that stand before it, so none leads back to itself.
//! Where the list would be long, the instances of a definition are kept nested; see [`super::nesting`].

use kajo_math::{DAffine3, Motion};
use kajo_scene::{Diagnostic, Item, OverBudget, Params, Span};

use super::graphics_state::{CurrentTransform, GraphicsState};
use super::part::{BYTES_PER_OBJECT, Part, Parts};
use super::{Compiler, operations};
use crate::ids::AssemblyId;
use crate::material::Appearance;

/// What a `Define` block holds.
#[derive(Clone)]
pub(super) struct Definition {
    pub parts: Parts,
    /// The assembly that has been made of it, if any.
    pub assembly: Option<AssemblyId>,
}

impl Compiler<'_> {
    pub(super) fn define(&mut self, item: Item<'_>, state: &mut GraphicsState) {
        let Some(name) = item.word().map(|word| word.text().into_owned()) else {
            let error =
                Diagnostic::error("`Define` needs a name").label(item.head_span(), "nothing can use this");
            self.diagnostics.push(error.help("write `Define NAME { ... }` and place it by `Instance NAME`"));
            return;
        };
        let mut inner = GraphicsState {
            parts: Some(Vec::new()),
            material_failed: state.material_failed,
            ..GraphicsState::default()
        };
        self.group(item, &mut CurrentTransform::origin(), &mut inner);
        let parts: Parts = inner.parts.unwrap_or_default().into();
        self.parts_defined += parts.len();
        let definition = Definition { parts, assembly: None };
        if self.definitions.insert(name.clone(), definition).is_some() {
            let error = Diagnostic::error(format!("there are two definitions named `{name}`"));
            self.diagnostics.push(error.label(item.head_span(), "the second one"));
        }
    }

    pub(super) fn instance(&mut self, item: Item<'_>, ctm: &mut CurrentTransform, state: &mut GraphicsState) {
        let operations = if item.has_block() { self.operations(item) } else { Vec::new() };
        let Some(name) = item.word().map(|word| word.text()) else {
            let error = Diagnostic::error("`Instance` needs the name of a definition");
            self.diagnostics.push(error.label(item.head_span(), "an instance of what?"));
            return;
        };
        let Some(definition) = self.definitions.get(&*name).cloned() else {
            let near = self.diagnostics.nearest(&name, self.definitions.keys().map(String::as_str));
            let help = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("write `Define {name} {{ ... }}` before it"),
            };
            let error = Diagnostic::error(format!("there is no definition named `{name}` before this"));
            self.diagnostics.push(error.label(item.head_span(), "asked for here").help(help));
            return;
        };
        let mut there;
        let ctm = if operations.is_empty() {
            ctm
        } else {
            there = self.moved(item, &operations, ctm);
            &mut there
        };
        let assembly = if state.is_operand || state.of_all.is_some() || self.is_moving() {
            None
        } else {
            self.assembly_of(&name, &definition, ctm, state, item)
        };
        if self.too_many {
            return;
        }
        match assembly {
            Some(number) => {
                let part = self.assembly_part(number, item);
                self.place_parts(&[part], item, ctm, state);
            }
            None => self.place_parts(&definition.parts, item, ctm, state),
        }
    }

    /// The operations in the block of an instance, where nothing else may stand.
    pub(super) fn operations<'t>(&mut self, item: Item<'t>) -> Vec<Item<'t>> {
        let mut params = Params::new(item, self.diagnostics);
        params.name();
        let operations = params.take(&operations::MOVING_OPERATIONS);
        params.finish();
        operations
    }

    /// Makes objects of all parts of a definition that stands at `ctm`.
    pub(super) fn place_parts(
        &mut self,
        parts: &[Part],
        item: Item<'_>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        if !self.has_room(parts.len(), item.head_span(), state.parts.as_ref().map_or(0, Vec::len)) {
            return;
        }
        // Neighbours often stand at the same place, which they then share.
        let mut latest: Option<(&Motion, CurrentTransform)> = None;
        for part in parts {
            if part.map.constant() == Some(&DAffine3::IDENTITY) {
                self.put(part, item, ctm, state);
                continue;
            }
            if latest.as_ref().is_none_or(|(map, _)| **map != part.map) {
                let there = ctm.around(&part.map);
                if !self.has_memory(there.world.bytes(), item.head_span()) {
                    return;
                }
                latest = Some((&part.map, there));
            }
            if let Some((_, there)) = &mut latest {
                self.put(part, item, there, state);
            }
        }
    }

    /// Whether there may be `more` objects; if not, that is reported once.
    pub(super) fn has_room(&mut self, more: usize, at: Span, open: usize) -> bool {
        let most = self.options.limits.objects;
        let so_far = self.scene.geometry().primitives.len()
            + self.scene.nested().placements.len()
            + self.parts_defined
            + open;
        if so_far.saturating_add(more) <= most {
            return self.has_memory(more.saturating_mul(BYTES_PER_OBJECT), at);
        }
        if !std::mem::replace(&mut self.too_many, true) {
            let message =
                format!("with this there would be more than {most} objects, the most that a scene may have");
            self.diagnostics.push(Diagnostic::error(message).label(at, format!("adds {more} to {so_far}")));
        }
        false
    }

    /// Takes memory for objects at `at`; if there is too little left, that is reported once.
    pub(super) fn has_memory(&mut self, bytes: usize, at: Span) -> bool {
        let taken = self.options.limits.memory.take(bytes as u64);
        taken.map_err(|over| self.report_memory("objects", over, at)).is_ok()
    }

    /// Takes memory for the materials that have come since this was asked last, as [`has_memory`](Self::has_memory).
    pub(super) fn has_memory_for_materials(&mut self, at: Span) -> bool {
        let Appearance { materials, textures, .. } = self.scene.appearance();
        let bytes = materials.bytes() + textures.bytes();
        let more = bytes.saturating_sub(std::mem::replace(&mut self.material_bytes, bytes));
        let taken = self.options.limits.memory.take(more as u64);
        taken.map_err(|over| self.report_memory("materials", over, at)).is_ok()
    }

    /// Reports once that there is too little memory for what stands at `at`.
    pub(super) fn report_memory(&mut self, what: &str, over: OverBudget, at: Span) {
        if !std::mem::replace(&mut self.too_many, true) {
            let error = Diagnostic::error(format!("there is no memory for the {what} of the scene: {over}"));
            self.diagnostics.push(error.label(at, "from here on"));
        }
    }
}
