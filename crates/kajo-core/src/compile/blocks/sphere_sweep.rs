//! `SphereSweep`: balls along paths.

use kajo_math::{DVec3, DVec4};
use kajo_scene::{Args, Diagnostic, Item, Params};

use crate::compile::member::{Member, ObjectMember, reported};
use crate::compile::paths::{self, Ends};
use crate::schema::{Block, Kind, NumberRange};
use crate::shape::{Path, SphereSweep};

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "SphereSweep",
        kind: Kind::Shape,
        about: "all balls along paths, whose radii change on the way",
        groups: &[],
        parts: &[&PATH],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, |params, _| read(item, params)),
};

pub const PATH: Block = Block {
    keyword: "path",
    kind: Kind::Part,
    about: "a path of the balls of a sweep",
    groups: &[&paths::fields(&[
        NumberRange::ANY,
        NumberRange::ANY,
        NumberRange::ANY,
        NumberRange::NOT_NEGATIVE,
    ])],
    parts: &[],
};

fn read<'t>(item: Item<'t>, params: &mut Params<'t, '_>) -> Option<SphereSweep> {
    let items = params.take(&[PATH.keyword]);
    if items.is_empty() {
        params.report_missing(PATH.keyword);
    }
    let paths: Vec<Option<Path<DVec4>>> =
        items.iter().map(|&item| paths::read(item, params.diagnostics(), Ends::Free, 4, ball)).collect();
    let paths = paths.into_iter().collect::<Option<Vec<_>>>().filter(|paths| !paths.is_empty())?;
    reported(params, SphereSweep::new(&paths), item, "no ball of this sweep has a radius")
}

/// A middle, and a radius that is not negative.
fn ball(args: &mut Args<'_>) -> Result<DVec4, Diagnostic> {
    let middle: DVec3 = args.vec3()?.as_dvec3();
    Ok(middle.extend(args.number_in(0.0..)?.into()))
}
