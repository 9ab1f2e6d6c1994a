//! A scene as text again, in one canonical form.

use crate::edit::format_number;
use crate::tree::{Item, Items, SceneDesc, Value};
use std::fmt::Write as _;

/// The whole scene: one item a line, blocks indented by two blanks, includes
/// replaced by what they held.
///
/// Reading the text gives the same items again, if there were no errors.
///
/// ```
/// let parsed = kajo_scene::SceneDesc::parse_str("Sphere{center 0 +1. .5 radius 1e0}// ball");
/// assert_eq!(kajo_scene::print(&parsed.desc), "Sphere {\n  center 0 1 0.5\n  radius 1\n}\n");
/// ```
pub fn print(desc: &SceneDesc) -> String {
    let mut out = String::new();
    // Siblings still to print, innermost last: no recursion, whatever the depth.
    let mut open: Vec<Items<'_>> = vec![desc.roots()];
    while let Some(siblings) = open.last_mut() {
        let Some(item) = siblings.next() else {
            open.pop();
            if !open.is_empty() {
                indent(&mut out, open.len() - 1);
                out.push_str("}\n");
            }
            continue;
        };
        indent(&mut out, open.len() - 1);
        head(&mut out, item);
        if item.has_block() && item.children().next().is_some() {
            out.push_str(" {\n");
            open.push(item.children());
        } else {
            out.push_str(if item.has_block() { " {}\n" } else { "\n" });
        }
    }
    out
}

fn indent(out: &mut String, depth: usize) {
    for _ in 0..depth {
        out.push_str("  ");
    }
}

fn head(out: &mut String, item: Item<'_>) {
    out.push_str(item.keyword());
    for (value, _) in item.values() {
        out.push(' ');
        match value {
            Value::Number(number) => out.push_str(&format_number(number)),
            Value::Word(word) => out.push_str(word),
            Value::Function(text) => {
                let text = item.function_text().unwrap_or_else(|| text.to_owned());
                let words: Vec<&str> = text.split_whitespace().collect();
                out.push_str(&words.join(" "));
            }
            Value::String(text) => {
                let _ = write!(out, "\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Everything but places, with the bits of numbers.
    fn content(desc: &SceneDesc) -> Vec<String> {
        let describe = |item: Item<'_>| {
            let numbers: Vec<u64> = item.numbers().map(|(value, _)| value.to_bits()).collect();
            let word = item.word().map(|word| word.value());
            let children = item.children().count();
            let function = item.function();
            format!("{} {word:?} {function:?} {numbers:?} {} {children}", item.keyword(), item.has_block())
        };
        desc.items().map(describe).collect()
    }

    fn check_round_trip(text: &str) {
        let first = SceneDesc::parse_str(text);
        assert!(!first.diagnostics.has_errors(), "{text}\n{:?}", first.diagnostics);
        let printed = print(&first.desc);
        let second = SceneDesc::parse_str(&printed);
        assert!(second.diagnostics.is_empty(), "{printed}\n{:?}", second.diagnostics);
        assert_eq!(content(&first.desc), content(&second.desc), "{text}\n{printed}");
        assert_eq!(print(&second.desc), printed, "canonical text is its own print");
    }

    #[test]
    fn awkward_items_come_back() {
        for text in [
            "",
            "a {}",
            "Matrix { 1 2 3 } b 1",
            "a \"x y\" 1 -0 1e300 5e-324 { b {} c \"\" }",
            r#"f "q\"\\ \n" g C:\dir"#,
            "a include b 1",
            "a = x^2 + y b 2",
        ] {
            check_round_trip(text);
        }
        let values = SceneDesc::parse_str("let r = -2 a =\n  r * x -\n y b=2*r");
        assert_eq!(print(&values.desc), "a = (-2) * x - y\nb -4\n");
    }

    #[test]
    fn deep_trees_need_no_deep_stack() {
        let text = "a {".repeat(256) + &"}".repeat(256);
        std::thread::Builder::new()
            .stack_size(64 << 10)
            .spawn(move || check_round_trip(&text))
            .expect("a thread")
            .join()
            .expect("no overflow");
    }

    fn item() -> impl Strategy<Value = String> {
        let word = "[a-zA-Z_é][a-zA-Z0-9_./#é-]{0,6}"
            .prop_filter("not a number or include", |w| crate::lexer::number(w).is_none() && w != "include");
        let string = "\"([a-z {}#/é]|\\\\\"|\\\\\\\\|\\\\n){0,6}\"";
        let value = prop_oneof![word.clone(), string];
        let numbers = prop::collection::vec(any::<f64>().prop_filter("finite", |x| x.is_finite()), 1..5)
            .prop_map(|list| list.iter().map(|x| format!("{x:?} ")).collect::<String>());
        let leaf = (word.clone(), prop::option::of(value), numbers)
            .prop_map(|(k, v, n)| format!("{k} {} {n}", v.unwrap_or_default()));
        leaf.prop_recursive(4, 40, 5, move |inner| {
            (word.clone(), prop::collection::vec(inner, 0..5), any::<bool>()).prop_map(|(k, items, glued)| {
                let blank = if glued { "" } else { " /* c */ " };
                format!("{k}{blank}{{{blank}{}}} # d\n", items.join("\n"))
            })
        })
    }

    proptest! {
        #[test]
        fn parse_of_print_is_the_same_tree(items in prop::collection::vec(item(), 0..5)) {
            check_round_trip(&items.concat());
        }
    }
}
