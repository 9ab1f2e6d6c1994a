//! A scene made by program has the picture of the same scene in a text, bit for bit.

use std::error::Error;

use kajo::build::bsdf::Phong;
use kajo::build::camera::{CameraFrame, PerspectiveCamera};
use kajo::build::light::{DirectionalLight, PointLight, Sides, SpotCone, SpotLight};
use kajo::build::material::{
    Blend, Glass, GlassSettings, LayeredMaterial, Layers, Matte, Perforated, PhongMaterial,
};
use kajo::build::shape::{Cuboid, Mesh, MeshData, Plane, Sphere};
use kajo::build::texture::{Checker, Placed};
use kajo::build::{
    Background, BuildSettings, Emission, Fog, PoseId, Reflectance, SceneBuilder, Spectrum, SurfaceEmission,
};
use kajo::kajo_math::{Affine3A, DAffine3, DVec3, Keyframes, Motion, Vec3};
use kajo::{
    Defaults, Format, INTEGRATORS, LoadOptions, MemoryAssets, RenderRequest, RenderSettings, SamplerKind,
    Scene, Settings, SettingsKey, Shadows, Silent, View, load_from, render,
};

const SIZE: [u32; 2] = [24, 18];

const TEXT: &str = "
PerspectiveCamera { center 0 2 9  direction 0 -0.2 -1  up 0 1 0  angle 40  shutter 0 0.5 }
Background { color 0.2 0.3 0.5  ambientLight 0.1 0.1 0.2  group sky }
Fog { color 0.5 0.5 0.6  density 0.01 }
Lights {
  PointLight { position 2 5 4  intensity 30 30 20  group key }
  DirectionalLight { direction -1 -2 -1  irradiance 0.5 0.5 0.5 }
  SpotLight { position -4 5 2  direction 1 -1 -0.5  angle 60  innerAngle 30  intensity 20 10 5 }
}
Materials {
  Matte grey { color 0.6 0.5 0.4 }
  Material glossy { diffuseColor 0.2 0.3 0.1  specularColor 0.5 0.5 0.5  exponent 30 }
  Glass clear { indexOfRefraction 1.4  absorption 0.1 0.3 0.6 }
  Principled coated { color 0.1 0.2 0.6  roughness 0.4  coat 0.5 }
  Checkerboard tiles { Transform { UniformScale 2 }  materialIndex grey  materialIndex glossy }
  Matte leaf { color 0.1 0.4 0.1  opacity 0.4 }
  Matte warm { color 0 0 0  emission 6 4 2  emits front  group warm }
  Checkerboard half { materialIndex warm  materialIndex grey }
}
Group {
  Define tuft {
    Sphere { center 0 0 0  radius 0.1 }
    Transform { Translate 0.2 0.1 0  MaterialIndex leaf Sphere { center 0 0 0  radius 0.1 } }
  }
  MaterialIndex tiles   Plane { normal 0 1 0  offset -1 }
  MaterialIndex clear   Sphere { center 0 0 0  radius 1 }
  MaterialIndex coated  Transform { Translate 2 0 0  UniformScale 0.5  Sphere { center 0 0 0  radius 1 } }
  MaterialIndex leaf    Box { min -3 -1 -1  max -2 1 0 }
  MaterialIndex glossy  Transform { Motion { key 0 { }  key 1 { Translate 0 1 0 } }  Sphere { center 0 -0.5 3  radius 0.3 } }
  MaterialIndex grey    TriangleMesh { file tent.obj }
  MaterialIndex half    Transform { Translate 0 3 0  Box { min -0.5 0 -0.5  max 0.5 0.2 0.5 } }
  MaterialIndex warm    Sphere { center 3 2 0  radius 0.2 }
  MaterialIndex coated
  Transform { Translate -1 -0.9 2  Instance tuft }
  Transform { Translate 1 -0.9 2  Instance tuft }
}";

const TENT: &str = "v 0 0 -2\nv 2 0 -2\nv 1 2 -2\nv 1 0 -1\nf 1 2 3\nf 1 4 3\nf 4 2 3\n";

