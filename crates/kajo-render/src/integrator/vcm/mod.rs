//! Vertex connection and merging [Georgiev, Křivánek, Davidovič and Slusallek 2012]: light from both ends, and by way of vertices that lie
//! close together.
//!
//! Each sample of a pixel does what the bidirectional integrator does. Besides, before sample `i` of all pixels is taken, `N` paths are
//! followed from lights and their vertices are kept; the camera's paths take those in disks around their own vertices, weighed
//! against all connections. So caustics in mirrors are found, which no connection finds, and where connections are good they are
//! preferred. See `bidir/merge.rs` for estimate and weights.
//!
//! The disks of pass `i = 1, 2, ...` have the radius
//!
//! ```text
//! r_i = r_1 i^((alpha - 1)/2)                                              [Georgiev et al. 2012]
//! ```
//!
//! and balls in media `2 r_1 i^((alpha - 1)/3)`, so their blur goes to nothing. With `alpha = 3/4` it does as
//! `i^(-1/4)`, and the variance of the mean of merged light as `i^(-3/4)`.
//!
//! Without merging this is the bidirectional integrator, to the bit.

mod footprint;
mod settings;

use kajo_core::camera::Camera;
use kajo_core::light::BoundingSphere;
use kajo_core::scene::Scene;
use kajo_math::Vec2;

use super::Integrator;
use super::bidir::{
    Bidirectional, BidirectionalSettings, MergePass, Merging, NoMedia, ReusedVolume, WithMedia,
};
use super::camera_view::CameraView;
use crate::trail::PathObserver;
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext, SamplesPerState};
use crate::{Setup, SetupError, WithState};
pub use settings::{VCM, VertexMergingSettings};

/// Pixels from the middle of a disk of the first pass to its rim.
const FIRST_RADIUS: f32 = 2.5;

/// The most pixels there, where vertices are so sparse that wider disks would be needed to hold one.
const WIDEST_RADIUS: f32 = 10.0;

/// Radius of the balls of the first pass, in radii of its disks.
///
/// Squared error times seconds of a tank of water with a glass ball, lit from outside by a point: 0.31 with 1, 0.12
/// with 2. Balls are large because few paths scatter in thin media.
const FIRST_BALL: f32 = 2.0;

/// Parts of the shutter interval in the first pass, where things move.
const FIRST_MOMENTS: f32 = 16.0;

/// Sets wavelengths of passes apart from all other numbers.
const WAVELENGTH_SALT: u64 = 0x7663_6d6c_616d;

/// Vertex connection and merging over one scene and one picture size.
pub struct VertexMerging<'a, V = NoMedia> {
    connecting: Bidirectional<'a, V>,
    view: CameraView<'a>,
    settings: VertexMergingSettings,
    /// Radius of the disks of the first pass.
    first_radius: f32,
}

/// The integrator with the vertices of a pass.
struct Merged<'m, 'a, V> {
    connecting: &'m Bidirectional<'a, V>,
    merging: Merging,
}

/// The integrator for a scene: with media where it has any.
pub(super) fn integrator_of<'a>(
    camera: &'a Camera,
    scene: &'a Scene,
    settings: VertexMergingSettings,
    size: [u32; 2],
    layers: LayerSet,
) -> Box<dyn PixelIntegrator + 'a> {
    match scene.has_media() {
        false => Box::new(VertexMerging::<NoMedia>::made(camera, scene, settings, size, layers)),
        true => Box::new(VertexMerging::<WithMedia>::made(camera, scene, settings, size, layers)),
    }
}

impl<'a, V: ReusedVolume<'a>> VertexMerging<'a, V> {
    fn made(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: VertexMergingSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> VertexMerging<'a, V> {
        let VertexMergingSettings { bounces, light_choice, roulette, spectral, .. } = settings;
        let both =
            BidirectionalSettings { bounces, light_choice, roulette, spectral, only_from_lights: false };
        let view = CameraView::new(scene, camera, size, layers).spectral(spectral);
        let world = BoundingSphere::around(&scene.geometry.bounds());
        let first_radius = match settings.radius {
            _ if !settings.merging => 0.0,
            radius if radius > 0.0 => radius.min(world.radius),
            _ => automatic_radius(&view, settings.photons, &world),
        };
        let connecting = Bidirectional::made(camera, scene, both, size, layers);
        VertexMerging { connecting, view, settings, first_radius }
    }

    /// How vertices are merged in pass `k`.
    fn pass(&self, k: u32, seed: u64) -> MergePass {
        // [Georgiev et al. 2012]
        let share = f64::from(k + 1).powf(0.5 * (f64::from(self.settings.alpha) - 1.0)) as f32;
        // The volume of balls goes as the area of disks.
        let ball_share = f64::from(k + 1).powf((f64::from(self.settings.alpha) - 1.0) / 3.0) as f32;
        let moments = if self.view.scene.has_moving_things() { (FIRST_MOMENTS / share) as u32 } else { 1 };
        MergePass {
            k,
            paths: self.settings.photons,
            radius: self.first_radius * share,
            ball_radius: FIRST_BALL * self.first_radius * ball_share,
            moments,
            wavelengths: self.view.wavelengths_of_pass(seed ^ WAVELENGTH_SALT, k),
        }
    }
}

/// The radius of the first disks that suits a picture: some pixels, but so large that they hold a vertex or so, and not so
/// large that they blur the scene, or what the picture shows of it.
fn automatic_radius(view: &CameraView<'_>, paths: u32, world: &BoundingSphere) -> f32 {
    // Spread evenly over the sphere around the scene, about one vertex would lie in the smallest disk.
    let least = world.radius * (4.0 / paths as f32).sqrt().min(0.01);
    let most = least.max(0.01 * world.radius);
    let radius = match footprint::median(view) {
        Some(pixel) => (FIRST_RADIUS * pixel).clamp(least, most).min(WIDEST_RADIUS * pixel),
        None => most,
    };
    radius.max(f32::MIN_POSITIVE)
}

impl<'v, V: ReusedVolume<'v>> Integrator for VertexMerging<'v, V> {
    /// A sample without merging, all there is where merging is off.
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.connecting.observe_merging(ctx, raster, None, observer)
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        self.settings.merging.then_some(SamplesPerState::ONE)
    }

    fn with_state<'a>(&'a self, k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let (merging, rays) = self.connecting.merging(self.pass(k, setup.seed), setup)?;
        let notes = match k == 0 && merging.is_empty() {
            true if rays.light == 0 => "there is no light in the scene that paths could begin at".to_owned(),
            true => "no path from a light came to where it can be merged: surfaces are mirrors or clear, and media not behind such; \
                 `integrator bidirectional` finds the same picture sooner"
                .to_owned(),
            false => return Ok(self.with_merging(merging, rays, Vec::new())),
        };
        Ok(self.with_merging(merging, rays, vec![notes]))
    }
}

impl<'a, V: ReusedVolume<'a>> VertexMerging<'a, V> {
    fn with_merging(&self, merging: Merging, rays: crate::RayCounters, notes: Vec<String>) -> WithState<'_> {
        WithState { integrator: Box::new(Merged { connecting: &self.connecting, merging }), rays, notes }
    }
}

impl<'v, V: ReusedVolume<'v>> Integrator for Merged<'_, 'v, V> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.connecting.observe_merging(ctx, raster, Some(&self.merging), observer)
    }
}

#[cfg(test)]
mod convergence_tests;
#[cfg(test)]
mod tests;
