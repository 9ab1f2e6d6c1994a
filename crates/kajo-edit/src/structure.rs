//! Blocks added, copied, moved and taken out, with the counts that must agree with them.

use std::ops::Range;

use kajo_scene::SceneDesc;

use super::fields::fields_of;
use super::tree::Tree;
use super::{EditRefused, FieldValue, Node, TextEdit, layout};
use kajo_core::compile::kind_of;
use kajo_core::schema::{FieldKind, Kind};

impl Tree {
    /// Adds a block to `into`, or where such blocks stand.
    pub(super) fn add(&self, into: Option<&Node>, block: &str) -> Result<Vec<TextEdit>, EditRefused> {
        let (keyword, is_one) = only_item(block);
        let kind = if is_one { kind_of(&keyword, None) } else { Kind::Part };
        let holder = match kind {
            Kind::Light => Some(Kind::Lights),
            Kind::Material => Some(Kind::Materials),
            Kind::Texture => Some(Kind::Textures),
            Kind::Medium => Some(Kind::Media),
            Kind::Define => Some(Kind::Group),
            _ if kind.is_object() => Some(Kind::Group),
            Kind::Part => return Err(EditRefused::new("that is not one block of the language")),
            _ => None,
        };
        let Some(holder) = holder else {
            if self.root(kind).is_some_and(|_| kind != Kind::Group) {
                return Err(EditRefused::new(format!("there is a block of this kind already: {keyword}")));
            }
            return Ok(self.add_at_end(block));
        };
        let into = into.filter(|node| node.kind.holds_objects() && holder == Kind::Group);
        let mut edits = Vec::new();
        let block = match holder {
            Kind::Group if kind != Kind::Define => {
                self.with_material(into.or(self.root(holder)), block, &mut edits)
            }
            Kind::Group | Kind::Materials => self.with_free_name(kind, block),
            _ => block.to_owned(),
        };
        match into.or(self.root(holder)) {
            Some(node) => edits.extend(self.put_last(node, &block, kind)?),
            None => {
                let keyword = match holder {
                    Kind::Light | Kind::Lights => "Lights",
                    Kind::Materials => "Materials",
                    Kind::Textures => "Textures",
                    Kind::Media => "Media",
                    _ => "Group",
                };
                edits.extend(self.add_at_end(&layout::block(self.text(super::FileId(0)), keyword, &block)));
            }
        }
        Ok(edits)
    }

    /// The block with a material before it, where none is in force; the first material is made if there is none.
    fn with_material(&self, into: Option<&Node>, block: &str, edits: &mut Vec<TextEdit>) -> String {
        let at = into.and_then(|node| self.item(node)).map_or(u32::MAX - 1, |item| item.next_index());
        let is_defined = into.is_some_and(|node| self.is_within_definition(node));
        if is_defined || self.in_force(at).is_some() || self.painted_by(into).is_some() {
            return block.to_owned();
        }
        let first = self.materials().next();
        if first.is_none() {
            match self.root(Kind::Materials) {
                Some(list) => {
                    edits.extend(self.put_last(list, "Matte { }", Kind::Material).unwrap_or_default())
                }
                None => edits.extend(self.add_at_end("Materials { Matte { } }")),
            }
        }
        let reference = first.map_or("0".into(), |material| self.reference(material));
        format!("MaterialIndex {reference}  {block}")
    }

    fn add_at_end(&self, block: &str) -> Vec<TextEdit> {
        let file = super::FileId(0);
        let (at, new) = layout::at_end(self.text(file), block);
        vec![TextEdit::insert(file, at, new)]
    }

    /// Puts a block last into another, and counts it.
    fn put_last(&self, into: &Node, block: &str, kind: Kind) -> Result<Vec<TextEdit>, EditRefused> {
        let mut edits = vec![self.inserted_last(into, block)?];
        edits.extend(self.recounted(into, 1, kind));
        Ok(edits)
    }

    /// Puts a piece last into a block.
    fn inserted_last(&self, into: &Node, block: &str) -> Result<TextEdit, EditRefused> {
        let text = self.text(into.file);
        let (at, new) = match self.last_in_text(into) {
            // The end of what is included is not in this file.
            _ if self.ends_with_include(into) => layout::before(text, into.span.end - 1, block),
            Some(last) => layout::after(text, &last, block),
            None => layout::first_in(text, &into.span, block)
                .ok_or_else(|| EditRefused::new(format!("`{}` has no block", into.keyword)))?,
        };
        Ok(TextEdit::insert(into.file, at, new))
    }

