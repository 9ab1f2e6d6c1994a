//! What holds for every shape, checked from one list.

use std::f64::consts::PI;

use kajo_bvh::BuildSettings;
use kajo_math::{DVec2, Motion, rng::Stream, warp};

use super::*;
use crate::interaction::RayOffset;

/// Calls `$check` with every finite shape of the list, its name first.
macro_rules! every_shape {
    ($check:ident $(, $arg:expr)*) => {{
        convex_shapes!($check $(, $arg)*);
        closed_shapes!($check $(, $arg)*);
    }};
}

/// The same with closed shapes of which a ray that leaves may enter again.
macro_rules! closed_shapes {
    ($check:ident $(, $arg:expr)*) => {{
        $check("torus", &torus(0.7, 0.25) $(, $arg)*);
        $check("torus without a hole", &torus(0.4, 0.4) $(, $arg)*);
        $check("torus that crosses itself", &torus(0.3, 0.5) $(, $arg)*);
        $check("blob", &blob() $(, $arg)*);
        $check("tube of a spline", &tube(CurveBasis::BSpline) $(, $arg)*);
        $check("tube of Béziers", &tube(CurveBasis::Bezier) $(, $arg)*);
        $check("isosurface", &isosurface() $(, $arg)*);
        $check("bilinear patch", &bilinear_patch() $(, $arg)*);
        $check("bicubic patch", &bicubic_patch() $(, $arg)*);
        $check("height field", &height_field(Some(-0.6)) $(, $arg)*);
        $check("height field without a base", &height_field(None) $(, $arg)*);
        $check("lathe", &lathe(false) $(, $arg)*);
        $check("lathe of a sheet", &lathe(true) $(, $arg)*);
        $check("sphere sweep", &sphere_sweep() $(, $arg)*);
        $check("prism", &prism() $(, $arg)*);
        $check("prism that crosses itself", &star_prism() $(, $arg)*);
        $check("difference", &carved(SetOperation::Difference) $(, $arg)*);
        $check("merge", &carved(SetOperation::Union) $(, $arg)*);
        $check("intersection", &carved(SetOperation::Intersection) $(, $arg)*);
    }};
}

/// The same with those that nothing leaves outward and meets again.
macro_rules! convex_shapes {
    ($check:ident $(, $arg:expr)*) => {{
        $check("sphere", &Sphere::new(Vec3::new(0.3, -0.2, 0.1), 0.9) $(, $arg)*);
        $check("box", &Cuboid::new(Vec3::new(-0.5, -1.0, -0.2), Vec3::new(0.9, 0.4, 0.7)) $(, $arg)*);
        $check("cylinder", &cone(0.6, 0.6, true) $(, $arg)*);
        $check("cone", &cone(0.8, 0.0, true) $(, $arg)*);
        $check("truncated cone", &cone(0.8, 0.3, true) $(, $arg)*);
        $check("superellipsoid", &superellipsoid(0.6, 1.3) $(, $arg)*);
        $check("rounded box", &superellipsoid(0.2, 0.2) $(, $arg)*);
        $check("open cylinder", &cone(0.6, 0.6, false) $(, $arg)*);
        $check("disk", &Disk::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), 1.0, 0.3).unwrap() $(, $arg)*);
        $check("quad", &Quad::new(Vec3::ZERO, Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.3, 1.0, 0.5)).unwrap() $(, $arg)*);
        $check("triangle", &triangle() $(, $arg)*);
        $check("mesh", &octahedron() $(, $arg)*);
    }};
}

fn cone(base: f32, top: f32, capped: bool) -> Cone {
    Cone::new(Vec3::new(0.1, -0.6, 0.2), Vec3::new(-0.2, 0.7, 0.4), base, top, capped).unwrap()
}

fn torus(major: f32, minor: f32) -> Torus {
    Torus::new(Vec3::new(0.1, -0.1, 0.05), Vec3::new(0.3, 1.0, -0.4), major, minor).unwrap()
}

/// A thick tube that bends and gets thinner.
fn tube(basis: CurveBasis) -> Curves {
    let points = [[-0.8, -0.6, 0.2], [-0.3, 0.7, -0.4], [0.4, 0.5, 0.6], [0.8, -0.6, 0.1]];
    let strands = Strands {
        points: points.map(Vec3::from_array).to_vec(),
        radii: vec![0.3, 0.2, 0.22, 0.12],
        ends: vec![4],
    };
    Curves::new(&strands, basis, CurveForm::Tube).unwrap()
}

