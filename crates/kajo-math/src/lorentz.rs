//! Inertial frames and the Lorentz transformations between them, with the speed of light 1.
//!
//! A frame that moves with the velocity `v` has the coordinates
//!
//! ```text
//! t' = γ (t - v·x)
//! x' = x + γ² / (γ + 1) (v·x) v - γ v t,            γ = 1 / sqrt(1 - v²)
//! ```
//!
//! [Møller 1972, ch. 2]. A map between frames is such a transformation, perhaps with a turn, and a shift of the origin; maps of
//! one velocity after the other compose to another one (in general with a turn, Wigner's), and their inverse is known without
//! a solver: `Λ⁻¹ = η Λᵀ η`.
//!
//! Light that arrives from the unit direction `d` is the vector `(ω, -ω d)`. Its image gives both what becomes of its direction,
//! aberration,
//!
//! ```text
//! tan(θ'/2) = sqrt((1 - β) / (1 + β)) tan(θ/2)
//! ```
//!
//! and what becomes of its frequency, the Doppler factor `ω'/ω = γ (1 + v·d)`, with `θ` the angle between `d` and `v`.
//! [Einstein 1905, § 7]

use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

/// A place and a moment in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpacetimeEvent {
    /// The moment, in the time in which light goes one unit of length.
    pub t: f64,
    /// The place.
    pub x: DVec3,
}

impl SpacetimeEvent {
    fn vector(self) -> DVec4 {
        self.x.extend(self.t)
    }
}

/// The map from the coordinates of one inertial frame to those of another: a Lorentz transformation and a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameMap {
    /// Columns and rows in the order x, y, z, t.
    lorentz: DMat4,
    shift: DVec4,
}

impl FrameMap {
    /// From a frame to itself.
    pub const IDENTITY: FrameMap = FrameMap { lorentz: DMat4::IDENTITY, shift: DVec4::ZERO };

    /// To a frame that moves with `velocity` and whose axes are not turned.
    ///
    /// The event `pivot` keeps its place, and its time there is 0: the origin of what moves is at that place at that moment.
    ///
    /// * `velocity`: as a fraction of the speed of light; `None` unless it is less than 1 long, and finite
    pub fn boost(velocity: DVec3, pivot: SpacetimeEvent) -> Option<FrameMap> {
        let v2 = velocity.length_squared();
        let gamma = 1.0 / (1.0 - v2).sqrt();
        if !(v2 < 1.0 && gamma.is_finite()) {
            return None;
        }
        let along = gamma * gamma / (gamma + 1.0) * velocity;
        let column = |axis: DVec3| (axis + along * velocity.dot(axis)).extend(-gamma * velocity.dot(axis));
        let lorentz = DMat4::from_cols(
            column(DVec3::X),
            column(DVec3::Y),
            column(DVec3::Z),
            (-gamma * velocity).extend(gamma),
        );
        let shift = pivot.x.extend(0.0) - lorentz * pivot.vector();
        Some(FrameMap { lorentz, shift })
    }

    /// This map after `first`.
    #[must_use]
    pub fn after(&self, first: &FrameMap) -> FrameMap {
        let shift = self.lorentz * first.shift + self.shift;
        FrameMap { lorentz: self.lorentz * first.lorentz, shift }
    }

    /// The map back.
    #[must_use]
    pub fn inverse(&self) -> FrameMap {
        let mut lorentz = self.lorentz.transpose();
        for axis in 0..3 {
            lorentz.col_mut(axis).w = -lorentz.col(axis).w;
            let w = -lorentz.w_axis[axis];
            lorentz.w_axis[axis] = w;
        }
        FrameMap { lorentz, shift: -(lorentz * self.shift) }
    }

    /// The coordinates of an event.
    #[inline]
    pub fn event(&self, event: SpacetimeEvent) -> SpacetimeEvent {
        let image = self.lorentz * event.vector() + self.shift;
        SpacetimeEvent { t: image.w, x: image.truncate() }
    }

    /// The direction in which light is seen in the second frame that in the first one arrives from `d`, times the ratio of its
    /// frequencies.
    ///
    /// So a ray of light back in time, `(t - s |d|, x + s d)`, has the same parameter `s` in both.
    ///
    /// * `d`: of any length
    #[inline]
    pub fn light(&self, d: DVec3) -> DVec3 {
        -(self.lorentz * (-d).extend(d.length())).truncate()
    }

    /// What is between the origins of two frames that move alike, in the coordinates of both: place and time of the second map's
    /// less those of this one's. `None` for frames that do not.
    pub fn offset(&self, other: &FrameMap) -> Option<SpacetimeEvent> {
        let shift = other.shift - self.shift;
        (self.lorentz == other.lorentz).then_some(SpacetimeEvent { t: shift.w, x: shift.truncate() })
    }

