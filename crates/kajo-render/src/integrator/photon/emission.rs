//! Photons on their way from lights.
//!
//! A path begins at a light chosen by its power and carries `Le |cos| / (p_light p_position p_direction)`, over the number of paths. At
//! each surface that scatters light into more than single directions it leaves a photon, and goes on as paths from lights
//! do elsewhere, with the factor for shading normals and with Russian roulette, so that photons of like power remain
//! [Jensen 2001, 4].
//!
//! In a medium it leaves one at each collision that scatters, of the power `beta / sigma_s` over the number of paths:
//! `beta` has the scattering `sigma_s` per unit length in it, so that these photons are distributed by volume as
//! radiance is, whatever the medium [Jensen and Christensen 1998].
//!
//! In homogeneous media its rays are kept too, as beams, of the first paths that leave so many as are wanted.
//!
//! The numbers of path `i` of map `k` are those of sample `i` of one pixel of a Sobol sequence, so that the photons of a map are spread
//! evenly over lights, positions and directions.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::LightGroup;
use kajo_core::light::{LightLeSample, PowerLightSampler, SampledLight};
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec3;
use kajo_math::rng::mix;

use super::beam::HomogeneousRay;
use super::beam_map::PhotonBeam;
use super::shutter::ShutterParts;
use crate::integrator::bidir::{
    LightStep, NoMedia, Subpath, Vertex, Volume, WithMedia, is_endless, light_end, sample_emitted,
};
use crate::integrator::photon_map::{Arrival, Photon, dither};
use crate::integrator::transport::{LaneMis, PathState, SurfaceInteraction};
use crate::setup::append_tightly;
use crate::trail::{Counting, PathObserver};
use crate::{RayCounters, SampleContext};
use crate::{Setup, SetupError};

/// Sets the seeds of photons apart from those of samples.
const SALT: u64 = 0x7068_6F74_6F6E;

/// Paths that one task follows.
const PATHS_A_TASK: u32 = 4096;

/// Beams that are kept of a map: those of its first paths. More of them take longer and leave the noise of surfaces.
pub const MOST_BEAMS: usize = 1 << 11;

/// What photons are wanted of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wanted {
    /// All.
    #[default]
    All,
    /// Those of light that no connection with a light finds.
    Indirect,
    /// Those that came by mirrors and glass alone; the path then ends.
    Caustic,
}

/// Which photons are wanted of the paths of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotonRequest {
    /// Those of the map.
    pub map: Wanted,
    /// Whether those of caustics are wanted by themselves, too.
    pub caustics: bool,
    /// Those in media, if any.
    pub in_media: Option<Wanted>,
    /// The shortest mean free path of homogeneous media whose photons are wanted as beams, too.
    pub beams: Option<f32>,
}

/// Sends photons out.
pub struct PhotonEmission<'a> {
    scene: &'a Scene,
    power_sampler: PowerLightSampler,
    sampler: Sampler,
    /// Paths for all parts of a map.
    paths: u32,
    /// How often light may be scattered before it leaves a photon.
    bounces: u32,
    roulette: bool,
    /// Whether the air is a medium without end, which nothing comes through from infinitely far away.
    in_endless_air: bool,
}

/// What was left by some paths.
#[derive(Default)]
pub struct PhotonBatch {
    /// The photons that were asked for.
    pub photons: Vec<Photon>,
    /// Of these, or beside them, those of caustics, where they are wanted by themselves.
    pub caustics: Vec<Photon>,
    /// Those in media.
    pub in_media: Vec<Photon>,
    /// Beams in homogeneous media, of the power of all paths.
    pub beams: Vec<PhotonBeam>,
    /// The first paths, by which these were left.
    pub beam_paths: u32,
    /// How many photons all paths left in the same media.
    pub photons_beside_beams: u64,
    /// Rays that were cast.
    pub rays: RayCounters,
}

/// The paths of a part of the time that the shutter is open.
#[derive(Clone, Copy)]
struct MapPart {
    /// The number of the map.
    k: u32,
    seed: u64,
    /// The number of the part, and what it is one of.
    part: u32,
    shutter: ShutterParts,
    /// How many paths.
    paths: u32,
}

/// How a photon got to where it is.
#[derive(Clone, Copy)]
struct Route {
    /// Whether no connection with a light finds what brought it.
    is_held_up: bool,
    /// Whether it came by mirrors and glass alone.
    is_caustic: bool,
}

