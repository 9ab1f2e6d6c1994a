//! Folders of pictures, one for each pair of directions, as the collection UBO2003 of the University of Bonn has them.
//!
//! The name of a picture says its directions in whole degrees: `tl` and `pl` for the angles of the light to the normal and around it, `tv`
//! and `pv` for those of the viewer, such as `00042_tl030_pl120_tv015_pv060.jpg`. Pictures show the rectified surface, all of one size.
//! They are photographs: a value is a share of what a white matt surface facing the light would send, with the cosine of
//! the light in it, so `f cos θi` is the value over π.

use std::collections::BTreeMap;
use std::f32::consts::FRAC_1_PI;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use kajo_color::srgb;
use kajo_core::measured::btf::BtfSamples;
use kajo_image::{DecodeLimits, Format, Image, decode};
use kajo_scene::{MemoryBudget, OverBudget};

/// Why pictures make no texture.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// Something could not be read.
    #[error("cannot read `{}`: {source}", .path.display())]
    Read {
        /// What.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A picture could not be decoded.
    #[error("cannot read `{}`: {source}", .path.display())]
    Decode {
        /// Which.
        path: PathBuf,
        /// Why.
        source: kajo_image::ImageError,
    },
    /// No name says directions.
    #[error("no picture in `{}` says its directions in its name, such as `tl030_pl120_tv015_pv060`", .0.display())]
    Empty(PathBuf),
    /// A pair of directions has no picture, or two.
    #[error("there are {views} views and {lights} lights, and {found} pictures of them; {example}")]
    Pairs {
        /// Directions to the viewer.
        views: usize,
        /// Directions to the light.
        lights: usize,
        /// Pictures.
        found: usize,
        /// One that is wrong.
        example: String,
    },
    /// Pictures differ in size.
    #[error("`{}` has {} x {} pixels, and others have {} x {}", .path.display(), .found[0], .found[1], .expected[0], .expected[1])]
    Size {
        /// Which.
        path: PathBuf,
        /// Its size.
        found: [u32; 2],
        /// That of others.
        expected: [u32; 2],
    },
    /// Samples need more memory than there is.
    #[error(transparent)]
    Memory(#[from] OverBudget),
}

/// Angles in degrees.
type Degrees = [u16; 2];

/// Directions of light and viewer that a file's name says.
fn directions_in(name: &str) -> Option<[Degrees; 2]> {
    let number = |key: &str| {
        let digits = |at: usize| {
            let digits: String = name[at + key.len()..].chars().take_while(char::is_ascii_digit).collect();
            digits.parse::<u16>().ok()
        };
        name.match_indices(key).find_map(|(at, _)| digits(at))
    };
    Some([[number("tl")?, number("pl")?], [number("tv")?, number("pv")?]])
}

/// Pictures in a folder and those below it, by view and light.
fn pictures(folder: &Path) -> Result<BTreeMap<(Degrees, Degrees), PathBuf>, FolderError> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let failed = |source| FolderError::Read { path: folder.clone(), source };
        let mut paths = Vec::new();
        for entry in fs::read_dir(&folder).map_err(failed)? {
            paths.push(entry.map_err(failed)?.path());
        }
        paths.sort();
        for path in paths {
            let is_folder = fs::symlink_metadata(&path).is_ok_and(|about| about.is_dir());
            if is_folder {
                folders.push(path);
                continue;
            }
            let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
            let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
            if Format::from_extension(ending).is_none() && !matches!(ending, "jpg" | "jpeg" | "webp") {
                continue;
            }
            let Some([light, view]) = directions_in(&name) else { continue };
            if let Some(other) = found.insert((view, light), path.clone()) {
                let example = format!("`{}` and `{}` are of the same", path.display(), other.display());
                let found = found.len() + 1;
                return Err(FolderError::Pairs { views: 0, lights: 0, found, example });
            }
        }
    }
    Ok(found)
}

