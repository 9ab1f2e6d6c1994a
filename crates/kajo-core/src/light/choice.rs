//! The rules by which one of many lights is chosen.

use super::LightVisibility;

/// How a light is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// By what it may contribute.
    #[default]
    Tree,
    /// Each as often as any other.
    Uniform,
    /// By what it may contribute and how often that arrives, which is learned before.
    Learned,
}

impl LightChoice {
    /// Names on the command line and in `Settings`, with the rules.
    pub const NAMES: [(&'static str, LightChoice); 3] =
        [("tree", LightChoice::Tree), ("uniform", LightChoice::Uniform), ("learned", LightChoice::Learned)];
}

/// How lights are chosen, with what that takes.
#[derive(Clone, Copy, Debug, Default)]
pub enum LightSelection<'a> {
    /// By what they may contribute, beside scattering that finds their light too.
    #[default]
    Tree,
    /// By what they may contribute, where nothing else finds their light.
    TreeAlone,
    /// Each as often as any other.
    Uniform,
    /// By what they may contribute and how often it arrives, beside scattering.
    Learned(&'a LightVisibility),
    /// The same where nothing else finds their light.
    LearnedAlone(&'a LightVisibility),
}

impl LightSelection<'_> {
    /// Whether scattering finds the light too, and both ways count by their densities.
    #[inline]
    pub fn is_beside_scattering(self) -> bool {
        matches!(self, LightSelection::Tree | LightSelection::Learned(_))
    }

    /// The same where scattering finds no light.
    pub fn alone(self) -> Self {
        match self {
            LightSelection::Tree => LightSelection::TreeAlone,
            LightSelection::Learned(visibility) => LightSelection::LearnedAlone(visibility),
            other => other,
        }
    }
}

/// Without a table what is to be learned is taken for visible.
impl From<LightChoice> for LightSelection<'_> {
    #[inline]
    fn from(choice: LightChoice) -> Self {
        match choice {
            LightChoice::Tree | LightChoice::Learned => LightSelection::Tree,
            LightChoice::Uniform => LightSelection::Uniform,
        }
    }
}
