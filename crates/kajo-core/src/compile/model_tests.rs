//! What becomes of lights, cameras, colours, pictures, points and lines of models.

use kajo_color::Wavelengths;
use kajo_image::{EncodeOptions, Format, Image, encode};
use kajo_math::{DVec3, Ray, Vec2, Vec3};
use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

use crate::camera::Camera;
use crate::compile::{CompileOptions, compile};
use crate::differential::SurfaceFootprint;
use crate::light::tests::sample_li;
use crate::scene::{Interaction, Scene};

/// The scene of these objects, which may name `a.gltf`, `a.obj` and `a.ply`, and what was said; the file has this content besides a triangle of
/// the corners (-1, -1), (3, -1) and (-1, 3): positions in accessor 0, coordinates from (0, 0) to (2, 2) in 1, coordinates of
/// (0.75, 0.75) in 2, red, green and blue in 3, the same with opacities of 1, 0.5 and 0 in 4, and 8 times those of 1 in 5.
fn compiled(objects: &str, content: &str) -> (Option<Scene>, Vec<String>) {
    compiled_of("Materials { Matte { color 0.5 0.5 0.5 } }", objects, content)
}

/// The same of these materials.
fn compiled_of(materials: &str, objects: &str, content: &str) -> (Option<Scene>, Vec<String>) {
    let floats: [&[f32]; 6] = [
        &[-1.0, -1.0, 0.0, 3.0, -1.0, 0.0, -1.0, 3.0, 0.0],
        &[0.0, 1.0, 2.0, 1.0, 0.0, -1.0],
        &[0.75, 0.25, 0.75, 0.25, 0.75, 0.25],
        &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        &[1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0],
        &[0.0, 8.0, 16.0, 8.0, 0.0, -8.0],
    ];
    let (mut bytes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new());
    for (i, list) in floats.iter().enumerate() {
        let (at, length) = (bytes.len(), 4 * list.len());
        bytes.extend(list.iter().flat_map(|x| x.to_le_bytes()));
        views.push(format!(r#"{{"buffer":0,"byteOffset":{at},"byteLength":{length}}}"#));
        let width = list.len() / 3;
        accessors.push(format!(r#"{{"bufferView":{i},"componentType":5126,"count":3,"type":"VEC{width}"}}"#));
    }
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"a.bin","byteLength":{}}}],"bufferViews":[{}],"accessors":[{}],
        "textures":[{{"source":0}},{{"source":1}},{{"extensions":{{"KHR_texture_basisu":{{"source":2}}}}}},{{"source":3}}],
        "images":[{{"uri":"a.png"}},{{"uri":"b.png"}},{{"uri":"c.ktx2"}},{{"uri":"none.png"}}],{content}}}"#,
        bytes.len(),
        views.join(","),
        accessors.join(",")
    );
    let png = |texel: fn(u32, u32) -> [f32; 4]| {
        encode(&Image::from_fn(2, 2, texel).unwrap(), Format::Png, &EncodeOptions::default()).unwrap()
    };
    // Red and green above blue and white; and a metal on the left of a diffuse base, half as glossy.
    let colors = png(|x, y| {
        [[[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]], [[0.0, 0.0, 1.0, 1.0], [1.0; 4]]][y as usize]
            [x as usize]
    });
    let gloss = png(|x, _| if x == 0 { [1.0, 1.0, 1.0, 1.0] } else { [0.0, 0.0, 0.0, 0.5] });
    let assets = MemoryAssets::new()
        .with("a.gltf", json)
        .with("a.bin", bytes)
        .with("a.png", colors)
        .with("b.png", gloss)
        .with("a.obj", "v -1 -1 0 1 0 0\nv 3 -1 0 0 1 0\nv -1 3 0 0 0 1\nf 1 2 3\n")
        .with(
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n\
             -1 -1 0 255 0 0\n3 -1 0 0 255 0\n-1 3 0 0 0 255\n3 0 1 2\n",
        );
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
         {materials} Group {{ MaterialIndex 0 {objects} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let mut diagnostics = Diagnostics::default();
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

fn scene(objects: &str, content: &str) -> Scene {
    let (scene, said) = compiled(objects, content);
    assert!(said.is_empty(), "{said:?}");
    scene.expect("a scene without mistakes")
}

/// Where a ray along the z axis hits the triangle.
fn met(scene: &Scene, x: f32, y: f32) -> Interaction {
    let event = scene.trace(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z));
    *event.surface().expect("the ray hits the model")
}

/// The colour that the classic integrator sees there.
fn color(scene: &Scene, x: f32, y: f32) -> Vec3 {
    let at = met(scene, x, y);
    let context = scene.texture_context(&at);
    scene.appearance.phong(at.material, &context).diffuse.to_rgb().into()
}

/// A triangle with these attributes and this in its material.
fn triangle(attributes: &str, material: &str) -> String {
    format!(
        r#""nodes":[{{"mesh":0}}],"materials":[{{{material}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{attributes}}},"material":0}}]}}]"#
    )
}

const LIGHTS: &str = r#""nodes":[
    {"name":"light","translation":[1,0,0],"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}},
    {"extensions":{"KHR_lights_punctual":{"light":1}}},{"extensions":{"KHR_lights_punctual":{"light":2}}}],
    "cameras":[{"perspective":{"yfov":0.5}}],
    "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","color":[1,0.5,0],"intensity":8},
    {"type":"directional","intensity":3},{"type":"spot","intensity":2,"spot":{"outerConeAngle":0.5}}]}}"#;

