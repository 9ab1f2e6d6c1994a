//! Pieces of rays through media, and lights as seen from them.
//!
//! Light of a point that is scattered once on a ray is an integral of `1 / (D^2 + (t - s)^2)` over the distance `t`, where `s` is the
//! distance of the point closest to the light and `D` that between the two. It is the angle under which the light sees
//! the ray, over `D`; so distances are drawn by that angle [Kulla and Fajardo 2012, eq. 4 and 5], and lights are chosen
//! by it [Conty Estévez and Kulla 2018, 4.3].
//!
//! A light that shines into a cone sees no more of a ray than lies within that:
//!
//! ```text
//! W(t) = (o + t d - a) . n  >=  0,      sin^2 W(t)^2  >=  cos^2 |(o + t d - a) - W(t) n|^2
//! ```
//!
//! for the apex `a`, the axis `n`, and the sine and cosine of half the cone's angle. For lights within a ball of radius
//! `r` whose axes lie within a cone too, the angle is the sum of both and the apex lies `r / sin` behind the middle of
//! the ball. The cone is convex, so that part of the ray is one interval.

use std::f32::consts::FRAC_PI_2;

use kajo_math::{Ray, Vec3, fmath};

/// Mean free paths on which nearly all collisions of a ray happen.
const FREE_PATHS: f32 = 3.0;

/// The least length of a ray, over its distance from a light, along which it makes a difference where the light is.
const NEAR: f32 = 0.5;

/// The same in heterogeneous media, where a point costs more, and so has to make a larger difference.
const NEAR_IN_HETEROGENEOUS: f32 = 2.0;

/// A piece of a ray through a medium, along which a light is to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct RaySegment {
    /// Where it begins.
    pub o: Vec3,
    /// Its unit direction.
    pub d: Vec3,
    /// Its length, perhaps infinite.
    pub length: f32,
    /// Moment within the shutter interval, 0 to 1.
    pub time: f32,
    /// Extinction of the medium, per unit of length.
    pub extinction: f32,
    /// Whether that is the same everywhere, not its mean.
    pub is_homogeneous: bool,
}

/// The part of a ray that a light can reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct LitPart {
    /// Distance of the ray's closest point.
    closest: f32,
    /// How far the light is from that.
    distance: f32,
    /// Distances between which the light sees the ray, the second one perhaps infinite.
    ends: [f32; 2],
}

/// The angle under which a light sees a part of a ray.
#[derive(Clone, Copy, Debug)]
pub struct AngularSpan {
    part: LitPart,
    /// The angles of its ends, from the closest point.
    angles: [f32; 2],
}

/// The directions into which light leaves a ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightCone {
    pub center: Vec3,
    /// Of the ball.
    pub radius: f32,
    pub axis: Vec3,
    /// Cosine of half the angle of the cone; not below 0.
    pub cos: f32,
}

impl RaySegment {
    /// * `length`: perhaps infinite
    /// * `extinction`: of the medium, which is homogeneous, per unit of length
    pub fn new(ray: &Ray, length: f32, extinction: f32) -> RaySegment {
        RaySegment { o: ray.o, d: ray.d, length, time: ray.time, extinction, is_homogeneous: true }
    }

    /// A point for which what is known of a region is asked: a free path from the start, or half of the way.
    pub fn middle(&self) -> Vec3 {
        self.o + self.d * (0.5 * self.length).min(1.0 / self.extinction)
    }

    /// Between which distances the ray is in a cone of light; `None` where it misses that.
    fn within(&self, cone: &LightCone) -> Option<[f32; 2]> {
        let cos2 = f64::from(cone.cos) * f64::from(cone.cos);
        let sin2 = 1.0 - cos2;
        let axis = cone.axis.as_dvec3();
        let behind = if cone.radius > 0.0 { f64::from(cone.radius) / sin2.sqrt() } else { 0.0 };
        let from_apex = (self.o - cone.center).as_dvec3() + behind * axis;
        let d = self.d.as_dvec3();
        // Along the axis, and across it.
        let (w, v) = (from_apex.dot(axis), d.dot(axis));
        let (w_across, v_across) = (from_apex - w * axis, d - v * axis);
        let a = sin2 * v * v - cos2 * v_across.length_squared();
        let b = sin2 * w * v - cos2 * w_across.dot(v_across);
        let c = sin2 * w * w - cos2 * w_across.length_squared();
        let [from, to] = inside_cone([a, b, c], [w, v])?;
        let ends = [(from as f32).max(0.0), (to as f32).min(self.length)];
        (ends[0] < ends[1]).then_some(ends)
    }

