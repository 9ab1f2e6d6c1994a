//! The transport core: the steps that every integrator takes along a path, from a camera or from a light.
//!
//! Integrators estimate sums over paths `x0 x1 ... xn` of
//!
//! ```text
//! f(x0 .. xn) = product of emission, scattering f |cos|, transmittance T and sensitivity
//! ```
//!
//! by growing a path one vertex after the other, with `beta` the product so far over the density of what was drawn.
//! What differs between them is what they add at a vertex and how they weigh it. What they share is here, as free
//! functions over the immutable [`Scene`](kajo_core::scene::Scene), a plain [`PathState`] and small records:
//!
//! ```text
//!        extend ─▶ Event ─▶ Surface ─▶ cross_hidden ─▶ shade ─▶ pass_straight ─▶ (integrator: sample) ─▶ follow ─▶ survives
//!          ▲         │                      │                         │                                              │
//!          │         └▶ Escaped, Absorbed   │                         │                                              │
//!          └────────────────────────────────┴─────────────────────────┴──────────────────────────────────────────────┘
//! ```
//!
//! * [`steps::extend`]: one ray to what stops it, weakened by the medium along it
//! * [`steps::cross_hidden`]: through an interface that is hidden in a medium of higher priority; [`advance`] repeats both up to a surface
//!   that is there
//! * [`shade`]: how the surface scatters
//! * [`pass_straight`]: through a hole or a pane without an event
//! * [`sample_light`], [`connect`]: a light drawn for a vertex, and what comes along a segment to it
//! * [`follow_phase`], [`connect_through_media`]: the same in media, where [`Event::Medium`] is a collision that scatters
//! * [`EquiangularRay`]: light drawn for a point of a ray through a medium
//! * [`VolumeDirection`]: a direction drawn towards media that emit, and their light along it
//! * [`ManifoldWalk`]: a light drawn for a vertex that stands behind clear boundaries, and the chain of refractions that joins both
//! * [`follow`], [`survives`]: on along a scattered direction, and Russian roulette
//!
//! [`advance`] and [`sample_light`] combine steps for callers that follow one path. The steps themselves do not call the next one and do
//! not depend on their caller, so a wavefront can call each of them over a queue of paths. The order in which they take random
//! numbers is part of their contract.

mod arrival;
mod collisions;
mod curves;
mod differentials;
mod emission_points;
mod equiangular;
mod frequency;
mod lane_mis;
mod local_frame;
mod manifold;
mod media;
mod medium_stack;
mod mis;
mod null_collisions;
mod overlap;
mod path_state;
pub mod steps;
mod volume_light;

pub use arrival::{TracedSegment, arrive};
pub use collisions::{MediumInteraction, Passage, lane_densities};
pub use differentials::{leave, sky_footprint};
pub use equiangular::{CollisionOnRay, EquiangularRay, homogeneous_medium};
pub use frequency::radiance_factor;
pub use lane_mis::{LaneMis, all_lanes};
pub use local_frame::LocalFrame;
pub use manifold::{Caster, ChainStart, Link, MOST_CHAINS, ManifoldWalk, SpecularChain, Via};
pub use media::{Joining, connect_through_media, follow_phase};
pub use medium_stack::{Interface, MediumStack};
pub use mis::power_heuristic;
pub use path_state::{PathState, SurfaceInteraction};
pub use steps::{
    ChosenLight, DrawnLight, Event, advance, choose_light, connect, cross_hidden, follow, light_of_choice,
    pass_straight, sample_light, shade, survives, survives_guided, survives_in_medium,
};
pub use volume_light::{VolumeDirection, pdf_to_volumes, weight_of_emission};
