//! Reading the keys of a block, with everything left over an error.
//!
//! A member of the language says which keys it knows by asking for them; what
//! it never asked for is unknown. So the list of allowed words in a message
//! cannot differ from what the code reads.

use crate::args::{Args, one_of};
use crate::diagnostic::{Diagnostic, Diagnostics, quoted};
use crate::nearest::nearest;
use crate::tree::{Item, SceneDesc};
use std::borrow::Cow;

/// The content of a block, or of the whole scene, as keys to ask for.
///
/// ```
/// use kajo_scene::{Args, Diagnostics, Params, SceneDesc};
/// let parsed = SceneDesc::parse_str("Sphere moon { center 0 1 0  raduis 2 }");
/// let mut diagnostics = Diagnostics::new();
/// let mut params = Params::new(parsed.desc.roots().next().unwrap(), &mut diagnostics);
/// assert_eq!(params.name().as_deref(), Some("moon"));
/// let center = params.required("center", Args::vec3);
/// let radius = params.or("radius", 1.0, Args::positive);
/// params.finish();
/// assert_eq!((center.unwrap().y, radius), (1.0, 1.0));
/// assert_eq!(diagnostics.errors().next().unwrap().help.as_deref(), Some("did you mean `radius`?"));
/// ```
pub struct Params<'a, 'd> {
    /// `None` for the whole scene.
    item: Option<Item<'a>>,
    diagnostics: &'d mut Diagnostics,
    children: Vec<Child<'a>>,
    asked: Vec<&'static str>,
    later: &'d [&'static str],
    values_used: bool,
    word_used: bool,
    /// There is no block, which has been reported: missing keys are no news.
    no_block: bool,
}

struct Child<'a> {
    item: Item<'a>,
    used: bool,
}

impl<'a, 'd> Params<'a, 'd> {
    /// The content of the item's block. An item without a block is reported.
    pub fn new(item: Item<'a>, diagnostics: &'d mut Diagnostics) -> Self {
        let no_block = !item.has_block();
        if no_block && !item.is_bare() {
            diagnostics.push(
                Diagnostic::error(format!("expected a block after `{}`", item.keyword()))
                    .label(item.head_span(), "no `{` follows")
                    .help(format!("write `{} {{ ... }}`", item.keyword())),
            );
        }
        Self::over(Some(item), item.children(), diagnostics, no_block)
    }

    /// The items of the scene that stand in no block.
    pub fn root(desc: &'a SceneDesc, diagnostics: &'d mut Diagnostics) -> Self {
        Self::over(None, desc.roots(), diagnostics, false)
    }

    fn over(
        item: Option<Item<'a>>,
        children: impl Iterator<Item = Item<'a>>,
        diagnostics: &'d mut Diagnostics,
        no_block: bool,
    ) -> Self {
        let children = children.map(|item| Child { item, used: false }).collect();
        Self {
            item,
            diagnostics,
            children,
            asked: Vec::new(),
            later: &[],
            values_used: no_block,
            word_used: no_block,
            no_block,
        }
    }

    /// Where to report what cannot be said through a reader.
    pub fn diagnostics(&mut self) -> &mut Diagnostics {
        self.diagnostics
    }

