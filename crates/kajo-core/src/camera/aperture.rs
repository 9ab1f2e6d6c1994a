//! The opening of a lens, which is the shape that highlights out of focus take.
//!
//! Coordinates are those of the picture, right and up, in units of the opening's radius. Points are drawn by maps
//! that keep neighbours together, so that stratified numbers give stratified points:
//!
//! * round: squares around the middle become circles [Shirley and Chiu 1997]
//! * polygon of `n` blades: a triangle between the middle and a side, then `sqrt(v) ((1-t) a + t b)` between its
//!   corners `a` and `b`; the area is `n/2 sin(2 pi / n)`
//! * picture: in proportion to its brightness [Pharr, Jakob and Humphreys 2023, appendix A.5]
//!
//! Scene: `PerspectiveCamera { ..  aperture 0.2  focus 5  blades 6  bladeRotation 15 }`

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use kajo_math::piecewise::Piecewise2D;
use kajo_math::{DVec2, Vec2, fmath, warp};

/// The shape of a lens's opening.
#[derive(Clone, Debug)]
pub enum Aperture {
    /// A disk.
    Round,
    /// A regular polygon with corners on the unit circle.
    Polygon {
        /// Number of corners, at least 3.
        blades: u32,
        /// Angle by which it is turned to the right, in radians; a corner points up when it is 0.
        rotation: f64,
    },
    /// As bright as a picture that fills the square around the unit circle.
    ///
    /// The picture's first row is on top: points of light behind the plane of focus show it upright, those before
    /// it upside down.
    Picture(Arc<Piecewise2D>),
}

impl Aperture {
    /// A point of the opening, from `u` in [0, 1)².
    pub(super) fn sample(&self, u: Vec2) -> DVec2 {
        match self {
            Aperture::Round => warp::concentric_disk(u).as_dvec2(),
            &Aperture::Polygon { blades, rotation } => {
                let side = f64::from(u.x) * f64::from(blades);
                let t = side.fract();
                let corner = |i: f64| direction(rotation + TAU * i / f64::from(blades));
                f64::from(u.y).sqrt() * corner(side.floor()).lerp(corner(side.floor() + 1.0), t)
            }
            Aperture::Picture(density) => {
                let p = density.sample(u).0.as_dvec2();
                DVec2::new(2.0 * p.x - 1.0, 1.0 - 2.0 * p.y)
            }
        }
    }

    /// The density of [`Aperture::sample`] at a point, per area.
    pub(super) fn pdf(&self, p: DVec2) -> f64 {
        match self {
            Aperture::Round => inside(p.length_squared() <= 1.0) / PI,
            &Aperture::Polygon { blades, rotation } => {
                let step = TAU / f64::from(blades);
                let within = |i: u32| {
                    p.dot(direction(rotation + step * (f64::from(i) + 0.5))) <= fmath::cos64(0.5 * step)
                };
                inside((0..blades).all(within)) * 2.0 / (f64::from(blades) * fmath::sin64(step))
            }
            Aperture::Picture(density) => {
                // The square has four units of area, the picture one.
                0.25 * f64::from(density.pdf(Vec2::new(0.5 + 0.5 * p.x as f32, 0.5 - 0.5 * p.y as f32)))
            }
        }
    }
}

/// The unit vector at an angle from up, turning to the right.
fn direction(angle: f64) -> DVec2 {
    DVec2::new(fmath::sin64(angle), fmath::cos64(angle))
}

fn inside(is: bool) -> f64 {
    if is { 1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn apertures() -> [Aperture; 5] {
        let picture = [0.0, 1.0, 1.0, 0.0, 0.2, 0.0, 0.0, 3.0, 0.0, 1.0, 1.0, 1.0];
        let picture = Piecewise2D::new(&picture, 4).expect("something to see");
        [
            Aperture::Round,
            Aperture::Polygon { blades: 3, rotation: 0.3 },
            Aperture::Polygon { blades: 6, rotation: 0.0 },
            Aperture::Polygon { blades: 9, rotation: -1.0 },
            Aperture::Picture(Arc::new(picture)),
        ]
    }

    /// The share of points in each cell of a grid over the square is the integral of the density there.
    #[test]
    fn points_follow_the_density() {
        let (cells, fine, n) = (6, 40, 1000);
        for aperture in apertures() {
            let mut found = vec![0.0; cells * cells];
            let cell = |p: DVec2| {
                let [x, y] =
                    (0.5 * (p + 1.0)).to_array().map(|c| ((c * cells as f64) as usize).min(cells - 1));
                x + cells * y
            };
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                found[cell(aperture.sample(u))] += 1.0 / (n * n) as f64;
            }
            let mut expected = vec![0.0; cells * cells];
            let m = cells * fine;
            for i in 0..m * m {
                let p = DVec2::new((i % m) as f64 + 0.5, (i / m) as f64 + 0.5) * 2.0 / m as f64 - 1.0;
                expected[cell(p)] += aperture.pdf(p) * 4.0 / (m * m) as f64;
            }
            assert!((expected.iter().sum::<f64>() - 1.0).abs() < 5e-3, "{aperture:?}");
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1.2e-3, "{aperture:?}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_corner_points_up_and_turns_to_the_right() {
        let corner = |rotation| Aperture::Polygon { blades: 5, rotation }.sample(Vec2::new(0.0, 1.0));
        assert!(corner(0.0).distance(DVec2::Y) < 1e-9);
        assert!(corner(0.5 * PI).distance(DVec2::X) < 1e-9);
    }

    #[test]
    fn the_first_row_of_a_picture_is_on_top() {
        let top_left = Piecewise2D::new(&[1.0, 0.0, 0.0, 0.0], 2).expect("something to see");
        let p = Aperture::Picture(Arc::new(top_left)).sample(Vec2::splat(0.5));
        assert!(p.distance(DVec2::new(-0.5, 0.5)) < 1e-6, "{p}");
    }
}
