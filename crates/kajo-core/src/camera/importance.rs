//! Cameras as seen by light: where a point appears in the picture, and how strongly.
//!
//! The mean of a picture is `integral of We L cos(theta) dw dA` over all rays that reach its lens, where `L` is the
//! radiance of the ray. For points of the film uniform over the picture and points of the lens with density `p(l)`,
//!
//! ```text
//! perspective   We = p(l) / (S cos^4 theta)           S: area of the picture at unit distance
//! telecentric   We = p(l) s^2 / (F cos^4 theta)       F: area of the picture, s: distance of the plane of focus
//! ```
//!
//! [Veach 1997, section 8.3], [Pharr, Jakob and Humphreys 2016, section 16.1], so that `We` integrates to one. A
//! pinhole is a lens of one point, for which `p(l)` stands as 1 here and in the density alike. Parallel rays without
//! a lens are met by light with probability zero and so have no importance; but a point can be connected with them, since
//! its place in the picture is known: there `We` over its density is `1/F`. Cameras that see all around are not
//! connected with.

use kajo_math::{DVec2, DVec3, Ray, Vec2, Vec3};

use super::{Camera, CameraFrame, OrthographicCamera, PerspectiveCamera, ThinLens};

/// What a camera makes of a ray that leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Importance {
    /// The position in the picture, both coordinates in [-1, 1].
    pub at: Vec2,
    /// Importance of radiance along the ray, per area and solid angle.
    pub we: f32,
    /// Density with which [`Camera::ray`] draws the origin, per area; 1 for a pinhole.
    pub pdf_area: f32,
    /// Density with which it draws the direction from there, per solid angle.
    pub pdf_direction: f32,
    /// Density with which [`Camera::sample_origin`] draws the origin, per area; 1 for a pinhole.
    pub pdf_origin: f32,
}

/// A way from a point to the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// World-space unit vector from the point to the lens.
    pub wi: Vec3,
    /// Distance to the lens; infinite for parallel rays.
    pub distance: f32,
    /// The position in the picture, both coordinates in [-1, 1].
    pub at: Vec2,
    /// Importance at the lens of radiance from the point.
    pub we: f32,
    /// Density of `wi` per solid angle; that of a pinhole is the square of the distance over the cosine, and 1 where
    /// there is no choice.
    pub pdf: f32,
    /// See [`Camera::pdf_across`].
    pub pdf_across: f32,
}

impl Camera {
    /// The importance of a ray that leaves the lens at `o` in direction `d`; `None` when it is not in the picture.
    ///
    /// * `o`: world space; a point of the lens, whose position within it is not checked when it is a pinhole
    /// * `d`: unit vector into the scene
    /// * `aspect`: width of the picture over its height
    /// * `time`: moment within the shutter interval
    pub fn importance(&self, o: Vec3, d: Vec3, aspect: f32, time: f32) -> Option<Importance> {
        match self {
            Camera::Perspective(camera) => camera.importance(o.as_dvec3(), d.as_dvec3(), aspect),
            Camera::Orthographic(camera) => camera.importance(o.as_dvec3(), d.as_dvec3(), aspect),
            Camera::Moving(moving) => moving.importance(o, d, aspect, time),
            _ => None,
        }
    }

    /// A world-space point from which rays of a camera with a lens start: on the lens, or of a telecentric camera on the plane of
    /// its picture, where the opening of each position of the picture is around that position. `None` where there is no lens.
    ///
    /// Its density per area is [`Importance::pdf_origin`].
    ///
    /// * `u`: uniform in [0, 1)²
    /// * `aspect`: width of the picture over its height
    /// * `time`: moment within the shutter interval
    pub fn sample_origin(&self, u: Vec2, aspect: f32, time: f32) -> Option<Vec3> {
        let on_plane =
            |frame: &CameraFrame, l: DVec2| (frame.center + l.x * frame.right + l.y * frame.up).as_vec3();
        match self {
            Camera::Perspective(camera) => Some(on_plane(camera.frame(), camera.lens()?.sample(u))),
            Camera::Orthographic(camera) => {
                let half = camera.half_size_with_lens(aspect, camera.lens.as_ref()?);
                Some(on_plane(&camera.frame, (2.0 * u.as_dvec2() - 1.0) * half))
            }
            Camera::Moving(moving) => moving.sample_origin(u, aspect, time),
            _ => None,
        }
    }

    /// A way from the world-space point `p` to the camera; `None` when that does not see it.
    ///
    /// * `lens`: uniform in [0, 1)²
    /// * `aspect`: width of the picture over its height
    /// * `time`: moment within the shutter interval
    pub fn connect(&self, p: Vec3, lens: Vec2, aspect: f32, time: f32) -> Option<Connection> {
        match self {
            Camera::Perspective(camera) => camera.connect(p.as_dvec3(), lens, aspect),
            Camera::Orthographic(camera) => camera.connect(p.as_dvec3(), lens, aspect),
            Camera::Moving(moving) => moving.connect(p, lens, aspect, time),
            _ => None,
        }
    }

    /// Density with which rays of the camera cross an area perpendicular to this one, of all rays that
    /// [`Camera::connect`] chooses from; `None` where it finds none.
    ///
    /// * `ray`: a ray of the camera, its direction of unit length
    /// * `distance`: of the area from its origin
    /// * `aspect`: width of the picture over its height
    pub fn pdf_across(&self, ray: &Ray, distance: f32, aspect: f32) -> Option<f32> {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        match self {
            Camera::Perspective(camera) => {
                let seen = camera.importance(o, d, aspect)?;
                Some(seen.pdf_direction / (distance * distance))
            }
            Camera::Orthographic(camera) => camera.pdf_across(o, d, aspect),
            Camera::Moving(moving) => moving.pdf_across(ray, distance, aspect),
            _ => None,
        }
    }
}

