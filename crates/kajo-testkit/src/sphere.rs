//! Do directions follow their density?
//!
//! A pilot run finds out where directions fall. Cells are rings around their mean, each with an equal
//! share of the pilot, cut into sectors; what the density puts into each is integrated by Gauss-Legendre quadrature,
//! refined where it is not settled. The runs that give no direction make one cell more, which expects what the
//! density leaves over. [Subr and Arvo 2007]

use std::f64::consts::{PI, TAU};

use kajo_math::{Frame, Vec2, Vec3, rng::Stream};

use crate::ChiSquare;

const RINGS: usize = 10;
const SECTORS: usize = 12;

/// Error allowed in the share of one cell.
const TOLERANCE: f64 = 1e-5;

/// Error of the quadrature where a density ends abruptly, as a share of everything.
const SHARP_EDGES: f64 = 3e-3;

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
fn integrate(f: &impl Fn(f64, f64) -> f64, cell: [f64; 4]) -> f64 {
    // Fine enough a start that no lobe slips through.
    quarters(cell).into_iter().flat_map(quarters).map(|part| refine(f, part, gauss(f, part), 9)).sum()
}

fn refine(f: &impl Fn(f64, f64) -> f64, cell: [f64; 4], whole: f64, depth: u32) -> f64 {
    let parts = quarters(cell).map(|part| (part, gauss(f, part)));
    let sum: f64 = parts.iter().map(|part| part.1).sum();
    if depth == 0 || (sum - whole).abs() < TOLERANCE / 16.0 {
        return sum;
    }
    parts.into_iter().map(|(part, value)| refine(f, part, value, depth - 1)).sum()
}

fn quarters([x0, x1, y0, y1]: [f64; 4]) -> [[f64; 4]; 4] {
    let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
    [[x0, x, y0, y], [x, x1, y0, y], [x0, x, y, y1], [x, x1, y, y1]]
}

/// Gauss-Legendre quadrature with four points a side.
fn gauss(f: &impl Fn(f64, f64) -> f64, [x0, x1, y0, y1]: [f64; 4]) -> f64 {
    const POINTS: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    ];
    let (hx, hy) = (0.5 * (x1 - x0), 0.5 * (y1 - y0));
    let mut sum = 0.0;
    for (px, wx) in POINTS {
        for (py, wy) in POINTS {
            sum += wx * wy * f(x0 + hx * (1.0 + px), y0 + hy * (1.0 + py));
        }
    }
    sum * hx * hy
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

    #[test]
    fn means_of_strata_are_those_of_integrals() {
        let mean = stratified_mean(256, 1, |u, uc| f64::from(u.x * u.x * u.y * uc));
        assert!((mean - 1.0 / 12.0).abs() < 1e-4, "{mean}");
    }
}
