//! A picture with its time, straight from the renderer, without files.

use kajo_core::sampler::Sampler;
use kajo_core::scene::Scene;
use kajo_image::Image;
use kajo_render::integrator::Prepare;
use kajo_render::{Film, FilmSpec, Layer, LayerSet, RayCounters, Silent};

use super::time::{Seconds, timed};
use kajo::RenderSettings;

/// What a render made, and how long it took.
pub struct Timed {
    /// Linear colours.
    pub image: Image,
    pub rays: RayCounters,
    pub seconds: Seconds,
}

impl Timed {
    /// Mean red, green and blue.
    pub fn mean(&self) -> [f64; 3] {
        let pixels = self.image.rgb_pixels();
        let n = pixels.len().max(1) as f64;
        let add = |[r, g, b]: [f64; 3], p: [f32; 3]| {
            [r + f64::from(p[0]), g + f64::from(p[1]), b + f64::from(p[2])]
        };
        pixels.fold([0.0; 3], add).map(|sum| sum / n)
    }
}

/// Renders colours with each of `samplers` in turn into one film, on `threads` threads; a pixel is the
/// average of all samples.
///
/// The text says why there is no picture, which can only be a size that does not fit into memory.
pub fn render(
    scene: &Scene,
    settings: &RenderSettings,
    samplers: &[Sampler],
    threads: usize,
) -> Result<Timed, String> {
    let [width, height] = settings.size;
    let layers = LayerSet::of(&[Layer::Color]);
    let spec = FilmSpec { layers, one_pass: samplers.len() == 1, ..FilmSpec::new(width, height) };
    let work = || {
        let integrator =
            settings.integrator_settings.prepare(scene, &scene.output.camera, settings.size, layers);
        let film = Film::new(spec, u64::MAX).map_err(|error| error.to_string())?;
        let mut rays = RayCounters::default();
        for sampler in samplers.iter().cloned() {
            let schedule = kajo_render::RenderSettings {
                seed: settings.seed,
                threads,
                ..kajo_render::RenderSettings::new(sampler)
            };
            let stats = kajo_render::render(&*integrator, &film, &schedule, &Silent)
                .map_err(|error| error.to_string())?;
            rays += stats.rays;
        }
        let image = film.develop(Layer::Color).ok_or("the film holds no colour")?;
        Ok::<_, String>((image, rays))
    };
    let (result, seconds) = timed(work);
    let (image, rays) = result?;
    Ok(Timed { image, rays, seconds })
}
