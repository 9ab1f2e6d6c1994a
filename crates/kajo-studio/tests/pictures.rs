//! What the whole window looks like, against the pictures of it in the manual. They were made with Mesa's software
//! rasteriser; the tolerance leaves room for how other cards draw edges and letters.
//!
//! After a change that is meant to be seen, renew them and look at what is different:
//!
//! ```text
//! KAJO_RENEW=1 cargo test -p kajo-studio --test pictures
//! ```

mod common;

use std::path::{Path, PathBuf};

use common::Window;
use egui::{Key, vec2};
use kajo::compare::Difference;
use kajo::{EncodeOptions, Format, Image};
use kajo_studio::shell::{Bottom, Tab};
use kajo_studio::state::{Action, Compare};

/// Largest mean FLIP error of a picture. A panel that is missing makes 0.05 and more.
const TOLERANCE: f64 = 0.012;

/// Rows at the bottom that tell how long a trace took.
const STATUS_ROWS: u32 = 28;

/// What the tests leave free around the window.
const MARGIN: u32 = 8;

/// The window as it is drawn, without its last rows.
fn picture(window: &mut Window) -> Image {
    window.frames(30);
    let drawn = window.harness.render().unwrap();
    let [columns, rows] = [MARGIN..drawn.width() - MARGIN, MARGIN..drawn.height() - MARGIN - STATUS_ROWS];
    let pixel = |x, y| drawn.get_pixel(x, y).0.into_iter().take(3).map(|byte| f32::from(byte) / 255.0);
    let data = rows.clone().flat_map(|y| columns.clone().flat_map(move |x| pixel(x, y)));
    Image::from_data(columns.len() as u32, rows.len() as u32, 3, data.collect()).unwrap()
}

/// Asserts that the window looks as in the reference `name`, or makes that.
fn check(window: &mut Window, name: &str) {
    let bytes = kajo::encode(&picture(window), Format::Png, &EncodeOptions::default()).unwrap();
    let images = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/images");
    let reference = images.join(format!("studio_{name}.png"));
    if std::env::var_os("KAJO_RENEW").is_some() {
        std::fs::write(reference, bytes).unwrap();
        return;
    }
    // It stays there for whoever wants to look at it.
    let found = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
    std::fs::write(&found, bytes).unwrap();
    let error = Difference::between(&reference, &found).unwrap().mean_flip();
    assert!(
        error < TOLERANCE,
        "{name}: FLIP {error:.4}; compare {} and {}",
        reference.display(),
        found.display()
    );
}

/// A window that is drawn, where that can be.
fn window() -> Option<Window> {
    window_of(common::SCENE)
}

fn window_of(scene: &str) -> Option<Window> {
    let Ok(mut window) = std::panic::catch_unwind(|| Window::with(scene, true)) else {
        eprintln!("skipped: nothing here can draw");
        return None;
    };
    window.harness.set_size(vec2(960.0, 620.0));
    window.frames(2);
    Some(window)
}

#[test]
fn the_preview_with_handles_and_fields() {
    let Some(mut window) = window() else { return };
    window.select("ball");
    window.key(Key::Num1);
    check(&mut window, "preview");
}

#[test]
fn what_a_set_operation_takes_away() {
    let Some(mut window) = window_of(&common::carved_scene()) else { return };
    let edge = window.point([0.2, 2.0, 1.0]);
    window.click(edge);
    assert_eq!(window.selected(), ["Sphere bite"]);
    check(&mut window, "subtracted");
}

#[test]
fn a_debug_ray_and_its_table() {
    let Some(mut window) = window() else { return };
    let ball = window.point([-1.3, 0.5, 1.2]);
    window.harness.hover_at(ball);
    window.frames(2);
    window.key(Key::E);
    window.harness.hover_at(ball + vec2(0.0, 1.0));
    check(&mut window, "debug_ray");
}

#[test]
fn a_trace_with_its_histogram_beside_a_kept_one() {
    let Some(mut window) = window() else { return };
    window.studio().options.asked.samples = Some((kajo::SamplerKind::Regular, 1));
    window.app().layout.tab = Tab::Picture;
    window.key(Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    window.frames(3);
    window.studio().apply(Action::Compare(Compare::Wipe));
    window.studio().options.asked.shadows = Some(kajo::Shadows::Off);
    let job = window.studio().tracer.frame().unwrap().job();
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().unwrap().job() > job);
    check(&mut window, "traced");
}

#[test]
fn the_text_with_a_mistake_in_light_colours() {
    let Some(mut window) = window() else { return };
    window.app().layout.light = true;
    window.harness.ctx.set_theme(egui::Theme::Light);
    window.app().layout.bottom = Some(Bottom::Text);
    window.select("red");
    let (file, _) = window.studio().document.as_ref().unwrap().files().next().unwrap();
    let text = common::SCENE.replace("reflectiveColor", "reflectColor");
    window.studio().apply(Action::Type { file, text });
    window.studio().apply(Action::EndTyping);
    check(&mut window, "text");
}
