//! Files that are written here of functions that are known.
//!
//! With as many components as texels every function is factorised exactly: the rows of texels are those of a permutation.

use std::f32::consts::PI;

use kajo_math::{fmath, half};
use kajo_scene::{Assets, Limits, MemoryAssets, MemoryBudget};

use super::super::tests::rings;
use super::super::{Btf, BtfEncoding, BtfError, BtfSamples, Compression, compress, read_btf, write_btf};
use super::read_ubo2014;
use crate::measured::direction;

/// A file to be written.
#[derive(Clone)]
struct Made {
    signature: &'static str,
    version: u32,
    has_cosine: bool,
    views: Vec<[f32; 2]>,
    lights: Vec<[f32; 2]>,
    size: [u32; 2],
    color_model: u32,
    mean: [f32; 3],
    axes: [f32; 9],
    /// Bytes of a number.
    scalar: u8,
    /// Whether the left matrix is that of the texels.
    is_transposed: bool,
}

impl Default for Made {
    fn default() -> Made {
        Made {
            signature: "!DFMF08FCR",
            version: 4,
            has_cosine: false,
            views: rings(37),
            lights: rings(25),
            size: [3, 2],
            color_model: 0,
            mean: [0.0; 3],
            axes: [0.0; 9],
            scalar: 4,
            is_transposed: false,
        }
    }
}

/// Three numbers of a texel for a view and a light.
type Function = fn(u32, [f32; 2], [f32; 2]) -> [f32; 3];

impl Made {
    fn texels(&self) -> usize {
        (self.size[0] * self.size[1]) as usize
    }

    fn begin(&self) -> Vec<u8> {
        let mut about = self.version.to_le_bytes().to_vec();
        about.extend([b'x'; 240]);
        [9.5f32, 1.0, 1.0, 1.0].iter().for_each(|v| about.extend(v.to_le_bytes()));
        if self.version > 1 {
            about.extend(u32::from(self.has_cosine).to_le_bytes());
        }
        let text = |about: &mut Vec<u8>, text: &str| {
            about.extend((text.len() as u32).to_le_bytes());
            about.extend(text.bytes());
        };
        if self.version > 2 {
            text(&mut about, "<setup/>");
        }
        if self.version > 3 {
            about.extend(3u32.to_le_bytes());
            ["R", "G", "B"].iter().for_each(|name| text(&mut about, name));
        }
        let mut bytes = self.signature.as_bytes().to_vec();
        bytes.extend((about.len() as u32 + 4).to_le_bytes());
        bytes.extend(about);
        bytes.extend((self.views.len() as u32).to_le_bytes());
        for view in &self.views {
            view.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            bytes.extend((self.lights.len() as u32).to_le_bytes());
            self.lights.iter().flatten().for_each(|v| bytes.extend(v.to_le_bytes()));
        }
        self.size.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        if self.signature.ends_with('R') {
            bytes.extend(1u32.to_le_bytes());
            bytes.extend([0; 36]);
        }
        bytes
    }

    fn number(&self, v: f32, bytes: &mut Vec<u8>) {
        match self.scalar {
            2 => bytes.extend(half::from_f32(v).to_le_bytes()),
            4 => bytes.extend(v.to_le_bytes()),
            _ => bytes.extend(f64::from(v).to_le_bytes()),
        }
    }

    /// Matrices of values in rows of pairs, or of one of three numbers of each, with columns of texels.
    fn matrices(&self, rows: &[Vec<f32>], bytes: &mut Vec<u8>) {
        let n = self.texels();
        // Component k is of texel k + 1, and half of it in each matrix.
        let texel_row = |t: usize| (0..n).map(move |k| if (k + 1) % n == t { 2.0 } else { 0.0 });
        let other: Vec<f32> = (0..n).flat_map(texel_row).collect();
        let own: Vec<f32> = rows.iter().flat_map(|row| (0..n).map(|k| 0.5 * row[(k + 1) % n])).collect();
        bytes.extend([rows.len() as u32, n as u32].map(u32::to_le_bytes).as_flattened());
        (0..n).for_each(|_| self.number(2.0, bytes));
        own.iter().chain(&other).for_each(|&v| self.number(v, bytes));
    }

