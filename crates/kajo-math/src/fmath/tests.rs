use super::*;
use crate::rng::mix;

/// Distance of a result from the exact one in units in the last place of the exact one.
///
/// What is beyond the largest number is to be infinite, what is no number is to be none.
fn ulps(got: f32, exact: f64) -> f64 {
    // Numbers from here on round to infinity.
    let infinite = 2f64.powi(128) - 2f64.powi(103);
    if exact.is_nan() || got.is_nan() || exact.abs() >= infinite || got.is_infinite() {
        let exact = if exact.abs() >= infinite { f64::INFINITY.copysign(exact) } else { exact };
        let near = f64::from(got) == exact || exact.is_nan() && got.is_nan();
        // Rounding may go either way within an ulp of the border.
        let border = (exact.abs() / 2f64.powi(128) - 1.0).abs() < 1e-7 || got.abs() == f32::MAX;
        return if near {
            0.0
        } else if border {
            1.0
        } else {
            f64::INFINITY
        };
    }
    let smallest = f64::from(f32::MIN_POSITIVE);
    let exponent = (exact.abs().max(smallest).to_bits() >> 52) as i32 - 1023;
    (f64::from(got) - exact).abs() / 2f64.powi(exponent - 23)
}

/// Checks a function on one number of 4099, of each sign and exponent; with `KAJO_DEEP` set, on all there are.
#[track_caller]
fn check(name: &str, most: f64, f: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64) {
    let stride = if std::env::var_os("KAJO_DEEP").is_some() { 1 } else { 4099 };
    let mut worst = (0.0, 0.0);
    for bits in (0..=u32::MAX).step_by(stride) {
        let x = f32::from_bits(bits);
        let error = ulps(f(x), exact(f64::from(x)));
        if error > worst.0 {
            worst = (error, x);
        }
    }
    println!("{name}: {:.4} ulp at {:e}", worst.0, worst.1);
    assert!(worst.0 <= most, "{name}: {} ulp at {:e}, {:e}", worst.0, worst.1, f(worst.1));
}

/// The same of a function of two numbers, on pairs that `pair` makes of random bits.
#[track_caller]
fn check_pairs(
    name: &str,
    most: f64,
    [f, exact]: [&dyn Fn(f64, f64) -> f64; 2],
    pair: impl Fn(u32, u32) -> [f32; 2],
) {
    let n = if std::env::var_os("KAJO_DEEP").is_some() { 1 << 28 } else { 1 << 18 };
    let mut worst = (0.0, [0.0; 2]);
    for i in 0..n {
        let bits = mix(i);
        let [x, y] = pair(bits as u32, (bits >> 32) as u32);
        let error = ulps(f(x.into(), y.into()) as f32, exact(x.into(), y.into()));
        if error > worst.0 {
            worst = (error, [x, y]);
        }
    }
    println!("{name}: {:.4} ulp at {:?}", worst.0, worst.1);
    assert!(worst.0 <= most, "{name}: {} ulp at {:?}", worst.0, worst.1);
}

fn finite(bits: u32) -> f32 {
    let x = f32::from_bits(bits);
    if x.is_finite() { x } else { f32::from_bits(bits ^ 1 << 30) }
}

/// A number of [-1, 1).
fn signed(bits: u32) -> f32 {
    (bits >> 8) as f32 / 8_388_608.0 - 1.0
}

#[test]
fn sine_is_within_an_ulp() {
    check("sin", 1.0, sin, sin64);
}

#[test]
fn cosine_is_within_an_ulp() {
    check("cos", 1.0, cos, cos64);
}

#[test]
fn tangent_is_within_an_ulp_and_a_quarter() {
    check("tan", 1.25, tan, tan64);
}

#[test]
fn one_less_the_cosine_is_within_two_ulp() {
    let exact = |x: f64| 2.0 * sin64(0.5 * x) * sin64(0.5 * x);
    // Where the cosine is from 1/2 to 0.71 its ulp is two of the difference.
    check("one_minus_cos", 2.0, one_minus_cos, exact);
}

#[test]
fn sine_and_cosine_together_are_the_single_ones() {
    for bits in (0..=u32::MAX).step_by(40_009) {
        let x = f32::from_bits(bits);
        let (s, c) = sin_cos(x);
        assert_eq!([s, c].map(f32::to_bits), [sin(x), cos(x)].map(f32::to_bits), "{x:e}");
    }
}

