//! Definitions that are kept as trees of their own.
//!
//! All instances of a definition together make so many objects: those in it, times the places where the text puts it. Where
//! that is more than a sixteenth of what a scene may hold, the definition becomes an [`crate::nested::Assembly`], and an
//! instance of it is one entry, whatever it holds. So a text of a few lines can place 10^9 objects in a few megabytes, and
//! what is placed once or twice keeps the flat list, where rays are faster.
//!
//! Assemblies hold neither what moves, nor lights, nor planes without bounds: definitions with such parts are flat. A
//! definition that holds assemblies is one too if it can be, however small, so that maps are multiplied in one order.

use std::collections::HashMap;

use kajo_math::{DAffine3, Motion};
use kajo_scene::{Diagnostic, Item, Limits, SceneDesc};

use super::Compiler;
use super::definition::Definition;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::group::OBJECTS;
use super::part::{BYTES_PER_OBJECT, Part};
use crate::builder::{self, SceneError};
use crate::ids::AssemblyId;
use crate::material::MaterialId;
use crate::nested::{Assembly, Member, PartContent};

/// Definitions of fewer objects are never worth a tree of their own.
const LEAST: usize = 64;

/// The share of [`kajo_scene::Limits::objects`] up to which the instances of a definition are flat.
const FLAT_SHARE: usize = 16;

/// How often the text places each definition.
pub(super) fn uses(desc: &SceneDesc) -> HashMap<String, usize> {
    let mut uses = HashMap::new();
    for item in desc.items().filter(|item| item.keyword() == "Instance") {
        if let Some(name) = item.word() {
            *uses.entry(name.text().into_owned()).or_insert(0) += 1;
        }
    }
    uses
}

/// What is known of a definition before it is read.
#[derive(Clone, Copy, Default)]
struct Outlook {
    /// How many parts it has at least.
    parts: usize,
    /// Whether any of them moves, so that all are placed one by one wherever the definition is.
    moves: bool,
}

