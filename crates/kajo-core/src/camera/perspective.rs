//! Rays through a point, or through a lens: direction `x aspect right + y up + forward / tan(angle/2)`, normalised.
//!
//! Scene: `PerspectiveCamera { center 0 0 10  direction 0 0 -1  up 0 1 0  angle 30 }`

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3, fmath};

use super::fit::{Fit, FitError, FitSpace, Freedom};
use super::importance::{connection, importance, split};
use super::model::CameraModel;
use super::origins::around_lens;
use super::{Camera, CameraFrame, Connection, Importance, ThinLens};

/// A pinhole camera, or one with a lens.
#[derive(Clone, Debug)]
pub struct PerspectiveCamera {
    frame: CameraFrame,
    /// Distance of the picture plane at which the picture is two units high.
    distance: f64,
    lens: Option<ThinLens>,
}

impl PerspectiveCamera {
    /// A pinhole camera with the full vertical field of view `angle`, in radians.
    pub fn new(frame: CameraFrame, angle: f64) -> PerspectiveCamera {
        PerspectiveCamera { frame, distance: 1.0 / fmath::tan64(0.5 * angle), lens: None }
    }

    /// The same camera with a lens in place of the pinhole.
    pub fn with_lens(self, lens: Option<ThinLens>) -> PerspectiveCamera {
        PerspectiveCamera { lens, ..self }
    }

    /// Position and axes.
    pub fn frame(&self) -> &CameraFrame {
        &self.frame
    }

    /// The same camera with another position and other axes.
    pub fn with_frame(self, frame: CameraFrame) -> PerspectiveCamera {
        PerspectiveCamera { frame, ..self }
    }

    /// Distance of the picture plane at which the picture is two units high: `1 / tan(angle / 2)`.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The lens, if there is one.
    pub fn lens(&self) -> Option<&ThinLens> {
        self.lens.as_ref()
    }

    /// Half the picture's width and height at unit distance.
    pub(super) fn half_size(&self, aspect: f32) -> DVec2 {
        DVec2::new(f64::from(aspect), 1.0) / self.distance
    }
}

impl CameraModel for PerspectiveCamera {
    fn keyword(&self) -> &'static str {
        "PerspectiveCamera"
    }

    fn is_finite(&self) -> bool {
        self.distance.is_finite()
    }

    fn frame(&self) -> &CameraFrame {
        &self.frame
    }

    fn set_frame(&mut self, frame: CameraFrame) {
        self.frame = frame;
    }

    fn lens(&self) -> Option<&ThinLens> {
        self.lens.as_ref()
    }

    fn set_lens(&mut self, lens: Option<ThinLens>) {
        self.lens = lens;
    }

    #[inline]
    fn ray(&self, at: Vec2, aspect: f32, lens: Vec2) -> Option<Ray> {
        let CameraFrame { center, right, up, forward } = self.frame;
        let (x, y) = (f64::from(at.x) * f64::from(aspect), f64::from(at.y));
        let d = x * right + y * up + self.distance * forward;
        let (o, d) = match &self.lens {
            None => (center, d),
            Some(thin) => thin.refract(&self.frame, center, d * (thin.focus / self.distance), lens),
        };
        Some(Ray::new(o.as_vec3(), d.normalize_or_zero().as_vec3()))
    }

    fn apex(&self) -> Option<Vec3> {
        self.lens.is_none().then(|| self.frame.center.as_vec3())
    }

    fn has_extent(&self) -> bool {
        true
    }

    fn origins(&self, _positions: [Vec2; 2], _aspect: f32) -> Option<Aabb> {
        Some(around_lens(&self.frame, DVec3::ZERO, self.lens.as_ref()))
    }

    fn project(&self, local: DVec3, aspect: f64) -> Option<DVec2> {
        let is_ahead = local.z * self.distance > 0.0;
        is_ahead.then(|| local.truncate() * self.distance / (local.z * DVec2::new(aspect, 1.0)))
    }

    fn fitted(&self, fit: &Fit, space: &FitSpace<'_>, inside: f64) -> Result<Camera, FitError> {
        if fit.freedom == Freedom::Opening {
            let height = space.widest(fit.aspect).ok_or(FitError::Around)?;
            let angle = 2.0 * fmath::atan64(height / inside);
            return Ok(PerspectiveCamera::new(self.frame, angle).with_lens(self.lens.clone()).into());
        }
        let height = inside / self.distance;
        if !(1e-6..1e6).contains(&height) {
            return Err(FitError::NoAngle);
        }
        let center = fit.eye(space, [height * fit.aspect, height]);
        Ok(self.clone().with_frame(CameraFrame { center, ..self.frame }).into())
    }

    fn is_connectable(&self) -> bool {
        true
    }

    fn importance(&self, o: DVec3, d: DVec3, aspect: f32) -> Option<Importance> {
        let (across, cosine) = split(&self.frame, d)?;
        let offset = self.frame.across(o - self.frame.center);
        // Where the ray crosses the plane of focus, seen from the middle of the lens at unit distance.
        let (seen, pdf_area) = match &self.lens {
            None => (across / cosine, 1.0),
            Some(thin) => (across / cosine + offset / thin.focus, thin.pdf(offset)),
        };
        let half = self.half_size(aspect);
        let pdf_direction = 1.0 / (4.0 * half.x * half.y * (cosine * cosine * cosine)).abs();
        importance(seen / half, cosine, [pdf_area, pdf_direction, pdf_area])
    }

    fn sample_origin(&self, u: Vec2, _aspect: f32) -> Option<DVec3> {
        Some(self.frame.in_plane(self.lens.as_ref()?.sample(u)))
    }

    fn connect(&self, p: DVec3, lens: Vec2, aspect: f32) -> Option<Connection> {
        let frame = self.frame();
        let offset = self.lens().map_or(DVec2::ZERO, |thin| thin.sample(lens));
        let o = frame.center + offset.x * frame.right + offset.y * frame.up;
        let to_lens = o - p;
        let distance = to_lens.length();
        let wi = to_lens / distance;
        let seen = self.importance(o, -wi, aspect)?;
        let cosine = -wi.dot(frame.forward);
        let across = f64::from(seen.pdf_direction) / (distance * distance);
        Some(connection(wi, distance, seen, f64::from(seen.pdf_area) * distance * distance / cosine, across))
    }

    fn pdf_across(&self, o: DVec3, d: DVec3, distance: f32, aspect: f32) -> Option<f32> {
        let seen = self.importance(o, d, aspect)?;
        Some(seen.pdf_direction / (distance * distance))
    }
}
