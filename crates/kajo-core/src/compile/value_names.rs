//! Names of values that would hide words of the language.
//!
//! A value is named by `let` or `repeat` and used wherever a number may stand, which is also where the next key may: a
//! value called `radius` would be read in place of every key `radius` after a number. So words of the language are no
//! names.

use std::collections::HashSet;

use kajo_scene::{Diagnostic, Diagnostics, SceneDesc};

use super::blocks::{MATERIAL_INDEX, blocks};
use crate::schema::{Block, Kind};

/// Reports values that are named by words of the language, each name once.
pub(super) fn check(desc: &SceneDesc, diagnostics: &mut Diagnostics) {
    let mut seen = HashSet::new();
    for (name, value) in desc.named_values() {
        if seen.insert(name) && is_word(name) {
            let error = Diagnostic::error(format!("`{name}` is a word of the scene language"));
            diagnostics.push(error.label(value.name, "choose another name for the value"));
        }
    }
}

fn is_word(name: &str) -> bool {
    let parts = || blocks().chain(blocks().flat_map(|block| block.parts.iter().copied()));
    let keys = || parts().flat_map(Block::fields).map(|field| field.key);
    // What is said behind a picture has no word of its own.
    let mut words = parts().filter(|block| block.kind != Kind::Picture).map(|block| block.keyword);
    name == MATERIAL_INDEX || words.any(|word| word == name) || keys().any(|key| key == name)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use kajo_scene::{MemoryAssets, SceneDesc};

    use super::*;
    use crate::compile::{CompileOptions, compile};

    const SCENE: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
        Materials { Matte { } } Group { MaterialIndex 0 Sphere { center 0 0 0  radius 1 } }";

    fn said(head: &str) -> Vec<String> {
        let mut parsed = SceneDesc::parse_str(&format!("{head}\n{SCENE}"));
        let (assets, mut diagnostics) = (MemoryAssets::new(), parsed.diagnostics);
        compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        diagnostics.iter().map(|said| said.message.clone()).collect()
    }

    /// The sources of this folder and of those in it.
    fn sources(folder: &Path) -> Vec<String> {
        let mut all = Vec::new();
        for entry in fs::read_dir(folder).expect("the sources are there") {
            let path = entry.expect("an entry of a folder").path();
            if path.is_dir() {
                all.extend(sources(&path));
            } else if !path.file_stem().is_some_and(|stem| stem.to_string_lossy().ends_with("tests")) {
                let text = fs::read_to_string(&path).expect("a source is text");
                // Unit tests stand behind what they test.
                let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
                all.push(code.split_whitespace().collect::<Vec<_>>().join(" "));
            }
        }
        all
    }

    /// The string literals with which a list begins that is the argument of a call.
    fn literals(arguments: &str) -> Vec<&str> {
        let mut rest = arguments.trim_start_matches(['&', '[', ' ']);
        let mut found = Vec::new();
        while let Some((word, behind)) = rest.strip_prefix('"').and_then(|quoted| quoted.split_once('"')) {
            // What is a sentence is a reason.
            found.extend((!word.contains(' ')).then_some(word));
            rest = behind.trim_start_matches([',', ' ']);
        }
        found
    }

    /// A word that a reader asks for would hide a value of that name: all such words are listed here.
    #[test]
    fn every_word_that_is_read_is_known() {
        const ASKS: [&str; 9] = [
            "params.block(",
            "params.optional(",
            "params.or(",
            "params.required(",
            "params.take(",
            "params.has(",
            "params.contains(",
            "params.refuse(",
            "params.idle(",
        ];
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/compile");
        let mut asked = HashSet::new();
        for text in sources(&folder) {
            for ask in ASKS {
                asked.extend(text.split(ask).skip(1).flat_map(literals).map(str::to_owned));
            }
        }
        for word in ["environment", "displacement", "indexOfRefraction", "tiling"] {
            assert!(asked.contains(word), "the reader of `{word}` is found");
        }
        let unknown: Vec<&String> = asked.iter().filter(|word| !is_word(word)).collect();
        assert!(unknown.is_empty(), "read and in no list: {unknown:?}");
    }

    #[test]
    fn words_of_the_language_are_no_names() {
        assert_eq!(said("let r = 1 let x = 2 repeat i 2 { }"), [""; 0]);
        for word in ["roughness", "Sphere", "wrap", "samples", "cubic", "tiling"] {
            // What else it was read for is said after that.
            let first = said(&format!("let {word} = 1")).swap_remove(0);
            assert_eq!(first, format!("`{word}` is a word of the scene language"));
        }
        let repeated = said("repeat i 2 { repeat height 2 { let r = 1 } }");
        assert_eq!(repeated, ["`height` is a word of the scene language"]);
    }
}
