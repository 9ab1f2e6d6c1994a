//! Light that comes back from a medium without end [Chandrasekhar 1950].
//!
//! A half space of a medium of albedo `w` that scatters evenly, lit by parallel light of the irradiance `E` across it under an angle of
//! the cosine `mu0`, has under an angle of the cosine `mu` the radiance
//!
//! ```text
//! L = w / 4pi  H(mu) H(mu0) mu0 / (mu + mu0)  E,      1/H(mu) = sqrt(1 - w) + w/2 integral of  mu' H(mu') / (mu + mu')  dmu'
//! ```
//!
//! with the integral over `mu'` from 0 to 1. Seen at one place it is a block so large that its sides are far away. Seen as a whole picture
//! it is a column between mirrors, as good as all of it: light that leaves it on one side comes in on the other, as from a
//! column beside it. Seen straight from above, with `mu` = 1, columns whose light comes from the other side in turn
//! are all alike in the mean.

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::quadrature::gauss_legendre;
use super::{Form, Parameters, spot_meter, text};
use crate::method::{
    BIDIRECTIONAL, LIGHT, MLT, Method, PATH, PATH_LIGHTS, PATH_NO_ROULETTE, PATH_SPECTRAL, SPPM, VCM,
};

/// What joins places in the block with the light.
const FROM_CAMERA: &[Method] = &[PATH, PATH_LIGHTS, PATH_SPECTRAL, PATH_NO_ROULETTE, BIDIRECTIONAL];

/// What follows light from its source through media: the mirrors send it on from a single direction, which no path from
/// the camera finds.
const METHODS: &[Method] = &[BIDIRECTIONAL, LIGHT];

/// What does so for a whole picture.
const SHARED: &[Method] = &[SPPM, VCM, MLT];

/// Half the width of the column, in mean free paths.
const HALF: f64 = 4.0;

/// Its depth: next to no light comes from below. What returns from there at an albedo of 0.8 has lost the factor
/// `exp(-0.71)` each mean free path, twice.
const DEPTH: f64 = 9.0;

/// What balls of photons may lose that reach over a mirror, as a share of the light.
const BORDER: f64 = 5e-3;

/// Scatterings and mirrors of which next to no path has more.
const WITHOUT_END: u32 = 150;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let form = column(draw);
    let shared =
        Form { name: format!("{}, by photons and chains", form.name), methods: SHARED, ..form.clone() };
    vec![form, shared.rounding(BORDER).size([64, 64]), block(draw)]
}

/// How a half space is lit.
struct Lighting {
    albedo: f64,
    /// The cosine of the light's direction.
    mu0: f64,
    irradiance: f64,
}

impl Lighting {
    fn draw(draw: &mut Parameters) -> Lighting {
        Lighting {
            albedo: draw.between(0.3, 0.8),
            mu0: draw.between(0.3, 1.0),
            irradiance: draw.between(1.0, 9.0),
        }
    }

    /// The light and the medium.
    fn text(&self) -> String {
        let Lighting { albedo, mu0, irradiance: e } = *self;
        let from = DVec3::new(-(1.0 - mu0 * mu0).sqrt(), -mu0, 0.0);
        format!(
            "Lights {{ DirectionalLight {{ direction {}  irradiance {e} {e} {e} }} }}\n\
             Media {{ Medium m {{ albedo {albedo} density 1 }} }}\n",
            text(from)
        )
    }

    /// The radiance straight above.
    fn expected(&self) -> f64 {
        let (h, mu0) = (HFunction::new(self.albedo), self.mu0);
        self.albedo / (4.0 * PI) * h.at(1.0) * h.at(mu0) * mu0 / (1.0 + mu0) * self.irradiance
    }

    fn name(&self) -> String {
        format!("S12 half space of albedo {}, lit at the cosine {}", self.albedo, self.mu0)
    }
}

/// A block seen at one place.
fn block(draw: &mut Parameters) -> Form {
    let lighting = Lighting::draw(draw);
    let scene = format!(
        "{}{}Materials {{ Interface b {{ medium m }} }}\n\
         Group {{ MaterialIndex b Box {{ min -200 -200 -200  max 200 0 200 }} }}",
        spot_meter(DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO),
        lighting.text()
    );
    Form::new(format!("{}, at one place", lighting.name()), scene, lighting.expected(), FROM_CAMERA)
        .bounces(WITHOUT_END)
}

/// A column seen as a whole.
fn column(draw: &mut Parameters) -> Form {
    let lighting = Lighting::draw(draw);
    let (low, side) = (-HALF - 0.5, 2.0 * HALF);
    let wall = |corner: [f64; 2], along: [f64; 2]| {
        let ([x, z], [u, v]) = (corner, along);
        format!("Quad {{ corner {x} -{DEPTH} {z}  edge1 {u} 0 {v}  edge2 0 {DEPTH} 0 }}")
    };
    let walls = [
        wall([-HALF, -HALF], [side, 0.0]),
        wall([-HALF, HALF], [side, 0.0]),
        wall([-HALF, -HALF], [0.0, side]),
        wall([HALF, -HALF], [0.0, side]),
    ];
    let scene = format!(
        "OrthographicCamera {{ center 0 5 0  direction 0 -1 0  up 0 0 1  size {side} }}\nBackground {{ color 0 0 0 }}\n\
         {}Materials {{ Interface b {{ medium m }}  Metal mirror {{ color 1 1 1 }} }}\n\
         Group {{ MaterialIndex b Box {{ min {low} -{DEPTH} {low}  max {} 0 {} }}\n\
         MaterialIndex mirror {} }}",
        lighting.text(),
        -low,
        -low,
        walls.join("\n")
    );
    Form::new(lighting.name(), scene, lighting.expected(), METHODS).bounces(WITHOUT_END).size([8, 8])
}

/// Chandrasekhar's function at the nodes of a rule for integrals.
struct HFunction {
    albedo: f64,
    /// Places, weights and values.
    nodes: Vec<[f64; 3]>,
}

impl HFunction {
    fn new(albedo: f64) -> HFunction {
        let rule = gauss_legendre(64).into_iter();
        let nodes = rule.map(|[x, weight]| [0.5 * (1.0 + x), 0.5 * weight, 1.0]).collect();
        let mut h = HFunction { albedo, nodes };
        for _ in 0..200 {
            let values: Vec<f64> = h.nodes.iter().map(|&[mu, ..]| h.at(mu)).collect();
            // Half way, since whole steps go to and fro.
            h.nodes.iter_mut().zip(values).for_each(|([.., old], new)| *old = 0.5 * (*old + new));
        }
        h
    }

    fn at(&self, mu: f64) -> f64 {
        let integral: f64 = self.nodes.iter().map(|[x, weight, h]| weight * x * h / (mu + x)).sum();
        1.0 / ((1.0 - self.albedo).sqrt() + 0.5 * self.albedo * integral)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_function_gives_the_published_radiances_and_albedos() {
        for (albedo, straight, plane) in
            [(0.5, 0.097_853, 0.160_144), (0.8, 0.255_431, 0.367_970), (0.9, 0.385_072, 0.507_939)]
        {
            let h = HFunction::new(albedo);
            assert!((albedo / 8.0 * h.at(1.0).powi(2) - straight).abs() < 1e-6, "{albedo}");
            // All light that comes back of what arrives at the cosine 1/2 is 1 - H sqrt(1 - w).
            assert!((1.0 - h.at(0.5) * (1.0 - albedo).sqrt() - plane).abs() < 1e-6, "{albedo}");
        }
    }
}
