//! Which wavelengths paths are drawn at, by the light of a scene.
//!
//! A light whose spectrum has a few lines is noisy where wavelengths are drawn without regard to it: of four wavelengths hardly
//! one meets a line, and counts the more. Here they are drawn by what the eye sees of the emitters' light,
//!
//! ```text
//! p(λ) = w₀ p_visible(λ) + Σ wᵢ Eᵢ(λ) s(λ) / ∫ Eᵢ s dλ,     s = x̄ + ȳ + z̄
//! ```
//!
//! with weights `w` in proportion to `∫ Eᵢ s` and to the power of the emitters. Lights without lines count to the first part,
//! which never vanishes, so that every wavelength is found however it comes about. The four wavelengths of a path are
//! quarter turns of one uniform number as always [Wilkie et al. 2014], here mapped by the inverse of the sum of `p`,
//! which is constant between the wavelengths of a list.

use std::collections::HashMap;
use std::sync::Arc;

use kajo_math::piecewise::Piecewise1D;

use crate::observer::{self, FIRST_NM, GAUSS, LAST_NM, STEP_NM};
use crate::wavelengths::visible_pdf;
use crate::{Emission, Tabulated, Wavelengths};

/// The least share of paths whose wavelengths are drawn without regard to the lights.
const LEAST_EVEN: f64 = 0.1;

/// Wavelengths of lights' own tables that are kept apart, at most.
const MOST_BREAKS: usize = 1 << 14;

/// How the wavelengths of paths are drawn.
#[derive(Clone, Debug, Default)]
pub struct WavelengthChoice {
    /// `None` where wavelengths are drawn as by [`Wavelengths::sample`].
    cells: Option<Cells>,
}

/// A density that is constant between wavelengths of a list.
#[derive(Clone, Debug)]
struct Cells {
    /// In nm, increasing, from one end of the visible range to the other.
    ends: Vec<f32>,
    density: Piecewise1D,
}

/// The light of all emitters of one spectrum.
struct Lines<'a> {
    table: &'a Tabulated,
    weight: f64,
}

