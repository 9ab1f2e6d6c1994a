//! From a scene to a picture.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use kajo_core::camera::Camera;
use kajo_core::sampler::SamplerKind;
use kajo_core::scene::Scene;
use kajo_image::{BitDepth, Format, Image, ImageError};
use kajo_render::integrator::Prepare;
use kajo_render::{
    ClampedLight, Film, FilmError, FilmSpec, Goal, KeptState, Layer, LayerSet, PixelIntegrator, Position,
    Progress, RenderError as PassError, RenderStats,
};
use kajo_scene::in_words;

use crate::SceneDigest;
use crate::checkpoint::{self, CheckpointError, Identity};
use crate::denoise::{self, DENOISE_OUTPUTS, DenoiseError, Denoiser};
use crate::development::Development;
use crate::output::{OutputError, Target};
use crate::view::{self, Look, View};
use crate::{CameraPose, RenderSettings, memory};

/// What may be used up, and in which pieces; none of it changes a bit of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Resources {
    /// Threads; 0 for one on each core.
    pub threads: usize,
    /// Side of a tile in pixels; 0 for the default.
    pub tile: u32,
    /// Bytes that a picture may take; `None` for what the system has left.
    pub memory: Option<u64>,
}

/// A render in passes: when it ends, and where it begins.
#[derive(Clone, Debug, Default)]
pub struct Passes {
    /// When the picture is good enough.
    pub goal: Goal,
    /// The checkpoint of an earlier render that is to be continued.
    pub resume: Option<PathBuf>,
    /// Where checkpoints will be written, unless anything there may be replaced: a checkpoint that is farther, or a
    /// file of another kind, is an error.
    pub checkpoint: Option<PathBuf>,
    /// What the scene was read from, so that a checkpoint of another one is refused.
    pub scene: SceneDigest,
}

/// A rendered picture, with all that was asked for.
#[derive(Debug)]
pub struct Picture {
    film: Film,
    /// Names of the groups of lights.
    groups: Arc<[String]>,
    settings: RenderSettings,
    position: Option<(Position, Identity)>,
    /// The light, where it was denoised.
    light: Option<Image>,
    /// [`Resources::threads`] of the render, and of what is done to the picture.
    threads: usize,
    /// How the light becomes values.
    pub development: Development,
    /// Whether files are made in little time rather than small, as for a picture that is not finished.
    pub quick: bool,
    /// Rays, samples and time of this run.
    pub stats: RenderStats,
}

/// A picture in the making, between two passes.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    film: &'a Film,
    groups: &'a [String],
    settings: &'a RenderSettings,
    position: &'a Position,
    identity: &'a Identity,
    /// [`Resources::threads`] of the render.
    threads: usize,
    /// Rays, samples and time of this run so far.
    pub stats: RenderStats,
}

/// Why there is no picture, or only a part of one.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The size or the filter makes no sense.
    #[error(transparent)]
    Film(FilmError),
    /// It would take more memory than there is.
    #[error(
        "a picture of {width} x {height} with these outputs needs {}, and {} can be had; ask for a smaller one",
        in_words(*needed), in_words(u128::from(*budget))
    )]
    Memory {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes needed.
        needed: u128,
        /// Bytes allowed.
        budget: u64,
    },
    /// The checkpoint to go on from is none of this render.
    #[error(transparent)]
    Checkpoint(CheckpointError),
    /// Adaptive sampling takes more samples here and fewer there, and these patterns have a fixed number.
    #[error(
        "adaptive sampling cannot use {0} samples, whose number is fixed; take sobol, zsobol, pmj or uniform ones"
    )]
    NotAdaptive(&'static str),
    /// Noise is estimated from samples that are independent, and those of this integrator share what they are made of.
    #[error(
        "the noise of `integrator {0}` cannot be told from its samples, which share their light; \
         take a number of samples or a time, or another integrator"
    )]
    UnknownNoise(&'static str),
    /// The integrator could not be made ready.
    #[error("{0}")]
    Unprepared(String),
    /// [`Progress::cancelled`] said so. The picture holds what was rendered.
    #[error("the render was interrupted")]
    Cancelled(Box<Picture>),
    /// Some tiles failed because of a bug.
    #[error("{message}")]
    Panicked {
        /// Which, and how.
        message: String,
        /// What was rendered all the same, if the render came that far.
        picture: Option<Box<Picture>>,
    },
}

