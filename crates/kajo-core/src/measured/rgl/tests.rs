//! Tables made of a known distribution of facets.

use kajo_color::Spectrum;
use kajo_math::{rng::Stream, warp};

use super::super::tensor_file::written;
use super::*;

/// GGX with `alpha` along x and y, and a reflectance of 1.
#[derive(Clone, Copy)]
pub struct Facets(pub f32, pub f32);

impl Facets {
    fn d(self, m: Vec3) -> f32 {
        let e = m.x * m.x / (self.0 * self.0) + m.y * m.y / (self.1 * self.1) + m.z * m.z;
        if m.z > 0.0 { 1.0 / (PI * self.0 * self.1 * e * e) } else { 0.0 }
    }

    fn lambda(self, w: Vec3) -> f32 {
        let across = self.0 * self.0 * w.x * w.x + self.1 * self.1 * w.y * w.y;
        0.5 * ((1.0 + across / (w.z * w.z).max(1e-12)).sqrt() - 1.0)
    }

    fn g1(self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// `f cos θi`.
    pub fn value(self, o: Vec3, i: Vec3) -> f32 {
        let m = (o + i).normalize();
        let g2 = 1.0 / (1.0 + self.lambda(o) + self.lambda(i));
        self.d(m) * g2 / (4.0 * o.z)
    }
}

fn polar(theta: f32, phi: f32) -> Vec3 {
    let ((sin, cos), (y, x)) = (fmath::sin_cos(theta), fmath::sin_cos(phi));
    Vec3::new(sin * x, sin * y, cos)
}

/// What is stored of the part `tint` of a channel.
struct Stored {
    phis: Vec<f32>,
    thetas: Vec<f32>,
    /// Nodes along each side of tables of facets, and of what is scattered.
    sides: [usize; 2],
}

impl Stored {
    fn bytes(values: impl IntoIterator<Item = f32>) -> Vec<u8> {
        values.into_iter().flat_map(f32::to_le_bytes).collect()
    }

    fn viewers(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        self.phis.iter().flat_map(|&phi| self.thetas.iter().map(move |&theta| (phi, theta)))
    }

    fn nodes(n: usize) -> impl Iterator<Item = Vec2> {
        (0..n * n).map(move |k| Vec2::new((k % n) as f32, (k / n) as f32) / (n - 1) as f32)
    }

    fn is_isotropic(&self) -> bool {
        self.phis.len() == 1
    }

    /// The facet of a point of the square for a viewer's azimuth.
    fn facet(&self, u: Vec2, phi: f32) -> Vec3 {
        let turned = (2.0 * u.y - 1.0) * PI + if self.is_isotropic() { phi } else { 0.0 };
        polar(u.x * u.x * FRAC_PI_2, turned)
    }

    /// What is scattered beyond the model at the nodes for each viewer.
    fn beyond(&self, facets: Facets) -> Vec<Vec<f32>> {
        let [n_m, n] = self.sides;
        let visible = self.visible(facets);
        let vndf = Warp::new([n_m; 2], visible).unwrap();
        let viewers = Parameters([self.phis.clone(), self.thetas.clone()]);
        let of = |(phi, theta): (f32, f32)| {
            let (o, slices) = (polar(theta, phi), viewers.slices([phi, theta]));
            let at = |s: Vec2| {
                let m = self.facet(vndf.sample(s.min(Vec2::splat(0.999_99)), &slices), phi);
                let i = 2.0 * o.dot(m) * m - o;
                if i.z <= 0.0 {
                    0.0
                } else {
                    (1.0 + facets.lambda(o)) / (1.0 + facets.lambda(o) + facets.lambda(i))
                }
            };
            Stored::nodes(n).map(at).collect()
        };
        self.viewers().map(of).collect()
    }

