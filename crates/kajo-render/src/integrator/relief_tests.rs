//! A matt floor whose normals lean has the radiance of its irradiance from wherever it is seen.
//!
//! Normals lean by 30 degrees to +x. Parallel light from straight above of the irradiance `E` across it gives the radiance
//!
//! ```text
//! L = R/π E cos 30
//! ```
//!
//! and a sky of radiance 1, of which the true surface hides what is below it, `L = R (1 + cos 30)/2`.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::Vec2;
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{Bidirectional, BidirectionalSettings, Path, PathSettings};
use crate::{LayerSet, PixelIntegrator, SampleContext};

const REFLECTANCE: f64 = 0.5;

/// A normal map that leans everywhere by 30 degrees to +u.
fn leaning() -> Vec<u8> {
    let mut file = b"PF\n1 1\n-1.0\n".to_vec();
    let (s, c) = 30f32.to_radians().sin_cos();
    file.extend([s, 0.0, c].map(|v| 0.5 + 0.5 * v).into_iter().flat_map(f32::to_le_bytes));
    file
}

/// The mean radiance of the middle of the picture by an integrator.
fn mean(integrator: &dyn PixelIntegrator) -> f64 {
    let samples = 1 << 14;
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    let mut ctx = SampleContext::new(&sampler, 3);
    let radiance = |k: u32| {
        ctx.begin([0, 0], k);
        f64::from(integrator.sample(&mut ctx, [0, 0], Vec2::splat(0.5)).radiance[0])
    };
    (0..samples).map(radiance).sum::<f64>() / f64::from(samples)
}

#[test]
fn matt_reliefs_are_as_bright_from_everywhere() {
    let cos = 30f64.to_radians().cos();
    let assets = MemoryAssets::new().with("leaning.pfm", leaning());
    let lights = [
        (
            "Background { color 0 0 0 } Lights { DirectionalLight { direction 0 -1 0 irradiance 3.14159265 3.14159265 3.14159265 } }",
            cos,
        ),
        ("Background { color 1 1 1 }", 0.5 * (1.0 + cos)),
    ];
    let materials = ["Matte m { color 0.5 0.5 0.5", "PhongMaterial m { diffuseColor 0.5 0.5 0.5"];
    for degrees in [60.0f64, 45.0, 20.0, 5.0, 120.0, 160.0, 175.0] {
        let (y, x) = degrees.to_radians().sin_cos();
        for (light, irradiance) in lights {
            for material in materials {
                let scene = scene_with(
                    &format!(
                        "OrthographicCamera {{ center {cx} {cy} 0  direction {x} -{y} 0  up 0 1 0  size 0.01 }}
                         {light} Materials {{ {material}  normalMap leaning.pfm }} }}
                         Group {{ MaterialIndex m Quad {{ corner -5 0 5  edge1 10 0 0  edge2 0 0 -10 }} }}",
                        cx = -3.0 * x,
                        cy = 3.0 * y
                    ),
                    &assets,
                );
                let (size, layers) = ([1, 1], LayerSet::of(&[]));
                let path = Path::new(&scene, PathSettings::default(), size, layers);
                let both_ends = Bidirectional::new(&scene, BidirectionalSettings::default(), size, layers);
                for found in [mean(&path), mean(&both_ends)] {
                    let expected = REFLECTANCE * irradiance;
                    let off = (found / expected - 1.0).abs();
                    assert!(off < 2e-3, "{material} from {degrees}: {found} for {expected} by {light}");
                }
            }
        }
    }
}
