//! What materials and colours of mesh files look like.

use crate::texture::TextureContext;
use kajo_color::Wavelengths;
use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::{Ray, Vec3};
use kajo_scene::{MemoryAssets, SceneDesc};

use super::{CompileOptions, compile};
use crate::bsdf::{Base, Bsdf, Phong};
use crate::material::ShadingPoint;
use crate::scene::{Interaction, RayEvent, Scene};

/// A square of two triangles from (-1, -1) to (1, 1), each with a material of its own.
const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/4\n";

fn picture(texel: fn(u32, u32) -> [f32; 3]) -> Vec<u8> {
    encode(&Image::from_fn(2, 2, texel).unwrap(), Format::Png, &EncodeOptions::default()).unwrap()
}

fn compiled(mesh: &str, assets: MemoryAssets) -> (Option<Scene>, Vec<String>) {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
         Materials {{ Matte {{ color 0.8 0.4 0.2 }} Metal gold {{ metal gold }} Mix both {{ materialIndex 0 materialIndex 0 }} }}
         Group {{ MaterialIndex 0 {mesh} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

fn at(scene: &Scene, x: f32, y: f32) -> Interaction {
    match scene.trace(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => at,
        RayEvent::Escaped => panic!("nothing at {x} {y}"),
    }
}

fn phong(scene: &Scene, x: f32, y: f32) -> Phong {
    let at = at(scene, x, y);
    scene.appearance.phong(at.material, &scene.texture_context(&at))
}

fn diffuse(scene: &Scene, x: f32, y: f32) -> Vec3 {
    phong(scene, x, y).diffuse.to_rgb().into()
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).abs().max_element() < 2e-3
}

/// The scene of the square with `head` before it, and what was said; `a.mtl` and `sub/b.mtl` are there.
fn square(head: &str, a: &str, b: &str) -> (Scene, Vec<String>) {
    let assets = MemoryAssets::new()
        .with("m.obj", format!("{head}{SQUARE}"))
        .with("a.mtl", a)
        .with("sub/b.mtl", b)
        .with("sub/red.png", picture(|_, _| [1.0, 0.0, 0.0]))
        .with("steps.png", picture(|x, _| [x as f32; 3]))
        .with("normals.png", picture(|_, _| [0.5, 0.5, 1.0]));
    let (scene, said) = compiled("TriangleMesh { file m.obj  materials on }", assets);
    (scene.unwrap_or_else(|| panic!("{said:?}")), said)
}

#[test]
fn libraries_are_many_and_their_names_are_of_any_system() {
    let (a, b) = ("newmtl a\nKd 0 1 0\n", "newmtl b\nKd 1 1 1\nmap_Kd C:\\work\\textures\\red.png\n");
    for head in [
        "mtllib a.mtl sub/b.mtl\n",
        "mtllib a.mtl\nmtllib sub\\b.mtl\n",
        "mtllib D:\\x\\a.mtl\nmtllib .\\sub\\b.mtl\n",
    ] {
        let (scene, said) = square(head, a, b);
        assert_eq!(said, [""; 0], "{head}");
        assert_eq!(diffuse(&scene, 0.5, -0.5), Vec3::Y);
        assert_eq!(diffuse(&scene, -0.5, 0.5), Vec3::X);
    }
}

#[test]
fn what_a_missing_library_describes_is_grey() {
    let (scene, said) = square("mtllib none.mtl\nmtllib a.mtl\n", "newmtl a\nKd 0 1 0\n", "");
    let expected =
        "`m.obj`: its library `none.mtl` cannot be read, its materials are grey: there is no such file";
    assert_eq!(said, [expected]);
    assert_eq!([diffuse(&scene, 0.5, -0.5), diffuse(&scene, -0.5, 0.5)], [Vec3::Y, Vec3::splat(0.5)]);
    let (scene, said) = square("mtllib a.mtl\n", "newmtl a\nKd 0 1 0\n", "");
    assert_eq!(said, ["`m.obj`: it uses the material `b`, which none of its libraries has"]);
    assert!(near(diffuse(&scene, -0.5, 0.5), Vec3::new(0.8, 0.4, 0.2)), "the one in force");
}

#[test]
fn what_a_library_says_and_nobody_reads_is_named() {
    let (_, said) =
        square("mtllib a.mtl\n", "newmtl b\nnewmtl a\nsharpness 9\nmap_Ks steps.png\nmap_Ks steps.png\n", "");
    let expected =
        ["`a.mtl`: `sharpness` is not read (line 3)", "`a.mtl`: `map_Ks` is not read (line 4 and 1 more)"];
    assert_eq!(said, expected);
}

#[test]
fn numbers_of_the_extension_become_layers() {
    let mtl = "newmtl b\nKd 0.25 0.5 1\nPr 0.5\nPm 0.75\nPc 0.25\nPcr 0.125\nPs 0.5\nNi 1.25\nKs 1 1 1\n\
               newmtl a\nKd 1 1 1\nmap_Pm -imfchan g steps.png\nmap_Pr steps.png\nPr 0.5\nd 0.5\n";
    let (scene, said) = square("mtllib a.mtl\n", mtl, "");
    assert_eq!(said, [""; 0]);
    let layers = |x: f32, y: f32, u: f32| {
        let met = at(&scene, x, y);
        let context = scene.texture_context(&met);
        let point = ShadingPoint { context: &context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u };
        match scene.appearance.bsdf(met.material, &point) {
            Bsdf::Principled(layers) => Some(layers),
            _ => None,
        }
    };
    let b = layers(-0.5, 0.5, 0.7).unwrap();
    assert_eq!((b.base, b.alpha.x, b.eta), (Base::Metal, 0.25, 1.25));
    assert_eq!((b.coat, b.coat_alpha, b.fuzz), (0.25, 0.015_625, 0.5));
    assert!(near(Vec3::from(b.color.to_rgb()), Vec3::new(0.25, 0.5, 1.0)));
    assert_eq!(layers(-0.5, 0.5, 0.8).unwrap().base, Base::Diffuse);
    // Half of it is there, and of that the picture is black on the left and white on the right.
    let found: Vec<_> = (0..16).map(|i| layers(0.5, -0.5, (i as f32 + 0.5) / 16.0)).collect();
    assert_eq!(found.iter().filter(|layers| layers.is_none()).count(), 8);
    assert!(
        found
            .iter()
            .flatten()
            .all(|layers| layers.base == Base::Metal && (layers.alpha.x - 0.25).abs() < 1e-3)
    );
}

/// What light goes into is a body of glass, as Blender writes it, and that is not done with opacity as well.
#[test]
fn bodies_of_blender_are_of_glass() {
    let mtl = |head: &str, opacity: &str| {
        format!("{head}\nnewmtl b\nnewmtl a\nKd 0.25 0.5 1\nNi 1.25\nPr 0.5\n{opacity}Tf 0.75 0.75 0.75\n")
    };
    let bases = |scene: &Scene| {
        let met = at(scene, 0.5, -0.5);
        let base = |u| {
            let context = scene.texture_context(&met);
            let point =
                ShadingPoint { context: &context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u };
            match scene.appearance.bsdf(met.material, &point) {
                Bsdf::Principled(layers) => Some((layers.base, layers.eta)),
                _ => None,
            }
        };
        [base(0.74), base(0.76)]
    };
    let glass = [Some((Base::Glass, 1.25)), Some((Base::Diffuse, 1.25))];
    let (scene, said) = square("mtllib a.mtl\n", &mtl("# Blender 5.0.1 MTL File: 'None'", "d 1\n"), "");
    assert_eq!((bases(&scene), said), (glass, vec![]));
    let (scene, said) = square("mtllib a.mtl\n", &mtl("# Blender 5.0.1 MTL File: 'None'", "d 0.5\n"), "");
    assert_eq!(bases(&scene), glass);
    assert_eq!(said, ["`a.mtl`: `d` of the material `a` is left out: light passes it anyway"]);
    let (scene, said) = square("mtllib a.mtl\n", &mtl("# another program", ""), "");
    assert_eq!((bases(&scene), said), ([Some((Base::Diffuse, 1.25)); 2], vec![]));
}

#[test]
fn reliefs_are_of_heights_or_of_normals() {
    for (mtl, leans) in [
        ("map_Bump -bm 5 steps.png", true),
        ("bump steps.png", true),
        ("bump -bm 0 steps.png", false),
        ("map_Bump normals.png", false),
        ("norm normals.png\nbump -bm 5 steps.png", false),
    ] {
        let (scene, said) = square("mtllib a.mtl\n", &format!("newmtl b\nnewmtl a\n{mtl}\n"), "");
        assert_eq!(said, [""; 0]);
        let shading = scene.shading(&at(&scene, 0.0, -0.5), 0.5);
        assert!(shading.leans, "{mtl}: there is a relief");
        assert_eq!(shading.n.distance(Vec3::Z) > 8e-3, leans, "{mtl}: {}", shading.n);
    }
}

#[test]
fn colours_of_vertices_tint_the_material_where_they_are_asked_for() {
    // Left red, right green, as values for a screen: 188 is about a half of the light.
    let obj = "v -1 -1 0 188 0 0\nv 1 -1 0 0 255 0\nv 1 1 0 0 255 0\nv -1 1 0 188 0 0\nf 1 2 3 4\n";
    let ply = "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\nelement vertex 4\n\
        property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n\
        property uchar blue\nend_header\n3 0 1 2\n3 0 2 3\n\
        -1 -1 0 188 0 0\n1 -1 0 0 255 0\n1 1 0 0 255 0\n-1 1 0 188 0 0\n";
    let own = Vec3::new(0.8, 0.4, 0.2);
    for name in ["m.obj", "m.ply"] {
        let assets = || MemoryAssets::new().with("m.obj", obj).with("m.ply", ply);
        let (scene, said) = compiled(&format!("TriangleMesh {{ file {name} }}"), assets());
        assert!(
            said.len() == 1 && said[0].ends_with("its colours are not shown; `colors on` shows them"),
            "{said:?}"
        );
        assert!(near(diffuse(&scene.unwrap(), 0.5, -0.5), own));
        let mesh = format!("TriangleMesh {{ file {name}  colors on }}");
        for things in [
            mesh.clone(),
            format!("MaterialIndex both {mesh}"),
            format!("Define m {{ {mesh} }} Instance m {{ }}"),
            format!("Transform {{ Motion {{ key 0 {{ }} key 1 {{ Translate 0 0 1 }} }} {mesh} }}"),
            format!("{mesh} Sphere {{ center 5 0 0  radius 1 }}"),
        ] {
            let (scene, said) = compiled(&things, assets());
            let scene = scene.unwrap_or_else(|| panic!("{things}: {said:?}"));
            assert!(!said.iter().any(|m| m.contains("colours")), "{said:?}");
            for (x, tint) in [(-0.999, Vec3::new(0.503, 0.0, 0.0)), (0.0, Vec3::new(0.2515, 0.5, 0.0))] {
                let found = diffuse(&scene, x, -0.5);
                assert!(near(found, own * tint), "{things} at {x}: {found}");
            }
            if things.contains("Sphere") {
                assert!(near(diffuse(&scene, 5.0, 0.0), own), "what has no corners has no colours of them");
            }
        }
        let (scene, _) = compiled(&format!("MaterialIndex gold {mesh}"), assets());
        let scene = scene.unwrap();
        let met = at(&scene, 0.0, 0.0);
        let plain = scene.appearance.phong(met.material, &TextureContext::default());
        assert_eq!(phong(&scene, 0.0, 0.0), plain, "measured metal has no colour to be tinted");
    }
    let clear = ply.replace("property uchar blue\n", "property uchar blue\nproperty uchar alpha\n");
    let clear = clear.replace("188 0 0\n", "188 0 0 51\n").replace("0 255 0\n", "0 255 0 51\n");
    let mesh = "TriangleMesh { file m.ply  colors on }";
    for things in [mesh.to_owned(), format!("Define m {{ {mesh} }} Instance m {{ }}")] {
        let (scene, said) = compiled(&things, MemoryAssets::new().with("m.ply", &clear));
        let scene = scene.unwrap_or_else(|| panic!("{said:?}"));
        let seen = scene.transmittance_in_air(&Ray::new(Vec3::new(0.0, -0.5, 5.0), Vec3::NEG_Z));
        assert!((seen.to_rgb()[0] - 0.8).abs() < 1e-5, "{things}: {seen:?}");
        assert_eq!(scene.appearance.number(at(&scene, 0.0, -0.5).material), 1, "{things}");
    }
    let assets = MemoryAssets::new().with("m.obj", SQUARE);
    let (_, said) = compiled("TriangleMesh { file m.obj  colors on }", assets);
    assert_eq!(said, ["`m.obj`: it has no colours for `colors on` to show"]);
}
