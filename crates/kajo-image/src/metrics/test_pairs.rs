//! Pairs of pictures made by formula, and what the authors' `flip-evaluator` 1.7 says of them.

use crate::Image;

/// Names a pair of pictures and lists the evaluator's answers.
pub(super) struct Pair {
    pub name: &'static str,
    /// Mean error at the default distance.
    pub flip: f64,
    /// Mean error at 30 pixels per degree.
    pub flip_at_30_ppd: f64,
    /// Largest error at the default distance.
    pub largest: f64,
    /// Error at (width / 3, height / 4) at the default distance.
    pub inner: f64,
    /// Mean error of the pictures' values v as 8 v², linear.
    pub hdr_flip: f64,
    /// First and last exposure of that.
    pub hdr_start: f32,
    pub hdr_stop: f32,
}

pub(super) const PAIRS: [Pair; 6] = [
    Pair {
        name: "noise",
        flip: 0.439524,
        flip_at_30_ppd: 0.735948,
        largest: 0.971656,
        inner: 0.413054,
        hdr_flip: 0.440892,
        hdr_start: -1.787562,
        hdr_stop: -0.107625,
    },
    Pair {
        name: "gradient",
        flip: 0.295875,
        flip_at_30_ppd: 0.292718,
        largest: 0.975793,
        inner: 0.187898,
        hdr_flip: 0.310948,
        hdr_start: -1.746936,
        hdr_stop: -0.072776,
    },
    Pair {
        name: "edges",
        flip: 0.313003,
        flip_at_30_ppd: 0.312827,
        largest: 0.758004,
        inner: 0.000000,
        hdr_flip: 0.323558,
        hdr_start: -1.618976,
        hdr_stop: -1.618976,
    },
    Pair {
        name: "hue",
        flip: 1.000000,
        flip_at_30_ppd: 1.000000,
        largest: 1.000000,
        inner: 1.000000,
        hdr_flip: 0.996161,
        hdr_start: -1.433121,
        hdr_stop: -1.433121,
    },
    Pair {
        name: "fireflies",
        flip: 0.058959,
        flip_at_30_ppd: 0.036872,
        largest: 0.977386,
        inner: 0.020965,
        hdr_flip: 0.027974,
        hdr_start: -0.613742,
        hdr_stop: 0.614510,
    },
    Pair {
        name: "blur",
        flip: 0.087473,
        flip_at_30_ppd: 0.104120,
        largest: 0.209116,
        inner: 0.062352,
        hdr_flip: 0.026887,
        hdr_start: -1.916703,
        hdr_stop: -0.062808,
    },
];

/// A value from 0 to 255 at column x, row y, channel c.
type Formula = fn(i64, i64, i64) -> i64;

impl Pair {
    /// Reference and test picture: multiples of 1/255, three channels.
    pub fn images(name: &str) -> (Image, Image) {
        let (width, height, reference, test): (u32, u32, Formula, Formula) = match name {
            "noise" => (64, 48, |x, y, c| hash(x, y, c, 1), |x, y, c| hash(x, y, c, 2)),
            "gradient" => (80, 40, |x, _, c| (3 * x + c * 20) % 256, |x, _, c| (3 * x + 4 + c * 24) % 256),
            "edges" => (61, 47, |x, y, _| checker(x, y), |x, y, _| checker(x + 1, y)),
            "hue" => (33, 17, |_, _, c| if c == 1 { 255 } else { 0 }, |_, _, c| if c == 2 { 255 } else { 0 }),
            "fireflies" => {
                (96, 64, waves, |x, y, c| if (x * 7 + y * 13) % 97 == 0 { 255 } else { waves(x, y, c) })
            }
            "blur" => (50, 70, stripes, |x, y, c| (-1..=1).map(|d| stripes(x, y + d, c)).sum::<i64>() / 3),
            _ => panic!("no pair is called {name}"),
        };
        let image = |f: Formula| {
            Image::from_fn(width, height, |x, y| [0, 1, 2].map(|c| f(x.into(), y.into(), c) as f32 / 255.0))
                .unwrap()
        };
        (image(reference), image(test))
    }
}

fn hash(x: i64, y: i64, c: i64, seed: i64) -> i64 {
    let v = (x * 374_761_393 + y * 668_265_263 + c * 2_147_483_647 + seed * 1_274_126_177) & 0xffff_ffff;
    let v = ((v ^ (v >> 13)) * 1_274_126_177) & 0xffff_ffff;
    (v ^ (v >> 16)) & 255
}

/// A triangle wave from 0 to 255 and back over 2 `p`.
fn triangle(v: i64, p: i64) -> i64 {
    let m = v.rem_euclid(2 * p);
    (if m < p { m } else { 2 * p - m }) * 255 / p
}

fn checker(x: i64, y: i64) -> i64 {
    if (x / 6 + y / 6) % 2 == 0 { 230 } else { 25 }
}

fn waves(x: i64, y: i64, c: i64) -> i64 {
    triangle(x + 2 * y + c * 5, 37) / 2 + 40
}

fn stripes(x: i64, y: i64, c: i64) -> i64 {
    triangle(x * (c + 1) + y, 9)
}
