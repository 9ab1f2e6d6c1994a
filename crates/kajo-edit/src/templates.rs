//! Blocks to start from.

use kajo::language::{block_of, kind_of};
use kajo_core::schema::{Absent, FieldKind, Kind};

/// A block of this kind in one line, around the place `at` and about as large as `size`; `None` for words that make no
/// object, light, material or camera.
///
/// ```
/// let block = kajo_edit::template("Sphere", [0.0, 1.0, 0.0], 0.5).unwrap();
/// assert_eq!(block, "Sphere { center 0 1 0  radius 0.5 }");
/// ```
pub fn template(keyword: &str, at: [f64; 3], size: f64) -> Option<String> {
    let spot = Spot { at, size };
    solid(keyword, &spot)
        .or_else(|| by_equation(keyword, &spot))
        .or_else(|| swept(keyword, &spot))
        .or_else(|| flat(keyword, &spot))
        .or_else(|| light_or_camera(keyword, &spot))
        .or_else(|| group(keyword, &spot))
        .or_else(|| by_fields(keyword, &spot))
}

/// Where a block is to be, and how large about.
struct Spot {
    at: [f64; 3],
    size: f64,
}

impl Spot {
    /// A point, from the middle in parts of the size.
    fn point(&self, dx: f64, dy: f64, dz: f64) -> String {
        let [x, y, z] = self.at;
        words(&[x + dx * self.size, y + dy * self.size, z + dz * self.size])
    }

    fn vector(&self, dx: f64, dy: f64, dz: f64) -> String {
        words(&[dx * self.size, dy * self.size, dz * self.size])
    }

    fn length(&self, share: f64) -> String {
        words(&[share * self.size])
    }

    fn center(&self) -> String {
        self.point(0.0, 0.0, 0.0)
    }
}

fn words(numbers: &[f64]) -> String {
    let text = |&n: &f64| kajo_core::schema::number_text(rounded(n));
    numbers.iter().map(text).collect::<Vec<_>>().join(" ")
}

/// Balls, boxes and the like.
fn solid(keyword: &str, spot: &Spot) -> Option<String> {
    let (center, radius) = (spot.center(), spot.length(1.0));
    Some(match keyword {
        "Sphere" => format!("Sphere {{ center {center}  radius {radius} }}"),
        "Box" => format!("Box {{ min {}  max {} }}", spot.point(-1.0, -1.0, -1.0), spot.point(1.0, 1.0, 1.0)),
        "Plane" => format!("Plane {{ normal 0 1 0  offset {} }}", words(&spot.at[1..2])),
        "Cylinder" | "Cone" => {
            let (base, top) = (spot.point(0.0, -1.0, 0.0), spot.point(0.0, 1.0, 0.0));
            format!("{keyword} {{ base {base}  top {top}  radius {radius} }}")
        }
        "Disk" => format!("Disk {{ center {center}  normal 0 1 0  radius {radius} }}"),
        "Blob" => {
            let [a, b] = [spot.point(-0.5, 0.0, 0.0), spot.point(0.5, 0.0, 0.0)];
            let radius = spot.length(0.7);
            let ball = |center: String| format!("sphere {{ center {center}  radius {radius} }}");
            format!("Blob {{ {}  {} }}", ball(a), ball(b))
        }
        _ => return None,
    })
}

/// Surfaces of functions.
fn by_equation(keyword: &str, spot: &Spot) -> Option<String> {
    let &Spot { at, size } = spot;
    let [x, y, z] = at;
    let center = spot.center();
    let (min, max) = (spot.point(-1.0, -1.0, -1.0), spot.point(1.0, 1.0, 1.0));
    Some(match keyword {
        "Isosurface" => {
            let from = |variable: &str, at: f64| format!("({variable} - {})", words(&[at]));
            let [x, y, z] = [from("x", x), from("y", y), from("z", z)];
            let radius = words(&[0.9 * size]);
            format!("Isosurface {{ function = {x}^2 + {y}^2 + {z}^2 - {radius}^2  min {min}  max {max} }}")
        }
        "Quadric" | "Cubic" | "Quartic" => {
            let degree = match keyword {
                "Quadric" => 2,
                "Cubic" => 3,
                _ => 4,
            };
            let ball = words(&ball(degree, at, 0.9 * size));
            format!("{keyword} {{ coefficients {ball}  min {min}  max {max} }}")
        }
        "Polynomial" => {
            // A ball: the squares of the distances to its middle, less that of the radius.
            let radius = 0.9 * size;
            let square = |axis: &str, c: f64| {
                format!("{}  {}", term(&words(&[1.0]), axis, 2), term(&words(&[-2.0 * c]), axis, 1))
            };
            let rest = words(&[x * x + y * y + z * z - radius * radius]);
            let terms = [square("x", x), square("y", y), square("z", z), format!("{rest} 0 0 0")].join("  ");
            format!("Polynomial {{ terms {terms}  min {min}  max {max} }}")
        }
        "DistanceGrid" => {
            format!("DistanceGrid {{ size 2 2 2  values -1 1 1 1 1 1 1 1  min {min}  max {max} }}")
        }
        "HeightField" => {
            let length = spot.length(2.0);
            let high = spot.length(0.5);
            let wave = "function = cos(3 * x) * cos(3 * z)";
            format!("HeightField {{ {wave}  center {center}  size {length} {length}  heights 0 {high} }}")
        }
        _ => return None,
    })
}

