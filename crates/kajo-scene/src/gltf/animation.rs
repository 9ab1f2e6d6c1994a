//! Animations: the places of nodes and the weights of morphs at a moment.
//!
//! A channel says how one property of a node changes: its translation, rotation or scale, or the weights of the targets of
//! its mesh. Its sampler has times and values, between which lead steps, straight lines (great circles for rotations), or
//! Hermite's cubics [Khronos 2021, sec. 3.11 and appendix C]:
//!
//! ```text
//! p(u) = (2u³ - 3u² + 1) p0 + (u³ - 2u² + u) h b0 + (3u² - 2u³) p1 + (u³ - u²) h a1,     u = (t - t0) / h
//! ```
//!
//! with the slopes `b` behind a key and `a` before it. What is found takes the place of what the nodes say, and so reaches
//! joints of skins and all that hangs on the nodes.

use std::sync::Arc;

use super::Budget;
use super::accessor::AccessorView;
use super::container::Buffers;
use super::json::{Animation, AnimationSampler, Document};
use kajo_math::DQuat;
use kajo_math::keyed::{Outside, hermite, slerp};

/// Which moment of which animation.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelMoment {
    /// The name of the animation, or its number from 0; the first one without.
    pub animation: Option<String>,
    /// Seconds from its beginning.
    pub seconds: f64,
    /// What holds before its first key and after its last.
    pub outside: Outside,
}

/// An animation of a model, and when it has keys.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelAnimation {
    /// Its name, if it has one.
    pub name: Option<Arc<str>>,
    /// Moments at which any of its channels has a key, in seconds from its beginning, each later than the one before.
    pub key_times: Arc<[f64]>,
}

/// What came of posing a model.
#[derive(Default)]
pub(super) struct Posed {
    /// The animation that was followed, if the model has any.
    pub animation: Option<ModelAnimation>,
    /// What could not be followed, one sentence each.
    pub left_out: Vec<String>,
}

/// A property of a node, and what it is.
enum Change {
    Translation([f64; 3]),
    Rotation([f64; 4]),
    Scale([f64; 3]),
    Weights(Vec<f64>),
}

/// Puts the nodes where they are at a moment.
pub(super) fn pose(
    document: &mut Document,
    buffers: &Buffers<'_>,
    moment: &ModelMoment,
    budget: &mut Budget,
) -> Result<Posed, String> {
    let Some(number) = chosen(&document.animations, moment.animation.as_deref())? else {
        return Ok(Posed::default());
    };
    let of_animation = |said: String| format!("animations[{number}]: {said}");
    let curves = curves(document, buffers, number, budget).map_err(of_animation)?;
    let name = document.animations[number].name.clone();
    let animation = Some(ModelAnimation { name, key_times: key_times(&curves) });
    let changes = changes(document, buffers, (number, &curves), moment, budget);
    let (changes, skipped) = changes.map_err(of_animation)?;
    for (node, change) in changes {
        let node = &mut document.nodes[node];
        match change {
            Change::Translation(t) => node.translation = Some(t),
            Change::Rotation(q) => node.rotation = Some(q),
            Change::Scale(s) => node.scale = Some(s),
            Change::Weights(weights) => node.weights = Some(weights),
        }
        // A matrix and its parts cannot both hold.
        node.matrix = None;
    }
    let said =
        (skipped > 0).then(|| format!("left out: {skipped} channels of an animation that move no node"));
    Ok(Posed { animation, left_out: said.into_iter().collect() })
}

/// The number of the animation that is asked for; `None` where the model has none.
fn chosen(animations: &[Animation], name: Option<&str>) -> Result<Option<usize>, String> {
    let Some(name) = name else { return Ok((!animations.is_empty()).then_some(0)) };
    let named = animations.iter().position(|animation| animation.name.as_deref() == Some(name));
    let numbered = || name.parse().ok().filter(|&number: &usize| number < animations.len());
    named.or_else(numbered).map(Some).ok_or_else(|| {
        let names: Vec<String> = animations
            .iter()
            .filter_map(|animation| animation.name.as_ref())
            .map(|name| format!("`{name}`"))
            .collect();
        match (animations.len(), names.is_empty()) {
            (0, _) => "it has no animations".to_owned(),
            (count, true) => {
                format!("it has no animation `{name}`; there are {count}, without names, from 0 on")
            }
            (_, false) => format!("it has no animation `{name}`; there are {}", names.join(", ")),
        }
    })
}

