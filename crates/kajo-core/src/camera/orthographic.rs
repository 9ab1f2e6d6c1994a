//! Parallel rays, or with a lens those of a telecentric camera.
//!
//! Origins cover `center + (size/2) (x aspect right + y up)`. Rays start infinitely far back:
//! what is behind the camera is seen too. With a lens each position of the picture has an opening of its own
//! around its origin, and rays start there.
//!
//! Scene: `OrthographicCamera { center 0 0 10  direction 0 0 -1  up 0 1 0  size 5 }`

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2};

use super::fit::{Fit, FitError, FitSpace, Freedom};
use super::importance::{connection, importance, split};
use super::model::CameraModel;
use super::origins::around_lens;
use super::{Camera, CameraFrame, Connection, Importance, ThinLens};

/// An orthographic camera.
#[derive(Clone, Debug)]
pub struct OrthographicCamera {
    /// Position and axes.
    pub frame: CameraFrame,
    /// Height of the picture in world units.
    pub size: f64,
    /// The lens, if there is one.
    pub lens: Option<ThinLens>,
}

impl OrthographicCamera {
    /// Half the picture's width and height in world units.
    pub(super) fn half_size(&self, aspect: f32) -> DVec2 {
        0.5 * self.size * DVec2::new(f64::from(aspect), 1.0)
    }

    /// Half the width and height of the part of the picture's plane from which rays start.
    fn half_size_with_lens(&self, aspect: f32, lens: &ThinLens) -> DVec2 {
        self.half_size(aspect).abs() + lens.radius
    }

    /// Density of points of the film per area.
    fn pdf_film(&self, aspect: f32) -> f64 {
        let half = self.half_size(aspect);
        1.0 / (4.0 * half.x * half.y).abs()
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

impl CameraModel for OrthographicCamera {
    fn keyword(&self) -> &'static str {
        "OrthographicCamera"
    }

    fn is_finite(&self) -> bool {
        self.size.is_finite()
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
        let o = center + 0.5 * self.size * (x * right + y * up);
        Some(match &self.lens {
            None => Ray::new(o.as_vec3(), forward.as_vec3()).over(f32::NEG_INFINITY, f32::INFINITY),
            Some(thin) => {
                let (o, d) = thin.refract(&self.frame, o, thin.focus * forward, lens);
                Ray::new(o.as_vec3(), d.normalize_or_zero().as_vec3())
            }
        })
    }

    fn has_extent(&self) -> bool {
        true
    }

    fn origins(&self, positions: [Vec2; 2], aspect: f32) -> Option<Aabb> {
        let lens = self.lens.as_ref()?;
        let CameraFrame { right, up, .. } = self.frame;
        let half = self.half_size(aspect);
        let [a, b] = positions.map(Vec2::as_dvec2);
        let corner = |x: f64, y: f64| half.x * x * right + half.y * y * up;
        let corners = [corner(a.x, a.y), corner(a.x, b.y), corner(b.x, a.y), corner(b.x, b.y)];
        let opening = |middle| around_lens(&self.frame, middle, Some(lens));
        Some(corners.into_iter().map(opening).fold(Aabb::EMPTY, Aabb::union))
    }

    fn project(&self, local: DVec3, aspect: f64) -> Option<DVec2> {
        Some(local.truncate() * 2.0 / (self.size * DVec2::new(aspect, 1.0)))
    }

    fn fitted(&self, fit: &Fit, space: &FitSpace<'_>, inside: f64) -> Result<Camera, FitError> {
        let here = space.coordinates(self.frame.center);
        let mut middle = here;
        let mut extent = [0.0; 2];
        for (axis, unit) in [DVec3::X, DVec3::Y].into_iter().enumerate() {
            let (low, high) = (space.least(unit), -space.least(-unit));
            if fit.freedom == Freedom::Position {
                middle[axis] = 0.5 * (low + high);
            }
            extent[axis] = 2.0 * (high - middle[axis]).max(middle[axis] - low);
        }
        if fit.freedom != Freedom::Opening {
            // In front of all of it, where a lens has something to focus on.
            middle.z = space.least(DVec3::Z) - space.diameter();
        }
        let size = extent[1].max(extent[0] / fit.aspect) / inside;
        let size = if size > 0.0 { size } else { 1.0 };
        let frame = CameraFrame { center: space.point(middle), ..self.frame };
        Ok(OrthographicCamera { frame, size, ..self.clone() }.into())
    }

    fn is_connectable(&self) -> bool {
        true
    }

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

    fn sample_origin(&self, u: Vec2, aspect: f32) -> Option<DVec3> {
        let half = self.half_size_with_lens(aspect, self.lens.as_ref()?);
        Some(self.frame.in_plane((2.0 * u.as_dvec2() - 1.0) * half))
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

    /// Points of the film per area across a ray that leaves it.
    fn pdf_across(&self, o: DVec3, d: DVec3, _distance: f32, aspect: f32) -> Option<f32> {
        let (_, cosine) = split(&self.frame, d)?;
        if self.lens.is_some() {
            return self.importance(o, d, aspect).map(|seen| seen.pdf_area / cosine as f32);
        }
        let at = self.frame.across(o - self.frame.center) / self.half_size(aspect);
        (at.abs().max_element() <= 1.0).then(|| self.pdf_film(aspect) as f32)
    }
}
