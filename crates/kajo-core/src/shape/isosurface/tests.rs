use std::f64::consts::PI;

use kajo_math::rng::Stream;
use kajo_math::tape::{Node, TapeBuilder, Unary};
use kajo_scene::SceneDesc;

use super::*;

/// The surface of a function as a scene writes it.
fn surface(function: &str, extent: f32, closed: bool) -> Isosurface {
    let desc = SceneDesc::parse_str(&format!("f = {function}")).desc;
    let function = desc.roots().next().unwrap().function().expect("a function").clone();
    Isosurface::new(function, Vec3::splat(-extent), Vec3::splat(extent), closed).unwrap()
}

/// The eighth Chebyshev polynomials.
fn chebyshev() -> Isosurface {
    let t8 = |x: &str| format!("(((128*{x}^2 - 256)*{x}^2 + 160)*{x}^2 - 32)*{x}^2 + 1");
    surface(&[t8("x"), t8("y"), t8("z")].join(" + "), 1.0, false)
}

/// All crossings of a line in double precision, in ascending order.
fn roots_of(surface: &Isosurface, o: DVec3, d: DVec3) -> Vec<f64> {
    let parts = &*surface.0;
    let line = Ray64 { o, d };
    let faces = if parts.closed { parts.faces(&line) } else { None };
    let faces = faces.into_iter().flatten().map(|(t, _)| t);
    let mut found: Vec<f64> = faces.filter(|&t| parts.is_inside(line.at(t))).collect();
    for cell in parts.cells.iter() {
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        if let Some(piece) = parts.cells.clip(cell, &line, everywhere) {
            parts.passage(&line).cross(cell, piece, &mut |_, root| {
                found.push(root());
                false
            });
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

/// Roots by the closed form, also from ten thousand units away.
#[test]
fn crossings_of_a_chebyshev_surface_are_right_to_a_billionth() {
    let surface = chebyshev();
    let expected = [0.2818640552, 0.4791286940, 0.8777446637, 0.9594543524];
    for far in [2.0, 1e4] {
        let found = roots_of(&surface, DVec3::new(-far, 0.1, 0.2), DVec3::X);
        let found: Vec<f64> = found.iter().map(|t| t - far).collect();
        assert_eq!(found.len(), 8, "{found:?}");
        for (i, x) in expected.into_iter().enumerate() {
            assert!((found[4 + i] - x).abs() < 1e-9 && (found[3 - i] + x).abs() < 1e-9, "{found:?}");
        }
    }
    // Elsewhere on the line they are the cosines of the other closed form, or none.
    for i in 0..500 {
        let [y, z] = [0, 1].map(|k| f64::from(Stream::new(3, [i, 0], 0).uniform(k)) * 2.0 - 1.0);
        let t8 = |x: f64| (8.0 * x.acos()).cos();
        let s = -t8(y) - t8(z);
        let found = roots_of(&surface, DVec3::new(-3.0, y, z), DVec3::X);
        if s.abs() > 1.0 + 1e-9 {
            assert!(found.is_empty(), "{found:?} at {y} {z}");
        } else if s.abs() < 1.0 - 1e-6 {
            let angle = s.acos();
            let mut all: Vec<f64> = (0..8)
                .map(|k| {
                    ((if k % 2 == 0 { angle } else { -angle } + 2.0 * PI * f64::from((k + 1) / 2)) / 8.0)
                        .cos()
                })
                .collect();
            all.sort_by(f64::total_cmp);
            assert_eq!(found.len(), 8, "{found:?} for {all:?} at {y} {z}");
            assert!(found.iter().zip(&all).all(|(t, x)| (t - 3.0 - x).abs() < 1e-9), "{found:?} for {all:?}");
        }
    }
}

/// The number of crossings against the sign of the function on a fine grid of each line.
#[test]
fn no_crossing_is_missed() {
    for (name, surface) in [
        ("gyroid", surface("sin(5*x)*cos(5*y) + sin(5*y)*cos(5*z) + sin(5*z)*cos(5*x)", 1.0, true)),
        ("heart", surface("(2*x^2 + 2*y^2 + z^2 - 1)^3 - 0.2*x^2*z^3 - 2*y^2*z^3", 1.5, true)),
        ("thin shell", surface("abs(x^2 + y^2 + z^2 - 0.5) - 0.002", 1.0, true)),
        ("rounded steps", surface("max(abs(x), abs(y)) - 0.6 + 0.2*floor(3*z)/3", 1.0, true)),
        ("pole", surface("1/(x + 0.3*y) + z", 1.0, true)),
        ("undefined", surface("sqrt(x) + y^2 - 0.5", 1.0, true)),
        ("open cone", surface("x^2 + y^2 - z^2", 1.0, false)),
        ("powers", surface("abs(x)^2.5 + abs(y)^0.7 + exp(z) - 1.5", 1.0, true)),
    ] {
        let parts = &*surface.0;
        let [low, high] = parts.cells.corners();
        let mut crossings = 0;
        for i in 0..400 {
            let stream = Stream::new(7, [i, 0], 0);
            let point = |k: u32| {
                DVec3::from_array([k, k + 1, k + 2].map(|k| f64::from(stream.uniform(k)) * 2.0 - 1.0))
            };
            let (o, to) = (3.0 * point(0), point(3));
            let line = Ray64 { o, d: to - o };
            let Some([(enters, _), (leaves, _)]) = parts.faces(&line) else { continue };
            let found = roots_of(&surface, line.o, line.d);
            crossings += found.len();
            if surface.is_closed() {
                assert!(found.len().is_multiple_of(2), "{name}: {found:?}");
            }
            // Odd, so that no step ends where a function jumps in the middle of the box.
            const STEPS: u32 = 2999;
            // From a little before the box to a little behind it, or within it where its faces are none of the surface.
            let margin = if surface.is_closed() { 1e-7 } else { -1e-7 };
            let (start, step) = (enters - margin, (leaves - enters + 2.0 * margin) / f64::from(STEPS));
            let is_in = |t: f64| {
                let p = line.at(t);
                p.cmpge(low).all() && p.cmple(high).all() && surface.value(p) < 0.0
            };
            for k in 0..STEPS {
                let [a, b] = [k, k + 1].map(|k| start + f64::from(k) * step);
                let between = found.iter().filter(|&&t| a <= t && t < b).count();
                assert_eq!(is_in(a) != is_in(b), between % 2 == 1, "{name}: line {i}, {a} to {b}: {found:?}");
            }
        }
        assert!(crossings > 100, "{name}: only {crossings}");
    }
}

/// Rays near the silhouette of a ball, by less and less: none or two crossings.
#[test]
fn tangent_rays_cross_twice_or_not_at_all() {
    let ball = surface("x^2 + y^2 + z^2 - 0.64", 1.0, true);
    let mut pairs = 0;
    for i in 0..20_000 {
        let angle = 1e-2 * f64::from(i % 600);
        let n = DVec3::new(angle.cos(), angle.sin(), 0.0);
        let off = 1e-9 * f64::from(i / 600 - 16) / 16.0;
        let found = roots_of(&ball, (0.8 + off) * n - 3.0 * DVec3::Z, DVec3::new(0.0, 0.0, 1.0));
        assert!(found.len() == 2 || found.is_empty(), "{found:?} at {off}");
        pairs += found.len() / 2;
    }
    assert!((5_000..15_000).contains(&pairs), "{pairs}");
}

/// The surface knows its box: the faces belong to a closed one, and nothing beyond does.
#[test]
fn faces_of_the_box_close_it() {
    let rod = "x^2 + y^2 - 0.25";
    let through = Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z);
    let closed = surface(rod, 1.0, true);
    let first = closed.hit(&through).unwrap();
    assert_eq!((first.t, first.u), (2.0, 5.0));
    let at = closed.surface_at(&through, &first);
    assert_eq!(at.n, -Vec3::Z);
    assert_eq!(closed.hit_at(0, at.p), Hit { t: 0.0, ..first });
    assert_eq!(closed.hit_at(0, Vec3::new(0.3, 0.4, 0.2)), Hit::default());
    let inside = Ray::new(Vec3::new(0.1, 0.2, 0.5), Vec3::Z);
    let last = closed.hit(&inside).unwrap();
    assert_eq!((last.t, last.u), (0.5, 6.0));
    let open = surface(rod, 1.0, false);
    assert!(open.hit(&through).is_none() && open.hit(&inside).is_none());
    assert!(!open.is_closed() && closed.is_closed());
    assert!(surface("x^2 + 1 + y", 0.9, true).is_empty());
    assert_eq!(surface("x^2 - 3", 1.0, true).bounds(), Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE });
    let constant = TapeBuilder::new().finish(Node::Constant(-1.0));
    let whole = Isosurface::new(Arc::new(constant), Vec3::ZERO, Vec3::ONE, true).unwrap();
    assert_eq!(whole.hit(&Ray::new(Vec3::new(0.5, 0.5, 4.0), -Vec3::Z)).map(|hit| hit.t), Some(3.0));
}

/// Functions that would take forever end: one that is zero but for rounding everywhere, and one that oscillates without end.
#[test]
fn hopeless_functions_end() {
    for function in
        ["(x + 1) - x - 1 + 0*y", "sin(1/(x^2 + y^2)) * 1e-3 + x * 0", "sin(1e6*x)*sin(1e6*y) + z"]
    {
        let surface = surface(function, 1.0, true);
        for i in 0..50 {
            let o = Vec3::new(-3.0, 0.02 * i as f32 - 0.5, 0.1);
            let mut count = 0;
            surface.crossings(&Ray::new(o, Vec3::new(1.0, 0.01, 0.02)), |_| count += 1);
            assert!(count % 2 == 0, "{function}: {count}");
        }
    }
}

#[test]
fn normals_are_gradients() {
    let surface = surface("x^2/0.49 + y^2/0.25 + z^2/0.81 - 1", 1.0, true);
    let ray = Ray::new(Vec3::new(0.2, 0.1, 3.0), -Vec3::Z);
    let hit = surface.hit(&ray).unwrap();
    let at = surface.surface_at(&ray, &hit);
    let p = at.p.as_dvec3();
    let n = DVec3::new(p.x / 0.49, p.y / 0.25, p.z / 0.81).normalize();
    assert!((at.n.as_dvec3() - n).length() < 1e-6, "{} for {n}", at.n);
    let mut sine = TapeBuilder::new();
    let x = sine.variable(0);
    let wave = sine.unary(Unary::Sin, x);
    let wave =
        Isosurface::new(Arc::new(sine.finish(wave)), Vec3::splat(-4.0), Vec3::splat(4.0), true).unwrap();
    assert_eq!(wave.gradient(DVec3::new(0.0, 1.0, 2.0)), (0.0, DVec3::X));
}

/// What is in the way of a ray is what it hits, wherever it begins and ends.
#[test]
fn rays_are_blocked_by_what_they_hit() {
    let mut blocked = 0;
    for function in [
        "sin(5*x)*cos(4*y) + sin(5*y)*cos(4*z)",
        "x^2 + y^2 - 0.25",
        "abs(x) + abs(y) + abs(z) - 0.7",
        "sqrt(x) - y",
    ] {
        for closed in [false, true] {
            let surface = surface(function, 1.0, closed);
            for i in 0..4000 {
                let s = Stream::new(103, [i, 0], 0);
                let point = |k: u32| Vec3::from_array([k, k + 1, k + 2].map(|k| 4.0 * s.uniform(k) - 2.0));
                let (o, to) = (point(0), point(3));
                let ray = Ray::new(o, to - o).over(0.0, 2.0 * s.uniform(6));
                let is_hit = surface.hit(&ray).is_some();
                blocked += usize::from(is_hit);
                assert_eq!(surface.blocks(&ray), is_hit, "{function}: ray {i}");
            }
        }
    }
    assert!(blocked > 2000);
}
