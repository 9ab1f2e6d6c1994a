//! Ambient occlusion: how open the surroundings of a surface are.
//!
//! ```text
//! L = 1/pi  integral over the hemisphere of  V(w) cos  dw
//! ```
//!
//! with `V` 1 where nothing is nearer than a given distance along `w`. One direction a sample, drawn by the
//! cosine, so that the estimate is the mean of `V` [Zhukov et al. 1998].

use kajo_color::Wavelengths;
use kajo_core::RayOffset;
use kajo_core::camera::Camera;
use kajo_core::scene::{Event, Scene};
use kajo_math::{Frame, Vec2, warp};

use super::view::View;
use crate::trail::{About, Counting, RayKind, Witness};
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext, Trail};

/// The ambient occlusion integrator over one scene and one picture size.
pub struct AmbientOcclusion<'a> {
    view: View<'a>,
    reach: f32,
}

impl<'a> AmbientOcclusion<'a> {
    /// * `reach`: distance beyond which nothing hides the light; may be infinite
    pub fn new(scene: &'a Scene, reach: f32, size: [u32; 2], layers: LayerSet) -> AmbientOcclusion<'a> {
        AmbientOcclusion { view: View::new(scene, size, layers), reach }
    }

    /// The same through another camera than the scene's.
    pub fn through(self, camera: &'a Camera) -> AmbientOcclusion<'a> {
        AmbientOcclusion { view: self.view.through(camera), ..self }
    }
}

impl AmbientOcclusion<'_> {
    fn cast<W: Witness>(&self, ctx: &mut SampleContext<'_>, raster: Vec2, witness: &mut W) -> PixelSample {
        let mut draws = ctx.draws;
        let scene = self.view.scene;
        let Some(ray) = self.view.ray(raster, &mut draws) else { return PixelSample::default() };
        draws.skip(1); // There are no wavelengths.
        witness.counters().camera += 1;
        let end = scene.trace(&ray);
        let about = || About { eta: 1.0, weight: [1.0; 3], light: None };
        witness.ended(scene, &ray, end.surface(), about);
        let Event::Surface(at) = end else {
            witness.found(|| [1.0; 3]);
            ctx.aux.lights[0] = [1.0; 3];
            return PixelSample { radiance: [1.0; 3], first: None };
        };
        let towards_viewer = if ray.d.dot(at.point.n) > 0.0 { -at.point.n } else { at.point.n };
        let wi = Frame::from_normal(towards_viewer).to_world(warp::cosine_hemisphere(draws.next_2d()));
        witness.counters().shadow += 1;
        // Below the true surface of a shading normal there is only that surface.
        let below = wi.dot(at.point.ng) * ray.d.dot(at.point.ng) > 0.0;
        let shadow = at.point.ray_towards(wi, self.reach, ray.time, RayOffset::Auto);
        let open = if below { 0.0 } else { scene.visibility(&shadow, &Wavelengths::RGB, 1.0).luminance() };
        witness.joined(RayKind::Shadow, scene, &shadow, about, || [open; 3]);
        ctx.aux.lights[0] = [open; 3];
        PixelSample { radiance: [open; 3], first: Some(self.view.first_hit(&at, &mut ctx.aux)) }
    }
}

impl PixelIntegrator for AmbientOcclusion<'_> {
    fn sample(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let mut counting = Counting::new(ctx);
        let sample = self.cast(ctx, raster, &mut counting);
        ctx.rays = counting.rays;
        sample
    }

    fn trail(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> (PixelSample, Trail) {
        let mut trail = Trail::default();
        (self.cast(ctx, raster, &mut trail), trail)
    }
}
