//! Where on a texture a point is: placement, projection, warp.
//!
//! A point of the world, or of the space of its object, is taken by an affine map to the space of the texture, `q = M
//! p`, there projected onto a sheet where the texture is to be laid like a picture, divided by the size of a unit, and
//! at last moved by turbulence:
//!
//! ```text
//! solid        q                                    planar      (x, y)
//! spherical    (1/2 + theta / 2 pi, 1/2 + asin(y / |q|) / pi)       cylindrical  (1/2 + theta / 2 pi, y)       theta = atan2(x, z)
//! cubic        across the axis along which the normal is longest    camera       1/2 - (x, y) / (2 z tan(angle / 2))
//! triplanar    the mean of three sheets, weighed by the fourth powers of the normal's components
//! uv           surface coordinates
//! ```
//!
//! A sheet lies in x and y of what is laid on it; pictures on it take the same two numbers for surface coordinates.

use std::sync::Arc;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::pattern::TurbulentWarp;
use kajo_math::{Affine3A, Mat3A, Vec2, Vec3, Vec3A, fmath};

use super::{
    AnyTexture, ColorNode, ColorTexture, FilteredNumber, FloatNode, FloatTexture, SurfaceUv, TextureContext,
    TextureDetail, TextureFootprint, TextureSlope, Textures, UvSet,
};

/// How points of space become places of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Projection {
    /// They are such: the texture fills space.
    #[default]
    Solid,
    /// By surface coordinates.
    Uv(UvSet),
    /// Along z.
    Planar,
    /// From the origin onto a sphere around it: once around in 1, from pole to pole in 1.
    Spherical,
    /// From the y axis onto a cylinder around it: once around in 1.
    Cylindrical,
    /// Along that axis which is nearest to the normal.
    Cubic,
    /// Along all three axes, more along those which are nearer to the normal.
    Triplanar,
    /// From the origin along -z, as a projector shines: the square picture is seen under this angle.
    Camera {
        /// Tangent of half the angle.
        tan_half: f32,
    },
}

/// What a texture is placed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureSpace {
    /// The world: things that are moved elsewhere lie elsewhere in the texture.
    #[default]
    World,
    /// That in which the fields of the shape are written: the texture goes where its operations take the thing.
    Object,
}

/// Where on a texture a point is.
#[derive(Clone, Copy, Debug)]
pub struct Mapping {
    /// What it is placed in.
    pub space: TextureSpace,
    /// From there to the space of the texture.
    pub texture_from_space: Affine3A,
    /// How its points become places of the texture.
    pub projection: Projection,
    /// Length of the texture's unit, above 0.
    pub size: f32,
    /// How places are moved at last.
    pub warp: Option<TurbulentWarp>,
    /// Whether octaves of the warp that are too narrow for the distance between samples are left out.
    pub is_filtered: bool,
}

impl Default for Mapping {
    fn default() -> Mapping {
        Mapping {
            space: TextureSpace::World,
            texture_from_space: Affine3A::IDENTITY,
            projection: Projection::Solid,
            size: 1.0,
            warp: None,
            is_filtered: false,
        }
    }
}

/// The two coordinates across an axis, such that sheets seen from outside are not mirrored.
fn across(axis: usize, is_back: bool, q: Vec3) -> Vec2 {
    let sign = if is_back { -1.0 } else { 1.0 };
    match axis {
        0 => Vec2::new(-sign * q.z, q.y),
        1 => Vec2::new(q.x, -sign * q.z),
        _ => Vec2::new(sign * q.x, q.y),
    }
}

/// The axis along which a vector is longest.
fn longest(v: Vec3) -> usize {
    let v = v.abs();
    if v.x >= v.y && v.x >= v.z {
        0
    } else if v.y >= v.z {
        1
    } else {
        2
    }
}

impl Mapping {
    fn is_finite(&self) -> bool {
        let is_angle = match self.projection {
            Projection::Camera { tan_half } => tan_half.is_finite() && tan_half > 0.0,
            _ => true,
        };
        let has_size = self.size.is_finite() && self.size > 0.0;
        let warp = self.warp.as_ref().is_none_or(TurbulentWarp::is_finite);
        self.texture_from_space.is_finite() && is_angle && has_size && warp
    }

    fn needs_uv(&self, part: impl FnOnce() -> bool) -> bool {
        match self.projection {
            Projection::Uv(_) => true,
            Projection::Solid => part(),
            _ => false,
        }
    }

    /// From the world to the space of the texture.
    #[inline]
    fn texture_from_world(&self, at: &TextureContext) -> Affine3A {
        match self.space {
            TextureSpace::World => self.texture_from_space,
            TextureSpace::Object => self.texture_from_space * Affine3A::from(at.object_from_world),
        }
    }

