//! How readers get at files, without knowing what a file is.
//!
//! A scene names its files; an [`Assets`] finds them. [`relative_asset`] holds
//! the rules on names that every implementation shares: a name is relative to
//! the file that says it, and nothing outside the root can be named.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::sync::Arc;

/// Opens the files a scene names.
pub trait Assets: Sync {
    /// Opens the file that a scene calls `name`.
    ///
    /// * `name`: as written in the scene
    /// * `from`: [`AssetFile::path`] of the file that names it; empty for the scene itself
    ///
    /// # Errors
    /// When the name is refused or the file cannot be read.
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError>;

    /// Progress callback of the loading of files.
    fn progress(&self, _step: LoadStep<'_>) {}
}

/// What takes its time while a scene is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadStep<'a> {
    /// A file is being read.
    Reading {
        /// [`AssetFile::path`].
        path: &'a str,
        /// Bytes read so far.
        done: u64,
        /// Bytes in the file.
        total: u64,
    },
    /// A tree is built over a mesh.
    Building {
        /// [`AssetFile::path`] of the mesh's file.
        path: &'a str,
        /// Triangles of the mesh.
        triangles: usize,
    },
}

/// An open file.
pub struct AssetFile {
    /// The resolved name: shown in messages, and equal for equal files.
    pub path: String,
    /// Bytes in the file, where known beforehand. A hint only: a file that is said to be too long is not read, and nothing
    /// else is made of it.
    pub len: Option<u64>,
    /// Differs when the content does, where that is known without reading it: made of the time of the last change.
    pub stamp: Option<u64>,
    /// How it is opened again after the scene was read, where that can be.
    pub reopen: Option<Reopen>,
    /// The content.
    pub reader: Box<dyn Read + Send>,
}

type OpenAgain = dyn Fn() -> Result<AssetFile, AssetError> + Send + Sync;

/// Opens a file again, for readers that do not keep all of its content.
#[derive(Clone)]
pub struct Reopen {
    identity: Arc<str>,
    open: Arc<OpenAgain>,
}

impl Reopen {
    /// One that calls `open`.
    ///
    /// * `identity`: one text for each file of this machine: its path from the root
    pub fn new(
        identity: &str,
        open: impl Fn() -> Result<AssetFile, AssetError> + Send + Sync + 'static,
    ) -> Reopen {
        Reopen { identity: identity.into(), open: Arc::new(open) }
    }

    /// What tells the file from all others.
    pub fn identity(&self) -> &str {
        &self.identity
    }

    /// The file as it is now.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn open(&self) -> Result<AssetFile, AssetError> {
        (self.open)()
    }
}

impl std::fmt::Debug for Reopen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Reopen").field("identity", &self.identity).finish_non_exhaustive()
    }
}

impl AssetFile {
    /// The first `most` bytes, or all there are; they are read again afterwards.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn head(&mut self, most: usize) -> Result<Vec<u8>, AssetError> {
        let mut head = Vec::new();
        self.reader.by_ref().take(most as u64).read_to_end(&mut head)?;
        let rest = std::mem::replace(&mut self.reader, Box::new(io::empty()));
        self.reader = Box::new(Cursor::new(head.clone()).chain(rest));
        Ok(head)
    }
}

impl std::fmt::Debug for AssetFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AssetFile").field("path", &self.path).field("len", &self.len).finish_non_exhaustive()
    }
}

