//! The scene that a document's texts make, and how another thread can be the one to make it.
//!
//! A [`Compilation`] is a picture of the texts at one moment. It shares nothing with the document that changes, so the
//! document can be edited while it runs; [`Document::adopt`] takes in what came of it.
//!
//! ```
//! # let text = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 } Group { }";
//! # let mut document = kajo_edit::Document::untitled(std::path::Path::new("."), text, Default::default())?;
//! let compilation = document.compilation().expect("the texts were never compiled");
//! let worker = std::thread::spawn(move || compilation.run());
//! document.adopt(worker.join().expect("a compiler that does not panic"));
//! assert!(document.scene().is_some());
//! assert!(document.compilation().is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;

use kajo_core::compile::{CompileOptions, MeshStore, compile};
use kajo_core::scene::Scene;
use kajo_core::{Object, ObjectId};
use kajo_scene::{Diagnostics, Sources, one_line, render};

use super::compiled::{Compiled, Made, ModelRow, model_rows};
use super::overlay::Overlay;
use super::tree::Tree;
use super::{Document, FileId, NodeId, SceneFile};
use kajo::{FsAssets, LoadOptions};
use kajo_core::schema::Kind;

/// Texts as they were at one moment, to be compiled.
#[derive(Debug)]
pub struct Compilation {
    generation: u64,
    tree: Arc<Tree>,
    files: Vec<SceneFile>,
    disk: Arc<FsAssets>,
    options: LoadOptions,
    meshes: Arc<MeshStore>,
}

impl Compilation {
    /// Makes a scene of the texts.
    pub fn run(self) -> Compiled {
        let Compilation { generation, tree, files, disk, options, meshes } = self;
        let compile_options =
            CompileOptions { meshes: Some(meshes), ..options.compile_options(options.budgeted()) };
        let assets = Overlay { disk: &disk, files: &files };
        let mut diagnostics = tree.diagnostics.clone();
        let mut desc = tree.desc.clone();
        // A text that could not be read whole would only give complaints about what is missing from it.
        let scene = match tree.whole {
            true => compile(&mut desc, &assets, &compile_options, &mut diagnostics),
            false => None,
        };
        let made = scene.map(|scene| {
            let nodes = scene.geometry.objects.iter().map(|object| nodes_of(&tree, &object));
            Made {
                generation,
                objects: nodes.collect(),
                models: model_rows(&scene, &tree).into(),
                tree: Arc::clone(&tree),
                scene: Arc::new(scene),
            }
        });
        Compiled { generation: Some(generation), diagnostics, desc: Arc::new(desc), made }
    }
}

impl Document {
    /// What [`Document::compile`] would do, for another thread to run; `None` if it is done.
    pub fn compilation(&self) -> Option<Compilation> {
        (!self.is_compiled()).then(|| Compilation {
            generation: self.generation,
            tree: Arc::clone(&self.tree),
            files: self.files.clone(),
            disk: Arc::clone(&self.disk),
            options: self.options.clone(),
            meshes: Arc::clone(&self.meshes),
        })
    }

    /// Takes in what came of a compilation of this document, unless that of a later text is there already.
    ///
    /// If the text had mistakes, the last good scene stays, and [`Document::diagnostics`] says what is wrong.
    pub fn adopt(&mut self, compiled: Compiled) {
        if compiled.generation < self.compiled.generation {
            return;
        }
        let made = compiled.made.or(self.compiled.made.take());
        self.compiled = Compiled { made, ..compiled };
    }

    /// Takes over the scene of another copy of this document, if that was made of later texts.
    pub fn keep_scene_of(&mut self, other: &Document) {
        if other.compiled.generation > self.compiled.generation {
            self.compiled = other.compiled.clone();
        }
    }

    /// Compiles the texts, if that has not been done since they changed.
    ///
    /// With mistakes in them the last good scene stays, and [`Document::diagnostics`] says what is wrong.
    pub fn compile(&mut self) {
        if let Some(compilation) = self.compilation() {
            self.adopt(compilation.run());
        }
    }

    /// Whether the texts, as they are now, have been compiled.
    pub fn is_compiled(&self) -> bool {
        self.compiled.generation == Some(self.generation)
    }

