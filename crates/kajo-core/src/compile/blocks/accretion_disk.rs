//! `AccretionDisk`: hot gas around a black hole.

use kajo_scene::{Diagnostic, Params};

use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{At, Inside, Keys, Sources, at_least, flag, inside, keys, positive, share};
use crate::compile::member::{MaterialMember, Member};
use crate::emission::OrbitingGas;
use crate::material::AccretionDisk;
use crate::medium::{BlackHole, MediumId};
use crate::schema::{Block, Kind};
use crate::texture::FloatTexture;

keys! {
    AccretionDiskKeys<'t> {
        hole: At<'t, Inside> = inside("hole").placed().required("name of the `BlackHole` that it goes around"),
        temperature: f32 = positive("temperature").unit("K").or(6500.0, "where it is hottest, in the frame of the gas"),
        luminance: f32 = at_least("luminance", 0.0).or(1.0, "how bright it is there, in that frame"),
        pattern: FloatTexture = share("pattern").or(1.0, "what its light is multiplied by, such as a swirl"),
        against: bool = flag("againstSpin").or(false, "whether it goes around left-handed about the axis"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "AccretionDisk",
        kind: Kind::Material,
        about: "gas that emits on its way around a black hole",
        groups: &[AccretionDiskKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        let holes = compiler.black_holes();
        compiler.pooled(item, |params, sources| read(params, sources, &holes))
    },
};

fn read(
    params: &mut Params<'_, '_>,
    sources: &mut Sources<'_>,
    holes: &[(MediumId, BlackHole)],
) -> Option<AccretionDisk> {
    let AccretionDiskKeys { hole, temperature, luminance, pattern, against } =
        AccretionDiskKeys::read(params, sources)?;
    let Inside(medium) = hole.value;
    let Some((_, space)) = holes.iter().find(|(id, _)| *id == medium) else {
        let error = Diagnostic::error("gas goes around a `BlackHole`, which this medium is not");
        params.diagnostics().push(error.label(hole.item.head_span(), "another kind of medium"));
        return None;
    };
    Some(AccretionDisk { gas: OrbitingGas::new(space.clone(), !against, temperature, luminance), pattern })
}
