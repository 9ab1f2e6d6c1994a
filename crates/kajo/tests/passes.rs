//! Renders in passes: checkpoints that continue to the same bytes, and those that are refused.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use kajo::output::Target;
use kajo::{
    BitDepth, CheckpointError, Defaults, Format, Goal, IntegratorName, LoadOptions, MemoryAssets, Passes,
    Picture, RenderError, RenderSettings, SamplerKind, Scene, SceneDigest, Settings, Silent, Snapshot, View,
};

const BALL: &str = "
    PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
    Background { color 0.1 0.2 0.3 }
    Lights { DirectionalLight { direction -1 -1 -1  color 1 1 1 } }
    Materials { Material gold { diffuseColor 1 0.8 0.2 } }
    Group { MaterialIndex gold  Sphere { center 0 0 0  radius 1 } }";

const OUTPUTS: [(View, Format); 2] = [(View::Color, Format::Exr), (View::Samples, Format::Exr)];

fn scene() -> Scene {
    let assets = MemoryAssets::new().with("ball.txt", BALL);
    kajo::load_from("ball.txt", &assets, &LoadOptions::default()).scene.unwrap()
}

fn settings(samples: (SamplerKind, u32)) -> RenderSettings {
    settings_of("classic", samples)
}

fn settings_of(integrator: &'static str, samples: (SamplerKind, u32)) -> RenderSettings {
    let integrator = Some(IntegratorName(integrator));
    let asked = Settings { integrator, size: Some([60, 40]), samples: Some(samples), ..Settings::default() };
    RenderSettings::resolve(&scene(), &asked, Defaults::Modern, false).unwrap()
}

fn exr(picture: &Picture) -> Vec<u8> {
    picture.encode(&[View::Color, View::Samples], Format::Exr, BitDepth::Eight).unwrap()
}

/// Renders in passes until `look` has enough.
fn run(
    settings: &RenderSettings,
    passes: &Passes,
    look: &mut dyn FnMut(Snapshot<'_>) -> ControlFlow<()>,
) -> Result<Picture, RenderError> {
    kajo::render_passes(&kajo::RenderRequest::new(&scene(), settings, &OUTPUTS), passes, &Silent, look)
}

/// A checkpoint of a render after four samples of each pixel.
fn checkpoint(settings: &RenderSettings, passes: &Passes, path: &Path) {
    let target = Target::check(path, &[]).unwrap();
    let ended = run(settings, passes, &mut |snapshot| {
        if snapshot.samples() < 4 {
            return ControlFlow::Continue(());
        }
        snapshot.save(&target).unwrap();
        ControlFlow::Break(())
    });
    assert!(matches!(ended, Err(RenderError::Cancelled(_))));
}

fn resumed(settings: &RenderSettings, path: &Path, passes: Passes) -> Result<Picture, RenderError> {
    let passes = Passes { resume: Some(path.to_path_buf()), ..passes };
    run(settings, &passes, &mut |_| ControlFlow::Continue(()))
}

fn refusal(settings: &RenderSettings, path: &Path, passes: Passes) -> CheckpointError {
    match resumed(settings, path, passes) {
        Err(RenderError::Checkpoint(error)) => error,
        other => panic!("not refused: {:?}", other.map(|picture| picture.stats)),
    }
}

#[test]
fn a_checkpoint_continues_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    for (samples, adaptive) in [
        ((SamplerKind::Jittered, 9), false),
        ((SamplerKind::Sobol, 16), false),
        ((SamplerKind::Pmj, 40), true),
    ] {
        let settings = settings(samples);
        let passes = Passes { goal: Goal { adaptive, ..Goal::default() }, ..Passes::default() };
        let whole = run(&settings, &passes, &mut |_| ControlFlow::Continue(())).unwrap();
        if !adaptive {
            let once =
                kajo::render(&kajo::RenderRequest::new(&scene(), &settings, &OUTPUTS), &Silent).unwrap();
            assert_eq!(exr(&whole), exr(&once), "passes or not");
        }
        checkpoint(&settings, &passes, &path);
        let resumed = resumed(&settings, &path, passes).unwrap();
        assert_eq!(exr(&resumed), exr(&whole), "{samples:?}");
        assert!(resumed.stats.samples < whole.stats.samples);
        assert_eq!(resumed.mean_samples(), whole.mean_samples());
        assert!(adaptive || whole.mean_samples() == f64::from(samples.1));
    }
}

