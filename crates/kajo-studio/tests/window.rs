//! Keys, mouse and widgets of the window, each function by script, without a display or a graphics card.

mod common;

use common::{SCENE, Window};
use egui::{Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use kajo::{IntegratorName, SamplerKind, View};
use kajo_studio::shell::{Bottom, Tab};
use kajo_studio::state::{Action, PictureSize, Shown};

/// The middle of the picture.
fn middle(window: &mut Window) -> Pos2 {
    window.app().area().unwrap().rect.center()
}

#[test]
fn an_empty_window_says_what_to_do() {
    let mut window = Window::empty(false);
    window.key(Key::Enter);
    assert_eq!(window.notice(), "Open a scene first.");
    window.key(Key::E);
    window.key(Key::F);
    window.key(Key::Space);
    window.key_with(Modifiers::COMMAND, Key::Z);
    window.key(Key::F1);
    assert!(window.harness.query_by_label_contains("Shoot a debug ray").is_some(), "the list of keys");
    window.key(Key::Escape);
    window.frames(20);
    assert!(window.harness.query_by_label_contains("Shoot a debug ray").is_none());
}

#[test]
fn l_opens_a_scene_by_name() {
    let mut window = Window::empty(false);
    let path = window.path("other.txt");
    std::fs::write(&path, SCENE).unwrap();
    window.key(Key::L);
    window.write("no such file.txt");
    window.key(Key::Enter);
    assert!(window.harness.query_by_label("There is no such file.").is_some());
    window.key(Key::Escape);
    window.key(Key::L);
    window.write(&path.display().to_string());
    window.key(Key::Enter);
    window.wait(|studio| studio.scene().is_some());
    assert_eq!(window.studio().title(), "other.txt");
    window.frames(2);
    assert_eq!(window.app().layout.recent.len(), 1);
}

#[test]
fn a_dropped_file_is_opened() {
    #[derive(Debug)]
    struct Dropped(std::path::PathBuf);
    impl egui::DroppedFile for Dropped {
        fn path(&self) -> &std::path::Path {
            &self.0
        }
        fn bytes(&self) -> Result<Vec<u8>, String> {
            std::fs::read(&self.0).map_err(|error| error.to_string())
        }
    }
    let mut window = Window::empty(false);
    let path = window.path("dropped.txt");
    std::fs::write(&path, SCENE).unwrap();
    window.harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path)));
    window.wait(|studio| studio.scene().is_some());
    assert_eq!(window.studio().title(), "dropped.txt");
}

#[test]
fn enter_traces_and_space_switches() {
    let mut window = Window::new();
    assert_eq!(window.studio().shown, Shown::Preview);
    window.key(Key::Enter);
    assert_eq!(window.studio().shown, Shown::Traced);
    window.wait(|studio| studio.tracer.frame().is_some_and(|frame| frame.samples() == 16));
    let frame = window.studio().tracer.frame().unwrap();
    assert_eq!(frame.size(), window.app().area().unwrap().size);
    window.key(Key::Space);
    assert_eq!(window.studio().shown, Shown::Preview);
    window.key(Key::Space);
    assert_eq!(window.studio().shown, Shown::Traced);
    let again = window.studio().tracer.frame().unwrap();
    assert!(std::sync::Arc::ptr_eq(&frame, &again), "nothing has changed, so nothing is traced anew");
}

#[test]
fn a_change_starts_the_trace_anew_and_escape_stops_it() {
    let mut window = Window::new();
    window.studio().options.habits.endless = true;
    window.key(Key::Enter);
    window.wait(|studio| studio.tracer.frame().is_some());
    let first = window.studio().tracer.frame().unwrap().job();
    window.harness.key_down(Key::W);
    window.frames(3);
    window.harness.key_up(Key::W);
    window.wait(|studio| studio.tracer.frame().is_some_and(|frame| frame.job() > first));
    assert!(window.studio().progress().is_some());
    window.key(Key::Escape);
    window.wait(|studio| studio.progress().is_none());
    window.frames(5);
    assert!(window.studio().progress().is_none(), "what was stopped stays stopped");
    window.studio().options.habits.live = false;
    let job = window.studio().tracer.frame().unwrap().job();
    window.studio().options.asked.bounces = Some(1);
    window.frames(5);
    assert!(window.studio().progress().is_none() && window.studio().tracer.frame().unwrap().job() == job);
}

