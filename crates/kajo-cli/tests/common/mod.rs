//! A folder of its own for each test, and runs of the program in it.
#![allow(dead_code, reason = "every test program uses a part of this")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A small scene with a light, a shadow and a mirror.
pub const BALL: &str = "\
PerspectiveCamera { center 0 1 9  direction 0 -0.1 -1  up 0 1 0  angle 30 }
Background { color 0.2 0.3 0.5  ambientLight 0.1 0.1 0.1 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 } }
Materials {
  PhongMaterial gold { diffuseColor 0.8 0.6 0.2  specularColor 1 1 1  exponent 20  reflectiveColor 0.3 0.3 0.3 }
  PhongMaterial floor { diffuseColor 0.5 0.5 0.5 }
}
Group {
  MaterialIndex gold   Sphere ball { center 0 0 0  radius 1 }
  MaterialIndex floor  Plane { normal 0 1 0  offset -1 }
}
";

/// A temporary folder.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// With `ball.txt` in it.
    pub fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.write("ball.txt", BALL);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Names of all files in the folder itself, hidden ones included.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program, to be started in the folder.
    pub fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kajo"));
        command.current_dir(self.0.path()).stdin(Stdio::null()).env("NO_COLOR", "1");
        command
    }

    /// Runs the program with the words of `line`.
    pub fn run(&self, line: &str) -> Ran {
        Ran::from(self.command().args(line.split_whitespace()).output().unwrap())
    }

    /// Runs the words of `line` by the program, and it by a shell after `before`.
    pub fn run_in_shell(&self, before: &str, line: &str) -> Ran {
        let script = format!("{before}; exec {} {line}", env!("CARGO_BIN_EXE_kajo"));
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(script).current_dir(self.0.path()).stdin(Stdio::null()).env("NO_COLOR", "1");
        Ran::from(shell.output().unwrap())
    }

    /// Makes a named pipe.
    pub fn pipe(&self, name: &str) {
        assert!(Command::new("mkfifo").arg(self.path(name)).status().unwrap().success());
    }

    /// Names of files in the making that were left behind.
    pub fn parts(&self) -> Vec<String> {
        self.names().into_iter().filter(|name| name.ends_with(".part")).collect()
    }

    /// Runs the program and makes sure that it succeeds.
    pub fn succeed(&self, line: &str) -> Ran {
        let ran = self.run(line);
        assert_eq!(ran.code, Some(0), "kajo {line}\n{}{}", ran.stdout, ran.stderr);
        ran
    }

    /// Runs the program and makes sure that it fails with this code, saying these things.
    pub fn fail(&self, line: &str, code: i32, said: &[&str]) -> Ran {
        let ran = self.run(line);
        assert_eq!(ran.code, Some(code), "kajo {line}\n{}{}", ran.stdout, ran.stderr);
        for part in said {
            assert!(ran.stderr.contains(part), "kajo {line}\nshould say `{part}`, said\n{}", ran.stderr);
        }
        assert!(!ran.stderr.contains("this is a bug in kajo"), "kajo {line}\n{}", ran.stderr);
        ran
    }
}

/// How a run ended and what it said.
pub struct Ran {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Ran {
        Ran {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// The folder that holds all crates.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Reads a picture.
pub fn picture(path: &Path) -> kajo::Image {
    kajo::compare::read_picture(path).unwrap_or_else(|error| panic!("{error}")).image
}
