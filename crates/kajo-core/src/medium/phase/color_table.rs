//! Phase functions by numbers that differ between colours or wavelengths.
//!
//! Each column of the table is a phase function of its own, `P_j`, divided by its own integral, and that of a wavelength is a
//! mixture of them,
//!
//! ```text
//! p(c, λ) = sum over j of w_j(λ) P_j(c),      w_j >= 0,      sum over j of w_j(λ) = 1
//! ```
//!
//! so that it is one too: no medium gains light. Between the wavelengths of two columns `w` goes along a straight line, and
//! beyond the first and the last the function is as it is there. For columns of red, green and blue `w` are the reflectances of
//! the three primaries [Mallett and Yuksel 2019]. Where lanes are red, green and blue, columns by wavelength are looked at by
//! the sensor, angle by angle, in light of D65, and divided by the integrals of what it sees.
//!
//! A cosine is drawn from one of the columns, chosen by `w` of one wavelength.

use kajo_color::{Outside, RgbBasis, Spectrum, Tabulated, Unbounded};

use super::{PhaseAngle, PhaseRows, PhaseTable, PhaseTableError};

/// A phase function for each of some colours or wavelengths, all at the same cosines.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorPhaseTable {
    /// Red, green and blue.
    rgb: [PhaseTable; 3],
    /// Wavelengths in nm, increasing; none where spectra are those of colours.
    nm: Vec<f32>,
    /// As many.
    by_wavelength: Vec<PhaseTable>,
}

/// Columns and the share of each; shares add up to 1.
type Mixture<'a> = [(&'a PhaseTable, f32); 3];

impl ColorPhaseTable {
    /// Of rows of an angle and the values of red, green and blue.
    ///
    /// # Errors
    /// [`PhaseTableError`].
    ///
    /// # Panics
    /// Where `rows` have other than three columns.
    pub fn of_colors(rows: &PhaseRows, angle: PhaseAngle) -> Result<ColorPhaseTable, PhaseTableError> {
        let columns = columns_of(rows, angle)?;
        let rgb = columns.try_into().expect("columns of red, green and blue");
        Ok(ColorPhaseTable { rgb, nm: Vec::new(), by_wavelength: Vec::new() })
    }

    /// Of rows of an angle and the values of some wavelengths.
    ///
    /// * `nm`: increasing, one for each column
    ///
    /// # Errors
    /// [`PhaseTableError`].
    ///
    /// # Panics
    /// Where there are not as many columns.
    pub fn by_wavelength(
        nm: &[f32],
        rows: &PhaseRows,
        angle: PhaseAngle,
    ) -> Result<ColorPhaseTable, PhaseTableError> {
        assert_eq!(nm.len(), rows.columns(), "a column for each wavelength");
        if nm.is_empty() {
            return Err(PhaseTableError::Wavelength(1));
        }
        let is_next = |i: usize| i == 0 || nm[i] > nm[i - 1];
        if let Some(i) = (0..nm.len()).find(|&i| !(nm[i] > 0.0 && nm[i].is_finite() && is_next(i))) {
            return Err(PhaseTableError::Wavelength(i + 1));
        }
        let by_wavelength = columns_of(rows, angle)?;
        Ok(ColorPhaseTable { rgb: seen(nm, &by_wavelength), nm: nm.to_vec(), by_wavelength })
    }

    /// The one table that all columns are, where they are all alike.
    pub fn alike(&self) -> Option<&PhaseTable> {
        let columns = if self.nm.is_empty() { &self.rgb } else { self.by_wavelength.as_slice() };
        columns.iter().all(|column| *column == columns[0]).then_some(&columns[0])
    }

    /// The mean cosine over red, green and blue.
    pub fn mean_cosine(&self) -> f32 {
        self.rgb.iter().map(PhaseTable::mean_cosine).sum::<f32>() * (1.0 / 3.0)
    }

