//! From the tree of a scene text to a [`Scene`].
//!
//! Each kind of block has a file in `blocks` with its fields and what is made of them; the files here read what
//! several of them share, and the lists that they stand in. Mistakes do not stop the reading: all of them are
//! collected with their places, and a scene comes out only when there are none.

mod aim;
mod animation;
mod background;
mod black_holes;
mod blobs;
mod blocks;
mod camera;
mod camera_keys;
mod cameras;
mod csg;
mod curves;
mod definition;
mod extras;
mod fields;
mod follow_path;
mod graphics_state;
mod grid;
mod group;
mod height_field;
mod lens;
mod light_groups;
mod light_quantities;
mod lights;
mod lorentz;
mod material_draft;
mod materials;
mod measured;
mod media;
mod member;
mod mesh;
mod mesh_store;
mod misplaced;
mod model;
mod model_beads;
mod model_files;
mod model_light;
mod model_material;
mod model_picture;
mod motion;
mod mtl_material;
mod named_texture;
mod nesting;
mod operands;
mod operations;
mod part;
mod paths;
mod picture_files;
mod picture_values;
mod scale;
mod settings;
mod spectra;
mod subdivision;
mod textures;
mod touching;
mod transform;
mod value_names;
mod world_line;

pub use self::animation::{animation_of, clock_of};
pub use self::blocks::animation::LAST_FRAME;
pub use self::blocks::texture_operations::ramp_colors;
pub use self::blocks::{block_in, block_of, blocks, keywords_of, kind_of};
pub use self::mesh_store::MeshStore;
pub use self::operations::{BLOCK_OPERATIONS, OPERATIONS};
pub use self::picture_files::tile_picture;
pub use self::settings::BLOCK as SETTINGS;
pub use self::transform::operations_matrix;

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, OnceLock};

use kajo_bvh::BuildSettings;
use kajo_scene::{Assets, Diagnostic, Diagnostics, Item, Limits, MeshFileError, Params, SceneDesc, Span};

use self::blocks::{LIGHT_LIST, MATERIAL_LIST, MEDIUM_LIST, TEXTURE_LIST};
use self::definition::Definition;
use self::misplaced::misplaced;
use crate::animation::{AnimatedModel, Animation};
use crate::builder::{SceneBuilder, SceneError};
use crate::camera::NamedCamera;
use crate::ids::MaterialSlot;
use crate::material::MaterialId;
use crate::scene::{Output, Scene};
use crate::settings::{Dialect, Rules, Settings};
use crate::shape::{AnyShape, ShapeId};
use crate::texture::{TexelFilter, TiledCopies};

/// The inputs of the compiler besides the text.
#[derive(Clone, Debug, Default)]
pub struct CompileOptions {
    /// The dialect, where it is not to be the scene's own choice.
    pub dialect: Option<Dialect>,
    /// How pictures are filtered that do not say it themselves, where that is not to be the scene's own choice.
    pub texture_filter: Option<TexelFilter>,
    /// Bounds on what files may demand.
    pub limits: Limits,
    /// How to build the trees over geometry.
    pub build: BuildSettings,
    /// The name of the camera that is to take the picture; the last one without.
    pub camera: Option<String>,
    /// Whether a camera of a model, where one is there, comes before those of the scene unless one is asked for.
    pub model_cameras_first: bool,
    /// Width of the picture over its height, for cameras that fit something into it, where that is not to be the
    /// scene's own choice.
    pub aspect: Option<f64>,
    /// The frame to show; the first one without.
    pub frame: Option<i64>,
    /// Frames of a second, where they are not to be the scene's own choice.
    pub fps: Option<f64>,
    /// Meshes that need not be read again. The same store is for the same limits and the same way to build.
    pub meshes: Option<Arc<MeshStore>>,
    /// Where large pictures are kept that are not to be in memory as a whole; without it all are.
    pub tiled: Option<TiledCopies>,
    /// Names that `integrator` may say. The compiler itself has none: integrators are made of scenes.
    pub integrators: &'static [&'static str],
}

