//! The standard observer, and integrals over what it sees.
//!
//! ```text
//! X = ∫ L(λ) x̄(λ) dλ / ∫ ȳ(λ) dλ,  and so Y, Z
//! ```
//!
//! so that radiance 1 at every wavelength has luminance `Y` = 1. Tables are joined by straight lines; on a
//! stretch without a node the product of three of them is a cubic, which two Gauss points integrate
//! exactly.
//! [CIE 018:2019]

use kajo_math::Vec4;

use crate::data::observer::{X, Y, Z};
use crate::tabulated::Tabulated;

/// The ends of the visible range in nm.
pub const FIRST_NM: f64 = 360.0;
/// See [`FIRST_NM`].
pub const LAST_NM: f64 = 830.0;

/// Distance of the nodes of the tables in nm.
pub(crate) const STEP_NM: f64 = 1.0;
/// How many nodes there are.
pub(crate) const NODES: usize = X.len();

/// Where two Gauss points lie in the interval [-1, 1].
pub(crate) const GAUSS: f64 = 0.577_350_269_189_625_8;

/// `∫ ȳ dλ` in nm.
pub(crate) const LUMINANCE_NM: f64 = {
    let (mut sum, mut i) = (-0.5 * (Y[0] + Y[NODES - 1]), 0);
    while i < NODES {
        sum += Y[i];
        i += 1;
    }
    sum * STEP_NM
};

/// The colour matching functions, node by node, as the inner loop reads them, and nothing.
static MATCHING: [Vec4; NODES] = {
    let (mut table, mut i) = ([Vec4::ZERO; NODES], 0);
    while i < NODES {
        table[i] = Vec4::new(X[i] as f32, Y[i] as f32, Z[i] as f32, 0.0);
        i += 1;
    }
    table
};

/// The node below `nm` in a table of `nodes` every `step` nm, and how far beyond it `nm` lies in [0, 1];
/// `None` outside the visible range.
#[inline]
pub(crate) fn locate(nm: f32, step: f64, nodes: usize) -> Option<(usize, f32)> {
    let at = (nm - FIRST_NM as f32) * (1.0 / step) as f32;
    if !(0.0..=(nodes - 1) as f32).contains(&at) {
        return None;
    }
    let node = (at as i32).min(nodes as i32 - 2);
    Some((node as usize, at - node as f32))
}

/// `x̄, ȳ, z̄` at a wavelength in nm; zero outside the visible range.
#[inline]
pub fn matching(nm: f32) -> [f32; 3] {
    matching_lanes(nm).truncate().to_array()
}

/// The same, and a zero.
#[inline]
pub(crate) fn matching_lanes(nm: f32) -> Vec4 {
    let Some((node, t)) = locate(nm, STEP_NM, NODES) else { return Vec4::ZERO };
    let (a, b) = (MATCHING[node], MATCHING[node + 1]);
    a + t * (b - a)
}

/// A table of values every `step` nm at a wavelength inside the visible range.
pub(crate) const fn line<const N: usize>(table: &[f64; N], step: f64, nm: f64) -> f64 {
    let at = (nm - FIRST_NM) / step;
    let node = at as usize;
    if node + 1 < N {
        table[node] + (at - node as f64) * (table[node + 1] - table[node])
    } else {
        table[N - 1]
    }
}

/// CIE XYZ of radiance `f(λ)`, which is smooth or straight between the wavelengths `breaks` and the nodes
/// of the observer's table.
pub(crate) fn xyz(breaks: &[f32], f: impl Fn(f32) -> f64) -> [f64; 3] {
    let mut ends: Vec<f64> = (0..NODES).map(|i| FIRST_NM + STEP_NM * i as f64).collect();
    ends.extend(breaks.iter().map(|nm| f64::from(*nm)).filter(|nm| (FIRST_NM..LAST_NM).contains(nm)));
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let mut sum = [0.0; 3];
    for pair in ends.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        for point in [middle - GAUSS * half, middle + GAUSS * half] {
            let (value, seen) = (f(point as f32), matching(point as f32));
            for i in 0..3 {
                sum[i] += value * f64::from(seen[i]) * half / LUMINANCE_NM;
            }
        }
    }
    sum
}

/// CIE XYZ of radiance given as a table.
pub fn xyz_of(radiance: &Tabulated) -> [f64; 3] {
    xyz(radiance.nm(), |nm| f64::from(radiance.at(nm)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gamut::xy_of;

    #[test]
    fn equal_energy_is_in_the_middle() {
        let e = xyz(&[], |_| 1.0);
        let [x, y] = xy_of(e);
        assert!((x - 1.0 / 3.0).abs() < 5e-5 && (y - 1.0 / 3.0).abs() < 5e-5, "{x} {y}");
        assert!((e[1] - 1.0).abs() < 1e-6, "{e:?}");
    }

    #[test]
    fn the_observer_is_the_published_one() {
        assert_eq!(matching(555.0), [0.512_050_1, 1.0, 0.005_749_999]);
        assert_eq!(matching(830.0)[1], 4.5181e-7);
        assert_eq!([matching(359.9), matching(830.1), matching(f32::NAN)], [[0.0; 3]; 3]);
        let half_way = matching(600.5)[1];
        assert!((half_way - 0.5 * (matching(600.0)[1] + matching(601.0)[1])).abs() < 1e-7);
    }

    #[test]
    fn a_narrow_line_is_not_missed() {
        // A triangle half a nanometre wide at 589.3 nm: its XYZ are the observer's there times its area.
        let line = |nm: f32| f64::from((1.0 - (nm - 589.3).abs() / 0.25).max(0.0));
        let found = xyz(&[589.05, 589.3, 589.55], line);
        let seen = matching(589.3);
        for i in 0..3 {
            let expected = 0.25 * f64::from(seen[i]) / LUMINANCE_NM;
            assert!((found[i] / expected - 1.0).abs() < 2e-3, "{found:?}");
        }
    }
}
