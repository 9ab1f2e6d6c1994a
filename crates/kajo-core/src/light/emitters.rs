//! All lights of a scene, to draw from.

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use super::{
    AreaLight, DirectionalLight, Emitter, LightChoice, LightId, LightSample, LightTree, Lights, SkyLight,
};
use crate::family::Pooled;

/// The lights of a scene, in one list: those of the file, then the pieces of glowing objects, then the sky.
#[derive(Debug, Default)]
pub struct Emitters {
    list: Vec<LightId>,
    /// The group of each.
    groups: Vec<u8>,
    /// Where the pieces begin; they are sorted by object and part.
    first_area: u32,
    /// Where the background is, if it gives light.
    sky: Option<u32>,
    /// Directional lights that are wide enough to be met.
    discs: Vec<u32>,
    /// Whether any piece of a glowing object gives not the same light everywhere.
    varies: bool,
    tree: LightTree,
}

impl Emitters {
    /// * `first_area`: the number of the first piece of a glowing object; from there on `list` names the pool of
    ///   pieces in its order
    /// * `sky`: the number of the background
    pub(crate) fn new(
        list: Vec<(LightId, u8)>,
        first_area: u32,
        sky: Option<u32>,
        lights: &Lights,
    ) -> Emitters {
        let (list, groups): (Vec<LightId>, Vec<u8>) = list.into_iter().unzip();
        let bounds: Vec<_> = list.iter().map(|&id| lights.bounds(id)).collect();
        let is_disc =
            |&id: &LightId| DirectionalLight::find(lights, id).is_some_and(|light| light.disc().is_some());
        let discs = (0..).zip(&list).filter_map(|(number, id)| is_disc(id).then_some(number)).collect();
        let varies = lights.areas.iter().any(|light| light.varied.is_some());
        Emitters { list, groups, first_area, sky, discs, varies, tree: LightTree::build(&bounds) }
    }

    /// Number of lights that can be drawn.
    pub fn len(&self) -> usize {
        self.tree.len()
    }

