//! The time line, by script: its frames, scrubbing, playback, and the keys of the scene.

mod common;

use common::{SCENE, Window};
use egui::{Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use kajo_studio::state::{Action, Shown, Studio};

/// The scene, with a ball that goes from left to right in a second, and grows in one step.
fn scene() -> String {
    let ball = "Sphere ball { center -2 1 0  radius 1.5 }";
    assert!(SCENE.contains(ball));
    let keyed = "Sphere ball { center keys { 0: -2 1 0  /* there */ 1: 2 1 4 }  radius keys step { 0: 1.5  0.5: 0.5 } }";
    format!("Animation {{ fps 24  frames 1 25 }}\r\n{}", SCENE.replace(ball, keyed))
}

fn frame(studio: &Studio) -> i64 {
    studio.time_line.timing().unwrap().frame
}

/// The middle of the ball at the frame on show, once the scene is made for that.
fn ball(window: &mut Window) -> [f64; 3] {
    window.settle();
    window.harness.step();
    let document = window.studio().document.as_ref().unwrap();
    assert!(document.is_current());
    let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap();
    document.value(ball.id, "center").unwrap().vec3().unwrap()
}

/// Where a frame is on the ruler.
fn on_ruler(window: &mut Window, frame: i64) -> Pos2 {
    let rect = window.harness.get_by_label("Time").rect();
    let [first, last] = ["Key 1 of ball center", "Key 25 of ball center"]
        .map(|name| window.harness.get_by_label(name).rect().center().x);
    Pos2::new(first + (last - first) * (frame - 1) as f32 / 24.0, rect.center().y)
}

#[test]
fn a_time_line_is_there_when_a_scene_changes_or_is_asked_for() {
    let mut window = Window::new();
    assert!(window.harness.query_by_label("Time").is_none());
    window.key(Key::T);
    assert!(window.harness.query_by_label("Time").is_some(), "asked for");
    assert!(window.harness.query_by_label("No value of this scene has keys yet.").is_some());
    window.key(Key::T);
    assert!(window.harness.query_by_label("Time").is_none());
    let mut window = Window::with(&scene(), false);
    window.frames(2);
    assert!(window.harness.query_by_label("Time").is_some());
    assert!(window.harness.query_by_label("Keys of ball center").is_some());
    window.press("Keys of ball radius");
    assert_eq!(window.selected(), ["Sphere ball"]);
    window.press("Window");
    window.press("Time line T");
    assert!(window.harness.query_by_label("Time").is_none());
}

#[test]
fn scrubbing_shows_the_scene_as_it_is_then() {
    let mut window = Window::with(&scene(), false);
    window.frames(2);
    let text = window.text();
    assert_eq!((frame(window.studio()), ball(&mut window)), (1, [-2.0, 1.0, 0.0]));
    let [from, to] = [13, 25].map(|frame| on_ruler(&mut window, frame));
    window.click(from);
    assert_eq!((frame(window.studio()), ball(&mut window)), (13, [0.0, 1.0, 2.0]));
    window.drag(PointerButton::Primary, from, to - from);
    assert_eq!((frame(window.studio()), ball(&mut window)), (25, [2.0, 1.0, 4.0]));
    window.wait(|studio| studio.preview_is_current());
    // What is picked is where the ball is now.
    let there = window.point([2.0, 1.0, 4.5]);
    window.click(there);
    assert_eq!(window.selected(), ["Sphere ball"]);
    assert_eq!(window.text(), text);
    assert!(!window.studio().has_unsaved_edits());
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(frame(window.studio()), 25, "there is nothing to undo");
}

#[test]
fn keys_step_by_frames_and_from_key_to_key() {
    let mut window = Window::with(&scene(), false);
    window.frames(2);
    for (modifiers, key, expected) in [
        (Modifiers::NONE, Key::Period, 2),
        (Modifiers::NONE, Key::Period, 3),
        (Modifiers::NONE, Key::Comma, 2),
        (Modifiers::SHIFT, Key::Period, 13),
        (Modifiers::SHIFT, Key::Period, 25),
        (Modifiers::SHIFT, Key::Comma, 13),
        (Modifiers::SHIFT, Key::Comma, 1),
    ] {
        window.key_with(modifiers, key);
        assert_eq!(frame(window.studio()), expected);
    }
    window.key_with(Modifiers::SHIFT, Key::Comma);
    assert_eq!(window.notice(), "There is no earlier key.");
    window.press("Last frame");
    assert_eq!(frame(window.studio()), 25);
    window.press("First frame");
    assert_eq!(frame(window.studio()), 1);
}

#[test]
fn it_plays_to_the_end_or_begins_anew() {
    let mut window = Window::with(&scene(), false);
    window.press("Loop");
    assert!(!window.studio().time_line.loops);
    window.studio().apply(Action::ShowFrame(20));
    window.key(Key::K);
    window.wait(|studio| frame(studio) == 25 && !studio.time_line.is_playing());
    assert_eq!(ball(&mut window), [2.0, 1.0, 4.0]);
    window.press("Loop");
    window.press("Play");
    window.wait(|studio| frame(studio) < 20);
    assert!(window.studio().time_line.is_playing());
    window.press("Pause");
    let now = frame(window.studio());
    window.frames(20);
    assert_eq!(frame(window.studio()), now);
}

#[test]
fn what_plays_waits_while_something_is_dragged() {
    let mut window = Window::with(&scene(), false);
    window.frames(2);
    window.select("crate");
    let corner = window.point([3.0, 2.0, 1.0]);
    window.button(corner, PointerButton::Primary, true);
    window.harness.event(egui::Event::PointerMoved(corner + vec2(30.0, -20.0)));
    window.frames(2);
    assert!(window.studio().has_grip());
    let now = frame(window.studio());
    window.studio().apply(Action::Play);
    std::thread::sleep(std::time::Duration::from_millis(100));
    window.frames(5);
    assert!(window.studio().has_grip() && window.studio().time_line.is_playing());
    assert_eq!(frame(window.studio()), now);
    window.button(corner + vec2(30.0, -20.0), PointerButton::Primary, false);
    window.wait(|studio| frame(studio) > now);
    window.key(Key::K);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), scene(), "the drag is one step");
}

