//! Who looks: a camera and the size of its picture.

use kajo_math::{DVec2, DVec3};

use kajo::CameraPose;

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
    pub fn intersect(&self, p: DVec3, normal: DVec3) -> Option<DVec3> {
        let slope = self.direction.dot(normal);
        let t = (p - self.origin).dot(normal) / slope;
        // Edge on, a pixel would move it out of sight.
        let is_edge_on = slope.abs() <= 1e-3 * normal.length() * self.direction.length();
        (!is_edge_on && t.is_finite() && !(self.only_ahead && t <= 0.0))
            .then(|| self.origin + t * self.direction)
    }
}

impl Eye<'_> {
    /// Where a point appears, in pixels from the top left; of two eyes, to the left one.
    pub fn project(&self, p: DVec3) -> Option<DVec2> {
        self.projections(p).into_iter().flatten().next()
    }

    /// All places where a point appears: one, or one for each eye.
    pub fn projections(&self, p: DVec3) -> [Option<DVec2>; 2] {
        self.pose.projections(p, self.size).map(|position| position.filter(|position| position.is_finite()))
    }

    /// The place where a point appears that is nearest to another place.
    pub(super) fn projection_near(&self, p: DVec3, near: DVec2) -> Option<DVec2> {
        let places = self.projections(p).into_iter().flatten();
        places.min_by(|a, b| a.distance_squared(near).total_cmp(&b.distance_squared(near)))
    }

    /// What a place of the picture sees.
    pub(super) fn sight(&self, position: DVec2) -> Option<Sight> {
        let ray = self.pose.ray(position, self.size)?;
        Some(Sight { origin: ray.o.as_dvec3(), direction: ray.d.as_dvec3(), only_ahead: ray.t_min >= 0.0 })
    }

    /// World units that one pixel spans at `p`, across the line of sight.
    pub fn pixel_at(&self, p: DVec3) -> f64 {
        // A step small enough for the picture to be flat, and large enough for rounding.
        let step = match self.pose.size() {
            Some(size) => 0.01 * size.abs(),
            None => 0.01 * (p - self.pose.eye()).length(),
        };
        let across = self.axes_at(p).right * step;
        let pixels = |to: DVec3| self.project(p).zip(self.project(to)).map(|(a, b)| a.distance(b));
        // At the edge of a panorama one of the two neighbours is far away.
        let pixels =
            [pixels(p + across), pixels(p - across)].into_iter().flatten().fold(f64::INFINITY, f64::min);
        if pixels > 0.0 && pixels.is_finite() { step / pixels } else { step }
    }

    /// The unit direction from the eye to `p`, or that of parallel rays.
    pub(super) fn towards(&self, p: DVec3) -> DVec3 {
        if self.pose.size().is_some() {
            return self.pose.forward();
        }
        (p - self.pose.eye()).normalize_or(self.pose.forward())
    }

    /// The directions of the picture around a point: those of the camera, or in a picture that is not flat those of one
    /// that looks at the point.
    pub(super) fn axes_at(&self, p: DVec3) -> PictureAxes {
        let (right, up, ahead) = (self.pose.right(), self.pose.up(), self.pose.forward());
        if self.pose.is_flat() {
            return PictureAxes { right, up, ahead };
        }
        let ahead = self.towards(p);
        // Straight above and below the camera the picture has no right of its own.
        let right = ahead.cross(up).try_normalize().unwrap_or(right);
        PictureAxes { right, up: right.cross(ahead), ahead }
    }
}

/// Unit vectors to the right, up and ahead in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct PictureAxes {
    pub right: DVec3,
    pub up: DVec3,
    pub ahead: DVec3,
}
