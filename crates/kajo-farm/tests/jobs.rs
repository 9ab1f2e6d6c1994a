//! Jobs with workers in this process: whatever becomes of them, the picture has the bytes of a plain render.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use kajo::{
    BitDepth, Defaults, Format, Goal, IntegratorName, LoadOptions, MemoryAssets, Passes, Position,
    RenderRequest, RenderSettings, RenderStats, Resources, SamplerKind, Scene, SceneDigest, Settings, Silent,
    SplitRender, View,
};
use kajo_farm::{
    FarmError, Job, Loss, Merged, Part, Plan, Published, Reply, Start, Task, Watch, Worker, coordinate,
};

const SCENE: &str = "
    PerspectiveCamera { center 0 1 7  direction 0 -0.1 -1  up 0 1 0  angle 35 }
    Background { color 0.2 0.3 0.5 }
    Materials { Matte grey { color 0.6 0.5 0.4 }  Glass pane { indexOfRefraction 1.5 }  Material bright { diffuseColor 0 0 0  emission 4 4 3 } }
    Group {
        MaterialIndex grey  Plane { normal 0 1 0  offset -1 }
        MaterialIndex pane  Sphere { center -0.8 0 0  radius 1 }
        MaterialIndex grey  Sphere { center 1.2 -0.2 0.5  radius 0.8 }
        MaterialIndex bright  Sphere { center 0 4 1  radius 0.5 }
    }";

const VIEWS: [View; 3] = [View::Color, View::Depth, View::Normals];

/// * `settings`: a block, or nothing
fn scene(settings: &str) -> Scene {
    let assets = MemoryAssets::new().with("s.txt", format!("{SCENE} {settings}"));
    let loaded = kajo::load_from("s.txt", &assets, &LoadOptions::default());
    assert!(loaded.scene.is_some(), "{}", loaded.report(false));
    loaded.scene.unwrap()
}

struct Setup {
    scene: Scene,
    settings: RenderSettings,
    goal: Goal,
}

impl Setup {
    fn new(integrator: &'static str, kind: SamplerKind, samples: u32, goal: Goal) -> Setup {
        let integrator = Some(IntegratorName(integrator));
        Setup::of(
            scene(""),
            Settings { integrator, samples: Some((kind, samples)), ..Settings::default() },
            goal,
        )
    }

    /// A render as a block of settings says.
    fn said(settings: &str, samples: u32) -> Setup {
        let samples = Some((SamplerKind::Sobol, samples));
        let scene = scene(&format!("Settings {{ {settings} }}"));
        Setup::of(scene, Settings { samples, ..Settings::default() }, Goal::default())
    }

    fn of(scene: Scene, asked: Settings, goal: Goal) -> Setup {
        let asked = Settings { size: Some([50, 38]), ..asked };
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        Setup { scene, settings, goal }
    }

    fn plain() -> Setup {
        Setup::new("path", SamplerKind::Sobol, 4, Goal::default())
    }

