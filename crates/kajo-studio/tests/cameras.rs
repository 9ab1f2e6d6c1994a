//! Cameras whose picture is not flat: what the preview shows is what is clicked on, shot at and dragged.

mod common;

use common::{SCENE, Window};
use egui::{Key, PointerButton, Vec2, vec2};
use kajo::View;
use kajo::kajo_math::{DVec2, DVec3};
use kajo_studio::state::{Action, Shown};
use kajo_testkit::every;

/// A point of the ball that faces the camera.
const ON_BALL: DVec3 = DVec3::new(-1.6, 1.4, 1.3);

/// A window that shows the scene through another camera.
fn through(camera: &str) -> Window {
    let home = "PerspectiveCamera { center 0 1 10  direction 0 0 -1  up 0 1 0  angle 40 }";
    let basis = "center 0 1 6  direction 0 0 -1  up 0 1 0";
    let (keyword, keys) = camera.split_once(' ').unwrap_or((camera, ""));
    let mut window = Window::with(&SCENE.replace(home, &format!("{keyword} {{ {basis}  {keys} }}")), false);
    window.wait(|studio| studio.sight_is_current());
    window
}

fn positions(window: &mut Window, p: DVec3) -> Vec<DVec2> {
    let size = window.app().area().unwrap().size;
    window.studio().camera.projections(p, size).into_iter().flatten().collect()
}

const CAMERAS: [(&str, usize); 6] = [
    ("FisheyeCamera angle 150  projection stereographic", 1),
    ("FisheyeCamera angle 200  fit corners", 1),
    ("PanoramaCamera", 1),
    ("PanoramaCamera stereo omnidirectional  eyeSeparation 0.3", 2),
    ("StereoCubemapCamera eyeSeparation 0.3", 2),
    ("StereoCubemapCamera stereo omnidirectional", 2),
];

#[test]
fn clicks_and_debug_rays_find_what_the_preview_shows() {
    for (camera, eyes) in CAMERAS {
        let mut window = through(camera);
        let seen = positions(&mut window, ON_BALL);
        assert_eq!(seen.len(), eyes, "{camera}");
        for eye in 0..eyes {
            window.wait(|studio| studio.sight_is_current());
            let place = positions(&mut window, ON_BALL)[eye];
            assert_eq!(window.studio().sight().unwrap().object(place), 1, "{camera}: drawn at {place}");
            let at = window.app().area().unwrap().point(place);
            window.click(at);
            assert_eq!(window.selected(), ["Sphere ball"], "{camera}: clicked at {place}");
            window.harness.hover_at(at);
            window.frames(2);
            window.key(Key::E);
            let hit = window.studio().rays.as_ref().unwrap().ray.segments[0].hit.unwrap();
            assert!(hit.p.as_dvec3().distance(ON_BALL) < 0.3, "{camera}: {}", hit.p);
            window.studio().apply(Action::ClearDebugRay);
            window.studio().apply(Action::Select(Vec::new()));
            window.app().layout.bottom = None;
            window.frames(5);
        }
    }
}

#[test]
fn handles_follow_the_pointer_in_every_picture() {
    for (camera, eyes) in CAMERAS {
        for eye in 0..eyes {
            let mut window = through(camera);
            window.select("ball");
            window.wait(|studio| studio.sight_is_current());
            let from = positions(&mut window, DVec3::new(-2.0, 1.0, 0.0))[eye];
            let area = window.app().area().unwrap();
            // A few pixels are much in the small faces of a cube.
            let by = if camera.starts_with("StereoCubemap") { vec2(-4.0, -6.0) } else { vec2(-24.0, -15.0) };
            window.drag(PointerButton::Primary, area.point(from), by);
            let document = window.studio().document.as_ref().unwrap();
            let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
            let center = DVec3::from_array(document.value(ball, "center").unwrap().vec3().unwrap());
            assert!(center.x < -2.1 && center.y > 1.1, "{camera}: {center}");
            let there = area.point(positions(&mut window, center)[eye]);
            let goal = area.point(from) + by;
            assert!(there.distance(goal) < 1.5, "{camera}: {there:?} {goal:?}");
        }
    }
}