#[test]
fn the_course_keys_fly() {
    let mut window = Window::new();
    let eye = |window: &mut Window| window.studio().camera.eye();
    for (key, axis, sign) in [
        (Key::W, 2, -1.0),
        (Key::S, 2, 1.0),
        (Key::A, 0, -1.0),
        (Key::D, 0, 1.0),
        (Key::PageUp, 1, 1.0),
        (Key::PageDown, 1, -1.0),
    ] {
        let before = eye(&mut window);
        window.harness.key_down(key);
        window.frames(10);
        window.harness.key_up(key);
        window.frames(2);
        let moved = eye(&mut window) - before;
        assert!(moved[axis] * sign > 0.05, "{key:?} moved {moved}");
        assert!((moved.length() - moved[axis].abs()) < 1e-6, "{key:?} moved {moved}");
        let rest = eye(&mut window);
        window.frames(3);
        assert_eq!(eye(&mut window), rest);
    }
    window.key(Key::Home);
    assert_eq!(eye(&mut window).to_array(), [0.0, 1.0, 10.0]);
}

#[test]
fn the_mouse_looks_turns_shifts_and_sets_the_speed() {
    let mut window = Window::new();
    let at = middle(&mut window);
    window.drag(PointerButton::Secondary, at, vec2(80.0, 40.0));
    let forward = window.studio().camera.forward();
    assert!(forward.x > 0.2 && forward.y < -0.1, "right and down: {forward}");
    assert_eq!(window.studio().camera.eye().to_array(), [0.0, 1.0, 10.0]);
    window.key(Key::Home);
    let center = window.studio().navigation.center;
    window.drag(PointerButton::Primary, at, vec2(80.0, 0.0));
    let eye = window.studio().camera.eye();
    assert!(eye.x < -1.0 && (eye - center).length() > 1.0, "{eye}");
    window.key(Key::Home);
    let speed = window.studio().navigation.speed;
    window.wheel(at, 1.0, Modifiers::NONE);
    assert!(window.studio().navigation.speed > 1.1 * speed);
    window.wheel(at, -1.0, Modifiers::NONE);
    assert!((window.studio().navigation.speed / speed - 1.0).abs() < 0.02);
    let away = (window.studio().camera.eye() - center).length();
    window.wheel(at, 2.0, Modifiers::COMMAND);
    assert!((window.studio().camera.eye() - center).length() < 0.9 * away);
}

#[test]
fn a_click_selects_what_is_under_it() {
    let mut window = Window::new();
    let ball = window.point([-2.0, 1.0, 1.5]);
    window.click(ball);
    assert_eq!(window.selected(), ["Sphere ball"]);
    assert_eq!(window.app().layout.tab, Tab::Object);
    let crate_ = window.point([2.0, 1.0, 1.0]);
    window.click(crate_);
    assert_eq!(window.selected(), ["Box crate"]);
    let sky = window.app().area().unwrap().rect.left_top() + vec2(5.0, 5.0);
    window.click(sky);
    assert!(window.selected().is_empty());
    window.key(Key::F);
    assert!(window.studio().camera.eye().z.is_finite());
}

#[test]
fn e_shoots_a_debug_ray_and_lists_its_segments() {
    let mut window = Window::new();
    let ball = window.point([-2.0, 1.0, 1.5]);
    window.harness.hover_at(ball);
    window.frames(2);
    window.key(Key::E);
    let rays = window.studio().rays.clone().expect("a debug ray");
    assert!(rays.ray.segments.len() >= 3, "camera, shadow and mirror: {}", rays.ray.segments.len());
    assert_eq!(window.app().layout.bottom, Some(Bottom::Rays));
    assert!(window.harness.query_by_label("Segment 0 camera").is_some());
    let (object, material) = window.studio().names_of(&rays.ray.segments[0]);
    assert_eq!((object.as_str(), material.as_str()), ("ball #1", "red #1"));
    let lines = window.studio().lines().len();
    window.press("Segment 0 camera");
    assert_eq!(window.studio().rays.as_ref().unwrap().chosen, Some(0));
    window.press("Clear");
    assert!(window.studio().rays.is_none());
    assert!(window.studio().lines().len() < lines, "its lines are gone");
}

