//! The formats of picture files.

use std::fmt;

/// A picture file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Portable Network Graphics, 8 or 16 bits.
    Png,
    /// OpenEXR, floats.
    Exr,
    /// Truevision TGA, 8 bits.
    Tga,
    /// Windows bitmap, 8 bits, without alpha when written.
    Bmp,
    /// Portable pixmap or greymap, 8 bits when written.
    Ppm,
    /// Portable float map.
    Pfm,
    /// Radiance HDR: three mantissas of 8 bits with one exponent.
    Hdr,
    /// JPEG, which is read and not written: it keeps no pixel as it is.
    Jpeg,
    /// WebP, which is read and not written.
    WebP,
}

impl Format {
    /// All formats that are written.
    pub const ALL: [Self; 7] = [Self::Png, Self::Exr, Self::Tga, Self::Bmp, Self::Ppm, Self::Pfm, Self::Hdr];

    /// The format of files that end in `.extension`, in any case, of those that are written.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Some(match extension.to_ascii_lowercase().as_str() {
            "png" => Self::Png,
            "exr" => Self::Exr,
            "tga" => Self::Tga,
            "bmp" | "dib" => Self::Bmp,
            "ppm" | "pgm" | "pbm" | "pnm" => Self::Ppm,
            "pfm" => Self::Pfm,
            "hdr" | "pic" | "rgbe" => Self::Hdr,
            _ => return None,
        })
    }

    /// The usual ending of such files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
            Self::Tga => "tga",
            Self::Bmp => "bmp",
            Self::Ppm => "ppm",
            Self::Pfm => "pfm",
            Self::Hdr => "hdr",
            Self::Jpeg => "jpg",
            Self::WebP => "webp",
        }
    }

    /// The format a file's first bytes name. TGA has no such bytes.
    pub fn from_magic(bytes: &[u8]) -> Option<Self> {
        Some(match bytes {
            [0x89, b'P', b'N', b'G', ..] => Self::Png,
            [0x76, 0x2f, 0x31, 0x01, ..] => Self::Exr,
            [b'#', b'?', ..] => Self::Hdr,
            [0xff, 0xd8, 0xff, ..] => Self::Jpeg,
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Self::WebP,
            // Six bytes on there are two zeros.
            [b'B', b'M', _, _, _, _, 0, 0, ..] => Self::Bmp,
            [b'P', b'F' | b'f', ..] => Self::Pfm,
            [b'P', b'1'..=b'7', ..] => Self::Ppm,
            _ => return None,
        })
    }

    /// Whether the file holds floats, linear and unclamped, rather than numbers for a screen.
    pub fn is_float(self) -> bool {
        matches!(self, Self::Exr | Self::Pfm | Self::Hdr)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png => "PNG",
            Self::Exr => "OpenEXR",
            Self::Tga => "TGA",
            Self::Bmp => "BMP",
            Self::Ppm => "PPM",
            Self::Pfm => "PFM",
            Self::Hdr => "Radiance HDR",
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
        })
    }
}
