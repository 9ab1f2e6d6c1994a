//! Files of other programs, known by how they begin and by the endings of their names, so that the message says what a file
//! is rather than which of its bytes is no word.

use crate::diagnostic::{Diagnostic, quoted};

/// What is read, for messages.
pub const READ_FORMATS: &str =
    "kajo reads its own scene text, and models in glTF 2.0 (.glb, .gltf), OBJ, PLY and STL";

/// Bytes that are looked at.
pub const HEAD_BYTES: usize = 4096;

/// A file of another program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForeignFile {
    /// What it is, as in "a scene of pbrt".
    pub what: &'static str,
    /// What can be done.
    pub advice: &'static str,
}

const EXPORT: &str = "open it in the program that it comes from, or in Blender, and export a `.glb`";
const SCENE: &str = "its meshes can be shown if they are PLY or OBJ files: `kajo mesh.ply`, or `TriangleMesh { file mesh.ply }` in a scene";
const CONVERT: &str =
    "turn it into a `.glb`, for instance with Blender or assimp: `assimp export FILE model.glb`";
const UNPACK: &str = "unpack it, and name the scene or model in it";

const fn foreign(what: &'static str, advice: &'static str) -> ForeignFile {
    ForeignFile { what, advice }
}

const PACKAGE_3MF: ForeignFile =
    foreign("a 3MF package", "open it in a slicer or in Blender and export an `.stl` or `.glb`");

/// How files begin.
const MAGIC: &[(&[u8], ForeignFile)] = &[
    (b"BLENDER", foreign("a Blender file", "open it in Blender and export a `.glb`: File, Export, glTF 2.0")),
    (b"PXR-USDC", foreign("a binary USD stage", "open it in Blender or usdview and export a `.glb`")),
    (b"#usda", foreign("a USD stage", "open it in Blender or usdview and export a `.glb`")),
    (b"Kaydara FBX Binary", foreign("an FBX file", CONVERT)),
    (b"; FBX", foreign("an FBX file", CONVERT)),
    (b"Ogawa", foreign("an Alembic archive", EXPORT)),
    (b"\x89HDF", foreign("an HDF5 file, such as an old Alembic archive", EXPORT)),
    (
        b"glTF\x01\0\0\0",
        foreign(
            "a glTF 1.0 file",
            "glTF 2.0 is what is read: convert it with `gltf-pipeline -i FILE -o model.glb`",
        ),
    ),
    (b"#VRML", foreign("a VRML world", CONVERT)),
    (b"#X3D", foreign("an X3D world", CONVERT)),
    (b"//Maya ASCII", foreign("a Maya scene", EXPORT)),
    (
        b"ISO-10303-21",
        foreign(
            "a STEP file of solid bodies",
            "export a mesh from a CAD program, such as FreeCAD: `.stl` or `.glb`",
        ),
    ),
    (b"##RenderMan", foreign("a RenderMan scene", SCENE)),
    (b"OFF\n", foreign("an OFF mesh", CONVERT)),
    (b"OFF\r", foreign("an OFF mesh", CONVERT)),
    (b"COFF", foreign("an OFF mesh", CONVERT)),
    (b"# .PCD", foreign("a cloud of points", "make a mesh of it first, for instance in MeshLab or Open3D")),
    (b"VOX ", foreign("a MagicaVoxel model", "export an `.obj` or `.ply` in MagicaVoxel")),
    (
        b"version https://git-lfs",
        foreign("a placeholder of Git LFS, not the file itself", "fetch it with `git lfs pull`"),
    ),
    (b"\x89PNG", foreign("a PNG picture", PICTURE)),
    (b"\xff\xd8\xff", foreign("a JPEG picture", PICTURE)),
    (b"\x76\x2f\x31\x01", foreign("an OpenEXR picture", PICTURE)),
    (b"#?RADIANCE", foreign("a Radiance picture", PICTURE)),
    (b"%PDF", foreign("a PDF document", EXPORT)),
    (b"\xd0\xcf\x11\xe0", foreign("a file of 3ds Max, or another compound document", EXPORT)),
    (b"\x28\xb5\x2f\xfd", foreign("a compressed file", UNPACK)),
    (b"\x1f\x8b", foreign("a compressed file", UNPACK)),
    (b"7z\xbc\xaf", foreign("an archive", UNPACK)),
    (b"Rar!", foreign("an archive", UNPACK)),
];

const PICTURE: &str =
    "pictures go onto materials and backgrounds: `Background { environment FILE }`; `kajo diff` compares two";