#[test]
fn the_outliner_selects_and_its_buttons_edit() {
    let mut window = Window::new();
    window.press("Sphere ball");
    assert_eq!(window.selected(), ["Sphere ball"]);
    let ball = window.studio().selection.main();
    window.press("Duplicate");
    assert_eq!(window.text().matches("Sphere").count(), 2);
    assert_ne!(window.studio().selection.main(), ball, "the copy is selected");
    window.press("Delete");
    assert_eq!(window.text().matches("Sphere").count(), 1);
    window.key_with(Modifiers::COMMAND, Key::Z);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), SCENE);
    window.key_with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    assert_eq!(window.text().matches("Sphere").count(), 2);
}

#[test]
fn blocks_are_added_from_the_menu() {
    let mut window = Window::new();
    let objects = window.studio().scene().unwrap().geometry.primitives.len();
    window.press("+ Add");
    window.press("Shape");
    window.press("Sphere");
    assert_eq!(window.studio().scene().unwrap().geometry.primitives.len(), objects + 1);
    assert!(window.selected()[0].starts_with("Sphere"));
    window.studio().apply(Action::Undo);
    assert_eq!(window.text(), SCENE);
}

#[test]
fn a_field_is_dragged_in_one_step_and_saved_without_another_byte() {
    let mut window = Window::new();
    window.select("ball");
    let widget = window.widget("Radius");
    window.drag(PointerButton::Primary, widget, vec2(60.0, 0.0));
    let text = window.text();
    assert_ne!(text, SCENE);
    let radius: f64 = text.split("radius ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(radius > 1.6, "{radius}");
    assert_eq!(text.replace(&format!("radius {radius} "), "radius 1.5 "), SCENE);
    window.key_with(Modifiers::COMMAND, Key::S);
    assert_eq!(window.read("scene.txt"), text);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), SCENE, "the whole drag is one step");
}

#[test]
fn what_is_saved_is_traced_as_the_window_showed_it() {
    let mut window = Window::new();
    window.select("ball");
    window.studio().options.habits.size = PictureSize::Fixed([64, 48]);
    let node = window.studio().selection.main().unwrap();
    let value = kajo_edit::FieldValue::numbers([0.75]);
    window.studio().apply(Action::SetField { node, key: "radius".into(), nth: 0, value });
    window.studio().apply(Action::EndDrag);
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    let shown = window.path("shown.png");
    window.studio().apply(Action::Export(shown.clone()));
    window.key_with(Modifiers::COMMAND, Key::S);
    let loaded = kajo::load(&window.path("scene.txt"), &kajo::LoadOptions::default());
    let scene = loaded.scene.unwrap();
    let asked = kajo::Settings { size: Some([64, 48]), ..Default::default() };
    let settings = kajo::RenderSettings::resolve(&scene, &asked, kajo::Defaults::Modern, false).unwrap();
    let outputs = [(View::Color, kajo::Format::Png)];
    let picture =
        kajo::render(&kajo::RenderRequest::new(&scene, &settings, &outputs), &kajo::Silent).unwrap();
    let bytes = picture.encode(&[View::Color], kajo::Format::Png, kajo::BitDepth::Eight).unwrap();
    assert_eq!(std::fs::read(shown).unwrap(), bytes);
}

#[test]
fn settings_change_what_is_traced() {
    let mut window = Window::new();
    window.press("Render");
    window.press_in_row("Progressive");
    assert!(!window.studio().options.habits.progressive);
    let size = window.studio().picture_size().map(|side| side.div_ceil(8));
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    assert_eq!(window.studio().tracer.frame().unwrap().size(), size, "an eighth of the window");
    window.press_in_row("Fresnel");
    assert_eq!(window.studio().options.asked.fresnel, Some(true));
    window.press("Reset Fresnel");
    assert_eq!(window.studio().options.asked.fresnel, None);
    let combo = window.harness.get_all_by_label("Integrator").last().unwrap().rect();
    assert!(combo.is_positive());
    window.studio().options.asked.integrator = Some(IntegratorName("path"));
    window.studio().options.asked.samples = Some((SamplerKind::Sobol, 4));
    window.frames(2);
    assert!(window.harness.query_by_label("Roulette").is_some(), "the path tracer's own options");
    window.harness.get_by_label("Reset all to the scene").scroll_to_me();
    window.frames(20);
    window.press("Reset all to the scene");
    assert_eq!(window.studio().options.asked, kajo::Settings::default());
}

