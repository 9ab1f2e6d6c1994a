//! Lenses and fisheyes as scenes ask for them, and the patterns of samples.

use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_scene::{MemoryAssets, Severity};

use super::*;
use crate::camera::{Aperture, Camera, FisheyeProjection, ThinLens};
use crate::sampler::SamplerKind;

const BASIS: &str = "center 0 0 10 direction 0 0 -1 up 0 1 0";

/// The scene of a camera, or the errors. `white.png` and `black.png` are pictures.
fn scene(block: &str) -> Result<Scene, Vec<String>> {
    let picture = |v| {
        let image = Image::filled(4, 4, &[v; 3]).expect("a small picture");
        encode(&image, Format::Png, &EncodeOptions::default()).expect("a PNG file")
    };
    let assets = MemoryAssets::new().with("white.png", picture(1.0)).with("black.png", picture(0.0));
    let mut parsed = SceneDesc::parse_str(block);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    let errors: Vec<String> =
        diagnostics.iter().filter(|d| d.severity == Severity::Error).map(|d| d.message.clone()).collect();
    if errors.is_empty() { scene.ok_or(errors) } else { Err(errors) }
}

/// The lens of a perspective camera with these keys.
fn lens(keys: &str) -> Result<Option<ThinLens>, Vec<String>> {
    let scene = scene(&format!("PerspectiveCamera {{ {BASIS} angle 30 {keys} }}"))?;
    let Camera::Perspective(camera) = scene.camera else { panic!("another camera") };
    Ok(camera.lens().cloned())
}

#[test]
fn a_lens_has_the_diameter_and_the_shape_that_was_asked_for() {
    let radius = |keys| lens(keys).expect("no errors").map(|lens| (lens.radius, lens.focus));
    assert_eq!(radius(""), None);
    assert_eq!(radius("focus 5"), None, "a pinhole is in focus everywhere");
    assert_eq!(radius("aperture 0 focus 5"), None);
    assert_eq!(radius("aperture 0.5 focus 5"), Some((0.25, 5.0)));
    assert_eq!(radius("focalLength 0.5 fNumber 2 focus 2"), Some((0.125, 2.0)));
    let shape =
        |keys: &str| lens(&format!("aperture 1 focus 5 {keys}")).expect("no errors").map(|l| l.aperture);
    assert!(matches!(shape(""), Some(Aperture::Round)));
    assert!(matches!(shape("blades 6 bladeRotation 180"),
        Some(Aperture::Polygon { blades: 6, rotation }) if (rotation - std::f64::consts::PI).abs() < 1e-9));
    assert!(matches!(shape("bokeh \"white.png\""), Some(Aperture::Picture(_))));
    let telecentric = scene(&format!("OrthographicCamera {{ {BASIS} size 3 aperture 1 focus 5 }}"));
    assert!(telecentric.expect("no errors").camera.has_lens());
}

#[test]
fn a_lens_that_cannot_be_is_an_error() {
    let errors = |keys| lens(keys).expect_err(keys).join("; ");
    assert!(errors("aperture 0.5").contains("`focus`"), "{}", errors("aperture 0.5"));
    assert!(errors("fNumber 2 focus 5").contains("`focalLength`"));
    assert!(errors("aperture 1 focalLength 1 fNumber 2 focus 5").contains("either"));
    assert!(errors("aperture 1 focus 5 bokeh \"black.png\"").contains("no light"));
    assert!(errors("aperture 1 focus 5 bokeh \"none.png\"").contains("none.png"));
    for keys in ["aperture -1 focus 5", "aperture 1 focus 0", "aperture 1 focus 5 blades 2"] {
        errors(keys);
    }
}

#[test]
fn fisheyes_have_limits_by_their_projection() {
    let fisheye = |keys: &str| scene(&format!("FisheyeCamera {{ {BASIS} {keys} }}"));
    let Camera::Fisheye(camera) = fisheye("").expect("no errors").camera else { panic!("another camera") };
    assert_eq!((camera.projection, camera.to_corners), (FisheyeProjection::Equidistant, false));
    assert!((camera.angle - std::f64::consts::PI).abs() < 1e-6);
    assert!(fisheye("angle 220 projection equisolid fit corners").is_ok());
    assert!(fisheye("angle 220 projection orthographic").is_err());
    assert!(fisheye("angle 361").is_err());
    assert!(fisheye("angle 0").is_err());
}

#[test]
fn every_pattern_of_samples_has_its_name() {
    for (name, kind) in SamplerKind::NAMES {
        let text = format!("PerspectiveCamera {{ {BASIS} angle 30 }} Settings {{ samples {name} 9 }}");
        assert_eq!(scene(&text).expect("no errors").settings.samples, Some((kind, 9)), "{name}");
        assert_eq!(SamplerKind::from_name(name), Some(kind));
    }
    let text = format!("PerspectiveCamera {{ {BASIS} angle 30 }} Settings {{ samples sobel 9 }}");
    assert_eq!(scene(&text).err().map(|errors| errors.len()), Some(1));
    assert!(scene(&text.replace("sobel 9", "sobol 0")).is_err(), "nothing would be seen");
    assert_eq!(SamplerKind::from_name("sobel"), None);
}
