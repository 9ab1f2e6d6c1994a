//! STL meshes, the format of 3D printing: in text or binary.
//!
//! ```text
//! solid NAME                              80 bytes, anything
//!   facet normal nx ny nz                 u32 number of triangles
//!     outer loop                          for each triangle:
//!       vertex x y z   (three times)          f32 x 12: normal, three vertices
//!     endloop                                 u16, which nobody agrees about
//!   endfacet
//! endsolid NAME
//! ```
//!
//! Both may begin with `solid`: many programs write it into the 80 bytes too.
//! A binary file has a zero byte there or in its count, and text has none.
//!
//! The format repeats each vertex in every triangle; those at the same place
//! become one again. The normals are left aside: the order of the corners says
//! which side is out, and the normals that programs write are often wrong.

use crate::byte_reader::ByteReader;
use crate::limits::Limits;
use crate::line_reader::{Fields, Line, LineReader};
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
use crate::text_encoding::is_utf16;
use crate::tri_mesh::{MeshReport, NO_INDEX, TriMesh};
use crate::triangulate::triangulate;
use crate::weld::Weld;
use std::io::Read;

/// Bytes before the first triangle of a binary file.
const HEADER: usize = 84;
/// Bytes of a triangle in a binary file.
const RECORD: usize = 50;

/// Reads an STL file; `path` is its name in messages.
///
/// ```
/// let text = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
///     endfacet\nendsolid s\n";
/// let (mesh, _) = kajo_scene::read_stl(text.as_bytes(), "a.stl", &Default::default()).unwrap();
/// assert_eq!(mesh.faces, [[0, 1, 2]]);
/// ```
///
/// # Errors
/// At the first thing that is malformed, cut off, or exceeds a limit; or when
/// reading fails.
pub fn read_stl(
    reader: impl Read,
    path: &str,
    limits: &Limits,
) -> Result<(TriMesh, MeshReport), MeshFileError> {
    let mut lines = LineReader::new(reader, path, limits).without_continuations();
    let mut builder = Builder::new(path, limits);
    if is_text(lines.at_least(HEADER)?) {
        builder.text(&mut lines, path)?;
    } else {
        builder.binary(&mut lines.into_bytes())?;
    }
    builder.finish()
}

/// Whether a file that begins so is the kind in text. One in UTF-16 is too, and then refused as such.
fn is_text(head: &[u8]) -> bool {
    let head = &head[..head.len().min(HEADER)];
    if is_utf16(head) {
        let letters: Vec<u8> = head.iter().copied().filter(u8::is_ascii_graphic).take(5).collect();
        return letters.eq_ignore_ascii_case(b"solid");
    }
    let words = head.strip_prefix("\u{feff}".as_bytes()).unwrap_or(head).trim_ascii_start();
    words.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !head.contains(&0)
}

struct Builder<'l> {
    path: &'l str,
    limits: &'l Limits,
    memory: ReadMemory,
    weld: Weld,
    mesh: TriMesh,
    report: MeshReport,
}

impl<'l> Builder<'l> {
    fn new(path: &'l str, limits: &'l Limits) -> Self {
        let (memory, weld) = (ReadMemory::new(&limits.memory), Weld::new());
        Self { path, limits, memory, weld, mesh: TriMesh::default(), report: MeshReport::default() }
    }

    fn binary(&mut self, bytes: &mut ByteReader<'_, impl Read>) -> Result<(), MeshFileError> {
        let Some((_, &[a, b, c, d])) =
            bytes.at_least(HEADER)?.first_chunk::<HEADER>().and_then(|h| h.split_last_chunk())
        else {
            return Err(bytes.mistake("an STL file begins with `solid` or has a header of 84 bytes"));
        };
        let count = u32::from_le_bytes([a, b, c, d]);
        bytes.consume(HEADER);
        for number in 0..count {
            let Some(record) = bytes.at_least(RECORD)?.first_chunk::<RECORD>() else {
                return Err(bytes.mistake(format!("the file ends in triangle {number} of {count}")));
            };
            let floats: [f32; 9] = std::array::from_fn(|i| {
                f32::from_le_bytes(std::array::from_fn(|byte| record[12 + 4 * i + byte]))
            });
            let [ax, ay, az, bx, by, bz, cx, cy, cz] = floats;
            self.polygon(&[[ax, ay, az], [bx, by, bz], [cx, cy, cz]], |said| bytes.mistake(said))?;
            bytes.consume(RECORD);
        }
        if !bytes.at_least(1)?.is_empty() {
            let message =
                format!("there is more in the file after the {count} triangles that its header counts");
            self.report.left_out.push(message);
        }
        Ok(())
    }

