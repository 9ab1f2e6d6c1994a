//! Light in bodies that bend it: what there is to be seen and how bright it is, whoever finds it.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::settings::Technique;
use kajo_testkit::Estimate;

use super::tests::{TECHNIQUES, camera, check, mean, mean_of, scene};
use super::*;
use crate::RenderSettings;
use crate::integrator::same_picture::assert_same_picture;
use crate::integrator::{
    AmbientOcclusion, AmbientOcclusionSettings, Bidirectional, BidirectionalSettings, PhotonMapping,
    PhotonSettings,
};
use crate::trail::Trail;

fn settings(bounces: u32) -> PathSettings {
    PathSettings { bounces, ..PathSettings::default() }
}

/// A body of a medium named `m`, and what else there is.
fn filled(view: &str, medium: &str, objects: &str) -> Scene {
    scene(&format!(
        "{view} Media {{ {medium} }} Materials {{ Interface i {{ medium m }}
             Matte white {{ color 0.8 0.8 0.8 }} Matte bright {{ color 0 0 0  emission 1 }} }} Group {{ {objects} }}"
    ))
}

fn under_a_white_sky(from: [f32; 3], to: [f32; 3]) -> String {
    camera(from, to).replace("color 0 0 0", "color 1 1 1")
}

const BALL: &str = "MaterialIndex i Sphere { center 0 0 0 radius 1 }";

/// In light of one radiance everywhere nothing is to be seen of a body, and inside of it radiance is `n^2`.
#[test]
fn a_uniform_sky_is_as_bright_as_the_square_of_the_index() {
    // The boundary of a Luneburg ball has the index of what is around, that of the others reflects and refracts.
    for (medium, index) in [
        ("LuneburgLens m { }", std::f64::consts::SQRT_2),
        ("GradientIndex m { index 1.5 }", 1.5),
        ("GradientIndex m { index = 1.5 - 0.2 * (x^2 + y^2 + z^2) }", 1.5),
    ] {
        let outside = filled(&under_a_white_sky([0.2, 0.3, 4.0], [0.1, 0.2, 0.0]), medium, BALL);
        check(&outside, settings(200), 400, 1.0);
        let inside = filled(&under_a_white_sky([0.0, 0.0, 0.0], [0.3, 0.5, 0.1]), medium, BALL);
        check(&inside, settings(200), 400, index * index);
    }
    // Where it begins n is not that of the middle: 2 - 0.5^2.
    let beside = filled(&under_a_white_sky([0.5, 0.0, 0.0], [0.3, 0.5, 0.1]), "LuneburgLens m { }", BALL);
    check(&beside, settings(20), 100, 1.75);
}

/// Within a body that bends light occlusion rays go straight, as they do without it.
#[test]
fn occlusion_is_the_same_within_a_body_of_index_one() {
    let of = |ball: &str| {
        let objects = format!(
            "{ball} MaterialIndex white Quad {{ corner -0.5 -0.2 -0.5 edge1 0 0 1 edge2 1 0 0 }}
             Sphere {{ center 0.1 0 0 radius 0.15 }}"
        );
        let scene =
            filled(&camera([0.0, 0.4, 0.4], [0.0, -0.2, 0.0]), "GradientIndex m { index 1 }", &objects);
        let settings = AmbientOcclusionSettings { reach: 0.3 };
        mean_of(&AmbientOcclusion::new(&scene, settings, [1, 1], LayerSet::of(&[])), 2000, 0)
    };
    let [with, without] = [BALL, ""].map(of);
    assert!(without.mean > 0.2 && without.mean < 0.95, "{without:?}");
    let sigma = with.standard_error.hypot(without.standard_error);
    assert!((with.mean - without.mean).abs() < 4.0 * sigma, "{with:?} {without:?}");
}

