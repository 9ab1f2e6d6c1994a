//! Set operations over numbered solids, as counts that change one solid at a time.
//!
//! A union holds a point if at least one of its operands does, an intersection of `n` if `n` do, and a difference is the
//! intersection of its first operand with the complements of the others. So every node counts the operands that hold the
//! point, and holds it itself if they are at least its threshold. Where one solid begins or ends only the counts between it
//! and the root change, and only as far up as what is said there does.

/// How operands are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetOperation {
    /// What is in any of them.
    Union,
    /// What is in all of them.
    Intersection,
    /// What is in the first one and in none of the others.
    Difference,
}

/// Set operations within set operations.
#[derive(Clone, Debug)]
pub(super) enum SetExpression {
    /// A solid by its number.
    Leaf(u32),
    /// An operation and its operands, at least one.
    Node(SetOperation, Vec<SetExpression>),
}

/// What a leaf or node hands to the node above it.
#[derive(Clone, Copy, Debug)]
struct Edge {
    parent: u32,
    /// What is said below is turned into its opposite.
    complements: bool,
}

/// An expression ready to be evaluated.
#[derive(Clone, Debug)]
pub(super) struct SetTree {
    leaves: Vec<Edge>,
    /// The root is the first one.
    nodes: Vec<Edge>,
    /// How many operands of each node must hold a point for the node to hold it.
    thresholds: Vec<u32>,
    /// The counts of a point that no leaf holds.
    outside: Vec<u32>,
}

impl SetTree {
    /// * `leaves`: how many there are; each is in the expression once
    pub fn new(expression: &SetExpression, leaves: usize) -> SetTree {
        let root = Edge { parent: 0, complements: false };
        let mut tree = SetTree {
            leaves: vec![root; leaves],
            nodes: Vec::new(),
            thresholds: Vec::new(),
            outside: Vec::new(),
        };
        match expression {
            SetExpression::Node(operation, operands) => {
                tree.node(root, *operation, operands);
            }
            leaf @ SetExpression::Leaf(_) => {
                tree.node(root, SetOperation::Union, std::slice::from_ref(leaf));
            }
        }
        tree
    }

    /// Adds a node with all below it; whether it holds a point that no leaf does.
    fn node(&mut self, edge: Edge, operation: SetOperation, operands: &[SetExpression]) -> bool {
        let node = self.nodes.len();
        let threshold = if operation == SetOperation::Union { 1 } else { operands.len() as u32 };
        self.nodes.push(edge);
        self.thresholds.push(threshold);
        self.outside.push(0);
        let mut held = 0;
        for (i, operand) in operands.iter().enumerate() {
            let complements = operation == SetOperation::Difference && i > 0;
            let edge = Edge { parent: node as u32, complements };
            let holds = match operand {
                SetExpression::Leaf(leaf) => {
                    self.leaves[*leaf as usize] = edge;
                    false
                }
                SetExpression::Node(operation, operands) => self.node(edge, *operation, operands),
            };
            held += u32::from(holds != complements);
        }
        self.outside[node] = held;
        held >= threshold
    }

    /// Starts anew with a point that no leaf holds.
    pub fn reset(&self, counts: &mut Vec<u32>) {
        counts.clear();
        counts.extend_from_slice(&self.outside);
    }

    /// Takes note that a leaf begins or ends to hold the point.
    #[inline]
    pub fn set(&self, counts: &mut [u32], leaf: u32, holds: bool) {
        let mut edge = self.leaves[leaf as usize];
        let mut holds = holds;
        loop {
            let node = edge.parent as usize;
            let threshold = self.thresholds[node];
            let before = counts[node] >= threshold;
            counts[node] = if holds != edge.complements { counts[node] + 1 } else { counts[node] - 1 };
            let after = counts[node] >= threshold;
            if before == after || node == 0 {
                return;
            }
            (holds, edge) = (after, self.nodes[node]);
        }
    }

    /// Whether the root holds the point.
    #[inline]
    pub fn holds(&self, counts: &[u32]) -> bool {
        counts[0] >= self.thresholds[0]
    }

    /// Whether a leaf is taken away from what it belongs to, so that its outside is the inside of the result.
    pub fn is_inverted(&self, leaf: u32) -> bool {
        let mut edge = self.leaves[leaf as usize];
        let mut inverted = edge.complements;
        while edge.parent != 0 {
            edge = self.nodes[edge.parent as usize];
            inverted ^= edge.complements;
        }
        inverted
    }
}

#[cfg(test)]
mod tests {
    use super::SetExpression::{Leaf, Node};
    use super::*;

    /// The expression taken literally.
    fn literally(expression: &SetExpression, inside: u32) -> bool {
        match expression {
            Leaf(leaf) => inside >> leaf & 1 == 1,
            Node(SetOperation::Union, operands) => operands.iter().any(|operand| literally(operand, inside)),
            Node(SetOperation::Intersection, operands) => {
                operands.iter().all(|operand| literally(operand, inside))
            }
            Node(SetOperation::Difference, operands) => {
                literally(&operands[0], inside)
                    && !operands[1..].iter().any(|operand| literally(operand, inside))
            }
        }
    }

    #[test]
    fn counts_say_what_the_expression_says() {
        let union = |a, b| Node(SetOperation::Union, vec![a, b]);
        let expression = Node(
            SetOperation::Difference,
            vec![
                union(Leaf(0), Node(SetOperation::Intersection, vec![Leaf(1), Leaf(2), Leaf(3)])),
                Leaf(4),
                Node(SetOperation::Difference, vec![union(Leaf(5), Leaf(6)), Leaf(7)]),
            ],
        );
        let tree = SetTree::new(&expression, 8);
        let mut counts = Vec::new();
        tree.reset(&mut counts);
        let mut inside = 0;
        for i in 0..20_000u32 {
            let leaf = (kajo_math::rng::mix(u64::from(i)) % 8) as u32;
            inside ^= 1 << leaf;
            tree.set(&mut counts, leaf, inside >> leaf & 1 == 1);
            assert_eq!(tree.holds(&counts), literally(&expression, inside), "{inside:b}");
        }
        assert_eq!([0, 1, 4, 5, 7].map(|leaf| tree.is_inverted(leaf)), [false, false, true, true, false]);
        let single = SetTree::new(&Leaf(0), 1);
        single.reset(&mut counts);
        assert!(!single.holds(&counts));
        single.set(&mut counts, 0, true);
        assert!(single.holds(&counts));
    }
}
