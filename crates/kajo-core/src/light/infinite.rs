//! The choice among lights infinitely far away, and between them and all others.
//!
//! What they send to a receiver is known but for what is in the way, which may be everything: in a room the sun is the
//! strongest light by far and not seen. So the background, all directional lights together, and the tree of lights that have a
//! position are chosen in proportion to the roots of the irradiances that they are estimated to make at the receiver; so are directional
//! lights among themselves. Of two lights whose irradiances have the ratio `r` the variance is then at most an eighth larger than
//! with choices in proportion where both are seen, and where the stronger one is hidden it grows by the factor `1 + sqrt r`, not
//! `1 + r`.
//!
//! What of a background is the same from everywhere is found by scattering as well as by drawing directions: beside scattering what is above the mean
//! of all directions counts. A background of one colour is not drawn then: under a sky alone the squared error is the same without, with half of the
//! rays, and under a sun of twice its irradiance the variance of a dense cloud is smaller the less it is drawn.

use super::SampledLight;
use super::tree::FirstStep;
use super::visibility::Mixture;
use crate::ids::LightIndex;

/// Factors of the weights of the background, of directional lights and of the tree that leave them as they are.
pub(super) const ALIKE: [f32; 3] = [1.0; 3];

/// What the root of a background that is not the same everywhere counts at least beside scattering.
const LEAST_BACKGROUND: f32 = 0.1;

/// Lights infinitely far away.
#[derive(Debug, Default)]
pub(super) struct InfiniteLights {
    background: Option<LightIndex>,
    /// The others, in the order of their indices.
    directional: Vec<LightIndex>,
    /// For each of them the share of their roots up to it.
    upto: Vec<f32>,
    /// The roots of the irradiances of the background and of all others.
    weights: [f32; 2],
    /// Factors of the weights of the background, of directional lights and of the tree where scattering finds light too.
    beside_scattering: [f32; 3],
}

impl InfiniteLights {
    /// * `lights`: with estimates of their irradiance, in the order of their indices
    /// * `unevenness`: of the background
    pub fn new(
        lights: impl Iterator<Item = (LightIndex, f32)>,
        background: Option<LightIndex>,
        unevenness: f32,
    ) -> InfiniteLights {
        let (mut of_background, mut sum, mut roots) = (0.0, 0.0, 0.0);
        let (mut directional, mut upto) = (Vec::new(), Vec::<f64>::new());
        for (light, irradiance) in lights {
            // Colours may have no luminance and be light all the same.
            let irradiance = f64::from(irradiance).clamp(1e-30, 1e30);
            if Some(light) == background {
                of_background = irradiance;
            } else {
                (sum, roots) = (sum + irradiance, roots + irradiance.sqrt());
                directional.push(light);
                upto.push(roots);
            }
        }
        let upto = upto.iter().map(|root| (root / roots) as f32).collect();
        let weights = [of_background, sum].map(|irradiance| irradiance.sqrt() as f32);
        let of_sky = if unevenness > 0.0 { unevenness.sqrt().max(LEAST_BACKGROUND) } else { 0.0 };
        let beside_scattering = [of_sky, 1.0, 1.0];
        InfiniteLights { background, directional, upto, weights, beside_scattering }
    }

    fn len(&self) -> usize {
        self.directional.len() + usize::from(self.background.is_some())
    }