/// A body of the index 1 is not there: it changes no mean, though segments do not go through it.
#[test]
fn a_body_of_index_one_is_not_there() {
    let objects = |ball: &str| {
        format!(
            "{ball} MaterialIndex white Quad {{ corner -9 -1.2 -9 edge1 0 0 18 edge2 18 0 0 }}
             MaterialIndex bright Quad {{ corner -0.5 2 -0.5 edge1 1 0 0 edge2 0 0 1 }}
             MaterialIndex white Sphere {{ center 0.3 0 0.2 radius 0.4 }}"
        )
    };
    for to in [[0.3, -1.2, 0.6], [0.3, 0.2, 0.5]] {
        let view = camera([0.5, 1.5, 4.0], to);
        let medium = "GradientIndex m { index 1 }";
        let [with, without] = [BALL, ""].map(|ball| filled(&view, medium, &objects(ball)));
        let expected = mean(&without, settings(3), 1000, 0);
        for technique in TECHNIQUES {
            let found = mean(&with, PathSettings { technique, ..settings(3) }, 2000, 0);
            let sigma = found.standard_error.hypot(expected.standard_error);
            // Lights that are only drawn are not found through the body at the last of all bounces.
            if technique != Technique::Lights {
                assert!(
                    (found.mean - expected.mean).abs() < 4.0 * sigma,
                    "{technique:?}: {found:?} {expected:?}"
                );
                assert!(sigma < 0.1 * expected.mean, "{technique:?}: {found:?} {expected:?}");
            }
        }
    }
}

/// An emitter that a Luneburg ball throws onto a wall, and things within bodies: the same light by paths that find the emitter, by paths
/// from both ends, from the emitter alone, and by photons.
#[test]
fn all_ways_of_finding_light_agree_behind_a_luneburg_ball() {
    let lens = "LuneburgLens m { }";
    let wall = "MaterialIndex i Sphere { center 0 0 0 radius 1 }
        MaterialIndex white Quad { corner -3 -3 -1.2 edge1 6 0 0 edge2 0 6 0 }
        MaterialIndex bright Sphere { center 0.5 0.3 3 radius 0.5 }";
    let within = "MaterialIndex i Sphere { center 0 0 0 radius 1 }
        MaterialIndex white Sphere { center 0 -0.3 0 radius 0.4 } Quad { corner -3 -3 -1.2 edge1 6 0 0 edge2 0 6 0 }
        MaterialIndex bright Sphere { center 0.2 0.6 0.1 radius 0.2 }";
    for (objects, from, to) in
        [(wall, [3.2, 0.0, 0.2], [0.05, 0.0, -1.2]), (within, [2.5, 0.2, 2.0], [0.1, -0.1, 0.4])]
    {
        let scene = filled(&camera(from, to), lens, objects);
        let path = mean(&scene, settings(3), 600, 0);
        assert!(path.mean > 0.0 && path.standard_error < 0.06 * path.mean, "{path:?}");
        let near = |name: &str, found: Estimate| {
            let sigma = found.standard_error.hypot(path.standard_error);
            assert!((found.mean - path.mean).abs() < 4.0 * sigma, "{name}: {found:?} for {path:?}");
            assert!(sigma < 0.1 * path.mean, "{name}: {found:?} for {path:?}");
        };
        let both = BidirectionalSettings { bounces: 3, ..BidirectionalSettings::default() };
        near("both ends", mean_of(&Bidirectional::new(&scene, both, [1, 1], LayerSet::of(&[])), 400, 0));
        near("lights only drawn", {
            let technique = Technique::Scattering;
            mean(&scene, PathSettings { technique, ..settings(3) }, 800, 0)
        });
    }
}

