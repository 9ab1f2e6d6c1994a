//! `kajo render`: the modern command line.

use std::io::Read;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::PossibleValuesParser;
use kajo::{
    BitDepth, Caustics, Defaults, Directions, Format, Gradients, IntegratorName, LightChoice, LoadOptions,
    PhotonMapUse, RayOffset, Rect, Settings, ShadowAttenuation, Shadows, Technique, View,
};

use super::values::{self, Aov, FilterArg, Samples, Size};
use super::{DevelopArgs, FarmArgs, FrameArgs, PassArgs, RunArgs, SceneArgs, numbered};
use crate::failure::Failure;
use crate::film::Film;
use crate::job::Job;
use crate::output::{Destination, Output};

/// What to render, how, and where to put it. What is not said here is up to the scene's `Settings`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// Scene file
    pub scene: PathBuf,
    /// The picture; its ending is the format: png, exr, tga, bmp, ppm, pfm or hdr. `-` is PNG to standard output.
    /// By default a PNG beside the scene
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Width and height in pixels: 800 600 or 800x600
    #[arg(long, value_name = "W H")]
    pub size: Option<Size>,
    /// A part of the picture alone: the column and row of its first pixel, its width and its height
    #[arg(long, value_names = ["X", "Y", "W", "H"], num_args = 4)]
    pub crop: Option<Vec<u32>>,
    /// A further picture, or without FILE a further layer of the OpenEXR file: depth, normals, uv, object,
    /// material, samples, albedo, motion, variance, lost, records, lights [may be repeated]
    #[arg(long, value_name = "NAME[=FILE]", value_parser = values::aov(), action = clap::ArgAction::Append)]
    pub aov: Vec<Aov>,
    /// Layers of the OpenEXR file, separated by commas, or all
    #[arg(long, value_name = "NAMES", value_delimiter = ',',
        value_parser = PossibleValuesParser::new(View::NAMES.into_iter().chain(["all"])))]
    pub layers: Vec<String>,
    /// Distances shown as white and as black in a depth picture; by default the nearest and farthest in it
    #[arg(long, value_names = ["MIN", "MAX"], num_args = 2, allow_negative_numbers = true,
        value_parser = values::finite)]
    pub depth_range: Option<Vec<f32>>,
    /// Bits a channel in PNG files
    #[arg(long, value_name = "BITS", default_value = "8", value_parser = ["8", "16"])]
    pub bits: String,

    /// Rays for each pixel, and how they are spread: 16, or jittered, regular, uniform, sobol, zsobol, pmj, cmj or
    /// poisson 16
    #[arg(long, value_name = "[PATTERN] N", help_heading = "Quality")]
    pub samples: Option<Samples>,
    /// How rays become pixels, with a width in pixels: none, box, tent, gaussian, mitchell, lanczos
    #[arg(long, value_name = "NAME [WIDTH]", help_heading = "Quality")]
    pub filter: Option<FilterArg>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", help_heading = "Quality")]
    pub seed: Option<u64>,

    /// How light is followed: classic is for the course, path for right pictures
    #[arg(long, value_name = "NAME", help_heading = "Light",
        value_parser = values::integrator())]
    pub integrator: Option<IntegratorName>,
    /// Follow light by wavelength
    #[arg(long, value_name = "ON|OFF", help_heading = "Light", value_parser = values::on_off())]
    pub spectral: Option<bool>,
    /// How many times in a row a ray may be mirrored or refracted; scattered, where paths are followed
    #[arg(long, value_name = "N", help_heading = "Light",
        value_parser = clap::value_parser!(u32).range(0..=i64::from(kajo::MAX_BOUNCES)))]
    pub bounces: Option<u32>,
    /// End a branch when it counts for less than this
    #[arg(long, value_name = "W", help_heading = "Light", value_parser = values::weight)]
    pub weight: Option<f32>,
    /// Whether objects hide lights, and whether glass lets light through
    #[arg(long, help_heading = "Light", value_parser = values::choice([
        ("off", Shadows::Off), ("on", Shadows::Opaque), ("transparent", Shadows::Transparent)]))]
    pub shadows: Option<Shadows>,
    /// How glass weakens light that passes through: by length, or at each surface
    #[arg(long, help_heading = "Light", value_parser = values::choice([
        ("length", ShadowAttenuation::Length), ("surface", ShadowAttenuation::Surface)]))]
    pub transparent_shadows: Option<ShadowAttenuation>,
    /// Light the back sides of surfaces too
    #[arg(long, value_name = "ON|OFF", help_heading = "Light", value_parser = values::on_off())]
    pub shade_back: Option<bool>,
    /// Divide light at glass by Fresnel's equations
    #[arg(long, value_name = "ON|OFF", help_heading = "Light", value_parser = values::on_off())]
    pub fresnel: Option<bool>,
    /// Mirror what cannot leave glass
    #[arg(long, value_name = "ON|OFF", help_heading = "Light", value_parser = values::on_off())]
    pub total_reflection: Option<bool>,
    /// How rays keep clear of the surface they leave
    #[arg(long, help_heading = "Light", value_parser = values::choice([
        ("auto", RayOffset::Auto), ("reference", RayOffset::Reference)]))]
    pub ray_offset: Option<RayOffset>,

    /// Distribution: rays from the first surface that is no mirror
    #[arg(long, value_name = "N", help_heading = "Paths", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub branches: Option<u32>,
    /// How directions of indirect light are drawn: scattering, cosine or uniform
    #[arg(long, value_name = "NAME", help_heading = "Paths", value_parser = values::choice(Directions::NAMES))]
    pub directions: Option<Directions>,
    /// How direct light is estimated: combined, lights or scattering
    #[arg(long, value_name = "NAME", help_heading = "Paths", value_parser = values::choice_or(Technique::NAMES, Technique::SYNONYMS))]
    pub technique: Option<Technique>,
    /// How lights are chosen: tree, uniform or learned
    #[arg(long, value_name = "NAME", help_heading = "Paths", value_parser = values::choice(LightChoice::NAMES))]
    pub light_choice: Option<LightChoice>,
    /// Paths, and chains of them: how lights behind smooth glass are found: scattering, or manifold to draw them as well
    #[arg(long, value_name = "NAME", help_heading = "Paths", value_parser = values::choice(Caustics::NAMES))]
    pub caustics: Option<Caustics>,
    /// Whether paths of little weight end at random
    #[arg(long, value_name = "ON|OFF", help_heading = "Paths", value_parser = values::on_off())]
    pub roulette: Option<bool>,
    /// Paths: draws directions by where light has come from
    #[arg(long, value_name = "ON|OFF", help_heading = "Paths", value_parser = values::on_off())]
    pub guiding: Option<bool>,
    /// Guided paths: samples of each pixel by which the guide learns
    #[arg(long, value_name = "N", help_heading = "Paths", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub training: Option<u32>,
    /// Photon maps: paths from lights for one map
    #[arg(long, value_name = "N", help_heading = "Paths", value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub photons: Option<u32>,
    /// Photon maps: what the map is used for: gather, direct, caustics or dots
    #[arg(long, value_name = "NAME", help_heading = "Paths", value_parser = values::choice(PhotonMapUse::NAMES))]
    pub photon_map: Option<PhotonMapUse>,
    /// Vertex merging: whether vertices are merged
    #[arg(long, value_name = "ON|OFF", help_heading = "Paths", value_parser = values::on_off())]
    pub merging: Option<bool>,
    /// Vertex merging: radius of the first disks; 0 for one that suits the picture
    #[arg(long, value_name = "LENGTH", help_heading = "Paths", value_parser = values::not_negative)]
    pub merge_radius: Option<f64>,
    /// Vertex merging: how slowly the disks shrink, from 0 to 1
    #[arg(long, value_name = "ALPHA", help_heading = "Paths", value_parser = values::share)]
    pub merge_alpha: Option<f64>,
    /// Irradiance caching: the error that a record may make, as a share
    #[arg(long, value_name = "SHARE", help_heading = "Paths", value_parser = values::positive)]
    pub accuracy: Option<f64>,
    /// Irradiance caching: rays for one record
    #[arg(long, value_name = "N", help_heading = "Paths", value_parser = clap::value_parser!(u32).range(16..=1_048_576))]
    pub rays: Option<u32>,
    /// Irradiance caching: what is known around a record: occlusion, strata or off
    #[arg(long, value_name = "NAME", help_heading = "Paths", value_parser = values::choice(Gradients::NAMES))]
    pub gradients: Option<Gradients>,
    /// Irradiance caching: shows the irradiance and its records
    #[arg(long, value_name = "ON|OFF", help_heading = "Paths", value_parser = values::on_off())]
    pub show_records: Option<bool>,
    /// The most that a sample brings of light that was scattered, against fireflies; 0 for any amount
    #[arg(long, value_name = "RADIANCE", help_heading = "Paths", value_parser = values::not_negative)]
    pub clamp: Option<f64>,
    /// Occlusion: the distance beyond which nothing hides the light
    #[arg(long, value_name = "DISTANCE", help_heading = "Paths", value_parser = values::positive)]
    pub reach: Option<f64>,

    #[command(flatten)]
    pub frames: FrameArgs,
    #[command(flatten)]
    pub develop: DevelopArgs,
    #[command(flatten)]
    pub passes: PassArgs,
    #[command(flatten)]
    pub farm: FarmArgs,
    #[command(flatten)]
    pub scene_args: SceneArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

