//! Lenses and fisheyes as scenes ask for them, and the patterns of samples.

use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::DVec3;
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
    let Camera::Perspective(camera) = scene.output.camera else { panic!("another camera") };
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
    assert!(telecentric.expect("no errors").output.camera.has_lens());
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
    let Camera::Fisheye(camera) = fisheye("").expect("no errors").output.camera else {
        panic!("another camera")
    };
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
        assert_eq!(scene(&text).expect("no errors").output.settings.samples, Some((kind, 9)), "{name}");
        assert_eq!(SamplerKind::from_name(name), Some(kind));
    }
    let text = format!("PerspectiveCamera {{ {BASIS} angle 30 }} Settings {{ samples sobel 9 }}");
    assert_eq!(scene(&text).err().map(|errors| errors.len()), Some(1));
    assert!(scene(&text.replace("sobel 9", "sobol 0")).is_err(), "nothing would be seen");
    assert_eq!(SamplerKind::from_name("sobel"), None);
}

/// Two balls and a floor without end, seen by these cameras.
fn room(cameras: &str) -> String {
    format!(
        "{cameras} Materials {{ Matte {{ }} }} Settings {{ size 200 100 }} Group {{ MaterialIndex 0
         Sphere red {{ center 2 1 0 radius 1 }} Transform pair {{ Translate 0 5 0 Sphere blue {{ center 0 0 0 radius 0.5 }} }}
         Plane floor {{ normal 0 1 0 offset 0 }} Define row {{ Sphere {{ center -4 0 0 radius 0.1 }} }} Instance row }}"
    )
}

/// The eye, the direction, and where a point appears in a picture twice as wide as high.
fn seen(cameras: &str, p: DVec3) -> (DVec3, DVec3, kajo_math::DVec2) {
    let scene = scene(&room(cameras)).unwrap_or_else(|errors| panic!("{cameras}: {errors:?}"));
    let frame = *scene.output.camera.frame();
    (frame.center, frame.forward, scene.output.camera.project(p, 2.0, 0.0).expect("in view"))
}

#[test]
fn cameras_look_at_points_and_objects() {
    let forward =
        |keys: &str| seen(&format!("PerspectiveCamera {{ {keys} angle 40 }}"), DVec3::new(0.0, 5.0, 0.0));
    let expected = DVec3::new(2.0, 1.0, -9.0).normalize();
    for keys in [
        "center 0 0 9 target 2 1 0",
        "center 0 0 9 target red",
        "center 0 0 9 lookAt red up 0 1 0",
        "lookAt 0 0 9 2 1 0",
        "lookAt 0 0 9  2 1 0  0 1 0",
    ] {
        let (eye, found, _) = forward(keys);
        assert!(eye == DVec3::new(0.0, 0.0, 9.0) && found.distance(expected) < 1e-6, "{keys}: {eye} {found}");
    }
    // Names of blocks around things count too, those of definitions, and all together.
    for (keys, to) in [("target pair", 5.0), ("target blue", 5.0), ("target row", 0.0)] {
        let (_, found, _) = forward(&format!("center 0 {to} 9 {keys}"));
        assert!(found.y.abs() < 1e-6, "{keys}: {found}");
    }
}

#[test]
fn what_is_fitted_touches_the_margin() {
    for (keys, kind) in [
        ("fit red 0.1", "PerspectiveCamera"),
        ("fit red 0.1 direction 1 -1 -1 angle 60", "PerspectiveCamera"),
        ("fit red 0.1 center -7 3 8", "PerspectiveCamera"),
        ("fit red 0.1 up 0 0 1", "OrthographicCamera"),
        ("fit red 0.1 direction 0 0 -1 center 2 1 30", "OrthographicCamera"),
    ] {
        let (_, forward, _) = seen(&format!("{kind} {{ {keys} }}"), DVec3::new(2.0, 1.0, 0.0));
        // The highest and lowest point of the ball as it is seen, by small steps around its rim.
        let camera = scene(&room(&format!("{kind} {{ {keys} }}"))).unwrap().output.camera;
        let up = camera.frame().up;
        let rim = (0..2000).map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / 2000.0;
            let p = DVec3::new(2.0, 1.0, 0.0) + angle.cos() * up + angle.sin() * forward;
            camera.project(p, 2.0, 0.0).unwrap().y.abs()
        });
        let most = rim.fold(0.0, f64::max);
        assert!((most - 0.8).abs() < 2e-3, "{kind} {keys}: {most}");
    }
}

