//! The panel with everything that is asked of a trace.

use egui::{DragValue, Slider, Ui};
use kajo::{CameraPose, FilterChoice, RenderSettings, SamplerKind, Settings};

use super::light_rows;
use super::widgets::{choice, option, row, rows, section};
use crate::state::{Action, PictureSize, RenderOptions};

/// All widgets.
///
/// * `own`: what the scene says
/// * `settings`: what holds now
pub fn show(ui: &mut Ui, options: &mut RenderOptions, own: &Settings, settings: &RenderSettings) {
    section(ui, "Picture", true, |ui| picture(ui, options, settings));
    light_rows::light(ui, &mut options.asked, settings);
    section(ui, "Samples", true, |ui| samples(ui, options, own, settings));
    light_rows::surfaces(ui, &mut options.asked, settings);
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
        if settings.values().show_records.is_some() {
            let hint = "Starts from the irradiance of the picture before, where only the camera moved: sooner, but not the \
                        same bits as from the beginning";
            row(ui, "Records", hint, |ui| ui.checkbox(&mut options.habits.keep_records, "Keep"));
        }
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
