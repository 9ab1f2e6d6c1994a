//! The blocks of a scene as nodes that keep their identity while the text around them changes.
//!
//! A node is an item with a block, or an `Instance` with or without one. Operations of transforms are values, not
//! nodes. A node is known again after an edit by where its text has gone: the beginning of its keyword is carried
//! through the change. A file included twice gives each of its blocks two nodes with one text.

use std::collections::HashMap;
use std::ops::Range;

use kajo_core::compile::OPERATIONS;
use kajo_scene::{Item, SceneDesc, SourceId};

use super::FileId;
use super::texts::Change;
use kajo::language::{block_in, block_of, kind_of};
use kajo_core::schema::{Block, Kind};

/// A block of a document, the same one after edits elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(u32);

/// A block of the scene's text.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it is known by.
    pub id: NodeId,
    /// What it describes.
    pub kind: Kind,
    /// The word it starts with.
    pub keyword: Box<str>,
    /// The name or word after that.
    pub name: Option<Box<str>>,
    /// The file it stands in.
    pub file: FileId,
    /// Its bytes there.
    pub span: Range<usize>,
    /// How many blocks it stands in.
    pub depth: u32,
    /// The block it stands in.
    pub parent: Option<NodeId>,
    /// The description of such blocks; `None` for one that is unknown where it stands.
    pub(super) block: Option<&'static Block>,
    /// Number of its item among the tree's.
    pub(super) item: u32,
    /// Place of the first node after its subtree in [`Outline::nodes`].
    pub(super) next: u32,
}

/// Where a node's text begins.
type Start = (FileId, usize);

/// All nodes of a document, each before what it holds.
#[derive(Debug, Default)]
pub struct Outline {
    nodes: Vec<Node>,
    indices: HashMap<NodeId, u32>,
}

impl Outline {
    /// All nodes in the order of the text, each before what it holds.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The node with this identity, if it is still there.
    pub fn get(&self, id: NodeId) -> Option<&Node> {
        self.indices.get(&id).map(|&index| &self.nodes[index as usize])
    }

    /// The nodes directly in a block; those in no block for `None`.
    pub fn children(&self, parent: Option<NodeId>) -> impl Iterator<Item = &Node> {
        let range = match parent {
            None => 0..self.nodes.len() as u32,
            Some(id) => self.indices.get(&id).map_or(0..0, |&at| at + 1..self.nodes[at as usize].next),
        };
        let mut at = range.start;
        std::iter::from_fn(move || {
            let node = (at < range.end).then(|| &self.nodes[at as usize])?;
            at = node.next;
            Some(node)
        })
    }

    /// The node and everything in it, in the order of the text.
    pub fn subtree(&self, id: NodeId) -> &[Node] {
        self.indices
            .get(&id)
            .map_or(&[], |&at| &self.nodes[at as usize..self.nodes[at as usize].next as usize])
    }

    /// The node whose item has this number.
    pub(super) fn at_item(&self, item: u32) -> Option<&Node> {
        let index = self.nodes.binary_search_by_key(&item, |node| node.item).ok()?;
        Some(&self.nodes[index])
    }

    /// The last node whose item does not come after this one.
    pub(super) fn last_up_to(&self, item: u32) -> Option<&Node> {
        let index = self.nodes.partition_point(|node| node.item <= item).checked_sub(1)?;
        Some(&self.nodes[index])
    }

    /// The innermost node that holds byte `at` of a file.
    pub fn at_byte(&self, file: FileId, at: usize) -> Option<&Node> {
        self.nodes.iter().rev().find(|node| node.file == file && node.span.contains(&at))
    }
}

impl Outline {
    /// Gives the nodes that are new here the identities of the subtree of `moved` in `old`, if they are as many.
    pub(super) fn keep_identities(&mut self, old: &Outline, moved: NodeId) {
        let new: Vec<NodeId> = missing_from(self, old).map(|node| node.id).collect();
        let was: Vec<NodeId> = old.subtree(moved).iter().map(|node| node.id).collect();
        if new.len() != was.len() || was.iter().any(|id| self.indices.contains_key(id)) {
            return;
        }
        let renamed: HashMap<NodeId, NodeId> = new.into_iter().zip(was).collect();
        for node in &mut self.nodes {
            let rename = |id: NodeId| renamed.get(&id).copied().unwrap_or(id);
            (node.id, node.parent) = (rename(node.id), node.parent.map(rename));
        }
        self.indices = self.nodes.iter().zip(0..).map(|(node, index)| (node.id, index)).collect();
    }
}

