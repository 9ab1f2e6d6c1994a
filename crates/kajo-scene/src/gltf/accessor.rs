//! Typed views of the bytes in buffers. What an accessor says is checked once, so that reading cannot fail.

use super::container::Buffers;
use super::json::{Accessor, Document};

/// A type of number in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u32) -> Option<Component> {
        Some(match code {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The number at the start of `bytes`, and the largest of its type.
    #[inline]
    fn read(self, bytes: &[u8]) -> (f64, f64) {
        let value = match (self, bytes) {
            (Component::I8, &[a, ..]) => f64::from(a as i8),
            (Component::U8, &[a, ..]) => f64::from(a),
            (Component::I16, &[a, b, ..]) => f64::from(i16::from_le_bytes([a, b])),
            (Component::U16, &[a, b, ..]) => f64::from(u16::from_le_bytes([a, b])),
            (Component::U32, &[a, b, c, d, ..]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Component::F32, &[a, b, c, d, ..]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            _ => 0.0,
        };
        let largest = match self {
            Component::I8 => f64::from(i8::MAX),
            Component::U8 => f64::from(u8::MAX),
            Component::I16 => f64::from(i16::MAX),
            Component::U16 => f64::from(u16::MAX),
            Component::U32 | Component::F32 => 1.0,
        };
        (value, largest)
    }
}

/// Elements one after the other in a buffer.
#[derive(Clone, Copy)]
struct Strip<'b> {
    bytes: &'b [u8],
    stride: usize,
    component: Component,
}

impl Strip<'_> {
    #[inline]
    fn read(&self, element: usize, column: usize) -> (f64, f64) {
        let at = element * self.stride + column * self.component.bytes();
        self.component.read(self.bytes.get(at..).unwrap_or_default())
    }
}

/// Elements of `N` numbers each.
pub(super) struct AccessorView<'b, const N: usize> {
    pub count: usize,
    /// `None` means zeros.
    strip: Option<Strip<'b>>,
    normalized: bool,
    /// The elements that differ, in order, and where their values are.
    sparse: Option<(Vec<u32>, Strip<'b>)>,
}

impl<'b, const N: usize> AccessorView<'b, N> {
    /// The accessor of this number.
    pub fn new(document: &Document, buffers: &'b Buffers<'_>, number: usize) -> Result<Self, String> {
        let named = |said: String| format!("accessors[{number}]: {said}");
        let accessor =
            document.accessors.get(number).ok_or_else(|| format!("there is no accessors[{number}]"))?;
        Self::of(document, buffers, accessor).map_err(named)
    }

    fn of(document: &Document, buffers: &'b Buffers<'_>, accessor: &Accessor) -> Result<Self, String> {
        let columns = match accessor.r#type.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            _ => 0,
        };
        if columns != N {
            return Err(format!("expected {N} numbers an element, found `{}`", accessor.r#type));
        }
        let component = component_of(accessor.component_type)?;
        let count = accessor.count;
        let dense = match accessor.buffer_view {
            Some(view) => Some(strip::<N>(document, buffers, view, accessor.byte_offset, component, count)?),
            None => None,
        };
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let (indices, values) = (&sparse.indices, &sparse.values);
                let kind = component_of(indices.component_type)?;
                let places = strip::<1>(
                    document,
                    buffers,
                    indices.buffer_view,
                    indices.byte_offset,
                    kind,
                    sparse.count,
                )?;
                let values = strip::<N>(
                    document,
                    buffers,
                    values.buffer_view,
                    values.byte_offset,
                    component,
                    sparse.count,
                )?;
                let places: Vec<u32> = (0..sparse.count).map(|i| places.read(i, 0).0 as u32).collect();
                if !places.is_sorted_by(|a, b| a < b)
                    || places.last().is_some_and(|&last| last as usize >= count)
                {
                    return Err("its sparse indices are not in order or out of range".to_owned());
                }
                Some((places, values))
            }
        };
        Ok(AccessorView { count, strip: dense, normalized: accessor.normalized, sparse })
    }

    /// Whether every element has bytes of its own, so that their number is no mere claim.
    pub fn is_backed(&self) -> bool {
        self.strip.is_some()
    }

    /// The numbers of an element; those of integer types made fractions if the accessor says so.
    #[inline]
    pub fn get(&self, element: usize) -> [f64; N] {
        let sparse = self.sparse.as_ref().and_then(|(places, values)| {
            let place = u32::try_from(element).ok()?;
            places.binary_search(&place).ok().map(|i| (values, i))
        });
        let Some((strip, element)) = sparse.or(self.strip.as_ref().map(|strip| (strip, element))) else {
            return [0.0; N];
        };
        std::array::from_fn(|column| match strip.read(element, column) {
            (value, largest) if self.normalized => (value / largest).max(-1.0),
            (value, _) => value,
        })
    }

    /// The numbers of an element in single precision.
    #[inline]
    pub fn floats(&self, element: usize) -> [f32; N] {
        self.get(element).map(|x| x as f32)
    }
}

fn component_of(code: u32) -> Result<Component, String> {
    Component::of(code).ok_or_else(|| format!("there is no type of number {code}"))
}

/// `count` elements of `N` numbers, all within the bytes of the view.
fn strip<'b, const N: usize>(
    document: &Document,
    buffers: &'b Buffers<'_>,
    number: usize,
    offset: usize,
    component: Component,
    count: usize,
) -> Result<Strip<'b>, String> {
    let (bytes, stride) = buffers.view(document, number)?;
    let size = N * component.bytes();
    let stride = stride.filter(|&stride| stride > 0).unwrap_or(size);
    if stride < size {
        return Err(format!("the elements of bufferViews[{number}] overlap"));
    }
    let needed = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
    let bytes = bytes.get(offset..).filter(|bytes| needed.is_some_and(|needed| needed <= bytes.len()));
    let bytes = bytes.ok_or_else(|| format!("{count} elements do not fit into bufferViews[{number}]"))?;
    Ok(Strip { bytes, stride, component })
}
