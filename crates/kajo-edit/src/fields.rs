//! The values of a block, one by one, to show and to set.
//!
//! Setting a value replaces the bytes of those numbers or words that differ. A field that is absent is inserted after
//! the last one, in the manner of the block.

use std::ops::Range;

use kajo_core::scene::Scene;
use kajo_core::schema::{
    Absent, Around, Block, FieldKind, FieldSpec, FieldValue, Kind, NumberRange, number_text, quoted,
};
use kajo_core::settings::Settings;
use kajo_scene::Item;

use super::tree::Tree;
use super::{EditRefused, FileId, Node, TextEdit, layout};
use kajo::{Defaults, RenderSettings};

/// A value of a block.
#[derive(Clone, Debug)]
pub struct Field {
    /// The word it is written by.
    pub key: String,
    /// Which of several with that key, from 0.
    pub nth: usize,
    /// The type of its value.
    pub kind: FieldKind,
    /// The range of a slider; see [`FieldSpec::slider`].
    pub slider: Option<[f64; 2]>,
    /// What it says, in a few words.
    pub about: &'static str,
    /// What holds: the value written, or the default; `None` where no value says what holds.
    pub value: Option<FieldValue>,
    /// The bytes of its item; `None` while it is absent.
    pub span: Option<(FileId, Range<usize>)>,
    /// What its absence means where no value says that, in a word or two.
    pub means: &'static str,
    /// What a first change begins with: what holds, or else a usual value; nothing for text that has to be typed.
    pub start: FieldValue,
    /// Why it cannot be set as the block is now, in a few words; `None` where it is written, or can be.
    pub idle: Option<String>,
    /// Whether the block is an error without it.
    pub required: bool,
}

impl Field {
    /// Whether it is the one with this key, `nth` of several.
    pub fn is(&self, key: &str, nth: usize) -> bool {
        self.key == key && self.nth == nth
    }
}

impl Tree {
    /// The fields of a node: those that its kind may have, and whatever else is written there.
    ///
    /// * `scene`: what the texts make, for defaults that depend on it
    pub(super) fn fields(&self, node: &Node, scene: Option<&Scene>) -> Vec<Field> {
        let written: Vec<Item<'_>> = self.values_of(node).collect();
        let mut specs = fields_of(node);
        let is_order = specs.clone().next().is_some() && specs.all(|spec| spec.repeats);
        if is_order || matches!(node.kind, Kind::Transform | Kind::Instance) {
            return self.written_in_order(node, &written);
        }
        let specs = fields_of(node);
        let mut fields: Vec<Field> = Vec::new();
        for spec in specs.clone() {
            if spec.repeats {
                let items = written.iter().filter(|item| item.keyword() == spec.key);
                fields.extend(items.enumerate().map(|(nth, item)| self.written(spec, nth, *item)));
                // One more.
                let nth = fields.iter().filter(|field| field.key == spec.key).count();
                fields.push(self.absent(node, spec, nth, scene));
                continue;
            }
            let nth = fields.iter().filter(|field| field.key == spec.key).count();
            let repeats = specs.clone().filter(|other| other.key == spec.key).count() > 1;
            let mut same = written.iter().filter(|item| item.keyword() == spec.key);
            // The last of a key that is given again counts.
            let item = if repeats { same.nth(nth) } else { same.next_back() };
            match item {
                Some(item) => fields.push(self.written(spec, nth, *item)),
                // Lists count their members themselves; a count that is set is one more thing to be wrong.
                None if spec.kind == FieldKind::Count => {}
                // Of several spellings there is the one that is written, or else the usual one.
                None if spec.same_as.is_some() || self.other_spelling(node, spec.key).is_some() => {}
                None => fields.push(self.absent(node, spec, nth, scene)),
            }
        }
        let unknown = written
            .iter()
            .enumerate()
            .filter(|(_, item)| !specs.clone().any(|spec| spec.key == item.keyword()));
        fields.extend(unknown.filter(|_| !node.kind.holds_objects()).map(|(i, &item)| {
            let nth = written[..i].iter().filter(|other| other.keyword() == item.keyword()).count();
            let value = FieldValue::of(item);
            let kind =
                if value.word.is_some() { FieldKind::Text } else { FieldKind::Groups(&[NumberRange::ANY]) };
            let absent = Absent::Nothing { means: "", start: "" };
            let spec = FieldSpec { absent, ..FieldSpec::new("", kind) };
            Field { key: item.keyword().to_owned(), ..self.written(&spec, nth, item) }
        }));
        fields
    }

