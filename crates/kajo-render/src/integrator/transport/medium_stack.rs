//! Which media a path is inside of.
//!
//! Where objects that light passes overlap, as glass and the liquid in it do, the medium of the highest priority is
//! there, and an interface inside a medium of higher priority than its own is not: light passes it as if it were nothing
//! [Schmidt and Budge 2002]. Of media of equal priority the one entered last is there, and where another one of them ends within it nothing
//! changes; or all of those that add: these are what bodies without a surface are filled with, and they add to the air too. They have no index
//! of refraction of their own, but that of what else is around.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::ObjectId;
use kajo_core::material::Interior;
use kajo_core::medium::{MaybeMedium, MediumId};
use kajo_core::scene::Scene;
use kajo_math::Ray;

/// Media that a stack has room for. Where more overlap, the one entered first is dropped.
const ROOM: usize = 4;

/// Media that may be in one place, the air among them.
pub const MOST_MEDIA: usize = ROOM + 1;

/// Bodies of a higher priority take the place of the air.
const PRIORITY_OF_AIR: i32 = 0;

/// What fills an object, as far as paths go by it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct MediumEntry {
    /// Absorption per unit length.
    sigma_a: Spectrum,
    /// Index of refraction.
    eta: f32,
    priority: i32,
    /// The object that it fills.
    object: ObjectId,
    /// What absorbs and scatters light by position.
    inside: MaybeMedium,
}

/// The media around a point of a path, in the order in which they were entered.
#[derive(Clone, Copy, Debug, Default)]
pub struct MediumStack {
    entries: [MediumEntry; ROOM],
    len: u32,
    /// What is outside of all.
    air: MaybeMedium,
    /// A bit for each of the entries, of those that add to what is there.
    adding: u8,
    /// Whether what is around the point is not that of the uppermost entry alone, or of the air alone.
    overlaps: bool,
}

/// Those of the entries that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct There {
    /// A bit for each.
    entries: u8,
    air: bool,
}

/// The surface between two media as a path comes to it.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// What is behind the surface.
    medium: MediumEntry,
    /// Index of refraction outside the surface.
    pub eta_outside: f32,
    /// Whether the path comes from outside.
    enters: bool,
    /// Whether what is behind the surface adds to what is there.
    adds: bool,
    /// Whether the surface is there at all, and not inside a medium of higher priority.
    pub is_real: bool,
    /// Whether refraction depends on the wavelength.
    pub is_dispersive: bool,
}

impl MediumStack {
    /// The air of a scene and nothing else.
    pub fn air(scene: &Scene) -> MediumStack {
        MediumStack { air: scene.lighting.air.into(), ..MediumStack::default() }
    }

