//! The choice of a light for a receiver, and the list of all that can be chosen.

use kajo_color::Wavelengths;
use kajo_math::Vec3;

use super::infinite::{ALIKE, InfiniteLights};
use super::segment::{AngularSpan, RaySegment};
use super::tree::FirstStep;
use super::visibility::{LightPart, Mixture};
use super::{
    AreaLight, Emitter, LightDraw, LightHit, LightId, LightSelection, LightTree, LightVisibility, Lights,
    Receiver, SampledLight,
};
use crate::differential::SkyFootprint;
use crate::ids::{LightGroup, LightIndex, ObjectId};

/// The lights of a scene, in one list: those of the file, then the patches of emissive objects, then the background.
#[derive(Debug, Default)]
pub struct LightSampler {
    list: Vec<LightId>,
    /// The group of each.
    groups: Vec<LightGroup>,
    /// Where the emissive patches begin; they are sorted by object and part.
    first_area: usize,
    /// Those that rays hit when they leave the scene, the background first.
    at_infinity: Vec<LightIndex>,
    tree: LightTree,
    infinite: InfiniteLights,
    /// All that can be chosen, those infinitely far away first.
    choosable: Vec<LightIndex>,
    /// Whether each is in another frame, where others choose it; empty where all are in this one.
    elsewhere: Vec<bool>,
}

impl LightSampler {
    /// * `first_area`: where the emissive patches begin; from there on `list` names their pool in its order
    /// * `background`: where the background is, if it gives light
    pub(crate) fn new(
        list: Vec<(LightId, LightGroup)>,
        first_area: usize,
        background: Option<LightIndex>,
        lights: &Lights,
    ) -> LightSampler {
        LightSampler::of_frame(list, first_area, background, lights, &[])
    }

    /// The same, which chooses among those that rest in one frame and knows all.
    ///
    /// * `elsewhere`: whether each rests in another frame; empty where all rest in this one
    pub(crate) fn of_frame(
        list: Vec<(LightId, LightGroup)>,
        first_area: usize,
        background: Option<LightIndex>,
        lights: &Lights,
        elsewhere: &[bool],
    ) -> LightSampler {
        let is_here = |light: LightIndex| !elsewhere.get(light.index()).is_some_and(|&elsewhere| elsewhere);
        let (list, groups): (Vec<LightId>, Vec<LightGroup>) = list.into_iter().unzip();
        let mut bounds: Vec<_> = list.iter().map(|&id| lights.bounds(id)).collect();
        let others = LightIndex::all(list.len()).filter(|&light| Some(light) != background);
        let hit = background.into_iter().chain(others).filter(|&light| is_here(light));
        let at_infinity = hit.filter(|light| lights.is_seen_at_infinity(list[light.index()])).collect();
        let all = || LightIndex::all(list.len()).filter(|&light| is_here(light));
        bounds
            .iter_mut()
            .zip(elsewhere)
            .for_each(|(bounds, &elsewhere)| *bounds = bounds.take().filter(|_| !elsewhere));
        let tree = LightTree::build(&bounds);
        let is_infinite = |light: &LightIndex| bounds[light.index()].is_none();
        let irradiances =
            all().filter(is_infinite).map(|light| (light, lights.irradiance(list[light.index()])));
        let unevenness = background.map_or(1.0, |light| lights.unevenness(list[light.index()]));
        let infinite = InfiniteLights::new(irradiances, background, unevenness);
        let choosable = all().filter(is_infinite).chain(all().filter(|&light| tree.has(light))).collect();
        let elsewhere = elsewhere.to_vec();
        LightSampler { list, groups, first_area, at_infinity, tree, infinite, choosable, elsewhere }
    }

    /// Whether a light rests in the frame that this chooses for.
    pub(crate) fn is_here(&self, light: LightIndex) -> bool {
        !self.elsewhere.get(light.index()).is_some_and(|&elsewhere| elsewhere)
    }

    /// Number of lights that can be chosen.
    pub fn len(&self) -> usize {
        self.choosable.len()
    }

    /// Whether nothing gives light.
    pub fn is_empty(&self) -> bool {
        self.choosable.is_empty()
    }

    /// Whether any is infinitely far away.
    pub(crate) fn has_infinite(&self) -> bool {
        self.choosable.first().is_some_and(|&light| !self.tree.has(light))
    }

    /// Whether any has a position.
    pub fn has_finite(&self) -> bool {
        !self.tree.is_empty()
    }

    /// All lights by their indices.
    pub fn list(&self) -> &[LightId] {
        &self.list
    }

    /// The light at an index.
    #[inline]
    pub fn id(&self, light: LightIndex) -> LightId {
        self.list[light.index()]
    }

    /// The group of a light.
    #[inline]
    pub fn group(&self, light: LightIndex) -> LightGroup {
        self.groups[light.index()]
    }

