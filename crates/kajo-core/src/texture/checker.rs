//! A checkerboard of unit cells in three dimensions.
//!
//! The cell's parity is counted as the reference program counts it: whole parts with C's
//! remainder, plus one for each negative coordinate. Away from whole negative numbers this
//! is the parity of `floor(x) + floor(y) + floor(z)`, even for the first material.

use kajo_math::Vec3;

use super::{FloatNode, TextureContext, Textures};

/// 0 in the cells of the first material, 1 in those of the second.
#[derive(Clone, Copy, Debug)]
pub struct Checker;

impl Checker {
    /// The number at a point of its own space.
    pub fn at(&self, q: Vec3) -> f32 {
        let parity = |v: f32| v as i64 ^ i64::from(v < 0.0);
        let is_even = (parity(q.x) ^ parity(q.y) ^ parity(q.z)) & 1 == 0;
        if is_even { 0.0 } else { 1.0 }
    }
}

impl FloatNode for Checker {
    fn is_finite(&self) -> bool {
        true
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.at(at.p)
    }
}
