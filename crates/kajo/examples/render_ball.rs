//! A scene from a string to a picture file: `cargo run --release --example render_ball`.

use std::error::Error;
use std::path::Path;

use kajo::output::Target;
use kajo::{BitDepth, Defaults, Format, LoadOptions, MemoryAssets, RenderSettings, Settings, Silent, View};

const BALL: &str = "
PerspectiveCamera { center 0 1 9  direction 0 -0.1 -1  up 0 1 0  angle 30 }
Background { color 0.6 0.7 0.9  ambientLight 0.2 0.2 0.25 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.8 0.8 0.7 } }
Materials {
  PhongMaterial gold { diffuseColor 0.8 0.6 0.2  specularColor 1 1 1  exponent 40  reflectiveColor 0.2 0.2 0.1 }
  PhongMaterial floor { diffuseColor 0.6 0.6 0.6 }
}
Group {
  MaterialIndex gold   Sphere { center 0 0 0  radius 1 }
  MaterialIndex floor  Plane { normal 0 1 0  offset -1 }
}";

fn main() -> Result<(), Box<dyn Error>> {
    let assets = MemoryAssets::new().with("ball.txt", BALL);
    let loaded = kajo::load_from("ball.txt", &assets, &LoadOptions::default());
    let scene = loaded.scene.as_ref().ok_or_else(|| loaded.report(false))?;

    let settings = RenderSettings::resolve(scene, &Settings::default(), Defaults::Modern, false)?;
    let outputs = [(View::Color, Format::Png)];
    let picture = kajo::render(&kajo::RenderRequest::new(scene, &settings, &outputs), &Silent)?;

    let bytes = picture.encode(&[View::Color], Format::Png, BitDepth::Eight)?;
    Target::check(Path::new("ball.png"), &[])?.write(&bytes)?;
    println!("ball.png: {} rays in {:.2} s", picture.stats.rays.total(), picture.stats.seconds);
    Ok(())
}
