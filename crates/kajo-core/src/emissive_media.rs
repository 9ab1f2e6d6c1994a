//! The bodies of media of a scene that emit, and what each part of them does.

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Aabb, Ray, Vec3};

use crate::ids::ObjectId;
use crate::medium::{EmissiveVolume, EmissiveVolumes, MediumId};
use crate::scene::{Primitive, Scene};
use crate::space::Space;

/// Points along each side of a cell at which it is asked what it emits.
const POINTS: u32 = 2;

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
    let volume = |(object, primitive): (_, &Primitive)| volume_of(scene, object, primitive);
    EmissiveVolumes::brightest(primitives.filter_map(volume).collect())
}

/// What an object holds.
fn volume_of(scene: &Scene, object: ObjectId, primitive: &Primitive) -> Option<EmissiveVolume> {
    let media = &scene.appearance.media;
    let medium = scene.appearance.materials.medium(primitive.material)?;
    if !media.coefficients(medium).emits() || !scene.appearance.has_passages(primitive.material) {
        return None;
    }
    let own = scene.geometry.world_bounds(primitive);
    let bounds = media.bounds(medium).map_or(own, |bounds| bounds.intersection(own));
    if bounds.is_empty() || !bounds.is_finite() || bounds.extent().min_element() <= 0.0 {
        return None;
    }
    let table = |bounds: Aabb| {
        let size = EmissiveVolume::cells(&bounds);
        (bounds, size, emission_by_cells(scene, object, medium, &bounds, size))
    };
    let (mut bounds, mut size, mut emission) = table(bounds);
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

/// What is given by each cell of a box around an object, x first: radiance per unit length, the mean of red, green and blue and of
/// points in the cell, at moments spread over the shutter's interval.
fn emission_by_cells(
    scene: &Scene,
    object: ObjectId,
    medium: MediumId,
    bounds: &Aabb,
    size: [u32; 3],
) -> Vec<f32> {
    let [nx, ny, nz] = size;
    let mut cells = vec![0.0; (nx * ny * nz) as usize];
    let step = bounds.extent() / Vec3::from(size.map(|n| (n * POINTS) as f32));
    let lines = (0..nz * POINTS).flat_map(|z| (0..ny * POINTS).map(move |y| [y, z]));
    for (i, [y, z]) in lines.enumerate() {
        let time = (i as f64 * 0.618_033_988_749_894_9).fract() as f32;
        let start = bounds.min + step * Vec3::new(0.0, y as f32 + 0.5, z as f32 + 0.5);
        let ray = Ray { time, ..Ray::new(start, Vec3::X) };
        let inside = Inside::of(scene, object, &ray);
        for x in 0..nx * POINTS {
            let t = step.x * (x as f32 + 0.5);
            if inside.holds(t) {
                let cell = ((z / POINTS * ny + y / POINTS) * nx + x / POINTS) as usize;
                cells[cell] += emission_at(scene, medium, ray.at(t), time) / POINTS.pow(3) as f32;
            }
        }
    }
    cells
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

/// Radiance per unit length, the mean of red, green and blue; 0 where that is no number.
fn emission_at(scene: &Scene, medium: MediumId, p: Vec3, time: f32) -> f32 {
    let (media, rgb) = (&scene.appearance.media, &Wavelengths::RGB);
    let p = media.velocities(medium).map_or(p, |velocities| velocities.source(p, time));
    let density = scene.appearance.density(medium, p);
    let coefficients = media.coefficients(medium);
    let given = match coefficients.heat() {
        Some(heat) => heat.emission(p, rgb),
        None => coefficients.emission(rgb).unwrap_or(Spectrum::BLACK),
    };
    let [r, g, b] = given.to_rgb();
    let mean = density * (r + g + b) / 3.0;
    if mean.is_finite() { mean.max(0.0) } else { 0.0 }
}
