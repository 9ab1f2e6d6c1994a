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
//! the surface rough: by the covariances of slopes ([`ColorTexture::normal_spread`]), along their own axes where the material has none.
//!
//! Scene: `Matte { color 0.5 0.5 0.5  bump stones.png { height 0.02 } }`

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::parts::answers_of_part;
use super::{Appearance, Lean, Material, MaterialId, Orientation, ShadingPoint};
use crate::bsdf::{Bsdf, Phong};
use crate::emission::SurfaceEmission;
use crate::texture::{
    AnyTexture, ColorTexture, FloatTexture, NormalSpread, TextureContext, TextureEvaluator, TextureSlope,
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
    fn lean(&self, evaluator: TextureEvaluator<'_>) -> Lean {
        match self {
            Relief::Normals { normals, scale } => {
                let m = 2.0 * Vec3::from(normals.rgb(evaluator).to_rgb()) - 1.0;
                let across = scale.at(evaluator) * normals.along(evaluator.textures, m.truncate());
                Lean::Tangent(across.extend(m.z))
            }
            Relief::Heights { heights, height } => {
                let TextureSlope { uv, p } = heights.slope(evaluator, *height);
                Lean::Slope { by_uv: uv, by_p: p }
            }
        }
    }

    /// How much the slopes differ within what the sample covers, along the tangents; `None` where they do not.
    fn spread(&self, evaluator: TextureEvaluator<'_>) -> Option<NormalSpread> {
        let Relief::Normals { normals, scale } = self else { return None };
        let spread = normals.normal_spread(evaluator);
        if spread.is_none() {
            return None;
        }
        let upright = 2.0 * normals.rgb(evaluator).to_rgb()[2] - 1.0;
        let slope = scale.at(evaluator) / upright.max(LEAST_UPRIGHT);
        Some(spread.mapped(slope * Vec2::X, slope * Vec2::Y))
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
        let Some(spread) = self.relief.spread(appearance.textures.evaluator(&at.context)) else {
            return bsdf;
        };
        let ([x, y], _) = spread.principal();
        // Facets that run somewhere already keep their direction.
        let runs = appearance.orientation(self.material, at).turn.is_some();
        bsdf.widened(if runs { Vec2::splat(0.5 * (x + y)) } else { Vec2::new(x, y) })
    }

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        let own = appearance.orientation(self.material, at);
        let evaluator = appearance.textures.evaluator(&at.context);
        let turn = own.turn.or_else(|| self.relief.spread(evaluator).map(|spread| spread.principal().1));
        Orientation { lean: Some(self.relief.lean(evaluator)), turn }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        appearance.passage(self.material, at, cos)
    }
}
