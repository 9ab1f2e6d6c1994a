//! The scene around a model that was given without one: a camera that sees all of it, even light, a soft key light, and on
//! request a ground.
//!
//! The scene is a text like any other. It is what `kajo model.glb` renders, what the studio opens, and what `kajo convert`
//! writes to go on with. Nothing in it depends on how large the model is but the height of the ground, for which the model is
//! read first.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use kajo_core::compile::{CompileOptions, compile};
use kajo_math::{Aabb, Vec3};
use kajo_scene::{
    Assets, Diagnostic, Diagnostics, HEAD_BYTES, MeshFormat, Parsed, SceneDesc, Severity, format_number,
};

use crate::{FsAssets, LoadOptions, UpAxis};

/// The text of a scene that shows a model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelScene {
    /// The text.
    pub text: String,
    /// Whether the model has lights of its own, so that the key light was left out.
    pub has_own_lights: bool,
}

/// Watts in a lumen, as programs that write lights to glTF files count them: 1/683.
const WATTS_PER_LUMEN: f32 = 0.001464;

/// Bytes of a model that are looked at for what it has.
const LOOKED_AT: usize = 4 << 20;

/// A model that lies in a file.
pub(crate) struct ModelFile {
    path: PathBuf,
    /// The name that a scene in its folder calls it by.
    name: String,
    format: MeshFormat,
    head: Vec<u8>,
}

impl ModelFile {
    /// The model at `path`; `None` where that is a scene, or nothing that can be read.
    pub fn find(path: &Path, assets: &FsAssets) -> Option<ModelFile> {
        let mut file = assets.open(assets.scene_name(), "").ok()?;
        let head = file.head(LOOKED_AT).ok()?;
        let format = MeshFormat::of_model(&head[..head.len().min(HEAD_BYTES)], assets.scene_name())?;
        let name = path.file_name()?.to_string_lossy().into_owned();
        Some(ModelFile { path: path.to_path_buf(), name, format, head })
    }

    /// The name that a scene in its folder calls it by.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The name of the scene in messages.
    pub fn scene_name(&self) -> String {
        self.path.with_extension("txt").to_string_lossy().into_owned()
    }

    /// The scene around it.
    ///
    /// * `called`: by what name the scene finds the file
    pub fn scene(
        &self,
        called: &str,
        assets: &dyn Assets,
        options: &LoadOptions,
        diagnostics: &mut Diagnostics,
    ) -> ModelScene {
        let model = &options.model;
        let up = model.up.unwrap_or(if self.stands_along_z() { UpAxis::Z } else { UpAxis::Y }).vector();
        let is_gltf = self.format == MeshFormat::Gltf;
        let has_own_lights = self.has_lights();
        let has_own_cameras = is_gltf && contains(&self.head, b"\"camera\"");
        let mut scene =
            Text { up, called, block: self.block(assets), has_own_lights, has_own_cameras, ground: None };
        if model.ground {
            scene.ground = self.lowest(&scene.write(&self.name), up, assets, options);
            if scene.ground.is_none() {
                let warning = "the model has no lowest point to put a ground under";
                diagnostics.push(Diagnostic::warning(warning));
            }
        }
        ModelScene { text: scene.write(&self.name), has_own_lights }
    }

    /// The block that shows it.
    fn block(&self, assets: &dyn Assets) -> Block {
        let mut block = Block {
            keyword: "TriangleMesh",
            smooth: false,
            materials: false,
            colors: false,
            is_photometric: false,
        };
        match self.format {
            MeshFormat::Gltf => {
                (block.keyword, block.is_photometric) = ("Model", self.has_photometric_lights());
            }
            // Programs for solid bodies write no normals, and mean what they write: flat faces.
            MeshFormat::Stl => {}
            MeshFormat::Ply => (block.smooth, block.colors) = (true, self.has_ply_colors()),
            MeshFormat::Obj => {
                block.smooth = self.is_fine() || lines(&self.head).any(|line| line.starts_with(b"vn "));
                block.materials = self.has_materials(assets);
                block.colors = self.has_obj_colors();
            }
        }
        block
    }

