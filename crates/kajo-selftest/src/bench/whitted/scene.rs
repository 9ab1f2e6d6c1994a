//! The two scenes of the Whitted benchmark, as text of the classic scene language.
//!
//! * flake: a sphereflake [Haines 1987]: on each sphere nine children a third as big, six around its equator and
//!   three 35 degrees from its pole, four generations deep; 7,381 mirrors
//! * marbles: 32 × 32 spheres of random place and size, a third each half mirrors, matte and glass
//!
//! Both stand on a chequered floor under point lights without fall-off.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_6};
use std::fmt::Write;

use kajo_math::DVec3;
use kajo_math::fmath::{cos64, sin64};

use crate::bench::pcg::uniform;

/// Generations of spheres after the first.
const FLAKE_DEPTH: u32 = 4;

/// Marbles on a side of their field.
const MARBLES: u32 = 32;

/// One of the scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhittedScene {
    /// Mirrors on mirrors.
    Flake,
    /// Mirrors, matte spheres and glass.
    Marbles,
}

/// A sphere with the number of its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchSphere {
    /// Centre.
    pub center: DVec3,
    /// Radius.
    pub radius: f64,
    /// 0 half mirror, 1 matte, 2 glass.
    pub material: u32,
}

/// Where the camera stands, and the lights.
pub(super) struct BenchView {
    pub eye: DVec3,
    pub target: DVec3,
    /// Vertical.
    pub fov_degrees: f64,
    pub lights: &'static [DVec3],
}

impl WhittedScene {
    /// Both.
    pub const ALL: [WhittedScene; 2] = [WhittedScene::Flake, WhittedScene::Marbles];

    /// `flake` or `marbles`.
    pub fn name(self) -> &'static str {
        match self {
            WhittedScene::Flake => "flake",
            WhittedScene::Marbles => "marbles",
        }
    }

    /// Its spheres.
    pub fn balls(self) -> Vec<BenchSphere> {
        match self {
            WhittedScene::Flake => {
                let mut balls = Vec::new();
                add_flake(DVec3::new(0.0, 0.5, 0.0), 0.5, DVec3::Y, FLAKE_DEPTH, &mut balls);
                balls
            }
            WhittedScene::Marbles => (0..MARBLES * MARBLES).map(marble).collect(),
        }
    }

    /// The scene, with the settings of the benchmark in its `Settings` block.
    pub fn text(self) -> String {
        let BenchView { eye, target, fov_degrees, lights } = self.view();
        let mut text = format!(
            "PerspectiveCamera {{ center {} direction {} up 0 1 0 angle {fov_degrees} }}\n\
             Background {{ color 0.3 0.5 0.8 ambientLight 0.1 0.1 0.1 }}\nLights {{\n",
            words(eye),
            words(target - eye)
        );
        // Writing to a string cannot fail.
        for &light in lights {
            let _ = writeln!(text, "  PointLight {{ position {} color 0.6 0.6 0.6 }}", words(light));
        }
        text.push_str(MATERIALS);
        let mut current = None;
        for BenchSphere { center, radius, material } in self.balls() {
            if current.replace(material) != Some(material) {
                let _ = writeln!(text, "  MaterialIndex {material}");
            }
            let _ = writeln!(text, "  Sphere {{ center {} radius {} }}", words(center), radius as f32);
        }
        text.push_str(SETTINGS);
        text
    }

    pub(super) fn view(self) -> BenchView {
        const FLAKE: [DVec3; 3] =
            [DVec3::new(4.0, 6.0, 2.0), DVec3::new(-3.0, 5.0, 4.0), DVec3::new(1.0, 7.0, -5.0)];
        const MARBLES: [DVec3; 2] = [DVec3::new(10.0, 14.0, 6.0), DVec3::new(-12.0, 10.0, 8.0)];
        match self {
            WhittedScene::Flake => BenchView {
                eye: DVec3::new(1.9, 1.6, 1.9),
                target: DVec3::new(0.0, 0.42, 0.0),
                fov_degrees: 35.0,
                lights: &FLAKE,
            },
            WhittedScene::Marbles => BenchView {
                eye: DVec3::new(0.0, 4.5, 15.0),
                target: DVec3::new(0.0, 0.0, 1.0),
                fov_degrees: 40.0,
                lights: &MARBLES,
            },
        }
    }
}

