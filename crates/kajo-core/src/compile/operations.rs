//! The operations of `Transform` blocks.
//!
//! The matrix starts as the identity. Each operation multiplies it from the right, so that the
//! last one listed acts on the object first; `Matrix` multiplies from the left.

use kajo_math::{DAffine3, DMat3, DVec3, fmath};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item};

use super::follow_path::{self, FOLLOW_PATH};
use crate::schema::{Absent, Constant, FieldKind, FieldSpec, NumberRange};

/// An operation of a `Transform`.
struct Operation {
    spec: FieldSpec,
    /// Takes the map, whose numbers may be ordered by rows.
    read: fn(&mut Args<'_>, bool) -> Result<DAffine3, Diagnostic>,
    /// Whether it is multiplied from the left.
    from_left: bool,
}

impl Operation {
    const fn new(
        key: &'static str,
        kind: FieldKind,
        nothing: &'static str,
        about: &'static str,
        read: fn(&mut Args<'_>, bool) -> Result<DAffine3, Diagnostic>,
    ) -> Operation {
        let absent = Absent::Value(Constant::Text(nothing));
        Operation {
            spec: FieldSpec { absent, repeats: true, about, ..FieldSpec::new(key, kind) },
            read,
            from_left: false,
        }
    }

    /// A turn about one of the axes of the world.
    const fn turn(
        key: &'static str,
        about: &'static str,
        read: fn(&mut Args<'_>, bool) -> Result<DAffine3, Diagnostic>,
    ) -> Operation {
        Operation::new(key, FieldKind::Angle { min: f64::MIN, max: f64::MAX }, "0", about, read)
    }

    const fn matrix(key: &'static str) -> Operation {
        let identity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
        let about = "any affine map, column by column unless the dialect has rows";
        let operation =
            Operation::new(key, FieldKind::Numbers(&[NumberRange::ANY; 16]), identity, about, matrix);
        Operation { from_left: true, ..operation }
    }
}

/// All operations; there may be several of each, and their order counts.
const ALL: [Operation; 9] = [
    Operation::new("Translate", FieldKind::Vector, "0 0 0", "moves", |args, _| {
        args.vec3().map(|t| DAffine3::from_translation(t.as_dvec3()))
    }),
    Operation::turn("XRotate", "turns about the x axis", |args, _| {
        args.number().map(|deg| rotation([1.0, 0.0, 0.0, deg]))
    }),
    Operation::turn("YRotate", "turns about the y axis", |args, _| {
        args.number().map(|deg| rotation([0.0, 1.0, 0.0, deg]))
    }),
    Operation::turn("ZRotate", "turns about the z axis", |args, _| {
        args.number().map(|deg| rotation([0.0, 0.0, 1.0, deg]))
    }),
    Operation::new(
        "Rotate",
        FieldKind::Numbers(&[NumberRange::ANY; 4]),
        "0 1 0 0",
        "turns about an axis: x y z degrees",
        |args, _| args.numbers().map(rotation),
    ),
    Operation::new("Scale", FieldKind::Vector, "1 1 1", "scales along the axes", |args, _| {
        args.vec3().map(|s| DAffine3::from_scale(s.as_dvec3()))
    }),
    Operation::new("UniformScale", FieldKind::NUMBER, "1", "scales equally", |args, _| {
        args.number().map(|s| DAffine3::from_scale(DVec3::splat(s.into())))
    }),
    Operation::matrix("Matrix"),
    Operation::matrix("Matrix4f"),
];

/// The descriptions of the operations.
pub(super) const FIELDS: &[FieldSpec] = &{
    let mut specs = [ALL[0].spec; ALL.len()];
    let mut i = 1;
    while i < ALL.len() {
        specs[i] = ALL[i].spec;
        i += 1;
    }
    specs
};

/// The word of a block that moves its objects.
pub(super) const MOTION: &str = "Motion";

/// Words for operations of a `Transform`.
pub const OPERATIONS: [&str; ALL.len()] = words([]);

/// Words for operations that are blocks, which stand where things may move.
pub const BLOCK_OPERATIONS: [&str; 2] = [MOTION, FOLLOW_PATH];

/// Words for operations where things may move as well.
pub(super) const MOVING_OPERATIONS: [&str; ALL.len() + BLOCK_OPERATIONS.len()] = words(BLOCK_OPERATIONS);

/// The words of the operations, and then others.
const fn words<const N: usize, const M: usize>(others: [&'static str; M]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut at = 0;
    while at < M {
        words[ALL.len() + at] = others[at];
        at += 1;
    }
    let mut i = 0;
    while i < ALL.len() {
        words[i] = FIELDS[i].key;
        i += 1;
    }
    words
}

/// Whether an operation multiplies from the left.
pub(super) fn is_from_left(item: Item<'_>) -> bool {
    ALL.iter().any(|operation| operation.from_left && operation.spec.key == item.keyword())
}

/// `m` after one operation; a faulty one is reported and changes nothing.
///
/// * `by_rows`: how the numbers of `Matrix` are ordered
pub(super) fn apply(m: DAffine3, item: Item<'_>, by_rows: bool, diagnostics: &mut Diagnostics) -> DAffine3 {
    if item.keyword() == FOLLOW_PATH {
        return m * follow_path::read(item, diagnostics).unwrap_or(DAffine3::IDENTITY);
    }
    let Some(operation) = ALL.iter().find(|operation| operation.spec.key == item.keyword()) else { return m };
    let map = Args::read(item, diagnostics, |args| (operation.read)(args, by_rows));
    let map = map.unwrap_or(DAffine3::IDENTITY);
    if operation.from_left { map * m } else { m * map }
}

/// The sixteen numbers of a matrix, whose last row is left aside.
fn matrix(args: &mut Args<'_>, by_rows: bool) -> Result<DAffine3, Diagnostic> {
    let m = args.numbers::<16>()?.map(f64::from);
    let column = |i: usize| match by_rows {
        true => DVec3::new(m[i], m[4 + i], m[8 + i]),
        false => DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]),
    };
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
