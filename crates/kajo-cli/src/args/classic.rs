//! `kajo -input ...`: the command line of the course program, and of its older relatives.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Args, FromArgMatches, parser::ValueSource};
use kajo::{
    BitDepth, Defaults, FilterChoice, Format, LoadOptions, MakeFilter, SamplerKind, Settings, Shadows, View,
};

use super::values::{self, Size};
use super::{DevelopArgs, FarmArgs, PassArgs, RunArgs, SceneArgs};
use crate::failure::Failure;
use crate::job::{ClassicWords, Diagram, DiagramKind, Job};
use crate::output::{Destination, Output};

/// Options of older programs that mean nothing here, and how many values each has.
const MEANINGLESS: [(&str, usize); 12] = [
    ("curve_tessellation", 1),
    ("draw_vectors", 1),
    ("dt", 1),
    ("gouraud", 0),
    ("grid", 3),
    ("gui", 0),
    ("integrator_color", 0),
    ("motion_blur", 0),
    ("patch_tessellation", 1),
    ("refresh", 1),
    ("revolution_tessellation", 1),
    ("tessellation", 2),
];

/// Options of older programs that ask for something that there is not here, with how many values each has and why not.
const REFUSED: [(&str, usize, &str); 3] = [
    ("output_bezier", 1, "there are no curves here to be written"),
    ("output_bspline", 1, "there are no curves here to be written"),
    ("visualize_grid", 0, "rays find their way by a tree of boxes here, and there is no grid to be shown"),
];

const SAMPLE_OPTIONS: [&str; 4] =
    ["uniform_samples", "regular_samples", "jittered_samples", "random_samples"];
const FILTER_OPTIONS: [&str; 5] =
    ["box_filter", "tent_filter", "gaussian_filter", "mitchell_filter", "lanczos_filter"];

/// The classic command line, meaningless options included.
#[derive(Debug)]
pub struct ClassicArgs {
    known: KnownArgs,
    /// Meaningless options that were given.
    ignored: Vec<&'static str>,
    /// The first of the refused ones that was given, and why it is refused.
    refused: Option<(&'static str, &'static str)>,
}

