//! A limit on what a single sample brings, against fireflies, and the light that it takes away.
//!
//! With the radiance `L` of a sample and the part `S` of it that emitters send straight to the camera, or by way of
//! smooth mirrors and glass alone, what counts is
//!
//! ```text
//! S + (L - S) min(1, c / max |L - S|)
//! ```
//!
//! where the maximum is that of the three channels: the hue stays, and what is seen of emitters is no noise. A splat is
//! limited as a whole. A picture made so is too dark where light comes rarely and much at once; by how much is known,
//! since what is taken is summed. The sums are exact, and so do not depend on the order of samples.

use std::io::{self, Read};

use super::fixed::{self, Term, Weight};
use super::numbers::{bytes, restore_array, save_numbers};
use crate::{Auxiliary, PixelSample};

/// What a limit has taken from the samples and splats of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedLight {
    /// The most that a sample may bring.
    pub limit: f32,
    /// Samples and splats that were limited.
    pub count: u64,
    /// The share of all light that was taken of red, green and blue, from 0 to 1; 0 where there is none.
    pub taken: [f64; 3],
}

/// Exact sums of the light before the limit, and of what it took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct ClampSums {
    count: u64,
    all: [i128; 3],
    taken: [i128; 3],
}

impl ClampSums {
    /// The sample that counts in place of another, with its shares of groups of lights.
    ///
    /// * `limit`: `c`, above zero
    pub fn limit_sample(
        &mut self,
        limit: f32,
        sample: &PixelSample,
        aux: &Auxiliary,
    ) -> (PixelSample, Auxiliary) {
        let (mut sample, mut aux) = (*sample, *aux);
        let before = sample.radiance;
        sample.radiance = self.limited(limit, before, aux.seen);
        if sample.radiance != before {
            let kept = [0, 1, 2].map(|c| if before[c] == 0.0 { 1.0 } else { sample.radiance[c] / before[c] });
            for light in &mut aux.lights {
                *light = [0, 1, 2].map(|c| light[c] * kept[c]);
            }
        }
        (sample, aux)
    }

    /// What counts in place of a radiance; what is no finite number stays as it is.
    ///
    /// * `seen`: the part of it that is not limited
    pub fn limited(&mut self, limit: f32, radiance: [f32; 3], seen: [f32; 3]) -> [f32; 3] {
        let scattered = [0, 1, 2].map(|c| radiance[c] - seen[c]);
        let largest = scattered.iter().fold(0.0, |largest: f32, value| largest.max(value.abs()));
        if !largest.is_finite() || radiance.iter().any(|value| !value.is_finite()) {
            return radiance;
        }
        add(&mut self.all, radiance);
        if largest <= limit {
            return radiance;
        }
        let factor = limit / largest;
        let kept = [0, 1, 2].map(|c| seen[c] + scattered[c] * factor);
        self.count += 1;
        add(&mut self.taken, [0, 1, 2].map(|c| radiance[c] - kept[c]));
        kept
    }

    /// Adds the sums of other samples.
    pub fn absorb(&mut self, more: &ClampSums) {
        self.count = self.count.saturating_add(more.count);
        for c in 0..3 {
            self.all[c] = self.all[c].saturating_add(more.all[c]);
            self.taken[c] = self.taken[c].saturating_add(more.taken[c]);
        }
    }

    /// What was taken by a limit.
    pub fn light(&self, limit: f32) -> ClampedLight {
        let share = |c: usize| match self.all[c] {
            0 => 0.0,
            all => fixed::mean(self.taken[c], 1.0) / fixed::mean(all, 1.0),
        };
        ClampedLight { limit, count: self.count, taken: [0, 1, 2].map(share) }
    }

    /// Writes the sums.
    pub fn save(&self, out: &mut Vec<u8>) {
        out.extend(self.count.to_le_bytes());
        save_numbers([self.all, self.taken].as_flattened().iter().copied(), out);
    }

