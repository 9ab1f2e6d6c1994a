//! How the light of a picture is spread over stops.
//!
//! A bin is a quarter of a stop: `bin = 4 (log2 v + 12)`, from 2^-12 to 2^4, for each of red, green and blue.
//! What is darker or brighter is counted in the outermost bins, and black on its own.

use kajo_math::fmath;

/// Number of bins.
pub const BINS: usize = 64;

const BINS_A_STOP: f32 = 4.0;
const DARKEST: f32 = -12.0;

/// Counts of values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Histogram {
    /// For red, green and blue: how many values fall into each bin.
    pub counts: [[u32; BINS]; 3],
    /// How many values are zero or less, or no numbers.
    pub black: [u32; 3],
    /// How many are above one, and so are cut where nothing compresses them.
    pub above_one: [u32; 3],
}

impl Histogram {
    /// Counts every pixel.
    ///
    /// * `light`: linear red, green and blue
    pub fn of<'a>(light: impl Iterator<Item = &'a [f32]>) -> Histogram {
        let mut histogram = Histogram { counts: [[0; BINS]; 3], black: [0; 3], above_one: [0; 3] };
        for pixel in light {
            for (channel, &value) in pixel.iter().take(3).enumerate() {
                histogram.count(channel, value);
            }
        }
        histogram
    }

    fn count(&mut self, channel: usize, value: f32) {
        if value.is_nan() || value <= 0.0 {
            self.black[channel] += 1;
            return;
        }
        self.above_one[channel] += u32::from(value > 1.0);
        self.counts[channel][bin(value)] += 1;
    }

    /// The largest count of a bin, and at least 1.
    pub fn peak(&self) -> u32 {
        self.counts.iter().flatten().copied().max().unwrap_or(0).max(1)
    }
}

/// Where the values of a bin begin, in stops above one.
pub fn stops_of(bin: usize) -> f32 {
    bin as f32 / BINS_A_STOP + DARKEST
}

/// The bin of a positive value.
fn bin(value: f32) -> usize {
    let place = BINS_A_STOP * ((fmath::ln(value) / std::f32::consts::LN_2) - DARKEST);
    // A cast from float cuts off, and stops at the ends.
    (place.max(0.0) as usize).min(BINS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_fall_into_their_stops() {
        for (value, stops) in [(1.0, 0.0), (0.5, -1.0), (0.25, -2.0), (2.0, 1.0), (1.0 / 4096.0, -12.0)] {
            assert_eq!(stops_of(bin(value)), stops, "{value}");
        }
        assert_eq!((bin(1e-20), bin(1e20), bin(f32::INFINITY)), (0, BINS - 1, BINS - 1));
        assert_eq!(bin(1.18), bin(1.0));
        assert_eq!(bin(1.20), bin(1.0) + 1);
    }

    #[test]
    fn every_value_is_counted_once() {
        let pixels = [[0.0, 0.5, 2.0], [f32::NAN, 0.5, 1.0], [-1.0, 0.3, 1.5]];
        let histogram = Histogram::of(pixels.iter().map(|pixel| &pixel[..]));
        for channel in 0..3 {
            let counted: u32 = histogram.counts[channel].iter().sum();
            assert_eq!(counted + histogram.black[channel], 3);
        }
        assert_eq!((histogram.black, histogram.above_one), ([3, 0, 0], [0, 0, 2]));
        assert_eq!(histogram.counts[1][bin(0.5)], 2);
        assert_eq!(histogram.peak(), 2);
        assert_eq!(Histogram::of(std::iter::empty()).peak(), 1);
    }
}
