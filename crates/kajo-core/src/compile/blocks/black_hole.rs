//! `BlackHole`: the curved space around a black hole.

use kajo_math::Vec3;
use kajo_scene::{Diagnostic, Params};

use crate::compile::fields::{
    Direction, Keys, Sources, between, choice, choices, direction, keys, point, positive,
};
use crate::compile::member::{MediumMember, Member};
use crate::medium::{BlackHole, BlackHoleObserver};
use crate::schema::{Block, Constant, Kind};

choices! {
    BlackHoleObserver {
        "againstSpin" => BlackHoleObserver::Orbits { with_axis: false },
        "falls" => BlackHoleObserver::Falls,
        "orbits" => BlackHoleObserver::Orbits { with_axis: true },
        "rests" => BlackHoleObserver::Rests,
    }
}

keys! {
    BlackHoleKeys {
        center: Vec3 = point("center").or([0.0; 3], "its middle"),
        mass: f32 = positive("mass").unit("length").sliding([0.01, 100.0]).or(1.0, "half the radius of its horizon, were it not to spin"),
        spin: f32 = between("spin", -1.0, 1.0).or(0.0, "angular momentum over the square of the mass"),
        axis: Direction = direction("axis").or([0.0, 1.0, 0.0], "what it spins about, right-handed"),
        observer: BlackHoleObserver = choice::<BlackHoleObserver>("observer")
            .otherwise(Constant::Word("rests"), "how a camera moves that is in its space"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "BlackHole",
        kind: Kind::Medium,
        about: "the curved space around a black hole",
        groups: &[BlackHoleKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.medium(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<BlackHole> {
    let BlackHoleKeys { center, mass, spin, axis, observer } = BlackHoleKeys::read(params, sources)?;
    let made = BlackHole::new(center, mass, spin, axis.0);
    let report = |error| params.report(Diagnostic::error(format!("{error}")), "no such hole");
    made.map_err(report).ok().map(|hole| hole.observed_by(observer))
}
