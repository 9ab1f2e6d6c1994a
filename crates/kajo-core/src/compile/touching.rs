//! Warnings of clear bodies with faces in one place.
//!
//! A ray that has met a surface goes on from just behind it, beyond what its place may be off by. What another body has there is
//! passed over: a liquid exactly as large as its glass is never entered. Bodies that overlap are right, and so is anything
//! that set operations make.
//!
//! Some rays through each body find such faces. They are there or not to all rays alike, so a few are enough.

use kajo_color::Wavelengths;
use kajo_math::{Aabb, Ray, Vec2, Vec3};
use kajo_scene::{Diagnostic, Diagnostics, SceneDesc};

use crate::ids::ObjectId;
use crate::interaction::SurfacePoint;
use crate::scene::Scene;

/// Bodies that rays are sent through: scenes are compiled again and again while they are edited.
const MOST_BODIES: usize = 32;

/// Rays along each axis, in each of two directions across.
const RAYS: usize = 4;

/// Rays that must find the same two bodies: one may pass where they cross.
const ENOUGH: usize = 2;

/// A crossing of a ray with a body that light passes.
struct Crossing {
    t: f32,
    object: ObjectId,
    point: SurfacePoint,
}

/// Warns of the first two bodies that touch.
pub(super) fn check(scene: &Scene, desc: &SceneDesc, diagnostics: &mut Diagnostics) {
    let Some(objects) = touching(scene) else { return };
    let words = objects.map(|object| scene.geometry.objects.get(object.index()));
    let [Some(first), Some(second)] = words else { return };
    let place = |item: u32| desc.item(item).map(|item| item.head_span());
    let (Some(here), Some(other)) = (place(second.described_by), place(first.described_by)) else { return };
    let message =
        format!("`{}` and `{}` are clear and have faces in one place", first.keyword, second.keyword);
    let warning = Diagnostic::warning(message)
        .label(here, "light meets one of the two faces and passes over the other")
        .label(other, "the other body");
    diagnostics.push(
        warning.help("let them overlap a little; where they do, the one of the higher `priority` is there"),
    );
}

/// Two bodies with faces in one place, in the order of the text.
fn touching(scene: &Scene) -> Option<[ObjectId; 2]> {
    let geometry = &scene.geometry;
    if !geometry.transmits {
        return None;
    }
    let all = ObjectId::all(geometry.primitives.len());
    let bodies: Vec<ObjectId> = all.filter(|&object| scene.may_transmit(object)).take(MOST_BODIES).collect();
    if bodies.len() < 2 {
        return None;
    }
    let boxes = bodies.iter().map(|&object| geometry.object_bounds(object));
    let mut found: Vec<([ObjectId; 2], usize)> = Vec::new();
    for ray in boxes.filter(Aabb::is_finite).flat_map(|bounds| rays_through(&bounds)) {
        for pair in touching_along(scene, &ray) {
            match found.iter_mut().find(|(known, _)| *known == pair) {
                Some((_, count)) => *count += 1,
                None => found.push((pair, 1)),
            }
        }
    }
    found.into_iter().filter(|(_, count)| *count >= ENOUGH).map(|(pair, _)| pair).min()
}

/// Rays through a box near to each of its axes, from before its faces to behind them.
fn rays_through(bounds: &Aabb) -> impl Iterator<Item = Ray> + use<> {
    /// How far they lean: along no face of a box.
    const LEANS: Vec2 = Vec2::new(0.013, 0.021);
    let (min, size) = (bounds.min, bounds.extent());
    (0..3 * RAYS * RAYS).map(move |i| {
        let (axis, i) = (i / (RAYS * RAYS), i % (RAYS * RAYS));
        // A lattice, off the middles where things are even.
        let (u, v) = ((i % RAYS) as f32 + 0.41, (i / RAYS) as f32 + 0.37);
        let turned = |along: f32, u: f32, v: f32| {
            let [mut x, mut y, mut z] = [along, u, v];
            (0..axis).for_each(|_| (x, y, z) = (z, x, y));
            Vec3::new(x, y, z)
        };
        let on_face = turned(-0.1, u / RAYS as f32, v / RAYS as f32);
        let d = turned(1.2, LEANS.x, LEANS.y) * size.max_element();
        Ray::new(min + on_face * size.max(Vec3::splat(1e-3 * size.max_element())), d).over(0.0, 1.0)
    })
}

/// The pairs of bodies that have faces in one place where a ray crosses them.
fn touching_along(scene: &Scene, ray: &Ray) -> Vec<[ObjectId; 2]> {
    let mut crossings = Vec::new();
    scene.crossings(ray, |object, hit| {
        let at = scene.interaction(ray, object, hit);
        if scene.interior(&at, &Wavelengths::RGB, 0.5).is_some() {
            crossings.push(Crossing { t: hit.t, object, point: at.point });
        }
    });
    crossings.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.object.cmp(&b.object)));
    let pairs = crossings.windows(2).filter(|pair| pair[0].object != pair[1].object);
    let touching = pairs.filter(|pair| is_one_place(&pair[0].point, &pair[1].point));
    touching.map(|pair| [pair[0].object.min(pair[1].object), pair[0].object.max(pair[1].object)]).collect()
}

