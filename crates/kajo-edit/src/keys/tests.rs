use std::path::Path;

use kajo::LoadOptions;
use kajo_math::keyed::{Interpolation, Outside};

use super::*;
use crate::{Edit, FieldValue, NodeId};

const TEXT: &str = "Animation { fps 10  frames 1 30 }
let wide = keys { 0: 1  1: 2 } // of the ball
PerspectiveCamera { center keys cubic { 0: 0 1 9  1: 2 1 9 }  direction 0 0 -1  up 0 1 0  angle 30
  Motion { key 0 { }  key 1 { Translate 1 0 0 } } }
Materials { Matte red { color 0.8 0.1 0.1 } }
Group {
  MaterialIndex red
  Transform {
    Translate 0 keys loop { 0: 0  # low
      0.25: 1 /* high */  0.5: 0 } 0
    YRotate keys step { 0: 0  2: 90 }  YRotate 10
    Sphere ball { center 0 0 0  radius wide }
  }
  repeat i 3 { Disk { center i 0 0  normal 0 1 0  radius keys { 0: 1  1: i } } }
}
";

fn document(text: &str) -> Document {
    let mut document = Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap();
    document.compile();
    assert!(document.is_current(), "{}", document.report(false));
    document
}

fn named<'a>(rows: &'a [KeyRow], name: &str) -> &'a KeyRow {
    let all = || rows.iter().map(|row| &row.name).collect::<Vec<_>>();
    rows.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("no {name} in {:?}", all()))
}

#[test]
fn every_block_of_keys_is_a_row() {
    let document = document(TEXT);
    let rows = document.key_rows();
    let names: Vec<&str> = rows.iter().map(|row| &*row.name).collect();
    assert_eq!(
        names,
        [
            "let wide",
            "PerspectiveCamera center",
            "PerspectiveCamera motion",
            "Transform Translate y",
            "Transform YRotate",
            "Disk radius"
        ]
    );
    let low = named(&rows, "Transform Translate y");
    assert_eq!((low.interpolation, low.outside), (Interpolation::Linear, Outside::Loop));
    let times: Vec<(f64, f64, f64)> = low.keys.iter().map(|k| (k.frame, k.seconds, k.values[0])).collect();
    assert_eq!(times, [(1.0, 0.0, 0.0), (3.5, 0.25, 1.0), (6.0, 0.5, 0.0)]);
    assert!(matches!(&low.owner, KeyOwner::Field { key, first: 1, nth: 0, .. } if key == "Translate"));
    assert_eq!((low.key_at(6.0), low.key_at(5.0)), (Some(2), None));
    let eye = named(&rows, "PerspectiveCamera center");
    assert_eq!((eye.interpolation, &eye.keys[1].values[..]), (Interpolation::Cubic, &[2.0, 1.0, 9.0][..]));
    assert_eq!(named(&rows, "PerspectiveCamera motion").keys[1].frame, 11.0);
    assert!(named(&rows, "Disk radius").is_repeated && !eye.is_repeated);
    assert_eq!(&TEXT[eye.span.1.clone()], "keys cubic { 0: 0 1 9  1: 2 1 9 }");
}

#[test]
fn rows_are_known_again_at_another_frame() {
    let mut document = document(TEXT);
    let before = document.key_rows();
    document.show_frame(12);
    assert_eq!(document.key_rows(), before);
}

const CAMERA: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }";

/// A ball with these values, at a frame of an animation of ten frames a second.
fn ball(values: &str, frame: i64) -> (Document, NodeId) {
    let mut document = document(&scene(values));
    document.show_frame(frame);
    let id = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
    (document, id)
}

fn scene(values: &str) -> String {
    format!(
        "Animation {{ fps 10 }} {CAMERA} let r = 0.5  let t = 2 * time  let k = keys {{ 0: 1  1: 2 }}
Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0  Sphere ball {{ {values} }} }}"
    )
}