    /// Calls `act` with the split of the render, and the bytes of its file when it is rendered at once.
    fn run(&self, act: impl FnOnce(&SplitRender<'_>, &[u8])) {
        let outputs = VIEWS.map(|view| (view, Format::Exr));
        let resources = Resources { threads: 2, ..Resources::default() };
        let request = RenderRequest::new(&self.scene, &self.settings, &outputs).with(resources);
        let passes = Passes { goal: self.goal, ..Passes::default() };
        let picture = match self.goal == Goal::default() {
            true => kajo::render(&request, &Silent).unwrap(),
            false => {
                kajo::render_passes(&request, &passes, &Silent, &mut |_| std::ops::ControlFlow::Continue(()))
                    .unwrap()
            }
        };
        let expected = picture.encode(&VIEWS, Format::Exr, BitDepth::Eight).unwrap();
        act(&SplitRender::new(&request, &self.goal, SceneDigest::default()).unwrap(), &expected);
    }
}

fn job(folder: &Path, split: &SplitRender<'_>, tile: u32, samples: u32) -> Job {
    let plan = Plan::new(split, (Vec::new(), String::new()), Vec::new(), (tile, samples)).unwrap();
    Job::create(folder, &plan, split).unwrap()
}

fn bytes(split: &SplitRender<'_>, film: kajo::Film) -> Vec<u8> {
    split.picture(film, RenderStats::default()).encode(&VIEWS, Format::Exr, BitDepth::Eight).unwrap()
}

fn part(job: &Job, split: &SplitRender<'_>, stage: u32, unit: u64, position: &Position) -> Part {
    let work = job.layout(split, position).unwrap().work_unit(unit).unwrap();
    let (film, _) = split.render(position, &work, &Silent).unwrap();
    Part::new(job.hash(), (stage, unit), &film, "a test").unwrap()
}

/// What workers do besides their work.
type Mishap<'a> = &'a (dyn Fn(u64, u64) -> Option<Loss> + Sync);

/// Workers that are threads.
struct Threads<'a> {
    job: &'a Job,
    split: &'a SplitRender<'a>,
    /// Asked with the unit and the number of the call.
    mishap: Mishap<'a>,
    calls: AtomicU64,
}

struct Thread<'a>(&'a Threads<'a>);

impl<'a> Threads<'a> {
    fn new(job: &'a Job, split: &'a SplitRender<'a>, mishap: Mishap<'a>) -> Threads<'a> {
        Threads { job, split, mishap, calls: AtomicU64::new(0) }
    }
}

impl Start for Threads<'_> {
    fn start(&self, _: usize) -> Result<Box<dyn Worker + '_>, Loss> {
        Ok(Box::new(Thread(self)))
    }
}

impl Worker for Thread<'_> {
    fn render(&mut self, task: &Task) -> Result<Reply, Loss> {
        let all = self.0;
        let call = all.calls.fetch_add(1, Ordering::SeqCst);
        if let Some(loss) = (all.mishap)(task.unit, call) {
            return Err(loss);
        }
        let (stage, position) = all.job.stage(all.split).unwrap();
        let part = part(all.job, all.split, stage, task.unit, &position);
        Ok(Reply { bytes: part.bytes().to_vec(), samples: 1, rays: 1 })
    }

    fn end(&self) -> Box<dyn Fn() + Send + Sync> {
        Box::new(|| ())
    }
}

#[derive(Default)]
struct Notes {
    lines: Mutex<Vec<String>>,
    /// Cancels once so many units are done.
    patience: Option<u64>,
    done: AtomicUsize,
}

impl Watch for Notes {
    fn done(&self, units: u64, _: u64, _: u64, _: u64) {
        self.done.store(units as usize, Ordering::SeqCst);
    }

    fn note(&self, text: &str) {
        self.lines.lock().unwrap().push(text.to_owned());
    }

    fn cancelled(&self) -> bool {
        self.patience.is_some_and(|most| self.done.load(Ordering::SeqCst) as u64 >= most)
    }
}

/// Renders all stages.
fn render(
    job: &Job,
    split: &SplitRender<'_>,
    workers: usize,
    mishap: Mishap<'_>,
) -> Result<kajo::Film, FarmError> {
    loop {
        coordinate(job, split, workers, &Threads::new(job, split, mishap), &Notes::default())?;
        if let Merged::Complete(film) = job.merge(split)? {
            return Ok(*film);
        }
    }
}

/// Numbers that look random.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

