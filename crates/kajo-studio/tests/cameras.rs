//! Cameras whose picture is not flat: what the preview shows is what is clicked on, shot at and dragged.

mod common;

use common::{SCENE, Window};
use egui::{Key, PointerButton, vec2};
use kajo::kajo_math::{DVec2, DVec3};
use kajo_studio::state::Action;

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

fn places(window: &mut Window, p: DVec3) -> Vec<DVec2> {
    let size = window.app().area().unwrap().size;
    window.studio().camera.places(p, size).into_iter().flatten().collect()
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
        let seen = places(&mut window, ON_BALL);
        assert_eq!(seen.len(), eyes, "{camera}");
        for eye in 0..eyes {
            window.wait(|studio| studio.sight_is_current());
            let place = places(&mut window, ON_BALL)[eye];
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
            let from = places(&mut window, DVec3::new(-2.0, 1.0, 0.0))[eye];
            let area = window.app().area().unwrap();
            // A few pixels are much in the small faces of a cube.
            let by = if camera.starts_with("StereoCubemap") { vec2(-4.0, -6.0) } else { vec2(-24.0, -15.0) };
            window.drag(PointerButton::Primary, area.point(from), by);
            let document = window.studio().document.as_ref().unwrap();
            let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
            let center = DVec3::from_array(document.value(ball, "center").unwrap().vec3().unwrap());
            assert!(center.x < -2.1 && center.y > 1.1, "{camera}: {center}");
            let there = area.point(places(&mut window, center)[eye]);
            let goal = area.point(from) + by;
            assert!(there.distance(goal) < 1.5, "{camera}: {there:?} {goal:?}");
        }
    }
}
