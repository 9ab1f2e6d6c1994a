//! BRDFs as the material data base of EPFL's Realistic Graphics Lab tabulates them [Dupuy and Jakob 2018].
//!
//! Directions are measured where a model of facets would scatter light: for a direction to the viewer `o` a point `s` of the
//! unit square stands for a facet normal `m`, drawn by the density of the visible ones, and that for the direction to the light `i`.
//! What is stored is what light is scattered beyond that model:
//!
//! ```text
//! f(o, i) cos θi  =  r(s; o) D(m) / (4 σ(o)),           m = (o + i) / |o + i|,       s = V⁻¹(m; o)
//!
//! pdf(i)  =  L(s; o) V(m; o) / (2 π² u sin θm · 4 o·m),        u = (2 θm / π)^½
//! ```
//!
//! with `D` the distribution of facets, `σ` their projected area, `V` the density of visible ones and `L` that of the
//! luminance of `r`, over the square `(u, (φm + π) / 2π)`. An isotropic material is known for one azimuth of the viewer, and `φm` counts from it.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};

use kajo_color::{illuminant, observer, sensor};
use kajo_math::{Vec2, Vec3, fmath};

use super::tensor_file::{Tensor, tensors};
use super::warp::{Parameters, Slices, Warp, WarpGrid, bracket};

/// A BRDF of that form.
#[derive(Clone)]
pub struct RglBrdf {
    /// Azimuths and angles to the normal of the viewer.
    viewers: Parameters,
    is_isotropic: bool,
    /// In how many parts of the circle of azimuths it repeats: 1, 2 or 4.
    symmetry: u32,
    /// Whether `r` is to be multiplied by the model of facets.
    has_facets: bool,
    ndf: WarpGrid,
    sigma: WarpGrid,
    vndf: Warp,
    luminance: Warp,
    rgb: WarpGrid,
    /// Wavelengths in nm, and `r` at each.
    spectra: Option<(Vec<f32>, WarpGrid)>,
}

/// A pair of directions as the tables have it.
struct DirectionPair {
    slices: Slices,
    /// Of the viewer, and of the facet.
    u_o: Vec2,
    u_m: Vec2,
    m: Vec3,
    o: Vec3,
}

/// The angle to the normal, precise near 0.
fn elevation(w: Vec3) -> f32 {
    let distance = (w.x * w.x + w.y * w.y + (w.z - 1.0) * (w.z - 1.0)).sqrt();
    2.0 * fmath::asin((0.5 * distance).min(1.0))
}

fn unit_of(theta: f32, phi: f32) -> Vec2 {
    let turn = (phi + PI) * (1.0 / TAU);
    Vec2::new((theta * FRAC_2_PI).max(0.0).sqrt(), turn - turn.floor())
}

/// Negative zero counts as negative, as it does for the sign that undoes this.
fn toward_negative(x: f32, sign: f32) -> f32 {
    if sign.is_sign_negative() { x } else { -x }
}

/// A field of the shape that is wanted; 0 stands for any length.
fn field(
    fields: &std::collections::BTreeMap<String, Tensor<'_>>,
    name: &str,
    wanted: &[usize],
) -> Result<(Vec<usize>, Vec<f32>), String> {
    let tensor = fields.get(name).ok_or_else(|| format!("it has no field `{name}`"))?;
    let fits = tensor.shape.len() == wanted.len()
        && tensor.shape.iter().zip(wanted).all(|(&n, &w)| n > 0 && (w == 0 || n == w));
    if !fits {
        return Err(format!("its field `{name}` has the dimensions {:?}, which do not fit", tensor.shape));
    }
    let values = tensor.floats().ok_or_else(|| format!("its field `{name}` has no numbers of 32 bits"))?;
    if !values.iter().all(|v| v.is_finite()) {
        return Err(format!("a number of its field `{name}` is infinite or none"));
    }
    Ok((tensor.shape.clone(), values))
}

fn ascending(name: &str, values: &[f32]) -> Result<(), String> {
    let rises = values.windows(2).all(|pair| pair[0] < pair[1]);
    rises.then_some(()).ok_or_else(|| format!("the numbers of its field `{name}` do not ascend"))
}

