//! Textures whose values are known.

use std::f32::consts::FRAC_1_PI;

use kajo_math::{principal::symmetric_eigen, rng::Stream, warp};
use kajo_scene::{Assets, Limits, MemoryAssets, MemoryBudget};

use super::*;
use crate::measured::direction;

/// Directions in rings, `step` degrees apart, to at most 75 degrees.
pub fn rings(step: u32) -> Vec<[f32; 2]> {
    let ring =
        |k: u32| (0..6 * k).map(move |i| [(step * k) as f32 * PI / 180.0, TAU * i as f32 / (6 * k) as f32]);
    [[0.0; 2]].into_iter().chain((1..=75 / step).flat_map(ring)).collect()
}

/// Samples of a function of texel, view and light.
fn samples(
    size: [u32; 2],
    step: u32,
    has_cosine: bool,
    f: impl Fn([u32; 2], Vec3, Vec3) -> [f32; 3],
) -> BtfSamples {
    let (views, lights) = (rings(step), rings(step));
    let mut values = Vec::new();
    for (y, x) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (y, x))) {
        for &wo in &views {
            for &wi in &lights {
                let (wo, wi) = (direction(wo), direction(wi));
                let cos = if has_cosine { wi.z } else { 1.0 };
                values.extend(f([x, y], wo, wi).map(|v| v * cos));
            }
        }
    }
    BtfSamples { size, views, lights, has_cosine, values }
}

/// A symmetric gloss about a normal that leans, on a matt ground.
fn glossy(lean: Vec3, exponent: f32) -> impl Fn(Vec3, Vec3) -> f32 {
    move |wo, wi| {
        let n = lean.normalize();
        let h = (wo + wi).normalize_or(Vec3::Z);
        0.2 * FRAC_1_PI + 0.2 * fmath::pow(h.dot(n).max(0.0), exponent)
    }
}

fn threads([x, y]: [u32; 2], wo: Vec3, wi: Vec3) -> [f32; 3] {
    let (sin, cos) = fmath::sin_cos(TAU * (x + 2 * y) as f32 / 8.0);
    let value = glossy(Vec3::new(0.4 * cos, 0.4 * sin, 1.0), 12.0)(wo, wi);
    [value, 0.6 * value, 0.3 + 0.02 * y as f32 * wi.x]
}

/// A texture of 8 x 8 texels with highlights that turn.
pub fn cloth_texture() -> Btf {
    let all = samples([8, 8], 18, false, |at, wo, wi| threads(at, wo, wi).map(|v| v * 0.5));
    Btf::new(compress(&all, &Compression { clusters: 2, components: 5 })).unwrap()
}

/// Everything is kept: a cluster for each texel.
const ALL: Compression = Compression { clusters: 1 << 16, components: 0 };

fn upper(i: u32) -> Vec3 {
    let s = Stream::new(17, [i, 0], 0);
    warp::uniform_hemisphere(Vec2::new(s.uniform(0), s.uniform(1)))
}

#[test]
fn stored_pairs_are_exact() {
    let noise = |[x, y]: [u32; 2], wo: Vec3, wi: Vec3| {
        let bits = wo.x.to_bits() ^ wo.y.to_bits().rotate_left(7) ^ wi.x.to_bits().rotate_left(13);
        let s = Stream::new(5, [x + 16 * y, bits ^ wi.y.to_bits().rotate_left(21)], 0);
        [s.uniform(0), s.uniform(1), s.uniform(2)]
    };
    let all = samples([3, 2], 25, false, noise);
    let btf = Btf::new(compress(&all, &ALL)).unwrap();
    for (y, x) in (0..2).flat_map(|y| (0..3).map(move |x| (y, x))) {
        for (&wo, &wi) in all.views.iter().flat_map(|wo| all.lights.iter().map(move |wi| (wo, wi))) {
            let (wo, wi) = (direction(wo), direction(wi));
            assert_eq!(btf.value(btf.texel(0, x, y), wo, wi), noise([x as u32, y as u32], wo, wi));
        }
    }
    // As they were measured, with the cosine.
    let with = Btf::new(compress(&samples([3, 2], 25, true, noise), &ALL)).unwrap();
    for (&wo, &wi) in all.views.iter().flat_map(|wo| all.lights.iter().map(move |wi| (wo, wi))) {
        let (wo, wi) = (direction(wo), direction(wi));
        let (found, expected) = (with.value(with.texel(0, 1, 1), wo, wi), noise([1, 1], wo, wi));
        assert!((0..3).all(|i| (found[i] - expected[i]).abs() <= 1e-6), "{found:?} {expected:?}");
    }
}

