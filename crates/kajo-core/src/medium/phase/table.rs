//! A phase function by numbers, as it was measured or computed: values at some cosines of the angle by which light is turned,
//! joined by straight lines over the cosine.
//!
//! ```text
//! p(c) = p_i + (p_(i+1) - p_i) (c - c_i) / (c_(i+1) - c_i),      2π ∫ p(c) dc = 1
//! ```
//!
//! The values are divided by their integral, so that any unit will do. The share of directions below a cosine is of the second
//! degree between two entries, and is inverted exactly: with `r` the share of the piece that lies below
//!
//! ```text
//! c = c_i + (c_(i+1) - c_i) r (p_i + p_(i+1)) / (p_i + sqrt(p_i² + r (p_(i+1)² - p_i²)))
//! ```

use std::f64::consts::{PI, TAU};

use kajo_math::fmath;

use super::PhaseTableError;

/// What the first number of an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseAngle {
    /// The angle by which light is turned in degrees, from 0 (straight on) to 180 (back).
    Degrees,
    /// Its cosine, from -1 (back) to 1 (straight on).
    Cosine,
}

/// Values at increasing cosines.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseTable {
    /// From -1 to 1; two of them may be the same after rounding.
    cos: Vec<f32>,
    /// Per solid angle, not negative.
    value: Vec<f32>,
    /// The share of directions below each of the cosines, from 0 to 1.
    below: Vec<f32>,
    mean_cosine: f32,
}

impl PhaseTable {
    /// The function through pairs of an angle and a value. Beyond the first and the last it is as it is there.
    ///
    /// * `pairs`: of increasing angles, or of increasing cosines
    ///
    /// # Errors
    /// [`PhaseTableError`].
    pub fn new(pairs: &[(f32, f32)], angle: PhaseAngle) -> Result<PhaseTable, PhaseTableError> {
        if pairs.len() < 2 {
            return Err(PhaseTableError::TooFew { rows: pairs.len(), columns: 1 });
        }
        for (i, &(at, value)) in pairs.iter().enumerate() {
            match angle {
                PhaseAngle::Degrees if !(0.0..=180.0).contains(&at) => {
                    return Err(PhaseTableError::Angle(i + 1));
                }
                PhaseAngle::Cosine if !(-1.0..=1.0).contains(&at) => {
                    return Err(PhaseTableError::Cosine(i + 1));
                }
                _ if i > 0 && at <= pairs[i - 1].0 => return Err(PhaseTableError::Order(i + 1)),
                _ if !(value.is_finite() && value >= 0.0) => {
                    return Err(PhaseTableError::Value { row: i + 1, column: 0 });
                }
                _ => {}
            }
        }
        let mut points: Vec<(f32, f64)> =
            pairs.iter().map(|&(at, value)| (cosine(at, angle), f64::from(value))).collect();
        if angle == PhaseAngle::Degrees {
            points.reverse();
        }
        let (first, last) = (points[0], points[points.len() - 1]);
        if first.0 > -1.0 {
            points.insert(0, (-1.0, first.1));
        }
        if last.0 < 1.0 {
            points.push((1.0, last.1));
        }
        normalized(&points).ok_or(PhaseTableError::Black(0))
    }

    /// The mean cosine.
    pub fn mean_cosine(&self) -> f32 {
        self.mean_cosine
    }

    /// The value for the cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        self.value_at(self.locate(cos))
    }

    /// The piece that a cosine lies in, and its share of that, for all tables of the same cosines.
    #[inline]
    pub(super) fn locate(&self, cos: f32) -> (usize, f32) {
        let last = self.cos.len() - 1;
        let i = self.cos.partition_point(|&c| c <= cos).clamp(1, last);
        let width = self.cos[i] - self.cos[i - 1];
        let share = if width > 0.0 { ((cos - self.cos[i - 1]) / width).clamp(0.0, 1.0) } else { 0.0 };
        (i, share)
    }

    /// The value at a place that [`PhaseTable::locate`] found.
    #[inline]
    pub(super) fn value_at(&self, (i, share): (usize, f32)) -> f32 {
        self.value[i - 1] + share * (self.value[i] - self.value[i - 1])
    }

    /// The same cosines with the values that `f` gives to each by its number; `None` where all of them are 0.
    pub(super) fn revalued(&self, f: impl Fn(usize) -> f32) -> Option<PhaseTable> {
        let points = self.cos.iter().enumerate().map(|(i, &cos)| (cos, f64::from(f(i))));
        normalized(&points.collect::<Vec<_>>())
    }

    /// The values, per solid angle, at increasing cosines.
    pub(super) fn values(&self) -> &[f32] {
        &self.value
    }

    /// A cosine for `u` in [0, 1), which grows with it.
    pub fn sample(&self, u: f32) -> f32 {
        let last = self.cos.len() - 1;
        let i = self.below.partition_point(|&below| below <= u).clamp(1, last);
        let piece = self.below[i] - self.below[i - 1];
        let r = if piece > 0.0 { ((u - self.below[i - 1]) / piece).clamp(0.0, 1.0) } else { 0.0 };
        let [a, b] = [self.value[i - 1], self.value[i]];
        let root = a + (a * a + r * (b * b - a * a)).max(0.0).sqrt();
        let share = if root > 0.0 { r * (a + b) / root } else { r };
        self.cos[i - 1] + share.min(1.0) * (self.cos[i] - self.cos[i - 1])
    }
}

