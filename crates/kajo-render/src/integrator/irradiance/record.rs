//! A record of the cache: the irradiance of a point, how it changes around it, and how far that holds.
//!
//! ```text
//! E(x, n) = sum of w_i (E_i + (n - n_i)·dE_i/dn + (x - x_i)·dE_i/dx) / sum of w_i             [Ward and Heckbert 1992, eq. 7]
//! w_i     = 1 - max(d_i, a_i)                                                           [Tabellion and Lamorlette 2004]
//! ```
//!
//! over all records whose weight is positive. `d_i` is the distance as a share of the radius of validity, of which there are two in the
//! tangent plane; `a_i` is 1 where the normals are as far apart as the accuracy allows. So records fade out where they end.

use kajo_math::{Aabb, Frame, Vec2, Vec3};

/// What is known of the irradiance around a point. The tangent plane has the axes of [`Frame::from_normal`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Record {
    /// World space.
    pub p: Vec3,
    /// Unit normal on the side that is lit, without relief.
    pub n: Vec3,
    /// Indirect irradiance, linear RGB.
    pub irradiance: [f32; 3],
    /// Of each channel, by the components of another unit normal in the tangent plane.
    pub by_normal: [Vec2; 3],
    /// Of each channel, by the position in the tangent plane, per unit of the world.
    pub by_position: [Vec2; 3],
    /// How far it holds, in units of the world: along `axis` and across, the larger one first.
    pub radii: [f32; 2],
    /// Cosine of the angle from the x axis of the tangent plane to the axis of the larger radius, which lies in the upper half.
    pub axis: f32,
}

/// A record before it is known how far it is used, which depends on the camera.
#[derive(Clone, Copy, Debug)]
pub struct GatheredRecord {
    /// Without radii.
    pub record: Record,
    /// By how much irradiance bends along the axis and across it, the smaller one first; `None` where radii are by distances.
    pub curvatures: Option<[f32; 2]>,
    /// Harmonic mean of the distances around.
    pub mean_distance: f32,
}

/// A position where irradiance is asked for.
#[derive(Clone, Copy, Debug)]
pub struct IrradianceQuery {
    /// World space.
    pub p: Vec3,
    /// Unit normal on the side that is lit, without relief.
    pub n: Vec3,
    /// Unit normal of the relief.
    pub relief: Vec3,
}

/// How far a record lies behind a position at most, as a share of its radius: what is further is not lit by what the record saw.
const LEAST_BEHIND: f32 = -0.05;

impl Record {
    /// The weight of the record at a position; not positive where it does not hold.
    ///
    /// * `turn`: how far normals may be apart, as `1 - cos`
    #[inline]
    pub fn weight(&self, at: &IrradianceQuery, turn: f32) -> f32 {
        let d = at.p - self.p;
        let [r1, r2] = self.radii;
        let length2 = d.length_squared();
        if length2 >= r1 * r1 {
            return 0.0;
        }
        let turned = (1.0 - at.n.dot(self.n)) / turn;
        if turned >= 1.0 || 0.5 * d.dot(at.n + self.n) < LEAST_BEHIND * r2 {
            return 0.0;
        }
        let along = d.dot(self.longer_axis());
        // All that is not along the axis, out of the tangent plane included.
        let across2 = (length2 - along * along).max(0.0);
        let distance = ((along / r1) * (along / r1) + across2 / (r2 * r2)).sqrt();
        1.0 - distance.max(turned.max(0.0).sqrt())
    }

    /// The irradiance of a position by this record alone, linear RGB; not negative.
    #[inline]
    pub fn extrapolated(&self, at: &IrradianceQuery) -> [f32; 3] {
        let frame = Frame::from_normal(self.n);
        let moved = frame.to_local(at.p - self.p).truncate();
        let turned = frame.to_local(at.relief).truncate();
        [0, 1, 2].map(|i| {
            let e = self.irradiance[i] + self.by_normal[i].dot(turned) + self.by_position[i].dot(moved);
            e.max(0.0)
        })
    }

    /// A box around the spheroid in which it holds, and the rounding errors of [`Record::weight`].
    pub fn bounds(&self) -> Aabb {
        let [r1, r2] = self.radii;
        let axis = self.longer_axis();
        let half = Vec3::splat(r2 * r2) + (r1 * r1 - r2 * r2) * axis * axis;
        let half = half.max(Vec3::ZERO).map(f32::sqrt) * 1.001 + 1e-6 * self.p.abs();
        Aabb { min: self.p - half, max: self.p + half }
    }

