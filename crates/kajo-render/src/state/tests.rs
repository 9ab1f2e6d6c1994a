use std::num::NonZeroU32;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::Vec2;
use kajo_math::rng::{Stream, mix};

use super::*;
use crate::setup::append_tightly;
use crate::{
    Film, FilmSpec, Goal, Layer, LayerSet, PixelSample, Position, Progress, RenderError, RenderSettings,
    RenderStats, SampleContext, Silent, WithState, render, render_passes,
};
use crate::{Rect, SamplesPerState, Unit, render_work_unit};

/// Light that depends on a table that three samples of each pixel share.
struct Shared;

struct Table(Vec<u64>);

impl PixelIntegrator for Shared {
    fn sample(&self, _: &mut SampleContext<'_>, _: [u32; 2], _: Vec2) -> PixelSample {
        panic!("samples are taken with a state")
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        NonZeroU32::new(3).map(SamplesPerState::Count)
    }

    fn with_state<'a>(&'a self, k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let seed = setup.seed;
        let table = setup.tasks(11, |i| Ok(mix(seed ^ mix(u64::from(k) << 32 | u64::from(i)))))?;
        let rays = RayCounters { light: 11, ..RayCounters::default() };
        Ok(WithState { integrator: Box::new(Table(table)), rays, notes: Vec::new() })
    }
}

impl PixelIntegrator for Table {
    fn sample(&self, ctx: &mut SampleContext<'_>, [x, y]: [u32; 2], _: Vec2) -> PixelSample {
        let u = Stream::new(self.0[((x + y) % 11) as usize], [x, y], ctx.index).uniform(0);
        ctx.rays.camera += 1;
        ctx.splats.add(Vec2::new(40.0 * u, 30.0 * (1.0 - u)), [u, 0.5, 0.25]);
        PixelSample { radiance: [u, 1.0 - u, 0.5], first: None }
    }
}

fn film() -> Film {
    let layers = LayerSet::of(&[Layer::Color]);
    Film::new(FilmSpec { layers, ..FilmSpec::new(40, 30) }, u64::MAX).unwrap()
}

fn bits(film: &Film) -> Vec<u32> {
    film.develop(Layer::Color).unwrap().data().iter().map(|v| v.to_bits()).collect()
}

fn settings(threads: usize, tile: u32, kind: SamplerKind) -> RenderSettings {
    RenderSettings { threads, tile, seed: 5, ..RenderSettings::new(Sampler::new(kind, 16)) }
}

/// Stops after some questions.
struct StopAfter(AtomicUsize);

impl Progress for StopAfter {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

fn go_on(_: &Film, _: &Position, _: &RenderStats) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

#[test]
fn threads_tiles_passes_and_stops_make_the_same_picture() {
    for kind in [SamplerKind::Uniform, SamplerKind::Jittered] {
        let whole = film();
        let stats = render(&Shared, &whole, &settings(1, 0, kind), &Silent).unwrap();
        assert_eq!((stats.samples, stats.rays.light), (40 * 30 * 16, 6 * 11));
        for (threads, tile) in [(2, 8), (7, 5), (1, 16)] {
            let (again, passes, stopped) = (film(), film(), film());
            let settings = settings(threads, tile, kind);
            render(&Shared, &again, &settings, &Silent).unwrap();
            let goal = Goal::default();
            render_passes(&Shared, &passes, &settings, &goal, &mut Position::default(), &Silent, &mut go_on)
                .unwrap();
            let mut position = Position::default();
            for n in 0.. {
                let stop = StopAfter(AtomicUsize::new(20 + 7 * n));
                let result =
                    render_passes(&Shared, &stopped, &settings, &goal, &mut position, &stop, &mut go_on);
                match result {
                    Ok(_) => break,
                    Err(RenderError::Cancelled(_)) => {}
                    Err(error) => panic!("{error}"),
                }
                // What is saved goes on elsewhere.
                let mut saved = Vec::new();
                position.save(&mut saved).unwrap();
                position = Position::restore(&stopped, &settings, &mut &saved[..]).unwrap();
            }
            for other in [&again, &passes, &stopped] {
                assert!(bits(&whole) == bits(other), "{kind:?} with {threads} threads, tiles of {tile}");
            }
        }
    }
}

#[test]
fn pieces_come_in_order_and_the_first_failure_ends_the_work() {
    let setup = |threads, progress| Setup { seed: 0, threads, memory: 0, progress };
    for threads in [1, 2, 7] {
        let setup = setup(threads, &Silent);
        assert_eq!(setup.tasks(100, |i| Ok(i * i)).unwrap(), (0..100).map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(setup.tasks(0, |_| Ok(())), Ok(Vec::new()));
        let refused = SetupError::Refused("no".to_owned());
        assert_eq!(setup.tasks(9, |i| if i == 3 { Err(refused.clone()) } else { Ok(()) }), Err(refused));
        let panicked = setup.tasks(9, |i| if i == 4 { panic!("oops") } else { Ok(()) });
        assert_eq!(panicked, Err(SetupError::Panicked("oops".to_owned())));
    }
    let stop = StopAfter(AtomicUsize::new(2));
    assert_eq!(setup(1, &stop).tasks(9, |_| Ok(())), Err(SetupError::Cancelled));
}

#[test]
fn results_are_put_together_in_order_whichever_is_made_first() {
    for threads in [1, 2, 7] {
        let setup = Setup { seed: 0, threads, memory: 0, progress: &Silent };
        // Every fifth takes much longer than others.
        let work = |i: u32| {
            (0..if i.is_multiple_of(5) { 200_000 } else { 10 }).fold(i, |x, _| std::hint::black_box(x))
        };
        let folded: Vec<u32> = setup
            .fold_tasks(100, work, |all: &mut Vec<u32>, i| {
                append_tightly(all, vec![i; i as usize]);
                Ok(())
            })
            .unwrap();
        assert_eq!(folded, (0..100).flat_map(|i| vec![i; i as usize]).collect::<Vec<_>>());
        assert!(folded.capacity() <= folded.len() * 9 / 8 + 100, "{}", folded.capacity());
        let refused = SetupError::Refused("no".to_owned());
        let refuse = |sum: &mut u32, i| {
            *sum += i;
            if *sum > 20 { Err(refused.clone()) } else { Ok(()) }
        };
        assert_eq!(setup.fold_tasks(6, work, refuse), Ok(15));
        assert_eq!(setup.fold_tasks(9, work, refuse), Err(refused.clone()));
    }
}

/// Pieces end anywhere, and each makes the states that it needs.
#[test]
fn pieces_of_a_picture_add_up_to_it() {
    let settings = settings(2, 8, SamplerKind::Sobol);
    let (whole, sum) = (film(), film());
    render(&Shared, &whole, &settings, &Silent).unwrap();
    for samples in [0..2, 2..9, 9..16] {
        for tile in [Rect { x0: 0, y0: 0, x1: 17, y1: 30 }, Rect { x0: 17, y0: 0, x1: 40, y1: 30 }] {
            let (task, limits) = (film(), Unit::UNLIMITED);
            let unit = Unit { tile, samples: samples.clone(), limits };
            render_work_unit(&Shared, &task, &settings, &Position::default(), &unit, &Silent).unwrap();
            sum.absorb(task).unwrap();
        }
    }
    assert!(bits(&whole) == bits(&sum));
}
