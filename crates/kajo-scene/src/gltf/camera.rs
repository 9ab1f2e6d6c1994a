//! Cameras of glTF. A camera stands where its node does, looks along the negative z axis of it, and has y upwards.

use kajo_math::{DAffine3, DVec3};
use serde::Deserialize;
use std::sync::Arc;

/// A camera at its place, in the model's space.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelCamera {
    /// The name of the node, or else of the camera.
    pub name: Option<Arc<str>>,
    /// Where it stands.
    pub center: DVec3,
    /// Unit direction in which it looks.
    pub direction: DVec3,
    /// Unit direction that is up in its picture, at right angles to the other one unless nodes are skewed.
    pub up: DVec3,
    /// How much it sees.
    pub view: ModelView,
}

/// How much a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelView {
    /// Through a point: the full vertical angle of view in radians, between 0 and π.
    Perspective {
        /// The angle.
        angle: f64,
    },
    /// Along parallel rays: the full height of what it sees, in units of the model.
    Orthographic {
        /// The height.
        height: f64,
    },
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Camera {
    name: Option<Arc<str>>,
    perspective: Option<Perspective>,
    orthographic: Option<Orthographic>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Perspective {
    yfov: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Orthographic {
    ymag: f64,
}

impl Camera {
    /// The camera at its place, if it sees anything.
    ///
    /// * `node_name`: the name of its node, which goes before its own
    /// * `transform`: from the node's space to the model's
    pub(super) fn placed(&self, node_name: Option<&Arc<str>>, transform: &DAffine3) -> Option<ModelCamera> {
        let view = match (&self.perspective, &self.orthographic) {
            (Some(Perspective { yfov }), _) => {
                let sees = *yfov > 0.0 && *yfov < std::f64::consts::PI;
                sees.then_some(ModelView::Perspective { angle: *yfov })
            }
            (None, Some(Orthographic { ymag })) => {
                let height = 2.0 * ymag.abs();
                (height > 0.0 && height.is_finite()).then_some(ModelView::Orthographic { height })
            }
            (None, None) => None,
        };
        let name = node_name.or(self.name.as_ref()).filter(|name| !name.is_empty());
        let axis = |v: DVec3| transform.transform_vector3(v).try_normalize();
        let poses = axis(DVec3::NEG_Z).zip(axis(DVec3::Y)).filter(|_| transform.translation.is_finite());
        view.zip(poses).map(|(view, (direction, up))| ModelCamera {
            name: name.cloned(),
            center: transform.translation,
            direction,
            up,
            view,
        })
    }
}
