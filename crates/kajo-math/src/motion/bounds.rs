//! Boxes around what moves.
//!
//! A tree over moving boxes needs them to move steadily: corners `(1 - s) p_open + s p_close` over the shutter. Where
//! the motion is smooth, a chord over a step `h` in time is nowhere farther from a point's path than
//!
//! ```text
//! h^2 / 8 max |p''|,
//! ```
//!
//! and `|p''|` is bounded through the chain of maps by the product rule. So the box of the object at the ends of
//! each step, larger by that much, moved steadily from one to the other, holds the object; and the lowest straight
//! line over time that is nowhere below the corners at all these moments moves a box that holds them all.

use super::Motion;
use super::pose::norm;
use crate::{Aabb, DAffine3, DVec3};

/// The most steps between two keys.
const MOST_STEPS: f64 = 64.0;

/// Share of the object's size that chords may be off by, up to the largest number of steps.
const TOLERANCE: f64 = 1.0 / 128.0;

/// Relative size of rounding, with room to spare.
const ROUNDING: f32 = 1e-6;

/// An object's box at a moment, from corner to corner.
struct Moment {
    /// Share of the interval, 0 to 1.
    s: f64,
    min: DVec3,
    max: DVec3,
}

impl Motion {
    /// Boxes at the two ends of an interval such that the box that moves steadily from the first to the second
    /// holds the image of `b` at all times, rounding included.
    pub fn bounds(&self, b: &Aabb, [open, close]: [f64; 2]) -> [Aabb; 2] {
        if b.is_empty() {
            return [Aabb::EMPTY; 2];
        }
        let corners = corners(b);
        let radius = corners.iter().map(|p| self.still.transform_point3(*p).length()).fold(0.0, f64::max);
        let size = b.extent().as_dvec3().length() * norm(&self.still.matrix3);
        let mut moments = Vec::new();
        for ends in self.smooth_intervals([open, close]).windows(2) {
            let length = ends[1] - ends[0];
            let bend = self.acceleration(0.5 * (ends[0] + ends[1]), radius) * length * length / 8.0;
            // A point that goes straight needs no more than its ends.
            let wanted = if bend > 0.0 { (bend / (TOLERANCE * size)).sqrt().ceil() } else { 1.0 };
            let steps = wanted.clamp(1.0, MOST_STEPS);
            let off = bend / (steps * steps);
            for i in 0..=steps as u32 {
                let t = ends[0] + length * (f64::from(i) / steps);
                let s = if close > open { (t - open) / (close - open) } else { f64::from(i) };
                moments.push(moment(s, &self.at(t), &corners, off));
            }
        }
        steady(&moments)
    }

    /// The interval's ends, and the keys within.
    fn smooth_intervals(&self, [open, close]: [f64; 2]) -> Vec<f64> {
        let keys = self.links().iter().flat_map(|link| link.keys.times.iter().copied());
        let mut ends: Vec<f64> = keys.filter(|t| (open..close).contains(t)).chain([open, close]).collect();
        ends.sort_by(f64::total_cmp);
        // A moment alone is a piece too.
        if close > open {
            ends.dedup();
        }
        ends
    }

    /// A bound on the second derivative by time of the path of any point that the still map takes no farther than
    /// `radius` from the origin, in the smooth piece around `time`.
    fn acceleration(&self, time: f64, radius: f64) -> f64 {
        // Bounds on the distance from the origin, the speed and the acceleration, from the inside out.
        let mut r = [radius, 0.0, 0.0];
        for link in self.links().iter().rev() {
            let keys = &link.keys;
            let i = keys.segment_at(time);
            let (start, end) = (keys.times[i], keys.times[i + 1]);
            let rests = time < start || time > end;
            let duration = if rests { f64::INFINITY } else { end - start };
            let [l0, l1, l2] = keys.segments[i].linear_rates(duration);
            let [t0, t1] = keys.segments[i].translation_rates(duration);
            let bend = l2 * r[0] + 2.0 * l1 * r[1] + l0 * r[2];
            r = [t0 + l0 * r[0], t1 + l1 * r[0] + l0 * r[1], bend];
            let n = norm(&link.before.matrix3);
            r = [link.before.translation.length() + n * r[0], n * r[1], n * r[2]];
        }
        r[2]
    }
}

fn corners(b: &Aabb) -> [DVec3; 8] {
    let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
    std::array::from_fn(|i| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

fn moment(s: f64, m: &DAffine3, corners: &[DVec3; 8], off: f64) -> Moment {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in corners {
        let p = m.transform_point3(*corner);
        (min, max) = (min.min(p), max.max(p));
    }
    Moment { s, min: min - off, max: max + off }
}

/// The tightest steady boxes around boxes at some moments, whose first is 0 and whose last is 1.
fn steady(moments: &[Moment]) -> [Aabb; 2] {
    let mut boxes = [Aabb::EMPTY; 2];
    for axis in 0..3 {
        let above = line_above(moments.iter().map(|m| [m.s, m.max[axis]]));
        let below = line_above(moments.iter().map(|m| [m.s, -m.min[axis]]));
        for end in 0..2 {
            boxes[end].min[axis] = -below[end] as f32;
            boxes[end].max[axis] = above[end] as f32;
        }
    }
    if !boxes.iter().all(Aabb::is_finite) {
        return [Aabb::EVERYWHERE; 2];
    }
    let size = boxes.iter().map(|b| b.min.abs().max(b.max.abs()).max_element()).fold(0.0, f32::max);
    boxes.map(|b| Aabb { min: b.min - size * ROUNDING, max: b.max + size * ROUNDING })
}

/// The heights at 0 and 1 of the line that is nowhere below the points and lowest in the middle: the edge of their
/// convex hull over 1/2. The points are sorted from 0 to 1.
fn line_above(points: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let mut hull: Vec<[f64; 2]> = Vec::new();
    for p in points {
        while let [.., a, b] = hull[..]
            && (b[0] - a[0]) * (p[1] - a[1]) >= (p[0] - a[0]) * (b[1] - a[1])
        {
            hull.pop();
        }
        match hull.last_mut() {
            Some(last) if last[0] == p[0] => last[1] = last[1].max(p[1]),
            _ => hull.push(p),
        }
    }
    let edge = hull.windows(2).find(|edge| edge[1][0] >= 0.5);
    let Some(&[a, b]) = edge else { return [f64::INFINITY; 2] };
    let slope = (b[1] - a[1]) / (b[0] - a[0]);
    [a[1] - slope * a[0], b[1] + slope * (1.0 - b[0])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_above_touches_and_never_cuts() {
        let hill = |s: f64| 3.0 - (s - 0.3) * (s - 0.3);
        let points: Vec<[f64; 2]> = (0..=50).map(|i| f64::from(i) / 50.0).map(|s| [s, hill(s)]).collect();
        let [open, close] = line_above(points.iter().copied());
        let line = |s: f64| open + s * (close - open);
        assert!(points.iter().all(|p| line(p[0]) >= p[1] - 1e-12));
        assert!(line(0.5) - hill(0.5) < 1e-3, "no line above is lower in the middle");
        assert_eq!(line_above([[0.0, 1.0], [0.5, -9.0], [1.0, 3.0]].into_iter()), [1.0, 3.0]);
        // Two pieces meet at a moment, each with a box of its own.
        let doubled = [[0.0, 0.0], [0.5, 1.0], [0.5, 2.0], [0.5, 1.5], [1.0, 0.0]];
        let [open, close] = line_above(doubled.into_iter());
        assert!(0.5 * (open + close) >= 2.0);
    }
}