    /// Whether nothing gives light.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty()
    }

    /// All lights by their numbers.
    pub(crate) fn list(&self) -> &[LightId] {
        &self.list
    }

    /// The light of that number.
    pub fn id(&self, number: u32) -> LightId {
        self.list[number as usize]
    }

    /// The lights of the file, and pieces that stand for all of each glowing object, with the factor of their light.
    ///
    /// * `most`: pieces of an object; of one that has more so many are taken, by their power, that stand for equal parts
    ///   of it
    pub fn representatives(&self, lights: &Lights, most: usize) -> Vec<(LightId, f32)> {
        let first_area = self.first_area as usize;
        let mut taken: Vec<_> = self.list[..first_area].iter().map(|&id| (id, 1.0)).collect();
        let mut pieces = self.list[first_area..].iter().copied();
        for object in lights.areas.chunk_by(|a, b| a.primitive == b.primitive) {
            let ids = pieces.by_ref().take(object.len());
            if object.len() <= most {
                taken.extend(ids.map(|id| (id, 1.0)));
                continue;
            }
            let power = |light: &AreaLight| light.bounds().map_or(0.0, |bounds| f64::from(bounds.power));
            let share = object.iter().map(power).sum::<f64>() / most as f64;
            let (mut sum, mut parts_before) = (0.0, 0.0);
            for (id, light) in ids.zip(object) {
                sum += power(light);
                // The middles of equal parts that lie on this piece.
                let parts = (sum / share + 0.5).floor();
                if parts > parts_before {
                    taken.push((id, ((parts - parts_before) * share / power(light)) as f32));
                    parts_before = parts;
                }
            }
        }
        taken
    }

    /// The number of the background, if it gives light.
    pub fn sky(&self) -> Option<u32> {
        self.sky
    }

    /// The directional lights whose discs cover the unit direction `d`, by their numbers, and the radiance from there.
    #[inline]
    pub fn discs<'a>(
        &'a self,
        lights: &'a Lights,
        d: Vec3,
        wavelengths: &'a Wavelengths,
    ) -> impl Iterator<Item = (u32, Spectrum)> {
        self.discs.iter().filter_map(move |&number| {
            let light = DirectionalLight::find(lights, self.id(number))?;
            let disc = light.disc().filter(|disc| disc.covers(d))?;
            Some((number, light.radiance(&disc, wavelengths)))
        })
    }

    /// A light, if it is a piece of a glowing object that gives not the same light everywhere, and the number of what it
    /// gives.
    #[inline]
    pub fn varied<'a>(&self, lights: &'a Lights, number: u32) -> Option<(&'a AreaLight, u32)> {
        if !self.varies {
            return None;
        }
        let light = AreaLight::find(lights, self.id(number))?;
        Some((light, light.varied?))
    }

    /// Bytes of the tree and the list.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(&*self.list) + size_of_val(&*self.groups)
    }

    /// The group of the light of this number.
    #[inline]
    pub fn group(&self, number: u32) -> u8 {
        self.groups[number as usize]
    }

    /// The group of the background.
    #[inline]
    pub fn sky_group(&self) -> u8 {
        self.sky.map_or(0, |number| self.group(number))
    }

    /// Light drawn for a receiver; its density includes the choice of the emitter.
    ///
    /// * `p`, `n`: point and unit normal of the receiver; the normal is zero where it has none
    /// * `time`: moment within the shutter interval
    /// * `u`: uniform in [0, 1), chooses the light
    #[inline]
    #[expect(
        clippy::too_many_arguments,
        reason = "a receiver, numbers and a mode; a struct would hold nothing together"
    )]
    pub fn sample(
        &self,
        lights: &Lights,
        [p, n]: [Vec3; 2],
        time: f32,
        u: f32,
        place: Vec2,
        wavelengths: &Wavelengths,
        choice: LightChoice,
    ) -> Option<LightSample> {
        let (emitter, probability) = self.tree.choose(p, n, u, choice)?;
        let mut sample = lights.sample(self.list[emitter as usize], p, time, place, wavelengths);
        // In place: a copy of what was just written in parts would have to wait for it.
        if let Some(sample) = &mut sample {
            // The density of a light without extent is that of its choice.
            sample.pdf *= probability;
            sample.light = emitter;
        }
        sample
    }

    /// The glowing piece that is this part of an object, and its number.
    #[inline]
    pub fn area<'a>(&self, lights: &'a Lights, primitive: u32, part: u32) -> Option<(u32, &'a AreaLight)> {
        let place = |light: &AreaLight| (light.primitive, light.part);
        let i = lights.areas.binary_search_by_key(&(primitive, part), place).ok()?;
        Some((self.first_area + i as u32, &lights.areas[i]))
    }

    /// Density per solid angle with which [`Emitters::sample`] draws this place of a glowing piece.
    ///
    /// * `from`, `receiver`: point and unit normal of the receiver
    /// * `p`, `n`: the place and its unit geometric normal
    /// * `time`: moment within the shutter interval
    #[inline]
    pub fn area_pdf(
        &self,
        (number, light): (u32, &AreaLight),
        [from, receiver]: [Vec3; 2],
        [p, n]: [Vec3; 2],
        time: f32,
        choice: LightChoice,
    ) -> f32 {
        let probability = self.tree.probability(number, from, receiver, choice);
        if probability > 0.0 { probability * light.pdf(from, p, n, time) } else { 0.0 }
    }

    /// Probability with which [`Emitters::sample`] chooses a light for a receiver.
    ///
    /// * `from`, `receiver`: point and unit normal of the receiver
    #[inline]
    pub fn probability(&self, number: u32, [from, receiver]: [Vec3; 2], choice: LightChoice) -> f32 {
        self.tree.probability(number, from, receiver, choice)
    }

    /// Density per solid angle with which [`Emitters::sample`] draws the way to a place of a light that has been chosen;
    /// 1 for a light without extent.
    ///
    /// * `from`: the receiver and the moment within the shutter interval
    /// * `at`: the place and its unit geometric normal
    /// * `wi`: unit direction to it
    pub fn way_pdf(
        &self,
        lights: &Lights,
        number: u32,
        (from, time): (Vec3, f32),
        [p, n]: [Vec3; 2],
        wi: Vec3,
    ) -> f32 {
        let id = self.id(number);
        if let Some(area) = AreaLight::find(lights, id) {
            area.pdf(from, p, n, time)
        } else if let Some(sky) = SkyLight::find(lights, id) {
            sky.pdf(wi)
        } else {
            DirectionalLight::find(lights, id).map_or(1.0, |light| light.pdf(wi))
        }
    }

    /// Density per solid angle with which [`Emitters::sample`] draws this direction to the background.
    #[inline]
    pub fn sky_pdf(
        &self,
        lights: &Lights,
        [from, receiver]: [Vec3; 2],
        wi: Vec3,
        choice: LightChoice,
    ) -> f32 {
        let Some(number) = self.sky else { return 0.0 };
        let density: f32 = lights.skies.iter().map(|sky| sky.pdf(wi)).sum();
        density * self.tree.probability(number, from, receiver, choice)
    }
}
