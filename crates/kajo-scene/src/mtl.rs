//! Wavefront MTL: the materials that OBJ files name.
//!
//! Colours and numbers are read with their places checked; maps are kept as
//! file names; what is not known is counted.

use crate::limits::Limits;
use crate::line_reader::{Field, Fields, Line, LineReader, MeshFileError};
use std::io::Read;

/// One `newmtl`; what the file does not say is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlMaterial {
    /// The name that `usemtl` uses.
    pub name: String,
    /// `Ka`, ambient colour.
    pub ambient: Option<[f32; 3]>,
    /// `Kd`, diffuse colour.
    pub diffuse: Option<[f32; 3]>,
    /// `Ks`, specular colour.
    pub specular: Option<[f32; 3]>,
    /// `Ke`, emitted colour.
    pub emission: Option<[f32; 3]>,
    /// `Tf`, colour of what passes through.
    pub transmission: Option<[f32; 3]>,
    /// `Ns`, specular exponent.
    pub exponent: Option<f32>,
    /// `Ni`, index of refraction.
    pub index_of_refraction: Option<f32>,
    /// `d`, or 1 minus `Tr`: 1 is opaque, 0 invisible. The last of the two in the file counts.
    pub opacity: Option<f32>,
    /// `illum`, the number of the lighting model.
    pub illumination: Option<u32>,
    /// Texture statements in order, such as `("map_Kd", "wood.png")`; their options are left out.
    pub maps: Vec<(String, String)>,
}

/// The materials of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlFile {
    /// In the order of the file. Names may repeat; the last one counts.
    pub materials: Vec<MtlMaterial>,
    /// Statements that are not known, or stand before the first `newmtl`.
    pub unknown: usize,
}

/// Reads an MTL file; `path` is its name in messages.
///
/// ```
/// let file = kajo_scene::read_mtl(&b"newmtl gold\nKd 1 .8 0\n"[..], "a.mtl", &Default::default()).unwrap();
/// assert_eq!(file.materials[0].diffuse, Some([1.0, 0.8, 0.0]));
/// ```
///
/// # Errors
/// At the first number that is missing, malformed or not finite, or beyond a
/// limit; or when reading fails.
pub fn read_mtl(reader: impl Read, path: &str, limits: &Limits) -> Result<MtlFile, MeshFileError> {
    let mut lines = LineReader::new(reader, path, limits);
    let mut file = MtlFile::default();
    while let Some(line) = lines.next_line()? {
        let mut fields = line.fields();
        let Some(keyword) = fields.next() else { continue };
        if keyword.bytes == b"newmtl" {
            if file.materials.len() >= limits.materials {
                let message = format!("the file has more than {} materials", limits.materials);
                return Err(line.mistake(path, keyword, message));
            }
            file.materials.push(MtlMaterial { name: text(fields.rest()), ..MtlMaterial::default() });
            continue;
        }
        let statement = Statement { path, line, keyword, fields };
        let known = match file.materials.last_mut() {
            Some(material) => statement.apply(material)?,
            None => false,
        };
        file.unknown += usize::from(!known);
    }
    Ok(file)
}

struct Statement<'a, 'b> {
    path: &'a str,
    line: Line<'b>,
    keyword: Field<'b>,
    fields: Fields<'b>,
}

