//! Scenes made by program: what is refused, and what comes out.

use kajo_color::{Emission, Reflectance, Wavelengths};
use kajo_math::{Affine3A, DAffine3, DVec3, Keyframes, Motion, Ray, Vec3};

use super::*;
use crate::camera::{CameraFrame, OrthographicCamera, PerspectiveCamera};
use crate::ids::{LightIndex, MaterialSlot, ObjectId, PoseId};
use crate::light::{PointLight, Sides, SpotLight};
use crate::material::{Blend, Embossed, Matte, Perforated, Relief};
use crate::scene::RayEvent;
use crate::shape::{Mesh, MeshData, Plane, Sphere};
use crate::texture::{
    Channel, Checker, ColorTexture, FloatTexture, Marble, Picture, PictureChannel, PictureMap, Placed,
    TexelFilter,
};

fn matte(albedo: f32) -> Matte {
    Matte::new(Reflectance::constant(albedo), 0.0)
}

fn ball(radius: f32) -> Sphere {
    Sphere { center: Vec3::ZERO, radius }
}

fn frame() -> CameraFrame {
    CameraFrame::new(DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z, DVec3::Y)
}

fn camera(angle: f64) -> PerspectiveCamera {
    PerspectiveCamera::new(frame(), angle)
}

fn point(x: f32) -> PointLight {
    PointLight {
        position: Vec3::new(x, 0.0, 0.0),
        intensity: Spectrum::WHITE,
        emission: Emission::from_rgb([1.0; 3]),
        attenuation: [0.0, 0.0, 1.0],
    }
}

/// A mesh of one triangle with a material of its own.
fn triangle(slot: MaterialSlot) -> Mesh {
    let data = MeshData {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        faces: vec![[0, 1, 2]],
        material_slots: Some(vec![slot]),
        ..MeshData::default()
    };
    Mesh::new(data, &BuildSettings::default()).unwrap()
}

/// Names that no builder with less in it has given.
struct Strange {
    shape: ShapeId,
    material: MaterialId,
    number: FloatTexture,
    color: ColorTexture,
    pose: PoseId,
    moving: PoseId,
    assembly: crate::ids::AssemblyId,
    group: LightGroup,
}

fn turning() -> Motion {
    let there = DAffine3::from_rotation_z(1.0);
    Motion::keyed(Keyframes::new(&[(0.0, DAffine3::IDENTITY), (1.0, there)]).unwrap())
}

fn strange() -> Strange {
    let mut other = SceneBuilder::default();
    let shape = other.shape(ball(1.0)).unwrap();
    let material = other.material(matte(0.5)).unwrap();
    let part = AssemblyPart {
        content: PartContent::Shape(shape),
        map: DAffine3::IDENTITY,
        material: Some(material),
    };
    Strange {
        shape,
        material,
        number: other.float_texture(Checker).unwrap(),
        color: other.color_texture(PictureMap::white()).unwrap(),
        pose: other.transform(&DAffine3::from_scale(DVec3::splat(2.0))).unwrap(),
        moving: other.motion(turning()).unwrap(),
        assembly: other.assembly(&[part]).unwrap(),
        group: other.light_group("key").unwrap(),
    }
}

