//! What the parser makes of texts good and bad.

use super::*;
use crate::tree::{Item, Value};

fn messages(parsed: &Parsed) -> Vec<String> {
    parsed.diagnostics.iter().map(|d| crate::one_line(d, parsed.desc.sources())).collect()
}

/// The tree in one line: `keyword values { children }`.
fn shape<'a>(items: impl Iterator<Item = Item<'a>>) -> String {
    let one = |item: Item<'a>| {
        let mut text = item.keyword().to_owned();
        for (value, _) in item.values() {
            text += &match value {
                Value::Number(number) => format!(" {number}"),
                Value::Word(word) | Value::Function(word) => format!(" {word}"),
                Value::String(string) => format!(" {string:?}"),
            };
        }
        if item.has_block() { format!("{text} {{{}}}", shape(item.children())) } else { text }
    };
    items.map(one).collect::<Vec<_>>().join("; ")
}

fn check(text: &str, expected: &str) {
    let parsed = SceneDesc::parse_str(text);
    assert_eq!(messages(&parsed), [""; 0], "{text}");
    assert_eq!(shape(parsed.desc.roots()), expected, "{text}");
}

fn check_errors(text: &str, expected: &[&str], tree: &str) {
    let parsed = SceneDesc::parse_str(text);
    let expected: Vec<String> = expected.iter().map(|e| format!("scene:{e}")).collect();
    assert_eq!(messages(&parsed), expected, "{text}");
    assert_eq!(shape(parsed.desc.roots()), tree, "{text}");
}

#[test]
fn items_take_one_word_then_numbers_then_a_block() {
    check("", "");
    check("a 1", "a 1");
    check("a b c d", "a b; c d");
    check("Group{numObjects 1 Sphere{radius 2}}a 1", "Group {numObjects 1; Sphere {radius 2}}; a 1");
    check("PhongMaterial gold { diffuseColor 1 .8 0 }", "PhongMaterial gold {diffuseColor 1 0.8 0}");
    check(
        "MaterialIndex 1 MaterialIndex gold obj_file bunny_200.obj",
        "MaterialIndex 1; MaterialIndex gold; obj_file bunny_200.obj",
    );
    check("obj_file \"my bunny.obj\" x 1", "obj_file \"my bunny.obj\"; x 1");
    check(
        "filter gaussian 0.5 samples jittered 16 shadows on",
        "filter gaussian 0.5; samples jittered 16; shadows on",
    );
    check("Matrix { 1 0 0 1 } a 2", "Matrix 1 0 0 1 {}; a 2");
    check("Rotate 1 2 { 3 a 4 }", "Rotate 1 2 3 {a 4}");
    check("obj_file 2.obj material 1.2.3", "obj_file 2.obj; material 1.2.3");
    check("a { } b { c { } d 1 }", "a {}; b {c {}; d 1}");
}

#[test]
fn spans_cover_what_they_say() {
    let text = "a 1 # c\r\nGroup name { x -2 3 y \"s\" }";
    let parsed = SceneDesc::parse_str(text);
    let group = parsed.desc.roots().nth(1).unwrap();
    let of = |span: Span| parsed.desc.sources().text(span).to_owned();
    assert_eq!(of(group.keyword_span()), "Group");
    assert_eq!(of(group.head_span()), "Group name");
    assert_eq!(of(group.span()), "Group name { x -2 3 y \"s\" }");
    let x = group.children().next().unwrap();
    assert_eq!((of(x.span()), of(x.head_span())), ("x -2 3".to_owned(), "x -2 3".to_owned()));
    let values: Vec<String> = x.numbers().map(|(_, span)| of(span)).collect();
    assert_eq!(values, ["-2", "3"]);
    assert_eq!(of(group.children().nth(1).unwrap().word().unwrap().span), "\"s\"");
    assert_eq!(parsed.desc.len(), 4);
    assert!(!group.is_bare());
}

