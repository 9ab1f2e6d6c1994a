//! Where the rays of a camera start, so that one can know before a render whether any does so inside an object.

use kajo_math::{Aabb, DVec3, Vec2};

use super::{Camera, CameraFrame, EyePair, ThinLens};

impl Camera {
    /// A box around all points where rays start at any moment of the shutter interval, a single point where they share
    /// one; `None` for parallel rays, which come from infinitely far away.
    ///
    /// * `positions`: opposite corners of the part of the picture that is asked for, in picture coordinates
    /// * `aspect`: as for [`Camera::ray`]
    pub fn origins(&self, positions: [Vec2; 2], aspect: f32) -> Option<Aabb> {
        match self {
            Camera::Moving(moving) => {
                let own = moving.camera.origins(positions, aspect)?;
                Some(moving.map.bounds_of_all_times(&own))
            }
            still => still.model().origins(positions, aspect),
        }
    }
}

/// A box around a lens, or around the pinhole.
///
/// * `middle`: of the lens, from the camera's centre
pub(super) fn around_lens(frame: &CameraFrame, middle: DVec3, lens: Option<&ThinLens>) -> Aabb {
    // Openings that are pictures fill the square around the circle.
    let radius = lens.map_or(0.0, |lens| lens.radius);
    let (center, x, y) = (frame.center + middle, radius * frame.right, radius * frame.up);
    Aabb::around([center - x - y, center - x + y, center + x - y, center + x + y].map(|p| p.as_vec3()))
}

/// A box around the ball in which two eyes turn, or around the one point of a camera without them.
pub(super) fn around_eyes(frame: &CameraFrame, eyes: Option<EyePair>) -> Aabb {
    let radius = DVec3::splat(eyes.map_or(0.0, |eyes| 0.5 * eyes.separation));
    Aabb::around([frame.center - radius, frame.center + radius].map(|p| p.as_vec3()))
}
