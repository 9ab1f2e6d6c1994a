//! `Transform` blocks: their operations as one matrix.

use kajo_math::{Affine3A, DAffine3};
use kajo_scene::{Diagnostics, Item, Params};

use super::motion;
use super::operations::{self, MOTION, OPERATIONS, apply};
use crate::schema::{Block, Kind};

/// The operations that place what they stand in.
pub(super) const PLACEMENT: Block = Block {
    keyword: "Transform",
    kind: Kind::Part,
    about: "operations that place the pattern around them",
    groups: &[operations::FIELDS],
    parts: &[],
};

/// The product of those items of a block that are operations; faulty ones are left out. What moves is taken as it is at
/// time 0.
///
/// * `by_rows`: see [`crate::settings::Rules::matrix_by_rows`]
pub fn operations_matrix<'a>(items: impl Iterator<Item = Item<'a>>, by_rows: bool) -> DAffine3 {
    let mut unheard = Diagnostics::new();
    items.fold(DAffine3::IDENTITY, |m, item| match item.keyword() == MOTION {
        true => motion::read(item, by_rows, 0.0, &mut unheard).map_or(m, |keys| m * keys.at(0.0)),
        false => apply(m, item, by_rows, &mut unheard),
    })
}

/// The matrix of a `Transform` that holds operations only.
pub(super) fn read_alone(item: Item<'_>, by_rows: bool, diagnostics: &mut Diagnostics) -> Option<Affine3A> {
    let mut params = Params::new(item, diagnostics);
    let operations = params.take(&OPERATIONS);
    params.finish();
    let apply = |m, item| apply(m, item, by_rows, diagnostics);
    let m = operations.into_iter().fold(DAffine3::IDENTITY, apply);
    Some(Affine3A::from_cols(
        m.matrix3.x_axis.as_vec3a(),
        m.matrix3.y_axis.as_vec3a(),
        m.matrix3.z_axis.as_vec3a(),
        m.translation.as_vec3a(),
    ))
}
