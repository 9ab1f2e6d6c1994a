//! `IndexGrid`: clear matter that bends light, by numbers on a grid.

use std::sync::Arc;

use kajo_math::spline_grid::SplineGrid;
use kajo_scene::{Diagnostic, Item};

use super::gradient_index::{AbbeKeys, CurveKeys};
use crate::compile::Compiler;
use crate::compile::fields::{Keys, keys, number};
use crate::compile::grid::{GridKeys, VoxelValues, grid_keys};
use crate::compile::member::{MediumMember, Member};
use crate::medium::gradient_index::{IndexGrid, Profile};
use crate::schema::{Block, Kind};

keys! {
    IndexKeys {
        scale: f32 = number("scale").or(1.0, "what its numbers are multiplied by"),
        offset: f32 = number("offset").or(0.0, "index of refraction where the number is 0"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "IndexGrid",
        kind: Kind::Medium,
        about: "clear matter that bends light, by indices of refraction on a grid",
        groups: &[GridKeys::FIELDS, IndexKeys::FIELDS, AbbeKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        let read = compiler.read_keys(item, |params, sources| {
            params.name();
            let grid = grid_keys(params, sources);
            let index = IndexKeys::read(params, sources);
            let colors = AbbeKeys::read(params, sources);
            let curves = CurveKeys::read(params, sources);
            Some((grid?, index?, colors?, curves?))
        });
        let (grid, index, colors, curves) = read?;
        let profile = Profile::Grid(Arc::new(compiler.index_grid(item, grid, &index)?));
        let stored = compiler.scene.medium(curves.medium(profile, colors.dispersing()));
        compiler.accepted(stored, item.head_span())
    },
};

impl Compiler<'_> {
    /// The index that keys ask for; why there is none is reported.
    fn index_grid(&mut self, item: Item<'_>, grid: GridKeys<'_>, index: &IndexKeys) -> Option<IndexGrid> {
        let VoxelValues { size, mut values, bounds } = self.grid(item, grid)?;
        values.iter_mut().for_each(|value| *value = index.offset + index.scale * *value);
        let room = self.options.limits.memory.take(SplineGrid::bytes(size)).map_err(|over| over.to_string());
        let made =
            room.and_then(|()| IndexGrid::new(size, &values, bounds).map_err(|error| error.to_string()));
        let report = |message| {
            let error = Diagnostic::error(message).label(item.head_span(), "no such medium");
            self.diagnostics.push(error.help("the index is `offset` + `scale` times the number"));
        };
        made.map_err(report).ok()
    }
}
