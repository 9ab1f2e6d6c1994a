//! The texts of a document as a tree, with the nodes that people see of it.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

use kajo_core::compile::clock_of;
use kajo_core::settings::Dialect;
use kajo_scene::{Clock, Diagnostics, Item, Limits, Parsed, SceneDesc, SourceId, Span};

use super::outline::{Identities, Outline};
use super::overlay::Overlay;
use super::texts::Change;
use super::{FileId, Node, NodeId, SceneFile};
use kajo::{FsAssets, LoadOptions, parse_scene};
use kajo_core::schema::Kind;

/// The parsed texts.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub desc: SceneDesc,
    /// What the parser said.
    pub diagnostics: Diagnostics,
    /// See [`Parsed::whole`].
    pub whole: bool,
    pub outline: Outline,
    /// The dialect, where it is not the text's own choice.
    pub dialect: Option<Dialect>,
    /// The document's file for each source.
    files: HashMap<SourceId, FileId>,
    /// The texts that were parsed.
    texts: Vec<Arc<str>>,
}

/// From what a tree follows another.
pub(super) struct Before<'a> {
    pub outline: &'a Outline,
    pub change: &'a Change,
    /// Identities of nodes that come back.
    pub remembered: &'a [(FileId, usize, NodeId)],
}

/// What the parser makes of the scene that `disk` stands for, with `files` in the place of what is on disk.
fn parsed(disk: &FsAssets, options: &LoadOptions, clock: Option<Clock>, files: &[SceneFile]) -> Parsed {
    let overlay = Overlay { disk, files };
    let parse =
        |clock: &Clock, limits: &Limits| SceneDesc::load_at(disk.scene_name(), &overlay, limits, clock);
    match clock {
        Some(clock) => parse(&clock, &options.limits.clone()),
        None => parse_scene(options, || options.limits.clone(), parse).0,
    }
}

/// How many numbers of a text are written as expressions, those of what is repeated once.
fn expressions(desc: &SceneDesc) -> usize {
    let original = |span: Span| (desc.sources().original(span.source), span.start, span.end);
    desc.expressions().map(|(span, _)| original(span)).collect::<HashSet<_>>().len()
}

impl Tree {
    /// Parses the scene that `disk` stands for, with `files` in the place of what is on disk. Files that are included
    /// for the first time are added to them.
    ///
    /// * `clock`: the moments to parse it for, where they are known
    pub fn parse(
        disk: &FsAssets,
        options: &LoadOptions,
        clock: Option<Clock>,
        files: &mut Vec<SceneFile>,
        before: Before<'_>,
        identities: &mut Identities,
    ) -> Tree {
        let Parsed { desc, diagnostics, whole } = parsed(disk, options, clock, files);
        let mut by_source = HashMap::new();
        for (source, text) in desc.sources().iter() {
            let known = files.iter().position(|file| file.name == text.path());
            let index = known.unwrap_or_else(|| {
                let read: Arc<str> = text.text().into();
                files.push(SceneFile { name: text.path().to_owned(), text: read.clone(), saved: Some(read) });
                files.len() - 1
            });
            by_source.insert(source, FileId(index as u32));
        }
        let sources = desc.sources();
        let file_of = |source| by_source.get(&sources.original(source)).copied().unwrap_or(FileId(0));
        let outline = identities.outline(&desc, file_of, before.outline, before.change, before.remembered);
        let texts = files.iter().map(|file| file.text.clone()).collect();
        Tree { desc, diagnostics, whole, outline, dialect: options.dialect, files: by_source, texts }
    }

    /// Whether a text that was moved leaves names behind that its values go by: then there is an error more, an expression less, or
    /// no whole tree.
    ///
    /// * `files`: with the text where it was moved to
    pub fn leaves_names_behind(&self, disk: &FsAssets, options: &LoadOptions, files: &[SceneFile]) -> bool {
        let new = parsed(disk, options, None, files);
        !new.whole
            || new.diagnostics.errors().count() > self.diagnostics.errors().count()
            || expressions(&new.desc) < expressions(&self.desc)
    }

    /// The moments for which a text that is at some of its own is to be parsed to be at those that are asked for; `None` where
    /// that does not matter.
    pub fn clock_of(&self, options: &LoadOptions) -> Option<Clock> {
        clock_of(&self.desc, &options.compile_options(options.limits.clone()))
    }

    pub fn file_of(&self, source: SourceId) -> FileId {
        self.files.get(&self.desc.sources().original(source)).copied().unwrap_or(FileId(0))
    }

    /// The text of a file as it was parsed.
    pub fn text(&self, file: FileId) -> &str {
        self.texts.get(file.0 as usize).map_or("", |text| text)
    }

    /// The file and bytes of an item.
    pub fn range(&self, item: Item<'_>) -> (FileId, Range<usize>) {
        self.range_of(item.span())
    }

    pub fn range_of(&self, span: Span) -> (FileId, Range<usize>) {
        (self.file_of(span.source), span.range())
    }

    /// The item of a node.
    pub fn item(&self, node: &Node) -> Option<Item<'_>> {
        self.desc.item(node.item)
    }

    /// The parent of a node.
    pub fn parent(&self, node: &Node) -> Option<&Node> {
        node.parent.and_then(|id| self.outline.get(id))
    }

    /// The innermost node that an item stands in, or that it is.
    pub fn node_around(&self, item: u32) -> Option<&Node> {
        let mut node = self.outline.last_up_to(item)?;
        while self.item(node)?.next_index() <= item {
            node = self.parent(node)?;
        }
        Some(node)
    }

    /// The last block of a kind that stands in no other: the one that counts.
    pub fn root(&self, kind: Kind) -> Option<&Node> {
        self.outline.children(None).filter(|node| node.kind == kind).last()
    }
}
