//! Which material is where: `MaterialIndex` is a running state of the text.
//!
//! It holds for all objects after it, past the end of the group it stands in; a definition begins without one and
//! does not change it for what follows. Objects that are painted, moved, copied or deleted must not change
//! the material of others, so `MaterialIndex` items are put around them where needed.
//!
//! The `material` of a set operation is that of all that stands in it, and no `MaterialIndex` is put there.

use std::borrow::Cow;
use std::ops::Range;

use kajo_scene::Item;

use super::fields::fields_of;
use super::tree::Tree;
use super::{EditRefused, FieldValue, FileId, Node, TextEdit, layout};
use kajo_core::compile::kind_of;
use kajo_core::schema::quoted;
use kajo_core::schema::{FieldKind, Kind};

const INDEX: &str = "MaterialIndex";

impl Tree {
    /// The blocks of all materials, in their order.
    pub(super) fn materials(&self) -> impl Iterator<Item = &Node> {
        let list = self.root(Kind::Materials).map(|node| node.id);
        list.into_iter().flat_map(|id| self.outline.children(Some(id))).filter(|n| n.kind == Kind::Material)
    }

    /// The material that a reference means.
    pub(super) fn meant(&self, reference: Item<'_>) -> Option<&Node> {
        match reference.word() {
            Some(word) => {
                let name = word.text();
                self.materials().find(|node| node.name.as_deref() == Some(&*name))
            }
            None => {
                let (number, _) = reference.numbers().next()?;
                (number >= 0.0 && number.fract() == 0.0).then(|| self.materials().nth(number as usize))?
            }
        }
    }

