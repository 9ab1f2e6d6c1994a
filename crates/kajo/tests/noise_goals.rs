//! Goals for noise with integrators whose samples share photons, vertices or what was learned, and those that cannot have one.

mod room;

use std::ops::ControlFlow;

use kajo::{
    BitDepth, Defaults, Format, Goal, Passes, Picture, RenderError, RenderSettings, Resources, SamplerKind,
    Scene, Settings, Silent, View,
};
use room::{ROOM, load};

/// Of one block, over which noise is estimated.
const SIDE: u32 = 32;

const OUTPUTS: [(View, Format); 1] = [(View::Color, Format::Exr)];

const KNOWN: [&str; 4] =
    ["sppm  photons 1000", "vcm  photons 1000", "path  guiding on  training 4", "path  lightChoice learned"];

/// A render of a scene of its own.
struct Render {
    scene: Scene,
    settings: RenderSettings,
}

impl Render {
    fn new(integrator: &str, kind: SamplerKind, samples: u32, seed: u64) -> Render {
        let scene = load(&format!("{ROOM}\nSettings {{ integrator {integrator}  bounces 3  filter none }}"));
        let asked = Settings {
            size: Some([SIDE; 2]),
            samples: Some((kind, samples)),
            seed: Some(seed),
            ..Settings::default()
        };
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        Render { scene, settings }
    }

    fn run(&self, goal: Goal, threads: usize) -> Result<Picture, RenderError> {
        let resources = Resources { threads, ..Resources::default() };
        let request = kajo::RenderRequest::new(&self.scene, &self.settings, &OUTPUTS).with(resources);
        let passes = Passes { goal, ..Passes::default() };
        kajo::render_passes(&request, &passes, &Silent, &mut |_| ControlFlow::Continue(()))
    }
}

fn until(noise: f64) -> Goal {
    Goal { noise: Some(noise), ..Goal::default() }
}

/// What is estimated is what other seeds change.
#[test]
fn the_noise_is_as_large_as_it_is_said_to_be() {
    const SEEDS: u64 = 8;
    for integrator in KNOWN {
        let pictures: Vec<Picture> = (0..SEEDS)
            .map(|seed| Render::new(integrator, SamplerKind::Uniform, 16, seed).run(until(1e-6), 2).unwrap())
            .collect();
        let lights: Vec<Vec<f64>> = pictures
            .iter()
            .map(|picture| picture.light().unwrap().data().iter().map(|&v| f64::from(v)).collect())
            .collect();
        let n = lights[0].len();
        let mean_of = |i: usize| lights.iter().map(|light| light[i]).sum::<f64>() / SEEDS as f64;
        let means: Vec<f64> = (0..n).map(mean_of).collect();
        let spread = |light: &Vec<f64>| light.iter().zip(&means).map(|(v, m)| (v - m).powi(2)).sum::<f64>();
        let variance = lights.iter().map(spread).sum::<f64>() / (n as f64 * (SEEDS - 1) as f64);
        let mean = means.iter().sum::<f64>() / n as f64;
        let found = (variance / (1.01 * mean * mean)).sqrt();
        let square = |picture: &Picture| picture.noise().unwrap().powi(2);
        let said = (pictures.iter().map(square).sum::<f64>() / SEEDS as f64).sqrt();
        assert!((said / found - 1.0).abs() < 0.15, "{integrator}: {said} is said, {found} found");
    }
}

#[test]
fn renders_end_when_they_are_good_enough() {
    for integrator in KNOWN {
        let render = Render::new(integrator, SamplerKind::Sobol, 4096, 0);
        let picture = render.run(until(0.15), 2).unwrap();
        let noise = picture.noise().unwrap();
        assert!(noise <= 0.15 && picture.mean_samples() < 4096.0, "{integrator}: {noise}");
        let adaptive = Render::new(integrator, SamplerKind::Sobol, 12, 0);
        let of = |threads| {
            let picture = adaptive.run(Goal { adaptive: true, ..Goal::default() }, threads).unwrap();
            picture.encode(&[View::Color], Format::Exr, BitDepth::Eight).unwrap()
        };
        assert!(of(1) == of(3), "{integrator}: the picture depends on the threads");
    }
}

#[test]
fn noise_that_samples_share_is_not_estimated() {
    for integrator in ["photon  photons 1000", "irradiance  rays 16", "mlt", "mmlt"] {
        let render = Render::new(integrator, SamplerKind::Sobol, 4, 0);
        for goal in [until(0.1), Goal { adaptive: true, ..Goal::default() }] {
            let refused = render.run(goal, 1);
            assert!(matches!(refused, Err(RenderError::UnknownNoise(_))), "{integrator}");
        }
    }
}
