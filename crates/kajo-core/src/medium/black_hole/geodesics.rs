//! Light around a black hole, as it is followed through a body.

use kajo_math::gravity::{Conserved, KerrMetric, Observer};
use kajo_math::{DMat3, DVec3};

use super::{BlackHole, Sense, resting};
use crate::curved_light::{RayEquation, RayState, Region, momentum, position};

/// Momentum beyond which light that is followed into the past has piled up on the horizon: shifted to less than this part of its
/// frequency, it is dark.
const PILED_UP: f64 = 1e5;

/// The largest distance of a chord from its curve, in parts of the distance from the hole.
const SAG_BY_RADIUS: f64 = 1e-3;

/// How near to the surface of the body is on it, as a part of its radius.
const ON_SURFACE: f64 = 1e-5;

/// The geodesics of light in a body around a black hole.
#[derive(Clone, Copy, Debug)]
pub struct Geodesics<'a> {
    space: &'a BlackHole,
    /// Square of the distance from the hole from which on frequencies are those far away.
    edge2: f64,
    /// Radial coordinate at which light ends.
    horizon: f64,
}

impl<'a> Geodesics<'a> {
    /// Those in a body.
    pub fn new(space: &'a BlackHole, region: &Region) -> Geodesics<'a> {
        let bounds = region.bounds;
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.as_dvec3() - space.center);
        let edge = (-min).min(max).min_element().max(0.0) * (1.0 - ON_SURFACE);
        Geodesics { space, edge2: edge * edge, horizon: space.inner_end() }
    }

    fn follows_future(&self) -> bool {
        self.space.sense == Sense::Reversed
    }

    /// The place in the hole's coordinates, what the metric is there, and the momentum.
    #[inline]
    fn parts(&self, y: &RayState) -> (DVec3, KerrMetric, DVec3) {
        let x = self.space.point_in_hole(position(y));
        (x, self.space.chart.metric(x), self.space.vector_in_hole(momentum(y)))
    }

    /// The frequency in the rest frame, and the direction in which the light goes, in the axes of the hole; on the surface of
    /// the body the frequency far away.
    fn received(&self, y: &RayState) -> Option<(f64, DVec3)> {
        let (x, metric, p) = self.parts(y);
        let energy = metric.energy(p, self.follows_future());
        let observer = resting(&self.space.chart, x)?;
        let (frequency, d) = match self.space.sense {
            Sense::Reversed => observer.received(energy, p),
            // What is followed is the light's way back.
            Sense::Past => {
                let (frequency, d) = observer.received(-energy, -p);
                (frequency, -d)
            }
        };
        let is_outside = x.length_squared() >= self.edge2;
        Some((if is_outside { energy.abs() } else { frequency }, d))
    }
}

impl RayEquation for Geodesics<'_> {
    fn start(&self, p: DVec3, d: DVec3) -> Option<RayState> {
        let x = self.space.point_in_hole(p);
        let d = self.space.vector_in_hole(d.normalize());
        if self.space.chart.radius(x) <= self.horizon {
            return None;
        }
        let observer = resting(&self.space.chart, x)?;
        let momentum = match self.space.sense {
            Sense::Reversed => observer.emitted(d).1,
            Sense::Past => -observer.emitted(-d).1,
        };
        let m = self.space.vector_in_world(momentum);
        Some([p.x, p.y, p.z, m.x, m.y, m.z, 0.0, 0.0])
    }

    #[inline]
    fn slope(&self, y: &RayState) -> RayState {
        let (x, metric, p) = self.parts(y);
        let energy = metric.energy(p, self.follows_future());
        let (dx, dp) = self.space.chart.flow_at(&metric, x, p, energy);
        let [dx, dp] = [dx, dp].map(|v| self.space.vector_in_world(v));
        // The proper length in the slice of constant time, which is finite at the horizon.
        let length = metric.normal_frequency(p);
        let KerrMetric { f, k, .. } = metric;
        let time = (energy + f * (energy + k.dot(p))).abs();
        [dx.x, dx.y, dx.z, dp.x, dp.y, dp.z, length, time]
    }

    fn direction(&self, y: &RayState) -> DVec3 {
        self.received(y).map_or(DVec3::ZERO, |(_, d)| self.space.vector_in_world(d))
    }

    fn ends(&self, y: &RayState) -> bool {
        let x = self.space.point_in_hole(position(y));
        let swallowed = self.space.chart.radius(x) <= self.horizon;
        swallowed || self.space.sense == Sense::Past && momentum(y).length() > PILED_UP
    }

    fn normals(&self, y: &RayState) -> Option<DMat3> {
        let observer = Observer::at_rest(&self.space.chart, self.space.point_in_hole(position(y)))?;
        let column = |v: DVec3| self.space.vector_in_world(observer.covector(self.space.vector_in_hole(v)));
        Some(DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)))
    }

    fn longest_step(&self, y: &RayState) -> f64 {
        // Light that falls straight in has no error that would shorten its steps, and must not come out on the other side.
        0.5 * self.space.point_in_hole(position(y)).length()
    }

    fn largest_sag(&self, y: &RayState) -> f64 {
        SAG_BY_RADIUS * self.space.point_in_hole(position(y)).length()
    }

    /// [Carter 1968]
    fn conserved(&self, y: &RayState) -> [Option<(&'static str, f64)>; 3] {
        let (x, metric, p) = self.parts(y);
        let energy = metric.energy(p, self.follows_future());
        let Conserved { energy, momentum, carter } = self.space.chart.conserved(x, p, energy);
        [Some(("energy", energy)), Some(("angular momentum", momentum)), Some(("Carter's constant", carter))]
    }

    fn frequency_ratio(&self, from: &RayState, to: &RayState) -> f64 {
        let [from, to] = [from, to].map(|y| self.received(y).map_or(0.0, |(frequency, _)| frequency.abs()));
        if to > 0.0 { from / to } else { 0.0 }
    }
}