#[test]
fn ids_of_another_scene_are_refused() {
    let s = strange();
    let mut scene = SceneBuilder::default();
    let blend = |materials| Blend { amount: s.number, materials };
    let no = SceneError::UnknownTexture;
    let placed = Placed { texture: s.number, texture_from_world: Affine3A::IDENTITY };
    assert_eq!(scene.float_texture(placed), Err(no.clone()));
    assert_eq!(scene.material(Matte::new(s.color.clone(), 0.0)), Err(no.clone()));
    assert_eq!(scene.material(Matte::new(Reflectance::constant(0.5), s.number)), Err(no.clone()));
    let slide = SurfaceEmission::from(Emission::from_rgb([1.0; 3])).through(&s.color);
    assert_eq!(scene.emissive_material(matte(0.5), slide), Err(no.clone()));
    let unknown = SceneError::UnknownMaterial(s.material);
    assert_eq!(scene.material(blend([s.material; 2])), Err(unknown.clone()));
    assert_eq!(scene.mesh_material(s.material), Err(unknown.clone()));
    assert_eq!(scene.see_through(s.material), Err(unknown.clone()));
    assert_eq!(scene.name_material(s.material, "grey"), Err(unknown.clone()));
    assert_eq!(scene.object(s.shape, s.material, PoseId::IDENTITY), Err(SceneError::UnknownShape(s.shape)));
    let first = MaterialSlot::new(0).unwrap();
    assert_eq!(scene.shape(triangle(first)), Err(SceneError::UnknownMeshMaterial(first)));

    let shape = scene.shape(ball(1.0)).unwrap();
    assert_eq!(scene.object(shape, s.material, PoseId::IDENTITY), Err(unknown.clone()));
    let material = scene.material(matte(0.5)).unwrap();
    assert_eq!(scene.material(blend([material; 2])), Err(no));
    for pose in [s.pose, s.moving] {
        assert_eq!(scene.object(shape, material, pose), Err(SceneError::UnknownPose(pose)));
    }
    let object = scene.object(shape, material, PoseId::IDENTITY).unwrap();
    assert_eq!(scene.name_object(ObjectId::from_index(1), "moon"), Err(SceneError::UnknownObject(1)));
    assert_eq!(scene.name_object(object, "moon"), Ok(()));

    let unknown = SceneError::UnknownAssembly(s.assembly);
    let part =
        AssemblyPart { content: PartContent::Assembly(s.assembly), map: DAffine3::IDENTITY, material: None };
    assert_eq!(scene.assembly(&[part]), Err(unknown.clone()));
    assert_eq!(scene.instance(s.assembly, &DAffine3::IDENTITY, None), Err(unknown));
    let unknown = SceneError::UnknownLightGroup(s.group);
    assert_eq!(scene.light_in(s.group, point(0.0)), Err(unknown.clone()));
    assert_eq!(scene.background_in(s.group, Background::default()), Err(unknown.clone()));
    let emission = SurfaceEmission::from(Emission::from_rgb([1.0; 3])).in_group(s.group);
    assert_eq!(scene.emissive_material(matte(0.5), emission), Err(unknown));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut scene = SceneBuilder::default();
    for bad in [f32::NAN, f32::INFINITY] {
        let wide = f64::from(bad);
        let no = SceneError::NotFinite;
        assert_eq!(scene.shape(ball(bad)), Err(no("Sphere")));
        assert_eq!(scene.shape(Plane::new(DVec3::Y, wide)), Err(no("Plane")));
        let texture = FloatTexture::Constant(bad);
        let placed = Placed { texture, texture_from_world: Affine3A::IDENTITY };
        assert_eq!(scene.float_texture(placed), Err(no("Placed")));
        let texture_from_world = Affine3A::from_scale(Vec3::splat(bad));
        let placed = Placed { texture: 0.5.into(), texture_from_world };
        assert_eq!(scene.float_texture(placed), Err(no("Placed")));
        let marble = Marble { octaves: 1, frequency: bad, amplitude: 1.0 };
        assert_eq!(scene.float_texture(marble), Err(no("Marble")));
        assert_eq!(scene.material(Matte::new(Reflectance::constant(0.5), bad)), Err(no("Matte")));
        assert_eq!(scene.light(point(bad)), Err(no("PointLight")));
        let cone = crate::light::SpotCone { inner: 0.1, outer: bad };
        let spot = SpotLight { point: point(0.0), axis: Vec3::Y, cone };
        assert_eq!(scene.light(spot), Err(no("SpotLight")));
        let slide = PictureMap { factor: [1.0, bad, 1.0, 1.0], ..PictureMap::white() };
        assert_eq!(scene.color_texture(slide).err(), Some(no("PictureMap")));
        let emission = SurfaceEmission::from(Emission::from_rgb([bad; 3]));
        // What is no number is no light.
        let expected = if bad.is_nan() { None } else { Some(no("SurfaceEmission")) };
        assert_eq!(scene.emissive_material(matte(0.5), emission).err(), expected);
        let color = Spectrum::grey(bad);
        let background = Background::Constant { color, emission: Emission::from_rgb([1.0; 3]) };
        assert_eq!(scene.background(background), Err(no("Background")));
        assert_eq!(scene.transform(&DAffine3::from_scale(DVec3::splat(wide))), Err(no("DAffine3")));
        let orthographic = OrthographicCamera { frame: frame(), size: wide, lens: None };
        assert_eq!(scene.camera(orthographic), Err(no("Camera")));
        assert_eq!(scene.camera(camera(wide)), Err(no("Camera")));
        assert_eq!(scene.shutter(Shutter::new(0.0, wide)), Err(no("Shutter")));
        let mut whole = SceneBuilder::default();
        whole.camera(camera(0.5)).unwrap();
        let settings = Settings { exposure: Some(bad), ..Settings::default() };
        assert_eq!(whole.finish(settings).unwrap_err(), no("Settings"));
    }
    // The camera of no angle has a picture infinitely far away.
    assert_eq!(scene.camera(camera(0.0)), Err(SceneError::NotFinite("Camera")));
    assert_eq!(scene.geometry().shapes.counts(), []);
}

