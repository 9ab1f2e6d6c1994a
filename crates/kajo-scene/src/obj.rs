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
use crate::line_reader::{Field, Fields, Line, LineReader};
use crate::memory_budget::OverBudget;
use crate::mesh_file_error::MeshFileError;
use crate::read_memory::ReadMemory;
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
        if let Some(statement) = Statement::of(line, path) {
            builder.add(statement)?;
        }
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

/// A line, its first word and what comes after that.
#[derive(Clone)]
struct Statement<'b> {
    path: &'b str,
    line: Line<'b>,
    keyword: Field<'b>,
    fields: Fields<'b>,
}

impl<'b> Statement<'b> {
    /// What a line says; `None` where that is nothing.
    fn of(line: Line<'b>, path: &'b str) -> Option<Statement<'b>> {
        let mut fields = line.fields();
        let keyword = fields.next()?;
        Some(Statement { path, line, keyword, fields })
    }

    fn mistake(&self, place: Field<'_>, message: impl Into<String>) -> MeshFileError {
        self.line.mistake(self.path, place, message)
    }

    /// The next `N` numbers; at least `least` must be there, others are zero.
    fn floats<const N: usize>(&mut self, least: usize) -> Result<[f32; N], MeshFileError> {
        let mut out = [0.0; N];
        for (i, out) in out.iter_mut().enumerate() {
            let Some(field) = self.fields.next() else {
                if i >= least {
                    break;
                }
                let key = String::from_utf8_lossy(self.keyword.bytes);
                let plural = if least == 1 { "" } else { "s" };
                let message = format!("expected {least} number{plural} after `{key}`, found {i}");
                return Err(self.mistake(self.fields.end(), message));
            };
            let no_number = || self.mistake(field, format!("expected a number, found {}", field.quoted()));
            *out = field.float().ok_or_else(no_number)?;
        }
        Ok(out)
    }
}