    /// The media around the start of a ray: those of objects that it leaves more often than it enters them.
    pub fn around(scene: &Scene, ray: &Ray, wavelengths: &Wavelengths) -> MediumStack {
        // Parallel rays of a camera without a position come from infinitely far behind it.
        if !scene.geometry.transmits || ray.t_min < 0.0 {
            return MediumStack::air(scene);
        }
        let mut around = Surroundings { media: MediumStack::air(scene), ..Surroundings::default() };
        let mut last: Option<CrossedObject> = None;
        scene.crossings(ray, |object, hit| {
            let at = scene.interaction(ray, object, hit);
            let Some(interior) = scene.interior(&at, wavelengths, 0.5) else { return };
            // The crossings of an object come one after the other, so where another one begins the last is done.
            if let Some(done) = last.take_if(|last| last.medium.object != object) {
                around.add(&done);
            }
            let medium = MediumEntry::of(object, &interior, 1.0);
            let first = CrossedObject { medium, adds: interior.adds, exits: 0, farthest: 0.0 };
            let crossed = last.get_or_insert(first);
            crossed.exits += if ray.d.dot(at.point.ng) > 0.0 { 1 } else { -1 };
            crossed.farthest = crossed.farthest.max(hit.t);
        });
        if let Some(done) = last {
            around.add(&done);
        }
        around.finish()
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The share of light that is left after a distance around the point.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> Spectrum {
        match self.absorption() {
            Some(sigma_a) => (sigma_a * -distance.min(f32::MAX)).exp(),
            None => Spectrum::WHITE,
        }
    }

    /// Index of refraction around the point.
    pub fn eta(&self) -> f32 {
        self.top().map_or(1.0, |medium| medium.eta)
    }

    /// Whether light goes along segments that start at the point, so that it may be connected with others: not where light bends.
    #[inline]
    pub fn connects(&self, scene: &Scene) -> bool {
        scene.space().connects() || self.curved(scene).is_none()
    }

    /// Index of refraction around the point for a segment that starts there; `None` where it does not [connect](MediumStack::connects).
    #[inline]
    pub fn eta_of_segment(&self, scene: &Scene) -> Option<f32> {
        self.connects(scene).then(|| self.eta())
    }

    /// Absorption per unit length around the point, where there is any.
    #[inline]
    pub fn absorption(&self) -> Option<Spectrum> {
        self.top().map(|medium| medium.sigma_a).filter(|sigma_a| !sigma_a.is_black())
    }

    /// What absorbs and scatters light by position around the point, unless that are several.
    #[inline]
    pub fn medium(&self) -> Option<MediumId> {
        self.top().map_or(self.air, |medium| medium.inside).get()
    }

    /// Whether the point is in one medium whose colours walk ways of their own; see [`Coefficients::separates_colors`].
    pub fn separates_colors(&self, scene: &Scene) -> bool {
        let separates = |medium| scene.appearance.media.coefficients(medium).separates_colors();
        !self.overlaps() && self.medium().is_some_and(separates)
    }

    /// Whether several media may be around the point, which are then those of [`MediumStack::each_medium`].
    #[inline]
    pub fn overlaps(&self) -> bool {
        self.overlaps
    }

    /// All that absorbs and scatters light by position around the point.
    pub fn each_medium(&self) -> [MaybeMedium; MOST_MEDIA] {
        let there = self.there();
        let mut each = [MaybeMedium::VACUUM; MOST_MEDIA];
        for (i, medium) in self.media().iter().enumerate().filter(|&(i, _)| there.entries >> i & 1 == 1) {
            each[i] = medium.inside;
        }
        if there.air {
            each[ROOM] = self.air;
        }
        each
    }

    /// The object around the point, and what fills it, where that bends light.
    #[inline]
    pub fn curved(&self, scene: &Scene) -> Option<(MediumId, ObjectId)> {
        let top = self.top()?;
        let medium = top.inside.get()?;
        scene.appearance.media.bends_light(medium).then_some((medium, top.object))
    }

    /// Notes the index of refraction at a point that a path has come to in an object.
    pub fn set_eta(&mut self, object: ObjectId, eta: f32) {
        if let Some(i) = self.position(object) {
            self.entries[i].eta = eta;
        }
    }

    /// Drops the entry of an object.
    pub fn leave(&mut self, object: ObjectId) {
        if let Some(i) = self.position(object) {
            self.entries.copy_within(i + 1..self.len as usize, i);
            self.len -= 1;
            if self.adding != 0 {
                self.adding = without_bit(self.adding, i);
                self.sum_up();
            }
        }
    }

    /// How a path comes to the surface of `object`.
    ///
    /// * `enters`: whether it comes from outside
    pub fn interface(&self, object: ObjectId, interior: &Interior, enters: bool) -> Interface {
        let leaves = if enters { None } else { self.position(object) };
        let others = self.media().iter().enumerate().filter(|&(i, _)| Some(i) != leaves);
        let outside = uppermost(others.map(|(_, medium)| medium));
        let eta_outside = match outside {
            Some(_) if self.adding != 0 => self.solid_eta(leaves),
            outside => outside.map_or(1.0, |outside| outside.eta),
        };
        let is_uppermost = |outside: &MediumEntry| {
            outside.priority <= interior.priority && leaves.is_none_or(|i| !self.is_replaced(i))
        };
        Interface {
            medium: MediumEntry::of(object, interior, eta_outside),
            eta_outside,
            enters,
            adds: interior.adds,
            is_real: outside.is_none_or(is_uppermost),
            is_dispersive: interior.is_dispersive,
        }
    }

    /// Goes to the other side of an interface.
    pub fn cross(&mut self, interface: &Interface) {
        if interface.enters {
            self.push(interface.medium, interface.adds);
        } else {
            self.leave(interface.medium.object);
        }
    }

    /// The media on the other side of an interface.
    pub fn across(mut self, interface: &Interface) -> MediumStack {
        self.cross(interface);
        self
    }

    /// Whether a medium of the same priority was entered later, which took the place of an entry.
    fn is_replaced(&self, entry: usize) -> bool {
        let own = self.entries[entry].priority;
        let mut later = (entry + 1..self.len as usize).filter(|i| self.adding >> i & 1 == 0);
        later.any(|i| self.entries[i].priority == own)
    }

    /// Index of refraction of the uppermost medium that does not add, of all but one.
    fn solid_eta(&self, but: Option<usize>) -> f32 {
        let solid = (0..self.len as usize).filter(|&i| self.adding >> i & 1 == 0 && Some(i) != but);
        uppermost(solid.map(|i| &self.entries[i])).map_or(1.0, |medium| medium.eta)
    }

    fn media(&self) -> &[MediumEntry] {
        &self.entries[..self.len as usize]
    }

    /// What is around the point.
    #[inline]
    fn top(&self) -> Option<&MediumEntry> {
        if self.is_empty() { None } else { uppermost(self.media().iter()) }
    }

    fn push(&mut self, medium: MediumEntry, adds: bool) {
        if self.len as usize == ROOM {
            self.entries.copy_within(1.., 0);
            self.len -= 1;
            self.adding >>= 1;
        }
        self.entries[self.len as usize] = medium;
        self.adding |= u8::from(adds) << self.len;
        self.len += 1;
        if self.adding != 0 {
            self.sum_up();
        }
    }

    /// Which of the entries are there: each takes the place of those before it, or adds to them, unless one before it has a higher priority.
    fn there(&self) -> There {
        let mut there = There { entries: 0, air: true };
        let mut priority = None;
        for (i, medium) in self.media().iter().enumerate() {
            let own = medium.priority;
            if priority.is_some_and(|before| before > own) {
                continue;
            }
            let is_level = priority.map_or(own <= PRIORITY_OF_AIR, |before| before == own);
            if self.adding >> i & 1 == 1 && is_level {
                there.entries |= 1 << i;
            } else {
                there = There { entries: 1 << i, air: false };
            }
            priority = Some(own);
        }
        there
    }

    /// Works out what is around the point anew, where some of the entries add.
    #[cold]
    #[inline(never)]
    fn sum_up(&mut self) {
        let there = self.there();
        let (adding, len) = (self.adding, self.len as usize);
        let is_there = |i: &usize| there.entries >> i & 1 == 1;
        // Of all that is there at most one does not add. What adds has no absorption of its own, and hands on that one's.
        let solid = (0..len).find(|i| is_there(i) && adding >> i & 1 == 0);
        let sigma_a = solid.map_or(Spectrum::BLACK, |i| self.entries[i].sigma_a);
        for i in (0..len).filter(is_there) {
            self.entries[i].sigma_a = sigma_a;
        }
        let eta = self.solid_eta(None);
        for i in (0..len).filter(|i| adding >> i & 1 == 1) {
            self.entries[i].eta = eta;
        }
        let top = self.top().map_or(self.air, |medium| medium.inside);
        let filled = self.each_medium().into_iter().filter(|&medium| medium != MaybeMedium::VACUUM);
        self.overlaps = !filled.eq((top != MaybeMedium::VACUUM).then_some(top));
    }

    /// Where an object was entered last.
    fn position(&self, object: ObjectId) -> Option<usize> {
        self.media().iter().rposition(|medium| medium.object == object)
    }
}

impl MediumEntry {
    /// * `eta_around`: index of refraction of what is around it
    fn of(object: ObjectId, interior: &Interior, eta_around: f32) -> MediumEntry {
        let &Interior { eta, absorption, priority, medium, .. } = interior;
        MediumEntry {
            sigma_a: absorption,
            eta: eta.unwrap_or(eta_around),
            priority,
            object,
            inside: medium.into(),
        }
    }
}

/// An object that a ray crosses.
#[derive(Clone, Copy)]
struct CrossedObject {
    medium: MediumEntry,
    adds: bool,
    /// Ways out less ways in.
    exits: i32,
    /// Parameter of the last crossing.
    farthest: f32,
}

/// The media around the start of a ray, while objects that it crosses are looked at in any order.
#[derive(Default)]
struct Surroundings {
    media: MediumStack,
    /// Where the ray leaves each of them for the last time, farthest first.
    ends: [f32; ROOM],
    /// Whether each of them adds to what is there.
    adds: [bool; ROOM],
}

impl Surroundings {
    /// Looks at an object, all of whose crossings are known.
    fn add(&mut self, crossed: &CrossedObject) {
        if crossed.exits <= 0 {
            return;
        }
        let MediumStack { entries, len, .. } = &mut self.media;
        let known = *len as usize;
        // The one that ends last was entered first.
        let place = self.ends[..known].partition_point(|&end| end >= crossed.farthest);
        let place = if known < ROOM {
            entries.copy_within(place..known, place + 1);
            self.ends.copy_within(place..known, place + 1);
            self.adds.copy_within(place..known, place + 1);
            *len += 1;
            place
        } else if place > 0 {
            entries.copy_within(1..place, 0);
            self.ends.copy_within(1..place, 0);
            self.adds.copy_within(1..place, 0);
            place - 1
        } else {
            return;
        };
        (entries[place], self.ends[place]) = (crossed.medium, crossed.farthest);
        self.adds[place] = crossed.adds;
    }

