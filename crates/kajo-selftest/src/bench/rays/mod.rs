//! Ray casting alone, on meshes, by the protocol of [`kajo_bvh::bench`].
//!
//! For meshes of known names the counts of hits and the sums of their distances are compared with those of another
//! ray caster, Embree 4.4.0: primary hits and distances within 0.01 %, bounce and shadow hits
//! within 0.1 %, bounce distances within 1 % (on `sphere` they are few and very short). A speed is
//! reported only for answers that pass.

mod gate;
mod generate;

use std::path::Path;

pub use gate::{Gate, check};
pub use generate::{NAMES, generate};
pub use kajo_bvh::bench::{Figures, Mesh, Rates, Report, Settings, run};
pub use kajo_bvh::{BuildSettings, Quality};

/// A mesh that is made here, by its name, or one from a file.
///
/// # Errors
/// When it is neither a name of [`NAMES`] nor a readable mesh file; the text says what was wrong.
pub fn mesh(name: &str) -> Result<Mesh, String> {
    if let Some(mesh) = generate(name) {
        return Ok(mesh);
    }
    Mesh::read(Path::new(name)).map_err(|error| {
        let names = NAMES.join(", ");
        format!("cannot read the mesh `{name}`: {error} (meshes made here are {names})")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_mesh_is_said() {
        let message = mesh("no/such.kmsh").unwrap_err();
        assert!(message.contains("no/such.kmsh") && message.contains("terrain"), "{message}");
    }

    #[test]
    fn the_sphere_passes_the_gate() {
        let mesh = mesh("sphere").unwrap();
        assert_eq!(mesh.triangles.len(), 1_310_720);
        let settings = Settings { threads: 2, passes: 1, builds: 1, build: BuildSettings::default() };
        let report = run(&mesh, &settings).unwrap();
        assert_eq!(check(&report.mesh, report.triangles, &report.hits, report.sum_t), Ok(Gate::Passed));
    }
}
