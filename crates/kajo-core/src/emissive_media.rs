//! The bodies of media of a scene that emit, and what each part of them does.

use std::cmp::Reverse;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Aabb, Ray, Vec3};

use crate::ids::ObjectId;
use crate::medium::{EmissiveVolume, EmissiveVolumes, MediumId};
use crate::scene::{Primitive, Scene};
use crate::space::Space;

/// Points along each side of a cell at which it is asked what it emits.
const POINTS: u32 = 2;

/// Bodies that directions are drawn to; the faintest of more are found by scattering alone.
const MOST_VOLUMES: usize = 64;

/// How often what emits is looked for within a smaller box.
const MOST_CLOSER_LOOKS: u32 = 2;

impl Scene {
    /// Bodies of media that emit, towards which directions are drawn: those that have an end, within surfaces that light passes
    /// straight, and where light does not bend.
    #[inline]
    pub fn emissive_volumes(&self) -> &EmissiveVolumes {
        self.lighting.volumes.get_or_init(|| volumes_of(self))
    }
}

fn volumes_of(scene: &Scene) -> EmissiveVolumes {
    if !scene.appearance.has_emissive_media() || scene.space() == Space::Curved || scene.relativity.is_some()
    {
        return EmissiveVolumes::default();
    }
    let primitives = ObjectId::all(scene.geometry.primitives.len()).zip(&scene.geometry.primitives);
    let of = |(object, primitive): (_, &Primitive)| EmissiveBody::of(scene, object, primitive);
    let mut bodies: Vec<EmissiveBody<'_>> = primitives.filter_map(of).collect();
    if bodies.len() > MOST_VOLUMES {
        // From 0 on, numbers have the order of their bits.
        bodies.sort_by_cached_key(|body| Reverse(body.rough_power().to_bits()));
        bodies.truncate(MOST_VOLUMES);
    }
    EmissiveVolumes::new(bodies.iter().filter_map(EmissiveBody::volume).collect())
}

/// An object with a medium that emits.
struct EmissiveBody<'a> {
    scene: &'a Scene,
    object: ObjectId,
    medium: MediumId,
    /// World space; not flat.
    bounds: Aabb,
}

impl<'a> EmissiveBody<'a> {
    /// What an object holds.
    fn of(scene: &'a Scene, object: ObjectId, primitive: &Primitive) -> Option<EmissiveBody<'a>> {
        let media = &scene.appearance.media;
        let medium = scene.appearance.materials.medium(primitive.material)?;
        if !media.coefficients(medium).emits() || !scene.appearance.has_passages(primitive.material) {
            return None;
        }
        let own = scene.geometry.world_bounds(primitive);
        let bounds = media.bounds(medium).map_or(own, |bounds| bounds.intersection(own));
        let usable = !bounds.is_empty() && bounds.is_finite() && bounds.extent().min_element() > 0.0;
        usable.then_some(EmissiveBody { scene, object, medium, bounds })
    }

    /// What all of its box would give, by few points, up to a factor; not negative.
    fn rough_power(&self) -> f32 {
        const SIDE: u32 = 4;
        let step = self.bounds.extent() / SIDE as f32;
        let place =
            |i: u32| Vec3::from([i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)].map(|k| k as f32 + 0.5));
        let at = |i: u32| self.emission_at(self.bounds.min + step * place(i), 0.0);
        (0..SIDE.pow(3)).map(at).sum::<f32>() * step.element_product()
    }

    /// What is drawn of it.
    fn volume(&self) -> Option<EmissiveVolume> {
        let table = |bounds: Aabb| {
            let size = EmissiveVolume::cells(&bounds);
            (bounds, size, self.emission_by_cells(&bounds, size))
        };
        let (mut bounds, mut size, mut emission) = table(self.bounds);
        // A small flame in a large box is looked at more closely.
        for _ in 0..MOST_CLOSER_LOOKS {
            let part = emissive_part(&bounds, size, &emission);
            if part.is_empty() || part.extent().element_product() > 0.5 * bounds.extent().element_product() {
                break;
            }
            (bounds, size, emission) = table(part);
        }
        EmissiveVolume::new(bounds, size, &emission)
    }
}