fn blob() -> Blob {
    let ball = |x: f64, strength: f64| BlobComponent {
        core: BlobCore::Ball(DVec3::new(x, 0.2 * x, -0.1)),
        radius: 0.6,
        strength,
        material: 0,
    };
    let rod = BlobCore::Cylinder([DVec3::new(-0.3, -0.5, 0.0), DVec3::new(0.2, 0.5, 0.3)]);
    let rod = BlobComponent { core: rod, radius: 0.4, strength: 0.7, material: 0 };
    Blob::new(BlobKernel::Gaussian, 0.5, &[ball(-0.4, 1.0), ball(0.5, 1.2), ball(0.0, -0.4), rod]).unwrap()
}

/// A ball with dents, cut by a face of its box: `x^2 + y^2 + z^2 + 0.1 sin(9 x) - 0.5`.
fn isosurface() -> Isosurface {
    use kajo_math::tape::{Binary, Node, TapeBuilder, Unary};
    let mut tape = TapeBuilder::new();
    let squares = [0, 1, 2].map(|i| {
        let x = tape.variable(i);
        tape.unary(Unary::Powi(2), x)
    });
    let x = tape.variable(0);
    let ripples = tape.mul(Node::Constant(9.0), x);
    let ripples = tape.unary(Unary::Sin, ripples);
    let ripples = tape.mul(Node::Constant(0.1), ripples);
    let value = [squares[1], squares[2], ripples, Node::Constant(-0.5)]
        .into_iter()
        .fold(squares[0], |sum, term| tape.binary(Binary::Add, sum, term));
    let (min, max) = (Vec3::new(-1.0, -0.55, -1.0), Vec3::ONE);
    Isosurface::new(std::sync::Arc::new(tape.finish(value)), min, max, true).unwrap()
}

fn bilinear_patch() -> BilinearPatch {
    let corners = [[-0.8, -0.6, 0.4], [0.7, -0.7, -0.2], [0.8, 0.8, 0.5], [-0.6, 0.7, -0.5]];
    BilinearPatch::new(corners.map(Vec3::from_array)).unwrap()
}

fn bicubic_patch() -> BicubicPatch {
    let bent = [[0.0, 0.5, 0.2, -0.3], [0.4, 1.0, 0.3, 0.0], [-0.2, 0.3, -0.8, 0.2], [0.1, 0.0, 0.4, 0.5]];
    let at = |i: usize, j: usize| Vec3::new(0.5 * i as f32 - 0.75, 0.5 * j as f32 - 0.75, bent[j][i]);
    BicubicPatch::new([0, 1, 2, 3].map(|j| [0, 1, 2, 3].map(|i| at(i, j)))).unwrap()
}

fn superellipsoid(east: f32, north: f32) -> Superellipsoid {
    Superellipsoid::new(Vec3::new(0.1, -0.2, 0.05), 0.75, east, north).unwrap()
}

/// A single cell, which has no edges, that is twisted.
fn height_field(base: Option<f64>) -> HeightField {
    let grid = HeightGrid { columns: 2, rows: 2, heights: vec![0.5, -0.3, -0.1, 0.4] };
    HeightField::new(grid, DVec2::new(-0.7, -0.6), DVec2::new(1.4, 1.3), base, false).unwrap()
}

fn sweep(depth: f64, taper: f64, rule: FillRule) -> Sweep {
    let (origin, axis) = (DVec3::new(0.1, -0.2, -0.3), DVec3::new(0.3, 0.4, 1.2).normalize());
    let right = DVec3::Y.cross(axis).normalize();
    Sweep { origin, axes: [right, axis.cross(right), axis], depth, taper, rule, bevel: None }
}

