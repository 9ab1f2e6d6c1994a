use std::sync::atomic::{AtomicUsize, Ordering};

use kajo_core::settings::Settings;

use super::*;
use crate::{
    BitDepth, Defaults, Format, LoadOptions, MemoryAssets, RenderRequest, Silent, load_from, render,
};

fn scene(radius: f32) -> Arc<Scene> {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
         Lights {{ DirectionalLight {{ direction -1 -1 -1 color 1 1 1 }} }}
         Materials {{ Material {{ diffuseColor 1 0.5 0 reflectiveColor 0.5 0.5 0.5 }} }}
         Group {{ MaterialIndex 0  Sphere {{ center 0 0 0  radius {radius} }}  Plane {{ normal 0 1 0 offset -1 }} }}"
    );
    let assets = MemoryAssets::new().with("a.txt", text);
    let loaded = load_from("a.txt", &assets, &LoadOptions::default());
    assert!(loaded.scene.is_some(), "{}", loaded.report(false));
    Arc::new(loaded.scene.unwrap())
}

fn settings(scene: &Scene, size: [u32; 2], samples: (SamplerKind, u32)) -> RenderSettings {
    let asked = Settings { size: Some(size), samples: Some(samples), ..Settings::default() };
    RenderSettings::resolve(scene, &asked, Defaults::Modern, false).unwrap()
}

const ALL: [(View, Format); 5] = [
    (View::Color, Format::Png),
    (View::Depth, Format::Png),
    (View::Normals, Format::Png),
    (View::Object, Format::Png),
    (View::Color, Format::Exr),
];

#[test]
fn the_thread_of_a_session_is_prepared_before_it_renders() {
    let scene = scene(1.0);
    let settings = settings(&scene, [8, 8], (SamplerKind::Regular, 1));
    let notes = Arc::new(std::sync::Mutex::new(Vec::new()));
    let note = |what| {
        let notes = Arc::clone(&notes);
        move || notes.lock().unwrap().push((what, thread::current().id()))
    };
    let session = Session::prepared(1, note("wake"), note("prepare"));
    session.start(Job::new(scene, settings));
    session.wait();
    let notes = notes.lock().unwrap().clone();
    assert_eq!(notes[0].0, "prepare");
    assert!(notes.len() > 1 && notes[1..].iter().all(|(what, by)| *what == "wake" && *by == notes[0].1));
}

#[test]
fn a_finished_frame_writes_the_files_of_a_render() {
    let scene = scene(1.0);
    for samples in [(SamplerKind::Jittered, 9), (SamplerKind::Sobol, 16)] {
        let settings = settings(&scene, [70, 50], samples);
        let picture = render(&RenderRequest::new(&scene, &settings, &ALL), &Silent).unwrap();
        let session = Session::new(2, || {});
        session.start(Job::new(Arc::clone(&scene), settings));
        assert!(matches!(session.wait(), Status::Finished));
        let frame = session.frame().unwrap();
        assert_eq!((frame.size(), frame.full_size(), frame.samples()), ([70, 50], [70, 50], samples.1));
        for (view, format) in ALL {
            let expected = picture.encode(&[view], format, BitDepth::Eight).unwrap();
            let found = frame.encode(&[view], format, BitDepth::Eight, &settings.development).unwrap();
            assert!(found == expected, "{view:?} as {format}");
        }
        assert_eq!(frame.light().data(), picture.light().unwrap().data());
    }
}

