//! PLY meshes, the format of scanned models: in text, or binary of either byte order.
//!
//! ```text
//! ply
//! format binary_little_endian 1.0
//! element vertex 8
//! property float x
//! property float y
//! property float z
//! element face 6
//! property list uchar int vertex_indices
//! end_header
//! ...
//! ```
//!
//! The header says which elements come, how many of each and what their
//! properties are [Turk 1994]. Read are the positions, normals, texture
//! coordinates and colours of vertices, and faces and triangle strips, whatever the types
//! and the order of their properties and their own; everything else is stepped over. Faces may have colours
//! where vertices have none.
//!
//! Colours of whole numbers are values for a screen, floats are amounts; opacities are amounts.
//!
//! Counts of the header are never believed: memory grows with what is read.
//! The layouts that programs write most, float vertices without lists and
//! faces with nothing but their list, take a short way ([`fast`]) that is
//! quicker than a disk.

mod fast;
mod header;
mod record;

use self::header::{ColorColumns, Column, Element, Format, Header};
use self::record::{Record, Records, Wanted};
use crate::limits::Limits;
use crate::line_reader::LineReader;
use crate::memory_budget::OverBudget;
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
use crate::tri_mesh::{Corners, MeshReport, NO_INDEX, TriMesh};
use crate::triangulate::triangulate;
use std::io::Read;

/// Reads a PLY file; `path` is its name in messages.
///
/// ```
/// let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
///     element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
/// let (mesh, _) = kajo_scene::read_ply(text.as_bytes(), "a.ply", &Default::default()).unwrap();
/// assert_eq!(mesh.faces, [[0, 1, 2]]);
/// ```
///
/// # Errors
/// At the first thing that is malformed, cut off, names a vertex that does
/// not exist, or exceeds a limit; or when reading fails.
pub fn read_ply(
    reader: impl Read,
    path: &str,
    limits: &Limits,
) -> Result<(TriMesh, MeshReport), MeshFileError> {
    let mut lines = LineReader::new(reader, path, limits).without_continuations();
    let header = Header::read(&mut lines, path, limits)?;
    let mut records = match header.format {
        Format::Ascii => Records::Lines(lines, path),
        Format::LittleEndian => Records::Little(lines.into_bytes()),
        Format::BigEndian => Records::Big(lines.into_bytes()),
    };
    let mut builder = Builder::new(path, limits, &header);
    for element in &header.elements {
        builder.element(element, &mut records)?;
    }
    builder.finish(&header)
}

