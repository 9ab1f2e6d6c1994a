//! The pixels of a display, as the server keeps them in a file: an X window dump.

use std::fs;
use std::path::Path;

use kajo::{EncodeOptions, Format, Image, encode};

use super::ACCENT;

/// All pixels, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Screen {
    pub width: u32,
    pub height: u32,
    pixels: Vec<[u8; 3]>,
}

/// The smallest rectangle around some pixels, and how many they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    pub min: [u32; 2],
    pub max: [u32; 2],
    pub count: u32,
}

impl Block {
    pub fn center(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.min[axis].midpoint(self.max[axis]))
    }

    pub fn size(&self) -> [u32; 2] {
        [0, 1].map(|axis| self.max[axis] - self.min[axis] + 1)
    }
}

impl Screen {
    /// Reads the file; `None` while it is not whole.
    pub fn read(path: &Path) -> Option<Screen> {
        let bytes = fs::read(path).ok()?;
        let number = |index: usize| {
            let word = bytes.get(4 * index..4 * index + 4)?.try_into().ok()?;
            Some(u32::from_be_bytes(word))
        };
        // The header, then colours of a palette that is not used, of twelve bytes each, then rows of four bytes a pixel.
        let [header, width, height, row, colors] =
            [number(0)?, number(4)?, number(5)?, number(12)?, number(19)?];
        let start = (header + 12 * colors) as usize;
        let mut pixels = Vec::with_capacity((width * height) as usize);
        for y in 0..height {
            let at = start + (y * row) as usize;
            let row = bytes.get(at..at + 4 * width as usize)?;
            pixels.extend(row.chunks_exact(4).map(|pixel| [pixel[2], pixel[1], pixel[0]]));
        }
        Some(Screen { width, height, pixels })
    }

    pub fn at(&self, x: u32, y: u32) -> [u8; 3] {
        self.pixels[(y * self.width + x) as usize]
    }

    /// The pixels of a kind within a rectangle; `None` when there are none.
    pub fn block(&self, [min, max]: [[u32; 2]; 2], is_one: impl Fn([u8; 3]) -> bool) -> Option<Block> {
        let mut block: Option<Block> = None;
        for y in min[1]..max[1].min(self.height) {
            for x in (min[0]..max[0].min(self.width)).filter(|&x| is_one(self.at(x, y))) {
                let known = block.get_or_insert(Block { min: [x, y], max: [x, y], count: 0 });
                known.min = [known.min[0].min(x), known.min[1]];
                known.max = [known.max[0].max(x), y];
                known.count += 1;
            }
        }
        block
    }

    /// Everywhere.
    pub fn all(&self) -> [[u32; 2]; 2] {
        [[0, 0], [self.width, self.height]]
    }

    /// The red ball, where it is drawn or traced, as the largest piece of its colour: the middle row and what is
    /// connected to it. Small pictures of it are elsewhere.
    pub fn ball(&self) -> Option<Block> {
        self.balls().into_iter().max_by_key(|ball| ball.count)
    }

    /// Everything that looks like the ball, large or small, from left to right.
    pub fn balls(&self) -> Vec<Block> {
        let is_red = |[r, g, b]: [u8; 3]| r > 50 && r / 2 > g.max(b);
        let mut seen = vec![false; self.pixels.len()];
        let mut balls = Vec::new();
        for start in 0..self.pixels.len() {
            if seen[start] || !is_red(self.pixels[start]) {
                continue;
            }
            let mut block = Block { min: [u32::MAX; 2], max: [0; 2], count: 0 };
            let mut open = vec![start];
            seen[start] = true;
            while let Some(pixel) = open.pop() {
                let [x, y] = [pixel as u32 % self.width, pixel as u32 / self.width];
                block.min = [block.min[0].min(x), block.min[1].min(y)];
                block.max = [block.max[0].max(x), block.max[1].max(y)];
                block.count += 1;
                let sides = [
                    (x > 0).then(|| pixel - 1),
                    (x + 1 < self.width).then_some(pixel + 1),
                    (y > 0).then(|| pixel - self.width as usize),
                    (y + 1 < self.height).then_some(pixel + self.width as usize),
                ];
                for next in sides.into_iter().flatten() {
                    if !seen[next] && is_red(self.pixels[next]) {
                        seen[next] = true;
                        open.push(next);
                    }
                }
            }
            let [width, height] = block.size();
            let is_round = width.abs_diff(height) * 4 <= width.max(height) && width >= 5;
            if is_round && 2 * block.count > width * height {
                balls.push(block);
            }
        }
        balls.sort_by_key(|ball| ball.min[0]);
        balls
    }

    /// The button of a dialog that Enter presses, below the menu with its own: rows that are full of the accent colour, one after another.
    pub fn button(&self) -> Option<Block> {
        let mut rows = 0;
        for y in 40..self.height {
            let row = &self.pixels[(y * self.width) as usize..((y + 1) * self.width) as usize];
            let run = row.split(|pixel| *pixel != ACCENT).map(<[_]>::len).max().unwrap_or(0);
            rows = if run >= 28 { rows + 1 } else { 0 };
            if rows == 3 {
                return self.block([[0, y - 2], [self.width, y + 1]], |pixel| pixel == ACCENT);
            }
        }
        None
    }

    /// The first row of a rectangle with as many pixels of a kind side by side.
    pub fn run(
        &self,
        [min, max]: [[u32; 2]; 2],
        length: u32,
        is_one: impl Fn([u8; 3]) -> bool,
    ) -> Option<Block> {
        for y in min[1]..max[1].min(self.height) {
            let mut from = min[0];
            for x in min[0]..max[0].min(self.width) {
                if !is_one(self.at(x, y)) {
                    from = x + 1;
                } else if x + 1 - from >= length {
                    let end = (x..max[0].min(self.width)).take_while(|&x| is_one(self.at(x, y))).last()?;
                    return Some(Block { min: [from, y], max: [end, y], count: end - from + 1 });
                }
            }
        }
        None
    }

    /// Small pictures of the ball below the large one.
    pub fn small_balls(&self) -> usize {
        let Some(large) = self.ball() else { return 0 };
        self.balls()
            .iter()
            .filter(|ball| ball.min[1] > large.max[1] && 2 * ball.size()[1] < large.size()[1])
            .count()
    }

    /// Whether another screen has the same pixels in a rectangle.
    pub fn agrees(&self, other: &Screen, [min, max]: [[u32; 2]; 2]) -> bool {
        (min[1]..max[1]).all(|y| (min[0]..max[0]).all(|x| self.at(x, y) == other.at(x, y)))
    }

    /// The outline of what is selected.
    pub fn outline(&self) -> Option<Block> {
        self.block(self.all(), |pixel| pixel == [255, 168, 51]).filter(|block| block.count > 50)
    }

    /// Writes a PNG file.
    pub fn save(&self, path: &Path) {
        let data = self.pixels.as_flattened().iter().map(|&value| f32::from(value) / 255.0).collect();
        let image = Image::from_data(self.width, self.height, 3, data).unwrap();
        fs::write(path, encode(&image, Format::Png, &EncodeOptions::default()).unwrap()).unwrap();
    }
}
