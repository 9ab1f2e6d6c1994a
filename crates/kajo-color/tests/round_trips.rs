//! Colours through the spectrum and back, and spectra through random wavelengths.

use kajo_color::gamut::{self, xyz_of};
use kajo_color::{Emission, Outside, Reflectance, RgbBasis, Spectrum, Tabulated, Wavelengths};
use kajo_color::{named, observer, sensor};
use kajo_math::rng::Stream;
use kajo_testkit::{Estimate, delta_e_2000, lab};

/// What the sensor sees of `f` under `n` evenly spread heroes: XYZ.
fn seen(n: u32, f: impl Fn(&Wavelengths) -> Spectrum) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for i in 0..n {
        let lambda = Wavelengths::sample((i as f32 + 0.5) / n as f32);
        for (sum, x) in sum.iter_mut().zip(sensor::to_xyz(f(&lambda), &lambda)) {
            *sum += f64::from(x) / f64::from(n);
        }
    }
    sum
}

/// Linear sRGB as CIELAB under D65.
fn lab_of_rgb(rgb: [f64; 3]) -> [f64; 3] {
    lab(kajo_color::matrix::apply(&sensor::XYZ_FROM_RGB, rgb), white())
}

fn white() -> [f64; 3] {
    kajo_color::matrix::apply(&sensor::XYZ_FROM_RGB, [1.0; 3])
}

/// A thousand display colours: the corners of the cube and others at random.
fn colours() -> impl Iterator<Item = [f32; 3]> {
    (0..1000u32).map(|i| {
        let stream = Stream::new(4, [i, 0], 0);
        let component = |d| if i < 8 { (i >> d & 1) as f32 } else { stream.uniform(d) };
        [0, 1, 2].map(|d| kajo_color::srgb::decode(component(d)))
    })
}

#[test]
fn a_thousand_colours_come_back_from_their_spectra() {
    let light = Emission::from_rgb([1.0; 3]);
    for rgb in colours() {
        let paint = Reflectance::from_rgb(rgb);
        let on_paint = lab(seen(2000, |lambda| paint.at(lambda) * light.at(lambda)), white());
        let coloured = Emission::from_rgb(rgb);
        let of_light = lab(seen(2000, |lambda| coloured.at(lambda)), white());
        let of_picture = lab(seen(2000, |lambda| RgbBasis::new(lambda).emission(rgb)), white());
        let expected = lab_of_rgb(rgb.map(f64::from));
        for found in [on_paint, of_light, of_picture] {
            let off = delta_e_2000(found, expected);
            assert!(off < 0.1, "{rgb:?} differs by {off}: {found:?} for {expected:?}");
        }
        assert!(!paint.was_clamped());
    }
}

#[test]
fn bright_lights_keep_their_strength() {
    for rgb in [[250.0, 30.0, 2.0], [0.001, 0.004, 0.0005], [7e4, 7e4, 7e4]] {
        let light = Emission::from_rgb(rgb);
        let xyz = seen(2000, |lambda| light.at(lambda));
        let found = kajo_color::matrix::apply(&sensor::RGB_FROM_XYZ, xyz);
        let largest = f64::from(rgb[0].max(rgb[1]));
        for i in 0..3 {
            assert!((found[i] - f64::from(rgb[i])).abs() < 5e-4 * largest, "{rgb:?}: {found:?}");
        }
        assert!((xyz[1] - f64::from(light.luminance())).abs() < 1e-3 * xyz[1]);
    }
}

/// Random heroes, all four lanes or the hero alone, estimate the integrals that the tables give.
#[test]
fn random_wavelengths_integrate_what_the_observer_sees() {
    let lights = ["A", "D65", "F11", "HP1", "LED-B3"].map(|name| named::illuminant(name).unwrap());
    let paint = Reflectance::from_rgb([0.6, 0.3, 0.1]);
    for (l, light) in lights.iter().enumerate() {
        let expected = seen(200_000, |lambda| light.at(lambda) * paint.at(lambda));
        for terminate in [false, true] {
            for (channel, expected) in expected.into_iter().enumerate() {
                let n = 4_000;
                let estimate = Estimate::of_batches(|batch| {
                    let sample = |i| {
                        let u = Stream::new(11, [i, batch], l as u32).uniform(channel as u32);
                        let mut lambda = Wavelengths::sample(u);
                        if terminate {
                            lambda.terminate_secondary();
                        }
                        f64::from(sensor::to_xyz(light.at(&lambda) * paint.at(&lambda), &lambda)[channel])
                    };
                    (0..n).map(sample).sum::<f64>() / f64::from(n)
                });
                estimate.check(expected, 0.02).unwrap();
            }
        }
    }
}

/// Two paints that match in daylight and part under a light.
#[test]
fn a_metameric_pair_matches_under_d65_and_parts_under_a() {
    // A measured-looking spectrum with a bump, and the smooth one of the same colour.
    let bump = |nm: f32| {
        0.25 + 0.35 * (-((nm - 600.0) / 25.0).powi(2)).exp() + 0.2 * (-((nm - 450.0) / 30.0).powi(2)).exp()
    };
    let measured =
        Tabulated::new((0..=94).map(|i| 360.0 + 5.0 * i as f32).map(|nm| (nm, bump(nm))), Outside::Clamp);
    let measured = Reflectance::from_spectrum(&measured.unwrap());
    let smooth = Reflectance::from_rgb(measured.rgb());
    let part = |name: &str| {
        let light = named::illuminant(name).unwrap();
        let white = seen(20_000, |lambda| light.at(lambda));
        let [one, two] =
            [&measured, &smooth].map(|paint| lab(seen(20_000, |l| light.at(l) * paint.at(l)), white));
        delta_e_2000(one, two)
    };
    assert!(part("D65") < 0.02, "{}", part("D65"));
    let (under_a, under_f11) = (part("A"), part("F11"));
    assert!((under_a - METAMERS_UNDER_A).abs() < 0.003, "{under_a}");
    assert!(under_f11 > 2.0, "{under_f11}");
}

/// The difference of the pair under A, as another program finds it from the bump and its own fit of the smooth spectrum [colour-science 0.4.7].
const METAMERS_UNDER_A: f64 = 3.6505;

#[test]
fn lights_of_the_observer_and_of_gamuts_agree() {
    // The white of the sensor is that of sRGB, to the fifth digit of the chromaticity.
    let [x, y] = gamut::xy_of(seen(20_000, |lambda| Emission::from_rgb([1.0; 3]).at(lambda)));
    assert!((x - 0.3127).abs() < 5e-5 && (y - 0.3290).abs() < 5e-5, "{x} {y}");
    let [_, luminance, _] = xyz_of(gamut::WHITE_D65);
    let flat = Tabulated::new([(300.0, 1.0), (900.0, 1.0)], Outside::Clamp).unwrap();
    assert!((observer::xyz_of(&flat)[1] - luminance).abs() < 1e-6);
}
