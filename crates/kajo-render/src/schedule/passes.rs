//! A picture in passes: after each, all of it can be seen, saved, and found good enough.
//!
//! The passes end after 1, 2, 4, ... 64 samples of each pixel and then after every further 64; in between
//! where a pass would take longer than is wanted. Where passes end does not change the picture, since its
//! sums are exact. Noise is looked at only at the ends that are always there, so that a render with a goal
//! for noise is the same for any number of threads too.
//!
//! Samplers such as the jittered one spread a fixed number of samples over a pixel row by row, so that the
//! first few of them all lie on top. Their samples are taken in an order that jumps about.

use std::{
    io::{self, Read, Write},
    ops::{ControlFlow, Range},
    time::{Duration, Instant},
};

use super::{
    Progress, RenderError, RenderSettings, RenderStats, adaptive,
    pass::{Done, PassShare, Plan, carry_out},
};
use crate::{
    Film, PixelIntegrator, SetupError,
    film::numbers::{flag, invalid, restore_array, restore_numbers, save_numbers},
    state::States,
};

/// Passes end at every power of two up to here, and then at every multiple of it.
pub(super) const REGULAR_STEP: u32 = 64;

/// Samples of each pixel before noise is believed.
pub(super) const LEAST_FOR_NOISE: u32 = 16;

/// When a picture is good enough, beside having all samples of its sampler.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// Stop when this much time has passed; but the first sample of every pixel is always taken.
    pub time: Option<Duration>,
    /// Stop when [`Film::noise`] is at most this. The film must keep [`Layer::Variance`](crate::Layer::Variance).
    pub noise: Option<f64>,
    /// Spread samples by the noise; see [`adaptive`]. The film must keep halves and the variance, and the sampler
    /// must allow for any number of samples.
    pub adaptive: bool,
    /// Longest time between two looks at the picture, as far as a single sample of each pixel allows.
    pub interval: Option<Duration>,
}

/// How far a render in passes is. With it and the film it can be continued, to the same bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Position {
    /// Samples of each pixel that the film has, as far as `limits` allow.
    pub(crate) done: u32,
    /// [`Unit::limits`] of each block of the film, once they are known.
    pub(crate) limits: Vec<[u32; 2]>,
    pub(crate) unfinished: Option<Unfinished>,
}

/// A pass that was interrupted: the film has some of its units.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unfinished {
    pub samples: Range<u32>,
    /// Side of its tiles.
    pub tile: u32,
    /// Parts that its samples were split into.
    pub ranges: u32,
    /// A bit for each unit that the film has.
    pub finished: Vec<u64>,
}

/// Renders a film in passes.
///
/// * `position`: where to begin, and afterwards where it ended; at the end of a render and after each pass the
///   film holds exactly what it says
/// * `look`: called after each pass, with what the render took so far; it may end the render
///
/// A sampler's samples without goals are the same picture as [`render`](super::render) makes of them.
///
/// # Errors
/// [`RenderError`] when the render was cancelled or ended by `look`, or a unit panicked.
pub fn render_passes<I: PixelIntegrator + ?Sized>(
    integrator: &I,
    film: &Film,
    settings: &RenderSettings,
    goal: &Goal,
    position: &mut Position,
    progress: &dyn Progress,
    look: &mut dyn FnMut(&Film, &Position, &RenderStats) -> ControlFlow<()>,
) -> Result<RenderStats, RenderError> {
    let start = Instant::now();
    let mut stats = RenderStats::default();
    let mut quota = u32::MAX;
    // A render that goes on may have been good enough before.
    if position.unfinished.is_none() && is_quiet_enough(film, goal, position.done) {
        return Ok(stats);
    }
    let mut states = States::new(integrator);
    while let Some(samples) = position.next_samples(settings, goal, quota, &|at| states.end_of_part(at)) {
        let plan = position.plan(film, settings, samples.clone());
        // Beyond what the clock can tell there is no end.
        let end = goal.time.filter(|_| position.done > 0).and_then(|time| start.checked_add(time));
        let clock = Clock { progress, end };
        let pass_start = Instant::now();
        let with_state = match states.at(samples.start, &settings.setup(&clock), &mut stats.rays) {
            Ok(with_state) => with_state,
            Err(SetupError::Cancelled) if clock.is_over() && !progress.cancelled() => return Ok(stats),
            Err(error) => return Err(RenderError::of_setup(error, stats)),
        };
        let share = position.share(film, settings, &plan, &stats);
        let finished = position.unfinished.as_ref().map_or(&[][..], |unfinished| &unfinished.finished);
        let Done { is_complete: complete, finished, stats: of_pass, failed } = match with_state {
            Some(with_state) => carry_out(with_state, film, &clock, settings, &plan, share, finished),
            None => carry_out(integrator, film, &clock, settings, &plan, share, finished),
        };
        position.unfinished = (!complete).then(|| plan.unfinished(finished));
        stats = stats.and(of_pass, start.elapsed().as_secs_f64());
        if !failed.is_empty() {
            return Err(RenderError::Panicked { failed, stats });
        }
        if !complete {
            return if clock.is_over() && !progress.cancelled() {
                Ok(stats)
            } else {
                Err(RenderError::Cancelled(stats))
            };
        }
        position.advance(film, settings, goal, samples.end);
        if look(film, position, &stats).is_break() {
            return Err(RenderError::Cancelled(stats));
        }
        if clock.is_over() || is_quiet_enough(film, goal, position.done) {
            break;
        }
        quota = quota_for(goal, pass_start.elapsed(), samples.end - samples.start);
    }
    Ok(stats)
}

