//! How much memory a large mesh takes, next to what must be kept of it.
//!
//! A mesh of waves is written as an OBJ file, read as any scene's is, compiled and rendered. The figure is
//! the most memory the process ever held over the bytes of the mesh and its tree, so a run measures
//! only what is done first in its process.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use kajo_core::settings::Settings;

use super::picture;
use kajo::{Defaults, LoadOptions, RenderSettings, load};

/// What a run showed, in bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Triangles of the mesh.
    pub triangles: usize,
    /// The OBJ file.
    pub file: u64,
    /// The mesh and its tree as they are kept to be rendered.
    pub kept: usize,
    /// The most that the process held at any time; `None` where the system does not tell.
    pub peak: Option<u64>,
}

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum MemoryError {
    /// The mesh could not be written to the folder for temporary files.
    #[error("cannot write the mesh: {0}")]
    Write(#[from] io::Error),
    /// The scene could not be read.
    #[error("cannot read the mesh back:\n{0}")]
    Read(String),
    /// The scene could not be rendered.
    #[error("cannot render the mesh: {0}")]
    Render(String),
    /// The picture shows nothing but background.
    #[error("the mesh is not in the picture")]
    Empty,
}

const SCENE: &str = "
    PerspectiveCamera { center 0 2 3  direction 0 -2 -3  up 0 1 0  angle 40 }
    Background { color 0 0 0  ambientLight 1 1 1 }
    Materials { Material { diffuseColor 1 1 1 } }
    Group { MaterialIndex 0  TriangleMesh { obj_file mesh.obj } }";

/// Renders a mesh of about `triangles` triangles.
///
/// # Errors
/// [`MemoryError`].
pub fn run(triangles: usize) -> Result<Report, MemoryError> {
    let folder = tempfile::tempdir()?;
    let side = (triangles.max(2) / 2).isqrt().max(1);
    write_waves(side, &folder.path().join("mesh.obj"))?;
    let path = folder.path().join("scene.txt");
    fs::write(&path, SCENE)?;
    let file = fs::metadata(folder.path().join("mesh.obj"))?.len();
    let loaded = load(&path, &LoadOptions::default());
    let Some(scene) = &loaded.scene else { return Err(MemoryError::Read(loaded.report(false))) };
    let asked = Settings { size: Some([64, 64]), ..Settings::default() };
    let settings = RenderSettings::resolve(scene, &asked, Defaults::Classic, false)
        .map_err(|error| MemoryError::Read(error.to_string()))?;
    let picture = picture::render(scene, &settings, &[settings.sampler()], 0).map_err(MemoryError::Render)?;
    if picture.mean()[0] <= 0.0 {
        return Err(MemoryError::Empty);
    }
    let peak = fs::read_to_string("/proc/self/status").ok().and_then(|status| peak_in(&status));
    Ok(Report { triangles: 2 * side * side, file, kept: scene.geometry.bytes(), peak })
}

/// `side` × `side` squares of two triangles over [-1, 1]².
fn write_waves(side: usize, path: &Path) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    for row in 0..=side {
        for column in 0..=side {
            let [x, z] = [column, row].map(|i| 2.0 * i as f64 / side as f64 - 1.0);
            let y = 0.1 * kajo_math::fmath::sin64(9.0 * x) * kajo_math::fmath::sin64(7.0 * z);
            writeln!(out, "v {x:.6} {y:.6} {z:.6}")?;
        }
    }
    for row in 0..side {
        for column in 0..side {
            // OBJ counts from 1.
            let a = row * (side + 1) + column + 1;
            let c = a + side + 1;
            writeln!(out, "f {a} {c} {}\nf {} {c} {}", a + 1, a + 1, c + 1)?;
        }
    }
    out.flush()
}

/// The high-water mark in bytes.
fn peak_in(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_mesh_is_measured() {
        let report = run(1000).unwrap();
        assert_eq!(report.triangles, 2 * 22 * 22);
        assert!(report.kept > 968 * 12, "indices alone are that much: {report:?}");
        assert!(report.peak.is_none_or(|peak| peak > report.kept as u64));
    }

    #[test]
    fn the_line_of_the_kernel_is_read() {
        assert_eq!(peak_in("VmPeak: 9 kB\nVmHWM:\t   2048 kB\n"), Some(2048 * 1024));
        assert_eq!(peak_in("VmHWM: much\n"), None);
    }
}