    /// Operations, and the segments of a path: their order counts.
    fn written_in_order(&self, node: &Node, written: &[Item<'_>]) -> Vec<Field> {
        let specs = fields_of(node);
        let field = |(i, item): (usize, &Item<'_>)| {
            let spec = specs.clone().find(|spec| spec.key == item.keyword())?;
            let nth = written[..i].iter().filter(|other| other.keyword() == spec.key).count();
            Some(self.written(spec, nth, *item))
        };
        written.iter().enumerate().filter_map(field).collect()
    }

    /// A field that is written.
    fn written(&self, spec: &FieldSpec, nth: usize, item: Item<'_>) -> Field {
        let value = FieldValue::of(item);
        Field {
            key: spec.key.to_owned(),
            nth,
            kind: spec.kind,
            slider: spec.slider,
            about: spec.about,
            value: Some(value.clone()),
            span: Some(self.range(item)),
            means: "",
            start: value,
            idle: None,
            required: matches!(spec.absent, Absent::Required),
        }
    }

    /// A field that is not.
    fn absent(&self, node: &Node, spec: &FieldSpec, nth: usize, scene: Option<&Scene>) -> Field {
        let value = self.default(node, spec, scene);
        let (means, start) = match spec.absent {
            Absent::Nothing { means, start } if !start.is_empty() => (means, FieldValue::parse(start)),
            Absent::Nothing { means, .. } | Absent::Rule { means, .. } => (means, spec.kind.plain()),
            Absent::Required | Absent::Value(_) => ("", spec.kind.plain()),
        };
        Field {
            key: spec.key.to_owned(),
            nth,
            kind: spec.kind,
            slider: spec.slider,
            about: spec.about,
            span: None,
            means,
            start: value.clone().unwrap_or(start),
            value,
            idle: self.idle(node, spec),
            required: matches!(spec.absent, Absent::Required),
        }
    }

    /// Why a field that is absent cannot be set.
    fn idle(&self, node: &Node, spec: &FieldSpec) -> Option<String> {
        let is_written = |key: &str| self.value_item(node, key, None).is_some();
        let missing = spec.needs.filter(|key| !is_written(key)).map(|key| format!("only with `{key}`"));
        let clash =
            || spec.excludes.iter().find(|key| is_written(key)).map(|key| format!("not with `{key}`"));
        missing.or_else(clash)
    }

    /// What holds while a field is absent, where a value says that.
    fn default(&self, node: &Node, spec: &FieldSpec, scene: Option<&Scene>) -> Option<FieldValue> {
        match spec.absent {
            _ if self.idle(node, spec).is_some() => None,
            Absent::Value(constant) => Some(constant.into()),
            Absent::Rule { value, .. } => value(&Around {
                value: &|key| self.value(node, key, scene),
                is_written: &|key| self.value_item(node, key, None).is_some(),
                scene,
                render: &|| scene.and_then(settled),
            }),
            Absent::Required | Absent::Nothing { .. } => None,
        }
    }

    /// Another spelling of a key that is written in a node's block.
    fn other_spelling(&self, node: &Node, key: &str) -> Option<Item<'_>> {
        let mut others =
            node.block.into_iter().flat_map(|block| block.spellings_of(key)).filter(|other| *other != key);
        others.find_map(|other| self.value_item(node, other, None))
    }

