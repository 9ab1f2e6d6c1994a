//! `Blob`: balls and cylinders that flow into each other.

use kajo_math::Vec3;
use kajo_scene::{Item, Params};

use crate::compile::fields::{Keys, Sources, choice, choices, keys, number, point, positive};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::{Blob, BlobComponent, BlobCore, BlobKernel};

choices! {
    BlobKernel {
        "gaussian" => BlobKernel::Gaussian,
        "wyvill" => BlobKernel::Wyvill,
        "povray" => BlobKernel::Povray,
    }
}

keys! {
    BlobKeys {
        threshold: f32 = positive("threshold").or(0.5, "value of the field at the surface"),
        kernel: BlobKernel = choice::<BlobKernel>("kernel").or_word("gaussian", "how strength falls off with the distance"),
    }
}

keys! {
    SphereKeys {
        center: Vec3 = point("center").required("its middle"),
        radius: f32 = positive("radius").unit("length").required("of its kernel"),
        strength: f32 = number("strength").or(1.0, "value of its field in the middle"),
    }
}

keys! {
    CylinderKeys {
        base: Vec3 = point("base").required("one end of its axis"),
        top: Vec3 = point("top").required("the other end"),
        radius: f32 = positive("radius").unit("length").required("of its kernel"),
        strength: f32 = number("strength").or(1.0, "value of its field on the axis"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Blob",
        kind: Kind::Shape,
        about: "balls and cylinders that flow into each other",
        groups: &[BlobKeys::FIELDS],
    },
    read: |compiler, item, ctm, state| compiler.solid(item, ctm, state, read),
};

pub const SPHERE: Block = Block {
    keyword: "sphere",
    kind: Kind::Part,
    about: "a component of a blob around a point",
    groups: &[SphereKeys::FIELDS],
};

pub const CYLINDER: Block = Block {
    keyword: "cylinder",
    kind: Kind::Part,
    about: "a component of a blob around a line",
    groups: &[CylinderKeys::FIELDS],
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Blob> {
    let keys = BlobKeys::read(params, sources);
    let components: Vec<Option<BlobComponent>> = params
        .take(&[SPHERE.keyword, CYLINDER.keyword])
        .into_iter()
        .map(|item| {
            let mut own = Params::new(item, params.diagnostics());
            own.name();
            let component = component(item, &mut own, sources);
            own.finish();
            component
        })
        .collect();
    let components: Vec<BlobComponent> = components.into_iter().collect::<Option<_>>()?;
    let BlobKeys { threshold, kernel } = keys?;
    Blob::new(kernel, threshold.into(), &components)
}

fn component(
    item: Item<'_>,
    params: &mut Params<'_, '_>,
    sources: &mut Sources<'_>,
) -> Option<BlobComponent> {
    let (core, radius, strength) = if item.keyword() == SPHERE.keyword {
        let SphereKeys { center, radius, strength } = SphereKeys::read(params, sources)?;
        (BlobCore::Ball(center.as_dvec3()), radius, strength)
    } else {
        let CylinderKeys { base, top, radius, strength } = CylinderKeys::read(params, sources)?;
        (BlobCore::Cylinder([base, top].map(Vec3::as_dvec3)), radius, strength)
    };
    Some(BlobComponent { core, radius: radius.into(), strength: strength.into() })
}
