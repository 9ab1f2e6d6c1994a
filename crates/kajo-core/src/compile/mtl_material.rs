//! What materials of MTL files become.
//!
//! A Phong material, as MTL describes it; where a material has any number of the extension for physically based ones
//! (`Pr Pm Ps Pc Pcr aniso anisor`), layers of these.

use std::collections::HashMap;

use kajo_color::{Emission, Spectrum};
use kajo_scene::{MtlMapUse, MtlMaterial, Span, TriMesh, read_mtl};

use super::Compiler;
use super::blocks::phong_material::absorption_of;
use crate::bsdf::Phong;
use crate::emission::SurfaceEmission;
use crate::ids::MaterialSlot;
use crate::material::{Embossed, Grain, LayeredMaterial, Layers, MaterialId, PhongMaterial, Relief};
use crate::texture::{Channel, Encoding, FloatTexture, PictureChannel, PictureMap, Wrap};

/// Albedo of what a library that cannot be read would describe.
const GREY: f32 = 0.5;

/// How far white of a `bump` rises above black, where the file makes it neither more nor less.
const BUMP_HEIGHT: f32 = 0.01;

/// What the numbers of a picture mean that is none of colours.
const AMOUNTS: Option<Encoding> = Some(Encoding::Linear);

/// A material where it stands.
struct Described<'a> {
    mtl: &'a MtlMaterial,
    /// Of its file, from whose folder pictures are found.
    path: &'a str,
    /// Where the scene names the mesh.
    span: Span,
}

/// The materials of libraries by their names, each with the path of its file.
type Library = HashMap<String, (MtlMaterial, String)>;

