//! Debug rays: all that becomes of one sample, as a list and as lines in the preview.

use std::sync::Arc;

use kajo::CameraPose;
use kajo::probe::{
    DebugRay, DebugRays, LightSource, ProbeSubject, Prober, RayKind, Segment, SetupError, pick,
};
use kajo::{RenderSettings, Resources, Scene, Silent};
use kajo_edit::NodeId;
use kajo_math::DVec2;

use super::{Action, RenderOptions, Shown, Studio, Version, Wake, priority};
use crate::raster::Line;

/// Length of a normal, and of a ray that hits nothing, in sizes of the scene.
const NORMAL: f32 = 0.04;
const FAR: f32 = 1.5;

/// How far from an edge a click is still on it, in pixels.
const ON_EDGE: f64 = 3.0;

/// The colour of normals.
const NORMALS: [u8; 4] = [255, 90, 220, 255];

/// A sample whose rays are shown.
///
/// It belongs to a place of a picture of the size that the viewport had then. When panels open and the viewport has
/// another size, or when the scene is edited, it is still the sample of that place.
#[derive(Clone, Debug)]
pub struct Rays {
    /// The rays.
    pub ray: DebugRay,
    /// The one that is lit up.
    pub chosen: Option<usize>,
    /// The one whose row is under the pointer.
    pub hovered: Option<usize>,
    /// Which of the pixel's samples it is, from 0.
    pub sample: u32,
    /// How many samples the pixel has.
    pub samples: u32,
    /// Whether the rays are those of a shot before, or none, while the integrator prepares for this one.
    pub is_awaited: bool,
    shot: Shot,
}

/// Through which place of which picture a ray was shot.
#[derive(Clone, Debug)]
struct Shot {
    camera: CameraPose,
    place: DVec2,
    /// Columns and rows of the picture.
    size: [u32; 2],
}

/// What shoots the rays of integrators that prepare something before.
pub struct Probing {
    prober: Prober,
    threads: usize,
    /// What it has prepared for last.
    subject: Option<(SubjectKey, Arc<ProbeSubject>)>,
}

/// What decides what an integrator prepares.
#[derive(Clone, Debug)]
struct SubjectKey {
    scene: Version,
    options: RenderOptions,
    camera: CameraPose,
    size: [u32; 2],
}

impl SubjectKey {
    fn is_same(&self, other: &SubjectKey) -> bool {
        let of = |key: &SubjectKey| (key.scene, key.options.clone(), key.size);
        of(self) == of(other) && self.camera.is_view_of(&other.camera)
    }
}

impl Probing {
    pub fn new(threads: usize, wake: &Wake) -> Probing {
        let wake = Arc::clone(wake);
        let prober = Prober::new(threads, move || wake(), priority::give_way);
        Probing { prober, threads, subject: None }
    }

    /// Ends what is under way, and lets go of what was prepared.
    fn forget(&mut self) {
        self.prober.forget();
        self.subject = None;
    }
}

impl Rays {
    /// The pixel in the picture of that size which `camera` makes now, as its top left corner and its sides;
    /// `None` when the ray was shot from elsewhere.
    pub fn pixel(&self, camera: &CameraPose, size: [u32; 2]) -> Option<[DVec2; 2]> {
        let Shot { camera: from, place, size: of } = &self.shot;
        if !camera.is_view_of(from) {
            return None;
        }
        let inside = |place: DVec2| place.max(DVec2::ZERO).min(DVec2::new(of[0].into(), of[1].into()) - 1e-6);
        let corner = inside(*place).floor();
        let [a, b] = [corner, corner + DVec2::ONE].map(|place| camera.position_in(place, *of, size));
        Some([a, b - a])
    }

    /// The segments that are lit up, from the camera to the one chosen or pointed at.
    fn lit(&self) -> Vec<usize> {
        self.hovered.or(self.chosen).map(|index| self.ray.way_to(index)).unwrap_or_default()
    }
}

