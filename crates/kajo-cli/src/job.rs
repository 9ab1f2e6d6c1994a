//! One render from the scene's file to the pictures' files, whichever command asked for it.

use std::path::{Path, PathBuf};
use std::thread;

use kajo::output::Target;
use kajo::{
    BitDepth, ClampedLight, DENOISE_OUTPUTS, Defaults, Dialect, EncodeOptions, Format, Highlight, ImageError,
    IntegratorSettings, LARGEST_R_HAT, LoadOptions, Loaded, Passes, Picture, Rect, Reduction, RenderError,
    RenderSettings, RenderStats, Resources, SamplerKind, Scene, SceneDigest, Settings, Severity, Snapshot,
    View, diagrams,
};

use kajo_farm::Bundle;

use crate::args::{DevelopArgs, FarmArgs, PassArgs};
use crate::console;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
use crate::keep::{self, Encoded, Keeper};
use crate::output::{Destination, Output};
use crate::passes::Watcher;
use crate::progress::Meter;

/// What to render, how, and where to put it.
#[derive(Debug)]
pub struct Job {
    pub scene: PathBuf,
    pub load: LoadOptions,
    pub defaults: Defaults,
    /// What the command line says about the picture.
    pub asked: Settings,
    /// The part of the picture that is wanted.
    pub crop: Option<Rect>,
    /// What the classic command line says besides.
    pub classic: Option<ClassicWords>,
    pub outputs: Vec<Output>,
    /// Pictures of how the picture is put together.
    pub diagrams: Vec<Diagram>,
    /// Bits a channel in PNG files.
    pub depth: BitDepth,
    pub resources: Resources,
    /// Write what there is when interrupted.
    pub keep_partial: bool,
    /// What a render in several passes is wanted for, if it is.
    pub passes: PassArgs,
    /// Who renders it, if it is not this process alone.
    pub farm: FarmArgs,
    /// What happens to the picture afterwards.
    pub develop: DevelopArgs,
    /// Files that must not be overwritten, besides those that the scene is read from.
    pub kept: Vec<PathBuf>,
    /// The only folder that files may be written to, by its real path, if there is such a bound.
    pub confined_to: Option<PathBuf>,
}

/// Classic options whose meaning depends on the scene's dialect, or that no `Settings` block has.
#[derive(Clone, Copy, Debug)]
pub struct ClassicWords {
    pub uv: bool,
    pub specular_fix: bool,
    /// The samples were asked for by `-uniform_samples`.
    pub uniform_samples: bool,
    /// Nine rays for a pixel, each anywhere in its ninth.
    pub jitter: bool,
    /// Nine rays for a pixel, weighed by 1 2 1 across and down.
    pub filter: bool,
}

/// A picture of how the picture is put together.
#[derive(Debug)]
pub struct Diagram {
    pub kind: DiagramKind,
    /// Columns and rows for a pixel.
    pub zoom: u32,
    pub path: PathBuf,
    pub format: Format,
}

/// What a diagram shows.
#[derive(Clone, Copy, Debug)]
pub enum DiagramKind {
    /// Where samples lie.
    Samples,
    /// The weights of the filter.
    Filter,
}

impl Diagram {
    fn encode(&self, settings: &RenderSettings) -> Result<Vec<u8>, ImageError> {
        let image = match self.kind {
            DiagramKind::Samples => diagrams::sample_positions(settings, self.zoom),
            DiagramKind::Filter => diagrams::filter_shape(settings, self.zoom),
        };
        kajo::encode(&image?, self.format, &EncodeOptions::default())
    }
}

/// Receives the diagnostics of a scene, before its render starts.
pub struct Voice<'a> {
    /// Whether the text may hold the colour codes of terminals.
    pub color: bool,
    /// Whether only warnings and errors are wanted.
    pub quiet: bool,
    /// Takes lines of text that is fit for a terminal.
    pub say: &'a mut dyn FnMut(&str),
}

