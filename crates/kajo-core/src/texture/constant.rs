//! The same value everywhere.

use kajo_math::Vec3;

use super::Pattern;

/// A share that does not vary.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// In [0, 1].
    pub value: f32,
}

impl Pattern for Constant {
    fn value(&self, _q: Vec3) -> f32 {
        self.value
    }

    fn is_finite(&self) -> bool {
        self.value.is_finite()
    }
}
