//! The compiled scene of kajo and everything evaluated along a ray.