#[test]
fn a_trace_begins_anew_at_another_frame() {
    let mut window = Window::with(&scene(), false);
    window.key(Key::Enter);
    window.wait(|studio| studio.tracer.frame().is_some());
    let job = window.studio().tracer.frame().unwrap().job();
    window.key(Key::Period);
    window.wait(|studio| studio.tracer.frame().is_some_and(|frame| frame.job() > job));
    assert_eq!(window.studio().shown, Shown::Traced);
    assert_eq!(frame(window.studio()), 2);
}

#[test]
fn frames_and_their_rate_are_written_into_the_scene() {
    let mut window = Window::with(&scene(), false);
    window.studio().apply(Action::SetFrames([1, 50]));
    window.studio().apply(Action::SetRate(12.0));
    window.studio().apply(Action::EndDrag);
    window.frames(3);
    assert_eq!(window.text(), scene().replace("fps 24  frames 1 25", "fps 12  frames 1 50"));
    let timing = window.studio().time_line.timing().unwrap();
    assert_eq!((timing.fps, timing.last), (12.0, 50));
    let mut window = Window::new();
    window.frames(2);
    window.studio().apply(Action::SetFrames([10, 20]));
    window.frames(3);
    assert_eq!(window.text(), format!("{SCENE}Animation {{ fps 24  frames 10 20 }}\r\n"));
    assert_eq!(window.studio().time_line.timing().unwrap().first, 10);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), SCENE);
}

#[test]
fn long_texts_are_scrubbed_beside_the_window() {
    let text = format!("{}{}", scene(), "// A line that makes the text long.\r\n".repeat(40_000));
    let mut window = Window::with(&text, false);
    for frame in [5, 9, 13, 25] {
        window.studio().apply(Action::ShowFrame(frame));
    }
    window.wait(|studio| frame(studio) == 25 && !studio.is_compiling());
    assert_eq!(ball(&mut window), [2.0, 1.0, 4.0]);
    assert_eq!(window.text(), text);
}

/// Where a key of the time line is.
fn mark(window: &mut Window, name: &str) -> Pos2 {
    window.harness.get_by_label(name).rect().center()
}

/// The window with the scene, its first frames drawn.
fn window() -> Window {
    let mut window = Window::with(&scene(), false);
    window.frames(2);
    window
}