/// Hands out identities.
#[derive(Clone, Debug, Default)]
pub(super) struct Identities {
    used: u32,
}

impl Identities {
    fn fresh(&mut self) -> NodeId {
        self.used += 1;
        NodeId(self.used)
    }

    /// The nodes of a tree; those of `old` that `change` leaves keep their identity.
    ///
    /// * `file_of`: the document's file for each source of the tree
    /// * `remembered`: identities of nodes that come back
    pub fn outline(
        &mut self,
        desc: &SceneDesc,
        file_of: impl Fn(SourceId) -> FileId,
        old: &Outline,
        change: &Change,
        remembered: &[(FileId, usize, NodeId)],
    ) -> Outline {
        let mut known = known_ids(old, change, remembered);
        let mut outline = Outline::default();
        let mut open: Vec<u32> = Vec::new();
        let mut skip_to = 0;
        for item in desc.items() {
            if item.index() < skip_to {
                continue;
            }
            while let Some(&at) = open.last()
                && !is_within(item, desc, outline.nodes[at as usize].item)
            {
                outline.nodes[at as usize].next = outline.nodes.len() as u32;
                open.pop();
            }
            if !is_node(item) {
                skip_to = item.next_index();
                continue;
            }
            let span = item.span();
            let start = (file_of(span.source), span.range().start);
            let id = known.get_mut(&start).and_then(Vec::pop).unwrap_or_else(|| self.fresh());
            let parent = open.last().map(|&at| &outline.nodes[at as usize]);
            let block = match parent {
                None => block_of(item.keyword()),
                Some(parent) => parent.block.and_then(|parent| block_in(Some(parent), item.keyword())),
            };
            let kind = || kind_of(item.keyword(), parent.map(|node| node.kind));
            let node = Node {
                id,
                kind: block.map_or_else(kind, |block| block.kind),
                keyword: item.keyword().into(),
                name: item.word().map(|word| word.text().into()),
                file: start.0,
                span: span.range(),
                depth: open.len() as u32,
                parent: parent.map(|node| node.id),
                block,
                item: item.index(),
                next: 0,
            };
            let at = outline.nodes.len() as u32;
            outline.indices.insert(id, at);
            outline.nodes.push(node);
            open.push(at);
        }
        let n = outline.nodes.len() as u32;
        open.into_iter().for_each(|at| outline.nodes[at as usize].next = n);
        outline
    }
}

/// The identities that nodes have by where they begin now; taken from the end they are first come first served.
fn known_ids(
    old: &Outline,
    change: &Change,
    remembered: &[(FileId, usize, NodeId)],
) -> HashMap<Start, Vec<NodeId>> {
    let mut known: HashMap<Start, Vec<NodeId>> = HashMap::new();
    for node in &old.nodes {
        if let Some(at) = change.carry(node.file, node.span.start) {
            known.entry((node.file, at)).or_default().push(node.id);
        }
    }
    for &(file, at, id) in remembered {
        known.entry((file, at)).or_default().push(id);
    }
    known.values_mut().for_each(|ids| ids.reverse());
    known
}

fn is_within(item: Item<'_>, desc: &SceneDesc, outer: u32) -> bool {
    desc.item(outer).is_some_and(|outer| item.index() < outer.next_index())
}

fn is_node(item: Item<'_>) -> bool {
    item.keyword() == "Instance" || item.has_block() && !OPERATIONS.contains(&item.keyword())
}

/// The nodes of `outline` that are not in `other`, in the order of the text.
pub(super) fn missing_from<'a>(outline: &'a Outline, other: &'a Outline) -> impl Iterator<Item = &'a Node> {
    outline.nodes.iter().filter(|node| !other.indices.contains_key(&node.id))
}

/// The nodes of `outline` that `change` does not lead to where they are in `other`, with where their texts begin.
pub(super) fn not_carried(
    outline: &Outline,
    change: &Change,
    other: &Outline,
) -> Vec<(FileId, usize, NodeId)> {
    let is_carried = |node: &Node| {
        let there = other.get(node.id).map(|node| (node.file, node.span.start));
        there.is_some() && there == change.carry(node.file, node.span.start).map(|at| (node.file, at))
    };
    let nodes = outline.nodes.iter().filter(|node| !is_carried(node));
    nodes.map(|node| (node.file, node.span.start, node.id)).collect()
}
