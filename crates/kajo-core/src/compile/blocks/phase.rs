//! Where to media scatter light: keys that all their blocks share.

use kajo_scene::{Args, Diagnostic, Params, read_limited};

use crate::compile::fields::{
    At, FileName, Keys, Plain, Sources, Typed, between, choice, choices, file, flag, keys, number,
    report_beside,
};
use crate::medium::Phase;
use crate::medium::phase::{
    HenyeyGreenstein, MiePhase, PhaseAngle, PhaseColumns, PhaseRows, PhaseTableError,
};
use crate::schema::{Constant, FieldKind, FieldSpec, NumberRange};

/// Bytes of the largest file of angles and values.
const LARGEST_TABLE: u64 = 16 << 20;

/// The phase functions by their words.
#[derive(Clone, Copy, PartialEq)]
pub enum PhaseName {
    Isotropic,
    HenyeyGreenstein,
    Mie,
    Rayleigh,
    Table,
}

choices! {
    PhaseName {
        "henyeyGreenstein" => PhaseName::HenyeyGreenstein,
        "isotropic" => PhaseName::Isotropic,
        "mie" => PhaseName::Mie,
        "rayleigh" => PhaseName::Rayleigh,
        "table" => PhaseName::Table,
    }
}

choices! {
    PhaseAngle {
        "cosine" => PhaseAngle::Cosine,
        "degrees" => PhaseAngle::Degrees,
    }
}

/// Numbers, as many as there are.
pub struct NumberList(Vec<f32>);

impl Plain<'_> for NumberList {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<NumberList, Diagnostic> {
        let numbers = (0..args.numbers_left()).map(|_| args.numbers().map(|[number]| number));
        numbers.collect::<Result<_, _>>().map(NumberList)
    }
}

keys! {
    /// Where to light is scattered.
    PhaseKeys<'t> {
        phase: Option<PhaseName> = choice::<PhaseName>("phase")
            .unlike("by the other keys", "isotropic", "where to light is scattered"),
        g: Option<f32> = number("g")
            .not_beside(&["droplets", "phaseTable", "phaseFile"])
            .presumed(Constant::Number(0.0), "mean cosine: -1 back, 0 to all sides, 1 straight on"),
        droplets: Option<f32> = between("droplets", 5.0, 50.0)
            .unit("µm")
            .not_beside(&["phaseTable", "phaseFile"])
            .unlike("20 for `mie`", "20", "mean diameter of the droplets of fog or a cloud"),
        table: Option<At<'t, NumberList>> = Typed::<NumberList>::new("phaseTable", FieldKind::Groups(&[NumberRange::ANY]))
            .not_beside(&["phaseFile"])
            .placed()
            .unlike("none", "0 4 60 1 120 0.5 180 1", "rows of the angle by which light is turned and how much is"),
        file: Option<At<'t, FileName>> = file("phaseFile")
            .placed()
            .option("a file of such rows, one on a line"),
        angle: Option<PhaseAngle> = choice::<PhaseAngle>("phaseAngle")
            .unlike("`degrees`", "degrees", "what the first number of each row is"),
        colors: bool = flag("phaseColors")
            .not_beside(&["phaseWavelengths"])
            .or(false, "whether the values of a row are three, of red, green and blue"),
        wavelengths: Option<At<'t, NumberList>> = Typed::<NumberList>::new("phaseWavelengths", FieldKind::Groups(&[NumberRange::POSITIVE]))
            .placed()
            .unlike("none", "450 550 650", "wavelengths in nm, increasing, of which each row has a value"),
    }
}