impl WavelengthChoice {
    /// The choice for lights of these powers, in any unit.
    ///
    /// Emitters whose light is a colour or that of a black body have no lines; where no others are, wavelengths are drawn as
    /// by [`Wavelengths::sample`].
    pub fn by_lights<'a>(emitters: impl IntoIterator<Item = (f32, &'a Emission)>) -> WavelengthChoice {
        let (mut even, mut lines, mut known) = (0.0, Vec::<Lines<'a>>::new(), HashMap::new());
        for (power, emission) in emitters {
            let weight = f64::from(power) * emission.strength();
            if !(weight > 0.0 && weight.is_finite()) {
                continue;
            }
            let Some(table) = emission.table() else {
                even += weight;
                continue;
            };
            let number = *known.entry(Arc::as_ptr(table)).or_insert(lines.len());
            if number == lines.len() {
                lines.push(Lines { table, weight: 0.0 });
            }
            lines[number].weight += weight;
        }
        if lines.is_empty() {
            return WavelengthChoice::default();
        }
        let all = lines.iter().map(|lines| lines.weight).sum::<f64>();
        WavelengthChoice::by_lines(&lines, even.max(LEAST_EVEN / (1.0 - LEAST_EVEN) * all))
    }

    /// * `even`: the weight of light without lines
    fn by_lines(lines: &[Lines<'_>], even: f64) -> WavelengthChoice {
        let mut nm: Vec<f32> = (0..observer::NODES).map(|i| (FIRST_NM + STEP_NM * i as f64) as f32).collect();
        let breaks = lines.iter().flat_map(|lines| lines.table.nm()).copied();
        nm.extend(breaks.filter(|nm| (FIRST_NM as f32..LAST_NM as f32).contains(nm)).take(MOST_BREAKS));
        nm.sort_by(f32::total_cmp);
        nm.dedup();
        let mut mass = vec![0.0; nm.len() - 1];
        for Lines { table, weight } in lines {
            let seen: Vec<f64> = nm.windows(2).map(|ends| seen(table, ends[0], ends[1])).collect();
            let all: f64 = seen.iter().sum();
            if all > 0.0 {
                mass.iter_mut().zip(&seen).for_each(|(mass, seen)| *mass += weight * seen / all);
            }
        }
        for (mass, ends) in mass.iter_mut().zip(nm.windows(2)) {
            let (middle, width) = (0.5 * (ends[0] + ends[1]), ends[1] - ends[0]);
            *mass += even * f64::from(visible_pdf(middle) * width);
        }
        let all: f64 = mass.iter().sum();
        let shares: Vec<f32> = mass.iter().map(|mass| (mass / all) as f32).collect();
        WavelengthChoice { cells: Piecewise1D::new(&shares).map(|density| Cells { ends: nm, density }) }
    }

    /// Four wavelengths of the visible range for a uniform `u` in [0, 1).
    pub fn sample(&self, u: f32) -> Wavelengths {
        match &self.cells {
            None => Wavelengths::sample(u),
            Some(cells) => Wavelengths::by_turns(u, |u| cells.draw(u)),
        }
    }
}

impl Cells {
    /// A wavelength in nm for a uniform `u` in [0, 1), and its density per nm.
    fn draw(&self, u: f32) -> (f32, f32) {
        let (cell, rest) = self.density.cell_of(u);
        let [from, to] = [self.ends[cell], self.ends[cell + 1]];
        // Where little of a probability is left to a cell, rounding may lead out of it.
        ((from + rest * (to - from)).min(to), self.density.probability(cell) / (to - from))
    }
}

/// What the eye sees of a spectrum between two wavelengths without a node between them.
fn seen(table: &Tabulated, from: f32, to: f32) -> f64 {
    let (middle, half) = (0.5 * (f64::from(from) + f64::from(to)), 0.5 * (f64::from(to) - f64::from(from)));
    let at = |nm: f64| {
        let nm = nm as f32;
        f64::from(table.at(nm).max(0.0)) * observer::matching(nm).iter().map(|&x| f64::from(x)).sum::<f64>()
    };
    half * (at(middle - GAUSS * half) + at(middle + GAUSS * half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outside, Spectrum, named, sensor};

    fn emitter(name: &str) -> Emission {
        named::illuminant(name).expect("a known light").normalized()
    }

    /// Mean and variance of what the sensor sees of a light, over paths.
    fn seen_of(choice: &WavelengthChoice, light: &Emission) -> ([f64; 3], f64) {
        const N: u32 = 20_000;
        let (mut sum, mut squares) = ([0.0; 3], 0.0);
        for i in 0..N {
            let lambda = choice.sample((i as f32 + 0.5) / N as f32);
            let rgb = sensor::to_rgb(light.at(&lambda), &lambda).map(f64::from);
            (0..3).for_each(|c| sum[c] += rgb[c] / f64::from(N));
            squares += rgb.iter().map(|x| x * x).sum::<f64>() / f64::from(N);
        }
        (sum, squares - sum.iter().map(|x| x * x).sum::<f64>())
    }

    #[test]
    fn colours_are_found_whatever_the_lights_are() {
        let lights =
            [emitter("sodium"), emitter("F11"), emitter("mercury"), Emission::from_rgb([0.2, 0.5, 0.9])];
        let plain = WavelengthChoice::default();
        for (i, own) in lights.iter().enumerate() {
            for weights in [vec![(1.0, own)], lights.iter().map(|light| (2.0, light)).collect()] {
                let choice = WavelengthChoice::by_lights(weights);
                for light in &lights {
                    // 20,000 strata, evenly spaced: the error is that of a sum over the range.
                    let ((found, _), (expected, _)) = (seen_of(&choice, light), seen_of(&plain, light));
                    for c in 0..3 {
                        assert!((found[c] - expected[c]).abs() < 3e-3, "{i}: {found:?} {expected:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn lines_are_no_noise_where_lights_are_known() {
        for (name, factor) in [("sodium", 300.0), ("mercury", 50.0), ("F11", 10.0), ("HP1", 8.0)] {
            let light = emitter(name);
            let before = seen_of(&WavelengthChoice::default(), &light).1;
            let after = seen_of(&WavelengthChoice::by_lights([(1.0, &light)]), &light).1;
            assert!(before > factor * after, "{name}: variance {before} and {after}");
        }
    }

    #[test]
    fn without_lines_nothing_changes() {
        let lights = [Emission::from_rgb([1.0, 0.5, 0.1]), Emission::blackbody(2700.0), Emission::BLACK];
        let choice = WavelengthChoice::by_lights(lights.iter().map(|light| (1.0, light)));
        assert!(choice.cells.is_none());
        for u in [0.0, 0.3, 0.999] {
            assert_eq!(choice.sample(u), Wavelengths::sample(u));
        }
        let dark = Emission::from_spectrum(Tabulated::new([(500.0, 0.0)], Outside::Zero).unwrap(), 1.0);
        for power in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let choice = WavelengthChoice::by_lights([(power, &emitter("sodium")), (1.0, &dark)]);
            assert!(choice.cells.is_none(), "{power}");
        }
    }

    #[test]
    fn the_density_is_that_of_what_is_drawn() {
        // A line of half a nanometre, and one at the very end of the range.
        let line = |nm: f32| Tabulated::new([(nm - 0.25, 0.0), (nm, 1.0), (nm + 0.25, 0.0)], Outside::Zero);
        for nm in [589.3, 829.9, 360.0] {
            let light = Emission::from_spectrum(line(nm).unwrap(), 1.0);
            let choice = WavelengthChoice::by_lights([(3.0, &light)]);
            let cells = choice.cells.as_ref().unwrap();
            let pdf = |nm: f32| {
                let i = cells.ends.partition_point(|&end| end <= nm).clamp(1, cells.ends.len() - 1);
                cells.density.probability(i - 1) / (cells.ends[i] - cells.ends[i - 1])
            };
            let of_cell = |ends: &[f32]| f64::from(pdf(0.5 * (ends[0] + ends[1])) * (ends[1] - ends[0]));
            let sum: f64 = cells.ends.windows(2).map(of_cell).sum();
            assert!((sum - 1.0).abs() < 1e-4, "{nm}: {sum}");
            for i in 0..10_000 {
                let lambda = choice.sample(i as f32 / 10_000.0);
                for (found, drawn) in lambda.nm().unwrap().into_iter().zip(lambda.pdf()) {
                    assert!(
                        (360.0..=830.0).contains(&found) && drawn > 0.0 && drawn.is_finite(),
                        "{found} {drawn}"
                    );
                    // At a border between two wavelengths of the list it may be that of either.
                    let near = [found - 1e-4, found, found + 1e-4].map(pdf);
                    assert!(near.contains(&drawn), "{found}: {drawn} {near:?}");
                }
            }
            let [r, g, b] = seen_of(&choice, &light.clone().normalized()).0;
            let expected = light.normalized().rgb();
            let luminance = Spectrum::rgb(r as f32, g as f32, b as f32).luminance();
            assert!((luminance - 1.0).abs() < 0.02, "{nm}: {r} {g} {b} {expected:?}");
        }
    }
}