/// Why a file could not be had. The text completes "cannot read `x`: ...".
#[derive(Debug, thiserror::Error)]
pub enum AssetError {
    /// There is no such file.
    #[error("there is no such file")]
    NotFound,
    /// The name leads out of the folders that may be read.
    #[error("it lies outside the scene's folder")]
    Outside,
    /// The name can be no file's name.
    #[error("{0}")]
    BadName(&'static str),
    /// A folder, device, pipe or socket.
    #[error("it is not a regular file")]
    NotAFile,
    /// More bytes than [`crate::Limits`] allows.
    #[error("it has more than {limit} bytes, the most that is read")]
    TooLarge {
        /// The bound, in bytes.
        limit: u64,
    },
    /// The operating system refused.
    #[error("{0}")]
    Io(#[from] io::Error),
}

/// Reads a whole file, unless it is known or proves to be longer than `limit` bytes.
///
/// # Errors
/// [`AssetError::TooLarge`] or what the reader reports.
pub fn read_limited(file: AssetFile, limit: u64) -> Result<Vec<u8>, AssetError> {
    if file.len.is_some_and(|len| len > limit) {
        return Err(AssetError::TooLarge { limit });
    }
    let mut bytes = Vec::new();
    file.reader.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(AssetError::TooLarge { limit });
    }
    Ok(bytes)
}

/// The path, from the root and with `/` between its parts, of the file that `from` calls `name`.
///
/// ```
/// use kajo_scene::relative_asset;
/// assert_eq!(relative_asset("scenes/a.txt", "../meshes/cube.obj").unwrap(), "meshes/cube.obj");
/// assert!(relative_asset("scenes/a.txt", "../../secret").is_err());
/// ```
///
/// # Errors
/// [`AssetError::Outside`] for absolute names (of Unix or Windows) and for `..` above the root;
/// [`AssetError::BadName`] for empty names, names of the root itself, back slashes and control characters.
pub fn relative_asset(from: &str, name: &str) -> Result<String, AssetError> {
    const LONGEST: usize = 4096;
    if name.is_empty() {
        return Err(AssetError::BadName("the name is empty"));
    }
    if name.len() > LONGEST {
        return Err(AssetError::BadName("the name is longer than 4096 bytes"));
    }
    if name.chars().any(char::is_control) {
        return Err(AssetError::BadName("the name holds a control character"));
    }
    if name.starts_with(['/', '\\']) || has_drive(name) {
        return Err(AssetError::Outside);
    }
    if name.contains('\\') {
        return Err(AssetError::BadName("the name holds a back slash; write `/` between folders"));
    }
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(name.split('/')) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop().ok_or(AssetError::Outside)?;
            }
            part => parts.push(part),
        }
    }
    if parts.is_empty() {
        return Err(AssetError::BadName("the name is that of a folder"));
    }
    Ok(parts.join("/"))
}

/// `C:` and the like.
fn has_drive(name: &str) -> bool {
    matches!(name.as_bytes(), [letter, b':', ..] if letter.is_ascii_alphabetic())
}

/// Files held in memory, for tests and examples.
///
/// ```
/// use kajo_scene::{Assets, MemoryAssets};
/// let assets = MemoryAssets::new().with("a/scene.txt", "include \"lights.txt\"").with("a/lights.txt", "");
/// assert_eq!(assets.open("lights.txt", "a/scene.txt").unwrap().path, "a/lights.txt");
/// ```
#[derive(Clone, Debug, Default)]
pub struct MemoryAssets {
    files: BTreeMap<String, Arc<[u8]>>,
}

impl MemoryAssets {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file, in place of one of the same path.
    pub fn with(mut self, path: impl Into<String>, content: impl AsRef<[u8]>) -> Self {
        self.files.insert(path.into(), content.as_ref().into());
        self
    }
}

