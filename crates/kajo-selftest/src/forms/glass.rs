//! Light that passes the surface of a clear body.
//!
//! The radiance of light that enters a body of index `n` grows by `n^2`, since its rays are squeezed together, and
//! shrinks again when it leaves. So a clear ball in even light is not to be seen, and an emitter within a body looks
//! weaker from outside by `1/n^2` [Veach 1997, 5.2]. A surface of `PhongMaterial` has no Fresnel term: it lets the
//! share `transparentColor` through, and what cannot leave is mirrored.

use kajo_math::DVec3;

use super::{Form, Parameters, spot_meter, text};
use crate::method::{GLASS, MIRRORS};

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let balls = [1.33, 1.5, 2.417].map(|n| ball(draw, n));
    let mut forms: Vec<Form> = balls.into_iter().chain([sunk_light(draw), sunk_camera(draw)]).collect();
    let shared: Vec<Form> =
        forms.iter().flat_map(|form| [form.shared(), form.chained(), form.chained_by_length(2)]).collect();
    forms.extend(shared);
    forms
}

fn ball(draw: &mut Parameters, n: f64) -> Form {
    let sky = draw.between(0.5, 4.0);
    let scene = format!(
        "{}Materials {{ Material glass {{ diffuseColor 0 0 0  transparentColor 1 1 1  indexOfRefraction {n} }} }}\n\
         Group {{ MaterialIndex glass Sphere {{ center 0 0 0  radius 1 }} }}",
        spot_meter(4.0 * draw.direction(-1.0), draw.point(0.5))
            .replace("color 0 0 0", &format!("color {sky} {sky} {sky}"))
    );
    Form::new(format!("S7 clear ball of index {n} in even light"), scene, sky, MIRRORS).bounces(100)
}

/// A block of index `n` that lets the share `t` through, with a light in it.
fn block(n: f64, t: f64, le: f64) -> String {
    format!(
        "Materials {{ Material glass {{ diffuseColor 0 0 0  transparentColor {t} {t} {t}  indexOfRefraction {n} }}\n\
         Material emitter {{ diffuseColor 0 0 0  emission {le} {le} {le} }} }}\n"
    )
}

fn sunk_light(draw: &mut Parameters) -> Form {
    let (n, t, le) = (draw.between(1.1, 2.0), draw.between(0.5, 0.95), draw.between(0.5, 4.0));
    let from = 3.0 * draw.direction(0.6);
    let scene = format!(
        "{}{}Group {{ MaterialIndex glass Box {{ min -9 -9 -9  max 9 0 9 }}\n\
         MaterialIndex emitter Quad {{ corner -8 -1 -8  edge1 0 0 16  edge2 16 0 0 }} }}",
        spot_meter(from, DVec3::ZERO),
        block(n, t, le)
    );
    Form::new(format!("light in a block of index {n}"), scene, t * le / (n * n), GLASS).bounces(1)
}

fn sunk_camera(draw: &mut Parameters) -> Form {
    let (n, t, le) = (draw.between(1.1, 2.0), draw.between(0.5, 0.95), draw.between(0.5, 4.0));
    // Steep enough for light to leave.
    let from = -draw.direction(0.9);
    let scene = format!(
        "{}{}Group {{ MaterialIndex glass Box {{ min -9 -9 -9  max 9 0 9 }}\n\
         MaterialIndex emitter Quad {{ corner {}  edge1 0 0 80  edge2 80 0 0 }} }}",
        spot_meter(from, DVec3::ZERO),
        block(n, t, le),
        text(DVec3::new(-40.0, 1.0, -40.0))
    );
    Form::new(format!("light seen from within a block of index {n}"), scene, t * le * n * n, GLASS).bounces(1)
}
