//! Warnings of scenes that are too large, too small or too far away for numbers of single precision.

use kajo_math::Aabb;
use kajo_scene::{Diagnostic, Diagnostics};

use crate::scene::Scene;
use crate::shape::Surface;

/// Squares of longer distances are infinite, those of shorter ones lose digits, and light falls off with the square.
const LONGEST: f64 = 1e18;
const SHORTEST: f64 = 1e-18;

/// How many times farther away than it is wide a mesh may be: its corners are then off by a thousandth of its width.
const FARTHEST_MESH: f64 = (1 << 14) as f64;
/// The same of other objects, which are off as a whole: by a sixteenth of their width.
const FARTHEST: f64 = (1 << 20) as f64;

/// Warns of what will not look right.
pub(super) fn check(scene: &Scene, diagnostics: &mut Diagnostics) {
    let mut boxes =
        scene.geometry.primitives.iter().map(|primitive| scene.geometry.shapes.bounds(primitive.shape));
    let far = boxes.find(|bounds| is_farther(bounds, FARTHEST));
    let far_mesh = scene
        .geometry
        .shapes
        .meshes
        .iter()
        .map(Surface::bounds)
        .find(|bounds| is_farther(bounds, FARTHEST_MESH));
    if let Some(bounds) = far_mesh.or(far) {
        let [x, y, z] = bounds.center().to_array();
        let message = format!(
            "an object {:.1e} wide is written at {x} {y} {z}: there, numbers of seven digits blur its shape",
            width(&bounds)
        );
        let help =
            "write it near the origin and move it with a `Transform`, or move everything and the camera";
        diagnostics.push(Diagnostic::warning(message).help(help));
    }
    // Parallel light does not fall off, but where it is followed from its source it comes through a disc of that size.
    let lights = scene.lighting.sampler.list().iter().filter_map(|&id| scene.lighting.lights.bounds(id));
    let all = lights.fold(scene.geometry.bounds(), |all, light| all.union(light.bounds));
    if all.is_empty() {
        return;
    }
    let width = width(&all);
    if width > LONGEST || (width > 0.0 && width < SHORTEST) {
        let message = format!(
            "the scene is {width:.0e} wide: the square of that is beyond the numbers light is reckoned with"
        );
        let help = "write it in another unit of length; from 1e-18 to 1e18 light falls off as it should";
        diagnostics.push(Diagnostic::warning(message).help(help));
    }
}

fn is_farther(bounds: &Aabb, times: f64) -> bool {
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let width = width(bounds);
    farthest.is_finite() && width > 0.0 && f64::from(farthest) > times * width
}

/// The diagonal, which may be longer than the largest number of single precision is the square of.
fn width(bounds: &Aabb) -> f64 {
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length()
}

#[cfg(test)]
mod tests {
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};

    fn warnings(blocks: &str) -> Vec<String> {
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
            Materials { Matte a { } }";
        let mut parsed = SceneDesc::parse_str(&format!("{camera} {blocks}"));
        let mesh = "v 10000000 0 0\nv 10000001 0 0\nv 10000000 1 0\nf 1 2 3\n";
        let assets = MemoryAssets::new()
            .with("far.obj", mesh)
            .with("near.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let mut diagnostics = Diagnostics::default();
        compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        diagnostics.iter().map(|d| d.message.clone()).collect()
    }

    #[test]
    fn scenes_beyond_squares_are_warned_of() {
        let scene = |unit: &str, light: &str| {
            warnings(&format!(
                "Lights {{ {light} }} Group {{ MaterialIndex a Sphere {{ center 0 0 0 radius 1e{unit} }} }}"
            ))
        };
        let point = |unit: &str| scene(unit, &format!("PointLight {{ position 0 1e{unit} 0 intensity 1 }}"));
        for unit in ["-17", "0", "17"] {
            assert_eq!(point(unit), [""; 0], "{unit}");
        }
        for unit in ["-25", "19", "30"] {
            let said = point(unit);
            assert!(said.len() == 1 && said[0].contains("square of that"), "{unit}: {said:?}");
        }
        assert_eq!(scene("30", "DirectionalLight { direction 0 -1 0 color 1 }").len(), 1);
        let floor = "Lights { DirectionalLight { direction 0 -1 0 color 1 } }
            Group { MaterialIndex a Plane { normal 0 1 0 offset 0 } }";
        assert_eq!(warnings(floor), [""; 0], "nothing in it has an end");
    }

    #[test]
    fn objects_far_from_the_origin_are_warned_of() {
        let objects = |text: &str| warnings(&format!("Group {{ MaterialIndex a {text} }}"));
        let said = objects("TriangleMesh { obj_file far.obj }");
        assert!(said.len() == 1 && said[0].contains("wide is written at 1000000"), "{said:?}");
        assert_eq!(objects("Triangle { vertex0 1e8 0 0 vertex1 100000016 0 0 vertex2 1e8 16 0 }").len(), 1);
        assert_eq!(objects("Box { min 3e7 0 0 max 30000004 1 1 }").len(), 1);
        for fine in [
            "Sphere { center 1e5 0 0 radius 1 }",
            "Plane { normal 0 1 0 offset 1e9 }",
            "Transform { Translate 1e8 0 0 TriangleMesh { obj_file near.obj } }",
        ] {
            assert_eq!(objects(fine), [""; 0], "{fine}");
        }
    }
}