    /// Whether up is z: in STL files, and in PLY files of Blender, which leaves its own axes in them.
    fn stands_along_z(&self) -> bool {
        let mut header = lines(&self.head).take_while(|line| !line.starts_with(b"end_header"));
        match self.format {
            MeshFormat::Stl => true,
            MeshFormat::Ply => header.any(|line| line.starts_with(b"comment") && contains(line, b"Blender")),
            MeshFormat::Obj | MeshFormat::Gltf => false,
        }
    }

    /// Whether a glTF file brings lights.
    fn has_lights(&self) -> bool {
        self.format == MeshFormat::Gltf && contains(&self.head, b"KHR_lights_punctual")
    }

    /// Whether lights of a glTF file are told in the units of the standard, lumens per area or solid angle: a light at home
    /// has tens of candela and the sun thousands of lux, where files that mean nothing of the kind have numbers near 1.
    fn has_photometric_lights(&self) -> bool {
        if !self.has_lights() {
            return false;
        }
        const LEAST: f32 = 100.0;
        const KEY: &[u8] = b"\"intensity\"";
        let found = self.head.windows(KEY.len()).enumerate().filter(|(_, window)| *window == KEY);
        let mut numbers = found.filter_map(|(at, _)| {
            let rest = self.head[at + KEY.len()..].trim_ascii_start().strip_prefix(b":")?.trim_ascii_start();
            let len = rest.iter().position(|b| !b"0123456789+-.eE".contains(b)).unwrap_or(rest.len());
            std::str::from_utf8(&rest[..len]).ok()?.parse::<f32>().ok()
        });
        numbers.any(|intensity| intensity >= LEAST)
    }

    /// Whether the header of a PLY file names a colour of its vertices.
    fn has_ply_colors(&self) -> bool {
        let header = lines(&self.head).take_while(|line| !line.starts_with(b"end_header"));
        let of_vertices = header
            .skip_while(|line| !line.starts_with(b"element vertex"))
            .skip(1)
            .take_while(|line| !line.starts_with(b"element"));
        let mut names = of_vertices.filter_map(|line| line.split(u8::is_ascii_whitespace).next_back());
        names.any(|name| matches!(name, b"red" | b"r" | b"diffuse_red"))
    }

    /// Whether a vertex of an OBJ file has a colour behind its position; where there are several objects, the first of them
    /// may have none.
    fn has_obj_colors(&self) -> bool {
        let words = |line: &[u8]| line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count();
        lines(&self.head).any(|line| line.starts_with(b"v ") && words(line) >= 7)
    }

    /// Whether there are so many vertices that faces are too small to be meant as such.
    fn is_fine(&self) -> bool {
        self.head.len() > 16 << 10
    }

    /// Whether the first library of materials that an OBJ file names can be had.
    fn has_materials(&self, assets: &dyn Assets) -> bool {
        let library = lines(&self.head).find_map(|line| line.strip_prefix(b"mtllib "));
        let library = library.map(|name| String::from_utf8_lossy(name).trim().to_owned());
        library.is_some_and(|name| assets.open(&name, "").is_ok())
    }

    /// How high the lowest point of a scene lies; `None` when it cannot be read, of which its loading will tell.
    fn lowest(&self, text: &str, up: Vec3, assets: &dyn Assets, options: &LoadOptions) -> Option<f32> {
        let limits = options.budgeted();
        let Parsed { mut desc, .. } = SceneDesc::parse(&self.scene_name(), text, assets, &limits);
        let mut unsaid = Diagnostics::new();
        let options = CompileOptions { camera: None, ..options.compile_options(limits) };
        let bounds = compile(&mut desc, assets, &options, &mut unsaid)?.geometry.bounds();
        (bounds.is_finite() && !bounds.is_empty()).then(|| lowest(&bounds, up))
    }
}

/// The least coordinate of a box along an axis.
fn lowest(bounds: &Aabb, up: Vec3) -> f32 {
    let corner = Vec3::select(up.cmplt(Vec3::ZERO), bounds.max, bounds.min);
    corner.dot(up)
}

fn contains(head: &[u8], part: &[u8]) -> bool {
    head.windows(part.len()).any(|window| window == part)
}

