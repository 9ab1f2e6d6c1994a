//! Intel Open Image Denoise, found at run time.
//!
//! The library is no part of kajo: where it is installed its functions are looked up by name and called
//! through its C interface, versions 1.4 and 2 of it. Where it is not, [`Oidn::load`] says what was looked
//! for. The pictures it makes are its own affair: other versions make others.
#![expect(unsafe_code, reason = "calls of a C library, whose functions are looked up at run time")]

use std::ffi::{CStr, OsStr, OsString, c_char, c_int, c_void};
use std::ptr;

use libloading::Library;
use thiserror::Error;

use super::Guided;
use crate::{Image, ImageError};

/// Names of the library, newest first.
const NAMES: [&str; 4] = if cfg!(target_os = "windows") {
    ["OpenImageDenoise.dll", "OpenImageDenoise2.dll", "OpenImageDenoise1.dll", "libOpenImageDenoise.dll"]
} else if cfg!(target_os = "macos") {
    [
        "libOpenImageDenoise.2.dylib",
        "libOpenImageDenoise.dylib",
        "libOpenImageDenoise.1.dylib",
        "libOpenImageDenoise.0.dylib",
    ]
} else {
    [
        "libOpenImageDenoise.so.2",
        "libOpenImageDenoise.so",
        "libOpenImageDenoise.so.1",
        "libOpenImageDenoise.so.0",
    ]
};

/// `OIDN_DEVICE_TYPE_CPU`: its pictures do not depend on a graphics card.
const CPU: c_int = 1;

/// `OIDN_FORMAT_FLOAT3`
const FLOAT3: c_int = 3;

/// Why there is no denoised picture.
#[derive(Debug, Error)]
pub enum OidnError {
    /// The library is not there.
    #[error("Intel Open Image Denoise is not installed: {reason}")]
    NotFound {
        /// What the system said of the first name that was tried.
        reason: String,
    },
    /// A library of that name lacks a function.
    #[error("this version of Intel Open Image Denoise cannot be used: {reason}")]
    Unsuitable {
        /// What is missing.
        reason: String,
    },
    /// It refused the picture.
    #[error("Intel Open Image Denoise failed: {0}")]
    Failed(String),
    /// The images do not fit together.
    #[error(transparent)]
    Image(#[from] ImageError),
}

type Device = *mut c_void;
type Filter = *mut c_void;
type Of<Handle> = unsafe extern "C" fn(Handle);
type SetImage =
    unsafe extern "C" fn(Filter, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize);

/// The library's functions that are needed.
pub struct Oidn {
    new_device: unsafe extern "C" fn(c_int) -> Device,
    set_threads: unsafe extern "C" fn(Device, *const c_char, c_int),
    commit_device: Of<Device>,
    device_error: unsafe extern "C" fn(Device, *mut *const c_char) -> c_int,
    release_device: Of<Device>,
    new_filter: unsafe extern "C" fn(Device, *const c_char) -> Filter,
    set_image: SetImage,
    set_bool: unsafe extern "C" fn(Filter, *const c_char, bool),
    commit_filter: Of<Filter>,
    execute_filter: Of<Filter>,
    release_filter: Of<Filter>,
    /// Keeps the functions where they are; dropped last.
    _library: Library,
}

impl std::fmt::Debug for Oidn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Oidn")
    }
}

impl Oidn {
    /// Finds the library.
    ///
    /// * `path`: its file; where the system keeps libraries, when `None`
    ///
    /// # Errors
    /// [`OidnError::NotFound`], or [`OidnError::Unsuitable`] when it lacks a function.
    pub fn load(path: Option<&OsStr>) -> Result<Oidn, OidnError> {
        let names: Vec<OsString> = match path {
            Some(path) => vec![path.to_owned()],
            None => NAMES.iter().map(OsString::from).collect(),
        };
        let mut reason = None;
        for name in &names {
            // SAFETY: the initialisers of this library may be run at any time from any thread; a file of this name
            // that is something else is the user's own doing, as with any library that a program loads.
            match unsafe { Library::new(name) } {
                Ok(library) => return Oidn::from_library(library),
                Err(error) => reason = reason.or_else(|| Some(error.to_string())),
            }
        }
        Err(OidnError::NotFound { reason: reason.unwrap_or_default() })
    }

    fn from_library(library: Library) -> Result<Oidn, OidnError> {
        // SAFETY: the types are those of `OpenImageDenoise/oidn.h`, the same in all versions that have these
        // names, and the functions live as long as the library, which is kept beside them.
        unsafe {
            Ok(Oidn {
                new_device: function(&library, "oidnNewDevice")?,
                set_threads: function(&library, "oidnSetDeviceInt")
                    .or_else(|_| function(&library, "oidnSetDevice1i"))?,
                commit_device: function(&library, "oidnCommitDevice")?,
                device_error: function(&library, "oidnGetDeviceError")?,
                release_device: function(&library, "oidnReleaseDevice")?,
                new_filter: function(&library, "oidnNewFilter")?,
                set_image: function(&library, "oidnSetSharedFilterImage")?,
                set_bool: function(&library, "oidnSetFilterBool")
                    .or_else(|_| function(&library, "oidnSetFilter1b"))?,
                commit_filter: function(&library, "oidnCommitFilter")?,
                execute_filter: function(&library, "oidnExecuteFilter")?,
                release_filter: function(&library, "oidnReleaseFilter")?,
                _library: library,
            })
        }
    }

