//! Do directions follow their density?
//!
//! A pilot run finds out where directions fall. Cells are rings around their mean, each with an equal
//! share of the pilot, cut into sectors; what the density puts into each is integrated along one angle and then along the
//! other, each time by Gauss-Kronrod quadrature that halves what is not settled. So it follows a density that ends abruptly, or
//! that grows without bound towards an outline like one over the root of the distance: a line meets those in few points, around which
//! halving is cheap. The runs that give no direction make one cell more, which expects what the
//! density leaves over. [Subr and Arvo 2007]

use std::f64::consts::{PI, TAU};

use kajo_math::{Frame, Vec2, Vec3, rng::Stream};

use crate::ChiSquare;

const RINGS: usize = 10;
const SECTORS: usize = 12;

/// Error allowed in the share of one cell.
const TOLERANCE: f64 = 1e-5;

/// How often an interval is halved at most: towards a point where a density grows like one over the root of the distance, a
/// thousandth of what is in the interval is left by then.
const MOST_HALVINGS: u32 = 20;

/// Error of the quadrature where a density ends abruptly, as a share of everything.
const SHARP_EDGES: f64 = 1e-3;

/// Compares `n` directions with their density.
///
/// * `sample`: a unit direction, or none, for `u` uniform in [0, 1)² and a third uniform number
/// * `pdf`: density per solid angle; its integral is the probability that there is a direction
pub fn test(
    n: u32,
    seed: u64,
    sample: impl Fn(Vec2, f32) -> Option<Vec3>,
    pdf: impl Fn(Vec3) -> f32,
) -> ChiSquare {
    let draw = |i: u32, run: u32| {
        let s = Stream::new(seed, [i, run], 0);
        sample(Vec2::new(s.uniform(0), s.uniform(1)), s.uniform(2))
    };
    let pilot: Vec<Vec3> = (0..n / 4).filter_map(|i| draw(i, 0)).collect();
    let mean = pilot.iter().sum::<Vec3>().normalize_or(Vec3::Z);
    let frame = Frame::from_normal(mean);
    let polar = |w: Vec3| {
        let w = frame.to_local(w).as_dvec3();
        (w.x.hypot(w.y).atan2(w.z), w.y.atan2(w.x).rem_euclid(TAU))
    };
    let mut angles: Vec<f64> = pilot.iter().map(|&w| polar(w).0).collect();
    angles.sort_by(f64::total_cmp);
    // Upper edges of the rings.
    let mut edges: Vec<f64> =
        (1..RINGS).filter_map(|i| angles.get(i * angles.len() / RINGS).copied()).collect();
    // Beyond the pilot's bulk rings widen, so that the quadrature does not step over what is left of a narrow lobe.
    while let Some(&last) = edges.last().filter(|&&last| last > 0.0 && 1.5 * last < PI) {
        edges.push(1.5 * last);
    }
    edges.push(PI);

    let mut observed = vec![0.0; edges.len() * SECTORS + 1];
    for i in 0..n {
        let cell = draw(i, 1).map(|w| {
            let (theta, phi) = polar(w);
            let ring = edges.partition_point(|&edge| edge < theta).min(edges.len() - 1);
            ring * SECTORS + ((phi / TAU * SECTORS as f64) as usize).min(SECTORS - 1)
        });
        observed[cell.unwrap_or(edges.len() * SECTORS)] += 1.0;
    }

    let density = |theta: f64, phi: f64| {
        let (s, c) = theta.sin_cos();
        let w = Vec3::new((s * phi.cos()) as f32, (s * phi.sin()) as f32, c as f32);
        f64::from(pdf(frame.to_world(w).normalize())) * s
    };
    let mut expected = Vec::with_capacity(observed.len());
    let mut bottom = 0.0;
    for &top in &edges {
        for sector in 0..SECTORS {
            let width = TAU / SECTORS as f64;
            let cell = [bottom, top, sector as f64 * width, (sector + 1) as f64 * width];
            expected.push(f64::from(n) * integrate(&density, cell));
        }
        bottom = top;
    }
    // What is left over is known no better than by the quadrature's error.
    let (none, error) = (f64::from(n) - expected.iter().sum::<f64>(), TOLERANCE * f64::from(n));
    expected.push(none.max(error));
    // More than everything may be expected by as much as the quadrature loses at sharp edges. Beyond that it is as wrong
    // as less: as if so many had gone nowhere.
    observed[edges.len() * SECTORS] += (-none - SHARP_EDGES * f64::from(n)).max(0.0);
    // Rounding of single precision can carry a direction over the edge of a cell that expects nothing.
    let expected: Vec<f64> = expected.into_iter().map(|e| e.max(1e-3)).collect();
    ChiSquare::test(&observed, &expected)
}

