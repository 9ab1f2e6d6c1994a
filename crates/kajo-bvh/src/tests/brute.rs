//! Trees of triangles against the same triangle test without a tree, bit for bit.

use kajo_math::{Ray, Vec3};

use super::meshes::{Mesh, Random};
use crate::group::{Group, Shear};
use crate::simd::{PacketSimd, Portable, Simd};
use crate::triangles::can_be_hit;
use crate::{BuildSettings, Quality, TriangleBvh, TriangleHit};

/// All triangles, each in a group of its own.
pub(super) struct Loop {
    groups: Vec<Group>,
}

impl Loop {
    pub(super) fn over(mesh: &Mesh) -> Loop {
        let kept = (0..mesh.triangles.len()).filter(|&t| can_be_hit(&mesh.corners(t)));
        Loop { groups: kept.map(|t| Group::new(&[t as u32], |t| mesh.corners(t as usize))).collect() }
    }

    fn closest(&self, ray: &Ray) -> Option<TriangleHit> {
        let shear = Shear::new(ray);
        let hits = self.groups.iter().filter_map(|g| g.closest(Portable, &shear, ray.t_max, 0));
        // In ascending order of numbers, so the first of equally near hits stays.
        hits.reduce(|a, b| if b.t < a.t { b } else { a })
    }

    fn any(&self, ray: &Ray) -> bool {
        let shear = Shear::new(ray);
        self.groups.iter().any(|g| g.any(Portable, &shear, ray.t_max))
    }

    fn all(&self, ray: &Ray) -> Vec<[u32; 4]> {
        let (shear, mut hits) = (Shear::new(ray), Vec::new());
        self.groups.iter().for_each(|g| g.all(Portable, &shear, ray.t_max, |hit| hits.push(bits(&hit))));
        hits
    }
}

/// Checks that rays traced by eights hit what they hit alone.
fn check_packets<S: PacketSimd>(simd: S, tree: &TriangleBvh, rays: &[Ray], name: &str) {
    for packet in rays.as_chunks::<8>().0 {
        let together = tree.closest8_on(simd, packet);
        for (ray, hit) in packet.iter().zip(together) {
            let alone = tree.closest_on(simd, ray);
            assert_eq!(
                hit.map(|h| bits(&h)),
                alone.map(|h| bits(&h)),
                "{name}: {ray:?}: {hit:?} or {alone:?}"
            );
        }
    }
}

/// Eight rays at a time that run together, about as far apart as `spread`: each starts where
/// one of `rays` does and has its range.
fn bundles(rays: &[Ray], spread: f32) -> Vec<Ray> {
    let mut random = Random::new(21);
    let mut beside = |ray: &Ray| {
        let size = ray.d.length() * spread;
        Ray { o: ray.o + random.cube() * size * 0.1, d: ray.d + random.cube() * size, ..*ray }
    };
    rays.iter().flat_map(|ray| [(); 8].map(|()| beside(ray))).collect()
}

fn bits(hit: &TriangleHit) -> [u32; 4] {
    // Zero has two signs but one value.
    [hit.triangle, (hit.t + 0.0).to_bits(), (hit.u + 0.0).to_bits(), (hit.v + 0.0).to_bits()]
}

pub(super) fn check_on<S: Simd>(
    simd: S,
    tree: &TriangleBvh,
    truth: &Loop,
    rays: &[Ray],
    name: &str,
) -> usize {
    let mut found = 0;
    for ray in rays {
        let (hit, expected) = (tree.closest_on(simd, ray), truth.closest(ray));
        assert_eq!(
            hit.map(|h| bits(&h)),
            expected.map(|h| bits(&h)),
            "{name}: {ray:?}: {hit:?} or {expected:?}"
        );
        assert_eq!(tree.any_on(simd, ray), truth.any(ray), "{name}: {ray:?}");
        let (mut all, mut expected) = (Vec::new(), truth.all(ray));
        tree.all_on(simd, ray, |hit| all.push(bits(&hit)));
        all.sort_unstable();
        expected.sort_unstable();
        assert_eq!(all, expected, "{name}: {ray:?}");
        found += usize::from(hit.is_some());
    }
    found
}

