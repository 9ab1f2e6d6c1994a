//! Options of what happens to a picture once it is rendered.

use clap::Args;
use clap::builder::TypedValueParser;
use kajo::{Denoiser, Development, Gamut, Tone, gamut};

use super::values;

/// How light becomes values.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Development")]
pub struct DevelopArgs {
    /// Take the noise out: best, oidn (Intel Open Image Denoise), or builtin
    #[arg(long, value_name = "HOW", num_args = 0..=1, default_missing_value = "best", value_parser = denoiser())]
    pub denoise: Option<Denoiser>,
    /// Make the picture brighter by this many factors of two
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = values::stops)]
    pub exposure: Option<f32>,
    /// The light that is to look white: its temperature in kelvin, and a tint if you like
    #[arg(long, value_name = "KELVIN[:TINT]", value_parser = white_balance)]
    pub white_balance: Option<[f64; 2]>,
    /// The curve of PNG and other pictures for a display: linear, srgb, aces, agx; by default linear in the classic
    /// integrator and srgb in the others
    #[arg(long, value_name = "CURVE", value_parser = values::choice(Tone::ALL.map(|tone| (tone.name(), tone))))]
    pub tone: Option<Tone>,
    /// The primaries of files of light such as OpenEXR: srgb, acescg, rec2020, aces2065-1
    #[arg(long, value_name = "NAME", value_parser = values::choice(gamut::ALL.map(|gamut| (gamut.name, gamut))))]
    pub gamut: Option<Gamut>,
}

impl DevelopArgs {
    /// The same for a picture, over what its scene says.
    pub fn development(&self, plain: Development) -> Development {
        Development {
            exposure: self.exposure.unwrap_or(plain.exposure),
            white: self.white_balance.or(plain.white),
            tone: self.tone.unwrap_or(plain.tone),
            gamut: self.gamut.unwrap_or(plain.gamut),
        }
    }
}

/// Reads the name of a denoiser. A library that is not where the system keeps libraries is named by the environment.
fn denoiser() -> impl TypedValueParser<Value = Denoiser> {
    clap::builder::PossibleValuesParser::new(["best", "oidn", "builtin"]).map(|name| match name.as_str() {
        "oidn" => Denoiser::Oidn(std::env::var_os("KAJO_OIDN")),
        "builtin" => Denoiser::BuiltIn,
        _ => Denoiser::Best,
    })
}

fn white_balance(text: &str) -> Result<[f64; 2], String> {
    let (kelvin, tint) = text.split_once(':').unwrap_or((text, "0"));
    let number =
        |text: &str, least: f64, most: f64| text.parse().ok().filter(|n: &f64| (least..=most).contains(n));
    match (number(kelvin, 1000.0, 25_000.0), number(tint, -150.0, 150.0)) {
        (Some(kelvin), Some(tint)) => Ok([kelvin, tint]),
        _ => {
            Err("expected a temperature from 1000 to 25000, and a tint from -150 to 150 if you like"
                .to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_a_temperature_and_perhaps_a_tint() {
        assert_eq!(white_balance("3200"), Ok([3200.0, 0.0]));
        assert_eq!(white_balance("5600:-10.5"), Ok([5600.0, -10.5]));
        for wrong in ["", "warm", "999", "25001", "5000:", "5000:151", "nan"] {
            assert!(white_balance(wrong).is_err(), "{wrong}");
        }
    }
}
