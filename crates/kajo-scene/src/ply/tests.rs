//! What the PLY reader makes of files good and bad.

use super::*;
use proptest::prelude::*;

/// Numbers of a file, to be written in any of the three formats.
#[derive(Clone, Copy, Debug)]
enum Number {
    Char(i8),
    Byte(u8),
    Short(i16),
    Half(u16),
    Int(i32),
    Word(u32),
    Float(f32),
    Double(f64),
}
use Number::{Byte, Char, Double, Float, Half, Int, Short, Word};

fn to_bytes(number: Number, big: bool) -> Vec<u8> {
    let mut bytes = match number {
        Char(x) => x.to_le_bytes().to_vec(),
        Byte(x) => x.to_le_bytes().to_vec(),
        Short(x) => x.to_le_bytes().to_vec(),
        Half(x) => x.to_le_bytes().to_vec(),
        Int(x) => x.to_le_bytes().to_vec(),
        Word(x) => x.to_le_bytes().to_vec(),
        Float(x) => x.to_le_bytes().to_vec(),
        Double(x) => x.to_le_bytes().to_vec(),
    };
    if big {
        bytes.reverse();
    }
    bytes
}

fn to_text(number: Number) -> String {
    match number {
        Char(x) => x.to_string(),
        Byte(x) => x.to_string(),
        Short(x) => x.to_string(),
        Half(x) => x.to_string(),
        Int(x) => x.to_string(),
        Word(x) => x.to_string(),
        Float(x) => x.to_string(),
        Double(x) => x.to_string(),
    }
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// A file of the given header lines and elements.
fn file(format: &str, header: &str, elements: &[Vec<Number>]) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {format} 1.0\ncomment from C:\\\n{header}end_header\n").into_bytes();
    for element in elements {
        if format == "ascii" {
            let words: Vec<String> = element.iter().map(|&x| to_text(x)).collect();
            bytes.extend(words.join(" ").bytes().chain([b'\n']));
        } else {
            bytes.extend(element.iter().flat_map(|&x| to_bytes(x, format == FORMATS[2])));
        }
    }
    bytes
}

fn read(bytes: &[u8]) -> Result<(TriMesh, MeshReport), String> {
    read_ply(bytes, "m.ply", &Limits::default()).map_err(|error| error.to_string())
}

/// What all three formats of a file give, which must be the same.
fn read_all(header: &str, elements: &[Vec<Number>]) -> (TriMesh, MeshReport) {
    let [a, b, c] = FORMATS.map(|format| read(&file(format, header, elements)).unwrap());
    assert!(a == b && b == c, "{a:?}\n{b:?}\n{c:?}");
    a
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACES: &str = "property list uchar int vertex_indices\n";

fn square(faces: &str) -> String {
    format!("element vertex 4\n{XYZ}{faces}")
}

fn corners() -> Vec<Vec<Number>> {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(|[x, y]| vec![Float(x), Float(y), Float(0.5)])
        .to_vec()
}

#[test]
fn triangles_and_polygons() {
    let mut elements = corners();
    elements.push(vec![Byte(3), Int(0), Int(1), Int(2)]);
    elements.push(vec![Byte(4), Int(0), Int(1), Int(2), Int(3)]);
    elements.push(vec![Byte(3), Int(3), Int(2), Int(1)]);
    let (mesh, report) = read_all(&square(&format!("element face 3\n{FACES}")), &elements);
    assert_eq!(mesh.positions[2], [1.0, 1.0, 0.5]);
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 2, 1]]);
    assert_eq!(report, MeshReport { polygons: 1, ..MeshReport::default() });
    assert_eq!(mesh.polygons.len(), 1);
}