/// The cosine of an angle as it was written.
fn cosine(at: f32, angle: PhaseAngle) -> f32 {
    match angle {
        PhaseAngle::Cosine => at,
        PhaseAngle::Degrees => fmath::cos64(f64::from(at) * (PI / 180.0)) as f32,
    }
}

/// The table through points of increasing cosines; `None` where all values are 0.
fn normalized(points: &[(f32, f64)]) -> Option<PhaseTable> {
    let (mut sum, mut moment) = (0.0, 0.0);
    let mut sums = vec![0.0];
    for pair in points.windows(2) {
        let [(c0, a), (c1, b)] = [pair[0], pair[1]].map(|(cos, value)| (f64::from(cos), value));
        let width = c1 - c0;
        sum += 0.5 * width * (a + b);
        moment += width * (c0 * (a + b) * 0.5 + width * (a + 2.0 * b) / 6.0);
        sums.push(sum);
    }
    // Values may be so small that their integral is no normal number, or so large that it is not finite.
    let scale = 1.0 / (TAU * sum);
    let value: Vec<f32> = points.iter().map(|&(_, value)| (value * scale) as f32).collect();
    if !(sum > 0.0 && value.iter().all(|value| value.is_finite())) {
        return None;
    }
    Some(PhaseTable {
        cos: points.iter().map(|&(cos, _)| cos).collect(),
        value,
        below: sums.iter().map(|below| (below / sum) as f32).collect(),
        mean_cosine: (moment / sum) as f32,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(pairs: &[(f32, f32)]) -> Result<PhaseTable, PhaseTableError> {
        PhaseTable::new(pairs, PhaseAngle::Degrees)
    }

    fn cosines(pairs: &[(f32, f32)]) -> Result<PhaseTable, PhaseTableError> {
        PhaseTable::new(pairs, PhaseAngle::Cosine)
    }

    #[test]
    fn values_are_joined_by_lines_and_normalised() {
        // 2π times the integral of 1 + c is 4π.
        let line = cosines(&[(-1.0, 0.0), (1.0, 6.0)]).unwrap();
        for cos in [-1.0f32, -0.3, 0.0, 0.9, 1.0] {
            assert!((f64::from(line.at(cos)) - (1.0 + f64::from(cos)) / (4.0 * PI)).abs() < 1e-7);
        }
        assert!((line.mean_cosine() - 1.0 / 3.0).abs() < 1e-6);
        // Its distribution is (1 + c)²/4.
        for u in [0.0f32, 0.2, 0.5, 0.99] {
            assert!((line.sample(u) - (2.0 * u.sqrt() - 1.0)).abs() < 1e-6, "{u}");
        }
        let same = degrees(&[(0.0, 6.0), (180.0, 0.0)]).unwrap();
        assert_eq!(same, line);
    }

    #[test]
    fn beyond_its_ends_it_is_as_it_is_there() {
        let short = cosines(&[(-0.5, 1.0), (0.5, 3.0)]).unwrap();
        assert_eq!(short, cosines(&[(-1.0, 1.0), (-0.5, 1.0), (0.5, 3.0), (1.0, 3.0)]).unwrap());
        let flat = degrees(&[(10.0, 2.0), (20.0, 2.0)]).unwrap();
        assert!((f64::from(flat.at(-0.7)) - 0.25 / PI).abs() < 1e-7);
    }

    /// Angles may be so near to 0 that their cosines are the same number.
    #[test]
    fn angles_near_zero_may_have_the_same_cosine() {
        let pairs = [(0.0, 1e6), (0.001, 1e5), (0.002, 10.0), (90.0, 1.0), (180.0, 1.0)];
        let peak = degrees(&pairs).unwrap();
        for i in 0..1000 {
            let cos = peak.sample(i as f32 / 1000.0);
            assert!((-1.0..=1.0).contains(&cos) && peak.at(cos) > 0.0, "{i}: {cos}");
        }
        assert!(peak.at(1.0).is_finite());
    }

    #[test]
    fn where_a_value_is_zero_no_light_goes() {
        let gap = cosines(&[(-1.0, 1.0), (-0.5, 0.0), (0.5, 0.0), (1.0, 1.0)]).unwrap();
        for i in 0..1000 {
            let cos = gap.sample(i as f32 / 1000.0);
            assert!(cos.abs() >= 0.5, "{i}: {cos}");
        }
    }

    #[test]
    fn what_is_no_phase_function_is_refused() {
        assert_eq!(degrees(&[]), Err(PhaseTableError::TooFew { rows: 0, columns: 1 }));
        assert_eq!(degrees(&[(0.0, 1.0)]), Err(PhaseTableError::TooFew { rows: 1, columns: 1 }));
        assert_eq!(degrees(&[(0.0, 1.0), (181.0, 1.0)]), Err(PhaseTableError::Angle(2)));
        assert_eq!(cosines(&[(-1.5, 1.0), (1.0, 1.0)]), Err(PhaseTableError::Cosine(1)));
        assert_eq!(cosines(&[(f32::NAN, 1.0), (1.0, 1.0)]), Err(PhaseTableError::Cosine(1)));
        assert_eq!(degrees(&[(90.0, 1.0), (0.0, 1.0)]), Err(PhaseTableError::Order(2)));
        assert_eq!(cosines(&[(0.0, 1.0), (0.0, 2.0)]), Err(PhaseTableError::Order(2)));
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(
                degrees(&[(0.0, 1.0), (90.0, value)]),
                Err(PhaseTableError::Value { row: 2, column: 0 })
            );
        }
        assert_eq!(degrees(&[(0.0, 0.0), (180.0, 0.0)]), Err(PhaseTableError::Black(0)));
    }
}
