//! The generator of the energy tables, and the check that the file in the repository is what it makes.
//!
//! `KAJO_WRITE_ENERGY=1 cargo test --release -p kajo-core energy_tables` writes the file anew.

use kajo_math::{Vec2, Vec3};

use super::super::microfacet::NormalDistribution;
use super::super::*;
use energy_tables::{ALPHAS, COSINES, INDICES, LARGEST, METAL_ALPHAS, STRONGEST, average};

/// Samples of one direction.
const SAMPLES: u32 = 4_096;

/// Where light goes from one cosine, in power: to each cosine on either side, by hat functions around the nodes.
type Row = [[f64; COSINES]; 2];

/// Light scattered once by facets for `wo` at the cosine of node `j`, with `eta` beyond over before; no index is
/// a perfect mirror.
fn scatter(facets: Microfacets, eta: Option<f32>, j: usize) -> Row {
    let mu = cosine_of(j).max(1e-6);
    let wo = at(mu);
    let mut row = [[0.0; COSINES]; 2];
    let mut add = |side: usize, cos: f32, weight: f32| {
        let x = cos.min(1.0).sqrt() * (COSINES - 1) as f32;
        let i = (x as usize).min(COSINES - 2);
        let t = f64::from(x) - i as f64;
        row[side][i] += (1.0 - t) * f64::from(weight);
        row[side][i + 1] += t * f64::from(weight);
    };
    for k in 0..SAMPLES {
        // Points of the lattice of the plastic number, which fill the square evenly.
        let along = (0.5 + f64::from(k) * 0.754_877_666_246_692_8).fract();
        let across = (0.5 + f64::from(k) * 0.569_840_290_998_053_3).fract();
        // Both sides of the plane of `wo` are alike.
        let u = Vec2::new(0.5 * across as f32, along as f32);
        // The number that turns normals out of that plane is the second one for Beckmann.
        let u = if facets.shape == NormalDistribution::Ggx { u } else { Vec2::new(u.y, u.x) };
        let m = facets.sample(wo, u);
        let cos = wo.dot(m);
        if cos <= 0.0 {
            continue;
        }
        let reflected = fresnel::reflect(-wo, m);
        let f = eta.map_or(1.0, |eta| fresnel::dielectric(cos, eta));
        if reflected.z > 0.0 {
            add(0, reflected.z, f * facets.g2_over_g1(wo, reflected));
        }
        if let Some(refracted) = eta.and_then(|eta| fresnel::refract(-wo, m, eta)).filter(|w| w.z < 0.0) {
            add(1, -refracted.z, (1.0 - f) * facets.through(wo, refracted) / facets.g1(wo));
        }
    }
    let n = f64::from(SAMPLES);
    row.map(|half| half.map(|sum| sum / n))
}

