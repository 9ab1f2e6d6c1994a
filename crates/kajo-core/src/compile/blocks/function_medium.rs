//! `FunctionMedium`: haze or a cloud whose density is a function of the place.

use std::sync::Arc;

use kajo_math::tape::Tape;
use kajo_math::{Aabb, Vec3};
use kajo_scene::{Diagnostic, Params};

use super::medium::{CoefficientKeys, coefficients};
use super::phase::PhaseKeys;
use crate::compile::fields::{Keys, Sources, function, keys, point};
use crate::compile::member::{MediumMember, Member};
use crate::medium::FunctionMedium;
use crate::schema::{Block, Kind};

keys! {
    FunctionKeys {
        function: Arc<Tape> = function("function").required("its density; where it is negative there is nothing"),
        min: Vec3 = point("min").or([-1.0; 3], "the corner of its box with the smallest coordinates"),
        max: Vec3 = point("max").or([1.0; 3], "the corner of its box with the largest coordinates"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "FunctionMedium",
        kind: Kind::Medium,
        about: "haze or a cloud by a function of the place",
        groups: &[FunctionKeys::FIELDS, CoefficientKeys::FIELDS, PhaseKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.medium(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<FunctionMedium> {
    let keys = FunctionKeys::read(params, sources);
    let coefficients = coefficients(params, sources);
    let (FunctionKeys { function, min, max }, coefficients) = (keys?, coefficients?);
    let made = FunctionMedium::new(coefficients, function, Aabb { min, max });
    let report = |error| params.report(Diagnostic::error(format!("{error}")), "no such medium");
    made.map_err(report).ok()
}
