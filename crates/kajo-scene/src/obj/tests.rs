//! What the OBJ reader makes of files good and bad.

use super::*;

fn read(text: &str) -> Result<(TriMesh, MeshReport), String> {
    read_obj(text.as_bytes(), "m.obj", &Limits::default()).map_err(|error| error.to_string())
}

fn mesh(text: &str) -> TriMesh {
    read(text).unwrap().0
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n";

fn face(f: &str) -> TriMesh {
    mesh(&format!("{TRIANGLE}f {f}\n"))
}

#[test]
fn all_forms_of_a_corner() {
    const NONE: [u32; 3] = [NO_INDEX; 3];
    let own = |corners: Option<[u32; 3]>| corners.map_or(Corners::Absent, |c| Corners::Own(vec![c]));
    for (f, uvs, normals) in [
        ("1 2 3", None, None),
        ("1/1 2/2 3/1", Some([0, 1, 0]), None),
        ("1//1 2//1 3//1", None, Some([0, 0, 0])),
        ("1/2/1 2/1/1 3/2/1", Some([1, 0, 1]), Some([0, 0, 0])),
        ("-3/-1/-1 -2/-2/-1 -1/-1/-1", Some([1, 0, 1]), Some([0, 0, 0])),
        ("1/ 2// 3", None, None),
        ("+1 2/2 3//1", Some([NO_INDEX, 1, NO_INDEX]), Some([NO_INDEX, NO_INDEX, 0])),
    ] {
        let mesh = face(f);
        assert_eq!(mesh.faces, [[0, 1, 2]], "{f}");
        assert_eq!(mesh.face_uvs, own(uvs), "{f}");
        assert_eq!(mesh.face_normals, own(normals), "{f}");
    }
    let late = mesh(&format!("{TRIANGLE}f 1 2 3\nf 1//1 2//1 3//1\nf 1 2 3\n"));
    assert_eq!(late.face_normals, Corners::Own(vec![NONE, [0; 3], NONE]));
}

#[test]
fn lines_end_in_any_way_and_go_on_after_a_backslash() {
    let expected = mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for text in [
        "\u{feff}v 0 0 0\r\nv 1 0 0 # c\r\n\r\nv 0 1 0\r\nf 1 2 3",
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        "v 0 \\\n 0 0\nv 1\\\r\n0 \\\r0\n\tv 0 1 0 1\nf 1\\\n\\\n 2 3\\\n",
        "# c\n#c \\\nv 9 9 9\n\nv 0 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3 # f 4 5 6\n",
    ] {
        assert_eq!(mesh(text), expected, "{text:?}");
    }
    assert_eq!(mesh(""), TriMesh::default());
}

#[test]
fn numbers_as_scanf_reads_them() {
    assert_eq!(mesh("v +0. 3.e-1 -.5\nvt 1\nvt 1 2 3").positions, [[0.0, 0.3, -0.5]]);
    assert_eq!(mesh("vt 1\nvt 1 2 3").uvs, [[1.0, 0.0], [1.0, 2.0]]);
}

#[test]
fn polygons_are_split_also_before_their_vertices_come() {
    let vertices = "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 1 2 0\nvt 0 0\nvt 0 1\nvt 1 0\nvt 1 1\n";
    let f = "f 1/1 2/2 3/3 4/4\n";
    let (before, report) = read(&format!("{f}{vertices}")).unwrap();
    let after = mesh(&format!("{vertices}{f}"));
    assert_eq!(report.polygons, 1);
    assert_eq!(before, after);
    assert_eq!(after.face_uvs, Corners::Own(after.faces.clone()), "attributes follow their corners");
    for [a, b, c] in after.faces {
        let p = |i: u32| after.positions[i as usize];
        let (a, b, c) = (p(a), p(b), p(c));
        let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert!(turn > 0.0, "the dart's inner corner was cut wrongly");
    }
}

#[test]
fn materials_and_libraries() {
    let text = format!(
        "mtllib a.mtl B.MTL a.mtl\nmtllib my file.mtl\n{TRIANGLE}f 1 2 3\nusemtl red paint \nf 1 2 3\n\
         usemtl blue\nf 1 2 3\nusemtl red paint\nf 1 2 3\n"
    );
    let mesh = mesh(&text);
    assert_eq!(mesh.libraries, ["a.mtl", "B.MTL", "my file.mtl"]);
    assert_eq!(mesh.material_names, ["red paint", "blue"]);
    assert_eq!(mesh.face_materials, Some(vec![NO_INDEX, 0, 1, 0]));
}

#[test]
fn triangles_that_are_not_finite_are_dropped_with_all_they_have() {
    let text = "v 0 0 0\nv 1 0 0\nv nan 1 0\nv 0 1e99 0\nv 0 1 0\nvn inf 0 0\nusemtl a\n\
                f 1//1 2//1 3//1\nf 1 2 5\nusemtl b\nf 1 2 4\nf 2 1 5\n";
    let (mesh, report) = read(text).unwrap();
    assert_eq!(mesh.faces, [[0, 1, 4], [1, 0, 4]]);
    assert_eq!(mesh.face_normals, Corners::Own(vec![[NO_INDEX; 3]; 2]));
    assert_eq!(mesh.face_materials, Some(vec![0, 1]));
    assert_eq!(mesh.normals, [[0.0; 3]]);
    assert_eq!((report.dropped, report.zeroed, report.warnings().len()), (2, 1, 2));
}

#[test]
fn what_is_no_triangle_is_counted() {
    let (mesh, report) = read("o a\ng b c\ns off\nl 1 2\np 1\nl 1 2\ncurv 1\nhello\n\0\n").unwrap();
    assert!(mesh.faces.is_empty());
    let expected = [
        "`l` is not read (line 4 and 1 more)",
        "`p` is not read (line 5)",
        "`curv` is not read (line 7)",
        "`hello` is not read (line 8)",
    ];
    assert_eq!(report.warnings(), expected);
    assert_eq!(MeshReport::default().warnings(), [""; 0]);
}

#[test]
fn colours_stand_behind_coordinates() {
    let plain = mesh("v 1 2 3\nv 1 2 3 1\nv 4 5 6 0.5 7\n");
    assert_eq!((plain.colors.len(), &plain.face_colors), (0, &Corners::Absent), "weights are no colours");
    let some = mesh("v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 0 0 1 0.3\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(some.colors, [[1.0; 4], [1.0, 0.5, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0; 4]]);
    assert_eq!((some.face_colors, some.colors_are_srgb), (Corners::Vertices, true));
    let bytes = mesh("v 0 0 0 255 51 -3\nv 1 0 0 0 1 1000\n");
    assert_eq!(bytes.colors, [[1.0, 0.2, 0.0, 1.0], [0.0, 1.0 / 255.0, 1.0, 1.0]]);
    let (odd, report) = read("v 0 0 0 nan 0 0\n").unwrap();
    assert_eq!((odd.colors, report.zeroed), (vec![[1.0; 4]], 1));
    assert_eq!(read("v 0 0 0 1 0 x\n").unwrap_err(), "m.obj:1:13: expected a number, found `x`");
}

/// Files of other programs have them, and no triangle could come of them.
#[test]
fn faces_of_two_corners_are_left_out() {
    let (mesh, report) = read(&format!("{TRIANGLE}f 1 2\nf 3/1/1\nf 1 2 3\nf\n")).unwrap();
    assert_eq!((mesh.faces, mesh.face_uvs), (vec![[0, 1, 2]], Corners::Absent));
    assert_eq!(report.warnings(), ["3 faces have fewer than three corners; they were left out"]);
    assert_eq!(
        read("v 0 0 0\nf 1 0\n").unwrap_err(),
        "m.obj:2:5: vertex 0 does not exist: the first one is 1"
    );
}

#[test]
fn mistakes_have_line_column_and_reason() {
    for (text, expected) in [
        ("v 1 2\n", "1:6: expected 3 numbers after `v`, found 2"),
        ("\n  v 1 2 x3\n", "2:9: expected a number, found `x3`"),
        ("vt\n", "1:3: expected 1 number after `vt`, found 0"),
        ("v 0 0 0\nf 1 1 0\n", "2:7: vertex 0 does not exist: the first one is 1"),
        ("v 0 0 0\nf 1 1 -2\n", "2:7: vertex -2 does not exist: only 1 are defined before this line"),
        ("v 0 0 0\nf 1 1 9 \nf 1 1 2\n", "2:7: there is no vertex 9"),
        ("v 0 0 0\nf 1 1 1//7\n", "2:10: there is no normal 7"),
        ("v 0 0 0\nf 1 1 1/7\n", "2:9: there is no texture coordinate 7"),
        ("f 99999999999 1 1\n", "1:3: there is no vertex 99999999999"),
        (
            "f 99999999999999999999 1 1\n",
            "1:3: expected the number of a vertex, found `99999999999999999999`",
        ),
        ("f 4294967295 1 1\n", "1:3: there is no vertex 4294967295"),
        ("f 1.5 1 1\n", "1:3: expected the number of a vertex, found `1.5`"),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", "2:3: expected a corner such as 1, 1/2, 1//3 or 1/2/3, found `1/1/1/1`"),
        ("f é \n", "1:3: expected the number of a vertex, found `é`"),
        ("v 0 \\\r\n 0 é0\n", "2:4: expected a number, found `é0`"),
        ("f 1 1 1\n", "1:3: there is no vertex 1"),
        ("f 5 7 6\n", "1:5: there is no vertex 7"),
        ("f 1 2 3\nf 7 8 9\nf 4 5 6\n", "2:7: there is no vertex 9"),
    ] {
        let message = read(text).map(|_| ()).unwrap_err();
        assert_eq!(message, format!("m.obj:{expected}"));
    }
}

#[test]
fn limits_hold() {
    let refused = |text: &str, limits: Limits, part: &str| {
        let message = read_obj(text.as_bytes(), "m.obj", &limits).map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    };
    let limits = Limits::default;
    refused("v 0 0 0\nv 0 0 0\n", Limits { vertices: 1, ..limits() }, "2:1: the mesh has more than 1");
    refused(
        "v 0 0 0\nf 1 1 1 1\n",
        Limits { faces: 1, ..limits() },
        "2:1: the mesh has more than 1 triangles",
    );
    refused(
        "v 0 0 0\nf 1 1 1 1\n",
        Limits { polygon_corners: 3, ..limits() },
        "2:9: the polygon has more than 3",
    );
    refused("usemtl a\nusemtl b\n", Limits { materials: 1, ..limits() }, "2:8: the mesh has more than 1 mat");
    refused(&"v 0 0 0\n".repeat(100), Limits { mesh_bytes: 99, ..limits() }, "more than 99 bytes");
    let long = format!("v 0 0 0\n#{}\n", "x".repeat(1 << 20));
    refused(&long, Limits { line_bytes: 1000, ..limits() }, "m.obj:2:1: the line has more than 1000 bytes");
}

#[test]
fn mistakes_become_diagnostics_with_their_line() {
    let text = format!("{}f 1 2 99{}\n", "v 0 0 0\n".repeat(3), " ".repeat(100_000));
    let error = read_obj(text.as_bytes(), "m.obj", &Limits::default()).unwrap_err();
    let parsed = crate::SceneDesc::parse_str("obj_file m.obj");
    let named_at = parsed.desc.roots().next().unwrap().span();
    let mut desc = parsed.desc;
    let diagnostic = error.to_diagnostic(desc.sources_mut(), Some(named_at));
    let shown = crate::render_one(&diagnostic, desc.sources(), false);
    assert!(shown.contains("--> m.obj:4:7\n"), "{shown}");
    assert!(shown.contains("4 | f 1 2 99"), "{shown}");
    assert!(shown.contains("obj_file m.obj"), "{shown}");
    assert!(shown.len() < 1000, "{shown}");
}

/// Which triangles make up a face is known, also where some are left out and where vertices come later.
#[test]
fn faces_of_more_corners_are_known() {
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv nan 0 0\n";
    let polygons = |faces: &str| mesh(&format!("{corners}{faces}")).polygons;
    assert_eq!(polygons("f 1 2 3\nf 1 3 4\n"), [[0; 2]; 0]);
    assert_eq!(polygons("f 1 2 3\nf 1 2 3 4\nf 1 2 4\nf 1 2 3 4 2\n"), [[1, 2], [4, 3]]);
    assert_eq!(polygons("f 1 2 5\nf 1 2 3 4\nf 1 2 3 5\n"), [[0, 2], [2, 1]]);
    assert_eq!(mesh(&format!("f 1 2 3 4\n{corners}")).polygons, [[0, 2]]);
}
