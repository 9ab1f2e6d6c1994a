//! Where words belong, to advise on one that stands in a wrong place.

use kajo_scene::{Diagnostic, Item};

use super::blocks::{self, LIGHT_LIST, MATERIAL_INDEX, MATERIAL_LIST, MEDIUM_LIST, TEXTURE_LIST, block_of};
use crate::schema::Kind;

/// The error for a word of the language that belongs elsewhere; `None` where it does not, or not by its word alone.
///
/// * `parent`: the kind of block that it stands in, `Group` for all that hold objects; `None` outside of all blocks
pub(super) fn misplaced(item: Item<'_>, parent: Option<&str>) -> Option<Diagnostic> {
    let word = item.keyword();
    let home = home(word)?;
    if home == parent {
        return None;
    }
    let stands = parent.map_or("outside of all blocks".to_owned(), |parent| format!("in `{parent}`"));
    let help = match home {
        Some(home) => format!("write it inside of `{home} {{ }}`"),
        None => "write it outside of all blocks".to_owned(),
    };
    let error = Diagnostic::error(format!("`{word}` cannot stand {stands}"));
    Some(error.label(item.keyword_span(), "not here").help(help))
}

/// The kind of block that a word belongs in, `Some(None)` for what stands outside of all; `None` for unknown words, and for
/// parts of blocks of a kind.
fn home(word: &str) -> Option<Option<&'static str>> {
    const GROUP: &str = blocks::group::GROUP.block.keyword;
    if word == MATERIAL_INDEX {
        return Some(Some(GROUP));
    }
    match block_of(word)?.kind {
        Kind::Camera
        | Kind::Settings
        | Kind::Animation
        | Kind::Background
        | Kind::Fog
        | Kind::Lights
        | Kind::Materials
        | Kind::Textures
        | Kind::Media => Some(None),
        Kind::Light => Some(Some(LIGHT_LIST.keyword)),
        Kind::Medium => Some(Some(MEDIUM_LIST.keyword)),
        Kind::Material => Some(Some(MATERIAL_LIST.keyword)),
        Kind::Texture => Some(Some(TEXTURE_LIST.keyword)),
        Kind::Group | Kind::Define | Kind::Transform | Kind::Instance | Kind::Shape => Some(Some(GROUP)),
        Kind::Part | Kind::Picture => None,
    }
}

#[cfg(test)]
mod tests {
    use kajo_scene::{MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};

    /// Message and help of each error.
    fn said(text: &str) -> Vec<(String, Option<String>)> {
        let mut parsed = SceneDesc::parse_str(text);
        let (assets, mut diagnostics) = (MemoryAssets::new(), parsed.diagnostics);
        let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        assert!(scene.is_none());
        diagnostics.iter().map(|said| (said.message.clone(), said.help.clone())).collect()
    }

    #[test]
    fn words_in_a_wrong_place_are_told_the_right_one() {
        for (text, message, help) in [
            ("Sphere { }", "`Sphere` cannot stand outside of all blocks", "write it inside of `Group { }`"),
            (
                "Matte red { }",
                "`Matte` cannot stand outside of all blocks",
                "write it inside of `Materials { }`",
            ),
            ("Lights { Sphere { } }", "`Sphere` cannot stand in `Lights`", "write it inside of `Group { }`"),
            ("Materials { Box { } }", "`Box` cannot stand in `Materials`", "write it inside of `Group { }`"),
            (
                "Group { PointLight { } }",
                "`PointLight` cannot stand in `Group`",
                "write it inside of `Lights { }`",
            ),
            (
                "Group { Transform { Settings { } Sphere { radius 1 } } }",
                "`Settings` cannot stand in `Group`",
                "write it outside of all blocks",
            ),
        ] {
            let told = (message.to_owned(), Some(help.to_owned()));
            let said = said(text);
            assert!(said.contains(&told), "{text}: {said:?}");
        }
    }

    #[test]
    fn words_of_other_programs_are_not_advised() {
        let said = said("Lights { Foo { } Arealight { } }");
        let advice: Vec<&str> = said.iter().filter_map(|(_, help)| help.as_deref()).collect();
        let allowed = "expected `numLights`, `DirectionalLight`, `PointLight` or `SpotLight`";
        assert!(advice.iter().filter(|help| **help == allowed).count() == 2, "{advice:?}");
    }
}
