//! Finished pixels of a film made for one pass.

use super::{layer::Layer, spec::FilmSpec, sums::Sums};
use crate::rect::Rect;

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
    /// The pixels of `rect`, black until sums are taken over.
    pub fn new(spec: &FilmSpec, rect: Rect) -> Pixels {
        let mut none = Sums::empty(spec);
        none.reset(rect);
        let mut pixels = Pixels { rect, values: Vec::new(), ids: Vec::new() };
        let area = rect.area() as usize;
        for layer in spec.layers.iter() {
            if is_id(layer) {
                pixels.ids.resize(pixels.ids.len() + area, 0);
            } else {
                pixels.values.resize(pixels.values.len() + area * layer.channels(), 0.0);
            }
        }
        pixels.take(spec, &none);
        pixels
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

fn is_id(layer: Layer) -> bool {
    matches!(layer, Layer::ObjectId | Layer::MaterialId)
}