#[test]
fn what_a_window_shows_is_what_a_png_holds() {
    let scene = scene(1.0);
    let settings = settings(&scene, [33, 21], (SamplerKind::Sobol, 4));
    let session = Session::new(1, || {});
    session.start(Job::new(scene, settings));
    session.wait();
    let frame = session.frame().unwrap();
    for view in [View::Color, View::Depth, View::Normals, View::Uv, View::Object, View::Samples] {
        let file = frame.encode(&[view], Format::Png, BitDepth::Eight, &settings.development).unwrap();
        let image = kajo_image::decode(&file, Some(Format::Png), &kajo_image::DecodeLimits::default());
        let image = image.unwrap().image;
        let shown = frame.rgba(view, &settings.development).unwrap();
        for (shown, pixel) in shown.chunks_exact(4).zip(image.pixels()) {
            let stored = |c: usize| (pixel[c.min(pixel.len() - 1)] * 255.0).round() as u8;
            assert_eq!(shown, [stored(0), stored(1), stored(2), 255], "{view:?}");
        }
    }
    let views = frame.views();
    assert!(views.contains(&View::Color) && views.contains(&View::Uv) && !views.contains(&View::Albedo));
    let all = frame.encode(&views, Format::Exr, BitDepth::Eight, &settings.development).unwrap();
    let light = frame.encode(&[View::Color], Format::Exr, BitDepth::Eight, &settings.development).unwrap();
    assert!(all.len() > light.len());
    for view in [View::Color, View::Depth, View::Normals, View::Uv, View::Object, View::Variance] {
        let numbers = frame.numbers(view).unwrap();
        for (x, y) in [(0, 0), (16, 10), (32, 20), (20, 14)] {
            let value = frame.value(view, x, y).unwrap();
            for (c, expected) in numbers.pixel(x, y).iter().enumerate() {
                assert_eq!(value[c].to_bits(), expected.to_bits(), "{view:?} at {x}, {y}");
            }
        }
        assert_eq!(frame.value(view, 33, 0), None);
    }
}

#[test]
fn the_last_of_many_jobs_is_shown() {
    let frames = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&frames);
    let session = Session::new(2, move || {
        counter.fetch_add(1, Ordering::Relaxed);
    });
    let scenes: Vec<_> = (1..=4).map(|i| scene(0.3 * i as f32)).collect();
    let mut last = 0;
    for i in 0..100 {
        let scene = &scenes[i % 4];
        last = session.start(Job::new(Arc::clone(scene), settings(scene, [64, 64], (SamplerKind::Sobol, 4))));
        if i % 10 == 0 {
            thread::sleep(std::time::Duration::from_millis(3));
        }
    }
    assert!(matches!(session.wait(), Status::Finished));
    let frame = session.frame().unwrap();
    assert_eq!(frame.job(), last);
    let settings = settings(&scenes[3], [64, 64], (SamplerKind::Sobol, 4));
    let expected = render(&RenderRequest::new(&scenes[3], &settings, &ALL), &Silent).unwrap();
    assert_eq!(frame.light().data(), expected.light().unwrap().data());
    assert!(frames.load(Ordering::Relaxed) > 0);
}

#[test]
fn a_job_without_end_is_coarse_first_and_ends_when_cancelled() {
    let scene = scene(1.0);
    let (sender, wakes) = std::sync::mpsc::channel();
    let session = Session::new(1, move || {
        let _ = sender.send(());
    });
    assert!(matches!(session.status(), Status::Idle) && session.frame().is_none());
    let mut job = Job::new(Arc::clone(&scene), settings(&scene, [800, 600], (SamplerKind::Jittered, 4)));
    job.coarse_views = vec![View::Normals];
    session.start(job.without_end());
    wakes.recv().unwrap();
    let first = session.frame().unwrap();
    assert_eq!((first.samples(), first.full_size()), (0, [800, 600]));
    assert!(first.size()[0] <= 400, "{:?}", first.size());
    assert_eq!(first.views(), [View::Color, View::Normals], "what it was asked for and no more");
    assert!(first.rgba(View::Normals, &first.settings().development).is_ok());
    loop {
        wakes.recv().unwrap();
        if session.frame().unwrap().samples() >= 2 {
            break;
        }
    }
    assert!(session.is_running());
    session.cancel();
    assert!(matches!(session.wait(), Status::Cancelled));
    let last = session.frame().unwrap();
    assert_eq!(last.size(), [800, 600]);
    assert!([View::Depth, View::Object, View::Variance].into_iter().all(|view| last.has(view)));
}

#[test]
fn another_camera_sees_what_it_would_as_the_scenes_own() {
    let here = scene(1.0);
    let mut pose = CameraPose::of(&here);
    pose.fly(kajo_math::DVec3::new(0.25, 0.5, 1.0));
    let settings = settings(&here, [40, 30], (SamplerKind::Sobol, 4));
    let session = Session::new(1, || {});
    session.start(Job::new(here, settings).through(pose));
    session.wait();
    let text = "PerspectiveCamera { center 0.25 0.5 8 direction 0 0 -1 up 0 1 0 angle 30 }
         Lights { DirectionalLight { direction -1 -1 -1 color 1 1 1 } }
         Materials { Material { diffuseColor 1 0.5 0 reflectiveColor 0.5 0.5 0.5 } }
         Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 }  Plane { normal 0 1 0 offset -1 } }";
    let assets = MemoryAssets::new().with("a.txt", text);
    let there = load_from("a.txt", &assets, &LoadOptions::default()).scene.unwrap();
    let expected = render(&RenderRequest::new(&there, &settings, &ALL), &Silent).unwrap();
    assert_eq!(session.frame().unwrap().light().data(), expected.light().unwrap().data());
}