#[test]
fn what_cannot_be_is_refused() {
    let mut scene = SceneBuilder::new(Limits { objects: 1, ..Limits::default() }, BuildSettings::default());
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    assert_eq!(scene.transform(&flat), Err(SceneError::NoInverse));
    assert_eq!(scene.motion(Motion::still(flat)), Err(SceneError::NoInverse));
    assert_eq!(scene.motion(turning().then(&Motion::still(flat))), Err(SceneError::NoInverse));
    assert_eq!(scene.shutter(Shutter::new(1.0, 0.5)), Err(SceneError::Shutter));
    assert_eq!(scene.light_group("a b"), Err(SceneError::LightGroupName("a b".to_owned())));
    for i in 1..crate::light::MAX_LIGHT_GROUPS {
        assert_eq!(scene.light_group(&i.to_string()).map(LightGroup::index), Ok(i));
    }
    assert_eq!(scene.light_group("more"), Err(SceneError::TooManyLightGroups));
    assert_eq!(scene.light_group("3").map(LightGroup::index), Ok(3));
    let sky = crate::light::SkyLight::new(Arc::default());
    assert_eq!(scene.light(sky), Err(SceneError::OwnLight("SkyLight")));

    let (shape, plane) = (scene.shape(ball(1.0)).unwrap(), scene.shape(Plane::new(DVec3::Y, 0.0)).unwrap());
    let grey = scene.material(matte(0.5)).unwrap();
    let emission = SurfaceEmission::from(Emission::from_rgb([1.0; 3]));
    let warm = scene.emissive_material(matte(0.5), emission).unwrap();
    scene.object(shape, grey, PoseId::IDENTITY).unwrap();
    assert_eq!(scene.object(shape, grey, PoseId::IDENTITY), Err(SceneError::TooManyObjects(1)));

    let part = |shape, material| {
        [AssemblyPart { content: PartContent::Shape(shape), map: DAffine3::IDENTITY, material }]
    };
    assert_eq!(scene.assembly(&part(plane, Some(grey))), Err(SceneError::UnboundedPart));
    assert_eq!(scene.assembly(&part(shape, Some(warm))), Err(SceneError::EmissivePart));
    assert_eq!(
        scene.assembly(&[AssemblyPart { map: flat, ..part(shape, None)[0] }]),
        Err(SceneError::NoInverse)
    );
    let slot = scene.mesh_material(warm).unwrap();
    let bright = scene.shape(triangle(slot)).unwrap();
    assert_eq!(scene.assembly(&part(bright, Some(grey))), Err(SceneError::EmissivePart));
    let bare = scene.assembly(&part(shape, None)).unwrap();
    let at = &DAffine3::IDENTITY;
    assert_eq!(scene.instance(bare, at, None), Err(SceneError::NoMaterial));
    assert_eq!(scene.instance(bare, at, Some(warm)), Err(SceneError::EmissivePart));
    assert_eq!(scene.instance(bare, &flat, Some(grey)), Err(SceneError::NoInverse));
    let mut tower = bare;
    let up = |assembly| [AssemblyPart { content: PartContent::Assembly(assembly), ..part(shape, None)[0] }];
    for _ in 1..crate::nested::MOST_LEVELS {
        tower = scene.assembly(&up(tower)).unwrap();
    }
    assert_eq!(scene.assembly(&up(tower)), Err(SceneError::TooManyLevels));
    scene.instance(tower, at, Some(grey)).unwrap();

    assert_eq!(SceneBuilder::default().finish(Settings::default()).unwrap_err(), SceneError::NoCamera);
    scene.camera(camera(0.5)).unwrap();
    let empty = Settings { size: Some([64, 0]), ..Settings::default() };
    assert_eq!(scene.finish(empty).unwrap_err(), SceneError::EmptyPicture(64, 0));
}

