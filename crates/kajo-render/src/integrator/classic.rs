//! Recursive ray tracing in the manner of the course's reference program [Whitted 1980].
//!
//! The light along a ray that hits a surface is
//!
//! ```text
//! L = ambient + sum of visible lights (Phong) + reflective L(mirror ray) + transparent L(refracted ray)
//! ```
//!
//! with as many mirror and refracted rays in a row as `bounces` allows. A ray carries the
//! index of refraction of where it travels: 1 at the camera, a material's own once it
//! has entered through the outside, 1 again after leaving anything. Under total internal
//! reflection the transmitted term is zero.
//!
//! Two options go beyond the reference. `total_reflection` sends the transmitted share into the
//! mirror direction where it cannot pass. `fresnel` divides it everywhere: the share `F` of
//! [`fresnel::dielectric`] is mirrored and `1 - F` passes.

mod settings;

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::ItemBuffer;
use kajo_core::bsdf::{Phong, fresnel};
use kajo_core::camera::Camera;
use kajo_core::light::{Illumination, LightId};
use kajo_core::scene::{Interaction, Scene};
use kajo_core::settings::Shadows;
use kajo_math::{Ray, Vec2, Vec3};

use super::Integrator;
use super::camera_view::CameraView;
use super::shadow;
use crate::context::Scratch;
use crate::trail::{About, PathObserver, RayKind};
use crate::{LayerSet, PixelSample, RayCounters, SampleContext};
pub use settings::{CLASSIC, ClassicSettings, MAX_BOUNCES};

/// The classic integrator over one scene and one picture size.
pub struct Classic<'a> {
    scene: &'a Scene,
    settings: ClassicSettings,
    view: CameraView<'a>,
    /// What camera rays may meet.
    camera_items: Option<ItemBuffer>,
    /// The lights, each with the factor of its light.
    emitters: Vec<(LightId, f32)>,
    /// What may be in front of each of them; for those beyond its end it is not known.
    light_items: Vec<Option<ItemBuffer>>,
}

/// Item buffers pay where a picture has more pixels than this for each primitive.
const PIXELS_PER_PRIMITIVE: u64 = 16;

/// Pixels for each cell of an item buffer: about as many shadow rays to a light fall into one.
const PIXELS_PER_CELL: u64 = 32;

/// Lights that get an item buffer; each takes up to some megabytes.
const LIGHTS_WITH_ITEMS: usize = 16;

/// Patches of an emissive object that are asked for light; those of a mesh may be a million.
const PIECES_OF_OBJECT: usize = 16;

/// Paths into which one sample may fork, 2^18: all forks of eighteen in a row are followed.
///
/// Where each surface both mirrors and lets light through, `bounces` in a row make 2^bounces paths, which would not
/// end within a lifetime.
const MOST_PATHS: u32 = 1 << 18;

/// Where a ray is on its way: what later light is multiplied by, and through what it travels.
#[derive(Clone, Copy)]
struct BranchState {
    bounces_left: u32,
    /// Paths into which this one may still fork, itself included.
    paths_left: u32,
    /// Product of the magnitudes of the colours so far.
    weight: f32,
    /// Index of refraction around the ray.
    eta: f32,
    /// Whether the ray travels inside a body, where there is no fog.
    inside: bool,
}

