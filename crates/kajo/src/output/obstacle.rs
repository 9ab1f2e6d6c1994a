//! What keeps a file from being replaced although a new one can be made beside it.

use std::io::{self, ErrorKind};
use std::path::Path;

/// Why the file at this real path cannot be replaced, as far as that can be known without doing it.
pub(super) fn obstacle(path: &Path) -> Option<io::Error> {
    if is_mounted(path) {
        return Some(io::Error::new(ErrorKind::ResourceBusy, "it is mounted there and cannot be replaced"));
    }
    if is_protected(path) {
        let reason = "the folder or the file is protected, and the file cannot be replaced";
        return Some(io::Error::new(ErrorKind::PermissionDenied, reason));
    }
    None
}

/// Whether the file may not be taken out of its folder: it belongs to somebody else in a sticky folder, or is immutable.
///
/// Systems look at that before they look at what is to be removed, so it is asked by the removal of a folder, which a
/// file is not.
#[cfg(unix)]
fn is_protected(path: &Path) -> bool {
    std::fs::remove_dir(path).is_err_and(|error| error.kind() == ErrorKind::PermissionDenied)
}

#[cfg(not(unix))]
fn is_protected(_: &Path) -> bool {
    false
}

/// Whether something is mounted at the path, as containers do with single files.
#[cfg(target_os = "linux")]
fn is_mounted(path: &Path) -> bool {
    use std::os::unix::ffi::OsStrExt;
    let mounts = std::fs::read("/proc/self/mountinfo").unwrap_or_default();
    mount_points(&mounts).any(|point| point == path.as_os_str().as_bytes())
}

#[cfg(not(target_os = "linux"))]
fn is_mounted(_: &Path) -> bool {
    false
}

/// The fifth word of each line [proc_pid_mountinfo(5)].
#[cfg(target_os = "linux")]
fn mount_points(mounts: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    let words = |line: &[u8]| line.split(|&b| b == b' ').nth(4).map(unescaped);
    mounts.split(|&b| b == b'\n').filter_map(words)
}

/// The word with its blanks, which are written `\040` and the like.
#[cfg(target_os = "linux")]
fn unescaped(word: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word;
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.get(..3).and_then(|digits| std::str::from_utf8(digits).ok());
        match digits.and_then(|digits| u8::from_str_radix(digits, 8).ok()) {
            Some(byte) if first == b'\\' => {
                bytes.push(byte);
                rest = &after[3..];
            }
            _ => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    bytes
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn mount_points_are_read() {
        let text = b"36 35 98:0 / /a\\040b rw - ext3 /dev/x rw\n37 35 0:1 /x /c\\134\\0 rw - tmpfs t rw\n";
        let points: Vec<Vec<u8>> = mount_points(text).collect();
        assert_eq!(points, [b"/a b".to_vec(), b"/c\\\\0".to_vec()]);
    }

    #[test]
    fn a_usual_file_has_none() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(obstacle(file.path()).is_none());
        assert!(file.path().exists());
        assert!(is_mounted(Path::new("/proc")));
    }
}