#[test]
fn mistakes_are_all_reported_and_reading_goes_on() {
    check_errors(
        "a } b 1",
        &["1:1: error: `a` has neither a value nor a block", "1:3: error: `}` without a block to close"],
        "a; b 1",
    );
    check_errors("g { a 1", &["1:1: error: the block of `g` is not closed"], "g {a 1}");
    check_errors("{ a 1 } b 2", &["1:1: error: `{` without a keyword before it"], "a 1; b 2");
    check_errors("g { { a 1 } } b 2", &["1:5: error: `{` without a keyword before it"], "g {a 1}; b 2");
    check_errors("a 1 1.2.3 b 2", &["1:5: error: `1.2.3` is not a number"], "a 1 0; b 2");
    check_errors("m { 12abc 1 }", &["1:5: error: `12abc` is not a number"], "m 0 1 {}");
    check_errors("a { } 5 b 1", &["1:7: error: the number `5` belongs to no keyword"], "a {}; b 1");
    check_errors(
        "a nan 1 -inf",
        &["1:3: error: `nan` is not a finite number", "1:9: error: `-inf` is not a finite number"],
        "a 0 1 0",
    );
    check_errors("a 1 1e999", &["1:5: error: `1e999` is too large"], "a 1 0");
    check_errors("a 1 \"s\"", &["1:5: error: the string `\"s\"` belongs to no keyword"], "a 1");
    check_errors("f \"s\nb 1", &["1:3: error: the string is not closed"], "f \"s\"; b 1");
    check_errors("a 1 /* b", &["1:5: error: the comment is not closed"], "a 1");
    check_errors("a", &["1:1: error: `a` has neither a value nor a block"], "a");
    check_errors("a 1 include", &["1:5: error: `include` names no file"], "a 1");
}

#[test]
fn text_that_is_no_text_is_refused_with_its_place() {
    let read = |bytes: &[u8]| {
        let assets = MemoryAssets::new().with("s", bytes);
        messages(&SceneDesc::load("s", &assets, &Limits::default()))
    };
    assert_eq!(read(b"\xef\xbb\xbfa 1"), [""; 0]);
    assert_eq!(read(b"a 1\nb\0 2"), ["s:2:2: error: the file is not text: it holds a zero byte"]);
    assert_eq!(read(b"a 1\r\nbc\xff 2"), ["s:2:3: error: the file is not UTF-8 text"]);
    assert_eq!(
        read(b"\xff\xfea\0"),
        ["s:1:1: error: this file is UTF-16 text, which is not read; save it as UTF-8"]
    );
    let missing = SceneDesc::load("nowhere", &MemoryAssets::new(), &Limits::default());
    assert_eq!(messages(&missing), ["error: cannot read `nowhere`: there is no such file"]);
}

#[test]
fn nesting_is_bounded_however_deep_the_text() {
    let deep = |n: usize| SceneDesc::parse_str(&"g {".repeat(n));
    assert!(messages(&deep(256)).iter().all(|m| m.contains("is not closed")));
    for n in [257, 100_000, 10_000_000] {
        assert_eq!(messages(&deep(n)), ["scene:1:771: error: blocks are nested more than 256 deep"]);
    }
    let braces = SceneDesc::parse_str(&"{".repeat(100_000));
    assert_eq!(braces.diagnostics.count(Severity::Error), 257);
}

#[test]
fn mistakes_without_end_stop_the_reading() {
    let parsed = SceneDesc::parse_str(&"} ".repeat(100_000));
    assert_eq!(parsed.diagnostics.count(Severity::Error), Limits::default().errors + 1);
}

fn load(files: &[(&str, &str)]) -> Parsed {
    load_within(files, &Limits::default())
}

fn load_within(files: &[(&str, &str)], limits: &Limits) -> Parsed {
    let assets = files.iter().fold(MemoryAssets::new(), |assets, (path, text)| assets.with(*path, text));
    SceneDesc::load(files[0].0, &assets, limits)
}

#[test]
fn files_of_shapes_are_no_scenes() {
    for (name, block) in [("a/Lantern.GLB", "Model"), ("a/x.gltf", "Model"), ("a/b.ply", "TriangleMesh")] {
        let parsed = load(&[(name, "glTF")]);
        assert_eq!(parsed.diagnostics.count(Severity::Error), 1);
        let said = parsed.diagnostics.iter().next().unwrap();
        assert_eq!(said.message, format!("`{name}` holds shapes, not a scene"));
        let file = name.trim_start_matches("a/");
        assert_eq!(
            said.help.as_deref(),
            Some(&*format!("a scene shows it: `Group {{ {block} {{ file {file} }} }}`"))
        );
    }
    let parsed = load(&[("s.txt", "include \"hare.obj\" a 1"), ("hare.obj", "v 0 0 0")]);
    assert_eq!(messages(&parsed), ["s.txt:1:9: error: `hare.obj` holds shapes, not a scene"]);
}

