//! Rays.

use crate::Vec3;

/// A half line `o + t d` with the range of parameters in which hits count.
///
/// `d` need not be a unit vector: under transforms it is carried along unnormalised, so
/// that `t` means the same in every space. A hit at `t` counts when `t_min < t < t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Smallest parameter, not itself included; negative infinity for orthographic cameras.
    pub t_min: f32,
    /// Direction.
    pub d: Vec3,
    /// Largest parameter, not itself included.
    pub t_max: f32,
    /// Moment within the shutter interval, 0 at its opening and 1 at its closing.
    pub time: f32,
}

impl Ray {
    /// A ray over `0 < t < infinity` at time 0.
    #[inline]
    pub fn new(o: Vec3, d: Vec3) -> Ray {
        Ray { o, t_min: 0.0, d, t_max: f32::INFINITY, time: 0.0 }
    }

    /// The same ray with another range.
    #[inline]
    pub fn over(self, t_min: f32, t_max: f32) -> Ray {
        Ray { t_min, t_max, ..self }
    }

    /// Distance from the origin to where the ray ends.
    #[inline]
    pub fn length(&self) -> f32 {
        self.t_max * self.d.length()
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + t * self.d
    }
}
