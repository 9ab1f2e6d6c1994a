//! Vectors, rays, boxes, transforms, motions, inertial frames, differential equations, random numbers and noise.
//!
//! Everything here is a pure function of its arguments. Coordinates are
//! right-handed; angles are radians unless a name says degrees. Elementary
//! functions come from [`fmath`], never from the system's maths library, so that a
//! picture does not depend on the machine it was made on.

pub mod aabb;
pub mod bilinear;
pub mod delaunay;
pub mod fmath;
pub mod frame;
pub mod gravity;
pub mod half;
pub mod interval;
pub mod keyed;
pub mod lorentz;
pub mod motion;
pub mod noise;
pub mod ode;
pub mod pattern;
pub mod permute;
pub mod piecewise;
pub mod pmj;
pub mod poisson;
pub mod principal;
pub mod quadrature;
pub mod ray;
pub mod rng;
pub mod robust;
pub mod roots;
pub mod sobol;
pub mod solid_angle;
pub mod spline_grid;
pub mod tape;
pub mod transform;
pub mod warp;
pub mod world_line;

pub use aabb::Aabb;
pub use frame::Frame;
pub use glam::{
    Affine3, Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec2, DVec3, DVec4, Mat3, Mat3A, Mat4, UVec2, UVec3,
    Vec2, Vec3, Vec3A, Vec4,
};
pub use motion::{KeyError, Keyframes, Motion};
pub use ray::Ray;
pub use transform::Transform;
