//! Media as the language writes them, and what is said of those that are none.

use std::sync::LazyLock;

use kajo_color::Wavelengths;
use kajo_math::Vec3;
use kajo_scene::{Diagnostics, Limits, MemoryAssets, MemoryBudget, SceneDesc};
use kajo_testkit::nano_vdb;
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

use super::{CompileOptions, compile};
use crate::scene::Scene;

static FILES: LazyLock<MemoryAssets> = LazyLock::new(|| {
    MemoryAssets::new()
        .with("cloud.df3", [0, 2, 0, 1, 0, 1, 255, 51])
        .with("short.df3", [0, 9, 0, 9, 0, 9, 255])
        .with("empty.vol", [])
        .with("bytes.raw", [0, 255, 51, 102])
        .with("haze.txt", "# degrees, value\n0 30\n90, 0.5\n180 1\n")
        .with("back.txt", "180 1\n0 1\n")
        .with("columns.txt", "# angle red green blue\n0 2 1 0\n180 0 1 2\n")
        .with("words.txt", "0 1\nback 2\n")
        .with("binary.txt", [0xff, 0xfe, 0x00])
        .with("cloud.vdb", cloud_vdb())
        .with("cloud.nvdb", nano_vdb::to_bytes(&[smoke("density", [1.0, 0.5])], VdbCompression::Zip))
        .with("cut.vdb", &cloud_vdb()[..2000])
});

/// A grid of three voxels, the middle one empty.
fn smoke(name: &str, values: [f32; 2]) -> VdbGrid {
    let mut grid = VdbGrid::new(name, VdbKind::Float, VdbMap::ScaleTranslate([2.0; 3], [10.0, 0.0, 0.0]));
    grid.set([-1, 0, 0], [values[0]; 3]);
    grid.set([1, 0, 0], [values[1]; 3]);
    grid
}

fn cloud_vdb() -> Vec<u8> {
    let mut colors = smoke("Cd", [1.0; 2]);
    colors.kind = VdbKind::Vec3;
    let mut bright = smoke("bright", [0.5, 1.5]);
    bright.kind = VdbKind::Vec3;
    let mut dark = smoke("dark", [1.0, -0.5]);
    dark.kind = VdbKind::Vec3;
    let vectors = |name: &str| {
        let mut grid = smoke(name, [0.5, if name == "gale" { f32::INFINITY } else { -1.0 }]);
        grid.kind = VdbKind::Vec3;
        grid
    };
    let grids = vec![
        colors,
        bright,
        dark,
        smoke("flame", [2.0, 3.0]),
        smoke("density", [1.0, 0.5]),
        smoke("sdf", [1.0, -0.5]),
        smoke("bad", [1.0, f32::NAN]),
        vectors("vel"),
        vectors("gale"),
        smoke("vel.x", [1.0, 2.0]),
        smoke("wind_X", [1.0, 2.0]),
        smoke("wind_Y", [0.0; 2]),
        smoke("wind_Z", [0.5; 2]),
        smoke("half_x", [1.0; 2]),
    ];
    VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids }.to_bytes()
}

