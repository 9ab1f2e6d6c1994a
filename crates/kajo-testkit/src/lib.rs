//! Statistics and comparisons for the tests of kajo.
