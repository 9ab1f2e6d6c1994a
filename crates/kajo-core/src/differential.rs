//! Ray differentials: how a ray differs from those of the neighbouring pixels [Igehy 1999].
//!
//! A ray from `P` along the unit vector `D` depends on the place in the picture. Its derivatives `dP` and `dD` by the two
//! picture coordinates, times the distance between samples, are carried along the path. On the way to a surface with the normal `N`
//!
//! ```text
//! dP' = dP + t dD + dt D,     dt = -((dP + t dD).N) / (D.N)                                  [eq. 10, 12]
//! ```
//!
//! at a mirror, with `d(D.N) = dD.N + D.dN`,
//!
//! ```text
//! dD' = dD - 2 [(D.N) dN + d(D.N) N]                                                         [eq. 15]
//! ```
//!
//! and where light is refracted, with `D' = eta D - mu N` and `mu = eta (D.N) - (D'.N)`,
//!
//! ```text
//! dD' = eta dD - mu dN - dmu N,     dmu = [eta - eta^2 (D.N) / (D'.N)] d(D.N)                [eq. 17, 18]
//! ```
//!
//! Behind a rough surface directions no longer depend on the picture smoothly. What goes on is a cone as wide as what was seen of
//! the surface, whose spread is what it was: narrower than all the light that arrives there, so that what is filtered by
//! it is biased by little.

use kajo_math::{Frame, Vec3};

/// Differences of a ray from those of the samples beside it and above it, in world space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayDifferential {
    /// Of its origin, or of the point where it met a surface.
    pub dp: [Vec3; 2],
    /// Of its unit direction, at right angles to that.
    pub dd: [Vec3; 2],
}

/// How far samples of a pixel are from each other, in parts of it.
///
/// Of `n` samples each covers about a part `1/n`, so its sides are `1/sqrt(n)` of a pixel's; not less than an eighth, beyond which filters
/// would have nothing left to do [Pharr et al. 2023, 10.1].
#[inline]
pub fn sample_side(samples: u32) -> f32 {
    (1.0 / (samples.max(1) as f32).sqrt()).max(0.125)
}

/// The least cosine that a footprint is stretched by.
const LEAST_COSINE: f32 = 1e-5;

impl RayDifferential {
    /// Where the ray has gone the distance `t` along the unit vector `d` to a surface.
    ///
    /// * `ng`: unit normal of the surface, on either side
    #[inline]
    pub fn transferred(&self, d: Vec3, t: f32, ng: Vec3) -> RayDifferential {
        let cos = d.dot(ng);
        let cos = LEAST_COSINE.max(cos.abs()).copysign(cos);
        let dp = [0, 1].map(|i| {
            let moved = self.dp[i] + t * self.dd[i];
            moved - d * (moved.dot(ng) / cos)
        });
        RayDifferential { dp, dd: self.dd }
    }

    /// After a mirror.
    ///
    /// * `d`: unit direction in which it was met
    /// * `n`: unit normal on the side of the ray, and how it changes over `dp`
    pub fn reflected(&self, d: Vec3, n: Vec3, dn: [Vec3; 2]) -> RayDifferential {
        let cos = d.dot(n);
        let dd = [0, 1].map(|i| {
            let change = self.dd[i].dot(n) + d.dot(dn[i]);
            self.dd[i] - 2.0 * (cos * dn[i] + change * n)
        });
        RayDifferential { dp: self.dp, dd }
    }

    /// After refraction.
    ///
    /// * `d`, `wt`: unit directions before and behind
    /// * `n`: unit normal on the side of the ray, and how it changes over `dp`
    /// * `eta`: index of refraction before the surface over that behind it
    pub fn refracted(&self, d: Vec3, wt: Vec3, n: Vec3, dn: [Vec3; 2], eta: f32) -> RayDifferential {
        let (cos_i, cos_t) = (d.dot(n), wt.dot(n));
        let cos_t = cos_t.min(-LEAST_COSINE);
        let mu = eta * cos_i - cos_t;
        let dd = [0, 1].map(|i| {
            let change = self.dd[i].dot(n) + d.dot(dn[i]);
            let dmu = (eta - eta * eta * cos_i / cos_t) * change;
            eta * self.dd[i] - mu * dn[i] - dmu * n
        });
        RayDifferential { dp: self.dp, dd }
    }

    /// After a surface that scatters into a range of directions: a cone along the unit vector `wi`, as wide as what was seen of the
    /// surface and of the same spread.
    pub fn scattered(&self, wi: Vec3) -> RayDifferential {
        let [across, up] = self.dp;
        let width = across.cross(up).dot(wi).abs().sqrt();
        let spread = self.dd[0].cross(self.dd[1]).length().sqrt();
        let Frame { s, t, .. } = Frame::from_normal(wi);
        RayDifferential { dp: [width * s, width * t], dd: [spread * s, spread * t] }
    }

    /// Itself, or nothing where it has become no number.
    pub fn usable(self) -> RayDifferential {
        let is_finite = self.dp.iter().chain(&self.dd).all(|v| v.is_finite());
        if is_finite { self } else { RayDifferential::default() }
    }
}

