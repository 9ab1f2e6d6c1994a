//! The seeds of `fuzz/corpus`, replayed and mutated with a fixed seed.

use kajo_scene::{
    Assets, Corners, Limits, MemoryAssets, MemoryBudget, MeshFileError, MeshReport, NO_INDEX, SceneDesc,
    Sources, TriMesh, VoxelValue, list_vdb, print, read_gltf, read_ies, read_mtl, read_obj, read_ply,
    read_stl, read_vdb, render, render_one, tokens,
};
use kajo_testkit::corpus;

fn check_scene(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        let mut at = 0;
        for token in tokens(text) {
            assert_eq!(token.start, at);
            assert!(text.is_char_boundary(token.end as usize) && token.end > at);
            at = token.end;
        }
        assert_eq!(at as usize, text.len());
    }
    let limits = Limits { includes: 20, items: 10_000, ..Limits::default() };
    let assets = MemoryAssets::new().with("self", data).with("b", data);
    let parsed = SceneDesc::load("self", &assets, &limits);
    let sources = parsed.desc.sources();
    for item in parsed.desc.items() {
        // Slicing checks that spans are in range and on character boundaries.
        let whole = item.span().range();
        assert!(sources.text(item.span()).starts_with(item.keyword()));
        for (_, span) in item.values() {
            assert!(!sources.text(span).is_empty());
            assert!(whole.contains(&span.range().start));
        }
    }
    for label in parsed.diagnostics.iter().flat_map(|d| &d.labels) {
        assert!(sources.get(label.span.source).text().get(label.span.range()).is_some());
    }
    let shown = render(&parsed.diagnostics, sources, false);
    assert!(shown.chars().all(|c| c == '\n' || !c.is_control()), "{shown:?}");
    if !parsed.diagnostics.has_errors() {
        let printed = print(&parsed.desc);
        let again = SceneDesc::parse("print", &*printed, &MemoryAssets::new(), &limits);
        assert!(again.diagnostics.is_empty(), "{printed}");
        assert_eq!(print(&again.desc), printed);
        assert_eq!(again.desc.len(), parsed.desc.len());
    }
}

fn check_mesh(result: Result<(TriMesh, MeshReport), MeshFileError>) {
    match result {
        Ok((mesh, _)) => {
            let finite = |v: u32| mesh.positions[v as usize].iter().all(|x| x.is_finite());
            assert!(mesh.faces.iter().flatten().all(|&v| finite(v)));
            let of_corners = [
                (&mesh.face_normals, mesh.normals.len()),
                (&mesh.face_uvs, mesh.uvs.len()),
                (&mesh.face_colors, mesh.colors.len()),
            ];
            assert!(mesh.colors.as_flattened().iter().all(|v| (0.0..=1.0).contains(v)));
            for (corners, len) in of_corners {
                match corners {
                    Corners::Absent => {}
                    Corners::Vertices => assert_eq!(len, mesh.positions.len()),
                    Corners::Own(list) => {
                        assert_eq!(list.len(), mesh.faces.len());
                        assert!(list.iter().flatten().all(|&i| i == NO_INDEX || (i as usize) < len));
                    }
                }
            }
            if let Some(materials) = &mesh.face_materials {
                assert_eq!(materials.len(), mesh.faces.len());
                let known = mesh.material_names.len();
                assert!(materials.iter().all(|&m| m == NO_INDEX || (m as usize) < known));
            }
        }
        Err(error) => {
            let mut sources = Sources::default();
            let diagnostic = error.to_diagnostic(&mut sources, None);
            assert!(render_one(&diagnostic, &sources, false).contains("error: "));
        }
    }
}

fn check_obj(data: &[u8]) {
    let limits = Limits::default();
    check_mesh(read_obj(data, "m.obj", &limits));
    let _ = read_mtl(data, "m.mtl", &limits);
}

/// SplitMix64 [Steele et al. 2014].
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// One to four of: a changed byte, a removed, doubled or foreign piece, an inserted token, a cut.
fn mutate(seed: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    const PIECES: [&[u8]; 16] = [
        b"{",
        b"}",
        b"\"",
        b"/*",
        b"*/",
        b"//",
        b"#",
        b" include b ",
        b" nan ",
        b" 1e999 ",
        b"\\\n",
        b"\xef\xbb\xbf",
        b"\xc2",
        b"/",
        b"-",
        b"\0",
    ];
    let mut data = seed.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(data.len() + 1);
        let end = (at + random.below(20)).min(data.len());
        match random.below(6) {
            0 if at < data.len() => data[at] ^= 1 << random.below(8),
            1 => drop(data.drain(at..end)),
            2 => {
                let piece = data[at..end].to_vec();
                data.splice(at..at, piece);
            }
            3 => {
                let from = random.below(other.len() + 1);
                data.splice(at..end, other[from..].iter().take(200).copied());
            }
            4 => {
                let piece = PIECES[random.below(PIECES.len())];
                let times = if random.below(10) == 0 { 300 } else { 1 };
                data.splice(at..at, piece.repeat(times));
            }
            _ => data.truncate(at),
        }
    }
    data
}

/// Shows what was tried when it makes a test fail.
struct Tried<'a> {
    name: String,
    data: &'a [u8],
}

impl Drop for Tried<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            println!("{}: b\"{}\"", self.name, self.data.escape_ascii());
        }
    }
}

