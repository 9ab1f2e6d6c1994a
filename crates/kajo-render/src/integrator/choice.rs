//! `integrator auto`: which integrator suits a scene, and why.
//!
//! Where only one integrator carries what is in the scene, it is that one. Otherwise short trials decide, of a few
//! thousand paths each: one sends light out and counts how much of it reaches a matt surface by way of mirrors and glass, a
//! caustic, and where there is any, small pictures show whether [merging](super::hidden_light) finds light that nothing
//! else does; the other renders a small picture with and without light that surfaces send to one another. Numbers are
//! drawn from a seed of their own, so the choice is a function of the scene, the same on all machines.

use kajo_color::Wavelengths;
use kajo_core::light::{LightId, PowerLightSampler};
use kajo_core::scene::Scene;
use kajo_core::settings::IntegratorName;

use super::photon::emission::{PhotonEmission, PhotonRequest, Wanted};
use super::{
    IntegratorSpec, NAMES, Path, PathSettings, bidir, classic, hidden_light, path, small_picture, vcm,
};
use crate::{Layer, LayerSet, Setup, Silent};

/// What stands for an integrator that is chosen by the scene.
pub const AUTO: IntegratorName = IntegratorName("auto");

/// All that `integrator` may say: [`AUTO`], and the names of all integrators.
pub const CHOICES: [&str; NAMES.len() + 1] = {
    let mut choices = [AUTO.0; NAMES.len() + 1];
    let mut i = 0;
    while i < NAMES.len() {
        choices[i + 1] = NAMES[i];
        i += 1;
    }
    choices
};

/// An integrator, and why it was chosen.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// The integrator.
    pub integrator: &'static IntegratorSpec,
    /// The reason, to follow "`path`: ".
    pub why: &'static str,
}

/// Paths from lights of the first trial.
const LIGHT_PATHS: u32 = 4096;
/// Columns and rows of the picture of the second, and samples of each of its pixels.
const PICTURE: ([u32; 2], u32) = ([24, 16], 8);
/// Caustics above this share of all light are too much for paths from the camera, which find them by scattering alone.
const CAUSTIC: f32 = 0.03;
/// The same where lights have no extent, so that such paths cannot find it at all.
const CAUSTIC_OF_POINTS: f32 = 0.002;
/// Light above this share that merged paths find alone is worth what they cost.
const HIDDEN: f32 = 0.01;
/// Where lights shine on less than this share of what is seen, paths from lights find more of it.
const LIT: f32 = 0.1;

/// The integrator that suits a scene; the scene keeps the answer.
pub fn choose(scene: &Scene) -> Choice {
    let &(name, why) = scene.output.suited.get_or_init(|| {
        let choice = try_out(scene);
        (choice.integrator.name, choice.why)
    });
    Choice { integrator: IntegratorSpec::named(name).unwrap_or(&path::PATH), why }
}

fn try_out(scene: &Scene) -> Choice {
    let of = |integrator, why| Choice { integrator, why };
    if scene.relativity.is_some() {
        return of(&path::PATH, "it alone follows light between things at such speeds");
    }
    if !scene.space().connects() {
        return of(&path::PATH, "light is bent here, so that points cannot be joined by straight lines");
    }
    if scene.lighting.fog.is_some() || is_of_the_formula(scene) {
        return of(&classic::CLASSIC, "its lights, ambient light or fog are those of the classic formula");
    }
    let power_sampler = scene.power_light_sampler();
    if power_sampler.sample(0.5).is_none() {
        let why = match scene.appearance.has_emissive_media() {
            true => "its light is that of media that emit, which paths find",
            false => "nothing in it gives light",
        };
        return of(&path::PATH, why);
    }
    let caustics = caustics(scene);
    if caustics > 0.0 && hidden_light::share(scene) > HIDDEN {
        return of(
            &vcm::VCM,
            "light that comes by mirrors or glass is seen by way of these again, which merged paths alone find",
        );
    }
    if has_points(scene) && caustics > CAUSTIC_OF_POINTS {
        return of(
            &bidir::BIDIRECTIONAL,
            "light from points, which paths from the camera never meet, comes by mirrors or glass",
        );
    }
    if sky(scene, &power_sampler) > 0.5 {
        return of(&path::PATH, "most light comes from all around");
    }
    if caustics > CAUSTIC {
        return of(&bidir::BIDIRECTIONAL, "much of its light comes by mirrors or glass");
    }
    if lit(scene) < LIT {
        return of(&bidir::BIDIRECTIONAL, "little of what is seen is lit by a light itself");
    }
    of(&path::PATH, "most of what is seen is lit by lights themselves")
}

