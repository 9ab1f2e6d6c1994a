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
//! Scene: `Matte { color 0.5 0.5 0.5  bump stones.png { height 0.02 } }`

use kajo_color::Spectrum;
use kajo_math::Vec3;

use super::parts::answers_of_part;
use super::{Appearance, Lean, Material, MaterialId, Orientation, ShadingPoint};
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::texture::{
    AnyTexture, ColorTexture, FloatTexture, TextureContext, TextureEvaluator, TextureSlope, Textures,
};

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

    answers_of_part!(bsdf, interior);

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        let own = appearance.orientation(self.material, at);
        Orientation { lean: Some(self.relief.lean(appearance.textures.evaluator(&at.context))), ..own }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        appearance.passage(self.material, at, cos)
    }
}
