//! Objects that give light: each piece of their surfaces becomes a light of its own.

use std::collections::HashMap;
use std::sync::Arc;

use kajo_color::Emission;
use kajo_math::{DAffine3, DMat3};
use kajo_scene::{Diagnostic, Params};

use super::Compiler;
use super::light_groups::LightGroups;
use super::spectra::SpectrumReader;
use crate::background::Background;
use crate::family::Pooled;
use crate::light::{AreaLight, Emitters, LightId, Sides, SkyLight};
use crate::motion::MovingTransform;

/// What a material says about giving light.
#[derive(Clone, Debug)]
pub(super) struct Glow {
    emission: Emission,
    sides: Sides,
    group: u8,
}

impl Glow {
    /// The light of a surface of which only this share is there; `None` where nothing is left.
    pub(super) fn weakened(self, share: f32) -> Option<Glow> {
        (share > 0.0).then(|| Glow { emission: self.emission.scaled(share), ..self })
    }
}

/// Reads `emission`, `emits` and `group` of a material.
pub(super) fn read_glow(
    params: &mut Params<'_, '_>,
    spectra: SpectrumReader<'_>,
    groups: &mut LightGroups,
) -> Option<Glow> {
    let emission = params.optional("emission", |args| spectra.emission(args));
    let names = [("back", Sides::Back), ("both", Sides::Both), ("front", Sides::Front)];
    let sides = params.optional("emits", |args| Ok((args.choice(&names)?, args.item())));
    let group = params.optional("group", |args| Ok((groups.number(args)?, args.item())));
    let [of_sides, of_group] = [sides.map(|(_, item)| item), group.map(|(_, item)| item)];
    for item in [of_sides, of_group].into_iter().flatten().filter(|_| emission.is_none()) {
        let message = format!("`{}` says nothing without an `emission`", item.keyword());
        params.diagnostics().push(Diagnostic::warning(message).label(item.head_span(), "has no effect"));
    }
    let emission = emission.filter(|emission| !emission.is_black())?;
    let sides = sides.map_or(Sides::Both, |(sides, _)| sides);
    Some(Glow { emission, sides, group: group.map_or(0, |(group, _)| group) })
}

impl Compiler<'_> {
    /// Makes the lights of all glowing objects, and marks these.
    pub(super) fn glowing_objects(&mut self) {
        if self.glows.is_empty() {
            return;
        }
        let mut unbounded = false;
        let mut drifts = HashMap::new();
        for i in 0..self.primitives.len() {
            let primitive = self.primitives[i];
            let is_lamp = self.glows.contains_key(&primitive.material);
            if !is_lamp {
                continue;
            }
            unbounded |= is_lamp && !self.shapes.bounds(primitive.shape).is_finite();
            let mut lights = Vec::new();
            let (map, drift) = self.start(primitive.transform, &mut drifts);
            self.shapes.patches(primitive.shape, |part, patch| {
                let slot = self.shapes.material_slot(primitive.shape, part);
                let material = slot.map_or(primitive.material, |slot| self.slot_materials[slot as usize]);
                let Some(Glow { emission, sides, group }) = self.glows.get(&material) else { return };
                let patch = if primitive.transform == 0 { Some(patch) } else { patch.transformed(&map) };
                let patch = match &drift {
                    Some(drift) => patch.and_then(|patch| patch.movable(drift.sampled_maps())),
                    None => patch,
                };
                let light = |patch| AreaLight {
                    patch,
                    drift: drift.clone(),
                    emission: emission.clone(),
                    sides: *sides,
                    primitive: i as u32,
                    part,
                };
                lights.extend(patch.filter(|patch| patch.area() > 0.0).map(|patch| (light(patch), *group)));
            });
            self.primitives[i].glows = !lights.is_empty();
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
            self.diagnostics.push(warning.help("a `Quad` or a `Disk` can be a lamp"));
        }
    }

    /// The map of an object as the shutter opens, and how it moves from there if it does; `drifts` has those of the
    /// objects before it.
    fn start(
        &self,
        transform: u32,
        drifts: &mut HashMap<u32, Arc<MovingTransform>>,
    ) -> (DAffine3, Option<Arc<MovingTransform>>) {
        if let Some(still) = self.transforms.get(transform as usize) {
            return (double(&still.world_from_object), None);
        }
        let motion = &self.motions[(u32::MAX - transform) as usize];
        let drift = || Arc::new(motion.since_opening());
        let drift = motion.moves().then(|| Arc::clone(drifts.entry(transform).or_insert_with(drift)));
        (motion.map_at(0.0), drift)
    }

    /// The lights that integrators draw from: those of the file, glowing pieces, and the background.
    pub(super) fn emitters(&mut self, background: &Arc<Background>) -> Emitters {
        let groups = self.groups_of_lights.iter().copied();
        let mut list: Vec<(LightId, u8)> = self.light_list.iter().copied().zip(groups).collect();
        let n_areas = self.lights.areas.len();
        let first_area = (list.len() - n_areas) as u32;
        let sky = (!background.is_black()).then(|| {
            let id = SkyLight::new(Arc::clone(background)).store(&mut self.lights);
            list.extend(id.map(|id| (id, self.sky_group)));
            list.len() as u32 - 1
        });
        Emitters::new(list, first_area, sky, &self.lights)
    }
}

/// The same map in double precision.
fn double(m: &kajo_math::Affine3A) -> DAffine3 {
    let column = |v: kajo_math::Vec3A| kajo_math::Vec3::from(v).as_dvec3();
    let matrix3 =
        DMat3::from_cols(column(m.matrix3.x_axis), column(m.matrix3.y_axis), column(m.matrix3.z_axis));
    DAffine3 { matrix3, translation: column(m.translation) }
}
