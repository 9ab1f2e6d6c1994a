//! One render from the scene's file to the pictures' files, whichever command asked for it.

use std::io::Write;
use std::path::{Path, PathBuf};

use kajo::output::{OutputError, Target};
use kajo::{
    BitDepth, DENOISE_OUTPUTS, Defaults, Dialect, Format, Highlight, IntegratorKind, LoadOptions, Loaded,
    Passes, Picture, Progress, RenderError, RenderSettings, RenderStats, Resources, SamplerKind, Scene,
    SceneDigest, Settings, Severity, View,
};

use crate::args::{DevelopArgs, PassArgs};
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Work};
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
    /// What the classic command line says besides.
    pub classic: Option<ClassicWords>,
    pub outputs: Vec<Output>,
    /// Bits a channel in PNG files.
    pub depth: BitDepth,
    pub resources: Resources,
    /// Write what there is when interrupted.
    pub keep_partial: bool,
    /// What a render in several passes is wanted for, if it is.
    pub passes: PassArgs,
    /// What happens to the picture afterwards.
    pub develop: DevelopArgs,
}

/// Classic options whose meaning depends on the scene's dialect, or that no `Settings` block has.
#[derive(Clone, Copy, Debug)]
pub struct ClassicWords {
    pub uv: bool,
    pub specular_fix: bool,
    /// The samples were asked for by `-uniform_samples`.
    pub uniform_samples: bool,
}

/// A file to be written and what it shows.
#[derive(Debug)]
pub struct Output {
    pub destination: Destination,
    pub format: Format,
    pub views: Vec<View>,
}

/// Where the bytes of a picture go.
#[derive(Debug)]
pub enum Destination {
    File(PathBuf),
    StandardOutput,
}

/// Who is told what there is to say about a scene, before its render starts.
pub struct Voice<'a> {
    /// Whether the text may hold the colour codes of terminals.
    pub color: bool,
    /// Whether only warnings and errors are wanted.
    pub quiet: bool,
    /// Takes lines of text.
    pub say: &'a mut dyn FnMut(&str),
}

/// What a job did.
#[derive(Debug)]
pub struct Done {
    pub size: [u32; 2],
    /// Of a pixel, on average.
    pub samples: f64,
    /// Estimated relative error, where it is known.
    pub noise: Option<f64>,
    pub stats: RenderStats,
}

/// Files to be written, found to be writable.
struct Targets {
    /// For each output that is no standard output.
    outputs: Vec<Target>,
    checkpoint: Option<Target>,
}

/// Why there is no complete picture.
enum Stop {
    Render(RenderError),
    Other(Failure),
}

impl Destination {
    /// The format that the name's ending says; PNG for standard output and devices.
    ///
    /// # Errors
    /// When the ending says nothing.
    pub fn format(&self) -> Result<Format, Failure> {
        let Destination::File(path) = self else { return Ok(Format::Png) };
        let extension = path.extension().map(|extension| extension.to_string_lossy());
        let is_device = extension.is_none() && path.starts_with("/dev");
        let format = extension.and_then(|extension| Format::from_extension(&extension));
        format.or(is_device.then_some(Format::Png)).ok_or_else(|| {
            let message = "its ending says no format; known are .png, .exr, .tga, .bmp, .ppm, .pfm and .hdr";
            Failure::Input(format!("cannot write `{}`: {message}", path.display()))
        })
    }
}

