//! The `kajo` command line.

mod args;
mod commands;
mod console;
mod failure;
mod farm;
mod film;
mod gallery;
mod guard;
mod interrupt;
mod job;
mod json;
mod keep;
mod output;
mod passes;
mod progress;
mod shortage;

use std::ffi::OsString;
use std::process::ExitCode;

use args::{Cli, Command};
use failure::Failure;
use interrupt::Interrupt;

fn main() -> ExitCode {
    ExitCode::from(guard::guarded(run))
}

fn run() -> Result<(), Failure> {
    let line: Vec<OsString> = std::env::args_os().collect();
    if line.len() < 2 {
        return commands::alone();
    }
    if let Some(words) = farm::words_for_python(&line) {
        return farm::hand_over(words);
    }
    let cli = match Cli::read(line) {
        Ok(cli) => cli,
        Err(error) => return said_by_clap(&error),
    };
    let interrupt = Interrupt::listen();
    match cli.command {
        Command::Render(args) if args.is_film() => commands::frames(&args, &interrupt),
        Command::Render(args) => commands::render(&args.job()?, &args.run, &interrupt),
        Command::Classic(args) => {
            args.warnings().for_each(|warning| console::warning(&warning));
            commands::render(&args.job()?, args.run(), &interrupt)
        }
        Command::Plan(args) => farm::plan(&args),
        Command::Unit(args) => farm::unit(&args, &interrupt),
        Command::Merge(args) => farm::merge(&args, &interrupt),
        Command::Worker(args) => farm::worker(&args),
        Command::Bundle(args) => farm::bundle(&args),
        Command::Farm(args) => farm::manage(&args),
        Command::Check(args) => commands::check(&args),
        Command::Info(args) => commands::info(&args),
        Command::Convert(args) => commands::convert(&args),
        Command::Btf(args) => commands::btf(&args.command),
        Command::Texture(args) => commands::texture(&args.command),
        Command::Diff(args) => commands::diff(&args),
        Command::Gallery(args) => gallery::run(&args, &interrupt),
        Command::Bench(args) => commands::bench(&args),
        Command::Selftest(args) => commands::selftest(&args),
        Command::Studio(args) => commands::studio(&args),
        Command::Completions(args) => commands::completions(args.shell),
        Command::Help(args) => commands::help(&args),
    }
}

/// Help and version are answers; everything else is a mistake in the command line.
fn said_by_clap(error: &clap::Error) -> Result<(), Failure> {
    let text = error.render().to_string();
    if console::printable(&text) == text {
        // The reader may have gone away.
        let _ = error.print();
    } else {
        console::line(text);
    }
    if error.use_stderr() { Err(Failure::Input(String::new())) } else { Ok(()) }
}
