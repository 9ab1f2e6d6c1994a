//! Where lights are and shine, singly and in groups.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use kajo_math::{Aabb, Vec3, fmath};

/// Where a light or a group of them is, where it shines and how strong it is.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// A box around the positions that light comes from.
    pub bounds: Aabb,
    /// The middle of the axes around which light leaves.
    pub axis: Vec3,
    /// Cosine of the largest angle between `axis` and the axes.
    pub cos_spread: f32,
    /// Cosine of the largest angle between a position's own axis and the light that leaves it.
    pub cos_reach: f32,
    /// Whether light leaves against the axes as well.
    pub two_sided: bool,
    /// Power; of light that leaves into a narrow cone, that of a light as bright in all directions, since the cone is in the angles.
    pub power: f32,
    /// Whether its light falls off by the square of the distance, as is taken for granted of all.
    pub is_inverse_square: bool,
}

/// The directions around an axis.
#[derive(Clone, Copy, Debug)]
struct DirectionCone {
    axis: Vec3,
    /// Cosine of the largest angle between the axis and a direction.
    cos_spread: f32,
}

impl LightBounds {
    /// Bounds around both.
    pub(super) fn union(self, other: LightBounds) -> LightBounds {
        let DirectionCone { axis, cos_spread } = self.cone().union(other.cone());
        LightBounds {
            bounds: self.bounds.union(other.bounds),
            axis,
            cos_spread,
            cos_reach: self.cos_reach.min(other.cos_reach),
            two_sided: self.two_sided || other.two_sided,
            power: self.power + other.power,
            is_inverse_square: self.is_inverse_square && other.is_inverse_square,
        }
    }

    fn cone(&self) -> DirectionCone {
        DirectionCone { axis: self.axis, cos_spread: self.cos_spread }
    }

    /// The solid angle that light fills, weighted by the cosine at its edges, times power and area.
    pub(super) fn cost(&self) -> f32 {
        let spread = fmath::acos(self.cos_spread.clamp(-1.0, 1.0));
        let reach = fmath::acos(self.cos_reach.clamp(-1.0, 1.0));
        let (sin, cos) = fmath::sin_cos(spread);
        let w = (spread + reach).min(PI);
        let solid_angle = TAU * (1.0 - cos)
            + FRAC_PI_2 * (2.0 * w * sin - fmath::cos(spread - 2.0 * w) - 2.0 * spread * sin + cos);
        self.power * solid_angle * self.bounds.half_area().max(f32::MIN_POSITIVE)
    }
}

impl DirectionCone {
    /// A cone around both.
    fn union(self, other: DirectionCone) -> DirectionCone {
        let (a, b) = (self.axis, other.axis);
        let angle = |cos: f32| fmath::acos(cos.clamp(-1.0, 1.0));
        let (spread_a, spread_b) = (angle(self.cos_spread), angle(other.cos_spread));
        let between = angle(a.dot(b));
        if (between + spread_b).min(PI) <= spread_a {
            return self;
        }
        if (between + spread_a).min(PI) <= spread_b {
            return other;
        }
        let spread = 0.5 * (spread_a + between + spread_b);
        let turn_around = a.cross(b).normalize_or_zero();
        if spread >= PI || turn_around == Vec3::ZERO {
            return DirectionCone { axis: a, cos_spread: -1.0 };
        }
        // Turn the first axis towards the second until both cones fit.
        let (sin, cos) = fmath::sin_cos(spread - spread_a);
        let axis = (cos * a + sin * turn_around.cross(a)).normalize_or(a);
        DirectionCone { axis, cos_spread: fmath::cos(spread) }
    }
}
