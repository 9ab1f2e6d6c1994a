//! `BicubicPatch`: a Bézier patch of sixteen control points.

use kajo_math::Vec3;
use kajo_scene::{Args, Diagnostic, Params};

use crate::compile::fields::{At, Keys, Plain, Sources, Typed, keys};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::schema::{Block, FieldKind, FieldSpec, Kind, NumberRange};
use crate::shape::BicubicPatch;

/// Four control points.
struct Row([Vec3; 4]);

impl Plain<'_> for Row {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Row, Diagnostic> {
        let numbers: [f32; 12] = args.numbers()?;
        let point = |k: usize| Vec3::from_slice(&numbers[3 * k..]);
        Ok(Row([0, 1, 2, 3].map(point)))
    }
}

const fn row(key: &'static str) -> Typed<Row> {
    Typed::new(key, FieldKind::Numbers(&[NumberRange::ANY; 12]))
}

keys! {
    BicubicPatchKeys<'t> {
        row0: Row = row("row0").required("four control points, from (u, v) = (0, 0) to (1, 0)"),
        row1: Row = row("row1").required("the next four"),
        row2: Row = row("row2").required("the next four"),
        row3: At<'t, Row> = row("row3").placed().required("the last four, from (0, 1) to (1, 1)"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "BicubicPatch",
        kind: Kind::Shape,
        about: "a Bézier patch of sixteen control points",
        groups: &[BicubicPatchKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<BicubicPatch> {
    let BicubicPatchKeys { row0, row1, row2, row3 } = BicubicPatchKeys::read(params, sources)?;
    let patch = BicubicPatch::new([row0.0, row1.0, row2.0, row3.value.0]);
    reported(params, patch, row3.item, "the control points of a patch must not all be on one line")
}