/// Checks all seeds, and mutations of them: fifty times as many with `KAJO_DEEP` set.
fn run(name: &str, mutations: usize, check: impl Fn(&[u8])) {
    let mutations = if kajo_testkit::is_deep() { 50 * mutations } else { mutations };
    let seeds = corpus(name);
    for (path, data) in &seeds {
        let _tried = Tried { name: path.clone(), data };
        check(data);
    }
    let mut random = Random(2);
    for i in 0..mutations {
        let other = random.below(seeds.len());
        let data = mutate(&seeds[i % seeds.len()].1, &seeds[other].1, &mut random);
        let _tried = Tried { name: format!("mutation {i}"), data: &data };
        check(&data);
    }
}

#[test]
fn scenes_never_panic_and_keep_their_promises() {
    run("scene", 6000, check_scene);
}

#[test]
fn meshes_never_panic_and_keep_their_promises() {
    run("obj", 10_000, check_obj);
}

fn check_gltf(data: &[u8]) {
    let assets = MemoryAssets::new().with("m.gltf", data);
    let file = assets.open("m.gltf", "").expect("the file is there");
    match read_gltf(file, &assets, &Limits::default()) {
        Ok(model) => {
            for part in model.instances.iter().flat_map(|instance| &model.meshes[instance.mesh]) {
                let finite = |v: u32| part.mesh.positions[v as usize].iter().all(|x| x.is_finite());
                assert!(part.mesh.faces.iter().flatten().all(|&v| finite(v)));
                assert!(part.material.is_none_or(|material| material < model.materials.len()));
                let beads = part.points.iter().chain(part.segments.iter().flatten());
                assert!(beads.copied().all(finite));
                let count = part.mesh.positions.len();
                let lists = [part.second_uvs.len(), part.mesh.colors.len(), part.tangents.len()];
                assert!(lists.iter().all(|&n| n == 0 || n == count));
                assert!(part.mesh.colors.iter().flatten().all(|c| (0.0..=1.0).contains(c)));
            }
            for light in &model.lights {
                assert!(light.intensity.iter().all(|c| *c >= 0.0 && c.is_finite()));
            }
            for shown in model.materials.iter().filter_map(|material| material.picture) {
                assert!(model.pictures.get(shown.picture).is_none_or(Option::is_some));
            }
        }
        Err(error) => {
            let diagnostic = error.to_diagnostic(&mut Sources::default(), None);
            assert!(!diagnostic.message.is_empty());
        }
    }
}

#[test]
fn gltf_files_never_panic_and_keep_their_promises() {
    run("gltf", 10_000, check_gltf);
}

#[test]
fn ply_files_never_panic_and_keep_their_promises() {
    run("ply", 10_000, |data| check_mesh(read_ply(data, "m.ply", &Limits::default())));
}

#[test]
fn stl_files_never_panic_and_keep_their_promises() {
    run("stl", 10_000, |data| check_mesh(read_stl(data, "m.stl", &Limits::default())));
}

fn check_ies(data: &[u8]) {
    if let Ok(file) = read_ies(data) {
        assert_eq!(file.candela.len(), file.vertical_deg.len() * file.horizontal_deg.len());
        assert!(!file.candela.is_empty() && file.candela.iter().all(|v| *v >= 0.0 && v.is_finite()));
        for (angles, most) in [(&file.vertical_deg, 180.0), (&file.horizontal_deg, 360.0)] {
            assert!(angles.is_sorted_by(|a, b| a < b) && angles.iter().all(|v| (0.0..=most).contains(v)));
        }
    }
}

#[test]
fn files_of_luminaires_never_panic_and_keep_their_promises() {
    run("ies", 10_000, check_ies);
}

fn check_voxels<T: VoxelValue + std::fmt::Debug>(assets: &MemoryAssets, wanted: usize, limits: &Limits) {
    if let Ok(grid) = read_vdb::<T>(assets.open("v", "").expect("the file is there"), wanted, limits) {
        let size = grid.voxels.size();
        assert!(size.iter().all(|&n| n > 0));
        assert!(grid.map.point([0.5; 3]).iter().all(|x| x.is_finite()));
        // The corners, and the middle.
        for k in 0..9 {
            let voxel = [0, 1, 2]
                .map(|axis| if k == 8 { size[axis] / 2 } else { (k >> axis & 1) * (size[axis] - 1) });
            let shifted = [0, 1, 2].map(|axis| voxel[axis] + grid.voxels.offset()[axis]);
            assert_eq!(grid.voxels.at(voxel).bits(), grid.voxels.block(shifted).at(shifted).bits());
        }
    }
}

fn check_vdb(data: &[u8]) {
    let assets = MemoryAssets::new().with("v", data);
    let limits = Limits { memory: MemoryBudget::new(64 << 20), ..Limits::default() };
    let entries = list_vdb(assets.open("v", "").expect("the file is there"), &limits).unwrap_or_default();
    for wanted in 0..entries.len().clamp(1, 4) {
        check_voxels::<f32>(&assets, wanted, &limits);
        check_voxels::<[f32; 3]>(&assets, wanted, &limits);
    }
    assert_eq!(limits.memory.used(), 0, "what is not kept is given back");
}

#[test]
fn files_of_voxels_never_panic_and_keep_their_promises() {
    run("vdb", 2000, check_vdb);
}