#[test]
fn lights_shine_in_their_units_where_the_model_stands() {
    let placed = |keys: &str| {
        scene(
            &format!("Transform {{ Translate 0 2 0  UniformScale 3  Model {{ file a.gltf {keys} }} }}"),
            LIGHTS,
        )
    };
    let lit = placed("");
    assert_eq!(lit.lighting.list.len(), 3);
    let emitter = &lit.lighting.lights.point[0];
    assert_eq!(emitter.position, Vec3::new(3.0, 2.0, 0.0));
    // Illuminance is candela over the square of the distance.
    let sample = sample_li(emitter, Vec3::new(3.0, 0.0, 0.0), Vec2::ZERO).unwrap();
    assert_eq!(sample.radiance.to_rgb(), [2.0, 1.0, 0.0]);
    let sun = sample_li(&lit.lighting.lights.directional[0], Vec3::ZERO, Vec2::ZERO).unwrap();
    assert_eq!((sun.wi, sun.radiance.to_rgb()), (Vec3::Z, [3.0; 3]));
    let spot = &lit.lighting.lights.spots[0];
    assert_eq!((spot.axis, spot.cone.inner), (Vec3::NEG_Z, 0.0));
    assert_eq!(placed("lightScale 0.25").lighting.lights.point[0].emission.rgb(), [2.0, 1.0, 0.0]);
    assert!(placed("lights off").lighting.list.is_empty());
    assert_eq!(placed("group key").lighting.groups[1], *"key");
    let (_, said) = compiled("Define emitters { Model { file a.gltf } }  Instance emitters", LIGHTS);
    assert_eq!(said, ["the lights of a model within a `Define` block are left out"]);
}

#[test]
fn cameras_are_listed_where_the_model_stands() {
    let objects = "Transform { Translate 0 2 0  YRotate 90  Model { file a.gltf  lights off } }";
    let scene = scene(objects, LIGHTS);
    let [_, camera] = &scene.output.cameras[..] else { panic!("{:?}", scene.output.cameras) };
    let Camera::Perspective(view) = &camera.camera else { panic!("{camera:?}") };
    assert_eq!(camera.name.as_deref(), Some("light"));
    let frame = view.frame();
    assert!(frame.center.distance(DVec3::new(0.0, 2.0, -1.0)) < 1e-9, "{frame:?}");
    assert!(frame.forward.distance(DVec3::NEG_X) < 1e-9 && frame.up.distance(DVec3::Y) < 1e-9, "{frame:?}");
    assert!((view.distance() * 0.25f64.tan() - 1.0).abs() < 1e-9);
}

