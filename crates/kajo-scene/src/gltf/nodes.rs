//! The tree of nodes: which mesh, light and camera stands where.

use super::accessor::AccessorView;
use super::container::Buffers;
use super::json::{Document, Instancing, Node};
use super::{Budget, Model, ModelCamera, ModelInstance, ModelLight};
use crate::limits::Limits;
use kajo_math::{DAffine3, DMat3, DVec3};
use std::collections::HashMap;

/// What the tree says.
#[derive(Default)]
pub(super) struct Tree {
    /// Without meshes yet: those of instances are numbers in `shown`.
    pub model: Model,
    /// The meshes that are shown, in the order of their first instance.
    pub shown: Vec<Shown>,
    /// From the space of each node of the scene to the model's.
    pub places: Vec<Option<DAffine3>>,
}

/// A mesh of the file in one of its shapes.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Shown {
    /// Its number in the file.
    pub mesh: usize,
    /// The node, where that has a say in the shape: by a skin or by weights of its own.
    pub node: Option<usize>,
}

/// What instances are read with.
struct Reading<'r, 'd> {
    document: &'r Document,
    buffers: &'r Buffers<'d>,
    limits: &'r Limits,
    budget: &'r mut Budget,
    /// Number of each mesh, and of each that its node has a say in, in [`Tree::shown`].
    numbers: HashMap<Shown, usize>,
}

impl Reading<'_, '_> {
    /// Adds the instances of a node's mesh.
    ///
    /// * `number`: of the node
    fn show(
        &mut self,
        tree: &mut Tree,
        mesh: usize,
        number: usize,
        transform: &DAffine3,
    ) -> Result<(), String> {
        let Reading { document, buffers, limits, budget, numbers } = self;
        let node = &document.nodes[number];
        let transform = *transform;
        let named = |said: String| format!("nodes[{number}]: {said}");
        let Some(shown) = document.meshes.get(mesh) else {
            return Err(named(format!("there is no meshes[{mesh}]")));
        };
        let name = node.name.as_ref().or(shown.name.as_ref()).filter(|name| !name.is_empty()).cloned();
        let instancing = node.extensions.as_ref().and_then(|extensions| extensions.instancing.as_ref());
        let many = instancing.map(|instancing| Many::new(document, buffers, instancing));
        let many = many.transpose().map_err(named)?;
        let count = many.as_ref().map_or(1, |many| many.count);
        let model = &mut tree.model;
        if count > limits.objects - model.instances.len() {
            return Err(format!("there are more than {} instances", limits.objects));
        }
        budget.take::<ModelInstance>(count)?;
        let has_a_say = node.skin.is_some() || node.weights.is_some();
        let shown = Shown { mesh, node: has_a_say.then_some(number) };
        let mesh = *numbers.entry(shown).or_insert_with(|| {
            tree.shown.push(shown);
            tree.shown.len() - 1
        });
        // The joints of a skin say where it is, whatever its own node does.
        let base = if node.skin.is_some() { DAffine3::IDENTITY } else { transform };
        let place_of = |i| many.as_ref().map_or(base, |many| base * many.get(i));
        model.instances.extend((0..count).map(|i| ModelInstance {
            name: name.clone(),
            mesh,
            model_from_mesh: place_of(i),
        }));
        Ok(())
    }
}

/// Walks the scene's nodes.
pub(super) fn read(
    document: &Document,
    buffers: &Buffers<'_>,
    limits: &Limits,
    budget: &mut Budget,
) -> Result<Tree, String> {
    budget.take::<Option<DAffine3>>(document.nodes.len())?;
    let mut tree = Tree { places: vec![None; document.nodes.len()], ..Tree::default() };
    let mut reading = Reading { document, buffers, limits, budget, numbers: HashMap::new() };
    let mut open: Vec<(usize, DAffine3)> =
        roots(document)?.into_iter().rev().map(|root| (root, DAffine3::IDENTITY)).collect();
    while let Some((number, parent)) = open.pop() {
        let node = document.nodes.get(number).ok_or_else(|| format!("there is no nodes[{number}]"))?;
        let transform = parent * local(node);
        if tree.places[number].replace(transform).is_some() {
            return Err(format!("nodes[{number}] hangs on two places of the tree"));
        }
        if node.extensions.as_ref().is_some_and(|extensions| !extensions.visibility.visible) {
            continue;
        }
        let named = |said: String| format!("nodes[{number}]: {said}");
        if let Some(mesh) = node.mesh {
            reading.show(&mut tree, mesh, number, &transform)?;
        }
        if let Some(light) = light_of(document, node, &transform).map_err(named)? {
            reading.budget.take::<ModelLight>(1)?;
            tree.model.lights.push(light);
        }
        if let Some(camera) = camera_of(document, node, &transform).map_err(named)? {
            reading.budget.take::<ModelCamera>(1)?;
            tree.model.cameras.push(camera);
        }
        open.extend(node.children.iter().rev().map(|&child| (child, transform)));
    }
    Ok(tree)
}