/// The options that do something. Each may be written with one dash; the last of several wins.
#[derive(Args, Debug)]
#[command(next_help_heading = "Classic options (one dash is enough)")]
struct KnownArgs {
    /// The scene
    #[arg(long, value_name = "SCENE", required = true)]
    input: PathBuf,
    /// The picture; without it no colours are written
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Distances shown as white and as black, and the depth picture
    #[arg(long, value_names = ["MIN", "MAX", "FILE"], num_args = 3, allow_negative_numbers = true)]
    depth: Option<Vec<std::ffi::OsString>>,
    /// The picture of the normals
    #[arg(long, value_name = "FILE")]
    normals: Option<PathBuf>,
    /// Width and height in pixels [default: 100 100]
    #[arg(long, value_name = "W H")]
    size: Option<Size>,
    /// Show each pixel's coordinates instead of the scene
    #[arg(long)]
    uv: bool,
    /// How many times in a row a ray may be mirrored or refracted [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(kajo::MAX_BOUNCES)))]
    bounces: Option<u32>,
    /// End a branch when it counts for less than this [default: 0]
    #[arg(long, value_name = "W", value_parser = values::weight)]
    weight: Option<f32>,
    /// Objects hide lights
    #[arg(long)]
    shadows: bool,
    /// Objects hide lights, but glass lets light through
    #[arg(long = "transparent_shadows")]
    transparent_shadows: bool,
    /// Light the back sides of surfaces too
    #[arg(long = "shade_back")]
    shade_back: bool,
    /// N rays at random for each pixel (on a grid in dialect mit-2004)
    #[arg(long = "uniform_samples", value_name = "N", overrides_with_all = SAMPLE_OPTIONS, value_parser = samples())]
    uniform_samples: Option<u32>,
    /// N rays on a grid for each pixel [default: 1]
    #[arg(long = "regular_samples", value_name = "N", overrides_with_all = SAMPLE_OPTIONS, value_parser = samples())]
    regular_samples: Option<u32>,
    /// N rays for each pixel, one at random in each cell of a grid
    #[arg(long = "jittered_samples", value_name = "N", overrides_with_all = SAMPLE_OPTIONS, value_parser = samples())]
    jittered_samples: Option<u32>,
    /// N rays at random for each pixel, in every dialect
    #[arg(long = "random_samples", value_name = "N", overrides_with_all = SAMPLE_OPTIONS, value_parser = samples())]
    random_samples: Option<u32>,
    /// Average over a square of this radius in pixels
    #[arg(long = "box_filter", value_name = "R", overrides_with_all = FILTER_OPTIONS, value_parser = values::filter_width)]
    box_filter: Option<f32>,
    /// Weigh rays by a pyramid of this radius in pixels
    #[arg(long = "tent_filter", value_name = "R", overrides_with_all = FILTER_OPTIONS, value_parser = values::filter_width)]
    tent_filter: Option<f32>,
    /// Weigh rays by a Gaussian of this standard deviation in pixels
    #[arg(long = "gaussian_filter", value_name = "SIGMA", overrides_with_all = FILTER_OPTIONS, value_parser = values::filter_width)]
    gaussian_filter: Option<f32>,
    /// Weigh rays by the cubic of Mitchell and Netravali
    #[arg(long = "mitchell_filter", value_name = "R", overrides_with_all = FILTER_OPTIONS, value_parser = values::filter_width)]
    mitchell_filter: Option<f32>,
    /// Weigh rays by a windowed sinc
    #[arg(long = "lanczos_filter", value_name = "R", overrides_with_all = FILTER_OPTIONS, value_parser = values::filter_width)]
    lanczos_filter: Option<f32>,
    /// Three by three rays for each pixel, each anywhere in its ninth
    #[arg(long)]
    jitter: bool,
    /// Three by three rays for each pixel, weighed by 1 2 1 across and down
    #[arg(long)]
    filter: bool,
    /// A picture of where the samples lie, each pixel ZOOM times as large
    #[arg(long = "render_samples", value_names = ["FILE", "ZOOM"], num_args = 2)]
    render_samples: Option<Vec<std::ffi::OsString>>,
    /// A picture of the filter's shape, each pixel ZOOM times as large
    #[arg(long = "render_filter", value_names = ["FILE", "ZOOM"], num_args = 2)]
    render_filter: Option<Vec<std::ffi::OsString>>,
    /// Weaken highlights at grazing light; dialect mit-2004 only
    #[arg(long = "specular_fix")]
    specular_fix: bool,
    /// Seed of the random numbers
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    scene_args: SceneArgs,
    #[command(flatten)]
    run: RunArgs,
}

fn samples() -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(0..=Settings::MAX_SAMPLES.into())
}

impl Args for ClassicArgs {
    fn augment_args(command: clap::Command) -> clap::Command {
        let refused = REFUSED.map(|(name, values, _)| (name, values));
        let hidden = MEANINGLESS.into_iter().chain(refused).map(|(name, values)| {
            let arg = Arg::new(name).long(name).hide(true);
            match values {
                0 => arg.action(clap::ArgAction::SetTrue),
                n => arg.num_args(n).allow_negative_numbers(true),
            }
        });
        KnownArgs::augment_args(command).args(hidden)
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        ClassicArgs::augment_args(command)
    }
}

impl FromArgMatches for ClassicArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<ClassicArgs, clap::Error> {
        let given = |name: &&str| matches.value_source(name) == Some(ValueSource::CommandLine);
        let ignored = MEANINGLESS.into_iter().map(|(name, _)| name).filter(given).collect();
        let refused = REFUSED.into_iter().find(|(name, ..)| given(name)).map(|(name, _, why)| (name, why));
        Ok(ClassicArgs { known: KnownArgs::from_arg_matches(matches)?, ignored, refused })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = ClassicArgs::from_arg_matches(matches)?;
        Ok(())
    }
}

impl ClassicArgs {
    /// How the render is run.
    pub fn run(&self) -> &RunArgs {
        &self.known.run
    }

