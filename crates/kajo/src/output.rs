//! Output files: whole or not at all.
//!
//! [`Target::check`] finds out before rendering whether a file can be written; [`Target::write`] fills a
//! temporary file beside it, brings it to the disk and renames it. The file that stood there before is
//! untouched until then, and after any failure. What cannot be written where it belongs can still be put
//! elsewhere, by [`rescue`].

mod obstacle;
mod part;

use std::env;
use std::ffi::OsStr;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::Builder;

use part::Part;

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// It is the scene, something that the scene is made of, or another file that is read.
    #[error("cannot write `{}`: it is `{}`, which is read; choose another name", path.display(), shown(input))]
    IsInput {
        /// The file.
        path: PathBuf,
        /// The same file, by the name under which it is read.
        input: PathBuf,
    },
    /// Two outputs have one name.
    #[error("cannot write `{}` twice in one run; choose another name for one of them", path.display())]
    Twice {
        /// The file.
        path: PathBuf,
    },
    /// It stands where a file should.
    #[error("cannot write `{}`: it is a folder", path.display())]
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// There is nowhere to put it.
    #[error("cannot write `{}`: there is no folder `{}`", path.display(), folder.display())]
    NoFolder {
        /// The file.
        path: PathBuf,
        /// The folder it should be in.
        folder: PathBuf,
    },
    /// The operating system refused the file before anything was written.
    #[error("cannot write `{}`: {source}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: io::Error,
    },
    /// Writing failed: the disk is full, or worse.
    #[error("cannot write `{}`, which needs {bytes} bytes: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// How long the file would be.
        bytes: usize,
        /// What went wrong.
        source: io::Error,
    },
}

/// Makes a file of what `content` writes, in place of what had its name, which is there until all of it is written.
///
/// * `path`: with its folder
///
/// # Errors
/// Those of the system and of `content`.
pub(crate) fn replace(
    path: &Path,
    content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let folder = path.parent().ok_or(ErrorKind::InvalidInput)?;
    let part = Part::create(folder)?;
    part::clear(folder, &part);
    content(&mut part.file())?;
    part.rename(path)
}

/// A file to be written, found to be writable.
#[derive(Debug)]
pub struct Target {
    /// As the user wrote it.
    path: PathBuf,
    /// What is to be replaced: behind the link, if `path` is one.
    real: PathBuf,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    /// A file, there already or not.
    File,
    /// A device or a pipe, written in place.
    Stream,
}

impl Target {
    /// Makes sure that `path` can be written, and removes what killed processes left of files in its folder.
    ///
    /// * `inputs`: files that must not be overwritten, by whatever names
    ///
    /// # Errors
    /// Every reason that can be known beforehand.
    pub fn check(path: &Path, inputs: &[PathBuf]) -> Result<Target, OutputError> {
        let refused = |source| OutputError::Refused { path: path.to_path_buf(), source };
        let existing = match fs::metadata(path) {
            Ok(metadata) => Some(metadata),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(refused(error)),
        };
        if existing.as_ref().is_some_and(Metadata::is_dir) {
            return Err(OutputError::IsFolder { path: path.to_path_buf() });
        }
        let (real, kind) = match &existing {
            Some(metadata) if metadata.is_file() => (fs::canonicalize(path).map_err(refused)?, Kind::File),
            // A pipe behind `/dev/stdout` has no name of its own.
            Some(_) => (path.to_path_buf(), Kind::Stream),
            None => (in_real_folder(path), Kind::File),
        };
        let target = Target { path: path.to_path_buf(), real, kind };
        inputs.iter().try_for_each(|input| target.differs_from(input))?;
        if let Kind::File = target.kind {
            target.probe()?;
        }
        Ok(target)
    }