    /// The bytes of a file that holds this function of texels and pairs.
    fn written(&self, f: Function) -> Vec<u8> {
        let mut bytes = self.begin();
        let n = self.texels() as u32;
        let pairs: Vec<_> =
            self.views.iter().flat_map(|v| self.lights.iter().map(move |l| (*v, *l))).collect();
        let is_full = self.signature.starts_with("!FMF");
        if is_full {
            if self.signature.contains('E') {
                bytes.push(2);
                bytes.extend(u32::from(self.color_model == 12).to_le_bytes());
                bytes.extend([2u32, 1].map(u32::to_le_bytes).as_flattened());
                bytes.extend([0; 4]);
            }
            bytes.extend(n.to_le_bytes());
            bytes.push(self.scalar);
            bytes.extend(n.to_le_bytes());
            let row = |&(v, l): &([f32; 2], [f32; 2]), c: usize| (0..n).map(|t| f(t, v, l)[c]).collect();
            let rows: Vec<Vec<f32>> =
                pairs.iter().flat_map(|pair| (0..3).map(move |c| row(pair, c))).collect();
            self.matrices(&rows, &mut bytes);
            return bytes;
        }
        bytes.extend(n.to_le_bytes());
        bytes.extend(self.color_model.to_le_bytes());
        self.mean.iter().chain(&self.axes).for_each(|v| bytes.extend(v.to_le_bytes()));
        for c in 0..3 {
            bytes.push(self.scalar);
            bytes.extend(n.to_le_bytes());
            if self.is_transposed {
                self.transposed(&pairs, |t, v, l| f(t, v, l)[c], &mut bytes);
                continue;
            }
            let row = |&(v, l): &([f32; 2], [f32; 2])| (0..n).map(|t| f(t, v, l)[c]).collect();
            let rows: Vec<Vec<f32>> = pairs.iter().map(row).collect();
            self.matrices(&rows, &mut bytes);
        }
        bytes
    }

    /// The same with texels on the left.
    fn transposed(
        &self,
        pairs: &[([f32; 2], [f32; 2])],
        f: impl Fn(u32, [f32; 2], [f32; 2]) -> f32,
        bytes: &mut Vec<u8>,
    ) {
        let n = self.texels();
        bytes.extend([n as u32, pairs.len() as u32].map(u32::to_le_bytes).as_flattened());
        (0..n).for_each(|_| self.number(1.0, bytes));
        for t in 0..n {
            (0..n).for_each(|k| self.number(if k == t { 1.0 } else { 0.0 }, bytes));
        }
        for &(v, l) in pairs {
            (0..n).for_each(|k| self.number(f(k as u32, v, l), bytes));
        }
    }
}

fn read_at_most(bytes: &[u8], most: u32) -> Result<BtfSamples, BtfError> {
    let assets = MemoryAssets::new().with("x.btf", bytes);
    let limits = Limits { memory: MemoryBudget::new(1 << 24), ..Limits::default() };
    let read = read_ubo2014(assets.open("x.btf", "").unwrap(), &limits, most);
    assert_eq!(limits.memory.used(), 0);
    read
}

fn read(bytes: &[u8]) -> Result<BtfSamples, BtfError> {
    read_at_most(bytes, 1 << 16)
}

/// A gloss on a ground whose colour is that of the texel; all of it between 0.05 and 1.5.
fn cloth(texel: u32, view: [f32; 2], light: [f32; 2]) -> [f32; 3] {
    let h = (direction(view) + direction(light)).normalize();
    let gloss = fmath::pow(h.z, 3.0 + texel as f32);
    [0.05 + 0.1 * texel as f32 + 0.5 * gloss, 0.4 + 0.3 * gloss, 0.3 - 0.01 * texel as f32 + 0.5 * gloss]
}

/// Compares all that was read with π times a function.
fn check(found: &BtfSamples, made: &Made, expected: Function, tolerance: f32) {
    assert_eq!(
        (found.size, &found.views, &found.lights, found.has_cosine),
        (made.size, &made.views, &made.lights, made.has_cosine)
    );
    let pairs = || made.views.iter().flat_map(|v| made.lights.iter().map(move |l| (*v, *l)));
    let all = (0..made.texels() as u32).flat_map(|t| pairs().map(move |(v, l)| (t, v, l)));
    assert_eq!(found.values.len(), 3 * all.clone().count());
    for (rgb, (t, v, l)) in found.values.chunks_exact(3).zip(all) {
        let rgb: Vec<f32> = rgb.iter().map(|v| PI * v).collect();
        let is_near = |(a, b): (&f32, f32)| (a - b).abs() <= tolerance * b.abs().max(0.1);
        assert!(
            rgb.iter().zip(expected(t, v, l)).all(is_near),
            "{t} {v:?} {l:?}: {rgb:?} {:?}",
            expected(t, v, l)
        );
    }
}

