//! What named values, expressions and repeated blocks become.

use crate::{Limits, MemoryAssets, Parsed, SceneDesc, one_line, print};

fn messages(parsed: &Parsed) -> Vec<String> {
    parsed.diagnostics.iter().map(|d| one_line(d, parsed.desc.sources())).collect()
}

/// `text` makes the same tree as `plain`.
#[track_caller]
fn same(text: &str, plain: &str) {
    let parsed = SceneDesc::parse_str(text);
    assert_eq!(messages(&parsed), [""; 0], "{text}");
    assert!(parsed.whole);
    assert_eq!(print(&parsed.desc), print(&SceneDesc::parse_str(plain).desc), "{text}");
}

#[track_caller]
fn wrong(text: &str, expected: &[&str]) {
    let parsed = SceneDesc::parse_str(text);
    let expected: Vec<String> = expected.iter().map(|e| format!("scene:{e}")).collect();
    assert_eq!(messages(&parsed), expected, "{text}");
}

#[test]
fn numbers_may_be_expressions() {
    same(
        "let r = 0.5  Sphere { radius 2 * r + 1  center r (r + 1) -r }",
        "Sphere { radius 2  center 0.5 1.5 -0.5 }",
    );
    same("a sin(90 deg) * 2 - 1 cos(0)", "a 1 1");
    same("a 1 -2 3", "a 1 -2 3");
    same("a 1 - 2 3", "a -1 3");
    same("a 2 * 3 / 4 b 1", "a 1.5 b 1");
    same("a (1+2)*3 b ((2)*(3))/4 (8)/(4)", "a 9 b 1.5 2");
    same("a 2*3 b 2^3*2 { 4 *2 c 1 }", "a 6 b 16 8 { c 1 }");
}

#[test]
fn words_stay_words() {
    for text in [
        "obj_file (2).obj e (old)/x.png b 2.obj c a*b d C:\\dir\\(x).png",
        "a b/c d textures/wood.png",
        "file sin.png MaterialIndex cos",
        "wrap repeat repeat 2 3",
        "name let x 1",
        "repeat 2 wrap clamp",
    ] {
        let parsed = SceneDesc::parse_str(text);
        assert_eq!(messages(&parsed), [""; 0], "{text}");
        let words: Vec<String> = parsed.desc.items().map(|item| item.keyword().to_owned()).collect();
        assert!(!words.is_empty());
    }
    same("let r = 2  MaterialIndex \"r\" b r/x.png c r", "MaterialIndex \"r\" b r/x.png c 2");
}

#[test]
fn a_value_holds_to_the_end_of_its_block() {
    same("let a = 1  b { let a = a + 1  c a  d { c a } }  e a", "b { c 2 d { c 2 } } e 1");
    same("let a = 1 let a = a * 3 b a", "b 3");
    same("let a = 180 deg / pi  let b = a-0.5 -0.5  c b", "c 0");
    wrong("b { let a = 1 } c (a)", &["1:20: error: there is no value named `a`"]);
}

#[test]
fn a_block_is_repeated() {
    same("repeat i 3 { a i }", "a 0 a 1 a 2");
    same("repeat i 2 { repeat j i + 1 { a i j } }", "a 0 0 a 1 0 a 1 1");
    same("repeat i 2 { b { c i + 0.5 { d (i) } } }", "b { c 0.5 { d 0 } } b { c 1.5 { d 1 } }");
    same("repeat i 0 { a { b } } c 1", "c 1");
    same("let n = 2 repeat i n { a i } repeat i n { b i }", "a 0 a 1 b 0 b 1");
    same("repeat i 2 { let x = i * 10  a x }", "a 0 a 10");
    same("a { repeat i 2 { b i } c 1 }", "a { b 0 b 1 c 1 }");
    same("repeat i 3 { // }\n a i /* } */ }", "a 0 a 1 a 2");
}

#[test]
fn values_and_turns_reach_into_included_files() {
    let assets = MemoryAssets::new()
        .with("main", "let r = 3 repeat i 2 { include \"part\" } c (q)")
        .with("part", "let q = r + i  a q (1 / (i - 1))");
    let parsed = SceneDesc::load("main", &assets, &Limits::default());
    let said = messages(&parsed);
    assert_eq!(said[0], "part:1:25: error: division by zero (in `repeat`: i = 1)", "{said:?}");
}

