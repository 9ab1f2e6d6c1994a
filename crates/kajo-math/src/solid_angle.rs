//! Flat shapes as a point sees them: solid angles, and directions uniform over them.
//!
//! * triangle: `tan(A/2) = |a.(b x c)| / (1 + a.b + b.c + c.a)` for unit vectors `a`, `b`, `c` to the corners
//!   [Van Oosterom and Strackee 1983]; directions by [Arvo 1995]
//! * rectangle: [Ureña et al. 2013], with angles from products so that flat views keep their digits
//! * cap: the cone of directions to a sphere
//!
//! All in double precision: solid angles are sums that cancel. A light of 1e-7 sr is a difference of angles of a few radians, of which
//! single precision leaves nothing.

use std::f64::consts::{PI, TAU};

use crate::{DVec3, Vec2, fmath};

/// A triangle on the unit sphere.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    a: DVec3,
    b: DVec3,
    c: DVec3,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle with these corners as seen from `from`; `None` when it is seen edge on or from a corner.
    pub fn new(from: DVec3, corners: [DVec3; 3]) -> Option<SphericalTriangle> {
        let [a, b, c] = corners.map(|p| (p - from).normalize_or_zero());
        let det = a.dot(b.cross(c)).abs();
        let solid_angle = 2.0 * fmath::atan2_64(det, 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        (det > 0.0).then_some(SphericalTriangle { a, b, c, solid_angle })
    }

    /// Solid angle in steradians, positive.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A unit direction uniform over the triangle, from `u` in [0, 1)^2.
    pub fn sample(&self, u: Vec2) -> DVec3 {
        let SphericalTriangle { a, b, c, solid_angle } = *self;
        let (ab, ac) = (a.cross(b), a.cross(c));
        let alpha = fmath::atan2_64(a.dot(b.cross(c)).abs(), ab.dot(ac));
        let (sin_alpha, cos_alpha) = (fmath::sin64(alpha), fmath::cos64(alpha));
        // The sub-triangle of the asked share of the area has its third corner on the arc from a to c.
        let angle = f64::from(u.x) * solid_angle - alpha;
        let (s, t) = (fmath::sin64(angle), fmath::cos64(angle));
        let (p, q) = (t - cos_alpha, s + sin_alpha * a.dot(b));
        let cos_arc = ((q * t - p * s) * cos_alpha - q) / ((q * s + p * t) * sin_alpha);
        let cos_arc = if cos_arc.is_nan() { 1.0 } else { cos_arc.clamp(-1.0, 1.0) };
        let corner = along(a, c, cos_arc);
        along(b, corner, 1.0 - f64::from(u.y) * (1.0 - corner.dot(b)))
    }
}

/// The unit vector at an angle of the given cosine from `from` towards `to`.
fn along(from: DVec3, to: DVec3, cos: f64) -> DVec3 {
    let across = (to - to.dot(from) * from).normalize_or_zero();
    cos * from + (1.0 - cos * cos).max(0.0).sqrt() * across
}

/// A rectangle in space.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    corner: DVec3,
    edges: [DVec3; 2],
    /// Unit vectors along the edges, and across: the first times the second.
    axes: [DVec3; 3],
    lengths: [f64; 2],
    middle: DVec3,
    /// The square of a diagonal.
    extent2: f64,
    area: f64,
}

impl Rectangle {
    /// The rectangle at `corner` between two edges; `None` where these are not perpendicular up to rounding, or too
    /// short to have directions.
    pub fn new(corner: DVec3, edges: [DVec3; 2]) -> Option<Rectangle> {
        let lengths = edges.map(DVec3::length);
        let [x, y] = [edges[0] / lengths[0], edges[1] / lengths[1]];
        let is_right = x.dot(y).abs() <= 1e-6;
        (is_right && corner.is_finite()).then(|| Rectangle {
            corner,
            edges,
            axes: [x, y, x.cross(y)],
            lengths,
            middle: corner + 0.5 * (edges[0] + edges[1]),
            extent2: edges[0].length_squared() + edges[1].length_squared(),
            area: lengths[0] * lengths[1],
        })
    }

