//! Paths from the camera, and what they take from the maps.
//!
//! At a vertex `x` of such a path, with the throughput `beta`, the light of the map is a density estimate: a sum over the `N` photons that lie
//! within `r` of `x` in the tangent plane. Photons are distributed by area with the density `N / (pi r^2)`, and each
//! carries the power `Φ_j` that came from `wi_j`,
//!
//! ```text
//! L = beta / (pi r^2)  sum over |x_j - x| < r  of  f(wo, wi_j) Φ_j                              [Jensen 2001, eq. 7.6]
//! L = beta (k - 1) / (k pi r_k^2)  sum over the k nearest  of  f(wo, wi_j) Φ_j
//! ```
//!
//! The second one is unbiased where the density is the same all around [Loftsgaarden and Quesenberry 1965]; the first
//! one is what progressive photon mapping sums, with the radius of its pass. The measure is area on the true surface,
//! so `f |cos|` is divided by the cosine of the geometric normal.
//!
//! In a medium photons are distributed by volume, and the radiance that a phase function scatters is estimated in a
//! ball [Jensen and Christensen 1998, eq. 9],
//!
//! ```text
//! L = beta / (4/3 pi r^3)  sum over |x_j - x| < r  of  p(wo, wi_j) Φ_j / sigma_s(x_j)
//! ```
//!
//! with the scattering `sigma_s` per unit length, which `beta` and `Φ_j` both have in them. Bodies in which light is
//! scattered many times before it leaves are finer than any ball; through them paths go on. Along rays through
//! homogeneous media progressive photon mapping sums all photons near the ray instead, or all beams; see `beam.rs`.
//!
//! Narrow lobes beside a diffuse part, `f = f_broad + f_narrow`, are left to the path: photons count for `f_broad`, and the path that goes on carries
//! the share `f_narrow / f`.
//!
//! Light that is drawn for the vertex, and light that the path hits, are the two estimates of path tracing, per solid
//! angle, with the power heuristic; light of one kind is taken either from a map or from these.
//!
//! No photon leaves a medium that emits. Where there is one, paths go on from vertices whose other light was taken from
//! a map, and add what media emit on their way alone.

use std::f32::consts::PI;

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightGroup;
use kajo_core::bsdf::Bsdf;
use kajo_core::differential::SkyFootprint;
use kajo_core::light::{LightHit, LightLiSample, LightPoint, LightSelection, Receiver};
use kajo_core::scene::{Interaction, Scene};
use kajo_core::settings::PhotonMapUse;
use kajo_math::{Ray, Vec3};

use super::beam::{LEAST_SINE, QueryBeam};
use super::beam_map::CrossingScratch;
use super::{InMedia, Maps, NEIGHBOURS, Photons, Radius};
use crate::integrator::bidir::{SegmentShare, Subpath, Vertex, Volume, shade_one_way};
use crate::integrator::camera_view::RayFootprint;
use crate::integrator::photon_map::{GatherPoint, NearestScratch, Photon, PhotonMap};
use crate::integrator::transport::{
    CollisionOnRay, DrawnLight, EquiangularRay, Event, Joining, MediumInteraction, PathState,
    SurfaceInteraction, advance, cross_hidden, pass_straight, power_heuristic, sample_light, steps::extend,
};
use crate::trail::{About, PathObserver, RayKind};

/// How bright white surfaces are between dots that stand for photons.
const AROUND_DOTS: f32 = 0.1;

/// Follows the path of one sample.
pub struct Gatherer<'a, O> {
    photons: &'a Photons<'a>,
    /// Those of its moment.
    maps: &'a Maps,
    observer: &'a mut O,
    footprint: RayFootprint,
    /// Light as the sensor sees it, linear RGB.
    pub radiance: [f32; 3],
    /// The first surface; the default where the path meets a medium before.
    pub first: Option<Interaction>,
    /// Whether it does.
    pub begins_in_medium: bool,
    /// The albedo of the first surface that is no mirror.
    pub albedo: Option<Spectrum>,
    /// Scratch memory of searches.
    pub scratch: GatherScratch,
    /// Whether photons were taken all along the last ray.
    on_beam: bool,
    /// That ray, where light was drawn for a point along it.
    along: Option<EquiangularRay>,
    /// Whether the path goes on for the light that media emit alone.
    for_media: bool,
}