impl Statement<'_, '_> {
    /// Whether the statement is known.
    fn apply(mut self, material: &mut MtlMaterial) -> Result<bool, MeshFileError> {
        match self.keyword.bytes {
            b"Ka" => material.ambient = self.color()?,
            b"Kd" => material.diffuse = self.color()?,
            b"Ks" => material.specular = self.color()?,
            b"Ke" => material.emission = self.color()?,
            b"Tf" => material.transmission = self.color()?,
            b"Ns" => material.exponent = Some(self.number()?),
            b"Ni" => material.index_of_refraction = Some(self.number()?),
            b"d" => material.opacity = Some(self.opacity()?),
            b"Tr" => material.opacity = Some(1.0 - self.number()?),
            b"illum" => material.illumination = Some(self.number()? as u32),
            b"bump" | b"disp" | b"decal" | b"norm" | b"refl" => self.map(material),
            keyword if keyword.starts_with(b"map_") => self.map(material),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Three numbers, or one for all three; `None` for the forms `spectral` and `xyz`.
    fn color(&mut self) -> Result<Option<[f32; 3]>, MeshFileError> {
        if matches!(self.fields.clone().next(), Some(Field { bytes: b"spectral" | b"xyz", .. })) {
            return Ok(None);
        }
        let red = self.number()?;
        if self.fields.clone().next().is_none() {
            return Ok(Some([red; 3]));
        }
        Ok(Some([red, self.number()?, self.number()?]))
    }

    /// A number, after `-halo` if that is there.
    fn opacity(&mut self) -> Result<f32, MeshFileError> {
        if matches!(self.fields.clone().next(), Some(Field { bytes: b"-halo", .. })) {
            self.fields.next();
        }
        self.number()
    }

    fn number(&mut self) -> Result<f32, MeshFileError> {
        let key = || String::from_utf8_lossy(self.keyword.bytes);
        let Some(field) = self.fields.next() else {
            let message = format!("expected a number after `{}`, found the end of the line", key());
            return Err(self.line.mistake(self.path, self.fields.end(), message));
        };
        field.float().filter(|x| x.is_finite()).ok_or_else(|| {
            let message = format!("expected a finite number after `{}`, found {}", key(), field.quoted());
            self.line.mistake(self.path, field, message)
        })
    }

    fn map(self, material: &mut MtlMaterial) {
        let file = text(without_options(self.fields).rest());
        if !file.is_empty() {
            material.maps.push((text(self.keyword), file));
        }
    }
}

/// What follows the options of a texture statement, such as `-s 1 1 1 -clamp on`.
fn without_options(mut fields: Fields<'_>) -> Fields<'_> {
    while let Some(option) = fields.clone().next().filter(|field| field.bytes.starts_with(b"-")) {
        fields.next();
        if matches!(option.bytes, b"-imfchan" | b"-type") {
            fields.next();
            continue;
        }
        let is_value = |field: Field<'_>| matches!(field.bytes, b"on" | b"off") || field.float().is_some();
        while fields.clone().next().is_some_and(is_value) {
            fields.next();
        }
    }
    fields
}

fn text(field: Field<'_>) -> String {
    String::from_utf8_lossy(field.bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<MtlFile, String> {
        read_mtl(text.as_bytes(), "m.mtl", &Limits::default()).map_err(|error| error.to_string())
    }

    #[test]
    fn every_statement_reaches_its_field() {
        let text = "newmtl red paint # x\nKa 1 2 3\nKd 0.5\nKs 4 5 6\nKe 7 8 9\nTf 1 0 1\nNs 10\nNi 1.5\n\
                    Tr 0.25\nillum 2\nmap_Kd -s 1 1 1 -clamp on -imfchan r my wood.png\nbump -bm 0.5 b.png\n\
                    newmtl glass\nTr 0.9\nd -halo 0.5\nKd spectral a.rfl\n";
        let file = read(text).unwrap();
        let red = MtlMaterial {
            name: "red paint # x".to_owned(),
            ambient: Some([1., 2., 3.]),
            diffuse: Some([0.5; 3]),
            specular: Some([4., 5., 6.]),
            emission: Some([7., 8., 9.]),
            transmission: Some([1., 0., 1.]),
            exponent: Some(10.0),
            index_of_refraction: Some(1.5),
            opacity: Some(0.75),
            illumination: Some(2),
            maps: vec![
                ("map_Kd".to_owned(), "my wood.png".to_owned()),
                ("bump".to_owned(), "b.png".to_owned()),
            ],
        };
        let glass = MtlMaterial { name: "glass".to_owned(), opacity: Some(0.5), ..MtlMaterial::default() };
        assert_eq!(file, MtlFile { materials: vec![red, glass], unknown: 0 });
    }

    #[test]
    fn unknown_and_early_statements_are_counted() {
        let file = read("Kd 1 1 1\nnewmtl a\nsharpness 3\nhello\n").unwrap();
        assert_eq!((file.materials.len(), file.unknown), (1, 3));
    }

    #[test]
    fn mistakes_have_line_column_and_reason() {
        for (text, expected) in [
            ("newmtl a\nKd 1 2\n", "m.mtl:2:7: expected a number after `Kd`, found the end of the line"),
            ("newmtl a\nNs x\n", "m.mtl:2:4: expected a finite number after `Ns`, found `x`"),
            ("newmtl a\nKe 1 nan 0\n", "m.mtl:2:6: expected a finite number after `Ke`, found `nan`"),
            ("newmtl a\nd 1e99\n", "m.mtl:2:3: expected a finite number after `d`, found `1e99`"),
        ] {
            assert_eq!(read(text).unwrap_err(), expected);
        }
        let limits = Limits { materials: 1, ..Limits::default() };
        assert!(read_mtl(&b"newmtl a\nnewmtl b\n"[..], "m", &limits).is_err());
    }
}
