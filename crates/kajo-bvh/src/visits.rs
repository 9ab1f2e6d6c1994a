//! How many nodes and groups of triangles rays visit: work that no noise of a machine touches.

use std::cell::Cell;

use kajo_math::{Ray, Vec4};

use crate::TriangleBvh;
use crate::simd::{Portable, Simd};

thread_local!(static NODES: Cell<usize> = const { Cell::new(0) });

/// Nodes and groups of four triangles that were tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visits {
    /// Nodes of up to eight children.
    pub nodes: usize,
    /// Groups of up to four triangles.
    pub groups: usize,
}

impl TriangleBvh {
    /// What finding the closest hits of `rays` takes, the same on all machines.
    pub fn closest_visits(&self, rays: &[Ray]) -> Visits {
        NODES.set(0);
        let mut groups = 0;
        for ray in rays {
            self.closest_by(Counting, ray, |tested| groups += tested.len());
        }
        Visits { nodes: NODES.get(), groups }
    }

    /// What it takes to find out which of `rays` hit anything, the same on all machines.
    pub fn any_visits(&self, rays: &[Ray]) -> Visits {
        NODES.set(0);
        let mut groups = 0;
        for ray in rays {
            self.any_by(Counting, ray, || groups += 1);
        }
        Visits { nodes: NODES.get(), groups }
    }
}

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
        NODES.set(NODES.get() + 1);
        Portable.le(a, b)
    }
    fn halves(self, x: Self::F32x8) -> [Vec4; 2] {
        Portable.halves(x)
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
