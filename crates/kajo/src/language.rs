//! The blocks of the scene language, and what fields they have.

use kajo_core::compile;
pub use kajo_core::compile::{keywords_of, kind_of};
pub use kajo_core::schema::{Absent, Block, FieldKind, FieldSpec, FieldValue, Kind};
use kajo_render::integrator;

/// All blocks.
pub fn blocks() -> impl Iterator<Item = &'static Block> {
    compile::blocks().map(known)
}

/// The block that begins with a word.
pub fn block_of(keyword: &str) -> Option<&'static Block> {
    compile::block_of(keyword).map(known)
}

/// The block that an item with this keyword begins within another one; `None` for `parent` outside of all that are known.
pub fn block_in(parent: Option<&Block>, keyword: &str) -> Option<&'static Block> {
    compile::block_in(parent, keyword).map(known)
}

/// The same block, with what may be said of integrators where it may have one.
fn known(block: &'static Block) -> &'static Block {
    if block.kind == Kind::Settings { &SETTINGS } else { block }
}

const SETTINGS: Block = Block { groups: &[&SETTINGS_FIELDS], ..compile::SETTINGS };

const SETTINGS_FIELDS: [FieldSpec; compile::SETTINGS.groups[0].len()] = {
    let mut fields = [compile::SETTINGS.groups[0][0]; compile::SETTINGS.groups[0].len()];
    let mut i = 0;
    while i < fields.len() {
        let field = compile::SETTINGS.groups[0][i];
        let kind = match field.kind {
            FieldKind::Integrator => FieldKind::Choice(&integrator::CHOICES),
            kind => kind,
        };
        fields[i] = FieldSpec { kind, ..field };
        i += 1;
    }
    fields
};

/// The classes of the Python package are written from the descriptions of blocks as well.
#[cfg(test)]
mod python;

/// The tables of the manual are written from the descriptions of blocks, between two comments in the page of each block.
#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn an_integrator_is_one_of_those_that_there_are() {
        let kind = block_of("Settings").unwrap().field("integrator").unwrap().kind;
        assert_eq!(kind, FieldKind::Choice(&integrator::CHOICES));
        let bare = |block: &Block| block.fields().any(|field| field.kind == FieldKind::Integrator);
        assert!(!blocks().any(bare));
    }

    /// Set to write the tables in place of checking them.
    pub(super) const WRITE: &str = "KAJO_WRITE_TABLES";

    const END: &str = "<!-- end of fields -->";

    fn begin(block: &Block) -> String {
        format!("<!-- fields of {}: written by `cargo xtask tables` -->", block.keyword)
    }

    fn code_list(words: &[&str]) -> String {
        let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
        match &words[..] {
            [] => String::new(),
            [word] => word.clone(),
            [first @ .., last] => format!("{} or {last}", first.join(", ")),
        }
    }

    fn values(field: &FieldSpec) -> String {
        let what = match field.kind {
            FieldKind::Choice(words) => code_list(words),
            FieldKind::ChoiceAndNumber(words, range) => format!("{}; then a number{range}", code_list(words)),
            FieldKind::ChoiceAndWhole(words, range) => {
                format!("{}; then a whole number{range}", code_list(words))
            }
            FieldKind::Flag => code_list(&["on", "off"]),
            FieldKind::Emission => "r g b, or [another light value](spectra.md)".to_owned(),
            FieldKind::Reflectance => "r g b, or [a file or `spectrum`](spectra.md)".to_owned(),
            kind => kind.to_string(),
        };
        let unit = if field.unit.is_empty() { String::new() } else { format!(", {}", field.unit) };
        let texture = if field.texture.is_some() { ", or a [texture](pictures.md)" } else { "" };
        format!("{what}{unit}{texture}")
    }

    fn default(field: &FieldSpec) -> String {
        match field.absent {
            Absent::Value(constant) if FieldValue::from(constant).word.is_some() => {
                format!("`{}`", field.absence())
            }
            Absent::Required => String::new(),
            _ => field.absence(),
        }
    }

    fn table(block: &Block) -> String {
        let mut text = "| key | values | default | meaning |\n|---|---|---|---|\n".to_owned();
        let mut last = None;
        for field in block.fields().filter(|field| last.replace(field.key) != Some(field.key)) {
            let cells = [format!("`{}`", field.key), values(field), default(field), field.about.to_owned()];
            let cells = cells.map(|cell| if cell.is_empty() { " ".to_owned() } else { format!(" {cell} ") });
            text.push_str(&format!("|{}|\n", cells.join("|")));
        }
        text
    }

    /// The page with the table of a block in it; `None` where the page has no place for that.
    fn with_table(page: &str, block: &Block) -> Option<String> {
        let start = page.find(&begin(block))?;
        let end = start + page[start..].find(END)? + END.len();
        Some(format!("{}{}\n\n{}\n{END}{}", &page[..start], begin(block), table(block), &page[end..]))
    }

    #[test]
    fn every_block_has_its_table_in_the_manual() {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/language");
        let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
        let mut pages: Vec<(PathBuf, String)> =
            files.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect();
        let mut seen = Vec::new();
        let mut wrong = Vec::new();
        for block in blocks().filter(|block| block.fields().next().is_some()) {
            let page = pages.iter_mut().find_map(|page| Some((with_table(&page.1, block)?, page)));
            match page {
                // Blocks of the same fields may share a table.
                None if seen.contains(&table(block)) => {}
                None => wrong.push(format!("no page has `{}` and `{END}`", begin(block))),
                Some((text, (path, old))) if text != *old => {
                    if std::env::var_os(WRITE).is_some() {
                        fs::write(&*path, &text).unwrap();
                    } else {
                        wrong.push(format!("{}: {} differs", path.display(), block.keyword));
                    }
                    *old = text;
                }
                Some(_) => {}
            }
            seen.push(table(block));
        }
        assert!(wrong.is_empty(), "{wrong:#?}\n`cargo xtask tables` writes those that differ");
    }
}
