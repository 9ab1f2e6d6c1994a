//! Which bodies a path is inside of.
//!
//! Where bodies overlap, as glass and the liquid in it do, the one of the highest priority is there, and a surface
//! inside a body of higher priority than its own is not: light passes it as if it were nothing
//! [Schmidt and Budge 2002]. Of bodies of equal priority the one entered last is there.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::material::Interior;
use kajo_core::scene::Scene;
use kajo_math::Ray;

/// More bodies than this around one point are forgotten, the outermost first.
const MOST: usize = 8;

/// The bodies around a point of a path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bodies {
    /// Objects and what fills them, in the order in which they were entered.
    list: [Option<(u32, Interior)>; MOST],
    len: usize,
}

/// How a path meets the surface of a body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    object: u32,
    interior: Interior,
    enters: bool,
    /// Index of refraction outside the surface.
    pub eta_outside: f32,
    /// Whether the surface is there at all.
    pub is_real: bool,
}

impl Boundary {
    /// Whether refraction depends on the wavelength.
    pub fn is_dispersive(&self) -> bool {
        self.interior.is_dispersive
    }
}

impl Bodies {
    /// The bodies around the start of a ray: those that it leaves more often than it enters them.
    pub fn around(scene: &Scene, ray: &Ray, wavelengths: &Wavelengths) -> Bodies {
        // Parallel rays of a camera without a place come from infinitely far behind it.
        if !scene.transmits || ray.t_min < 0.0 {
            return Bodies::default();
        }
        let mut met: [Option<(u32, Interior, i32, f32)>; MOST] = [None; MOST];
        scene.crossings(ray, |primitive, hit| {
            let at = scene.interaction(ray, primitive, hit);
            let Some(interior) = scene.interior(&at, wavelengths, 0.5) else { return };
            let Some(body) = met.iter_mut().find(|body| body.is_none_or(|body| body.0 == primitive)) else {
                return;
            };
            let (_, _, exits, farthest) = body.get_or_insert((primitive, interior, 0, 0.0));
            *exits += if ray.d.dot(at.point.ng) > 0.0 { 1 } else { -1 };
            *farthest = farthest.max(hit.t);
        });
        let mut around = Bodies::default();
        // The one that ends last was entered first.
        met.sort_by(|a, b| b.map_or(0.0, |b| b.3).total_cmp(&a.map_or(0.0, |a| a.3)));
        for (primitive, interior, exits, _) in met.into_iter().flatten() {
            if exits > 0 {
                around = around.with(primitive, interior);
            }
        }
        around
    }

    /// What is around the point.
    fn top(&self) -> Option<Interior> {
        let bodies = self.list[..self.len].iter().flatten().map(|body| body.1);
        bodies.fold(None, |top: Option<Interior>, body| match top {
            Some(top) if top.priority > body.priority => Some(top),
            _ => Some(body),
        })
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The share of light that is left after a distance around the point.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> Spectrum {
        match self.absorption() {
            Some(absorption) => (absorption * -distance.min(f32::MAX)).exp(),
            None => Spectrum::WHITE,
        }
    }

    /// Index of refraction around the point.
    pub fn eta(&self) -> f32 {
        if self.is_empty() {
            return 1.0;
        }
        self.top().map_or(1.0, |body| body.eta)
    }

    /// Absorption per unit length around the point.
    #[inline]
    pub fn absorption(&self) -> Option<Spectrum> {
        if self.is_empty() { None } else { self.top().map(|body| body.absorption).filter(|a| !a.is_black()) }
    }

    /// A path's meeting with the surface of `object`.
    ///
    /// * `enters`: whether it comes from outside
    pub fn meet(&self, object: u32, interior: Interior, enters: bool) -> Boundary {
        let outside = if enters { *self } else { self.without(object) };
        let around = outside.top();
        let hidden = around.is_some_and(|around| around.priority > interior.priority);
        let eta_outside = around.map_or(1.0, |around| around.eta);
        Boundary { object, interior, enters, eta_outside, is_real: !hidden }
    }

    /// The bodies beyond a surface that was passed.
    pub fn beyond(&self, boundary: &Boundary) -> Bodies {
        if boundary.enters {
            self.with(boundary.object, boundary.interior)
        } else {
            self.without(boundary.object)
        }
    }

    fn with(mut self, object: u32, interior: Interior) -> Bodies {
        if self.len == MOST {
            self.list.copy_within(1.., 0);
            self.len -= 1;
        }
        self.list[self.len] = Some((object, interior));
        self.len += 1;
        self
    }

    fn without(mut self, object: u32) -> Bodies {
        let is_it = |body: &Option<(u32, Interior)>| body.is_some_and(|body| body.0 == object);
        if let Some(i) = self.list[..self.len].iter().rposition(is_it) {
            self.list.copy_within(i + 1..self.len, i);
            self.len -= 1;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(eta: f32, priority: i32) -> Interior {
        Interior { eta, is_dispersive: false, absorption: Spectrum::grey(eta), priority }
    }

    #[test]
    fn a_liquid_that_overlaps_its_glass_shares_one_surface() {
        let (glass, water) = (body(1.5, 2), body(1.33, 1));
        let air = Bodies::default();
        assert!(air.absorption().is_none());
        let outer = air.meet(1, glass, true);
        assert!(outer.is_real && outer.eta_outside == 1.0);
        let in_glass = air.beyond(&outer);
        // The water begins inside the glass: nothing is seen of that.
        let hidden = in_glass.meet(2, water, true);
        assert!(!hidden.is_real);
        let both = in_glass.beyond(&hidden);
        assert_eq!(both.absorption(), Some(glass.absorption));
        // The inner side of the glass is where glass meets water.
        let inner = both.meet(1, glass, false);
        assert!(inner.is_real && inner.eta_outside == 1.33);
        let in_water = both.beyond(&inner);
        assert_eq!(in_water.absorption(), Some(water.absorption));
        let out = in_water.meet(2, water, false);
        assert!(out.is_real && out.eta_outside == 1.0);
        assert!(in_water.beyond(&out).absorption().is_none());
    }

    #[test]
    fn leaving_what_was_never_entered_is_leaving() {
        let inside = Bodies::default().meet(7, body(1.5, 0), false);
        assert!(inside.is_real && inside.eta_outside == 1.0);
        assert!(Bodies::default().beyond(&inside).absorption().is_none());
    }

    #[test]
    fn too_many_bodies_forget_the_outermost() {
        let mut bodies = Bodies::default();
        for i in 0..20 {
            bodies = bodies.beyond(&bodies.meet(i, body(1.0 + i as f32, 0), true));
        }
        assert_eq!(bodies.absorption(), Some(Spectrum::grey(20.0)));
        assert!(bodies.meet(19, body(20.0, 0), false).eta_outside == 19.0);
    }
}
