//! World lines: where an observer is at every moment, and what its own clock shows.
//!
//! A world line through events is a cubic spline of the place by the world's time, whose acceleration is continuous and zero at both ends,
//! where it goes on as it is. Its clock shows the proper time
//!
//! ```text
//! τ = ∫ sqrt(1 - v²) dt
//! ```
//!
//! with the speed of light 1. Under constant acceleration `a` in its own frame, from rest, an observer is at [Rindler 2006, section 3.7]
//!
//! ```text
//! t = sinh(a τ) / a,    x = (cosh(a τ) - 1) / a,    v = tanh(a τ)
//! ```

use std::fmt;

use glam::DVec3;

use crate::fmath::{exp_m1_64, tanh64};
use crate::lorentz::SpacetimeEvent;
use crate::quadrature::gauss5;

/// Where an observer is, and how it moves there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldPoint {
    /// The place and the moment.
    pub event: SpacetimeEvent,
    /// As a fraction of the speed of light.
    pub velocity: DVec3,
}

/// Why there is no world line through events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WorldLineError {
    /// There are none.
    Empty,
    /// This event is not after the one before it, or no event at all.
    Order(usize),
    /// It would be faster than allowed after this event.
    Fast {
        /// Which event.
        after: usize,
        /// How fast, over the speed of light.
        speed: f64,
    },
}

impl fmt::Display for WorldLineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WorldLineError::Empty => write!(f, "a world line goes through events, and here is none"),
            WorldLineError::Order(_) => write!(f, "events stand in the order of their moments"),
            WorldLineError::Fast { speed, .. } => {
                write!(f, "this would go on at {speed:.4} times the speed of light")
            }
        }
    }
}

/// A world line through events.
#[derive(Clone, Debug)]
pub struct WorldLine {
    spans: Vec<Span>,
    /// What the clock shows at the beginning of each span, and at the end of the last.
    clock: Vec<f64>,
}

/// Between two events: `x(t) = p + t (v + t (a/2 + t j/6))`, with `t` from the first of them on.
#[derive(Clone, Copy, Debug)]
struct Span {
    start: f64,
    duration: f64,
    place: DVec3,
    velocity: DVec3,
    acceleration: DVec3,
    jerk: DVec3,
}

impl Span {
    fn place_at(&self, t: f64) -> DVec3 {
        self.place + t * (self.velocity + t * (0.5 * self.acceleration + t / 6.0 * self.jerk))
    }

    fn velocity_at(&self, t: f64) -> DVec3 {
        self.velocity + t * (self.acceleration + 0.5 * t * self.jerk)
    }

    /// What its clock counts from one time to another.
    fn proper_time(&self, from: f64, to: f64) -> f64 {
        let rate = |t: f64| (1.0 - self.velocity_at(t).length_squared()).max(0.0).sqrt();
        let step = (to - from) / f64::from(PARTS);
        (0..PARTS).map(|i| from + step * f64::from(i)).map(|a| gauss5(a, a + step, rate)).sum()
    }

    /// A speed of the span that is at least `fastest`, if there is one; the velocity is a parabola, which lies within the hull of its
    /// control points.
    fn too_fast(&self, fastest: f64) -> Option<f64> {
        let mut left = vec![[0.0, self.duration]];
        while let Some([a, b]) = left.pop() {
            let [va, vb] = [a, b].map(|t| self.velocity_at(t));
            let middle = va + 0.5 * (b - a) * (self.acceleration + a * self.jerk);
            let found = va.length().max(vb.length());
            if found >= fastest {
                return Some(found);
            }
            if middle.length() >= fastest {
                // So near to the limit that it may as well be there.
                if b - a < 1e-6 * self.duration {
                    return Some(middle.length());
                }
                left.extend([[a, 0.5 * (a + b)], [0.5 * (a + b), b]]);
            }
        }
        None
    }
}

/// Parts of a span over which clocks are integrated.
const PARTS: u32 = 8;

impl WorldLine {
    /// The world line through events; one that has a single event rests there.
    ///
    /// * `fastest`: its speed stays below this fraction of the speed of light
    ///
    /// # Errors
    ///
    /// [`WorldLineError`].
    pub fn through(events: &[SpacetimeEvent], fastest: f64) -> Result<WorldLine, WorldLineError> {
        let Some(first) = events.first() else { return Err(WorldLineError::Empty) };
        let is_event = |event: &SpacetimeEvent| event.t.is_finite() && event.x.is_finite();
        if !is_event(first) {
            return Err(WorldLineError::Order(0));
        }
        let follows = |pair: &[SpacetimeEvent]| is_event(&pair[1]) && pair[1].t > pair[0].t;
        if let Some(i) = events.windows(2).position(|pair| !follows(pair)) {
            return Err(WorldLineError::Order(i + 1));
        }
        let mut spans = spans(events);
        if spans.is_empty() {
            let [velocity, acceleration, jerk] = [DVec3::ZERO; 3];
            spans.push(Span { start: first.t, duration: 0.0, place: first.x, velocity, acceleration, jerk });
        }
        let fast = spans.iter().enumerate().find_map(|(i, span)| Some((i, span.too_fast(fastest)?)));
        if let Some((after, speed)) = fast {
            return Err(WorldLineError::Fast { after, speed });
        }
        let mut clock = vec![0.0];
        for span in &spans {
            clock.push(clock[clock.len() - 1] + span.proper_time(0.0, span.duration));
        }
        Ok(WorldLine { spans, clock })
    }