/// What a sample covers of a surface: how far it is from a point to those of the neighbouring samples.
///
/// Zero where nothing is known of it, as in scenes where no texture asks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceFootprint {
    /// In world space, in the tangent plane.
    pub dp: [Vec3; 2],
}

impl SurfaceFootprint {
    /// That of a single point.
    pub const POINT: SurfaceFootprint = SurfaceFootprint { dp: [Vec3::ZERO; 2] };

    /// Whether it is that of a single point.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.dp == [Vec3::ZERO; 2]
    }
}

/// What a pixel covers of all that is infinitely far away: how the direction of a ray is from those of the neighbouring pixels.
///
/// Zero where nothing is known of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkyFootprint {
    /// Differences of unit directions, at right angles to them.
    pub dd: [Vec3; 2],
}

impl SkyFootprint {
    /// That of a single direction.
    pub const POINT: SkyFootprint = SkyFootprint { dd: [Vec3::ZERO; 2] };

    /// Whether it is that of a single direction.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.dd == [Vec3::ZERO; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{DVec3, Vec2, rng::Stream, warp};

    /// The map from a ray to the one behind a sphere's surface in double precision.
    fn through_sphere(o: DVec3, d: DVec3, eta: Option<f64>) -> (DVec3, DVec3) {
        let (b, c) = (o.dot(d), o.length_squared() - 1.0);
        let p = o + (-b - (b * b - c).sqrt()) * d;
        let n = p.normalize();
        let cos = d.dot(n);
        let wi = match eta {
            None => d - 2.0 * cos * n,
            Some(eta) => {
                let cos_t = -(1.0 - eta * eta * (1.0 - cos * cos)).sqrt();
                eta * d - (eta * cos - cos_t) * n
            }
        };
        (p, wi)
    }

    #[test]
    fn differentials_are_derivatives_of_reflection_and_refraction() {
        for i in 0..200 {
            let s = Stream::new(8, [i, 0], 0);
            let target = 0.9 * warp::concentric_disk(Vec2::new(s.uniform(0), s.uniform(1)));
            let o = DVec3::new(0.3, -0.2, 4.0);
            let d = (DVec3::new(f64::from(target.x), f64::from(target.y), 0.3) - o).normalize();
            if o.cross(d).length() > 0.9 {
                continue;
            }
            let [dd, dp] = [2, 5].map(|k| {
                DVec3::new(s.uniform(k).into(), s.uniform(k + 1).into(), s.uniform(k + 2).into()) - 0.5
            });
            let dd = dd - dd.dot(d) * d;
            for eta in [None, Some(1.0 / 1.5), Some(1.2)] {
                let h = 1e-5;
                let ray = |h: f64| through_sphere(o + h * dp, (d + h * dd).normalize(), eta);
                let ((p1, w1), (p0, w0)) = (ray(h), ray(-h));
                let ((p, wi), [by_p, by_w]) =
                    (ray(0.0), [p1 - p0, w1 - w0].map(|v| (v / (2.0 * h)).as_vec3()));
                if !wi.is_finite() || !by_w.is_finite() {
                    continue;
                }
                let start = RayDifferential { dp: [dp.as_vec3(); 2], dd: [dd.as_vec3(); 2] };
                let (df, n) = (d.as_vec3(), p.as_vec3());
                let there = start.transferred(df, (p - o).length() as f32, n);
                // On the unit sphere the normal changes as the point does.
                let after = match eta {
                    None => there.reflected(df, n, there.dp),
                    Some(eta) => there.refracted(df, wi.as_vec3(), n, there.dp, eta as f32),
                };
                let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-4 * (1.0 + b.length() * b.length());
                assert!(near(after.dp[0], by_p), "{eta:?}: {} {by_p}", after.dp[0]);
                assert!(near(after.dd[0], by_w), "{eta:?}: {} {by_w}", after.dd[0]);
            }
        }
    }

    #[test]
    fn cones_keep_width_and_spread() {
        let d = Vec3::new(0.6, 0.0, -0.8);
        let differential = RayDifferential {
            dp: [0.1 * Vec3::X, 0.2 * Vec3::Y],
            dd: [0.01 * Vec3::new(0.8, 0.0, 0.6), 0.01 * Vec3::Y],
        };
        let cone = differential.scattered(-d);
        let area = 0.02f32 * 0.8;
        assert!((cone.dp[0].length() - area.sqrt()).abs() < 1e-6 && cone.dp[0].dot(d).abs() < 1e-6);
        assert!((cone.dd[1].length() - 0.01).abs() < 1e-7 && cone.dd[0].dot(cone.dd[1]).abs() < 1e-8);
    }

    #[test]
    fn grazing_footprints_are_finite() {
        let dd = [0.001 * Vec3::Z, 0.001 * Vec3::Y];
        let there = RayDifferential { dd, ..RayDifferential::default() }.transferred(Vec3::X, 1e6, Vec3::Z);
        assert_eq!(there, there.usable());
        let lost = RayDifferential { dp: [Vec3::NAN; 2], dd };
        assert_eq!(lost.usable(), RayDifferential::default());
    }
}