#[test]
fn a_render_goes_on_to_more_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    let target = Target::check(&path, &[]).unwrap();
    let without_end = &mut |_: Snapshot<'_>| ControlFlow::Continue(());
    for kind in [SamplerKind::Sobol, SamplerKind::Uniform] {
        for integrator in ["path", "bidirectional", "distribution"] {
            let of = |n| settings_of(integrator, (kind, n));
            let at_once =
                kajo::render(&kajo::RenderRequest::new(&scene(), &of(64), &OUTPUTS), &Silent).unwrap();
            // Finished with a number that is no power of two, and begun only.
            let finished = run(&of(19), &Passes::default(), without_end).unwrap();
            finished.snapshot().unwrap().save(&target).unwrap();
            let resumed_whole = resumed(&of(64), &path, Passes::default()).unwrap();
            checkpoint(&of(40), &Passes::default(), &path);
            let resumed_part = resumed(&of(64), &path, Passes::default()).unwrap();
            assert_eq!(exr(&resumed_whole), exr(&at_once), "{kind:?}, {integrator:?}");
            assert_eq!(exr(&resumed_part), exr(&at_once), "{kind:?}, {integrator:?}");
            assert_eq!(resumed_whole.stats.samples, 60 * 40 * (64 - 19));
        }
    }
}

#[test]
fn numbers_of_samples_that_cannot_be_reached_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    for (name, kind) in SamplerKind::NAMES.into_iter().filter(|(_, kind)| !kind.is_open_ended()) {
        checkpoint(&settings((kind, 16)), &Passes::default(), &path);
        let error = refusal(&settings((kind, 64)), &path, Passes::default());
        let CheckpointError::OtherNumber { then, now, .. } = &error else { panic!("{name}: {error}") };
        assert_eq!(then.replacen("16", "64", 1), *now);
        assert!(error.to_string().contains("sobol"), "{error}");
    }
    let sobol = |n| settings((SamplerKind::Sobol, n));
    let adaptive = Goal { adaptive: true, ..Goal::default() };
    let passes = Passes { goal: adaptive, ..Passes::default() };
    checkpoint(&sobol(64), &passes, &path);
    let error = refusal(&sobol(128), &path, passes);
    assert!(matches!(error, CheckpointError::OtherNumber { adaptive: true, .. }), "{error}");
    checkpoint(&sobol(16), &Passes::default(), &path);
    assert!(resumed(&sobol(4), &path, Passes::default()).is_ok());
    let error = refusal(&sobol(3), &path, Passes::default());
    assert!(matches!(error, CheckpointError::MoreSamples { found: 4, asked: 3, .. }), "{error}");
}

#[test]
fn a_goal_for_noise_can_be_raised() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    let target = Target::check(&path, &[]).unwrap();
    let settings = settings((SamplerKind::Uniform, 10_000));
    let until = |noise| Passes { goal: Goal { noise: Some(noise), ..Goal::default() }, ..Passes::default() };
    let without_end = &mut |_: Snapshot<'_>| ControlFlow::Continue(());
    let coarse = run(&settings, &until(0.05), without_end).unwrap();
    coarse.snapshot().unwrap().save(&target).unwrap();
    let again = resumed(&settings, &path, until(0.05)).unwrap();
    assert_eq!(again.stats.samples, 0, "it was good enough");
    let fine = resumed(&settings, &path, until(0.02)).unwrap();
    let at_once = run(&settings, &until(0.02), without_end).unwrap();
    assert!(coarse.mean_samples() < fine.mean_samples() && fine.mean_samples() < 10_000.0);
    assert_eq!(exr(&fine), exr(&at_once));
}