/// Does it; returns the values of the ball then, and that undo brings every byte back.
fn done(document: &mut Document, edit: &Edit) -> Result<String, String> {
    let before = document.text().to_owned();
    let applied = document.apply(edit).map_err(|refused| refused.to_string());
    let text = document.text().to_owned();
    if applied.is_err() {
        assert_eq!(text, before);
    }
    applied?;
    document.compile();
    assert!(document.is_current(), "{}", document.report(false));
    let frame = document.timing().frame;
    assert!(document.undo() || text == before);
    assert_eq!(document.text(), before);
    document.redo();
    assert_eq!((document.text(), document.timing().frame), (&*text, frame));
    let start = text.find("Sphere ball { ").unwrap() + "Sphere ball { ".len();
    Ok(text[start..text.rfind(" } }").unwrap()].to_owned())
}

fn set(values: &str, frame: i64, key: &str, numbers: &[f64]) -> Result<String, String> {
    let (mut document, ball) = ball(values, frame);
    done(&mut document, &Edit::set(ball, key, FieldValue::numbers(numbers.iter().copied())))
}

fn key(values: &str, frame: i64, key: &str, value: Option<&[f64]>) -> Result<String, String> {
    let (mut document, ball) = ball(values, frame);
    let value = value.map(|numbers| FieldValue::numbers(numbers.iter().copied()));
    done(&mut document, &Edit::SetKey { node: ball, key: key.to_owned(), nth: None, value })
}

#[test]
fn to_set_a_value_with_keys_sets_the_key_at_the_frame() {
    let keyed = "center 0 0 0  radius keys cubic { 0: 1 /* one */  1: 2 }  /* end */";
    let changed = |from: &str, to: &str| Ok(keyed.replace(from, to));
    assert_eq!(set(keyed, 1, "radius", &[1.5]), changed("0: 1", "0: 1.5"));
    assert_eq!(set(keyed, 11, "radius", &[1.5]), changed("1: 2", "1: 1.5"));
    assert_eq!(set(keyed, 6, "radius", &[3.0]), changed("0: 1 ", "0: 1  0.5: 3 "));
    assert_eq!(set(keyed, -9, "radius", &[3.0]), changed("0: 1", "-1: 3  0: 1"));
    assert_eq!(set(keyed, 14, "radius", &[3.0]), changed("1: 2", "1: 2  1.3: 3"));
    assert_eq!(set(keyed, 1, "radius", &[1.0]), Ok(keyed.to_owned()), "what it is already");
    // Of several numbers each has its own keys, or none.
    let mixed = "center 1 keys { 0: 2 3  1: 4 5 }  radius 1";
    assert_eq!(
        set(mixed, 1, "center", &[7.0, 2.0, 8.0]),
        Ok("center 7 keys { 0: 2 8  1: 4 5 }  radius 1".into())
    );
    assert_eq!(
        set(mixed, 6, "center", &[1.0, 3.0, 8.0]),
        Ok("center 1 keys { 0: 2 3  0.5: 3 8  1: 4 5 }  radius 1".into())
    );
    // On lines of their own they stay so.
    let lines = "center 0 0 0  radius keys {\n    0: 1 # one\n    1: 2\n  }";
    let expected = "center 0 0 0  radius keys {\n    0: 1 # one\n    0.5: 3\n    1: 2\n  }";
    assert_eq!(set(lines, 6, "radius", &[3.0]), Ok(expected.to_owned()));
}