/// What is to be rendered: all but who watches.
#[derive(Clone, Copy, Debug)]
pub struct RenderRequest<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Where it is seen from; with the scene's own camera where absent.
    pub camera: Option<&'a CameraPose>,
    /// How it is rendered.
    pub settings: &'a RenderSettings,
    /// Views and formats of the files that will be made: what they need is recorded.
    pub outputs: &'a [(View, Format)],
    /// What may be used up; the picture has the same bits whatever it says.
    pub resources: Resources,
    /// What renders of the scene through other cameras left, to start from and to add to; renders that write or read a
    /// checkpoint do neither.
    pub kept: Option<&'a KeptState>,
}

impl<'a> RenderRequest<'a> {
    /// The scene through its own camera, with all cores.
    pub fn new(
        scene: &'a Scene,
        settings: &'a RenderSettings,
        outputs: &'a [(View, Format)],
    ) -> RenderRequest<'a> {
        RenderRequest { scene, camera: None, settings, outputs, resources: Resources::default(), kept: None }
    }

    /// The same through another camera.
    pub fn through(self, camera: &'a CameraPose) -> RenderRequest<'a> {
        RenderRequest { camera: Some(camera), ..self }
    }

    /// The same with these resources.
    pub fn with(self, resources: Resources) -> RenderRequest<'a> {
        RenderRequest { resources, ..self }
    }

    /// The same from what renders of the scene through other cameras left: records of irradiance, which it adds its own to.
    pub fn keeping(self, kept: &'a KeptState) -> RenderRequest<'a> {
        RenderRequest { kept: Some(kept), ..self }
    }

    pub(crate) fn camera(&self) -> &'a Camera {
        self.camera.map_or(&self.scene.output.camera, CameraPose::camera)
    }

    pub(crate) fn layers(&self) -> LayerSet {
        layers(self.scene, self.outputs, self.settings)
    }

    /// The film of a render in passes.
    pub(crate) fn spec_of_passes(&self, goal: &Goal) -> Result<FilmSpec, RenderError> {
        if let (true, Some(name)) = (goal.adaptive, fixed_pattern(self.settings.samples.0)) {
            return Err(RenderError::NotAdaptive(name));
        }
        let mut layers = self.layers();
        if goal.adaptive || goal.noise.is_some() {
            layers = layers.with(Layer::Variance);
        }
        if layers.has(Layer::Variance) && !self.integrator(layers).noise_is_known() {
            return Err(RenderError::UnknownNoise(self.settings.integrator.name.0));
        }
        let spec = film_spec(self.camera(), self.settings, layers);
        // Where the noise of the picture decides on its samples, all of it does so.
        let samples_everywhere = spec.samples_everywhere || spec.shown.is_some() && goal.noise.is_some();
        Ok(FilmSpec { halves: goal.adaptive, samples_everywhere, ..spec })
    }

    /// Room for what is made of the film.
    pub(crate) fn reserve(&self, spec: &FilmSpec) -> Result<Reserve, RenderError> {
        Reserve::new(spec, to_finish(self.scene, self.outputs, self.settings))
    }

    pub(crate) fn check_memory(&self, spec: &FilmSpec) -> Result<(), RenderError> {
        check_memory(spec, to_finish(self.scene, self.outputs, self.settings), &self.resources)
    }

    pub(crate) fn integrator(&self, layers: LayerSet) -> Box<dyn PixelIntegrator + 'a> {
        integrator(self.scene, self.camera(), self.settings, layers)
    }

    pub(crate) fn schedule(&self, spec: &FilmSpec) -> kajo_render::RenderSettings {
        let schedule = schedule(self.settings, &within_memory(&self.resources, spec));
        let film = u64::try_from(spec.bytes()).unwrap_or(u64::MAX);
        kajo_render::RenderSettings { memory: schedule.memory.saturating_sub(film), ..schedule }
    }

    pub(crate) fn picture(
        &self,
        film: Film,
        position: Option<(Position, Identity)>,
        stats: RenderStats,
    ) -> Picture {
        Picture::new(film, self.scene, self.settings, position, &self.resources, stats)
    }
}

