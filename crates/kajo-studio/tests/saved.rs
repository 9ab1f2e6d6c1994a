//! What the window shows is what its scene renders to once it is saved, whatever was edited before.

mod common;

use common::{Dice, Window};
use kajo::{BitDepth, Defaults, Format, LoadOptions, RenderSettings, SamplerKind, Settings, View};
use kajo_edit::{Document, NodeId};
use kajo_studio::state::{Action, PictureSize, Studio};
use kajo_testkit::every;

const SIZE: [u32; 2] = [32, 24];

/// A number of a block that can be a little larger or smaller: the field, which of several, and its new value.
fn nudged(document: &Document, node: NodeId, dice: &mut Dice) -> Option<Action> {
    let mut fields = document.fields(node);
    fields.retain(|f| f.span.is_some() && f.value.as_ref().is_some_and(|value| !value.numbers.is_empty()));
    let field = fields.get(dice.below(fields.len().max(1)))?;
    let mut value = field.value.clone()?;
    let which = dice.below(value.numbers.len());
    value.numbers[which] = (value.numbers[which] * [0.8, 1.1, 1.25][dice.below(3)] * 1e3).round() / 1e3;
    Some(Action::SetField { node, key: field.key.clone(), nth: field.nth, value })
}

/// Something that a user might do.
fn any_action(studio: &Studio, dice: &mut Dice) -> Option<Action> {
    let document = studio.document.as_ref()?;
    let nodes = document.outline().nodes();
    let node = &nodes[dice.below(nodes.len())];
    match dice.below(8) {
        0 => Some(Action::Add(["Sphere", "Box", "PointLight", "Cone"][dice.below(4)])),
        1 if node.kind.is_object() => Some(Action::Duplicate),
        2 if node.kind.is_object() => Some(Action::Delete),
        3 => Some(Action::Undo),
        _ => nudged(document, node.id, dice),
    }
    .filter(|_| nodes.len() < 200)
}

/// Windows with scenes of the gallery that need no other files, and their names: a quarter of these, and all where tests are
/// run in full.
fn windows() -> impl Iterator<Item = (String, Window)> {
    let gallery = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/gallery");
    let mut paths: Vec<_> = std::fs::read_dir(gallery).unwrap().map(|entry| entry.unwrap().path()).collect();
    // Its chains begin with a million samples, which take minutes here.
    paths.retain(|path| !path.ends_with("keyhole.txt"));
    paths.sort();
    every(4, paths).filter_map(|path| {
        let text = std::fs::read_to_string(&path).ok()?;
        let mut window = Window::with(&text, false);
        let is_whole = window.studio().n_errors() == 0 && window.studio().scene().is_some();
        is_whole.then(|| (path.file_stem().unwrap().to_string_lossy().into_owned(), window))
    })
}

#[test]
fn a_saved_scene_renders_to_the_picture_that_the_window_showed() {
    let asked = Settings { samples: Some((SamplerKind::Sobol, 2)), ..Settings::default() };
    let mut edits = 0;
    for (seed, (name, mut window)) in (0..).zip(windows()) {
        let text = window.text();
        window.studio().options.habits.size = PictureSize::Fixed(SIZE);
        window.studio().options.asked = asked.clone();
        let mut dice = Dice::new(seed);
        for _ in 0..24 {
            let Some(action) = any_action(window.studio(), &mut dice) else { continue };
            let nodes = window.studio().document.as_ref().unwrap().outline().nodes();
            let node = nodes[dice.below(nodes.len())].id;
            window.studio().apply(Action::Select(vec![node]));
            window.studio().apply(action);
            window.frames(1);
            // What makes no scene is taken back.
            if window.studio().n_errors() > 0 {
                window.studio().apply(Action::Undo);
                window.settle();
            }
            edits += usize::from(window.text() != text);
        }
        let shown = traced(&mut window);
        window.studio().apply(Action::Save);
        window.settle();
        assert_eq!(window.read("scene.txt"), window.text(), "{name}");
        assert!(shown == rendered(&window, &asked), "{name} renders to another picture once it is saved");
    }
    assert!(edits > 60, "{edits} edits");
}

#[test]
fn to_look_at_a_block_changes_nothing() {
    let mut looks = 0;
    for (name, mut window) in windows() {
        let text = window.text();
        let document = window.studio().document.as_ref().unwrap();
        let nodes: Vec<NodeId> = document.outline().nodes().iter().map(|node| node.id).collect();
        for node in nodes.into_iter().take(60) {
            window.studio().apply(Action::Select(vec![node]));
            window.frames(2);
            looks += 1;
            let document = window.studio().document.as_ref().unwrap();
            assert!(document.text() == text, "{name}: {:?}", document.undo_label());
        }
    }
    assert!(looks > 150, "{looks}");
}

/// The bytes of the picture that the window traces.
fn traced(window: &mut Window) -> Vec<u8> {
    window.key(egui::Key::Enter);
    window.wait(|studio| studio.progress().is_none() && studio.tracer.frame().is_some());
    let path = window.path("shown.png");
    window.studio().apply(Action::Export(path.clone()));
    std::fs::read(path).unwrap()
}

/// The bytes of the picture that the saved scene renders to.
fn rendered(window: &Window, asked: &Settings) -> Vec<u8> {
    let loaded = kajo::load(&window.path("scene.txt"), &LoadOptions::default());
    let scene = loaded.scene.as_ref().unwrap_or_else(|| panic!("{}", loaded.report(false)));
    let asked = Settings { size: Some(SIZE), ..asked.clone() };
    let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap();
    let outputs = [(View::Color, Format::Png)];
    let picture = kajo::render(&kajo::RenderRequest::new(scene, &settings, &outputs), &kajo::Silent).unwrap();
    picture.encode(&[View::Color], Format::Png, BitDepth::Eight).unwrap()
}
