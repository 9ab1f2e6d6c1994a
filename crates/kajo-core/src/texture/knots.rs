//! Functions of one number through given points.

/// What is between two points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The straight line.
    #[default]
    Linear,
    /// The cubic that is level at both.
    Smooth,
    /// The first of both.
    Step,
}

/// A function of one number: `N` numbers at given places, the first before and the last after all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots<const N: usize> {
    /// Places, none less than the one before, each with what stands there.
    knots: Vec<(f32, [f32; N])>,
    interpolation: Interpolation,
}

impl<const N: usize> Knots<N> {
    /// The function; `None` without any place, or where places go back, or numbers are none.
    pub fn new(knots: Vec<(f32, [f32; N])>, interpolation: Interpolation) -> Option<Knots<N>> {
        let is_finite =
            |(at, values): &(f32, [f32; N])| at.is_finite() && values.iter().all(|v| v.is_finite());
        let is_sound =
            !knots.is_empty() && knots.iter().all(is_finite) && knots.is_sorted_by(|a, b| a.0 <= b.0);
        is_sound.then_some(Knots { knots, interpolation })
    }

    /// Places and what stands there.
    pub fn knots(&self) -> &[(f32, [f32; N])] {
        &self.knots
    }

    /// The places, and between two of them those that part what is between into `parts` alike.
    pub(super) fn breakpoints(&self, parts: usize) -> Vec<f32> {
        let between = |pair: &[(f32, [f32; N])]| {
            let (a, b) = (pair[0].0, pair[1].0);
            (0..parts).map(move |i| a + (b - a) * (i as f32 / parts as f32))
        };
        let last = self.knots.last().map(|(at, _)| *at);
        self.knots.windows(2).flat_map(between).chain(last).collect()
    }

    /// The two points around a place and the share of the second; `None` before and after all.
    fn around(&self, t: f32) -> Option<(&[f32; N], &[f32; N], f32, f32)> {
        let after = self.knots.partition_point(|(at, _)| *at <= t);
        let (a, b) = (self.knots.get(after.checked_sub(1)?)?, self.knots.get(after)?);
        Some((&a.1, &b.1, (t - a.0) / (b.0 - a.0), b.0 - a.0))
    }

    /// The function at a place.
    pub fn at(&self, t: f32) -> [f32; N] {
        let Some((a, b, s, _)) = self.around(t) else {
            let [(first, before), .., (_, after)] = &*self.knots else { return self.knots[0].1 };
            return if t < *first { *before } else { *after };
        };
        let s = match self.interpolation {
            Interpolation::Linear => s,
            Interpolation::Smooth => s * s * (3.0 - 2.0 * s),
            Interpolation::Step => 0.0,
        };
        std::array::from_fn(|i| a[i] + s * (b[i] - a[i]))
    }

    /// How it changes with the place.
    pub fn slope(&self, t: f32) -> [f32; N] {
        let Some((a, b, s, length)) = self.around(t) else { return [0.0; N] };
        let rate = match self.interpolation {
            Interpolation::Linear => 1.0,
            Interpolation::Smooth => 6.0 * s * (1.0 - s),
            Interpolation::Step => 0.0,
        };
        std::array::from_fn(|i| rate * (b[i] - a[i]) / length)
    }

    /// Its mean over [0, 1], about.
    pub fn mean(&self) -> [f32; N] {
        const PLACES: usize = 256;
        let values = (0..PLACES).map(|i| self.at((i as f32 + 0.5) / PLACES as f32));
        values.fold([0.0; N], |sum, v| std::array::from_fn(|i| sum[i] + v[i] / PLACES as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(interpolation: Interpolation) -> Knots<1> {
        let knots = vec![(0.25, [1.0]), (0.5, [3.0]), (0.5, [0.0]), (1.0, [2.0])];
        Knots::new(knots, interpolation).unwrap()
    }

    #[test]
    fn functions_go_through_their_points() {
        let values = |interpolation| [-1.0, 0.25, 0.3125, 0.5, 0.75, 2.0].map(|t| of(interpolation).at(t)[0]);
        assert_eq!(values(Interpolation::Linear), [1.0, 1.0, 1.5, 0.0, 1.0, 2.0]);
        assert_eq!(values(Interpolation::Smooth), [1.0, 1.0, 1.3125, 0.0, 1.0, 2.0]);
        assert_eq!(values(Interpolation::Step), [1.0, 1.0, 1.0, 0.0, 0.0, 2.0]);
        let one = Knots::new(vec![(0.5, [7.0])], Interpolation::Linear).unwrap();
        assert_eq!([0.0, 0.5, f32::NAN].map(|t| one.at(t)[0]), [7.0; 3]);
    }

    #[test]
    fn slopes_are_derivatives() {
        for interpolation in [Interpolation::Linear, Interpolation::Smooth, Interpolation::Step] {
            let function = of(interpolation);
            for t in [0.1, 0.3, 0.4, 0.6, 0.9, 1.5] {
                let h = 1e-3;
                let difference = (function.at(t + h)[0] - function.at(t - h)[0]) / (2.0 * h);
                assert!((difference - function.slope(t)[0]).abs() < 2e-3, "{interpolation:?} {t}");
            }
        }
    }

    #[test]
    fn points_that_are_none_are_refused() {
        assert!(Knots::<1>::new(vec![], Interpolation::Linear).is_none());
        assert!(Knots::new(vec![(0.5, [0.0]), (0.25, [1.0])], Interpolation::Linear).is_none());
        assert!(Knots::new(vec![(0.5, [f32::NAN])], Interpolation::Linear).is_none());
        assert!(Knots::new(vec![(f32::INFINITY, [0.0])], Interpolation::Linear).is_none());
    }
}
