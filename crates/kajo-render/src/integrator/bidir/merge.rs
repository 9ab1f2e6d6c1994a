//! Vertex merging: one more technique that samples a path, by a vertex of a path from a light that lies near a vertex of the camera's.
//!
//! A pass has `N` paths from lights, whose vertices are kept in a map. The camera's path takes those that lie within `r` of its
//! own vertex `z` for paths that come to `z` itself,
//!
//! ```text
//! L  =  1/(N pi r^2)  sum over y  of  beta_y f_z(wi_y, wo) beta_z w                  [Georgiev et al. 2012]
//! ```
//!
//! This technique draws `z` from both sides, and takes it if both points are close: its density is that of a connection before `z`, times that of
//! drawing `z` from the light, times the area of the disk. With `N` paths from lights it is worth `N` samples, so in weights it has the
//! density
//!
//! ```text
//! p_m  =  eta p>(z) p_s,      eta = pi r^2 N                                         [Georgiev 2012, eq. 20]
//! ```
//!
//! if `p_s` is that of the connection before `z`; it counts as if it were rarer, see [`MERGE_DENSITY`]. A connection
//! that ends at `z` from the light has the density `p_s p>(z) / p<(next)`, so merging at the end of a path adds `eta^2`
//! to what stands for the connection before it: in `d_vcm` of `partial_mis.rs`, from which it gets into `d_vc` of all
//! later vertices. In terms of the sums with that, the weight of merging is
//!
//! ```text
//! w_m  =  1 / (a_light + a_camera - 1),      a = (d_vcm + b^2 d_vc) / eta^2          [Georgiev 2012, eq. 37 to 39]
//! ```
//!
//! Each `a` is at least one, which is merging itself. Holes are not merged, neither are mirrors.
//!
//! In a medium the vertices within a ball are taken instead [Křivánek et al. 2014, point-point 3D], of power per volume,
//!
//! ```text
//! L  =  1/(N 4/3 pi r^3)  sum over y  of  beta_y / sigma_s(y) p_z(wi_y, wo) beta_z w,      eta = 4/3 pi r^3 N
//! ```
//!
//! with the phase function `p_z`, and the scattering `sigma_s` per unit length that both ends have in their `beta`. Densities at such a vertex are
//! per volume, see `volume.rs`, and `eta` is, so sums and weights are those of surfaces with the one `eta` or the other
//! at each vertex. The ball is never larger than a part of the mean free path, [`LARGEST_BALL`]; so `eta` is a function
//! of the place.
//!
//! Balls hold few points where connections find much: a vertex in a medium is merged only if light comes to it and
//! leaves it by mirrors or clear boundaries, so that it can be connected with neither neighbour. Whether that is so is
//! known from each side once the path has gone on, and what merging adds to the sums waits until then:
//! [`WithMedia::merged`](super::WithMedia::merged). Until the next vertex is known to be a mirror, `d_vcm` of the vertex is without it, as it has
//! to be for connections.
//!
//! What moves is merged with light of its own moment: the shutter interval is divided into equal parts, `eta` becomes that of one of them, and
//! only vertices of one part are merged, at the positions which they have in the middle of it.

use std::f32::consts::PI;

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::LightGroup;
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec3;
use kajo_math::rng::mix;

use super::partial_mis::square;
use super::techniques::AllTechniques;
use super::{Bidirectional, CameraEnd, Carried, Contribution, Vertex, VertexCounts, Volume};
use crate::integrator::photon_map::{Arrival, GatherPoint, Photon, PhotonMap, Stored, dither};
use crate::integrator::transport::{LaneMis, SurfaceInteraction};
use crate::setup::append_tightly;
use crate::trail::{Counting, PathObserver};
use crate::{RayCounters, SampleContext, Setup, SetupError};

/// Sets the numbers of light paths that are kept apart from those of samples.
const SALT: u64 = 0x006d_6572_6765;

/// Paths that one task follows.
const PATHS_A_TASK: u32 = 4096;

/// Most parts of a shutter interval.
const MOST_MOMENTS: u32 = 250;

/// The density of merging in weights, in parts of the true one: all samples of a pass share its vertices, while those that are connected are
/// their own.
///
/// By relative variance of `gallery/looking_glass.txt` at equal samples: 1.46 with 1, 1 with 1/10, 1.12 with 1/50. Light that merging
/// alone finds is the same with all of them.
const MERGE_DENSITY: f64 = 0.1;

