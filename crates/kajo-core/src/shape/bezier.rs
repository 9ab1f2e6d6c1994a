//! Bezier curves of degree one to three, and paths of them, in any number of dimensions.
//!
//! Splines through points are made cubic: with the points `p` the tangent at `p[i]` is `(p[i+1] - p[i-1]) / 2`, at an end the
//! difference to the only neighbour [Catmull and Rom 1974], and a tangent `m` puts controls at `p ± m / 3`.

use std::ops::{Add, Mul, Sub};

/// What control points may be.
pub trait ControlPoint:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl<V: Copy + PartialEq + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>> ControlPoint for V {}

/// A line, a quadratic or a cubic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier<V> {
    points: [V; 4],
    degree: usize,
}

impl<V: ControlPoint> Bezier<V> {
    /// The straight line between two points.
    pub fn line(a: V, b: V) -> Bezier<V> {
        Bezier { points: [a, b, b, b], degree: 1 }
    }

    /// From `a` to `c`, drawn towards `b`.
    pub fn quadratic([a, b, c]: [V; 3]) -> Bezier<V> {
        Bezier { points: [a, b, c, c], degree: 2 }
    }

    /// From the first point to the last, drawn towards the others.
    pub fn cubic(points: [V; 4]) -> Bezier<V> {
        Bezier { points, degree: 3 }
    }

    /// Its control points: one more than its degree.
    pub fn points(&self) -> &[V] {
        &self.points[..=self.degree]
    }

    /// Where it begins.
    pub fn start(&self) -> V {
        self.points[0]
    }

    /// Where it ends.
    pub fn end(&self) -> V {
        self.points[self.degree]
    }

    /// The same with every control point mapped, which for affine maps is the mapped curve.
    pub fn map<W: ControlPoint>(&self, map: impl FnMut(V) -> W) -> Bezier<W> {
        Bezier { points: self.points.map(map), degree: self.degree }
    }

    /// The point at `s` in [0, 1], by de Casteljau's algorithm.
    #[inline]
    pub fn at(&self, s: f64) -> V {
        let [a, b, c, d] = self.points;
        let mix = |a: V, b: V| a * (1.0 - s) + b * s;
        match self.degree {
            1 => mix(a, b),
            2 => mix(mix(a, b), mix(b, c)),
            _ => {
                let (ab, bc, cd) = (mix(a, b), mix(b, c), mix(c, d));
                mix(mix(ab, bc), mix(bc, cd))
            }
        }
    }

    /// The derivative by `s`.
    #[inline]
    pub fn derivative(&self, s: f64) -> V {
        let [a, b, c, d] = self.points;
        let mix = |a: V, b: V| a * (1.0 - s) + b * s;
        match self.degree {
            1 => b - a,
            2 => mix(b - a, c - b) * 2.0,
            _ => mix(mix(b - a, c - b), mix(c - b, d - c)) * 3.0,
        }
    }

    /// The second derivative by `s`.
    #[inline]
    pub fn second_derivative(&self, s: f64) -> V {
        let [a, b, c, d] = self.points;
        match self.degree {
            1 => (b - a) * 0.0,
            2 => (a - b * 2.0 + c) * 2.0,
            _ => ((a - b * 2.0 + c) * (1.0 - s) + (b - c * 2.0 + d) * s) * 6.0,
        }
    }

    /// What is before `s` and what is behind.
    pub fn split(&self, s: f64) -> [Bezier<V>; 2] {
        let [a, b, c, d] = self.points;
        let mix = |a: V, b: V| a * (1.0 - s) + b * s;
        match self.degree {
            1 => {
                let middle = mix(a, b);
                [Bezier::line(a, middle), Bezier::line(middle, b)]
            }
            2 => {
                let (ab, bc) = (mix(a, b), mix(b, c));
                let middle = mix(ab, bc);
                [Bezier::quadratic([a, ab, middle]), Bezier::quadratic([middle, bc, c])]
            }
            _ => {
                let (ab, bc, cd) = (mix(a, b), mix(b, c), mix(c, d));
                let (abc, bcd) = (mix(ab, bc), mix(bc, cd));
                let middle = mix(abc, bcd);
                [Bezier::cubic([a, ab, abc, middle]), Bezier::cubic([middle, bcd, cd, d])]
            }
        }
    }

    /// The curve in `2^levels` pieces, in order.
    pub fn subdivided(&self, levels: u32) -> Vec<Bezier<V>> {
        let mut pieces = vec![*self];
        for _ in 0..levels {
            pieces = pieces.iter().flat_map(|piece| piece.split(0.5)).collect();
        }
        pieces
    }
}

/// Curves one behind the other, each beginning at the very point where the one before ends.
#[derive(Clone, Debug)]
pub struct Path<V> {
    start: V,
    curves: Vec<Bezier<V>>,
}

impl<V: ControlPoint> Path<V> {
    /// A path that begins somewhere and goes nowhere yet.
    pub fn new(start: V) -> Path<V> {
        Path { start, curves: Vec::new() }
    }