#[test]
fn any_types_in_any_order_with_others_between() {
    let header = "element camera 1\nproperty list short double p\nproperty uchar q\nelement vertex 3\n\
        property uchar red\nproperty double z\nproperty short x\nproperty list uint ushort l\nproperty char y\n\
        property float v\nproperty int u\nproperty float nx\nproperty float ny\nproperty float nz\n\
        element edge 2\nproperty int a\nelement face 2\nproperty float quality\nproperty list ushort uchar texcoord\n\
        property list ushort uint vertex_index\nproperty double w\n";
    let vertex = |x: i16, y: i8, z: f64| {
        let list = vec![Word(2), Half(7), Half(8)];
        let front = vec![Byte(255), Double(z), Short(x)];
        let back = vec![Char(y), Float(0.25), Int(x.into()), Float(0.0), Float(f32::from(y)), Float(1.0)];
        [front, list, back].concat()
    };
    let face = |a: u32, b: u32, c: u32| {
        let list = [Half(3), Word(a), Word(b), Word(c)];
        [&[Float(1.0), Half(2), Byte(1), Byte(2)][..], &list, &[Double(9.0)]].concat()
    };
    let elements = [
        vec![Short(2), Double(1.0), Double(2.0), Byte(1)],
        vertex(-300, -1, 1e-3),
        vertex(5, 2, 0.25),
        vertex(0, 0, 1e30),
        vec![Int(1)],
        vec![Int(2)],
        face(2, 1, 0),
        face(0, 1, 2),
    ];
    let (mesh, report) = read_all(header, &elements);
    assert_eq!(mesh.positions, [[-300.0, -1.0, 1e-3], [5.0, 2.0, 0.25], [0.0, 0.0, 1e30]]);
    assert_eq!(mesh.normals[1], [0.0, 2.0, 1.0]);
    assert_eq!(mesh.uvs[0], [-300.0, 0.25]);
    assert_eq!((&mesh.face_normals, &mesh.face_uvs), (&Corners::Vertices, &Corners::Vertices));
    assert_eq!(mesh.faces, [[2, 1, 0], [0, 1, 2]]);
    assert_eq!(report.left_out.len(), 3, "texture coordinates of faces, camera, edge: {report:?}");
    assert_eq!(mesh.face_colors, Corners::Absent, "red alone is no colour");
}

#[test]
fn floats_of_any_layout_take_the_short_way_and_mean_the_same() {
    let names = ["nx", "y", "confidence", "x", "ny", "z", "s", "nz", "t"];
    let properties: String = names.iter().map(|name| format!("property float {name}\n")).collect();
    let header = format!(
        "element vertex 3\n{properties}element face 1\nproperty uchar flag\n{FACES}property short k\n"
    );
    let vertex = |i: u16| (0..9).map(|k| Float(f32::from(i * 10 + k))).collect::<Vec<_>>();
    let face = vec![Byte(9), Byte(3), Int(2), Int(0), Int(1), Short(4)];
    let (mesh, _) = read_all(&header, &[vertex(0), vertex(1), vertex(2), face]);
    assert_eq!(mesh.positions[1], [13.0, 11.0, 15.0]);
    assert_eq!(mesh.normals[1], [10.0, 14.0, 17.0]);
    assert_eq!(mesh.uvs[2], [26.0, 28.0]);
    assert_eq!(mesh.faces, [[2, 0, 1]]);
}

#[test]
fn strips_turn_every_other_triangle_round() {
    let mut elements = corners();
    elements.push([7, 0, 1, 3, 2, -1, 0, 1].map(Int).to_vec());
    let (mesh, _) =
        read_all(&square("element tristrips 1\nproperty list int int vertex_indices\n"), &elements);
    assert_eq!(mesh.faces, [[0, 1, 3], [3, 1, 2]]);
}

