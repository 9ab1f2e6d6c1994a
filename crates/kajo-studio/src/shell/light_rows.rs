//! How light is followed: the integrator, and a row for each key that it listens to.

use egui::{DragValue, Response, Slider, Ui};
use kajo::{
    AUTO, Caustics, Directions, Gradients, INTEGRATOR_CHOICES, IntegratorName, LightChoice, PhotonMapUse,
    RayOffset, RenderSettings, Settings, SettingsKey, ShadowAttenuation, Shadows, Technique,
};

use super::widgets::{choice, option, rows, section};

/// What is about shadows and surfaces rather than paths.
const OF_SURFACES: [SettingsKey; 3] =
    [SettingsKey::Shadows, SettingsKey::ShadowAttenuation, SettingsKey::ShadeBack];

/// The section with the integrator.
pub fn light(ui: &mut Ui, asked: &mut Settings, settings: &RenderSettings) {
    section(ui, "Light", true, |ui| {
        rows(ui, "light", |ui| {
            let about = format!("How light is followed. Now: {}", settings.integrator.about);
            // Of the scene's choice it is said what it is.
            let (name, hint) = match settings.why {
                Some(why) => (AUTO, format!("{about}; `{}`: {why}", settings.integrator.name)),
                None => (settings.integrator.name, about),
            };
            option(ui, "Integrator", &hint, &mut asked.integrator, name, |ui, name| {
                choice(ui, "integrator", name, &INTEGRATOR_CHOICES.map(|name| (name, IntegratorName(name))))
            });
            let now = settings.values();
            for key in keys(settings).filter(|key| !OF_SURFACES.contains(key)) {
                light_row(ui, key, asked, &now);
            }
        });
    });
}

/// The section about shadows, for integrators that leave a choice there.
pub fn surfaces(ui: &mut Ui, asked: &mut Settings, settings: &RenderSettings) {
    let keys: Vec<_> = keys(settings).filter(|key| OF_SURFACES.contains(key)).collect();
    if keys.is_empty() {
        return;
    }
    section(ui, "Shadows and surfaces", true, |ui| {
        rows(ui, "surfaces", |ui| {
            let now = settings.values();
            keys.into_iter().for_each(|key| surface_row(ui, key, asked, &now));
        });
    });
}

/// The keys that the integrator listens to, in the order of all keys.
fn keys(settings: &RenderSettings) -> impl Iterator<Item = SettingsKey> {
    let own = settings.integrator.keys;
    SettingsKey::ALL.into_iter().filter(|key| own.contains(key))
}

fn light_row(ui: &mut Ui, key: SettingsKey, asked: &mut Settings, now: &Settings) {
    match key {
        SettingsKey::Bounces => {
            let hint = "Mirror, refracted or scattered rays in a row";
            known(ui, ["Bounces", hint], &mut asked.bounces, now.bounces, |ui, bounces| {
                ui.add(Slider::new(bounces, 0..=32).clamping(egui::SliderClamping::Never))
            });
        }
        SettingsKey::Weight => {
            let hint = "Rays that count less than this are not followed";
            known(ui, ["Least weight", hint], &mut asked.weight, now.weight, |ui, weight| {
                ui.add(Slider::new(weight, 0.0..=1.0))
            });
        }
        SettingsKey::Fresnel => {
            let hint = "Mirrors reflect by the Fresnel formula";
            known(ui, ["Fresnel", hint], &mut asked.fresnel, now.fresnel, on);
        }
        SettingsKey::TotalReflection => {
            let hint = "Light that cannot leave a dense body is reflected inside";
            known(ui, ["Total reflection", hint], &mut asked.total_reflection, now.total_reflection, on);
        }
        SettingsKey::RayOffset => {
            let hint = "How rays keep clear of the surface they leave";
            known(ui, ["Ray offset", hint], &mut asked.ray_offset, now.ray_offset, |ui, value| {
                let all = [("auto", RayOffset::Auto), ("reference", RayOffset::Reference)];
                choice(ui, "ray offset", value, &all)
            });
        }
        SettingsKey::Reach => {
            let hint = "Distance beyond which nothing occludes; 0 for none";
            let reach = now.reach.map(|reach| if reach.is_finite() { reach } else { 0.0 });
            known(ui, ["Reach", hint], &mut asked.reach, reach, |ui, reach| {
                let response = ui.add(DragValue::new(reach).range(0.0..=f32::MAX).speed(0.02));
                if *reach <= 0.0 {
                    *reach = f32::INFINITY;
                }
                response
            });
        }
        _ => path_row(ui, key, asked, now),
    }
}