    /// As [`Target::check`] for several files of one run.
    ///
    /// # Errors
    /// As there, and [`OutputError::Twice`].
    pub fn check_all(paths: &[PathBuf], inputs: &[PathBuf]) -> Result<Vec<Target>, OutputError> {
        let mut targets: Vec<Target> = Vec::with_capacity(paths.len());
        for path in paths {
            let target = Target::check(path, inputs)?;
            let is_file = matches!(target.kind, Kind::File);
            if is_file && targets.iter().any(|other| other.real == target.real) {
                return Err(OutputError::Twice { path: path.clone() });
            }
            targets.push(target);
        }
        Ok(targets)
    }

    /// Makes sure that it is not this file, be it by links.
    ///
    /// # Errors
    /// [`OutputError::IsInput`].
    pub fn differs_from(&self, input: &Path) -> Result<(), OutputError> {
        match self.real == input || is_same(&self.real, input) {
            true => Err(OutputError::IsInput { path: self.path.clone(), input: input.to_path_buf() }),
            false => Ok(()),
        }
    }

    /// The path as the user wrote it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is a device or a pipe, which is written in place and may keep its writer waiting for a reader.
    pub fn is_stream(&self) -> bool {
        matches!(self.kind, Kind::Stream)
    }

    /// Whether its folder is there.
    pub fn has_folder(&self) -> bool {
        self.folder().is_dir()
    }

    /// Whether it is a file in this folder or one below it, by their real paths.
    ///
    /// * `folder`: a real path
    pub fn is_file_within(&self, folder: &Path) -> bool {
        !self.is_stream() && self.real.starts_with(folder)
    }

    /// Writes the file, whole.
    ///
    /// # Errors
    /// [`OutputError::Write`]; what stood there before still does.
    pub fn write(&self, bytes: &[u8]) -> Result<(), OutputError> {
        self.fill(bytes.len(), |out| out.write_all(bytes))
    }

    /// As [`Target::write`] with what `write` puts into the file.
    ///
    /// * `bytes`: about how many that will be, for the message when there is no room
    ///
    /// # Errors
    /// As there.
    pub fn fill(
        &self,
        bytes: usize,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), OutputError> {
        let result = match self.kind {
            Kind::File => self.replace(write),
            Kind::Stream => {
                File::options().write(true).open(&self.real).and_then(|file| buffered(&file, write))
            }
        };
        result.map_err(|source| OutputError::Write { path: self.path.clone(), bytes, source })
    }

    fn replace(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let part = Part::create(self.folder())?;
        if let Ok(existing) = fs::metadata(&self.real) {
            part.file().set_permissions(existing.permissions())?;
        }
        buffered(part.file(), write)?;
        part.file().sync_all()?;
        part.rename(&self.real)?;
        self.sync_folder();
        Ok(())
    }

    /// Brings the new name to the disk too, where the system lets a folder be synchronised; the file
    /// itself is whole either way.
    fn sync_folder(&self) {
        if cfg!(unix) {
            let _ = File::open(self.folder()).and_then(|folder| folder.sync_all());
        }
    }

    /// Whether a file can be made there, and take the place of what is there already.
    fn probe(&self) -> Result<(), OutputError> {
        let folder = self.folder();
        if !folder.is_dir() {
            return Err(OutputError::NoFolder { path: self.path.clone(), folder: folder.to_path_buf() });
        }
        let refused = |source| OutputError::Refused { path: self.path.clone(), source };
        let existing = fs::metadata(&self.real).ok();
        if existing.as_ref().is_some_and(|metadata| metadata.permissions().readonly()) {
            return Err(refused(io::Error::new(ErrorKind::PermissionDenied, "the file is write-protected")));
        }
        if let Some(obstacle) = existing.and_then(|_| obstacle::obstacle(&self.real)) {
            return Err(refused(obstacle));
        }
        let part = Part::create(folder).map_err(refused)?;
        part::clear(folder, &part);
        Ok(())
    }

    fn folder(&self) -> &Path {
        match self.real.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }
}

fn buffered(file: &File, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out)?;
    out.flush()
}

