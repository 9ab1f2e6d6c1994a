//! Compressed buffer views: the extension `EXT_meshopt_compression` [Kapoulkine 2021, "EXT_meshopt_compression"].
//!
//! Three codecs, each told by the first byte of the data:
//!
//! ```text
//! ATTRIBUTES  a0   for each byte of an element the differences from one element to the next, in groups of 16
//! TRIANGLES   e1   a byte a triangle, which names an edge and a vertex seen lately, and what that cannot say
//! INDICES     d1   differences of indices to one of two earlier ones
//! ```
//!
//! A filter then turns what was stored into what it stands for. No element is stored before the bytes that hold it have been
//! read, so what a file claims costs nothing.

use super::json::Meshopt;

/// Elements decoded at once, at most.
const LARGEST_BLOCK: usize = 256;
/// Bytes of those, at most.
const BLOCK_BYTES: usize = 8192;

/// The bytes of a view.
///
/// * `data`: compressed
pub(super) fn decode(said: &Meshopt, data: &[u8]) -> Result<Vec<u8>, String> {
    let &Meshopt { byte_stride: stride, count, .. } = said;
    let allowed: &[usize] = match (said.mode.as_str(), said.filter.as_str()) {
        ("TRIANGLES" | "INDICES", "NONE") => &[2, 4],
        ("ATTRIBUTES", "OCTAHEDRAL") => &[4, 8],
        ("ATTRIBUTES", "QUATERNION") => &[8],
        ("ATTRIBUTES", "NONE" | "EXPONENTIAL") => &[],
        (mode, filter) => {
            return Err(format!("it is compressed in a way that is not known: {mode}, {filter}"));
        }
    };
    let fits = if allowed.is_empty() {
        stride.is_multiple_of(4) && (4..=256).contains(&stride)
    } else {
        allowed.contains(&stride)
    };
    if !fits {
        return Err(format!("elements of {stride} bytes cannot be compressed in this way"));
    }
    if said.mode == "ATTRIBUTES" && data.first() == Some(&0xa1) {
        return Err("it is in the second version of the compression, which is not supported; `gltfpack` writes the first one".to_owned());
    }
    let decoded = match said.mode.as_str() {
        "TRIANGLES" => triangles(data, count).map(|list| narrowed(&list, stride)),
        "INDICES" => indices(data, count).map(|list| narrowed(&list, stride)),
        _ => attributes(data, count, stride),
    };
    let mut bytes = decoded.ok_or("its compressed data is damaged or too short")?;
    match said.filter.as_str() {
        "OCTAHEDRAL" if stride == 4 => bytes.as_chunks_mut().0.iter_mut().for_each(octahedral_of_bytes),
        "OCTAHEDRAL" => bytes.as_chunks_mut().0.iter_mut().for_each(octahedral_of_shorts),
        "QUATERNION" => bytes.as_chunks_mut().0.iter_mut().for_each(quaternion),
        "EXPONENTIAL" => bytes.as_chunks_mut().0.iter_mut().for_each(exponential),
        _ => {}
    }
    Ok(bytes)
}

/// Indices as numbers of so many bytes.
fn narrowed(indices: &[u32], bytes: usize) -> Vec<u8> {
    indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(bytes)).collect()
}

/// Takes so many bytes from the front.
fn take<'a>(data: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    data.split_off(..count)
}

fn attributes(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&first, mut data) = data.split_first()?;
    // The element before the first one stands at the end.
    let tail = data.len().checked_sub(stride.max(32))?;
    let mut before = data.get(data.len() - stride..)?.to_vec();
    data = &data[..tail];
    if first != 0xa0 {
        return None;
    }
    let largest = ((BLOCK_BYTES / stride) & !15).min(LARGEST_BLOCK);
    let mut bytes = Vec::new();
    let mut left = count;
    while left > 0 {
        let n = left.min(largest);
        let mut block = [0; BLOCK_BYTES];
        for (column, value) in before.iter_mut().enumerate() {
            let mut differences = [0; LARGEST_BLOCK];
            groups(&mut data, &mut differences[..n.next_multiple_of(16)])?;
            for (row, difference) in differences[..n].iter().enumerate() {
                *value = value.wrapping_add((difference >> 1) ^ (difference & 1).wrapping_neg());
                block[row * stride + column] = *value;
            }
        }
        bytes.extend(&block[..n * stride]);
        left -= n;
    }
    data.is_empty().then_some(bytes)
}

