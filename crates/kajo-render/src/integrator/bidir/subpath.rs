//! One of the two subpaths of a path, from the light or from the camera, while it grows.
//!
//! With the vertices `x0 .. xi` a subpath carries the product of scattering over densities,
//!
//! ```text
//! beta = beta_0  product over 0 < j < i of  f |cos| / p>(xj -> xj+1)
//! ```
//!
//! with densities `p>` per solid angle: `beta_0` is 1 at the camera, and `Le |cos| / (P p_A p_d)` at a light that was
//! chosen with the probability `P` and left with the densities `p_A` of the position and `p_d` of the direction. An
//! estimate is `beta` of one subpath times what joins it to the other, or to nothing, and a weight of the power
//! heuristic over all techniques. For these weights each vertex keeps the sums of [`PartialMis`] [Georgiev 2012, eq. 34
//! and 35], of the density of the ray and of that of the direction back, both per area where they arrive.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::LightGroup;
use kajo_core::bsdf::{Bsdf, BsdfSample, Transport};
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::LightLeSample;
use kajo_core::scene::{Interaction, Scene};
use kajo_core::shading::Shading;
use kajo_math::Vec3;

use super::partial_mis::{Growth, PartialMis};
use super::vertex::Vertex;
use super::volume::{Volume, WithMedia, grown_through_media};
use super::{Contribution, VertexCounts, shade_one_way};
use crate::integrator::transport::{
    Event, MediumInteraction, PathState, SurfaceInteraction, VolumeDirection, advance, follow, follow_phase,
    pass_straight, power_heuristic, survives, survives_in_medium, weight_of_emission,
};
use crate::trail::PathObserver;

/// The vertex that the current ray starts from, and the density with which the ray was sampled there.
#[derive(Clone, Copy, Debug)]
pub struct LastVertex {
    /// The vertex.
    pub p: Vec3,
    /// Density of the ray per solid angle; for parallel rays (light from infinitely far away, orthographic cameras) per area across them.
    pub pdf: f32,
    /// Whether `pdf` is per area across the ray, so that no distance enters the density at its end.
    pub is_parallel: bool,
    /// Cosine with the true surface at the vertex, 1 where there is none.
    pub cosine: f32,
    /// Index of refraction around the start of the ray.
    pub eta: f32,
    /// Density per solid angle of going the other way, from where the ray ends to the vertex before this one.
    pub pdf_back: f32,
    /// The sums of the vertex.
    pub mis: PartialMis,
    /// What merging at the vertex adds to `d_vcm` if the ray comes to the next one by mirrors or clear boundaries, see [`WithMedia::merged`].
    pub merged: f64,
}

impl LastVertex {
    /// The sums of the vertex, with merging there if no connection joins it with the next one.
    ///
    /// * `connectable`: whether one does
    #[inline(always)]
    fn sums<'v, V: Volume<'v>>(&self, connectable: bool) -> PartialMis {
        match V::HAS_MEDIA && !connectable {
            true => PartialMis { d_vcm: self.mis.d_vcm + self.merged, ..self.mis },
            false => self.mis,
        }
    }
}

/// A path from one end while it grows.
pub struct Subpath<'s> {
    pub state: PathState<'s>,
    pub last: LastVertex,
}

