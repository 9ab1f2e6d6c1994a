//! The files a scene names, found on disk.
//!
//! A name is looked up beside the file that says it, then in each extra folder. What is found must lie in
//! the scene's folder or in an extra one, by its real path, so that neither `..` nor a link leads out; the
//! check comes before the disk is asked, so that a refusal does not tell what exists elsewhere. `a/../b` is `b`,
//! be `a` a link or not.
//! [`FsAssets::allow_outside`] lifts all of this. Pipes, devices and folders are refused before they are
//! opened, since opening a pipe may wait for ever.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::UNIX_EPOCH;

use kajo_math::rng::mix;
use kajo_scene::{AssetError, AssetFile, Assets, Limits, LoadStep, Reopen, nearest, relative_asset};

/// Progress callback of the loading of a scene.
pub trait LoadProgress: std::fmt::Debug + Send + Sync {
    /// Another piece of a file has been read, or a tree is about to be built.
    fn step(&self, step: LoadStep<'_>);
}

/// Files beside a scene.
#[derive(Debug)]
pub struct FsAssets {
    scene: PathBuf,
    scene_name: String,
    roots: Vec<Root>,
    allow_outside: bool,
    max_bytes: u64,
    progress: Option<Arc<dyn LoadProgress>>,
    /// Real paths of the files handed out, by the names shown for them.
    opened: Mutex<BTreeMap<String, PathBuf>>,
}

/// A folder whose files may be read.
#[derive(Debug)]
struct Root {
    /// As the user wrote it, with `/` at its end unless empty.
    prefix: String,
    /// Its real path.
    folder: PathBuf,
}

impl FsAssets {
    /// The files in the folder of `scene` and below. The scene itself may be a link; it was named by the user.
    ///
    /// # Errors
    /// When the folder does not exist or may not be entered.
    pub fn new(scene: &Path) -> io::Result<FsAssets> {
        let parent = scene.parent().unwrap_or(Path::new(""));
        Ok(FsAssets {
            scene: scene.to_path_buf(),
            scene_name: shown(scene),
            roots: vec![Root::new(parent)?],
            allow_outside: false,
            max_bytes: Limits::default().mesh_bytes,
            progress: None,
            opened: Mutex::default(),
        })
    }

    /// Adds a folder whose files may be read too, and where names are looked up as a last resort.
    ///
    /// # Errors
    /// When the folder does not exist or may not be entered.
    pub fn with_folder(mut self, folder: &Path) -> io::Result<FsAssets> {
        self.roots.push(Root::new(folder)?);
        Ok(self)
    }

    /// Lets names lead anywhere, if `yes`.
    pub fn allow_outside(mut self, yes: bool) -> FsAssets {
        self.allow_outside = yes;
        self
    }

    /// Tells `progress`, if there is one, how far the reading of each file is.
    pub fn watched_by(mut self, progress: Option<Arc<dyn LoadProgress>>) -> FsAssets {
        self.progress = progress;
        self
    }

    /// The name by which the scene itself is opened and shown.
    pub fn scene_name(&self) -> &str {
        &self.scene_name
    }

    /// Real paths of all files opened so far: what must not be overwritten.
    pub fn opened(&self) -> Vec<PathBuf> {
        // The scene is kept by the name of its link, if it is one.
        self.lock().values().filter_map(|path| fs::canonicalize(path).ok()).collect()
    }

