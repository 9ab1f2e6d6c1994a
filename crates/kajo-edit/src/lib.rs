//! A scene that is being edited: its texts, what they mean, and every step back.
//!
//! ```text
//!            parse              compile
//!   texts ----------> outline ----------> scene, messages
//!     ^                  |
//!     +----- edits ------+
//! ```
//!
//! The text is the truth. An [`Edit`] names a node of the outline and becomes replaced pieces of text; every other byte
//! stays as it was written, comments and blanks included. What cannot be said so is refused with a reason. An edit
//! that leaves a scene with mistakes keeps the last good scene to look at, and says what is wrong and where.
//!
//! An edit in a file that is included changes that file; one in a definition changes all its instances.
//!
//! Beside the [`Document`] stand what one needs to work on it with a mouse: [`handles`], points of the scene that can be
//! dragged, and [`preview`], its triangles for a graphics card. Nothing here knows a window.
//!
//! ```
//! use kajo_edit::{Document, Edit, FieldValue};
//!
//! let text = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
//!     Materials { Matte { } }
//!     Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 /* wide */ } }";
//! let mut document = Document::untitled(std::path::Path::new("."), text, Default::default())?;
//! let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
//! let wider = Edit::set(ball, "radius", FieldValue::numbers([2.5]));
//! document.apply(&wider)?;
//! assert!(document.text().ends_with("radius 2.5 /* wide */ } }"));
//! document.undo();
//! assert_eq!(document.text(), text);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod command;
mod compilation;
mod compiled;
mod completion;
mod difference;
mod displace;
mod document;
mod expressions;
mod fields;
pub mod handles;
mod history;
mod key_rows;
mod keys;
mod layout;
mod look;
mod materials;
mod movement;
mod naming;
mod outline;
mod overlay;
mod placement;
pub mod preview;
mod ramp;
mod refused;
mod reshape;
mod structure;
mod swatch;
mod templates;
mod texts;
mod timing;
mod tree;
mod unsaved;

pub use command::{Applied, Edit};
pub use compilation::Compilation;
pub use compiled::{Compiled, ModelRow};
pub use completion::{Completion, Suggestion, completion};
pub use difference::{Hunk, hunks};
pub use document::{Document, DocumentError};
pub use fields::Field;
pub use kajo_core::compile::keywords_of;
pub use kajo_core::schema::{FieldKind, FieldSpec, Kind};
pub use kajo_core::schema::{FieldValue, number_text};
pub use kajo_math::keyed::{Interpolation, Outside};
pub use key_rows::{Key, KeyOwner, KeyRow};
pub use keys::Keying;
pub use movement::Movement;
pub use outline::{Node, NodeId, Outline};
pub use ramp::{Ramp, RampStop};
pub use refused::EditRefused;
pub use swatch::{SWATCH_SIZE, Swatch, SwatchOf};
pub use templates::template;
pub use texts::{FileId, SceneFile, TextEdit};
pub use timing::Timing;
pub use unsaved::{Conflict, Unsaved, UnsavedText};