/// A body with a neck and a foot, and a ring cut out of its inside; or only its side.
fn lathe(open: bool) -> Lathe {
    let p = DVec2::new;
    let mut body = Path::new(p(if open { 0.3 } else { 0.0 }, -0.7));
    body.line_to(p(0.5, -0.7));
    body.cubic_to([p(0.9, -0.4), p(0.1, -0.1)], p(0.4, 0.3));
    body.quadratic_to(p(0.6, 0.6), p(if open { 0.2 } else { 0.0 }, 0.7));
    let hole = Path::closed_spline(&[p(0.2, -0.5), p(0.1, -0.4), p(0.2, -0.3), p(0.3, -0.4)]).unwrap();
    let axis = DVec3::new(0.3, 0.4, 1.2).normalize();
    let turning = Turning { origin: DVec3::new(0.1, -0.05, 0.0), axis, rule: FillRule::EvenOdd };
    let profiles = if open { vec![body] } else { vec![body, hole] };
    Lathe::new(turning, &profiles).unwrap()
}

/// A cone, a bend and a spline, in a loop.
fn sphere_sweep() -> SphereSweep {
    let p = |x: f64, y: f64, z: f64, r: f64| kajo_math::DVec4::new(x, y, z, r);
    let mut path = Path::new(p(-0.6, -0.5, 0.1, 0.3));
    path.line_to(p(0.3, -0.5, -0.1, 0.15));
    path.cubic_to([p(0.9, -0.5, -0.2, 0.2), p(0.8, 0.5, 0.2, 0.4)], p(0.2, 0.5, 0.2, 0.2));
    path.spline_through(&[p(-0.2, 0.0, 0.3, 0.15), p(0.1, -0.4, -0.3, 0.1)]);
    SphereSweep::new(&[path]).unwrap()
}

/// Straight and round on the outside, with a hole.
fn prism() -> Prism {
    let p = DVec2::new;
    let mut outside = Path::new(p(-0.7, -0.5));
    outside.line_to(p(0.5, -0.6));
    outside.cubic_to([p(0.9, -0.4), p(0.9, 0.3)], p(0.4, 0.5));
    outside.quadratic_to(p(-0.3, 0.8), p(-0.7, 0.3));
    outside.close();
    let mut hole = Path::new(p(-0.2, -0.2));
    hole.line_to(p(-0.2, 0.2));
    hole.line_to(p(0.2, 0.1));
    hole.close();
    Prism::new(sweep(0.8, 1.0, FillRule::NonZero), &[outside, hole]).unwrap()
}

/// A star whose sides cross, and whose middle is gone around twice; smaller at its far end.
fn star_prism() -> Prism {
    let corner = |i: u32| {
        let angle = 0.8 * PI * f64::from(i) + 0.1;
        DVec2::new(0.9 * angle.cos(), 0.8 * angle.sin())
    };
    let mut star = Path::new(corner(0));
    (1..5).for_each(|i| star.line_to(corner(i)));
    star.close();
    Prism::new(sweep(0.9, 0.4, FillRule::EvenOdd), &[star]).unwrap()
}

/// A box, and a ball and a mesh somewhere else.
fn carved(operation: SetOperation) -> Csg {
    let map = kajo_math::DAffine3::from_translation(DVec3::new(0.4, 0.3, 0.2))
        * kajo_math::DAffine3::from_rotation_z(0.4)
        * kajo_math::DAffine3::from_scale(DVec3::new(1.0, 0.8, 1.2));
    let part =
        |shape: AnyShape, map| vec![SolidPart { shape, map: Motion::still(map), material: None, source: 0 }];
    let still = kajo_math::DAffine3::IDENTITY;
    let cuboid = Cuboid::new(Vec3::new(-0.6, -0.7, -0.5), Vec3::new(0.5, 0.4, 0.6));
    let operands = [
        part(cuboid.into(), still),
        part(Sphere::new(Vec3::new(0.2, 0.1, 0.3), 0.6).into(), map),
        part(octahedron().into(), map),
    ];
    let first = if operation == SetOperation::Intersection { &operands[..] } else { &operands[..2] };
    Csg::new(operation, first).unwrap()
}

fn triangle() -> Triangle {
    let vertices = [Vec3::new(-0.7, 0.0, 0.3), Vec3::new(0.8, -0.2, 0.1), Vec3::new(0.1, 0.9, -0.5)];
    Triangle { vertices, uvs: [Vec2::ZERO, Vec2::X, Vec2::Y] }
}

fn octahedron() -> Mesh {
    let positions = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].to_vec();
    let faces = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Mesh::new(MeshData { positions, faces, ..MeshData::default() }, &BuildSettings::default()).unwrap()
}

