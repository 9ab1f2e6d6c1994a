//! Closed rooms, in which light goes on for ever.
//!
//! *An emissive room.* All walls send out `Le` and scatter the share `rho` evenly. The same light comes from
//! everywhere, so after `k` scatterings
//!
//! ```text
//! L = Le (1 + rho + ... + rho^k),    without end    L = Le / (1 - rho)
//! ```
//!
//! whatever the shape of the room.
//!
//! *A point emitter in a ball.* A wall of a sphere sends the same light to all of the sphere, since between two of its
//! points `cos cos' / d^2 = 1 / 4 R^2`. So all but the emitter's own light is even: with intensity `I` the radiance
//! where the light is at distance `d` under the angle `theta` is
//!
//! ```text
//! L = rho/pi I (cos theta / d^2 + rho / ((1 - rho) R^2))
//! ```

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::quadrature::simpson;
use super::{Form, Parameters, STARTS, spot_meter, text};
use crate::method::{
    BIDIRECTIONAL, BOUNCES, CACHES, DIRECT, FEW_PHOTONS, FEW_PHOTONS_IN_MAPS, GLOBAL, LIGHT, MLT, MMLT,
    Method, PATH, PATH_LIGHTS, PATH_SPECTRAL, PHOTONS, PHOTONS_SPECTRAL, SIZE_BY_WAVELENGTH,
};

/// Bounces of which nobody sees the end: `0.85^200` is `8e-15`.
const WITHOUT_END: u32 = 200;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms: Vec<Form> =
        ROOMS.iter().flat_map(|room| [emissive(draw, room, None), emissive(draw, room, Some(1))]).collect();
    forms.push(emissive(draw, &ROOMS[0], Some(0)));
    for room in [&ROOMS[2], &ROOMS[6]] {
        let wide = emissive(draw, room, Some(1));
        forms.push(Form {
            name: wide.name.replace(room.name, &format!("{}, seen widely", room.name)),
            scene: wide.scene.replace("angle 0.001", "angle 70"),
            methods: SEEN_WIDELY,
            ..wide
        });
    }
    forms.push(light_in_ball(draw, GLOBAL_OF_POINTS, true));
    forms.push(light_in_ball(draw, &[DIRECT], false));
    // All pixels share the photons of a sample, and the samples that chains begin at.
    for bounces in [None, Some(1)] {
        let room = emissive(draw, &ROOMS[0], bounces);
        let by_photons = Form {
            name: format!("{}, by photons", room.name),
            scene: room.scene.replace("angle 0.001", "angle 70"),
            methods: PHOTONS,
            ..room.rounding(BLUR).size([64, 64])
        };
        forms.push(by_photons.clone());
        forms.push(Form { methods: PHOTONS_SPECTRAL, size: SIZE_BY_WAVELENGTH, ..by_photons });
    }
    // All pixels share the noise of the records.
    let cached = |form: Form| Form {
        name: format!("{}, by a cache", form.name),
        methods: CACHES,
        ..form.rounding(RECORDS).least_noise(OF_RECORDS).size([16, 16])
    };
    let room = emissive(draw, &ROOMS[0], None);
    forms.push(cached(Form { scene: room.scene.replace("angle 0.001", "angle 70"), ..room }));
    forms.push(cached(light_in_ball(draw, CACHES, true)));
    let room = emissive(draw, &ROOMS[2], None);
    let by_chains = |form: Form, methods| Form {
        name: format!("{}, by chains", form.name),
        methods,
        ..form.size([32, 32])
    };
    forms.push(by_chains(room, CHAINS));
    forms.push(by_chains(light_in_ball(draw, CHAINS, true), CHAINS));
    forms.push(by_chains(emissive(draw, &ROOMS[2], Some(2)), CHAINS_OF_LENGTHS).least_noise(STARTS));
    forms.extend([
        light_in_ball_seen_widely(draw, FEW_PHOTONS, None).rounding(BLUR),
        light_in_ball_seen_widely(draw, FEW_PHOTONS_IN_MAPS, None)
            .rounding(BLUR)
            .least_noise(OF_ONE_MAP)
            .size([16, 16]),
        light_in_ball_seen_widely(draw, CHAINS_OF_LENGTHS, Some(3)).least_noise(STARTS),
    ]);
    forms
}