impl<'a> Classic<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(scene: &'a Scene, settings: ClassicSettings, size: [u32; 2], layers: LayerSet) -> Classic<'a> {
        Classic::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: ClassicSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> Classic<'a> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let pays = pixels >= PIXELS_PER_PRIMITIVE * scene.geometry.primitives.len() as u64;
        let cells = usize::try_from(pixels / PIXELS_PER_CELL).unwrap_or(usize::MAX);
        let items = |apex: Option<Vec3>| {
            apex.filter(|_| pays).and_then(|apex| scene.geometry.item_buffer(apex, cells))
        };
        let camera_items = items(camera.apex());
        let emitters = scene.lighting.sampler.representatives(&scene.lighting.lights, PIECES_OF_OBJECT);
        let hidden = match settings.shadows {
            Shadows::Off => 0,
            Shadows::Opaque | Shadows::Transparent => LIGHTS_WITH_ITEMS,
        };
        let light_items =
            emitters.iter().take(hidden).map(|&(id, _)| items(scene.lighting.lights.apex(id))).collect();
        let view = CameraView::new(scene, camera, size, layers);
        Classic { scene, settings, view, camera_items, emitters, light_items }
    }

    /// Writes where a ray ends that leaves the surface at `at`; `false` where it hits nothing.
    fn trace(&self, ray: &Ray, at: &mut Interaction) -> bool {
        if ray.d.dot(at.point.ng) < 0.0 {
            self.scene.trace_inwards(ray, at)
        } else {
            self.scene.trace_into(None, ray, at)
        }
    }

    /// Light along the ray of a path, and along all that branches off it:
    ///
    /// ```text
    /// L(ray) = local + reflective L(mirror ray) + transparent L(refracted ray)
    /// ```
    ///
    /// A sum over a tree of rays; nothing is drawn. Where only one branch goes on, the path goes on along it. Where both do,
    /// the mirrored one is followed to all its ends first, and the other waits in a list.
    ///
    /// * `at`: the surface that the ray hits, if it `hits` one
    fn li<O: PathObserver>(
        &self,
        ray: Ray,
        path: BranchState,
        at: &mut Interaction,
        mut hits: bool,
        observer: &mut O,
        scratch: &mut Scratch,
    ) -> Spectrum {
        let mut walk = FollowedPath { ray, path, light: Spectrum::BLACK, beta: Spectrum::WHITE };
        let mut n_waiting = 0;
        loop {
            let branches = self.surface(&mut walk, hits.then_some(&mut *at), observer);
            let branch = match branches {
                (None, None) => {
                    // Most paths never fork, and ask for no list.
                    let waiting = if n_waiting > 0 {
                        scratch.get::<Vec<PendingRefraction<O::Mark>>>().pop()
                    } else {
                        None
                    };
                    let Some(fork) = waiting else { return walk.light };
                    n_waiting -= 1;
                    observer.back_to(fork.mark);
                    let light = fork.light + fork.weight * walk.light;
                    walk = FollowedPath { light, beta: fork.beta, ..walk };
                    *at = fork.at;
                    refracted(fork.refracted, observer)
                }
                (Some(mirrored), None) => reflected(mirrored, observer),
                (None, Some(behind)) => refracted(behind, observer),
                (Some(_), Some(behind)) if walk.path.paths_left < 2 => {
                    observer.counters().left_out += 1;
                    refracted(behind, observer)
                }
                (Some(_), Some(_)) if observer.interrupted() => {
                    scratch.get::<Vec<PendingRefraction<O::Mark>>>().clear();
                    return walk.light;
                }
                (Some(mut mirrored), Some(mut behind)) => {
                    mirrored.path.paths_left = walk.path.paths_left / 2;
                    behind.path.paths_left = walk.path.paths_left - mirrored.path.paths_left;
                    let mirrored = reflected(mirrored, observer);
                    let (mark, weight) = (observer.mark(), walk.beta * mirrored.factor);
                    observer.weaken(|| weight.to_rgb());
                    let FollowedPath { light, beta, .. } = walk;
                    let fork = PendingRefraction { light, beta, weight, refracted: behind, at: *at, mark };
                    scratch.get::<Vec<PendingRefraction<O::Mark>>>().push(fork);
                    n_waiting += 1;
                    (walk.light, walk.beta) = (Spectrum::BLACK, Spectrum::WHITE);
                    Branch { factor: Spectrum::WHITE, ..mirrored }
                }
            };
            let Branch { d, factor, path } = branch;
            let ray = at.point.ray_towards(d, f32::INFINITY, walk.ray.time, self.settings.ray_offset);
            (walk.ray, walk.path, walk.beta) = (ray, path, walk.beta * factor);
            hits = self.trace(&walk.ray, at);
        }
    }

    /// Adds the light of the end of a path's ray, and says how it goes on from there: mirrored, and refracted.
    fn surface(
        &self,
        walk: &mut FollowedPath,
        end: Option<&mut Interaction>,
        observer: &mut impl PathObserver,
    ) -> (Option<Branch>, Option<Branch>) {
        let FollowedPath { ray, path, light, beta } = walk;
        let about = || About { eta: path.eta, weight: beta.to_rgb(), light: None };
        observer.ended(self.scene, ray, end.as_deref(), about);
        let Some(at) = end else {
            let behind = self.scene.lighting.background.color(ray.d);
            let arriving = *beta * self.through_fog(ray, f32::INFINITY, path, behind);
            observer.found(|| arriving.to_rgb());
            *light += arriving;
            return (None, None);
        };
        let mixed;
        let phong = match self.scene.constant(at.material) {
            Some(phong) => phong,
            None => {
                mixed = self.scene.appearance.phong(at.material, &self.scene.texture_context(at));
                &mixed
            }
        };
        let shading = self.scene.shading(at, 0.5);
        let mut diffuse_n = None;
        if shading.leans {
            at.point.n = shading.normal(-ray.d);
            diffuse_n = (shading.n != at.point.n).then_some(shading.n);
        }
        let carried = || (path.eta, *beta * self.fog_factor(ray, at.hit.t, path));
        let mut local = self.shade(ray, at, phong, diffuse_n, observer, carried);
        let emitted = self.scene.surface_light(at, ray.d, &Wavelengths::RGB).map(|hit| hit.radiance);
        if let Some(emitted) = emitted {
            local += emitted;
        }
        observer.found(|| {
            let own = self.scene.lighting.ambient * phong.ambient + emitted.unwrap_or(Spectrum::BLACK);
            (*beta * self.through_fog(ray, at.hit.t, path, own)).to_rgb()
        });
        // Fog weakens everything that comes from the surface, also what arrives there later.
        *light += *beta * self.through_fog(ray, at.hit.t, path, local);
        *beta *= self.fog_factor(ray, at.hit.t, path);
        (self.mirrored(ray, at, phong, path), self.refracted(ray, at, phong, path))
    }

    /// Ambient light and every visible light, by the material's own model.
    ///
    /// * `phong`: of the material
    /// * `diffuse_n`: unit normal of its diffuse part, where it is another one: its tilt by a relief is not limited
    /// * `carried`: index of refraction around the ray, and what becomes of light that leaves the surface along it
    fn shade(
        &self,
        ray: &Ray,
        at: &Interaction,
        phong: &Phong,
        diffuse_n: Option<Vec3>,
        observer: &mut impl PathObserver,
        carried: impl Fn() -> (f32, Spectrum),
    ) -> Spectrum {
        let mut light = self.scene.lighting.ambient * phong.ambient;
        let from_behind = ray.d.dot(at.point.n) > 0.0;
        if from_behind && !self.settings.shade_back {
            return light;
        }
        let facing = |n: Vec3| if from_behind { -n } else { n };
        let (n, diffuse_n) = (facing(at.point.n), diffuse_n.map(facing));
        let (wo, highlight) = (-ray.d, self.settings.highlight);
        let scattered = |wi: Vec3, light: Spectrum| match diffuse_n {
            None => phong.shade(n, wo, wi, light, highlight),
            Some(diffuse_n) => phong.shade_with_two_normals(n, diffuse_n, wo, wi, light, highlight),
        };
        for (number, &(id, factor)) in self.emitters.iter().enumerate() {
            let Illumination { wi, distance, intensity } =
                self.scene.lighting.lights.illuminate(id, at.point.p, at.time);
            let shaded = scattered(wi, intensity * factor);
            if !shaded.is_black() {
                let shadow_ray = at.point.ray_towards(wi, distance, ray.time, self.settings.ray_offset);
                let arriving = shaded * self.visibility(number, &shadow_ray, observer.counters());
                let about = || {
                    let (eta, weight) = carried();
                    let white = scattered(wi, Spectrum::WHITE);
                    About { eta, weight: (weight * white).to_rgb(), light: Some(id) }
                };
                observer.joined(RayKind::Shadow, self.scene, &shadow_ray, about, || {
                    (carried().1 * arriving).to_rgb()
                });
                light += arriving;
            }
        }
        light
    }

    /// The share of light number `number` that arrives at the start of a ray towards it.
    fn visibility(&self, number: usize, shadow_ray: &Ray, rays: &mut RayCounters) -> Spectrum {
        let apex = self.light_items.get(number).and_then(Option::as_ref);
        match self.settings.shadows {
            Shadows::Off => Spectrum::WHITE,
            Shadows::Transparent if self.scene.geometry.transmits => {
                rays.shadow += 1;
                shadow::transmittance(self.scene, apex, shadow_ray, self.settings.shadow_attenuation)
            }
            Shadows::Opaque | Shadows::Transparent => {
                rays.shadow += 1;
                let occluded = self.scene.occluded_towards(apex, shadow_ray);
                if occluded { Spectrum::BLACK } else { Spectrum::WHITE }
            }
        }
    }

    fn mirrored(&self, ray: &Ray, at: &Interaction, phong: &Phong, path: &BranchState) -> Option<Branch> {
        let mut factor = phong.reflective;
        if (self.settings.fresnel || self.settings.total_reflection) && !phong.transparent.is_black() {
            factor += phong.transparent * self.mirrored_share(ray, at, phong, path);
        }
        let path = self.after(factor, path)?;
        Some(Branch { d: fresnel::reflect(ray.d, at.point.n), factor, path })
    }

    #[inline(always)]
    fn refracted(&self, ray: &Ray, at: &Interaction, phong: &Phong, path: &BranchState) -> Option<Branch> {
        if phong.transparent.is_black() || path.bounces_left == 0 {
            return None;
        }
        self.refracted_by(ray, at, phong, path)
    }

    /// [`Classic::refracted`] by a material that lets light through.
    #[inline(never)]
    fn refracted_by(&self, ray: &Ray, at: &Interaction, phong: &Phong, path: &BranchState) -> Option<Branch> {
        let crossing = Crossing::of(ray, at, phong);
        let d = fresnel::refract(ray.d, crossing.n, crossing.eta_far / path.eta)?;
        let passing =
            if self.settings.fresnel { 1.0 - self.mirrored_share(ray, at, phong, path) } else { 1.0 };
        let factor = phong.transparent * passing;
        let beyond =
            BranchState { eta: crossing.eta_far, inside: crossing.enters, ..self.after(factor, path)? };
        Some(Branch { d, factor, path: beyond })
    }

    /// The share of the transmitted light that is mirrored instead.
    fn mirrored_share(&self, ray: &Ray, at: &Interaction, phong: &Phong, path: &BranchState) -> f32 {
        let crossing = Crossing::of(ray, at, phong);
        let eta = crossing.eta_far / path.eta;
        if self.settings.fresnel {
            fresnel::dielectric(-ray.d.dot(crossing.n), eta)
        } else if fresnel::refract(ray.d, crossing.n, eta).is_none() {
            1.0
        } else {
            0.0
        }
    }

    /// The path behind a surface that multiplies light by `factor`, if anything of that could be seen.
    fn after(&self, factor: Spectrum, path: &BranchState) -> Option<BranchState> {
        if path.bounces_left == 0 || factor.is_black() {
            return None;
        }
        let weight = path.weight * factor.magnitude();
        if weight < self.settings.weight {
            return None;
        }
        Some(BranchState { bounces_left: path.bounces_left - 1, weight, ..*path })
    }

    /// `behind` as it is seen through the fog along the first `t` of a ray.
    fn through_fog(&self, ray: &Ray, t: f32, path: &BranchState, behind: Spectrum) -> Spectrum {
        match &self.scene.lighting.fog {
            Some(fog) if !path.inside => fog.seen_through(behind, ray.o, ray.d, t.max(0.0)),
            _ => behind,
        }
    }

    /// What remains of light from behind the first `t` of a ray.
    fn fog_factor(&self, ray: &Ray, t: f32, path: &BranchState) -> f32 {
        match &self.scene.lighting.fog {
            Some(fog) if !path.inside => fog.transmittance(ray.o, ray.d, t.max(0.0)),
            _ => 1.0,
        }
    }

    /// What a surface does with white light in all: scatter, mirror and let through.
    fn albedo(&self, at: &Interaction) -> [f32; 3] {
        let phong = self.scene.appearance.phong(at.material, &self.scene.texture_context(at));
        (phong.diffuse + phong.reflective + phong.transparent).to_rgb().map(|v| v.min(1.0))
    }

    /// The test picture: red grows to the right, green downward; the values of pixel centres.
    fn uv_picture(&self, pixel: [u32; 2]) -> Spectrum {
        let center = |axis: usize| (pixel[axis] as f32 + 0.5) / self.view.size[axis] as f32;
        Spectrum::rgb(center(0), center(1), 1.0)
    }
}