#[test]
fn the_picture_has_the_bytes_of_a_plain_render() {
    let mut dice = Dice(7);
    let noisy = Goal { noise: Some(0.2), ..Goal::default() };
    let adaptive = Goal { adaptive: true, ..Goal::default() };
    for (setup, splits) in [
        (Setup::plain(), 20),
        (Setup::new("path", SamplerKind::Jittered, 4, Goal::default()), 3),
        (Setup::new("bidirectional", SamplerKind::Sobol, 3, Goal::default()), 3),
        (Setup::new("path", SamplerKind::Sobol, 4096, noisy), 1),
        (Setup::new("path", SamplerKind::Sobol, 24, adaptive), 2),
    ] {
        setup.run(|split, expected| {
            for i in 0..splits {
                let folder = tempfile::tempdir().unwrap();
                let many = setup.settings.samples.1 > 1000;
                let (tile, samples) =
                    (9 + dice.below(50) as u32, 1 + dice.below(if many { 64 } else { 4 }) as u32);
                let job = job(folder.path(), split, tile, samples);
                let workers = [1, 2, 7][i % 3];
                let film = render(&job, split, workers, &|_, _| None).unwrap();
                assert!(
                    bytes(split, film) == expected,
                    "{workers} workers, {tile} pixels, {samples} samples"
                );
            }
        });
    }
}

/// Workers make photons, vertices, records and chains anew, or take up what others have learned: all of them are the same.
#[test]
fn what_integrators_keep_for_many_samples_is_the_same_for_all_workers() {
    for (i, settings) in [
        "integrator sppm  photons 500",
        "integrator sppm  photons 500  spectral on",
        "integrator photon  photons 2000  photonMap direct",
        "integrator photon  photons 2000  photonMap gather",
        "integrator photon  photons 2000  photonMap caustics",
        "integrator vcm  photons 500",
        "integrator irradiance  rays 64",
        "integrator mlt",
        "integrator mmlt  bounces 2",
        "integrator path  guiding on  training 4",
        "integrator path  lightChoice learned",
        "integrator path  caustics manifold",
    ]
    .into_iter()
    .enumerate()
    {
        Setup::said(settings, 6).run(|split, expected| {
            for (tile, samples) in [(64, 1), (20, 4), (33, 3)] {
                let folder = tempfile::tempdir().unwrap();
                let job = job(folder.path(), split, tile, samples);
                let workers = [1, 2, 3][i % 3];
                let film = render(&job, split, workers, &|_, _| None)
                    .unwrap_or_else(|error| panic!("{settings}: {error}"));
                assert!(
                    bytes(split, film) == expected,
                    "{settings}: {workers} workers, {tile} pixels, {samples} samples"
                );
            }
        });
    }
}

#[test]
fn workers_that_are_lost_cost_nothing() {
    Setup::plain().run(|split, expected| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 16, 1);
        // Two of three are lost, or cannot do it the first time.
        let film = render(&job, split, 3, &|_, call| match call % 3 {
            0 => None,
            _ => Some(Loss::Worker("on purpose".to_owned())),
        });
        assert!(bytes(split, film.unwrap()) == expected);
    });
}

#[test]
fn a_unit_that_always_fails_does_not_keep_the_others() {
    Setup::plain().run(|split, expected| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 16, 2);
        let tries = Mutex::new(BTreeMap::<u64, usize>::new());
        let failing = |unit, _| {
            *tries.lock().unwrap().entry(unit).or_default() += 1;
            (unit == 5).then(|| Loss::Unit("on purpose\nat great length".to_owned()))
        };
        let Err(FarmError::Failed { units }) = render(&job, split, 2, &failing) else { panic!("it failed") };
        assert_eq!((units.len(), units[0].unit, &*units[0].message), (1, 5, "on purpose"));
        let (_, position) = job.stage(split).unwrap();
        let layout = job.layout(split, &position).unwrap();
        assert_eq!(
            job.finished(&layout).unwrap().len() as u64,
            layout.units() - 1,
            "all others are finished"
        );
        assert!(tries.lock().unwrap().iter().all(|(&unit, &n)| n == if unit == 5 { 3 } else { 1 }));
        let logs: Vec<_> = fs::read_dir(folder.path().join("logs")).unwrap().collect();
        assert_eq!(logs.len(), 3, "one for each try");
        let missing = job.merge(split).unwrap_err();
        assert!(matches!(&missing, FarmError::NotYet(text) if text.contains("1 of")), "{missing}");
        // Another run begins with three new tries, and does only what is missing.
        tries.lock().unwrap().clear();
        let film = render(&job, split, 2, &|unit, _| {
            *tries.lock().unwrap().entry(unit).or_default() += 1;
            None
        });
        assert!(bytes(split, film.unwrap()) == expected);
        assert_eq!(tries.into_inner().unwrap().into_iter().collect::<Vec<_>>(), [(5, 1)]);
    });
}

