//! Textures by the names that a scene gives them.

use std::collections::HashMap;

use kajo_scene::{Diagnostic, Diagnostics, Item};

use crate::texture::FloatTexture;

pub(super) use crate::texture::NamedTexture;

/// Textures by their names; `None` for one that was wrong, which has been reported.
pub(super) type TextureNames = HashMap<String, Option<NamedTexture>>;

/// The texture that the word of an item names; `None` where it names none, and `Some(None)` where that one was wrong, or
/// there is none of that name, which is reported.
///
/// * `is_value`: whether a word that is no name of a texture means something else
pub(super) fn find(
    names: &TextureNames,
    item: Item<'_>,
    diagnostics: &mut Diagnostics,
    is_value: impl Fn(&str) -> bool,
) -> Option<Option<NamedTexture>> {
    if item.function().is_some() || names.is_empty() {
        return None;
    }
    let word = item.word()?.text();
    if let Some(known) = names.get(&*word) {
        return Some(known.clone());
    }
    if is_value(&word) {
        return None;
    }
    let near = diagnostics.nearest(&word, names.keys().map(String::as_str)).map(str::to_owned);
    let help = near.map_or_else(
        || {
            let mut names: Vec<String> = names.keys().map(|name| format!("`{name}`")).collect();
            names.sort();
            format!("the scene has {}", names.join(", "))
        },
        |near| format!("did you mean `{near}`?"),
    );
    let error = Diagnostic::error(format!("there is no texture named `{word}`"));
    diagnostics.push(error.label(item.head_span(), "asked for here").help(help));
    Some(None)
}

/// Whether a word in place of a colour says where a spectrum is.
pub(super) fn is_spectrum(word: &str) -> bool {
    word == "spectrum" || word.contains('.')
}

/// The numbers that textures are, as far as all of them are numbers.
pub(super) fn numbers_of(textures: &[NamedTexture]) -> Option<Vec<FloatTexture>> {
    let number = |texture: &NamedTexture| match texture {
        NamedTexture::Float(texture) => Some(*texture),
        NamedTexture::Color(_) => None,
    };
    textures.iter().map(number).collect()
}