/// Checks all queries on all instruction sets, and answers how many rays hit something.
fn check(mesh: &Mesh, n_rays: usize, name: &str) -> usize {
    let (truth, rays) = (Loop::over(mesh), mesh.rays(n_rays, 7));
    let mut found = 0;
    for quality in [Quality::Linear, Quality::Fast, Quality::High] {
        let settings = BuildSettings { quality };
        let tree = TriangleBvh::build(&mesh.positions, &mesh.triangles, &settings).unwrap();
        found = check_on(Portable, &tree, &truth, &rays, name);
        let bundles = [0.0, 0.001, 0.1].map(|spread| bundles(&rays[..rays.len() / 8], spread)).concat();
        check_packets(Portable, &tree, &bundles, name);
        check_packets(Portable, &tree, &rays, name);
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = crate::simd::Avx2::detect() {
            avx2.vectorize(|| check_on(avx2, &tree, &truth, &rays, name));
            avx2.vectorize(|| check_packets(avx2, &tree, &bundles, name));
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(avx512) = crate::simd::Avx512::detect() {
            avx512.vectorize(|| check_on(avx512, &tree, &truth, &rays, name));
            avx512.vectorize(|| check_packets(avx512, &tree, &bundles, name));
        }
    }
    found
}

/// A thousand rays; with `KAJO_DEEP` set, fifty times as many.
fn rays() -> usize {
    if std::env::var_os("KAJO_DEEP").is_some() { 50_000 } else { 1_000 }
}

#[test]
fn soups_of_every_density() {
    for (seed, (n, size)) in [(40, 1.0), (500, 0.2), (3000, 0.05), (3000, 1.0)].into_iter().enumerate() {
        let found = check(&Mesh::soup(n, size, seed as u64), rays(), "soup");
        assert!(found > rays() / 8, "rays should hit something, {found} did");
    }
}

#[test]
fn a_handful_of_triangles() {
    for n in 0..=9 {
        check(&Mesh::soup(n, 1.0, 50 + n as u64), rays(), "handful");
    }
}

#[test]
fn shared_edges() {
    assert!(check(&Mesh::grid(24, 0.1, 1), rays(), "hills") > rays() / 4);
    assert!(check(&Mesh::sphere(3), rays(), "sphere") > rays() / 4);
    // Long triangles, of which many are cut.
    let long = Mesh::sphere(4).moved(|p| p + Vec3::ONE * (10.0 * p.element_sum()));
    assert!(check(&long, rays(), "long sphere") > rays() / 4);
}

#[test]
fn flat_and_along_the_axes() {
    assert!(check(&Mesh::grid(24, 0.0, 1), rays(), "plane z = 0") > rays() / 8);
    let tilted = Mesh::grid(24, 0.0, 1).moved(|p| Vec3::new(p.z + 3.0, p.y, p.x));
    check(&tilted, rays(), "plane x = 3");
    let steps = Mesh::grid(24, 1.0, 1).moved(|p| Vec3::new(p.x, p.y, (p.z * 3.0).floor()));
    check(&steps, rays(), "steps");
}

#[test]
fn slivers() {
    check(&Mesh::slivers(1500, 3), rays(), "slivers");
    check(&Mesh::slivers(1500, 4).moved(|p| p * Vec3::new(1.0, 1e-3, 1.0)), rays(), "flat slivers");
}

#[test]
fn scales_from_tiny_to_huge() {
    for scale in [1e-12, 1e-4, 1e6, 1e12, 1e25] {
        check(&Mesh::soup(1000, 0.2, 8).moved(|p| p * scale), rays(), "scaled soup");
    }
    check(&Mesh::soup(1000, 0.2, 8).moved(|p| p + 1e6), rays(), "far soup");
    check(&Mesh::soup(2000, 0.02, 8).moved(|p| p * p.abs().powf(8.0)), rays(), "soup of all sizes");
}

#[test]
fn duplicates_answer_with_the_lowest_number() {
    check(&Mesh::soup(200, 0.5, 5).repeated(7), rays(), "duplicates");
    check(&Mesh::soup(1, 1.0, 6).repeated(100), rays(), "all the same");
    let mesh = Mesh::soup(1, 1.0, 6).repeated(1000);
    let tree = TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap();
    let [a, b, c] = mesh.corners(0);
    let ray = Ray::new(Vec3::splat(4.0), (a + b + c) / 3.0 - Vec3::splat(4.0));
    assert_eq!(tree.closest(&ray).unwrap().triangle, 0);
    let mut seen = [0; 1000];
    tree.all(&ray, |hit| seen[hit.triangle as usize] += 1);
    assert_eq!(seen, [1; 1000]);
}

#[test]
fn hits_lie_where_an_independent_test_finds_them() {
    let (mesh, mut random) = (Mesh::soup(1, 1.0, 11), Random::new(12));
    let tree = TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap();
    let [a, b, c] = mesh.corners(0).map(Vec3::as_dvec3);
    for _ in 0..10_000 {
        let (u, v) = (f64::from(random.unit()) * 1.2 - 0.1, f64::from(random.unit()) * 1.2 - 0.1);
        let o = random.cube() * 5.0;
        let target = (1.0 - u - v) * a + u * b + v * c;
        let ray = Ray::new(o, (target - o.as_dvec3()).as_vec3());
        let edge = [u, v, 1.0 - u - v].into_iter().fold(f64::INFINITY, f64::min);
        match tree.closest(&ray) {
            // A ray almost in the plane of the triangle tells nothing.
            _ if (b - a).cross(c - a).normalize().dot(ray.d.as_dvec3().normalize()).abs() < 0.05 => {}
            Some(hit) => {
                assert!(edge > -1e-4, "{u} {v}");
                let (du, dv) = (f64::from(hit.u) - u, f64::from(hit.v) - v);
                assert!((hit.t - 1.0).abs() < 1e-4 && du.abs() < 1e-4 && dv.abs() < 1e-4, "{hit:?}, {u} {v}");
            }
            None => assert!(edge < 1e-4, "{u} {v}"),
        }
    }
}

#[test]
fn the_range_of_a_ray_excludes_its_ends() {
    let mut mesh = Mesh::default();
    mesh.push([Vec3::new(-1.0, -1.0, 2.0), Vec3::new(3.0, -1.0, 2.0), Vec3::new(-1.0, 3.0, 2.0)]);
    let tree = TriangleBvh::build(&mesh.positions, &mesh.triangles, &BuildSettings::default()).unwrap();
    let ray = Ray::new(Vec3::ZERO, Vec3::new(0.0, 0.0, 0.5));
    let hit = tree.closest(&ray).unwrap();
    assert_eq!(hit, TriangleHit { t: 4.0, u: 0.25, v: 0.25, triangle: 0 });
    for (t_min, t_max, hits) in [(4.0, 9.0, false), (0.0, 4.0, false), (3.9, 4.1, true), (-9.0, 9.0, true)] {
        let ray = ray.over(t_min, t_max);
        let mut all = 0;
        tree.all(&ray, |_| all += 1);
        assert_eq!((tree.closest(&ray).is_some(), tree.any(&ray), all == 1), (hits, hits, hits));
    }
    let behind = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::Z).over(f32::NEG_INFINITY, f32::INFINITY);
    assert_eq!(tree.closest(&behind).map(|h| h.t), Some(-3.0));
}
