//! Any bytes as a scene that includes itself under the name `self`, and as the file `b`.

#![no_main]

use kajo_scene::{Limits, MemoryAssets, SceneDesc, print, render, tokens};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok(text) = std::str::from_utf8(data) {
        let covered: usize = tokens(text).map(|token| token.range().len()).sum();
        assert_eq!(covered, text.len());
    }
    let limits = Limits { includes: 50, items: 100_000, ..Limits::default() };
    let assets = MemoryAssets::new().with("self", data).with("b", data);
    let parsed = SceneDesc::load("self", &assets, &limits);
    let sources = parsed.desc.sources();
    for item in parsed.desc.items() {
        sources.text(item.span());
        item.values().for_each(|(_, span)| assert!(!sources.text(span).is_empty()));
    }
    render(&parsed.diagnostics, sources, true);
    if !parsed.diagnostics.has_errors() {
        let printed = print(&parsed.desc);
        let again = SceneDesc::parse("print", &*printed, &MemoryAssets::new(), &limits);
        assert!(again.diagnostics.is_empty());
        assert_eq!(print(&again.desc), printed);
    }
});
