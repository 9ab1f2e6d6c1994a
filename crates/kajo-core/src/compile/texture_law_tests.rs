//! What holds for every parameter of every material that may be a texture, by the list of their fields.

use kajo_color::Wavelengths;
use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::{Ray, Vec3};
use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

use super::blocks::MATERIALS;
use super::measured_tests::grey;
use super::{CompileOptions, compile};
use crate::scene::Scene;
use crate::schema::{Block, FieldKind, FieldSpec};

/// What else is in a block, so that each of its parameters makes a difference.
const BESIDE: &[(&str, &[(&str, &str)])] = &[
    ("BTF", &[("file", "grey.btf")]),
    ("Glass", &[("thickness", "0.5"), ("absorption", "1 2 3"), ("roughness", "0.5"), ("anisotropy", "0.5")]),
    ("Matte", &[]),
    ("Metal", &[("roughness", "0.5"), ("anisotropy", "0.5")]),
    ("Mix", &[("materialIndex", "other"), ("materialIndex", "shiny")]),
    ("Material", &[("specularColor", "0.5 0.5 0.5"), ("diffuseColor", "0.25 0.25 0.25")]),
    ("PhongMaterial", &[("specularColor", "0.5 0.5 0.5"), ("diffuseColor", "0.25 0.25 0.25")]),
    (
        "Principled",
        &[
            ("anisotropy", "0.5"),
            ("coat", "0.5"),
            ("fuzz", "0.5"),
            ("metalness", "0.25"),
            ("roughness", "0.5"),
        ],
    ),
];

/// Numbers and colours of materials that are no textures: what the inside of a body is like, which is not of its
/// surface, and what patterns are.
const NO_TEXTURES: &[(&str, &str)] = &[
    ("AccretionDisk", "luminance"),
    ("AccretionDisk", "temperature"),
    ("Glass", "indexOfRefraction"),
    ("Glass", "abbeNumber"),
    ("Glass", "absorption"),
    ("GravitationalLens", "axisRatio"),
    ("GravitationalLens", "core"),
    ("GravitationalLens", "dispersion"),
    ("GravitationalLens", "mass"),
    ("Marble", "frequency"),
    ("Marble", "amplitude"),
    ("Material", "indexOfRefraction"),
    ("Material", "refractionIndex"),
    ("Material", "absorption"),
    ("PhongMaterial", "indexOfRefraction"),
    ("PhongMaterial", "refractionIndex"),
    ("PhongMaterial", "absorption"),
    ("Principled", "absorption"),
    ("Principled", "subsurfaceAnisotropy"),
    ("Principled", "subsurfaceRadius"),
    ("Principled", "subsurfaceScale"),
    ("Wood", "frequency"),
    ("Wood", "amplitude"),
];

/// Whether a field may say a number or a colour.
fn is_value(field: &FieldSpec) -> bool {
    matches!(
        field.kind,
        FieldKind::Number { .. } | FieldKind::Color(_) | FieldKind::Reflectance | FieldKind::Emission
    )
}

fn fields() -> impl Iterator<Item = (&'static Block, &'static FieldSpec)> {
    let of_block = |block: &'static Block| block.fields().map(move |field| (block, field));
    MATERIALS.iter().map(|member| &member.block).flat_map(of_block)
}