/// A mirror or refracted ray to be followed from the surface where it branched off.
struct Branch {
    /// Its direction.
    d: Vec3,
    factor: Spectrum,
    path: BranchState,
}

/// A path while it is followed.
struct FollowedPath {
    /// The ray that has been followed last.
    ray: Ray,
    path: BranchState,
    /// Light found since the last fork.
    light: Spectrum,
    /// What later light is multiplied by.
    beta: Spectrum,
}

/// A surface whose refracted branch waits until the mirrored one has been followed to its ends.
struct PendingRefraction<M> {
    /// Light of the path up to there.
    light: Spectrum,
    /// Its throughput there.
    beta: Spectrum,
    /// What the light of the mirrored branch is multiplied by.
    weight: Spectrum,
    refracted: Branch,
    at: Interaction,
    mark: M,
}

/// The same branch, now that it is followed.
fn reflected(branch: Branch, observer: &mut impl PathObserver) -> Branch {
    observer.counters().reflected += 1;
    observer.next(RayKind::Reflected);
    branch
}

/// The same branch, now that it is followed.
fn refracted(branch: Branch, observer: &mut impl PathObserver) -> Branch {
    observer.counters().refracted += 1;
    observer.next(RayKind::Transmitted);
    branch
}

/// The two sides of a surface as a ray hits it.
struct Crossing {
    /// Unit normal against the ray.
    n: Vec3,
    /// Whether the ray comes from outside.
    enters: bool,
    /// Index of refraction beyond the surface; leaving always goes to vacuum.
    eta_far: f32,
}

