//! The matrices of a file.

use std::io::Read;

use super::super::error::BtfError;
use super::super::reader::{Reader, Scalar};
use super::header::{Form, Header, content};

/// Most components of a matrix.
const MAX_COMPONENTS: u32 = 1 << 12;

/// Two matrices whose rows have `components` numbers; values are the products of rows of both.
#[derive(Debug)]
struct Pair {
    components: usize,
    /// One of pairs of directions, the other of texels.
    left: Vec<f32>,
    right: Vec<f32>,
    /// Whether the left one is that of pairs of directions.
    is_of_directions: bool,
    /// How many rows of the left one belong together, one for each number of a colour: 1 or 3.
    interleaved: usize,
}

/// All matrices.
#[derive(Debug)]
pub(super) struct Factors {
    /// One for each number of a colour, or one for all.
    pairs: Vec<Pair>,
}

/// The rows of a matrix for one number of a colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rows<'a> {
    values: &'a [f32],
    pub components: usize,
    stride: usize,
    first: usize,
}

impl Rows<'_> {
    /// The numbers of a row.
    #[inline]
    pub fn row(&self, i: usize) -> &[f32] {
        &self.values[(i * self.stride + self.first) * self.components..][..self.components]
    }
}

impl Factors {
    /// Reads the matrices that a header announces.
    ///
    /// # Errors
    /// [`BtfError`], for matrices of other sizes, numbers that are not finite, or at the end of the file.
    pub fn read(reader: &mut Reader<'_, impl Read>, header: &Header) -> Result<Factors, BtfError> {
        let pairs = match header.form {
            Form::Decorrelated => {
                let read = |channel| {
                    let scalar = read_scalar(reader)?;
                    Pair::read(reader, header, scalar, [channel, 1])
                };
                [1, 2, 3].into_iter().map(read).collect::<Result<_, _>>()?
            }
            Form::Full => {
                reader.whole("matrices")?;
                let scalar = read_scalar(reader)?;
                vec![Pair::read(reader, header, scalar, [1, 3])?]
            }
        };
        Ok(Factors { pairs })
    }

    /// For a number of a colour the rows of pairs of directions, light by light for each view, and those of texels, row by row from above.
    pub fn channel(&self, channel: usize) -> [Rows<'_>; 2] {
        let pair = &self.pairs[channel.min(self.pairs.len() - 1)];
        let components = pair.components;
        let first = channel % pair.interleaved;
        let left = Rows { values: &pair.left, components, stride: pair.interleaved, first };
        let right = Rows { values: &pair.right, components, stride: 1, first: 0 };
        if pair.is_of_directions { [left, right] } else { [right, left] }
    }
}

/// How numbers of matrices are stored.
fn read_scalar(reader: &mut Reader<'_, impl Read>) -> Result<Scalar, BtfError> {
    match reader.byte("matrices")? {
        2 => Ok(Scalar::Half),
        4 => Ok(Scalar::Float),
        8 => Ok(Scalar::Double),
        n => Err(content(format!("numbers of its matrices have {n} bytes; 2, 4 and 8 are read"))),
    }
}

impl Pair {
    /// * `number`: of the pair, from 1
    fn read(
        reader: &mut Reader<'_, impl Read>,
        header: &Header,
        scalar: Scalar,
        [number, interleaved]: [usize; 2],
    ) -> Result<Pair, BtfError> {
        const PART: &str = "matrices";
        let [components, rows, columns] =
            [reader.whole(PART)?, reader.whole(PART)?, reader.whole(PART)?].map(u64::from);
        if !(1..=u64::from(MAX_COMPONENTS)).contains(&components) {
            let most = MAX_COMPONENTS;
            return Err(content(format!(
                "it has {components} components, which have to be from 1 to {most}"
            )));
        }
        let directions = (header.views.len() * header.lights.len()) as u64;
        let texels = u64::from(header.size[0]) * u64::from(header.size[1]);
        let is_of = |n: u64, m: u64| rows == n * interleaved as u64 && columns == m;
        let is_of_directions = is_of(directions, texels);
        if !is_of_directions && !is_of(texels, directions) {
            return Err(content(format!(
                "its matrices {number} have {rows} and {columns} rows, which are not its {directions} pairs of \
                 directions and {texels} texels"
            )));
        }
        reader.skip(components * scalar.bytes() as u64, "singular values")?;
        let mut read = |rows: u64, side: &str| {
            let (mut values, count) = (Vec::new(), rows * components);
            reader.values(&mut values, [count; 2], scalar, PART)?;
            match values.iter().position(|v| !v.is_finite()) {
                Some(at) => Err(content(format!(
                    "row {} of its {side} matrix {number} has numbers that are not finite",
                    at as u64 / components
                ))),
                None => Ok(values),
            }
        };
        let (left, right) = (read(rows, "left")?, read(columns, "right")?);
        Ok(Pair { components: components as usize, left, right, is_of_directions, interleaved })
    }
}
