//! Light and reflectance as a scene writes them: colours, names, temperatures, measured spectra.
//!
//! ```text
//! emission 10 9 7                      linear sRGB
//! emission 10                          white: D65
//! emission F11 10                      a light by its name, of luminance 10
//! emission blackbody 3200 10           a black body of 3200 K, of luminance 10
//! emission light.spd 10                 a file of wavelengths and values, times 10
//! emission spectrum 400 0.1 700 1      wavelengths in nm and values
//! ```
//!
//! The last number of a name, a temperature or a file is a factor, 1 where it is missing. Reflectances take colours,
//! files and `spectrum`.

use kajo_color::named::{self, ILLUMINANTS};
use kajo_color::{Emission, Outside, Reflectance, Spectrum, Tabulated};
use kajo_math::Vec3;
use kajo_scene::{Args, Assets, Diagnostic, Diagnostics, Item, nearest, read_limited};

/// Bytes of the largest file of wavelengths and values.
const LARGEST_TABLE: u64 = 16 << 20;

/// Reads values that depend on wavelength.
#[derive(Clone, Copy)]
pub(super) struct SpectrumReader<'a> {
    pub assets: &'a dyn Assets,
}

/// A value, and what it is in linear sRGB: just what was written, where that was a colour.
#[derive(Clone, Debug)]
pub(super) struct Written<T> {
    pub rgb: Spectrum,
    pub value: T,
}

impl Written<Emission> {
    /// Whether any of it takes light away.
    fn is_negative(&self) -> bool {
        self.rgb.to_rgb().iter().any(|&v| v < 0.0)
    }

    /// The light, unless it is negative, which is reported at `item`.
    pub fn not_negative(self, item: Item<'_>, diagnostics: &mut Diagnostics) -> Option<Emission> {
        if self.is_negative() {
            let error = Diagnostic::error(format!("`{}` must not be negative", item.keyword()));
            diagnostics.push(error.label(item.head_span(), ""));
            return None;
        }
        Some(self.value)
    }
}

