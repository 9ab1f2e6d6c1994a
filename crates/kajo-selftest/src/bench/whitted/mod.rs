//! The classic renderer on two classic scenes: 1024 × 768 pixels, five bounces, transparent shadows.
//!
//! The work is that of other programs on the same spheres: a branch ends when its weight falls below 1/256,
//! glass weakens shadows by its colour at every surface, and with anti-aliasing a pixel gets five
//! camera rays, one through its centre and four on a regular 2 × 2 grid, as method 1 of
//! POV-Ray casts them.
//!
//! A picture is believed only when its mean colour and its counts of rays are the known ones and its bits
//! are the same in every pass on any number of threads.

mod known;
mod peers;
mod scene;

use kajo_core::compile::{CompileOptions, compile};
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::Settings as Asked;
use kajo_image::Image;
use kajo_render::RayCounters;
use kajo_scene::{Limits, MemoryAssets, SceneDesc};

use super::picture::{self, Timed};
use super::time::{Seconds, Times, timed};
use kajo::{Defaults, RenderSettings};

pub use known::{COUNT_TOLERANCE, MEAN_TOLERANCE};
pub use scene::{BenchSphere, WhittedScene};

/// Camera rays of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AntiAliasing {
    /// One, through the centre.
    #[default]
    None,
    /// One through the centre and four on a 2 × 2 grid.
    Grid,
}

impl AntiAliasing {
    /// Camera rays of a pixel.
    pub fn samples(self) -> u32 {
        self.samplers().iter().map(Sampler::samples).sum()
    }

    fn samplers(self) -> Vec<Sampler> {
        let counts: &[u32] = match self {
            AntiAliasing::None => &[1],
            AntiAliasing::Grid => &[1, 4],
        };
        counts.iter().map(|&n| Sampler::new(SamplerKind::Regular, n)).collect()
    }
}

/// What to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// The scene.
    pub scene: WhittedScene,
    /// Camera rays of a pixel.
    pub aa: AntiAliasing,
    /// Numbers of threads to render with; each pass renders with each.
    pub threads: Vec<usize>,
    /// How often everything is done.
    pub passes: usize,
}

/// What a run showed.
#[derive(Debug)]
pub struct Report {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Spheres.
    pub balls: usize,
    /// Bytes of scene text.
    pub text_bytes: usize,
    /// From text to its tree.
    pub parse: Times,
    /// From the tree to a scene that can be rendered.
    pub compile: Times,
    /// Rays by kind.
    pub rays: RayCounters,
    /// Mean red, green and blue.
    pub mean: [f64; 3],
    /// For each number of threads, what rendering took.
    pub renders: Vec<(usize, Times)>,
    /// The picture.
    pub image: Image,
}

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WhittedError {
    /// The text was not accepted.
    #[error("the scene cannot be read:\n{0}")]
    Scene(String),
    /// There is no picture.
    #[error("the scene cannot be rendered: {0}")]
    Render(String),
    /// The picture is not the right one.
    #[error("the picture is wrong: {0}")]
    Wrong(String),
    /// Threads or passes change the picture.
    #[error("the picture of pass {pass} on {threads} threads differs from the first one")]
    Unstable {
        /// Counted from 1.
        pass: usize,
        /// Threads that rendered it.
        threads: usize,
    },
}

/// Renders a scene again and again.
///
/// # Errors
/// [`WhittedError`]; no time is reported for a wrong picture.
pub fn run(settings: &Settings) -> Result<Report, WhittedError> {
    let text = settings.scene.text();
    let (mut parses, mut compiles) = (Vec::new(), Vec::new());
    let mut renders: Vec<(usize, Vec<Seconds>)> =
        settings.threads.iter().map(|&threads| (threads, Vec::new())).collect();
    let mut first: Option<Timed> = None;
    for pass in 1..=settings.passes.max(1) {
        let (scene, parse, compile) = load(&text)?;
        parses.push(parse);
        compiles.push(compile);
        let resolved = RenderSettings::resolve(&scene, &Asked::default(), Defaults::Modern, false)
            .map_err(|error| WhittedError::Render(error.to_string()))?;
        for (threads, times) in &mut renders {
            let timed = picture::render(&scene, &resolved, &settings.aa.samplers(), *threads)
                .map_err(WhittedError::Render)?;
            times.push(timed.seconds);
            match &first {
                None => {
                    known::check(settings.scene, settings.aa, &timed).map_err(WhittedError::Wrong)?;
                    first = Some(timed);
                }
                Some(first) if same(first, &timed) => {}
                Some(_) => return Err(WhittedError::Unstable { pass, threads: *threads }),
            }
        }
    }
    let first = first.ok_or_else(|| WhittedError::Render("no number of threads is given".to_owned()))?;
    Ok(Report {
        size: [first.image.width(), first.image.height()],
        balls: settings.scene.balls().len(),
        text_bytes: text.len(),
        parse: Times::of(&parses),
        compile: Times::of(&compiles),
        rays: first.rays,
        mean: first.mean(),
        renders: renders.iter().map(|(threads, times)| (*threads, Times::of(times))).collect(),
        image: first.image,
    })
}

fn load(text: &str) -> Result<(Scene, Seconds, Seconds), WhittedError> {
    let assets = MemoryAssets::new();
    let (mut parsed, parse) = timed(|| SceneDesc::parse("bench.txt", text, &assets, &Limits::default()));
    let options = CompileOptions::default();
    let (scene, compile) = timed(|| compile(&mut parsed.desc, &assets, &options, &mut parsed.diagnostics));
    let report = || kajo_scene::render(&parsed.diagnostics, parsed.desc.sources(), false);
    Ok((scene.ok_or_else(|| WhittedError::Scene(report()))?, parse, compile))
}

/// Bit for bit.
fn same(a: &Timed, b: &Timed) -> bool {
    let bits = |picture: &Timed| picture.image.data().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    a.rays == b.rays && bits(a) == bits(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_is_verified_and_reported() {
        let settings =
            Settings { scene: WhittedScene::Marbles, aa: AntiAliasing::None, threads: vec![1, 3], passes: 1 };
        let report = run(&settings).unwrap();
        assert_eq!((report.size, report.balls), ([1024, 768], 1024));
        assert_eq!(report.rays.camera, 1024 * 768);
        assert_eq!(report.renders.iter().map(|(threads, _)| *threads).collect::<Vec<_>>(), [1, 3]);
        assert!(report.renders.iter().all(|(_, times)| times.cpu.min > 0.0));
    }

    #[test]
    fn anti_aliasing_is_five_rays() {
        assert_eq!((AntiAliasing::None.samples(), AntiAliasing::Grid.samples()), (1, 5));
    }

    #[test]
    fn no_threads_no_figure() {
        let settings =
            Settings { scene: WhittedScene::Flake, aa: AntiAliasing::None, threads: vec![], passes: 1 };
        assert!(matches!(run(&settings), Err(WhittedError::Render(_))));
    }
}
