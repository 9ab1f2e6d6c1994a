//! Numbers in the voxels of a file, at points of the world.

use std::ops::{Add, Mul, Sub};
use std::sync::Arc;

use kajo_math::{Aabb, DAffine3, DMat3, DVec3, Transform, Vec3};
use kajo_scene::{Block, GridMap, SparseVoxels, VoxelValue};

/// Numbers in voxels, and where they are in the world.
#[derive(Clone, Debug)]
pub struct PlacedVoxels<T = f32> {
    pub(super) voxels: Arc<SparseVoxels<T>>,
    /// Between the world and voxels, of which the first fills the unit cube.
    pub(super) transform: Transform,
}

impl<T: VoxelValue> PlacedVoxels<T> {
    /// * `map`: from voxels to the world
    ///
    /// `None` for a map that has no inverse.
    pub fn new(voxels: SparseVoxels<T>, map: &DAffine3) -> Option<PlacedVoxels<T>> {
        Some(PlacedVoxels { voxels: Arc::new(voxels), transform: Transform::new(map)? })
    }

    /// The box of the voxels, in their own space.
    pub(super) fn extent(&self) -> Aabb {
        Aabb { min: Vec3::ZERO, max: Vec3::from(self.voxels.size().map(|n| n as f32)) }
    }

    /// A box around a box of the world, in the space of the voxels.
    pub(super) fn local(&self, region: &Aabb) -> Aabb {
        region.transformed(&self.transform.object_from_world)
    }

    /// Whether a world-space point is in the box of the voxels.
    pub(super) fn contains(&self, p: Vec3) -> bool {
        self.extent().contains(self.transform.object_from_world.transform_point3(p))
    }

    /// A value that `is_wrong` says is none, with its place from the corner of the box.
    pub fn find(&self, is_wrong: impl Fn(T) -> bool) -> Option<([u32; 3], T)> {
        let mut found = None;
        let offset = self.voxels.offset();
        self.voxels.for_each_block(|low, high, block| {
            for x in low[0]..high[0] {
                for y in low[1]..high[1] {
                    for z in low[2]..high[2] {
                        let value = block.at([x + offset[0], y + offset[1], z + offset[2]]);
                        if is_wrong(value) {
                            found = found.or(Some(([x, y, z], value)));
                        }
                        if matches!(block, Block::Constant(_)) {
                            return;
                        }
                    }
                }
            }
        });
        found
    }

    /// The eight voxels between whose middles a world-space point is, with their weights; outside of the box those of the nearest point in it.
    pub(super) fn around(&self, p: Vec3, mut show: impl FnMut(T, f32)) {
        let p = self.transform.object_from_world.transform_point3(p);
        let last = self.voxels.size().map(|n| n - 1);
        let p = (p - 0.5).clamp(Vec3::ZERO, Vec3::from(last.map(|n| n as f32)));
        let low = p.to_array().map(|x| x as u32);
        let f = p - Vec3::from(low.map(|n| n as f32));
        let offset = self.voxels.offset();
        for corner in 0..8 {
            let is_high = [0, 1, 2].map(|axis| corner >> axis & 1 == 1);
            let weight = |axis: usize| if is_high[axis] { f[axis] } else { 1.0 - f[axis] };
            let weight = weight(0) * weight(1) * weight(2);
            if weight > 0.0 {
                let voxel = [0, 1, 2].map(|axis| (low[axis] + u32::from(is_high[axis])).min(last[axis]));
                let voxel = [0, 1, 2].map(|axis| voxel[axis] + offset[axis]);
                show(self.voxels.block(voxel).at(voxel), weight);
            }
        }
    }

    /// What lies between voxels at a point; outside of the box what is at the nearest point in it.
    ///
    /// * `p`: in the space of the voxels
    /// * `number`: what a voxel stands for
    #[inline]
    fn interpolated<V: Interpolable>(&self, p: Vec3, number: impl Fn(T) -> V) -> V {
        let last = self.voxels.size().map(|n| n - 1);
        let p = (p - 0.5).clamp(Vec3::ZERO, Vec3::from(last.map(|n| n as f32)));
        let low = p.to_array().map(|x| x as u32);
        let f = p - Vec3::from(low.map(|n| n as f32));
        let offset = self.voxels.offset();
        let high = [0, 1, 2].map(|axis| (low[axis] + 1).min(last[axis]) + offset[axis]);
        let low = [0, 1, 2].map(|axis| low[axis] + offset[axis]);
        if (0..3).all(|axis| low[axis] >> 3 == high[axis] >> 3) {
            return match self.voxels.block(low) {
                Block::Constant(value) => number(value),
                block => trilinear([low, high], f, |voxel| number(block.at(voxel))),
            };
        }
        trilinear([low, high], f, |voxel| number(self.voxels.block(voxel).at(voxel)))
    }
}

impl PlacedVoxels<[f32; 3]> {
    /// The three numbers at a world-space point, interpolated; outside of the box those of its nearest voxel.
    pub(super) fn vector(&self, p: Vec3) -> Vec3 {
        self.interpolated(self.transform.object_from_world.transform_point3(p), Vec3::from)
    }
}

impl PlacedVoxels {
    /// The number at a world-space point, interpolated; `None` outside of the box of the voxels.
    pub fn within(&self, p: Vec3) -> Option<f32> {
        let p = self.transform.object_from_world.transform_point3(p);
        self.extent().contains(p).then(|| self.interpolated(p, |value| value))
    }

    /// The number of a voxel that is none, with its place from the corner of the box.
    pub fn not_finite(&self) -> Option<([u32; 3], f32)> {
        self.find(|value| !value.is_finite())
    }

    /// The number at a world-space point, interpolated; outside of the box that of its nearest voxel.
    pub fn at(&self, p: Vec3) -> f32 {
        self.interpolated(self.transform.object_from_world.transform_point3(p), |value| value)
    }
}

/// What can be interpolated.
pub(super) trait Interpolable:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f32, Output = Self>
{
}

impl Interpolable for f32 {}
impl Interpolable for Vec3 {}

/// Interpolates between the eight voxels of which two are opposite ones.
#[inline]
fn trilinear<V: Interpolable>([low, high]: [[u32; 3]; 2], f: Vec3, value: impl Fn([u32; 3]) -> V) -> V {
    let mix = |a: V, b: V, t: f32| a + (b - a) * t;
    let row = |y: u32, z: u32| mix(value([low[0], y, z]), value([high[0], y, z]), f.x);
    let plane = |z: u32| mix(row(low[1], z), row(high[1], z), f.y);
    mix(plane(low[2]), plane(high[2]), f.z)
}

/// The map of a file in double precision.
pub fn affine(map: &GridMap) -> DAffine3 {
    let [x, y, z] = map.axes.map(DVec3::from);
    DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: map.origin.into() }
}
