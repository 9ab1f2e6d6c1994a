//! What the MTL reader makes of files good and bad.

use super::*;

fn read(text: &str) -> Result<MtlFile, String> {
    read_mtl(text.as_bytes(), "m.mtl", &Limits::default()).map_err(|error| error.to_string())
}

fn plain(shows: MtlMapUse, file: &str) -> MtlMap {
    let (repeat, offset) = ([1.0; 2], [0.0; 2]);
    MtlMap { shows, file: file.to_owned(), repeat, offset, clamps: false, bump: 1.0, channel: None }
}

#[test]
fn every_statement_reaches_its_field() {
    let text = "newmtl red paint # x\nKa 1 2 3\nKd 0.5\nKs 4 5 6\nKe 7 8 9\nTf 1 0 1\nNs 10\nNi 1.5\n\
                Tr 0.25\nillum 2\nmap_Kd -s 2 3 1 -o .5 -clamp on -imfchan g my wood.png\nbump -bm 0.5 b.png\n\
                NEWMTL glass\nTr 0.9\nd 0.5\npr .1\nPm .2\nPs .3\nPc .4\nPcr .5\naniso .6\nanisor .7\n\
                map_Pr r.png\nmap_Pm a\\m.png\nmap_Ps s.png\nmap_Pc c.png\nMAP_PCR cr.png\nmap_bump n.png\n\
                norm n.png\nmap_ke e.png\nmap_d d.png\nmap_d -imfchan m last.png\n";
    let file = read(text).unwrap();
    let red = MtlMaterial {
        name: "red paint # x".to_owned(),
        ambient: Some([1., 2., 3.]),
        diffuse: Some([0.5; 3]),
        specular: Some([4., 5., 6.]),
        emission: Some([7., 8., 9.]),
        transmission: Some([1., 0., 1.]),
        exponent: Some(10.0),
        index_of_refraction: Some(1.5),
        opacity: Some(0.75),
        illumination: Some(2),
        maps: vec![
            MtlMap {
                repeat: [2.0, 3.0],
                offset: [0.5, 0.0],
                clamps: true,
                channel: Some(1),
                ..plain(MtlMapUse::Diffuse, "my wood.png")
            },
            MtlMap { bump: 0.5, ..plain(MtlMapUse::Bump, "b.png") },
        ],
        ..MtlMaterial::default()
    };
    let maps = [
        (MtlMapUse::Roughness, "r.png"),
        (MtlMapUse::Metalness, "a\\m.png"),
        (MtlMapUse::Sheen, "s.png"),
        (MtlMapUse::Coat, "c.png"),
        (MtlMapUse::CoatRoughness, "cr.png"),
        (MtlMapUse::Bump, "n.png"),
        (MtlMapUse::Normals, "n.png"),
        (MtlMapUse::Emission, "e.png"),
        (MtlMapUse::Opacity, "d.png"),
    ];
    let mut maps: Vec<MtlMap> = maps.map(|(shows, file)| plain(shows, file)).into();
    maps.push(MtlMap { channel: Some(3), ..plain(MtlMapUse::Opacity, "last.png") });
    let glass = MtlMaterial {
        name: "glass".to_owned(),
        opacity: Some(0.5),
        roughness: Some(0.1),
        metalness: Some(0.2),
        sheen: Some(0.3),
        coat: Some(0.4),
        coat_roughness: Some(0.5),
        anisotropy: Some(0.6),
        anisotropy_rotation: Some(0.7),
        maps,
        ..MtlMaterial::default()
    };
    assert_eq!(glass.map(MtlMapUse::Opacity).map(|map| &*map.file), Some("last.png"), "the last one counts");
    assert_eq!(file, MtlFile { materials: vec![red, glass], skipped: Skipped::default() });
}

#[test]
fn what_is_not_read_is_named_with_its_line() {
    let text = "Kd 1 1 1\nKs 1 1 1\nnewmtl a\nsharpness 3\nhello\nmap_Ka a.png\nd -halo 0.5\nKd spectral a.rfl\n\
                map_Kd -mm 0 1 -blendu off -texres 7 -s 0 0 a.png\nsharpness 4\nmap_Pr -imfchan l r.png\n";
    let file = read(text).unwrap();
    let expected = [
        "what stands before the first `newmtl` is not read (line 1 and 1 more)",
        "`sharpness` is not read (line 4 and 1 more)",
        "`hello` is not read (line 5)",
        "`map_Ka` is not read (line 6)",
        "`-halo` is not read (line 7)",
        "`Kd spectral` is not read (line 8)",
        "`-mm` is not read (line 9)",
        "`-blendu` is not read (line 9)",
        "`-texres` is not read (line 9)",
        "`-imfchan` is not read (line 11)",
    ];
    assert_eq!(file.skipped.sentences(), expected);
    assert_eq!(file.materials[0].maps[0], plain(MtlMapUse::Diffuse, "a.png"));
}

#[test]
fn mistakes_have_line_column_and_reason() {
    for (text, expected) in [
        ("newmtl a\nKd 1 2\n", "m.mtl:2:7: expected a number after `Kd`, found the end of the line"),
        ("newmtl a\nNs x\n", "m.mtl:2:4: expected a finite number after `Ns`, found `x`"),
        ("newmtl a\nKe 1 nan 0\n", "m.mtl:2:6: expected a finite number after `Ke`, found `nan`"),
        ("newmtl a\nd 1e99\n", "m.mtl:2:3: expected a finite number after `d`, found `1e99`"),
        ("newmtl a\nPr\n", "m.mtl:2:3: expected a number after `Pr`, found the end of the line"),
    ] {
        assert_eq!(read(text).unwrap_err(), expected);
    }
    let limits = Limits { materials: 1, ..Limits::default() };
    assert!(read_mtl(&b"newmtl a\nnewmtl b\n"[..], "m", &limits).is_err());
}

#[test]
fn files_of_blender_are_known_by_their_first_line() {
    let said = |head: &str| read(&format!("{head}newmtl a\nTf 1 1 1\n")).unwrap().materials[0].by_blender;
    assert!(said("# Blender 5.0.1 MTL File: 'None'\n# www.blender.org\n\n"));
    assert!(!said("") && !said("# made with another program, not Blender \n") && !said("# Blenders\n"));
}
