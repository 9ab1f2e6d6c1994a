//! A medium whose density is given at the voxels of a grid that is mostly empty, placed by any affine map: clouds and smoke of OpenVDB.
//!
//! As in [`GridMedium`](super::GridMedium), values belong to the middles of voxels, and are interpolated linearly along the three axes of the
//! grid between them. The ray is taken to the space of the voxels, where the bounds on its stretches are.
//!
//! Voxels may hold a number, or three, of red, green and blue: then extinction has a colour `c` at each place, of which the density is the
//! largest part, `d = max(c)`, and each wavelength `i` has its share,
//!
//! ```text
//! sigma_t[i](x) = sigma_t[i] d(x) s[i](x),    0 <= s[i] <= 1
//! ```
//!
//! with `s` the reflectance of the colour `c / d`, so that bounds on the density hold for all wavelengths.
//!
//! Scene: `Media { GridMedium cloud { file cloud.vdb  grid density  density 20  albedo 1 } }`

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::{Aabb, Ray, Vec3};
use kajo_scene::{SparseVoxels, VoxelValue};

use super::voxel_cells::VoxelCells;
use super::{Coefficients, GridError, MajorantGrid, Majorants, Medium, PlacedVoxels, VelocityGrid};
use crate::motion::Shutter;
use crate::texture::{Textures, rgb_reflectance};

/// What a voxel holds of a medium.
pub trait DensityVoxel: VoxelValue {
    /// Whether the density has a colour.
    const IS_COLORED: bool;

    /// The density at a world-space point, interpolated: of one with a colour the largest part.
    fn density(grid: &PlacedVoxels<Self>, p: Vec3) -> f32;

    /// The same for each wavelength.
    fn spectral_density(grid: &PlacedVoxels<Self>, p: Vec3, wavelengths: &Wavelengths) -> Spectrum;
}

impl DensityVoxel for f32 {
    const IS_COLORED: bool = false;

    fn density(grid: &PlacedVoxels, p: Vec3) -> f32 {
        grid.at(p)
    }

    fn spectral_density(grid: &PlacedVoxels, p: Vec3, _: &Wavelengths) -> Spectrum {
        Spectrum::grey(grid.at(p))
    }
}

impl DensityVoxel for [f32; 3] {
    const IS_COLORED: bool = true;

    fn density(grid: &PlacedVoxels<[f32; 3]>, p: Vec3) -> f32 {
        grid.vector(p).max_element()
    }

    fn spectral_density(grid: &PlacedVoxels<[f32; 3]>, p: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        let color = grid.vector(p);
        let most = color.max_element();
        if most <= 0.0 {
            return Spectrum::BLACK;
        }
        rgb_reflectance((color / most).to_array(), wavelengths) * most
    }
}

/// A medium by voxels of which most may be empty.
#[derive(Clone, Debug)]
pub struct SparseGridMedium<T = f32> {
    coefficients: Coefficients,
    grid: PlacedVoxels<T>,
    /// In the space of the voxels.
    majorants: MajorantGrid,
    /// Around all of it in the world.
    bounds: Aabb,
    /// How it moves, where it does.
    motion: Option<Box<GridMotion>>,
}

/// How many times as far as a grid is wide its matter may go while the shutter is open.
const MOST_WIDTHS: f32 = 100.0;

/// How the matter of a grid moves.
#[derive(Clone, Debug)]
struct GridMotion {
    velocities: VelocityGrid,
    /// Bounds at the moment that the grid is of.
    resting: MajorantGrid,
}

impl<T: DensityVoxel> SparseGridMedium<T> {
    /// * `coefficients`: of the density 1
    ///
    /// # Errors
    /// [`GridError::Voxel`] for a density that is none.
    pub fn new(coefficients: Coefficients, grid: PlacedVoxels<T>) -> Result<SparseGridMedium<T>, GridError> {
        let extent = grid.extent();
        let bounds = grid.transform.bounds(&extent);
        let majorants = majorants(&grid.voxels, extent)?;
        Ok(SparseGridMedium { coefficients, grid, majorants, bounds, motion: None })
    }

