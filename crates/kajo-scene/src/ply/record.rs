//! Elements of a PLY file one by one, whatever their layout.

use super::header::{Element, Kind, Scalar};
use crate::byte_reader::ByteReader;
use crate::line_reader::{Fields, Line, LineReader};
use crate::mesh_file_error::MeshFileError;
use std::io::Read;

/// Where elements come from.
pub(super) enum Records<'l, R> {
    /// Text, an element to a line, and the file's name.
    Lines(LineReader<'l, R>, &'l str),
    /// Binary, the lowest byte first.
    Little(ByteReader<'l, R>),
    /// Binary, the highest byte first.
    Big(ByteReader<'l, R>),
}

/// What is to be kept of an element.
#[derive(Clone, Copy)]
pub(super) enum Wanted {
    Nothing,
    /// All that is not a list.
    Scalars,
    /// One list, of at most so many items, and all that is not a list.
    List {
        property: usize,
        most: usize,
    },
}

/// The kept values of an element. Every type of number fits an `f64` exactly.
#[derive(Default)]
pub(super) struct Record {
    /// One for each property; of lists their length.
    pub scalars: Vec<f64>,
    pub list: Vec<f64>,
}

impl<R: Read> Records<'_, R> {
    /// Reads element `number` into `record`.
    pub fn read(
        &mut self,
        element: &Element,
        number: u64,
        wanted: Wanted,
        record: &mut Record,
    ) -> Result<(), MeshFileError> {
        record.scalars.clear();
        record.list.clear();
        match self {
            Records::Lines(lines, path) => loop {
                let Some(line) = lines.next_line()? else {
                    return Err(lines.mistake(cut_off(element, number)));
                };
                let fields = line.fields();
                if fields.clone().next().is_some() {
                    return read_properties(
                        &mut LineValues { fields, line, path },
                        element,
                        number,
                        wanted,
                        record,
                    );
                }
            },
            Records::Little(bytes) => {
                let mut values = ByteValues { bytes, convert: little };
                read_properties(&mut values, element, number, wanted, record)
            }
            Records::Big(bytes) => {
                let mut values = ByteValues { bytes, convert: big };
                read_properties(&mut values, element, number, wanted, record)
            }
        }
    }

    /// Steps over element `number`.
    pub fn skip(&mut self, element: &Element, number: u64) -> Result<(), MeshFileError> {
        self.read(element, number, Wanted::Nothing, &mut Record::default())
    }

    /// A mistake in the element read last.
    pub fn mistake(&self, element: &Element, number: u64, message: &str) -> MeshFileError {
        let message = format!("{} {number}: {message}", element.name);
        match self {
            Records::Lines(lines, _) => lines.mistake_in_last(message),
            Records::Little(bytes) | Records::Big(bytes) => bytes.mistake(message),
        }
    }
}

/// What is said when the file ends too early.
pub(super) fn cut_off(element: &Element, number: u64) -> String {
    format!("the file ends in {} {number} of {}", element.name, element.count)
}

/// Numbers one after the other.
trait Values {
    /// The next number, or `None` at the end.
    fn number(&mut self, scalar: Scalar) -> Result<Option<f64>, MeshFileError>;

    /// Steps over numbers; `false` when they are not all there.
    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<bool, MeshFileError>;

    fn mistake(&self, message: String) -> MeshFileError;

    /// That numbers of an element are missing.
    fn cut_off(&self, element: &Element, number: u64) -> MeshFileError;
}