impl Position {
    /// Samples of each pixel that the film has; those in noisy positions may have more, see [`Goal::adaptive`].
    pub fn samples(&self) -> u32 {
        self.done
    }

    /// Samples of each pixel that the film has once the current pass is complete.
    pub fn samples_begun(&self) -> u32 {
        self.unfinished.as_ref().map_or(self.done, |unfinished| unfinished.samples.end)
    }

    /// Whether the film has more samples than such a render takes.
    pub fn exceeds(&self, settings: &RenderSettings) -> bool {
        let most = self.most_samples().unwrap_or(settings.sampler.samples());
        self.samples_begun() > most
    }

    /// The most samples of any pixel, once noise has decided on them.
    fn most_samples(&self) -> Option<u32> {
        self.limits.iter().flatten().max().map(|&most| most.saturating_mul(2))
    }

    /// Writes the position.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut bytes = Vec::new();
        save_numbers([self.done.into()].into_iter(), &mut bytes);
        bytes.extend([u8::from(!self.limits.is_empty()), u8::from(self.unfinished.is_some())]);
        if !self.limits.is_empty() {
            save_numbers(self.limits.as_flattened().iter().map(|&n| n.into()), &mut bytes);
        }
        if let Some(Unfinished { samples, tile, ranges, finished }) = &self.unfinished {
            let numbers = [samples.start, samples.end, *tile, *ranges];
            save_numbers(numbers.into_iter().map(i128::from), &mut bytes);
            save_numbers(finished.iter().map(|&bits| bits.into()), &mut bytes);
        }
        out.write_all(&bytes)
    }

    /// Reads what [`Position::save`] wrote about the render of `film`.
    ///
    /// # Errors
    /// Those of `input`; `InvalidData` when it holds something else.
    pub fn restore(film: &Film, settings: &RenderSettings, input: &mut dyn Read) -> io::Result<Position> {
        let mut done = [0];
        restore_array(&mut done, input)?;
        let mut position = Position { done: done[0], ..Position::default() };
        let (has_limits, is_unfinished) = (flag(input)?, flag(input)?);
        if has_limits {
            position.limits = vec![[0; 2]; film.grid().len() as usize];
            restore_array(position.limits.as_flattened_mut(), input)?;
            let most = adaptive::largest_limit(settings.sampler.samples());
            if position.limits.iter().flatten().any(|&limit| limit > most) {
                return Err(invalid());
            }
        }
        if is_unfinished {
            let mut numbers = [0; 4];
            restore_array(&mut numbers, input)?;
            let [start, end, tile, ranges] = numbers;
            if start != position.done || end <= start {
                return Err(invalid());
            }
            let plan = Plan::new(film, settings, start..end, &position.limits).cut(tile, ranges);
            let mut finished = Vec::new();
            restore_numbers(plan.len().div_ceil(64) as usize, input, |_, bits| {
                finished.push(bits.try_into().map_err(|_| invalid())?);
                Ok(())
            })?;
            position.unfinished = Some(plan.unfinished(finished));
        }
        Ok(position)
    }

    /// The samples of the next pass; `None` when there are no more.
    ///
    /// * `quota`: how many at most; `end_of_part`: where a pass that begins there has to end
    fn next_samples(
        &self,
        settings: &RenderSettings,
        goal: &Goal,
        quota: u32,
        end_of_part: &dyn Fn(u32) -> u32,
    ) -> Option<Range<u32>> {
        if let Some(unfinished) = &self.unfinished {
            return Some(unfinished.samples.clone());
        }
        let end = self.end(settings, goal);
        let regular = match self.done {
            done if self.limits.is_empty() && done >= REGULAR_STEP => {
                (done / REGULAR_STEP + 1).saturating_mul(REGULAR_STEP)
            }
            done => done.saturating_add(1).checked_next_power_of_two().unwrap_or(u32::MAX),
        };
        let next = regular.min(self.done.saturating_add(quota.max(1))).min(end).min(end_of_part(self.done));
        (next > self.done).then_some(self.done..next)
    }

    /// An upper bound on the number of samples of any pixel, from what is known so far.
    pub(super) fn end(&self, settings: &RenderSettings, goal: &Goal) -> u32 {
        let samples = settings.sampler.samples();
        match self.most_samples() {
            Some(most) => most,
            None if goal.adaptive => adaptive::pilot_samples(samples).min(samples),
            None => samples,
        }
    }

    fn plan(&self, film: &Film, settings: &RenderSettings, samples: Range<u32>) -> Plan {
        let plan = Plan::new(film, settings, samples, &self.limits);
        match &self.unfinished {
            Some(unfinished) => plan.cut(unfinished.tile, unfinished.ranges),
            None => plan,
        }
    }

    fn share(&self, film: &Film, settings: &RenderSettings, plan: &Plan, stats: &RenderStats) -> PassShare {
        let pixels = plan.sampled.area();
        PassShare {
            samples: film.samples(),
            rays: stats.rays.total(),
            samples_in_all: (pixels * u64::from(settings.sampler.samples()))
                .max(film.samples() + plan.samples()),
            whole_units: true,
        }
    }

    /// Notes that a pass is complete, and decides on what follows a pilot.
    pub(super) fn advance(&mut self, film: &Film, settings: &RenderSettings, goal: &Goal, done: u32) {
        self.done = done;
        let budget = settings.sampler.samples();
        if goal.adaptive && self.limits.is_empty() && done == adaptive::pilot_samples(budget) && done < budget
        {
            self.limits = adaptive::limits(film, done, budget, goal.noise);
        }
    }
}

