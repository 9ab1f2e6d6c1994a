//! What is chosen: nodes of the text, and the objects of the scene that they make.

use std::ops::Range;

use kajo_edit::preview::{Preview, Vertex};
use kajo_edit::{Document, Kind, NodeId};
use kajo_math::{Aabb, Vec3};

use super::Studio;
use crate::raster::is_within;

/// What is known of a chosen node, to find it again in a text that was written anew.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    id: NodeId,
    keyword: Box<str>,
    name: Option<Box<str>>,
    /// Which of the nodes with this keyword and name it is.
    nth: usize,
}

/// What is chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    nodes: Vec<NodeId>,
    objects: Vec<Range<u32>>,
}

impl Selection {
    /// The nodes, the one chosen last at the end.
    pub fn nodes(&self) -> &[NodeId] {
        &self.nodes
    }

    /// The node chosen last, whose fields are shown.
    pub fn main(&self) -> Option<NodeId> {
        self.nodes.last().copied()
    }

    /// Numbers of the objects that are outlined, in ranges with gaps between them, in order.
    pub fn objects(&self) -> &[Range<u32>] {
        &self.objects
    }

    /// Whether a node is chosen.
    pub fn has(&self, node: NodeId) -> bool {
        self.nodes.contains(&node)
    }

    /// Chooses these nodes and no others.
    pub fn set(&mut self, nodes: Vec<NodeId>, document: &Document) {
        self.nodes = nodes;
        self.refresh(document);
    }

    /// Chooses a node beside the others, or no longer.
    pub fn toggle(&mut self, node: NodeId, document: &Document) {
        match self.nodes.iter().position(|&chosen| chosen == node) {
            Some(at) => drop(self.nodes.remove(at)),
            None => self.nodes.push(node),
        }
        self.refresh(document);
    }

    /// Chooses again what was chosen: where a node is gone, the one like it.
    pub(super) fn find_again(&mut self, chosen: &[Chosen], document: &Document) {
        let find = |chosen: &Chosen| {
            let is_there = document.node(chosen.id).is_some();
            let like = || alike(document, &chosen.keyword, chosen.name.as_deref()).nth(chosen.nth);
            if is_there { Some(chosen.id) } else { like() }
        };
        self.set(chosen.iter().filter_map(find).collect(), document);
    }

    /// Forgets nodes that are gone and finds the objects of the others.
    pub fn refresh(&mut self, document: &Document) {
        self.nodes.retain(|&node| document.node(node).is_some());
        let mut ranges = Vec::new();
        for &node in &self.nodes {
            let objects = match document.node(node).map(|node| node.kind) {
                Some(Kind::Material) => document.objects_painted(node),
                _ => document.objects_of(node),
            };
            ranges.extend(objects.into_iter().map(|number| number..number + 1));
            ranges.extend(document.nested_objects_of(node));
        }
        self.objects = joined(ranges);
    }
}

/// The nodes with a keyword and a name, in their order.
fn alike<'a>(
    document: &'a Document,
    keyword: &'a str,
    name: Option<&'a str>,
) -> impl Iterator<Item = NodeId> + 'a {
    let nodes = document.outline().nodes().iter();
    let same = move |node: &&kajo_edit::Node| &*node.keyword == keyword && node.name.as_deref() == name;
    nodes.filter(same).map(|node| node.id)
}

impl Studio {
    /// What is known of the nodes that are chosen.
    pub(super) fn chosen(&self) -> Vec<Chosen> {
        let Some(document) = &self.document else { return Vec::new() };
        let known = |&id: &NodeId| {
            let node = document.node(id)?;
            let nth = alike(document, &node.keyword, node.name.as_deref()).position(|other| other == id)?;
            Some(Chosen { id, keyword: node.keyword.clone(), name: node.name.clone(), nth })
        };
        self.selection.nodes().iter().filter_map(known).collect()
    }

    /// A box around the objects that are chosen; `None` without any.
    pub fn selection_bounds(&self) -> Option<Aabb> {
        let (_, preview) = self.preview.as_ref()?;
        let bounds = bounds_of(preview, self.selection.objects());
        (!bounds.is_empty() && bounds.is_finite()).then_some(bounds)
    }
}

/// The same numbers in as few ranges as can be, in order.
fn joined(mut ranges: Vec<Range<u32>>) -> Vec<Range<u32>> {
    ranges.sort_unstable_by_key(|range| range.start);
    let mut joined: Vec<Range<u32>> = Vec::new();
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    joined
}

/// A box around objects; of planes around the part that the scene stands on.
///
/// * `objects`: their numbers; see [`is_within`]
fn bounds_of(preview: &Preview, objects: &[Range<u32>]) -> Aabb {
    let margin = 0.5 * preview.bounds.extent();
    let (least, most) = (preview.bounds.min - margin, preview.bounds.max + margin);
    let corners = preview.instances.iter().flat_map(|instance| {
        let vertices = &preview.meshes[instance.mesh as usize].vertices;
        let chosen = vertices.iter().filter(|vertex| is_within(vertex.object + instance.object, objects));
        let place = |vertex: &Vertex| instance.world_from_mesh.transform_point3(Vec3::from(vertex.position));
        chosen.map(move |vertex| place(vertex).clamp(least, most))
    });
    Aabb::around(corners)
}

#[cfg(test)]
mod tests {
    use super::joined;

    #[test]
    fn numbers_side_by_side_are_one_range() {
        assert_eq!(joined(vec![7..8, 1..2, 2..3, 5..9, 2..3]), [1..3, 5..9]);
        assert!(joined(Vec::new()).is_empty());
    }
}
