//! What a user must not lose, and what must be what it looks like, in the real program on a display without a screen.
//!
//! It needs Xvfb and xdotool, which `cargo xtask test` installs where it may; without them it says so and passes. With
//! `KAJO_SCREENSHOTS` it keeps pictures of the display in the folder of that name.

#![cfg(target_os = "linux")]

mod desktop;

use desktop::{Desktop, SCENE, Screen};

/// Takes the ball out, as an edit.
fn delete_ball(desktop: &mut Desktop) {
    let ball = desktop.see("the ball", Screen::ball);
    desktop.click(ball.center());
    // Its handles and its outline are there once it is selected.
    desktop.see("the selection", |screen| screen.outline());
    desktop.key("Delete");
    desktop.until("an edit", |desktop| desktop.title().starts_with('*').then_some(()));
    // Else what comes next could be taken for seen before this is.
    desktop.see("no ball", |screen| screen.ball().is_none().then_some(()));
}

/// Opens the dialog for a file with these keys, writes a path into it, and waits until it gives way.
fn choose(desktop: &mut Desktop, keys: &str, name: &str) {
    desktop.key(keys);
    let button = desktop.see("a dialog for a file", Screen::button);
    desktop.key("ctrl+a");
    desktop.type_text(&desktop.path(name).display().to_string());
    desktop.key("Return");
    desktop.see("what comes of it", |screen| (screen.button() != Some(button)).then_some(()));
}

#[test]
fn what_would_lose_edits_asks_first() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    desktop.write("other.txt", &SCENE.replace("stays", "is another"));
    delete_ball(&mut desktop);
    for keys in ["ctrl+q", "ctrl+n"] {
        desktop.key(keys);
        desktop.wait_for_question(keys);
        desktop.key("Escape");
        desktop.wait_for_no_question();
        assert_eq!(desktop.title(), "*scene.txt - kajo studio");
    }
    choose(&mut desktop, "ctrl+o", "other.txt");
    desktop.wait_for_question("open another");
    // To the button that gives the edits up.
    desktop.keys(&["Tab", "Return"]);
    desktop.wait_for_title("other.txt - kajo studio");
    assert_eq!(desktop.read("scene.txt"), SCENE);

    delete_ball(&mut desktop);
    desktop.key("ctrl+q");
    desktop.wait_for_question("quit");
    desktop.key("Return");
    assert!(desktop.ended());
    let saved = desktop.read("other.txt");
    assert!(saved.starts_with("// A comment that is another.") && !saved.contains("Sphere"), "{saved}");
}

#[test]
fn a_file_that_is_there_is_replaced_only_on_request() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    desktop.write("other.txt", "mine");
    choose(&mut desktop, "ctrl+shift+s", "other.txt");
    desktop.wait_for_question("replace");
    assert_eq!(desktop.read("other.txt"), "mine");
    desktop.key("Escape");
    desktop.wait_for_no_question();
    assert_eq!(desktop.read("other.txt"), "mine");
    choose(&mut desktop, "ctrl+shift+s", "other.txt");
    desktop.wait_for_question("replace");
    desktop.key("Return");
    desktop.wait_for_title("other.txt - kajo studio");
    assert_eq!(desktop.read("other.txt"), SCENE);
}

#[test]
fn edits_are_offered_after_a_kill() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    delete_ball(&mut desktop);
    let folder = "kajo-studio/recovery";
    desktop.until("edits saved aside", |desktop| {
        let files = desktop.files_of_program(folder);
        files.iter().any(|file| file.extension().is_some_and(|ending| ending == "json")).then_some(())
    });
    desktop.kill();
    assert_eq!(desktop.read("scene.txt"), SCENE);

    desktop.start(None);
    desktop.wait_for_question("recover");
    desktop.key("Return");
    desktop.wait_for_title("*scene.txt - kajo studio");
    desktop.key("ctrl+s");
    desktop.wait_for_title("scene.txt - kajo studio");
    let saved = desktop.read("scene.txt");
    assert!(saved.starts_with("// A comment that stays.") && !saved.contains("Sphere"), "{saved}");
}