    /// The point where the diagonals cross.
    pub fn middle(&self) -> DVec3 {
        self.middle
    }

    /// The square of the diagonals' length, for edges that are exactly perpendicular.
    pub fn extent2(&self) -> f64 {
        self.extent2
    }

    /// The corner where both edges start.
    pub fn corner(&self) -> DVec3 {
        self.corner
    }

    /// The edges from the corner.
    pub fn edges(&self) -> [DVec3; 2] {
        self.edges
    }

    /// The unit vector along the first edge times the one along the second.
    pub fn normal(&self) -> DVec3 {
        self.axes[2]
    }

    /// Area of one side.
    pub fn area(&self) -> f64 {
        self.area
    }
}

/// A rectangle on the unit sphere.
///
/// The interior angle at the corner `(x, y, z)`, in axes along the edges, is the argument of the complex number
/// `(+-x y, |z| r)`, and the solid angle the sum of the four less `2 pi`. So it is the argument of their product, and
/// where the paper asks for sines of sums of angles, products of these numbers have them: one arc tangent
/// does for all four.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    axes: [DVec3; 3],
    x: [f64; 2],
    y: [f64; 2],
    /// Coordinate of the plane along the third axis.
    z: f64,
    /// Cosine and sine of the angle from which the solid angle is measured: less the sum of the two
    /// interior angles at the first edge's start.
    start: [f64; 2],
    solid_angle: f64,
}

impl SphericalRectangle {
    /// A rectangle as seen from `from`; `None` when the viewer stands in its plane.
    ///
    /// A view of next to nothing may come out as next to everything, and the other way round: neither is of use.
    pub fn new(from: DVec3, rectangle: &Rectangle) -> Option<SphericalRectangle> {
        let Rectangle { corner, axes, lengths, .. } = *rectangle;
        let d = corner - from;
        let [x0, y0, z] = axes.map(|axis| d.dot(axis));
        let (x, y) = ([x0, x0 + lengths[0]], [y0, y0 + lengths[1]]);
        let angle = |x: f64, y: f64, sign: f64| [sign * x * y, z.abs() * (x * x + y * y + z * z).sqrt()];
        let far = product(angle(x[1], y[0], 1.0), angle(x[1], y[1], -1.0));
        let near = product(angle(x[0], y[1], 1.0), angle(x[0], y[0], -1.0));
        let [re, im] = product(far, near);
        let signed = fmath::atan2_64(im, re);
        let solid_angle = if signed < 0.0 { signed + TAU } else { signed };
        let size = (x[0] * x[0] + z * z) * ((y[0] * y[0] + z * z) * (y[1] * y[1] + z * z)).sqrt();
        let start = [near[0] / size, -near[1] / size];
        let seen = z != 0.0 && solid_angle > 0.0;
        seen.then_some(SphericalRectangle { axes, x, y, z, start, solid_angle })
    }

    /// Solid angle in steradians, positive.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A vector from the viewer to a point of the rectangle, its direction uniform over the solid angle.
    pub fn sample(&self, u: Vec2) -> DVec3 {
        let SphericalRectangle { axes, x, y, z, start, solid_angle } = *self;
        let z2 = z * z;
        let [across0, across1] = y.map(|y| (y * y + z2).sqrt());
        let (b0, b1) = (-y[0] / across0, y[1] / across1);
        let (sin, cos) = fmath::sincos64(f64::from(u.x) * solid_angle);
        let [cos, sin] = product(start, [cos, sin]);
        let f = (cos * b0 - b1) / sin;
        let steep = f * f - z2 / (across0 * across0);
        let at_x = (z.abs().copysign(f) / steep.max(1e-300).sqrt()).clamp(x[0], x[1]);
        let d2 = at_x * at_x + z2;
        let height = |y: f64| y / (d2 + y * y).sqrt();
        let h = height(y[0]) + f64::from(u.y) * (height(y[1]) - height(y[0]));
        let at_y = (h * (d2 / (1.0 - h * h).max(1e-300)).sqrt()).clamp(y[0], y[1]);
        at_x * axes[0] + at_y * axes[1] + z * axes[2]
    }
}

