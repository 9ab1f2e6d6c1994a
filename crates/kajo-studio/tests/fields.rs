//! Fields that are absent, by script: they show what holds, dimmed, and the first nudge starts from there.

mod common;

use common::{SCENE, Window};
use egui::{PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
use kajo_edit::FieldValue;
use kajo_studio::state::Action;

/// What is written for a key in the block that begins with `head`.
fn value_of(text: &str, head: &str, key: &str) -> Option<f64> {
    let block = text.split(head).nth(1)?.split('}').next()?;
    block.split(&format!(" {key} ")).nth(1)?.split_whitespace().next()?.parse().ok()
}

/// Whether there is a row of that name.
fn has_row(window: &mut Window, name: &str) -> bool {
    window.harness.query_all_by_label(name).next().is_some()
}

#[test]
fn what_is_not_set_is_under_more() {
    let mut window = Window::new();
    window.select("red");
    assert!(has_row(&mut window, "Diffuse color") && has_row(&mut window, "Reflective color"));
    assert!(!has_row(&mut window, "Opacity"), "it is folded away");
    window.press("More (13)");
    window.frames(20);
    assert!(has_row(&mut window, "Opacity") && has_row(&mut window, "Specular color"));
    assert!(has_row(&mut window, "only with Emission"));
    // What has to be there comes first, also in blocks of which nothing else is set.
    window.select("sun");
    assert!(has_row(&mut window, "Direction"));
}

#[test]
fn the_first_nudge_starts_from_the_default() {
    let mut window = Window::new();
    window.select("red");
    window.press("More (13)");
    window.frames(20);
    window.harness.get_all_by_label("Index of refraction").next().unwrap().scroll_to_me();
    window.frames(20);
    let widget = window.widget("Index of refraction");
    // While it is dragged it stays where it is.
    window.button(widget, PointerButton::Primary, true);
    for step in 1..=10 {
        window.harness.event(egui::Event::PointerMoved(widget + vec2(2.0 * step as f32, 0.0)));
        window.frames(1);
        let moved = window.widget("Index of refraction");
        assert!(moved.distance(widget) < 2.0, "{moved:?} {widget:?}");
    }
    window.button(widget + vec2(20.0, 0.0), PointerButton::Primary, false);
    window.frames(10);
    let text = window.text();
    let index = value_of(&text, "PhongMaterial red", "indexOfRefraction").expect("it is written");
    assert!(index > 1.0 && index < 1.5, "from 1 upwards: {index}");
    assert!(window.harness.query_by_label("More (12)").is_some(), "it is among those that are set");
    window.studio().apply(Action::Undo);
    assert_eq!(window.text(), SCENE, "one step");
}

#[test]
fn every_absent_field_shows_what_holds_or_says_it_in_words() {
    let mut window = Window::new();
    let document = window.studio().document.as_ref().unwrap();
    let of = |name: &str| {
        let node =
            document.outline().nodes().iter().find(|node| node.name.as_deref() == Some(name)).unwrap().id;
        document.fields(node)
    };
    let red = of("red");
    let value = |key: &str| red.iter().find(|field| field.key == key).unwrap().value.clone();
    assert_eq!(value("opacity"), Some(FieldValue::numbers([1.0])));
    assert_eq!(value("ambientColor"), Some(FieldValue::numbers([0.9, 0.1, 0.1])), "the diffuse one");
    assert_eq!(value("emission"), Some(FieldValue::numbers([0.0; 3])));
    let all = document.outline().nodes().iter().flat_map(|node| document.fields(node.id));
    for field in all.filter(|field| field.span.is_none()) {
        assert!(field.value.is_some() || field.idle.is_some() || !field.means.is_empty(), "{field:?}");
    }
}

#[test]
fn what_no_value_says_is_set_to_a_usual_one() {
    let scene = SCENE.replace("Group {", "Settings { samples regular 1 }\r\nGroup {");
    let mut window = Window::with(&scene, false);
    let document = window.studio().document.as_ref().unwrap();
    let node = document.outline().nodes().iter().find(|node| &*node.keyword == "Settings").unwrap().id;
    window.studio().apply(Action::Select(vec![node]));
    window.frames(3);
    // Behind it are the keys that the scene does not have.
    window.harness.get_by_label_contains("More (").click();
    window.frames(20);
    // Lists show the word that holds.
    let integrator = window.harness.get_all_by_label("Integrator").last().unwrap();
    assert_eq!(integrator.value().as_deref(), Some("Classic"));
    assert!(window.harness.query_by_label_contains("Other").is_none());
    window.harness.get_by_label("Set reach").scroll_to_me();
    window.frames(20);
    window.press("Set reach");
    assert_eq!(value_of(&window.text(), "Settings", "reach"), Some(1.0));
}

#[test]
fn whole_numbers_stay_whole_when_they_are_dragged() {
    let mut window = Window::with(&SCENE.replace("Group {", "Settings { }\r\nGroup {"), false);
    let document = window.studio().document.as_ref().unwrap();
    let node = document.outline().nodes().iter().find(|node| &*node.keyword == "Settings").unwrap().id;
    window.studio().apply(Action::Select(vec![node]));
    window.frames(3);
    let widget = window.widget("Samples");
    window.drag(PointerButton::Primary, widget, vec2(37.0, 0.0));
    let text = window.text();
    let samples =
        text.split("samples jittered ").nth(1).expect("it is written").split_whitespace().next().unwrap();
    assert!(samples.parse::<u32>().is_ok_and(|samples| samples > 16), "{samples}");
    assert_eq!(window.studio().n_errors(), 0);
}

/// A hole in a space, and a ball that rides past it; select the one by its name, the other as the only `Lorentz`.
const CURVED: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 40 }
Background { color 0.2 0.2 0.2 }
Media { BlackHole hole { mass 1  spin 0.3 } }
Materials { Interface space { medium hole }  Matte grey { color 0.5 0.5 0.5 } }
Group ride { Lorentz boost { velocity 0.3 0 -0.4  MaterialIndex grey  Sphere { center 0 0 -3 radius 0.5 } } }
";

