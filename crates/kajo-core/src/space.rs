//! The geometry that light travels in, as far as those who follow it have to know.

use crate::scene::Scene;

/// How light gets from one event to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Along straight lines, at one frequency.
    Flat,
}

impl Space {
    /// Whether the way between any two points is known, so that vertices of paths can be connected and lights be sampled.
    /// Where light bends it has to be followed instead.
    #[inline]
    pub fn connects(self) -> bool {
        match self {
            Space::Flat => true,
        }
    }

    /// The frequency of light where it arrives over that where it left, on a way between two events.
    ///
    /// Radiance over the third power of the frequency is what stays the same along a way.
    #[inline]
    pub fn frequency_ratio(self) -> f32 {
        match self {
            Space::Flat => 1.0,
        }
    }
}

impl Scene {
    /// The geometry that light travels in.
    #[inline]
    pub fn space(&self) -> Space {
        Space::Flat
    }
}
