//! Debug rays: all that becomes of one sample, as a list and as lines in the preview.

use kajo::CameraPose;
use kajo::probe::{DebugRay, RayKind, Segment, debug_ray, pick};
use kajo_math::DVec2;

use super::{Action, Studio};
use crate::raster::Line;

/// Length of a normal, and of a ray that hits nothing, in sizes of the scene.
const NORMAL: f32 = 0.04;
const FAR: f32 = 1.5;

/// A sample whose rays are shown.
#[derive(Clone, Debug)]
pub struct Rays {
    /// The rays.
    pub ray: DebugRay,
    /// The one that is lit up.
    pub chosen: Option<usize>,
    camera: CameraPose,
    place: DVec2,
}

impl Studio {
    pub(super) fn probe_action(&mut self, action: Action) {
        match action {
            Action::Pick(place, several) => self.pick(place, several),
            Action::DebugRay(place) => self.shoot(place, self.camera.clone()),
            Action::ClearDebugRay => self.rays = None,
            Action::ChooseSegment(index) => {
                if let Some(rays) = &mut self.rays {
                    rays.chosen = index;
                }
            }
            _ => {}
        }
    }

    /// Chooses what is seen at a place of the picture. A second click on what an instance placed goes on to the
    /// shape that describes it.
    fn pick(&mut self, place: DVec2, several: bool) {
        let (Some(scene), Some(document)) = (self.scene(), &self.document) else { return };
        let seen = pick(scene, &self.camera, place, self.picture_size());
        let node = seen.as_ref().and_then(|seen| document.node_of_object(seen.object));
        let part = seen.as_ref().and_then(|seen| document.part_of_object(seen.object));
        let action = match node {
            Some(node) if several => Action::SelectToo(node),
            Some(node) if self.selection.main() == Some(node) => Action::Select(vec![part.unwrap_or(node)]),
            Some(node) => Action::Select(vec![node]),
            None if several => return,
            None => Action::Select(Vec::new()),
        };
        self.edit_action(action);
    }

    fn shoot(&mut self, place: DVec2, camera: CameraPose) {
        let Some(scene) = self.scene() else {
            self.say("Open a scene first.", false);
            return;
        };
        let Some(Ok(mut settings)) = self.settings() else { return };
        settings.size = self.picture_size();
        let ray = debug_ray(scene, &settings, &camera, place, 0);
        let text = match ray.segments.len() {
            1 => "A debug ray of 1 segment.".to_owned(),
            n => format!("A debug ray of {n} segments."),
        };
        self.rays = Some(Rays { ray, chosen: None, camera, place });
        self.say(&text, false);
    }

    /// Shoots the ray again where it was shot, after the scene has changed.
    pub(super) fn shoot_again(&mut self) {
        if let Some(Rays { camera, place, .. }) = self.rays.take() {
            let notice = self.notice.take();
            self.shoot(place, camera);
            self.notice = notice;
        }
    }

    /// The debug ray as lines: its segments, and the normals where they end.
    pub(super) fn ray_lines(&self) -> Vec<Line> {
        let Some(rays) = &self.rays else { return Vec::new() };
        let size = self.bounds().extent().length();
        let way = rays.chosen.map(|index| rays.ray.way_to(index)).unwrap_or_default();
        let segments = rays.ray.segments.iter();
        let lines = segments.clone().enumerate().map(|(index, segment)| {
            let is_chosen = way.contains(&index);
            let width = if is_chosen { 4.0 } else { 2.0 };
            let to = segment.from + segment.d * segment.distance.min(FAR * size);
            Line { from: segment.from, to, color: color(segment, is_chosen), width }
        });
        // Over the rays, which may go the same way.
        let normals = segments.filter_map(|segment| segment.hit).map(|hit| Line {
            from: hit.p,
            to: hit.p + NORMAL * size * hit.n,
            color: [255, 90, 220, 255],
            width: 2.0,
        });
        lines.chain(normals).collect()
    }
}

/// The colour of a kind of ray; of a shadow ray, whether the light arrives.
pub fn color(segment: &Segment, is_chosen: bool) -> [u8; 4] {
    let [r, g, b] = match segment.kind {
        RayKind::Camera => [255, 255, 255],
        RayKind::Reflected => [255, 205, 60],
        RayKind::Transmitted => [80, 220, 255],
        RayKind::Scattered => [120, 235, 120],
        RayKind::Lamp => [255, 170, 90],
        RayKind::Connection => [190, 150, 255],
        RayKind::Splat => [255, 130, 190],
        RayKind::Shadow if segment.contribution == [0.0; 3] => [235, 80, 70],
        RayKind::Shadow => [255, 240, 160],
    };
    [r, g, b, if is_chosen { 255 } else { 220 }]
}

/// The kind of a ray in a word.
pub fn kind_name(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Camera => "camera",
        RayKind::Reflected => "reflected",
        RayKind::Transmitted => "refracted",
        RayKind::Scattered => "scattered",
        RayKind::Shadow => "shadow",
        RayKind::Lamp => "from lamp",
        RayKind::Connection => "connection",
        RayKind::Splat => "to camera",
    }
}

impl Studio {
    /// What a segment met, and the material of that, by name where they have one.
    pub fn names_of(&self, segment: &Segment) -> (String, String) {
        let Some(hit) = segment.hit else {
            let nothing = if segment.distance.is_finite() { "light" } else { "nothing" };
            return (nothing.to_owned(), "-".to_owned());
        };
        let document = self.document.as_ref();
        let name = |node: Option<kajo::edit::NodeId>, number: u32| {
            let node = node.and_then(|id| document?.node(id));
            let named = node.map(|node| node.name.as_deref().unwrap_or(&node.keyword).to_owned());
            named.map_or_else(|| format!("#{number}"), |name| format!("{name} #{number}"))
        };
        let object = name(document.and_then(|d| d.part_of_object(hit.object)), hit.object);
        let material = name(document.and_then(|d| d.node_of_material(hit.material)), hit.material);
        (object, material)
    }
}
