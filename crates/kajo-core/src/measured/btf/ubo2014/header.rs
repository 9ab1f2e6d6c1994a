//! What a file says before its matrices.

use std::io::Read;

use super::super::error::BtfError;
use super::super::file::{MAX_SIDE, check_horizon};
use super::super::reader::Reader;
use super::colors::ColorModel;
use crate::measured::{DirectionSet, MAX_DIRECTIONS, direction};

/// How values are divided into matrices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Two for each number of a colour: DFMF.
    Decorrelated,
    /// Two for all numbers: FMF.
    Full,
}

/// For each direction its angle to the normal and that around it, radians.
type Angles = Vec<[f32; 2]>;

/// What is known before the matrices.
#[derive(Debug)]
pub(super) struct Header {
    pub form: Form,
    pub color_model: ColorModel,
    /// Whether values have the cosine of the light in them.
    pub has_cosine: bool,
    pub views: Angles,
    pub lights: Angles,
    /// Width and height in texels.
    pub size: [u32; 2],
}

/// The part of the file that errors name.
const PART: &str = "header";

/// Length of each of three texts about the measurement.
const TEXT: u64 = 80;

impl Header {
    /// Reads all up to the matrices.
    ///
    /// # Errors
    /// [`BtfError`], at the first thing that is malformed, cut off, or not known.
    pub fn read(reader: &mut Reader<'_, impl Read>) -> Result<Header, BtfError> {
        let (form, is_extended) = read_signature(reader)?;
        // An R says that there are rotations; it is part of the signature. What else comes is the length of the header.
        let begins = reader.position();
        let first = reader.byte(PART)?;
        let has_rotations = first == b'R';
        let mut length = [first, 0, 0, 0];
        let begins = if has_rotations {
            reader.bytes(&mut length, PART)?;
            begins + 1
        } else {
            reader.bytes(&mut length[1..], PART)?;
            begins
        };
        let has_cosine = read_about(reader)?;
        let (found, length) = (reader.position() - begins, u32::from_le_bytes(length));
        if found != u64::from(length) {
            return Err(content(format!("its header has {found} bytes and says that it has {length}")));
        }
        let (views, lights) = read_directions(reader)?;
        check_horizon(&lights, has_cosine)?;
        let size = [reader.whole(PART)?, reader.whole(PART)?];
        if let Some(n) = size.iter().find(|n| !(1..=MAX_SIDE).contains(*n)) {
            return Err(content(format!(
                "one of its sides has {n} texels, which have to be 1 to {MAX_SIDE}"
            )));
        }
        if has_rotations {
            let rotations = reader.whole(PART)?;
            reader.skip(36 * u64::from(rotations), "rotations")?;
        }
        let color_model = match form {
            Form::Decorrelated => read_color_model(reader)?,
            Form::Full => read_extension(reader, is_extended)?,
        };
        Ok(Header { form, color_model, has_cosine, views, lights, size })
    }
}

pub(super) fn content(what: String) -> BtfError {
    BtfError::Content(what)
}

/// The form, and for FMF whether more is said before the matrices.
fn read_signature(reader: &mut Reader<'_, impl Read>) -> Result<(Form, bool), BtfError> {
    let mut begin = [0; 8];
    match reader.bytes(&mut begin, PART) {
        Err(BtfError::Short(_)) => return Err(BtfError::Signature),
        other => other?,
    }
    let (form, last) = match &begin {
        b"!DFMF08F" => (Form::Decorrelated, Some(b'C')),
        b"!FMF12FC" => (Form::Full, Some(b'E')),
        b"!FMF06FC" => (Form::Full, None),
        b"!PVF06FC" => return Err(BtfError::Form("PVF, a factorisation for each view")),
        b"!BDIF06R" => return Err(BtfError::Form("BDI, pictures that are not compressed")),
        _ => return Err(BtfError::Signature),
    };
    if let Some(last) = last
        && reader.byte(PART)? != last
    {
        return Err(BtfError::Signature);
    }
    Ok((form, last == Some(b'E')))
}

