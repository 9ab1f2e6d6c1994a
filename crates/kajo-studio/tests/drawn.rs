//! What the window draws, looked at pixel by pixel, without a display. It needs something that draws with Vulkan or
//! OpenGL, Mesa's software drivers included; without any it says so and passes.

mod common;

use common::Window;
use egui::Key;
use kajo::View;
use kajo::kajo_math::DVec2;
use kajo_studio::state::{Action, Compare, Shown};

/// A window that is drawn, where that can be.
fn window() -> Option<Window> {
    let window = std::panic::catch_unwind(Window::drawn).ok();
    if window.is_none() {
        eprintln!("skipped: nothing here can draw");
    }
    window
}

/// Red, green and blue of the picture in the viewport, pixel by pixel.
fn viewport(window: &mut Window) -> ([u32; 2], Vec<[u8; 3]>) {
    let area = window.app().area().unwrap();
    let image = window.harness.render().unwrap();
    let [left, top] = [area.rect.left() as u32, area.rect.top() as u32];
    let [width, height] = area.size;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| {
        let [r, g, b, _] = image.get_pixel(left + x, top + y).0;
        [r, g, b]
    });
    ([width, height], pixels.collect())
}

/// The object that a colour of the preview belongs to: 1 the red ball, 2 the green crate, 0 anything else.
fn object_of([r, g, b]: [u8; 3]) -> u32 {
    let [r, g, b] = [r, g, b].map(i32::from);
    match () {
        () if r > 2 * g && r > 2 * b => 1,
        () if g > r + 30 && g > b + 30 => 2,
        () => 0,
    }
}

#[test]
fn the_preview_shows_what_the_tracer_sees_and_the_window_what_was_traced() {
    let Some(mut window) = window() else { return };
    window.frames(3);
    let (size, preview) = viewport(&mut window);
    window.studio().options.asked.samples = Some((kajo::SamplerKind::Regular, 1));
    window.studio().options.habits.all_layers = true;
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    window.frames(2);
    let frame = window.studio().tracer.frame().unwrap();
    assert_eq!(frame.size(), size);
    let (_, traced) = viewport(&mut window);
    let development = window.studio().settings().unwrap().unwrap().development;
    let expected = frame.rgba(View::Color, &development).unwrap();
    let mut differ = 0;
    let mut seen = [0; 3];
    for (i, (drawn, shown)) in preview.iter().zip(&traced).enumerate() {
        let [x, y] = [i as u32 % size[0], i as u32 / size[0]];
        let object = frame.value(View::Object, x, y).unwrap()[0] as u32;
        let object = if object <= 2 { object } else { 0 };
        seen[object as usize] += 1;
        differ += u32::from(object_of(*drawn) != object);
        let same = (0..3).all(|c| shown[c].abs_diff(expected[4 * i + c]) <= 1);
        assert!(same, "{x} {y}: {shown:?} and not {:?}", &expected[4 * i..4 * i + 3]);
    }
    assert!(seen.iter().all(|&n| n > 10_000), "{seen:?}");
    // Edges have a pixel to either side.
    assert!(f64::from(differ) < 0.004 * preview.len() as f64, "{differ} of {} pixels differ", preview.len());
}

/// Through every kind of camera: 1,000 pixels show the object that a click there selects.
#[test]
fn a_pixel_shows_the_object_that_is_picked_there() {
    let Some(mut window) = window() else { return };
    let basis = "center 0 1 6  direction 0 0 -1  up 0 1 0";
    for camera in [
        format!("PerspectiveCamera {{ {basis}  angle 70 }}"),
        format!("OrthographicCamera {{ {basis}  size 7 }}"),
        format!("FisheyeCamera {{ {basis}  angle 150 }}"),
        format!("PanoramaCamera {{ {basis} }}"),
        format!("PanoramaCamera {{ {basis}  stereo omnidirectional }}"),
        format!("StereoCubemapCamera {{ {basis} }}"),
    ] {
        let home = "PerspectiveCamera { center 0 1 10  direction 0 0 -1  up 0 1 0  angle 40 }";
        let path = window.path("camera.txt");
        std::fs::write(&path, common::SCENE.replace(home, &camera)).unwrap();
        window.studio().apply(Action::Open(path));
        window.wait(|studio| !studio.is_loading() && studio.scene().is_some() && studio.preview_is_current());
        window.wait(|studio| studio.camera.is_flat() || studio.sight_is_current());
        window.frames(3);
        let area = window.app().area().unwrap();
        let (scene, pose) = (window.studio().scene().unwrap().clone(), window.studio().camera.clone());
        let image = window.harness.render().unwrap();
        let (mut differ, mut seen) = (0, [0; 3]);
        for i in 0..1000 {
            let pixel = [i * 7919 % area.size[0], i * 104_729 % area.size[1]];
            let place = DVec2::from_array(pixel.map(|side| f64::from(side) + 0.5));
            let picked = kajo::probe::pick(&scene, &pose, place, area.size).map_or(0, |seen| seen.object);
            let object = if picked <= 2 { picked } else { 0 };
            let [r, g, b, _] = image.get_pixel(area.point(place).x as u32, area.point(place).y as u32).0;
            seen[object as usize] += 1;
            differ += u32::from(object_of([r, g, b]) != object);
        }
        // Edges of what the card draws have a pixel to either side.
        let most = if pose.is_flat() { 8 } else { 0 };
        assert!(differ <= most, "{camera}: {differ} of 1000 pixels differ");
        assert!(seen[1] > 3 && seen[2] > 3, "{camera}: {seen:?}");
    }
}

