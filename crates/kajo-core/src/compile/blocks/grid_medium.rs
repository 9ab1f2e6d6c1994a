//! `GridMedium`: a cloud or smoke whose density is given voxel by voxel.

use kajo_math::Aabb;
use kajo_scene::{Diagnostic, Item};

use super::medium::{CoefficientKeys, coefficients};
use crate::compile::Compiler;
use crate::compile::grid::{Grid, GridKeys, grid_keys};
use crate::compile::member::{MediumMember, Member};
use crate::medium::{Coefficients, DensityGrid, GridMedium};
use crate::schema::{Block, Kind};

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "GridMedium",
        kind: Kind::Medium,
        about: "a cloud or smoke, given voxel by voxel",
        groups: &[GridKeys::FIELDS, CoefficientKeys::FIELDS],
    },
    read: |compiler, item| {
        let read = compiler.read_keys(item, |params, sources| {
            params.name();
            let (keys, coefficients) = (grid_keys(params, sources), coefficients(params, sources));
            Some((keys?, coefficients?))
        });
        let (keys, coefficients) = read?;
        let medium = compiler.grid_medium(item, keys, coefficients)?;
        let stored = compiler.scene.medium(medium);
        compiler.accepted(stored, item.head_span())
    },
};

impl Compiler<'_> {
    fn grid_medium(
        &mut self,
        item: Item<'_>,
        keys: GridKeys<'_>,
        coefficients: Coefficients,
    ) -> Option<GridMedium> {
        let Grid { size, values, bounds: [min, max] } = self.grid(keys)?;
        let mut report = |message: String| {
            self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "no such medium"));
        };
        let grid = DensityGrid::new(size, values).map_err(|error| report(error.to_string())).ok()?;
        let medium = GridMedium::new(coefficients, grid, Aabb { min, max });
        if medium.is_none() {
            let message = "every coordinate of `min` must be less than that of `max`";
            self.diagnostics
                .push(Diagnostic::error(message).label(item.head_span(), "the box of this is empty"));
        }
        medium
    }
}