impl Wanted {
    #[inline]
    fn takes(self, route: Route) -> bool {
        match self {
            Wanted::All => true,
            Wanted::Indirect => route.is_held_up,
            Wanted::Caustic => route.is_caustic,
        }
    }
}

impl PhotonBatch {
    /// Keeps a photon of a surface where it is wanted.
    #[inline]
    fn keep(&mut self, photon: Photon, wanted: PhotonRequest, route: Route) {
        self.photons.extend(wanted.map.takes(route).then_some(photon));
        self.caustics.extend((wanted.caustics && route.is_caustic).then_some(photon));
    }

    /// Adds those of the paths after these.
    fn append(&mut self, next: PhotonBatch) {
        append_tightly(&mut self.photons, next.photons);
        append_tightly(&mut self.caustics, next.caustics);
        append_tightly(&mut self.in_media, next.in_media);
        self.photons_beside_beams += next.photons_beside_beams;
        if self.beams.len() < MOST_BEAMS {
            append_tightly(&mut self.beams, next.beams);
            self.beam_paths += next.beam_paths;
        }
        self.rays += next.rays;
    }

    /// Whether no photon was left.
    pub fn is_empty(&self) -> bool {
        [&self.photons, &self.caustics, &self.in_media].iter().all(|photons| photons.is_empty())
    }

    fn bytes(&self) -> u64 {
        let room = [&self.photons, &self.caustics, &self.in_media].map(Vec::capacity);
        let photons = room.iter().sum::<usize>() * size_of::<Photon>();
        (photons + self.beams.capacity() * size_of::<PhotonBeam>()) as u64
    }
}

impl<'a> PhotonEmission<'a> {
    pub fn new(scene: &'a Scene, paths: u32, bounces: u32, roulette: bool) -> PhotonEmission<'a> {
        let sampler = Sampler::new(SamplerKind::Sobol, paths);
        PhotonEmission {
            scene,
            power_sampler: scene.power_light_sampler(),
            sampler,
            paths,
            bounces,
            roulette,
            in_endless_air: is_endless(scene),
        }
    }

    /// Whether any light has power.
    pub fn has_light(&self) -> bool {
        self.power_sampler.sample(0.5).is_some()
    }

    /// The photons of map `k`, of all moments.
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
        let parts = self.emit_in(ShutterParts::WHOLE, k, wavelengths, wanted, setup)?;
        Ok(parts.into_iter().next().unwrap_or_default())
    }

