//! What the user wrote to make each object, and where: sixteen bytes an object, for there may be millions.

use std::num::NonZeroU32;
use std::sync::Arc;

/// An object's words, kept by number in [`Objects`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    name: Option<NameId>,
    /// The item that describes it, see [`Object::described_by`].
    item: u32,
    keyword: KeywordId,
}

/// Names an entry of [`Objects::names`], counted from 1 so that having none takes no room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct NameId(NonZeroU32);

/// Names an entry of [`Objects::keywords`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct KeywordId(u16);

impl Label {
    /// The number of the item that describes it.
    pub(crate) fn item(self) -> u32 {
        self.item
    }
}

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
        let keyword = u16::try_from(number).expect("keywords are those of the language, some hundreds");
        Label { name: name.and_then(|name| self.add_name(name)), item, keyword: KeywordId(keyword) }
    }

    /// Keeps a name; `None` where 32 bits do not hold its number.
    fn add_name(&mut self, name: Arc<str>) -> Option<NameId> {
        let number = u32::try_from(self.names.len() + 1).ok().and_then(NonZeroU32::new)?;
        self.names.push(name);
        Some(NameId(number))
    }

    /// Adds an object that the item with the number `placed_by` puts into the scene.
    pub(crate) fn push(&mut self, label: Label, placed_by: u32) {
        self.labels.push(label);
        self.placed_by.push(placed_by);
    }

    /// Gives an object another name; `false` where there is none of that number.
    pub(crate) fn rename(&mut self, primitive: usize, name: Arc<str>) -> bool {
        if primitive >= self.labels.len() {
            return false;
        }
        self.labels[primitive].name = self.add_name(name);
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
            name: label.name.and_then(|NameId(n)| self.names.get(n.get() as usize - 1)).map(|name| &**name),
            keyword: self.keywords.get(usize::from(label.keyword.0))?,
            described_by: label.item,
            placed_by,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words of more keywords than a byte counts, with and without names, are those that were given.
    #[test]
    fn words_are_kept() {
        const KEYWORDS: [&str; 300] = {
            let text = "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyz";
            let mut words = [""; 300];
            let mut i = 0;
            while i < 300 {
                let (_, tail) = text.split_at(i % 26);
                (words[i], _) = tail.split_at(1 + i / 26);
                i += 1;
            }
            words
        };
        let mut objects = Objects::default();
        for (i, keyword) in (0..).zip(KEYWORDS) {
            let name = (i % 3 == 0).then(|| format!("number {i}").into());
            let label = objects.label(name, keyword, i + 7);
            objects.push(label, i);
        }
        assert!(objects.rename(1, "another".into()) && !objects.rename(300, "nobody".into()));
        for (i, object) in objects.iter().enumerate() {
            let name = (i % 3 == 0).then(|| format!("number {i}"));
            let name = if i == 1 { Some("another") } else { name.as_deref() };
            assert_eq!((object.name, object.keyword), (name, KEYWORDS[i]));
            assert_eq!((object.described_by, object.placed_by), (i as u32 + 7, i as u32));
        }
        assert_eq!(size_of::<Label>() + size_of::<u32>(), 16);
    }
}
