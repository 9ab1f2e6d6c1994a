//! What one camera ray brings to the film, and the integrators that cast it.

use std::num::NonZeroU32;

use kajo_math::{Vec2, Vec3};

use crate::{KeptState, RayCounters, SampleContext, Setup, SetupError, Trail};

/// What one camera ray brings to the film. Values of rarer layers are in [`SampleContext::aux`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PixelSample {
    /// Radiance arriving along the ray as the sensor sees it: linear RGB.
    pub radiance: [f32; 3],
    /// The nearest surface, or `None` when the ray left the scene.
    pub first: Option<FirstHit>,
}

/// The nearest surface along a camera ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Length of the path to it, along the camera's ray or its curve; negative behind the start of parallel rays that see what is there.
    pub t: f32,
    /// World space unit normal as stored with the surface, not turned towards the viewer.
    pub n: Vec3,
    /// Parameters of the surface.
    pub uv: Vec2,
    /// Number of the object, counted from 1: 0 is what a miss has.
    pub object: u32,
    /// Number of the material, counted from 1: 0 is what a miss has.
    pub material: u32,
}

/// Samples of each pixel that share one state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplesPerState {
    /// So many in a row.
    Count(NonZeroU32),
    /// All there are.
    All,
}

impl SamplesPerState {
    /// A state for each.
    pub const ONE: SamplesPerState = SamplesPerState::Count(NonZeroU32::MIN);

    /// The number of the state that the sample at a position has.
    pub fn part_of(self, position: u32) -> u32 {
        match self {
            SamplesPerState::Count(n) => position / n,
            SamplesPerState::All => 0,
        }
    }

    /// One past the last position of the samples that share a state with that at `position`, as far as they can be counted.
    pub fn end_of_part(self, position: u32) -> u32 {
        match self {
            SamplesPerState::Count(n) => (position / n + 1).saturating_mul(n.get()),
            SamplesPerState::All => u32::MAX,
        }
    }
}

/// Radiance arriving along the camera ray through a film position.
pub trait PixelIntegrator: Sync {
    /// Casts one camera ray.
    ///
    /// * `ctx`: the random numbers of this sample; every ray cast, the camera's included, is counted there,
    ///   and light for other positions of the picture is added to its splats
    /// * `pixel`: the pixel that asks, counted from the top left one
    /// * `raster`: position on the film in pixels; (0, 0) is the top left corner of the picture. It may lie
    ///   beside `pixel`: a regular grid of a number that is no square hangs over.
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> PixelSample;

    /// The same sample with all its rays, where the integrator reports them.
    fn trail(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> (PixelSample, Trail) {
        (self.sample(ctx, pixel, raster), Trail::default())
    }

    /// Whether [`PixelIntegrator::trail`] shows the samples of a render only with their state: then it is to be asked of what
    /// [`PixelIntegrator::with_state`] makes.
    fn trails_need_state(&self) -> bool {
        self.samples_per_state().is_some()
    }

    /// Samples of each pixel that share one state, which is made before they are taken; `None` where each stands by itself.
    ///
    /// See [`state`](crate::state).
    fn samples_per_state(&self) -> Option<SamplesPerState> {
        None
    }

    /// Whether the noise of a pixel can be told from its samples: they are independent, given a state whose choice changes no
    /// mean, or each has a state of its own.
    fn noise_is_known(&self) -> bool {
        matches!(self.samples_per_state(), None | Some(SamplesPerState::ONE))
    }

    /// Has it start from what renders of the same scene through other cameras left, and leave its own to those that follow: records
    /// of irradiance. `false` of an integrator that has nothing of the kind.
    fn keep_state(&mut self, _kept: &KeptState) -> bool {
        false
    }

    /// The integrator with the state of part `k` of the samples: a function of the scene, the seed and `k`, and of what is
    /// [kept](PixelIntegrator::keep_state).
    ///
    /// # Errors
    /// [`SetupError`]
    fn with_state<'a>(&'a self, _k: u32, _setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        Err(SetupError::Refused("this integrator has no state".to_owned()))
    }
}

/// An integrator with its state, and what that took.
pub struct WithState<'a> {
    /// Takes the samples of the part.
    pub integrator: Box<dyn PixelIntegrator + 'a>,
    /// Rays cast for the state.
    pub rays: RayCounters,
    /// What is worth knowing of it, a sentence each.
    pub notes: Vec<String>,
}
