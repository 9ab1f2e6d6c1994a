//! What the user wrote to make each object, and where: sixteen bytes an object, for there may be millions.

use std::sync::Arc;

/// An object's words, kept by number in [`Objects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    name: u32,
    /// The item that describes it, see [`Object::described_by`].
    item: u32,
    keyword: u8,
}

impl Label {
    /// The number of the item that describes it.
    pub(crate) fn item(self) -> u32 {
        self.item
    }
}

/// Stands for "no name" in a [`Label`].
const NO_NAME: u32 = u32::MAX;

/// What a user wrote as one object of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Object<'a> {
    /// The name given in the scene, if any.
    pub name: Option<&'a str>,
    /// The word that made it, such as `Sphere`.
    pub keyword: &'static str,
    /// Number of the item that describes it among [`kajo_scene::SceneDesc::items`]: a shape, or a model.
    pub described_by: u32,
    /// Number of the item that puts it into the scene: the shape itself, or the outermost instance.
    pub placed_by: u32,
}

/// The user's words for each primitive.
#[derive(Debug, Default)]
pub struct Objects {
    labels: Vec<Label>,
    placed_by: Vec<u32>,
    names: Vec<Arc<str>>,
    keywords: Vec<&'static str>,
}

impl Objects {
    /// Keeps an object's words. Objects of the same definition share them.
    ///
    /// * `item`: number of the item that describes it
    pub(crate) fn label(&mut self, name: Option<Arc<str>>, keyword: &'static str, item: u32) -> Label {
        let known = self.keywords.iter().position(|&k| k == keyword);
        let number = known.unwrap_or_else(|| {
            self.keywords.push(keyword);
            self.keywords.len() - 1
        });
        let name = name.map_or(NO_NAME, |name| {
            self.names.push(name);
            self.names.len() as u32 - 1
        });
        Label { name, item, keyword: number as u8 }
    }

    /// Adds an object that the item with the number `placed_by` puts into the scene.
    pub(crate) fn push(&mut self, label: Label, placed_by: u32) {
        self.labels.push(label);
        self.placed_by.push(placed_by);
    }

    /// Gives an object another name; `false` where there is none of that number.
    pub(crate) fn rename(&mut self, primitive: usize, name: Arc<str>) -> bool {
        let number = self.names.len() as u32;
        let Some(label) = self.labels.get_mut(primitive) else { return false };
        label.name = number;
        self.names.push(name);
        true
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.labels.len()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let names: usize = self.names.iter().map(|name| name.len() + size_of_val(name)).sum();
        size_of_val(&*self.labels) + size_of_val(&*self.placed_by) + names
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.labels.is_empty()
    }

    /// The words of all primitives, in their order.
    pub fn iter(&self) -> impl Iterator<Item = Object<'_>> {
        (0..self.labels.len()).filter_map(|primitive| self.get(primitive))
    }

    /// The words of a primitive, by its index into [`crate::scene::Geometry::primitives`].
    pub fn get(&self, primitive: usize) -> Option<Object<'_>> {
        self.words(*self.labels.get(primitive)?, *self.placed_by.get(primitive)?)
    }

    /// The words of an object with a label.
    pub(crate) fn words(&self, label: Label, placed_by: u32) -> Option<Object<'_>> {
        Some(Object {
            name: self.names.get(label.name as usize).map(|name| &**name),
            keyword: self.keywords.get(usize::from(label.keyword))?,
            described_by: label.item,
            placed_by,
        })
    }
}
