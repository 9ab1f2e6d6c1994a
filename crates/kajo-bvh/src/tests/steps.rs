//! Work for a ray grows with the logarithm of the number of triangles.

use std::cell::Cell;

use kajo_math::{Ray, Vec4};

use super::meshes::{Mesh, Random};
use crate::simd::{Portable, Simd};
use crate::{BuildSettings, TriangleBvh};

thread_local!(static VISITS: Cell<usize> = const { Cell::new(0) });

/// [`Portable`], counting the nodes that are tested.
#[derive(Clone, Copy)]
struct Counting;

impl Simd for Counting {
    type F32x8 = <Portable as Simd>::F32x8;
    type F64x4 = <Portable as Simd>::F64x4;

    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
    fn splat(self, x: f32) -> Self::F32x8 {
        Portable.splat(x)
    }
    fn load(self, x: &[f32; 8]) -> Self::F32x8 {
        Portable.load(x)
    }
    fn store(self, x: Self::F32x8) -> [f32; 8] {
        Portable.store(x)
    }
    fn mul_add(self, a: Self::F32x8, b: Self::F32x8, c: Self::F32x8) -> Self::F32x8 {
        Portable.mul_add(a, b, c)
    }
    fn min(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8 {
        Portable.min(a, b)
    }
    fn max(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8 {
        Portable.max(a, b)
    }
    fn le(self, a: Self::F32x8, b: Self::F32x8) -> u32 {
        VISITS.set(VISITS.get() + 1);
        Portable.le(a, b)
    }
    fn widen(self, x: Vec4) -> Self::F64x4 {
        Portable.widen(x)
    }
    fn narrow(self, x: Self::F64x4) -> Vec4 {
        Portable.narrow(x)
    }
    fn splat_f64(self, x: f64) -> Self::F64x4 {
        Portable.splat_f64(x)
    }
    fn add_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4 {
        Portable.add_f64(a, b)
    }
    fn sub_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4 {
        Portable.sub_f64(a, b)
    }
    fn mul_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4 {
        Portable.mul_f64(a, b)
    }
    fn div_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4 {
        Portable.div_f64(a, b)
    }
    fn le_f64(self, a: Self::F64x4, b: Self::F64x4) -> u32 {
        Portable.le_f64(a, b)
    }
}

/// Nodes that a ray at a sphere of `20 * 4^level` triangles visits on average.
fn visits(level: usize) -> f64 {
    let mesh = Mesh::sphere(level);
    let tree = TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap();
    let (mut random, n) = (Random::new(5), 2000);
    VISITS.set(0);
    for _ in 0..n {
        let o = random.cube().normalize() * 3.0;
        let hit = tree.closest_on(Counting, &Ray::new(o, random.cube() * 0.5 - o));
        assert!(hit.is_some());
    }
    VISITS.get() as f64 / f64::from(n)
}

#[test]
fn twice_the_triangles_take_a_quarter_more_nodes_at_most() {
    // From 1280 triangles on; each level has four times as many.
    let deepest = if std::env::var_os("KAJO_DEEP").is_some() { 9 } else { 6 };
    let counts: Vec<f64> = (3..=deepest).map(visits).collect();
    for pair in counts.windows(2) {
        assert!(pair[1] <= pair[0] * 1.25 * 1.25, "{counts:?}");
    }
    assert!(counts[0] < 10.0, "{counts:?}");
}
