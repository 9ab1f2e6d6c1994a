//! Numbers that the program has from tables or formulas, against published ones.

use kajo_color::emission::planck;
use kajo_color::observer::xyz_of;
use kajo_color::{Outside, Spectrum, Tabulated, illuminant, named};
use kajo_core::bsdf::{MetalFresnel, fresnel};

use super::Number;

pub fn numbers() -> Vec<Number> {
    let mut numbers = indices();
    numbers.extend(chromaticities());
    numbers.extend(black_bodies());
    numbers.extend(fresnel_terms());
    numbers.extend(metal_reflectances());
    numbers
}

fn number(name: String, expected: f64, measured: f64, tolerance: f64) -> Number {
    Number { name, expected, measured, tolerance }
}

/// Indices at Fraunhofer's lines C, d, F and g, in nm: of catalogues and, for water, of
/// [Daimon and Masumura 2007].
fn indices() -> Vec<Number> {
    const LINES: [(&str, f64); 4] = [("C", 656.2725), ("d", 587.5618), ("F", 486.1327), ("g", 435.8343)];
    const GLASSES: [(&str, [f64; 4], f64); 5] = [
        ("N-BK7", [1.514322, 1.516800, 1.522376, 1.526685], 2e-6),
        ("N-SF10", [1.720906, 1.728277, 1.746430, 1.761914], 2e-6),
        ("fused-silica", [1.456367, 1.458464, 1.463126, 1.466693], 2e-6),
        ("water", [1.331513, 1.333403, 1.337492, 1.340586], 2e-6),
        ("diamond", [2.40991, 2.41749, 2.43554, 2.44997], 2e-5),
    ];
    let of_glass = |(glass, indices, tolerance): (&'static str, [f64; 4], f64)| {
        LINES.into_iter().zip(indices).map(move |((line, nm), index)| {
            let found = named::glass(glass).map_or(f64::NAN, |glass| glass.index(nm));
            number(format!("index of {glass}, line {line}"), index, found, tolerance)
        })
    };
    GLASSES.into_iter().flat_map(of_glass).collect()
}

/// Chromaticities of CIE illuminants, 2 degree observer [CIE 015:2018].
fn chromaticities() -> Vec<Number> {
    let sampled = |f: &dyn Fn(f64) -> f64| {
        let pairs = (360..=830).map(|nm| (nm as f32, f(f64::from(nm)) as f32));
        Tabulated::new(pairs, Outside::Zero).map_or([f64::NAN; 3], |table| xyz_of(&table))
    };
    let lights = [
        ("E", sampled(&|_| 1.0), [1.0 / 3.0, 1.0 / 3.0]),
        ("A", sampled(&|nm| planck(nm, 2855.496)), [0.4476, 0.4074]),
        ("D65", sampled(&|nm| f64::from(illuminant::d65(nm as f32))), [0.3127, 0.3290]),
    ];
    let of_light = |(name, xyz, expected): (&'static str, [f64; 3], [f64; 2])| {
        let sum: f64 = xyz.iter().sum();
        ["x", "y"].into_iter().enumerate().map(move |(i, axis)| {
            number(format!("chromaticity {axis} of illuminant {name}"), expected[i], xyz[i] / sum, 1e-4)
        })
    };
    lights.into_iter().flat_map(of_light).collect()
}

/// Planck's law, W/(m² sr nm).
fn black_bodies() -> Vec<Number> {
    const VALUES: [(f64, [f64; 3]); 2] =
        [(5800.0, [26154.6, 26310.5, 23098.9]), (6500.0, [47511.7, 43063.1, 35243.5])];
    let of_body = |(kelvin, radiances): (f64, [f64; 3])| {
        [450.0, 550.0, 650.0].into_iter().zip(radiances).map(move |(nm, radiance)| {
            number(format!("black body of {kelvin} K at {nm} nm"), radiance, planck(nm, kelvin), 0.06)
        })
    };
    VALUES.into_iter().flat_map(of_body).collect()
}

/// Fresnel's equations for unpolarised light at glass of index 1.5, from air and from within, by the angle in degrees.
fn fresnel_terms() -> Vec<Number> {
    const FROM_AIR: [(f64, f64); 8] = [
        (0.0, 0.04),
        (30.0, 0.041523),
        (45.0, 0.050240),
        (60.0, 0.089187),
        (75.0, 0.253061),
        (80.0, 0.387704),
        (85.0, 0.612800),
        (89.0, 0.904185),
    ];
    const FROM_WITHIN: [(f64, f64); 4] = [(30.0, 0.055190), (40.0, 0.245291), (41.0, 0.379751), (41.9, 1.0)];
    let row = |place: &'static str, eta: f32| {
        move |(degrees, expected): (f64, f64)| {
            let found = fresnel::dielectric(degrees.to_radians().cos() as f32, eta);
            number(format!("Fresnel's term at {degrees} degrees {place}"), expected, found.into(), 3e-6)
        }
    };
    let within = FROM_WITHIN.into_iter().map(row("within glass", 1.0 / 1.5));
    FROM_AIR.into_iter().map(row("from air", 1.5)).chain(within).collect()
}

/// Mean reflectance of both polarisations of a metal of index 0.2 and extinction 3, by the angle in degrees.
fn metal_reflectances() -> Vec<Number> {
    const VALUES: [(f64, [f64; 2]); 4] = [
        (0.0, [0.923372, 0.923372]),
        (45.0, [0.946596, 0.896043]),
        (60.0, [0.962413, 0.874409]),
        (80.0, [0.986927, 0.890190]),
    ];
    let metal = MetalFresnel::Complex { eta: Spectrum::grey(0.2), k: Spectrum::grey(3.0) };
    let row = |(degrees, [s, p]): (f64, [f64; 2])| {
        let found = metal.at(degrees.to_radians().cos() as f32)[0];
        let name = format!("reflectance of a metal of index 0.2 + 3 i at {degrees} degrees");
        number(name, 0.5 * (s + p), found.into(), 2e-6)
    };
    VALUES.into_iter().map(row).collect()
}
