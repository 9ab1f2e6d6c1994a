//! Metropolis light transport in primary sample space [Kelemen et al. 2002].
//!
//! A sample of another integrator is a function `F(u)` of its uniform numbers `u`, a list of lights at positions of the picture. Markov
//! chains move `u` so that it is met in proportion to the importance `I(u)`, the mean over the channels of the sum of that light: a
//! path that brings much is changed a little and tried again. With `b`, the integral of `I`, estimated by independent samples, a
//! chain of `M` mutations from `u` to the proposal `v`, accepted with the probability `a = min(1, I(v)/I(u))`, adds
//!
//! ```text
//! (a + s) / (I(v)/b + p) F(v) / M   +   (1 - a) / (I(u)/b + p) F(u) / M          [Kelemen et al. 2002, eq. 13]
//! ```
//!
//! where `s` is 1 for a large step, which draws all numbers anew and is made with the probability `p`, and 0 for a small one: large steps
//! are samples of plain integration too, and are weighed with the chain's. A small step moves each number by a distance
//! between `s1 = 1/1024` and `s2 = 1/64`, small ones as likely as large ones by their logarithm,
//!
//! ```text
//! v = u +- s2 exp(-ln(s2/s1) x),   x uniform in [0, 1),   around the torus
//! ```
//!
//! so that proposals are symmetric. Numbers beyond those that a chain keeps are independent in each proposal.
//!
//! Each chain begins at a sample drawn in proportion to `I` of those that `b` was estimated by, so that it is where it would be after any
//! number of mutations; no beginning has to be thrown away [Veach 1997, 11.3.1]. So chains may be short and many: one for each
//! block of pixels and each sample of theirs, with a mutation for each pixel. It depends on the seed, the block and the
//! sample alone, and its light goes to exact sums, so no split of the work changes a bit. Where its states have their
//! light is counted too, to tell whether groups of chains agree; see [`ChainCounts`](crate::ChainCounts).

mod allotment;
mod chain;
mod mutated;
mod settings;
mod start;

use std::num::NonZeroU32;

use kajo_core::camera::Camera;
use kajo_core::scene::Scene;
use kajo_math::Vec2;

use super::bidir::{Bidirectional, WithMedia};
use super::path::{ManifoldPath, Path};
use super::{Integrator, bidir::BidirectionalSettings};
use crate::trail::PathObserver;
use crate::{Layer, LayerSet, PixelIntegrator, PixelSample, RayCounters, Rect, SampleContext};
use crate::{SamplesPerState, Setup, SetupError, WithState};
use chain::{Chain, Evaluation};
use mutated::Mutated;
pub use settings::{METROPOLIS, MULTIPLEXED, MetropolisSettings, MutatedSamples};
use start::Starts;

/// Side of the block of pixels that shares a chain.
const BLOCK: u32 = 32;

/// Mutations for which the same start samples serve, but for those of one sample of the picture: enough that a million
/// start samples cost little beside them.
const MUTATIONS_OF_PART: u32 = 1 << 24;

/// Standard error of the brightness, as a share of it, above which there is a note.
const UNSURE: f64 = 0.02;

/// Moves samples of another integrator, before it knows where to begin.
pub struct Metropolis<'a> {
    mutated: MutatedIntegrator<'a>,
    /// Vertices of the longest paths, where samples have one technique alone.
    by_technique: Option<u32>,
    size: [u32; 2],
    layers: LayerSet,
}

/// The integrator whose samples are mutated.
enum MutatedIntegrator<'a> {
    Path(Path<'a>),
    /// The same with lights drawn that stand behind glass.
    ManifoldPath(ManifoldPath<'a>),
    Bidirectional(Bidirectional<'a>),
    /// The same with participating media.
    ThroughMedia(Bidirectional<'a, WithMedia<'a>>),
}

/// Chains that know where to begin.
struct Chains<'a> {
    of: &'a Metropolis<'a>,
    starts: Starts,
}

impl<'a> Metropolis<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(
        scene: &'a Scene,
        settings: MetropolisSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Metropolis<'a> {
        Metropolis::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: MetropolisSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Metropolis<'a> {
        let MetropolisSettings { light_choice, roulette, spectral, samples, .. } = settings;
        let bounces = settings.bounces_followed();
        // Light groups are not told apart, so that light may go anywhere.
        let own = LayerSet::of(
            &[Layer::Color, Layer::Albedo].map(|layer| if layers.has(layer) { layer } else { Layer::Color }),
        );
        let mutated = if let MutatedSamples::OfPaths = samples {
            let paths = settings.of_paths();
            match paths.walks_in(scene) {
                false => MutatedIntegrator::Path(Path::through(camera, scene, paths, size, own)),
                true => {
                    MutatedIntegrator::ManifoldPath(ManifoldPath::through(camera, scene, paths, size, own))
                }
            }
        } else {
            let both =
                BidirectionalSettings { bounces, light_choice, roulette, spectral, only_from_lights: false };
            match scene.has_media() {
                false => {
                    MutatedIntegrator::Bidirectional(Bidirectional::through(camera, scene, both, size, own))
                }
                true => MutatedIntegrator::ThroughMedia(Bidirectional::made(camera, scene, both, size, own)),
            }
        };
        let by_technique = matches!(samples, MutatedSamples::ByTechnique).then_some(bounces + 3);
        Metropolis { mutated, by_technique, size, layers }
    }

    /// The integrator whose samples are mutated.
    fn integrator(&self) -> &dyn PixelIntegrator {
        match &self.mutated {
            MutatedIntegrator::Path(path) => path,
            MutatedIntegrator::ManifoldPath(path) => path,
            MutatedIntegrator::Bidirectional(both) => both,
            MutatedIntegrator::ThroughMedia(both) => both,
        }
    }

    /// Its samples, whole or by technique.
    fn mutated(&self) -> Mutated<'_> {
        match (self.by_technique, &self.mutated) {
            (Some(longest), MutatedIntegrator::Bidirectional(integrator)) => {
                Mutated::ByTechnique { integrator, longest }
            }
            (Some(longest), MutatedIntegrator::ThroughMedia(integrator)) => {
                Mutated::ByTechnique { integrator, longest }
            }
            _ => Mutated::Whole(self.integrator()),
        }
    }

    /// The samples to begin at of part `k` of the samples of the picture.
    fn starts(&self, k: u32, setup: &Setup<'_>) -> Result<(Starts, RayCounters), SetupError> {
        let of_part = Setup { seed: setup.seed ^ u64::from(k) << 32, ..*setup };
        Starts::find(self.mutated(), self.size, &of_part)
    }

    /// Whether any layer needs the camera's ray of each pixel.
    fn sees_surfaces(&self) -> bool {
        self.layers != LayerSet::of(&[Layer::Color])
    }

    /// The pixels that share a chain with one of which this is the first; `None` for all others.
    fn block(&self, [x, y]: [u32; 2]) -> Option<Rect> {
        let is_first = x.is_multiple_of(BLOCK) && y.is_multiple_of(BLOCK);
        let [width, height] = self.size;
        is_first.then(|| Rect { x0: x, y0: y, x1: (x + BLOCK).min(width), y1: (y + BLOCK).min(height) })
    }
}