/// Mass, spin and the length of a velocity have sliders, whose drag is one step and keeps the direction.
#[test]
fn sliders_try_masses_and_speeds() {
    let mut window = Window::with(CURVED, false);
    window.select("hole");
    let widget = window.widget("Mass");
    window.drag(PointerButton::Primary, widget, vec2(12.0, 0.0));
    let text = window.text();
    let mass = value_of(&text, "BlackHole hole", "mass").unwrap();
    assert!(mass > 1.2 && mass < 100.0, "{mass}");
    assert_eq!(text.replace(&format!("mass {mass} "), "mass 1 "), CURVED);
    window.studio().apply(Action::Undo);
    assert_eq!(window.text(), CURVED);

    window.select("boost");
    let widget = window.widget("Velocity");
    window.drag(PointerButton::Primary, widget, vec2(25.0, 0.0));
    let text = window.text();
    let numbers = text.split("velocity ").nth(1).unwrap().split_whitespace().take(3);
    let [x, y, z] = numbers.map(|v| v.parse::<f64>().unwrap()).collect::<Vec<_>>()[..] else {
        panic!("{text}")
    };
    let speed = x.hypot(z);
    assert!(
        y == 0.0 && (x / z + 0.75).abs() < 1e-3 && speed < 1.0 && (speed - 0.5).abs() > 0.02,
        "{x} {y} {z}"
    );
}

const RAMP: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 40 }
Background { color 0.3 0.3 0.3  ambientLight 1 1 1 }
Textures { Cells m { }  Ramp land { texture m  stop 0 1 0 0  stop 0.5 0 1 0  stop 1 0 0 1 } }
Materials { Matte grey { color land } }
Group { MaterialIndex grey  Sphere { center 0 0 0  radius 1 } }
";

/// Stops of a ramp are dragged as far as their neighbours, as one step; a click adds one of the colour that is there; rows take them out.
#[test]
fn ramps_are_edited_by_their_bar() {
    let mut window = Window::with(RAMP, false);
    window.select("land");
    // Its picture makes room for itself above the bar.
    window.wait(|studio| !studio.is_drawing_swatches());
    window.frames(2);
    let mark = window.widget("Mark 2");
    window.drag(PointerButton::Primary, mark, vec2(400.0, 0.0));
    assert_eq!(window.text(), RAMP.replace("stop 0.5 0 1 0", "stop 1 0 1 0"), "no further than the next one");
    window.studio().apply(Action::Undo);
    assert_eq!(window.text(), RAMP);
    window.frames(5);

    let [first, second] = ["Mark 1", "Mark 2"].map(|name| window.widget(name));
    let on_bar = first + 0.5 * (second - first) - vec2(0.0, 14.0);
    window.click(on_bar);
    window.frames(5);
    let text = window.text();
    let added = text.split("stop ").nth(2).unwrap();
    let numbers: Vec<f64> = added.split_whitespace().map(|v| v.parse().unwrap()).collect();
    assert!((numbers[0] - 0.25).abs() < 0.02 && (numbers[1] - 0.5).abs() < 0.05, "{text}");
    assert!((numbers[2] - 0.5).abs() < 0.05 && numbers[3] == 0.0, "{text}");
    window.press("Remove stop 2");
    window.frames(5);
    assert_eq!(window.text(), RAMP);
}

/// A texture, a material that shows it and a field that names it have pictures of it in the panel; a plain material has none.
#[test]
fn textures_have_swatches() {
    let scene = SCENE
        .replace("Materials {", "Textures { Checks checks { size 0.5 } }\nMaterials {")
        .replace("PhongMaterial grey { diffuseColor 0.5 0.5 0.5 }", "Matte grey { color checks }");
    let mut window = Window::with(&scene, false);
    let swatches = |window: &mut Window, name: &str, labels: &[(&str, usize)]| {
        window.select(name);
        window.wait(|studio| !studio.is_drawing_swatches());
        window.frames(3);
        for (label, count) in labels {
            let found = window.harness.query_all_by_label(label).count();
            assert_eq!(found, *count, "{label} with {name} selected");
        }
    };
    swatches(&mut window, "checks", &[("Swatch of checks", 1), ("Swatch of grey", 0)]);
    swatches(&mut window, "grey", &[("Swatch of checks", 1), ("Swatch of grey", 1)]);
    swatches(&mut window, "floor", &[("Swatch of checks", 1), ("Swatch of grey", 1)]);
    swatches(&mut window, "ball", &[("Swatch of checks", 0), ("Swatch of red", 0)]);
    // It follows an edit.
    swatches(&mut window, "checks", &[("Swatch of checks", 1)]);
    let node = window.studio().selection.main().unwrap();
    let before = window.studio().swatch_of(node).cloned().unwrap();
    let (key, value) = ("size".to_owned(), FieldValue::numbers([4.0]));
    window.studio().apply(Action::SetField { node, key, nth: 0, value });
    window.settle();
    window.wait(|studio| !studio.is_drawing_swatches());
    let after = window.studio().swatch_of(node).cloned().unwrap();
    assert!(after.width > before.width, "{:?} {:?}", before.width, after.width);
}
