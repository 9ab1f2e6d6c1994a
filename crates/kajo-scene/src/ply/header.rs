//! The header of a PLY file: what elements there are and how each is laid out.

use crate::limits::Limits;
use crate::line_reader::{Field, Fields, Line, LineReader};
use crate::mesh_file_error::MeshFileError;
use crate::tri_mesh::NO_INDEX;
use std::io::Read;

/// Most elements of a header, and most properties of an element.
const MOST: usize = 1000;

/// How values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A type of number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    #[default]
    F32,
    F64,
}

impl Scalar {
    fn named(name: &[u8]) -> Option<Scalar> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    /// Bytes of a number in binary files.
    pub fn bytes(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    /// The number that stands for all of a colour.
    pub fn whole_of_color(self) -> f32 {
        match self {
            Scalar::F32 | Scalar::F64 => 1.0,
            Scalar::I16 | Scalar::U16 => 65535.0,
            // Text files often call them `int`.
            Scalar::I8 | Scalar::U8 | Scalar::I32 | Scalar::U32 => 255.0,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }
}

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// A property that holds one number.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Column {
    /// Its number among the properties.
    pub property: usize,
    /// Where it begins in a binary record, if no list stands before it.
    pub offset: Option<usize>,
    pub scalar: Scalar,
}

#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
    /// Bytes of a binary record, if it holds no list.
    pub stride: Option<usize>,
    /// The coordinates, if this is `vertex`.
    pub position: [Column; 3],
    /// The number of the property that lists vertices, if this is `face` or `tristrips`.
    pub corner_list: usize,
}

impl Element {
    /// The columns of these names, if all are there.
    pub fn columns<const N: usize>(&self, names: [&str; N]) -> Option<[Column; N]> {
        let mut columns = [Column::default(); N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = self.column(name)?;
        }
        Some(columns)
    }

    /// The column of this name, if it is there.
    pub fn column(&self, name: &str) -> Option<Column> {
        let property = self.properties.iter().position(|p| p.name == name)?;
        let Kind::One(scalar) = self.properties[property].kind else { return None };
        let offset = self.properties[..property].iter().map(Property::fixed_bytes).sum();
        Some(Column { property, offset, scalar })
    }

    /// What its numbers are for, once all properties are known.
    fn settle(&mut self) -> Result<(), String> {
        self.stride = self.properties.iter().map(Property::fixed_bytes).sum();
        match self.name.as_str() {
            "vertex" => {
                self.position = self
                    .columns(["x", "y", "z"])
                    .ok_or("the vertices have no properties `x`, `y` and `z`".to_owned())?;
            }
            "face" | "tristrips" => {
                let is_list = |p: &Property| {
                    matches!(p.kind, Kind::List { .. })
                        && matches!(p.name.as_str(), "vertex_indices" | "vertex_index")
                };
                self.corner_list = self
                    .properties
                    .iter()
                    .position(is_list)
                    .ok_or_else(|| format!("`{}` has no list `vertex_indices`", self.name))?;
            }
            _ => {}
        }
        Ok(())
    }
}

/// Where an element has its colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColorColumns {
    pub rgb: [Column; 3],
    pub opacity: Option<Column>,
}

impl ColorColumns {
    pub fn of(element: &Element) -> Option<ColorColumns> {
        let names = [
            (["red", "green", "blue"], "alpha"),
            (["diffuse_red", "diffuse_green", "diffuse_blue"], "diffuse_alpha"),
            (["r", "g", "b"], "a"),
        ];
        let columns = |(rgb, opacity): ([&str; 3], &str)| {
            let opacity = element.column(opacity).or_else(|| element.column("alpha"));
            Some(ColorColumns { rgb: element.columns(rgb)?, opacity })
        };
        names.into_iter().find_map(columns)
    }

    /// Whether red, green and blue are values for a screen.
    pub fn is_srgb(&self) -> bool {
        self.rgb[0].scalar.is_integer()
    }

    /// The colour of an element, by the numbers of its properties.
    pub fn color(&self, scalars: &[f64]) -> [f32; 4] {
        let share = |column: Column| scalars[column.property] as f32 / column.scalar.whole_of_color();
        let [r, g, b] = self.rgb.map(share);
        [r, g, b, self.opacity.map_or(1.0, share)]
    }
}

impl Property {
    /// Bytes in a binary record; `None` for a list.
    fn fixed_bytes(&self) -> Option<usize> {
        match self.kind {
            Kind::One(scalar) => Some(scalar.bytes()),
            Kind::List { .. } => None,
        }
    }
}

/// All that stands before the values.
#[derive(Debug)]
pub(super) struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
}

impl Header {
    /// How many vertices there are, if the file is as long as it says.
    pub fn vertex_count(&self) -> usize {
        let vertices = self.elements.iter().find(|e| e.name == "vertex");
        vertices.map_or(0, |e| usize::try_from(e.count).unwrap_or(usize::MAX))
    }

    /// Reads up to and with `end_header`.
    pub fn read(
        lines: &mut LineReader<'_, impl Read>,
        path: &str,
        limits: &Limits,
    ) -> Result<Header, MeshFileError> {
        let mut reader = HeaderReader { path, limits, format: None, elements: Vec::new() };
        match lines.next_line()? {
            Some(line) if line.bytes.trim_ascii() == b"ply" => {}
            _ => return Err(lines.mistake("a PLY file begins with a line `ply`")),
        }
        loop {
            let Some(line) = lines.next_line()? else {
                return Err(lines.mistake("the file ends before `end_header`"));
            };
            let mut fields = line.fields();
            let Some(keyword) = fields.next() else { continue };
            match keyword.bytes {
                b"comment" | b"obj_info" => {}
                b"format" => reader.format(line, fields)?,
                b"element" => reader.element(line, keyword, fields)?,
                b"property" => reader.property(line, keyword, fields)?,
                b"end_header" => return reader.finish(line, keyword),
                _ => {
                    let message = format!("expected `property` or `end_header`, found {}", keyword.quoted());
                    return Err(line.mistake(path, keyword, message));
                }
            }
        }
    }