fn lines(head: &[u8]) -> impl Iterator<Item = &[u8]> {
    head.split(|&b| b == b'\n').map(<[u8]>::trim_ascii_start)
}

/// A block that shows a model: its keyword, and its keys besides the file.
#[derive(Clone, Copy)]
struct Block {
    keyword: &'static str,
    smooth: bool,
    materials: bool,
    colors: bool,
    /// Whether its lights are told in lumens.
    is_photometric: bool,
}

/// What the text is made of.
struct Text<'a> {
    up: Vec3,
    called: &'a str,
    block: Block,
    has_own_lights: bool,
    has_own_cameras: bool,
    /// Its height.
    ground: Option<f32>,
}

impl Text<'_> {
    fn write(&self, name: &str) -> String {
        let up = self.up;
        // Things that stand upright along y look towards z, those along z towards -y.
        let front = if up.z == 0.0 { Vec3::Z } else { Vec3::NEG_Y };
        let right = up.cross(front);
        let along = |x: f32, y: f32, z: f32| vector(x * right + y * up + z * front);
        let Block { keyword, smooth, materials, colors, is_photometric } = self.block;
        let file = quoted(self.called);
        let mut text = format!("# {name}, framed and lit. Everything here may be changed.\n\n");
        if self.has_own_cameras {
            let _ = writeln!(
                text,
                "# The model has cameras of its own: `--camera NAME` takes the picture with one of them."
            );
        }
        let _ = write!(
            text,
            "# The camera goes to where the scene fills the picture; `fit model` leaves out what else there is.\n\
             # `direction` is where it looks, `angle` how much it sees.\n\
             PerspectiveCamera view {{\n  fit       scene\n  direction {}\n  up        {}\n  angle     30\n}}\n\n",
            along(-0.55, -0.38, -1.0),
            along(0.0, 1.0, 0.0),
        );
        text += &self.lights(along);
        let _ = write!(
            text,
            "# For what brings no material of its own.\nMaterials {{\n  \
             Principled clay {{ color {}  roughness 0.55 }}\n",
            // Colours of vertices are factors of it.
            if colors { "0.95 0.95 0.95" } else { "0.58 0.55 0.51" }
        );
        if self.ground.is_some() {
            let _ = writeln!(text, "  Matte floor {{ color 0.46 0.46 0.46 }}");
        }
        let _ = write!(text, "}}\n\nGroup {{\n  MaterialIndex clay\n  {keyword} model {{ file {file}");
        let keys = [(smooth, "smooth"), (materials, "materials"), (colors, "colors")];
        for (_, key) in keys.iter().filter(|(on, _)| *on) {
            let _ = write!(text, "  {key} on");
        }
        if is_photometric {
            let _ = write!(text, "  lightScale {}", format_number(WATTS_PER_LUMEN));
        }
        let _ = writeln!(text, " }}");
        if let Some(height) = self.ground {
            let _ = write!(
                text,
                "  MaterialIndex floor\n  Plane ground {{ normal {}  offset {} }}\n",
                along(0.0, 1.0, 0.0),
                format_number(height),
            );
        }
        let _ = write!(
            text,
            "}}\n\n# Light is followed from surface to surface; more samples make the picture smoother.\n\
             Settings {{\n  integrator path\n  samples    sobol 64\n}}\n"
        );
        text
    }
}

impl Text<'_> {
    /// The lines of what lights the model.
    ///
    /// * `along`: a vector of the scene by right, up and front
    fn lights(&self, along: impl Fn(f32, f32, f32) -> String) -> String {
        let what = "# Even light from everywhere";
        if self.has_own_lights {
            let units = match self.block.is_photometric {
                true => " These are told in lumens; `lightScale` makes watts of them, 683 lumens each.",
                false => "",
            };
            return format!(
                "{what}, beside the lights of the model.{units}\nBackground {{ color 0.25 0.25 0.25 }}\n\n"
            );
        }
        format!(
            "{what}. What the light `angle` degrees wide shines at is softer the wider it is.\n\
             Background {{ color 0.3 0.3 0.3 }}\n\
             Lights {{\n  DirectionalLight key {{ direction {}  irradiance 2.5  angle 24 }}\n  \
             DirectionalLight rim {{ direction {}  irradiance 1.3  angle 40 }}\n}}\n\n",
            along(0.55, -0.95, -0.6),
            along(-0.7, -0.55, 0.85),
        )
    }
}

