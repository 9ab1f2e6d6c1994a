//! The same scenes in the languages of POV-Ray 3.7 and Tachyon, to be rendered beside ours.
//!
//! Both programs are left-handed: POV-Ray gets a mirrored camera, Tachyon mirrored z coordinates. POV-Ray
//! multiplies the diffuse share of a transparent surface by its opacity, so that share is divided by it
//! beforehand. Tachyon's chequers are red and blue, and it does not bend rays.

use std::fmt::Write;

use kajo_math::DVec3;
use kajo_math::fmath::tan64;

use super::scene::{BenchSphere, BenchView, WhittedScene};

/// Columns, rows, and surfaces that a camera ray may meet in a row.
const WIDTH: u32 = 1024;
const HEIGHT: u32 = 768;
const DEPTH: u32 = 6;

/// A surface as these programs describe it.
struct Finish {
    color: [f64; 3],
    diffuse: f64,
    phong: f64,
    exponent: f64,
    mirror: f64,
    transmission: f64,
}

const FINISHES: [Finish; 3] = [
    Finish {
        color: [1.0, 0.75, 0.33],
        diffuse: 0.5,
        phong: 0.4,
        exponent: 60.0,
        mirror: 0.5,
        transmission: 0.0,
    },
    Finish {
        color: [0.3, 0.5, 0.9],
        diffuse: 0.9,
        phong: 0.0,
        exponent: 1.0,
        mirror: 0.0,
        transmission: 0.0,
    },
    Finish { color: [0.95; 3], diffuse: 0.05, phong: 0.4, exponent: 100.0, mirror: 0.1, transmission: 0.85 },
];

impl WhittedScene {
    /// The scene for POV-Ray 3.7.
    pub fn povray(self) -> String {
        let BenchView { eye, target, fov_degrees, lights } = self.view();
        let at = |v: DVec3| format!("<{:.7},{:.7},{:.7}>", v.x, v.y, v.z);
        let mut text = format!(
            "#version 3.7;\n\
             global_settings {{ assumed_gamma 1.0 max_trace_level {DEPTH} adc_bailout 1/256 ambient_light rgb 1 }}\n\
             camera {{ perspective location {} right -x*{WIDTH}/{HEIGHT} up y direction z*{:.9} sky y look_at {} }}\n\
             background {{ rgb <0.3,0.5,0.8> }}\n",
            at(eye),
            image_distance(fov_degrees),
            at(target)
        );
        // Writing to a string cannot fail.
        for &light in lights {
            let _ = writeln!(text, "light_source {{ {} rgb 0.6 }}", at(light));
        }
        for (i, finish) in FINISHES.iter().enumerate() {
            let Finish { color: [r, g, b], phong, exponent, mirror, transmission, .. } = *finish;
            let diffuse = finish.diffuse / (1.0 - transmission);
            let interior = if transmission > 0.0 { "interior { ior 1.5 }" } else { "" };
            let _ = writeln!(
                text,
                "#declare M{i} = material {{ texture {{ pigment {{ rgb <{r},{g},{b}> transmit {transmission} }} finish \
                 {{ ambient 0.1 diffuse {diffuse} phong {phong} phong_size {exponent} reflection {mirror} }} }} {interior} }}"
            );
        }
        text.push_str(
            "plane { y, 0 texture { pigment { checker rgb 0.8 rgb 0.25 } finish { ambient 0.1 diffuse 0.9 } } }\n",
        );
        for BenchSphere { center, radius, material } in self.balls() {
            let _ = writeln!(text, "sphere {{ {}, {radius:.7} material {{ M{material} }} }}", at(center));
        }
        text
    }

    /// The scene for Tachyon.
    pub fn tachyon(self) -> String {
        let BenchView { eye, target, fov_degrees, lights } = self.view();
        let at = |v: DVec3| format!("{:.7} {:.7} {:.7}", v.x, v.y, -v.z);
        let mut text = format!(
            "BEGIN_SCENE\nRESOLUTION {WIDTH} {HEIGHT}\nCAMERA\nZOOM {:.7}\nASPECTRATIO 1.0\nANTIALIASING 0\n\
             RAYDEPTH {DEPTH}\nCENTER {}\nVIEWDIR {}\nUPDIR 0 1 0\nEND_CAMERA\nBACKGROUND 0.3 0.5 0.8\n",
            image_distance(fov_degrees),
            at(eye),
            at((target - eye).normalize())
        );
        for &light in lights {
            let _ = writeln!(text, "LIGHT CENTER {} RAD 0.001 COLOR 0.6 0.6 0.6", at(light));
        }
        for (i, finish) in FINISHES.iter().enumerate() {
            let Finish { color: [r, g, b], diffuse, phong, exponent, mirror, transmission } = *finish;
            let highlight = match phong {
                0.0 => String::new(),
                _ => format!("PHONG PLASTIC {phong} PHONG_SIZE {exponent} "),
            };
            let _ = writeln!(
                text,
                "TEXDEF M{i} AMBIENT 0.1 DIFFUSE {diffuse} SPECULAR {mirror} OPACITY {:.2} {highlight}COLOR {r} {g} {b} TEXFUNC 0",
                1.0 - transmission
            );
        }
        text.push_str(
            "PLANE CENTER 0 0 0 NORMAL 0 1 0 TEXTURE AMBIENT 0.1 DIFFUSE 0.9 SPECULAR 0 OPACITY 1 \
             COLOR 0.8 0.8 0.8 TEXFUNC 1 CENTER 0 0 0 ROTATE 0 0 0 SCALE 1 1 1\n",
        );
        for BenchSphere { center, radius, material } in self.balls() {
            let _ = writeln!(text, "SPHERE CENTER {} RAD {radius:.7} M{material}", at(center));
        }
        text + "END_SCENE\n"
    }
}

/// Distance of an image plane of height 1.
fn image_distance(fov_degrees: f64) -> f64 {
    0.5 / tan64((fov_degrees / 2.0).to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sphere_is_there() {
        for (scene, n) in [(WhittedScene::Flake, 7381), (WhittedScene::Marbles, 1024)] {
            assert_eq!(scene.povray().lines().filter(|line| line.starts_with("sphere")).count(), n);
            assert_eq!(scene.tachyon().lines().filter(|line| line.starts_with("SPHERE")).count(), n);
        }
    }

    #[test]
    fn lines_are_as_the_programs_read_them() {
        let pov = WhittedScene::Flake.povray();
        assert!(pov.contains("sphere { <0.0000000,0.5000000,0.0000000>, 0.5000000 material { M0 } }"));
        assert!(pov.contains("direction z*1.585797401 sky y"), "0.5 / tan(17.5 degrees)");
        let tachyon = WhittedScene::Flake.tachyon();
        assert!(tachyon.contains("\nCENTER 1.9000000 1.6000000 -1.9000000\n"));
        assert!(tachyon.contains(
            "TEXDEF M0 AMBIENT 0.1 DIFFUSE 0.5 SPECULAR 0.5 OPACITY 1.00 PHONG PLASTIC 0.4 PHONG_SIZE 60 "
        ));
    }
}
