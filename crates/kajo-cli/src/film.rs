//! Pictures of frames joined to a video by ffmpeg, where that is installed.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::failure::Failure;

/// Endings of videos, with what ffmpeg is told for them.
const KINDS: [(&str, &[&str]); 4] = [
    ("mp4", H264_STREAMED),
    ("mov", H264_STREAMED),
    ("mkv", H264),
    ("webm", &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-pix_fmt", "yuv420p"]),
];

const H264: &[&str] = &["-c:v", "libx264", "-crf", "16", "-preset", "slow", "-pix_fmt", "yuv420p"];

/// The same, with what a player needs first at the beginning of the file.
const H264_STREAMED: &[&str] =
    &["-c:v", "libx264", "-crf", "16", "-preset", "slow", "-pix_fmt", "yuv420p", "-movflags", "+faststart"];

/// Sides are even, as the codecs want them. Pictures are sRGB; without a word ffmpeg would make luma and chroma of them by BT.601, which players
/// take for those of BT.709 where a picture is large.
const FILTER: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv";

/// What the file says of its colours.
const COLORS: [&str; 8] =
    ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv"];

/// What joins the pictures.
const PROGRAM: &str = "ffmpeg";

/// A video to be made.
#[derive(Debug)]
pub struct Film {
    path: PathBuf,
    /// Where its frames are kept until it is finished.
    folder: PathBuf,
    fps: f64,
    options: &'static [&'static str],
}

impl Film {
    /// Whether the ending of a name is that of a video.
    pub fn is_one(path: &Path) -> bool {
        kind(path).is_some()
    }

    /// The video at `path`.
    ///
    /// * `fps`: frames of a second; 24 without
    /// * `count`: how many frames it has
    ///
    /// # Errors
    /// When ffmpeg is not installed, or the folder for the frames cannot be made.
    pub fn new(path: &Path, fps: Option<f64>, count: usize) -> Result<Film, Failure> {
        let options = kind(path).unwrap_or(H264);
        let version =
            Command::new(PROGRAM).arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !version.is_ok_and(|status| status.success()) {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            return Err(Failure::Input(format!(
                "a video is made by ffmpeg, which is not installed: `apt install ffmpeg`, `dnf install ffmpeg-free` or \
                 `brew install ffmpeg`; or write pictures: -o {stem}.####.png"
            )));
        }
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".frames");
        let folder = path.with_file_name(name);
        std::fs::create_dir_all(&folder).map_err(|error| {
            Failure::Output(format!(
                "cannot make the folder `{}` for {count} frames: {error}",
                folder.display()
            ))
        })?;
        Ok(Film { path: path.to_owned(), folder, fps: fps.unwrap_or(24.0), options })
    }

    /// The file of the video.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The pattern of the names of its frames.
    pub fn pattern(&self) -> PathBuf {
        self.folder.join("######.png")
    }

    /// Joins the pictures, and removes them once the video is there.
    ///
    /// * `pictures`: of its frames, in order
    ///
    /// # Errors
    /// When ffmpeg fails; then the pictures stay, and what it says is shown.
    pub fn join(&self, pictures: &[PathBuf]) -> Result<(), Failure> {
        let list = self.folder.join("frames.txt");
        let mut lines = String::from("ffconcat version 1.0\n");
        for picture in pictures {
            let name = picture.file_name().unwrap_or_default().to_string_lossy();
            let _ = write!(lines, "file {name}\nduration {:.9}\n", 1.0 / self.fps);
        }
        let failed = |what: String| {
            Failure::Output(format!(
                "cannot make `{}`: {what}; its frames are in `{}`",
                self.path.display(),
                self.folder.display()
            ))
        };
        std::fs::write(&list, lines).map_err(|error| failed(error.to_string()))?;
        // Beside the frames, so that an unfinished one takes no place of a finished one.
        let part = self.folder.join(self.path.file_name().unwrap_or_default());
        let rate = format!("{}", self.fps);
        let output = Command::new(PROGRAM)
            .args(["-hide_banner", "-loglevel", "error", "-y", "-f", "concat", "-safe", "0", "-i"])
            .arg(&list)
            .args(["-vf", FILTER, "-r", &rate])
            .args(self.options)
            .args(COLORS)
            .arg(&part)
            .stdin(Stdio::null())
            .output()
            .map_err(|error| failed(error.to_string()))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            let said = said.trim();
            return Err(failed(format!(
                "ffmpeg failed: {}",
                if said.is_empty() { "it does not say why" } else { said }
            )));
        }
        std::fs::rename(&part, &self.path).map_err(|error| failed(error.to_string()))?;
        for file in pictures.iter().chain([&list]) {
            // What cannot be removed does no harm.
            let _ = std::fs::remove_file(file);
        }
        let _ = std::fs::remove_dir(&self.folder);
        Ok(())
    }
}

fn kind(path: &Path) -> Option<&'static [&'static str]> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    KINDS.iter().find(|(name, _)| *name == ending).map(|(_, options)| *options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn videos_are_known_by_their_endings() {
        assert!(Film::is_one(Path::new("a/film.MP4")) && Film::is_one(Path::new("b.webm")));
        assert!(!Film::is_one(Path::new("film.png")) && !Film::is_one(Path::new("mp4")));
    }
}