    /// Length in the world of the texture's unit, about.
    fn unit(&self, at: &TextureContext) -> f32 {
        let stretch = self.texture_from_world(at).matrix3;
        let [x, y, z] = [stretch.x_axis, stretch.y_axis, stretch.z_axis].map(Vec3A::length);
        let unit = self.size / x.max(y).max(z);
        match self.projection {
            // Sheets of the sphere, the cylinder and the projector grow with the distance.
            Projection::Spherical | Projection::Cylindrical | Projection::Camera { .. } => 0.1 * unit,
            _ => unit,
        }
    }

    /// A normal in the texture's space, by the map `m` to it; where there is none, the direction from the middle to `q` stands for it.
    fn normal(m: &Mat3A, n: Vec3, q: Vec3) -> Vec3 {
        // Normals go by the inverse transpose: by cross products of the columns.
        let cofactors = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
        let sum = cofactors.into_iter().zip(n.to_array()).fold(Vec3A::ZERO, |sum, (c, n)| sum + n * c);
        let n = Vec3::from(if m.determinant() < 0.0 { -sum } else { sum }).normalize_or_zero();
        if n == Vec3::ZERO { q.normalize_or(Vec3::Z) } else { n }
    }

    /// Calls `f` with every place of the texture that has a share in a point, and with that share.
    #[inline]
    fn each(&self, at: &TextureContext, mut f: impl FnMut(&TextureContext, f32)) {
        let map = self.texture_from_world(at);
        let q = map.transform_point3(at.p);
        let dq = at.footprint.p.map(|dp| map.transform_vector3(dp));
        let normal = || Mapping::normal(&map.matrix3, at.n, q);
        let mut sheet = |uv: Vec2, duv: [Vec2; 2], share: f32| {
            let c = self.settled(uv.extend(0.0), duv.map(|d| d.extend(0.0)), at);
            let uv = SurfaceUv::from(c.p.truncate());
            let duv = c.footprint.p.map(Vec3::truncate);
            let footprint = TextureFootprint { uv: duv, second_uv: duv, ..c.footprint };
            f(&TextureContext { uv, footprint, ..c }, share);
        };
        let around = |v: f32| v - v.round();
        match self.projection {
            Projection::Solid => {
                let n = if at.n == Vec3::ZERO { Vec3::ZERO } else { normal() };
                f(&TextureContext { n, ..self.settled(q, dq, at) }, 1.0);
            }
            Projection::Uv(set) => {
                let uv = match set {
                    UvSet::First => at.uv.first,
                    UvSet::Second => at.uv.second,
                };
                sheet(uv, at.footprint.on(set), 1.0);
            }
            Projection::Planar => sheet(q.truncate(), dq.map(Vec3::truncate), 1.0),
            Projection::Spherical | Projection::Cylindrical | Projection::Camera { .. } => {
                let uv = self.rolled(q);
                let duv = dq.map(|d| {
                    let d = self.rolled(q + d) - uv;
                    // Beside the seam the way around is the short one.
                    Vec2::new(around(d.x), d.y)
                });
                sheet(uv, duv, 1.0);
            }
            Projection::Cubic => {
                let n = normal();
                let axis = longest(n);
                let of = |q| across(axis, n[axis] < 0.0, q);
                sheet(of(q), dq.map(of), 1.0);
            }
            Projection::Triplanar => {
                let n = normal();
                let weights = (n * n) * (n * n);
                let sum = weights.element_sum();
                for axis in 0..3 {
                    let share = weights[axis] / sum;
                    if share > 0.0 {
                        let of = |q| across(axis, n[axis] < 0.0, q);
                        sheet(of(q), dq.map(of), share);
                    }
                }
            }
        }
    }

    /// The place on the sheet of a sphere, a cylinder or a projector.
    fn rolled(&self, q: Vec3) -> Vec2 {
        const TURN: f32 = std::f32::consts::TAU;
        let round = || 0.5 + fmath::atan2(q.x, q.z) / TURN;
        match self.projection {
            Projection::Spherical => {
                let height = q.y / q.length().max(f32::MIN_POSITIVE);
                Vec2::new(round(), 0.5 + fmath::asin(height.clamp(-1.0, 1.0)) * 2.0 / TURN)
            }
            Projection::Camera { tan_half } => {
                // What lies behind is lit through the pinhole, upside down.
                let depth = if q.z.abs() < 1e-6 { -1e-6 } else { q.z };
                Vec2::splat(0.5) - 0.5 * q.truncate() / (depth * tan_half)
            }
            _ => Vec2::new(round(), q.y),
        }
    }

