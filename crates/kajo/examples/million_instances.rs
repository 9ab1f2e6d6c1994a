//! Writes a scene of a million instances of a mesh, a thousand at a time, and nothing else.
//!
//! ```text
//! cargo run --release -p kajo --example million_instances -- bunny.obj 0.1 > million.txt
//! kajo render million.txt -o million.png
//! ```
//!
//! The arguments are the mesh file, named as from the folder of the scene, and the factor that
//! brings it to a size of about one. The text has two thousand lines: instances of a definition that
//! holds instances.

use std::f64::consts::PI;
use std::io::{self, BufWriter, Write};

/// Instances in a patch, and patches.
const MANY: u32 = 1000;

fn main() -> io::Result<()> {
    let mut args = std::env::args().skip(1);
    let mesh = args.next().unwrap_or_else(|| "bunny.obj".to_owned());
    let size: f64 = args.next().and_then(|size| size.parse().ok()).unwrap_or(1.0);

    let mut out = BufWriter::new(io::stdout().lock());
    writeln!(out, "PerspectiveCamera {{ center 0 60 900  direction 0 -0.18 -1  up 0 1 0  angle 40 }}")?;
    writeln!(out, "Background {{ color 0.7 0.8 0.9  ambientLight 0.3 0.3 0.3 }}")?;
    writeln!(out, "Lights {{ DirectionalLight {{ direction 0.6 -0.7 -0.4  color 0.8 0.8 0.7 }} }}")?;
    writeln!(out, "Materials {{ PhongMaterial fur {{ diffuseColor 0.6 0.45 0.3 }} }}")?;
    writeln!(out, "Group {{\n  MaterialIndex fur")?;
    writeln!(
        out,
        "  Define one {{ Transform {{ UniformScale {size}  TriangleMesh {{ file \"{mesh}\" }} }} }}"
    )?;
    writeln!(out, "  Define patch {{")?;
    place(&mut out, "one", 1.3)?;
    writeln!(out, "  }}")?;
    place(&mut out, "patch", 1.3 * f64::from(MANY).sqrt())?;
    writeln!(out, "}}")?;
    out.flush()
}

/// Instances on the spiral of a sunflower, which covers a disc evenly; `step` is the distance of neighbours.
fn place(out: &mut impl Write, name: &str, step: f64) -> io::Result<()> {
    let golden = PI * (3.0 - 5f64.sqrt());
    for i in 0..MANY {
        let (radius, angle) = (step * f64::from(i).sqrt(), golden * f64::from(i));
        let (x, z) = (radius * angle.cos(), radius * angle.sin());
        let turn = (angle * 57.0) % 360.0;
        writeln!(out, "  Instance {name} {{ Translate {x:.3} 0 {z:.3}  YRotate {turn:.1} }}")?;
    }
    Ok(())
}
