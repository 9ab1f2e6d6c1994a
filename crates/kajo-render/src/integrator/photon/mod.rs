//! Photon mapping [Jensen 1996], [Jensen 2001], and progressive photon mapping [Hachisuka and Jensen 2009].
//!
//! Paths from lights leave photons of power `Φ` where they come to surfaces that are no mirrors. The light that such a surface sends
//! to the camera is estimated from the photons of a small disk of radius `r` around a point,
//!
//! ```text
//! L(x, wo) = 1/(pi r^2) sum over j of f(x, wo, wi_j) Φ_j                         [Jensen 2001, eq. 7.6]
//! ```
//!
//! which is blurred by the disk, but finds light that no path from the camera finds: that of small lights behind glass and by way of
//! mirrors. What is taken from the map at a point, and what by paths, is one of
//!
//! ```text
//! direct      all light of the first surface that is no mirror
//! gather      caustics at that surface, and all light of the surfaces that one more ray hits from there
//! caustics    caustics; paths find the rest
//! sppm        all but direct light, from new photons for each sample and in ever smaller disks
//! ```
//!
//! Direct light is that of a light drawn for the point; a caustic is light that came from a light by mirrors and glass alone. The
//! paths that remain meet lights and draw them as in path tracing, but count no light twice: a light met by way of mirrors
//! from a point whose caustics were taken from the map is left out. Where surfaces are glossy, a few directions say more than
//! photons; there paths go on.
//!
//! Progressive photon mapping takes the mean of `n` passes,
//!
//! ```text
//! L = 1/n sum over i = 1 .. n  of  L_i,       L_i = 1/(pi r_i^2) sum over the photons of pass i in the disk  of  f Φ_j
//! ```
//!
//! each an independent estimate by a map of its own, of `N` paths whose power is divided by `N`, one sample of each pixel for each map. In pass `i`,
//! with `a = 2/3`,
//!
//! ```text
//! r_{i+1}^2 / r_i^2 = (i + a) / (i + 1)                            [Knaus and Zwicker 2011, eq. 19]
//! ```
//!
//! so that the bias vanishes as `i^(a - 1)` and the variance of the mean still does as `i^-a`. No pass needs what another found.
//!
//! In participating media photons are left at collisions, and their light is estimated from those of a small ball
//! [Jensen and Christensen 1998], whose volume shrinks as the area of the disks does. Paths from the camera end at
//! their first collision, and all but direct light comes from the photons there. Where the medium is homogeneous
//! progressive photon mapping takes the photons all along a ray, whether or not it collides [Jarosz, Zwicker and Jensen
//! 2008], or the beams that pass it [Jarosz et al. 2011].

mod beam;
mod beam_map;
pub(super) mod emission;
mod gather;
mod settings;
mod shutter;

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::bsdf::Transport;
use kajo_core::camera::Camera;
use kajo_core::light::BoundingSphere;
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::PhotonMapUse;
use kajo_math::{Vec2, Vec3, fmath};

use super::Integrator;
use super::bidir::{NoMedia, Subpath, WithMedia};
use super::camera_view::{CameraView, in_white_light, number_of_pass};
use super::path::{Path, PathSettings};
use super::photon_map::PhotonMap;
use super::transport::{LaneMis, PathState};
use crate::trail::PathObserver;
use crate::{LayerSet, PixelSample, SampleContext};
use crate::{SamplesPerState, Setup, SetupError, WithState};
use beam_map::{BeamMap, SearchRadius};
use emission::{PhotonBatch, PhotonEmission, PhotonRequest, Wanted};
use gather::{GatherScratch, Gatherer};
pub use settings::{PHOTON, PhotonSettings, SPPM};
use shutter::ShutterParts;

/// Photons of a density estimate of fixed maps.
const NEIGHBOURS: usize = 64;

/// `a`: how much of the photons of each further pass is kept.
const ALPHA: f64 = 2.0 / 3.0;

/// Pixels from the middle of the first disk to its rim, where the scene's size does not say otherwise.
const FIRST_RADIUS: f32 = 2.5;

/// Sets wavelengths of passes apart from all other numbers.
const WAVELENGTH_SALT: u64 = 0x6C61_6D62_6461;

