//! Files of bidirectional texture functions, and what they hold.
//!
//! ```text
//! bytes                       what
//! 8                           "kajoBTF" and a line feed
//! u32                         version, 1
//! u32                         1 if values have the cosine of the light in them, plus 2 if they are halves
//! u32 u32                     width and height of the largest level in texels
//! u32 u32                     numbers of views and of lights
//! u32 u32                     numbers of clusters and of components
//! f32 f32 for each            views, then lights: angle to the normal, angle from u towards v; radians
//! values for each cluster     [mean, then components][view][light][red, green, blue]
//! for each texel              u16 cluster, then a value for each component; levels one after the other, rows from above
//! u64                         FNV-1a of all bytes before
//! ```
//!
//! All is little end first. Values are f32 or halves, linear, per steradian. Each level has half the width and height of the one
//! before, rounded down and at least 1, until there is one texel. Lists grow as the file is read, so that no number in it can ask
//! for more memory than the file has bytes.

use std::io::{self, BufReader, Read};

use kajo_math::half;
use kajo_scene::{AssetFile, Limits, MemoryShare};

use super::error::BtfError;
use super::reader::{Reader, Scalar};

const MAGIC: [u8; 8] = *b"kajoBTF\n";
/// How files of the University of Bonn begin.
const SIGNATURES: [&[u8]; 4] = [b"!DFMF", b"!FMF", b"!PVF", b"!BDIF"];
const VERSION: u32 = 1;
const COSINE: u32 = 1;
const HALVES: u32 = 2;

/// Most texels along a side.
pub(super) const MAX_SIDE: u32 = 1 << 16;

/// What a file holds: a compressed texture with all its levels.
#[derive(Clone, Debug, PartialEq)]
pub struct BtfFile {
    /// Width and height of the largest level.
    pub size: [u32; 2],
    /// Angles of the directions to the viewer: to the normal, and from u towards v; radians.
    pub views: Vec<[f32; 2]>,
    /// Angles of the directions to the light.
    pub lights: Vec<[f32; 2]>,
    /// Whether values have the cosine of the light in them.
    pub has_cosine: bool,
    /// Principal components of each cluster.
    pub components: u32,
    /// For each cluster `[mean, then components][view][light][r, g, b]`.
    pub clusters: Vec<f32>,
    /// The cluster of each texel, level by level.
    pub texel_clusters: Vec<u16>,
    /// `components` weights of each texel.
    pub texel_weights: Vec<f32>,
}

/// How values are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BtfEncoding {
    /// 16 bits, about three digits.
    #[default]
    Half,
    /// 32 bits.
    Float,
}

impl BtfFile {
    /// Sizes of all levels, the largest one first.
    pub fn levels(&self) -> Vec<[u32; 2]> {
        levels(self.size)
    }

    /// The number of clusters.
    pub fn cluster_count(&self) -> usize {
        self.clusters.len() / self.cluster_len().max(1)
    }

    /// Numbers of a cluster.
    fn cluster_len(&self) -> usize {
        3 * (1 + self.components as usize) * self.views.len() * self.lights.len()
    }

    /// Refuses numbers that contradict each other, and those that are none.
    pub(super) fn check(&self) -> Result<(), BtfError> {
        let say = |what: String| Err(BtfError::Content(what));
        let [width, height] = self.size;
        if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
            return say(format!(
                "a texture of {width} x {height} texels; each side has to be from 1 to {MAX_SIDE}"
            ));
        }
        let texels: usize = self.levels().iter().map(|[w, h]| *w as usize * *h as usize).sum();
        let weights = texels * self.components as usize;
        let length = self.cluster_len();
        if self.texel_clusters.len() != texels
            || self.texel_weights.len() != weights
            || length == 0
            || self.clusters.is_empty()
            || !self.clusters.len().is_multiple_of(length)
        {
            return say("its lists do not have the lengths that its numbers say".to_owned());
        }
        if let Some(wrong) = self.texel_clusters.iter().find(|&&c| usize::from(c) >= self.cluster_count()) {
            return say(format!("a texel is of cluster {wrong}, and there are {}", self.cluster_count()));
        }
        if !self.clusters.iter().chain(&self.texel_weights).all(|v| v.is_finite()) {
            return say("one of its values is infinite or not a number".to_owned());
        }
        check_horizon(&self.lights, self.has_cosine)
    }
}

/// Refuses lights whose cosine cannot be divided out.
pub(super) fn check_horizon(lights: &[[f32; 2]], has_cosine: bool) -> Result<(), BtfError> {
    let grazing = |&[theta, _]: &[f32; 2]| (1.5698..1.571).contains(&theta);
    match lights.iter().position(grazing).filter(|_| has_cosine) {
        Some(i) => Err(BtfError::Content(format!(
            "light {i} is on the horizon, where values with the cosine of the light in them say nothing"
        ))),
        None => Ok(()),
    }
}

/// Sizes of all levels.
pub(super) fn levels(mut size: [u32; 2]) -> Vec<[u32; 2]> {
    let mut all = vec![size];
    while size != [1, 1] && size[0] > 0 && size[1] > 0 {
        size = size.map(|n| (n / 2).max(1));
        all.push(size);
    }
    all
}

/// FNV-1a [Fowler, Noll and Vo 1991].
#[derive(Clone, Copy)]
struct Checksum(u64);