/// The phase function; one that is none is reported.
pub fn phase(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Phase> {
    for key in ["droplets", "phaseTable", "phaseFile", "phaseWavelengths"] {
        if params.contains(key) {
            report_beside(params, PhaseKeys::FIELDS, key);
        }
    }
    let keys = PhaseKeys::read(params, sources)?;
    let is_table = keys.table.is_some() || keys.file.is_some();
    if !is_table {
        params
            .idle(&["phaseAngle", "phaseColors", "phaseWavelengths"], "without `phaseTable` or `phaseFile`");
    }
    let implied = match (&keys, keys.g.unwrap_or(0.0)) {
        _ if is_table => PhaseName::Table,
        (PhaseKeys { droplets: Some(_), .. }, _) => PhaseName::Mie,
        (_, 0.0) => PhaseName::Isotropic,
        _ => PhaseName::HenyeyGreenstein,
    };
    let name = keys.phase.unwrap_or(implied);
    for (key, meant) in [
        ("g", PhaseName::HenyeyGreenstein),
        ("droplets", PhaseName::Mie),
        ("phaseTable", PhaseName::Table),
        ("phaseFile", PhaseName::Table),
    ] {
        if name != meant {
            params.idle(&[key], "with this `phase`");
        }
    }
    match name {
        PhaseName::Isotropic => Some(Phase::Isotropic),
        PhaseName::Rayleigh => Some(Phase::Rayleigh),
        PhaseName::HenyeyGreenstein => {
            let lobe = HenyeyGreenstein::new(keys.g.unwrap_or(0.0));
            if lobe.is_none() {
                let error = Diagnostic::error("`g` is more than -1 and less than 1");
                params.report(error, "a mean cosine of 1 would be no scattering");
            }
            lobe.map(Phase::HenyeyGreenstein)
        }
        PhaseName::Mie => MiePhase::new(keys.droplets.unwrap_or(20.0)).map(Phase::Mie),
        PhaseName::Table => table(&keys, params, sources),
    }
}

/// The phase function by numbers.
fn table(keys: &PhaseKeys<'_>, params: &mut Params<'_, '_>, sources: &Sources<'_>) -> Option<Phase> {
    let columns = match &keys.wavelengths {
        Some(At { value: NumberList(nm), .. }) => PhaseColumns::Wavelengths(nm.clone()),
        None if keys.colors => PhaseColumns::Rgb,
        None => PhaseColumns::One,
    };
    let (item, rows) = match (&keys.table, &keys.file) {
        (Some(At { value: NumberList(numbers), item }), _) => {
            (item, PhaseRows::new(columns.count(), numbers))
        }
        (None, Some(At { value: FileName(name), item })) => match text_of(name, item.path(), sources) {
            Ok(text) => (item, PhaseRows::parse(columns.count(), &text)),
            Err(reason) => {
                let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
                params.diagnostics().push(error.label(item.head_span(), "no phase function"));
                return None;
            }
        },
        (None, None) => {
            let error = Diagnostic::error("`phase table` has no numbers");
            params.report(error.help("write `phaseTable 0 4 90 1 180 2`, or `phaseFile haze.txt`"), "here");
            return None;
        }
    };
    let angle = keys.angle.unwrap_or(PhaseAngle::Degrees);
    let made = rows.and_then(|rows| Phase::by_numbers(&columns, &rows, angle));
    let report = |error: PhaseTableError| {
        let (of, item) = match (&error, &keys.wavelengths, &keys.file) {
            (PhaseTableError::Wavelength(_), Some(At { item, .. }), _) => {
                ("`phaseWavelengths`".to_owned(), item)
            }
            (_, _, Some(At { value: FileName(name), .. })) => (format!("cannot read `{name}`"), item),
            _ => ("`phaseTable`".to_owned(), item),
        };
        let error = Diagnostic::error(format!("{of}: {error}"));
        params.diagnostics().push(error.label(item.head_span(), "no phase function"));
    };
    made.map_err(report).ok()
}

/// The text of a file beside the scene.
fn text_of(name: &str, path: &str, sources: &Sources<'_>) -> Result<String, String> {
    let file = sources.textures.spectra.assets.open(name, path);
    let bytes = file.and_then(|file| read_limited(file, LARGEST_TABLE)).map_err(|error| error.to_string())?;
    String::from_utf8(bytes).map_err(|_| "it is not text".to_owned())
}
