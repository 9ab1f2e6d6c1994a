//! Pixel buffers, picture files and picture comparison for kajo.
