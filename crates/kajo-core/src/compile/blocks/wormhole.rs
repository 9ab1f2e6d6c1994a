//! `Wormhole`: the curved space around the mouths of a wormhole.

use kajo_math::Vec3;
use kajo_scene::{Diagnostic, Params};

use crate::compile::fields::{Direction, Keys, Sources, at_least, direction, keys, point, positive};
use crate::compile::member::{MediumMember, Member};
use crate::medium::{WormholeMedium, WormholeShape};
use crate::schema::{Block, Kind};

keys! {
    WormholeKeys {
        mouth: Vec3 = point("mouth").required("the middle of one mouth"),
        other: Vec3 = point("other").required("the middle of the other one"),
        radius: f32 = positive("radius").unit("length").required("of the ball around each mouth in which space is curved"),
        throat: f32 = positive("throat").unit("length").sliding([0.01, 100.0]).required("radius of its narrowest place"),
        length: f32 = at_least("length", 0.0).unit("length").or(0.0, "how long it is as narrow as that"),
        width: f32 = at_least("width", 0.0)
            .unit("length")
            .or(0.0, "how gently it widens, as the mass of a black hole would; 0 for that of Ellis"),
        into: Direction = direction("into").or([0.0, 0.0, -1.0], "light that goes into the one mouth like this..."),
        out: Direction = direction("out").or([0.0, 0.0, -1.0], "...comes out of the other like that"),
        up: Direction = direction("up").or([0.0, 1.0, 0.0], "what is up on both sides"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "Wormhole",
        kind: Kind::Medium,
        about: "the curved space of two mouths that are one throat",
        groups: &[WormholeKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.medium(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<WormholeMedium> {
    let WormholeKeys { mouth, other, radius, throat, length, width, into, out, up } =
        WormholeKeys::read(params, sources)?;
    let shape = WormholeShape {
        centers: [mouth, other],
        throat,
        length,
        radius,
        width,
        directions: [into.0, out.0],
        up: up.0,
    };
    let report = |error| params.report(Diagnostic::error(format!("{error}")), "no such wormhole");
    WormholeMedium::new(&shape).map_err(report).ok()
}
