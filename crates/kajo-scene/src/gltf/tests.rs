//! What the glTF reader makes of files good and bad.

use super::*;
use crate::assets::MemoryAssets;
use crate::tri_mesh::Corners;
use kajo_math::DVec3;
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Numbers one after the other, each list beginning at a multiple of four bytes.
#[derive(Default)]
pub(super) struct Bin {
    pub bytes: Vec<u8>,
    pub views: Vec<String>,
}

impl Bin {
    /// Adds a view; answers its number.
    pub fn add(&mut self, content: impl IntoIterator<Item = u8>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(content);
        let len = self.bytes.len() - start;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(format!("{{\"buffer\":0,\"byteOffset\":{start},\"byteLength\":{len}}}"));
        self.views.len() - 1
    }

    pub fn floats(&mut self, floats: &[f32]) -> usize {
        self.add(floats.iter().flat_map(|x| x.to_le_bytes()))
    }
}

/// The buffer and the accessors of a square of two triangles: positions, normals, texture coordinates, indices.
pub(super) fn square() -> (Bin, Vec<String>) {
    let mut bin = Bin::default();
    bin.floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]);
    bin.floats(&[0., 0., 1.].repeat(4));
    bin.floats(&[0., 0., 1., 0., 1., 1., 0., 1.]);
    bin.add([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let accessor = |view: usize, kind: u32, count: usize, of: &str| {
        format!("{{\"bufferView\":{view},\"componentType\":{kind},\"count\":{count},\"type\":\"{of}\"}}")
    };
    let accessors = vec![
        accessor(0, 5126, 4, "VEC3"),
        accessor(1, 5126, 4, "VEC3"),
        accessor(2, 5126, 4, "VEC2"),
        accessor(3, 5123, 6, "SCALAR"),
    ];
    (bin, accessors)
}

const MESH: &str = r#""meshes":[{"name":"square","primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},
    "indices":3,"material":0}]}],"materials":[{"name":"red","pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,0.25],
    "metallicFactor":0},"alphaMode":"BLEND"}]"#;

pub(super) fn json(bin: &Bin, accessors: &[String], buffer: &str, rest: &str) -> String {
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{{{buffer}\"byteLength\":{}}}],\"bufferViews\":[{}],\
         \"accessors\":[{}],{rest}}}",
        bin.bytes.len(),
        bin.views.join(","),
        accessors.join(",")
    )
}

pub(super) fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut chunk = json.as_bytes().to_vec();
    chunk.resize(chunk.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((12 + 8 + chunk.len() as u32 + 8 + bin.len() as u32).to_le_bytes());
    for (kind, content) in [(b"JSON", &chunk[..]), (b"BIN\0", bin)] {
        file.extend((content.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(content);
    }
    file
}

fn read(bytes: &[u8], assets: &MemoryAssets) -> Result<Model, String> {
    let assets = assets.clone().with("folder/m.gltf", bytes);
    let file = assets.open("folder/m.gltf", "").unwrap();
    read_gltf(file, &assets, &Limits::default()).map_err(|error| error.to_string())
}

/// The square as a GLB with this after its accessors.
fn read_square(rest: &str) -> Result<Model, String> {
    let (bin, accessors) = square();
    read(&glb(&json(&bin, &accessors, "", rest), &bin.bytes), &MemoryAssets::new())
}

#[test]
fn one_mesh_of_many_nodes_is_read_once() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = format!(
        r#""scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"translation":[1,2,3],"children":[1,2,3]}},
        {{"mesh":0,"name":"turned","rotation":[0,0,{half},{half}]}},{{"mesh":0,"scale":[2,2,2]}},
        {{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1],"mesh":0}},{{"mesh":0,"name":"in no scene"}}]"#
    );
    let model = read_square(&format!("{MESH},{nodes}")).unwrap();
    assert_eq!((model.meshes.len(), model.instances.len()), (1, 3));
    let part = &model.meshes[0][0];
    assert_eq!(part.mesh.faces, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(part.mesh.positions[2], [1.0, 1.0, 0.0]);
    assert_eq!(part.mesh.face_normals, Corners::Vertices);
    assert_eq!(part.mesh.uvs, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]], "turned upright");
    let material = &model.materials[part.material.unwrap()];
    assert_eq!((material.base_color, material.opacity, material.metallic), ([1.0, 0.5, 0.0], 0.25, 0.0));
    let corner = |i: usize| model.instances[i].model_from_mesh.transform_point3(DVec3::X);
    for (i, expected) in [[1.0, 3.0, 3.0], [3.0, 2.0, 3.0], [7.0, 2.0, 3.0]].into_iter().enumerate() {
        assert!(corner(i).distance(DVec3::from(expected)) < 1e-12, "{i}: {}", corner(i));
    }
    let names: Vec<_> = model.instances.iter().map(|i| i.name.as_deref()).collect();
    assert_eq!(names, [Some("turned"), Some("square"), Some("square")]);
    assert!(model.left_out.is_empty());
}

#[test]
fn buffers_lie_within_or_beside() {
    let (bin, accessors) = square();
    let rest = format!("{MESH},\"nodes\":[{{\"mesh\":0}}]");
    let within = read_square(&rest).unwrap();
    let beside = json(&bin, &accessors, "\"uri\":\"my%20data.bin\",", &rest);
    let assets = MemoryAssets::new().with("folder/my data.bin", &bin.bytes);
    let beside = read(beside.as_bytes(), &assets).unwrap();
    let digits = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bin.bytes.chunks(3) {
        let bits = three.iter().enumerate().fold(0u32, |bits, (i, &b)| bits | u32::from(b) << (16 - 8 * i));
        text.extend((0..=three.len()).map(|i| char::from(digits[(bits >> (18 - 6 * i)) as usize & 63])));
    }
    let data =
        json(&bin, &accessors, &format!("\"uri\":\"data:application/octet-stream;base64,{text}\","), &rest);
    let embedded = read(data.as_bytes(), &MemoryAssets::new()).unwrap();
    for other in [beside, embedded] {
        assert_eq!(other.meshes[0][0].mesh, within.meshes[0][0].mesh);
    }
}