impl RenderArgs {
    /// The same as a job.
    ///
    /// # Errors
    /// When a name says no format, or layers are asked for that no file holds.
    pub fn job(&self) -> Result<Job, Failure> {
        let frame = self.frames.frames.as_ref().map(|frames| {
            frames.single().ok_or_else(|| {
                Failure::Input("one frame at a time here: give one, as in `--frames 12`".to_owned())
            })
        });
        self.job_of(frame.transpose()?, None)
    }

    /// Whether pictures of frames are asked for, each with a name of its own.
    pub fn is_film(&self) -> bool {
        let is_film = |path: &PathBuf| Film::is_one(path);
        self.frames.frames.is_some() || self.output.as_ref().is_some_and(is_film)
    }

    /// The picture of a frame as a job.
    ///
    /// * `output`: where it goes, if that is not to be what the command line says
    ///
    /// # Errors
    /// As for [`RenderArgs::job`].
    pub fn job_of(&self, frame: Option<i64>, output: Option<PathBuf>) -> Result<Job, Failure> {
        let load = LoadOptions {
            aspect: self.size.map(Size::aspect),
            frame,
            fps: self.frames.fps,
            ..self.scene_args.options()
        };
        let numbered = |path: PathBuf| match frame {
            Some(frame) => numbered(&path, frame),
            None => Ok(path),
        };
        let passes = PassArgs {
            checkpoint: self.passes.checkpoint.clone().map(numbered).transpose()?,
            ..self.passes.clone()
        };
        let mut outputs = self.outputs(output.or(self.output.clone()))?;
        for output in &mut outputs {
            if let Destination::File(path) = &mut output.destination {
                *path = numbered(std::mem::take(path))?;
            }
        }
        Ok(Job {
            scene: self.scene.clone(),
            load,
            defaults: Defaults::Modern,
            asked: self.settings(),
            crop: self.crop.as_deref().and_then(part),
            classic: None,
            outputs,
            diagrams: Vec::new(),
            depth: if self.bits == "16" { BitDepth::Sixteen } else { BitDepth::Eight },
            resources: self.run.resources(),
            keep_partial: self.run.keep_partial,
            passes,
            farm: self.farm.clone(),
            develop: self.develop.clone(),
            kept: Vec::new(),
            confined_to: None,
        })
    }

