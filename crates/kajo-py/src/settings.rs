//! Settings of a render, from the words of a `Settings` block.
//!
//! They are read by the scene language itself, so that Python knows every key that scenes know, and its messages.

use kajo::{Defaults, LoadOptions, MemoryAssets, Rect, RenderSettings, Scene};
use pyo3::prelude::*;

use crate::{Crop, failed, scene_error};

/// A scene that is nothing but a place for settings.
const AROUND: &str = "OrthographicCamera { center 0 0 1  direction 0 0 -1  up 0 1 0  size 1 } Group { }";

/// All settings of a render.
///
/// * `text`: keys and values, which count more than what the scene says
///
/// # Errors
/// `SceneError` with the place of what is wrong; `RenderError` where settings do not go together.
pub fn resolve(py: Python<'_>, scene: &Scene, text: &str, crop: Option<Crop>) -> PyResult<RenderSettings> {
    let assets = MemoryAssets::new().with("settings", format!("Settings {{ {text} }}\n{AROUND}"));
    let loaded = kajo::load_from("settings", &assets, &LoadOptions::default());
    let lines: Vec<String> = loaded.lines().collect();
    // A warning is of a key that means nothing, or of a word that was skipped.
    let Some(asked) = loaded.scene.as_ref().filter(|_| lines.is_empty()) else {
        return Err(scene_error(py, loaded.report(false), lines));
    };
    let settings =
        RenderSettings::resolve(scene, &asked.output.settings, Defaults::Modern, false).map_err(failed)?;
    match crop {
        Some((x0, y0, width, height)) => settings
            .cropped(Rect { x0, y0, x1: x0.saturating_add(width), y1: y0.saturating_add(height) })
            .map_err(failed),
        None => Ok(settings),
    }
}
