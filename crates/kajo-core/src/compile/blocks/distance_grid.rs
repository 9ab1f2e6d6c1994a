//! `DistanceGrid`: a surface through numbers on a grid.

use kajo_scene::{Diagnostic, Item, Params};

use crate::compile::Compiler;
use crate::compile::fields::{Keys, Sources, flag, keys, number};
use crate::compile::graphics_state::{CurrentTransform, GraphicsState};
use crate::compile::grid::{GridKeys, VoxelValues, grid_keys};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::{DistanceGrid, ShapeId};

keys! {
    DistanceGridKeys {
        level: f32 = number("level").or(0.0, "what the surface is at; lower numbers are inside"),
        closed: bool = flag("closed").or(true, "whether faces of the box close it where they cut it"),
        smooth: bool = flag("smooth").or(true, "shaded by interpolated normals"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "DistanceGrid",
        kind: Kind::Shape,
        about: "the surface through numbers on a grid, such as signed distances",
        groups: &[GridKeys::FIELDS, DistanceGridKeys::FIELDS],
        parts: &[],
    },
    read: place_distance_grid,
};

fn place_distance_grid(
    compiler: &mut Compiler<'_>,
    item: Item<'_>,
    ctm: &mut CurrentTransform,
    state: &mut GraphicsState,
) {
    let shape =
        compiler.read_keys(item, read).and_then(|(grid, keys)| compiler.distance_grid(item, grid, keys));
    compiler.put_shape(shape, item, ctm, state);
}

fn read<'t>(
    params: &mut Params<'t, '_>,
    sources: &mut Sources<'_>,
) -> Option<(GridKeys<'t>, DistanceGridKeys)> {
    params.name();
    let (grid, keys) = (grid_keys(params, sources), DistanceGridKeys::read(params, sources));
    Some((grid?, keys?))
}

impl Compiler<'_> {
    fn distance_grid(
        &mut self,
        item: Item<'_>,
        grid: GridKeys<'_>,
        keys: DistanceGridKeys,
    ) -> Option<ShapeId> {
        let DistanceGridKeys { level, closed, smooth } = keys;
        let VoxelValues { size, values, bounds } = self.grid(item, grid)?;
        match DistanceGrid::new(size, values, bounds, level, [closed, smooth]) {
            Ok(grid) => {
                if grid.is_empty() {
                    let warning = Diagnostic::warning("there is no surface in this grid");
                    let help = "all numbers are on one side of `level`";
                    self.diagnostics
                        .push(warning.label(item.head_span(), "nothing is to be seen of this").help(help));
                }
                self.shape(item, grid)
            }
            Err(error) => {
                let error = Diagnostic::error(error.to_string());
                self.diagnostics.push(error.label(item.head_span(), "no such surface"));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Ray, Vec3};
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};
    use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

    use crate::compile::{CompileOptions, compile};
    use crate::scene::Scene;

    fn compiled(object: &str) -> Result<Scene, String> {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0 {object} }}"
        );
        let raw: Vec<u8> = [-1.0_f32, 1.0].iter().cycle().take(8).flat_map(|x| x.to_le_bytes()).collect();
        // A ball of radius 3 around (2, 0, 0), by voxels of half a unit.
        let mut ball =
            VdbGrid::new("ball", VdbKind::Float, VdbMap::ScaleTranslate([0.5; 3], [2.0, 0.0, 0.0]));
        for k in 0..17 * 17 * 17 {
            let index = [k % 17 - 8, k / 17 % 17 - 8, k / 289 - 8];
            let r2 = index.iter().map(|x| x * x).sum::<i32>() as f32;
            ball.set(index, [0.5 * r2.sqrt() - 3.0; 3]);
        }
        let mut turned = ball.clone();
        turned.map = VdbMap::Affine([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]);
        let vdb = |grid| {
            VdbFile { version: 224, compression: VdbCompression::Blosc, masks: true, grids: vec![grid] }
                .to_bytes()
        };
        let assets = MemoryAssets::new().with("steps.raw", raw).with("short.raw", [0_u8; 7]);
        let assets = assets.with("ball.vdb", vdb(ball)).with("turned.vdb", vdb(turned));
        let mut parsed = SceneDesc::parse_str(&text);
        let mut diagnostics = Diagnostics::default();
        let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        let said: Vec<String> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join(" / "))
    }

    /// The x at which a ray along x from far away meets a scene first.
    fn first(scene: &Scene, y: f32, d: f32) -> Option<f32> {
        let met = scene.trace(&Ray::new(Vec3::new(-16.0 * d, y, 0.25), Vec3::new(d, 0.0, 0.0)));
        met.surface().map(|at| at.point.p.x)
    }

    #[test]
    fn grids_are_where_they_are_written() {
        let wall = "size 2 2 2  values -1 1 -1 1 -1 1 -1 1";
        for source in [wall, "file steps.raw  size 2 2 2"] {
            let closed = compiled(&format!("DistanceGrid {{ {source} }}")).unwrap();
            assert_eq!((first(&closed, 0.5, 1.0), first(&closed, 0.5, -1.0)), (Some(-1.0), Some(0.0)));
            let open = compiled(&format!("DistanceGrid {{ {source}  closed off  level 0.5 }}")).unwrap();
            assert_eq!((first(&open, 0.5, 1.0), first(&open, 1.5, 1.0)), (Some(0.5), None));
            let moved = compiled(&format!("DistanceGrid {{ {source}  min 2 0 0  max 6 1 1 }}")).unwrap();
            assert_eq!(first(&moved, 0.5, -1.0), Some(4.0));
        }
    }

    #[test]
    fn level_sets_are_surfaces() {
        let scene = compiled("DistanceGrid { file ball.vdb }").unwrap();
        // The ray is a quarter beside the middle; between the numbers the function is linear, not a distance.
        let half = (9.0f32 - 0.0625).sqrt();
        for (d, expected) in [(1.0, 2.0 - half), (-1.0, 2.0 + half)] {
            let x = first(&scene, 0.0, d).unwrap();
            assert!((x - expected).abs() < 0.015, "{x} {expected}");
        }
        let moved = compiled("DistanceGrid { file turned.vdb  min -8 -8 -8  max 8 8 8 }").unwrap();
        let x = first(&moved, 0.0, 1.0).unwrap();
        assert!((x + 6.0).abs() < 0.04, "{x}");
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        for (object, words) in [
            ("DistanceGrid { }", "`DistanceGrid` needs `file`"),
            ("DistanceGrid { values 1 1 1 1 1 1 1 1 }", "needs `size`"),
            ("DistanceGrid { size 2 2 2  values 1 1 1 }", "2 x 2 x 2 numbers make no surface"),
            ("DistanceGrid { size 1 1 1  values 1 }", "1 x 1 x 1 numbers make no surface"),
            ("DistanceGrid { size 2 2 2  values 1 1 1 1 1 1 1 1 }", "there is no surface in this grid"),
            (
                "DistanceGrid { size 2 2 2  values 1 1 1 1 1 1 1 0  min 1 1 1  max 0 2 2 }",
                "less than that of `max`",
            ),
            ("DistanceGrid { file turned.vdb }", "turned in the world: write `min` and `max`"),
            ("DistanceGrid { file nowhere.vol }", "there is no such file"),
            ("DistanceGrid { file short.raw  size 2 2 2 }", "ends after"),
            ("DistanceGrid { file steps.raw  size 4000000000 4000000000 4000000000 }", "steps.raw"),
        ] {
            let said = compiled(object).err().unwrap_or_default();
            assert!(said.contains(words), "{object}: {said}");
        }
    }
}