fn from_text() -> Scene {
    let assets = MemoryAssets::new().with("s.txt", TEXT).with("tent.obj", TENT);
    let loaded = load_from("s.txt", &assets, &LoadOptions::default());
    let report = loaded.report(false);
    loaded.scene.unwrap_or_else(|| panic!("{report}"))
}

/// The same scene.
fn by_program() -> Result<Scene, Box<dyn Error>> {
    let mut scene = SceneBuilder::default();
    let frame =
        CameraFrame::new(DVec3::new(0.0, 2.0, 9.0), DVec3::new(0.0, f64::from(-0.2f32), -1.0), DVec3::Y);
    scene.camera(PerspectiveCamera::new(frame, 40f64.to_radians()))?;
    scene.shutter(kajo::build::Shutter::new(0.0, 0.5))?;
    let [sky, key, warm] = ["sky", "key", "warm"].map(|name| scene.light_group(name));
    scene.background_in(sky?, Background::constant([0.2, 0.3, 0.5]))?;
    scene.ambient(Spectrum::rgb(0.1, 0.1, 0.2));
    scene.fog(Fog { color: Spectrum::rgb(0.5, 0.5, 0.6), density: 0.01, falloff: 0.0, height: 0.0 });

    let light = Emission::from_rgb;
    scene.light_in(key?, PointLight::new(Vec3::new(2.0, 5.0, 4.0), light([30.0, 30.0, 20.0])))?;
    scene.light(DirectionalLight::new(Vec3::new(-1.0, -2.0, -1.0), light([0.5; 3])))?;
    let point = PointLight::new(Vec3::new(-4.0, 5.0, 2.0), light([20.0, 10.0, 5.0]));
    let cone = SpotCone::new(0.5 * 30f32.to_radians(), 0.5 * 60f32.to_radians());
    scene.light(SpotLight { point, axis: Vec3::new(1.0, -1.0, -0.5).normalize(), cone })?;

    let color = Reflectance::from_rgb;
    let grey = scene.material(Matte::new(color([0.6, 0.5, 0.4]), 0.0))?;
    let diffuse = Spectrum::rgb(0.2, 0.3, 0.1);
    let specular = Spectrum::rgb(0.5, 0.5, 0.5);
    let glossy = Phong { ambient: diffuse, diffuse, specular, exponent: 30.0, eta: 1.0, ..Phong::BLACK };
    let glossy = scene.material(PhongMaterial::from(glossy))?;
    let clear = GlassSettings {
        index: kajo::build::Dispersion::Constant(f64::from(1.4f32)),
        absorption: [0.1, 0.3, 0.6],
        ..GlassSettings::default()
    };
    let clear = scene.material(Glass::from(clear))?;
    let layers = Layers {
        color: color([0.1, 0.2, 0.6]).into(),
        roughness: 0.4.into(),
        coat: 0.5.into(),
        ..Layers::default()
    };
    let coated = scene.material(LayeredMaterial::from(layers))?;
    let checks = scene.float_texture(Checker)?;
    let texture_from_world = Affine3A::from_scale(Vec3::splat(2.0));
    let small = scene.float_texture(Placed { texture: checks, texture_from_world })?;
    let tiles = scene.material(Blend { amount: small, materials: [grey, glossy] })?;
    let leaf = scene.material(Matte::new(color([0.1, 0.4, 0.1]), 0.0))?;
    let leaf = scene.material(Perforated { material: leaf, opacity: 0.4.into() })?;
    let emission = SurfaceEmission::from(light([6.0, 4.0, 2.0])).on(Sides::Front).in_group(warm?);
    let warm = scene.emissive_material(Matte::new(color([0.0; 3]), 0.0), emission)?;
    let half = scene.material(Blend { amount: checks, materials: [warm, grey] })?;

    let moved = |x, y, z| DAffine3::from_translation(Vec3::new(x, y, z).as_dvec3());
    let still = PoseId::IDENTITY;
    let unit = scene.shape(Sphere::new(Vec3::ZERO, 1.0))?;
    let plane = scene.shape(Plane::new(DVec3::Y, -1.0))?;
    scene.object(plane, tiles, still)?;
    scene.object(unit, clear, still)?;
    let aside = scene.transform(&(moved(2.0, 0.0, 0.0) * DAffine3::from_scale(DVec3::splat(0.5))))?;
    scene.object(unit, coated, aside)?;
    let cuboid = scene.shape(Cuboid::new(Vec3::new(-3.0, -1.0, -1.0), Vec3::new(-2.0, 1.0, 0.0)))?;
    scene.object(cuboid, leaf, still)?;
    let keys = Keyframes::new(&[(0.0, DAffine3::IDENTITY), (1.0, moved(0.0, 1.0, 0.0))]);
    let rises = scene.motion(Motion::keyed(keys.map_err(|_| "keys")?))?;
    let pebble = scene.shape(Sphere::new(Vec3::new(0.0, -0.5, 3.0), 0.3))?;
    scene.object(pebble, glossy, rises)?;
    let data = MeshData {
        positions: [[0.0, 0.0, -2.0], [2.0, 0.0, -2.0], [1.0, 2.0, -2.0], [1.0, 0.0, -1.0]]
            .map(Vec3::from)
            .into(),
        faces: vec![[0, 1, 2], [0, 3, 2], [3, 1, 2]],
        ..MeshData::default()
    };
    let tent = scene.shape(Mesh::new(data, &BuildSettings::default())?)?;
    scene.object(tent, grey, still)?;
    let slab = scene.shape(Cuboid::new(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 0.2, 0.5)))?;
    let above = scene.transform(&moved(0.0, 3.0, 0.0))?;
    scene.object(slab, half, above)?;
    let bulb = scene.shape(Sphere::new(Vec3::new(3.0, 2.0, 0.0), 0.2))?;
    scene.object(bulb, warm, still)?;

    let bead = scene.shape(Sphere::new(Vec3::ZERO, 0.1))?;
    for x in [-1.0, 1.0] {
        let tuft = moved(x, -0.9, 2.0);
        let places = [tuft, tuft * moved(0.2, 0.1, 0.0)];
        for (material, place) in [coated, leaf].into_iter().zip(places) {
            let pose = scene.transform(&place)?;
            scene.object(bead, material, pose)?;
        }
    }
    Ok(scene.finish(Settings::default())?)
}

