//! Checkpoints of integrators that keep something for many samples (photons, vertices, records, chains, what they have learned):
//! whenever a render is stopped and taken up again, and on however many threads, the picture has the bytes of one that was never stopped.

mod room;

use std::ops::ControlFlow;
use std::path::Path;

use kajo::output::Target;
use kajo::{
    BitDepth, Defaults, Format, Passes, Picture, RenderError, RenderSettings, Resources, SamplerKind, Scene,
    Settings, Silent, Snapshot, View,
};
use room::{ROOM, load};

/// The same room with smoke in it and in the ball.
const SMOKE: &str = "Media { Medium air { sigma_s 0.1 0.2 0.3  sigma_a 0.05 }
    FunctionMedium m { function = 1 + x  sigma_s 1 }  exterior air }";

const METHODS: [&str; 14] = [
    "sppm  photons 500",
    "sppm  photons 500  spectral on",
    "photon  photons 2000  photonMap direct",
    "photon  photons 2000  photonMap gather",
    "photon  photons 2000  photonMap caustics",
    "vcm  photons 500",
    "vcm  photons 500  spectral on",
    "irradiance  rays 64",
    "mlt",
    "mmlt",
    "path  guiding on  training 6",
    "path  guiding on  training 6  spectral on",
    "path  lightChoice learned",
    "path  caustics manifold",
];

const OUTPUTS: [(View, Format); 1] = [(View::Color, Format::Exr)];

/// A render of a scene of its own.
struct Render {
    scene: Scene,
    method: String,
}

impl Render {
    fn settings(&self, samples: u32) -> RenderSettings {
        let asked = Settings {
            size: Some([18, 12]),
            samples: Some((SamplerKind::Sobol, samples)),
            ..Settings::default()
        };
        RenderSettings::resolve(&self.scene, &asked, Defaults::Modern, false).unwrap()
    }

    fn run(
        &self,
        samples: u32,
        threads: usize,
        resume: Option<&Path>,
        look: &mut dyn FnMut(Snapshot<'_>) -> ControlFlow<()>,
    ) -> Result<Picture, RenderError> {
        let (settings, passes) =
            (self.settings(samples), Passes { resume: resume.map(Path::to_path_buf), ..Passes::default() });
        let resources = Resources { threads, ..Resources::default() };
        let request = kajo::RenderRequest::new(&self.scene, &settings, &OUTPUTS).with(resources);
        kajo::render_passes(&request, &passes, &Silent, look)
    }

    /// Goes on until pixels have so many samples and keeps that in a file.
    fn stop_after(&self, of: u32, samples: u32, resume: Option<&Path>, file: &Path) {
        let target = Target::check(file, &[]).unwrap();
        let ended = self.run(of, 3, resume, &mut |snapshot| {
            if snapshot.samples() < samples {
                return ControlFlow::Continue(());
            }
            snapshot.save(&target).unwrap();
            ControlFlow::Break(())
        });
        assert!(matches!(ended, Err(RenderError::Cancelled(_))), "{}: it was not stopped", self.method);
    }
}

fn exr(picture: &Picture) -> Vec<u8> {
    picture.encode(&[View::Color], Format::Exr, BitDepth::Eight).unwrap()
}

/// * `media`: what is in front of the materials
fn check(method: &str, media: &str) {
    const SAMPLES: u32 = 16;
    let text = ROOM.replacen("Materials", &format!("{media} Materials"), 1);
    let text =
        if media.is_empty() { text } else { text.replace("Glass glass { }", "Glass glass { medium m }") };
    let render = Render {
        scene: load(&format!("{text}\nSettings {{ integrator {method}  bounces 4 }}")),
        method: method.to_owned(),
    };
    let without_end = &mut |_: Snapshot<'_>| ControlFlow::Continue(());
    let settings = render.settings(SAMPLES);
    let request = kajo::RenderRequest::new(&render.scene, &settings, &OUTPUTS);
    let at_once = exr(&kajo::render(&request, &Silent).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
    for (stop, threads) in [(1, 1), (2, 7), (8, 2)] {
        render.stop_after(SAMPLES, stop, None, &first);
        let picture = render.run(SAMPLES, threads, Some(&first), without_end).unwrap();
        assert!(exr(&picture) == at_once, "{method}: stopped after {stop} samples");
    }
    // Stopped twice.
    render.stop_after(SAMPLES, 2, None, &first);
    render.stop_after(SAMPLES, 4, Some(&first), &second);
    let picture = render.run(SAMPLES, 1, Some(&second), without_end).unwrap();
    assert!(exr(&picture) == at_once, "{method}: stopped twice");
    // Finished with fewer samples, and then more are wanted.
    let target = Target::check(&first, &[]).unwrap();
    render.run(5, 2, None, without_end).unwrap().snapshot().unwrap().save(&target).unwrap();
    let picture = render.run(SAMPLES, 2, Some(&first), without_end).unwrap();
    assert!(exr(&picture) == at_once, "{method}: finished with 5 samples, then {SAMPLES}");
}

#[test]
fn what_is_kept_is_the_same_after_a_stop() {
    METHODS.into_iter().for_each(|method| check(method, ""));
}

#[test]
fn what_is_kept_in_media_is_the_same_after_a_stop() {
    METHODS.into_iter().for_each(|method| check(method, SMOKE));
}