impl RglBrdf {
    /// The BRDF of a file with the fields `theta_i`, `phi_i`, `ndf`, `sigma`, `vndf`, `luminance`, and `rgb` or `spectra` with
    /// `wavelengths`.
    ///
    /// # Errors
    /// What is missing or malformed, in words.
    pub fn read(file: &[u8]) -> Result<RglBrdf, String> {
        let fields = tensors(file)?;
        let (_, thetas) = field(&fields, "theta_i", &[0])?;
        let (_, phis) = field(&fields, "phi_i", &[0])?;
        ascending("theta_i", &thetas)?;
        ascending("phi_i", &phis)?;
        let [n_phi, n_theta] = [phis.len(), thetas.len()];
        let grid = |name: &str| {
            let (shape, values) = field(&fields, name, &[0, 0])?;
            let size = [shape[1], shape[0]];
            sides(name, size)?;
            Ok::<WarpGrid, String>(WarpGrid::new(size, 1, values))
        };
        let warp = |name: &str| {
            let (shape, values) = field(&fields, name, &[n_phi, n_theta, 0, 0])?;
            let size = [shape[3], shape[2]];
            sides(name, size)?;
            Warp::new(size, values).ok_or_else(|| format!("its field `{name}` is no density"))
        };
        let (ndf, sigma, vndf, luminance) = (grid("ndf")?, grid("sigma")?, warp("vndf")?, warp("luminance")?);
        let spectra = match fields.contains_key("spectra") {
            true => Some(spectra(&fields, [n_phi, n_theta])?),
            false => None,
        };
        let rgb = match &spectra {
            Some((wavelengths, size, values)) => WarpGrid::new(*size, 3, in_rgb(wavelengths, *size, values)),
            None => {
                let (shape, values) = field(&fields, "rgb", &[n_phi, n_theta, 3, 0, 0])?;
                let size = [shape[4], shape[3]];
                sides("rgb", size)?;
                WarpGrid::new(size, 3, values)
            }
        };
        let spectra = spectra.map(|(wavelengths, size, values)| {
            (wavelengths.clone(), WarpGrid::new(size, wavelengths.len(), values))
        });
        let range = phis[n_phi - 1] - phis[0];
        let is_isotropic = n_phi <= 2;
        let symmetry = if is_isotropic { 1 } else { (TAU / range).round() as u32 };
        if ![1, 2, 4].contains(&symmetry) {
            return Err(format!("its azimuths span {} degrees, not 90, 180 or 360", range.to_degrees()));
        }
        let jacobian =
            fields.get("jacobian").and_then(Tensor::bytes).and_then(|bytes| bytes.first().copied());
        let has_facets = jacobian.unwrap_or(1) != 0;
        let viewers = Parameters([phis, thetas]);
        Ok(RglBrdf { viewers, is_isotropic, symmetry, has_facets, ndf, sigma, vndf, luminance, rgb, spectra })
    }

    /// Whether it is known by wavelengths.
    pub fn is_spectral(&self) -> bool {
        self.spectra.is_some()
    }

    /// Whether the azimuth of the surface matters.
    pub fn is_isotropic(&self) -> bool {
        self.is_isotropic
    }

    /// Both directions turned to the part of the circle that is known, and the signs that turn back.
    fn reduced(&self, o: Vec3, i: Vec3) -> (Vec3, Vec3, [f32; 2]) {
        if self.symmetry < 2 {
            return (o, i, [-1.0; 2]);
        }
        let sy = o.y;
        let sx = if self.symmetry == 4 { o.x } else { sy };
        let turned = |w: Vec3| Vec3::new(toward_negative(w.x, sx), toward_negative(w.y, sy), w.z);
        (turned(o), turned(i), [sx, sy])
    }

    fn pair(&self, o: Vec3, m: Vec3) -> DirectionPair {
        let (theta_o, phi_o) = (elevation(o), fmath::atan2(o.y, o.x));
        let phi_m = fmath::atan2(m.y, m.x) - if self.is_isotropic { phi_o } else { 0.0 };
        let slices = self.viewers.slices([phi_o, theta_o]);
        DirectionPair { slices, u_o: unit_of(theta_o, phi_o), u_m: unit_of(elevation(m), phi_m), m, o }
    }

    /// The place of a pair of directions above the surface; `None` where there is no facet between them.
    fn between(&self, o: Vec3, i: Vec3) -> Option<DirectionPair> {
        let (o, i, _) = self.reduced(o, i);
        let m = (o + i).try_normalize()?;
        Some(self.pair(o, m))
    }

    /// The factor of what is stored.
    fn facets(&self, at: &DirectionPair) -> f32 {
        if !self.has_facets {
            return 1.0;
        }
        let sigma = self.sigma.eval(at.u_o, &ONE, 0);
        if sigma > 0.0 { self.ndf.eval(at.u_m, &ONE, 0) / (4.0 * sigma) } else { 0.0 }
    }

    /// `f cos θi` in linear RGB, for unit vectors above the surface.
    pub fn rgb(&self, o: Vec3, i: Vec3) -> [f32; 3] {
        let Some(at) = self.between(o, i) else { return [0.0; 3] };
        let (s, facets) = (self.vndf.invert(at.u_m, &at.slices), self.facets(&at));
        [0, 1, 2].map(|channel| (self.rgb.eval(s, &at.slices, channel) * facets).max(0.0))
    }

    /// `f cos θi` at wavelengths in nm; `None` where it is known in RGB only.
    pub fn spectrum(&self, o: Vec3, i: Vec3, nm: [f32; 4]) -> Option<[f32; 4]> {
        let (wavelengths, grid) = self.spectra.as_ref()?;
        let Some(at) = self.between(o, i) else { return Some([0.0; 4]) };
        let (s, facets) = (self.vndf.invert(at.u_m, &at.slices), self.facets(&at));
        Some(nm.map(|nm| {
            let (node, t) = bracket(wavelengths, nm);
            let low = grid.eval(s, &at.slices, node);
            let high = grid.eval(s, &at.slices, (node + 1).min(wavelengths.len() - 1));
            ((low + t * (high - low)) * facets).max(0.0)
        }))
    }

