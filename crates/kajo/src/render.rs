//! From a scene to a picture.

use kajo_core::scene::Scene;
use kajo_core::settings::Shadows;
use kajo_image::{BitDepth, Format, ImageError};
use kajo_render::integrator::{Classic, ClassicSettings};
use kajo_render::{
    Film, FilmError, FilmSpec, Layer, LayerSet, Progress, RenderError as PassError, RenderStats,
};

use crate::view::{self, View};
use crate::{RenderSettings, memory};

/// What may be used up, and in which pieces; none of it changes a bit of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Resources {
    /// Threads; 0 for one on each core.
    pub threads: usize,
    /// Side of a tile in pixels; 0 for the default.
    pub tile: u32,
    /// Bytes that a picture may take; `None` for what the system has left.
    pub memory: Option<u64>,
}

/// A rendered picture, with all that was asked for.
#[derive(Debug)]
pub struct Picture {
    film: Film,
    settings: RenderSettings,
    /// Rays, samples and time.
    pub stats: RenderStats,
}

/// Why there is no picture, or only a part of one.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The size or the filter makes no sense.
    #[error(transparent)]
    Film(FilmError),
    /// It would take more memory than there is.
    #[error(
        "a picture of {width} x {height} with these outputs needs {}, and {} can be had; ask for a smaller one",
        in_words(*needed), in_words(u128::from(*budget))
    )]
    Memory {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes needed.
        needed: u128,
        /// Bytes allowed.
        budget: u64,
    },
    /// [`Progress::cancelled`] said so. The picture holds what was rendered.
    #[error("the render was interrupted")]
    Cancelled(Box<Picture>),
    /// Some tiles failed because of a bug; this says which and how.
    #[error("{0}")]
    Panicked(String),
}

/// Renders `scene`, recording what files of these views and formats need.
///
/// The picture has the same bits whatever `resources` says.
///
/// # Errors
/// [`RenderError`]; the size is checked before anything is allocated.
pub fn render(
    scene: &Scene,
    settings: &RenderSettings,
    outputs: &[(View, Format)],
    resources: &Resources,
    progress: &dyn Progress,
) -> Result<Picture, RenderError> {
    let layers = layers(outputs, settings);
    let spec = film_spec(scene, settings, layers);
    check_memory(&spec, resources)?;
    let film = Film::new(spec, u64::MAX).map_err(RenderError::Film)?;
    let integrator = Classic::new(scene, light_settings(settings, layers), settings.size, layers);
    let schedule = kajo_render::RenderSettings {
        sampler: settings.sampler(),
        seed: settings.seed,
        threads: resources.threads,
        tile: resources.tile,
    };
    let result = kajo_render::render(&integrator, &film, &schedule, progress);
    let picture = |stats| Picture { film, settings: *settings, stats };
    match result {
        Ok(stats) => Ok(picture(stats)),
        Err(PassError::Cancelled(stats)) => Err(RenderError::Cancelled(Box::new(picture(stats)))),
        Err(error @ PassError::Panicked { .. }) => Err(RenderError::Panicked(error.to_string())),
    }
}

impl Picture {
    /// The bytes of a file that shows `views`; only OpenEXR can show more than one.
    ///
    /// # Errors
    /// When a view was not asked for in [`render`], or the format cannot hold the picture.
    pub fn encode(&self, views: &[View], format: Format, depth: BitDepth) -> Result<Vec<u8>, ImageError> {
        view::encode(&self.film, views, format, depth, &self.settings)
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.settings.size
    }
}

fn layers(outputs: &[(View, Format)], settings: &RenderSettings) -> LayerSet {
    let mut layers: Vec<Layer> = outputs.iter().map(|(view, format)| view.layer(*format, settings)).collect();
    if layers.is_empty() {
        // Somebody wants to know how long it takes.
        layers.push(Layer::Color);
    }
    LayerSet::of(&layers)
}

fn film_spec(scene: &Scene, settings: &RenderSettings, layers: LayerSet) -> FilmSpec {
    let [width, height] = settings.size;
    let cell = match scene.camera.cells() {
        [1, 1] => None,
        [columns, rows] => Some([width.div_ceil(columns), height.div_ceil(rows)]),
    };
    FilmSpec {
        cell,
        filter: settings.filter,
        layers,
        depth_map: settings.depth_map(),
        normal_map: settings.normal_map(),
        one_pass: true,
        ..FilmSpec::new(width, height)
    }
}

/// Depth and normals are those of the first surface, so that without colour nothing further is followed.
fn light_settings(settings: &RenderSettings, layers: LayerSet) -> ClassicSettings {
    match layers.has(Layer::Color) {
        true => settings.classic,
        false => ClassicSettings { bounces: 0, shadows: Shadows::Off, ..settings.classic },
    }
}

/// Makes sure that the film and the largest of its pictures, while it is encoded, fit.
fn check_memory(spec: &FilmSpec, resources: &Resources) -> Result<(), RenderError> {
    /// Three floats, and up to four channels of two bytes each before and after compression.
    const BYTES_TO_ENCODE_A_PIXEL: u128 = 3 * 4 + 2 * 8;
    let FilmSpec { width, height, .. } = *spec;
    let budget = resources.memory.unwrap_or_else(memory::available);
    let needed = spec.bytes() + u128::from(width) * u128::from(height) * BYTES_TO_ENCODE_A_PIXEL;
    if needed > u128::from(budget) {
        return Err(RenderError::Memory { width, height, needed, budget });
    }
    Ok(())
}