    /// The media, when all objects have been looked at.
    fn finish(self) -> MediumStack {
        let Surroundings { mut media, adds, .. } = self;
        let known = adds.iter().take(media.len as usize).enumerate();
        media.adding = known.fold(0, |bits, (i, &adds)| bits | u8::from(adds) << i);
        if media.adding != 0 {
            media.sum_up();
        }
        media
    }
}

/// Bits with one of them taken out, and those above it moved down.
fn without_bit(bits: u8, i: usize) -> u8 {
    let below = (1 << i) - 1;
    (bits & below) | (bits >> 1 & !below)
}

/// The medium that is there, of those of some objects in the order in which they were entered.
fn uppermost<'a>(media: impl Iterator<Item = &'a MediumEntry>) -> Option<&'a MediumEntry> {
    media.fold(None, |top: Option<&MediumEntry>, medium| match top {
        Some(top) if top.priority > medium.priority => Some(top),
        _ => Some(medium),
    })
}

#[cfg(test)]
mod tests {
    use kajo_math::Vec3;
    use kajo_scene::MemoryAssets;

    use super::*;
    use crate::integrator::tests::scene_with;

    fn interior(eta: f32, priority: i32) -> Interior {
        Interior {
            eta: Some(eta),
            is_dispersive: false,
            absorption: Spectrum::grey(eta),
            priority,
            medium: None,
            adds: false,
        }
    }

