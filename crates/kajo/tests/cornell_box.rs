//! The box that path tracers are compared in: its mean is known from another program.

use kajo::{
    BitDepth, Defaults, Format, IntegratorName, LoadOptions, MemoryAssets, RenderRequest, RenderSettings,
    SamplerKind, Settings, Silent, View, load_from, render,
};
use kajo_image::DecodeLimits;

const BOX: &str = include_str!("../../../scenes/bench/cornell_box.txt");

/// The mean over all pixels, of a picture of a million paths.
fn mean(integrator: &'static str, bounces: u32) -> [f64; 3] {
    let assets = MemoryAssets::new().with("box.txt", BOX);
    let loaded = load_from("box.txt", &assets, &LoadOptions::default());
    assert!(loaded.diagnostics.is_empty(), "{}", loaded.report(false));
    let scene = loaded.scene.unwrap();
    let asked = Settings {
        integrator: Some(IntegratorName(integrator)),
        bounces: Some(bounces),
        size: Some([64, 64]),
        samples: Some((SamplerKind::Sobol, 256)),
        ..Settings::default()
    };
    let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
    let picture =
        render(&RenderRequest::new(&scene, &settings, &[(View::Color, Format::Exr)]), &Silent).unwrap();
    let bytes = picture.encode(&[View::Color], Format::Exr, BitDepth::Eight).unwrap();
    let image = kajo_image::decode(&bytes, Some(Format::Exr), &DecodeLimits::default()).unwrap().image;
    let n = image.pixels().len() as f64;
    image.pixels().fold([0.0; 3], |sum, pixel| [0, 1, 2].map(|c| sum[c] + f64::from(pixel[c]) / n))
}

fn is_near(mean: [f64; 3], expected: [f64; 3], tolerance: f64) -> bool {
    mean.iter().zip(expected).all(|(m, e)| (m / e - 1.0).abs() < tolerance)
}

/// Mitsuba 3.9 with many samples, to four digits: with seven scattering events, and in red with six and with eight.
#[test]
fn the_mean_is_that_of_another_program() {
    let expected = [0.2402, 0.1412, 0.0600];
    for integrator in ["path", "bidirectional"] {
        let found = mean(integrator, 6);
        assert!(is_near(found, expected, 0.003), "{integrator:?}: {found:?}");
    }
    for (bounces, red) in [(5, 0.2376), (7, 0.2417)] {
        let found = mean("path", bounces)[0];
        assert!((found / red - 1.0).abs() < 0.003, "{bounces}: {found}");
        assert!(!is_near([found; 3], [expected[0]; 3], 0.005), "the depths cannot be told apart");
    }
}
