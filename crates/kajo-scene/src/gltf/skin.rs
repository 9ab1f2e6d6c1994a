//! The shape of a mesh: targets of its morphs with their weights, and skins with joints where nodes put them.
//!
//! With the weights `m` of morphs and `w` of joints, in the model's space,
//!
//! ```text
//! p'  =  sum wj Jj Bj (p + sum mi di) / sum wj
//! ```
//!
//! where `J` is the place of a joint, `B` the inverse of its place when the skin was bound, and `d` the displacements of a
//! target [Khronos 2021, sec. 3.7.2.2 and 3.7.3.3].

use super::Budget;
use super::accessor::AccessorView;
use super::container::Buffers;
use super::json::{Document, Skin};
use super::nodes::{Shown, Tree, affine};
use kajo_math::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;
use std::rc::Rc;

/// How the vertices of a mesh are moved before its nodes place it.
#[derive(Default)]
pub(super) struct Pose<'d> {
    /// Of the targets of its primitives.
    pub weights: &'d [f64],
    /// From the mesh's space to the model's, for each joint; `None` for a mesh without a skin.
    pub joints: Option<Rc<[DAffine3]>>,
}

/// The poses of meshes; those of skins are worked out once.
pub(super) struct Poses<'d> {
    document: &'d Document,
    buffers: &'d Buffers<'d>,
    skins: HashMap<usize, Option<Rc<[DAffine3]>>>,
}

impl<'d> Poses<'d> {
    pub fn new(document: &'d Document, buffers: &'d Buffers<'d>) -> Poses<'d> {
        Poses { document, buffers, skins: HashMap::new() }
    }

    /// Skins with joints that stand nowhere in the scene.
    pub fn failed(&self) -> usize {
        self.skins.values().filter(|skin| skin.is_none()).count()
    }

    pub fn of(&mut self, shown: Shown, tree: &Tree, budget: &mut Budget) -> Result<Pose<'d>, String> {
        let weights = &self.document.meshes[shown.mesh].weights;
        let Some(number) = shown.node else { return Ok(Pose { weights, joints: None }) };
        let node = &self.document.nodes[number];
        let weights = node.weights.as_ref().unwrap_or(weights);
        let Some(skin) = node.skin else { return Ok(Pose { weights, joints: None }) };
        let known = self.skins.get(&skin).cloned();
        let joints = match known {
            Some(joints) => joints,
            None => {
                let said = self.document.skins.get(skin);
                let said = said.ok_or_else(|| format!("nodes[{number}]: there is no skins[{skin}]"))?;
                let joints =
                    self.joints(said, tree, budget).map_err(|error| format!("skins[{skin}]: {error}"))?;
                self.skins.insert(skin, joints.clone());
                joints
            }
        };
        // A skin without a place leaves its mesh where its node is.
        let transform = || tree.places[number].map(|transform| Rc::from([transform]));
        Ok(Pose { weights, joints: joints.or_else(transform) })
    }

    fn joints(
        &self,
        skin: &Skin,
        tree: &Tree,
        budget: &mut Budget,
    ) -> Result<Option<Rc<[DAffine3]>>, String> {
        let bound = skin.inverse_bind_matrices;
        let bound =
            bound.map(|number| AccessorView::<16>::new(self.document, self.buffers, number)).transpose()?;
        if bound.as_ref().is_some_and(|bound| bound.count < skin.joints.len()) {
            return Err("there are fewer matrices than joints".to_owned());
        }
        budget.take::<DAffine3>(skin.joints.len())?;
        let joint = |(i, &number): (usize, &usize)| {
            let transform = tree.places.get(number).copied().flatten()?;
            let bound = bound.as_ref().map_or(DAffine3::IDENTITY, |bound| affine(&bound.get(i)));
            Some(transform * bound).filter(|map| map.is_finite())
        };
        Ok(skin.joints.iter().enumerate().map(joint).collect())
    }
}

/// The weighted mean of maps of joints; weights of joints that are not there count nothing.
///
/// Returns `None` where there are no weights, and the vertex stays with the first joint.
pub(super) fn blended(joints: &[DAffine3], weights: impl Iterator<Item = (usize, f64)>) -> Option<DAffine3> {
    let mut sum = DAffine3 { matrix3: DMat3::ZERO, translation: DVec3::ZERO };
    let mut total = 0.0;
    for (joint, weight) in weights {
        let Some(map) = joints.get(joint).filter(|_| weight > 0.0) else { continue };
        sum.matrix3 += map.matrix3 * weight;
        sum.translation += map.translation * weight;
        total += weight;
    }
    let mean = DAffine3 { matrix3: sum.matrix3 * (1.0 / total), translation: sum.translation / total };
    (total > 0.0 && mean.is_finite()).then_some(mean)
}

/// A normal after a map.
pub(super) fn turned(map: &DAffine3, n: [f32; 3]) -> [f32; 3] {
    let n = DVec3::from(n.map(f64::from));
    let moved = match map.matrix3.determinant() {
        0.0 => map.matrix3 * n,
        _ => map.matrix3.inverse().transpose() * n,
    };
    moved.normalize_or_zero().as_vec3().to_array()
}
