//! Laws of lobes besides density and energy, which `laws.rs` of the crate has for everything that draws directions.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3, rng::Stream, warp};
use kajo_testkit::sphere;

use super::super::*;
use super::list::{ROUGHNESSES, directions, families, mirrors, phong};

fn random(s: &Stream, k: u32) -> (Vec3, Vec3, Vec2, f32) {
    let v2 = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
    (warp::uniform_sphere(v2(k)), warp::uniform_sphere(v2(k + 2)), v2(k + 4), s.uniform(k + 6))
}

/// Largest difference of two spectra, relative to the larger of them and to 1.
fn difference(a: Spectrum, b: Spectrum) -> f32 {
    let largest = a.max_lane().max(b.max_lane()).max(1.0);
    (a - b).map(f32::abs).max_lane() / largest
}

#[test]
fn a_bsdf_is_small_and_copied() {
    fn copied<T: Copy>() -> usize {
        size_of::<T>()
    }
    assert!(copied::<Bsdf>() <= 128, "{} bytes", size_of::<Bsdf>());
}

#[test]
fn weights_are_values_over_densities() {
    for family in families() {
        for roughness in ROUGHNESSES {
            let lobe = (family.lobe)(roughness);
            for i in 0..200 {
                let (wo, _, u, uc) = random(&Stream::new(3, [i, 0], 0), 0);
                for mode in [Transport::Radiance, Transport::Importance] {
                    let Some(sample) = lobe.sample(wo, u, uc, mode) else { continue };
                    assert!((sample.wi.length() - 1.0).abs() < 1e-5);
                    let across = sample.wi.z * wo.z < 0.0;
                    assert_eq!(across, sample.kind.transmission, "{}", family.name);
                    if sample.kind.delta || wo.z.abs() < 0.01 || sample.wi.z.abs() < 0.01 {
                        continue;
                    }
                    let pdf = lobe.pdf(wo, sample.wi);
                    let place = format!("{} {roughness} from {wo} to {}", family.name, sample.wi);
                    assert!((pdf / sample.pdf - 1.0).abs() < 0.02, "{place}: {pdf} {}", sample.pdf);
                    let weight = lobe.eval(wo, sample.wi, mode) * (1.0 / pdf);
                    assert!(
                        difference(weight, sample.weight) < 2e-3,
                        "{place}: {weight:?} {:?}",
                        sample.weight
                    );
                }
            }
        }
    }
}

/// A highlight as wide as the half space around the mirror direction: it is drawn there and nowhere else.
#[test]
fn a_highlight_of_exponent_zero_ends_at_a_right_angle() {
    let lobe = phong(0.0, 0.8, 0.0, 0.0, 1.0);
    let mut behind = 0;
    for i in 0..200 {
        let (mut wo, mut wi, ..) = random(&Stream::new(6, [i, 0], 0), 0);
        (wo.z, wi.z) = (wo.z.abs(), wi.z.abs());
        let is_behind = Vec3::new(-wo.x, -wo.y, wo.z).dot(wi) < 0.0;
        behind += u32::from(is_behind);
        assert_eq!(lobe.pdf(wo, wi) == 0.0, is_behind);
        assert_eq!(lobe.eval(wo, wi, Transport::Radiance).is_black(), is_behind);
    }
    assert!(behind > 20, "{behind}");
}

/// Paths leave out the number where a lobe says that it needs none.
#[test]
fn a_lobe_that_is_not_choosy_does_as_well_without_a_number() {
    let lobes =
        families().into_iter().flat_map(|family| ROUGHNESSES.map(|r| (family.name, (family.lobe)(r))));
    let (mut choosy, mut plain) = (0, 0);
    for (name, lobe) in lobes.chain(mirrors()) {
        let differs = |i: u32| {
            let (wo, _, u, uc) = random(&Stream::new(5, [i, 0], 0), 0);
            let [with, without] = [uc, 0.0].map(|uc| lobe.sample(wo, u, uc, Transport::Radiance));
            with.map(|sample| sample.wi) != without.map(|sample| sample.wi)
        };
        match lobe.is_choosy() {
            true => choosy += u32::from((0..200).any(differs)),
            false => {
                plain += 1;
                assert!(!(0..200).any(differs), "{name}: {lobe:?}");
            }
        }
    }
    assert!(choosy > 10 && plain > 5, "{choosy} and {plain} in the list");
}

/// The light that goes from `wi` to `wo` is the same, whichever end a path begins at.
///
/// Some pairs of directions turn their last bits into more than rounding, such as those whose half vector is short. So much
/// may both ways differ twice.
#[test]
fn both_ways_are_one() {
    for family in families() {
        for roughness in ROUGHNESSES {
            let lobe = (family.lobe)(roughness);
            for i in 0..2000 {
                let (wo, wi, ..) = random(&Stream::new(4, [i, 0], 0), 0);
                if wo.z.abs() < 0.01 || wi.z.abs() < 0.01 {
                    continue;
                }
                // Times both cosines, so that grazing directions do not magnify rounding.
                let value = |wo: Vec3, wi| lobe.eval(wo, wi, Transport::Radiance) * wo.z.abs();
                let there = value(wo, wi);
                let back = lobe.eval(wi, wo, Transport::Importance) * wi.z.abs();
                let off = difference(there, back);
                let last_bits = || {
                    let changes = Vec3::AXES.map(|axis| {
                        let bit = 0.5 * f32::EPSILON * axis;
                        difference(value(wo + bit, wi), value(wo - bit, wi))
                            + difference(value(wo, wi + bit), value(wo, wi - bit))
                    });
                    0.5 * changes.iter().sum::<f32>()
                };
                assert!(
                    off < 1e-6 || off < 1e-6 + 2.0 * last_bits(),
                    "{} {roughness} {wo} {wi}: {there:?} {back:?}",
                    family.name
                );
            }
        }
    }
}

