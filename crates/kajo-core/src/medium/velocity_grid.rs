//! How the matter of a grid moves while the shutter is open: a velocity at each place, as simulations of fluids write it.
//!
//! What is at `x` at the time `t` was at `q` at the time `t₀` that the grids of the file are of, and goes straight on until the shutter closes,
//!
//! ```text
//! x = q + (t - t₀) v(q),    q₁ = x - (t - t₀) v(x),    q₂ = x - (t - t₀) v(q₁)
//! ```
//!
//! with the velocity `v`; the second of these steps is taken for `q` [Kim and Ko 2007]. Density, temperature and colour at `x`
//! are those at `q`: matter is carried along and is neither thinned nor gathered.
//!
//! Scene: `Media { GridMedium smoke { file smoke.vdb  density 20  velocity vel } }`

use kajo_math::{Aabb, Affine3A, DMat3, Mat3, Vec3};
use kajo_scene::VoxelValue;

use super::PlacedVoxels;
use super::voxel_cells::{VoxelCells, cells_of};
use crate::motion::Shutter;

/// More than any shutter is open for, and far from what a number cannot hold.
const LONGEST: f32 = 1e30;

/// The components of a velocity, as files hold them.
#[derive(Clone, Debug)]
pub enum VelocityComponents {
    /// Three in each voxel.
    Together(PlacedVoxels<[f32; 3]>),
    /// A grid for each.
    Apart(Box<[PlacedVoxels; 3]>),
}

impl VelocityComponents {
    /// The numbers at a world-space point; outside of the box of a grid those of its nearest voxel.
    fn at(&self, p: Vec3) -> Vec3 {
        match self {
            VelocityComponents::Together(grid) => grid.vector(p),
            VelocityComponents::Apart(grids) => Vec3::from([0, 1, 2].map(|axis| grids[axis].at(p))),
        }
    }

    /// A voxel whose numbers are not all finite, with its place from the corner of its box.
    pub fn not_finite(&self) -> Option<([u32; 3], f32)> {
        match self {
            VelocityComponents::Together(grid) => {
                let (voxel, value) = grid.find(|value| value.iter().any(|v| !v.is_finite()))?;
                value.into_iter().find(|v| !v.is_finite()).map(|v| (voxel, v))
            }
            VelocityComponents::Apart(grids) => grids.iter().find_map(PlacedVoxels::not_finite),
        }
    }
}

/// Velocities by place.
#[derive(Clone, Debug)]
pub struct VelocityGrid {
    components: VelocityComponents,
    /// From the numbers of the file to velocities in the world.
    world_from_file: Mat3,
    /// Bounds on the numbers: of all together, or of each.
    ranges: Vec<Ranges>,
    /// From the moment that the grids are of to those at which the shutter opens and closes.
    elapsed: [f32; 2],
}

/// Between which numbers a grid is, cell by cell.
#[derive(Clone, Debug)]
struct Ranges {
    cells: VoxelCells,
    /// Least and largest numbers of each cell, x first.
    each: Vec<Aabb>,
    /// Those of all.
    all: Aabb,
}

impl Ranges {
    fn new<T: VoxelValue>(grid: &PlacedVoxels<T>, vector: impl Fn(T) -> Vec3) -> Ranges {
        let cells = VoxelCells::new(grid.voxels.size());
        let of_voxel = |_, value| {
            let v = vector(value);
            Aabb { min: v, max: v }
        };
        let each = cells.fold(&grid.voxels, Aabb::EMPTY, of_voxel, Aabb::union);
        let all = each.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        Ranges { cells, each, all }
    }

    /// Around the numbers in a box of the grid's own space.
    fn over(&self, region: &Aabb) -> Aabb {
        let touched = cells_of(self.cells.touched(region));
        touched.map(|cell| self.each[self.cells.index(cell)]).fold(Aabb::EMPTY, Aabb::union)
    }
}

