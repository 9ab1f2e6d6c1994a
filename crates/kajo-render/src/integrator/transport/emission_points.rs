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
            let emissive = most(&majorant);
            // Where nothing is emitted the ray may go on without end.
            if emissive > 0.0 {
                all += emissive * (t_max - t_min);
                optical_depth += matter.hero_extinction(&majorant) * (t_max - t_min);
            }
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

#[cfg(test)]
mod tests {
    use kajo_color::Spectrum;
    use kajo_math::Vec3;

    use super::*;

    /// Stretches of these lengths, one behind the other, with the majorants and the extinction of each.
    struct Stretches<'a>(&'a [(f32, f32, f32)]);

    impl NullCollisionMedium for Stretches<'_> {
        type Most = (f32, f32);
        type Depth = f32;

        fn spans(&self, _ray: &Ray) -> impl Iterator<Item = Span<(f32, f32)>> {
            self.0.iter().scan(0.0, |at, &(length, majorant, sigma)| {
                let t_min = *at;
                *at += length;
                Some(Span { t_min, t_max: *at, most: (majorant, sigma) })
            })
        }

        fn is_void(&self, most: &(f32, f32)) -> bool {
            most.0 == 0.0
        }

        fn hero_extinction(&self, most: &(f32, f32)) -> f32 {
            most.1
        }

        fn depth(&self, most: &(f32, f32), length: f32) -> f32 {
            most.1 * length
        }

        fn transmittance(&self, depth: f32) -> Spectrum {
            (Spectrum::WHITE * -depth).exp()
        }
    }

    /// All points of a ray, each with the length that it stands for.
    fn points(stretches: &Stretches<'_>, scatterings: u32, u: f32) -> Option<Vec<(f32, f32)>> {
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        let mut points = EmissionPoints::along(stretches, &ray, scatterings, |most| most.0, u)?;
        let mut all = Vec::new();
        for Span { t_min, t_max, most: (majorant, _) } in stretches.spans(&ray) {
            // A null collision cuts a stretch in two.
            let middle = t_min + 0.3 * (t_max - t_min).min(1.0);
            for (from, to) in [(t_min, middle), (middle, t_max)] {
                while let Some(point) = points.next_in(from, to, majorant) {
                    assert!((from..=to).contains(&point.0), "{point:?} {from} {to}");
                    all.push(point);
                }
                points.pass(from, to, majorant);
            }
        }
        Some(all)
    }

    /// As many as there are to be, so that each stretch has its length in the mean over `u`; none where nothing is emitted.
    #[test]
    fn points_stand_for_the_lengths_of_their_stretches() {
        let some = [(0.7, 2.0, 0.1), (1.5, 0.0, 3.0), (0.2, 9.0, 0.0), (2.0, 0.5, 0.2)];
        let stretches = Stretches(&some);
        for (scatterings, count) in [(0, 16), (3, 4)] {
            let (mut lengths, n) = ([0.0; 4], 1000);
            for i in 0..n {
                let all =
                    points(&stretches, scatterings, (i as f32 + 0.5) / n as f32).expect("light is given");
                assert!(all.len().abs_diff(count) <= 1, "{}", all.len());
                for (at, length) in all {
                    let k = [0.7, 2.2, 2.4].iter().filter(|end| at > **end).count();
                    lengths[k] += length / n as f32;
                }
            }
            let expected = some.map(|(length, majorant, _)| if majorant > 0.0 { length } else { 0.0 });
            assert!((0..4).all(|k| (lengths[k] - expected[k]).abs() < 0.01), "{lengths:?}");
        }
    }

    /// In dense matter there are more of them, and what emits nothing may have no end.
    #[test]
    fn there_are_two_on_a_mean_free_path() {
        let dense = Stretches(&[(1.0, 3.0, 50.0), (f32::INFINITY, 0.0, 7.0)]);
        assert!(points(&dense, 2, 0.5).expect("light is given").len().abs_diff(100) <= 1);
        assert!(points(&Stretches(&[(f32::INFINITY, 1.0, 1.0)]), 2, 0.5).is_none());
        assert!(points(&Stretches(&[(1.0, 0.0, 1.0)]), 2, 0.5).is_none());
    }
}