/// A line through a random point of the unit ball in a random direction.
fn random_line(i: u32) -> Ray {
    let s = Stream::new(17, [i, 0], 0);
    let u = |k| Vec2::new(s.uniform(k), s.uniform(k + 1));
    let (through, d) = (warp::uniform_sphere(u(0)) * s.uniform(2), warp::uniform_sphere(u(3)));
    Ray::new(through - 3.0 * d, d)
}

/// Vertices and middles of triangles lie on the surface or the sagitta below it, normals agree, and the areas add up.
fn triangles_stand_for_the_surface(name: &str, shape: &impl Surface) {
    const AROUND: u32 = 64;
    let mut triangles = Tessellation::default();
    shape.tessellate(AROUND, &mut triangles);
    let sagitta = 1.0 - (std::f32::consts::PI / AROUND as f32).cos();
    let (mut area, mut expected) = (0.0, 0.0);
    shape.patches(|_, patch| expected += patch.area());
    for (&face, &part) in triangles.faces.iter().zip(&triangles.parts) {
        let corners = face.map(|i| triangles.positions[i as usize]);
        let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        area += f64::from(0.5 * across.length());
        let n = across.normalize();
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        // From outside, a little beside the edges of parts that meet.
        for (p, off) in [(middle, 2.0 * sagitta), (corners[0].lerp(middle, 1e-3), 2e-3 * sagitta + 1e-5)] {
            let ray = Ray::new(p + 0.1 * n, -n);
            let hit = shape.hit(&ray).unwrap_or_else(|| panic!("{name}: no surface at {p}"));
            assert!((hit.t - 0.1).abs() <= off, "{name}: {p} is {} off", hit.t - 0.1);
            assert_eq!(hit.part, part, "{name} at {p}");
        }
        for i in face {
            let stored = triangles.normals[i as usize];
            let hit = Ray::new(triangles.positions[i as usize].lerp(middle, 1e-4) + 0.1 * n, -n);
            let found = shape.surface_at(&hit, &shape.hit(&hit).unwrap()).n;
            // At the tip of a cone normals turn by half a segment.
            let agree = stored == Vec3::ZERO || stored.distance(found) < 0.06;
            assert!(agree && stored.dot(n) >= 0.0, "{name}: {stored} for {found}");
        }
    }
    assert!((area / expected - 1.0).abs() < 5e-3, "{name}: {area} for {expected}");
}

#[test]
fn tessellations_stand_for_their_shapes() {
    convex_shapes!(triangles_stand_for_the_surface);
    // Of those without a hole another part of the surface is too near, in the middle.
    triangles_stand_for_the_surface("torus", &torus(0.7, 0.25));
}

#[test]
fn a_mesh_keeps_its_vertices_where_it_can() {
    let mut flat = Tessellation::default();
    octahedron().tessellate(8, &mut flat);
    assert_eq!((flat.positions.len(), flat.faces.len()), (6, 8));
    assert!(flat.normals.iter().all(|&n| n == Vec3::ZERO));
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = vec![[0, 1, 2], [0, 1, 3]];
    // Both triangles share their first vertex with its normal; the second one has two.
    let normals = CornerValues { values: vec![Vec3::Z, Vec3::Y], faces: Some(vec![[0, 0, 0], [0, 1, 1]]) };
    let data = MeshData { positions, faces, normals: Some(normals), ..MeshData::default() };
    let mut smooth = Tessellation::default();
    Mesh::new(data, &BuildSettings::default()).unwrap().tessellate(8, &mut smooth);
    assert_eq!(smooth.faces, [[0, 1, 2], [0, 4, 3]]);
    assert_eq!(smooth.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Y]);
    assert_eq!((smooth.positions[4], smooth.parts), (Vec3::X, vec![0, 1]));
}

