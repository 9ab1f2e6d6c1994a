//! Shapes: what rays hit.
//!
//! A shape answers in its own object space, with rays whose direction is not normalised.
//! Analytic shapes solve in double precision; meshes are single precision with a watertight
//! test. Every shape can also report all crossings, which transparent shadows and solid
//! modelling need.

mod bezier;
mod bicubic_patch;
mod bilinear_patch;
mod blob;
mod box_faces;
mod cone;
mod csg;
mod cuboid;
mod curves;
mod disk;
mod distance_grid;
mod fill;
mod height_field;
mod isosurface;
mod lathe;
mod mesh;
mod mesh_digest;
mod outline;
mod patch;
mod plane;
mod prism;
mod quad;
mod sphere;
mod sphere_sweep;
pub mod subdivision;
mod superellipsoid;
mod tessellate;
mod torus;
mod triangle;
mod vertex_attributes;

pub use bezier::{Bezier, ControlPoint, Path};
pub use bicubic_patch::BicubicPatch;
pub use bilinear_patch::BilinearPatch;
pub use blob::{Blob, BlobComponent, BlobCore, BlobKernel, MOST_MATERIALS};
pub use cone::Cone;
pub use csg::{Csg, CsgError, SetOperation, SolidPart};
pub use cuboid::Cuboid;
pub use curves::{CurveBasis, CurveForm, Curves, CurvesError, Strands};
pub use disk::Disk;
pub use distance_grid::{DistanceGrid, DistanceGridError};
pub use height_field::{HeightField, HeightFieldError, HeightGrid};
pub use isosurface::Isosurface;
pub use lathe::{Lathe, LatheError, Turning};
pub use mesh::{ABSENT, CornerValues, Mesh, MeshData, Neighbours, vertex_normals};
pub use outline::FillRule;
pub(crate) use patch::per_solid_angle;
pub use patch::{
    Canonical, CoverSegment, CurvedPatch, DiskPatch, Patch, PatchDirection, PatchPoint, PatchSample,
    PlacedPatch, PlacedTraced, QuadPatch, TracedPatch,
};
pub use plane::Plane;
pub use prism::{Bevel, BevelProfile, Prism, Sweep};
pub use quad::Quad;
pub use sphere::Sphere;
pub use sphere_sweep::SphereSweep;
pub use superellipsoid::Superellipsoid;
pub use tessellate::Tessellation;
pub use torus::Torus;
pub use triangle::Triangle;
pub use vertex_attributes::VertexAttributes;

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3, Vec4, robust::gamma};

use crate::family::family;
use crate::ids::MaterialSlot;
use crate::interaction::{Hit, SurfacePoint, Tangents, test_error};
use crate::motion::{MovingTransform, Shutter};

/// What every shape can do. All in object space.
pub trait Surface: Sized {
    /// A box that holds the shape; [`Aabb::EVERYWHERE`] for unbounded ones.
    fn bounds(&self) -> Aabb;

    /// Whether all its numbers are finite.
    fn is_finite(&self) -> bool;

    /// The nearest crossing with `t_min < t < t_max`.
    fn hit(&self, ray: &Ray) -> Option<Hit>;

    /// Whether there is any crossing with `t_min < t < t_max`.
    #[inline(always)]
    fn blocks(&self, ray: &Ray) -> bool {
        self.hit(ray).is_some()
    }