    /// The real path of a file that was opened, by the name shown for it.
    pub fn real_path(&self, shown: &str) -> Option<PathBuf> {
        self.lock().get(shown).cloned()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<String, PathBuf>> {
        self.opened.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The path of the file beside the scene that is called `name`, as it is shown.
    ///
    /// # Errors
    /// As those of opening it by that name.
    pub fn locate(&self, name: &str) -> Result<PathBuf, AssetError> {
        self.find(name, &self.scene_name).map(|path| PathBuf::from(self.name_of(&path)))
    }

    /// The real path of the file that `from` calls `name`.
    fn find(&self, name: &str, from: &str) -> Result<PathBuf, AssetError> {
        if let Err(refusal @ AssetError::BadName(_)) = relative_asset(from, name) {
            return Err(refusal);
        }
        let beside = self.lock().get(from).and_then(|path| path.parent()).map(Path::to_path_buf);
        let beside = beside.unwrap_or_else(|| self.roots[0].folder.clone());
        let folders = std::iter::once(&beside).chain(self.roots.iter().map(|root| &root.folder));
        let mut refusal = AssetError::NotFound;
        for candidate in folders.map(|folder| folder.join(name)) {
            let found = match self.allow_outside {
                true => fs::canonicalize(&candidate).map_err(AssetError::from),
                false if is_relative(name) => self.find_inside(&normalised(&candidate)),
                false => Err(AssetError::Outside),
            };
            match found {
                Ok(path) => return Ok(path),
                Err(AssetError::Outside) => refusal = AssetError::Outside,
                Err(AssetError::NotFound) => {}
                Err(AssetError::Io(error)) if is_absence(&error) => {}
                Err(error) => return Err(error),
            }
        }
        let wanted = normalised(&beside.join(name));
        Err(match refusal {
            AssetError::NotFound if self.allow_outside || self.folder_is_inside(&wanted) => absent(&wanted),
            refusal => refusal,
        })
    }

    /// The real path of a file, looked up name by name from a folder that may be read, so that nothing is asked, and
    /// nothing told, about what links lead to outside.
    ///
    /// * `path`: without `.` and `..`
    fn find_inside(&self, path: &Path) -> Result<PathBuf, AssetError> {
        let root =
            self.roots.iter().find(|root| path.starts_with(&root.folder)).ok_or(AssetError::Outside)?;
        let mut real = root.folder.clone();
        for name in path.strip_prefix(&root.folder).map_err(|_| AssetError::Outside)? {
            let next = real.join(name);
            let is_link = fs::symlink_metadata(&next)?.is_symlink();
            real = match fs::canonicalize(&next) {
                Ok(path) if self.contains(&path) => path,
                // Whether there is something at the end of a link that leads out is not for the scene to know.
                Err(error) if !is_link => return Err(error.into()),
                Ok(_) | Err(_) => return Err(AssetError::Outside),
            };
        }
        Ok(real)
    }

    /// Whether the folder that a file would be in may be read.
    fn folder_is_inside(&self, path: &Path) -> bool {
        path.parent().is_some_and(|folder| self.find_inside(folder).is_ok())
    }

    fn contains(&self, path: &Path) -> bool {
        self.roots.iter().any(|root| path.starts_with(&root.folder))
    }

    /// The name shown for a real path: as short as the user wrote the folder.
    fn name_of(&self, path: &Path) -> String {
        let inside =
            |root: &Root| path.strip_prefix(&root.folder).ok().map(|rest| root.prefix.clone() + &shown(rest));
        self.roots.iter().find_map(inside).unwrap_or_else(|| shown(path))
    }
}

impl Assets for FsAssets {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let (path, shown) = if from.is_empty() && name == self.scene_name {
            let path = fs::canonicalize(&self.scene).map_err(|error| match is_absence(&error) {
                true => absent(&self.scene),
                false => error.into(),
            })?;
            // What the scene names lies beside the link, not beside the file it points to.
            let beside_link = self.scene.file_name().map(|name| self.roots[0].folder.join(name));
            self.lock().insert(name.to_owned(), beside_link.unwrap_or_else(|| path.clone()));
            (path, name.to_owned())
        } else {
            let path = self.find(name, from)?;
            let shown = self.name_of(&path);
            self.lock().insert(shown.clone(), path.clone());
            (path, shown)
        };
        let (file, len) = open_regular(&path, self.max_bytes)?;
        let stamp = stamp_of(&file);
        let reader: Box<dyn Read + Send> = match &self.progress {
            None => Box::new(file),
            Some(progress) => Box::new(WatchedFile {
                file,
                path: shown.clone(),
                done: 0,
                total: len,
                progress: Arc::clone(progress),
            }),
        };
        let reopen = path.to_str().map(|identity| {
            let (path, shown, most) = (path.clone(), shown.clone(), self.max_bytes);
            Reopen::new(identity, move || {
                let (file, len) = open_regular(&path, most)?;
                let (stamp, path) = (stamp_of(&file), shown.clone());
                Ok(AssetFile { path, len: Some(len), stamp, reopen: None, reader: Box::new(file) })
            })
        });
        Ok(AssetFile { path: shown, len: Some(len), stamp, reopen, reader })
    }

    fn progress(&self, step: LoadStep<'_>) {
        if let Some(progress) = &self.progress {
            progress.step(step);
        }
    }
}

/// What tells one state of a file from another: when it was changed, and how long it is.
fn stamp_of(file: &File) -> Option<u64> {
    let metadata = file.metadata().ok()?;
    let changed = metadata.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Some(mix(changed.as_nanos() as u64 ^ mix(metadata.len())))
}

/// A file that tells how much of it has been read.
struct WatchedFile {
    file: File,
    path: String,
    done: u64,
    total: u64,
    progress: Arc<dyn LoadProgress>,
}

impl Read for WatchedFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.done += n as u64;
        self.progress.step(LoadStep::Reading { path: &self.path, done: self.done, total: self.total });
        Ok(n)
    }
}

