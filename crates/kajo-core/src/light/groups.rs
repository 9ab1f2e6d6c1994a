//! Names of groups of lights.

use std::sync::Arc;

use crate::ids::LightGroup;

/// The group of what is in none.
pub(crate) const OTHER: &str = "other";

/// Why a name makes no group of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightGroupError {
    /// It has other characters than letters, digits, `_` and `-`, or none.
    Name,
    /// There are as many groups as have layers.
    TooMany,
}

/// The names of groups, in the order in which they are met; the first is that of lights without a group.
#[derive(Clone, Debug)]
pub struct LightGroups {
    names: Vec<String>,
}

impl Default for LightGroups {
    fn default() -> LightGroups {
        LightGroups { names: vec![OTHER.to_owned()] }
    }
}

impl LightGroups {
    /// The group of a name, which may be a new one.
    ///
    /// # Errors
    /// [`LightGroupError`].
    pub fn group(&mut self, name: &str) -> Result<LightGroup, LightGroupError> {
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c)) {
            return Err(LightGroupError::Name);
        }
        let known = self.names.iter().position(|known| known == name);
        let group = LightGroup::new(known.unwrap_or(self.names.len())).ok_or(LightGroupError::TooMany)?;
        if known.is_none() {
            self.names.push(name.to_owned());
        }
        Ok(group)
    }

    /// Whether a group has a name.
    pub fn contains(&self, group: LightGroup) -> bool {
        group.index() < self.names.len()
    }

    /// All names; that of a group stands at its index.
    pub fn into_names(self) -> Arc<[String]> {
        self.names.into()
    }
}
