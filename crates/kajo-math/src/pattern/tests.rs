//! Laws that every pattern keeps.

use super::*;

/// Values at a few places, as bits, which are the same on every machine.
const GOLDEN: &str = include_str!("golden.txt");

fn all() -> Vec<SolidPattern> {
    AnyPattern::all().into_iter().map(SolidPattern::new).collect()
}

#[test]
fn every_pattern_is_in_range_and_uses_it() {
    for pattern in all() {
        let (mut least, mut most, mut cut) = (1.0f32, 0.0f32, 0);
        for i in 0..20_000 {
            let q = 50.0 * spread(i);
            let raw = pattern.pattern().at(q, 0.0);
            cut += u32::from(!(0.0..=1.0).contains(&raw));
            let v = pattern.at(q, 0.0);
            assert!((0.0..=1.0).contains(&v), "{pattern:?} {q}: {v}");
            (least, most) = (least.min(v), most.max(v));
        }
        assert!(cut <= 100, "{}: {cut} of 20000 are cut off", pattern.pattern().name());
        assert!(most - least > 0.5, "{}: {least} {most}", pattern.pattern().name());
    }
}

#[test]
fn bad_places_have_the_mean() {
    let (huge, tiny) = (f32::MAX, f32::from_bits(1));
    for pattern in all() {
        for q in
            [Vec3::splat(f32::NAN), Vec3::X * f32::INFINITY, Vec3::splat(-huge), Vec3::new(0.0, 1e7, 0.0)]
        {
            assert_eq!(pattern.at(q, 0.0), pattern.mean(), "{pattern:?} {q}");
        }
        for q in [Vec3::ZERO, -Vec3::ZERO, Vec3::splat(tiny), Vec3::splat(1e6), Vec3::splat(-1_048_576.0)] {
            for width in [0.0, tiny, 0.1, 1.0, huge, f32::INFINITY, f32::NAN] {
                let v = pattern.at(q, width);
                assert!((0.0..=1.0).contains(&v), "{pattern:?} {q} {width}: {v}");
            }
        }
    }
}

#[test]
fn means_are_means_and_wide_samples_see_them() {
    for pattern in all() {
        let n = 30_000u32;
        let value = |i| f64::from(pattern.at(32.0 * spread(i + 77_777), 0.0));
        let mean = ((0..n).map(value).sum::<f64>() / f64::from(n)) as f32;
        assert!(
            (mean - pattern.mean()).abs() < 0.015,
            "{}: {mean} {}",
            pattern.pattern().name(),
            pattern.mean()
        );
        for i in 0..50 {
            let q = 20.0 * spread(i) + Vec3::new(60.0, 0.0, 0.0);
            let widest = 1.0 / pattern.pattern().frequency(q);
            if widest.is_finite() {
                assert_eq!(pattern.at(q, widest), pattern.mean(), "{}", pattern.pattern().name());
            }
        }
    }
}

#[test]
fn wide_samples_have_lost_all_variance() {
    for pattern in all() {
        let n = 30_000u32;
        let squares = (0..n).map(|i| {
            let off = f64::from(pattern.at(32.0 * spread(i + 77_777), 0.0) - pattern.mean());
            off * off
        });
        let variance = (squares.sum::<f64>() / f64::from(n)) as f32;
        for i in 0..50 {
            let q = 20.0 * spread(i) + Vec3::new(60.0, 0.0, 0.0);
            let widest = 1.0 / pattern.pattern().frequency(q);
            if widest.is_finite() {
                let lost = pattern.lost(q, widest);
                assert!(
                    (lost / variance - 1.0).abs() < 0.06,
                    "{}: {lost} {variance}",
                    pattern.pattern().name()
                );
            }
            assert_eq!(pattern.lost(q, 0.0), 0.0);
        }
    }
}

/// What is left varies by so much less over all places as each of them has lost.
#[test]
fn variances_add_up() {
    let patterns = [
        (AnyPattern::from(Clouds::default()), 0.1),
        (Turbulence::default().into(), 0.1),
        (Granite::default().into(), 0.03),
        (Waves::default().into(), 0.15),
        (Brick::default().into(), 0.05),
        (Checks.into(), 0.3),
    ];
    for (pattern, width) in patterns {
        let pattern = SolidPattern::new(pattern);
        let n = 30_000u32;
        let place = |i| 200.0 * spread(i);
        let variance = |width: f32| {
            let values = (0..n).map(|i| f64::from(pattern.at(place(i), width)));
            let (sum, squares) = values.fold((0.0, 0.0), |(s, q), v| (s + v, q + v * v));
            squares / f64::from(n) - (sum / f64::from(n)).powi(2)
        };
        let lost = (0..n).map(|i| f64::from(pattern.lost(place(i), width))).sum::<f64>() / f64::from(n);
        let (all, left) = (variance(0.0), variance(width));
        let name = pattern.pattern().name();
        assert!(lost > 0.02 * all, "{name}: {lost} of {all}");
        assert!((left + lost - all).abs() < 0.06 * all, "{name}: {left} + {lost} is not {all}");
    }
}

/// Averages over as many points as lie between samples: where what is between is faded, that is what is left.
#[test]
fn a_band_limit_brings_a_pattern_nearer_to_its_average() {
    for pattern in all() {
        let (mut sharp, mut faded) = (0.0f64, 0.0f64);
        for i in 0..200 {
            let q = 20.0 * spread(i) + Vec3::new(40.0, 0.0, 0.0);
            let width = 0.75 / pattern.pattern().frequency(q);
            if !width.is_finite() {
                continue;
            }
            let around = (0..200).map(|k| pattern.at(q + width * spread(k + 999), 0.0)).sum::<f32>() / 200.0;
            sharp += f64::from(pattern.at(q, 0.0) - around).powi(2);
            faded += f64::from(pattern.at(q, width) - around).powi(2);
        }
        assert!(faded <= 0.5 * sharp, "{}: {faded} {sharp}", pattern.pattern().name());
    }
}

#[test]
fn values_are_the_same_on_every_machine() {
    let places = [Vec3::new(0.3, 1.7, -2.2), Vec3::new(-41.6, 7.25, 13.9), Vec3::new(1234.5, -0.01, 98.7)];
    let mut found = String::new();
    for pattern in all() {
        found += pattern.pattern().name();
        for (q, width) in places.into_iter().zip([0.0, 0.0, 0.02]) {
            found += &format!(" {:08x}", pattern.at(q, width).to_bits());
        }
        found += "\n";
    }
    let moved = places.map(|q| TurbulentWarp::default().moved(q, 0.0).x.to_bits());
    found += &format!("Warp {:08x} {:08x} {:08x}\n", moved[0], moved[1], moved[2]);
    assert!(found == GOLDEN, "found\n{found}");
}

#[test]
fn another_seed_is_another_pattern() {
    let octaves = |seed| Octaves { seed, ..Octaves::default() };
    let differs = |a: AnyPattern, b: AnyPattern| {
        let [a, b] = [a, b].map(SolidPattern::new);
        let far = |i: &u32| (a.at(9.0 * spread(*i), 0.0) - b.at(9.0 * spread(*i), 0.0)).abs() > 1e-3;
        assert!((0..200).filter(far).count() > 100, "{a:?}");
    };
    differs(Clouds(octaves(0)).into(), Clouds(octaves(1)).into());
    differs(Worley::default().into(), Worley { seed: 1, ..Worley::default() }.into());
    differs(Cells { seed: 0 }.into(), Cells { seed: 1 }.into());
    differs(Gabor::default().into(), Gabor { seed: 1, ..Gabor::default() }.into());
}
