//! Random small scenes look the same as by path tracing.

use kajo_math::rng::Stream;

use super::*;

/// A pick of lines by a random number.
fn pick<'a>(u: f32, lines: &[&'a str]) -> &'a str {
    lines[(u * lines.len() as f32) as usize]
}

/// A scene of a few things under lights of all kinds.
fn random_scene(i: u32) -> String {
    let stream = Stream::new(77, [i, 0], 0);
    let u = |k: u32| stream.uniform(k);
    let view = pick(
        u(0),
        &[
            "PerspectiveCamera { center 0 0.3 3  direction 0 -0.1 -1  up 0 1 0  angle 50 }",
            "PerspectiveCamera { center 0 0.3 3  direction 0 -0.1 -1  up 0 1 0  angle 50  aperture 0.3  focus 3 }",
            "OrthographicCamera { center 0 0.3 3  direction 0 -0.1 -1  up 0 1 0  size 2 }",
            "OrthographicCamera { center 0 0.3 3  direction 0 -0.1 -1  up 0 1 0  size 2  aperture 0.3  focus 3 }",
            "FisheyeCamera { center 0 0.3 1.5  direction 0 -0.1 -1  up 0 1 0 }",
        ],
    );
    let background = pick(u(1), &["0 0 0", "0.3 0.4 0.5"]);
    let lights = pick(
        u(2),
        &[
            "PointLight { position 0.6 1.2 0.8  intensity 3 3 3 }",
            "PointLight { position 0.6 1.2 0.8  color 1 1 1  attenuation 0.3 0.2 0.5 }",
            "SpotLight { position 0 2 1  direction 0 -2 -1  angle 60  innerAngle 20  intensity 9 9 9 }",
            "DirectionalLight { direction 0.3 -1 -0.4  irradiance 3 3 3 }",
            "DirectionalLight { direction 0.3 -1 -0.4  irradiance 3 3 3  angle 60 }",
            "",
        ],
    );
    let light = pick(
        u(3),
        &[
            "Quad { corner -0.4 1.5 -0.4  edge1 0.8 0 0  edge2 0 0 0.8 }",
            "Sphere { center -0.8 1 0.5  radius 0.3 }",
            "Disk { center 0 1.5 0  normal 0 -1 0.2  radius 0.5 }",
            "Transform { Translate 0 1.3 0 Scale 0.6 0.2 0.4 Sphere { center 0 0 0  radius 1 } }",
        ],
    );
    let bright = pick(
        u(8),
        &[
            "Material emitter { diffuseColor 0.2 0.2 0.2  emission 2 2 2 }",
            "Matte emitter { color 0.2 0.2 0.2  emission dents.pfm { repeat 2  light blackbody 4000 3 } }",
            "Matte emitter { color 0.2 0.2 0.2  emission 4  emits front  opacity dents.pfm { channel green } }",
            "Matte dark { color 0.2 0.2 0.2 }  Matte warm { color 0.5 0.2 0.1  emission 9 3 1 }
             Noise emitter { materialIndex dark  materialIndex warm  Transform { UniformScale 3 } }",
        ],
    );
    // What mirrors send on from emitters that no ray can meet is light that no path from the camera can find.
    let rough = ["white", "red", "gold", "frosted", "lacquer", "flint", "dented"];
    let all = ["white", "red", "gold", "mirror", "frosted", "clear", "paint", "gloss", "flint", "dented"];
    let material =
        |k| pick(u(k), if lights.is_empty() || lights.ends_with("angle 60 }") { &all } else { &rough });
    let (a, b) = (material(4), material(5));
    let ground = pick(
        u(6),
        &["Plane { normal 0 1 0  offset -1 }", "Quad { corner -3 -1 -3  edge1 0 0 6  edge2 6 0 0 }"],
    );
    let thing = pick(
        u(7),
        &[
            "Sphere { center 0.6 -0.4 0.2  radius 0.6 }",
            "Box { min 0.1 -1.01 -0.4  max 1.0 0 0.5 }",
            "Transform { Translate 0.6 -0.4 0 YRotate 30 Scale 0.5 0.6 0.4 Sphere { center 0 0 0  radius 1 } }",
        ],
    );
    format!(
        "{view} Background {{ color {background} }} Lights {{ {lights} }}
         Materials {{ Matte white {{ color 0.7 0.7 0.7 }}  Matte red {{ color 0.6 0.2 0.1 }}
            Metal gold {{ metal gold roughness 0.5 }}  Metal mirror {{ color 0.8 0.8 0.8 }}
            Glass frosted {{ roughness 0.6  absorption 0.3 0.6 0.9 }}  Glass clear {{ indexOfRefraction 1.4 }}
            Metal dented {{ roughness 0.6  anisotropy 0.7  normalMap dents.pfm }}
            Glass flint {{ glass N-SF10  roughness 0.2 }}
            Principled paint {{ color 0.2 0.5 0.3  coat 0.7  roughness 0.5 }}
            Principled lacquer {{ color 0.2 0.5 0.3  coat 0.7  coatRoughness 0.3  roughness 0.5 }}
            Material gloss {{ diffuseColor 0.3 0.2 0.1  specularColor 0.3 0.3 0.3  exponent 20  reflectiveColor 0.2 0.2 0.2 }}
            {bright} }}
         Group {{ MaterialIndex white {ground}  MaterialIndex emitter {light}
            MaterialIndex {a} Sphere {{ center -0.5 -0.5 0  radius 0.5 }}  MaterialIndex {b} {thing} }}"
    )
}

