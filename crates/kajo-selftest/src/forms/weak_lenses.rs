//! Weak gravitational lenses.
//!
//! From the distance `a` light that crosses a lens at the distance `b` from its middle is seen at the angle `t`, `tan t = b/a`. It comes
//! from a star straight behind the middle, at the distance `c`, if the lens turns it by
//!
//! ```text
//! α = sin t + sin s,      tan s = b/c
//! ```
//!
//! which a point mass `M` does for `4 M / b = α`, and an isothermal sphere for `4π σ² = α`. Under an even sky nothing is seen of any lens.

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::{Form, Parameters, spot_meter, text};
use crate::method::{BIDIRECTIONAL, Method, PATH, PATH_SCATTERING, PATH_SPECTRAL};

const LENSES: &[Method] = &[PATH, PATH_SCATTERING, PATH_SPECTRAL, BIDIRECTIONAL];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    vec![ring(draw, true), ring(draw, false), even_sky(draw)]
}

/// A scene with a lens in a disk.
fn behind(view: &str, lens: &str, [center, normal]: [DVec3; 2], rest: &str) -> String {
    format!(
        "{view}Materials {{ GravitationalLens lens {{ center {c}  {lens} }}  Matte emitter {{ color 0 0 0  emission 1 }} }}
Group {{ MaterialIndex lens Disk {{ center {c}  normal {}  radius 9 }} {rest} }}\n",
        text(normal),
        c = text(center),
    )
}

fn ring(draw: &mut Parameters, is_point: bool) -> Form {
    let (center, n) = (draw.point(1.0), draw.direction(-1.0));
    let (near, far, b) = (draw.between(3.0, 9.0), draw.between(3.0, 9.0), draw.between(0.3, 1.5));
    let angle = (b / near).atan();
    let turned = angle.sin() + (b / far).atan().sin();
    let (kind, lens) = match is_point {
        true => ("a point mass", format!("mass {}", 0.25 * b * turned)),
        false => ("an isothermal sphere", format!("dispersion {}", (turned / (4.0 * PI)).sqrt())),
    };
    let from = center + near * n;
    let star =
        format!("MaterialIndex emitter Sphere {{ center {}  radius {} }}", text(center - far * n), 0.02 * b);
    let view = spot_meter(from, center + b * n.any_orthonormal_vector());
    let scene = behind(&view, &lens, [center, n], &star);
    Form::new(format!("ring of a star behind {kind}, at {} degrees", angle.to_degrees()), scene, 1.0, LENSES)
}

fn even_sky(draw: &mut Parameters) -> Form {
    let (center, n) = (draw.point(1.0), draw.direction(-1.0));
    let (ratio, core) = (draw.between(0.2, 1.0), draw.between(0.0, 0.5));
    let (from, to) = (center + 6.0 * n, center + draw.point(2.0).reject_from_normalized(n));
    let view = spot_meter(from, to).replace("color 0 0 0", "color 1 1 1");
    let lens = format!("mass 0.02  dispersion 0.15  axisRatio {ratio}  core {core}");
    let scene = behind(&view, &lens, [center, n], "");
    Form::new(format!("even sky through a galaxy of the axis ratio {ratio}"), scene, 1.0, LENSES)
}
