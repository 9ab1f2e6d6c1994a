//! Whether points may lie inside objects that light passes, by the boxes of these: a question for once, before paths
//! are asked one by one.

use kajo_math::Aabb;

use super::Geometry;

/// What a region may have in common with the insides of objects that light passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Immersion {
    /// Nothing.
    Outside,
    /// Some of it, which does not depend on the time.
    Still,
    /// Some of it at some time: an object that moves reaches into the region.
    Moving,
}

impl Geometry {
    /// Whether any point of a region may be inside an object that light passes, at any time while the shutter is open.
    pub fn immersion(&self, region: &Aabb) -> Immersion {
        if !self.transmits {
            return Immersion::Outside;
        }
        let touches = |bounds: &Aabb| !bounds.intersection(*region).is_empty();
        let mut found = Immersion::Outside;
        for primitive in self.primitives.iter().filter(|primitive| primitive.transmits) {
            if touches(&self.world_bounds(primitive)) {
                if self.is_moving(primitive) {
                    return Immersion::Moving;
                }
                found = Immersion::Still;
            }
        }
        // What stands in nested instances does not move; which of it light passes is not looked up.
        if self.nested_bounds().any(|bounds| touches(&bounds)) { Immersion::Still } else { found }
    }
}
