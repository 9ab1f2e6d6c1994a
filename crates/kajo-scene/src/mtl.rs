//! Wavefront MTL: the materials that OBJ files name.
//!
//! ```text
//! newmtl NAME     Kd r g b     Ns e     d o     map_Kd [OPTIONS] FILE     ...
//! Pr 0.3   Pm 1   Pc 0.5   Pcr 0.1   Ps 0.2   aniso 0.8   anisor 0.25
//! ```
//!
//! Colours and numbers are read with their places checked; the case of keywords means nothing. What is not read is
//! named with its line in [`MtlFile::skipped`].

use crate::limits::Limits;
use crate::line_reader::{Field, Fields, Line, LineReader};
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
use crate::skipped::Skipped;
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
    /// `Pr`, roughness.
    pub roughness: Option<f32>,
    /// `Pm`, metalness.
    pub metalness: Option<f32>,
    /// `Ps`, sheen.
    pub sheen: Option<f32>,
    /// `Pc`, coat.
    pub coat: Option<f32>,
    /// `Pcr`, roughness of the coat.
    pub coat_roughness: Option<f32>,
    /// `aniso`, how far highlights are drawn out.
    pub anisotropy: Option<f32>,
    /// `anisor`, which way, in turns.
    pub anisotropy_rotation: Option<f32>,
    /// Whether Blender wrote the file, by its first comment: there `Tf` beside `Pr` is the share of light that goes in.
    pub by_blender: bool,
    /// Pictures in the order of the file.
    pub maps: Vec<MtlMap>,
}

/// What a picture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MtlMapUse {
    /// `map_Kd`.
    Diffuse,
    /// `map_Ke`.
    Emission,
    /// `map_d`.
    Opacity,
    /// `norm`.
    Normals,
    /// `bump` or `map_Bump`.
    Bump,
    /// `map_Pr`.
    Roughness,
    /// `map_Pm`.
    Metalness,
    /// `map_Ps`.
    Sheen,
    /// `map_Pc`.
    Coat,
    /// `map_Pcr`.
    CoatRoughness,
}

/// A picture of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct MtlMap {
    /// What it is for.
    pub shows: MtlMapUse,
    /// As written, back slashes included.
    pub file: String,
    /// `-s`: how often it fits into the unit square, across and up.
    pub repeat: [f32; 2],
    /// `-o`: by how much of itself it is moved, to the left and down.
    pub offset: [f32; 2],
    /// `-clamp on`: its last row and column go on beside it.
    pub clamps: bool,
    /// `-bm`: factor of a relief.
    pub bump: f32,
    /// `-imfchan`: 0 for red, 1 green, 2 blue, 3 for what it covers.
    pub channel: Option<u8>,
}

/// The materials of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MtlFile {
    /// In the order of the file. Names may repeat; the last one counts.
    pub materials: Vec<MtlMaterial>,
    /// What is not read.
    pub skipped: Skipped,
}

impl MtlMaterial {
    /// The last picture that is for this.
    pub fn map(&self, shows: MtlMapUse) -> Option<&MtlMap> {
        self.maps.iter().rev().find(|map| map.shows == shows)
    }
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
    let mut memory = ReadMemory::new(&limits.memory);
    let mut by_blender = false;
    while let Some(line) = lines.next_line()? {
        by_blender |= line.bytes.starts_with(b"# Blender ");
        let mut fields = line.fields();
        let Some(keyword) = fields.next() else { continue };
        if keyword.bytes.eq_ignore_ascii_case(b"newmtl") {
            if file.materials.len() >= limits.materials {
                let message = format!("the file has more than {} materials", limits.materials);
                return Err(line.mistake(path, keyword, message));
            }
            let material = MtlMaterial { name: text(fields.rest()), by_blender, ..MtlMaterial::default() };
            let taken = memory.take(material.name.len());
            let pushed = taken.and_then(|()| memory.push(&mut file.materials, material));
            pushed.map_err(|over| MeshFileError::memory(path, over))?;
            continue;
        }
        let Some(material) = file.materials.last_mut() else {
            file.skipped.add("what stands before the first `newmtl`", line.number);
            continue;
        };
        let statement = Statement { path, line, keyword, fields, skipped: &mut file.skipped };
        let maps = material.maps.len();
        statement.apply(material)?;
        for map in &material.maps[maps..] {
            let bytes = 2 * size_of::<MtlMap>() + map.file.len();
            memory.take(bytes).map_err(|over| MeshFileError::memory(path, over))?;
        }
    }
    Ok(file)
}

struct Statement<'a, 'b> {
    path: &'a str,
    line: Line<'b>,
    keyword: Field<'b>,
    fields: Fields<'b>,
    skipped: &'a mut Skipped,
}

