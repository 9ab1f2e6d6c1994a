use crate::clock::Clock;
use crate::{Limits, MemoryAssets, Parsed, SceneDesc};

/// Frame 13 at 24 frames a second, half a second after time 0, and two moments more.
fn parse(text: &str) -> Parsed {
    let clock = Clock::new(24.0, 1, 13).with_moments([6.0, 12.0]);
    SceneDesc::parse_at("scene", text, &MemoryAssets::new(), &Limits::default(), &clock)
}

fn said(text: &str) -> Vec<String> {
    let parsed = parse(text);
    parsed.diagnostics.iter().map(|said| said.message.clone()).collect()
}

/// The numbers of the first item at each moment.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    let parsed = parse(text);
    assert_eq!(said(text), [""; 0], "{text}");
    let item = parsed.desc.roots().next().unwrap();
    (0..3).map(|moment| item.at_moment(moment).numbers().map(|(value, _)| value).collect()).collect()
}

/// The same for items with one number.
fn number(text: &str) -> Vec<f64> {
    numbers(text)
        .iter()
        .map(|numbers| {
            assert_eq!(numbers.len(), 1, "{text}");
            numbers[0]
        })
        .collect()
}

#[test]
fn keys_stand_for_numbers() {
    assert_eq!(number("radius keys { 0: 0  1: 4 }"), [2.0, 3.0, 4.0]);
    assert_eq!(number("radius = keys { 0: 0  1: 4 }"), [2.0, 3.0, 4.0]);
    assert_eq!(number("radius keys step { 0: 1  0.75: 4 }"), [1.0, 4.0, 4.0]);
    assert_eq!(number("radius keys loop { 0: 0  0.5: 4 }"), [0.0, 2.0, 0.0]);
    assert_eq!(number("radius keys pingpong linear { 0: 0  0.5: 4 }"), [4.0, 2.0, 0.0]);
    assert_eq!(number("radius keys monotone { 0: 1  0.5: 3  2: 3 }"), [3.0; 3]);
    let vector = numbers("center keys { 0: 0 -1 (1 + 1)  # here\n /* then */ 1: 4 -1 -2 }");
    assert_eq!(vector, [[2.0, -1.0, 0.0], [3.0, -1.0, -1.0], [4.0, -1.0, -2.0]]);
    assert_eq!(
        numbers("center 7 keys { 0: 0  1: 4 } 9"),
        [[7.0, 2.0, 9.0], [7.0, 3.0, 9.0], [7.0, 4.0, 9.0]]
    );
    assert_eq!(number("x keys { -1/2: 0  1.5: 8 }"), [4.0, 5.0, 6.0]);
}

#[test]
fn expressions_know_the_time() {
    assert_eq!(number("radius (time)"), [0.5, 0.75, 1.0]);
    assert_eq!(number("radius 2 * time"), [1.0, 1.5, 2.0]);
    assert_eq!(number("radius time * 2"), [1.0, 1.5, 2.0]);
    assert_eq!(number("radius = frame"), [13.0, 19.0, 25.0]);
    assert_eq!(number("radius floor(frame / 12)"), [1.0, 1.0, 2.0]);
    assert_eq!(numbers("center 0 time 1")[1], [0.0, 0.75, 1.0]);
    assert_eq!(numbers("center time 0 -1")[1], [0.75, 0.0, -1.0]);
    assert_eq!(numbers("center time -.5 1")[1], [0.75, -0.5, 1.0]);
    // A value of that name hides it, and a name after a keyword is one.
    assert_eq!(numbers("let time = 3 center 0 time 1").len(), 3);
    let parsed = parse("material time  radius 2");
    assert_eq!(parsed.desc.roots().next().unwrap().word().unwrap().raw, "time");
    assert!(!parsed.desc.changes());
}

#[test]
fn named_values_change_with_what_they_are_made_of() {
    let parsed =
        parse("let a = keys { 0: 0  1: 4 } let b = 2 * a Group { let a = 1 Ball { x b y (a) } } End { x a }");
    assert!(!parsed.diagnostics.has_errors() && parsed.desc.changes());
    let all: Vec<_> = parsed.desc.items().collect();
    let at = |keyword: &str, moment: usize| {
        let item = all.iter().rfind(|item| item.keyword() == keyword).unwrap().at_moment(moment);
        item.numbers().map(|(value, _)| value).collect::<Vec<_>>()
    };
    assert_eq!(at("y", 2), [1.0]);
    assert_eq!((at("x", 0), at("x", 2)), (vec![2.0], vec![4.0]));
    let group = parsed.desc.roots().next().unwrap();
    let ball = group.at_moment(1).children().next().unwrap();
    assert_eq!(ball.children().next().unwrap().numbers().next().unwrap().0, 6.0);
    assert!(group.changes() && ball.changes());
    assert!(!ball.children().nth(1).unwrap().changes());
    // Turns, functions of the place and counts are those of the frame.
    let parsed = parse("repeat i (2 * time) { Box { f = x + time } }");
    assert_eq!(parsed.desc.roots().count(), 1);
    let function = parsed.desc.roots().next().unwrap().children().next().unwrap();
    assert_eq!(function.function_text().unwrap(), "= x + 0.5");
    assert!(parsed.desc.changes());
}