/// Renders a picture.
///
/// # Errors
/// [`RenderError`]; the size is checked before anything is allocated.
pub fn render(request: &RenderRequest<'_>, progress: &dyn Progress) -> Result<Picture, RenderError> {
    let layers = request.layers();
    let mut integrator = request.integrator(layers);
    if let Some(kept) = request.kept {
        integrator.keep_state(kept);
    }
    let one_pass = integrator
        .samples_per_state()
        .is_none_or(|per_state| per_state.end_of_part(0) >= request.settings.samples.1);
    let spec = FilmSpec { one_pass, ..film_spec(request.camera(), request.settings, layers) };
    request.check_memory(&spec)?;
    let film = new_film(spec)?;
    let reserve = request.reserve(&spec)?;
    let result = kajo_render::render(&*integrator, &film, &request.schedule(&spec), progress);
    drop(reserve);
    ended(result, |stats| request.picture(film, None, stats))
}

/// As [`render`], in passes over the whole picture: it can be seen and saved after each, ends when a goal is
/// reached, and goes on from a checkpoint.
///
/// * `look`: called after each pass; may end the render
///
/// Without goals for time or noise, the picture has the same bits as that of [`render`].
///
/// # Errors
/// As [`render`]; a checkpoint that cannot be used; a sampler with a fixed number of samples for adaptive
/// sampling.
pub fn render_passes(
    request: &RenderRequest<'_>,
    passes: &Passes,
    progress: &dyn Progress,
    look: &mut dyn FnMut(Snapshot<'_>) -> ControlFlow<()>,
) -> Result<Picture, RenderError> {
    let RenderRequest { scene, settings, resources, .. } = *request;
    let goal = &passes.goal;
    let spec = request.spec_of_passes(goal)?;
    let layers = spec.layers;
    let mut integrator = request.integrator(layers);
    // What goes on later makes its state anew.
    let goes_on = passes.resume.is_some() || passes.checkpoint.is_some();
    if let Some(kept) = request.kept.filter(|_| !goes_on) {
        integrator.keep_state(kept);
    }
    request.check_memory(&spec)?;
    let identity = Identity::new(passes.scene, (scene, request.camera()), settings, &spec, goal);
    let schedule = request.schedule(&spec);
    let (film, mut position) = match &passes.resume {
        Some(path) => checkpoint::restore(path, &identity, spec, &schedule, progress)
            .map_err(RenderError::Checkpoint)?,
        None => (new_film(spec)?, Position::default()),
    };
    if let Some(path) = &passes.checkpoint {
        checkpoint::check_replaced(path, &identity, film.samples(), passes.resume.as_deref())
            .map_err(RenderError::Checkpoint)?;
    }
    let reserve = request.reserve(&spec)?;
    let look = &mut |film: &Film, position: &Position, &stats: &RenderStats| {
        let (groups, identity, threads) = (&*scene.lighting.groups, &identity, resources.threads);
        look(Snapshot { film, groups, settings, position, identity, threads, stats })
    };
    let result =
        kajo_render::render_passes(&*integrator, &film, &schedule, goal, &mut position, progress, look);
    drop(reserve);
    ended(result, |stats| request.picture(film, Some((position, identity)), stats))
}

/// What came of a render, with its picture.
fn ended(
    result: Result<RenderStats, PassError>,
    picture: impl FnOnce(RenderStats) -> Picture,
) -> Result<Picture, RenderError> {
    match result {
        Ok(stats) => Ok(picture(stats)),
        Err(error) => Err(failed(error, picture)),
    }
}

/// Why a render is not complete, with what there is of its picture.
pub(crate) fn failed(error: PassError, picture: impl FnOnce(RenderStats) -> Picture) -> RenderError {
    let message = error.to_string();
    match error {
        PassError::Unprepared { message, .. } => RenderError::Unprepared(message),
        PassError::Cancelled(stats) => RenderError::Cancelled(Box::new(picture(stats))),
        PassError::Panicked { stats, .. } => {
            RenderError::Panicked { message, picture: Some(Box::new(picture(stats))) }
        }
    }
}

impl RenderError {
    /// A bug before there was a picture.
    pub(crate) fn panicked(message: impl Into<String>) -> RenderError {
        RenderError::Panicked { message: message.into(), picture: None }
    }
}

pub(crate) fn schedule(settings: &RenderSettings, resources: &Resources) -> kajo_render::RenderSettings {
    kajo_render::RenderSettings {
        sampler: settings.sampler(),
        seed: settings.seed,
        threads: resources.threads,
        tile: resources.tile,
        memory: resources.memory.unwrap_or_else(memory::available),
    }
}

/// The integrator that the settings ask for, through the scene's own camera or another.
pub(crate) fn integrator<'a>(
    scene: &'a Scene,
    camera: &'a Camera,
    settings: &RenderSettings,
    layers: LayerSet,
) -> Box<dyn PixelIntegrator + 'a> {
    settings.integrator_settings.prepare(scene, camera, settings.size, layers)
}

