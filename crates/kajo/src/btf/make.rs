//! Rendering a bidirectional texture function.
//!
//! The surface lies about the plane z = 0 and is seen from above: a square of it, with u along x and v along y, becomes the texture. For each
//! direction of the light the scene is compiled with that light alone, and for each view the square is projected along the
//! direction to the viewer, obliquely, so that a pixel is a texel whatever the view:
//!
//! ```text
//! f(x, wo, wi) cos θi  =  L(x, wo) / E          E: irradiance of a surface that faces the light
//! ```
//!
//! Lights and background of the scene's own have no effect. Where the surface is to repeat, the scene repeats it beyond
//! the square, since neighbours cast shadows on it.

use std::io::Cursor;
use std::path::Path;

use kajo_core::camera::{Camera, CameraFrame, OrthographicCamera};
use kajo_core::measured::btf::BtfSamples;
use kajo_core::measured::direction;
use kajo_math::DVec3;
use kajo_render::Silent;
use kajo_scene::{AssetError, AssetFile, Assets, OverBudget};

use crate::{
    Defaults, Format, FsAssets, LoadOptions, RenderError, RenderRequest, RenderSettings, SamplerKind,
    Settings, SettingsError, View, load_from,
};

/// What is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Making {
    /// Texels along each side, at least 1.
    pub side: u32,
    /// Rings of directions around the normal, at least 1; see [`super::rings`].
    pub rings: u32,
    /// Samples of each texel, for each pair of directions.
    pub samples: u32,
    /// The corner of the square with the least x and y.
    pub corner: [f64; 2],
    /// Length of its sides.
    pub length: f64,
}

/// Why there is no such texture.
#[derive(Debug, thiserror::Error)]
pub enum MakeError {
    /// The scene cannot be read: what was said of it.
    #[error("{0}")]
    Scene(String),
    /// It cannot be rendered as its settings say.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// It could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Numbers that are no light came out.
    #[error("the picture has pixels that are no numbers")]
    NotFinite,
    /// Its samples need more memory than there is.
    #[error(transparent)]
    Memory(#[from] OverBudget),
}

/// The files of a scene, and one more that puts a light into it.
struct Lit<'a> {
    files: &'a FsAssets,
    name: String,
    text: String,
}

impl Assets for Lit<'_> {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        if name != self.name || !from.is_empty() {
            return self.files.open(name, if from == self.name { self.files.scene_name() } else { from });
        }
        let reader = Box::new(Cursor::new(self.text.clone().into_bytes()));
        Ok(AssetFile {
            path: self.name.clone(),
            len: Some(self.text.len() as u64),
            stamp: None,
            reopen: None,
            reader,
        })
    }
}

/// Renders the texture of a scene, whose own lights have no effect.
///
/// * `done`: told how many of the directions of light are finished, and of how many
///
/// # Errors
/// [`MakeError`].
pub fn make(
    scene: &Path,
    options: &LoadOptions,
    making: &Making,
    mut done: impl FnMut(usize, usize),
) -> Result<BtfSamples, MakeError> {
    let files = options.assets(scene).map_err(MakeError::Scene)?;
    let directions = super::rings(making.rings);
    let (n, texels) = (directions.len(), making.side as usize * making.side as usize);
    let limits = options.budgeted();
    let bytes = (texels as u128 * (n * n) as u128 * 12).min(u128::from(u64::MAX)) as u64;
    let _memory = limits.memory.share(bytes)?;
    let mut values = vec![0.0; texels * n * n * 3];
    for (light, &angles) in directions.iter().enumerate() {
        let text = lit_text(&files, direction(angles).to_array());
        let lit = Lit { files: &files, name: format!("{} with its light", files.scene_name()), text };
        let loaded = load_from(&lit.name, &lit, options);
        let report = loaded.report(false);
        let mut scene = loaded.scene.ok_or(MakeError::Scene(report))?;
        let asked = Settings {
            size: Some([making.side; 2]),
            samples: Some((SamplerKind::Sobol, making.samples)),
            ..Settings::default()
        };
        for (view, &angles) in directions.iter().enumerate() {
            let wo = direction(angles).as_dvec3();
            scene.output.camera = Camera::Orthographic(oblique(making, wo));
            let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false)?;
            let outputs = [(View::Color, Format::Exr)];
            let picture = crate::render(&RenderRequest::new(&scene, &settings, &outputs), &Silent)?;
            let light_image = picture.light().map_err(|_| MakeError::NotFinite)?;
            for (texel, pixel) in light_image.pixels().enumerate() {
                let at = ((texel * n + view) * n + light) * 3;
                values[at..at + 3].copy_from_slice(&pixel[..3]);
            }
        }
        done(light + 1, n);
    }
    if !values.iter().all(|v| v.is_finite()) {
        return Err(MakeError::NotFinite);
    }
    let (views, lights) = (directions.clone(), directions);
    Ok(BtfSamples { size: [making.side; 2], views, lights, has_cosine: true, values })
}

