//! Paths from the camera, and what they take from the maps.
//!
//! At a vertex `x` of such a path, with the throughput `beta`, the light of the map is a density estimate: a sum over the `N` photons that lie
//! within `r` of `x` in the tangent plane. Photons are distributed by area with the density `N / (pi r^2)`, and each carries the power `Φ_j` that came from `wi_j`,
//!
//! ```text
//! L = beta / (pi r^2)  sum over |x_j - x| < r  of  f(wo, wi_j) Φ_j                              [Jensen 2001, eq. 7.6]
//! L = beta (k - 1) / (k pi r_k^2)  sum over the k nearest  of  f(wo, wi_j) Φ_j
//! ```
//!
//! The second one is unbiased where the density is the same all around [Loftsgaarden and Quesenberry 1965]; the first one is what progressive photon mapping
//! sums, with the radius of its pass. The measure is area on the true surface, so `f |cos|` is divided by the cosine of the geometric normal.
//!
//! Light that is drawn for the vertex, and light that the path hits, are the two estimates of path tracing, per solid angle, with the power heuristic;
//! light of one kind is taken either from a map or from these.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightGroup;
use kajo_core::bsdf::Bsdf;
use kajo_core::light::{LightHit, LightLiSample, LightPoint, Receiver};
use kajo_core::scene::{Interaction, Scene};
use kajo_core::settings::PhotonMapUse;
use kajo_math::Vec3;

use super::{Maps, NEIGHBOURS, Photons};
use crate::integrator::bidir::{NoMedia, Subpath, Vertex, shade_one_way};
use crate::integrator::camera_view::RayFootprint;
use crate::integrator::path::power_heuristic;
use crate::integrator::photon_map::{GatherPoint, NearestScratch, Photon, PhotonMap};
use crate::integrator::transport::{
    DrawnLight, Event, PathState, SurfaceInteraction, advance, connect, pass_straight, sample_light,
};
use crate::trail::{About, PathObserver, RayKind};

/// Follows the path of one sample.
pub struct Gatherer<'a, O> {
    photons: &'a Photons<'a>,
    observer: &'a mut O,
    footprint: RayFootprint,
    /// Light as the sensor sees it, linear RGB.
    pub radiance: [f32; 3],
    /// The first surface.
    pub first: Option<Interaction>,
    /// The albedo of the first surface that is no mirror.
    pub albedo: Option<Spectrum>,
    /// Scratch memory of searches.
    pub scratch: NearestScratch,
}

/// The last vertex that is not specular.
#[derive(Clone, Copy)]
struct From {
    receiver: Receiver,
    /// Density per solid angle of that direction.
    pdf: f32,
    /// Whether its caustics were taken from a map.
    has_caustics: bool,
}

/// From what the light of a vertex is estimated.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    /// All of it from the map; the path goes on by specular lobes only.
    FromMap,
    /// Direct light by next-event estimation, the rest from the map; the path goes on by specular lobes only.
    DirectAndMap,
    /// Direct light by next-event estimation, caustics from the map, the rest by the path (final gathering).
    DirectAndCaustics,
    /// Direct light by next-event estimation, the rest by the path.
    Direct,
}

impl<'a, O: PathObserver> Gatherer<'a, O> {
    pub fn new(
        photons: &'a Photons<'a>,
        observer: &'a mut O,
        footprint: RayFootprint,
        scratch: NearestScratch,
    ) -> Self {
        let (radiance, first, albedo) = ([0.0; 3], None, None);
        Gatherer { photons, observer, footprint, radiance, first, albedo, scratch }
    }

