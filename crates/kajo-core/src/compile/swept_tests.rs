//! Shapes made of paths, as they are written.

use kajo_math::{Ray, Vec3};
use kajo_scene::{MemoryAssets, SceneDesc};

use super::tests::scene;
use super::*;
use crate::scene::RayEvent;

const HEAD: &str = "PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }
Materials { Material red { diffuseColor 1 0 0 } }\n";

fn of(group: &str) -> Scene {
    scene(&format!("{HEAD}Group {{ MaterialIndex red {group} }}"))
}

/// How high what a ray down the z axis from (x, y) meets first is.
fn height(scene: &Scene, x: f32, y: f32) -> Option<f32> {
    match scene.trace(&Ray::new(Vec3::new(x, y, 10.0), Vec3::NEG_Z)) {
        RayEvent::Surface(at) => Some((at.point.p.z * 1e4).round() / 1e4),
        RayEvent::Escaped => None,
    }
}

/// Everything that is said about a group.
fn said(group: &str) -> (bool, String) {
    let mut parsed = SceneDesc::parse_str(&format!("{HEAD}Group {{ MaterialIndex red {group} }}"));
    let mut diagnostics = parsed.diagnostics;
    let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &CompileOptions::default(), &mut diagnostics);
    (scene.is_some(), diagnostics.iter().map(|diagnostic| format!("{diagnostic:?}\n")).collect())
}

/// Checks that a group is refused, and that the reason has these words.
fn is_refused(group: &str, words: &str) {
    let (accepted, said) = said(group);
    assert!(!accepted && said.contains(words), "{group}: {said}");
}

#[test]
fn prisms_are_where_they_are_written() {
    let scene = of("Prism { depth 0.5  outline { line 0 0  2 0  2 1 } }");
    assert_eq!(height(&scene, 1.5, 0.25), Some(0.5));
    assert_eq!((height(&scene, 0.5, 0.75), height(&scene, -0.5, -0.5)), (None, None));
    // Lying: what is up in the outline points away, and `size` is that of its unit.
    let lying = "origin 0 0 -1  axis 0 1 0  size 2  depth 0.5  outline { line 0 0  1 0  1 1  0 1 }";
    let scene = of(&format!("Prism {{ {lying} }}"));
    assert_eq!((height(&scene, 1.9, 0.25), height(&scene, 1.9, 0.6)), (Some(-1.0), None));
    let scene = of(&format!("Prism {{ up 1 0 0  {lying} }}"));
    assert_eq!((height(&scene, 1.9, 0.25), height(&scene, -0.1, 0.25)), (Some(1.0), None));
}

#[test]
fn outlines_go_on_from_item_to_item() {
    // A parabola upon a square, and a round hole.
    let scene = of("Prism {
      depth 1  fill evenodd
      outline { line 0 0  1 0  1 1  quadratic 0.5 2  0 1 }
      outline { spline 0.5 0.3  0.7 0.5  0.5 0.7  0.3 0.5 }
    }");
    assert_eq!((height(&scene, 0.1, 0.1), height(&scene, 0.5, 1.45)), (Some(1.0), Some(1.0)));
    assert_eq!((height(&scene, 0.5, 0.5), height(&scene, 0.5, 1.55)), (None, None));
    // A tip, half way up half as large.
    let scene = of("Prism { depth 1  taper 0  outline { line -1 -1  1 -1  1 1  -1 1 } }");
    assert_eq!((height(&scene, 0.5, 0.0), height(&scene, 0.2, -0.25)), (Some(0.5), Some(0.75)));
    // Repeated corners.
    let scene = of("Prism { depth 1  outline { repeat i 8 { line cos(i * 45 deg) sin(i * 45 deg) } } }");
    assert_eq!((height(&scene, 0.9, 0.0), height(&scene, 0.7, 0.7)), (Some(1.0), Some(1.0)));
}

#[test]
fn mistakes_in_outlines_are_told() {
    is_refused("Prism { depth 1 }", "`Prism` needs `outline`");
    is_refused("Prism { outline { line 0 0 1 0 1 1 } }", "`Prism` needs `depth`");
    is_refused("Prism { depth 1  outline { } }", "this `outline` goes nowhere");
    is_refused("Prism { depth 1  outline { line 0 0 1 } }", "groups of 2 after `line`, found 3");
    is_refused("Prism { depth 1  outline { cubic 0 0 1 0 1 1 } }", "`cubic` goes on by three points each");
    is_refused("Prism { depth 1  outline { line 0 0 1 0  quadratic 1 1 } }", "`quadratic` goes on by pairs");
    is_refused("Prism { depth 1  outline { line 0 0 1 0 1 x } }", "line");
    is_refused(
        "Prism { depth 1  outline { line 0 0 1 1 2 2 } }",
        "all points of this outline are on one line",
    );
    is_refused("Prism { depth 1  outline { spline 1 1 1 1 1 1 } }", "on one line");
    is_refused("Prism { depth 1  outline { arc 0 0 } }", "unknown word `arc`");
    is_refused("Prism { depth 0  outline { line 0 0 1 0 1 1 } }", "`depth` must be more than 0");
    is_refused("Prism { depth 1  taper -1  outline { line 0 0 1 0 1 1 } }", "`taper`");
    is_refused("Prism { depth 1  up 0 0 2  outline { line 0 0 1 0 1 1 } }", "`up` points along the axis");
    is_refused("Prism { depth 1  outline { line 0 0 1e39 0 1 1 } }", "between -3.4e38 and 3.4e38");
    // What is all but too large is no panic.
    assert!(said("Prism { depth 1  outline { line 0 0 3e38 0 1 3e38 } }").1.len() < 1000);
}

