//! Any bytes as an OBJ mesh and as an MTL file.

#![no_main]

use kajo_scene::{Corners, Limits, NO_INDEX, Sources, read_mtl, read_obj, render_one};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let limits = Limits::default();
    match read_obj(data, "m.obj", &limits) {
        Ok((mesh, _)) => {
            for &v in mesh.faces.iter().flatten() {
                assert!(mesh.positions[v as usize].iter().all(|x| x.is_finite()));
            }
            let in_range = |corners: &Corners, len: usize| match corners {
                Corners::Absent => true,
                Corners::Vertices => len == mesh.positions.len(),
                Corners::Own(list) => list.iter().flatten().all(|&i| i == NO_INDEX || (i as usize) < len),
            };
            assert!(in_range(&mesh.face_normals, mesh.normals.len()));
            assert!(in_range(&mesh.face_uvs, mesh.uvs.len()));
            assert!(in_range(&mesh.face_colors, mesh.colors.len()));
        }
        Err(error) => {
            let mut sources = Sources::default();
            let diagnostic = error.to_diagnostic(&mut sources, None);
            render_one(&diagnostic, &sources, false);
        }
    }
    let _ = read_mtl(data, "m.mtl", &limits);
});