    /// A place in units of the texture, moved by the warp, and what a sample covers of it.
    #[inline]
    fn settled(&self, c: Vec3, dc: [Vec3; 2], at: &TextureContext) -> TextureContext {
        let footprint = TextureFootprint { p: dc.map(|d| d / self.size), ..at.footprint };
        let c = c / self.size;
        let p = match &self.warp {
            None => c,
            Some(warp) => warp.moved(c, if self.is_filtered { footprint.width() } else { 0.0 }),
        };
        TextureContext { p, footprint, ..*at }
    }
}

/// A number, evaluated elsewhere.
#[derive(Clone, Debug)]
pub struct MappedFloat {
    /// The texture.
    pub texture: FloatTexture,
    /// Where.
    pub mapping: Arc<Mapping>,
}

impl FloatNode for MappedFloat {
    fn is_finite(&self) -> bool {
        self.mapping.is_finite()
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.texture)
    }

    fn wants_footprint(&self) -> bool {
        self.mapping.is_filtered && self.mapping.warp.is_some()
    }

    fn is_on_second_set(&self) -> bool {
        self.mapping.projection == Projection::Uv(UvSet::Second)
    }

    fn wants_object_space(&self) -> bool {
        self.mapping.space == TextureSpace::Object
    }

    fn needs_uv(&self, textures: &Textures) -> bool {
        self.mapping.needs_uv(|| self.texture.needs_uv(textures))
    }

    fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        detail_of(&self.mapping, found, |found| self.texture.detail(textures, found));
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        let mut sum = 0.0;
        self.mapping.each(at, |at, share| sum += share * self.texture.at(textures.evaluator(at)));
        sum
    }

    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let mut sum = FilteredNumber::default();
        self.mapping.each(at, |at, share| {
            let number = self.texture.filtered(textures.evaluator(at));
            sum = sum.plus(number.mapped(share * number.mean, share));
        });
        sum
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let Mapping { projection, size, warp, .. } = &*self.mapping;
        let value = |at: &TextureContext| self.value(textures, at);
        match projection {
            Projection::Solid if warp.is_none() => {
                let mut found = TextureSlope::default();
                self.mapping.each(at, |at, _| found = self.texture.slope(textures.evaluator(at), factor));
                // By the chain rule: the transpose of the map takes gradients back.
                let p =
                    self.mapping.texture_from_world(at).matrix3.transpose() * Vec3A::from(found.p / *size);
                TextureSlope { p: p.into(), ..found }
            }
            Projection::Uv(_) => TextureSlope::on_surface(at, size / 256.0, factor, value),
            _ => TextureSlope::over(at, self.mapping.unit(at) / 256.0, factor, value),
        }
    }

    fn mean(&self, textures: &Textures) -> f32 {
        self.texture.mean(textures)
    }
}

/// Adds what is to be known of a texture that is laid by a mapping: no picture on it lies where surface coordinates say.
fn detail_of(mapping: &Mapping, found: &mut TextureDetail, part: impl FnOnce(&mut TextureDetail)) {
    if mapping.projection == Projection::Solid && mapping.warp.is_none() {
        return part(found);
    }
    (found.has_pattern, found.jumps) = (true, true);
}

/// A colour, evaluated elsewhere.
#[derive(Clone, Debug)]
pub struct MappedColor {
    /// The texture.
    pub texture: ColorTexture,
    /// Where.
    pub mapping: Arc<Mapping>,
}

impl ColorNode for MappedColor {
    fn is_finite(&self) -> bool {
        self.mapping.is_finite()
    }

    fn parts(&self) -> Vec<AnyTexture<'_>> {
        vec![(&self.texture).into()]
    }

    fn wants_footprint(&self) -> bool {
        self.mapping.is_filtered && self.mapping.warp.is_some()
    }

    fn is_on_second_set(&self) -> bool {
        self.mapping.projection == Projection::Uv(UvSet::Second)
    }

    fn wants_object_space(&self) -> bool {
        self.mapping.space == TextureSpace::Object
    }

    fn color_needs_uv(&self, textures: &Textures) -> bool {
        self.mapping.needs_uv(|| self.texture.needs_uv(textures))
    }

    fn color_detail(&self, textures: &Textures, found: &mut TextureDetail) {
        detail_of(&self.mapping, found, |found| self.texture.detail(textures, found));
    }

    fn reflectance(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        let mut sum = Spectrum::BLACK;
        self.mapping.each(at, |at, share| {
            sum += self.texture.at(textures.evaluator(at), wavelengths) * share;
        });
        sum
    }

    fn color_is_filtered(&self, textures: &Textures) -> bool {
        self.texture.is_filtered(textures)
    }

    fn color_mean(&self, textures: &Textures) -> [f32; 3] {
        self.texture.mean(textures)
    }
}