    fn settings(&self) -> Settings {
        Settings {
            size: self.size.map(|size| size.0),
            bounces: self.bounces,
            weight: self.weight,
            shadows: self.shadows,
            shadow_attenuation: self.transparent_shadows,
            shade_back: self.shade_back,
            samples: self.samples.map(|samples| (samples.0, samples.1)),
            filter: self.filter.map(|filter| filter.0),
            seed: self.seed,
            fresnel: self.fresnel,
            total_reflection: self.total_reflection,
            ray_offset: self.ray_offset,
            dialect: self.scene_args.dialect,
            texture_filter: self.scene_args.textures.texture_filter,
            depth_range: self.depth_range.as_ref().and_then(|range| range.as_slice().try_into().ok()),
            integrator: self.integrator,
            spectral: self.spectral,
            branches: self.branches,
            guiding: self.guiding,
            training: self.training,
            photons: self.photons,
            photon_map: self.photon_map,
            merging: self.merging,
            merge_radius: self.merge_radius.map(|radius| radius as f32),
            merge_alpha: self.merge_alpha.map(|alpha| alpha as f32),
            accuracy: self.accuracy.map(|accuracy| accuracy as f32),
            rays: self.rays,
            gradients: self.gradients,
            show_records: self.show_records,
            directions: self.directions,
            technique: self.technique,
            light_choice: self.light_choice,
            caustics: self.caustics,
            roulette: self.roulette,
            clamp: self.clamp.map(|clamp| clamp as f32),
            reach: self.reach.map(|reach| reach as f32),
            // Development is put over what the scene says once there is a picture.
            exposure: None,
            tone: None,
            white_balance: None,
        }
    }