    /// How light from within a ball sees the ray; `None` where it does not.
    ///
    /// * `cone`: where its light goes, if it does not go everywhere
    pub(super) fn seen_from(&self, center: Vec3, radius: f32, cone: Option<&LightCone>) -> Option<LitPart> {
        let ends = match cone {
            Some(cone) => self.within(cone)?,
            None => [0.0, self.length],
        };
        let to = center - self.o;
        let closest = to.dot(self.d);
        // A light on the ray itself has no angle; no point is nearer than the light is large, or than rounding may tell.
        let distance = (to - closest * self.d).length().max(radius).max(1e-4 * to.length());
        let part = LitPart { closest, distance, ends };
        (distance > 0.0 && ends[1] > ends[0] && self.is_worth_drawing(&part)).then_some(part)
    }

    /// Whether collisions would find the light on a part of the ray badly: it is less than what they may end on, or
    /// some of that is much nearer to the light than the rest.
    fn is_worth_drawing(&self, part: &LitPart) -> bool {
        let is_cut = part.ends[0] > 0.0 || part.ends[1] < self.length;
        let reached = self.length.min(FREE_PATHS / self.extinction);
        let off = part.nearest() - part.closest;
        let near = if self.is_homogeneous { NEAR } else { NEAR_IN_HETEROGENEOUS };
        is_cut || reached * reached > near * near * (part.distance * part.distance + off * off)
    }
}

/// Between which `t` there is `a t^2 + 2 b t + c >= 0` with `w + v t >= 0`, for a form that is positive in a cone and its mirror image alone; the
/// second factor is positive in the cone.
fn inside_cone([a, b, c]: [f64; 3], [w, v]: [f64; 2]) -> Option<[f64; 2]> {
    const EVER: f64 = f64::INFINITY;
    let root = (b * b - a * c).max(0.0).sqrt();
    if a > 0.0 {
        // It comes out of the mirror image and runs into the cone, or the other way.
        return Some(if v > 0.0 { [(root - b) / a, EVER] } else { [-EVER, (-root - b) / a] });
    }
    if a < 0.0 {
        let meets = b * b > a * c && w - b / a * v > 0.0;
        return meets.then(|| [(root - b) / a, (-root - b) / a]);
    }
    // Parallel to a side of the cone, or to the plane that it has become.
    let t = -0.5 * c / b;
    match () {
        () if b > 0.0 && v > 0.0 => Some([t, EVER]),
        () if b < 0.0 && v < 0.0 => Some([-EVER, t]),
        () => (b == 0.0 && c > 0.0 && w > 0.0).then_some([-EVER, EVER]),
    }
}

impl AngularSpan {
    /// A distance, drawn by its angle.
    ///
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub fn sample(&self, u: f32) -> f32 {
        let [a, b] = self.angles;
        let LitPart { closest, distance, ends } = self.part;
        (closest + distance * fmath::tan((1.0 - u) * a + u * b)).clamp(ends[0], ends[1])
    }

    /// The density with which [`AngularSpan::sample`] draws a distance; 0 where the light does not see the ray.
    #[inline]
    pub fn pdf(&self, t: f32) -> f32 {
        let LitPart { closest, distance, ends } = self.part;
        if !(ends[0]..=ends[1]).contains(&t) {
            return 0.0;
        }
        let off = t - closest;
        distance / ((self.angles[1] - self.angles[0]) * (distance * distance + off * off))
    }
}

impl LitPart {
    /// The distance at which it is closest to the light.
    fn nearest(&self) -> f32 {
        self.closest.clamp(self.ends[0], self.ends[1])
    }

    /// The angles of its ends, to draw distances by; `None` where they are one.
    pub(super) fn span(self) -> Option<AngularSpan> {
        let angle = |t: f32| match t.is_finite() {
            true => fmath::atan2(t - self.closest, self.distance),
            false => FRAC_PI_2,
        };
        let angles = self.ends.map(angle);
        (angles[1] > angles[0]).then_some(AngularSpan { part: self, angles })
    }

