//! `kajo texture`: tiled copies of pictures.

use kajo::TextureFolder;

use crate::args::{TextureCommand, TextureFolderArgs, TextureMakeArgs};
use crate::console;
use crate::failure::Failure;

pub fn texture(command: &TextureCommand) -> Result<(), Failure> {
    match command {
        TextureCommand::Make(args) => make(args),
        TextureCommand::List(args) => list(args),
        TextureCommand::Clear(args) => clear(args),
    }
}

fn folder(args: &TextureFolderArgs) -> Result<TextureFolder, Failure> {
    let none = || Failure::Input("there is no folder for tiled copies; say --texture-folder".to_owned());
    args.folder(None).ok_or_else(none)
}

fn make(args: &TextureMakeArgs) -> Result<(), Failure> {
    let folder = folder(&args.folder)?;
    let mut failed = 0;
    for picture in &args.pictures {
        match folder.make(picture, args.encoding) {
            Ok([width, height]) => console::line(format!("{}: {width} x {height}", picture.display())),
            Err(reason) => {
                failed += 1;
                console::error(&format!("cannot make a copy of `{}`: {reason}", picture.display()));
            }
        }
    }
    // What is wrong has been said.
    if failed > 0 { Err(Failure::Input(String::new())) } else { Ok(()) }
}

fn list(args: &TextureFolderArgs) -> Result<(), Failure> {
    let folder = folder(args)?;
    let files = folder.files().map_err(|error| unreadable(&folder, &error))?;
    let mut text = format!("{}\n", folder.folder.display());
    for (path, bytes) in &files {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        text += &format!("{bytes:>14}  {name}\n");
    }
    text += &format!("{:>14}  bytes in all\n", files.iter().map(|(_, bytes)| bytes).sum::<u64>());
    console::answer(&text)
}

fn clear(args: &TextureFolderArgs) -> Result<(), Failure> {
    let folder = folder(args)?;
    let (count, bytes) = folder.clear().map_err(|error| unreadable(&folder, &error))?;
    console::line(format!("{}: {count} tiled copies removed, {bytes} bytes", folder.folder.display()));
    Ok(())
}

fn unreadable(folder: &TextureFolder, error: &std::io::Error) -> Failure {
    Failure::Input(format!("cannot change `{}`: {error}", folder.folder.display()))
}