#[test]
fn mirrors_have_neither_value_nor_density_and_keep_all_light() {
    for (name, lobe) in mirrors() {
        assert!(lobe.is_delta(), "{name}");
        for wo in directions(12) {
            let energy = sphere::stratified_mean(64, 2, |u, uc| {
                let sample = lobe.sample(wo, u, uc, Transport::Importance).expect("nothing is lost");
                assert!(sample.kind.delta && (0.0..=1.0).contains(&sample.pdf), "{name}");
                assert!(lobe.eval(wo, sample.wi, Transport::Radiance).is_black());
                assert_eq!(lobe.pdf(wo, sample.wi), 0.0);
                f64::from(sample.weight.max_lane())
            });
            assert!((energy - 1.0).abs() < 1e-3, "{name} from {wo}: {energy}");
            assert!((lobe.albedo(wo).max_lane() - 1.0).abs() < 1e-5, "{name}");
        }
    }
}

/// Radiance refracted into a medium of index `eta` is `eta²` times as large, to and fro.
#[test]
fn radiance_is_squeezed_by_the_square_of_the_index() {
    for (family, eta) in [("glass", 1.5), ("diamond", 2.417), ("glass, Beckmann", 1.5)] {
        let lobes = families();
        let lobe = (lobes.iter().find(|f| f.name == family).expect("in the list").lobe)(0.1);
        let mut seen = 0;
        for i in 0..200 {
            let (wo, _, u, uc) = random(&Stream::new(6, [i, 0], 0), 0);
            let pair = [Transport::Radiance, Transport::Importance].map(|mode| lobe.sample(wo, u, uc, mode));
            let [Some(radiance), Some(importance)] = pair else { continue };
            let squeezed = if !radiance.kind.transmission {
                1.0
            } else if wo.z > 0.0 {
                eta
            } else {
                1.0 / eta
            };
            assert!((radiance.eta / squeezed - 1.0).abs() < 1e-5);
            let expected = importance.weight * (1.0 / (squeezed * squeezed));
            assert!(difference(radiance.weight, expected) < 1e-5, "{family}");
            seen += u32::from(radiance.kind.transmission);
        }
        assert!(seen > 50);
    }
}

/// Along the surface, straight down, denormal, and not even numbers: nothing but numbers comes out.
#[test]
fn hostile_directions_give_numbers() {
    let tiny = [0.0, -0.0, 1e-30, 1e-20, 1e-8, -1e-8, 1e-4];
    let mut places = vec![Vec3::Z, Vec3::NEG_Z];
    places.extend(tiny.map(|z| Vec3::new(1.0, 0.0, z)));
    places.extend(tiny.map(|z| Vec3::new(-0.6, 0.8, z)));
    places.push(Vec3::new(1e-20, 0.0, 1.0));
    let rough = families().into_iter().flat_map(|family| {
        [0.0, 1e-6, 1e-3, 2e-3, 0.1, 1.0].map(|roughness| (family.name, (family.lobe)(roughness)))
    });
    let u = [Vec2::ZERO, Vec2::ONE * (1.0 - f32::EPSILON), Vec2::new(0.0, 0.999_999), Vec2::splat(0.5)];
    for (name, lobe) in rough.chain(mirrors()) {
        for &wo in &places {
            for &wi in &places {
                let (f, pdf) = (lobe.eval(wo, wi, Transport::Radiance), lobe.pdf(wo, wi));
                assert!(f.is_finite() && f.to_rgb().iter().all(|&v| v >= 0.0), "{name} {wo} {wi}: {f:?}");
                assert!(pdf.is_finite() && pdf >= 0.0, "{name} {wo} {wi}: {pdf}");
            }
            assert!(lobe.albedo(wo).is_finite(), "{name} {wo}");
            for u in u {
                for uc in [0.0, 0.3, 0.999_999_9] {
                    let Some(sample) = lobe.sample(wo, u, uc, Transport::Radiance) else { continue };
                    assert!(
                        sample.wi.is_finite() && sample.weight.is_finite() && sample.pdf > 0.0,
                        "{name} {wo}"
                    );
                    assert!((sample.wi.length() - 1.0).abs() < 1e-4, "{name} {wo}: {}", sample.wi);
                    assert!(
                        sample.weight.to_rgb().iter().all(|&v| (0.0..1e3).contains(&v)),
                        "{name} {wo} {sample:?}"
                    );
                }
            }
        }
    }
}
