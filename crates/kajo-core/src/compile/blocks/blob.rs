//! `Blob`: balls, cylinders and half spaces that flow into each other.

use kajo_math::Vec3;
use kajo_scene::{Item, Params};

use crate::compile::blobs::{BlobText, ComponentText};
use crate::compile::fields::{
    Direction, Keys, Optional, Sources, choice, choices, direction, keys, number, point, positive,
};
use crate::compile::material_draft::{Reference, named_material};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::{BlobComponent, BlobCore, BlobKernel};

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
    SphereKeys<'t> {
        center: Vec3 = point("center").required("its middle"),
        radius: f32 = positive("radius").unit("length").required("of its kernel"),
        strength: f32 = number("strength").or(1.0, "value of its field in the middle"),
        material: Option<Reference<'t>> = material(),
    }
}

keys! {
    CylinderKeys<'t> {
        base: Vec3 = point("base").required("one end of its axis"),
        top: Vec3 = point("top").required("the other end"),
        radius: f32 = positive("radius").unit("length").required("of its kernel"),
        strength: f32 = number("strength").or(1.0, "value of its field on the axis"),
        material: Option<Reference<'t>> = material(),
    }
}

keys! {
    PlaneKeys<'t> {
        point: Vec3 = point("point").required("a point of it"),
        normal: Direction = direction("normal").required("at right angles to it, away from what is filled"),
        radius: f32 = positive("radius").unit("length").required("of its kernel, outwards"),
        strength: f32 = number("strength").or(1.0, "value of its field behind it"),
        material: Option<Reference<'t>> = material(),
    }
}

const fn material<'t>() -> Optional<Reference<'t>> {
    named_material("material").unlike(
        "that of the blob",
        "",
        "what it is made of, where it is not like the rest",
    )
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Blob",
        kind: Kind::Shape,
        about: "balls, cylinders and half spaces that flow into each other",
        groups: &[BlobKeys::FIELDS],
        parts: &[&SPHERE, &CYLINDER, &PLANE],
    },
    read: |compiler, item, ctm, state| {
        let text = compiler.read_keys(item, read);
        compiler.blob(text, item, ctm, state);
    },
};

pub const SPHERE: Block = Block {
    keyword: "sphere",
    kind: Kind::Part,
    about: "a component of a blob around a point",
    groups: &[SphereKeys::FIELDS],
    parts: &[],
};

pub const CYLINDER: Block = Block {
    keyword: "cylinder",
    kind: Kind::Part,
    about: "a component of a blob around a line",
    groups: &[CylinderKeys::FIELDS],
    parts: &[],
};

pub const PLANE: Block = Block {
    keyword: "plane",
    kind: Kind::Part,
    about: "a component of a blob that fills the half space behind a plane",
    groups: &[PlaneKeys::FIELDS],
    parts: &[],
};

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<BlobText<'t>> {
    params.name();
    let keys = BlobKeys::read(params, sources);
    let components: Vec<Option<ComponentText<'t>>> = params
        .take(&[SPHERE.keyword, CYLINDER.keyword, PLANE.keyword])
        .into_iter()
        .map(|item| {
            let mut own = Params::new(item, params.diagnostics());
            own.name();
            let component = component(item, &mut own, sources);
            own.finish();
            component
        })
        .collect();
    let components = components.into_iter().collect::<Option<_>>()?;
    let BlobKeys { threshold, kernel } = keys?;
    Some(BlobText { kernel, threshold: threshold.into(), components })
}

fn component<'t>(
    item: Item<'t>,
    params: &mut Params<'t, '_>,
    sources: &mut Sources<'_>,
) -> Option<ComponentText<'t>> {
    let (core, radius, strength, material) = if item.keyword() == SPHERE.keyword {
        let SphereKeys { center, radius, strength, material } = SphereKeys::read(params, sources)?;
        (BlobCore::Ball(center.as_dvec3()), radius, strength, material)
    } else if item.keyword() == CYLINDER.keyword {
        let CylinderKeys { base, top, radius, strength, material } = CylinderKeys::read(params, sources)?;
        (BlobCore::Cylinder([base, top].map(Vec3::as_dvec3)), radius, strength, material)
    } else {
        let PlaneKeys { point, normal, radius, strength, material } = PlaneKeys::read(params, sources)?;
        let normal = normal.0.as_dvec3().normalize();
        (BlobCore::HalfSpace { normal, offset: normal.dot(point.as_dvec3()) }, radius, strength, material)
    };
    let shape = BlobComponent { core, radius: radius.into(), strength: strength.into(), material: 0 };
    Some(ComponentText { item, shape, material })
}
