//! `kajo convert`: the scene that shows a model, as a file to go on with.

use std::path::{Path, PathBuf};

use kajo::output::Target;
use kajo::{LoadOptions, ModelOptions, load, model_scene};

use crate::args::ConvertArgs;
use crate::console;
use crate::failure::Failure;

pub fn convert(args: &ConvertArgs) -> Result<(), Failure> {
    let path = args.scene.clone().unwrap_or_else(|| args.model.with_extension("txt"));
    let is_standard_output = path.as_os_str() == "-";
    let folder = if is_standard_output { args.model.parent() } else { path.parent() };
    let model = ModelOptions { up: args.model_args.up, ground: args.model_args.ground };
    let options = LoadOptions { model, ..LoadOptions::default() };
    let converted = model_scene(&args.model, folder.unwrap_or(Path::new("")), &options);
    let (scene, said) = converted.map_err(|error| Failure::Input(error.to_string()))?;
    said.iter().for_each(|warning| console::warning(warning));
    if is_standard_output {
        return console::answer(&scene.text);
    }
    let is_there = path.exists();
    let target = Target::check(&path, &if is_there { files_of(&args.model) } else { Vec::new() })?;
    if is_there && !args.force {
        let message = "is there already; `--force` writes over it, and another name beside it";
        return Err(Failure::Input(format!("`{}` {message}", path.display())));
    }
    target.write(scene.text.as_bytes())?;
    console::line(format!("{}: shows {}; `kajo {0}` renders it", path.display(), args.model.display()));
    Ok(())
}

/// The files that a model is read from.
fn files_of(model: &Path) -> Vec<PathBuf> {
    let mut files = load(model, &LoadOptions::default()).files;
    files.push(model.to_path_buf());
    files
}
