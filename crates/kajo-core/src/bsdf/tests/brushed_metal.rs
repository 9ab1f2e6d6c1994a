//! The generator of the tables of brushed metals, and the check that the file in the repository is what it makes.
//!
//! `KAJO_WRITE_ENERGY=1 cargo test --release -p kajo-core brushed_metal_tables` writes the file anew.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_2};

use kajo_math::{Vec2, Vec3};

use super::super::microfacet::NormalDistribution;
use super::super::*;
use brushed_metal::{ALPHAS, ASPECTS, COSINES, OF_SHAPE, TURNS};
use energy_tables::LARGEST;

/// Samples of one direction.
const SAMPLES: u32 = 2_048;

const DIRECTIONS: usize = COSINES * TURNS;

/// The direction of the nodes `j` of the cosine and `p` of the azimuth.
fn direction(p: usize, j: usize) -> Vec3 {
    let root = (j as f32 / (COSINES - 1) as f32).max(1e-3);
    let mu = root * root;
    let (s, c) = (p as f32 / (TURNS - 1) as f32 * FRAC_PI_2).sin_cos();
    let r = (1.0 - mu * mu).max(0.0).sqrt();
    Vec3::new(r * c, r * s, mu)
}

/// The facets of the nodes `a` of the roughness and `q` of the ratio.
fn facets(shape: NormalDistribution, a: usize, q: usize) -> Microfacets {
    let square = |i: usize, n: usize| (i as f32 / (n - 1) as f32).powi(2);
    let alpha_x = square(a, ALPHAS);
    Microfacets { shape, alpha_x, alpha_y: square(q, ASPECTS) * alpha_x }.held()
}

/// How a value at `x` of [0, 1] is shared between two of `nodes` nodes.
fn shared(x: f32, nodes: usize) -> [(usize, f64); 2] {
    let x = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
    let i = (x as usize).min(nodes - 2);
    let t = f64::from(x) - i as f64;
    [(i, 1.0 - t), (i + 1, t)]
}

/// Where light of a mirror lobe goes from a direction, in power: to each direction, by hat functions around the nodes.
fn scatter(facets: &Microfacets, wo: Vec3) -> Vec<f64> {
    let mut row = vec![0.0; DIRECTIONS];
    for k in 0..SAMPLES {
        // Points of the lattice of the plastic number, which fill the square evenly.
        let along = (0.5 + f64::from(k) * 0.754_877_666_246_692_8).fract();
        let across = (0.5 + f64::from(k) * 0.569_840_290_998_053_3).fract();
        let m = facets.sample(wo, Vec2::new(across as f32, along as f32));
        let wi = fresnel::reflect(-wo, m);
        if wi.z <= 0.0 {
            continue;
        }
        let weight = f64::from(facets.g2_over_g1(wo, wi)) / f64::from(SAMPLES);
        for (p, share) in shared(FRAC_2_PI * wi.y.abs().atan2(wi.x.abs()), TURNS) {
            for (j, part) in shared(wi.z.min(1.0).sqrt(), COSINES) {
                row[p * COSINES + j] += weight * share * part;
            }
        }
    }
    row
}

/// `s` with `s(o) ∫ f(o, i) s(i) di = 1`.
fn factors(facets: &Microfacets) -> Vec<f64> {
    let wo = (0..DIRECTIONS).map(|i| direction(i / COSINES, i % COSINES));
    let rows: Vec<_> = wo.map(|wo| scatter(facets, wo)).collect();
    let mut s = vec![1.0f64; DIRECTIONS];
    for _ in 0..100 {
        let old = s.clone();
        for (s, row) in s.iter_mut().zip(&rows) {
            *s = (*s / row.iter().zip(&old).map(|(a, b)| a * b).sum::<f64>()).sqrt();
        }
    }
    s
}

fn values(shape: NormalDistribution) -> Vec<u8> {
    std::thread::scope(|scope| {
        let rough =
            |a| move || (0..ASPECTS).flat_map(|q| factors(&facets(shape, a, q))).collect::<Vec<f64>>();
        let threads: Vec<_> = (0..ALPHAS).map(|a| scope.spawn(rough(a))).collect();
        let all = threads.into_iter().flat_map(|thread| thread.join().expect("generated"));
        let short = |s: f64| (s / f64::from(LARGEST) * 65535.0).round().clamp(0.0, 65535.0) as u16;
        all.flat_map(|s| short(s).to_le_bytes()).collect()
    })
}

#[test]
fn brushed_metal_tables_are_what_the_generator_makes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bsdf/brushed_metal.bin");
    if std::env::var_os("KAJO_WRITE_ENERGY").is_some() {
        let tables = [NormalDistribution::Ggx, NormalDistribution::Beckmann].map(values).concat();
        assert_eq!(tables.len(), 4 * OF_SHAPE);
        std::fs::write(path, tables).expect("the table is written");
        return;
    }
    for (shape, a, q) in [(NormalDistribution::Ggx, 9, 2), (NormalDistribution::Beckmann, ALPHAS - 1, 3)] {
        let facets = facets(shape, a, q);
        for (i, s) in factors(&facets).into_iter().enumerate() {
            let w = direction(i / COSINES, i % COSINES);
            let found = f64::from(brushed_metal::factor(&facets, w));
            assert!((found - s).abs() < 2e-3, "{shape:?} {a} {q} {w}: {found} for {s}");
        }
    }
}

/// Grain along y is grain along x seen from the side, and all four quarters are alike.
#[test]
fn quarters_are_alike() {
    let along = Microfacets { shape: NormalDistribution::Ggx, alpha_x: 0.6, alpha_y: 0.2 };
    let across = Microfacets { alpha_x: 0.2, alpha_y: 0.6, ..along };
    for (p, j) in [(0, 3), (2, 8), (5, 12), (9, 19)] {
        let w = direction(p, j);
        let expected = brushed_metal::factor(&along, w);
        for mirrored in [Vec3::new(-w.x, w.y, w.z), Vec3::new(w.x, -w.y, w.z)] {
            assert!((brushed_metal::factor(&along, mirrored) - expected).abs() < 1e-6, "{w}");
        }
        assert!((brushed_metal::factor(&across, Vec3::new(w.y, w.x, w.z)) - expected).abs() < 1e-5, "{w}");
    }
}