/// Chains over paths.
const CHAINS: &[Method] = &[MLT];

/// Chains for each length, which are to be few.
const CHAINS_OF_LENGTHS: &[Method] = &[MMLT];

/// The noise of a map, of which a batch has one, however many samples it takes.
const OF_ONE_MAP: f64 = 2.5e-3;

/// What interpolation between a few records may change, as a share of the light.
const RECORDS: f64 = 5e-3;

/// The least standard error of a mean of pictures by records of 1024 rays, as a share of it: each picture has few of them, and more samples
/// add none.
const OF_RECORDS: f64 = 1.5e-3;

/// What the roundness of a wall within the disks of photons may change, as a share of its light.
const BLUR: f64 = 2e-3;

/// What solves a scene whose lights have no size.
const GLOBAL_OF_POINTS: &[Method] = &[PATH, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL];

/// What solves a scene of which the camera sees so much that light from emitters comes across it.
const SEEN_WIDELY: &[Method] = &[PATH, BIDIRECTIONAL, LIGHT];

/// A closed surface around the origin.
struct Room {
    name: &'static str,
    scene: &'static str,
    /// Vertices and faces, for rooms that are meshes.
    mesh: &'static str,
}

const ROOMS: [Room; 7] = [
    Room { name: "sphere", scene: "Sphere { center 0.1 0 -0.2  radius 1 }", mesh: "" },
    Room {
        name: "ellipsoid",
        scene: "Transform { Scale 1 2 1.5  ZRotate 40  Sphere { center 0 0 0  radius 0.8 } }",
        mesh: "",
    },
    Room { name: "box", scene: "Box { min -1 -1.2 -0.7  max 1.1 1 0.9 }", mesh: "" },
    Room { name: "cylinder", scene: "Cylinder { base 0 -1 0.1  top 0.2 1 0  radius 1 }", mesh: "" },
    Room { name: "octahedron, a mesh", scene: "TriangleMesh { file room.obj }", mesh: OCTAHEDRON },
    Room {
        name: "displaced octahedron",
        scene: "TriangleMesh { file room.obj  smooth off  subdivide 3  displacement 0.2 }",
        mesh: OCTAHEDRON,
    },
    Room {
        name: "blob",
        scene: "Blob { sphere { center -0.5 0 0  radius 1.2 }  sphere { center 0.6 0.2 -0.1  radius 1 } }",
        mesh: "",
    },
];

const OCTAHEDRON: &str = "v 2 0 0\nv -2 0 0\nv 0 1.5 0\nv 0 -1.5 0\nv 0 0 1.8\nv 0 0 -1.8\n\
    f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

fn emissive(draw: &mut Parameters, room: &Room, bounces: Option<u32>) -> Form {
    let (rho, le) = (draw.between(0.2, 0.85), draw.between(0.5, 4.0));
    let spin = draw.between(0.0, 360.0);
    let (from, to) = (draw.point(0.2), draw.direction(-1.0));
    let scene = format!(
        "{}Materials {{ Material m {{ diffuseColor {rho} {rho} {rho}  emission {le} {le} {le} }} }}\n\
         Group {{ MaterialIndex m  Transform {{ Rotate 0 0.6 0.8 {spin}  {} }} }}",
        spot_meter(from, from + to),
        room.scene
    );
    let scatterings = bounces.map(|n| n as i32 + 1);
    let expected = le * scatterings.map_or(1.0, |k| 1.0 - rho.powi(k + 1)) / (1.0 - rho);
    let ended = match bounces {
        None => "no end of bounces".to_owned(),
        Some(n) => format!("light scattered {} times", n + 1),
    };
    let name = format!("S1 emissive {}, albedo {rho}, {ended}", room.name);
    let methods = if bounces.is_none() { GLOBAL } else { BOUNCES };
    let form = Form::new(name, scene, expected, methods).bounces(bounces.unwrap_or(WITHOUT_END));
    if room.mesh.is_empty() { form } else { form.file("room.obj", room.mesh.to_owned()) }
}

