//! The blocks of the scene language, and what fields they have.

pub use kajo_core::compile::{block_of, blocks, keywords_of, kind_of};
pub use kajo_core::schema::{Absent, Block, FieldKind, FieldSpec, FieldValue, Kind};