    /// The picture with less noise. The variance is not looked at.
    ///
    /// * `threads`: 0 for as many as the library likes
    ///
    /// # Errors
    /// [`OidnError::Image`] when the images do not fit together, [`OidnError::Failed`] with the library's own words.
    pub fn denoise(&self, picture: &Guided<'_>, threads: usize) -> Result<Image, OidnError> {
        picture.check()?;
        let mut result = picture.color.clone();
        // SAFETY: handles are used while they live and released once. The images are as large as is said,
        // stay where they are until the filter is released, and only `output` is written, which nobody else
        // holds.
        unsafe {
            let device = (self.new_device)(CPU);
            if device.is_null() {
                return Err(self.failure(device));
            }
            (self.set_threads)(device, c"numThreads".as_ptr(), threads.try_into().unwrap_or(0));
            (self.commit_device)(device);
            let filter = (self.new_filter)(device, c"RT".as_ptr());
            if filter.is_null() {
                let failure = self.failure(device);
                (self.release_device)(device);
                return Err(failure);
            }
            let guides =
                [(c"color", picture.color), (c"albedo", picture.albedo), (c"normal", picture.normal)];
            for (name, image) in guides {
                self.set(filter, name, image.data().as_ptr().cast_mut().cast(), image);
            }
            self.set(filter, c"output", result.data_mut().as_mut_ptr().cast(), picture.color);
            (self.set_bool)(filter, c"hdr".as_ptr(), true);
            (self.commit_filter)(filter);
            (self.execute_filter)(filter);
            let mut message = ptr::null();
            let code = (self.device_error)(device, &mut message);
            let failure = (code != 0).then(|| failed(message));
            (self.release_filter)(filter);
            (self.release_device)(device);
            failure.map_or(Ok(result), Err)
        }
    }

    /// Names an image of the size of `like` for a filter.
    ///
    /// # Safety
    /// `filter` lives, and `data` stays valid for three floats a pixel until it is released.
    unsafe fn set(&self, filter: Filter, name: &CStr, data: *mut c_void, like: &Image) {
        let (width, height) = (like.width() as usize, like.height() as usize);
        // SAFETY: as the caller promised; strides of zero mean that pixels lie one behind the other.
        unsafe { (self.set_image)(filter, name.as_ptr(), data, FLOAT3, width, height, 0, 0, 0) }
    }

    /// What the device, or without one the library, says of its last mistake.
    ///
    /// # Safety
    /// `device` is null or lives.
    unsafe fn failure(&self, device: Device) -> OidnError {
        let mut message = ptr::null();
        // SAFETY: as the caller promised; the message is not used after another call.
        unsafe {
            (self.device_error)(device, &mut message);
            failed(message)
        }
    }
}

/// A function of a library.
///
/// # Safety
/// `F` is its type.
unsafe fn function<F: Copy>(library: &Library, name: &str) -> Result<F, OidnError> {
    // SAFETY: as the caller promised.
    let symbol = unsafe { library.get::<F>(name.as_bytes()) };
    symbol.map(|symbol| *symbol).map_err(|error| OidnError::Unsuitable { reason: error.to_string() })
}

/// # Safety
/// `message` is null or a text that ends with a zero.
unsafe fn failed(message: *const c_char) -> OidnError {
    if message.is_null() {
        return OidnError::Failed("it does not say why".to_owned());
    }
    // SAFETY: as the caller promised.
    OidnError::Failed(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_that_is_not_there_is_an_error() {
        let missing = Oidn::load(Some(OsStr::new("libNoSuchDenoiser.so.99")));
        let Err(error @ OidnError::NotFound { .. }) = missing else { panic!("found") };
        assert!(error.to_string().contains("libNoSuchDenoiser"), "{error}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn another_library_is_an_error() {
        match Oidn::load(Some(OsStr::new("libc.so.6"))) {
            Err(OidnError::Unsuitable { reason }) => assert!(reason.contains("oidn"), "{reason}"),
            // Systems with another C library.
            Err(OidnError::NotFound { .. }) => {}
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn where_it_is_installed_it_smooths() {
        let Ok(oidn) = Oidn::load(std::env::var_os("KAJO_OIDN").as_deref()) else { return };
        let noise = |x: u32, y: u32| 0.5 + 0.4 * f32::from(u8::from((x * 7 + y * 13) % 5 < 2));
        let color = Image::from_fn(64, 48, |x, y| [noise(x, y); 3]).unwrap();
        let flat = Image::filled(64, 48, &[0.5; 3]).unwrap();
        let picture = Guided { color: &color, variance: &flat, albedo: &flat, normal: &flat };
        let smooth = oidn.denoise(&picture, 2).unwrap();
        let spread = |image: &Image| {
            let mean = image.data().iter().sum::<f32>() / image.data().len() as f32;
            image.data().iter().map(|v| (v - mean) * (v - mean)).sum::<f32>()
        };
        assert!(spread(&smooth) < 0.5 * spread(&color), "{} to {}", spread(&color), spread(&smooth));
        let grey = Image::new(64, 48, 1).unwrap();
        assert!(matches!(oidn.denoise(&Guided { albedo: &grey, ..picture }, 0), Err(OidnError::Image(_))));
    }
}
