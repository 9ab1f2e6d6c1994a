//! A material with a relief that is not modelled: what a texture says of its bumps and dents moves the normals, not the surface.
//!
//! A texture of normals gives one at each point, `m = 2 rgb - 1`, in the frame of the tangents and the normal, and `scale`
//! makes the relief flatter or steeper:
//!
//! ```text
//! n' along scale (mx t + my b) + mz n
//! ```
//!
//! A texture of heights `h` gives the normal of the surface that is raised by `h` [Blinn 1978], without leaving the tangent plane
//! [Mikkelsen 2010]:
//!
//! ```text
//! n' along |d| n - sign(d) (h_u (p_v x n) + h_v (n x p_u)),     d = p_u . (p_v x n)
//! ```
//!
//! with its derivatives by surface coordinates from differences over one texel of a picture. Heights that fill space have the gradient
//! `g`, of which the part across `n` is taken off: `n' along n - (g - (g . n) n)`.
//!
//! Where a [filter](crate::texture::TexelFilter) takes the mean of many normals, these are facets that are too small to be seen, and make
//! the surface rough: by the covariances of slopes ([`ColorTexture::filtered_normals`]), along their own axes where the material has none.
//!
//! Scene: `Matte { color 0.5 0.5 0.5  bump stones.png { height 0.02 } }`

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::parts::answers_of_part;
use super::{Appearance, Lean, Material, MaterialId, Orientation, ShadingPoint};
use crate::bsdf::{Bsdf, Phong};
use crate::emission::SurfaceEmission;
use crate::texture::{
    AnyTexture, ColorTexture, FilteredNormals, FloatTexture, TextureContext, TextureEvaluator, TextureSlope,
    Textures,
};

/// The least part of a mean of normals along the normal of the surface that slopes are counted over: steeper is rough in any case.
const LEAST_UPRIGHT: f32 = 0.1;

/// A relief.
#[derive(Clone, Debug)]
pub enum Relief {
    /// By normals.
    Normals {
        /// Red to the first tangent, green to the second, blue along the normal; a half is nothing.
        normals: ColorTexture,
        /// Factor of the components across the normal.
        scale: FloatTexture,
    },
    /// By heights.
    Heights {
        /// The heights.
        heights: FloatTexture,
        /// How far 1 rises above 0, in units of the world.
        height: f32,
    },
}

impl Relief {
    /// How the normal leans at a point.
    ///
    /// * `filtered`: [`Relief::filtered`] there
    fn lean(&self, evaluator: TextureEvaluator<'_>, filtered: Option<&FilteredNormals>) -> Lean {
        match self {
            Relief::Normals { normals, scale } => {
                let here = || {
                    let m = 2.0 * Vec3::from(normals.rgb(evaluator).to_rgb()) - 1.0;
                    normals.along(evaluator.textures, m.truncate()).extend(m.z)
                };
                let m = filtered.map_or_else(here, |filtered| filtered.mean);
                Lean::Tangent((scale.at(evaluator) * m.truncate()).extend(m.z))
            }
            Relief::Heights { heights, height } => {
                let TextureSlope { uv, p } = heights.slope(evaluator, *height);
                Lean::Slope { by_uv: uv, by_p: p }
            }
        }
    }

    /// The normals that are seen as one.
    fn filtered(&self, evaluator: TextureEvaluator<'_>) -> Option<FilteredNormals> {
        match self {
            Relief::Normals { normals, .. } => normals.filtered_normals(evaluator),
            Relief::Heights { .. } => None,
        }
    }

    /// The factor from components of such normals to slopes.
    fn steepness(&self, evaluator: TextureEvaluator<'_>, filtered: &FilteredNormals) -> f32 {
        match self {
            Relief::Normals { scale, .. } => scale.at(evaluator) / filtered.mean.z.max(LEAST_UPRIGHT),
            Relief::Heights { .. } => 0.0,
        }
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        match self {
            Relief::Normals { normals, scale } => vec![normals.into(), (*scale).into()],
            Relief::Heights { heights, .. } => vec![(*heights).into()],
        }
    }
}

/// Another material with a relief.
#[derive(Clone, Debug)]
pub struct Embossed {
    /// What it is otherwise.
    pub material: MaterialId,
    /// Its relief.
    pub relief: Relief,
}

impl Embossed {
    /// What there is under the relief.
    fn chosen<'a>(
        &self,
        _appearance: &Appearance,
        at: &ShadingPoint<'a>,
    ) -> Option<(MaterialId, ShadingPoint<'a>)> {
        Some((self.material, *at))
    }
}

impl Material for Embossed {
    fn is_finite(&self) -> bool {
        match &self.relief {
            Relief::Normals { .. } => true,
            Relief::Heights { height, .. } => height.is_finite(),
        }
    }

    fn textures(&self) -> Vec<AnyTexture<'_>> {
        self.relief.textures()
    }

    fn parts(&self) -> &[MaterialId] {
        std::slice::from_ref(&self.material)
    }

    fn emission(
        &self,
        of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
        _textures: &mut Textures,
    ) -> Option<SurfaceEmission> {
        Some(of_part(self.material))
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        appearance.phong(self.material, at)
    }

    fn needs_uv(&self, appearance: &Appearance) -> bool {
        let of_relief = |texture: AnyTexture<'_>| texture.needs_uv(&appearance.textures);
        appearance.needs_uv(self.material) || self.relief.textures().into_iter().any(of_relief)
    }

    answers_of_part!(interior);

    fn bsdf<'a>(&'a self, appearance: &'a Appearance, at: &ShadingPoint<'_>) -> Bsdf<'a> {
        let bsdf = appearance.bsdf(self.material, at);
        let evaluator = appearance.textures.evaluator(at.context);
        let Some(filtered) = self.relief.filtered(evaluator) else { return bsdf };
        let steepness = self.relief.steepness(evaluator, &filtered);
        let (variances, _) = filtered.spread.principal();
        let [x, y] = variances.map(|variance| steepness * steepness * variance);
        // Facets that run somewhere already keep their direction.
        let runs = appearance.orientation(self.material, at).turn.is_some();
        bsdf.widened(if runs { Vec2::splat(0.5 * (x + y)) } else { Vec2::new(x, y) })
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        let own = appearance.orientation(self.material, at);
        let evaluator = appearance.textures.evaluator(at.context);
        let filtered = self.relief.filtered(evaluator);
        let turn = own.turn.or(filtered.as_ref().map(|filtered| filtered.spread.principal().1));
        Orientation { lean: Some(self.relief.lean(evaluator, filtered.as_ref())), turn }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        appearance.passage(self.material, at, cos)
    }
}
