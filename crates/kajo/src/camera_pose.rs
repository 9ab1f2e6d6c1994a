//! A camera that can be moved: to fly, to orbit, to show a box, and to say where things appear.
//!
//! The projection matrix takes world space to clip space, with depth in [0, 1] and y up, and agrees with the rays
//! that the tracer casts. With the camera's axes as the columns of `B` and `d = 1 / tan(angle / 2)`,
//!
//! ```text
//! perspective    (d/aspect a, d b, far/(far-near) (s - near), s)         (a, b, s) = B^-1 (p - eye)
//! orthographic   (2/(size aspect) a, 2/size b, (s - near)/(far - near), 1)
//! ```
//!
//! For angles beyond 180 degrees `d` is negative, such a camera sees what is behind it, and all three change their sign.

mod strokes;

use kajo_core::camera::{Camera, CameraFrame, OrthographicCamera, PerspectiveCamera, Raster, ThinLens};
use kajo_core::scene::Scene;
use kajo_core::settings::Rules;
use kajo_math::{Aabb, DMat3, DMat4, DQuat, DVec2, DVec3, DVec4, Ray, Vec2, fmath};

pub use strokes::Stroke;

/// How near to straight up or down a turned camera may look, as a cosine.
const STEEPEST: f64 = 0.9999;

/// Where a camera stands, where it looks, and how it makes a picture of that.
///
/// A pose that was never changed has the very camera of its scene, bit for bit. One that moves while the shutter is open
/// is where it is at the opening, and stands still from there on when it is changed.
#[derive(Clone, Debug)]
pub struct CameraPose {
    /// What the tracer uses.
    camera: Camera,
    /// The same at the opening of the shutter, without its motion.
    still: Camera,
    /// Whether samples lie on the corners of the picture, as one dialect has it.
    corner_samples: bool,
    /// Whether angles and sizes are those of the width, as one dialect has it.
    spans_width: bool,
    /// The direction that stays up when the camera turns.
    level: DVec3,
}

impl CameraPose {
    /// The scene's own camera.
    pub fn of(scene: &Scene) -> CameraPose {
        CameraPose::with(scene, scene.output.camera.clone())
    }

    /// The scene's own camera in a picture of another shape; see [`Scene::camera_for`].
    ///
    /// * `aspect`: width of the picture over its height
    pub fn in_picture(scene: &Scene, aspect: f64) -> CameraPose {
        CameraPose::with(scene, scene.camera_for(aspect))
    }

    fn with(scene: &Scene, camera: Camera) -> CameraPose {
        let still = still(&camera);
        let level = nearest_axis(still.frame().up);
        let Rules { corner_samples, spans_width, .. } = scene.output.rules;
        CameraPose { camera, still, corner_samples, spans_width, level }
    }

    fn new(camera: Camera, up: DVec3) -> CameraPose {
        CameraPose {
            still: camera.clone(),
            camera,
            corner_samples: false,
            spans_width: false,
            level: nearest_axis(up),
        }
    }

    /// A pinhole camera at `eye` that looks at `target`.
    ///
    /// * `angle`: vertical field of view in radians
    pub fn perspective(eye: DVec3, target: DVec3, up: DVec3, angle: f64) -> CameraPose {
        let frame = CameraFrame::new(eye, target - eye, up);
        CameraPose::new(Camera::Perspective(PerspectiveCamera::new(frame, angle)), up)
    }

    /// Parallel rays; `size` is the height of the picture in world units.
    pub fn orthographic(eye: DVec3, target: DVec3, up: DVec3, size: f64) -> CameraPose {
        let frame = CameraFrame::new(eye, target - eye, up);
        CameraPose::new(Camera::Orthographic(OrthographicCamera { frame, size, lens: None }), up)
    }

    /// The camera as the tracer uses it.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// World-space position.
    pub fn eye(&self) -> DVec3 {
        self.still.frame().center
    }

    /// Unit vector forward.
    pub fn forward(&self) -> DVec3 {
        self.still.frame().forward
    }

    /// Unit vector up, perpendicular to the direction in all dialects but one.
    pub fn up(&self) -> DVec3 {
        self.still.frame().up
    }

