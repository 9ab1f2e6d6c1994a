use super::*;
use crate::{Defaults, LoadOptions, MemoryAssets, Silent, load_from};
use kajo_core::sampler::SamplerKind;
use kajo_core::settings::{IntegratorName, Settings};

fn ball() -> Scene {
    let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }\n\
                Materials { Material { diffuseColor 1 0.5 0 } }\n\
                Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 } }";
    let loaded = load_from("ball.txt", &MemoryAssets::new().with("ball.txt", text), &LoadOptions::default());
    assert!(loaded.scene.is_some(), "{}", loaded.report(false));
    loaded.scene.unwrap()
}

fn settings(scene: &Scene, size: [u32; 2]) -> RenderSettings {
    let asked = Settings { size: Some(size), ..Settings::default() };
    RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap()
}

#[test]
fn every_view_fits_every_format() {
    let scene = ball();
    let settings = settings(&scene, [9, 7]);
    for format in Format::ALL {
        let outputs = View::ALL.map(|view| (view, format));
        let picture = render(&RenderRequest::new(&scene, &settings, &outputs), &Silent).unwrap();
        for view in View::ALL {
            let bytes = picture.encode(&[view], format, BitDepth::Eight).unwrap();
            let image =
                kajo_image::decode(&bytes, Some(format), &kajo_image::DecodeLimits::default()).unwrap().image;
            assert_eq!((image.width(), image.height()), (9, 7), "{view:?} as {format}");
            let background = if view == View::Depth && format == Format::Exr { f32::INFINITY } else { 0.0 };
            let differs = image.pixel(0, 0) != image.pixel(4, 3);
            // Nothing moves or bends light, and the ball's middle and the background have no noise.
            let is_even =
                matches!(view, View::Samples | View::Motion | View::Variance | View::Lost | View::Records);
            assert!(differs || is_even, "{view:?} as {format} shows the ball");
            if matches!(view, View::Depth | View::Object | View::Material) && format != Format::Pfm {
                assert_eq!(image.pixel(0, 0)[0], background, "{view:?} as {format}");
            }
        }
    }
}

#[test]
fn an_exr_file_holds_all_views() {
    let scene = ball();
    let outputs = View::ALL.map(|view| (view, Format::Exr));
    let picture = render(&RenderRequest::new(&scene, &settings(&scene, [4, 4]), &outputs), &Silent).unwrap();
    let bytes = picture.encode(&View::ALL, Format::Exr, BitDepth::Eight).unwrap();
    let file = kajo_image::exr::decode(&bytes, &kajo_image::DecodeLimits::default()).unwrap();
    let main = file.layer(None).unwrap();
    for channel in ["R", "G", "B", "Z"] {
        assert!(main.channel(channel).is_some(), "{channel}");
    }
    for (layer, channel) in [
        ("N", "X"),
        ("uv", "U"),
        ("object", "id"),
        ("material", "id"),
        ("samples", "count"),
        ("albedo", "R"),
        ("motion", "Y"),
        ("variance", "B"),
        ("lost", "count"),
        ("records", "share"),
        ("lights.other", "G"),
    ] {
        assert!(file.layer(Some(layer)).unwrap().channel(channel).is_some(), "{layer}.{channel}");
    }
}

/// A body without an index of refraction to the right of its middle: the layer has as many lost rays there as were counted.
#[test]
fn a_layer_shows_where_rays_were_lost() {
    let text = "OrthographicCamera { center 0.01 0 9 direction 0 0 -1 up 0 1 0 size 2 } Background { color 1 1 1 }\n\
                Media { GradientIndex m { index = 1.5 - 3 * step(0, x) } } Materials { Interface i { medium m } }\n\
                Group { MaterialIndex i  Sphere { center 0 0 0  radius 0.9 } }";
    let loaded = load_from("ball.txt", &MemoryAssets::new().with("ball.txt", text), &LoadOptions::default());
    let scene = loaded.scene.unwrap();
    let outputs = [(View::Color, Format::Exr), (View::Lost, Format::Exr)];
    for integrator in ["path", "bidirectional"] {
        let asked = Settings {
            size: Some([16, 16]),
            samples: Some((SamplerKind::Sobol, 4)),
            integrator: Some(IntegratorName(integrator)),
            ..Settings::default()
        };
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        let picture = render(&RenderRequest::new(&scene, &settings, &outputs), &Silent).unwrap();
        let lost = picture.film.develop(Layer::LostRays).unwrap();
        let in_all = 4.0 * lost.data().iter().sum::<f32>();
        let counted = picture.stats.rays.lost as f32;
        assert!((in_all / counted - 1.0).abs() < 0.02, "{integrator}: {in_all} of {counted}");
        // Paths from lights, too, come to nothing on the right, whatever pixel they are made for.
        let from_lights = if integrator == "path" { 0.0..=0.0 } else { 0.0..=1.0 };
        for y in 4..12 {
            let [left, right] = [lost.pixel(5, y)[0], lost.pixel(11, y)[0]];
            assert!(from_lights.contains(&left), "{integrator}: {left} where light goes through");
            assert!(from_lights.contains(&(right - 1.0)), "{integrator}: {right} where it does not");
        }
    }
}