    /// The velocity of the second frame in the first.
    pub fn velocity(&self) -> DVec3 {
        let row = DVec3::new(self.lorentz.x_axis.w, self.lorentz.y_axis.w, self.lorentz.z_axis.w);
        -row / self.lorentz.w_axis.w
    }

    /// `γ` of that velocity, by which clocks of either frame run slow in the other.
    pub fn gamma(&self) -> f64 {
        self.lorentz.w_axis.w
    }

    /// Whether both frames are at rest in each other.
    pub fn is_at_rest(&self) -> bool {
        self.lorentz == DMat4::IDENTITY
    }

    /// Where in the first frame things are at its moment `t` that rest in the second: contracted along their motion.
    pub fn snapshot(&self, t: f64) -> DAffine3 {
        let back = self.inverse();
        let by_time = back.lorentz.w_axis;
        let time_by_place = DVec3::new(back.lorentz.x_axis.w, back.lorentz.y_axis.w, back.lorentz.z_axis.w);
        let column = |axis: usize| {
            back.lorentz.col(axis).truncate() - by_time.truncate() * (time_by_place[axis] / by_time.w)
        };
        let start = back.shift.truncate() + by_time.truncate() * ((t - back.shift.w) / by_time.w);
        DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: start }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ORIGIN: SpacetimeEvent = SpacetimeEvent { t: 0.0, x: DVec3::ZERO };

    fn boost(v: DVec3) -> FrameMap {
        FrameMap::boost(v, ORIGIN).unwrap()
    }

    fn velocity() -> impl Strategy<Value = DVec3> {
        (prop::array::uniform3(-1.0..1.0f64), 0.0..0.99f64)
            .prop_map(|(v, speed)| speed * DVec3::from(v).try_normalize().unwrap_or(DVec3::X))
    }

    fn event() -> impl Strategy<Value = SpacetimeEvent> {
        prop::array::uniform4(-10.0..10.0f64)
            .prop_map(|[t, x, y, z]| SpacetimeEvent { t, x: DVec3::new(x, y, z) })
    }

    fn distance(a: SpacetimeEvent, b: SpacetimeEvent) -> f64 {
        (a.vector() - b.vector()).abs().max_element()
    }

    proptest! {
        #[test]
        fn the_way_back_leads_to_the_start(v in velocity(), w in velocity(), pivot in event(), e in event()) {
            let there = FrameMap::boost(w, pivot).unwrap().after(&FrameMap::boost(v, e).unwrap());
            let back = there.inverse();
            let scale = there.gamma() * there.gamma();
            prop_assert!(distance(back.event(there.event(e)), e) < 1e-12 * 100.0 * scale);
            let d = e.x.try_normalize().unwrap_or(DVec3::Y);
            prop_assert!(back.light(there.light(d)).distance(d) < 1e-13 * scale);
        }

        #[test]
        fn intervals_are_kept(v in velocity(), w in velocity(), pivot in event(), a in event(), b in event()) {
            let map = FrameMap::boost(w, pivot).unwrap().after(&boost(v));
            let interval = |a: SpacetimeEvent, b: SpacetimeEvent| a.x.distance_squared(b.x) - (a.t - b.t).powi(2);
            let (before, after) = (interval(a, b), interval(map.event(a), map.event(b)));
            prop_assert!((before - after).abs() < 1e-12 * 1e3 * map.gamma().powi(2), "{before} {after}");
        }

        #[test]
        fn light_stays_light_and_rays_keep_their_parameter(v in velocity(), e in event(), d in velocity(), s in 0.0..20.0f64) {
            let map = FrameMap::boost(v, e).unwrap();
            let image = map.light(d);
            let along = |e: SpacetimeEvent, d: DVec3| SpacetimeEvent { t: e.t - s * d.length(), x: e.x + s * d };
            let off = distance(map.event(along(e, d)), along(map.event(e), image));
            prop_assert!(off < 1e-12 * 100.0 * map.gamma(), "{}", off);
        }

        #[test]
        fn what_rests_is_contracted_and_flies(v in velocity(), x in event(), t in -5.0..5.0f64) {
            let map = FrameMap::boost(v, ORIGIN).unwrap();
            let now = map.snapshot(t);
            let place = now.transform_point3(x.x);
            let off = map.event(SpacetimeEvent { t, x: place }).x.distance(x.x);
            prop_assert!(off < 1e-12 * 100.0 * map.gamma(), "{}", off);
            let first = map.snapshot(0.0).transform_point3(x.x);
            prop_assert!(first.distance(place - t * v) < 1e-11);
            prop_assert!((now.matrix3.determinant() * map.gamma() - 1.0).abs() < 1e-11 * map.gamma());
            prop_assert!(map.velocity().distance(v) < 1e-14);
        }
    }

