//! Media that bend light.

/// The answers of a medium that bends light and does nothing else to it. It has a field `coefficients`, clear ones.
///
/// * its equation of rays in a region, by wavelengths: `|medium, region, wavelengths| equation`
macro_rules! only_bends_light {
    (|$medium:ident, $region:ident, $wavelengths:ident| $equation:expr) => {
        fn coefficients(&self) -> &crate::medium::Coefficients {
            &self.coefficients
        }

        fn density(&self, _textures: &crate::texture::Textures, _p: kajo_math::Vec3) -> f32 {
            0.0
        }

        fn bounds(&self) -> Option<kajo_math::Aabb> {
            None
        }

        fn majorants(&self, ray: &kajo_math::Ray) -> crate::medium::Majorants<'_> {
            let nothing = crate::medium::Majorant { t_min: 0.0, t_max: ray.t_max, density: 0.0, least: 0.0 };
            crate::medium::Majorants::one(nothing)
        }

        fn bends_light(&self) -> bool {
            true
        }

        fn follow<C: crate::curved_light::Chords>(
            &self,
            ray: &kajo_math::Ray,
            around: Option<&crate::differential::RayDifferential>,
            $region: &crate::curved_light::Region,
            $wavelengths: &kajo_color::Wavelengths,
            chords: &mut C,
        ) -> Option<crate::curved_light::Followed> {
            let $medium = self;
            Some(crate::curved_light::follow(&$equation, ray, around, $region, chords))
        }

        fn conserved(
            &self,
            ends: &[crate::curved_light::RayState; 2],
            $region: &crate::curved_light::Region,
            $wavelengths: &kajo_color::Wavelengths,
        ) -> [Option<crate::curved_light::ConservedQuantity>; 3] {
            let $medium = self;
            crate::curved_light::ConservedQuantity::of(&$equation, ends)
        }
    };
}

pub(super) use only_bends_light;
