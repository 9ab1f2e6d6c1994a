//! The weights of the sums that grow with the paths are those of the definition, term by term.

use crate::trail::Counting;
use kajo_core::bsdf::Transport;
use kajo_core::light::LightChoice;
use kajo_math::Vec3;

use super::*;
use crate::integrator::bidir::partial_mis::{Growth, mis_weight};

/// A point of a whole path, light first.
struct PathPoint<'s> {
    p: Vec3,
    /// Zero where there is no surface.
    n: Vec3,
    vertex: Option<Vertex<'s>>,
}

/// A path in the order from the light to the lens, and how it starts.
struct Whole<'s> {
    places: Vec<PathPoint<'s>>,
    /// Density of the light's end, of the way on, and of the light's end as it is drawn for the second point.
    light: [f64; 3],
    /// Density of the last but one point, of the camera's own rays.
    camera: f64,
    /// Vertices of paths from lights for one of the camera's, times the area in which they are merged; 0 where none are.
    merged: f64,
}

/// How a path was found.
#[derive(Clone, Copy, Debug)]
enum Sampled {
    /// So many points come from the light.
    Connected(usize),
    /// This point comes from both ends.
    Merged(usize),
}

impl Whole<'_> {
    /// Density per area of drawing position `to` from `by`, where the path comes from `from`.
    fn density(&self, from: usize, by: usize, to: usize) -> f64 {
        let (a, b, c) = (&self.places[from], &self.places[by], &self.places[to]);
        let (back, on) = ((a.p - b.p).normalize(), (c.p - b.p).normalize());
        let pdf = b.vertex.as_ref().map_or(0.0, |vertex| vertex.pdf(back, on));
        f64::from(pdf * c.n.dot(on).abs() / b.p.distance_squared(c.p))
    }

    /// The densities of all connections but `t = 0`, which is none, with that of splats as it is in weights, and of merging at each point.
    fn densities(&self) -> [Vec<f64>; 2] {
        let n = self.places.len();
        let from_light = |i: usize| match i {
            0 => self.light[0],
            1 => {
                let (a, b) = (&self.places[0], &self.places[1]);
                let on = (b.p - a.p).normalize();
                self.light[1] * f64::from(b.n.dot(on).abs() / a.p.distance_squared(b.p))
            }
            _ => self.density(i - 2, i - 1, i),
        };
        let from_camera = |i: usize| match n - 1 - i {
            0 => 1.0,
            1 => self.camera,
            _ => self.density(i + 2, i + 1, i),
        };
        let way = |s: usize| {
            let light: f64 = if s == 1 { self.light[2] } else { (0..s).map(from_light).product() };
            let density = light * (s..n).map(from_camera).product::<f64>();
            if s + 1 == n { 0.2 * density } else { density }
        };
        let merged = |i: usize| {
            let is_inner = (1..n - 1).contains(&i);
            let both = (0..=i).map(from_light).product::<f64>() * (i..n).map(from_camera).product::<f64>();
            if is_inner { self.merged * both } else { 0.0 }
        };
        [(0..n).map(way).collect(), (0..n).map(merged).collect()]
    }
}

