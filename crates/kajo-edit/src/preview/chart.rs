//! Triangles of surfaces that show textures, each with a tile of a picture.
//!
//! Two triangles that share an edge have a tile together, a third alone one of which it uses half:
//!
//! ```text
//!     c0 --- c1        s from c0 to c1, t from c0 to c2, both 1 there;
//!      |  A / |        beyond the edge from c1 to c2 is the other triangle,
//!      |  / B |        with s and t counted backwards from d0.
//!     c2 --- d0
//! ```
//!
//! Around that there is a frame of one texel, so that what is read between texels comes from the same triangles.

use kajo_core::ObjectId;
use kajo_core::shape::Tessellation;
use kajo_math::{Transform, Vec3};

use super::{PreviewMesh, Vertex};

/// Cells of a tile along a side, at most.
const MOST_CELLS: f32 = 512.0;

/// See [`Tile::points`].
const MOST_POINTS: f32 = 4.0;

/// Columns of the picture.
const WIDTH: u32 = 2048;

/// Stands in the place of a corner that there is not.
const NONE: u32 = u32::MAX;

/// An object whose surfaces show textures.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    pub object: ObjectId,
    /// Where it is drawn.
    pub world_from_object: Transform,
    /// In the space of the shape.
    pub triangles: Tessellation,
    /// The middle and half the size of what is to be seen close, in that space; texels are larger away from it. `None` where all are
    /// alike.
    pub near: Option<(Vec3, f32)>,
}

/// Texels of a chart with a part that is seen close, in those of any other: much of it is farther away.
const CHARTS_OF_A_GRADED_ONE: u32 = 4;

impl Chart {
    fn world(&self, corner: u32) -> Vec3 {
        self.world_from_object.point(self.triangles.positions[corner as usize])
    }

    /// All triangles, two by two where that is possible, with tiles of no size yet.
    fn tiles(&self, chart: u32) -> Vec<(Tile, [f32; 2])> {
        let Tessellation { faces, parts, .. } = &self.triangles;
        let mut tiles = Vec::with_capacity(faces.len() / 2);
        let mut next = 0;
        while next < faces.len() {
            let face = faces[next];
            let pair = faces.get(next + 1).and_then(|&other| joined(face, other));
            let corners = pair.unwrap_or_else(|| self.alone(face));
            let second = if pair.is_some() { next + 1 } else { next };
            let far = self.distance(&corners);
            let points = far.sqrt().round().clamp(1.0, MOST_POINTS) as u16;
            let parts = [parts[next], parts[second]];
            let tile = Tile { chart, corners, parts, points, cells: [0; 2], origin: [0; 2] };
            // From a height above it a texel that far away is seen as long by its distance, and as high by the square of that.
            tiles.push((tile, self.legs(&corners).map(|leg| leg / far.powf(1.5))));
            next = second + 1;
        }
        tiles
    }

    /// A triangle with the corner in front that is opposite of its longest side.
    fn alone(&self, face: [u32; 3]) -> [u32; 4] {
        let length = |i: usize| self.world(face[(i + 1) % 3]).distance_squared(self.world(face[(i + 2) % 3]));
        let first = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b))).unwrap_or(0);
        [face[first], face[(first + 1) % 3], face[(first + 2) % 3], NONE]
    }

    /// How long a tile's sides are in the world.
    fn legs(&self, corners: &[u32; 4]) -> [f32; 2] {
        let [c0, c1, c2, d0] = *corners;
        let length = |a: u32, b: u32| self.world(a).distance(self.world(b));
        let [s, t] = [length(c0, c1), length(c0, c2)];
        if d0 == NONE { [s, t] } else { [s.max(length(d0, c2)), t.max(length(d0, c1))] }
    }

    /// How far a tile is from the middle of what is seen close, in its size; 1 within.
    fn distance(&self, corners: &[u32; 4]) -> f32 {
        let Some((middle, size)) = self.near else { return 1.0 };
        let [_, p, q, _] = corners.map(|corner| self.triangles.positions.get(corner as usize).copied());
        let between = 0.5 * (p.unwrap_or(middle) + q.unwrap_or(middle));
        ((between - middle).abs().max_element() / size).max(1.0)
    }
}

/// The corners of two triangles that share an edge, as a tile has them.
fn joined(a: [u32; 3], b: [u32; 3]) -> Option<[u32; 4]> {
    let (i, j) = (0..3)
        .flat_map(|i| (0..3).map(move |j| (i, j)))
        .find(|&(i, j)| a[(i + 1) % 3] == b[(j + 2) % 3] && a[(i + 2) % 3] == b[(j + 1) % 3])?;
    Some([a[i], a[(i + 1) % 3], a[(i + 2) % 3], b[j]])
}

/// The part of the picture that one or two triangles show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tile {
    /// Index of its [`Chart`].
    pub chart: u32,
    /// As drawn above.
    corners: [u32; 4],
    /// Parts of the shape that its triangles belong to.
    parts: [u32; 2],
    /// Along a side of a texel, how many times as many points as elsewhere make its colour.
    pub points: u16,
    /// Along its sides; none for triangles that are as small as a texel, which all of them show.
    cells: [u16; 2],
    /// Column and row of its first texel in the picture.
    pub origin: [u16; 2],
}

impl Tile {
    /// Columns and rows of texels.
    pub fn size(&self) -> [u32; 2] {
        if self.cells == [0; 2] { [1; 2] } else { self.cells.map(|n| u32::from(n) + 2) }
    }

