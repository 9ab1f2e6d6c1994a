//! The panel with everything that is asked of a trace.

use egui::{DragValue, Slider, Ui};
use kajo::{
    CameraPose, FilterChoice, IntegratorKind, RenderSettings, SamplerKind, Settings, ShadowAttenuation,
    Shadows,
};

use super::widgets::{choice, option, row, rows, section};
use crate::state::{Action, PictureSize, RenderOptions};

/// All widgets.
///
/// * `own`: what the scene says
/// * `settings`: what holds now
pub fn show(ui: &mut Ui, options: &mut RenderOptions, own: &Settings, settings: &RenderSettings) {
    section(ui, "Picture", true, |ui| picture(ui, options, settings));
    section(ui, "Light", true, |ui| light(ui, options, settings));
    section(ui, "Samples", true, |ui| samples(ui, options, own, settings));
    section(ui, "Shadows and surfaces", true, |ui| surfaces(ui, options, settings));
    section(ui, "Machine", false, |ui| machine(ui, options));
    if !ui.ctx().text_edit_focused() && options.asked != Settings::default() {
        ui.add_space(4.0);
        if ui.button("Reset all to the scene").clicked() {
            options.asked = Settings::default();
        }
    }
}

fn picture(ui: &mut Ui, options: &mut RenderOptions, settings: &RenderSettings) {
    rows(ui, "picture", |ui| {
        row(ui, "Size", "How many pixels the traced picture has", |ui| {
            let fixed = PictureSize::Fixed(match options.habits.size {
                PictureSize::Fixed(size) => size,
                _ => settings.size,
            });
            let all = [
                ("window", PictureSize::Window),
                ("as the scene says", PictureSize::Scene),
                ("fixed", fixed),
            ];
            choice(ui, "size", &mut options.habits.size, &all)
        });
        if let PictureSize::Fixed(size) = &mut options.habits.size {
            row(ui, "Columns", "Width of the picture in pixels", |ui| side(ui, &mut size[0]));
            row(ui, "Rows", "Height of the picture in pixels", |ui| side(ui, &mut size[1]));
        }
        row(ui, "Progressive", "Starts coarse and refines while you look", |ui| {
            ui.checkbox(&mut options.habits.progressive, "Refine")
        });
        row(ui, "Downscale", "The first picture has this many times fewer columns and rows", |ui| {
            ui.add(Slider::new(&mut options.habits.downscale, 1..=32).logarithmic(true))
        });
        row(ui, "Live", "Any change starts the trace anew while it is on show", |ui| {
            ui.checkbox(&mut options.habits.live, "Restart on changes")
        });
        row(ui, "Endless", "Adds samples until you stop it", |ui| {
            ui.checkbox(&mut options.habits.endless, "No last sample")
        });
        let hint = "Albedo, motion and groups of lights too, for pixels and OpenEXR files";
        row(ui, "Layers", hint, |ui| ui.checkbox(&mut options.habits.all_layers, "Record all"));
        row(ui, "Show uv", "Picture coordinates as red and green: the first exercise of the course", |ui| {
            ui.checkbox(&mut options.uv, "Coordinates only")
        });
    });
}

/// Where the camera stands and how much it sees; what is asked for goes into `actions`.
pub fn camera(ui: &mut Ui, camera: &CameraPose, actions: &mut Vec<Action>) {
    section(ui, "Camera", true, |ui| {
        rows(ui, "camera", |ui| {
            row(ui, "Place", "Where the camera is: x, y, z", |ui| {
                let mut eye = camera.eye();
                ui.spacing_mut().item_spacing.x = 3.0;
                let drag = |ui: &mut Ui, v: &mut f64| ui.add(DragValue::new(v).speed(0.02).max_decimals(2));
                let all = drag(ui, &mut eye.x) | drag(ui, &mut eye.y) | drag(ui, &mut eye.z);
                if all.changed() {
                    actions.push(Action::SetEye(eye));
                }
                all
            });
            if let Some(angle) = camera.angle() {
                row(ui, "Field of view", "From the bottom of the picture to its top", |ui| {
                    let mut degrees = angle.to_degrees();
                    let response = ui.add(Slider::new(&mut degrees, 1.0..=170.0).suffix("°").max_decimals(1));
                    if response.changed() {
                        actions.push(Action::SetAngle(degrees.to_radians()));
                    }
                    response
                });
            }
            if let Some(mut size) = camera.size() {
                row(ui, "Height", "Of the picture, in the scene's units", |ui| {
                    let response = ui.add(DragValue::new(&mut size).range(1e-6..=1e9).speed(0.02));
                    if response.changed() {
                        actions.push(Action::SetHeight(size));
                    }
                    response
                });
            }
        });
        ui.horizontal(|ui| {
            if ui.button("Back to the scene's").clicked() {
                actions.push(Action::ResetCamera);
            }
            if ui.button("Write into the scene").clicked() {
                actions.push(Action::StoreCamera);
            }
        });
    });
}