/// The columns and rows of a traced picture in which an object is, as shares of it: left, right, top, bottom.
fn traced_edges(window: &mut Window, object: f32) -> [f64; 4] {
    let frame = window.studio().picture().unwrap();
    let [width, height] = frame.size();
    let mut edges = [1.0f64, 0.0, 1.0, 0.0];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        if frame.value(View::Object, x, y).unwrap()[0] == object {
            let [u, v] = [[x, width], [y, height]].map(|[at, of]| (f64::from(at) + 0.5) / f64::from(of));
            edges = [edges[0].min(u), edges[1].max(u), edges[2].min(v), edges[3].max(v)];
        }
    }
    edges
}

/// The same in the preview, of the ball.
fn previewed_edges(window: &mut Window) -> [f64; 4] {
    let size = window.app().area().unwrap().size;
    let camera = window.studio().camera.clone();
    let mut edges = [1.0f64, 0.0, 1.0, 0.0];
    for i in 0..4000 {
        // Points all over the ball.
        let z = 1.0 - (f64::from(i) + 0.5) / 2000.0;
        let turn = 2.399_963 * f64::from(i);
        let r = (1.0 - z * z).sqrt();
        let p = DVec3::new(-2.0, 1.0, 0.0) + 1.5 * DVec3::new(r * turn.cos(), r * turn.sin(), z);
        let at = camera.project(p, size).unwrap();
        let [u, v] = [at.x / f64::from(size[0]), at.y / f64::from(size[1])];
        edges = [edges[0].min(u), edges[1].max(u), edges[2].min(v), edges[3].max(v)];
    }
    edges
}

#[test]
fn a_fitted_camera_fits_the_picture_of_the_window() {
    let home = "PerspectiveCamera { center 0 1 10  direction 0 0 -1  up 0 1 0  angle 40 }";
    for camera in [
        "PerspectiveCamera { fit ball 0.1 }",
        "PerspectiveCamera { fit ball 0.1  center 1 2 7 }",
        "OrthographicCamera { fit ball 0.1  direction 0 -0.2 -1 }",
    ] {
        let mut window = Window::with(&SCENE.replace(home, camera), false);
        for size in every(2, [Vec2::new(1500.0, 420.0), Vec2::new(700.0, 1000.0)]) {
            window.harness.set_size(size);
            window.studio().shown = Shown::Preview;
            window.frames(4);
            let [width, height] = window.app().area().unwrap().size;
            assert_eq!(width > height, size.x > size.y, "{width} x {height}");
            let place = window.app().area().unwrap().size.map(f64::from);
            let [width, height] = place;
            window.studio().apply(Action::DebugRay(DVec2::new(0.5 * width, 0.5 * height)));
            let met = window.studio().rays.as_ref().unwrap().ray.segments[0].hit.unwrap().p;

            let previewed = previewed_edges(&mut window);
            // What fits best touches the margin at two edges that lie opposite to each other.
            let margins = [
                (previewed[0] - 0.1).abs().max((previewed[1] - 0.9).abs()),
                (previewed[2] - 0.1).abs().max((previewed[3] - 0.9).abs()),
            ];
            assert!(margins[0].min(margins[1]) < 0.005, "{camera} in {size}: {previewed:?}");
            assert!(previewed[0] > 0.095 && previewed[1] < 0.905, "{camera} in {size}: {previewed:?}");
            assert!(previewed[2] > 0.095 && previewed[3] < 0.905, "{camera} in {size}: {previewed:?}");

            window.key(Key::Enter);
            window.wait(|studio| {
                studio.progress().is_none() && studio.picture().is_some_and(|frame| frame.samples() > 0)
            });
            let traced = traced_edges(&mut window, 1.0);
            let apart = traced.iter().zip(previewed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 0.01, "{camera} in {size}: {traced:?} {previewed:?}");
            // A finished picture stays what it is in a window of another shape, and so does the debug ray.
            let job = window.studio().picture().unwrap().job();
            window.harness.set_size(Vec2::new(1000.0, 700.0));
            window.frames(4);
            assert_eq!(window.studio().picture().unwrap().job(), job);
            assert!(window.studio().progress().is_none());
            window.studio().shown = Shown::Preview;
            window.frames(4);
            let rays = window.studio().rays.as_ref().unwrap();
            let again = rays.ray.segments[0].hit.unwrap().p;
            assert!(again.distance(met) < 0.02, "{camera} in {size}: {met} {again}");
        }
    }
}
