//! From positions on the film, in pixels, to positions in the picture, and back.

use kajo_math::{DVec2, Vec2};

/// The pixels of a picture: raster coordinates run from (0, 0) at the top left corner to its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Whether the middles of the outermost pixels lie on the picture's edge, as one dialect has it.
    pub corner_samples: bool,
    /// Whether what the camera sees spans the picture's width, as one dialect has it, and not its height.
    pub spans_width: bool,
}

impl Raster {
    /// Width over height.
    #[inline]
    pub fn aspect(&self) -> f32 {
        let [w, h] = self.size.map(|n| n as f32);
        w / h
    }

    /// Picture coordinates at the upper edge: 1 where the camera spans the height. The rays of a picture as high as
    /// wide, drawn together or apart on both axes, are those that span the width of any other.
    #[inline]
    pub fn scale(&self) -> f32 {
        if self.spans_width { 1.0 / self.aspect() } else { 1.0 }
    }

    /// The picture coordinates of a position on the film; see [`super::Camera::ray`].
    #[inline]
    pub fn picture(&self, raster: Vec2) -> Vec2 {
        self.scale() * self.over_film(raster)
    }

    fn over_film(&self, raster: Vec2) -> Vec2 {
        let [w, h] = self.size.map(|n| n as f32);
        if self.corner_samples {
            let across = |x: f32, n: f32| if n > 1.0 { 2.0 * (x - 0.5) / (n - 1.0) - 1.0 } else { 0.0 };
            Vec2::new(across(raster.x, w), -across(raster.y, h))
        } else {
            Vec2::new(2.0 * raster.x / w - 1.0, 1.0 - 2.0 * raster.y / h)
        }
    }

    /// The position on the film of picture coordinates.
    pub fn film_position(&self, at: DVec2) -> DVec2 {
        let [w, h] = self.size.map(f64::from);
        let at = at / f64::from(self.scale());
        let [across, down] = [0.5 * (at.x + 1.0), 0.5 * (1.0 - at.y)];
        if self.corner_samples {
            DVec2::new(across * (w - 1.0) + 0.5, down * (h - 1.0) + 0.5)
        } else {
            DVec2::new(across * w, down * h)
        }
    }

    /// What picture coordinates are multiplied by to run from -1 to 1 over the whole film.
    pub fn reach(&self) -> DVec2 {
        let share =
            |n: u32| if self.corner_samples { f64::from(n - n.min(1)) / f64::from(n.max(1)) } else { 1.0 };
        DVec2::new(share(self.size[0]), share(self.size[1])) / f64::from(self.scale())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_both_ways() {
        for (corner_samples, spans_width) in [(false, false), (true, false), (false, true), (true, true)] {
            let raster = Raster { size: [40, 30], corner_samples, spans_width };
            for position in [Vec2::new(0.5, 0.5), Vec2::new(13.25, 29.0), Vec2::new(39.5, 2.0)] {
                let at = raster.picture(position).as_dvec2();
                assert!(raster.film_position(at).distance(position.as_dvec2()) < 1e-5);
                let [w, h] = [40.0, 30.0];
                let over_film =
                    DVec2::new(2.0 * f64::from(position.x) / w - 1.0, 1.0 - 2.0 * f64::from(position.y) / h);
                assert!((at * raster.reach()).distance(over_film) < 1e-6);
            }
        }
        let corners = Raster { size: [40, 30], corner_samples: true, spans_width: false };
        assert_eq!(corners.picture(Vec2::new(0.5, 0.5)), Vec2::new(-1.0, 1.0));
        let wide = Raster { size: [40, 20], corner_samples: false, spans_width: true };
        assert_eq!(wide.picture(Vec2::new(0.0, 0.0)), Vec2::new(-0.5, 0.5));
    }
}