fn dot(a: &[f64; COSINES], b: &[f64; COSINES]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Where light goes from each cosine by facets that are perfect mirrors.
fn mirrored(facets: Microfacets) -> Vec<[f64; COSINES]> {
    (0..COSINES).map(|j| scatter(facets, None, j)[0]).collect()
}

/// How much of it goes anywhere.
fn once(rows: &[[f64; COSINES]]) -> impl Iterator<Item = f64> {
    rows.iter().map(|row| row.iter().sum::<f64>())
}

/// `s` with `s(o) ∫ f(o, i) s(i) di = 1`.
fn metal(rows: &[[f64; COSINES]]) -> [f64; COSINES] {
    let mut s = [1.0f64; COSINES];
    for _ in 0..200 {
        let old = s;
        for (s, row) in s.iter_mut().zip(rows) {
            *s = (*s / dot(row, &old)).sqrt();
        }
    }
    s
}

/// Loss and reflected share, seen through an index `eta` beyond over before.
fn clear(facets: Microfacets, eta: f32) -> [[f64; COSINES]; 2] {
    let rows: Vec<Row> = (0..COSINES).map(|j| scatter(facets, Some(eta), j)).collect();
    let sum = |half: &[f64; COSINES]| half.iter().sum::<f64>();
    let reflected = std::array::from_fn(|j| sum(&rows[j][0]));
    [std::array::from_fn(|j| (1.0 - sum(&rows[j][0]) - sum(&rows[j][1])).max(0.0)), reflected]
}

/// The cosine of node `j`: denser towards grazing directions.
fn cosine_of(j: usize) -> f32 {
    let root = j as f32 / (COSINES - 1) as f32;
    root * root
}

/// The direction of a cosine in the plane of x and z.
fn at(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// The facets of node `a` of `nodes`.
fn facets(shape: NormalDistribution, a: usize, nodes: usize) -> Microfacets {
    let root = a as f32 / (nodes - 1) as f32;
    Microfacets::new(shape, root * root).held()
}

/// The index of a node; that of 1 is approached.
fn index(n: usize) -> f32 {
    let root = n as f32 / (INDICES - 1) as f32;
    let y = STRONGEST * root * root;
    ((1.0 + y) / (1.0 - y)).max(1.002)
}

fn short(v: f64) -> u16 {
    (v.clamp(0.0, 1.0) * 65535.0).round() as u16
}

/// What the tables of clear media say of one index, for all roughnesses.
#[derive(Default)]
struct Clear {
    thin: Vec<u16>,
    dense: Vec<u16>,
    reflected: Vec<u16>,
    averages: [Vec<f32>; 2],
}

impl Clear {
    fn new(shape: NormalDistribution, n: usize) -> Clear {
        let mut tables = Clear::default();
        for a in 0..ALPHAS {
            let facets = facets(shape, a, ALPHAS);
            let [thin, reflected] = clear(facets, index(n)).map(|values| values.map(short));
            let [dense, _] = clear(facets, 1.0 / index(n)).map(|values| values.map(short));
            // Averages of the rounded numbers, so that what comes out is just what the tables say is lost.
            for (averages, lost) in tables.averages.iter_mut().zip([thin, dense]) {
                averages.push(average(&lost.map(|v| f64::from(v) / 65535.0)) as f32);
            }
            tables.thin.extend(thin);
            tables.dense.extend(dense);
            tables.reflected.extend(reflected);
        }
        tables
    }
}

/// The albedos of mirrors that are met once.
fn mirrors(shape: NormalDistribution) -> Vec<u8> {
    let rows = (0..METAL_ALPHAS).map(|a| mirrored(facets(shape, a, METAL_ALPHAS)));
    rows.flat_map(|rows| once(&rows).map(short).collect::<Vec<u16>>()).flat_map(u16::to_le_bytes).collect()
}

/// All values of one shape in the order of the file but those.
fn values(shape: NormalDistribution) -> Vec<u8> {
    let (metals, clears) = std::thread::scope(|scope| {
        let clears: Vec<_> = (0..INDICES).map(|n| scope.spawn(move || Clear::new(shape, n))).collect();
        let metals = (0..METAL_ALPHAS)
            .flat_map(|a| {
                metal(&mirrored(facets(shape, a, METAL_ALPHAS))).map(|s| short(s / f64::from(LARGEST)))
            })
            .collect::<Vec<u16>>();
        (metals, clears.into_iter().map(|thread| thread.join().expect("generated")).collect::<Vec<Clear>>())
    });
    let table = |of: fn(&Clear) -> &Vec<u16>| clears.iter().flat_map(of).copied().collect::<Vec<u16>>();
    let shorts = [metals, table(|c| &c.thin), table(|c| &c.dense), table(|c| &c.reflected)].concat();
    let averages =
        [0, 1].map(|side| clears.iter().flat_map(|c| c.averages[side].clone()).collect::<Vec<f32>>());
    let bytes = shorts.into_iter().flat_map(u16::to_le_bytes);
    bytes.chain(averages.concat().into_iter().flat_map(f32::to_le_bytes)).collect()
}

#[test]
fn energy_tables_are_what_the_generator_makes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bsdf/energy.bin");
    if std::env::var_os("KAJO_WRITE_ENERGY").is_some() {
        let shapes = [NormalDistribution::Ggx, NormalDistribution::Beckmann];
        let tables = [shapes.map(values).concat(), shapes.map(mirrors).concat()];
        std::fs::write(path, tables.concat()).expect("the table is written");
        return;
    }
    let close = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-4;
    for (shape, a) in [(NormalDistribution::Ggx, 40), (NormalDistribution::Beckmann, METAL_ALPHAS - 1)] {
        let facets = facets(shape, a, METAL_ALPHAS);
        let rows = mirrored(facets);
        for (j, s) in metal(&rows).into_iter().enumerate() {
            assert!(close(energy::metal(&facets, at(cosine_of(j))), s), "{shape:?} {a} {j}: {s}");
        }
        for (j, once) in once(&rows).enumerate() {
            assert!(close(energy::mirrored_once(&facets, cosine_of(j)), once), "{shape:?} {a} {j}: {once}");
        }
    }
    for (shape, a, n) in [
        (NormalDistribution::Ggx, 11, 4),
        (NormalDistribution::Ggx, ALPHAS - 1, 8),
        (NormalDistribution::Beckmann, 20, 5),
    ] {
        let facets = facets(shape, a, ALPHAS);
        let loss = energy::Loss::new(&facets, index(n));
        let [thin, reflected] = clear(facets, index(n));
        let [dense, _] = clear(facets, 1.0 / index(n));
        let [l1, l2] = [average(&thin), f64::from(index(n)).powi(2) * average(&dense)];
        for j in 0..COSINES {
            let cos = cosine_of(j);
            assert!(close(loss.lost(false, at(cos)), thin[j]) && close(loss.lost(true, at(cos)), dense[j]));
            assert!(
                close(loss.reflected(at(cos)), reflected[j] + thin[j] * l1 / (l1 + l2)),
                "{shape:?} {a} {n} {j}"
            );
        }
    }
}
