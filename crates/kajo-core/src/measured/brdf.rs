//! BRDFs of single materials by tables, in the forms of two data bases.

use std::fmt;

use kajo_color::{RgbBasis, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};
use kajo_scene::{AssetError, AssetFile, Limits, OverBudget, read_limited};

use super::merl::MerlBrdf;
use super::rgl::RglBrdf;
use super::tensor_file::is_tensor_file;

/// Nodes of the table of albedos over the cosine of the viewer.
const ALBEDOS: usize = 16;

/// Directions along each side of the square over which an albedo is averaged.
const SIDE: usize = 24;

/// A measured BRDF.
#[derive(Clone)]
pub struct MeasuredBrdf {
    table: Table,
    /// The share of light from everywhere that goes to the viewer, by the viewer's cosine from 0 to 1; linear RGB.
    albedos: Vec<[f32; 3]>,
}

#[derive(Clone)]
enum Table {
    Merl(MerlBrdf),
    Rgl(Box<RglBrdf>),
}

/// Why there is no such BRDF.
#[derive(Debug, thiserror::Error)]
pub enum MeasuredError {
    /// The file could not be read.
    #[error(transparent)]
    Asset(#[from] AssetError),
    /// It needs more memory than is left.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// It is something else, or damaged.
    #[error("{0}")]
    Content(String),
}

/// What a path asks for.
#[derive(Clone, Copy, Debug)]
pub enum MeasuredLanes {
    /// Wavelengths in nm, of a BRDF that is known by these.
    Nm([f32; 4]),
    /// What red, green and blue are in the lanes of the path.
    Rgb(RgbBasis),
}

impl fmt::Debug for MeasuredBrdf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match &self.table {
            Table::Merl(_) => "Merl",
            Table::Rgl(_) => "Rgl",
        };
        f.debug_struct(name).finish_non_exhaustive()
    }
}

impl MeasuredBrdf {
    /// Reads the table of a file, by its first bytes: that of RGL, or of MERL.
    ///
    /// # Errors
    /// [`MeasuredError`].
    pub fn read(file: AssetFile, limits: &Limits) -> Result<MeasuredBrdf, MeasuredError> {
        let limit = limits.mesh_bytes;
        if let Some(len) = file.len {
            let _held = limits.memory.share(len)?;
        }
        let bytes = read_limited(file, limit)?;
        let _held = limits.memory.share(bytes.len() as u64)?;
        MeasuredBrdf::from_bytes(&bytes).map_err(MeasuredError::Content)
    }

    /// As [`MeasuredBrdf::read`] of the content of a file.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn from_bytes(bytes: &[u8]) -> Result<MeasuredBrdf, String> {
        let table = match is_tensor_file(bytes) {
            true => Table::Rgl(Box::new(RglBrdf::read(bytes)?)),
            false => Table::Merl(MerlBrdf::read(bytes)?),
        };
        let mut brdf = MeasuredBrdf { table, albedos: Vec::new() };
        brdf.albedos = (0..ALBEDOS).map(|i| brdf.estimated_albedo(i as f32 / (ALBEDOS - 1) as f32)).collect();
        Ok(brdf)
    }

    /// Whether it depends on the azimuth of the surface.
    pub fn is_anisotropic(&self) -> bool {
        matches!(&self.table, Table::Rgl(table) if !table.is_isotropic())
    }

    /// What a path with these wavelengths asks for.
    pub fn lanes(&self, wavelengths: &Wavelengths) -> MeasuredLanes {
        match (&self.table, wavelengths.nm()) {
            (Table::Rgl(table), Some(nm)) if table.is_spectral() => MeasuredLanes::Nm(nm),
            _ => MeasuredLanes::Rgb(RgbBasis::new(wavelengths)),
        }
    }

    /// `f cos θi` for unit vectors above the surface.
    pub fn value(&self, wo: Vec3, wi: Vec3, lanes: &MeasuredLanes) -> Spectrum {
        match (lanes, &self.table) {
            (MeasuredLanes::Nm(nm), Table::Rgl(table)) => {
                table.spectrum(wo, wi, *nm).map_or(Spectrum::BLACK, Spectrum::from)
            }
            (MeasuredLanes::Rgb(basis), _) => basis.reflectance(self.rgb(wo, wi)),
            (MeasuredLanes::Nm(_), Table::Merl(_)) => Spectrum::BLACK,
        }
    }

    /// `f cos θi` in linear RGB.
    fn rgb(&self, wo: Vec3, wi: Vec3) -> [f32; 3] {
        match &self.table {
            Table::Merl(table) => table.value(wo, wi).map(|v| v * wi.z),
            Table::Rgl(table) => table.rgb(wo, wi),
        }
    }

    /// A direction of light for a viewer; nothing is scattered where it is below the surface.
    pub fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Vec3 {
        match &self.table {
            Table::Merl(table) => table.sample(wo, u, uc),
            Table::Rgl(table) => table.sample(wo, u),
        }
    }

    /// Density per solid angle of [`MeasuredBrdf::sample`], for unit vectors above the surface.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        match &self.table {
            Table::Merl(table) => table.pdf(wo, wi),
            Table::Rgl(table) => table.pdf(wo, wi),
        }
    }

    /// The albedo for a viewer with this cosine, on the mean of azimuths; linear RGB.
    pub fn albedo(&self, cos: f32) -> [f32; 3] {
        let place = cos.clamp(0.0, 1.0) * (ALBEDOS - 1) as f32;
        let node = (place as usize).min(ALBEDOS - 2);
        let (low, high) = (self.albedos[node], self.albedos[node + 1]);
        [0, 1, 2].map(|c| low[c] + (place - node as f32) * (high[c] - low[c]))
    }

    fn estimated_albedo(&self, cos: f32) -> [f32; 3] {
        let cos = cos.max(0.02);
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let mut sum = [0.0f64; 3];
        for i in 0..SIDE * SIDE {
            let u = Vec2::new((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5) / SIDE as f32;
            // Choices and azimuths of the viewer go by golden sections, so that they mix with the grid.
            let (uc, turn) = ((i as f32 * 0.618_034).fract(), (i as f32 * 0.754_878).fract());
            let (y, x) = kajo_math::fmath::sin_cos(turn * std::f32::consts::TAU);
            let wo = Vec3::new(sin * x, sin * y, cos);
            let wi = self.sample(wo, u, uc);
            let pdf = if wi.z > 0.0 { self.pdf(wo, wi) } else { 0.0 };
            if pdf > 0.0 {
                let value = self.rgb(wo, wi);
                (0..3).for_each(|c| sum[c] += f64::from(value[c] / pdf));
            }
        }
        sum.map(|v| (v / (SIDE * SIDE) as f64).clamp(0.0, 1.0) as f32)
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        match &self.table {
            Table::Merl(table) => table.bytes(),
            Table::Rgl(table) => table.bytes(),
        }
    }
}