    /// Every crossing with `t_min < t < t_max`, in no particular order.
    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, visit: F);

    /// Position and normals at a hit of this shape by this ray.
    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint;

    /// How a part moves within the shape while the shutter is open: the map from where it is described. `None` for what keeps its
    /// shape, as almost everything does.
    ///
    /// Points and tangents of a moving part, but for those of rays, are taken and given as they are when the shutter opens.
    fn part_motion(&self, _part: u32) -> Option<&MovingTransform> {
        None
    }

    /// Whether there are parts with a [`Surface::part_motion`] if the shutter is open when they move.
    fn has_moving_parts(&self) -> bool {
        false
    }

    /// Sees parts that move through a shutter.
    fn expose(&mut self, _shutter: Shutter) {}

    /// Whether any part moves while the shutter is open that it was last exposed to.
    fn moves(&self) -> bool {
        false
    }

    /// A box that holds the shape in a part of the shutter's interval, given by its ends in [0, 1].
    fn bounds_during(&self, _part: [f64; 2]) -> Aabb {
        self.bounds()
    }

    /// What [`Surface::hit`] would have said of a point `p` of a part, but for the ray's parameter.
    fn hit_at(&self, part: u32, _p: Vec3) -> Hit {
        Hit { part, ..Hit::default() }
    }

    /// Surface coordinates, in [0, 1]^2 where the shape is finite.
    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2;

    /// A second set of texture coordinates, if there is one.
    fn second_uv_at(&self, _hit: &Hit, _p: Vec3) -> Option<Vec2> {
        None
    }

    /// The colour of the vertices, linear RGB and opacity in [0, 1], if they have one.
    fn color_at(&self, _hit: &Hit) -> Option<Vec4> {
        None
    }

    /// Whether [`Surface::color_at`] knows colours.
    fn has_colors(&self) -> bool {
        false
    }

    /// How the position changes with surface coordinates at the point `p` of a hit.
    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents;

    /// The same by the second set of texture coordinates, if there is one.
    fn second_tangents_at(&self, _hit: &Hit, _p: Vec3) -> Option<Tangents> {
        None
    }

    /// Whether the surface encloses a volume, so that crossings come in pairs.
    fn is_closed(&self) -> bool;

    /// Whether it has an inside: closed surfaces, and those that bound half of space.
    fn is_solid(&self) -> bool {
        self.is_closed()
    }

    /// Whether the line of a ray comes from within a solid without an end; see [`Surface::is_solid`].
    fn starts_inside(&self, _ray: &Ray) -> bool {
        false
    }

    /// How many parts there are to hit: one more than the largest [`Hit::part`].
    fn part_count(&self) -> u32 {
        1
    }

    /// Whether patches may be larger than the surface; then [`Surface::shows`] says where it is.
    fn is_partial(&self) -> bool {
        false
    }

    /// Whether a point of the patches of a part is one of the surface at a ray's time.
    ///
    /// * `_p`: where the point is at that time
    fn shows(&self, _part: u32, _p: Vec3, _time: f32) -> bool {
        true
    }

    /// Whether the surface faces where the patches of a part have their backs.
    fn is_inverted(&self, _part: u32) -> bool {
        false
    }

    /// The patches that the surface consists of with their parts, for surfaces that give light; none for
    /// unbounded ones. What has no closed form is a [`TracedPatch`].
    fn patches<F: FnMut(u32, Patch)>(&self, _visit: F) {}

    /// What the surface is called in messages, if it has an end and no patches all the same.
    fn without_patches(&self) -> Option<&'static str> {
        None
    }

    /// Triangles that stand for the surface; none for unbounded ones.
    ///
    /// * `around`: segments of a full circle
    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        self.patches(|part, patch| out.patch(part, &patch, around));
    }

    /// Whether [`Surface::tessellate`] makes triangles that grow in number with the square of the segments around.
    fn is_curved(&self) -> bool {
        true
    }

    /// Which of the shape's own materials a part has, if it brings any.
    fn material_slot(&self, _part: u32) -> Option<MaterialSlot> {
        None
    }

    /// Bytes kept beyond the shape's own record.
    fn heap_bytes(&self) -> usize {
        0
    }
}

