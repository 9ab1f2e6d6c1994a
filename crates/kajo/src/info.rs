//! What is in a scene, in numbers and names.

use std::path::PathBuf;

use kajo_scene::{Item, SceneDesc};

use crate::{Dialect, Loaded, Scene};

/// A summary of a loaded scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneInfo {
    /// Real paths of the files it was read from.
    pub files: Vec<PathBuf>,
    /// The conventions it is read by.
    pub dialect: Dialect,
    /// The kind of its camera, by the word that makes one.
    pub camera: &'static str,
    /// Lights in the order of the file.
    pub lights: usize,
    /// Names of its materials in the order of the file; the first has number 1 in the id layers.
    pub materials: Vec<Option<String>>,
    /// Its objects in the order of the file; the first has number 1 in the id layers.
    pub objects: Vec<ObjectInfo>,
    /// How many more there are in instances that are kept nested; their numbers follow.
    pub nested_objects: u64,
    /// How many shapes it has of each kind.
    pub shapes: Vec<(&'static str, usize)>,
    /// Triangles of all meshes.
    pub mesh_triangles: u64,
    /// Smallest and largest coordinates of everything that has bounds; `None` when nothing has.
    pub bounds: Option<[[f32; 3]; 2]>,
    /// Bytes of geometry and its trees.
    pub bytes: usize,
    /// The blocks of the text.
    pub tree: Vec<TreeNode>,
}

/// One object of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjectInfo {
    /// The word that makes it, such as `Sphere`.
    pub keyword: String,
    /// Its own name, if it has one.
    pub name: Option<String>,
}

/// A block of the scene's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeNode {
    /// The word before it.
    pub keyword: String,
    /// The name after that, if any.
    pub name: Option<String>,
    /// The blocks within.
    pub children: Vec<TreeNode>,
}

impl SceneInfo {
    /// The summary, or `None` when the scene has errors.
    pub fn of(loaded: &Loaded) -> Option<SceneInfo> {
        let scene = loaded.scene.as_ref()?;
        let objects = scene
            .geometry
            .objects
            .iter()
            .map(|o| ObjectInfo { keyword: o.keyword.to_string(), name: o.name.map(str::to_owned) })
            .collect();
        Some(SceneInfo {
            files: loaded.files.clone(),
            dialect: scene.output.rules.dialect,
            camera: scene.output.camera.keyword(),
            lights: scene.lighting.list.len(),
            materials: scene.appearance.list.iter().map(|(_, name)| name.clone()).collect(),
            objects,
            nested_objects: scene.geometry.object_count() - scene.geometry.primitives.len() as u64,
            shapes: scene.geometry.shapes.counts(),
            mesh_triangles: scene
                .geometry
                .shapes
                .meshes
                .iter()
                .map(|mesh| mesh.triangle_count() as u64)
                .sum(),
            bounds: bounds(scene),
            bytes: scene.geometry.bytes(),
            tree: tree(&loaded.desc),
        })
    }
}

fn bounds(scene: &Scene) -> Option<[[f32; 3]; 2]> {
    let bounds = scene.geometry.bounds();
    (!bounds.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()])
}

fn tree(desc: &SceneDesc) -> Vec<TreeNode> {
    desc.roots().filter(Item::has_block).map(node).collect()
}

// The parser bounds how deep blocks are nested, and so how deep this calls itself.
fn node(item: Item<'_>) -> TreeNode {
    TreeNode {
        keyword: item.keyword().to_owned(),
        name: item.word().map(|word| word.text().into_owned()),
        children: item.children().filter(Item::has_block).map(node).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadOptions, MemoryAssets, load_from};

    #[test]
    fn a_scene_is_summed_up() {
        let text = "OrthographicCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 size 5 }\n\
                    Lights { PointLight { position 1 2 3 color 1 1 1 } }\n\
                    Materials { Material red { diffuseColor 1 0 0 } Material {} }\n\
                    Group { MaterialIndex red Sphere moon { center 1 0 0 radius 1 }\n\
                    Plane { normal 0 1 0 offset -1 } }";
        let assets = MemoryAssets::new().with("s.txt", text);
        let loaded = load_from("s.txt", &assets, &LoadOptions::default());
        let info = SceneInfo::of(&loaded).unwrap();
        assert_eq!((info.camera, info.lights, info.mesh_triangles), ("OrthographicCamera", 1, 0));
        assert_eq!(info.materials, [Some("red".to_owned()), None]);
        assert_eq!(info.objects[0], ObjectInfo { keyword: "Sphere".into(), name: Some("moon".into()) });
        assert_eq!(info.shapes.iter().map(|(_, n)| n).sum::<usize>(), 2);
        let [low, high] = info.bounds.unwrap();
        for (found, expected) in low.iter().chain(&high).zip([0.0, -1.0, -1.0, 2.0, 1.0, 1.0]) {
            assert!((found - expected).abs() < 1e-4, "{low:?} to {high:?}");
        }
        let group = info.tree.iter().find(|node| node.keyword == "Group").unwrap();
        assert_eq!(
            group.children.iter().map(|node| node.keyword.as_str()).collect::<Vec<_>>(),
            ["Sphere", "Plane"]
        );

        let wrong =
            load_from("s.txt", &MemoryAssets::new().with("s.txt", "Grup {}"), &LoadOptions::default());
        assert_eq!(SceneInfo::of(&wrong), None);
    }
}
