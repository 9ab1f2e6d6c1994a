//! Paths that choose lights by what is known to arrive: see [`LightVisibility`].
//!
//! Before the picture is made, paths are followed through all of it, and each light that is drawn along them is noted with whether anything of it
//! arrives. The first of them choose lights by importance, the others by what these have found: where all light but
//! that of one emitter in a thousand is kept off by walls, that one is hardly drawn before.
//!
//! The estimator of the picture is the path tracer's, with another probability of a light. For each light that is drawn this is
//!
//! ```text
//! P = 0.1 product of s + 0.9 product of t
//! ```
//!
//! over the steps from the root of the tree to the light, with the probabilities `s` by importance and `t` by
//! importance times what was learned to arrive: a discrete probability, which the density of the position on the light
//! is multiplied by. Tables are fixed before the first sample of the picture is taken, so the estimate is unbiased
//! whatever they say, and it does not depend on threads.

use std::ops::Range;

use kajo_core::LightIndex;
use kajo_core::light::{LightDraw, LightSelection, LightVisibility, Receiver};
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::Vec2;
use kajo_math::rng::mix;

use super::{Path, Sampled};
use crate::integrator::Integrator;
use crate::trail::PathObserver;
use crate::{PixelSample, RayCounters, SampleContext, Setup, SetupError, WithState};

/// Paths for each pixel of the picture.
const PATHS_PER_PIXEL: u64 = 4;

/// The least and the largest number of paths.
const PATHS: [u64; 2] = [1 << 12, 1 << 17];

/// Paths of one task.
const TASK: u64 = 256;

/// Draws that a task keeps: in a cloud a path may have hundreds.
const DRAWS: usize = 32 * TASK as usize;

/// One in so many of the paths chooses lights by importance.
const FIRST: u64 = 4;

/// Sets the numbers of these paths apart from those of samples.
const SALT: u64 = 0x6C69_6768_7473;

/// A path tracer with what it has learned.
struct LearnedPath<'a> {
    path: &'a Path<'a>,
    visibility: LightVisibility,
}

impl Integrator for LearnedPath<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let lights = self.path.lights_by(Some(&self.visibility));
        self.path.observe_choosing(ctx, raster, observer, Sampled, lights).0
    }
}

/// Follows paths, and makes an integrator that chooses lights by what these have found.
pub(super) fn prepare<'a>(path: &'a Path<'a>, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
    let (visibility, rays) = learn(path, setup)?;
    Ok(WithState { integrator: Box::new(LearnedPath { path, visibility }), rays, notes: Vec::new() })
}

/// What arrives, and the rays that it took.
pub(super) fn learn(
    path: &Path<'_>,
    setup: &Setup<'_>,
) -> Result<(LightVisibility, RayCounters), SetupError> {
    let sampler = &path.view.scene.lighting.sampler;
    let [width, height] = path.view.size.map(u64::from);
    let tasks = (width * height * PATHS_PER_PIXEL).clamp(PATHS[0], PATHS[1]) / TASK;
    let mut draws = Vec::new();
    let mut rays = train(path, setup, 0..tasks / FIRST, path.lights_by(None), &mut draws)?;
    let visibility = sampler.learn(draws.clone());
    let by_these = path.lights_by(Some(&visibility));
    rays += train(path, setup, tasks / FIRST..tasks, by_these, &mut draws)?;
    Ok((sampler.learn(draws), rays))
}

