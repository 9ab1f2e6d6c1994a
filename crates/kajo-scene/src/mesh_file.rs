//! Which reader a mesh file needs, told from its first bytes and its name.

use crate::assets::AssetFile;
use crate::foreign::{HEAD_BYTES, foreign_file};
use crate::limits::Limits;
use crate::mesh_file_error::MeshFileError;
use crate::obj::read_obj;
use crate::ply::read_ply;
use crate::stl::read_stl;
use crate::text_encoding::is_utf16;
use crate::tri_mesh::{MeshReport, TriMesh};

/// Formats of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// Stereolithography.
    Stl,
    /// glTF, which holds a whole model rather than a mesh.
    Gltf,
}

impl MeshFormat {
    /// The format of a file that is a model and no scene; `None` where neither its beginning nor its name says so.
    pub fn of_model(head: &[u8], path: &str) -> Option<MeshFormat> {
        let ending = path.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
        let is_named = |endings: &[&str]| ending.as_deref().is_some_and(|ending| endings.contains(&ending));
        let begins = head.starts_with(b"glTF") || MeshFormat::of(head, "") == MeshFormat::Ply;
        let is_model = begins || is_named(&["glb", "gltf", "vrm", "obj", "ply", "stl"]);
        if !is_model || foreign_file(head, path).is_some() {
            return None;
        }
        let is_gltf = !begins && is_named(&["glb", "gltf", "vrm"]);
        Some(if is_gltf { MeshFormat::Gltf } else { MeshFormat::of(head, path) })
    }

    /// The format of a file that begins so. What is found in it weighs more than the ending of its name.
    ///
    /// ```
    /// use kajo_scene::MeshFormat;
    /// assert_eq!(MeshFormat::of(b"ply\nformat", "bunny"), MeshFormat::Ply);
    /// assert_eq!(MeshFormat::of(b"# made by hand", "bunny.obj"), MeshFormat::Obj);
    /// ```
    pub fn of(head: &[u8], path: &str) -> MeshFormat {
        let named = |ending: &str| {
            let from = path.len().saturating_sub(ending.len());
            path.get(from..).is_some_and(|end| end.eq_ignore_ascii_case(ending))
        };
        let text = head.strip_prefix("\u{feff}".as_bytes()).unwrap_or(head).trim_ascii_start();
        match head {
            [b'p', b'l', b'y', b'\n' | b'\r' | b' ', ..] => MeshFormat::Ply,
            [b'g', b'l', b'T', b'F', ..] => MeshFormat::Gltf,
            _ if text.starts_with(b"{") => MeshFormat::Gltf,
            _ if named(".ply") => MeshFormat::Ply,
            _ if named(".stl") => MeshFormat::Stl,
            _ if named(".obj") => MeshFormat::Obj,
            // Text, which is refused by name.
            _ if is_utf16(head) => MeshFormat::Obj,
            _ if text.starts_with(b"solid") || head.contains(&0) => MeshFormat::Stl,
            _ => MeshFormat::Obj,
        }
    }
}