#[test]
fn keys_of_a_named_value_are_set_where_it_is_written() {
    let keyed = "center 0 k k  radius k";
    let (mut document, id) = ball(keyed, 6);
    let with =
        |keys: &str| scene(keyed).replace("k = keys { 0: 1  1: 2 }", &format!("k = keys {{ {keys} }}"));
    assert_eq!(document.keying(id, "radius", 0), Keying::Keyed { at_frame: false });
    done(&mut document, &Edit::set(id, "radius", FieldValue::numbers([3.0]))).unwrap();
    assert_eq!(document.text(), with("0: 1  0.5: 3  1: 2"));
    assert_eq!(document.keying(id, "radius", 0), Keying::Keyed { at_frame: true });
    assert_eq!(document.keys_here(id, "radius", 0)[0].1, 1);
    done(&mut document, &Edit::set(id, "center", FieldValue::numbers([0.0, 4.0, 4.0]))).unwrap();
    assert_eq!(document.text(), with("0: 1  0.5: 4  1: 2"));
    let refused = document.apply(&Edit::set(id, "center", FieldValue::numbers([0.0, 5.0, 6.0]))).unwrap_err();
    assert_eq!(refused.to_string(), "one value with keys stands for several numbers, which would differ");
    document.show_frame(11);
    let edit = Edit::SetKey { node: id, key: "center".into(), nth: None, value: None };
    let all = done(&mut document, &edit).unwrap();
    assert_eq!(all, "center keys { 1: 0 } k k  radius k");
    let here = document.keys_here(id, "center", 0);
    assert_eq!(here.iter().map(|(_, index)| *index).collect::<Vec<_>>(), [0, 2, 2]);
}

#[test]
fn keys_that_go_on_are_set_in_their_first_run() {
    let keyed = "center 0 0 0  radius keys loop { 0: 1  1: 2 }";
    assert_eq!(set(keyed, 11, "radius", &[3.0]), Ok(keyed.replace("0: 1", "0: 3")), "the last is never seen");
    assert_eq!(set(keyed, 16, "radius", &[3.0]), Ok(keyed.replace("0: 1", "0: 1  0.5: 3")));
    let back = "center 0 0 0  radius keys pingpong { 0: 1  1: 2 }";
    assert_eq!(set(back, 19, "radius", &[3.0]), Ok(back.replace("0: 1", "0: 1  0.2: 3")));
}

#[test]
fn what_is_computed_is_refused() {
    let refused = |values: &str, frame, numbers: &[f64]| set(values, frame, "radius", numbers).unwrap_err();
    let written = |text: &str| format!("it is written as `{text}`: change that in the text");
    assert_eq!(refused("center 0 0 0  radius keys { 0: (2 * r)  1: 2 }", 1, &[3.0]), written("(2 * r)"));
    assert_eq!(refused("center 0 0 0  radius 1 + time", 1, &[3.0]), written("1 + time"));
    let why = |values: &str, name: &str| key(values, 6, name, None).unwrap_err();
    assert_eq!(why("center 0 0 0  radius 1 + time", "radius"), written("1 + time"));
    assert_eq!(why("center 0 t 0  radius 1", "center"), written("t"));
    assert_eq!(why("center 0 (2 * k) 0  radius 1", "center"), written("(2 * k)"));
    assert_eq!(why("center keys { 0: 1  1: 2 } 0 t  radius 1", "center"), written("t"));
    let (document, _) = ball("center 0 0 0  radius 1", 1);
    let node = |word: &str| document.outline().nodes().iter().find(|node| &*node.keyword == word).unwrap().id;
    let fixed = |word: &str, key: &str| match document.keying(node(word), key, 0) {
        Keying::Fixed(why) => why,
        other => panic!("{other:?}"),
    };
    assert_eq!(fixed("Animation", "fps"), "the frames of a scene are the same at all times");
    let settings = self::document(&format!("{CAMERA} Settings {{ integrator path }} Group {{ }}"));
    let node = settings.outline().nodes().iter().find(|node| &*node.keyword == "Settings").unwrap().id;
    assert_eq!(settings.keying(node, "integrator", 0), Keying::Fixed("only numbers can have keys".into()));
}