/// One chain has nothing to agree with, many of a plain scene nearly do, and paths are no chains.
#[test]
fn the_bottom_line_says_whether_chains_agree() {
    let mut window = Window::new();
    window.studio().options.habits.size = PictureSize::Fixed([24, 20]);
    window.studio().options.habits.progressive = false;
    for (integrator, samples, expected) in [
        ("path", 1, None),
        ("mmlt", 1, Some("chains disagree, R-hat above 10")),
        ("mmlt", 256, Some("R-hat 1.0")),
    ] {
        window.studio().options.asked.integrator = Some(IntegratorName(integrator));
        window.studio().options.asked.samples = Some((SamplerKind::Sobol, samples));
        window.key(Key::Enter);
        window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
        window.frames(2);
        let frame = window.studio().tracer.frame().unwrap();
        assert_eq!((frame.samples(), frame.r_hat().is_some()), (samples, expected.is_some()));
        let shown = window.harness.query_by_label_contains(expected.unwrap_or("R-hat"));
        assert_eq!(
            shown.is_some(),
            expected.is_some(),
            "{integrator}, {samples} samples: {:?}",
            frame.r_hat()
        );
    }
}

#[test]
fn layers_histogram_and_pixel_are_shown() {
    let mut window = Window::new();
    window.studio().options.habits.size = PictureSize::Fixed([60, 40]);
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    window.press("Picture");
    for (label, view) in [("Depth", View::Depth), ("Noise", View::Variance), ("Object", View::Object)] {
        // The layer's button is the first widget of that name below the tabs.
        let buttons = window.harness.get_all_by_label(label).map(|node| node.rect().center());
        let at = buttons.filter(|at| at.y > 60.0).min_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
        window.click(at);
        assert_eq!(window.studio().view, view);
    }
    let ball = window.point([-2.0, 1.0, 1.5]);
    window.harness.hover_at(ball);
    window.frames(2);
    assert!(window.harness.query_by_label("Place").is_some(), "the pixel's numbers");
}

#[test]
fn long_texts_are_edited_beside_the_window() {
    let text = format!("{SCENE}{}", "// A line that makes the text long.\r\n".repeat(40_000));
    let mut window = Window::with(&text, false);
    let document = window.studio().document.as_ref().unwrap();
    let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
    let now = |window: &mut Window| window.studio().document.as_ref().unwrap().text().to_owned();
    for radius in [1.6, 1.7, 1.8, 1.9] {
        let (key, value) = ("radius".to_owned(), kajo_edit::FieldValue::numbers([radius]));
        window.studio().apply(Action::SetField { node: ball, key, nth: 0, value });
    }
    assert!(window.studio().is_compiling() && now(&mut window) == text, "the window does not wait");
    window.wait(|studio| !studio.is_compiling());
    assert_eq!(now(&mut window), text.replace("radius 1.5", "radius 1.9"));
    window.frames(2);
    window.studio().apply(Action::Undo);
    assert_eq!(now(&mut window), text, "one step");

    // Another program writes the file, and something is edited before it is read.
    let path = window.path("scene.txt");
    std::fs::write(&path, text.replace("offset -1", "offset -2")).unwrap();
    window.studio().apply(Action::Reload);
    assert_eq!(now(&mut window), text);
    window.studio().apply(Action::Rename(ball, Some("globe".to_owned())));
    let both = text.replace("offset -1", "offset -2").replace("Sphere ball", "Sphere globe");
    assert_eq!(now(&mut window), both);
    window.key(Key::Enter);
    window.wait(|studio| studio.tracer.frame().is_some());
    assert_eq!(window.studio().n_errors(), 0);
    for _ in 0..2 {
        window.studio().apply(Action::Undo);
    }
    assert_eq!(now(&mut window), text);
}

