//! One path while it grows, from the light or from the camera.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::RayOffset;
use kajo_core::bsdf::{Bsdf, BsdfSample, Transport};
use kajo_core::sampler::Draws;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, Vec3};

use super::Found;
use super::rivals::{Growth, Rivals};
use super::vertex::Vertex;
use crate::integrator::bodies::{Bodies, Boundary};
use crate::integrator::walk::{LARGEST_SURVIVAL, MOST_SURFACES, SAFE_BOUNCES};
use crate::trail::{About, RayKind, Witness};

/// How the present ray was found.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Where it started.
    pub from: Vec3,
    /// Density of its direction per solid angle; for parallel rays that of its place, per area across them.
    pub pdf: f32,
    /// Whether it comes from infinitely far, or one of its ends counts as if it did.
    pub is_parallel: bool,
    /// Cosine with the true surface where it started, 1 where there is none.
    pub cosine: f32,
    /// Density per solid angle of going the other way, from where the ray ends to the point before its start.
    pub back: f32,
    /// The sums of the point where it started.
    pub rivals: Rivals,
    /// Whether both ends can be connected.
    pub joins: bool,
}

/// A path while it grows.
pub struct Walk<'a, 'b, W> {
    scene: &'a Scene,
    pub draws: Draws<'b>,
    /// Who is told.
    pub witness: W,
    /// The present ray.
    pub ray: Ray,
    pub step: Step,
    /// Light that is carried, or what it will be multiplied by.
    pub beta: Spectrum,
    pub wavelengths: Wavelengths,
    mode: Transport,
    bodies: Bodies,
    /// Makes `beta` the share that is left, to decide how long the path is worth following.
    scale: f32,
    roulette: bool,
    scatterings: u32,
    /// Surfaces met so far.
    surfaces: u32,
    /// The first surface.
    pub first: Option<Interaction>,
}

/// A surface that a path has met.
pub struct Met {
    pub at: Interaction,
    boundary: Option<Boundary>,
    /// Chooses among the parts of a mixture.
    u: f32,
    /// Scattering there, where it is known already: [`Walk::passes`] asks for it where light may pass.
    bsdf: Option<Bsdf>,
}

impl<'a, 'b, W: Witness> Walk<'a, 'b, W> {
    /// A path that starts with a ray.
    ///
    /// * `mode`: which end it starts at
    /// * `beta`: what the ray carries
    /// * `bodies`: around its start
    pub fn new(
        scene: &'a Scene,
        draws: Draws<'b>,
        mode: Transport,
        (ray, step): (Ray, Step),
        ((beta, wavelengths), bodies): ((Spectrum, Wavelengths), Bodies),
        roulette: bool,
        witness: W,
    ) -> Walk<'a, 'b, W> {
        Walk {
            scene,
            draws,
            witness,
            ray,
            step,
            beta,
            wavelengths,
            mode,
            bodies,
            scale: 1.0 / wavelengths.max_lane(beta).max(f32::MIN_POSITIVE),
            roulette,
            scatterings: 0,
            surfaces: 0,
            first: None,
        }
    }

    /// Follows the ray to the next surface that is there; `None` when it leaves the scene, or carries nothing since it has
    /// met too many.
    pub fn trace(&mut self) -> Option<Met> {
        loop {
            if self.surfaces == MOST_SURFACES {
                self.beta = Spectrum::BLACK;
                return None;
            }
            self.surfaces += 1;
            let mut at = Interaction::default();
            let meets = self.scene.trace_into(None, &self.ray, &mut at);
            let (bodies, weight) = (&self.bodies, self.beta);
            let about = || About {
                eta: bodies.eta(),
                weight: sensor::to_rgb(weight, &self.wavelengths),
                light: None,
            };
            self.witness.ended(self.scene, &self.ray, meets.then_some(&at), about);
            if !meets {
                return None;
            }
            self.beta *= self.bodies.transmittance(at.hit.t);
            self.first.get_or_insert(at);
            let u = self.draws.number_if(self.scene.is_mixture(&at));
            let interior = self.scene.interior(&at, &self.wavelengths, u);
            let enters = self.ray.d.dot(at.point.ng) < 0.0;
            let boundary = interior.map(|interior| self.bodies.meet(at.primitive, interior, enters));
            let Some(hidden) = boundary.filter(|boundary| !boundary.is_real) else {
                return Some(Met { at, boundary, u, bsdf: None });
            };
            // A connection would be held up here.
            self.step.joins = false;
            self.bodies = self.bodies.beyond(&hidden);
            self.witness.next(RayKind::Transmitted);
            self.ray = at.point.ray_towards(self.ray.d, f32::INFINITY, self.ray.time, RayOffset::Auto);
        }
    }

    /// Goes straight on where the surface has a hole, or a pane that the path is to pass; `false` where it is met.
    ///
    /// The ray stays the same for the sums: connections pass holes and panes too, weakened by their share. Chances of passing
    /// are left out of the densities of all ways alike.
    pub fn passes(&mut self, met: &mut Met) -> bool {
        let scene = self.scene;
        let Met { at, boundary: None, u, bsdf } = met else { return false };
        if !scene.has_passages {
            return false;
        }
        let (draws, d) = (&mut self.draws, self.ray.d);
        let bsdf = bsdf.insert(scene.bsdf(at, &self.wavelengths, self.bodies.eta(), *u));
        let Some(share) = bsdf.cross(|| (at.crossing_cosine(d), draws.next_1d())) else { return false };
        if self.scatterings == 0 && matches!(bsdf, Bsdf::Null) {
            self.first = None;
        }
        self.beta *= share;
        self.ray = at.point.ray_towards(d, f32::INFINITY, self.ray.time, RayOffset::Auto);
        true
    }