impl Checksum {
    const START: Checksum = Checksum(0xcbf2_9ce4_8422_2325);

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// The bytes of a file.
pub fn write_btf(file: &BtfFile, encoding: BtfEncoding) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let is_half = encoding == BtfEncoding::Half;
    let flags = u32::from(file.has_cosine) * COSINE + u32::from(is_half) * HALVES;
    let counts = [file.views.len(), file.lights.len(), file.cluster_count()].map(|n| n as u32);
    let head = [VERSION, flags, file.size[0], file.size[1], counts[0], counts[1], counts[2], file.components];
    head.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    let angles = file.views.iter().chain(&file.lights).flatten();
    angles.for_each(|v| bytes.extend(v.to_le_bytes()));
    let value = |v: f32, bytes: &mut Vec<u8>| match encoding {
        BtfEncoding::Half => bytes.extend(half::from_f32(v.clamp(-half::MAX, half::MAX)).to_le_bytes()),
        BtfEncoding::Float => bytes.extend(v.to_le_bytes()),
    };
    file.clusters.iter().for_each(|&v| value(v, &mut bytes));
    let components = file.components as usize;
    for (i, cluster) in file.texel_clusters.iter().enumerate() {
        bytes.extend(cluster.to_le_bytes());
        file.texel_weights[i * components..][..components].iter().for_each(|&v| value(v, &mut bytes));
    }
    let mut sum = Checksum::START;
    sum.add(&bytes);
    bytes.extend(sum.0.to_le_bytes());
    bytes
}

/// The bytes of a file, with the checksum of those that were read.
struct Summed<R> {
    file: R,
    sum: Checksum,
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.sum.add(&buffer[..n]);
        Ok(n)
    }
}

/// Reads the beginning of a file: its flags, its size, and its numbers of views, lights, clusters and components.
fn read_head(reader: &mut Reader<'_, impl Read>) -> Result<[u32; 7], BtfError> {
    let mut magic = [0; 8];
    match reader.bytes(&mut magic, "header") {
        Err(BtfError::Short(_)) => return Err(BtfError::Magic),
        other => other?,
    }
    if SIGNATURES.iter().any(|signature| magic.starts_with(signature)) {
        return Err(BtfError::Bonn);
    }
    if magic != MAGIC {
        return Err(BtfError::Magic);
    }
    let version = reader.whole("header")?;
    if version != VERSION {
        return Err(BtfError::Version(version));
    }
    let mut head = [0; 7];
    for n in &mut head {
        *n = reader.whole("header")?;
    }
    check_head(head).map_or(Ok(head), |message| Err(BtfError::Content(message)))
}

/// Reads a file, and how its values are stored. The second value is memory of the first one, which the holder of both keeps.
///
/// # Errors
/// [`BtfError`], at the first thing that is malformed, cut off, damaged, or exceeds a limit.
pub fn read_btf(file: AssetFile, limits: &Limits) -> Result<(BtfFile, BtfEncoding, MemoryShare), BtfError> {
    let summed = Summed { file: BufReader::new(file.reader), sum: Checksum::START };
    let mut reader = Reader::new(summed, file.len, limits)?;
    let [flags, width, height, n_views, n_lights, n_clusters, components] = read_head(&mut reader)?;
    let (encoding, scalar) = match flags & HALVES {
        0 => (BtfEncoding::Float, Scalar::Float),
        _ => (BtfEncoding::Half, Scalar::Half),
    };
    let (views, lights) = (reader.angles(n_views)?, reader.angles(n_lights)?);
    let values = [n_clusters, components + 1, n_views, n_lights, 3].into_iter().map(u64::from).product();
    let (mut clusters, mut texel_clusters, mut texel_weights) = (Vec::new(), Vec::new(), Vec::new());
    reader.values(&mut clusters, [values; 2], scalar, "clusters")?;
    let texels: u64 = levels([width, height]).iter().map(|[w, h]| u64::from(*w) * u64::from(*h)).sum();
    for texel in 0..texels {
        let mut cluster = [0; 2];
        reader.room(&mut texel_clusters, 1, texels - texel)?;
        reader.bytes(&mut cluster, "texels")?;
        texel_clusters.push(u16::from_le_bytes(cluster));
        let n = u64::from(components);
        reader.values(&mut texel_weights, [n, n * (texels - texel)], scalar, "texels")?;
    }
    let sum = reader.file.sum.0;
    let mut end = [0; 8];
    reader.bytes(&mut end, "checksum")?;
    if u64::from_le_bytes(end) != sum {
        return Err(BtfError::Checksum);
    }
    reader.end()?;
    let has_cosine = flags & COSINE != 0;
    let size = [width, height];
    let file =
        BtfFile { size, views, lights, has_cosine, components, clusters, texel_clusters, texel_weights };
    file.check()?;
    Ok((file, encoding, reader.memory))
}

/// What is wrong with the numbers of a header.
fn check_head([flags, width, height, n_views, n_lights, n_clusters, components]: [u32; 7]) -> Option<String> {
    const DIRECTIONS: u32 = crate::measured::MAX_DIRECTIONS as u32;
    if flags & !(COSINE | HALVES) != 0 {
        return Some(format!("its flags are {flags}, of which 1 and 2 are known"));
    }
    for (n, most, what) in [
        (width, MAX_SIDE, "texels across"),
        (height, MAX_SIDE, "texels down"),
        (n_views, DIRECTIONS, "views"),
        (n_lights, DIRECTIONS, "lights"),
        (n_clusters, 1 << 16, "clusters"),
    ] {
        if n == 0 || n > most {
            return Some(format!("it has {n} {what}, which have to be from 1 to {most}"));
        }
    }
    (components > 1024).then(|| format!("it has {components} components, of which there may be 1024"))
}