#[test]
fn a_file_changed_under_edits_offers_theirs_mine_and_the_difference() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    delete_ball(&mut desktop);
    let theirs = SCENE.replace("radius 1", "radius 0.5");
    desktop.write("scene.txt", &theirs);
    desktop.wait_for_question("theirs or mine");
    desktop.rest();
    // The button for the difference is above that for theirs.
    let theirs = desktop.see("the button for theirs", Screen::button);
    let x = theirs.min[0] + 12;
    let above = desktop.see("the button above it", |screen| {
        (0..theirs.min[1] - 2).rev().find(|&y| screen.at(x, y) == [55, 57, 63])
    });
    desktop.click([x, above - 4]);
    desktop.see("the difference", |screen| {
        let has = |color| screen.block(screen.all(), |pixel| pixel == color);
        let wide = |color| has(color).is_some_and(|block| block.size()[0] > 100);
        (wide([255, 110, 100]) && wide([120, 210, 140])).then_some(())
    });
    desktop.rest();
    let theirs = desktop.see("the button for theirs", Screen::button);
    desktop.click(theirs.center());
    desktop.wait_for_title("scene.txt - kajo studio");
    desktop.see("their ball", Screen::ball);
    // Undo brings mine back, and saving it over theirs is asked for.
    desktop.key("ctrl+z");
    desktop.wait_for_title("*scene.txt - kajo studio");
    desktop.key("ctrl+s");
    desktop.wait_for_title("scene.txt - kajo studio");
    assert!(!desktop.read("scene.txt").contains("Sphere"));
}

#[test]
fn the_debug_ray_stays_with_its_pixel() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    let ball = desktop.see("the ball", Screen::ball);
    let [width, height] = ball.size();
    desktop.point_at([ball.min[0] + width / 3, ball.min[1] + height / 4]);
    desktop.key("e");
    // Where the mark is in the ball, as a share of its size.
    let share = |screen: &Screen| {
        let ball = screen.ball()?;
        let mark = screen.block([ball.min, ball.max], |pixel| pixel == [255; 3])?;
        let share =
            |axis: usize| f64::from(mark.center()[axis] - ball.min[axis]) / f64::from(ball.size()[axis]);
        Some([share(0), share(1), f64::from(ball.size()[1])])
    };
    desktop.see("the mark", share);
    let screen = desktop.rest();
    let small = share(&screen).unwrap();
    assert!(small[2] < 0.9 * f64::from(height), "a panel has opened: {small:?}");
    desktop.key("p");
    desktop.see("a larger picture", |screen| screen.ball().filter(|ball| ball.size()[1] > height));
    let large = share(&desktop.rest()).unwrap();
    for [x, y, _] in [small, large] {
        assert!((x - 1.0 / 3.0).abs() < 0.04 && (y - 0.25).abs() < 0.04, "{small:?} {large:?}");
    }
}

#[test]
fn absent_fields_show_dimmed_what_holds_and_change_from_there() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    let ball = desktop.see("the ball", Screen::ball);
    let bare = SCENE.replace("Matte { color 0.8 0.1 0.1 }", "Matte { }");
    desktop.write("scene.txt", &bare);
    desktop.see("the ball without its colour", |screen| screen.ball().is_none().then_some(()));
    desktop.click(ball.center());
    desktop.see("the selection", Screen::outline);
    // The material says nothing, so its list of other fields is open. Among them is an opacity of 1: a slider that is full,
    // fainter than that of a value which is set.
    let panel = [[900, 0], [1280, 800]];
    let set = [104, 74, 28];
    let is_dimmed =
        |[r, g, b]: [u8; 3]| (60..95).contains(&r) && (45..70).contains(&g) && (22..42).contains(&b);
    let full = desktop.see("the dimmed slider", |screen| screen.run(panel, 75, is_dimmed));
    let [y, end] = [full.min[1] + 2, full.max[0]];
    desktop.drag([end, y], [end - 12, y]);
    desktop.until("an edit", |desktop| desktop.title().starts_with('*').then_some(()));
    desktop.see("the slider of a value that is set", |screen| screen.run(panel, 60, |pixel| pixel == set));
    desktop.key("ctrl+s");
    desktop.wait_for_title("scene.txt - kajo studio");
    let saved = desktop.read("scene.txt");
    let opacity = saved.split("opacity ").nth(1).expect("an opacity").split(' ').next().unwrap();
    let opacity: f64 = opacity.parse().unwrap();
    assert!((0.5..1.0).contains(&opacity), "from 1 downwards: {saved}");
    assert_eq!(saved.replace(&format!(" opacity {opacity}"), ""), bare);
}