    /// What to say about options that do nothing.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.ignored
            .iter()
            .map(|name| format!("`-{name}` belongs to an older program and means nothing here"))
    }

    /// The same as a job.
    ///
    /// # Errors
    /// When a name says no format, a depth or a zoom is no number, or an option asks for what there is not.
    pub fn job(&self) -> Result<Job, Failure> {
        if let Some((name, why)) = self.refused {
            return Err(Failure::Input(format!("`-{name}` cannot be done: {why}")));
        }
        let known = &self.known;
        let (depth_range, depth_file) = known.depth()?;
        let files =
            [(&known.output, View::Color), (&depth_file, View::Depth), (&known.normals, View::Normals)];
        let outputs = files.into_iter().filter_map(|(path, view)| Some((path.clone()?, view)));
        let outputs: Result<Vec<Output>, Failure> = outputs
            .map(|(path, view)| {
                let destination = Destination::File(path);
                Ok(Output { format: destination.format()?, destination, views: vec![view] })
            })
            .collect();
        let outputs = outputs?;
        if (known.jitter || known.filter) && outputs.iter().any(|output| output.format == Format::Exr) {
            let message = "pictures made of three by three rays for each pixel are no OpenEXR files";
            return Err(Failure::Input(format!(
                "{message}; choose another format for `-jitter` and `-filter`"
            )));
        }
        Ok(Job {
            scene: known.input.clone(),
            load: LoadOptions { aspect: known.size.map(Size::aspect), ..known.scene_args.options() },
            defaults: Defaults::Classic,
            asked: known.settings(depth_range),
            crop: None,
            classic: Some(ClassicWords {
                uv: known.uv,
                specular_fix: known.specular_fix,
                uniform_samples: known.uniform_samples.is_some(),
                jitter: known.jitter,
                filter: known.filter,
            }),
            outputs,
            diagrams: known.diagrams()?,
            depth: BitDepth::Eight,
            resources: known.run.resources(),
            keep_partial: known.run.keep_partial,
            passes: PassArgs::default(),
            farm: FarmArgs::default(),
            develop: DevelopArgs::default(),
            kept: Vec::new(),
            confined_to: None,
        })
    }
}

impl KnownArgs {
    fn diagrams(&self) -> Result<Vec<Diagram>, Failure> {
        let asked = [
            ("render_samples", &self.render_samples, DiagramKind::Samples),
            ("render_filter", &self.render_filter, DiagramKind::Filter),
        ];
        let mut diagrams = Vec::new();
        for (option, values, kind) in asked {
            let Some([file, zoom]) = values.as_deref() else { continue };
            let text = zoom.to_string_lossy();
            let Some(zoom) = text.parse().ok().filter(|zoom| (1..=values::MAX_ZOOM).contains(zoom)) else {
                let most = values::MAX_ZOOM;
                let message = format!("expected a whole number from 1 to {most}, found `{text}`");
                return Err(Failure::Input(format!("`-{option} FILE ZOOM`: {message}")));
            };
            let path = PathBuf::from(file);
            let format = Destination::File(path.clone()).format()?;
            diagrams.push(Diagram { kind, zoom, path, format });
        }
        Ok(diagrams)
    }

    fn depth(&self) -> Result<(Option<[f32; 2]>, Option<PathBuf>), Failure> {
        let Some([min, max, file]) = self.depth.as_deref() else { return Ok((None, None)) };
        let number = |text: &std::ffi::OsString| {
            values::finite(&text.to_string_lossy()).map_err(|problem| {
                Failure::Input(format!("`-depth MIN MAX FILE`: {problem}, found `{}`", text.display()))
            })
        };
        Ok((Some([number(min)?, number(max)?]), Some(PathBuf::from(file))))
    }

    fn settings(&self, depth_range: Option<[f32; 2]>) -> Settings {
        let shadows = match (self.transparent_shadows, self.shadows) {
            (true, _) => Some(Shadows::Transparent),
            (false, true) => Some(Shadows::Opaque),
            (false, false) => None,
        };
        let samples = [
            (self.uniform_samples, SamplerKind::Uniform),
            (self.regular_samples, SamplerKind::Regular),
            (self.jittered_samples, SamplerKind::Jittered),
            (self.random_samples, SamplerKind::Uniform),
        ];
        let filters: [(Option<f32>, MakeFilter); 5] = [
            (self.box_filter, FilterChoice::Box),
            (self.tent_filter, FilterChoice::Tent),
            (self.gaussian_filter, FilterChoice::Gaussian),
            (self.mitchell_filter, FilterChoice::Mitchell),
            (self.lanczos_filter, FilterChoice::Lanczos),
        ];
        Settings {
            size: self.size.map(|size| size.0),
            bounces: self.bounces,
            weight: self.weight,
            shadows,
            shade_back: self.shade_back.then_some(true),
            samples: samples.into_iter().find_map(|(n, kind)| Some((kind, n?))),
            filter: filters.into_iter().find_map(|(width, make)| width.map(make)),
            seed: self.seed,
            dialect: self.scene_args.dialect,
            depth_range,
            ..Settings::default()
        }
    }
}