/// Sets moments of passes apart from all other numbers.
const MOMENT_SALT: u64 = 0x7368_7574_7465;

/// From the moment of a pass to that of the next one, as a share of the time that the shutter is open: the root of 2, less 1. With the
/// wavelengths of the passes these are spread evenly over the square.
const MOMENT_STEP: f64 = std::f64::consts::SQRT_2 - 1.0;

/// Parts of the time that the shutter is open whose photons are kept apart, where things move: in one map for all samples, and in the
/// first pass over rows that are exposed one after the other.
const PARTS: f32 = 8.0;

/// The most parts of later passes.
const MOST_PARTS: u32 = 256;

/// A photon mapper over one scene and one picture size, before it has photons: it follows paths.
pub struct PhotonMapping<'a> {
    view: CameraView<'a>,
    settings: PhotonSettings,
    paths: Path<'a>,
}

/// A photon mapper with the photons of a part of the samples.
pub struct Photons<'a> {
    view: CameraView<'a>,
    settings: PhotonSettings,
    shutter: ShutterParts,
    /// Those of each part of the time that the shutter is open.
    maps: Vec<Maps>,
    /// What all photons carry.
    wavelengths: Wavelengths,
    /// Whether any medium emits, which no photon leaves.
    has_emissive_media: bool,
}

/// The maps, and how they are looked at.
enum Maps {
    /// The nearest photons: all, and those of caustics.
    Fixed { usage: PhotonMapUse, all: PhotonMap, caustics: PhotonMap, in_media: PhotonMap },
    /// Those in a disk or a ball.
    Progressive { indirect: PhotonMap, in_media: InMedia, radius: Radius },
}

/// What media hold of the light of a pass.
struct InMedia {
    photons: PhotonMap,
    /// The same light on its way through homogeneous media, if there is any.
    beams: Option<BeamMap>,
    /// How many photons were left beside each beam that is kept.
    photons_per_beam: f32,
}

/// The radii of the disks and balls of a pass.
#[derive(Clone, Copy, Debug)]
struct Radius {
    disk: RadiusOfPass,
    ball: RadiusOfPass,
}

/// What is left of a radius in a pass.
#[derive(Clone, Copy, Debug)]
struct RadiusOfPass {
    /// What the first one is at least and, if pixels are larger, at most.
    bounds: [f32; 2],
    /// What is left of it in this pass.
    share: f32,
}

impl Radius {
    /// * `paths`: that photons of a pass are left by; `world`: around the scene
    fn of_pass(k: u32, paths: u32, world: &BoundingSphere) -> Radius {
        // What is left of the area of disks and of the volume of balls alike: the product of all ratios
        // [Knaus and Zwicker 2011, eq. 19 and 5].
        let share: f64 = (1..=k).map(|i| (f64::from(i) + ALPHA) / (f64::from(i) + 1.0)).product();
        let pass = |least: f32, share: f64| RadiusOfPass {
            bounds: [least, least.max(0.01 * world.radius)],
            share: share as f32,
        };
        // Spread evenly over the sphere around the scene, or within it, about one photon would lie in the smallest one.
        Radius {
            disk: pass(world.radius * (4.0 / paths as f32).sqrt(), share.sqrt()),
            ball: pass(world.radius * cbrt(1.0 / f64::from(paths)) as f32, cbrt(share)),
        }
    }
}

/// The cube root of a positive number.
fn cbrt(x: f64) -> f64 {
    fmath::exp64(fmath::ln64(x) / 3.0)
}

impl RadiusOfPass {
    /// * `pixel`: size of a pixel at the point
    fn at(&self, pixel: f32) -> f32 {
        let [least, most] = self.bounds;
        self.share * (FIRST_RADIUS * pixel).clamp(least, most)
    }

    /// The one of the smallest pixels.
    fn least(&self) -> f32 {
        self.at(0.0)
    }
}

