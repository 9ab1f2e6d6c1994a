//! Typed names of what a scene holds in lists.
//!
//! Each name is an index in 32 bits (a light group in 8). How it is encoded is known here alone, so that no name can be taken
//! for another and no other code does arithmetic with one.

/// Writes a name that is an index into one list.
macro_rules! index {
    ($(#[$doc:meta])* $Name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $Name(u32);

        impl $Name {
            /// The name of the entry at an index; `None` where 32 bits do not hold it.
            pub fn new(index: usize) -> Option<$Name> {
                u32::try_from(index).ok().map($Name)
            }

            /// The index of the entry.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }

            /// The names of all entries of a list of this length, as far as 32 bits hold them.
            pub fn all(len: usize) -> impl Iterator<Item = $Name> {
                (0..u32::try_from(len).unwrap_or(u32::MAX)).map($Name)
            }
        }
    };
}

index! {
    /// Names an assembly: a tree of its own that can stand in many places.
    AssemblyId
}

index! {
    /// Names a light among all that integrators sample: those of the file, then the emissive surfaces, then the background.
    LightIndex
}

index! {
    /// Names an entry of [`crate::scene::Lighting::varied_emissions`].
    VariedEmissionId
}

index! {
    /// Names an entry of [`crate::scene::Geometry::transforms`].
    TransformId
}

index! {
    /// Names an entry of [`crate::scene::Geometry::motions`].
    MotionId
}

/// Names an inertial frame of a scene, in which things rest; see [`crate::scene::Relativity`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FrameId(u16);

/// The most inertial frames of a scene, the world's included: every ray is tested in each of them.
pub const MAX_FRAMES: usize = 256;

impl FrameId {
    /// That of the world, in which all rests that says nothing else.
    pub const WORLD: FrameId = FrameId(0);

    /// The frame at an index; `None` from [`MAX_FRAMES`] on.
    pub fn new(index: usize) -> Option<FrameId> {
        u16::try_from(index).ok().filter(|_| index < MAX_FRAMES).map(FrameId)
    }

    /// Its index.
    #[inline]
    pub fn index(self) -> usize {
        self.0.into()
    }
}

/// Where an object stands: names its transform, or its motion if it has one.
///
/// Transforms count upwards from 0 and motions downwards from the largest number, so that looking among the transforms
/// finds nothing for what has a motion, and what has none costs no more than that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PoseId(u32);

impl PoseId {
    /// In the world as it is: the first transform.
    pub const IDENTITY: PoseId = PoseId(0);

    /// Under a transform.
    pub fn still(transform: TransformId) -> PoseId {
        PoseId(transform.0)
    }

    /// Under a motion.
    pub fn moving(motion: MotionId) -> PoseId {
        PoseId(!motion.0)
    }

    /// Whether the object's own space is the world's.
    #[inline]
    pub fn is_identity(self) -> bool {
        self == PoseId::IDENTITY
    }

    /// Its transform among all of a scene; `None` where it has a motion.
    #[inline]
    pub fn still_in<T>(self, transforms: &[T]) -> Option<&T> {
        transforms.get(self.0 as usize)
    }

    /// Its motion among all of a scene; `None` where it has a transform.
    #[inline]
    pub fn moving_in<T>(self, motions: &[T]) -> Option<&T> {
        motions.get(!self.0 as usize)
    }

    /// The same to change it.
    pub fn moving_in_mut<T>(self, motions: &mut [T]) -> Option<&mut T> {
        motions.get_mut(!self.0 as usize)
    }
}

/// Names an object: an entry of [`crate::scene::Geometry::primitives`], or past their end an object in a nested instance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(u32);

impl ObjectId {
    /// No object, which comes after all others.
    pub(crate) const NONE: ObjectId = ObjectId(u32::MAX);

    /// How many objects can be named.
    pub(crate) const MOST: u32 = u32::MAX - 1;

    /// The object at an index.
    #[inline]
    pub fn from_index(index: u32) -> ObjectId {
        ObjectId(index)
    }

    /// The first `len` objects, as far as they can be named.
    pub fn all(len: usize) -> impl Iterator<Item = ObjectId> {
        (0..u32::try_from(len).unwrap_or(ObjectId::MOST)).map(ObjectId)
    }

    /// Its index among all objects.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The object with a number in the id layers.
    pub fn from_number(number: u32) -> Option<ObjectId> {
        number.checked_sub(1).map(ObjectId)
    }

    /// Its number in the id layers, counted from 1.
    #[inline]
    pub fn number(self) -> u32 {
        self.0 + 1
    }

    /// The object that stands this many after it, in the order of the text.
    #[inline]
    pub(crate) fn after(self, count: u32) -> ObjectId {
        ObjectId(self.0 + count)
    }

    /// How many objects stand between another one and this; `None` where this one comes first.
    #[inline]
    pub(crate) fn since(self, first: ObjectId) -> Option<u32> {
        self.0.checked_sub(first.0)
    }
}

/// Names a material that parts of shapes bring: an entry of the slots of a [`crate::scene::Scene`], or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialSlot(u32);

impl MaterialSlot {
    /// No material of the part's own: it has that of the object.
    pub const NONE: MaterialSlot = MaterialSlot(u32::MAX);

    /// The name of the entry at an index; `None` where 32 bits do not hold it.
    pub fn new(index: usize) -> Option<MaterialSlot> {
        u32::try_from(index).ok().map(MaterialSlot).filter(|slot| *slot != MaterialSlot::NONE)
    }

    /// The index of the entry.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The name, unless it is that of none.
    #[inline]
    pub fn given(self) -> Option<MaterialSlot> {
        (self != MaterialSlot::NONE).then_some(self)
    }
}

/// Most groups of lights that a scene can have, those without a group counted as one.
pub const MAX_LIGHT_GROUPS: usize = 8;

/// A group of lights that has a light layer of its own; the default one holds all lights without a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LightGroup(u8);

impl LightGroup {
    /// The group at an index into [`crate::scene::Lighting::groups`]; `None` from [`MAX_LIGHT_GROUPS`] on.
    pub fn new(index: usize) -> Option<LightGroup> {
        u8::try_from(index).ok().filter(|_| index < MAX_LIGHT_GROUPS).map(LightGroup)
    }

    /// Its index into [`crate::scene::Lighting::groups`].
    #[inline]
    pub fn index(self) -> usize {
        self.0.into()
    }
}