#[test]
fn a_click_selects_nested_instances() {
    let mut window = Window::empty(false);
    let balls: String = (0..100).map(|i| format!("Sphere {{ center 0 0 {i} radius 0.4 }}\n")).collect();
    let rows = |name: &str, n: i32| -> String {
        (0..n).map(|i| format!("Instance {name} {{ Translate 0 {i} 0 }}\n")).collect()
    };
    let text = format!(
        "PerspectiveCamera {{ center 35 35 -90 direction 0 0 1 up 0 1 0 angle 60 }}
        Materials {{ Material {{}} }}
        Group {{ MaterialIndex 0 Define row {{ {balls} }} Define wall {{ {} }}\n{} }}",
        rows("row", 100),
        (0..70).map(|i| format!("Instance wall {{ Translate {i} 0 0 }}\n")).collect::<String>()
    );
    let path = window.path("forest.txt");
    std::fs::write(&path, text).unwrap();
    window.studio().apply(Action::Open(path));
    window.wait(|studio| studio.scene().is_some() && studio.preview_is_current());
    assert_eq!(window.studio().scene().unwrap().geometry.object_count(), 700_000);
    // So many are not drawn as boxes: the preview shows what rays meet, and that is picked, shot at and grabbed.
    assert!(window.studio().camera.is_flat() && !window.studio().is_drawn());
    window.wait(|studio| studio.sight_is_current());
    let at = window.point([20.0, 30.0, -0.4]);
    let place = window.app().area().unwrap().picture_position(at).unwrap();
    let seen = window.studio().sight().unwrap().object(place);
    window.studio().apply(Action::DebugRay(place));
    let hit = window.studio().rays.as_ref().unwrap().ray.segments[0].hit.unwrap();
    assert_eq!(hit.object, seen);
    assert!(hit.p.distance([20.0, 30.0, -0.4].into()) < 0.2, "{}", hit.p);
    window.studio().apply(Action::ClearDebugRay);
    window.click(at);
    let studio = window.studio();
    assert!(studio.selection.objects().iter().any(|range| range.contains(&seen)));
    let node = studio.selection.main().unwrap();
    let chosen = studio.document.as_ref().unwrap().node(node).unwrap();
    assert_eq!((&*chosen.keyword, chosen.name.as_deref()), ("Instance", Some("wall")));
    assert_eq!(studio.selection.objects(), std::slice::from_ref(&(200_001..210_001)));
    let bounds = studio.selection_bounds().unwrap();
    assert!((bounds.min.x - 19.6).abs() < 0.1 && (bounds.max.y - 99.4).abs() < 0.1, "{bounds:?}");
}

#[test]
fn a_file_changed_elsewhere_is_read_again_and_mistakes_are_shown_in_place() {
    let mut window = Window::new();
    let path = window.path("scene.txt");
    std::fs::write(&path, SCENE.replace("radius 1.5", "radius 0.5")).unwrap();
    window.wait(|studio| studio.document.as_ref().unwrap().text().contains("radius 0.5"));
    std::fs::write(&path, SCENE.replace("Sphere ball", "Sphre ball")).unwrap();
    window.wait(|studio| studio.n_errors() > 0);
    assert!(window.studio().scene().is_some(), "the last good scene stays");
    window.press("Problems (1)");
    assert!(window.harness.query_by_label_contains("scene.txt:13:").is_some());
    window.press("Text");
    let message = window.studio().problems[0].message.clone();
    assert!(window.harness.query_by_label(&message).is_some(), "the mistake stands at its line");
    std::fs::write(&path, SCENE).unwrap();
    window.wait(|studio| studio.problems.is_empty());
}

#[test]
fn mistakes_of_one_line_stand_side_by_side() {
    let mut window = Window::new();
    let path = window.path("scene.txt");
    std::fs::write(&path, SCENE.replace("radius 1.5", "radius 1.5  rubbish 1  nonsense 2")).unwrap();
    window.wait(|studio| studio.n_errors() > 1);
    window.press("Text");
    window.frames(3);
    let messages: Vec<_> = window.studio().problems.iter().map(|problem| problem.message.clone()).collect();
    let mut places: Vec<_> =
        messages.iter().map(|message| window.harness.get_by_label(message).rect()).collect();
    places.sort_by(|a, b| a.left().total_cmp(&b.left()));
    assert!(places.len() > 1);
    for pair in places.windows(2) {
        assert!(pair[0].right() < pair[1].left(), "{places:?}");
        assert_eq!(pair[0].top(), pair[1].top());
    }
}