/// The name of the pattern of samples, if it needs a fixed number of them.
pub(crate) fn fixed_pattern(kind: SamplerKind) -> Option<&'static str> {
    match kind {
        SamplerKind::Regular => Some("regular"),
        SamplerKind::Jittered => Some("jittered"),
        SamplerKind::Poisson => Some("poisson"),
        SamplerKind::Cmj => Some("cmj"),
        SamplerKind::Uniform | SamplerKind::Sobol | SamplerKind::ZSobol | SamplerKind::Pmj => None,
    }
}

impl Snapshot<'_> {
    /// The picture so far; see [`Picture::encode`].
    ///
    /// # Errors
    /// As there.
    pub fn encode(&self, views: &[View], format: Format, depth: BitDepth) -> Result<Vec<u8>, ImageError> {
        let look =
            Look { development: &self.settings.development, light: None, groups: self.groups, quick: false };
        view::encode(self.film, views, format, depth, self.settings, &look)
    }

    /// The light so far, linear RGB.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn light(&self) -> Result<Image, ImageError> {
        view::develop(self.film, Layer::Color)
    }

    /// Samples of each pixel so far.
    pub fn samples(&self) -> u32 {
        self.position.samples()
    }

    /// Writes a checkpoint, whole or not at all.
    ///
    /// # Errors
    /// When the file cannot be written; the one that stood there before still does.
    pub fn save(&self, target: &Target) -> Result<(), OutputError> {
        target.fill(self.bytes(), |out| self.write(out))
    }

    /// Writes the bytes of a checkpoint.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        checkpoint::save(self.threads, self.identity, self.film, self.position, out)
    }

    /// About how many bytes a checkpoint has.
    pub fn bytes(&self) -> usize {
        usize::try_from(self.film.spec().bytes()).unwrap_or(usize::MAX)
    }
}

impl Picture {
    fn new(
        film: Film,
        scene: &Scene,
        settings: &RenderSettings,
        position: Option<(Position, Identity)>,
        resources: &Resources,
        stats: RenderStats,
    ) -> Picture {
        Picture {
            film,
            groups: Arc::clone(&scene.lighting.groups),
            settings: *settings,
            position,
            light: None,
            threads: resources.threads,
            development: settings.development,
            quick: false,
            stats,
        }
    }

