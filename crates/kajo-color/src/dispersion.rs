//! The index of refraction of transparent matter, and how it changes with the wavelength.
//!
//! ```text
//! Sellmeier: n²(λ) = 1 + Σᵢ Bᵢ λ² / (λ² − Cᵢ)        λ in µm
//! Cauchy:    n(λ)  = A + B / λ²,  from n_d and the Abbe number V_d = (n_d − 1) / (n_F − n_C)
//! ```
//!
//! with the lines C 656.27 nm, d 587.56 nm and F 486.13 nm of hydrogen and helium.
//! [Sellmeier 1871], [Cauchy 1836]; coefficients: [Schott 2017], [Malitson 1965], [Malitson and Dodge 1972],
//! [Peter 1923], [Daimon and Masumura 2007].

use std::sync::Arc;

use crate::tabulated::Tabulated;
use crate::{Spectrum, Wavelengths};

/// The lines C, d and F in nm.
const LINE_C: f64 = 656.2725;
const LINE_D: f64 = 587.5618;
const LINE_F: f64 = 486.1327;

/// An index of refraction as a function of the wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Dispersion {
    /// The same at every wavelength.
    Constant(f64),
    /// A sum of resonances.
    Sellmeier(Sellmeier),
    /// `a + b / λ²`, `b` in nm².
    Cauchy {
        /// The index of very long waves.
        a: f64,
        /// How fast it grows towards blue, in nm².
        b: f64,
    },
    /// Measured values.
    Table(Arc<Tabulated>),
}

/// Sellmeier's coefficients; terms with `b` = 0 are unused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sellmeier {
    /// Strengths.
    pub b: [f64; 4],
    /// Squares of the resonances, in µm².
    pub c: [f64; 4],
}

impl Sellmeier {
    /// The index at a wavelength in nm, held to [1, 10].
    pub fn index(&self, nm: f64) -> f64 {
        let squared = nm * nm * 1e-6;
        let terms = self.b.iter().zip(&self.c).filter(|(b, _)| **b != 0.0);
        let sum: f64 = terms.map(|(b, c)| b / (1.0 - c / squared)).sum();
        (1.0 + sum).clamp(1.0, 100.0).sqrt()
    }
}

impl Dispersion {
    /// Cauchy's formula through an index at the line d with an Abbe number. An Abbe number that is not
    /// positive and finite means none: no dispersion.
    pub fn from_abbe(index: f64, abbe: f64) -> Dispersion {
        if !(abbe > 0.0 && abbe.is_finite()) {
            return Dispersion::Constant(index);
        }
        let spread = 1.0 / (LINE_F * LINE_F) - 1.0 / (LINE_C * LINE_C);
        let b = (index - 1.0) / (abbe * spread);
        Dispersion::Cauchy { a: index - b / (LINE_D * LINE_D), b }
    }

    /// The index at a wavelength in nm.
    pub fn index(&self, nm: f64) -> f64 {
        match self {
            Dispersion::Constant(index) => *index,
            Dispersion::Sellmeier(sellmeier) => sellmeier.index(nm),
            Dispersion::Cauchy { a, b } => a + b / (nm * nm),
            Dispersion::Table(table) => f64::from(table.at(nm as f32)),
        }
    }

    /// The index at the line d, which stands for all in RGB mode.
    pub fn index_d(&self) -> f64 {
        self.index(LINE_D)
    }

    /// Abbe's number `(n_d − 1) / (n_F − n_C)`; infinite without dispersion.
    pub fn abbe(&self) -> f64 {
        (self.index_d() - 1.0) / (self.index(LINE_F) - self.index(LINE_C))
    }

    /// Whether wavelengths part: such a surface calls [`Wavelengths::terminate_secondary`].
    pub fn is_dispersive(&self) -> bool {
        match self {
            Dispersion::Constant(_) => false,
            Dispersion::Cauchy { b, .. } => *b != 0.0,
            Dispersion::Sellmeier(_) => true,
            Dispersion::Table(table) => table.values().windows(2).any(|pair| pair[0] != pair[1]),
        }
    }