#[test]
fn affine_functions_of_the_plane_are_exact_between_directions() {
    let projected = |w: Vec3| w.truncate() / (1.0 + w.z);
    let f = |wo: Vec3, wi: Vec3| {
        let (o, i) = (projected(wo), projected(wi));
        (0.5 + 0.2 * o.x - 0.1 * o.y) * (0.4 - 0.3 * i.x + 0.1 * i.y)
    };
    let btf = Btf::new(compress(&samples([1, 1], 15, false, |_, wo, wi| [f(wo, wi); 3]), &ALL)).unwrap();
    let inside = |w: &Vec3| w.z > fmath::cos(72.0 * PI / 180.0);
    for (wo, wi) in
        (0..2000).map(|i| (upper(2 * i), upper(2 * i + 1))).filter(|(o, i)| inside(o) && inside(i))
    {
        let found = btf.value(btf.texel(0, 0, 0), wo, wi)[0];
        assert!((found - f(wo, wi)).abs() < 1e-5, "{wo} {wi}: {found} {}", f(wo, wi));
    }
}

/// A known BRDF between its samples: the error falls with their number.
#[test]
fn more_directions_are_nearer_to_a_known_brdf() {
    let f = glossy(Vec3::Z, 4.0);
    let error = |step| {
        let btf =
            Btf::new(compress(&samples([1, 1], step, false, |_, wo, wi| [f(wo, wi); 3]), &ALL)).unwrap();
        let off = |i: u32| {
            let (wo, wi) = (upper(2 * i), upper(2 * i + 1));
            if wo.z.min(wi.z) < 0.3 {
                return 0.0;
            }
            f64::from((btf.value(btf.texel(0, 0, 0), wo, wi)[0] - f(wo, wi)).abs())
        };
        (0..2000).map(off).sum::<f64>() / 2000.0
    };
    let errors = [25, 15, 10].map(error);
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
}

#[test]
fn the_error_of_one_cluster_is_that_of_the_singular_values() {
    let all = samples([6, 5], 37, false, threads);
    let width = 3 * all.views.len() * all.lights.len();
    let mean: Vec<f64> = (0..width)
        .map(|i| all.values.iter().skip(i).step_by(width).map(|&v| f64::from(v)).sum::<f64>() / 30.0)
        .collect();
    let centred = |t: usize, i: usize| f64::from(all.values[t * width + i]) - mean[i];
    let dot = |a: usize, b: usize| (0..width).map(|i| centred(a, i) * centred(b, i)).sum::<f64>();
    let gram: Vec<f64> = (0..900).map(|i| dot(i / 30, i % 30)).collect();
    let (squares, _) = symmetric_eigen(&gram, 30);
    for components in [1, 2, 4] {
        let file = compress(&all, &Compression { clusters: 1, components });
        let mut error = 0.0;
        for t in 0..30 {
            for i in 0..width {
                let weights = &file.texel_weights[t * components as usize..];
                let parts = (0..components as usize)
                    .map(|k| f64::from(weights[k]) * f64::from(file.clusters[(k + 1) * width + i]));
                let found = f64::from(file.clusters[i]) + parts.sum::<f64>();
                error += (found - f64::from(all.values[t * width + i])).powi(2);
            }
        }
        let (least, whole): (f64, f64) = (squares[components as usize..].iter().sum(), squares.iter().sum());
        assert!((error - least).abs() < 1e-6 * whole, "{components}: {error} for {least} of {whole}");
        let clustered = compress(&all, &Compression { clusters: 3, components });
        assert_eq!(clustered.cluster_count(), 3);
    }
}

#[test]
fn a_flat_texture_reflects_its_albedo() {
    for (has_cosine, rho) in [(false, 0.7), (true, 0.7), (true, 0.2)] {
        let all = samples([2, 2], 15, has_cosine, |_, _, _| [rho * FRAC_1_PI; 3]);
        let btf = Btf::new(compress(&all, &Compression::default())).unwrap();
        let texel = btf.texel(0, 0, 0);
        for wo in [Vec3::Z, direction([0.7, 1.0]), direction([1.45, 4.0])] {
            let n = 128;
            let mut sum = 0.0;
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let wi = btf.sample(wo, u, (i as f32 * 0.618_034).fract());
                sum += f64::from(btf.value(texel, wo, wi)[0] * wi.z / btf.pdf(wo, wi));
            }
            let found = sum / f64::from(n * n);
            let exact = |v: f64| (v / f64::from(rho) - 1.0).abs() < 0.005;
            assert!(exact(found) && exact(btf.albedo(texel, wo)[1].into()), "{has_cosine} {wo}: {found}");
        }
        assert!((btf.mean_albedo()[0] - rho).abs() < 1e-3);
    }
}

#[test]
fn symmetric_samples_are_symmetric_in_between() {
    let f = glossy(Vec3::new(0.2, 0.1, 1.0), 20.0);
    let all = samples([2, 1], 15, true, |_, wo, wi| [f(wo, wi); 3]);
    let btf = Btf::new(compress(&all, &Compression { clusters: 1, components: 1 })).unwrap();
    for (wo, wi) in (0..2000).map(|i| (upper(2 * i), upper(2 * i + 1))) {
        let texel = btf.texel(0, 1, 0);
        let (there, back) = (btf.value(texel, wo, wi)[0], btf.value(texel, wi, wo)[0]);
        assert!((there - back).abs() < 0.01 * there.max(back), "{wo} {wi}: {there} {back}");
    }
}