    /// The value of `key`, or `None` when the key is absent or wrong.
    pub fn optional<T>(
        &mut self,
        key: &'static str,
        reader: impl FnOnce(&mut Args<'a>) -> Result<T, Diagnostic>,
    ) -> Option<T> {
        let item = self.take_last(key)?;
        Args::read(item, self.diagnostics, reader)
    }

    /// The value of `key`, or `default` when the key is absent or wrong.
    pub fn or<T>(
        &mut self,
        key: &'static str,
        default: T,
        reader: impl FnOnce(&mut Args<'a>) -> Result<T, Diagnostic>,
    ) -> T {
        self.optional(key, reader).unwrap_or(default)
    }

    /// The value of `key`; its absence is an error. `None` means an error was reported.
    pub fn required<T>(
        &mut self,
        key: &'static str,
        reader: impl FnOnce(&mut Args<'a>) -> Result<T, Diagnostic>,
    ) -> Option<T> {
        match self.take_last(key) {
            Some(item) => Args::read(item, self.diagnostics, reader),
            None => {
                self.report_missing(key);
                None
            }
        }
    }

    /// The values that stand before the block, read in order.
    pub fn own<T>(&mut self, reader: impl FnOnce(&mut Args<'a>) -> Result<T, Diagnostic>) -> Option<T> {
        self.values_used = true;
        self.word_used = true;
        Args::read_head(self.item?, self.diagnostics, reader)
    }

    /// The word or string before the block, as in `PhongMaterial gold { ... }`.
    pub fn name(&mut self) -> Option<Cow<'a, str>> {
        self.word_used = true;
        self.item?.word().map(|word| word.text())
    }

    /// The one block called `key`, or `None`; when repeated the last wins, with a warning.
    pub fn block(&mut self, key: &'static str) -> Option<Item<'a>> {
        self.take_last(key)
    }

    /// Every item with one of these keywords, in the order of the text.
    pub fn take(&mut self, keys: &[&'static str]) -> Vec<Item<'a>> {
        self.asked.extend(keys);
        self.take_if(|item| keys.contains(&item.keyword()))
    }

    /// Every item not asked for yet that has a block, in the order of the text.
    pub fn blocks(&mut self) -> Vec<Item<'a>> {
        self.take_if(|item| item.has_block())
    }

    /// Every item not asked for yet, in the order of the text.
    pub fn rest(&mut self) -> Vec<Item<'a>> {
        self.take_if(|_| true)
    }

    /// Keywords that are part of the language but not built yet; each use is reported so.
    pub fn later(&mut self, keys: &'d [&'static str]) {
        self.later = keys;
    }

    /// Reports everything that was never asked for.
    pub fn finish(self) {
        for child in self.children.iter().filter(|child| !child.used) {
            let diagnostic = if self.later.contains(&child.item.keyword()) {
                not_supported_yet(child.item)
            } else {
                let place = self.item.map(|item| item.keyword());
                unknown_word(child.item, place, self.asked.iter().copied())
            };
            self.diagnostics.push(diagnostic);
        }
        if let Some(item) = self.item {
            let word = item.word().map(|word| word.span).filter(|_| !self.word_used);
            let number = item.numbers().next().map(|(_, span)| span).filter(|_| !self.values_used);
            if let Some(span) = word.or(number) {
                let found = quoted(item.desc().sources().text(span));
                self.diagnostics.push(
                    Diagnostic::error(format!("unexpected {found} after `{}`", item.keyword()))
                        .label(span, "expected only a block here"),
                );
            }
        }
    }

    /// The last child called `key`; earlier ones are marked used, with a warning.
    fn take_last(&mut self, key: &'static str) -> Option<Item<'a>> {
        self.asked.push(key);
        let mut last: Option<Item<'a>> = None;
        for child in self.children.iter_mut().filter(|child| child.item.keyword() == key) {
            child.used = true;
            if let Some(earlier) = last.replace(child.item) {
                self.diagnostics.push(
                    Diagnostic::warning(format!("`{key}` is given again; the last one counts"))
                        .label(child.item.head_span(), "this one counts")
                        .label(earlier.head_span(), "this one has no effect"),
                );
            }
        }
        last
    }

    fn take_if(&mut self, wanted: impl Fn(Item<'a>) -> bool) -> Vec<Item<'a>> {
        let mut taken = Vec::new();
        for child in self.children.iter_mut().filter(|child| !child.used && wanted(child.item)) {
            child.used = true;
            taken.push(child.item);
        }
        taken
    }

    fn report_missing(&mut self, key: &str) {
        if self.no_block {
            return;
        }
        self.diagnostics.push(match self.item {
            Some(item) => Diagnostic::error(format!("`{}` needs `{key}`", item.keyword()))
                .label(item.keyword_span(), format!("no `{key}` in this block")),
            None => Diagnostic::error(format!("the scene needs `{key}`")),
        });
    }
}

/// The error for an item whose keyword means nothing in `place` (`None`: outside
/// of all blocks), with the nearest of the words allowed there, or all of them.
pub fn unknown_word<'w>(
    item: Item<'_>,
    place: Option<&str>,
    allowed: impl Iterator<Item = &'w str> + Clone,
) -> Diagnostic {
    let word = quoted(item.keyword());
    let message = match place {
        Some(place) => format!("unknown word {word} in `{place}`"),
        None => format!("unknown word {word}"),
    };
    let help = match nearest(item.keyword(), allowed.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("expected {}", one_of(allowed)),
    };
    Diagnostic::error(message).label(item.keyword_span(), "not known here").help(help)
}

/// The error for an item that is part of the language but not built yet.
pub fn not_supported_yet(item: Item<'_>) -> Diagnostic {
    Diagnostic::error(format!("`{}` is not supported yet", item.keyword()))
        .label(item.keyword_span(), "this version cannot render it")
}
