//! The class `Scene`, and what reads scenes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo::{Dialect, LoadOptions, Loaded, Severity, TextureFolder, View};
use kajo_farm::{Bundle, Recording};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::files::{FileArgument, PythonFiles};
use crate::image::{Image, view};
use crate::render::{self, Watchers};
use crate::{Crop, failed, scene_error, settings};

/// A scene, ready to be rendered.
#[pyclass(frozen, module = "kajo._native")]
pub struct Scene {
    pub scene: Arc<kajo::Scene>,
    warnings: Vec<String>,
}

impl Scene {
    /// * `warnings`: one line each
    pub fn new(scene: Arc<kajo::Scene>, warnings: Vec<String>) -> Scene {
        Scene { scene, warnings }
    }
}

#[pymethods]
impl Scene {
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    #[getter]
    fn objects(&self) -> u64 {
        self.scene.geometry.object_count()
    }

    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn render(
        &self,
        py: Python<'_>,
        settings: &str,
        layers: Vec<String>,
        threads: usize,
        noise: Option<f64>,
        time: Option<f64>,
        adaptive: bool,
        crop: Option<Crop>,
        progress: Option<Py<PyAny>>,
        preview: Option<(f64, Py<PyAny>)>,
    ) -> PyResult<Image> {
        let settings = settings::resolve(py, &self.scene, settings, crop)?;
        let views = layers.iter().map(|name| view(name)).collect::<PyResult<Vec<View>>>()?;
        let goal = render::goal(noise, time, adaptive, preview.as_ref().map(|(interval, _)| *interval))?;
        let watchers = Watchers { progress, preview: preview.map(|(_, preview)| preview) };
        let picture = render::render(py, &self.scene, &settings, &views, threads, &goal, watchers)?;
        Ok(Image { picture, views })
    }
}

/// What the keywords of `load` and `loads` say.
pub fn options(camera: Option<String>, dialect: Option<&str>, aspect: Option<f64>) -> PyResult<LoadOptions> {
    let unknown = |name: &str| {
        PyValueError::new_err(format!("{name:?} is no dialect: take {}", Dialect::NAMES.join(", ")))
    };
    let dialect = dialect.map(|name| Dialect::from_name(name).ok_or_else(|| unknown(name))).transpose()?;
    Ok(LoadOptions { dialect, camera, aspect, ..LoadOptions::default() })
}

/// The scene, or an exception with all that is wrong.
pub fn checked(py: Python<'_>, loaded: Loaded) -> PyResult<Scene> {
    let lines: Vec<String> = loaded.lines().collect();
    if loaded.scene.is_none() {
        return Err(scene_error(py, loaded.report(false), lines));
    }
    debug_assert_eq!(loaded.diagnostics.count(Severity::Error), 0);
    match loaded.scene {
        Some(scene) => Ok(Scene { scene: Arc::new(scene), warnings: lines }),
        None => Err(scene_error(py, String::new(), lines)),
    }
}

/// Reads a scene file.
#[pyfunction]
pub fn load(
    py: Python<'_>,
    path: PathBuf,
    folders: Vec<PathBuf>,
    allow_outside: bool,
    camera: Option<String>,
    dialect: Option<&str>,
    aspect: Option<f64>,
) -> PyResult<Scene> {
    let textures = TextureFolder::usual();
    let options = LoadOptions { folders, allow_outside, textures, ..options(camera, dialect, aspect)? };
    let loaded = py.detach(|| kajo::load(Path::new(&path), &options));
    checked(py, loaded)
}

/// Reads a scene from its text.
#[pyfunction]
pub fn loads(
    py: Python<'_>,
    text: &str,
    name: &str,
    files: BTreeMap<String, FileArgument>,
    camera: Option<String>,
    dialect: Option<&str>,
    aspect: Option<f64>,
) -> PyResult<Scene> {
    let options = options(camera, dialect, aspect)?;
    let files = PythonFiles::new(py, name, text, files)?;
    let loaded = py.detach(|| kajo::load_from(name, &files, &options));
    checked(py, loaded)
}

/// A scene file and all it names, as the bytes of a bundle.
#[pyfunction]
pub fn pack<'py>(
    py: Python<'py>,
    path: PathBuf,
    folders: Vec<PathBuf>,
    allow_outside: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let options = LoadOptions { folders, allow_outside, ..LoadOptions::default() };
    let bytes = py.detach(|| {
        let assets = options.assets(&path)?;
        let recording = Recording::new(&assets, assets.scene_name());
        let loaded = kajo::load_from(assets.scene_name(), &recording, &options);
        match loaded.scene {
            None => Err(loaded.report(false)),
            Some(_) => recording.bundle().bytes().map_err(|error| error.to_string()),
        }
    });
    bytes.map(|bytes| PyBytes::new(py, &bytes)).map_err(|report| scene_error(py, report, Vec::new()))
}

/// A scene with its files, as the bytes of a bundle.
#[pyfunction]
pub fn pack_text<'py>(
    py: Python<'py>,
    text: &str,
    name: &str,
    files: BTreeMap<String, FileArgument>,
) -> PyResult<Bound<'py, PyBytes>> {
    let files = PythonFiles::new(py, name, text, files)?;
    let bytes = py.detach(|| {
        let recording = Recording::new(&files, name);
        let loaded = kajo::load_from(name, &recording, &LoadOptions::default());
        match loaded.scene {
            None => Err(loaded.report(false)),
            Some(_) => recording.bundle().bytes().map_err(|error| error.to_string()),
        }
    });
    bytes.map(|bytes| PyBytes::new(py, &bytes)).map_err(|report| scene_error(py, report, Vec::new()))
}

/// Reads a scene from the bytes of a bundle.
#[pyfunction]
pub fn unpack(
    py: Python<'_>,
    bytes: &[u8],
    camera: Option<String>,
    dialect: Option<&str>,
    aspect: Option<f64>,
) -> PyResult<Scene> {
    let options = options(camera, dialect, aspect)?;
    let bundle = Bundle::read(bytes).map_err(failed)?;
    let loaded = py.detach(|| kajo::load_from(bundle.scene(), &bundle, &options));
    checked(py, loaded)
}