/// The product of two complex numbers.
fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

/// The directions in which a sphere is seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct SphericalCap {
    /// Unit direction to the centre.
    axis: DVec3,
    /// One minus the cosine of the cap's angular radius.
    one_minus_cos: f64,
}

impl SphericalCap {
    /// The sphere as seen from `from`; `None` from its surface and from inside.
    pub fn new(from: DVec3, center: DVec3, radius: f64) -> Option<SphericalCap> {
        let to_center = center - from;
        let sin2 = radius * radius / to_center.length_squared();
        // 1 - cos without cancellation.
        let one_minus_cos = sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt());
        (sin2 < 1.0 && sin2 > 0.0).then_some(SphericalCap { axis: to_center.normalize(), one_minus_cos })
    }

    /// Solid angle in steradians, positive.
    pub fn solid_angle(&self) -> f64 {
        TAU * self.one_minus_cos
    }

    /// Whether a unit direction is within the cap.
    pub fn contains(&self, d: DVec3) -> bool {
        // 1 - cos is half the squared distance of the unit vectors, without cancellation.
        0.5 * d.distance_squared(self.axis) <= self.one_minus_cos
    }

    /// A unit direction uniform over the cap, from `u` in [0, 1)^2.
    pub fn sample(&self, u: Vec2) -> DVec3 {
        let drop = f64::from(u.x) * self.one_minus_cos;
        let (cos, sin) = (1.0 - drop, (drop * (2.0 - drop)).max(0.0).sqrt());
        let phi = TAU * f64::from(u.y);
        let (x, y) = basis64(self.axis);
        sin * (fmath::cos64(phi) * x + fmath::sin64(phi) * y) + cos * self.axis
    }
}