struct Builder<'l> {
    path: &'l str,
    limits: &'l Limits,
    memory: ReadMemory,
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
            memory: ReadMemory::new(&limits.memory),
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

    fn add(&mut self, statement: Statement<'_>) -> Result<(), MeshFileError> {
        match statement.keyword.bytes {
            b"v" => self.vertex(statement),
            b"vt" => self.uv(statement),
            b"vn" => self.normal(statement),
            b"f" | b"fo" => self.face(&statement),
            b"usemtl" => self.use_material(&statement),
            b"mtllib" => {
                self.library(statement.fields);
                Ok(())
            }
            b"o" | b"g" | b"s" => Ok(()),
            word => {
                self.report.skipped.word(word, statement.line.number);
                Ok(())
            }
        }
    }

    fn over(&self) -> impl Fn(OverBudget) -> MeshFileError + use<'l> {
        let path = self.path;
        move |over| MeshFileError::memory(path, over)
    }

    fn vertex(&mut self, mut statement: Statement<'_>) -> Result<(), MeshFileError> {
        let position = statement.floats::<3>(3)?;
        self.not_finite |= !position.iter().all(|x| x.is_finite());
        self.check_room(&statement, List::Vertex, self.mesh.positions.len())?;
        // One more number is a weight, and a fourth of a colour an opacity.
        if statement.fields.clone().nth(2).is_some() {
            let [r, g, b] = self.report.finite_or(statement.floats::<3>(3)?, 1.0);
            let (colors, before) = (&mut self.mesh.colors, self.mesh.positions.len());
            let room = self.memory.room(colors, before + 1 - colors.len());
            room.map_err(|over| MeshFileError::memory(self.path, over))?;
            colors.resize(before, WHITE);
            colors.push([r, g, b, 1.0]);
        }
        let over = self.over();
        self.memory.push(&mut self.mesh.positions, position).map_err(over)
    }

    fn normal(&mut self, mut statement: Statement<'_>) -> Result<(), MeshFileError> {
        let normal = statement.floats::<3>(3)?;
        self.check_room(&statement, List::Normal, self.mesh.normals.len())?;
        let normal = self.report.finite_or_zero(normal);
        let over = self.over();
        self.memory.push(&mut self.mesh.normals, normal).map_err(over)
    }

    fn uv(&mut self, mut statement: Statement<'_>) -> Result<(), MeshFileError> {
        let uv = statement.floats::<2>(1)?;
        self.check_room(&statement, List::Uv, self.mesh.uvs.len())?;
        let uv = self.report.finite_or_zero(uv);
        let over = self.over();
        self.memory.push(&mut self.mesh.uvs, uv).map_err(over)
    }

    fn check_room(&self, statement: &Statement<'_>, list: List, len: usize) -> Result<(), MeshFileError> {
        // Indices are 32 bits, and the last one means "none".
        let most = self.limits.vertices.min(NO_INDEX as usize);
        if len < most {
            return Ok(());
        }
        let message = format!("the mesh has more than {most} of the kind {}", list.name());
        Err(statement.mistake(statement.keyword, message))
    }

    fn face(&mut self, statement: &Statement<'_>) -> Result<(), MeshFileError> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for field in statement.fields.clone() {
            if corners.len() == self.limits.polygon_corners {
                let message = format!("the polygon has more than {} corners", self.limits.polygon_corners);
                return Err(statement.mistake(field, message));
            }
            corners.push(self.corner(statement, field)?);
        }
        if corners.len() < 3 {
            self.report.degenerate += 1;
            self.corners = corners;
            return Ok(());
        }
        if self.mesh.faces.len() + corners.len() - 2 > self.limits.faces {
            let message = format!("the mesh has more than {} triangles", self.limits.faces);
            return Err(statement.mistake(statement.keyword, message));
        }
        let over = self.over();
        self.face_room(&corners).map_err(over)?;
        self.add_face(&corners);
        self.corners = corners;
        Ok(())
    }

    /// Makes room for the triangles of a face in all the lists that get any.
    fn face_room(&mut self, corners: &[Corner]) -> Result<(), OverBudget> {
        let Self { mesh, memory, unsplit, .. } = self;
        let (before, more) = (mesh.faces.len(), corners.len() - 2);
        memory.room(&mut mesh.faces, more)?;
        for (list, kind) in [(&mut mesh.face_uvs, List::Uv), (&mut mesh.face_normals, List::Normal)] {
            let given = corners.iter().any(|corner| corner[kind as usize] != NO_INDEX);
            if *list == Corners::Absent && given {
                let mut own = Vec::new();
                memory.room(&mut own, before + more)?;
                own.resize(before, [NO_INDEX; 3]);
                *list = Corners::Own(own);
            }
            if let Corners::Own(own) = list {
                memory.room(own, more)?;
            }
        }
        if let Some(materials) = &mut mesh.face_materials {
            memory.room(materials, more)?;
        }
        if corners.len() > 3 {
            memory.room(&mut mesh.polygons, 1)?;
        }
        if corners.len() > 3 && corners.iter().any(|corner| corner[0] as usize >= mesh.positions.len()) {
            memory.room(unsplit, 1)?;
            memory.take(size_of_val(corners))?;
        }
        Ok(())
    }

    fn add_face(&mut self, corners: &[Corner]) {
        if let [a, b, c] = *corners {
            self.push_triangle([a, b, c]);
            return;
        }
        self.report.polygons += 1;
        self.mesh.polygons.push([self.mesh.faces.len() as u32, corners.len() as u32 - 2]);
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
        mesh.faces.push(corners.map(|corner| corner[0]));
        for (list, kind) in [(&mut mesh.face_uvs, List::Uv), (&mut mesh.face_normals, List::Normal)] {
            if let Corners::Own(own) = list {
                own.push(corners.map(|corner| corner[kind as usize]));
            }
        }
        if let Some(materials) = &mut mesh.face_materials {
            materials.push(*material);
        }
    }

    /// `a`, `a/t`, `a//n` or `a/t/n`.
    fn corner(&mut self, statement: &Statement<'_>, field: Field<'_>) -> Result<Corner, MeshFileError> {
        let mut corner = [NO_INDEX; 3];
        let mut start = 0;
        for (i, part) in field.bytes.split(|&b| b == b'/').enumerate() {
            let place = Field { bytes: part, start: field.start + start };
            start += part.len() + 1;
            match (List::ALL.get(i), part) {
                (Some(List::Uv | List::Normal), b"") => {}
                (Some(&list), _) => corner[i] = self.index(statement, place, list)?,
                (None, _) => {
                    let message =
                        format!("expected a corner such as 1, 1/2, 1//3 or 1/2/3, found {}", field.quoted());
                    return Err(statement.mistake(field, message));
                }
            }
        }
        Ok(corner)
    }

    /// An index as written to one counted from zero.
    #[inline]
    fn index(
        &mut self,
        statement: &Statement<'_>,
        field: Field<'_>,
        list: List,
    ) -> Result<u32, MeshFileError> {
        let len = match list {
            List::Vertex => self.mesh.positions.len(),
            List::Uv => self.mesh.uvs.len(),
            List::Normal => self.mesh.normals.len(),
        };
        match integer(field.bytes) {
            Some(index) if index > 0 && index <= len as i64 => Ok((index - 1) as u32),
            Some(index) if index < 0 && -index <= len as i64 => Ok((len as i64 + index) as u32),
            Some(index) if index > 0 && index < i64::from(NO_INDEX) => {
                Ok(self.refer_forward(statement.line, field, list, (index - 1) as u32))
            }
            other => Err(statement.mistake(field, bad_index(field, list, other, len))),
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

    fn use_material(&mut self, statement: &Statement<'_>) -> Result<(), MeshFileError> {
        let name = statement.fields.rest();
        let id = self.mesh.material_names.len() as u32;
        let text = String::from_utf8_lossy(name.bytes).into_owned();
        self.material = match self.material_ids.get(&text) {
            Some(&known) => known,
            None if id as usize >= self.limits.materials => {
                let message = format!("the mesh has more than {} materials", self.limits.materials);
                return Err(statement.mistake(name, message));
            }
            None => {
                // The name twice, and an entry of the table.
                let bytes = 2 * text.len() + 128;
                self.memory.take(bytes).map_err(|over| MeshFileError::memory(self.path, over))?;
                self.mesh.material_names.push(text.clone());
                self.material_ids.insert(text, id);
                id
            }
        };
        if self.mesh.face_materials.is_none() {
            let (mut materials, before) = (Vec::new(), self.mesh.faces.len());
            let room = self.memory.room(&mut materials, before);
            room.map_err(|over| MeshFileError::memory(self.path, over))?;
            materials.resize(before, NO_INDEX);
            self.mesh.face_materials = Some(materials);
        }
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
        let over = self.over();
        self.settle_colors().map_err(over)?;
        Ok((self.mesh, self.report))
    }

    /// Brings the colours into [0, 1], and gives one to each vertex if there are any.
    fn settle_colors(&mut self) -> Result<(), OverBudget> {
        let TriMesh { colors, positions, .. } = &mut self.mesh;
        if colors.is_empty() {
            return Ok(());
        }
        self.memory.room(colors, positions.len() - colors.len())?;
        let most = if colors.as_flattened().iter().any(|&v| v > 1.0) { 255.0 } else { 1.0 };
        let share = |v: f32| (v / most).clamp(0.0, 1.0);
        colors.iter_mut().for_each(|[r, g, b, _]| (*r, *g, *b) = (share(*r), share(*g), share(*b)));
        colors.resize(positions.len(), WHITE);
        self.mesh.colors_are_srgb = true;
        self.mesh.face_colors = Corners::Vertices;
        Ok(())
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

/// What is said of an index that leads nowhere.
fn bad_index(field: Field<'_>, list: List, index: Option<i64>, len: usize) -> String {
    let name = list.name();
    match index {
        None => format!("expected the number of a {name}, found {}", field.quoted()),
        Some(0) => format!("{name} 0 does not exist: the first one is 1"),
        Some(index) if index < 0 => {
            format!("{name} {index} does not exist: only {len} are defined before this line")
        }
        Some(index) => format!("there is no {name} {index}"),
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
