//! Sets of primaries, and the way from one to another.
//!
//! Primaries are given as chromaticities `(x, y)`. With the columns `P = (x/y, 1, (1-x-y)/y)` of the
//! three and the white `W` written the same way,
//!
//! ```text
//! XYZ = P diag(P⁻¹ W) rgb
//! ```
//!
//! Between sets of different white, colours are adapted by Bradford's cone responses `B`:
//!
//! ```text
//! XYZ' = B⁻¹ diag(B W' / B W) B XYZ
//! ```
//!
//! [SMPTE RP 177-1993], [Lam 1985]. All values are linear; curves for displays are in [`crate::tone`].

use crate::matrix::{Matrix3, apply, diagonal, inverse, product};

/// Three primaries and a white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gamut {
    /// The name as it is written in a scene or on the command line.
    pub name: &'static str,
    /// Chromaticities of red, green and blue.
    pub primaries: [[f64; 2]; 3],
    /// Chromaticity of equal amounts of the three.
    pub white: [f64; 2],
}

/// Chromaticity of D65 as standards of television round it.
pub const WHITE_D65: [f64; 2] = [0.3127, 0.3290];

/// Chromaticity of the white of ACES, near D60.
pub const WHITE_ACES: [f64; 2] = [0.32168, 0.33767];

/// The primaries of sRGB and Rec. 709 [IEC 61966-2-1].
pub const SRGB: Gamut =
    Gamut { name: "srgb", primaries: [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]], white: WHITE_D65 };

/// ACES2065-1, the primaries AP0, for exchange [SMPTE ST 2065-1].
pub const ACES2065: Gamut = Gamut {
    name: "aces2065-1",
    primaries: [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.0770]],
    white: WHITE_ACES,
};

/// ACEScg, the primaries AP1 [Academy S-2014-004].
pub const ACESCG: Gamut =
    Gamut { name: "acescg", primaries: [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]], white: WHITE_ACES };

/// Rec. 2020, for wide-gamut displays [ITU-R BT.2020].
pub const REC2020: Gamut =
    Gamut { name: "rec2020", primaries: [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]], white: WHITE_D65 };

/// Every gamut with a name.
pub const ALL: [Gamut; 4] = [SRGB, ACES2065, ACESCG, REC2020];

impl Gamut {
    /// The gamut called `name`.
    pub fn named(name: &str) -> Option<Gamut> {
        ALL.into_iter().find(|gamut| gamut.name == name)
    }

    /// CIE XYZ of linear values in this gamut; equal amounts of 1 have `Y = 1`.
    pub const fn xyz_from_rgb(&self) -> Matrix3 {
        xyz_from_primaries(&self.primaries, xyz_of(self.white))
    }

    /// Linear values in this gamut of CIE XYZ, without adaptation.
    pub const fn rgb_from_xyz(&self) -> Matrix3 {
        inverse(&self.xyz_from_rgb())
    }

    /// Linear values in this gamut of linear values in `from`; white goes to white.
    pub const fn from(&self, from: &Gamut) -> Matrix3 {
        let adapted = adaptation(xyz_of(from.white), xyz_of(self.white));
        product(&self.rgb_from_xyz(), &product(&adapted, &from.xyz_from_rgb()))
    }
}

/// XYZ of a chromaticity, with `Y = 1`.
pub const fn xyz_of([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// Chromaticity of XYZ; of black, that of equal energy.
pub fn xy_of([x, y, z]: [f64; 3]) -> [f64; 2] {
    let sum = x + y + z;
    if sum == 0.0 { [1.0 / 3.0; 2] } else { [x / sum, y / sum] }
}

/// The matrix from linear values to XYZ that takes equal amounts of 1 to `white`.
pub(crate) const fn xyz_from_primaries(primaries: &[[f64; 2]; 3], white: [f64; 3]) -> Matrix3 {
    let (r, g, b) = (xyz_of(primaries[0]), xyz_of(primaries[1]), xyz_of(primaries[2]));
    let columns = [[r[0], g[0], b[0]], [r[1], g[1], b[1]], [r[2], g[2], b[2]]];
    product(&columns, &diagonal(apply(&inverse(&columns), white)))
}

/// The Bradford adaptation of XYZ seen under the white `from` to the white `to`, both as XYZ.
pub const fn adaptation(from: [f64; 3], to: [f64; 3]) -> Matrix3 {
    const CONES: Matrix3 = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    let (a, b) = (apply(&CONES, from), apply(&CONES, to));
    product(&inverse(&CONES), &product(&diagonal([b[0] / a[0], b[1] / a[1], b[2] / a[2]]), &CONES))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(found: Matrix3, expected: Matrix3, tolerance: f64) {
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < tolerance, "{found} for {expected}");
        }
    }

    #[test]
    fn matrices_are_those_of_the_standards() {
        // IEC 61966-2-1 prints four digits, ITU-R BT.2020 as many, ACES ten.
        let srgb = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        check(SRGB.xyz_from_rgb(), srgb, 6e-5);
        let rec2020 = [[0.6370, 0.1446, 0.1689], [0.2627, 0.6780, 0.0593], [0.0000, 0.0281, 1.0610]];
        check(REC2020.xyz_from_rgb(), rec2020, 6e-5);
        let ap1 = [
            [0.6624541811, 0.1340042065, 0.1561876870],
            [0.2722287168, 0.6740817658, 0.0536895174],
            [-0.0055746495, 0.0040607335, 1.0103391003],
        ];
        check(ACESCG.xyz_from_rgb(), ap1, 1e-10);
    }

    #[test]
    fn white_goes_to_white_and_back() {
        for from in ALL {
            for to in ALL {
                let there = to.from(&from);
                for x in apply(&there, [1.0; 3]) {
                    assert!((x - 1.0).abs() < 1e-12, "{} to {}", from.name, to.name);
                }
                check(product(&from.from(&to), &there), diagonal([1.0; 3]), 1e-12);
            }
            assert_eq!(Gamut::named(from.name), Some(from));
        }
        assert_eq!(Gamut::named("srbg"), None);
    }

    #[test]
    fn wide_gamuts_hold_all_of_srgb() {
        for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            assert!(apply(&REC2020.from(&SRGB), rgb).iter().all(|x| *x > 0.0));
            assert!(apply(&ACESCG.from(&SRGB), rgb).iter().all(|x| *x > 0.0));
        }
        assert!(apply(&SRGB.from(&ACESCG), [0.0, 1.0, 0.0])[0] < -0.1);
    }

    #[test]
    fn chromaticities_are_inverted() {
        let [x, y] = xy_of(xyz_of([0.2, 0.7]));
        assert!((x - 0.2).abs() < 1e-15 && (y - 0.7).abs() < 1e-15);
        assert_eq!(xy_of([0.0; 3]), [1.0 / 3.0; 2]);
    }
}
