//! Reads a mesh file, says what is in it and how fast it was read.

use kajo_scene::{AssetFile, Limits, Sources, read_mesh, render_one};
use std::time::Instant;

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "mesh.obj".to_owned());
    let file = std::fs::File::open(&path)?;
    let megabytes = file.metadata()?.len() as f64 / 1e6;
    let asset = AssetFile { path, len: None, stamp: None, reopen: None, reader: Box::new(file) };
    let start = Instant::now();
    match read_mesh(asset, &Limits::default()) {
        Ok((mesh, report)) => {
            let rate = megabytes / start.elapsed().as_secs_f64();
            println!("{} vertices, {} triangles at {rate:.0} MB/s", mesh.positions.len(), mesh.faces.len());
            report.warnings().iter().for_each(|warning| println!("warning: {warning}"));
        }
        Err(error) => {
            let mut sources = Sources::default();
            let diagnostic = error.to_diagnostic(&mut sources, None);
            println!("{}", render_one(&diagnostic, &sources, false));
        }
    }
    Ok(())
}
