//! The scene language of kajo: text to a tree with places, and mesh files.
//!
//! ```text
//! text --tokens--> SceneDesc --Params, Args--> typed values (in the crates above)
//!                      |
//!                      +--print, apply_edits--> text
//! ```
//!
//! This crate defines how a scene is written, not what its words mean: members of
//! the language read their keys from a [`Params`], and what is not read is an
//! error with its place and the nearest word that would have been right.
//! Files come from an [`Assets`]; what they may cost is bounded by [`Limits`].
//!
//! ```
//! use kajo_scene::{Args, Params, SceneDesc, render};
//! let mut parsed = SceneDesc::parse_str("Sphere { center 0 0 radius 1 }");
//! let sphere = parsed.desc.roots().next().unwrap();
//! let mut params = Params::new(sphere, &mut parsed.diagnostics);
//! let center = params.required("center", Args::vec3);
//! let radius = params.required("radius", Args::positive);
//! params.finish();
//! assert_eq!((center, radius), (None, Some(1.0)));
//! let report = render(&parsed.diagnostics, parsed.desc.sources(), false);
//! assert!(report.starts_with("error: expected 3 numbers after `center`, found 2"));
//! ```

#![forbid(unsafe_code)]

mod args;
mod assets;
mod byte_reader;
mod clock;
mod diagnostic;
mod edit;
mod expression;
mod font;
mod foreign;
mod gltf;
mod ies;
mod lexer;
mod limits;
mod line_reader;
mod memory_budget;
mod mesh_file;
mod mesh_file_error;
mod mtl;
mod nearest;
mod obj;
mod params;
mod parser;
mod ply;
mod print;
mod read_memory;
mod report;
mod skipped;
mod source;
mod stl;
mod text_encoding;
mod tree;
mod tri_mesh;
mod triangulate;
mod vdb;
mod volume;
mod voxels;
mod weld;
mod written_keys;

pub use args::Args;
pub use assets::{
    AssetError, AssetFile, Assets, LoadStep, MemoryAssets, Reopen, read_limited, relative_asset,
};
pub use clock::{Clock, USUAL_FPS};
pub use diagnostic::{Diagnostic, Diagnostics, Label, Severity};
pub use edit::{EditError, apply_edits, format_number};
pub use font::{FontError, GlyphContour, GlyphSegment, TextAlign, TextOutlines, TextStyle, text_outlines};
pub use foreign::{ForeignFile, HEAD_BYTES, READ_FORMATS, foreign_file};
pub use gltf::{
    CoordinateSet, Model, ModelAmount, ModelAnimation, ModelCamera, ModelCover, ModelGlossiness,
    ModelInstance, ModelLight, ModelLightKind, ModelMaterial, ModelMoment, ModelPart, ModelTint, ModelView,
    PictureSource, PictureUse, PictureWrap, VertexColors, read_gltf, read_gltf_at, read_gltf_picture,
};
pub use ies::{IesError, IesFile, read_ies};
pub use lexer::{LexError, Token, TokenKind, Tokens, tokens};
pub use limits::Limits;
pub use memory_budget::{MemoryBudget, MemoryShare, OverBudget, in_words};
pub use mesh_file::{MeshFormat, read_mesh};
pub use mesh_file_error::{FileMistake, MeshFileError};
pub use mtl::{MtlFile, MtlMap, MtlMapUse, MtlMaterial, read_mtl};
pub use nearest::nearest;
pub use obj::read_obj;
pub use params::{Params, not_supported_yet, unknown_word};
pub use parser::Parsed;
pub use ply::read_ply;
pub use print::print;
pub use report::{SHOWN, one_line, printable, render, render_one};
pub use skipped::Skipped;
pub use source::{Position, Source, SourceId, Sources, Span};
pub use stl::read_stl;
pub use tree::{Item, Items, NamedValue, SceneDesc, Value, Word};
pub use tri_mesh::{Corners, MeshReport, NO_INDEX, TriMesh};
pub use vdb::{GridEntry, GridMap, VoxelGrid, is_vdb, list_vdb, read_vdb};
pub use volume::{RawVolume, VolumeEncoding, VolumeError, VolumeFile, read_volume};
pub use voxels::{Block, SparseVoxels, VoxelValue};
pub use written_keys::{KeysOwner, WrittenKey, WrittenKeys};