    /// Stretch from the square of facets to directions of light.
    fn jacobian(at: &DirectionPair) -> f32 {
        let sin = at.m.truncate().length();
        (2.0 * PI * PI * at.u_m.x * sin).max(1e-6) * 4.0 * at.o.dot(at.m)
    }

    /// Density per solid angle of [`RglBrdf::sample`].
    pub fn pdf(&self, o: Vec3, i: Vec3) -> f32 {
        let Some(at) = self.between(o, i) else { return 0.0 };
        let s = self.vndf.invert(at.u_m, &at.slices);
        let density = self.luminance.pdf(s, &at.slices) * self.vndf.pdf(at.u_m, &at.slices);
        let jacobian = RglBrdf::jacobian(&at);
        if jacobian > 0.0 { density / jacobian } else { 0.0 }
    }

    /// A direction of light for a viewer, which may be below the surface: then nothing is scattered.
    pub fn sample(&self, o: Vec3, u: Vec2) -> Vec3 {
        let (o, _, [sx, sy]) = self.reduced(o, o);
        let (theta_o, phi_o) = (elevation(o), fmath::atan2(o.y, o.x));
        let slices = self.viewers.slices([phi_o, theta_o]);
        let s = self.luminance.sample(Vec2::new(u.y, u.x), &slices);
        let u_m = self.vndf.sample(s, &slices);
        let theta = u_m.x * u_m.x * FRAC_PI_2;
        let phi = (2.0 * u_m.y - 1.0) * PI + if self.is_isotropic { phi_o } else { 0.0 };
        let ((sin, cos), (y, x)) = (fmath::sin_cos(theta), fmath::sin_cos(phi));
        let m = Vec3::new(sin * x, sin * y, cos);
        let i = 2.0 * o.dot(m) * m - o;
        Vec3::new(toward_negative(i.x, sx), toward_negative(i.y, sy), i.z).normalize_or(Vec3::Z)
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let grids =
            [Some(&self.ndf), Some(&self.sigma), Some(&self.rgb), self.spectra.as_ref().map(|s| &s.1)];
        let grids: usize = grids.into_iter().flatten().map(WarpGrid::bytes).sum();
        grids + self.vndf.bytes() + self.luminance.bytes()
    }
}

/// The one slice of a function without parameters.
const ONE: Slices = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];

fn sides(name: &str, [width, height]: [usize; 2]) -> Result<(), String> {
    let enough = width >= 2 && height >= 2;
    enough
        .then_some(())
        .ok_or_else(|| format!("its field `{name}` has a side of one number; two are the least"))
}

/// Wavelengths, and what is known at each of them.
type Spectra = (Vec<f32>, [usize; 2], Vec<f32>);

fn spectra(
    fields: &std::collections::BTreeMap<String, Tensor<'_>>,
    [n_phi, n_theta]: [usize; 2],
) -> Result<Spectra, String> {
    let (_, wavelengths) = field(fields, "wavelengths", &[0])?;
    ascending("wavelengths", &wavelengths)?;
    let (shape, values) = field(fields, "spectra", &[n_phi, n_theta, wavelengths.len(), 0, 0])?;
    let size = [shape[4], shape[3]];
    sides("spectra", size)?;
    Ok((wavelengths, size, values))
}

/// The colours of spectra under D65, linear RGB.
fn in_rgb(wavelengths: &[f32], [width, height]: [usize; 2], values: &[f32]) -> Vec<f32> {
    let (n, nodes) = (width * height, wavelengths.len());
    // What each node adds to the colour, as it stands for its part of a curve that is linear between nodes.
    let mut weights = vec![[0.0f64; 3]; nodes];
    let mut white = 0.0;
    for nm in 360..=830 {
        let nm = nm as f32;
        let light = f64::from(illuminant::d65(nm));
        let xyz = observer::matching(nm).map(|v| f64::from(v) * light);
        white += xyz[1];
        let (node, t) = bracket(wavelengths, nm);
        for (node, share) in [(node, 1.0 - t), ((node + 1).min(nodes - 1), t)] {
            (0..3).for_each(|c| weights[node][c] += f64::from(share) * xyz[c]);
        }
    }
    let rows = &sensor::RGB_FROM_XYZ;
    let of_channel = |row: &[f64; 3]| -> Vec<f64> {
        weights.iter().map(|xyz| (0..3).map(|k| row[k] * xyz[k]).sum::<f64>() / white).collect()
    };
    let rgb: Vec<Vec<f64>> = rows.iter().map(of_channel).collect();
    let mut out = Vec::new();
    for slice in values.chunks_exact(nodes * n) {
        for shares in &rgb {
            out.extend((0..n).map(|i| {
                (0..nodes).map(|node| f64::from(slice[node * n + i]) * shares[node]).sum::<f64>() as f32
            }));
        }
    }
    out
}

#[cfg(test)]
pub(crate) mod tests;