/// Follows the training paths of some tasks; adds the lights that they draw.
fn train(
    path: &Path<'_>,
    setup: &Setup<'_>,
    tasks: Range<u64>,
    lights: LightSelection<'_>,
    draws: &mut Vec<LightDraw>,
) -> Result<RayCounters, SetupError> {
    let [width, height] = path.view.size;
    let pixels = u64::from(width) * u64::from(height);
    let found = setup.tasks((tasks.end - tasks.start) as u32, |task| {
        let sampler = Sampler::new(SamplerKind::Uniform, 1);
        let mut ctx = SampleContext::new(&sampler, mix(setup.seed ^ SALT));
        let mut recorder = Recorder::default();
        for i in (tasks.start + u64::from(task)) * TASK..(tasks.start + u64::from(task) + 1) * TASK {
            let at = mix(i) % pixels;
            let pixel = [(at % u64::from(width)) as u32, (at / u64::from(width)) as u32];
            let raster = Vec2::new(pixel[0] as f32, pixel[1] as f32) + ctx.begin(pixel, i as u32);
            path.observe_choosing(&mut ctx, raster, &mut recorder, Sampled, lights);
        }
        let choices = &path.view.scene.lighting.sampler;
        let draws = recorder.draws.into_iter().map(|drawn| {
            let by = [path.lights_by(None), lights];
            let [tree, by] = by.map(|by| choices.pmf(drawn.light, &drawn.to, by));
            LightDraw { p: drawn.to.p, light: drawn.light, weight: tree / by, arrives: drawn.arrives }
        });
        Ok((draws.collect::<Vec<_>>(), recorder.rays))
    })?;
    let mut rays = RayCounters::default();
    for (drawn, cast) in found {
        rays += cast;
        draws.extend(drawn);
    }
    Ok(rays)
}

/// Keeps the lights that are drawn.
#[derive(Default)]
struct Recorder {
    rays: RayCounters,
    draws: Vec<RecordedDraw>,
}

/// A light that was drawn for a receiver.
struct RecordedDraw {
    to: Receiver,
    light: LightIndex,
    arrives: bool,
}

impl PathObserver for Recorder {
    type Mark = ();

    fn counters(&mut self) -> &mut RayCounters {
        &mut self.rays
    }

    fn light_drawn(&mut self, to: &Receiver, light: LightIndex, arrives: impl FnOnce() -> bool) {
        if self.draws.len() < DRAWS {
            self.draws.push(RecordedDraw { to: *to, light, arrives: arrives() });
        }
    }

    fn mark(&self) {}

    fn back_to(&mut self, (): ()) {}
}

#[cfg(test)]
mod tests {
    use kajo_core::light::LightChoice;
    use kajo_core::sampler::{Sampler, SamplerKind};
    use kajo_core::scene::Scene;
    use kajo_core::settings::Technique;

    use super::super::PathSettings;
    use super::super::tests::{camera, mean_of, scene};
    use super::*;
    use crate::integrator::same_picture::assert_same_picture;
    use crate::{Layer, LayerSet, PixelIntegrator, RenderSettings, Silent};

    fn settings() -> PathSettings {
        PathSettings { light_choice: LightChoice::Learned, bounces: 2, ..PathSettings::default() }
    }

    /// A floor under a ball of light, and four hundred balls of light behind a wall.
    fn walled(eye: &str) -> Scene {
        scene(&format!(
            "{eye}
             Materials {{ Matte floor {{ color 0.5 0.6 0.4 }}  Matte emitter {{ color 0 0 0  emission 30 25 20 }} }}
             Group {{
                 MaterialIndex floor
                 Quad {{ corner -9 0 5  edge1 18 0 0  edge2 0 0 -10 }}
                 Quad {{ corner -1 0 9  edge1 0 9 0  edge2 0 0 -18 }}
                 MaterialIndex emitter
                 Sphere {{ center -3 2.5 0.5  radius 0.2 }}
                 repeat i 20 {{ repeat j 20 {{
                     Sphere {{ center 1 + 0.3 * i  1  4 - 0.4 * j  radius 0.05 }}
                 }} }}
             }}"
        ))
    }

