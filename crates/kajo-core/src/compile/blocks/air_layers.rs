//! `AirLayers`: air over hot or cold ground, in which mirages are seen.

use super::gradient_index::CurveKeys;
use crate::compile::fields::{Direction, Keys, at_least, direction, flag, keys, number, positive};
use crate::compile::member::{MediumMember, Member};
use crate::medium::gradient_index::{AirLayers, Dispersing, Profile};
use crate::schema::{Block, Constant, Kind};

keys! {
    LayerKeys {
        up: Direction = direction("up").otherwise(Constant::Triple([0.0, 1.0, 0.0]), "away from the ground"),
        ground: f32 = number("ground").unit("length").or(0.0, "where the ground is along `up`"),
        meter: f32 = positive("meter").unit("length").or(1.0, "a metre in the scene's unit"),
        temperature: f32 = positive("temperature").unit("K").or(293.0, "of air away from the ground"),
        rise: f32 = number("rise").unit("K").or(0.0, "how much hotter it is at the ground; negative for colder"),
        depth: f32 = positive("depth").unit("m").or(0.1, "height in which that falls to 1/e"),
        inversion: f32 = number("inversion").unit("K").or(0.0, "how much warmer it is above a certain height"),
        inversion_height: f32 = at_least("inversionHeight", 0.0).unit("m").or(10.0, "that height"),
        inversion_width: f32 = positive("inversionWidth").unit("m").or(1.0, "half the thickness of the layer between"),
        strength: f32 = at_least("strength", 0.0).or(1.0, "makes all bending stronger than it is"),
        dispersion: bool = flag("dispersion").or(true, "whether colours part as they do in air"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "AirLayers",
        kind: Kind::Medium,
        about: "air over hot or cold ground, in which mirages are seen",
        groups: &[LayerKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            let keys = LayerKeys::read(params, sources)?;
            let curves = CurveKeys::read(params, sources)?;
            let Direction(up) = keys.up;
            let meter = f64::from(keys.meter);
            let layers = AirLayers {
                up: up.as_dvec3().normalize(),
                ground: keys.ground.into(),
                temperature: keys.temperature.into(),
                rise: keys.rise.into(),
                depth: f64::from(keys.depth) * meter,
                inversion: keys.inversion.into(),
                height: f64::from(keys.inversion_height) * meter,
                width: f64::from(keys.inversion_width) * meter,
                strength: keys.strength.into(),
            };
            let dispersing = if keys.dispersion { Dispersing::Air } else { Dispersing::None };
            Some(curves.medium(Profile::Layers(layers), dispersing))
        })
    },
};
