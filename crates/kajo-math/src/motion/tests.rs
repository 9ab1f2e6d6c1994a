//! Motions as wholes.

use super::*;
use crate::rng::Stream;
use crate::{Aabb, DVec3, Vec3};

/// Random numbers for a case.
struct Random(Stream, u32);

impl Random {
    fn new(case: u32) -> Random {
        Random(Stream::new(21, [case, 0], 0), 0)
    }

    fn next(&mut self) -> f64 {
        self.1 += 1;
        self.0.uniform(self.1).into()
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) - 0.5
    }

    /// A map of moderate stretch; rigid where `rigid` says so.
    fn map(&mut self, rigid: bool) -> DAffine3 {
        let turn = DAffine3::from_axis_angle(self.vector().normalize(), 6.0 * self.next());
        let moved = DAffine3::from_translation(4.0 * self.vector()) * turn;
        if rigid { moved } else { moved * DAffine3::from_scale(0.3 + 3.0 * (self.vector() + 0.5)) }
    }

    fn keyframes(&mut self, rigid: bool) -> Keyframes {
        let keys = 2 + (3.0 * self.next()) as usize;
        let mut time = self.next() - 0.8;
        let keys: Vec<_> = (0..keys)
            .map(|_| {
                time += 0.1 + 0.7 * self.next();
                (time, self.map(rigid))
            })
            .collect();
        Keyframes::new(&keys).expect("good keys")
    }

    /// Up to three keyed maps within each other, and still ones between.
    fn motion(&mut self, rigid: bool) -> Motion {
        let mut motion = Motion::still(self.map(rigid));
        for _ in 0..1 + (3.0 * self.next()) as usize {
            motion = motion.then(&Motion::keyed(self.keyframes(rigid))).then(&Motion::still(self.map(rigid)));
        }
        motion
    }
}

#[test]
fn bounds_hold_the_object_at_a_thousand_times() {
    for case in 0..60 {
        let mut random = Random::new(case);
        let motion = random.motion(case % 2 == 0);
        let (p, q) = (random.vector().as_vec3(), random.vector().as_vec3());
        let object = Aabb { min: p.min(q), max: p.max(q) };
        let open = 0.4 * random.next();
        let close = open + 0.8 * random.next();
        let boxes = motion.bounds(&object, [open, close]);
        for _ in 0..1000 {
            let s = random.next();
            let inside = random.vector() + 0.5;
            let p = object.min.as_dvec3() + inside.round() * object.extent().as_dvec3();
            let p = motion.at(open + s * (close - open)).transform_point3(p).as_vec3();
            let lerp = |a: Vec3, b: Vec3| (1.0 - s as f32) * a + s as f32 * b;
            let around =
                Aabb { min: lerp(boxes[0].min, boxes[1].min), max: lerp(boxes[0].max, boxes[1].max) };
            assert!(around.padded(1e-6).contains(p), "case {case}, s = {s}: {p} in {around:?}");
        }
    }
}

#[test]
fn bounds_of_steady_motion_are_tight() {
    let keys = [(0.0, DAffine3::IDENTITY), (2.0, DAffine3::from_translation(DVec3::new(8.0, -4.0, 0.0)))];
    let motion = Motion::keyed(Keyframes::new(&keys).unwrap());
    let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    let [open, close] = motion.bounds(&unit, [0.5, 1.5]);
    let near = |a: Vec3, x: f32, y: f32, z: f32| a.distance(Vec3::new(x, y, z)) < 1e-4;
    assert!(near(open.min, 2.0, -1.0, 0.0) && near(open.max, 3.0, 0.0, 1.0), "{open:?}");
    assert!(near(close.min, 6.0, -3.0, 0.0) && near(close.max, 7.0, -2.0, 1.0), "{close:?}");
    // A moment alone, and before all keys.
    for (interval, x) in [([1.0, 1.0], 4.0), ([-3.0, -1.0], 0.0), ([7.0, 9.0], 8.0)] {
        let boxes = motion.bounds(&unit, interval);
        assert!(boxes.iter().all(|b| near(b.min, x, -0.5 * x, 0.0)), "{interval:?}: {boxes:?}");
        assert!(motion.is_still_over(interval));
    }
    assert!(!motion.is_still_over([1.0, 1.1]));
}

/// A camera without a lens is a point: at rest, and on a straight way.
#[test]
fn bounds_of_points_hold_them() {
    let keys = [(0.0, DAffine3::IDENTITY), (1.0, DAffine3::from_translation(DVec3::new(2.0, 0.0, 0.0)))];
    let p = Aabb { min: Vec3::ONE, max: Vec3::ONE };
    for (motion, to) in [
        (Motion::still(DAffine3::IDENTITY), Vec3::ONE),
        (Motion::keyed(Keyframes::new(&keys).unwrap()), Vec3::new(3.0, 1.0, 1.0)),
    ] {
        let [open, close] = motion.bounds(&p, [0.0, 1.0]);
        assert!(
            open.padded(1e-5).contains(Vec3::ONE) && close.padded(1e-5).contains(to),
            "{open:?} {close:?}"
        );
        assert!(open.extent().max_element() < 1e-4, "{open:?}");
    }
}