    /// The photons of map `k`, those of each part of the time that the shutter is open by themselves. Each part has the power of all lights.
    ///
    /// # Errors
    /// [`SetupError`]; when there is no room for the photons.
    pub fn emit_in(
        &self,
        shutter: ShutterParts,
        k: u32,
        wavelengths: &Wavelengths,
        wanted: PhotonRequest,
        setup: &Setup<'_>,
    ) -> Result<Vec<PhotonBatch>, SetupError> {
        let paths = shutter.share_of(self.paths);
        let tasks = paths.div_ceil(PATHS_A_TASK);
        let work = |task: u32| {
            let (part, task) = (task / tasks, task % tasks);
            let begin = task * PATHS_A_TASK;
            let end = begin.saturating_add(PATHS_A_TASK).min(paths);
            let mut batch = PhotonBatch::default();
            let map = MapPart { k, seed: setup.seed, part, shutter, paths };
            match self.scene.has_media() {
                false => (begin..end)
                    .for_each(|i| self.emit_path::<NoMedia>(&map, i, wavelengths, wanted, &mut batch)),
                true => (begin..end)
                    .for_each(|i| self.emit_path::<WithMedia<'_>>(&map, i, wavelengths, wanted, &mut batch)),
            }
            (part, batch)
        };
        setup.fold_tasks(tasks * shutter.count(), work, |all: &mut Vec<PhotonBatch>, (part, batch)| {
            all.resize_with(part as usize + 1, PhotonBatch::default);
            all[part as usize].append(batch);
            let bytes = all.iter().map(PhotonBatch::bytes).sum::<u64>();
            if bytes > setup.memory { Err(self.too_many(setup.memory)) } else { Ok(()) }
        })
    }

    fn too_many(&self, memory: u64) -> SetupError {
        SetupError::Refused(format!(
            "the photons of {} paths need more memory than the {} MB that can be had; ask for fewer `photons`",
            self.paths,
            memory >> 20
        ))
    }

    /// Follows path `i` of a part of a map.
    fn emit_path<'v, V: Volume<'v>>(
        &'v self,
        map: &MapPart,
        i: u32,
        wavelengths: &Wavelengths,
        wanted: PhotonRequest,
        batch: &mut PhotonBatch,
    ) {
        let scene = self.scene;
        let mut observer = PhotonKeeper::new(&self.sampler, i, wanted, batch.beams.len() < MOST_BEAMS);
        batch.beam_paths += u32::from(observer.keeps_beams);
        let Some((mut path, emitted)) = self.begin::<V>(map, i, wavelengths) else { return };
        observer.counters().light += 1;
        let (mut surface, mut first) = (SurfaceInteraction::default(), None);
        while let Some(step) =
            path.step_from_light::<V>(scene, &emitted, &mut surface, &mut first, &mut observer)
        {
            observer.is_held_up |= !path.state.connectable;
            let (bsdf, collision) = match step {
                LightStep::Vertex(vertex) => vertex,
                // What is a hole to this path may be seen by others.
                LightStep::Passed(beta) if scene.is_mixture(&surface.at) => {
                    observer.leave(&map.arrival_on(scene, &path, &surface, beta), batch);
                    continue;
                }
                LightStep::Passed(_) => continue,
            };
            let vertex = match &collision {
                None => path.vertex::<V>(scene, &surface, bsdf, LightGroup::default()),
                Some(at) => path.vertex_in_medium::<V>(scene, at, LightGroup::default()),
            };
            match &collision {
                // Of a mixture another part may be seen from the camera.
                None if !bsdf.is_delta() || scene.is_mixture(&surface.at) => {
                    observer.leave(&map.arrival_on(scene, &path, &surface, path.state.beta), batch);
                }
                // Paths from the camera go on through bodies that scatter light many times.
                Some(at) if !at.is_subsurface => {
                    let arrival = map.arrival_in_medium(scene, &path, &vertex);
                    observer.leave_in_medium(&arrival, scene, &path.state, batch);
                }
                _ => {}
            }
            let is_last = path.state.scatterings >= self.bounces;
            if is_last
                || !path.scatter_at(&vertex, &surface, collision.as_ref(), self.roulette, &mut observer)
            {
                break;
            }
            // The light itself is one way to be found, but not from behind what scatters it.
            observer.is_held_up = true;
            observer.is_clear &= !path.state.connectable;
            if wanted.map == Wanted::Caustic && !observer.is_clear {
                break;
            }
        }
        batch.rays += observer.counting.rays;
        batch.beams.append(&mut observer.beams);
    }

    /// The beginning of path `i` of a part of a map, and the light that it begins with; `None` where it has none.
    fn begin<'v, V: Volume<'v>>(
        &self,
        map: &MapPart,
        i: u32,
        wavelengths: &Wavelengths,
    ) -> Option<(Subpath<'_>, LightLeSample)> {
        let scene = self.scene;
        let mut draws = SampleStream::new(&self.sampler, mix(map.seed ^ SALT), [map.k, map.part], i);
        let time = map.shutter.moment(map.part, draws.number_if(scene.moves()));
        let hero = if V::HAS_MEDIA { LaneMis::new(wavelengths, draws.next_1d()).hero } else { 0 };
        let drawn = sample_emitted(scene, &self.power_sampler, time, wavelengths, &mut draws);
        let (SampledLight { probability, .. }, emitted) = drawn?;
        if V::HAS_MEDIA && self.in_endless_air && emitted.at.is_infinite() {
            return None;
        }
        let mut path = light_end(scene, &emitted, time, probability, wavelengths, draws);
        if V::HAS_MEDIA {
            path.state.carry_media(hero);
        }
        Some((path, emitted))
    }
}

impl MapPart {
    /// What comes to a surface, where that is in the middle of the part.
    ///
    /// * `beta`: what the path carries there
    fn arrival_on(
        &self,
        scene: &Scene,
        path: &Subpath<'_>,
        surface: &SurfaceInteraction,
        beta: Spectrum,
    ) -> Arrival {
        Arrival {
            p: self.shutter.point_at(scene, &surface.at),
            n: surface.at.point.ng,
            wi: surface.wo,
            power: beta * (1.0 / self.paths as f32),
            scatterings: path.state.scatterings,
            secondary_terminated: path.state.wavelengths.secondary_terminated(),
        }
    }

