//! Objects that give light: each piece of their surfaces becomes a light of its own.

use std::collections::HashMap;
use std::sync::Arc;

use kajo_color::{Emission, Wavelengths};
use kajo_math::{Affine3A, DAffine3, DMat3, Vec2};
use kajo_scene::Diagnostic;

use super::Compiler;
use crate::background::Background;
use crate::family::Pooled;
use crate::glow::{EmissionFactor, EmissionTerm, VariedEmission};
use crate::ids::{LightGroup, LightIndex, ObjectId, PoseId, VariedEmissionId};
use crate::light::{AreaLight, LightId, LightSampler, Sides, SkyLight};
use crate::material::{MaterialId, MaterialPoint};
use crate::motion::MovingTransform;
use crate::shape::{Patch, ShapeId};
use crate::texture::{PictureMap, Share, SurfaceUv, TextureId};

/// Memory of a light: itself, and its places in the lists and the tree by which lights are chosen.
const BYTES_PER_LIGHT: usize = size_of::<AreaLight>() + 96;

/// What a material says about giving light.
#[derive(Clone, Debug)]
pub(super) struct Glow {
    /// Its light, which is that of several materials where it mixes them.
    terms: Vec<EmissionTerm>,
    sides: Sides,
    group: LightGroup,
}

impl Glow {
    /// The same light everywhere, on all sides.
    pub(super) fn even(emission: Emission) -> Option<Glow> {
        let terms = vec![EmissionTerm { emission, factors: Vec::new() }];
        Glow { terms, sides: Sides::Both, group: LightGroup::default() }.if_any()
    }

    /// The light where it leaves the surface on these sides only.
    pub(super) fn on(self, sides: Sides) -> Glow {
        Glow { sides, ..self }
    }

    /// The light among that of a group.
    pub(super) fn in_group(self, group: LightGroup) -> Glow {
        Glow { group, ..self }
    }

    /// The light as it shines through a picture.
    pub(super) fn through(mut self, slide: PictureMap) -> Glow {
        self.terms.iter_mut().for_each(|term| term.factors.push(EmissionFactor::Slide(slide.clone())));
        self
    }

    /// The light of a surface that the colours at its vertices tint too.
    pub(super) fn tinted(mut self) -> Glow {
        self.terms.iter_mut().for_each(|term| term.factors.push(EmissionFactor::Tint));
        self
    }

    /// The light of which a share is left at each place; `None` where nothing is.
    pub(super) fn weakened(mut self, share: &Share) -> Option<Glow> {
        for term in &mut self.terms {
            match share {
                Share::Plain(value) => term.emission = term.emission.clone().scaled(*value),
                Share::Picture(..) | Share::Cut(..) => {
                    term.factors.push(EmissionFactor::Share(share.clone()))
                }
            }
        }
        self.if_any()
    }

    /// The light of one of two materials that a pattern mixes.
    ///
    /// * `pattern`: where it is, and the share of the second material if that is the same everywhere
    pub(super) fn mixed(
        mut self,
        (pattern, pattern_from_world): (TextureId, Affine3A),
        even: Option<f32>,
        is_second: bool,
    ) -> Option<Glow> {
        if let Some(t) = even {
            return self.weakened(&Share::Plain(if is_second { t } else { 1.0 - t }));
        }
        let share = EmissionFactor::Pattern { pattern, pattern_from_world, is_second };
        self.terms.iter_mut().for_each(|term| term.factors.push(share.clone()));
        self.if_any()
    }

    /// The light of both, on the sides and in the group of this one.
    pub(super) fn with(mut self, other: Glow) -> Glow {
        self.terms.extend(other.terms);
        self
    }

    /// Whether both shine from the same sides and belong to the same group.
    pub(super) fn agrees_with(&self, other: &Glow) -> bool {
        self.sides == other.sides && self.group == other.group
    }