    /// The bytes of what stands last in a block, of what its own file has there.
    fn last_in_text(&self, node: &Node) -> Option<Range<usize>> {
        let children = self.item(node).into_iter().flat_map(|item| item.children());
        children
            .map(|item| self.range(item))
            .filter(|(file, _)| *file == node.file)
            .last()
            .map(|(_, range)| range)
    }

    /// Whether what stands last in a block comes from another file.
    fn ends_with_include(&self, node: &Node) -> bool {
        let last = self.item(node).and_then(|item| item.children().last());
        last.is_some_and(|item| self.file_of(item.span().source) != node.file)
    }

    /// The edit of the count in a block that holds `more` blocks of a kind than before.
    fn recounted(&self, holder: &Node, more: i32, kind: Kind) -> Vec<TextEdit> {
        let is_counted = kind.is_object() || matches!(kind, Kind::Light | Kind::Material);
        let count = fields_of(holder).find(|field| field.kind == FieldKind::Count);
        let Some(count) = count.filter(|_| is_counted) else { return Vec::new() };
        let Some(item) = self.value_item(holder, count.key, None) else { return Vec::new() };
        let Some((count, _)) = item.numbers().next() else { return Vec::new() };
        self.replace_values(item, &FieldValue::numbers([count + f64::from(more)]))
    }

    /// Puts a copy of a block after it.
    pub(super) fn duplicate(&self, node: &Node) -> Result<Vec<TextEdit>, EditRefused> {
        let Some((parent, item)) = self.parent(node).zip(self.item(node)) else {
            return Err(EditRefused::new(format!("a scene has one `{}`", node.keyword)));
        };
        let (copy, after) = match node.kind {
            Kind::Light => (self.source_of(item).to_owned(), Some(node)),
            // Materials are known by number: the copy comes last.
            Kind::Material => (self.renamed_copy(node), None),
            Kind::Define => (self.renamed_copy(node), Some(node)),
            kind if kind.is_object() => (self.transplanted(node, parent, item.next_index()), Some(node)),
            _ => return Err(EditRefused::new(format!("a second `{}` would mean nothing", node.keyword))),
        };
        let Some(after) = after else { return self.put_last(parent, &copy, node.kind) };
        let (at, new) = layout::after(self.text(after.file), &after.span, &copy);
        let mut edits = vec![TextEdit::insert(after.file, at, new)];
        edits.extend(self.recounted(parent, 1, node.kind));
        Ok(edits)
    }

    /// The text of a node whose name must differ from all others, with such a name.
    fn renamed_copy(&self, node: &Node) -> String {
        self.item(node).map_or_else(String::new, |item| self.with_free_name(node.kind, self.source_of(item)))
    }

    /// The text of a block, with another name where one of that kind has its name already.
    fn with_free_name(&self, kind: Kind, block: &str) -> String {
        let parsed = SceneDesc::parse_str(block);
        let Some(word) = parsed.desc.roots().next().and_then(|item| item.word()) else {
            return block.to_owned();
        };
        let name = word.text();
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        let taken = |name: &str| {
            self.outline.nodes().iter().any(|n| n.kind == kind && n.name.as_deref() == Some(name))
        };
        if !taken(&name) {
            return block.to_owned();
        }
        let fresh = (2..).map(|i: u32| format!("{stem}_{i}")).find(|name| !taken(name)).unwrap_or_default();
        let range = word.span.range();
        let quoted = kajo_core::schema::quoted(&fresh);
        format!("{}{quoted}{}", &block[..range.start], &block[range.end..])
    }

    /// Takes a block out.
    pub(super) fn delete(&self, node: &Node) -> Result<Vec<TextEdit>, EditRefused> {
        let mut edits = match node.kind {
            Kind::Material => self.without_material(node)?,
            Kind::Materials => {
                self.outline
                    .children(Some(node.id))
                    .try_for_each(|m| self.without_material(m).map(|_| ()))?;
                Vec::new()
            }
            Kind::Define => match self.instances_of(node).next() {
                Some(instance) => {
                    let place = self.line_of(instance.file, &instance.span);
                    return Err(EditRefused::new(format!("this definition is in use: {place} places it")));
                }
                None => Vec::new(),
            },
            _ => Vec::new(),
        };
        let node = self.sole_content_of(node);
        edits.push(self.taken_out(node));
        if let Some(parent) = self.parent(node) {
            edits.extend(self.recounted(parent, -1, node.kind));
        }
        Ok(edits)
    }