family! {
    /// Names a shape in [`Shapes`].
    handle ShapeId;
    /// All shapes of a scene, each kind in a pool of its own.
    pools Shapes;
    /// Any shape.
    any AnyShape;
    contract Surface;
    members {
        bicubic_patches: BicubicPatch,
        bilinear_patches: BilinearPatch,
        blobs: Blob,
        cones: Cone,
        csgs: Csg,
        cuboids: Cuboid,
        curves: Curves,
        disks: Disk,
        height_fields: HeightField,
        isosurfaces: Isosurface,
        distance_grids: DistanceGrid,
        lathes: Lathe,
        meshes: Mesh,
        planes: Plane,
        prisms: Prism,
        quads: Quad,
        spheres: Sphere,
        sphere_sweeps: SphereSweep,
        superellipsoids: Superellipsoid,
        tori: Torus,
        triangles: Triangle,
    }
    any methods {
        /// See [`Surface::is_finite`].
        fn is_finite() -> bool;
        /// See [`Surface::is_solid`].
        fn is_solid() -> bool;
    }
    all methods {
        /// See [`Surface::expose`].
        fn expose(shutter: Shutter);
    }
    methods {
        /// See [`Surface::bounds`].
        fn bounds() -> Aabb;
        /// See [`Surface::hit`].
        fn hit(ray: &Ray) -> Option<Hit>;
        /// See [`Surface::blocks`].
        fn blocks(ray: &Ray) -> bool;
        /// See [`Surface::crossings`]; for any visitor the same code, of which each shape has much.
        fn crossings(ray: &Ray, visit: &mut dyn FnMut(Hit));
        /// See [`Surface::surface_at`].
        fn surface_at(ray: &Ray, hit: &Hit) -> SurfacePoint;
        /// See [`Surface::part_motion`].
        fn part_motion(part: u32) -> Option<&MovingTransform>;
        /// See [`Surface::has_moving_parts`].
        fn has_moving_parts() -> bool;
        /// See [`Surface::moves`].
        fn moves() -> bool;
        /// See [`Surface::bounds_during`].
        fn bounds_during(part: [f64; 2]) -> Aabb;
        /// See [`Surface::hit_at`].
        fn hit_at(part: u32, p: Vec3) -> Hit;
        /// See [`Surface::uv_at`].
        fn uv_at(hit: &Hit, p: Vec3) -> Vec2;
        /// See [`Surface::second_uv_at`].
        fn second_uv_at(hit: &Hit, p: Vec3) -> Option<Vec2>;
        /// See [`Surface::color_at`].
        fn color_at(hit: &Hit) -> Option<Vec4>;
        /// See [`Surface::has_colors`].
        fn has_colors() -> bool;
        /// See [`Surface::tangents_at`].
        fn tangents_at(hit: &Hit, p: Vec3) -> Tangents;
        /// See [`Surface::second_tangents_at`].
        fn second_tangents_at(hit: &Hit, p: Vec3) -> Option<Tangents>;
        /// See [`Surface::is_closed`].
        fn is_closed() -> bool;
        /// See [`Surface::is_solid`].
        fn is_solid() -> bool;
        /// See [`Surface::starts_inside`].
        fn starts_inside(ray: &Ray) -> bool;
        /// See [`Surface::part_count`].
        fn part_count() -> u32;
        /// See [`Surface::is_partial`].
        fn is_partial() -> bool;
        /// See [`Surface::shows`].
        fn shows(part: u32, p: Vec3, time: f32) -> bool;
        /// See [`Surface::is_inverted`].
        fn is_inverted(part: u32) -> bool;
        /// See [`Surface::patches`].
        fn patches(visit: &mut dyn FnMut(u32, Patch));
        /// See [`Surface::without_patches`].
        fn without_patches() -> Option<&'static str>;
        /// See [`Surface::tessellate`].
        fn tessellate(around: u32, out: &mut Tessellation);
        /// See [`Surface::is_curved`].
        fn is_curved() -> bool;
        /// See [`Surface::material_slot`].
        fn material_slot(part: u32) -> Option<MaterialSlot>;
        /// See [`Surface::heap_bytes`].
        fn heap_bytes() -> usize;
    }
}

/// A ray in double precision, for analytic shapes.
#[derive(Clone, Copy)]
pub(crate) struct Ray64 {
    pub o: DVec3,
    pub d: DVec3,
}

