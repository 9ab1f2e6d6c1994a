//! Light that passes straight through transparent things before it comes to a surface.
//!
//! By length: inside a closed body of absorption `a` light is weakened by `exp(-a d)`, `d` the
//! length of the way inside; the way is not bent. Crossings come in pairs for each
//! body, so `d` is the sum of the parameters where the ray leaves it less those where it enters.
//! A body that the ray leaves without having entered holds the ray's origin, one that it
//! enters and does not leave holds the light. Surfaces that enclose nothing weaken light by their
//! transparent colour.
//!
//! By surface: every surface crossed weakens light by its transparent colour, as the older
//! programs do.

use kajo_color::Spectrum;
use kajo_core::ItemBuffer;
use kajo_core::ObjectId;
use kajo_core::scene::Scene;
use kajo_core::settings::ShadowAttenuation;
use kajo_math::{Ray, fmath};

/// How many bodies a shadow ray can be inside of at once; beyond that light is blocked.
const MAX_BODIES: usize = 32;

/// One body's crossings so far.
#[derive(Clone, Copy)]
struct Body {
    object: ObjectId,
    /// Ways out less ways in.
    exits: i32,
    /// Sum of parameters of exits less those of entries.
    length: f32,
    /// Of the crossing met last: properties do not vary within a body in practice.
    absorption: Spectrum,
}

/// The share of light that comes through along `ray`, whose end is the light, and the apex of a buffer if there is one.
pub(super) fn transmittance(
    scene: &Scene,
    apex: Option<&ItemBuffer>,
    ray: &Ray,
    by: ShadowAttenuation,
) -> Spectrum {
    match by {
        ShadowAttenuation::Length => by_length(scene, apex, ray),
        ShadowAttenuation::Surface => by_surface(scene, apex, ray),
    }
}

fn by_surface(scene: &Scene, apex: Option<&ItemBuffer>, ray: &Ray) -> Spectrum {
    let mut through = Spectrum::WHITE;
    let blocked = scene.occluded_or(apex, ray, |object, hit| {
        through *= scene.transparency(ray, object, hit);
        through.is_black()
    });
    if blocked { Spectrum::BLACK } else { through }
}

fn by_length(scene: &Scene, apex: Option<&ItemBuffer>, ray: &Ray) -> Spectrum {
    let mut through = Spectrum::WHITE;
    let mut bodies: [Option<Body>; MAX_BODIES] = [None; MAX_BODIES];
    let blocked = scene.occluded_or(apex, ray, |object, hit| {
        let at = scene.interaction(ray, object, hit);
        let place = scene.texture_context(&at);
        let phong = scene.appearance.phong(at.material, &place);
        let closed = scene.geometry.shape(object).is_some_and(|shape| scene.geometry.shapes.is_closed(shape));
        if phong.transparent.is_black() || !closed {
            through *= phong.transparent;
            return through.is_black();
        }
        let Some(body) = find(&mut bodies, object) else { return true };
        let sign = if ray.d.dot(at.point.ng) > 0.0 { 1 } else { -1 };
        body.exits += sign;
        body.length += sign as f32 * hit.t;
        body.absorption = phong.absorption;
        false
    });
    if blocked {
        return Spectrum::BLACK;
    }
    for body in bodies.iter().map_while(Option::as_ref) {
        // Entered and not left: the rest of the way to the light is inside too.
        let rest = if body.exits < 0 { -body.exits as f32 * ray.t_max } else { 0.0 };
        let inside = (body.length + rest).max(0.0);
        // Without absorption nothing is lost, even on an infinite way.
        through *= body.absorption.map(|a| if a == 0.0 { 1.0 } else { fmath::exp(-a * inside) });
    }
    through
}

/// The record of a body, new or old; `None` when there is no more room.
fn find(bodies: &mut [Option<Body>; MAX_BODIES], object: ObjectId) -> Option<&mut Body> {
    let place = bodies.iter().position(|b| b.is_none_or(|b| b.object == object))?;
    let new = Body { object, exits: 0, length: 0.0, absorption: Spectrum::BLACK };
    Some(bodies[place].get_or_insert(new))
}