#[test]
fn stored_pairs_are_those_of_the_file() {
    let plain = Made::default();
    for made in [
        plain.clone(),
        Made { signature: "!DFMF08FC", version: 3, ..plain.clone() },
        Made { signature: "!FMF06FC", version: 2, has_cosine: true, ..plain.clone() },
        Made { signature: "!FMF06FCR", version: 1, ..plain.clone() },
        Made { signature: "!FMF12FCER", scalar: 8, ..plain.clone() },
        Made { is_transposed: true, size: [1, 5], ..plain.clone() },
        Made { scalar: 8, views: rings(25), ..plain.clone() },
    ] {
        check(&read(&made.written(cloth)).unwrap(), &made, cloth, 3e-7);
    }
    let halves = Made { scalar: 2, ..plain };
    check(&read(&halves.written(cloth)).unwrap(), &halves, cloth, 6e-4);
}

/// Luminance and differences of a colour, as BT.601 has them.
fn yuv([r, g, b]: [f32; 3]) -> [f32; 3] {
    let y = 0.299 * r + 0.587 * g + 0.114 * b;
    [y, (b - y) / 2.032_11, (r - y) / 1.139_83]
}

#[test]
fn colour_models_are_undone() {
    const EPSILON: f32 = 1e-5;
    let models: [(u32, Function); 7] = [
        (1, |t, v, l| yuv(cloth(t, v, l))),
        (3, |t, v, l| {
            // Axes that are orthogonal, and colours without the mean.
            let [r, g, b] = cloth(t, v, l);
            let [r, g, b] = [r - 0.5, g - 0.25, b];
            [0.6 * r + 0.8 * g, -0.8 * r + 0.6 * g, b]
        }),
        (4, |t, v, l| {
            let [r, g, b] = cloth(t, v, l);
            [0.25 * r + 0.5 * g + 0.25 * b, 0.5 * (r - b), -0.25 * r + 0.5 * g - 0.25 * b]
        }),
        (9, |t, v, l| {
            let [y, u, v] = yuv(cloth(t, v, l));
            [(y + EPSILON).ln(), u, v]
        }),
        (10, |t, v, l| {
            let [y, u, v] = yuv(cloth(t, v, l));
            let small = |d: f32| d.signum() * (d.abs() / EPSILON).ln().max(0.0);
            [(y + EPSILON).ln(), small(u), small(v)]
        }),
        (11, |t, v, l| {
            let [y, u, v] = yuv(cloth(t, v, l));
            [(y + EPSILON).ln(), u / (y + EPSILON), v / (y + EPSILON)]
        }),
        (12, |t, v, l| cloth(t, v, l).map(|v| (v + EPSILON).ln())),
    ];
    for (color_model, f) in models {
        let axes = [0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, 0.0, 1.0];
        let made = Made { color_model, mean: [0.5, 0.25, 0.0], axes, ..Made::default() };
        check(&read(&made.written(f)).unwrap(), &made, cloth, 3e-5);
    }
    let logarithms = Made { signature: "!FMF12FCE", color_model: 12, ..Made::default() };
    let f: Function = |t, v, l| cloth(t, v, l).map(|v| (v + EPSILON).ln());
    check(&read(&logarithms.written(f)).unwrap(), &logarithms, cloth, 3e-5);
}

