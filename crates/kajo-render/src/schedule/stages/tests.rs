use std::ops::ControlFlow;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::{Vec2, rng::Stream};

use super::*;
use crate::{
    FilmSpec, Filter, Layer, LayerSet, PixelSample, Rect, SampleContext, Silent, schedule::render_passes,
};

/// Light that depends on everything, noisier to the right, and splats everywhere.
struct Noisy;

impl PixelIntegrator for Noisy {
    fn sample(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let stream = *ctx.draws.stream();
        let u = |d| stream.uniform(d);
        let value = 1.0 + u(5) * raster.x * 0.05 + 0.01 * pixel[1] as f32;
        if u(6) < 0.5 {
            ctx.splats.add(Vec2::new(u(7) * 80.0, u(8) * 60.0), [u(9), 0.1, value]);
        }
        ctx.rays.camera += 1;
        PixelSample { radiance: [value, u(10), 0.5], first: None }
    }
}

fn film(spec: FilmSpec) -> Film {
    Film::new(spec, u64::MAX).expect("a sensible film")
}

fn bits(film: &Film) -> Vec<Vec<u32>> {
    let of =
        |layer| film.develop(layer).expect("the film has it").data().iter().map(|v| v.to_bits()).collect();
    film.spec().layers.iter().map(of).collect()
}

/// Numbers below `n` that look random.
struct Dice(Stream, u32);

impl Dice {
    fn below(&mut self, n: u32) -> u32 {
        self.1 += 1;
        ((self.0.uniform(self.1) * n as f32) as u32).min(n.saturating_sub(1))
    }
}

/// Cuts a stage of a picture at random positions and puts it together again, in an order of its own.
fn in_pieces(spec: FilmSpec, settings: &RenderSettings, goal: &Goal, dice: &mut Dice) -> Film {
    let sum = film(spec);
    let mut position = Position::default();
    while let Some(samples) = position.stage(settings, goal) {
        let (w, h) = (9 + dice.below(spec.width), 7 + dice.below(spec.height));
        let step = 1 + dice.below(samples.end - samples.start);
        let mut films = Vec::new();
        for (x0, y0) in (0..spec.height)
            .step_by(h as usize)
            .flat_map(|y| (0..spec.width).step_by(w as usize).map(move |x| (x, y)))
        {
            for start in samples.clone().step_by(step as usize) {
                let tile = Rect { x0, y0, x1: x0 + w, y1: y0 + h };
                let samples = start..(start + step).min(samples.end);
                let unit = Unit { tile, samples, limits: Unit::UNLIMITED };
                let part = film(spec);
                let settings = RenderSettings { threads: 1 + dice.below(2) as usize, ..settings.clone() };
                render_work_unit(&Noisy, &part, &settings, &position, &unit, &Silent).expect("rendered");
                films.push(part);
            }
        }
        while !films.is_empty() {
            let part = films.swap_remove(dice.below(films.len() as u32) as usize);
            // Pieces of pieces may also be put together first.
            match films.pop() {
                Some(other) if dice.below(2) == 0 => {
                    other.absorb(part).expect("of one kind");
                    films.push(other);
                }
                other => {
                    films.extend(other);
                    sum.absorb(part).expect("of one kind");
                }
            }
        }
        if position.end_stage(&sum, settings, goal) {
            break;
        }
    }
    sum
}

#[test]
fn pieces_add_up_to_the_picture_however_it_is_cut() {
    let layers = LayerSet::of(&[Layer::Color, Layer::Variance, Layer::SampleCount]);
    let mut dice = Dice(Stream::new(5, [1, 2], 3), 0);
    let mut looks = Vec::new();
    for (kind, n, goal) in [
        (SamplerKind::Jittered, 9, Goal::default()),
        (SamplerKind::Sobol, 6, Goal::default()),
        (SamplerKind::Uniform, 4000, Goal { noise: Some(0.035), ..Goal::default() }),
        (SamplerKind::Uniform, 24, Goal { adaptive: true, ..Goal::default() }),
        (SamplerKind::Uniform, 64, Goal { adaptive: true, noise: Some(0.03), ..Goal::default() }),
    ] {
        for filter in [Filter::None, Filter::MITCHELL] {
            let spec =
                FilmSpec { filter, layers, halves: goal.adaptive, shown: None, ..FilmSpec::new(70, 41) };
            let settings = RenderSettings { threads: 2, ..RenderSettings::new(Sampler::new(kind, n)) };
            let (whole, mut position) = (film(spec), Position::default());
            let look = &mut |_: &Film, _: &Position, _: &RenderStats| ControlFlow::Continue(());
            render_passes(&Noisy, &whole, &settings, &goal, &mut position, &Silent, look).expect("rendered");
            looks.push(position.samples());
            for _ in 0..if n > 100 { 2 } else { 20 } {
                let sum = in_pieces(spec, &settings, &goal, &mut dice);
                assert_eq!((sum.samples(), bits(&sum)), (whole.samples(), bits(&whole)), "{kind:?} {n}");
            }
        }
    }
    assert!((17..4000).contains(&looks[4]), "the goal for noise decided: {looks:?}");
}

#[test]
fn a_crop_is_rendered_only_where_it_is_shown() {
    let shown = Rect { x0: 20, y0: 10, x1: 50, y1: 30 };
    let spec = FilmSpec { shown: Some(shown), ..FilmSpec::new(70, 41) };
    let settings = RenderSettings::new(Sampler::new(SamplerKind::Uniform, 2));
    let part = film(spec);
    let unit = Unit { tile: Rect::of_size(30, 41), samples: 0..2, limits: Unit::UNLIMITED };
    render_work_unit(&Noisy, &part, &settings, &Position::default(), &unit, &Silent).expect("rendered");
    assert_eq!(part.samples(), 10 * 20 * 2);
}

#[test]
fn films_of_other_kinds_are_not_added() {
    let sum = film(FilmSpec::new(4, 4));
    assert!(sum.absorb(film(FilmSpec::new(4, 5))).is_err());
    let filtered = FilmSpec { filter: Filter::MITCHELL, ..FilmSpec::new(4, 4) };
    assert!(sum.absorb(film(filtered)).is_err());
}

#[test]
fn looks_at_the_noise_are_those_of_passes() {
    let ends: Vec<u32> = [0, 5, 16, 31, 32, 63, 64, 127, 128].map(next_look).to_vec();
    assert_eq!(ends, [16, 16, 32, 32, 64, 64, 128, 128, 192]);
}
