//! What the film costs: nanoseconds for each sample of a picture whose rays cost nothing.
//!
//! `cargo bench -p kajo-render --bench film [-- PART OF A NAME]`. One thread; the median of nine runs and their spread. Each
//! picture is checked before its time is printed.

use std::time::Instant;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::{Vec2, Vec3};
use kajo_render::{
    Film, FilmSpec, Filter, FirstHit, Layer, LayerSet, PixelIntegrator, PixelSample, RenderSettings,
    SampleContext, Silent, render,
};

/// A surface of one colour before the whole film.
struct Flat;

impl PixelIntegrator for Flat {
    fn sample(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> PixelSample {
        ctx.rays.camera += 1;
        let first = FirstHit { t: raster.x, n: Vec3::Z, uv: raster, object: 1, material: 1 };
        PixelSample { radiance: [0.25, 0.5, 0.75], first: Some(first) }
    }
}

/// Nanoseconds per sample, and whether the picture is right.
fn run(spec: FilmSpec, sampler: Sampler) -> (f64, bool) {
    let film = Film::new(spec, u64::MAX).expect("a sensible film");
    let settings = RenderSettings { threads: 1, ..RenderSettings::new(sampler) };
    let start = Instant::now();
    let stats = render(&Flat, &film, &settings, &Silent).expect("rendered");
    let ns = start.elapsed().as_secs_f64() * 1e9 / stats.samples as f64;
    let image = film.develop(Layer::Color).expect("colour");
    (ns, image.pixels().all(|rgb| (rgb[1] - 0.5).abs() < 1e-6))
}

fn main() {
    let color = LayerSet::of(&[Layer::Color]);
    let all = LayerSet::of(&Layer::ALL);
    let cases = [
        ("plain, regular 1", Filter::None, color, SamplerKind::Regular, 1),
        ("plain, regular 16", Filter::None, color, SamplerKind::Regular, 16),
        ("plain, jittered 16", Filter::None, color, SamplerKind::Jittered, 16),
        ("plain, all layers", Filter::None, all, SamplerKind::Jittered, 16),
        ("box 0.5", Filter::BOX, color, SamplerKind::Jittered, 16),
        ("tent 1", Filter::Tent { radius: 1.0 }, color, SamplerKind::Jittered, 16),
        ("gaussian 0.5", Filter::gaussian(0.5), color, SamplerKind::Jittered, 16),
        ("mitchell 2", Filter::MITCHELL, color, SamplerKind::Jittered, 16),
        ("lanczos 3", Filter::LANCZOS, color, SamplerKind::Jittered, 16),
    ];
    println!("{:20} {:>10} {:>10} {:>10}", "ns per sample", "median", "least", "most");
    let wanted = std::env::args().skip(1).find(|arg| !arg.starts_with('-')).unwrap_or_default();
    for (name, filter, layers, kind, n) in cases.into_iter().filter(|case| case.0.contains(&wanted)) {
        let spec = FilmSpec { filter, layers, one_pass: true, ..FilmSpec::new(800, 600) };
        let mut times = [0.0; 9];
        for time in &mut times {
            let (ns, right) = run(spec, Sampler::new(kind, n));
            assert!(right, "{name}: the picture is wrong");
            *time = ns;
        }
        times.sort_by(f64::total_cmp);
        println!("{name:20} {:10.1} {:10.1} {:10.1}", times[4], times[0], times[8]);
    }
}