#[test]
fn everything_with_an_end_is_the_scene() {
    let (eye, _, at) = seen("PerspectiveCamera { fit scene direction 0 0 -1 }", DVec3::new(0.0, 5.5, 0.0));
    assert!((at.y - 0.9).abs() < 0.02 && eye.z > 5.0, "{eye} {at}");
    // A target stays in the middle, a place and a direction stay what they are.
    let (_, forward, at) =
        seen("PerspectiveCamera { fit scene target red angle 50 }", DVec3::new(2.0, 1.0, 0.0));
    assert!(at.length() < 1e-6 && forward.y < 0.0);
    let (eye, _, _) = seen("PerspectiveCamera { fit scene center 0 2 30 }", DVec3::ZERO);
    assert_eq!(eye, DVec3::new(0.0, 2.0, 30.0));
    // Nothing at all is looked at as if it were a ball.
    assert!(scene("PerspectiveCamera { fit scene } Group { }").is_ok());
}

#[test]
fn the_picture_that_is_asked_for_decides_what_fits() {
    let reach = |aspect: f64| {
        let text = room("PerspectiveCamera { fit scene direction 0 0 -1 }");
        let mut parsed = SceneDesc::parse_str(&text);
        let options = CompileOptions { aspect: Some(aspect), ..CompileOptions::default() };
        let scene =
            compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut parsed.diagnostics).unwrap();
        let at = |p: DVec3| scene.output.camera.project(p, aspect, 0.0).unwrap().abs();
        [at(DVec3::new(-4.1, 0.0, 0.0)).x, at(DVec3::new(0.0, 5.5, 0.0)).y]
    };
    let ([x, y], [wide_x, wide_y]) = (reach(0.5), reach(3.0));
    assert!((x - 0.9).abs() < 2e-2 && y < 0.6, "{x} {y}");
    assert!((wide_y - 0.9).abs() < 2e-2 && wide_x < 0.7, "{wide_x} {wide_y}");
}

#[test]
fn a_camera_is_fitted_to_another_picture_as_it_is_to_its_own() {
    let fitted = |camera: &str, written: f64, shown: f64| {
        let text = room(camera);
        let mut parsed = SceneDesc::parse_str(&text);
        let options = CompileOptions { aspect: Some(written), ..CompileOptions::default() };
        let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut parsed.diagnostics);
        scene.unwrap_or_else(|| panic!("{camera}")).camera_for(shown)
    };
    for camera in [
        "PerspectiveCamera { fit scene }",
        "PerspectiveCamera { fit pair 0.1 direction 1 -1 -1 angle 50 }",
        "PerspectiveCamera { fit red center 0 2 30 }",
        "PerspectiveCamera { fit row target red }",
        "PerspectiveCamera { fit scene aperture 0.2 focus red }",
        "PerspectiveCamera { fit scene Motion { key 0 { } key 1 { Translate 1 0 0 } } }",
        "OrthographicCamera { fit scene direction 0 -1 0 up 0 0 -1 }",
        "OrthographicCamera { fit scene size 3 }",
        "FisheyeCamera { fit scene angle 150 fit corners }",
    ] {
        let debug = |camera: &Camera| format!("{camera:?}");
        let own = debug(&fitted(camera, 0.5, 0.5));
        assert_eq!(own, debug(&fitted(camera, 3.0, 0.5)), "{camera}");
        let is_same = own == debug(&fitted(camera, 3.0, 3.0));
        assert_eq!(is_same, camera.contains("size"), "{camera}");
    }
    let same = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
    assert_eq!(format!("{:?}", fitted(same, 1.0, 1.0)), format!("{:?}", fitted(same, 1.0, 5.0)));
}

