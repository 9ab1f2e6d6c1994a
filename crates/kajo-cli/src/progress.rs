//! How far the loading of a scene and its render are, shown to whoever is there to see it.

use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use kajo::{LoadProgress, LoadStep, Progress};

use crate::console;
use crate::interrupt::Interrupt;

/// Shows progress in one of three ways.
pub enum Meter {
    /// Not at all.
    Silent,
    /// A bar that moves, with rays a second and the time left.
    Bar { bar: ProgressBar, rays: Arc<AtomicU64> },
    /// A line at the start and after each tenth, where there is no terminal.
    Lines { next_tenth: AtomicU64 },
}

/// A meter that also knows whether to stop.
pub struct Watched<'a> {
    meter: &'a Meter,
    interrupt: &'a Interrupt,
}

impl Meter {
    /// A bar on a terminal; elsewhere nothing, or lines if they are asked for.
    pub fn new(quiet: bool, forced: bool) -> Meter {
        match (io::stderr().is_terminal(), quiet && !forced) {
            (_, true) => Meter::Silent,
            (true, false) => Meter::bar(),
            (false, false) if forced => Meter::Lines { next_tenth: AtomicU64::new(0) },
            (false, false) => Meter::Silent,
        }
    }

    fn bar() -> Meter {
        let rays = Arc::new(AtomicU64::new(0));
        let (cast, start) = (Arc::clone(&rays), Instant::now());
        let rate = move |_: &ProgressState, text: &mut dyn Write| {
            let seconds = start.elapsed().as_secs_f64().max(1e-3);
            let _ = write!(text, "{} rays/s", in_short(cast.load(Ordering::Relaxed) as f64 / seconds));
        };
        let style = ProgressStyle::with_template("{bar:32} {percent:>3} %  {rate}  {eta} left  {wide_msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .with_key("rate", rate);
        Meter::Bar { bar: ProgressBar::no_length().with_style(style), rays }
    }

    /// Progress callback of the loading: a bar for long files, on a terminal. It goes when it is dropped.
    pub fn loading(&self) -> Option<Arc<dyn LoadProgress>> {
        match self {
            Meter::Bar { .. } => Some(Arc::new(LoadBar::new())),
            Meter::Silent | Meter::Lines { .. } => None,
        }
    }

    /// The same, stoppable.
    pub fn watched<'a>(&'a self, interrupt: &'a Interrupt) -> Watched<'a> {
        Watched { meter: self, interrupt }
    }

    /// Something to stand beside the bar.
    pub fn tell(&self, text: &str) {
        if let Meter::Bar { bar, .. } = self {
            bar.set_message(kajo::printable(text));
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Meter::Bar { bar, .. } = self {
            bar.finish_and_clear();
        }
    }
}

impl Progress for Watched<'_> {
    fn done(&self, pixels_done: u64, pixels_total: u64, rays: u64) {
        match self.meter {
            Meter::Silent => {}
            Meter::Bar { bar, rays: cast } => {
                cast.fetch_max(rays, Ordering::Relaxed);
                if bar.length() != Some(pixels_total) {
                    bar.set_length(pixels_total);
                }
                bar.set_position(pixels_done);
            }
            Meter::Lines { next_tenth } => {
                let tenth = pixels_done * 10 / pixels_total.max(1);
                if next_tenth.fetch_max(tenth + 1, Ordering::Relaxed) <= tenth {
                    console::line(format_args!("{} %, {} rays", tenth * 10, in_short(rays as f64)));
                }
            }
        }
    }

    fn cancelled(&self) -> bool {
        self.interrupt.is_stopping()
    }

    fn note(&self, sentence: &str) {
        match self.meter {
            Meter::Bar { bar, .. } => bar.suspend(|| console::warning(sentence)),
            Meter::Silent | Meter::Lines { .. } => console::warning(sentence),
        }
    }
}

/// A bar that shows the reading of long files and the building of large trees.
#[derive(Debug)]
struct LoadBar {
    bar: ProgressBar,
}

impl LoadBar {
    /// Shorter files are read before anybody could read the bar.
    const LONG_FILE: u64 = 32 << 20;
    const LARGE_MESH: usize = 1_000_000;

    fn new() -> LoadBar {
        let style = ProgressStyle::with_template("{bar:32} {percent:>3} %  {msg}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        LoadBar { bar: ProgressBar::no_length().with_style(style) }
    }
}

impl LoadProgress for LoadBar {
    fn step(&self, step: LoadStep<'_>) {
        match step {
            LoadStep::Reading { path, done, total } if total >= Self::LONG_FILE => {
                if self.bar.length() != Some(total) {
                    self.bar.set_message(format!("reading {}", kajo::printable(path)));
                    self.bar.set_length(total);
                }
                self.bar.set_position(done);
            }
            LoadStep::Building { path, triangles } if triangles >= Self::LARGE_MESH => {
                let triangles = in_short(triangles as f64);
                let path = kajo::printable(path);
                self.bar.set_message(format!("{triangles} triangles of {path} are being sorted"));
                self.bar.tick();
            }
            _ => {}
        }
    }
}

impl Drop for LoadBar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// 7,900,000 as "7.9 M".
pub fn in_short(count: f64) -> String {
    match count {
        count if count < 1e3 => format!("{count:.0}"),
        count if count < 1e6 => format!("{:.1} k", count / 1e3),
        count if count < 1e9 => format!("{:.1} M", count / 1e6),
        count => format!("{:.1} G", count / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_files_move_the_bar() {
        let load = LoadBar::new();
        load.step(LoadStep::Reading { path: "a", done: 5, total: 10 });
        assert_eq!(load.bar.length(), None);
        load.step(LoadStep::Reading { path: "a", done: 5, total: LoadBar::LONG_FILE });
        assert_eq!((load.bar.length(), load.bar.position()), (Some(LoadBar::LONG_FILE), 5));
        assert_eq!(load.bar.message(), "reading a");
    }

    #[test]
    fn counts_are_short() {
        assert_eq!(in_short(999.0), "999");
        assert_eq!(in_short(7_900_000.0), "7.9 M");
        assert_eq!(in_short(1.25e10), "12.5 G");
    }
}