/// Largest radius of a ball in a medium, in mean free paths: light changes within one, and beyond the surface of a body there is none.
const LARGEST_BALL: f32 = 0.5;

/// The ball around a vertex in a medium in which it is merged.
#[derive(Clone, Copy, Debug)]
pub struct MergeBall {
    /// World units.
    radius: f32,
    /// `eta^2`.
    density2: f64,
    /// `1/(4/3 pi r^3)`, for one part of the shutter interval.
    kernel: f32,
}

/// Vertices of paths from lights, on surfaces and in media.
#[derive(Debug, Default)]
struct VertexBatch {
    on_surfaces: Vec<LightVertex>,
    in_media: Vec<LightVertex>,
    /// Rays that were cast for them.
    rays: RayCounters,
}

impl VertexBatch {
    /// Adds those of the paths after these.
    fn append(&mut self, next: VertexBatch) {
        append_tightly(&mut self.on_surfaces, next.on_surfaces);
        append_tightly(&mut self.in_media, next.in_media);
        self.rays += next.rays;
    }

    fn bytes(&self) -> u64 {
        let room = self.on_surfaces.capacity() + self.in_media.capacity();
        room as u64 * size_of::<LightVertex>() as u64
    }
}

/// A vertex of a path from a light, as it is kept.
#[derive(Clone, Copy, Debug)]
pub struct LightVertex {
    photon: Photon,
    /// Square roots of `d_vcm / eta^2` and `d_vc / eta^2`.
    d_vcm: f32,
    d_vc: f32,
    /// How often light was scattered before.
    scatterings: u16,
    group: LightGroup,
    /// Part of the shutter interval.
    moment: u8,
}

impl LightVertex {
    /// Whether a path from the camera may be merged with it.
    ///
    /// * `most`: scatterings before it that the path may still have
    /// * `moment`: part of the shutter interval
    fn completes(&self, most: u32, moment: u8) -> bool {
        u32::from(self.scatterings) <= most && self.moment == moment
    }
}

impl Stored for LightVertex {
    fn photon(&self) -> &Photon {
        &self.photon
    }

    fn photon_mut(&mut self) -> &mut Photon {
        &mut self.photon
    }
}

/// How the vertices of a pass are merged.
#[derive(Clone, Copy, Debug)]
pub struct MergePass {
    /// The number of the pass, from 0.
    pub k: u32,
    /// Paths from lights, at least 1.
    pub paths: u32,
    /// Radius of the disks, above zero.
    pub radius: f32,
    /// Largest radius of the balls in media, above zero, see [`LARGEST_BALL`].
    pub ball_radius: f32,
    /// Parts of the shutter interval that are merged among themselves, from 1 to 250.
    pub moments: u32,
    /// What all paths carry, since none of different ones can be merged.
    pub wavelengths: Wavelengths,
}

/// The vertices of paths from lights of a pass.
#[derive(Debug)]
pub struct Merging {
    pass: MergePass,
    map: PhotonMap<LightVertex>,
    in_media: PhotonMap<LightVertex>,
    /// `eta^2`.
    density2: f64,
    /// `1/(pi r^2)`, for one part of the shutter interval.
    kernel: f32,
}

impl Merging {
    fn new(pass: MergePass) -> Merging {
        let moments = pass.moments.clamp(1, MOST_MOMENTS);
        let area = f64::from(pass.radius).powi(2) * std::f64::consts::PI / f64::from(moments);
        let density = MERGE_DENSITY * area * f64::from(pass.paths);
        let kernel = moments as f32 / (PI * pass.radius * pass.radius);
        Merging {
            pass: MergePass { moments, ..pass },
            map: PhotonMap::new(Vec::new(), 1),
            in_media: PhotonMap::new(Vec::new(), 1),
            density2: density * density,
            kernel,
        }
    }

    /// What all paths of the pass carry.
    pub fn wavelengths(&self) -> &Wavelengths {
        &self.pass.wavelengths
    }

    /// Whether nothing can be merged.
    pub fn is_empty(&self) -> bool {
        self.map.is_empty() && self.in_media.is_empty()
    }

    fn moment(&self, time: f32) -> u8 {
        ((time * self.pass.moments as f32) as u32).min(self.pass.moments - 1) as u8
    }