/// A floor whose material has this value, on the left half of its coordinates and on the right one; what is wrong if
/// it cannot be made.
fn answers(block: &Block, field: &FieldSpec, value: &str) -> Result<[String; 2], String> {
    let picture = Image::from_fn(2, 1, |x, _| if x == 0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 1.0] });
    let options = EncodeOptions::default();
    let halves =
        encode(&picture.expect("a small picture"), Format::Pfm, &options).expect("it can be written");
    let beside =
        BESIDE.iter().find(|(keyword, _)| *keyword == block.keyword).map_or(&[][..], |found| found.1);
    let beside = beside.iter().filter(|(key, _)| *key != field.key);
    let mut beside: String = beside.map(|(key, value)| format!("{key} {value} ")).collect();
    if field.key == "transparentColor" {
        // What holds without it depends on the colour.
        beside += "absorption 1 2 3 ";
    }
    let text = format!(
        "PerspectiveCamera {{ center 0 9 0 direction 0 -1 0 up 0 0 -1 angle 30 }}
         Textures {{
           Gradient across {{ wave once  Transform {{ Translate -0.5 0 0 }} }}
           Threshold right {{ texture across }}
           Ramp halves {{ texture across  interpolation step  stop 0 1 0 0  stop 0.5 0 1 1 }}
         }}
         Materials {{
           {} {{ {beside} {} {value} }}
           Matte other {{ color 0.5 0.25 0.5 }}
           Metal shiny {{ roughness 0.5 }}
         }}
         Group {{ MaterialIndex 0 Quad {{ corner -1 0 1 edge1 2 0 0 edge2 0 0 -2 }} }}",
        block.keyword, field.key
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let mut said = Diagnostics::default();
    let assets = MemoryAssets::new().with("halves.pfm", halves).with("grey.btf", grey());
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut said);
    let all = || said.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ");
    scene.map(|scene| [-0.5, 0.5].map(|x| answer(&scene, x))).ok_or_else(all)
}

/// All that a material says of a place.
fn answer(scene: &Scene, x: f32) -> String {
    let ray = Ray::new(Vec3::new(x, 9.0, 0.3), Vec3::NEG_Y);
    let event = scene.trace(&ray);
    let at = event.surface().expect("the floor is met");
    let (context, wavelengths) = (scene.texture_context(at), &Wavelengths::RGB);
    let phong = scene.appearance.phong(at.material, &context);
    let light = scene.surface_light(at, ray.d, wavelengths).map_or([0.0; 3], |light| light.radiance.to_rgb());
    let lobes = [0.0, 0.1, 0.3, 0.5, 0.7, 0.9].map(|u| {
        let bsdf = scene.bsdf(at, wavelengths, 1.0, u);
        (bsdf, scene.shading(at, u), scene.interior(at, wavelengths, u))
    });
    let passes = scene.transmittance_in_air(&ray);
    format!("{phong:?} {light:?} {lobes:?} {passes:?}")
}

/// Where a texture has a number, a material is as with that number everywhere; and no parameter goes unheard.
#[test]
fn a_texture_is_at_each_place_the_number_that_it_has_there() {
    let mut tested = 0;
    for (block, field) in fields().filter(|(_, field)| is_value(field) && field.texture.is_some()) {
        let (left, right, texture) = match field.kind {
            FieldKind::Number { min, .. } => {
                let [lo, hi] = [min + 0.25, min + 0.75];
                (hi.to_string(), lo.to_string(), format!("halves.pfm {{ filter nearest range {lo} {hi} }}"))
            }
            _ => ("1 0 0".to_owned(), "0 1 1".to_owned(), "halves.pfm { filter nearest }".to_owned()),
        };
        let what = format!("{} of {}", field.key, block.keyword);
        let [by_left, by_right, by_texture] =
            [left, right, texture].map(|value| answers(block, field, &value));
        let Ok([at_left, at_right]) = by_texture else {
            assert!(by_left == by_texture && by_right == by_texture, "{what}: {by_texture:?}");
            continue;
        };
        let (by_left, by_right) = (by_left.unwrap()[0].clone(), by_right.unwrap()[1].clone());
        assert_ne!(by_left, by_right, "{what} makes no difference");
        assert!(
            at_left == by_left && at_right == by_right,
            "{what}: {at_left} {by_left}, {at_right} {by_right}"
        );
        tested += 1;
    }
    assert!(tested >= 40, "{tested}");
}

/// The same for textures that have names.
#[test]
fn a_named_texture_is_at_each_place_what_it_is_there() {
    let mut tested = 0;
    for (block, field) in fields().filter(|(_, field)| is_value(field) && field.texture.is_some()) {
        let (left, right, name) = match field.kind {
            FieldKind::Number { min, .. } => {
                let [lo, hi] = [min + 0.25, min + 0.75];
                (lo.to_string(), hi.to_string(), format!("right {{ range {lo} {hi} }}"))
            }
            _ => ("1 0 0".to_owned(), "0 1 1".to_owned(), "halves".to_owned()),
        };
        let what = format!("{} of {}", field.key, block.keyword);
        let [by_left, by_right, by_name] = [left, right, name].map(|value| answers(block, field, &value));
        let Ok(by_name) = by_name else {
            assert!(by_left == by_name && by_right == by_name, "{what}: {by_name:?}");
            continue;
        };
        assert_eq!(by_name, [by_left.unwrap()[0].clone(), by_right.unwrap()[1].clone()], "{what}");
        tested += 1;
    }
    assert!(tested >= 40, "{tested}");
}