    /// The same medium, carried along while the shutter is open.
    #[must_use]
    pub fn with_velocities(self, velocities: VelocityGrid) -> SparseGridMedium<T> {
        let resting = self.majorants.clone();
        SparseGridMedium { motion: Some(Box::new(GridMotion { velocities, resting })), ..self }
    }

    /// Whether a world-space point is where there may be any of it: matter that moves is nowhere but where it was.
    fn may_hold(&self, p: Vec3) -> bool {
        self.motion.is_none() || self.grid.contains(p)
    }
}

/// Bounds on what interpolation makes of voxels, by cells of their box.
fn majorants<T: VoxelValue>(voxels: &SparseVoxels<T>, extent: Aabb) -> Result<MajorantGrid, GridError> {
    let cells = VoxelCells::new(voxels.size());
    let mut wrong = None;
    let join = |[a, b]: [f32; 2], [c, d]: [f32; 2]| [a.min(c), b.max(d)];
    let extremes = |voxel, held: T| {
        held.numbers().iter().fold([f32::INFINITY, 0.0], |range, &value| {
            if !value.is_finite() || value < 0.0 {
                wrong = wrong.or(Some(GridError::Voxel { voxel, value }));
            }
            join(range, [value; 2])
        })
    };
    let ranges = cells.fold(voxels, [f32::INFINITY, 0.0], extremes, join);
    match wrong {
        Some(error) => Err(error),
        None => Ok(MajorantGrid::new(extent, cells.count(), |cell| ranges[cells.index(cell)])),
    }
}

impl<T: DensityVoxel> Medium for SparseGridMedium<T> {
    fn is_finite(&self) -> bool {
        self.bounds.is_finite()
    }

    #[inline]
    fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    fn density(&self, _textures: &Textures, p: Vec3) -> f32 {
        if self.may_hold(p) { T::density(&self.grid, p) } else { 0.0 }
    }

    fn has_colored_density(&self) -> bool {
        T::IS_COLORED
    }

    fn spectral_density(&self, _textures: &Textures, p: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        if self.may_hold(p) { T::spectral_density(&self.grid, p, wavelengths) } else { Spectrum::BLACK }
    }

    fn velocities(&self) -> Option<&VelocityGrid> {
        self.motion.as_ref().map(|motion| &motion.velocities)
    }