    /// Notes that a vertex on a surface can be merged, if so: light that goes on from there may have been found so.
    #[inline(never)]
    pub fn weigh<'s, V: Volume<'s>>(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        vertex: &mut Vertex<'s, V>,
    ) {
        let (at, appearance) = (&surface.at, &scene.appearance);
        // A hole that light came by was not seen at all.
        let has_holes = appearance.has_passages && appearance.has_passages(at.material);
        let is_delta = vertex.bsdf.is_delta();
        // Of a mixture another part may be seen from the camera.
        if has_holes || is_delta && !scene.is_mixture(at) {
            return;
        }
        vertex.merged_at = Some(match self.pass.moments {
            1 => at.point.p,
            n => scene.geometry.point_at(at, (f32::from(self.moment(at.time)) + 0.5) / n as f32),
        });
        if !is_delta {
            vertex.mis.d_vcm += self.density2;
        }
    }

    /// The ball around a vertex in a medium.
    ///
    /// * `sigma_t`: mean extinction there
    fn ball(&self, sigma_t: f32) -> MergeBall {
        let MergePass { moments, paths, ball_radius, .. } = self.pass;
        let radius = ball_radius.min(LARGEST_BALL / sigma_t);
        let volume = 4.0 / 3.0 * std::f64::consts::PI * f64::from(radius).powi(3) / f64::from(moments);
        let density = MERGE_DENSITY * volume * f64::from(paths);
        MergeBall { radius, density2: density * density, kernel: (1.0 / volume) as f32 }
    }

    /// Notes that a vertex in a medium can be merged, and with what is in which ball, if so.
    ///
    /// * `connectable`: whether it can be connected with the vertex before
    #[inline(never)]
    pub fn weigh_in_medium<'s, V: Volume<'s>>(
        &self,
        vertex: &mut Vertex<'s, V>,
        connectable: bool,
    ) -> Option<MergeBall> {
        let volume = vertex.volume.with_media_mut().filter(|_| !connectable)?;
        let ball = self.ball(volume.sigma_t);
        volume.merged = ball.density2;
        vertex.merged_at = Some(vertex.at.p);
        Some(ball)
    }

    /// The weight of merging `y` with `z` [Georgiev 2012, eq. 37 to 39].
    ///
    /// * `wi`: unit direction from which light comes to `y`
    /// * `density2`: `eta^2` at `z`
    fn mis_weight<'s, V: Volume<'s>>(y: &LightVertex, z: &Vertex<'s, V>, wi: Vec3, density2: f64) -> f32 {
        let merged =
            z.volume.with_media().filter(|volume| volume.phase.is_some()).map_or(0.0, |volume| volume.merged);
        let from_light = square(y.d_vcm) + square(z.pdf(z.wo, wi)) * square(y.d_vc);
        let from_camera = (z.mis.weighed(1.0, z.pdf(wi, z.wo)) + merged) / density2;
        let weight = (1.0 / (from_light + from_camera - 1.0)) as f32;
        // Densities beyond all numbers belong to ways that find the path for certain.
        if weight.is_nan() { 0.0 } else { weight }
    }

    /// A vertex of a path from a light as it is kept; `None` where it cannot be merged.
    ///
    /// * `dither`: in [0, 1)
    fn stored<'s, V: Volume<'s>>(
        &self,
        vertex: &Vertex<'s, V>,
        scatterings: u32,
        moment: u8,
        dither: f32,
    ) -> Option<LightVertex> {
        let arrival = self.arrival(vertex, scatterings)?;
        // The camera's path sees the part of a mixture that it draws itself.
        let own = if vertex.bsdf.is_delta() { 1.0 } else { 0.0 };
        Some(self.kept(vertex, &arrival, self.density2, own, moment, dither))
    }

    /// The same in a medium.
    ///
    /// * `time`: moment within the shutter interval
    fn stored_in_medium<'s, V: Volume<'s>>(
        &self,
        scene: &Scene,
        vertex: &Vertex<'s, V>,
        scatterings: u32,
        time: f32,
        dither: f32,
    ) -> Option<LightVertex> {
        let (arrival, volume) = (self.arrival(vertex, scatterings)?, vertex.volume.with_media()?);
        let sigma_s = volume.media[0].scattering(scene, arrival.p, time, self.wavelengths());
        let arrival = Arrival { n: Vec3::Z, power: arrival.power.safe_div(sigma_s), ..arrival };
        // Merging itself, which its sums are without.
        Some(self.kept(vertex, &arrival, volume.merged, 1.0, self.moment(time), dither))
    }

