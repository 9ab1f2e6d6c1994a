//! The layouts of binary files that matter: float vertices, and triangles.
//!
//! Both are read in long runs. Whatever is unusual, such as a face of four
//! corners or an index out of range, is left to the careful way.

use super::VertexColumns;
use super::header::{ColorColumns, Column, Element, Kind, Scalar};
use super::record::{Records, cut_off};
use crate::byte_reader::ByteReader;
use crate::limits::Limits;
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
use crate::tri_mesh::TriMesh;
use std::io::Read;

/// Reads all vertices if they are without lists and what is wanted are floats; else none.
pub(super) fn vertices(
    element: &Element,
    columns: &VertexColumns,
    records: &mut Records<'_, impl Read>,
    mesh: &mut TriMesh,
    memory: &mut ReadMemory,
) -> Result<bool, MeshFileError> {
    let Some(layout) = VertexLayout::of(element, columns) else { return Ok(false) };
    match records {
        Records::Lines(..) => return Ok(false),
        Records::Little(bytes) => layout.read(element, bytes, f32::from_le_bytes, (mesh, columns, memory))?,
        Records::Big(bytes) => layout.read(element, bytes, f32::from_be_bytes, (mesh, columns, memory))?,
    }
    Ok(true)
}

/// Where the floats of a vertex begin in its record.
struct VertexLayout {
    stride: usize,
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    uv: Option<[usize; 2]>,
    /// Where the bytes of a colour are, and that of its opacity.
    color: Option<([usize; 3], Option<usize>)>,
}

impl VertexLayout {
    fn of(element: &Element, columns: &VertexColumns) -> Option<VertexLayout> {
        fn float_at(column: Column) -> Option<usize> {
            column.offset.filter(|_| column.scalar == Scalar::F32)
        }
        let byte_at = |column: Column| column.offset.filter(|_| column.scalar == Scalar::U8);
        let color = match columns.color {
            None => None,
            Some(ColorColumns { rgb: [r, g, b], opacity }) => {
                let opacity = match opacity {
                    None => None,
                    Some(column) => Some(byte_at(column)?),
                };
                Some(([byte_at(r)?, byte_at(g)?, byte_at(b)?], opacity))
            }
        };
        fn floats_at<const N: usize>(columns: Option<[Column; N]>) -> Option<Option<[usize; N]>> {
            let Some(columns) = columns else { return Some(None) };
            columns
                .iter()
                .all(|&c| float_at(c).is_some())
                .then(|| Some(columns.map(|c| c.offset.unwrap_or(0))))
        }
        Some(VertexLayout {
            stride: element.stride?,
            position: floats_at(Some(columns.position))??,
            normal: floats_at(columns.normal)?,
            uv: floats_at(columns.uv)?,
            color,
        })
    }

    fn read(
        &self,
        element: &Element,
        bytes: &mut ByteReader<'_, impl Read>,
        float: impl Fn([u8; 4]) -> f32,
        (mesh, columns, memory): (&mut TriMesh, &VertexColumns, &mut ReadMemory),
    ) -> Result<(), MeshFileError> {
        let mut left = element.count;
        while left > 0 {
            let path = bytes.path;
            let unread = bytes.at_least(self.stride)?;
            let records = unread.chunks_exact(self.stride).take(usize::try_from(left).unwrap_or(usize::MAX));
            let n = records.len();
            if n == 0 {
                return Err(bytes.mistake(cut_off(element, element.count - left)));
            }
            columns.room(n, mesh, memory).map_err(|over| MeshFileError::memory(path, over))?;
            mesh.positions.extend(records.clone().map(|record| floats(record, self.position, &float)));
            if let Some(at) = self.normal {
                mesh.normals.extend(records.clone().map(|record| floats(record, at, &float)));
            }
            if let Some(at) = self.uv {
                mesh.uvs.extend(records.clone().map(|record| floats(record, at, &float)));
            }
            if let Some((at, opacity)) = self.color {
                let share = |byte: u8| f32::from(byte) / 255.0;
                let color = |record: &[u8]| {
                    let [r, g, b] = at.map(|i| share(record[i]));
                    [r, g, b, opacity.map_or(1.0, |i| share(record[i]))]
                };
                mesh.colors.extend(records.map(color));
            }
            bytes.consume(n * self.stride);
            left -= n as u64;
        }
        Ok(())
    }
}