/// Scratch memory of searches for photons and for beams.
#[derive(Default)]
pub struct GatherScratch {
    nearest: NearestScratch,
    crossings: CrossingScratch,
}

/// The last vertex that is not specular.
#[derive(Clone, Copy)]
struct From {
    receiver: Receiver,
    /// Density per solid angle of that direction.
    pdf: f32,
    /// Whether its caustics were taken from a map.
    has_caustics: bool,
    /// The share of caustics that was not.
    caustics: Spectrum,
    /// Whether its lights were drawn as if no path met them.
    is_alone: bool,
}

/// Which part of direct light has two estimates, by drawing lights and by scattering, that count by the power heuristic.
#[derive(Clone, Copy, PartialEq, Eq)]
enum DirectMis {
    /// None: lights are drawn alone.
    None,
    /// All.
    All,
    /// That of narrow lobes. Of the rest lights are drawn alone, or it was taken from a map.
    Narrow { draws_rest: bool },
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

impl Role {
    /// Whether the path goes on by all that scatters light there.
    fn goes_on(self) -> bool {
        matches!(self, Role::DirectAndCaustics | Role::Direct)
    }

    /// Which part of direct light has two estimates; `None` where no light is drawn.
    ///
    /// * `is_split`: whether narrow lobes are left to the path
    fn direct_mis(self, is_split: bool) -> Option<DirectMis> {
        match self {
            role if role.goes_on() => Some(DirectMis::All),
            Role::FromMap => is_split.then_some(DirectMis::Narrow { draws_rest: false }),
            _ if is_split => Some(DirectMis::Narrow { draws_rest: true }),
            _ => Some(DirectMis::None),
        }
    }
}

impl<'a, O: PathObserver> Gatherer<'a, O> {
    /// * `time`: of the path
    pub fn new(
        photons: &'a Photons<'a>,
        time: f32,
        observer: &'a mut O,
        footprint: RayFootprint,
        scratch: GatherScratch,
    ) -> Self {
        Gatherer {
            photons,
            maps: &photons.maps[photons.shutter.part_at(time) as usize],
            observer,
            footprint,
            radiance: [0.0; 3],
            first: None,
            begins_in_medium: false,
            albedo: None,
            scratch,
            on_beam: false,
            along: None,
            for_media: false,
        }
    }

    fn scene(&self) -> &'a Scene {
        self.photons.view.scene
    }