    fn scene(&self) -> &'a Scene {
        self.photons.view.scene
    }

    /// Follows a path to its end.
    pub fn run(&mut self, mut path: Subpath<'_>) {
        let (scene, bounces) = (self.scene(), self.photons.settings.bounces);
        let mut surface = SurfaceInteraction::default();
        let mut from: Option<From> = None;
        let mut length = 0.0;
        loop {
            match advance(scene, &mut path.state, &mut surface, &mut self.first, self.observer) {
                Event::Surface => {}
                Event::Escaped(d) => return self.add_background(&path.state, d, from.as_ref()),
                Event::Medium(_) | Event::Absorbed => return,
            }
            length += surface.length;
            self.add_emission(&path.state, &surface, from.as_ref());
            let is_last = path.state.scatterings > bounces;
            if is_last && !scene.appearance.has_passages {
                return;
            }
            let mut bsdf = shade_one_way(scene, &mut path.state, &surface);
            if pass_straight(scene, &mut path.state, &surface, &mut bsdf) {
                if path.state.scatterings == 0 && matches!(bsdf, Bsdf::Null) {
                    self.first = None;
                }
                continue;
            }
            if is_last {
                return;
            }
            let z = path.vertex::<NoMedia>(scene, &surface, bsdf, LightGroup::default());
            if !self.scatter(&mut path, &z, &surface, length, &mut from) {
                return;
            }
        }
    }

    /// Adds the light of a vertex and goes on from it; `false` when the path ends there.
    fn scatter(
        &mut self,
        path: &mut Subpath<'_>,
        z: &Vertex<'_>,
        surface: &SurfaceInteraction,
        length: f32,
        from: &mut Option<From>,
    ) -> bool {
        let roulette = self.photons.settings.roulette;
        if z.bsdf.is_delta() {
            return path.scatter(z, surface, roulette, self.observer);
        }
        if self.albedo.is_none() && self.photons.view.wants_albedo() {
            self.albedo = Some(z.bsdf.albedo(z.local(z.wo).wo));
        }
        let role = self.role(z, surface.length, from.as_ref());
        let goes_on = matches!(role, Role::DirectAndCaustics | Role::Direct);
        if role != Role::FromMap {
            self.add_direct_light(&mut path.state, z, goes_on);
        }
        let photons = self.photons;
        match (&photons.maps, role) {
            (_, Role::Direct) => {}
            (Maps::Progressive { indirect, radius }, _) => {
                self.add_disk(&path.state, z, indirect, radius.at(self.footprint.at(length)));
            }
            (Maps::Fixed { caustics, .. }, Role::DirectAndCaustics) => {
                self.add_nearest(&path.state, z, caustics)
            }
            (Maps::Fixed { all, .. }, _) => self.add_nearest(&path.state, z, all),
        }
        let receiver = z.receiver(path.state.ray.time);
        if !path.scatter(z, surface, roulette, self.observer) {
            return false;
        }
        let is_mirrored = !path.state.connectable;
        if !is_mirrored {
            let has_caustics = role == Role::DirectAndCaustics;
            *from = Some(From { receiver, pdf: path.last.pdf, has_caustics });
        }
        goes_on || is_mirrored
    }

    /// What becomes of light at a vertex that is no mirror.
    ///
    /// * `length`: of the last segment
    fn role(&self, z: &Vertex<'_>, length: f32, from: Option<&From>) -> Role {
        match &self.photons.maps {
            Maps::Fixed { usage: PhotonMapUse::Direct, .. } => Role::FromMap,
            _ if !z.bsdf.is_broad() => Role::Direct,
            Maps::Progressive { .. } => Role::DirectAndMap,
            // Nearby surfaces are seen too sharply for the disks of a map; there one more ray is cast.
            Maps::Fixed { usage: PhotonMapUse::Gather, all, .. }
                if from.is_some_and(|from| from.has_caustics) && length > all.largest_radius() =>
            {
                Role::FromMap
            }
            Maps::Fixed { .. } => Role::DirectAndCaustics,
        }
    }

    /// Adds light under the present wavelengths of a path.
    fn add(&mut self, light: Spectrum, wavelengths: &Wavelengths) {
        let rgb = sensor::to_rgb(light, wavelengths);
        self.radiance = [0, 1, 2].map(|i| self.radiance[i] + rgb[i]);
    }

    /// The photons of a disk of radius `r`: `beta / (pi r^2) sum f Φ` [Jensen 2001, eq. 7.6].
    fn add_disk(&mut self, state: &PathState<'_>, z: &Vertex<'_>, map: &PhotonMap, r: f32) {
        let mut sums = Sums::new(self.most_scatterings(state));
        map.within(&gather_point(z), r, |photon| sums.add(z, photon));
        // [Jensen 2001, eq. 7.6]
        self.add_sums(state, sums, (std::f32::consts::PI * r * r).recip());
    }

    /// The `k` nearest photons: `beta (k - 1) / (k pi r_k^2) sum f Φ`.
    fn add_nearest(&mut self, state: &PathState<'_>, z: &Vertex<'_>, map: &PhotonMap) {
        if map.is_empty() {
            return;
        }
        let mut sums = Sums::new(self.most_scatterings(state));
        let density =
            map.nearest(&gather_point(z), NEIGHBOURS, &mut self.scratch, |photon| sums.add(z, photon));
        self.add_sums(state, sums, density);
    }

    fn add_sums(&mut self, state: &PathState<'_>, sums: Sums, density: f32) {
        let mut single = state.wavelengths;
        single.terminate_secondary();
        let lights = [sums.all * state.beta * density, sums.single * state.beta * density];
        self.observer.found(|| {
            let rgb = [sensor::to_rgb(lights[0], &state.wavelengths), sensor::to_rgb(lights[1], &single)];
            [0, 1, 2].map(|i| rgb[0][i] + rgb[1][i])
        });
        self.add(lights[0], &state.wavelengths);
        self.add(lights[1], &single);
    }

    /// How often a photon may have been scattered before it comes to the present vertex.
    fn most_scatterings(&self, state: &PathState<'_>) -> u32 {
        self.photons.settings.bounces.saturating_sub(state.scatterings)
    }

    /// The MIS weight of light that the path hit: `p^2 / (p^2 + q^2)` of the density `p` per solid angle with which it went there and the
    /// density `q` of drawing the light at the vertex before [Veach 1997, eq. 9.15]; 0 for a caustic that was taken from a map.
    ///
    /// * `at`: the point of the light
    /// * `d`: unit direction in which the path came to it
    fn weight(
        &self,
        state: &PathState<'_>,
        hit: &LightHit,
        at: &LightPoint,
        d: Vec3,
        from: Option<&From>,
    ) -> f32 {
        match from {
            None => 1.0,
            Some(from) if state.connectable => {
                let choice = self.photons.settings.light_choice;
                power_heuristic(from.pdf, self.scene().pdf_li(hit.light, &from.receiver, at, d, choice))
            }
            // By way of mirrors: a caustic.
            Some(from) => f32::from(u8::from(!from.has_caustics)),
        }
    }

    fn add_background(&mut self, state: &PathState<'_>, d: Vec3, from: Option<&From>) {
        let through = from.map_or(state.ray.o, |from| from.receiver.p);
        for hit in self.scene().lights_at_infinity(d, &state.wavelengths) {
            let weight = self.weight(state, &hit, &LightPoint::Infinite { through }, d, from);
            self.add_hit(state, hit.radiance * weight);
        }
    }

    fn add_emission(&mut self, state: &PathState<'_>, surface: &SurfaceInteraction, from: Option<&From>) {
        let d = -surface.wo;
        if let Some(hit) = self.scene().surface_light(&surface.at, d, &state.wavelengths) {
            let weight = self.weight(state, &hit, &LightPoint::on(&surface.at.point), d, from);
            self.add_hit(state, hit.radiance * weight);
        }
    }

    fn add_hit(&mut self, state: &PathState<'_>, radiance: Spectrum) {
        let light = state.beta * radiance;
        self.observer.found(|| sensor::to_rgb(light, &state.wavelengths));
        self.add(light, &state.wavelengths);
    }

    /// Next-event estimation at a vertex: the integral over directions of `f |cos| Li`, by one direction drawn with the density `q` per solid
    /// angle, is `f |cos| T V Le w / q` with the weight `w = q^2 / (p^2 + q^2)` [Veach 1997, eq. 9.15].
    ///
    /// * `may_meet`: whether the path goes on and may meet the light, so that both count by the power heuristic
    fn add_direct_light(&mut self, state: &mut PathState<'_>, z: &Vertex<'_>, may_meet: bool) {
        let scene = self.scene();
        let time = state.ray.time;
        let choice = self.photons.settings.light_choice;
        let Some(drawn) = sample_light(scene, state, &z.receiver(time), choice) else { return };
        let DrawnLight { light, pdf, li: LightLiSample { wi, radiance, is_delta, at, .. } } = drawn;
        let scattered = z.gathered(wi);
        if scattered.is_black() {
            return;
        }
        let segment = z.at.ray_to(&at, wi, time);
        let carried = state.beta * scattered;
        let visible = connect(scene, &segment, z.eta(wi), &state.wavelengths, self.observer);
        let distance = if at.is_infinite() { f32::INFINITY } else { at.p().distance(z.at.p) };
        let weight = if may_meet && !is_delta { power_heuristic(pdf, z.pdf(z.wo, wi)) } else { 1.0 };
        let found = carried * radiance * z.transmittance(wi, distance) * visible * (weight / pdf);
        let about = || About {
            eta: z.eta(wi).unwrap_or(1.0),
            weight: sensor::to_rgb(carried, &state.wavelengths),
            light: Some(scene.lighting.sampler.id(light)),
        };
        let rgb = || sensor::to_rgb(found, &state.wavelengths);
        self.observer.joined(RayKind::Shadow, scene, &segment, about, rgb);
        if !visible.is_black() {
            self.add(found, &state.wavelengths);
        }
    }
}

fn gather_point(z: &Vertex<'_>) -> GatherPoint {
    GatherPoint { p: z.at.p, n: z.at.ng }
}

/// Power of photons, scattered to the camera.
struct Sums {
    all: Spectrum,
    /// Of those of which only one wavelength counts.
    single: Spectrum,
    most_scatterings: u32,
}

impl Sums {
    fn new(most_scatterings: u32) -> Sums {
        Sums { all: Spectrum::BLACK, single: Spectrum::BLACK, most_scatterings }
    }

    /// `f Φ`, with the factor for shading normals of light that comes from a light [Veach 1997, 5.3.2].
    fn add(&mut self, z: &Vertex<'_>, photon: &Photon) {
        if !photon.is_within(self.most_scatterings) {
            return;
        }
        let wi = photon.wi();
        let cosine = z.cosine(wi);
        if cosine <= 0.0 {
            return;
        }
        let light = z.gathered(wi) * photon.power() * cosine.recip();
        *(if photon.secondary_terminated() { &mut self.single } else { &mut self.all }) += light;
    }
}
