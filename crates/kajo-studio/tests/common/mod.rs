//! A window without a display: keys and mouse are events, and what it shows can be looked at.
#![allow(dead_code, reason = "every test program uses a part of this")]

use std::path::PathBuf;
use std::time::Duration;

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use egui_wgpu::{RenderState, RendererOptions};
use kajo_math::rng;
use kajo_studio::shell::{App, Layout};
use kajo_studio::state::{Action, Studio};

/// A red ball left, a green box right, on a grey floor, with comments in odd places.
pub const SCENE: &str = "\
// A scene for tests.\r
PerspectiveCamera { center 0 1 10  direction 0 0 -1  up 0 1 0  angle 40 } # looks along -z
Background { color 0.2 0.3 0.5  ambientLight 0.2 0.2 0.2 }
Lights {
\tDirectionalLight sun { direction -1 -2 -1  color 0.8 0.8 0.8 }
}
Materials {
  PhongMaterial red { diffuseColor 0.9 0.1 0.1 /* not too red */ reflectiveColor 0.2 0.2 0.2 }
  PhongMaterial green { diffuseColor 0.1 0.8 0.2 }
  PhongMaterial grey { diffuseColor 0.5 0.5 0.5 }
}
Group {
  MaterialIndex red    Sphere ball { center -2 1 0  radius 1.5 } // the ball
  MaterialIndex green  Box crate { min 1 0 -1  max 3 2 1 }
  MaterialIndex grey   Plane floor { normal 0 1 0  offset -1 }
}
";

/// The same, with a bite out of the box.
pub fn carved_scene() -> String {
    let whole = "Box crate { min 1 0 -1  max 3 2 1 }";
    let carved = format!("Difference carved {{ {whole}  Sphere bite {{ center 1 2 1  radius 0.8 }} }}");
    assert!(SCENE.contains(whole));
    SCENE.replace(whole, &carved)
}

/// The window's size in points.
pub const SIZE: Vec2 = Vec2::new(1200.0, 760.0);

/// The window, made in its first frame.
pub struct Slot {
    app: Option<App>,
    card: Option<RenderState>,
}

/// A window and the folder of its scene.
pub struct Window {
    pub harness: Harness<'static, Slot>,
    pub folder: tempfile::TempDir,
}

impl Window {
    /// A window without a card, with `SCENE` open.
    pub fn new() -> Window {
        Window::with(SCENE, false)
    }

    /// A window with a card, whose pictures can be looked at.
    pub fn drawn() -> Window {
        Window::with(SCENE, true)
    }

    pub fn with(scene: &str, drawn: bool) -> Window {
        let mut window = Window::empty(drawn);
        window.open(scene);
        window
    }

    /// Opens a scene, beside what is in the window's folder.
    pub fn open(&mut self, scene: &str) {
        let path = self.path("scene.txt");
        std::fs::write(&path, scene).unwrap();
        self.app().studio.apply(Action::Open(path));
        self.wait(|studio| studio.document.is_some() && !studio.is_loading());
        self.wait(|studio| studio.scene().is_none() || studio.preview_is_current());
    }