/// Whether a ray that has met one of two faces passes over the other.
fn is_one_place(a: &SurfacePoint, b: &SurfacePoint) -> bool {
    /// The cosine of how much they may lean to each other.
    const ALIKE: f32 = 0.9999;
    let error = a.p_error + b.p_error + f32::EPSILON * (a.p.abs() + b.p.abs());
    let apart = (b.p - a.p).dot(a.ng).abs();
    a.ng.dot(b.ng).abs() > ALIKE && apart <= a.ng.abs().dot(error)
}

#[cfg(test)]
mod tests {
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};

    fn warnings(objects: &str) -> Vec<String> {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Media {{ Medium smoke {{ density 1 }} }}
             Materials {{ Glass clear {{ priority 1 }} Glass water {{ }} Matte wood {{ }} Interface haze {{ medium smoke }} Glass pane {{ thin on }} }}
             Group {{ {objects} }}"
        );
        let mut parsed = SceneDesc::parse_str(&text);
        let mut said = Diagnostics::new();
        let scene = compile(&mut parsed.desc, &MemoryAssets::new(), &CompileOptions::default(), &mut said);
        assert!(scene.is_some(), "{said:?}");
        said.iter().map(|diagnostic| diagnostic.message.clone()).collect()
    }

    /// A box in the hollow of a vessel, so much larger on each side, in another place of the scene.
    fn liquid(larger: f32, at: &str) -> String {
        let (lo, hi) = (-0.8 - larger, 0.8 + larger);
        format!(
            "MaterialIndex clear Transform {{ {at} Difference {{ Box {{ min -1 -1 -1 max 1 1 1 }} Box {{ min -0.8 -0.8 -0.8 max 0.8 1.2 0.8 }} }} }}
             MaterialIndex water Transform {{ {at} Box {{ min {lo} {lo} {lo} max {hi} 0.5 {hi} }} }}"
        )
    }

    #[test]
    fn a_liquid_that_touches_its_glass_is_told() {
        for at in ["Translate 0 0 0", "Translate 3 -20 7  YRotate 33", "UniformScale 300"] {
            let said = warnings(&liquid(0.0, at));
            assert!(said.len() == 1 && said[0].contains("`Difference` and `Box`"), "{at}: {said:?}");
            for larger in [0.01, -0.01, 1e-4] {
                assert_eq!(warnings(&liquid(larger, at)), [""; 0], "{at}: {larger}");
            }
        }
    }

    #[test]
    fn only_bodies_that_light_passes_are_told() {
        let beside = |a: &str, b: &str, x: f32| {
            format!(
                "MaterialIndex {a} Box {{ min -1 0 0 max 0 1 1 }} MaterialIndex {b} Box {{ min {x} 0 0 max 1 1 1 }}"
            )
        };
        assert_eq!(warnings(&beside("haze", "haze", 0.0)).len(), 1);
        assert_eq!(warnings(&beside("clear", "water", 0.0)).len(), 1);
        assert_eq!(warnings(&beside("clear", "water", -0.001)), [""; 0]);
        for other in ["wood", "pane"] {
            assert_eq!(warnings(&beside("clear", other, 0.0)), [""; 0], "{other}");
        }
        // Round faces, as of lenses that are cemented.
        let ball = "Sphere { center 0 0 0  radius 1 }";
        let around = format!("Difference {{ Sphere {{ center 0 0 0.3  radius 1.5 }} {ball} }}");
        assert_eq!(warnings(&format!("MaterialIndex clear {around} MaterialIndex water {ball}")).len(), 1);
        let larger = ball.replace("radius 1", "radius 1.001");
        assert_eq!(warnings(&format!("MaterialIndex clear {around} MaterialIndex water {larger}")), [""; 0]);
        // Balls that touch in a point have no faces in one place, nor have those that cross each other.
        let pair = |x: f32| format!("MaterialIndex clear {ball} Sphere {{ center {x} 0 0  radius 1 }}");
        for x in [2.0, 1.0] {
            assert_eq!(warnings(&pair(x)), [""; 0]);
        }
        assert_eq!(warnings(&pair(0.0)).len(), 1);
        // A set operation of both has one surface there.
        let boxes = "Box { min -1 0 0 max 0 1 1 } Box { min 0 0 0 max 1 1 1 }";
        assert_eq!(warnings(&format!("MaterialIndex clear Merge {{ {boxes} }}")), [""; 0]);
    }
}
