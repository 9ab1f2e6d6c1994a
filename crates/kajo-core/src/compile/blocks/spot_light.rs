//! `SpotLight`: light from a point into a cone.

use kajo_math::Vec3;
use kajo_scene::Params;

use super::point_light::{BrightnessKeys, POSITION};
use crate::compile::fields::{Direction, Keys, Sources, degrees, direction, keys};
use crate::compile::member::{LightMember, Member};
use crate::ids::LightGroup;
use crate::light::{SpotCone, SpotLight};
use crate::schema::{Around, Block, FieldValue, Kind};

keys! {
    SpotKeys {
        position: Vec3 = POSITION,
        direction: Direction = direction("direction").required("where it points"),
        angle: f32 = degrees("angle", 0.0, 360.0).required("full width of the cone"),
        inner_angle: Option<f32> = degrees("innerAngle", 0.0, 360.0)
            .ruled(inner_angle, "¾ of `angle`", "width of the cone that is evenly bright"),
    }
}

pub const MEMBER: LightMember = Member {
    block: Block {
        keyword: "SpotLight",
        kind: Kind::Light,
        about: "light from a point into a cone",
        groups: &[SpotKeys::FIELDS, BrightnessKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.light(item, read),
};

/// The part of a cone that is evenly bright unless its own angle is written.
const INNER_SHARE: f32 = 0.75;

fn inner_angle(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers([f64::from(INNER_SHARE * around.number("angle")? as f32)]))
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<(SpotLight, LightGroup)> {
    params.name();
    let keys = SpotKeys::read(params, sources);
    let brightness = BrightnessKeys::read(params, sources);
    let SpotKeys { position, direction, angle, inner_angle } = keys?;
    let inner = inner_angle.unwrap_or(INNER_SHARE * angle);
    if inner > angle {
        params.idle(&["innerAngle"], "beyond `angle`: the edge is sharp");
    }
    if angle == 0.0 {
        let message = "a cone of 0 degrees holds no light; `angle` is that of the whole cone";
        params.warn("angle", message, "no cone");
    } else if angle == 360.0 {
        let message = "a cone of 360 degrees is no cone: `PointLight` shines in all directions";
        params.warn("angle", message, "all around");
    } else if angle > 180.0 {
        let message =
            "a cone of more than 180 degrees shines backwards too; `angle` is that of the whole cone";
        params.warn("angle", message, "beyond a half space");
    }
    let half = |degrees: f32| 0.5 * degrees.to_radians();
    let cone = SpotCone::new(half(inner.min(angle)), half(angle));
    let (point, group) = brightness?.light(position, cone.share_of_sphere(), params)?;
    Some((SpotLight { point, axis: direction.0, cone }, group))
}
