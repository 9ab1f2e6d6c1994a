//! The generator of the tables of brushed clear media, and the check that the file in the repository is what it makes.
//!
//! `KAJO_WRITE_ENERGY=1 cargo test --release -p kajo-core brushed_clear_tables` writes the file anew, from the tables of
//! facets of one roughness.

use std::f32::consts::FRAC_PI_2;

use kajo_math::{Vec2, Vec3};

use super::super::microfacet::NormalDistribution;
use super::super::*;
use brushed_clear::{
    ALPHAS, ASPECTS, BrushedClear, COSINES, INDICES, OF_SHAPE, OF_TABLE, SURFACES, TURNS, mean_surface,
};
use energy_tables::{EvenTables, STRONGEST};

/// Samples of one direction.
const SAMPLES: u32 = 4_096;

/// A node of everything but directions.
#[derive(Clone, Copy)]
struct Surface {
    facets: Microfacets,
    n: f32,
}

impl Surface {
    /// The surface of the nodes of index, roughness and ratio, ratios fastest.
    fn new(shape: NormalDistribution, number: usize) -> Surface {
        let square = |i: usize, n: usize| (i as f32 / (n - 1) as f32).powi(2);
        let rough = square(number / ASPECTS % ALPHAS, ALPHAS);
        let alpha_y = square(number % ASPECTS, ASPECTS) * rough;
        let facets = Microfacets { shape, alpha_x: rough, alpha_y }.held();
        let y = STRONGEST * square(number / (ASPECTS * ALPHAS), INDICES);
        Surface { facets, n: ((1.0 + y) / (1.0 - y)).max(1.002) }
    }

    /// What single facets lose of light from `wo`, on the side of the higher index or the other, and what they reflect there.
    fn scatter(&self, dense: bool, wo: Vec3) -> [f64; 2] {
        let (facets, eta) = (&self.facets, if dense { 1.0 / self.n } else { self.n });
        let (mut reflected, mut transmitted) = (0.0, 0.0);
        for k in 0..SAMPLES {
            // Points of the lattice of the plastic number, which fill the square evenly.
            let along = (0.5 + f64::from(k) * 0.754_877_666_246_692_8).fract();
            let across = (0.5 + f64::from(k) * 0.569_840_290_998_053_3).fract();
            let m = facets.sample(wo, Vec2::new(across as f32, along as f32));
            let cos = wo.dot(m);
            if cos <= 0.0 {
                continue;
            }
            let f = fresnel::dielectric(cos, eta);
            let up = fresnel::reflect(-wo, m);
            if up.z > 0.0 {
                reflected += f64::from(f * facets.g2_over_g1(wo, up));
            }
            if let Some(down) = fresnel::refract(-wo, m, eta).filter(|w| w.z < 0.0) {
                transmitted += f64::from((1.0 - f) * facets.through(wo, down) / facets.g1(wo));
            }
        }
        let n = f64::from(SAMPLES);
        [(1.0 - (reflected + transmitted) / n).max(0.0), reflected / n]
    }

    /// The tables of facets that are as rough everywhere as these are along the azimuth of `w`.
    fn even(&self, w: Vec3) -> EvenTables {
        let Microfacets { shape, alpha_x, alpha_y } = self.facets;
        let aside = w.truncate().normalize_or(Vec2::splat(0.5f32.sqrt()));
        EvenTables::new(shape, (alpha_x * aside.x).hypot(alpha_y * aside.y), self.n)
    }

    /// The differences in one direction: of both sides' loss, and of what is reflected.
    fn differences(&self, w: Vec3) -> [f64; 3] {
        let even = self.even(w);
        let [[thin, reflected], [dense, _]] = [false, true].map(|dense| self.scatter(dense, w));
        [
            thin - f64::from(even.lost(false, w.z)),
            dense - f64::from(even.lost(true, w.z)),
            reflected - f64::from(even.reflected_once(w.z)),
        ]
    }