impl Statement<'_, '_> {
    fn apply(mut self, material: &mut MtlMaterial) -> Result<(), MeshFileError> {
        match self.keyword.bytes.to_ascii_lowercase().as_slice() {
            b"ka" => material.ambient = self.color()?,
            b"kd" => material.diffuse = self.color()?,
            b"ks" => material.specular = self.color()?,
            b"ke" => material.emission = self.color()?,
            b"tf" => material.transmission = self.color()?,
            b"ns" => material.exponent = Some(self.number()?),
            b"ni" => material.index_of_refraction = Some(self.number()?),
            b"d" => material.opacity = Some(self.opacity()?),
            b"tr" => material.opacity = Some(1.0 - self.number()?),
            b"illum" => material.illumination = Some(self.number()? as u32),
            b"pr" => material.roughness = Some(self.number()?),
            b"pm" => material.metalness = Some(self.number()?),
            b"ps" => material.sheen = Some(self.number()?),
            b"pc" => material.coat = Some(self.number()?),
            b"pcr" => material.coat_roughness = Some(self.number()?),
            b"aniso" => material.anisotropy = Some(self.number()?),
            b"anisor" => material.anisotropy_rotation = Some(self.number()?),
            b"map_kd" => self.map(material, MtlMapUse::Diffuse),
            b"map_ke" => self.map(material, MtlMapUse::Emission),
            b"map_d" => self.map(material, MtlMapUse::Opacity),
            b"norm" | b"map_norm" => self.map(material, MtlMapUse::Normals),
            b"bump" | b"map_bump" => self.map(material, MtlMapUse::Bump),
            b"map_pr" => self.map(material, MtlMapUse::Roughness),
            b"map_pm" => self.map(material, MtlMapUse::Metalness),
            b"map_ps" => self.map(material, MtlMapUse::Sheen),
            b"map_pc" => self.map(material, MtlMapUse::Coat),
            b"map_pcr" => self.map(material, MtlMapUse::CoatRoughness),
            _ => self.skipped.word(self.keyword.bytes, self.line.number),
        }
        Ok(())
    }

    /// Three numbers, or one for all three; `None` for the forms `spectral` and `xyz`.
    fn color(&mut self) -> Result<Option<[f32; 3]>, MeshFileError> {
        if let Some(form) = self.fields.clone().next()
            && matches!(form.bytes, b"spectral" | b"xyz")
        {
            let what = format!("`{} {}`", text(self.keyword), text(form));
            self.skipped.add(&what, self.line.number);
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
        if let Some(option) = self.fields.clone().next().filter(|field| field.bytes == b"-halo") {
            self.fields.next();
            self.skipped.word(option.bytes, self.line.number);
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

    fn map(mut self, material: &mut MtlMaterial, shows: MtlMapUse) {
        let mut map = MtlMap {
            shows,
            file: String::new(),
            repeat: [1.0; 2],
            offset: [0.0; 2],
            clamps: false,
            bump: 1.0,
            channel: None,
        };
        while let Some(option) = self.fields.clone().next().filter(|field| field.bytes.starts_with(b"-")) {
            self.fields.next();
            self.option(option, &mut map);
        }
        map.file = text(self.fields.rest());
        if !map.file.is_empty() {
            material.maps.push(map);
        }
    }

    /// An option of a picture with its values.
    fn option(&mut self, option: Field<'_>, map: &mut MtlMap) {
        match option.bytes {
            b"-s" => map.repeat = self.pair(1.0).map(|v| if v == 0.0 { 1.0 } else { v }),
            b"-o" => map.offset = self.pair(0.0),
            b"-bm" => map.bump = self.values::<1>()[0].unwrap_or(1.0),
            b"-clamp" => map.clamps = self.word() == b"on",
            b"-imfchan" => {
                let channels = [&b"r"[..], b"g", b"b", b"m"];
                let named = self.word();
                map.channel = channels.iter().position(|&name| name == named).map(|i| i as u8);
                if map.channel.is_none() {
                    self.skipped.word(option.bytes, self.line.number);
                }
            }
            _ => {
                match option.bytes {
                    b"-blendu" | b"-blendv" | b"-cc" | b"-type" => drop(self.word()),
                    _ => drop(self.values::<3>()),
                }
                self.skipped.word(option.bytes, self.line.number);
            }
        }
    }

    fn word(&mut self) -> &[u8] {
        self.fields.next().map_or(b"", |field| field.bytes)
    }

    /// The first two of up to three numbers.
    fn pair(&mut self, default: f32) -> [f32; 2] {
        let [u, v, _] = self.values::<3>();
        [u.unwrap_or(default), v.unwrap_or(default)]
    }

    /// As many finite numbers as come next, at most `N`.
    fn values<const N: usize>(&mut self) -> [Option<f32>; N] {
        let mut values = [None; N];
        for value in &mut values {
            *value = self.fields.clone().next().and_then(Field::float).filter(|x| x.is_finite());
            if value.is_none() {
                break;
            }
            self.fields.next();
        }
        values
    }
}

fn text(field: Field<'_>) -> String {
    String::from_utf8_lossy(field.bytes).into_owned()
}

#[cfg(test)]
mod tests;
