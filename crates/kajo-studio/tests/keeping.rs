//! What the window keeps: edits when something is closed, opened or changed from outside, and finished pictures.

mod common;

use common::{SCENE, Window};
use egui::{Event, Key, Modifiers, PointerButton, Vec2, vec2};
use egui_kittest::kittest::Queryable as _;
use kajo::View;
use kajo_edit::FieldValue;
use kajo_studio::state::{Action, Compare, PictureSize, Question, Shown};

/// What the window is called, as its frame says it.
fn title(window: &mut Window) -> String {
    window.frames(1);
    window.app().title().to_owned()
}

#[test]
fn the_window_is_named_after_its_scene() {
    let mut window = Window::empty(false);
    assert_eq!(title(&mut window), "kajo studio");
    window.key_with(Modifiers::COMMAND, Key::N);
    assert_eq!(title(&mut window), "untitled - kajo studio");
    let mut window = Window::new();
    assert_eq!(title(&mut window), "scene.txt - kajo studio");
    set_radius(&mut window, 2.0);
    assert_eq!(title(&mut window), "*scene.txt - kajo studio");
    window.key_with(Modifiers::COMMAND, Key::S);
    assert_eq!(title(&mut window), "scene.txt - kajo studio");
}

fn set_radius(window: &mut Window, radius: f64) {
    window.select("ball");
    let node = window.studio().selection.main().unwrap();
    let value = FieldValue::numbers([radius]);
    window.studio().apply(Action::SetField { node, key: "radius".into(), nth: 0, value });
    window.frames(3);
}

/// Asks the window to close, as the button of its frame does.
fn ask_to_close(window: &mut Window) {
    let viewport = window.harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    viewport.events.push(egui::ViewportEvent::Close);
    window.frames(1);
    let viewport = window.harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    viewport.events.clear();
    window.frames(2);
}

#[test]
fn closing_asks_about_edits_and_saves_them() {
    let mut window = Window::new();
    set_radius(&mut window, 2.0);
    let text = window.text();
    ask_to_close(&mut window);
    assert!(window.harness.query_by_label("Save the edits of scene.txt?").is_some());
    window.key(Key::Escape);
    assert!(!window.studio().is_closing() && window.studio().question().is_none());
    assert_eq!(window.read("scene.txt"), SCENE);
    ask_to_close(&mut window);
    // Enter takes the first answer.
    window.key(Key::Enter);
    assert!(window.studio().is_closing());
    assert_eq!(window.read("scene.txt"), text);
}

#[test]
fn without_edits_nothing_is_asked() {
    let mut window = Window::new();
    ask_to_close(&mut window);
    assert!(window.studio().is_closing());
    let mut window = Window::empty(false);
    window.key_with(Modifiers::COMMAND, Key::N);
    window.key_with(Modifiers::COMMAND, Key::Q);
    assert!(window.studio().is_closing(), "nobody has touched the new scene");
}

#[test]
fn a_new_scene_is_named_before_another_is_opened() {
    let mut window = Window::empty(false);
    let [other, named] = ["other.txt", "named.txt"].map(|name| window.path(name));
    std::fs::write(&other, SCENE).unwrap();
    window.key_with(Modifiers::COMMAND, Key::N);
    window.studio().apply(Action::Add("Box"));
    window.frames(2);
    let text = window.text();
    window.studio().apply(Action::Open(other));
    window.frames(3);
    window.press("Save");
    window.key_with(Modifiers::COMMAND, Key::A);
    window.write(&named.display().to_string());
    window.key(Key::Enter);
    window.wait(|studio| studio.title() == "other.txt");
    assert_eq!(window.read("named.txt"), text);
}

#[test]
fn edits_can_be_given_up() {
    let mut window = Window::new();
    set_radius(&mut window, 2.0);
    window.key_with(Modifiers::COMMAND, Key::N);
    assert_eq!(window.studio().title(), "scene.txt");
    window.press("Don't save");
    assert_eq!(window.studio().title(), "untitled");
    assert_eq!(window.read("scene.txt"), SCENE);
}

