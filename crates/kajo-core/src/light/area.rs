//! Emissive surfaces: each point sends the same radiance into all directions of its side.
//!
//! Such a light exists for each patch of every object whose material has an `emission`; it is not written on its
//! own. The power of one side is `pi A L`.
//!
//! Two integrals over the points `y` of the patch, of the normal `n`, are estimated by one sample each. The light that arrives at a receiver `x`,
//!
//! ```text
//! integral of  f |cos| V L(y, -wi)  dwi,            dwi = |n . wi| / |x - y|^2 dA
//! ```
//!
//! by `f |cos| V L / pdf_li`, with the density `pdf_li` per solid angle at `x`; and the power that leaves it,
//!
//! ```text
//! integral of  L(y, d) |n . d|  dd dA  =  pi A L    of a side with the same radiance everywhere
//! ```
//!
//! by `L |n . d| / (p_A p_d)`, with the density `p_A` per area of the point and `p_d = |n . d| / pi` per solid angle of the direction, half of that
//! where both sides give light. So each sample of an even patch that is drawn by area counts `pi A L` for each of its sides.
//!
//! Where the radiance differs over the patch, positions are drawn by it: see `emission_density.rs`. A patch that moves is sampled
//! where it is at the time of the receiver's ray, and its density is that of the moved patch.

use std::f32::consts::PI;

use std::sync::Arc;

use kajo_color::{Emission, Spectrum, Wavelengths};
use kajo_math::{Aabb, Frame, Vec2, Vec3, warp};

use super::sample::INVERSE_SQUARE;
use super::{
    BoundingSphere, EmissionDensity, EmissionPdf, EmissiveSurfaces, Emitter, Illumination, LeNumbers,
    LeavingLight, LightBounds, LightLeSample, LightLiSample, LightPoint, Receiver,
};
use crate::ids::{ObjectId, VariedEmissionId};
use crate::motion::MovingTransform;
use crate::shape::{Patch, PatchDirection, PatchPoint, PlacedPatch};

/// Which sides of a surface give light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both.
    #[default]
    Both,
    /// The outer one, where normals point.
    Front,
    /// The inner one.
    Back,
}

impl Sides {
    /// Whether light leaves the surface into a direction whose cosine with the outward normal is `cos`.
    #[inline]
    pub fn emit(self, cos: f32) -> bool {
        match self {
            Sides::Both => cos != 0.0,
            Sides::Front => cos > 0.0,
            Sides::Back => cos < 0.0,
        }
    }
}

/// Which part of a patch belongs to the surface, of which set operations may cut some away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PatchExtent {
    /// All of it.
    #[default]
    Whole,
    /// What [`EmissiveSurfaces::shows`] says, facing as the patch does.
    Part,
    /// The same, facing the other way.
    InvertedPart,
}

/// An emissive patch.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Its geometry in world space, for one that moves at the opening of the shutter.
    pub patch: Patch,
    /// How it has moved since then, if it does; a sphere must stay one.
    pub drift: Option<Arc<MovingTransform>>,
    /// Radiance; where it differs over the patch, about its mean.
    pub emission: Emission,
    /// Where the radiance differs over the patch: what [`EmissiveSurfaces::radiance`] is to evaluate.
    pub varied: Option<VariedEmissionId>,
    /// What positions are then drawn by; absent where they are as good as alike.
    pub density: Option<Box<EmissionDensity>>,
    /// Which sides give light.
    pub sides: Sides,
    /// What of the patch there is.
    pub extent: PatchExtent,
    /// The object it belongs to.
    pub object: ObjectId,
    /// The part of that object.
    pub part: u32,
}

impl AreaLight {
    /// The normal of the surface where the patch has the normal `n`; `None` where it is not there.
    #[inline]
    fn surface_normal(&self, p: Vec3, n: Vec3, time: f32, surfaces: &impl EmissiveSurfaces) -> Option<Vec3> {
        match self.extent {
            PatchExtent::Whole => Some(n),
            PatchExtent::Part => surfaces.shows(self, p, time).then_some(n),
            PatchExtent::InvertedPart => surfaces.shows(self, p, time).then_some(-n),
        }
    }

    /// The radiance of a point at a time.
    ///
    /// * `leaving`: the point, and where its light goes
    #[inline]
    fn radiance(
        &self,
        leaving: LeavingLight,
        time: f32,
        wavelengths: &Wavelengths,
        surfaces: &impl EmissiveSurfaces,
    ) -> Spectrum {
        match self.varied {
            None => self.emission.at(wavelengths),
            Some(varied) => surfaces.radiance(self, varied, leaving, time, wavelengths),
        }
    }

