//! Where a camera has to stand, or how much it has to see, so that something just fits into its picture.
//!
//! What is to be seen answers one question: which of its points `p` lies farthest in a direction `n`, its support.
//! With `(a, b, s)` the coordinates of a point to the right, up and forward and `x` the tangent of half the
//! horizontal angle, the point is left of the right edge of a perspective picture taken from `(a', b', s')` where
//!
//! ```text
//! a - a' <= (s - s') x      that is      s' x - a' <= s x - a
//! ```
//!
//! so that all of them are where `s' x - a' <= min (s x - a)`, a support. Two edges opposite to each other give the largest
//! `s'` of their direction, and the `a'` in the middle; the smaller of the two largest `s'` is the position. No search is
//! needed, and the silhouette touches the edges exactly. How wide a picture from a given position has to be is the largest
//! `a / s`, found by Dinkelbach's iteration [Dinkelbach 1967]: `x <- a/s` of the point with the largest `a - x s`.
//!
//! A fisheye sees the ball around the box of the points, which fills its disk.

use kajo_math::{DMat3, DVec3};

use super::{Camera, CameraFrame};

/// How near a camera comes to what it fits into its picture, as a share of its diameter.
const NEAREST: f64 = 0.05;

/// The point of something that lies farthest in a direction of any length.
pub type Support<'a> = dyn Fn(DVec3) -> DVec3 + 'a;

/// What a camera may change so that something fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// Where it stands.
    Position,
    /// How far away it stands, on the line through its centre along its direction.
    Distance,
    /// How much it sees: the angle, or the height of its picture.
    Opening,
}

/// Why nothing was fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitError {
    /// A part of it is beside or behind the camera.
    Around,
    /// The camera sees all around.
    SeesAll,
    /// The angle is none that a picture can have.
    NoAngle,
    /// Its direction and what is up are the same.
    NoAxes,
}

/// How something is to fill the picture.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// What the camera may change.
    pub freedom: Freedom,
    /// Width of the picture over its height.
    pub aspect: f64,
    /// The share of the picture that stays free at each edge, in [0, 0.5).
    pub margin: f64,
}

impl Fit {
    /// The camera with what is free chosen such that what `support` describes fits.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn apply(&self, camera: &Camera, support: &Support<'_>) -> Result<Camera, FitError> {
        let space = FitSpace::of(camera.frame(), support).ok_or(FitError::NoAxes)?;
        let inside = 1.0 - 2.0 * self.margin;
        match camera {
            Camera::Moving(moving) => self.apply(&moving.camera, support),
            still => still.model().fitted(self, &space, inside),
        }
    }

    /// The position of a perspective camera.
    ///
    /// * `tangents`: of half the horizontal and vertical angle
    pub(super) fn eye(&self, space: &FitSpace<'_>, tangents: [f64; 2]) -> DVec3 {
        let here = space.coordinates(space.center);
        // What points at the camera, or is seen edge on, would be met by its tip.
        let mut forward = space.least(DVec3::Z) - NEAREST * space.diameter();
        let mut across = [here.x, here.y];
        for (axis, (unit, x)) in [DVec3::X, DVec3::Y].into_iter().zip(tangents).enumerate() {
            let right = space.least(x * DVec3::Z - unit);
            let left = space.least(x * DVec3::Z + unit);
            match self.freedom {
                Freedom::Distance => {
                    let at = across[axis];
                    forward = forward.min((right + at) / x).min((left - at) / x);
                }
                _ => {
                    forward = forward.min(0.5 * (right + left) / x);
                    across[axis] = 0.5 * (left - right);
                }
            }
        }
        space.point(DVec3::new(across[0], across[1], forward))
    }
}

/// The direction from `center` in which a perspective picture shows something in its middle.
///
/// `None` where no picture from there holds it.
pub fn centred(center: DVec3, up: DVec3, support: &Support<'_>) -> Option<DVec3> {
    let [x, y, z] =
        [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| 0.5 * (support(axis) + support(-axis)).dot(axis));
    let mut forward = (DVec3::new(x, y, z) - center).try_normalize()?;
    // The middle in the picture is not that of the box: what is near counts for more.
    for _ in 0..4 {
        let frame = CameraFrame::new(center, forward, up);
        let space = FitSpace::of(&frame, support)?;
        let [right, top, left, bottom] = space.tangents()?;
        let way = frame.forward + 0.5 * (right - left) * frame.right + 0.5 * (top - bottom) * frame.up;
        forward = way.try_normalize()?;
    }
    Some(forward)
}

/// What is to be seen in the coordinates of a camera.
pub(super) struct FitSpace<'a> {
    center: DVec3,
    /// The camera's axes.
    axes: DMat3,
    /// Its inverse.
    rows: DMat3,
    support: &'a Support<'a>,
}

