//! Editing by blocks: what is removed side by side comes back.

use std::path::Path;

use kajo::LoadOptions;
use kajo::edit::{Document, Edit, Kind, NodeId};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

fn document(text: &str) -> Document {
    let mut document = Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap();
    document.compile();
    document
}

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
