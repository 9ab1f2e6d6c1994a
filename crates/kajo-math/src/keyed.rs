//! Numbers that are given at some moments: keys, and the curves between them.
//!
//! Between the keys `k` and `k+1`, a time `h` apart, with values `p` and slopes `m` (for the end of the interval `n`), a
//! cubic is Hermite's
//!
//! ```text
//! p(u) = (2u³ - 3u² + 1) p0 + (u³ - 2u² + u) h m0 + (3u² - 2u³) p1 + (u³ - u²) h n1,     u = (t - t0) / h
//! ```
//!
//! Slopes are those of the parabola through three neighbouring keys (Catmull-Rom splines, for keys that are not equally
//! far apart), or their harmonic means, with which nothing overshoots [Fritsch and Butland 1984], or are given.

use crate::{DQuat, fmath};

/// How numbers go from one key to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Each value holds up to the next key.
    Step,
    /// In straight lines.
    #[default]
    Linear,
    /// Along a Catmull-Rom spline, which may overshoot.
    Cubic,
    /// Along a cubic that stays between the values at its ends.
    Monotone,
}

impl Interpolation {
    /// All of them, with the names that they are asked for by.
    pub const NAMES: [(&'static str, Interpolation); 4] = [
        ("step", Interpolation::Step),
        ("linear", Interpolation::Linear),
        ("cubic", Interpolation::Cubic),
        ("monotone", Interpolation::Monotone),
    ];
}

/// What holds before the first key and after the last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outside {
    /// The first and the last value.
    #[default]
    Hold,
    /// The keys again and again; the moment of the last key is that of the first.
    Loop,
    /// The keys forwards, backwards, forwards and so on.
    PingPong,
}

impl Outside {
    /// All of them, with the names that they are asked for by.
    pub const NAMES: [(&'static str, Outside); 3] =
        [("hold", Outside::Hold), ("loop", Outside::Loop), ("pingpong", Outside::PingPong)];

    /// The time between the first key and the last at which things are as at `time`.
    pub fn within(self, time: f64, [first, last]: [f64; 2]) -> f64 {
        let period = last - first;
        if period <= 0.0 {
            return first;
        }
        match self {
            Outside::Hold => time.clamp(first, last),
            Outside::Loop => first + (time - first).rem_euclid(period),
            Outside::PingPong => {
                let phase = (time - first).rem_euclid(2.0 * period);
                first + if phase > period { 2.0 * period - phase } else { phase }
            }
        }
    }
}

/// Why there is no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyedError {
    /// There is no key.
    Empty,
    /// The key of this number is not later than the one before it, or its time is no number.
    Order(usize),
    /// The key of this number has another count of values than the first, or one that is no number.
    Values(usize),
}

/// Some numbers as functions of the time.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyedNumbers {
    /// Moments, each later than the one before.
    times: Vec<f64>,
    /// For each key its values.
    values: Vec<f64>,
    /// For each value the slopes with which the curve arrives and leaves; empty for curves without.
    slopes: Vec<[f64; 2]>,
    width: usize,
    interpolation: Interpolation,
    outside: Outside,
}

impl KeyedNumbers {
    /// The curves through these keys: times, each with its values.
    ///
    /// # Errors
    /// [`KeyedError`]
    pub fn new(
        keys: &[(f64, Vec<f64>)],
        interpolation: Interpolation,
        outside: Outside,
    ) -> Result<KeyedNumbers, KeyedError> {
        let times: Vec<f64> = keys.iter().map(|key| key.0).collect();
        let width = keys.first().ok_or(KeyedError::Empty)?.1.len();
        let is_key = |values: &[f64]| values.len() == width && values.iter().all(|v| v.is_finite());
        if let Some(i) = (0..keys.len()).find(|&i| !is_key(&keys[i].1)) {
            return Err(KeyedError::Values(i));
        }
        let values = keys.iter().flat_map(|key| key.1.iter().copied()).collect();
        let mut curve = KeyedNumbers { times, values, slopes: Vec::new(), width, interpolation, outside };
        curve.check_order()?;
        if matches!(interpolation, Interpolation::Cubic | Interpolation::Monotone) {
            curve.slopes = curve.natural_slopes();
        }
        Ok(curve)
    }

    /// Cubics with given slopes, held outside of the keys.
    ///
    /// * `width`: values of each key
    /// * `slopes`: for each value, in units of it over time, how the curve arrives at its key and how it leaves
    ///
    /// # Errors
    /// [`KeyedError`]
    pub fn with_slopes(
        times: Vec<f64>,
        width: usize,
        values: Vec<f64>,
        slopes: Vec<[f64; 2]>,
    ) -> Result<KeyedNumbers, KeyedError> {
        if times.is_empty() {
            return Err(KeyedError::Empty);
        }
        let count = times.len() * width;
        if values.len() != count || slopes.len() != count {
            return Err(KeyedError::Values(values.len().min(slopes.len()) / width.max(1)));
        }
        let is_finite = |i: &usize| values[*i].is_finite() && slopes[*i].iter().all(|m| m.is_finite());
        if let Some(i) = (0..count).find(|i| !is_finite(i)) {
            return Err(KeyedError::Values(i / width));
        }
        let (interpolation, outside) = (Interpolation::Cubic, Outside::Hold);
        let curve = KeyedNumbers { times, values, slopes, width, interpolation, outside };
        curve.check_order()?;
        Ok(curve)
    }

