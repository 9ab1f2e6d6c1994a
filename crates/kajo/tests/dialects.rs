//! What the dialects and the scenes of older courses mean, by pictures whose pixels are worked out by hand.

use kajo::{
    Defaults, Dialect, EncodeOptions, Format, Image, LoadOptions, Loaded, MemoryAssets, RenderRequest,
    RenderSettings, Settings, Silent, View, encode, load_from, render,
};

const FRONT: &str = "OrthographicCamera { center 0 0 5  direction 0 0 -1  up 0 1 0  size 4 }";

fn loaded(text: &str, dialect: Dialect, assets: MemoryAssets) -> Loaded {
    let options = LoadOptions { dialect: Some(dialect), ..LoadOptions::default() };
    load_from("s.txt", &assets.with("s.txt", text), &options)
}

/// The light of a picture without emitters, where surfaces have their ambient colour.
fn picture(text: &str, dialect: Dialect, size: [u32; 2], assets: MemoryAssets) -> Image {
    let loaded = loaded(text, dialect, assets);
    let scene = loaded.scene.as_ref().unwrap_or_else(|| panic!("{text}\n{}", loaded.report(false)));
    let asked = Settings { size: Some(size), bounces: Some(1), ..Settings::default() };
    let settings = RenderSettings::resolve(scene, &asked, Defaults::Classic, false).unwrap();
    let outputs = [(View::Color, Format::Exr)];
    render(&RenderRequest::new(scene, &settings, &outputs), &Silent).unwrap().light().unwrap()
}

/// The only pixel of a scene.
fn pixel(text: &str, dialect: Dialect, assets: MemoryAssets) -> [f32; 3] {
    picture(text, dialect, [1, 1], assets).rgb(0, 0)
}

fn close(found: [f32; 3], expected: [f32; 3], what: &str) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4);
    assert!(near, "{what}: {found:?} is not {expected:?}");
}

/// Pixels that show something else than the background.
fn covered(image: &Image) -> usize {
    image.rgb_pixels().filter(|rgb| *rgb != [0.5; 3]).count()
}

#[test]
fn angles_and_sizes_span_the_width_in_mit_2004() {
    let quad = "Materials { Material { diffuseColor 1 0 0 } } Group { MaterialIndex 0
        Quad { corner -0.48 -0.48 0  edge1 0.96 0 0  edge2 0 0.96 0 } }";
    let near = "PerspectiveCamera { center 0 0 1  direction 0 0 -1  up 0 1 0  angle 90 }";
    for (camera, dialect, size, expected) in [
        // 40 x 20 pixels of a fifth: the four next to the middle on each axis.
        (FRONT, Dialect::Handout, [40, 20], 4 * 4),
        // Of a tenth.
        (FRONT, Dialect::Mit2004, [40, 20], 10 * 10),
        (FRONT, Dialect::Mit2004, [20, 40], 4 * 4),
        // Two units high, or two wide.
        (near, Dialect::Handout, [40, 20], 10 * 10),
        (near, Dialect::Mit2004, [40, 20], 20 * 20),
        // Square pictures are the same.
        (near, Dialect::Mit2004, [20, 20], 10 * 10),
    ] {
        let image = picture(&format!("{camera} {quad}"), dialect, size, MemoryAssets::new());
        assert_eq!(covered(&image), expected, "{dialect:?} {size:?} {camera}");
    }
}

#[test]
fn tents_are_cones_in_mit_2004() {
    use kajo::FilterChoice::Tent;
    for (dialect, weight) in [(Dialect::Handout, 0.25), (Dialect::Mit2004, 1.0 - 0.5f32.sqrt())] {
        let loaded = loaded(FRONT, dialect, MemoryAssets::new());
        let asked = Settings { filter: Some(Tent(1.0)), ..Settings::default() };
        let settings =
            RenderSettings::resolve(&loaded.scene.unwrap(), &asked, Defaults::Classic, false).unwrap();
        assert!((settings.filter.weight(0.5, 0.5) - weight).abs() < 1e-6, "{dialect:?}");
    }
    // A sample in the middle of each pixel. Those beside a bright one have 1 - 1/r of its light, and those across a corner
    // 1 - sqrt(2)/r, each divided by the sum of all nine weights.
    let spot = "Materials { Material { diffuseColor 4 4 4 } } Background { color 0 0 0 }
        Settings { filter tent 1.5 } Group { MaterialIndex 0
        Quad { corner -0.1 -0.1 0  edge1 0.2 0 0  edge2 0 0.2 0 } }";
    let image = picture(&format!("{FRONT} {spot}"), Dialect::Mit2004, [5, 5], MemoryAssets::new());
    let (side, corner) = (1.0 - 1.0 / 1.5, 1.0 - 2f32.sqrt() / 1.5);
    let whole = 1.0 + 4.0 * side + 4.0 * corner;
    for (x, y, weight) in
        [(2, 2, 1.0), (1, 2, side), (2, 3, side), (3, 3, corner), (1, 1, corner), (0, 2, 0.0)]
    {
        close(image.rgb(x, y), [4.0 * weight / whole; 3], &format!("{x} {y}"));
    }
}