/// Passes over what is said about the measurement; answers whether values have the cosine of the light in them.
fn read_about(reader: &mut Reader<'_, impl Read>) -> Result<bool, BtfError> {
    let version = reader.whole(PART)?;
    if !(1..=4).contains(&version) {
        return Err(content(format!("its header is of version {version}; 1 to 4 are read")));
    }
    // The setup, the sensor and the light; pixels for a millimetre and a factor of each colour.
    reader.skip(3 * TEXT + 4 + 12, PART)?;
    let has_cosine = version > 1 && reader.whole(PART)? != 0;
    if version > 2 {
        let length = reader.whole(PART)?;
        reader.skip(length.into(), "description")?;
    }
    if version > 3 {
        let channels = reader.whole(PART)?;
        if channels != 3 {
            return Err(content(format!("it has {channels} colour channels, and those with 3 are read")));
        }
        for _ in 0..channels {
            let length = reader.whole(PART)?;
            reader.skip(length.into(), "names of colour channels")?;
        }
    }
    Ok(has_cosine)
}

/// Views and lights: for each view its direction and those of all lights, which are the same for all views.
fn read_directions(reader: &mut Reader<'_, impl Read>) -> Result<(Angles, Angles), BtfError> {
    /// The length of the difference of two directions that are the same.
    const SAME: f32 = 1e-3;
    let count = |n: u32, what: &str| match n {
        1.. if n as usize <= MAX_DIRECTIONS => Ok(n),
        _ => Err(content(format!("it has {n} {what}, which have to be from 1 to {MAX_DIRECTIONS}"))),
    };
    let n_views = count(reader.whole(PART)?, "views")?;
    let (mut views, mut lights) = (Vec::new(), Vec::new());
    for view in 0..n_views {
        views.extend(reader.angles(1)?);
        let n_lights = count(reader.whole("directions")?, "lights")?;
        let of_view = reader.angles(n_lights)?;
        if view == 0 {
            lights = of_view;
            continue;
        }
        let is_same = |(&a, &b): (&[f32; 2], &[f32; 2])| (direction(a) - direction(b)).length() < SAME;
        if of_view.len() != lights.len() || !of_view.iter().zip(&lights).all(is_same) {
            return Err(content(format!("the lights of view {view} are not those of view 0")));
        }
    }
    DirectionSet::new(&views).map_err(BtfError::Views)?;
    DirectionSet::new(&lights).map_err(BtfError::Lights)?;
    Ok((views, lights))
}

/// The colour model of DFMF.
fn read_color_model(reader: &mut Reader<'_, impl Read>) -> Result<ColorModel, BtfError> {
    const PART: &str = "colour model";
    // The most components of a matrix, each of which says its own.
    reader.whole(PART)?;
    let number = reader.whole(PART)?;
    let mut numbers = [0.0; 12];
    for n in &mut numbers {
        *n = f32::from_bits(reader.whole(PART)?);
    }
    let [mean, x, y, z] = [0, 3, 6, 9].map(|i| [numbers[i], numbers[i + 1], numbers[i + 2]]);
    ColorModel::new(number, mean, [x, y, z])
}

/// What FMF says: whether logarithms were taken. A map of heights is passed over.
fn read_extension(reader: &mut Reader<'_, impl Read>, is_extended: bool) -> Result<ColorModel, BtfError> {
    const PART: &str = "second header";
    let version = if is_extended { reader.byte(PART)? } else { 0 };
    if version > 2 {
        return Err(content(format!("its second header is of version {version}; 0 to 2 are read")));
    }
    let has_logarithms = version >= 1 && reader.whole(PART)? != 0;
    if version >= 2 {
        let [width, height] = [reader.whole(PART)?, reader.whole(PART)?];
        if width.max(height) > MAX_SIDE {
            return Err(content(format!("its map of heights has {width} x {height} texels")));
        }
        reader.skip(2 * u64::from(width) * u64::from(height), "map of heights")?;
    }
    Ok(if has_logarithms { ColorModel::LogRgb } else { ColorModel::Rgb })
}
