//! `Transform` blocks: their operations as one matrix.
//!
//! The matrix starts as the identity. Each operation multiplies it from the right, so that the
//! last one listed acts on the object first; `Matrix` multiplies from the left.

use kajo_math::{Affine3A, DAffine3, DMat3, DVec3, fmath};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use super::motion;

/// Words for operations of a `Transform`.
pub const OPERATIONS: [&str; 9] =
    ["Matrix", "Matrix4f", "Rotate", "Scale", "Translate", "UniformScale", "XRotate", "YRotate", "ZRotate"];

/// Words for operations where things may move as well.
pub(super) const MOVING_OPERATIONS: [&str; 10] = [
    "Matrix",
    "Matrix4f",
    "Motion",
    "Rotate",
    "Scale",
    "Translate",
    "UniformScale",
    "XRotate",
    "YRotate",
    "ZRotate",
];

/// `m` after one operation; a faulty one is reported and changes nothing.
///
/// * `by_rows`: how the numbers of `Matrix` are ordered
pub(super) fn apply(m: DAffine3, item: Item<'_>, by_rows: bool, diagnostics: &mut Diagnostics) -> DAffine3 {
    let mut read = |reader: fn(&mut Args<'_>) -> Result<DAffine3, Diagnostic>| {
        Args::read(item, diagnostics, reader).unwrap_or(DAffine3::IDENTITY)
    };
    match item.keyword() {
        "Matrix" | "Matrix4f" if by_rows => read(rows) * m,
        "Matrix" | "Matrix4f" => read(columns) * m,
        "Rotate" => m * read(|args| args.numbers().map(rotation)),
        "Scale" => m * read(|args| args.vec3().map(|s| DAffine3::from_scale(s.as_dvec3()))),
        "Translate" => m * read(|args| args.vec3().map(|t| DAffine3::from_translation(t.as_dvec3()))),
        "UniformScale" => {
            m * read(|args| args.number().map(|s| DAffine3::from_scale(DVec3::splat(s.into()))))
        }
        "XRotate" => m * read(|args| args.number().map(|deg| rotation([1.0, 0.0, 0.0, deg]))),
        "YRotate" => m * read(|args| args.number().map(|deg| rotation([0.0, 1.0, 0.0, deg]))),
        "ZRotate" => m * read(|args| args.number().map(|deg| rotation([0.0, 0.0, 1.0, deg]))),
        _ => m,
    }
}

/// The product of those items of a block that are operations; faulty ones are left out. What moves is taken as it is at
/// time 0.
///
/// * `by_rows`: see [`crate::settings::Rules::matrix_by_rows`]
pub fn operations_matrix<'a>(items: impl Iterator<Item = Item<'a>>, by_rows: bool) -> DAffine3 {
    let mut unheard = Diagnostics::new();
    items.fold(DAffine3::IDENTITY, |m, item| match item.keyword() {
        "Motion" => motion::read(item, by_rows, &mut unheard).map_or(m, |keys| m * keys.at(0.0)),
        _ => apply(m, item, by_rows, &mut unheard),
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

fn columns(args: &mut Args<'_>) -> Result<DAffine3, Diagnostic> {
    let m = args.numbers::<16>()?.map(f64::from);
    let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    Ok(DAffine3::from_cols(column(0), column(1), column(2), column(3)))
}

fn rows(args: &mut Args<'_>) -> Result<DAffine3, Diagnostic> {
    let m = args.numbers::<16>()?.map(f64::from);
    let column = |i: usize| DVec3::new(m[i], m[4 + i], m[8 + i]);
    Ok(DAffine3::from_cols(column(0), column(1), column(2), column(3)))
}

/// Rodrigues' formula `cos I + sin [a]x + (1 - cos) a a^T`, with the axis as it stands: one
/// that is not of unit length gives a map that is no rotation, as in the reference program.
fn rotation([x, y, z, degrees]: [f32; 4]) -> DAffine3 {
    let (a, angle) = (DVec3::new(x.into(), y.into(), z.into()), f64::from(degrees).to_radians());
    let (sin, cos) = (fmath::sin64(angle), fmath::cos64(angle));
    let column = |e: DVec3| cos * e + sin * a.cross(e) + (1.0 - cos) * a.dot(e) * a;
    DAffine3::from_mat3(DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)))
}
