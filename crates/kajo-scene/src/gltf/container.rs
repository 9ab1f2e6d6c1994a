//! The bytes of a glTF file: JSON and buffers, in one file or in several.
//!
//! ```text
//! glb:  "glTF" version length  { length "JSON" bytes }  { length "BIN\0" bytes }     u32, lowest byte first
//! ```

use super::json::Document;
use super::material::Material;
use super::{Budget, meshopt};
use crate::assets::{AssetError, AssetFile, Assets, read_limited};
use crate::limits::Limits;
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// A file in memory, and where its parts are.
pub(super) struct Container {
    bytes: Vec<u8>,
    json: Range<usize>,
    /// The buffer that comes in the same file.
    binary: Option<Range<usize>>,
}

/// Reads a whole file; nothing in it is looked at but where the parts of a GLB begin and end.
pub(super) fn read(file: AssetFile, limits: &Limits) -> Result<Container, MeshFileError> {
    let path = file.path.clone();
    let bytes = read_limited(file, limits.model_bytes)
        .map_err(|source| MeshFileError::Read { path: path.clone(), source })?;
    if !bytes.starts_with(b"glTF") {
        return Ok(Container { json: 0..bytes.len(), bytes, binary: None });
    }
    let wrong = |byte: usize, message: &str| MeshFileError::Bytes {
        path: path.clone(),
        byte: byte as u64,
        message: message.to_owned(),
    };
    match word(&bytes, 4) {
        Some(2) => {}
        Some(1) => return Err(wrong(4, &unread_version("1.0"))),
        Some(other) => {
            return Err(wrong(4, &format!("this is a GLB file of version {other}; version 2 is read")));
        }
        None => return Err(wrong(4, "this is no GLB file: it ends after four bytes")),
    }
    let (kind, json) = chunk(&bytes, 12).ok_or_else(|| wrong(12, "the file ends in its first chunk"))?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(wrong(12, "the first chunk is not JSON"));
    }
    let next = json.end;
    let binary = match chunk(&bytes, next) {
        Some((kind, range)) if kind == u32::from_le_bytes(*b"BIN\0") => Some(range),
        Some(_) => None,
        None if next == bytes.len() => None,
        None => return Err(wrong(next, "the file ends in a chunk")),
    };
    Ok(Container { bytes, json, binary })
}

/// The kind of the chunk at `at`, and where its content is, if all of it is there.
fn chunk(bytes: &[u8], at: usize) -> Option<(u32, Range<usize>)> {
    let start = at.checked_add(8)?;
    let end = start.checked_add(word(bytes, at)? as usize)?;
    bytes.get(start..end)?;
    // Chunks are padded to four bytes.
    Some((word(bytes, at + 4)?, start..end))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..).and_then(|rest| rest.first_chunk()).map(|&four| u32::from_le_bytes(four))
}

impl Container {
    /// The JSON, understood.
    ///
    /// * `memory`: what it is going to be in memory is taken from there
    pub fn document(
        &self,
        path: &str,
        limits: &Limits,
        memory: &mut ReadMemory,
    ) -> Result<Document, MeshFileError> {
        let json = &self.bytes[self.json.clone()];
        let json = json.strip_prefix("\u{feff}".as_bytes()).unwrap_or(json);
        let wrong = |error: serde_json::Error| {
            let message = match is_of_version_1(json) {
                true => unread_version("1.0"),
                false => format!("in the JSON: {error}"),
            };
            MeshFileError::Content { path: path.to_owned(), message }
        };
        let materials = count_of_materials(json).map_err(wrong)?;
        if materials > limits.materials {
            let message = format!("the file has more than {} materials", limits.materials);
            return Err(MeshFileError::Content { path: path.to_owned(), message });
        }
        memory.take(parsed_bytes(json, materials)).map_err(|over| MeshFileError::memory(path, over))?;
        serde_json::from_slice(json).map_err(wrong)
    }
}

/// The number of materials in a JSON, an error where it is malformed: then nothing of it is kept in memory.
fn count_of_materials(json: &[u8]) -> serde_json::Result<usize> {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct Materials {
        materials: Vec<IgnoredAny>,
    }
    serde_json::from_slice(json).map(|counted: Materials| counted.materials.len())
}

