//! A linear map taken apart, and the way from one to another.

use crate::{DAffine3, DMat3, DQuat, DVec3, fmath};

/// Newton's iteration needs about `log2` of the largest over the smallest stretch, and a handful more.
const MOST_STEPS: u32 = 200;

/// Turns and strains below this are rounding.
const NOTHING: f64 = 1e-12;

/// An affine map as `T R S`: a symmetric stretch, then a rotation, then a translation.
///
/// A map that mirrors has a stretch of which all three factors are negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// `T`.
    pub translation: DVec3,
    /// `R`, with determinant 1.
    pub rotation: DMat3,
    /// `S`, symmetric, its factors all positive or all negative.
    pub stretch: DMat3,
}

impl Pose {
    /// Takes a map apart; `None` when it has no finite inverse.
    ///
    /// The factor nearest to the matrix `M` among the orthogonal ones is the limit of
    /// `Q <- (Q + Q^-T) / 2` from `Q = M` [Higham 1986].
    pub fn of(m: &DAffine3) -> Option<Pose> {
        let usable = |q: &DMat3| q.is_finite() && q.determinant() != 0.0;
        let mut q = m.matrix3;
        for _ in 0..MOST_STEPS {
            if !usable(&q) {
                return None;
            }
            let next = 0.5 * (q + q.inverse().transpose());
            let step = largest(&(next - q));
            q = next;
            if step <= f64::EPSILON {
                break;
            }
        }
        if !(usable(&q) && m.translation.is_finite()) {
            return None;
        }
        let rotation = if q.determinant() < 0.0 { -q } else { q };
        let s = rotation.transpose() * m.matrix3;
        Some(Pose { translation: m.translation, rotation, stretch: 0.5 * (s + s.transpose()) })
    }

    fn mirrors(&self) -> bool {
        self.stretch.determinant() < 0.0
    }
}

/// The way from one pose to another: all three parts at constant speed, the rotation by the shorter arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseSegment {
    from: Pose,
    /// What is added to the translation.
    shift: DVec3,
    /// Unit axis of the turn, in the space of the stretched object, and its angle in [0, pi].
    axis: DVec3,
    angle: f64,
    /// What is added to the stretch.
    strain: DMat3,
}

impl PoseSegment {
    /// `None` when one pose mirrors and the other does not: everything would be flat in between.
    pub fn between(from: &Pose, to: &Pose) -> Option<PoseSegment> {
        if from.mirrors() != to.mirrors() {
            return None;
        }
        let q = DQuat::from_mat3(&(from.rotation.transpose() * to.rotation));
        // q and -q are the same rotation; the one with the positive real part is the shorter way.
        let v = if q.w < 0.0 { -q.xyz() } else { q.xyz() };
        let angle = 2.0 * fmath::atan2_64(v.length(), q.w.abs());
        let turns = angle > NOTHING;
        let strain = to.stretch - from.stretch;
        let strains = largest(&strain) > NOTHING * largest(&from.stretch);
        Some(PoseSegment {
            from: *from,
            shift: to.translation - from.translation,
            axis: if turns { v.normalize() } else { DVec3::Z },
            angle: if turns { angle } else { 0.0 },
            strain: if strains { strain } else { DMat3::ZERO },
        })
    }

    /// The map at a share `u` in [0, 1] of the way.
    #[inline]
    pub fn at(&self, u: f64) -> DAffine3 {
        let stretch = self.from.stretch + u * self.strain;
        let rotation = if self.angle == 0.0 {
            self.from.rotation
        } else {
            self.from.rotation * turn(self.axis, u * self.angle)
        };
        DAffine3 { matrix3: rotation * stretch, translation: self.from.translation + u * self.shift }
    }

    /// Whether nothing changes on the way.
    pub fn is_still(&self) -> bool {
        self.shift == DVec3::ZERO && self.angle == 0.0 && self.strain == DMat3::ZERO
    }

    /// Whether lengths stay what they are, up to the rounding of single precision.
    pub fn is_rigid(&self) -> bool {
        let is_one = |m: DMat3| largest(&(m - DMat3::IDENTITY)) < 1e-6;
        is_one(self.from.stretch) && is_one(self.from.stretch + self.strain)
    }

    /// Whether the turn is half a circle, for which there is no shorter way.
    pub fn is_half_turn(&self) -> bool {
        self.angle > std::f64::consts::PI * (1.0 - 1e-6)
    }

    /// Bounds on the translation and its rate of change when the way takes the time `duration`.
    pub(super) fn translation_rates(&self, duration: f64) -> [f64; 2] {
        let ends = [self.from.translation, self.from.translation + self.shift];
        [ends[0].length().max(ends[1].length()), self.shift.length() / duration]
    }

    /// Bounds on the norm of the linear part `R S` and of its first two derivatives.
    ///
    /// `R` turns at the rate `w` and `S` changes at the rate `e`, so `|R S|' <= w |S| + e` and
    /// `|R S|'' <= w^2 |S| + 2 w e`.
    pub(super) fn linear_rates(&self, duration: f64) -> [f64; 3] {
        let size = norm(&self.from.stretch).max(norm(&(self.from.stretch + self.strain)));
        let (w, e) = (self.angle / duration, norm(&self.strain) / duration);
        [size, w * size + e, w * w * size + 2.0 * w * e]
    }
}