/// Reads a mesh of any format that holds one.
///
/// # Errors
/// Those of the format's reader; and for glTF, which is no single mesh.
pub fn read_mesh(file: AssetFile, limits: &Limits) -> Result<(TriMesh, MeshReport), MeshFileError> {
    let mut file = file;
    let head = file.head(HEAD_BYTES);
    let AssetFile { path, reader: whole, .. } = file;
    let head = head.map_err(|source| MeshFileError::Read { path: path.clone(), source })?;
    if let Some(foreign) = foreign_file(&head, &path) {
        let message = format!("this is {}, which is not read; {}", foreign.what, foreign.advice);
        return Err(MeshFileError::Content { path, message });
    }
    let format = MeshFormat::of(&head, &path);
    match format {
        MeshFormat::Obj => read_obj(whole, &path, limits),
        MeshFormat::Ply => read_ply(whole, &path, limits),
        MeshFormat::Stl => read_stl(whole, &path, limits),
        MeshFormat::Gltf => {
            let message =
                "this is a glTF file, a model of many meshes: show it with `Model { file ... }`".to_owned();
            Err(MeshFileError::Bytes { path, byte: 0, message })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::{Assets, MemoryAssets};
    use crate::memory_budget::MemoryBudget;
    use crate::mtl::read_mtl;
    use crate::text_encoding::tests::in_utf16;

    #[test]
    fn models_are_told_from_scenes() {
        for (head, path, format) in [
            (&b"ply\nformat ascii 1.0"[..], "bunny.txt", Some(MeshFormat::Ply)),
            (b"glTF\x02\0\0\0", "model", Some(MeshFormat::Gltf)),
            (b"{}", "model.gltf", Some(MeshFormat::Gltf)),
            (b"v 0 0 0", "a.OBJ", Some(MeshFormat::Obj)),
            (b"", "a.stl", Some(MeshFormat::Stl)),
            (b"Group { }", "scene.txt", None),
            (b"solid Group", "scene.txt", None),
            (b"Kaydara FBX Binary", "a.obj", None),
        ] {
            assert_eq!(MeshFormat::of_model(head, path), format, "{path}");
        }
    }

    #[test]
    fn lists_take_memory_as_they_grow() {
        let n = 20_000;
        let lines = |line: &dyn Fn(usize) -> String| (0..n).map(line).collect::<String>();
        let points = lines(&|i| format!("{i} 1 2 0.5 0.25 1\n"));
        let fan = "1//1 2//1 3//1 4//1 ".repeat(50);
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\n\
             property float nx\nproperty float ny\nproperty float nz\nelement face 4000\n\
             property list uchar int vertex_indices\nend_header\n"
        );
        let face = |i: usize| format!("4 {i} {} {} {}\n", i + 1, i + 2, i + 3);
        let faces: String = (0..4000).map(face).collect();
        let stl = lines(&|i| {
            format!(
                "facet normal 0 0 1\nouter loop\nvertex {i} 0 0\nvertex 0 1 {i}\nvertex 1 {i} 1\nendloop\nendfacet\n"
            )
        });
        let mut binary = vec![0; 80];
        binary.extend((n as u32).to_le_bytes());
        for i in 0..n {
            let record: [f32; 12] = std::array::from_fn(|k| (i * k) as f32);
            binary.extend(record.iter().flat_map(|x| x.to_le_bytes()).chain([0; 2]));
        }
        let mut swift = ply.replace("ascii", "binary_little_endian").into_bytes();
        swift.extend((0..n * 6).flat_map(|i| (i as f32).to_le_bytes()));
        swift.extend((0..4000u32).flat_map(|_| [&[3u8][..], &[0; 12]].concat()));
        let files: [(&str, Vec<u8>); 7] = [
            ("points.obj", lines(&|i| format!("v {i} 1 2\n")).into()),
            ("colours.obj", lines(&|i| format!("v {i} 1 2 0 1 1\n")).into()),
            (
                "fans.obj",
                format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n{}", format!("f {fan}\n").repeat(40))
                    .into(),
            ),
            ("a.ply", [ply, points, faces].concat().into()),
            ("swift.ply", swift),
            ("a.stl", format!("solid a\n{stl}endsolid a\n").into()),
            ("binary.stl", binary),
        ];
        for (path, content) in files {
            let assets = MemoryAssets::new().with(path, content);
            let read = |bytes: u64| {
                let limits = Limits { memory: MemoryBudget::new(bytes), ..Limits::default() };
                (read_mesh(assets.open(path, "").unwrap(), &limits), limits.memory)
            };
            let (refused, memory) = read(150_000);
            assert!(matches!(refused, Err(MeshFileError::Memory { .. })), "{path}: {refused:?}");
            assert!(memory.was_exceeded() && memory.used() == 0, "{path}");
            let (mesh, memory) = read(8_000_000);
            assert!(mesh.is_ok() && memory.used() == 0, "{path}: {mesh:?}");
        }
        let limits = Limits { memory: MemoryBudget::new(150_000), ..Limits::default() };
        for mtl in ["newmtl a\n".repeat(n), format!("newmtl a\n{}", "map_Kd a\n".repeat(n))] {
            let refused = read_mtl(mtl.as_bytes(), "a.mtl", &limits);
            assert!(matches!(refused, Err(MeshFileError::Memory { .. })), "{refused:?}");
        }
    }

    #[test]
    fn text_in_utf_16_is_refused_by_name() {
        let ply = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n";
        let stl = "solid a\nendsolid a\n";
        for (path, text) in [
            ("a.obj", "v 0 0 0\n"),
            ("a", "v 0 0 0\n"),
            ("a.ply", ply),
            ("a", ply),
            ("a.stl", stl),
            ("a.txt", stl),
        ] {
            for content in in_utf16(text) {
                let assets = MemoryAssets::new().with(path, content);
                let said =
                    read_mesh(assets.open(path, "").unwrap(), &Limits::default()).unwrap_err().to_string();
                assert_eq!(
                    said,
                    format!("{path}: this file is UTF-16 text, which is not read; save it as UTF-8")
                );
            }
        }
        for content in in_utf16("newmtl a\n") {
            let said = read_mtl(&*content, "a.mtl", &Limits::default()).unwrap_err().to_string();
            assert!(said.starts_with("a.mtl: this file is UTF-16"), "{said}");
        }
    }

    #[test]
    fn content_comes_before_the_name() {
        for (head, path, format) in [
            (&b"ply\r\nformat ascii 1.0"[..], "a.obj", MeshFormat::Ply),
            (b"solid thing", "a.STL", MeshFormat::Stl),
            (b"solid thing", "a", MeshFormat::Stl),
            (b"v 0 0 0", "a.ply", MeshFormat::Ply),
            (b"v 0 0 0", "a", MeshFormat::Obj),
            (b"solid 0 0 0", "a.obj", MeshFormat::Obj),
            (b"made by x\0\0\0", "a", MeshFormat::Stl),
            (b"glTF\x02\0\0\0", "a.obj", MeshFormat::Gltf),
            ("\u{feff} {}".as_bytes(), "a.gltf", MeshFormat::Gltf),
            (b"", "", MeshFormat::Obj),
            (b"", "\u{e9}ply", MeshFormat::Obj),
        ] {
            assert_eq!(MeshFormat::of(head, path), format, "{path}");
        }
    }
}