    /// Takes the noise out of the light. The outputs that were asked for must have included
    /// [`DENOISE_OUTPUTS`](crate::DENOISE_OUTPUTS).
    ///
    /// Returns how it was done, in words.
    ///
    /// # Errors
    /// [`DenoiseError`]; the picture then stays as it was.
    pub fn denoise(&mut self, denoiser: &Denoiser) -> Result<String, DenoiseError> {
        let (light, how) = denoise::denoise(&self.film, denoiser, self.threads)?;
        self.light = Some(light);
        Ok(how)
    }

    /// The bytes of a file that shows `views`; only OpenEXR can show more than one.
    ///
    /// # Errors
    /// When a view was not asked for in [`render`], or the format cannot hold the picture.
    pub fn encode(&self, views: &[View], format: Format, depth: BitDepth) -> Result<Vec<u8>, ImageError> {
        let look = Look {
            development: &self.development,
            light: self.light.as_ref(),
            groups: &self.groups,
            quick: self.quick,
        };
        view::encode(&self.film, views, format, depth, &self.settings, &look)
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.settings.shown_size()
    }

    /// Samples of a pixel on average, those of earlier runs included.
    pub fn mean_samples(&self) -> f64 {
        self.film.samples() as f64 / self.film.spec().sampled(&self.settings.sampler()).area() as f64
    }

    /// The light, linear RGB.
    ///
    /// # Errors
    /// When the picture shows something else, or there is no memory for it.
    pub fn light(&self) -> Result<Image, ImageError> {
        view::develop(&self.film, Layer::Color)
    }

    /// A layer as numbers, as an OpenEXR file has them; light is linear. The view with [`Format::Exr`] must have been asked
    /// for.
    ///
    /// # Errors
    /// When it was not, or there is no memory for it.
    pub fn layer(&self, view: View) -> Result<Image, ImageError> {
        match (view, &self.light) {
            (View::Color, Some(light)) => Ok(light.clone()),
            _ => view::picture(&self.film, view, Format::Exr, &self.settings),
        }
    }

    /// Samples that were left out because they were no finite numbers: each is a bug.
    pub fn non_finite(&self) -> u64 {
        self.film.non_finite()
    }

    /// How many values of the light the exposure makes larger than any number; they are written as the largest one.
    pub fn overexposed(&self) -> usize {
        if self.development.exposure <= 0.0 {
            return 0;
        }
        match &self.light {
            Some(light) => self.development.overflows(light),
            None => self.light().map_or(0, |light| self.development.overflows(&light)),
        }
    }

    /// Estimated relative error of the light, where it is known; see [`Goal::noise`].
    pub fn noise(&self) -> Option<f64> {
        self.film.noise()
    }

    /// How far groups of Markov chains are from agreeing, where there are any: they do not above [`LARGEST_R_HAT`](crate::LARGEST_R_HAT).
    pub fn r_hat(&self) -> Option<f64> {
        self.film.r_hat()
    }

    /// What `clamp` has taken away of the light, where that is asked for.
    pub fn clamped(&self) -> Option<ClampedLight> {
        self.film.clamped()
    }

    /// What can be saved as a checkpoint: pictures rendered in passes.
    pub fn snapshot(&self) -> Option<Snapshot<'_>> {
        let Picture { film, groups, settings, position, stats, threads, .. } = self;
        let (position, identity) = position.as_ref()?;
        Some(Snapshot { film, groups, settings, position, identity, threads: *threads, stats: *stats })
    }
}

fn layers(scene: &Scene, outputs: &[(View, Format)], settings: &RenderSettings) -> LayerSet {
    let n_groups = scene.lighting.groups.len();
    let of = |(view, format): &(View, Format)| view.layers(*format, settings, n_groups);
    let mut layers: Vec<Layer> = outputs.iter().flat_map(of).collect();
    if layers.is_empty() {
        // Without outputs the render is only timed.
        layers.push(Layer::Color);
    }
    LayerSet::of(&layers)
}

