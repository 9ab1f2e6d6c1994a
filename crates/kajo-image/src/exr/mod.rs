//! OpenEXR: many layers of float channels in one file.
//!
//! A file is written as **one part** whose channels carry their layer in their name, the
//! convention of the OpenEXR technical introduction: `R G B A` for the picture itself,
//! then `N.X N.Y N.Z`, `uv.U uv.V`, `objectId.id`, and by habit a bare `Z` for depth.
//! Several parts would be equally legal, but a program that knows one part only then
//! shows the first and hides the rest, whereas dotted names are read by all: Nuke and tev
//! list them as layers, Blender opens them in its image nodes, and OpenImageIO returns
//! every channel in the first subimage. Compression is ZIP over 16 lines, which is
//! lossless and read everywhere; where there is no time for it, runs of equal bytes, which is both too.
//!
//! The reader takes both conventions, and any compression the `exr` crate knows.

mod dwa;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::decode;
pub use write::{encode, encode_quickly};

use crate::{Image, ImageError};

/// The content of an OpenEXR file: layers of one size, and remarks.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExrPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Layers; the one without a name is the picture that viewers show.
    pub layers: Vec<ExrLayer>,
    /// Chromaticities of red, green, blue and white, where they are not those of Rec. 709.
    pub chromaticities: Option<[[f32; 2]; 4]>,
    /// Text attributes such as `software`, `comments` or `owner`. A reader returns them
    /// sorted by name, and only those that are text.
    pub attributes: Vec<(String, String)>,
}

/// Channels that belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExrLayer {
    /// What stands before the dot in the file's channel names; `None` for the main layer.
    pub name: Option<String>,
    /// Names without the layer (`R`, `Z`, `id`) and samples, row 0 on top.
    pub channels: Vec<(String, ChannelData)>,
}

/// The `height × width` samples of one channel, in the type they have in the file.
#[derive(Debug, Clone, PartialEq)]
pub enum ChannelData {
    /// 32-bit floats.
    F32(Vec<f32>),
    /// 16-bit floats in the file (range ±65504, 11 significant bits), 32-bit floats here.
    F16(Vec<f32>),
    /// 32-bit whole numbers.
    U32(Vec<u32>),
}

impl ExrPicture {
    /// The layer with this name; `None` asks for the main one.
    pub fn layer(&self, name: Option<&str>) -> Option<&ExrLayer> {
        self.layers.iter().find(|layer| layer.name.as_deref() == name)
    }

    /// The picture a viewer would show: the main layer, or else the first.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when there is no channel, or a channel has the wrong length.
    pub fn main_image(&self) -> Result<Image, ImageError> {
        self.layer(None)
            .or_else(|| self.layers.first())
            .ok_or_else(|| ImageError::parameter("an OpenEXR picture without layers"))?
            .to_image(self.width, self.height)
    }
}

impl ExrLayer {
    /// The channels of `image` as 32-bit floats: `Y`, `Y A`, `R G B` or `R G B A`.
    pub fn from_image(name: Option<&str>, image: &Image) -> Self {
        let names: &[&str] = match image.channels() {
            1 => &["Y"],
            2 => &["Y", "A"],
            3 => &["R", "G", "B"],
            _ => &["R", "G", "B", "A"],
        };
        let plane = |c: usize| ChannelData::F32(image.pixels().map(|pixel| pixel[c]).collect());
        let channels = names.iter().enumerate().map(|(c, &name)| (name.to_owned(), plane(c))).collect();
        Self { name: name.map(str::to_owned), channels }
    }

    /// The samples of the channel with this name.
    pub fn channel(&self, name: &str) -> Option<&ChannelData> {
        self.channels.iter().find(|(n, _)| n == name).map(|(_, data)| data)
    }

    /// The layer as a picture: `R G B`, `X Y Z` or `Y`, with `A` where there is one; a layer
    /// with none of them gives its first three channels, or its first, as colour or grey.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when there is no channel, or one is not `width · height` long.
    pub fn to_image(&self, width: u32, height: u32) -> Result<Image, ImageError> {
        let planes = self.viewable_planes();
        let pixels = width as usize * height as usize;
        if planes.is_empty() || planes.iter().any(|plane| plane.len() != pixels) {
            return Err(ImageError::parameter(format!("a layer without {width} x {height} samples")));
        }
        let mut image = Image::new(width, height, planes.len())?;
        for (i, pixel) in image.data_mut().chunks_exact_mut(planes.len()).enumerate() {
            for (value, plane) in pixel.iter_mut().zip(&planes) {
                *value = plane.get(i);
            }
        }
        Ok(image)
    }

    fn viewable_planes(&self) -> Vec<&ChannelData> {
        let all = |names: &[&str]| names.iter().map(|n| self.channel(n)).collect::<Option<Vec<_>>>();
        match all(&["R", "G", "B"]).or_else(|| all(&["X", "Y", "Z"])).or_else(|| all(&["Y"])) {
            Some(mut planes) => {
                planes.extend(self.channel("A"));
                planes
            }
            None => {
                let n = if self.channels.len() < 3 { 1 } else { 3 };
                self.channels.iter().take(n).map(|(_, data)| data).collect()
            }
        }
    }
}

impl ChannelData {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(v) | Self::F16(v) => v.len(),
            Self::U32(v) => v.len(),
        }
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sample `i`; whole numbers beyond 2²⁴ lose digits.
    fn get(&self, i: usize) -> f32 {
        match self {
            Self::F32(v) | Self::F16(v) => v[i],
            Self::U32(v) => v[i] as f32,
        }
    }
}