#[test]
fn bounds_of_a_spin_are_those_of_its_circle() {
    let turned = |degrees: f64| DAffine3::from_rotation_z(degrees.to_radians());
    let keys = [0.0, 120.0, 240.0, 360.0].map(|degrees| (degrees / 360.0, turned(degrees)));
    let motion = Motion::keyed(Keyframes::new(&keys).unwrap());
    let blade = Aabb { min: Vec3::new(0.0, -0.1, 0.0), max: Vec3::new(2.0, 0.1, 0.1) };
    let boxes = motion.bounds(&blade, [0.0, 1.0]);
    // Half-way through, and on the whole.
    let half = |f: fn(&Aabb) -> Vec3| 0.5 * (f(&boxes[0]) + f(&boxes[1]));
    let [low, high] = [half(|b| b.min), half(|b| b.max)];
    assert!(low.truncate().abs().max(high.truncate()).max_element() < 2.05, "{boxes:?}");
    assert!(boxes[0].union(boxes[1]).extent().max_element() < 1.5 * 4.0, "{boxes:?}");
}

#[test]
fn rigid_motions_keep_distances() {
    for case in 0..100 {
        let mut random = Random::new(1000 + case);
        let motion = random.motion(true);
        for _ in 0..20 {
            let (t, p, q) = (2.0 * random.next() - 0.5, random.vector(), random.vector());
            let m = motion.at(t);
            let distance = m.transform_point3(p).distance(m.transform_point3(q));
            assert!((distance - p.distance(q)).abs() < 1e-12, "case {case}");
            assert!((m.matrix3.determinant() - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn keys_are_met_and_rest_outside() {
    for case in 0..100 {
        let mut random = Random::new(2000 + case);
        let maps = [random.map(false), random.map(false), random.map(false)];
        let keys = Keyframes::new(&[(1.0, maps[0]), (2.0, maps[1]), (4.0, maps[2])]).unwrap();
        for (t, m) in [(1.0, 0), (2.0, 1), (4.0, 2), (0.0, 0), (-1e9, 0), (5.0, 2), (1e9, 2)] {
            let p = random.vector();
            let off = keys.at(t).transform_point3(p).distance(maps[m].transform_point3(p));
            assert!(off < 1e-12, "case {case}, t = {t}: {off}");
        }
    }
}

#[test]
fn a_product_is_taken_at_each_time() {
    for case in 0..50 {
        let mut random = Random::new(3000 + case);
        let (outer, inner) = (random.motion(false), random.motion(false));
        let still = Motion::still(random.map(false));
        for (a, b) in [(&outer, &inner), (&still, &inner), (&outer, &still), (&still, &still)] {
            let both = a.then(b);
            let (t, p) = (random.next(), random.vector());
            let expected = (a.at(t) * b.at(t)).transform_point3(p);
            assert!(both.at(t).transform_point3(p).distance(expected) < 1e-9, "case {case}");
            assert_eq!(both.constant().is_some(), a.constant().is_some() && b.constant().is_some());
        }
        let placed = inner.then(&still);
        assert!(placed == inner.then(&still) && placed != inner && inner != outer);
    }
}

#[test]
fn keys_that_make_no_motion_are_refused() {
    let at = |t: f64| (t, DAffine3::IDENTITY);
    let scaled = |t: f64, x: f64| (t, DAffine3::from_scale(DVec3::new(x, 1.0, 1.0)));
    assert_eq!(Keyframes::new(&[at(0.0)]), Err(KeyError::Few));
    assert_eq!(Keyframes::new(&[at(0.0), at(1.0), at(1.0)]), Err(KeyError::Order(2)));
    assert_eq!(Keyframes::new(&[at(f64::NAN), at(1.0)]), Err(KeyError::Order(0)));
    assert_eq!(Keyframes::new(&[at(0.0), scaled(1.0, 0.0)]), Err(KeyError::NoInverse(1)));
    assert_eq!(Keyframes::new(&[at(0.0), scaled(1.0, 2.0), scaled(2.0, -1.0)]), Err(KeyError::Mirrors(2)));
    let half = Keyframes::new(&[at(0.0), (1.0, DAffine3::from_rotation_y(std::f64::consts::PI))]).unwrap();
    assert!(half.segments()[0].is_half_turn());
}