    /// The averages over the hemisphere, weighted by the cosine, of what the tables say is lost, less those of facets of the root
    /// mean square of both roughnesses.
    ///
    /// * `nodes`: the differences of all directions
    fn averages(&self, nodes: &[[i16; 3]]) -> [f32; 2] {
        const STEPS: usize = 48;
        let mut sums = [0.0; 2];
        for i in 0..STEPS * STEPS {
            let [x, t] = [i / STEPS, i % STEPS].map(|k| (k as f32 + 0.5) / STEPS as f32);
            let w = direction(t, x);
            let even = self.even(w);
            let place = |x: f32, nodes: usize| energy_tables::Between::new(x, nodes);
            for (side, sum) in sums.iter_mut().enumerate() {
                let node = |p: usize, j: usize| f32::from(nodes[p * COSINES + j][side]) / 32767.0;
                let d = place(t, TURNS).mix(|p| place(x, COSINES).mix(|j| node(p, j)));
                let lost = (even.lost(side == 1, w.z) + d).clamp(0.0, 1.0);
                // The hemisphere's `2 cos d cos` with the cosine the square of x.
                *sum += f64::from(lost * 4.0 * x * x * x);
            }
        }
        let mean = mean_surface(&self.facets, self.n).averages();
        [0, 1].map(|side| (sums[side] / (STEPS * STEPS) as f64 - f64::from(mean[side])) as f32)
    }
}

/// The direction with this share of the quarter as its azimuth and this root of its cosine; straight above, just so far
/// aside that it has an azimuth.
fn direction(turn: f32, root: f32) -> Vec3 {
    let mu = root.clamp(1e-3, 1.0 - 1e-5).powi(2);
    let (s, c) = (turn * FRAC_PI_2).sin_cos();
    let r = (1.0 - mu * mu).max(0.0).sqrt();
    Vec3::new(r * c, r * s, mu)
}

/// The direction of a node, cosines fastest.
fn node(i: usize) -> Vec3 {
    let share = |i: usize, n: usize| i as f32 / (n - 1) as f32;
    direction(share(i / COSINES, TURNS), share(i % COSINES, COSINES))
}

fn short(d: f64) -> i16 {
    (d * 32767.0).round() as i16
}

/// The tables of one shape.
fn tables(shape: NormalDistribution) -> Vec<u8> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let surface =
        |s: usize| (0..COSINES * TURNS).map(move |i| Surface::new(shape, s).differences(node(i)).map(short));
    let all: Vec<[i16; 3]> = std::thread::scope(|scope| {
        let part = SURFACES.div_ceil(threads);
        let made = (0..threads).map(|t| {
            scope
                .spawn(move || (t * part..SURFACES.min((t + 1) * part)).flat_map(surface).collect::<Vec<_>>())
        });
        let made: Vec<_> = made.collect();
        made.into_iter().flat_map(|thread| thread.join().expect("generated")).collect()
    });
    assert_eq!(all.len(), OF_TABLE);
    let mut bytes: Vec<u8> = (0..3).flat_map(|k| all.iter().flat_map(move |d| d[k].to_le_bytes())).collect();
    let averages: Vec<_> = all
        .chunks(COSINES * TURNS)
        .enumerate()
        .map(|(s, nodes)| Surface::new(shape, s).averages(nodes))
        .collect();
    bytes.extend((0..2).flat_map(|side| averages.iter().flat_map(move |l| l[side].to_le_bytes())));
    assert_eq!(bytes.len(), OF_SHAPE);
    bytes
}