    /// The patch where it is at a time.
    #[inline]
    fn placed(&self, time: f32) -> PlacedPatch<'_> {
        PlacedPatch { patch: &self.patch, moved: self.drift.as_ref().map(|drift| drift.map_at(time)) }
    }

    /// A box around the patch, the unit normal of its surface where it is the same everywhere, and its area.
    ///
    /// The area of a curved patch is that at the opening of the shutter.
    fn outline(&self, time: f32) -> (Aabb, Option<Vec3>, f32) {
        let (bounds, area) = (self.patch.bounds(), self.patch.area() as f32);
        let facing = if self.extent == PatchExtent::InvertedPart { -1.0 } else { 1.0 };
        let normal = self.patch.normal().map(|n| facing * n.as_vec3());
        let Some(drift) = &self.drift else { return (bounds, normal, area) };
        let map = drift.at(time);
        let Some(n) = normal else { return (map.bounds(&bounds), None, area) };
        // Areas grow by the volume's factor over that of the distance across.
        let across: Vec3 = (map.object_from_world.matrix3.transpose() * kajo_math::Vec3A::from(n)).into();
        let growth = map.world_from_object.matrix3.determinant().abs() * across.length();
        (map.bounds(&bounds), Some(map.normal(n)), area * growth)
    }

    /// The box, the normal and the cosine of the largest angle between it and the normals at any time.
    fn bounds_of_all_times(&self) -> (Aabb, Vec3, f32) {
        const TIMES: u8 = 16;
        let (mut bounds, normal, _) = self.outline(0.0);
        if let Some(drift) = &self.drift {
            bounds = drift.bounds_of_all_times(&self.patch.bounds());
        }
        let Some(n) = normal else { return (bounds, Vec3::Z, -1.0) };
        let keeps = |i: u8| {
            let then = self.outline(f32::from(i) / f32::from(TIMES)).1;
            then.is_some_and(|then| then.dot(n) > 1.0 - 1e-6)
        };
        // One that turns may point anywhere for all that the choice of lights needs to know.
        let turns = self.drift.is_some() && !(0..=TIMES).all(keeps);
        (bounds, n, if turns { -1.0 } else { 1.0 })
    }
}

impl Emitter for AreaLight {
    /// As if all light came from the middle of the patch.
    fn illuminate(&self, p: Vec3, time: f32) -> Illumination {
        let (bounds, normal, area) = self.outline(time);
        let to_light = bounds.center() - p;
        let distance = to_light.length();
        let wi = to_light / distance;
        let (area, cos) = match normal {
            Some(n) => {
                let cos = -wi.dot(n);
                (area, if self.sides.emit(cos) { cos.abs() } else { 0.0 })
            }
            // A convex body shows a quarter of its surface on average.
            None => (0.25 * area, if self.sides == Sides::Back { 0.0 } else { 1.0 }),
        };
        let irradiance =
            Spectrum::from(Vec3::from(self.emission.rgb())) * (area * cos / (distance * distance));
        // Not quite as far as the surface, which would hide itself.
        let reach = 1.0 - 0.5 * bounds.extent().max_element() / distance.max(f32::MIN_POSITIVE);
        Illumination { wi, distance: distance * reach.clamp(0.0, 0.999), intensity: irradiance * (1.0 / PI) }
    }

    fn is_finite(&self) -> bool {
        self.emission.is_finite() && self.patch.bounds().is_finite()
    }

    /// `pdf = p_A |x - y|^2 / |n . wi|` for points drawn by area; else by solid angle, see [`Patch::sample`], or by a mixture of either with the
    /// density of the emission, see [`EmissionDensity`].
    #[inline]
    fn sample_li<S: EmissiveSurfaces>(
        &self,
        to: &Receiver,
        u: Vec2,
        wavelengths: &Wavelengths,
        surfaces: &S,
    ) -> Option<LightLiSample> {
        let patch = self.placed(to.time);
        let PatchDirection { at, wi, pdf } = match &self.density {
            None => patch.sample(to.p, u)?,
            Some(density) => density.sample(&patch, to.p, u)?,
        };
        let n = self.surface_normal(at.p, at.n, to.time, surfaces)?;
        if !self.sides.emit(-wi.dot(n)) {
            return None;
        }
        let radiance = self.radiance(LeavingLight { p: at.p, d: -wi }, to.time, wavelengths, surfaces);
        let point = LightPoint::Surface { p: at.p, p_error: at.p_error, n };
        Some(LightLiSample { wi, radiance, pdf, is_delta: false, at: point })
    }

    /// By the rules of `sample_li`; 0 from a side that gives no light, where that draws nothing.
    #[inline]
    fn pdf_li(&self, to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        let LightPoint::Surface { p, n, .. } = *at else { return 0.0 };
        if !self.sides.emit(-wi.dot(n)) {
            return 0.0;
        }
        let patch = self.placed(to.time);
        match &self.density {
            None => patch.pdf(to.p, p, n),
            Some(density) => density.pdf(&patch, to.p, p, n),
        }
    }