#[test]
fn what_gives_no_light_says_so() {
    let text = format!(
        "{}Group {{ MaterialIndex lit Prism {{ depth 1  outline {{ line 0 0 1 0 1 1 }} }} }}",
        HEAD.replace("diffuseColor 1 0 0 }", "diffuseColor 1 0 0 } Matte lit { emission 1 1 1 }")
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let mut diagnostics = parsed.diagnostics;
    compile(&mut parsed.desc, &MemoryAssets::new(), &CompileOptions::default(), &mut diagnostics);
    let warned =
        diagnostics.iter().any(|said| said.message == "a prism gives no light, whatever its material says");
    assert!(warned, "{diagnostics:?}");
}

#[test]
fn lathes_are_where_they_are_written() {
    // A cylinder that lies along x, two units long.
    let scene = of("Lathe { axis 1 0 0  size 2  profile { line 0 0  0.5 0  0.5 1  0 1 } }");
    assert_eq!((height(&scene, 1.5, 0.0), height(&scene, 2.5, 0.0)), (Some(1.0), None));
    // A ring of glass, and its hole; the last point is the first one.
    let scene = of("Lathe { axis 0 0 1  profile { spline 1 0  1.5 0.5  1 1  0.75 0.5  1 0 } }");
    assert_eq!((height(&scene, 1.0, 0.0), height(&scene, 0.5, 0.0)), (Some(1.0), None));
    // A sheet, which is no solid; and an operand that is one.
    is_refused(
        "Difference { Lathe { profile { line 1 0  1 1 } }  Sphere { center 0 0 0  radius 1 } }",
        "must have an inside",
    );
    let scene = of("Difference {
      Lathe { axis 0 0 1  profile { line 0 0  1 0  1 1  0 1 } }
      Lathe { axis 0 0 1  origin 0 0 0.5  profile { line 0 0  0.5 0  0.5 1  0 1 } }
    }");
    assert_eq!((height(&scene, 0.75, 0.0), height(&scene, 0.25, 0.0)), (Some(1.0), Some(0.5)));
}

#[test]
fn mistakes_in_profiles_are_told() {
    is_refused("Lathe { }", "`Lathe` needs `profile`");
    is_refused("Lathe { profile { } }", "this `profile` goes nowhere");
    is_refused("Lathe { profile { line 0 0  0 1 } }", "there is nothing to turn");
    is_refused("Lathe { profile { line 0 0  -1 0  0 1 } }", "this profile crosses the axis");
    is_refused("Lathe { profile { spline 0.5 0  0 0.1  0 1 } }", "may swing beyond");
    is_refused("Lathe { profile { line 1 1  1 1 } }", "there is nothing to turn");
    is_refused("Lathe { profile { line 0 0 1e39 0 1 1 } }", "between -3.4e38 and 3.4e38");
    assert!(said("Lathe { profile { line 0 0 3e38 0 1 3e38 } }").1.len() < 1000);
}

#[test]
fn sphere_sweeps_are_where_they_are_written() {
    let scene = of("SphereSweep { path { line 0 0 0 0.5  2 0 0 0.5 } }");
    assert_eq!((height(&scene, 1.0, 0.0), height(&scene, 2.25, 0.45)), (Some(0.5), None));
    // Radii change from point to point, and paths may be several.
    let scene = of("SphereSweep { path { line 0 0 0 1  4 0 0 0 } path { spline 0 3 0 0.5  0 3 0 0.5 } }");
    assert_eq!((height(&scene, 0.0, 3.0), height(&scene, 3.9, 0.0).is_some()), (Some(0.5), true));
    let scene = of(
        "Difference { Sphere { center 0 0 0  radius 1 }  SphereSweep { path { line 0 0 1 0.25  0 0 2 0.25 } } }",
    );
    assert_eq!(height(&scene, 0.0, 0.0), Some(0.75));
}

#[test]
fn mistakes_in_sphere_sweeps_are_told() {
    is_refused("SphereSweep { }", "`SphereSweep` needs `path`");
    is_refused("SphereSweep { path { } }", "this `path` goes nowhere");
    is_refused("SphereSweep { path { line 0 0 0 1  0 0 1 } }", "groups of 4 after `line`, found 7");
    is_refused("SphereSweep { path { line 0 0 0 -1  0 0 1 1 } }", "must be");
    is_refused("SphereSweep { path { line 0 0 0 0  0 0 1 0 } }", "no ball of this sweep has a radius");
    is_refused("SphereSweep { path { line 0 0 0 1  zig 0 0 1 0 } }", "zig");
    assert!(said("SphereSweep { path { line 0 0 3e38 1  0 1 3e38 3e38 } }").1.len() < 1000);
}