    /// How many numbers there are at a time.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The times of the first and the last key.
    pub fn span(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// The numbers at a time.
    pub fn at(&self, time: f64) -> Vec<f64> {
        (0..self.width).map(|c| self.one_at(time, c)).collect()
    }

    /// One of the numbers at a time.
    ///
    /// # Panics
    /// When `c` is not below [`KeyedNumbers::width`].
    pub fn one_at(&self, time: f64, c: usize) -> f64 {
        assert!(c < self.width, "there are {} numbers", self.width);
        let time = self.outside.within(time, self.span());
        let (i, u) = self.segment(time);
        let value = |key: usize| self.values[key * self.width + c];
        if u == 0.0 || self.times.len() == 1 {
            return value(i);
        }
        let (from, to) = (value(i), value(i + 1));
        match self.interpolation {
            Interpolation::Step => {
                if u < 1.0 {
                    from
                } else {
                    to
                }
            }
            Interpolation::Linear => {
                if u < 1.0 {
                    from + u * (to - from)
                } else {
                    to
                }
            }
            Interpolation::Cubic | Interpolation::Monotone => {
                let h = self.times[i + 1] - self.times[i];
                let slopes = [self.slope(i, c)[1] * h, self.slope(i + 1, c)[0] * h];
                let value = hermite([from, to], slopes, u);
                // Rounding does not leave the interval either.
                let is_bounded = self.interpolation == Interpolation::Monotone;
                if is_bounded { value.clamp(from.min(to), from.max(to)) } else { value }
            }
        }
    }

    /// The number of the key at or before a time within the span, and the share of the way from there to the next.
    pub fn segment(&self, time: f64) -> (usize, f64) {
        segment(&self.times, time)
    }

    fn slope(&self, key: usize, c: usize) -> [f64; 2] {
        self.slopes[key * self.width + c]
    }

    fn check_order(&self) -> Result<(), KeyedError> {
        let t = &self.times;
        let in_order = |i: &usize| t[*i].is_finite() && (*i == 0 || t[*i] > t[*i - 1]);
        (0..t.len()).find(|i| !in_order(i)).map_or(Ok(()), |i| Err(KeyedError::Order(i)))
    }

    /// Slopes from the neighbours of each key; where keys repeat and end as they began, those of a closed curve.
    fn natural_slopes(&self) -> Vec<[f64; 2]> {
        let (n, width) = (self.times.len(), self.width);
        let mut slopes = vec![[0.0; 2]; n * width];
        if n < 2 {
            return slopes;
        }
        let steps: Vec<f64> = self.times.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let mean = match self.interpolation {
            Interpolation::Monotone => harmonic_slope,
            _ => parabola_slope,
        };
        for c in 0..width {
            let value = |key: usize| self.values[key * width + c];
            let rise = |i: usize| (value(i + 1) - value(i)) / steps[i];
            let is_closed = self.outside == Outside::Loop && value(0) == value(n - 1);
            for key in 0..n {
                let before = if key > 0 { Some(key - 1) } else { is_closed.then_some(n - 2) };
                let after = if key < n - 1 { Some(key) } else { is_closed.then_some(0) };
                let slope = match (before, after) {
                    (Some(i), Some(j)) => mean([steps[i], steps[j]], [rise(i), rise(j)]),
                    // A curve that turns back at its end has no slope there.
                    _ if self.outside == Outside::PingPong => 0.0,
                    (Some(i), None) | (None, Some(i)) => rise(i),
                    (None, None) => 0.0,
                };
                slopes[key * width + c] = [slope; 2];
            }
        }
        slopes
    }
}

/// The number of the entry of a sorted list at or before `time`, and the share of the way from there to the next.
fn segment(times: &[f64], time: f64) -> (usize, f64) {
    let last = times.len() - 1;
    let i = times.partition_point(|&t| t <= time).clamp(1, last.max(1)) - 1;
    if last == 0 {
        return (0, 0.0);
    }
    (i, ((time - times[i]) / (times[i + 1] - times[i])).clamp(0.0, 1.0))
}

/// The slope at the middle one of three keys of the parabola through them.
fn parabola_slope([h0, h1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    (h1 * d0 + h0 * d1) / (h0 + h1)
}

/// A slope with which a cubic does not overshoot [Fritsch and Butland 1984].
fn harmonic_slope([h0, h1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    if d0 * d1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / d0 + w1 / d1)
}

/// Hermite's cubic at `u` in [0, 1].
///
/// * `slopes`: at its ends, for an interval of length 1
pub fn hermite([p0, p1]: [f64; 2], [m0, m1]: [f64; 2], u: f64) -> f64 {
    let (u2, u3) = (u * u, u * u * u);
    // Exact where the ends are equal and the slopes are 0.
    p0 + (3.0 * u2 - 2.0 * u3) * (p1 - p0) + (u3 - 2.0 * u2 + u) * m0 + (u3 - u2) * m1
}

/// The rotation at a share `u` in [0, 1] of the shorter great circle from `a` to `b` [Shoemake 1985].
///
/// * `a`, `b`: unit quaternions
pub fn slerp(a: DQuat, b: DQuat, u: f64) -> DQuat {
    let dot = a.dot(b);
    let b = if dot < 0.0 { -b } else { b };
    let cos = dot.abs().min(1.0);
    // Nearly parallel: the straight line is as good, and does not divide by nothing.
    let blended = if cos > 1.0 - 1e-9 {
        a * (1.0 - u) + b * u
    } else {
        let angle = fmath::atan2_64((1.0 - cos * cos).sqrt(), cos);
        let sin = fmath::sin64(angle);
        a * (fmath::sin64((1.0 - u) * angle) / sin) + b * (fmath::sin64(u * angle) / sin)
    };
    blended.normalize()
}

#[cfg(test)]
mod tests;
