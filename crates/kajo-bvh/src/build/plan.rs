//! The cheapest way to fold a binary tree into a wide one.
//!
//! A binary subtree can become a leaf, a wide node, or be shared out over some slots of the
//! wide node above it. With `A` the surface, `P` the blocks of a leaf, the cheapest ways are
//! [Ylitie, Karras and Laine 2017, eq. 3-6]
//!
//! ```text
//! C(n, 1) = min(A P c_block, A c_node + D(n, 8))
//! C(n, i) = min(D(n, i), C(n, i - 1))
//! D(n, i) = min over 0 < k < i of C(left, k) + C(right, i - k)
//! ```
//!
//! found from the leaves up. What was chosen stays with the nodes, in 22 bits each.

use super::prim::Box4;
use crate::node::WIDTH;

/// Cost of a leaf block relative to a visit of a wide node.
pub(super) const BLOCK_COST: f32 = 0.9;

/// `C(n, 1)` to `C(n, 7)`.
pub(super) type Costs = [f32; WIDTH - 1];

/// What to do with a node of the binary tree: whether it is to be a leaf, and for each number
/// of slots from 2 to 8 how many of them the left child gets; none where fewer slots do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan(u32);

impl Plan {
    pub(super) const LEAF: Plan = Plan(1 << 31);

    pub(super) fn is_leaf(self) -> bool {
        self.0 & Plan::LEAF.0 != 0
    }

    /// How many of `slots` the left child gets; 0 where fewer slots do as well.
    pub(super) fn left(self, slots: usize) -> usize {
        (self.0 >> (3 * (slots - 2)) & 7) as usize
    }

    fn with(self, slots: usize, left: usize) -> Plan {
        Plan(self.0 | (left as u32) << (3 * (slots - 2)))
    }

    /// The best plan for a node above two others, and what it costs.
    pub(super) fn over(bounds: Box4, as_leaf: f32, left: &Costs, right: &Costs) -> (Plan, Costs) {
        let (cost, k) = share(left, right, WIDTH);
        let as_node = bounds.half_area() + cost;
        // Surfaces of huge boxes are infinite, and so is the cost of what is too much for a leaf.
        let is_leaf = as_leaf <= as_node && as_leaf < f32::INFINITY;
        let plan = if is_leaf { Plan::LEAF } else { Plan(0) };
        let (mut plan, mut costs) = (plan.with(WIDTH, k), [as_leaf.min(as_node); WIDTH - 1]);
        for slots in 2..WIDTH {
            let (cost, k) = share(left, right, slots);
            costs[slots - 1] = costs[slots - 2];
            if cost < costs[slots - 1] {
                costs[slots - 1] = cost;
                plan = plan.with(slots, k);
            }
        }
        (plan, costs)
    }
}

/// The cheapest `C(left, k) + C(right, slots - k)` and its `k`.
#[inline(always)]
fn share(left: &Costs, right: &Costs, slots: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for k in 1..slots {
        let cost = left[k - 1] + right[slots - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_hold_every_choice() {
        for left in 1..=7 {
            for slots in 2..=WIDTH {
                let plan = Plan(0).with(slots, left);
                for other in 2..=WIDTH {
                    assert_eq!(plan.left(other), if other == slots { left } else { 0 });
                }
                assert!(!plan.is_leaf());
            }
        }
        let full = (2..=WIDTH).fold(Plan::LEAF, |plan, slots| plan.with(slots, slots - 1));
        assert!(full.is_leaf() && (2..=WIDTH).all(|slots| full.left(slots) == slots - 1));
    }

    #[test]
    fn the_cheapest_share_is_found() {
        let left = [9.0, 8.0, 7.0, 3.0, 3.0, 3.0, 3.0];
        let right = [9.0, 4.0, 4.0, 4.0, 4.0, 4.0, 4.0];
        assert_eq!(share(&left, &right, 2), (18.0, 1));
        assert_eq!(share(&left, &right, 3), (13.0, 1));
        assert_eq!(share(&left, &right, 6), (7.0, 4));
        let nothing = [f32::INFINITY; 7];
        assert_eq!(share(&nothing, &nothing, 5), (f32::INFINITY, 1));
    }
}
