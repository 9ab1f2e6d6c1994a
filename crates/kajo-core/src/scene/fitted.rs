//! A camera that was fitted into a picture of one shape, to be fitted into one of another.

use std::ops::Range;

use kajo_math::DVec3;

use super::{Extent, Scene};
use crate::camera::fit::{Fit, FitError};
use crate::camera::{Camera, MovingCamera, OrthographicCamera};
use crate::motion::MovingTransform;
use crate::objects::Object;

/// Which objects fill a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fitted {
    /// All of them.
    All,
    /// Those of a name, and those that blocks of this name place.
    Named {
        /// The name.
        name: String,
        /// Numbers of the items in such blocks.
        items: Vec<Range<u32>>,
    },
}

impl Fitted {
    fn holds(&self, object: &Object<'_>) -> bool {
        match self {
            Fitted::All => true,
            Fitted::Named { name, items } => {
                object.name == Some(&**name) || items.iter().any(|range| range.contains(&object.placed_by))
            }
        }
    }
}

/// What a camera is to show, and what it may change for that.
#[derive(Clone, Debug)]
pub struct FittedCamera {
    /// The camera as it is written, with any value for what is free.
    pub written: Camera,
    /// What it may change, and the margin.
    pub fit: Fit,
    /// What fills its picture.
    pub objects: Fitted,
    /// Whether a picture of parallel rays keeps its size, and only the camera goes to another place.
    pub keeps_size: bool,
    /// The point that its lens makes sharp, where that is no distance.
    pub focus: Option<DVec3>,
    /// How it moves while the shutter is open.
    pub motion: Option<MovingTransform>,
}

impl FittedCamera {
    /// The camera in a picture of the shape that `fit` has, without focus and motion.
    ///
    /// # Errors
    /// [`FitError`].
    pub fn framed(&self, extent: &Extent<'_>) -> Result<Camera, FitError> {
        let fitted = self.fit.apply(&self.written, &|n| extent.support(n))?;
        Ok(match (fitted, &self.written) {
            (Camera::Orthographic(fitted), Camera::Orthographic(written)) if self.keeps_size => {
                Camera::Orthographic(OrthographicCamera { size: written.size, ..fitted })
            }
            (fitted, _) => fitted,
        })
    }

    /// The whole camera; `None` where what is to be sharp is behind it.
    fn finished(&self, extent: &Extent<'_>) -> Option<Camera> {
        let mut camera = self.framed(extent).ok()?;
        if let Some(p) = self.focus {
            camera = camera.focused_on(p)?;
        }
        Some(match &self.motion {
            Some(map) => Camera::Moving(Box::new(MovingCamera { camera, map: map.clone() })),
            None => camera,
        })
    }
}

impl Scene {
    /// The scene's camera for a picture of another shape than that for which it was compiled: fitted to that, if it is one
    /// that fits something into its picture.
    ///
    /// * `aspect`: width of the picture over its height
    pub fn camera_for(&self, aspect: f64) -> Camera {
        let fitted = self.output.fitted.as_ref().filter(|fitted| fitted.fit.aspect != aspect);
        let fitted = fitted.and_then(|fitted| {
            let extent = self.geometry.extent(|object| fitted.objects.holds(object));
            FittedCamera { fit: Fit { aspect, ..fitted.fit }, ..fitted.clone() }.finished(&extent)
        });
        fitted.unwrap_or_else(|| self.output.camera.clone())
    }
}