impl SpectrumReader<'_> {
    /// Light: none of it may be negative.
    pub fn emission(self, args: &mut Args<'_>) -> Result<Emission, Diagnostic> {
        let key = args.item().keyword();
        let light = self.classic_light(args)?;
        if light.is_negative() {
            return Err(args.error(format!("`{key}` must not be negative")));
        }
        Ok(light.value)
    }

    /// Light of the classic format, which takes light away where its colour is negative.
    pub fn classic_light(self, args: &mut Args<'_>) -> Result<Written<Emission>, Diagnostic> {
        if args.is_word() {
            let value = self.spectral_light(args)?;
            return Ok(Written { rgb: Spectrum::from(Vec3::from(value.rgb())), value });
        }
        let rgb = if args.numbers_left() == 1 { Vec3::splat(args.number()?) } else { args.vec3()? };
        Ok(Written { rgb: rgb.into(), value: Emission::from_rgb(rgb.to_array()) })
    }

    fn spectral_light(self, args: &mut Args<'_>) -> Result<Emission, Diagnostic> {
        let word = args.text()?;
        if word.eq_ignore_ascii_case("blackbody") {
            let kelvin = args.number_in(300.0..=1e6)?;
            return Ok(Emission::blackbody(kelvin).scaled(factor(args)?));
        }
        if let Some(light) = named::illuminant(&word) {
            return Ok(light.scaled(factor(args)?));
        }
        if let Some(table) = self.table(&word, args, Outside::Zero)? {
            if let Some(v) = table.values().iter().find(|&&v| v < 0.0) {
                return Err(args.error(format!("the light of a spectrum is not negative, but here is {v}")));
            }
            return Ok(Emission::from_spectrum(table, 1.0));
        }
        let near = nearest(&word, ILLUMINANTS.into_iter().chain(["blackbody", "spectrum"]));
        let help = near.map_or_else(
            || format!("lights are {}; a name with a dot in it is a file", ILLUMINANTS.join(", ")),
            |near| format!("did you mean `{near}`?"),
        );
        Err(args.error(format!("there is no light named `{word}`")).help(help))
    }

    /// The colour of a surface.
    pub fn reflectance(self, args: &mut Args<'_>) -> Result<Written<Reflectance>, Diagnostic> {
        if !args.is_word() {
            let rgb = args.vec3()?;
            return Ok(Written { rgb: rgb.into(), value: Reflectance::from_rgb(rgb.to_array()) });
        }
        let word = args.text()?;
        let Some(table) = self.table(&word, args, Outside::Clamp)? else {
            let error = args.error(format!("there is no reflectance named `{word}`"));
            return Err(
                error.help("write three numbers, a file such as `paint.spd`, or `spectrum 400 0.1 700 0.8`")
            );
        };
        if let Some(v) = table.values().iter().find(|v| !(0.0..=1.0).contains(*v)) {
            let error = args.error(format!("a reflectance lies between 0 and 1, but here is {v}"));
            return Err(error.help("per cent become shares by a factor: `paint.spd 0.01`"));
        }
        let value = Reflectance::from_spectrum(&table);
        Ok(Written { rgb: Spectrum::from(Vec3::from(value.rgb())), value })
    }

    /// The table that stands after `spectrum`, or in the file `word` times its factor; `None` where `word` is neither.
    fn table(
        self,
        word: &str,
        args: &mut Args<'_>,
        outside: Outside,
    ) -> Result<Option<Tabulated>, Diagnostic> {
        if word == "spectrum" {
            return pairs(args, outside).map(Some);
        }
        if !word.contains('.') {
            return Ok(None);
        }
        let factor = factor(args)?;
        let read = |word: &str| -> Result<Tabulated, String> {
            let file = self.assets.open(word, args.item().path()).map_err(|e| e.to_string())?;
            let bytes = read_limited(file, LARGEST_TABLE).map_err(|e| e.to_string())?;
            let text = String::from_utf8(bytes).map_err(|_| "it is not text".to_owned())?;
            Tabulated::parse(&text, outside).map_err(|e| e.to_string())
        };
        match read(word) {
            Ok(table) => Ok(Some(table.map(|v| v * factor))),
            Err(reason) => Err(args.error(format!("cannot read `{word}`: {reason}"))),
        }
    }
}

/// The factor that may stand after a name.
pub(super) fn factor(args: &mut Args<'_>) -> Result<f32, Diagnostic> {
    if args.numbers_left() == 0 { Ok(1.0) } else { args.number_in(0.0..) }
}