#[test]
fn brushed_clear_tables_are_what_the_generator_makes() {
    let shapes = [NormalDistribution::Ggx, NormalDistribution::Beckmann];
    if std::env::var_os("KAJO_WRITE_ENERGY").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bsdf/brushed_clear.bin");
        std::fs::write(path, shapes.map(tables).concat()).expect("the table is written");
        return;
    }
    let numbers =
        [(3 * ALPHAS + 6) * ASPECTS + 2, (5 * ALPHAS + 9) * ASPECTS + 1, (ALPHAS + 3) * ASPECTS + 4];
    for (shape, number) in shapes.into_iter().flat_map(|shape| numbers.map(|number| (shape, number))) {
        let surface = Surface::new(shape, number);
        let found = BrushedClear::new(&surface.facets, surface.n);
        for i in (0..COSINES * TURNS).step_by(7) {
            let w = node(i);
            let [[thin, reflected], [dense, _]] = [false, true].map(|dense| surface.scatter(dense, w));
            for (found, expected) in [
                (found.lost(false, w), thin),
                (found.lost(true, w), dense),
                (found.reflected_once(w), reflected),
            ] {
                assert!(
                    (f64::from(found) - expected).abs() < 1e-3,
                    "{shape:?} {number} {w}: {found} for {expected}"
                );
            }
        }
    }
}

/// Between nodes too, most of all near straight above, where one step of the cosine has all azimuths; and what is lost comes
/// out again.
#[test]
fn tables_of_clear_media_hold_between_their_nodes() {
    const STEPS: usize = 12;
    for shape in [NormalDistribution::Ggx, NormalDistribution::Beckmann] {
        for (alpha, anisotropy, n) in [(0.49, 0.6, 1.5), (0.25, 0.6, 1.5), (0.49, 0.6, 1.05)] {
            let surface = Surface { facets: Microfacets::brushed(shape, alpha, anisotropy).held(), n };
            let found = BrushedClear::new(&surface.facets, n);
            let (mut averages, mut off) = ([0.0; 2], [0.0; 2]);
            for i in 0..STEPS * STEPS {
                let [x, t] = [i / STEPS, i % STEPS].map(|k| (k as f32 + 0.5) / STEPS as f32);
                let (w, weight) = (direction(t, x), f64::from(4.0 * x * x * x) / (STEPS * STEPS) as f64);
                for side in [0, 1] {
                    let lost = f64::from(found.lost(side == 1, w));
                    let [expected, _] = surface.scatter(side == 1, w);
                    averages[side] += weight * lost;
                    off[side] += weight * (lost - expected).abs();
                    let step = if x > 0.9 { 0.012 } else { 0.03 };
                    assert!(
                        (lost - expected).abs() < step,
                        "{shape:?} {alpha} {n} {w}: {lost} for {expected}"
                    );
                }
            }
            assert!(off[0] < 4e-4 && off[1] < 4e-3, "{shape:?} {alpha} {n}: {off:?}");
            let expected = 1.0 / (averages[0] + f64::from(n * n) * averages[1]);
            let density = f64::from(found.density[0]);
            assert!(
                (density / expected - 1.0).abs() < 0.01,
                "{shape:?} {alpha} {n}: {density} for {expected}"
            );
        }
    }
}

/// Grain along y is grain along x seen from the side, and all four quarters of both sides are alike.
#[test]
fn quarters_of_clear_media_are_alike() {
    let facets =
        |[alpha_x, alpha_y]: [f32; 2]| Microfacets { shape: NormalDistribution::Beckmann, alpha_x, alpha_y };
    let [along, across] = [[0.6, 0.2], [0.2, 0.6]].map(|alphas| BrushedClear::new(&facets(alphas), 1.5));
    for w in [direction(0.1, 0.3), direction(0.5, 0.7), direction(0.9, 0.9)] {
        let expected = along.lost(true, w);
        for mirrored in [Vec3::new(-w.x, w.y, w.z), Vec3::new(w.x, -w.y, w.z), -w] {
            assert!((along.lost(true, mirrored) - expected).abs() < 1e-6, "{w}");
        }
        assert!((across.lost(true, Vec3::new(w.y, w.x, w.z)) - expected).abs() < 1e-5, "{w}");
    }
}
