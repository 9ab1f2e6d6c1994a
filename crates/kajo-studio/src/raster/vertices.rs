//! Corners, transforms of instances and lines as the shaders read them.

use bytemuck::{Pod, Zeroable};

use super::Line;

/// A corner of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Vertex {
    /// Position in the mesh's own space.
    pub p: [f32; 3],
    /// Normal in the same space, each part times 127, and a spare; zero for the triangle's own.
    pub n: [i8; 4],
    /// Colour as shown, and a spare.
    pub color: [u8; 4],
}

/// Where a corner is in the picture of all textures.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct AtlasPosition {
    /// From the left and from the top, in parts of the whole times 65535.
    pub share: [u16; 2],
}

/// Where a mesh stands, and a colour that its own is multiplied with.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct InstanceTransform {
    /// World from the mesh's space, row by row.
    pub rows: [[f32; 4]; 3],
    pub color: [u8; 4],
}

/// A line as the shader reads it: the width goes with the first end.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct LineInstance {
    pub from_and_width: [f32; 4],
    pub to: [f32; 4],
    pub color: [u8; 4],
}

impl From<&Line> for LineInstance {
    fn from(line: &Line) -> LineInstance {
        LineInstance {
            from_and_width: line.from.extend(line.width).to_array(),
            to: line.to.extend(0.0).to_array(),
            color: line.color,
        }
    }
}