    /// What an `Interface` is filled with, by the number of a medium.
    fn haze(medium: usize, priority: i32) -> Interior {
        let medium = Some(numbered()[medium]);
        Interior { eta: None, absorption: Spectrum::BLACK, medium, adds: true, ..interior(1.0, priority) }
    }

    /// Names of ten media.
    fn numbered() -> Vec<MediumId> {
        let media: String = (0..10).map(|i| format!("Medium m{i} {{ density 1 }} ")).collect();
        let camera = "PerspectiveCamera { center 0 0 0 direction 0 0 -1 up 0 1 0 angle 30 }";
        let scene = scene_with(&format!("{camera} Media {{ {media} }}"), &MemoryAssets::new());
        scene.appearance.media.ids().collect()
    }

    /// Enters objects with these insides one after the other, which are numbered from 0.
    fn inside_of(air: MaybeMedium, insides: &[Interior]) -> MediumStack {
        let mut media = MediumStack { air, ..MediumStack::default() };
        for (i, inside) in insides.iter().enumerate() {
            let object = ObjectId::from_index(i as u32);
            media.cross(&media.interface(object, inside, true));
        }
        media
    }

    /// The media around, in the order of their numbers.
    fn around(media: &MediumStack) -> Vec<usize> {
        let known = numbered();
        let number = |medium: MediumId| known.iter().position(|&other| other == medium);
        let each = media.each_medium().into_iter().filter_map(MaybeMedium::get);
        let mut numbers: Vec<usize> = each.filter_map(number).collect();
        numbers.sort_unstable();
        let alone: Vec<usize> = media.medium().and_then(number).into_iter().collect();
        assert_eq!(media.overlaps(), numbers != alone);
        numbers
    }