/// Two unit vectors that make a right-handed orthonormal basis with the unit vector `n` [Duff et al. 2017].
pub fn basis64(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// Irradiance on a plane under a polygon of unit radiance that lies wholly above its horizon.
///
/// Lambert's formula: half the sum over the edges of the angle each subtends times the cosine between the
/// normal of its plane and the receiver's [Lambert 1760]. Positive for corners that run clockwise as
/// seen from the receiver.
///
/// * `from`: the receiving point; `n`: its unit normal
pub fn polygon_irradiance(from: DVec3, n: DVec3, corners: &[DVec3]) -> f64 {
    let to = |i: usize| (corners[i % corners.len()] - from).normalize_or_zero();
    let edge = |i: usize| {
        let across = to(i).cross(to(i + 1));
        fmath::atan2_64(across.length(), to(i).dot(to(i + 1))) * across.normalize_or_zero().dot(n)
    };
    -0.5 * (0..corners.len()).map(edge).sum::<f64>()
}

/// The solid angle of everything.
pub const SPHERE: f64 = 4.0 * PI;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Stream;

    fn draw(i: u32) -> Vec2 {
        let stream = Stream::new(7, [i, 0], 0);
        Vec2::new(stream.uniform(0), stream.uniform(1))
    }

    fn somewhere(i: u32) -> DVec3 {
        let s = Stream::new(11, [i, 1], 3);
        DVec3::new(s.uniform(0).into(), s.uniform(1).into(), s.uniform(2).into()) * 2.0 - 1.0
    }

    #[test]
    fn an_octant_is_half_pi_and_two_halves_make_a_rectangle() {
        let octant = SphericalTriangle::new(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]).unwrap();
        assert!((octant.solid_angle() - PI / 2.0).abs() < 1e-12);
        for i in 0..200 {
            let (corner, [e1, e2]) = (somewhere(i) * 3.0, [somewhere(i + 1000), somewhere(i + 2000)]);
            let e2 = e1.cross(e2);
            let corners = [corner, corner + e1, corner + e1 + e2, corner + e2];
            let from = somewhere(i + 3000);
            let rectangle =
                SphericalRectangle::new(from, &Rectangle::new(corner, [e1, e2]).unwrap()).unwrap();
            let halves = [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k: usize| corners[k]));
            let sum: f64 =
                halves.map(|t| SphericalTriangle::new(from, t).unwrap().solid_angle()).iter().sum();
            assert!((rectangle.solid_angle() / sum - 1.0).abs() < 1e-8, "{i}: {sum}");
        }
    }

    #[test]
    fn a_rectangle_seen_almost_edge_on_keeps_its_digits() {
        // Far along its own plane: area cos / d^2 to first order.
        let (from, h) = (DVec3::new(1000.0, 1e-3, 0.5), 1e-3);
        let unit = Rectangle::new(DVec3::ZERO, [DVec3::X, DVec3::Z]).unwrap();
        let flat = SphericalRectangle::new(from, &unit).unwrap();
        let expected = h / 999.5f64.powi(3);
        assert!((flat.solid_angle() / expected - 1.0).abs() < 1e-2, "{}", flat.solid_angle() / expected);
    }

    /// Samples of a solid angle must integrate the cosine to what Lambert's formula says.
    fn check_irradiance(corners: &[DVec3], solid_angle: f64, sample: impl Fn(Vec2) -> DVec3) {
        let n = 40_000;
        let (mut sum, mut square) = (0.0, 0.0);
        for i in 0..n {
            let cos = sample(draw(i)).normalize().y * solid_angle;
            sum += cos;
            square += cos * cos;
        }
        let (mean, n) = (sum / f64::from(n), f64::from(n));
        let sigma = ((square / n - mean * mean) / n).sqrt();
        let expected = polygon_irradiance(DVec3::ZERO, DVec3::Y, corners).abs();
        assert!((mean - expected).abs() < 4.5 * sigma, "{mean} for {expected} by {sigma}");
    }

    #[test]
    fn samples_are_uniform_over_the_solid_angle() {
        for i in 0..12 {
            let up = |v: DVec3| DVec3::new(v.x, v.y.abs() + 0.05, v.z);
            let corners = [up(somewhere(i)), up(somewhere(i + 100)), up(somewhere(i + 200))];
            let triangle = SphericalTriangle::new(DVec3::ZERO, corners).unwrap();
            check_irradiance(&corners, triangle.solid_angle(), |u| triangle.sample(u));

            let (corner, e1) = (up(somewhere(i + 300)) + DVec3::Y, somewhere(i + 400) * 0.5);
            let e2 = e1.cross(somewhere(i + 500)).normalize() * 0.4;
            let rectangle =
                SphericalRectangle::new(DVec3::ZERO, &Rectangle::new(corner, [e1, e2]).unwrap()).unwrap();
            let corners = [corner, corner + e1, corner + e1 + e2, corner + e2];
            check_irradiance(&corners, rectangle.solid_angle(), |u| rectangle.sample(u));
        }
    }

    #[test]
    fn irradiance_of_known_polygons() {
        // A unit square centred above, at heights 0.5, 1 and 2; to the side; over one corner.
        let square = |x: f64, h: f64| {
            [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[a, b]| DVec3::new(a + x, h, b))
        };
        let e = |corners: &[DVec3]| polygon_irradiance(DVec3::ZERO, DVec3::Y, corners).abs();
        for (corners, expected) in [
            (square(0.0, 0.5), 1.740_840),
            (square(0.0, 1.0), 0.752_275),
            (square(0.0, 2.0), 0.230_837),
            (square(1.0, 1.0), 0.265_005),
        ] {
            assert!((e(&corners) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn caps_hold_their_directions() {
        let cap = SphericalCap::new(DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0), 1.0).unwrap();
        let cos = (1.0f64 - 1.0 / 9.0).sqrt();
        assert!((cap.solid_angle() - TAU * (1.0 - cos)).abs() < 1e-12);
        let mean: f64 = (0..4000).map(|i| cap.sample(draw(i)).z).sum::<f64>() / 4000.0;
        assert!((mean - 0.5 * (1.0 + cos)).abs() < 1e-3);
        assert!((0..100).all(|i| cap.sample(draw(i)).z >= cos - 1e-12));
        assert!(SphericalCap::new(DVec3::ZERO, DVec3::Z, 1.0).is_none());
    }
}
