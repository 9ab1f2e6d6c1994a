//! Where nodes stand in the world.

use kajo_core::compile::operations_matrix;
use kajo_core::settings::Dialect;
use kajo_math::DAffine3;

use super::Node;
use super::tree::Tree;
use kajo_core::schema::Kind;

/// Blocks that one may stand in before we stop counting; the parser allows fewer, but definitions add up.
const DEEPEST: u32 = 4096;

impl Tree {
    /// The map to the world from the space that a node's own numbers are in: what the transforms it stands in do.
    ///
    /// Something in a definition is taken to be where the first instance of that puts it. Things that move are where
    /// they are at time 0.
    pub(super) fn placement(&self, node: &Node) -> DAffine3 {
        let mut world = DAffine3::IDENTITY;
        let mut at = node;
        for _ in 0..DEEPEST {
            let Some(parent) = self.parent(at) else { break };
            let outer = match parent.kind {
                Kind::Define => self.instances_of(parent).find(|instance| instance.item > parent.item),
                _ => Some(parent),
            };
            let Some(outer) = outer else { break };
            world = self.own_map(outer) * world;
            at = outer;
        }
        world
    }

    /// What the operations of a transform or an instance do; the identity for other nodes.
    pub(super) fn own_map(&self, node: &Node) -> DAffine3 {
        let moves = matches!(node.kind, Kind::Transform | Kind::Instance);
        let children = self.item(node).filter(|_| moves).into_iter().flat_map(|item| item.children());
        operations_matrix(children, self.matrix_by_rows())
    }

    /// How the numbers of `Matrix` are ordered.
    pub(super) fn matrix_by_rows(&self) -> bool {
        self.dialect.or(self.own_dialect()).unwrap_or_default().rules().matrix_by_rows
    }

    /// The dialect that the text asks for.
    fn own_dialect(&self) -> Option<Dialect> {
        let item = self.value_item(self.root(Kind::Settings)?, "dialect", None)?;
        Dialect::from_name(&item.word()?.text())
    }
}