    #[test]
    fn a_liquid_that_overlaps_its_glass_shares_one_surface() {
        let (glass, water) = (interior(1.5, 2), interior(1.33, 1));
        let air = MediumStack::default();
        assert!(air.absorption().is_none());
        let outer = air.interface(ObjectId::from_index(1), &glass, true);
        assert!(outer.is_real && outer.eta_outside == 1.0);
        let in_glass = air.across(&outer);
        // The water begins inside the glass: nothing is seen of that.
        let hidden = in_glass.interface(ObjectId::from_index(2), &water, true);
        assert!(!hidden.is_real);
        let both = in_glass.across(&hidden);
        assert_eq!(both.absorption(), Some(glass.absorption));
        // The inner side of the glass is where glass meets water.
        let inner = both.interface(ObjectId::from_index(1), &glass, false);
        assert!(inner.is_real && inner.eta_outside == 1.33);
        let in_water = both.across(&inner);
        assert_eq!(in_water.absorption(), Some(water.absorption));
        let out = in_water.interface(ObjectId::from_index(2), &water, false);
        assert!(out.is_real && out.eta_outside == 1.0);
        assert!(in_water.across(&out).absorption().is_none());
    }

    /// What ends within a medium of its own priority that was entered later has no surface there.
    #[test]
    fn of_equal_media_the_one_entered_last_is_there() {
        let (glass, water) = (interior(1.5, 0), interior(1.33, 0));
        let [first, second] = [0, 1].map(ObjectId::from_index);
        let both = inside_of(MaybeMedium::VACUUM, &[glass, water]);
        assert_eq!(both.eta(), 1.33);
        let end = both.interface(first, &glass, false);
        assert!(!end.is_real);
        let in_water = both.across(&end);
        assert_eq!((in_water.eta(), in_water.absorption()), (1.33, Some(water.absorption)));
        let out = in_water.interface(second, &water, false);
        assert!(out.is_real && out.eta_outside == 1.0);
        // The one entered last ends at the other one.
        let end = both.interface(second, &water, false);
        assert!(end.is_real && end.eta_outside == 1.5);
        assert_eq!(both.across(&end).eta(), 1.5);
        // What adds takes no place.
        let hazy = inside_of(MaybeMedium::VACUUM, &[glass, haze(1, 0)]);
        assert!(hazy.interface(first, &glass, false).is_real);
    }