    /// The lights of the file, and patches that stand for all of each emissive object, with the factor of their light.
    ///
    /// * `most`: patches of an object; of one that has more so many are taken by systematic sampling: the running sum
    ///   of powers is cut into equal parts, and the patch at the middle of each stands for all of it, with the factor
    ///   that makes the sum of its power that of the part
    pub fn representatives(&self, lights: &Lights, most: usize) -> Vec<(LightId, f32)> {
        let here = |i: usize| LightIndex::new(i).is_some_and(|light| self.is_here(light));
        let listed = self.list[..self.first_area].iter().enumerate().filter(|&(i, _)| here(i));
        let mut taken: Vec<_> = listed.map(|(_, &id)| (id, 1.0)).collect();
        let mut patches = self.list[self.first_area..].iter().copied();
        let mut next = self.first_area;
        for object in lights.areas.chunk_by(|a, b| a.object == b.object) {
            let ids = patches.by_ref().take(object.len());
            let first = next;
            next += object.len();
            if !here(first) {
                ids.for_each(drop);
                continue;
            }
            if object.len() <= most {
                taken.extend(ids.map(|id| (id, 1.0)));
                continue;
            }
            let power = |light: &AreaLight| light.bounds().map_or(0.0, |bounds| f64::from(bounds.power));
            let share = object.iter().map(power).sum::<f64>() / most as f64;
            let (mut sum, mut parts_before) = (0.0, 0.0);
            for (id, light) in ids.zip(object) {
                sum += power(light);
                // The middles of equal parts that lie on this patch.
                let parts = (sum / share + 0.5).floor();
                if parts > parts_before {
                    taken.push((id, ((parts - parts_before) * share / power(light)) as f32));
                    parts_before = parts;
                }
            }
        }
        taken
    }

    /// Bytes of the tree and the lists.
    pub fn bytes(&self) -> usize {
        let lists = size_of_val(&*self.list) + size_of_val(&*self.groups) + size_of_val(&*self.at_infinity);
        self.tree.bytes() + self.infinite.bytes() + lists + size_of_val(&*self.choosable)
    }

