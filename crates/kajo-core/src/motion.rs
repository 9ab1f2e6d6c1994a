//! Things that move while the shutter is open.
//!
//! A ray has a moment `s` in the shutter interval, 0 at the opening and 1 at the closing. It meets every object
//! where that is at the time `open + s (close - open)`: the picture is the mean over that interval, the integral
//! of motion blur by one more dimension of samples [Cook, Porter and Carpenter 1984].

use kajo_math::{Aabb, Affine3A, DAffine3, Motion, Transform, Vec3};

/// From when to when the shutter is open, in the time of the scene's keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shutter {
    /// The moment of a ray at time 0.
    pub open: f64,
    /// The moment of a ray at time 1, not before `open`.
    pub close: f64,
    /// The moment at which patterns in world space are painted on what moves.
    pub painted: f64,
}

impl Default for Shutter {
    fn default() -> Shutter {
        Shutter::new(0.0, 1.0)
    }
}

impl Shutter {
    /// The shutter that is open from `open` to `close`; patterns are painted at time 0.
    pub const fn new(open: f64, close: f64) -> Shutter {
        Shutter { open, close, painted: 0.0 }
    }

    /// The moment of a ray's time.
    #[inline]
    fn moment(&self, time: f32) -> f64 {
        self.open + f64::from(time) * (self.close - self.open)
    }

    /// The interval as a pair.
    pub fn interval(&self) -> [f64; 2] {
        [self.open, self.close]
    }
}

/// A map from object to world space that changes with the time of a ray.
#[derive(Clone, Debug)]
pub struct MovingTransform {
    motion: Motion,
    shutter: Shutter,
    /// The map, if it is the same for all rays.
    resting: Option<Transform>,
    /// Whether what is mapped moves within its own space.
    holds_moving: bool,
    /// The map when patterns are painted.
    painted: Transform,
}

impl MovingTransform {
    /// The map `motion` as seen through the shutter.
    pub fn new(motion: Motion, shutter: Shutter) -> MovingTransform {
        let resting = motion.is_still_over(shutter.interval());
        let resting = resting.then(|| Transform::of_invertible(&motion.at(shutter.open)));
        let painted = Transform::of_invertible(&motion.at(shutter.painted));
        MovingTransform { motion, shutter, resting, holds_moving: false, painted }
    }

    /// The map at a ray's time.
    #[inline]
    pub fn at(&self, time: f32) -> Transform {
        self.resting.unwrap_or_else(|| Transform::of_invertible(&self.map_at(time)))
    }

    /// The same in double precision.
    #[inline]
    pub fn map_at(&self, time: f32) -> DAffine3 {
        self.motion.at(self.shutter.moment(time))
    }

    /// Whether what is mapped is elsewhere for other rays, in whole or in part.
    pub fn moves(&self) -> bool {
        self.resting.is_none() || self.holds_moving
    }

    /// Whether what is mapped moves within its own space.
    #[inline]
    pub(crate) fn holds_moving(&self) -> bool {
        self.holds_moving
    }

    /// Takes note that what is mapped moves within its own space.
    pub(crate) fn hold_moving(&mut self) {
        self.holds_moving = true;
    }

    /// Whether the map differs between rays.
    pub(crate) fn is_moving_map(&self) -> bool {
        self.resting.is_none()
    }

    /// `inner` first and then this.
    pub(crate) fn then(&self, inner: &MovingTransform) -> MovingTransform {
        MovingTransform::new(self.motion.then(&inner.motion), self.shutter)
    }

    /// Boxes for the two ends of a part of the shutter's interval such that the box that moves steadily from one to
    /// the other holds the image of `b` at all times.
    ///
    /// * `part`: the ends, in [0, 1]
    pub fn bounds(&self, b: &Aabb, part: [f64; 2]) -> [Aabb; 2] {
        let Shutter { open, close, .. } = self.shutter;
        self.motion.bounds(b, part.map(|s| open + s * (close - open)))
    }

    /// A box around the image of `b` at all times.
    pub fn bounds_of_all_times(&self, b: &Aabb) -> Aabb {
        let [open, close] = self.bounds(b, [0.0, 1.0]);
        open.union(close)
    }

