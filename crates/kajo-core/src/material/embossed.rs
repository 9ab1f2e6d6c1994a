//! A material with a relief that is not modelled: what a picture says of its bumps and dents moves the normals, not the surface.
//!
//! A picture of normals gives one for each texel, `m = 2 rgb - 1`, in the frame of the tangents and the normal, and `scale`
//! makes the relief flatter or steeper:
//!
//! ```text
//! n' along scale (mx t + my b) + mz n
//! ```
//!
//! A picture of heights `h` gives the normal of the surface that is raised by `h` [Blinn 1978], without leaving the tangent plane
//! [Mikkelsen 2010]:
//!
//! ```text
//! n' along |d| n - sign(d) (h_u (p_v x n) + h_v (n x p_u)),     d = p_u . (p_v x n)
//! ```
//!
//! with its derivatives from differences over one texel.
//!
//! Scene: `Matte { color 0.5 0.5 0.5  bump stones.png { height 0.02 } }`

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3};

use super::parts::answers_of_part;
use super::{Appearance, Lean, Material, MaterialId, Orientation, ShadingPoint};
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::texture::{Channel, PictureMap, SurfaceUv, TextureContext};

/// A relief.
#[derive(Clone, Debug)]
pub enum Relief {
    /// By the normals of a picture.
    Normals {
        /// Red to the first tangent, green to the second, blue along the normal; a half is nothing.
        map: PictureMap,
        /// Factor of the components across the normal.
        scale: f32,
    },
    /// By the heights of a picture.
    Heights {
        /// Where the heights are.
        map: PictureMap,
        /// Which of its channels they are.
        channel: Channel,
        /// How far white rises above black, in units of the world.
        height: f32,
    },
}

impl Relief {
    /// How the normal leans at surface coordinates.
    fn lean(&self, uv: SurfaceUv) -> Lean {
        match self {
            Relief::Normals { map, scale } => {
                let [r, g, b, _] = map.at(uv);
                let m = 2.0 * Vec3::new(r, g, b) - 1.0;
                let across = *scale * along(map, m.truncate());
                Lean::Tangent(across.extend(m.z))
            }
            Relief::Heights { map, channel, height } => {
                let half = 0.5 * map.texel();
                let rise = |step: Vec2| {
                    let [there, back] = [step, -step].map(|step| map.at(uv.moved(step))[*channel as usize]);
                    there - back
                };
                let rises = Vec2::new(rise(Vec2::new(half.x, 0.0)), rise(Vec2::new(0.0, half.y)));
                Lean::Slope(*height * rises / map.texel())
            }
        }
    }
}

/// A direction of the picture as one of the coordinates that place it.
fn along(map: &PictureMap, m: Vec2) -> Vec2 {
    if map.cross == Vec2::ZERO {
        return m * map.repeat.map(f32::signum);
    }
    let right = Vec2::new(map.repeat.x, map.cross.x).normalize_or_zero();
    let up = Vec2::new(map.cross.y, map.repeat.y).normalize_or_zero();
    m.x * right + m.y * up
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
            Relief::Normals { map, scale } => map.is_finite() && scale.is_finite(),
            Relief::Heights { map, height, .. } => map.is_finite() && height.is_finite(),
        }
    }

    fn parts(&self) -> &[MaterialId] {
        std::slice::from_ref(&self.material)
    }

    fn emission(
        &self,
        _appearance: &Appearance,
        of_part: &dyn Fn(MaterialId) -> SurfaceEmission,
    ) -> SurfaceEmission {
        of_part(self.material)
    }

    fn phong(&self, appearance: &Appearance, at: &TextureContext) -> Phong {
        appearance.phong(self.material, at)
    }

    fn needs_uv(&self, _appearance: &Appearance) -> bool {
        true
    }

    answers_of_part!(bsdf, interior);

    fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Orientation {
        let own = appearance.orientation(self.material, at);
        Orientation { lean: Some(self.relief.lean(at.context.uv)), ..own }
    }

    fn is_oriented(&self, _appearance: &Appearance) -> bool {
        true
    }

    fn passage(&self, appearance: &Appearance, at: &ShadingPoint<'_>, cos: f32) -> Spectrum {
        appearance.passage(self.material, at, cos)
    }
}
