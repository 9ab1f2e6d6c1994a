//! Bodies that are the two mouths of a wormhole.
//!
//! Around each of two places there is a ball in which space is curved; their middles are one throat, so that light that goes into the
//! one comes out of the other ([`kajo_math::gravity::Wormhole`]). Both balls are filled with this medium, and are one body to
//! whoever keeps account of what light is inside of: a `Merge`. In a body that is only one of them light is lost.
//!
//! The metric is still, and clocks agree: nothing is shifted in frequency.
//!
//! Scene: `Media { Wormhole gate { mouth 0 0 0  other 20 0 0  throat 1  radius 4 } }`

use kajo_math::gravity::{Profile, Wormhole};
use kajo_math::{DMat3, DQuat, DVec3, Vec3};

use super::bending::only_bends_light;
use super::{Coefficients, Medium};
use crate::curved_light::{RayEquation, RayState, Region, momentum, position};

/// The space of both mouths of a wormhole.
#[derive(Clone, Debug)]
pub struct WormholeMedium {
    mouth: Wormhole,
    centers: [DVec3; 2],
    /// Along which light goes on from the other mouth as it came into the first one, in the world of the first.
    forwards: DVec3,
    /// Turns the world of the first mouth to that of the other.
    turn: DQuat,
    coefficients: Coefficients,
}

/// What a wormhole is made by.
#[derive(Clone, Copy, Debug)]
pub struct WormholeShape {
    /// Middles of its mouths, in world space.
    pub centers: [Vec3; 2],
    /// Radius of the throat.
    pub throat: f32,
    /// Length of the throat.
    pub length: f32,
    /// Radius of the ball around each mouth.
    pub radius: f32,
    /// How the throat widens: the film's parameter, or 0 for Ellis's wormhole.
    pub width: f32,
    /// Light that enters the first mouth in the one direction, towards its middle, leaves the other mouth in the other direction.
    pub directions: [Vec3; 2],
    /// What is up on both sides.
    pub up: Vec3,
}

/// A mistake in a wormhole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WormholeError {
    /// A radius, length or width is negative, zero where it must not be, or not finite; or the radius is no more than the throat's.
    Size,
    /// The balls overlap.
    Overlap,
    /// A direction is zero, or along `up`.
    Direction,
}

impl std::fmt::Display for WormholeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            WormholeError::Size => {
                "the `throat` of a wormhole is more than 0, and `radius` is more than that; `length` and `width` are not negative"
            }
            WormholeError::Overlap => "the mouths of a wormhole are at least twice its `radius` apart",
            WormholeError::Direction => "the directions of a wormhole are neither zero nor along `up`",
        })
    }
}

impl std::error::Error for WormholeError {}

impl WormholeMedium {
    /// # Errors
    ///
    /// [`WormholeError`].
    pub fn new(shape: &WormholeShape) -> Result<WormholeMedium, WormholeError> {
        let WormholeShape { throat, length, radius, width, .. } = *shape;
        let finite = [throat, length, radius, width].iter().all(|v| v.is_finite() && *v >= 0.0);
        if !finite || throat <= 0.0 || radius <= throat * (1.0 + 1e-3) || radius > 1e6 * throat {
            return Err(WormholeError::Size);
        }
        let centers = shape.centers.map(|p| p.as_dvec3());
        if centers[0].distance(centers[1]) < 2.0 * f64::from(radius) {
            return Err(WormholeError::Overlap);
        }
        let axes = shape.directions.map(|d| axes(d.as_dvec3(), shape.up.as_dvec3()));
        let [Some(before), Some(after)] = axes else { return Err(WormholeError::Direction) };
        let profile = if width == 0.0 { Profile::Ellis } else { Profile::Gradual(width.into()) };
        Ok(WormholeMedium {
            mouth: Wormhole::new(throat.into(), length.into(), profile, radius.into()),
            centers,
            forwards: before.z_axis,
            turn: DQuat::from_mat3(&(after * before.transpose())).normalize(),
            coefficients: Coefficients::clear(),
        })
    }

    fn rays(&self, region: &Region) -> ThroatRays<'_> {
        let holds = |center: &DVec3| region.bounds.contains(center.as_vec3());
        ThroatRays { medium: self, is_whole: self.centers.iter().all(holds) }
    }

    /// The mouth that a world-space point is nearer to, and the point seen from its middle.
    #[inline]
    fn local(&self, p: DVec3) -> (usize, DVec3) {
        let [a, b] = self.centers.map(|center| p - center);
        if a.length_squared() <= b.length_squared() { (0, a) } else { (1, b) }
    }
}

/// A right-handed frame whose last axis is a direction and whose second one is as nearly up as may be.
fn axes(d: DVec3, up: DVec3) -> Option<DMat3> {
    let z = d.try_normalize()?;
    let x = up.cross(z).try_normalize().filter(|_| up.normalize_or_zero().cross(z).length() > 1e-6)?;
    Some(DMat3::from_cols(x, z.cross(x), z))
}

