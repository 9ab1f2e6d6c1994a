//! The stops of a ramp, to show and to set.

use kajo_core::compile::ramp_colors;
use kajo_core::schema::FieldKind;
use kajo_core::texture::Colors;

use super::{Field, FieldValue};

/// A place of a ramp, and its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampStop {
    /// Where it is, from 0 to 1 mostly.
    pub at: f64,
    /// Linear red, green and blue, from 0 to 1.
    pub rgb: [f64; 3],
}

/// The stops of a block, in their order, which is that of their places.
#[derive(Clone, Debug)]
pub struct Ramp {
    /// The stops; at least one.
    pub stops: Vec<RampStop>,
    /// What is between them.
    colors: Colors,
}

impl Ramp {
    /// The word of stops.
    pub const KEY: &'static str = "stop";

    /// That of a block with these fields; `None` where it is none, or says something that is none.
    pub fn of(fields: &[Field]) -> Option<Ramp> {
        let written = |field: &&Field| field.kind == FieldKind::ColorStop && field.span.is_some();
        let stops: Option<Vec<RampStop>> = fields.iter().filter(written).map(stop).collect();
        let word = fields.iter().find(|field| field.key == "interpolation");
        let word = word.and_then(|field| field.value.as_ref()?.word.as_deref()).unwrap_or("linear");
        Ramp::new(stops?, word)
    }

    fn new(stops: Vec<RampStop>, interpolation: &str) -> Option<Ramp> {
        let own = |stop: &RampStop| (stop.at as f32, stop.rgb.map(|v| v as f32));
        let colors = ramp_colors(stops.iter().map(own).collect(), interpolation)?;
        Some(Ramp { stops, colors })
    }

    /// Linear red, green and blue at a place.
    pub fn at(&self, place: f64) -> [f32; 3] {
        self.colors.at(place as f32)
    }

    /// How far a stop may go without passing another one.
    pub fn room(&self, stop: usize) -> [f64; 2] {
        let least = stop.checked_sub(1).map_or(f64::MIN, |before| self.stops[before].at);
        // In order are places in single precision.
        [least, self.stops.get(stop + 1).map_or(f64::MAX, |after| after.at.max(least))]
    }

    /// The stops with one more at a place, of the colour that is there.
    pub fn with_stop(&self, at: f64) -> Vec<RampStop> {
        let mut stops = self.stops.clone();
        let rgb = self.at(at).map(|v| (f64::from(v) * 1e4).round() / 1e4);
        stops.insert(stops.partition_point(|stop| stop.at <= at), RampStop { at, rgb });
        stops
    }
}

impl RampStop {
    /// As a scene has it.
    pub fn value(&self) -> FieldValue {
        let [r, g, b] = self.rgb;
        FieldValue::numbers([self.at, r, g, b])
    }
}

fn stop(field: &Field) -> Option<RampStop> {
    let [at, r, g, b] = field.value.as_ref()?.numbers[..] else { return None };
    Some(RampStop { at, rgb: [r, g, b] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_are_put_where_they_belong() {
        let stop = |at: f64, grey: f64| RampStop { at, rgb: [grey; 3] };
        let ramp = Ramp::new(vec![stop(0.0, 0.0), stop(0.5, 1.0), stop(1.0, 0.0)], "linear").unwrap();
        assert_eq!(ramp.at(0.25), [0.5; 3]);
        assert_eq!(ramp.with_stop(0.75)[2], stop(0.75, 0.5));
        assert_eq!(ramp.with_stop(-1.0)[0], stop(-1.0, 0.0));
        assert_eq!((ramp.room(0), ramp.room(1)), ([f64::MIN, 0.5], [0.0, 1.0]));
        let same = Ramp::new([0.5, 0.5, 0.5 - 1e-12].map(|at| stop(at, 0.0)).to_vec(), "linear").unwrap();
        assert_eq!(same.room(1), [0.5; 2]);
        assert!(Ramp::new(vec![], "linear").is_none() && Ramp::new(vec![stop(0.0, 0.0)], "?").is_none());
    }
}
