//! Time of a frame of the preview: `cargo bench -p kajo-studio`.
//!
//! Hills of 200,000 and of a million triangles, all in view, at 960 x 540 pixels, the camera turning a little from
//! frame to frame; the mean and the longest of the frames after the first. Then the whole window, panels and all, while
//! nothing else runs, while a trace without an end runs on every core, and while one that each frame starts anew does.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use egui_wgpu::{RenderState, RendererOptions};
use kajo::{CameraPose, LoadOptions, MemoryAssets};
use kajo_edit::preview::Preview;
use kajo_math::{DVec2, DVec3};
use kajo_studio::raster::{Eye, Raster, Shot};
use kajo_studio::shell::{App, Layout};
use kajo_studio::state::Action;

const SIZE: [u32; 2] = [960, 540];
const FRAMES: u32 = 20;

fn main() {
    let card = create_render_state(
        default_wgpu_setup(),
        RendererOptions { dithering: false, ..RendererOptions::default() },
    );
    println!("{}", egui_wgpu::adapter_info_summary(&card.adapter.get_info()));
    for side in [316, 707] {
        let begin = Instant::now();
        let preview = hills(side);
        let made = begin.elapsed();
        let mut raster = Raster::new(&card);
        let begin = Instant::now();
        raster.set_scene(&preview);
        let uploaded = begin.elapsed();
        frame(&mut raster, 0.0);
        let times: Vec<Duration> = (1..=FRAMES).map(|i| frame(&mut raster, 0.01 * f64::from(i))).collect();
        let mean = times.iter().sum::<Duration>() / FRAMES;
        let longest = times.iter().max().copied().unwrap_or_default();
        println!(
            "{:>9} triangles: {:6.1} ms a frame, {:6.1} ms the longest; {:.0} ms to read, {:.0} ms to the card",
            raster.triangles(),
            ms(mean),
            ms(longest),
            ms(made),
            ms(uploaded)
        );
    }
    window(&card);
}

/// Draws the window while it traces.
fn window(card: &RenderState) {
    let run = |ui: &mut egui::Ui, app: &mut Option<App>| {
        app.get_or_insert_with(|| App::new(ui.ctx(), Some(card), Layout::default())).ui(ui);
    };
    let renderer = WgpuTestRenderer::from_render_state(card.clone());
    let builder = Harness::builder().with_size([1280.0, 800.0]).renderer(renderer);
    let mut harness = builder.build_ui_state(run, None);
    harness.step();
    for (what, traces, turns) in [
        ("nothing runs", false, false),
        ("a trace runs", true, false),
        ("each frame starts a trace anew", true, true),
    ] {
        let mut times = Vec::new();
        for i in 0..40 {
            let Some(app) = harness.state_mut() else { return };
            if i == 0 {
                app.studio.apply(Action::New);
                app.studio.options.habits.endless = true;
            }
            if i == 0 && traces {
                app.studio.apply(Action::Trace);
            }
            if turns {
                app.studio.apply(Action::Orbit(DVec2::new(1.0, 0.0)));
            }
            let begin = Instant::now();
            harness.step();
            // A window that cannot be drawn would have failed before.
            let _ = harness.render();
            times.push(begin.elapsed());
        }
        let mean = times.iter().sum::<Duration>() / times.len() as u32;
        let longest = times.iter().max().copied().unwrap_or_default();
        println!("while {what}: {:.1} ms a frame of the window, {:.1} ms the longest", ms(mean), ms(longest));
    }
}

fn ms(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

/// Draws one frame and waits for it.
fn frame(raster: &mut Raster, angle: f64) -> Duration {
    let eye = DVec3::new(0.3 + angle, 0.9, 1.4);
    let camera = CameraPose::perspective(eye, DVec3::ZERO, DVec3::Y, 0.8);
    let clip_from_world = camera.projection(SIZE, 0.01, 10.0).expect("a flat picture").as_mat4();
    let eye = Eye { clip_from_world, place: eye.as_vec3(), is_direction: false };
    let shot = Shot { size: SIZE, scale: 1.0, eye, lines: &[], selected: &[], background: [0.1; 3] };
    let begin = Instant::now();
    raster.draw(&shot);
    raster.finish();
    begin.elapsed()
}

/// A square of hills with `side` by `side` cells of two triangles.
fn hills(side: usize) -> Preview {
    let mut obj = String::new();
    let at = |i: usize| 2.0 * i as f64 / side as f64 - 1.0;
    for (x, z) in (0..=side).flat_map(|z| (0..=side).map(move |x| (at(x), at(z)))) {
        let y = 0.1 * kajo_math::fmath::sin64(9.0 * x) * kajo_math::fmath::sin64(7.0 * z);
        let _ = writeln!(obj, "v {x} {y} {z}");
    }
    for (x, z) in (0..side).flat_map(|z| (0..side).map(move |x| (x, z))) {
        let corner = |dx, dz| (z + dz) * (side + 1) + x + dx + 1;
        let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let _ = writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}");
    }
    let scene = "PerspectiveCamera { center 0 1 2 direction 0 -0.4 -1 up 0 1 0 angle 45 }
        Materials { Material { diffuseColor 0.6 0.7 0.4 } }
        Group { MaterialIndex 0 TriangleMesh { obj_file hills.obj } }";
    let assets = MemoryAssets::new().with("hills.txt", scene).with("hills.obj", obj);
    let loaded = kajo::load_from("hills.txt", &assets, &LoadOptions::default());
    Preview::of(&loaded.scene.expect("a scene without mistakes"))
}