    /// What there is of it.
    fn if_any(mut self) -> Option<Glow> {
        self.terms.retain(|term| !term.emission.is_black());
        (!self.terms.is_empty()).then_some(self)
    }

    /// The light, where it is the same everywhere.
    fn constant(&self) -> Option<&Emission> {
        match &*self.terms {
            [EmissionTerm { emission, factors }] if factors.is_empty() => Some(emission),
            _ => None,
        }
    }
}

/// What emitters have to know of the light of their material.
struct Shining {
    /// The light, or its mean.
    emission: Emission,
    /// The number of light that varies.
    varied: Option<VariedEmissionId>,
    sides: Sides,
    group: LightGroup,
}

impl Compiler<'_> {
    /// Makes the lights of all glowing objects, and marks these.
    pub(super) fn glowing_objects(&mut self) {
        if self.glows.is_empty() {
            return;
        }
        let mut unbounded = false;
        let mut drifts = HashMap::new();
        let glows = self.shining();
        for i in 0..self.geometry.primitives.len() {
            let primitive = self.geometry.primitives[i];
            if !glows.contains_key(&primitive.material) && !self.brings_lights(primitive.shape) {
                continue;
            }
            let bounds = self.geometry.shapes.bounds(primitive.shape);
            unbounded |= !bounds.is_finite() && !bounds.is_empty();
            let mut lights = Vec::new();
            let (map, drift) = self.start(primitive.pose, &mut drifts);
            self.geometry.shapes.patches(primitive.shape, |part, patch| {
                let slot = self.geometry.shapes.material_slot(primitive.shape, part);
                let material = slot.map_or(primitive.material, |slot| self.appearance.slots[slot as usize]);
                let Some(Shining { emission, varied, sides, group }) = glows.get(&material) else { return };
                let emission = match *varied {
                    None => emission.clone(),
                    Some(varied) => {
                        self.light_of_piece(emission, varied, primitive.shape, (part, &patch), &map)
                    }
                };
                let patch = if primitive.pose.is_identity() { Some(patch) } else { patch.transformed(&map) };
                let patch = match &drift {
                    Some(drift) => patch.and_then(|patch| patch.movable(drift.sampled_maps())),
                    None => patch,
                };
                let light = |patch| AreaLight {
                    patch,
                    drift: drift.clone(),
                    emission,
                    varied: *varied,
                    sides: *sides,
                    object: ObjectId::from_index(i as u32),
                    part,
                };
                lights.extend(patch.filter(|patch| patch.area() > 0.0).map(|patch| (light(patch), *group)));
            });
            let bytes = lights.len() * BYTES_PER_LIGHT;
            if let Err(over) = self.options.limits.memory.take(bytes as u64) {
                let error = Diagnostic::error(format!("there is no memory for so many lights: {over}"));
                self.diagnostics.push(error);
                return;
            }
            self.geometry.primitives[i].glows = !lights.is_empty();
            for (light, group) in lights {
                if let Some(id) = light.store(&mut self.lights) {
                    self.light_list.push(id);
                    self.groups_of_lights.push(group);
                }
            }
        }
        if unbounded {
            let warning =
                Diagnostic::warning("a plane without bounds gives no light, whatever its material says");
            self.diagnostics.push(warning.help("a `Quad` or a `Disk` can be a light"));
        }
    }

    /// The light of a piece whose places differ, for emitters to be chosen by: nine tenths of it what some of the places give,
    /// and a tenth what the material does on the whole, lest light between them be left undrawn.
    ///
    /// * `mean`: of all places of the material
    /// * `patch`: the piece in the shape's own space; `map` takes it to the world's
    fn light_of_piece(
        &self,
        mean: &Emission,
        varied: VariedEmissionId,
        shape: ShapeId,
        (part, patch): (u32, &Patch),
        map: &DAffine3,
    ) -> Emission {
        /// Places across and up.
        const GRID: u8 = 4;
        const KNOWN: f32 = 0.9;
        let varied = &self.varied_emissions[varied.index()];
        let light = |i: u8| {
            let u = Vec2::new((i % GRID).into(), (i / GRID).into()) + 0.5;
            let p = patch.sample_area(u / f32::from(GRID))?.p;
            let hit = self.geometry.shapes.hit_at(shape, part, p);
            let uv = self.geometry.shapes.uv_at(shape, &hit, p);
            let second = self.geometry.shapes.second_uv_at(shape, &hit).unwrap_or(uv);
            let place = MaterialPoint {
                p: map.transform_point3(p.as_dvec3()).as_vec3(),
                uv: SurfaceUv { first: uv, second },
                tint: self.geometry.shapes.color_at(shape, &hit),
            };
            Some(varied.at(&self.appearance.textures, &place, &Wavelengths::RGB).luminance())
        };
        let found: Vec<f32> = (0..GRID * GRID).filter_map(light).collect();
        let share = found.iter().sum::<f32>() / (found.len() as f32 * mean.luminance());
        let share = if share.is_finite() { KNOWN * share + (1.0 - KNOWN) } else { 1.0 };
        mean.clone().scaled(share)
    }

    /// Puts light that varies into its list, and says what emitters have to know of each material's.
    fn shining(&mut self) -> HashMap<MaterialId, Shining> {
        let varied = &mut self.varied_emissions;
        let shining = |(&id, glow): (&MaterialId, &Glow)| {
            let &Glow { sides, group, ref terms } = glow;
            if let Some(emission) = glow.constant() {
                return (id, Shining { emission: emission.clone(), varied: None, sides, group });
            }
            let light = VariedEmission::new(terms.clone());
            let emission = light.mean();
            let number = VariedEmissionId::new(varied.len());
            varied.push(light);
            (id, Shining { emission, varied: number, sides, group })
        };
        self.glows.iter().map(shining).collect()
    }

    /// The map of an object as the shutter opens, and how it moves from there if it does; `drifts` has those of the
    /// objects before it.
    fn start(
        &self,
        pose: PoseId,
        drifts: &mut HashMap<PoseId, Arc<MovingTransform>>,
    ) -> (DAffine3, Option<Arc<MovingTransform>>) {
        if let Some(still) = pose.still_in(&self.geometry.transforms) {
            return (double(&still.world_from_object), None);
        }
        let Some(motion) = pose.moving_in(&self.geometry.motions) else { return (DAffine3::IDENTITY, None) };
        let drift = || Arc::new(motion.since_opening());
        let drift = motion.moves().then(|| Arc::clone(drifts.entry(pose).or_insert_with(drift)));
        (motion.map_at(0.0), drift)
    }

    /// The lights that integrators draw from: those of the file, glowing pieces, and the background.
    pub(super) fn light_sampler(&mut self, background: &Arc<Background>) -> LightSampler {
        let groups = self.groups_of_lights.iter().copied();
        let mut list: Vec<(LightId, LightGroup)> = self.light_list.iter().copied().zip(groups).collect();
        let n_areas = self.lights.areas.len();
        let first_area = list.len() - n_areas;
        let mut sky = None;
        if !background.is_black()
            && let Some(id) = SkyLight::new(Arc::clone(background)).store(&mut self.lights)
        {
            sky = LightIndex::new(list.len());
            list.push((id, self.sky_group));
        }
        LightSampler::new(list, first_area, sky, &self.lights)
    }
}

/// The same map in double precision.
fn double(m: &Affine3A) -> DAffine3 {
    let column = |v: kajo_math::Vec3A| kajo_math::Vec3::from(v).as_dvec3();
    let matrix3 =
        DMat3::from_cols(column(m.matrix3.x_axis), column(m.matrix3.y_axis), column(m.matrix3.z_axis));
    DAffine3 { matrix3, translation: column(m.translation) }
}
