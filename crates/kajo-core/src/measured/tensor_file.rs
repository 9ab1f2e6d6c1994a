//! Files of named arrays, as the material data base of EPFL's Realistic Graphics Lab has them.
//!
//! ```text
//! "tensor_file" and a zero byte, u8 u8 version 1 0, u32 number of fields
//! for each field: u16 length of its name, the name, u16 dimensions, u8 type, u64 where its numbers begin, u64 for each dimension
//! ```
//!
//! All is little end first. The types that are read are u8 (1) and f32 (10).

use std::collections::BTreeMap;

/// An array of a file.
#[derive(Debug)]
pub struct Tensor<'a> {
    /// Its dimensions; the last runs fastest.
    pub shape: Vec<usize>,
    kind: u8,
    bytes: &'a [u8],
}

const BYTES: u8 = 1;
const FLOATS: u8 = 10;
/// Bytes of a number, by type.
const SIZES: [u64; 12] = [0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8];

impl Tensor<'_> {
    /// The numbers; `None` for those of another type than f32.
    pub fn floats(&self) -> Option<Vec<f32>> {
        let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        (self.kind == FLOATS).then(|| self.bytes.chunks_exact(4).map(float).collect())
    }

    /// The bytes; `None` for numbers of another type.
    pub fn bytes(&self) -> Option<&[u8]> {
        (self.kind == BYTES).then_some(self.bytes)
    }
}

/// The next bytes of a header.
fn take<'a>(rest: &mut &'a [u8], n: usize) -> Result<&'a [u8], String> {
    let (taken, left) = rest.split_at_checked(n).ok_or("the file ends within its header")?;
    *rest = left;
    Ok(taken)
}

fn whole(rest: &mut &[u8], n: usize) -> Result<u64, String> {
    let bytes = take(rest, n)?;
    Ok(bytes.iter().rev().fold(0, |sum, &byte| sum << 8 | u64::from(byte)))
}

/// Whether a file begins as one of arrays does.
pub fn is_tensor_file(file: &[u8]) -> bool {
    file.starts_with(b"tensor_file\0")
}

/// The arrays of a file by their names.
///
/// # Errors
/// What is malformed or cut off, in words.
pub fn tensors(file: &[u8]) -> Result<BTreeMap<String, Tensor<'_>>, String> {
    let mut rest = file;
    if !is_tensor_file(file) {
        return Err("this is no file of tensors".to_owned());
    }
    take(&mut rest, 12)?;
    let version = take(&mut rest, 2)?;
    if version != [1, 0] {
        return Err(format!("this is version {}.{} of the format, and 1.0 is read", version[0], version[1]));
    }
    let mut fields = BTreeMap::new();
    for _ in 0..whole(&mut rest, 4)? {
        let length = whole(&mut rest, 2)? as usize;
        let name = String::from_utf8_lossy(take(&mut rest, length)?).into_owned();
        let dimensions = whole(&mut rest, 2)?;
        let kind = whole(&mut rest, 1)? as u8;
        let begin = whole(&mut rest, 8)?;
        let mut shape = Vec::new();
        for _ in 0..dimensions {
            shape.push(usize::try_from(whole(&mut rest, 8)?).unwrap_or(usize::MAX));
        }
        let size = SIZES.get(usize::from(kind)).copied().filter(|&size| size > 0);
        let size = size.ok_or_else(|| format!("`{name}` has numbers of the unknown type {kind}"))?;
        let count = shape.iter().try_fold(size, |n: u64, &side| n.checked_mul(side as u64));
        let end = count.and_then(|count| begin.checked_add(count)).filter(|&end| end <= file.len() as u64);
        let end = end.ok_or_else(|| format!("the file ends within `{name}`"))?;
        let bytes = &file[begin as usize..end as usize];
        fields.insert(name, Tensor { shape, kind, bytes });
    }
    Ok(fields)
}

/// A file of arrays, to test readers with.
#[cfg(test)]
pub fn written(fields: &[(&str, &[usize], Vec<u8>, u8)]) -> Vec<u8> {
    let mut file = b"tensor_file\0\x01\x00".to_vec();
    file.extend((fields.len() as u32).to_le_bytes());
    let head: usize =
        18 + fields.iter().map(|(name, shape, ..)| 13 + name.len() + 8 * shape.len()).sum::<usize>();
    let mut begin = head as u64;
    for (name, shape, bytes, kind) in fields {
        file.extend((name.len() as u16).to_le_bytes());
        file.extend(name.as_bytes());
        file.extend((shape.len() as u16).to_le_bytes());
        file.push(*kind);
        file.extend(begin.to_le_bytes());
        shape.iter().for_each(|&side| file.extend((side as u64).to_le_bytes()));
        begin += bytes.len() as u64;
    }
    fields.iter().for_each(|field| file.extend(&field.2));
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_read_and_damage_is_said() {
        let floats: Vec<u8> = [1.5f32, 2.5].iter().flat_map(|v| v.to_le_bytes()).collect();
        let good = written(&[("a", &[2], floats, FLOATS), ("b", &[1, 3], vec![7, 8, 9], BYTES)]);
        let found = tensors(&good).unwrap();
        assert_eq!(found["a"].floats().unwrap(), [1.5, 2.5]);
        assert_eq!((found["b"].bytes().unwrap(), &*found["b"].shape), (&[7, 8, 9][..], &[1, 3][..]));
        assert!(found["a"].bytes().is_none() && found["b"].floats().is_none());
        for length in 0..good.len() {
            tensors(&good[..length]).unwrap_err();
        }
        let error = |at: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            tensors(&bytes).unwrap_err()
        };
        assert_eq!(error(0, b'x'), "this is no file of tensors");
        assert_eq!(error(12, 2), "this is version 2.0 of the format, and 1.0 is read");
        assert_eq!(error(23, 77), "`a` has numbers of the unknown type 77");
        assert_eq!(error(38, 255), "the file ends within `a`");
    }
}
