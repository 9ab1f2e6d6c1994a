//! `kajo btf`: bidirectional texture functions.

use std::path::Path;

use kajo::LoadOptions;
use kajo::btf::{
    self, BtfEncoding, BtfError, BtfSamples, Compression, FolderError, MakeError, Making, write_btf,
};
use kajo::output::Target;

use crate::args::{BtfCommand, BtfCompressArgs, BtfInfoArgs, BtfKeptArgs, BtfMakeArgs};
use crate::console;
use crate::failure::Failure;

pub fn btf(command: &BtfCommand) -> Result<(), Failure> {
    match command {
        BtfCommand::Make(args) => make(args),
        BtfCommand::Compress(args) => compress(args),
        BtfCommand::Info(args) => info(args),
    }
}

fn make(args: &BtfMakeArgs) -> Result<(), Failure> {
    let target = Target::check(&args.kept.output, std::slice::from_ref(&args.scene))?;
    let BtfMakeArgs { side, rings, samples, length, .. } = *args;
    let making = Making { side, rings, samples, corner: [args.corner[0], args.corner[1]], length };
    let options: LoadOptions = args.scene_args.options();
    let samples = btf::make(&args.scene, &options, &making, |_, _| {}).map_err(|error| match error {
        MakeError::Render(error) => error.into(),
        MakeError::Memory(over) => Failure::Memory(over.to_string()),
        other => Failure::Input(other.to_string()),
    })?;
    write(&samples, &args.kept, &target)
}

fn compress(args: &BtfCompressArgs) -> Result<(), Failure> {
    let target = Target::check(&args.kept.output, std::slice::from_ref(&args.measured))?;
    let memory = LoadOptions::default().budgeted().memory;
    let samples = if args.measured.is_dir() {
        btf::read_folder(&args.measured, args.side, &memory, |_, _| {}).map_err(|error| match error {
            FolderError::Memory(over) => Failure::Memory(over.to_string()),
            other => Failure::Input(other.to_string()),
        })?
    } else {
        btf::read_ubo2014(&args.measured, args.side, &memory)
            .map_err(|error| unreadable(&args.measured, error))?
    };
    write(&samples, &args.kept, &target)
}

fn unreadable(path: &Path, error: BtfError) -> Failure {
    let text = format!("cannot read `{}`: {error}", path.display());
    if matches!(error, BtfError::Memory(_)) { Failure::Memory(text) } else { Failure::Input(text) }
}

/// Compresses samples, and says how much of them is left.
fn write(samples: &BtfSamples, kept: &BtfKeptArgs, target: &Target) -> Result<(), Failure> {
    let BtfKeptArgs { clusters, components, float, .. } = *kept;
    let file = btf::compress(samples, &Compression { clusters, components });
    let encoding = if float { BtfEncoding::Float } else { BtfEncoding::Half };
    let bytes = write_btf(&file, encoding);
    target.write(&bytes)?;
    console::line(format!(
        "{}: {} x {} texels, {} views, {} lights, {} bytes",
        kept.output.display(),
        file.size[0],
        file.size[1],
        file.views.len(),
        file.lights.len(),
        bytes.len()
    ));
    Ok(())
}

fn info(args: &BtfInfoArgs) -> Result<(), Failure> {
    let (file, encoding) = btf::read_file(&args.file).map_err(|error| unreadable(&args.file, error))?;
    let levels = file.levels().len();
    let values = if encoding == BtfEncoding::Half { "halves" } else { "floats" };
    let cosine =
        if file.has_cosine { "with the cosine of the light" } else { "without the cosine of the light" };
    console::answer(&format!(
        "texels      {} x {}, {levels} levels\nviews       {}\nlights      {}\nclusters    {}\ncomponents  {}\nvalues      \
         {values}, {cosine}\n",
        file.size[0],
        file.size[1],
        file.views.len(),
        file.lights.len(),
        file.cluster_count(),
        file.components
    ))
}