struct Builder<'l> {
    path: &'l str,
    limits: &'l Limits,
    memory: ReadMemory,
    /// As many as the header says; a file that has fewer is in error.
    vertex_count: usize,
    vertices_have_colors: bool,
    /// Polygons that came before the vertices: first triangle and corners.
    unsplit: Vec<(usize, Vec<u32>)>,
    mesh: TriMesh,
    report: MeshReport,
    not_finite: bool,
    // Kept between faces to save allocations.
    corners: Vec<u32>,
    points: Vec<[f32; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl<'l> Builder<'l> {
    fn new(path: &'l str, limits: &'l Limits, header: &Header) -> Self {
        Self {
            path,
            limits,
            memory: ReadMemory::new(&limits.memory),
            vertex_count: header.vertex_count(),
            vertices_have_colors: header.has_colors("vertex"),
            unsplit: Vec::new(),
            mesh: TriMesh::default(),
            report: MeshReport::default(),
            not_finite: false,
            corners: Vec::new(),
            points: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn element(
        &mut self,
        element: &Element,
        records: &mut Records<'_, impl Read>,
    ) -> Result<(), MeshFileError> {
        match element.name.as_str() {
            "vertex" => self.vertices(element, records)?,
            "face" => self.faces(element, records)?,
            "tristrips" => self.strips(element, records)?,
            _ if element.properties.is_empty() => {}
            _ => {
                for number in 0..element.count {
                    records.skip(element, number)?;
                }
            }
        }
        // What was reserved beyond need while the lists grew.
        self.mesh.positions.shrink_to_fit();
        self.mesh.normals.shrink_to_fit();
        self.mesh.uvs.shrink_to_fit();
        self.mesh.colors.shrink_to_fit();
        self.mesh.faces.shrink_to_fit();
        Ok(())
    }

    fn vertices(
        &mut self,
        element: &Element,
        records: &mut Records<'_, impl Read>,
    ) -> Result<(), MeshFileError> {
        let columns = VertexColumns::of(element);
        let path = self.path;
        let over = |over| MeshFileError::memory(path, over);
        if !fast::vertices(element, &columns, records, &mut self.mesh, &mut self.memory)? {
            let mut record = Record::default();
            for number in 0..element.count {
                records.read(element, number, Wanted::Scalars, &mut record)?;
                let float = |column: Column| record.scalars[column.property] as f32;
                columns.room(1, &mut self.mesh, &mut self.memory).map_err(over)?;
                self.mesh.positions.push(columns.position.map(float));
                self.mesh.normals.extend(columns.normal.map(|c| c.map(float)));
                self.mesh.uvs.extend(columns.uv.map(|c| c.map(float)));
                self.mesh.colors.extend(columns.color.map(|c| c.color(&record.scalars)));
            }
        }
        if columns.normal.is_some() {
            self.mesh.face_normals = Corners::Vertices;
        }
        if columns.uv.is_some() {
            self.mesh.face_uvs = Corners::Vertices;
        }
        if let Some(color) = columns.color {
            self.mesh.face_colors = Corners::Vertices;
            self.mesh.colors_are_srgb = color.is_srgb();
        }
        self.not_finite = self.mesh.positions.iter().any(|p| !p.iter().all(|x| x.is_finite()));
        let Self { mesh, report, .. } = self;
        mesh.normals.iter_mut().for_each(|n| *n = report.finite_or_zero(*n));
        mesh.uvs.iter_mut().for_each(|uv| *uv = report.finite_or_zero(*uv));
        if columns.color.is_some() {
            mesh.colors.iter_mut().for_each(|c| *c = held(*c, report));
            settle_opacities(&mut mesh.colors);
        }
        Ok(())
    }

    fn faces(
        &mut self,
        element: &Element,
        records: &mut Records<'_, impl Read>,
    ) -> Result<(), MeshFileError> {
        let list = element.corner_list;
        let colors = ColorColumns::of(element).filter(|_| !self.vertices_have_colors);
        let mut record = Record::default();
        let most = self.limits.polygon_corners;
        let mut number = 0;
        while number < element.count {
            // Runs of triangles go the short way; what it does not know comes back here.
            let (left, n) = (element.count - number, self.vertex_count);
            if colors.is_none() {
                let sinks = (self.limits, &mut self.memory);
                number += fast::triangles(element, left, records, n, &mut self.mesh, sinks)?;
            }
            if number == element.count {
                break;
            }
            records.read(element, number, Wanted::List { property: list, most }, &mut record)?;
            let mut corners = std::mem::take(&mut self.corners);
            corners.clear();
            for &index in &record.list {
                corners
                    .push(self.vertex_index(index).map_err(|said| records.mistake(element, number, &said))?);
            }
            let before = self.mesh.faces.len();
            self.polygon(&corners, |said| records.mistake(element, number, &said))?;
            self.corners = corners;
            if let Some(columns) = colors
                && self.mesh.faces.len() > before
            {
                self.mesh.colors_are_srgb = columns.is_srgb();
                self.color_faces(before, columns.color(&record.scalars))?;
            }
            number += 1;
        }
        Ok(())
    }

    /// Gives a colour to the triangles from `first` on.
    fn color_faces(&mut self, first: usize, color: [f32; 4]) -> Result<(), MeshFileError> {
        let Self { path, mesh, report, memory, .. } = self;
        let color = held(color, report);
        // Faces one after the other often have the same.
        if mesh.colors.last() != Some(&color) {
            memory.push(&mut mesh.colors, color).map_err(|over| MeshFileError::memory(path, over))?;
        }
        if mesh.face_colors == Corners::Absent {
            mesh.face_colors = Corners::Own(Vec::new());
        }
        if let Corners::Own(own) = &mut mesh.face_colors {
            let room = memory.room(own, mesh.faces.len() - own.len());
            room.map_err(|over| MeshFileError::memory(path, over))?;
            own.resize(first, [NO_INDEX; 3]);
            own.resize(mesh.faces.len(), [mesh.colors.len() as u32 - 1; 3]);
        }
        Ok(())
    }

    /// Strips: each vertex after the first two makes a triangle with the two before it, turned round
    /// every other time; -1 begins another strip.
    fn strips(
        &mut self,
        element: &Element,
        records: &mut Records<'_, impl Read>,
    ) -> Result<(), MeshFileError> {
        let wanted = Wanted::List { property: element.corner_list, most: self.limits.faces };
        let mut record = Record::default();
        for number in 0..element.count {
            records.read(element, number, wanted, &mut record)?;
            let mut strip: [Option<u32>; 2] = [None; 2];
            let mut is_turned = false;
            for &index in &record.list {
                if index == -1.0 {
                    (strip, is_turned) = ([None; 2], false);
                    continue;
                }
                let c = self.vertex_index(index).map_err(|said| records.mistake(element, number, &said))?;
                if let [Some(a), Some(b)] = strip {
                    let triangle = if is_turned { [b, a, c] } else { [a, b, c] };
                    is_turned = !is_turned;
                    self.polygon(&triangle, |said| records.mistake(element, number, &said))?;
                }
                strip = [strip[1], Some(c)];
            }
        }
        Ok(())
    }

    fn vertex_index(&self, index: f64) -> Result<u32, String> {
        let count = self.vertex_count;
        if index >= 0.0 && index < count as f64 && index.fract() == 0.0 {
            return Ok(index as u32);
        }
        Err(format!("there is no vertex {index}: the file has {count}, numbered from 0"))
    }

    /// Adds a face; `mistake` makes an error of what is wrong with it.
    fn polygon(
        &mut self,
        corners: &[u32],
        mistake: impl Fn(String) -> MeshFileError,
    ) -> Result<(), MeshFileError> {
        let Some(more) = corners.len().checked_sub(2).filter(|&more| more > 0) else {
            self.report.degenerate += 1;
            return Ok(());
        };
        if self.mesh.faces.len() + more > self.limits.faces {
            return Err(mistake(format!("the mesh has more than {} triangles", self.limits.faces)));
        }
        let over = |over| MeshFileError::memory(self.path, over);
        self.memory.room(&mut self.mesh.faces, more).map_err(over)?;
        if let [a, b, c] = *corners {
            self.mesh.faces.push([a, b, c]);
            return Ok(());
        }
        self.report.polygons += 1;
        let polygon = [self.mesh.faces.len() as u32, more as u32];
        self.memory.push(&mut self.mesh.polygons, polygon).map_err(over)?;
        if self.mesh.positions.len() < self.vertex_count {
            // The places are not known yet: a fan for now.
            self.memory.room(&mut self.unsplit, 1).map_err(over)?;
            self.memory.take(size_of_val(corners)).map_err(over)?;
            self.unsplit.push((self.mesh.faces.len(), corners.to_vec()));
            self.mesh.faces.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
            return Ok(());
        }
        self.split(corners);
        self.mesh.faces.extend(self.triangles.iter().map(|t| t.map(|i| corners[i])));
        Ok(())
    }

    fn split(&mut self, corners: &[u32]) {
        self.points.clear();
        self.points.extend(corners.iter().map(|&v| self.mesh.positions[v as usize]));
        triangulate(&self.points, &mut self.triangles);
    }

    fn finish(mut self, header: &Header) -> Result<(TriMesh, MeshReport), MeshFileError> {
        for (first, corners) in std::mem::take(&mut self.unsplit) {
            self.split(&corners);
            for (face, triangle) in self.mesh.faces[first..].iter_mut().zip(&self.triangles) {
                *face = triangle.map(|i| corners[i]);
            }
        }
        if let Corners::Own(own) = &mut self.mesh.face_colors {
            let more = self.mesh.faces.len() - own.len();
            self.memory.room(own, more).map_err(|over| MeshFileError::memory(self.path, over))?;
            own.resize(self.mesh.faces.len(), [NO_INDEX; 3]);
        }
        if self.not_finite {
            self.report.dropped = self.mesh.drop_not_finite();
        }
        self.report.left_out = header.left_out();
        debug_assert!(self.mesh.positions.len() < NO_INDEX as usize);
        Ok((self.mesh, self.report))
    }
}

/// A colour within [0, 1], white where the file's is not finite.
fn held(color: [f32; 4], report: &mut MeshReport) -> [f32; 4] {
    report.finite_or(color, 1.0).map(|v| v.clamp(0.0, 1.0))
}

/// Makes sense of opacities: all zeros stand for a vertex without a colour, as Blender writes them for objects without
/// colours beside others; and where no opacity is more than zero, nobody wrote any. Where vertices are half there, those that
/// are not there at all are meant.
fn settle_opacities(colors: &mut [[f32; 4]]) {
    let is_unwritten = colors.iter().all(|color| color[3] == 0.0);
    let fades = colors.iter().any(|color| color[3] > 0.0 && color[3] < 1.0);
    for color in colors {
        if *color == [0.0; 4] && !fades {
            *color = [1.0; 4];
        } else if is_unwritten {
            color[3] = 1.0;
        }
    }
}

/// Where a vertex has what is read of it.
struct VertexColumns {
    position: [Column; 3],
    normal: Option<[Column; 3]>,
    uv: Option<[Column; 2]>,
    color: Option<ColorColumns>,
}

impl VertexColumns {
    fn of(element: &Element) -> VertexColumns {
        let uv_names = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];
        VertexColumns {
            position: element.position,
            normal: element.columns(["nx", "ny", "nz"]),
            uv: uv_names.into_iter().find_map(|names| element.columns(names)),
            color: ColorColumns::of(element),
        }
    }

    /// Makes room for `more` vertices.
    fn room(&self, more: usize, mesh: &mut TriMesh, memory: &mut ReadMemory) -> Result<(), OverBudget> {
        memory.room(&mut mesh.positions, more)?;
        if self.normal.is_some() {
            memory.room(&mut mesh.normals, more)?;
        }
        if self.uv.is_some() {
            memory.room(&mut mesh.uvs, more)?;
        }
        if self.color.is_some() { memory.room(&mut mesh.colors, more) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests;
