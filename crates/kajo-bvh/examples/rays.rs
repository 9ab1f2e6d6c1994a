//! Rays a second on mesh files: `rays FILE.kmsh... [--threads N] [--passes P] [--builds B] [--quality linear|high]`.
//!
//! Prints one JSON object a mesh, and fails where the hits are not those of the protocol.

use std::path::Path;
use std::process::ExitCode;

use kajo_bvh::bench::{Mesh, Settings, run};
use kajo_bvh::{BuildSettings, Quality};

fn main() -> ExitCode {
    let mut settings = Settings { threads: 1, passes: 5, builds: 3, build: BuildSettings::default() };
    let mut files = Vec::new();
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut number = || args.next().and_then(|n| n.parse().ok()).unwrap_or(1);
        match arg.as_str() {
            "--threads" => settings.threads = number(),
            "--passes" => settings.passes = number(),
            "--builds" => settings.builds = number(),
            "--quality" => {
                settings.build.quality = match args.next().as_deref() {
                    Some("linear") => Quality::Linear,
                    Some("high") => Quality::High,
                    _ => Quality::Fast,
                }
            }
            _ => files.push(arg),
        }
    }
    for file in files {
        let report = Mesh::read(Path::new(&file))
            .map_err(|e| e.to_string())
            .and_then(|mesh| run(&mesh, &settings).map_err(|e| e.to_string()));
        match report {
            Ok(report) => {
                println!("{}", report.to_json());
                if report.is_right() == Some(false) {
                    eprintln!("{file}: hits are not those of the protocol");
                    return ExitCode::FAILURE;
                }
            }
            Err(error) => {
                eprintln!("{error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
