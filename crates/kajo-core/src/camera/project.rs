//! Where a point appears in the picture: the inverse of [`Camera::ray`] through the middle of the lens.
//!
//! With the camera's axes as the columns of `B`, a point `p` of the world is `(a, b, s) = B^-1 (p - center)`, and
//! appears at
//!
//! ```text
//! perspective    (a, b) d / (s (aspect, 1))              d = 1 / tan(angle / 2)
//! orthographic   (a, b) 2 / (size (aspect, 1))
//! panorama       (atan2(a, s) / pi, 2 asin(b / |p|) / pi)
//! fisheye        (a, b) r(theta) / |(a, b)|              theta = atan2(|(a, b)|, s)
//! ```
//!
//! A camera whose angle is beyond 180 degrees has a negative `d`, and sees what is behind it.
//!
//! Pictures for two eyes show a point twice. Where an eye turns with the gaze `w`, its place follows from `w`, and `w` from
//! its place:
//!
//! ```text
//! w' = (p - eye(w)) / |p - eye(w)|
//! ```
//!
//! comes nearer to the answer with each step, by the ratio of the eye's way to the distance.

use std::f64::consts::PI;

use kajo_math::{DMat3, DVec2, DVec3, fmath};

use super::{Camera, CameraFrame, EyePair};

/// Steps towards the gaze of an eye that turns, and what is near enough.
const STEPS: u32 = 64;
const NEAR_ENOUGH: f64 = 1e-12;

impl Camera {
    /// Position and axes; for a camera that moves, before its motion.
    pub fn frame(&self) -> &CameraFrame {
        self.model().frame()
    }

    /// The same camera with another position and other axes, where it rests.
    #[must_use]
    pub fn with_frame(self, frame: CameraFrame) -> Camera {
        match self {
            Camera::Moving(moving) => moving.camera.with_frame(frame),
            mut still => {
                still.model_mut().set_frame(frame);
                still
            }
        }
    }

    /// The picture coordinates of the world-space point `p`, which may lie outside of [-1, 1]; `None` where the
    /// camera does not see that way, or sees everything twice.
    ///
    /// * `aspect`: width of the picture over its height
    /// * `time`: moment within the shutter interval
    pub fn project(&self, p: DVec3, aspect: f64, time: f32) -> Option<DVec2> {
        if let Camera::Moving(moving) = self {
            return moving.project(p, aspect, time);
        }
        let local = self.frame().local(p)?;
        let at = self.model().project(local, aspect)?;
        at.is_finite().then_some(at)
    }

    /// The positions where the camera shows a point: as [`Camera::project`], or for two eyes that of the left one and that of
    /// the right one.
    pub fn projections(&self, p: DVec3, aspect: f64, time: f32) -> [Option<DVec2>; 2] {
        if let Camera::Moving(moving) = self {
            return moving.projections(p, aspect, time);
        }
        if self.model().has_two_eyes() {
            return [-1.0, 1.0].map(|side| self.model().project_eye(p, side));
        }
        [self.project(p, aspect, time), None]
    }
}

/// Longitude and latitude of a direction by right, up and forward, from -1 to 1 each.
pub(super) fn longitude_latitude(local: DVec3) -> DVec2 {
    let latitude = fmath::atan2_64(local.y, DVec2::new(local.x, local.z).length());
    DVec2::new(fmath::atan2_64(local.x, local.z) / PI, 2.0 * latitude / PI)
}

impl EyePair {
    /// The unit direction in which an eye that turns sees the world-space point `p`; `None` where it is too near.
    pub(super) fn gaze(&self, frame: &CameraFrame, p: DVec3, side: f64) -> Option<DVec3> {
        let mut w = (p - frame.center).try_normalize()?;
        for _ in 0..STEPS {
            let next = (p - self.turned(frame, w, side)).try_normalize()?;
            let step = next.distance_squared(w);
            w = next;
            if step < NEAR_ENOUGH * NEAR_ENOUGH {
                return Some(w);
            }
        }
        None
    }
}

impl CameraFrame {
    /// A world-space point by right, up and forward; `None` when the axes span no space.
    pub fn local(&self, p: DVec3) -> Option<DVec3> {
        let axes = DMat3::from_cols(self.right, self.up, self.forward);
        (axes.determinant() != 0.0).then(|| axes.inverse() * (p - self.center))
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::Vec2;
    use kajo_math::rng::Stream;

    use super::super::tests::every_camera;
    use super::*;

    /// A point on a ray of the picture is projected to a position whose ray meets the point.
    #[test]
    fn points_on_rays_appear_where_the_rays_go() {
        let aspect = 1.5;
        let mut projected = 0;
        for camera in every_camera() {
            for i in 0..200 {
                let s = Stream::new(3, [i, 0], 0);
                let at = 2.0 * Vec2::new(s.uniform(0), s.uniform(1)) - 1.0;
                let Some(ray) = camera.ray(at, aspect as f32, Vec2::splat(0.5), 0.0) else { continue };
                let p = ray.o.as_dvec3() + f64::from(1.0 + 9.0 * s.uniform(2)) * ray.d.as_dvec3();
                let Some(found) = camera.project(p, aspect, 0.0) else { continue };
                let again = camera.ray(found.as_vec2(), aspect as f32, Vec2::splat(0.5), 0.0).unwrap();
                let to_p = p - again.o.as_dvec3();
                let beside = to_p.cross(again.d.as_dvec3()).length();
                assert!(beside < 5e-6 * (1.0 + to_p.length()), "{camera:?}: {found} for {at}: {beside}");
                projected += 1;
            }
        }
        assert!(projected > 1000, "{projected}");
    }

    /// Both eyes see a point of a ray, and one of them where the ray goes.
    #[test]
    fn eyes_see_points_where_their_rays_go() {
        let aspect = 2.0;
        let (mut seen, mut cameras) = (0, 0);
        let two_eyed = |camera: &Camera| camera.cells() != [1, 1];
        for camera in every_camera().into_iter().filter(two_eyed) {
            cameras += 1;
            for i in 0..500 {
                let s = Stream::new(9, [i, 0], 0);
                let at = 2.0 * Vec2::new(s.uniform(0), s.uniform(1)) - 1.0;
                let ray = camera.ray(at, aspect, Vec2::splat(0.5), 0.0).unwrap();
                let p = ray.o.as_dvec3() + f64::from(0.5 + 9.0 * s.uniform(2)) * ray.d.as_dvec3();
                let found = camera.projections(p, aspect.into(), 0.0).map(|position| position.unwrap());
                let nearest = found.map(|position| position.distance(at.as_dvec2()));
                assert!(nearest[0].min(nearest[1]) < 1e-4, "{camera:?}: {found:?} for {at}");
                for position in found {
                    let ray = camera.ray(position.as_vec2(), aspect, Vec2::splat(0.5), 0.0).unwrap();
                    let beside = (p - ray.o.as_dvec3()).cross(ray.d.as_dvec3()).length();
                    assert!(beside < 1e-4, "{camera:?}: {position} misses by {beside}");
                    seen += 1;
                }
            }
        }
        assert!(cameras >= 3 && seen == 1000 * cameras, "{cameras} {seen}");
    }

    #[test]
    fn nothing_is_seen_behind_a_pinhole() {
        let camera = every_camera().into_iter().find(|c| matches!(c, Camera::Perspective(_))).unwrap();
        let CameraFrame { center, forward, .. } = *camera.frame();
        assert!(camera.project(center + forward, 1.0, 0.0).unwrap().length() < 1e-12);
        assert!(camera.project(center - forward, 1.0, 0.0).is_none());
    }
}
