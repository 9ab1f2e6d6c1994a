//! Where objects stand, and what holds for them there.

use kajo_math::{DAffine3, Motion, Transform};

use super::part::Part;
use crate::ids::PoseId;
use crate::material::MaterialId;

/// The running state of a walk through groups.
#[derive(Default)]
pub(super) struct Walk {
    /// Set by `MaterialIndex`; stays in force after the group it stands in, as in the classic format.
    pub material: Option<MaterialId>,
    /// A `MaterialIndex` was wrong, which has been reported: objects without a material are no news.
    pub material_failed: bool,
    /// What has been found of a definition, while one is read: nothing in it is an object of the scene yet.
    pub parts: Option<Vec<Part>>,
    /// Whether what is read is an operand of a set operation.
    pub is_operand: bool,
}

/// Where objects stand.
pub(super) struct Place {
    pub world: Motion,
    /// The same with its inverse at a moment; `None` when there is none, and what stands here is never hit.
    pub transform: Option<Transform>,
    /// Its name among the scene's, once an object needs it.
    pub pose: Option<PoseId>,
}

impl Place {
    /// Where nothing has been moved.
    pub fn origin() -> Place {
        Place::new(Motion::still(DAffine3::IDENTITY))
    }

    pub fn new(world: Motion) -> Place {
        let transform = match world.constant() {
            Some(map) => Transform::new(map),
            None => Transform::new(&world.at(0.0)),
        };
        let stays = transform.filter(|transform| world.constant().is_some() && transform.is_identity());
        Place { world, transform, pose: stays.map(|_| PoseId::IDENTITY) }
    }

    /// The transform of a place that does not move.
    pub fn fixed(&self) -> Option<&Transform> {
        self.transform.as_ref().filter(|_| self.world.constant().is_some())
    }

    /// The same place for something that has no inverse whatever rounding makes of it.
    pub fn flattened(self) -> Place {
        Place { transform: None, ..self }
    }

    /// The place of something that stands within what stands here.
    pub fn around(&self, map: &Motion) -> Place {
        let there = Place::new(self.world.then(map));
        if self.is_flat() { there.flattened() } else { there }
    }

    /// The place of something that has been taken here already.
    pub fn baked(&self) -> Place {
        let origin = Place::origin();
        if self.is_flat() { origin.flattened() } else { origin }
    }

    pub fn is_flat(&self) -> bool {
        self.transform.is_none()
    }
}