/// Outlines and curves that are swept.
fn swept(keyword: &str, spot: &Spot) -> Option<String> {
    let (center, radius) = (spot.center(), spot.length(1.0));
    Some(match keyword {
        "Prism" => {
            let length = spot.length(1.0);
            let outline = "outline { line -1 -1  1 -1  1 0  spline 0.7 0.7  0 1  -0.7 0.7  -1 0 }";
            format!("Prism {{ origin {center}  size {length}  depth {length}  {outline} }}")
        }
        "Lathe" => {
            let profile =
                "profile { line 0 -1  0.6 -1  cubic 0.8 -0.6  0.1 0  0.4 0.5  spline 0.5 0.8  0 1 }";
            format!("Lathe {{ origin {center}  size {radius}  {profile} }}")
        }
        "SphereSweep" => {
            let ball = |dx: f64, dy: f64, radius: f64| {
                format!("{} {}", spot.point(dx, dy, 0.0), spot.length(radius))
            };
            let [a, b, c] = [ball(-0.6, -0.4, 0.4), ball(0.1, 0.2, 0.3), ball(0.7, -0.3, 0.2)];
            format!("SphereSweep {{ path {{ spline {a}  {b}  {c} }} }}")
        }
        "Curves" => {
            let points = [
                spot.point(-1.0, 0.0, 0.0),
                spot.point(-0.4, 1.0, 0.0),
                spot.point(0.4, -1.0, 0.0),
                spot.point(1.0, 0.0, 0.0),
            ];
            let width = spot.length(0.15);
            format!("Curves {{ radius {width}  strand {{ points {} }} }}", points.join("  "))
        }
        _ => return None,
    })
}

/// Surfaces without an inside.
fn flat(keyword: &str, spot: &Spot) -> Option<String> {
    Some(match keyword {
        "Quad" => {
            let (corner, a, b) =
                (spot.point(-1.0, 0.0, 1.0), spot.vector(2.0, 0.0, 0.0), spot.vector(0.0, 0.0, -2.0));
            format!("Quad {{ corner {corner}  edge1 {a}  edge2 {b} }}")
        }
        "BilinearPatch" => {
            let [a, b] = [spot.point(-1.0, -0.3, 1.0), spot.point(1.0, 0.3, 1.0)];
            let [c, d] = [spot.point(1.0, -0.3, -1.0), spot.point(-1.0, 0.3, -1.0)];
            format!("BilinearPatch {{ vertex0 {a}  vertex1 {b}  vertex2 {c}  vertex3 {d} }}")
        }
        "BicubicPatch" => {
            // A cushion over a square.
            let row = |j: u32| {
                let point = |i: u32| {
                    let inner = [i, j].iter().filter(|&&k| k == 1 || k == 2).count();
                    let [x, z] = [i, j].map(|k| f64::from(k) / 1.5 - 1.0);
                    spot.point(x, [0.0, 0.3, 0.6][inner], -z)
                };
                format!("row{j} {}", [0, 1, 2, 3].map(point).join("  "))
            };
            format!("BicubicPatch {{ {} }}", [0, 1, 2, 3].map(row).join("  "))
        }
        "Triangle" => {
            let [a, b, c] =
                [spot.point(-1.0, 0.0, 0.0), spot.point(1.0, 0.0, 0.0), spot.point(0.0, 1.5, 0.0)];
            format!("Triangle {{ vertex0 {a}  vertex1 {b}  vertex2 {c} }}")
        }
        _ => return None,
    })
}