    /// Follows a path to its end.
    pub fn run<V: Volume<'a>>(&mut self, mut path: Subpath<'_>) {
        let (scene, bounces) = (self.scene(), self.photons.settings.bounces);
        let mut surface = SurfaceInteraction::default();
        let mut from: Option<From> = None;
        let mut length = 0.0;
        loop {
            let (start, beta) = (path.state.ray, path.state.beta);
            let event = match self.maps {
                Maps::Progressive { in_media, radius, .. } if V::HAS_MEDIA && !self.for_media => {
                    self.advance_with_beams(&mut path.state, &mut surface, in_media, radius, length)
                }
                _ => advance(scene, &mut path.state, &mut surface, &mut self.first, self.observer),
            };
            if V::HAS_MEDIA {
                self.add_medium_emission(&mut path);
                if let Maps::Fixed { usage: PhotonMapUse::Dots, in_media, .. } = self.maps {
                    let end = if let Event::Medium(at) = &event { at.length } else { path.state.extent };
                    self.add_dots_along(&Ray { t_min: 0.0, t_max: end, ..start }, beta, in_media, length);
                }
            }
            let is_last = path.state.scatterings > bounces;
            match event {
                Event::Surface => {}
                Event::Escaped(_) if self.for_media => return,
                Event::Escaped(d) => return self.add_background(&path.state, d, from.as_ref()),
                Event::Medium(at) if V::HAS_MEDIA => {
                    length += at.length;
                    let goes_on = !is_last && self.scatter_in_medium::<V>(&mut path, &at, length, &mut from);
                    if !goes_on {
                        return;
                    }
                    continue;
                }
                Event::Medium(_) | Event::Absorbed => return,
            }
            length += surface.length;
            if !self.for_media {
                self.add_emission(&path.state, &surface, from.as_ref());
            }
            if is_last && !scene.appearance.has_passages {
                return;
            }
            let mut bsdf = shade_one_way(scene, &mut path.state, &surface);
            if pass_straight(scene, &mut path.state, &surface, &mut bsdf) {
                if path.state.scatterings == 0 && matches!(bsdf, Bsdf::Null) && !self.begins_in_medium {
                    self.first = None;
                }
                continue;
            }
            if is_last {
                return;
            }
            let z = path.vertex::<V>(scene, &surface, bsdf, LightGroup::default());
            if !self.scatter(&mut path, &z, &surface, length, &mut from) {
                return;
            }
        }
    }

    /// Follows the path to the next event, as [`advance`], and adds the light of the photons along its rays where those are beams.
    ///
    /// * `length`: of the path before
    #[inline(never)]
    fn advance_with_beams(
        &mut self,
        state: &mut PathState<'_>,
        surface: &mut SurfaceInteraction,
        maps: &InMedia,
        radius: &Radius,
        mut length: f32,
    ) -> Event<'a> {
        let scene = self.scene();
        loop {
            let is_last = state.scatterings > self.photons.settings.bounces;
            let beam = QueryBeam::of(scene, state).filter(|_| !is_last);
            let event = extend(scene, state, surface, self.observer);
            (self.on_beam, self.along) = (beam.is_some(), None);
            if let Some(beam) = beam.filter(|_| !matches!(event, Event::Absorbed)) {
                self.add_beam(&beam, state.extent, maps, radius, length);
                self.add_direct_light_along(&beam.start, state);
            }
            if !matches!(event, Event::Surface) {
                return event;
            }
            if self.first.is_none() {
                self.first = Some(surface.at);
            }
            if !cross_hidden(state, surface, self.observer) {
                return event;
            }
            length += surface.length;
        }
    }

    /// Adds the light of one light at a point drawn along a ray.
    ///
    /// * `start`: the path at the start of the ray
    fn add_direct_light_along<'s>(&mut self, start: &PathState<'s>, state: &mut PathState<'s>) {
        let (scene, choice) = (self.scene(), self.photons.settings.light_choice);
        self.along = EquiangularRay::of(scene, start, state.extent);
        let found =
            self.along.and_then(|along| along.sample(scene, start, state, choice.into(), self.observer));
        if let Some((_, added)) = found {
            self.add(added, &start.wavelengths);
        }
    }

    /// The photons of a cylinder around a ray: `beta / (pi r^2) sum T sigma_s p Φ / sigma_s(x_j)` [Jarosz et al. 2008, eq. 13]; or the beams that
    /// pass it, `beta / (2 r) sum T sigma_s p T Φ / sin θ` [Jarosz et al. 2011], and the photons of those that are all but parallel to it.
    ///
    /// * `extent`: length of the ray to the next surface
    /// * `length`: of the path before
    fn add_beam(
        &mut self,
        beam: &QueryBeam<'_, '_>,
        extent: f32,
        maps: &InMedia,
        radius: &Radius,
        length: f32,
    ) {
        let footprint = self.footprint;
        // A pixel is widest at the far end, and a radius has an upper bound.
        let r_at = |t: f32| radius.disk.at(footprint.at((length + t).min(f32::MAX)));
        let ray = Ray { t_min: 0.0, t_max: extent, ..beam.start.ray };
        let mut sums = Sums::new(self.photons.settings.bounces.saturating_sub(beam.start.scatterings));
        let beams = maps.beams.as_ref().filter(|beams| {
            let mean_free_path = beam.ray.mean_free_path;
            let r = beams.radius_at(ray.o + mean_free_path.min(extent) * ray.d);
            mean_free_path > 2.0 * r * maps.photons_per_beam
        });
        if let Some(beams) = beams {
            beams.along(&ray, &mut self.scratch.crossings, |of, at| {
                if at.sine >= LEAST_SINE && of.scatterings <= sums.most_scatterings {
                    sums.take(of.secondary_terminated, beam.scattered_from(of, at));
                }
            });
        }
        maps.photons.along(&ray, r_at(extent), |photon, t, d2| {
            let r = r_at(t);
            let is_meant = beams.is_none() || ray.d.cross(photon.wi()).length() < LEAST_SINE;
            if is_meant && d2 <= r * r && photon.is_within(sums.most_scatterings) {
                sums.take(photon.secondary_terminated(), beam.scattered(photon, t, r));
            }
        });
        self.add_sums(beam.start.beta, &beam.start.wavelengths, &sums, 1.0);
    }

    /// Adds the light of a vertex and goes on from it; `false` when the path ends there.
    fn scatter<V: Volume<'a>>(
        &mut self,
        path: &mut Subpath<'_>,
        z: &Vertex<'a, V>,
        surface: &SurfaceInteraction,
        length: f32,
        from: &mut Option<From>,
    ) -> bool {
        let roulette = self.photons.settings.roulette;
        if z.bsdf.is_delta() {
            return path.scatter(z, surface, roulette, self.observer);
        }
        if V::HAS_MEDIA {
            self.add_volume_light(path, z, surface, None);
        }
        if self.for_media {
            return path.scatter(z, surface, roulette, self.observer);
        }
        if self.albedo.is_none() && self.photons.view.wants_albedo() {
            self.albedo = Some(z.bsdf.albedo(z.local(z.wo).wo));
        }
        let role = self.role(z, surface.length, from.as_ref());
        let is_split = self.is_split(role, z);
        if let Some(mis) = role.direct_mis(is_split) {
            self.add_direct_light(&mut path.state, z, mis, None);
        }
        let p = self.photons.shutter.point_at(self.scene(), &surface.at);
        let query = MapQuery { point: GatherPoint { p, n: z.at.ng }, is_split };
        match (self.maps, role) {
            (_, Role::Direct) => {}
            (Maps::Progressive { indirect, radius, .. }, _) => {
                self.add_disk(&path.state, z, indirect, &query, radius.disk.at(self.footprint.at(length)));
            }
            (Maps::Fixed { caustics, .. }, Role::DirectAndCaustics) => {
                self.add_nearest(&path.state, z, caustics, &query)
            }
            (Maps::Fixed { usage: PhotonMapUse::Dots, all, .. }, _) => {
                self.add_dots(&path.state, z, all, &query.point, length)
            }
            (Maps::Fixed { all, .. }, _) => self.add_nearest(&path.state, z, all, &query),
        }
        let receiver = z.receiver(path.state.ray.time);
        if !path.scatter(z, surface, roulette, self.observer) {
            return false;
        }
        !path.state.connectable || self.leave(path, z, receiver, role, from)
    }

    /// Leaves a vertex in another than a single direction; `false` when the path ends.
    fn leave<V: Volume<'a>>(
        &mut self,
        path: &mut Subpath<'_>,
        z: &Vertex<'a, V>,
        receiver: Receiver,
        role: Role,
        from: &mut Option<From>,
    ) -> bool {
        let is_split = self.is_split(role, z);
        let narrow = if is_split { z.narrow_share(path.state.ray.d) } else { Spectrum::BLACK };
        let caustics = if role == Role::DirectAndCaustics { narrow } else { Spectrum::WHITE };
        let has_caustics = matches!(role, Role::DirectAndCaustics | Role::FromMap);
        let is_alone = !role.goes_on();
        *from = Some(From { receiver, pdf: path.last.pdf, has_caustics, caustics, is_alone });
        match role.goes_on() {
            true => true,
            false if is_split => path.state.keep(narrow),
            false => self.goes_on_for_media(),
        }
    }

    /// Whether narrow lobes of a vertex are left to the path, and the map has what is scattered broadly.
    fn is_split<V: Volume<'a>>(&self, role: Role, z: &Vertex<'a, V>) -> bool {
        let is_meant = match self.maps {
            Maps::Fixed { usage: PhotonMapUse::Direct | PhotonMapUse::Dots, .. } => false,
            // The path goes on for media that emit, by all lobes.
            _ if self.photons.has_emissive_media => role == Role::DirectAndCaustics,
            _ => role != Role::Direct,
        };
        is_meant && z.bsdf.has_narrow_lobes()
    }

    /// Whether a path goes on whose other light was taken from a map; it does so for the light of media that emit.
    fn goes_on_for_media(&mut self) -> bool {
        self.for_media = self.photons.has_emissive_media;
        self.for_media
    }

    /// The same in a medium.
    #[inline(never)]
    fn scatter_in_medium<V: Volume<'a>>(
        &mut self,
        path: &mut Subpath<'_>,
        at: &MediumInteraction<'a>,
        length: f32,
        from: &mut Option<From>,
    ) -> bool {
        if self.first.is_none() {
            self.first = Some(Interaction::default());
            self.begins_in_medium = true;
        }
        let photons = self.photons;
        let z = path.vertex_in_medium::<V>(self.scene(), at, LightGroup::default());
        self.add_volume_light(path, &z, &SurfaceInteraction::default(), Some(at));
        if self.for_media {
            return path.scatter_in_medium(&z, at, photons.settings.roulette, self.observer);
        }
        let role = match self.maps {
            _ if at.is_subsurface => Role::Direct,
            Maps::Fixed { usage: PhotonMapUse::Direct | PhotonMapUse::Dots, .. } => Role::FromMap,
            Maps::Fixed { usage: PhotonMapUse::Caustics, .. } => Role::DirectAndCaustics,
            Maps::Fixed { usage: PhotonMapUse::Gather, .. } | Maps::Progressive { .. } => Role::DirectAndMap,
        };
        if role != Role::FromMap {
            let collision = self.along.map(|along| along.collision(at.length, &path.state));
            let mis = if role.goes_on() { DirectMis::All } else { DirectMis::None };
            self.add_direct_light(&mut path.state, &z, mis, collision);
        }
        match self.maps {
            _ if role == Role::Direct => {}
            // All photons along the ray were added.
            Maps::Progressive { .. } if self.on_beam => {}
            Maps::Progressive { in_media, radius, .. } => {
                self.add_ball(&path.state, &z, &in_media.photons, radius.ball.at(self.footprint.at(length)));
            }
            // All dots along the ray were added.
            Maps::Fixed { usage: PhotonMapUse::Dots, .. } => {}
            Maps::Fixed { in_media, .. } => self.add_nearest_in_ball(&path.state, &z, in_media),
        }
        if !role.goes_on() && !self.goes_on_for_media() {
            return false;
        }
        let receiver = z.receiver(at.time);
        if !path.scatter_in_medium(&z, at, photons.settings.roulette, self.observer) {
            return false;
        }
        let has_caustics = role == Role::DirectAndCaustics;
        let caustics = if has_caustics { Spectrum::BLACK } else { Spectrum::WHITE };
        *from =
            Some(From { receiver, pdf: path.last.pdf, has_caustics, caustics, is_alone: !role.goes_on() });
        true
    }

    /// Adds the light that media gave on the way: no photon comes from there.
    fn add_medium_emission(&mut self, path: &mut Subpath<'_>) {
        let (emitted, weight) = path.medium_emission(self.scene());
        if !emitted.is_black() {
            let light = emitted * weight;
            self.observer.emitter_met(|| sensor::to_rgb(light, &path.state.wavelengths));
            self.add(light, &path.state.wavelengths);
        }
    }

    /// Adds light of media that comes directly to a vertex.
    ///
    /// * `collision`: where that came before the surface
    #[inline(never)]
    fn add_volume_light<V: Volume<'a>>(
        &mut self,
        path: &Subpath<'_>,
        z: &Vertex<'a, V>,
        surface: &SurfaceInteraction,
        collision: Option<&MediumInteraction<'_>>,
    ) {
        if !self.photons.has_emissive_media {
            return;
        }
        let mut light = [0.0; 3];
        path.volume_light(
            self.scene(),
            z,
            surface,
            collision,
            self.observer,
            |emitted, wavelengths, observer| {
                let rgb = sensor::to_rgb(emitted, wavelengths);
                observer.emitter_met(|| rgb);
                light = [0, 1, 2].map(|i| light[i] + rgb[i]);
            },
        );
        self.radiance = [0, 1, 2].map(|i| self.radiance[i] + light[i]);
    }

    /// What becomes of light at a vertex that is no mirror.
    ///
    /// * `length`: of the last segment
    fn role<V: Volume<'a>>(&self, z: &Vertex<'a, V>, length: f32, from: Option<&From>) -> Role {
        match self.maps {
            Maps::Fixed { usage: PhotonMapUse::Direct | PhotonMapUse::Dots, .. } => Role::FromMap,
            _ if !z.bsdf.has_broad_part() => Role::Direct,
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
    fn add_disk<V: Volume<'a>>(
        &mut self,
        state: &PathState<'_>,
        z: &Vertex<'a, V>,
        map: &PhotonMap,
        query: &MapQuery,
        r: f32,
    ) {
        let mut sums = Sums { is_split: query.is_split, ..Sums::new(self.most_scatterings(state)) };
        map.within(&query.point, r, |photon| sums.add(z, photon));
        // [Jensen 2001, eq. 7.6]
        self.add_sums(state.beta, &state.wavelengths, &sums, (PI * r * r).recip());
    }

    /// The `k` nearest photons: `beta (k - 1) / (k pi r_k^2) sum f Φ`.
    fn add_nearest<V: Volume<'a>>(
        &mut self,
        state: &PathState<'_>,
        z: &Vertex<'a, V>,
        map: &PhotonMap,
        query: &MapQuery,
    ) {
        if map.is_empty() {
            return;
        }
        let mut sums = Sums { is_split: query.is_split, ..Sums::new(self.most_scatterings(state)) };
        let density =
            map.nearest(&query.point, NEIGHBOURS, &mut self.scratch.nearest, |photon| sums.add(z, photon));
        self.add_sums(state.beta, &state.wavelengths, &sums, density);
    }

    /// A dot where a photon lies within the width of a pixel, and a dim view of the surface elsewhere.
    ///
    /// * `length`: of the path from the camera
    fn add_dots<V: Volume<'a>>(
        &mut self,
        state: &PathState<'_>,
        z: &Vertex<'a, V>,
        map: &PhotonMap,
        point: &GatherPoint,
        length: f32,
    ) {
        let mut dot = None;
        map.within(point, self.footprint.at(length), |photon| dot = dot.or(Some(dot_of(photon))));
        let local = z.local(z.wo);
        let light = dot.unwrap_or_else(|| z.bsdf.albedo(local.wo) * (AROUND_DOTS * local.wo.z.abs()));
        self.add_shown(state.beta * light, &state.wavelengths);
    }

    /// A dot where a photon of a medium lies within the width of a pixel beside a ray.
    ///
    /// * `beta`: throughput at the start of the ray
    /// * `length`: of the path before
    fn add_dots_along(&mut self, ray: &Ray, beta: Spectrum, map: &PhotonMap, length: f32) {
        let footprint = self.footprint;
        let r_at = |t: f32| footprint.at((length + t).min(f32::MAX));
        let mut dot = None;
        map.along(ray, r_at(ray.t_max), |photon, t, d2| {
            if d2 <= r_at(t) * r_at(t) {
                dot = dot.or(Some(dot_of(photon)));
            }
        });
        let wavelengths = self.photons.wavelengths;
        self.add_shown(beta * dot.unwrap_or(Spectrum::BLACK), &wavelengths);
    }

    /// Adds what is shown in place of light.
    fn add_shown(&mut self, light: Spectrum, wavelengths: &Wavelengths) {
        self.observer.found(|| sensor::to_rgb(light, wavelengths));
        self.add(light, wavelengths);
    }

    /// The photons of a ball of radius `r`: `beta / (4/3 pi r^3) sum p Φ / sigma_s` [Jensen and Christensen 1998, eq. 9].
    fn add_ball<V: Volume<'a>>(&mut self, state: &PathState<'_>, z: &Vertex<'a, V>, map: &PhotonMap, r: f32) {
        let mut sums = Sums::new(self.most_scatterings(state));
        map.within_ball(z.at.p, r, |photon| sums.add(z, photon));
        self.add_sums(state.beta, &state.wavelengths, &sums, (4.0 / 3.0 * PI * r * r * r).recip());
    }

    /// The `k` nearest photons: `beta (k - 1) / (k 4/3 pi r_k^3) sum p Φ / sigma_s`.
    fn add_nearest_in_ball<V: Volume<'a>>(
        &mut self,
        state: &PathState<'_>,
        z: &Vertex<'a, V>,
        map: &PhotonMap,
    ) {
        if map.is_empty() {
            return;
        }
        let mut sums = Sums::new(self.most_scatterings(state));
        let density =
            map.nearest_in_ball(z.at.p, NEIGHBOURS, &mut self.scratch.nearest, |photon| sums.add(z, photon));
        self.add_sums(state.beta, &state.wavelengths, &sums, density);
    }

    /// * `beta`, `wavelengths`: throughput of the path, and what its lanes stand for
    fn add_sums(&mut self, beta: Spectrum, wavelengths: &Wavelengths, sums: &Sums, density: f32) {
        let mut single = *wavelengths;
        single.terminate_secondary();
        let lights = [sums.all * beta * density, sums.single * beta * density];
        self.observer.found(|| {
            let rgb = [sensor::to_rgb(lights[0], wavelengths), sensor::to_rgb(lights[1], &single)];
            [0, 1, 2].map(|i| rgb[0][i] + rgb[1][i])
        });
        self.add(lights[0], wavelengths);
        self.add(lights[1], &single);
    }

    /// How often a photon may have been scattered before it comes to the present vertex.
    fn most_scatterings(&self, state: &PathState<'_>) -> u32 {
        self.photons.settings.bounces.saturating_sub(state.scatterings)
    }

    /// The MIS weight of light that the path hit: `p^2 / (p^2 + q^2)` of the density `p` per solid angle with which it went there and the
    /// density `q` of drawing the light at the vertex before [Veach 1997, eq. 9.15]; for a caustic the share that was not taken from a map.
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
    ) -> Spectrum {
        match from {
            None => Spectrum::WHITE,
            Some(from) if state.connectable => {
                let choice = LightSelection::from(self.photons.settings.light_choice);
                let choice = if from.is_alone { choice.alone() } else { choice };
                let pdf_li = self.scene().pdf_li(hit.light, &from.receiver, at, d, choice);
                let reach = if state.carries_media { state.lanes.arrival(&state.wavelengths) } else { 1.0 };
                Spectrum::grey(power_heuristic(from.pdf * reach, pdf_li))
            }
            // By way of mirrors.
            Some(from) => from.caustics,
        }
    }

    fn add_background(&mut self, state: &PathState<'_>, d: Vec3, from: Option<&From>) {
        let through = from.map_or(state.ray.o, |from| from.receiver.p);
        for hit in self.scene().lights_at_infinity(d, &SkyFootprint::POINT, &state.wavelengths) {
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
        self.observer.emitter_met(|| sensor::to_rgb(light, &state.wavelengths));
        self.add(light, &state.wavelengths);
    }

    /// Next-event estimation at a vertex: the integral over directions of `f |cos| Li`, by one direction drawn with the density `q` per solid
    /// angle, is `f |cos| T V Le w / q` with the weight `w = q^2 / (p^2 + q^2)` [Veach 1997, eq. 9.15].
    ///
    /// * `mis`: which part of it the path may meet
    /// * `collision`: where the vertex is one on a ray for a point of which light was drawn too
    fn add_direct_light<V: Volume<'a>>(
        &mut self,
        state: &mut PathState<'_>,
        z: &Vertex<'a, V>,
        mis: DirectMis,
        collision: Option<CollisionOnRay>,
    ) {
        let scene = self.scene();
        let time = state.ray.time;
        let choice = LightSelection::from(self.photons.settings.light_choice);
        let by = if mis == DirectMis::All { choice } else { choice.alone() };
        let Some(drawn) = sample_light(scene, state, &z.receiver(time), by) else { return };
        let DrawnLight { light, pdf, li: LightLiSample { wi, radiance, is_delta, at, .. } } = drawn;
        let scattered = z.gathered(wi);
        if scattered.is_black() {
            return;
        }
        let segment = z.at.ray_to(&at, wi, time);
        let collided = collision.map(|collision| collision.weight(scene, light, choice));
        let carried = state.beta * scattered * collided.unwrap_or(1.0);
        let distance = if at.is_infinite() { f32::INFINITY } else { at.p().distance(z.at.p) };
        let share =
            SegmentShare::along(scene, z, wi, distance, &segment, Joining::from(state), self.observer);
        let found = share.map_or(Spectrum::BLACK, |SegmentShare { within, visible, reach }| {
            let drawn = || match is_delta {
                true => 1.0,
                false => power_heuristic(pdf, z.pdf(z.wo, wi) * reach),
            };
            let weight = match mis {
                DirectMis::None => Spectrum::WHITE,
                DirectMis::All => Spectrum::grey(drawn()),
                DirectMis::Narrow { draws_rest } => {
                    let narrow = z.narrow_share(wi);
                    let rest = if draws_rest { Spectrum::WHITE - narrow } else { Spectrum::BLACK };
                    rest + narrow * drawn()
                }
            };
            carried * radiance * within * visible * weight * pdf.recip()
        });
        let about = || About {
            eta: z.eta(wi).unwrap_or(1.0),
            weight: sensor::to_rgb(carried, &state.wavelengths),
            light: Some(scene.lighting.sampler.id(light)),
        };
        let rgb = || sensor::to_rgb(found, &state.wavelengths);
        self.observer.joined(RayKind::Shadow, scene, &segment, about, rgb);
        self.add(found, &state.wavelengths);
    }
}