/// Draws paths from both ends, and hands all whole ones to `look` with the way in which they were found and the weight.
///
/// * `radius`: in which vertices are merged, if they are
fn each_path(text: &str, radius: Option<f32>, look: &mut dyn FnMut(&Whole, Sampled, f32)) {
    let scene = scene(text);
    let it = Bidirectional::new(&scene, both(), [1, 1], LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let wavelengths = Wavelengths::RGB;
    let mut rays = Counting::default();
    let merging = radius.map(|radius| {
        let pass = MergePass { k: 0, paths: 1000, radius, ball_radius: radius, moments: 1, wavelengths };
        it.merging(pass, &setup(0)).expect("vertices").0
    });
    let merging = merging.as_ref();
    for k in 0..300 {
        let mut ctx = SampleContext::new(&sampler, 5);
        let place = ctx.begin([k, 0], 0);
        let mut draws = ctx.draws;
        let (mut again, mut path) = (draws.split(0, 0, 1), Vec::new());
        let began =
            Carried { wavelengths: &wavelengths, time: 0.0, hero: 0, techniques: AllTechniques(merging) };
        it.follow_light(&mut rays, &mut path, again, began);
        again.skip(1);
        let [position, direction] = [again.next_2d(), again.next_2d()];
        let chosen = it.power_sampler.sample(position.x).expect("a light");
        let numbers = LeNumbers { position: chosen.pair(position), direction };
        let world = it.power_sampler.world();
        let emitted =
            scene.sample_le(chosen.light, 0.0, numbers, &wavelengths, world).expect("light that leaves");
        let ray = it.view.ray(place, &mut draws).expect("a ray");
        let mut views: Vec<(Vertex, Vec3)> = Vec::new();
        let last = subpath::LastVertex {
            p: ray.o,
            pdf: 1.0,
            is_parallel: true,
            cosine: 1.0,
            eta: 1.0,
            pdf_back: 0.0,
            mis: PartialMis::default(),
            merged: 0.0,
        };
        let state = PathState::new(
            ray,
            wavelengths,
            Spectrum::WHITE,
            Transport::Radiance,
            MediumStack::default(),
            draws,
        );
        let mut path_from_camera = Subpath { state: PathState { connectable: true, ..state }, last };
        let (mut surface, mut first, mut counting) =
            (SurfaceInteraction::default(), None, Counting::default());
        let mut pdf_camera = 0.0;
        while let Event::Surface =
            advance(&scene, &mut path_from_camera.state, &mut surface, &mut first, &mut counting)
        {
            if views.len() == 4 {
                break;
            }
            if views.is_empty() {
                pdf_camera = it.view.pdf_across(&ray, surface.at.point.p).expect("a camera");
                path_from_camera.last.pdf = weighted_pdf_across(pdf_camera);
            }
            let bsdf = shade(&scene, &path_from_camera.state, &surface);
            let mut z = path_from_camera.vertex(&scene, &surface, bsdf, LightGroup::default());
            if let Some(merging) = merging {
                merging.weigh(&scene, &surface, &mut z);
            }
            views.push((z, z.at.p));
            if !path_from_camera.scatter(&z, &surface, false, &mut counting) {
                break;
            }
        }
        let mut whole = |from_light: &[Vertex], from_camera: &[Vertex], way: Sampled, weight: f32| {
            let mut places = vec![PathPoint { p: emitted.at.p(), n: emitted.at.n(), vertex: None }];
            let chain = from_light.iter().chain(from_camera.iter().rev());
            places.extend(chain.map(|v| PathPoint { p: v.at.p, n: v.at.ng, vertex: Some(*v) }));
            places.push(PathPoint { p: ray.o, n: Vec3::ZERO, vertex: None });
            let first = &places[1];
            let wi = (emitted.at.p() - first.p).normalize();
            let receiver = first.vertex.as_ref().expect("a surface").receiver(0.0);
            let drawn = scene.pdf_li(chosen.light, &receiver, &emitted.at, wi, LightChoice::Tree);
            let distance2 = emitted.at.p().distance_squared(first.p);
            let spread = emitted.at.jacobian_to_end_measure(wi, distance2);
            let last = &places[places.len() - 2];
            let camera = pdf_camera_at(&it, &ray, last);
            let pdf = scene.pdf_le(chosen.light, 0.0, &emitted.at, -wi, world);
            let (end, rest) = (f64::from(chosen.probability * pdf.position), f64::from(pdf.direction));
            let merged = merging.map_or(0.0, Merging::density);
            let light = [end, rest, f64::from(drawn * spread)];
            look(&Whole { places, light, camera, merged }, way, weight);
        };
        let views: Vec<Vertex> = views.into_iter().map(|view| view.0).collect();
        for i in 1..=path.len() {
            let y = &path[i - 1];
            for j in 1..=views.len() {
                let technique = VertexCounts { s: i as u32 + 1, t: j as u32 + 1 };
                if let Some(found) = it.join(y, &views[j - 1], technique, began, &mut again, &mut rays) {
                    whole(&path[..i], &views[..j], Sampled::Connected(i + 1), found.weight);
                    if let Some(merging) = merging {
                        let merged = merging.mis_weight_of(y, &drawn_from(&views[j - 1], y, merging));
                        whole(&path[..i], &views[..j], Sampled::Merged(i), merged);
                    }
                }
            }
            if let Some(found) =
                it.splat(y, VertexCounts { s: i as u32 + 1, t: 1 }, began, &mut again, &mut rays)
            {
                whole(&path[..i], &[], Sampled::Connected(i + 1), found.weight);
            }
        }
        assert!(pdf_camera > 0.0);
    }
}

/// The vertex `y` as the camera's path has it that comes from `z`.
fn drawn_from<'s>(z: &Vertex<'s>, y: &Vertex<'s>, merging: &Merging) -> Vertex<'s> {
    let (wi, distance2) = ((y.at.p - z.at.p).normalize(), y.at.p.distance_squared(z.at.p));
    let growth = Growth {
        pdf: z.pdf(z.wo, wi) * y.cosine(wi) / distance2,
        g: z.cosine(wi) / distance2,
        pdf_back: z.pdf(wi, z.wo),
        connectable: true,
    };
    let mut mis = z.mis.grown(growth);
    mis.d_vcm += merging.density().powi(2);
    Vertex { wo: -wi, mis, ..*y }
}

/// The density per area at the last point of a surface of the camera's own rays.
fn pdf_camera_at(it: &Bidirectional<'_>, ray: &Ray, last: &PathPoint) -> f64 {
    let d = (last.p - ray.o).normalize();
    let seen = Ray { d, ..*ray };
    it.view.pdf_across(&seen, last.p).map_or(0.0, |pdf| f64::from(pdf * last.n.dot(d).abs()))
}

const VIEW: &str = "PerspectiveCamera { center 0 0 0.95  direction 0 -0.2 -1  up 0 1 0  angle 70 }";

/// A room with two matt lights and things that scatter in all kinds of ways, but none into single directions.
const ROOM: &str = "Background { color 0 0 0 }
    Materials { Matte white { color 0.7 0.7 0.7 }  Metal gold { metal gold roughness 0.5 }
        Glass frosted { roughness 0.6 }  Principled paint { color 0.2 0.5 0.3  coat 0.7  roughness 0.5 }
        Material emitter { diffuseColor 0.2 0.2 0.2  emission 2 2 2 } }
    Group { MaterialIndex white  Box { min -1 -1 -1  max 1 1 1 }
        MaterialIndex emitter Quad { corner -0.6 0.95 -0.6  edge1 1.2 0 0  edge2 0 0 1.2 }
        MaterialIndex emitter Sphere { center 0.5 0.3 -0.5  radius 0.2 }
        MaterialIndex gold Sphere { center -0.5 -0.5 -0.3  radius 0.4 }
        MaterialIndex frosted Sphere { center 0.4 -0.6 -0.2  radius 0.35 }
        MaterialIndex paint Sphere { center -0.5 0.5 -0.6  radius 0.3 } }";

#[test]
fn weights_are_those_of_the_definition() {
    let point = "Lights { PointLight { position 0.3 0.6 0.2  intensity 1 1 1 } }";
    for (light, radius) in [("", None), (point, None), ("", Some(0.1)), (point, Some(0.02))] {
        let (mut counts, mut merged) = ([0; 8], [0; 8]);
        each_path(&format!("{VIEW} {ROOM} {light}"), radius, &mut |whole, way, weight| {
            let is_point = whole.places[0].n == Vec3::ZERO;
            let mut densities = whole.densities();
            if is_point {
                densities[0][0] = 0.0;
            }
            let sum: f64 = densities.iter().flatten().map(|p| p * p).sum();
            let (own, counts) = match way {
                Sampled::Connected(s) => (densities[0][s], &mut counts),
                Sampled::Merged(i) => (densities[1][i], &mut merged),
            };
            let expected = own * own / sum;
            assert!(
                (f64::from(weight) - expected).abs() < 2e-3,
                "{way:?}: {weight} {expected} {densities:?}"
            );
            counts[whole.places.len().min(7)] += 1;
        });
        assert!(counts[3..].iter().all(|&n| n > 20), "{counts:?}");
        assert!(radius.is_none() || merged[4..].iter().all(|&n| n > 20), "{merged:?}");
    }
}

#[test]
fn a_way_without_rivals_counts_in_full() {
    assert_eq!(mis_weight(0.0, 0.0), 1.0);
    assert_eq!(mis_weight(1.0, 2.0), 0.25);
    assert_eq!(mis_weight(f64::INFINITY, 0.0), 0.0);
    assert_eq!(mis_weight(f64::NAN, 0.0), 0.0);
}
