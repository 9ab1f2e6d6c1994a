//! Comparison of pictures, and scenes whose light is known.

use kajo::Image as Pixels;
use kajo::compare::compare_pictures;
use kajo_selftest::{Effort, Verdict, trials};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// An array of height x width x channels.
fn pixels(py: Python<'_>, array: &Bound<'_, PyAny>, shape: (u32, u32, usize)) -> PyResult<Pixels> {
    let data = PyBuffer::<f32>::get(array)?.to_vec(py)?;
    let (height, width, channels) = shape;
    Pixels::from_data(width, height, channels, data).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Figures by their names.
type Figures = Vec<(&'static str, f64)>;

/// The figures of a comparison, and the FLIP error of each pixel in the array that `make` returns for a shape.
///
/// * `display`: whether the values are those of a screen, within 0 and 1, and not light
#[pyfunction]
pub fn compare<'py>(
    py: Python<'py>,
    pictures: (Bound<'py, PyAny>, Bound<'py, PyAny>),
    shapes: ((u32, u32, usize), (u32, u32, usize)),
    display: bool,
    make: &Bound<'py, PyAny>,
) -> PyResult<(Figures, Bound<'py, PyAny>)> {
    let (reference, test) = (pixels(py, &pictures.0, shapes.0)?, pixels(py, &pictures.1, shapes.1)?);
    let (figures, flip) = py
        .detach(|| compare_pictures(&reference, &test, !display))
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    let mean =
        flip.data().iter().map(|&error| f64::from(error)).sum::<f64>() / flip.data().len().max(1) as f64;
    let named = vec![
        ("mse", figures.mse),
        ("rmse", figures.rmse),
        ("psnr", figures.psnr),
        ("rel_mse", figures.rel_mse),
        ("max_abs", figures.max_abs),
        ("flip", mean),
    ];
    let map = make.call1(((flip.height(), flip.width()),))?;
    PyBuffer::<f32>::get(&map)?.copy_from_slice(py, flip.data())?;
    Ok((named, map))
}

/// A row of the self-test: name, method, expected, measured, standard error, camera rays, verdict.
type RowOfTest = (String, &'static str, f64, f64, f64, u64, String);

/// Renders the rows whose name or method holds `only`, and calls `tell` with each.
#[pyfunction]
pub fn selftest(
    py: Python<'_>,
    only: &str,
    seed: u64,
    quick: bool,
    threads: usize,
    tell: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let effort = if quick { Effort::QUICK } else { Effort::FULL };
    let wanted =
        trials(seed).into_iter().filter(|trial| trial.name.contains(only) || trial.method.contains(only));
    for trial in wanted {
        let row = py.detach(|| trial.run(seed, effort, threads));
        py.check_signals()?;
        let verdict = match row.verdict {
            Verdict::Pass => "pass".to_owned(),
            Verdict::Wrong => "wrong".to_owned(),
            Verdict::Noisy => "noisy".to_owned(),
            Verdict::Broken(why) => why,
        };
        let row: RowOfTest =
            (row.name, row.method, row.expected, row.measured, row.sigma, row.samples, verdict);
        tell.call1(row)?;
    }
    Ok(())
}