    /// Unit vector along the larger radius.
    #[inline]
    fn longer_axis(&self) -> Vec3 {
        let Frame { s, t, .. } = Frame::from_normal(self.n);
        let sin = (1.0 - self.axis * self.axis).max(0.0).sqrt();
        self.axis * s + sin * t
    }

    /// The mean of the channels.
    pub fn mean(&self) -> f32 {
        self.irradiance.iter().sum::<f32>() / 3.0
    }

    /// Makes the radii no larger than those of a neighbour and the distance to it, so that what a neighbour has seen near by is
    /// not missed [Křivánek, Bouatouch, Pattanaik and Žára 2006].
    pub fn clamp_to(&mut self, other: &Record) {
        let d = self.p.distance(other.p);
        self.radii = [0, 1].map(|i| self.radii[i].min(other.radii[i] + d));
    }

    /// Whether both are on surfaces that are lit from about the same side.
    pub fn is_beside(&self, other: &Record) -> bool {
        self.n.dot(other.n) > 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_small() {
        assert!(size_of::<Record>() <= 96, "{}", size_of::<Record>());
    }

    /// An ellipse whose longer axis is the tangent plane's y axis.
    fn record() -> Record {
        let n = Vec3::Z;
        let radii = [2.0, 0.5];
        let by_position = [Vec2::new(0.5, 0.25); 3];
        let by_normal = [Vec2::new(0.0, 1.0); 3];
        Record { n, radii, axis: 0.0, irradiance: [1.0; 3], by_position, by_normal, ..Record::default() }
    }

    fn query(along: f32, across: f32) -> IrradianceQuery {
        let Frame { s, t, n } = Frame::from_normal(Vec3::Z);
        IrradianceQuery { p: across * s + along * t, n, relief: n }
    }

    #[test]
    fn weights_fall_to_nothing_at_the_ellipse() {
        let record = record();
        let weight = |along, across| record.weight(&query(along, across), 0.1);
        assert_eq!(weight(0.0, 0.0), 1.0);
        assert!((weight(1.0, 0.0) - 0.5).abs() < 1e-6 && (weight(0.0, 0.25) - 0.5).abs() < 1e-6);
        assert!(weight(1.99, 0.0) > 0.0 && weight(2.01, 0.0) <= 0.0);
        assert!(weight(0.0, 0.49) > 0.0 && weight(0.0, 0.51) <= 0.0);
    }

    #[test]
    fn other_sides_and_what_is_in_front_are_not_known() {
        let record = record();
        let here = query(0.0, 0.0);
        assert!(record.weight(&IrradianceQuery { n: -Vec3::Z, ..here }, 0.1) <= 0.0);
        assert!(record.weight(&IrradianceQuery { n: Vec3::X, ..here }, 0.1) <= 0.0);
        assert!(record.weight(&IrradianceQuery { p: Vec3::Z * -0.1, ..here }, 0.1) <= 0.0, "below a floor");
        let above = record.weight(&IrradianceQuery { p: Vec3::Z * 0.1, ..here }, 0.1);
        assert!(above > 0.0 && above < 1.0);
    }

    #[test]
    fn irradiance_goes_by_the_gradients() {
        let record = record();
        let moved = record.extrapolated(&query(0.4, 0.2));
        assert!((moved[0] - 1.2).abs() < 1e-6, "{moved:?}");
        let Frame { t, n, .. } = Frame::from_normal(Vec3::Z);
        let relief = (0.6 * t + 0.8 * n).normalize();
        let turned = record.extrapolated(&IrradianceQuery { relief, ..query(0.0, 0.0) });
        assert!((turned[0] - 1.6).abs() < 1e-6, "{turned:?}");
        let far = record.extrapolated(&query(-40.0, 0.0));
        assert_eq!(far, [0.0; 3], "light is not negative");
    }

    #[test]
    fn radii_shrink_beside_smaller_ones() {
        let mut record = record();
        let small = Record { p: Vec3::X, radii: [0.5, 0.25], ..record };
        record.clamp_to(&small);
        assert_eq!(record.radii, [1.5, 0.5]);
    }
}