#[test]
fn lights_take_from_the_budget() {
    let limits = Limits { memory: kajo_scene::MemoryBudget::new(100), ..Limits::default() };
    let mut scene = SceneBuilder::new(limits, BuildSettings::default());
    let shape = scene.shape(ball(1.0)).unwrap();
    let emission = SurfaceEmission::from(Emission::from_rgb([1.0; 3]));
    let warm = scene.emissive_material(matte(0.5), emission).unwrap();
    scene.object(shape, warm, PoseId::IDENTITY).unwrap();
    scene.camera(camera(0.5)).unwrap();
    assert!(matches!(scene.finish(Settings::default()), Err(SceneError::LightMemory(_))));
}

#[test]
fn a_scene_has_what_was_pushed() {
    let mut scene = SceneBuilder::default();
    let [grey, white] = [0.5, 0.8].map(|albedo| scene.material(matte(albedo)).unwrap());
    scene.name_material(white, "white").unwrap();
    let shape = scene.shape(ball(1.0)).unwrap();
    let aside = scene.transform(&DAffine3::from_translation(DVec3::X * 3.0)).unwrap();
    let spins = scene.motion(turning()).unwrap();
    let objects = [PoseId::IDENTITY, aside, spins].map(|pose| scene.object(shape, grey, pose).unwrap());
    scene.name_object(objects[1], "moon").unwrap();
    let part = AssemblyPart {
        content: PartContent::Shape(shape),
        map: DAffine3::from_translation(DVec3::Y * 3.0),
        material: None,
    };
    let pair =
        scene.assembly(&[part, AssemblyPart { map: DAffine3::from_translation(DVec3::Y * 6.0), ..part }]);
    scene.instance(pair.unwrap(), &DAffine3::IDENTITY, Some(white)).unwrap();
    let key = scene.light_group("key").unwrap();
    assert_eq!(scene.light(point(1.0)).map(LightIndex::index), Ok(0));
    assert_eq!(scene.light_in(key, point(2.0)).map(LightIndex::index), Ok(1));
    scene.named_camera("front", camera(0.5)).unwrap();
    scene.camera(OrthographicCamera { frame: frame(), size: 4.0, lens: None }).unwrap();
    scene.shutter(Shutter::new(0.0, 0.5)).unwrap();
    let scene = scene.finish(Settings { size: Some([4, 3]), ..Settings::default() }).unwrap();

    assert_eq!((scene.geometry.primitives.len(), scene.geometry.object_count()), (3, 5));
    let words: Vec<_> = scene.geometry.objects.iter().map(|object| (object.name, object.keyword)).collect();
    assert_eq!(words, [(None, "Sphere"), (Some("moon"), "Sphere"), (None, "Sphere")]);
    assert!(scene.moves() && !scene.geometry.transmits);
    assert_eq!([grey, white].map(|id| scene.appearance.number(id)), [1, 2]);
    assert_eq!(scene.appearance.list[1].1.as_deref(), Some("white"));
    assert_eq!(&*scene.lighting.groups, ["other", "key"]);
    let groups: Vec<_> = LightIndex::all(2).map(|i| scene.lighting.sampler.group(i).index()).collect();
    assert_eq!(groups, [0, 1]);
    assert_eq!(scene.lighting.ambient, Spectrum::BLACK);
    assert!(matches!(scene.output.camera, Camera::Orthographic(_)));
    let names: Vec<_> = scene.output.cameras.iter().map(|camera| camera.name.as_deref()).collect();
    assert_eq!(names, [Some("front"), None]);
    let seen = |x: f32, y: f32| match scene.trace(&Ray::new(Vec3::new(x, y, 9.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => Some((at.object.index(), at.material)),
        RayEvent::Escaped => None,
    };
    assert_eq!([seen(3.0, 0.0), seen(0.0, 3.0)], [Some((1, grey)), Some((3, white))]);
    assert_eq!([seen(0.0, 6.0), seen(5.0, 5.0)], [Some((4, white)), None]);
}

#[test]
fn materials_give_the_light_of_their_parts() {
    let mut scene = SceneBuilder::default();
    let key = scene.light_group("key").unwrap();
    let light = |v: f32| SurfaceEmission::from(Emission::from_rgb([v; 3]));
    let front = light(4.0).on(Sides::Front).in_group(key);
    let first = scene.emissive_material(matte(0.0), front).unwrap();
    let second = scene.emissive_material(matte(0.0), light(8.0)).unwrap();
    let dark = scene.material(matte(0.0)).unwrap();
    let blend = |materials| Blend { amount: 0.25.into(), materials };
    let normals = scene.color_texture(PictureMap::white()).unwrap();
    let relief = Relief::Normals { normals, scale: 0.0.into() };
    let shape = scene.shape(ball(1.0)).unwrap();
    let materials = [
        scene.material(blend([first, second])),
        scene.material(blend([dark, first])),
        scene.material(Perforated { material: first, opacity: 0.5.into() }),
        scene.material(Embossed { material: first, relief }),
        scene.material(blend([dark, dark])),
    ];
    for material in materials {
        scene.object(shape, material.unwrap(), PoseId::IDENTITY).unwrap();
    }
    scene.camera(camera(0.5)).unwrap();
    let scene = scene.finish(Settings::default()).unwrap();
    let lights = scene.lighting.lights.areas.iter();
    let given: Vec<_> = lights.map(|light| (light.object.index(), light.emission.rgb()[0])).collect();
    assert_eq!(given, [(0, 5.0), (1, 1.0), (2, 2.0), (3, 4.0)]);
    assert!(scene.lighting.lights.areas.iter().all(|light| light.sides == Sides::Front));
    let groups = LightIndex::all(4).map(|i| scene.lighting.sampler.group(i));
    assert!(groups.into_iter().all(|group| group == key));
    assert_eq!(
        scene.geometry.primitives.iter().map(|p| p.emits).collect::<Vec<_>>(),
        [true, true, true, true, false]
    );
}

/// A ball of radius 2 at the origin, seen from far along z.
fn ball_of(make: impl FnOnce(&mut SceneBuilder) -> MaterialId) -> Scene {
    let mut scene = SceneBuilder::default();
    let material = make(&mut scene);
    let shape = scene.shape(ball(2.0)).unwrap();
    scene.object(shape, material, PoseId::IDENTITY).unwrap();
    scene.camera(camera(0.5)).unwrap();
    scene.finish(Settings::default()).unwrap()
}

/// A ball of radius r that is raised by h(x) has the normal along n - (h' x - (h' x . n) n).
#[test]
fn a_relief_of_a_pattern_leans_against_its_gradient() {
    let scene = ball_of(|scene| {
        let heights = scene.float_texture(Marble { octaves: 1, frequency: 3.0, amplitude: 0.0 }).unwrap();
        let material = scene.material(matte(0.5)).unwrap();
        scene.material(Embossed { material, relief: Relief::Heights { heights, height: 0.5 } }).unwrap()
    });
    for (x, y) in [(0.0, 0.0), (0.4, 0.3), (-1.2, 0.7)] {
        let event = scene.trace(&Ray::new(Vec3::new(x, y, 9.0), Vec3::NEG_Z));
        let at = event.surface().unwrap();
        let n = at.point.n;
        let gradient = 0.75 * (3.0 * x).cos() * Vec3::X;
        let expected = (n - (gradient - gradient.dot(n) * n)).normalize();
        let found = scene.shading(at, 0.5);
        assert!(found.leans && found.n.distance(expected) < 2e-3, "{} for {expected}", found.n);
    }
}

/// What a picture says holds where it is laid, also where no part of a mixture shows one.
#[test]
fn a_picture_mixes_materials_and_their_light() {
    let scene = ball_of(|scene| {
        // Black on the left half of the longitudes, white on the right one.
        let picture = Picture::from_fn(2, 1, |x, _| [x as f32; 4]);
        let map = PictureMap { filter: TexelFilter::Nearest, ..PictureMap::new(picture.into()) };
        let halves = PictureChannel { map, channel: Channel::Red };
        let amount = scene.float_texture(halves).unwrap();
        let light = |v: f32| SurfaceEmission::from(Emission::from_rgb([v; 3]));
        let first = scene.emissive_material(matte(0.2), light(1.0)).unwrap();
        let second = scene.emissive_material(matte(0.6), light(5.0)).unwrap();
        scene.material(Blend { amount, materials: [first, second] }).unwrap()
    });
    let mut met = Vec::new();
    for angle in [0.3f32, 1.2, 2.0, 2.9, 3.5, 4.4, 5.3, 6.1] {
        let d = Vec3::new(angle.cos(), 0.0, angle.sin());
        let ray = Ray::new(-5.0 * d, d);
        let event = scene.trace(&ray);
        let at = event.surface().unwrap();
        let right = scene.geometry.surface_uv(at).first.x >= 0.5;
        let (albedo, light) = if right { (0.6, 5.0) } else { (0.2, 1.0) };
        let place = scene.texture_context(at);
        assert_eq!(scene.appearance.phong(at.material, &place).diffuse.to_rgb(), [albedo; 3]);
        let given = scene.surface_light(at, d, &Wavelengths::RGB).unwrap();
        assert_eq!(given.radiance.to_rgb(), [light; 3]);
        met.push(right);
    }
    assert!(met.contains(&true) && met.contains(&false));
}

/// What is said of a point that no ray has met is what is said of one that a ray meets.
#[test]
fn a_point_of_a_surface_has_the_textures_that_a_ray_finds_there() {
    let mut builder = SceneBuilder::default();
    let checker = builder.float_texture(Checker).unwrap();
    let [first, second] = [0.2, 0.6].map(|albedo| builder.material(matte(albedo)).unwrap());
    let material = builder.material(Blend { amount: checker, materials: [first, second] }).unwrap();
    let shape = builder.shape(ball(2.0)).unwrap();
    let map = DAffine3::from_translation(DVec3::new(0.3, 0.1, 0.0))
        * DAffine3::from_scale(DVec3::new(1.0, 1.5, 1.0));
    let pose = builder.transform(&map).unwrap();
    let object = builder.object(shape, material, pose).unwrap();
    builder.camera(camera(0.5)).unwrap();
    let scene = builder.finish(Settings::default()).unwrap();
    for (x, y) in [(0.0, 0.0), (0.7, 0.4), (-0.9, 1.7), (1.3, -1.2)] {
        let event = scene.trace(&Ray::new(Vec3::new(x, y, 9.0), Vec3::NEG_Z));
        let met = event.surface().unwrap();
        let own = scene.geometry.transform_of(&scene.geometry.primitives[0], 0.0).object_from_world;
        let p = own.transform_point3(met.point.p);
        let at = scene.surface_point(object, met.hit.part, p, p.normalize()).unwrap();
        assert!(at.point.p.distance(met.point.p) < 1e-5 && at.point.n.distance(met.point.n) < 1e-5);
        assert_eq!((at.object, at.material), (met.object, met.material));
        let [told, found] = [&at, met]
            .map(|at| scene.appearance.phong(at.material, &scene.texture_context(at)).diffuse.to_rgb());
        assert_eq!(told, found);
    }
    assert!(scene.surface_point(ObjectId::from_index(1), 0, Vec3::ZERO, Vec3::X).is_none());
}

#[test]
fn a_material_varies_where_its_colours_do() {
    let mut builder = SceneBuilder::default();
    let heights = builder.float_texture(Checker).unwrap();
    let [first, second] = [0.2, 0.6].map(|albedo| builder.material(matte(albedo)).unwrap());
    let relief = Relief::Heights { heights, height: 0.1 };
    let embossed = builder.material(Embossed { material: first, relief }).unwrap();
    let mixed = builder.material(Blend { amount: heights, materials: [first, second] }).unwrap();
    let holes = builder.material(Perforated { material: mixed, opacity: heights }).unwrap();
    let object = builder.shape(ball(1.0)).unwrap();
    builder.object(object, holes, PoseId::IDENTITY).unwrap();
    builder.camera(camera(0.5)).unwrap();
    let scene = builder.finish(Settings::default()).unwrap();
    let varies = [first, embossed, mixed, holes].map(|material| scene.appearance.varies(material));
    assert_eq!(varies, [false, false, true, true]);
}
