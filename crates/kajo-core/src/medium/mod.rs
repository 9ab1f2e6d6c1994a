//! Participating media: what fills bodies and the air, absorbs light, scatters it and gives light of its own.
//!
//! Along a segment of length `ds` the share `sigma_a ds` of the light is absorbed and the share `sigma_s ds` scattered, so
//!
//! ```text
//! dL/ds = -sigma_t L + sigma_s (integral of p(wo, wi) Li(wi) dwi),    sigma_t = sigma_a + sigma_s
//! ```
//!
//! [Chandrasekhar 1950]. A medium has coefficients by wavelength ([`Coefficients`]), and a density by position that both of
//! them are multiplied by. It also bounds the density on each interval of a ray ([`Majorant`]), which is
//! what collisions are sampled by. How they are drawn is part of the transport core.
//!
//! [`Fog`] is another thing: the haze of the classic formula, which scatters nothing.

mod albedo_grid;
mod bending;
mod black_hole;
#[cfg(test)]
mod bundle_tests;
mod coefficients;
mod emissive_volumes;
mod fog;
mod function;
pub mod gradient_index;
mod grid;
mod heat;
mod homogeneous;
mod majorant;
mod majorant_grid;
pub mod phase;
mod placed_voxels;
mod sparse;
mod subsurface;
mod textured;
mod velocity_grid;
mod voxel_cells;
mod wormhole;

pub use albedo_grid::{AlbedoGrid, AlbedoGridError};
pub use black_hole::{BlackHole, BlackHoleError, BlackHoleObserver};
pub use coefficients::{Coefficients, CoefficientsError};
pub(crate) use emissive_volumes::EmissiveVolume;
pub use emissive_volumes::EmissiveVolumes;
pub use fog::Fog;
pub use function::{FunctionMedium, FunctionMediumError};
pub use gradient_index::GradientIndex;
pub use grid::{DensityGrid, GridError, GridMedium};
pub use heat::{Heat, REFERENCE_KELVIN};
pub use homogeneous::HomogeneousMedium;
pub use majorant::Majorants;
pub use majorant_grid::{GridWalk, Majorant, MajorantGrid};
pub use phase::{Phase, PhaseAtWavelengths, PhaseSample};
pub use placed_voxels::{PlacedVoxels, affine};
pub use sparse::{DensityVoxel, SparseGridMedium};
pub use subsurface::albedo_of;
pub use textured::TextureMedium;
pub use velocity_grid::{VelocityComponents, VelocityGrid};
pub use wormhole::{WormholeError, WormholeMedium, WormholeShape};

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Aabb, Ray, Vec3};

use crate::curved_light::{Chords, ConservedQuantity, Followed, RayState, Region};
use crate::differential::RayDifferential;
use crate::family::{NO_MEMBER, family};
use crate::motion::Shutter;
use crate::texture::{AnyTexture, Textures};

/// What every medium can do.
pub trait Medium {
    /// Whether all its own numbers are finite.
    fn is_finite(&self) -> bool;

    /// The textures that it is made of.
    fn textures(&self) -> Vec<AnyTexture<'_>> {
        Vec::new()
    }

    /// What it does to light at the density 1.
    fn coefficients(&self) -> &Coefficients;

    /// The density at a world-space point, not negative, at the moment that it is of.
    fn density(&self, textures: &Textures, p: Vec3) -> f32;

    /// Whether the density depends on the wavelength.
    fn has_colored_density(&self) -> bool {
        false
    }

    /// The density at a world-space point for each wavelength, nowhere more than [`Medium::density`].
    fn spectral_density(&self, textures: &Textures, p: Vec3, _wavelengths: &Wavelengths) -> Spectrum {
        Spectrum::grey(self.density(textures, p))
    }

    /// Bounds on the density along a ray in world space, from its start on.
    ///
    /// * `ray`: of unit direction; `t_min` is 0
    fn majorants(&self, ray: &Ray) -> Majorants<'_>;

    /// The world-space box outside of which there is nothing of it; `None` where it has no end.
    fn bounds(&self) -> Option<Aabb>;

    /// How its matter moves while the shutter is open. What is asked at a point is then asked at its [source](VelocityGrid::source).
    fn velocities(&self) -> Option<&VelocityGrid> {
        None
    }

    /// Sees matter that moves through a shutter. Its [bounds](Medium::bounds) are no longer finite where it goes too far to be seen.
    fn expose(&mut self, _shutter: Shutter) {}

    /// Whether the density is the same everywhere, so that transmittance has a closed form.
    fn is_homogeneous(&self) -> bool {
        false
    }

    /// Whether light bends in it. Then it does nothing else to light: it neither absorbs nor scatters.
    fn bends_light(&self) -> bool {
        false
    }

    /// Whether light of different wavelengths goes different ways in it.
    fn is_dispersive(&self) -> bool {
        false
    }

    /// Index of refraction at a world-space point at the first wavelength; `None` where the medium leaves the index to
    /// what it fills.
    fn index(&self, _p: Vec3, _wavelengths: &Wavelengths) -> Option<f32> {
        None
    }

    /// What a camera sees that is in it and moves: the unit direction of the ray in the rest frame, and the frequency that the
    /// camera sees over the one that they see. `None` for a camera at rest.
    fn observed(&self, _ray: &Ray) -> Option<(Vec3, f32)> {
        None
    }

    /// Follows light through it, where light bends.
    ///
    /// * `ray`: starts inside; its direction has unit length
    /// * `around`: how neighbouring rays differ from it, if they are to be followed too
    /// * `region`: the body that it fills
    fn follow<C: Chords>(
        &self,
        _ray: &Ray,
        _around: Option<&RayDifferential>,
        _region: &Region,
        _wavelengths: &Wavelengths,
        _chords: &mut C,
    ) -> Option<Followed> {
        None
    }

    /// What should be the same at both ends of a way, where light bends.
    ///
    /// * `ends`: of [`Medium::follow`], for the same region and wavelengths
    fn conserved(
        &self,
        _ends: &[RayState; 2],
        _region: &Region,
        _wavelengths: &Wavelengths,
    ) -> [Option<ConservedQuantity>; 3] {
        [None; 3]
    }
}

