//! What is beside a picture.

/// What is beside a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The same picture again.
    #[default]
    Repeat,
    /// Its mirror image.
    Mirror,
    /// Its last row or column.
    Clamp,
    /// Black, opaque.
    Black,
    /// Nothing: black without any alpha, so that what it covers is a hole.
    Once,
}

impl Wrap {
    /// Brings a coordinate to [0, 1], or where there is nothing else to the picture's next edge and beyond by no more than itself.
    #[inline]
    pub(super) fn coordinate(self, s: f32) -> f32 {
        let s = if s.is_finite() { s } else { 0.0 };
        match self {
            Wrap::Repeat => s - s.floor(),
            Wrap::Mirror => {
                let s = s - 2.0 * (0.5 * s).floor();
                if s > 1.0 { 2.0 - s } else { s }
            }
            Wrap::Clamp => s.clamp(0.0, 1.0),
            // Far enough for the widest filter to find nothing.
            Wrap::Black | Wrap::Once => s.clamp(-16.0, 17.0),
        }
    }

    /// The number of a texel that may be one beyond the first or the last of `n`; `None` where there is none.
    #[inline]
    pub(super) fn index(self, i: i64, n: u32) -> Option<usize> {
        let n = i64::from(n);
        let inside = match self {
            Wrap::Repeat if i < 0 => i + n,
            Wrap::Repeat if i >= n => i - n,
            Wrap::Black | Wrap::Once if i < 0 || i >= n => return None,
            _ => i,
        };
        Some(inside.clamp(0, n - 1) as usize)
    }

    /// The number of any texel, however far beyond the first or the last of `n`; `None` where there is none.
    #[inline]
    pub(super) fn index_far(self, i: i64, n: u32) -> Option<usize> {
        let n = i64::from(n);
        match self {
            Wrap::Repeat => Some(i.rem_euclid(n) as usize),
            Wrap::Mirror => {
                let i = i.rem_euclid(2 * n);
                Some(i.min(2 * n - 1 - i) as usize)
            }
            Wrap::Clamp => Some(i.clamp(0, n - 1) as usize),
            Wrap::Black | Wrap::Once => (0..n).contains(&i).then_some(i as usize),
        }
    }

    /// What stands where there is no texel.
    #[inline]
    pub(super) fn beside(self) -> [f32; 4] {
        if self == Wrap::Black { [0.0, 0.0, 0.0, 1.0] } else { [0.0; 4] }
    }
}