    /// The last good scene that [`Document::compile`] made.
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        self.compiled.made.as_ref().map(|made| &made.scene)
    }

    /// Whether [`Document::scene`] is what the texts say now.
    pub fn is_current(&self) -> bool {
        self.compiled.made.as_ref().is_some_and(|made| made.generation == self.generation)
    }

    /// [`Document::generation`] of the texts that [`Document::scene`] was made from; 0 without a scene.
    pub fn scene_generation(&self) -> u64 {
        self.compiled.made.as_ref().map_or(0, |made| made.generation)
    }

    /// Everything worth saying about the texts, as of the last [`Document::compile`].
    pub fn diagnostics(&self) -> &Diagnostics {
        &self.compiled.diagnostics
    }

    /// The texts that the messages point into: those that were compiled last.
    pub fn sources(&self) -> &Sources {
        self.compiled.desc.sources()
    }

    /// The file and bytes that a message is about, where they are in the texts that were compiled last.
    pub fn range_of(&self, diagnostic: &kajo_scene::Diagnostic) -> Option<(FileId, Range<usize>)> {
        diagnostic.span().map(|span| self.tree.range_of(span))
    }

    /// The messages as they are shown to people, with the lines they are about; in colour on request.
    pub fn report(&self, color: bool) -> String {
        render(&self.compiled.diagnostics, self.sources(), color)
    }

    /// One line a message: `file:line:column: error: what`.
    pub fn lines(&self) -> impl Iterator<Item = String> {
        self.compiled.diagnostics.iter().map(|diagnostic| one_line(diagnostic, self.sources()))
    }

    /// The node that puts an object into the scene: a shape, or the outermost instance.
    ///
    /// * `number`: as in the id layer of [`Document::scene`], from 1
    pub fn node_of_object(&self, number: u32) -> Option<NodeId> {
        self.nodes_of_object(number)?[0]
    }

    /// The node that describes an object: a shape, which may stand in a definition, or a model.
    ///
    /// * `number`: as in the id layer of [`Document::scene`], from 1
    pub fn part_of_object(&self, number: u32) -> Option<NodeId> {
        self.nodes_of_object(number)?[1]
    }

    /// The block of a light of [`Document::scene`], by its place in the order of the file, from 0.
    pub fn node_of_light(&self, place: u32) -> Option<NodeId> {
        let tree = &self.compiled.made.as_ref()?.tree;
        let list = tree.root(Kind::Lights)?.id;
        let mut lights = tree.outline.children(Some(list)).filter(|node| node.kind == Kind::Light);
        lights.nth(place as usize).map(|node| node.id)
    }

    /// The node of an item of the text that [`Document::scene`] was made of; see [`crate::preview::LineKind::Subtracted`].
    pub fn node_of_item(&self, item: u32) -> Option<NodeId> {
        let tree = &self.compiled.made.as_ref()?.tree;
        tree.outline.at_item(item).map(|node| node.id)
    }

    /// The keys of models that follow the frames by animations of their files, as of the last good scene.
    pub fn model_rows(&self) -> &[ModelRow] {
        self.compiled.made.as_ref().map_or(&[], |made| &made.models)
    }

    /// The nodes that place an object and that describe it.
    fn nodes_of_object(&self, number: u32) -> Option<[Option<NodeId>; 2]> {
        let made = self.compiled.made.as_ref()?;
        let id = ObjectId::from_number(number)?;
        let known = made.objects.get(id.index()).copied();
        known.or_else(|| made.scene.geometry.object(id).map(|object| nodes_of(&made.tree, &object)))
    }

    /// Numbers of the objects of [`Document::scene`] that a node places or describes, or nodes within it do; without
    /// those in nested instances, see [`Document::nested_objects_of`].
    pub fn objects_of(&self, id: NodeId) -> Vec<u32> {
        let nodes: HashSet<NodeId> = self.outline().subtree(id).iter().map(|n| n.id).collect();
        let is_of = |object: &[Option<NodeId>; 2]| object.iter().flatten().any(|id| nodes.contains(id));
        (1..).zip(self.objects()).filter(|(_, object)| is_of(object)).map(|(number, _)| number).collect()
    }

    /// Numbers of the objects in nested instances that a node puts into [`Document::scene`], or nodes within it do.
    ///
    /// Unlike other objects these are not found by what describes them: they may be as many as can be numbered.
    pub fn nested_objects_of(&self, id: NodeId) -> Vec<Range<u32>> {
        let Some(made) = &self.compiled.made else { return Vec::new() };
        let nodes: HashSet<NodeId> = self.outline().subtree(id).iter().map(|n| n.id).collect();
        let is_within = |item| made.tree.outline.at_item(item).is_some_and(|node| nodes.contains(&node.id));
        let objects = made.scene.geometry.nested_objects(is_within).into_iter();
        objects.map(|range| range.start.number()..range.end.number()).collect()
    }

    fn objects(&self) -> &[[Option<NodeId>; 2]] {
        self.compiled.made.as_ref().map_or(&[], |made| &made.objects)
    }
}

/// The nodes that place an object and that describe it.
fn nodes_of(tree: &Tree, object: &Object<'_>) -> [Option<NodeId>; 2] {
    [object.placed_by, object.described_by].map(|item| tree.outline.at_item(item).map(|node| node.id))
}

#[cfg(test)]
mod tests {
    use crate::{Document, Edit, FieldValue};
    use kajo::LoadOptions;
    use std::path::Path;

    const TEXT: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
        Materials { Material {} }
        Group { MaterialIndex 0  Sphere ball { center 0 0 0  radius 1 }  Sphere { center 2 0 0  radius 1 } }";

    fn document(text: &str) -> Document {
        Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap()
    }