/// The colour of a photon's power, as bright as can be.
fn dot_of(photon: &Photon) -> Spectrum {
    let power = photon.power();
    let largest = power.to_rgb().into_iter().fold(f32::MIN_POSITIVE, f32::max);
    power * (1.0 / largest)
}

/// A place whose photons are wanted.
struct MapQuery {
    point: GatherPoint,
    /// Whether they count for what is scattered broadly alone.
    is_split: bool,
}

/// Power of photons, scattered to the camera.
struct Sums {
    all: Spectrum,
    /// Of those of which only one wavelength counts.
    single: Spectrum,
    most_scatterings: u32,
    /// Whether narrow lobes are left out.
    is_split: bool,
}

impl Sums {
    fn new(most_scatterings: u32) -> Sums {
        Sums { all: Spectrum::BLACK, single: Spectrum::BLACK, most_scatterings, is_split: false }
    }

    /// `f Φ`, with the factor for shading normals of light that comes from a light [Veach 1997, 5.3.2].
    fn add<'v, V: Volume<'v>>(&mut self, z: &Vertex<'v, V>, photon: &Photon) {
        if !photon.is_within(self.most_scatterings) {
            return;
        }
        let wi = photon.wi();
        let cosine = z.cosine(wi);
        if cosine <= 0.0 {
            return;
        }
        let scattered = if self.is_split { z.gathered_broadly(wi) } else { z.gathered(wi) };
        self.take(photon.secondary_terminated(), scattered * photon.power() * cosine.recip());
    }

    /// Adds the light that a photon or a beam brings.
    fn take(&mut self, secondary_terminated: bool, light: Spectrum) {
        *(if secondary_terminated { &mut self.single } else { &mut self.all }) += light;
    }
}