impl Job {
    /// Does it all.
    ///
    /// # Errors
    /// [`Failure`]; then no file is written that was not finished before.
    pub fn run(&self, meter: &Meter, interrupt: &Interrupt, voice: &mut Voice<'_>) -> Result<Done, Failure> {
        let load = LoadOptions { progress: meter.loading(), ..self.load.clone() };
        let mut loaded = kajo::load(&self.scene, &load);
        drop(load);
        if !loaded.diagnostics.is_empty() {
            (voice.say)(&loaded.report(voice.color));
        }
        let scene = loaded.scene.take().ok_or_else(|| has_errors(&self.scene, &loaded))?;
        let settings = self.settings(&scene, voice)?;
        let targets = self.targets(&loaded.files)?;
        let outputs: Vec<(View, Format)> = self
            .outputs
            .iter()
            .flat_map(|output| output.views.iter().map(|&view| (view, output.format)))
            .chain(self.develop.denoise.iter().flat_map(|_| DENOISE_OUTPUTS))
            .collect();
        let (result, interrupted) = interrupt.during(Work::Render, || {
            let progress = meter.watched(interrupt);
            let result = if self.passes.are_wanted() {
                self.render_passes(&scene, &settings, &outputs, &loaded.files, &targets, &progress, interrupt)
            } else {
                kajo::render(&scene, &settings, &outputs, &self.resources, &progress).map_err(Stop::Render)
            };
            meter.finish();
            result
        });
        let (mut picture, bug) = match result {
            Ok(picture) => (picture, None),
            Err(Stop::Render(RenderError::Cancelled(partial))) => (*partial, None),
            Err(Stop::Render(RenderError::Panicked { message, picture: Some(partial) })) => {
                (*partial, Some(Failure::Bug(message)))
            }
            Err(Stop::Render(error)) => return Err(error.into()),
            Err(Stop::Other(failure)) => return Err(failure),
        };
        // Before anything else can go wrong; a picture that cannot be continued is still worth writing.
        let (saved, interrupted_meanwhile) = interrupt.during(Work::Write, || save(&picture, &targets));
        let interrupted = interrupted || interrupted_meanwhile;
        if let Some(bug) = bug {
            if let Err(error) = saved {
                (voice.say)(&format!("warning: {error}\n"));
            }
            return Err(bug);
        }
        let stopped = || interrupt.failure();
        if interrupted && !self.keep_partial && targets.checkpoint.is_none() {
            return Err(stopped());
        }
        warn_of_numbers(&picture.stats, voice);
        picture.development = self.develop.development(picture.development);
        if let Some(denoiser) = &self.develop.denoise {
            match picture.denoise(denoiser) {
                Ok(_) if voice.quiet => {}
                Ok(how) => (voice.say)(&format!("denoised {how}\n")),
                // The noisy picture took long enough to be kept.
                Err(error) => (voice.say)(&format!("warning: the picture is not denoised: {error}\n")),
            }
        }
        self.write(&picture, &targets.outputs, interrupt)?;
        saved?;
        if interrupted {
            return Err(stopped());
        }
        Ok(Done {
            size: picture.size(),
            samples: picture.mean_samples(),
            noise: picture.noise(),
            stats: picture.stats,
        })
    }

    /// A render with somebody to look at it after each pass.
    #[expect(clippy::too_many_arguments, reason = "they are what `run` has found out so far")]
    fn render_passes(
        &self,
        scene: &Scene,
        settings: &RenderSettings,
        outputs: &[(View, Format)],
        files: &[PathBuf],
        targets: &Targets,
        progress: &dyn Progress,
        interrupt: &Interrupt,
    ) -> Result<Picture, Stop> {
        let digest = SceneDigest::of_files(files);
        let digest = digest
            .map_err(|error| Stop::Other(Failure::Input(format!("cannot read the scene again: {error}"))))?;
        let passes = Passes { goal: self.passes.goal(), resume: self.passes.resume.clone(), scene: digest };
        let mut watcher = Watcher::new(&self.passes, &self.scene, targets.checkpoint.as_ref(), interrupt);
        let result = kajo::render_passes(
            scene,
            settings,
            outputs,
            &self.resources,
            &passes,
            progress,
            &mut |snapshot| watcher.look(snapshot),
        );
        match watcher.failure {
            Some(failure) => Err(Stop::Other(failure.into())),
            None => result.map_err(Stop::Render),
        }
    }

