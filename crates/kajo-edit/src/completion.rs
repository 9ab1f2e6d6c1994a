//! What may be typed at a place of a text: keys of its block that are not there yet, words of a choice, blocks.
//!
//! The text need not be a scene yet. Its tokens are walked from the start: a word begins an item unless it is the one word
//! that may stand behind a keyword, and braces open and close blocks.

use std::ops::Range;

use kajo::language::{block_in, blocks};
use kajo_core::schema::{Block, FieldKind, FieldSpec, Kind};
use kajo_scene::{TokenKind, tokens};

/// A word that may be typed.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// The word.
    pub word: &'static str,
    /// What may be written behind it; empty where that is not known, or nothing.
    pub values: String,
    /// What it is, in a few words; empty for the words of a choice.
    pub about: &'static str,
}

/// What may be typed at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Completion {
    /// The bytes of the word that has been begun, behind the place too; empty where none has.
    pub range: Range<usize>,
    /// What may stand there, in the order of the descriptions.
    pub suggestions: Vec<Suggestion>,
}

/// What may be typed at the byte `at` of a text; `None` within comments, strings and numbers, and where nothing may.
pub fn completion(text: &str, at: usize) -> Option<Completion> {
    let position = TypingPosition::find(text, at)?;
    let mut suggestions = match position.value_of {
        Some(key) => position.words_of(key),
        None => position.keys(),
    };
    let begun = text[position.range.start..at].to_lowercase();
    suggestions.retain(|suggestion| suggestion.word.to_lowercase().starts_with(&begun));
    (!suggestions.is_empty()).then_some(Completion { range: position.range, suggestions })
}

/// A block around the place.
struct Open<'t> {
    /// What it is; `None` for the text itself, and where that is unknown.
    block: Option<&'static Block>,
    /// Whether it is the text itself, or a `repeat` of what stands there.
    is_outermost: bool,
    /// The keys of the items in it.
    keys: Vec<&'t str>,
}

impl<'t> Open<'t> {
    /// The block behind a keyword in this one. A repeat holds what may stand around it.
    fn opens(&self, keyword: &str) -> Open<'t> {
        let is_repeat = keyword == "repeat" && self.block.is_none_or(|block| block.kind != Kind::Picture);
        let block = match self.block {
            around if is_repeat => around,
            None if !self.is_outermost => None,
            around => block_in(around, keyword),
        };
        Open { block, is_outermost: is_repeat && self.is_outermost, keys: Vec::new() }
    }
}

/// What is known of a place as soon as it is found.
struct Found<'t> {
    range: Range<usize>,
    value_of: Option<&'t str>,
    /// How many blocks are around it, the text itself included.
    depth: usize,
}

/// Whether a word is a key of the innermost block.
fn is_key(open: &[Open<'_>], word: &str) -> bool {
    open.last().and_then(|open| open.block).is_some_and(|block| block.field(word).is_some())
}

/// Where in a text something is to be typed.
struct TypingPosition<'t> {
    range: Range<usize>,
    /// The text and the blocks around the place, the innermost last, with all keys that stand in that one.
    open: Vec<Open<'t>>,
    /// The key behind which it stands, where a word may follow.
    value_of: Option<&'t str>,
}

impl<'t> TypingPosition<'t> {
    fn find(text: &'t str, at: usize) -> Option<TypingPosition<'t>> {
        let mut open = vec![Open { block: None, is_outermost: true, keys: Vec::new() }];
        // The last keyword, and whether its one word may still follow.
        let (mut keyword, mut takes_word) = ("", false);
        // Whether that is being typed: the next key may follow at once.
        let mut is_begun = false;
        let mut found: Option<Found<'t>> = None;
        for token in tokens(text) {
            let (range, piece) = (token.range(), &text[token.range()]);
            let mut is_typed = false;
            if found.is_none() {
                let touches = range.start < at && at <= range.end;
                let here = match token.kind {
                    TokenKind::Word if touches => Some(range.clone()),
                    TokenKind::Whitespace if touches => Some(at..at),
                    TokenKind::OpenBrace | TokenKind::CloseBrace if touches => None,
                    _ if touches => return None,
                    _ if range.start >= at => Some(at..at),
                    _ => None,
                };
                is_typed = here.as_ref().is_some_and(|range| !range.is_empty());
                let value_of = takes_word.then_some(keyword);
                found = here.map(|range| Found { range, value_of, depth: open.len() });
            }
            match token.kind {
                TokenKind::Whitespace | TokenKind::Comment => {}
                TokenKind::Word if !takes_word || is_begun && is_key(&open, piece) => {
                    (keyword, takes_word, is_begun) = (piece, true, is_typed);
                    // What is being typed is not there yet.
                    open.last_mut()?.keys.extend((!is_typed).then_some(piece));
                }
                TokenKind::Word | TokenKind::String | TokenKind::Number(_) | TokenKind::Error(_) => {
                    (takes_word, is_begun) = (false, false);
                }
                TokenKind::OpenBrace => {
                    open.push(open.last()?.opens(keyword));
                    takes_word = false;
                }
                TokenKind::CloseBrace => {
                    takes_word = false;
                    // All keys of the block are known.
                    if found.as_ref().is_some_and(|found| found.depth == open.len()) {
                        break;
                    }
                    open.truncate((open.len() - 1).max(1));
                }
            }
        }
        let end = Found { range: at..at, value_of: takes_word.then_some(keyword), depth: open.len() };
        let Found { range, value_of, depth } = found.unwrap_or(end);
        open.truncate(depth);
        Some(TypingPosition { range, open, value_of })
    }

    fn block(&self) -> Option<&'static Block> {
        self.open.last()?.block
    }

