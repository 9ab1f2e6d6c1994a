//! Materials before their references to others are followed.

use std::borrow::Cow;

use kajo_scene::{Args, Diagnostic, Span};

use super::extras::Extras;
use super::fields::{Plain, Sources, Typed};
use crate::material::MaterialId;
use crate::schema::{FieldKind, FieldSpec};
use crate::texture::FloatTexture;

/// What one of two materials of a pattern is written by.
pub(super) const PART: FieldSpec = FieldSpec {
    about: "the two materials that it mixes",
    ..FieldSpec::new("materialIndex", FieldKind::Material)
};

/// The two materials of a pattern.
pub(super) const PARTS: &[FieldSpec] = &[PART; 2];

/// A material before its references are followed.
pub(super) enum Draft<'t> {
    /// One that has none, with what it has besides, and where it stands.
    Stored(Option<MaterialId>, Extras, Span),
    Blend(BlendDraft<'t>),
}

/// A blend before the references to its parts are followed.
pub(super) struct BlendDraft<'t> {
    /// The share of the second part.
    pub amount: FloatTexture,
    pub parts: [Reference<'t>; 2],
    pub span: Span,
}

/// Another material, by number or name.
#[derive(Clone)]
pub(super) enum Reference<'t> {
    Number(usize, Span),
    Name(Cow<'t, str>, Span),
}

/// A field that names a material.
pub(super) const fn named_material<'t>(key: &'static str) -> Typed<Reference<'t>> {
    Typed::new(key, FieldKind::Material)
}

impl<'t> Plain<'t> for Reference<'t> {
    fn parse(_: &FieldSpec, args: &mut Args<'t>, _: &mut Sources<'_>) -> Result<Reference<'t>, Diagnostic> {
        Reference::read(args)
    }
}

impl<'t> Reference<'t> {
    /// The value of a `MaterialIndex`.
    pub(super) fn read(args: &mut Args<'t>) -> Result<Reference<'t>, Diagnostic> {
        let span = args.item().head_span();
        if args.is_word() {
            return Ok(Reference::Name(args.text()?, span));
        }
        Ok(Reference::Number(args.int_in(0..=i64::from(u32::MAX))? as usize, span))
    }
}
