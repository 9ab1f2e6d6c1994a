use kajo_math::rng::Stream;

use super::*;
use crate::shape::Surface;

/// Spheres and boxes of many sizes within [-1, 1]^3, every third one not opaque.
fn bodies(n: u32, seed: u64) -> Vec<BufferedObject> {
    let body = |primitive: u32| {
        let s = Stream::new(seed, [primitive, 0], 0);
        let center = 2.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.0;
        let sphere = Sphere::new(center, 0.3 * s.uniform(3).powi(3));
        let is_sphere = !primitive.is_multiple_of(4);
        let bounds = sphere.bounds();
        let sphere = is_sphere.then_some(sphere);
        let object = ObjectId::from_index(primitive);
        BufferedObject { object, bounds, sphere, opaque: !primitive.is_multiple_of(3) }
    };
    (0..n).map(body).collect()
}

/// Where a ray meets a body, if it does: a sphere, or a box in place of another shape.
fn hit(body: &BufferedObject, ray: &Ray) -> Option<f32> {
    match body.sphere {
        Some(sphere) => sphere.hit(ray).map(|hit| hit.t),
        None => body.bounds.clip(ray).map(|(near, _)| near),
    }
}

fn points(n: u32, seed: u64, scale: f32) -> impl Iterator<Item = Vec3> {
    (0..n).map(move |i| {
        let s = Stream::new(seed, [i, 1], 0);
        scale * (2.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.0)
    })
}

/// Points outside, inside and within a body, on an axis and far away.
fn apexes(bodies: &[BufferedObject]) -> [Vec3; 5] {
    [
        Vec3::new(3.0, 4.0, -2.0),
        Vec3::new(0.2, -0.1, 0.3),
        bodies[1].bounds.center(),
        Vec3::new(0.0, 5.0, 0.0),
        Vec3::new(-300.0, 200.0, 0.5),
    ]
}

#[test]
fn lists_hold_all_that_a_ray_from_the_apex_can_meet_first() {
    for n in [1, 5, 400] {
        let bodies = bodies(n.max(2), u64::from(n));
        for (apex, cells) in apexes(&bodies).into_iter().zip([0, 0, 9000, 100_000, 9000]) {
            let buffer = ItemBuffer::new(apex, &bodies, cells).unwrap();
            let mut listed = 0;
            for target in points(3000, 7, 1.2) {
                let ray = Ray::new(apex, (target - apex).normalize());
                let Some(items) = buffer.seen_along(&ray) else { continue };
                listed += items.len();
                let nearest = bodies.iter().filter_map(|b| Some((hit(b, &ray)?, b.object)));
                if let Some((t, object)) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)) {
                    let item = items.iter().find(|item| item.object == object);
                    assert!(item.is_some_and(|item| item.near <= t), "{apex} {ray:?} {object:?}");
                }
                assert!(items.is_sorted_by(|a, b| a.near <= b.near));
            }
            assert!(listed < 3000 * 12, "{n} {apex}: {listed}");
        }
    }
}

#[test]
fn rays_to_the_apex_find_what_blocks_them() {
    let bodies = bodies(400, 3);
    for (apex, cells) in apexes(&bodies).into_iter().flat_map(|apex| [(apex, 0), (apex, 100_000)]) {
        let buffer = ItemBuffer::new(apex, &bodies, cells).unwrap();
        let (mut answered, mut blocked, mut known) = (0, 0, 0);
        for p in points(3000, 8, 1.5).chain(points(500, 9, 40.0)) {
            let (wi, distance) = ((apex - p).normalize(), (apex - p).length());
            let ray = Ray::new(p, wi).over(1e-3, distance);
            let Some(between) = buffer.between(&ray) else { continue };
            answered += 1;
            let met: Vec<&BufferedObject> = bodies.iter().filter(|b| hit(b, &ray).is_some()).collect();
            let hidden = met.iter().any(|b| b.opaque && b.sphere.is_some());
            blocked += u32::from(hidden);
            let items = match between {
                Between::Items(items, farthest) => {
                    items.iter().take_while(|item| item.near <= farthest).collect::<Vec<_>>()
                }
                Between::Blocked => {
                    known += 1;
                    assert!(hidden, "{ray:?}");
                    continue;
                }
            };
            let listed = |b: &&BufferedObject| items.iter().any(|item| item.object == b.object);
            if hidden {
                assert!(met.iter().any(|b| b.opaque && listed(b)), "{ray:?}");
            } else {
                assert!(met.iter().all(listed), "{ray:?}");
            }
        }
        assert!(answered > 2000 && blocked > 100, "{apex}: {answered} {blocked}");
        let many = if cells == 0 { 0 } else { blocked / 4 };
        assert!(known >= many, "{apex}: {known} of {blocked}");
    }
}