/// All numbers left, as wavelengths and values.
fn pairs(args: &mut Args<'_>, outside: Outside) -> Result<Tabulated, Diagnostic> {
    if args.numbers_left() % 2 == 1 {
        return Err(args.error("`spectrum` takes pairs: a wavelength in nm and a value"));
    }
    let pairs = (0..args.numbers_left() / 2).map(|_| args.numbers().map(|[nm, value]| (nm, value)));
    let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
    Tabulated::new(pairs, outside).map_err(|e| args.error(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::{MemoryAssets, SceneDesc};

    /// What `read` makes of a line, or the first error.
    fn read<T>(
        line: &str,
        read: impl FnOnce(SpectrumReader<'_>, &mut Args<'_>) -> Result<T, Diagnostic>,
    ) -> Result<T, String> {
        let assets = MemoryAssets::new()
            .with("light.spd", "400 1\n700 3 # red\n")
            .with("percent.spd", "400 10\n700 30\n")
            .with("bad.spd", "400 1\nnm red\n")
            .with("binary.spd", [0xff, 0xfe, 0x00]);
        let parsed = SceneDesc::parse_str(line);
        let item = parsed.desc.roots().next().unwrap();
        let mut diagnostics = Diagnostics::default();
        let value = Args::read(item, &mut diagnostics, |args| read(SpectrumReader { assets: &assets }, args));
        value.ok_or_else(|| diagnostics.errors().next().unwrap().message.clone())
    }

    fn emission(spectra: SpectrumReader<'_>, args: &mut Args<'_>) -> Result<Emission, Diagnostic> {
        spectra.emission(args)
    }

    fn reflectance(
        spectra: SpectrumReader<'_>,
        args: &mut Args<'_>,
    ) -> Result<Written<Reflectance>, Diagnostic> {
        spectra.reflectance(args)
    }

    fn light(line: &str) -> Emission {
        read(line, emission).unwrap_or_else(|e| panic!("{line}: {e}"))
    }

    #[test]
    fn lights_are_written_in_many_ways() {
        assert_eq!(light("emission 3 2 1"), Emission::from_rgb([3.0, 2.0, 1.0]));
        assert_eq!(light("emission 3"), Emission::from_rgb([3.0; 3]));
        assert_eq!(light("emission sodium 5"), named::illuminant("sodium").unwrap().scaled(5.0));
        assert_eq!(light("emission d65"), Emission::from_rgb([1.0; 3]));
        assert_eq!(light("emission blackbody 3200 4"), Emission::blackbody(3200.0).scaled(4.0));
        let table = || Tabulated::new([(400.0, 2.0), (700.0, 6.0)], Outside::Zero).unwrap();
        assert_eq!(light("emission light.spd 2"), Emission::from_spectrum(table(), 1.0));
        assert_eq!(light("emission spectrum 400 2 700 6"), Emission::from_spectrum(table(), 1.0));
    }

    #[test]
    fn the_factor_of_a_name_is_its_luminance() {
        for line in ["emission F11 7", "emission blackbody 2000 7", "emission 7", "emission D75 7"] {
            assert!((light(line).luminance() - 7.0).abs() < 1e-4, "{line}");
        }
    }

    #[test]
    fn reflectances_take_colours_and_tables() {
        let colour = read("diffuseColor 0.5 -1 2", reflectance).unwrap();
        assert_eq!(colour.rgb, Spectrum::rgb(0.5, -1.0, 2.0), "as written");
        assert_eq!(colour.value.rgb(), [0.5, 0.0, 1.0]);
        let table = Tabulated::new([(400.0, 0.1), (700.0, 0.3)], Outside::Clamp).unwrap();
        let expected = Reflectance::from_spectrum(&table);
        for line in ["diffuseColor spectrum 400 0.1 700 0.3", "diffuseColor percent.spd 0.01"] {
            let found = read(line, reflectance).unwrap();
            let off = found.value.rgb().into_iter().zip(expected.rgb()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f32::max) < 1e-6 && found.rgb.to_rgb() == found.value.rgb(), "{line}");
        }
    }

    #[test]
    fn mistakes_are_named() {
        let error = |line: &str| read(line, emission).unwrap_err();
        assert_eq!(error("emission sodum 2"), "there is no light named `sodum`");
        assert_eq!(error("emission 1 -1 1"), "`emission` must not be negative");
        assert_eq!(error("emission D65 -1"), "`emission` must be at least 0, found -1");
        assert_eq!(
            error("emission blackbody 20"),
            "`emission` must be at least 300 and at most 1000000, found 20"
        );
        assert!(error("emission blackbody").contains("expected 1 number"));
        assert_eq!(error("emission none.spd"), "cannot read `none.spd`: there is no such file");
        assert!(error("emission bad.spd").starts_with("cannot read `bad.spd`: line 2"));
        assert_eq!(error("emission binary.spd"), "cannot read `binary.spd`: it is not text");
        assert!(error("emission spectrum 400 1 700").contains("takes pairs"));
        assert!(error("emission spectrum 500 1 400 1").contains("must increase"));
        assert!(error("emission spectrum").contains("at least one pair"));
        assert!(error("emission D65 1 2").contains("found 2"));
        assert!(error("emission spectrum 400 1 500 -2 600 1").contains("here is -2"));
        let error = |line: &str| read(line, reflectance).unwrap_err();
        assert_eq!(error("diffuseColor light.spd"), "a reflectance lies between 0 and 1, but here is 3");
        assert_eq!(error("diffuseColor D65"), "there is no reflectance named `D65`");
        assert!(error("diffuseColor 0.5").contains("expected 3 numbers"));
    }
}