#[test]
fn files_that_are_there_are_replaced_only_on_request() {
    let mut window = Window::new();
    let other = window.path("other.txt");
    std::fs::write(&other, "something else").unwrap();
    for (answer, text) in [("Cancel", "something else"), ("Replace", SCENE)] {
        window.studio().apply(Action::SaveAs(other.clone()));
        window.frames(3);
        assert!(window.harness.query_by_label("There is such a file already").is_some());
        assert_eq!(window.read("other.txt"), "something else");
        window.press(answer);
        assert_eq!(window.read("other.txt"), text);
    }
    window.studio().apply(Action::SaveAs(other));
    window.frames(2);
    assert!(window.studio().question().is_none(), "it is the scene's own file by now");

    window.studio().options.habits.size = PictureSize::Fixed([16, 12]);
    window.studio().options.habits.turntable_frames = 2;
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    for name in ["picture.png", "turn_001.png"] {
        std::fs::write(window.path(name), "mine").unwrap();
    }
    let [picture, turn] = ["picture.png", "turn.png"].map(|name| window.path(name));
    for action in [Action::Export(picture), Action::Turntable(turn)] {
        window.studio().apply(action);
        assert!(matches!(window.studio().question(), Some(Question::Replace { .. })));
        window.frames(2);
        window.key(Key::Escape);
    }
    assert_eq!([window.read("picture.png"), window.read("turn_001.png")], ["mine", "mine"]);
    assert!(!window.path("turn_000.png").exists());
}

#[test]
fn a_file_changed_under_edits_offers_theirs_mine_and_the_difference() {
    let mut window = Window::new();
    set_radius(&mut window, 2.0);
    let (mine, theirs) = (window.text(), SCENE.replace("radius 1.5", "radius 0.5"));
    let node = window.studio().selection.main();
    let path = window.path("scene.txt");
    std::fs::write(&path, &theirs).unwrap();
    window.wait(|studio| studio.question().is_some());
    assert_eq!(window.text(), mine, "nothing is taken over without being asked for");
    window.frames(2);
    window.press("Show the difference");
    assert!(window.harness.query_by_label_contains("- mine").is_some(), "the difference");
    window.frames(10);
    window.press("Theirs");
    assert_eq!(window.text(), theirs);
    assert_eq!(window.studio().selection.main(), node, "the same block is selected");
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), mine);

    // To save over it is asked for too, even before the change was noticed.
    let later = SCENE.replace("radius 1.5", "radius 0.25");
    std::fs::write(&path, &later).unwrap();
    window.studio().apply(Action::Save);
    assert_eq!(window.read("scene.txt"), later);
    window.frames(3);
    window.press("Mine: save over it");
    assert_eq!(window.read("scene.txt"), mine);
}

#[test]
fn the_selection_is_kept_when_a_file_is_written_anew() {
    let mut window = Window::new();
    window.select("crate");
    let node = window.studio().selection.main();
    let path = window.path("scene.txt");
    let other =
        SCENE.replace("// A scene for tests.", "// Two\r\n// lines").replace("min 1 0 -1", "min 1 0 -2");
    std::fs::write(&path, &other).unwrap();
    window.wait(|studio| studio.document.as_ref().unwrap().text().contains("Two"));
    assert_eq!((window.studio().selection.main(), window.selected()), (node, vec!["Box crate".to_owned()]));
    // Where the whole line is another one, the block of that name is found again.
    std::fs::write(
        &path,
        other.replace("MaterialIndex green  Box crate {", "  MaterialIndex red\n\tBox\tcrate\n{"),
    )
    .unwrap();
    window.wait(|studio| studio.document.as_ref().unwrap().text().contains("Box\tcrate"));
    window.settle();
    assert_eq!(window.selected(), ["Box crate"]);
}

#[test]
fn edits_are_offered_after_a_crash() {
    let aside = tempfile::tempdir().unwrap();
    let mut window = Window::new();
    window.studio().keep_edits_in(aside.path());
    set_radius(&mut window, 2.0);
    let text = window.text();
    window.studio().settle_recovery();
    let folder = window.folder;
    drop(window.harness);

    let mut window = Window::empty(false);
    window.studio().keep_edits_in(aside.path());
    window.frames(3);
    assert!(window.harness.query_by_label("Unsaved edits were found").is_some());
    window.press("Recover");
    assert_eq!(window.text(), text);
    assert_eq!(window.studio().title(), "scene.txt");
    window.key_with(Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read_to_string(folder.path().join("scene.txt")).unwrap(), text);
    window.studio().settle_recovery();
    drop(window);
    assert_eq!(std::fs::read_dir(aside.path()).unwrap().count(), 0, "nothing is left over");
}

