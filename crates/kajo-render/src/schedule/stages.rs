//! A render in units of work that may be done in any order, anywhere.
//!
//! A *stage* is a range of samples of all pixels that can be taken before the picture decides on the next. Most
//! renders have one. A goal for noise has one up to each look at the noise; adaptive sampling has a pilot and a rest.
//! A stage is cut into units, each some pixels and some of the samples, which [`render_work_unit`] puts into a film. The
//! films of all units add up ([`Film::absorb`]) to that of [`render_passes`](super::render_passes), to the bit.

use std::ops::Range;
use std::time::Instant;

use super::{
    Goal, Position, Progress, RenderError, RenderSettings, RenderStats, Unit,
    pass::{PassShare, Plan, carry_out},
    passes::{LEAST_FOR_NOISE, REGULAR_STEP, is_quiet_enough},
};
use crate::{Film, PixelIntegrator, state::States};

impl Position {
    /// The samples of the next stage; `None` when the sampler has no more.
    pub fn stage(&self, settings: &RenderSettings, goal: &Goal) -> Option<Range<u32>> {
        let end = self.end(settings, goal);
        let end = match goal.noise {
            Some(_) if !goal.adaptive => next_look(self.samples()).min(end),
            _ => end,
        };
        (end > self.samples()).then_some(self.samples()..end)
    }

    /// Notes that a film has all of [`Position::stage`], and decides on what follows.
    ///
    /// Returns whether the render is complete.
    pub fn end_stage(&mut self, film: &Film, settings: &RenderSettings, goal: &Goal) -> bool {
        if let Some(samples) = self.stage(settings, goal) {
            self.advance(film, settings, goal, samples.end);
        }
        is_quiet_enough(film, goal, self.samples()) || self.stage(settings, goal).is_none()
    }
}

/// Renders a unit of a stage and adds it to a film, on as many threads as the settings say.
///
/// * `position`: at the beginning of the stage
/// * `unit`: some samples of the stage, of some pixels; those that are not sampled are left out
///
/// # Errors
/// [`RenderError`] when the render was cancelled or a tile panicked; the film then holds some of it.
pub fn render_work_unit<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    film: &Film,
    settings: &RenderSettings,
    position: &Position,
    unit: &Unit,
    progress: &dyn Progress,
) -> Result<RenderStats, RenderError> {
    let start = Instant::now();
    let sampled = film.spec().sampled(&settings.sampler).intersection(&unit.tile);
    let mut states = States::new(integrator);
    let mut stats = RenderStats::default();
    let (mut begin, all) = (unit.samples.start, unit.samples.end);
    let in_all = Plan::over(film, settings, sampled, unit.samples.clone(), &position.limits).samples();
    loop {
        let end = states.end_of_part(begin).min(all);
        let with_state = states.at(begin, &settings.setup(progress), &mut stats.rays);
        let with_state = with_state.map_err(|error| RenderError::of_setup(error, stats))?;
        let plan = Plan::over(film, settings, sampled, begin..end, &position.limits);
        let (samples, rays) = (stats.samples, stats.rays.total());
        let share = PassShare { samples, rays, samples_in_all: in_all, whole_units: true };
        let done = match with_state {
            Some(with_state) => carry_out(with_state, film, progress, settings, &plan, share, &[]),
            None => carry_out(integrator, film, progress, settings, &plan, share, &[]),
        };
        stats = stats.and(done.stats, start.elapsed().as_secs_f64());
        match (done.failed.is_empty(), done.is_complete) {
            (false, _) => return Err(RenderError::Panicked { failed: done.failed, stats }),
            (true, false) => return Err(RenderError::Cancelled(stats)),
            (true, true) if end >= all => return Ok(stats),
            (true, true) => begin = end,
        }
    }
}

/// Samples of each pixel when the noise is looked at next; see [`render_passes`](super::render_passes).
fn next_look(done: u32) -> u32 {
    match done {
        _ if done < LEAST_FOR_NOISE => LEAST_FOR_NOISE,
        _ if done < REGULAR_STEP => (done + 1).next_power_of_two(),
        _ => (done / REGULAR_STEP + 1).saturating_mul(REGULAR_STEP),
    }
}

#[cfg(test)]
mod tests;
