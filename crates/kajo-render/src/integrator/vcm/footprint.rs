//! How large pixels are on the surfaces that a camera sees.

use kajo_color::Spectrum;
use kajo_core::LightGroup;
use kajo_core::bsdf::Transport;
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_math::Vec2;

use crate::SampleContext;
use crate::integrator::bidir::{NoMedia, Subpath, shade_one_way};
use crate::integrator::camera_view::CameraView;
use crate::integrator::transport::{Event, PathState, SurfaceInteraction, advance, pass_straight};
use crate::trail::Counting;

/// Rays in each row and column of a grid over the picture.
const GRID: u32 = 16;

/// Mirrors and clear boundaries that are followed.
const MOST_MIRRORS: u32 = 16;

/// The median of the sizes of pixels, in world units, at the first surfaces that are no mirrors; `None` where no ray of a grid over the
/// picture comes to one.
pub fn median(view: &CameraView<'_>) -> Option<f32> {
    let places = (0..GRID * GRID).map(|i| [i % GRID, i / GRID]);
    let mut sizes: Vec<f32> =
        places.filter_map(|place| size_at(view, place)).filter(|s| s.is_finite()).collect();
    let middle = sizes.len() / 2;
    (!sizes.is_empty()).then(|| *sizes.select_nth_unstable_by(middle, f32::total_cmp).1)
}

fn size_at(view: &CameraView<'_>, place: [u32; 2]) -> Option<f32> {
    let scene = view.scene;
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let mut draws = SampleStream::new(&sampler, 0, place, 0);
    let raster = Vec2::from([0, 1].map(|i| (place[i] as f32 + 0.5) / GRID as f32 * view.size[i] as f32));
    let start = draws;
    let ray = view.ray(raster, &mut draws)?;
    let footprint = view.footprint(&ray, raster, start)?;
    let wavelengths = view.wavelengths_at(0.5);
    let media = view.media_around(&ray, &wavelengths);
    let mut path = Subpath::from_camera(PathState::new(
        ray,
        wavelengths,
        Spectrum::WHITE,
        Transport::Radiance,
        media,
        draws,
    ));
    let mut counting = Counting::new(&SampleContext::new(&sampler, 0));
    let (mut surface, mut first) = (SurfaceInteraction::default(), None);
    let mut length = 0.0;
    while let Event::Surface = advance(scene, &mut path.state, &mut surface, &mut first, &mut counting) {
        length += surface.length;
        let mut bsdf = shade_one_way(scene, &mut path.state, &surface);
        if pass_straight(scene, &mut path.state, &surface, &mut bsdf) {
            continue;
        }
        if !bsdf.is_delta() {
            return Some(footprint.at(length));
        }
        let vertex = path.vertex::<NoMedia>(scene, &surface, bsdf, LightGroup::default());
        if path.state.scatterings == MOST_MIRRORS || !path.scatter(&vertex, &surface, false, &mut counting) {
            break;
        }
    }
    None
}