impl VelocityGrid {
    /// * `components`: all finite
    /// * `world_from_file`: from their numbers to velocities in the world, per unit of the time of the shutter
    pub fn new(components: VelocityComponents, world_from_file: &DMat3) -> VelocityGrid {
        let ranges = match &components {
            VelocityComponents::Together(grid) => vec![Ranges::new(grid, Vec3::from)],
            VelocityComponents::Apart(grids) => {
                (0..3).map(|axis| Ranges::new(&grids[axis], |v| v * Vec3::AXES[axis])).collect()
            }
        };
        VelocityGrid { components, world_from_file: world_from_file.as_mat3(), ranges, elapsed: [0.0; 2] }
    }

    /// Whether any place of a ray of any time has other matter than at the moment that the grids are of.
    pub fn moves(&self) -> bool {
        self.elapsed != [0.0; 2]
    }

    /// Is seen through a shutter: the grids are of the moment 0 of its time, which in an animation is that of the frame.
    pub(super) fn expose(&mut self, shutter: Shutter) {
        self.elapsed = shutter.interval().map(|moment| (moment as f32).clamp(-LONGEST, LONGEST));
    }

    /// Where the matter that is at a point at a ray's time was at the moment that the grids are of, all in world space.
    ///
    /// * `time`: moment within the shutter interval
    pub fn source(&self, p: Vec3, time: f32) -> Vec3 {
        let [open, close] = self.elapsed;
        let elapsed = open + time * (close - open);
        if elapsed == 0.0 {
            return p;
        }
        let first = p - elapsed * self.velocity(p);
        p - elapsed * self.velocity(first)
    }

    /// The velocity at a world-space point at the moment that the grids are of.
    fn velocity(&self, p: Vec3) -> Vec3 {
        self.world_from_file * self.components.at(p)
    }

    /// A box around where the matter comes from that is ever in a world-space box.
    pub(super) fn sources(&self, region: &Aabb) -> Aabb {
        let first = self.moved(region, &self.over(region), -1.0);
        self.moved(region, &self.over(&first), -1.0)
    }

    /// A world-space box around all matter of a world-space box at all times.
    pub(super) fn reach(&self, region: &Aabb) -> Aabb {
        let all = self.ranges.iter().map(|ranges| ranges.all);
        let moved = self.moved(region, &self.in_world(all), 1.0);
        moved.union(*region)
    }

    /// Around the velocities in a world-space box.
    fn over(&self, region: &Aabb) -> Aabb {
        let local = |part: usize| match &self.components {
            VelocityComponents::Together(grid) => grid.local(region),
            VelocityComponents::Apart(grids) => grids[part].local(region),
        };
        let parts = self.ranges.iter().enumerate();
        self.in_world(parts.map(|(part, ranges)| ranges.over(&local(part))))
    }

    /// Around velocities in the world whose components are between bounds: of all together, or the sum of those of each.
    fn in_world(&self, bounds: impl Iterator<Item = Aabb>) -> Aabb {
        let sum = |a: Aabb, b: Aabb| Aabb { min: a.min + b.min, max: a.max + b.max };
        let bounds = bounds.reduce(sum).unwrap_or(Aabb { min: Vec3::ZERO, max: Vec3::ZERO });
        bounds.transformed(&Affine3A::from_mat3(self.world_from_file))
    }