    #[test]
    fn a_document_is_edited_while_its_text_of_before_is_compiled() {
        let mut document = document(TEXT);
        let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        let early = document.compilation().unwrap();
        document.apply(&Edit::set(ball, "radius", FieldValue::numbers([2.0]))).unwrap();
        document.apply(&Edit::Delete(ball)).unwrap();
        let late = document.compilation().unwrap();
        document.adopt(early.run());
        assert!(document.scene().is_some() && !document.is_current() && !document.is_compiled());
        assert_eq!(document.scene().unwrap().geometry.primitives.len(), 2, "the text of before");
        assert_eq!(document.node_of_object(1), Some(ball));
        document.adopt(late.run());
        assert!(document.is_current() && document.compilation().is_none());
        assert_eq!(document.scene().unwrap().geometry.primitives.len(), 1);
        assert_ne!(document.node_of_object(1), Some(ball));
    }

    #[test]
    fn a_copy_is_edited_and_takes_over_what_was_compiled_meanwhile() {
        let mut document = document(TEXT);
        document.compile();
        let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        document.apply(&Edit::set(ball, "radius", FieldValue::numbers([2.0]))).unwrap();
        let mut copy = document.clone();
        document.compile();
        copy.apply(&Edit::set(ball, "radius", FieldValue::numbers([3.0]))).unwrap();
        assert!(document.text().contains("radius 2") && copy.text().contains("radius 3"));
        assert!(copy.scene_generation() < document.scene_generation());
        copy.keep_scene_of(&document);
        assert_eq!(copy.scene_generation(), document.scene_generation());
        assert!(!copy.is_current() && copy.generation() > document.generation());
        copy.compile();
        let generation = copy.scene_generation();
        copy.keep_scene_of(&document);
        assert_eq!(copy.scene_generation(), generation);
        assert!(copy.undo() && copy.undo() && !copy.undo());
        assert_eq!(copy.text(), TEXT);
    }

    #[test]
    fn what_comes_late_is_not_taken_in() {
        let mut document = document(TEXT);
        let early = document.compilation().unwrap();
        let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        document.apply(&Edit::Delete(ball)).unwrap();
        document.compile();
        let generation = document.scene_generation();
        document.adopt(early.run());
        assert_eq!(document.scene_generation(), generation);
        assert_eq!(document.scene().unwrap().geometry.primitives.len(), 1);
    }

    #[test]
    fn messages_point_into_the_text_that_was_compiled() {
        let mut document = document(TEXT);
        document.compile();
        let (file, _) = document.files().next().unwrap();
        let text = TEXT.replace("Sphere ball", "Sphre ball");
        document.apply(&Edit::Rewrite { file, text }).unwrap();
        let compilation = document.compilation().unwrap();
        document.apply(&Edit::Rewrite { file, text: format!("\n\n{TEXT}") }).unwrap();
        document.adopt(compilation.run());
        assert!(document.scene().is_some(), "the last good scene stays");
        assert!(
            document.lines().any(|line| line.contains(":3:34: error:")),
            "{:?}",
            document.lines().collect::<Vec<_>>()
        );
    }

    #[test]
    fn objects_in_nested_instances_lead_to_their_blocks() {
        let balls: String = (0..100).map(|i| format!("Sphere {{ center {i} 0 0  radius 0.3 }}\n")).collect();
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }}
            Materials {{ Material {{}} }}
            Group {{ MaterialIndex 0  Define row {{ {balls} }}
                Instance row  Sphere {{ center 0 5 0  radius 1 }}  Instance row {{ Translate 0 1 0 }} }}"
        );
        let mut options = LoadOptions::default();
        options.limits.objects = 1600;
        let mut document = Document::untitled(Path::new("."), &text, options).unwrap();
        document.compile();
        let scene = document.scene().unwrap().clone();
        assert_eq!((scene.geometry.primitives.len(), scene.geometry.object_count()), (1, 201));
        let of = |word: &str| {
            document.outline().nodes().iter().filter(|n| &*n.keyword == word).collect::<Vec<_>>()
        };
        let (instances, spheres) = (of("Instance"), of("Sphere"));
        // The sphere that is listed is number 1, those of the first row are 2 to 101.
        for (number, by, part) in [(1, None, 100), (2, Some(0), 0), (101, Some(0), 99), (102, Some(1), 0)] {
            let by = by.map_or(spheres[100].id, |i: usize| instances[i].id);
            assert_eq!(document.node_of_object(number), Some(by), "{number}");
            assert_eq!(document.part_of_object(number), Some(spheres[part].id), "{number}");
        }
        assert_eq!(document.node_of_object(202), None);
        let numbers = document.nested_objects_of(instances[1].id);
        assert_eq!(numbers, std::slice::from_ref(&(102..202)));
        assert!(document.nested_objects_of(spheres[100].id).is_empty());
        let camera = kajo::CameraPose::of(&scene);
        let at = camera.project(kajo_math::DVec3::new(1.0, 1.0, 0.0), [200, 200]).unwrap();
        let pick = kajo::probe::pick(&scene, &camera, at, [200, 200]).unwrap();
        assert_eq!(document.node_of_object(pick.object), Some(instances[1].id));
    }
}