#[test]
fn faces_may_stand_before_vertices() {
    // A dart, whose inner corner decides where it is cut.
    let dart = [[0.0, 0.0], [4.0, 2.0], [0.0, 4.0], [1.0, 2.0]];
    let vertices = dart.map(|[x, y]| vec![Float(x), Float(y), Float(0.0)]).to_vec();
    let faces = vec![
        vec![Byte(3), Int(2), Int(1), Int(0)],
        vec![Byte(4), Int(0), Int(1), Int(2), Int(3)],
        vec![Byte(3), Int(0), Int(1), Int(2)],
    ];
    let strip = vec![[4, 0, 1, 3, 2].map(Int).to_vec()];
    let header = |parts: [&str; 3]| parts.concat();
    let vertex_lines = format!("element vertex 4\n{XYZ}");
    let face_lines = format!("element face 3\n{FACES}");
    let strip_lines = "element tristrips 1\nproperty list int int vertex_indices\n";
    let after = read_all(
        &header([&vertex_lines, &face_lines, strip_lines]),
        &[vertices.clone(), faces.clone(), strip.clone()].concat(),
    );
    let before =
        read_all(&header([&face_lines, strip_lines, &vertex_lines]), &[faces, strip, vertices].concat());
    assert_eq!(before, after);
    assert_eq!((after.0.faces.len(), after.1.polygons), (6, 1));
}

#[test]
fn vertices_have_colours() {
    let read = |kind: &str, names: [&str; 3], number: fn(u8) -> Number| {
        let colors: String = names.map(|name| format!("property {kind} {name}\n")).concat();
        let header = format!("element vertex 2\n{XYZ}{colors}property uchar alpha\n");
        let vertex = |rgb: [u8; 3]| {
            let mut vertex = vec![Float(1.0), Float(2.0), Float(3.0)];
            vertex.extend(rgb.map(number));
            vertex.push(Byte(51));
            vertex
        };
        read_all(&header, &[vertex([0, 51, 255]), vertex([255, 0, 102])]).0
    };
    let expected = [[0.0, 0.2, 1.0, 0.2], [1.0, 0.0, 0.4, 0.2]];
    let rgb = ["red", "green", "blue"];
    for mesh in [
        read("uchar", rgb, Byte),
        read("ushort", ["diffuse_red", "diffuse_green", "diffuse_blue"], |v| Half(257 * u16::from(v))),
        read("int", ["r", "g", "b"], |v| Int(v.into())),
    ] {
        assert_eq!((&*mesh.colors, mesh.colors_are_srgb), (&expected[..], true));
        assert_eq!(mesh.face_colors, Corners::Vertices);
    }
    let floats = read("float", rgb, |v| Float(f32::from(v) / 255.0));
    assert_eq!((&*floats.colors, floats.colors_are_srgb), (&expected[..], false));
    let odd = read("double", rgb, |v| Double(f64::from(v) - 254.0));
    assert_eq!(odd.colors, [[0.0, 0.0, 1.0, 0.2], [1.0, 0.0, 0.0, 0.2]], "held to [0, 1]");
    let header = format!("element vertex 2\n{XYZ}property float r\nproperty float g\nproperty float b\n");
    let vertex = |rgb: [f32; 3]| [1.0, 2.0, 3.0].into_iter().chain(rgb).map(Float).collect::<Vec<_>>();
    let elements = [vertex([0.5, f32::NAN, 0.0]), vertex([0.5, 0.25, 0.0])];
    let (mesh, report) = read_all(&header, &elements);
    assert_eq!(mesh.colors, [[1.0; 4], [0.5, 0.25, 0.0, 1.0]], "what is no number is white");
    assert_eq!(report.warnings().len(), 1, "{report:?}");
}

