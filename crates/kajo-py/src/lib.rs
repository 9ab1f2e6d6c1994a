//! kajo for Python: the module `kajo._native`, around which the package `kajo` is written in Python.
//!
//! Pictures are made by the same functions as those of the command line, so they have the same bytes. A render runs on
//! threads of its own while the interpreter is free; the thread that asked for it looks every 20 ms whether Ctrl-C was
//! pressed and tells the callback how far it is.

mod document;
mod files;
mod image;
mod measures;
mod render;
mod scene;
mod settings;

use kajo::View;
use pyo3::prelude::*;

pyo3::create_exception!(kajo, KajoError, pyo3::exceptions::PyException, "What kajo cannot do.");
pyo3::create_exception!(
    kajo,
    SceneError,
    KajoError,
    "A scene, or a setting, that is wrong; `lines` has the messages."
);
pyo3::create_exception!(kajo, RenderError, KajoError, "A picture that cannot be rendered.");
pyo3::create_exception!(kajo, EditError, KajoError, "An edit of a scene file that cannot be done.");

/// Left, top, width and height of a part of the picture.
type Crop = (u32, u32, u32, u32);

fn failed(error: impl std::fmt::Display) -> PyErr {
    RenderError::new_err(error.to_string())
}

/// An exception with all that is wrong with a scene.
///
/// * `lines`: one for each message
fn scene_error(py: Python<'_>, report: String, lines: Vec<String>) -> PyErr {
    let error = SceneError::new_err(report);
    // The message says it all; the list is for programs.
    let _ = error.value(py).setattr("lines", lines);
    error
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
    module.add("EditError", py.get_type::<EditError>())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<image::Image>()?;
    module.add_class::<document::Document>()?;
    module.add_function(wrap_pyfunction!(scene::load, module)?)?;
    module.add_function(wrap_pyfunction!(scene::loads, module)?)?;
    module.add_function(wrap_pyfunction!(scene::pack, module)?)?;
    module.add_function(wrap_pyfunction!(scene::pack_text, module)?)?;
    module.add_function(wrap_pyfunction!(scene::unpack, module)?)?;
    module.add_function(wrap_pyfunction!(image::write, module)?)?;
    module.add_function(wrap_pyfunction!(measures::compare, module)?)?;
    module.add_function(wrap_pyfunction!(measures::selftest, module)?)?;
    module.add_function(wrap_pyfunction!(build_identity, module)?)
}
