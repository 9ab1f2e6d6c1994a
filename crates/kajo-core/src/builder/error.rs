//! Why a scene cannot be made.

use kajo_scene::OverBudget;

use crate::ids::{AssemblyId, LightGroup, MAX_FRAMES, MAX_LIGHT_GROUPS, MaterialSlot, PoseId};
use crate::material::MaterialId;
use crate::medium::MediumId;
use crate::nested::MOST_LEVELS;
use crate::scene::MAX_GAMMA;
use crate::shape::ShapeId;

/// Why something cannot be part of a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// A number that is infinite or none; the type it stands in.
    #[error("a number of a {0} is infinite or none")]
    NotFinite(&'static str),
    /// A map that is not invertible, so that nothing under it could be hit.
    #[error("a map from object to world space has no inverse")]
    NoInverse,
    /// A shape that this builder has not named.
    #[error("the scene has no shape {0:?}")]
    UnknownShape(ShapeId),
    /// A material that this builder has not named.
    #[error("the scene has no material {0:?}")]
    UnknownMaterial(MaterialId),
    /// A medium that this builder has not named.
    #[error("the scene has no medium {0:?}")]
    UnknownMedium(MediumId),
    /// A medium that bends light, named by a material whose surface does more than end it.
    #[error("a medium that bends light can only fill a body with the material `Interface`, not with `{0}`")]
    CurvedInside(&'static str),
    /// A medium that bends light, around everything.
    #[error("a medium that bends light fills closed bodies only, not all that is around them")]
    CurvedAir,
    /// Air without end that gives light and does not weaken it.
    #[error(
        "air without end that gives light has to absorb or scatter all colours, or all of it together would be endlessly bright"
    )]
    EndlessEmission,
    /// A texture that this builder has not named.
    #[error("the scene has no such texture")]
    UnknownTexture,
    /// A place that this builder has not named.
    #[error("the scene has no transform and no motion {0:?}")]
    UnknownPose(PoseId),
    /// An assembly that this builder has not named.
    #[error("the scene has no assembly {0:?}")]
    UnknownAssembly(AssemblyId),
    /// A group that this builder has not named.
    #[error("the scene has no group of lights {0:?}")]
    UnknownLightGroup(LightGroup),
    /// A mesh names a material by a number that [`SceneBuilder::mesh_material`](super::SceneBuilder::mesh_material) has not given.
    #[error("the scene has no material number {} for triangles of meshes", .0.index())]
    UnknownMeshMaterial(MaterialSlot),
    /// An object that was not pushed; its index.
    #[error("the scene has no object {0}")]
    UnknownObject(usize),
    /// More members of one type than a handle can name.
    #[error("there are too many of the type {0}")]
    TooMany(&'static str),
    /// More objects than [`kajo_scene::Limits::objects`], or than numbers can name.
    #[error("there would be more than {0} objects")]
    TooManyObjects(usize),
    /// More groups of lights than have layers.
    #[error("a scene has at most {} groups of lights, and that of all others", MAX_LIGHT_GROUPS - 1)]
    TooManyLightGroups,
    /// A name of a group that would be none of a layer.
    #[error("`{0}` cannot name a group of lights: it takes letters, digits, `_` and `-`")]
    LightGroupName(String),
    /// Assemblies one in the other.
    #[error("there are more than {MOST_LEVELS} levels of assemblies")]
    TooManyLevels,
    /// A part of an assembly has no bounds, so that no tree can hold it.
    #[error("a shape without bounds cannot be part of an assembly")]
    UnboundedPart,
    /// A part of an assembly would give light: each object that does is listed, and these are too many.
    #[error("parts of an assembly cannot give light")]
    EmissivePart,
    /// A part of an assembly moves, in whole or in part.
    #[error("parts of an assembly cannot move")]
    MovingPart,
    /// An assembly has parts without a material, and its instance has none for them.
    #[error("an instance of an assembly whose parts have no material needs one")]
    NoMaterial,
    /// A velocity that nothing has.
    #[error(
        "nothing moves at the speed of light: a velocity is less than 1 long, and by {MAX_GAMMA} clocks may run slow"
    )]
    Velocity,
    /// Too many velocities.
    #[error(
        "there are more than {MAX_FRAMES} different velocities, in each of which every ray has to be tested"
    )]
    TooManyFrames,
    /// A light that the scene makes itself, of emissive objects or of the background.
    #[error("a {0} is made by the scene itself")]
    OwnLight(&'static str),
    /// There is no camera to take the picture.
    #[error("the scene has no camera")]
    NoCamera,
    /// A picture without pixels.
    #[error("the picture would have no pixels: {0} by {1}")]
    EmptyPicture(u32, u32),
    /// A shutter that closes before it opens.
    #[error("the shutter closes before it opens")]
    Shutter,
    /// A medium whose matter goes so far while the shutter is open that nothing of it would be seen.
    #[error(
        "the matter of a `GridMedium` goes more than 100 times as far as its grid is wide while the shutter is open: \
         `velocityScale` or the `shutter` of the camera is not what it should be"
    )]
    FastMedium,
    /// There is too little memory for the lights that emissive objects are.
    #[error("there is no memory for so many lights: {0}")]
    LightMemory(OverBudget),
}
