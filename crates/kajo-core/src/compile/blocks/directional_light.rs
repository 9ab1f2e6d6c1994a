//! `DirectionalLight`: parallel light from far away.

use kajo_color::Emission;
use kajo_math::fmath;
use kajo_scene::Params;

use crate::compile::fields;
use crate::compile::fields::{Direction, Keys, Sources, classic_light, degrees, direction, emission, keys};
use crate::compile::light_quantities::{classic, physical};
use crate::compile::member::{LightMember, Member};
use crate::compile::spectra::Written;
use crate::ids::LightGroup;
use crate::light::DirectionalLight;
use crate::schema::{Block, Kind};

keys! {
    DirectionalKeys {
        direction: Direction = direction("direction").required("the way its light goes"),
        color: Option<Written<Emission>> = classic_light("color")
            .not_beside(&["irradiance"])
            .unlike("none", "1 1 1", "brightness by the classic formula"),
        irradiance: Option<Emission> = emission("irradiance")
            .not_beside(&["color"])
            .unit("W/m²")
            .unlike("none", "3 3 3", "light on a surface that faces it"),
        angle: f32 = degrees("angle", 0.0, 180.0).or(0.0, "how wide it is in the sky; the sun: 0.53"),
        group: Option<LightGroup> = fields::GROUP,
    }
}

pub const MEMBER: LightMember = Member {
    block: Block {
        keyword: "DirectionalLight",
        kind: Kind::Light,
        about: "parallel light from far away, as of the sun",
        groups: &[DirectionalKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.light(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<(DirectionalLight, LightGroup)> {
    params.name();
    params.either(&["color", "irradiance"], "a light");
    let keys = DirectionalKeys::read(params, sources)?;
    let (intensity, emission) = match (keys.irradiance, keys.color) {
        (Some(irradiance), _) => physical(irradiance),
        (None, Some(color)) => classic(color),
        (None, None) => {
            params.report_missing("color");
            return None;
        }
    };
    let height = fmath::one_minus_cos(0.5 * keys.angle.to_radians());
    let light = DirectionalLight { to_light: -keys.direction.0, height, intensity, emission };
    Some((light, keys.group.unwrap_or_default()))
}
