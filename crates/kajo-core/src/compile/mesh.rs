//! `TriangleMesh` blocks and the files they name.
//!
//! A file is read and its tree built once, however many objects show it.

use std::collections::HashMap;

use kajo_color::srgb;
use kajo_math::{Vec2, Vec3, Vec4};
use kajo_scene::{
    AssetFile, Corners, Diagnostic, Item, LoadStep, MemoryShare, Reopen, Span, TriMesh, read_mesh,
};

use super::Compiler;
use super::mesh_store::{Kept, Shading, StoreKey};
use super::picture_files::{PictureReader, Problem};
use super::subdivision::{Displacement, ReadFaces, Subdivision};
use crate::ids::MaterialSlot;
use crate::shape::{CornerValues, Mesh, MeshData, Neighbours, ShapeId, VertexAttributes, vertex_normals};
use crate::texture::{Encoding, PictureMap};

/// Meshes read so far.
pub(super) type MeshCache = HashMap<MeshKey, Option<ShapeId>>;

/// A mesh as a block asks for it.
pub(super) struct MeshRequest {
    /// The name of its file.
    pub name: String,
    /// Where that is named.
    pub span: Span,
    pub shading: Shading,
    /// Whether it is in the materials of its own file.
    pub own_materials: bool,
    /// Whether its colours tint it.
    pub colors: bool,
    /// Whether and how it is subdivided.
    pub subdivision: Option<Subdivision>,
    /// How far the subdivided surface is moved outwards.
    pub displacement: Option<Displacement>,
}

/// What makes two meshes the same.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct MeshKey {
    path: String,
    shading: Shading,
    own_materials: bool,
    colors: bool,
    subdivision: Option<Subdivision>,
}