    fn visible(&self, facets: Facets) -> Vec<f32> {
        let of = |(phi, theta): (f32, f32)| {
            let o = polar(theta, phi);
            let at = move |u: Vec2| {
                let m = self.facet(u, phi);
                let stretch = 2.0 * PI * PI * u.x * m.truncate().length();
                facets.g1(o) * o.dot(m).max(0.0) * facets.d(m) / o.z.max(1e-3) * stretch
            };
            Stored::nodes(self.sides[0]).map(at)
        };
        self.viewers().flat_map(of).collect()
    }
}

/// A file of facets, by wavelengths or in the colour `(1, 0.5, 0.25)`.
pub fn file(facets: Facets, is_spectral: bool) -> Vec<u8> {
    let is_isotropic = facets.0 == facets.1;
    let n_phi = if is_isotropic { 1 } else { 5 };
    let phis = (0..n_phi).map(|k| -PI + FRAC_PI_2 * k as f32 / 4.0).collect();
    let thetas = (0..8).map(|k| 1.5 * k as f32 / 7.0).collect();
    let stored = Stored { phis, thetas, sides: [if is_isotropic { 128 } else { 64 }, 32] };
    let [n_m, n] = stored.sides;
    let beyond = stored.beyond(facets);
    let all = |of: &dyn Fn(Vec3) -> f32| {
        Stored::bytes(Stored::nodes(n_m).map(|u| of(polar(u.x * u.x * FRAC_PI_2, (2.0 * u.y - 1.0) * PI))))
    };
    let sigma = |w: Vec3| w.z.max(1e-3) * (1.0 + facets.lambda(Vec3::new(w.x, w.y, w.z.max(1e-3))));
    let shares: Vec<f32> = if is_spectral { vec![0.2, 0.4, 0.6, 0.8] } else { vec![1.0, 0.5, 0.25] };
    let scattered = beyond.iter().flat_map(|slice| shares.iter().map(move |share| (slice, *share)));
    let scattered: Vec<f32> =
        scattered.flat_map(|(slice, share)| slice.iter().map(move |v| share * v)).collect();
    let (np, nt, nc) = (stored.phis.len(), stored.thetas.len(), shares.len());
    let name = if is_spectral { "spectra" } else { "rgb" };
    let mut fields = vec![
        ("description", vec![4], b"test".to_vec(), 1),
        ("jacobian", vec![1], vec![1], 1),
        ("phi_i", vec![np], Stored::bytes(stored.phis.clone()), 10),
        ("theta_i", vec![nt], Stored::bytes(stored.thetas.clone()), 10),
        ("ndf", vec![n_m, n_m], all(&|m| facets.d(m)), 10),
        ("sigma", vec![n_m, n_m], all(&sigma), 10),
        ("vndf", vec![np, nt, n_m, n_m], Stored::bytes(stored.visible(facets)), 10),
        ("luminance", vec![np, nt, n, n], Stored::bytes(beyond.iter().flatten().copied()), 10),
        (name, vec![np, nt, nc, n, n], Stored::bytes(scattered), 10),
    ];
    if is_spectral {
        fields.push(("wavelengths", vec![4], Stored::bytes([400.0, 500.0, 600.0, 700.0]), 10));
    }
    let fields: Vec<_> =
        fields.iter().map(|(name, shape, bytes, kind)| (*name, &shape[..], bytes.clone(), *kind)).collect();
    written(&fields)
}

fn upper(i: u32) -> Vec3 {
    let s = Stream::new(31, [i, 0], 0);
    warp::uniform_hemisphere(Vec2::new(s.uniform(0), s.uniform(1)))
}

#[test]
fn tables_give_back_the_facets_that_they_were_made_of() {
    for facets in [Facets(0.35, 0.35), Facets(0.5, 0.25)] {
        let table = RglBrdf::read(&file(facets, false)).unwrap();
        assert_eq!(table.is_isotropic(), facets.0 == facets.1);
        let (mut n, mut off, mut sum) = (0, 0.0, 0.0);
        for (o, i) in (0..6000).map(|k| (upper(2 * k), upper(2 * k + 1))).filter(|(o, i)| o.z.min(i.z) > 0.25)
        {
            let (found, expected) = (table.rgb(o, i)[0], facets.value(o, i));
            if expected < 0.02 {
                continue;
            }
            n += 1;
            // Between viewers whose densities differ the tables are linear, which is farthest off at grazing angles.
            off += f64::from((found - expected).abs());
            sum += f64::from(expected);
            let [r, g, b] = table.rgb(o, i);
            assert!((g - 0.5 * r).abs() < 1e-4 * r && (b - 0.25 * r).abs() < 1e-4 * r);
        }
        assert!(n > 1000 && off < 0.1 * sum, "{n}: {off} of {sum}");
    }
}

#[test]
fn directions_have_their_density_and_their_albedo() {
    for facets in [Facets(0.35, 0.35), Facets(0.5, 0.25)] {
        let table = RglBrdf::read(&file(facets, false)).unwrap();
        for o in [Vec3::Z, polar(0.7, 0.4), polar(1.2, -2.0)] {
            let n = 96;
            let (mut found, mut expected) = (0.0, 0.0);
            for k in 0..n * n {
                let u = Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
                let i = table.sample(o, u);
                if i.z > 0.0 {
                    found += f64::from(table.rgb(o, i)[0] / table.pdf(o, i));
                }
                // What facets of this kind reflect, by other samples.
                let i = warp::cosine_hemisphere(u);
                expected += f64::from(facets.value(o, i) / (i.z / PI));
            }
            let [found, expected] = [found, expected].map(|sum| sum / f64::from(n * n));
            assert!((found / expected - 1.0).abs() < 0.02, "{o}: {found} {expected}");
        }
    }
}

#[test]
fn spectra_are_known_by_wavelength_and_have_a_colour() {
    let facets = Facets(0.4, 0.4);
    let table = RglBrdf::read(&file(facets, true)).unwrap();
    assert!(table.is_spectral());
    let (o, i) = (polar(0.3, 1.0), polar(0.4, -2.0));
    let one = table.spectrum(o, i, [500.0, 550.0, 390.0, 900.0]).unwrap();
    let whole = one[0] / 0.4;
    for (found, expected) in one.iter().zip([0.4, 0.5, 0.2, 0.8]) {
        assert!((found / whole - expected).abs() < 1e-4, "{one:?}");
    }
    let rgb = table.rgb(o, i).map(|v| v / whole);
    // A reflectance that rises with the wavelength is reddish, and its luminance is about that in the green.
    assert!(rgb[0] > rgb[1] && rgb[1] > rgb[2], "{rgb:?}");
    let luminance = Spectrum::rgb(rgb[0], rgb[1], rgb[2]).luminance();
    assert!((luminance - 0.515).abs() < 0.02, "{luminance}");
    assert!(RglBrdf::read(&file(facets, false)).unwrap().spectrum(o, i, [500.0; 4]).is_none());
}

#[test]
fn what_does_not_fit_is_named() {
    let error = |fields: &[(&str, &[usize], Vec<u8>, u8)]| RglBrdf::read(&written(fields)).err().unwrap();
    let floats = |values: &[f32]| Stored::bytes(values.iter().copied());
    assert_eq!(error(&[]), "it has no field `theta_i`");
    let theta: (&str, &[usize], _, _) = ("theta_i", &[2], floats(&[0.0, 1.0]), 10);
    assert_eq!(
        error(&[("theta_i", &[2], floats(&[1.0, 0.0]), 10), ("phi_i", &[1], floats(&[0.0]), 10)]),
        "the numbers of its field `theta_i` do not ascend"
    );
    assert_eq!(error(&[("theta_i", &[2], vec![0, 0], 1)]), "its field `theta_i` has no numbers of 32 bits");
    assert!(error(&[("theta_i", &[1, 1], floats(&[0.0]), 10)]).contains("dimensions [1, 1]"));
    assert!(error(&[("theta_i", &[1], floats(&[f32::NAN]), 10)]).contains("infinite or none"));
    let phi: (&str, &[usize], _, _) = ("phi_i", &[1], floats(&[0.0]), 10);
    let ndf: (&str, &[usize], _, _) = ("ndf", &[1, 2], floats(&[1.0, 1.0]), 10);
    assert!(error(&[theta, phi, ndf]).contains("a side of one number"));
}
