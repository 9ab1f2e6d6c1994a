//! Files that are whole or not there, and never change once they are.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// How names begin of files that are being written.
const UNFINISHED: &str = ".unfinished-";

/// Publishes a file under a name that nothing else has. It is on the disk before it has the name, and the name
/// before this returns.
///
/// Returns whether it is new; otherwise the file that was there is left as it is.
///
/// # Errors
/// What the system says.
pub(crate) fn publish(path: &Path, bytes: &[u8]) -> io::Result<bool> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    // By a link, or a rename that replaces nothing.
    match file.persist_noclobber(path) {
        Ok(_) => {}
        Err(error) if error.error.kind() == ErrorKind::AlreadyExists => return Ok(false),
        Err(error) => return Err(error.error),
    }
    // Some systems cannot bring folders to the disk.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(true)
}

/// A whole file, unless it is longer than `most`; `None` where there is none.
///
/// # Errors
/// What the system says.
pub(crate) fn read(path: &Path, most: u64) -> io::Result<Option<Vec<u8>>> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    if !file.metadata()?.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file"));
    }
    let mut bytes = Vec::new();
    file.take(most).read_to_end(&mut bytes)?;
    Ok(Some(bytes))
}

/// Names of the files of a folder, sorted; none where there is no folder.
///
/// # Errors
/// What the system says.
pub(crate) fn names(folder: &Path) -> io::Result<Vec<String>> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let mut names = Vec::new();
    for entry in entries {
        names.extend(entry?.file_name().into_string());
    }
    names.sort();
    Ok(names)
}

/// Removes a file, if it is there.
///
/// # Errors
/// What the system says.
pub(crate) fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Removes what processes that were killed a day ago or earlier left unfinished.
pub(crate) fn sweep(folder: &Path) {
    const OLD: Duration = Duration::from_secs(24 * 3600);
    for name in names(folder).unwrap_or_default().iter().filter(|name| name.starts_with(UNFINISHED)) {
        let path = folder.join(name);
        let changed = fs::metadata(&path).and_then(|metadata| metadata.modified());
        let age = changed.ok().and_then(|changed| SystemTime::now().duration_since(changed).ok());
        if age.is_some_and(|age| age > OLD) {
            let _ = fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_copy_wins() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        assert!(publish(&path, b"one").unwrap());
        assert!(!publish(&path, b"two").unwrap());
        assert_eq!(read(&path, 100).unwrap().unwrap(), b"one");
        assert_eq!(read(&folder.path().join("b"), 100).unwrap(), None);
        assert_eq!(names(folder.path()).unwrap(), ["a"], "nothing unfinished stays");
        assert!(read(folder.path(), 100).is_err());
        assert!(publish(&folder.path().join("no/a"), b"").is_err());
    }
}