#[test]
fn other_files_hold_one_view() {
    let scene = ball();
    let outputs = [(View::Color, Format::Png), (View::Depth, Format::Png)];
    let picture = render(&RenderRequest::new(&scene, &settings(&scene, [4, 4]), &outputs), &Silent).unwrap();
    assert!(picture.encode(&[View::Color, View::Depth], Format::Png, BitDepth::Eight).is_err());
    assert!(picture.encode(&[View::Uv], Format::Png, BitDepth::Eight).is_err(), "not asked for");
}

#[test]
fn pictures_beyond_memory_are_refused_at_once() {
    let scene = ball();
    let sizes = [[1_000_000_000, 1_000_000_000], [u32::MAX, u32::MAX]];
    for size in sizes {
        let result = render(
            &RenderRequest::new(&scene, &settings(&scene, size), &[(View::Color, Format::Png)]),
            &Silent,
        );
        let error = result.unwrap_err();
        assert!(matches!(error, RenderError::Memory { .. }), "{error}");
        assert!(error.to_string().contains(" EB"), "{error}");
    }
    let small = Resources { memory: Some(1000), ..Resources::default() };
    let result = render(&RenderRequest::new(&scene, &settings(&scene, [100, 100]), &[]).with(small), &Silent);
    assert!(matches!(result, Err(RenderError::Memory { budget: 1000, .. })));
}

#[test]
fn memory_is_counted_for_all_that_is_made_of_a_picture() {
    let scene = ball();
    let settings = settings(&scene, [100, 100]);
    let bytes = |outputs: &[(View, Format)]| to_finish(&scene, outputs, &settings);
    let png = [(View::Color, Format::Png), (View::Depth, Format::Png)];
    assert_eq!(bytes(&png), BYTES_TO_ENCODE, "one file after the other");
    let layers_of_exr =
        [View::Color, View::Depth, View::Normals, View::Lights].map(|view| (view, Format::Exr));
    assert_eq!(bytes(&layers_of_exr), 12 + 8 * 10, "all in one file");
    assert_eq!(bytes(&[png.as_slice(), &DENOISE_OUTPUTS].concat()), denoise::BYTES_A_PIXEL);

    let needed = |outputs: &[(View, Format)]| {
        let none = Resources { memory: Some(0), ..Resources::default() };
        let Err(RenderError::Memory { needed, .. }) =
            render(&RenderRequest::new(&scene, &settings, outputs).with(none), &Silent)
        else {
            panic!("it needs nothing")
        };
        needed
    };
    let spec = FilmSpec {
        one_pass: true,
        ..film_spec(&scene.output.camera, &settings, layers(&scene, &DENOISE_OUTPUTS, &settings))
    };
    assert_eq!(needed(&DENOISE_OUTPUTS), spec.bytes() + 10_000 * u128::from(denoise::BYTES_A_PIXEL));
}

#[test]
fn a_cancelled_render_keeps_what_it_has() {
    struct Never;
    impl Progress for Never {
        fn done(&self, _: u64, _: u64, _: u64) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let scene = ball();
    let outputs = [(View::Color, Format::Png)];
    let result = render(&RenderRequest::new(&scene, &settings(&scene, [100, 100]), &outputs), &Never);
    let Err(RenderError::Cancelled(picture)) = result else { panic!("not cancelled") };
    assert!(picture.encode(&[View::Color], Format::Png, BitDepth::Eight).is_ok());
    assert!(picture.stats.samples < 100 * 100 * 16);
}

#[test]
fn bytes_are_told_in_words() {
    assert_eq!(in_words(1536).to_string(), "1.5 kB");
    assert_eq!(in_words(12 * 10u128.pow(18)).to_string(), "12.0 EB");
    assert_eq!(in_words(10u128.pow(24)).to_string(), "1000000.0 EB");
}
