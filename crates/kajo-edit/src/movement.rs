//! Movements: what a hand does to a thing in space.

use kajo_math::{DAffine3, DMat3, DQuat, DVec3, fmath};

/// A change of place, direction or size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Movement {
    /// By this much.
    Translate(DVec3),
    /// Around an axis, anticlockwise when it points at you.
    Rotate {
        /// A point on the axis.
        center: DVec3,
        /// A unit vector along it.
        axis: DVec3,
        /// How far.
        degrees: f64,
    },
    /// Along three axes.
    Scale {
        /// What stays where it is.
        center: DVec3,
        /// Perpendicular unit vectors as columns.
        axes: DMat3,
        /// A factor for each of them.
        factors: DVec3,
    },
    /// Any map with an inverse.
    Map(DAffine3),
}

/// What a linear map does to shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Linear {
    Identity,
    /// Turns, and scales equally by this factor; does not mirror.
    Similar(f64),
    /// Scales along the coordinate axes, each by a positive factor.
    Aligned,
    /// Anything else that does not mirror.
    Direct,
    /// Mirrors.
    Mirrored,
}

/// How far from exact the parts of a matrix may be.
const TOLERANCE: f64 = 1e-9;

impl Movement {
    /// The map from places before to places after.
    pub fn map(&self) -> DAffine3 {
        let around = |center: DVec3, m: DMat3| DAffine3 { matrix3: m, translation: center - m * center };
        match *self {
            Movement::Translate(by) => DAffine3::from_translation(by),
            Movement::Rotate { center, axis, degrees } => {
                around(center, DMat3::from_quat(turn(axis, degrees)))
            }
            Movement::Scale { center, axes, factors } => {
                around(center, axes * DMat3::from_diagonal(factors) * axes.transpose())
            }
            Movement::Map(map) => map,
        }
    }

    /// The same movement as it is seen in a space that `outer_from_inner` leads from; `None` when that has no inverse.
    pub(super) fn within(&self, outer_from_inner: &DAffine3) -> Option<Movement> {
        let (p, linear) = (outer_from_inner, outer_from_inner.matrix3);
        if linear.determinant() == 0.0 || !p.is_finite() {
            return None;
        }
        let inverse = p.inverse();
        let general = || Movement::Map(inverse * self.map() * *p);
        Some(match *self {
            Movement::Translate(by) => Movement::Translate(inverse.matrix3 * by),
            Movement::Rotate { center, axis, degrees } => match as_scaled_rotation(&linear) {
                Some(_) => {
                    let axis = (inverse.matrix3 * axis).normalize() * linear.determinant().signum();
                    Movement::Rotate { center: inverse.transform_point3(center), axis, degrees }
                }
                None => general(),
            },
            Movement::Scale { center, axes, factors } => {
                let center = inverse.transform_point3(center);
                if factors.x == factors.y && factors.x == factors.z {
                    return Some(Movement::Scale { center, axes: DMat3::IDENTITY, factors });
                }
                let m = inverse.matrix3 * axes;
                let axes = DMat3::from_cols(m.x_axis.normalize(), m.y_axis.normalize(), m.z_axis.normalize());
                match is_orthonormal(&axes) {
                    true => Movement::Scale { center, axes, factors },
                    false => general(),
                }
            }
            Movement::Map(_) => general(),
        })
    }

    /// Whether it moves nothing.
    pub(super) fn is_nothing(&self) -> bool {
        self.map().abs_diff_eq(DAffine3::IDENTITY, 1e-12)
    }

    /// What it does besides moving the origin.
    pub(super) fn linear(&self) -> Linear {
        let m = self.map().matrix3;
        let off_diagonal = m.abs() - DMat3::from_diagonal(m.diagonal()).abs();
        let largest = |m: DMat3| m.x_axis.max(m.y_axis).max(m.z_axis).max_element();
        let scale = largest(m.abs()).max(f64::MIN_POSITIVE);
        if m.determinant() <= 0.0 {
            Linear::Mirrored
        } else if m.abs_diff_eq(DMat3::IDENTITY, TOLERANCE) {
            Linear::Identity
        } else if let Some(factor) = as_scaled_rotation(&m) {
            Linear::Similar(factor)
        } else if largest(off_diagonal) < TOLERANCE * scale && m.diagonal().min_element() > 0.0 {
            Linear::Aligned
        } else {
            Linear::Direct
        }
    }
}

/// The factor of a map that turns, perhaps mirrors, and scales equally; `None` for others.
fn as_scaled_rotation(m: &DMat3) -> Option<f64> {
    let scale = m.x_axis.length();
    (scale > 0.0 && is_orthonormal(&(*m * (1.0 / scale)))).then_some(scale)
}

fn is_orthonormal(m: &DMat3) -> bool {
    (m.transpose() * *m).abs_diff_eq(DMat3::IDENTITY, TOLERANCE)
}

/// The turn around a unit axis.
pub(super) fn turn(axis: DVec3, degrees: f64) -> DQuat {
    let half = 0.5 * degrees.to_radians();
    let v = fmath::sin64(half) * axis;
    DQuat::from_xyzw(v.x, v.y, v.z, fmath::cos64(half))
}

/// The unit axis and the angle in degrees, in [0, 180], of a turn.
pub(super) fn axis_and_angle(turn: DQuat) -> (DVec3, f64) {
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let (v, sin) = (turn.xyz(), turn.xyz().length());
    let degrees = 2.0 * sin.atan2(turn.w).to_degrees();
    (v.try_normalize().unwrap_or(DVec3::Y), degrees)
}