/// The nodes of the file's scene; in a file without scenes, those that hang on no other.
fn roots(document: &Document) -> Result<Vec<usize>, String> {
    let number = document.scene.unwrap_or(0);
    if let Some(scene) = document.scenes.get(number) {
        return Ok(scene.nodes.clone());
    }
    if document.scene.is_some() {
        return Err(format!("there is no scenes[{number}]"));
    }
    let mut is_root = vec![true; document.nodes.len()];
    for &child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(root) = is_root.get_mut(child) {
            *root = false;
        }
    }
    Ok((0..is_root.len()).filter(|&i| is_root[i]).collect())
}

fn local(node: &Node) -> DAffine3 {
    if let Some(m) = &node.matrix {
        return affine(m);
    }
    placed(
        node.translation.unwrap_or([0.0; 3]),
        node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
        node.scale.unwrap_or([1.0; 3]),
    )
}

/// `T R S`, with the rotation as a quaternion x, y, z, w, brought to unit length.
fn placed(translation: [f64; 3], [x, y, z, w]: [f64; 4], scale: [f64; 3]) -> DAffine3 {
    let norm = x * x + y * y + z * z + w * w;
    let s = if norm > 0.0 { 2.0 / norm } else { 0.0 };
    let rotation = DMat3::from_cols(
        DVec3::new(1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
        DVec3::new(s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)),
        DVec3::new(s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)),
    );
    DAffine3 {
        matrix3: rotation * DMat3::from_diagonal(DVec3::from(scale)),
        translation: DVec3::from(translation),
    }
}

/// The places of `EXT_mesh_gpu_instancing`.
struct Many<'b> {
    count: usize,
    translation: Option<AccessorView<'b, 3>>,
    rotation: Option<AccessorView<'b, 4>>,
    scale: Option<AccessorView<'b, 3>>,
}

impl<'b> Many<'b> {
    fn new(
        document: &Document,
        buffers: &'b Buffers<'_>,
        instancing: &Instancing,
    ) -> Result<Many<'b>, String> {
        let number = |name: &str| instancing.attributes.get(name).copied();
        let (translation, rotation, scale) = (number("TRANSLATION"), number("ROTATION"), number("SCALE"));
        let many = Many {
            count: 0,
            translation: translation
                .map(|number| AccessorView::new(document, buffers, number))
                .transpose()?,
            rotation: rotation.map(|number| AccessorView::new(document, buffers, number)).transpose()?,
            scale: scale.map(|number| AccessorView::new(document, buffers, number)).transpose()?,
        };
        let counts = [
            many.translation.as_ref().map(|v| (v.count, v.is_backed())),
            many.rotation.as_ref().map(|v| (v.count, v.is_backed())),
            many.scale.as_ref().map(|v| (v.count, v.is_backed())),
        ];
        let mut counts = counts.into_iter().flatten();
        // Without attributes there is one, at the node itself.
        let first = counts.next().unwrap_or((1, true));
        if !first.1 || counts.any(|other| other != first) {
            return Err("the attributes of its instances differ in number or have no data".to_owned());
        }
        Ok(Many { count: first.0, ..many })
    }

    fn get(&self, i: usize) -> DAffine3 {
        placed(
            self.translation.as_ref().map_or([0.0; 3], |view| view.get(i)),
            self.rotation.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |view| view.get(i)),
            self.scale.as_ref().map_or([1.0; 3], |view| view.get(i)),
        )
    }
}

/// A matrix given column by column, without its last row.
pub(super) fn affine(m: &[f64; 16]) -> DAffine3 {
    let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    DAffine3::from_cols(column(0), column(1), column(2), column(3))
}

/// The camera of a node, if it has one that sees anything.
fn camera_of(document: &Document, node: &Node, transform: &DAffine3) -> Result<Option<ModelCamera>, String> {
    let Some(number) = node.camera else { return Ok(None) };
    let camera = document.cameras.get(number).ok_or_else(|| format!("there is no cameras[{number}]"))?;
    Ok(camera.placed(node.name.as_ref(), transform))
}

/// The light of a node, if it has one and stands anywhere.
fn light_of(document: &Document, node: &Node, transform: &DAffine3) -> Result<Option<ModelLight>, String> {
    let Some(said) = node.extensions.as_ref().and_then(|extensions| extensions.light.as_ref()) else {
        return Ok(None);
    };
    let lights = document.extensions.as_ref().and_then(|extensions| extensions.lights.as_ref());
    let light = lights.and_then(|lights| lights.lights.get(said.light));
    light.ok_or_else(|| format!("there is no light {}", said.light))?.placed(node.name.as_ref(), transform)
}
