//! Timber: growth rings with early and late wood, knots, rays and pores.
//!
//! Each point of a trunk along y has a time at which it grew. In the stem that is the distance from the pith, `t_s = f r`, bent by noise that
//! is stretched along the trunk; in a knot, a branch that grew out of the pith as a cone, it is `t_k = f d / k`, where `d` is the
//! distance from the branch's axis and `k` its thickness by the stem's. What was there first stays, so that the time is the smaller
//! one, and where both are nearly equal the grain leans: the smooth minimum of both [Larsson et al. 2022, section 4]. A
//! ring is pale early wood that darkens into late wood and ends at once. Rays are sheets outwards from the pith, pores thin tubes
//! along the trunk [Liu et al. 2016].

use super::bands::radius;
use super::{Pattern, fract, hash, lerp, noise, passed};
use crate::{Vec3, fmath};

/// Timber: 0 is the palest wood, 1 the darkest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timber {
    /// Rings per unit.
    pub frequency: f32,
    /// Rings by which noise bends them.
    pub bend: f32,
    /// Knots per unit of length.
    pub knots: f32,
    /// How dark the rays are.
    pub rays: f32,
    /// How dark the pores are.
    pub pores: f32,
    /// Chooses one of many trunks.
    pub seed: u32,
}

impl Default for Timber {
    fn default() -> Timber {
        Timber { frequency: 8.0, bend: 1.0, knots: 0.5, rays: 0.25, pores: 0.25, seed: 0 }
    }
}

/// The smooth minimum of two numbers that differ from it within `k` of each other.
fn smooth_min(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k * 0.25
}

impl Timber {
    /// The time at which a point grew, in rings.
    fn time(&self, q: Vec3, width: f32) -> f32 {
        let r = radius(q);
        let bent = passed(width, 1.0) * noise(Vec3::new(q.x, 0.2 * q.y, q.z), self.seed)
            + 0.5 * passed(width, 2.0) * noise(Vec3::new(2.0 * q.x, 0.4 * q.y, 2.0 * q.z) + 0.37, self.seed);
        let mut time = self.frequency * r + self.bend * bent;
        if self.knots > 0.0 {
            // One branch in each piece of the trunk; those of the pieces beside it may reach in.
            let piece = (q.y * self.knots).floor();
            for step in [-1.0, 0.0, 1.0] {
                let h = hash::cell([(piece + step) as i32, 17, 0], self.seed);
                let foot = (piece + step + hash::uniform(h, 0)) / self.knots;
                let (sin, cos) = fmath::sin_cos(std::f32::consts::TAU * hash::uniform(h, 1));
                // Branches rise a little.
                let axis = Vec3::new(sin, 0.3 * hash::uniform(h, 2), cos).normalize();
                let from_foot = q - foot * Vec3::Y;
                let along = from_foot.dot(axis);
                if along <= 0.0 {
                    continue;
                }
                let d = (from_foot - along * axis).length();
                let thickness = lerp(hash::uniform(h, 3), 0.08, 0.2);
                let grown = self.frequency * d / thickness + 0.5 * self.bend * bent;
                time = smooth_min(time, grown, 1.5);
            }
        }
        time
    }
}

/// How dark a ring is: pale early wood, then late wood, whose end samples average over.
fn ring(time: f32, width: f32) -> f32 {
    let t = fract(time);
    let late = t * t * t;
    let edge = (1.0 - t) / width.clamp(0.04, 1.0);
    lerp(edge.min(1.0), 0.0, 0.15 + 0.85 * late)
}

impl Pattern for Timber {
    fn is_finite(&self) -> bool {
        [self.frequency, self.bend, self.knots, self.rays, self.pores].iter().all(|v| v.is_finite())
    }

    fn at(&self, q: Vec3, width: f32) -> f32 {
        /// Mean darkness of a ring, for samples that are too far apart for rings.
        const MEAN_RING: f32 = 0.33;
        let share = passed(width, self.frequency);
        let rings = lerp(share, MEAN_RING, ring(self.time(q, width), width * self.frequency));
        let outwards = Vec3::new(q.x, 0.0, q.z).normalize_or_zero();
        let sheet =
            noise(Vec3::new(24.0 * outwards.x, 3.0 * q.y, 24.0 * outwards.z), self.seed.wrapping_add(1));
        let sheet = passed(width, 4.0) * ((sheet - 0.25) * 4.0).clamp(0.0, 1.0);
        let tube = noise(Vec3::new(40.0 * q.x, 1.5 * q.y, 40.0 * q.z), self.seed.wrapping_add(2));
        let tube = passed(width, 40.0) * ((tube - 0.3) * 5.0).clamp(0.0, 1.0);
        let dark = rings + self.rays * sheet * (1.0 - rings);
        dark + self.pores * tube * (1.0 - dark)
    }

    fn frequency(&self, _q: Vec3) -> f32 {
        // Knots and bends are wider than rings.
        self.frequency.abs().min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::spread;

    #[test]
    fn the_minimum_is_smooth_and_below_both() {
        for i in 0..400 {
            let p = 3.0 * spread(i);
            let v = smooth_min(p.x, p.y, 0.5);
            assert!(v <= p.x.min(p.y) && v >= p.x.min(p.y) - 0.125);
            assert_eq!(smooth_min(1.0, 1.0 + p.z.abs() + 0.5, 0.5), 1.0);
        }
    }

    #[test]
    fn plain_timber_has_rings_of_one_width() {
        let plain = Timber { bend: 0.0, knots: 0.0, rays: 0.0, pores: 0.0, ..Timber::default() };
        for i in 0..200 {
            let q = 4.0 * spread(i);
            let out = q * Vec3::new(1.0, 0.0, 1.0) * (1.0 + 1.0 / (8.0 * radius(q)));
            let [here, there] = [q, out].map(|q| plain.time(q, 0.0));
            assert!((there - here - 1.0).abs() < 1e-4, "{q}");
        }
        assert!((plain.at(Vec3::new(0.062_5, 0.0, 0.0), 0.0) - ring(0.5, 0.0)).abs() < 1e-5);
    }

    #[test]
    fn wood_within_a_branch_is_older() {
        let (bare, knotty) = (
            Timber { knots: 0.0, bend: 0.0, ..Timber::default() },
            Timber { bend: 0.0, ..Timber::default() },
        );
        let older = (0..4000).filter(|&i| {
            let q = 3.0 * spread(i);
            let [without, with] = [bare, knotty].map(|timber| timber.time(q, 0.0));
            assert!(with <= without);
            with < without - 1.0
        });
        let share = older.count() as f32 / 4000.0;
        assert!(share > 0.005 && share < 0.2, "{share}");
    }
}
