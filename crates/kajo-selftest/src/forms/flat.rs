//! Flat things in a coordinate plane through the origin or across all axes, at any scale, each in every part: where
//! rounding lets a ray meet the surface that it leaves, or a light hide itself, nothing of this comes out.
//!
//! Under an even sky of radiance `L`, with nothing else in the scene, a matt surface of albedo `rho` has the radiance
//! `rho L`; a white mirror, a clear pane and a cut-out have `L`, and matt of opacity `o` has `o rho L + (1 - o) L`. As
//! a light over a floor that is parallel to it, a polygon gives what Lambert's formula says, and a disk of
//! radius `r` at the distance `h` before its middle
//!
//! ```text
//! E = pi r^2 / (r^2 + h^2).
//! ```

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::lights::SKIES;
use super::polygon::irradiance;
use super::{Form, Parameters, floor_and_light, spot_meter, text};
use crate::method::{
    BIDIRECTIONAL, GLASS, LIGHTS, MIRRORS, Method, PATH, PATH_SCATTERING, PATH_SPECTRAL, SMALL_LIGHTS,
};

/// What follows paths through holes, bidirectional light included.
const HOLES: &[Method] = &[PATH, PATH_SCATTERING, PATH_SPECTRAL, BIDIRECTIONAL];

const SHAPES: [&str; 7] = ["plane", "disk", "quad", "triangle", "box", "mesh", "mesh in a transform"];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = Vec::new();
    for shape in SHAPES {
        forms.extend([receiver(draw, shape), mirror(draw, shape), pane(draw, shape), holes(draw, shape)]);
        if shape != "plane" {
            forms.push(light(draw, shape));
        }
    }
    let shared: Vec<Form> = forms
        .iter()
        .filter(|form| {
            form.name.contains("flat quad as a mirror") || form.name.contains("flat quad as a pane")
        })
        .flat_map(|form| [form.shared(), form.chained(), form.chained_by_length(1)])
        .collect();
    forms.extend(shared);
    forms
}

/// A plane through the origin: its axes, of which the second is its normal, and the size of what lies in it.
struct PlaneFrame {
    axes: [DVec3; 3],
    scale: f64,
    name: String,
}

impl PlaneFrame {
    fn draw(draw: &mut Parameters) -> PlaneFrame {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let frames = [
            ("x = 0", [y, x, -z]),
            ("y = 0", [x, y, -z]),
            ("z = 0", [x, z, y]),
            ("a tilted plane", {
                let n = draw.direction(-1.0);
                let u = n.any_orthonormal_vector();
                [u, n, u.cross(n)]
            }),
        ];
        let (name, [u, n, v]) = frames[draw.index(4)];
        let sign = if draw.index(2) == 0 { 1.0 } else { -1.0 };
        let exponent = draw.index(11) as i32 - 5;
        let name = format!("{name} at scale 1e{exponent}");
        PlaneFrame { axes: [u, sign * n, sign * v], scale: 10f64.powi(exponent), name }
    }

    /// World space from coordinates in the plane, of the order of 1, and above it.
    fn at(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        let [u, n, v] = self.axes;
        self.scale * (x * u + y * n + z * v)
    }

    /// A thing of unit size in the plane y = 0, in its place.
    fn transform(&self, thing: &str) -> String {
        let [u, n, v] = self.axes.map(|axis| text(self.scale * axis));
        format!("Transform {{ Matrix {{ {u} 0  {n} 0  {v} 0  0 0 0 1 }} {thing} }}")
    }

    /// The scene's text of a shape, and its file.
    fn shape(&self, shape: &str) -> (String, Option<String>) {
        let n = text(self.axes[1]);
        let corners = outline(shape).map(|corner| self.at(corner));
        match shape {
            "plane" => (format!("Plane {{ normal {n}  offset 0 }}"), None),
            "disk" => (format!("Disk {{ center 0 0 0  normal {n}  radius {} }}", self.scale as f32), None),
            "quad" => {
                let [a, b, _, d] = corners;
                let [edge1, edge2] = [b - a, d - a].map(text);
                (format!("Quad {{ corner {}  edge1 {edge1}  edge2 {edge2} }}", text(a)), None)
            }
            "triangle" => (super::triangle([corners[0], corners[1], corners[2]]), None),
            "box" => (self.transform("Box { min -1 -1 -1  max 1 0 1 }"), None),
            "mesh" => ("TriangleMesh { file flat.obj }".to_owned(), Some(obj(corners))),
            _ => {
                (self.transform("TriangleMesh { file flat.obj }"), Some(obj(outline(shape).map(DVec3::from))))
            }
        }
    }