#[test]
fn lenses_focus_on_points_and_objects() {
    let focus = |keys: &str| {
        let text = room(&format!(
            "PerspectiveCamera {{ center 2 1 9 direction 0 0 -1 up 0 1 0 angle 40 aperture 0.1 {keys} }}"
        ));
        let scene = scene(&text)?;
        let Camera::Perspective(camera) = &scene.output.camera else { panic!("another camera") };
        Ok::<f64, Vec<String>>(camera.lens().unwrap().focus)
    };
    assert_eq!(focus("focus 4"), Ok(4.0));
    assert_eq!(focus("focus 7 -2 5"), Ok(4.0));
    assert_eq!(focus("focus red"), Ok(9.0));
    assert!(focus("focus 0 0 20").unwrap_err()[0].contains("behind"));
    assert!(focus("focus rad").unwrap_err()[0].contains("no object named `rad`"));
}

#[test]
fn cameras_are_chosen_by_name() {
    let text = room(
        "PerspectiveCamera front { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
         OrthographicCamera top { fit scene direction 0 -1 0 up 0 0 -1 }
         PerspectiveCamera last { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 30 }",
    );
    let chosen = |name: Option<&str>| {
        let mut parsed = SceneDesc::parse_str(&text);
        let options = CompileOptions { camera: name.map(str::to_owned), ..CompileOptions::default() };
        let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &options, &mut parsed.diagnostics);
        let said: Vec<String> = parsed
            .diagnostics
            .iter()
            .map(|d| format!("{} {}", d.message, d.help.clone().unwrap_or_default()))
            .collect();
        (scene, said)
    };
    let (scene, said) = chosen(None);
    let scene = scene.unwrap();
    assert!(said.is_empty() && scene.output.camera.frame().center.z == 5.0, "{said:?}");
    let names: Vec<_> = scene.output.cameras.iter().map(|camera| camera.name.as_deref()).collect();
    assert_eq!(names, [Some("front"), Some("top"), Some("last")]);
    assert_eq!(chosen(Some("front")).0.unwrap().output.camera.frame().center.z, 9.0);
    assert!(matches!(chosen(Some("top")).0.unwrap().output.camera, Camera::Orthographic(_)));
    let (scene, said) = chosen(Some("frnt"));
    assert!(scene.is_none() && said[0].contains("no camera named `frnt`"), "{said:?}");
    assert!(said[0].contains("`front`, `top`, `last`"), "{said:?}");
}

#[test]
fn what_cannot_be_fitted_is_said() {
    let errors = |camera: &str| scene(&room(camera)).expect_err(camera).join("; ");
    assert!(errors("PerspectiveCamera { fit red center 0 0 9 angle 30 }").contains("nothing is left"));
    assert!(errors("PerspectiveCamera { fit rde }").contains("no object named `rde`"));
    assert!(errors("PerspectiveCamera { fit floor }").contains("no end"));
    assert!(
        errors("PerspectiveCamera { fit red center 2 1 0.5 direction 0 0 -1 }")
            .contains("no picture from there")
    );
    assert!(errors("PanoramaCamera { fit scene }").contains("sees all around"));
    assert!(errors("PerspectiveCamera { fit scene angle 0 }").contains("angle of view"));
    assert!(errors("PerspectiveCamera { fit 3 }").contains("`fit` says"));
    assert!(
        errors("PerspectiveCamera { center 0 0 9 target 0 0 0 lookAt 0 0 0 angle 30 }").contains("not both")
    );
    assert!(errors("PerspectiveCamera { target 0 0 0 angle 30 }").contains("needs `center`"));
    // What the disk of a fisheye fills and what fills the picture are two things.
    let fisheye = scene(&room("FisheyeCamera { fit corners fit red }")).expect("no errors");
    assert!(matches!(fisheye.output.camera, Camera::Fisheye(camera) if camera.to_corners));
}