#[test]
fn the_keys_of_a_model_are_in_its_file() {
    let text = format!("{CAMERA} Group {{ Model {{ file fox.glb  animation Run  animationTime 0.4 }} }}");
    let document = Document::untitled(Path::new("."), &text, LoadOptions::default()).unwrap();
    let model = document.outline().nodes().iter().find(|node| &*node.keyword == "Model").unwrap().id;
    let Keying::Fixed(why) = document.keying(model, "animation", 0) else { panic!() };
    assert!(why.contains("are in its file; `animationTime` can have some"), "{why}");
    assert_eq!(document.keying(model, "animationTime", 0), Keying::Still);
    assert_eq!(document.keying(model, "file", 0), Keying::Fixed("only numbers can have keys".into()));
}

#[test]
fn a_first_key_takes_the_place_of_a_value() {
    assert_eq!(
        key("center 0 0 0  radius 1 /* wide */", 6, "radius", None),
        Ok("center 0 0 0  radius keys { 0.5: 1 } /* wide */".into())
    );
    assert_eq!(
        key("center r /* up */ 0  2.50  radius 1", 1, "center", Some(&[0.5, 1.0, 2.5])),
        Ok("center keys { 0: r /* up */ 1  2.50 }  radius 1".into()),
        "what stays is written as it was"
    );
    assert_eq!(
        key("center 0 keys { 0: 0  1: 1 } 0  radius 1", 6, "center", None),
        Ok("center keys { 0.5: 0 } keys { 0: 0  0.5: 0.5  1: 1 } keys { 0.5: 0 }  radius 1".into())
    );
    let (document, id) = ball("center 0 keys { 0: 0  1: 1 } 0  radius 1", 1);
    assert_eq!(document.keying(id, "center", 0), Keying::Keyed { at_frame: true });
    assert_eq!(document.keying(id, "radius", 0), Keying::Still);
    // One that is absent, and one of whole numbers.
    let mut document =
        self::document(&format!("{CAMERA} Settings {{ }} Materials {{ Matte {{ }} }} Group {{ }}"));
    let of = |word: &str| document.outline().nodes().iter().find(|node| &*node.keyword == word).unwrap().id;
    let (matte, settings) = (of("Matte"), of("Settings"));
    let set = |node, key: &str| Edit::SetKey { node, key: key.into(), nth: None, value: None };
    document.apply(&set(matte, "color")).unwrap();
    document.apply(&set(settings, "bounces")).unwrap();
    let text = document.text().to_owned();
    assert!(text.contains("Matte { color keys { 0: 0.8 0.8 0.8 } }"), "{text}");
    assert!(text.contains("bounces keys step { 0: "), "{text}");
}

#[test]
fn times_have_as_many_digits_as_they_need() {
    for (fps, frame, expected) in [
        (24.0, 2, "0.041666667"),
        (25.0, 2, "0.04"),
        (24.0, 25, "1"),
        (30.0, 0, "-0.033333333"),
        (23.976, 2, "0.041708375"),
    ] {
        let text = format!(
            "Animation {{ fps {fps} }} {CAMERA} Materials {{ Matte {{ }} }}
            Group {{ MaterialIndex 0  Sphere ball {{ center 0 0 0  radius 1 }} }}"
        );
        let mut document = document(&text);
        document.show_frame(frame);
        let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        let edit = Edit::SetKey { node: ball, key: "radius".into(), nth: None, value: None };
        document.apply(&edit).unwrap();
        assert!(document.text().contains(&format!("keys {{ {expected}: 1 }}")), "{}", document.text());
        assert_eq!(document.key_rows()[0].keys[0].frame, frame as f64);
    }
}

/// The keys of these indices of the ball's radius.
fn keys_of(document: &Document, indices: &[usize]) -> Vec<(KeyOwner, usize)> {
    let rows = document.key_rows();
    let owner = &named(&rows, "ball radius").owner;
    indices.iter().map(|&index| (owner.clone(), index)).collect()
}

fn moved(values: &str, indices: &[usize], frames: f64) -> Result<String, String> {
    let (mut document, _) = ball(values, 1);
    let keys = keys_of(&document, indices);
    done(&mut document, &Edit::MoveKeys { keys, frames })
}