    /// Reads what [`ClampSums::save`] wrote.
    pub fn restore(input: &mut dyn Read) -> io::Result<ClampSums> {
        let count = u64::from_le_bytes(bytes(input)?);
        let mut sums = [[0; 3]; 2];
        restore_array(sums.as_flattened_mut(), input)?;
        let [all, taken] = sums;
        Ok(ClampSums { count, all, taken })
    }
}

fn add(sums: &mut [i128; 3], light: [f32; 3]) {
    for (sum, value) in sums.iter_mut().zip(light) {
        *sum = sum.saturating_add(Term::new(value).unwrap_or(Term::ZERO).times(Weight::ONE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limited(limit: f32, radiance: [f32; 3], seen: [f32; 3]) -> ([f32; 3], ClampedLight) {
        let mut sums = ClampSums::default();
        let kept = sums.limited(limit, radiance, seen);
        (kept, sums.light(limit))
    }

    #[test]
    fn what_is_above_the_limit_keeps_its_hue() {
        assert_eq!(
            limited(4.0, [2.0, 8.0, 1.0], [0.0; 3]),
            ([1.0, 4.0, 0.5], ClampedLight { limit: 4.0, count: 1, taken: [0.5; 3] })
        );
        let untouched = ClampedLight { limit: 8.0, count: 0, taken: [0.0; 3] };
        assert_eq!(limited(8.0, [2.0, 8.0, 1.0], [0.0; 3]), ([2.0, 8.0, 1.0], untouched));
        // Colours outside of the gamut count by their magnitude.
        assert_eq!(limited(4.0, [2.0, -8.0, 0.0], [0.0; 3]).0, [1.0, -4.0, 0.0]);
    }

    #[test]
    fn what_is_seen_of_emitters_is_not_limited() {
        let (kept, light) = limited(2.0, [104.0, 52.0, 0.0], [100.0, 50.0, 0.0]);
        assert_eq!((kept, light.count), ([102.0, 51.0, 0.0], 1));
        assert_eq!(light.taken, [2.0 / 104.0, 1.0 / 52.0, 0.0]);
        assert_eq!(limited(2.0, [1e6; 3], [1e6; 3]).0, [1e6; 3]);
    }

    #[test]
    fn what_is_no_number_is_left_to_the_film() {
        for radiance in [[f32::NAN, 1.0, 2.0], [1.0, f32::INFINITY, 9.0]] {
            let (kept, light) = limited(2.0, radiance, [0.0; 3]);
            assert_eq!(kept.map(f32::to_bits), radiance.map(f32::to_bits));
            assert_eq!((light.count, light.taken), (0, [0.0; 3]));
        }
    }

    #[test]
    fn groups_of_lights_still_add_up_to_the_sample() {
        let mut aux = Auxiliary { seen: [10.0, 0.0, 0.0], ..Auxiliary::default() };
        aux.lights[0] = [10.0, 0.0, 0.0];
        aux.lights[3] = [30.0, 8.0, 0.0];
        let sample = PixelSample { radiance: [40.0, 8.0, 0.0], first: None };
        let (sample, aux) = ClampSums::default().limit_sample(3.0, &sample, &aux);
        assert_eq!(sample.radiance[0], 13.0);
        for c in 0..3 {
            let sum: f32 = aux.lights.iter().map(|light| light[c]).sum();
            assert!((sum - sample.radiance[c]).abs() < 1e-6, "{sum} {:?}", sample.radiance);
        }
    }

    #[test]
    fn sums_can_be_added_and_kept() {
        let mut sums = [ClampSums::default(); 3];
        for (i, radiance) in [[5.0, 1.0, 0.0], [0.5, 0.1, 0.0], [1e9, 2.0, 1.0]].into_iter().enumerate() {
            sums[i % 2].limited(1.0, radiance, [0.0; 3]);
            sums[2].limited(1.0, radiance, [0.0; 3]);
        }
        let [mut sum, other, whole] = sums;
        sum.absorb(&other);
        assert_eq!(sum, whole);
        let mut kept = Vec::new();
        whole.save(&mut kept);
        let mut input = kept.as_slice();
        assert_eq!(ClampSums::restore(&mut input).unwrap(), whole);
        assert!(input.is_empty() && ClampSums::restore(&mut &kept[..9]).is_err());
    }
}
