//! Path tracing [Kajiya 1986].
//!
//! The radiance along a camera ray is the integral over all paths `x0 x1 ... xn` from the camera to a light,
//!
//! ```text
//! L = sum over n of the integral of  Le(xn) product over k of f(xk) |cos k| T(xk, xk+1)  over directions dw1 .. dwn
//! ```
//!
//! estimated by one path that is prolonged by the surfaces' own scattering, each direction with a density `p` per solid
//! angle. The throughput is the product so far,
//!
//! ```text
//! beta <- beta f |cos| / p
//! ```
//!
//! and all light that the path hits is added with it. At every surface the light of one light is
//! added as well, drawn by what it may contribute. A light that scattering hits and one that was sampled are two
//! estimates of the same light; each counts with the weight `p^2 / (p^2 + q^2)` of its density against the other's
//! [Veach and Guibas 1995]. Paths that carry little end at random, and the survivors count more [Arvo and
//! Kirk 1990].
//!
//! Distribution ray tracing [Cook et al. 1984] splits the path at the first vertex `x` that is not specular into `n`
//! branches. Each of them samples a direction by the non-specular lobes of `x` with numbers that are spread over all
//! branches of the pixel, and the sum of their light is estimated by the mean,
//!
//! ```text
//! L(x, wo) = 1/n sum over k = 1 .. n  of  (f |cos| / p)_k L_k      +  specular lobes, by one more branch of weight 1
//! ```
//!
//! so each begins with `beta / n`, and direct light at `x` is sampled once. Direct light alone (`direct`) is the same
//! sum over paths, cut where a path would go on from a vertex that is not specular: such a vertex keeps its next-event
//! estimation and the emission that its scattering hits, with their weights.
//!
//! A vertex at which a path splits is an entry in a list of what remains to be followed, so a path of any depth takes no more stack than one
//! of none.
//!
//! In spectral mode the path carries four wavelengths; where its direction comes to depend on the first of them
//! the others end.

mod directions;
mod guiding;
mod learned;
mod relativistic;
mod settings;
mod tracer;

use std::mem;

use kajo_color::Spectrum;
use kajo_core::bsdf::Transport;
use kajo_core::camera::Camera;
use kajo_core::light::{LightChoice, LightSelection, LightVisibility};
use kajo_core::scene::Scene;
use kajo_core::settings::Directions;
use kajo_math::Vec2;

use super::Integrator;
use super::camera_view::{CameraView, in_white_light};
use super::transport::{LaneMis, PathState};
use crate::context::emptied;
use crate::trail::PathObserver;
use crate::{LayerSet, PixelSample, SampleContext, SamplesPerState, Setup, SetupError, WithState};
pub use guiding::GuidedPath;
pub use relativistic::RelativisticPath;
pub(super) use settings::WITHOUT_WALKS;
pub use settings::{DIRECT, DISTRIBUTION, PATH, PathSettings};
pub(super) use tracer::{
    CameraPath, DiffuseVertex, GuidedDirection, Indirect, IndirectLight, PathTracer, Worth,
};
use tracer::{Casters, Fork, Sampled, ThroughGlass};

/// The path tracer over one scene and one picture size.
pub struct Path<'a> {
    view: CameraView<'a>,
    settings: PathSettings,
    /// Whether there are any media.
    carries_media: bool,
}

impl<'a> Path<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(scene: &'a Scene, settings: PathSettings, size: [u32; 2], layers: LayerSet) -> Path<'a> {
        Path::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: PathSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Path<'a> {
        let carries_media = scene.has_media();
        Path {
            carries_media,
            view: CameraView::new(scene, camera, size, layers).spectral(settings.spectral),
            settings,
        }
    }
}

/// The path tracer with lights drawn that stand behind glass; see `tracer/caustics.rs`.
pub struct ManifoldPath<'a> {
    path: Path<'a>,
    casters: Casters,
}

impl<'a> ManifoldPath<'a> {
    /// The integrator through a camera of its own.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: PathSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> ManifoldPath<'a> {
        let path = Path::through(camera, scene, settings, size, layers);
        ManifoldPath { path, casters: Casters::of(scene) }
    }
}

impl Integrator for ManifoldPath<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.path.observe_with(ctx, raster, observer, ThroughGlass::new(&self.casters)).0
    }
}