/// Through all exponents, and densely where expressions are: next to quarter turns, and up to the first thousand.
#[test]
fn sines_and_cosines_of_double_precision_have_the_bits_of_the_library() {
    let check = |x: f64| {
        let bits = |(sin, cos): (f64, f64)| [sin.to_bits(), cos.to_bits()];
        let expected = bits(libm::sincos(x));
        assert_eq!(bits(sincos64(x)), expected, "{x:e}");
        assert_eq!(bits((sin64(x), cos64(x))), expected, "{x:e}");
        let single = [libm::sin(x), libm::cos(x)].map(f64::to_bits);
        assert_eq!(single, expected, "{x:e}");
    };
    [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY].into_iter().for_each(check);
    assert!(sin64(f64::NAN).is_nan() && cos64(f64::NAN).is_nan());
    for i in 0..200_000_u64 {
        let word = mix(i);
        // Any number but infinities and what is none.
        check(f64::from_bits(word & !(1 << 62) | (word & 1) << 61));
        let unit = (word >> 11) as f64 / 9_007_199_254_740_992.0;
        for range in [1.0, 8.0, 1e3, 2e6] {
            check((2.0 * unit - 1.0) * range);
        }
        let end = (i % 2000) as f64 * std::f64::consts::FRAC_PI_4;
        for off in [0.0, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3] {
            check(end * (1.0 + (unit - 0.5) * off));
            check(-(end + (unit - 0.5) * off));
        }
    }
}

/// Where an angle nearly is a whole number of quarter turns, the rest has few digits of its own.
#[test]
fn angles_next_to_quarter_turns_keep_their_digits() {
    for k in (0..4000u32).chain((0..120).map(|e| 1u32.rotate_left(e % 32) + e)) {
        let nearest = (f64::from(k) * std::f64::consts::FRAC_PI_2) as f32;
        for step in -3..=3 {
            let x = f32::from_bits(nearest.to_bits().saturating_add_signed(step));
            let exact = f64::from(x);
            assert!(ulps(sin(x), sin64(exact)) < 1.0, "sin {x:e}");
            assert!(ulps(cos(-x), cos64(exact)) < 1.0, "cos {x:e}");
            assert!(ulps(tan(x), tan64(exact)) < 1.2, "tan {x:e}");
            let less = 2.0 * sin64(0.5 * exact) * sin64(0.5 * exact);
            assert!(ulps(one_minus_cos(x), less) <= 2.0, "1 - cos {x:e}");
        }
    }
}

#[test]
fn arc_sine_is_within_an_ulp() {
    check("asin", 1.0, asin, asin64);
}

#[test]
fn arc_cosine_is_within_an_ulp() {
    check("acos", 1.0, acos, libm::acos);
}

#[test]
fn exponential_is_within_an_ulp() {
    check("exp", 1.0, exp, exp64);
}

#[test]
fn exponential_less_one_is_within_an_ulp_and_a_quarter() {
    check("exp_m1", 1.23, exp_m1, exp_m1_64);
}

#[test]
fn logarithm_is_within_an_ulp() {
    check("ln", 1.0, ln, libm::log);
}

#[test]
fn error_function_is_within_one_and_a_half_ulp() {
    check("erf", 1.44, erf, erf64);
}

#[test]
fn angles_of_points_are_within_an_ulp() {
    let both: [&dyn Fn(f64, f64) -> f64; 2] = [&|y, x| atan2(y as f32, x as f32).into(), &atan2_64];
    check_pairs("atan2 of any numbers", 1.0, both, |a, b| [finite(a), finite(b)]);
    check_pairs("atan2 in a square", 1.0, both, |a, b| [signed(a), signed(b)]);
    check_pairs("atan2 of like numbers", 1.0, both, |a, b| {
        let x = finite(a);
        [(f64::from(x) * f64::from(1.0 + signed(b))).clamp(-3.4e38, 3.4e38) as f32, x]
    });
}

fn powers() -> [&'static dyn Fn(f64, f64) -> f64; 2] {
    [&|x, y| pow(x as f32, y as f32).into(), &libm::pow]
}

#[test]
fn powers_are_within_an_ulp() {
    let positive = |bits: u32| finite(bits & 0x7FFF_FFFF);
    // Exponents that are whole by chance go another way.
    let broken = |y: f32| if y == y.trunc() { y + 0.25 } else { y };
    check_pairs("pow of any numbers", 1.0, powers(), |a, b| [positive(a), broken(finite(b))]);
    check_pairs("pow of colours", 1.0, powers(), |a, b| [0.5 + 0.5 * signed(a), broken(3.0 * signed(b))]);
    let within_range = |x: f32, b: u32| {
        let log = libm::log2(x.into());
        [x, broken((150.0 * f64::from(signed(b)) / log).clamp(-1e30, 1e30) as f32)]
    };
    check_pairs("pow with results of any size", 1.0, powers(), |a, b| within_range(positive(a), b));
    check_pairs("pow of numbers near 1", 1.0, powers(), |a, b| within_range(1.05 + 0.4 * signed(a), b));
}

