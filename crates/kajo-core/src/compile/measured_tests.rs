//! Measured materials as the language writes them, and what is said of files that are none.

use kajo_color::Wavelengths;
use kajo_math::{Vec2, Vec3};
use kajo_scene::{Diagnostics, Limits, MemoryAssets, MemoryBudget, SceneDesc};

use super::{CompileOptions, compile};
use crate::bsdf::{Bsdf, Transport};
use crate::material::ShadingPoint;
use crate::measured::btf::{BtfEncoding, BtfSamples, Compression, compress, write_btf};
use crate::scene::Scene;
use crate::texture::TextureContext;

/// A texture of one texel that is half white.
pub(super) fn grey() -> Vec<u8> {
    let values = vec![0.5 * std::f32::consts::FRAC_1_PI; 3];
    let samples =
        BtfSamples { size: [1, 1], views: vec![[0.0; 2]], lights: vec![[0.0; 2]], has_cosine: false, values };
    write_btf(&compress(&samples, &Compression::default()), BtfEncoding::Float)
}

fn compiled(material: &str) -> (Option<Scene>, Vec<String>) {
    let mut damaged = grey();
    damaged[50] ^= 1;
    let assets = MemoryAssets::new()
        .with("grey.btf", grey())
        .with("damaged.btf", damaged)
        .with("short.btf", &grey()[..60])
        .with("other.btf", "P6 1 1")
        .with("short.binary", [90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0, 7])
        .with("empty.bsdf", b"tensor_file\0\x01\x00\0\0\0\0");
    let limits = Limits { memory: MemoryBudget::new(64 << 20), ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
    let group = "Group { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } }";
    let mut parsed = SceneDesc::parse_str(&format!("{camera} Materials {{ {material} }} {group}"));
    let mut diagnostics = Diagnostics::default();
    let scene = compile(&mut parsed.desc, &assets, &options, &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

#[test]
fn a_texture_is_read_once_and_scaled() {
    let text = "BTF a { file grey.btf  repeat 3 3 } BTF b { file grey.btf  scale 0.5  filter trilinear }
                BTF c { file grey.btf  scale = 0.25 + x }";
    let (scene, said) = compiled(text);
    let scene = scene.unwrap_or_else(|| panic!("{said:?}"));
    let appearance = &scene.appearance;
    assert!(appearance.has_filters && appearance.has_orientations && appearance.has_pictures);
    for (i, albedo) in [0.5, 0.25, 0.125].into_iter().enumerate() {
        let (context, wavelengths) = (TextureContext::default(), &Wavelengths::RGB);
        let at = ShadingPoint { context: &context, wavelengths, eta_outside: 1.0, u: 0.5 };
        let bsdf = appearance.bsdf(appearance.list[i].0, &at);
        assert!(matches!(bsdf, Bsdf::Btf(_)));
        let found = bsdf.sample(Vec3::Z, Vec2::splat(0.4), 0.3, Transport::Radiance).unwrap().weight;
        assert!((found[1] - albedo).abs() < 1e-3, "{found:?}");
        assert!((bsdf.albedo(Vec3::Z)[2] - albedo).abs() < 1e-3);
        let phong = appearance.phong(appearance.list[i].0, &context);
        assert!((phong.diffuse[1] - albedo).abs() < 1e-3, "{phong:?}");
    }
}

#[test]
fn scenes_without_such_a_filter_carry_no_footprints() {
    let (scene, _) = compiled("BTF a { file grey.btf }");
    assert!(!scene.unwrap().appearance.has_filters);
}

#[test]
fn files_that_are_none_are_named_with_the_reason() {
    for (text, expected) in [
        ("BTF a { file none.btf }", "cannot read `none.btf`: there is no such file"),
        ("BTF a { file damaged.btf }", "cannot read `damaged.btf`: "),
        ("BTF a { file short.btf }", "cannot read `short.btf`: the file ends within its "),
        ("BTF a { file other.btf }", "cannot read `other.btf`: this is no kajo BTF"),
        ("Measured a { file none.bsdf }", "cannot read `none.bsdf`: there is no such file"),
        ("Measured a { file short.binary }", "cannot read `short.binary`: it has 1 bytes of values"),
        ("Measured a { file empty.bsdf }", "cannot read `empty.bsdf`: it has no field `theta_i`"),
        ("Measured a { file other.btf }", "cannot read `other.btf`: the file ends within its header"),
    ] {
        let (scene, said) = compiled(text);
        assert!(scene.is_none() && said.len() == 1 && said[0].starts_with(expected), "{text}: {said:?}");
    }
}

#[test]
fn keys_that_are_missing_or_wrong_are_named() {
    let error = |text: &str| compiled(text).1.join("; ");
    assert!(error("BTF a { repeat 2 2 }").contains("`file`"));
    assert!(error("BTF a { file grey.btf  scale -1 }").contains("at least 0"));
    assert!(error("BTF a { file grey.btf  filter ewa }").contains("ewa"));
    assert!(error("Measured a { }").contains("`file`"));
}