impl<'a> PhotonMapping<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(
        scene: &'a Scene,
        settings: PhotonSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> PhotonMapping<'a> {
        PhotonMapping::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: PhotonSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> PhotonMapping<'a> {
        let PhotonSettings { bounces, light_choice, roulette, spectral, .. } = settings;
        let paths = PathSettings { bounces, light_choice, roulette, spectral, ..PathSettings::default() };
        PhotonMapping {
            view: CameraView::new(scene, camera, size, layers).spectral(spectral),
            settings,
            paths: Path::through(camera, scene, paths, size, layers),
        }
    }

    /// The moments of the photons of map `k`.
    fn shutter(&self, k: u32, seed: u64) -> ShutterParts {
        let scene = self.view.scene;
        match self.settings.usage {
            _ if !scene.has_moving_things() => ShutterParts::WHOLE,
            // What has moved is seen in many places, and so are its photons.
            Some(PhotonMapUse::Dots) => ShutterParts::WHOLE,
            Some(_) => ShutterParts::equal(PARTS as u32),
            None if scene.output.readout > 0.0 => {
                let share = Radius::of_pass(k, self.settings.photons, &self.world()).disk.share;
                ShutterParts::equal(((PARTS / share) as u32).min(MOST_PARTS))
            }
            None => ShutterParts::at(number_of_pass(seed ^ MOMENT_SALT, k, MOMENT_STEP)),
        }
    }

    /// The maps of part `k`, the rays that they took, and what is worth knowing of them.
    fn maps(
        &self,
        k: u32,
        shutter: ShutterParts,
        wavelengths: &Wavelengths,
        setup: &Setup<'_>,
    ) -> Result<(Vec<Maps>, crate::RayCounters, Vec<String>), SetupError> {
        let PhotonSettings { bounces, photons, usage, roulette, .. } = self.settings;
        let emission = PhotonEmission::new(self.view.scene, photons, bounces, roulette);
        let [map, in_media] = match usage {
            None => [Wanted::Indirect; 2],
            Some(PhotonMapUse::Direct | PhotonMapUse::Dots) => [Wanted::All; 2],
            Some(PhotonMapUse::Gather) => [Wanted::All, Wanted::Indirect],
            Some(PhotonMapUse::Caustics) => [Wanted::Caustic; 2],
        };
        let caustics = usage == Some(PhotonMapUse::Gather);
        // Where light does not even reach across the smallest disk, photons are as good.
        let beams = usage.is_none().then(|| self.radius(k, shutter).disk.least());
        let wanted = PhotonRequest { map, caustics, in_media: Some(in_media), beams };
        let has_light = emission.has_light();
        let batches = match has_light {
            true => emission.emit_in(shutter, k, wavelengths, wanted, setup)?,
            false => (0..shutter.count()).map(|_| PhotonBatch::default()).collect(),
        };
        let mut notes = Vec::new();
        if !has_light && k == 0 {
            notes.push("there is no light in the scene that photons could leave".to_owned());
        } else if usage == Some(PhotonMapUse::Caustics) && batches.iter().all(PhotonBatch::is_empty) {
            notes.push(
                "no photon came to a surface by way of mirrors or glass, so there are no caustics; \
                 `integrator path` finds the same picture sooner"
                    .to_owned(),
            );
        }
        let mut rays = crate::RayCounters::default();
        batches.iter().for_each(|batch| rays += batch.rays);
        let maps = batches.into_iter().map(|batch| match usage {
            None => self.progressive(self.radius(k, shutter), batch, setup.threads),
            Some(usage) => fixed(usage, batch, setup.threads),
        });
        Ok((maps.collect(), rays, notes))
    }

    /// The sphere around the scene.
    fn world(&self) -> BoundingSphere {
        BoundingSphere::around(&self.view.scene.geometry.bounds())
    }

    /// The radii of pass `k`.
    fn radius(&self, k: u32, shutter: ShutterParts) -> Radius {
        Radius::of_pass(k, shutter.share_of(self.settings.photons), &self.world())
    }

    /// The radii of searches for beams, by the pixels in the middle of the picture.
    fn search_radius(&self, of_pass: RadiusOfPass) -> SearchRadius {
        let sampler = Sampler::new(SamplerKind::Uniform, 1);
        let mut draws = SampleStream::new(&sampler, 0, [0, 0], 0);
        let (start, raster) = (draws, Vec2::from(self.view.size.map(|n| 0.5 * n as f32)));
        let ray = self.view.ray(raster, &mut draws);
        let footprint = ray.and_then(|ray| self.view.footprint(&ray, raster, start)).unwrap_or_default();
        SearchRadius { center: ray.map_or(Vec3::ZERO, |ray| ray.o), footprint, of_pass }
    }

    /// The maps of a pass.
    fn progressive(&self, radius: Radius, batch: PhotonBatch, threads: usize) -> Maps {
        let PhotonBatch { photons, in_media, beams, beam_paths, photons_beside_beams, .. } = batch;
        let world = self.world();
        let photons_per_beam = photons_beside_beams as f32 / beams.len().max(1) as f32;
        let searches = self.view.size.map(u64::from).into_iter().product();
        let beams = (!beams.is_empty()).then(|| {
            BeamMap::new(beams, beam_paths, self.search_radius(radius.disk), 2.0 * world.radius, searches)
        });
        let in_media = InMedia { photons: PhotonMap::new(in_media, threads), beams, photons_per_beam };
        Maps::Progressive { indirect: PhotonMap::new(photons, threads), in_media, radius }
    }
}