    /// A scene that shows a shape of the material `m`, slantingly.
    fn seen(&self, draw: &mut Parameters, shape: &str, sky: f64, material: &str) -> (String, Option<String>) {
        let (thing, file) = self.shape(shape);
        let to = [draw.between(-0.2, 0.2), 0.0, draw.between(-0.2, 0.2)];
        let from = [draw.between(-1.0, 1.0), draw.between(0.3, 3.0), draw.between(-1.0, 1.0)];
        let camera = spot_meter(self.at(from), self.at(to));
        let scene = format!(
            "{}Materials {{ {material} }}\nGroup {{ MaterialIndex m {thing} }}",
            camera.replace("color 0 0 0", &format!("color {}", text(DVec3::splat(sky))))
        );
        (scene, file)
    }
}

/// Corners around the origin, counter-clockwise as seen from above; a triangle has the first three.
fn outline(shape: &str) -> [[f64; 3]; 4] {
    match shape {
        "triangle" => [[-1.5, 0.0, 1.0], [1.5, 0.0, 1.0], [0.0, 0.0, -2.0], [0.0, 0.0, -2.0]],
        _ => [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]],
    }
}

/// Two triangles.
fn obj(corners: [DVec3; 4]) -> String {
    let vertices = corners.map(|corner| format!("v {}\n", text(corner)));
    format!("{}f 1 2 3\nf 1 3 4\n", vertices.concat())
}

fn form(
    (scene, file): (String, Option<String>),
    name: String,
    expected: f64,
    methods: &'static [Method],
) -> Form {
    let form = Form::new(name, scene, expected, methods);
    match file {
        Some(content) => form.file("flat.obj", content),
        None => form,
    }
}

fn receiver(draw: &mut Parameters, shape: &str) -> Form {
    let (frame, rho, sky) = (PlaneFrame::draw(draw), draw.between(0.2, 0.9), draw.between(0.5, 2.0));
    let scene = frame.seen(draw, shape, sky, &format!("Matte m {{ color {rho} {rho} {rho} }}"));
    form(scene, format!("flat {shape} under the sky, {}", frame.name), rho * sky, SKIES).bounces(0)
}

fn mirror(draw: &mut Parameters, shape: &str) -> Form {
    let (frame, sky) = (PlaneFrame::draw(draw), draw.between(0.5, 2.0));
    let scene = frame.seen(draw, shape, sky, "Metal m { color 1 1 1 }");
    form(scene, format!("flat {shape} as a mirror, {}", frame.name), sky, MIRRORS)
}

fn pane(draw: &mut Parameters, shape: &str) -> Form {
    let (frame, sky) = (PlaneFrame::draw(draw), draw.between(0.5, 2.0));
    let scene = frame.seen(draw, shape, sky, "Glass m { thin on }");
    form(scene, format!("flat {shape} as a pane, {}", frame.name), sky, GLASS)
}

fn holes(draw: &mut Parameters, shape: &str) -> Form {
    let (frame, rho, sky) = (PlaneFrame::draw(draw), draw.between(0.2, 0.9), draw.between(0.5, 2.0));
    // Light goes to and fro in a box that is there.
    let opacity = if shape == "box" { 0.0 } else { draw.between(0.0, 0.6) };
    let material = format!("Matte m {{ color {rho} {rho} {rho}  opacity {opacity} }}");
    let scene = frame.seen(draw, shape, sky, &material);
    let expected = (opacity * rho + 1.0 - opacity) * sky;
    form(scene, format!("flat {shape} with holes, {}", frame.name), expected, HOLES)
}

fn light(draw: &mut Parameters, shape: &str) -> Form {
    let (frame, rho, le) = (PlaneFrame::draw(draw), draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    // Near or far, by the logarithm.
    let height = 10f64.powf(draw.between(-0.3, 2.0));
    let methods = if height < 4.0 { LIGHTS } else { SMALL_LIGHTS };
    let floor = frame.at([0.0, height, 0.0]);
    let (thing, file) = frame.shape(shape);
    let n = -frame.axes[1];
    let scene = format!(
        "{}{}Group {{\n  MaterialIndex floor Disk {{ center {}  normal {}  radius {} }}\n  MaterialIndex emitter {thing}\n}}",
        spot_meter(floor + frame.at([0.01, -0.02, 0.0]), floor),
        floor_and_light(rho, le),
        text(floor),
        text(n),
        0.001 * frame.scale as f32,
    );
    let received = match shape {
        "disk" => PI / (1.0 + height * height),
        "triangle" => {
            irradiance(&outline(shape)[..3].iter().map(|&c| frame.at(c) - floor).collect::<Vec<_>>(), n)
        }
        _ => irradiance(&outline(shape).map(|corner| frame.at(corner) - floor), n),
    };
    let name = format!("flat {shape} as a light, {}", frame.name);
    form((scene, file), name, rho / PI * le * received, methods).bounces(0)
}
