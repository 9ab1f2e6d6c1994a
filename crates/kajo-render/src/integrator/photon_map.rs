//! Photons in a tree.
//!
//! A photon is power `Φ` that came to a point of a surface, or of a medium, from the direction `wi`. Its position takes
//! 12 bytes, the direction and the number of scatterings before 4, the normal and the axis of its node 2, four lanes of
//! power with one exponent 6. Lanes are rounded up or down by the number of the photon, in turn, so that sums of many
//! are not off by that.
//!
//! The tree is balanced and has no pointers [Jensen 2001, 5.1]: of a range of photons the middle one divides the rest along the
//! axis in which they spread the widest; ranges of a few are searched as they stand. All orders are total, by position and then
//! by content, so that the same photons make the same tree however many threads build it, and each search meets them in
//! the same order.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f32::consts::PI;
use std::thread;

use kajo_color::Spectrum;
use kajo_math::rng::unit;
use kajo_math::{Ray, Vec3};

/// Photons that are searched without a tree.
const LEAF: usize = 8;

/// Ranges that a search may have put off: one for each level.
const LEVELS: usize = 40;

/// Photons below which a range is built on the same thread.
const LARGE: usize = 1 << 15;

/// Scatterings that a photon counts; more are taken for so many.
const MOST_SCATTERINGS: u32 = 15;

/// Least cosine between the normal of a photon and that of the surface that it is to light.
const LEAST_COSINE: f32 = 0.8;

/// How far off the tangent disk a photon may lie, as a share of the largest radius.
const SLAB: f32 = 0.25;

/// Photons of which the distance to their neighbours is looked at.
const PROBES: usize = 256;

/// What is known of a photon when it comes to a surface.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// The point.
    pub p: Vec3,
    /// Unit geometric normal there, outward; in a medium any unit vector.
    pub n: Vec3,
    /// Unit direction that it came from.
    pub wi: Vec3,
    /// The power that it carries, over the number of paths; in a medium over the scattering per unit length, too.
    pub power: Spectrum,
    /// How often it was scattered before.
    pub scatterings: u32,
    /// Whether only one wavelength got here.
    pub secondary_terminated: bool,
}

/// A photon as it is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    p: [f32; 3],
    /// 14 bits for each coordinate of the direction, 4 for the scatterings.
    wi: u32,
    /// 7 bits for each coordinate of the normal, 2 for the axis.
    n: u16,
    /// From the lowest bit: four times 10 bits, 7 bits of the exponent, and whether only one wavelength counts.
    power: [u16; 3],
}

/// The number in [0, 1) by which the power of vertex `j` of path `i` is rounded: a golden sequence rounds those of many photons evenly.
pub fn dither(i: u32, j: u32) -> f32 {
    unit(i.wrapping_mul(0x9E37_79B9).wrapping_add(0x6180_3399u32.wrapping_mul(j)))
}

impl Photon {
    /// * `dither`: in [0, 1), by which the power is rounded
    pub fn new(arrival: &Arrival, dither: f32) -> Photon {
        let Arrival { p, n, wi, power, scatterings, secondary_terminated } = *arrival;
        let [x, y] = to_square(wi, 14);
        let [nx, ny] = to_square(n, 7);
        let bits = encode(power, dither) | u64::from(secondary_terminated) << 47;
        Photon {
            p: p.to_array(),
            wi: x | y << 14 | scatterings.min(MOST_SCATTERINGS) << 28,
            n: (nx | ny << 7) as u16,
            power: [bits as u16, (bits >> 16) as u16, (bits >> 32) as u16],
        }
    }

    /// The point that it came to.
    pub fn p(&self) -> Vec3 {
        self.p.into()
    }

    /// Unit direction that it came from.
    pub fn wi(&self) -> Vec3 {
        from_square([self.wi & 0x3FFF, self.wi >> 14 & 0x3FFF], 14)
    }

