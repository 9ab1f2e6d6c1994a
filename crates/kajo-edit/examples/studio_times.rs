//! How long a window has to wait: for triangles to draw, for the first traced picture, for a render to stop.
//!
//! ```text
//! cargo run --release -p kajo-edit --example studio_times -- scenes/gallery/cornell.txt 960 540
//! ```

use std::error::Error;
use std::io::{self, Write};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use kajo::session::{Job, Session};
use kajo::{Defaults, LoadOptions, RenderSettings, Settings, load};
use kajo_edit::preview::Preview;

fn main() -> Result<(), Box<dyn Error>> {
    match measure(&mut io::stdout()) {
        // Whoever reads has read enough.
        Err(error) if is_closed_pipe(&*error) => Ok(()),
        result => result,
    }
}

fn is_closed_pipe(error: &(dyn Error + 'static)) -> bool {
    error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

fn measure(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("which scene?")?;
    let size: Vec<u32> = args.map(|arg| arg.parse()).collect::<Result<_, _>>()?;
    let size = <[u32; 2]>::try_from(size).ok();

    let loaded = load(path.as_ref(), &LoadOptions::default());
    let Some(scene) = loaded.scene.as_ref() else { return Err(loaded.report(false).into()) };
    let start = Instant::now();
    let preview = Preview::of(scene);
    writeln!(out, "{:8.2} ms  preview of {} triangles", ms(start.elapsed()), preview.triangle_count())?;

    let asked = Settings { size, ..Settings::default() };
    let settings = RenderSettings::resolve(scene, &asked, Defaults::Modern, false)?;
    let scene = Arc::new(loaded.scene.ok_or("there was one")?);
    let (sender, frames) = mpsc::channel();
    let session = Session::new(0, move || {
        // The program may have ended.
        let _ = sender.send(Instant::now());
    });

    // A picture that was being rendered gives way to the next, as it does while one flies about.
    for round in ["from rest", "while another one is rendered"] {
        let start = Instant::now();
        let job = session.start(Job::new(Arc::clone(&scene), settings).without_end());
        writeln!(out, "{:8.2} ms  call that starts a render, {round}", ms(start.elapsed()))?;
        loop {
            let when = frames.recv()?;
            let Some(frame) = session.frame().filter(|frame| frame.job() == job) else { continue };
            let [width, height] = frame.size();
            writeln!(out, "{:8.2} ms  {width} x {height}, {} samples", ms(when - start), frame.samples())?;
            if frame.samples() >= 4 {
                break;
            }
        }
    }

    // In the middle of a pass.
    std::thread::sleep(Duration::from_millis(20));
    let start = Instant::now();
    session.cancel();
    writeln!(out, "{:8.2} ms  call that cancels", ms(start.elapsed()))?;
    drop(session);
    writeln!(out, "{:8.2} ms  until nothing runs any more", ms(start.elapsed()))?;
    Ok(())
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