fn path_row(ui: &mut Ui, key: SettingsKey, asked: &mut Settings, now: &Settings) {
    match key {
        SettingsKey::Technique => {
            let hint = "How direct light is estimated";
            known(ui, ["Direct light", hint], &mut asked.technique, now.technique, |ui, value| {
                choice(ui, "technique", value, &Technique::NAMES)
            });
        }
        SettingsKey::Directions => {
            let hint = "How directions of indirect light are drawn";
            known(ui, ["Directions", hint], &mut asked.directions, now.directions, |ui, value| {
                choice(ui, "directions", value, &Directions::NAMES)
            });
        }
        SettingsKey::LightChoice => {
            let hint = "How a light is chosen for a point";
            known(ui, ["Light choice", hint], &mut asked.light_choice, now.light_choice, |ui, value| {
                choice(ui, "light choice", value, &LightChoice::NAMES)
            });
        }
        SettingsKey::Caustics => {
            let hint = "How lights are found that shine through smooth glass";
            known(ui, ["Caustics", hint], &mut asked.caustics, now.caustics, |ui, value| {
                choice(ui, "caustics", value, &Caustics::NAMES)
            });
        }
        SettingsKey::Roulette => {
            let hint = "Paths of little weight end at random";
            known(ui, ["Roulette", hint], &mut asked.roulette, now.roulette, on);
        }
        SettingsKey::Spectral => {
            let hint = "Light is followed by wavelength: rainbows, dispersion";
            known(ui, ["Spectral", hint], &mut asked.spectral, now.spectral, on);
        }
        SettingsKey::Branches => {
            let hint = "Rays from the first surface that is no mirror";
            known(ui, ["Branches", hint], &mut asked.branches, now.branches, |ui, branches| {
                ui.add(Slider::new(branches, 1..=256).logarithmic(true))
            });
        }
        SettingsKey::Guiding => {
            let hint = "Directions are drawn by where light has come from, which is learned first";
            known(ui, ["Guiding", hint], &mut asked.guiding, now.guiding, on);
        }
        SettingsKey::Training if now.guiding == Some(true) => {
            let hint = "Samples of each pixel by which the guide learns";
            known(ui, ["Training", hint], &mut asked.training, now.training, |ui, samples| {
                ui.add(Slider::new(samples, 1..=1024).logarithmic(true))
            });
        }
        SettingsKey::Clamp => {
            let hint = "The most that a sample brings of light that was scattered, against fireflies; 0 for any amount";
            known(ui, ["Clamp", hint], &mut asked.clamp, now.clamp, |ui, clamp| {
                ui.add(DragValue::new(clamp).range(0.0..=f32::MAX).speed(0.1).max_decimals(3))
            });
        }
        _ => photon_row(ui, key, asked, now),
    }
}