    /// Unit normal of the surface that it came to.
    pub fn n(&self) -> Vec3 {
        let n = u32::from(self.n);
        from_square([n & 0x7F, n >> 7 & 0x7F], 7)
    }

    /// Its power.
    pub fn power(&self) -> Spectrum {
        decode(self.bits())
    }

    /// Whether only one of its wavelengths counts.
    pub fn secondary_terminated(&self) -> bool {
        self.power[2] >> 15 == 1
    }

    /// Whether it was scattered at most so many times, as far as that was counted.
    pub fn is_within(&self, scatterings: u32) -> bool {
        scatterings >= MOST_SCATTERINGS || self.wi >> 28 <= scatterings
    }

    fn bits(&self) -> u64 {
        let [a, b, c] = self.power.map(u64::from);
        a | b << 16 | c << 32
    }

    fn axis(&self) -> usize {
        usize::from(self.n >> 14).min(2)
    }

    fn set_axis(&mut self, axis: usize) {
        self.n = self.n & 0x3FFF | (axis as u16) << 14;
    }

    /// A total order, by one coordinate before all else.
    fn order(&self, other: &Photon, axis: usize) -> Ordering {
        let content = |photon: &Photon| (photon.wi, photon.n & 0x3FFF, photon.power);
        let place = |axis: usize| self.p[axis].total_cmp(&other.p[axis]);
        place(axis)
            .then_with(|| place((axis + 1) % 3))
            .then_with(|| place((axis + 2) % 3))
            .then_with(|| content(self).cmp(&content(other)))
    }
}

/// What a map keeps: a photon, and perhaps more that is to be known of it.
pub trait Stored: Send {
    fn photon(&self) -> &Photon;
    fn photon_mut(&mut self) -> &mut Photon;
}

impl Stored for Photon {
    fn photon(&self) -> &Photon {
        self
    }

    fn photon_mut(&mut self) -> &mut Photon {
        self
    }
}

/// Bias of the exponent: powers from `2^-90` to `2^37` are kept.
const BIAS: i32 = 90;

fn encode(power: Spectrum, dither: f32) -> u64 {
    let lanes = [0, 1, 2, 3].map(|i| power[i]).map(|lane| if lane.is_finite() { lane.max(0.0) } else { 0.0 });
    let most = lanes.into_iter().fold(0.0, f32::max);
    // 2^exponent is above `most`, half of it is not.
    let exponent = (most.to_bits() >> 23) as i32 - 126;
    if exponent < 1 - BIAS {
        return 0;
    }
    let exponent = exponent.min(127 - BIAS);
    let scale = 1023.0 / power_of_two(exponent);
    let mantissas = lanes.map(|lane| (lane * scale + dither).min(1023.0) as u64);
    let [a, b, c, d] = mantissas;
    a | b << 10 | c << 20 | d << 30 | ((exponent + BIAS) as u64) << 40
}

fn decode(bits: u64) -> Spectrum {
    let scale = power_of_two((bits >> 40 & 0x7F) as i32 - BIAS) * (1.0 / 1023.0);
    Spectrum::from([0, 10, 20, 30].map(|shift| (bits >> shift & 0x3FF) as f32 * scale))
}

fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((exponent + 127) as u32) << 23)
}

/// A unit vector in the square of an octahedron unfolded [Meyer et al. 2010], in steps of so many bits.
fn to_square(w: Vec3, bits: u32) -> [u32; 2] {
    let sum = w.x.abs() + w.y.abs() + w.z.abs();
    let [x, y] = [w.x / sum, w.y / sum];
    let fold = |a: f32, b: f32| (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 };
    let place = if w.z < 0.0 { [fold(x, y), fold(y, x)] } else { [x, y] };
    let most = ((1u32 << bits) - 1) as f32;
    place.map(|a| ((0.5 * a + 0.5) * most + 0.5).clamp(0.0, most) as u32)
}

