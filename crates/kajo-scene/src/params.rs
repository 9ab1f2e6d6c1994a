//! Reading the keys of a block, with everything left over an error.
//!
//! A member of the language says which keys it knows by asking for them; what
//! it never asked for is unknown. So the list of allowed words in a message
//! cannot differ from what the code reads.

use crate::args::{Args, one_of};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity, quoted};
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

    /// The content of the item's block, and nothing for an item that has none and needs none.
    pub fn within(item: Item<'a>, diagnostics: &'d mut Diagnostics) -> Self {
        Self::over(Some(item), item.children(), diagnostics, false)
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

    /// Whether an item called `key` is there that has not been read yet.
    pub fn has(&self, key: &str) -> bool {
        self.children.iter().any(|child| !child.used && child.item.keyword() == key)
    }

    /// Whether an item called `key` is there, asked for or not.
    pub fn contains(&self, key: &str) -> bool {
        self.children.iter().any(|child| child.item.keyword() == key)
    }

    /// Warns of the items among `keys` that are there, asked for or not: for this reason they have no effect.
    pub fn idle(&mut self, keys: &[&str], reason: &str) {
        for child in self.children.iter().filter(|child| keys.contains(&child.item.keyword())) {
            let warning = Diagnostic::warning(format!("`{}` has no effect {reason}", child.item.keyword()));
            self.diagnostics.push(warning.label(child.item.head_span(), "left aside"));
        }
    }

    /// Reports what is to be said of the block itself.
    pub fn report(&mut self, diagnostic: Diagnostic, label: &str) {
        self.diagnostics.push(match self.item {
            Some(item) => diagnostic.label(item.head_span(), label),
            None => diagnostic,
        });
    }

    /// Warns at the last item called `key`, asked for or not.
    pub fn warn(&mut self, key: &str, message: impl Into<String>, label: &str) {
        let warning = Diagnostic::warning(message);
        let place = self.children.iter().rev().find(|child| child.item.keyword() == key);
        self.diagnostics.push(match place {
            Some(child) => warning.label(child.item.head_span(), label),
            None => warning,
        });
    }

    /// Reports the items called `key`, asked for or not, as an error for this reason: `beside ...` or `without ...`.
    pub fn refuse(&mut self, key: &str, reason: &str) {
        for child in self.children.iter().filter(|child| child.item.keyword() == key) {
            let error = Diagnostic::error(format!("`{key}` cannot stand {reason}"));
            self.diagnostics.push(error.label(child.item.head_span(), "not here"));
        }
    }

    /// Reports when more than one of `keys` is there, which are words for the same thing; what they say is still to be
    /// asked for.
    pub fn either(&mut self, keys: &[&str], what: &str) {
        let mut first: Option<Item<'a>> = None;
        for child in self.children.iter_mut().filter(|child| keys.contains(&child.item.keyword())) {
            let other = first.filter(|first| first.keyword() != child.item.keyword());
            if let Some(other) = other {
                let error = Diagnostic::error(format!("{what} has {}, not both", one_of(keys)));
                let error = error.label(child.item.head_span(), "one too many");
                self.diagnostics.push(error.label(other.head_span(), "the other one"));
            }
            first.get_or_insert(child.item);
            // Unknown it is not.
            child.used = true;
        }
    }

    /// The one block called `key`, or `None`; when repeated the last wins, with a warning.
    pub fn block(&mut self, key: &'static str) -> Option<Item<'a>> {
        self.take_last(key)
    }

    /// As [`Params::block`], of those items alone that `is_meant` knows; others are left to be asked for.
    pub fn block_where(
        &mut self,
        key: &'static str,
        is_meant: impl Fn(Item<'a>) -> bool,
    ) -> Option<Item<'a>> {
        self.take_last_where(key, &is_meant)
    }

    /// Every item with one of these keywords, in the order of the text.
    pub fn take(&mut self, keys: &[&'static str]) -> Vec<Item<'a>> {
        self.asked.extend(keys);
        self.take_if(&|item| keys.contains(&item.keyword()))
    }

    /// Reports items that have not been read and for which `error` has a diagnostic, instead of calling them unknown.
    pub fn elsewhere(&mut self, error: impl Fn(Item<'a>) -> Option<Diagnostic>) {
        for child in self.children.iter_mut().filter(|child| !child.used) {
            if let Some(error) = error(child.item) {
                child.used = true;
                self.diagnostics.push(error);
            }
        }
    }

    /// Every item not asked for yet that has a block, in the order of the text.
    pub fn blocks(&mut self) -> Vec<Item<'a>> {
        self.take_if(&|item| item.has_block())
    }

    /// Every item not asked for yet, in the order of the text.
    pub fn rest(&mut self) -> Vec<Item<'a>> {
        self.take_if(&|_| true)
    }

    /// Keywords that are part of the language but not built yet; each use is reported so.
    pub fn later(&mut self, keys: &'d [&'static str]) {
        self.later = keys;
    }

    /// Reports everything that was never asked for.
    pub fn finish(self) {
        for child in self.children.iter().filter(|child| !child.used) {
            // A flood of unknown words is not worth the search for near ones.
            if self.diagnostics.count(Severity::Error) > Diagnostics::KEPT {
                return;
            }
            let diagnostic = if self.later.contains(&child.item.keyword()) {
                not_supported_yet(child.item)
            } else {
                let parent = self.item.map(|item| item.keyword());
                unknown_word(child.item, parent, self.asked.iter().copied())
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
        self.take_last_where(key, &|_| true)
    }

    /// The last child called `key` that is meant; earlier ones are marked used, with a warning.
    fn take_last_where(
        &mut self,
        key: &'static str,
        is_meant: &dyn Fn(Item<'a>) -> bool,
    ) -> Option<Item<'a>> {
        self.asked.push(key);
        let mut last: Option<Item<'a>> = None;
        let same = |child: &&mut Child<'a>| child.item.keyword() == key && is_meant(child.item);
        for child in self.children.iter_mut().filter(same) {
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

    fn take_if(&mut self, wanted: &dyn Fn(Item<'a>) -> bool) -> Vec<Item<'a>> {
        let mut taken = Vec::new();
        for child in self.children.iter_mut().filter(|child| !child.used && wanted(child.item)) {
            child.used = true;
            taken.push(child.item);
        }
        taken
    }

    /// Reports that there is no `key`, unless there is one, which may be wrong, or no block at all.
    pub fn report_missing(&mut self, key: &str) {
        if self.no_block || self.contains(key) {
            return;
        }
        self.diagnostics.push(match self.item {
            Some(item) => Diagnostic::error(format!("`{}` needs `{key}`", item.keyword()))
                .label(item.keyword_span(), format!("no `{key}` in this block")),
            None => Diagnostic::error(format!("the scene needs `{key}`")),
        });
    }
}

/// The error for an item whose keyword means nothing in `parent` (`None`: outside
/// of all blocks), with the nearest of the words allowed there, or all of them.
pub fn unknown_word<'w>(
    item: Item<'_>,
    parent: Option<&str>,
    allowed: impl Iterator<Item = &'w str> + Clone,
) -> Diagnostic {
    let word = quoted(item.keyword());
    let message = match parent {
        Some(parent) => format!("unknown word {word} in `{parent}`"),
        None => format!("unknown word {word}"),
    };
    let help = match nearest(item.keyword(), allowed.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("expected {}", one_of(&allowed.collect::<Vec<_>>())),
    };
    Diagnostic::error(message).label(item.keyword_span(), "not known here").help(help)
}

/// The error for an item that is part of the language but not built yet.
pub fn not_supported_yet(item: Item<'_>) -> Diagnostic {
    Diagnostic::error(format!("`{}` is not supported yet", item.keyword()))
        .label(item.keyword_span(), "this version cannot render it")
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{Vec2, Vec3};

    /// Reads the first item of a text and returns the result and the messages.
    ///
    /// The tree is leaked, so that `Args::vec3` and its like can be passed as they are.
    fn read<T>(text: &str, reader: impl FnOnce(&mut Params<'static, '_>) -> T) -> (T, Vec<String>) {
        let parsed = Box::leak(Box::new(SceneDesc::parse_str(text)));
        let mut diagnostics = parsed.diagnostics.clone();
        let mut params = Params::new(parsed.desc.roots().next().unwrap(), &mut diagnostics);
        let value = reader(&mut params);
        params.finish();
        let messages = diagnostics.iter().map(|d| crate::one_line(d, parsed.desc.sources())).collect();
        (value, messages)
    }

    /// The value of key `k` in `B { k ... }`, or the one message without its place.
    fn value<T>(
        values: &str,
        reader: impl FnOnce(&mut Args<'static>) -> Result<T, Diagnostic>,
    ) -> Result<T, String> {
        let (value, messages) = read(&format!("B {{ k {values} }}"), |params| params.required("k", reader));
        match (value, messages.as_slice()) {
            (Some(value), []) => Ok(value),
            (None, [message]) => Err(message.strip_prefix("scene:1:").unwrap().to_owned()),
            (_, messages) => panic!("{messages:?}"),
        }
    }

    fn error<T: PartialEq + std::fmt::Debug>(text: &str) -> Result<T, String> {
        Err(text.to_owned())
    }

    #[test]
    fn keys_without_effect_are_warned_of_and_words_for_the_same_refused() {
        let said = |text: &str| {
            let reader = |params: &mut Params<'static, '_>| {
                params.either(&["color", "power"], "a light");
                let power = params.optional("power", Args::number);
                let color = params.optional("color", Args::number);
                params.optional("focus", Args::number);
                params.idle(&["focus", "blades"], "here");
                params.warn("color", "odd", "so it is");
                power.or(color)
            };
            read(text, reader)
        };
        assert_eq!(said("B { power 2 }"), (Some(2.0), vec!["warning: odd".to_owned()]));
        let odd = |column: u32| format!("scene:1:{column}: warning: odd");
        assert_eq!(said("B { color 3 }"), (Some(3.0), vec![odd(5)]));
        let (_, both) = said("B { color 3  power 2 }");
        let message = "scene:1:14: error: a light has `color` or `power`, not both";
        assert_eq!(both, [message.to_owned(), odd(5)]);
        let (_, idle) = said("B { color 1  focus 3 }");
        let message = "scene:1:14: warning: `focus` has no effect here";
        assert_eq!(idle, [message.to_owned(), odd(5)]);
    }

    #[test]
    fn numbers_are_counted_and_typed() {
        assert_eq!(value("1 2 3", Args::vec3), Ok(Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(value("1 2", Args::vec2), Ok(Vec2::new(1.0, 2.0)));
        assert_eq!(value("1e300", Args::double), Ok(1e300));
        assert_eq!(value("1 2 3 4", Args::numbers::<4>), Ok([1.0, 2.0, 3.0, 4.0]));
        assert_eq!(value("1 2", Args::vec3), error("7: error: expected 3 numbers after `k`, found 2"));
        assert_eq!(value("1 2 3 4", Args::vec3), error("13: error: expected 3 numbers after `k`, found 4"));
    }

    #[test]
    fn words_are_no_numbers() {
        assert_eq!(value("x", Args::number), error("7: error: expected 1 number after `k`, found `x`"));
        let not_a_number =
            error("7: error: expected 1 number after `k`, found `1.2.3`, which is not a number");
        assert_eq!(value("1.2.3", Args::number), not_a_number);
        let too_large = error("7: error: expected 1 number after `k`, found `1e400`, which is too large");
        assert_eq!(value("1e400", Args::number), too_large);
        assert_eq!(value("x 1", Args::number), error("7: error: expected 1 number after `k`, found `x`"));
    }

    #[test]
    fn ranges_hold_at_their_ends() {
        let angle = |args: &mut Args<'static>| args.number_in(0.0..=180.0);
        assert_eq!(value("0", angle), Ok(0.0));
        assert_eq!(value("180", angle), Ok(180.0));
        let message = "7: error: `k` must be at least 0 and at most 180, found 180.5";
        assert_eq!(value("180.5", angle), error(message));
        assert_eq!(value("-1", |a| a.number_in(0.0..)), error("7: error: `k` must be at least 0, found -1"));
        assert_eq!(value("0", Args::positive), error("7: error: `k` must be more than 0, found 0"));
        assert_eq!(value("1", |a| a.number_in(..1.0)), error("7: error: `k` must be less than 1, found 1"));
        let count = |args: &mut Args<'static>| args.int_in(1..=9);
        assert_eq!((value("1", count), value("9.0", count)), (Ok(1), Ok(9)));
        for wrong in ["0", "10", "1.5", "1e30", "-1e30"] {
            let message = format!("7: error: `k` must be a whole number from 1 to 9, found {wrong}");
            assert_eq!(value(wrong, count), Err(message));
        }
    }

    #[test]
    fn numbers_too_large_for_32_bits_are_refused() {
        assert_eq!(value("3.4e38", Args::number), Ok(3.4e38));
        let message = "9: error: `k` must be between -3.4e38 and 3.4e38, found 1e39";
        assert_eq!(value("1 1e39 1", Args::vec3), error(message));
        assert_eq!(value("1e-60", Args::number), Ok(0.0));
    }

    #[test]
    fn choices_and_flags() {
        let table = [("regular", 1), ("jittered", 2)];
        assert_eq!(value("jittered", |a| a.choice(&table)), Ok(2));
        let message = "7: error: expected `regular` or `jittered` after `k`, found `jitered`";
        assert_eq!(value("jitered", |a| a.choice(&table)), error(message));
        let message = "7: error: expected `regular` or `jittered` after `k`, found 1 number";
        assert_eq!(value("4", |a| a.choice(&table)), error(message));
        for (text, on) in
            [("on", true), ("true", true), ("yes", true), ("1", true), ("off", false), ("0", false)]
        {
            assert_eq!(value(text, Args::flag), Ok(on), "{text}");
        }
        for text in ["2", "maybe", "1 0", "on 1"] {
            assert!(value(text, Args::flag).is_err(), "{text}");
        }
        assert_eq!(
            value("gaussian 0.5", |a| Ok((a.word_of(&["box", "gaussian"])?, a.number()?))),
            Ok(("gaussian", 0.5))
        );
    }

    #[test]
    fn texts_and_points() {
        assert_eq!(value("a/b.obj", |a| a.text().map(|t| t.into_owned())), Ok("a/b.obj".to_owned()));
        assert_eq!(value("\"a \\\" b\"", |a| a.text().map(|t| t.into_owned())), Ok("a \" b".to_owned()));
        let message = "7: error: expected a word or a string in quotes after `k`, found 1 number";
        assert_eq!(value("1", |a| a.text().map(|t| t.into_owned())), error(message));
        assert_eq!(value("1 2 3 4 5 6", Args::points).map(|p| p.len()), Ok(2));
        assert!(value("1 2 3 4", Args::points).unwrap_err().contains("groups of three"));
        assert_eq!(value("{ 1 2 3 }", Args::vec3), Ok(Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(value("1 { a 2 }", Args::number), error("11: error: `k` takes no block"));
    }

    #[test]
    fn missing_unknown_and_repeated_keys() {
        let (values, messages) = read("B { radus 1 b 2 a 3 a 4 Torus { } zzz 1 }", |params| {
            params.later(&["Torus", "Blob"]);
            let required = params.required("radius", Args::number);
            (
                required,
                params.or("a", 0.0, Args::number),
                params.or("c", 7.0, Args::number),
                params.optional("b", Args::vec3),
            )
        });
        assert_eq!(values, (None, 4.0, 7.0, None));
        assert_eq!(
            messages,
            [
                "scene:1:1: error: `B` needs `radius`",
                "scene:1:21: warning: `a` is given again; the last one counts",
                "scene:1:15: error: expected 3 numbers after `b`, found 1",
                "scene:1:5: error: unknown word `radus` in `B`",
                "scene:1:25: error: `Torus` is not supported yet",
                "scene:1:35: error: unknown word `zzz` in `B`",
            ]
        );
    }

    #[test]
    fn unknown_words_come_with_advice() {
        let parsed = SceneDesc::parse_str("raduis 1 torus 2");
        let help = |i: usize, allowed: &[&str]| {
            unknown_word(parsed.desc.roots().nth(i).unwrap(), None, allowed.iter().copied()).help.unwrap()
        };
        assert_eq!(help(0, &["center", "radius"]), "did you mean `radius`?");
        assert_eq!(help(1, &["center", "radius"]), "expected `center` or `radius`");
        assert_eq!(help(1, &[]), "expected nothing");
    }

    #[test]
    fn names_and_values_before_the_block_must_be_asked_for() {
        let (name, messages) = read("B moon { }", |params| params.name().map(|n| n.into_owned()));
        assert_eq!((name.as_deref(), messages.len()), (Some("moon"), 0));
        assert_eq!(read("B moon { }", |_| ()).1, ["scene:1:3: error: unexpected `moon` after `B`"]);
        assert_eq!(read("B 1 2 { }", |_| ()).1, ["scene:1:3: error: unexpected `1` after `B`"]);
        let (own, messages) =
            read("B 1 2 { a 1 }", |params| (params.own(Args::vec2), params.or("a", 0.0, Args::number)));
        assert_eq!((own, messages.len()), ((Some(Vec2::new(1.0, 2.0)), 1.0), 0));
    }

    #[test]
    fn a_missing_block_is_told_once() {
        let (_, messages) = read("B 1", |params| params.required("a", Args::number));
        assert_eq!(messages, ["scene:1:1: error: expected a block after `B`"]);
        let (_, messages) = read("B", |params| params.required("a", Args::number));
        assert_eq!(messages, ["scene:1:1: error: `B` has neither a value nor a block"]);
        let (_, messages) = read("B { a }", |params| params.required("a", Args::number));
        assert_eq!(messages, ["scene:1:5: error: `a` has neither a value nor a block"]);
    }

    #[test]
    fn children_are_handed_out_once_and_in_order() {
        let ((taken, blocks, rest), messages) = read("B { S { } M 1 T { } S { } n 2 }", |params| {
            let keys =
                |items: Vec<Item<'_>>| items.iter().map(|i| i.keyword().to_owned()).collect::<String>();
            (keys(params.take(&["S", "M"])), keys(params.blocks()), keys(params.rest()))
        });
        assert_eq!((taken.as_str(), blocks.as_str(), rest.as_str()), ("SMS", "T", "n"));
        assert_eq!(messages, [""; 0]);
    }

    #[test]
    fn the_whole_scene_is_a_place_too() {
        let parsed = SceneDesc::parse_str("Camera { } size 1 2 3 what 1");
        let mut diagnostics = Diagnostics::new();
        let mut params = Params::root(&parsed.desc, &mut diagnostics);
        assert!(params.block("Camera").is_some() && params.block("Group").is_none());
        assert_eq!(params.required("size", Args::vec3), Some(Vec3::new(1.0, 2.0, 3.0)));
        params.required("Lights", Args::number);
        params.finish();
        assert_eq!(diagnostics.count(Severity::Error), 2);
        let messages: Vec<_> = diagnostics.iter().map(|d| d.message.as_str()).collect();
        assert_eq!(messages, ["the scene needs `Lights`", "unknown word `what`"]);
    }
}
