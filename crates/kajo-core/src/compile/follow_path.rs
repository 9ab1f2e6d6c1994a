//! `FollowPath`: an operation that brings things to a point of a path and turns them along it.
//!
//! Scene: `Transform { FollowPath { spline 0 0 0  2 0 1  4 0 0  progress (time / 8) }  Model { file train.glb } }`

use kajo_math::quadrature::gauss5;
use kajo_math::{DAffine3, DMat3, DVec3, fmath};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use super::paths::{self, Ends};
use crate::schema::{Absent, Block, Constant, FieldKind, FieldSpec, Kind, NumberRange};
use crate::shape::{Bezier, Path};

pub(super) const FOLLOW_PATH: &str = "FollowPath";

const PROGRESS: FieldSpec =
    field("progress", FieldKind::NUMBER, "0", "how far along the path, in parts of its length");
const FORWARD: FieldSpec =
    field("forward", FieldKind::Vector, "0 0 -1", "what of the thing points along the path");
const UP: FieldSpec = field("up", FieldKind::Vector, "0 1 0", "what is up, of the thing and of the world");
const BANK: FieldSpec = field(
    "bank",
    FieldKind::Angle { min: f64::MIN, max: f64::MAX },
    "0",
    "how far the thing leans to its right, as into a curve",
);
const TURN: FieldSpec = field("turn", FieldKind::Flag, "on", "whether the thing is turned at all");

/// The largest `progress` either way.
const MOST_ROUNDS: f64 = 1e6;

pub(super) const BLOCK: Block = Block {
    keyword: FOLLOW_PATH,
    kind: Kind::Part,
    about: "an operation that brings things to a point of a path and turns them along it",
    groups: &[&paths::fields(&[NumberRange::ANY; 3]), &[PROGRESS, FORWARD, UP, BANK, TURN]],
    parts: &[],
};

const fn field(key: &'static str, kind: FieldKind, usual: &'static str, about: &'static str) -> FieldSpec {
    FieldSpec { absent: Absent::Value(Constant::Text(usual)), about, ..FieldSpec::new(key, kind) }
}

/// The map of a block; `None` where a mistake was reported.
pub(super) fn read(item: Item<'_>, diagnostics: &mut Diagnostics) -> Option<DAffine3> {
    let mut params = Params::new(item, diagnostics);
    let path = paths::take(item, &mut params, Ends::Free, 3, |args| Ok(args.vec3()?.as_dvec3()));
    let progress = params.or(PROGRESS.key, 0.0, rounds);
    let forward = params.or(FORWARD.key, DVec3::NEG_Z, direction);
    let up = params.or(UP.key, DVec3::Y, direction);
    let bank = params.or(BANK.key, 0.0, Args::number);
    let turns = params.or(TURN.key, true, Args::flag);
    if !turns {
        params.idle(&[FORWARD.key, UP.key, BANK.key], "with `turn off`");
    } else if forward.cross(up).length_squared() < 1e-12 {
        params.warn(FORWARD.key, "`forward` and `up` are the same direction", "says too little");
    }
    params.finish();
    let path = path?;
    let Some(PathPosition { point, along }) = position(&path, progress) else {
        let error = Diagnostic::error(format!("the path of this `{FOLLOW_PATH}` has no length"));
        diagnostics.push(error.label(item.keyword_span(), "goes nowhere"));
        return None;
    };
    if !turns {
        return Some(DAffine3::from_translation(point));
    }
    let turn = axes(along, up) * leaning(f64::from(bank).to_radians()) * axes(forward, up).transpose();
    Some(DAffine3::from_mat3_translation(turn, point))
}

/// A share of a path, or so many rounds of it.
fn rounds(args: &mut Args<'_>) -> Result<f64, Diagnostic> {
    let found = args.double()?;
    let is_far = found.abs() > MOST_ROUNDS;
    if is_far {
        Err(args.error(format!("`progress` is at most {MOST_ROUNDS} either way")))
    } else {
        Ok(found)
    }
}

/// A direction of unit length.
fn direction(args: &mut Args<'_>) -> Result<DVec3, Diagnostic> {
    let found = args.vec3()?.as_dvec3();
    found.try_normalize().ok_or_else(|| args.error("a direction has a length above zero"))
}

/// A point of a path, and where it goes on to from there.
struct PathPosition {
    point: DVec3,
    /// Of unit length.
    along: DVec3,
}

/// The position after a share of a path's length; `None` where that is zero.
///
/// Paths that come back to where they began go on; others end.
fn position(path: &Path<DVec3>, progress: f64) -> Option<PathPosition> {
    let pieces: Vec<Bezier<DVec3>> =
        path.curves().iter().flat_map(|curve| curve.subdivided(LEVELS)).collect();
    let lengths: Vec<f64> = pieces.iter().map(|piece| length(piece, 1.0)).collect();
    let whole: f64 = lengths.iter().sum();
    if !(whole > 0.0 && whole.is_finite()) {
        return None;
    }
    let share = if path.is_closed() { progress - progress.floor() } else { progress.clamp(0.0, 1.0) };
    let (mut left, mut i) = (share * whole, 0);
    while i + 1 < pieces.len() && (left > lengths[i] || lengths[i] == 0.0) {
        left -= lengths[i];
        i += 1;
    }
    // Points repeated at the end have no direction.
    while lengths[i] == 0.0 {
        i -= 1;
        left = lengths[i];
    }
    let piece = &pieces[i];
    let (mut low, mut high) = (0.0, 1.0);
    let mut s = (left / lengths[i]).clamp(0.0, 1.0);
    for _ in 0..STEPS {
        let off = length(piece, s) - left;
        if off > 0.0 {
            high = s;
        } else {
            low = s;
        }
        let newton = s - off / piece.derivative(s).length();
        s = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
    }
    // At a cusp the direction is that of what is next to it.
    let chord = piece.end() - piece.start();
    let along = piece.derivative(s).try_normalize().or(chord.try_normalize())?;
    Some(PathPosition { point: piece.at(s), along })
}

/// Curves are halved this often.
const LEVELS: u32 = 5;

/// Steps of Newton's method, kept between bounds.
const STEPS: u32 = 12;

/// The length of a piece up to `s`.
fn length(piece: &Bezier<DVec3>, s: f64) -> f64 {
    gauss5(0.0, s, |s| piece.derivative(s).length())
}

/// Axes of unit length: to the right, up and backwards, of what looks along `forward`.
fn axes(forward: DVec3, up: DVec3) -> DMat3 {
    let right = forward.cross(up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
    DMat3::from_cols(right, right.cross(forward), -forward)
}

/// The turn of [`axes`] of what leans to its right.
fn leaning(angle: f64) -> DMat3 {
    let (sin, cos) = (fmath::sin64(angle), fmath::cos64(angle));
    DMat3::from_cols(DVec3::new(cos, -sin, 0.0), DVec3::new(sin, cos, 0.0), DVec3::Z)
}