fn compiled(text: &str) -> (Option<Scene>, Vec<String>) {
    let limits = Limits { memory: MemoryBudget::new(64 << 20), ..Limits::default() };
    let options = CompileOptions { limits, ..CompileOptions::default() };
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
    let mut parsed = SceneDesc::parse_str(&format!("{camera} {text}"));
    let mut diagnostics = Diagnostics::default();
    let scene = compile(&mut parsed.desc, &*FILES, &options, &mut diagnostics);
    (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
}

fn media(text: &str) -> (Option<Scene>, Vec<String>) {
    compiled(&format!("Media {{ {text} }}"))
}

#[test]
fn coefficients_are_said_in_three_ways() {
    for (text, sigma_a, sigma_s) in [
        ("sigma_a 1 2 3 sigma_s 4", [1.0, 2.0, 3.0], [4.0; 3]),
        ("albedo 0.25 density 4 8 0 scale 0.5", [1.5, 3.0, 0.0], [0.5, 1.0, 0.0]),
        ("albedo 0 0.5 1 meanFreePath 0.5", [2.0, 1.0, 0.0], [0.0, 1.0, 2.0]),
        ("density 3", [0.0; 3], [3.0; 3]),
    ] {
        let (scene, said) = media(&format!("Medium m {{ {text} }} exterior m"));
        let scene = scene.unwrap_or_else(|| panic!("{text}: {said:?}"));
        let media = &scene.appearance.media;
        let made = media.coefficients(scene.lighting.air.expect("the air"));
        let rgb = Wavelengths::RGB;
        assert_eq!((made.sigma_a(&rgb).to_rgb(), made.sigma_s(&rgb).to_rgb()), (sigma_a, sigma_s), "{text}");
    }
}

/// A phase function is said by its word, or by what belongs to one of them alone.
#[test]
fn phase_functions_are_said_by_words_and_by_numbers() {
    for (text, name, mean_cosine) in [
        ("", "Isotropic", 0.0),
        ("g 0.5", "HenyeyGreenstein", 0.5),
        ("phase rayleigh", "Rayleigh", 0.0),
        ("phase mie", "Mie", 0.8793),
        ("droplets 5", "Mie", 0.8434),
        ("phase mie droplets 50", "Mie", 0.8912),
        ("phaseTable 0 2 180 0", "Table", 0.333),
        ("phaseAngle cosine phaseTable -1 0 1 7", "Table", 0.333),
        ("phase table phaseFile haze.txt", "Table", 0.6042),
        ("phaseColors on phaseTable 0 2 3 4 180 0 0 0", "Table", 0.333),
        ("phaseColors on phaseTable 0 2 1 0 180 0 1 1", "ColorTable", 0.0),
        ("phaseWavelengths 500 600 phaseTable 0 2 3 180 0 0", "Table", 0.333),
        ("phaseWavelengths 400 410 420 phaseFile columns.txt", "ColorTable", -0.3285),
        ("phaseColors on phaseFile columns.txt", "ColorTable", 0.0),
    ] {
        let (scene, said) = media(&format!("Medium m {{ density 1 {text} }} exterior m"));
        let scene = scene.filter(|_| said.is_empty()).unwrap_or_else(|| panic!("{text}: {said:?}"));
        let phase = scene.appearance.media.coefficients(scene.lighting.air.expect("the air")).phase();
        assert!(format!("{phase:?}").starts_with(name), "{text}: {phase:?}");
        assert!((phase.mean_cosine() - mean_cosine).abs() < 1e-3, "{text}: {}", phase.mean_cosine());
    }
    for (text, message) in [
        ("phase rayleigh g 0.5", "`g` has no effect with this `phase`"),
        ("phase isotropic droplets 20", "`droplets` has no effect with this `phase`"),
        ("phase mie phaseTable 0 1 180 1", "`phaseTable` has no effect with this `phase`"),
        ("phaseAngle cosine", "`phaseAngle` has no effect without `phaseTable` or `phaseFile`"),
        ("phaseColors on", "`phaseColors` has no effect without `phaseTable` or `phaseFile`"),
        ("phaseWavelengths 500", "`phaseWavelengths` has no effect without `phaseTable` or `phaseFile`"),
    ] {
        let (scene, said) = media(&format!("Medium m {{ density 1 {text} }}"));
        assert!(scene.is_some() && said == [message], "{text}: {said:?}");
    }
}

#[test]
fn grids_come_from_files_and_from_the_text() {
    for text in [
        "GridMedium m { file cloud.df3 density 1 }",
        "GridMedium m { file bytes.raw size 4 1 1 encoding u8 density 1 }",
        "GridMedium m { size 2 1 1 values 0 1 density 1 min 0 0 0 max 1 2 3 }",
        "GridMedium m { file cloud.vdb density 1 }",
        "GridMedium m { file cloud.vdb grid flame density 1 min 0 0 0 }",
        "GridMedium m { file cloud.nvdb density 1 } exterior m",
        "GridMedium m { file cloud.vdb density 1 temperature flame temperatureScale 900 temperatureOffset 300 brightness 2 }",
        "GridMedium m { file cloud.vdb sigma_a 0 temperature flame }",
        "GridMedium m { file cloud.vdb density 1 albedoGrid Cd temperature flame }",
        "GridMedium m { file cloud.vdb temperature flame }",
        "GridMedium m { file cloud.vdb density 1 velocity vel }",
        "GridMedium m { file cloud.vdb density 1 velocity wind velocityScale -2 albedoGrid Cd } exterior m",
        "GridMedium m { file cloud.vdb grid bright density 1 temperature flame velocity wind min 3 -1 -1 }",
        "GridMedium m { file cloud.vdb grid bright density 1 albedoGrid Cd temperature flame max 19 1 1 }",
        "FunctionMedium m { function = x + y density 1 }",
        "Medium m { emission blackbody 1900 5 }",
        "Medium m { emission 1 2 3  sigma_a 1 } exterior m",
        "FunctionMedium m { function = x  emission 1 } exterior m",
        "TextureMedium m { texture = 0.5 + 0.5 * x density 1 }",
    ] {
        let (scene, said) = media(text);
        assert!(scene.is_some() && said.is_empty(), "{text}: {said:?}");
    }
}

/// A grid of a file is where the file says, or in the box that the scene says.
#[test]
fn voxels_of_a_file_have_their_places() {
    for (text, corners, places) in [
        ("file cloud.vdb", [[7.0, -1.0, -1.0], [13.0, 1.0, 1.0]], [8.0, 10.0, 12.0]),
        ("file cloud.nvdb", [[7.0, -1.0, -1.0], [13.0, 1.0, 1.0]], [8.0, 10.0, 12.0]),
        ("file cloud.vdb min 0 0 0 max 3 1 1", [[0.0; 3], [3.0, 1.0, 1.0]], [0.5, 1.5, 2.5]),
        ("file cloud.vdb max 19 1 1", [[7.0, -1.0, -1.0], [19.0, 1.0, 1.0]], [9.0, 13.0, 17.0]),
    ] {
        let (scene, said) = media(&format!("GridMedium m {{ {text} density 1 }} exterior m"));
        let scene = scene.unwrap_or_else(|| panic!("{text}: {said:?}"));
        let (air, media) = (scene.lighting.air.expect("the air"), &scene.appearance.media);
        let bounds = media.bounds(air).expect("an end");
        let is_at = |found: Vec3, corner: [f32; 3]| found.abs_diff_eq(corner.into(), 1e-4);
        assert!(is_at(bounds.min, corners[0]) && is_at(bounds.max, corners[1]), "{text}: {bounds:?}");
        let y = 0.5 * (bounds.min.y + bounds.max.y);
        let found = places.map(|x| scene.appearance.density(air, Vec3::new(x, y, y)));
        assert_eq!(found, [1.0, 0.0, 0.5], "{text}");
    }
}

/// A grid of colours has a density for each of red, green and blue; that of all is the largest.
#[test]
fn colours_of_a_file_are_densities() {
    let (scene, said) = media("GridMedium m { file cloud.vdb grid bright density 2 } exterior m");
    let scene = scene.filter(|_| said.is_empty()).unwrap_or_else(|| panic!("{said:?}"));
    let (air, media) = (scene.lighting.air.expect("the air"), &scene.appearance.media);
    assert!(media.has_colored_density(air));
    let found = [8.0, 12.0].map(|x| scene.appearance.density(air, x * Vec3::X));
    assert_eq!(found, [0.5, 1.5]);
}

#[test]
fn mistakes_are_named() {
    for (text, expected) in [
        ("Medium m { }", "this medium has no density"),
        ("Medium { density 1 }", "`Medium` has no name"),
        ("Medium m { density 1 } Medium m { density 2 }", "there are two media named `m`"),
        ("Medium m { sigma_a -1 }", "`sigma_a` is not negative"),
        ("Medium m { sigma_s 1 2 -0.5 }", "`sigma_s` is not negative"),
        ("Medium m { density 1 albedo 1.5 }", "`albedo` is from 0 to 1"),
        ("Medium m { density 1 albedo 0.5 sigma_a 1 }", "`albedo` cannot stand beside `sigma_a`"),
        ("Medium m { density 1 meanFreePath 2 }", "`density` cannot stand beside `meanFreePath`"),
        ("Medium m { meanFreePath 0 }", "`meanFreePath` is more than 0"),
        ("Medium m { density 1 g 1 }", "`g` is more than -1 and less than 1"),
        ("Medium m { density 1 g -1.5 }", "`g` is more than -1 and less than 1"),
        ("Medium m { density 1 droplets 4 }", "`droplets` must be at least 5 and at most 50, found 4"),
        ("Medium m { density 1 droplets 51 }", "`droplets` must be at least 5 and at most 50, found 51"),
        ("Medium m { density 1 droplets 9 g 0.5 }", "`g` cannot stand beside `droplets`"),
        ("Medium m { density 1 phase table }", "`phase table` has no numbers"),
        (
            "Medium m { density 1 phaseTable 0 1 90 }",
            "`phaseTable`: rows are of an angle and a value: 3 numbers",
        ),
        (
            "Medium m { density 1 phaseColors on phaseTable 0 1 1 1 90 1 }",
            "`phaseTable`: rows are of an angle and 3 values: 6 numbers",
        ),
        (
            "Medium m { density 1 phaseColors on phaseTable 0 1 1 1 90 1 -1 1 }",
            "`phaseTable`: row 2, value 2: a value is finite and not negative",
        ),
        ("Medium m { density 1 phaseColors on phaseTable 0 1 0 1 90 1 0 1 }", "all values of column 2 are 0"),
        (
            "Medium m { density 1 phaseWavelengths 500 450 phaseTable 0 1 1 90 1 1 }",
            "`phaseWavelengths`: wavelength 2: wavelengths are positive",
        ),
        (
            "Medium m { density 1 phaseWavelengths 500 450 phaseTable 0 1 90 1 }",
            "an angle and 2 values: 4 numbers",
        ),
        (
            "Medium m { density 1 phaseWavelengths 450 500 phaseFile columns.txt }",
            "cannot read `columns.txt`: line 2: expected an angle and 2 values, found `0 2 1 0`",
        ),
        (
            "Medium m { density 1 phaseColors on phaseWavelengths 450 phaseTable 0 1 90 1 }",
            "`phaseColors` cannot stand beside",
        ),
        (
            "Medium m { density 1 phaseTable 0 1 }",
            "at least two rows of an angle and a value, and here is one",
        ),
        ("Medium m { density 1 phaseTable 0 1 200 1 }", "row 2: an angle is from 0 to 180 degrees"),
        ("Medium m { density 1 phaseTable 90 1 0 1 }", "row 2: angles, or their cosines, must increase"),
        ("Medium m { density 1 phaseTable 0 1 180 -2 }", "row 2: a value is finite and not negative"),
        ("Medium m { density 1 phaseTable 0 0 180 0 }", "all values are 0"),
        ("Medium m { density 1 phaseAngle cosine phaseTable -1 1 2 1 }", "row 2: a cosine is from -1 to 1"),
        (
            "Medium m { density 1 phaseTable 0 1 180 1 phaseFile haze.txt }",
            "`phaseTable` cannot stand beside",
        ),
        ("Medium m { density 1 phaseFile none.txt }", "cannot read `none.txt`: there is no such file"),
        ("Medium m { density 1 phaseFile back.txt }", "cannot read `back.txt`: row 2: angles"),
        ("Medium m { density 1 phaseFile words.txt }", "`words.txt`: line 2: expected an angle and a value"),
        ("Medium m { density 1 phaseFile binary.txt }", "cannot read `binary.txt`: it is not text"),
        ("Medium m { density 1 scale -1 }", "at least 0"),
        ("Medium m { density 1 } exterior n", "there is no medium named `n`"),
        ("Medium m { emission 1 } exterior m", "endlessly bright"),
        ("Medium m { emission 1 sigma_a 1 0 1 } exterior m", "endlessly bright"),
        ("Medium m { emission -1 }", "negative"),
        ("TextureMedium m { density 1 }", "expected one `texture`, found 0"),
        ("TextureMedium m { texture 0.5 density 1 min 1 1 1 }", "must be less than that of `max`"),
        ("TextureMedium m { texture 0.5 }", "this medium has no density"),
        ("GridMedium m { density 1 }", "file"),
        ("GridMedium m { density 1 values 1 2 }", "size"),
        ("GridMedium m { density 1 size 2 2 2 values 1 2 }", "a grid of 8 voxels has 2 values"),
        ("GridMedium m { density 1 size 2 1 1 values 1 -2 }", "value 1 of the grid is -2"),
        ("GridMedium m { density 1 size 1 1 1 values 1 min 1 1 1 max 1 2 2 }", "`min` must be less"),
        ("GridMedium m { density 1 file none.vol }", "cannot read `none.vol`: there is no such file"),
        ("GridMedium m { density 1 file short.df3 }", "the file ends after 1 of its 729 values"),
        ("GridMedium m { density 1 file empty.vol }", "the file ends within its header"),
        ("GridMedium m { density 1 file cloud.vdb grid flames }", "there is no grid `flames` in `cloud.vdb`"),
        ("GridMedium m { density 1 file cloud.vdb grid dark }", "voxel (2, 0, 0) of the grid is -0.5"),
        ("IndexGrid m { file cloud.vdb grid Cd }", "the grid `Cd` has 3 numbers in a voxel, not 1"),
        ("GridMedium m { density 1 file cloud.vdb grid sdf }", "voxel (2, 0, 0) of the grid is -0.5"),
        ("GridMedium m { density 1 file cloud.vdb min 99 0 0 }", "`min` must be less"),
        ("GridMedium m { density 1 file cloud.df3 grid density }", "there is one grid in `cloud.df3`"),
        ("GridMedium m { density 1 file cut.vdb }", "cannot read `cut.vdb`: the file ends within a grid"),
        (
            "GridMedium m { density 1 file cloud.vdb temperature heat }",
            "there is no grid `heat` in `cloud.vdb`",
        ),
        (
            "GridMedium m { density 1 file cloud.vdb temperature bad }",
            "voxel (2, 0, 0) of the temperatures is NaN",
        ),
        ("GridMedium m { density 1 file cloud.vdb albedoGrid Cs }", "there is no grid `Cs` in `cloud.vdb`"),
        (
            "GridMedium m { density 1 file cloud.vdb albedoGrid density }",
            "the grid `density` has 1 numbers in a voxel, not 3",
        ),
        (
            "GridMedium m { density 1 file cloud.vdb albedoGrid bright }",
            "voxel (2, 0, 0) of the colours is 1.5 1.5 1.5: each is from 0 to 1",
        ),
        ("GridMedium m { density 1 file cloud.df3 albedoGrid Cd }", "`albedoGrid` names a grid of a .vdb"),
        (
            "GridMedium m { density 1 size 1 1 1 values 1 albedoGrid Cd }",
            "`albedoGrid` cannot stand without `file`",
        ),
        ("GridMedium m { density 1 file cloud.vdb temperature flame emission 1 }", "cannot stand beside"),
        (
            "GridMedium m { density 1 file cloud.vdb brightness 2 }",
            "`brightness` cannot stand without `temperature`",
        ),
        (
            "GridMedium m { density 1 file cloud.df3 temperature flame }",
            "`temperature` names a grid of a .vdb",
        ),
        ("GridMedium m { density 1 file cloud.vdb temperature flame brightness -1 }", "at least 0"),
        (
            "GridMedium m { density 1 file cloud.vdb velocity speed }",
            "there is no grid `speed` in `cloud.vdb`",
        ),
        ("GridMedium m { density 1 file cloud.vdb velocity half }", "there is no grid `half` in `cloud.vdb`"),
        (
            "GridMedium m { density 1 file cloud.vdb velocity density }",
            "the grid `density` has 1 numbers in a voxel, not 3",
        ),
        (
            "GridMedium m { density 1 file cloud.vdb velocity gale }",
            "voxel (2, 0, 0) of the velocities is inf",
        ),
        ("GridMedium m { density 1 file cloud.df3 velocity vel }", "`velocity` names a grid of a .vdb"),
        (
            "GridMedium m { density 1 file cloud.vdb velocityScale 2 }",
            "`velocityScale` cannot stand without `velocity`",
        ),
        (
            "GridMedium m { density 1 file cloud.vdb velocity vel velocityScale 1e9 }",
            "more than 100 times as far as its grid is wide",
        ),
        (
            "GridMedium m { density 1 file bytes.raw size 4 1 1 encoding u8 grid a }",
            "`grid` cannot stand beside `size`",
        ),
        ("GridMedium m { density 1 grid a size 2 1 1 values 1 2 }", "`grid` cannot stand without `file`"),
        (
            "GridMedium m { density 1 file bytes.raw size 10000 10000 10000 encoding u8 }",
            "the file ends after 4 of its 1000000000000 values",
        ),
        ("FunctionMedium m { density 1 function = 1 / x }", "the function has no bound"),
        ("FunctionMedium m { density 1 function = x min 1 1 1 }", "`min` must be less"),
        ("GradientIndex m { }", "`GradientIndex` needs `index`"),
        ("GradientIndex m { index 1.5 } exterior m", "fills closed bodies only"),
        ("IndexGrid m { }", "`IndexGrid` needs `file`"),
        ("IndexGrid m { size 2 2 2 values 1 1 1 }", "2 x 2 x 2 points need as many numbers, and there are 3"),
        (
            "IndexGrid m { size 2 1 1 values 0 1 offset 1 scale -1 }",
            "an index of refraction is above 0, and at the point 1 0 0 of the grid it is 0",
        ),
        ("IndexGrid m { size 1 1 1 values 1.5 min 1 0 0 max 1 1 1 }", "must be less than that of `max`"),
        ("LuneburgLens m { radius 0 }", "`radius` must be more than 0"),
        ("RodLens m { axis 0 0 0 }", "`axis` must not be zero"),
        ("AirLayers m { depth 0 }", "`depth` must be more than 0"),
        ("AirLayers m { integrator euler steps 0 }", "`steps`"),
    ] {
        let (scene, said) = media(text);
        assert!(scene.is_none() && said.iter().any(|s| s.contains(expected)), "{text}: {said:?}");
    }
}

/// Bodies that bend light are closed, bounded and at rest, and nothing but their inside bends it.
#[test]
fn bodies_that_bend_light_are_closed_and_bounded_and_at_rest() {
    let of = |shape: &str, material: &str| {
        compiled(&format!(
            "Media {{ LuneburgLens m {{ }} }} Materials {{ Interface i {{ medium m }} {material} }}
             Group {{ MaterialIndex i {shape} }}"
        ))
    };
    for (shape, expected) in [
        ("Disk { center 0 0 0 normal 0 1 0 radius 1 }", "a medium fills closed shapes, and this one is open"),
        ("Plane { normal 0 1 0 offset 0 }", "a body that bends light has bounds, and this one has none"),
        (
            "Transform { Motion { key 0 { } key 1 { Translate 1 0 0 } } Sphere { center 0 0 0 radius 1 } }",
            "a body that bends light does not move",
        ),
    ] {
        let (scene, said) = of(shape, "");
        assert!(scene.is_none() && said.iter().any(|said| said == expected), "{shape}: {said:?}");
    }
    let (scene, said) = of("Sphere { center 0 0 0 radius 1 }", "Glass g { medium m }");
    let expected =
        "a medium that bends light can only fill a body with the material `Interface`, not with `Glass`";
    assert!(scene.is_none() && said == [expected], "{said:?}");
    for shape in [
        "Sphere { center 0 0 0 radius 1 }",
        "Difference { Box { min -1 -1 -1 max 1 1 1 } Sphere { center 0 0 0 radius 0.5 } }",
    ] {
        let (scene, said) = of(shape, "");
        let scene = scene.unwrap_or_else(|| panic!("{shape}: {said:?}"));
        assert!(scene.appearance.bends_light && !scene.has_media() && said.is_empty(), "{said:?}");
    }
}

#[test]
fn a_medium_in_an_open_shape_is_refused() {
    let of = |shape: &str| {
        compiled(&format!(
            "Media {{ Medium m {{ density 1 }} }} Materials {{ Interface i {{ medium m }} Glass g {{ medium m }} }}
             Group {{ MaterialIndex i {shape} }}"
        ))
    };
    for shape in
        ["Quad { corner 0 0 0 edge1 1 0 0 edge2 0 1 0 }", "Disk { center 0 0 0 normal 0 1 0 radius 1 }"]
    {
        let (scene, said) = of(shape);
        assert!(
            scene.is_none() && said == ["a medium fills closed shapes, and this one is open"],
            "{said:?}"
        );
    }
    for shape in ["Sphere { center 0 0 0 radius 1 }", "Plane { normal 0 1 0 offset 0 }"] {
        let (scene, said) = of(shape);
        assert!(scene.is_some_and(|scene| scene.has_media()), "{shape}: {said:?}");
    }
    let (_, said) = compiled("Materials { Glass g { medium milk } }");
    assert_eq!(said, ["there is no medium named `milk`"]);
}

#[test]
fn a_body_below_a_surface_is_filled_with_its_colour() {
    let of = |keys: &str, shape: &str| {
        compiled(&format!(
            "Textures {{ Clouds share {{ }} Ramp paint {{ texture share  stop 0 0.3 0.3 0.3  stop 1 0.9 0.5 0.5 }} }}
             Materials {{ Principled b {{ {keys} }} }} Group {{ MaterialIndex b {shape} }}"
        ))
    };
    let ball = "Sphere { center 0 0 0 radius 1 }";
    let sigma_t = |keys: &str| {
        let (scene, said) = of(keys, ball);
        let scene = scene.filter(|_| said.is_empty()).unwrap_or_else(|| panic!("{keys}: {said:?}"));
        assert!(scene.appearance.has_subsurface && scene.has_media() && scene.geometry.transmits);
        let media = &scene.appearance.media;
        let made = media.coefficients(media.ids().next().expect("a medium"));
        let rgb = Wavelengths::RGB;
        let [a, s] = [made.sigma_a(&rgb), made.sigma_s(&rgb)];
        ((a + s).to_rgb().map(|v| (v * 1e3).round() / 1e3), a.to_rgb()[1] == 0.0, made.phase().mean_cosine())
    };
    assert_eq!(sigma_t("subsurface 1"), ([20.0, 100.0, 200.0], false, 0.0));
    assert_eq!(
        sigma_t(
            "color 0.5 1 0.5  subsurface 0.5  subsurfaceRadius 2  subsurfaceScale 0.25  subsurfaceAnisotropy 0.7"
        ),
        ([2.0; 3], true, 0.7)
    );
    // A colour that differs from place to place is one of the surface.
    assert!(sigma_t("color paint  subsurface 1").1);
    assert!(sigma_t("subsurface share  metalness share  priority 3").0[0] > 0.0);

    let without = of("subsurface 0  color 0.5 0.5 0.5", ball).0.expect("a scene");
    assert!(!without.has_media() && !without.geometry.transmits && !without.appearance.has_subsurface);

    for (keys, shape, message) in [
        (
            "subsurface 1",
            "Disk { center 0 0 0 normal 0 1 0 radius 1 }",
            "a medium fills closed shapes, and this one is open",
        ),
        (
            "subsurface 1 transmission 0.5",
            ball,
            "`transmission` cannot stand beside `subsurface`: a body has one inside",
        ),
        ("subsurface 1 opacity 0.5", ball, "light passes this material anyway, so that it can have no holes"),
        ("subsurface 1 subsurfaceRadius 1 0 1", ball, "`subsurfaceRadius` is more than 0"),
        (
            "subsurface 1 subsurfaceRadius 1e-30 subsurfaceScale 1e-30",
            ball,
            "`subsurfaceRadius` times `subsurfaceScale` is out of range",
        ),
    ] {
        let (scene, said) = of(keys, shape);
        assert!(scene.is_none() && said == [message], "{keys}: {said:?}");
    }
    for keys in ["subsurface 2", "subsurface 1 subsurfaceAnisotropy 1", "subsurface 1 subsurfaceScale 0"] {
        let (scene, said) = of(keys, ball);
        assert!(scene.is_none() && said.len() == 1, "{keys}: {said:?}");
    }
    for (keys, message) in [
        ("subsurfaceScale 3", "`subsurfaceScale` has no effect without `subsurface`"),
        (
            "subsurface 1 metalness 1",
            "`subsurface` has no effect with `metalness 1`: light does not enter metal",
        ),
        ("subsurface 1 thin on", "`thin` has no effect beside `subsurface`"),
        ("subsurface 1 diffuseRoughness 1", "`diffuseRoughness` has no effect beside `subsurface`"),
    ] {
        let (scene, said) = of(keys, ball);
        assert!(scene.is_some() && said == [message], "{keys}: {said:?}");
    }
}