#[test]
fn the_view_can_be_written_into_the_scene() {
    let mut window = Window::new();
    window.harness.key_down(Key::W);
    window.frames(10);
    window.harness.key_up(Key::W);
    window.frames(2);
    let eye = window.studio().camera.eye();
    window.key_with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::C);
    let camera = kajo::CameraPose::of(window.studio().scene().unwrap());
    assert!((camera.eye() - eye).length() < 1e-5, "{} {eye}", camera.eye());
    assert!(window.text().contains("# looks along -z"));
}

#[test]
fn the_panels_hide_and_come_back() {
    let mut window = Window::new();
    let wide = |window: &mut Window| window.app().area().unwrap().rect.width();
    let before = wide(&mut window);
    window.key(Key::P);
    assert!(wide(&mut window) > before + 200.0);
    window.key(Key::P);
    assert_eq!(wide(&mut window), before);
}

#[test]
fn saving_asks_for_a_name_where_there_is_none() {
    let mut window = Window::empty(false);
    window.key_with(Modifiers::COMMAND, Key::N);
    assert_eq!(window.studio().title(), "untitled");
    assert_eq!(window.studio().n_errors(), 0);
    window.key_with(Modifiers::COMMAND, Key::S);
    window.key_with(Modifiers::COMMAND, Key::A);
    let path = window.path("new.txt");
    window.write(&path.display().to_string());
    window.key(Key::Enter);
    assert_eq!(window.read("new.txt"), window.text());
    assert_eq!(window.studio().title(), "new.txt");
}

#[test]
fn a_handle_follows_the_pointer_and_its_drag_is_one_step() {
    let mut window = Window::new();
    window.select("ball");
    let before = window.point([-2.0, 1.0, 0.0]);
    let by = vec2(64.0, -40.0);
    window.drag(PointerButton::Primary, before, by);
    let text = window.text();
    let center: Vec<f64> = text
        .split("Sphere ball { center ")
        .nth(1)
        .unwrap()
        .split_whitespace()
        .take(3)
        .map(|word| word.parse().unwrap())
        .collect();
    let after = window.point([center[0], center[1], center[2]]);
    assert!((after - before - by).length() < 0.5, "{:?} for {by:?}", after - before);
    assert!(window.studio().camera.eye().z == 10.0, "the camera stays");
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), SCENE);
}

#[test]
fn escape_takes_a_drag_back() {
    let mut window = Window::new();
    window.select("ball");
    let at = window.point([-2.0, 1.0, 0.0]);
    window.button(at, PointerButton::Primary, true);
    for step in 1..=5 {
        window.harness.hover_at(at + vec2(8.0 * step as f32, 0.0));
        window.frames(1);
    }
    assert_ne!(window.text(), SCENE);
    window.key(Key::Escape);
    assert_eq!(window.text(), SCENE);
    window.button(at, PointerButton::Primary, false);
    assert_eq!(window.text(), SCENE);
    assert!(window.studio().document.as_ref().unwrap().undo_label().is_none());
}

#[test]
fn gizmos_move_turn_and_scale() {
    let mut window = Window::new();
    window.select("crate");
    let own = window.studio().handles().all.len();
    for key in [Key::Num1, Key::Num2, Key::Num3] {
        window.key(key);
        let handles = window.studio().handles();
        assert!(handles.all.len() > own, "{key:?}: {} handles", handles.all.len());
        // The arrows, rings or boxes that nothing nearer hides.
        let size = window.app().area().unwrap().size;
        let studio = window.studio();
        let is_on_top = |index: usize| {
            let place = studio.camera.project(handles.all[index].at, size);
            place.is_some_and(|place| studio.handle_at(&handles, place) == Some(index))
        };
        let on_top: Vec<usize> = (own..handles.all.len()).filter(|&index| is_on_top(index)).collect();
        let mut edits = 0;
        for index in on_top {
            let at = window.point(handles.all[index].at.to_array());
            window.drag(PointerButton::Primary, at, vec2(30.0, 22.0));
            assert_eq!(window.studio().n_errors(), 0);
            if window.text() != SCENE {
                edits += 1;
                window.key_with(Modifiers::COMMAND, Key::Z);
                assert_eq!(window.text(), SCENE);
            }
        }
        // What points at the camera cannot be dragged along itself.
        assert!(edits >= 2, "{key:?}: {edits}");
    }
    window.key(Key::Num3);
    assert_eq!(window.studio().handles().all.len(), own, "the same key hides it");
}