#[test]
fn keys_are_moved_to_other_frames() {
    let keyed = "center 0 0 0  radius keys { 0: 1.0 /* one */  1: 2 # two\n  2: r }";
    let changed = |from: &str, to: &str| Ok(keyed.replace(from, to));
    assert_eq!(moved(keyed, &[1], 3.0), changed("1: 2", "1.3: 2"));
    assert_eq!(moved(keyed, &[0, 2], 3.0), Ok(keyed.replace("0: 1.0", "0.3: 1.0").replace("2: r", "2.3: r")));
    assert_eq!(moved(keyed, &[0], 0.0), Ok(keyed.to_owned()));
    // Beyond another one they change places; what stands between them stays.
    assert_eq!(
        moved(keyed, &[0], 15.0),
        Ok("center 0 0 0  radius keys { 1: 2 /* one */  1.5: 1.0 # two\n  2: r }".into())
    );
    // One that is there gives way.
    assert_eq!(
        moved(keyed, &[0], 10.0),
        Ok("center 0 0 0  radius keys { 1: 1.0 /* one */ # two\n  2: r }".into())
    );
    // Onto whole frames.
    let between = "center 0 0 0  radius keys { 0.04: 1  0.07: 2 }";
    assert_eq!(moved(between, &[0], 2.0), Ok(between.replace("0.04: 1  0.07: 2", "0.07: 2  0.2: 1")));
    assert_eq!(moved(between, &[1], 2.0), Ok(between.replace("0.07", "0.3")));
    let near = "center 0 0 0  radius keys { 0.01: 1  0.02: 2 }";
    assert_eq!(moved(near, &[0, 1], 2.0), Err("two keys cannot both be at frame 3".into()));
    let computed = "center 0 0 0  radius keys { r: 1  1: 2 }";
    assert_eq!(moved(computed, &[0], 1.0), Err("it is written as `r`: change that in the text".into()));
    assert_eq!(moved(computed, &[1], 1.0), Ok(computed.replace("1: 2", "1.1: 2")));
}

#[test]
fn keys_are_taken_out_and_the_last_leaves_a_value() {
    let deleted = |values: &str, indices: &[usize], frame| {
        let (mut document, _) = ball(values, frame);
        let keys = keys_of(&document, indices);
        done(&mut document, &Edit::DeleteKeys(keys))
    };
    let keyed = "center 0 0 0  radius keys { 0: 1 /* one */  1: 2  2: 4 }";
    assert_eq!(deleted(keyed, &[1], 1), Ok(keyed.replace("  1: 2", "")));
    assert_eq!(deleted(keyed, &[0, 2], 1), Ok("center 0 0 0  radius keys { /* one */  1: 2 }".into()));
    assert_eq!(deleted(keyed, &[0, 1, 2], 6), Ok("center 0 0 0  radius 1.5".into()));
    let lines = "center 0 0 0  radius keys {\n    0: 1\n    1: 2\n  }";
    assert_eq!(deleted(lines, &[0], 1), Ok(lines.replace("    0: 1\n", "")));
    // Those of a named value leave its number, and those of a `Motion` are two at least.
    let mut document = document(TEXT);
    let rows = document.key_rows();
    let all = |name: &str| (0..2).map(|index| (named(&rows, name).owner.clone(), index)).collect::<Vec<_>>();
    let motion =
        document.apply(&Edit::DeleteKeys(all("PerspectiveCamera motion")[..1].to_vec())).unwrap_err();
    assert_eq!(motion.to_string(), "a `Motion` has two keys at least, each a `key`: take out all of it");
    document.apply(&Edit::DeleteKeys(all("let wide"))).unwrap();
    assert_eq!(document.text(), TEXT.replace("wide = keys { 0: 1  1: 2 }", "wide = 1"));
}

