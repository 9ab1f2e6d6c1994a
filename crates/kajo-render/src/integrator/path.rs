//! Path tracing [Kajiya 1986].
//!
//! The radiance along a camera ray is the integral over all paths `x0 x1 ... xn` from the camera to a light,
//!
//! ```text
//! L = sum over n of  Le(xn) prod over k of  f(xk) |cos| / p
//! ```
//!
//! estimated by one path that is prolonged by the surfaces' own scattering. At every surface the light of one emitter is
//! added as well, drawn by what it may contribute. A light that is met by chance and one that was drawn are two
//! estimates of the same light; each counts with the weight `p^2 / (p^2 + q^2)` of its density against the other's
//! [Veach and Guibas 1995]. Paths that carry little end at random, and the survivors count more [Arvo and
//! Kirk 1990].
//!
//! In spectral mode the path carries four wavelengths; where its direction comes to depend on the first of them
//! the others end.

use std::cell::Cell;

use kajo_color::Spectrum;
use kajo_core::camera::Camera;
use kajo_core::light::LightChoice;
use kajo_core::scene::Scene;
use kajo_core::settings::{Directions, Technique};
use kajo_math::Vec2;

use super::view::{View, in_white_light};
use super::walk::{LightGroups, Walk};
use crate::trail::{Counting, Witness};
use crate::{LayerSet, PixelIntegrator, PixelSample, SampleContext, Trail};

/// Options of [`Path`].
#[derive(Clone, Copy, Debug)]
pub struct PathSettings {
    /// How often light is scattered on its way from one surface to another; 0 shows what emitters light themselves.
    pub bounces: u32,
    /// Mirrors and clear boundaries that a path may meet before any other surface without a bounce being counted.
    pub free_mirrors: u32,
    /// Whether paths go on from mirrors and glass only, so that nothing but direct light is seen.
    pub only_mirrors: bool,
    /// How direct light is estimated.
    pub technique: Technique,
    /// How lights are chosen.
    pub light_choice: LightChoice,
    /// How directions are drawn.
    pub directions: Directions,
    /// Paths that go on from the first surface that is no mirror: more than one is distribution ray tracing
    /// [Cook et al. 1984].
    pub branches: u32,
    /// Whether paths of little weight end at random.
    pub roulette: bool,
    /// Whether light is followed by wavelength.
    pub spectral: bool,
}

impl Default for PathSettings {
    fn default() -> PathSettings {
        PathSettings {
            bounces: 16,
            free_mirrors: 0,
            only_mirrors: false,
            technique: Technique::Combined,
            light_choice: LightChoice::Tree,
            directions: Directions::Scattering,
            branches: 1,
            roulette: true,
            spectral: false,
        }
    }
}

/// The path tracer over one scene and one picture size.
pub struct Path<'a> {
    view: View<'a>,
    settings: PathSettings,
}

impl<'a> Path<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(scene: &'a Scene, settings: PathSettings, size: [u32; 2], layers: LayerSet) -> Path<'a> {
        Path { view: View::new(scene, size, layers).spectral(settings.spectral), settings }
    }

    /// The same through another camera than the scene's.
    pub fn through(self, camera: &'a Camera) -> Path<'a> {
        Path { view: self.view.through(camera), ..self }
    }
}

impl Path<'_> {
    fn cast<W: Witness>(&self, ctx: &mut SampleContext<'_>, raster: Vec2, witness: W) -> (PixelSample, W) {
        let mut draws = ctx.draws;
        let Some(ray) = self.view.ray(raster, &mut draws) else { return (PixelSample::default(), witness) };
        let wavelengths = self.view.wavelengths(&mut draws);
        let groups = LightGroups::default();
        let wanted = self.view.wants_light_groups().then_some(&groups);
        let mut walk = Walk::new(&self.view, &self.settings, ray, wavelengths, draws, witness);
        walk.tell_groups_apart(wanted);
        walk.witness.counters().camera += 1;
        walk.run();
        let (radiance, first, albedo) = (walk.finished(), walk.first, walk.albedo);
        if self.view.wants_albedo() {
            ctx.aux.albedo = in_white_light(albedo.unwrap_or(Spectrum::BLACK), &wavelengths);
        }
        if wanted.is_some() {
            ctx.aux.lights = groups.each_ref().map(Cell::get);
        }
        let first = first.map(|at| self.view.first_hit(&at, &mut ctx.aux));
        (PixelSample { radiance, first }, walk.witness)
    }
}

impl PixelIntegrator for Path<'_> {
    fn sample(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> PixelSample {
        let (sample, counting) = self.cast(ctx, raster, Counting::new(ctx));
        ctx.rays = counting.rays;
        sample
    }

    fn trail(&self, ctx: &mut SampleContext<'_>, _pixel: [u32; 2], raster: Vec2) -> (PixelSample, Trail) {
        self.cast(ctx, raster, Trail::default())
    }
}

#[cfg(test)]
mod tests;
