//! Questions about one place of a picture: what is there, and where its light comes from.
//!
//! Both are answered by the renderer itself. [`pick`] casts the camera's ray through the place; [`debug_ray`] takes
//! one sample there and keeps every ray of it. The sample is the one that a render with the same settings takes,
//! except that its place in the picture is given: all other random numbers are those of the pixel's sample of
//! that index. The contributions of its segments add up to its radiance.
//!
//! Integrators may prepare what many samples share, such as photon maps, records of irradiance, paths from lights that
//! are merged with, or which lights arrive. Debug rays show samples with all of that: [`DebugRays`] prepares it with
//! the first ray and keeps it for all further ones, and a [`Prober`] does so in a thread of its own. Only Metropolis
//! light transport shows something else than it renders with, an independent sample of the integrator whose samples its
//! chains mutate: what a chain adds to the picture belongs to no pixel.

mod prober;

use kajo_core::scene::Scene;
use kajo_math::{DVec2, Vec2, Vec3};
use kajo_render::state::States;
use kajo_render::{
    Layer, LayerSet, PixelIntegrator, Progress, RayCounters, SampleContext, Silent, position_of,
};

use crate::{CameraPose, RenderSettings, Resources};
pub use kajo_core::curved_light::ConservedQuantity;
pub use kajo_render::SetupError;
pub use kajo_render::trail::{LightSource, RayKind, Segment, TrailHit};
pub use prober::{ProbeSubject, Prober};

/// What is seen at a place of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Pick {
    /// Number of the object in the id layers, counted from 1.
    pub object: u32,
    /// Number of the material in the id layers, counted from 1; 0 for one that came with a mesh.
    pub material: u32,
    /// Distance along the camera's ray.
    pub t: f32,
    /// World-space point.
    pub point: Vec3,
    /// Unit shading normal, outward.
    pub normal: Vec3,
    /// Coordinates on the surface.
    pub uv: Vec2,
    /// The word that makes the object, such as `Sphere`.
    pub keyword: &'static str,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Number of the text's item that describes the object; see [`kajo_scene::SceneDesc::item`].
    pub described_by: u32,
    /// Number of the item that puts it into the scene: the same, or the outermost instance.
    pub placed_by: u32,
}

/// What the camera sees through a place of a picture of `size` pixels; `None` when nothing is there.
///
/// * `position`: in pixels, counted from the top left corner; the middle of the first pixel is (0.5, 0.5)
///
/// Through a lens one looks by its middle, and at things that move when the shutter opens. What moves nearly as fast as light is where it is
/// at the moment 0 of the world, which is what previews draw, and not where it is seen.
pub fn pick(scene: &Scene, camera: &CameraPose, position: DVec2, size: [u32; 2]) -> Option<Pick> {
    let ray = camera.ray(position, size)?;
    let (at, point) = scene.trace_snapshot(&ray)?;
    let words = scene.geometry.object(at.object)?;
    Some(Pick {
        object: at.object.number(),
        material: scene.appearance.number(at.material),
        t: at.hit.t,
        point: point.p,
        normal: point.n,
        uv: scene.geometry.uv(&at),
        keyword: words.keyword,
        name: words.name.map(str::to_owned),
        described_by: words.described_by,
        placed_by: words.placed_by,
    })
}

/// All rays of one sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DebugRay {
    /// The rays, each after the one that it starts from.
    pub segments: Vec<Segment>,
    /// How many more there were than are kept.
    pub left_out: usize,
    /// Radiance of the sample, linear RGB: the sum of all contributions.
    pub radiance: [f32; 3],
    /// Rays by kind.
    pub rays: RayCounters,
}

impl DebugRay {
    /// The segments from the camera to the one of this index, which is the last.
    pub fn way_to(&self, segment: usize) -> Vec<usize> {
        let mut way = Vec::new();
        let mut next = Some(segment);
        while let Some((index, segment)) = next.and_then(|index| Some((index, self.segments.get(index)?))) {
            way.push(index);
            next = segment.parent.map(|parent| parent as usize);
        }
        way.reverse();
        way
    }
}

/// Follows the light of one sample through a place of the picture, and prepares what the integrator needs for that alone; see [`DebugRays`].
///
/// * `position`: as in [`pick`]
/// * `index`: which of the pixel's samples to take the random numbers of
///
/// # Errors
/// [`SetupError`] where the integrator cannot be prepared.
pub fn debug_ray(
    scene: &Scene,
    settings: &RenderSettings,
    camera: &CameraPose,
    position: DVec2,
    index: u32,
) -> Result<DebugRay, SetupError> {
    DebugRays::new(scene, settings, camera).shooter().shoot(position, index, &Resources::default(), &Silent)
}

/// What debug rays of a scene with the same settings through the same camera share.
pub struct DebugRays<'a> {
    integrator: Box<dyn PixelIntegrator + 'a>,
    settings: RenderSettings,
}

impl<'a> DebugRays<'a> {
    /// Nothing is prepared yet.
    pub fn new(scene: &'a Scene, settings: &RenderSettings, camera: &'a CameraPose) -> DebugRays<'a> {
        let layers = LayerSet::of(&[Layer::Color]);
        let integrator = crate::render::integrator(scene, camera.camera(), settings, layers);
        DebugRays { integrator, settings: *settings }
    }

    /// Whether the first ray may take long, since the integrator prepares something.
    pub fn need_state(&self) -> bool {
        self.integrator.trails_need_state()
    }

    /// Shoots rays one after the other.
    pub fn shooter(&self) -> DebugShooter<'_> {
        DebugShooter { rays: self, states: States::new(&*self.integrator) }
    }
}

/// Shoots debug rays, and keeps what the integrator has prepared for the last one.
pub struct DebugShooter<'i> {
    rays: &'i DebugRays<'i>,
    states: States<'i, dyn PixelIntegrator + 'i>,
}

impl DebugShooter<'_> {
    /// Follows the light of one sample through a place of the picture.
    ///
    /// * `position`, `index`: as for [`debug_ray`]
    /// * `resources`: threads and memory for what is prepared
    /// * `progress`: is told how much of it is done, and may end it
    ///
    /// # Errors
    /// [`SetupError`] where it cannot be prepared, or was ended.
    pub fn shoot(
        &mut self,
        position: DVec2,
        index: u32,
        resources: &Resources,
        progress: &dyn Progress,
    ) -> Result<DebugRay, SetupError> {
        let DebugRays { integrator, settings } = self.rays;
        let sampler = settings.sampler();
        let with_state = if integrator.trails_need_state() {
            let setup = crate::render::schedule(settings, resources);
            let position = position_of(&sampler, index);
            self.states.at(position, &setup.setup(progress), &mut RayCounters::default())?
        } else {
            None
        };
        let mut ctx = SampleContext::new(&sampler, settings.seed);
        let [width, height] = settings.size;
        let pixel = [position.x as u32, position.y as u32];
        let pixel = [pixel[0].min(width.saturating_sub(1)), pixel[1].min(height.saturating_sub(1))];
        ctx.begin(pixel, index);
        let (sample, trail) = with_state.unwrap_or(&**integrator).trail(&mut ctx, pixel, position.as_vec2());
        Ok(DebugRay {
            segments: trail.segments().to_vec(),
            left_out: trail.left_out(),
            radiance: sample.radiance,
            rays: trail.counters(),
        })
    }
}

#[cfg(test)]
mod tests;
