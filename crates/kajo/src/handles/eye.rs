//! Who looks: a camera and the size of its picture.

use kajo_math::{DVec2, DVec3};

use crate::CameraPose;

/// A camera and the size of its picture in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Eye<'a> {
    /// The camera.
    pub pose: &'a CameraPose,
    /// Columns and rows.
    pub size: [u32; 2],
}

/// A line that a pixel sees along.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub origin: DVec3,
    pub direction: DVec3,
    /// Whether nothing behind the origin is seen.
    pub only_ahead: bool,
}

impl Sight {
    /// Where it meets the plane through `p` with this normal; `None` where it does not, or the plane is seen edge on.
    pub fn meets(&self, p: DVec3, normal: DVec3) -> Option<DVec3> {
        let slope = self.direction.dot(normal);
        let t = (p - self.origin).dot(normal) / slope;
        // Edge on, a pixel would move it out of sight.
        let is_edge_on = slope.abs() <= 1e-3 * normal.length() * self.direction.length();
        (!is_edge_on && t.is_finite() && !(self.only_ahead && t <= 0.0))
            .then(|| self.origin + t * self.direction)
    }
}

impl Eye<'_> {
    /// Where a point appears, in pixels from the top left.
    pub fn project(&self, p: DVec3) -> Option<DVec2> {
        self.pose.project(p, self.size).filter(|place| place.is_finite())
    }

    /// What a place of the picture sees.
    pub(super) fn sight(&self, place: DVec2) -> Option<Sight> {
        let ray = self.pose.ray(place, self.size)?;
        Some(Sight { origin: ray.o.as_dvec3(), direction: ray.d.as_dvec3(), only_ahead: ray.t_min >= 0.0 })
    }

    /// World units that one pixel spans at `p`, across the line of sight.
    pub fn pixel_at(&self, p: DVec3) -> f64 {
        // A step small enough for the picture to be flat, and large enough for rounding.
        let step = match self.pose.size() {
            Some(size) => 0.01 * size.abs(),
            None => 0.01 * (p - self.pose.eye()).length(),
        };
        let across = self.pose.right() * step;
        let pixels = self.project(p).zip(self.project(p + across)).map(|(a, b)| a.distance(b));
        pixels.filter(|&pixels| pixels > 0.0).map_or(step, |pixels| step / pixels)
    }

    /// The unit direction from the eye to `p`, or that of parallel rays.
    pub(super) fn towards(&self, p: DVec3) -> DVec3 {
        if self.pose.size().is_some() {
            return self.pose.forward();
        }
        (p - self.pose.eye()).normalize_or(self.pose.forward())
    }
}
