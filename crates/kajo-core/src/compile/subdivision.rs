//! Meshes that are the cages of subdivision surfaces.

use std::sync::Arc;

use kajo_math::tape::Tape;
use kajo_math::{DVec3, Vec2, fmath};
use kajo_scene::{Params, Span};

use super::Compiler;
use super::fields::{Keys, Sources, choice, choices, count, degrees, keys, report_without};
use crate::interaction::SurfaceUv;
use crate::schema::FieldSpec;
use crate::shape::MeshData;
use crate::shape::subdivision::{BYTES_PER_TRIANGLE, Cage, Polygons, Scheme, Subdivided, triangle_count};
use crate::texture::{FloatTexture, TextureContext};

choices! {
    Scheme {
        "catmullClark" => Scheme::CatmullClark,
        "loop" => Scheme::Loop,
    }
}

keys! {
    /// The keys of meshes that are subdivided.
    pub(super) SubdivisionKeys {
        subdivide: u32 = count("subdivide", 0, 12).or(0, "steps of subdivision into a smooth surface"),
        scheme: Option<Scheme> =
            choice::<Scheme>("scheme").only_beside("subdivide").option("rules by which it is subdivided"),
        crease_angle: Option<f32> = degrees("creaseAngle", 0.0, 180.0)
            .only_beside("subdivide")
            .option("edges that bend by more stay sharp"),
    }
}

impl Subdivision {
    /// What the keys of a block say; `None` inside where it is not subdivided.
    ///
    /// * `fields`: other keys of the block that may need this
    pub fn read(
        params: &mut Params<'_, '_>,
        sources: &mut Sources<'_>,
        fields: &[FieldSpec],
    ) -> Option<Option<Subdivision>> {
        if !params.contains("subdivide") {
            report_without(params, SubdivisionKeys::FIELDS, "subdivide");
            report_without(params, fields, "subdivide");
        }
        let SubdivisionKeys { subdivide, scheme, crease_angle } = SubdivisionKeys::read(params, sources)?;
        let crease_deg = crease_angle.map(f32::to_bits);
        Some((subdivide > 0).then_some(Subdivision { levels: subdivide, scheme, crease_deg }))
    }
}

/// How a mesh is subdivided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Subdivision {
    /// Steps, at least one.
    pub levels: u32,
    /// By triangles or polygons if the scene says so, else as the file has them.
    pub scheme: Option<Scheme>,
    /// Bits of the angle in degrees beyond which edges are sharp.
    pub crease_deg: Option<u32>,
}

/// How far a surface is moved outwards.
#[derive(Clone, Debug)]
pub(super) enum Displacement {
    /// A number, or a picture over texture coordinates.
    Texture(FloatTexture),
    /// A function of the place before the move; where it has no value there is no surface.
    Function(Arc<Tape>),
}

/// A mesh that has been read: its triangles, and which of them make up faces of more corners.
pub(super) struct ReadFaces {
    pub data: MeshData,
    pub polygons: Vec<[u32; 2]>,
}

impl Compiler<'_> {
    /// A subdivided mesh; `None` where it would be too large, which is reported.
    ///
    /// * `displacement`: how far its vertices are moved along their normals
    pub(super) fn subdivided(
        &mut self,
        read: ReadFaces,
        how: Subdivision,
        displacement: Option<&Displacement>,
        (is_smooth, path, at): (bool, &str, Span),
    ) -> Option<MeshData> {
        let ReadFaces { data, polygons } = read;
        let scheme =
            how.scheme.unwrap_or(if polygons.is_empty() { Scheme::Loop } else { Scheme::CatmullClark });
        let inner: usize = polygons.iter().map(|[_, n]| 2 * (*n as usize).saturating_sub(1)).sum();
        let counts = [data.faces.len(), 3 * data.faces.len() - inner];
        let triangles = triangle_count(scheme, counts, how.levels);
        if triangles > self.options.limits.faces as u64 {
            let message = format!(
                "subdivided {} times it has more than {} triangles",
                how.levels, self.options.limits.faces
            );
            self.cannot_read(path, &message, at);
            return None;
        }
        let share = self.options.limits.memory.share(triangles.saturating_mul(BYTES_PER_TRIANGLE));
        let _making = share.map_err(|over| self.cannot_read(path, &over.to_string(), at)).ok()?;
        let has_uvs = data.uvs.is_some();
        let needs_uvs = matches!(displacement, Some(Displacement::Texture(texture)) if texture.needs_uv(self.scene.textures()));
        if needs_uvs && !has_uvs {
            self.warn_of_file(path, "it has no texture coordinates for the picture of `displacement`", at);
        }
        let crease_cos =
            how.crease_deg.map_or(-2.0, |bits| fmath::cos64(f64::from(f32::from_bits(bits)).to_radians()));
        let cage = Cage::new(Polygons::of_mesh(data, &polygons, scheme), crease_cos);
        let mut surface = Subdivided::new(cage, scheme, how.levels);
        match displacement {
            None => {}
            Some(Displacement::Texture(texture)) => {
                let textures = self.scene.textures();
                surface.displace(|p: DVec3, uv: Vec2| {
                    let at = TextureContext {
                        p: p.as_vec3(),
                        uv: SurfaceUv::from(uv),
                        ..TextureContext::default()
                    };
                    texture.at(textures.evaluator(&at)).into()
                });
            }
            Some(Displacement::Function(tape)) => {
                let mut slots = Vec::new();
                surface.displace(|p: DVec3, _| tape.at(&p.to_array(), &mut slots));
            }
        }
        Some(surface.into_mesh(is_smooth))
    }
}