pub(crate) fn film_spec(camera: &Camera, settings: &RenderSettings, layers: LayerSet) -> FilmSpec {
    let [width, height] = settings.size;
    let cell = match camera.cells() {
        [1, 1] => None,
        [columns, rows] => Some([width.div_ceil(columns), height.div_ceil(rows)]),
    };
    FilmSpec {
        cell,
        filter: settings.filter,
        clamp: settings.clamp,
        layers,
        shown: settings.crop,
        // Light from emitters may appear anywhere in the picture.
        samples_everywhere: settings.integrator.splats,
        depth_map: settings.depth_map(),
        normal_map: settings.normal_map(),
        ..FilmSpec::new(width, height)
    }
}

/// Bytes a pixel that one picture takes while it is encoded: three floats, and up to four channels of two bytes each
/// before and after compression.
pub(crate) const BYTES_TO_ENCODE: u64 = 3 * 4 + 2 * 8;

/// Bytes a pixel that it takes to make files of a film, beside the film.
///
/// All layers of an OpenEXR file are encoded together. Which of the outputs share a file is not known here, so all of
/// them might. Denoising comes before, when the outputs are those that it needs, and its result stays.
fn to_finish(scene: &Scene, outputs: &[(View, Format)], settings: &RenderSettings) -> u64 {
    /// Light, three floats.
    const LIGHT: u64 = 3 * 4;
    /// A float by itself, and in the file.
    const CHANNEL: u64 = 4 + 4;
    let together: Vec<Layer> = View::ALL
        .iter()
        .filter(|&&view| outputs.contains(&(view, Format::Exr)))
        .flat_map(|view| view.layers(Format::Exr, settings, scene.lighting.groups.len()))
        .collect();
    let channels: usize = together.into_iter().map(Layer::channels).sum();
    let encoding = BYTES_TO_ENCODE.max(LIGHT + CHANNEL * channels as u64);
    let is_denoised = DENOISE_OUTPUTS.iter().all(|output| outputs.contains(output));
    if is_denoised { denoise::BYTES_A_PIXEL.max(LIGHT + encoding) } else { encoding }
}

/// The resources with no more threads than leave room for the film.
fn within_memory(resources: &Resources, spec: &FilmSpec) -> Resources {
    let film = u64::try_from(spec.bytes()).unwrap_or(u64::MAX);
    Resources { threads: memory::threads_beside(film, resources.threads), ..*resources }
}

pub(crate) fn new_film(spec: FilmSpec) -> Result<Film, RenderError> {
    let FilmSpec { width, height, .. } = spec;
    let needed = spec.bytes();
    Film::new(spec, u64::MAX).map_err(|error| match error {
        FilmError::OutOfMemory { .. } => {
            RenderError::Memory { width, height, needed, budget: memory::available() }
        }
        error => RenderError::Film(error),
    })
}

/// Room for what is made of a film, kept free while it is rendered: where a process may have only so much address space,
/// a picture that was rendered can also be encoded.
pub(crate) struct Reserve {
    _room: Vec<u8>,
}

impl Reserve {
    /// * `to_finish`: bytes a pixel needed beside the film
    fn new(spec: &FilmSpec, to_finish: u64) -> Result<Reserve, RenderError> {
        let FilmSpec { width, height, .. } = *spec;
        let needed = u128::from(width) * u128::from(height) * u128::from(to_finish);
        let mut room = Vec::new();
        match usize::try_from(needed).map(|bytes| room.try_reserve_exact(bytes)) {
            Ok(Ok(())) => Ok(Reserve { _room: room }),
            _ => Err(RenderError::Memory { width, height, needed, budget: memory::available() }),
        }
    }
}

/// Makes sure that a film and what is made of it fit.
///
/// * `to_finish`: bytes a pixel needed beside the film
pub(crate) fn check_memory(
    spec: &FilmSpec,
    to_finish: u64,
    resources: &Resources,
) -> Result<(), RenderError> {
    let FilmSpec { width, height, .. } = *spec;
    let budget = resources.memory.unwrap_or_else(memory::available);
    let needed = spec.bytes() + u128::from(spec.shown().area()) * u128::from(to_finish);
    if needed > u128::from(budget) {
        return Err(RenderError::Memory { width, height, needed, budget });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