impl Plan {
    fn unfinished(&self, finished: Vec<u64>) -> Unfinished {
        Unfinished { samples: self.samples.clone(), tile: self.grid.side(), ranges: self.ranges, finished }
    }
}

impl RenderStats {
    /// This and what a further pass took, `seconds` after the start.
    pub(super) fn and(self, pass: RenderStats, seconds: f64) -> RenderStats {
        let mut rays = self.rays;
        rays += pass.rays;
        RenderStats { rays, samples: self.samples + pass.samples, seconds, ..pass }
    }
}

/// Progress that also ends when the time is over.
struct Clock<'a> {
    progress: &'a dyn Progress,
    end: Option<Instant>,
}

impl Clock<'_> {
    fn is_over(&self) -> bool {
        self.end.is_some_and(|end| Instant::now() >= end)
    }
}

impl Progress for Clock<'_> {
    fn done(&self, pixels_done: u64, pixels_total: u64, rays: u64) {
        self.progress.done(pixels_done, pixels_total, rays);
    }

    fn cancelled(&self) -> bool {
        self.progress.cancelled() || self.is_over()
    }

    fn note(&self, sentence: &str) {
        self.progress.note(sentence);
    }
}

/// Whether the goal for noise is reached. Adaptive renders are planned to reach it instead: stopping them by what
/// their samples show would bias them.
pub(super) fn is_quiet_enough(film: &Film, goal: &Goal, done: u32) -> bool {
    let is_regular = done >= LEAST_FOR_NOISE && (done.is_power_of_two() || done.is_multiple_of(REGULAR_STEP));
    let noise = goal.noise.filter(|_| is_regular && !goal.adaptive);
    noise.is_some_and(|goal| film.noise().is_some_and(|noise| noise <= goal))
}

/// Samples that fit into the interval, by what the last pass took.
fn quota_for(goal: &Goal, took: Duration, samples: u32) -> u32 {
    let Some(interval) = goal.interval else { return u32::MAX };
    let per_sample = took.as_secs_f64() / f64::from(samples);
    (interval.as_secs_f64() / per_sample.max(1e-9)) as u32
}

#[cfg(test)]
mod tests;