/// Traces to the end; the number of the trace.
fn trace(window: &mut Window) -> u64 {
    window.studio().options.habits.size = PictureSize::Fixed([60, 40]);
    window.key(Key::Enter);
    finished(window)
}

fn finished(window: &mut Window) -> u64 {
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    window.frames(3);
    window.studio().tracer.frame().unwrap().job()
}

#[test]
fn another_layer_starts_nothing_anew() {
    let mut window = Window::new();
    let job = trace(&mut window);
    for view in View::ALL {
        window.studio().apply(Action::Show(view));
        window.frames(3);
        assert_eq!(finished(&mut window), job, "{view:?}");
    }
    let frame = window.studio().picture().unwrap();
    for view in
        [View::Depth, View::Normals, View::Uv, View::Object, View::Material, View::Samples, View::Variance]
    {
        assert!(frame.has(view), "{view:?}");
    }
    assert!(!frame.has(View::Albedo));
    window.studio().apply(Action::Show(View::Albedo));
    let again = trace(&mut window);
    assert!(again > job && window.studio().picture().unwrap().has(View::Albedo), "Enter traces with it");
}

#[test]
fn a_stray_drag_is_taken_back_with_its_picture() {
    let mut window = Window::new();
    let job = trace(&mut window);
    let picture = window.studio().picture().unwrap();
    let eye = window.studio().camera.eye();
    let at = window.app().area().unwrap().rect.center() + vec2(0.0, -40.0);
    window.drag(PointerButton::Primary, at, vec2(50.0, 10.0));
    assert!(finished(&mut window) > job);
    assert_ne!(window.studio().camera.eye(), eye);
    let other = window.studio().picture().unwrap();
    assert!(!std::sync::Arc::ptr_eq(&picture, &other));

    window.key_with(Modifiers::COMMAND, Key::Z);
    let again = window.studio().picture().unwrap();
    assert!(std::sync::Arc::ptr_eq(&picture, &again), "it is there at once, not traced anew");
    assert_eq!(window.studio().camera.eye(), eye);
    window.frames(5);
    assert!(window.studio().progress().is_none());
    window.key_with(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    assert!(std::sync::Arc::ptr_eq(&other, &window.studio().picture().unwrap()));
    assert_eq!(window.studio().pictures.kept().len(), 2);

    // After an edit undo is about that, and the camera has keys of its own.
    let view = window.studio().camera.eye();
    set_radius(&mut window, 2.0);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!((window.text().as_str(), window.studio().camera.eye()), (SCENE, view));
    window.key_with(Modifiers::ALT, Key::ArrowLeft);
    assert_eq!(window.studio().camera.eye(), eye);
    window.key_with(Modifiers::ALT, Key::ArrowRight);
    assert_eq!(window.studio().camera.eye(), view);
}

#[test]
fn a_flight_is_one_step() {
    let mut window = Window::new();
    let eye = window.studio().camera.eye();
    for key in [Key::W, Key::D] {
        window.harness.key_down(key);
        window.frames(8);
        window.harness.key_up(key);
        window.frames(3);
    }
    let between = |window: &mut Window| {
        window.key_with(Modifiers::ALT, Key::ArrowLeft);
        window.studio().camera.eye()
    };
    let middle = between(&mut window);
    assert!(middle.x == eye.x && middle.z < eye.z);
    assert_eq!(between(&mut window), eye);
    between(&mut window);
    assert_eq!(window.notice(), "The camera has made no such step.");
    // In the preview undo is about the scene.
    window.key(Key::Home);
    window.key_with(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.notice(), "There is nothing left to step over.");
}

#[test]
fn pictures_stand_in_a_strip_and_are_compared() {
    let mut window = Window::new();
    trace(&mut window);
    set_radius(&mut window, 1.0);
    finished(&mut window);
    let letters: String = window.studio().pictures.kept().iter().map(|kept| kept.letter).collect();
    assert_eq!(letters, "AB");
    window.press("Wipe");
    assert_eq!(window.studio().reference().unwrap().letter, 'A', "the other one");
    // The wipe is dragged in the picture, and the camera stays.
    let version = window.studio().camera_version();
    let rect = window.app().area().unwrap().rect;
    window.drag(PointerButton::Primary, rect.center(), Vec2::new(0.25 * rect.width(), 0.0));
    assert!((window.studio().pictures.wipe - 0.75).abs() < 0.01, "{}", window.studio().pictures.wipe);
    assert_eq!(window.studio().camera_version(), version);

    window.press("Difference");
    let apart = window.studio().apart().unwrap();
    let figures = apart.difference.as_ref().as_ref().unwrap().figures;
    assert!(figures.rmse > 0.01 && figures.psnr.is_finite());
    window.key(Key::Escape);
    assert_eq!(window.studio().pictures.compare, Compare::Off);

    window.press("Picture A");
    let shown = window.studio().picture().unwrap();
    assert!(std::sync::Arc::ptr_eq(&shown, &window.studio().pictures.get('A').unwrap().frame));
    window.press("Now");
    assert!(!std::sync::Arc::ptr_eq(&shown, &window.studio().picture().unwrap()));
    window.studio().apply(Action::ForgetPicture('A'));
    window.frames(2);
    assert!(window.harness.query_by_label("Picture A").is_none());
}

#[test]
fn chords_within_one_frame_count_in_their_order() {
    let mut window = Window::new();
    set_radius(&mut window, 2.0);
    let text = window.text();
    let press =
        |key, modifiers, pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    let input = window.harness.input_mut();
    for key in [Key::S, Key::Z] {
        input.events.push(press(key, Modifiers::COMMAND, true));
        input.events.push(press(key, Modifiers::COMMAND, false));
    }
    // The modifier is up again before the frame is drawn.
    input.events.push(Event::ModifiersChanged(Modifiers::NONE));
    window.harness.step();
    assert_eq!((window.read("scene.txt"), window.text().as_str()), (text, SCENE));
    assert_eq!(window.studio().shown, Shown::Preview);
}

#[test]
fn a_small_window_has_room_for_everything() {
    let mut window = Window::new();
    window.harness.set_size(Vec2::new(640.0, 400.0));
    window.frames(4);
    let area = window.app().area().unwrap().rect;
    assert!(area.width() > 150.0 && area.height() > 100.0, "{area:?}");
    window.key(Key::F1);
    let last = window.harness.get_by_label("Stop tracing; close what is open");
    last.scroll_to_me();
    window.frames(20);
    let at = window.harness.get_by_label("Stop tracing; close what is open").rect();
    assert!(at.bottom() < 400.0 && at.top() > 0.0, "{at:?}");
    window.key(Key::Escape);
    window.frames(20);
    assert!(window.harness.query_by_label("Stop tracing; close what is open").is_none());
    window.press("Text");
    let area = window.app().area().unwrap().rect;
    assert!(area.height() > 60.0, "{area:?}");
    window.key(Key::Escape);
    assert_eq!(window.app().layout.bottom, None);
    window.key(Key::L);
    let cancel = window.harness.get_by_label("Cancel").rect();
    assert!(cancel.bottom() < 400.0, "{cancel:?}");
}

#[test]
fn letters_stay_with_their_pictures() {
    let mut window = Window::new();
    trace(&mut window);
    let first = window.studio().pictures.get('A').unwrap().frame.clone();
    let keep = |window: &mut Window, n: usize| {
        for _ in 0..n {
            let angle = 0.5 + 0.01 * window.studio().camera_version() as f64;
            window.studio().apply(Action::SetAngle(angle));
            trace(window);
        }
        window.studio().pictures.kept().iter().map(|kept| kept.letter).collect::<String>()
    };
    assert_eq!(keep(&mut window, 3), "ABCD");
    window.studio().apply(Action::ForgetPicture('B'));
    window.studio().apply(Action::CompareWith(Some('A')));
    window.studio().apply(Action::Compare(Compare::Wipe));
    assert_eq!(keep(&mut window, 2), "ACDEF", "no letter goes to another picture");
    // Those that are compared stay when the oldest give way, even when all letters have been used once.
    assert_eq!(keep(&mut window, 22), "AVWXYZBC");
    assert!(std::sync::Arc::ptr_eq(&window.studio().pictures.get('A').unwrap().frame, &first));
    assert_eq!(window.studio().reference().unwrap().letter, 'A');
}