    /// The values for the cosine of the angle by which light is turned, lane by lane.
    ///
    /// * `nm`: wavelengths of the lanes; zero where lanes are red, green and blue
    #[inline]
    pub fn at(&self, cos: f32, nm: [f32; 4]) -> Spectrum {
        let place = self.rgb[0].locate(cos);
        if nm[0] == 0.0 {
            let [r, g, b] = self.rgb.each_ref().map(|column| column.value_at(place));
            return Spectrum::rgb(r, g, b);
        }
        let mixed = |mixture: Mixture<'_>| {
            mixture.iter().map(|(column, share)| share * column.value_at(place)).sum::<f32>()
        };
        Spectrum::from(nm.map(|nm| mixed(self.mixture(nm))))
    }

    /// A cosine drawn by the values of one lane.
    ///
    /// * `u`: uniform in [0, 1)
    /// * `nm`: as in [`ColorPhaseTable::at`]
    /// * `lane`: less than 4; less than 3 where lanes are red, green and blue
    pub fn sample(&self, mut u: f32, nm: [f32; 4], lane: usize) -> f32 {
        if nm[0] == 0.0 {
            return self.rgb[lane].sample(u);
        }
        // One of the columns is chosen, and what is left of the number draws from it.
        let mixture = self.mixture(nm[lane]);
        for (column, share) in mixture {
            if u < share {
                return column.sample((u / share).min(1.0 - f32::EPSILON));
            }
            u -= share;
        }
        // Shares add up to 1 but for rounding.
        let last = mixture.iter().rev().find(|(_, share)| *share > 0.0).unwrap_or(&mixture[0]);
        last.0.sample(1.0 - f32::EPSILON)
    }

    /// The columns of a wavelength in nm, with their shares.
    #[inline]
    fn mixture(&self, nm: f32) -> Mixture<'_> {
        if self.nm.is_empty() {
            let shares = RgbBasis::shares_at(nm);
            return [0, 1, 2].map(|i| (&self.rgb[i], shares[i]));
        }
        let last = self.nm.len() - 1;
        let i = self.nm.partition_point(|&node| node <= nm).clamp(1, last.max(1)) - 1;
        let next = (i + 1).min(last);
        let width = self.nm[next] - self.nm[i];
        let t = if width > 0.0 { ((nm - self.nm[i]) / width).clamp(0.0, 1.0) } else { 0.0 };
        let [a, b] = [i, next].map(|i| &self.by_wavelength[i]);
        [(a, 1.0 - t), (b, t), (a, 0.0)]
    }
}

/// A table for each column.
fn columns_of(rows: &PhaseRows, angle: PhaseAngle) -> Result<Vec<PhaseTable>, PhaseTableError> {
    let columns = rows.columns();
    let column = |i: usize| {
        PhaseTable::new(&rows.column(i), angle).map_err(|error| match error {
            PhaseTableError::TooFew { rows, .. } => PhaseTableError::TooFew { rows, columns },
            PhaseTableError::Value { row, .. } if columns > 1 => {
                PhaseTableError::Value { row, column: i + 1 }
            }
            PhaseTableError::Black(_) if columns > 1 => PhaseTableError::Black(i + 1),
            error => error,
        })
    };
    (0..columns).map(column).collect()
}