/// Bytes in groups of 16, each of 0, 2, 4 or 8 bits a byte.
fn groups(data: &mut &[u8], bytes: &mut [u8]) -> Option<()> {
    let n = bytes.len() / 16;
    let head = take(data, n.div_ceil(4))?;
    for (i, group) in bytes.as_chunks_mut::<16>().0.iter_mut().enumerate() {
        let bits = match head[i / 4] >> (i % 4 * 2) & 3 {
            0 => continue,
            3 => {
                group.copy_from_slice(take(data, 16)?);
                continue;
            }
            log => 2 * log,
        };
        let packed = take(data, 2 * usize::from(bits))?;
        let (mask, per_byte) = ((1u8 << bits) - 1, usize::from(8 / bits));
        for (j, byte) in group.iter_mut().enumerate() {
            let shift = 8 - bits * (j % per_byte + 1) as u8;
            let value = packed[j / per_byte] >> shift & mask;
            // The largest number stands for one that is written out.
            *byte = if value == mask { take(data, 1)?[0] } else { value };
        }
    }
    Some(())
}

/// The latest 16 of something.
#[derive(Default)]
struct Latest<T> {
    list: [T; 16],
    next: usize,
}

impl<T: Copy> Latest<T> {
    /// The one that came `back` before the next.
    fn get(&self, back: u8) -> T {
        self.list[self.next.wrapping_sub(usize::from(back)) & 15]
    }

    fn push(&mut self, value: T) {
        self.list[self.next] = value;
        self.next = (self.next + 1) & 15;
    }
}

/// What is known of the vertices of a mesh so far.
#[derive(Default)]
struct Vertices {
    latest: Latest<u32>,
    /// The first that has not been named.
    next: u32,
    /// The last that was written out.
    last: u32,
}

impl Vertices {
    fn fresh(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    fn written_out(&mut self, data: &mut &[u8]) -> Option<u32> {
        self.last = self.last.wrapping_add(difference(variable(data)?));
        Some(self.last)
    }
}

impl Vertices {
    /// The corners of a triangle none of whose edges is known.
    ///
    /// * `what`: the lower half of its code
    /// * `table`: of frequent pairs of vertices
    fn without_edge(&mut self, what: u8, table: &[u8; 16], rest: &mut &[u8]) -> Option<[u32; 3]> {
        // 0 is a new vertex, 15 one that is written out, anything else one of the latest.
        let (of_a, pair) = match what {
            14 => (0, take(rest, 1)?[0]),
            15 => (15, take(rest, 1)?[0]),
            _ => (0, table[usize::from(what)]),
        };
        if what >= 14 && pair == 0 {
            self.next = 0;
        }
        let kinds = [of_a, pair >> 4, pair & 15];
        let is_written_out = |kind: u8| kind == 15 && what >= 14;
        let mut corners = [0; 3];
        for (corner, kind) in corners.iter_mut().zip(kinds) {
            *corner = if kind == 0 { self.fresh() } else { self.latest.get(kind) };
        }
        for (corner, kind) in corners.iter_mut().zip(kinds) {
            if is_written_out(kind) {
                *corner = self.written_out(rest)?;
            }
        }
        for (&corner, kind) in corners.iter().zip(kinds) {
            if kind == 0 || is_written_out(kind) {
                self.latest.push(corner);
            }
        }
        Some(corners)
    }
}

fn triangles(data: &[u8], count: usize) -> Option<Vec<u32>> {
    let (&first, rest) = data.split_first()?;
    let version = first & 0x0f;
    if first & 0xf0 != 0xe0 || version > 1 || !count.is_multiple_of(3) {
        return None;
    }
    // A byte a triangle, what does not fit into those, and a table of frequent pairs of vertices.
    let (codes, rest) = rest.split_at_checked(count / 3)?;
    let (mut rest, table) = rest.split_last_chunk::<16>()?;
    let written_out = if version == 1 { 13 } else { 15 };
    let (mut edges, mut vertices) = (Latest::<[u32; 2]>::default(), Vertices::default());
    let mut list = Vec::new();
    for &code in codes {
        let (edge, what) = (code >> 4, code & 15);
        if edge < 15 {
            let [a, b] = edges.get(edge + 1);
            let c = match what {
                0 => vertices.fresh(),
                _ if what < written_out => vertices.latest.get(what + 1),
                15 => vertices.written_out(&mut rest)?,
                // 13 and 14 are the neighbours of the last one.
                _ => {
                    vertices.last = vertices.last.wrapping_add_signed(if what == 13 { -1 } else { 1 });
                    vertices.last
                }
            };
            if what == 0 || what >= written_out {
                vertices.latest.push(c);
            }
            edges.push([c, b]);
            edges.push([a, c]);
            list.extend([a, b, c]);
            continue;
        }
        let corners = vertices.without_edge(what, table, &mut rest)?;
        let [a, b, c] = corners;
        edges.push([b, a]);
        edges.push([c, b]);
        edges.push([a, c]);
        list.extend(corners);
    }
    rest.is_empty().then_some(list)
}

fn indices(data: &[u8], count: usize) -> Option<Vec<u32>> {
    let (&first, rest) = data.split_first()?;
    if first & 0xf0 != 0xd0 || first & 0x0f > 1 {
        return None;
    }
    let mut rest = rest.get(..rest.len().checked_sub(4)?)?;
    let mut last = [0u32; 2];
    let mut list = Vec::new();
    for _ in 0..count {
        let value = variable(&mut rest)?;
        let last = &mut last[(value & 1) as usize];
        *last = last.wrapping_add(difference(value >> 1));
        list.push(*last);
    }
    rest.is_empty().then_some(list)
}

/// A number of one to five bytes, seven bits each.
fn variable(data: &mut &[u8]) -> Option<u32> {
    let mut value = 0;
    for i in 0..5 {
        let byte = take(data, 1)?[0];
        value |= u32::from(byte & 127).wrapping_shl(7 * i);
        if byte < 128 {
            break;
        }
    }
    Some(value)
}

/// A difference, whose sign is the lowest bit, to be added with wrapping.
fn difference(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}

/// The nearest whole number, from zero where two are as near.
fn rounded(x: f32) -> i32 {
    (x + if x >= 0.0 { 0.5 } else { -0.5 }) as i32
}

/// A unit vector of two coordinates on an octahedron; the third number is what stands for 1.
fn octahedral([x, y, one]: [f32; 3], largest: f32) -> [i32; 3] {
    let z = one - x.abs() - y.abs();
    let below = z.min(0.0);
    let unfold = |v: f32| if v >= 0.0 { v + below } else { v - below };
    let (x, y) = (unfold(x), unfold(y));
    let scale = largest / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| rounded(v * scale))
}