    /// Haze that begins in glass has the index of glass there, and that of the air behind it, whatever its priority.
    #[test]
    fn what_adds_has_the_index_of_what_it_is_in() {
        let [first, second, third] = [0, 1, 2].map(ObjectId::from_index);
        for priority in [-1, 0] {
            let hazy = inside_of(MaybeMedium::VACUUM, &[interior(1.5, 0), haze(1, priority)]);
            assert_eq!(hazy.eta(), 1.5);
            let end = hazy.interface(first, &interior(1.5, 0), false);
            assert!(end.is_real && end.eta_outside == 1.0, "{priority}: {}", end.eta_outside);
            let behind = hazy.across(&end);
            assert_eq!(
                (behind.eta(), behind.interface(second, &haze(1, priority), false).eta_outside),
                (1.0, 1.0)
            );
        }
        // Water around glass, with haze that begins in both.
        let (water, glass) = (interior(1.33, 0), interior(1.5, 1));
        let all = inside_of(MaybeMedium::VACUUM, &[water, glass, haze(1, 0)]);
        assert_eq!(all.eta(), 1.5);
        let out = all.interface(second, &glass, false);
        assert!(out.is_real && out.eta_outside == 1.33);
        let in_water = all.across(&out);
        assert_eq!((in_water.eta(), around(&in_water)), (1.33, vec![1]));
        let out = in_water.interface(first, &water, false);
        assert!(out.is_real && out.eta_outside == 1.0);
        assert_eq!(in_water.across(&out).interface(third, &haze(1, 0), false).eta_outside, 1.0);
    }

    /// Media of equal priority add whatever their order is, and to the air; one of a higher priority takes their place.
    #[test]
    fn media_without_a_surface_add() {
        let air = MaybeMedium::from(Some(numbered()[9]));
        let [a, b] = [haze(1, 0), haze(2, 0)];
        let cavity = Interior { medium: None, ..haze(0, 1) };
        let nothing = Interior { medium: None, ..haze(0, 0) };
        for (insides, expected) in [
            (vec![], vec![9]),
            (vec![a], vec![1, 9]),
            (vec![a, b], vec![1, 2, 9]),
            (vec![b, a, a], vec![1, 1, 2, 9]),
            (vec![nothing], vec![9]),
            (vec![cavity], vec![]),
            (vec![a, cavity], vec![]),
            (vec![cavity, a], vec![]),
            (vec![cavity, haze(3, 1), b], vec![3]),
            (vec![haze(3, 1)], vec![3]),
            (vec![haze(3, -1)], vec![3, 9]),
            (vec![a, interior(1.5, 0)], vec![]),
            (vec![interior(1.5, 0), a], vec![1]),
            (vec![a, interior(1.5, 0), b], vec![2]),
            (vec![interior(1.5, 1), a], vec![]),
        ] {
            let media = inside_of(air, &insides);
            assert_eq!(around(&media), expected, "{insides:?}");
        }
        assert_eq!(around(&inside_of(MaybeMedium::VACUUM, &[a])), [1]);
        assert!(!inside_of(MaybeMedium::VACUUM, &[a]).overlaps());
    }

    /// Objects may be left in any order, and what is left of the others goes on.
    #[test]
    fn media_that_add_are_left_in_any_order() {
        let glass = interior(1.5, 0);
        let insides = [glass, haze(1, 0), haze(2, 0)];
        let media = inside_of(MaybeMedium::VACUUM, &insides);
        assert_eq!((around(&media), media.absorption()), (vec![1, 2], Some(glass.absorption)));
        let leave = |mut media: MediumStack, i: u32| {
            media.leave(ObjectId::from_index(i));
            media
        };
        let without_glass = leave(media, 0);
        assert_eq!((around(&without_glass), without_glass.absorption()), (vec![1, 2], None));
        let without_one = leave(media, 1);
        assert_eq!((around(&without_one), without_one.absorption()), (vec![2], Some(glass.absorption)));
        let glass_alone = leave(without_one, 2);
        assert_eq!((around(&glass_alone), glass_alone.absorption()), (vec![], Some(glass.absorption)));
        assert!(!glass_alone.overlaps());
    }

