//! Smaller copies of a picture: the pyramid of Williams [1983].
//!
//! Each level has half the texels of the one below in each direction, down to a single one. A texel is the mean over what
//! it covers of the level below, which for odd sizes are parts of texels:
//!
//! ```text
//! T'(i) = sum over j of  a(i, j) T(j) / sum over j of a(i, j),      a(i, j) = |[i w/w', (i+1) w/w') and [j, j+1)|
//! ```
//!
//! so that the mean of the whole is kept on all levels. Means are of linear light.

use super::Picture;

/// The levels above a picture.
#[derive(Debug)]
pub(super) struct Pyramid {
    /// From half the size on.
    pub levels: Vec<Level>,
}

/// One of them.
#[derive(Debug)]
pub(super) struct Level {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<[u16; 4]>,
}

impl Pyramid {
    /// Bytes that the levels above so many texels take, about.
    pub fn bytes(texels: u64) -> u64 {
        // A third of the picture, and a little for pictures that are narrow.
        (texels / 2 + 64) * size_of::<[u16; 4]>() as u64
    }

    /// Of a picture in memory; none for others, which have theirs in tiles.
    pub fn of(picture: &Picture) -> Pyramid {
        let mut levels: Vec<Level> = Vec::new();
        let Some(texels) = picture.resident() else { return Pyramid { levels } };
        let (mut width, mut height) = (picture.width, picture.height);
        while width > 1 || height > 1 {
            let below = levels.last().map_or(texels, |level| &level.texels[..]);
            let level = halved(below, width, height);
            (width, height) = (level.width, level.height);
            levels.push(level);
        }
        Pyramid { levels }
    }
}

/// Parts of texels that one of the level above covers, and how much of each.
fn covered(i: u32, n: u32, above: u32) -> [(usize, f64); 3] {
    let (n64, above) = (u64::from(n), u64::from(above));
    // In parts of `1/above` of a texel, which are whole.
    let (first, last) = (u64::from(i) * n64, (u64::from(i) + 1) * n64);
    std::array::from_fn(|k| {
        let j = first / above + k as u64;
        let part = ((j + 1) * above).min(last).saturating_sub((j * above).max(first));
        (j.min(n64 - 1) as usize, part as f64)
    })
}

fn halved(below: &[[u16; 4]], width: u32, height: u32) -> Level {
    let is_even = width.is_multiple_of(2) && height.is_multiple_of(2);
    let texels = if is_even { means_of_four(below, width) } else { means_of_parts(below, width, height) };
    Level { width: (width / 2).max(1), height: (height / 2).max(1), texels }
}

fn means_of_parts(below: &[[u16; 4]], width: u32, height: u32) -> Vec<[u16; 4]> {
    let (w, h) = ((width / 2).max(1), (height / 2).max(1));
    let area = f64::from(width) * f64::from(height);
    let columns: Vec<_> = (0..w).map(|x| covered(x, width, w)).collect();
    let mut texels = Vec::with_capacity(w as usize * h as usize);
    for y in 0..h {
        let rows = covered(y, height, h);
        for columns in &columns {
            let mut sum = [0.0; 4];
            for (j, b) in rows {
                for &(i, a) in columns {
                    let texel = below[j * width as usize + i];
                    (0..4).for_each(|c| sum[c] += a * b * f64::from(texel[c]));
                }
            }
            texels.push(sum.map(|sum| (sum / area).round() as u16));
        }
    }
    texels
}

/// [`means_of_parts`] where both sizes are even.
fn means_of_four(below: &[[u16; 4]], width: u32) -> Vec<[u16; 4]> {
    let width = width as usize;
    let mut texels = Vec::with_capacity(below.len() / 4);
    for rows in below.chunks_exact(2 * width) {
        let (upper, lower) = rows.split_at(width);
        let means = upper.chunks_exact(2).zip(lower.chunks_exact(2)).map(|(upper, lower)| {
            let sum = |c: usize| {
                [upper[0], upper[1], lower[0], lower[1]].iter().map(|t| u32::from(t[c])).sum::<u32>()
            };
            std::array::from_fn(|c| ((sum(c) + 2) / 4) as u16)
        });
        texels.extend(means);
    }
    texels
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    /// A sinusoid of `f` cycles a texel keeps `sin(2^l pi f) / (2^l sin(pi f))` of its amplitude on level `l`.
    #[test]
    fn sinusoids_keep_the_amplitude_of_box_filters() {
        let n = 64;
        let f = 1.0 / 16.0;
        let tau = std::f64::consts::TAU;
        let wave = |x: f64| 0.5 + 0.5 * (tau * f * x).sin();
        let picture = Picture::from_fn(n, n, |x, y| {
            [wave(f64::from(x) + 0.5) as f32, wave(f64::from(y) + 0.5) as f32, 0.5, 1.0]
        });
        let pyramid = Pyramid::of(&picture);
        for (level, expected) in pyramid.levels.iter().zip([0.980_785, 0.906_127, 0.640_729, 0.0]) {
            // The coefficient of the sine, whichever way it runs.
            for (channel, across) in [(0, true), (1, false)] {
                let n = level.width;
                let (mut sum, mut norm) = (0.0, 0.0);
                for i in 0..n {
                    let (x, y) = if across { (i, n / 2) } else { (n / 2, i) };
                    let texel = f64::from(level.texels[(y * n + x) as usize][channel]) / 65535.0;
                    let wave = (tau * (f64::from(i) + 0.5) * f * 64.0 / f64::from(n)).sin();
                    sum += 2.0 * (texel - 0.5) * wave;
                    norm += wave * wave;
                }
                // Of whole periods in a texel nothing is left.
                let amplitude = if norm > 1e-9 { sum / norm } else { 0.0 };
                assert!(norm > 1e-9 || level.texels.iter().all(|texel| texel[channel].abs_diff(32768) < 2));
                assert!((amplitude - expected).abs() < 2e-5, "{n}: {amplitude} {expected}");
            }
        }
        assert_eq!(pyramid.levels.len(), 6);
    }

    #[test]
    fn means_of_four_are_those_of_parts() {
        for (w, h) in [(2, 2), (64, 2), (2, 30), (46, 22)] {
            let texel = |x: u32, y: u32| {
                let s = Stream::new(5, [x, y], 0);
                [s.uniform(0), s.uniform(1), f32::from(x.is_multiple_of(2)), 1.0]
            };
            let picture = Picture::from_fn(w, h, texel);
            let texels = picture.resident().unwrap();
            assert_eq!(means_of_four(texels, w), means_of_parts(texels, w, h), "{w} x {h}");
        }
    }

    #[test]
    fn means_are_kept_for_any_size() {
        for (w, h) in [(1, 1), (5, 3), (17, 1), (1, 9), (31, 8), (100, 37)] {
            let picture = Picture::from_fn(w, h, |x, y| {
                let s = Stream::new(3, [x, y], 0);
                [s.uniform(0), s.uniform(1), s.uniform(2), s.uniform(3)]
            });
            let pyramid = Pyramid::of(&picture);
            if let Some(top) = pyramid.levels.last() {
                assert_eq!((top.width, top.height), (1, 1));
                for (c, &found) in top.texels[0].iter().enumerate() {
                    assert!((f32::from(found) / 65535.0 - picture.mean[c]).abs() < 6e-5, "{w} x {h}");
                }
            }
            let texels: usize = pyramid.levels.iter().map(|level| level.texels.len()).sum();
            assert!(texels as u64 * 8 <= Pyramid::bytes(u64::from(w) * u64::from(h)), "{w} x {h}");
        }
    }
}
