//! The objects by way of which light makes caustics.

use kajo_color::Wavelengths;
use kajo_core::ObjectId;
use kajo_core::material::ShadingPoint;
use kajo_core::scene::Scene;
use kajo_core::texture::{TextureContext, TextureFootprint};
use kajo_math::{Vec2, Vec3};

use crate::integrator::transport::{Caster, Link};

/// Casters beyond which none is chosen: to choose costs as much as there are.
const MOST: usize = 256;

/// A footprint as large as a picture.
const FROM_FAR: TextureFootprint =
    TextureFootprint { p: [Vec3::X, Vec3::Y], uv: [Vec2::X, Vec2::Y], second_uv: [Vec2::X, Vec2::Y] };

/// The probability with which the caster is chosen that stands before a light.
const BEFORE: f32 = 0.75;

/// All casters of a scene, each chosen for a receiver in proportion to about the solid angle of its box.
#[derive(Debug, Default)]
pub struct Casters(Vec<Caster>);

impl Casters {
    /// The bounded objects of smooth glass or metal. Those in nested instances are none, and where there are too many none is.
    pub fn of(scene: &Scene) -> Casters {
        let mut list = Vec::new();
        for (i, primitive) in scene.geometry.primitives.iter().enumerate() {
            // As seen from far away, where reliefs are facets that make a surface rough.
            let context = TextureContext { footprint: FROM_FAR, ..TextureContext::default() };
            let point =
                ShadingPoint { context: &context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u: 0.5 };
            let Some(link) = Link::of(&scene.appearance.bsdf(primitive.material, &point)) else { continue };
            let object = ObjectId::from_index(i as u32);
            let bounds = scene.geometry.object_bounds(object);
            if bounds.is_finite() && bounds.extent().max_element() > 0.0 {
                list.push(Caster { object, link, center: bounds.center(), half: 0.5 * bounds.extent() });
            }
        }
        if list.len() > MOST {
            list.clear();
        }
        Casters(list)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A caster for a receiver, and the probability of that choice; the farther away all are, the more often none is chosen.
    ///
    /// * `before`: the object that the straight line to the light meets first
    /// * `u`: uniform in [0, 1)
    pub fn choose(&self, p: Vec3, before: Option<ObjectId>, u: f32) -> Option<(Caster, f32)> {
        let before = before.and_then(|object| self.caster(object));
        let others = if before.is_some() { 1.0 - BEFORE } else { 1.0 };
        let chosen = match before {
            Some(caster) if u >= others => Some(caster),
            _ => {
                let mut left = u / others * self.all(p);
                let mut each = self.0.iter();
                each.find(|caster| {
                    left -= weight(caster, p);
                    left < 0.0
                })
            }
        };
        chosen.map(|caster| (*caster, self.probability(p, before, caster)))
    }

    /// The caster that an object is, and the probability with which it is chosen for a receiver.
    ///
    /// * `before`: as for [`Casters::choose`]
    pub fn find(&self, p: Vec3, before: Option<ObjectId>, object: ObjectId) -> Option<(Caster, f32)> {
        let before = before.and_then(|object| self.caster(object));
        self.caster(object).map(|caster| (*caster, self.probability(p, before, caster)))
    }

    fn probability(&self, p: Vec3, before: Option<&Caster>, caster: &Caster) -> f32 {
        let others = if before.is_some() { 1.0 - BEFORE } else { 1.0 };
        let first = if before.is_some_and(|before| before.object == caster.object) { BEFORE } else { 0.0 };
        first + others * weight(caster, p) / self.all(p)
    }

    fn caster(&self, object: ObjectId) -> Option<&Caster> {
        self.0.iter().find(|caster| caster.object == object)
    }

    /// The sum of all weights, or 1 where they are less.
    fn all(&self, p: Vec3) -> f32 {
        self.0.iter().map(|caster| weight(caster, p)).sum::<f32>().max(1.0)
    }
}

/// The solid angle of the sphere around a caster's box but for a factor, if that is far away.
fn weight(caster: &Caster, p: Vec3) -> f32 {
    let radius2 = caster.half.length_squared();
    radius2 / (radius2 + (caster.center - p).length_squared())
}
