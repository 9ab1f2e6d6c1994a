//! What is chosen: nodes of the text, and the objects of the scene that they make.

use kajo::edit::{Document, Kind, NodeId};
use kajo::preview::Preview;
use kajo_math::{Aabb, Vec3};

use super::Studio;

/// What is chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    nodes: Vec<NodeId>,
    objects: Vec<u32>,
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

    /// Numbers of the objects that are outlined, in order.
    pub fn objects(&self) -> &[u32] {
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

    /// Forgets nodes that are gone and finds the objects of the others.
    pub fn refresh(&mut self, document: &Document) {
        self.nodes.retain(|&node| document.node(node).is_some());
        let objects = |&node: &NodeId| match document.node(node).map(|node| node.kind) {
            Some(Kind::Material) => document.objects_painted(node),
            _ => document.objects_of(node),
        };
        self.objects = self.nodes.iter().flat_map(objects).collect();
        self.objects.sort_unstable();
        self.objects.dedup();
    }
}

impl Studio {
    /// A box around the objects that are chosen; `None` without any.
    pub fn selection_bounds(&self) -> Option<Aabb> {
        let (_, preview) = self.preview.as_ref()?;
        let bounds = bounds_of(preview, self.selection.objects());
        (!bounds.is_empty() && bounds.is_finite()).then_some(bounds)
    }
}

/// A box around objects.
///
/// * `objects`: their numbers, in order
fn bounds_of(preview: &Preview, objects: &[u32]) -> Aabb {
    let corners = preview.instances.iter().flat_map(|instance| {
        let vertices = &preview.meshes[instance.mesh as usize].vertices;
        let chosen = vertices
            .iter()
            .filter(|vertex| objects.binary_search(&(vertex.object + instance.object)).is_ok());
        chosen.map(|vertex| instance.world_from_mesh.transform_point3(Vec3::from(vertex.position)))
    });
    Aabb::around(corners)
}