/// A medium by a grid of colours.
pub type ColoredGridMedium = SparseGridMedium<[f32; 3]>;

family! {
    /// Names a medium in [`Media`].
    handle MediumId;
    /// All media of a scene.
    pools Media;
    /// Any medium.
    any AnyMedium;
    contract Medium;
    members {
        black_holes: BlackHole,
        colored_grids: ColoredGridMedium,
        functions: FunctionMedium,
        gradient_indices: GradientIndex,
        grids: GridMedium,
        homogeneous: HomogeneousMedium,
        sparse_grids: SparseGridMedium,
        textured: TextureMedium,
        wormholes: WormholeMedium,
    }
    any methods {
        /// See [`Medium::is_finite`].
        fn is_finite() -> bool;
        /// See [`Medium::textures`].
        fn textures() -> Vec<AnyTexture<'_>>;
    }
    all methods {
        /// See [`Medium::expose`].
        fn expose(shutter: Shutter);
    }
    methods {
        /// See [`Medium::coefficients`].
        fn coefficients() -> &Coefficients;
        /// See [`Medium::density`].
        fn density(textures: &Textures, p: Vec3) -> f32;
        /// See [`Medium::has_colored_density`].
        fn has_colored_density() -> bool;
        /// See [`Medium::spectral_density`].
        fn spectral_density(textures: &Textures, p: Vec3, wavelengths: &Wavelengths) -> Spectrum;
        /// See [`Medium::majorants`].
        fn majorants(ray: &Ray) -> Majorants<'_>;
        /// See [`Medium::bounds`].
        fn bounds() -> Option<Aabb>;
        /// See [`Medium::velocities`].
        fn velocities() -> Option<&VelocityGrid>;
        /// See [`Medium::is_homogeneous`].
        fn is_homogeneous() -> bool;
        /// See [`Medium::bends_light`].
        fn bends_light() -> bool;
        /// See [`Medium::is_dispersive`].
        fn is_dispersive() -> bool;
        /// See [`Medium::index`].
        fn index(p: Vec3, wavelengths: &Wavelengths) -> Option<f32>;
        /// See [`Medium::observed`].
        fn observed(ray: &Ray) -> Option<(Vec3, f32)>;
        /// See [`Medium::follow`].
        fn follow<C: Chords>(
            ray: &Ray,
            around: Option<&RayDifferential>,
            region: &Region,
            wavelengths: &Wavelengths,
            chords: &mut C,
        ) -> Option<Followed>;
        /// See [`Medium::conserved`].
        fn conserved(
            ends: &[RayState; 2],
            region: &Region,
            wavelengths: &Wavelengths,
        ) -> [Option<ConservedQuantity>; 3];
    }
}

/// A medium or none, in the 32 bits of its name: what paths carry many of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaybeMedium(u32);

impl MaybeMedium {
    /// Empty space.
    pub const VACUUM: MaybeMedium = MaybeMedium(NO_MEMBER);

    /// The medium, if there is one.
    #[inline]
    pub fn get(self) -> Option<MediumId> {
        (self != MaybeMedium::VACUUM).then_some(MediumId(self.0))
    }
}

impl Default for MaybeMedium {
    fn default() -> MaybeMedium {
        MaybeMedium::VACUUM
    }
}

impl From<Option<MediumId>> for MaybeMedium {
    fn from(medium: Option<MediumId>) -> MaybeMedium {
        medium.map_or(MaybeMedium::VACUUM, |MediumId(name)| MaybeMedium(name))
    }
}