    /// The outermost transform that holds nothing but this node, or the node itself.
    pub(super) fn sole_content_of<'a>(&'a self, node: &'a Node) -> &'a Node {
        let mut outermost = node;
        while let Some(parent) = self.parent(outermost)
            && parent.kind == Kind::Transform
            && parent.file == outermost.file
            && self.outline.children(Some(parent.id)).count() == 1
        {
            outermost = parent;
        }
        outermost
    }

    /// Moves an object to the end of a group.
    pub(super) fn move_into(&self, node: &Node, into: &Node) -> Result<Vec<TextEdit>, EditRefused> {
        let refused = |reason: &str| Err(EditRefused::new(reason));
        if !node.kind.is_object() || self.parent(node).is_none() {
            return refused("only objects can be moved to a group");
        }
        if !into.kind.holds_objects() {
            return refused("objects can be moved to groups, definitions and transforms only");
        }
        if node.file != into.file {
            return refused("they stand in different files");
        }
        // By their texts: of a file included twice there are two nodes of one text.
        if node.span.contains(&into.span.start) {
            return refused("a group cannot be moved into itself");
        }
        if self.is_used_before_defined(node, into) {
            return refused("a definition must stand before what uses it");
        }
        let Some(target) = self.item(into) else { return Ok(Vec::new()) };
        // By its text: of a file included twice, and of what is repeated, it is last there as another node.
        if !self.ends_with_include(into) && self.last_in_text(into).as_ref() == Some(&node.span) {
            return Ok(Vec::new());
        }
        let text = self.transplanted(node, into, target.next_index());
        let mut edits = vec![self.inserted_last(into, &text)?, self.taken_out(node)];
        // Two nodes of one text hold the same.
        let is_elsewhere = |from: &Node| from.file != into.file || from.span != into.span;
        if self.parent(node).is_some_and(is_elsewhere) {
            edits.extend(self.recounted(into, 1, node.kind));
            edits.extend(self.parent(node).map_or_else(Vec::new, |from| self.recounted(from, -1, node.kind)));
        }
        Ok(edits)
    }

    /// Takes out the text of a node, but for what keeps the material of what follows.
    fn taken_out(&self, node: &Node) -> TextEdit {
        let left_behind = self.left_behind(node);
        let range = match left_behind.is_empty() {
            true => layout::removal(self.text(node.file), &node.span),
            false => node.span.clone(),
        };
        TextEdit { file: node.file, range, new: left_behind }
    }

    /// Whether a node places a definition that comes after, or is, the one it would be moved into.
    fn is_used_before_defined(&self, node: &Node, into: &Node) -> bool {
        let instances = self.outline.subtree(node.id).iter().filter(|inner| inner.kind == Kind::Instance);
        let names: Vec<&str> = instances.filter_map(|instance| instance.name.as_deref()).collect();
        let ends_later = |define: &Node| {
            self.item(define).zip(self.item(into)).is_none_or(|(d, i)| d.next_index() > i.index())
        };
        self.outline.nodes().iter().any(|define| {
            let is_placed = define.name.as_deref().is_some_and(|name| names.contains(&name));
            define.kind == Kind::Define && is_placed && ends_later(define)
        })
    }

    /// Whether a node stands in a definition, or is one.
    pub(super) fn is_within_definition(&self, node: &Node) -> bool {
        let mut at = Some(node);
        while let Some(node) = at {
            if node.kind == Kind::Define {
                return true;
            }
            at = self.parent(node);
        }
        false
    }
}

/// The keyword that a text begins with, and whether it is one block and nothing else.
fn only_item(text: &str) -> (String, bool) {
    let parsed = SceneDesc::parse_str(text);
    let mut roots = parsed.desc.roots();
    let first = roots.next();
    let is_one = parsed.whole && !parsed.diagnostics.has_errors() && roots.next().is_none();
    (first.map_or_else(String::new, |item| item.keyword().to_owned()), is_one && first.is_some())
}
