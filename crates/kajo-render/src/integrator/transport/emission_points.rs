//! Points of a ray at which it is asked what the media along it emit.
//!
//! The light that media give between the distances `a` and `b`, the integral of `T e`, is estimated at few points, spread evenly not over the ray but
//! over what the media have of density at most, the integral `M(t)` of the majorant `m`:
//!
//! ```text
//! integral of T e dt = integral of T e / m dM  ~  D sum over k of  T(t_k) e(t_k) / m(t_k),    M(t_k) = (u + k) D
//! ```
//!
//! with one uniform number `u` for all of them, and the spacing `D` such that a ray which no collision ends has a given number of
//! points, and one that collisions end has some before them. Where the majorant is near the density, each point brings as much.

use kajo_math::Ray;

use super::null_collisions::{NullCollisionMedium, Span};

/// Points of a ray that the camera casts: what it sees is seen in the picture.
const SEEN: f32 = 16.0;

/// Points of a ray behind a vertex, which is one of many for a pixel.
const BEHIND_VERTICES: f32 = 4.0;

/// Points within a mean free path of the majorant.
const BETWEEN_COLLISIONS: f32 = 2.0;

/// The points of a ray, as it is followed from its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct EmissionPoints {
    /// `M` where the ray has come to.
    passed: f32,
    /// `M` at the next point.
    next: f32,
    /// `D`.
    spacing: f32,
}

impl EmissionPoints {
    /// Those of a ray; `None` where it has no end, or nothing is along it.
    ///
    /// * `scatterings`: of the path before
    /// * `most`: what counts as the majorant of a span
    /// * `u`: uniform in [0, 1)
    pub fn along<M: NullCollisionMedium>(
        matter: &M,
        ray: &Ray,
        scatterings: u32,
        most: impl Fn(&M::Most) -> f32,
        u: f32,
    ) -> Option<EmissionPoints> {
        let (mut all, mut optical_depth) = (0.0, 0.0);
        for Span { t_min, t_max, most: majorant } in matter.spans(ray) {
            all += most(&majorant) * (t_max - t_min);
            optical_depth += matter.hero_extinction(&majorant) * (t_max - t_min);
        }
        let least = if scatterings == 0 { SEEN } else { BEHIND_VERTICES };
        let spacing = all / least.max(BETWEEN_COLLISIONS * optical_depth);
        let usable = spacing > 0.0 && spacing.is_finite();
        usable.then_some(EmissionPoints { passed: 0.0, next: u * spacing, spacing })
    }

    /// The next point of a stretch of constant majorant, with the length that it stands for; `None` where the stretch has no more.
    ///
    /// * `from`, `to`: the distances of its ends
    #[inline]
    pub fn next_in(&mut self, from: f32, to: f32, majorant: f32) -> Option<(f32, f32)> {
        let ahead = self.next - self.passed;
        let whole = majorant * (to - from);
        if ahead >= whole || majorant <= 0.0 {
            return None;
        }
        self.next += self.spacing;
        Some(((from + ahead.max(0.0) / majorant).min(to), self.spacing / majorant))
    }

    /// Goes on behind a stretch.
    #[inline]
    pub fn pass(&mut self, from: f32, to: f32, majorant: f32) {
        self.passed += majorant * (to - from);
    }
}
