//! The scene language of kajo: text to a tree with places, and mesh files.