impl Voice<'_> {
    fn warn(&mut self, text: impl std::fmt::Display) {
        self.label("warning", text);
    }

    fn note(&mut self, text: impl std::fmt::Display) {
        if !self.quiet {
            self.label("note", text);
        }
    }

    fn label(&mut self, label: &str, text: impl std::fmt::Display) {
        (self.say)(&format!("{label}: {}\n", console::printable(&text.to_string())));
    }
}

/// What a job did.
#[derive(Debug)]
pub struct Done {
    pub size: [u32; 2],
    /// Of a pixel, on average.
    pub samples: f64,
    /// Estimated relative error, where it is known.
    pub noise: Option<f64>,
    /// How far groups of Markov chains are from agreeing, where there are any.
    pub r_hat: Option<f64>,
    pub stats: RenderStats,
}

/// Files to be written, found to be writable.
struct Targets {
    /// For each output that is no standard output.
    outputs: Vec<Target>,
    /// For each diagram.
    diagrams: Vec<Target>,
    checkpoint: Option<Target>,
}

impl Job {
    /// Does it all.
    ///
    /// # Errors
    /// [`Failure`]; then no file is written that was not finished before.
    pub fn run(&self, meter: &Meter, interrupt: &Interrupt, voice: &mut Voice<'_>) -> Result<Done, Failure> {
        let memory = self.resources.memory;
        let mut loaded = self.load_scene(meter, None)?;
        if !loaded.diagnostics.is_empty() {
            (voice.say)(&loaded.report(voice.color));
        }
        let scene = match loaded.scene.take() {
            Some(scene) => scene,
            None => return Err(has_errors(&self.scene, &loaded)),
        };
        // What the scene takes is not there for the film.
        let memory = memory.map(|bytes| bytes.saturating_sub(loaded.memory.used()));
        let resources = Resources { memory, ..self.resources };
        let settings = self.settings(&scene, voice)?;
        self.check_formats(settings.size)?;
        let targets = self.targets(&loaded.files)?;
        let mut passes = match self.passes.are_wanted() {
            true => Some(self.prepare_passes(&loaded, &targets, interrupt)?),
            false => None,
        };
        for (diagram, target) in self.diagrams.iter().zip(&targets.diagrams) {
            let bytes = diagram.encode(&settings).map_err(|error| Failure::Input(error.to_string()))?;
            target.write(&bytes)?;
        }
        let outputs = self.recorded();
        let (result, interrupted) = interrupt.during(Work::Render, || {
            let progress = meter.watched(interrupt);
            let result = match &mut passes {
                None => kajo::render(
                    &kajo::RenderRequest::new(&scene, &settings, &outputs).with(resources),
                    &progress,
                ),
                Some((passes, watcher)) => {
                    let look = &mut |snapshot: Snapshot<'_>| watcher.look(snapshot);
                    kajo::render_passes(
                        &kajo::RenderRequest::new(&scene, &settings, &outputs).with(resources),
                        passes,
                        &progress,
                        look,
                    )
                }
            };
            meter.finish();
            result
        });
        let done = self.finish(result, interrupted, &targets, interrupt, voice)?;
        let problems = loaded.tiles.map(|tiles| tiles.take_problems()).unwrap_or_default();
        match &problems[..] {
            [] => Ok(done),
            problems => {
                let all = problems.join("; ");
                Err(Failure::Input(format!("{all}; what is missing is shown in the mean colour")))
            }
        }
    }