    /// A smooth path through points, back to the first.
    pub fn closed_spline(points: &[V]) -> Option<Path<V>> {
        let n = points.len();
        let mut path = Path::new(*points.first()?);
        let tangent = |i: usize| (points[(i + 1) % n] - points[(i + n - 1) % n]) * 0.5;
        for i in 0..n {
            path.hermite(points[(i + 1) % n], [tangent(i), tangent((i + 1) % n)]);
        }
        Some(path)
    }

    /// The same with every control point mapped.
    pub fn map<W: ControlPoint>(&self, map: impl Fn(V) -> W) -> Path<W> {
        Path { start: map(self.start), curves: self.curves.iter().map(|curve| curve.map(&map)).collect() }
    }

    /// Its curves, in order.
    pub fn curves(&self) -> &[Bezier<V>] {
        &self.curves
    }

    /// Where it has come to.
    pub fn end(&self) -> V {
        self.curves.last().map_or(self.start, Bezier::end)
    }

    /// Whether it has come back to where it began.
    pub fn is_closed(&self) -> bool {
        !self.curves.is_empty() && self.end() == self.start
    }

    /// Goes straight to a point.
    pub fn line_to(&mut self, p: V) {
        self.curves.push(Bezier::line(self.end(), p));
    }

    /// Goes to a point, drawn towards another.
    pub fn quadratic_to(&mut self, control: V, p: V) {
        self.curves.push(Bezier::quadratic([self.end(), control, p]));
    }

    /// Goes to a point, drawn towards two others.
    pub fn cubic_to(&mut self, controls: [V; 2], p: V) {
        self.curves.push(Bezier::cubic([self.end(), controls[0], controls[1], p]));
    }

    /// Goes smoothly through points.
    pub fn spline_through(&mut self, points: &[V]) {
        let first = self.end();
        let all: Vec<V> = std::iter::once(first).chain(points.iter().copied()).collect();
        let last = all.len() - 1;
        let tangent = |i: usize| match i {
            0 => all[1] - all[0],
            _ if i == last => all[last] - all[last - 1],
            _ => (all[i + 1] - all[i - 1]) * 0.5,
        };
        for i in 0..last {
            self.hermite(all[i + 1], [tangent(i), tangent(i + 1)]);
        }
    }

    /// Goes straight back to where it began, unless it is there.
    pub fn close(&mut self) {
        if self.end() != self.start {
            self.line_to(self.start);
        }
    }

    /// Goes to a point with these tangents at both ends.
    fn hermite(&mut self, p: V, [m0, m1]: [V; 2]) {
        let third = 1.0 / 3.0;
        self.cubic_to([self.end() + m0 * third, p - m1 * third], p);
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::DVec2;

    use super::*;

    fn curves() -> [Bezier<DVec2>; 3] {
        let [a, b, c, d] = [[0.1, 0.2], [1.0, -0.5], [2.0, 1.5], [0.4, 2.2]].map(DVec2::from_array);
        [Bezier::line(a, b), Bezier::quadratic([a, b, c]), Bezier::cubic([a, b, c, d])]
    }

    #[test]
    fn ends_are_exact_and_derivatives_are_differences() {
        for curve in curves() {
            assert_eq!((curve.at(0.0), curve.at(1.0)), (curve.start(), curve.end()));
            for s in [0.1, 0.5, 0.83] {
                let difference = (curve.at(s + 1e-6) - curve.at(s - 1e-6)) / 2e-6;
                assert!((curve.derivative(s) - difference).length() < 1e-8);
            }
        }
    }

    #[test]
    fn pieces_are_of_the_curve() {
        for curve in curves() {
            let [before, behind] = curve.split(0.3);
            assert_eq!(before.end(), behind.start());
            for s in [0.0, 0.25, 0.7, 1.0] {
                assert!((before.at(s) - curve.at(0.3 * s)).length() < 1e-15);
                assert!((behind.at(s) - curve.at(0.3 + 0.7 * s)).length() < 2e-15);
            }
            assert_eq!(curve.subdivided(3).len(), 8);
        }
    }

    #[test]
    fn splines_go_through_their_points_smoothly() {
        let points = [[0.0, 0.0], [1.0, 0.2], [1.5, 1.0], [0.5, 2.0]].map(DVec2::from_array);
        let mut open = Path::new(points[0]);
        open.spline_through(&points[1..]);
        let closed = Path::closed_spline(&points).unwrap();
        assert_eq!((open.curves().len(), closed.curves().len()), (3, 4));
        assert!(!open.is_closed() && closed.is_closed());
        for path in [&open, &closed] {
            for (pair, p) in path.curves().windows(2).zip(&points[1..]) {
                assert_eq!((pair[0].end(), pair[1].start()), (*p, *p));
                assert!((pair[0].derivative(1.0) - pair[1].derivative(0.0)).length() < 1e-14);
            }
        }
        let seam = closed.curves()[3].derivative(1.0) - closed.curves()[0].derivative(0.0);
        assert!(seam.length() < 1e-14);
        open.close();
        assert!(open.is_closed() && open.curves().len() == 4);
    }
}
