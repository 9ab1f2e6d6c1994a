//! The line at the bottom: the newest message, how the trace goes, how fast one flies.

use std::time::Duration;

use egui::{Align, Id, Label, Layout, RichText, Ui};
use kajo::session::Status;
use kajo::{ClampedLight, LARGEST_R_HAT};

use super::theme;
use crate::state::{Shown, Studio};

/// The whole line.
pub fn show(ui: &mut Ui, studio: &Studio) {
    // As high as a widget, whatever is written in it.
    ui.horizontal(|ui| ui.with_layout(Layout::right_to_left(Align::Center), |ui| line(ui, studio)));
}

fn line(ui: &mut Ui, studio: &Studio) {
    let speed = studio.navigation.speed;
    ui.label(RichText::new(format!("speed {speed:.2}")).color(theme::quiet(ui)))
        .on_hover_text("World units a second; the wheel changes it");
    ui.separator();
    trace(ui, studio);
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| message(ui, studio));
}

/// What is going on, or the newest message, as much of it as there is room for.
fn message(ui: &mut Ui, studio: &Studio) {
    if studio.is_loading() || is_long(ui, studio.is_compiling()) {
        ui.spinner();
        ui.label("Reading the scene...");
    } else if let Some(notice) = &studio.notice {
        let color = if notice.is_error { theme::error(ui) } else { theme::quiet(ui) };
        ui.add(Label::new(RichText::new(&notice.text).color(color)).truncate());
    }
}

/// Whether something has been going on for so long that one should say so.
fn is_long(ui: &Ui, is_going_on: bool) -> bool {
    /// In seconds.
    const LONG: f64 = 0.3;
    let id = Id::unique("since when the scene is being read");
    if !is_going_on {
        ui.data_mut(|data| data.remove::<f64>(id));
        return false;
    }
    let now = ui.input(|input| input.time);
    let since = ui.data_mut(|data| *data.get_temp_mut_or_insert_with(id, || now));
    ui.ctx().request_repaint_after(Duration::from_secs_f64(LONG));
    now - since >= LONG
}

fn trace(ui: &mut Ui, studio: &Studio) {
    let Some(frame) = studio.picture() else {
        ui.label(RichText::new("Enter traces").color(theme::quiet(ui)));
        return;
    };
    let stats = frame.stats();
    let [width, height] = frame.size();
    let text = format!(
        "{width} x {height}, {}, {} rays/s, {:.2} s",
        samples(frame.samples()),
        in_short(frame.rays_per_second()),
        stats.seconds
    );
    if let Some(r_hat) = frame.r_hat().filter(|_| frame.samples() > 0) {
        chains(ui, r_hat);
    }
    if let Some(clamped) = frame.clamped() {
        ui.label(RichText::new(of_clamp(&clamped)).color(theme::quiet(ui))).on_hover_text(format!(
            "{} samples brought more scattered light than {}, the limit of `clamp`. The picture is darker by what was taken away.",
            clamped.count, clamped.limit
        ));
        ui.separator();
    }
    match studio.tracer.status() {
        Status::Running { progress } => {
            ui.add(
                egui::ProgressBar::new(progress)
                    .desired_width(110.0)
                    .desired_height(8.0)
                    .fill(theme::accent(ui)),
            );
            ui.label(text);
        }
        Status::Failed(error) => {
            ui.label(RichText::new(error.to_string()).color(theme::error(ui)));
        }
        Status::Cancelled => {
            ui.label(format!("stopped: {text}"));
        }
        Status::Idle | Status::Finished => {
            let seen = if studio.shown == Shown::Traced { "" } else { " (Space shows it)" };
            ui.label(format!("{text}{seen}"));
        }
    }
}

/// Whether groups of Markov chains agree.
fn chains(ui: &mut Ui, r_hat: f64) {
    let agree = r_hat <= LARGEST_R_HAT;
    let color = if agree { theme::quiet(ui) } else { theme::warning(ui) };
    ui.label(RichText::new(of_chains(r_hat)).color(color)).on_hover_text(
        "How far groups of Markov chains differ in where they find light: 1 is not at all. Above 1.05 parts of the picture may be \
         too bright or too dark, even where it looks clean; more samples help.",
    );
    ui.separator();
}

/// The largest share of red, green and blue that was taken away.
fn of_clamp(clamped: &ClampedLight) -> String {
    let share = clamped.taken.into_iter().fold(0.0, f64::max);
    format!("clamp takes {:.2} %", 100.0 * share)
}

fn of_chains(r_hat: f64) -> String {
    let verdict = if r_hat <= LARGEST_R_HAT { "chains agree" } else { "chains disagree" };
    let figures = if r_hat > 10.0 { "above 10".to_owned() } else { format!("{r_hat:.3}") };
    format!("{verdict}, R-hat {figures}")
}

fn samples(count: u32) -> String {
    match count {
        0 => "coarse".to_owned(),
        1 => "1 sample".to_owned(),
        n => format!("{n} samples"),
    }
}

/// `12.3 M`
fn in_short(count: f64) -> String {
    match count {
        n if n >= 1e9 => format!("{:.1} G", n / 1e9),
        n if n >= 1e6 => format!("{:.1} M", n / 1e6),
        n if n >= 1e3 => format!("{:.1} k", n / 1e3),
        n => format!("{n:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let words: Vec<String> = [999.0, 12_345.0, 5.67e6, 2.1e9].map(in_short).to_vec();
        assert_eq!(words, ["999", "12.3 k", "5.7 M", "2.1 G"]);
        let of_chains: Vec<String> = [1.004, 1.06, f64::INFINITY].map(of_chains).to_vec();
        let expected =
            ["chains agree, R-hat 1.004", "chains disagree, R-hat 1.060", "chains disagree, R-hat above 10"];
        assert_eq!(of_chains, expected);
        assert_eq!([0, 1, 16].map(samples), ["coarse", "1 sample", "16 samples"]);
    }
}