    /// Reads the scene, or takes it from a bundle.
    ///
    /// # Errors
    /// When the scene's file is a bundle that is damaged. What is wrong with a scene is in [`Loaded`].
    pub fn load_scene(&self, meter: &Meter, bundle: Option<&Bundle>) -> Result<Loaded, Failure> {
        let load =
            LoadOptions { progress: meter.loading(), memory: self.resources.memory, ..self.load.clone() };
        let (read, files);
        let bundle = match bundle {
            // Of a scene whose own files are elsewhere.
            Some(bundle) => {
                files = Vec::new();
                bundle
            }
            None if Bundle::is_one(&self.scene) => {
                let bytes = std::fs::read(&self.scene).map_err(|error| {
                    Failure::Input(format!("cannot read `{}`: {error}", self.scene.display()))
                })?;
                read = Bundle::read(&bytes)?;
                files = vec![std::fs::canonicalize(&self.scene).unwrap_or_else(|_| self.scene.clone())];
                &read
            }
            None => return Ok(kajo::load(&self.scene, &load)),
        };
        let loaded = kajo::load_from(bundle.scene(), bundle, &load);
        Ok(Loaded { files, digest: Some(bundle.digest()), ..loaded })
    }

    /// What the film is asked to hold.
    pub fn recorded(&self) -> Vec<(View, Format)> {
        self.outputs
            .iter()
            .flat_map(|output| output.views.iter().map(|&view| (view, output.format)))
            .chain(self.develop.denoise.iter().flat_map(|_| DENOISE_OUTPUTS))
            .collect()
    }

    /// What the scene was read from, as one number.
    ///
    /// # Errors
    /// When a file cannot be read again.
    pub fn scene_digest(loaded: &Loaded) -> Result<SceneDigest, Failure> {
        let files = match loaded.digest {
            Some(digest) => digest,
            None => SceneDigest::of_files(&loaded.files)
                .map_err(|error| Failure::Input(format!("cannot read the scene again: {error}")))?,
        };
        // The text around a model, of which `--up` and `--ground` decide.
        let digest = loaded.sources().iter().next().map_or(files, |(_, text)| files.with_text(text.text()));
        // The moments of the frame, where there are any.
        let clock = loaded.desc.clock();
        Ok(if clock.is_film() { digest.with_text(&format!("{clock:?}")) } else { digest })
    }

    /// Makes sure that a picture of this size can be written.
    ///
    /// * `inputs`: files that must not be overwritten
    ///
    /// # Errors
    /// [`Failure`]
    pub fn check_outputs(&self, size: [u32; 2], inputs: &[PathBuf]) -> Result<(), Failure> {
        self.check_formats(size)?;
        self.targets(inputs).map(|_| ())
    }

    /// Writes the files of a picture that came from elsewhere.
    ///
    /// * `inputs`: files that must not be overwritten
    ///
    /// # Errors
    /// [`Failure`]
    pub fn write(
        &self,
        picture: Picture,
        inputs: &[PathBuf],
        interrupt: &Interrupt,
        voice: &mut Voice<'_>,
    ) -> Result<Done, Failure> {
        self.check_formats(picture.size())?;
        let targets = self.targets(inputs)?;
        self.finish(Ok(picture), false, &targets, interrupt, voice)
    }