    /// What comes to a vertex; `None` where it cannot be merged.
    fn arrival<'s, V: Volume<'s>>(&self, vertex: &Vertex<'s, V>, scatterings: u32) -> Option<Arrival> {
        Some(Arrival {
            p: vertex.merged_at?,
            n: vertex.at.ng,
            wi: vertex.wo,
            power: vertex.beta * (1.0 / self.pass.paths as f32),
            scatterings,
            secondary_terminated: vertex.secondary_terminated,
        })
    }

    /// * `density2`, `own`: `eta^2`, and what merging adds to `d_vcm / eta^2`
    fn kept<'s, V: Volume<'s>>(
        &self,
        vertex: &Vertex<'s, V>,
        arrival: &Arrival,
        density2: f64,
        own: f64,
        moment: u8,
        dither: f32,
    ) -> LightVertex {
        LightVertex {
            photon: Photon::new(arrival, dither),
            d_vcm: (vertex.mis.d_vcm / density2 + own).sqrt() as f32,
            d_vc: (vertex.mis.d_vc / density2).sqrt() as f32,
            scatterings: arrival.scatterings.min(u16::MAX.into()) as u16,
            group: vertex.group,
            moment,
        }
    }
}

#[cfg(test)]
impl Merging {
    /// What a merged path counts if `y`, drawn from the light, and `z`, drawn from the camera, are one.
    pub fn mis_weight_of(&self, y: &Vertex<'_>, z: &Vertex<'_>) -> f32 {
        let stored = self.stored(y, 0, 0, 0.5).expect("a vertex that can be merged");
        Merging::mis_weight(&stored, z, y.wo, self.density2)
    }

    /// `eta`.
    pub fn density(&self) -> f64 {
        self.density2.sqrt()
    }
}