#[test]
fn what_is_selected_has_an_outline_and_a_debug_ray_is_drawn() {
    let Some(mut window) = window() else { return };
    let count = |pixels: &[[u8; 3]], color: [i32; 3]| {
        let near = |pixel: &&[u8; 3]| (0..3).all(|c| (i32::from(pixel[c]) - color[c]).abs() < 12);
        pixels.iter().filter(near).count()
    };
    let orange = [255, 168, 51];
    let (_, plain) = viewport(&mut window);
    assert_eq!(count(&plain, orange), 0);
    window.select("crate");
    let (_, selected) = viewport(&mut window);
    assert!(count(&selected, orange) > 300, "an outline: {}", count(&selected, orange));
    window.studio().apply(Action::Select(Vec::new()));
    // Where the normal does not point at the camera.
    let ball = window.point([-2.0, 2.06, 1.06]);
    window.harness.hover_at(ball);
    window.frames(2);
    window.key(Key::E);
    window.frames(5);
    let pink = [255, 90, 220];
    let (_, with_ray) = viewport(&mut window);
    assert!(count(&with_ray, pink) > count(&plain, pink) + 20, "the normal: {}", count(&with_ray, pink));
}

#[test]
fn a_kept_picture_is_left_of_the_wipe() {
    let Some(mut window) = window() else { return };
    window.studio().options.asked.samples = Some((kajo::SamplerKind::Regular, 1));
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    let (size, before) = viewport(&mut window);
    window.frames(3);
    window.studio().apply(Action::Compare(Compare::Wipe));
    window.studio().options.uv = true;
    let job = window.studio().tracer.frame().unwrap().job();
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().unwrap().job() > job);
    window.frames(2);
    assert_eq!(window.studio().shown, Shown::Traced);
    let (_, after) = viewport(&mut window);
    // Neither where the pictures are named nor where the wipe has its grip.
    let row = (size[1] / 4 * size[0]) as usize;
    let width = size[0] as usize;
    let same = |from: usize, to: usize| (from..to).filter(|x| before[row + x] == after[row + x]).count();
    assert_eq!(same(0, width / 2 - 2), width / 2 - 2, "the left half is the picture kept");
    assert!(same(width / 2 + 2, width) < width / 20, "the right half is the new one");
}

/// Checks on the ball and the floor, which are left of the crate and below it; the crate stays green.
#[test]
fn the_preview_shows_textures() {
    let Some(mut window) = window() else { return };
    let scene = common::SCENE
        .replace("Materials {", "Textures { Checks checks { size 0.5 } }\nMaterials {")
        .replace("PhongMaterial grey { diffuseColor 0.5 0.5 0.5 }", "Matte grey { color checks }");
    window.open(&scene);
    window.wait(|studio| !studio.is_refining_textures());
    window.frames(3);
    assert!(window.studio().fine_textures().is_some());
    let ([width, height], pixels) = viewport(&mut window);
    // Along a row of the floor below the ball, where a square is some fifty pixels wide.
    let row = &pixels[(width * (height - height / 8)) as usize..][..width as usize];
    let (dark, bright) = row.iter().partition::<Vec<[u8; 3]>, _>(|[r, ..]| *r < 60);
    assert!(dark.len() > 100 && bright.len() > 100, "{} dark, {} bright", dark.len(), bright.len());
    let turns = row.windows(2).filter(|two| (two[0][0] < 60) != (two[1][0] < 60)).count();
    assert!((4..40).contains(&turns), "{turns} edges in a row");
    let green = pixels.iter().filter(|pixel| object_of(**pixel) == 2).count();
    assert!(green > 10_000, "the crate has {green} pixels");
    // An edit shows coarse textures first, and fine ones a moment later.
    window.select("floor");
    let floor = window.studio().selection.main().unwrap();
    let (key, value) = ("offset".to_owned(), kajo_edit::FieldValue::numbers([-1.5]));
    let before = window.studio().fine_textures().cloned();
    window.studio().apply(Action::SetField { node: floor, key, nth: 0, value });
    window.wait(|studio| studio.preview_is_current() && !studio.is_compiling());
    window.wait(|studio| !studio.is_refining_textures());
    assert!(window.studio().fine_textures().is_some() && window.studio().fine_textures().cloned() != before);
}