#[test]
fn the_keys_of_a_motion_move_and_say_how_else_they_are_edited() {
    let mut document = document(TEXT);
    let owner = named(&document.key_rows(), "PerspectiveCamera motion").owner.clone();
    document.apply(&Edit::MoveKeys { keys: vec![(owner.clone(), 1)], frames: 5.0 }).unwrap();
    assert_eq!(document.text(), TEXT.replace("key 1 {", "key 1.5 {"));
    document.undo();
    document.apply(&Edit::MoveKeys { keys: vec![(owner.clone(), 0)], frames: 15.0 }).unwrap();
    assert_eq!(
        document.text(),
        TEXT.replace("key 0 { }  key 1 { Translate 1 0 0 }", "key 1 { Translate 1 0 0 }  key 1.5 { }")
    );
    let edit = Edit::SetKeyModes { owner, interpolation: Some(Interpolation::Step), outside: None };
    assert!(document.apply(&edit).unwrap_err().to_string().starts_with("a `Motion` goes steadily"));
}

#[test]
fn how_keys_go_on_is_one_word() {
    let modes = |values: &str, interpolation, outside| {
        let (mut document, _) = ball(values, 1);
        let owner = named(&document.key_rows(), "ball radius").owner.clone();
        done(&mut document, &Edit::SetKeyModes { owner, interpolation, outside })
    };
    let keyed = "center 0 0 0  radius keys { 0: 1  1: 1 }";
    let words = |words: &str| Ok(keyed.replace("keys", words));
    assert_eq!(modes(keyed, Some(Interpolation::Cubic), None), words("keys cubic"));
    assert_eq!(modes(keyed, Some(Interpolation::Linear), None), words("keys"), "it is so");
    assert_eq!(modes(keyed, Some(Interpolation::Step), Some(Outside::Loop)), words("keys step loop"));
    let modal = keyed.replace("keys", "keys /* so */ loop  cubic");
    assert_eq!(modes(&modal, Some(Interpolation::Monotone), None), Ok(modal.replace("cubic", "monotone")));
    assert_eq!(modes(&modal, None, Some(Outside::Hold)), Ok(modal.replace("loop", "hold")));
    assert_eq!(
        modes(&modal, Some(Interpolation::Step), Some(Outside::PingPong)),
        words("keys /* so */ pingpong  step")
    );
}

#[test]
fn what_is_dragged_in_space_gets_keys_too() {
    let (mut document, id) = ball("center keys { 0: 0 0 0  1: 2 0 0 }  radius 1", 6);
    let movement = crate::Movement::Translate(kajo_math::DVec3::Y);
    let moved = done(&mut document, &Edit::Move { node: id, movement });
    assert_eq!(moved, Ok("center keys { 0: 0 0 0  0.5: 1 1 0  1: 2 0 0 }  radius 1".into()));
    // In a drag each step starts from the text before it.
    document.begin_gesture("drag");
    for y in [0.5, 0.25] {
        let movement = crate::Movement::Translate(kajo_math::DVec3::new(0.0, y, 0.0));
        document.apply(&Edit::Move { node: id, movement }).unwrap();
    }
    document.end_gesture();
    assert!(document.text().contains("0.5: 1 1.25 0"), "{}", document.text());
    // A `Scale` with one number would have three.
    let text = format!(
        "{CAMERA} Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0
        Transform {{ UniformScale keys {{ 0: 1  1: 2 }}  Sphere ball {{ center 0 0 0  radius 1 }} }} }}"
    );
    let mut document = self::document(&text);
    let node = document.outline().nodes().iter().find(|node| &*node.keyword == "Transform").unwrap().id;
    let scale = |factors| crate::Movement::Scale {
        center: kajo_math::DVec3::ZERO,
        axes: kajo_math::DMat3::IDENTITY,
        factors,
    };
    let uneven = Edit::Move { node, movement: scale(kajo_math::DVec3::new(1.0, 2.0, 1.0)) };
    let refused = document.apply(&uneven).unwrap_err().to_string();
    assert_eq!(refused, "`UniformScale` has keys, which that would take away");
    document.apply(&Edit::Move { node, movement: scale(kajo_math::DVec3::splat(3.0)) }).unwrap();
    assert!(document.text().contains("keys { 0: 3  1: 2 }"), "{}", document.text());
}