fn hits_lie_in_the_bounds_and_on_the_surface(name: &str, shape: &impl Surface) {
    let (bounds, mut found) = (shape.bounds(), 0);
    for i in 0..4000 {
        let ray = random_line(i);
        let mut nearest = f32::INFINITY;
        let mut count = 0;
        shape.crossings(&ray, |hit| {
            nearest = nearest.min(hit.t);
            count += 1;
        });
        let hit = shape.hit(&ray);
        assert_eq!(hit.map_or(f32::INFINITY, |h| h.t), nearest, "{name}: nearest of all crossings, ray {i}");
        assert_eq!(hit.is_some(), shape.blocks(&ray));
        assert!(!shape.is_closed() || count % 2 == 0, "{name}: a closed shape is left as often as entered");
        let Some(hit) = hit else { continue };
        found += 1;
        let at = shape.surface_at(&ray, &hit);
        assert!(bounds.padded(1e-6).contains(at.p), "{name}: {} outside {bounds:?}", at.p);
        assert!(at.p.distance(ray.at(hit.t)) < 1e-5, "{name}: {} is not on the ray", at.p);
        assert!((at.n.length() - 1.0).abs() < 1e-5);
        let uv = shape.uv_at(&hit, at.p);
        assert!(uv.cmpge(Vec2::splat(-1e-4)).all() && uv.cmple(Vec2::splat(1.0001)).all(), "{name}: uv {uv}");
        // The range is exclusive on both sides.
        assert!(shape.hit(&ray.over(0.0, hit.t)).is_none(), "{name}: t_max");
        let beyond = shape.hit(&ray.over(hit.t, f32::INFINITY));
        assert!(beyond.is_none_or(|next| next.t > hit.t), "{name}: t_min");
    }
    assert!(found > 400, "{name}: only {found} rays hit");
}

#[test]
fn every_shape_is_consistent() {
    every_shape!(hits_lie_in_the_bounds_and_on_the_surface);
}

/// Normals against the surface itself: three neighbouring rays give two tangents.
fn normals_are_perpendicular_to_the_surface(name: &str, shape: &impl Surface) {
    let mut checked = 0;
    for i in 0..2000 {
        let ray = random_line(i);
        let (s, t) = warp::basis(ray.d);
        let h = 2e-3;
        let point = |offset: Vec3| {
            let moved = Ray { o: ray.o + offset, ..ray };
            shape.hit(&moved).map(|hit| (hit, shape.surface_at(&moved, &hit)))
        };
        // Central differences, where all five rays meet the same part away from silhouettes and edges.
        let five = [Vec3::ZERO, h * s, -h * s, h * t, -h * t].map(point);
        let [Some(middle), Some(a), Some(b), Some(c), Some(d)] = five else { continue };
        let elsewhere = |h: &Hit| h.part != middle.0.part || (h.t - middle.0.t).abs() > 0.01;
        let is_edge = |p: &(Hit, SurfacePoint)| p.1.n.dot(middle.1.n) < 0.95;
        if [a, b, c, d].iter().any(|p| elsewhere(&p.0) || is_edge(p)) || ray.d.dot(middle.1.n).abs() < 0.4 {
            continue;
        }
        checked += 1;
        let n = (a.1.p - b.1.p).cross(c.1.p - d.1.p).normalize();
        let off = n.dot(middle.1.n).abs();
        assert!(off > 1.0 - 2e-5, "{name}: ray {i}, {n} against {}", middle.1.n);
        if shape.is_closed() {
            assert!(ray.d.dot(middle.1.ng) < 0.0, "{name}: normals of closed shapes point outward");
        }
    }
    assert!(checked > 100, "{name}: only {checked} checked");
}

#[test]
fn every_normal_is_right() {
    every_shape!(normals_are_perpendicular_to_the_surface);
}

/// A step along a tangent changes its coordinate by the step and the other one not at all.
fn tangents_are_derivatives(name: &str, shape: &impl Surface) {
    let mut checked = 0;
    for i in 0..400 {
        let ray = random_line(i);
        let Some(hit) = shape.hit(&ray) else { continue };
        let at = shape.surface_at(&ray, &hit);
        let (uv, tangents) = (shape.uv_at(&hit, at.p), shape.tangents_at(&hit, at.p));
        assert!(tangents.dpdu.dot(at.n).abs() <= 1e-4 * tangents.dpdu.length(), "{name}: {tangents:?}");
        for (tangent, expected) in [(tangents.dpdu, Vec2::X), (tangents.dpdv, Vec2::Y)] {
            let h = 2e-3 / tangent.length();
            let beside = [h, -h].map(|h| {
                let down = Ray::new(at.p + h * tangent + 0.1 * at.n, -at.n);
                shape.hit(&down).map(|hit| (hit.part, shape.uv_at(&hit, down.at(hit.t))))
            });
            let [Some((a, ahead)), Some((b, behind))] = beside else { continue };
            // Not across an edge, and not where u begins again.
            if a != hit.part || b != hit.part || ahead.distance(uv) + behind.distance(uv) > 0.5 {
                continue;
            }
            checked += 1;
            let found = (ahead - behind) / (2.0 * h);
            // Near poles and tips coordinates bend.
            assert!(found.distance(expected) < 0.05, "{name}: {found} along {tangent} at {}", at.p);
        }
    }
    assert!(checked > 40, "{name}: only {checked} checked");
}