#[test]
fn gaussians_weigh_whole_pixels_in_mit_2004() {
    // A sample in the middle of each pixel, and a bright one in the middle of the picture. Two standard deviations are 0.8,
    // less than the way to the next sample, but the next pixels begin within them.
    let spot = "Materials { Material { diffuseColor 4 4 4 } } Background { color 0 0 0 }
        Settings { filter gaussian 0.4 } Group { MaterialIndex 0
        Quad { corner -0.1 -0.1 0  edge1 0.2 0 0  edge2 0 0.2 0 } }";
    let side = (-1.0f32 / (2.0 * 0.4 * 0.4)).exp();
    let whole = 1.0 + 4.0 * side + 4.0 * side * side;
    let middle_only = [(2, 2, 1.0), (1, 2, 0.0), (3, 3, 0.0), (0, 2, 0.0)];
    let neighbours =
        [(2, 2, 1.0 / whole), (1, 2, side / whole), (3, 3, side * side / whole), (0, 2, 0.0), (2, 4, 0.0)];
    let cases = [
        (Dialect::Handout, &middle_only[..]),
        (Dialect::MitA2, &middle_only),
        (Dialect::Mit2004, &neighbours),
    ];
    for (dialect, expected) in cases {
        let image = picture(&format!("{FRONT} {spot}"), dialect, [5, 5], MemoryAssets::new());
        for &(x, y, share) in expected {
            close(image.rgb(x, y), [4.0 * share; 3], &format!("{dialect:?} {x} {y}"));
        }
    }
}

#[test]
fn noise_without_octaves_is_none() {
    let scene = |material: &str| {
        format!(
            "OrthographicCamera {{ center 0.3 0 5  direction 0 0 -1  up 0 1 0  size 0.001 }}
             Materials {{ Material {{ diffuseColor 1 0 0 }} Material {{ diffuseColor 0 0 1 }} {material} }}
             Group {{ MaterialIndex 2  Plane {{ normal 0 0 1  offset 0 }} }}"
        )
    };
    let veins = 0.5 + 0.5 * 0.6f32.sin();
    for (material, t) in [
        ("Noise { materialIndex 0  materialIndex 1  octaves 0 }", 0.5),
        ("Marble { materialIndex 0  materialIndex 1  octaves 0  frequency 2  amplitude 9 }", veins),
        // The same within a material, which takes the place of its diffuse colour.
        (
            "PhongMaterial { diffuseColor 0 9 0  Noise { color 1 0 0  color 0 0 1  octaves 0  frequency 2 } }",
            veins,
        ),
    ] {
        for dialect in Dialect::ALL {
            close(pixel(&scene(material), dialect, MemoryAssets::new()), [1.0 - t, 0.0, t], material);
        }
    }
    let white = "PhongMaterial { Noise { octaves 0  frequency 2 }  shininess 5 }";
    close(pixel(&scene(white), Dialect::MitA2, MemoryAssets::new()), [veins; 3], "from black to white");
    let three = scene("PhongMaterial { Noise { color 1 0 0  color 0 1 0  color 0 0 1 } }");
    let refused = loaded(&three, Dialect::MitA2, MemoryAssets::new());
    assert!(refused.scene.is_none() && refused.report(false).contains("there is a third"));
}

#[test]
fn textures_stand_in_place_of_the_diffuse_colour_in_mit_a2() {
    let texture = Image::filled(2, 2, &[0.8, 0.4, 0.2]).unwrap();
    let file = encode(&texture, Format::Pfm, &EncodeOptions::default()).unwrap();
    let text = format!(
        "{FRONT} Materials {{ Material {{ diffuseColor 0.5 0.5 0.5  texture t.pfm }} }}
         Group {{ MaterialIndex 0  Quad {{ corner -5 -5 0  edge1 10 0 0  edge2 0 10 0 }} }}"
    );
    for (dialect, expected) in [(Dialect::Handout, [0.4, 0.2, 0.1]), (Dialect::MitA2, [0.8, 0.4, 0.2])] {
        let found = pixel(&text, dialect, MemoryAssets::new().with("t.pfm", &file));
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{dialect:?} {found:?}");
    }
}

