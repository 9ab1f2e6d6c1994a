//! The geometry that light travels in, as integrators use it.
//!
//! Light goes straight but for bodies that bend it ([`crate::curved_light`]). A path carries the medium and the body that it is inside of, and these
//! decide how it is followed:
//!
//! ```text
//! outside, or in any other medium      Scene::trace_into      straight, at one frequency
//! in a medium that bends light         Scene::follow          along a curve, to the surface it meets
//! ```
//!
//! The way between two points is known where their segment meets no such body: its surface lets nothing pass of what is sent along a
//! segment, and a segment that begins inside of it is not to be asked for. What light comes through bodies that bend it, paths find by
//! themselves, and as they could not have been found by a connection ([`Followed`] is no segment) it counts in full.

use kajo_color::Wavelengths;
use kajo_math::{Aabb, Ray, Vec3};

use crate::curved_light::{Chords, ConservedQuantity, Followed, Outcome, RayState, Region};
use crate::differential::RayDifferential;
use crate::ids::ObjectId;
use crate::medium::MediumId;
use crate::scene::{Interaction, Scene};

/// How light gets from one event to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Along straight lines, at one frequency, everywhere.
    Flat,
    /// So but for the inside of some bodies.
    Curved,
}

/// A ray with those beside it.
#[derive(Clone, Copy, Debug)]
pub struct DifferentialRay<'r> {
    /// The ray.
    pub ray: &'r Ray,
    /// How neighbouring rays differ from it, if they are to be followed too.
    pub differential: Option<&'r RayDifferential>,
}

/// How light came to where it was followed to.
#[derive(Clone, Copy, Debug)]
pub struct CurveArrival {
    /// What became of it; only where it meets something is there an interaction.
    pub outcome: Outcome,
    /// Unit direction in which it arrives.
    pub d: Vec3,
    /// Length of the way.
    pub length: f32,
    /// The last chord, which ends at its `t_max`.
    pub chord: Ray,
    /// Index of refraction where it arrives.
    pub eta: f32,
    /// Radiance where the way begins over that where it ends, but for the shift of frequency: `(n / n')^2`.
    pub eta_scale: f32,
    /// Frequency where the way begins over that where it ends.
    pub g: f32,
    /// The states where it began and where it arrives, for [`Scene::conserved`].
    pub ends: [RayState; 2],
    /// How it differs there from the rays beside it; `None` unless that was asked for, and where it is not known.
    pub differential: Option<RayDifferential>,
}

impl Space {
    /// Whether the segment between any two points is a path that light takes, so that points may be connected. Where it is not, segments that
    /// begin inside of a body that bends light are no paths of light.
    #[inline]
    pub fn connects(self) -> bool {
        match self {
            Space::Flat => true,
            Space::Curved => false,
        }
    }
}

impl Scene {
    /// The geometry that light travels in.
    #[inline]
    pub fn space(&self) -> Space {
        if self.appearance.bends_light { Space::Curved } else { Space::Flat }
    }

    /// Follows light through a body that bends it, to the first surface that it meets, which may be that of the body.
    ///
    /// * `from`: starts inside of the body; its direction has unit length
    /// * `medium`: what fills the body
    /// * `at`: filled with where light arrives, if it meets anything; the hit's `t` is that of the last chord
    /// * `passed`: called with each chord that light has gone along, the last one excepted
    ///
    /// Returns `None` where the medium does not bend light.
    pub fn follow(
        &self,
        DifferentialRay { ray, differential: around }: DifferentialRay<'_>,
        medium: MediumId,
        body: ObjectId,
        wavelengths: &Wavelengths,
        at: &mut Interaction,
        passed: impl FnMut(&Ray),
    ) -> Option<CurveArrival> {
        let region = Region { bounds: self.bounds_of(body) };
        let mut chords = SceneChords { scene: self, at, passed };
        let followed =
            self.appearance.media.follow(medium, ray, around, &region, wavelengths, &mut chords)?;
        let Followed { outcome, chord, length, index, eta_scale, g, bundle, ends, .. } = followed;
        let differential = bundle.map(|bundle| match outcome {
            Outcome::Meets => bundle.on_plane(at.point.ng.as_dvec3()),
            _ => bundle.here(),
        });
        let mut d = followed.d.as_vec3();
        if outcome == Outcome::Meets {
            // Of light that grazes a surface the tangent may be on the one side and the chord on the other: it was the chord that met it.
            let from_chord = chord.d.dot(at.point.ng);
            if let Some(normals) = &followed.normals {
                let seen = |n: Vec3| (*normals * n.as_dvec3()).normalize_or_zero().as_vec3();
                (at.point.n, at.point.ng) = (seen(at.point.n), seen(at.point.ng));
            }
            if d.dot(at.point.ng) * from_chord <= 0.0 {
                d = chord.d.normalize();
            }
        }
        let [eta, eta_scale, g] = [index, eta_scale, g].map(|v| v as f32);
        Some(CurveArrival { outcome, d, length: length as f32, chord, eta, eta_scale, g, ends, differential })
    }

    /// What should be the same at both ends of a way through a body that bends light.
    ///
    /// * `ends`: [`CurveArrival::ends`]
    /// * the rest: as for [`Scene::follow`]
    pub fn conserved(
        &self,
        ends: &[RayState; 2],
        medium: MediumId,
        body: ObjectId,
        wavelengths: &Wavelengths,
    ) -> [Option<ConservedQuantity>; 3] {
        let region = Region { bounds: self.bounds_of(body) };
        self.appearance.media.conserved(medium, ends, &region, wavelengths)
    }

    /// A box around a body; around the whole scene where that has no bounds.
    fn bounds_of(&self, body: ObjectId) -> Aabb {
        let own = self.geometry.object_bounds(body);
        if own.is_finite() && !own.is_empty() { own } else { self.geometry.bounds() }
    }
}

/// The surfaces of a scene, and where the last one was met.
struct SceneChords<'a, F> {
    scene: &'a Scene,
    at: &'a mut Interaction,
    passed: F,
}

impl<F: FnMut(&Ray)> Chords for SceneChords<'_, F> {
    fn hit(&mut self, chord: &Ray) -> Option<f32> {
        self.scene.trace_into(None, chord, self.at).then_some(self.at.hit.t)
    }

    fn passed(&mut self, chord: &Ray) {
        (self.passed)(chord);
    }
}
