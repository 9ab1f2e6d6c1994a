//! A ball that light is inside of, for tests.

use kajo_math::{Aabb, DVec3, Ray, Vec3};

use super::{Chords, Region};

/// A ball that light is inside of.
pub(crate) struct SphereChords {
    center: DVec3,
    radius: f64,
    /// Chords that it let pass.
    pub passed: Vec<Ray>,
}

impl SphereChords {
    pub fn new(center: DVec3, radius: f64) -> SphereChords {
        SphereChords { center, radius, passed: Vec::new() }
    }

    pub fn region(&self) -> Region {
        let (c, r) = (self.center.as_vec3(), Vec3::splat(self.radius as f32));
        Region { bounds: Aabb { min: c - r, max: c + r } }
    }
}

impl Chords for SphereChords {
    fn hit(&mut self, chord: &Ray) -> Option<f32> {
        let (o, d) = (chord.o.as_dvec3() - self.center, chord.d.as_dvec3());
        let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - self.radius * self.radius);
        let t = ((-b + (b * b - a * c).sqrt()) / a) as f32;
        (t > chord.t_min && t < chord.t_max).then_some(t)
    }

    fn passed(&mut self, chord: &Ray) {
        self.passed.push(*chord);
    }
}