#[test]
fn an_index_of_refraction_makes_glass_in_mit_a2() {
    let pane = |index: &str| {
        format!(
            "{FRONT} Background {{ color 1 1 1 }}
             Materials {{ Material {{ diffuseColor 0 0 0  specularColor 0.5 0.25 1  {index} }} }}
             Group {{ MaterialIndex 0  Quad {{ corner -5 -5 0  edge1 10 0 0  edge2 0 10 0 }} }}"
        )
    };
    // The background behind, and the background mirrored.
    for (dialect, index, expected) in [
        (Dialect::MitA2, "refractionIndex 1.5", [1.0, 0.5, 2.0]),
        (Dialect::MitA2, "refractionIndex 0", [0.5, 0.25, 1.0]),
        (Dialect::MitA2, "refractionIndex 1.5  transparentColor 0 0 0", [0.5, 0.25, 1.0]),
        (Dialect::Handout, "refractionIndex 1.5", [0.0, 0.0, 0.0]),
        (Dialect::Handout, "refractionIndex 1.5  transparentColor 0 1 0", [0.0, 1.0, 0.0]),
    ] {
        close(pixel(&pane(index), dialect, MemoryAssets::new()), expected, index);
    }
}

#[test]
fn the_back_face_of_a_cube_map_is_mirrored_in_mit_a2() {
    let faces = ["right", "left", "up", "down", "front", "back"];
    let halves = |x: u32, _: u32| if x == 0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let file =
        encode(&Image::from_fn(2, 2, halves).unwrap(), Format::Png, &EncodeOptions::default()).unwrap();
    let assets = || {
        faces.iter().fold(MemoryAssets::new(), |assets, face| assets.with(format!("sky/{face}.png"), &file))
    };
    // A quarter of a face to the right, where its right column has its middle.
    let look = |direction: &str, dialect| {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 0  direction {direction}  up 0 1 0  angle 30 }}
             Background {{ cubeMap sky }} Group {{ }}"
        );
        pixel(&text, dialect, assets())
    };
    let (left, right) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for (direction, dialect, expected) in [
        ("0.5 0 -1", Dialect::Handout, right),
        ("-0.5 0 -1", Dialect::Handout, left),
        ("0.5 0 -1", Dialect::MitA2, left),
        ("-0.5 0 -1", Dialect::MitA2, right),
        // The front face is as it was.
        ("-0.5 0 1", Dialect::Handout, right),
        ("-0.5 0 1", Dialect::MitA2, right),
    ] {
        close(look(direction, dialect), expected, &format!("{direction} {dialect:?}"));
    }
}

#[test]
fn cameras_of_tsinghua_say_the_size_of_the_picture() {
    let scene = |size: &str| {
        format!(
            "PerspectiveCamera {{ center 0 0 10  direction 0 0 -1  up 0 1 0  angle 30  {size} }}
             Lights {{ numLights 1  PointLight {{ position 0 0 10  color 0.9 0.9 0.9 }} }}
             Background {{ color 0.2 0 0.6 }}
             Materials {{ numMaterials 1
               Material {{ diffuseColor 0.79 0.66 0.44  specularColor 0 0 0  shininess 20 }} }}
             Group {{ numObjects 1  MaterialIndex 0  Sphere {{ center 0 0 0  radius 1 }} }}"
        )
    };
    let size = |text: &str, asked: Option<[u32; 2]>| {
        let loaded = loaded(text, Dialect::Handout, MemoryAssets::new());
        let scene = loaded.scene.as_ref().unwrap_or_else(|| panic!("{}", loaded.report(false)));
        let asked = Settings { size: asked, ..Settings::default() };
        RenderSettings::resolve(scene, &asked, Defaults::Classic, false).unwrap().size
    };
    assert_eq!(size(&scene("width 70  height 50"), None), [70, 50]);
    assert_eq!(size(&scene("width 70  height 50"), Some([3, 4])), [3, 4]);
    assert_eq!(size(&format!("{} Settings {{ size 8 9 }}", scene("width 70  height 50")), None), [8, 9]);
    assert_eq!(size(&scene(""), None), [100, 100]);
    for wrong in ["width 70", "height 50", "width 0  height 50", "width 1.5  height 2"] {
        assert!(loaded(&scene(wrong), Dialect::Handout, MemoryAssets::new()).scene.is_none(), "{wrong}");
    }
    let curves =
        scene("").replace("Sphere {", "RevSurface { profile BezierCurve { controls { } } } Sphere {");
    let refused = loaded(&curves, Dialect::Handout, MemoryAssets::new());
    assert!(refused.report(false).contains("`RevSurface` is not supported yet"), "{}", refused.report(false));
}