    /// Where the observer is when its clock shows a time, counted from the first event; before that and after the last one it moves evenly.
    pub fn at(&self, proper_time: f64) -> WorldPoint {
        let last = self.spans.len() - 1;
        let i = self.clock[1..last + 1].partition_point(|&end| end <= proper_time);
        let span = &self.spans[i];
        let left = proper_time - self.clock[i];
        let counted = self.clock[i + 1] - self.clock[i];
        let t = if left < 0.0 {
            left / rate(span.velocity)
        } else if left > counted || counted == 0.0 {
            span.duration + (left - counted) / rate(span.velocity_at(span.duration))
        } else {
            moment(span, left)
        };
        let within = t.clamp(0.0, span.duration);
        let velocity = span.velocity_at(within);
        let x = span.place_at(within) + (t - within) * velocity;
        WorldPoint { event: SpacetimeEvent { t: span.start + t, x }, velocity }
    }
}

/// How fast the clock of an observer goes by that of the world.
fn rate(velocity: DVec3) -> f64 {
    (1.0 - velocity.length_squared()).sqrt()
}

/// The time of a span at which its clock has counted so much.
fn moment(span: &Span, counted: f64) -> f64 {
    let (mut low, mut high) = (0.0, span.duration);
    let mut t = 0.5 * span.duration;
    // Newton's method, kept between bounds that close.
    for _ in 0..60 {
        let off = span.proper_time(0.0, t) - counted;
        if off > 0.0 {
            high = t;
        } else {
            low = t;
        }
        let newton = t - off / rate(span.velocity_at(t));
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == t {
            break;
        }
        t = next;
    }
    t
}

/// The natural cubic spline through events, in pieces.
fn spans(events: &[SpacetimeEvent]) -> Vec<Span> {
    let n = events.len();
    let duration = |i: usize| events[i + 1].t - events[i].t;
    let chord = |i: usize| (events[i + 1].x - events[i].x) / duration(i);
    // Accelerations at the events, by elimination [Thomas 1949]; zero at both ends.
    let (mut above, mut a) = (vec![0.0; n], vec![DVec3::ZERO; n]);
    for i in 1..n.saturating_sub(1) {
        let (h0, h1) = (duration(i - 1), duration(i));
        let pivot = 2.0 * (h0 + h1) - h0 * above[i - 1];
        above[i] = h1 / pivot;
        a[i] = (6.0 * (chord(i) - chord(i - 1)) - h0 * a[i - 1]) / pivot;
    }
    for i in (1..n.saturating_sub(1)).rev() {
        let next = a[i + 1];
        a[i] -= above[i] * next;
    }
    let span = |i: usize| Span {
        start: events[i].t,
        duration: duration(i),
        place: events[i].x,
        velocity: chord(i) - duration(i) / 6.0 * (2.0 * a[i] + a[i + 1]),
        acceleration: a[i],
        jerk: (a[i + 1] - a[i]) / duration(i),
    };
    (0..n - 1).map(span).collect()
}