/// Turns a scene's tree into a scene.
///
/// Returns the scene, or `None` when `diagnostics` holds an error afterwards. Files that the scene
/// names are read through `assets`; lines of theirs that messages show are added to the
/// sources of `desc`.
pub fn compile(
    desc: &mut SceneDesc,
    assets: &dyn Assets,
    options: &CompileOptions,
    diagnostics: &mut Diagnostics,
) -> Option<Scene> {
    let mut file_errors = Vec::new();
    let meshes = options.meshes.as_deref();
    meshes.into_iter().for_each(MeshStore::begin);
    let scene = compile_tree(desc, assets, options, diagnostics, &mut file_errors);
    diagnostics.merge_turns(desc.sources());
    if file_errors.is_empty() {
        meshes.filter(|_| scene.is_some()).into_iter().for_each(MeshStore::keep_used);
        return scene;
    }
    for (error, span) in file_errors {
        diagnostics.push(error.to_diagnostic(desc.sources_mut(), Some(span)));
    }
    None
}

fn compile_tree(
    desc: &SceneDesc,
    assets: &dyn Assets,
    options: &CompileOptions,
    diagnostics: &mut Diagnostics,
    file_errors: &mut Vec<(MeshFileError, Span)>,
) -> Option<Scene> {
    value_names::check(desc, diagnostics);
    let mut root = Params::root(desc, diagnostics);
    let camera_items = root.take(&camera::KEYWORDS);
    let settings = root.block(settings::BLOCK.keyword);
    let animation = root.block(blocks::animation::BLOCK.keyword);
    let background = root.block(background::BLOCK.keyword);
    let fog = root.block(background::FOG.keyword);
    let lights = root.block(LIGHT_LIST.keyword);
    let textures = root.block(TEXTURE_LIST.keyword);
    let media = root.block(MEDIUM_LIST.keyword);
    let materials = root.block(MATERIAL_LIST.keyword);
    let group = root.block(blocks::group::GROUP.block.keyword);
    root.elsewhere(|item| misplaced(item, None));
    root.finish();

    let mut compiler = Compiler::new(assets, options, Dialect::default().rules(), diagnostics, file_errors);
    let settings = settings.map(|item| compiler.settings(item)).unwrap_or_default();
    compiler.rules = options.dialect.or(settings.dialect).unwrap_or_default().rules();
    compiler.pictures.filter = options.texture_filter.or(settings.texture_filter).unwrap_or_default();
    compiler.uses = nesting::uses(desc);
    compiler.animation(animation);
    let camera_name = options.camera.as_deref();
    let cameras = compiler.cameras(&camera_items, camera_name);
    let chosen = cameras::chosen(&cameras, camera_name);
    compiler.open_shutter(&cameras, chosen);
    let camera_size = chosen.and_then(|i| cameras[i].size);
    compiler.background(background);
    fog.into_iter().for_each(|item| compiler.fog(item));
    lights.into_iter().for_each(|item| compiler.lights(item));
    textures.into_iter().for_each(|item| compiler.textures(item));
    media.into_iter().for_each(|item| compiler.media(item));
    materials.into_iter().for_each(|item| compiler.materials(item));
    if let Some(item) = group.filter(|_| compiler.moving_fit(desc)) {
        compiler.objects(item);
    }
    compiler.check_emitters();
    // A model that could not be read may have brought one.
    let may_have_camera = compiler.lacks_a_model || !compiler.model_cameras.is_empty();
    if group.is_some() && camera_items.is_empty() && !may_have_camera {
        compiler.diagnostics.push(camera::missing());
    }
    if compiler.has_failed() {
        return None;
    }
    let settings = Settings { size: settings.size.or(camera_size), ..settings };
    let mut scene = compiler.finish(settings, group.is_some())?;
    cameras::span(&mut scene, cameras, desc, options, diagnostics);
    scale::check(&scene, diagnostics);
    touching::check(&scene, desc, diagnostics);
    black_holes::check_cameras(&scene, diagnostics);
    (!diagnostics.has_errors()).then_some(scene)
}

