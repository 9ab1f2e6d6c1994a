//! The class `Image`.

use std::path::PathBuf;

use kajo::output::Target;
use kajo::{BitDepth, Format, Picture, View};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyKeyError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::failed;

/// A rendered picture.
#[pyclass(frozen, module = "kajo._native")]
pub struct Image {
    pub picture: Picture,
    pub views: Vec<View>,
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
    fn r_hat(&self) -> Option<f64> {
        self.picture.r_hat()
    }

    #[getter]
    fn clamped(&self) -> Option<(f64, f64, f64)> {
        self.picture.clamped().map(|clamped| clamped.taken.into())
    }

    #[getter]
    fn rays(&self) -> u64 {
        self.picture.stats.rays.total()
    }

    #[getter]
    fn seconds(&self) -> f64 {
        self.picture.stats.seconds
    }

    /// Calls `make` with height, width and channels, fills the array of 32-bit floats that it returns, and returns that.
    fn layer<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        make: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let wanted = view(name).map_err(|_| PyKeyError::new_err(name.to_owned()))?;
        if !self.views.contains(&wanted) {
            return Err(PyKeyError::new_err(name.to_owned()));
        }
        let image = py.detach(|| self.picture.layer(wanted)).map_err(failed)?;
        let array = make.call1(((image.height(), image.width(), image.channels()),))?;
        PyBuffer::<f32>::get(&array)?.copy_from_slice(py, image.data())?;
        Ok(array)
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
}

/// The view that a layer of this name shows.
pub fn view(name: &str) -> PyResult<View> {
    View::from_name(name).ok_or_else(|| {
        PyValueError::new_err(format!("{name:?} is no layer: take {}", View::NAMES.join(", ")))
    })
}

/// Writes a file, whole or not at all.
#[pyfunction]
pub fn write(py: Python<'_>, path: PathBuf, data: &[u8]) -> PyResult<()> {
    py.detach(|| Target::check(&path, &[]).and_then(|target| target.write(data)))
        .map_err(|error| PyOSError::new_err(error.to_string()))
}
