//! Wall clock and processor time, and the spread of repeated measurements.

use std::time::Instant;

use cpu_time::ProcessTime;

/// The middle and the ends of repeated measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The median; of an even number of values the greater of the middle two.
    pub median: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// The spread of some values; zeros when there are none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Spread {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        match (values.first(), values.get(values.len() / 2), values.last()) {
            (Some(&min), Some(&median), Some(&max)) => Spread { median, min, max },
            _ => Spread::default(),
        }
    }
}

/// Seconds that something took each time it was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// By the clock on the wall.
    pub wall: Spread,
    /// By processor time, all threads added up.
    pub cpu: Spread,
}

/// One measurement, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Seconds {
    pub wall: f64,
    /// Of the whole process.
    pub cpu: f64,
}

impl Times {
    pub(super) fn of(measured: &[Seconds]) -> Times {
        Times {
            wall: Spread::of(measured.iter().map(|seconds| seconds.wall)),
            cpu: Spread::of(measured.iter().map(|seconds| seconds.cpu)),
        }
    }
}

/// Does `work` and says how long it took.
pub(super) fn timed<R>(work: impl FnOnce() -> R) -> (R, Seconds) {
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    let result = work();
    (result, Seconds { wall: wall.elapsed().as_secs_f64(), cpu: cpu.elapsed().as_secs_f64() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_the_median_and_the_ends() {
        assert_eq!(Spread::of([3.0, 1.0, 2.0]), Spread { median: 2.0, min: 1.0, max: 3.0 });
        assert_eq!(Spread::of([4.0, 1.0]), Spread { median: 4.0, min: 1.0, max: 4.0 });
        assert_eq!(Spread::of([]), Spread::default());
    }

    #[test]
    fn both_clocks_run() {
        let (sum, seconds) =
            timed(|| (0..3_000_000u64).fold(1u64, |s, i| s.wrapping_mul(3).rotate_left((i % 7) as u32)));
        assert_ne!(sum, 0);
        assert!(seconds.wall > 0.0 && seconds.cpu > 0.0, "{seconds:?}");
        let times = Times::of(&[seconds, Seconds { wall: 1e9, cpu: 1e9 }]);
        assert_eq!((times.wall.min, times.cpu.max), (seconds.wall, 1e9));
    }
}