#[test]
fn what_is_finished_is_never_rendered_again() {
    Setup::plain().run(|split, expected| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 10, 1);
        let rendered = Mutex::new(Vec::new());
        let mut before = 0;
        for patience in [3, 17, 40, u64::MAX] {
            let note = |unit, _| {
                rendered.lock().unwrap().push(unit);
                None
            };
            let notes = Notes { patience: Some(patience), ..Notes::default() };
            let result = coordinate(&job, split, 2, &Threads::new(&job, split, &note), &notes);
            assert_eq!(matches!(result, Err(FarmError::Cancelled)), patience < u64::MAX);
            let now = rendered.lock().unwrap().len();
            assert!(now > before);
            before = now;
        }
        let mut units = rendered.into_inner().unwrap();
        let n = units.len();
        units.sort_unstable();
        units.dedup();
        assert_eq!(units.len(), n, "no unit twice");
        let Merged::Complete(film) = job.merge(split).unwrap() else { panic!("it is complete") };
        assert!(bytes(split, *film) == expected);
    });
}

#[test]
fn space_is_bounded_by_the_picture() {
    Setup::new("path", SamplerKind::Sobol, 40, Goal::default()).run(|split, expected| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 32, 1);
        let most = Mutex::new((0, 0));
        let count = |name: &str, ending: &str| {
            let entries = fs::read_dir(folder.path().join(name)).unwrap();
            entries.flatten().filter(|entry| entry.file_name().to_string_lossy().ends_with(ending)).count()
        };
        let film = render(&job, split, 2, &|_, _| {
            let mut most = most.lock().unwrap();
            *most = (most.0.max(count("parts", ".kpart")), most.1.max(count("sums", ".ksums")));
            None
        });
        assert!(bytes(split, film.unwrap()) == expected);
        let (parts, sums) = most.into_inner().unwrap();
        // Four tiles of forty units each.
        assert!(parts <= 4 * 4 + 2 && sums <= 4 + 2, "{parts} parts, {sums} sums");
    });
}

#[test]
fn damage_is_found_and_rendered_again() {
    Setup::plain().run(|split, expected| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 25, 1);
        let whole = part(&job, split, 0, 1, &Position::default());
        let mut dice = Dice(1);
        for _ in 0..300 {
            let mut bytes = whole.bytes().to_vec();
            let at = dice.below(bytes.len() as u64) as usize;
            bytes[at] ^= 1 << dice.below(8);
            assert!(Part::read(bytes, job.hash()).is_err(), "byte {at}");
            let cut = whole.bytes()[..dice.below(whole.bytes().len() as u64) as usize].to_vec();
            assert!(Part::read(cut, job.hash()).is_err());
        }
        assert_eq!(Part::read(whole.bytes().to_vec(), job.hash()).unwrap(), whole);
        assert!(Part::read(whole.bytes().to_vec(), &[0; 32]).is_err(), "another plan");
        render(&job, split, 2, &|_, _| None).unwrap();
        let files = |name: &str, ending: &str| -> Vec<PathBuf> {
            let entries = fs::read_dir(folder.path().join(name)).unwrap().flatten();
            entries
                .map(|entry| entry.path())
                .filter(|path| path.to_string_lossy().ends_with(ending))
                .collect()
        };
        let mut damaged = 0;
        for path in
            [files("parts", ".kpart"), files("sums", ".ksums")].iter().flat_map(|files| files.iter().take(1))
        {
            let mut bytes = fs::read(path).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            fs::write(path, bytes).unwrap();
            damaged += 1;
        }
        assert!(damaged > 0);
        assert!(matches!(job.merge(split), Err(FarmError::NotYet(_))), "what was damaged is missing");
        assert_eq!(files("damaged", "").len(), damaged);
        let film = render(&job, split, 2, &|_, _| None).unwrap();
        assert!(bytes(split, film) == expected);
    });
}

