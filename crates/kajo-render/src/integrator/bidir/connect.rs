//! The ends of paths, and what joins them.
//!
//! Each of the estimates here is that of one way to find a path, with `s` of its vertices from the light's path and `t` from
//! the camera's. With the throughputs `beta` of both ends, what is summed over paths of vertices per area is
//!
//! ```text
//! s = 0           beta_z Le(z -> back)                                       a light that the camera's path hits
//! s = 1           beta_z f_z |cos| Le T V / q(wi)                            a light drawn for z, q per solid angle
//! s > 1, t > 1    beta_y f_y f_z |cos cos'| / d^2 T V beta_z                 two vertices y, z that see each other
//! s > 1, t = 1    beta_y f_y |cos| We T V / p(lens)                          a vertex y that the lens sees
//! s = 1, t = 1    Le We |cos| T V / (p(lens) q(wi))                          a light drawn for a point of the lens
//! ```
//!
//! times the weight of the way among all others. `T` is the transmittance of the medium, `V` that of holes and panes. At points
//! in a medium phase functions stand for `f`, and no cosines are left.

use kajo_color::{Spectrum, Wavelengths, sensor};
use kajo_core::LightIndex;
use kajo_core::differential::SkyFootprint;
use kajo_core::interaction::SurfacePoint;
use kajo_core::light::{EmissionPdf, LightLiSample, LightPoint, Receiver, SampledLight};
use kajo_core::sampler::SampleStream;
use kajo_core::scene::{Interaction, Scene};
use kajo_math::{Ray, Vec3};

use super::partial_mis::{PartialMis, mis_weight, square, weighted_pdf_across};
use super::subpath::Subpath;
use super::vertex::Vertex;
use super::volume::Volume;
use super::{Bidirectional, Carried, Contribution, VertexCounts};
use crate::integrator::transport::{
    DrawnLight, Joining, MediumStack, PathState, connect, connect_through_media, sample_light,
};
use crate::trail::{About, PathObserver, RayKind};

/// Densities with which a path from a light begins. Of a light infinitely far away the direction is its end.
#[derive(Clone, Copy, Debug)]
pub struct LightEndPdf {
    /// Of the light vertex, per area; per solid angle for light from infinitely far away, one for a point.
    pub end: f32,
    /// Of the first segment, per solid angle, without the geometry at its end; per area for light from infinitely far away.
    pub onward: f32,
}

impl LightEndPdf {
    pub fn new(pdf: EmissionPdf, is_infinite: bool) -> LightEndPdf {
        let EmissionPdf { position, direction } = pdf;
        let [end, onward] = if is_infinite { [direction, position] } else { [position, direction] };
        LightEndPdf { end, onward }
    }
}

/// What is reported to an observer of a segment that joins two vertices.
struct Join<'a> {
    kind: RayKind,
    segment: &'a Ray,
    /// What light from its far end is multiplied by.
    carried: Spectrum,
    /// The light that it is cast to.
    light: Option<LightIndex>,
}

/// What comes along a segment that joins two vertices.
pub struct SegmentShare {
    /// What the medium that it starts in leaves; in scenes with participating media all that is left, over the mean density of the lanes.
    pub within: Spectrum,
    /// What holes and panes leave.
    pub visible: Spectrum,
    /// The probability of going the same way by free paths, in scenes with participating media; 1 in others.
    pub reach: f32,
}

impl SegmentShare {
    /// What comes along a segment from a vertex; `None` where nothing does.
    ///
    /// * `wi`, `distance`: the direction from the vertex and how far its other end is
    ///
    /// Takes random numbers in scenes with participating media.
    #[inline]
    pub fn along<'a, V: Volume<'a>>(
        scene: &Scene,
        z: &Vertex<'a, V>,
        wi: Vec3,
        distance: f32,
        segment: &Ray,
        with: Joining<'_, '_>,
        observer: &mut impl PathObserver,
    ) -> Option<SegmentShare> {
        if let Some(volume) = z.volume.with_media() {
            return SegmentShare::through_media(scene, segment, &volume.media[z.side(wi)], with, observer);
        }
        let visible = connect(scene, segment, z.eta(wi), with.wavelengths, observer);
        let share = || SegmentShare { within: z.transmittance(wi, distance), visible, reach: 1.0 };
        (!visible.is_black()).then(share)
    }

