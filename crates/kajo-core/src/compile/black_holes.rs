//! Whether cameras can be where they are, near black holes.

use kajo_math::Vec2;
use kajo_scene::{Diagnostic, Diagnostics};

use crate::family::Pooled;
use crate::medium::{BlackHole, BlackHoleObserver};
use crate::scene::Scene;

/// Reports a camera that cannot move as its black hole says.
pub(super) fn check_cameras(scene: &Scene, diagnostics: &mut Diagnostics) {
    let media = &scene.appearance.media;
    let holes = media.ids().filter_map(|id| BlackHole::find(media, id));
    let Some(places) = scene.output.camera.origins([Vec2::NEG_ONE, Vec2::ONE], 1.0) else { return };
    let p = places.center();
    for hole in holes.filter(|hole| !hole.may_see_from(p)) {
        let radius = hole.radius(p) / hole.hole().mass();
        let (message, help) = match hole.observer() {
            BlackHoleObserver::Rests => {
                let message = "nothing can be at rest where the camera is, so near a black hole";
                (message, "write `observer falls` in the `BlackHole`, or move the camera away from it")
            }
            BlackHoleObserver::Orbits { .. } => {
                let message = "there is no circular orbit where the camera is, and so near a black hole";
                (message, "circular orbits end where light goes around: at 3 masses without spin")
            }
            BlackHoleObserver::Falls => {
                let message = "the camera is behind the inner horizon of a black hole";
                (message, "nothing can be said of what it would see; move it away from the hole")
            }
        };
        let at = format!("the camera's radial coordinate is {radius:.3} masses; {help}");
        diagnostics.push(Diagnostic::error(message).help(at));
    }
}

#[cfg(test)]
mod tests {
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};

    /// What is said of a scene with this medium, seen from a place.
    fn said(from: &str, media: &str, material: &str) -> Vec<String> {
        let text = format!(
            "PerspectiveCamera {{ center {from}  direction 0 0 -1  up 0 1 0  angle 40 }}
             Media {{ {media} }} Materials {{ Interface space {{ medium m }} {material} }}
             Group {{ MaterialIndex space Sphere {{ center 0 0 0  radius 90 }} }}"
        );
        let mut parsed = SceneDesc::parse_str(&text);
        let mut diagnostics = Diagnostics::default();
        compile(&mut parsed.desc, &MemoryAssets::new(), &CompileOptions::default(), &mut diagnostics);
        diagnostics.iter().map(|d| d.message.clone()).collect()
    }

    #[track_caller]
    fn check(from: &str, media: &str, material: &str, expected: &str) {
        let said = said(from, media, material);
        assert!(said.iter().any(|message| message.contains(expected)), "{said:?}");
    }

    #[test]
    fn sound_scenes_are_not_complained_of() {
        for hole in ["", "spin 1", "spin -0.5 observer orbits", "observer falls", "mass 0.5 axis 1 1 0"] {
            let gas = "AccretionDisk gas { hole m  temperature 4000  pattern = 0.5 + 0.5 * sin(x) }";
            assert_eq!(said("0 0 12", &format!("BlackHole m {{ {hole} }}"), gas), Vec::<String>::new());
        }
        assert_eq!(said("0 0 1.5", "BlackHole m { observer falls }", ""), Vec::<String>::new());
    }

    #[test]
    fn cameras_are_where_they_can_be() {
        check("0 0 1.5", "BlackHole m { }", "", "nothing can be at rest");
        check("0 0 1.9", "BlackHole m { spin 0.9 }", "", "nothing can be at rest");
        check("0 0 2.5", "BlackHole m { observer orbits }", "", "no circular orbit");
        check("0 0.2 0", "BlackHole m { spin 0.9 observer falls }", "", "inner horizon");
    }

    #[test]
    fn holes_and_wormholes_that_cannot_be() {
        check("0 0 9", "BlackHole m { spin 1.1 }", "", "spin");
        check("0 0 9", "BlackHole m { mass 0 }", "", "mass");
        check("0 0 9", "BlackHole m { axis 0 0 0 }", "", "axis");
        check(
            "0 0 9",
            "Medium m { sigma_a 1 }",
            "AccretionDisk gas { hole m }",
            "gas goes around a `BlackHole`",
        );
        let wormhole = |rest: &str| format!("Wormhole m {{ mouth 0 0 0  other 9 0 0  {rest} }}");
        check("0 0 20", &wormhole("radius 1 throat 2"), "", "`radius` is more than that");
        check("0 0 20", &wormhole("radius 5 throat 1"), "", "at least twice");
        check("0 0 20", &wormhole("radius 2 throat 1 up 0 0 1"), "", "along `up`");
    }
}