    /// Saves and writes what came of a render.
    ///
    /// * `interrupted`: whether a signal came meanwhile
    fn finish(
        &self,
        result: Result<Picture, RenderError>,
        interrupted: bool,
        targets: &Targets,
        interrupt: &Interrupt,
        voice: &mut Voice<'_>,
    ) -> Result<Done, Failure> {
        let (mut picture, bug) = match result {
            Ok(picture) => (picture, Ok(())),
            Err(RenderError::Cancelled(partial)) => (*partial, Ok(())),
            Err(RenderError::Panicked { message, picture: Some(partial) }) => {
                (*partial, Err(Failure::Bug(format!("{message}; the picture is what the other tiles show"))))
            }
            // Reading a long checkpoint was broken off.
            Err(RenderError::Checkpoint(_)) if interrupted => return Err(interrupt.failure()),
            Err(error) => return Err(error.into()),
        };
        picture.development = self.develop.development(picture.development);
        picture.quick = interrupted;
        // Before anything else can go wrong; a picture that cannot be continued is still worth writing.
        let ((saved, encoded), interrupted_meanwhile) =
            interrupt.during(Work::Write, || self.save(&picture, targets, interrupt));
        let interrupted = interrupted || interrupted_meanwhile;
        let stopped = || interrupt.failure();
        let keeps_partial = self.keep_partial || targets.checkpoint.is_some();
        if interrupted && !keeps_partial {
            bug?;
            return Err(stopped());
        }
        warn_of_numbers(&picture.stats, voice);
        warn_of_chains(picture.r_hat(), voice);
        if let Some(clamped) = picture.clamped() {
            voice.note(what_was_clamped(&clamped));
        }
        let mut interrupted = interrupted;
        interrupted |= self.denoise(&mut picture, keeps_partial, interrupt, voice);
        let overexposed = picture.overexposed();
        if overexposed > 0 {
            voice.warn(format!(
                "the exposure makes {overexposed} values larger than any number; they become the largest"
            ));
        }
        let keeper = Keeper { interrupt, stoppable: !keeps_partial, depth: self.depth, scene: &self.scene };
        let written = keeper.pictures(&picture, &self.outputs, &targets.outputs, encoded);
        Failure::all([bug, written, saved])?;
        if interrupted {
            return Err(stopped());
        }
        Ok(Done {
            size: picture.size(),
            samples: picture.mean_samples(),
            noise: picture.noise(),
            r_hat: picture.r_hat(),
            stats: picture.stats,
        })
    }

    /// Removes the noise of a picture where that is asked for; whether a signal came meanwhile.
    fn denoise(
        &self,
        picture: &mut Picture,
        keeps_partial: bool,
        interrupt: &Interrupt,
        voice: &mut Voice<'_>,
    ) -> bool {
        let Some(denoiser) = &self.develop.denoise else { return false };
        let mut denoise = || picture.denoise(denoiser);
        let (denoised, interrupted_meanwhile) = match keeps_partial {
            true => interrupt.during(Work::Write, denoise),
            false => (denoise(), false),
        };
        match denoised {
            Ok(_) if voice.quiet => {}
            Ok(how) => (voice.say)(&format!("denoised {how}\n")),
            // The noisy picture took long enough to be kept.
            Err(error) => voice.warn(format!("the picture is not denoised: {error}")),
        }
        interrupted_meanwhile
    }

