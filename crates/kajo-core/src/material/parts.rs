//! Materials that are made of others and show one of these at a point.

/// The answers of such a material, which are those of the part that it shows.
///
/// Its type says which one that is, and what to ask it, by
/// `chosen(&self, &Appearance, &ShadingPoint<'a>) -> Option<(MaterialId, ShadingPoint<'a>)>`; `None` is a hole.
macro_rules! answers_of_part {
    ($($method:ident),+) => {
        fn is_mixture(&self) -> bool {
            true
        }

        $(answers_of_part!(@$method);)+
    };
    (@bsdf) => {
        fn bsdf<'a>(
            &'a self,
            appearance: &'a Appearance,
            at: &ShadingPoint<'_>,
        ) -> crate::bsdf::Bsdf<'a> {
            let of_part = |(part, at)| appearance.bsdf(part, &at);
            self.chosen(appearance, at).map_or(crate::bsdf::Bsdf::Null, of_part)
        }
    };
    (@interior) => {
        fn interior(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> Option<super::Interior> {
            let (part, at) = self.chosen(appearance, at)?;
            appearance.interior(part, &at)
        }
    };
    (@orientation) => {
        fn orientation(&self, appearance: &Appearance, at: &ShadingPoint<'_>) -> super::Orientation {
            let of_part = |(part, at)| appearance.orientation(part, &at);
            self.chosen(appearance, at).map(of_part).unwrap_or_default()
        }
    };
}

pub(super) use answers_of_part;