    /// A window without a scene.
    pub fn empty(drawn: bool) -> Window {
        let card = drawn.then(|| create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE));
        let builder = Harness::builder().with_size(SIZE).with_step_dt(1.0 / 60.0);
        let builder = match &card {
            Some(card) => builder.renderer(WgpuTestRenderer::from_render_state(card.clone())),
            None => builder,
        };
        let run = |ui: &mut egui::Ui, slot: &mut Slot| {
            let Slot { app, card } = slot;
            app.get_or_insert_with(|| App::new(ui.ctx(), card.as_ref(), Layout::default())).ui(ui);
        };
        let mut harness = builder.build_ui_state(run, Slot { app: None, card });
        harness.step();
        Window { harness, folder: tempfile::tempdir().unwrap() }
    }

    pub fn app(&mut self) -> &mut App {
        self.harness.state_mut().app.as_mut().expect("made in the first frame")
    }

    pub fn studio(&mut self) -> &mut Studio {
        &mut self.app().studio
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// Draws frames until something holds, for as long as it takes.
    pub fn wait(&mut self, done: impl Fn(&Studio) -> bool) {
        loop {
            self.harness.step();
            if done(self.studio()) {
                return;
            }
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// Draws frames, and more until the scene is what the text says.
    pub fn frames(&mut self, n: usize) {
        (0..n).for_each(|_| self.harness.step());
        self.settle();
    }

    /// Waits until the scene is what the text says.
    pub fn settle(&mut self) {
        while self.studio().is_compiling() {
            std::thread::sleep(Duration::from_millis(1));
            self.harness.step();
        }
    }

    pub fn key(&mut self, key: Key) {
        self.key_with(Modifiers::NONE, key);
    }

    pub fn key_with(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.frames(3);
    }

    pub fn write(&mut self, text: &str) {
        self.harness.event(Event::Text(text.to_owned()));
        self.frames(2);
    }

    /// Where a world-space point appears in the window.
    pub fn point(&mut self, p: [f64; 3]) -> Pos2 {
        let area = self.app().area().expect("a picture");
        let studio = self.studio();
        let place = studio.camera.project(p.into(), area.size).expect("in front of the camera");
        area.point(place)
    }

    pub fn button(&mut self, pos: Pos2, button: PointerButton, pressed: bool) {
        let modifiers = Modifiers::NONE;
        self.harness.event(Event::PointerMoved(pos));
        self.harness.event(Event::PointerButton { pos, button, pressed, modifiers });
        self.frames(2);
    }

    pub fn click(&mut self, pos: Pos2) {
        self.button(pos, PointerButton::Primary, true);
        self.button(pos, PointerButton::Primary, false);
    }

    pub fn drag(&mut self, button: PointerButton, from: Pos2, by: Vec2) {
        self.button(from, button, true);
        for step in 1..=8 {
            self.harness.event(Event::PointerMoved(from + by * (step as f32 / 8.0)));
            self.frames(1);
        }
        self.button(from + by, button, false);
    }

    pub fn wheel(&mut self, pos: Pos2, notches: f32, modifiers: Modifiers) {
        self.harness.event(Event::PointerMoved(pos));
        let delta = Vec2::new(0.0, notches);
        let unit = egui::MouseWheelUnit::Line;
        let (phase, source) = (egui::TouchPhase::Move, egui::MouseWheelSource::Wheel);
        self.harness.event_modifiers(Event::MouseWheel { unit, delta, modifiers, phase, source }, modifiers);
        self.frames(30);
    }

    /// Clicks the widget with this name.
    pub fn press(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.frames(3);
    }

    /// Clicks the widget behind this name of a row.
    pub fn press_in_row(&mut self, name: &str) {
        let at = self.widget(name);
        self.click(at);
    }

    /// Where the widget behind this name of a row is.
    pub fn widget(&mut self, name: &str) -> Pos2 {
        let nodes = self.harness.get_all_by_label(name).map(|node| node.rect().center());
        nodes.max_by(|a, b| a.x.total_cmp(&b.x)).expect("a widget")
    }

    pub fn notice(&mut self) -> String {
        self.studio().notice.as_ref().map(|notice| notice.text.clone()).unwrap_or_default()
    }

    /// Selects the node with this name.
    pub fn select(&mut self, name: &str) {
        let document = self.studio().document.as_ref().unwrap();
        let node =
            document.outline().nodes().iter().find(|node| node.name.as_deref() == Some(name)).unwrap().id;
        self.studio().apply(Action::Select(vec![node]));
        self.frames(2);
    }

    /// The keyword and name of what is selected.
    pub fn selected(&mut self) -> Vec<String> {
        let studio = self.studio();
        let document = studio.document.as_ref().unwrap();
        let nodes = studio.selection.nodes().iter().filter_map(|&id| document.node(id));
        nodes.map(|node| format!("{} {}", node.keyword, node.name.as_deref().unwrap_or_default())).collect()
    }

    pub fn text(&mut self) -> String {
        self.studio().document.as_ref().unwrap().text().to_owned()
    }
}

/// What is random: hashes of a seed and a count.
pub struct Dice {
    seed: u64,
    rolled: u64,
}

impl Dice {
    pub fn new(seed: u64) -> Dice {
        Dice { seed, rolled: 0 }
    }

    /// A number below `n`, which is not zero.
    pub fn below(&mut self, n: usize) -> usize {
        self.rolled += 1;
        (rng::mix(rng::mix(self.seed) ^ self.rolled) % n as u64) as usize
    }
}