    /// What a render in passes goes by, and who looks at it after each.
    fn prepare_passes<'a>(
        &self,
        loaded: &Loaded,
        targets: &'a Targets,
        interrupt: &'a Interrupt,
    ) -> Result<(Passes, Watcher<'a>), Failure> {
        let scene = Job::scene_digest(loaded)?;
        let PassArgs { resume, checkpoint, overwrite_checkpoint, .. } = self.passes.clone();
        let checkpoint = checkpoint.filter(|_| !overwrite_checkpoint);
        let passes = Passes { goal: self.passes.goal(), resume, checkpoint, scene };
        Ok((passes, Watcher::new(&self.passes, &self.scene, targets.checkpoint.as_ref(), interrupt)))
    }

    /// Saves the state of a render that is over, however it ended, if that is wanted. Meanwhile another thread makes the first
    /// picture into the bytes of its file, unless it is to be denoised: who interrupts a render does not like to wait.
    fn save(
        &self,
        picture: &Picture,
        targets: &Targets,
        interrupt: &Interrupt,
    ) -> (Result<(), Failure>, Option<Encoded>) {
        let (Some(target), Some(state)) = (&targets.checkpoint, picture.snapshot()) else {
            return (Ok(()), None);
        };
        let first = self.outputs.first().filter(|_| self.develop.denoise.is_none());
        thread::scope(|scope| {
            let encoding = first.and_then(|output| {
                let encode = || picture.encode(&output.views, output.format, self.depth);
                thread::Builder::new().spawn_scoped(scope, encode).ok()
            });
            let saved = keep::checkpoint(&state, target, interrupt);
            (saved, encoding.and_then(|encoding| encoding.join().ok()))
        })
    }

    /// How the scene is rendered, all defaults filled in.
    ///
    /// # Errors
    /// When what was asked for does not go together.
    pub fn settings(&self, scene: &Scene, voice: &mut Voice<'_>) -> Result<RenderSettings, Failure> {
        let uv = self.classic.is_some_and(|words| words.uv);
        let mut settings = RenderSettings::resolve(scene, &self.asked, self.defaults, uv)?;
        if let Some(part) = self.crop {
            settings = settings.cropped(part)?;
        }
        if let Some(why) = settings.why {
            voice.note(format!("integrator auto takes `{}`: {why}", settings.integrator.name));
        }
        let left_out = settings.left_out(scene).into_iter().map(str::to_owned);
        for note in left_out.chain(settings.without_effect(&self.asked, &scene.output.settings)) {
            voice.warn(note);
        }
        if settings.integrator.splats && self.passes.adaptive {
            let plan = match self.passes.noise {
                Some(_) => "; leave out `--adaptive` to reach that `--noise`",
                None => "",
            };
            voice.warn(format!(
                "adaptive sampling goes by what paths from the camera find, and not by light from emitters{plan}"
            ));
        }
        let Some(words) = self.classic else { return Ok(settings) };
        let is_2004 = scene.output.rules.dialect == Dialect::Mit2004;
        if words.uniform_samples && is_2004 {
            settings.samples.0 = SamplerKind::Regular;
        }
        if words.jitter || words.filter {
            let reduction = if words.filter { Reduction::Binomial } else { Reduction::Mean };
            settings = settings.reduced(reduction, words.jitter);
        }
        match (words.specular_fix, is_2004) {
            (true, true) => {
                if let IntegratorSettings::Classic(classic) = &mut settings.integrator_settings {
                    classic.highlight = Highlight::HalfTimesCosine;
                }
            }
            (true, false) => voice.warn("`-specular_fix` works in dialect mit-2004 only"),
            (false, _) => {}
        }
        Ok(settings)
    }

    /// Makes sure that the formats can hold pictures of this size.
    fn check_formats(&self, size: [u32; 2]) -> Result<(), Failure> {
        let holds = |format| format != Format::Tga || size.iter().all(|&side| side <= u16::MAX.into());
        match self.outputs.iter().all(|output| holds(output.format)) {
            true => Ok(()),
            false => Err(Failure::Input(
                "a .tga file holds at most 65535 x 65535 pixels; take another format".to_owned(),
            )),
        }
    }

    /// Makes sure that every file can be written.
    fn targets(&self, inputs: &[PathBuf]) -> Result<Targets, Failure> {
        let files = self.outputs.iter().filter_map(|output| match &output.destination {
            Destination::File(path) => Some(path.clone()),
            Destination::StandardOutput => None,
        });
        let diagrams = self.diagrams.iter().map(|diagram| diagram.path.clone());
        let files: Vec<PathBuf> = files.chain(diagrams).chain(self.passes.checkpoint.clone()).collect();
        let inputs = [inputs, &*self.kept].concat();
        let mut outputs = Target::check_all(&files, &inputs)?;
        if let Some(folder) = &self.confined_to {
            let outside = outputs.iter().find(|target| !target.is_file_within(folder));
            if let Some(target) = outside {
                return Err(outside_of(target.path(), folder));
            }
        }
        let checkpoint = self.passes.checkpoint.as_ref().and_then(|_| outputs.pop());
        if let Some(resumed) = &self.passes.resume {
            outputs.iter().try_for_each(|target| target.differs_from(resumed))?;
        }
        let diagrams = outputs.split_off(outputs.len() - self.diagrams.len());
        match checkpoint {
            Some(target) if target.is_stream() => Err(Failure::Output(format!(
                "cannot keep a checkpoint in `{}`: it is a pipe or a device",
                target.path().display()
            ))),
            checkpoint => Ok(Targets { outputs, diagrams, checkpoint }),
        }
    }
}