impl Integrator for Metropolis<'_> {
    /// An independent sample of the integrator whose samples chains mutate, not a state of a chain.
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        match &self.mutated {
            MutatedIntegrator::Path(path) => path.observe(ctx, pixel, raster, observer),
            MutatedIntegrator::ManifoldPath(path) => path.observe(ctx, pixel, raster, observer),
            MutatedIntegrator::Bidirectional(both) => both.observe(ctx, pixel, raster, observer),
            MutatedIntegrator::ThroughMedia(both) => both.observe(ctx, pixel, raster, observer),
        }
    }

    /// A chain adds light all over the picture, so debug rays show an independent sample of the pixel.
    fn trails_need_state(&self) -> bool {
        false
    }

    /// The brightness of the whole picture is known to the start samples alone. New ones for each part make its error
    /// go away with more samples, as the noise of chains does.
    fn samples_per_state(&self) -> Option<SamplesPerState> {
        let [width, height] = self.size;
        let samples = MUTATIONS_OF_PART / width.saturating_mul(height).max(1);
        Some(NonZeroU32::new(samples).map_or(SamplesPerState::ONE, SamplesPerState::Count))
    }

    /// Mutations of one chain are alike, and land in all pixels.
    fn noise_is_known(&self) -> bool {
        false
    }

    fn with_state<'a>(&'a self, k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let (starts, rays) = self.starts(k, setup)?;
        // Once is enough.
        let notes = if k == 0 { starts.notes() } else { Vec::new() };
        Ok(WithState { integrator: Box::new(Chains { of: self, starts }), rays, notes })
    }
}

impl PixelIntegrator for Chains<'_> {
    /// Runs the chain of the pixel's block, if the pixel is its first, and looks at the surface that the pixel shows.
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let of = self.of;
        let mut sample = PixelSample::default();
        if of.sees_surfaces() {
            let before = ctx.splats.as_slice().len();
            sample.first = of.integrator().sample(ctx, pixel, raster).first;
            ctx.splats.truncate(before);
        }
        if let Some(block) = of.block(pixel) {
            self.run(ctx, [block.x0 / BLOCK, block.y0 / BLOCK], block.area() as u32);
        }
        sample
    }
}

impl Chains<'_> {
    /// Runs the chain of a block for one sample: as many mutations as it has pixels.
    fn run(&self, ctx: &mut SampleContext<'_>, block: [u32; 2], mutations: u32) {
        let size = self.of.size;
        let [columns, rows] = size.map(|side| side.div_ceil(BLOCK));
        let place = block[0] + block[1] * columns;
        let chain = u64::from(place) + u64::from(ctx.index) * u64::from(columns) * u64::from(rows);
        let Some(start) = self.starts.draw(ctx.seed(), block, ctx.index, chain) else { return };
        let mut evaluation = Evaluation::of(self.of.mutated(), size, ctx);
        let mut chain = Chain::new(start, &mut evaluation);
        let b = self.starts.brightness_of(&start);
        let size = Vec2::from(size.map(|side| side as f32));
        // Each group has as many chains as another one, whether there are many blocks or many samples.
        let number = place.wrapping_add(ctx.index);
        for m in 0..mutations {
            if m % 64 == 63 && evaluation.is_given_up(ctx) {
                break;
            }
            chain.mutate(m, b, &mut evaluation, &mut |raster, value| ctx.splats.add(raster, value));
            ctx.chains.count(number, chain.brightest() / size);
        }
        evaluation.give_back(ctx);
    }
}

#[cfg(test)]
mod tests;