/// The pattern is solid; half a unit up, the floor runs through the middle of a layer of cubes.
const MATERIALS: &str = "}
Materials {
  Material mirror {
    ambientColor 1 0.75 0.33  diffuseColor 0.5 0.375 0.165  specularColor 0.4 0.4 0.4  exponent 60
    reflectiveColor 0.5 0.5 0.5
  }
  Material matte { ambientColor 0.3 0.5 0.9  diffuseColor 0.27 0.45 0.81 }
  Material glass {
    ambientColor 0.95 0.95 0.95  diffuseColor 0.0475 0.0475 0.0475  specularColor 0.4 0.4 0.4  exponent 100
    reflectiveColor 0.1 0.1 0.1  transparentColor 0.85 0.85 0.85  indexOfRefraction 1.5
  }
  Material light { ambientColor 0.8 0.8 0.8  diffuseColor 0.72 0.72 0.72 }
  Material dark { ambientColor 0.25 0.25 0.25  diffuseColor 0.225 0.225 0.225 }
  Checkerboard floor { Transform { Translate 0 0.5 0 }  materialIndex light  materialIndex dark }
}
Group {
  MaterialIndex floor
  Plane { normal 0 1 0 offset 0 }
";

const SETTINGS: &str = "}
Settings {
  size 1024 768  bounces 5  weight 0.00390625
  shadows transparent  transparentShadows surface  samples regular 1
}
";

/// Three numbers, rounded to single precision as the scene will have them.
fn words(v: DVec3) -> String {
    let v = v.as_vec3();
    format!("{} {} {}", v.x, v.y, v.z)
}

/// A sphere, and `depth` generations of children around its pole `up`.
fn add_flake(center: DVec3, radius: f64, up: DVec3, depth: u32, balls: &mut Vec<BenchSphere>) {
    balls.push(BenchSphere { center, radius, material: 0 });
    if depth == 0 {
        return;
    }
    let aside = if up.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let t = up.cross(aside).normalize();
    let b = up.cross(t);
    let equator = (0..6).map(|k| (FRAC_PI_2, f64::from(k) * FRAC_PI_3));
    let polar = (0..3).map(|k| (35f64.to_radians(), FRAC_PI_6 + f64::from(k) * 2.0 * FRAC_PI_3));
    for (theta, phi) in equator.chain(polar) {
        let n = sin64(theta) * (cos64(phi) * t + sin64(phi) * b) + cos64(theta) * up;
        let child = radius / 3.0;
        add_flake(center + n * (radius + child), child, n, depth - 1, balls);
    }
}

fn marble(i: u32) -> BenchSphere {
    let u = [0, 1, 2, 3].map(|k| uniform(i, k));
    let radius = 0.15 + 0.25 * u[0];
    let place = |cell: u32, u: f64| f64::from(cell) - f64::from(MARBLES / 2) + 0.5 + (u - 0.5) * 0.5;
    BenchSphere {
        center: DVec3::new(place(i % MARBLES, u[1]), radius, place(i / MARBLES, u[2])),
        radius,
        material: (u[3] * 3.0) as u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::{LoadOptions, MemoryAssets, Severity, load_from};

    #[test]
    fn the_scenes_are_read_as_they_are_meant() {
        for (scene, balls) in [(WhittedScene::Flake, 7381), (WhittedScene::Marbles, 1024)] {
            assert_eq!(scene.balls().len(), balls);
            let assets = MemoryAssets::new().with("scene.txt", scene.text());
            let loaded = load_from("scene.txt", &assets, &LoadOptions::default());
            assert_eq!(loaded.diagnostics.count(Severity::Warning), 0, "{}", loaded.report(false));
            let compiled = loaded.scene.unwrap();
            assert_eq!(compiled.geometry.primitives.len(), balls + 1);
            assert_eq!(compiled.output.settings.size, Some([1024, 768]));
        }
    }

    #[test]
    fn children_touch_their_parent() {
        let balls = WhittedScene::Flake.balls();
        for child in &balls[1..] {
            let touches = |parent: &&BenchSphere| {
                let gap = parent.center.distance(child.center) - parent.radius - child.radius;
                (parent.radius / child.radius - 3.0).abs() < 1e-9 && gap.abs() < 1e-9
            };
            assert!(balls.iter().any(|parent| touches(&parent)), "{child:?}");
        }
    }

    /// Some spheres of the definition that the other renderers are given.
    #[test]
    fn spheres_are_where_other_programs_have_them() {
        let flake = WhittedScene::Flake.balls();
        let marbles = WhittedScene::Marbles.balls();
        let known = [
            (flake[4], [0.0, 0.302469136, -0.592592593, 0.00617283951], 0),
            (marbles[0], [-15.5656509, 0.197599837, -15.6338483, 0.197599837], 2),
            (marbles[4], [-11.5954322, 0.361747438, -15.5907902, 0.361747438], 0),
        ];
        for (ball, [x, y, z, r], material) in known {
            assert!((ball.center - DVec3::new(x, y, z)).length() < 1e-7, "{ball:?}");
            assert!((ball.radius - r).abs() < 1e-9 && ball.material == material, "{ball:?}");
        }
    }
}
