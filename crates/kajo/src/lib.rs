//! kajo, a ray tracer: load, compile and render scenes.
