//! How large a picture a decoder may make.

use crate::ImageError;

/// Bounds checked against a picture's header before memory is reserved for its pixels.
///
/// A file of a few bytes can claim four thousand million pixels in each direction, and a
/// compressed one can keep a promise of gigabytes. The defaults, 65,536 pixels a side and
/// 2 GiB, let every picture through that a person would make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DecodeLimits {
    /// Largest width and largest height, in pixels.
    pub max_side: u32,
    /// Most memory for pixels while decoding: the decoder's buffer and the result, in bytes.
    pub max_bytes: u64,
}

impl Default for DecodeLimits {
    fn default() -> Self {
        Self { max_side: 1 << 16, max_bytes: 2 << 30 }
    }
}

impl DecodeLimits {
    /// Checks a picture that takes `bytes_per_pixel` while it is decoded.
    ///
    /// # Errors
    /// [`ImageError::Limit`] names the first bound that is exceeded.
    pub fn check(&self, width: u64, height: u64, bytes_per_pixel: u64) -> Result<(), ImageError> {
        within("width in pixels", width, self.max_side.into())?;
        within("height in pixels", height, self.max_side.into())?;
        // Two sides of 32 bits cannot overflow 64; the size of a pixel may.
        self.check_bytes((width * height).saturating_mul(bytes_per_pixel))
    }

    /// Checks a picture that takes `needed` bytes in all while it is decoded.
    ///
    /// # Errors
    /// [`ImageError::Limit`].
    pub fn check_bytes(&self, needed: u64) -> Result<(), ImageError> {
        within("memory in bytes", needed, self.max_bytes)
    }
}

fn within(what: &'static str, needed: u64, limit: u64) -> Result<(), ImageError> {
    if needed > limit { Err(ImageError::Limit { what, needed, limit }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bound_is_inclusive_and_named() {
        let limits = DecodeLimits { max_side: 10, max_bytes: 800 };
        assert_eq!(limits.check(10, 10, 8), Ok(()));
        let refused = |w, h, bytes| match limits.check(w, h, bytes) {
            Err(ImageError::Limit { what, .. }) => what,
            other => panic!("{other:?}"),
        };
        assert_eq!(refused(11, 1, 1), "width in pixels");
        assert_eq!(refused(1, 11, 1), "height in pixels");
        assert_eq!(refused(10, 10, 9), "memory in bytes");
        assert_eq!(refused(u64::MAX, u64::MAX, u64::MAX), "width in pixels");
        assert_eq!(refused(10, 10, u64::MAX), "memory in bytes");
    }
}