    #[test]
    fn leaving_what_was_never_entered_is_leaving() {
        let inside = MediumStack::default().interface(ObjectId::from_index(7), &interior(1.5, 0), false);
        assert!(inside.is_real && inside.eta_outside == 1.0);
        assert!(MediumStack::default().across(&inside).absorption().is_none());
    }

    #[test]
    fn too_many_media_forget_the_outermost() {
        let mut media = MediumStack::default();
        for i in 0..20 {
            media.cross(&media.interface(ObjectId::from_index(i), &interior(1.0 + i as f32, 0), true));
        }
        assert_eq!(media.absorption(), Some(Spectrum::grey(20.0)));
        assert!(media.interface(ObjectId::from_index(19), &interior(20.0, 0), false).eta_outside == 19.0);
        // As many as there is room for are known.
        for i in (0..20).rev() {
            let known = i + ROOM as u32 >= 20;
            assert_eq!(media.eta(), if known { 1.0 + i as f32 } else { 1.0 }, "{i}");
            media.cross(&media.interface(ObjectId::from_index(i), &interior(1.0 + i as f32, 0), false));
        }
    }

    /// What lies ahead of a ray does not crowd out what is around its start.
    #[test]
    fn a_ray_that_starts_in_water_knows_it_behind_many_balls() {
        let balls: String = (1..=100).map(|i| format!("Sphere {{ center 0 0 -{i} radius 0.4 }} ")).collect();
        let text = format!(
            "PerspectiveCamera {{ center 0 0 0 direction 0 0 -1 up 0 1 0 angle 30 }}
             Materials {{ Glass water {{ indexOfRefraction 1.33 }}  Glass ball {{ }} }}
             Group {{ MaterialIndex ball {balls} MaterialIndex water Box {{ min -9 -9 -199 max 9 9 1 }} }}"
        );
        let scene = scene_with(&text, &MemoryAssets::new());
        let around =
            |z: f32| MediumStack::around(&scene, &Ray::new(z * Vec3::Z, -Vec3::Z), &Wavelengths::RGB);
        assert_eq!([around(0.0).eta(), around(-1.0).eta(), around(2.0).eta()], [1.33, 1.5, 1.0]);
    }

    /// Whatever the order of the file, the media are those in the order of their ends.
    #[test]
    fn of_many_media_around_a_start_the_innermost_are_known() {
        for sizes in [[1, 2, 3, 4, 5, 6, 7], [7, 6, 5, 4, 3, 2, 1], [4, 7, 1, 6, 2, 5, 3]] {
            let materials: String =
                sizes.map(|i| format!("Glass g{i} {{ indexOfRefraction 1.{i} }} ")).concat();
            let balls: String =
                sizes.map(|i| format!("MaterialIndex g{i} Sphere {{ center 0 0 0 radius {i} }} ")).concat();
            let text = format!(
                "PerspectiveCamera {{ center 0 0 0 direction 0 0 -1 up 0 1 0 angle 30 }}
                 Materials {{ {materials} }} Group {{ {balls} }}"
            );
            let scene = scene_with(&text, &MemoryAssets::new());
            let ray = Ray::new(Vec3::ZERO, -Vec3::Z);
            let media = MediumStack::around(&scene, &ray, &Wavelengths::RGB);
            let etas: Vec<_> = media.media().iter().map(|medium| medium.eta).collect();
            assert_eq!(etas, [1.4, 1.3, 1.2, 1.1], "{sizes:?}");
        }
    }

    #[test]
    fn a_stack_is_small() {
        assert_eq!(size_of::<MediumStack>(), 144);
        assert_eq!(size_of::<Interface>(), 48);
    }
}
