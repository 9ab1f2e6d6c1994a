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
    /// Names a light among all that integrators sample: those of the file, then the emissive surfaces, then the background.
    LightIndex
}

index! {
    /// Names an entry of [`crate::Scene::varied_emissions`].
    VariedEmissionId
}

/// Most groups of lights that a scene can have, those without a group counted as one.
pub const MAX_LIGHT_GROUPS: usize = 8;

/// A group of lights that has a light layer of its own; the default one holds all lights without a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LightGroup(u8);

impl LightGroup {
    /// The group at an index into [`crate::Scene::light_groups`]; `None` from [`MAX_LIGHT_GROUPS`] on.
    pub fn new(index: usize) -> Option<LightGroup> {
        u8::try_from(index).ok().filter(|_| index < MAX_LIGHT_GROUPS).map(LightGroup)
    }

    /// Its index into [`crate::Scene::light_groups`].
    #[inline]
    pub fn index(self) -> usize {
        self.0.into()
    }
}