/// Means are those of colours, also where logarithms were stored.
#[test]
fn large_textures_are_averaged() {
    let made = Made { color_model: 12, size: [5, 4], ..Made::default() };
    let bytes = made.written(|t, v, l| cloth(t, v, l).map(|v| (v + 1e-5).ln()));
    let (whole, small) = (read(&bytes).unwrap(), read_at_most(&bytes, 2).unwrap());
    assert_eq!(small.size, [1, 1]);
    let width = whole.values.len() / 20;
    let corner = (0..20).filter(|t| t % 5 < 3 && t / 5 < 3);
    for i in (0..width).step_by(11) {
        let mean = corner.clone().map(|t| whole.values[t * width + i]).sum::<f32>() / 9.0;
        assert!((small.values[i] - mean).abs() < 1e-6, "{i}: {} {mean}", small.values[i]);
    }
    let half = read_at_most(&bytes, 3).unwrap();
    assert_eq!(half.size, [2, 2]);
    let mean = [12, 13, 17, 18].map(|t| whole.values[t * width + 7]).iter().sum::<f32>() / 4.0;
    assert!((half.values[3 * width + 7] - mean).abs() < 1e-6);
}

/// From such a file to what a surface shows.
#[test]
fn a_compressed_file_shows_what_was_measured() {
    let made = Made { has_cosine: true, color_model: 12, ..Made::default() };
    let with_cosine: Function = |t, v, l| cloth(t, v, l).map(|f| (f * direction(l).z + 1e-5).ln());
    let samples = read(&made.written(with_cosine)).unwrap();
    let file = compress(&samples, &Compression { clusters: 6, components: 0 });
    let assets = MemoryAssets::new().with("x.btf", &*write_btf(&file, BtfEncoding::Float));
    let (file, ..) = read_btf(assets.open("x.btf", "").unwrap(), &Limits::default()).unwrap();
    let btf = Btf::new(file).unwrap();
    for texel in 0..6 {
        for (&view, &light) in made.views.iter().flat_map(|v| made.lights.iter().map(move |l| (v, l))) {
            let at = btf.texel(0, i64::from(texel % 3), i64::from(texel / 3));
            let found = btf.value(at, direction(view), direction(light));
            for (found, expected) in found.iter().zip(cloth(texel, view, light)) {
                assert!((PI * found - expected).abs() < 1e-4, "{texel} {view:?} {light:?}: {found}");
            }
        }
    }
}

/// A file that is quickly read.
fn short() -> Made {
    let views = vec![[0.0, 0.0], [0.5, 0.0], [0.5, 2.0], [0.5, 4.0]];
    Made { lights: views[..3].to_vec(), views, size: [2, 1], scalar: 2, ..Made::default() }
}

#[test]
fn files_that_are_cut_off_are_refused() {
    for signature in ["!DFMF08FCR", "!FMF12FCE", "!FMF06FC"] {
        let good = Made { signature, ..short() }.written(cloth);
        read(&good).unwrap();
        for length in 0..good.len() {
            let error = read(&good[..length]).unwrap_err();
            assert!(matches!(error, BtfError::Short(_) | BtfError::Signature), "{length}: {error}");
        }
        assert!(matches!(read(&[&good[..], b"x"].concat()).unwrap_err(), BtfError::Long));
        // Whatever a byte is, it is read or refused.
        for at in 0..good.len() {
            for flip in [0x01, 0x40, 0x80, 0xff] {
                let mut bytes = good.clone();
                bytes[at] ^= flip;
                if let Ok(samples) = read(&bytes) {
                    assert!(samples.values.iter().all(|v| v.is_finite()));
                }
            }
        }
    }
}