#[test]
fn colours_at_vertices_are_factors() {
    let model = "Model { file a.gltf }";
    let diffuse = r#""pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1],"metallicFactor":0}"#;
    let plain = scene(model, &triangle(r#","COLOR_0":3"#, diffuse));
    let near = |found: Vec3, expected: [f32; 3]| {
        assert!(found.distance(expected.into()) < 1e-3, "{found} for {expected:?}");
    };
    near(color(&plain, 0.0, 0.0), [0.25, 0.25, 0.25]);
    near(color(&plain, 1.0, 0.0), [0.125, 0.5, 0.25]);
    let pictured = diffuse.replace("{\"base", "{\"baseColorTexture\":{\"index\":0},\"base");
    let pictured = scene(model, &triangle(r#","COLOR_0":3,"TEXCOORD_0":2"#, &pictured));
    // The picture is green there.
    near(color(&pictured, 0.0, 0.0), [0.0, 0.25, 0.0]);
    let (scene, said) =
        compiled("Model { file a.gltf  materials off }", &triangle(r#","COLOR_0":3"#, diffuse));
    assert_eq!((color(&scene.unwrap(), 0.0, 0.0), said), (Vec3::splat(0.5), Vec::new()));
}

#[test]
fn a_coloured_triangle_is_the_same_in_every_format() {
    let diffuse = r#""pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1],"metallicFactor":0}"#;
    let content = triangle(r#","COLOR_0":3"#, diffuse);
    let blocks = [
        "Model { file a.gltf }",
        "TriangleMesh { file a.obj  colors on }",
        "TriangleMesh { file a.ply  colors on }",
    ];
    let scenes = blocks.map(|block| scene(block, &content));
    for (x, y) in [(-0.9, -0.9), (0.0, 0.0), (1.5, -0.5), (-0.5, 1.75)] {
        // The corners are red, green and blue, at (-1, -1), (3, -1) and (-1, 3).
        let (green, blue) = (0.25 * (x + 1.0), 0.25 * (y + 1.0));
        let expected = 0.5 * Vec3::new(1.0 - green - blue, green, blue);
        for (scene, block) in std::iter::zip(&scenes, blocks) {
            let found = color(scene, x, y);
            assert!(found.distance(expected) < 1e-5, "{block} at {x} {y}: {found} for {expected}");
        }
    }
}

#[test]
fn opacities_at_vertices_are_factors_where_the_material_asks() {
    let visible = |material: &str, x: f32, y: f32| {
        let scene = scene("Model { file a.gltf }", &triangle(r#","COLOR_0":4"#, material));
        let ray = Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z);
        scene.transmittance_in_air(&ray).to_rgb()[1]
    };
    // Opacities of 1, 0.5 and 0 at the corners.
    let opacity = |x: f32, y: f32| 1.0 - 0.125 * (x + 1.0) - 0.25 * (y + 1.0);
    let half = r#""alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5]}"#;
    for (x, y) in [(-0.5, -0.5), (0.5, 0.5), (-0.5, 2.0)] {
        let near = |found: f32, expected: f32| {
            assert!((found - expected).abs() < 1e-5, "{found} for {expected} at {x} {y}");
        };
        near(visible("", x, y), 0.0);
        near(visible(r#""alphaMode":"BLEND""#, x, y), 1.0 - opacity(x, y));
        near(visible(half, x, y), 1.0 - 0.5 * opacity(x, y));
        let cut = visible(r#""alphaMode":"MASK","alphaCutoff":0.4"#, x, y);
        near(cut, if opacity(x, y) < 0.4 { 1.0 } else { 0.0 });
    }
}

#[test]
fn surfaces_without_lighting_shine_in_the_colours_of_their_vertices() {
    let material =
        r#""pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1]},"extensions":{"KHR_materials_unlit":{}}"#;
    let unlit = scene("Model { file a.gltf }", &triangle(r#","COLOR_0":3"#, material));
    for (x, y) in [(-0.5, -0.5), (1.0, 0.5)] {
        let emitted = unlit.surface_light(&met(&unlit, x, y), Vec3::NEG_Z, &Wavelengths::RGB).unwrap();
        let (green, blue) = (0.25 * (x + 1.0), 0.25 * (y + 1.0));
        let expected = Vec3::new(0.5 * (1.0 - green - blue), green, blue);
        assert!(Vec3::from(emitted.radiance.to_rgb()).distance(expected) < 1e-5, "{emitted:?} at {x} {y}");
    }
}

#[test]
fn pictures_are_laid_by_the_second_coordinates() {
    let material = r#""normalTexture":{"index":0},"pbrMetallicRoughness":{"metallicFactor":0,
        "baseColorTexture":{"index":0,"texCoord":1}}"#;
    let laid = scene("Model { file a.gltf }", &triangle(r#","TEXCOORD_0":1,"TEXCOORD_1":2"#, material));
    for (x, y) in [(-0.5, -0.5), (0.5, 0.5), (-0.5, 0.9)] {
        assert!(color(&laid, x, y).distance(Vec3::Y) < 1e-3, "{}", color(&laid, x, y));
    }
}

/// Where the second coordinates grow 8 times as fast as the first, a sample covers 8 times as much of a picture on them.
#[test]
fn footprints_on_second_coordinates_are_their_own() {
    let laid = |filter: &str, set: u32, attributes: &str, material: &str| {
        let materials = format!(
            "Textures {{ Placed t {{ texture a.png {{ filter {filter} }}  projection uv  uvSet {set} }} }}
             Materials {{ Matte {{ color t }} }}"
        );
        let content = triangle(attributes, material);
        let (scene, said) = compiled_of(&materials, "Model { file a.gltf  materials off }", &content);
        assert!(said.is_empty(), "{said:?}");
        scene.expect("a scene without mistakes")
    };
    let asks =
        r#""normalTexture":{"index":0},"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}}"#;
    let covered = |scene: &Scene, x: f32, y: f32| {
        let footprint = SurfaceFootprint { dp: [0.3 * Vec3::X, 0.1 * (Vec3::X + Vec3::Y)] };
        let at = Interaction { footprint, ..met(scene, x, y) };
        let context = scene.texture_context(&at);
        Vec3::from(scene.appearance.phong(at.material, &context).diffuse.to_rgb())
    };
    for filter in ["ewa", "trilinear", "sat", "feline"] {
        let second = laid(filter, 2, r#","TEXCOORD_0":1,"TEXCOORD_1":5"#, asks);
        let first = laid(filter, 1, r#","TEXCOORD_0":5"#, "");
        assert!(second.appearance.textures.wants_second_footprint());
        assert!(!first.appearance.textures.wants_second_footprint());
        let mut off = 0.0f32;
        for (x, y) in (0..40).map(|i| (-0.9 + 0.04 * i as f32, -0.7 + 0.03 * i as f32)) {
            let (found, expected) = (covered(&second, x, y), covered(&first, x, y));
            assert!(found.distance(expected) < 1e-5, "{filter} {x} {y}: {found} {expected}");
            off = off.max(found.distance(color(&second, x, y)));
        }
        assert!(off > 0.05, "{filter}: {off}");
    }
}

#[test]
fn pictures_of_models_take_the_filter_of_the_render() {
    let material = r#""pbrMetallicRoughness":{"metallicFactor":0,"baseColorTexture":{"index":0}}"#;
    let content = triangle(r#","TEXCOORD_0":1"#, material);
    for (settings, is_filtered) in [("", false), ("Settings { textureFilter trilinear }", true)] {
        let materials = format!("{settings} Materials {{ Matte {{ color 0.5 0.5 0.5 }} }}");
        let (scene, said) = compiled_of(&materials, "Model { file a.gltf }", &content);
        let scene = scene.unwrap_or_else(|| panic!("{said:?}"));
        let footprint = SurfaceFootprint { dp: [4.0 * Vec3::X, 4.0 * Vec3::Y] };
        let at = Interaction { footprint, ..met(&scene, -0.5, 0.5) };
        let found = scene.appearance.phong(at.material, &scene.texture_context(&at)).diffuse.to_rgb();
        // The mean of all four texels.
        let is_mean = Vec3::from(found).distance(Vec3::splat(0.5)) < 1e-3;
        assert_eq!(is_mean, is_filtered, "{settings}: {found:?}");
    }
}

#[test]
fn unlit_surfaces_have_their_colour_in_any_light() {
    let material = r#""pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,0.75,1]},"extensions":{"KHR_materials_unlit":{}}"#;
    let unlit = scene("Model { file a.gltf }", &triangle("", material));
    assert_eq!(unlit.lighting.lights.areas.len(), 1);
    let at = met(&unlit, 0.0, 0.0);
    let bsdf = unlit.bsdf(&at, &Wavelengths::RGB, 1.0, 0.5);
    assert!(bsdf.albedo(Vec3::Z).to_rgb().iter().all(|&c| c < 1e-6));
    assert_eq!(unlit.lighting.lights.areas[0].emission.rgb(), [0.25, 0.5, 0.75]);
}

#[test]
fn glossiness_in_pictures_becomes_metalness() {
    let material = r#""extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0.5,0.5,1],
        "specularFactor":[1,0.8,0.3],"specularGlossinessTexture":{"index":1}}}"#;
    let older = scene("Model { file a.gltf }", &triangle(r#","TEXCOORD_0":1"#, material));
    let layers = |x| {
        let at = met(&older, x, 0.0);
        let bsdf = older.bsdf(&at, &Wavelengths::RGB, 1.0, 0.5);
        let crate::bsdf::Bsdf::Principled(layers) = bsdf else { panic!("{bsdf:?}") };
        (layers.base, Vec3::from(layers.color.to_rgb()), layers.alpha.x)
    };
    let (base, gold, alpha) = layers(-0.5);
    assert!(base == crate::bsdf::Base::Metal && alpha == 0.0, "{base:?} {alpha}");
    assert!(gold.distance(Vec3::new(1.0, 0.8, 0.3)) < 0.01, "{gold}");
    let (base, grey, alpha) = layers(0.5);
    assert!(base == crate::bsdf::Base::Diffuse && (alpha - 0.25).abs() < 0.01, "{base:?} {alpha}");
    assert!(grey.distance(Vec3::splat(0.5 / 0.96)) < 0.01, "{grey}");
}

#[test]
fn missing_pictures_are_named_once() {
    let shown = r#""normalTexture":{"index":3},"emissiveTexture":{"index":3},"emissiveFactor":[1,1,1]"#;
    let content = triangle(r#","TEXCOORD_0":1"#, shown);
    let (scene, said) = compiled("Model { file a.gltf }", &content);
    assert!(scene.is_some());
    assert_eq!(said, ["`a.gltf`: `none.png` is left out: there is no such file"]);
}

#[test]
fn pictures_in_other_containers_are_named_once() {
    let content =
        triangle(r#","TEXCOORD_0":1"#, r#""normalTexture":{"index":2},"emissiveTexture":{"index":2}"#);
    let content = format!(r#"{content},"extensionsUsed":["KHR_texture_basisu"]"#);
    let (scene, said) = compiled("Model { file a.gltf }", &content);
    assert!(
        scene.is_some() && said.len() == 1 && said[0].contains("`images[2]` is left out: KTX2"),
        "{said:?}"
    );
}

#[test]
fn points_and_lines_are_shown_on_request() {
    let beads = |mode: u32| {
        format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":3}},"mode":{mode}}}]}}]"#
        )
    };
    let (_, said) = compiled("Model { file a.gltf }", &beads(0));
    assert_eq!(said, ["`a.gltf`: left out: 3 points; `points RADIUS` shows them"]);
    let points = scene("Model { file a.gltf  points 0.25 }", &beads(0));
    assert_eq!((points.geometry.primitives.len(), points.geometry.shapes.spheres.len()), (3, 3));
    let at = met(&points, -1.0, -1.0);
    assert!((at.hit.t - 4.75).abs() < 1e-4);
    let point = points.texture_context(&at);
    let phong = points.appearance.phong(at.material, &point);
    assert_eq!(phong.diffuse.to_rgb(), [1.0, 0.0, 0.0]);
    let (_, said) = compiled("Model { file a.gltf  points 1 }", &beads(2));
    assert_eq!(said, ["`a.gltf`: left out: 3 lines; `lines RADIUS` shows them"]);
    let lines = scene("Model { file a.gltf  lines 0.25 }", &beads(2));
    assert_eq!((lines.geometry.shapes.spheres.len(), lines.geometry.shapes.cones.len()), (3, 3));
    assert!((met(&lines, 1.0, -1.0).hit.t - 4.75).abs() < 1e-4);
}

/// The corner of a triangle goes to (4 v + a + b)/6 of its own and the other two.
#[test]
fn models_are_subdivided() {
    let content = triangle("", "");
    let hits = |objects: &str, x: f32, y: f32| {
        let ray = Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z);
        scene(objects, &content).trace(&ray).surface().is_some()
    };
    let [x, y] = [10.0 / 6.0, -2.0 / 6.0];
    for keys in ["subdivide 1", "subdivide 4", "subdivide 3  scheme loop"] {
        let model = format!("Model {{ file a.gltf {keys} }}");
        assert!(hits(&model, x - 0.01, y) && !hits(&model, x + 0.01, y), "{keys}");
    }
    assert!(hits("Model { file a.gltf }", x + 0.01, y));
    let material =
        r#""normalTexture":{"index":0},"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}}"#;
    let with_second = triangle(r#","TEXCOORD_0":1,"TEXCOORD_1":2"#, material);
    let (_, said) = compiled("Model { file a.gltf subdivide 2 }", &with_second);
    assert_eq!(
        said,
        ["`a.gltf`: its second texture coordinates and tangents are left out where it is subdivided"]
    );
    let (_, said) = compiled("Model { file a.gltf creaseAngle 20 }", &content);
    assert!(said.iter().any(|s| s.contains("without `subdivide`")), "{said:?}");
}
