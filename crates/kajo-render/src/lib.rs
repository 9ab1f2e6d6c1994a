//! Film, integrators and the schedule of kajo.
