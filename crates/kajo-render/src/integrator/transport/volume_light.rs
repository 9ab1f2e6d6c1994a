//! Light of media that emit, found in two ways: by rays that scattering draws, and by rays drawn towards it.
//!
//! What media give along a direction `w` is added up by a ray that is followed to its first collision or surface, whichever way
//! its direction was drawn [Simon et al. 2017]. At a vertex scattering draws it with the density `p`, and
//! [`EmissiveVolumes`](kajo_core::medium::EmissiveVolumes) do with `q`. Light found by scattering counts
//!
//! ```text
//! w = p^2 / (p^2 + q^2)                                               [Veach 1997, eq. 9.15]
//! ```
//!
//! and that of the other ray what is left of 1. Both densities are of the direction alone, so all light along a ray has one weight, and both
//! rays go through surfaces, media and null collisions by the same steps.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::bsdf::{BsdfSample, ScatterKind};
use kajo_core::medium::{PhaseSample, phase::PhaseValue};
use kajo_core::scene::{Interaction, Scene};
use kajo_math::Vec3;

use super::{
    Event, MediumInteraction, PathState, SurfaceInteraction, advance, follow, follow_phase, pass_straight,
    power_heuristic, shade,
};
use crate::trail::PathObserver;

/// Tells the random numbers of these rays from those of branches.
const TO_VOLUMES: u32 = 0x70F1;

/// A direction drawn towards media that emit, for a ray that branches off a path.
#[derive(Clone, Copy, Debug)]
pub struct VolumeDirection<'s> {
    /// The path at the vertex that it branches off, with random numbers of the ray's own.
    pub state: PathState<'s>,
    /// Unit direction in world space.
    pub wi: Vec3,
    /// Density per solid angle.
    pub pdf: f32,
}

impl<'s> VolumeDirection<'s> {
    /// Draws one; `None` where there are no such media. The path's own random numbers stay what they are.
    ///
    /// * `path`: that has come to the vertex
    /// * `from`: the vertex
    pub fn sample(scene: &Scene, path: &PathState<'s>, from: Vec3) -> Option<VolumeDirection<'s>> {
        let volumes = scene.emissive_volumes();
        if volumes.is_empty() {
            return None;
        }
        let mut draws = path.draws.split(TO_VOLUMES, 0, 1);
        let (u, v) = (draws.next_2d(), draws.next_2d());
        let (wi, pdf) = volumes.sample(from, u, v)?;
        Some(VolumeDirection { state: PathState { draws, differential: None, ..*path }, wi, pdf })
    }

    /// Goes into it from a surface.
    ///
    /// * `in_frame`: the direction in the frame in which the surface scatters
    /// * `crosses`: whether it leads to the other side
    /// * `scattered`: `f |cos|` for the direction
    /// * `weight`: of the light that is found
    pub fn follow(
        &mut self,
        surface: &SurfaceInteraction,
        (in_frame, crosses): (Vec3, bool),
        scattered: Spectrum,
        weight: f32,
        observer: &mut impl PathObserver,
    ) {
        let kind = ScatterKind { transmission: crosses, delta: false, straight: false };
        let weight = scattered * (weight / self.pdf);
        let sample = BsdfSample { wi: in_frame, weight, pdf: self.pdf, kind, eta: 1.0 };
        follow(&mut self.state, surface, self.wi, &sample, observer);
    }

    /// Goes into it from a point in a medium.
    ///
    /// * `scattered`: the phase function for the direction
    /// * `weight`: of the light that is found
    pub fn follow_phase(
        &mut self,
        at: &MediumInteraction<'_>,
        scattered: PhaseValue,
        weight: f32,
        observer: &mut impl PathObserver,
    ) {
        // All lanes have drawn it alike.
        let value = PhaseValue { pdf: self.pdf, colors: None };
        follow_phase(&mut self.state, at, PhaseSample { wi: self.wi, value }, observer);
        self.state.beta *= scattered.value() * (weight / self.pdf);
    }

    /// Hands over the light that media give along it, with the wavelengths that it was found under, as far as a path that is scattered
    /// there would find it with a weight below 1.
    pub fn emission<O: PathObserver>(
        self,
        scene: &Scene,
        observer: &mut O,
        mut found: impl FnMut(Spectrum, &Wavelengths, &mut O),
    ) {
        let mut state = self.state;
        let mut surface = SurfaceInteraction::default();
        loop {
            let (emitted, meets_surface) = emission_up_to_surface(scene, &mut state, &mut surface, observer);
            // Behind a hidden surface a path finds all of the light.
            if !state.connectable {
                return;
            }
            if !emitted.is_black() {
                found(emitted, &state.wavelengths, observer);
            }
            if !meets_surface || !passes(scene, &mut state, &surface) {
                return;
            }
        }
    }
}

/// What media give along the path's ray to its next event, and whether that is a surface.
#[inline(never)]
fn emission_up_to_surface(
    scene: &Scene,
    path: &mut PathState<'_>,
    surface: &mut SurfaceInteraction,
    observer: &mut impl PathObserver,
) -> (Spectrum, bool) {
    // No one asks for the first surface.
    let mut first = Some(Interaction::default());
    let event = advance(scene, path, surface, &mut first, observer);
    (std::mem::take(&mut path.emitted), matches!(event, Event::Surface))
}

/// Whether the path goes straight on through a surface, which it then does.
#[inline(never)]
fn passes(scene: &Scene, path: &mut PathState<'_>, surface: &SurfaceInteraction) -> bool {
    if !scene.appearance.has_passages {
        return false;
    }
    if surface.is_dispersive() && path.wavelengths.is_spectral() {
        path.end_secondary_wavelengths();
    }
    let mut bsdf = shade(scene, path, surface);
    pass_straight(scene, path, surface, &mut bsdf)
}

/// The density with which light that media give along the ray of a path might have been found by [`VolumeDirection::sample`].
///
/// * `from`: the last vertex of the path
pub fn pdf_to_volumes(scene: &Scene, path: &PathState<'_>, from: Vec3) -> f32 {
    let volumes = scene.emissive_volumes();
    let may_be_drawn = path.connectable && path.scatterings > 0 && !volumes.is_empty();
    if may_be_drawn { volumes.pdf(from, path.ray.d) } else { 0.0 }
}

/// The weight of light that media give along the ray of a path, where it is found in both ways.
///
/// * `from`: the last vertex of the path
/// * `pdf`: density per solid angle with which it went on there
pub fn weight_of_emission(scene: &Scene, path: &PathState<'_>, from: Vec3, pdf: f32) -> f32 {
    match pdf_to_volumes(scene, path, from) {
        drawn if drawn > 0.0 => power_heuristic(pdf, drawn),
        _ => 1.0,
    }
}
