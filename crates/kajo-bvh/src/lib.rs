//! Bounding volume hierarchies for kajo.