fn photon_row(ui: &mut Ui, key: SettingsKey, asked: &mut Settings, now: &Settings) {
    match key {
        SettingsKey::Photons => {
            let hint = "Paths from lights for one photon map";
            known(ui, ["Photons", hint], &mut asked.photons, now.photons, |ui, photons| {
                ui.add(Slider::new(photons, 1_000..=10_000_000).logarithmic(true))
            });
        }
        SettingsKey::PhotonMap => {
            let hint = "What the photon map is used for";
            known(ui, ["Photon map", hint], &mut asked.photon_map, now.photon_map, |ui, value| {
                choice(ui, "photon map", value, &PhotonMapUse::NAMES)
            });
        }
        SettingsKey::Merging => {
            let hint = "Paths from lights are merged with those from the camera";
            known(ui, ["Merging", hint], &mut asked.merging, now.merging, on);
        }
        SettingsKey::MergeRadius => {
            let hint =
                "Radius of the first disks in which paths are merged; 0 for one that suits the picture";
            known(ui, ["Merge radius", hint], &mut asked.merge_radius, now.merge_radius, |ui, radius| {
                ui.add(DragValue::new(radius).range(0.0..=f32::MAX).speed(0.001).max_decimals(5))
            });
        }
        SettingsKey::MergeAlpha => {
            let hint = "How slowly these disks shrink; 1 for not at all";
            known(ui, ["Merge alpha", hint], &mut asked.merge_alpha, now.merge_alpha, |ui, alpha| {
                ui.add(Slider::new(alpha, 0.0..=1.0))
            });
        }
        _ => record_row(ui, key, asked, now),
    }
}

fn record_row(ui: &mut Ui, key: SettingsKey, asked: &mut Settings, now: &Settings) {
    match key {
        SettingsKey::Accuracy => {
            let hint = "The error that a record of irradiance may make, as a share";
            known(ui, ["Accuracy", hint], &mut asked.accuracy, now.accuracy, |ui, accuracy| {
                ui.add(Slider::new(accuracy, 0.001..=1.0).logarithmic(true))
            });
        }
        SettingsKey::Rays => {
            let hint = "Rays for one record of irradiance";
            known(ui, ["Rays", hint], &mut asked.rays, now.rays, |ui, rays| {
                ui.add(Slider::new(rays, 64..=65_536).logarithmic(true))
            });
        }
        SettingsKey::Gradients => {
            let hint = "What is known of how irradiance changes around a record";
            known(ui, ["Gradients", hint], &mut asked.gradients, now.gradients, |ui, value| {
                choice(ui, "gradients", value, &Gradients::NAMES)
            });
        }
        SettingsKey::ShowRecords => {
            let hint = "The irradiance and its records in place of the picture";
            known(ui, ["Show records", hint], &mut asked.show_records, now.show_records, on);
        }
        _ => surface_row(ui, key, asked, now),
    }
}

fn surface_row(ui: &mut Ui, key: SettingsKey, asked: &mut Settings, now: &Settings) {
    match key {
        SettingsKey::Shadows => {
            let hint = "Whether things cast shadows";
            known(ui, ["Shadows", hint], &mut asked.shadows, now.shadows, |ui, value| {
                let all = [
                    ("off", Shadows::Off),
                    ("opaque", Shadows::Opaque),
                    ("transparent", Shadows::Transparent),
                ];
                choice(ui, "shadows", value, &all)
            });
        }
        SettingsKey::ShadowAttenuation if now.shadows == Some(Shadows::Transparent) => {
            let hint = "How glass weakens the light that passes";
            let names = ["Attenuation", hint];
            known(ui, names, &mut asked.shadow_attenuation, now.shadow_attenuation, |ui, value| {
                let all =
                    [("by length", ShadowAttenuation::Length), ("by surface", ShadowAttenuation::Surface)];
                choice(ui, "attenuation", value, &all)
            });
        }
        SettingsKey::ShadeBack => {
            let hint = "Lights the far side of surfaces too";
            known(ui, ["Shade back", hint], &mut asked.shade_back, now.shade_back, |ui, on| {
                ui.checkbox(on, "Both sides")
            });
        }
        _ => {}
    }
}

/// A row for a value that is known, with a name and a hint.
fn known<T: Clone>(
    ui: &mut Ui,
    [name, hint]: [&str; 2],
    asked: &mut Option<T>,
    now: Option<T>,
    add: impl FnOnce(&mut Ui, &mut T) -> Response,
) {
    if let Some(now) = now {
        option(ui, name, hint, asked, now, add);
    }
}

fn on(ui: &mut Ui, on: &mut bool) -> Response {
    ui.checkbox(on, "On")
}
