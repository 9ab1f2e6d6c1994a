//! Names of values that would hide words of the language.
//!
//! A value is named by `let` or `repeat` and used wherever a number may stand, which is also where the next key may: a
//! value called `radius` would be read in place of every key `radius` after a number. So words of the language are no
//! names.

use std::collections::HashSet;

use kajo_scene::{Diagnostic, Diagnostics, SceneDesc};

use super::blocks::{MATERIAL_INDEX, blocks};
use crate::schema::Block;

/// Keys of blocks that are in no list: of pictures, and counts.
const OTHERS: [&str; 13] = [
    MATERIAL_INDEX,
    "numObjects",
    "numLights",
    "numMaterials",
    "channel",
    "cutoff",
    "encoding",
    "filter",
    "height",
    "offset",
    "repeat",
    "scale",
    "wrap",
];

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
    let keys = || blocks().flat_map(Block::fields).map(|field| field.key);
    OTHERS.contains(&name) || blocks().any(|block| block.keyword == name) || keys().any(|key| key == name)
}

#[cfg(test)]
mod tests {
    use kajo_scene::{MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};

    const SCENE: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
        Materials { Matte { } } Group { MaterialIndex 0 Sphere { center 0 0 0  radius 1 } }";

    fn said(head: &str) -> Vec<String> {
        let mut parsed = SceneDesc::parse_str(&format!("{head}\n{SCENE}"));
        let (assets, mut diagnostics) = (MemoryAssets::new(), parsed.diagnostics);
        compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        diagnostics.iter().map(|said| said.message.clone()).collect()
    }

    #[test]
    fn words_of_the_language_are_no_names() {
        assert_eq!(said("let r = 1 let x = 2 repeat i 2 { }"), [""; 0]);
        for word in ["roughness", "Sphere", "wrap", "samples"] {
            // What else it was read for is said after that.
            let first = said(&format!("let {word} = 1")).swap_remove(0);
            assert_eq!(first, format!("`{word}` is a word of the scene language"));
        }
        let repeated = said("repeat i 2 { repeat height 2 { let r = 1 } }");
        assert_eq!(repeated, ["`height` is a word of the scene language"]);
    }
}