impl Root {
    fn new(folder: &Path) -> io::Result<Root> {
        let real = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let mut prefix = shown(folder);
        if !prefix.is_empty() && !prefix.ends_with('/') {
            prefix.push('/');
        }
        Ok(Root { prefix, folder: fs::canonicalize(real)? })
    }
}

fn open_regular(path: &Path, max_bytes: u64) -> Result<(File, u64), AssetError> {
    let check = |metadata: fs::Metadata| match metadata.is_file() {
        false => Err(AssetError::NotAFile),
        true if metadata.len() > max_bytes => Err(AssetError::TooLarge { limit: max_bytes }),
        true => Ok(metadata.len()),
    };
    check(fs::metadata(path)?)?;
    let file = File::open(path)?;
    // Once more: the name may have come to mean another file since.
    let len = check(file.metadata()?)?;
    Ok((file, len))
}

/// Whether the name has no root, drive or server.
fn is_relative(name: &str) -> bool {
    Path::new(name).components().all(|part| !matches!(part, Component::RootDir | Component::Prefix(_)))
}

/// The path without `.` and `..`, links not followed.
fn normalised(path: &Path) -> PathBuf {
    let mut clean = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                clean.pop();
            }
            part => clean.push(part),
        }
    }
    clean
}

fn is_absence(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// "There is no such file", with the name in the same folder that is most like it.
fn absent(path: &Path) -> AssetError {
    /// Entries of a folder looked at for a similar name.
    const LOOKED_AT: usize = 10_000;
    let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return AssetError::NotFound };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(entries) = fs::read_dir(folder) else { return AssetError::NotFound };
    let names: Vec<OsString> = entries.take(LOOKED_AT).flatten().map(|entry| entry.file_name()).collect();
    let mut names: Vec<&str> = names.iter().filter_map(|name| name.to_str()).collect();
    names.sort_unstable();
    match nearest(&name.to_string_lossy(), names.into_iter()) {
        Some(similar) => {
            let message = format!("there is no such file; did you mean `{similar}`?");
            AssetError::Io(io::Error::new(ErrorKind::NotFound, message))
        }
        None => AssetError::NotFound,
    }
}

