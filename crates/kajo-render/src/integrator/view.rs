//! The camera's part of an integrator: rays through places of the picture, and what layers record of the first
//! surface.

use kajo_core::camera::{Camera, Raster};
use kajo_core::sampler::Draws;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, Vec2};

use crate::{FirstHit, Layer, LayerSet};

/// A scene as a camera sees it in a picture of some size.
pub(super) struct View<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    layers: LayerSet,
}

impl<'a> View<'a> {
    pub fn new(scene: &'a Scene, size: [u32; 2], layers: LayerSet) -> View<'a> {
        View { scene, camera: &scene.camera, size, layers }
    }

    /// The same through another camera than the scene's.
    pub fn through(self, camera: &'a Camera) -> View<'a> {
        View { camera, ..self }
    }

    /// The camera ray through a place of the picture, in pixels from its top left corner; none where the camera
    /// shows nothing.
    ///
    /// Takes the dimensions of the lens and the time.
    pub fn ray(&self, raster: Vec2, draws: &mut Draws<'_>) -> Option<Ray> {
        let lens = draws.pair_if(self.camera.has_lens());
        draws.skip(1);
        let film = Raster::new(self.size, &self.scene.rules);
        self.camera.ray(film.picture(raster), film.aspect(), lens)
    }

    /// Whether the layers record albedos.
    pub fn wants_albedo(&self) -> bool {
        self.layers.has(Layer::Albedo)
    }

    /// What the layers record of a surface.
    pub fn first_hit(&self, at: &Interaction) -> FirstHit {
        let uv = if self.layers.has(Layer::Uv) { self.scene.uv(at) } else { Vec2::ZERO };
        let numbered = self.layers.has(Layer::MaterialId);
        let material = if numbered { self.scene.material_number(at.material) } else { 0 };
        FirstHit { t: at.hit.t, n: at.point.n, uv, object: at.primitive + 1, material }
    }
}
