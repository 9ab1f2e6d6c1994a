//! Whether the self-test sees mistakes: each of a list of bugs is put into a copy of the sources, and the self-test
//! must fail there.

use std::fs;
use std::io;
use std::path::Path;

use crate::steps::{Cargo, Report};

/// A mistake that somebody could make.
struct Mutant {
    name: &'static str,
    file: &'static str,
    /// Occurs once in the file.
    right: &'static str,
    wrong: &'static str,
}

const fn mutant(name: &'static str, file: &'static str, right: &'static str, wrong: &'static str) -> Mutant {
    Mutant { name, file, right, wrong }
}

const AREA: &str = "crates/kajo-core/src/light/area.rs";
const LAMBERT: &str = "crates/kajo-core/src/bsdf/lambert.rs";
const PHONG: &str = "crates/kajo-core/src/bsdf/phong_lobes.rs";
const LIGHTING: &str = "crates/kajo-core/src/lighting.rs";
const VIEW: &str = "crates/kajo-render/src/integrator/camera_view.rs";
const CONNECT: &str = "crates/kajo-render/src/integrator/bidir/connect.rs";
const TRACER: &str = "crates/kajo-render/src/integrator/path/tracer.rs";
const STEPS: &str = "crates/kajo-render/src/integrator/transport/steps.rs";

const INTERACTION: &str = "crates/kajo-core/src/interaction.rs";

const MUTANTS: [Mutant; 15] = [
    mutant("no squared index at refraction", PHONG, "color * mode.scale(eta), p", "color, p"),
    mutant("no pi in diffuse reflection", LAMBERT, "share * (wi.z.abs() * FRAC_1_PI)", "share * wi.z.abs()"),
    mutant(
        "no cosine in diffuse reflection",
        LAMBERT,
        "share * (wi.z.abs() * FRAC_1_PI)",
        "share * FRAC_1_PI",
    ),
    mutant(
        "the density of a light without that of its choice",
        STEPS,
        "pdf: li.pdf * probability }",
        "pdf: li.pdf * (0.0 * probability + 1.0) }",
    ),
    mutant(
        "half the density of a light that was met",
        LIGHTING,
        "true => probability * lights.pdf_li_beside_scattering(id, to, at, wi)",
        "true => 0.5 * probability * lights.pdf_li_beside_scattering(id, to, at, wi)",
    ),
    mutant(
        "half the density of a direction to a light that was drawn",
        TRACER,
        "power_heuristic(pdf, self.pdf_of_path(bsdf, local.wo, towards))",
        "power_heuristic(pdf, 0.5 * self.pdf_of_path(bsdf, local.wo, towards))",
    ),
    mutant(
        "a place of an emitter gives the light of the whole",
        AREA,
        "Some(varied) => surfaces.radiance(self, varied, leaving, time, wavelengths),",
        "Some(varied) => {\n                let _ = (varied, leaving, time, surfaces);\n                self.emission.at(wavelengths)\n            }",
    ),
    mutant(
        "rays start on the mesh that they leave",
        INTERACTION,
        "gamma(10) * extent + f32::MIN_POSITIVE",
        "0.0 * extent",
    ),
    mutant("rays end on the surface that they reach", LIGHTING, "p_error + seen_error", "p_error"),
    mutant("branches are added, not averaged", TRACER, "path.state.beta *= 1.0 / n as f32;", ""),
    mutant("survivors do not count more", STEPS, "path.beta *= 1.0 / q;", ""),
    mutant(
        "shadows are forgotten",
        STEPS,
        "scene.transmittance(segment, eta, wavelengths)",
        "scene.transmittance(segment, eta, wavelengths) * 0.0 + Spectrum::WHITE",
    ),
    mutant(
        "lights stay where they were when the shutter opened",
        AREA,
        "self.drift.as_ref().map(|drift| drift.map_at(time))",
        "self.drift.as_ref().map(|drift| drift.map_at(0.0 * time))",
    ),
    mutant(
        "the shutter closes half-way",
        VIEW,
        "let time = draws.number_if(self.moves);\n        let film = &self.film;\n        let at",
        "let time = 0.5 * draws.number_if(self.moves);\n        let film = &self.film;\n        let at",
    ),
    mutant(
        "joined paths count in full",
        CONNECT,
        "distance2.recip(),\n            weight: mis_weight(w_light, w_camera)",
        "distance2.recip(),\n            weight: mis_weight(0.0 * w_light, 0.0 * w_camera)",
    ),
];

/// Puts each mistake into a copy of the sources below `target/mutants` and runs the self-test there.
pub fn check(root: &Path, report: &mut Report) {
    let copy = root.join("target/mutants");
    if let Err(error) = copy_sources(root, &copy) {
        return report.add("copy of the sources", Err(vec![error.to_string()]));
    }
    let build = "test --profile deep --package kajo-selftest --lib";
    let test =
        || Cargo::new(&copy, &format!("{build} -- --exact tests::every_row_passes")).env("KAJO_DEEP", "1");
    report.run("the self-test as it is", test());
    for mutant in &MUTANTS {
        let path = copy.join(mutant.file);
        let Ok(text) = fs::read_to_string(&path) else {
            report.add(mutant.name, Err(vec![format!("cannot read {}", path.display())]));
            continue;
        };
        let put = |text: &str| fs::write(&path, text).map_err(|error| vec![error.to_string()]);
        if let Err(problem) = put(&text.replacen(mutant.right, mutant.wrong, 1)) {
            report.add(mutant.name, Err(problem));
            continue;
        }
        // A mistake that does not compile would be seen by anybody.
        report.run(&format!("{}: compiles", mutant.name), Cargo::new(&copy, &format!("{build} --no-run")));
        report.run_to_fail(&format!("{}: is seen", mutant.name), test());
        if let Err(problem) = put(&text) {
            report.add("the sources put back", Err(problem));
        }
    }
}

/// Copies what cargo needs to build the workspace. The copy's own build stays, so that it need not start anew.
fn copy_sources(root: &Path, copy: &Path) -> io::Result<()> {
    const NEEDED: [&str; 5] = ["Cargo.toml", "Cargo.lock", "rust-toolchain.toml", "crates", "xtask"];
    fs::create_dir_all(copy)?;
    NEEDED.iter().try_for_each(|name| copy_tree(&root.join(name), &copy.join(name)))
}

/// Copies a file, or a folder with all in it. Files that are the same already keep their time.
fn copy_tree(from: &Path, to: &Path) -> io::Result<()> {
    if !from.is_dir() {
        let content = fs::read(from)?;
        return if fs::read(to).is_ok_and(|old| old == content) { Ok(()) } else { fs::write(to, content) };
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let name = entry?.file_name();
        copy_tree(&from.join(&name), &to.join(&name))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_mistake_has_its_place_in_the_sources() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        for mutant in &MUTANTS {
            let text = fs::read_to_string(root.join(mutant.file)).expect("a source");
            assert_eq!(text.matches(mutant.right).count(), 1, "{}", mutant.name);
        }
    }

    #[test]
    fn trees_are_copied_whole() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let copy = std::env::temp_dir().join(format!("kajo-xtask-copy-{}", std::process::id()));
        copy_tree(&root.join("src"), &copy).expect("a copy");
        let same = fs::read(copy.join("mutants.rs")).expect("a copy of this file");
        assert_eq!(same, fs::read(root.join("src/mutants.rs")).expect("this file"));
        fs::remove_dir_all(&copy).expect("the copy");
    }
}