#[test]
fn a_turntable_is_written_in_the_background() {
    let mut window = Window::new();
    window.studio().options.habits.size = PictureSize::Fixed([16, 12]);
    window.studio().options.habits.turntable_frames = 3;
    let path = window.path("turn.png");
    window.studio().apply(Action::Turntable(path));
    window.wait(|studio| studio.notice.as_ref().is_some_and(|notice| notice.text == "Wrote 3 pictures."));
    let pictures: Vec<Vec<u8>> =
        (0..3).map(|i| std::fs::read(window.path(&format!("turn_00{i}.png"))).unwrap()).collect();
    assert_ne!(pictures[0], pictures[1]);
}

#[test]
fn the_camera_is_set_by_its_widgets() {
    let mut window = Window::new();
    window.press("Render");
    let widget = window.widget("Field of view");
    let angle = window.studio().camera.angle().unwrap();
    window.drag(PointerButton::Primary, widget, vec2(30.0, 0.0));
    assert!(window.studio().camera.angle().unwrap() > angle + 0.01);
    window.press("Back to the scene's");
    assert!((window.studio().camera.angle().unwrap() - angle).abs() < 1e-9);
}

#[test]
fn arrows_walk_through_the_tree() {
    let mut window = Window::new();
    window.key(Key::ArrowDown);
    assert_eq!(window.selected(), ["PerspectiveCamera "]);
    window.key(Key::ArrowDown);
    assert_eq!(window.selected(), ["Background "]);
    window.key(Key::ArrowUp);
    assert_eq!(window.selected(), ["PerspectiveCamera "]);
}

#[test]
fn typing_a_name_flies_nowhere() {
    let mut window = Window::new();
    let eye = window.studio().camera.eye();
    window.harness.get_by_label("Search the scene").click();
    window.frames(2);
    window.harness.key_down(Key::W);
    window.frames(5);
    window.harness.key_up(Key::W);
    window.key(Key::E);
    window.key(Key::Space);
    window.frames(2);
    assert_eq!(window.studio().camera.eye(), eye);
    assert!(window.studio().rays.is_none());
    assert_eq!(window.studio().shown, Shown::Preview);
}

/// Opens the text of the scene and puts the caret behind the first `after`.
fn type_after(window: &mut Window, after: &str) {
    if window.app().layout.bottom != Some(Bottom::Text) {
        window.press("Text");
    }
    let shown = window.text().replace("\r\n", "\n");
    let at = shown[..shown.find(after).unwrap() + after.len()].chars().count();
    let ctx = window.harness.ctx.clone();
    let id = egui::Id::unique("text of the scene");
    let mut state = egui::TextEdit::load_state(&ctx, id).unwrap_or_default();
    let caret = egui::text::CCursorRange::one(egui::text::CCursor::new(at));
    state.cursor.set_char_range(Some(caret));
    egui::TextEdit::store_state(&ctx, id, state);
    ctx.memory_mut(|memory| memory.request_focus(id));
    window.frames(2);
}

#[test]
fn what_is_typed_changes_those_bytes_and_is_one_step_a_line() {
    let mut window = Window::new();
    type_after(&mut window, "radius 1.5");
    for letter in ["2", "5"] {
        window.write(letter);
    }
    assert_eq!(window.text(), SCENE.replace("radius 1.5", "radius 1.525"));
    assert_eq!(window.studio().n_errors(), 0);
    window.key(Key::Enter);
    window.write("x");
    assert!(window.text().contains("radius 1.525\r\nx }"), "a line ends as the first one does");
    assert!(window.studio().n_errors() > 0 && window.studio().scene().is_some());
    window.key(Key::Backspace);
    assert_eq!(window.studio().n_errors(), 0);
    let undo = |window: &mut Window| window.key_with(Modifiers::COMMAND, Key::Z);
    undo(&mut window);
    undo(&mut window);
    assert_eq!(window.text(), SCENE, "the line and what came after it");
    window.key_with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    assert!(window.text().contains("radius 1.525\r\n }"));
    window.key_with(Modifiers::COMMAND, Key::S);
    assert_eq!(window.read("scene.txt"), window.text());
}

