//! Ambient occlusion: how open the surroundings of a surface are.
//!
//! ```text
//! L = 1/pi  integral over the hemisphere of  V(w) cos  dw
//! ```
//!
//! with `V` 1 where nothing is nearer than a given distance along `w`. One direction a sample, drawn by the
//! cosine, so that the estimate is the mean of `V` [Zhukov et al. 1998].

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::RayOffset;
use kajo_core::bsdf::Transport;
use kajo_core::camera::Camera;
use kajo_core::scene::Scene;
use kajo_core::settings::{IntegratorName, Settings, SettingsKey};
use kajo_math::{Frame, Vec2, warp};

use super::camera_view::CameraView;
use super::transport::{Event, PathState, SurfaceInteraction, advance, connect};
use super::{Integrator, IntegratorSettings, IntegratorSpec, Prepare, Quantity};
use crate::trail::{About, PathObserver, RayKind};
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext};

/// Options of [`AmbientOcclusion`].
#[derive(Clone, Copy, Debug)]
pub struct AmbientOcclusionSettings {
    /// Distance beyond which nothing hides the light; may be infinite.
    pub reach: f32,
}

/// Ambient occlusion.
pub const OCCLUSION: IntegratorSpec = IntegratorSpec {
    name: IntegratorName("occlusion"),
    about: "how open the surroundings of a surface are",
    quantity: Quantity::Geometry,
    splats: false,
    samples: 64,
    keys: &[SettingsKey::Reach],
    settings: |context| {
        let reach = context.said.reach.unwrap_or(f32::INFINITY);
        IntegratorSettings::AmbientOcclusion(AmbientOcclusionSettings { reach })
    },
};

impl Prepare for AmbientOcclusionSettings {
    fn prepare<'a>(
        self,
        scene: &'a Scene,
        camera: &'a Camera,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Box<dyn PixelIntegrator + 'a> {
        Box::new(AmbientOcclusion::through(camera, scene, self, size, layers))
    }

    fn values(&self) -> Settings {
        Settings { reach: Some(self.reach), ..Settings::default() }
    }

    fn left_out(&self, scene: &Scene, _size: [u32; 2]) -> Vec<&'static str> {
        (!scene.space().connects()).then_some(STRAIGHT).into_iter().collect()
    }
}

/// What it leaves out in scenes with bodies that bend light.
const STRAIGHT: &str = "occlusion rays go straight through bodies that bend light: of `occlusion` the camera's rays alone are bent";

/// The ambient occlusion integrator over one scene and one picture size.
pub struct AmbientOcclusion<'a> {
    view: CameraView<'a>,
    settings: AmbientOcclusionSettings,
}

impl<'a> AmbientOcclusion<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(
        scene: &'a Scene,
        settings: AmbientOcclusionSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> AmbientOcclusion<'a> {
        AmbientOcclusion::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: AmbientOcclusionSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> AmbientOcclusion<'a> {
        AmbientOcclusion { view: CameraView::new(scene, camera, size, layers), settings }
    }
}

impl Integrator for AmbientOcclusion<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let mut draws = ctx.draws;
        let scene = self.view.scene;
        let Some(ray) = self.view.ray(raster, &mut draws) else { return PixelSample::default() };
        draws.skip(1); // There are no wavelengths.
        observer.counters().camera += 1;
        let media = self.view.media_around(&ray, &Wavelengths::RGB);
        // The two numbers after these are those of the occlusion ray.
        let mut of_path = draws;
        of_path.skip(2);
        let mut path =
            PathState::new(ray, Wavelengths::RGB, Spectrum::WHITE, Transport::Radiance, media, of_path);
        let (mut surface, mut first) = (SurfaceInteraction::default(), None);
        let event = advance(scene, &mut path, &mut surface, &mut first, observer);
        // As of all integrators, it is the first surface, hidden or not, that the layers record.
        let first = first.map(|at| self.view.first_hit(&at, &mut ctx.aux));
        match event {
            Event::Surface => {}
            Event::Escaped(_) => {
                observer.found(|| [1.0; 3]);
                ctx.aux.lights[0] = [1.0; 3];
                return PixelSample { radiance: [1.0; 3], first };
            }
            Event::Medium(_) | Event::Absorbed => return PixelSample { first, ..PixelSample::default() },
        }
        let SurfaceInteraction { at, wo, .. } = surface;
        let n = if wo.dot(at.point.n) < 0.0 { -at.point.n } else { at.point.n };
        let wi = Frame::from_normal(n).to_world(warp::cosine_hemisphere(draws.next_2d()));
        let segment = at.point.ray_towards(wi, self.settings.reach, ray.time, RayOffset::Auto);
        // Occlusion rays go straight, also in bodies that bend light.
        let eta = path.media.eta();
        let about = || About { eta, weight: [1.0; 3], light: None };
        // Below the true surface of a shading normal there is only that surface.
        let below = wi.dot(at.point.ng) * wo.dot(at.point.ng) < 0.0;
        let open = if below {
            observer.counters().shadow += 1;
            0.0
        } else {
            connect(scene, &segment, Some(eta), &path.wavelengths, observer).luminance()
        };
        observer.joined(RayKind::Shadow, scene, &segment, about, || [open; 3]);
        ctx.aux.lights[0] = [open; 3];
        PixelSample { radiance: [open; 3], first }
    }
}
