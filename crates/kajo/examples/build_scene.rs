//! A scene without a text: balls on a spiral, and the one that lights them.
//!
//! ```text
//! cargo run --release -p kajo --example build_scene
//! ```

use std::error::Error;
use std::f32::consts::TAU;
use std::path::Path;

use kajo::build::camera::{CameraFrame, PerspectiveCamera};
use kajo::build::material::{LayeredMaterial, Layers, Matte};
use kajo::build::shape::{Plane, Sphere};
use kajo::build::{Background, Emission, PoseId, Reflectance, SceneBuilder, SceneError, SurfaceEmission};
use kajo::kajo_math::{DAffine3, DVec3, Vec3};
use kajo::output::Target;
use kajo::{BitDepth, Defaults, Format, RenderRequest, RenderSettings, Scene, Settings, Silent, View};

/// Balls on the spiral.
const BALLS: u8 = 40;

fn spiral() -> Result<Scene, SceneError> {
    let mut scene = SceneBuilder::default();
    scene.background(Background::constant([0.05, 0.06, 0.1]))?;

    let paper = scene.material(Matte::new(Reflectance::constant(0.6), 1.0))?;
    let floor = scene.shape(Plane::new(DVec3::Y, 0.0))?;
    scene.object(floor, paper, PoseId::IDENTITY)?;

    // One shape stands in many places.
    let ball = scene.shape(Sphere::new(Vec3::new(0.0, 1.0, 0.0), 1.0))?;
    for i in 0..BALLS {
        let t = f32::from(i) / f32::from(BALLS);
        let hue = [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|phase| 0.5 + 0.4 * (TAU * (t + phase)).cos());
        let layers =
            Layers { color: Reflectance::from_rgb(hue).into(), coat: 1.0.into(), ..Layers::default() };
        let lacquer = scene.material(LayeredMaterial::from(layers))?;
        let (angle, size) = (f64::from(6.0 * t), f64::from(0.2 + 0.5 * t));
        let place = DVec3::new(angle.cos(), 0.0, angle.sin()) * (1.5 + 3.0 * f64::from(t));
        let pose = scene
            .transform(&(DAffine3::from_translation(place) * DAffine3::from_scale(DVec3::splat(size))))?;
        scene.object(ball, lacquer, pose)?;
    }

    // An object whose material gives light is a light.
    let light = SurfaceEmission::from(Emission::blackbody(3000.0).scaled(8.0));
    let bulb = scene.emissive_material(Matte::new(Reflectance::constant(0.0), 0.0), light)?;
    let above = scene.transform(&DAffine3::from_translation(DVec3::new(0.0, 1.5, 0.0)))?;
    scene.object(ball, bulb, above)?;

    let frame = CameraFrame::new(DVec3::new(0.0, 8.0, 12.0), DVec3::new(0.0, -0.6, -1.0), DVec3::Y);
    scene.camera(PerspectiveCamera::new(frame, 45f64.to_radians()))?;
    scene.finish(Settings { size: Some([400, 300]), ..Settings::default() })
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = spiral()?;
    let settings = RenderSettings::resolve(&scene, &Settings::default(), Defaults::Modern, false)?;
    let outputs = [(View::Color, Format::Png)];
    let picture = kajo::render(&RenderRequest::new(&scene, &settings, &outputs), &Silent)?;
    let bytes = picture.encode(&[View::Color], Format::Png, BitDepth::Eight)?;
    Target::check(Path::new("spiral.png"), &[])?.write(&bytes)?;
    println!("spiral.png: {} objects", scene.geometry.object_count());
    Ok(())
}