/// Writes what cannot be put where it belongs into the first of these folders that takes it: the one it belongs to, the
/// current one, and that for temporary files. Its name begins and ends as `path` does. Returns its path.
///
/// * `write`: called for each folder
pub fn rescue(path: &Path, mut write: impl FnMut(&mut dyn Write) -> io::Result<()>) -> Option<PathBuf> {
    let temporary = env::temp_dir();
    let own = path.parent().unwrap_or(Path::new(""));
    let is_device = own.starts_with("/dev");
    let folders = [(!is_device).then_some(own), Some(Path::new("")), Some(&*temporary)];
    folders.into_iter().flatten().find_map(|folder| {
        let shared = folder == temporary;
        write_under_new_name(folder, path, shared, &mut write).ok()
    })
}

/// * `shared`: whether the file is to be its owner's alone
fn write_under_new_name(
    folder: &Path,
    path: &Path,
    shared: bool,
    write: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
) -> io::Result<PathBuf> {
    let part = |part: Option<&OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
    let prefix = format!("{}.kajo-", part(path.file_stem()));
    let suffix = path.extension().map(|extension| format!(".{}", part(Some(extension)))).unwrap_or_default();
    let mut builder = Builder::new();
    builder.prefix(&prefix).suffix(&suffix);
    if !shared {
        part::with_usual_rights(&mut builder);
    }
    let file = match folder.as_os_str().is_empty() {
        true => builder.tempfile_in(".")?,
        false => builder.tempfile_in(folder)?,
    };
    buffered(file.as_file(), write)?;
    file.as_file().sync_all()?;
    let (_, written) = file.keep().map_err(|error| error.error)?;
    // The folder as it was named, not as it is found from the root.
    Ok(written.file_name().map(|name| folder.join(name)).unwrap_or(written))
}

/// Whether two paths lead to one file, which may have several names.
#[cfg(unix)]
fn is_same(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let number = |path| fs::metadata(path).map(|metadata| (metadata.dev(), metadata.ino())).ok();
    number(a).is_some_and(|a| number(b) == Some(a))
}

/// Whether two paths lead to one file.
#[cfg(not(unix))]
fn is_same(a: &Path, b: &Path) -> bool {
    fs::canonicalize(a).is_ok_and(|a| fs::canonicalize(b).is_ok_and(|b| a == b))
}

/// A path as one would write it in the current folder.
fn shown(path: &Path) -> std::path::Display<'_> {
    let folder = env::current_dir().and_then(fs::canonicalize).unwrap_or_default();
    path.strip_prefix(folder).unwrap_or(path).display()
}