fn light_or_camera(keyword: &str, spot: &Spot) -> Option<String> {
    let center = spot.center();
    Some(match keyword {
        "DirectionalLight" => "DirectionalLight { direction -1 -2 -1  color 0.8 0.8 0.8 }".to_owned(),
        "PointLight" => format!("PointLight {{ position {center}  color 0.8 0.8 0.8 }}"),
        "SpotLight" => {
            format!("SpotLight {{ position {center}  direction 0 -1 0  angle 40  color 0.8 0.8 0.8 }}")
        }
        "PerspectiveCamera" => {
            let eye = spot.point(0.0, 0.0, 6.0);
            format!("PerspectiveCamera {{ center {eye}  direction 0 0 -1  up 0 1 0  angle 30 }}")
        }
        _ => return None,
    })
}

/// What holds objects or materials.
fn group(keyword: &str, spot: &Spot) -> Option<String> {
    let radius = spot.length(1.0);
    Some(match keyword {
        "Group" | "Union" => format!("{keyword} {{ }}"),
        "Intersection" | "Difference" | "Merge" => {
            let (min, max, corner) =
                (spot.point(-1.0, -1.0, -1.0), spot.point(1.0, 1.0, 1.0), spot.point(1.0, 1.0, 1.0));
            format!(
                "{keyword} {{ Box {{ min {min}  max {max} }}  Sphere {{ center {corner}  radius {radius} }} }}"
            )
        }
        "Transform" => "Transform { Translate 0 0 0  Group { } }".to_owned(),
        "Lorentz" => "Lorentz { velocity 0.9 0 0  Translate 0 0 0  Group { } }".to_owned(),
        "Checkerboard" | "Marble" | "Mix" | "Noise" | "Wood" => {
            format!("{keyword} {{ materialIndex 0  materialIndex 0 }}")
        }
        _ => return None,
    })
}

/// A block by what its fields say: any material, and any shape and light that has no better one.
fn by_fields(keyword: &str, spot: &Spot) -> Option<String> {
    let center = spot.center();
    Some(match keyword {
        _ if kind_of(keyword, None) == Kind::Material => {
            if block_of(keyword)?.fields().any(|field| matches!(field.absent, Absent::Required)) {
                // What needs a file has nothing to start from.
                return None;
            }
            let color = block_of(keyword)?.fields().find(|field| field.key.to_lowercase().ends_with("color"));
            match color {
                Some(field) => format!("{keyword} {{ {} 0.8 0.8 0.8 }}", field.key),
                None => format!("{keyword} {{ }}"),
            }
        }
        _ if matches!(kind_of(keyword, None), Kind::Shape | Kind::Light) => {
            // Where it is, and what it cannot do without: the first length is the size, others are parts of it.
            let (mut text, mut length) = (String::new(), 1.0);
            for field in block_of(keyword)?.fields() {
                let is_required = matches!(field.absent, Absent::Required);
                let value = match field.kind {
                    FieldKind::Point if is_required || field.key == "center" => center.clone(),
                    _ if field.key == "color" && kind_of(keyword, None) == Kind::Light => {
                        "0.8 0.8 0.8".to_owned()
                    }
                    _ if !is_required => continue,
                    FieldKind::Vector => "0 1 0".to_owned(),
                    FieldKind::Number { .. } => {
                        let value = spot.length(length);
                        length *= 0.3;
                        value
                    }
                    _ => return None,
                };
                text += &format!(" {} {value} ", field.key);
            }
            // What needs a file, say, has nothing to start from.
            (!text.is_empty()).then(|| format!("{keyword} {{{text}}}"))?
        }
        _ => return None,
    })
}

/// A term of a polynomial in one variable, as four numbers.
fn term(coefficient: &str, axis: &str, power: u32) -> String {
    let powers = ["x", "y", "z"].map(|other| if other == axis { power } else { 0 }.to_string());
    format!("{coefficient} {}", powers.join(" "))
}

/// The coefficients of a ball as a polynomial of a degree, by falling powers of x, then of y, then of z.
fn ball(degree: u32, [x, y, z]: [f64; 3], radius: f64) -> Vec<f64> {
    let mut coefficients = Vec::new();
    for i in (0..=degree).rev() {
        for j in (0..=degree - i).rev() {
            coefficients.extend((0..=degree - i - j).rev().map(|k| match (i, j, k) {
                (2, 0, 0) | (0, 2, 0) | (0, 0, 2) => 1.0,
                (1, 0, 0) => -2.0 * x,
                (0, 1, 0) => -2.0 * y,
                (0, 0, 1) => -2.0 * z,
                (0, 0, 0) => x * x + y * y + z * z - radius * radius,
                _ => 0.0,
            }));
        }
    }
    coefficients
}

/// To three digits behind the point, which is enough to start from.
fn rounded(x: f64) -> f64 {
    (x * 1000.0).round() / 1000.0
}