    /// Unit vector to the right.
    pub fn right(&self) -> DVec3 {
        self.still.frame().right
    }

    /// The word that makes this kind of camera in a scene.
    pub fn keyword(&self) -> &'static str {
        self.still.keyword()
    }

    /// Vertical field of view in radians, of a perspective camera.
    pub fn angle(&self) -> Option<f64> {
        match &self.still {
            Camera::Perspective(camera) => Some(2.0 * fmath::atan64(1.0 / camera.distance())),
            _ => None,
        }
    }

    /// Height of the picture in world units, of an orthographic camera.
    pub fn size(&self) -> Option<f64> {
        match &self.still {
            Camera::Orthographic(camera) => Some(camera.size),
            _ => None,
        }
    }

    /// The lens, where there is one.
    pub fn lens(&self) -> Option<&ThinLens> {
        self.still.lens()
    }

    /// Another field of view; no other camera than a perspective one has any.
    pub fn set_angle(&mut self, angle: f64) {
        if let Camera::Perspective(camera) = &self.still {
            let lens = camera.lens().cloned();
            self.set(Camera::Perspective(PerspectiveCamera::new(*camera.frame(), angle).with_lens(lens)));
        }
    }

    /// Another height of the picture; no other camera than an orthographic one has any.
    pub fn set_size(&mut self, size: f64) {
        if let Camera::Orthographic(camera) = &self.still {
            self.set(Camera::Orthographic(OrthographicCamera { size, ..camera.clone() }));
        }
    }

    /// Another lens, or a pinhole; cameras that see all around stay as they are.
    pub fn set_lens(&mut self, lens: Option<ThinLens>) {
        self.set(self.still.clone().with_lens(lens));
    }

    /// Moves the camera to `eye`, its axes unchanged.
    pub fn set_eye(&mut self, eye: DVec3) {
        self.set_frame(CameraFrame { center: eye, ..*self.still.frame() });
    }

    /// Moves the camera along its own axes.
    ///
    /// * `by`: to the right, up and forward, in world units
    pub fn fly(&mut self, by: DVec3) {
        let CameraFrame { center, right, up, forward } = *self.still.frame();
        self.set_eye(center + by.x * right + by.y * up + by.z * forward);
    }

    /// Turns the camera where it stands, level all the time: it never looks quite straight up or down.
    ///
    /// * `right`, `up`: angles in radians
    pub fn turn(&mut self, right: f64, up: f64) {
        let forward = self.turned(self.forward(), right, up);
        self.set_frame(CameraFrame::new(self.eye(), forward, self.level));
    }

    /// Carries the camera around `center`, looking at the same place of it as before.
    ///
    /// * `right`, `up`: angles in radians by which the camera moves around the centre
    pub fn orbit(&mut self, center: DVec3, right: f64, up: f64) {
        let forward = self.turned(self.forward(), -right, -up);
        let turned = CameraFrame::new(self.eye(), forward, self.level);
        let arm = self.still.frame().local(center).unwrap_or(DVec3::ZERO);
        let eye = center - (arm.x * turned.right + arm.y * turned.up + arm.z * turned.forward);
        self.set_frame(CameraFrame { center: eye, ..turned });
    }

    /// Looks at `target` from where it stands.
    pub fn look_at(&mut self, target: DVec3) {
        self.set_frame(CameraFrame::new(self.eye(), target - self.eye(), self.level));
    }

    /// Moves the camera back or forth, its direction unchanged, until a box fills the picture; the picture of
    /// parallel rays becomes as high as needs be.
    ///
    /// * `aspect`: width of the picture over its height
    pub fn frame(&mut self, bounds: &Aabb, aspect: f64) {
        if bounds.is_empty() || !bounds.is_finite() {
            return;
        }
        /// Some air around the box.
        const MARGIN: f64 = 1.1;
        let center = bounds.center().as_dvec3();
        let radius = MARGIN * (0.5 * bounds.extent().as_dvec3().length()).max(1e-6);
        let narrow = aspect.min(1.0);
        let half_angle = match &self.still {
            Camera::Perspective(camera) => fmath::atan64(narrow / camera.distance().abs()),
            _ => 0.25 * std::f64::consts::PI,
        };
        let distance = radius / fmath::sin64(half_angle);
        self.set_size(2.0 * radius / narrow);
        self.set_eye(center - distance * self.forward());
    }

    /// Which way a flat picture looks: 1 forward, -1 back, as with an angle beyond 180 degrees.
    fn sense(&self) -> f64 {
        match &self.still {
            Camera::Perspective(camera) => camera.distance().signum(),
            _ => 1.0,
        }
    }

    /// Whether the picture is flat, so that [`CameraPose::projection`] makes it.
    pub fn is_flat(&self) -> bool {
        self.projection([1, 1], 1.0, 2.0).is_some()
    }

    /// Depths for [`CameraPose::projection`] between which all of a box lies, and of planes that are much larger what one
    /// sees; no nearer than a small share of that.
    pub fn depths(&self, bounds: &Aabb) -> [f64; 2] {
        /// Places of planes are that far away, at most.
        const HORIZON: f64 = 1e5;
        let (center, radius) = (bounds.center().as_dvec3(), f64::from(bounds.extent().length()) / 2.0);
        let ahead = self.sense() * (center - self.eye()).dot(self.forward());
        let away = (center - self.eye()).length();
        let reach = radius.max(1e-3).max(away);
        if self.size().is_some() {
            // Through a lens, rays begin at the camera.
            let near = if self.lens().is_some() { 0.0 } else { ahead - 32.0 * reach };
            return [near, (ahead + 32.0 * reach).max(1e-2 * reach)];
        }
        let far = (ahead + 8.0 * reach).max(8e-2 * reach);
        [(1e-4 * far).max(1e-6), HORIZON * far]
    }

    /// World space to clip space for a picture of `size` pixels, for cameras whose picture is flat.
    ///
    /// * `near`, `far`: distances along the direction that get depths 0 and 1; parallel rays may have a negative
    ///   `near`, since what is behind the camera is seen too
    pub fn projection(&self, size: [u32; 2], near: f64, far: f64) -> Option<DMat4> {
        let raster = self.raster(size);
        let aspect = f64::from(raster.aspect());
        let CameraFrame { center, right, up, forward } = *self.still.frame();
        let axes = DMat3::from_cols(right, up, forward);
        if axes.determinant() == 0.0 {
            return None;
        }
        let view = DMat4::from_mat3(axes.inverse()) * DMat4::from_translation(-center);
        let depth = 1.0 / (far - near);
        let reach = raster.reach() / DVec2::new(aspect, 1.0);
        let clip = match &self.still {
            Camera::Perspective(camera) => {
                let sense = self.sense();
                let across = sense * camera.distance() * reach;
                DMat4::from_cols(
                    across.x * DVec4::X,
                    across.y * DVec4::Y,
                    sense * DVec4::new(0.0, 0.0, far * depth, 1.0),
                    -far * near * depth * DVec4::Z,
                )
            }
            Camera::Orthographic(camera) => {
                let across = 2.0 / camera.size * reach;
                DMat4::from_cols(
                    across.x * DVec4::X,
                    across.y * DVec4::Y,
                    depth * DVec4::Z,
                    DVec4::new(0.0, 0.0, -near * depth, 1.0),
                )
            }
            _ => return None,
        };
        Some(clip * view)
    }

    /// A camera with a flat picture that stands and looks the same: itself, or a wide one in place of those that
    /// see all around.
    pub fn flat(&self) -> CameraPose {
        match self.still {
            Camera::Perspective(_) | Camera::Orthographic(_) => self.clone(),
            _ => {
                let frame = *self.still.frame();
                let wide = Camera::Perspective(PerspectiveCamera::new(frame, 90f64.to_radians()));
                CameraPose { camera: wide.clone(), still: wide, ..*self }
            }
        }
    }

    /// Where the world-space point `p` appears in a picture of `size` pixels, counted from its top left corner;
    /// beyond its edges too. `None` where the camera does not see that way, or sees everything twice.
    pub fn project(&self, p: DVec3, size: [u32; 2]) -> Option<DVec2> {
        let raster = self.raster(size);
        Some(raster.film_position(self.still.project(p, raster.aspect().into(), 0.0)?))
    }

    /// All places where the world-space point `p` appears: as [`CameraPose::project`], or for two eyes that of the left
    /// one and that of the right one.
    pub fn projections(&self, p: DVec3, size: [u32; 2]) -> [Option<DVec2>; 2] {
        let raster = self.raster(size);
        self.still.projections(p, raster.aspect().into(), 0.0).map(|at| Some(raster.film_position(at?)))
    }

    /// The ray through a place of a picture of `size` pixels, from the middle of the lens.
    pub fn ray(&self, position: DVec2, size: [u32; 2]) -> Option<Ray> {
        let raster = self.raster(size);
        self.still.ray(raster.picture(position.as_vec2()), raster.aspect(), Vec2::splat(0.5), 0.0)
    }

    /// The place in a picture of another size where the camera looks the way it does at `position` in one of size `of`.
    ///
    /// Pictures of another shape show more or less at their sides. For two eyes, and where the camera sees nothing, it is
    /// the same share of the picture.
    pub fn position_in(&self, position: DVec2, of: [u32; 2], to: [u32; 2]) -> DVec2 {
        if of == to {
            return position;
        }
        let pixels = |size: [u32; 2]| DVec2::new(size[0].max(1).into(), size[1].max(1).into());
        let ray = self.ray(position, of);
        let seen = ray.and_then(|ray| self.project(ray.o.as_dvec3() + ray.d.as_dvec3(), to));
        seen.unwrap_or(position * pixels(to) / pixels(of))
    }

    /// Whether another camera stands there, looks the same way and sees as much.
    pub fn is_view_of(&self, other: &CameraPose) -> bool {
        let of = |pose: &CameraPose| {
            (pose.eye(), pose.forward(), pose.up(), pose.angle(), pose.size(), pose.keyword())
        };
        of(self) == of(other)
    }

    fn raster(&self, size: [u32; 2]) -> Raster {
        let spans_width = self.spans_width && self.still.has_extent();
        Raster { size, corner_samples: self.corner_samples, spans_width }
    }

    fn set_frame(&mut self, frame: CameraFrame) {
        self.set(self.still.clone().with_frame(frame));
    }

    fn set(&mut self, camera: Camera) {
        self.still = camera.clone();
        self.camera = camera;
    }

    /// A unit direction, turned around the level axis and then up.
    fn turned(&self, forward: DVec3, right: f64, up: f64) -> DVec3 {
        let around = rotation(self.level, -right) * forward;
        let across = around.cross(self.level);
        let Some(across) = across.try_normalize() else { return around };
        let tilted = rotation(across, up) * around;
        // Past the zenith the picture would turn over.
        let steep = tilted.dot(self.level).abs() > STEEPEST || tilted.cross(self.level).dot(across) < 0.0;
        if steep { around } else { tilted.normalize_or(forward) }
    }
}

/// A camera as it is at the opening of the shutter.
fn still(camera: &Camera) -> Camera {
    let Camera::Moving(moving) = camera else { return camera.clone() };
    let map = moving.map.map_at(0.0);
    let CameraFrame { center, right, up, forward } = *moving.camera.frame();
    let [right, up, forward] = [right, up, forward].map(|axis| map.transform_vector3(axis));
    moving.camera.clone().with_frame(CameraFrame { center: map.transform_point3(center), right, up, forward })
}

/// The turn by `angle` around a unit axis.
fn rotation(axis: DVec3, angle: f64) -> DQuat {
    let v = fmath::sin64(0.5 * angle) * axis;
    DQuat::from_xyzw(v.x, v.y, v.z, fmath::cos64(0.5 * angle))
}

/// The coordinate axis that a vector is nearest to, with its sign; y for none.
fn nearest_axis(v: DVec3) -> DVec3 {
    let size = v.abs();
    if size.y >= size.x && size.y >= size.z {
        if v.y < 0.0 { DVec3::NEG_Y } else { DVec3::Y }
    } else if size.z >= size.x {
        DVec3::Z * v.z.signum()
    } else {
        DVec3::X * v.x.signum()
    }
}

#[cfg(test)]
mod tests;