impl Crossing {
    fn of(ray: &Ray, at: &Interaction, phong: &Phong) -> Crossing {
        let enters = ray.d.dot(at.point.n) < 0.0;
        let n = if enters { at.point.n } else { -at.point.n };
        Crossing { n, enters, eta_far: if enters { phong.eta } else { 1.0 } }
    }
}

impl Integrator for Classic<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let Some(ray) = self.view.ray(raster, &mut ctx.draws) else { return PixelSample::default() };
        observer.counters().camera += 1;
        let path = BranchState {
            bounces_left: self.settings.bounces,
            paths_left: MOST_PATHS,
            weight: 1.0,
            eta: 1.0,
            inside: false,
        };
        let mut at = Interaction::default();
        let hits = self.scene.trace_into(self.camera_items.as_ref(), &ray, &mut at);
        let first = hits.then(|| self.view.first_hit(&at, &mut ctx.aux));
        if hits && self.view.wants_albedo() {
            ctx.aux.albedo = self.albedo(&at);
        }
        let mut light = self.li(ray, path, &mut at, hits, observer, &mut ctx.scratch);
        if self.settings.uv {
            light = self.uv_picture(pixel);
            observer.shown_instead(|| light.to_rgb());
        }
        // Groups of lights are not told apart.
        ctx.aux.lights[0] = light.to_rgb();
        PixelSample { radiance: light.to_rgb(), first }
    }
}