/// The rotation by `angle` around a unit axis: `cos I + sin [a]x + (1 - cos) a a^T`.
fn turn(a: DVec3, angle: f64) -> DMat3 {
    let (sin, cos) = (fmath::sin64(angle), fmath::cos64(angle));
    let column = |e: DVec3| cos * e + sin * a.cross(e) + ((1.0 - cos) * a.dot(e)) * a;
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

/// The largest magnitude of an entry.
fn largest(m: &DMat3) -> f64 {
    m.to_cols_array().iter().fold(0.0, |most: f64, v| most.max(v.abs()))
}

/// A bound on how much a matrix lengthens any vector: the smaller of two that are easy to compute.
pub(super) fn norm(m: &DMat3) -> f64 {
    let entries = m.to_cols_array();
    let frobenius = entries.iter().map(|v| v * v).sum::<f64>().sqrt();
    let sum = |m: &DMat3| [m.x_axis, m.y_axis, m.z_axis].map(|c| c.abs().element_sum());
    let most = |sums: [f64; 3]| sums[0].max(sums[1]).max(sums[2]);
    frobenius.min((most(sum(m)) * most(sum(&m.transpose()))).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Stream;

    /// A map with a stretch between 0.1 and 10 along random axes, now and then mirrored.
    fn random(k: u32) -> DAffine3 {
        let s = Stream::new(11, [k, 0], 0);
        let v = |d: u32| DVec3::new(s.uniform(d).into(), s.uniform(d + 1).into(), s.uniform(d + 2).into());
        let turned = |d: u32| turn((v(d) - 0.5).normalize(), 6.0 * v(d).y);
        let factors = v(6).map(|x| (10.0f64).powf(2.0 * x - 1.0));
        let mirror = if k.is_multiple_of(3) { -1.0 } else { 1.0 };
        let matrix3 = turned(0) * DMat3::from_diagonal(mirror * factors) * turned(3);
        DAffine3 { matrix3, translation: 9.0 * (v(9) - 0.5) }
    }

    fn is_rotation(m: &DMat3) -> bool {
        largest(&(m.transpose() * *m - DMat3::IDENTITY)) < 1e-12 && m.determinant() > 0.0
    }

    #[test]
    fn the_parts_make_the_whole_again() {
        for k in 0..500 {
            let m = random(k);
            let pose = Pose::of(&m).expect("it has an inverse");
            assert!(is_rotation(&pose.rotation), "{k}");
            assert_eq!(pose.stretch, pose.stretch.transpose());
            assert!(largest(&(pose.rotation * pose.stretch - m.matrix3)) < 1e-12 * norm(&m.matrix3), "{k}");
            assert_eq!(pose.mirrors(), k.is_multiple_of(3));
        }
        assert!(Pose::of(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))).is_none());
        assert!(Pose::of(&DAffine3::from_scale(DVec3::splat(f64::NAN))).is_none());
        assert!(Pose::of(&DAffine3::from_scale(DVec3::new(1e-30, 1.0, 1e30))).is_some());
    }

    #[test]
    fn a_way_goes_from_end_to_end_by_the_shorter_arc() {
        for k in 0..200 {
            let ends = [random(3 * k), random(3 * k + 300)];
            let poses = ends.map(|m| Pose::of(&m).expect("it has an inverse"));
            let way = PoseSegment::between(&poses[0], &poses[1]).expect("both mirror");
            for (u, end) in [(0.0, ends[0]), (1.0, ends[1])] {
                let m = way.at(u);
                assert!(largest(&(m.matrix3 - end.matrix3)) < 1e-11 * norm(&end.matrix3), "{k}");
                assert!(m.translation.distance(end.translation) < 1e-12);
            }
            assert!(way.angle <= std::f64::consts::PI);
            let [size, first, second] = way.linear_rates(1.0);
            let h = 1e-3;
            for i in 1..20 {
                let at = |u: f64| way.at(u).matrix3;
                let u = f64::from(i) / 20.0;
                let slope = (at(u + h) - at(u - h)) * (0.5 / h);
                let bend = (at(u + h) + at(u - h) - 2.0 * at(u)) * (1.0 / (h * h));
                let within = |m: DMat3, bound: f64| norm(&m) <= 2.0 * bound + 1e-6;
                assert!(within(at(u), size) && within(slope, first) && within(bend, second), "{k}");
            }
        }
        let mixed = PoseSegment::between(&Pose::of(&random(0)).unwrap(), &Pose::of(&random(1)).unwrap());
        assert!(mixed.is_none(), "a mirror image is never reached");
    }

    #[test]
    fn a_quarter_turn_is_uniform_and_rigid() {
        let quarter = DAffine3::from_mat3(turn(DVec3::Z, std::f64::consts::FRAC_PI_2));
        let poses = [DAffine3::IDENTITY, quarter].map(|m| Pose::of(&m).unwrap());
        let way = PoseSegment::between(&poses[0], &poses[1]).unwrap();
        for i in 0..=10 {
            let u = f64::from(i) / 10.0;
            let p = way.at(u).transform_vector3(DVec3::X);
            let (sin, cos) = (u * std::f64::consts::FRAC_PI_2).sin_cos();
            assert!(p.distance(DVec3::new(cos, sin, 0.0)) < 1e-14);
            assert!(is_rotation(&way.at(u).matrix3));
        }
        assert!(!way.is_still() && !way.is_half_turn());
        assert!(PoseSegment::between(&poses[1], &poses[1]).unwrap().is_still());
    }
}