/// Counts the parts of definitions that move, which cannot be kept nested, before any is made: a few lines can ask for as
/// many as memory holds.
///
/// Returns the item with which they are more than `most`, and their number by then.
fn too_many_moving<'t>(desc: &'t SceneDesc, most: usize) -> Option<(Item<'t>, usize)> {
    let mut known: HashMap<String, Outlook> = HashMap::new();
    let mut open: Vec<(Item<'t>, Outlook)> = Vec::new();
    let mut sum = 0usize;
    for item in desc.items() {
        while let Some((define, outlook)) = open.pop_if(|(define, _)| define.next_index() <= item.index()) {
            sum = sum.saturating_add(if outlook.moves { outlook.parts } else { 0 });
            if sum > most {
                return Some((define, sum));
            }
            known.extend(define.word().map(|word| (word.text().into_owned(), outlook)));
        }
        let mut more = Outlook::default();
        match item.keyword() {
            "Define" => {
                open.push((item, Outlook::default()));
                continue;
            }
            "Instance" => {
                let outlook = item.word().and_then(|word| known.get(&*word.text())).copied();
                more = outlook.unwrap_or_default();
                more.moves |= moves(item);
                more.parts = if more.moves { more.parts } else { more.parts.min(1) };
            }
            "Transform" => more.moves = moves(item) && item.children().any(|child| is_object(child)),
            "Group" | "Union" | "Model" => {}
            _ if is_object(item) => more.parts = 1,
            _ => {}
        }
        match open.last_mut() {
            Some((_, outlook)) => {
                outlook.parts = outlook.parts.saturating_add(more.parts);
                outlook.moves |= more.moves;
            }
            None if more.moves => sum = sum.saturating_add(more.parts),
            None => {}
        }
        if sum > most {
            return Some((item, sum));
        }
    }
    None
}

fn moves(item: Item<'_>) -> bool {
    item.children().any(|child| child.keyword() == "Motion")
}

fn is_object(item: Item<'_>) -> bool {
    OBJECTS.contains(&item.keyword())
}

impl Compiler<'_> {
    /// Whether the objects of a scene that move may be made; if not, that is reported.
    pub(super) fn moving_fit(&mut self, desc: &SceneDesc) -> bool {
        let Limits { objects, memory, .. } = &self.options.limits;
        let room = usize::try_from(memory.left()).unwrap_or(usize::MAX) / BYTES_PER_OBJECT;
        let found = too_many_moving(desc, room.min(*objects));
        found.is_none_or(|(item, count)| self.has_room(count, item.head_span(), 0))
    }

    /// The assembly that stands for a definition here; `None` where its parts are to be placed one by one.
    pub(super) fn assembly_of(
        &mut self,
        name: &str,
        definition: &Definition,
        ctm: &CurrentTransform,
        state: &GraphicsState,
        item: Item<'_>,
    ) -> Option<AssemblyId> {
        let id = definition.assembly.or_else(|| self.assemble(name, definition, item))?;
        let assembly = self.scene.nested().assembly(id);
        let light = state.material.is_some_and(|material| self.scene.is_emissive(material));
        let may_stand = ctm.world.constant().is_some() && !(light && assembly.inherits);
        // Where it may not, what holds assemblies cannot be taken apart either, and one error is enough.
        (may_stand || assembly.levels > 1).then_some(id)
    }

    /// Makes an assembly of a definition where that pays and can be.
    fn assemble(&mut self, name: &str, definition: &Definition, item: Item<'_>) -> Option<AssemblyId> {
        let count = definition.parts.len();
        let uses = self.uses.get(name).copied().unwrap_or(0);
        let is_long = count >= LEAST && count.saturating_mul(uses) > self.options.limits.objects / FLAT_SHARE;
        let is_nested = definition.parts.iter().any(|part| matches!(part.content, PartContent::Assembly(_)));
        if !is_long && !is_nested {
            return None;
        }
        let members: Option<Vec<Member>> = definition.parts.iter().map(|part| self.member(part)).collect();
        let assembly = self.scene.assemble(members?).ok();
        if assembly.is_none() {
            self.too_many_to_number(item);
        } else if let Some(definition) = self.definitions.get_mut(name) {
            definition.assembly = assembly;
        }
        assembly
    }

    /// Reports once that numbers of objects do not reach that far.
    fn too_many_to_number(&mut self, item: Item<'_>) {
        if !std::mem::replace(&mut self.too_many, true) {
            let message = "with this there would be more objects than can be numbered, about 4 * 10^9";
            self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "too many"));
        }
    }

    /// A part as a member of an assembly, if it can be one.
    fn member(&self, part: &Part) -> Option<Member> {
        let &Part { content, material, label, .. } = part;
        let part = builder::AssemblyPart { content, map: *part.map.constant()?, material };
        self.scene.member(&part, label).ok()
    }

    /// An assembly as the only part of what is placed.
    pub(super) fn assembly_part(&mut self, assembly: AssemblyId, item: Item<'_>) -> Part {
        Part {
            content: PartContent::Assembly(assembly),
            map: Motion::still(DAffine3::IDENTITY),
            material: None,
            label: self.scene.label(None, "Instance", item.index()),
        }
    }

    /// Whether a part can stand here in a definition; if not, that is reported.
    pub(super) fn may_stand(&mut self, part: &Part, by: Item<'_>, ctm: &CurrentTransform) -> bool {
        let PartContent::Assembly(assembly) = part.content else { return true };
        if ctm.world.constant().is_some() {
            return true;
        }
        let count = self.scene.nested().assembly(assembly).count;
        let message = format!("this would move {count} objects, which are too many to move one by one");
        let error = Diagnostic::error(message).label(by.head_span(), "nested instances cannot move");
        self.diagnostics.push(error);
        false
    }

    /// Places an assembly in the scene.
    ///
    /// * `material`: of its parts that have none, if not the one in force
    pub(super) fn place_assembly(
        &mut self,
        assembly: AssemblyId,
        material: Option<MaterialId>,
        by: Item<'_>,
        ctm: &CurrentTransform,
        state: &GraphicsState,
    ) {
        let Assembly { count, inherits, .. } = *self.scene.nested().assembly(assembly);
        let stands = Part { material, ..self.assembly_part(assembly, by) };
        if ctm.is_flat() || !self.may_stand(&stands, by, ctm) {
            return;
        }
        if self.is_moving() {
            let message =
                format!("this would place {count} objects that move, which are too many to place one by one");
            let error = Diagnostic::error(message)
                .label(by.head_span(), "nested instances cannot stand in `Lorentz`");
            self.diagnostics.push(error);
            return;
        }
        let material = if inherits { material.or_else(|| self.material_for(by, state)) } else { None };
        let Some(map) = ctm.world.constant() else { return };
        match self.scene.put_assembly(assembly, map, material, by.index()) {
            Ok(()) | Err(SceneError::NoMaterial) => {}
            Err(SceneError::EmissivePart) => {
                let message = format!("this would make lights of {count} objects, which are too many");
                let error =
                    Diagnostic::error(message).label(by.head_span(), "nested instances give no light");
                self.diagnostics.push(error);
            }
            Err(_) => self.too_many_to_number(by),
        }
    }
}
