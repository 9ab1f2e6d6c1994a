//! Edits of numbers that are written as expressions.
//!
//! A number that is the name of a value is changed where that value is written, and with it all that use the name. Any
//! other expression stays as it is: the edit is refused, and says how the number is written.

use kajo_scene::{NamedValue, Span};

use super::tree::Tree;
use super::{EditRefused, TextEdit};

/// The edits with those of named values at the place where the values are written.
///
/// # Errors
/// When a number is replaced that an expression says, or one value would have to be two.
pub(super) fn kept(tree: &Tree, edits: Vec<TextEdit>) -> Result<Vec<TextEdit>, EditRefused> {
    let mut kept: Vec<TextEdit> = Vec::with_capacity(edits.len());
    for edit in edits {
        let Some((place, value)) = expression_at(tree, &edit) else {
            kept.push(edit);
            continue;
        };
        let sources = tree.desc.sources();
        let Some(literal) = value.and_then(|value| value.literal) else {
            let written = sources.text(place);
            return Err(EditRefused::new(format!("it is written as `{written}`: change that in the text")));
        };
        let (file, range) = tree.range_of(literal);
        match kept.iter().find(|other| other.file == file && other.range == range) {
            Some(other) if other.new == edit.new => {}
            Some(_) => {
                let name = sources.text(place);
                return Err(EditRefused::new(format!(
                    "`{name}` stands for several numbers, which would differ"
                )));
            }
            None => kept.push(TextEdit { file, range, new: edit.new }),
        }
    }
    Ok(kept)
}

/// The expression that an edit replaces, and nothing else.
fn expression_at(tree: &Tree, edit: &TextEdit) -> Option<(Span, Option<NamedValue>)> {
    tree.desc.expressions().find(|(place, _)| tree.range_of(*place) == (edit.file, edit.range.clone()))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use kajo::LoadOptions;

    use crate::{Document, Edit, FieldValue, Movement};

    const CAMERA: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }";

    fn document(objects: &str) -> Document {
        let text = format!(
            "{CAMERA} let r = 0.5 /* wide */ Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 {objects} }}"
        );
        let mut document = Document::untitled(Path::new("."), &text, LoadOptions::default()).unwrap();
        document.compile();
        assert!(document.scene().is_some(), "{}", document.report(false));
        document
    }

    fn set(document: &mut Document, key: &str, numbers: &[f64]) -> Result<(), String> {
        let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        let edit = Edit::set(ball, key, FieldValue::numbers(numbers.iter().copied()));
        document.apply(&edit).map(|_| ()).map_err(|refused| refused.to_string())
    }

    #[test]
    fn a_named_value_is_changed_where_it_is_written() {
        let mut document = document("Sphere { center r 0 r  radius r }");
        let old = document.text().to_owned();
        set(&mut document, "radius", &[0.75]).unwrap();
        assert_eq!(document.text(), old.replace("0.5", "0.75"));
        document.undo();
        assert_eq!(document.text(), old);
        set(&mut document, "center", &[2.0, 1.0, 2.0]).unwrap();
        assert_eq!(document.text(), old.replace("0.5", "2").replace("center r 0 r", "center r 1 r"));
        document.undo();
        let refused = set(&mut document, "center", &[1.0, 0.0, 2.0]).unwrap_err();
        assert_eq!(refused, "`r` stands for several numbers, which would differ");
        assert_eq!(document.text(), old);
    }

    #[test]
    fn other_expressions_are_not_overwritten() {
        let mut document = document("Sphere { center 0 0 0  radius 2 * r }");
        let old = document.text().to_owned();
        let refused = set(&mut document, "radius", &[3.0]).unwrap_err();
        assert_eq!(refused, "it is written as `2 * r`: change that in the text");
        set(&mut document, "radius", &[1.0]).unwrap();
        assert_eq!(document.text(), old, "that is its value");
    }

    #[test]
    fn what_is_repeated_is_changed_in_its_one_text() {
        let mut document = document("repeat i 3 { Sphere { center i 0 0  radius 0.25 } }");
        let old = document.text().to_owned();
        let balls: Vec<_> =
            document.outline().nodes().iter().filter(|node| &*node.keyword == "Sphere").collect();
        assert_eq!(balls.len(), 3);
        let last = balls[2].id;
        document.apply(&Edit::set(last, "radius", FieldValue::numbers([0.5]))).unwrap();
        assert_eq!(document.text(), old.replace("0.25", "0.5"));
        document.compile();
        let bounds = document.scene().unwrap().geometry.bounds();
        assert!((bounds.min.x + 0.5).abs() < 1e-4 && (bounds.max.x - 2.5).abs() < 1e-4, "{bounds:?}");
        let movement = Movement::Translate(kajo_math::DVec3::X);
        let refused = document.apply(&Edit::Move { node: last, movement }).unwrap_err().to_string();
        assert_eq!(refused, "it is written as `i`: change that in the text");
        document.apply(&Edit::Duplicate(last)).unwrap();
        document.compile();
        assert_eq!(document.scene().unwrap().geometry.objects.iter().count(), 6);
        while document.undo() {}
        assert_eq!(document.text(), old);
    }
}
