//! Paths that go on as three, one for each of red, green and blue, where they enter a body whose colours have very different
//! mean free paths.
//!
//! In skin red light goes five times as far as blue between two scatterings. A walk of many steps whose distances are drawn for
//! one colour is very unlikely for another, so by the balance heuristic over the lanes it brings light of about one colour, three
//! times as much, with a weight that varies from walk to walk. A walk whose estimate counts by the density of its own colour
//! alone brings the product of its albedos, which is near 1 and has little noise:
//!
//! ```text
//! beta = (beta[i] in lane i, else 0),    r_u[i] = r_l[i] = 3, else 0,    for i = red, green, blue
//! ```
//!
//! All three have the same random numbers, which makes their noise less coloured. Only paths that the camera sees enter are
//! split, so there are three at most. Light beyond the surface is found by them alone: connections to it, which have all lanes,
//! have no MIS weight against them. Wavelengths are followed four at a time as everywhere.

use kajo_color::Spectrum;
use kajo_core::settings::Directions;

use super::{CameraPath, IndirectLight, PathTracer};
use crate::integrator::transport::SurfaceInteraction;
use crate::trail::PathObserver;

/// A path behind a surface whose colours are followed one after the other.
pub(super) struct SplitPath<'s, M> {
    /// The path with all colours.
    whole: CameraPath<'s>,
    /// The observer's state there.
    mark: M,
    /// The next colour.
    lane: usize,
}

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Whether a path may be split at its next surface.
    ///
    /// * `path`: before it is scattered there
    #[inline]
    pub(super) fn may_split_colors(&self, path: &CameraPath<'s>) -> bool {
        let scene = self.scene();
        scene.appearance.has_subsurface
            && !C::IS_ASKED
            && !C::GUIDES
            && !C::WALKS
            && self.settings.directions == Directions::Scattering
            && self.settings.branches <= 1
            && self.split.is_none()
            && path.bounces == 0
            && path.state.carries_media
            && !path.state.wavelengths.is_spectral()
            && !path.state.media.separates_colors(scene)
    }

    /// Whether light from behind a surface is found only by paths that are split there.
    pub(super) fn finds_light_by_colors(&self, path: &CameraPath<'s>, surface: &SurfaceInteraction) -> bool {
        let separates = |interface| path.state.media.across(interface).separates_colors(self.scene());
        self.may_split_colors(path) && surface.interface.as_ref().is_some_and(separates)
    }

    /// Leaves a path its first colour, and keeps the others for later.
    ///
    /// * `path`: behind the surface; not black
    #[cold]
    #[inline(never)]
    pub(super) fn split_colors(&mut self, path: &mut CameraPath<'s>) {
        self.split = Some(SplitPath { whole: *path, mark: self.observer.mark(), lane: 0 });
        self.take_color(path);
    }

    /// Takes the next colour of a split path; `false` where there are no more.
    ///
    /// * `path`: the path that has ended, which is replaced
    pub(super) fn take_color(&mut self, path: &mut CameraPath<'s>) -> bool {
        let Some(split) = &mut self.split else { return false };
        let Some(lane) = (split.lane..3).find(|&lane| split.whole.state.beta[lane] > 0.0) else {
            return false;
        };
        split.lane = lane + 1;
        self.observer.back_to(split.mark);
        *path = split.whole;
        path.follow_lane(lane);
        true
    }
}

impl CameraPath<'_> {
    /// Makes it carry one lane, whose density alone its weight counts by.
    fn follow_lane(&mut self, lane: usize) {
        let mut chosen = [0.0; 4];
        chosen[lane] = 1.0;
        let chosen = Spectrum::from(chosen);
        let state = &mut self.state;
        state.beta *= chosen;
        state.lanes.hero = lane as u32;
        state.lanes.r_u = chosen * 3.0;
        state.lanes.r_l = state.lanes.r_u;
        state.connectable = false;
    }
}