    /// What is seen at a point of it, in texels from its origin: a part of the shape, and point and normal in its space. `None` where
    /// no triangle is.
    pub fn at(&self, chart: &Chart, x: f32, y: f32) -> Option<(u32, Vec3, Vec3)> {
        let [c0, c1, c2, d0] = self.corners;
        let [s, t] = match self.cells {
            [0, 0] => [1.0 / 3.0; 2],
            [w, h] => [(x - 1.0) / f32::from(w), (y - 1.0) / f32::from(h)],
        };
        let ([a, b, c], [s, t], part) = match s + t > 1.0 && d0 != NONE {
            true => ([d0, c2, c1], [1.0 - s, 1.0 - t], self.parts[1]),
            false => ([c0, c1, c2], [s, t], self.parts[0]),
        };
        // Texels of the frame beyond the longest side are wanted too.
        let frame: f32 = self.cells.iter().map(|&n| 1.0 / f32::from(n.max(1))).sum();
        if s + t > 1.0 + frame {
            return None;
        }
        let between = |of: &[Vec3]| {
            let [a, b, c] = [a, b, c].map(|corner| of[corner as usize]);
            a + s * (b - a) + t * (c - a)
        };
        let n = between(&chart.triangles.normals).normalize_or_zero();
        let p = between(&chart.triangles.positions);
        let face_normal = || {
            let [a, b, c] = [a, b, c].map(|corner| chart.triangles.positions[corner as usize]);
            (b - a).cross(c - a).normalize_or_zero()
        };
        Some((part, p, if n == Vec3::ZERO { face_normal() } else { n }))
    }

    /// Adds its triangles to a mesh in world space.
    fn draw(&self, chart: &Chart, mesh: &mut PreviewMesh) {
        let first = mesh.vertices.len() as u32;
        let [x, y] = self.origin.map(f32::from);
        let [w, h] = self.cells.map(f32::from);
        let is_pair = self.corners[3] != NONE;
        for (&corner, [s, t]) in self.corners.iter().zip([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]) {
            if corner == NONE {
                continue;
            }
            let n = chart.world_from_object.normal(chart.triangles.normals[corner as usize]);
            mesh.vertices.push(Vertex {
                position: chart.world(corner).to_array(),
                normal: n.to_array(),
                color: [255; 4],
                object: chart.object.number(),
            });
            let is_point = self.cells == [0; 2];
            mesh.texels.push(if is_point { [x + 0.5, y + 0.5] } else { [x + 1.0 + s * w, y + 1.0 + t * h] });
        }
        let mirrors = chart.world_from_object.mirrors();
        for [a, b, c] in [[0, 1, 2], [3, 2, 1]].into_iter().take(if is_pair { 2 } else { 1 }) {
            let face = if mirrors { [a, c, b] } else { [a, b, c] };
            mesh.indices.extend(face.map(|i| first + i));
        }
    }
}

/// Charts and where their tiles are in a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Plan {
    pub charts: Vec<Chart>,
    pub tiles: Vec<Tile>,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
}

impl Plan {
    /// Tiles for charts, those of a chart with as many texels as those of any other.
    ///
    /// * `budget`: texels of all, about
    /// * `most`: texels of a chart
    pub fn new(charts: Vec<Chart>, budget: u32, most: u32) -> Plan {
        let weight = |chart: &Chart| if chart.near.is_some() { CHARTS_OF_A_GRADED_ONE } else { 1 };
        let share = (budget / charts.iter().map(weight).sum::<u32>().max(1)).min(most);
        let mut tiles = Vec::new();
        for (index, chart) in (0..).zip(&charts) {
            tiles.extend(sized(chart.tiles(index), weight(chart) * share));
        }
        let size = packed(&mut tiles);
        Plan { charts, tiles, size }
    }

    /// All triangles in world space.
    pub fn mesh(&self) -> PreviewMesh {
        let mut mesh = PreviewMesh::default();
        for tile in &self.tiles {
            tile.draw(&self.charts[tile.chart as usize], &mut mesh);
        }
        mesh
    }
}

/// Tiles with texels that are as small as can be, all of one size in the world.
///
/// * `share`: texels of all; more where there are more triangles
fn sized(tiles: Vec<(Tile, [f32; 2])>, share: u32) -> Vec<Tile> {
    let area: f32 = tiles.iter().map(|(_, [s, t])| s * t).sum();
    let mut texel = (area / share.max(1) as f32).sqrt().max(f32::MIN_POSITIVE);
    loop {
        let of = |(tile, legs): &(Tile, [f32; 2])| {
            let cells = legs.map(|leg| (leg / texel).ceil().clamp(1.0, MOST_CELLS) as u16);
            Tile { cells: if cells == [1; 2] { [0; 2] } else { cells }, ..*tile }
        };
        let sized: Vec<Tile> = tiles.iter().map(of).collect();
        let texels: u64 =
            sized.iter().map(|tile| tile.size().iter().map(|&n| u64::from(n)).product::<u64>()).sum();
        if texels <= u64::from(share) || texels <= tiles.len() as u64 || !texel.is_finite() {
            return sized;
        }
        texel *= 1.15;
    }
}

/// Puts tiles side by side, in rows from the highest to the lowest, and says how large the picture is.
fn packed(tiles: &mut [Tile]) -> [u32; 2] {
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(tiles[i].size()[1]));
    let [mut x, mut y, mut height] = [0; 3];
    for i in order {
        let [w, h] = tiles[i].size();
        if x + w > WIDTH {
            (x, y, height) = (0, y + height, 0);
        }
        tiles[i].origin = [x as u16, y as u16];
        (x, height) = (x + w, height.max(h));
    }
    [WIDTH, y + height]
}
