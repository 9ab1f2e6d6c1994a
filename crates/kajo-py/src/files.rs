//! Files that a scene names and that Python holds: bytes, and arrays that are read where they lie.
//!
//! The content of a file is a list of tables, one after the other. A table is read row by row: some constant bytes, then one
//! row of each column. So the vertices of a mesh are written by its arrays of points, normals and coordinates, as binary PLY
//! has them, and no array is copied to make the file. A buffer stays alive for as long as somebody reads it.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::sync::Arc;

use kajo::{AssetError, AssetFile, Assets, relative_asset};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PySlice;

/// One column of a table: a `memoryview` of bytes, and how many of them are a row.
type ColumnArgument = (Py<PyAny>, usize);

/// A file as Python hands it over: tables of constant bytes and columns.
pub type FileArgument = Vec<(Vec<u8>, Vec<ColumnArgument>)>;

/// Rows of columns side by side.
struct Table {
    /// What each row begins with.
    before: Vec<u8>,
    columns: Vec<ColumnArgument>,
    rows: usize,
}

impl Table {
    fn new(py: Python<'_>, (before, columns): (Vec<u8>, Vec<ColumnArgument>)) -> PyResult<Table> {
        let rows_of = |(bytes, width): &ColumnArgument| -> PyResult<usize> {
            let bytes = PyBuffer::<u8>::get(bytes.bind(py))?.item_count();
            match bytes.checked_div(*width) {
                Some(rows) if rows * width == bytes => Ok(rows),
                _ => Err(PyValueError::new_err("an array has whole rows")),
            }
        };
        let rows: Vec<usize> = columns.iter().map(rows_of).collect::<PyResult<_>>()?;
        let first = rows.first().copied().unwrap_or(1);
        match rows.iter().all(|&n| n == first) {
            true => Ok(Table { before, columns, rows: first }),
            false => Err(PyValueError::new_err("arrays side by side have as many rows as each other")),
        }
    }

    /// Bytes of a row.
    fn width(&self) -> usize {
        self.before.len() + self.columns.iter().map(|(_, width)| width).sum::<usize>()
    }

    /// Some rows as they stand in the file.
    fn rows(&self, py: Python<'_>, rows: std::ops::Range<usize>) -> PyResult<Vec<u8>> {
        let columns: Vec<(Vec<u8>, usize)> = self
            .columns
            .iter()
            .map(|(bytes, width)| {
                let piece = PySlice::new(py, (rows.start * width) as isize, (rows.end * width) as isize, 1);
                let piece = bytes.bind(py).get_item(piece)?;
                Ok((PyBuffer::<u8>::get(&piece)?.to_vec(py)?, *width))
            })
            .collect::<PyResult<_>>()?;
        let mut out = Vec::with_capacity(rows.len() * self.width());
        for row in 0..rows.len() {
            out.extend_from_slice(&self.before);
            for (bytes, width) in &columns {
                let row = bytes.get(row * width..(row + 1) * width);
                out.extend_from_slice(
                    row.ok_or_else(|| PyValueError::new_err("an array has become shorter"))?,
                );
            }
        }
        Ok(out)
    }
}

/// Reads the tables of a file, some rows at a time.
struct TableReader {
    tables: Arc<Vec<Table>>,
    table: usize,
    row: usize,
    ready: Vec<u8>,
    taken: usize,
}

impl Read for TableReader {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        /// Bytes that are taken while the interpreter waits.
        const CHUNK: usize = 1 << 18;
        while self.taken == self.ready.len() {
            let Some(table) = self.tables.get(self.table) else { return Ok(0) };
            if self.row == table.rows {
                (self.table, self.row) = (self.table + 1, 0);
                continue;
            }
            let rows = (CHUNK / table.width().max(1)).max(1).min(table.rows - self.row);
            let read = Python::attach(|py| table.rows(py, self.row..self.row + rows));
            (self.ready, self.taken) = (read.map_err(|error| io::Error::other(error.to_string()))?, 0);
            self.row += rows;
        }
        let n = out.len().min(self.ready.len() - self.taken);
        out[..n].copy_from_slice(&self.ready[self.taken..self.taken + n]);
        self.taken += n;
        Ok(n)
    }
}

/// Files by their names.
#[derive(Default)]
pub struct PythonFiles {
    text: (String, Arc<[u8]>),
    files: BTreeMap<String, Arc<Vec<Table>>>,
}

impl PythonFiles {
    /// * `name`, `text`: of the scene
    pub fn new(
        py: Python<'_>,
        name: &str,
        text: &str,
        files: BTreeMap<String, FileArgument>,
    ) -> PyResult<PythonFiles> {
        let tables = |(name, file): (String, FileArgument)| {
            let tables: PyResult<Vec<Table>> = file.into_iter().map(|table| Table::new(py, table)).collect();
            Ok((name, Arc::new(tables?)))
        };
        let files = files.into_iter().map(tables).collect::<PyResult<_>>()?;
        Ok(PythonFiles { text: (name.to_owned(), text.as_bytes().into()), files })
    }
}

impl Assets for PythonFiles {
    fn open(&self, name: &str, from: &str) -> Result<AssetFile, AssetError> {
        let path = if from.is_empty() { name.to_owned() } else { relative_asset(from, name)? };
        if path == self.text.0 {
            let text = Arc::clone(&self.text.1);
            let (len, reader) = (Some(text.len() as u64), Box::new(io::Cursor::new(text)));
            return Ok(AssetFile { path, len, stamp: None, reopen: None, reader });
        }
        let tables = Arc::clone(self.files.get(&path).ok_or(AssetError::NotFound)?);
        let len = tables.iter().map(|table| table.rows as u64 * table.width() as u64).sum();
        let reader = TableReader { tables, table: 0, row: 0, ready: Vec::new(), taken: 0 };
        Ok(AssetFile { path, len: Some(len), stamp: None, reopen: None, reader: Box::new(reader) })
    }
}