/// What stands somewhere near the beginning of a text, in small letters.
const INSIDE: &[(&str, ForeignFile)] = &[
    ("<collada", foreign("a Collada file", CONVERT)),
    ("<x3d", foreign("an X3D world", CONVERT)),
    ("<scene version=", foreign("a scene of Mitsuba", SCENE)),
    ("<scene type=", foreign("a scene of Mitsuba", SCENE)),
    (
        "<!doctype html",
        foreign("a web page", "what was downloaded is the page about the model, not the model"),
    ),
    ("<html", foreign("a web page", "what was downloaded is the page about the model, not the model")),
    ("<svg", foreign("a drawing", EXPORT)),
    (
        "<?xml",
        foreign(
            "an XML file",
            "if it is a scene of Mitsuba or a Collada file, export a `.glb` from the program that made it",
        ),
    ),
    ("worldbegin", foreign("a scene of pbrt", SCENE)),
    ("#include \"colors.inc\"", foreign("a scene of POV-Ray", SCENE)),
    ("global_settings", foreign("a scene of POV-Ray", SCENE)),
];

/// Endings of names, for files that do not begin in any way of their own.
const ENDINGS: &[(&str, ForeignFile)] = &[
    ("pbrt", foreign("a scene of pbrt", SCENE)),
    ("pov", foreign("a scene of POV-Ray", SCENE)),
    ("dae", foreign("a Collada file", CONVERT)),
    ("usd", foreign("a USD stage", "open it in Blender or usdview and export a `.glb`")),
    ("usda", foreign("a USD stage", "open it in Blender or usdview and export a `.glb`")),
    ("usdc", foreign("a USD stage", "open it in Blender or usdview and export a `.glb`")),
    ("usdz", foreign("a packed USD stage", "open it in Blender and export a `.glb`")),
    ("blend", foreign("a Blender file", "open it in Blender and export a `.glb`: File, Export, glTF 2.0")),
    ("3mf", PACKAGE_3MF),
    ("fbx", foreign("an FBX file", CONVERT)),
    ("abc", foreign("an Alembic archive", EXPORT)),
    ("3ds", foreign("a 3D Studio file", CONVERT)),
    ("max", foreign("a file of 3ds Max", EXPORT)),
    ("ma", foreign("a Maya scene", EXPORT)),
    ("mb", foreign("a Maya scene", EXPORT)),
    ("c4d", foreign("a Cinema 4D file", EXPORT)),
    ("lwo", foreign("a LightWave object", CONVERT)),
    ("lws", foreign("a LightWave scene", EXPORT)),
    ("hip", foreign("a Houdini file", EXPORT)),
    ("skp", foreign("a SketchUp model", EXPORT)),
    ("3dm", foreign("a Rhino model", EXPORT)),
    (
        "step",
        foreign(
            "a STEP file of solid bodies",
            "export a mesh from a CAD program, such as FreeCAD: `.stl` or `.glb`",
        ),
    ),
    (
        "stp",
        foreign(
            "a STEP file of solid bodies",
            "export a mesh from a CAD program, such as FreeCAD: `.stl` or `.glb`",
        ),
    ),
    (
        "iges",
        foreign(
            "an IGES file of surfaces",
            "export a mesh from a CAD program, such as FreeCAD: `.stl` or `.glb`",
        ),
    ),
    (
        "igs",
        foreign(
            "an IGES file of surfaces",
            "export a mesh from a CAD program, such as FreeCAD: `.stl` or `.glb`",
        ),
    ),
    ("dxf", foreign("a DXF drawing", EXPORT)),
    ("off", foreign("an OFF mesh", CONVERT)),
    ("wrl", foreign("a VRML world", CONVERT)),
    ("x3d", foreign("an X3D world", CONVERT)),
    ("rib", foreign("a RenderMan scene", SCENE)),
    ("ass", foreign("a scene of Arnold", SCENE)),
    ("lxs", foreign("a scene of LuxRender", SCENE)),
    ("vdb", foreign("an OpenVDB volume", "volumes on a grid are not rendered")),
    ("mtl", foreign("a library of materials", "name the `.obj` file that uses it")),
    ("ies", foreign("a measured luminaire", "a scene uses it: `PointLight { position 0 2 0  ies FILE }`")),
];

