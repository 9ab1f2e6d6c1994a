//! The scene language of kajo: text to a tree with places, and mesh files.

#![forbid(unsafe_code)]

mod args;
mod assets;
mod diagnostic;
mod edit;
mod lexer;
mod limits;
mod line_reader;
mod mtl;
mod nearest;
mod obj;
mod params;
mod parser;
mod print;
mod report;
mod source;
mod tree;
mod triangulate;

pub use args::Args;
pub use assets::{AssetError, AssetFile, Assets, MemoryAssets, read_limited, relative_asset};
pub use diagnostic::{Diagnostic, Diagnostics, Label, Severity};
pub use edit::{EditError, apply_edits, format_number};
pub use lexer::{LexError, Token, TokenKind, Tokens, tokens};
pub use limits::Limits;
pub use line_reader::{FileMistake, MeshFileError};
pub use mtl::{MtlFile, MtlMaterial, read_mtl};
pub use nearest::nearest;
pub use obj::{NO_INDEX, ObjMesh, ObjReport, read_obj};
pub use params::{Params, not_supported_yet, unknown_word};
pub use parser::Parsed;
pub use print::print;
pub use report::{SHOWN, one_line, render, render_one};
pub use source::{Position, Source, SourceId, Sources, Span};
pub use tree::{Item, Items, SceneDesc, Value, Word};
