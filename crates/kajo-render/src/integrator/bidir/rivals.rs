//! The other ways to find a path, and what they leave to this one.
//!
//! A path `x0 x1 .. xn` from a light to the lens can be found in several ways: `s` of its points are drawn from the light
//! and the others from the camera. With the density `p_s` of each way it counts with the weight
//!
//! ```text
//! w_s = p_s^2 / sum over j of p_j^2                               [Veach 1997, 9.2]
//! ```
//!
//! Two ways that differ in who drew `xi` differ by the factor `p>(xi) / p<(xi)`, the densities per area of drawing it
//! from the side of the light and from that of the camera. So the sums over the ways on both sides of a
//! connection grow with the paths. For the end `xi` of a path from the light,
//!
//! ```text
//! sum over j < s of (p_j / p_s)^2  =  p<(xi)^2 (last + b^2 earlier)                  i = s - 1
//!
//! last     = 1 / p>(xi)^2                                        connected before xi
//! earlier  = g^2 / p>(xi)^2 (last' + b'^2 earlier')              connected before the point before xi
//! ```
//!
//! where `b` is the density per solid angle at `xi` of going on to the point before, known only when the path is
//! connected, and `g = cos / d^2` makes it one per area there. The same holds from the camera. The scheme is that of
//! [Georgiev 2012]. Single directions cannot be met by a connection: their `last` is zero.

/// The sums of one end of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rivals {
    /// Connections of the end with the point before it.
    pub last: f64,
    /// Connections farther back.
    pub earlier: f64,
}

/// One more point of a path.
#[derive(Clone, Copy, Debug)]
pub struct Growth {
    /// Density of the new point per area.
    pub pdf: f32,
    /// `cos / d^2` at the point before.
    pub spread: f32,
    /// Density per solid angle at the point before of going back from the new one.
    pub back: f32,
    /// Whether both points can be connected.
    pub joins: bool,
}

impl Rivals {
    /// The sums at the next point of the path.
    pub fn grown(&self, by: Growth) -> Rivals {
        let once = square(by.pdf).recip();
        let earlier = square(by.spread) * once * self.sum(1.0, by.back);
        Rivals { last: if by.joins { once } else { 0.0 }, earlier }
    }

    /// The squared densities of all ways on this side, over that of the connection.
    ///
    /// * `arriving`: density per area with which the other side draws the end
    /// * `back`: density per solid angle with which it goes on to the point before
    pub fn sum(&self, arriving: f32, back: f32) -> f64 {
        square(arriving) * (self.last + square(back) * self.earlier)
    }

    /// The same without connections of the end itself.
    pub fn without_last(self) -> Rivals {
        Rivals { last: 0.0, ..self }
    }
}

/// The weight of a way whose rivals have these sums.
pub fn weight(light_side: f64, camera_side: f64) -> f32 {
    let weight = (1.0 / (1.0 + light_side + camera_side)) as f32;
    // Densities beyond all numbers belong to ways that find the path for certain.
    if weight.is_nan() { 0.0 } else { weight }
}

/// In double precision, where products of many squares do not overflow.
pub fn square(x: f32) -> f64 {
    f64::from(x) * f64::from(x)
}
