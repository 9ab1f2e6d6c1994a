//! What becomes of any bytes as a scene or as a mesh: diagnostics, or a small picture of finite numbers, in bounded time.
//!
//! Used by the test beside this folder and by the fuzz targets `render` and `mesh`.

use std::sync::atomic::{AtomicU64, Ordering};

use kajo::{
    Defaults, Format, INTEGRATORS, IntegratorName, Limits, LoadOptions, MemoryAssets, Progress, RenderError,
    RenderRequest, RenderSettings, Resources, SamplerKind, Settings, View, load_from, render,
};

/// Bounds that keep a case below a few milliseconds and megabytes.
fn limits() -> Limits {
    Limits {
        includes: 20,
        items: 2000,
        objects: 2000,
        vertices: 20_000,
        faces: 20_000,
        polygon_corners: 200,
        ..Limits::default()
    }
}

/// Stops a render that asks too often whether to go on.
struct Patience(AtomicU64);

impl Progress for Patience {
    fn done(&self, _: u64, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) > 200
    }
}

/// Renders `text` with an integrator if it is a scene.
///
/// # Panics
/// When anything panics, or the picture holds what is no finite number.
pub fn picture(text: &[u8], files: &[(&str, &[u8])], integrator: IntegratorName) {
    let assets = MemoryAssets::new().with("scene.txt", text);
    let assets = files.iter().fold(assets, |assets, (name, content)| assets.with(*name, content));
    let options = LoadOptions { limits: limits(), ..LoadOptions::default() };
    let Some(scene) = load_from("scene.txt", &assets, &options).scene else { return };
    let asked = Settings {
        size: Some([3, 3]),
        samples: Some((SamplerKind::Uniform, 2)),
        integrator: Some(integrator),
        bounces: Some(scene.output.settings.bounces.unwrap_or(6).min(12)),
        branches: Some(2),
        photons: Some(200),
        rays: Some(32),
        ..Settings::default()
    };
    let Ok(settings) = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false) else { return };
    let resources = Resources { threads: 1, tile: 0, memory: Some(1 << 27) };
    let patience = Patience(AtomicU64::new(0));
    match render(
        &RenderRequest::new(&scene, &settings, &[(View::Color, Format::Exr)]).with(resources),
        &patience,
    ) {
        Ok(picture) => {
            let light = picture.light().expect("a picture of nine pixels");
            assert!(light.data().iter().all(|v| v.is_finite()), "{:?}", light.data());
        }
        Err(error @ RenderError::Panicked { .. }) => panic!("{error}"),
        Err(_) => {}
    }
}

/// What a mesh stands for in its scene.
pub const PARTS: [&str; 9] = [
    "Matte m { color 0.5 0.5 0.5 }",
    "Metal m { color 0.9 0.9 0.9  roughness 0.3 }",
    "Glass m { }",
    "Glass m { thin on }",
    "Glass m { thin on  roughness 0.4 }",
    "Matte m { opacity 0.3 }",
    "Matte m { color 0 0 0  emission 3 3 3 }",
    "PhongMaterial m { reflectiveColor 0.5 0.5 0.5  transparentColor 0.5 0.5 0.5  indexOfRefraction 1.3 }",
    "Principled m { bump bump.pgm 0.1  anisotropy 0.5  roughness 0.4 }",
];

/// Renders any bytes as a mesh of a format, in a part.
pub fn mesh(data: &[u8], extension: &str, part: usize, integrator: IntegratorName) {
    let name = format!("mesh.{extension}");
    let object = match extension {
        "glb" | "gltf" => format!("Model {{ file {name} }}"),
        "obj" => format!("MaterialIndex m TriangleMesh {{ file {name}  materials on  smooth on }}"),
        _ => format!("MaterialIndex m TriangleMesh {{ file {name} }}"),
    };
    let scene = format!(
        "PerspectiveCamera {{ center 0.3 0.2 4  direction 0 0 -1  up 0 1 0  angle 40 }}
         Background {{ color 0.2 0.3 0.4 }}
         Lights {{ PointLight {{ position 3 3 3  intensity 5 5 5 }} }}
         Materials {{ {}  Matte emitter {{ emission 5 5 5 }} }}
         Group {{
           {object}
           MaterialIndex emitter Quad {{ corner -1 3 -1  edge1 2 0 0  edge2 0 0 2 }}
           Transform {{ Rotate 1 1 0 40  Scale 1 1e-3 1  {object} }}
         }}",
        PARTS[part % PARTS.len()]
    );
    let material = b"newmtl a\nKd 1 0 0\nKe 1 1 1\nd 0.5\nmap_Kd bump.pgm\n";
    let bump = b"P2 2 2 255 0 255 128 7\n";
    let files: [(&str, &[u8]); 4] =
        [(&name, data), ("bump.pgm", bump), ("m.mtl", material), ("all.mtl", material)];
    picture(scene.as_bytes(), &files, integrator);
}

/// Integrators, each as likely as the others.
pub fn integrator(choice: u8) -> IntegratorName {
    INTEGRATORS[usize::from(choice) % INTEGRATORS.len()].name
}