#[test]
fn includes_put_items_in_their_place() {
    let parsed = load(&[
        ("s/main.txt", "a 1 g { include \"sub/x.txt\" b 2 } include ../y.txt include sub/x.txt z 0"),
        ("s/sub/x.txt", "x 1 include x2.txt"),
        ("s/sub/x2.txt", "h { x2 1 }"),
        ("y.txt", ""),
    ]);
    assert_eq!(messages(&parsed), [""; 0]);
    assert_eq!(shape(parsed.desc.roots()), "a 1; g {x 1; h {x2 1}; b 2}; x 1; h {x2 1}; z 0");
    assert_eq!(parsed.desc.sources().iter().count(), 4, "a file included twice is kept once");
    let x2 = parsed.desc.items().find(|item| item.keyword() == "x2").unwrap();
    assert_eq!(x2.path(), "s/sub/x2.txt");
}

#[test]
fn includes_that_go_round_name_the_whole_circle() {
    let parsed = load(&[("a", "include b"), ("b", "k 1 include c"), ("c", "include \"b\"")]);
    assert_eq!(messages(&parsed), ["c:1:9: error: a file includes itself: b -> c -> b"]);
    assert_eq!(messages(&load(&[("a", "include a")])), ["a:1:9: error: a file includes itself: a -> a"]);
}

#[test]
fn includes_that_fail_are_reported_where_they_stand() {
    assert_eq!(
        messages(&load(&[("a", "include no b 1")])),
        ["a:1:9: error: cannot read `no`: there is no such file"]
    );
    let outside = load(&[("a", "include ../b")]);
    assert_eq!(messages(&outside), ["a:1:9: error: cannot read `../b`: it lies outside the scene's folder"]);
}

#[test]
fn blocks_do_not_reach_across_files() {
    let parsed = load(&[("a", "g { include b } k 1"), ("b", "x 1 } h {")]);
    assert_eq!(
        messages(&parsed),
        ["b:1:5: error: `}` without a block to close", "b:1:7: error: the block of `h` is not closed"]
    );
    assert_eq!(shape(parsed.desc.roots()), "g {x 1; h {}}; k 1");
}

#[test]
fn chains_and_explosions_of_includes_are_refused() {
    let names: Vec<String> = (0..40).map(|i| format!("f{i}")).collect();
    let chain: Vec<(String, String)> =
        names.iter().zip(&names[1..]).map(|(a, b)| (a.clone(), format!("include {b}"))).collect();
    let files: Vec<(&str, &str)> = chain.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let parsed = load(&files);
    assert_eq!(parsed.diagnostics.count(Severity::Error), 1);
    assert!(
        messages(&parsed)[0]
            .starts_with("f32:1:9: error: files include each other more than 32 deep: f0 -> f1")
    );

    let bomb: Vec<(String, String)> = names[..30]
        .iter()
        .zip(&names[1..])
        .map(|(a, b)| (a.clone(), format!("k 1 include {b} include {b}")))
        .chain([("f30".to_owned(), "k 1".to_owned())])
        .collect();
    let files: Vec<(&str, &str)> = bomb.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    assert!(messages(&load(&files))[0].contains("more than 10000 files are included"));
    let few = load_within(&files, &Limits { items: 100, ..Limits::default() });
    assert!(messages(&few)[0].contains("the scene has more than 100 items"));
    assert_eq!(few.desc.len(), 100);
}

#[test]
fn text_beyond_the_limit_is_refused() {
    let limits = Limits { text_bytes: 26, ..Limits::default() };
    assert_eq!(messages(&load_within(&[("a", "include b"), ("b", "k 123")], &limits)), [""; 0]);
    let over = load_within(&[("a", "include b include b"), ("b", "k 123")], &limits);
    let message = "more than 26 bytes of scene text, included files counted each time";
    assert_eq!(messages(&over), [format!("a:1:19: error: {message}")]);
    let over = load_within(&[("a", "a 1                          ")], &limits);
    assert_eq!(messages(&over), [format!("error: {message}")]);
    let over = SceneDesc::parse("a", " ".repeat(27), &MemoryAssets::new(), &limits);
    assert_eq!(messages(&over), [format!("error: {message}")]);
}