    /// About the integral over it of `exp(-sigma (t + r)) / r^2`, for the distance `r` from the light: what is closest to
    /// the light, and what is closest to the start of the ray.
    ///
    /// * `extinction`: `sigma`
    pub(super) fn scattered(&self, extinction: f32) -> f32 {
        let LitPart { closest, distance, ends: [from, to] } = *self;
        let [start, end] = [from - closest, to - closest];
        let nearest = self.nearest();
        let r2 = |t: f32| distance * distance + (t - closest) * (t - closest);
        let absorbed = |t: f32, r2: f32| fmath::exp(-extinction * (t + r2.sqrt()));
        // Between the directions to both ends.
        let angle = match end.is_finite() {
            true => fmath::atan2(distance * (end - start), distance * distance + start * end),
            false => fmath::atan2(distance, start),
        };
        let [at_light, at_start] = [nearest, from].map(r2);
        absorbed(nearest, at_light) * angle / distance
            + absorbed(from, at_start) * (to - from).min(1.0 / extinction).min(at_start.sqrt()) / at_start
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{Vec2, rng::Stream, warp};

    fn direction(s: &Stream, at: u32) -> Vec3 {
        warp::uniform_sphere(Vec2::new(s.uniform(at), s.uniform(at + 1)))
    }

    fn position(s: &Stream, at: u32) -> Vec3 {
        4.0 * Vec3::new(s.uniform(at), s.uniform(at + 1), s.uniform(at + 2)) - 2.0
    }

    fn segment(s: &Stream, at: u32) -> RaySegment {
        let length = if s.uniform(at) < 0.2 { f32::INFINITY } else { 6.0 * s.uniform(at) };
        RaySegment {
            o: position(s, at + 1),
            d: direction(s, at + 4),
            length,
            time: 0.0,
            extinction: 0.3,
            is_homogeneous: true,
        }
    }

    /// Of points along rays those in the interval are those that are in the cone.
    #[test]
    fn a_ray_is_in_a_cone_where_its_points_are() {
        let (mut inside, mut outside) = (0, 0);
        for k in 0..400 {
            let s = Stream::new(11, [k, 0], 0);
            let cos = [0.0, 0.05, 0.999, s.uniform(90)][k as usize % 4];
            let cone = LightCone { center: position(&s, 20), radius: 0.0, axis: direction(&s, 30), cos };
            let segment = segment(&s, 40);
            let found = segment.within(&cone);
            for i in 0..100 {
                let t = 0.06 * i as f32;
                let to = segment.o + t * segment.d - cone.center;
                let above = cone.axis.dot(to) - cos * to.length();
                if t >= segment.length || above.abs() < 1e-4 {
                    continue;
                }
                let is_found = found.is_some_and(|[from, to]| t >= from && t <= to);
                assert_eq!(is_found, above > 0.0, "{k} at {t}: {found:?}");
                if above > 0.0 { inside += 1 } else { outside += 1 }
            }
        }
        assert!(inside > 2_000 && outside > 2_000, "{inside} {outside}");
    }

    /// Rays along the axis, through the apex, along a side, and in the plane of what shines on one side of it.
    #[test]
    fn rays_that_touch_a_cone() {
        let along = |o: Vec3, d: Vec3| RaySegment {
            o,
            d,
            length: f32::INFINITY,
            time: 0.0,
            extinction: 1.0,
            is_homogeneous: true,
        };
        let cone = |cos| LightCone { center: Vec3::ZERO, radius: 0.0, axis: Vec3::NEG_Y, cos };
        let within = |o, d, cos| along(o, d).within(&cone(cos));
        let narrow = 0.6;
        assert_eq!(within(Vec3::Y, Vec3::NEG_Y, narrow), Some([1.0, f32::INFINITY]));
        assert_eq!(within(Vec3::NEG_Y, Vec3::Y, narrow), Some([0.0, 1.0]));
        assert_eq!(within(Vec3::ZERO, Vec3::NEG_Y, narrow), Some([0.0, f32::INFINITY]));
        assert_eq!(within(Vec3::NEG_X, Vec3::X, narrow), None);
        assert_eq!(within(2.0 * Vec3::Y, Vec3::X, narrow), None);
        for side in [Vec3::new(0.8, -0.6, 0.0), Vec3::new(-0.8, 0.6, 0.0)] {
            let ends = within(-side, side, narrow);
            assert!(ends.is_none_or(|[from, to]| from >= 0.0 && from < to), "{ends:?}");
        }
        for d in [Vec3::X, Vec3::Z] {
            assert_eq!(within(Vec3::ZERO, d, 0.0), None, "in the plane");
            assert_eq!(within(Vec3::NEG_Y, d, 0.0), Some([0.0, f32::INFINITY]), "before it");
            assert_eq!(within(Vec3::Y, d, 0.0), None, "behind it");
        }
        // A cone without width has nothing in it.
        assert_eq!(within(Vec3::Y, Vec3::X, 1.0), None);
    }

    /// No point is left out that any point of a ball shines at.
    #[test]
    fn the_cone_around_a_ball_has_the_cones_of_its_points() {
        let mut inside = 0;
        for k in 0..400 {
            let s = Stream::new(12, [k, 0], 0);
            let cos = [0.0, 0.2, 0.9][k as usize % 3];
            let cone =
                LightCone { center: position(&s, 20), radius: s.uniform(23), axis: direction(&s, 30), cos };
            let segment = segment(&s, 40);
            let found = segment.within(&cone);
            for i in 0..200 {
                let s = Stream::new(13, [k, i], 0);
                let from = cone.center + cone.radius * s.uniform(0) * direction(&s, 1);
                let t = 6.0 * s.uniform(3);
                let to = segment.o + t * segment.d - from;
                if t < segment.length && cone.axis.dot(to) > (cos + 1e-4) * to.length() {
                    assert!(found.is_some_and(|[from, to]| t >= from && t <= to), "{k} at {t}: {found:?}");
                    inside += 1;
                }
            }
        }
        assert!(inside > 5_000, "{inside}");
    }

    /// The share of distances below one that was drawn with `u` is `u`.
    #[test]
    fn distances_have_the_density_that_is_said() {
        for k in 0..20 {
            let s = Stream::new(14, [k, 0], 0);
            let segment = segment(&s, 0);
            let cone = LightCone { center: position(&s, 20), radius: 0.1, axis: direction(&s, 30), cos: 0.3 };
            let cone = (k % 2 == 0).then_some(&cone);
            let part = segment.seen_from(position(&s, 20), 0.1, cone);
            let Some(span) = part.and_then(LitPart::span) else { continue };
            let [from, to] = [span.sample(0.0), span.sample(0.999)];
            const STEPS: u32 = 40_000;
            let width = (f64::from(to) - f64::from(from)) / f64::from(STEPS);
            let sum: f64 = (0..STEPS)
                .map(|i| f64::from(span.pdf((f64::from(from) + (f64::from(i) + 0.5) * width) as f32)) * width)
                .sum();
            assert!((sum - 0.999).abs() < 0.01, "{k}: {sum}");
            assert_eq!(span.pdf(from - 0.1), 0.0);
        }
    }

    /// The estimate by which lights are chosen is within twenty times what is scattered.
    #[test]
    fn the_estimate_of_scattered_light_is_near_the_integral() {
        let mut drawn = 0;
        for k in 0..60 {
            let s = Stream::new(15, [k, 0], 0);
            let segment = RaySegment { extinction: [0.01, 0.3, 3.0][k as usize % 3], ..segment(&s, 0) };
            let light = position(&s, 20);
            let Some(part) = segment.seen_from(light, 0.0, None) else { continue };
            drawn += 1;
            let span = part.span().expect("an angle");
            const STEPS: u32 = 20_000;
            let [from, to] = span.angles.map(f64::from);
            let width = (to - from) / f64::from(STEPS);
            let integral: f64 = (0..STEPS)
                .map(|i| {
                    let angle = from + (f64::from(i) + 0.5) * width;
                    let t = f64::from(part.closest) + f64::from(part.distance) * angle.tan();
                    let r = f64::from(part.distance) / angle.cos();
                    (-f64::from(segment.extinction) * (t + r)).exp() * width / f64::from(part.distance)
                })
                .sum();
            let ratio = f64::from(part.scattered(segment.extinction)) / integral;
            assert!(ratio > 0.05 && ratio < 20.0, "{k}: {ratio}");
        }
        assert!(drawn > 20, "{drawn}");
    }
}
