//! Eight floats at a time, by what the processor at hand can do.
//!
//! [`Avx2`] exists only where the processor has AVX2 and FMA, found out at run time; [`Avx512`]
//! is the same instructions with twice the registers, and masks that need no register of
//! their own; [`Portable`] exists everywhere and becomes SSE2 on x86-64 and NEON on ARM by way of
//! glam. Kernels are written once, generic over [`Simd`], inlined into
//! [`Simd::vectorize`], and so compiled once for each.
//!
//! [`Simd::mul_add`] may round once or twice: it must decide only what may differ between
//! machines, which is how tightly a box encloses, never what is hit.
#![allow(unsafe_code, reason = "intrinsics, each behind a proof that the processor has them")]

#[cfg(any(test, feature = "bench"))]
mod packet;

use kajo_math::Vec4;

#[cfg(any(test, feature = "bench"))]
pub(crate) use packet::PacketSimd;

/// A set of instructions that works on eight floats.
pub(crate) trait Simd: Copy {
    /// Eight floats.
    type F32x8: Copy;

    /// Runs `f`, with everything inlined into it compiled for this set.
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R;
    fn splat(self, x: f32) -> Self::F32x8;
    fn load(self, x: &[f32; 8]) -> Self::F32x8;
    fn store(self, x: Self::F32x8) -> [f32; 8];
    /// `a b + c`, rounded once or twice.
    fn mul_add(self, a: Self::F32x8, b: Self::F32x8, c: Self::F32x8) -> Self::F32x8;
    fn min(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8;
    fn max(self, a: Self::F32x8, b: Self::F32x8) -> Self::F32x8;
    /// Bit `i` tells whether `a <= b` in lane `i`.
    fn le(self, a: Self::F32x8, b: Self::F32x8) -> u32;
    /// The first and the last four.
    fn halves(self, x: Self::F32x8) -> [Vec4; 2];

    /// Four doubles; every operation rounds once, the same on all machines.
    type F64x4: Copy;

    fn widen(self, x: Vec4) -> Self::F64x4;
    fn narrow(self, x: Self::F64x4) -> Vec4;
    fn splat_f64(self, x: f64) -> Self::F64x4;
    fn add_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4;
    fn sub_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4;
    fn mul_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4;
    fn div_f64(self, a: Self::F64x4, b: Self::F64x4) -> Self::F64x4;
    /// Bit `i` tells whether `a <= b` in lane `i`.
    fn le_f64(self, a: Self::F64x4, b: Self::F64x4) -> u32;
}

/// The instructions that rays are traced with on the machine at hand, by name.
pub fn instructions() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    match avx::level() {
        avx::Level::Avx512 => return "AVX-512",
        avx::Level::Avx2 => return "AVX2",
        avx::Level::Baseline => {}
    }
    match std::env::consts::ARCH {
        "x86_64" => "SSE2",
        "aarch64" => "NEON",
        _ => "scalar",
    }
}

