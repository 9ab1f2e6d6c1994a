//! Light that a path finds along its rays through media, besides that of collisions.

use kajo_core::settings::Technique;

use super::{CameraPath, IndirectLight, PathTracer};
use crate::integrator::transport::{EquiangularRay, Event, SurfaceInteraction, advance};
use crate::trail::PathObserver;

impl<'a: 's, 's, O: PathObserver, C: IndirectLight> PathTracer<'a, 's, O, C> {
    /// As [`advance`], through media: adds the light that these give on the way, and that of points drawn along the ray.
    #[cold]
    #[inline(never)]
    pub(super) fn advance_through_media(
        &mut self,
        path: &mut CameraPath<'s>,
        surface: &mut SurfaceInteraction,
    ) -> Event<'a> {
        let scene = self.scene();
        let start = path.state;
        path.along = None;
        let event = advance(scene, &mut path.state, surface, &mut self.estimate.first, self.observer);
        self.add_medium_emission(path);
        if C::IS_ASKED
            || path.ends_at_lights
            || self.settings.technique == Technique::Scattering
            || path.state.surfaces != start.surfaces + 1
        {
            return event;
        }
        let length = match event {
            Event::Surface => surface.length,
            Event::Medium(_) => path.state.extent,
            Event::Escaped(_) => f32::INFINITY,
            Event::Absorbed => return event,
        };
        path.along = EquiangularRay::of(scene, &start, length);
        let found = path
            .along
            .and_then(|along| along.sample(scene, &start, &mut path.state, self.lights, self.observer));
        if let Some((light, added)) = found {
            self.add(&start, added, scene.lighting.sampler.group(light));
        }
        event
    }
}
