//! Light of media that emit; see `transport/volume_light.rs`.

use kajo_color::sensor;
use kajo_core::LightGroup;
use kajo_core::bsdf::{Bsdf, Transport};
use kajo_core::settings::Technique;

use super::{CameraPath, IndirectLight, PathTracer, TwoFrames};
use crate::integrator::transport::{
    LocalFrame, MediumInteraction, SurfaceInteraction, VolumeDirection, pdf_to_volumes, power_heuristic,
    weight_of_emission,
};
use crate::trail::PathObserver;

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// Adds the light that media gave on the way of a path since it was taken last.
    pub(super) fn add_medium_emission(&mut self, path: &mut CameraPath<'s>) {
        let emitted = std::mem::take(&mut path.state.emitted);
        if emitted.is_black() || (C::IS_ASKED && !self.indirect.counts_lights()) {
            return;
        }
        let (scene, from) = (self.scene(), path.receiver.p);
        let weight = match self.settings.technique {
            Technique::Scattering => 1.0,
            Technique::Lights if pdf_to_volumes(scene, &path.state, from) > 0.0 => 0.0,
            Technique::Lights => 1.0,
            Technique::Combined => weight_of_emission(scene, &path.state, from, path.pdf),
        };
        if weight > 0.0 {
            self.add_hit(&path.state, emitted * weight, LightGroup::default());
        }
    }

    /// Adds the light of one light, and of media that emit, that comes directly to a surface and goes on from there.
    pub(super) fn add_drawn_light(
        &mut self,
        path: &mut CameraPath<'s>,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'s>,
        local: &LocalFrame,
    ) {
        self.add_direct_light(path, surface, bsdf, local);
        if path.state.carries_media {
            self.add_volume_light(path, surface, bsdf, local);
        }
    }

    /// Adds light of media that comes directly to a surface and goes on from there.
    #[cold]
    #[inline(never)]
    fn add_volume_light(
        &mut self,
        path: &CameraPath<'s>,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'s>,
        local: &LocalFrame,
    ) {
        let drawn = VolumeDirection::sample(self.scene(), &path.state, surface.at.point.p);
        let Some(mut drawn) = drawn else { return };
        let (world, pdf) = (drawn.wi, drawn.pdf);
        let Some(wi) = local.to_local(world) else { return };
        let scattered = bsdf.eval(local.wo, wi, Transport::Radiance);
        let crosses = wi.z * local.wo.z < 0.0;
        if scattered.is_black() || (crosses && self.finds_light_by_colors(path, surface)) {
            return;
        }
        let by_path = || self.pdf_of_path(bsdf, local.wo, TwoFrames { local: wi, world });
        let weight = self.weight_of_volume_light(pdf, by_path);
        let mark = self.observer.mark();
        drawn.follow(surface, (wi, crosses), scattered, weight, self.observer);
        self.add_emission_along(path, drawn);
        self.observer.back_to(mark);
    }

    /// The same at a point in a medium.
    pub(super) fn add_volume_light_in_medium(&mut self, path: &CameraPath<'s>, at: &MediumInteraction<'_>) {
        let drawn = VolumeDirection::sample(self.scene(), &path.state, at.p);
        let Some(mut drawn) = drawn else { return };
        let scattered = at.phase.eval(at.wo, drawn.wi);
        let weight = self.weight_of_volume_light(drawn.pdf, || scattered.pdf);
        let mark = self.observer.mark();
        drawn.follow_phase(at, scattered, weight, self.observer);
        self.add_emission_along(path, drawn);
        self.observer.back_to(mark);
    }

    /// The weight of light along a direction that was drawn towards it.
    ///
    /// * `by_path`: the density with which the path itself goes there
    fn weight_of_volume_light(&self, pdf: f32, by_path: impl FnOnce() -> f32) -> f32 {
        if self.settings.technique == Technique::Combined { power_heuristic(pdf, by_path()) } else { 1.0 }
    }

    fn add_emission_along(&mut self, path: &CameraPath<'s>, drawn: VolumeDirection<'s>) {
        let (estimate, indirect) = (&mut self.estimate, &mut self.indirect);
        drawn.emission(self.view.scene, self.observer, |emitted, wavelengths, observer| {
            observer.emitter_met(|| sensor::to_rgb(emitted, wavelengths));
            if C::GUIDES {
                indirect.finds(emitted);
            }
            estimate.add_sensed(&path.state, wavelengths, emitted, LightGroup::default());
        });
    }
}