/// 1536 as "1.5 kB".
fn in_words(bytes: u128) -> String {
    const UNITS: [&str; 6] = ["kB", "MB", "GB", "TB", "PB", "EB"];
    let mut amount = bytes as f64 / 1000.0;
    let mut unit = 0;
    while amount >= 1000.0 && unit + 1 < UNITS.len() {
        amount /= 1000.0;
        unit += 1;
    }
    format!("{amount:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Defaults, LoadOptions, MemoryAssets, Silent, load_from};
    use kajo_core::settings::Settings;

    fn ball() -> Scene {
        let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n\
                    Materials { Material { diffuseColor 1 0.5 0 } }\n\
                    Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 } }";
        let loaded =
            load_from("ball.txt", &MemoryAssets::new().with("ball.txt", text), &LoadOptions::default());
        assert!(loaded.scene.is_some(), "{}", loaded.report(false));
        loaded.scene.unwrap()
    }

    fn settings(scene: &Scene, size: [u32; 2]) -> RenderSettings {
        let asked = Settings { size: Some(size), ..Settings::default() };
        RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap()
    }

    #[test]
    fn every_view_fits_every_format() {
        let scene = ball();
        let settings = settings(&scene, [9, 7]);
        for format in Format::ALL {
            let outputs = View::ALL.map(|view| (view, format));
            let picture = render(&scene, &settings, &outputs, &Resources::default(), &Silent).unwrap();
            for view in View::ALL {
                let bytes = picture.encode(&[view], format, BitDepth::Eight).unwrap();
                let image = kajo_image::decode(&bytes, Some(format), &kajo_image::DecodeLimits::default())
                    .unwrap()
                    .image;
                assert_eq!((image.width(), image.height()), (9, 7), "{view:?} as {format}");
                let background =
                    if view == View::Depth && format == Format::Exr { f32::INFINITY } else { 0.0 };
                let differs = image.pixel(0, 0) != image.pixel(4, 3);
                assert!(differs || view == View::Samples, "{view:?} as {format} shows the ball");
                if matches!(view, View::Depth | View::Object | View::Material) && format != Format::Pfm {
                    assert_eq!(image.pixel(0, 0)[0], background, "{view:?} as {format}");
                }
            }
        }
    }

    #[test]
    fn an_exr_file_holds_all_views() {
        let scene = ball();
        let outputs = View::ALL.map(|view| (view, Format::Exr));
        let picture =
            render(&scene, &settings(&scene, [4, 4]), &outputs, &Resources::default(), &Silent).unwrap();
        let bytes = picture.encode(&View::ALL, Format::Exr, BitDepth::Eight).unwrap();
        let file = kajo_image::exr::decode(&bytes, &kajo_image::DecodeLimits::default()).unwrap();
        let main = file.layer(None).unwrap();
        for channel in ["R", "G", "B", "Z"] {
            assert!(main.channel(channel).is_some(), "{channel}");
        }
        for (layer, channel) in
            [("N", "X"), ("uv", "U"), ("object", "id"), ("material", "id"), ("samples", "count")]
        {
            assert!(file.layer(Some(layer)).unwrap().channel(channel).is_some(), "{layer}.{channel}");
        }
    }

    #[test]
    fn other_files_hold_one_view() {
        let scene = ball();
        let outputs = [(View::Color, Format::Png), (View::Depth, Format::Png)];
        let picture =
            render(&scene, &settings(&scene, [4, 4]), &outputs, &Resources::default(), &Silent).unwrap();
        assert!(picture.encode(&[View::Color, View::Depth], Format::Png, BitDepth::Eight).is_err());
        assert!(picture.encode(&[View::Uv], Format::Png, BitDepth::Eight).is_err(), "not asked for");
    }

    #[test]
    fn pictures_beyond_memory_are_refused_at_once() {
        let scene = ball();
        let sizes = [[1_000_000_000, 1_000_000_000], [u32::MAX, u32::MAX]];
        for size in sizes {
            let result = render(
                &scene,
                &settings(&scene, size),
                &[(View::Color, Format::Png)],
                &Resources::default(),
                &Silent,
            );
            let error = result.unwrap_err();
            assert!(matches!(error, RenderError::Memory { .. }), "{error}");
            assert!(error.to_string().contains(" EB"), "{error}");
        }
        let small = Resources { memory: Some(1000), ..Resources::default() };
        let result = render(&scene, &settings(&scene, [100, 100]), &[], &small, &Silent);
        assert!(matches!(result, Err(RenderError::Memory { budget: 1000, .. })));
    }

    #[test]
    fn a_cancelled_render_keeps_what_it_has() {
        struct Never;
        impl Progress for Never {
            fn done(&self, _: u64, _: u64, _: u64) {}
            fn cancelled(&self) -> bool {
                true
            }
        }
        let scene = ball();
        let outputs = [(View::Color, Format::Png)];
        let result = render(&scene, &settings(&scene, [100, 100]), &outputs, &Resources::default(), &Never);
        let Err(RenderError::Cancelled(picture)) = result else { panic!("not cancelled") };
        assert!(picture.encode(&[View::Color], Format::Png, BitDepth::Eight).is_ok());
        assert!(picture.stats.samples < 100 * 100 * 16);
    }

    #[test]
    fn bytes_are_told_in_words() {
        assert_eq!(in_words(1536), "1.5 kB");
        assert_eq!(in_words(12 * 10u128.pow(18)), "12.0 EB");
        assert_eq!(in_words(10u128.pow(24)), "1000000.0 EB");
    }
}
