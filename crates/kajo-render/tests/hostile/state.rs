//! What becomes of any bytes as the saved state of a render: refused, or gone on from, without a panic.
//!
//! Files of checkpoints end with a hash, which damage does not survive; this is what stands behind it.
//!
//! Used by the test beside this folder and by the fuzz target `checkpoint`.

use std::ops::ControlFlow;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::Vec2;
use kajo_render::{
    Film, FilmSpec, Filter, Goal, Layer, LayerSet, PixelIntegrator, PixelSample, Position, RenderSettings,
    SampleContext, Silent, render_passes,
};

struct Grey;

impl PixelIntegrator for Grey {
    fn sample(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let value = 0.1 * raster.x + ctx.draws.next_1d();
        PixelSample { radiance: [value, 0.5, 0.0], first: None }
    }
}

fn spec() -> FilmSpec {
    let layers = LayerSet::of(&[Layer::Color, Layer::Depth, Layer::ObjectId, Layer::Variance]);
    FilmSpec { filter: Filter::gaussian(0.6), layers, halves: true, ..FilmSpec::new(5, 3) }
}

fn settings() -> RenderSettings {
    RenderSettings { threads: 1, ..RenderSettings::new(Sampler::new(SamplerKind::Sobol, 16)) }
}

fn run(film: &Film, position: &mut Position, passes: u32) {
    let goal = Goal { adaptive: true, noise: Some(1e-3), ..Goal::default() };
    let mut left = passes;
    let look = &mut |_: &Film, _: &Position, _: &_| {
        left = left.saturating_sub(1);
        if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let _ = render_passes(&Grey, film, &settings(), &goal, position, &Silent, look);
}

/// The state of a render after some passes.
#[allow(dead_code, reason = "the fuzz target has a corpus")]
pub fn saved(passes: u32) -> Vec<u8> {
    let film = Film::new(spec(), 1 << 24).expect("a small film");
    let mut position = Position::default();
    run(&film, &mut position, passes);
    let mut bytes = Vec::new();
    film.save(0, &mut bytes).expect("memory");
    position.save(&mut bytes).expect("memory");
    bytes
}

/// Reads a state and goes on from it; answers whether it could be read.
pub fn go_on(mut data: &[u8]) -> bool {
    let Ok(film) = Film::restore(spec(), 1 << 24, &mut data) else { return false };
    let Ok(mut position) = Position::restore(&film, &settings(), &mut data) else { return false };
    if position.exceeds(&settings()) {
        return false;
    }
    run(&film, &mut position, 3);
    for layer in [Layer::Color, Layer::Depth, Layer::ObjectId, Layer::Variance] {
        film.develop(layer).expect("the film has it");
    }
    true
}