    /// What comes to a vertex in a medium.
    fn arrival_in_medium<'v, V: Volume<'v>>(
        &self,
        scene: &Scene,
        path: &Subpath<'_>,
        vertex: &Vertex<'v, V>,
    ) -> Arrival {
        let PathState { media, wavelengths, ray, beta, scatterings, .. } = &path.state;
        let sigma_s = media.scattering(scene, vertex.at.p, ray.time, wavelengths);
        Arrival {
            p: vertex.at.p,
            n: Vec3::Z,
            wi: vertex.wo,
            power: (*beta * (1.0 / self.paths as f32)).safe_div(sigma_s),
            scatterings: *scatterings,
            secondary_terminated: vertex.secondary_terminated,
        }
    }
}

/// Leaves the photons of a path, counts its rays, and keeps those through homogeneous media as beams.
#[derive(Default)]
struct PhotonKeeper<'a> {
    counting: Counting<'a>,
    /// The number of the path, and how many photons it has left.
    path: u32,
    stored: u32,
    /// What is kept, and whether beams are among it.
    wanted: PhotonRequest,
    keeps_beams: bool,
    /// Whether anything stands between the last vertex and the light.
    is_held_up: bool,
    /// Whether nothing but mirrors and glass was met.
    is_clear: bool,
    beams: Vec<PhotonBeam>,
}

impl<'a> PhotonKeeper<'a> {
    /// * `path`: its number
    /// * `has_room`: whether more beams are wanted
    fn new(sampler: &'a Sampler, path: u32, wanted: PhotonRequest, has_room: bool) -> PhotonKeeper<'a> {
        let counting = Counting::new(&SampleContext::new(sampler, 0));
        let keeps_beams = has_room && wanted.beams.is_some();
        PhotonKeeper { counting, path, wanted, keeps_beams, is_clear: true, ..PhotonKeeper::default() }
    }

    /// The number by which the power of the next photon is rounded.
    fn next_dither(&mut self) -> f32 {
        self.stored += 1;
        dither(self.path, self.stored - 1)
    }

    /// Leaves a photon on a surface where it is wanted.
    fn leave(&mut self, arrival: &Arrival, batch: &mut PhotonBatch) {
        let photon = Photon::new(arrival, self.next_dither());
        batch.keep(photon, self.wanted, self.route());
    }

    /// Leaves a photon in a medium where it is wanted.
    fn leave_in_medium(
        &mut self,
        arrival: &Arrival,
        scene: &Scene,
        state: &PathState<'_>,
        batch: &mut PhotonBatch,
    ) {
        let dither = self.next_dither();
        if self.wanted.in_media.is_some_and(|wanted| wanted.takes(self.route())) {
            batch.in_media.push(Photon::new(arrival, dither));
            batch.photons_beside_beams += u64::from(self.wants_beam(scene, state).is_some());
        }
    }

    /// The ray of a path, if it is one of those that may be kept as beams.
    fn wants_beam<'v>(&self, scene: &'v Scene, path: &PathState<'_>) -> Option<HomogeneousRay<'v>> {
        let shortest = self.wanted.beams?;
        HomogeneousRay::of(scene, path).filter(|ray| ray.mean_free_path >= shortest)
    }

    /// How light got to the last vertex, or to the one that the path goes to.
    fn route(&self) -> Route {
        Route { is_held_up: self.is_held_up, is_caustic: self.is_clear && self.is_held_up }
    }
}

impl PathObserver for PhotonKeeper<'_> {
    type Mark = ();

    fn counters(&mut self) -> &mut RayCounters {
        self.counting.counters()
    }

    fn traced(&mut self, scene: &Scene, path: &PathState<'_>, extent: f32) {
        if !self.keeps_beams {
            return;
        }
        self.is_held_up |= !path.connectable;
        if self.wanted.in_media.is_some_and(|wanted| wanted.takes(self.route()))
            && let Some(ray) = self.wants_beam(scene, path)
        {
            self.beams.push(PhotonBeam {
                o: path.ray.o,
                d: path.ray.d,
                length: ray.reach(extent),
                power: path.beta,
                scatterings: path.scatterings,
                secondary_terminated: path.wavelengths.secondary_terminated(),
            });
        }
    }

    fn mark(&self) {}

    fn back_to(&mut self, _mark: ()) {}
}