#[test]
fn keys_are_dragged_onto_frames_in_one_step() {
    let mut window = window();
    let from = mark(&mut window, "Key 13 of ball radius");
    let frame_width = (on_ruler(&mut window, 2) - on_ruler(&mut window, 1)).x;
    window.drag(PointerButton::Primary, from, vec2(5.2 * frame_width, 0.0));
    assert_eq!(window.text(), scene().replace("0.5: 0.5", "0.708333333: 0.5"));
    assert_eq!(frame(window.studio()), 1, "that is no scrubbing");
    assert_eq!(window.selected(), ["Sphere ball"]);
    let there = mark(&mut window, "Key 18 of ball radius");
    assert!((there.x - from.x - 5.0 * frame_width).abs() < 1.0);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), scene(), "the whole drag is one step");
    // Several at once, beyond others and back.
    for name in ["Key 13 of ball radius", "Key 1 of ball center"] {
        let at = mark(&mut window, name);
        window.harness.event(egui::Event::PointerMoved(at));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::SHIFT);
            window.harness.event_modifiers(
                egui::Event::PointerButton { pos: at, button, pressed, modifiers },
                modifiers,
            );
            window.frames(2);
        }
    }
    assert_eq!(window.studio().time_line.n_chosen(), 2);
    let from = mark(&mut window, "Key 1 of ball center");
    window.drag(PointerButton::Primary, from, vec2(2.0 * frame_width, 0.0));
    let both = scene().replace("0.5: 0.5", "0.583333333: 0.5").replace("0: -2 1 0", "0.083333333: -2 1 0");
    assert_eq!(window.text(), both);
    assert_eq!(window.studio().time_line.n_chosen(), 2);
}

#[test]
fn escape_takes_a_drag_of_keys_back_and_delete_takes_them_out() {
    let mut window = window();
    let from = mark(&mut window, "Key 25 of ball center");
    window.button(from, PointerButton::Primary, true);
    window.harness.event(egui::Event::PointerMoved(from - vec2(200.0, 0.0)));
    window.frames(2);
    assert_ne!(window.text(), scene());
    window.key(Key::Escape);
    window.button(from - vec2(200.0, 0.0), PointerButton::Primary, false);
    assert_eq!(window.text(), scene());
    let at = mark(&mut window, "Key 25 of ball center");
    window.click(at);
    assert_eq!(window.studio().time_line.n_chosen(), 1);
    window.key(Key::Delete);
    assert_eq!(window.text(), scene().replace("  /* there */ 1: 2 1 4", "  /* there */"));
    assert_eq!(window.studio().time_line.n_chosen(), 0);
    window.key_with(Modifiers::COMMAND, Key::Z);
    // What is selected elsewhere is what is deleted then.
    let at = mark(&mut window, "Key 25 of ball center");
    window.click(at);
    window.press("Box crate");
    window.key(Key::Delete);
    assert_eq!(window.text(), scene().replace("  Box crate { min 1 0 -1  max 3 2 1 }", ""));
}

#[test]
fn a_value_with_keys_says_what_a_change_does() {
    let mut window = window();
    window.select("ball");
    window.studio().apply(Action::ShowFrame(7));
    window.frames(3);
    assert_eq!(window.harness.get_all_by_label("adds a key").count(), 2);
    let widget = window.widget("Radius");
    window.drag(PointerButton::Primary, widget, vec2(30.0, 0.0));
    assert_eq!(window.notice(), "Sets a new key of radius at frame 7.");
    let text = window.text();
    let radius: f64 = text.split("0.25: ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(radius > 1.5, "{radius}");
    let expected = scene().replace("0: 1.5  0.5", &format!("0: 1.5  0.25: {radius}  0.5"));
    assert_eq!(text, expected);
    assert!(
        window.harness.query_by_label("key").is_some()
            && window.harness.query_by_label("adds a key").is_some()
    );
    window.drag(PointerButton::Primary, widget, vec2(30.0, 0.0));
    assert_eq!(window.notice(), "Changes the key of radius at frame 7.");
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), expected, "each drag is a step");
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), scene());
    // A handle sets keys too.
    let center = window.point([-1.0, 1.0, 1.0]);
    window.drag(PointerButton::Primary, center, vec2(0.0, -40.0));
    assert!(window.text().contains("keys { 0: -2 1 0  0.25: "), "{}", window.text());
    assert_eq!(window.notice(), "A key was set at frame 7.");
}