/// The part of a box whose cells emit, and a cell more to all sides.
fn emissive_part(bounds: &Aabb, size: [u32; 3], emission: &[f32]) -> Aabb {
    let [nx, ny, _] = size.map(|n| n as usize);
    let cell = bounds.extent() / Vec3::from(size.map(|n| n as f32));
    let emissive = emission.iter().enumerate().filter(|(_, e)| **e > 0.0);
    let corners = emissive.flat_map(|(i, _)| {
        let place = Vec3::from([i % nx, i / nx % ny, i / (nx * ny)].map(|k| k as f32));
        [place - 1.0, place + 2.0].map(|corner| bounds.min + cell * corner)
    });
    Aabb::around(corners).intersection(*bounds)
}

impl EmissiveBody<'_> {
    /// What is given by each cell of a box around an object, x first: radiance per unit length, the mean of red, green and blue and of
    /// points in the cell, at moments spread over the shutter's interval.
    fn emission_by_cells(&self, bounds: &Aabb, size: [u32; 3]) -> Vec<f32> {
        let [nx, ny, nz] = size;
        let mut cells = vec![0.0; (nx * ny * nz) as usize];
        let step = bounds.extent() / Vec3::from(size.map(|n| (n * POINTS) as f32));
        let lines = (0..nz * POINTS).flat_map(|z| (0..ny * POINTS).map(move |y| [y, z]));
        for (i, [y, z]) in lines.enumerate() {
            let time = (i as f64 * 0.618_033_988_749_894_9).fract() as f32;
            let start = bounds.min + step * Vec3::new(0.0, y as f32 + 0.5, z as f32 + 0.5);
            let ray = Ray { time, ..Ray::new(start, Vec3::X) };
            let inside = Inside::of(self.scene, self.object, &ray);
            for x in 0..nx * POINTS {
                let t = step.x * (x as f32 + 0.5);
                if inside.holds(t) {
                    let cell = ((z / POINTS * ny + y / POINTS) * nx + x / POINTS) as usize;
                    cells[cell] += self.emission_at(ray.at(t), time) / POINTS.pow(3) as f32;
                }
            }
        }
        cells
    }

    /// Radiance per unit length, the mean of red, green and blue; 0 where that is no number.
    fn emission_at(&self, p: Vec3, time: f32) -> f32 {
        let &EmissiveBody { scene, medium, .. } = self;
        let (media, rgb) = (&scene.appearance.media, &Wavelengths::RGB);
        let p = media.velocities(medium).map_or(p, |velocities| velocities.source(p, time));
        let density = scene.appearance.density(medium, p);
        let given = media.coefficients(medium).emission_at(p, rgb);
        let [r, g, b] = given.map_or([0.0; 3], Spectrum::to_rgb);
        let mean = density * (r + g + b) / 3.0;
        if mean.is_finite() { mean.max(0.0) } else { 0.0 }
    }
}

/// Where a ray is inside an object.
struct Inside {
    /// Distances at which it leaves it, 1, or enters it, -1.
    crossings: Vec<(f32, i32)>,
}

impl Inside {
    fn of(scene: &Scene, object: ObjectId, ray: &Ray) -> Inside {
        let mut crossings = Vec::new();
        scene.crossings(ray, |crossed, hit| {
            if crossed == object {
                let leaves = ray.d.dot(scene.interaction(ray, object, hit).point.ng) > 0.0;
                crossings.push((hit.t, if leaves { 1 } else { -1 }));
            }
        });
        Inside { crossings }
    }

    /// Whether it is at a distance: where it leaves the object more often from there on than it enters it.
    fn holds(&self, t: f32) -> bool {
        self.crossings.iter().filter(|(at, _)| *at > t).map(|(_, leaves)| leaves).sum::<i32>() > 0
    }
}
