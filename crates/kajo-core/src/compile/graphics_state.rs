//! The current transform and the graphics state: what holds for the objects of a group, as in [Pharr, Jakob and Humphreys 2023, C.2].

use kajo_math::{DAffine3, Motion, Transform};

use super::part::Part;
use crate::ids::PoseId;
use crate::material::MaterialId;

/// What holds for the next object while groups are read.
#[derive(Default)]
pub(super) struct GraphicsState {
    /// Set by `MaterialIndex`; stays in force after the group it stands in, as in the classic format.
    pub material: Option<MaterialId>,
    /// That of all objects whatever is said of theirs: the `material` of a `Union` around them.
    pub of_all: Option<MaterialId>,
    /// A `MaterialIndex` was wrong, which has been reported: objects without a material are no news.
    pub material_failed: bool,
    /// What has been found of a definition, while one is read: nothing in it is an object of the scene yet.
    pub parts: Option<Vec<Part>>,
    /// Whether what is read is an operand of a set operation.
    pub is_operand: bool,
}

/// From the space of objects to the world's: the current transformation matrix, over time.
pub(super) struct CurrentTransform {
    pub world: Motion,
    /// The same with its inverse at a moment; `None` when there is none, and what stands here is never hit.
    pub transform: Option<Transform>,
    /// Its name among the scene's, once an object needs it.
    pub pose: Option<PoseId>,
}

impl CurrentTransform {
    /// Where nothing has been moved.
    pub fn origin() -> CurrentTransform {
        CurrentTransform::new(Motion::still(DAffine3::IDENTITY))
    }

    pub fn new(world: Motion) -> CurrentTransform {
        let transform = match world.constant() {
            Some(map) => Transform::new(map),
            None => Transform::new(&world.at(0.0)),
        };
        let stays = transform.filter(|transform| world.constant().is_some() && transform.is_identity());
        CurrentTransform { world, transform, pose: stays.map(|_| PoseId::IDENTITY) }
    }

    /// The transform, where it does not move.
    pub fn fixed(&self) -> Option<&Transform> {
        self.transform.as_ref().filter(|_| self.world.constant().is_some())
    }

    /// The same for something that has no inverse whatever rounding makes of it.
    pub fn flattened(self) -> CurrentTransform {
        CurrentTransform { transform: None, ..self }
    }

    /// That of something that stands within what stands here.
    pub fn around(&self, map: &Motion) -> CurrentTransform {
        let there = CurrentTransform::new(self.world.then(map));
        if self.is_flat() { there.flattened() } else { there }
    }

    /// That of something whose points have been transformed already.
    pub fn baked(&self) -> CurrentTransform {
        let origin = CurrentTransform::origin();
        if self.is_flat() { origin.flattened() } else { origin }
    }

    pub fn is_flat(&self) -> bool {
        self.transform.is_none()
    }
}
