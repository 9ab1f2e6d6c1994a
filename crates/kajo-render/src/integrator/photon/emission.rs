//! Photons on their way from lights.
//!
//! A path begins at a light chosen by its power and carries `Le |cos| / (p_light p_position p_direction)`, over the number of paths. At
//! each surface that scatters light into more than single directions it leaves a photon, and goes on as paths from lights
//! do elsewhere, with the factor for shading normals and with Russian roulette, so that photons of like power remain
//! [Jensen 2001, 4].
//!
//! The numbers of path `i` of map `k` are those of sample `i` of one pixel of a Sobol sequence, so that the photons of a map are spread
//! evenly over lights, positions and directions.

use kajo_color::Wavelengths;
use kajo_core::LightGroup;
use kajo_core::light::{PowerLightSampler, SampledLight};
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::rng::mix;

use crate::integrator::bidir::{NoMedia, light_end, sample_emitted};
use crate::integrator::photon_map::{Arrival, Photon, dither};
use crate::integrator::transport::SurfaceInteraction;
use crate::trail::{Counting, PathObserver};
use crate::{RayCounters, SampleContext};
use crate::{Setup, SetupError};

/// Sets the seeds of photons apart from those of samples.
const SALT: u64 = 0x7068_6F74_6F6E;

/// Paths that one task follows.
const PATHS_A_TASK: u32 = 4096;

/// What photons are wanted of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All.
    All,
    /// Those of light that no connection with a light finds.
    Indirect,
    /// Those that came by mirrors and glass alone; the path then ends.
    Caustic,
}

/// Which photons are wanted of the paths of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonRequest {
    /// Those of the map.
    pub map: Wanted,
    /// Whether those of caustics are wanted by themselves, too.
    pub caustics: bool,
}

/// Sends photons out.
pub struct Emission<'a> {
    scene: &'a Scene,
    power_sampler: PowerLightSampler,
    sampler: Sampler,
    /// Paths for a map.
    paths: u32,
    /// How often light may be scattered before it leaves a photon.
    bounces: u32,
    roulette: bool,
}

/// What was left by some paths.
#[derive(Default)]
pub struct PhotonBatch {
    /// The photons that were asked for.
    pub photons: Vec<Photon>,
    /// Of these, or beside them, those of caustics, where they are wanted by themselves.
    pub caustics: Vec<Photon>,
    /// Rays that were cast.
    pub rays: RayCounters,
}

impl PhotonBatch {
    /// Keeps a photon where it is wanted.
    ///
    /// * `is_held_up`: whether no connection with a light finds what brought it
    /// * `is_caustic`: whether it came by mirrors and glass alone
    #[inline]
    fn keep(&mut self, photon: Photon, wanted: PhotonRequest, is_held_up: bool, is_caustic: bool) {
        let is_wanted = match wanted.map {
            Wanted::All => true,
            Wanted::Indirect => is_held_up,
            Wanted::Caustic => is_caustic,
        };
        self.photons.extend(is_wanted.then_some(photon));
        self.caustics.extend((wanted.caustics && is_caustic).then_some(photon));
    }
}

impl<'a> Emission<'a> {
    pub fn new(scene: &'a Scene, paths: u32, bounces: u32, roulette: bool) -> Emission<'a> {
        let sampler = Sampler::new(SamplerKind::Sobol, paths);
        Emission { scene, power_sampler: scene.power_light_sampler(), sampler, paths, bounces, roulette }
    }

    /// Whether any light has power.
    pub fn has_light(&self) -> bool {
        self.power_sampler.sample(0.5).is_some()
    }

    /// The photons of map `k`.
    ///
    /// # Errors
    /// [`SetupError`]; when there is no room for the photons.
    pub fn emit(
        &self,
        k: u32,
        wavelengths: &Wavelengths,
        wanted: PhotonRequest,
        setup: &Setup<'_>,
    ) -> Result<PhotonBatch, SetupError> {
        let work = |task: u32| {
            let begin = task * PATHS_A_TASK;
            let end = begin.saturating_add(PATHS_A_TASK).min(self.paths);
            let mut batch = PhotonBatch::default();
            (begin..end).for_each(|i| self.emit_path(k, i, setup.seed, wavelengths, wanted, &mut batch));
            // All of them are copied once.
            let bytes = 2 * (batch.photons.len() + batch.caustics.len()) * size_of::<Photon>();
            (batch, bytes as u64)
        };
        let too_many = || self.too_many(setup.memory);
        let tasks = setup.tasks_in_memory(self.paths.div_ceil(PATHS_A_TASK), work, too_many)?;
        let mut all = PhotonBatch::default();
        all.photons.reserve_exact(tasks.iter().map(|task| task.photons.len()).sum());
        for task in tasks {
            all.photons.extend(task.photons);
            all.caustics.extend(task.caustics);
            all.rays += task.rays;
        }
        Ok(all)
    }

    fn too_many(&self, memory: u64) -> SetupError {
        SetupError::Refused(format!(
            "the photons of {} paths need more memory than the {} MB that can be had; ask for fewer `photons`",
            self.paths,
            memory >> 20
        ))
    }

    /// Follows path `i` of map `k`.
    fn emit_path(
        &self,
        k: u32,
        i: u32,
        seed: u64,
        wavelengths: &Wavelengths,
        wanted: PhotonRequest,
        batch: &mut PhotonBatch,
    ) {
        let scene = self.scene;
        let mut counting = Counting::new(&SampleContext::new(&self.sampler, 0));
        let mut draws = SampleStream::new(&self.sampler, mix(seed ^ SALT), [k, 0], i);
        let time = draws.number_if(scene.moves());
        let drawn = sample_emitted(scene, &self.power_sampler, time, wavelengths, &mut draws);
        let Some((SampledLight { probability, .. }, emitted)) = drawn else { return };
        let mut path = light_end(scene, &emitted, time, probability, wavelengths, draws);
        counting.counters().light += 1;
        let (mut surface, mut first) = (SurfaceInteraction::default(), None);
        // Whether nothing but mirrors and glass was met, and whether anything stands between a surface and the light.
        let (mut is_clear, mut is_held_up) = (true, false);
        let mut stored = 0;
        while let Some((bsdf, _)) =
            path.next_from_light::<NoMedia>(scene, &emitted, &mut surface, &mut first, &mut counting)
        {
            is_held_up |= !path.state.connectable;
            let vertex = path.vertex::<NoMedia>(scene, &surface, bsdf, LightGroup::default());
            if !bsdf.is_delta() {
                let is_caustic = is_clear && is_held_up;
                let arrival = Arrival {
                    p: vertex.at.p,
                    n: vertex.at.ng,
                    wi: vertex.wo,
                    power: path.state.beta * (1.0 / self.paths as f32),
                    scatterings: path.state.scatterings,
                    secondary_terminated: vertex.secondary_terminated,
                };
                let photon = Photon::new(&arrival, dither(i, stored));
                stored += 1;
                batch.keep(photon, wanted, is_held_up, is_caustic);
            }
            let is_last = path.state.scatterings >= self.bounces;
            if is_last || !path.scatter(&vertex, &surface, self.roulette, &mut counting) {
                break;
            }
            // The light itself is one way to be found, but not from behind what scatters it.
            is_held_up = true;
            is_clear &= !path.state.connectable;
            if wanted.map == Wanted::Caustic && !is_clear {
                break;
            }
        }
        batch.rays += counting.rays;
    }
}
