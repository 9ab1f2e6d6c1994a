//! Tables of phase functions as they are written: rows of an angle and of values.

/// Rows of an angle, or of its cosine, and one value for each of some columns.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseRows {
    /// At least one.
    columns: usize,
    angles: Vec<f32>,
    /// Row by row.
    values: Vec<f32>,
}

/// Why rows are no phase function. They are counted from 1, and so are their values.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PhaseTableError {
    /// There is nothing to join by lines.
    #[error("a phase function takes at least two rows of an angle and {}, and here {}", named(*columns), counted(*rows))]
    TooFew {
        /// Rows that there are.
        rows: usize,
        /// Values in a row.
        columns: usize,
    },
    /// Numbers that do not fill their rows.
    #[error("rows are of an angle and {}: {numbers} numbers fill no whole number of them", named(*columns))]
    Ragged {
        /// How many there are.
        numbers: usize,
        /// Values in a row.
        columns: usize,
    },
    /// Not the angle of a direction.
    #[error("row {0}: an angle is from 0 to 180 degrees")]
    Angle(usize),
    /// Not the cosine of an angle.
    #[error("row {0}: a cosine is from -1 to 1")]
    Cosine(usize),
    /// Not greater than the one before.
    #[error("row {0}: angles, or their cosines, must increase")]
    Order(usize),
    /// Negative, infinite or no number.
    #[error("row {row}{}: a value is finite and not negative", value_named(*column))]
    Value {
        /// Its row.
        row: usize,
        /// Which value of the row it is; 0 where there is one.
        column: usize,
    },
    /// No light goes anywhere; the number of the column, 0 where there is one.
    #[error("all values{} are 0, so that no light goes anywhere", column_named(*.0))]
    Black(usize),
    /// Wavelengths that are no positive numbers or not in their order; which one.
    #[error("wavelength {0}: wavelengths are positive numbers of nanometres that increase")]
    Wavelength(usize),
    /// A line of text is no row.
    #[error("line {line}: expected an angle and {}, found `{found}`", named(*columns))]
    Line {
        /// Counted from 1.
        line: usize,
        /// Values in a row.
        columns: usize,
        /// The line, or its beginning.
        found: String,
    },
}

fn counted(rows: usize) -> String {
    match rows {
        0 => "are none".to_owned(),
        1 => "is one".to_owned(),
        n => format!("are {n}"),
    }
}

fn named(columns: usize) -> String {
    if columns == 1 { "a value".to_owned() } else { format!("{columns} values") }
}

fn value_named(column: usize) -> String {
    if column == 0 { String::new() } else { format!(", value {column}") }
}

fn column_named(column: usize) -> String {
    if column == 0 { String::new() } else { format!(" of column {column}") }
}

impl PhaseRows {
    /// Rows of `1 + columns` numbers one after the other, the angle first.
    ///
    /// * `columns`: at least 1
    ///
    /// # Errors
    /// [`PhaseTableError::Ragged`].
    pub fn new(columns: usize, numbers: &[f32]) -> Result<PhaseRows, PhaseTableError> {
        if !numbers.len().is_multiple_of(1 + columns) {
            return Err(PhaseTableError::Ragged { numbers: numbers.len(), columns });
        }
        let mut rows = PhaseRows { columns, angles: Vec::new(), values: Vec::new() };
        for row in numbers.chunks_exact(1 + columns) {
            rows.push(row);
        }
        Ok(rows)
    }

    /// Reads text with one row on a line, numbers separated by blanks, a comma, a semicolon or a colon. Empty lines and what
    /// follows `#` do not count.
    ///
    /// * `columns`: at least 1
    ///
    /// # Errors
    /// [`PhaseTableError::Line`].
    pub fn parse(columns: usize, text: &str) -> Result<PhaseRows, PhaseTableError> {
        let mut rows = PhaseRows { columns, angles: Vec::new(), values: Vec::new() };
        for (i, line) in text.lines().enumerate() {
            let content = line.split('#').next().unwrap_or("").trim();
            if content.is_empty() {
                continue;
            }
            let words = content.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | ':'));
            let numbers: Option<Vec<f32>> =
                words.filter(|word| !word.is_empty()).map(|word| word.parse().ok()).collect();
            match numbers.filter(|numbers| numbers.len() == 1 + columns) {
                Some(row) => rows.push(&row),
                None => {
                    let found = content.chars().take(40).collect();
                    return Err(PhaseTableError::Line { line: i + 1, columns, found });
                }
            }
        }
        Ok(rows)
    }

    fn push(&mut self, row: &[f32]) {
        self.angles.push(row[0]);
        self.values.extend_from_slice(&row[1..]);
    }

    /// Values in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The angles, each with its value in a column.
    ///
    /// * `column`: counted from 0, less than [`PhaseRows::columns`]
    pub fn column(&self, column: usize) -> Vec<(f32, f32)> {
        let rows = self.values.chunks_exact(self.columns);
        self.angles.iter().zip(rows).map(|(&angle, row)| (angle, row[column])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_has_a_row_on_a_line() {
        let text = "# angle value\n0 30\n\n 90, 0.5 # sideways\n180;\t1e-1\n";
        let rows = PhaseRows::parse(1, text).unwrap();
        assert_eq!(rows.column(0), [(0.0, 30.0), (90.0, 0.5), (180.0, 0.1)]);
        let rows = PhaseRows::parse(3, "0 1 2 3\n180 4, 5, 6").unwrap();
        assert_eq!(rows.column(1), [(0.0, 2.0), (180.0, 5.0)]);
        assert_eq!(rows, PhaseRows::new(3, &[0.0, 1.0, 2.0, 3.0, 180.0, 4.0, 5.0, 6.0]).unwrap());
        for (columns, text, line, found) in [
            (1, "0 1\n5", 2, "5"),
            (1, "0 1 2", 1, "0 1 2"),
            (1, "\nangle 1", 2, "angle 1"),
            (2, "0 1 2\n90 1\n", 2, "90 1"),
        ] {
            let expected = PhaseTableError::Line { line, columns, found: found.to_owned() };
            assert_eq!(PhaseRows::parse(columns, text), Err(expected), "{text}");
        }
    }

    #[test]
    fn numbers_fill_their_rows() {
        let error = PhaseRows::new(3, &[0.0, 1.0, 2.0, 3.0, 90.0, 1.0]).unwrap_err();
        assert_eq!(error, PhaseTableError::Ragged { numbers: 6, columns: 3 });
        assert_eq!(
            error.to_string(),
            "rows are of an angle and 3 values: 6 numbers fill no whole number of them"
        );
    }
}