/// The path of a file to be made, by the real path of its folder where that exists: equal for equal files.
fn in_real_folder(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (fs::canonicalize(folder), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_path_buf(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_made_or_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for content in [&b"one"[..], b"two, longer"] {
            let target = Target::check(&path, &[]).unwrap();
            target.write(content).unwrap();
            assert_eq!(fs::read(&path).unwrap(), content);
            assert_eq!(names(folder.path()), ["a.png"]);
        }
    }

    #[test]
    fn a_check_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        Target::check(&folder.path().join("a.png"), &[]).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn faults_are_found_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("scene.txt"), "").unwrap();
        let inputs = [fs::canonicalize(path("scene.txt")).unwrap()];
        let check = |name: &str| Target::check(&path(name), &inputs);
        assert!(matches!(check("scene.txt"), Err(OutputError::IsInput { .. })));
        assert!(matches!(check("./scene.txt"), Err(OutputError::IsInput { .. })));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("scene.txt", path("symbolic")).unwrap();
            fs::hard_link(path("scene.txt"), path("hard")).unwrap();
            for link in ["symbolic", "hard"] {
                let refused = check(link).unwrap_err().to_string();
                let named = [link, "scene.txt"].iter().all(|name| refused.contains(&format!("{name}`")));
                assert!(named && refused.contains("which is read"), "{refused}");
            }
        }
        assert!(matches!(check("nowhere/a.png"), Err(OutputError::NoFolder { .. })));
        assert!(matches!(
            check("scene.txt/a.png"),
            Err(OutputError::NoFolder { .. } | OutputError::Refused { .. })
        ));
        assert!(matches!(Target::check(folder.path(), &[]), Err(OutputError::IsFolder { .. })));
        fs::create_dir(path("b")).unwrap();
        for other in ["a.png", "./a.png", "b/../a.png"] {
            let twice = Target::check_all(&[path("a.png"), path(other)], &[]);
            assert!(matches!(twice, Err(OutputError::Twice { .. })), "{other}");
        }
        assert!(Target::check_all(&[path("a.png"), path("b/a.png")], &[]).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_rights_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("real.png"), "old").unwrap();
        fs::set_permissions(path("real.png"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("real.png", path("link.png")).unwrap();
        Target::check(&path("link.png"), &[]).unwrap().write(b"new").unwrap();
        assert!(fs::symlink_metadata(path("link.png")).unwrap().is_symlink());
        assert_eq!(fs::read(path("real.png")).unwrap(), b"new");
        assert_eq!(fs::metadata(path("real.png")).unwrap().permissions().mode() & 0o777, 0o640);

        Target::check(&path("fresh.png"), &[]).unwrap().write(b"new").unwrap();
        File::create(path("usual.png")).unwrap();
        let mode = |name: &str| fs::metadata(path(name)).unwrap().permissions().mode();
        assert_eq!(mode("fresh.png"), mode("usual.png"), "the same rights as any new file");
    }

    #[test]
    fn a_check_clears_what_killed_processes_left() {
        let folder = tempfile::tempdir().unwrap();
        let left = Part::create(folder.path()).unwrap();
        let name = names(folder.path()).remove(0);
        drop(left);
        fs::write(folder.path().join(&name), "half of a picture").unwrap();
        Target::check(&folder.path().join("a.png"), &[]).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn what_has_lost_its_place_is_put_beside_it_or_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.png");
        fs::write(&path, "old").unwrap();
        let beside = rescue(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(
            (fs::read(&path).unwrap(), fs::read(&beside).unwrap()),
            (b"old".to_vec(), b"new".to_vec())
        );
        assert_eq!(beside.parent(), path.parent());
        let name = beside.file_name().unwrap().to_str().unwrap();
        assert!(name.starts_with("out.kajo-") && name.ends_with(".png"), "{name}");

        let gone = folder.path().join("gone/out.png");
        let mut attempts = 0;
        let elsewhere = rescue(&gone, |out| {
            attempts += 1;
            // As if the current folder were full.
            if attempts == 1 { Err(ErrorKind::StorageFull.into()) } else { out.write_all(b"new") }
        });
        let elsewhere = elsewhere.unwrap();
        assert_eq!(elsewhere.parent(), Some(&*env::temp_dir()));
        fs::remove_file(elsewhere).unwrap();
        assert_eq!(rescue(&gone, |_| Err(ErrorKind::StorageFull.into())), None);
        assert_eq!(names(folder.path()).len(), 2, "failures leave nothing");
    }

    #[cfg(unix)]
    #[test]
    fn a_write_protected_file_is_refused() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(matches!(Target::check(&path, &[]), Err(OutputError::Refused { .. })));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_in_place() {
        Target::check(Path::new("/dev/null"), &[]).unwrap().write(b"gone").unwrap();
        let full = Target::check(Path::new("/dev/full"), &[]).unwrap().write(b"too much").unwrap_err();
        assert!(matches!(&full, OutputError::Write { bytes: 8, .. }), "{full}");
        assert!(full.to_string().contains("8 bytes"));
    }

    /// As `-o /dev/stdout` and `-o >(command)` name them: links to something without a name of its own.
    #[cfg(target_os = "linux")]
    #[test]
    fn pipes_are_written_in_place() {
        use std::io::Read;
        use std::os::fd::AsRawFd;
        let (mut reader, writer) = io::pipe().unwrap();
        let path = PathBuf::from(format!("/dev/fd/{}", writer.as_raw_fd()));
        Target::check(&path, &[]).unwrap().write(b"through").unwrap();
        drop(writer);
        let mut read = String::new();
        reader.read_to_string(&mut read).unwrap();
        assert_eq!(read, "through");
    }
}
