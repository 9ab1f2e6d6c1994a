//! A room with every kind of light that integrators keep something of: a point, an emitter, and a ball of glass before them.

use kajo::{LoadOptions, MemoryAssets, Scene};

pub const ROOM: &str = "
    PerspectiveCamera { center 0 0 1.9  direction 0 -0.4 -1  up 0 1 0  angle 70 }
    Background { color 0 0 0 }
    Lights { PointLight { position -0.8 1.5 0.3  intensity 2 2 1 } }
    Materials { Matte wall { color 0.6 0.5 0.4 }  Glass glass { }  Matte emitter { color 0 0 0  emission 5 } }
    Group { MaterialIndex wall Box { min -2 -2 -2 max 2 2 2 }
            MaterialIndex glass Sphere { center 0.5 -0.5 0 radius 0.8 }
            MaterialIndex emitter Quad { corner -1.5 1.9 -1 edge1 1 0 0 edge2 0 0 1 } }";

/// The scene of a text.
pub fn load(text: &str) -> Scene {
    let assets = MemoryAssets::new().with("room.txt", text);
    let loaded = kajo::load_from("room.txt", &assets, &LoadOptions::default());
    assert!(loaded.scene.is_some(), "{text}\n{}", loaded.report(false));
    loaded.scene.unwrap()
}
