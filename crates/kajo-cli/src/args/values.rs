//! Values of options that are more than a word or a number.

use std::ffi::OsString;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use kajo::{Dialect, FilterChoice, INTEGRATOR_CHOICES, IntegratorName, SamplerKind, Settings, View};

/// Columns and rows: `800x600`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

impl Size {
    /// Width over height.
    pub fn aspect(self) -> f64 {
        f64::from(self.0[0]) / f64::from(self.0[1])
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Size, String> {
        let side = |text: &str| text.parse::<u32>().ok().filter(|&n| n > 0);
        let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
        sides
            .map(Size)
            .ok_or_else(|| "expected width and height, two whole numbers from 1 to 4294967295".to_owned())
    }
}

/// Samples of each pixel, and their pattern if it is said: `16` or `regular:16`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples(pub SamplerKind, pub u32);

/// The most columns and rows for a pixel of a diagram.
pub const MAX_ZOOM: u32 = 1000;

impl FromStr for Samples {
    type Err = String;

    fn from_str(text: &str) -> Result<Samples, String> {
        let (pattern, number) = text.split_once(':').unwrap_or(("jittered", text));
        let pattern = SamplerKind::from_name(pattern);
        let number = number.parse().ok().filter(|n| (1..=Settings::MAX_SAMPLES).contains(n));
        match (pattern, number) {
            (Some(pattern), Some(number)) => Ok(Samples(pattern, number)),
            _ => {
                let names = SamplerKind::NAMES.map(|(name, _)| name).join(", ");
                let most = Settings::MAX_SAMPLES;
                Err(format!("expected a number from 1 to {most}, or a number behind one of {names}"))
            }
        }
    }
}

/// A reconstruction filter and its radius or standard deviation: `gaussian` or `gaussian:0.5`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterArg(pub FilterChoice);

impl FromStr for FilterArg {
    type Err = String;

    fn from_str(text: &str) -> Result<FilterArg, String> {
        let (name, width) = text.split_once(':').map_or((text, None), |(name, width)| (name, Some(width)));
        let Some((_, (make, natural))) = FilterChoice::NAMES.into_iter().find(|(known, _)| *known == name)
        else {
            let names = FilterChoice::NAMES.map(|(name, _)| name).join(", ");
            return Err(format!("expected one of {names}, and a width in pixels if you like"));
        };
        width.map_or(Ok(natural), filter_width).map(|width| FilterArg(make(width)))
    }
}

/// The radius of a filter, or its standard deviation where it is Gaussian.
pub fn filter_width(text: &str) -> Result<f32, String> {
    let width = text.parse().ok().filter(|&width: &f32| FilterChoice::SIZES.contains(&width.into()));
    let [least, most] = [FilterChoice::SIZES.start(), FilterChoice::SIZES.end()].map(f64::to_string);
    width.ok_or_else(|| format!("expected a width in pixels from {least} to {most}"))
}

/// A further output: `depth=FILE`, or `depth` for a layer of the OpenEXR file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Aov {
    pub view: View,
    pub path: Option<PathBuf>,
}

/// Reads an [`Aov`]; the file's name may be any bytes.
pub fn aov() -> impl TypedValueParser<Value = Aov> {
    clap::builder::OsStringValueParser::new().try_map(|text: OsString| {
        // Names are ASCII, so that what follows the first `=` is whole even where it is no UTF-8.
        let bytes = text.as_encoded_bytes();
        let (name, path) = match bytes.iter().position(|&byte| byte == b'=') {
            Some(at) => (bytes[..at].to_vec(), Some(suffix(&text, at + 1))),
            None => (bytes.to_vec(), None),
        };
        let view = std::str::from_utf8(&name).ok().and_then(View::from_name);
        match (view, path) {
            (None, _) => {
                Err(format!("expected NAME=FILE or NAME, with NAME one of {}", View::NAMES.join(", ")))
            }
            (Some(_), Some(path)) if path.is_empty() => {
                Err("expected the name of a file after `=`".to_owned())
            }
            (Some(view), path) => Ok(Aov { view, path: path.map(PathBuf::from) }),
        }
    })
}

/// What follows the first `start` bytes, which are ASCII.
fn suffix(text: &OsString, start: usize) -> OsString {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::{OsStrExt, OsStringExt};
        OsString::from_vec(text.as_bytes()[start..].to_vec())
    }
    #[cfg(not(unix))]
    {
        text.to_string_lossy().chars().skip(start).collect::<String>().into()
    }
}

/// Reads the name of a dialect.
pub fn dialect() -> impl TypedValueParser<Value = Dialect> {
    PossibleValuesParser::new(Dialect::NAMES)
        .try_map(|name| Dialect::from_name(&name).ok_or_else(|| format!("no dialect is called {name}")))
}

/// Reads the name of an integrator.
pub fn integrator() -> impl TypedValueParser<Value = IntegratorName> {
    choice(INTEGRATOR_CHOICES.map(|name| (name, IntegratorName(name))))
}

/// Reads one of a few words.
pub fn choice<T: Copy + Send + Sync + 'static, const N: usize>(
    choices: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    choice_or(choices, [])
}