#[test]
fn a_file_of_several_buffers_is_read_once() {
    let (bin, accessors) = square();
    let buffer = format!("\"uri\":\"a.bin\",\"byteLength\":{}}},{{", bin.bytes.len());
    let text =
        json(&bin, &accessors, &format!("{buffer}\"uri\":\"./a.bin\","), &format!("{MESH},\"nodes\":[]"));
    let assets = MemoryAssets::new().with("m.gltf", &text).with("a.bin", &bin.bytes);
    let read = |model_bytes: u64| {
        let file = assets.open("m.gltf", "").unwrap();
        read_gltf(file, &assets, &Limits { model_bytes, ..Limits::default() })
            .map_err(|error| error.to_string())
    };
    let whole = (text.len() + bin.bytes.len()) as u64;
    assert!(read(whole).is_ok());
    assert!(read(whole - 1).unwrap_err().contains("a.bin"));
    assert!(read(text.len() as u64 - 1).unwrap_err().contains("m.gltf"));
}

#[test]
fn strips_fans_and_bare_vertices() {
    let part = |mode: u32, indices: &str| {
        let mesh = format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}{indices},"mode":{mode}}}]}}]"#
        );
        read_square(&format!("{mesh},\"nodes\":[{{\"mesh\":0}}]")).unwrap()
    };
    let faces = |mode, indices| part(mode, indices).meshes[0][0].mesh.faces.clone();
    assert_eq!(faces(5, ""), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(faces(6, ""), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(faces(4, ""), [[0, 1, 2]]);
    assert_eq!(faces(5, ",\"indices\":3"), [[0, 1, 2], [2, 1, 0], [2, 0, 2], [2, 0, 3]]);
    let beads = |mode, indices| {
        let model = part(mode, indices);
        assert!(model.meshes[0][0].mesh.faces.is_empty() && model.left_out.is_empty());
        (model.meshes[0][0].points.clone(), model.meshes[0][0].segments.clone())
    };
    assert_eq!(beads(0, ""), (vec![0, 1, 2, 3], vec![]));
    assert_eq!(beads(1, ""), (vec![], vec![[0, 1], [2, 3]]));
    assert_eq!(beads(2, ""), (vec![], vec![[0, 1], [1, 2], [2, 3], [3, 0]]));
    assert_eq!(beads(3, ",\"indices\":3"), (vec![], vec![[0, 1], [1, 2], [2, 0], [0, 2], [2, 3]]));
    assert_eq!(part(9, "").left_out, ["left out: 1 parts of an unknown kind"]);
}

#[test]
fn parts_keep_only_the_vertices_they_use() {
    let (mut bin, mut accessors) = square();
    let view = bin.add([3u8, 1, 0]);
    accessors
        .push(format!("{{\"bufferView\":{view},\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}}"));
    let rest =
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":4}]}],"nodes":[{"mesh":0}]"#;
    let model = read(&glb(&json(&bin, &accessors, "", rest), &bin.bytes), &MemoryAssets::new()).unwrap();
    let mesh = &model.meshes[0][0].mesh;
    assert_eq!((mesh.positions.len(), &mesh.faces[..]), (3, &[[2, 1, 0]][..]));
    assert_eq!(mesh.positions[2], [0.0, 1.0, 0.0]);
}

#[test]
fn quantised_and_sparse_numbers_are_read() {
    let mut bin = Bin::default();
    let shorts =
        bin.add([0i16, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0].iter().flat_map(|x| x.to_le_bytes()));
    let places = bin.add([1u8]);
    let values = bin.floats(&[7.0, 8.0, 9.0]);
    bin.views[shorts] = bin.views[shorts].replace('}', ",\"byteStride\":8}");
    let accessors = vec![
        format!(
            r#"{{"bufferView":{shorts},"componentType":5122,"normalized":true,"count":3,"type":"VEC3"}}"#
        ),
        format!(
            r#"{{"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":1,
            "indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
        ),
    ];
    let rest = r#""extensionsRequired":["KHR_mesh_quantization"],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1}}]}]"#;
    let model = read(&glb(&json(&bin, &accessors, "", rest), &bin.bytes), &MemoryAssets::new()).unwrap();
    let mesh = &model.meshes[0][0].mesh;
    assert_eq!(mesh.positions, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
    assert_eq!(mesh.normals, [[0.0; 3], [7.0, 8.0, 9.0], [0.0; 3]]);
}

#[test]
fn instances_of_the_extension_are_placed() {
    let (mut bin, mut accessors) = square();
    let view = bin.floats(&[1., 0., 0., 2., 0., 0., 3., 0., 0.]);
    accessors.push(format!("{{\"bufferView\":{view},\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}}"));
    let instancing = |attributes: &str| {
        let node = format!(
            r#"{{"mesh":0,"translation":[0,5,0],"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{attributes}}}}}}}"#
        );
        let text = json(&bin, &accessors, "", &format!("{MESH},\"nodes\":[{node}]"));
        read(&glb(&text, &bin.bytes), &MemoryAssets::new())
    };
    let model = instancing("{\"TRANSLATION\":4}").unwrap();
    let places: Vec<DVec3> = model.instances.iter().map(|i| i.model_from_mesh.translation).collect();
    assert_eq!(places, [1.0, 2.0, 3.0].map(|x| DVec3::new(x, 5.0, 0.0)));
    assert_eq!(instancing("{}").unwrap().instances.len(), 1);
    assert!(instancing("{\"TRANSLATION\":4,\"SCALE\":0}").unwrap_err().contains("differ in number"));
}

#[test]
fn what_is_left_out_is_said() {
    let model = read_square(&format!(r#"{MESH},"nodes":[{{"mesh":0}}],"animations":[{{}}]"#));
    assert_eq!(model.unwrap().left_out, ["left out: 1 animations"]);
    let said = |more: &str| material(more).unwrap().left_out;
    assert!(said("\"occlusionTexture\":{\"index\":0}").is_empty(), "light that is followed needs none");
    for texture in [
        r#""normalTexture":{"index":0},"occlusionTexture":{"index":0,"texCoord":9},"emissiveTexture":{"index":1,"texCoord":1},
            "extensions":{"KHR_materials_clearcoat":{"clearcoatTexture":{"index":0,"texCoord":2}}}"#,
        r#""extensions":{"KHR_materials_anisotropy":{"anisotropyTexture":{"index":0}}}"#,
    ] {
        assert_eq!(said(texture), ["left out: 1 materials with textures that are not shown"], "{texture}");
    }
    let rare = r#""extensions":{"KHR_materials_iridescence":{},"KHR_materials_ior":{"ior":1.2}}"#;
    assert_eq!(said(rare), ["left out: `KHR_materials_iridescence` of 1 materials"]);
    assert!(said(r#""extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}"#).is_empty());
}

/// Picture `number` as it is.
fn as_it_is(number: usize) -> PictureUse {
    let (wrap, nearest, set) = ([PictureWrap::Repeat; 2], false, CoordinateSet::First);
    PictureUse { picture: number, wrap, nearest, set, repeat: [1.0; 2], cross: [0.0; 2], offset: [0.0; 2] }
}

/// The square with three pictures, and this of its material instead of its alpha mode.
fn material(more: &str) -> Result<Model, String> {
    let mesh = MESH.replace("\"alphaMode\":\"BLEND\"", more);
    let textures = r#""textures":[{"source":0},{"source":1},{"source":2}],
        "images":[{"uri":"a.png"},{"uri":"b.png"},{"uri":"c.png"}]"#;
    read_square(&format!("{mesh},\"nodes\":[{{\"mesh\":0}}],{textures}"))
}

/// That material with these extensions.
fn extended(extensions: &str) -> ModelMaterial {
    let model = material(&format!("\"extensions\":{{{extensions}}}")).unwrap();
    assert!(model.left_out.is_empty(), "{:?}", model.left_out);
    let used = model.materials[0].pictures().map(|p| p.picture).collect::<BTreeSet<_>>();
    let found = (0..3).filter(|&i| model.pictures[i].is_some()).collect();
    assert_eq!(used, found, "pictures are read where they are shown");
    model.materials[0].clone()
}

#[test]
fn extensions_of_materials_are_read() {
    let without = extended("");
    assert_eq!((without.eta, without.specular.color, without.body), (1.5, [1.0; 3], None));
    let amount = |value, picture: Option<usize>| ModelAmount { value, picture: picture.map(as_it_is) };
    assert_eq!((without.transmission, without.coat), (amount(0.0, None), amount(0.0, None)));

    let glass = extended(
        r#""KHR_materials_transmission":{"transmissionFactor":0.75,"transmissionTexture":{"index":2}},
        "KHR_materials_ior":{"ior":1.33},
        "KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":2,"attenuationColor":[1,0.5,0]}"#,
    );
    assert_eq!((glass.eta, glass.transmission), (1.33, amount(0.75, Some(2))));
    let [r, g, b] = glass.body.unwrap();
    assert!(r == 0.0 && (g - 0.5 * 2f32.ln()).abs() < 1e-6 && b.is_finite() && b > 5.0, "{r} {g} {b}");
    let clear = extended(r#""KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.5,0.5,0.5]}"#);
    assert_eq!(clear.body, Some([0.0; 3]), "without a distance there is no absorption");
    let pane = extended(r#""KHR_materials_volume":{"attenuationDistance":1,"attenuationColor":[0,0,0]}"#);
    assert_eq!(pane.body, None);
    for (ior, expected) in [("0", 1.5), ("-3", 1.5), ("1", 1.0), ("99", 4.0)] {
        assert_eq!(extended(&format!(r#""KHR_materials_ior":{{"ior":{ior}}}"#)).eta, expected);
    }

    let coated = extended(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":2,"clearcoatTexture":{"index":0},
        "clearcoatRoughnessFactor":0.3,"clearcoatRoughnessTexture":{"index":1}},
        "KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[1,0.5,4],"specularColorTexture":{"index":2}},
        "KHR_materials_anisotropy":{"anisotropyStrength":0.6,"anisotropyRotation":1.5707964}"#,
    );
    assert_eq!((coated.coat, coated.coat_roughness), (amount(1.0, Some(0)), amount(0.3, Some(1))));
    assert_eq!(coated.specular, ModelTint { color: [1.0, 0.5, 4.0], picture: Some(as_it_is(2)) });
    assert_eq!(coated.gloss, ModelAmount { value: 0.5, picture: None });
    assert_eq!(coated.anisotropy, (0.6, 0.25));
    let velvet = extended(
        r#""KHR_materials_sheen":{"sheenColorFactor":[0.5,0.25,0],"sheenColorTexture":{"index":1},
        "sheenRoughnessFactor":0.4,"sheenRoughnessTexture":{"index":1}}"#,
    );
    assert_eq!(velvet.sheen, ModelTint { color: [0.5, 0.25, 0.0], picture: Some(as_it_is(1)) });
    assert_eq!(velvet.sheen_roughness, amount(0.4, Some(1)));
}

#[test]
fn materials_of_the_older_model_are_put_into_the_newer_terms() {
    let older = |more: &str| extended(&format!("\"KHR_materials_pbrSpecularGlossiness\":{{{more}}}"));
    let paint = older(
        r#""diffuseFactor":[0.1,0.2,0.3,0.5],"diffuseTexture":{"index":1},"specularFactor":[0.04,0.02,0.04],
        "glossinessFactor":0.75"#,
    );
    assert_eq!((paint.base_color, paint.picture, paint.opacity), ([0.1, 0.2, 0.3], Some(as_it_is(1)), 0.5));
    assert_eq!((paint.metallic, paint.roughness, paint.specular.color), (0.0, 0.25, [1.0, 0.5, 1.0]));
    assert!((paint.eta - 1.5).abs() < 1e-5, "{}", paint.eta);
    let gold = older(r#""diffuseFactor":[0,0,0,1],"specularFactor":[1,0.8,0.3]"#);
    assert_eq!((gold.metallic, gold.base_color, gold.roughness), (1.0, [1.0, 0.8, 0.3], 0.0));
    let chalk = older(r#""specularFactor":[0,0,0],"glossinessFactor":0"#);
    assert_eq!((chalk.eta, chalk.specular.color, chalk.roughness), (1.0, [0.0; 3], 1.0));
}

#[test]
fn pictures_are_moved_and_scaled() {
    let transform =
        r#"{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.25,0.5],"scale":[2,3]}}}"#;
    let model = material(&format!("\"normalTexture\":{transform}")).unwrap();
    let (shown, _) = model.materials[0].normals.unwrap();
    assert_eq!((shown.repeat, shown.offset), ([2.0, 3.0], [0.25, -2.5]));
    // The same texel as by the rule of the extension, where the second coordinate points down.
    let (u, v) = (0.4, 0.3);
    let down = 3.0 * (1.0 - v) + 0.5;
    let up = shown.repeat[1] * v + shown.offset[1];
    assert!((1.0f32 - down - up).abs() < 1e-6 && shown.repeat[0] * u + shown.offset[0] == 2.0 * u + 0.25);

    let turned = transform.replace("\"offset\"", "\"rotation\":0.5,\"offset\"");
    let model = material(&format!("\"normalTexture\":{turned}")).unwrap();
    let (shown, _) = model.materials[0].normals.unwrap();
    // Counter-clockwise as the picture is seen: T R S with the rotation (c s, -s c) where the second coordinate points down.
    let (sin, cos) = 0.5f32.sin_cos();
    let (across, down) = (2.0 * u, 3.0 * (1.0 - v));
    let expected = [cos * across + sin * down + 0.25, 1.0 - (cos * down - sin * across + 0.5)];
    let found = [
        shown.repeat[0] * u + shown.cross[0] * v + shown.offset[0],
        shown.repeat[1] * v + shown.cross[1] * u + shown.offset[1],
    ];
    assert!(
        (found[0] - expected[0]).abs() < 1e-5 && (found[1] - expected[1]).abs() < 1e-5,
        "{found:?} {expected:?}"
    );
}

/// The square with a picture for its colour, and these images.
fn painted(texture: &str, images: &str) -> Result<Model, String> {
    let base = format!("\"baseColorTexture\":{{{texture}}},\"metallicFactor\"");
    let mesh = MESH.replace("\"metallicFactor\"", &base);
    let samplers = r#""textures":[{"source":1,"sampler":0},{"source":7},{}],
        "samplers":[{"wrapS":33648,"wrapT":33071,"magFilter":9728}]"#;
    read_square(&format!("{mesh},\"nodes\":[{{\"mesh\":0}}],{samplers},\"images\":[{images}]"))
}

#[test]
fn pictures_of_colours_are_found() {
    let unused = r#"{"uri":"unused.png"}"#;
    let model = painted("\"index\":0", &format!(r#"{unused},{{"uri":"my%20skin.png"}}"#)).unwrap();
    let wrap = [PictureWrap::Mirror, PictureWrap::Clamp];
    let shown = PictureUse { wrap, nearest: true, ..as_it_is(1) };
    assert!(model.materials.iter().any(|material| material.picture == Some(shown)));
    assert_eq!(model.pictures, [None, Some(PictureSource::File("my skin.png".to_owned()))]);
    let data = r#"{"uri":"data:image/png;base64,Zm9v"}"#;
    let model = painted("\"index\":0", &format!("{unused},{data}")).unwrap();
    assert_eq!(model.pictures[1], Some(PictureSource::Bytes(b"foo".to_vec())));
    let view = r#"{"bufferView":0,"mimeType":"image/png"}"#;
    let model = painted("\"index\":0", &format!("{unused},{view}")).unwrap();
    assert!(matches!(&model.pictures[1], Some(PictureSource::Bytes(bytes)) if !bytes.is_empty()));
}

#[test]
fn a_picture_within_is_read_alone() {
    let images = r#"{"uri":"other.png"},{"uri":"data:image/png;base64,Zm9v"},{"bufferView":0}"#;
    let (bin, accessors) = square();
    let rest = format!("{MESH},\"nodes\":[{{\"mesh\":0}}],\"images\":[{images}]");
    let whole = glb(&json(&bin, &accessors, "", &rest), &bin.bytes);
    let read = |number| {
        let assets = MemoryAssets::new().with("a.glb", &*whole);
        let file = assets.open("a.glb", "").unwrap();
        read_gltf_picture(file, &MemoryAssets::new(), &Limits::default(), number)
            .map_err(|error| error.to_string())
    };
    assert_eq!(read(1).unwrap(), b"foo");
    // The view of the positions.
    assert_eq!(read(2).unwrap(), bin.bytes[..48]);
    assert!(read(0).unwrap_err().contains("images[0]: it is in a file of its own"));
    assert!(read(3).unwrap_err().contains("images[3]: there is no such picture"));
}

#[test]
fn pictures_of_normals_and_roughness_are_found() {
    let mesh = MESH.replace(
        "\"pbrMetallicRoughness\":{",
        r#""normalTexture":{"index":0,"scale":0.5},"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":1},"#,
    );
    let textures = r#""textures":[{"source":1},{"source":0}],"images":[{"uri":"mr.png"},{"uri":"n.png"}]"#;
    let model = read_square(&format!("{mesh},\"nodes\":[{{\"mesh\":0}}],{textures}")).unwrap();
    let material = &model.materials[0];
    assert_eq!(material.normals, Some((as_it_is(1), 0.5)));
    assert_eq!(material.metal_and_roughness, Some(as_it_is(0)));
    assert!(model.pictures.iter().all(Option::is_some) && model.left_out.is_empty(), "{:?}", model.left_out);
}

#[test]
fn light_and_cover_are_read() {
    let material = |more: &str| {
        let mesh = MESH.replace("\"alphaMode\":\"BLEND\"", more);
        let textures = r#""textures":[{"source":0}],"images":[{"uri":"bright.png"}]"#;
        let model = read_square(&format!("{mesh},\"nodes\":[{{\"mesh\":0}}],{textures}")).unwrap();
        assert!(model.left_out.is_empty(), "{:?}", model.left_out);
        (model.materials[0].clone(), model.pictures)
    };
    let (plain, _) = material("\"emissiveFactor\":[0.5,0,-1]");
    assert_eq!((plain.emissive, plain.emissive_picture, plain.two_sided), ([0.5, 0.0, 0.0], None, false));
    assert_eq!((plain.cover, plain.opacity), (ModelCover::Everything, 0.25));
    let (strong, pictures) = material(
        r#""emissiveFactor":[0.5,0.25,1],"emissiveTexture":{"index":0},"doubleSided":true,
        "extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}}"#,
    );
    assert_eq!((strong.emissive, strong.emissive_picture), ([4.0, 2.0, 8.0], Some(as_it_is(0))));
    assert_eq!(
        (strong.two_sided, pictures),
        (true, vec![Some(PictureSource::File("bright.png".to_owned()))])
    );
    assert_eq!(material("\"alphaMode\":\"BLEND\"").0.cover, ModelCover::Share);
    assert_eq!(material("\"alphaMode\":\"MASK\"").0.cover, ModelCover::FromOn(0.5));
    assert_eq!(material("\"alphaMode\":\"MASK\",\"alphaCutoff\":0.1").0.cover, ModelCover::FromOn(0.1));
}

#[test]
fn pictures_that_are_nowhere_are_told_or_left_out() {
    for texture in ["\"index\":1", "\"index\":2", "\"index\":99"] {
        let model = painted(texture, "").unwrap();
        assert!(model.pictures.is_empty(), "{texture}");
    }
    for (image, expected) in [
        ("{}", "images[1]: it has neither a `uri` nor a `bufferView`"),
        (r#"{"bufferView":99}"#, "images[1]: there is no bufferViews[99]"),
        (r#"{"uri":"data:image/png,x"}"#, "images[1]: its `data:` uri is not in base64"),
        (r#"{"uri":"%ff"}"#, "images[1]: its name is not UTF-8"),
    ] {
        let said = painted("\"index\":0", &format!("{{}},{image}")).unwrap_err();
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn mistakes_are_told_with_their_place() {
    let mesh = |attributes: &str| {
        format!(
            r#""meshes":[{{"primitives":[{{"attributes":{attributes},"indices":3}}]}}],"nodes":[{{"mesh":0}}]"#
        )
    };
    for (rest, said) in [
        ("\"nodes\":[{\"mesh\":7}]".to_owned(), "nodes[0]: there is no meshes[7]"),
        (
            "\"nodes\":[{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]".to_owned(),
            "nodes[0] hangs on two places",
        ),
        ("\"nodes\":[{},{\"children\":[0]},{\"children\":[0]}]".to_owned(), "nodes[0] hangs on two places"),
        ("\"nodes\":[{\"children\":[9]}]".to_owned(), "there is no nodes[9]"),
        ("\"scene\":3".to_owned(), "there is no scenes[3]"),
        ("\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]".to_owned(), "KHR_draco_mesh_compression"),
        (mesh("{\"POSITION\":9}"), "meshes[0]: primitives[0]: there is no accessors[9]"),
        (mesh("{\"POSITION\":2}"), "accessors[2]: expected 3 numbers an element, found `VEC2`"),
        (mesh("{\"POSITION\":0,\"NORMAL\":3}"), "accessors[3]: expected 3 numbers"),
        ("\"nodes\":3".to_owned(), "in the JSON: invalid type: integer `3`"),
        ("\"nodes\":[".to_owned(), "in the JSON: "),
    ] {
        let error = read_square(&rest).unwrap_err();
        assert!(error.starts_with("folder/m.gltf: ") && error.contains(said), "{rest}\n{error}");
    }
    let with = |change: &dyn Fn(String) -> String| {
        let (bin, accessors) = square();
        let rest = format!("{MESH},\"nodes\":[{{\"mesh\":0}}]");
        read(&glb(&change(json(&bin, &accessors, "", &rest)), &bin.bytes), &MemoryAssets::new()).unwrap_err()
    };
    for (from, to, said) in [
        (
            "\"count\":4",
            "\"count\":4000000000",
            "accessors[0]: 4000000000 elements do not fit into bufferViews[0]",
        ),
        ("\"count\":6", "\"count\":18446744073709551615", "do not fit into bufferViews[3]"),
        (
            "\"byteOffset\":0",
            "\"byteOffset\":18446744073709551615",
            "bufferViews[0] reaches beyond its buffer",
        ),
        ("\"bufferView\":3", "\"bufferView\":9", "there is no bufferViews[9]"),
        (
            "\"byteLength\":48}",
            "\"byteLength\":48,\"byteStride\":8}",
            "the elements of bufferViews[0] overlap",
        ),
        ("5123", "5124", "there is no type of number 5124"),
        ("\"byteLength\":140", "\"byteLength\":141", "buffers[0]: it should have 141 bytes and has 140"),
        ("\"material\":0", "\"material\":1", "there is no materials[1]"),
        (
            "\"2.0\"",
            "\"1.0\"",
            "this is glTF 1.0, an older format of another structure; version 2 is read: `gltf-pipeline",
        ),
        ("\"2.0\"", "\"3.1\"", "this is glTF 3.1; version 2 is read"),
        ("\"version\":\"2.0\"", "", "it does not say which version of glTF it is"),
        (
            "\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"",
            "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"",
            "primitives[0]",
        ),
    ] {
        let error = with(&|text| text.replacen(from, to, 1));
        assert!(error.contains(said), "{from} -> {to}\n{error}");
    }
    let (bin, accessors) = square();
    let outside = json(&bin, &accessors, "\"uri\":\"../../../secret\",", MESH);
    assert!(read(outside.as_bytes(), &MemoryAssets::new()).unwrap_err().contains("outside"));
    for (bytes, said) in [
        (
            &b"glTF\x01\0\0\0"[..],
            "byte 4: this is glTF 1.0, an older format of another structure; version 2 is read",
        ),
        (b"glTF\x03\0\0\0", "byte 4: this is a GLB file of version 3; version 2 is read"),
        (b"glTF", "byte 4: this is no GLB file: it ends after four bytes"),
        (
            br#"{"meshes":{"a":{"primitives":[]}},"asset":{"version":"1.0"}}"#,
            "this is glTF 1.0, an older format",
        ),
        (br#"{"nodes":{"a":{}},"scene":"a"}"#, "this is glTF 1.0, an older format"),
        (b"glTF\x02\0\0\0\0\0\0\0\xff\xff\xff\xffJSON", "byte 12: the file ends in its first chunk"),
        (b"glTF\x02\0\0\0\0\0\0\0\0\0\0\0BIN\0", "byte 12: the first chunk is not JSON"),
        (b"", "in the JSON: EOF"),
    ] {
        let error = read(bytes, &MemoryAssets::new()).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn saying_the_same_thing_over_and_over_takes_no_memory() {
    let (mut bin, mut accessors) = square();
    let view = bin.add(vec![0u8; 300_000]);
    accessors.push(format!(
        "{{\"bufferView\":{view},\"componentType\":5121,\"count\":300000,\"type\":\"SCALAR\"}}"
    ));
    let primitive = r#"{"attributes":{"POSITION":0},"indices":4}"#;
    let rest =
        format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}]"#, [primitive; 1000].join(","));
    let model = read(&glb(&json(&bin, &accessors, "", &rest), &bin.bytes), &MemoryAssets::new());
    let error = model.map(|_| "accepted").unwrap_err();
    assert!(error.contains("out of all proportion"), "{error}");
}

/// A short file of many empty things is refused before it is read, and nothing stays taken.
#[test]
fn what_a_model_is_in_memory_is_taken_from_the_budget() {
    let many = |head: &str, each: &str, count: usize, tail: &str| {
        format!(r#"{{"asset":{{"version":"2.0"}},{head}{}{tail}}}"#, vec![each; count].join(","))
    };
    let read = |text: &str, bytes: u64| {
        let limits = Limits { memory: crate::MemoryBudget::new(bytes), ..Limits::default() };
        let assets = MemoryAssets::new().with("m.gltf", text);
        let model = read_gltf(assets.open("m.gltf", "").unwrap(), &assets, &limits);
        assert_eq!(limits.memory.used(), 0);
        (model, limits.memory.was_exceeded())
    };
    let nodes = many(r#""nodes":["#, "{}", 30_000, "]");
    let primitives =
        many(r#""nodes":[{"mesh":0}],"meshes":[{"primitives":["#, r#"{"attributes":{}}"#, 30_000, "]}]");
    let materials = many(r#""materials":["#, "{}", 30_000, "]");
    let texts = many(r#""extensionsUsed":["a"],"extensionsRequired":["#, r#""""#, 200_000, "]");
    assert!(matches!(read(&texts, 9_000_000).0, Err(MeshFileError::Memory { .. })));
    // Cut short, or with a second list, it is malformed, and nothing of it is kept until that is found.
    let limits = Limits { materials: 10, ..Limits::default() };
    let cut = materials[..materials.len() - 2].to_owned();
    for text in [cut, materials.replace("]}", r#"],"materials":[]}"#)] {
        let assets = MemoryAssets::new().with("m.gltf", &text);
        let said = read_gltf(assets.open("m.gltf", "").unwrap(), &assets, &limits).unwrap_err().to_string();
        assert!(said.starts_with("m.gltf: in the JSON: "), "{said}");
    }
    for text in [&nodes, &primitives, &materials] {
        let (refused, exceeded) = read(text, 10_000_000);
        assert!(
            matches!(refused, Err(MeshFileError::Memory { .. })) && exceeded,
            "{:.60}: {refused:?}",
            text
        );
        assert!(matches!(read(text, 300_000_000), (Ok(_), false)), "{text:.60}");
    }
    let limits = Limits { materials: 1000, ..Limits::default() };
    let assets = MemoryAssets::new().with("m.gltf", &materials);
    let refused = read_gltf(assets.open("m.gltf", "").unwrap(), &assets, &limits).unwrap_err();
    assert_eq!(refused.to_string(), "m.gltf: the file has more than 1000 materials");

    let (mut bin, mut accessors) = square();
    let indices: Vec<u8> = (0..1_200_000u32).map(|i| (i % 4) as u8).collect();
    let view = bin.add(indices);
    accessors.push(format!(
        "{{\"bufferView\":{view},\"componentType\":5121,\"count\":1200000,\"type\":\"SCALAR\"}}"
    ));
    let rest =
        r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":4}]}]"#;
    let file = glb(&json(&bin, &accessors, "", rest), &bin.bytes);
    let limits = |bytes| Limits { memory: crate::MemoryBudget::new(bytes), ..Limits::default() };
    let assets = MemoryAssets::new().with("m.glb", &file);
    let read = |limits: &Limits| read_gltf(assets.open("m.glb", "").unwrap(), &assets, limits);
    assert!(matches!(read(&limits(8_000_000)), Err(MeshFileError::Memory { .. })));
    assert!(read(&limits(40_000_000)).is_ok());
}

proptest! {
    /// Whatever is cut off or changed, there is an error or a model whose indices are in range.
    #[test]
    fn broken_files_end_in_errors(cut in 0usize..2000, flips in prop::collection::vec((0usize..2000, any::<u8>()), 0..4)) {
        let (bin, accessors) = square();
        let mut bytes = glb(&json(&bin, &accessors, "", &format!("{MESH},\"nodes\":[{{\"mesh\":0}}]")), &bin.bytes);
        for (at, byte) in flips {
            let at = at % bytes.len();
            bytes[at] ^= byte;
        }
        bytes.truncate(bytes.len() - cut.min(bytes.len()) * usize::from(cut % 4 == 0));
        if let Ok(model) = read(&bytes, &MemoryAssets::new()) {
            for instance in &model.instances {
                for part in &model.meshes[instance.mesh] {
                    prop_assert!(part.mesh.faces.iter().flatten().all(|&v| (v as usize) < part.mesh.positions.len()));
                    prop_assert!(part.material.is_none_or(|m| m < model.materials.len()));
                }
            }
        }
    }
}

/// The square with these attributes besides its own, whose accessors begin at 4, and this of the file.
fn with_attributes(
    attributes: &str,
    add: impl FnOnce(&mut Bin) -> Vec<String>,
    rest: &str,
) -> Result<Model, String> {
    let (mut bin, mut accessors) = square();
    accessors.extend(add(&mut bin));
    let mesh = format!(
        r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2{attributes}}},"indices":3,"material":0}}]}}]"#
    );
    read(&glb(&json(&bin, &accessors, "", &format!("{mesh},{rest}")), &bin.bytes), &MemoryAssets::new())
}

pub(super) fn accessor(view: usize, kind: u32, count: usize, of: &str) -> String {
    format!(
        "{{\"bufferView\":{view},\"componentType\":{kind},\"count\":{count},\"type\":\"{of}\",\"normalized\":false}}"
    )
}

#[test]
fn vertices_bring_colours_second_coordinates_and_tangents() {
    let rest = r#""nodes":[{"mesh":0}],"images":[{"uri":"a.png"}],"textures":[{"source":0}],
        "materials":[{"normalTexture":{"index":0},"emissiveTexture":{"index":0,"texCoord":3}}]"#;
    let attributes = r#","COLOR_0":4,"TEXCOORD_3":5,"TANGENT":6"#;
    let add = |bin: &mut Bin| {
        let colors = bin.add([255u8, 0, 51, 255].repeat(4));
        let uvs = bin.floats(&[0.25, 0.5].repeat(4));
        let tangents = bin.floats(&[1.0, 0.0, 0.0, -1.0].repeat(4));
        vec![
            accessor(colors, 5121, 4, "VEC4").replace("false", "true"),
            accessor(uvs, 5126, 4, "VEC2"),
            accessor(tangents, 5126, 4, "VEC4"),
        ]
    };
    let model = with_attributes(attributes, add, rest).unwrap();
    let part = &model.meshes[0][0];
    assert_eq!(part.mesh.colors, [[1.0, 0.0, 0.2, 1.0]; 4]);
    assert_eq!(part.second_uvs, [[0.25, 0.5]; 4]);
    assert_eq!(part.tangents, [[1.0, 0.0, 0.0, -1.0]; 4]);
    let material = &model.materials[0];
    assert_eq!(material.vertex_colors, VertexColors::Color);
    assert_eq!(material.normals.unwrap().0.set, CoordinateSet::First);
    assert_eq!(material.emissive_picture.unwrap().set, CoordinateSet::Second);
    assert!(model.left_out.is_empty(), "{:?}", model.left_out);

    // What no picture asks for is not kept; a part without a material gets the one of the standard for its colours.
    let bare = r#""nodes":[{"mesh":0}],"materials":[{}]"#;
    let model = with_attributes(attributes, add, bare).unwrap();
    let part = &model.meshes[0][0];
    assert!(part.second_uvs.is_empty() && part.tangents.is_empty());
    let colors = |bin: &mut Bin| vec![accessor(bin.floats(&[0.5, 2.0, f32::NAN].repeat(4)), 5126, 4, "VEC3")];
    let plain =
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":4}}]}],"nodes":[{"mesh":0}]"#;
    let (mut bin, mut accessors) = square();
    accessors.extend(colors(&mut bin));
    let model = read(&glb(&json(&bin, &accessors, "", plain), &bin.bytes), &MemoryAssets::new()).unwrap();
    let part = &model.meshes[0][0];
    assert_eq!((part.mesh.colors[0], part.material), ([0.5, 1.0, 0.0, 1.0], Some(0)));
    assert_eq!((model.materials[0].metallic, model.materials[0].vertex_colors), (1.0, VertexColors::Color));
    let white = |bin: &mut Bin| vec![accessor(bin.floats(&[1.0; 12]), 5126, 4, "VEC3")];
    let model = with_attributes(r#","COLOR_0":4"#, white, bare).unwrap();
    assert!(
        model.meshes[0][0].mesh.colors.is_empty() && model.materials[0].vertex_colors == VertexColors::None
    );
    let few = |bin: &mut Bin| vec![accessor(bin.floats(&[1.0; 9]), 5126, 3, "VEC3")];
    let said = with_attributes(r#","COLOR_0":4"#, few, bare).unwrap_err();
    assert!(said.contains("there are 4 vertices, but 3 of `COLOR_0`"), "{said}");
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_do() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let rest = format!(
        r#"{MESH},"nodes":[{{"translation":[1,2,3],"scale":[2,2,2],"children":[1,2,3,4,5]}},
        {{"name":"light","translation":[1,0,0],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},
        {{"rotation":[{half},0,0,{half}],"extensions":{{"KHR_lights_punctual":{{"light":1}}}}}},
        {{"extensions":{{"KHR_lights_punctual":{{"light":2}}}}}},
        {{"name":"eye","camera":0,"rotation":[0,{half},0,{half}]}},{{"camera":1}}],
        "cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}},
        {{"name":"plan","type":"orthographic","orthographic":{{"xmag":1,"ymag":2,"zfar":9,"znear":0}}}}],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point","color":[1,0.5,0],"intensity":8,"range":3}},
        {{"name":"down","type":"directional"}},
        {{"type":"spot","intensity":-4,"spot":{{"innerConeAngle":0.9,"outerConeAngle":0.5}}}}]}}}}"#
    );
    let model = read_square(&rest).unwrap();
    assert!(model.left_out.is_empty(), "{:?}", model.left_out);
    let [light, sun, spot] = &model.lights[..] else { panic!("{:?}", model.lights) };
    assert_eq!((light.name.as_deref(), light.kind), (Some("light"), ModelLightKind::Point));
    assert_eq!((light.intensity, light.position), ([8.0, 4.0, 0.0], DVec3::new(3.0, 2.0, 3.0)));
    assert_eq!((sun.name.as_deref(), sun.kind), (Some("down"), ModelLightKind::Directional));
    assert!(sun.direction.distance(DVec3::Y) < 1e-12, "{}", sun.direction);
    assert_eq!((spot.intensity, spot.kind), ([0.0; 3], ModelLightKind::Spot { inner: 0.5, outer: 0.5 }));
    let [eye, plan] = &model.cameras[..] else { panic!("{:?}", model.cameras) };
    assert_eq!((eye.name.as_deref(), eye.view), (Some("eye"), ModelView::Perspective { angle: 0.5 }));
    assert!(eye.direction.distance(DVec3::NEG_X) < 1e-12 && eye.up.distance(DVec3::Y) < 1e-12, "{eye:?}");
    assert_eq!((plan.name.as_deref(), plan.view), (Some("plan"), ModelView::Orthographic { height: 4.0 }));
    assert_eq!(plan.center, DVec3::new(1.0, 2.0, 3.0));
    for (from, to, said) in [
        ("\"light\":2", "\"light\":7", "nodes[3]: there is no light 7"),
        ("\"point\"", "\"area\"", "nodes[1]: there is no type of light `area`"),
        ("\"camera\":1", "\"camera\":2", "nodes[5]: there is no cameras[2]"),
    ] {
        let error = read_square(&rest.replace(from, to)).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    assert_eq!(read_square(&rest.replace("\"yfov\":0.5", "\"yfov\":4")).unwrap().cameras.len(), 1);
    let hidden = rest.replacen(
        "\"scale\"",
        "\"extensions\":{\"KHR_node_visibility\":{\"visible\":false}},\"scale\"",
        1,
    );
    assert!(read_square(&hidden).unwrap().lights.is_empty());
}

#[test]
fn unlit_and_dispersive_materials_are_read() {
    assert!(extended(r#""KHR_materials_unlit":{}"#).unlit && !extended("").unlit);
    assert_eq!(extended(r#""KHR_materials_dispersion":{"dispersion":0.5}"#).abbe, 40.0);
    assert_eq!(extended("").abbe, f32::INFINITY);
    let gloss = extended(
        r#""KHR_materials_specular":{"specularFactor":0.5,"specularTexture":{"index":1},"specularColorTexture":{"index":2}}"#,
    );
    let weight = ModelAmount { value: 0.5, picture: Some(as_it_is(1)) };
    assert_eq!((gloss.gloss, gloss.specular.picture), (weight, Some(as_it_is(2))));
    let older = extended(
        r#""KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,1,1,1],"diffuseTexture":{"index":0},
        "glossinessFactor":0.5,"specularGlossinessTexture":{"index":1}}"#,
    );
    let kept = older.glossiness.unwrap();
    assert_eq!((kept.diffuse, kept.specular, kept.glossiness), ([0.5, 1.0, 1.0], [1.0; 3], 0.5));
    assert_eq!((kept.diffuse_picture, kept.picture), (Some(as_it_is(0)), as_it_is(1)));
}

#[test]
fn morphs_and_skins_have_the_shape_they_have_at_rest() {
    let targets = |weights: &str, node: &str| {
        let (mut bin, mut accessors) = square();
        let moved = bin.floats(&[0.0, 0.0, 2.0].repeat(4));
        accessors.push(accessor(moved, 5126, 4, "VEC3"));
        let rest = format!(
            r#""nodes":[{{"mesh":0}},{{"mesh":0{node}}},{{"mesh":0}}],"meshes":[{{{weights}"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1}},
            "indices":3,"targets":[{{"POSITION":4}},{{"NORMAL":4}}]}}]}}]"#
        );
        read(&glb(&json(&bin, &accessors, "", &rest), &bin.bytes), &MemoryAssets::new()).unwrap()
    };
    let height = |model: &Model, mesh: usize| model.meshes[mesh][0].mesh.positions[2];
    let plain = targets("", "");
    assert_eq!((plain.meshes.len(), height(&plain, 0), plain.left_out.len()), (1, [1.0, 1.0, 0.0], 0));
    let both = targets("\"weights\":[0.5,0.25],", ",\"weights\":[1,0]");
    assert_eq!((both.meshes.len(), both.instances.len()), (2, 3));
    assert_eq!((height(&both, 0), height(&both, 1)), ([1.0, 1.0, 1.0], [1.0, 1.0, 2.0]));
    assert_eq!(both.meshes[0][0].mesh.normals[0], [0.0, 0.0, 1.5]);
    assert_eq!([0, 1, 2].map(|i| both.instances[i].mesh), [0, 1, 0]);

    let half = std::f64::consts::FRAC_1_SQRT_2;
    let skinned = |joints: &str, bound: &str| {
        let (mut bin, mut accessors) = square();
        let numbers = bin.add([0u8, 1, 0, 0].repeat(4));
        let weights = bin.floats(&[0.5, 0.5, 0.0, 0.0].repeat(4));
        let mut matrix = [0.0f32; 16];
        (0..4).for_each(|i| matrix[5 * i] = 1.0);
        matrix[12] = -5.0;
        let matrices = bin.floats(&[matrix; 2].concat());
        accessors.extend([
            accessor(numbers, 5121, 4, "VEC4"),
            accessor(weights, 5126, 4, "VEC4"),
            accessor(matrices, 5126, 2, "MAT4"),
        ]);
        let rest = format!(
            r#""nodes":[{{"mesh":0,"skin":0,"translation":[9,9,9]}},{{"translation":[5,0,1]}},
            {{"translation":[5,0,3],"rotation":[0,0,{half},{half}]}}],"skins":[{{"joints":{joints}{bound}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"JOINTS_0":4,"WEIGHTS_0":5}},"indices":3}}]}}]"#
        );
        read(&glb(&json(&bin, &accessors, "", &rest), &bin.bytes), &MemoryAssets::new())
    };
    let model = skinned("[1,1]", ",\"inverseBindMatrices\":6").unwrap();
    assert_eq!(model.meshes[0][0].mesh.positions[2], [1.0, 1.0, 1.0]);
    assert_eq!(model.instances[0].model_from_mesh, DAffine3::IDENTITY);
    let turned = skinned("[2,2]", "").unwrap();
    let [x, y, z] = turned.meshes[0][0].mesh.positions[1];
    assert!((x - 5.0).abs() < 1e-6 && (y - 1.0).abs() < 1e-6 && z == 3.0, "{x} {y} {z}");
    assert_eq!(turned.meshes[0][0].mesh.normals[1], [0.0, 0.0, 1.0]);
    let lost = skinned("[1,77]", "").unwrap();
    assert_eq!(lost.meshes[0][0].mesh.positions[0], [9.0, 9.0, 9.0]);
    assert_eq!(lost.left_out, ["left out: 1 skins with joints that are not in the scene"]);
    let error = skinned("[1,1,1]", ",\"inverseBindMatrices\":6").unwrap_err();
    assert!(error.contains("skins[0]: there are fewer matrices than joints"), "{error}");
}