#[test]
fn other_rays_are_not_answered() {
    let bodies = bodies(50, 4);
    let apex = Vec3::new(3.0, 4.0, -2.0);
    let buffer = ItemBuffer::new(apex, &bodies, 0).unwrap();
    let to_apex = |p: Vec3| Ray::new(p, (apex - p).normalize()).over(0.0, (apex - p).length());
    let ray = to_apex(Vec3::ZERO);
    assert!(buffer.between(&ray).is_some());
    assert!(buffer.between(&ray.over(0.0, 0.99 * ray.t_max)).is_none());
    assert!(buffer.between(&ray.over(0.0, f32::INFINITY)).is_none());
    assert!(buffer.between(&Ray { d: Vec3::NAN, ..ray }).is_none());
    assert!(buffer.between(&to_apex(Vec3::new(1e4, 0.0, 0.0))).is_none());
    let seen = Ray::new(apex, -ray.d);
    assert!(buffer.seen_along(&seen).is_some());
    assert!(buffer.seen_along(&Ray { d: 2.0 * seen.d, ..seen }).is_none());
    assert!(buffer.seen_along(&Ray { o: apex + 0.1, ..seen }).is_none());
    assert!(buffer.seen_along(&Ray::new(apex, ray.d)).is_some_and(<[Item]>::is_empty));
    assert!(ItemBuffer::new(apex, &[], 0).is_none());
    assert!(ItemBuffer::new(Vec3::new(f32::INFINITY, 0.0, 0.0), &bodies, 0).is_none());
    // Where squares of distances are too small or too large.
    for scale in [1e-20, 1e25] {
        let bounds = Aabb { min: Vec3::splat(-scale), max: Vec3::splat(scale) };
        let body = BufferedObject { bounds, sphere: None, ..bodies[0] };
        assert!(ItemBuffer::new(scale * Vec3::Y, &[body], 0).is_none());
    }
}

/// A thousand bodies in one direction are no list; what is behind a wall is in none.
#[test]
fn crowds_go_to_the_tree_and_hidden_things_nowhere() {
    let apex = Vec3::new(0.0, 0.0, 10.0);
    let sphere = |primitive: u32, z: f32, radius: f32| {
        let sphere = Sphere::new(Vec3::new(0.0, 0.0, z), radius);
        let object = ObjectId::from_index(primitive);
        BufferedObject { object, bounds: sphere.bounds(), sphere: Some(sphere), opaque: true }
    };
    let mut bodies: Vec<BufferedObject> = (0..1000).map(|i| sphere(i, -(i as f32), 0.01)).collect();
    let ahead = Ray::new(apex, Vec3::NEG_Z);
    assert!(ItemBuffer::new(apex, &bodies, 0).unwrap().seen_along(&ahead).is_none());
    bodies.push(sphere(1000, 2.0, 1.0));
    let buffer = ItemBuffer::new(apex, &bodies, 0).unwrap();
    assert_eq!(buffer.seen_along(&ahead).map(|items| items[0].object), Some(ObjectId::from_index(1000)));
    let listed = buffer.seen_along(&ahead).map_or(0, <[Item]>::len);
    assert!(listed < 4, "{listed}");
    assert!(buffer.bytes() < 100_000);
}