/// Samples of all pictures in a folder and those below it.
///
/// * `most`: texels along a side at most; larger pictures are averaged
/// * `done`: told how many pictures are read, and of how many
///
/// # Errors
/// [`FolderError`].
pub fn read_folder(
    folder: &Path,
    most: u32,
    memory: &MemoryBudget,
    mut done: impl FnMut(usize, usize),
) -> Result<BtfSamples, FolderError> {
    let pictures = pictures(folder)?;
    let distinct = |of: fn(&(Degrees, Degrees)) -> Degrees| {
        let mut all: Vec<Degrees> = pictures.keys().map(of).collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let (views, lights) = (distinct(|pair| pair.0), distinct(|pair| pair.1));
    if pictures.is_empty() {
        return Err(FolderError::Empty(folder.to_path_buf()));
    }
    let pairs = || views.iter().flat_map(|&view| lights.iter().map(move |&light| (view, light)));
    if let Some((view, light)) = pairs().find(|pair| !pictures.contains_key(pair)) {
        let example =
            format!("that of light {} {} and view {} {} is missing", light[0], light[1], view[0], view[1]);
        let found = pictures.len();
        return Err(FolderError::Pairs { views: views.len(), lights: lights.len(), found, example });
    }
    let (mut values, mut size, mut _share) = (Vec::new(), [0, 0], None);
    let (width, total) = (3 * views.len() * lights.len(), pictures.len());
    for (i, pair) in pairs().enumerate() {
        let path = &pictures[&pair];
        let image = reduced(&read_picture(path)?, most);
        let found = [image.width(), image.height()];
        if i == 0 {
            size = found;
            let count = u64::from(found[0]) * u64::from(found[1]) * width as u64;
            _share = Some(memory.share(4 * count)?);
            values = vec![0.0; count as usize];
        }
        if found != size {
            return Err(FolderError::Size { path: path.clone(), found, expected: size });
        }
        for (texel, pixel) in image.pixels().enumerate() {
            values[texel * width + 3 * i..][..3].copy_from_slice(&pixel[..3]);
        }
        done(i + 1, total);
    }
    let radians =
        |all: Vec<Degrees>| all.iter().map(|&[t, p]| [t, p].map(|a| f32::from(a).to_radians())).collect();
    Ok(BtfSamples { size, views: radians(views), lights: radians(lights), has_cosine: true, values })
}

/// A picture in linear RGB over π.
fn read_picture(path: &Path) -> Result<Image, FolderError> {
    let bytes = fs::read(path).map_err(|source| FolderError::Read { path: path.to_path_buf(), source })?;
    let hint = path.extension().and_then(|ending| Format::from_extension(&ending.to_string_lossy()));
    let failed = |source| FolderError::Decode { path: path.to_path_buf(), source };
    let decoded = decode(&bytes, hint, &DecodeLimits::default()).map_err(failed)?;
    let is_linear = decoded.depth.is_none();
    let value = |v: f32| FRAC_1_PI * if is_linear { v } else { srgb::decode(v) };
    let source = &decoded.image;
    let mut image = Image::new(source.width(), source.height(), 3).map_err(failed)?;
    for (to, from) in image.data_mut().chunks_exact_mut(3).zip(source.pixels()) {
        let rgb = if from.len() < 3 { [from[0]; 3] } else { [from[0], from[1], from[2]] };
        to.copy_from_slice(&rgb.map(value));
    }
    Ok(image)
}

/// The picture with at most so many pixels along its sides, each the mean of a block.
fn reduced(image: &Image, most: u32) -> Image {
    let factor = image.width().max(image.height()).div_ceil(most.max(1));
    if factor <= 1 {
        return image.clone();
    }
    let (width, height) = ((image.width() / factor).max(1), (image.height() / factor).max(1));
    let mean = |x: u32, y: u32| {
        let (mut sum, mut n) = ([0.0; 3], 0.0);
        for y in y * factor..((y + 1) * factor).min(image.height()) {
            let row = image.row(y);
            for x in x * factor..((x + 1) * factor).min(image.width()) {
                sum = [0, 1, 2].map(|c| sum[c] + row[3 * x as usize + c]);
                n += 1.0;
            }
        }
        sum.map(|v| v / n)
    };
    Image::from_fn(width, height, mean).unwrap_or_else(|_| image.clone())
}

#[cfg(test)]
mod tests {
    use kajo_image::{EncodeOptions, encode};

    use super::*;

    #[test]
    fn names_say_directions() {
        let expected = Some([[30, 120], [15, 60]]);
        assert_eq!(directions_in("00042_tl030_pl120_tv015_pv060.jpg"), expected);
        assert_eq!(directions_in("00042 tl030 pl120 tv015 pv060.png"), expected);
        assert_eq!(directions_in("tl030_pl120_tv015.png"), None);
        assert_eq!(directions_in("plain.png"), None);
    }

    #[test]
    fn a_folder_becomes_samples() {
        let folder = std::env::temp_dir().join(format!("kajo_ubo_{}", std::process::id()));
        fs::create_dir_all(folder.join("tv015_pv060")).unwrap();
        let picture = |grey: f32| {
            let image = Image::from_fn(4, 2, |x, _| if x < 2 { [grey; 3] } else { [0.5 * grey; 3] }).unwrap();
            encode(&image, Format::Pfm, &EncodeOptions::default()).unwrap()
        };
        let names = [
            ("tl000_pl000_tv000_pv000.pfm", 0.1),
            ("tl030_pl090_tv000_pv000.pfm", 0.2),
            ("tv015_pv060/tl000_pl000_tv015_pv060.pfm", 0.3),
            ("tv015_pv060/tl030_pl090_tv015_pv060.pfm", 0.4),
        ];
        for (name, grey) in names {
            fs::write(folder.join(name), picture(grey)).unwrap();
        }
        let read = || read_folder(&folder, 2, &MemoryBudget::default(), |_, _| {});
        let samples = read().unwrap();
        assert_eq!((samples.size, samples.views.len(), samples.lights.len()), ([2, 1], 2, 2));
        assert_eq!(samples.lights[1], [30f32.to_radians(), 90f32.to_radians()]);
        let grey: Vec<f32> = samples.values.iter().step_by(3).map(|v| v / FRAC_1_PI).collect();
        for (found, expected) in grey.iter().zip([0.1, 0.2, 0.3, 0.4, 0.05, 0.1, 0.15, 0.2]) {
            assert!((found - expected).abs() < 1e-6, "{grey:?}");
        }
        fs::remove_file(folder.join(names[3].0)).unwrap();
        let said = read().unwrap_err().to_string();
        assert!(said.contains("3 pictures") && said.contains("light 30 90 and view 15 60"), "{said}");
        fs::remove_dir_all(&folder).unwrap();
        assert!(matches!(read().unwrap_err(), FolderError::Read { .. }));
    }
}