impl Compiler<'_> {
    pub(super) fn mesh(&mut self, item: Item<'_>, request: MeshRequest) -> Option<ShapeId> {
        let MeshRequest { name, span, shading, own_materials, colors, subdivision, displacement } = request;
        let file = match self.assets.open(&name, item.path()) {
            Ok(file) => file,
            Err(error) => {
                self.cannot_read(&name, &error.to_string(), span);
                return None;
            }
        };
        let key = MeshKey { path: file.path.clone(), shading, own_materials, colors, subdivision };
        let known = self.meshes.get(&key).filter(|_| displacement.is_none());
        if let Some(&known) = known {
            return known;
        }
        // Materials of its own get numbers of this scene, and so do pictures.
        let stamp = file.stamp.filter(|_| !own_materials && displacement.is_none());
        let store = self.options.meshes.as_deref().zip(stamp);
        let store = store.map(|(store, stamp)| {
            (store, StoreKey { path: key.path.clone(), stamp, shading, colors, subdivision })
        });
        let kept = store.as_ref().and_then(|(store, key)| store.get(key));
        let read = match kept {
            Some(kept) => {
                kept.warnings.iter().for_each(|warning| self.warn_of_file(&key.path, warning, span));
                Some(kept)
            }
            None => self.read_mesh(file, &key, displacement.as_ref(), span).inspect(|read| {
                store.into_iter().for_each(|(store, key)| store.put(key, read.clone()));
            }),
        };
        let is_clear = read.as_ref().is_some_and(|read| read.mesh.has_opacities());
        let shape = read.and_then(|read| self.put_mesh(read.mesh, &key.path, item, span));
        self.clear_meshes.extend(shape.filter(|_| is_clear));
        if displacement.is_none() {
            self.meshes.insert(key, shape);
        }
        shape
    }

    fn read_mesh(
        &mut self,
        file: AssetFile,
        key: &MeshKey,
        displacement: Option<&Displacement>,
        span: Span,
    ) -> Option<Kept> {
        let path = &key.path;
        let (mut mesh, report) = match read_mesh(file, &self.options.limits) {
            Ok(read) => read,
            Err(error) => {
                self.file_errors.push((error, span));
                return None;
            }
        };
        let mut warnings = report.warnings();
        match (key.colors, mesh.face_colors == Corners::Absent) {
            (true, true) => warnings.push("it has no colours for `colors on` to show".to_owned()),
            (false, false) => {
                warnings.push("its colours are not shown; `colors on` shows them".to_owned());
                (mesh.colors, mesh.face_colors) = (Vec::new(), Corners::Absent);
            }
            _ => {}
        }
        warnings.iter().for_each(|warning| self.warn_of_file(path, warning, span));
        let slots = if key.own_materials { self.material_slots(&mesh, path, span) } else { None };
        let data = match key.subdivision {
            None => {
                // What of it is kept counts as part of the mesh.
                let _averaging = self.memory_for_normals(&mesh, key.shading, path, span)?;
                mesh_data(mesh, key.shading, slots)
            }
            Some(how) => {
                let polygons = std::mem::take(&mut mesh.polygons);
                let read = ReadFaces { data: mesh_data(mesh, Shading::Flat, slots), polygons };
                let is_smooth = key.shading != Shading::Flat;
                self.subdivided(read, how, displacement, (is_smooth, path, span))?
            }
        };
        let mesh = self.built(data, path, span)?;
        Some(Kept { mesh, warnings })
    }

    /// Memory for finding the normals of a mesh that brings none; `None` where there is too little, which is reported.
    fn memory_for_normals(
        &mut self,
        mesh: &TriMesh,
        shading: Shading,
        path: &str,
        span: Span,
    ) -> Option<MemoryShare> {
        /// The sum of the normals around, the number of the first vertex there, and a place in their order.
        const BYTES_PER_VERTEX: usize = size_of::<Vec3>() + 2 * size_of::<u32>();
        let averages = match shading {
            Shading::Flat => false,
            Shading::Averaged => true,
            Shading::Smooth => mesh.face_normals == Corners::Absent,
        };
        let bytes = if averages { BYTES_PER_VERTEX * mesh.positions.len() } else { 0 };
        let share = self.options.limits.memory.share(bytes as u64);
        share.map_err(|over| self.cannot_read(path, &over.to_string(), span)).ok()
    }

    /// Memory for a file that is held while it is read; `None` where there is too little, which is reported.
    pub(super) fn memory_for_file(&mut self, file: &AssetFile, span: Span) -> Option<MemoryShare> {
        let share = self.options.limits.memory.share(file.len.unwrap_or(0));
        share.map_err(|over| self.cannot_read(&file.path, &over.to_string(), span)).ok()
    }

    /// As [`Compiler::built`], unless the same mesh was built for a scene before.
    pub(super) fn built_once(&mut self, data: MeshData, path: &str, span: Span) -> Option<Mesh> {
        let Some(store) = self.options.meshes.clone() else { return self.built(data, path, span) };
        let digest = data.digest();
        if let Some(mesh) = store.built(digest) {
            let (bytes, _) = data.memory();
            let taken = self.options.limits.memory.take(bytes as u64);
            return taken.map_err(|over| self.cannot_read(path, &over.to_string(), span)).ok().map(|()| mesh);
        }
        self.built(data, path, span).inspect(|mesh| store.put_built(digest, mesh.clone()))
    }

    /// Builds the tree of a mesh, unless the scene has failed already: a misspelt word should be reported
    /// without waiting for that.
    pub(super) fn built(&mut self, data: MeshData, path: &str, span: Span) -> Option<Mesh> {
        if self.has_failed() {
            return None;
        }
        let memory = &self.options.limits.memory;
        let (kept, building) = data.memory();
        let taken = memory.take(kept as u64).and_then(|()| memory.share(building as u64));
        let _building = match taken {
            Ok(share) => share,
            Err(over) => {
                self.cannot_read(path, &over.to_string(), span);
                return None;
            }
        };
        self.assets.progress(LoadStep::Building { path, triangles: data.faces.len() });
        let built = Mesh::new(data, &self.options.build);
        built.map_err(|error| self.cannot_read(path, &error.to_string(), span)).ok()
    }

    /// Stores a mesh, and says what is wrong with it.
    fn put_mesh(&mut self, mesh: Mesh, path: &str, item: Item<'_>, span: Span) -> Option<ShapeId> {
        match (mesh.triangle_count(), mesh.dropped()) {
            (0, _) => self.warn_of_file(path, "there are no triangles in it", span),
            (_, 0) => {}
            (n, flat) => {
                let message = format!("{flat} of its {n} triangles have no area and are left out");
                self.warn_of_file(path, &message, span);
            }
        }
        self.shape(item, mesh)
    }

    /// A picture that another file than the scene names; one that cannot be read is left out with a warning.
    ///
    /// * `encoding`: what its colours mean; `None` leaves it to the file
    pub(super) fn found_picture(
        &mut self,
        name: &str,
        from: &str,
        encoding: Option<Encoding>,
        span: Span,
    ) -> Option<PictureMap> {
        let mut pictures = PictureReader::new(self.assets, self.options, &mut self.pictures);
        // Some programs write the separators of their own system.
        let read = pictures.picture(&name.replace('\\', "/"), from, encoding);
        let laid = read.and_then(|(picture, _)| pictures.laid(picture));
        self.laid_or_left_out(laid, name, from, span)
    }

    /// A picture within another file; `name` is its own and that of the file.
    ///
    /// * `source`: how its bytes are had again
    pub(super) fn held_picture(
        &mut self,
        (bytes, source): (&[u8], Option<Reopen>),
        name: &str,
        encoding: Option<Encoding>,
        span: Span,
    ) -> Option<PictureMap> {
        let mut pictures = PictureReader::new(self.assets, self.options, &mut self.pictures);
        let read = pictures.held(bytes, name, encoding, source);
        let laid = read.and_then(|(picture, _)| pictures.laid(picture));
        self.laid_or_left_out(laid, name, name, span)
    }

    fn laid_or_left_out(
        &mut self,
        laid: Result<PictureMap, Problem>,
        name: &str,
        from: &str,
        span: Span,
    ) -> Option<PictureMap> {
        laid.map_err(|problem| self.picture_left_out(name, from, &problem.to_string(), span)).ok()
    }

    /// Warns that a picture which a file names is left out, once, however many materials show it.
    pub(super) fn picture_left_out(&mut self, name: &str, from: &str, why: &str, span: Span) {
        if self.left_out_pictures.insert((from.to_owned(), name.to_owned())) {
            self.warn_of_file(from, &format!("`{name}` is left out: {why}"), span);
        }
    }

    pub(super) fn cannot_read(&mut self, name: &str, reason: &str, span: Span) {
        let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
        self.diagnostics.push(error.label(span, "named here"));
    }

    pub(super) fn warn_of_file(&mut self, path: &str, message: &str, span: Span) {
        let warning = Diagnostic::warning(format!("`{path}`: {message}"));
        self.diagnostics.push(warning.label(span, "read here"));
    }
}

