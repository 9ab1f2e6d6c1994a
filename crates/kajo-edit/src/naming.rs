//! Names of nodes, and the references that follow them.

use std::ops::Range;

use super::tree::Tree;
use super::{EditRefused, FieldValue, Node, TextEdit};
use kajo_core::schema::Kind;
use kajo_core::schema::quoted;

impl Tree {
    /// Gives a node another name, or none.
    pub(super) fn rename(&self, node: &Node, name: Option<&str>) -> Result<Vec<TextEdit>, EditRefused> {
        let name = name.map(str::trim).filter(|name| !name.is_empty());
        self.check_name(node, name)?;
        let Some(item) = self.item(node) else { return Ok(Vec::new()) };
        let keyword_end = item.keyword_span().range().end;
        let (range, new) = match (item.word().map(|word| word.span.range()), name) {
            (Some(old), Some(name)) => (old, quoted(name).into_owned()),
            (Some(old), None) => (keyword_end..old.end, String::new()),
            (None, Some(name)) => (keyword_end..keyword_end, self.separated(node, keyword_end, name)),
            (None, None) => return Ok(Vec::new()),
        };
        let mut edits = vec![TextEdit { file: node.file, range, new }];
        match node.kind {
            Kind::Material => edits.extend(self.references_renamed(node, name)),
            Kind::Define => edits.extend(self.instances_renamed(node, name.unwrap_or_default())),
            _ => {}
        }
        edits.sort_by_key(|edit| (edit.file, edit.range.start));
        edits.dedup();
        Ok(edits)
    }

    fn check_name(&self, node: &Node, name: Option<&str>) -> Result<(), EditRefused> {
        let refused = |reason: String| Err(EditRefused::new(reason));
        if !node.kind.is_object() && !matches!(node.kind, Kind::Material | Kind::Light | Kind::Define) {
            return refused(format!("`{}` has no name", node.keyword));
        }
        if matches!(node.kind, Kind::Instance | Kind::Transform) {
            return refused(format!("`{}` has no name of its own", node.keyword));
        }
        if name.is_some_and(|name| name.contains(char::is_control)) {
            return refused("a name stands in one line".to_owned());
        }
        if node.kind == Kind::Define && name.is_none() {
            return refused("a definition needs a name".to_owned());
        }
        let must_differ = matches!(node.kind, Kind::Material | Kind::Define);
        let others =
            self.outline.nodes().iter().filter(|other| other.kind == node.kind && other.id != node.id);
        if let Some(name) = name.filter(|_| must_differ)
            && others.into_iter().any(|other| other.name.as_deref() == Some(name))
        {
            return refused(format!("there is another one named `{name}`"));
        }
        Ok(())
    }

    fn separated(&self, node: &Node, at: usize, name: &str) -> String {
        let follows = self.text(node.file)[at..].chars().next();
        let gap = if follows.is_none_or(char::is_whitespace) { "" } else { " " };
        format!(" {}{gap}", quoted(name))
    }

    /// References by name to a material that gets another one, or none.
    fn references_renamed(&self, material: &Node, name: Option<&str>) -> Vec<TextEdit> {
        let value = match name {
            Some(name) => FieldValue::word(name),
            None => {
                let index = self.materials().position(|n| n.id == material.id).unwrap_or(0);
                FieldValue::numbers([index as f64])
            }
        };
        let by_name = self.references().filter(|item| item.word().is_some());
        let meant = by_name.filter(|&item| self.meant(item).is_some_and(|meant| meant.id == material.id));
        meant.flat_map(|item| self.replace_values(item, &value)).collect()
    }

    fn instances_renamed(&self, definition: &Node, name: &str) -> Vec<TextEdit> {
        let edit =
            |(file, range): (_, Range<usize>)| TextEdit { file, range, new: quoted(name).into_owned() };
        let instances = self.instances_of(definition);
        instances.filter_map(|node| Some(edit(self.range_of(self.item(node)?.word()?.span)))).collect()
    }

    /// The instances of a definition.
    pub(super) fn instances_of<'a>(&'a self, definition: &'a Node) -> impl Iterator<Item = &'a Node> {
        let all = self.outline.nodes().iter().filter(|node| node.kind == Kind::Instance);
        all.filter(|node| node.name.is_some() && node.name == definition.name)
    }
}