    /// Chooses a light for a receiver; `None` when none can reach it.
    ///
    /// * `u`: uniform in [0, 1)
    #[inline]
    pub fn sample<'a>(
        &self,
        to: &Receiver,
        u: f32,
        by: impl Into<LightSelection<'a>>,
    ) -> Option<SampledLight> {
        if let [only] = *self.choosable {
            return Some(SampledLight::new(only, 1.0, u));
        }
        let by = by.into();
        let factors = self.factors(by);
        match by {
            LightSelection::Tree | LightSelection::TreeAlone => {}
            LightSelection::Uniform => return self.sample_uniform(u),
            LightSelection::Learned(visibility) | LightSelection::LearnedAlone(visibility) => {
                return self.sample_learned(to, u, visibility, factors);
            }
        }
        let step = self.tree.first_step(to);
        let share = self.infinite.share_of_tree(&step, factors);
        if u < share {
            let chosen = self.tree.sample(to, &step, u / share)?;
            return Some(SampledLight { probability: share * chosen.probability, ..chosen });
        }
        let chosen = self.infinite.sample((u - share) / (1.0 - share), factors)?;
        Some(SampledLight { probability: (1.0 - share) * chosen.probability, ..chosen })
    }

    /// Probability with which [`LightSampler::sample`] chooses a light for a receiver.
    #[inline]
    pub fn pmf<'a>(&self, light: LightIndex, to: &Receiver, by: impl Into<LightSelection<'a>>) -> f32 {
        if let [only] = *self.choosable {
            return if only == light { 1.0 } else { 0.0 };
        }
        let in_tree = self.tree.has(light);
        let by = by.into();
        let factors = self.factors(by);
        match by {
            LightSelection::Tree | LightSelection::TreeAlone => {}
            LightSelection::Uniform => {
                let can_be_chosen = in_tree || self.infinite.pmf(light, ALIKE) > 0.0;
                return if can_be_chosen { self.pmf_uniform() } else { 0.0 };
            }
            LightSelection::Learned(visibility) | LightSelection::LearnedAlone(visibility) => {
                return self.pmf_learned(light, to, visibility, factors);
            }
        }
        let step = self.tree.first_step(to);
        let share = self.infinite.share_of_tree(&step, factors);
        if in_tree {
            share * self.tree.pmf(light, to, &step)
        } else {
            (1.0 - share) * self.infinite.pmf(light, factors)
        }
    }

    /// Chooses a light that has a position for a piece of a ray; `None` when none can reach it.
    ///
    /// * `u`: uniform in [0, 1)
    pub fn sample_along<'a>(
        &self,
        segment: &RaySegment,
        u: f32,
        by: impl Into<LightSelection<'a>>,
    ) -> Option<SampledLight> {
        if let [only] = *self.choosable {
            return Some(SampledLight::new(only, 1.0, u));
        }
        match by.into() {
            LightSelection::Tree | LightSelection::TreeAlone => {
                self.tree.sample(segment, &self.tree.first_step(segment), u)
            }
            LightSelection::Uniform => self.sample_uniform(u),
            LightSelection::Learned(visibility) | LightSelection::LearnedAlone(visibility) => {
                let known = visibility.region(segment.middle());
                let step = self.tree.first_step(segment);
                self.tree.sample_learned(segment, &step, u, &known, Mixture::START)
            }
        }
    }

    /// Probability with which [`LightSampler::sample_along`] chooses a light that has a position.
    pub fn pmf_along<'a>(
        &self,
        light: LightIndex,
        segment: &RaySegment,
        by: impl Into<LightSelection<'a>>,
    ) -> f32 {
        if let [only] = *self.choosable {
            return if only == light { 1.0 } else { 0.0 };
        }
        match by.into() {
            LightSelection::Tree | LightSelection::TreeAlone => {
                self.tree.pmf(light, segment, &self.tree.first_step(segment))
            }
            LightSelection::Uniform => self.pmf_uniform(),
            LightSelection::Learned(visibility) | LightSelection::LearnedAlone(visibility) => {
                let known = visibility.region(segment.middle());
                let step = self.tree.first_step(segment);
                self.tree.pmf_learned(light, segment, &step, &known, Mixture::START)
            }
        }
    }

    /// The angle under which a light sees a piece of a ray, of the part that its light can reach; `None` where there is none, and for a light
    /// infinitely far away.
    pub fn seen_from(&self, light: LightIndex, segment: &RaySegment) -> Option<AngularSpan> {
        self.tree.seen_from(light, segment)
    }

    fn sample_uniform(&self, u: f32) -> Option<SampledLight> {
        let n = self.len();
        let scaled = u * n as f32;
        let i = (scaled as usize).min(n.checked_sub(1)?);
        Some(SampledLight::new(self.choosable[i], self.pmf_uniform(), scaled - i as f32))
    }

    /// Of a light that can be chosen.
    fn pmf_uniform(&self) -> f32 {
        1.0 / self.len() as f32
    }

    /// Factors of the weights of the background, of directional lights and of the tree.
    #[inline]
    fn factors(&self, by: LightSelection<'_>) -> [f32; 3] {
        if by.is_beside_scattering() { self.infinite.beside_scattering() } else { ALIKE }
    }

    fn sample_learned(
        &self,
        to: &Receiver,
        u: f32,
        visibility: &LightVisibility,
        factors: [f32; 3],
    ) -> Option<SampledLight> {
        let (known, step) = (visibility.region(to.p), self.tree.first_step(to));
        let factors = [factors, [0, 1, 2].map(|i| factors[i] * known.parts[i])];
        let (in_tree, mixture, u) = Mixture::START.step(self.shares_of_tree(&step, factors), u);
        if in_tree {
            self.tree.sample_learned(to, &step, u, &known, mixture)
        } else {
            self.infinite.sample_learned(u, factors, mixture)
        }
    }

    fn pmf_learned(
        &self,
        light: LightIndex,
        to: &Receiver,
        visibility: &LightVisibility,
        factors: [f32; 3],
    ) -> f32 {
        let (known, step) = (visibility.region(to.p), self.tree.first_step(to));
        let factors = [factors, [0, 1, 2].map(|i| factors[i] * known.parts[i])];
        let shares = self.shares_of_tree(&step, factors);
        if self.tree.has(light) {
            self.tree.pmf_learned(light, to, &step, &known, Mixture::START.after(shares))
        } else {
            let mixture = Mixture::START.after(shares.map(|share| 1.0 - share));
            self.infinite.pmf_learned(light, factors, mixture)
        }
    }

    /// The probability that a light has a position, by importance and by what is known to arrive too.
    ///
    /// * `factors`: for both
    fn shares_of_tree(&self, step: &FirstStep, factors: [[f32; 3]; 2]) -> [f32; 2] {
        factors.map(|factors| self.infinite.share_of_tree(step, factors))
    }

    /// A table of what arrives, of draws by [`LightSampler::sample`].
    pub fn learn(&self, draws: Vec<LightDraw>) -> LightVisibility {
        LightVisibility::learn(draws, |light| match self.tree.trail(light) {
            Some(trail) => LightPart::InTree { trail },
            None if self.infinite.is_background(light) => LightPart::Background,
            None => LightPart::Directional,
        })
    }

    /// The patch of a part of an emissive object.
    #[inline]
    pub fn area<'a>(
        &self,
        lights: &'a Lights,
        object: ObjectId,
        part: u32,
    ) -> Option<(LightIndex, &'a AreaLight)> {
        let key = |light: &AreaLight| (light.object, light.part);
        let i = lights.areas.binary_search_by_key(&(object, part), key).ok()?;
        Some((LightIndex::new(self.first_area + i)?, &lights.areas[i]))
    }

    /// The lights that a ray along the unit vector `d` hits when it leaves the scene, the background first.
    #[inline]
    pub fn at_infinity<'a>(
        &'a self,
        lights: &'a Lights,
        d: Vec3,
        footprint: &'a SkyFootprint,
        wavelengths: &'a Wavelengths,
    ) -> impl Iterator<Item = LightHit> {
        self.at_infinity.iter().filter_map(move |&light| {
            let radiance = lights.radiance_at_infinity(self.id(light), d, footprint, wavelengths)?;
            Some(LightHit { light, group: self.group(light), radiance })
        })
    }
}