    /// The same through participating media.
    ///
    /// * `media`: around the start of the segment
    #[inline(never)]
    fn through_media(
        scene: &Scene,
        segment: &Ray,
        media: &MediumStack,
        with: Joining<'_, '_>,
        observer: &mut impl PathObserver,
    ) -> Option<SegmentShare> {
        let wavelengths = *with.wavelengths;
        let passage = connect_through_media(scene, segment, *media, with, observer);
        let density = wavelengths.mean(passage.r_l);
        let share = || SegmentShare {
            within: passage.t * density.recip(),
            visible: Spectrum::WHITE,
            reach: passage.reach(&wavelengths),
        };
        (!passage.t.is_black() && density > 0.0).then(share)
    }
}

impl<'a, V: Volume<'a>> Bidirectional<'a, V> {
    /// `s = 0`: the emission of a surface that the camera's path hits, `beta Le w`.
    ///
    /// * `from`: the vertex before, `None` where that is the lens
    pub(super) fn hit_emission(
        &self,
        path: &Subpath<'_>,
        at: &Interaction,
        wo: Vec3,
        camera_ray: &Ray,
        from: Option<&Vertex<'a, V>>,
    ) -> Option<Contribution> {
        let hit = self.scene().surface_light(at, -wo, &path.state.wavelengths)?;
        let (p, end) = (at.point.p, LightPoint::on(&at.point));
        let seen = || self.mis_weight_of_seen(path, camera_ray, hit.light, &end);
        let weight = from.map_or_else(seen, |from| {
            let cosine = end.cosine(wo);
            let pdf_li = self.pdf_li(hit.light, &from.receiver(at.time), &end, -wo) * cosine
                / p.distance_squared(from.at.p);
            let pdf_le = self.pdf_le(hit.light, at.time, &end, wo);
            mis_weight_of_hit(&path.mis_at::<V>(p, cosine, None), pdf_li, pdf_le)
        });
        Some(path.hit(hit.radiance, hit.group, weight))
    }

    /// `s = 0`: hands the light to `found` of the background and of the discs in the sky that the camera's path comes to.
    ///
    /// * `d`: unit direction in which it leaves the scene
    pub(super) fn hit_background(
        &self,
        path: &Subpath<'_>,
        d: Vec3,
        camera_ray: &Ray,
        from: Option<&Vertex<'a, V>>,
        mut found: impl FnMut(Contribution),
    ) {
        let scene = self.scene();
        let PathState { ray, wavelengths, .. } = &path.state;
        for hit in scene.lights_at_infinity(d, &SkyFootprint::POINT, wavelengths) {
            let seen = || {
                let end = LightPoint::Infinite { through: camera_ray.o };
                self.mis_weight_of_seen(path, camera_ray, hit.light, &end)
            };
            let weight = from.map_or_else(seen, |from| {
                let end = LightPoint::Infinite { through: from.at.p };
                let pdf_li = self.pdf_li(hit.light, &from.receiver(ray.time), &end, d);
                let pdf_le = self.pdf_le(hit.light, ray.time, &end, -d);
                mis_weight_of_hit(&path.mis_at_infinity::<V>(), pdf_li, pdf_le)
            });
            found(path.hit(hit.radiance, hit.group, weight));
        }
    }

    /// `s = 1`: a light drawn for a vertex of the camera's path.
    pub(super) fn direct_light(
        &self,
        path: &mut PathState<'_>,
        z: &Vertex<'a, V>,
        t: u32,
        observer: &mut impl PathObserver,
    ) -> Option<Contribution> {
        let scene = self.scene();
        let time = path.ray.time;
        let drawn = sample_light(scene, path, &z.receiver(time), self.settings.light_choice)?;
        let DrawnLight { light, pdf, li: LightLiSample { wi, radiance, is_delta, at, .. } } = drawn;
        let scattered = z.gathered(wi);
        if scattered.is_black() {
            return None;
        }
        let segment = z.at.ray_to(&at, wi, time);
        let join = Join {
            kind: RayKind::Shadow,
            segment: &segment,
            carried: z.beta * scattered,
            light: Some(light),
        };
        let is_infinite = at.is_infinite();
        let distance = if is_infinite { f32::INFINITY } else { at.p().distance(z.at.p) };
        let Some(share) =
            SegmentShare::along(self.scene(), z, wi, distance, &segment, Joining::from(path), observer)
        else {
            self.tell(observer, &join, &path.wavelengths, None);
            return None;
        };
        let LightEndPdf { end, onward } = self.pdf_le(light, time, &at, -wi);
        let thinning = if is_infinite { 1.0 } else { 1.0 / (distance * distance) };
        let pdf_li = pdf * at.jacobian_to_end_measure(wi, distance * distance);
        // [Georgiev 2012, eq. 44 and 45]
        let by_camera = V::scaled(z.pdf(z.wo, wi), || share.reach);
        let w_light = if is_delta { 0.0 } else { square(by_camera / pdf) };
        let arriving = V::scaled(onward * z.cosine(wi) * thinning, || share.reach * sigma_t(z));
        let w_camera = square(end / pdf_li) * z.mis.weighed(arriving, z.pdf(wi, z.wo));
        let found = Contribution {
            technique: VertexCounts { s: 1, t },
            is_merged: false,
            light: z.beta * scattered * radiance * share.within * share.visible * pdf.recip(),
            weight: mis_weight(w_light, w_camera),
            secondary_terminated: z.secondary_terminated,
            group: scene.lighting.sampler.group(light),
            raster: None,
        };
        self.tell(observer, &join, &path.wavelengths, Some(&found));
        Some(found)
    }

    /// `s > 1, t > 1`: two vertices that see each other.
    pub(super) fn join(
        &self,
        y: &Vertex<'a, V>,
        z: &Vertex<'a, V>,
        technique: VertexCounts,
        Carried { wavelengths, time, hero, .. }: Carried<'_, impl Copy>,
        draws: &mut SampleStream<'_>,
        observer: &mut impl PathObserver,
    ) -> Option<Contribution> {
        let distance2 = y.at.p.distance_squared(z.at.p);
        if y.is_delta() || distance2 == 0.0 {
            return None;
        }
        let distance = distance2.sqrt();
        let wi = (y.at.p - z.at.p) / distance;
        let scattered = z.gathered(wi) * y.passed_on(-wi);
        if scattered.is_black() {
            return None;
        }
        let segment = z.at.ray_to(&y.end(), wi, time);
        let carried = z.beta * scattered;
        let join = Join { kind: RayKind::Connection, segment: &segment, carried, light: None };
        let secondary_terminated = y.secondary_terminated || z.secondary_terminated;
        let mut followed = *wavelengths;
        if V::HAS_MEDIA && secondary_terminated {
            followed.terminate_secondary();
        }
        let with = Joining { wavelengths: &followed, hero, r_u: lanes(y) * lanes(z), draws };
        let Some(share) = SegmentShare::along(self.scene(), z, wi, distance, &segment, with, observer) else {
            self.tell(observer, &join, wavelengths, None);
            return None;
        };
        let by_camera = z.pdf(z.wo, wi) * y.cosine(wi) / distance2;
        let by_light = y.pdf(y.wo, -wi) * z.cosine(wi) / distance2;
        let by_camera = V::scaled(by_camera, || share.reach * sigma_t(y));
        let by_light = V::scaled(by_light, || share.reach * sigma_t(z));
        // [Georgiev 2012, eq. 40 and 41]
        let w_light = y.mis.weighed(by_camera, y.pdf(-wi, y.wo));
        let w_camera = z.mis.weighed(by_light, z.pdf(wi, z.wo));
        let found = Contribution {
            technique,
            is_merged: false,
            light: y.beta * scattered * z.beta * share.within * share.visible * distance2.recip(),
            weight: mis_weight(w_light, w_camera),
            secondary_terminated,
            group: y.group,
            raster: None,
        };
        self.tell(observer, &join, wavelengths, Some(&found));
        Some(found)
    }

    /// `t = 1`: a vertex of the light's path that the camera sees.
    ///
    /// Takes two numbers for the lens.
    pub(super) fn splat(
        &self,
        y: &Vertex<'a, V>,
        technique: VertexCounts,
        Carried { wavelengths, time, hero, .. }: Carried<'_, impl Copy>,
        draws: &mut SampleStream<'_>,
        observer: &mut impl PathObserver,
    ) -> Option<Contribution> {
        let lens = draws.pair_if(self.view.camera.has_lens());
        if y.is_delta() {
            return None;
        }
        let (to, raster) = self.view.connect(y.at.p, lens, time)?;
        let scattered = y.passed_on(to.wi);
        if scattered.is_black() {
            return None;
        }
        let is_parallel = to.distance.is_infinite();
        let lens = match is_parallel {
            true => LightPoint::Infinite { through: y.at.p },
            false => LightPoint::Position(y.at.p + to.distance * to.wi),
        };
        let segment = y.at.ray_to(&lens, to.wi, time);
        let carried = y.beta * scattered;
        let join = Join { kind: RayKind::Splat, segment: &segment, carried, light: None };
        self.tell(observer, &join, wavelengths, None);
        let mut followed = *wavelengths;
        if V::HAS_MEDIA && y.secondary_terminated {
            followed.terminate_secondary();
        }
        let with = Joining { wavelengths: &followed, hero, r_u: lanes(y), draws };
        let share = SegmentShare::along(self.scene(), y, to.wi, to.distance, &segment, with, observer)?;
        // [Georgiev 2012, eq. 46 and 47]
        let arriving = weighted_pdf_across(to.pdf_across) * y.cosine(to.wi);
        let arriving = V::scaled(arriving, || share.reach * sigma_t(y));
        let w_light = || y.mis.weighed(arriving, y.pdf(to.wi, y.wo));
        Some(Contribution {
            technique,
            is_merged: false,
            light: carried * share.within * share.visible * (to.we / to.pdf),
            weight: if self.settings.only_from_lights { 1.0 } else { mis_weight(w_light(), 0.0) },
            secondary_terminated: y.secondary_terminated,
            group: y.group,
            raster: Some(raster),
        })
    }

    /// `s = 1, t = 1`: a light drawn for a point of the lens.
    ///
    /// Takes four numbers: two for the lens, two for the light and the position on it.
    pub(super) fn light_on_lens(
        &self,
        Carried { wavelengths, time, hero, .. }: Carried<'_, impl Copy>,
        draws: &mut SampleStream<'_>,
        observer: &mut impl PathObserver,
    ) -> Option<Contribution> {
        let scene = self.scene();
        let [lens, u] = [draws.next_2d(), draws.next_2d()];
        let o = self.view.sample_origin(lens, time)?;
        let receiver = Receiver { p: o, n: Vec3::ZERO, time };
        let chosen = scene.lighting.sampler.sample(&receiver, u.x, self.settings.light_choice)?;
        let SampledLight { light, probability, .. } = chosen;
        let li =
            scene.sample_li(light, &receiver, chosen.pair(u), wavelengths, self.settings.light_choice)?;
        // No ray of the camera hits a light without extent, which is therefore left out of pictures.
        if li.is_delta || li.radiance.is_black() {
            return None;
        }
        let (pdf_camera, raster) = self.view.pdf_from_origin(o, li.wi, time)?;
        let pdf_li = probability * li.pdf;
        let lens = SurfacePoint { p: o, n: li.wi, ng: li.wi, ..SurfacePoint::default() };
        let segment = lens.ray_to(&li.at, li.wi, time);
        let join =
            Join { kind: RayKind::Splat, segment: &segment, carried: Spectrum::WHITE, light: Some(light) };
        self.tell(observer, &join, wavelengths, None);
        let media = self.view.media_around(&Ray::new(o, li.wi), wavelengths);
        let with = Joining { wavelengths, hero, r_u: Spectrum::WHITE, draws };
        let share = match V::HAS_MEDIA {
            true => SegmentShare::through_media(scene, &segment, &media, with, observer)?,
            false => {
                let eta = media.eta_of_segment(scene);
                let visible = connect(scene, &segment, eta, wavelengths, observer);
                if visible.is_black() {
                    return None;
                }
                let distance = if li.at.is_infinite() { f32::INFINITY } else { li.at.p().distance(o) };
                let sigma_a = media.absorption().filter(|_| distance.is_finite());
                let within = sigma_a.map_or(Spectrum::WHITE, |sigma_a| (sigma_a * -distance).exp());
                SegmentShare { within, visible, reach: 1.0 }
            }
        };
        let by_camera = V::scaled(pdf_camera, || share.reach);
        Some(Contribution {
            technique: VertexCounts { s: 1, t: 1 },
            is_merged: false,
            light: li.radiance * share.within * share.visible * (pdf_camera / pdf_li),
            weight: mis_weight(0.0, square(weighted_pdf_across(by_camera) / pdf_li)),
            secondary_terminated: wavelengths.secondary_terminated(),
            group: scene.lighting.sampler.group(light),
            raster: Some(raster),
        })
    }

    /// The weight of light at the end of the camera's ray, which [`Bidirectional::light_on_lens`] finds, too.
    ///
    /// * `end`: the point of the light
    fn mis_weight_of_seen(
        &self,
        path: &Subpath<'_>,
        camera_ray: &Ray,
        light: LightIndex,
        end: &LightPoint,
    ) -> f32 {
        let &Ray { o, d, time, .. } = camera_ray;
        if !path.state.connectable || !self.joins_lens() {
            return 1.0;
        }
        let Some((pdf_camera, _)) = self.view.pdf_from_origin(o, d, time) else { return 1.0 };
        let pdf_li = self.pdf_li(light, &Receiver { p: o, n: Vec3::ZERO, time }, end, d);
        let by_camera = V::scaled(pdf_camera, || path.state.lanes.arrival(&path.state.wavelengths));
        mis_weight(square(pdf_li / weighted_pdf_across(by_camera)), 0.0)
    }

    /// Reports a segment that joins two vertices to the observer.
    ///
    /// * `found`: what it adds to the sample
    fn tell(
        &self,
        observer: &mut impl PathObserver,
        join: &Join<'_>,
        wavelengths: &Wavelengths,
        found: Option<&Contribution>,
    ) {
        let about = || About {
            eta: 1.0,
            weight: sensor::to_rgb(join.carried, wavelengths),
            light: join.light.map(|light| self.scene().lighting.sampler.id(light)),
        };
        let light = || found.map_or([0.0; 3], |found| found.value(wavelengths));
        observer.joined(join.kind, self.scene(), join.segment, about, light);
    }

    /// Density with which [`Bidirectional::direct_light`] draws a light and the direction `wi` to a point of it.
    pub(super) fn pdf_li(&self, light: LightIndex, to: &Receiver, at: &LightPoint, wi: Vec3) -> f32 {
        self.scene().pdf_li(light, to, at, wi, self.settings.light_choice)
    }

    /// The densities with which a path from a light begins along `d`, with the choice of the light.
    fn pdf_le(&self, light: LightIndex, time: f32, at: &LightPoint, d: Vec3) -> LightEndPdf {
        if V::HAS_MEDIA && self.is_hidden(at) {
            return LightEndPdf { end: 0.0, onward: 0.0 };
        }
        let pdf = self.scene().pdf_le(light, time, at, d, self.power_sampler.world());
        let LightEndPdf { end, onward } = LightEndPdf::new(pdf, at.is_infinite());
        LightEndPdf { end: end * self.power_sampler.pmf(light), onward }
    }
}

/// Mean extinction at a vertex in a medium, else 1.
fn sigma_t<'a, V: Volume<'a>>(vertex: &Vertex<'a, V>) -> f32 {
    vertex.volume.with_media().map_or(1.0, |volume| volume.sigma_t)
}

/// Densities of the path to a vertex, by lanes.
fn lanes<'a, V: Volume<'a>>(vertex: &Vertex<'a, V>) -> Spectrum {
    vertex.volume.with_media().map_or(Spectrum::WHITE, |volume| volume.r_u)
}

/// The weight of light that the camera's path met [Georgiev 2012, eq. 43].
///
/// * `pdf_li`: density per area of the light's end of the path among lights drawn for a vertex
/// * `pdf_le`: densities among paths from lights
fn mis_weight_of_hit(mis: &PartialMis, pdf_li: f32, pdf_le: LightEndPdf) -> f32 {
    let LightEndPdf { end, onward } = pdf_le;
    mis_weight(0.0, square(pdf_li) * mis.d_vcm + square(end) * square(onward) * mis.d_vc)
}
