//! Finished pixels of a film made for one pass.

use super::{
    fixed,
    layer::{Layer, LayerSet},
    spec::FilmSpec,
    sums::Sums,
};
use crate::{PixelSample, rect::Rect};

/// The layers of a rectangle of pixels as floats.
#[derive(Clone, Debug)]
pub(crate) struct Pixels {
    pub rect: Rect,
    /// For each layer of the film that is no number of something, in order, its channels of every pixel.
    values: Vec<f32>,
    /// Numbers of objects, then numbers of materials, as far as the film has them.
    ids: Vec<u32>,
}

impl Pixels {
    /// No pixels.
    pub fn empty() -> Pixels {
        Pixels { rect: Rect::of_size(0, 0), values: Vec::new(), ids: Vec::new() }
    }

    /// The pixels of `rect`, black until something is taken over.
    pub fn new(spec: &FilmSpec, rect: Rect) -> Pixels {
        let mut pixels = Pixels::empty();
        pixels.reset(spec, rect);
        pixels
    }

    /// Starts afresh with the pixels of `rect`, keeping the memory.
    pub fn reset(&mut self, spec: &FilmSpec, rect: Rect) {
        self.rect = rect;
        self.values.clear();
        self.ids.clear();
        let area = rect.area() as usize;
        for layer in spec.layers.iter() {
            if is_id(layer) {
                self.ids.resize(self.ids.len() + area, 0);
            } else {
                let nothing = if layer == Layer::Depth { f32::INFINITY } else { 0.0 };
                self.values.resize(self.values.len() + area * layer.channels(), nothing);
            }
        }
    }

    /// Records the only sample of a pixel, to the same bits as if it had gone through sums.
    ///
    /// * `values`: those of the sample for the filtered layers
    ///
    /// Returns whether all of it was finite.
    #[inline]
    pub fn put(&mut self, spec: &FilmSpec, pixel: usize, values: &[f32], sample: &PixelSample) -> bool {
        if spec.layers == LayerSet::of(&[Layer::Color]) {
            return put_all(&mut self.values[3 * pixel..], values);
        }
        let hit = sample.first.as_ref();
        let area = self.rect.area() as usize;
        let (mut start, mut id_start, mut used) = (0, 0, 0);
        let mut finite = true;
        for layer in spec.layers.iter() {
            let n = layer.channels();
            let out = start + pixel * n;
            match layer {
                Layer::ObjectId => self.ids[id_start + pixel] = hit.map_or(0, |hit| hit.object),
                Layer::MaterialId => self.ids[id_start + pixel] = hit.map_or(0, |hit| hit.material),
                Layer::SampleCount => self.values[out] = 1.0,
                // One sample says nothing about its variance.
                Layer::Variance => {}
                Layer::Depth => {
                    let distance = hit.map(|hit| fixed::alone(hit.t));
                    self.values[out] = distance.flatten().unwrap_or(f32::INFINITY);
                    finite &= distance != Some(None);
                }
                _ => {
                    finite &= put_all(&mut self.values[out..], &values[used..used + n]);
                    used += n;
                }
            }
            *(if is_id(layer) { &mut id_start } else { &mut start }) += n * area;
        }
        finite
    }

    /// Copies the pixels that both have.
    pub fn copy(&mut self, spec: &FilmSpec, other: &Pixels) {
        let common = self.rect.intersection(&other.rect);
        let width = common.width() as usize;
        if width == 0 {
            return;
        }
        for layer in spec.layers.iter() {
            let (start, other_start, n) =
                (self.start(spec, layer), other.start(spec, layer), layer.channels());
            for y in common.y0..common.y1 {
                let to = start + self.rect.index(common.x0, y) * n;
                let from = other_start + other.rect.index(common.x0, y) * n;
                if is_id(layer) {
                    self.ids[to..to + width].copy_from_slice(&other.ids[from..from + width]);
                } else {
                    self.values[to..to + width * n].copy_from_slice(&other.values[from..from + width * n]);
                }
            }
        }
    }

    /// Develops the sums of the pixels that both rectangles have.
    pub fn take(&mut self, spec: &FilmSpec, sums: &Sums) {
        let common = self.rect.intersection(&sums.rect);
        let width = common.width() as usize;
        if width == 0 {
            return;
        }
        for layer in spec.layers.iter() {
            let (start, n) = (self.start(spec, layer), layer.channels());
            for y in common.y0..common.y1 {
                let (to, from) = (self.rect.index(common.x0, y), sums.rect.index(common.x0, y));
                if is_id(layer) {
                    for (pixel, id) in (from..).zip(&mut self.ids[start + to..][..width]) {
                        *id = sums.id(layer, pixel);
                    }
                } else {
                    sums.row(spec, layer, from, &mut self.values[start + to * n..][..width * n]);
                }
            }
        }
    }

    /// A row of a layer; see [`Sums::row`].
    pub fn row(&self, spec: &FilmSpec, layer: Layer, first: usize, out: &mut [f32]) {
        let (start, n) = (self.start(spec, layer), layer.channels());
        if is_id(layer) {
            for (&id, out) in self.ids[start + first..].iter().zip(out) {
                *out = id as f32;
            }
        } else {
            out.copy_from_slice(&self.values[start + first * n..][..out.len()]);
        }
    }

    /// Number of the object or material of a pixel's first sample.
    pub fn id(&self, spec: &FilmSpec, layer: Layer, pixel: usize) -> u32 {
        self.ids[self.start(spec, layer) + pixel]
    }

    /// Where a layer starts in its array.
    fn start(&self, spec: &FilmSpec, layer: Layer) -> usize {
        let before = spec.layers.iter().take_while(|&l| l != layer).filter(|&l| is_id(l) == is_id(layer));
        before.map(Layer::channels).sum::<usize>() * self.rect.area() as usize
    }
}

/// Writes values as they would come out of sums; 0 for those that are not finite.
///
/// Returns whether all were finite.
#[inline]
fn put_all(out: &mut [f32], values: &[f32]) -> bool {
    let mut finite = true;
    for (out, &value) in out.iter_mut().zip(values) {
        let alone = fixed::alone(value);
        *out = alone.unwrap_or(0.0);
        finite &= alone.is_some();
    }
    finite
}

fn is_id(layer: Layer) -> bool {
    matches!(layer, Layer::ObjectId | Layer::MaterialId)
}