/// A file that a bound on what may be written does not allow.
fn outside_of(path: &Path, folder: &Path) -> Failure {
    Failure::Input(format!(
        "`{}` is outside `{}`, the only folder that the list may write to; `@` stands for the place and name of its picture",
        path.display(),
        folder.display()
    ))
}

/// "scene.txt has 3 errors", after they were shown; a single one speaks for itself.
pub fn has_errors(scene: &Path, loaded: &Loaded) -> Failure {
    if loaded.is_out_of_memory() {
        return Failure::Memory(format!("there is not enough memory for `{}`", scene.display()));
    }
    match loaded.diagnostics.count(Severity::Error) {
        0 | 1 => Failure::Input(String::new()),
        count => Failure::Input(format!("`{}` has {count} errors", scene.display())),
    }
}

/// R-hat in words: `1.013`, or `above 10`.
pub fn in_figures(r_hat: f64) -> String {
    if r_hat > 10.0 { "above 10".to_owned() } else { format!("{r_hat:.3}") }
}

/// Warns where groups of Markov chains differ.
fn warn_of_chains(r_hat: Option<f64>, voice: &mut Voice<'_>) {
    if let Some(r_hat) = r_hat.filter(|&r_hat| r_hat > LARGEST_R_HAT) {
        voice.warn(format!(
            "Markov chains do not agree on where light is: R-hat between groups of them is {}, more than {LARGEST_R_HAT}, so that \
             a render with another seed would look different; ask for more samples",
            in_figures(r_hat)
        ));
    }
}

/// What `clamp` has taken away.
fn what_was_clamped(clamped: &ClampedLight) -> String {
    let ClampedLight { limit, count, taken } = clamped;
    if *count == 0 {
        return format!("`clamp {limit}` took nothing away: no sample was above it");
    }
    let [red, green, blue] = taken.map(|share| 100.0 * share);
    format!(
        "`clamp {limit}` limited {count} sample{} and took away {red:.2} % of the red light, {green:.2} % of the green and \
         {blue:.2} % of the blue: the picture is darker by that",
        if *count == 1 { "" } else { "s" },
    )
}

