//! Files in the making: `.kajo-*.part`, beside the files that they will become.
//!
//! Whoever writes a part holds a lock on it until it has its name. The system drops the lock when the process ends, in
//! whichever way, so a part that nobody has locked belongs to nobody: [`clear`] removes it.
//!
//! On some network folders one machine does not hear of the locks of another. So the name of a part says which run of
//! the operating system it was made under, and a part of another one is left alone for as long as somebody may still
//! be writing it: until [`ABANDONED`] after its last change, by the folder's own clock. A writer that was asleep for
//! longer finds its part gone and writes it again.

use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::time::{Duration, SystemTime};

use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".kajo-";
const SUFFIX: &str = ".part";

/// How long a part of another machine must have stayed as it is to be removed.
const ABANDONED: Duration = Duration::from_secs(600);

/// A file in the making, locked. It goes when it is dropped.
pub(super) struct Part(NamedTempFile);

impl Part {
    /// An empty one, with the rights that new files have.
    pub fn create(folder: &Path) -> io::Result<Part> {
        /// Somebody who clears the folder may take a part in the moment before it is locked.
        const ATTEMPTS: usize = 16;
        let prefix = format!("{PREFIX}{}-", system());
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(SUFFIX);
        with_usual_rights(&mut builder);
        for _ in 0..ATTEMPTS {
            let part = builder.tempfile_in(folder).map_err(without_name)?;
            match part.as_file().try_lock() {
                Ok(()) if part.path().symlink_metadata().is_ok() => return Ok(Part(part)),
                Ok(()) | Err(TryLockError::WouldBlock) => {}
                // There are no locks here: others go by its age.
                Err(TryLockError::Error(_)) => return Ok(Part(part)),
            }
        }
        Err(io::Error::other("files in the making are removed by another process"))
    }

    pub fn file(&self) -> &File {
        self.0.as_file()
    }

    /// Gives it its name, in place of what had it before.
    pub fn rename(self, to: &Path) -> io::Result<()> {
        self.0.persist(to).map(drop).map_err(|error| error.error)
    }
}

/// Removes the parts in the folder that no living process owns.
///
/// * `own`: one that was just made there
pub(super) fn clear(folder: &Path, own: &Part) {
    let now = own.file().metadata().and_then(|metadata| metadata.modified()).ok();
    let Ok(entries) = fs::read_dir(folder) else { return };
    let system = system();
    for entry in entries.flatten() {
        let Some(made_here) = made_here(&entry.file_name(), &system) else { continue };
        // Neither a link nor a pipe is ours, and a pipe would keep us waiting.
        if entry.file_type().is_ok_and(|kind| kind.is_file()) {
            remove_abandoned(&entry.path(), made_here, now);
        }
    }
}

fn remove_abandoned(path: &Path, made_here: bool, now: Option<SystemTime>) {
    let Ok(file) = File::options().read(true).write(true).open(path) else { return };
    let is_abandoned = match file.try_lock() {
        Ok(()) => made_here || is_old(&file, now),
        Err(TryLockError::WouldBlock) => false,
        Err(TryLockError::Error(_)) => is_old(&file, now),
    };
    if is_abandoned {
        // The lock is held, so nobody takes it for theirs meanwhile. It may be somebody else's to remove.
        let _ = fs::remove_file(path);
    }
}

fn is_old(file: &File, now: Option<SystemTime>) -> bool {
    let changed = file.metadata().and_then(|metadata| metadata.modified()).ok();
    changed.zip(now).and_then(|(then, now)| now.duration_since(then).ok()).is_some_and(|age| age >= ABANDONED)
}

/// Whether a part of this name was made under the system that is named; `None` for what is no part.
fn made_here(name: &OsStr, system: &str) -> Option<bool> {
    let middle = name.to_str()?.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
    Some(middle.split_once('-').is_some_and(|(made_under, _)| made_under == system))
}

/// A word for the run of the operating system that this is. Where it does not tell, locks must do.
fn system() -> String {
    let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let digits: String = id.chars().filter(char::is_ascii_hexdigit).take(8).collect();
    if digits.is_empty() { "here".to_owned() } else { digits }
}

/// Temporary files are for their owner alone unless one says otherwise.
pub(super) fn with_usual_rights(builder: &mut Builder<'_, '_>) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    #[cfg(not(unix))]
    let _ = builder;
}

/// The error without the name of the temporary file, which means nothing to anybody.
pub(super) fn without_name(error: io::Error) -> io::Error {
    match (error.raw_os_error(), error.kind()) {
        (Some(code), _) => io::Error::from_raw_os_error(code),
        (None, ErrorKind::NotFound) => io::Error::new(ErrorKind::NotFound, "its folder is gone"),
        (None, kind) => kind.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn clear_from_outside(folder: &Path) {
        clear(folder, &Part::create(folder).unwrap());
    }

    #[test]
    fn only_parts_without_an_owner_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let living = Part::create(folder.path()).unwrap();
        let left = format!("{PREFIX}{}-abc123{SUFFIX}", system());
        fs::write(path(&left), "left by a process that was killed").unwrap();
        fs::write(path(".kajo-notes.txt"), "no part").unwrap();
        fs::create_dir(path(&format!("{PREFIX}{}-folder{SUFFIX}", system()))).unwrap();
        clear_from_outside(folder.path());
        assert!(living.0.path().exists());
        assert!(!path(&left).exists());
        assert_eq!(names(folder.path()).len(), 3);
        living.rename(&path("done")).unwrap();
        assert!(path("done").exists());
    }

    #[test]
    fn parts_of_other_machines_go_when_they_are_old() {
        let folder = tempfile::tempdir().unwrap();
        // The second is what earlier versions called them.
        let others = [".kajo-0badcafe-abc123.part", ".kajo-abc123.part"].map(|name| folder.path().join(name));
        others.iter().for_each(|path| fs::write(path, "").unwrap());
        clear_from_outside(folder.path());
        assert!(others.iter().all(|path| path.exists()), "somebody may be writing them");
        for path in &others {
            let file = File::options().write(true).open(path).unwrap();
            file.set_modified(SystemTime::now() - 2 * ABANDONED).unwrap();
        }
        let slow_writer = File::open(&others[0]).unwrap();
        slow_writer.try_lock().unwrap();
        clear_from_outside(folder.path());
        assert!(others[0].exists(), "it is locked");
        assert!(!others[1].exists());
        drop(slow_writer);
        clear_from_outside(folder.path());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn writers_and_those_who_clear_do_not_disturb_each_other() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let folder = folder.path();
                scope.spawn(move || {
                    for round in 0..50 {
                        let part = Part::create(folder).unwrap();
                        clear(folder, &part);
                        part.rename(&folder.join(format!("{thread}-{round}"))).unwrap();
                    }
                });
            }
        });
        assert_eq!(names(folder.path()).len(), 200);
    }

    #[test]
    fn a_name_says_where_a_part_was_made() {
        let of = |name: &str| made_here(OsStr::new(name), "1a2b");
        assert_eq!(of(".kajo-1a2b-x.part"), Some(true));
        assert_eq!(of(".kajo-1a2c-x.part"), Some(false));
        assert_eq!(of(".kajo-1a2b.part"), Some(false));
        assert_eq!(of("kajo-1a2b-x.part"), None);
        assert_eq!(of(".kajo-1a2b-x.png"), None);
    }
}
