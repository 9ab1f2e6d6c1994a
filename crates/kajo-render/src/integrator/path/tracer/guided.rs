//! Directions drawn with the help of a guide, which holds where light has come from to points of the same cell.
//!
//! With the density `p_s` of scattering and `p_g` of the guide a direction is drawn by one of both, with the chances `a` and `1 - a`, and counts
//! by the density of the mixture,
//!
//! ```text
//! beta <- beta f |cos| / p,     p = a p_s + (1 - a) p_g
//! ```
//!
//! which is the balance heuristic for one sample [Veach 1997, 9.2.4]. Wherever light can come from, `p` is at least `a p_s`, so that nothing is
//! missed whatever the guide has learned. Single directions, of mirrors and clear coats, are scattering's alone.

use kajo_color::Spectrum;
use kajo_core::bsdf::{Bsdf, BsdfSample, ScatterKind, Transport};
use kajo_math::Vec2;

use super::{
    CameraPath, Fork, GuidedDirection, IndirectLight, PathTracer, SampledDirection, Shaded, Worth,
    survives_guided,
};
use crate::integrator::transport::{LocalFrame, PathState, SurfaceInteraction};
use crate::trail::PathObserver;

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Goes on from a surface: with as many branches as the path is worth, or with a probability where it is worth little; `false` when it
    /// ends or splits.
    ///
    /// Takes one number where chance decides, and those of [`PathTracer::go_on_guided`].
    pub(super) fn scatter_guided(
        &mut self,
        path: &mut CameraPath<'s>,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'s>,
        local: &LocalFrame,
    ) -> bool {
        match self.indirect.worth() {
            Worth::Survives(q) if self.settings.roulette => {
                if path.state.draws.next_1d() >= q {
                    return false;
                }
                path.state.beta *= 1.0 / q;
            }
            Worth::Splits(branches) if branches > 1 && self.settings.roulette => {
                let (surface, bsdf, local) = (*surface, *bsdf, *local);
                let mark = self.observer.mark();
                self.forks.push(Fork { path: *path, surface, bsdf, local, branches, taken: 0, mark });
                self.indirect.forks();
                return false;
            }
            _ => {}
        }
        self.go_on_guided(path, Shaded { surface, bsdf, local })
    }

    /// Takes the next branch from the last split; `false` where no more are left.
    ///
    /// * `path`: the path that has ended, which is replaced
    pub(super) fn take_guided_branch(&mut self, path: &mut CameraPath<'s>) -> bool {
        while let Some(fork) = self.forks.last_mut() {
            self.observer.back_to(fork.mark);
            let (n, i) = (fork.branches, fork.taken);
            fork.taken += 1;
            let is_last = i + 1 == n || self.observer.interrupted();
            let draws = fork.path.state.draws.split(0, i, n);
            let state = PathState { wavelengths: path.state.wavelengths, draws, ..fork.path.state };
            *path = CameraPath { state, ..fork.path };
            path.state.beta *= 1.0 / n as f32;
            let (surface, bsdf, local) = (fork.surface, fork.bsdf, fork.local);
            if is_last {
                self.forks.pop();
            }
            self.indirect.takes_branch(is_last);
            if self.go_on_guided(path, Shaded { surface: &surface, bsdf: &bsdf, local: &local }) {
                return true;
            }
        }
        false
    }

    /// How many times less the path carries than if its directions had been drawn by scattering alone.
    #[inline(always)]
    pub(super) fn gain(&self) -> f32 {
        if C::GUIDES { self.indirect.gain() } else { 1.0 }
    }

    /// Takes the path along a direction of the mixture; `false` when it ends.
    ///
    /// Takes the numbers of [`CameraPath::go_on`], after one for the choice between scattering and guide where there are both.
    fn go_on_guided(&mut self, path: &mut CameraPath<'s>, at: Shaded<'_>) -> bool {
        let (scene, settings) = (self.view.scene, self.settings);
        let Some(share) = self.indirect.share_of_scattering() else {
            return self.go_on_unguided(path, at);
        };
        let Shaded { bsdf, local, .. } = at;
        let beta = path.state.beta;
        let draws = &mut path.state.draws;
        let by_scattering = share >= 1.0 || draws.next_1d() < share;
        let (u, choice): (Vec2, f32) = (draws.next_2d(), draws.number_if(bsdf.is_choosy()));
        let (sample, wi, left) = if by_scattering {
            let drawn = bsdf.sample(local.wo, u, choice, Transport::Radiance);
            let drawn = drawn.and_then(|sample| local.to_world(&sample).map(|wi| (sample, wi)));
            let Some((mut sample, wi)) = drawn else { return self.fail(beta) };
            if sample.kind.delta {
                sample.weight *= 1.0 / share;
                (sample, wi, GuidedDirection { w: None, p: share, p_scattering: 1.0, p_guide: 0.0, beta })
            } else {
                let (p, p_guide) = self.indirect.mixed(wi, sample.pdf);
                let p_scattering = sample.pdf;
                sample.weight *= p_scattering / p;
                sample.pdf = p;
                (sample, wi, GuidedDirection { w: Some(wi), p, p_scattering, p_guide, beta })
            }
        } else {
            let (w, p_guide) = self.indirect.draw(u);
            let Some(wi) = local.to_local(w).filter(|wi| wi.z * local.wo.z > 0.0) else {
                return self.fail(beta);
            };
            let p_scattering = bsdf.pdf(local.wo, wi);
            let p = share * p_scattering + (1.0 - share) * p_guide;
            let weight = bsdf.eval(local.wo, wi, Transport::Radiance) * (1.0 / p);
            if !weight.is_finite() || weight.is_black() {
                return self.fail(beta);
            }
            let kind = ScatterKind { transmission: false, delta: false, straight: false };
            let sample = BsdfSample { wi, weight, pdf: p, kind, eta: 1.0 };
            (sample, w, GuidedDirection { w: Some(w), p, p_scattering, p_guide, beta })
        };
        self.indirect.leaves(&left);
        if !path.go_along(scene, settings, at, SampledDirection { sample: &sample, wi }, self.observer) {
            return false;
        }
        let plays = settings.roulette && self.indirect.worth() == Worth::Unknown;
        survives_guided(&mut path.state, path.bounces, plays, self.gain())
    }

    /// Takes the path along a direction of scattering where there is no guide.
    fn go_on_unguided(&mut self, path: &mut CameraPath<'s>, at: Shaded<'_>) -> bool {
        let draws = &mut path.state.draws;
        let (u, choice) = (draws.next_2d(), draws.number_if(at.bsdf.is_choosy()));
        let drawn = at.bsdf.sample(at.local.wo, u, choice, Transport::Radiance);
        let Some((sample, wi)) = drawn.and_then(|sample| Some((sample, at.local.to_world(&sample)?))) else {
            return false;
        };
        let drawn = SampledDirection { sample: &sample, wi };
        path.go_along(self.view.scene, self.settings, at, drawn, self.observer)
            && survives_guided(&mut path.state, path.bounces, self.settings.roulette, self.gain())
    }

    fn fail(&mut self, beta: Spectrum) -> bool {
        self.indirect.fails(beta);
        false
    }
}