#[test]
fn checkpoints_of_other_renders_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.checkpoint");
    let settings = settings((SamplerKind::Sobol, 16));
    checkpoint(&settings, &Passes::default(), &path);
    let others = [
        (RenderSettings { seed: 7, ..settings }, "seed: 0"),
        (RenderSettings { size: [61, 40], ..settings }, "60"),
        (RenderSettings { samples: (SamplerKind::Uniform, 16), ..settings }, "Sobol"),
    ];
    for (other, told) in others {
        let error = refusal(&other, &path, Passes::default());
        assert!(matches!(error, CheckpointError::OtherRender { .. }), "{error}");
        assert!(error.to_string().contains(told), "{error}");
    }
    let file = folder.path().join("scene.txt");
    fs::write(&file, BALL).unwrap();
    let digest = SceneDigest::of_files(&[file]).unwrap();
    let error = refusal(&settings, &path, Passes { scene: digest, ..Passes::default() });
    assert!(error.to_string().contains("`scene 0000"), "{error}");
    let adaptive = Goal { adaptive: true, ..Goal::default() };
    let error = refusal(&settings, &path, Passes { goal: adaptive, ..Passes::default() });
    assert!(error.to_string().contains("adaptive None"), "{error}");
}

#[test]
fn damaged_checkpoints_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    let settings = settings((SamplerKind::Sobol, 16));
    checkpoint(&settings, &Passes::default(), &path("good"));
    let good = fs::read(path("good")).unwrap();
    let refused = |bytes: &[u8]| {
        fs::write(path("bad"), bytes).unwrap();
        refusal(&settings, &path("bad"), Passes::default())
    };
    for cut in [0, 7, 8, 11, 12, 20, 43, 44, good.len() / 2, good.len() - 1] {
        let error = refused(&good[..cut]);
        let expected =
            matches!(error, CheckpointError::Damaged { .. } | CheckpointError::NoCheckpoint { .. });
        assert!(expected, "{error}");
    }
    for i in (12..good.len()).step_by(997).chain(good.len() - 32..good.len()) {
        let mut bytes = good.clone();
        bytes[i] ^= 0x10;
        let error = refused(&bytes);
        assert!(matches!(error, CheckpointError::Damaged { .. }), "byte {i}: {error}");
    }
    assert!(matches!(refused(BALL.as_bytes()), CheckpointError::NoCheckpoint { .. }));
    let mut newer = good.clone();
    newer[8] = 9;
    assert!(matches!(refused(&newer), CheckpointError::Version { found: 9, .. }));
    let error = refusal(&settings, &path("nothing"), Passes::default());
    assert!(matches!(error, CheckpointError::Read { .. }), "{error}");
}

#[test]
fn patterns_of_a_fixed_number_are_not_adaptive() {
    let goal = Goal { adaptive: true, ..Goal::default() };
    for kind in [SamplerKind::Jittered, SamplerKind::Regular, SamplerKind::Poisson] {
        let passes = Passes { goal, ..Passes::default() };
        let refused = run(&settings((kind, 16)), &passes, &mut |_| ControlFlow::Continue(()));
        assert!(matches!(refused, Err(RenderError::NotAdaptive(_))));
    }
}

#[test]
fn a_snapshot_is_the_picture_so_far() {
    let settings = settings((SamplerKind::Uniform, 8));
    let mut seen = Vec::new();
    let picture = run(&settings, &Passes::default(), &mut |snapshot| {
        let light = snapshot.light().unwrap();
        assert!((light.pixel(0, 0)[2] - 0.3).abs() < 1e-6, "the background is there from the beginning");
        let views = [View::Color, View::Samples];
        seen.push((snapshot.samples(), snapshot.encode(&views, Format::Exr, BitDepth::Eight).unwrap()));
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(seen.iter().map(|(samples, _)| *samples).collect::<Vec<_>>(), [1, 2, 4, 8]);
    assert_eq!(seen[3].1, exr(&picture));
    assert!(picture.noise().is_none() && picture.snapshot().is_some());
}