/// A text that includes the scene and lights it from the direction `wi` alone: of blocks that are given twice the last one counts.
fn lit_text(files: &FsAssets, [x, y, z]: [f32; 3]) -> String {
    let scene = files.scene_name();
    let name = scene.rsplit(['/', '\\']).next().unwrap_or(scene);
    let (x, y, z) = (-x, -y, -z);
    format!(
        "include \"{name}\"\n\
         Background {{ color 0 0 0 }}\n\
         OrthographicCamera {{ center 0 0 0  direction 0 0 -1  up 0 1 0  size 1 }}\n\
         Lights {{ DirectionalLight {{ direction {x:?} {y:?} {z:?}  irradiance 1 1 1 }} }}\n"
    )
}

/// The camera whose rays come along `wo` from the texels of the square.
fn oblique(making: &Making, wo: DVec3) -> OrthographicCamera {
    let [x, y] = making.corner;
    let half = 0.5 * making.length;
    let center = DVec3::new(x + half, y + half, 0.0);
    // Its picture lies in the surface, not across the rays.
    let frame = CameraFrame { center, right: DVec3::X, up: DVec3::Y, forward: -wo };
    OrthographicCamera { frame, size: making.length, lens: None }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn made(name: &str, text: &str) -> Result<BtfSamples, String> {
        let folder = std::env::temp_dir().join(format!("kajo_btf_{name}_{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let scene = folder.join("surface.txt");
        fs::write(&scene, text).unwrap();
        let making = Making { side: 4, rings: 1, samples: 4, corner: [0.0, 0.0], length: 1.0 };
        let samples = make(&scene, &LoadOptions::default(), &making, |_, _| {});
        fs::remove_dir_all(&folder).unwrap();
        samples.map_err(|error| error.to_string())
    }

    #[test]
    fn a_matt_plane_has_its_albedo_everywhere() {
        // Light of its own has no effect.
        let text = "Settings { integrator path }  Background { color 3 3 3 }
            Lights { PointLight { position 0 0 5  color 1 1 1 } }
            Materials { Matte grey { color 0.5 0.5 0.5 } }
            Group { MaterialIndex grey  Plane { normal 0 0 1  offset 0 } }";
        let samples = made("plane", text).unwrap();
        assert_eq!((samples.views.len(), samples.values.len()), (7, 16 * 49 * 3));
        for (i, value) in samples.values.iter().enumerate() {
            let expected = 0.5 / std::f32::consts::PI * direction(samples.lights[i / 3 % 7]).z;
            assert!((value - expected).abs() < 1e-4, "{i}: {value} {expected}");
        }
    }

    #[test]
    fn texels_are_places_whatever_the_view() {
        // The left half is black.
        let text = "Settings { integrator path }
            Materials { Matte black { color 0 0 0 }  Matte white { color 1 1 1 } }
            Group {
              MaterialIndex black  Quad { corner -9 -9 0  edge1 9.5 0 0  edge2 0 20 0 }
              MaterialIndex white  Quad { corner 0.5 -9 0  edge1 9 0 0  edge2 0 20 0 }
            }";
        let samples = made("halves", text).unwrap();
        for (texel, values) in samples.values.chunks(49 * 3).enumerate() {
            let is_white = texel % 4 >= 2;
            assert!(values.iter().all(|v| (*v > 0.01) == is_white), "{texel}: {values:?}");
        }
    }

    #[test]
    fn a_scene_that_cannot_be_read_is_refused_with_the_reason() {
        let said = made("mistake", "Group { Sphere { center 0 0 0  radius 1 } }").unwrap_err();
        assert!(said.contains("no material"), "{said}");
    }
}
