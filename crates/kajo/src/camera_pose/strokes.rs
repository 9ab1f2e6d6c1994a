//! Straight lines of the world in the picture of any camera.
//!
//! Where the picture is not flat they are curves, and at the edges of panoramas and cube faces they are torn. A line is
//! halved until its halves are short in the picture; halves that stay long are the tears.

use kajo_math::{DVec2, DVec3};

use super::CameraPose;

/// Pixels of a stroke, at most, in a picture that is not flat.
const LONGEST: f64 = 12.0;

/// How often a line is halved: at least, so that nothing of it is overlooked, and at most.
const HALVINGS: [u32; 2] = [3, 10];

/// A share of the picture's shorter side; longer strokes are tears.
const TEAR: f64 = 0.2;

/// A piece of a line in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its ends, in pixels from the top left corner.
    pub ends: [DVec2; 2],
    /// Its middle, in world space.
    pub middle: DVec3,
}

impl CameraPose {
    /// The line between two points of the world in a picture of `size` pixels; for two eyes in both of their pictures.
    pub fn strokes(&self, from: DVec3, to: DVec3, size: [u32; 2]) -> Vec<Stroke> {
        let mut strokes = Vec::new();
        for eye in [0, 1] {
            let line = Line { pose: self, from, to, size, eye };
            let ends = [line.projection(0.0), line.projection(1.0)];
            if let ([Some(a), Some(b)], true) = (ends, self.is_flat()) {
                strokes.push(Stroke { ends: [a, b], middle: 0.5 * (from + to) });
            } else if eye == 0 || self.camera().cells() != [1, 1] {
                line.halve([0.0, 1.0], ends, 0, &mut strokes);
            }
        }
        strokes
    }
}

/// A line of the world as an eye sees it.
struct Line<'a> {
    pose: &'a CameraPose,
    from: DVec3,
    to: DVec3,
    size: [u32; 2],
    eye: usize,
}

impl Line<'_> {
    fn at(&self, t: f64) -> DVec3 {
        self.from.lerp(self.to, t)
    }

    fn projection(&self, t: f64) -> Option<DVec2> {
        self.pose.projections(self.at(t), self.size)[self.eye]
    }

    /// Adds the strokes of the line between `t[0]` and `t[1]`, which was halved that often.
    fn halve(&self, t: [f64; 2], places: [Option<DVec2>; 2], halvings: u32, strokes: &mut Vec<Stroke>) {
        let [least, most] = HALVINGS;
        let middle = 0.5 * (t[0] + t[1]);
        if halvings >= least {
            match places {
                [None, None] => return,
                [Some(a), Some(b)] => {
                    let length = a.distance(b);
                    let torn = TEAR * f64::from(self.size[0].min(self.size[1]));
                    if length <= LONGEST || halvings == most && length < torn {
                        strokes.push(Stroke { ends: [a, b], middle: self.at(middle) });
                        return;
                    }
                }
                _ => {}
            }
            if halvings == most {
                return;
            }
        }
        let [a, b] = places;
        let between = self.projection(middle);
        self.halve([t[0], middle], [a, between], halvings + 1, strokes);
        self.halve([middle, t[1]], [between, b], halvings + 1, strokes);
    }
}

#[cfg(test)]
mod tests {
    use kajo_core::camera::{Camera, CameraFrame, EyePair, PanoramaCamera};

    use super::*;

    const SIZE: [u32; 2] = [400, 200];

    fn panorama(eyes: Option<EyePair>) -> CameraPose {
        let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
        CameraPose::new(Camera::Panorama(PanoramaCamera { frame, eyes }), DVec3::Y)
    }

    fn is_in_picture(stroke: &Stroke) -> bool {
        stroke.ends.iter().all(|p| (0.0..=400.0).contains(&p.x) && (0.0..=200.0).contains(&p.y))
    }

    #[test]
    fn a_line_before_a_flat_camera_is_one_stroke() {
        let pose = CameraPose::perspective(DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO, DVec3::Y, 0.7);
        let (a, b) = (DVec3::NEG_X, DVec3::X);
        let strokes = pose.strokes(a, b, SIZE);
        let [Stroke { ends, .. }] = strokes[..] else { panic!("{strokes:?}") };
        assert_eq!(ends.map(Some), [a, b].map(|p| pose.project(p, SIZE)));
        // What is behind the camera is left out, and the rest is there.
        let strokes = pose.strokes(DVec3::X, DVec3::new(1.0, 0.0, 20.0), SIZE);
        assert!(strokes.len() > 3 && strokes.iter().all(|stroke| stroke.middle.z < 9.0), "{strokes:?}");
    }

    #[test]
    fn a_line_around_a_panorama_is_torn_at_its_edge() {
        let pose = panorama(None);
        let strokes = pose.strokes(DVec3::new(3.0, 1.0, 2.0), DVec3::new(-3.0, 1.0, 2.0), SIZE);
        assert!(strokes.iter().all(is_in_picture));
        let length: f64 = strokes.iter().map(|stroke| stroke.ends[0].distance(stroke.ends[1])).sum();
        // The line goes around behind the camera, over 2 atan(3/2) of the circle.
        let expected = 400.0 * 2.0 * 1.5f64.atan() / std::f64::consts::TAU;
        assert!((length / expected - 1.0).abs() < 0.1, "{length} {expected}");
        assert!(strokes.iter().all(|stroke| stroke.ends[0].distance(stroke.ends[1]) < 20.0));
    }

    #[test]
    fn two_eyes_see_a_line_twice() {
        let pose = panorama(Some(EyePair { separation: 0.1 }));
        let strokes = pose.strokes(DVec3::new(-1.0, 0.5, -3.0), DVec3::new(1.0, 0.5, -3.0), SIZE);
        let upper = strokes.iter().filter(|stroke| stroke.ends[0].y < 100.0).count();
        assert!(upper > 3 && strokes.len() - upper > 3, "{upper} of {}", strokes.len());
    }
}