    #[test]
    fn the_pivot_keeps_its_place_and_starts_the_clock() {
        let pivot = SpacetimeEvent { t: 3.0, x: DVec3::new(1.0, -2.0, 5.0) };
        let image = FrameMap::boost(DVec3::new(0.3, 0.1, -0.7), pivot).unwrap().event(pivot);
        assert!(distance(image, SpacetimeEvent { t: 0.0, ..pivot }) < 1e-14);
    }

    #[test]
    fn nothing_is_as_fast_as_light() {
        for v in [1.0, -1.0, 2.0, f64::NAN, f64::INFINITY] {
            assert!(FrameMap::boost(DVec3::new(v, 0.0, 0.0), ORIGIN).is_none());
        }
        assert_eq!(boost(DVec3::ZERO), FrameMap::IDENTITY);
        assert!(boost(DVec3::ZERO).is_at_rest() && !boost(0.1 * DVec3::X).is_at_rest());
    }

    /// Velocities along a line add by Einstein's formula.
    #[test]
    fn velocities_compose() {
        for [a, b] in [[0.5, 0.5], [0.9, 0.9], [0.99, -0.5], [-0.3, 0.7]] {
            let both = boost(b * DVec3::X).after(&boost(a * DVec3::X));
            let expected = boost((a + b) / (1.0 + a * b) * DVec3::X);
            let off = (both.lorentz - expected.lorentz).to_cols_array().map(f64::abs);
            assert!(off.iter().all(|&off| off < 1e-12 * both.gamma()), "{a} {b}: {off:?}");
        }
        // Across each other they turn the axes as well [Møller 1972, ch. 2].
        let across = boost(0.6 * DVec3::Y).after(&boost(0.8 * DVec3::X));
        let w = across.velocity();
        assert!(w.distance(DVec3::new(0.8, 0.6 * 0.6, 0.0)) < 1e-14, "{w}");
    }

    /// Angles of aberration and Doppler factors; [Weiskopf 2001], and the formulas above.
    #[test]
    fn aberration_and_doppler_are_those_of_the_tables() {
        let degrees = [30.0, 60.0, 90.0, 120.0, 150.0f64];
        let table = [
            (0.5, [17.588, 36.870, 60.0, 90.0, 130.208], [1.732_051, 0.866_025, 0.577_350]),
            (0.9, [7.0353, 15.0902, 25.8419, 43.3418, 81.1397], [4.358_899, 0.435_890, 0.229_416]),
            (0.99, [2.1763, 4.6873, 8.1096, 13.9997, 29.6371], [14.106_736, 0.141_067, 0.070_888]),
        ];
        let towards = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        for (b, angles, doppler) in table {
            let map = boost(b * DVec3::X);
            for (angle, expected) in degrees.into_iter().zip(angles) {
                let seen = map.light(towards(angle.to_radians()));
                let found = seen.y.atan2(seen.x).to_degrees();
                assert!((found - expected).abs() < 6e-4, "{b}, {angle}: {found}");
            }
            // The angles of the Doppler table are those at which the moving one sees the light.
            for (angle, expected) in [0.0, 90.0, 180.0f64].into_iter().zip(doppler) {
                let back = map.inverse().light(towards(angle.to_radians()));
                assert!((1.0 / back.length() - expected).abs() < 6e-7, "{b}, {angle}");
            }
        }
    }

    /// A mirror that moves along its normal against the light; [Einstein 1905, § 8].
    #[test]
    fn a_moving_mirror_steepens_and_hastens_light() {
        for (b, incidence, ratio, reflected) in [(0.5, 45.0f64, 2.609_476, 15.7224), (0.5, 0.0, 3.0, 0.0)] {
            let map = boost(b * DVec3::X);
            let i = incidence.to_radians();
            // Where the light comes from, seen by the mirror, which throws it back.
            let arrives = map.light(DVec3::new(i.cos(), i.sin(), 0.0));
            let leaves = DVec3::new(arrives.x, -arrives.y, 0.0);
            // Light that leaves in a direction is light that arrives from it, with time reversed and so the velocity.
            let seen = map.inverse();
            let out = -seen.light(-leaves);
            assert!((out.length() - ratio).abs() < 1e-6, "{}", out.length());
            assert!((out.y.abs().atan2(out.x).to_degrees() - reflected).abs() < 1e-4, "{out}");
        }
    }
}