/// Whether light is meant as numbers of the classic formula: ambient light beside others, or lights that do not fade, and no surface
/// that emits.
fn is_of_the_formula(scene: &Scene) -> bool {
    let lights = &scene.lighting.lights;
    let unfading = lights.ids().any(|id| lights.is_unfading(id));
    // Scenes without lights have ambient light of their own accord.
    let has_ambient = !scene.lighting.ambient.is_black() && has_points(scene);
    let emits = lights.ids().any(|id| lights.object(id).is_some());
    !emits && (has_ambient || unfading)
}

/// Whether there are lights that rays do not hit, or hardly ever.
fn has_points(scene: &Scene) -> bool {
    let lights = &scene.lighting.lights;
    lights.ids().any(|id| lights.is_pointlike(id))
}

/// The share of light that comes from infinitely far away and all around.
fn sky(scene: &Scene, power_sampler: &PowerLightSampler) -> f32 {
    let (lights, world) = (&scene.lighting.lights, power_sampler.world());
    let all: f32 = scene.lighting.sampler.list().iter().map(|&id| lights.power(id, world)).sum();
    let surrounds = |id: &LightId| lights.is_background(*id);
    let sky: f32 = lights.ids().filter(surrounds).map(|id| lights.power(id, world)).sum();
    sky / all
}

/// The share of paths from lights, drawn in proportion to power, that come to a surface which is not specular by
/// specular events alone, at least one of them: `n_caustic / N`, the mean of an indicator over `N` paths, whose
/// standard error is below `1 / (2 sqrt(N))`.
fn caustics(scene: &Scene) -> f32 {
    const MOST_MIRRORS: u32 = 8;
    let emission = PhotonEmission::new(scene, LIGHT_PATHS, MOST_MIRRORS, false);
    let setup = Setup { seed: 0, threads: 1, memory: u64::MAX, progress: &Silent };
    let found = emission.emit(
        0,
        &Wavelengths::RGB,
        PhotonRequest { map: Wanted::Caustic, caustics: false, in_media: None, beams: None },
        &setup,
    );
    found.map_or(0.0, |batch| batch.photons.len() as f32 / LIGHT_PATHS as f32)
}

/// How much of the light of what is seen comes from lights themselves: the median over pixels of `L_direct / L`, where
/// both are means of few samples of path tracing, without and with indirect light. Pixels that show no light are left
/// out.
fn lit(scene: &Scene) -> f32 {
    let (size, samples) = PICTURE;
    let camera = &scene.output.camera;
    let direct = PathSettings { only_mirrors: true, roulette: false, ..PathSettings::default() };
    let all = PathSettings { bounces: 4, ..PathSettings::default() };
    let [direct, all] = [direct, all].map(|settings| {
        let path = Path::through(camera, scene, settings, size, LayerSet::of(&[Layer::Color]));
        small_picture::brightness(&path, size, samples)
    });
    let mut shares: Vec<f32> =
        direct.iter().zip(&all).filter(|(_, all)| **all > 0.0).map(|(direct, all)| direct / all).collect();
    shares.sort_by(f32::total_cmp);
    shares.get(shares.len() / 2).copied().unwrap_or(0.0)
}
