//! Patterns that are tiles: bricks, hexagons, cubes.

use kajo_math::pattern::{Brick, Cells, Checks, Hexagons};

use super::{SEED, SeedKeys, pattern_member};
use crate::compile::fields::{Keys, between, keys, number, positive};

keys! {
    BrickKeys {
        height: f32 = positive("courseHeight").unit("size").or(0.375, "height of a course, of bricks of length 1"),
        mortar: f32 = between("mortar", 0.0, 1.0).unit("size").or(0.0625, "width of the joints"),
        shift: f32 = number("shift").or(0.5, "by which part of a brick each course is moved"),
        variation: f32 = between("variation", 0.0, 1.0).or(0.0, "by how much some bricks are darker"),
        seed: u32 = SEED,
    }
}

keys! {
    TileKeys {
        mortar: f32 = between("mortar", 0.0, 1.0).unit("size").or(0.0625, "width of the joints"),
        variation: f32 = between("variation", 0.0, 1.0).or(0.0, "by how much some tiles are darker"),
        seed: u32 = SEED,
    }
}

pattern_member!(
    BRICK,
    "Brick",
    "bricks in courses across y, the same along z",
    [BrickKeys],
    |params, sources| {
        let BrickKeys { height, mortar, shift, variation, seed } = BrickKeys::read(params, sources)?;
        Brick { height, mortar, shift, variation, seed }
    }
);

pattern_member!(
    HEXAGONS,
    "Hexagons",
    "six-sided tiles in x and y, the same along z",
    [TileKeys],
    |params, sources| {
        let TileKeys { mortar, variation, seed } = TileKeys::read(params, sources)?;
        Hexagons { mortar, variation, seed }
    }
);

pattern_member!(
    CELLS,
    "Cells",
    "cubes, each with a number that is drawn for it",
    [SeedKeys],
    |params, sources| { Cells { seed: SeedKeys::read(params, sources)?.seed } }
);

pattern_member!(CHECKS, "Checks", "cubes that are 0 and 1 by turns", [], |_params, _sources| Checks);