impl<'s> Subpath<'s> {
    /// A path from the camera that begins with the ray of its state.
    pub fn from_camera(state: PathState<'s>) -> Subpath<'s> {
        let (p, eta, mis) = (state.ray.o, state.media.eta(), PartialMis::default());
        let last =
            LastVertex { p, pdf: 1.0, is_parallel: true, cosine: 1.0, eta, pdf_back: 0.0, mis, merged: 0.0 };
        Subpath { state, last }
    }
}

/// The vertex that a path has come to: scattering on the surface, or the collision in a medium, where there is none.
pub type NextVertex<'a> = (Bsdf<'a>, Option<MediumInteraction<'a>>);

/// What a path from a light has come to.
pub enum LightStep<'a> {
    /// A surface that it went straight through, by a hole or a pane, and what it carried there.
    Passed(Spectrum),
    /// A vertex.
    Vertex(NextVertex<'a>),
}

impl Subpath<'_> {
    /// Follows a path from a light to its next vertex; `None` where it ends.
    ///
    /// Where the light's falloff is not the inverse square the path is corrected at its first vertex, whose distance decides.
    ///
    /// * `emitted`: the light that the path begins with
    /// * `surface`: filled, if the vertex is on one
    /// * `first`: as for [`advance`]
    #[inline]
    pub fn next_from_light<'v, V: Volume<'v>>(
        &mut self,
        scene: &'v Scene,
        emitted: &LightLeSample,
        surface: &mut SurfaceInteraction,
        first: &mut Option<Interaction>,
        observer: &mut impl PathObserver,
    ) -> Option<NextVertex<'v>> {
        loop {
            if let LightStep::Vertex(vertex) =
                self.step_from_light::<V>(scene, emitted, surface, first, observer)?
            {
                return Some(vertex);
            }
        }
    }

    /// The same to the next surface, be it a hole.
    #[inline(always)]
    pub fn step_from_light<'v, V: Volume<'v>>(
        &mut self,
        scene: &'v Scene,
        emitted: &LightLeSample,
        surface: &mut SurfaceInteraction,
        first: &mut Option<Interaction>,
        observer: &mut impl PathObserver,
    ) -> Option<LightStep<'v>> {
        let state = &mut self.state;
        let is_first = state.scatterings == 0;
        let share = |p: Vec3| if is_first { emitted.share_at(p.distance(emitted.at.p())) } else { 1.0 };
        match advance(scene, state, surface, first, observer) {
            Event::Surface => {
                let share = share(surface.at.point.p);
                let mut bsdf = shade_one_way(scene, state, surface);
                let beta = state.beta;
                if pass_straight(scene, state, surface, &mut bsdf) {
                    return Some(LightStep::Passed(beta * share));
                }
                state.beta *= share;
                Some(LightStep::Vertex((bsdf, None)))
            }
            Event::Medium(at) if V::HAS_MEDIA => {
                state.beta *= share(at.p);
                Some(LightStep::Vertex((Bsdf::Null, Some(at))))
            }
            _ => None,
        }
    }

    /// The sums at the point `p` that the ray has come to [Georgiev 2012, eq. 34 and 35], with the density per area and the factor of the way back
    ///
    /// ```text
    /// p>(xi) = pdf cos_i / d^2,        g = cos_(i-1) / d^2 (eta_(i-1) / eta_i)^2
    /// ```
    ///
    /// of the distance `d` to the vertex before; without `1 / d^2` where rays are parallel.
    ///
    /// * `cosine`: between the ray and the true normal there
    /// * `collision`: mean extinction there, if it is in a medium
    pub fn mis_at<'v, V: Volume<'v>>(&self, p: Vec3, cosine: f32, collision: Option<f32>) -> PartialMis {
        self.last.sums::<V>(self.state.connectable).grown(self.growth_at::<V>(p, cosine, collision))
    }

    /// The densities and the factor of [`Subpath::mis_at`].
    #[inline(always)]
    fn growth_at<'v, V: Volume<'v>>(&self, p: Vec3, cosine: f32, collision: Option<f32>) -> Growth {
        let LastVertex { p: from, pdf, is_parallel, pdf_back, .. } = self.last;
        let thinning = if is_parallel { 1.0 } else { p.distance_squared(from).recip() };
        // The étendue cos dw n^2 of a narrow beam is the same at both ends, whatever lies between. A segment without an
        // interface ends at the index at which it began.
        let eta = if self.state.connectable { 1.0 } else { self.last.eta / self.state.media.eta() };
        let g = self.last.cosine * thinning * eta * eta;
        let connectable = self.state.connectable;
        let growth = Growth { pdf: pdf * cosine * thinning, g, pdf_back, connectable };
        if V::HAS_MEDIA { grown_through_media(growth, &self.state, collision) } else { growth }
    }

    /// What merging at the vertex before adds to `d_vc` of a vertex on a surface if that turns out to scatter into a single direction.
    fn merged_before<'v, V: Volume<'v>>(&self, p: Vec3, cosine: f32) -> f64 {
        match self.last.merged {
            merged if merged > 0.0 && self.state.connectable => {
                PartialMis { d_vcm: merged, d_vc: 0.0 }.grown(self.growth_at::<V>(p, cosine, None)).d_vc
            }
            _ => 0.0,
        }
    }

    /// The sums where the ray ends that leaves the scene: as [`Subpath::mis_at`], with densities per solid angle in place of those per area.
    pub fn mis_at_infinity<'v, V: Volume<'v>>(&self) -> PartialMis {
        let LastVertex { pdf, cosine: g, pdf_back, .. } = self.last;
        let mis = self.last.sums::<V>(self.state.connectable);
        let growth = Growth { pdf, g, pdf_back, connectable: self.state.connectable };
        mis.grown(if V::HAS_MEDIA { grown_through_media(growth, &self.state, None) } else { growth })
    }

    /// Light that the ray of a path from the camera has hit (`s = 0`).
    pub(super) fn hit(&self, radiance: Spectrum, group: LightGroup, weight: f32) -> Contribution {
        Contribution {
            technique: VertexCounts { s: 0, t: self.state.scatterings + 2 },
            is_merged: false,
            light: self.state.beta * radiance,
            weight,
            secondary_terminated: self.state.wavelengths.secondary_terminated(),
            group,
            raster: None,
        }
    }

    /// Emission of media along a path from the camera since it was taken last, and its weight: what the path meets by its own scattering is
    /// weighed against [`Subpath::volume_light`], and against no other technique.
    pub fn medium_emission(&mut self, scene: &Scene) -> (Spectrum, f32) {
        let light = std::mem::take(&mut self.state.emitted);
        if light.is_black() {
            return (light, 0.0);
        }
        (light, weight_of_emission(scene, &self.state, self.last.p, self.last.pdf))
    }

    /// The same as a contribution.
    pub(super) fn medium_contribution(&mut self, scene: &Scene) -> Contribution {
        let (light, weight) = self.medium_emission(scene);
        Contribution { light, ..self.hit(Spectrum::BLACK, LightGroup::default(), weight) }
    }

    /// Hands over the light of media that comes directly to a vertex of a path from the camera, and goes on from there, with the wavelengths
    /// that it was found under.
    ///
    /// * `surface`, `collision`: as for [`Subpath::scatter_at`]
    pub fn volume_light<'v, V: Volume<'v>, O: PathObserver>(
        &self,
        scene: &Scene,
        vertex: &Vertex<'v, V>,
        surface: &SurfaceInteraction,
        collision: Option<&MediumInteraction<'_>>,
        observer: &mut O,
        found: impl FnMut(Spectrum, &Wavelengths, &mut O),
    ) {
        let Some(mut drawn) = VolumeDirection::sample(scene, &self.state, vertex.at.p) else { return };
        let (wi, pdf) = (drawn.wi, drawn.pdf);
        let weight = power_heuristic(pdf, vertex.pdf(vertex.wo, wi));
        let mark = observer.mark();
        match collision {
            Some(at) => drawn.follow_phase(at, at.phase.eval(at.wo, wi), weight, observer),
            None => {
                let (scattered, local) = (vertex.gathered(wi), vertex.local(vertex.wo).to_local(wi));
                let Some(local) = local.filter(|_| !scattered.is_black()) else { return };
                drawn.follow(surface, (local, vertex.side(wi) == 1), scattered, weight, observer);
            }
        }
        drawn.emission(scene, observer, found);
        observer.back_to(mark);
    }

    /// The path's vertex on a surface.
    ///
    /// * `group`: the light group of a path from a light
    pub fn vertex<'b, V: Volume<'b>>(
        &self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        bsdf: Bsdf<'b>,
        group: LightGroup,
    ) -> Vertex<'b, V> {
        let &SurfaceInteraction { at, wo, u, ref interface, .. } = surface;
        let media = self.state.media;
        let beyond = interface.as_ref().map_or(media, |interface| media.across(interface));
        let sides = [media, beyond];
        Vertex {
            at: at.point,
            shading: scene.shading(&at, u),
            bsdf,
            wo,
            beta: self.state.beta,
            mis: self.mis_at::<V>(at.point.p, at.point.ng.dot(wo).abs(), None),
            sigma_a: sides.each_ref().map(|media| media.absorption().unwrap_or(Spectrum::BLACK)),
            eta: sides.each_ref().map(|media| media.eta_of_segment(scene)),
            secondary_terminated: self.state.wavelengths.secondary_terminated(),
            group,
            merged_at: None,
            volume: V::of(|| WithMedia {
                phase: None,
                sigma_t: 1.0,
                r_u: self.state.lanes.r_u,
                media: sides,
                merged: self.merged_before::<V>(at.point.p, at.point.ng.dot(wo).abs()),
            }),
        }
    }

    /// The path's vertex in a medium.
    ///
    /// * `group`: the light group of a path from a light
    pub fn vertex_in_medium<'b, V: Volume<'b>>(
        &self,
        scene: &Scene,
        at: &MediumInteraction<'b>,
        group: LightGroup,
    ) -> Vertex<'b, V> {
        let PathState { media, lanes, .. } = self.state;
        let eta = media.eta_of_segment(scene);
        Vertex {
            at: SurfacePoint { p: at.p, ..SurfacePoint::default() },
            shading: Shading::default(),
            bsdf: Bsdf::Null,
            wo: at.wo,
            beta: self.state.beta,
            mis: self.mis_at::<V>(at.p, 1.0, Some(lanes.sigma_t)),
            sigma_a: [media.absorption().unwrap_or(Spectrum::BLACK); 2],
            eta: [eta; 2],
            secondary_terminated: self.state.wavelengths.secondary_terminated(),
            group,
            merged_at: None,
            volume: V::of(|| WithMedia {
                phase: Some(at.phase),
                sigma_t: lanes.sigma_t,
                r_u: lanes.r_u,
                media: [media; 2],
                merged: 0.0,
            }),
        }
    }

    /// Goes on from a vertex, on a surface or in a medium; `false` when the path ends there.
    ///
    /// * `collision`: where that came before the surface
    #[inline]
    pub fn scatter_at<'v, V: Volume<'v>>(
        &mut self,
        vertex: &Vertex<'v, V>,
        surface: &SurfaceInteraction,
        collision: Option<&MediumInteraction<'_>>,
        roulette: bool,
        observer: &mut impl PathObserver,
    ) -> bool {
        match collision {
            Some(at) if V::HAS_MEDIA => self.scatter_in_medium(vertex, at, roulette, observer),
            _ => self.scatter(vertex, surface, roulette, observer),
        }
    }

    /// Goes on from a vertex in a medium along a direction drawn by its phase function; `false` when the path ends there.
    ///
    /// Takes two numbers, and one for roulette where it is played.
    pub fn scatter_in_medium<'v, V: Volume<'v>>(
        &mut self,
        vertex: &Vertex<'v, V>,
        at: &MediumInteraction<'_>,
        roulette: bool,
        observer: &mut impl PathObserver,
    ) -> bool {
        let state = &mut self.state;
        let sample = at.phase.sample(at.wo, state.draws.next_2d(), state.lanes.hero);
        follow_phase(state, at, sample, observer);
        // Densities of directions stand in `pdf` alone, as means over the lanes.
        state.lanes.r_l = state.lanes.r_u;
        state.lanes.sigma_t_from = state.lanes.sigma_t;
        self.last = LastVertex {
            p: at.p,
            pdf: sample.value.pdf,
            is_parallel: false,
            cosine: 1.0,
            eta: state.media.eta(),
            // Phase functions are symmetric.
            pdf_back: sample.value.pdf,
            mis: vertex.mis,
            merged: vertex.volume.with_media().map_or(0.0, |volume| volume.merged),
        };
        let bounces = state.scatterings;
        survives_in_medium(state, bounces, roulette, 1.0)
    }

    /// Goes on from a vertex along a direction drawn by its scattering; `false` when the path ends there.
    ///
    /// Takes three numbers, and one for roulette where it is played.
    pub fn scatter<'v, V: Volume<'v>>(
        &mut self,
        vertex: &Vertex<'v, V>,
        surface: &SurfaceInteraction,
        roulette: bool,
        observer: &mut impl PathObserver,
    ) -> bool {
        let state = &mut self.state;
        let (u, choice) = (state.draws.next_2d(), state.draws.next_1d());
        let local = vertex.local(vertex.wo);
        let bumped = local.bumped(&vertex.bsdf);
        let bsdf = bumped.as_ref().unwrap_or(&vertex.bsdf);
        let Some(mut sample) = bsdf.sample(local.wo, u, choice, state.mode) else { return false };
        let Some(wi) = local.to_world(&sample) else { return false };
        let same_frame = vertex.shading.is_shared(vertex.wo, wi);
        let delta = sample.kind.delta;
        if state.mode == Transport::Importance {
            // The frame belongs to the camera's side, which may see another one.
            if same_frame {
                state.beta *= vertex.correction(local.wo, sample.wi, wi);
            } else if delta {
                return false;
            } else {
                sample.weight = vertex.passed_on(wi) * sample.pdf.recip();
            }
        }
        let pdf_back = match (delta, same_frame) {
            (false, _) => vertex.pdf(wi, vertex.wo),
            (true, true) => reversed(&sample, local.wo),
            (true, false) => 0.0,
        };
        self.last = LastVertex {
            p: vertex.at.p,
            pdf: sample.pdf,
            is_parallel: false,
            cosine: vertex.cosine(wi),
            eta: 1.0,
            pdf_back,
            mis: if delta { vertex.as_specular() } else { vertex.mis },
            merged: 0.0,
        };
        follow(state, surface, wi, &sample, observer);
        if V::HAS_MEDIA {
            state.lanes.sigma_t_from = 1.0;
        }
        self.last.eta = state.media.eta();
        let bounces = state.scatterings;
        survives(state, bounces, roulette)
    }
}

/// The counterpart of `sample.pdf` for the reverse direction of a specular event.
///
/// Both are probabilities. Their ratio as densities is that of the solid angles of a narrow beam on both sides,
/// `cos dw eta^2 = cos' dw' eta'^2`.
fn reversed(sample: &BsdfSample, wo: Vec3) -> f32 {
    sample.pdf * wo.z.abs() / (sample.wi.z.abs() * sample.eta * sample.eta)
}