impl Assets for MemoryAssets {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let path = relative_asset(from, name)?;
        let content = Arc::clone(self.files.get(&path).ok_or(AssetError::NotFound)?);
        let len = Some(content.len() as u64);
        Ok(AssetFile { path, len, stamp: None, reopen: None, reader: Box::new(Cursor::new(content)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Resolved from `s/t/scene.txt`, two folders below the root.
    fn resolve(name: &str) -> Result<String, AssetError> {
        relative_asset("s/t/scene.txt", name)
    }

    #[test]
    fn a_file_that_is_known_to_be_too_long_is_not_read() {
        struct Unread;
        impl Read for Unread {
            fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
                panic!("it is read");
            }
        }
        let file = |len, reader| AssetFile { path: "a".to_owned(), len, stamp: None, reopen: None, reader };
        let refused = read_limited(file(Some(11), Box::new(Unread)), 10);
        assert!(matches!(refused, Err(AssetError::TooLarge { limit: 10 })));
        for len in [None, Some(3)] {
            let refused = read_limited(file(len, Box::new(io::repeat(0))), 10);
            assert!(
                matches!(refused, Err(AssetError::TooLarge { limit: 10 })),
                "whatever is said of its length"
            );
        }
    }

    #[test]
    fn good_names_resolve() {
        for (name, path) in [
            ("a.obj", "s/t/a.obj"),
            ("./a.obj", "s/t/a.obj"),
            (".//a.obj", "s/t/a.obj"),
            ("b/a.obj", "s/t/b/a.obj"),
            ("b//a.obj", "s/t/b/a.obj"),
            ("b/./a.obj", "s/t/b/a.obj"),
            ("b/../a.obj", "s/t/a.obj"),
            ("../a.obj", "s/a.obj"),
            ("../../a.obj", "a.obj"),
            ("../t/a.obj", "s/t/a.obj"),
            ("b/c/../../../a.obj", "s/a.obj"),
            ("dir/", "s/t/dir"),
            ("my bunny.obj", "s/t/my bunny.obj"),
            ("été/ø.obj", "s/t/été/ø.obj"),
            ("...", "s/t/..."),
            ("..a", "s/t/..a"),
            ("a..", "s/t/a.."),
            (".hidden", "s/t/.hidden"),
            ("a.b.c", "s/t/a.b.c"),
            ("ab:c", "s/t/ab:c"),
            ("~/a", "s/t/~/a"),
            ("$HOME/a", "s/t/$HOME/a"),
            ("%2e%2e/a", "s/t/%2e%2e/a"),
            ("-rf", "s/t/-rf"),
        ] {
            assert_eq!(resolve(name).unwrap(), path, "{name:?}");
        }
        assert_eq!(relative_asset("", "a").unwrap(), "a");
        assert_eq!(relative_asset("scene.txt", "a/b").unwrap(), "a/b");
    }

    #[test]
    fn names_that_lead_outside_are_refused() {
        for name in [
            "/",
            "/etc/passwd",
            "//etc/passwd",
            "///a",
            "/..",
            "/dev/stdin",
            "\\",
            "\\a",
            "\\\\server\\share\\a",
            "\\\\?\\C:\\a",
            "\\\\.\\pipe\\a",
            "\\..\\a",
            "C:",
            "C:a",
            "C:/a",
            "C:\\a",
            "c:a.obj",
            "z:/",
            "z:..",
            "../../../a",
            "../../..",
            "../../../s/t/a",
            "a/../../../../b",
            "./../../../a",
            "..//..//..//a",
            ".././.././../a",
            "b/c/../../../../../a",
            "../../../../../../../../etc/passwd",
            "dir/../../../../a",
            "../s/../../../a",
            "x/../../../..//b",
            "../../../",
            "./.././../.././..",
        ] {
            assert!(matches!(resolve(name), Err(AssetError::Outside)), "{name:?} gave {:?}", resolve(name));
        }
    }

    #[test]
    fn names_of_nothing_are_refused() {
        let long = "a".repeat(4097);
        for name in [
            "",
            "a\0",
            "\0",
            "a\0.obj",
            "a\nb",
            "a\rb",
            "\ta",
            "\u{1b}[2J",
            "\u{7f}",
            "\u{85}",
            "a\\b",
            "..\\a",
            "..\\..\\..\\a",
            "a\\..\\b",
            "a/b\\c",
            "../..",
            "../../.",
            "../../",
            &long,
        ] {
            assert!(
                matches!(resolve(name), Err(AssetError::BadName(_))),
                "{name:?} gave {:?}",
                resolve(name)
            );
        }
        assert!(matches!(relative_asset("", "."), Err(AssetError::BadName(_))));
    }

    #[test]
    fn a_reader_that_never_ends_is_cut_off() {
        let endless = || AssetFile {
            path: "e".into(),
            len: Some(3),
            stamp: None,
            reopen: None,
            reader: Box::new(io::repeat(b'a').take(1 << 40)),
        };
        assert!(matches!(read_limited(endless(), 1000), Err(AssetError::TooLarge { limit: 1000 })));
        let exact = AssetFile {
            path: "e".into(),
            len: None,
            stamp: None,
            reopen: None,
            reader: Box::new(io::repeat(b'a').take(7)),
        };
        assert_eq!(read_limited(exact, 7).unwrap(), b"aaaaaaa");
    }
}