/// Two halves of four, each a register on most machines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Simd for Portable {
    type F32x8 = [Vec4; 2];

    #[inline(always)]
    fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
        f()
    }
    #[inline(always)]
    fn splat(self, x: f32) -> [Vec4; 2] {
        [Vec4::splat(x); 2]
    }
    #[inline(always)]
    fn load(self, x: &[f32; 8]) -> [Vec4; 2] {
        [Vec4::from_slice(&x[..4]), Vec4::from_slice(&x[4..])]
    }
    #[inline(always)]
    fn store(self, x: [Vec4; 2]) -> [f32; 8] {
        let mut out = [0.0; 8];
        x[0].write_to_slice(&mut out[..4]);
        x[1].write_to_slice(&mut out[4..]);
        out
    }
    #[inline(always)]
    fn mul_add(self, a: [Vec4; 2], b: [Vec4; 2], c: [Vec4; 2]) -> [Vec4; 2] {
        [a[0] * b[0] + c[0], a[1] * b[1] + c[1]]
    }
    #[inline(always)]
    fn min(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0].min(b[0]), a[1].min(b[1])]
    }
    #[inline(always)]
    fn max(self, a: [Vec4; 2], b: [Vec4; 2]) -> [Vec4; 2] {
        [a[0].max(b[0]), a[1].max(b[1])]
    }
    #[inline(always)]
    fn le(self, a: [Vec4; 2], b: [Vec4; 2]) -> u32 {
        a[0].cmple(b[0]).bitmask() | a[1].cmple(b[1]).bitmask() << 4
    }
    #[inline(always)]
    fn halves(self, x: [Vec4; 2]) -> [Vec4; 2] {
        x
    }

    type F64x4 = [f64; 4];

    #[inline(always)]
    fn widen(self, x: Vec4) -> [f64; 4] {
        x.to_array().map(f64::from)
    }
    #[inline(always)]
    fn narrow(self, x: [f64; 4]) -> Vec4 {
        Vec4::from_array(x.map(|x| x as f32))
    }
    #[inline(always)]
    fn splat_f64(self, x: f64) -> [f64; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn add_f64(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub_f64(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul_f64(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn div_f64(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [0, 1, 2, 3].map(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn le_f64(self, a: [f64; 4], b: [f64; 4]) -> u32 {
        (0..4).fold(0, |bits, i| bits | u32::from(a[i] <= b[i]) << i)
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use avx::{Avx2, Avx512};

/// Evaluates an expression with the best [`Simd`] this machine has.
///
/// `wide:` before it adds [`Avx512`] to the choice: for kernels that keep much at hand, as each
/// choice is compiled on its own.
macro_rules! dispatch {
    (wide: $simd:ident => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        if let Some($simd) = $crate::simd::Avx512::detect() {
            return $crate::simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            );
        }
        $crate::simd::dispatch!($simd => $body)
    }};
    ($simd:ident => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        if let Some($simd) = $crate::simd::Avx2::detect() {
            return $crate::simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            );
        }
        let $simd = $crate::simd::Portable;
        $crate::simd::Simd::vectorize(
            $simd,
            #[inline(always)]
            || $body,
        )
    }};
}
pub(crate) use dispatch;

#[cfg(target_arch = "x86_64")]
mod avx {
    use std::arch::x86_64::*;
    use std::sync::OnceLock;

    use super::{Simd, Vec4};

    /// Proof that the processor has AVX2 and FMA, and if `WIDE` the registers of AVX-512.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx<const WIDE: bool>(());

    pub(crate) type Avx2 = Avx<false>;
    pub(crate) type Avx512 = Avx<true>;

    /// The sets that kernels are compiled for, each with all of the one before.
    #[derive(Clone, Copy, PartialEq, PartialOrd)]
    pub(super) enum Level {
        Baseline,
        Avx2,
        Avx512,
    }

    /// What the processor has. A ray is too short to ask for each feature again.
    #[inline(always)]
    pub(super) fn level() -> Level {
        static LEVEL: OnceLock<Level> = OnceLock::new();
        *LEVEL.get_or_init(|| {
            let avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt");
            let avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq");
            match (avx2, avx512) {
                (true, true) => Level::Avx512,
                (true, false) => Level::Avx2,
                (false, _) => Level::Baseline,
            }
        })
    }

    impl Avx512 {
        /// The proof, where it holds.
        #[inline(always)]
        pub(crate) fn detect() -> Option<Avx512> {
            (level() >= Level::Avx512).then_some(Avx(()))
        }
    }

    impl Avx2 {
        /// The proof, where it holds.
        #[inline(always)]
        pub(crate) fn detect() -> Option<Avx2> {
            (level() >= Level::Avx2).then_some(Avx(()))
        }
    }

    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
    fn run<R>(f: impl FnOnce() -> R) -> R {
        f()
    }

    #[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt,avx512f,avx512vl,avx512bw,avx512dq")]
    fn run_wide<R>(f: impl FnOnce() -> R) -> R {
        f()
    }

    // SAFETY of every block below: `self` proves that the processor has the instruction.
    impl<const WIDE: bool> Simd for Avx<WIDE> {
        type F32x8 = __m256;

        #[inline(always)]
        fn vectorize<R>(self, f: impl FnOnce() -> R) -> R {
            // SAFETY: as above.
            unsafe { if WIDE { run_wide(f) } else { run(f) } }
        }
        #[inline(always)]
        fn splat(self, x: f32) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_set1_ps(x) }
        }
        #[inline(always)]
        fn load(self, x: &[f32; 8]) -> __m256 {
            // SAFETY: as above, and eight floats lie at the address.
            unsafe { _mm256_loadu_ps(x.as_ptr()) }
        }
        #[inline(always)]
        fn store(self, x: __m256) -> [f32; 8] {
            let mut out = [0.0; 8];
            // SAFETY: as above, and there is room for eight floats.
            unsafe { _mm256_storeu_ps(out.as_mut_ptr(), x) };
            out
        }
        #[inline(always)]
        fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }
        #[inline(always)]
        fn min(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_min_ps(a, b) }
        }
        #[inline(always)]
        fn max(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: as above.
            unsafe { _mm256_max_ps(a, b) }
        }
        #[inline(always)]
        fn le(self, a: __m256, b: __m256) -> u32 {
            // SAFETY: as above.
            unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b)) as u32 }
        }
        #[inline(always)]
        fn halves(self, x: __m256) -> [Vec4; 2] {
            // SAFETY: as above.
            unsafe { [_mm256_castps256_ps128(x).into(), _mm256_extractf128_ps::<1>(x).into()] }
        }

        type F64x4 = __m256d;

        #[inline(always)]
        fn widen(self, x: Vec4) -> __m256d {
            // SAFETY: as above.
            unsafe { _mm256_cvtps_pd(x.into()) }
        }
        #[inline(always)]
        fn narrow(self, x: __m256d) -> Vec4 {
            // SAFETY: as above.
            unsafe { _mm256_cvtpd_ps(x) }.into()
        }
        #[inline(always)]
        fn splat_f64(self, x: f64) -> __m256d {
            // SAFETY: as above.
            unsafe { _mm256_set1_pd(x) }
        }
        #[inline(always)]
        fn add_f64(self, a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: as above.
            unsafe { _mm256_add_pd(a, b) }
        }
        #[inline(always)]
        fn sub_f64(self, a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: as above.
            unsafe { _mm256_sub_pd(a, b) }
        }
        #[inline(always)]
        fn mul_f64(self, a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: as above.
            unsafe { _mm256_mul_pd(a, b) }
        }
        #[inline(always)]
        fn div_f64(self, a: __m256d, b: __m256d) -> __m256d {
            // SAFETY: as above.
            unsafe { _mm256_div_pd(a, b) }
        }
        #[inline(always)]
        fn le_f64(self, a: __m256d, b: __m256d) -> u32 {
            // SAFETY: as above.
            unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(a, b)) as u32 }
        }
    }
}

/// A stack of fixed capacity that costs nothing to set up.
///
/// Capacity is a promise of the builder (depth of the tree times children of a node); the
/// check on every push only guards the memory.
pub(crate) struct Stack<T: Copy, const N: usize> {
    len: usize,
    items: [std::mem::MaybeUninit<T>; N],
}

impl<T: Copy, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Stack { len: 0, items: [const { std::mem::MaybeUninit::uninit() }; N] }
    }

    #[inline(always)]
    pub(crate) fn push(&mut self, item: T) {
        self.items[self.len].write(item);
        self.len += 1;
    }

    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: only `push` raises `len`, after writing the item below it.
        Some(unsafe { self.items.get_unchecked(self.len).assume_init() })
    }

    /// The items from number `start` on, oldest first.
    #[inline(always)]
    pub(crate) fn from(&mut self, start: usize) -> &mut [T] {
        let items = &mut self.items[start..self.len];
        // SAFETY: items below `len` were written.
        unsafe { items.assume_init_mut() }
    }

    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.len
    }
}