/// The law of rays in a body, which ought to hold both mouths.
#[derive(Clone, Copy, Debug)]
struct ThroatRays<'a> {
    medium: &'a WormholeMedium,
    is_whole: bool,
}

impl std::ops::Deref for ThroatRays<'_> {
    type Target = WormholeMedium;

    fn deref(&self) -> &WormholeMedium {
        self.medium
    }
}

impl RayEquation for ThroatRays<'_> {
    fn start(&self, p: DVec3, d: DVec3) -> Option<RayState> {
        if !self.is_whole {
            return None;
        }
        let (_, x) = self.local(p);
        let n = self.mouth.index_squared(x.length_squared()).0.sqrt();
        let m = n * d.normalize();
        n.is_finite().then_some([p.x, p.y, p.z, m.x, m.y, m.z, 0.0, 0.0])
    }

    #[inline]
    fn slope(&self, y: &RayState) -> RayState {
        let (_, x) = self.local(position(y));
        let p = momentum(y);
        let (n2, gradient) = self.mouth.index_squared(x.length_squared());
        let force = gradient * x;
        [p.x, p.y, p.z, force.x, force.y, force.z, n2, n2]
    }

    fn corrected(&self, y: &RayState) -> RayState {
        let (_, x) = self.local(position(y));
        let p = momentum(y);
        let ratio = self.mouth.index_squared(x.length_squared()).0 / p.length_squared();
        if (ratio - 1.0).abs() < 1e-13 || !ratio.is_finite() {
            return *y;
        }
        let p = ratio.sqrt() * p;
        [y[0], y[1], y[2], p.x, p.y, p.z, y[6], y[7]]
    }

    fn conserved(&self, y: &RayState) -> [Option<(&'static str, f64)>; 3] {
        let (_, x) = self.local(position(y));
        [Some(("angular momentum", x.cross(momentum(y)).length())), None, None]
    }

    fn has_gate(&self) -> bool {
        true
    }

    fn before_gate(&self, y: &RayState) -> f64 {
        let (_, x) = self.local(position(y));
        let throat = self.mouth.throat_in_chart();
        x.length_squared() - throat * throat
    }

    fn through_gate(&self, y: &RayState) -> Option<RayState> {
        let (mouth, x) = self.local(position(y));
        // From the other mouth the turn is undone, and the direction is the one that it was turned to.
        let (forwards, turn) = match mouth {
            0 => (self.forwards, self.turn),
            _ => (self.turn * self.forwards, self.turn.conjugate()),
        };
        let passage = self.mouth.passed(x, momentum(y), forwards, turn)?;
        let p = self.centers[1 - mouth] + passage.x;
        let m = passage.p;
        let [length, time] = [y[6], y[7]].map(|way| way + passage.length);
        Some([p.x, p.y, p.z, m.x, m.y, m.z, length, time])
    }
}

impl Medium for WormholeMedium {
    fn is_finite(&self) -> bool {
        self.centers.iter().all(|p| p.is_finite())
    }

    only_bends_light!(|medium, region, _wavelengths| medium.rays(region));
}

#[cfg(test)]
mod tests {
    use kajo_color::Wavelengths;
    use kajo_math::gravity::schwarzschild::elliptic_f;
    use kajo_math::{Aabb, Ray};

    use super::*;
    use crate::curved_light::{Chords, Outcome};

    /// Nothing in the way.
    struct Empty;

    impl Chords for Empty {
        fn hit(&mut self, _chord: &Ray) -> Option<f32> {
            None
        }
    }

    const SHAPE: WormholeShape = WormholeShape {
        centers: [Vec3::ZERO, Vec3::new(20.0, 0.0, 0.0)],
        throat: 1.0,
        length: 0.0,
        radius: 3.0,
        width: 0.0,
        directions: [Vec3::NEG_Z, Vec3::NEG_Z],
        up: Vec3::Y,
    };

    #[test]
    fn light_goes_on_from_the_other_mouth() {
        let wormhole = WormholeMedium::new(&SHAPE).expect("a wormhole");
        let region = Region { bounds: Aabb { min: Vec3::splat(-3.0), max: Vec3::new(23.0, 3.0, 3.0) } };
        for b in [0.0f64, 0.2, 0.4, -0.4, 0.8] {
            let o = Vec3::new(0.0, b as f32, (9.0 - b * b).sqrt() as f32);
            let ray = Ray::new(o, Vec3::NEG_Z);
            let way = wormhole.follow(&ray, None, &region, &Wavelengths::RGB, &mut Empty).expect("it bends");
            assert_eq!(way.outcome, Outcome::Leaves);
            let k = b.abs();
            let swept = 2.0 * k * (elliptic_f(1.0, k * k) - elliptic_f(1.0 / 3.0, k * k));
            let angle = (swept + 2.0 * (k / 3.0).asin()).copysign(b);
            let expected = DVec3::new(0.0, angle.sin(), -angle.cos());
            // Light has left the ball at its box, outside of which it is not straight in this test.
            assert!(way.d.distance(expected) < 0.02, "{b}: {} instead of {expected}", way.d);
        }
    }
}
