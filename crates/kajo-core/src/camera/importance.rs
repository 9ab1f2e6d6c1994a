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

use super::{Camera, CameraFrame};

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
            Camera::Moving(moving) => moving.importance(o, d, aspect, time),
            still => still.model().importance(o.as_dvec3(), d.as_dvec3(), aspect),
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
        match self {
            Camera::Moving(moving) => moving.sample_origin(u, aspect, time),
            still => still.model().sample_origin(u, aspect).map(|o| o.as_vec3()),
        }
    }

    /// A way from the world-space point `p` to the camera; `None` when that does not see it.
    ///
    /// * `lens`: uniform in [0, 1)²
    /// * `aspect`: width of the picture over its height
    /// * `time`: moment within the shutter interval
    pub fn connect(&self, p: Vec3, lens: Vec2, aspect: f32, time: f32) -> Option<Connection> {
        match self {
            Camera::Moving(moving) => moving.connect(p, lens, aspect, time),
            still => still.model().connect(p.as_dvec3(), lens, aspect),
        }
    }

    /// Density with which rays of the camera cross an area perpendicular to this one, of all rays that
    /// [`Camera::connect`] chooses from; `None` where it finds none.
    ///
    /// * `ray`: a ray of the camera, its direction of unit length
    /// * `distance`: of the area from its origin
    /// * `aspect`: width of the picture over its height
    pub fn pdf_across(&self, ray: &Ray, distance: f32, aspect: f32) -> Option<f32> {
        match self {
            Camera::Moving(moving) => moving.pdf_across(ray, distance, aspect),
            still => {
                let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
                still.model().pdf_across(o, d, distance, aspect)
            }
        }
    }
}

/// The part of a direction across the camera's, and along it; `None` when it points backwards, or when the axes are
/// no orthonormal basis and so make no picture that light could find.
pub(super) fn split(frame: &CameraFrame, d: DVec3) -> Option<(DVec2, f64)> {
    let cosine = d.dot(frame.forward);
    let sees = cosine > 0.0 && frame.is_orthonormal();
    sees.then(|| (frame.across(d), cosine))
}

pub(super) fn importance(
    at: DVec2,
    cosine: f64,
    [pdf_area, pdf_direction, pdf_origin]: [f64; 3],
) -> Option<Importance> {
    let inside = at.abs().max_element() <= 1.0 && pdf_area > 0.0 && pdf_direction > 0.0;
    inside.then(|| Importance {
        at: at.as_vec2(),
        we: (pdf_area * pdf_direction / cosine) as f32,
        pdf_area: pdf_area as f32,
        pdf_direction: pdf_direction as f32,
        pdf_origin: pdf_origin as f32,
    })
}

pub(super) fn connection(wi: DVec3, distance: f64, seen: Importance, pdf: f64, across: f64) -> Connection {
    let Importance { at, we, .. } = seen;
    let (distance, pdf, pdf_across) = (distance as f32, pdf as f32, across as f32);
    Connection { wi: wi.as_vec3(), distance, at, we, pdf, pdf_across }
}