#[test]
fn every_tangent_is_a_derivative() {
    // A mesh without coordinates has no tangents, and no blob, isosurface or sphere sweep has.
    every_shape!(tangents_are_derivatives_of_shapes_with_coordinates);
    let plane = Plane::new(DVec3::new(1.0, 2.0, -0.5), 0.3);
    tangents_are_derivatives("plane", &plane);
    let positions = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y].map(|p| p - 0.4).to_vec();
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::new(0.9, 0.7), Vec2::Y].to_vec();
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let uvs = Some(CornerValues { values: uvs, faces: None });
    let mesh = MeshData { positions, faces, uvs, ..MeshData::default() };
    tangents_are_derivatives("mesh", &Mesh::new(mesh, &BuildSettings::default()).unwrap());
}

fn tangents_are_derivatives_of_shapes_with_coordinates(name: &str, shape: &impl Surface) {
    let ray = Ray::new(Vec3::new(0.1, 0.2, 3.0), Vec3::new(0.0, 0.0, -1.0));
    match shape.hit(&ray).map(|hit| shape.tangents_at(&hit, ray.at(hit.t))) {
        Some(tangents) if ["mesh", "blob", "isosurface", "sphere sweep"].contains(&name) => {
            assert_eq!(tangents, Tangents::default())
        }
        _ => tangents_are_derivatives(name, shape),
    }
}

/// Volume by the lengths of parallel chords, from all crossings.
fn volume(shape: &impl Surface) -> f64 {
    let bounds = shape.bounds().padded(0.01);
    let (n, extent) = (700, bounds.extent());
    let mut sum = 0.0;
    for j in 0..n {
        for i in 0..n {
            let at = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / n as f32;
            let o = bounds.min + Vec3::new(at.x * extent.x, at.y * extent.y, -1.0);
            let ray = Ray::new(o, Vec3::Z);
            shape.crossings(&ray, |hit| {
                let leaves = shape.surface_at(&ray, &hit).ng.z > 0.0;
                sum += f64::from(if leaves { hit.t } else { -hit.t });
            });
        }
    }
    sum * f64::from(extent.x) * f64::from(extent.y) / f64::from(n * n)
}

#[test]
fn volumes_follow_their_formulas() {
    let height = f64::from(Vec3::new(-0.3, 1.3, 0.2).length());
    let frustum = |r: f64, s: f64| PI * height / 3.0 * (r * r + r * s + s * s);
    let near = |name: &str, got: f64, expected: f64| {
        assert!((got / expected - 1.0).abs() < 1e-3, "{name}: {got} instead of {expected}");
    };
    near("sphere", volume(&Sphere::new(Vec3::splat(0.3), 0.9)), 4.0 / 3.0 * PI * 0.729);
    near("box", volume(&Cuboid::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.5))), 1.0);
    near("cylinder", volume(&cone(0.6, 0.6, true)), frustum(0.6, 0.6));
    near("cone", volume(&cone(0.8, 0.0, true)), frustum(0.8, 0.0));
    near("truncated cone", volume(&cone(0.8, 0.3, true)), frustum(0.8, 0.3));
    near("mesh", volume(&octahedron()), 4.0 / 3.0);
    // Pappus: area of the tube's section times the way of its middle.
    let ring = |major: f64, minor: f64| 2.0 * PI * PI * major * minor * minor;
    near("torus", volume(&torus(0.7, 0.25)), ring(0.7, 0.25));
    near("torus without a hole", volume(&torus(0.4, 0.4)), ring(0.4, 0.4));
    // Of the section only what is on its side of the axis, and its middle by the integral of r dr dz.
    let (major, minor, angle) = (0.3f64, 0.5f64, (-0.3f64 / 0.5).acos());
    let apple = 2.0
        * PI
        * minor
        * minor
        * (major * (angle - 0.5 * (2.0 * angle).sin()) + 2.0 / 3.0 * minor * angle.sin().powi(3));
    near("torus that crosses itself", volume(&torus(0.3, 0.5)), apple);
}