#[test]
fn finished_pictures_stand_in_a_strip_and_a_stray_drag_loses_none() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    let ball = desktop.see("the ball", Screen::ball);
    let inside = [ball.min, ball.max];
    let corner = [ball.min[0] - 100, ball.min[1]];
    desktop.point_at(corner);
    desktop.key("Return");
    desktop.see("picture A", |screen| (screen.small_balls() == 1).then_some(()));
    let first = desktop.rest();
    desktop.drag(corner, [corner[0] + 60, corner[1]]);
    desktop.see("picture B", |screen| (screen.small_balls() == 2).then_some(()));
    desktop.point_at(corner);
    let second = desktop.rest();
    assert!(!second.agrees(&first, inside), "it is lit from another side");
    desktop.key("ctrl+z");
    desktop.see("the first picture again", |screen| screen.agrees(&first, inside).then_some(()));
    desktop.key("ctrl+shift+z");
    desktop.see("the second picture again", |screen| screen.agrees(&second, inside).then_some(()));
    desktop.drag(corner, [corner[0] + 60, corner[1]]);
    desktop.see("picture C", |screen| (screen.small_balls() == 3).then_some(()));
}

#[test]
fn a_small_display_has_room_for_the_picture_and_esc_closes_the_help() {
    let Some(mut desktop) = Desktop::new([640, 400]) else { return };
    desktop.write("scene.txt", SCENE);
    desktop.start(Some("scene.txt"));
    let ball = desktop.see("the ball", Screen::ball);
    assert!(ball.size()[1] > 40, "{ball:?}");
    let [width, height] = desktop.window_size();
    assert!(width <= 640 && height <= 400, "{width} x {height}");
    let before = desktop.rest();
    desktop.key("F1");
    desktop.see("the help", |screen| screen.ball().is_none_or(|seen| seen != ball).then_some(()));
    desktop.rest();
    desktop.key("Escape");
    let inside = [ball.min, ball.max];
    desktop.see("the picture again", |screen| screen.agrees(&before, inside).then_some(()));
}

#[test]
fn chords_as_quick_as_a_macro_all_count() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    delete_ball(&mut desktop);
    desktop.keys(&["ctrl+s", "ctrl+z"]);
    desktop.see("the ball again", Screen::ball);
    desktop.wait_for_title("*scene.txt - kajo studio");
    assert!(!desktop.read("scene.txt").contains("Sphere"), "saved before it was undone");
}

#[test]
fn the_program_traces_writes_pictures_and_saves_the_view() {
    let Some(mut desktop) = Desktop::with_scene() else { return };
    desktop.key("Return");
    desktop.see("a finished picture", |screen| (screen.small_balls() == 1).then_some(()));
    choose(&mut desktop, "ctrl+e", "picture.png");
    let size = desktop.until("a file of the picture", |desktop| {
        let bytes = std::fs::read(desktop.path("picture.png")).ok()?;
        let number = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
        Some([number(16)?, number(20)?])
    });
    assert!(size[0] > 400 && size[1] > 250, "as large as the viewport: {size:?}");
    // The dialog takes what is done while it goes away.
    desktop.wait_for_no_question();
    desktop.rest();
    // A drag turns the camera, and the view goes into the scene, and that into its file.
    let ball = desktop.see("the ball", Screen::ball);
    let corner = [ball.min[0] - 100, ball.min[1]];
    desktop.drag(corner, [corner[0] + 60, corner[1]]);
    desktop.see("another picture", |screen| (screen.small_balls() == 2).then_some(()));
    desktop.key("ctrl+shift+c");
    desktop.wait_for_title("*scene.txt - kajo studio");
    desktop.key("ctrl+s");
    desktop.wait_for_title("scene.txt - kajo studio");
    let saved = desktop.read("scene.txt");
    let [rest, own] = [&saved, SCENE].map(|text| text.split_once("up 0 1 0").expect("a camera").1);
    assert_eq!(rest, own);
    assert!(saved.starts_with("// A comment that stays.\nPerspectiveCamera { center "), "{saved}");
    assert_ne!(saved, SCENE);
}
