//! `Isosurface`: where a function is zero.

use std::sync::Arc;

use kajo_math::Vec3;
use kajo_math::tape::Tape;
use kajo_scene::{Diagnostic, Params};

use crate::compile::fields::{Keys, Sources, flag, function, keys, point};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::Isosurface;

keys! {
    IsosurfaceKeys {
        function: Arc<Tape> = function("function").required("negative inside, zero at the surface"),
        min: Vec3 = point("min").or([-1.0; 3], "the corner of its box with the smallest coordinates"),
        max: Vec3 = point("max").or([1.0; 3], "the corner of its box with the largest coordinates"),
        closed: bool = flag("closed").or(true, "whether faces of the box close it where they cut it"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Isosurface",
        kind: Kind::Shape,
        about: "the surface where a function is zero, in a box",
        groups: &[IsosurfaceKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Isosurface> {
    let IsosurfaceKeys { function, min, max, closed } = IsosurfaceKeys::read(params, sources)?;
    surface(params, function, [min, max], closed)
}

/// The surface of a function in a box, with what there is to be said of it.
pub(super) fn surface(
    params: &mut Params<'_, '_>,
    function: Arc<Tape>,
    [min, max]: [Vec3; 2],
    closed: bool,
) -> Option<Isosurface> {
    let Some(surface) = Isosurface::new(function, min, max, closed) else {
        let error = Diagnostic::error("every coordinate of `min` must be less than that of `max`");
        params.report(error, "the box of this is empty");
        return None;
    };
    if surface.is_empty() {
        let warning = Diagnostic::warning("there is no surface in the box from `min` to `max`");
        let help = "the function has one sign there: a larger box may help, or another sign";
        params.report(warning.help(help), "nothing is to be seen of this");
    }
    Some(surface)
}