    /// Whether a light is the background.
    pub fn is_background(&self, light: LightIndex) -> bool {
        Some(light) == self.background
    }

    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.directional) + size_of_val(&*self.upto)
    }

    /// Factors of the weights of the three parts where scattering finds light too.
    pub fn beside_scattering(&self) -> [f32; 3] {
        self.beside_scattering
    }

    /// The probability that one of a tree is chosen for a receiver, and not one of these.
    ///
    /// * `factors`: of the weights of the background, of directional lights and of the tree
    #[inline]
    pub fn share_of_tree(&self, step: &FirstStep, factors: [f32; 3]) -> f32 {
        let weight = self.weights[0] * factors[0] + self.weights[1] * factors[1];
        if weight == 0.0 {
            return 1.0;
        }
        match step.irradiance() {
            Some(irradiance) => {
                let tree = irradiance.sqrt() * factors[2];
                tree / (tree + weight)
            }
            None => 1.0 / (self.len() + 1) as f32,
        }
    }

    /// Chooses one of these; `None` where there are none.
    ///
    /// * `u`: uniform in [0, 1)
    /// * `factors`: as for [`InfiniteLights::share_of_tree`]
    #[inline]
    pub fn sample(&self, u: f32, factors: [f32; 3]) -> Option<SampledLight> {
        let share = self.share_of_background(factors);
        if let Some(background) = self.background
            && u < share
        {
            return Some(SampledLight::new(background, share, u / share));
        }
        self.sample_directional((u - share) / (1.0 - share), 1.0 - share)
    }

    /// As [`InfiniteLights::sample`], by a mixture with what is known to arrive.
    ///
    /// * `factors`: as for [`InfiniteLights::share_of_tree`], by importance, and by what is known to arrive too
    pub fn sample_learned(&self, u: f32, factors: [[f32; 3]; 2], mixture: Mixture) -> Option<SampledLight> {
        let (is_background, mixture, u) = mixture.step(self.shares_of_background(factors), u);
        match self.background {
            Some(background) if is_background => {
                Some(SampledLight::new(background, mixture.probability(), u))
            }
            _ => self.sample_directional(u, mixture.probability()),
        }
    }

    /// Probability with which [`InfiniteLights::sample_learned`] chooses a light; 0 for one that is not among these.
    pub fn pmf_learned(&self, light: LightIndex, factors: [[f32; 3]; 2], mixture: Mixture) -> f32 {
        let shares = self.shares_of_background(factors);
        if Some(light) == self.background {
            return mixture.after(shares).probability();
        }
        let i = self.directional.binary_search(&light);
        let mixture = mixture.after(shares.map(|share| 1.0 - share));
        i.map_or(0.0, |i| mixture.probability() * self.probability(i))
    }

    /// Chooses one of the directional lights.
    ///
    /// * `among`: the probability that it is one of them
    #[inline]
    fn sample_directional(&self, u: f32, among: f32) -> Option<SampledLight> {
        let i = self.upto.partition_point(|&upto| upto <= u).min(self.upto.len().checked_sub(1)?);
        let probability = self.probability(i);
        let rest = (u - self.before(i)) / probability;
        Some(SampledLight::new(self.directional[i], among * probability, rest))
    }

    /// Probability with which [`InfiniteLights::sample`] chooses a light; 0 for one that is not among these.
    #[inline]
    pub fn pmf(&self, light: LightIndex, factors: [f32; 3]) -> f32 {
        let share = self.share_of_background(factors);
        if Some(light) == self.background {
            return share;
        }
        let i = self.directional.binary_search(&light);
        i.map_or(0.0, |i| (1.0 - share) * self.probability(i))
    }

    /// By importance, and by what is known to arrive too.
    fn shares_of_background(&self, factors: [[f32; 3]; 2]) -> [f32; 2] {
        factors.map(|factors| self.share_of_background(factors))
    }

    fn share_of_background(&self, factors: [f32; 3]) -> f32 {
        let [background, directional] = [0, 1].map(|i| self.weights[i] * factors[i]);
        if background > 0.0 { background / (background + directional) } else { 0.0 }
    }

    /// The probability of the directional lights before one of them.
    fn before(&self, i: usize) -> f32 {
        i.checked_sub(1).map_or(0.0, |i| self.upto[i])
    }

    /// The probability of one among the directional lights.
    fn probability(&self, i: usize) -> f32 {
        self.upto[i] - self.before(i)
    }
}