impl Compiler<'_> {
    /// For each face the slot of its material, or [`MaterialSlot::NONE`].
    pub(super) fn material_slots(
        &mut self,
        mesh: &TriMesh,
        path: &str,
        span: Span,
    ) -> Option<Vec<MaterialSlot>> {
        let face_materials = mesh.face_materials.as_ref()?;
        let (known, all_read) = self.libraries(mesh, path, span);
        let mut grey = None;
        let mut slots = Vec::with_capacity(mesh.material_names.len());
        for name in &mesh.material_names {
            slots.push(match known.get(name) {
                Some((mtl, path)) => {
                    let id = self.mtl_material(&Described { mtl, path, span });
                    if !self.has_memory_for_materials(span) {
                        return None;
                    }
                    self.slot(id, span)
                }
                None if all_read => {
                    let message = format!("it uses the material `{name}`, which none of its libraries has");
                    self.warn_of_file(path, &message, span);
                    MaterialSlot::NONE
                }
                None => *grey.get_or_insert_with(|| {
                    let diffuse = Spectrum::rgb(GREY, GREY, GREY);
                    let phong = Phong { ambient: diffuse, diffuse, ..Phong::BLACK };
                    let id = self.store_material(PhongMaterial::from(phong), span);
                    self.slot(id, span)
                }),
            });
        }
        Some(
            face_materials
                .iter()
                .map(|&m| slots.get(m as usize).copied().unwrap_or(MaterialSlot::NONE))
                .collect(),
        )
    }

    /// The slot of a material among those that meshes bring.
    fn slot(&mut self, id: Option<MaterialId>, span: Span) -> MaterialSlot {
        let Some(id) = id else { return MaterialSlot::NONE };
        let number = self.scene.mesh_material(id);
        self.accepted(number, span).unwrap_or(MaterialSlot::NONE)
    }

    /// The materials of a mesh's libraries, and whether all of these could be read.
    fn libraries(&mut self, mesh: &TriMesh, path: &str, span: Span) -> (Library, bool) {
        let mut known = Library::new();
        let mut all_read = true;
        for library in &mesh.libraries {
            let name = self.name_beside(library, path);
            let file = match self.assets.open(&name, path) {
                Ok(file) => file,
                Err(error) => {
                    all_read = false;
                    let message =
                        format!("its library `{library}` cannot be read, its materials are grey: {error}");
                    self.warn_of_file(path, &message, span);
                    continue;
                }
            };
            let mtl_path = file.path;
            match read_mtl(file.reader, &mtl_path, &self.options.limits) {
                Ok(mtl) => {
                    for sentence in mtl.skipped.sentences() {
                        self.warn_of_file(&mtl_path, &sentence, span);
                    }
                    let placed = |m: MtlMaterial| (m.name.clone(), (m, mtl_path.clone()));
                    known.extend(mtl.materials.into_iter().map(placed));
                }
                Err(error) => self.file_errors.push((error, span)),
            }
        }
        (known, all_read)
    }

    /// A file's name as it can be opened: some programs write the separators of their own system, and whole paths of
    /// files that lie beside the one that names them.
    fn name_beside(&self, name: &str, from: &str) -> String {
        let name = name.replace('\\', "/");
        let can_open = |name: &str| self.assets.open(name, from).is_ok();
        match name.rsplit_once('/') {
            Some((_, last)) if !can_open(&name) && can_open(last) => last.to_owned(),
            _ => name,
        }
    }

    fn mtl_material(&mut self, described: &Described<'_>) -> Option<MaterialId> {
        let mtl = described.mtl;
        let color = self.mtl_picture(described, MtlMapUse::Diffuse, None);
        let slide = self.mtl_picture(described, MtlMapUse::Emission, None);
        let slide = slide.and_then(|map| self.color_picture(map, described.span));
        let cover = self.mtl_cover(described);
        let (mut id, mut share) = if is_physical(mtl) {
            let layers = self.mtl_layers(described, color);
            let opacity = cover.or(mtl.opacity.map(|d| FloatTexture::Constant(d.clamp(0.0, 1.0))));
            let opacity = opacity.filter(|share| share.share_range()[0] < 1.0);
            (self.store_material(LayeredMaterial::from(layers), described.span)?, opacity)
        } else {
            let color = color.and_then(|map| self.color_picture(map, described.span));
            let material = PhongMaterial::from(phong(mtl)).with_picture(color);
            (self.store_material(material, described.span)?, cover)
        };
        let is_clear = self.scene.appearance().may_transmit(id);
        if is_clear && share.is_some() {
            let written = if mtl.map(MtlMapUse::Opacity).is_some() { "map_d" } else { "d" };
            let message =
                format!("`{written}` of the material `{}` is left out: light passes it anyway", mtl.name);
            self.warn_of_file(described.path, &message, described.span);
            share = None;
        }
        if let Some(relief) = self.mtl_relief(described) {
            id = self.store_material(Embossed { material: id, relief }, described.span)?;
        }
        let share = share.filter(|share| share.mean(&self.scene.appearance().textures) < 1.0);
        // Of a light of which only the picture is written the picture is all there is.
        let light = mtl.emission.unwrap_or(if slide.is_some() { [1.0; 3] } else { [0.0; 3] });
        let even = SurfaceEmission::from(Emission::from_rgb(light));
        let emission = slide.iter().fold(even, SurfaceEmission::through);
        self.lit_and_cut(id, emission, share, described.span)
    }

    /// The share of the surface that is there, of a material with a picture of that.
    fn mtl_cover(&mut self, described: &Described<'_>) -> Option<FloatTexture> {
        let map = self.mtl_picture(described, MtlMapUse::Opacity, AMOUNTS)?;
        // Where a picture has an alpha channel, that is what programs mean.
        let usual = if map.means()[Channel::Alpha as usize] < 1.0 { Channel::Alpha } else { Channel::Red };
        let channel = described.channel(MtlMapUse::Opacity).unwrap_or(usual);
        let texture = self.scene.float_texture(PictureChannel { map, channel });
        self.accepted(texture, described.span)
    }

    fn mtl_relief(&mut self, described: &Described<'_>) -> Option<Relief> {
        if let Some(map) = self.mtl_picture(described, MtlMapUse::Normals, AMOUNTS) {
            let normals = self.color_picture(map, described.span)?;
            return Some(Relief::Normals { normals, scale: 1.0.into() });
        }
        let map = self.mtl_picture(described, MtlMapUse::Bump, AMOUNTS)?;
        let bump = described.mtl.map(MtlMapUse::Bump)?.bump;
        // Many programs write pictures of normals there, which are blue on the whole.
        let [r, g, b, _] = map.means();
        if (r - 0.5).abs() < 0.15 && (g - 0.5).abs() < 0.15 && b > 0.7 {
            let normals = self.color_picture(map, described.span)?;
            return Some(Relief::Normals { normals, scale: bump.into() });
        }
        let channel = described.channel(MtlMapUse::Bump).unwrap_or_default();
        let heights = self.scene.float_texture(PictureChannel { map, channel });
        let heights = self.accepted(heights, described.span)?;
        Some(Relief::Heights { heights, height: BUMP_HEIGHT * bump })
    }

    fn mtl_layers(&mut self, described: &Described<'_>, color: Option<PictureMap>) -> Layers {
        let mtl = described.mtl;
        let mut amount = |shows, value: Option<f32>, default: f32| {
            let map = self.mtl_picture(described, shows, AMOUNTS);
            let default = if map.is_some() { 1.0 } else { default };
            let channel = described.channel(shows).unwrap_or_default();
            self.number(map, value.unwrap_or(default).clamp(0.0, 1.0), channel, described.span)
        };
        let diffuse = mtl.diffuse.unwrap_or([1.0; 3]).map(|v| v.clamp(0.0, 1.0));
        let defaults = Layers::default();
        let exponent = mtl.exponent.filter(|&e| e > 0.0);
        Layers {
            metalness: amount(MtlMapUse::Metalness, mtl.metalness, 0.0),
            roughness: amount(MtlMapUse::Roughness, mtl.roughness, exponent.map_or(0.5, roughness_of)),
            coat: amount(MtlMapUse::Coat, mtl.coat, 0.0),
            coat_roughness: amount(MtlMapUse::CoatRoughness, mtl.coat_roughness, 0.0),
            fuzz: amount(MtlMapUse::Sheen, mtl.sheen, 0.0),
            color: self.color(color, diffuse, described.span),
            grain: Grain {
                anisotropy: mtl.anisotropy.unwrap_or(0.0).clamp(0.0, 1.0).into(),
                rotation: mtl.anisotropy_rotation.unwrap_or(0.0).rem_euclid(1.0).into(),
            },
            transmission: transmission(mtl).into(),
            eta: mtl
                .index_of_refraction
                .filter(|&eta| eta >= 1.0)
                .map_or(defaults.eta, FloatTexture::Constant),
            ..defaults
        }
    }

    fn mtl_picture(
        &mut self,
        described: &Described<'_>,
        shows: MtlMapUse,
        encoding: Option<Encoding>,
    ) -> Option<PictureMap> {
        let shown = described.mtl.map(shows)?;
        let name = self.name_beside(&shown.file, described.path);
        let map = self.found_picture(&name, described.path, encoding, described.span)?;
        let wrap = if shown.clamps { [Wrap::Clamp; 2] } else { map.wrap };
        Some(PictureMap { wrap, repeat: shown.repeat.into(), offset: shown.offset.into(), ..map })
    }
}