    /// The words that may follow a key.
    fn words_of(&self, key: &str) -> Vec<Suggestion> {
        let field = self.block().and_then(|block| block.field(key));
        let words = match field.map(|field| field.kind) {
            Some(
                FieldKind::Choice(words)
                | FieldKind::ChoiceAndNumber(words, _)
                | FieldKind::ChoiceAndWhole(words, _),
            ) => words,
            Some(FieldKind::Flag) => &["on", "off"],
            _ => &[],
        };
        words.iter().map(|word| Suggestion { word, values: String::new(), about: "" }).collect()
    }

    /// Keys that are not there yet, and blocks.
    fn keys(&self) -> Vec<Suggestion> {
        let mut keys: Vec<Suggestion> = Vec::new();
        for field in self.fields() {
            if keys.last().is_none_or(|last| last.word != field.key) {
                keys.push(Suggestion { word: field.key, values: field.values(), about: field.about });
            }
        }
        let block =
            |block: &Block| Suggestion { word: block.keyword, values: String::new(), about: block.about };
        let parts = self.block().map_or(&[][..], |block| block.parts);
        keys.extend(parts.iter().copied().chain(blocks().filter(|block| self.may_hold(block))).map(block));
        keys
    }

    /// The fields that may still be written.
    fn fields(&self) -> impl Iterator<Item = &'static FieldSpec> {
        let keys: &[&str] = self.open.last().map_or(&[], |open| &open.keys);
        self.block().into_iter().flat_map(move |block| {
            block.fields().filter(move |field| {
                let is_same =
                    |key: &&&str| block.field(key).is_some_and(|other| other.main_key() == field.main_key());
                let written = keys.iter().filter(is_same).count();
                let most = block.fields().filter(|other| other.key == field.key).count();
                (field.repeats || written < most)
                    && field.needs.is_none_or(|key| keys.contains(&key))
                    && field.excludes.iter().all(|key| !keys.contains(key))
            })
        })
    }

    /// Whether a block may stand here.
    fn may_hold(&self, block: &Block) -> bool {
        match self.block() {
            None if self.open.last().is_some_and(|open| open.is_outermost) => {
                let outermost = [Kind::Camera, Kind::Settings, Kind::Animation, Kind::Background, Kind::Fog];
                let lists = [Kind::Lights, Kind::Materials, Kind::Textures, Kind::Media, Kind::Group];
                outermost.contains(&block.kind) || lists.contains(&block.kind)
            }
            None => false,
            Some(around) => around.lists(block),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words for the place that is marked by `|`, and the word that they would replace.
    fn words(text: &str) -> Option<(String, Vec<&'static str>)> {
        let at = text.find('|').unwrap();
        let text = text.replacen('|', "", 1);
        let completion = completion(&text, at)?;
        let words = completion.suggestions.iter().map(|suggestion| suggestion.word).collect();
        Some((text[completion.range].to_owned(), words))
    }

    #[test]
    fn a_repeat_holds_what_stands_around_it() {
        let keys = words("Group { Sphere { | } }").unwrap().1;
        assert!(keys.contains(&"radius"));
        for text in ["Group { repeat i 3 { Sphere { | } } }", "repeat i 3 { Group { Sphere { | } } }"] {
            assert_eq!(words(text).unwrap().1, keys, "{text}");
        }
        assert_eq!(words("repeat i 3 { | }").unwrap().1, words(" | ").unwrap().1);
    }

    #[test]
    fn keys_that_are_not_there_yet_are_offered() {
        let fog = |text: &str| words(&format!("Fog {{ {text} }}")).unwrap().1;
        assert_eq!(fog("|"), ["color", "density", "heightFalloff", "height"]);
        assert_eq!(fog("color 1 1 1 |"), ["density", "heightFalloff", "height"]);
        assert_eq!(fog("| height 3"), ["color", "density", "heightFalloff"]);
        assert_eq!(fog("h| height 3"), ["heightFalloff"], "the next key is none's value");
        assert_eq!(fog("density 0.1 he|"), ["heightFalloff", "height"]);
        assert_eq!(words("Fog { colo|r 1 1 1 }").unwrap(), ("color".to_owned(), vec!["color"]));
        // A block that is not closed yet.
        assert_eq!(words("Fog { density 1 co|").unwrap().1, ["color"]);
        assert_eq!(words("Group { Triangle { tex| on } }").unwrap().1.len(), 3);
    }

    #[test]
    fn keys_are_offered_as_often_as_they_may_stand() {
        let blend = |parts: &str| words(&format!("Materials {{ Mix {{ {parts} | }} }}")).unwrap().1;
        assert_eq!(blend("materialIndex 0"), ["materialIndex", "amount", "Transform"]);
        assert_eq!(blend("materialIndex 0 materialIndex 1"), ["amount", "Transform"]);
        let moved = words("Group { Transform { Translate 1 0 0 Tra| } }").unwrap().1;
        assert!(moved.starts_with(&["Translate"]), "{moved:?}");
    }

    #[test]
    fn keys_beside_which_one_is_an_error_are_left_out() {
        let light = words("Lights { SpotLight { power 3 | } }").unwrap().1;
        assert!(light.contains(&"position") && light.contains(&"group"), "{light:?}");
        for key in ["power", "color", "falloff"] {
            assert!(!light.contains(&key), "{light:?}");
        }
        let material = |keys: &str| words(&format!("Materials {{ Matte {{ {keys} em| }} }}")).unwrap().1;
        assert_eq!(material(""), ["emission"]);
        assert_eq!(material("emission 1 group a"), ["emits"]);
        // Of two spellings one is enough.
        let mesh = words("Group { TriangleMesh { file a.obj | } }").unwrap().1;
        assert_eq!(mesh, ["smooth", "materials", "colors", "subdivide"]);
    }

    #[test]
    fn words_of_choices_follow_their_key() {
        assert_eq!(words("Settings { tone |").unwrap().1, ["linear", "srgb", "aces", "agx"]);
        assert_eq!(words("Settings { tone a|").unwrap(), ("a".to_owned(), vec!["aces", "agx"]));
        assert_eq!(words("Materials { Principled { thin o| } }").unwrap().1, ["on", "off"]);
    }

    #[test]
    fn blocks_are_offered_where_they_may_stand() {
        assert_eq!(words("Li|").unwrap().1, ["Lights"]);
        assert_eq!(words("Lights { Po|").unwrap().1, ["PointLight"]);
        assert_eq!(words("Group { Transform { Translate 1 0 0 To|").unwrap().1, ["Torus"]);
        assert_eq!(words("Background { s|").unwrap().1, ["sky", "stars"]);
        assert_eq!(words("Group { Prism { out|").unwrap().1, ["outline"]);
        assert_eq!(words("Group { Transform { Mo|").unwrap().1, ["Motion", "Model"]);
        assert_eq!(words("Group { Transform { Motion { |").unwrap().1, ["key"]);
        assert_eq!(words("Group { Blob { |} }").unwrap().1[2..], ["sphere", "cylinder", "plane"]);
        assert_eq!(words("Textures { Brick { Tr|").unwrap().1, ["Transform"]);
        assert!(!words("Group { | }").unwrap().1.contains(&"PointLight"));
        assert_eq!(words("Group { Sphere moon { center 0 0 0  radius 1 } } Fo|").unwrap().1, ["Fog"]);
    }

    #[test]
    fn a_word_is_what_it_is_where_it_stands() {
        let veins = words("Materials { PhongMaterial { Noise { |").unwrap().1;
        assert_eq!(veins, ["color", "octaves", "frequency", "amplitude"]);
        let blended = words("Materials { Noise { |").unwrap().1;
        assert_eq!(blended, ["materialIndex", "octaves", "Transform"]);
        let placed = words("Textures { Brick { Transform { |").unwrap().1;
        assert!(placed.contains(&"Translate") && !placed.contains(&"Sphere"), "{placed:?}");
        let outline = words("Group { Prism { outline { |").unwrap().1;
        assert_eq!(outline, ["line", "quadratic", "cubic", "spline"]);
        assert_eq!(words("Group { Curves { strand { points 0 0 0  1 0 0  |").unwrap().1, ["radii"]);
        assert_eq!(words("Group { Foo { Sphere { |"), None, "nobody knows what stands in it");
    }

    #[test]
    fn what_is_said_of_a_picture_is_offered_behind_its_name() {
        let behind = |key: &str| words(&format!("Materials {{ Matte {{ {key} a.png {{ |")).unwrap().1;
        assert!(behind("color").starts_with(&["repeat", "offset", "wrap", "tiling", "filter", "encoding"]));
        assert!(!behind("color").contains(&"channel") && behind("roughness").contains(&"channel"));
        assert!(behind("opacity").contains(&"cutoff") && behind("bump").contains(&"height"));
        assert!(behind("normalMap").contains(&"scale") && behind("emission").contains(&"light"));
        assert_eq!(words("Materials { Matte { color a.png { wrap m|").unwrap().1, ["mirror"]);
        assert!(!behind("color").contains(&"cycle"), "without frames");
    }

    #[test]
    fn nothing_is_offered_in_comments_and_numbers() {
        assert_eq!(words("Fog { # he|\n }"), None);
        assert_eq!(words("Fog { density 0.|1 }"), None);
        assert_eq!(words("Fog { zzz| }"), None);
        assert_eq!(words("Group { Sphere |"), None);
    }
}
