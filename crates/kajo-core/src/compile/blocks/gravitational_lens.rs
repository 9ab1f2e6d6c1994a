//! `GravitationalLens`: a mass in a plane that turns light.

use kajo_math::Vec3;
use kajo_math::gravity::ThinLens;
use kajo_scene::{Diagnostic, Params};

use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{Direction, Keys, Sources, at_least, between, direction, keys, point};
use crate::compile::member::{MaterialMember, Member};
use crate::material::GravitationalLens;
use crate::schema::{Block, Kind};

keys! {
    GravitationalLensKeys {
        center: Vec3 = point("center").or([0.0; 3], "its middle"),
        mass: f32 = at_least("mass", 0.0).unit("length").or(0.0, "of a point: light at the distance b is turned by 4 mass / b"),
        dispersion: f32 = between("dispersion", 0.0, 0.25)
            .or(0.0, "of the velocities of a galaxy's stars, over that of light: turns light by 4 pi dispersion^2"),
        axis_ratio: f32 = between("axisRatio", 0.01, 1.0).or(1.0, "how flat the galaxy is seen"),
        axis: Direction = direction("axis").or([1.0, 0.0, 0.0], "where it is longer"),
        core: f32 = at_least("core", 0.0).unit("length").or(0.0, "radius within which all mass is spread out"),
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "GravitationalLens",
        kind: Kind::Material,
        about: "the plane of a mass that turns the light of what is far behind it",
        groups: &[GravitationalLensKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.pooled(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<GravitationalLens> {
    let GravitationalLensKeys { center, mass, dispersion, axis_ratio, axis, core } =
        GravitationalLensKeys::read(params, sources)?;
    if mass == 0.0 && dispersion == 0.0 {
        let warning = Diagnostic::warning("a lens without mass turns no light");
        params.report(warning.help("say its `mass`, or the `dispersion` of a galaxy"), "turns nothing");
    }
    let [mass, dispersion, axis_ratio, core] = [mass, dispersion, axis_ratio, core].map(f64::from);
    let lens = ThinLens::new([mass, dispersion], axis_ratio, core);
    Some(GravitationalLens { center, axis: axis.0, lens })
}