/// The same where further words are understood, of which neither help nor messages say anything.
pub fn choice_or<T: Copy + Send + Sync + 'static, const N: usize, const M: usize>(
    choices: [(&'static str, T); N],
    synonyms: [(&'static str, T); M],
) -> impl TypedValueParser<Value = T> {
    let shown = choices.iter().map(|&(name, _)| PossibleValue::new(name));
    let hidden = synonyms.iter().map(|&(name, _)| PossibleValue::new(name).hide(true));
    let words: Vec<_> = shown.chain(hidden).collect();
    PossibleValuesParser::new(words).try_map(move |word| {
        let found = choices.iter().chain(&synonyms).find(|(name, _)| *name == word);
        found.map(|&(_, value)| value).ok_or_else(|| format!("{word} is none of the choices"))
    })
}

/// `on` or `off`.
pub fn on_off() -> impl TypedValueParser<Value = bool> {
    choice([("on", true), ("off", false)])
}

/// Any finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|n: &f32| n.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

/// Factors of two, as many as a scene may ask for.
pub fn stops(text: &str) -> Result<f32, String> {
    let stops = text.parse().ok().filter(|n: &f32| (-100.0..=100.0).contains(n));
    stops.ok_or_else(|| "expected a number from -100 to 100".to_owned())
}

/// A finite number from 0 up.
pub fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n: &f64| n.is_finite() && *n >= 0.0);
    number.ok_or_else(|| "expected a number that is not negative".to_owned())
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n: &f64| n.is_finite() && *n > 0.0);
    number.ok_or_else(|| "expected a number above 0".to_owned())
}

/// A number from 0 to 1.
pub fn share(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n: &f64| (0.0..=1.0).contains(n));
    number.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

/// A time in seconds.
pub fn seconds(text: &str) -> Result<Duration, String> {
    not_negative(text).and_then(|seconds| {
        Duration::try_from_secs_f64(seconds).map_err(|_| "expected a number of seconds".to_owned())
    })
}

/// The least weight of a branch.
pub fn weight(text: &str) -> Result<f32, String> {
    not_negative(text).map(|weight| weight as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers_above_zero() {
        assert_eq!("800x600".parse(), Ok(Size([800, 600])));
        assert_eq!("1000000000x4294967295".parse(), Ok(Size([1_000_000_000, u32::MAX])));
        for wrong in
            ["800", "800x", "x600", "0x1", "1x0", "-1x5", "1.5x2", "4294967296x1", "axb", "1x2x3", ""]
        {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn samples_have_a_pattern_or_are_jittered() {
        assert_eq!("16".parse(), Ok(Samples(SamplerKind::Jittered, 16)));
        assert_eq!("regular:4".parse(), Ok(Samples(SamplerKind::Regular, 4)));
        assert_eq!("bluenoise:4".parse(), Ok(Samples(SamplerKind::ZSobol, 4)));
        for wrong in ["regular", "random:4", "-1", "0", "sobol:0", "1048577", "4:regular", "1.5", ""] {
            assert!(wrong.parse::<Samples>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn filters_have_a_width_of_their_own_or_a_natural_one() {
        assert_eq!("gaussian".parse(), Ok(FilterArg(FilterChoice::Gaussian(0.5))));
        assert_eq!("tent:1.5".parse(), Ok(FilterArg(FilterChoice::Tent(1.5))));
        assert_eq!("none".parse(), Ok(FilterArg(FilterChoice::None)));
        for wrong in ["gauss", "tent:0", "tent:-1", "tent:65", "tent:nan", "tent:", ""] {
            assert!(wrong.parse::<FilterArg>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn synonyms_are_understood_and_not_shown() {
        let parser = choice_or([("new", 1), ("other", 2)], [("old", 1)]);
        let read = |word: &str| parser.parse_ref(&clap::Command::new("kajo"), None, word.as_ref());
        assert_eq!([read("new").ok(), read("old").ok(), read("other").ok()], [Some(1), Some(1), Some(2)]);
        let message = read("young").unwrap_err().to_string();
        assert!(message.contains("new") && !message.contains("old"), "{message}");
        let shown = parser.possible_values().into_iter().flatten().filter(|value| !value.is_hide_set());
        assert_eq!(shown.map(|value| value.get_name().to_owned()).collect::<Vec<_>>(), ["new", "other"]);
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(finite("-2.5e3"), Ok(-2500.0));
        assert!(["inf", "nan", "1e99", "x"].iter().all(|text| finite(text).is_err()));
        assert_eq!(stops("-100"), Ok(-100.0));
        assert!(["101", "-1e30", "inf", "nan", ""].iter().all(|text| stops(text).is_err()));
        assert!(["-1", "inf", "nan"].iter().all(|text| not_negative(text).is_err()));
        assert!(["0", "-1", "inf", "nan", "1%"].iter().all(|text| positive(text).is_err()));
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        assert!(["-1", "1e300", "inf", "1s"].iter().all(|text| seconds(text).is_err()));
    }
}
