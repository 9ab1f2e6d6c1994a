//! The choice of the light that a path begins at, in proportion to power:
//!
//! ```text
//! P(i) = Φ_i / sum over j of Φ_j
//! ```
//!
//! with the luminous power `Φ` of each light; that of a light infinitely far away is what reaches the bounding sphere of the scene. Light that starts
//! at light `i`, drawn by its `sample_le` with the densities of `pdf_le`, counts over `P(i)` times these, so the sum
//! over all lights of the light that leaves them is estimated by one of them. A light of power zero is never chosen;
//! neither is one that stands in another inertial frame.

use kajo_math::Aabb;

use super::{BoundingSphere, LightSampler, Lights, SampledLight};
use crate::ids::LightIndex;

/// Chooses lights with probabilities in proportion to their power.
#[derive(Debug)]
pub struct PowerLightSampler {
    world: BoundingSphere,
    /// Sums of the powers of all lights up to each.
    sums: Vec<f32>,
}

impl PowerLightSampler {
    /// * `bounds`: of everything that has any
    pub fn new(sampler: &LightSampler, lights: &Lights, bounds: &Aabb) -> PowerLightSampler {
        let world = BoundingSphere::around(bounds);
        let all = LightIndex::all(sampler.list().len());
        let power =
            |light| if sampler.is_here(light) { lights.power(sampler.id(light), &world) } else { 0.0 };
        let powers = all.map(|light| f64::from(power(light)));
        let sums = powers.scan(0.0, |sum: &mut f64, power| {
            *sum += if power.is_finite() { power.max(0.0) } else { 0.0 };
            Some(*sum as f32)
        });
        PowerLightSampler { world, sums: sums.collect() }
    }

    /// The sphere that lights infinitely far away shine at.
    pub fn world(&self) -> &BoundingSphere {
        &self.world
    }

    /// Chooses a light for a uniform `u` in [0, 1); `None` when none gives light.
    pub fn sample(&self, u: f32) -> Option<SampledLight> {
        let all = *self.sums.last()?;
        let light = LightIndex::new(self.sums.partition_point(|&sum| sum <= u * all))?;
        if light.index() >= self.sums.len() {
            return None;
        }
        let probability = self.pmf(light);
        let before = light.index().checked_sub(1).map_or(0.0, |i| self.sums[i] / all);
        Some(SampledLight::new(light, probability, (u - before) / probability))
    }

    /// Probability with which [`PowerLightSampler::sample`] chooses a light.
    pub fn pmf(&self, light: LightIndex) -> f32 {
        let i = light.index();
        let before = i.checked_sub(1).map_or(0.0, |i| self.sums[i]);
        self.sums.last().map_or(0.0, |&all| if all > 0.0 { (self.sums[i] - before) / all } else { 0.0 })
    }
}