/// The scene while it is being put together.
struct Compiler<'a> {
    assets: &'a dyn Assets,
    options: &'a CompileOptions,
    rules: Rules,
    diagnostics: &'a mut Diagnostics,
    /// Mistakes in files other than the scene's, with where the scene names them.
    file_errors: &'a mut Vec<(MeshFileError, Span)>,
    /// Which frame it is of how many, where there are any.
    animation: Option<Animation>,
    scene: SceneBuilder,
    definitions: HashMap<String, Definition>,
    /// The slots by which solids made of others name materials.
    solid_slots: HashMap<MaterialId, MaterialSlot>,
    /// How often the text places each definition.
    uses: HashMap<String, usize>,
    /// Parts of all definitions.
    parts_defined: usize,
    /// There are more objects than there may be, which has been reported.
    too_many: bool,
    /// Files that name pictures which cannot be read, each with its picture.
    left_out_pictures: HashSet<(String, String)>,
    /// Memory taken for materials.
    material_bytes: usize,
    /// Triangles without area, and where the first one stands.
    flat_triangles: Option<(usize, Span)>,
    medium_names: fields::MediumNames,
    material_names: HashMap<String, MaterialId>,
    /// The names, where they have any, of materials that could not be made, which has been reported.
    failed_materials: HashSet<Option<String>>,
    texture_names: named_texture::TextureNames,
    pictures: picture_files::PictureCache,
    measured: measured::MeasuredCache,
    meshes: mesh::MeshCache,
    /// Those whose colours have opacities.
    clear_meshes: HashSet<ShapeId>,
    /// Of shapes that bring materials the same without.
    plain_shapes: HashMap<ShapeId, ShapeId>,
    models: model::ModelCache,
    /// Cameras that models bring, in world space.
    model_cameras: Vec<NamedCamera>,
    /// Models that follow the frames.
    animated_models: Vec<AnimatedModel>,
    /// Whether a model could not be read.
    lacks_a_model: bool,
}

impl Compiler<'_> {
    /// Takes over when the camera that was chosen is open, and how it moves.
    fn open_shutter(&mut self, cameras: &[camera::CameraRequest<'_>], chosen: Option<usize>) {
        let (shutter, readout) = cameras::shutter_of(cameras, chosen, self.exposure(None));
        self.scene.expose(shutter, readout);
        if let Some(camera) = chosen.map(|i| &cameras[i]) {
            let observed = self.scene.observe(camera.observer);
            self.accepted(observed, camera.item.keyword_span());
        }
    }
}