impl<'a, V: Volume<'a>> Bidirectional<'a, V> {
    /// Follows the paths from lights of a pass. Returns their vertices, and the rays that they took.
    ///
    /// The numbers of path `i` are those of sample `i` of one pixel of a Sobol sequence.
    ///
    /// # Errors
    /// [`SetupError`]; when there is no room for the vertices.
    pub fn merging(&self, pass: MergePass, setup: &Setup<'_>) -> Result<(Merging, RayCounters), SetupError> {
        let mut merging = Merging::new(pass);
        let sampler = Sampler::new(SamplerKind::Sobol, pass.paths);
        let work = |task: u32| {
            let begin = task * PATHS_A_TASK;
            let end = begin.saturating_add(PATHS_A_TASK).min(pass.paths);
            let (mut batch, mut path) = (VertexBatch::default(), Vec::new());
            let mut counting = Counting::new(&SampleContext::new(&sampler, 0));
            for i in begin..end {
                let draws = SampleStream::new(&sampler, mix(setup.seed ^ SALT), [pass.k, 0], i);
                self.keep_path(&merging, draws, &mut counting, &mut path, i, &mut batch);
            }
            VertexBatch { rays: counting.rays, ..batch }
        };
        let all =
            setup.fold_tasks(pass.paths.div_ceil(PATHS_A_TASK), work, |all: &mut VertexBatch, batch| {
                all.append(batch);
                if all.bytes() > setup.memory { Err(too_many(pass.paths, setup.memory)) } else { Ok(()) }
            })?;
        merging.map = PhotonMap::new(all.on_surfaces, setup.threads);
        merging.in_media = PhotonMap::new(all.in_media, setup.threads);
        Ok((merging, all.rays))
    }

    /// Follows one path from a light and keeps its vertices.
    ///
    /// * `path`: room for them
    fn keep_path(
        &self,
        merging: &Merging,
        mut draws: SampleStream<'_>,
        counting: &mut Counting,
        path: &mut Vec<Vertex<'a, V>>,
        i: u32,
        batch: &mut VertexBatch,
    ) {
        let wavelengths = merging.wavelengths();
        let time = draws.number_if(self.view.scene.moves());
        let hero = if V::HAS_MEDIA { LaneMis::new(wavelengths, draws.next_1d()).hero } else { 0 };
        path.clear();
        let techniques = AllTechniques(Some(merging));
        let carried = Carried { wavelengths, time, hero, techniques };
        self.follow_light(counting, path, draws, carried);
        let moment = merging.moment(time);
        for (j, vertex) in (0..).zip(&*path) {
            let dither = dither(i, j);
            match vertex.phase() {
                None => batch.on_surfaces.extend(merging.stored(vertex, j, moment, dither)),
                Some(_) => {
                    let stored = merging.stored_in_medium(self.scene(), vertex, j, time, dither);
                    batch.in_media.extend(stored);
                }
            }
        }
    }

    /// Merges a vertex of the camera's path with those of paths from lights.
    #[inline(never)]
    pub(super) fn merge<O: PathObserver>(
        &self,
        end: &CameraEnd<'_, '_, '_, V, impl Copy>,
        z: &mut Vertex<'a, V>,
        merging: &Merging,
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) {
        if end.collision.is_some() {
            return self.merge_in_medium(end, z, merging, observer, found);
        }
        merging.weigh(self.scene(), &end.surface, z);
        let Some(p) = z.merged_at.filter(|_| !z.is_delta()) else { return };
        let (moment, most) = (merging.moment(end.carried.time), self.longest() - 1 - end.t);
        let point = GatherPoint { p, n: z.at.ng };
        merging.map.within(&point, merging.pass.radius, |y| {
            if !y.completes(most, moment) {
                return;
            }
            let wi = y.photon.wi();
            let (scattered, cosine) = (z.gathered(wi), z.cosine(wi));
            if scattered.is_black() || cosine <= 0.0 {
                return;
            }
            // The kernel 1/(N pi r^2) estimates a density per area of the true surface, so the cosine of `f |cos|` is divided by that of
            // the geometric normal [Veach 1997, 5.3.2].
            let light = z.beta * scattered * y.photon.power() * (merging.kernel / cosine);
            add_merged(end, z, y, Merged { light, density2: merging.density2 }, observer, found);
        });
    }

    /// The same in a medium: `1/(4/3 pi r^3) sum beta_y / sigma_s p_z beta_z w` [Křivánek et al. 2014, point-point 3D].
    #[inline(never)]
    fn merge_in_medium<O: PathObserver>(
        &self,
        end: &CameraEnd<'_, '_, '_, V, impl Copy>,
        z: &mut Vertex<'a, V>,
        merging: &Merging,
        observer: &mut O,
        found: &mut impl FnMut(Contribution, &Wavelengths),
    ) {
        let Some(ball) = merging.weigh_in_medium(z, end.path.state.connectable) else { return };
        let MergeBall { radius, density2, kernel } = ball;
        let (moment, most) = (merging.moment(end.carried.time), self.longest() - 1 - end.t);
        merging.in_media.within_ball(z.at.p, radius, |y| {
            if !y.completes(most, moment) {
                return;
            }
            let light = z.beta * z.gathered(y.photon.wi()) * y.photon.power() * kernel;
            add_merged(end, z, y, Merged { light, density2 }, observer, found);
        });
    }
}

/// What a merged path carries.
struct Merged {
    /// The estimate by merging alone.
    light: Spectrum,
    /// `eta^2` where it was merged.
    density2: f64,
}

/// Hands the light of a merged path to `found` and to the observer.
fn add_merged<'a, V: Volume<'a>, O: PathObserver>(
    end: &CameraEnd<'_, '_, '_, V, impl Copy>,
    z: &Vertex<'a, V>,
    y: &LightVertex,
    Merged { light, density2 }: Merged,
    observer: &mut O,
    found: &mut impl FnMut(Contribution, &Wavelengths),
) {
    let wavelengths = end.carried.wavelengths;
    let merged = Contribution {
        technique: VertexCounts { s: u32::from(y.scatterings) + 2, t: end.t },
        is_merged: true,
        light,
        weight: Merging::mis_weight(y, z, y.photon.wi(), density2),
        secondary_terminated: y.photon.secondary_terminated() || z.secondary_terminated,
        group: y.group,
        raster: None,
    };
    observer.found(|| merged.value(wavelengths));
    found(merged, wavelengths);
}

fn too_many(paths: u32, memory: u64) -> SetupError {
    SetupError::Refused(format!(
        "the vertices of {paths} paths from lights need more memory than the {} MB that can be had; ask for fewer `photons`",
        memory >> 20
    ))
}
