//! Photon beams: the whole rays of paths from lights through homogeneous media, in a tree [Jarosz et al. 2011].
//!
//! A photon stands at one collision; a beam stands for all that its ray might have had, each as likely as light gets there. It
//! carries the power `Φ` of the path at its start, over the number of paths, which the medium weakens on the way.
//!
//! Beams are cut into spans whose boxes, widened by the radii of searches there, are in the tree of a bounding volume hierarchy. So that these are
//! known, they depend on the point that is looked at: a few pixels, as large as these are at that distance from the camera.

use kajo_bvh::{BuildSettings, Bvh};
use kajo_color::Spectrum;
use kajo_math::{Aabb, Ray, Vec3};

use super::RadiusOfPass;
use crate::integrator::camera_view::RayFootprint;

/// Spans for each search: as many as take about as long to build a tree of as they spare a search.
const SPANS_PER_SEARCH: f32 = 8.0;

/// Spans within the scene at most, about: some 40 MB.
const MOST_SPANS: f32 = (1 << 19) as f32;

/// Length of a span, in radii of a search: boxes of shorter ones are not much smaller.
const SPAN: f32 = 8.0;

/// A ray of a path from a light through a homogeneous medium, to the next surface.
#[derive(Clone, Copy, Debug)]
pub struct PhotonBeam {
    /// Its start.
    pub o: Vec3,
    /// Unit direction of its light.
    pub d: Vec3,
    /// How far it goes.
    pub length: f32,
    /// The power that it carries at its start, in [`BeamMap`] over the number of paths.
    pub power: Spectrum,
    /// How often its light was scattered before.
    pub scatterings: u32,
    /// Whether only one wavelength got here.
    pub secondary_terminated: bool,
}

/// Where a beam is nearest to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamCrossing {
    /// The span of the beam.
    span: u32,
    /// Parameter of the point of the ray that is nearest.
    pub t: f32,
    /// Length of the beam up to there.
    pub along: f32,
    /// How far off the beam might have passed.
    pub r: f32,
    /// Sine of the angle between both.
    pub sine: f32,
}

/// Scratch memory of searches.
pub type CrossingScratch = Vec<BeamCrossing>;

/// How far around a point beams are searched for.
#[derive(Clone, Copy, Debug)]
pub struct SearchRadius {
    /// Where the camera is.
    pub center: Vec3,
    /// The size of pixels.
    pub footprint: RayFootprint,
    /// The radius for such a size.
    pub of_pass: RadiusOfPass,
}

impl SearchRadius {
    /// The radius around a point.
    pub fn at(&self, p: Vec3) -> f32 {
        self.of_pass.at(self.footprint.at(p.distance(self.center)))
    }
}

/// A part of a beam.
#[derive(Clone, Copy, Debug)]
struct Span {
    beam: u32,
    /// Lengths along the beam.
    range: [f32; 2],
}

/// Beams, to be found by the rays that they cross.
#[derive(Debug)]
pub struct BeamMap {
    beams: Vec<PhotonBeam>,
    spans: Vec<Span>,
    tree: Bvh,
    radius: SearchRadius,
}

impl BeamMap {
    /// Builds the tree.
    ///
    /// * `paths`: that the beams were left by
    /// * `radius`: of searches
    /// * `size`: of the scene
    /// * `searches`: how many there are to be, about: for few of them long spans will do
    pub fn new(
        mut beams: Vec<PhotonBeam>,
        paths: u32,
        radius: SearchRadius,
        size: f32,
        searches: u64,
    ) -> BeamMap {
        beams.iter_mut().for_each(|beam| beam.power *= (paths as f32).recip());
        let in_scene = beams.iter().map(|beam| beam.length.min(size)).sum::<f32>();
        let shortest = in_scene / (SPANS_PER_SEARCH * searches as f32).min(MOST_SPANS);
        let (mut spans, mut boxes) = (Vec::new(), Vec::new());
        for (i, beam) in beams.iter().enumerate() {
            let mut from = 0.0;
            while from < beam.length {
                // Beyond the scene few rays come by.
                let r = radius.at(beam.o + from * beam.d);
                let step = if from > size { from } else { shortest.max(SPAN * r) };
                let to = if from + step > from { (from + step).min(beam.length) } else { beam.length };
                spans.push(Span { beam: i as u32, range: [from, to] });
                let ends = [from, to].map(|t| beam.o + t * beam.d);
                // Distances from a point are largest at one of the ends, and so are radii.
                let r = radius.at(ends[0]).max(radius.at(ends[1]));
                boxes.push(Aabb { min: ends[0].min(ends[1]) - r, max: ends[0].max(ends[1]) + r });
                from = to;
            }
        }
        let tree = Bvh::build(&boxes, &BuildSettings::default());
        BeamMap { beams, spans, tree, radius }
    }

    /// The radius of searches around a point.
    pub fn radius_at(&self, p: Vec3) -> f32 {
        self.radius.at(p)
    }