#[test]
fn a_scene_by_program_has_the_picture_of_the_text() {
    let (text, program) = (from_text(), by_program().unwrap());
    assert_eq!(text.geometry.object_count(), program.geometry.object_count());
    assert_eq!(text.lighting.groups, program.lighting.groups);
    let light = |scene: &Scene, integrator, spectral| {
        let asked = Settings {
            size: Some(SIZE),
            samples: Some((SamplerKind::Sobol, 4)),
            integrator: Some(integrator),
            shadows: Some(Shadows::Transparent),
            bounces: Some(4),
            spectral: Some(spectral),
            guiding: Some(true),
            training: Some(20),
            photons: Some(2000),
            rays: Some(64),
            ..Settings::default()
        };
        let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap();
        let outputs = [(View::Color, Format::Exr)];
        let picture = render(&RenderRequest::new(scene, &settings, &outputs), &Silent).unwrap();
        let light = picture.light().unwrap();
        assert!(light.data().iter().sum::<f32>() > 1.0);
        light.data().iter().map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    for spec in INTEGRATORS {
        let integrator = spec.name;
        for spectral in [false, true] {
            if spectral && !spec.keys.contains(&SettingsKey::Spectral) {
                continue;
            }
            let [a, b] = [&text, &program].map(|scene| light(scene, integrator, spectral));
            let same = std::iter::zip(&a, &b).filter(|(a, b)| a == b).count();
            assert_eq!(same, a.len(), "{integrator:?}, spectral {spectral}");
        }
    }
}
