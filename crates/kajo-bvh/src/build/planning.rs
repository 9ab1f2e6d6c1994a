//! Plans every node of a binary tree, from the leaves up. The costs of a grove are dropped once it is done.

use rayon::prelude::*;

use super::LeafShape;
use super::binary::{Forest, Grove, Next};
use super::plan::{BLOCK_COST, Costs, Plan};
use crate::node::WIDTH;

impl Grove {
    /// Plans all twigs and answers their costs.
    fn plan(&mut self, shape: LeafShape) -> Vec<Costs> {
        let mut costs = vec![[0.0; WIDTH - 1]; self.twigs.len()];
        for (place, twig) in self.twigs.iter_mut().enumerate().rev() {
            let as_leaf = if twig.len() <= shape.most {
                twig.bounds().half_area() * BLOCK_COST * shape.blocks(twig.len()) as f32
            } else {
                f32::INFINITY
            };
            if twig.right == 0 {
                costs[place] = [as_leaf; WIDTH - 1];
            } else {
                let (left, right) = (&costs[place + 1], &costs[usize::from(twig.right)]);
                (twig.plan, costs[place]) = Plan::over(twig.bounds(), as_leaf, left, right);
            }
        }
        costs
    }
}

impl Forest {
    /// Plans all nodes.
    pub(super) fn plan(&mut self, shape: LeafShape) {
        // Stems, and the twigs they stand for, by groves.
        let mut ends = vec![Vec::new(); self.groves.len()];
        for (place, stem) in self.stems.iter().enumerate() {
            if let Next::Twig(spot) = stem.next {
                ends[spot.grove as usize].push((place, spot.twig as usize));
            }
        }
        let plan = |(grove, ends): (&mut Grove, Vec<(usize, usize)>)| {
            let costs = grove.plan(shape);
            ends.into_iter().map(|(stem, twig)| (stem, costs[twig])).collect::<Vec<_>>()
        };
        let found: Vec<_> = self.groves.par_iter_mut().zip(ends).map(plan).collect();
        let mut costs = vec![[0.0; WIDTH - 1]; self.stems.len()];
        for (stem, found) in found.into_iter().flatten() {
            costs[stem] = found;
        }
        for (place, stem) in self.stems.iter_mut().enumerate().rev() {
            if let Next::Right(right) = stem.next {
                let (left, right) = (&costs[place + 1], &costs[right as usize]);
                (stem.plan, costs[place]) = Plan::over(stem.bounds, f32::INFINITY, left, right);
            }
        }
    }
}