    fn text(&mut self, lines: &mut LineReader<'_, impl Read>, path: &str) -> Result<(), MeshFileError> {
        let mut corners: Vec<[f32; 3]> = Vec::new();
        let mut in_solid = false;
        while let Some(line) = lines.next_line()? {
            let mut fields = line.fields();
            let Some(keyword) = fields.next() else { continue };
            match &*keyword.bytes.to_ascii_lowercase() {
                b"solid" => in_solid = true,
                b"endsolid" => in_solid = false,
                b"facet" | b"outer" => corners.clear(),
                b"vertex" if corners.len() == self.limits.polygon_corners => {
                    let message = format!("the facet has more than {} corners", self.limits.polygon_corners);
                    return Err(line.mistake(path, keyword, message));
                }
                b"vertex" => corners.push(vertex(line, path, fields)?),
                b"endloop" => {
                    self.polygon(&corners, |said| line.mistake(path, keyword, said))?;
                    corners.clear();
                }
                b"endfacet" => {}
                _ => {
                    let message = format!(
                        "expected `facet`, `outer loop`, `vertex`, `endloop`, `endfacet` or `endsolid`, found {}",
                        keyword.quoted()
                    );
                    return Err(line.mistake(path, keyword, message));
                }
            }
        }
        match in_solid {
            true => Err(lines.mistake("the file ends before `endsolid`")),
            false => Ok(()),
        }
    }

    /// Adds a facet; `mistake` makes an error of what is wrong with it.
    fn polygon(
        &mut self,
        corners: &[[f32; 3]],
        mistake: impl Fn(String) -> MeshFileError,
    ) -> Result<(), MeshFileError> {
        let Some(more) = corners.len().checked_sub(2).filter(|&more| more > 0) else {
            return Err(mistake(format!("a facet needs at least 3 vertices, found {}", corners.len())));
        };
        if self.mesh.faces.len() + more > self.limits.faces {
            return Err(mistake(format!("the mesh has more than {} triangles", self.limits.faces)));
        }
        let most = self.limits.vertices.min(NO_INDEX as usize);
        if self.weld.positions.len() + corners.len() > most {
            return Err(mistake(format!("the mesh has more than {most} vertices")));
        }
        if !corners.iter().flatten().all(|x| x.is_finite()) {
            self.report.dropped += more;
            return Ok(());
        }
        let over = |over| MeshFileError::memory(self.path, over);
        self.memory.room(&mut self.mesh.faces, more).map_err(over)?;
        self.weld.room(corners.len(), &mut self.memory).map_err(over)?;
        if let [a, b, c] = *corners {
            let face = [a, b, c].map(|p| self.weld.number(p));
            self.mesh.faces.push(face);
            return Ok(());
        }
        self.report.polygons += 1;
        let mut triangles = Vec::new();
        triangulate(corners, &mut triangles);
        for triangle in triangles {
            let face = triangle.map(|i| self.weld.number(corners[i]));
            self.mesh.faces.push(face);
        }
        Ok(())
    }

    fn finish(self) -> Result<(TriMesh, MeshReport), MeshFileError> {
        let mut mesh = self.mesh;
        mesh.positions = self.weld.positions;
        mesh.positions.shrink_to_fit();
        mesh.faces.shrink_to_fit();
        Ok((mesh, self.report))
    }
}

fn vertex(line: Line<'_>, path: &str, mut fields: Fields<'_>) -> Result<[f32; 3], MeshFileError> {
    let mut position = [0.0; 3];
    for (i, x) in position.iter_mut().enumerate() {
        let Some(field) = fields.next() else {
            let message = format!("expected 3 numbers after `vertex`, found {i}");
            return Err(line.mistake(path, fields.end(), message));
        };
        *x = field.float().ok_or_else(|| {
            line.mistake(path, field, format!("expected a number, found {}", field.quoted()))
        })?;
    }
    Ok(position)
}

#[cfg(test)]
mod tests;