#[test]
fn other_words_do_not_take_the_place_of_keys() {
    let text =
        format!("{CAMERA} Materials {{ Matte {{ color keys {{ 0: 1 0 0  1: 0 1 0 }} }} }} Group {{ }}");
    let mut document = document(&text);
    let matte = document.outline().nodes().iter().find(|node| &*node.keyword == "Matte").unwrap().id;
    let refused = document.apply(&Edit::set(matte, "color", FieldValue::word("gold"))).unwrap_err();
    assert_eq!(refused.to_string(), "`color` has keys, and those have other numbers: take it out first");
    document.apply(&Edit::Unset { node: matte, key: "color".into(), nth: None }).unwrap();
    assert!(document.text().contains("Matte { }"));
}

#[test]
fn what_is_repeated_has_its_keys_in_one_text() {
    let mut document = document(TEXT);
    let rows = document.key_rows();
    let disk = named(&rows, "Disk radius");
    document.apply(&Edit::MoveKeys { keys: vec![(disk.owner.clone(), 1)], frames: 10.0 }).unwrap();
    assert_eq!(document.text(), TEXT.replace("{ 0: 1  1: i }", "{ 0: 1  2: i }"));
    let disks: Vec<NodeId> = document
        .outline()
        .nodes()
        .iter()
        .filter(|node| &*node.keyword == "Disk")
        .map(|node| node.id)
        .collect();
    document.apply(&Edit::set(disks[2], "radius", FieldValue::numbers([3.0]))).unwrap();
    assert_eq!(document.text(), TEXT.replace("{ 0: 1  1: i }", "{ 0: 3  2: i }"));
}

/// Values that stand for each other, and are named again by each turn, are each looked up once.
#[test]
fn names_that_stand_for_names_are_followed_once() {
    let chain: String = (1..30).map(|i| format!("  let n{i} = n{} + 0 * n{}\n", i - 1, i - 1)).collect();
    let keying = |first: &str| {
        let turns =
            format!("repeat i 20 {{\n  let n0 = {first}\n{chain}  Sphere {{ center i 0 0  radius n29 }}\n}}");
        let materials = "Materials { Matte red { color 1 0 0 } }";
        let document = document(&format!("{CAMERA} {materials} Group {{ MaterialIndex red {turns} }}"));
        let node = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        document.keying(node, "radius", 0)
    };
    assert!(matches!(keying("1 + time"), Keying::Fixed(_)));
    assert_eq!(keying("1 + i"), Keying::Still);
}

