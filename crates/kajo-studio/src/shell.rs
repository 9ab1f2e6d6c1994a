//! The window: panels around a viewport, and the keys and mouse that go with it.

mod app;
mod chooser;
mod completion;
mod help;
mod keys;
mod light_rows;
mod menu;
mod object_panel;
mod outliner;
mod picture;
mod picture_panel;
mod problems_panel;
mod questions;
mod ramp;
mod rays_panel;
mod render_panel;
mod sight;
mod stage;
mod status;
mod strip;
mod swatch;
mod text_editor;
mod text_panel;
pub mod theme;
mod time_panel;
mod viewport;
mod widgets;

pub use app::{App, Bottom, Layout, Tab};
pub use viewport::Area;