#[test]
fn keys_of_a_block_are_completed_at_the_caret() {
    let mut window = Window::new();
    let is_offered = |window: &Window, word: &str| window.harness.query_by_label(word).is_some();
    type_after(&mut window, "Plane floor { normal 0 1 0");
    // While a key is typed.
    window.write(" o");
    assert!(!is_offered(&window, "offset"), "it is there already");
    window.key(Key::Backspace);
    window.key(Key::Backspace);
    assert_eq!(window.text(), SCENE);
    type_after(&mut window, "diffuseColor 0.1 0.8 0.2");
    window.write(" tr");
    assert!(is_offered(&window, "transparentColor") && !is_offered(&window, "exponent"));
    window.key(Key::Enter);
    assert!(window.text().contains("0.1 0.8 0.2 transparentColor }"), "{}", window.text());
    assert!(!is_offered(&window, "transparentColor"), "it is closed");
    window.write("0 0 0 ");
    // For the asking, and by arrows.
    window.key_with(Modifiers::CTRL, Key::Space);
    assert!(is_offered(&window, "texture") && is_offered(&window, "specularColor"));
    assert!(!is_offered(&window, "diffuseColor"));
    window.key(Key::ArrowDown);
    window.key(Key::Tab);
    assert!(window.text().contains("transparentColor 0 0 0 specularColor }"), "{}", window.text());
    // With the mouse.
    window.write("0 0 0 sh");
    window.frames(20);
    window.press("shininess");
    assert!(window.text().contains("specularColor 0 0 0 shininess }"), "{}", window.text());
    window.write("9");
    assert!(window.text().contains("shininess 9}"), "one types on: {}", window.text());
    assert_eq!(window.studio().n_errors(), 0);
    // What moves the caret elsewhere closes the list.
    window.write(" em");
    assert!(is_offered(&window, "emission"));
    window.key(Key::Home);
    assert!(!is_offered(&window, "emission"));
}

#[test]
fn keys_in_the_text_are_letters_and_blocks_remain_what_they_are() {
    let mut window = Window::new();
    window.select("crate");
    let crate_ = window.studio().selection.main();
    let eye = window.studio().camera.eye();
    type_after(&mut window, "// the ball");
    window.harness.key_down(Key::W);
    window.write("w");
    window.harness.key_up(Key::W);
    window.key(Key::E);
    window.frames(3);
    assert_eq!(window.studio().camera.eye(), eye);
    assert!(window.studio().rays.is_none());
    assert!(window.text().contains("// the ballw"));
    assert_eq!(window.studio().selection.main(), crate_, "it stays selected");
    assert_eq!(window.selected(), ["Box crate"]);
}

#[test]
fn blocks_are_copied_cut_and_pasted_as_text() {
    let mut window = Window::new();
    window.select("ball");
    window.harness.event(egui::Event::Copy);
    window.frames(1);
    let copied = window.harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.expect("a text for the clipboard");
    assert_eq!(copied, "Sphere ball { center -2 1 0  radius 1.5 }\n");
    window.harness.event(egui::Event::Cut);
    window.frames(2);
    assert!(!window.text().contains("Sphere"));
    window
        .harness
        .event(egui::Event::Paste(format!("{copied}  Material red {{ }} Box {{ min 0 0 0 max 1 1 1 }}")));
    window.frames(2);
    assert_eq!(window.notice(), "Pasted 3 blocks.");
    assert_eq!(window.studio().n_errors(), 0);
    assert_eq!(window.studio().scene().unwrap().geometry.primitives.len(), 4);
    assert!(window.text().contains("Material red_2 {"), "a name that is taken is not taken twice");
    for _ in 0..4 {
        window.key_with(Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(window.text(), SCENE);
    window.harness.event(egui::Event::Paste("no block".to_owned()));
    window.frames(2);
    assert_eq!(window.text(), SCENE);
}

#[test]
fn light_colours_are_remembered() {
    let mut window = Window::new();
    window.press("Window");
    window.press("Light colours");
    assert!(window.app().layout.light);
    assert_eq!(window.harness.ctx.theme(), egui::Theme::Light);
}