    fn settings(&self, scene: &Scene, voice: &mut Voice<'_>) -> Result<RenderSettings, Failure> {
        let uv = self.classic.is_some_and(|words| words.uv);
        let mut settings = RenderSettings::resolve(scene, &self.asked, self.defaults, uv)?;
        let left_out = settings.left_out(scene).into_iter().map(str::to_owned);
        for note in left_out.chain(settings.without_effect(&self.asked, &scene.settings)) {
            (voice.say)(&format!("warning: {note}\n"));
        }
        let splats = matches!(settings.integrator, IntegratorKind::Bidirectional | IntegratorKind::Light);
        if splats && self.passes.adaptive {
            let plan = match self.passes.noise {
                Some(_) => "; leave out `--adaptive` to reach that `--noise`",
                None => "",
            };
            (voice.say)(&format!(
                "warning: adaptive sampling goes by what paths from the camera find, and not by light from lamps{plan}\n"
            ));
        }
        let Some(words) = self.classic else { return Ok(settings) };
        let is_2004 = scene.rules.dialect == Dialect::Mit2004;
        if words.uniform_samples && is_2004 {
            settings.samples.0 = SamplerKind::Regular;
        }
        match (words.specular_fix, is_2004) {
            (true, true) => settings.classic.highlight = Highlight::HalfTimesCosine,
            (true, false) => (voice.say)("warning: `-specular_fix` works in dialect mit-2004 only\n"),
            (false, _) => {}
        }
        Ok(settings)
    }

    /// Makes sure that every file can be written.
    fn targets(&self, inputs: &[PathBuf]) -> Result<Targets, OutputError> {
        let files = self.outputs.iter().filter_map(|output| match &output.destination {
            Destination::File(path) => Some(path.clone()),
            Destination::StandardOutput => None,
        });
        let files: Vec<PathBuf> = files.chain(self.passes.checkpoint.clone()).collect();
        let mut outputs = Target::check_all(&files, inputs)?;
        let checkpoint = self.passes.checkpoint.as_ref().and_then(|_| outputs.pop());
        Ok(Targets { outputs, checkpoint })
    }

    fn write(&self, picture: &Picture, targets: &[Target], interrupt: &Interrupt) -> Result<(), Failure> {
        let mut targets = targets.iter();
        for output in &self.outputs {
            let bytes = picture.encode(&output.views, output.format, self.depth)?;
            let (result, interrupted) = interrupt.during(Work::Write, || match &output.destination {
                Destination::StandardOutput => write_to_standard_output(&bytes),
                Destination::File(_) => match targets.next() {
                    Some(target) => target.write(&bytes).map_err(Failure::from),
                    None => Ok(()),
                },
            });
            result?;
            if interrupted {
                return Err(interrupt.failure());
            }
        }
        Ok(())
    }
}

/// "scene.txt has 3 errors", after they were shown; a single one speaks for itself.
pub fn has_errors(scene: &Path, loaded: &Loaded) -> Failure {
    match loaded.diagnostics.count(Severity::Error) {
        0 | 1 => Failure::Input(String::new()),
        count => Failure::Input(format!("`{}` has {count} errors", scene.display())),
    }
}

/// Saves the state of a render that is over, however it ended, if that is wanted.
fn save(picture: &Picture, targets: &Targets) -> Result<(), OutputError> {
    match (&targets.checkpoint, picture.snapshot()) {
        (Some(target), Some(state)) => state.save(target),
        _ => Ok(()),
    }
}

fn warn_of_numbers(stats: &RenderStats, voice: &mut Voice<'_>) {
    if stats.non_finite > 0 {
        (voice.say)(&format!(
            "warning: {} samples were not finite numbers and count as black\n",
            stats.non_finite
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

fn write_to_standard_output(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(|error| {
        Failure::Output(format!(
            "cannot write to standard output, which needs {} bytes: {error}",
            bytes.len()
        ))
    })
}