    /// * `main`: where the picture goes, if that is said
    fn outputs(&self, main: Option<PathBuf>) -> Result<Vec<Output>, Failure> {
        let is_film = self.frames.frames.as_ref().is_some_and(|frames| frames.single().is_none());
        let main = match main {
            Some(path) if path.as_os_str() == "-" => Destination::StandardOutput,
            Some(path) => Destination::File(path),
            None if is_film => Destination::File(self.scene.with_extension("####.png")),
            None => Destination::File(beside(&self.scene)?),
        };
        let main = Output { format: main.format()?, destination: main, views: self.main_views() };
        if main.views.len() > 1 && main.format != Format::Exr {
            let message = "only an OpenEXR file (-o FILE.exr) holds several layers; give the others files of their own: --aov depth=FILE";
            return Err(Failure::Input(message.to_owned()));
        }
        let mut outputs = vec![main];
        for aov in &self.aov {
            if let Some(path) = &aov.path {
                let destination = Destination::File(path.clone());
                outputs.push(Output { format: destination.format()?, destination, views: vec![aov.view] });
            }
        }
        Ok(outputs)
    }

    /// What the main file shows: the layers asked for, or colour and the outputs without files of their own.
    fn main_views(&self) -> Vec<View> {
        let mut views = match self.layers.iter().any(|name| name == "all") {
            true => View::ALL.to_vec(),
            false => self.layers.iter().filter_map(|name| View::from_name(name)).collect(),
        };
        if views.is_empty() {
            views.push(View::Color);
        }
        for aov in self.aov.iter().filter(|aov| aov.path.is_none()) {
            views.push(aov.view);
        }
        let mut unique: Vec<View> = Vec::new();
        for view in views {
            if !unique.contains(&view) {
                unique.push(view);
            }
        }
        unique
    }
}

/// The part of a picture that four numbers say.
fn part(numbers: &[u32]) -> Option<Rect> {
    let &[x0, y0, width, height] = numbers else { return None };
    Some(Rect { x0, y0, x1: x0.saturating_add(width), y1: y0.saturating_add(height) })
}

/// `scene.png` for `scene.txt`.
fn beside(scene: &Path) -> Result<PathBuf, Failure> {
    let png = scene.with_extension("png");
    let is_scene = scene.extension().is_none_or(|ending| ending.eq_ignore_ascii_case("txt"));
    if !is_scene && png.exists() && !is_ours(&png) {
        // Textures and previews of models lie beside them, under the same name.
        return Err(Failure::Input(format!(
            "`{}` is there already, and not by kajo; name the picture with -o FILE",
            png.display()
        )));
    }
    if scene.file_stem().is_none() || png == *scene {
        return Err(Failure::Input(format!(
            "`{}` is no scene; name the picture with -o FILE",
            scene.display()
        )));
    }
    Ok(png)
}

/// Whether a PNG file says that this program wrote it.
fn is_ours(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(1024).read_to_end(&mut head));
    let mark = b"Software\0kajo";
    read.is_ok() && head.windows(mark.len()).any(|window| window == mark)
}
