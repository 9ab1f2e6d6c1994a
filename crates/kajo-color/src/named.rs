//! Lights, metals and glasses that a scene asks for by name.

use crate::data::{light_sources, metals};
use crate::dispersion::{Dispersion, GLASSES};
use crate::emission::Emission;
use crate::illuminant;
use crate::metal::MeasuredMetal;
use crate::tabulated::{Outside, Tabulated};

/// The names of [`illuminant()`], in the order of the alphabet.
///
/// * `A`: the standard incandescent light source; `E`: equal energy
/// * `D50`, `D55`, `D65`, `D75`: phases of daylight
/// * `F2`, `F7`, `F11`: fluorescent light sources, cool white, daylight, three-band
/// * `HP1`, `HP5`: high-pressure discharges, sodium and metal halide
/// * `LED-B3`: blue diodes and a phosphor; `mercury`: a clear mercury discharge
/// * `sodium`: a low-pressure sodium discharge
pub const ILLUMINANTS: [&str; 14] =
    ["A", "D50", "D55", "D65", "D75", "E", "F11", "F2", "F7", "HP1", "HP5", "LED-B3", "mercury", "sodium"];

/// The names of [`metal`].
pub const METALS: [&str; 7] = ["aluminium", "chromium", "copper", "gold", "iron", "silver", "titanium"];

/// The names of [`glass`]. Water and fused silica are among them; all at 20 °C.
pub fn glasses() -> impl Iterator<Item = &'static str> {
    GLASSES.iter().map(|(name, _)| *name)
}

/// The light called `name`, with luminance 1. Case does not count.
pub fn illuminant(name: &str) -> Option<Emission> {
    let name = ILLUMINANTS.into_iter().find(|known| known.eq_ignore_ascii_case(name))?;
    let table = |values: &[f64]| Tabulated::regular(380.0, 5.0, values, Outside::Zero);
    let table = match name {
        // Illuminant A is defined with a constant that has changed since: 2848 K * 1.43878 / 1.4350.
        "A" => return Some(Emission::blackbody(2855.496)),
        "D50" => illuminant::daylight(5002.78),
        "D55" => illuminant::daylight(5503.06),
        "D65" => return Some(Emission::from_rgb([1.0; 3])),
        "D75" => illuminant::daylight(7504.17),
        "E" => Tabulated::regular(360.0, 470.0, &[1.0, 1.0], Outside::Zero),
        "F11" => table(&light_sources::FL11),
        "F2" => table(&light_sources::FL2),
        "F7" => table(&light_sources::FL7),
        "HP1" => table(&light_sources::HP1),
        "HP5" => table(&light_sources::HP5),
        "LED-B3" => table(&light_sources::LED_B3),
        "mercury" => table(&light_sources::MERCURY),
        // The lines D2 and D1 at 588.995 and 589.592 nm as a spectrometer of 5 nm shows them. Narrower, hardly
        // any path would meet them.
        "sodium" => Tabulated::regular(584.3, 5.0, &[0.0, 1.0, 0.0], Outside::Zero),
        _ => return None,
    };
    Some(Emission::from_spectrum(table, 1.0).normalized())
}

/// The metal called `name`. Case does not count; `aluminum` is the same as `aluminium`.
pub fn metal(name: &str) -> Option<MeasuredMetal> {
    let rows: &[[f32; 3]] = match name.to_ascii_lowercase().as_str() {
        "aluminium" | "aluminum" => &metals::ALUMINIUM,
        "chromium" => &metals::CHROMIUM,
        "copper" => &metals::COPPER,
        "gold" => &metals::GOLD,
        "iron" => &metals::IRON,
        "silver" => &metals::SILVER,
        "titanium" => &metals::TITANIUM,
        _ => return None,
    };
    let column = |i: usize| Tabulated::new(rows.iter().map(|row| (row[0], row[i])), Outside::Clamp).ok();
    Some(MeasuredMetal::new(&column(1)?, &column(2)?))
}

/// The index of the clear matter called `name`. Case does not count.
pub fn glass(name: &str) -> Option<Dispersion> {
    let (_, sellmeier) = GLASSES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
    Some(Dispersion::Sellmeier(*sellmeier))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gamut::xy_of;
    use crate::{Wavelengths, sensor};

    /// Chromaticity of a light as a path sees it.
    fn chromaticity(light: &Emission) -> [f64; 2] {
        const N: usize = 50_000;
        let mut sum = [0.0; 3];
        for i in 0..N {
            let lambda = Wavelengths::sample((i as f32 + 0.5) / N as f32);
            for (sum, x) in sum.iter_mut().zip(sensor::to_xyz(light.at(&lambda), &lambda)) {
                *sum += f64::from(x) / N as f64;
            }
        }
        assert!((sum[1] - 1.0).abs() < 1e-3, "luminance {}", sum[1]);
        xy_of(sum)
    }

    #[test]
    fn lights_have_their_published_chromaticities() {
        // [CIE 015:2018, tables 3 and 10 to 12]
        let published = [
            ("A", [0.4476, 0.4074]),
            ("D50", [0.3457, 0.3585]),
            ("D55", [0.3324, 0.3474]),
            ("D65", [0.3127, 0.3290]),
            ("D75", [0.2990, 0.3149]),
            ("E", [0.3333, 0.3333]),
            ("F2", [0.3721, 0.3751]),
            ("F7", [0.3129, 0.3292]),
            ("F11", [0.3805, 0.3769]),
            ("HP1", [0.5330, 0.4150]),
            ("HP5", [0.3776, 0.3713]),
            ("LED-B3", [0.3756, 0.3723]),
            // The chromaticity of a triangle around 589.3 nm.
            ("sodium", [0.5708, 0.4286]),
            ("mercury", [0.3112, 0.3829]),
        ];
        for (name, [x, y]) in published {
            let found = chromaticity(&illuminant(name).unwrap());
            let off = (found[0] - x).abs().max((found[1] - y).abs());
            assert!(off < 1e-3, "{name}: {found:?}");
        }
        assert_eq!(published.len(), ILLUMINANTS.len());
    }

    #[test]
    fn names_are_found_and_nothing_else() {
        for name in METALS {
            assert!(metal(&name.to_uppercase()).is_some(), "{name}");
        }
        for name in glasses() {
            assert!(glass(&name.to_lowercase()).is_some(), "{name}");
        }
        assert!(illuminant("d65") == illuminant("D65") && metal("aluminum") == metal("aluminium"));
        assert!(illuminant("D66").is_none() && metal("unobtainium").is_none() && glass("N-BK8").is_none());
    }
}
