//! What the STL reader makes of files good and bad.

use super::*;
use proptest::prelude::*;

fn read(bytes: &[u8]) -> Result<(TriMesh, MeshReport), String> {
    read_stl(bytes, "m.stl", &Limits::default()).map_err(|error| error.to_string())
}

type Triangle = [[f32; 3]; 3];

const SQUARE: [Triangle; 2] = [
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
    [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
];

fn binary(header: &str, triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        // A normal that is wrong on purpose.
        let floats = [7.0; 3].into_iter().chain(triangle.iter().flatten().copied());
        bytes.extend(floats.flat_map(f32::to_le_bytes).chain([1, 2]));
    }
    bytes
}

fn text(triangles: &[Triangle]) -> String {
    let mut text = "solid a b c\n".to_owned();
    for triangle in triangles {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for [x, y, z] in triangle {
            text += &format!("      vertex {x:e} {y} {z}\n");
        }
        text += "    endloop\n  endfacet\n";
    }
    text + "endsolid a b c\n"
}

#[test]
fn both_kinds_give_the_same_welded_mesh() {
    let (mesh, report) = read(&binary("made by hand", &SQUARE)).unwrap();
    assert_eq!(mesh.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.faces, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(report, MeshReport::default());
    let lines = text(&SQUARE);
    for text in [lines.clone(), lines.to_uppercase(), lines.replace('\n', "\r\n"), lines.clone() + &lines] {
        let (again, _) = read(text.as_bytes()).unwrap();
        assert_eq!(again.positions, mesh.positions);
        assert_eq!(again.faces[..2], mesh.faces);
    }
    assert_eq!(read((lines.clone() + &lines).as_bytes()).unwrap().0.faces.len(), 4, "two solids");
}

#[test]
fn a_binary_file_may_begin_with_solid() {
    assert_eq!(read(&binary("solid thing", &SQUARE)).unwrap().0.faces.len(), 2);
    // No zero byte in the header, but in the count.
    assert_eq!(read(&binary(&"solid x".repeat(12)[..80], &SQUARE)).unwrap().0.faces.len(), 2);
    assert_eq!(read(b"solid\nendsolid\n").unwrap().0, TriMesh::default());
}

#[test]
fn corners_that_are_not_finite_cost_their_triangle() {
    let mut triangles = SQUARE;
    triangles[1][2][1] = f32::NAN;
    let (mesh, report) = read(&binary("", &triangles)).unwrap();
    assert_eq!((mesh.faces.len(), mesh.positions.len(), report.dropped), (1, 3, 1));
}

#[test]
fn facets_may_have_more_corners() {
    let quad = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid\n";
    let (mesh, report) = read(quad.as_bytes()).unwrap();
    assert_eq!((mesh.faces.len(), mesh.positions.len(), report.polygons), (2, 4, 1));
}

#[test]
fn mistakes_are_told_with_their_place() {
    let whole = binary("", &SQUARE);
    let head = "solid a\nfacet normal 0 0 1\nouter loop\n";
    for (bytes, said) in [
        (whole[..180].to_vec(), "m.stl: byte 134: the file ends in triangle 1 of 2"),
        (whole[..83].to_vec(), "begins with `solid` or has a header of 84 bytes"),
        (Vec::new(), "begins with `solid`"),
        (
            format!("{head}vertex 0 0\n").into_bytes(),
            "m.stl:4:11: expected 3 numbers after `vertex`, found 2",
        ),
        (format!("{head}vertex 0 0 z\n").into_bytes(), "m.stl:4:12: expected a number, found `z`"),
        (
            format!("{head}vertex 0 0 1\nendloop\n").into_bytes(),
            "m.stl:5:1: a facet needs at least 3 vertices, found 1",
        ),
        (format!("{head}vortex\n").into_bytes(), "m.stl:4:1: expected `facet`"),
        (head.as_bytes().to_vec(), "the file ends before `endsolid`"),
    ] {
        let error = read(&bytes).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
    let mut claims = whole.clone();
    claims[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(read(&claims).unwrap_err().contains("the file ends in triangle 2 of 4294967295"));
    let mut longer = whole;
    longer.push(0);
    assert_eq!(read(&longer).unwrap().1.left_out.len(), 1);
    let few = Limits { vertices: 3, ..Limits::default() };
    let error = read_stl(&*binary("", &SQUARE), "m", &few).unwrap_err().to_string();
    assert!(error.contains("more than 3 vertices"), "{error}");
}

proptest! {
    #[test]
    fn broken_files_end_in_errors(
        cut in 0usize..400, flips in prop::collection::vec((0usize..400, any::<u8>()), 0..4), as_text in any::<bool>()
    ) {
        let mut bytes = if as_text { text(&SQUARE).into_bytes() } else { binary("solid", &SQUARE) };
        for (at, byte) in flips {
            let at = at % bytes.len();
            bytes[at] ^= byte;
        }
        bytes.truncate(bytes.len() - cut.min(bytes.len()) * usize::from(cut % 2 == 0));
        if let Ok((mesh, _)) = read(&bytes) {
            prop_assert!(mesh.faces.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
            prop_assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn triangles_come_back_in_both_kinds(points in prop::collection::vec(prop::array::uniform9(-1e3f32..1e3), 0..40)) {
        let triangles: Vec<Triangle> = points.iter().map(|p| [[p[0], p[1], p[2]], [p[3], p[4], p[5]], [p[6], p[7], p[8]]]).collect();
        for bytes in [binary("x", &triangles), text(&triangles).into_bytes()] {
            let (mesh, _) = read(&bytes).unwrap();
            let back: Vec<Triangle> = mesh.faces.iter().map(|f| f.map(|v| mesh.positions[v as usize])).collect();
            prop_assert_eq!(&back, &triangles);
        }
    }
}
