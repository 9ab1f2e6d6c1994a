//! The position and axes of a camera.

use kajo_math::{DVec2, DVec3};

/// Where a camera stands and what it calls right, up and forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFrame {
    /// World-space position.
    pub center: DVec3,
    /// Unit vector to the right, or zero when up and direction are parallel.
    pub right: DVec3,
    /// Unit vector up, perpendicular to the direction unless given raw.
    pub up: DVec3,
    /// Unit vector forward.
    pub forward: DVec3,
}

impl CameraFrame {
    /// The frame that looks along `direction` with `up` as near to up as possible.
    ///
    /// `right = direction x up` and `up' = right x direction`, each normalised. Degenerate
    /// input gives zero axes, and so the centre ray everywhere, as in the reference program.
    pub fn new(center: DVec3, direction: DVec3, up: DVec3) -> CameraFrame {
        let forward = direction.normalize_or_zero();
        let right = forward.cross(up).normalize_or_zero();
        CameraFrame { center, right, up: right.cross(forward).normalize_or_zero(), forward }
    }

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        [self.center, self.right, self.up, self.forward].iter().all(|v| v.is_finite())
    }

    /// The same frame with `up` taken as it stands, which the `mit-a2` programs do.
    pub fn with_raw_up(self, up: DVec3) -> CameraFrame {
        CameraFrame { up, ..self }
    }

    /// The point of the plane across the camera's direction, through its position.
    pub(super) fn in_plane(&self, at: DVec2) -> DVec3 {
        self.center + at.x * self.right + at.y * self.up
    }

    /// The part of a vector across the camera's direction: right and up.
    pub(super) fn across(&self, v: DVec3) -> DVec2 {
        DVec2::new(v.dot(self.right), v.dot(self.up))
    }

    /// Whether the axes are perpendicular unit vectors.
    pub(crate) fn is_orthonormal(&self) -> bool {
        let axes = [self.right, self.up, self.forward];
        let unit = axes.iter().all(|axis| (axis.length_squared() - 1.0).abs() < 1e-6);
        unit && self.right.cross(self.up).dot(self.forward).abs() > 1.0 - 1e-6
    }
}
