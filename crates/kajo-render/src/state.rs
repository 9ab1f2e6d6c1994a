//! What many samples share: made before they are taken, and never changed by them.
//!
//! A photon map, a table of paths to start Markov chains from: such state belongs to a *part* of the samples, `n` of each pixel
//! for an integrator that says so with [`PixelIntegrator::samples_per_state`]. Part `k` is positions `k n` to `(k + 1) n - 1` of
//! each pixel's samples, and
//!
//! ```text
//! state = function of (scene, seed, k)
//! ```
//!
//! So whoever takes a unit of work can make its state again: a render that goes on from a checkpoint, or another machine. Neither
//! threads nor tiles nor the moment at which a pass ends can change a bit of it.

use crate::{PixelIntegrator, RayCounters, SamplesPerState, Setup, SetupError};

/// The parts' states of an integrator, one at a time: the newest is kept until another one is asked for.
pub struct States<'i, I: ?Sized> {
    integrator: &'i I,
    current: Option<(u32, Box<dyn PixelIntegrator + 'i>)>,
}

impl<'i, I: PixelIntegrator + ?Sized> States<'i, I> {
    /// None is made yet.
    pub fn new(integrator: &'i I) -> States<'i, I> {
        States { integrator, current: None }
    }

    /// One past the last position of the part that a position belongs to.
    pub fn end_of_part(&self, position: u32) -> u32 {
        self.integrator.samples_per_state().unwrap_or(SamplesPerState::All).end_of_part(position)
    }

    /// The integrator with the state of the part that a position belongs to, which is made unless it is kept; `None` for an integrator without
    /// any.
    ///
    /// * `rays`: those cast for it are added
    ///
    /// # Errors
    /// [`SetupError`]; then no state is kept.
    pub fn at(
        &mut self,
        position: u32,
        setup: &Setup<'_>,
        rays: &mut RayCounters,
    ) -> Result<Option<&(dyn PixelIntegrator + 'i)>, SetupError> {
        let Some(samples) = self.integrator.samples_per_state() else { return Ok(None) };
        let k = samples.part_of(position);
        if self.current.as_ref().is_none_or(|&(part, _)| part != k) {
            // The last one makes room.
            self.current = None;
            let made = self.integrator.with_state(k, setup)?;
            *rays += made.rays;
            made.notes.iter().for_each(|note| setup.progress.note(note));
            self.current = Some((k, made.integrator));
        }
        Ok(self.current.as_ref().map(|(_, integrator)| &**integrator))
    }
}

#[cfg(test)]
mod tests;
