//! Media as the language writes them, and what is said of those that are none.

use kajo_color::Wavelengths;
use kajo_scene::{Diagnostics, Limits, MemoryAssets, MemoryBudget, SceneDesc};

use super::{CompileOptions, compile};
use crate::scene::Scene;

fn compiled(text: &str) -> (Option<Scene>, Vec<String>) {
    let assets = MemoryAssets::new()
        .with("cloud.df3", [0, 2, 0, 1, 0, 1, 255, 51])
        .with("short.df3", [0, 9, 0, 9, 0, 9, 255])
        .with("empty.vol", [])
        .with("bytes.raw", [0, 255, 51, 102]);
    let limits = Limits { memory: MemoryBudget::new(64 << 20), ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
    let mut parsed = SceneDesc::parse_str(&format!("{camera} {text}"));
    let mut diagnostics = Diagnostics::default();
    let scene = compile(&mut parsed.desc, &assets, &options, &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

fn media(text: &str) -> (Option<Scene>, Vec<String>) {
    compiled(&format!("Media {{ {text} }}"))
}

#[test]
fn coefficients_are_said_in_three_ways() {
    for (text, sigma_a, sigma_s) in [
        ("sigma_a 1 2 3 sigma_s 4", [1.0, 2.0, 3.0], [4.0; 3]),
        ("albedo 0.25 density 4 8 0 scale 0.5", [1.5, 3.0, 0.0], [0.5, 1.0, 0.0]),
        ("albedo 0 0.5 1 meanFreePath 0.5", [2.0, 1.0, 0.0], [0.0, 1.0, 2.0]),
        ("density 3", [0.0; 3], [3.0; 3]),
    ] {
        let (scene, said) = media(&format!("Medium m {{ {text} }} exterior m"));
        let scene = scene.unwrap_or_else(|| panic!("{text}: {said:?}"));
        let media = &scene.appearance.media;
        let made = media.coefficients(scene.lighting.air.expect("the air"));
        let rgb = Wavelengths::RGB;
        assert_eq!((made.sigma_a(&rgb).to_rgb(), made.sigma_s(&rgb).to_rgb()), (sigma_a, sigma_s), "{text}");
    }
}

#[test]
fn grids_come_from_files_and_from_the_text() {
    for text in [
        "GridMedium m { file cloud.df3 density 1 }",
        "GridMedium m { file bytes.raw size 4 1 1 encoding u8 density 1 }",
        "GridMedium m { size 2 1 1 values 0 1 density 1 min 0 0 0 max 1 2 3 }",
        "FunctionMedium m { function = x + y density 1 }",
        "Medium m { emission blackbody 1900 5 }",
        "Medium m { emission 1 2 3  sigma_a 1 } exterior m",
        "FunctionMedium m { function = x  emission 1 } exterior m",
        "TextureMedium m { texture = 0.5 + 0.5 * x density 1 }",
    ] {
        let (scene, said) = media(text);
        assert!(scene.is_some() && said.is_empty(), "{text}: {said:?}");
    }
}

#[test]
fn mistakes_are_named() {
    for (text, expected) in [
        ("Medium m { }", "this medium has no density"),
        ("Medium { density 1 }", "`Medium` has no name"),
        ("Medium m { density 1 } Medium m { density 2 }", "there are two media named `m`"),
        ("Medium m { sigma_a -1 }", "`sigma_a` is not negative"),
        ("Medium m { sigma_s 1 2 -0.5 }", "`sigma_s` is not negative"),
        ("Medium m { density 1 albedo 1.5 }", "`albedo` is from 0 to 1"),
        ("Medium m { density 1 albedo 0.5 sigma_a 1 }", "`albedo` cannot stand beside `sigma_a`"),
        ("Medium m { density 1 meanFreePath 2 }", "`density` cannot stand beside `meanFreePath`"),
        ("Medium m { meanFreePath 0 }", "`meanFreePath` is more than 0"),
        ("Medium m { density 1 g 1 }", "`g` is more than -1 and less than 1"),
        ("Medium m { density 1 g -1.5 }", "`g` is more than -1 and less than 1"),
        ("Medium m { density 1 scale -1 }", "at least 0"),
        ("Medium m { density 1 } exterior n", "there is no medium named `n`"),
        ("Medium m { emission 1 } exterior m", "endlessly bright"),
        ("Medium m { emission 1 sigma_a 1 0 1 } exterior m", "endlessly bright"),
        ("Medium m { emission -1 }", "negative"),
        ("TextureMedium m { density 1 }", "expected one `texture`, found 0"),
        ("TextureMedium m { texture 0.5 density 1 min 1 1 1 }", "must be less than that of `max`"),
        ("TextureMedium m { texture 0.5 }", "this medium has no density"),
        ("GridMedium m { density 1 }", "file"),
        ("GridMedium m { density 1 values 1 2 }", "size"),
        ("GridMedium m { density 1 size 2 2 2 values 1 2 }", "a grid of 8 voxels has 2 values"),
        ("GridMedium m { density 1 size 2 1 1 values 1 -2 }", "value 1 of the grid is -2"),
        ("GridMedium m { density 1 size 1 1 1 values 1 min 1 1 1 max 1 2 2 }", "`min` must be less"),
        ("GridMedium m { density 1 file none.vol }", "cannot read `none.vol`: there is no such file"),
        ("GridMedium m { density 1 file short.df3 }", "the file ends after 1 of its 729 values"),
        ("GridMedium m { density 1 file empty.vol }", "the file ends within its header"),
        (
            "GridMedium m { density 1 file bytes.raw size 10000 10000 10000 encoding u8 }",
            "the file ends after 4 of its 1000000000000 values",
        ),
        ("FunctionMedium m { density 1 function = 1 / x }", "the function has no bound"),
        ("FunctionMedium m { density 1 function = x min 1 1 1 }", "`min` must be less"),
        ("GradientIndex m { }", "`GradientIndex` needs `index`"),
        ("GradientIndex m { index 1.5 } exterior m", "fills closed bodies only"),
        ("LuneburgLens m { radius 0 }", "`radius` must be more than 0"),
        ("RodLens m { axis 0 0 0 }", "`axis` must not be zero"),
        ("AirLayers m { depth 0 }", "`depth` must be more than 0"),
        ("AirLayers m { integrator euler steps 0 }", "`steps`"),
    ] {
        let (scene, said) = media(text);
        assert!(scene.is_none() && said.iter().any(|s| s.contains(expected)), "{text}: {said:?}");
    }
}

/// Bodies that bend light are closed, bounded and at rest, and nothing but their inside bends it.
#[test]
fn bodies_that_bend_light_are_closed_and_bounded_and_at_rest() {
    let of = |shape: &str, material: &str| {
        compiled(&format!(
            "Media {{ LuneburgLens m {{ }} }} Materials {{ Interface i {{ medium m }} {material} }}
             Group {{ MaterialIndex i {shape} }}"
        ))
    };
    for (shape, expected) in [
        ("Disk { center 0 0 0 normal 0 1 0 radius 1 }", "a medium fills closed shapes, and this one is open"),
        ("Plane { normal 0 1 0 offset 0 }", "a body that bends light has bounds, and this one has none"),
        (
            "Transform { Motion { key 0 { } key 1 { Translate 1 0 0 } } Sphere { center 0 0 0 radius 1 } }",
            "a body that bends light does not move",
        ),
    ] {
        let (scene, said) = of(shape, "");
        assert!(scene.is_none() && said.iter().any(|said| said == expected), "{shape}: {said:?}");
    }
    let (scene, said) = of("Sphere { center 0 0 0 radius 1 }", "Glass g { medium m }");
    let expected =
        "a medium that bends light can only fill a body with the material `Interface`, not with `Glass`";
    assert!(scene.is_none() && said == [expected], "{said:?}");
    for shape in [
        "Sphere { center 0 0 0 radius 1 }",
        "Difference { Box { min -1 -1 -1 max 1 1 1 } Sphere { center 0 0 0 radius 0.5 } }",
    ] {
        let (scene, said) = of(shape, "");
        let scene = scene.unwrap_or_else(|| panic!("{shape}: {said:?}"));
        assert!(scene.appearance.bends_light && !scene.has_media() && said.is_empty(), "{said:?}");
    }
}

#[test]
fn a_medium_in_an_open_shape_is_refused() {
    let of = |shape: &str| {
        compiled(&format!(
            "Media {{ Medium m {{ density 1 }} }} Materials {{ Interface i {{ medium m }} Glass g {{ medium m }} }}
             Group {{ MaterialIndex i {shape} }}"
        ))
    };
    for shape in
        ["Quad { corner 0 0 0 edge1 1 0 0 edge2 0 1 0 }", "Disk { center 0 0 0 normal 0 1 0 radius 1 }"]
    {
        let (scene, said) = of(shape);
        assert!(
            scene.is_none() && said == ["a medium fills closed shapes, and this one is open"],
            "{said:?}"
        );
    }
    for shape in ["Sphere { center 0 0 0 radius 1 }", "Plane { normal 0 1 0 offset 0 }"] {
        let (scene, said) = of(shape);
        assert!(scene.is_some_and(|scene| scene.has_media()), "{shape}: {said:?}");
    }
    let (_, said) = compiled("Materials { Glass g { medium milk } }");
    assert_eq!(said, ["there is no medium named `milk`"]);
}