/// Where an observer is that has been at rest in the origin at the moment 0, and is under constant acceleration in its own frame.
///
/// * `acceleration`: in speeds of light per time, so that 1 over it is a length
pub fn accelerated(acceleration: DVec3, proper_time: f64) -> WorldPoint {
    let a = acceleration.length();
    if a == 0.0 {
        return WorldPoint {
            event: SpacetimeEvent { t: proper_time, x: DVec3::ZERO },
            velocity: DVec3::ZERO,
        };
    }
    let along = acceleration / a;
    let rapidity = a * proper_time;
    // sinh and cosh - 1 without loss where the rapidity is small.
    let grown = exp_m1_64(rapidity);
    let sinh = 0.5 * (grown + grown / (grown + 1.0));
    let cosh_m1 = 0.5 * grown * grown / (grown + 1.0);
    WorldPoint {
        event: SpacetimeEvent { t: sinh / a, x: cosh_m1 / a * along },
        velocity: tanh64(rapidity) * along,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(t: f64, x: [f64; 3]) -> SpacetimeEvent {
        SpacetimeEvent { t, x: x.into() }
    }

    fn through(events: &[SpacetimeEvent]) -> Result<WorldLine, WorldLineError> {
        WorldLine::through(events, 0.999_999)
    }

    #[test]
    fn two_events_are_joined_by_even_motion() {
        let line = through(&[event(1.0, [0.0; 3]), event(11.0, [6.0, 0.0, 0.0])]).expect("a line");
        // Clocks go slow by 0.8.
        for (tau, t) in [(-4.0, -4.0), (0.0, 1.0), (4.0, 6.0), (8.0, 11.0), (16.0, 21.0)] {
            let found = line.at(tau);
            assert!((found.event.t - t).abs() < 1e-12, "{tau}: {found:?}");
            assert!(
                (found.event.x.x - 0.6 * (t - 1.0)).abs() < 1e-12 && found.velocity.x == 0.6,
                "{found:?}"
            );
        }
    }

    /// A spline through events of a hyperbola is the hyperbola, and so is its clock.
    #[test]
    fn splines_follow_constant_acceleration() {
        let a = DVec3::new(0.0, 0.3, -0.4);
        let exact = |tau: f64| accelerated(a, tau);
        let events: Vec<SpacetimeEvent> =
            (0..=200).map(|i| exact(-6.0 + 0.06 * f64::from(i)).event).collect();
        let line = through(&events).expect("a line");
        for i in 0..80 {
            let tau = -4.0 + 0.1 * f64::from(i);
            let (found, expected) = (line.at(tau + 6.0), exact(tau));
            assert!((found.event.t - expected.event.t).abs() < 1e-5, "{tau}: {found:?} {expected:?}");
            assert!((found.event.x - expected.event.x).length() < 1e-5, "{tau}: {found:?} {expected:?}");
            assert!((found.velocity - expected.velocity).length() < 1e-4, "{tau}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn acceleration_has_its_closed_form() {
        let WorldPoint { event, velocity } = accelerated(DVec3::new(2.0, 0.0, 0.0), 0.7);
        assert!((event.t - 1.4f64.sinh() / 2.0).abs() < 1e-15);
        assert!((event.x.x - (1.4f64.cosh() - 1.0) / 2.0).abs() < 1e-15);
        assert!((velocity.x - 1.4f64.tanh()).abs() < 1e-15);
        assert_eq!(accelerated(DVec3::ZERO, 3.0).event, SpacetimeEvent { t: 3.0, x: DVec3::ZERO });
    }

    /// On a circle clocks go slow by the same factor all the time.
    #[test]
    fn round_trips_take_less_time_for_who_goes() {
        let (radius, speed) = (5.0, 0.8);
        let events: Vec<SpacetimeEvent> = (0..=400)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i) / 200.0;
                event(angle * radius / speed, [radius * angle.cos(), 0.0, radius * angle.sin()])
            })
            .collect();
        let line = through(&events).expect("a line");
        let around = std::f64::consts::TAU * radius / speed;
        // The second half of the first round and the first one of the second are far from the ends, which are bent less.
        let [a, b] = [0.35 * around, 0.85 * around].map(|tau| line.at(tau));
        assert!((b.event.t - a.event.t - 0.5 * around / 0.6).abs() < 1e-4, "{a:?} {b:?}");
        assert!((a.event.x.length() - radius).abs() < 1e-5 && (a.velocity.length() - speed).abs() < 1e-4);
    }

    #[test]
    fn what_is_no_world_line_is_refused() {
        assert_eq!(through(&[]).err(), Some(WorldLineError::Empty));
        let twice = [event(0.0, [0.0; 3]), event(0.0, [1.0, 0.0, 0.0])];
        assert_eq!(through(&twice).err(), Some(WorldLineError::Order(1)));
        assert_eq!(through(&[event(f64::NAN, [0.0; 3])]).err(), Some(WorldLineError::Order(0)));
        let light = [event(0.0, [0.0; 3]), event(1.0, [1.0, 0.0, 0.0])];
        assert_eq!(through(&light).err(), Some(WorldLineError::Fast { after: 0, speed: 1.0 }));
        // Each chord is slow, and the curve between them is not.
        let corner = [event(0.0, [0.0; 3]), event(1.0, [0.9, 0.0, 0.0]), event(2.0, [0.9, 0.9, 0.0])];
        assert!(matches!(through(&corner).err(), Some(WorldLineError::Fast { .. })));
        let still = through(&[event(2.0, [1.0, 2.0, 3.0])]).expect("a line");
        assert_eq!(still.at(5.0).event, event(7.0, [1.0, 2.0, 3.0]));
    }
}