#[test]
fn objects_may_still_be_called_keys() {
    let parsed = parse("Sphere keys { center 0 0 0 } Sphere keys { } PhongMaterial keys step { } file keys");
    let words: Vec<_> =
        parsed.desc.roots().map(|item| (item.has_block(), item.word().map(|w| w.raw))).collect();
    assert_eq!(words[..2], [(true, Some("keys")); 2]);
    assert!(!parsed.desc.changes());
}

#[test]
fn bad_keys_are_said_with_their_place() {
    for (text, message) in [
        ("radius keys { }", "there is no key in these `keys`"),
        ("radius keys cubic { }", "there is no key in these `keys`"),
        ("radius keys { 1 2 }", "a key begins with its time and `:`"),
        ("radius keys { 0: 1  0: 2 }", "keys stand in the order of time, each later than the last (0)"),
        ("radius keys { 1: 1  0: 2 }", "keys stand in the order of time, each later than the last (1)"),
        ("radius keys { 0: 1  1: 2 3 }", "this key has 2 values, and the first one 1"),
        ("radius keys { 0: 1  1: }", "this key has 0 values, and the first one 1"),
        ("radius keys { 0: }", "a key has a value behind its time"),
        ("radius keys cubix { 0: 1 }", "keys cannot be `cubix`"),
        ("radius keys { 0: 1 / 0 }", "division by zero"),
        ("radius keys { 0: time }", "keys are the same at all times"),
        ("radius keys { 0: nan }", "there is no value named `nan`"),
        ("radius keys { 0: 1e999 }", "expected a number, a name or `(`, found `1`"),
        ("let r = keys { 0: 1 2 }", "one number is wanted here, and these keys have 2"),
        ("radius 1 / (time - 1)", "division by zero"),
        ("radius = 1 / (time - 1)", "division by zero"),
    ] {
        assert_eq!(said(text), [message], "{text}");
    }
    assert!(said("Sphere { radius keys { 0: 1").iter().any(|said| said.contains("is not closed")));
    // What is wrong in a block of keys leaves the rest as it is.
    let parsed = parse("Sphere { radius keys { 0: 1  0: 2 }  center 1 2 3 } Box { }");
    assert!(parsed.whole && parsed.desc.roots().count() == 2);
    let parsed = parse("radius keys { 0: 1  1: 2 }");
    assert_eq!(
        parsed.desc.sources().text(parsed.desc.expressions().next().unwrap().0),
        "keys { 0: 1  1: 2 }"
    );
}

#[test]
fn keys_are_known_by_where_they_are_written() {
    let text = "let r = keys { 0: 1 }  let one = 1
        Sphere { center 7 keys cubic loop { 0: 0 1 /* x */ (1 / 2): one 3 }  radius r }
        repeat i 2 { Disk { radius keys { i: 1  2: 2 } } }";
    let parsed = parse(text);
    assert_eq!(parsed.diagnostics.iter().count(), 0);
    let keyed = parsed.desc.keyed();
    let [value, center, radius] = keyed else { panic!("{keyed:?}") };
    assert_eq!((value.owner, value.keys[0].time), (crate::KeysOwner::Value(0), 0.0));
    assert_eq!(parsed.desc.named_values().next().unwrap().0, "r");
    assert!(text[center.span.range()].starts_with("keys cubic") && text[center.span.range()].ends_with('}'));
    let crate::KeysOwner::Item { item, first } = center.owner else { panic!() };
    assert_eq!((parsed.desc.item(item).unwrap().keyword(), first), ("center", 1));
    let last = &center.keys[1];
    assert_eq!((last.time, &text[last.time_place.clone()]), (0.5, "(1 / 2)"));
    let values: Vec<(f64, &str)> = last.values.iter().map(|(v, at)| (*v, &text[at.clone()])).collect();
    assert_eq!(values, [(1.0, "one"), (3.0, "3")]);
    assert!(radius.is_repeated && !center.is_repeated, "once for both turns");
}