/// The maps that all samples share.
fn fixed(usage: PhotonMapUse, batch: PhotonBatch, threads: usize) -> Maps {
    let [all, caustics] = match usage {
        PhotonMapUse::Caustics => [Vec::new(), batch.photons],
        _ => [batch.photons, batch.caustics],
    };
    let [all, caustics, in_media] = [all, caustics, batch.in_media]
        .map(|photons| PhotonMap::new(photons, threads).for_nearest(NEIGHBOURS));
    Maps::Fixed { usage, all, caustics, in_media }
}

impl Integrator for PhotonMapping<'_> {
    /// A path without photons, as path tracing follows it.
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.paths.observe(ctx, pixel, raster, observer)
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        Some(if self.settings.usage.is_some() { SamplesPerState::All } else { SamplesPerState::ONE })
    }

    fn with_state<'a>(&'a self, k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let wavelengths = self.view.wavelengths_of_pass(setup.seed ^ WAVELENGTH_SALT, k);
        let shutter = self.shutter(k, setup.seed);
        let (maps, rays, notes) = self.maps(k, shutter, &wavelengths, setup)?;
        let has_emissive_media = self.view.scene.appearance.has_emissive_media();
        let (view, settings) = (self.view.clone().at_moment(shutter.common()), self.settings);
        let integrator = Photons { view, settings, shutter, maps, wavelengths, has_emissive_media };
        Ok(WithState { integrator: Box::new(integrator), rays, notes })
    }
}

impl Integrator for Photons<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let view = &self.view;
        let mut draws = ctx.draws;
        let start = draws;
        let Some(ray) = view.ray(raster, &mut draws) else { return PixelSample::default() };
        // Wavelengths are the photons'.
        draws.skip(1);
        let wavelengths = self.wavelengths;
        let (media, time) = (view.media_around(&ray, &wavelengths), ray.time);
        let mut state = PathState::new(ray, wavelengths, Spectrum::WHITE, Transport::Radiance, media, draws);
        observer.counters().camera += 1;
        let footprint = view.footprint(&ray, raster, start).unwrap_or_default();
        let scratch = std::mem::take(ctx.scratch.get::<GatherScratch>());
        let mut gatherer = Gatherer::new(self, time, observer, footprint, scratch);
        if view.scene.has_media() {
            let u = state.draws.next_1d();
            state.carry_media(LaneMis::new(&wavelengths, u).hero);
            gatherer.run::<WithMedia<'_>>(Subpath::from_camera(PathState { connectable: true, ..state }));
        } else {
            gatherer.run::<NoMedia>(Subpath::from_camera(PathState { connectable: true, ..state }));
        }
        let Gatherer { radiance, first, begins_in_medium, albedo, scratch, .. } = gatherer;
        *ctx.scratch.get::<GatherScratch>() = scratch;
        if view.wants_albedo() {
            ctx.aux.albedo = in_white_light(albedo.unwrap_or(Spectrum::BLACK), &wavelengths);
        }
        let first = first.filter(|_| !begins_in_medium);
        PixelSample { radiance, first: first.map(|at| view.first_hit(&at, &mut ctx.aux)) }
    }
}

#[cfg(test)]
mod tests;