/// All rays of one sample through the middle of the picture.
fn debug_ray(scene: &Scene) -> Trail {
    let path = Path::new(scene, settings(3), [1, 1], LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let mut ctx = SampleContext::new(&sampler, 0);
    let place = ctx.begin([0, 0], 0);
    let mut trail = Trail::default();
    path.observe(&mut ctx, [0, 0], place, &mut trail);
    trail
}

/// A debug ray is drawn along its curve: pieces that join, from the boundary on.
#[test]
fn a_debug_ray_is_a_polyline_in_a_body_that_bends_it() {
    let scene = filled(&camera([0.0, 0.5, 4.0], [0.0, 0.5, 0.0]), "LuneburgLens m { }", BALL);
    let trail = debug_ray(&scene);
    let segments = trail.segments();
    assert!(segments.len() > 20, "{}", segments.len());
    for pair in segments.windows(2) {
        let end = pair[0].from + pair[0].distance * pair[0].d;
        assert!(end.distance(pair[1].from) < 1e-4, "{pair:?}");
    }
    // Parallel light leaves at the pole.
    let last = segments.last().expect("some");
    assert!(last.from.distance(kajo_math::Vec3::NEG_Z) < 2e-3 && last.distance.is_infinite(), "{last:?}");
    assert!(segments.iter().all(|segment| segment.weight.iter().all(|w| (w - 1.0).abs() < 1e-4)));
}

/// The last chord of a curve says what was kept along it: what the symmetry of the medium keeps, and by Euler's steps not so well.
#[test]
fn a_debug_ray_tells_what_a_curve_keeps() {
    let hole = "PerspectiveCamera { center 0 2 30  direction 0.25 0.05 -1  up 0 1 0  angle 0.1 } Background { color 1 1 1 }";
    let space = "MaterialIndex i Sphere { center 0 0 0 radius 60 }";
    let ball = camera([0.0, 0.5, 4.0], [0.0, 0.5, 0.0]);
    let kerr = ["energy", "angular momentum", "Carter's constant"];
    let luneburg = ["momentum over index", "angular momentum"];
    for (view, medium, objects, names, drift) in [
        (hole, "BlackHole m { mass 1  spin 0.8 }", space, &kerr[..], 0.0..1e-8),
        (&*ball, "LuneburgLens m { }", BALL, &luneburg[..], 0.0..1e-8),
        (&*ball, "LuneburgLens m { integrator euler  steps 40 }", BALL, &luneburg[..], 1e-4..1.0),
    ] {
        let scene = filled(view, medium, objects);
        let trail = debug_ray(&scene);
        let told = trail.segments().iter().filter(|segment| segment.conserved.iter().any(Option::is_some));
        let [curve] = told.collect::<Vec<_>>()[..] else { panic!("{medium}: not one curve") };
        let kept: Vec<_> = curve.conserved.iter().flatten().collect();
        assert!(kept.iter().map(|quantity| quantity.name).eq(names.iter().copied()), "{medium}: {kept:?}");
        let off = kept.iter().map(|q| (q.end - q.start).abs() / q.start.abs().max(1e-3)).fold(0.0, f64::max);
        assert!(drift.contains(&off), "{medium}: {kept:?}");
    }
}

/// Nothing that comes to a position without an index is a hang or no number.
#[test]
fn places_without_an_index_are_black_and_counted() {
    let scene = filled(
        &under_a_white_sky([0.0, 0.1, 4.0], [0.0, 0.1, 0.0]),
        "GradientIndex m { index = 1 - 3 * step(0, 0.2 - z) }",
        BALL,
    );
    let found = mean(&scene, settings(3), 16, 0);
    assert_eq!(found.mean, 0.0);
}

/// Photons bend, too.
#[test]
fn photons_are_thrown_by_a_luneburg_ball_as_paths_are() {
    let scene = filled(
        &camera([3.2, 0.0, 0.2], [0.05, 0.0, -1.2]),
        "LuneburgLens m { }",
        "MaterialIndex i Sphere { center 0 0 0 radius 1 }
        MaterialIndex white Quad { corner -3 -3 -1.2 edge1 6 0 0 edge2 0 6 0 }
        MaterialIndex bright Sphere { center 0.5 0.3 4 radius 1.5 }",
    );
    let path = mean(&scene, settings(1), 1000, 0);
    let photons = PhotonSettings { photons: 300_000, bounces: 1, ..PhotonSettings::default() };
    let integrator = PhotonMapping::new(&scene, photons, [1, 1], LayerSet::of(&[]));
    let setup = Setup { seed: 5, threads: 1, memory: u64::MAX, progress: &crate::Silent };
    let state = integrator.with_state(0, &setup).expect("a map");
    let found = mean_of(&*state.integrator, 20, 0);
    assert!((found.mean / path.mean - 1.0).abs() < 0.15, "{found:?} {path:?}");
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let objects = "MaterialIndex i Sphere { center 0 0 0 radius 3 } MaterialIndex white Sphere { center 1.4 0 0.5 radius 0.4 }
        MaterialIndex bright Quad { corner -3 3.2 -3 edge1 6 0 0 edge2 0 0 6 }";
    for (medium, spectral) in [
        ("LuneburgLens m { radius 3 }", false),
        ("GradientIndex m { index = 1.5 - 0.02 * (x^2 + y^2 + z^2)  abbeNumber 30  noise 0.05 }", true),
        ("BlackHole m { mass 0.2  spin 0.7  axis 0.3 1 0 }", true),
    ] {
        let view = "PerspectiveCamera { center 0.2 0.5 6  direction 0 -0.1 -1  up 0 1 0  angle 60 } Background { color 1 1 1 }";
        let scene = filled(view, medium, objects);
        let size = [16, 12];
        let layers = LayerSet::of(&[crate::Layer::Color]);
        let path = Path::new(&scene, PathSettings { spectral, ..settings(4) }, size, layers);
        let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 2));
        assert_same_picture(&path, size, &schedule, [2, 1]);
    }
}