/// A ball around the origin with a point light in it.
struct LitBall {
    rho: f64,
    intensity: f64,
    radius: f64,
    light: DVec3,
}

impl LitBall {
    fn draw(draw: &mut Parameters) -> LitBall {
        let (rho, intensity, radius) =
            (draw.between(0.2, 0.85), draw.between(0.5, 4.0), draw.between(0.8, 2.0));
        LitBall { rho, intensity, radius, light: radius * draw.between(0.1, 0.7) * draw.direction(-1.0) }
    }

    /// Radiance of the wall at `p`, from light that was scattered `n` times; `None` for all of it.
    fn radiance(&self, p: DVec3, n: Option<u32>) -> f64 {
        let to_light = self.light - p;
        let direct = to_light.normalize().dot(-p / self.radius) / to_light.length_squared();
        let rest = n.map_or(1.0, |n| 1.0 - self.rho.powi(n as i32 - 1));
        let indirect = self.rho * rest / (1.0 - self.rho) / (self.radius * self.radius);
        self.rho / PI * self.intensity * (direct + indirect)
    }

    fn scene(&self, view: &str) -> String {
        let LitBall { rho, intensity, radius, light } = self;
        format!(
            "{view}Lights {{ PointLight {{ position {}  intensity {intensity} {intensity} {intensity} }} }}\n\
             Materials {{ Material m {{ diffuseColor {rho} {rho} {rho} }} }}\n\
             Group {{ MaterialIndex m  Sphere {{ center 0 0 0  radius {radius} }} }}",
            text(*light)
        )
    }
}

fn light_in_ball(draw: &mut Parameters, methods: &'static [Method], all_bounces: bool) -> Form {
    let ball = LitBall::draw(draw);
    let seen = ball.radius * draw.direction(-1.0);
    let name = match all_bounces {
        true => format!("S2 point light in a ball, albedo {}", ball.rho),
        false => format!("S2 point emitter in a ball, albedo {}, its own light only", ball.rho),
    };
    let expected = ball.radiance(seen, if all_bounces { None } else { Some(1) });
    Form::new(name, ball.scene(&spot_meter(DVec3::ZERO, seen)), expected, methods).bounces(WITHOUT_END)
}

/// The same in a picture, whose mean is the integral over it; from the middle all of the wall is as far away.
///
/// * `scatterings`: `None` for all
fn light_in_ball_seen_widely(
    draw: &mut Parameters,
    methods: &'static [Method],
    scatterings: Option<u32>,
) -> Form {
    const ANGLE: f64 = 40.0;
    let (ball, to) = (LitBall::draw(draw), draw.direction(-1.0));
    let up = to.any_orthonormal_vector();
    let (right, half) = (to.cross(up), (0.5 * ANGLE).to_radians().tan());
    let at = |u: f64, v: f64| {
        ball.radiance(ball.radius * (to + half * (u * right + v * up)).normalize(), scatterings)
    };
    let expected = 0.25 * simpson(-1.0, 1.0, 50, |u| simpson(-1.0, 1.0, 50, |v| at(u, v)));
    let view = format!(
        "PerspectiveCamera {{ center 0 0 0  direction {}  up {}  angle {ANGLE} }}\nBackground {{ color 0 0 0 }}\n",
        text(to),
        text(up)
    );
    let ended = scatterings.map_or(String::new(), |n| format!(", light scattered at most {n} times"));
    let name = format!("S2 point light in a ball, albedo {}{ended}, seen widely", ball.rho);
    Form::new(name, ball.scene(&view), expected, methods)
        .bounces(scatterings.map_or(WITHOUT_END, |n| n - 1))
        .size([32, 32])
}
