//! How many rays were cast, and what for.

use std::ops::AddAssign;

/// Rays cast, by what they were for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounters {
    /// From the camera.
    pub camera: u64,
    /// From a light.
    pub light: u64,
    /// Towards a light, or between two paths.
    pub shadow: u64,
    /// Mirrored at a surface.
    pub reflected: u64,
    /// Refracted through a surface.
    pub refracted: u64,
    /// Not cast, since paths of one sample had forked too often.
    pub left_out: u64,
    /// Given up in bodies that bend light: they took too many steps, or came to where there is no index of refraction.
    pub lost: u64,
}

impl RayCounters {
    /// Rays of every kind that were cast.
    pub fn total(&self) -> u64 {
        self.camera + self.light + self.shadow + self.reflected + self.refracted
    }
}

impl AddAssign for RayCounters {
    fn add_assign(&mut self, other: RayCounters) {
        self.camera += other.camera;
        self.light += other.light;
        self.shadow += other.shadow;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
        self.left_out += other.left_out;
        self.lost += other.lost;
    }
}