/// What a file is, if it is one of another program.
///
/// * `head`: its first [`HEAD_BYTES`] bytes, or all that it has
/// * `path`: its name
///
/// ```
/// use kajo_scene::foreign_file;
/// assert_eq!(foreign_file(b"#usda 1.0\n", "a.txt").unwrap().what, "a USD stage");
/// assert!(foreign_file(b"Group { }", "scene.txt").is_none());
/// ```
pub fn foreign_file(head: &[u8], path: &str) -> Option<ForeignFile> {
    let head = &head[..head.len().min(HEAD_BYTES)];
    if let Some((_, foreign)) = MAGIC.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Some(*foreign);
    }
    let ending = path.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let by_name = ENDINGS.iter().find(|(known, _)| ending.as_deref() == Some(known)).map(|(_, found)| *found);
    if head.starts_with(b"PK\x03\x04") {
        let archive = foreign("an archive", UNPACK);
        return Some(by_name.unwrap_or(if contains(head, b"3D/") { PACKAGE_3MF } else { archive }));
    }
    if is_pbrt(head) {
        return Some(foreign("a scene of pbrt", SCENE));
    }
    let text = String::from_utf8_lossy(head).to_lowercase();
    let has_markup = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
    let inside = INSIDE.iter().filter(|(words, _)| has_markup || !words.starts_with('<'));
    let inside = inside.into_iter().find(|(words, _)| text.contains(words)).map(|(_, found)| *found);
    inside.or(by_name)
}

/// Directives of pbrt begin lines and take strings.
fn is_pbrt(head: &[u8]) -> bool {
    let begins = |line: &[u8]| {
        [&b"Integrator \""[..], b"Film \"", b"Sampler \"", b"Camera \""].iter().any(|d| line.starts_with(d))
    };
    head.split(|&b| b == b'\n').any(begins)
}

fn contains(head: &[u8], part: &[u8]) -> bool {
    head.windows(part.len()).any(|window| window == part)
}

impl ForeignFile {
    /// The error about a file of that name.
    pub fn error(&self, name: &str) -> Diagnostic {
        Diagnostic::error(self.message(name)).help(format!("{}; {READ_FORMATS}", self.advice))
    }

    /// The same in a sentence.
    pub fn message(&self, name: &str) -> String {
        format!("{} is {}, which kajo does not read", quoted(name), self.what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_content_and_by_name() {
        for (head, path, what) in [
            (&b"BLENDER-v300"[..], "a", "a Blender file"),
            (b"\x28\xb5\x2f\xfd..", "a.blend", "a compressed file"),
            (b"Kaydara FBX Binary  \0", "a.obj", "an FBX file"),
            (b"PK\x03\x04..[Content_Types].xml..3D/3dmodel.model", "a", "a 3MF package"),
            (b"PK\x03\x04", "a.usdz", "a packed USD stage"),
            (b"PK\x03\x04", "a.zip", "an archive"),
            (b"<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">", "a.xml", "a scene of Mitsuba"),
            (b"<?xml version=\"1.0\"?>\n<COLLADA xmlns", "a.xml", "a Collada file"),
            (
                b"# a\nLookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin",
                "a.txt",
                "a scene of pbrt",
            ),
            (b"Film \"rgb\" \"string filename\" \"a.exr\"", "a.txt", "a scene of pbrt"),
            (b"#include \"colors.inc\"\ncamera {", "a.txt", "a scene of POV-Ray"),
            (b"camera { location <0, 1, -3> }", "a.POV", "a scene of POV-Ray"),
            (b"glTF\x01\0\0\0", "a.glb", "a glTF 1.0 file"),
            (b"Ogawa\xff", "a.abc", "an Alembic archive"),
            (b"#usda 1.0", "a.txt", "a USD stage"),
            (b"#VRML V2.0 utf8", "a", "a VRML world"),
            (b"<!DOCTYPE html>", "a.glb", "a web page"),
            (b"\x89PNG\r\n", "a.txt", "a PNG picture"),
            (b"anything", "a.dae", "a Collada file"),
        ] {
            assert_eq!(foreign_file(head, path).map(|f| f.what), Some(what), "{path}");
        }
    }

    #[test]
    fn scenes_and_models_that_are_read_are_not_foreign() {
        for (head, path) in [
            (&b"# <html> in a comment\nGroup { }"[..], "scene.txt"),
            (b"PerspectiveCamera { fit scene }", "scene"),
            (b"ply\nformat ascii 1.0", "a.ply"),
            (b"solid a", "a.stl"),
            (b"# OBJ\nv 0 0 0", "a.obj"),
            (b"glTF\x02\0\0\0", "a.glb"),
            (b"{ \"asset\": { \"version\": \"2.0\" } }", "a.gltf"),
            (b"", "a.txt"),
        ] {
            assert_eq!(foreign_file(head, path), None, "{path}");
        }
    }

    #[test]
    fn a_message_names_what_is_read() {
        let error = foreign_file(b"BLENDER", "chair.blend").unwrap().error("chair.blend");
        assert_eq!(error.message, "`chair.blend` is a Blender file, which kajo does not read");
        let help = error.help.unwrap();
        for format in ["scene text", "glTF 2.0", "OBJ", "PLY", "STL"] {
            assert!(help.contains(format), "{help}");
        }
    }
}