/// The path as text, with `/` between its parts on every platform.
fn shown(path: &Path) -> String {
    let text = path.to_string_lossy();
    if cfg!(windows) { text.replace('\\', "/") } else { text.into_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::read_limited;

    /// `inside/` with a scene, a mesh and `sub/part.txt`; `outside/` beside it; `extra/` to be allowed.
    struct Folders(tempfile::TempDir);

    impl Folders {
        fn new() -> Folders {
            let folders = Folders(tempfile::tempdir().unwrap());
            for name in [
                "inside/scene.txt",
                "inside/bunny_200.obj",
                "inside/sub/part.txt",
                "outside/x.obj",
                "extra/e.obj",
            ] {
                let path = folders.path(name);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, name).unwrap();
            }
            folders
        }

        fn path(&self, name: &str) -> PathBuf {
            self.0.path().join(name)
        }

        fn assets(&self) -> FsAssets {
            let assets = FsAssets::new(&self.path("inside/scene.txt")).unwrap();
            assets.open(assets.scene_name(), "").unwrap();
            assets
        }
    }

    /// What the file holds, which is the name it was made by.
    fn content(assets: &FsAssets, name: &str, from: &str) -> Result<String, AssetError> {
        let file = assets.open(name, from)?;
        Ok(String::from_utf8(read_limited(file, 1000)?).unwrap())
    }

    #[test]
    fn names_are_looked_up_beside_the_file_that_says_them() {
        let folders = Folders::new();
        let assets = folders.assets();
        let scene = assets.scene_name().to_owned();
        assert_eq!(content(&assets, "bunny_200.obj", &scene).unwrap(), "inside/bunny_200.obj");
        let part = assets.open("sub/part.txt", &scene).unwrap().path;
        assert_eq!(part, scene.replace("scene.txt", "sub/part.txt"));
        assert_eq!(content(&assets, "../bunny_200.obj", &part).unwrap(), "inside/bunny_200.obj");
        assert_eq!(
            assets.open("sub/../bunny_200.obj", &scene).unwrap().path,
            assets.open("bunny_200.obj", &scene).unwrap().path
        );
        assert_eq!(assets.opened().len(), 3);
    }

    #[test]
    fn names_that_lead_outside_are_refused_unless_allowed() {
        let folders = Folders::new();
        let absolute = folders.path("outside/x.obj").to_string_lossy().into_owned();
        let assets = folders.assets();
        for name in ["../outside/x.obj", "sub/../../outside/x.obj", "../outside/missing.obj", &absolute] {
            let refused = content(&assets, name, assets.scene_name());
            assert!(matches!(refused, Err(AssetError::Outside)), "{name}: {refused:?}");
        }
        let assets = folders.assets().allow_outside(true);
        for name in ["../outside/x.obj", &absolute] {
            assert_eq!(content(&assets, name, assets.scene_name()).unwrap(), "outside/x.obj");
        }
    }

    #[test]
    fn progress_is_told_piece_by_piece() {
        #[derive(Debug, Default)]
        struct Heard(Mutex<Vec<String>>);
        impl LoadProgress for Heard {
            fn step(&self, step: LoadStep<'_>) {
                self.0.lock().unwrap().push(format!("{step:?}"));
            }
        }
        let (folders, heard) = (Folders::new(), Arc::new(Heard::default()));
        let assets = folders.assets().watched_by(Some(heard.clone()));
        let text = content(&assets, "bunny_200.obj", assets.scene_name()).unwrap();
        assets.progress(LoadStep::Building { path: "b", triangles: 3 });
        let heard = heard.0.lock().unwrap();
        assert!(
            heard.iter().any(|step| step.contains(&format!("done: {0}, total: {0}", text.len()))),
            "{heard:?}"
        );
        assert_eq!(heard.last().unwrap(), "Building { path: \"b\", triangles: 3 }");
    }

    #[test]
    fn extra_folders_are_allowed_and_searched() {
        let folders = Folders::new();
        let assets = folders.assets().with_folder(&folders.path("extra")).unwrap();
        for name in ["e.obj", "../extra/e.obj"] {
            assert_eq!(content(&assets, name, assets.scene_name()).unwrap(), "extra/e.obj");
        }
        let refused = content(&assets, "../outside/x.obj", assets.scene_name());
        assert!(matches!(refused, Err(AssetError::Outside)));
        assert!(folders.assets().with_folder(&folders.path("nowhere")).is_err());
    }

    #[test]
    fn a_missing_file_names_its_neighbour() {
        let folders = Folders::new();
        let assets = folders.assets();
        let missing = |name: &str| content(&assets, name, assets.scene_name()).unwrap_err().to_string();
        assert!(
            missing("bunny_20.obj").contains("did you mean `bunny_200.obj`?"),
            "{}",
            missing("bunny_20.obj")
        );
        assert_eq!(missing("quite_something_else"), "there is no such file");
        assert_eq!(missing("no_folder/x.obj"), "there is no such file");
        let assets = FsAssets::new(&folders.path("inside/scen.txt")).unwrap();
        let missing = assets.open(assets.scene_name(), "").unwrap_err().to_string();
        assert!(missing.contains("did you mean `scene.txt`?"), "{missing}");
        assert!(FsAssets::new(&folders.path("nowhere/scene.txt")).is_err());
    }

    #[test]
    fn folders_and_long_files_are_refused() {
        let folders = Folders::new();
        let mut assets = folders.assets();
        assert!(matches!(content(&assets, "sub", assets.scene_name()), Err(AssetError::NotAFile)));
        assets.max_bytes = 5;
        let refused = content(&assets, "bunny_200.obj", assets.scene_name());
        assert!(matches!(refused, Err(AssetError::TooLarge { limit: 5 })));
    }

    #[cfg(unix)]
    #[test]
    fn links_cannot_climb_out() {
        use std::os::unix::fs::symlink;
        let folders = Folders::new();
        symlink("../outside/x.obj", folders.path("inside/link.obj")).unwrap();
        symlink("../outside", folders.path("inside/folder")).unwrap();
        symlink("bunny_200.obj", folders.path("inside/fine.obj")).unwrap();
        symlink(folders.path("inside/scene.txt"), folders.path("extra/scene.txt")).unwrap();
        let assets = folders.assets();
        let open = |name| content(&assets, name, assets.scene_name());
        assert!(matches!(open("link.obj"), Err(AssetError::Outside)));
        assert!(matches!(open("folder/x.obj"), Err(AssetError::Outside)));
        assert_eq!(open("fine.obj").unwrap(), "inside/bunny_200.obj");
        assert_eq!(open("folder/../bunny_200.obj").unwrap(), "inside/bunny_200.obj");

        let assets = FsAssets::new(&folders.path("extra/scene.txt")).unwrap();
        let scene = assets.scene_name().to_owned();
        assert_eq!(content(&assets, &scene, "").unwrap(), "inside/scene.txt");
        assert_eq!(content(&assets, "e.obj", &scene).unwrap(), "extra/e.obj", "beside the link");
        assert!(assets.opened().contains(&fs::canonicalize(folders.path("inside/scene.txt")).unwrap()));
    }

    #[cfg(unix)]
    #[test]
    fn a_refusal_does_not_tell_what_is_outside() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folders = Folders::new();
        fs::create_dir_all(folders.path("outside/locked/x")).unwrap();
        fs::set_permissions(folders.path("outside/locked"), fs::Permissions::from_mode(0o000)).unwrap();
        for (link, target) in [
            ("there.obj", "../outside/x.obj"),
            ("absent.obj", "../outside/nothing.obj"),
            ("folder", "../outside"),
            ("no_folder", "../nowhere"),
            ("locked", "../outside/locked/x"),
        ] {
            symlink(target, folders.path("inside").join(link)).unwrap();
        }
        let assets = folders.assets();
        let refusal = |name: &str| content(&assets, name, assets.scene_name()).unwrap_err().to_string();
        let expected = AssetError::Outside.to_string();
        for name in [
            "there.obj",
            "absent.obj",
            "folder/x.obj",
            "folder/y.obj",
            "folder/nowhere/y.obj",
            "no_folder/x.obj",
            "locked/x.obj",
            "../outside/x.obj",
            "../outside/nothing.obj",
            "/etc/passwd",
            "/nothing",
        ] {
            assert_eq!(refusal(name), expected, "{name}");
        }
        assert_eq!(refusal("folder/../y"), "there is no such file");
        let extra = folders.assets().with_folder(&folders.path("extra")).unwrap();
        let refusal = content(&extra, "folder/y.obj", extra.scene_name()).unwrap_err().to_string();
        assert_eq!(refusal, expected, "another folder is looked into as well");
        fs::set_permissions(folders.path("outside/locked"), fs::Permissions::from_mode(0o755)).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused_before_they_are_opened() {
        let assets = Folders::new().assets().allow_outside(true);
        assert!(matches!(content(&assets, "/dev/zero", assets.scene_name()), Err(AssetError::NotAFile)));
    }
}