#[test]
fn new_keys_of_a_motion_change_nothing_and_say_where_things_are() {
    let motion = |keys: &str| {
        document(&format!(
            "Animation {{ fps 10  frames 1 30 }}\nPerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }}
Materials {{ Matte red {{ color 0.8 0.1 0.1 }} }}
Group {{ MaterialIndex red Transform {{ Motion {{ {keys} }} Sphere {{ center 0 0 0  radius 1 }} }} }}\n"
        ))
    };
    let maps = |document: &Document| {
        let rows = document.tree.outline.nodes().iter().find(|node| &*node.keyword == MOTION).unwrap();
        let keys: Vec<_> = document
            .tree
            .motion_keys(rows)
            .map(|item| {
                let map = kajo_core::compile::operations_matrix(item.children(), false);
                (item.numbers().next().unwrap().0, map)
            })
            .collect();
        kajo_math::Keyframes::new(&keys).unwrap()
    };
    for (keys, frame, expected) in [
        ("key 0 { }  key 1 { Translate 1 0 0 }", 6, Some("key 0.5 { Translate 0.5 0 0 }")),
        ("key 0 { }  key 1 { YRotate 90 }", 6, Some("key 0.5 { YRotate 45 }")),
        ("key 0 { }  key 1 { YRotate -90 }", 3, Some("key 0.2 { YRotate -18 }")),
        ("key 0 { }  key 1 { UniformScale 2 }", 21, Some("key 2 { UniformScale 2 }")),
        ("key 1 { }  key 2 { Translate 0 1 0 }", 1, Some("key 0 { }")),
        ("key 0 { }  key 1 { Scale 1 2 3 Translate 0 1 0 }", 6, None),
        ("key 0 { YRotate 10 }  key 1 { Rotate 0.6 0 0.8 70  Translate 0 1 2  Scale 1 2 1 }", 4, None),
        ("key 0 { }  key 1 { Matrix { 1 0 0 0  0.5 1 0 0  0 0 1 0  0 3 0 1 } }", 9, None),
    ] {
        let mut document = motion(keys);
        document.show_frame(frame);
        document.compile();
        let before = maps(&document);
        let owner = named(&document.key_rows(), "Transform motion").owner.clone();
        let rows = named(&document.key_rows(), "Transform motion").keys.len();
        document.apply(&Edit::InsertKey(owner.clone())).unwrap_or_else(|error| panic!("{keys}: {error}"));
        if let Some(expected) = expected {
            assert!(document.text().contains(expected), "{keys}: {}", document.text());
        }
        document.compile();
        assert!(document.is_current(), "{}", document.report(false));
        assert_eq!(named(&document.key_rows(), "Transform motion").keys.len(), rows + 1);
        let after = maps(&document);
        // Of what shears, more keys are nearer to the straight way of its size than fewer; where the key stands all is as it was.
        let at = f64::from(frame as i32 - 1) / 10.0;
        assert!(
            after.at(at).abs_diff_eq(before.at(at), 1e-5),
            "{keys}: {:?} {:?}",
            after.at(at),
            before.at(at)
        );
        let again = document.apply(&Edit::InsertKey(owner)).unwrap_err().to_string();
        assert_eq!(again, "there is a key at this frame already");
    }
}

#[test]
fn new_keys_of_a_value_are_what_it_is() {
    let mut document = document(TEXT);
    document.show_frame(6);
    document.compile();
    let owner = named(&document.key_rows(), "let wide").owner.clone();
    document.apply(&Edit::InsertKey(owner)).unwrap();
    assert!(document.text().contains("keys { 0: 1  0.5: 1.5  1: 2 }"), "{}", document.text());
}

#[test]
fn the_keys_of_a_model_are_a_row() {
    let folder = tempfile::tempdir().unwrap();
    kajo_testkit::write_walker(folder.path(), [0.5, 1.0, 2.0]).unwrap();
    let rows = |frames: &str, keys: &str| {
        let text = format!(
            "{frames} PerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }}
Materials {{ Matte red {{ }} }} Group {{ MaterialIndex red repeat i 2 {{ Model fox {{ file walker.gltf {keys} }} }} }}"
        );
        let mut document = Document::untitled(folder.path(), &text, LoadOptions::default()).unwrap();
        document.compile();
        assert!(document.is_current(), "{}", document.report(false));
        let node = document.outline().nodes().iter().find(|node| &*node.keyword == "Model").unwrap().id;
        let rows = document.model_rows().to_vec();
        assert!(rows.iter().all(|row| row.node == node));
        rows.into_iter().map(|row| (row.name, row.frames)).collect::<Vec<_>>()
    };
    let film = "Animation { fps 10  frames 3 30 }";
    assert_eq!(rows(film, ""), [("fox: walk".to_owned(), vec![8.0, 13.0, 23.0])]);
    // Where it does not follow the frames, and where there are none, it has none.
    assert_eq!(rows(film, "animationTime (2 * time)"), []);
    assert_eq!(rows("", ""), []);
}
