//! What packets of rays take beyond what single rays do.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;

use kajo_math::Vec4;

#[cfg(target_arch = "x86_64")]
use super::avx::Avx;
use super::{Portable, Simd};

/// Arithmetic of rays side by side.
pub(crate) trait PacketSimd: Simd {
    fn add(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8;
    fn sub(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8;
    fn mul(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8;
    fn div(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8;
    /// Bit `i` tells whether `a < b` in lane `i`.
    fn lt(self, a: Self::F32x8, b: Self::F32x8) -> u32;
    /// Bit `i` is the sign of lane `i`, set for negative zero.
    fn signs(self, x: Self::F32x8) -> u32;
    /// Of two halves.
    fn join(self, halves: [Vec4; 2]) -> Self::F32x8;
}

impl PacketSimd for Portable {
    #[inline(always)]
    fn add(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] + b[0], a[1] + b[1]]
    }
    #[inline(always)]
    fn sub(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] - b[0], a[1] - b[1]]
    }
    #[inline(always)]
    fn mul(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] * b[0], a[1] * b[1]]
    }
    #[inline(always)]
    fn div(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] / b[0], a[1] / b[1]]
    }
    #[inline(always)]
    fn lt(self, a: [Vec4; 2], b: [Vec4; 2]) -> u32 {
        a[0].cmplt(b[0]).bitmask() | a[1].cmplt(b[1]).bitmask() << 4
    }
    #[inline(always)]
    fn signs(self, x: [Vec4; 2]) -> u32 {
        x[0].is_negative_bitmask() | x[1].is_negative_bitmask() << 4
    }
    #[inline(always)]
    fn join(self, halves: [Vec4; 2]) -> [Vec4; 2] {
        halves
    }
}

// SAFETY of every block below: `self` proves that the processor has the instruction.
#[cfg(target_arch = "x86_64")]
impl<const WIDE: bool> PacketSimd for Avx<WIDE> {
    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_div_ps(a, b) }
    }
    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32 }
    }
    #[inline(always)]
    fn signs(self, x: __m256) -> u32 {
        // SAFETY: as above.
        unsafe { _mm256_movemask_ps(x) as u32 }
    }
    #[inline(always)]
    fn join(self, [a, b]: [Vec4; 2]) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_set_m128(b.into(), a.into()) }
    }
}
