//! Wavefront OBJ meshes: triangles with optional normals, texture coordinates, colours and materials.
//!
//! ```text
//! v x y z [r g b]   vt u [v [w]]     vn x y z     usemtl NAME     mtllib FILE...
//! f a b c ...       f a/t ...        f a//n ...   f a/t/n ...     1 is the first, -1 the latest
//! ```
//!
//! The reader is our own because mistakes must be told with line and column,
//! because a hostile file must end in an error before it costs memory, and
//! because a mesh of 10^7 triangles should cost no more than its result.
//!
//! A file may be used in spite of small faults: triangles with a vertex that is
//! not finite are left out, statements that describe no triangles are skipped,
//! and [`MeshReport`] tells of both. Names of groups and smoothing groups change nothing.
//!
//! Colours behind the coordinates are values for a screen, as programs write them, from 0 to 1; if any is larger, from
//! 0 to 255. Vertices without one are white.

use crate::limits::Limits;
use crate::line_reader::{Field, Fields, Line, LineReader, MeshFileError};
use crate::tri_mesh::{Corners, MeshReport, NO_INDEX, TriMesh};
use crate::triangulate::triangulate;
use std::collections::HashMap;
use std::io::Read;
use std::ops::Range;

/// Reads an OBJ file; `path` is its name in messages.
///
/// ```
/// let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 -1\n";
/// let (mesh, report) = kajo_scene::read_obj(text.as_bytes(), "quad.obj", &Default::default()).unwrap();
/// assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(report.polygons, 1);
/// ```
///
/// # Errors
/// At the first statement that is malformed, names a vertex that does not
/// exist, or exceeds a limit; or when reading fails.
pub fn read_obj(
    reader: impl Read,
    path: &str,
    limits: &Limits,
) -> Result<(TriMesh, MeshReport), MeshFileError> {
    let mut lines = LineReader::new(reader, path, limits);
    let mut builder = Builder::new(path, limits);
    while let Some(line) = lines.next_line()? {
        builder.statement(line)?;
    }
    builder.finish()
}

/// The three index lists of OBJ.
#[derive(Clone, Copy)]
enum List {
    Vertex,
    Uv,
    Normal,
}

impl List {
    const ALL: [List; 3] = [List::Vertex, List::Uv, List::Normal];

    fn name(self) -> &'static str {
        match self {
            List::Vertex => "vertex",
            List::Uv => "texture coordinate",
            List::Normal => "normal",
        }
    }
}

/// The colour of a vertex that has none.
const WHITE: [f32; 4] = [1.0; 4];

/// A corner of a face: its index in each [`List`], or [`NO_INDEX`].
type Corner = [u32; 3];

/// The farthest reference to something not yet defined.
struct Forward {
    index: u32,
    // The line and the place in it, should it never be defined.
    bytes: Vec<u8>,
    number: usize,
    place: Range<usize>,
}

impl Forward {
    fn mistake(&self, path: &str, list: List) -> MeshFileError {
        let line = Line { bytes: &self.bytes, number: self.number };
        let field = Field { bytes: &self.bytes[self.place.clone()], start: self.place.start };
        line.mistake(path, field, format!("there is no {} {}", list.name(), u64::from(self.index) + 1))
    }
}

