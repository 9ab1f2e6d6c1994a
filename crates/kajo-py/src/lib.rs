//! kajo for Python: the module `kajo._native`, around which the package `kajo` is written in Python.
//!
//! Pictures are made by the same functions as those of the command line, so they have the same bytes. A render runs on
//! threads of its own while the interpreter is free; the thread that asked for it looks every 40 ms whether Ctrl-C was
//! pressed and tells the callback how far it is.

mod render;
mod settings;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo::output::Target;
use kajo::{BitDepth, Dialect, Format, LoadOptions, Loaded, MemoryAssets, Picture, Severity, View};
use pyo3::exceptions::{PyKeyError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

pyo3::create_exception!(kajo, KajoError, pyo3::exceptions::PyException, "What kajo cannot do.");
pyo3::create_exception!(
    kajo,
    SceneError,
    KajoError,
    "A scene, or a setting, that is wrong; `lines` has the messages."
);
pyo3::create_exception!(kajo, RenderError, KajoError, "A picture that cannot be rendered.");

/// A scene, ready to be rendered.
#[pyclass(frozen, module = "kajo._native")]
struct Scene {
    scene: Arc<kajo::Scene>,
    warnings: Vec<String>,
}

/// A rendered picture.
#[pyclass(frozen, module = "kajo._native")]
struct Image {
    picture: Picture,
    views: Vec<View>,
}

/// What to render besides settings.
type Crop = (u32, u32, u32, u32);

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
    ) -> PyResult<Image> {
        let settings = settings::resolve(py, &self.scene, settings, crop)?;
        let views = layers.iter().map(|name| view(name)).collect::<PyResult<Vec<View>>>()?;
        let goal = render::goal(noise, time, adaptive)?;
        let picture = render::render(py, &self.scene, &settings, &views, threads, &goal, progress)?;
        Ok(Image { picture, views })
    }
}

#[pymethods]
impl Image {
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.picture.size().into()
    }

    #[getter]
    fn layers(&self) -> Vec<&'static str> {
        self.views.iter().map(|view| view.name()).collect()
    }

    #[getter]
    fn samples(&self) -> f64 {
        self.picture.mean_samples()
    }

    #[getter]
    fn noise(&self) -> Option<f64> {
        self.picture.noise()
    }

    #[getter]
    fn rays(&self) -> u64 {
        self.picture.stats.rays.total()
    }

    #[getter]
    fn seconds(&self) -> f64 {
        self.picture.stats.seconds
    }

    /// Height, width, channels, and the numbers as bytes.
    fn layer<'py>(&self, py: Python<'py>, name: &str) -> PyResult<(u32, u32, usize, Bound<'py, PyBytes>)> {
        let wanted = view(name).map_err(|_| PyKeyError::new_err(name.to_owned()))?;
        if !self.views.contains(&wanted) {
            return Err(PyKeyError::new_err(name.to_owned()));
        }
        let image = py.detach(|| self.picture.layer(wanted)).map_err(failed)?;
        let bytes: Vec<u8> = image.data().iter().flat_map(|value| value.to_ne_bytes()).collect();
        Ok((image.height(), image.width(), image.channels(), PyBytes::new(py, &bytes)))
    }

    /// The bytes of a file.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        layers: Vec<String>,
        format: &str,
        bits: u32,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let views = layers.iter().map(|name| view(name)).collect::<PyResult<Vec<View>>>()?;
        let format = Format::from_extension(format).ok_or_else(|| {
            PyValueError::new_err(format!(
                "{format:?} is no format: take png, exr, tga, bmp, ppm, pfm or hdr"
            ))
        })?;
        let depth = match bits {
            8 => BitDepth::Eight,
            16 => BitDepth::Sixteen,
            _ => return Err(PyValueError::new_err("a PNG file has 8 or 16 bits a channel")),
        };
        let bytes = py.detach(|| self.picture.encode(&views, format, depth)).map_err(failed)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes a file, whole or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf, data: &[u8]) -> PyResult<()> {
        py.detach(|| Target::check(&path, &[]).and_then(|target| target.write(data)))
            .map_err(|error| PyOSError::new_err(error.to_string()))
    }
}

fn view(name: &str) -> PyResult<View> {
    View::from_name(name).ok_or_else(|| {
        PyValueError::new_err(format!("{name:?} is no layer: take {}", View::NAMES.join(", ")))
    })
}

fn failed(error: impl std::fmt::Display) -> PyErr {
    RenderError::new_err(error.to_string())
}

fn options(camera: Option<String>, dialect: Option<&str>, aspect: Option<f64>) -> PyResult<LoadOptions> {
    let unknown = |name: &str| {
        PyValueError::new_err(format!("{name:?} is no dialect: take {}", Dialect::NAMES.join(", ")))
    };
    let dialect = dialect.map(|name| Dialect::from_name(name).ok_or_else(|| unknown(name))).transpose()?;
    Ok(LoadOptions { dialect, camera, aspect, ..LoadOptions::default() })
}

/// The scene, or an exception with all that is wrong.
fn checked(py: Python<'_>, loaded: Loaded) -> PyResult<Scene> {
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

fn scene_error(py: Python<'_>, report: String, lines: Vec<String>) -> PyErr {
    let error = SceneError::new_err(report);
    // The message says it all; the list is for programs.
    let _ = error.value(py).setattr("lines", lines);
    error
}

/// Reads a scene file.
#[pyfunction]
fn load(
    py: Python<'_>,
    path: PathBuf,
    folders: Vec<PathBuf>,
    allow_outside: bool,
    camera: Option<String>,
    dialect: Option<&str>,
    aspect: Option<f64>,
) -> PyResult<Scene> {
    let options = LoadOptions { folders, allow_outside, ..options(camera, dialect, aspect)? };
    let loaded = py.detach(|| kajo::load(Path::new(&path), &options));
    checked(py, loaded)
}

/// Reads a scene from its text.
#[pyfunction]
fn loads(
    py: Python<'_>,
    text: &str,
    name: &str,
    files: BTreeMap<String, Vec<u8>>,
    camera: Option<String>,
    dialect: Option<&str>,
    aspect: Option<f64>,
) -> PyResult<Scene> {
    let options = options(camera, dialect, aspect)?;
    let loaded = py.detach(|| {
        let assets =
            files.iter().fold(MemoryAssets::new(), |assets, (name, content)| assets.with(name, content));
        kajo::load_from(name, &assets.with(name, text), &options)
    });
    checked(py, loaded)
}

/// What decides the bits of pictures.
#[pyfunction]
fn build_identity() -> String {
    kajo::epoch::build_identity()
}

/// The module.
#[pymodule]
#[pyo3(name = "_native")]
fn native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("LAYERS", View::NAMES.to_vec())?;
    module.add("KajoError", py.get_type::<KajoError>())?;
    module.add("SceneError", py.get_type::<SceneError>())?;
    module.add("RenderError", py.get_type::<RenderError>())?;
    module.add_class::<Scene>()?;
    module.add_class::<Image>()?;
    module.add_function(wrap_pyfunction!(load, module)?)?;
    module.add_function(wrap_pyfunction!(loads, module)?)?;
    module.add_function(wrap_pyfunction!(build_identity, module)?)
}