#[test]
fn smaller_copies_are_means_and_texels_repeat() {
    let all = samples([6, 4], 37, false, |at, wo, wi| threads(at, wo, wi).map(|v| v * 0.5));
    let btf = Btf::new(compress(&all, &Compression { clusters: 1, components: 24 })).unwrap();
    assert_eq!((btf.level_count(), btf.level_size(1), btf.level_size(9)), (3, [3, 2], [1, 1]));
    assert_eq!(btf.texel(0, -1, 4), btf.texel(0, 5, 0));
    let (wo, wi) = (direction([0.5, 0.3]), direction([0.8, 4.0]));
    let at = |level: usize, x: i64, y: i64| btf.value(btf.texel(level, x, y), wo, wi)[0];
    let four = 0.25 * (at(0, 2, 2) + at(0, 3, 2) + at(0, 2, 3) + at(0, 3, 3));
    assert!((at(1, 1, 1) - four).abs() < 1e-5, "{} {four}", at(1, 1, 1));
    let whole = (0..24).map(|i| at(0, i % 6, i / 6)).sum::<f32>() / 24.0;
    assert!((at(2, 0, 0) - whole).abs() < 1e-5, "{} {whole}", at(2, 0, 0));
}

fn read(bytes: &[u8]) -> Result<(BtfFile, BtfEncoding), BtfError> {
    let assets = MemoryAssets::new().with("x.btf", bytes);
    let limits = Limits { memory: MemoryBudget::new(1 << 24), ..Limits::default() };
    let (file, encoding, _) = read_btf(assets.open("x.btf", "").unwrap(), &limits)?;
    Ok((file, encoding))
}

fn small() -> BtfFile {
    compress(&samples([3, 2], 37, true, threads), &Compression { clusters: 2, components: 2 })
}

#[test]
fn files_are_read_as_they_were_written() {
    let file = small();
    assert_eq!(read(&write_btf(&file, BtfEncoding::Float)).unwrap(), (file.clone(), BtfEncoding::Float));
    let (halves, encoding) = read(&write_btf(&file, BtfEncoding::Half)).unwrap();
    assert_eq!(encoding, BtfEncoding::Half);
    let pairs = std::iter::zip(&halves.clusters, &file.clusters);
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() <= 5e-4 * b.abs() + 1e-7));
    // What is written again is the same.
    assert_eq!(read(&write_btf(&halves, BtfEncoding::Half)).unwrap().0, halves);
}

#[test]
fn damaged_files_are_refused_in_words() {
    let good = write_btf(&small(), BtfEncoding::Half);
    for length in (0..good.len()).step_by(7).chain([good.len() - 1]) {
        let error = read(&good[..length]).unwrap_err();
        assert!(matches!(error, BtfError::Short(_) | BtfError::Magic), "{length}: {error}");
    }
    assert!(matches!(read(&[&good[..], b"x"].concat()).unwrap_err(), BtfError::Long));
    for at in (0..good.len()).step_by(11) {
        let mut bytes = good.clone();
        bytes[at] ^= 0x40;
        read(&bytes).unwrap_err();
    }
    let error = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.clone();
        change(&mut bytes);
        read(&bytes).unwrap_err().to_string()
    };
    let last = good.len() - 20;
    assert!(error(&|b| b[last] ^= 1).contains("checksum"));
    assert!(error(&|b| b[8] = 9).contains("version 9"));
    assert!(error(&|b| b[12] = 16).contains("flags"));
    assert!(error(&|b| b[16..20].fill(0)).contains("0 texels across"));
    assert!(error(&|b| b[24..28].fill(255)).contains("4294967295 views"));
    // Numbers that promise more than there is end with the file, not with memory.
    assert!(
        error(&|b| b[16..20].copy_from_slice(&60_000u32.to_le_bytes())).contains("ends within its texels")
    );
    assert!(error(&|b| b[28..32].copy_from_slice(&8000u32.to_le_bytes())).contains("ends within its"));
}

#[test]
fn directions_that_are_none_are_refused() {
    let wrong = |change: &dyn Fn(&mut BtfFile)| {
        let mut file = small();
        change(&mut file);
        Btf::new(file).unwrap_err().to_string()
    };
    assert!(wrong(&|f| f.views[2] = f.views[1]).contains("views: directions 1 and 2 are the same"));
    assert!(wrong(&|f| f.lights[3] = [2.0, 0.0]).contains("lights: direction 3"));
    assert!(wrong(&|f| f.lights[3] = [FRAC_1_PI * PI * 1.5706, 0.0]).contains("light 3 is on the horizon"));
    assert!(wrong(&|f| f.clusters[5] = f32::NAN).contains("not a number"));
    assert!(wrong(&|f| f.texel_clusters[1] = 7).contains("cluster 7, and there are 2"));
    assert!(wrong(&|f| f.texel_weights.truncate(3)).contains("lengths"));
}
