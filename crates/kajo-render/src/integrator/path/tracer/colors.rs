//! Paths that go on as three, one for each of red, green and blue, where they enter a body in which these walk ways of their own.
//!
//! Red light goes five times as far in skin as blue before it is scattered. A walk of many steps drawn for the one is all but impossible for the other, so
//! that a path brings light of one colour only, three times as much; by the mean density of the lanes, in the denominator, it
//! varies besides from walk to walk. A walk that counts by the density of its own colour alone brings the product of its albedos,
//! which is near 1 and has little noise:
//!
//! ```text
//! beta = (beta[i] in lane i, else 0),    r_u[i] = r_l[i] = 3, else 0,    for i = red, green, blue
//! ```
//!
//! All three have the same random numbers, so that what noise is left has less of a colour. Only paths that the camera sees enter are split, so that there are
//! three at most. Light beyond the surface is found by them alone: connections to it, which have all lanes, cannot be weighed against them. Wavelengths are
//! followed four at a time as everywhere.

use kajo_color::Spectrum;
use kajo_core::settings::Directions;

use super::{CameraPath, IndirectLight, PathTracer};
use crate::integrator::transport::MediumStack;
use crate::trail::PathObserver;

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Whether a path is split where it passes a surface behind which colours walk ways of their own.
    ///
    /// * `path`: before it is scattered there
    #[inline]
    pub(super) fn may_split_colors(&self, path: &CameraPath<'s>) -> bool {
        let scene = self.scene();
        let is_plain =
            !C::IS_ASKED && !C::GUIDES && !C::WALKS && self.settings.directions == Directions::Scattering;
        scene.appearance.has_subsurface
            && is_plain
            && path.bounces == 0
            && !path.is_branch
            && self.settings.branches <= 1
            && path.state.carries_media
            && !path.state.wavelengths.is_spectral()
            && !path.state.media.separates_colors(scene)
    }

    /// Whether light from behind a surface is left to paths that go on there as one colour each.
    ///
    /// * `beyond`: media behind the surface, where the light is there
    #[inline]
    pub(super) fn leaves_to_colors(&self, path: &CameraPath<'s>, beyond: Option<&MediumStack>) -> bool {
        beyond.is_some_and(|beyond| beyond.separates_colors(self.scene())) && self.may_split_colors(path)
    }

    /// Leaves a path its first colour, and keeps the others for later.
    #[cold]
    #[inline(never)]
    pub(super) fn split_colors(&mut self, path: &mut CameraPath<'s>) {
        let whole = *path;
        let mut is_first = true;
        for lane in (0..3).filter(|&lane| whole.state.beta[lane] > 0.0) {
            let mut chosen = [0.0; 4];
            chosen[lane] = 1.0;
            let chosen = Spectrum::from(chosen);
            let mut of_color = whole;
            of_color.state.beta *= chosen;
            of_color.state.lanes.hero = lane as u32;
            of_color.state.lanes.r_u = chosen * 3.0;
            of_color.state.lanes.r_l = of_color.state.lanes.r_u;
            of_color.state.connectable = false;
            match std::mem::take(&mut is_first) {
                true => *path = of_color,
                false => self.colors.push((of_color, self.observer.mark())),
            }
        }
    }

    /// Takes the next colour of a path that was split; `false` where there are no more.
    pub(super) fn take_color(&mut self, path: &mut CameraPath<'s>) -> bool {
        let Some((next, mark)) = self.colors.pop() else { return false };
        self.observer.back_to(mark);
        *path = next;
        true
    }
}