impl<'a> FitSpace<'a> {
    fn of(frame: &CameraFrame, support: &'a Support<'a>) -> Option<FitSpace<'a>> {
        let axes = DMat3::from_cols(frame.right, frame.up, frame.forward);
        let rows = axes.inverse();
        (axes.determinant() != 0.0).then_some(FitSpace { center: frame.center, axes, rows, support })
    }

    /// A point by right, up and forward, counted from the origin.
    pub fn coordinates(&self, p: DVec3) -> DVec3 {
        self.rows * p
    }

    pub fn point(&self, coordinates: DVec3) -> DVec3 {
        self.axes * coordinates
    }

    /// The point for which a combination of coordinates is largest.
    fn farthest(&self, combination: DVec3) -> DVec3 {
        self.coordinates((self.support)(self.rows.transpose() * combination))
    }

    /// The least value of a combination of coordinates.
    pub fn least(&self, combination: DVec3) -> f64 {
        combination.dot(self.farthest(-combination))
    }

    fn extent(&self) -> [DVec3; 2] {
        let low = DVec3::new(self.least(DVec3::X), self.least(DVec3::Y), self.least(DVec3::Z));
        let high = -DVec3::new(self.least(-DVec3::X), self.least(-DVec3::Y), self.least(-DVec3::Z));
        [low, high]
    }

    /// The diagonal of the box along the axes; 1 for a point.
    pub fn diameter(&self) -> f64 {
        let [low, high] = self.extent();
        let diameter = low.distance(high);
        if diameter > 0.0 { diameter } else { 1.0 }
    }

    pub fn radius(&self) -> f64 {
        0.5 * self.diameter()
    }

    pub fn middle(&self) -> DVec3 {
        let [low, high] = self.extent();
        self.point(0.5 * (low + high))
    }

    /// The tangents of the angles from forward to the farthest points to the right, up, left and down; `None` unless all
    /// points are ahead.
    fn tangents(&self) -> Option<[f64; 4]> {
        let here = self.coordinates(self.center);
        if self.least(DVec3::Z) - here.z <= 0.0 {
            return None;
        }
        Some([DVec3::X, DVec3::Y, -DVec3::X, -DVec3::Y].map(|side| {
            let of = |p: DVec3| (p - here).dot(side) / (p.z - here.z);
            let mut tangent = of(self.farthest(side));
            // Each step is larger than the one before, and there are few.
            for _ in 0..64 {
                let next = of(self.farthest(side - tangent * DVec3::Z));
                if next <= tangent {
                    break;
                }
                tangent = next;
            }
            tangent
        }))
    }

    /// The tangent of half the vertical angle that holds all; `None` unless all points are ahead.
    pub fn widest(&self, aspect: f64) -> Option<f64> {
        let [right, top, left, bottom] = self.tangents()?;
        Some(top.max(bottom).max(right.max(left) / aspect).max(1e-6))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{FisheyeCamera, FisheyeProjection, OrthographicCamera, PerspectiveCamera};
    use kajo_math::rng::Stream;

    fn points(i: u32) -> Vec<DVec3> {
        let s = Stream::new(11, [i, 0], 0);
        let scale = 10f64.powi(i as i32 % 7 - 3);
        let point = |k: u32| DVec3::from([0, 1, 2].map(|c| f64::from(s.uniform(3 * k + c)))) * scale;
        (0..20).map(|k| point(k) + DVec3::new(3.0, -2.0, 5.0)).collect()
    }

    fn farthest(points: &[DVec3], n: DVec3) -> DVec3 {
        points.iter().copied().max_by(|a, b| a.dot(n).total_cmp(&b.dot(n))).unwrap()
    }

    fn frame(i: u32) -> CameraFrame {
        let s = Stream::new(5, [i, 0], 0);
        let v = |k: u32| DVec3::from([0, 1, 2].map(|c| 2.0 * f64::from(s.uniform(k + c)) - 1.0));
        CameraFrame::new(v(0), v(3), v(6))
    }

    /// How far out the points reach in the picture, to the sides and up and down.
    fn reach(camera: &Camera, points: &[DVec3], aspect: f64) -> [f64; 2] {
        let at = |p: &DVec3| camera.project(*p, aspect, 0.0).expect("ahead");
        let reach = |axis: usize| points.iter().map(|p| at(p)[axis].abs()).fold(0.0, f64::max);
        [reach(0), reach(1)]
    }

    #[test]
    fn everything_is_seen_and_touches_the_margin() {
        let mut touched = 0;
        for i in 0..60 {
            let (points, frame) = (points(i), frame(i));
            let support = |n: DVec3| farthest(&points, n);
            for (aspect, margin) in [(1.5, 0.05), (0.4, 0.0), (4.0, 0.2)] {
                let cameras = [
                    Camera::Perspective(PerspectiveCamera::new(frame, 0.7)),
                    Camera::Perspective(PerspectiveCamera::new(
                        frame.with_raw_up(frame.up + 0.2 * frame.right),
                        1.5,
                    )),
                    Camera::Orthographic(OrthographicCamera { frame, size: 2.0, lens: None }),
                ];
                for camera in cameras {
                    let fit = Fit { freedom: Freedom::Position, aspect, margin };
                    let fitted = fit.apply(&camera, &support).unwrap();
                    let [x, y] = reach(&fitted, &points, aspect);
                    let inside = 1.0 - 2.0 * margin;
                    let ahead = |p: &DVec3| (p - fitted.frame().center).dot(frame.forward);
                    let nearest = points.iter().map(ahead).fold(f64::INFINITY, f64::min);
                    // The points lie in a cube of this side; no camera comes nearer than a part of it.
                    let is_near = nearest < 0.15 * 10f64.powi(i as i32 % 7 - 3);
                    assert!(x.max(y) < inside + 1e-9, "{i} {aspect}: {x} {y}");
                    assert!(is_near || x.max(y) > inside - 1e-9, "{i} {aspect}: {x} {y}");
                    touched += usize::from(!is_near);
                    assert_eq!(fitted.frame().forward, frame.forward);
                }
            }
        }
        assert!(touched > 400, "{touched}");
    }

    #[test]
    fn from_a_place_the_angle_is_what_fits() {
        for i in 0..60 {
            let points = points(i);
            let support = |n: DVec3| farthest(&points, n);
            let scale = 10f64.powi(i as i32 % 7 - 3);
            let center = DVec3::new(3.0, -2.0, 5.0) + scale * DVec3::new(-2.0, 1.0, 4.0);
            let forward = centred(center, DVec3::Y, &support).unwrap();
            let camera =
                Camera::Perspective(PerspectiveCamera::new(CameraFrame::new(center, forward, DVec3::Y), 1.0));
            let fit = Fit { freedom: Freedom::Opening, aspect: 1.3, margin: 0.1 };
            let fitted = fit.apply(&camera, &support).unwrap();
            let [x, y] = reach(&fitted, &points, 1.3);
            assert!((x.max(y) - 0.8).abs() < 1e-9, "{x} {y}");
            // Both edges are as far away.
            let across: Vec<f64> = points.iter().map(|p| fitted.project(*p, 1.3, 0.0).unwrap().y).collect();
            let [low, high] =
                [across.iter().copied().fold(1.0, f64::min), across.iter().copied().fold(-1.0, f64::max)];
            assert!((low + high).abs() < 5e-3, "{low} {high}");
        }
    }

    #[test]
    fn along_the_line_of_sight_the_target_stays_in_the_middle() {
        let points = points(3);
        let support = |n: DVec3| farthest(&points, n);
        let target = points[4];
        let forward = DVec3::new(-1.0, -0.5, -2.0);
        let camera = PerspectiveCamera::new(CameraFrame::new(target, forward, DVec3::Y), 0.8);
        let fit = Fit { freedom: Freedom::Distance, aspect: 1.0, margin: 0.05 };
        let fitted = fit.apply(&Camera::Perspective(camera), &support).unwrap();
        assert!(fitted.project(target, 1.0, 0.0).unwrap().length() < 1e-9);
        let [x, y] = reach(&fitted, &points, 1.0);
        assert!((x.max(y) - 0.9).abs() < 1e-9);
    }

    #[test]
    fn a_fisheye_holds_all_and_what_sees_all_refuses() {
        let (points, frame) = (points(3), frame(2));
        let support = |n: DVec3| farthest(&points, n);
        for (to_corners, aspect) in [(false, 1.0), (false, 0.5), (true, 1.5)] {
            for angle in [1.0, 3.1] {
                let projection = FisheyeProjection::Equisolid;
                let camera = Camera::Fisheye(FisheyeCamera { frame, angle, projection, to_corners });
                let fit = Fit { freedom: Freedom::Position, aspect, margin: 0.05 };
                let [x, y] = reach(&fit.apply(&camera, &support).unwrap(), &points, aspect);
                assert!(x.max(y) < 0.95, "{x} {y}");
            }
        }
        let fit = Fit { freedom: Freedom::Opening, aspect: 1.0, margin: 0.0 };
        let all = Camera::Panorama(crate::camera::PanoramaCamera { frame, eyes: None });
        assert_eq!(fit.apply(&all, &support).unwrap_err(), FitError::SeesAll);
        let within = CameraFrame::new(points[0], DVec3::Z, DVec3::Y);
        let within = Camera::Perspective(PerspectiveCamera::new(within, 1.0));
        assert_eq!(fit.apply(&within, &support).unwrap_err(), FitError::Around);
    }

    #[test]
    fn a_point_can_be_looked_at() {
        let p = DVec3::new(1.0, 2.0, 3.0);
        let support = |_: DVec3| p;
        for camera in [
            Camera::Perspective(PerspectiveCamera::new(frame(1), 0.7)),
            Camera::Orthographic(OrthographicCamera { frame: frame(1), size: 2.0, lens: None }),
        ] {
            let fitted =
                Fit { freedom: Freedom::Position, aspect: 1.0, margin: 0.05 }.apply(&camera, &support);
            let at = fitted.unwrap().project(p, 1.0, 0.0).expect("ahead");
            assert!(at.length() < 1e-9);
        }
    }
}