#[test]
fn random_scenes_look_as_by_path_tracing() {
    for i in 0..if effort() > 1 { 60 } else { 10 } {
        let text = random_scene(i);
        let scene = scene(&text);
        let spectral = i % 3 == 0;
        let both_ways = |samples: u32| {
            let path = PathSettings { bounces: 4, spectral, ..PathSettings::default() };
            let path = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), samples, 1);
            let settings = BidirectionalSettings { bounces: 4, spectral, ..both() };
            let found = mean_of(&Bidirectional::new(&scene, settings, [1, 1], LayerSet::of(&[])), samples, 1);
            (path, found, path.standard_error.hypot(found.standard_error))
        };
        let (mut path, mut found, mut sigma) = both_ways(1000 * effort());
        // Some of them are noisy by either way.
        if sigma >= 0.08 * path.mean {
            (path, found, sigma) = both_ways(8000 * effort());
        }
        assert!((path.mean - found.mean).abs() < 4.5 * sigma, "scene {i}: {path:?} {found:?}\n{text}");
        assert!(sigma < 0.08 * path.mean, "scene {i} is too noisy: {path:?} {found:?}\n{text}");
    }
}

/// A light and a matt ball in coloured glass. Rays that meet the light by chance know the bodies that they are in.
#[test]
fn a_light_in_glass_shines_through_it() {
    let text = "PerspectiveCamera { center 0 0 6  direction 0 0 -1  up 0 1 0  angle 30 } Background { color 0 0 0 }
        Materials { Glass amber { indexOfRefraction 1.3  absorption 0.5 0.5 0.5 }  Matte white { color 0.8 0.8 0.8 }
            Material emitter { diffuseColor 0 0 0  emission 5 5 5 } }
        Group { MaterialIndex amber Sphere { center 0 0 0  radius 1.4 }
            MaterialIndex emitter Sphere { center 0.4 0.5 0  radius 0.4 }
            MaterialIndex white Sphere { center -0.4 -0.4 0  radius 0.5 } }";
    let scene = scene(text);
    let technique = kajo_core::settings::Technique::Scattering;
    let path = PathSettings { bounces: 4, technique, ..PathSettings::default() };
    let path = mean_of(&Path::new(&scene, path, [1, 1], LayerSet::of(&[])), 4000 * effort(), 0);
    let found = mean(&scene, BidirectionalSettings { bounces: 4, ..both() }, 1000 * effort());
    let sigma = path.standard_error.hypot(found.standard_error);
    assert!((path.mean - found.mean).abs() < 4.5 * sigma, "{path:?} {found:?}");
    assert!(sigma < 0.02 * path.mean, "{path:?} {found:?}");
}

/// Compares with paths of no bounce, one and four.
#[track_caller]
fn looks_as_by_path_tracing(scene: &Scene, light: &str) {
    for bounces in [0, 1, 4] {
        let samples = 1500 * effort();
        let path = PathSettings { bounces, ..PathSettings::default() };
        let path = mean_of(&Path::new(scene, path, [1, 1], LayerSet::of(&[])), samples, 0);
        let found = mean(scene, BidirectionalSettings { bounces, ..both() }, samples);
        let sigma = path.standard_error.hypot(found.standard_error);
        assert!((path.mean - found.mean).abs() < 4.5 * sigma, "{light} {bounces}: {path:?} {found:?}");
        assert!(sigma < 0.03 * path.mean, "{light} {bounces}: {path:?} {found:?}");
    }
}