fn read_properties(
    values: &mut impl Values,
    element: &Element,
    number: u64,
    wanted: Wanted,
    record: &mut Record,
) -> Result<(), MeshFileError> {
    for (i, property) in element.properties.iter().enumerate() {
        let (Kind::One(scalar) | Kind::List { count: scalar, .. }) = property.kind;
        let value = values.number(scalar)?.ok_or_else(|| values.cut_off(element, number))?;
        if !matches!(wanted, Wanted::Nothing) {
            record.scalars.push(value);
        }
        let Kind::List { item, .. } = property.kind else { continue };
        if value < 0.0 || value.fract() != 0.0 {
            let message = format!("{} {number}: a list cannot have {value} items", element.name);
            return Err(values.mistake(message));
        }
        let whole = match wanted {
            Wanted::List { property, most } if property == i => {
                if value > most as f64 {
                    let message = format!("{} {number} has more than {most} corners", element.name);
                    return Err(values.mistake(message));
                }
                read_list(values, item, value as usize, &mut record.list)?
            }
            _ => values.skip(item, value as u64)?,
        };
        if !whole {
            return Err(values.cut_off(element, number));
        }
    }
    Ok(())
}

fn read_list(
    values: &mut impl Values,
    item: Scalar,
    count: usize,
    list: &mut Vec<f64>,
) -> Result<bool, MeshFileError> {
    for _ in 0..count {
        match values.number(item)? {
            Some(value) => list.push(value),
            None => return Ok(false),
        }
    }
    Ok(true)
}

/// The words of a line.
struct LineValues<'b> {
    fields: Fields<'b>,
    line: Line<'b>,
    path: &'b str,
}

impl Values for LineValues<'_> {
    fn number(&mut self, _: Scalar) -> Result<Option<f64>, MeshFileError> {
        let Some(field) = self.fields.next() else { return Ok(None) };
        let value = std::str::from_utf8(field.bytes).ok().and_then(|text| text.parse().ok());
        value.map(Some).ok_or_else(|| {
            self.line.mistake(self.path, field, format!("expected a number, found {}", field.quoted()))
        })
    }

    fn skip(&mut self, _: Scalar, count: u64) -> Result<bool, MeshFileError> {
        for _ in 0..count {
            if self.fields.next().is_none() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn mistake(&self, message: String) -> MeshFileError {
        self.line.mistake(self.path, self.fields.end(), message)
    }

    fn cut_off(&self, element: &Element, number: u64) -> MeshFileError {
        self.mistake(format!("{} {number} has more numbers than this line", element.name))
    }
}

/// Bytes, and how to read a number from its own.
struct ByteValues<'b, 'l, R> {
    bytes: &'b mut ByteReader<'l, R>,
    convert: fn(Scalar, &[u8]) -> Option<f64>,
}

impl<R: Read> Values for ByteValues<'_, '_, R> {
    fn number(&mut self, scalar: Scalar) -> Result<Option<f64>, MeshFileError> {
        let n = scalar.bytes();
        let Some(own) = self.bytes.at_least(n)?.get(..n) else { return Ok(None) };
        let value = (self.convert)(scalar, own);
        self.bytes.consume(n);
        Ok(value)
    }

    fn skip(&mut self, scalar: Scalar, count: u64) -> Result<bool, MeshFileError> {
        self.bytes.skip(count.saturating_mul(scalar.bytes() as u64))
    }

    fn mistake(&self, message: String) -> MeshFileError {
        self.bytes.mistake(message)
    }

    fn cut_off(&self, element: &Element, number: u64) -> MeshFileError {
        self.mistake(cut_off(element, number))
    }
}

fn little(scalar: Scalar, bytes: &[u8]) -> Option<f64> {
    Some(match scalar {
        Scalar::I8 => i8::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::U8 => u8::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::I16 => i16::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::U16 => u16::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::I32 => i32::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::U32 => u32::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::F32 => f32::from_le_bytes(bytes.try_into().ok()?).into(),
        Scalar::F64 => f64::from_le_bytes(bytes.try_into().ok()?),
    })
}

fn big(scalar: Scalar, bytes: &[u8]) -> Option<f64> {
    let mut turned = [0; 8];
    let turned = turned.get_mut(..bytes.len())?;
    turned.copy_from_slice(bytes);
    turned.reverse();
    little(scalar, turned)
}