    /// The items of a node's block that are no nodes themselves, and pictures, which are both: a value, and what is said of it.
    pub(super) fn values_of(&self, node: &Node) -> impl Iterator<Item = Item<'_>> {
        let children = self.item(node).into_iter().flat_map(|item| item.children());
        let is_value = |node: &Node| node.kind == Kind::Picture;
        children.filter(move |child| self.outline.at_item(child.index()).is_none_or(is_value))
    }

    /// The item of the `nth` value called `key`; the last one for `None`.
    pub(super) fn value_item(&self, node: &Node, key: &str, nth: Option<usize>) -> Option<Item<'_>> {
        let mut same = self.values_of(node).filter(|item| item.keyword() == key);
        match nth {
            Some(nth) => same.nth(nth),
            None => same.last(),
        }
    }

    /// Sets a value, or takes it out for `None`.
    pub(super) fn set_field(
        &self,
        node: &Node,
        key: &str,
        nth: Option<usize>,
        value: Option<&FieldValue>,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let pair = fields_of(node).find(|spec| spec.key == key).and_then(|spec| spec.pair);
        let item = self.value_item(node, key, nth).or_else(|| self.other_spelling(node, key));
        let other = pair.and_then(|pair| self.value_item(node, pair, None));
        match (item, value) {
            (Some(item), Some(value)) => self.set_values_of(item, value),
            (Some(item), None) => {
                let mut items: Vec<Item<'_>> = [item].into_iter().chain(other).collect();
                items.sort_by_key(|item| item.index());
                Ok(self.without(&items))
            }
            (None, Some(value)) => self.insert_text(node, key, &value.text()),
            (None, None) => Ok(Vec::new()),
        }
    }

    /// Makes these all the values of a key that repeats: those that are there become the first ones, more of them follow the last, and what
    /// is there beyond them is taken out.
    pub(super) fn set_list(
        &self,
        node: &Node,
        key: &str,
        values: &[FieldValue],
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let items: Vec<Item<'_>> = self.values_of(node).filter(|item| item.keyword() == key).collect();
        let mut edits = Vec::new();
        for (item, value) in items.iter().zip(values) {
            edits.extend(self.set_values_of(*item, value)?);
        }
        let Some(last) = items.last() else {
            let more: Vec<String> = values.iter().map(FieldValue::text).collect();
            return if more.is_empty() {
                Ok(edits)
            } else {
                self.insert_text(node, key, &more.join(&format!("  {key} ")))
            };
        };
        let (file, span) = self.range(*last);
        for value in values.iter().skip(items.len()) {
            let (at, new) = layout::after(self.text(file), &span, &format!("{key} {}", value.text()));
            edits.push(TextEdit::insert(file, at, new));
        }
        edits.extend(self.without(items.get(values.len()..).unwrap_or_default()));
        Ok(edits)
    }

    /// Takes out items that stand in this order.
    fn without(&self, items: &[Item<'_>]) -> Vec<TextEdit> {
        let mut edits: Vec<TextEdit> = Vec::new();
        for item in items {
            let (file, span) = self.range(*item);
            let range = layout::removal(self.text(file), &span);
            match edits.last_mut().filter(|last| last.file == file && last.range.end >= range.start) {
                Some(last) => last.range.end = last.range.end.max(range.end),
                None => edits.push(TextEdit { file, range, new: String::new() }),
            }
        }
        edits
    }

    /// What a first change of an absent field begins with.
    pub(super) fn start(&self, node: &Node, key: &str) -> FieldValue {
        let spec = fields_of(node).find(|spec| spec.key == key);
        spec.map_or_else(FieldValue::default, |spec| self.absent(node, spec, 0, None).start)
    }

    /// Sets some of the numbers of a value that is there.
    pub(super) fn set_some(
        &self,
        node: &Node,
        key: &str,
        numbers: &[Option<f64>],
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let absent = || EditRefused::new(format!("there is no `{key}` here"));
        let item = self.value_item(node, key, None).ok_or_else(absent)?;
        let mut value = FieldValue::of(item);
        for (old, new) in value.numbers.iter_mut().zip(numbers) {
            *old = new.unwrap_or(*old);
        }
        self.set_values_of(item, &value)
    }

    /// The value that holds for a key: the one written, or the default.
    ///
    /// * `scene`: as for [`Tree::fields`]
    pub(super) fn value(&self, node: &Node, key: &str, scene: Option<&Scene>) -> Option<FieldValue> {
        if let Some(item) = self.value_item(node, key, None).or_else(|| self.other_spelling(node, key)) {
            return Some(FieldValue::of(item));
        }
        let spec = fields_of(node).find(|spec| spec.key == key)?;
        self.default(node, spec, scene)
    }

    /// Inserts a value that is absent, as text; behind it the one without which it says nothing, if that is absent too.
    pub(super) fn insert_text(
        &self,
        node: &Node,
        key: &str,
        value: &str,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        let pair = fields_of(node).find(|spec| spec.key == key).and_then(|spec| spec.pair);
        let pair = pair.filter(|pair| self.value_item(node, pair, None).is_none());
        let pair = pair.map(|pair| format!("{pair} {}", self.start(node, pair).text()));
        let pieces: Vec<String> = std::iter::once(format!("{key} {value}")).chain(pair).collect();
        let text = self.text(node.file);
        let is_operation = matches!(node.kind, Kind::Transform | Kind::Instance);
        if let Some(last) = self.values_of(node).last() {
            let span = self.range(last).1;
            let inserted = pieces.iter().map(|piece| {
                let (at, new) = layout::after(text, &span, piece);
                TextEdit::insert(node.file, at, new)
            });
            return Ok(inserted.collect());
        }
        let piece = pieces.join("  ");
        let (at, new) = match layout::first_in(text, &node.span, &piece) {
            Some(place) => place,
            None if is_operation => (node.span.end, format!(" {{ {piece} }}")),
            None => return Err(EditRefused::new(format!("`{}` has no block", node.keyword))),
        };
        Ok(vec![TextEdit::insert(node.file, at, new)])
    }

    pub(super) fn replace_values(&self, item: Item<'_>, value: &FieldValue) -> Vec<TextEdit> {
        let file = self.file_of(item.span().source);
        let mut edits = Vec::new();
        let numbers: Vec<(f64, Range<usize>)> = item.numbers().map(|(n, span)| (n, span.range())).collect();
        let same_shape =
            item.word().is_some() == value.word.is_some() && numbers.len() == value.numbers.len();
        if !same_shape {
            return self.rewrite_values(item, value);
        }
        if let (Some(old), Some(new)) = (item.word(), &value.word)
            && old.text() != new.as_str()
        {
            edits.push(TextEdit { file, range: old.span.range(), new: quoted(new).into_owned() });
        }
        for ((old, range), &new) in numbers.into_iter().zip(&value.numbers) {
            if !is_same_number(old, new) {
                edits.push(TextEdit { file, range, new: number_text(new) });
            }
        }
        edits
    }

    /// Puts a value in the place of one with another number of words or numbers.
    fn rewrite_values(&self, item: Item<'_>, value: &FieldValue) -> Vec<TextEdit> {
        let file = self.file_of(item.span().source);
        let spans = || item.values().map(|(_, span)| span.range());
        let range = match (spans().next(), spans().last()) {
            (Some(first), Some(last)) => first.start..last.end,
            _ => item.keyword_span().range().end..item.keyword_span().range().end,
        };
        let gap = if range.is_empty() { " " } else { "" };
        vec![TextEdit { file, range, new: format!("{gap}{}", value.text()) }]
    }
}

/// Whether two numbers are one for a scene, which keeps single precision except of whole numbers.
pub(super) fn is_same_number(a: f64, b: f64) -> bool {
    a == b || (a as f32 == b as f32 && (a.fract() != 0.0 || b.fract() != 0.0))
}

/// The fields that a node may have.
pub(super) fn fields_of(node: &Node) -> impl Iterator<Item = &'static FieldSpec> + Clone + use<> {
    node.block.into_iter().flat_map(Block::fields)
}

/// The default settings of a render of a scene, those that depend on it.
fn settled(scene: &Scene) -> Option<Settings> {
    let render = RenderSettings::resolve(scene, &Settings::default(), Defaults::Modern, false).ok()?;
    Some(render.values())
}

#[cfg(test)]
mod tests;
