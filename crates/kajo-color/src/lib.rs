//! Spectra and colour spaces for kajo.