struct Builder<'l> {
    path: &'l str,
    limits: &'l Limits,
    mesh: TriMesh,
    report: MeshReport,
    material_ids: HashMap<String, u32>,
    material: u32,
    forward: [Option<Forward>; 3],
    /// Polygons whose vertices come later: first triangle and corners.
    unsplit: Vec<(usize, Vec<Corner>)>,
    not_finite: bool,
    // Kept between faces to save allocations.
    corners: Vec<Corner>,
    points: Vec<[f32; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl<'l> Builder<'l> {
    fn new(path: &'l str, limits: &'l Limits) -> Self {
        Self {
            path,
            limits,
            mesh: TriMesh::default(),
            report: MeshReport::default(),
            material_ids: HashMap::new(),
            material: NO_INDEX,
            forward: [None, None, None],
            unsplit: Vec::new(),
            not_finite: false,
            corners: Vec::new(),
            points: Vec::new(),
            triangles: Vec::new(),
        }
    }

    fn statement(&mut self, line: Line<'_>) -> Result<(), MeshFileError> {
        let mut fields = line.fields();
        let Some(keyword) = fields.next() else { return Ok(()) };
        match keyword.bytes {
            b"v" => self.vertex(line, keyword, fields),
            b"vt" => self.uv(line, keyword, fields),
            b"vn" => self.normal(line, keyword, fields),
            b"f" | b"fo" => self.face(line, keyword, fields),
            b"usemtl" => self.use_material(line, &fields),
            b"mtllib" => {
                self.library(fields);
                Ok(())
            }
            b"o" | b"g" | b"s" => Ok(()),
            word => {
                self.report.skipped.word(word, line.number);
                Ok(())
            }
        }
    }

    fn vertex(
        &mut self,
        line: Line<'_>,
        keyword: Field<'_>,
        mut fields: Fields<'_>,
    ) -> Result<(), MeshFileError> {
        let position = self.floats::<3>(line, keyword, &mut fields, 3)?;
        self.not_finite |= !position.iter().all(|x| x.is_finite());
        self.check_room(line, keyword, List::Vertex, self.mesh.positions.len())?;
        // One more number is a weight, and a fourth of a colour an opacity.
        if fields.clone().nth(2).is_some() {
            let color = self.floats::<3>(line, keyword, &mut fields, 3)?;
            let [r, g, b] = self.report.finite_or_zero(color);
            self.mesh.colors.resize(self.mesh.positions.len(), WHITE);
            self.mesh.colors.push([r, g, b, 1.0]);
        }
        self.mesh.positions.push(position);
        Ok(())
    }

    fn normal(
        &mut self,
        line: Line<'_>,
        keyword: Field<'_>,
        mut fields: Fields<'_>,
    ) -> Result<(), MeshFileError> {
        let normal = self.floats::<3>(line, keyword, &mut fields, 3)?;
        self.check_room(line, keyword, List::Normal, self.mesh.normals.len())?;
        let normal = self.report.finite_or_zero(normal);
        self.mesh.normals.push(normal);
        Ok(())
    }

    fn uv(
        &mut self,
        line: Line<'_>,
        keyword: Field<'_>,
        mut fields: Fields<'_>,
    ) -> Result<(), MeshFileError> {
        let uv = self.floats::<2>(line, keyword, &mut fields, 1)?;
        self.check_room(line, keyword, List::Uv, self.mesh.uvs.len())?;
        let uv = self.report.finite_or_zero(uv);
        self.mesh.uvs.push(uv);
        Ok(())
    }

    /// The next `N` numbers; at least `least` must be there, others are zero.
    fn floats<const N: usize>(
        &self,
        line: Line<'_>,
        keyword: Field<'_>,
        fields: &mut Fields<'_>,
        least: usize,
    ) -> Result<[f32; N], MeshFileError> {
        let mut out = [0.0; N];
        for (i, out) in out.iter_mut().enumerate() {
            let Some(field) = fields.next() else {
                if i >= least {
                    break;
                }
                let key = String::from_utf8_lossy(keyword.bytes);
                let plural = if least == 1 { "" } else { "s" };
                let message = format!("expected {least} number{plural} after `{key}`, found {i}");
                return Err(line.mistake(self.path, fields.end(), message));
            };
            *out = field.float().ok_or_else(|| {
                line.mistake(self.path, field, format!("expected a number, found {}", field.quoted()))
            })?;
        }
        Ok(out)
    }

    fn check_room(
        &self,
        line: Line<'_>,
        keyword: Field<'_>,
        list: List,
        len: usize,
    ) -> Result<(), MeshFileError> {
        // Indices are 32 bits, and the last one means "none".
        let most = self.limits.vertices.min(NO_INDEX as usize);
        if len < most {
            return Ok(());
        }
        let message = format!("the mesh has more than {most} of the kind {}", list.name());
        Err(line.mistake(self.path, keyword, message))
    }

    fn face(&mut self, line: Line<'_>, keyword: Field<'_>, fields: Fields<'_>) -> Result<(), MeshFileError> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for field in fields.clone() {
            if corners.len() == self.limits.polygon_corners {
                let message = format!("the polygon has more than {} corners", self.limits.polygon_corners);
                return Err(line.mistake(self.path, field, message));
            }
            corners.push(self.corner(line, field)?);
        }
        if corners.len() < 3 {
            let message = format!("a face needs at least 3 corners, found {}", corners.len());
            return Err(line.mistake(self.path, keyword, message));
        }
        if self.mesh.faces.len() + corners.len() - 2 > self.limits.faces {
            let message = format!("the mesh has more than {} triangles", self.limits.faces);
            return Err(line.mistake(self.path, keyword, message));
        }
        self.add_face(&corners);
        self.corners = corners;
        Ok(())
    }

    fn add_face(&mut self, corners: &[Corner]) {
        if let [a, b, c] = *corners {
            self.push_triangle([a, b, c]);
            return;
        }
        self.report.polygons += 1;
        let vertex_count = self.mesh.positions.len();
        if corners.iter().any(|corner| corner[0] as usize >= vertex_count) {
            // The places are not known yet: a fan for now.
            self.unsplit.push((self.mesh.faces.len(), corners.to_vec()));
            for i in 1..corners.len() - 1 {
                self.push_triangle([corners[0], corners[i], corners[i + 1]]);
            }
            return;
        }
        let mut triangles = std::mem::take(&mut self.triangles);
        self.split(corners, &mut triangles);
        for triangle in &triangles {
            self.push_triangle(triangle.map(|i| corners[i]));
        }
        self.triangles = triangles;
    }

    fn split(&mut self, corners: &[Corner], triangles: &mut Vec<[usize; 3]>) {
        self.points.clear();
        self.points.extend(corners.iter().map(|corner| self.mesh.positions[corner[0] as usize]));
        triangulate(&self.points, triangles);
    }

    fn push_triangle(&mut self, corners: [Corner; 3]) {
        let Self { mesh, material, .. } = self;
        let before = mesh.faces.len();
        mesh.faces.push(corners.map(|corner| corner[0]));
        push_attribute(&mut mesh.face_uvs, before, corners.map(|corner| corner[1]));
        push_attribute(&mut mesh.face_normals, before, corners.map(|corner| corner[2]));
        if let Some(materials) = &mut mesh.face_materials {
            materials.push(*material);
        }
    }

    /// `a`, `a/t`, `a//n` or `a/t/n`.
    fn corner(&mut self, line: Line<'_>, field: Field<'_>) -> Result<Corner, MeshFileError> {
        let mut corner = [NO_INDEX; 3];
        let mut start = 0;
        for (i, part) in field.bytes.split(|&b| b == b'/').enumerate() {
            let place = Field { bytes: part, start: field.start + start };
            start += part.len() + 1;
            match (List::ALL.get(i), part) {
                (Some(List::Uv | List::Normal), b"") => {}
                (Some(&list), _) => corner[i] = self.index(line, place, list)?,
                (None, _) => {
                    let message =
                        format!("expected a corner such as 1, 1/2, 1//3 or 1/2/3, found {}", field.quoted());
                    return Err(line.mistake(self.path, field, message));
                }
            }
        }
        Ok(corner)
    }

    /// An index as written to one counted from zero.
    #[inline]
    fn index(&mut self, line: Line<'_>, field: Field<'_>, list: List) -> Result<u32, MeshFileError> {
        let len = match list {
            List::Vertex => self.mesh.positions.len(),
            List::Uv => self.mesh.uvs.len(),
            List::Normal => self.mesh.normals.len(),
        };
        match integer(field.bytes) {
            Some(index) if index > 0 && index <= len as i64 => Ok((index - 1) as u32),
            Some(index) if index < 0 && -index <= len as i64 => Ok((len as i64 + index) as u32),
            Some(index) if index > 0 && index < i64::from(NO_INDEX) => {
                Ok(self.refer_forward(line, field, list, (index - 1) as u32))
            }
            other => Err(self.bad_index(line, field, list, other, len)),
        }
    }

    /// Remembers that `index` must be defined by the end of the file.
    fn refer_forward(&mut self, line: Line<'_>, field: Field<'_>, list: List, index: u32) -> u32 {
        let slot = &mut self.forward[list as usize];
        if slot.as_ref().is_none_or(|forward| forward.index < index) {
            let last = slot.take();
            let is_same_line = last.as_ref().is_some_and(|forward| forward.number == line.number);
            let mut bytes = last.map(|forward| forward.bytes).unwrap_or_default();
            // A long line may name ever larger numbers; it is copied once.
            if !is_same_line {
                bytes.clear();
                bytes.extend_from_slice(line.bytes);
            }
            let place = field.start..field.start + field.bytes.len();
            *slot = Some(Forward { index, bytes, number: line.number, place });
        }
        index
    }

    fn bad_index(
        &self,
        line: Line<'_>,
        field: Field<'_>,
        list: List,
        index: Option<i64>,
        len: usize,
    ) -> MeshFileError {
        let name = list.name();
        let message = match index {
            None => format!("expected the number of a {name}, found {}", field.quoted()),
            Some(0) => format!("{name} 0 does not exist: the first one is 1"),
            Some(index) if index < 0 => {
                format!("{name} {index} does not exist: only {len} are defined before this line")
            }
            Some(index) => format!("there is no {name} {index}"),
        };
        line.mistake(self.path, field, message)
    }

    fn use_material(&mut self, line: Line<'_>, fields: &Fields<'_>) -> Result<(), MeshFileError> {
        let name = fields.rest();
        let id = self.mesh.material_names.len() as u32;
        let text = String::from_utf8_lossy(name.bytes).into_owned();
        self.material = match self.material_ids.get(&text) {
            Some(&known) => known,
            None if id as usize >= self.limits.materials => {
                let message = format!("the mesh has more than {} materials", self.limits.materials);
                return Err(line.mistake(self.path, name, message));
            }
            None => {
                self.mesh.material_names.push(text.clone());
                self.material_ids.insert(text, id);
                id
            }
        };
        let before = self.mesh.faces.len();
        self.mesh.face_materials.get_or_insert_with(|| vec![NO_INDEX; before]);
        Ok(())
    }

    /// One name that may hold blanks, or several that all end in `.mtl`.
    fn library(&mut self, fields: Fields<'_>) {
        let is_name = |field: Field<'_>| field.bytes.to_ascii_lowercase().ends_with(b".mtl");
        let names: Vec<Field<'_>> =
            if fields.clone().all(is_name) { fields.collect() } else { vec![fields.rest()] };
        for name in names {
            let name = String::from_utf8_lossy(name.bytes).into_owned();
            let room = self.mesh.libraries.len() < self.limits.includes;
            if room && !name.is_empty() && !self.mesh.libraries.contains(&name) {
                self.mesh.libraries.push(name);
            }
        }
    }

    fn finish(mut self) -> Result<(TriMesh, MeshReport), MeshFileError> {
        let lens = [self.mesh.positions.len(), self.mesh.uvs.len(), self.mesh.normals.len()];
        for ((forward, len), list) in self.forward.iter().zip(lens).zip(List::ALL) {
            if let Some(forward) = forward.as_ref().filter(|forward| forward.index as usize >= len) {
                return Err(forward.mistake(self.path, list));
            }
        }
        for (first, corners) in std::mem::take(&mut self.unsplit) {
            self.split_late(first, &corners);
        }
        if self.not_finite {
            self.report.dropped = self.mesh.drop_not_finite();
        }
        self.settle_colors();
        Ok((self.mesh, self.report))
    }

    /// Brings the colours into [0, 1], and gives one to each vertex if there are any.
    fn settle_colors(&mut self) {
        let TriMesh { colors, positions, .. } = &mut self.mesh;
        if colors.is_empty() {
            return;
        }
        let most = if colors.as_flattened().iter().any(|&v| v > 1.0) { 255.0 } else { 1.0 };
        let share = |v: f32| (v / most).clamp(0.0, 1.0);
        colors.iter_mut().for_each(|[r, g, b, _]| (*r, *g, *b) = (share(*r), share(*g), share(*b)));
        colors.resize(positions.len(), WHITE);
        self.mesh.colors_are_srgb = true;
        self.mesh.face_colors = Corners::Vertices;
    }

    /// Replaces the fan that stood in for a polygon.
    fn split_late(&mut self, first: usize, corners: &[Corner]) {
        let mut triangles = std::mem::take(&mut self.triangles);
        self.split(corners, &mut triangles);
        for (face, triangle) in (first..).zip(&triangles) {
            let of = |list: List| triangle.map(|i| corners[i][list as usize]);
            self.mesh.faces[face] = of(List::Vertex);
            if let Corners::Own(uvs) = &mut self.mesh.face_uvs {
                uvs[face] = of(List::Uv);
            }
            if let Corners::Own(normals) = &mut self.mesh.face_normals {
                normals[face] = of(List::Normal);
            }
        }
        self.triangles = triangles;
    }
}

/// Adds the indices of a face; the list begins to exist with the first that has any.
fn push_attribute(corners: &mut Corners, faces_before: usize, indices: [u32; 3]) {
    if *corners == Corners::Absent && indices != [NO_INDEX; 3] {
        *corners = Corners::Own(vec![[NO_INDEX; 3]; faces_before]);
    }
    if let Corners::Own(list) = corners {
        list.push(indices);
    }
}

/// A whole number with an optional sign; `None` also when it is absurdly long.
#[inline]
fn integer(bytes: &[u8]) -> Option<i64> {
    let (negative, digits) = match bytes {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, bytes),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests;