    /// Hands over the beams whose line is nearest to that of a ray at a point of both, and near there, in the order in which they were given.
    ///
    /// * `ray`: of unit direction; as far as `t_max`
    pub fn along(
        &self,
        ray: &Ray,
        scratch: &mut CrossingScratch,
        mut found: impl FnMut(&PhotonBeam, &BeamCrossing),
    ) {
        scratch.clear();
        self.tree.each(ray, |span| scratch.extend(self.crossing(span, ray)));
        scratch.sort_unstable_by_key(|crossing| crossing.span);
        for crossing in scratch.iter() {
            found(&self.beams[self.spans[crossing.span as usize].beam as usize], crossing);
        }
    }

    /// Where the line of a span is nearest to that of a ray, if that is a point of both.
    fn crossing(&self, number: u32, ray: &Ray) -> Option<BeamCrossing> {
        let Span { beam, range: [from, to] } = self.spans[number as usize];
        let beam = &self.beams[beam as usize];
        let across = ray.d.cross(beam.d);
        let (w, sine2) = (beam.o - ray.o, across.length_squared());
        let t = w.cross(beam.d).dot(across) / sine2;
        let along = w.cross(ray.d).dot(across) / sine2;
        let is_met = (ray.t_min..=ray.t_max).contains(&t) && (from..to).contains(&along);
        let (off, r) = (w.dot(across), self.radius.at(ray.o + t * ray.d));
        let is_near = is_met && off * off <= r * r * sine2;
        is_near.then(|| BeamCrossing { span: number, t, along, r, sine: sine2.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    /// Every beam that passes a ray within the radius is found, once, at the place where a search over both lines finds them nearest.
    #[test]
    fn beams_are_found_where_they_pass() {
        let stream = Stream::new(5, [0, 0], 0);
        let point = |i: u32| Vec3::from_array([0, 1, 2].map(|axis| 4.0 * stream.uniform(3 * i + axis) - 2.0));
        let beam = |i: u32| PhotonBeam {
            o: point(2 * i),
            d: (point(2 * i + 1) - point(2 * i)).normalize(),
            length: if i.is_multiple_of(9) { 1e4 } else { 1.0 + (i % 4) as f32 },
            power: Spectrum::WHITE,
            scatterings: i,
            secondary_terminated: false,
        };
        let beams: Vec<PhotonBeam> = (0..400).map(beam).collect();
        let mut scratch = CrossingScratch::new();
        let of_pass = RadiusOfPass { bounds: [0.03, 0.07], share: 1.0 };
        let radius = SearchRadius {
            center: Vec3::X,
            footprint: RayFootprint { origin: 0.0, direction: 0.01 },
            of_pass,
        };
        // Whole beams, and spans of them.
        let maps = [1, 1 << 20].map(|searches| BeamMap::new(beams.clone(), 4, radius, 4.0, searches));
        assert!(maps[1].spans.len() > 2 * maps[0].spans.len());
        let mut all = 0;
        for i in 1000..1040 {
            let ray = Ray {
                o: point(2 * i),
                d: (point(2 * i + 1) - point(2 * i)).normalize(),
                t_min: 0.0,
                t_max: 2.0,
                time: 0.0,
            };
            // The nearest points of two lines: no common normal plane is asked for, steps of both are made smaller and smaller.
            let nearest = |beam: &PhotonBeam| {
                let (mut t, mut s) = (0.0f64, 0.0f64);
                let [o, d, p, e] = [ray.o, ray.d, beam.o, beam.d].map(Vec3::as_dvec3);
                for _ in 0..4000 {
                    t = (p + s * e - o).dot(d);
                    s = (o + t * d - p).dot(e);
                }
                (t, s, (o + t * d).distance(p + s * e), radius.at((o + t * d).as_vec3()))
            };
            let expected: Vec<u32> = beams
                .iter()
                .filter(|beam| {
                    let (t, s, distance, r) = nearest(beam);
                    (0.0..2.0).contains(&t)
                        && s >= 0.0
                        && s < f64::from(beam.length)
                        && distance < f64::from(r)
                })
                .map(|beam| beam.scatterings)
                .collect();
            let found = maps.each_ref().map(|map| {
                let mut found = Vec::new();
                map.along(&ray, &mut scratch, |beam, at| {
                    let places = [ray.o + at.t * ray.d, beam.o + at.along * beam.d];
                    assert!(places[0].distance(places[1]) < at.r + 1e-4 && at.r == radius.at(places[0]));
                    assert!((at.sine - ray.d.cross(beam.d).length()).abs() < 1e-5);
                    assert_eq!(beam.power, Spectrum::WHITE * 0.25);
                    found.push(beam.scatterings);
                });
                found
            });
            all += expected.len();
            assert_eq!(found, [expected.clone(), expected]);
        }
        assert!(all > 100, "{all}");
    }
}