    fn is_surface(&self) -> bool {
        true
    }

    fn sample_area(&self, u: Vec2, time: f32) -> Option<(LightPoint, f32)> {
        let patch = self.placed(time);
        let drawn = match &self.density {
            _ if patch.traced().is_some() => return None,
            None => patch.sample_area(u)?,
            Some(density) => density.sample_area(&patch, u)?,
        };
        let PatchPoint { p, p_error, n } = drawn.at;
        Some((LightPoint::Surface { p, p_error, n }, self.pdf_area(p, time)))
    }

    fn pdf_area(&self, p: Vec3, time: f32) -> f32 {
        let patch = self.placed(time);
        match &self.density {
            _ if patch.traced().is_some() => 0.0,
            None => patch.pdf_area(p),
            Some(density) => density.pdf_area(&patch, p),
        }
    }

    fn is_pointlike(&self) -> bool {
        false
    }

    fn object(&self) -> Option<ObjectId> {
        Some(self.object)
    }

    fn bounds(&self) -> Option<LightBounds> {
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        let power = sides * PI * self.patch.area() as f32 * self.emission.luminance();
        let (bounds, n, cos_spread) = self.bounds_of_all_times();
        let axis = if self.sides == Sides::Back { -n } else { n };
        let two_sided = self.sides == Sides::Both;
        Some(LightBounds {
            bounds,
            axis,
            cos_spread,
            cos_reach: 0.0,
            two_sided,
            power,
            is_inverse_square: true,
        })
    }

    /// A point by area or emission and a direction by its cosine with the normal; of a surface that rays find, a line
    /// through it of which each hit is as likely.
    fn sample_le<S: EmissiveSurfaces>(
        &self,
        time: f32,
        u: LeNumbers,
        wavelengths: &Wavelengths,
        world: &BoundingSphere,
        surfaces: &S,
    ) -> Option<LightLeSample> {
        let patch = self.placed(time);
        let traced = patch.traced();
        let (drawn, along) = match (&self.density, &traced) {
            (_, Some(traced)) => traced.sample_line(u.position, u.direction).map(|(at, d)| (at, Some(d)))?,
            (None, None) => (patch.sample_area(u.position)?, None),
            (Some(density), None) => (density.sample_area(&patch, u.position)?, None),
        };
        let drawn = drawn.at;
        let outward = self.surface_normal(drawn.p, drawn.n, time, surfaces)?;
        let d = match along {
            Some(d) if self.sides.emit(outward.dot(d)) => d,
            Some(d) => -d,
            None => {
                let n = if self.sides == Sides::Back { -outward } else { outward };
                cosine_around(n, u.direction, self.sides == Sides::Both)
            }
        };
        let at = LightPoint::Surface { p: drawn.p, p_error: drawn.p_error, n: outward };
        Some(LightLeSample {
            at,
            d,
            radiance: self.radiance(LeavingLight { p: drawn.p, d }, time, wavelengths, surfaces),
            attenuation: INVERSE_SQUARE,
            pdf: self.pdf_le(time, &at, d, world),
            is_delta: false,
        })
    }

    /// `p_A` per area, and `p_d = |n . d| / pi` per solid angle, half of that where both sides give light.
    fn pdf_le(&self, time: f32, at: &LightPoint, d: Vec3, _world: &BoundingSphere) -> EmissionPdf {
        let LightPoint::Surface { p, n, .. } = *at else { return EmissionPdf::default() };
        let cos = n.dot(d);
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        let direction = if self.sides.emit(cos) { cos.abs() / (sides * PI) } else { 0.0 };
        let patch = self.placed(time);
        let position = match (&self.density, patch.traced()) {
            (_, Some(traced)) => traced.pdf_line(p, d),
            (None, None) => patch.pdf_area(p),
            (Some(density), None) => density.pdf_area(&patch, p),
        };
        EmissionPdf { position, direction }
    }

    fn power(&self, _world: &BoundingSphere) -> f32 {
        self.bounds().map_or(0.0, |bounds| bounds.power)
    }

    fn emission(&self) -> Option<&Emission> {
        Some(&self.emission)
    }

    fn varied_emission(&self) -> Option<VariedEmissionId> {
        self.varied
    }
}

/// Directions of a cosine's density around `n`, or with `u.x` doubled on both sides of it.
fn cosine_around(n: Vec3, u: Vec2, both: bool) -> Vec3 {
    let (x, side) = match (both, u.x < 0.5) {
        (false, _) => (u.x, 1.0),
        (true, true) => (2.0 * u.x, 1.0),
        (true, false) => (2.0 * u.x - 1.0, -1.0),
    };
    Frame::from_normal(side * n).to_world(warp::cosine_hemisphere(Vec2::new(x, u.y)))
}