    /// Around the points of a box that go on for all times of the shutter.
    ///
    /// * `velocities`: between these
    /// * `sign`: -1 for the way back
    fn moved(&self, region: &Aabb, velocities: &Aabb, sign: f32) -> Aabb {
        let ways = self.elapsed.map(|t| [velocities.min * (sign * t), velocities.max * (sign * t)]);
        let ways = Aabb::around(ways.into_iter().flatten());
        Aabb { min: region.min + ways.min, max: region.max + ways.max }
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::rng::Stream;
    use kajo_math::{Ray, Vec2, warp};
    use kajo_scene::{Assets, Limits, MemoryAssets, VoxelGrid, read_vdb};
    use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

    use super::*;
    use crate::medium::{Coefficients, Medium, Phase, SparseGridMedium, affine};
    use crate::texture::Textures;

    fn read<T: VoxelValue>(grid: VdbGrid) -> PlacedVoxels<T> {
        let file =
            VdbFile { version: 224, compression: VdbCompression::None, masks: true, grids: vec![grid] };
        let assets = MemoryAssets::new().with("v", file.to_bytes());
        let read: VoxelGrid<T> = read_vdb(assets.open("v", "").unwrap(), 0, &Limits::default()).unwrap();
        PlacedVoxels::new(read.voxels, &affine(&read.map)).unwrap()
    }

    /// A grid of `size` whose numbers are given by place.
    fn filled(size: [i32; 3], map: VdbMap, of: impl Fn([i32; 3]) -> [f32; 3]) -> VdbGrid {
        let mut grid = VdbGrid::new("v", VdbKind::Vec3, map);
        for k in 0..size.iter().product() {
            let place = [k % size[0], k / size[0] % size[1], k / (size[0] * size[1])];
            grid.set(place, of(place));
        }
        grid
    }

    fn random(seed: u32, [x, y, z]: [i32; 3]) -> [f32; 3] {
        let numbers = Stream::new(seed.into(), [x as u32, y as u32], z as u32);
        [0, 1, 2].map(|k| 2.0 * numbers.uniform(k) - 1.0)
    }

    /// Of a velocity that is the same everywhere the source is exact, and of one that grows with the place nearly.
    #[test]
    fn matter_comes_from_where_its_velocity_says() {
        let even = filled([4; 3], VdbMap::Uniform(0.5), |_| [1.0, 2.0, -4.0]);
        let turn = DMat3::from_cols_array(&[0.0, 2.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let mut even = VelocityGrid::new(VelocityComponents::Together(read(even)), &turn);
        let p = Vec3::new(0.3, 0.1, 0.7);
        assert_eq!(even.source(p, 0.5), p);
        even.expose(Shutter::new(-0.25, 0.75));
        assert!(even.moves());
        for (time, elapsed) in [(0.0, -0.25), (0.25, 0.0), (1.0, 0.75)] {
            let expected = p - elapsed * Vec3::new(-4.0, 2.0, -4.0);
            assert!(even.source(p, time).abs_diff_eq(expected, 1e-5), "{time}");
        }
        // v = x / 10, so that x = q (1 + t / 10).
        let grow = |axis: usize| {
            let mut grid = filled([9; 3], VdbMap::Uniform(1.0), |p| [0.1 * p[axis] as f32; 3]);
            grid.kind = VdbKind::Float;
            read(grid)
        };
        let apart = VelocityComponents::Apart(Box::new([grow(0), grow(1), grow(2)]));
        let mut apart = VelocityGrid::new(apart, &DMat3::IDENTITY);
        apart.expose(Shutter::new(0.0, 1.0));
        let p = Vec3::new(2.0, 5.0, 7.0);
        // Two steps of the iteration leave the third power of 1/10.
        assert!(apart.source(p, 1.0).abs_diff_eq(p / 1.1, 1e-3 * 7.0), "{}", apart.source(p, 1.0));
    }

    /// Whatever the places of both grids, their maps and the shutter, each density is between the bounds of its stretch, and none is outside
    /// of the box.
    #[test]
    fn all_densities_that_move_are_between_their_bounds() {
        let turned = VdbMap::Affine([[0.3, 0.4, 0.0], [-0.4, 0.3, 0.1], [0.0, 0.2, -0.5]], [1.0, -2.0, 0.5]);
        let scaled = VdbMap::ScaleTranslate([1.5, 0.9, 2.0], [-4.0, 1.0, -3.0]);
        let mut met = 0;
        for (seed, maps, shutter) in [
            (1, [VdbMap::Uniform(0.5), VdbMap::Uniform(0.5)], [0.0, 1.0]),
            (2, [turned, scaled], [-0.5, 2.0]),
            (3, [scaled, turned], [0.5, 0.5]),
        ] {
            let dense = filled([30, 11, 18], maps[0], |p| random(seed, p).map(|v| v.max(0.0).powi(3)));
            let mut dense = dense;
            dense.kind = VdbKind::Float;
            let speeds = filled([12, 20, 9], maps[1], |p| random(seed + 10, p).map(|v| 3.0 * v));
            let coefficients = Coefficients::new([0.0; 3], [1.0; 3], Phase::Isotropic).unwrap();
            let velocities = VelocityGrid::new(VelocityComponents::Together(read(speeds)), &DMat3::IDENTITY);
            let medium = SparseGridMedium::<f32>::new(coefficients, read(dense)).unwrap();
            let resting = medium.bounds().unwrap();
            let mut medium = medium.with_velocities(velocities);
            medium.expose(Shutter::new(shutter[0], shutter[1]));
            let (bounds, velocities) = (medium.bounds().unwrap(), medium.velocities().unwrap());
            assert!(bounds.half_area() > resting.half_area());
            for i in 0..1500 {
                let number = Stream::new(8, [i, 1], 0);
                let u = |k| number.uniform(k);
                let d = warp::uniform_sphere(Vec2::new(u(0), u(1)));
                let middle = resting.min + Vec3::new(u(2), u(3), u(4)) * resting.extent();
                let ray = Ray::new(middle - 80.0 * d, d);
                let mut spans = medium.majorants(&ray).peekable();
                for k in 0..400 {
                    let t = 60.0 + 0.1 * (k as f32 + u(5));
                    while spans.next_if(|span| span.t_max < t).is_some() {}
                    let span = spans.peek().filter(|span| span.t_min <= t);
                    let [least, most] = span.map_or([0.0; 2], |span| [span.least, span.density]);
                    let source = velocities.source(ray.at(t), u(6));
                    let density = medium.density(&Textures::default(), source);
                    met += usize::from(density > 0.0);
                    assert!(density <= most * 1.001 + 1e-4, "{seed} {t}: {density} {most}");
                    assert!(density >= least * 0.999 - 1e-4, "{seed} {t}: {density} {least}");
                    assert!(density == 0.0 || bounds.padded(1e-4).contains(ray.at(t)), "{seed} {t}");
                }
            }
        }
        assert!(met > 10_000, "{met}");
    }

    /// What goes too far to be seen has no bounds that are finite.
    #[test]
    fn what_is_too_fast_is_told() {
        let dense = || {
            let mut grid = filled([8; 3], VdbMap::Uniform(1.0), |_| [1.0; 3]);
            grid.kind = VdbKind::Float;
            read::<f32>(grid)
        };
        for (speed, is_lost) in [(10.0, false), (1e4, true), (3e38, true)] {
            let speeds = read(filled([2; 3], VdbMap::Uniform(1.0), |_| [0.0, speed, 0.0]));
            let velocities = VelocityGrid::new(VelocityComponents::Together(speeds), &DMat3::IDENTITY);
            let medium = SparseGridMedium::<f32>::new(Coefficients::clear(), dense()).unwrap();
            let mut medium = medium.with_velocities(velocities);
            for (close, is_lost) in [(1.0, is_lost), (0.0, false)] {
                medium.expose(Shutter::new(0.0, close));
                assert_eq!(medium.bounds().unwrap().is_finite(), !is_lost, "{speed} {close}");
            }
        }
        let endless = f64::from(f32::MAX) * 2.0;
        let speeds = read(filled([2; 3], VdbMap::Uniform(1.0), |_| [1.0; 3]));
        let velocities = VelocityGrid::new(VelocityComponents::Together(speeds), &DMat3::IDENTITY);
        let mut medium =
            SparseGridMedium::<f32>::new(Coefficients::clear(), dense()).unwrap().with_velocities(velocities);
        medium.expose(Shutter::new(0.0, endless));
        assert!(!medium.bounds().unwrap().is_finite());
    }
}