impl Described<'_> {
    /// The channel that the file asks for.
    fn channel(&self, shows: MtlMapUse) -> Option<Channel> {
        const CHANNELS: [Channel; 4] = [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha];
        CHANNELS.get(usize::from(self.mtl.map(shows)?.channel?)).copied()
    }
}

/// Whether a material has anything of the extension for physically based ones.
fn is_physical(mtl: &MtlMaterial) -> bool {
    let numbers = [mtl.roughness, mtl.metalness, mtl.sheen, mtl.coat, mtl.coat_roughness, mtl.anisotropy];
    let pictures = [
        MtlMapUse::Roughness,
        MtlMapUse::Metalness,
        MtlMapUse::Sheen,
        MtlMapUse::Coat,
        MtlMapUse::CoatRoughness,
    ];
    numbers.iter().any(Option::is_some) || pictures.iter().any(|&shows| mtl.map(shows).is_some())
}

/// The share of light that goes into a material that has anything of that extension. Other programs than Blender write `Tf`
/// whether or not light does.
fn transmission(mtl: &MtlMaterial) -> f32 {
    let share = mtl.transmission.filter(|_| mtl.by_blender);
    share.map_or(0.0, |share| share.into_iter().fold(0.0, f32::max).min(1.0))
}

/// The roughness whose facets, of `α = roughness²`, have about the highlight of the exponent `2/α² - 2`.
fn roughness_of(exponent: f32) -> f32 {
    (2.0 / (exponent + 2.0)).sqrt().sqrt()
}

/// The Phong material that an MTL material describes.
fn phong(mtl: &MtlMaterial) -> Phong {
    let color = |c: Option<[f32; 3]>, default| c.map_or(default, |[r, g, b]| Spectrum::rgb(r, g, b));
    let diffuse = color(mtl.diffuse, Spectrum::WHITE);
    let specular = color(mtl.specular, Spectrum::BLACK);
    let mirrors = matches!(mtl.illumination, Some(3 | 5..=7));
    let through = 1.0 - mtl.opacity.unwrap_or(1.0).clamp(0.0, 1.0);
    let transparent = color(mtl.transmission, Spectrum::WHITE) * through;
    Phong {
        // `Ka` is left aside: many programs write black or white there whatever the material is.
        ambient: diffuse,
        diffuse,
        specular,
        exponent: mtl.exponent.unwrap_or(1.0).max(0.0),
        reflective: if mirrors { specular } else { Spectrum::BLACK },
        transparent,
        absorption: transparent.map(absorption_of),
        eta: mtl.index_of_refraction.filter(|&eta| eta > 0.0).unwrap_or(1.0),
    }
}
