//! A render that the interpreter can be told of and can stop.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use kajo::{
    BitDepth, Format, Goal, Passes, Picture, Progress, RenderRequest, RenderSettings, Resources, Scene,
    Snapshot, View,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::{RenderError, failed};

/// Interval between two checks for signals.
const STEP: Duration = Duration::from_millis(20);

/// How far a render is, and whether it is to stop.
#[derive(Default)]
struct Watch {
    done: AtomicU64,
    total: AtomicU64,
    stop: AtomicBool,
    /// What the preview's callback raised.
    raised: Mutex<Option<PyErr>>,
}

impl Progress for Watch {
    fn done(&self, pixels_done: u64, pixels_total: u64, _: u64) {
        self.done.fetch_max(pixels_done, Ordering::Relaxed);
        self.total.store(pixels_total, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Watch {
    fn share(&self) -> f64 {
        self.done.load(Ordering::Relaxed) as f64 / self.total.load(Ordering::Relaxed).max(1) as f64
    }
}

/// Progress callbacks of a render.
pub struct Watchers {
    /// Called with the share that is done.
    pub progress: Option<Py<PyAny>>,
    /// Called with the bytes of a PNG of the picture so far.
    pub preview: Option<Py<PyAny>>,
}

/// When a render ends.
///
/// * `interval`: seconds between two looks at the picture so far
pub fn goal(noise: Option<f64>, time: Option<f64>, adaptive: bool, interval: Option<f64>) -> PyResult<Goal> {
    if noise.is_some_and(|noise| !(noise.is_finite() && noise > 0.0)) {
        return Err(PyValueError::new_err("noise is a number above 0"));
    }
    let seconds = |time| Duration::try_from_secs_f64(time);
    let time = time.map(seconds).transpose();
    let time = time.map_err(|_| PyValueError::new_err("time is a number of seconds, 0 or more"))?;
    let interval = interval.map(seconds).transpose();
    let interval =
        interval.map_err(|_| PyValueError::new_err("preview_interval is a number of seconds, 0 or more"))?;
    Ok(Goal { time, noise, adaptive, interval })
}

/// Renders on other threads; this one looks after signals and the callback.
///
/// # Errors
/// `RenderError`, and what a signal or the callback raised.
pub fn render(
    py: Python<'_>,
    scene: &Scene,
    settings: &RenderSettings,
    views: &[View],
    threads: usize,
    goal: &Goal,
    watchers: Watchers,
) -> PyResult<Picture> {
    let Watchers { progress, preview } = watchers;
    // Files for the eye show some layers otherwise than files of numbers, and either may be asked for.
    let outputs: Vec<(View, Format)> = [Format::Exr, Format::Png]
        .into_iter()
        .flat_map(|format| views.iter().map(move |&view| (view, format)))
        .collect();
    let resources = Resources { threads, ..Resources::default() };
    let request = RenderRequest::new(scene, settings, &outputs).with(resources);
    let watch = Watch::default();
    let rendered = py.detach(|| {
        thread::scope(|scope| {
            let (over, heard) = sync_channel(1);
            let watch = &watch;
            let work = move || {
                let result = match *goal == Goal::default() {
                    true => kajo::render(&request, watch),
                    false => {
                        let passes = Passes { goal: *goal, ..Passes::default() };
                        let look = &mut |snapshot: Snapshot<'_>| match &preview {
                            Some(preview) => show(&snapshot, views, preview, watch),
                            None => ControlFlow::Continue(()),
                        };
                        kajo::render_passes(&request, &passes, watch, look)
                    }
                };
                let _ = over.send(());
                result
            };
            let worker = thread::Builder::new().name("kajo".to_owned()).spawn_scoped(scope, work)?;
            let mut raised = None;
            while raised.is_none() && matches!(heard.recv_timeout(STEP), Err(RecvTimeoutError::Timeout)) {
                raised = Python::attach(|py| look(py, watch, progress.as_ref())).err();
                watch.stop.store(raised.is_some(), Ordering::Relaxed);
            }
            let result = worker.join();
            Ok::<_, std::io::Error>((result, raised))
        })
    });
    if let Some(raised) = watch.raised.into_inner().unwrap_or_default() {
        return Err(raised);
    }
    let (result, raised) = rendered?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    finished(py, result, progress.as_ref())
}

/// What a thread has rendered, and the end of its progress told.
fn finished(
    py: Python<'_>,
    result: thread::Result<Result<Picture, kajo::RenderError>>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Picture> {
    match result {
        Ok(Ok(picture)) => {
            if let Some(callback) = progress {
                callback.call1(py, (1.0,))?;
            }
            Ok(picture)
        }
        Ok(Err(error)) => Err(failed(error)),
        Err(_) => Err(RenderError::new_err("this is a bug in kajo, not in your scene: a thread panicked")),
    }
}

/// Shows the picture so far; what that raises ends the render.
fn show(snapshot: &Snapshot<'_>, views: &[View], preview: &Py<PyAny>, watch: &Watch) -> ControlFlow<()> {
    // A picture that cannot be shown yet will be shown later.
    let Ok(png) = snapshot.encode(&views[..1.min(views.len())], Format::Png, BitDepth::Eight) else {
        return ControlFlow::Continue(());
    };
    let shown =
        Python::attach(|py| preview.call1(py, (PyBytes::new(py, &png), snapshot.samples())).map(drop));
    let Err(raised) = shown else { return ControlFlow::Continue(()) };
    if let Ok(mut first) = watch.raised.lock() {
        first.get_or_insert(raised);
    }
    ControlFlow::Break(())
}

/// Hears signals, and tells how far the render is.
fn look(py: Python<'_>, watch: &Watch, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    py.check_signals()?;
    if let Some(callback) = progress {
        callback.call1(py, (watch.share(),))?;
    }
    Ok(())
}
