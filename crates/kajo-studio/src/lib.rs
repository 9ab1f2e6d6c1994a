//! The studio: a window in which one flies through a scene, traces it, looks at what rays do, and edits it.
//!
//! * [`state`]: what the window is about, with no window in it
//! * [`raster`]: the preview, drawn by the graphics card or by its stand-in on the processor
//! * [`shell`]: panels, keys and mouse
//!
//! The program `kajo-studio` puts them into a window; tests put them into none.

pub mod raster;
pub mod shell;
pub mod state;