/// The path tracer for a scene: another one where something moves nearly as fast as light.
fn integrator_of<'a>(
    camera: &'a Camera,
    scene: &'a Scene,
    settings: PathSettings,
    size: [u32; 2],
    layers: LayerSet,
) -> Box<dyn crate::PixelIntegrator + 'a> {
    match scene.relativity.as_deref() {
        None if settings.walks_in(scene) => {
            Box::new(ManifoldPath::through(camera, scene, settings, size, layers))
        }
        None if settings.is_guided() => Box::new(GuidedPath::through(camera, scene, settings, size, layers)),
        None => Box::new(Path::through(camera, scene, settings, size, layers)),
        Some(all) => Box::new(RelativisticPath::new(camera, scene, all, settings, size, layers)),
    }
}

impl Integrator for Path<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.observe_with(ctx, raster, observer, Sampled).0
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        self.learns_lights().then_some(SamplesPerState::All)
    }

    /// What is learned changes no mean.
    fn noise_is_known(&self) -> bool {
        true
    }

    fn with_state<'a>(&'a self, _k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        learned::prepare(self, setup)
    }
}

impl Path<'_> {
    /// As [`Integrator::observe`], with a source of indirect light, which is returned.
    pub(super) fn observe_with<O: PathObserver, C: IndirectLight>(
        &self,
        ctx: &mut SampleContext<'_>,
        raster: Vec2,
        observer: &mut O,
        indirect: C,
    ) -> (PixelSample, C) {
        self.observe_choosing(ctx, raster, observer, indirect, self.settings.light_selection())
    }

    /// The same with another choice of lights than that of the settings.
    fn observe_choosing<O: PathObserver, C: IndirectLight>(
        &self,
        ctx: &mut SampleContext<'_>,
        raster: Vec2,
        observer: &mut O,
        indirect: C,
        lights: LightSelection<'_>,
    ) -> (PixelSample, C) {
        let mut draws = ctx.draws;
        let differential = self.view.differential(raster, draws, ctx.sampler.samples());
        let Some(ray) = self.view.ray(raster, &mut draws) else { return (PixelSample::default(), indirect) };
        let wavelengths = self.view.wavelengths(&mut draws);
        let media = self.view.media_around(&ray, &wavelengths);
        let state = PathState::new(ray, wavelengths, Spectrum::WHITE, Transport::Radiance, media, draws);
        let mut path = CameraPath::new(state, &self.settings);
        path.state.differential = differential;
        if self.carries_media {
            path.state.carries_media = true;
            path.state.lanes = LaneMis::new(&wavelengths, path.state.draws.next_1d());
        }
        observer.counters().camera += 1;
        let room = C::GUIDES || self.forks();
        let forks = room.then(|| mem::take(ctx.scratch.get::<Vec<Fork<'static, O::Mark>>>()));
        let forks = forks.map_or_else(Vec::new, emptied);
        let mut tracer =
            PathTracer::new(&self.view, &self.settings, observer, indirect, forks).choosing(lights);
        let (radiance, found) = tracer.run(path);
        if self.view.wants_albedo() {
            ctx.aux.albedo = in_white_light(found.albedo.unwrap_or(Spectrum::BLACK), &wavelengths);
        }
        if let Some(groups) = found.groups {
            ctx.aux.lights = groups;
        }
        let first = found.first.as_ref().map(|at| self.view.first_hit(at, &mut ctx.aux));
        let (forks, indirect) = tracer.into_parts();
        if room {
            *ctx.scratch.get::<Vec<Fork<'static, O::Mark>>>() = emptied(forks);
        }
        (PixelSample { radiance, first }, indirect)
    }

    /// Whether lights are chosen by what is learned to arrive.
    fn learns_lights(&self) -> bool {
        let is_choice = self.view.scene.lighting.sampler.len() > 1;
        is_choice && self.settings.light_choice == LightChoice::Learned
    }

    /// How lights are chosen, with what is known of those that arrive.
    fn lights_by<'v>(&self, visibility: Option<&'v LightVisibility>) -> LightSelection<'v> {
        let learned = |visibility| self.settings.selection(LightSelection::Learned(visibility));
        visibility.map_or(self.settings.light_selection(), learned)
    }

    /// Whether paths ever fork.
    fn forks(&self) -> bool {
        self.settings.branches > 1 || self.settings.directions != Directions::Scattering
    }
}

#[cfg(test)]
mod caustics_tests;
#[cfg(test)]
mod colored_phase_tests;
#[cfg(test)]
mod curved_tests;
#[cfg(test)]
mod emission_tests;
#[cfg(test)]
mod lens_tests;
#[cfg(test)]
mod media_tests;
#[cfg(test)]
mod random_walk_tests;
#[cfg(test)]
mod relativistic_tests;
#[cfg(test)]
mod star_tests;
#[cfg(test)]
mod subsurface_tests;
#[cfg(test)]
mod tests;
