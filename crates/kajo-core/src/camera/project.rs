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
//! Pictures for two eyes show a point twice and so have no such place.

use std::f64::consts::PI;

use kajo_math::{DMat3, DVec2, DVec3, fmath};

use super::{Camera, FisheyeCamera, FisheyeProjection, Frame};

impl Camera {
    /// Position and axes; for a camera that moves, before its motion.
    pub fn frame(&self) -> &Frame {
        match self {
            Camera::Orthographic(camera) => &camera.frame,
            Camera::Perspective(camera) => camera.frame(),
            Camera::Panorama(camera) => &camera.frame,
            Camera::Fisheye(camera) => &camera.frame,
            Camera::StereoCubemap(camera) => &camera.frame,
            Camera::Moving(moving) => moving.camera.frame(),
        }
    }

    /// The same camera with another position and other axes, where it rests.
    pub fn with_frame(self, frame: Frame) -> Camera {
        match self {
            Camera::Orthographic(mut camera) => {
                camera.frame = frame;
                Camera::Orthographic(camera)
            }
            Camera::Perspective(camera) => Camera::Perspective(camera.with_frame(frame)),
            Camera::Panorama(mut camera) => {
                camera.frame = frame;
                Camera::Panorama(camera)
            }
            Camera::Fisheye(mut camera) => {
                camera.frame = frame;
                Camera::Fisheye(camera)
            }
            Camera::StereoCubemap(mut camera) => {
                camera.frame = frame;
                Camera::StereoCubemap(camera)
            }
            Camera::Moving(moving) => moving.camera.with_frame(frame),
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
        let across = local.truncate();
        let at = match self {
            Camera::Perspective(camera) if local.z > 0.0 => {
                across * camera.distance() / (local.z * DVec2::new(aspect, 1.0))
            }
            Camera::Orthographic(camera) => across * 2.0 / (camera.size * DVec2::new(aspect, 1.0)),
            Camera::Panorama(camera) if !camera.is_stereo() => {
                let latitude = fmath::atan2_64(local.y, DVec2::new(local.x, local.z).length());
                DVec2::new(fmath::atan2_64(local.x, local.z) / PI, 2.0 * latitude / PI)
            }
            Camera::Fisheye(camera) => camera.project(local, aspect)?,
            _ => return None,
        };
        at.is_finite().then_some(at)
    }
}

impl FisheyeCamera {
    fn project(&self, local: DVec3, aspect: f64) -> Option<DVec2> {
        let across = local.truncate();
        let outward = across.length();
        let theta = fmath::atan2_64(outward, local.z);
        let half = 0.5 * self.angle;
        if theta > half {
            return None;
        }
        let r = self.projection.radius(theta, half);
        let scale = if self.to_corners { (aspect * aspect + 1.0).sqrt() } else { 1.0 };
        let direction = if outward > 0.0 { across / outward } else { DVec2::ZERO };
        Some(direction * r * scale / DVec2::new(aspect, 1.0))
    }
}

impl FisheyeProjection {
    /// The distance from the middle at which the angle `theta` from forward appears, for half a field of view `half`.
    fn radius(self, theta: f64, half: f64) -> f64 {
        match self {
            FisheyeProjection::Equidistant => theta / half,
            FisheyeProjection::Equisolid => fmath::sin64(0.5 * theta) / fmath::sin64(0.5 * half),
            FisheyeProjection::Stereographic => fmath::tan64(0.5 * theta) / fmath::tan64(0.5 * half),
            FisheyeProjection::Orthographic => fmath::sin64(theta) / fmath::sin64(half),
        }
    }
}

impl Frame {
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

    /// A point on a ray of the picture is projected to a place whose ray meets the point.
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

    #[test]
    fn nothing_is_seen_behind_a_pinhole() {
        let camera = every_camera().into_iter().find(|c| matches!(c, Camera::Perspective(_))).unwrap();
        let Frame { center, forward, .. } = *camera.frame();
        assert!(camera.project(center + forward, 1.0, 0.0).unwrap().length() < 1e-12);
        assert!(camera.project(center - forward, 1.0, 0.0).is_none());
    }
}