/// The samplers of an animation.
fn curves<'d>(
    document: &'d Document,
    buffers: &Buffers<'_>,
    number: usize,
    budget: &mut Budget,
) -> Result<Vec<Curve<'d>>, String> {
    let samplers = document.animations[number].samplers.iter().enumerate();
    let curve = |(i, sampler)| {
        Curve::new(document, buffers, sampler, budget).map_err(|said| format!("samplers[{i}]: {said}"))
    };
    samplers.map(curve).collect()
}

/// What an animation says at a moment, each with its node, and how many channels say nothing of nodes.
fn changes(
    document: &Document,
    buffers: &Buffers<'_>,
    (number, curves): (usize, &[Curve<'_>]),
    moment: &ModelMoment,
    budget: &mut Budget,
) -> Result<(Vec<(usize, Change)>, usize), String> {
    let animation = &document.animations[number];
    let time = time_within(curves, moment);
    let (mut changes, mut skipped) = (Vec::with_capacity(animation.channels.len()), 0);
    for (i, channel) in animation.channels.iter().enumerate() {
        let named = |said: String| format!("channels[{i}]: {said}");
        let curve = curves.get(channel.sampler);
        let curve = curve.ok_or_else(|| named(format!("there is no samplers[{}]", channel.sampler)))?;
        let Some(node) = channel.target.node else {
            skipped += 1;
            continue;
        };
        let Some(said) = document.nodes.get(node) else {
            return Err(named(format!("there is no nodes[{node}]")));
        };
        let mesh = said.mesh.and_then(|mesh| document.meshes.get(mesh));
        let targets = mesh.and_then(|mesh| mesh.primitives.first()).map_or(0, |first| first.targets.len());
        let width = match channel.target.path.as_str() {
            "translation" | "scale" => 3,
            "rotation" => 4,
            "weights" => targets,
            _ => {
                skipped += 1;
                continue;
            }
        };
        budget.take::<f64>(width).map_err(named)?;
        let is_rotation = channel.target.path == "rotation";
        let values = curve.at(time, (document, buffers), width, is_rotation).map_err(named)?;
        if values.iter().any(|value| !value.is_finite()) {
            continue;
        }
        changes.push((
            node,
            match (channel.target.path.as_str(), values.as_slice()) {
                ("translation", &[x, y, z]) => Change::Translation([x, y, z]),
                ("scale", &[x, y, z]) => Change::Scale([x, y, z]),
                ("rotation", &[x, y, z, w]) => Change::Rotation([x, y, z, w]),
                _ => Change::Weights(values),
            },
        ));
    }
    Ok((changes, skipped))
}

/// When any of the curves has a key, in seconds from the beginning.
fn key_times(curves: &[Curve<'_>]) -> Arc<[f64]> {
    let start = first_key(curves).min(0.0);
    let mut times: Vec<f64> = curves.iter().flat_map(|curve| &curve.times).map(|time| time - start).collect();
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    times.into()
}

/// The first key of any curve.
fn first_key(curves: &[Curve<'_>]) -> f64 {
    curves.iter().map(|curve| curve.times[0]).fold(f64::INFINITY, f64::min)
}

/// The moment in the time of the animation's keys.
fn time_within(curves: &[Curve<'_>], moment: &ModelMoment) -> f64 {
    // An animation begins with the first key of any channel and lasts up to the last one.
    let first = first_key(curves);
    let last =
        curves.iter().map(|curve| curve.times[curve.times.len() - 1]).fold(f64::NEG_INFINITY, f64::max);
    // On a grid of nanoseconds, so that frames a whole number of rounds apart are the same.
    let [start, last, time] = [first.min(0.0), last, first.min(0.0) + moment.seconds].map(on_grid);
    if last > start { moment.outside.within(time, [start, last]) } else { start }
}

fn on_grid(seconds: f64) -> f64 {
    const GRID: f64 = (1u64 << 30) as f64;
    (seconds * GRID).round() / GRID
}

/// A sampler whose times are read.
struct Curve<'d> {
    sampler: &'d AnimationSampler,
    /// Growing, and at least one.
    times: Vec<f64>,
}

impl<'d> Curve<'d> {
    fn new(
        document: &Document,
        buffers: &Buffers<'_>,
        sampler: &'d AnimationSampler,
        budget: &mut Budget,
    ) -> Result<Curve<'d>, String> {
        let view = AccessorView::<1>::new(document, buffers, sampler.input)?;
        if !view.is_backed() || view.count == 0 {
            return Err("it has no times".to_owned());
        }
        budget.take::<f64>(view.count)?;
        let times: Vec<f64> = (0..view.count).map(|i| view.get(i)[0]).collect();
        let grows = times.windows(2).all(|pair| pair[1] > pair[0]);
        if !(grows && times.iter().all(|time| time.is_finite())) {
            return Err("its times do not grow".to_owned());
        }
        Ok(Curve { sampler, times })
    }

    /// So many numbers at a time.
    fn at(
        &self,
        time: f64,
        (document, buffers): (&Document, &Buffers<'_>),
        width: usize,
        is_rotation: bool,
    ) -> Result<Vec<f64>, String> {
        let output = self.sampler.output;
        let last = self.times.len() - 1;
        let is_cubic = self.sampler.interpolation == "CUBICSPLINE";
        let elements = self.times.len() * if is_cubic { 3 } else { 1 };
        let values = match width {
            3 if !is_rotation && is_triple(document, output) => {
                Values::Three(AccessorView::new(document, buffers, output)?)
            }
            4 if is_rotation => Values::Four(AccessorView::new(document, buffers, output)?),
            _ => Values::One(AccessorView::new(document, buffers, output)?, width),
        };
        if values.count() < elements {
            return Err(format!("there are {elements} values to be, and only {}", values.count()));
        }
        // The middle one of three for a cubic, which has its slopes around it.
        let value = |key: usize| values.get(if is_cubic { 3 * key + 1 } else { key });
        let i = self.times.partition_point(|&t| t <= time);
        if i == 0 || i > last {
            return Ok(value(if i == 0 { 0 } else { last }));
        }
        let (from, to) = (i - 1, i);
        let h = self.times[to] - self.times[from];
        let u = (time - self.times[from]) / h;
        let (a, b) = (value(from), value(to));
        let unit = |q: &[f64]| DQuat::from_slice(q).normalize();
        Ok(match self.sampler.interpolation.as_str() {
            "STEP" => a,
            "CUBICSPLINE" => {
                let (leaving, arriving) = (values.get(3 * from + 2), values.get(3 * to));
                let curve = |c: usize| hermite([a[c], b[c]], [leaving[c] * h, arriving[c] * h], u);
                let values: Vec<f64> = (0..width).map(curve).collect();
                if is_rotation { unit(&values).to_array().to_vec() } else { values }
            }
            _ if is_rotation => slerp(unit(&a), unit(&b), u).to_array().to_vec(),
            _ => std::iter::zip(a, b).map(|(a, b)| a + u * (b - a)).collect(),
        })
    }
}

/// Whether an accessor has three numbers an element, so that its values are no weights.
fn is_triple(document: &Document, accessor: usize) -> bool {
    document.accessors.get(accessor).is_some_and(|accessor| accessor.r#type == "VEC3")
}

/// Values of keys.
enum Values<'b> {
    Three(AccessorView<'b, 3>),
    Four(AccessorView<'b, 4>),
    /// Numbers, so many of them for a key.
    One(AccessorView<'b, 1>, usize),
}

impl Values<'_> {
    /// How many values there are.
    fn count(&self) -> usize {
        match self {
            Values::Three(view) => view.count,
            Values::Four(view) => view.count,
            // No weights are always there.
            Values::One(view, width) => view.count.checked_div(*width).unwrap_or(usize::MAX),
        }
    }

    fn get(&self, i: usize) -> Vec<f64> {
        match self {
            Values::Three(view) => view.get(i).to_vec(),
            Values::Four(view) => view.get(i).to_vec(),
            Values::One(view, width) => (0..*width).map(|c| view.get(i * width + c)[0]).collect(),
        }
    }
}

#[cfg(test)]
mod tests;
