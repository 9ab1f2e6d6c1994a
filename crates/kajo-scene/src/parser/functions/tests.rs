//! What stands behind equals signs.

use crate::{Args, Diagnostics, Item, Parsed, SceneDesc, one_line};

fn messages(parsed: &Parsed) -> Vec<String> {
    parsed.diagnostics.iter().map(|d| one_line(d, parsed.desc.sources())).collect()
}

fn value(item: Item<'_>, at: [f64; 3]) -> f64 {
    item.function().expect("a function").at(&at, &mut Vec::new())
}

#[test]
fn a_function_reaches_as_far_as_it_can() {
    let text = "let r = 0.5 f = x^2 + y^2\n - (r * z) ^ 2 g 1 h=max(x, y,\n z) { i=-2*r j = r k = 7 }";
    let parsed = SceneDesc::parse_str(text);
    assert_eq!(messages(&parsed), [""; 0]);
    let items: Vec<Item<'_>> = parsed.desc.items().collect();
    let keywords: Vec<&str> = items.iter().map(Item::keyword).collect();
    assert_eq!(keywords, ["f", "g", "h", "i", "j", "k"]);
    assert_eq!(value(items[0], [3.0, 4.0, 2.0]), 24.0);
    assert_eq!(value(items[2], [3.0, 4.0, 2.0]), 4.0);
    assert!(
        items[2].has_block() && items[0].function_text().as_deref() == Some("= x^2 + y^2\n - (0.5 * z) ^ 2")
    );
    let numbers: Vec<f64> = items[3..].iter().flat_map(|item| item.numbers().map(|n| n.0)).collect();
    assert_eq!(numbers, [-1.0, 0.5, 7.0]);
    // What is written as a number can be changed there, and what is a name at the value.
    let named: Vec<bool> = parsed.desc.expressions().map(|(_, value)| value.is_some()).collect();
    assert_eq!(named, [false, true]);
}

/// Every turn of a repeated block has a function of its own.
#[test]
fn functions_are_of_their_turn() {
    let parsed = SceneDesc::parse_str("repeat i 3 { f = x + 10 * i }");
    let values: Vec<f64> = parsed.desc.items().map(|item| value(item, [1.0, 0.0, 0.0])).collect();
    assert_eq!(values, [1.0, 11.0, 21.0]);
}

#[test]
fn variables_hide_values() {
    let parsed = SceneDesc::parse_str("let x = 5 f = x  g x");
    let items: Vec<Item<'_>> = parsed.desc.items().collect();
    assert_eq!(value(items[0], [1.0, 0.0, 0.0]), 1.0);
    assert_eq!(items[1].numbers().next().map(|n| n.0), Some(5.0));
}

#[test]
fn mistakes_have_a_place() {
    for (text, expected) in [
        ("f = x + q b 1", "1:9: error: there is no value named `q`"),
        ("f = x / (2 - 2) b 1", "1:9: error: division by zero"),
        ("f = sqrt(-1) * x", "1:5: error: `sqrt` has no finite value at -1"),
        ("f = random(x, 0, 1)", "1:5: error: what `random` is called with must be the same everywhere"),
        ("f =", "1:4: error: expected a number, a name or `(` at the end of this"),
        ("f = (x + 1 b 1", "1:5: error: this `(` is not closed"),
        ("f = 2x", "1:6: error: `x` stands right behind an expression"),
    ] {
        let parsed = SceneDesc::parse_str(text);
        let found = messages(&parsed);
        assert!(found.len() == 1 && found[0].starts_with(&format!("scene:{expected}")), "{text}: {found:?}");
    }
    let long = format!("f = {}", (0..20_000).map(|i| format!("x * {i} + ")).collect::<String>() + "y");
    assert!(messages(&SceneDesc::parse_str(&long))[0].contains("at most 10000 operations"));
}

#[test]
fn readers_say_what_they_expect() {
    let read = |text: &str, reader: fn(&mut Args<'_>) -> Result<(), crate::Diagnostic>| {
        let parsed = SceneDesc::parse_str(text);
        let mut diagnostics = Diagnostics::new();
        Args::read(parsed.desc.roots().next().expect("an item"), &mut diagnostics, reader);
        diagnostics.iter().map(|d| one_line(d, parsed.desc.sources())).collect::<String>()
    };
    let number = |text| read(text, |args| args.number().map(|_| ()));
    let function = |text| read(text, |args| args.function().map(|_| ()));
    let word = |text| read(text, |args| args.text().map(|_| ()));
    assert_eq!(number("radius = 2"), "");
    assert!(
        number("radius = 2 * x").contains("expected 1 number after `radius`, found a function of the place")
    );
    assert_eq!(function("f = 2 * x"), "");
    assert_eq!(function("f 3"), "");
    assert!(
        function("f 3 4").contains("expected `=` and a function of x, y and z after `f`, found 2 numbers")
    );
    assert!(function("f wood").contains("found `wood`"));
    assert!(word("name = x").contains("expected a word or a string in quotes after `name`"));
}