fn vector(v: Vec3) -> String {
    let text = |x: f32| format_number(if x == 0.0 { 0.0 } else { x });
    v.to_array().map(text).join(" ")
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Why a model cannot be turned into a scene.
#[derive(Debug, thiserror::Error)]
pub enum ConvertError {
    /// It is no model; the text says what it is, as a sentence of its own.
    #[error("{0}")]
    NoModel(String),
    /// A folder cannot be entered.
    #[error("{0}")]
    Folder(String),
}

/// The scene that shows the model at `path`, and whatever is to be said about it.
///
/// * `folder`: where the scene will lie
///
/// # Errors
/// [`ConvertError`] when there is no such model.
pub fn model_scene(
    path: &Path,
    folder: &Path,
    options: &LoadOptions,
) -> Result<(ModelScene, Vec<String>), ConvertError> {
    let assets = options.assets(path).map_err(ConvertError::Folder)?;
    let Some(model) = ModelFile::find(path, &assets) else {
        let parsed = SceneDesc::load(assets.scene_name(), &assets, &options.limits);
        let error = parsed.diagnostics.iter().find(|d| d.severity == Severity::Error);
        let told = error.map(|d| match &d.help {
            Some(help) => format!("{}\n  help: {help}", d.message),
            None => d.message.clone(),
        });
        let scene = || format!("`{}` is a scene already", path.display());
        return Err(ConvertError::NoModel(told.unwrap_or_else(scene)));
    };
    let mut diagnostics = Diagnostics::new();
    let called = relative(path, folder);
    let scene = model.scene(&model.name, &assets, options, &mut diagnostics);
    let text = scene.text.replacen(
        &format!("file {}", quoted(&model.name)),
        &format!("file {}", quoted(&called)),
        1,
    );
    let mut said: Vec<String> = diagnostics.iter().map(|d| d.message.clone()).collect();
    if called.starts_with("..") || Path::new(&called).is_absolute() {
        said.push(format!(
            "the scene names `{called}`, which lies outside its folder: render it with `--allow-outside`, or put the two together"
        ));
    }
    Ok((ModelScene { text, ..scene }, said))
}

/// The name by which a file in `folder` calls the one at `path`.
fn relative(path: &Path, folder: &Path) -> String {
    let real = |p: &Path| {
        let p = if p.as_os_str().is_empty() { Path::new(".") } else { p };
        std::fs::canonicalize(p).unwrap_or_else(|_| p.to_path_buf())
    };
    let (path, folder) = (real(path), real(folder));
    let common = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let ups = folder.components().count() - common;
    let mut name = PathBuf::new();
    (0..ups).for_each(|_| name.push(".."));
    path.components().skip(common).for_each(|part| name.push(part));
    name.to_string_lossy().replace('\\', "/")
}

/// The text of the scene around the model at `path`, in memory; `None` when the file is no model.
pub fn model_text(path: &Path, options: &LoadOptions) -> Option<String> {
    let assets = options.assets(path).ok()?;
    let model = ModelFile::find(path, &assets)?;
    Some(model.scene(model.name(), &assets, options, &mut Diagnostics::new()).text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ModelOptions;
    use std::fs;

    const TETRAHEDRON: &str = "v 0 0 2\nv 1 0 2\nv 0 1 2\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

    /// The text that shows a file of this content.
    fn text(name: &str, content: &str, model: ModelOptions) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        fs::write(folder.path().join("some.mtl"), "newmtl a\n").unwrap();
        let options = LoadOptions { model, ..LoadOptions::default() };
        let (scene, said) = model_scene(&path, folder.path(), &options).unwrap();
        assert!(said.is_empty(), "{said:?}");
        scene.text
    }

    #[test]
    fn the_ground_is_under_the_model_whichever_way_is_up() {
        let ground = |up| text("a.obj", TETRAHEDRON, ModelOptions { up, ground: true });
        assert!(ground(None).contains("Plane ground { normal 0 1 0  offset 0 }"));
        assert!(ground(Some(UpAxis::Z)).contains("Plane ground { normal 0 0 1  offset 2 }"));
        assert!(ground(Some(UpAxis::MinusZ)).contains("Plane ground { normal 0 0 -1  offset -3 }"));
        assert!(!text("a.obj", TETRAHEDRON, ModelOptions::default()).contains("Plane"));
    }

    #[test]
    fn what_a_file_has_is_asked_for() {
        let of = |name, content: &str| text(name, content, ModelOptions::default());
        assert!(of("a.obj", TETRAHEDRON).contains("TriangleMesh model { file \"a.obj\" }"));
        assert!(
            of("a.obj", &format!("mtllib some.mtl\n{TETRAHEDRON}vn 0 0 1\n"))
                .contains("smooth on  materials on }")
        );
        assert!(of("a.obj", &format!("mtllib none.mtl\n{TETRAHEDRON}")).contains("\"a.obj\" }"));
        assert!(
            of("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n").contains("colors on }")
        );
        let ply =
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty uchar red\nend_header\n";
        assert!(of("a.ply", ply).contains("smooth on  colors on }"));
        assert!(!of("a.ply", &ply.replace("uchar red", "uchar quality")).contains("colors"));
        let stl = of("a \"b\".stl", "solid a\nendsolid a\n");
        assert!(stl.contains("up        0 0 1") && stl.contains(r#"file "a \"b\".stl" }"#), "{stl}");
        let lit =
            of("a.gltf", "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_lights_punctual\"]}");
        assert!(lit.contains("Model model") && !lit.contains("DirectionalLight"), "{lit}");
    }

    #[test]
    fn files_of_blender_stand_upright_in_their_light_and_colours() {
        let of = |name, content: &str| text(name, content, ModelOptions::default());
        let ply = "ply\nformat ascii 1.0\ncomment Created in Blender version 5.0.1\nelement vertex 0\nproperty float x\nend_header\n";
        assert!(of("a.ply", ply).contains("up        0 0 1"));
        assert!(of("a.ply", &ply.replace("Blender", "MeshLab")).contains("up        0 1 0"));
        let second = format!("o a\n{TETRAHEDRON}o b\nv 0 0 0 1 0 0\n");
        assert!(of("a.obj", &second).contains("colors on"));
        let lit = |lights: &str| {
            let extension = format!(r#""extensions":{{"KHR_lights_punctual":{{"lights":[{lights}]}}}}"#);
            of("a.gltf", &format!(r#"{{"asset":{{"version":"2.0"}},{extension}}}"#))
        };
        let sun = lit(
            r#"{"type":"point","intensity":2},{"color":[1,1,1],"intensity" : 2049,"type":"directional"}"#,
        );
        assert!(sun.contains("lightScale 0.001464 ") && sun.contains("683 lumens"), "{sun}");
        assert!(!lit(r#"{"type":"point","intensity":20}"#).contains("lightScale"));
        assert!(!lit(r#"{"type":"point"}"#).contains("lightScale"));
        let unlit =
            r#"{"asset":{"version":"2.0"},"extensions":{"EXT_lights_image_based":{"intensity":200}}}"#;
        assert!(!of("a.gltf", unlit).contains("lightScale"), "other intensities are none of lights");
    }

    #[test]
    fn a_scene_beside_the_model_calls_it_by_its_way() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("parts/a.obj");
        fs::create_dir_all(folder.path().join("parts")).unwrap();
        fs::create_dir_all(folder.path().join("scenes")).unwrap();
        fs::write(&path, TETRAHEDRON).unwrap();
        let named =
            |scenes: &str| model_scene(&path, &folder.path().join(scenes), &LoadOptions::default()).unwrap();
        assert!(named("").0.text.contains("file \"parts/a.obj\""));
        let (scene, said) = named("scenes");
        assert!(scene.text.contains("file \"../parts/a.obj\"") && said[0].contains("--allow-outside"));
        let error = model_scene(&folder.path().join("b.obj"), folder.path(), &LoadOptions::default());
        assert!(error.unwrap_err().to_string().contains("b.obj"));
    }
}