    /// The sums at the point `p` that the ray has come to.
    ///
    /// * `cosine`: between the ray and the true normal there
    pub fn rivals(&self, p: Vec3, cosine: f32) -> Rivals {
        let Step { from, pdf, is_parallel, back, joins, .. } = self.step;
        let thinning = if is_parallel { 1.0 } else { p.distance_squared(from).recip() };
        let spread = self.step.cosine * thinning;
        self.step.rivals.grown(Growth { pdf: pdf * cosine * thinning, spread, back, joins })
    }

    /// The sums where the ray ends that leaves the scene.
    pub fn rivals_at_infinity(&self) -> Rivals {
        let Step { pdf, cosine, back, joins, rivals, .. } = self.step;
        rivals.grown(Growth { pdf, spread: cosine, back, joins })
    }

    /// Light that the ray of a path from the camera has met.
    pub fn found(&self, radiance: Spectrum, group: u8, weight: f32) -> Found {
        let is_single = self.wavelengths.secondary_terminated();
        let way = [0, self.scatterings + 2];
        Found { way, light: self.beta * radiance, weight, is_single, group, raster: None }
    }

    /// The path's point on a surface.
    pub fn vertex(&mut self, met: &Met) -> Vertex {
        let Met { at, boundary, u, bsdf } = met;
        if boundary.is_some_and(|boundary| boundary.is_dispersive()) {
            self.wavelengths.terminate_secondary();
        }
        let eta_outside = boundary.map_or_else(|| self.bodies.eta(), |boundary| boundary.eta_outside);
        let back = -self.ray.d;
        let absorption = |bodies: &Bodies| bodies.absorption().unwrap_or(Spectrum::BLACK);
        let beyond = boundary.map_or(self.bodies, |boundary| self.bodies.beyond(&boundary));
        let sides = [self.bodies, beyond];
        Vertex {
            at: at.point,
            shading: self.scene.shading(at, *u),
            bsdf: bsdf.unwrap_or_else(|| self.scene.bsdf(at, &self.wavelengths, eta_outside, *u)),
            back,
            beta: self.beta,
            rivals: self.rivals(at.point.p, at.point.ng.dot(back).abs()),
            absorption: sides.each_ref().map(absorption),
            eta: sides.each_ref().map(Bodies::eta),
            is_single: self.wavelengths.secondary_terminated(),
            group: 0,
        }
    }

    /// Goes on from a point; `false` when the path ends there.
    pub fn scatter(&mut self, vertex: &Vertex, met: &Met) -> bool {
        let (u, choice) = (self.draws.next_2d(), self.draws.next_1d());
        let local = vertex.local(vertex.back);
        let Some(mut sample) = vertex.bsdf.sample(local.wo, u, choice, self.mode) else { return false };
        let wi = local.frame.to_world(sample.wi);
        if !vertex.agrees(wi, sample.wi) {
            return false;
        }
        let same_frame = vertex.shading.is_shared(vertex.back, wi);
        if self.mode == Transport::Importance {
            // The frame belongs to the camera's side, which may see another one.
            if same_frame {
                self.beta *= vertex.correction([local.wo, sample.wi], wi);
            } else if sample.kind.delta {
                return false;
            } else {
                sample.weight = vertex.passed_on(wi) * sample.pdf.recip();
            }
        }
        let delta = sample.kind.delta;
        let back = match (delta, same_frame) {
            (false, _) => vertex.pdf(wi, vertex.back),
            (true, true) => reversed(&sample, local.wo),
            (true, false) => 0.0,
        };
        self.step = Step {
            from: vertex.at.p,
            pdf: sample.pdf,
            is_parallel: false,
            cosine: vertex.cosine(wi),
            back,
            rivals: if delta { vertex.rivals.without_last() } else { vertex.rivals },
            joins: !delta,
        };
        self.leave(vertex, met, &sample, wi);
        self.survives()
    }

    fn leave(&mut self, vertex: &Vertex, met: &Met, sample: &BsdfSample, wi: Vec3) {
        let kind = if sample.kind.transmission {
            self.witness.counters().refracted += 1;
            self.bodies = met.boundary.map_or(self.bodies, |boundary| self.bodies.beyond(&boundary));
            RayKind::Transmitted
        } else {
            self.witness.counters().reflected += 1;
            RayKind::Reflected
        };
        self.witness.next(if sample.kind.delta { kind } else { RayKind::Scattered });
        self.beta *= sample.weight;
        if self.mode == Transport::Radiance {
            // Radiance is squeezed at boundaries, which a later one undoes.
            self.scale *= sample.eta * sample.eta;
        }
        self.ray = vertex.at.ray_towards(wi, f32::INFINITY, self.ray.time, RayOffset::Auto);
        self.scatterings += 1;
    }

    /// Whether the path goes on, decided at random where it carries little.
    fn survives(&mut self) -> bool {
        let left = self.wavelengths.max_lane(self.beta) * self.scale;
        if left.is_nan() || left <= 0.0 {
            return false;
        }
        if !self.roulette || self.scatterings <= SAFE_BOUNCES {
            return true;
        }
        let chance = left.min(LARGEST_SURVIVAL);
        if self.draws.next_1d() >= chance {
            return false;
        }
        self.beta *= 1.0 / chance;
        true
    }
}

/// What stands for the density of the way back of a single direction, where `sample.pdf` stands for that of the
/// way there.
///
/// Both are probabilities. Their ratio as densities is that of the solid angles of a narrow beam on both sides,
/// `cos dw eta^2 = cos' dw' eta'^2`.
fn reversed(sample: &BsdfSample, wo: Vec3) -> f32 {
    sample.pdf * wo.z.abs() / (sample.wi.z.abs() * sample.eta * sample.eta)
}