#[test]
fn a_second_result_must_be_equal() {
    Setup::plain().run(|split, _| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 25, 1);
        let position = Position::default();
        let layout = job.layout(split, &position).unwrap();
        let first = part(&job, split, 0, 0, &position);
        assert_eq!(job.publish(&first, &layout, split).unwrap(), Published::First);
        assert_eq!(job.publish(&first, &layout, split).unwrap(), Published::Again);
        // Another unit's sums under the first one's number: what bad memory would bring.
        let unit = layout.work_unit(1).unwrap();
        let (film, _) = split.render(&position, &unit, &Silent).unwrap();
        let wrong = Part::new(job.hash(), (0, 0), &film, "a machine with bad memory").unwrap();
        let refused = |job: &Job| {
            let error = job.publish(&wrong, &layout, split).unwrap_err().to_string();
            assert!(error.contains("unit 0") && error.contains("a machine with bad memory"), "{error}");
        };
        refused(&job);
        // The same once the part itself was put together with others.
        job.fold(0, &layout, split).unwrap();
        assert_eq!(fs::read_dir(folder.path().join("parts")).unwrap().count(), 0);
        refused(&job);
        assert_eq!(job.publish(&first, &layout, split).unwrap(), Published::Again);
    });
}

#[test]
fn a_folder_belongs_to_one_render_and_one_coordinator() {
    let folder = tempfile::tempdir().unwrap();
    Setup::plain().run(|split, _| {
        let first = job(folder.path(), split, 25, 1);
        let again = job(folder.path(), split, 7, 3);
        assert_eq!(again.plan().tile, 25, "the plan stays what it was");
        let lock = first.lock().unwrap();
        let refused = again.lock().unwrap_err().to_string();
        assert!(refused.contains("process"), "{refused}");
        drop(lock);
        assert!(again.lock().is_ok());
    });
    Setup::new("path", SamplerKind::Sobol, 5, Goal::default()).run(|split, _| {
        let plan = Plan::new(split, (Vec::new(), String::new()), Vec::new(), (25, 1)).unwrap();
        let refused = Job::create(folder.path(), &plan, split).unwrap_err().to_string();
        assert!(refused.contains("`samples 4` where this one has `samples 5`"), "{refused}");
        let text = serde_json::to_string(&plan).unwrap();
        let other = Plan::read(&text.replace("epoch 1", "epoch 2")).unwrap();
        let refused = other.check(split).unwrap_err().to_string();
        assert!(refused.contains("epoch 2") && refused.contains("epoch 1"), "{refused}");
    });
    assert!(Job::open(&folder.path().join("nothing")).unwrap_err().to_string().contains("kajo plan"));
}

#[test]
fn workers_that_lie_are_not_believed() {
    struct Liars(AtomicUsize, Vec<u8>);
    struct Liar<'a>(&'a Liars);
    impl Start for Liars {
        fn start(&self, _: usize) -> Result<Box<dyn Worker + '_>, Loss> {
            Ok(Box::new(Liar(self)))
        }
    }
    impl Worker for Liar<'_> {
        fn render(&mut self, _: &Task) -> Result<Reply, Loss> {
            self.0.0.fetch_add(1, Ordering::SeqCst);
            Ok(Reply { bytes: self.0.1.clone(), ..Reply::default() })
        }
        fn end(&self) -> Box<dyn Fn() + Send + Sync> {
            Box::new(|| ())
        }
    }
    Setup::plain().run(|split, _| {
        let folder = tempfile::tempdir().unwrap();
        let job = job(folder.path(), split, 100, 4);
        let liars = Liars(AtomicUsize::new(0), b"nothing of the kind".to_vec());
        let result = coordinate(&job, split, 1, &liars, &Notes::default());
        assert!(matches!(result, Err(FarmError::Failed { .. })), "it is given up in the end");
        assert!(liars.0.load(Ordering::SeqCst) > 3);
    });
}