/// About what the structures of a JSON take in memory, rather more, so that a short file of many empty ones is not read.
fn parsed_bytes(json: &[u8], materials: usize) -> usize {
    /// Of one of any other kind, in a list with as much room again, or in a map of names.
    const OBJECT: usize = 600;
    /// Of a number or text in such a list.
    const ITEM: usize = 2 * size_of::<String>();
    let (mut objects, mut items) = (0, 0);
    for &byte in json {
        objects += usize::from(byte == b'{');
        items += usize::from(byte == b',');
    }
    let materials = materials.saturating_mul(2 * size_of::<Material>());
    let rest = objects.saturating_mul(OBJECT).saturating_add(items.saturating_mul(ITEM));
    materials.saturating_add(rest).saturating_add(json.len())
}

/// Whether things have names instead of numbers, as in the first version of the format.
fn is_of_version_1(json: &[u8]) -> bool {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct Lists {
        meshes: Option<BTreeMap<String, IgnoredAny>>,
        nodes: Option<BTreeMap<String, IgnoredAny>>,
    }
    serde_json::from_slice(json).is_ok_and(|lists: Lists| lists.meshes.is_some() || lists.nodes.is_some())
}

/// What is said of a version of glTF that is not read.
pub(super) fn unread_version(version: &str) -> String {
    match version.split('.').next() {
        Some("") | None => "it does not say which version of glTF it is; version 2 is read".to_owned(),
        Some("1") => format!(
            "this is glTF {version}, an older format of another structure; version 2 is read: \
             `gltf-pipeline -i OLD -o NEW` converts it"
        ),
        Some(_) => format!("this is glTF {version}; version 2 is read"),
    }
}

/// The content of all buffers.
pub(super) struct Buffers<'c> {
    container: &'c Container,
    list: Vec<Source>,
    /// Buffer views that were compressed.
    decoded: HashMap<usize, Vec<u8>>,
    bytes_read: u64,
}

enum Source {
    SameFile(Range<usize>),
    Own(Vec<u8>),
    /// The same file as that of an earlier buffer.
    Shared(usize),
    /// Nothing is left of it but compressed views.
    Absent,
}

impl<'c> Buffers<'c> {
    pub fn load(
        document: &Document,
        container: &'c Container,
        path: &str,
        assets: &dyn Assets,
        limits: &Limits,
        memory: &mut ReadMemory,
    ) -> Result<Buffers<'c>, MeshFileError> {
        let bytes_read = container.bytes.len() as u64;
        let mut buffers = Buffers { container, list: Vec::new(), decoded: HashMap::new(), bytes_read };
        // The first buffer of each file.
        let mut files = HashMap::new();
        for (i, buffer) in document.buffers.iter().enumerate() {
            let wrong = |message: &str| MeshFileError::Content {
                path: path.to_owned(),
                message: format!("buffers[{i}]: {message}"),
            };
            let source = match (&buffer.uri, &container.binary) {
                (None, Some(range)) if i == 0 => Source::SameFile(range.clone()),
                (None, _) if buffer.extensions.meshopt.as_ref().is_some_and(|said| said.fallback) => {
                    buffers.list.push(Source::Absent);
                    continue;
                }
                (None, _) => return Err(wrong("it has no `uri`, and the file holds no buffer")),
                (Some(uri), _) => match uri.strip_prefix("data:") {
                    Some(data) => {
                        memory.take(data.len()).map_err(|over| MeshFileError::memory(path, over))?;
                        Source::Own(
                            decode_data(data).ok_or_else(|| wrong("its `data:` uri is not in base64"))?,
                        )
                    }
                    None => {
                        let file = open_beside(uri, path, assets)?;
                        match files.entry(file.path.clone()) {
                            Entry::Occupied(first) => Source::Shared(*first.get()),
                            Entry::Vacant(place) => {
                                place.insert(i);
                                let left = limits.model_bytes.saturating_sub(buffers.bytes_read);
                                let len = usize::try_from(file.len.unwrap_or(0)).unwrap_or(usize::MAX);
                                memory.take(len).map_err(|over| MeshFileError::memory(uri, over))?;
                                Source::Own(
                                    read_limited(file, left).map_err(|source| unreadable(uri, source))?,
                                )
                            }
                        }
                    }
                },
            };
            if let Source::Own(bytes) = &source {
                buffers.bytes_read = buffers.bytes_read.saturating_add(bytes.len() as u64);
            }
            buffers.list.push(source);
            let found = buffers.get(i).map_or(0, <[u8]>::len);
            if found < buffer.byte_length {
                return Err(wrong(&format!("it should have {} bytes and has {found}", buffer.byte_length)));
            }
        }
        Ok(buffers)
    }

    /// Bytes of a buffer.
    pub fn get(&self, buffer: usize) -> Option<&[u8]> {
        match self.list.get(buffer)? {
            Source::SameFile(range) => self.container.bytes.get(range.clone()),
            Source::Own(bytes) => Some(bytes),
            &Source::Shared(first) => self.get(first),
            Source::Absent => None,
        }
    }

    /// Decodes the views that are compressed.
    pub fn decode(&mut self, document: &Document, budget: &mut Budget) -> Result<(), String> {
        for (i, view) in document.buffer_views.iter().enumerate() {
            let Some(said) = &view.extensions.meshopt else { continue };
            let named = |message: String| format!("bufferViews[{i}]: {message}");
            let end = said.byte_offset.checked_add(said.byte_length);
            let data = end.and_then(|end| self.get(said.buffer)?.get(said.byte_offset..end));
            let data =
                data.ok_or_else(|| named("its compressed data reaches beyond its buffer".to_owned()))?;
            budget.take::<u8>(said.count.saturating_mul(said.byte_stride)).map_err(named)?;
            let decoded = meshopt::decode(said, data).map_err(named)?;
            self.decoded.insert(i, decoded);
        }
        Ok(())
    }

    /// The bytes of a buffer view, and from where to where in them elements step if it says so.
    pub fn view(&self, document: &Document, number: usize) -> Result<(&[u8], Option<usize>), String> {
        let view =
            document.buffer_views.get(number).ok_or_else(|| format!("there is no bufferViews[{number}]"))?;
        if let Some(decoded) = self.decoded.get(&number) {
            return Ok((decoded, view.byte_stride));
        }
        let buffer = self.get(view.buffer).ok_or_else(|| format!("there is no buffers[{}]", view.buffer))?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end));
        let bytes = bytes.ok_or_else(|| format!("bufferViews[{number}] reaches beyond its buffer"))?;
        Ok((bytes, view.byte_stride))
    }

    /// Bytes of all files.
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read
    }
}

