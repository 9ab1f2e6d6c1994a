//! What a set operation takes away: seen as dim edges, picked by them, and dragged.

mod common;

use common::{Window, carved_scene as scene};
use egui::{PointerButton, vec2};
use kajo_edit::preview::LineKind;
use kajo_studio::state::Action;

#[test]
fn an_edge_of_what_is_taken_away_is_picked_and_its_handle_dragged() {
    let mut window = Window::with(&scene(), false);
    // In the air beside the box, where nothing is hit.
    let edge = window.point([0.2, 2.0, 1.0]);
    window.click(edge);
    assert_eq!(window.selected(), ["Sphere bite"]);
    let beside = window.point([-0.2, 2.6, 1.0]);
    window.click(beside);
    assert!(window.selected().is_empty(), "{:?}", window.selected());
    // What is seen between edges is still picked.
    let face = window.point([2.5, 0.5, 1.0]);
    window.click(face);
    assert_eq!(window.selected(), ["Difference carved"]);
    window.click(edge);
    let before = window.point([1.0, 2.0, 1.0]);
    window.drag(PointerButton::Primary, before, vec2(48.0, 20.0));
    let text = window.text();
    let center: Vec<f64> = text
        .split("Sphere bite { center ")
        .nth(1)
        .unwrap()
        .split_whitespace()
        .take(3)
        .map(|word| word.parse().unwrap())
        .collect();
    let after = window.point([center[0], center[1], center[2]]);
    assert!((after - before - vec2(48.0, 20.0)).length() < 0.5, "{:?}", after - before);
    // The edges have gone along.
    window.wait(|studio| studio.preview_is_current());
    let moved = window.point([center[0] - 0.8, center[1], center[2]]);
    window.studio().apply(Action::Select(Vec::new()));
    window.click(moved);
    assert_eq!(window.selected(), ["Sphere bite"]);
}

#[test]
fn edges_are_dim_until_they_are_chosen() {
    let mut window = Window::with(&scene(), false);
    let opacities = |window: &mut Window| {
        let studio = window.studio();
        let wires = studio.preview.as_ref().unwrap().1.lines.clone();
        let drawn = studio.lines();
        let mut found: Vec<u8> = wires
            .iter()
            .zip(&drawn)
            .filter(|(wire, _)| matches!(wire.kind, LineKind::Subtracted(_)))
            .map(|(_, line)| line.color[3])
            .collect();
        assert!(found.len() > 100, "{}", found.len());
        found.dedup();
        found
    };
    let dim = opacities(&mut window);
    window.select("bite");
    let chosen = opacities(&mut window);
    window.select("carved");
    let within = opacities(&mut window);
    window.select("ball");
    assert!(dim.len() == 1 && chosen.len() == 1 && dim[0] < 128 && chosen[0] > 200, "{dim:?} {chosen:?}");
    assert_eq!((within, opacities(&mut window)), (chosen, dim));
}

/// On the screen: grey beside the box, where without them nothing is.
#[test]
fn edges_are_drawn() {
    let Ok(mut window) = std::panic::catch_unwind(|| Window::with(&scene(), true)) else {
        eprintln!("skipped: nothing here can draw");
        return;
    };
    window.frames(3);
    let image = window.harness.render().unwrap();
    let [near, far] = [[0.3, 1.9, 1.3], [-0.2, 3.0, 1.3]].map(|p| window.point(p));
    let differing = |at: egui::Pos2| {
        let pixel = |x: i32, y: i32| image.get_pixel((at.x as i32 + x) as u32, (at.y as i32 + y) as u32).0;
        let around = (-12..=12).flat_map(|y| (-12..=12).map(move |x| (x, y)));
        let first = pixel(-12, -12);
        around.filter(|&(x, y)| (0..3).any(|c| pixel(x, y)[c].abs_diff(first[c]) > 8)).count()
    };
    assert!(differing(near) > 20, "{}", differing(near));
    assert_eq!(differing(far), 0);
}