    fn expose(&mut self, shutter: Shutter) {
        let Some(motion) = &mut self.motion else { return };
        motion.velocities.expose(shutter);
        let GridMotion { velocities, resting } = &**motion;
        let extent = self.grid.extent();
        let reach = self.grid.local(&velocities.reach(&self.grid.transform.bounds(&extent)));
        if !velocities.moves() {
            self.majorants = resting.clone();
            self.bounds = self.grid.transform.bounds(&extent);
            return;
        }
        if !reach.extent().cmple(MOST_WIDTHS * extent.extent().max_element() * Vec3::ONE).all() {
            self.bounds = Aabb::EVERYWHERE;
            return;
        }
        // A cell of all places where matter ever is has the bounds of those that it may come from.
        let cells = VoxelCells::new(reach.extent().to_array().map(|length| length.ceil() as u32));
        let width = reach.extent() / Vec3::from(cells.count().map(|n| n as f32));
        self.majorants = MajorantGrid::new(reach, cells.count(), |cell| {
            let corner = reach.min + width * Vec3::from(cell.map(|n| n as f32));
            let region = self.grid.transform.bounds(&Aabb { min: corner, max: corner + width });
            resting.range_in(&self.grid.local(&velocities.sources(&region)))
        });
        self.bounds = self.grid.transform.bounds(&reach);
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.bounds)
    }

    fn majorants(&self, ray: &Ray) -> Majorants<'_> {
        Majorants::cells(self.majorants.walk(&self.grid.transform.ray_in_object(ray)))
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, rng::Stream, warp};
    use kajo_scene::{Assets, Limits, MemoryAssets, VoxelGrid, read_vdb};
    use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

    use super::*;
    use crate::medium::{DensityGrid, GridMedium, Phase, affine};

    /// As the file that it would be in.
    fn read(grid: VdbGrid) -> VoxelGrid<f32> {
        let file =
            VdbFile { version: 224, compression: VdbCompression::None, masks: true, grids: vec![grid] };
        let assets = MemoryAssets::new().with("v", file.to_bytes());
        read_vdb(assets.open("v", "").unwrap(), 0, &Limits::default()).unwrap()
    }

    fn medium(grid: VdbGrid) -> Result<SparseGridMedium, GridError> {
        let grid = read(grid);
        let coefficients = Coefficients::new([0.0; 3], [1.0; 3], Phase::Isotropic).unwrap();
        SparseGridMedium::new(coefficients, PlacedVoxels::new(grid.voxels, &affine(&grid.map)).unwrap())
    }

    /// Voxels of a box that are a number each, some of them 0; a block of one value, and one that is empty.
    fn values(size: [i32; 3]) -> impl Iterator<Item = ([i32; 3], f32)> {
        let [nx, ny, nz] = size;
        let all = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        all.enumerate().map(move |(k, index)| {
            let value = match index.map(|x| x >> 3) {
                [1, 1, 0] => 0.25,
                [0, 1, 1] => 0.0,
                _ => Stream::new(5, [k as u32, 0], 0).uniform(0).powi(3),
            };
            let is_corner = index == [0; 3] || index == size.map(|n| n - 1);
            (index, if is_corner { 1.0 } else { value })
        })
    }

    fn grid(size: [i32; 3], low: [i32; 3], map: VdbMap) -> VdbGrid {
        let mut grid = VdbGrid::new("density", VdbKind::Float, map);
        for (index, value) in values(size) {
            if value > 0.0 {
                grid.set([0, 1, 2].map(|axis| index[axis] + low[axis]), [value; 3]);
            }
        }
        grid
    }

    #[test]
    fn the_density_is_that_of_a_grid_with_all_voxels() {
        let (size, low) = ([21, 17, 30], [-5, 3, -11]);
        let sparse =
            medium(grid(size, low, VdbMap::ScaleTranslate([0.5, 0.25, 2.0], [1.0, 2.0, 3.0]))).unwrap();
        let dense =
            DensityGrid::new(size.map(|n| n as u32), values(size).map(|(_, value)| value).collect()).unwrap();
        let corner =
            |by: [f32; 3]| Vec3::new(1.0, 2.0, 3.0) + Vec3::new(0.5, 0.25, 2.0) * (Vec3::from(by) - 0.5);
        let first = low.map(|x| x as f32);
        let bounds = Aabb { min: corner(first), max: corner([0, 1, 2].map(|k| first[k] + size[k] as f32)) };
        let coefficients = Coefficients::new([0.0; 3], [1.0; 3], Phase::Isotropic).unwrap();
        let dense = GridMedium::new(coefficients, dense, bounds).unwrap();
        let found = sparse.bounds().unwrap();
        assert!(
            found.min.abs_diff_eq(bounds.min, 1e-3) && found.max.abs_diff_eq(bounds.max, 1e-3),
            "{found:?}"
        );
        let mut inside = 0;
        for i in 0..20_000 {
            let number = Stream::new(8, [i, 1], 0);
            let p = bounds.min
                + Vec3::new(number.uniform(0), number.uniform(1), number.uniform(2)) * bounds.extent();
            let found = sparse.density(&Textures::default(), p);
            let expected = dense.density(&Textures::default(), p);
            assert!((found - expected).abs() < 2e-4, "{p}: {found} {expected}");
            inside += usize::from(found > 0.0);
        }
        assert!(inside > 10_000);
    }

    #[test]
    fn all_densities_are_between_their_bounds() {
        let turned = VdbMap::Affine([[0.3, 0.4, 0.0], [-0.4, 0.3, 0.1], [0.0, 0.2, -0.5]], [1.0, -2.0, 0.5]);
        for (size, map) in
            [([21, 17, 30], VdbMap::Uniform(0.1)), ([300, 2, 3], turned), ([16, 9, 20], turned)]
        {
            let medium = medium(grid(size, [-7, 1, 130], map)).unwrap();
            let bounds = medium.bounds().unwrap();
            let mut met = 0;
            for i in 0..2000 {
                let number = Stream::new(8, [i, 1], 0);
                let u = |k| number.uniform(k);
                let d = warp::uniform_sphere(Vec2::new(u(0), u(1)));
                let middle = bounds.min + Vec3::new(u(2), u(3), u(4)) * bounds.extent();
                let ray = Ray::new(middle - 80.0 * d, d);
                for m in medium.majorants(&ray) {
                    met += 1;
                    for k in 0..8 {
                        let p = ray.at(m.t_min + (k as f32 + 0.5) / 8.0 * (m.t_max - m.t_min));
                        let density = medium.density(&Textures::default(), p);
                        assert!(density <= m.density * 1.001 + 1e-4, "{size:?} {p}: {density} {m:?}");
                        assert!(density >= m.least * 0.999 - 1e-4, "{size:?} {p}: {density} {m:?}");
                        assert!(bounds.padded(1e-4).contains(p), "{p}");
                    }
                }
            }
            assert!(met > 100, "{met}");
        }
    }

    /// Of a colour the largest part is the density, whose bounds hold for all wavelengths.
    #[test]
    fn colours_are_densities() {
        let mut grid = VdbGrid::new("Cd", VdbKind::Vec3, VdbMap::Uniform(1.0));
        grid.set([0, 0, 0], [4.0, 2.0, 0.0]);
        grid.set([1, 0, 0], [0.0, 1.0, 2.0]);
        grid.set([3, 0, 0], [0.0; 3]);
        let file =
            VdbFile { version: 224, compression: VdbCompression::None, masks: true, grids: vec![grid] };
        let assets = MemoryAssets::new().with("v", file.to_bytes());
        let read: VoxelGrid<[f32; 3]> =
            read_vdb(assets.open("v", "").unwrap(), 0, &Limits::default()).unwrap();
        let coefficients = Coefficients::new([0.0; 3], [1.0; 3], Phase::Isotropic).unwrap();
        let placed = PlacedVoxels::new(read.voxels, &affine(&read.map)).unwrap();
        let medium = SparseGridMedium::new(coefficients, placed).unwrap();
        assert!(medium.has_colored_density());
        for (x, density, colors) in [
            (0.0, 4.0, [4.0, 2.0, 0.0]),
            (0.25, 3.0, [3.0, 1.75, 0.5]),
            (0.5, 2.0, [2.0, 1.5, 1.0]),
            (0.75, 1.5, [1.0, 1.25, 1.5]),
            (1.5, 1.0, [0.0, 0.5, 1.0]),
            (2.5, 0.0, [0.0; 3]),
        ] {
            let p = Vec3::new(x, 0.0, 0.0);
            assert_eq!(medium.density(&Textures::default(), p), density, "{x}");
            let found = medium.spectral_density(&Textures::default(), p, &Wavelengths::RGB).to_rgb();
            assert!((0..3).all(|i| (found[i] - colors[i]).abs() < 1e-6), "{x}: {found:?}");
            for u in [0.2, 0.6] {
                let wavelengths = Wavelengths::sample(u);
                let found = medium.spectral_density(&Textures::default(), p, &wavelengths);
                assert!((0..4).all(|i| (0.0..=density).contains(&found[i])), "{x} {u}: {found:?}");
            }
            let ray = Ray::new(p, Vec3::Y);
            let most = medium.majorants(&ray).map(|m| m.density).fold(0.0, f32::max);
            assert!(most >= density, "{x}: {most}");
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            let mut grid = grid([9, 9, 9], [0; 3], VdbMap::Uniform(1.0));
            grid.set([8, 2, 1], [value; 3]);
            let error = medium(grid).err();
            assert!(matches!(error, Some(GridError::Voxel { voxel: [8, 2, 1], .. })), "{error:?}");
            let mut tile = VdbGrid::new("d", VdbKind::Float, VdbMap::Uniform(1.0));
            tile.tile(7, [0; 3], [value; 3], true);
            assert!(medium(tile).is_err());
        }
    }
}