/// The integral of `f` over a rectangle `[x0, x1, y0, y1]`.
fn integrate(f: &impl Fn(f64, f64) -> f64, [x0, x1, y0, y1]: [f64; 4]) -> f64 {
    let tolerance = TOLERANCE / 16.0;
    // Each line may be off by as much as the whole.
    let along_x = |y: f64| integrate_line(&|x| f(x, y), [x0, x1], tolerance / (y1 - y0));
    integrate_line(&along_x, [y0, y1], tolerance)
}

/// The integral of `f` over an interval, to about `tolerance`.
fn integrate_line(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2], tolerance: f64) -> f64 {
    // Fine enough a start that no lobe slips through.
    let middle = 0.5 * (from + to);
    [[from, middle], [middle, to]].into_iter().map(|half| refine(f, half, tolerance, MOST_HALVINGS)).sum()
}

fn refine(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2], tolerance: f64, halvings: u32) -> f64 {
    let [sum, error] = gauss_kronrod(f, [from, to]);
    if halvings == 0 || error < tolerance {
        return sum;
    }
    let middle = 0.5 * (from + to);
    [[from, middle], [middle, to]].into_iter().map(|half| refine(f, half, tolerance, halvings - 1)).sum()
}

/// The integral of `f` over an interval by the rule of 15 points, and by how much that differs from the rule of 7 of them
/// [Kronrod 1965].
fn gauss_kronrod(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> [f64; 2] {
    /// Point, weight of all 15 and of the 7; the points on one side, the outermost first.
    const POINTS: [[f64; 3]; 7] = [
        [0.991_455_371_120_812_6, 0.022_935_322_010_529_22, 0.0],
        [0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7],
        [0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0],
        [0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_67],
        [0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0],
        [0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9],
        [0.207_784_955_007_898_47, 0.204_432_940_075_298_89, 0.0],
    ];
    const MIDDLE: [f64; 2] = [0.209_482_141_084_727_83, 0.417_959_183_673_469_4];
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let value = f(middle);
    let [mut all, mut some] = MIDDLE.map(|weight| weight * value);
    for [point, of_all, of_some] in POINTS {
        let value = f(middle - half * point) + f(middle + half * point);
        all += of_all * value;
        some += of_some * value;
    }
    [half * all, half * (all - some).abs()]
}

/// The mean of `f` over the unit square and a third uniform number, by `side`² samples: one in each cell of
/// a grid, the third numbers evenly spread too.
pub fn stratified_mean(side: u32, seed: u64, mut f: impl FnMut(Vec2, f32) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..side * side {
        let s = Stream::new(seed, [i, 0], 0);
        let jitter = Vec2::new(s.uniform(0), s.uniform(1));
        let u = (Vec2::new((i % side) as f32, (i / side) as f32) + jitter) / side as f32;
        // Multiples of the golden ratio fill the interval evenly.
        let golden = (f64::from(i) * 0.618_033_988_749_894_9
            + f64::from(s.uniform(2)) / f64::from(side * side))
        .fract();
        let below_one = 1.0 - f32::EPSILON;
        sum += f(u.min(Vec2::splat(below_one)), (golden as f32).min(below_one));
    }
    sum / f64::from(side * side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::warp;

    fn cosine(n: u32, pdf: impl Fn(Vec3) -> f32) -> ChiSquare {
        test(n, 5, |u, uc| (uc < 0.75).then(|| warp::cosine_hemisphere(u)), pdf)
    }

    #[test]
    fn the_right_density_passes_and_wrong_ones_fail() {
        let right = |w: Vec3| 0.75 * w.z.max(0.0) / std::f32::consts::PI;
        assert!(cosine(100_000, right).passes(0.01, 1));
        assert!(!cosine(100_000, |w| right(w) / 0.75).passes(0.01, 1), "directions that are missing");
        assert!(
            !cosine(100_000, |w| if w.z > 0.0 { 0.75 / std::f32::consts::TAU } else { 0.0 }).passes(0.01, 1)
        );
        assert!(
            !cosine(100_000, |w| right(w) * (1.0 + 0.1 * w.x)).passes(0.01, 1),
            "a tenth more on one side"
        );
        assert!(!test(1000, 5, |_, _| None, right).passes(0.01, 1), "no directions at all");
        let beside = |w: Vec3| if w.z < 0.0 { -0.5 * w.z / std::f32::consts::PI } else { right(w) };
        assert!(!cosine(100_000, beside).passes(0.01, 1), "a density of 1.25 in all");
    }

    #[test]
    fn narrow_lobes_are_found_by_the_quadrature() {
        // A cap of one degree, straight down, uniform.
        let cos = 1f32.to_radians().cos();
        let pdf = 1.0 / (std::f32::consts::TAU * (1.0 - cos));
        let sample = |u: Vec2, _| {
            let z = 1.0 - u.x * (1.0 - cos);
            let (s, c) = (std::f32::consts::TAU * u.y).sin_cos();
            let r = (1.0 - z * z).sqrt();
            Some(Vec3::new(r * c, r * s, -z))
        };
        let inside = |w: Vec3| if -w.z >= cos { pdf } else { 0.0 };
        let result = test(100_000, 6, sample, inside);
        assert!(result.passes(0.01, 1), "{result:?}");
    }

    /// Rims near which a density grows without bound, and beyond which there is nothing, across cells at any angle: the share of
    /// a sphere's surface that is seen through each part of a disk, `1 / (2 pi r sqrt(r^2 - d^2))`.
    #[test]
    fn the_quadrature_follows_outlines() {
        let r = 0.7f64;
        let disk = |x: f64, y: f64| {
            let inside = r * r - (x - 0.13).powi(2) - (y - 0.07).powi(2);
            if inside > 0.0 { 1.0 / (TAU * r * inside.sqrt()) } else { 0.0 }
        };
        for cells in [5, 10, 20] {
            let edge = |i: i32| -1.0 + 2.0 * f64::from(i) / f64::from(cells);
            let cell = |i: i32| {
                let (x, y) = (i % cells, i / cells);
                integrate(&disk, [edge(x), edge(x + 1), edge(y), edge(y + 1)])
            };
            let all: f64 = (0..cells * cells).map(cell).sum();
            assert!((all - 1.0).abs() < 3e-4, "{cells}: {all}");
        }
        // A quarter of it, along whose diameters it ends abruptly.
        let quarter =
            integrate(&|x, y| if x < 0.13 && y < 0.07 { disk(x, y) } else { 0.0 }, [-1.0, 1.0, -1.0, 1.0]);
        assert!((quarter - 0.25).abs() < 5e-4, "{quarter}");
    }

    #[test]
    fn means_of_strata_are_those_of_integrals() {
        let mean = stratified_mean(256, 1, |u, uc| f64::from(u.x * u.x * u.y * uc));
        assert!((mean - 1.0 / 12.0).abs() < 1e-4, "{mean}");
    }
}
