//! Film, integrators and the schedule of kajo.
//!
//! An integrator turns a position on the film into radiance ([`PixelIntegrator`]); [`render`] calls it for
//! every sample of every tile on all cores; a [`Film`] sums the samples exactly and develops them into
//! pictures.

mod chain_counts;
pub mod context;
pub mod film;
pub mod integrator;
mod kept_state;
pub mod order;
mod progress;
mod ray_counters;
pub mod rect;
pub mod sample;
pub mod schedule;
mod setup;
pub mod state;
pub mod trail;

pub use chain_counts::{ChainCounts, LARGEST_R_HAT};
pub use context::{Auxiliary, SampleContext, Splats};
pub use film::{
    ClampedLight, DepthMap, Film, FilmError, FilmPart, FilmSpec, Filter, Layer, LayerSet, NormalMap,
};
pub use kajo_core::light::MAX_LIGHT_GROUPS;
pub use kept_state::KeptState;
pub use progress::{Progress, Silent};
pub use ray_counters::RayCounters;
pub use rect::Rect;
pub use sample::{FirstHit, PixelIntegrator, PixelSample, SamplesPerState, WithState};
pub use schedule::{
    FailedUnit, Goal, Position, RenderError, RenderSettings, RenderStats, Unit, position_of, render,
    render_passes, render_work_unit,
};
pub use setup::{Setup, SetupError, panic_message};
pub use trail::{LightSource, RayKind, Segment, Trail, TrailHit};