    fn setup(threads: usize) -> Setup<'static> {
        Setup { seed: 0, threads, memory: u64::MAX, progress: &Silent }
    }

    #[test]
    fn hidden_lights_are_drawn_rarely_and_the_mean_is_the_same() {
        let scene = walled(&camera([-4.0, 3.0, 5.0], [-4.0, 0.0, 0.0]));
        let learned = Path::new(&scene, settings(), [1, 1], LayerSet::of(&[]));
        let tree = PathSettings { light_choice: LightChoice::Tree, ..settings() };
        let tree = mean_of(&Path::new(&scene, tree, [1, 1], LayerSet::of(&[])), 4000, 0);
        let state = PixelIntegrator::with_state(&learned, 0, &setup(1)).unwrap();
        let learned = mean_of(&*state.integrator, 4000, 0);
        let sigma = tree.standard_error.hypot(learned.standard_error);
        assert!((tree.mean - learned.mean).abs() < 4.0 * sigma, "{tree:?} {learned:?}");
        assert!(learned.standard_error < 0.25 * tree.standard_error, "{tree:?} {learned:?}");
        assert!(state.rays.total() > 0);
    }

    #[test]
    fn what_is_learned_does_not_depend_on_threads() {
        let scene = walled(&camera([-4.0, 3.0, 5.0], [-4.0, 0.0, 0.0]));
        let path = Path::new(&scene, settings(), [16, 16], LayerSet::of(&[]));
        let [one, three] = [1, 3].map(|threads| learn(&path, &setup(threads)).unwrap().0);
        assert!(one == three);
        assert!(one.bytes() > 4096, "{}", one.bytes());
    }

    #[test]
    fn threads_tiles_and_stops_make_the_same_picture() {
        let size = [20, 16];
        let scene = walled(&camera([-4.0, 3.0, 5.0], [-4.0, 0.0, 0.0]).replace("angle 0.01", "angle 60"));
        let path = Path::new(&scene, settings(), size, LayerSet::of(&[Layer::Color]));
        let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
        assert_same_picture(&path, size, &schedule, [9, 5]);
    }

    /// A sky of one colour is drawn where nothing but drawing finds it.
    #[test]
    fn lights_that_are_drawn_only_are_learned_too() {
        let scene = scene(&format!(
            "{} Background {{ color 0.5 0.5 0.5 }}
             Lights {{ PointLight {{ position 0 3 0  intensity 1 }}  PointLight {{ position 9 -3 0  intensity 9 }} }}
             Materials {{ Matte floor {{ color 0.5 0.5 0.5 }} }}
             Group {{ MaterialIndex floor Quad {{ corner -4 0 4  edge1 8 0 0  edge2 0 0 -8 }} }}",
            camera([0.0, 3.0, 2.0], [0.0, 0.0, 0.0])
        ));
        let drawn = PathSettings { technique: Technique::Lights, ..settings() };
        let path = Path::new(&scene, drawn, [1, 1], LayerSet::of(&[]));
        let state = PixelIntegrator::with_state(&path, 0, &setup(1)).unwrap();
        let found = mean_of(&*state.integrator, 4000, 0);
        // 0.5 of the sky, and 0.5/pi of the light three above.
        let expected = 0.5 * 0.5 + 0.5 / std::f64::consts::PI / 9.0;
        let sigma = found.standard_error;
        assert!((found.mean - expected).abs() < 4.0 * sigma && sigma < 0.02, "{found:?} {expected}");
    }

    /// With one light there is nothing to choose.
    #[test]
    fn there_is_nothing_to_learn_of_one_light() {
        let scene = scene(&format!(
            "{} Lights {{ PointLight {{ position 0 3 0  intensity 1 }} }}
             Materials {{ Matte m {{ color 1 1 1 }} }} Group {{ MaterialIndex m Plane {{ normal 0 1 0  offset 0 }} }}",
            camera([0.0, 3.0, 5.0], [0.0, 0.0, 0.0])
        ));
        let path = Path::new(&scene, settings(), [1, 1], LayerSet::of(&[]));
        assert_eq!(PixelIntegrator::samples_per_state(&path), None);
    }
}