fn side(ui: &mut Ui, pixels: &mut u32) -> egui::Response {
    ui.add(DragValue::new(pixels).range(1..=32768).speed(2.0))
}

fn light(ui: &mut Ui, options: &mut RenderOptions, settings: &RenderSettings) {
    let asked = &mut options.asked;
    let kind = settings.integrator;
    let is_classic = kind == IntegratorKind::Classic;
    rows(ui, "light", |ui| {
        option(ui, "Integrator", "How light is followed", &mut asked.integrator, kind, |ui, kind| {
            choice(ui, "integrator", kind, &IntegratorKind::NAMES)
        });
        if kind != IntegratorKind::Occlusion {
            let bounces = if is_classic { settings.classic.bounces } else { settings.path.bounces };
            let hint = "Mirror, refracted or scattered rays in a row";
            option(ui, "Bounces", hint, &mut asked.bounces, bounces, |ui, bounces| {
                ui.add(Slider::new(bounces, 0..=32).clamping(egui::SliderClamping::Never))
            });
        }
        match kind {
            IntegratorKind::Classic => {
                let hint = "Rays that count less than this are not followed";
                option(ui, "Least weight", hint, &mut asked.weight, settings.classic.weight, |ui, weight| {
                    ui.add(Slider::new(weight, 0.0..=1.0))
                });
                let hint = "Mirrors reflect by the Fresnel formula";
                option(ui, "Fresnel", hint, &mut asked.fresnel, settings.classic.fresnel, |ui, on| {
                    ui.checkbox(on, "On")
                });
                let hint = "Light that cannot leave a dense body is reflected inside";
                let value = settings.classic.total_reflection;
                option(ui, "Total reflection", hint, &mut asked.total_reflection, value, |ui, on| {
                    ui.checkbox(on, "On")
                });
            }
            IntegratorKind::Occlusion => {
                let hint = "Distance beyond which nothing occludes; 0 for none";
                let value = if settings.reach.is_finite() { settings.reach } else { 0.0 };
                option(ui, "Reach", hint, &mut asked.reach, value, |ui, reach| {
                    let response = ui.add(DragValue::new(reach).range(0.0..=f32::MAX).speed(0.02));
                    if *reach <= 0.0 {
                        *reach = f32::INFINITY;
                    }
                    response
                });
            }
            _ => paths(ui, asked, settings),
        }
    });
}

fn paths(ui: &mut Ui, asked: &mut Settings, settings: &RenderSettings) {
    let path = &settings.path;
    let hint = "How direct light is estimated";
    option(ui, "Direct light", hint, &mut asked.technique, path.technique, |ui, value| {
        choice(ui, "technique", value, &kajo::Technique::NAMES)
    });
    let hint = "How directions of indirect light are drawn";
    option(ui, "Directions", hint, &mut asked.directions, path.directions, |ui, value| {
        choice(ui, "directions", value, &kajo::Directions::NAMES)
    });
    let hint = "Paths of little weight end at random";
    option(ui, "Roulette", hint, &mut asked.roulette, path.roulette, |ui, on| ui.checkbox(on, "On"));
    let hint = "Light is followed by wavelength: rainbows, dispersion";
    option(ui, "Spectral", hint, &mut asked.spectral, path.spectral, |ui, on| ui.checkbox(on, "On"));
    if settings.integrator == IntegratorKind::Distribution {
        let hint = "Rays from the first surface that is no mirror";
        option(ui, "Branches", hint, &mut asked.branches, path.branches, |ui, branches| {
            ui.add(Slider::new(branches, 1..=256).logarithmic(true))
        });
    }
}