    /// The index in the lanes of a path; that of the line d in every lane in RGB mode.
    pub fn at(&self, lambda: &Wavelengths) -> Spectrum {
        match lambda.nm() {
            Some(nm) => Spectrum::from(nm.map(|nm| self.index(f64::from(nm)) as f32)),
            None => Spectrum::grey(self.index_d() as f32),
        }
    }
}

/// Named glasses and other clear matter, in the order of the alphabet. At 20 °C; sapphire's ordinary ray.
#[rustfmt::skip]
pub(crate) const GLASSES: [(&str, Sellmeier); 10] = [
    ("diamond", Sellmeier {
        b: [0.3306, 4.3356, 0.0, 0.0], c: [0.175 * 0.175, 0.106 * 0.106, 0.0, 0.0] }),
    ("F2", Sellmeier {
        b: [1.34533359, 0.209073176, 0.937357162, 0.0], c: [0.00997743871, 0.0470450767, 111.886764, 0.0] }),
    ("fused-silica", Sellmeier {
        b: [0.6961663, 0.4079426, 0.8974794, 0.0],
        c: [0.0684043 * 0.0684043, 0.1162414 * 0.1162414, 9.896161 * 9.896161, 0.0] }),
    ("N-BAK4", Sellmeier {
        b: [1.28834642, 0.132817724, 0.945395373, 0.0], c: [0.00779980626, 0.0315631177, 105.965875, 0.0] }),
    ("N-BK7", Sellmeier {
        b: [1.03961212, 0.231792344, 1.01046945, 0.0], c: [0.00600069867, 0.0200179144, 103.560653, 0.0] }),
    ("N-SF10", Sellmeier {
        b: [1.62153902, 0.256287842, 1.64447552, 0.0], c: [0.0122241457, 0.0595736775, 147.468793, 0.0] }),
    ("N-SF11", Sellmeier {
        b: [1.73759695, 0.313747346, 1.89878101, 0.0], c: [0.013188707, 0.0623068142, 155.23629, 0.0] }),
    ("sapphire", Sellmeier {
        b: [1.4313493, 0.65054713, 5.3414021, 0.0],
        c: [0.0726631 * 0.0726631, 0.1193242 * 0.1193242, 18.028251 * 18.028251, 0.0] }),
    ("SF10", Sellmeier {
        b: [1.61625977, 0.259229334, 1.07762317, 0.0], c: [0.0127534559, 0.0581983954, 116.60768, 0.0] }),
    ("water", Sellmeier {
        b: [0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688],
        c: [0.005101829712, 0.01821153936, 0.02620722293, 10.69792721] }),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::named::glass;
    use crate::tabulated::Outside;

    /// The line g of mercury.
    const LINE_G: f64 = 435.8343;

    #[test]
    fn indices_at_the_lines_c_d_f_g_are_those_of_the_catalogues() {
        let published = [
            ("N-BK7", [1.514322, 1.516800, 1.522376, 1.526685]),
            ("N-SF10", [1.720906, 1.728277, 1.746430, 1.761914]),
            ("fused-silica", [1.456367, 1.458464, 1.463126, 1.466693]),
            ("water", [1.331513, 1.333403, 1.337492, 1.340586]),
            ("diamond", [2.40991, 2.41749, 2.43554, 2.44997]),
        ];
        for (name, expected) in published {
            let tolerance = if name == "diamond" { 1e-5 } else { 1.5e-6 };
            for (nm, expected) in [LINE_C, LINE_D, LINE_F, LINE_G].into_iter().zip(expected) {
                let found = glass(name).unwrap().index(nm);
                assert!((found - expected).abs() < tolerance, "{name} {nm}: {found}");
            }
        }
    }

    #[test]
    fn abbe_numbers_are_those_of_the_catalogues() {
        let published = [
            ("N-BK7", 1.5168, 64.167),
            ("N-SF10", 1.72828, 28.53),
            ("N-SF11", 1.78472, 25.68),
            ("F2", 1.62004, 36.37),
            ("N-BAK4", 1.56883, 55.98),
            ("SF10", 1.72825, 28.41),
            ("sapphire", 1.7682, 72.3),
        ];
        for (name, index, abbe) in published {
            let found = glass(name).unwrap();
            assert!((found.index_d() - index).abs() < 1e-4, "{name}: {}", found.index_d());
            assert!((found.abbe() - abbe).abs() < 0.1, "{name}: {}", found.abbe());
        }
        assert!((glass("N-BK7").unwrap().abbe() - 64.167).abs() < 1e-3);
    }

    #[test]
    fn a_prism_of_sixty_degrees_deviates_each_line_as_measured() {
        // Minimum deviation of the lines r, C, d, e, F, g, h: 2 asin(n sin 30°) - 60°.
        let lines = [706.5188, LINE_C, LINE_D, 546.074, LINE_F, LINE_G, 404.6561];
        let published = [
            ("N-BK7", [38.3038, 38.4291, 38.6467, 38.8158, 39.1381, 39.5195, 39.8353]),
            ("N-SF10", [58.2839, 58.7350, 59.5690, 60.2581, 61.6689, 63.5161, 65.2181]),
        ];
        for (name, expected) in published {
            let glass = glass(name).unwrap();
            for (nm, expected) in lines.into_iter().zip(expected) {
                let found = 2.0 * (0.5 * glass.index(nm)).asin().to_degrees() - 60.0;
                assert!((found - expected).abs() < 2e-4, "{name} {nm}: {found}");
            }
        }
    }

    #[test]
    fn cauchy_has_the_index_and_the_abbe_number_it_was_made_for() {
        let found = Dispersion::from_abbe(1.6, 36.0);
        assert!((found.index_d() - 1.6).abs() < 1e-12 && (found.abbe() - 36.0).abs() < 1e-9);
        assert!(found.index(400.0) > found.index(700.0));
        for none in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert_eq!(Dispersion::from_abbe(1.5, none), Dispersion::Constant(1.5));
        }
    }

    #[test]
    fn lanes_hold_the_index_of_each_wavelength() {
        let glass = glass("N-SF11").unwrap();
        let lambda = Wavelengths::sample(0.15);
        for (i, nm) in lambda.nm().unwrap().into_iter().enumerate() {
            assert_eq!(glass.at(&lambda)[i], glass.index(f64::from(nm)) as f32);
        }
        assert_eq!(glass.at(&Wavelengths::RGB), Spectrum::grey(glass.index_d() as f32));
    }

    #[test]
    fn only_what_varies_disperses() {
        let table = |a, b| {
            let pairs = [(400.0, a), (700.0, b)];
            Dispersion::Table(Arc::new(Tabulated::new(pairs, Outside::Clamp).unwrap()))
        };
        assert!(table(1.5, 1.4).is_dispersive() && !table(1.5, 1.5).is_dispersive());
        assert!((table(1.5, 1.4).index(550.0) - 1.45).abs() < 1e-6);
        assert!(!Dispersion::Constant(1.5).is_dispersive() && Dispersion::Constant(1.5).abbe().is_infinite());
        assert!(!Dispersion::Cauchy { a: 1.5, b: 0.0 }.is_dispersive());
    }

    #[test]
    fn far_from_the_visible_the_index_stays_a_number() {
        for (_, sellmeier) in GLASSES {
            for nm in [0.0, 1.0, 68.4, 100.0, 106.0, 175.0, 1e4, 1e7, f64::INFINITY] {
                let index = sellmeier.index(nm);
                assert!((1.0..=10.0).contains(&index), "{nm}: {index}");
            }
        }
    }
}