#[inline(always)]
fn floats<const N: usize>(record: &[u8], at: [usize; N], float: impl Fn([u8; 4]) -> f32) -> [f32; N] {
    at.map(|start| float(record[start..].first_chunk().copied().unwrap_or_default()))
}

/// Reads the triangles that come next; answers how many faces that were.
///
/// * `left`: faces that are still to come
/// * `vertices`: how many vertices there are
pub(super) fn triangles(
    element: &Element,
    left: u64,
    records: &mut Records<'_, impl Read>,
    vertices: usize,
    mesh: &mut TriMesh,
    (limits, memory): (&Limits, &mut ReadMemory),
) -> Result<u64, MeshFileError> {
    let Some(layout) = FaceLayout::of(element) else { return Ok(0) };
    let most = left.min((limits.faces - mesh.faces.len()) as u64);
    match records {
        Records::Lines(..) => Ok(0),
        Records::Little(bytes) => layout.read(bytes, most, u32::from_le_bytes, vertices, (mesh, memory)),
        Records::Big(bytes) => layout.read(bytes, most, u32::from_be_bytes, vertices, (mesh, memory)),
    }
}

/// A face of three corners: a list of 32-bit integers with a length of one byte, and other numbers
/// around it.
struct FaceLayout {
    /// Bytes before the list.
    before: usize,
    /// Bytes of all.
    size: usize,
}

impl FaceLayout {
    const TRIANGLE: usize = 1 + 3 * 4;

    fn of(element: &Element) -> Option<FaceLayout> {
        let corners = element.corner_list;
        let Kind::List { count: Scalar::I8 | Scalar::U8, item: Scalar::I32 | Scalar::U32 } =
            element.properties[corners].kind
        else {
            return None;
        };
        let (mut before, mut size) = (0, Self::TRIANGLE);
        for (i, property) in element.properties.iter().enumerate().filter(|&(i, _)| i != corners) {
            let Kind::One(scalar) = property.kind else { return None };
            size += scalar.bytes();
            before += if i < corners { scalar.bytes() } else { 0 };
        }
        Some(FaceLayout { before, size })
    }

    fn read(
        &self,
        bytes: &mut ByteReader<'_, impl Read>,
        most: u64,
        index: impl Fn([u8; 4]) -> u32,
        vertices: usize,
        (mesh, memory): (&mut TriMesh, &mut ReadMemory),
    ) -> Result<u64, MeshFileError> {
        let mut done = 0;
        while done < most {
            let path = bytes.path;
            let unread = bytes.at_least(self.size)?;
            let before = mesh.faces.len();
            let records =
                unread.chunks_exact(self.size).take(usize::try_from(most - done).unwrap_or(usize::MAX));
            let triangle = |record: &[u8]| {
                let list = record[self.before..].first_chunk::<{ Self::TRIANGLE }>()?;
                let [3, corners @ ..] = list else { return None };
                let ([a, b, c], _) = corners.as_chunks::<4>() else { return None };
                let face = [*a, *b, *c].map(&index);
                face.iter().all(|&v| (v as usize) < vertices).then_some(face)
            };
            let room = memory.room(&mut mesh.faces, records.len());
            room.map_err(|over| MeshFileError::memory(path, over))?;
            mesh.faces.extend(records.map_while(triangle));
            let run = mesh.faces.len() - before;
            if run == 0 {
                break;
            }
            bytes.consume(run * self.size);
            done += run as u64;
        }
        Ok(done)
    }
}