    /// Whether elements of this name have colours.
    pub fn has_colors(&self, element: &str) -> bool {
        let element = self.elements.iter().find(|e| e.name == element);
        element.is_some_and(|element| ColorColumns::of(element).is_some())
    }

    /// What the file has that is not supported.
    pub fn left_out(&self) -> Vec<String> {
        let has = |element: &str, property: &str| {
            self.elements.iter().any(|e| e.name == element && e.properties.iter().any(|p| p.name == property))
        };
        let mut list = Vec::new();
        if self.has_colors("face") && self.has_colors("vertex") {
            list.push("the colours of the faces are not used, only those of vertices".to_owned());
        }
        if has("face", "texcoord") {
            list.push("the texture coordinates of the faces are not used, only those of vertices".to_owned());
        }
        for element in self.elements.iter().filter(|e| e.count > 0) {
            if !matches!(element.name.as_str(), "vertex" | "face" | "tristrips") {
                list.push(format!("{} `{}` were skipped", element.count, element.name));
            }
        }
        list
    }
}

struct HeaderReader<'l> {
    path: &'l str,
    limits: &'l Limits,
    format: Option<Format>,
    elements: Vec<Element>,
}

impl HeaderReader<'_> {
    fn format(&mut self, line: Line<'_>, mut fields: Fields<'_>) -> Result<(), MeshFileError> {
        let word = fields.next().unwrap_or(fields.end());
        self.format = Some(match word.bytes {
            b"ascii" => Format::Ascii,
            b"binary_little_endian" => Format::LittleEndian,
            b"binary_big_endian" => Format::BigEndian,
            _ => {
                let message = "expected `ascii`, `binary_little_endian` or `binary_big_endian`";
                return Err(line.mistake(self.path, word, message));
            }
        });
        Ok(())
    }

    fn element(
        &mut self,
        line: Line<'_>,
        keyword: Field<'_>,
        mut fields: Fields<'_>,
    ) -> Result<(), MeshFileError> {
        self.settle_last(line, keyword)?;
        let name = fields.next().unwrap_or(fields.end());
        let place = fields.next().unwrap_or(fields.end());
        let count = std::str::from_utf8(place.bytes).ok().and_then(|text| text.parse::<u64>().ok());
        let Some(count) = count else {
            let message = format!("expected the number of elements, found {}", place.quoted());
            return Err(line.mistake(self.path, place, message));
        };
        let name_text = String::from_utf8_lossy(name.bytes).into_owned();
        let most = match name_text.as_str() {
            "vertex" => self.limits.vertices.min(NO_INDEX as usize) as u64,
            "face" => self.limits.faces as u64,
            _ => u64::MAX,
        };
        if count > most {
            let message = format!("the file says it has {count} `{name_text}`, and at most {most} are read");
            return Err(line.mistake(self.path, place, message));
        }
        let known = |name: &str| self.elements.iter().any(|e| e.name == name);
        if known(&name_text) {
            return Err(line.mistake(self.path, name, format!("there are two elements `{name_text}`")));
        }
        if self.elements.len() == MOST {
            return Err(line.mistake(self.path, keyword, format!("there are more than {MOST} elements")));
        }
        self.elements.push(Element {
            name: name_text,
            count,
            properties: Vec::new(),
            stride: None,
            position: [Column::default(); 3],
            corner_list: 0,
        });
        Ok(())
    }

    fn property(
        &mut self,
        line: Line<'_>,
        keyword: Field<'_>,
        mut fields: Fields<'_>,
    ) -> Result<(), MeshFileError> {
        let mut word = || fields.next().unwrap_or(fields.end());
        let first = word();
        let path = self.path;
        let scalar = |field: Field<'_>| {
            Scalar::named(field.bytes).ok_or_else(|| {
                let message = format!("expected a type such as `float` or `uchar`, found {}", field.quoted());
                line.mistake(path, field, message)
            })
        };
        let kind = if first.bytes == b"list" {
            let place = word();
            let count = scalar(place)?;
            if !count.is_integer() {
                return Err(line.mistake(path, place, "the length of a list must be of an integer type"));
            }
            Kind::List { count, item: scalar(word())? }
        } else {
            Kind::One(scalar(first)?)
        };
        let name = String::from_utf8_lossy(word().bytes).into_owned();
        let Some(element) = self.elements.last_mut() else {
            return Err(line.mistake(path, keyword, "there is no `element` before this property"));
        };
        if element.properties.len() == MOST {
            return Err(line.mistake(path, keyword, format!("there are more than {MOST} properties")));
        }
        element.properties.push(Property { name, kind });
        Ok(())
    }

    fn settle_last(&mut self, line: Line<'_>, keyword: Field<'_>) -> Result<(), MeshFileError> {
        let Some(element) = self.elements.last_mut() else { return Ok(()) };
        element.settle().map_err(|message| line.mistake(self.path, keyword, message))
    }

    fn finish(mut self, line: Line<'_>, keyword: Field<'_>) -> Result<Header, MeshFileError> {
        self.settle_last(line, keyword)?;
        let missing = |what| line.mistake(self.path, keyword, what);
        let format = self.format.ok_or_else(|| missing("there is no `format` before this"))?;
        if !self.elements.iter().any(|e| e.name == "vertex") {
            return Err(missing("there is no `element vertex` before this"));
        }
        Ok(Header { format, elements: self.elements })
    }
}