fn samples(ui: &mut Ui, options: &mut RenderOptions, own: &Settings, settings: &RenderSettings) {
    let asked = &mut options.asked;
    rows(ui, "samples", |ui| {
        let (kind, count) = settings.samples;
        option(ui, "Samples", "Rays through each pixel", &mut asked.samples, (kind, count), |ui, samples| {
            ui.add(
                Slider::new(&mut samples.1, 1..=4096).logarithmic(true).clamping(egui::SliderClamping::Edits),
            )
        });
        let hint = "Where in the pixel the samples lie";
        option(ui, "Sampler", hint, &mut asked.samples, (kind, count), |ui, samples| {
            choice(ui, "sampler", &mut samples.0, &SamplerKind::NAMES)
        });
        let current = asked.filter.or(own.filter).unwrap_or(FilterChoice::None);
        option(ui, "Filter", "How samples become pixels", &mut asked.filter, current, |ui, filter| {
            choice(ui, "filter", filter, &filters(*filter))
        });
        if let Some(mut radius) = radius_of(current) {
            row(ui, "Filter radius", "In pixels", |ui| {
                let response = ui.add(Slider::new(&mut radius, 0.1..=4.0).max_decimals(2));
                if response.changed() {
                    asked.filter = Some(with_radius(current, radius));
                }
                response
            });
        }
        option(ui, "Seed", "Another seed, another noise", &mut asked.seed, settings.seed, |ui, seed| {
            ui.add(DragValue::new(seed))
        });
    });
}

fn surfaces(ui: &mut Ui, options: &mut RenderOptions, settings: &RenderSettings) {
    let asked = &mut options.asked;
    let classic = &settings.classic;
    rows(ui, "surfaces", |ui| {
        option(
            ui,
            "Shadows",
            "Whether things cast shadows",
            &mut asked.shadows,
            classic.shadows,
            |ui, value| {
                let all = [
                    ("off", Shadows::Off),
                    ("opaque", Shadows::Opaque),
                    ("transparent", Shadows::Transparent),
                ];
                choice(ui, "shadows", value, &all)
            },
        );
        if classic.shadows == Shadows::Transparent {
            let hint = "How glass weakens the light that passes";
            let value = classic.shadow_attenuation;
            option(ui, "Attenuation", hint, &mut asked.shadow_attenuation, value, |ui, value| {
                let all =
                    [("by length", ShadowAttenuation::Length), ("by surface", ShadowAttenuation::Surface)];
                choice(ui, "attenuation", value, &all)
            });
        }
        let hint = "Lights the far side of surfaces too";
        option(ui, "Shade back", hint, &mut asked.shade_back, classic.shade_back, |ui, on| {
            ui.checkbox(on, "Both sides")
        });
    });
}

fn machine(ui: &mut Ui, options: &mut RenderOptions) {
    rows(ui, "machine", |ui| {
        row(ui, "Threads", "0 for one on each core", |ui| {
            ui.add(Slider::new(&mut options.habits.threads, 0..=64))
        });
        row(ui, "Turntable", "How many pictures a turntable has", |ui| {
            ui.add(Slider::new(&mut options.habits.turntable_frames, 1..=360))
        });
    });
}

/// All filters, the current one with its own radius.
fn filters(current: FilterChoice) -> [(&'static str, FilterChoice); 6] {
    let all = [
        ("none", FilterChoice::None),
        ("box", FilterChoice::Box(0.5)),
        ("tent", FilterChoice::Tent(1.0)),
        ("gaussian", FilterChoice::Gaussian(0.4)),
        ("mitchell", FilterChoice::Mitchell(2.0)),
        ("lanczos", FilterChoice::Lanczos(3.0)),
    ];
    let same = |a: &FilterChoice| std::mem::discriminant(a) == std::mem::discriminant(&current);
    all.map(|(name, filter)| (name, if same(&filter) { current } else { filter }))
}

fn radius_of(filter: FilterChoice) -> Option<f32> {
    match filter {
        FilterChoice::None => None,
        FilterChoice::Box(r)
        | FilterChoice::Tent(r)
        | FilterChoice::Gaussian(r)
        | FilterChoice::Mitchell(r)
        | FilterChoice::Lanczos(r) => Some(r),
    }
}

fn with_radius(filter: FilterChoice, r: f32) -> FilterChoice {
    match filter {
        FilterChoice::None => FilterChoice::None,
        FilterChoice::Box(_) => FilterChoice::Box(r),
        FilterChoice::Tent(_) => FilterChoice::Tent(r),
        FilterChoice::Gaussian(_) => FilterChoice::Gaussian(r),
        FilterChoice::Mitchell(_) => FilterChoice::Mitchell(r),
        FilterChoice::Lanczos(_) => FilterChoice::Lanczos(r),
    }
}
