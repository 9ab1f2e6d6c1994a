//! Editing by blocks: what is removed side by side comes back, and keys that belong together are set together.

use super::*;

/// Blocks that stand side by side, one to a line or glued together, with and without counts.
fn neighbours(newline: &str, gap: &str, counted: bool) -> String {
    let count = |key: &str, n: usize| if counted { format!("{key} {n}{newline}") } else { String::new() };
    let balls: Vec<String> = (0..5).map(|i| format!("Sphere b{i} {{ center {i} 0 0 radius 1 }}")).collect();
    let lights = ["DirectionalLight { direction 0 -1 0 color 1 1 1 }"; 3];
    format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}{newline}\
         Lights {{{gap}{}{}{gap}}}{newline}Materials {{ Matte {{}} }}{newline}\
         Group {{{gap}{}MaterialIndex 0{newline}{}{gap}}}",
        count("numLights", 3),
        lights.join(gap),
        count("numObjects", 5),
        balls.join(gap),
    )
}

#[test]
fn neighbours_that_are_removed_come_back_where_they_were() {
    let config = Config { cases: 96, failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let style = (
        prop::sample::select(vec!["\n", "\r\n", "\r"]),
        prop::sample::select(vec!["", " ", "  ", "\t", "\n", "\n  ", "\n\n", " // c\n", "/* c */"]),
        any::<bool>(),
    );
    let cases = (style, prop::collection::vec(0..20_usize, 2..7), any::<bool>());
    runner
        .run(&cases, |((newline, gap, counted), chosen, together)| {
            let mut d = document(&neighbours(newline, gap, counted));
            let mut texts = vec![d.text().to_owned()];
            // Together they would all change the count.
            let together = together && !counted;
            let node = |d: &Document, number: usize| {
                let nodes = d.outline().nodes().iter();
                let all: Vec<NodeId> =
                    nodes.filter(|n| matches!(n.kind, Kind::Shape | Kind::Light)).map(|n| n.id).collect();
                all.get(number % all.len().max(1)).copied()
            };
            if together {
                let mut nodes: Vec<NodeId> = chosen.iter().filter_map(|&n| node(&d, n)).collect();
                nodes.sort();
                nodes.dedup();
                let removed = nodes.len();
                let before = d.outline().nodes().len();
                let edit = Edit::Together(nodes.into_iter().map(Edit::Delete).collect());
                d.apply(&edit).unwrap_or_else(|error| panic!("{error}: {:?}", texts[0]));
                prop_assert_eq!(d.outline().nodes().len() + removed, before, "{:?}", d.text());
                texts.push(d.text().to_owned());
            } else {
                for number in chosen {
                    let Some(node) = node(&d, number) else { break };
                    d.apply(&Edit::Delete(node)).unwrap();
                    texts.push(d.text().to_owned());
                }
            }
            // Back, forth and back again, through every text on the way and with the same nodes.
            let ids = |d: &Document| d.outline().nodes().iter().map(|n| n.id).collect::<Vec<_>>();
            let last = texts.len() - 1;
            for text in texts[..last].iter().rev() {
                prop_assert!(d.undo());
                prop_assert_eq!(d.text(), text);
            }
            prop_assert!(!d.undo() && !d.is_dirty() || d.path().is_none());
            let whole = ids(&d);
            for text in &texts[1..] {
                prop_assert!(d.redo());
                prop_assert_eq!(d.text(), text);
            }
            for text in texts[..last].iter().rev() {
                prop_assert!(d.undo());
                prop_assert_eq!(d.text(), text);
            }
            prop_assert_eq!(ids(&d), whole);
            Ok(())
        })
        .unwrap();
}

#[test]
fn a_key_of_two_spellings_is_one_field() {
    let spellings = [
        ("Material", "diffuseColor 1 0 0", ["exponent", "shininess"], "7"),
        ("Material", "diffuseColor 1 0 0", ["indexOfRefraction", "refractionIndex"], "1.5"),
        ("TriangleMesh", "smooth on", ["file", "obj_file"], "tent.obj"),
    ];
    for (keyword, rest, keys, value) in spellings {
        let text = |written: &str| {
            let block = format!("{keyword} {{ {rest}{written} }}");
            match keyword {
                "Material" => SCENE.replace("Materials {", &format!("Materials {{ {block}")),
                _ => SCENE.replace("Sphere ball { center 0 0 0  radius 1 }", &block),
            }
        };
        let shown = |d: &Document| -> Vec<(String, bool)> {
            let node = find(d, keyword);
            let fields = d.fields(node).into_iter().filter(|field| keys.contains(&&*field.key));
            fields.map(|field| (field.key, field.span.is_some())).collect()
        };
        let absent = document(&text(""));
        assert_eq!(shown(&absent), [(keys[0].to_owned(), false)], "the usual one");
        for (key, other) in [(keys[0], keys[1]), (keys[1], keys[0])] {
            let mut d = document(&text(&format!(" {key} {value}")));
            assert_eq!(shown(&d), [(key.to_owned(), true)], "the one that is written");
            let node = find(&d, keyword);
            assert_eq!(d.value(node, other), d.value(node, key), "they say the same");
            // Whoever asks for the other one changes this one.
            let new =
                if keyword == "Material" { FieldValue::numbers([2.5]) } else { FieldValue::word("b.obj") };
            let expected = text(&format!(" {key} {}", new.text()));
            d.apply(&Edit::set(node, other, new)).unwrap();
            assert_eq!(d.text(), expected);
            d.apply(&Edit::Unset { node, key: other.to_owned(), nth: None }).unwrap();
            assert_eq!(d.text(), text(""));
        }
        // Who wrote both sees both.
        let both = document(&text(&format!(" {} {value} {} {value}", keys[0], keys[1])));
        assert_eq!(shown(&both).len(), 2);
    }
}

#[test]
fn what_says_nothing_alone_is_set_and_taken_out_together() {
    for (written, gap) in [("focus 4", "  "), ("focus 4 // sharp\n ", "\n  ")] {
        let camera = format!(
            "PerspectiveCamera {{\n  center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30\n  {written}}}\n"
        );
        let rest = SCENE.split_once("PerspectiveCamera").unwrap().1.split_once('}').unwrap().1;
        let mut d = document(&format!("{camera}{rest}"));
        let before = d.text().to_owned();
        let node = find(&d, "PerspectiveCamera");
        for key in ["fNumber", "focalLength"] {
            let field = d.fields(node).into_iter().find(|field| field.key == key).unwrap();
            assert!(field.idle.is_none() && field.value.is_none(), "{field:?}");
            d.apply(&Edit::set(node, key, field.start)).unwrap();
            let text = d.text();
            assert!(text.contains(&format!("{gap}fNumber 2.8")), "{text}");
            assert!(text.contains(&format!("{gap}focalLength 0.05")), "{text}");
            d.compile();
            assert!(d.is_current(), "{}", d.report(false));
            d.apply(&Edit::Unset { node, key: key.to_owned(), nth: None }).unwrap();
            assert_eq!(d.text(), before);
            assert!(d.undo() && d.undo());
            assert_eq!(d.text(), before);
        }
    }
}
