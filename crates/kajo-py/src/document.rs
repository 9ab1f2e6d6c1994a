//! The class `Document`: a scene file that is edited, of which every byte stays that nobody meant to change.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use kajo::LoadOptions;
use kajo_edit::{Edit, FieldValue};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::scene::{Scene, options};
use crate::{EditError, scene_error};

/// A scene file that is edited.
#[pyclass(module = "kajo._native")]
pub struct Document {
    document: kajo_edit::Document,
}

/// What a block of a document is known by, whatever is edited elsewhere.
#[pyclass(frozen, eq, hash, from_py_object, module = "kajo._native")]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct NodeId(kajo_edit::NodeId);

/// A block: what it is known by, its keyword, its name, and the block that it stands in.
type Node = (NodeId, String, Option<String>, Option<NodeId>);

/// A word and numbers, as a scene has them behind a key.
type Value = (Option<String>, Vec<f64>);

/// A field: its key, which of several, its value, whether that is written, and what it says.
type Field = (String, usize, Option<Value>, bool, &'static str);

fn refused(error: impl std::fmt::Display) -> PyErr {
    EditError::new_err(error.to_string())
}

fn unwritten(error: impl std::fmt::Display) -> PyErr {
    PyOSError::new_err(error.to_string())
}

impl Document {
    fn apply(&mut self, edit: &Edit) -> PyResult<Option<NodeId>> {
        let applied = self.document.apply(edit).map_err(refused)?;
        Ok(applied.created.map(NodeId))
    }
}

#[pymethods]
impl Document {
    #[new]
    fn open(
        path: PathBuf,
        text: Option<&str>,
        folders: Vec<PathBuf>,
        allow_outside: bool,
        dialect: Option<&str>,
    ) -> PyResult<Document> {
        let options = LoadOptions { folders, allow_outside, ..options(None, dialect, None)? };
        let document = match text {
            None => kajo_edit::Document::open(&path, options),
            Some(text) => kajo_edit::Document::untitled(&path, text, options),
        };
        document.map(|document| Document { document }).map_err(unwritten)
    }

    #[getter]
    fn text(&self) -> &str {
        self.document.text()
    }

    #[getter]
    fn path(&self) -> Option<&Path> {
        self.document.path()
    }

    #[getter]
    fn is_dirty(&self) -> bool {
        self.document.is_dirty()
    }

    fn nodes(&self) -> Vec<Node> {
        let nodes = self.document.outline().nodes().iter();
        nodes
            .map(|node| {
                let name = node.name.as_deref().map(str::to_owned);
                (NodeId(node.id), node.keyword.to_string(), name, node.parent.map(NodeId))
            })
            .collect()
    }

    /// The text of a block; nothing of one that is gone.
    fn text_of(&self, node: &NodeId) -> Option<&str> {
        let node = self.document.node(node.0)?;
        let (_, file) = self.document.files().find(|(id, _)| *id == node.file)?;
        file.text.get(node.span.clone())
    }

    fn fields(&self, node: &NodeId) -> Vec<Field> {
        let value = |value: FieldValue| (value.word, value.numbers);
        let fields = self.document.fields(node.0).into_iter();
        fields.map(|f| (f.key, f.nth, f.value.map(value), f.span.is_some(), f.about)).collect()
    }

    fn set(&mut self, node: &NodeId, key: String, value: Value, nth: Option<usize>) -> PyResult<()> {
        let (word, numbers) = value;
        let value = FieldValue { word, numbers };
        self.apply(&Edit::Set { node: node.0, key, nth, value }).map(drop)
    }

    fn unset(&mut self, node: &NodeId, key: String, nth: Option<usize>) -> PyResult<()> {
        self.apply(&Edit::Unset { node: node.0, key, nth }).map(drop)
    }

    fn rename(&mut self, node: &NodeId, name: Option<String>) -> PyResult<()> {
        self.apply(&Edit::Rename { node: node.0, name }).map(drop)
    }

    fn add(&mut self, into: Option<NodeId>, block: String) -> PyResult<Option<NodeId>> {
        self.apply(&Edit::Add { into: into.map(|id| id.0), block })
    }

    fn duplicate(&mut self, node: &NodeId) -> PyResult<Option<NodeId>> {
        self.apply(&Edit::Duplicate(node.0))
    }

    fn delete(&mut self, node: &NodeId) -> PyResult<()> {
        self.apply(&Edit::Delete(node.0)).map(drop)
    }

    fn paint(&mut self, node: &NodeId, material: &NodeId) -> PyResult<()> {
        self.apply(&Edit::Paint { node: node.0, material: material.0 }).map(drop)
    }

    fn move_into(&mut self, node: &NodeId, into: &NodeId) -> PyResult<()> {
        self.apply(&Edit::MoveInto { node: node.0, into: into.0 }).map(drop)
    }

    fn rewrite(&mut self, text: String) -> PyResult<()> {
        let first = self.document.files().next().map(|(id, _)| id);
        let Some(file) = first else { return Ok(()) };
        self.apply(&Edit::Rewrite { file, text }).map(drop)
    }

    fn undo(&mut self) -> bool {
        self.document.undo()
    }

    fn redo(&mut self) -> bool {
        self.document.redo()
    }

    fn save(&mut self, path: Option<PathBuf>) -> PyResult<()> {
        match path {
            None => self.document.save(),
            Some(path) => self.document.save_as(&path),
        }
        .map_err(unwritten)
    }

    /// The scene that the texts make, as they are now.
    fn scene(&mut self, py: Python<'_>) -> PyResult<Scene> {
        let document = &mut self.document;
        py.detach(|| document.compile());
        let lines: Vec<String> = document.lines().collect();
        match document.scene().filter(|_| document.is_current()) {
            Some(scene) => Ok(Scene::new(Arc::clone(scene), lines)),
            None => Err(scene_error(py, document.report(false), lines)),
        }
    }
}