impl<'a> Compiler<'a> {
    fn new(
        assets: &'a dyn Assets,
        options: &'a CompileOptions,
        rules: Rules,
        diagnostics: &'a mut Diagnostics,
        file_errors: &'a mut Vec<(MeshFileError, Span)>,
    ) -> Compiler<'a> {
        Compiler {
            assets,
            options,
            rules,
            diagnostics,
            file_errors,
            animation: None,
            scene: SceneBuilder::new(options.limits.clone(), options.build),
            definitions: HashMap::new(),
            solid_slots: HashMap::new(),
            uses: HashMap::new(),
            parts_defined: 0,
            too_many: false,
            left_out_pictures: HashSet::new(),
            material_bytes: 0,
            flat_triangles: None,
            medium_names: HashMap::new(),
            material_names: HashMap::new(),
            failed_materials: HashSet::new(),
            texture_names: HashMap::new(),
            pictures: picture_files::PictureCache::default(),
            measured: measured::MeasuredCache::default(),
            meshes: mesh::MeshCache::default(),
            clear_meshes: HashSet::new(),
            plain_shapes: HashMap::new(),
            models: model::ModelCache::default(),
            model_cameras: Vec::new(),
            animated_models: Vec::new(),
            lacks_a_model: false,
        }
    }

    /// Whether there was a mistake, so that no scene will come of it.
    fn has_failed(&self) -> bool {
        self.diagnostics.has_errors()
            || !self.file_errors.is_empty()
            || self.options.limits.memory.was_exceeded()
    }

    /// Reads the block of `item`; everything in it that `read` does not ask for is an error.
    fn read_keys<'t, T>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut fields::Sources<'_>) -> Option<T>,
    ) -> Option<T> {
        let (rules, integrators) = (self.rules, self.options.integrators);
        let (nodes, groups) = self.scene.textures_and_groups();
        let named = &self.texture_names;
        let textures =
            fields::TextureReader::new(self.assets, self.options, &mut self.pictures, nodes, named);
        let media = &self.medium_names;
        let mut sources = fields::Sources { textures, groups, media, rules, integrators };
        let mut params = Params::new(item, self.diagnostics);
        let value = read(&mut params, &mut sources);
        params.finish();
        value
    }

    /// Checks an optional count such as `numLights`; `what` is counted, in the singular.
    fn check_count(&mut self, counter: Option<Item<'_>>, found: usize, what: &str) {
        let Some(counter) = counter else { return };
        let key = counter.keyword();
        let said =
            kajo_scene::Args::read(counter, self.diagnostics, |args| args.int_in(0..=i64::from(u32::MAX)));
        if let Some(said) = said.filter(|&said| usize::try_from(said) != Ok(found)) {
            let there = if found == 1 { format!("is 1 {what}") } else { format!("are {found} {what}s") };
            let message = format!("`{key}` says {said}, but there {there} in this block");
            let error = Diagnostic::error(message).label(counter.head_span(), format!("expected {found}"));
            self.diagnostics.push(error.help(format!("write `{key} {found}`, or leave the count out")));
        }
    }

    /// Adds a shape.
    fn shape(&mut self, item: Item<'_>, shape: impl Into<AnyShape>) -> Option<ShapeId> {
        let added = self.scene.shape(shape);
        self.accepted(added, item.head_span())
    }

    /// What the scene answers to what stands at `at`; why it refuses that is reported.
    fn accepted<T>(&mut self, answer: Result<T, SceneError>, at: Span) -> Option<T> {
        let report = |error: &SceneError| {
            self.diagnostics.push(Diagnostic::error(error.to_string()).label(at, "cannot be in a scene"));
        };
        answer.inspect_err(report).ok()
    }

    /// Warns of objects that give no light although their material does.
    fn check_emitters(&mut self) {
        if self.scene.has_unbounded_emitters() {
            let message = "a plane without bounds gives no light, whatever its material says";
            let warning = Diagnostic::warning(message).help("a `Quad` or a `Disk` can be a light");
            self.diagnostics.push(warning);
        }
        if let Some(what) = self.scene.emitter_without_patches() {
            let message = format!("{what} gives no light, whatever its material says");
            let warning = Diagnostic::warning(message).help("a `Sphere` or a mesh can be a light");
            self.diagnostics.push(warning);
        }
    }

    /// The scene, but for the cameras of the text.
    fn finish(mut self, settings: Settings, has_group: bool) -> Option<Scene> {
        let output = Output {
            camera: camera::none(),
            fitted: None,
            cameras: self.model_cameras,
            readout: self.scene.readout(),
            settings,
            rules: self.rules,
            texture_filter: self.pictures.filter,
            has_group,
            animation: self.animation,
            animated_models: self.animated_models,
            suited: OnceLock::new(),
        };
        let named = self.texture_names.into_iter();
        self.scene.name_textures(named.filter_map(|(name, texture)| Some((name, texture?))).collect());
        let scene = self.scene.finish_with(output);
        let report = |error: &SceneError| self.diagnostics.push(Diagnostic::error(error.to_string()));
        scene.inspect_err(report).ok()
    }
}

#[cfg(test)]
mod animation_tests;
#[cfg(test)]
mod blob_tests;
#[cfg(test)]
mod camera_tests;
#[cfg(test)]
mod csg_motion_tests;
#[cfg(test)]
mod csg_tests;
#[cfg(test)]
mod definition_tests;
#[cfg(test)]
mod emission_tests;
#[cfg(test)]
mod emissive_media_tests;
#[cfg(test)]
mod empty_mesh_tests;
#[cfg(test)]
mod follow_path_tests;
#[cfg(test)]
mod measured_tests;
#[cfg(test)]
mod media_tests;
#[cfg(test)]
mod mesh_file_tests;
#[cfg(test)]
mod model_animation_tests;
#[cfg(test)]
mod model_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod nesting_tests;
#[cfg(test)]
mod object_space_tests;
#[cfg(test)]
mod shading_tests;
#[cfg(test)]
mod subdivision_tests;
#[cfg(test)]
mod swept_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod texture_graph_tests;
#[cfg(test)]
mod texture_law_tests;
