//! Looks whether another program has written the files of the scene.
//!
//! A thread asks for the time and length of each file a few times a second: that works on every file system, the
//! shared ones included, and a file that is replaced, as editors do to save, is seen like one that is written.
//! A change is told once it has been still for one look, so that a file half written is not read.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, SystemTime};

/// Time between two looks.
const PAUSE: Duration = Duration::from_millis(200);

/// Tells when files change. Dropping it ends its thread.
pub struct Watch {
    files: Sender<(Vec<PathBuf>, Vec<Stamp>)>,
    changes: Receiver<()>,
}

/// What is seen of a file without opening it; `None` where it is missing.
type Stamp = Option<(SystemTime, u64)>;

impl Watch {
    /// Begins to look; `wake` is called, by another thread, when there is something to tell.
    pub fn new(wake: impl Fn() + Send + 'static) -> Watch {
        let (files, new_files) = mpsc::channel();
        let (tell, changes) = mpsc::channel();
        thread::spawn(move || look(&new_files, &tell, &wake));
        Watch { files, changes }
    }

    /// Looks at these files from now on, as they are at this moment.
    pub fn set(&self, files: Vec<PathBuf>) {
        // What is written from here on is told, whenever the thread comes to it, which lives as long as this sender.
        let now = stamps(&files);
        let _ = self.files.send((files, now));
        while self.changes.try_recv().is_ok() {}
    }

    /// Whether a file has changed since the last call.
    pub fn changed(&self) -> bool {
        let mut any = false;
        while self.changes.try_recv().is_ok() {
            any = true;
        }
        any
    }
}

fn look(new_files: &Receiver<(Vec<PathBuf>, Vec<Stamp>)>, tell: &Sender<()>, wake: &impl Fn()) {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut told: Vec<Stamp> = Vec::new();
    let mut last: Vec<Stamp> = Vec::new();
    loop {
        match new_files.recv_timeout(PAUSE) {
            Ok((list, then)) => {
                files = list;
                last.clone_from(&then);
                told = then;
            }
            Err(RecvTimeoutError::Timeout) => {
                let now = stamps(&files);
                // A file that is missing is one being replaced.
                let settled = now == last && now.iter().all(Option::is_some);
                if settled && now != told {
                    told.clone_from(&now);
                    if tell.send(()).is_err() {
                        return;
                    }
                    wake();
                }
                last = now;
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

fn stamps(files: &[PathBuf]) -> Vec<Stamp> {
    let stamp = |path: &PathBuf| stamp(path);
    files.iter().map(stamp).collect()
}

fn stamp(path: &Path) -> Stamp {
    let about = fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Arc, Mutex, PoisonError};

    /// Waits until `done`, for as long as it takes.
    fn wait(done: impl Fn() -> bool) {
        while !done() {
            thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn writing_and_replacing_a_file_are_seen_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let [scene, other] = ["scene.txt", "other.txt"].map(|name| folder.path().join(name));
        fs::write(&scene, "a").unwrap();
        let woken = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&woken);
        let watch = Watch::new(move || {
            counter.fetch_add(1, Ordering::SeqCst);
        });
        watch.set(vec![scene.clone()]);
        thread::sleep(PAUSE / 2);
        fs::write(&scene, "ab").unwrap();
        wait(|| woken.load(Ordering::SeqCst) == 1);
        assert!(watch.changed() && !watch.changed());
        fs::write(&other, "abc").unwrap();
        fs::rename(&other, &scene).unwrap();
        wait(|| woken.load(Ordering::SeqCst) == 2);
        assert!(watch.changed());
        fs::write(&other, "not watched").unwrap();
        thread::sleep(3 * PAUSE);
        assert!(!watch.changed());
    }

    #[test]
    fn the_thread_ends_with_the_watch() {
        struct Ends(Arc<Mutex<bool>>);
        impl Drop for Ends {
            fn drop(&mut self) {
                *self.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
            }
        }
        let ended = Arc::new(Mutex::new(false));
        let ends = Ends(Arc::clone(&ended));
        drop(Watch::new(move || {
            let _ = &ends;
        }));
        wait(|| *ended.lock().unwrap());
    }
}