#[test]
fn numbers_that_make_no_sense_are_refused_in_words() {
    let said = |made: &Made, change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = made.written(cloth);
        change(&mut bytes);
        read(&bytes).unwrap_err().to_string()
    };
    let plain = |change: &dyn Fn(&mut Vec<u8>)| said(&short(), change);
    let put = |b: &mut Vec<u8>, at: usize, n: u32| b[at..at + 4].copy_from_slice(&n.to_le_bytes());
    // The header begins at 10 and has 299 bytes; views begin at 309.
    assert!(plain(&|b| b[0] = b'?').contains("!DFMF08FCR"));
    assert!(plain(&|b| b[..10].copy_from_slice(b"!PVF06FCR!")).contains("its form is PVF"));
    assert!(plain(&|b| b[..10].copy_from_slice(b"!BDIF06R2!")).contains("its form is BDI"));
    assert!(plain(&|b| put(b, 10, 300)).contains("has 299 bytes and says that it has 300"));
    assert!(plain(&|b| put(b, 14, 9)).contains("version 9"));
    assert!(plain(&|b| put(b, 278, u32::MAX)).contains("ends within its description"));
    assert!(plain(&|b| put(b, 290, 31)).contains("31 colour channels"));
    assert!(plain(&|b| put(b, 309, 0)).contains("0 views"));
    assert!(plain(&|b| put(b, 309, u32::MAX)).contains("4294967295 views"));
    assert!(plain(&|b| put(b, 321, 9000)).contains("9000 lights"));
    assert!(plain(&|b| put(b, 313, 2f32.to_bits())).contains("views: direction 0"));
    assert!(plain(&|b| put(b, 313, f32::NAN.to_bits())).contains("views: direction 0"));
    // Views of 36 bytes, then the size.
    let size = 313 + 4 * 36;
    assert!(plain(&|b| put(b, size - 24, 1f32.to_bits())).contains("lights of view 3"));
    assert!(plain(&|b| put(b, size, 0)).contains("0 texels"));
    assert!(plain(&|b| put(b, size + 4, u32::MAX)).contains("4294967295 texels"));
    assert!(plain(&|b| put(b, size + 8, u32::MAX)).contains("ends within its rotations"));
    let model = size + 12 + 36 + 4;
    assert!(plain(&|b| put(b, model, 2)).contains("colour model has the number 2"));
    let axes = Made { color_model: 3, axes: [f32::INFINITY; 9], ..short() };
    assert!(said(&axes, &|_| {}).contains("axes of colours are not finite"));
    let matrices = model + 4 + 48;
    assert!(plain(&|b| b[matrices] = 3).contains("have 3 bytes"));
    assert!(plain(&|b| put(b, matrices + 1, 0)).contains("0 components"));
    assert!(plain(&|b| put(b, matrices + 1, 1 << 30)).contains("components"));
    assert!(plain(&|b| put(b, matrices + 5, 13)).contains("13 and 2 rows"));
    assert!(plain(&|b| put(b, matrices + 9, 3)).contains("matrices 1 have 12 and 3 rows"));
    // Two singular values, then 12 rows of two halves.
    let left = matrices + 13 + 4;
    assert!(
        plain(&|b| b[left + 8..left + 10].copy_from_slice(&[0, 0x7c])).contains("row 2 of its left matrix 1")
    );
    let right = left + 48;
    assert!(
        plain(&|b| b[right + 4..right + 6].copy_from_slice(&[1, 0x7e]))
            .contains("row 1 of its right matrix 1")
    );
    let logarithms = Made { color_model: 12, ..short() };
    let large = said(&logarithms, &|b| b[left + 12..left + 16].fill(0x7b));
    assert!(large.contains("texel 0 0 for view 1 and light 0 is not finite"), "{large}");
    let horizon = Made { has_cosine: true, lights: vec![[0.0; 2], [0.5, 0.0], [1.5706, 2.0]], ..short() };
    assert!(said(&horizon, &|_| {}).contains("light 2 is on the horizon"));
    let line = Made { lights: vec![[0.0; 2], [0.5, 0.0], [0.7, 0.0]], ..short() };
    assert!(said(&line, &|_| {}).contains("lights: the directions lie on a line"));
}

/// What does not fit is refused before it is read.
#[test]
fn a_texture_that_is_too_large_is_refused() {
    let made = short();
    let mut bytes = made.written(cloth);
    let size = 313 + 4 * 36;
    bytes[size..size + 4].copy_from_slice(&60_000u32.to_le_bytes());
    bytes[size + 4..size + 8].copy_from_slice(&60_000u32.to_le_bytes());
    assert!(matches!(read(&bytes).unwrap_err(), BtfError::Memory(_)));
    // Averaged it would fit, and its matrices are not there.
    assert!(matches!(read_at_most(&bytes, 4).unwrap_err(), BtfError::Content(_)));
    let limits = Limits { mesh_bytes: 100, ..Limits::default() };
    let assets = MemoryAssets::new().with("x.btf", &*made.written(cloth));
    let refused = read_ubo2014(assets.open("x.btf", "").unwrap(), &limits, 64).unwrap_err();
    assert!(matches!(refused, BtfError::Asset(_)));
}

#[test]
fn a_surface_says_what_to_do_with_such_a_file() {
    let assets = MemoryAssets::new().with("x.btf", &*short().written(cloth));
    let refused = read_btf(assets.open("x.btf", "").unwrap(), &Limits::default()).unwrap_err();
    assert!(refused.to_string().contains("kajo btf compress"), "{refused}");
}