#[test]
fn opacities_that_mean_none_are_none() {
    let rgba = "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n";
    let header = format!("element vertex 3\n{XYZ}{rgba}");
    let read = |colors: [[u8; 4]; 3]| {
        let vertex = |rgba: [u8; 4]| {
            [Float(0.0), Float(1.0), Float(2.0)].into_iter().chain(rgba.map(Byte)).collect::<Vec<_>>()
        };
        read_all(&header, &colors.map(vertex)).0.colors
    };
    let none = [0; 4];
    assert_eq!(read([none, [255, 0, 0, 255], none]), [[1.0; 4], [1.0, 0.0, 0.0, 1.0], [1.0; 4]]);
    assert_eq!(read([none, [255, 0, 0, 51], none])[0], none.map(f32::from), "it fades away");
    assert_eq!(
        read([[0, 0, 255, 0], [255, 0, 0, 0], none]),
        [[0.0, 0.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0], [1.0; 4]]
    );
    assert_eq!(read([[0, 0, 255, 0], [255, 0, 0, 51], none])[0], [0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn faces_have_colours_where_vertices_have_none() {
    let colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let header = square(&format!("{strips}element face 6\n{FACES}{colors}"));
    let face = |corners: &[i32], rgb: [u8; 3]| {
        let list = corners.iter().map(|&c| Int(c));
        [Byte(corners.len() as u8)].into_iter().chain(list).chain(rgb.map(Byte)).collect::<Vec<_>>()
    };
    let mut elements = corners();
    elements.push([3, 0, 1, 2].map(Int).to_vec());
    elements.push(face(&[0, 1, 2], [255, 0, 0]));
    // Without corners to make a triangle of they are none.
    elements.push(face(&[0, 1], [1, 2, 3]));
    elements.push(face(&[], [1, 2, 3]));
    elements.push(face(&[0, 1, 2, 3], [0, 51, 0]));
    elements.push(face(&[3, 2, 1], [0, 51, 0]));
    elements.push(face(&[0, 2, 1], [255, 255, 255]));
    let (mesh, report) = read_all(&header, &elements);
    assert_eq!(mesh.colors, [[1.0, 0.0, 0.0, 1.0], [0.0, 0.2, 0.0, 1.0], [1.0; 4]]);
    let own = [[NO_INDEX; 3], [0; 3], [1; 3], [1; 3], [1; 3], [2; 3]];
    assert_eq!((mesh.face_colors, mesh.colors_are_srgb), (Corners::Own(own.to_vec()), true));
    assert_eq!(report.warnings(), ["2 faces have fewer than three corners; they were left out"]);
    // Those of vertices come first.
    let both = format!("element vertex 1\n{XYZ}{colors}element face 0\n{FACES}{colors}");
    let vertex = vec![Float(0.0), Float(0.0), Float(0.0), Byte(255), Byte(255), Byte(0)];
    let (mesh, report) = read_all(&both, &[vertex]);
    assert_eq!((mesh.colors, mesh.face_colors), (vec![[1.0, 1.0, 0.0, 1.0]], Corners::Vertices));
    assert_eq!(report.left_out, ["the colours of the faces are not used, only those of vertices"]);
}

#[test]
fn headers_end_their_lines_in_any_way() {
    // Its first byte is that of a line end.
    let x = f32::from_le_bytes([b'\n', 0, 0x80, 0x3f]);
    let (header, elements) = (format!("element vertex 1\n{XYZ}"), [vec![Float(x), Float(2.0), Float(3.0)]]);
    let whole = file("binary_little_endian", &header, &elements);
    let (head, body) = whole.split_at(whole.len() - 12);
    for end in ["\n", "\r\n", "\r"] {
        let head = String::from_utf8(head.to_vec()).unwrap().replace('\n', end);
        let (mesh, _) = read(&[head.as_bytes(), body].concat()).unwrap();
        assert_eq!(mesh.positions, [[x, 2.0, 3.0]], "{end:?}");
    }
}

#[test]
fn what_is_not_finite_is_left_out_and_counted() {
    let header = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n\
        property float ny\nproperty float nz\nelement face 2\nproperty list uchar int vertex_indices\n";
    let vertex = |x: f32, n: f32| vec![Float(x), Float(1.0), Float(2.0), Float(n), Float(0.0), Float(1.0)];
    let face = |a, b, c| vec![Byte(3), Int(a), Int(b), Int(c)];
    let elements = [
        vertex(0.0, f32::NAN),
        vertex(1.0, 0.0),
        vertex(f32::INFINITY, f32::INFINITY),
        face(0, 1, 0),
        face(0, 1, 2),
    ];
    let (mesh, report) = read_all(header, &elements);
    assert_eq!((mesh.faces.len(), report.dropped, report.zeroed), (1, 1, 2));
    assert_eq!(mesh.normals, [[0.0; 3], [0.0, 0.0, 1.0], [0.0; 3]]);
    assert_eq!(report.warnings().len(), 2);
}

#[test]
fn mistakes_are_told_with_their_place() {
    let start = "ply\nformat ascii 1.0\n";
    let face = |values: &str| {
        format!(
            "{start}{}end_header\n0 0 0\n1 0 0\n\n1 1 0\n0 1 0\n{values}\n",
            square(&format!("element face 1\n{FACES}"))
        )
    };
    for (text, said) in [
        ("plyx\n".to_owned(), "byte 5: a PLY file begins with a line `ply`"),
        ("ply\nformat ascii 1.0".to_owned(), "the file ends before `end_header`"),
        ("ply\nformat binary\n".to_owned(), "m.ply:2:8: expected `ascii`, `binary_little_endian`"),
        (
            format!("{start}elment vertex 3\n"),
            "m.ply:3:1: expected `property` or `end_header`, found `elment`",
        ),
        (format!("{start}element vertex 3x\n"), "m.ply:3:16: expected the number of elements, found `3x`"),
        (
            format!("{start}element vertex 4000000000\n"),
            "m.ply:3:16: the file says it has 4000000000 `vertex`",
        ),
        (format!("{start}element vertex 3\n{XYZ}element vertex 3\n"), "there are two elements `vertex`"),
        (
            format!("{start}element face 1\n{FACES}element vertex 1\n{XYZ}end_header\n3 0 0 0\n"),
            "the file ends in vertex 0 of 1",
        ),
        (
            format!("{start}element face 1\n{FACES}element vertex 1\n{XYZ}end_header\n3 0 0 1\n0 0 0\n"),
            "m.ply:10:1: face 0: there is no vertex 1: the file has 1, numbered from 0",
        ),
        (format!("{start}element face 1\n{FACES}end_header\n3 0 0 0\n"), "there is no `element vertex`"),
        (
            format!("{start}element vertex 3\nproperty flot x\n"),
            "m.ply:4:10: expected a type such as `float`",
        ),
        (format!("{start}element vertex 3\nproperty list float int x\n"), "must be of an integer type"),
        (format!("{start}property int x\n"), "there is no `element` before this property"),
        (
            format!("{start}element vertex 3\nproperty float x\nend_header\n"),
            "no properties `x`, `y` and `z`",
        ),
        (format!("{start}end_header\n"), "there is no `element vertex`"),
        (format!("ply\nelement vertex 3\n{XYZ}end_header\n"), "there is no `format`"),
        (
            format!("{start}element vertex 3\n{XYZ}element face 1\nend_header\n"),
            "has no list `vertex_indices`",
        ),
        (face("3 0 1 4"), "m.ply:15:1: face 0: there is no vertex 4: the file has 4, numbered from 0"),
        (face("3 0 1 -1"), "there is no vertex -1"),
        (face("3 0 1 0.5"), "there is no vertex 0.5"),
        (face("3 0 1"), "m.ply:15:6: face 0 has more numbers than this line"),
        (face("-3 0 1 2"), "a list cannot have -3 items"),
        (face("3.5 0 1 2"), "a list cannot have 3.5 items"),
        (face("5000 0 1 2"), "has more than 4096 corners"),
        (face("three"), "m.ply:15:1: expected a number, found `three`"),
        (face(""), "the file ends in face 0 of 1"),
    ] {
        let error = read(text.as_bytes()).unwrap_err();
        assert!(error.contains(said), "{text}\n{error}");
    }
}

#[test]
fn indices_of_binary_files_are_checked() {
    for (index, said) in [(4, "face 1: there is no vertex 4"), (-1, "face 1: there is no vertex")] {
        let mut elements = corners();
        elements.push(vec![Byte(3), Int(0), Int(1), Int(3)]);
        elements.push(vec![Byte(3), Int(0), Int(1), Int(index)]);
        for format in FORMATS {
            let error =
                read(&file(format, &square(&format!("element face 2\n{FACES}")), &elements)).unwrap_err();
            assert!(error.contains(said), "{format}: {error}");
        }
    }
}

#[test]
fn counts_are_not_believed() {
    let most = Limits::default().vertices;
    for format in FORMATS {
        let header = format!("element vertex {most}\n{XYZ}");
        let error = read(&file(format, &header, &corners())).unwrap_err();
        assert!(error.contains("the file ends in vertex 4 of 1073741824"), "{error}");
        let header = square("element other 18446744073709551615\nproperty list uint double l\n");
        let mut elements = corners();
        elements.push(vec![Word(u32::MAX), Double(1.0)]);
        let error = read(&file(format, &header, &elements)).unwrap_err();
        assert!(error.contains("other 0"), "{error}");
    }
    let small = Limits { faces: 1, ..Limits::default() };
    let mut elements = corners();
    elements.push(vec![Byte(4), Int(0), Int(1), Int(2), Int(3)]);
    for format in FORMATS {
        let bytes = file(format, &square(&format!("element face 1\n{FACES}")), &elements);
        assert!(read_ply(&*bytes, "m", &small).unwrap_err().to_string().contains("more than 1 triangles"));
    }
}

#[test]
fn elements_without_properties_cost_nothing() {
    let header = square("element nothing 18446744073709551615\n");
    let bytes = file(FORMATS[1], &header, &corners());
    assert_eq!(read(&bytes).unwrap().0.positions.len(), 4);
}

proptest! {
    /// Whatever is cut off or changed, there is an error or a mesh whose indices are in range.
    #[test]
    fn broken_files_end_in_errors(cut in 0usize..1000, flips in prop::collection::vec((0usize..1000, any::<u8>()), 0..4), format in 0usize..3) {
        let mut elements = corners();
        elements.extend((0..5).map(|i| vec![Byte(3), Int(i % 4), Int((i + 1) % 4), Int((i + 2) % 4)]));
        let mut bytes = file(FORMATS[format], &square(&format!("element face 5\n{FACES}")), &elements);
        for (at, byte) in flips {
            let at = at % bytes.len();
            bytes[at] ^= byte;
        }
        bytes.truncate(bytes.len() - cut.min(bytes.len()) * usize::from(cut % 2 == 0));
        if let Ok((mesh, _)) = read(&bytes) {
            prop_assert!(mesh.faces.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// Runs that are longer than what is read at a time, with a polygon somewhere.
    #[test]
    fn long_files_come_back(n in 20_000usize..60_000, quad in 0usize..60_000, big in any::<bool>()) {
        let header = format!("element vertex {n}\n{XYZ}element face {n}\n{FACES}");
        let mut elements: Vec<Vec<Number>> = (0..n).map(|i| vec![Float(i as f32), Float(0.0), Float(1.0)]).collect();
        elements.extend((0..n as i32).map(|i| match i as usize == quad {
            true => vec![Byte(4), Int(0), Int(1), Int(2), Int(3)],
            false => vec![Byte(3), Int(i), Int(0), Int(n as i32 - 1 - i)],
        }));
        let (mesh, report) = read(&file(FORMATS[1 + usize::from(big)], &header, &elements)).unwrap();
        prop_assert_eq!(mesh.faces.len(), n + report.polygons);
        prop_assert_eq!(report.polygons, usize::from(quad < n));
        prop_assert_eq!(mesh.positions[n - 1], [(n - 1) as f32, 0.0, 1.0]);
        prop_assert_eq!(mesh.faces[n - 1 + report.polygons], [n as u32 - 1, 0, 0]);
    }
}
