//! Blobs of balls with POV-Ray's kernel: the field along a ray is a quartic.
//!
//! In a [cell](super::cells) `1 - u` of a ball is a quadratic along the ray, whose Bernstein coefficients are products of the places of
//! both ends, and its square a quartic; so is the sum, but where the border of a ball is passed, at which the piece is cut.

use kajo_math::DVec3;
use kajo_math::roots::{quadratic, sign_changes_until};

use super::field::{BlobCore, BlobKernel, Term};
use crate::shape::Ray64;

/// The balls of such a blob.
#[derive(Debug)]
pub(super) struct QuarticBalls {
    threshold: f64,
    balls: Vec<QuarticBall>,
}

#[derive(Clone, Copy, Debug)]
struct QuarticBall {
    center: DVec3,
    /// One over the squared radius.
    inverse2: f64,
    strength: f64,
}

/// A ball's `1 - u` on a piece of a ray, by Bernstein coefficients.
type Quadratic = [f64; 3];

impl QuarticBall {
    /// On the piece between two places.
    #[inline(always)]
    fn quadratic(&self, a: DVec3, b: DVec3) -> Quadratic {
        let (a, b) = (a - self.center, b - self.center);
        [a.dot(a), a.dot(b), b.dot(b)].map(|product| 1.0 - product * self.inverse2)
    }

    /// Adds the square of a quadratic, times the strength.
    #[inline(always)]
    fn add_square(&self, [v0, v1, v2]: Quadratic, sum: &mut [f64; 5]) {
        let square = [v0 * v0, v0 * v1, (v0 * v2 + 2.0 * v1 * v1) / 3.0, v1 * v2, v2 * v2];
        sum.iter_mut().zip(square).for_each(|(sum, v)| *sum += self.strength * v);
    }
}

impl QuarticBalls {
    /// `None` for another kernel, and for terms that are not all balls.
    pub fn new(kernel: BlobKernel, terms: &[Term], threshold: f64) -> Option<QuarticBalls> {
        (kernel == BlobKernel::Povray).then_some(())?;
        let ball = |term: &Term| match term.core() {
            BlobCore::Ball(center) => {
                Some(QuarticBall { center, inverse2: term.inverse2(), strength: term.strength() })
            }
            _ => None,
        };
        let balls = terms.iter().map(ball).collect::<Option<_>>()?;
        Some(QuarticBalls { threshold, balls })
    }

    /// Visits the crossings on a piece of a line that lies in the support of these balls alone, in ascending order, until `visit` says that it
    /// is enough; whether it did.
    #[inline(always)]
    pub fn cross(
        &self,
        members: &[u32],
        line: &Ray64,
        [from, to]: [f64; 2],
        borders: &mut Vec<f64>,
        visit: &mut impl FnMut(f64) -> bool,
    ) -> bool {
        let ends = [from, to].map(|t| line.at(t));
        // Where borders of balls are passed this is more than the field.
        let mut most = [-self.threshold; 5];
        let mut is_cut = false;
        for &i in members {
            let ball = &self.balls[i as usize];
            let v = ball.quadratic(ends[0], ends[1]);
            if v[0].max(v[1]).max(v[2]) <= 0.0 {
                continue;
            }
            let passes_border = v[0] < 0.0 || v[2] < 0.0;
            is_cut |= passes_border;
            if !passes_border || ball.strength > 0.0 {
                ball.add_square(v.map(|v| v.max(0.0)), &mut most);
            }
        }
        if most.iter().all(|&v| v < 0.0) {
            return false;
        }
        if !is_cut {
            return sign_changes_until(&most, |s| visit(from + s * (to - from)));
        }
        self.cross_cut(members, line, [from, to], borders, visit)
    }

    /// The same where the borders of balls are passed.
    #[inline(never)]
    fn cross_cut(
        &self,
        members: &[u32],
        line: &Ray64,
        [from, to]: [f64; 2],
        borders: &mut Vec<f64>,
        visit: &mut dyn FnMut(f64) -> bool,
    ) -> bool {
        borders.clear();
        let ends = [from, to].map(|t| line.at(t));
        for &i in members {
            let v = self.balls[i as usize].quadratic(ends[0], ends[1]);
            if v[0] >= 0.0 && v[2] >= 0.0 || v[0].max(v[1]).max(v[2]) <= 0.0 {
                continue;
            }
            let roots = quadratic(v[0] - 2.0 * v[1] + v[2], v[1] - v[0], v[0]);
            let roots = roots.into_iter().flat_map(|(a, b)| [a, b]).filter(|s| *s > 0.0 && *s < 1.0);
            borders.extend(roots.map(|s| from + s * (to - from)));
        }
        borders.push(to);
        borders.sort_unstable_by(f64::total_cmp);
        let (mut from, mut start) = (from, ends[0]);
        for &border in &*borders {
            let border = border.min(to);
            if border <= from {
                continue;
            }
            let end = line.at(border);
            let mut sum = [-self.threshold; 5];
            for &i in members {
                let ball = &self.balls[i as usize];
                let v = ball.quadratic(start, end);
                // What it says between borders it says in their middle.
                if v[0] + 2.0 * v[1] + v[2] > 0.0 {
                    ball.add_square(v.map(|v| v.max(0.0)), &mut sum);
                }
            }
            if sign_changes_until(&sum, |s| visit(from + s * (border - from))) {
                return true;
            }
            (from, start) = (border, end);
        }
        false
    }

    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.balls)
    }
}