/// The same for functions of the place.
#[test]
fn a_function_is_at_each_place_the_number_that_it_has_there() {
    let mut tested = 0;
    for (block, field) in fields().filter(|(_, field)| field.texture.is_some()) {
        let FieldKind::Number { min, .. } = field.kind else { continue };
        let [lo, hi] = [min + 0.25, min + 0.75];
        let function = format!("= {lo} + 0.5 * step(x, 0)");
        let by_function = answers(block, field, &function);
        let [by_hi, by_lo] = [hi, lo].map(|value| answers(block, field, &value.to_string()));
        let what = format!("{} of {}", field.key, block.keyword);
        let Ok(by_function) = by_function else {
            assert!(by_hi == by_function && by_lo == by_function, "{what}: {by_function:?}");
            continue;
        };
        assert_eq!(by_function, [by_hi.unwrap()[0].clone(), by_lo.unwrap()[1].clone()], "{what}");
        tested += 1;
    }
    assert!(tested >= 20, "{tested}");
}

/// What only textures can say, such as reliefs, names may say as well as pictures.
#[test]
fn a_named_texture_stands_where_a_picture_may() {
    let mut tested = 0;
    // Slopes of pictures are differences of texels.
    let pictures = fields().filter(|(_, field)| field.kind == FieldKind::Picture && field.key != "bump");
    for (block, field) in pictures {
        let [picture, name] =
            ["halves.pfm { filter nearest }", "halves"].map(|value| answers(block, field, value));
        assert_eq!(name, picture, "{} of {}", field.key, block.keyword);
        tested += u32::from(name.is_ok());
    }
    assert!(tested >= 8, "{tested}");
}

/// Light that a function says, as bright as it is.
#[test]
fn a_function_is_the_light_of_a_surface() {
    let fields: Vec<_> = fields().filter(|(_, field)| field.key == "emission").collect();
    for &(block, field) in fields.iter().filter(|(block, _)| block.keyword == "Matte") {
        let by_function = answers(block, field, "= 3 + 4 * step(x, 0)").unwrap();
        let [seven, three] = ["7 7 7", "3 3 3"].map(|value| answers(block, field, value).unwrap());
        assert_eq!(by_function, [seven[0].clone(), three[1].clone()]);
        assert!(by_function[0].contains("[7.0, 7.0, 7.0]"), "{by_function:?}");
    }
    assert!(fields.len() >= 8, "{}", fields.len());
}

#[test]
fn numbers_and_colours_of_materials_may_be_textures() {
    let others = fields().filter(|(_, field)| is_value(field) && field.texture.is_none());
    let others: Vec<_> = others.map(|(block, field)| (block.keyword, field.key)).collect();
    let mut expected = NO_TEXTURES.to_vec();
    expected.sort_unstable();
    let mut found = others;
    found.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn a_picture_of_an_index_says_its_range() {
    let field = |keyword, key| {
        fields().find(|(block, field)| (block.keyword, field.key) == (keyword, key)).expect("a field")
    };
    let (block, index) = field("Principled", "indexOfRefraction");
    let said = answers(block, index, "halves.pfm").unwrap_err();
    assert!(said.contains("needs a `range`") && said.contains("from 1 to 4"), "{said}");
    let said = answers(block, index, "halves.pfm { range 1.3 5 }").unwrap_err();
    assert!(said.contains('5'), "{said}");
    let body = answers(block, index, "halves.pfm { range 1.3 1.5 } transmission 0.5").unwrap_err();
    assert!(body.contains("the inside of a body has one index"), "{body}");
    let (block, diffuse) = field("PhongMaterial", "diffuseColor");
    let said = answers(block, diffuse, "halves.pfm  texture halves.pfm");
    assert!(said.is_err_and(|said| said.contains("beside a `diffuseColor`")));
}
