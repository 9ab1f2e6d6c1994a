//! Members of the families of blocks: what each is, and what reads it.

use kajo_scene::{Diagnostic, Item, Params};

use super::Compiler;
use super::camera_keys::CameraReader;
use super::fields::Sources;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::material_draft::Draft;
use super::named_texture::NamedTexture;
use crate::medium::MediumId;
use crate::schema::Block;

/// A block of a family, and what reads it.
pub(super) struct Member<F> {
    pub block: Block,
    pub read: F,
}

/// The words of the members of a family.
pub(super) const fn keywords<F, const N: usize>(members: &[&Member<F>; N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = members[i].block.keyword;
        i += 1;
    }
    words
}

/// A kind of object, groups and transforms included.
pub(super) type ObjectMember =
    Member<fn(&mut Compiler<'_>, Item<'_>, &mut CurrentTransform, &mut GraphicsState)>;

/// A kind of light.
pub(super) type LightMember = Member<fn(&mut Compiler<'_>, Item<'_>)>;

/// A kind of camera.
pub(super) type CameraMember = Member<CameraReader>;

/// A kind of material.
pub(super) type MaterialMember = Member<for<'t> fn(&mut Compiler<'_>, Item<'t>) -> Option<Draft<'t>>>;

/// A kind of texture that has a name.
pub(super) type TextureMember = Member<fn(&mut Params<'_, '_>, &mut Sources<'_>) -> Option<NamedTexture>>;

/// A kind of medium.
pub(super) type MediumMember = Member<for<'t> fn(&mut Compiler<'_>, Item<'t>) -> Option<MediumId>>;

/// A shape; one that cannot be is reported at `item`.
pub(super) fn reported<T>(
    params: &mut Params<'_, '_>,
    shape: Option<T>,
    item: Item<'_>,
    message: &str,
) -> Option<T> {
    if shape.is_none() {
        params.diagnostics().push(Diagnostic::error(message).label(item.head_span(), "leaves no such shape"));
    }
    shape
}