/// Rays that leave a shape outward do not meet the place that they leave, and a convex one nowhere.
fn outward_rays_escape(name: &str, shape: &impl Surface, convex: bool) {
    for i in 0..4000 {
        let ray = random_line(i);
        let Some(hit) = shape.hit(&ray) else { continue };
        let at = shape.surface_at(&ray, &hit);
        let s = Stream::new(23, [i, 0], 0);
        let w = warp::uniform_sphere(Vec2::new(s.uniform(0), s.uniform(1)));
        let w = if w.dot(at.ng) < 0.0 { -w } else { w };
        let away = at.ray_towards(w, f32::INFINITY, 0.0, RayOffset::Auto);
        // Others may be entered again, after which the surface that was left is no longer near.
        let next = shape.hit(&away);
        let enters = next.is_none_or(|next| shape.surface_at(&away, &next).ng.dot(w) < 0.0);
        assert!(if convex { next.is_none() } else { enters }, "{name}: ray {i} towards {w} at {}", at.p);
    }
}

#[test]
fn no_ray_meets_the_surface_it_leaves() {
    convex_shapes!(outward_rays_escape, true);
    closed_shapes!(outward_rays_escape, false);
    for scale in [1e-4f32, 1e-2, 1.0, 1e3, 1e6] {
        let far = Vec3::new(3.0, -2.0, 1.0) * scale;
        for i in 0..2000 {
            let line = random_line(i);
            let ray = Ray::new(far + scale * line.o, line.d);
            leaves_alone(&Sphere::new(far, 0.8 * scale), &ray);
            leaves_alone(&Plane::new(DVec3::new(0.3, 1.0, -0.2), f64::from(scale)), &ray);
            leaves_alone(&Disk::new(far, line.o, scale, 0.0).unwrap(), &ray);
        }
    }
}

fn leaves_alone(shape: &impl Surface, ray: &Ray) {
    let Some(hit) = shape.hit(ray) else { return };
    let at = shape.surface_at(ray, &hit);
    for d in [Vec3::X, Vec3::new(0.6, -0.64, 0.48), Vec3::NEG_Z] {
        let d = if d.dot(at.ng) < 0.0 { -d } else { d };
        assert!(!shape.blocks(&at.ray_towards(d, f32::INFINITY, 0.0, RayOffset::Auto)), "{} {d}", at.p);
    }
}

#[test]
fn no_ray_meets_the_surface_it_leaves_where_a_coordinate_is_all_but_zero() {
    // The normals' lengths are one only to the last place, which leaves hits a little off the plane y = 0, by
    // more than a hit's own last place there.
    for i in 0..200 {
        let random = Stream::new(31, [i, 0], 0);
        let number = |k: u32| 0.1 + 3.0 * random.uniform(k);
        let (a, b) = (Vec3::new(0.0, 0.0, number(0)), Vec3::new(number(1), 0.0, 0.0));
        let quad = Quad::new(Vec3::ZERO, a, b).unwrap();
        let triangle = Triangle { vertices: [Vec3::ZERO, a, b], uvs: [Vec2::ZERO; 3] };
        let disk = Disk::new(Vec3::ZERO, Vec3::new(0.0, number(2), 0.0), number(3), 0.0).unwrap();
        for k in 0..20 {
            let target = (a + b) * (0.4 * random.uniform(4 + k));
            let from = target + Vec3::new(number(30 + k), 5.0, -number(60 + k));
            let ray = Ray::new(from, target - from);
            leaves_alone(&quad, &ray);
            leaves_alone(&triangle, &ray);
            leaves_alone(&disk, &ray);
        }
    }
}