    /// Where the point of the object that is at the world-space point `p` at a ray's time is when patterns are painted.
    ///
    /// Patterns in world space are painted there, and so go along with the object.
    pub fn painted(&self, p: Vec3, time: f32) -> Vec3 {
        self.painted.point(self.at(time).object_from_world.transform_point3(p))
    }

    /// The same for a point of a part that moves by `inner` within the object.
    pub(crate) fn painted_part(&self, inner: &MovingTransform, p: Vec3, time: f32) -> Vec3 {
        let own = self.at(time).object_from_world.transform_point3(p);
        self.painted.point(inner.painted(own, time))
    }

    /// Where the point that is at `p` at a ray's time is at that of another one.
    pub(crate) fn carried(&self, p: Vec3, [from, to]: [f32; 2]) -> Vec3 {
        self.at(to).point(self.at(from).object_from_world.transform_point3(p))
    }

    /// How things have moved from the time of a ray to that of another one.
    pub(crate) fn between(&self, [from, to]: [f32; 2]) -> Transform {
        Transform::of_invertible(&(self.map_at(to) * self.map_at(from).inverse()))
    }

    /// The unit normal there of a surface whose normal at a ray's time is `n`.
    ///
    /// * `inner`: how the part moves within the object, where it does
    pub(crate) fn painted_normal(&self, inner: Option<&MovingTransform>, n: Vec3, time: f32) -> Vec3 {
        // By the inverse transposes of all maps.
        let own = self.at(time).world_from_object.matrix3.transpose() * n;
        let own = inner.map_or(own, |inner| inner.painted_normal(None, own, time));
        (self.painted.object_from_world.matrix3.transpose() * own).normalize_or(n)
    }

    /// From the world as patterns are painted in it to the space of the object.
    pub fn object_from_painted(&self) -> Affine3A {
        self.painted.object_from_world
    }

    /// The map at some times that tell whether it ever changes shapes.
    pub fn sampled_maps(&self) -> impl Iterator<Item = DAffine3> {
        (0..=32u8).map(|i| self.map_at(f32::from(i) / 32.0))
    }

    /// How far things that start as they are when the shutter opens have moved at a ray's time.
    pub fn since_opening(&self) -> MovingTransform {
        let back = Motion::still(self.map_at(0.0).inverse());
        MovingTransform::new(self.motion.then(&back), self.shutter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{DVec3, Keyframes};

    fn moving(shutter: Shutter) -> MovingTransform {
        let there = DAffine3::from_translation(DVec3::X) * DAffine3::from_rotation_z(1.0);
        let keys = [(0.0, DAffine3::IDENTITY), (2.0, there)];
        MovingTransform::new(Motion::keyed(Keyframes::new(&keys).unwrap()), shutter)
    }

    #[test]
    fn times_of_rays_are_shares_of_the_shutter() {
        let map = moving(Shutter::new(0.5, 1.5));
        assert!(map.moves());
        assert_eq!(map.at(0.5).world_from_object.translation.x, 0.5);
        assert_eq!(map.at(1.0).world_from_object.translation.x, 0.75);
        for shutter in [Shutter::new(1.0, 1.0), Shutter::new(3.0, 4.0)] {
            let map = moving(shutter);
            assert!(!map.moves());
            assert_eq!(map.at(0.0), map.at(1.0));
            let expected = moving(Shutter::new(0.0, 4.0)).at(0.25 * shutter.open as f32);
            let p = Vec3::new(3.0, 4.0, 5.0);
            assert!(map.at(0.3).point(p).distance(expected.point(p)) < 1e-6);
        }
    }

    #[test]
    fn patterns_stay_on_the_object() {
        let map = moving(Shutter::new(0.5, 1.5));
        let p = Vec3::new(3.0, 4.0, 5.0);
        for time in [0.0, 0.4, 1.0] {
            // The map at time 0 of the scene is the identity.
            assert!(map.painted(map.at(time).point(p), time).distance(p) < 1e-5);
        }
        let since = map.since_opening();
        assert!(since.at(0.0).point(p).distance(p) < 1e-6);
        let start = map.at(0.0).point(p);
        assert!(since.at(0.7).point(start).distance(map.at(0.7).point(p)) < 1e-5);
    }
}