fn from_square(place: [u32; 2], bits: u32) -> Vec3 {
    let most = ((1u32 << bits) - 1) as f32;
    let [x, y] = place.map(|a| 2.0 * (a as f32 / most) - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let fold = |a: f32, b: f32| (1.0 - b.abs()) * if a < 0.0 { -1.0 } else { 1.0 };
    let [x, y] = if z < 0.0 { [fold(x, y), fold(y, x)] } else { [x, y] };
    Vec3::new(x, y, z).normalize()
}

/// Photons, to be found by position.
#[derive(Debug, Default)]
pub struct PhotonMap<P = Photon> {
    photons: Vec<P>,
    /// The square of the largest radius of a search for the nearest.
    most_r2: f32,
}

/// A position of a surface whose photons are wanted.
#[derive(Clone, Copy, Debug)]
pub struct GatherPoint {
    /// The point.
    pub p: Vec3,
    /// Unit geometric normal, outward.
    pub n: Vec3,
}

/// Scratch memory of a search for the nearest photons: squared distances, as bits, and photons.
pub type NearestScratch = Vec<(u32, u32)>;

impl PhotonMap {
    /// The same map for searches for the `k` nearest: they look as far as twice the distance of the `k`-th neighbour that half of
    /// the photons have.
    pub fn for_nearest(mut self, k: usize) -> PhotonMap {
        let mut scratch = NearestScratch::new();
        let step = (self.photons.len() / PROBES).max(1);
        let mut distances: Vec<u32> = Vec::new();
        for photon in self.photons.iter().step_by(step) {
            self.nearest_of(photon.p.into(), k + 1, f32::INFINITY, &mut scratch, |_| true);
            distances.extend(scratch.last().map(|&(d2, _)| d2));
        }
        distances.sort_unstable();
        let median = distances.get(distances.len() / 2).map_or(0.0, |&d2| f32::from_bits(d2));
        self.most_r2 = 4.0 * median;
        self
    }

    /// The largest radius of [`PhotonMap::nearest`].
    pub fn largest_radius(&self) -> f32 {
        self.most_r2.sqrt()
    }

    /// Hands over the `k` nearest photons of the surface, nearest first, those of equal distance in the order of the tree.
    ///
    /// Returns the factor of their sum that makes it a density per area. For `k` photons within `r_k`, the distance of the last of them,
    /// that is
    ///
    /// ```text
    /// (k - 1) / (k pi r_k^2)
    /// ```
    ///
    /// since `k / (pi r_k^2)` is too large by `k / (k - 1)` in the mean: the disk ends where a photon is. Where there are fewer within
    /// the largest radius, the disk has that radius, whatever is found.
    pub fn nearest(
        &self,
        point: &GatherPoint,
        k: usize,
        scratch: &mut NearestScratch,
        mut found: impl FnMut(&Photon),
    ) -> f32 {
        let r = self.largest_radius();
        self.nearest_of(point.p, k, self.most_r2, scratch, |photon| point.takes(photon, r));
        scratch.iter().for_each(|&(_, i)| found(&self.photons[i as usize]));
        let (share, r2) = self.reached(k, scratch);
        if r2 > 0.0 { share / (PI * r2) } else { 0.0 }
    }

    /// The same of photons in a medium: hands over the `k` nearest and returns the factor that makes a density per volume,
    ///
    /// ```text
    /// (k - 1) / (k 4/3 pi r_k^3)
    /// ```
    pub fn nearest_in_ball(
        &self,
        p: Vec3,
        k: usize,
        scratch: &mut NearestScratch,
        mut found: impl FnMut(&Photon),
    ) -> f32 {
        self.nearest_of(p, k, self.most_r2, scratch, |_| true);
        scratch.iter().for_each(|&(_, i)| found(&self.photons[i as usize]));
        let (share, r2) = self.reached(k, scratch);
        if r2 > 0.0 { share / (4.0 / 3.0 * PI * r2 * r2.sqrt()) } else { 0.0 }
    }

    /// The factor `(k - 1)/k` where all `k` were found, and the square of the radius that was searched.
    fn reached(&self, k: usize, scratch: &NearestScratch) -> (f32, f32) {
        match scratch.last() {
            Some(&(d2, _)) if scratch.len() == k => ((k - 1) as f32 / k as f32, f32::from_bits(d2)),
            _ => (1.0, self.most_r2),
        }
    }

    /// Fills `scratch` with the `k` nearest of some photons, nearest first.
    fn nearest_of(
        &self,
        p: Vec3,
        k: usize,
        most_r2: f32,
        scratch: &mut NearestScratch,
        is_meant: impl Fn(&Photon) -> bool,
    ) {
        scratch.clear();
        let mut heap = BinaryHeap::from(std::mem::take(scratch));
        self.search(p, most_r2, |i, d2, photon| {
            let bound = |heap: &BinaryHeap<(u32, u32)>| match heap.peek() {
                Some(&(farthest, _)) if heap.len() == k => f32::from_bits(farthest),
                _ => most_r2,
            };
            if d2 <= bound(&heap) && is_meant(photon) {
                heap.push((d2.to_bits(), i));
                if heap.len() > k {
                    heap.pop();
                }
            }
            bound(&heap)
        });
        *scratch = heap.into_sorted_vec();
    }
}

impl<P: Stored> PhotonMap<P> {
    /// Builds the tree.
    pub fn new(mut photons: Vec<P>, threads: usize) -> PhotonMap<P> {
        build(&mut photons, threads);
        PhotonMap { photons, most_r2: 0.0 }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    /// Hands over the photons of a tangent disk of radius `r`, in an order that depends on the tree and the position alone.
    pub fn within(&self, point: &GatherPoint, r: f32, mut found: impl FnMut(&P)) {
        let r2 = r * r;
        self.search(point.p, r2, |_, d2, photon| {
            if d2 <= r2 && point.takes(photon.photon(), r) {
                found(photon);
            }
            r2
        });
    }

    /// Hands over the photons of a ball of radius `r`, in an order that depends on the tree and the position alone.
    pub fn within_ball(&self, p: Vec3, r: f32, mut found: impl FnMut(&P)) {
        let r2 = r * r;
        self.search(p, r2, |_, d2, photon| {
            if d2 <= r2 {
                found(photon);
            }
            r2
        });
    }

    /// Hands over the photons of a cylinder of radius `r` around a ray, each with the parameter of the point of the ray that is nearest to
    /// it and the square of its distance from there, in an order that depends on the tree and the ray alone.
    ///
    /// * `ray`: of unit direction; as far as `t_max`
    pub fn along(&self, ray: &Ray, r: f32, mut found: impl FnMut(&P, f32, f32)) {
        let (o, d, r2) = (ray.o.to_array(), ray.d.to_array(), r * r);
        let mut look = |photon: &P| {
            let to = photon.photon().p() - ray.o;
            let t = to.dot(ray.d);
            let d2 = (to - t * ray.d).length_squared();
            if (ray.t_min..=ray.t_max).contains(&t) && d2 <= r2 {
                found(photon, t, d2);
            }
        };
        let mut put_off = [(0, 0, [0.0f32; 2]); LEVELS];
        let mut n = 1;
        put_off[0] = (0, self.photons.len(), [ray.t_min, ray.t_max]);
        while n > 0 {
            n -= 1;
            let (begin, mut end, mut range) = put_off[n];
            while end - begin > LEAF && range[0] <= range[1] {
                let middle = begin.midpoint(end);
                look(&self.photons[middle]);
                let node = self.photons[middle].photon();
                let axis = node.axis();
                let (lower, upper) = parts_of_range(range, o[axis] - node.p[axis], d[axis], r);
                put_off[n] = (middle + 1, end, upper);
                n += 1;
                (end, range) = (middle, lower);
            }
            if range[0] <= range[1] {
                (begin..end).for_each(|i| look(&self.photons[i]));
            }
        }
    }

    /// Looks at all photons that may be near, and at others.
    ///
    /// * `r2`: squared radius of the search
    /// * `visit`: given the number of a photon, its squared distance and the photon; answers how far is yet to be looked
    fn search(&self, p: Vec3, mut r2: f32, mut visit: impl FnMut(u32, f32, &P) -> f32) {
        let place = p.to_array();
        let mut put_off = [(0, 0, 0.0f32); LEVELS];
        let mut n = 1;
        put_off[0] = (0, self.photons.len(), 0.0);
        let mut look = |i: usize, r2: &mut f32| {
            let photon = &self.photons[i];
            *r2 = visit(i as u32, p.distance_squared(photon.photon().p.into()), photon);
        };
        while n > 0 {
            n -= 1;
            let (mut begin, mut end, d2) = put_off[n];
            if d2 > r2 {
                continue;
            }
            while end - begin > LEAF {
                let middle = begin.midpoint(end);
                look(middle, &mut r2);
                let node = self.photons[middle].photon();
                let ahead = place[node.axis()] - node.p[node.axis()];
                let (lower, upper) = ((begin, middle), (middle + 1, end));
                let (near, far) = if ahead < 0.0 { (lower, upper) } else { (upper, lower) };
                if ahead * ahead <= r2 {
                    put_off[n] = (far.0, far.1, ahead * ahead);
                    n += 1;
                }
                (begin, end) = near;
            }
            (begin..end).for_each(|i| look(i, &mut r2));
        }
    }
}

/// The parts of a range of parameters of a ray, in which points of the ray may be near photons on the lower side of a plane across an
/// axis, and near those on the upper side.
///
/// * `o`, `d`: start of the ray, from the plane on, and its direction, along the axis
/// * `r`: how near
fn parts_of_range([from, to]: [f32; 2], o: f32, d: f32, r: f32) -> ([f32; 2], [f32; 2]) {
    const NONE: [f32; 2] = [1.0, 0.0];
    if d == 0.0 {
        return (if o <= r { [from, to] } else { NONE }, if o >= -r { [from, to] } else { NONE });
    }
    // More than the roundings of positions.
    let r = r + 1e-6 * o.abs();
    let [lower_end, upper_end] = [(r - o) / d, (-r - o) / d];
    match d > 0.0 {
        true => ([from, to.min(lower_end)], [from.max(upper_end), to]),
        false => ([from.max(lower_end), to], [from, to.min(upper_end)]),
    }
}

impl GatherPoint {
    /// Whether a photon lies on the same surface, as far as one can tell: not off the tangent disk, and with a like normal.
    fn takes(&self, photon: &Photon, r: f32) -> bool {
        let off = self.n.dot(Vec3::from(photon.p) - self.p).abs();
        off <= SLAB * r && self.n.dot(photon.n()) >= LEAST_COSINE
    }
}

fn build<P: Stored>(photons: &mut [P], threads: usize) {
    if photons.len() <= LEAF {
        photons.sort_unstable_by(|a, b| a.photon().order(b.photon(), 0));
        return;
    }
    let axis = widest_axis(photons);
    let middle = photons.len() / 2;
    let (lower, node, upper) =
        photons.select_nth_unstable_by(middle, |a, b| a.photon().order(b.photon(), axis));
    node.photon_mut().set_axis(axis);
    if threads > 1 && lower.len() > LARGE {
        let (here, there) = (threads.div_ceil(2), threads / 2);
        thread::scope(|scope| {
            scope.spawn(|| build(upper, there));
            build(lower, here);
        });
    } else {
        build(lower, 1);
        build(upper, 1);
    }
}

fn widest_axis<P: Stored>(photons: &[P]) -> usize {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for photon in photons.iter().map(Stored::photon) {
        for axis in 0..3 {
            low[axis] = low[axis].min(photon.p[axis]);
            high[axis] = high[axis].max(photon.p[axis]);
        }
    }
    let width = |axis: usize| high[axis] - low[axis];
    if width(0) >= width(1) && width(0) >= width(2) {
        0
    } else if width(1) >= width(2) {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests;