impl Studio {
    pub(super) fn probe_action(&mut self, action: Action) {
        match action {
            Action::Pick(place, several) => self.pick(place, several),
            Action::DebugRay(place) => {
                let shot = Shot { camera: self.camera.clone(), place, size: self.picture_size() };
                self.shoot(shot, 0);
                self.say_of_rays();
            }
            Action::DebugSample(sample) => {
                if let Some(Rays { shot, .. }) = &self.rays {
                    self.shoot(shot.clone(), sample);
                }
            }
            Action::ClearDebugRay => self.clear_rays(),
            Action::ChooseSegment(index) => {
                if let Some(rays) = &mut self.rays {
                    rays.chosen = index;
                }
            }
            Action::HoverSegment(index) => {
                if let Some(rays) = &mut self.rays {
                    rays.hovered = index;
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
        // Its edges are all that there is to see of what is taken away.
        let edge = (self.shown == Shown::Preview)
            .then(|| self.subtracted_at(place, self.picture_size(), ON_EDGE))
            .flatten();
        let taken = edge.and_then(|item| document.node_of_item(item));
        let node = taken.or_else(|| seen.as_ref().and_then(|seen| document.node_of_object(seen.object)));
        let part = match taken {
            Some(_) => None,
            None => seen.as_ref().and_then(|seen| document.part_of_object(seen.object)),
        };
        let action = match node {
            Some(node) if several => Action::SelectToo(node),
            Some(node) if self.selection.main() == Some(node) => Action::Select(vec![part.unwrap_or(node)]),
            Some(node) => Action::Select(vec![node]),
            None if several => return,
            None => Action::Select(Vec::new()),
        };
        self.edit_action(action);
    }

    fn shoot(&mut self, shot: Shot, sample: u32) {
        let Some(scene) = self.scene().cloned() else {
            self.say("Open a scene first.", false);
            return;
        };
        let Some(Ok(mut settings)) = self.settings() else { return };
        settings.size = shot.size;
        let samples = settings.samples.1.max(1);
        let sample = sample.min(samples - 1);
        let (ray, is_awaited) = match shot_at_once(&scene, &settings, &shot, sample) {
            Some(Ok(ray)) => {
                self.probing.forget();
                (ray, false)
            }
            Some(Err(error)) => return self.say(&error.to_string(), true),
            None => {
                let (subject, is_new) = self.subject(&scene, settings, &shot);
                self.probing.prober.shoot(&subject, shot.place, sample);
                let before = self.rays.take();
                let is_awaited = is_new || before.as_ref().is_some_and(|rays| rays.is_awaited);
                (before.map(|rays| rays.ray).unwrap_or_default(), is_awaited)
            }
        };
        self.rays = Some(Rays { ray, chosen: None, hovered: None, sample, samples, is_awaited, shot });
    }

    /// What a shot goes through, and whether nothing is prepared for that yet: that of the last one where nothing has changed.
    fn subject(
        &mut self,
        scene: &Arc<Scene>,
        settings: RenderSettings,
        shot: &Shot,
    ) -> (Arc<ProbeSubject>, bool) {
        let threads = self.options.habits.threads;
        if threads != self.probing.threads {
            self.probing = Probing::new(threads, &self.wake);
        }
        let Shot { camera, size, .. } = shot.clone();
        let options = self.options.of_light();
        let key = SubjectKey { scene: self.version(), options, camera: camera.clone(), size };
        if let Some((_, subject)) = self.probing.subject.as_ref().filter(|(of, _)| of.is_same(&key)) {
            return (Arc::clone(subject), false);
        }
        let subject = Arc::new(ProbeSubject { scene: Arc::clone(scene), settings, camera });
        self.probing.subject = Some((key, Arc::clone(&subject)));
        (subject, true)
    }

    /// Takes in the rays that were waited for.
    pub(super) fn take_rays(&mut self) {
        match self.probing.prober.take() {
            None => {}
            Some(Ok(ray)) => {
                if let Some(rays) = &mut self.rays {
                    (rays.ray, rays.is_awaited) = (ray, false);
                    self.say_of_rays();
                }
            }
            Some(Err(error)) => {
                self.clear_rays();
                if error != SetupError::Cancelled {
                    self.say(&error.to_string(), true);
                }
            }
        }
    }

    /// How many tasks are done of how many that prepare the debug ray, while it is waited for.
    pub fn rays_progress(&self) -> Option<[u32; 2]> {
        self.probing.prober.progress()
    }

    /// Takes the debug ray away, and what was prepared for it.
    pub(super) fn clear_rays(&mut self) {
        self.rays = None;
        self.probing.forget();
    }

    fn say_of_rays(&mut self) {
        let text = match self.rays.as_ref().map(|rays| (rays.is_awaited, rays.ray.segments.len())) {
            None => return,
            Some((true, _)) => "The integrator prepares; Esc stops.".to_owned(),
            Some((_, 1)) => "A debug ray of 1 segment.".to_owned(),
            Some((_, n)) => format!("A debug ray of {n} segments."),
        };
        self.say(&text, false);
    }

    /// Shoots the ray again where it was shot, after the scene has changed.
    pub(super) fn shoot_again(&mut self) {
        if let Some(Rays { shot, sample, .. }) = &self.rays {
            self.shoot(shot.clone(), *sample);
        }
    }

    /// Shoots the ray again to the point that it has met, from where the camera stands now, if it came from where it stood
    /// before.
    ///
    /// * `size`: columns and rows of the picture on show
    pub(super) fn shoot_along(&mut self, before: &CameraPose, size: [u32; 2]) {
        let Some(Rays { ray, sample, shot, .. }) = &self.rays else { return };
        if !shot.camera.is_view_of(before) {
            return;
        }
        let met = ray.segments.first().and_then(|segment| segment.hit).map(|hit| hit.p.as_dvec3());
        let [of, to] = [shot.size, size].map(|size| DVec2::new(size[0].into(), size[1].into()));
        let place = met.and_then(|p| self.camera.project(p, size)).unwrap_or(shot.place / of * to);
        self.shoot(Shot { camera: self.camera.clone(), place, size }, *sample);
    }

    /// The debug ray as lines: its segments, and the normals where they end.
    pub(super) fn ray_lines(&self) -> Vec<Line> {
        let Some(rays) = &self.rays else { return Vec::new() };
        let size = self.bounds().extent().length();
        let lit = rays.lit();
        let segments = rays.ray.segments.iter();
        let opaque = if rays.is_awaited { 60 } else { 220 };
        let lines = segments.clone().enumerate().map(|(index, segment)| {
            let (width, opacity) = match (lit.is_empty(), lit.contains(&index)) {
                (true, _) => (2.0, opaque),
                (false, true) => (4.0, 255),
                (false, false) => (1.5, 110),
            };
            let to = segment.from + segment.d * segment.distance.min(FAR * size);
            let [r, g, b] = color(segment);
            Line { from: segment.from, to, color: [r, g, b, opacity], width }
        });
        // Over the rays, which may go the same way.
        let normals = segments.filter_map(|segment| segment.hit).map(|hit| Line {
            from: hit.p,
            to: hit.p + NORMAL * size * hit.n,
            color: NORMALS,
            width: 2.0,
        });
        lines.chain(normals).collect()
    }
}

/// The rays of a shot; `None` where the integrator has something to prepare before.
fn shot_at_once(
    scene: &Scene,
    settings: &RenderSettings,
    shot: &Shot,
    sample: u32,
) -> Option<Result<DebugRay, SetupError>> {
    let rays = DebugRays::new(scene, settings, &shot.camera);
    let shoot = || rays.shooter().shoot(shot.place, sample, &Resources::default(), &Silent);
    (!rays.need_state()).then(shoot)
}

/// The colours of these segments and of normals, each once, with what they stand for.
pub fn legend(segments: &[Segment]) -> Vec<([u8; 3], &'static str)> {
    let mut entries: Vec<([u8; 3], &'static str)> = Vec::new();
    for segment in segments {
        let entry = (color(segment), meaning(segment));
        if !entries.contains(&entry) {
            entries.push(entry);
        }
    }
    if segments.iter().any(|segment| segment.hit.is_some()) {
        let [r, g, b, _] = NORMALS;
        entries.push(([r, g, b], "normal"));
    }
    entries
}

/// What the colour of a segment stands for.
fn meaning(segment: &Segment) -> &'static str {
    match segment.kind {
        RayKind::Shadow if is_dark(segment) => "shadow ray that finds no light",
        RayKind::Shadow => "shadow ray that finds light",
        RayKind::Camera => "from the camera",
        RayKind::Reflected => "reflected",
        RayKind::Transmitted => "refracted",
        RayKind::Scattered => "scattered",
        RayKind::Light => "from a light",
        RayKind::Connection => "between two paths",
        RayKind::Splat => "to the camera",
    }
}

fn is_dark(segment: &Segment) -> bool {
    segment.contribution == [0.0; 3]
}

/// The colour of a kind of ray; of a shadow ray, whether the light arrives.
pub fn color(segment: &Segment) -> [u8; 3] {
    match segment.kind {
        RayKind::Camera => [255, 255, 255],
        RayKind::Reflected => [255, 205, 60],
        RayKind::Transmitted => [80, 220, 255],
        RayKind::Scattered => [120, 235, 120],
        RayKind::Light => [255, 170, 90],
        RayKind::Connection => [190, 150, 255],
        RayKind::Splat => [255, 130, 190],
        RayKind::Shadow if is_dark(segment) => [235, 80, 70],
        RayKind::Shadow => [255, 240, 160],
    }
}

/// The kind of a ray in a word.
pub fn kind_name(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Camera => "camera",
        RayKind::Reflected => "reflected",
        RayKind::Transmitted => "refracted",
        RayKind::Scattered => "scattered",
        RayKind::Shadow => "shadow",
        RayKind::Light => "from light",
        RayKind::Connection => "connection",
        RayKind::Splat => "to camera",
    }
}

impl Studio {
    /// What a segment met, and the material of that, by name where they have one; of a shadow ray, which light it finds,
    /// or what is in the way.
    pub fn names_of(&self, segment: &Segment) -> (String, String) {
        let document = self.document.as_ref();
        let object = segment.hit.map(|hit| self.object_name(hit.object));
        let material = segment.hit.map_or_else(
            || "-".to_owned(),
            |hit| self.name_of(document.and_then(|d| d.node_of_material(hit.material)), hit.material),
        );
        let Some(light) = segment.light.map(|light| self.light_name(light)) else {
            let nothing = if segment.distance.is_finite() { "light" } else { "nothing" };
            return (object.unwrap_or_else(|| nothing.to_owned()), material);
        };
        let end = match object {
            Some(object) => format!("{light}: blocked by {object}"),
            None if is_dark(segment) => format!("{light}: no light this way"),
            None => format!("reaches {light}"),
        };
        (end, material)
    }

    fn light_name(&self, light: LightSource) -> String {
        let document = self.document.as_ref();
        match light {
            LightSource::Listed(place) => {
                self.name_of(document.and_then(|d| d.node_of_light(place)), place + 1)
            }
            LightSource::Object(number) => self.object_name(number),
            LightSource::Background => "the background".to_owned(),
        }
    }

    fn object_name(&self, number: u32) -> String {
        self.name_of(self.document.as_ref().and_then(|d| d.part_of_object(number)), number)
    }

    /// The name of a block, or its word, and a number.
    fn name_of(&self, node: Option<NodeId>, number: u32) -> String {
        let node = node.and_then(|id| self.document.as_ref()?.node(id));
        let named = node.map(|node| node.name.as_deref().unwrap_or(&node.keyword).to_owned());
        named.map_or_else(|| format!("#{number}"), |name| format!("{name} #{number}"))
    }
}
