//! The debug ray by script: it stays where it was shot, its pixel is marked, its rows say what they are.

mod common;

use common::Window;
use egui::{Event, Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use kajo::IntegratorName;
use kajo::kajo_math::DVec2;
use kajo_edit::FieldValue;
use kajo_studio::state::{Action, Studio};

/// Where the debug ray ends first, in the world.
fn first_hit(window: &mut Window) -> [f64; 3] {
    let rays = window.studio().rays.as_ref().expect("a debug ray");
    rays.ray.segments[0].hit.expect("something there").p.to_array().map(f64::from)
}

/// The middle of the marked pixel in the window.
fn marked(window: &mut Window) -> Option<Pos2> {
    let area = window.app().area().unwrap();
    let studio = window.studio();
    let [corner, sides] = studio.rays.as_ref()?.pixel(&studio.camera, area.size)?;
    assert!(sides.distance(DVec2::ONE) < 0.5, "about a pixel: {sides}");
    Some(area.point(corner + 0.5 * sides))
}

fn shoot(window: &mut Window, at: Pos2) {
    window.harness.hover_at(at);
    window.frames(2);
    window.key(Key::E);
}

#[test]
fn the_ray_stays_with_its_pixel_when_panels_open_and_the_scene_is_edited() {
    let mut window = Window::new();
    let ball = window.point([-2.6, 1.4, 1.3]);
    let before = window.app().area().unwrap().size;
    shoot(&mut window, ball);
    window.frames(10);
    let after = window.app().area().unwrap().size;
    assert!(after[1] < before[1], "the table takes its place: {before:?} {after:?}");
    let hit = first_hit(&mut window);
    let mark = marked(&mut window).unwrap();
    let there = window.point(hit);
    assert!(mark.distance(there) < 1.5, "{mark:?} {there:?}");

    let crate_ = window.studio().document.as_ref().unwrap();
    let node = crate_.outline().nodes().iter().find(|node| node.name.as_deref() == Some("crate")).unwrap().id;
    let value = FieldValue::numbers([3.0, 2.5, 1.0]);
    window.studio().apply(Action::SetField { node, key: "max".into(), nth: 0, value });
    window.studio().apply(Action::EndDrag);
    window.frames(10);
    assert_eq!(first_hit(&mut window), hit, "an edit elsewhere does not move it");
    assert!(marked(&mut window).unwrap().distance(mark) < 0.01);

    // From elsewhere one sees the ray, but its pixel is in no picture.
    window.studio().apply(Action::Orbit(DVec2::new(40.0, 0.0)));
    window.frames(2);
    assert_eq!(marked(&mut window), None);
    window.key(Key::Home);
    assert!(marked(&mut window).unwrap().distance(mark) < 0.01);
}

#[test]
fn a_row_under_the_pointer_lights_its_ray_up() {
    let mut window = Window::new();
    let ball = window.point([-1.3, 0.5, 1.2]);
    shoot(&mut window, ball);
    window.frames(10);
    let wide = |window: &mut Window| window.studio().lines().iter().filter(|line| line.width == 4.0).count();
    assert_eq!(wide(&mut window), 0);
    let labels: Vec<String> = {
        let rays = window.studio().rays.as_ref().unwrap();
        let segments = rays.ray.segments.iter().enumerate();
        segments.map(|(i, s)| format!("Segment {i} {}", kajo_studio::state::ray_kind(s.kind))).collect()
    };
    let row = window.harness.get_by_label(&labels[1]).rect().center();
    window.harness.hover_at(row);
    window.frames(3);
    assert_eq!(window.studio().rays.as_ref().unwrap().hovered, Some(1));
    assert_eq!(wide(&mut window), 2, "the way from the camera");
    window.harness.hover_at(ball - vec2(0.0, 40.0));
    window.frames(3);
    assert_eq!(wide(&mut window), 0);
    assert!(window.harness.query_by_label("from the camera").is_some(), "colours are explained");
    assert!(window.harness.query_by_label("normal").is_some());
}

#[test]
fn shadow_rows_say_which_light_they_reach_and_what_is_before_it() {
    let mut window = Window::new();
    let texts = |window: &mut Window| {
        let studio = window.studio();
        let segments = studio.rays.as_ref().unwrap().ray.segments.clone();
        let shadow = segments.iter().filter(|s| s.kind == kajo::probe::RayKind::Shadow);
        shadow.map(|segment| studio.names_of(segment).0).collect::<Vec<_>>()
    };
    let bright = window.point([0.0, -1.0, 2.0]);
    shoot(&mut window, bright);
    assert_eq!(texts(&mut window), ["reaches sun #1"]);
    // Below the ball, on the side that the light does not come from.
    let dark = window.point([-3.0, -1.0, -0.5]);
    shoot(&mut window, dark);
    assert_eq!(texts(&mut window), ["sun #1: blocked by ball #1"]);
}

#[test]
fn the_key_that_is_held_shoots_wherever_the_pointer_goes() {
    let mut window = Window::new();
    let from = window.point([-2.0, 1.0, 1.5]);
    window.harness.hover_at(from);
    window.frames(2);
    window.harness.key_down(Key::E);
    window.frames(10);
    let first = first_hit(&mut window);
    // The system presses a key again that is held; the pointer rests, though the picture under it has changed.
    for _ in 0..3 {
        let (key, modifiers) = (Key::E, Modifiers::NONE);
        window.harness.event(Event::Key { key, physical_key: None, pressed: true, repeat: true, modifiers });
        window.frames(2);
    }
    assert_eq!(first_hit(&mut window), first);
    let mut seen = vec![first];
    for step in 1..=4 {
        window.harness.hover_at(from + vec2(12.0 * step as f32, 0.0));
        window.frames(2);
        let hit = first_hit(&mut window);
        assert!(!seen.contains(&hit), "{hit:?}");
        let there = window.point(hit);
        assert!(there.distance(from + vec2(12.0 * step as f32, 0.0)) < 1.5, "under the pointer: {there:?}");
        seen.push(hit);
    }
    window.harness.key_up(Key::E);
    window.frames(2);
    let last = first_hit(&mut window);
    window.harness.hover_at(from + vec2(-30.0, 0.0));
    window.frames(2);
    assert_eq!(first_hit(&mut window), last, "no more than while it is held");
}

#[test]
fn other_samples_of_the_pixel_can_be_followed() {
    let mut window = Window::new();
    window.studio().options.asked.integrator = Some(IntegratorName("path"));
    let floor = window.point([0.0, -1.0, 2.0]);
    shoot(&mut window, floor);
    let first = window.studio().rays.clone().unwrap();
    assert_eq!((first.sample, first.samples), (0, 64));
    window.studio().apply(Action::DebugSample(5));
    let other = window.studio().rays.clone().unwrap();
    assert_eq!(other.sample, 5);
    assert_eq!(first.ray.segments[0].hit.unwrap().p, other.ray.segments[0].hit.unwrap().p, "the same place");
    assert_ne!(first.ray, other.ray);
    window.studio().apply(Action::DebugSample(1000));
    assert_eq!(window.studio().rays.as_ref().unwrap().sample, 63);
}

/// The first ray of an integrator with a map waits for it, without the window; the next ones have it, and Escape ends the wait.
#[test]
fn rays_of_integrators_that_prepare_something_come_when_that_is_done() {
    let mut window = Window::new();
    let ask = |window: &mut Window, photons: u32| {
        let asked = &mut window.studio().options.asked;
        asked.integrator = Some(IntegratorName("photon"));
        asked.photons = Some(photons);
    };
    ask(&mut window, 2000);
    let ball = window.point([-2.6, 1.4, 1.3]);
    shoot(&mut window, ball);
    let is_there = |studio: &Studio| studio.rays.as_ref().is_some_and(|rays| !rays.is_awaited);
    window.wait(is_there);
    let first = window.studio().rays.as_ref().unwrap();
    assert!(!first.is_awaited && !first.ray.segments.is_empty());
    // The bottom panel has opened, so the next picture is of another size.
    shoot(&mut window, ball);
    window.wait(is_there);
    window.harness.hover_at(ball + vec2(4.0, 0.0));
    window.frames(2);
    window.harness.key_press(Key::E);
    window.harness.step();
    assert!(!window.studio().rays.as_ref().unwrap().is_awaited, "nothing is prepared again");
    window.wait(is_there);

    ask(&mut window, 1 << 24);
    shoot(&mut window, ball);
    assert!(window.studio().rays.as_ref().unwrap().is_awaited && window.studio().rays_progress().is_some());
    window.key(Key::Escape);
    assert!(window.studio().rays.is_none() && window.studio().rays_progress().is_none());
    shoot(&mut window, ball);
    window.harness.get_by_label("Stop").click();
    window.wait(|studio| studio.rays.is_none() && studio.rays_progress().is_none());
}
