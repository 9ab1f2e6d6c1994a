//! Values of fields that are names of media.

use std::collections::HashMap;

use kajo_scene::{Args, Diagnostic, Diagnostics, Item};

use super::{Sources, Typed, Value};
use crate::medium::MediumId;
use crate::schema::{FieldKind, FieldSpec};

/// The media by their names; `None` for one that was wrong, which has been reported.
pub(in crate::compile) type MediumNames = HashMap<String, Option<MediumId>>;

/// The medium that a body is filled with.
#[derive(Clone, Copy)]
pub(in crate::compile) struct Inside(pub MediumId);

/// A medium by its name.
pub(in crate::compile) const fn inside(key: &'static str) -> Typed<Inside> {
    Typed::new(key, FieldKind::Text)
}

impl Value<'_> for Inside {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Inside> {
        named_medium(item, diagnostics, sources.media).map(Inside)
    }
}

/// The medium that an item names; an unknown one is reported.
pub(in crate::compile) fn named_medium(
    item: Item<'_>,
    diagnostics: &mut Diagnostics,
    media: &MediumNames,
) -> Option<MediumId> {
    let name = Args::read(item, diagnostics, |args| args.text())?;
    if let Some(known) = media.get(&*name) {
        return *known;
    }
    let near = diagnostics.nearest(&name, media.keys().map(String::as_str)).map(str::to_owned);
    let help = match near {
        Some(near) => format!("did you mean `{near}`?"),
        None if media.is_empty() => "the scene has no media: add a `Media` block".to_owned(),
        None => {
            let mut names: Vec<String> = media.keys().map(|name| format!("`{name}`")).collect();
            names.sort();
            format!("the scene has {}", names.join(", "))
        }
    };
    let error = Diagnostic::error(format!("there is no medium named `{name}`"));
    diagnostics.push(error.label(item.head_span(), "asked for here").help(help));
    None
}