#[test]
fn mistakes_are_placed_and_said_once() {
    wrong("a 1 / 0", &["1:7: error: division by zero"]);
    wrong("repeat i 5 { a 1 / (i - 1) b 1 }", &["1:20: error: division by zero (in `repeat`: i = 1)"]);
    wrong("repeat i 2.5 { }", &["1:10: error: a block cannot be repeated 2.5 times"]);
    wrong("repeat i -1 { }", &["1:10: error: a block cannot be repeated -1 times"]);
    wrong("repeat i 1000000000 { }", &["1:10: error: a block can be repeated 10000000 times at most"]);
    wrong("repeat i { a 1 }", &["1:8: error: this `repeat` does not say how often"]);
    wrong("repeat i 3 a 1", &["1:10: error: a `repeat` has a block"]);
    wrong("repeat i 3 { a 1", &["1:1: error: the block of `repeat` is not closed"]);
    wrong("repeat i 0 { a 1", &["1:12: error: the block of `repeat` is not closed"]);
    wrong("let = 3", &["1:5: error: a `let` gives a name to a number"]);
    wrong(
        "let r 3",
        &["1:5: error: a `let` gives a name to a number", "1:7: error: the number `3` belongs to no keyword"],
    );
    wrong("let sin = 3", &["1:5: error: `sin` has a meaning in expressions already"]);
    wrong("a 1 (1)+2", &["1:8: error: `+` stands right behind an expression"]);
    wrong("a (r) b 1", &["1:4: error: there is no value named `r`"]);
    wrong("a (1)(2) b 1", &["1:6: error: `(` stands right behind an expression"]);
    wrong(
        "a { 1 +} b 1 -{ }",
        &["1:7: error: expected a number after `+`", "1:14: error: expected a number after `-`"],
    );
    wrong("a 1\n* q b 1", &["2:3: error: there is no value named `q`"]);
    wrong("a 1 2 * q 3", &["1:9: error: there is no value named `q`"]);
}

#[test]
fn repeats_end_however_they_stand_in_each_other() {
    let nest = "repeat i 1000 { ".repeat(9) + &"}".repeat(9);
    let limits = Limits { items: 20_000, ..Limits::default() };
    let parsed = SceneDesc::parse("scene", nest, &MemoryAssets::new(), &limits);
    let said = messages(&parsed);
    assert!(said.len() == 1 && said[0].contains("more than 20000 items, repeated ones"), "{said:?}");
    assert!(!parsed.whole);
}

#[test]
fn one_mistake_of_many_turns_is_one() {
    let parsed = SceneDesc::parse_str("repeat i 3 { a (i) b 1 } c 1 c 1");
    let mut diagnostics = crate::Diagnostics::new();
    for item in parsed.desc.items() {
        diagnostics.push(crate::Diagnostic::error("wrong").label(item.span(), ""));
    }
    diagnostics.merge_turns(parsed.desc.sources());
    assert_eq!((diagnostics.iter().count(), diagnostics.count(crate::Severity::Error)), (4, 4));
}

#[test]
fn places_know_their_turn() {
    let parsed = SceneDesc::parse_str("repeat i 2 { repeat j 2 { a 1 } }");
    let sources = parsed.desc.sources();
    let turns: Vec<_> = parsed.desc.items().map(|item| sources.repetition(item.span().source)).collect();
    assert_eq!(turns[2], [("i", 1.0), ("j", 0.0)]);
    assert_eq!(turns.len(), 4);
    assert!(
        parsed
            .desc
            .items()
            .all(|item| sources.original(item.span().source) == sources.iter().next().unwrap().0)
    );
    assert_eq!(sources.iter().count(), 1);
    let names: Vec<&str> = parsed.desc.named_values().map(|(name, _)| name).collect();
    assert_eq!(names, ["i", "j", "j", "i", "j", "j"]);
}

#[test]
fn expressions_know_what_decides_them() {
    let parsed = SceneDesc::parse_str("let r = 0.3 let s = r * 2  a 1 r (r) s 2 * r");
    let text = |span| parsed.desc.sources().text(span);
    let found: Vec<_> = parsed
        .desc
        .expressions()
        .map(|(place, value)| (text(place), value.map(|value| (text(value.name), value.literal.map(text)))))
        .collect();
    let expected =
        [("r", Some(("r", Some("0.3")))), ("(r)", None), ("s", Some(("s", None))), ("2 * r", None)];
    assert_eq!(found, expected);
}
