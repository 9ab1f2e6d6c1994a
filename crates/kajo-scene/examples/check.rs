//! Reads a scene file, reports its mistakes and says how long that took.

use kajo_scene::{Limits, MemoryAssets, SceneDesc, render};
use std::time::Instant;

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "scene.txt".to_owned());
    let text = std::fs::read_to_string(&path)?;
    let (bytes, lines) = (text.len(), text.lines().count());
    let start = Instant::now();
    let parsed = SceneDesc::parse(&path, text, &MemoryAssets::new(), &Limits::default());
    let seconds = start.elapsed().as_secs_f64();
    print!("{}", render(&parsed.diagnostics, parsed.desc.sources(), false));
    println!("{lines} lines, {bytes} bytes, {} items in {seconds:.3} s", parsed.desc.len());
    Ok(())
}