/// A matt ball on the ground behind a pane and under another one, beside one of water that has a third in it.
#[test]
fn panes_let_as_much_light_through_as_by_path_tracing() {
    let text = |light: &str, sky: f32| {
        format!(
            "PerspectiveCamera {{ center 0 0.4 4  direction 0 -0.1 -1  up 0 1 0  angle 40 }}
             Background {{ color {sky} {sky} {sky} }} Lights {{ {light} }}
             Materials {{ Matte white {{ color 0.7 0.7 0.7 }}  Glass pane {{ thickness 0.3  absorption 0.5 1 2 }}
                Principled misty {{ color 0.9 0.6 0.3  transmission 0.6  thin on }}  Glass rough {{ thin on  bump dents.pfm {{ height 0.1 }} }}
                Glass water {{ indexOfRefraction 1.33  absorption 0.3 0.2 0.1 }}
                Material emitter {{ diffuseColor 0 0 0  emission 4 4 4 }} }}
             Group {{ MaterialIndex white Plane {{ normal 0 1 0  offset -1 }} Sphere {{ center 0 -0.5 0  radius 0.5 }}
                MaterialIndex pane Quad {{ corner -2 -1 1  edge1 4 0 0  edge2 0 2 0 }}
                MaterialIndex misty Quad {{ corner -1 0.5 -1  edge1 0 0 2  edge2 2 0 0.1 }}
                MaterialIndex rough Quad {{ corner 0.7 -0.9 -0.5  edge1 0.5 0 0.6  edge2 0 0.9 0 }}
                MaterialIndex water Box {{ min -1.6 -0.99 -0.4  max -0.8 0 0.4 }}
                MaterialIndex pane Quad {{ corner -1.5 -0.5 -0.3  edge1 0.6 0 0  edge2 0 0 0.6 }}
                MaterialIndex emitter Sphere {{ center 0 1.6 0  radius 0.3 }} }}"
        )
    };
    let emitters = [
        "",
        "PointLight { position 1 2 1  intensity 2 2 2 }",
        "DirectionalLight { direction 0.2 -1 0.1  irradiance 2 2 2  angle 10 }",
    ];
    for (i, light) in emitters.into_iter().enumerate() {
        // What mirrors send on from a point is for paths from the light alone.
        let text = text(light, if i == 2 { 0.0 } else { 0.3 });
        let scene =
            scene(&if i == 1 { text.replace("MaterialIndex pane", "MaterialIndex white") } else { text });
        looks_as_by_path_tracing(&scene, light);
    }
}

/// A matt ball on the ground behind gauze, lit by a light behind a screen, a window in a wall, a veil that emits, and a sky.
/// Holes cost no bounce, and connections go through them.
#[test]
fn holes_let_as_much_light_through_as_by_path_tracing() {
    let text = |light: &str, sky: f32| {
        format!(
            "PerspectiveCamera {{ center 0 0.4 4  direction 0 -0.1 -1  up 0 1 0  angle 40 }}
             Background {{ color {sky} {sky} {sky} }} Lights {{ {light} }}
             Materials {{ Matte white {{ color 0.7 0.7 0.7 }}  Matte gauze {{ color 0.5 0.3 0.2  opacity 0.4 }}
                Matte hole {{ opacity 0 }}  Checkerboard lattice {{ Transform {{ UniformScale 5 }} materialIndex white
                materialIndex hole }}  Matte veil {{ color 0.2 0.2 0.2  emission 0.5 0.5 0.5  opacity 0.3 }}
                Material emitter {{ diffuseColor 0 0 0  emission 4 4 4 }} }}
             Group {{ MaterialIndex white Plane {{ normal 0 1 0  offset -1 }} Sphere {{ center 0 -0.5 0  radius 0.5 }}
                MaterialIndex gauze Quad {{ corner -2 -1 1  edge1 4 0 0  edge2 0 2 0 }}
                Sphere {{ center 0 1.6 0  radius 0.6 }}
                MaterialIndex lattice Quad {{ corner -1 0.7 -1  edge1 0 0 2  edge2 2 0 0.1 }}
                MaterialIndex veil Quad {{ corner 0.6 -0.9 -0.5  edge1 0.5 0 0.6  edge2 0 0.9 0 }}
                MaterialIndex emitter Sphere {{ center 0 1.6 0  radius 0.3 }} }}"
        )
    };
    let emitters = [
        "",
        "PointLight { position 1 2 1  intensity 2 2 2 }",
        "DirectionalLight { direction 0.2 -1 0.1  irradiance 2 2 2 }",
    ];
    for (i, light) in emitters.into_iter().enumerate() {
        let scene = scene(&text(light, if i == 2 { 0.0 } else { 0.3 }));
        looks_as_by_path_tracing(&scene, light);
    }
}