    /// How a material is referred to.
    pub(super) fn reference<'a>(&self, material: &'a Node) -> Cow<'a, str> {
        match &material.name {
            Some(name) => quoted(name),
            None => Cow::Owned(self.materials().position(|n| n.id == material.id).unwrap_or(0).to_string()),
        }
    }

    /// Every item that refers to a material, in the order of the text: `MaterialIndex` of objects, and values of blocks.
    pub(super) fn references(&self) -> impl Iterator<Item = Item<'_>> {
        let indices = self.desc.items().filter(|item| item.keyword() == INDEX);
        let values = self.outline.nodes().iter().flat_map(|node| self.references_of(node));
        let mut all: Vec<Item<'_>> = indices.chain(values).collect();
        all.sort_by_key(Item::index);
        all.into_iter()
    }

    /// The values of a block that name materials.
    fn references_of<'a>(&'a self, node: &'a Node) -> impl Iterator<Item = Item<'a>> {
        let names = |item: &Item<'_>| {
            let mut fields = fields_of(node).filter(|field| field.kind == FieldKind::Material);
            fields.any(|field| field.key == item.keyword())
        };
        let may_have = fields_of(node).any(|field| field.kind == FieldKind::Material);
        let values = may_have.then(|| self.values_of(node));
        values.into_iter().flatten().filter(names)
    }

    /// What gives all objects in a block, and those in it, one material: the outermost set operation with a `material` that
    /// the block is or stands in, and that value.
    pub(super) fn painted_by<'a>(&'a self, node: Option<&'a Node>) -> Option<(&'a Node, Item<'a>)> {
        let around = std::iter::successors(node, |inner| self.parent(inner));
        let around =
            around.take_while(|node| node.kind != Kind::Define).filter(|node| node.kind == Kind::Group);
        around.filter_map(|node| Some((node, self.references_of(node).last()?))).last()
    }

    /// The material of an object; for a group that of its first object.
    pub(super) fn material_of(&self, node: &Node) -> Option<&Node> {
        let item = self.item(node)?;
        let within = (item.index()..item.next_index()).filter_map(|i| self.desc.item(i));
        let first = within.filter(|&i| is_painted(i)).map(|i| i.index()).next().unwrap_or(item.index());
        let by_operation = self.painted_by(self.node_around(first)).map(|(_, reference)| reference);
        self.meant(by_operation.or_else(|| self.in_force(first))?)
    }

    /// The `MaterialIndex` that holds just before the item with this number.
    pub(super) fn in_force(&self, before: u32) -> Option<Item<'_>> {
        let mut state: Option<Item<'_>> = None;
        let mut outer: Vec<(u32, Option<Item<'_>>)> = Vec::new();
        for item in self.desc.items().take(before as usize + 1) {
            while let Some(&(end, saved)) = outer.last()
                && item.index() >= end
            {
                state = saved;
                outer.pop();
            }
            match item.keyword() {
                _ if item.index() == before => break,
                "Define" => outer.push((item.next_index(), std::mem::take(&mut state))),
                INDEX => state = Some(item),
                _ => {}
            }
        }
        state
    }

    /// Whether an object from item `from` on takes the material in force there.
    fn is_used_from(&self, from: u32) -> bool {
        let enclosing =
            |item: &Item<'_>| item.keyword() == "Define" && item.index() < from && from < item.next_index();
        let end = self.desc.items().filter(enclosing).map(|item| item.next_index()).min().unwrap_or(u32::MAX);
        let mut at = from;
        while let Some(item) = self.desc.item(at).filter(|_| at < end) {
            match item.keyword() {
                INDEX => return false,
                "Define" => at = item.next_index(),
                _ if is_painted(item) => return true,
                _ => at += 1,
            }
        }
        false
    }

    /// The text of the last `MaterialIndex` in a subtree that holds after it.
    fn last_within(&self, item: Item<'_>) -> Option<&str> {
        let (mut at, mut last) = (item.index(), None);
        while let Some(inner) = self.desc.item(at).filter(|_| at < item.next_index()) {
            match inner.keyword() {
                "Define" => at = inner.next_index(),
                INDEX => {
                    last = Some(self.source_of(inner));
                    at += 1;
                }
                _ => at += 1,
            }
        }
        last
    }

    /// The bytes of an item.
    pub(super) fn source_of(&self, item: Item<'_>) -> &str {
        let (file, range) = self.range(item);
        &self.text(file)[range]
    }

    /// What must stand where a subtree is taken out, so that what follows keeps its material.
    pub(super) fn left_behind(&self, node: &Node) -> String {
        let Some(item) = self.item(node).filter(|_| node.kind != Kind::Define) else { return String::new() };
        let last = self.last_within(item).filter(|_| self.is_used_from(item.next_index()));
        last.map_or_else(String::new, str::to_owned)
    }

    /// The text of an object for another place, with what keeps its material and that of what follows there.
    ///
    /// * `into`: the block in which the text will stand, before item `to`
    pub(super) fn transplanted(&self, node: &Node, into: &Node, to: u32) -> String {
        let Some(item) = self.item(node) else { return String::new() };
        let text = self.source_of(item);
        if self.painted_by(Some(into)).is_some() {
            return text.to_owned();
        }
        let index = |item: Option<Item<'_>>| item.map(|item| self.source_of(item));
        let there = index(self.in_force(to));
        let painted = self.painted_by(self.parent(node)).map(|(_, reference)| self.as_index(reference));
        let own = painted.as_deref().or_else(|| index(self.in_force(item.index())));
        let needs_own = own != there && self.is_used_within(item);
        let before = own.filter(|_| needs_own).map_or_else(String::new, |own| format!("{own}  "));
        let leaves = self.last_within(item).or(own.filter(|_| needs_own));
        let is_disturbed = leaves.is_some_and(|leaves| Some(leaves) != there) && self.is_used_from(to);
        let after = there.filter(|_| is_disturbed).map_or_else(String::new, |there| format!("  {there}"));
        format!("{before}{text}{after}")
    }

    /// The `MaterialIndex` that means what a value means.
    fn as_index(&self, reference: Item<'_>) -> String {
        let text = self.source_of(reference);
        format!("{INDEX}{}", text.strip_prefix(reference.keyword()).unwrap_or(text))
    }

    /// Whether a subtree takes the material in force before it.
    fn is_used_within(&self, item: Item<'_>) -> bool {
        let mut at = item.index();
        while let Some(inner) = self.desc.item(at).filter(|_| at < item.next_index()) {
            match inner.keyword() {
                INDEX => return false,
                "Define" => at = inner.next_index(),
                _ if is_painted(inner) => return true,
                _ => at += 1,
            }
        }
        false
    }

    /// Gives an object another material.
    pub(super) fn paint(&self, node: &Node, material: &Node) -> Result<Vec<TextEdit>, EditRefused> {
        if !node.kind.is_object() || material.kind != Kind::Material {
            return Err(EditRefused::new("only objects have materials"));
        }
        if self.parent(node).is_none() {
            return Err(EditRefused::new("select the objects in the scene's group"));
        }
        let Some(item) = self.item(node) else { return Ok(Vec::new()) };
        if let Some((around, _)) = self.painted_by(self.parent(node)) {
            let message =
                format!("the `{}` that it stands in has one material for all: paint that", around.keyword);
            return Err(EditRefused::new(message));
        }
        if let Some((_, own)) = self.painted_by(Some(node)) {
            return Ok(self.set_reference(own, material));
        }
        let inner: Vec<Item<'_>> = self.indices_within(item).collect();
        if !inner.is_empty() {
            return Ok(self.repaint(&inner, item, material));
        }
        let current = self.in_force(item.index());
        if current.and_then(|current| self.meant(current)).is_some_and(|meant| meant.id == material.id) {
            return Ok(Vec::new());
        }
        let text = self.text(node.file);
        // An index for this object alone is set to the new material.
        if let Some(own) =
            current.filter(|own| own.next_index() == item.index() && !self.is_used_from(item.next_index()))
            && self.is_in_block_of(own, node)
        {
            return Ok(self.set_reference(own, material));
        }
        let piece = format!("{INDEX} {}", self.reference(material));
        let (at, new) = layout::before(text, node.span.start, &piece);
        let mut edits = vec![TextEdit::insert(node.file, at, new)];
        if let Some(current) = current.filter(|_| self.is_used_from(item.next_index())) {
            let (at, new) = layout::after(text, &node.span, self.source_of(current));
            edits.push(TextEdit::insert(node.file, at, new));
        }
        Ok(edits)
    }

    /// What says of what material the objects in a block are: each `MaterialIndex`, and each `material` of a set operation.
    fn indices_within<'a>(&'a self, item: Item<'a>) -> impl Iterator<Item = Item<'a>> {
        let within = (item.index()..item.next_index()).filter_map(|i| self.desc.item(i));
        within.filter(|&inner| {
            let is_of_operation = || {
                let node = self.node_around(inner.index()).filter(|node| node.kind == Kind::Group);
                node.is_some_and(|node| self.references_of(node).any(|own| own.index() == inner.index()))
            };
            inner.keyword() == INDEX || is_of_operation()
        })
    }

    /// Sets all indices of a group, and one for what stands in it before the first.
    fn repaint(&self, inner: &[Item<'_>], group: Item<'_>, material: &Node) -> Vec<TextEdit> {
        let mut edits: Vec<TextEdit> = inner.iter().flat_map(|&i| self.set_reference(i, material)).collect();
        let (file, span) = self.range(group);
        if self.is_used_within(group) {
            let piece = format!("{INDEX} {}", self.reference(material));
            let (at, new) = layout::before(self.text(file), span.start, &piece);
            edits.push(TextEdit::insert(file, at, new));
        }
        if let Some(last) = self.last_within(group).filter(|_| self.is_used_from(group.next_index())) {
            let (at, new) = layout::after(self.text(file), &span, last);
            edits.push(TextEdit::insert(file, at, new));
        }
        edits
    }

    fn is_in_block_of(&self, item: Item<'_>, node: &Node) -> bool {
        let beside = self.parent(node).into_iter().flat_map(|parent| self.values_of(parent));
        beside.into_iter().any(|other| other.index() == item.index()) && self.range(item).0 == node.file
    }

    /// Makes a reference mean this material.
    pub(super) fn set_reference(&self, reference: Item<'_>, material: &Node) -> Vec<TextEdit> {
        let value = match &material.name {
            Some(name) => FieldValue::word(&**name),
            None => {
                let index = self.materials().position(|n| n.id == material.id).unwrap_or(0);
                FieldValue::numbers([index as f64])
            }
        };
        self.replace_values(reference, &value)
    }

    /// An error that names who refers to a material, if anybody does; else the edits that keep the other references by
    /// number right when it goes.
    pub(super) fn without_material(&self, material: &Node) -> Result<Vec<TextEdit>, EditRefused> {
        let Some(index) = self.materials().position(|node| node.id == material.id) else {
            return Ok(Vec::new());
        };
        let own = self.item(material).map_or(0..0, |item| item.index()..item.next_index());
        let mut edits = Vec::new();
        for reference in self.references().filter(|reference| !own.contains(&reference.index())) {
            if self.meant(reference).is_some_and(|meant| meant.id == material.id) {
                let (file, range) = self.range(reference);
                return Err(EditRefused::new(format!(
                    "this material is in use: {} names it",
                    self.line_of(file, &range)
                )));
            }
            let later =
                reference.numbers().next().filter(|&(n, _)| reference.word().is_none() && n > index as f64);
            if let Some((number, _)) = later {
                edits.extend(self.replace_values(reference, &FieldValue::numbers([number - 1.0])));
            }
        }
        // A file included twice has two items of one text.
        edits.sort_by_key(|edit| (edit.file, edit.range.start));
        edits.dedup();
        Ok(edits)
    }

    /// `line 12`, and the file where it is not the scene's own.
    pub(super) fn line_of(&self, file: FileId, range: &Range<usize>) -> String {
        let source = self.desc.sources().iter().find(|&(source, _)| self.file_of(source) == file);
        let Some((_, source)) = source else { return "another file".to_owned() };
        let line = source.position(range.start as u32).line;
        if file == FileId(0) { format!("line {line}") } else { format!("line {line} of {}", source.path()) }
    }
}

/// Whether an item is an object that takes the material in force.
fn is_painted(item: Item<'_>) -> bool {
    matches!(kind_of(item.keyword(), Some(Kind::Group)), Kind::Shape | Kind::Instance)
}