#[test]
fn odd_numbers_do_no_harm() {
    fn poke(_name: &str, shape: &impl Surface) {
        for bad in [f32::NAN, f32::INFINITY, f32::MAX, 0.0, -0.0, f32::MIN_POSITIVE] {
            for k in 0..6 {
                let mut v = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
                v[k] = bad;
                let ray = Ray::new(Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5]));
                if let Some(hit) = shape.hit(&ray) {
                    assert!(!hit.t.is_nan());
                }
            }
            let still = Ray::new(Vec3::ZERO, Vec3::splat(0.0 * bad));
            assert!(shape.hit(&still).is_none_or(|hit| !hit.t.is_nan()));
        }
    }
    every_shape!(poke);
    assert!(Sphere::new(Vec3::ZERO, 0.0).hit(&Ray::new(Vec3::NEG_Z, Vec3::Z)).is_none());
    assert_eq!(Sphere::new(Vec3::ZERO, -2.0).radius, 2.0);
    assert!(Plane::new(DVec3::ZERO, 1.0).hit(&Ray::new(Vec3::NEG_Z, Vec3::Z)).is_none());
    let flat = Triangle { vertices: [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], uvs: [Vec2::ZERO; 3] };
    assert!(flat.is_degenerate() && !triangle().is_degenerate());
}

/// A row of triangles round a point shares edges; no ray through an edge or the point slips between.
#[test]
fn neighbouring_triangles_leave_no_gap() {
    let hub = Vec3::new(0.123, -0.456, 0.789);
    let rim: Vec<Vec3> = (0..7)
        .map(|i| {
            let s = Stream::new(31, [i, 0], 0);
            let (sin, cos) =
                kajo_math::fmath::sin_cos(std::f32::consts::TAU * (i as f32 + s.uniform(0)) / 7.0);
            hub + Vec3::new(cos, sin, s.uniform(1) - 0.5)
        })
        .collect();
    let fan: Vec<Triangle> = (0..7)
        .map(|i| Triangle { vertices: [hub, rim[i], rim[(i + 1) % 7]], uvs: [Vec2::ZERO; 3] })
        .collect();
    for i in 0..200_000u32 {
        let s = Stream::new(37, [i, 0], 0);
        let edge = rim[(i % 7) as usize] - hub;
        let target = if i % 3 == 0 { hub } else { hub + 0.9 * s.uniform(0) * edge };
        let o = hub + Vec3::new(s.uniform(1) - 0.5, s.uniform(2) - 0.5, 5.0);
        let ray = Ray::new(o, target - o);
        assert!(fan.iter().any(|t| t.hit(&ray).is_some()), "ray {i} slips through");
    }
}

#[test]
fn meshes_know_whether_they_are_closed() {
    assert!(octahedron().is_closed());
    let [x, y, z, o] = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ZERO];
    let mesh = |positions: Vec<Vec3>, faces: Vec<[u32; 3]>| {
        let data = MeshData { positions, faces, ..MeshData::default() };
        Mesh::new(data, &BuildSettings::default()).unwrap().is_closed()
    };
    let tetrahedron = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    assert!(mesh(vec![o, x, y, z], tetrahedron.clone()));
    assert!(!mesh(vec![o, x, y, z], tetrahedron[..3].to_vec()), "a face is missing");
    let turned = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 3, 0]];
    assert!(!mesh(vec![o, x, y, z], turned), "a face is turned round");
    // Every face with points of its own: closed all the same.
    let apart: Vec<Vec3> = tetrahedron.iter().flatten().map(|&i| [o, x, y, z][i as usize]).collect();
    assert!(mesh(apart, (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()));
}

#[test]
fn colours_of_corners_are_interpolated() {
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE];
    let faces = vec![[0, 1, 2], [1, 3, 2], [0, 1, 3]];
    let values = vec![Vec4::X, Vec4::Y, Vec4::ONE];
    let own = vec![[0, 1, 2], [2, 2, 2], [ABSENT; 3]];
    let colors = Some(CornerValues { values, faces: Some(own) });
    let data = MeshData { positions, faces, colors, ..MeshData::default() };
    let mesh = Mesh::new(data, &BuildSettings::default()).unwrap();
    let at = |part, u, v| mesh.color_at(&Hit { t: 1.0, u, v, part });
    assert_eq!(at(0, 0.5, 0.25), Some(Vec4::new(0.5, 0.75, 0.25, 0.25)));
    assert_eq!(at(1, 0.5, 0.25), Some(Vec4::ONE));
    assert_eq!((at(2, 0.5, 0.25), at(0, 1.5, 0.0)), (None, Some(Vec4::Y)));
    assert!(mesh.has_colors() && mesh.heap_bytes() >= 3 * 28);
}