fn open_beside(uri: &str, path: &str, assets: &dyn Assets) -> Result<AssetFile, MeshFileError> {
    let name = percent_decoded(uri).ok_or(AssetError::BadName("its name is not UTF-8"));
    name.and_then(|name| assets.open(&name, path)).map_err(|source| unreadable(uri, source))
}

fn unreadable(uri: &str, source: AssetError) -> MeshFileError {
    MeshFileError::Read { path: uri.to_owned(), source }
}

/// `my%20buffer.bin` as "my buffer.bin".
pub(super) fn percent_decoded(uri: &str) -> Option<String> {
    let hex = |digit: u8| (digit as char).to_digit(16);
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        (bytes, rest) = match (first, tail) {
            (b'%', [a, b, tail @ ..]) if hex(*a).is_some() && hex(*b).is_some() => {
                let value = hex(*a)? * 16 + hex(*b)?;
                bytes.push(value as u8);
                (bytes, tail)
            }
            _ => {
                bytes.push(*first);
                (bytes, tail)
            }
        };
    }
    String::from_utf8(bytes).ok()
}

/// The bytes of a uri `data:MEDIA;base64,DIGITS`, without its `data:`.
pub(super) fn decode_data(data: &str) -> Option<Vec<u8>> {
    let (media, digits) = data.split_once(',')?;
    if !media.ends_with(";base64") {
        return None;
    }
    let digits = digits.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for four in digits.chunks(4) {
        let mut bits = 0u32;
        for &digit in four {
            bits = bits << 6 | digit_value(digit)?;
        }
        // Two, three and four digits hold one, two and three bytes.
        let [_, a, b, c] = (bits << (6 * (4 - four.len()))).to_be_bytes();
        match four.len() {
            2 => bytes.push(a),
            3 => bytes.extend([a, b]),
            4 => bytes.extend([a, b, c]),
            _ => return None,
        }
    }
    Some(bytes)
}

fn digit_value(digit: u8) -> Option<u32> {
    Some(u32::from(match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percents_are_decoded() {
        let data = |digits: &str| decode_data(&format!("application/octet-stream;base64,{digits}"));
        for (digits, bytes) in [
            ("", &b""[..]),
            ("Zg==", b"f"),
            ("Zm8=", b"fo"),
            ("Zm9v", b"foo"),
            ("Zm9vYmFy", b"foobar"),
            ("+/8", b"\xfb\xff"),
        ] {
            assert_eq!(data(digits).as_deref(), Some(bytes), "{digits}");
        }
        assert_eq!(data("Z"), None);
        assert_eq!(data("Z g="), None);
        assert_eq!(decode_data("text/plain,hello"), None);
        assert_eq!(percent_decoded("a%20b%2Fc%4").as_deref(), Some("a b/c%4"));
        assert_eq!(percent_decoded("%ff"), None);
    }
}
