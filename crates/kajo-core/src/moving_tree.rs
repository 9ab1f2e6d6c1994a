//! A tree over what moves while the shutter is open.
//!
//! Boxes that move steadily fit loosely around what turns. So the shutter's interval is cut into slices of equal
//! length, each with a tree of its own, as long as twice as many make the boxes much smaller; a ray asks the one
//! that holds its time. The number is a power of two, so that times within slices are exact.

use kajo_bvh::{BuildSettings, MovingBvh};
use kajo_math::{Aabb, Ray};

/// The most slices.
const MOST_SLICES: u32 = 16;

/// Twice as many slices must make boxes smaller than this share of their area.
const GAIN: f32 = 0.8;

/// The most boxes in all slices, where there is more than one slice.
const MOST_BOXES: usize = 1 << 22;

/// Boxes that are looked at to choose the number of slices.
const LOOKED_AT: usize = 256;

/// Trees over moving boxes, one for each slice of the shutter's interval.
#[derive(Debug)]
pub(crate) struct MovingTree {
    slices: Vec<MovingBvh>,
}

impl MovingTree {
    /// A tree over the boxes with these numbers.
    ///
    /// * `bounds`: a box at the two ends of a part of the shutter's interval, given by its ends in `[0, 1]`; the box
    ///   that moves steadily between them holds the object; empty for what is not to be in the tree
    /// * `count`: how many numbers there are
    pub fn build(
        count: usize,
        bounds: impl Fn(usize, [f64; 2]) -> [Aabb; 2],
        settings: &BuildSettings,
    ) -> MovingTree {
        let n = slices(count, &bounds);
        let slice = |k: u32| {
            let boxes: Vec<[Aabb; 2]> = (0..count).map(|i| bounds(i, part(k, n))).collect();
            MovingBvh::build(&boxes, settings)
        };
        MovingTree { slices: (0..n).map(slice).collect() }
    }

    /// See [`MovingBvh::closest`].
    #[inline]
    pub fn closest(&self, ray: &Ray, hit: impl FnMut(u32, f32) -> f32) {
        let (tree, ray) = self.slice(ray);
        tree.closest(&ray, hit);
    }

    /// See [`MovingBvh::any`].
    #[inline]
    pub fn any(&self, ray: &Ray, hit: impl FnMut(u32) -> bool) -> bool {
        let (tree, ray) = self.slice(ray);
        tree.any(&ray, hit)
    }

    /// See [`MovingBvh::each`].
    #[inline]
    pub fn each(&self, ray: &Ray, visit: impl FnMut(u32)) {
        let (tree, ray) = self.slice(ray);
        tree.each(&ray, visit);
    }

    /// Bytes of all slices.
    pub fn bytes(&self) -> usize {
        self.slices.iter().map(|tree| tree.stats().bytes).sum()
    }

    /// The tree of a ray's time, and the ray with its time within the slice.
    #[inline]
    fn slice(&self, ray: &Ray) -> (&MovingBvh, Ray) {
        let x = ray.time.clamp(0.0, 1.0) * self.slices.len() as f32;
        let k = (x as usize).min(self.slices.len() - 1);
        (&self.slices[k], Ray { time: x - k as f32, ..*ray })
    }
}

/// The ends of slice `k` of `n`.
fn part(k: u32, n: u32) -> [f64; 2] {
    [f64::from(k) / f64::from(n), f64::from(k + 1) / f64::from(n)]
}

/// The number of slices that pays.
fn slices(count: usize, bounds: &impl Fn(usize, [f64; 2]) -> [Aabb; 2]) -> u32 {
    let step = count.div_ceil(LOOKED_AT).max(1);
    let area = |n: u32| {
        let middle = |i: usize, k: u32| {
            let [open, close] = bounds(i, part(k, n));
            Aabb { min: 0.5 * (open.min + close.min), max: 0.5 * (open.max + close.max) }.half_area()
        };
        let sum: f32 = (0..count)
            .step_by(step)
            .flat_map(|i| (0..n).map(move |k| (i, k)))
            .map(|(i, k)| middle(i, k))
            .sum();
        sum / n as f32
    };
    let mut n = 1;
    let mut size = area(n);
    while n < MOST_SLICES && 2 * n as usize * count <= MOST_BOXES {
        let halved = area(2 * n);
        if halved >= GAIN * size {
            break;
        }
        (n, size) = (2 * n, halved);
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{MovingTransform, Shutter};
    use kajo_math::{DAffine3, DVec3, Keyframes, Motion, Vec3};

    /// A blade that turns by an angle and moves along.
    fn blade(degrees: f64, along: f64) -> MovingTransform {
        let there = DAffine3::from_translation(DVec3::new(along, 0.0, 0.0))
            * DAffine3::from_rotation_z(degrees.to_radians());
        let keys = [(0.0, DAffine3::IDENTITY), (1.0, there)];
        MovingTransform::new(Motion::keyed(Keyframes::new(&keys).unwrap()), Shutter::default())
    }

    const BLADE: Aabb = Aabb { min: Vec3::new(0.9, -0.05, 0.0), max: Vec3::new(1.1, 0.05, 0.1) };

    fn tree(map: &MovingTransform) -> MovingTree {
        MovingTree::build(1, |_, part| map.bounds(&BLADE, part), &BuildSettings::default())
    }

    #[test]
    fn what_turns_far_is_sliced_and_what_moves_straight_is_not() {
        assert_eq!(tree(&blade(0.0, 5.0)).slices.len(), 1);
        assert!(tree(&blade(150.0, 0.0)).slices.len() >= 4);
    }

    #[test]
    fn rays_of_all_times_find_what_is_there() {
        let map = blade(150.0, 0.5);
        let tree = tree(&map);
        for i in 0..=1000u16 {
            let time = f32::from(i) / 1000.0;
            let at = map.at(time).point(Vec3::new(1.0, 0.0, 0.05));
            let ray = Ray { time, ..Ray::new(at + 3.0 * Vec3::Z, Vec3::NEG_Z) };
            let mut found = [0; 3];
            tree.closest(&ray, |_, t_max| {
                found[0] += 1;
                t_max
            });
            tree.each(&ray, |_| found[1] += 1);
            found[2] += i32::from(tree.any(&ray, |_| true));
            assert_eq!(found, [1; 3], "at {time}");
        }
    }
}