/// What the sensor sees of phase functions by wavelength, in red, green and blue.
fn seen(nm: &[f32], columns: &[PhaseTable]) -> [PhaseTable; 3] {
    let rgb_at = |i: usize| {
        let values = nm.iter().zip(columns).map(|(&nm, column)| (nm, column.values()[i]));
        let spectrum = Tabulated::new(values, Outside::Clamp);
        spectrum.map_or([0.0; 3], |spectrum| Unbounded::from_spectrum(&spectrum).rgb())
    };
    let rgb: Vec<[f32; 3]> = (0..columns[0].values().len()).map(rgb_at).collect();
    // A primary that sees nothing at any angle sees what the middle wavelength does.
    let middle = || columns[columns.len() / 2].clone();
    [0, 1, 2].map(|primary| columns[0].revalued(|i| rgb[i][primary]).unwrap_or_else(middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_color::Wavelengths;
    use std::f64::consts::TAU;

    const NM: [f32; 3] = [450.0, 550.0, 650.0];
    const ROWS: &[f32] = &[
        0.0, 40.0, 20.0, 6.0, //
        20.0, 3.0, 4.0, 5.0, //
        90.0, 0.2, 0.5, 1.0, //
        140.0, 0.4, 0.1, 0.3, //
        180.0, 0.1, 0.8, 0.2,
    ];

    fn rows(numbers: &[f32]) -> PhaseRows {
        PhaseRows::new(3, numbers).unwrap()
    }

    fn both() -> [ColorPhaseTable; 2] {
        let rows = rows(ROWS);
        [
            ColorPhaseTable::of_colors(&rows, PhaseAngle::Degrees).unwrap(),
            ColorPhaseTable::by_wavelength(&NM, &rows, PhaseAngle::Degrees).unwrap(),
        ]
    }

    /// Of straight pieces over the cosine the midpoint rule is exact but where a piece begins or ends.
    #[test]
    fn light_of_each_wavelength_goes_somewhere() {
        let spectral = [0.0f32, 0.1, 0.2].map(Wavelengths::sample);
        let lanes = spectral.iter().filter_map(Wavelengths::nm).chain([[0.0; 4]]);
        for nm in lanes.chain([[1.0, 300.0, 840.0, 2e4]]) {
            for table in both() {
                let n = 100_000;
                let mut sums = [0.0f64; 4];
                for i in 0..n {
                    let cos = (2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0) as f32;
                    let values = table.at(cos, nm);
                    (0..4).for_each(|lane| sums[lane] += f64::from(values[lane]) * TAU * 2.0 / f64::from(n));
                }
                let n_lanes = if nm[0] == 0.0 { 3 } else { 4 };
                assert!(sums[..n_lanes].iter().all(|sum| (sum - 1.0).abs() < 1e-5), "{nm:?}: {sums:?}");
            }
        }
    }

    /// What is drawn with `u` of a lane follows the values of that lane: of `n` cosines as many lie in a piece as it says.
    #[test]
    fn cosines_follow_the_lane_that_draws() {
        let nm = Wavelengths::sample(0.3).nm().unwrap();
        for (table, nm, lane) in both().into_iter().flat_map(|table| {
            [(nm, 0), (nm, 2), ([0.0; 4], 1), ([0.0; 4], 2)].map(|(nm, lane)| (table.clone(), nm, lane))
        }) {
            let (n, bins) = (100_000, 40);
            let mut found = vec![0.0f64; bins];
            for i in 0..n {
                let cos = table.sample((i as f32 + 0.5) / n as f32, nm, lane);
                let bin = ((0.5 * (cos + 1.0) * bins as f32) as usize).min(bins - 1);
                found[bin] += 1.0 / f64::from(n);
            }
            for (bin, share) in found.into_iter().enumerate() {
                let steps = 1000;
                let expected: f64 = (0..steps)
                    .map(|i| {
                        let at = (bin as f64 + (f64::from(i) + 0.5) / f64::from(steps)) / bins as f64;
                        f64::from(table.at((2.0 * at - 1.0) as f32, nm)[lane]) * TAU * 2.0
                    })
                    .sum::<f64>()
                    / f64::from(steps)
                    / bins as f64;
                assert!((share - expected).abs() < 1e-4, "{nm:?} {lane} {bin}: {share} {expected}");
            }
        }
    }

    #[test]
    fn between_two_wavelengths_functions_go_along_lines() {
        let [_, table] = both();
        for cos in [-0.9f32, 0.0, 0.7, 1.0] {
            let values = table.at(cos, [450.0, 500.0, 550.0, 700.0]);
            assert!((values[1] - 0.5 * (values[0] + values[2])).abs() < 1e-6 * values[1], "{cos}");
            assert_eq!(values[3], table.at(cos, [650.0; 4])[0]);
        }
        let column = PhaseTable::new(&rows(ROWS).column(1), PhaseAngle::Degrees).unwrap();
        assert_eq!(table.at(0.3, [550.0; 4])[2], column.at(0.3));
    }

    #[test]
    fn columns_that_are_alike_are_one() {
        let grey: Vec<f32> = ROWS.chunks(4).flat_map(|row| [row[0], row[1], row[1], row[1]]).collect();
        let plain = PhaseTable::new(&rows(ROWS).column(0), PhaseAngle::Degrees).unwrap();
        let rows = rows(&grey);
        let colors = ColorPhaseTable::of_colors(&rows, PhaseAngle::Degrees).unwrap();
        assert_eq!(colors.alike(), Some(&plain));
        let spectral = ColorPhaseTable::by_wavelength(&NM, &rows, PhaseAngle::Degrees).unwrap();
        assert_eq!(spectral.alike(), Some(&plain));
        // What the sensor sees of such columns is the same but for rounding.
        for cos in [-1.0f32, 0.2, 1.0] {
            let seen = spectral.at(cos, [0.0; 4]);
            assert!((0..3).all(|i| (seen[i] / plain.at(cos) - 1.0).abs() < 1e-4), "{cos}: {seen:?}");
        }
        assert!(both().iter().all(|table| table.alike().is_none()));
    }

    #[test]
    fn what_is_no_phase_function_is_refused() {
        let of =
            |numbers: &[f32]| ColorPhaseTable::of_colors(&rows(numbers), PhaseAngle::Degrees).unwrap_err();
        let negative = [0.0, 1.0, 1.0, 1.0, 180.0, 1.0, -1.0, 1.0];
        assert_eq!(of(&negative), PhaseTableError::Value { row: 2, column: 2 });
        assert_eq!(of(&[0.0, 1.0, 1.0, 0.0, 180.0, 1.0, 1.0, 0.0]), PhaseTableError::Black(3));
        assert_eq!(of(&ROWS[..4]), PhaseTableError::TooFew { rows: 1, columns: 3 });
        for (nm, which) in [([450.0, 450.0, 650.0], 2), ([450.0, 650.0, 550.0], 3), ([0.0, 1.0, 2.0], 1)] {
            let made = ColorPhaseTable::by_wavelength(&nm, &rows(ROWS), PhaseAngle::Degrees);
            assert_eq!(made.unwrap_err(), PhaseTableError::Wavelength(which), "{nm:?}");
        }
    }
}
