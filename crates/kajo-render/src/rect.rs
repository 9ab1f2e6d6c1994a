//! Rectangles of pixels.

/// The pixels `(x, y)` with `x0 <= x < x1` and `y0 <= y < y1`; row 0 is the top one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl Rect {
    /// The rectangle of a whole picture.
    pub fn of_size(width: u32, height: u32) -> Rect {
        Rect { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// Pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// The pixels in both; of zero width or height where there are none.
    pub fn intersection(&self, other: &Rect) -> Rect {
        let (x0, y0) = (self.x0.max(other.x0), self.y0.max(other.y0));
        Rect { x0, y0, x1: self.x1.min(other.x1).max(x0), y1: self.y1.min(other.y1).max(y0) }
    }

    /// Position of a pixel of the rectangle in an array of its rows.
    #[inline]
    pub fn index(&self, x: u32, y: u32) -> usize {
        debug_assert!((self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y));
        (y - self.y0) as usize * self.width() as usize + (x - self.x0) as usize
    }
}

/// Cell `index`, row by row, of a grid of square cells over a picture; the last column and row of cells may
/// be narrower.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    picture: Rect,
    side: u32,
}

impl Grid {
    /// Cells of `side × side` pixels over the picture; a `side` of 0 counts as 1.
    pub fn new(width: u32, height: u32, side: u32) -> Grid {
        Grid { picture: Rect::of_size(width, height), side: side.max(1) }
    }

    /// Cells in a row.
    pub fn columns(&self) -> u32 {
        self.picture.x1.div_ceil(self.side)
    }

    /// Cells in a column.
    pub fn rows(&self) -> u32 {
        self.picture.y1.div_ceil(self.side)
    }

    /// Cells in all.
    pub fn len(&self) -> u64 {
        u64::from(self.columns()) * u64::from(self.rows())
    }

    /// Whether the picture has no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The pixels of a cell.
    pub fn cell(&self, column: u32, row: u32) -> Rect {
        let (x0, y0) = (column * self.side, row * self.side);
        let (x1, y1) = (x0.saturating_add(self.side), y0.saturating_add(self.side));
        Rect { x0, y0, x1, y1 }.intersection(&self.picture)
    }

    /// Side of the cells in pixels.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// The same picture in cells of another side; 0 counts as 1.
    pub fn with_side(&self, side: u32) -> Grid {
        Grid { side: side.max(1), ..*self }
    }

    /// Columns and rows of the cells that share pixels with a rectangle of the picture.
    pub fn cells_over(&self, rect: &Rect) -> Rect {
        Rect {
            x0: rect.x0 / self.side,
            y0: rect.y0 / self.side,
            x1: rect.x1.div_ceil(self.side),
            y1: rect.y1.div_ceil(self.side),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intersections_are_never_negative() {
        let a = Rect { x0: 2, y0: 2, x1: 5, y1: 6 };
        assert_eq!(a.intersection(&Rect::of_size(4, 3)), Rect { x0: 2, y0: 2, x1: 4, y1: 3 });
        assert_eq!(a.intersection(&Rect::of_size(1, 9)).area(), 0);
        assert_eq!(a.area(), 12);
        assert_eq!(a.index(3, 4), 7);
    }

    #[test]
    fn a_grid_covers_each_pixel_once() {
        for (width, height, side) in [(1, 1, 1), (7, 5, 2), (5, 3, 64), (1, 9, 4), (8, 8, 8)] {
            let grid = Grid::new(width, height, side);
            let mut seen = vec![0; (width * height) as usize];
            for row in 0..grid.rows() {
                for column in 0..grid.columns() {
                    let cell = grid.cell(column, row);
                    assert!(cell.area() > 0);
                    for y in cell.y0..cell.y1 {
                        for x in cell.x0..cell.x1 {
                            seen[(y * width + x) as usize] += 1;
                            let over = grid.cells_over(&Rect { x0: x, y0: y, x1: x + 1, y1: y + 1 });
                            assert_eq!(over, Rect { x0: column, y0: row, x1: column + 1, y1: row + 1 });
                        }
                    }
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{width} x {height} by {side}");
        }
        assert!(Grid::new(0, 5, 2).is_empty());
        assert_eq!(Grid::new(u32::MAX, 1, u32::MAX - 1).cell(1, 0).width(), 1);
    }
}