impl PerspectiveCamera {
    fn importance(&self, o: DVec3, d: DVec3, aspect: f32) -> Option<Importance> {
        let (across, cosine) = split(self.frame(), d)?;
        let offset = self.frame().across(o - self.frame().center);
        // Where the ray crosses the plane of focus, seen from the middle of the lens at unit distance.
        let (seen, pdf_area) = match self.lens() {
            None => (across / cosine, 1.0),
            Some(thin) => (across / cosine + offset / thin.focus, thin.pdf(offset)),
        };
        let half = self.half_size(aspect);
        let pdf_direction = 1.0 / (4.0 * half.x * half.y * (cosine * cosine * cosine)).abs();
        importance(seen / half, cosine, [pdf_area, pdf_direction, pdf_area])
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
}

impl OrthographicCamera {
    fn importance(&self, o: DVec3, d: DVec3, aspect: f32) -> Option<Importance> {
        let thin = self.lens.as_ref()?;
        let (across, cosine) = split(&self.frame, d)?;
        // The point of the lens follows from the direction, since all rays of a film point meet in focus.
        let offset = -across / cosine * thin.focus;
        let middle = self.frame.across(o - self.frame.center) - offset;
        let half = self.half_size(aspect);
        let pdf_direction = thin.pdf(offset) * thin.focus * thin.focus / (cosine * cosine * cosine);
        let around = self.half_size_with_lens(aspect, thin);
        let pdf_origin = 1.0 / (4.0 * around.x * around.y);
        importance(middle / half, cosine, [self.pdf_film(aspect), pdf_direction, pdf_origin])
    }

    /// Half the width and height of the part of the picture's plane from which rays start.
    fn half_size_with_lens(&self, aspect: f32, lens: &ThinLens) -> DVec2 {
        self.half_size(aspect).abs() + lens.radius
    }

    /// Points of the film per area across a ray that leaves it.
    fn pdf_across(&self, o: DVec3, d: DVec3, aspect: f32) -> Option<f32> {
        let (_, cosine) = split(&self.frame, d)?;
        if self.lens.is_some() {
            return self.importance(o, d, aspect).map(|seen| seen.pdf_area / cosine as f32);
        }
        let at = self.frame.across(o - self.frame.center) / self.half_size(aspect);
        (at.abs().max_element() <= 1.0).then(|| self.pdf_film(aspect) as f32)
    }

    /// Density of points of the film per area.
    fn pdf_film(&self, aspect: f32) -> f64 {
        let half = self.half_size(aspect);
        1.0 / (4.0 * half.x * half.y).abs()
    }

    fn connect(&self, p: DVec3, lens: Vec2, aspect: f32) -> Option<Connection> {
        let Some(thin) = &self.lens else { return self.connect_parallel(p, aspect) };
        let frame = &self.frame;
        let offset = thin.sample(lens);
        let d =
            (thin.focus * frame.forward - offset.x * frame.right - offset.y * frame.up).normalize_or_zero();
        let distance = (p - frame.center).dot(frame.forward) / d.dot(frame.forward);
        if distance.is_nan() || distance <= 0.0 {
            return None;
        }
        let seen = self.importance(p - distance * d, d, aspect)?;
        let across = f64::from(seen.pdf_area) / d.dot(frame.forward);
        Some(connection(-d, distance, seen, f64::from(seen.pdf_direction), across))
    }

    fn connect_parallel(&self, p: DVec3, aspect: f32) -> Option<Connection> {
        split(&self.frame, self.frame.forward)?;
        let at = self.frame.across(p - self.frame.center) / self.half_size(aspect);
        let film = self.pdf_film(aspect) as f32;
        (at.abs().max_element() <= 1.0).then(|| Connection {
            wi: -self.frame.forward.as_vec3(),
            distance: f32::INFINITY,
            at: at.as_vec2(),
            we: film,
            pdf: 1.0,
            pdf_across: film,
        })
    }
}

/// The part of a direction across the camera's, and along it; `None` when it points backwards, or when the axes are
/// no orthonormal basis and so make no picture that light could find.
fn split(frame: &CameraFrame, d: DVec3) -> Option<(DVec2, f64)> {
    let cosine = d.dot(frame.forward);
    let sees = cosine > 0.0 && frame.is_orthonormal();
    sees.then(|| (frame.across(d), cosine))
}

fn importance(at: DVec2, cosine: f64, [pdf_area, pdf_direction, pdf_origin]: [f64; 3]) -> Option<Importance> {
    let inside = at.abs().max_element() <= 1.0 && pdf_area > 0.0 && pdf_direction > 0.0;
    inside.then(|| Importance {
        at: at.as_vec2(),
        we: (pdf_area * pdf_direction / cosine) as f32,
        pdf_area: pdf_area as f32,
        pdf_direction: pdf_direction as f32,
        pdf_origin: pdf_origin as f32,
    })
}

fn connection(wi: DVec3, distance: f64, seen: Importance, pdf: f64, across: f64) -> Connection {
    let Importance { at, we, .. } = seen;
    let (distance, pdf, pdf_across) = (distance as f32, pdf as f32, across as f32);
    Connection { wi: wi.as_vec3(), distance, at, we, pdf, pdf_across }
}