#[test]
fn what_cannot_be_rendered_is_said() {
    let scene = scene(1.0);
    let session = Session::new(1, || {});
    session.start(Job::new(Arc::clone(&scene), settings(&scene, [u32::MAX; 2], (SamplerKind::Sobol, 4))));
    let Status::Failed(error) = session.wait() else { panic!("rendered anyway") };
    assert!(matches!(*error, RenderError::Memory { .. }), "{error}");
    session.start(Job::new(Arc::clone(&scene), settings(&scene, [8, 8], (SamplerKind::Sobol, 4))));
    assert!(matches!(session.wait(), Status::Finished));
}

/// A room that is lit by a cache of irradiance.
fn cached_room(rays: u32) -> Arc<Scene> {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 1.9 direction 0 -0.2 -1 up 0 1 0 angle 60 }}
         Lights {{ PointLight {{ position 0 1.5 0  intensity 4 4 4 }} }}
         Materials {{ Matte {{ color 0.6 0.5 0.4 }} }}
         Group {{ MaterialIndex 0 Box {{ min -2 -2 -2 max 2 2 2 }} }}
         Settings {{ integrator irradiance  rays {rays}  bounces 2 }}"
    );
    let loaded = load_from("a.txt", &MemoryAssets::new().with("a.txt", text), &LoadOptions::default());
    Arc::new(loaded.scene.unwrap())
}

/// Where only the camera moved, a job starts from the records of the one before, if it is asked to; a job of another scene does not.
#[test]
fn records_are_kept_while_only_the_camera_moves() {
    let (room, other) = (cached_room(64), cached_room(64));
    let settings = settings(&room, [24, 24], (SamplerKind::Sobol, 1));
    let mut moved = CameraPose::of(&room);
    moved.orbit(Default::default(), 0.1, 0.0);
    let session = Session::new(1, || {});
    let rays = |scene: &Arc<Scene>, keeps_state: bool, camera: Option<&CameraPose>| {
        let job = Job { keeps_state, ..Job::new(Arc::clone(scene), settings) };
        session.start(camera.into_iter().fold(job, |job, camera| job.through(camera.clone())));
        assert!(matches!(session.wait(), Status::Finished));
        let frame = session.frame().unwrap();
        (frame.stats().rays.total(), frame.light().data().to_vec())
    };
    let fresh = rays(&room, true, None);
    assert_eq!(rays(&room, true, None), fresh, "what nobody moved begins anew");
    let alone = rays(&room, false, Some(&moved));
    let back = rays(&room, true, None);
    assert!(3 * back.0 < fresh.0, "{} of {}", back.0, fresh.0);
    let kept = rays(&room, true, Some(&moved));
    assert!(3 * kept.0 < alone.0, "{} of {}", kept.0, alone.0);
    assert_eq!(rays(&room, false, Some(&moved)), alone);
    assert_eq!(rays(&other, true, Some(&moved)), alone);
}

/// Coarse pictures hand their records on, so that something is seen long before the cache of the whole picture is made; that is the one of
/// any other program.
#[test]
fn a_picture_of_a_cache_is_coarse_first() {
    let room = cached_room(4096);
    let settings = settings(&room, [64, 48], (SamplerKind::Sobol, 1));
    let (sender, wakes) = std::sync::mpsc::channel();
    let session = Session::new(1, move || {
        let _ = sender.send(());
    });
    session.start(Job { keeps_state: true, ..Job::new(Arc::clone(&room), settings) });
    wakes.recv().unwrap();
    let first = session.frame().unwrap();
    assert!(first.size()[0] < 64 && first.samples() == 0, "{:?}", first.size());
    assert!(matches!(session.wait(), Status::Finished));
    let alone =
        render(&RenderRequest::new(&room, &settings, &[(View::Color, Format::Exr)]), &Silent).unwrap();
    assert_eq!(session.frame().unwrap().light().data(), alone.light().unwrap().data());
}