impl Ray64 {
    #[inline]
    pub fn new(ray: &Ray) -> Ray64 {
        Ray64 { o: ray.o.as_dvec3(), d: ray.d.as_dvec3() }
    }

    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.o + t * self.d
    }
}

/// `t` in single precision if it lies in the ray's range.
#[inline]
pub(crate) fn in_range(ray: &Ray, t: f64) -> Option<f32> {
    let t = t as f32;
    (t > ray.t_min && t < ray.t_max).then_some(t)
}

/// The nearest of a few crossings of a shape, from its list of all of them.
#[inline]
pub(crate) fn nearest_crossing(shape: &impl Surface, ray: &Ray) -> Option<Hit> {
    let mut nearest: Option<Hit> = None;
    shape.crossings(ray, |hit| {
        if nearest.is_none_or(|best| hit.t < best.t) {
            nearest = Some(hit);
        }
    });
    nearest
}

/// The coordinates in the unit square of the place of a patch that is nearest to `p`, or one of them: from the nearest of a grid
/// of places on by least squares.
///
/// * `at`: the point at coordinates, and its derivatives
pub(crate) fn nearest_uv(p: DVec3, at: impl Fn(DVec2) -> (DVec3, DVec3, DVec3)) -> DVec2 {
    const GRID: u32 = 8;
    const STEPS: u32 = 12;
    let off = |uv: DVec2| at(uv).0.distance_squared(p);
    let grid =
        (0..=GRID).flat_map(|j| (0..=GRID).map(move |i| DVec2::new(i.into(), j.into()) / f64::from(GRID)));
    let mut uv = grid.min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or_default();
    for _ in 0..STEPS {
        let (q, by_u, by_v) = at(uv);
        let w = p - q;
        let (a, b, c) = (by_u.dot(by_u), by_u.dot(by_v), by_v.dot(by_v));
        let (x, y, area) = (by_u.dot(w), by_v.dot(w), a * c - b * b);
        let next = uv + DVec2::new(c * x - b * y, a * y - b * x) / area;
        if !next.is_finite() {
            break;
        }
        uv = next.clamp(DVec2::ZERO, DVec2::ONE);
    }
    uv
}

/// The hit of a triangle's point `p`.
pub(crate) fn hit_of_triangle([a, b, c]: [DVec3; 3], part: u32, p: Vec3) -> Hit {
    let (ab, ac, w) = (b - a, c - a, p.as_dvec3() - a);
    let n = ab.cross(ac);
    let area = n.length_squared();
    let [u, v] = [w.cross(ac), ab.cross(w)].map(|part| if area > 0.0 { part.dot(n) / area } else { 0.0 });
    Hit { t: 0.0, u: u as f32, v: v as f32, part }
}

/// A point that was computed in double precision, in single, and a bound on the error of each coordinate.
///
/// * `scale`: size of the numbers it was computed from. A coordinate near zero that is the difference of larger
///   ones carries their error, many times its own last place.
#[inline]
pub(crate) fn stored(p: DVec3, scale: f64) -> (Vec3, Vec3) {
    /// Some ten roundings in double precision, `2^-49`.
    const COMPUTED: f64 = 8.0 * f64::EPSILON;
    let single = p.as_vec3();
    let computed = (COMPUTED * (scale + p.abs().max_element())) as f32 + f32::MIN_POSITIVE;
    (single, single.abs() * gamma(2) + Vec3::splat(computed))
}

/// How far from a triangle a ray has to start so that the test in single precision does not find it again.
///
/// The watertight test shears the corners, relative to the origin, in single precision: some ten roundings of
/// coordinates as large as the triangle. So it tests a triangle whose corners are moved by as much, in any direction:
/// also across a plane in which all corners share a coordinate, even one of 0.
pub(crate) fn triangle_error([a, b, c]: [DVec3; 3]) -> f32 {
    let extent = (b - a).abs().max((c - b).abs()).max((a - c).abs()).max_element();
    test_error(extent as f32)
}

#[cfg(test)]
mod tests;