#[test]
fn a_mark_sets_the_first_key_and_takes_it_out_again() {
    let mut window = window();
    window.select("crate");
    window.studio().apply(Action::ShowFrame(13));
    window.frames(3);
    window.press("Key of max");
    assert_eq!(window.text(), scene().replace("max 3 2 1", "max keys { 0.5: 3 2 1 }"));
    assert_eq!(window.notice(), "Done: set a key of max.");
    window.frames(2);
    assert!(window.harness.query_by_label("Key 13 of crate max").is_some(), "a row more");
    window.key(Key::Period);
    window.key(Key::I);
    assert!(window.text().contains("max keys { 0.5: 3 2 1  0.541666667: 3 2 1 }"), "{}", window.text());
    window.press("Key of max");
    window.key(Key::Comma);
    window.press("Key of max");
    assert_eq!(window.text(), scene(), "as it was");
    // A name cannot have keys, and says so.
    window.studio().apply(Action::SelectNext(false));
    window.key(Key::I);
    let node = window.studio().selection.main().unwrap();
    window.studio().apply(Action::ToggleKey { node, key: "nothing".into(), nth: 0 });
    window.select("floor");
    window.key(Key::I);
    assert!(window.notice().starts_with("Nothing that is selected has keys"));
}

#[test]
fn a_models_own_keys_have_a_row() {
    let mut window = Window::empty(false);
    kajo_testkit::write_walker(window.folder.path(), [0.0, 0.5, 1.0]).unwrap();
    window.open(&scene().replace("Sphere ball", "Model fox { file walker.gltf } Sphere ball"));
    window.frames(3);
    window.press("Keys of fox: walk");
    assert_eq!(window.selected(), ["Model fox"]);
    // Where it has keys one scrubs too.
    let row = window.harness.get_by_label("Keys of fox: walk").rect().center();
    let at = Pos2::new(on_ruler(&mut window, 19).x, row.y);
    window.click(at);
    assert_eq!(frame(window.studio()), 19);
}

#[test]
fn values_go_from_key_to_key_as_is_chosen() {
    let mut window = window();
    let at = mark(&mut window, "Key 1 of ball center");
    window.click(at);
    window.studio().apply(Action::SetInterpolation(None, kajo_edit::Interpolation::Cubic));
    window.studio().apply(Action::SetOutside(None, kajo_edit::Outside::Loop));
    window.frames(3);
    let text = window.text();
    assert!(text.contains("center keys loop cubic {") || text.contains("center keys cubic loop {"), "{text}");
    window.key_with(Modifiers::COMMAND, Key::Z);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), scene());
    // By the menu of a row.
    let row = window.harness.get_by_label("Keys of ball radius").rect().center();
    window.button(row, PointerButton::Secondary, true);
    window.button(row, PointerButton::Secondary, false);
    window.press("Monotone");
    assert_eq!(window.text(), scene().replace("keys step", "keys monotone"));
    window.key_with(Modifiers::COMMAND, Key::Z);
    window.studio().apply(Action::ShowFrame(7));
    window.frames(3);
    let row = window.harness.get_by_label("Keys of ball radius").rect().center();
    window.button(row, PointerButton::Secondary, true);
    window.button(row, PointerButton::Secondary, false);
    window.press("Set a key at this frame");
    assert_eq!(window.text(), scene().replace("0: 1.5  0.5", "0: 1.5  0.25: 1.5  0.5"));
}

/// Looked at by eyes where a path is given to write it to.
#[test]
fn it_is_drawn() {
    let Ok(mut window) = std::panic::catch_unwind(|| Window::with(&scene(), true)) else {
        eprintln!("skipped: nothing here can draw");
        return;
    };
    window.frames(3);
    window.select("ball");
    window.studio().apply(Action::ShowFrame(7));
    let at = mark(&mut window, "Key 13 of ball radius");
    window.click(at);
    window.frames(20);
    window.wait(|studio| studio.preview_is_current());
    window.frames(3);
    let at_key = window.harness.get_by_label("Key 25 of ball center").rect().center();
    let image = window.harness.render().unwrap();
    if let Some(path) = std::env::var_os("KAJO_WRITE_WINDOW") {
        image.save(path).unwrap();
    }
    let pixel = |at: Pos2| image.get_pixel(at.x as u32, at.y as u32).0;
    assert_ne!(pixel(at_key), pixel(at_key + vec2(0.0, 7.5)), "a mark on its row");
}