#[test]
fn whole_powers_are_within_an_ulp_and_a_quarter() {
    // Of double precision, by products: within a few millionths of an ulp.
    let exact = |x: f64, n: f64| x.powi(n as i32);
    // Bases of which none has a power below 1e-30 or beyond the largest number.
    let bases = |most: i32| [1e-30, 3.4e38].map(|end: f64| end.powf(1.0 / f64::from(most)));
    for (most, error) in [(8, 0.51), (64, 0.55), (1024, 1.25)] {
        let [low, high] = bases(most);
        check_pairs("whole powers", error, [powers()[0], &exact], |a, b| {
            let share = f64::from(0.5 + 0.5 * signed(a));
            let size = (low + (high.min(3.0) - low) * share) as f32;
            [if b & 1 == 0 { size } else { -size }, (b >> 1) as f32 % (most + 1) as f32]
        });
    }
    // The higher the power, the larger the error: all bases of the highest.
    let [low, high] = bases(1024).map(|base| (base as f32).to_bits());
    for x in (low + 1..high).map(f32::from_bits) {
        let error = ulps(powi(x, 1024), exact(x.into(), 1024.0));
        assert!(error <= 1.25, "{x}^1024: {error} ulp");
    }
    // Smaller ones have lost digits.
    for i in 0..100_000 {
        let (x, n) = (0.5 + 0.5 * signed(mix(i) as u32), (mix(i) >> 32) as u32 % 1025);
        let exact = libm::pow(x.into(), n.into());
        if exact < 1e-30 {
            assert!((f64::from(powi(x, n)) - exact).abs() < 1e-34, "{x}^{n}");
        }
    }
    assert_eq!([pow(0.0, 0.0), powi(0.0, 0), powi(0.0, 7), pow(0.3, 1.0)], [1.0, 1.0, 0.0, 0.3]);
    assert_eq!(
        [powi(1e20, 2), powi(-1e20, 3), powi(3.0, 1024)],
        [f32::INFINITY, f32::NEG_INFINITY, f32::INFINITY]
    );
}

/// Every pair of numbers that are special, or next to such ones.
#[test]
fn powers_and_angles_of_special_numbers_are_those_of_the_standard() {
    let sizes = [
        0.0,
        1e-45,
        1.1e-38,
        f32::MIN_POSITIVE,
        1e-20,
        0.25,
        0.999_999_94,
        1.0,
        1.000_000_1,
        1.5,
        2.0,
        3.0,
        17.0,
        127.5,
        128.0,
        1e10,
        16_777_215.0,
        16_777_216.0,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    for x in sizes.into_iter().flat_map(|x| [x, -x]) {
        for y in sizes.into_iter().flat_map(|y| [y, -y]) {
            let power = ulps(pow(x, y), libm::pow(x.into(), y.into()));
            assert!(power < 1.0, "{x:e}^{y:e}: {:e}", pow(x, y));
            let (angle, exact) = (atan2(y, x), atan2_64(y.into(), x.into()));
            assert!(ulps(angle, exact) < 1.0, "atan2({y:e}, {x:e}): {angle:e} {exact:e}");
            assert_eq!(
                angle.is_sign_negative(),
                exact.is_sign_negative() && !exact.is_nan() || angle.is_nan() && angle.is_sign_negative()
            );
        }
    }
}

/// Zeros keep their sign, and no finite angle, however large, makes something that is no number.
#[test]
fn zeros_infinities_and_numbers_out_of_range() {
    for f in [sin, tan, asin, erf] {
        assert_eq!(f(0.0).to_bits(), 0);
        assert_eq!(f(-0.0).to_bits(), 1 << 31);
        assert_eq!(f(1e-45), 1e-45);
        assert!(f(f32::NAN).is_nan());
    }
    for f in [sin, cos, tan, one_minus_cos] {
        assert!(f(f32::INFINITY).is_nan() && f(f32::NEG_INFINITY).is_nan() && f(f32::NAN).is_nan());
        assert!((0..255 << 23).step_by(1 << 16).all(|bits| f(f32::from_bits(bits)).is_finite()));
    }
    assert!(
        [asin(1.000_000_1), acos(-1.000_000_1), acos(f32::NAN), ln(-1e-45), exp(f32::NAN)]
            .iter()
            .all(|x| x.is_nan())
    );
    assert_eq!(
        [exp(f32::NEG_INFINITY), exp(-104.0), exp(0.0), exp(f32::INFINITY)],
        [0.0, 0.0, 1.0, f32::INFINITY]
    );
    assert_eq!(
        [ln(0.0), ln(-0.0), ln(1.0), ln(f32::INFINITY)],
        [f32::NEG_INFINITY, f32::NEG_INFINITY, 0.0, f32::INFINITY]
    );
    assert_eq!([erf(f32::INFINITY), erf(-4.0), acos(1.0), cos(0.0)], [1.0, -1.0, 0.0, 1.0]);
}