fn octahedral_of_bytes(element: &mut [u8; 4]) {
    let [x, y, one, w] = *element;
    let [x, y, z] = octahedral([x, y, one].map(|v| f32::from(v as i8)), 127.0);
    *element = [x as u8, y as u8, z as u8, w];
}

fn octahedral_of_shorts(element: &mut [u8; 8]) {
    let [x, y, one, w] = shorts(element);
    let [x, y, z] = octahedral([x, y, one].map(f32::from), 32767.0);
    put_shorts(element, [x as i16, y as i16, z as i16, w]);
}

/// A unit quaternion without its largest component, whose number is the two lowest bits of the last short.
fn quaternion(element: &mut [u8; 8]) {
    let [x, y, z, last] = shorts(element);
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(last | 3);
    let [x, y, z] = [x, y, z].map(|v| f32::from(v) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let mut turned = [0; 4];
    for (i, v) in [w, x, y, z].into_iter().enumerate() {
        turned[((last & 3) as usize + i) & 3] = rounded(v * 32767.0) as i16;
    }
    put_shorts(element, turned);
}

/// 24 bits of a number and 8 of a power of two.
fn exponential(element: &mut [u8; 4]) {
    let value = i32::from_le_bytes(*element);
    let (mantissa, exponent) = (value << 8 >> 8, value >> 24);
    let power = f64::from_bits(((1023 + exponent) as u64) << 52);
    *element = ((f64::from(mantissa) * power) as f32).to_le_bytes();
}

fn shorts(element: &[u8; 8]) -> [i16; 4] {
    let [a, b, c, d, e, f, g, h] = *element;
    [[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes)
}

fn put_shorts(element: &mut [u8; 8], values: [i16; 4]) {
    element.as_chunks_mut().0.iter_mut().zip(values).for_each(|(bytes, value)| *bytes = value.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes of hexadecimal digits.
    fn bytes(digits: &str) -> Vec<u8> {
        let digit = |c: u8| (c as char).to_digit(16).unwrap() as u8;
        digits.as_bytes().as_chunks().0.iter().map(|[a, b]| digit(*a) << 4 | digit(*b)).collect()
    }

    fn said(mode: &str, filter: &str, count: usize, byte_stride: usize) -> Meshopt {
        let (mode, filter) = (mode.to_owned(), filter.to_owned());
        Meshopt { buffer: 0, byte_offset: 0, byte_length: 0, byte_stride, count, mode, filter }
    }

    fn decoded(mode: &str, filter: &str, count: usize, stride: usize, data: &str) -> Result<Vec<u8>, String> {
        decode(&said(mode, filter, count, stride), &bytes(data))
    }

    const ATTRIBUTES: &str = "a000052aaaaaaaaa000000070006121e2a36424e5a66727e8a96a2aeff000000bac6d2de07005f5f095f5f095f5f095f5f\
        095f5f09ff0000005f5f095f0000000000000000000000000000000000000000000000000000000007000000";
    const TRIANGLES: &str = "e1f010f010fffffffefffe5100f812008fb60198c408ffcbc50802ffb2010202bfc701007687566778a986658968980169\
        0000";
    const INDICES: &str = "d100040004c901040504f589110400000000";

    // The data of all of these was written by meshoptimizer 1.3.
    #[test]
    fn attributes_are_decoded() {
        let expected = (0..20u32).flat_map(|i| [7, i, 3 * i * i, 137 * i + 71 * (i % 3)].map(|x| x as u8));
        assert_eq!(decoded("ATTRIBUTES", "NONE", 20, 4, ATTRIBUTES).unwrap(), expected.collect::<Vec<_>>());
    }

    #[test]
    fn indices_are_decoded() {
        let list =
            |bytes: Vec<u8>| bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect::<Vec<_>>();
        let found = list(decoded("TRIANGLES", "NONE", 30, 4, TRIANGLES).unwrap());
        let triangles = [
            [0, 1, 2],
            [2, 1, 3],
            [4, 5, 6],
            [6, 5, 7],
            [0, 3, 7],
            [9, 9, 1],
            [100, 3, 70000],
            [8, 10, 11],
            [100, 101, 102],
            [9, 0, 2],
        ];
        assert_eq!(found, triangles.concat());
        let found = list(decoded("INDICES", "NONE", 10, 4, INDICES).unwrap());
        assert_eq!(found, [0, 1, 1, 2, 50, 3, 51, 4, 70000, 5]);
        let short = decoded("INDICES", "NONE", 10, 2, INDICES).unwrap();
        assert_eq!(short[..6], [0, 0, 1, 0, 1, 0]);
    }

    #[test]
    fn filters_are_undone() {
        for (filter, stride, data, expected) in [
            (
                "OCTAHEDRAL",
                4,
                "a0013f000000febc46013f0000009239aa00010f000000fefd0000000000000000000000000000000000000000000000000\
                 000000000007f00",
                "00007f004c009a00c44c527f00810000",
            ),
            (
                "OCTAHEDRAL",
                8,
                "a0011f0000007376013f0000000e1306013f000000db706e013f00000008031300000106000000010f000000fefd0000000\
                 0000000000000000000000000000000000000000000000000ff070000",
                "00000000ff7f0000c54c00009599000097c2ca4cf351ff7f0000018000000000",
            ),
            (
                "QUATERNION",
                8,
                "a0013f000000b1b241013f0000000a0903013f000000b2e09a013f0000000b181b013f000000b1b241013f0000000a09030\
                 1320000000500000000000000000000000000000000000000000000000000000000000000ff07",
                "000000000000ff7f0f40fa3f06c0fa3f65660000cd4c000039f39f5939f36ca6",
            ),
            (
                "EXPONENTIAL",
                4,
                "a00103000000ff013f0000008f507c011800000001230000001000000000000000000000000000000000000000000000000\
                 000000000002000f3",
                "0000803f000020c00000000000007a44",
            ),
        ] {
            assert_eq!(decoded("ATTRIBUTES", filter, 4, stride, data).unwrap(), bytes(expected), "{filter}");
        }
    }

    #[test]
    fn damage_and_unknown_kinds_are_named() {
        for (mode, count, stride, data) in
            [("ATTRIBUTES", 20, 4, ATTRIBUTES), ("TRIANGLES", 30, 4, TRIANGLES), ("INDICES", 10, 4, INDICES)]
        {
            let whole = bytes(data);
            for cut in 0..whole.len() {
                let _ = decode(&said(mode, "NONE", count, stride), &whole[..cut]);
            }
            for (count, data) in [
                (count, &whole[1..]),
                (count, &whole[..20.min(whole.len() - 1)]),
                (usize::MAX / 3 * 3, &whole),
            ] {
                let error = decode(&said(mode, "NONE", count, stride), data).unwrap_err();
                assert_eq!(error, "its compressed data is damaged or too short", "{mode}");
            }
        }
        let error = |mode, filter, stride| decoded(mode, filter, 1, stride, "a1").unwrap_err();
        assert!(error("ATTRIBUTES", "NONE", 4).contains("second version"));
        assert!(
            error("TRIANGLES", "OCTAHEDRAL", 4).contains("in a way that is not known: TRIANGLES, OCTAHEDRAL")
        );
        assert!(error("ATTRIBUTES", "NONE", 6).contains("elements of 6 bytes"));
        assert!(error("INDICES", "NONE", 8).contains("elements of 8 bytes"));
    }
}