fn warn_of_numbers(stats: &RenderStats, voice: &mut Voice<'_>) {
    if stats.non_finite > 0 {
        voice.warn(format!("{} samples were not finite numbers and count as black", stats.non_finite));
    }
    if stats.rays.lost > 0 {
        voice.warn(format!(
            "{} rays were lost in bodies that bend light and count as black: they took too many steps, or came to where \
             the index of refraction is no number above zero",
            stats.rays.lost
        ));
    }
    if stats.rays.left_out > 0 {
        (voice.say)(&format!(
            "warning: {} mirrored rays were left out: where surfaces mirror and let light through, paths of one sample \
             double with each of the bounces; ask for fewer bounces or a larger --weight\n",
            stats.rays.left_out
        ));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[test]
    fn chains_that_do_not_agree_are_warned_of() {
        for (r_hat, expected) in [
            (None, None),
            (Some(1.049), None),
            (Some(1.0512), Some("1.051")),
            (Some(f64::INFINITY), Some("above 10")),
        ] {
            let mut said = String::new();
            let mut say = |text: &str| said.push_str(text);
            let mut voice = Voice { color: false, quiet: true, say: &mut say };
            warn_of_chains(r_hat, &mut voice);
            match expected {
                None => assert_eq!(said, ""),
                Some(figures) => assert!(
                    said.contains(&format!("R-hat between groups of them is {figures}, more than 1.05")),
                    "{said}"
                ),
            }
        }
    }

    #[test]
    fn what_is_clamped_is_said_in_shares() {
        let said = |count, taken| what_was_clamped(&ClampedLight { limit: 2.5, count, taken });
        assert_eq!(said(0, [0.0; 3]), "`clamp 2.5` took nothing away: no sample was above it");
        assert_eq!(
            said(12, [0.5, 0.0123, 0.0]),
            "`clamp 2.5` limited 12 samples and took away 50.00 % of the red light, 1.23 % of the green and 0.00 % of the blue: \
             the picture is darker by that"
        );
        assert!(said(1, [0.1; 3]).contains("limited 1 sample and"));
    }

    impl Job {
        /// A job that asks for nothing in particular.
        pub fn plain(scene: PathBuf, size: [u32; 2], outputs: Vec<Output>) -> Job {
            Job {
                scene,
                load: LoadOptions::default(),
                defaults: Defaults::Modern,
                asked: Settings { size: Some(size), ..Settings::default() },
                classic: None,
                outputs,
                crop: None,
                diagrams: Vec::new(),
                depth: BitDepth::Eight,
                resources: Resources::default(),
                keep_partial: false,
                passes: PassArgs::default(),
                farm: FarmArgs::default(),
                develop: DevelopArgs::default(),
                kept: Vec::new(),
                confined_to: None,
            }
        }
    }

    /// Makes the first and the fourth tile fail, as a bug in kajo would: a tile tells from within how far it is, every
    /// 256 samples and at its end.
    #[derive(Default)]
    struct Failing(AtomicU32);

    impl kajo::Progress for Failing {
        fn done(&self, _: u64, _: u64, _: u64) {
            let told = self.0.fetch_add(1, Ordering::Relaxed);
            assert!(![1, 12].contains(&told), "on purpose");
        }

        fn cancelled(&self) -> bool {
            false
        }
    }

    #[test]
    fn tiles_that_fail_do_not_cost_the_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let camera = "OrthographicCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  size 1 }";
        std::fs::write(path("scene.txt"), format!("{camera} Background {{ color 1 1 1 }} Group {{ }}"))
            .unwrap();
        for passes in [None, Some(path("state"))] {
            let output = Output {
                destination: Destination::File(path("out.png")),
                format: Format::Png,
                views: vec![View::Color],
            };
            let mut job = Job::plain(path("scene.txt"), [96, 64], vec![output]);
            job.asked.samples = Some((SamplerKind::Uniform, 1));
            job.passes.checkpoint = passes;
            let loaded = kajo::load(&job.scene, &job.load);
            let scene = loaded.scene.as_ref().unwrap();
            let mut said = String::new();
            let mut voice = Voice { color: false, quiet: true, say: &mut |text: &str| said.push_str(text) };
            let settings = job.settings(scene, &mut voice).unwrap();
            let targets = job.targets(&loaded.files).unwrap();
            let interrupt = Interrupt::default();
            let outputs = [(View::Color, Format::Png)];
            let resources = Resources { threads: 1, tile: 32, memory: None };
            let result = match targets.checkpoint {
                None => kajo::render(
                    &kajo::RenderRequest::new(scene, &settings, &outputs).with(resources),
                    &Failing::default(),
                ),
                Some(_) => {
                    let (passes, mut watcher) = job.prepare_passes(&loaded, &targets, &interrupt).unwrap();
                    let look = &mut |snapshot: Snapshot<'_>| watcher.look(snapshot);
                    let failing = Failing::default();
                    kajo::render_passes(
                        &kajo::RenderRequest::new(scene, &settings, &outputs).with(resources),
                        &passes,
                        &failing,
                        look,
                    )
                }
            };
            let failure = job.finish(result, false, &targets, &interrupt, &mut voice).unwrap_err();
            assert_eq!(failure.code(), 4);
            let message = failure.message();
            assert!(
                message.contains("of the picture's tiles failed; the first is the one at ("),
                "{message}"
            );
            assert!(message.contains("on purpose; the picture is what the other tiles show"), "{message}");
            let picture = kajo::compare::read_picture(&path("out.png")).unwrap().image;
            assert_eq!([picture.width(), picture.height()], [96, 64]);
            let white = picture.pixels().filter(|pixel| pixel[0] == 1.0).count();
            assert_eq!(white, 4 * 32 * 32, "the other four tiles");
            assert_eq!(path("state").exists(), targets.checkpoint.is_some());
        }
    }
}
