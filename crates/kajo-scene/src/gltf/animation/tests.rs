use super::super::tests::{accessor, glb, json, square};
use super::*;
use crate::assets::{Assets, MemoryAssets};
use crate::gltf::{Model, read_gltf_at};
use crate::limits::Limits;
use kajo_math::DVec3;

/// A square that nodes 0 and 1 show: the one with a target that lifts it by 2, the other with node 2 as its only joint.
/// Accessors from 4 on: times 0, 1, 2; three places; three rotations about z by 0, 90 and 90 degrees; weights
/// 0, 1, 0 with slopes; times that do not grow.
fn model(animations: &str, moment: Option<ModelMoment>) -> Result<Model, String> {
    let (mut bin, mut accessors) = square();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut floats = |values: &[f32], count: usize, of: &str| {
        let view = bin.floats(values);
        accessors.push(accessor(view, 5126, count, of));
    };
    floats(&[0.0, 1.0, 2.0], 3, "SCALAR");
    floats(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 4.0, 0.0], 3, "VEC3");
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half, 0.0, 0.0, -half, -half], 3, "VEC4");
    // Slope before, value, slope behind.
    floats(&[0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 9, "SCALAR");
    floats(&[0.0, 2.0, 2.0], 3, "SCALAR");
    floats(&[0.0, 0.0, 2.0].repeat(4), 4, "VEC3");
    floats(&[1.0, 0.0, 0.0, 0.0].repeat(4), 4, "VEC4");
    let joints = bin.add([0u8; 16]);
    accessors.push(accessor(joints, 5121, 4, "VEC4"));
    let rest = format!(
        r#""nodes":[{{"mesh":0,"name":"lifted"}},{{"mesh":1,"skin":0}},{{"translation":[5,0,1]}}],
        "skins":[{{"joints":[2]}}],"animations":[{animations}],"meshes":[
        {{"primitives":[{{"attributes":{{"POSITION":0}},"indices":3,"targets":[{{"POSITION":9}}]}}]}},
        {{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":11,"WEIGHTS_0":10}},"indices":3}}]}}]"#
    );
    let assets = MemoryAssets::new().with("m.glb", glb(&json(&bin, &accessors, "", &rest), &bin.bytes));
    let file = assets.open("m.glb", "").unwrap();
    read_gltf_at(file, &assets, &Limits::default(), moment.as_ref()).map_err(|error| error.to_string())
}

/// An animation of one channel.
fn channel(node: usize, path: &str, output: usize, interpolation: &str) -> String {
    format!(
        r#"{{"name":"{path}","channels":[{{"sampler":0,"target":{{"node":{node},"path":"{path}"}}}}],
        "samplers":[{{"input":4,"output":{output}{interpolation}}}]}}"#
    )
}

fn at(seconds: f64) -> Option<ModelMoment> {
    Some(ModelMoment { animation: None, seconds, outside: Outside::Hold })
}

const CUBIC: &str = r#","interpolation":"CUBICSPLINE""#;
const STEP: &str = r#","interpolation":"STEP""#;

#[track_caller]
fn near(found: DVec3, expected: [f64; 3]) {
    assert!(found.distance(DVec3::from(expected)) < 1e-6, "{found}");
}

#[test]
fn nodes_are_moved_turned_and_scaled() {
    let corner = |animation: &str, seconds: f64| {
        let model = model(animation, at(seconds)).unwrap();
        model.instances[0].model_from_mesh.transform_point3(DVec3::X)
    };
    let slides = channel(0, "translation", 5, "");
    near(corner(&slides, 0.5), [2.0, 0.0, 0.0]);
    near(corner(&slides, 1.5), [3.0, 2.0, 0.0]);
    near(corner(&slides, 99.0), [3.0, 4.0, 0.0]);
    near(corner(&slides, -99.0), [1.0, 0.0, 0.0]);
    near(corner(&channel(0, "translation", 5, STEP), 1.5), [3.0, 0.0, 0.0]);
    near(corner(&channel(0, "scale", 5, ""), 0.5), [1.0, 0.0, 0.0]);
    let turns = channel(0, "rotation", 6, "");
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    near(corner(&turns, 0.5), [diagonal, diagonal, 0.0]);
    // The last two are the same rotation by quaternions of opposite signs.
    near(corner(&turns, 1.5), [0.0, 1.0, 0.0]);
}

#[test]
fn morphs_have_their_weights() {
    let height = |seconds: f64| {
        let model = model(&channel(0, "weights", 7, CUBIC), at(seconds)).unwrap();
        model.meshes[0][0].mesh.positions[2][2]
    };
    // 1/8 of the slope behind the first key, and half of the weight at the second.
    assert_eq!((height(0.0), height(0.5), height(1.0), height(1.5)), (0.0, 1.25, 2.0, 1.0));
}

#[test]
fn skins_follow_their_joints() {
    let vertex = |animation: &str, seconds: f64| {
        let model = model(animation, at(seconds)).unwrap();
        let [x, y, z] = model.meshes[1][0].mesh.positions[1];
        DVec3::new(x.into(), y.into(), z.into())
    };
    let turns = channel(2, "rotation", 6, "");
    near(vertex(&turns, 0.0), [6.0, 0.0, 1.0]);
    near(vertex(&turns, 1.0), [5.0, 1.0, 1.0]);
    near(vertex(&channel(2, "translation", 5, ""), 1.5), [3.0, 2.0, 0.0]);
}

#[test]
fn the_animation_and_its_end_are_chosen() {
    let both = [channel(0, "translation", 5, ""), channel(0, "rotation", 6, "")].join(",");
    let corner = |animation: &str, seconds: f64, outside: Outside| {
        let moment = ModelMoment { animation: Some(animation.to_owned()), seconds, outside };
        model(&both, Some(moment)).unwrap().instances[0].model_from_mesh.transform_point3(DVec3::X)
    };
    near(corner("rotation", 1.0, Outside::Hold), [0.0, 1.0, 0.0]);
    near(corner("1", 1.0, Outside::Hold), [0.0, 1.0, 0.0]);
    near(corner("0", 2.5, Outside::Loop), [2.0, 0.0, 0.0]);
    near(corner("0", 3.5, Outside::PingPong), [2.0, 0.0, 0.0]);
    // Without a moment it is at rest, and says what it leaves out.
    let rest = model(&both, None).unwrap();
    near(rest.instances[0].model_from_mesh.transform_point3(DVec3::X), [1.0, 0.0, 0.0]);
    assert_eq!(rest.left_out, ["left out: 2 animations"]);
    assert_eq!(model(&both, at(1.0)).unwrap().left_out, [""; 0]);
    let pointer =
        r#"{"channels":[{"sampler":0,"target":{"path":"pointer"}}],"samplers":[{"input":4,"output":5}]}"#;
    let said = model(pointer, at(1.0)).unwrap().left_out;
    assert_eq!(said, ["left out: 1 channels of an animation that move no node"]);
}

#[test]
fn what_is_wrong_with_an_animation_is_said() {
    let wrong = |animation: &str| model(animation, at(0.5)).unwrap_err();
    let check = |animation: &str, said: &str| {
        let error = wrong(animation);
        assert!(error.contains(said), "{error}");
    };
    check(&channel(7, "scale", 5, ""), "animations[0]: channels[0]: there is no nodes[7]");
    check(&channel(0, "scale", 99, ""), "there is no accessors[99]");
    check(&channel(0, "scale", 5, CUBIC), "there are 9 values to be, and only 3");
    check(&channel(0, "rotation", 5, ""), "expected 4 numbers an element");
    check(
        &channel(0, "scale", 5, "").replace("\"input\":4", "\"input\":8"),
        "samplers[0]: its times do not grow",
    );
    check(&channel(0, "scale", 5, "").replace("\"sampler\":0", "\"sampler\":3"), "there is no samplers[3]");
    let named =
        |name: &str| ModelMoment { animation: Some(name.to_owned()), seconds: 0.0, outside: Outside::Hold };
    let error = model(&channel(0, "scale", 5, ""), Some(named("jump"))).unwrap_err();
    assert!(error.contains("it has no animation `jump`; there are `scale`"), "{error}");
    assert!(model("", Some(named("jump"))).unwrap_err().contains("it has no animations"));
}