fn mesh_data(mesh: TriMesh, shading: Shading, material_slots: Option<Vec<MaterialSlot>>) -> MeshData {
    let positions: Vec<Vec3> = mesh.positions.into_iter().map(Vec3::from).collect();
    let from_file = |normals, corners| corner_values(normals, corners, |n| Vec3::from(n).normalize_or_zero());
    let around = |neighbours| Some(vertex_normals(&positions, &mesh.faces, neighbours));
    let normals = match shading {
        Shading::Flat => None,
        Shading::Averaged => around(Neighbours::ByIndex),
        Shading::Smooth => {
            from_file(mesh.normals, mesh.face_normals).or_else(|| around(Neighbours::ByPosition))
        }
    };
    let uvs = corner_values(mesh.uvs, mesh.face_uvs, Vec2::from);
    let colors = corner_colors(mesh.colors, mesh.face_colors, mesh.colors_are_srgb);
    let attributes = VertexAttributes::default();
    MeshData { positions, faces: mesh.faces, normals, uvs, colors, attributes, material_slots }
}

/// Colours of corners in linear RGB, and their opacity.
pub(super) fn corner_colors(
    colors: Vec<[f32; 4]>,
    corners: Corners,
    are_srgb: bool,
) -> Option<CornerValues<Vec4>> {
    let linear = |v: f32| if are_srgb { srgb::decode(v) } else { v };
    corner_values(colors, corners, |[r, g, b, opacity]| {
        Vec4::from([linear(r), linear(g), linear(b), opacity].map(|v| v.clamp(0.0, 1.0)))
    })
}

pub(super) fn corner_values<T, U>(
    values: Vec<T>,
    corners: Corners,
    convert: impl FnMut(T) -> U,
) -> Option<CornerValues<U>> {
    let faces = match corners {
        Corners::Absent => return None,
        Corners::Vertices => None,
        Corners::Own(faces) => Some(faces),
    };
    Some(CornerValues { values: values.into_iter().map(convert).collect(), faces })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use kajo_scene::{AssetError, Assets, MemoryAssets, SceneDesc};

    use super::*;
    use crate::compile::{CompileOptions, compile};

    /// Counts the trees that are built.
    struct Counting(MemoryAssets, AtomicUsize);

    impl Assets for Counting {
        fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
            self.0.open(name, from)
        }

        fn progress(&self, step: LoadStep<'_>) {
            if let LoadStep::Building { .. } = step {
                self.1.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    #[test]
    fn no_tree_is_built_for_a_scene_that_has_failed() {
        let scene = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
            Materials { Matte { color 1 1 1 } }
            Group { MaterialIndex 0 TriangleMesh { obj_file a.obj } }";
        for (text, trees) in [(scene.to_owned(), 1), (format!("{scene} Lihgts {{ }}"), 0)] {
            let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
            let assets = Counting(MemoryAssets::new().with("a.obj", triangle), AtomicUsize::new(0));
            let mut parsed = SceneDesc::parse_str(&text);
            let mut diagnostics = parsed.diagnostics;
            let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
            assert_eq!((scene.is_some(), assets.1.into_inner()), (trees == 1, trees), "{text}");
        }
    }
}
