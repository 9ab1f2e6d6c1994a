//! Every way to find paths of some length finds the same light.

use super::*;
use crate::trail::Counting;

/// Sums over batches of the light of each way, and of all of them with their weights, by the number of points.
struct Ways {
    /// By the points of the path and those from the light.
    alone: Vec<Vec<Vec<f64>>>,
    /// The same for those that are merged.
    merged: Vec<Vec<Vec<f64>>>,
    weighted: Vec<Vec<f64>>,
}

const BATCHES: u32 = 32;

fn ways(scene: &Scene, settings: BidirectionalSettings, samples: u32) -> Ways {
    ways_merging(scene, settings, samples, None)
}

/// * `merging`: paths from lights, and the radius in which their vertices are merged, if they are
fn ways_merging(
    scene: &Scene,
    settings: BidirectionalSettings,
    samples: u32,
    merging: Option<(u32, f32)>,
) -> Ways {
    match scene.has_media() {
        false => ways_of::<NoMedia>(scene, settings, samples, merging),
        true => ways_of::<WithMedia>(scene, settings, samples, merging),
    }
}

fn ways_of<'a, V: Volume<'a>>(
    scene: &'a Scene,
    settings: BidirectionalSettings,
    samples: u32,
    merging: Option<(u32, f32)>,
) -> Ways {
    let longest = settings.bounces as usize + 4;
    let integrator =
        Bidirectional::<V>::made(&scene.output.camera, scene, settings, [1, 1], LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    let zeros = || vec![0.0; BATCHES as usize];
    let by_points = || vec![vec![zeros(); longest]; longest];
    let mut sums = Ways { alone: by_points(), merged: by_points(), weighted: vec![zeros(); longest] };
    let mut path = Vec::new();
    for batch in 0..BATCHES {
        let merging = merging.map(|(paths, radius)| {
            let moments = if scene.moves() { 8 } else { 1 };
            let pass = MergePass {
                k: 0,
                paths,
                radius,
                ball_radius: radius,
                moments,
                wavelengths: Wavelengths::RGB,
            };
            integrator.merging(pass, &setup(batch.into())).expect("vertices").0
        });
        let mut ctx = SampleContext::new(&sampler, 0);
        for k in 0..samples {
            let place = ctx.begin([0, batch], k);
            let mut add = |found: Contribution, _: &Wavelengths| {
                let outside = |raster: Vec2| raster.min_element() < 0.0 || raster.max_element() >= 1.0;
                if found.raster.is_some_and(outside) {
                    return;
                }
                let [s, t] = [found.technique.s, found.technique.t].map(|n| n as usize);
                let light = f64::from(found.light[0]) / f64::from(samples);
                let points = s + t - usize::from(found.is_merged);
                let alone = if found.is_merged { &mut sums.merged } else { &mut sums.alone };
                alone[points][s][batch as usize] += light;
                sums.weighted[points][batch as usize] += f64::from(found.weight) * light;
            };
            let counting = &mut Counting::default();
            integrator.estimate(
                ctx.draws,
                counting,
                place,
                &mut path,
                AllTechniques(merging.as_ref()),
                &mut add,
            );
        }
    }
    sums
}

fn estimate(sums: &[f64]) -> Estimate {
    Estimate::of_batches(|batch| sums[batch as usize])
}

/// Light of paths of `points` points by path tracing.
fn by_path(scene: &Scene, points: u32, samples: u32) -> Estimate {
    let bounces = |bounces: u32| {
        let settings = PathSettings { bounces, roulette: false, ..PathSettings::default() };
        mean_of(&Path::new(scene, settings, [1, 1], LayerSet::of(&[])), samples, 0)
    };
    let (all, shorter) = (bounces(points - 3), points.checked_sub(4).map(bounces));
    let less = shorter.map_or(0.0, |shorter| shorter.mean);
    let noise = shorter.map_or(0.0, |shorter| shorter.standard_error);
    let direct = if points == 3 { mean_of_seen(scene, samples) } else { 0.0 };
    Estimate { mean: all.mean - less - direct, standard_error: all.standard_error.hypot(noise) }
}

/// Light of emitters that are seen themselves.
fn mean_of_seen(scene: &Scene, samples: u32) -> f64 {
    let nothing = BidirectionalSettings { bounces: 0, ..both() };
    estimate(&ways(scene, nothing, samples).weighted[2]).mean
}

#[track_caller]
fn assert_same(one: &Estimate, other: &Estimate, what: &str) {
    assert_same_within(one, other, 0.06, what);
}

/// * `noise`: the largest standard error, as a share of the light
#[track_caller]
fn assert_same_within(one: &Estimate, other: &Estimate, noise: f64, what: &str) {
    let sigma = one.standard_error.hypot(other.standard_error);
    assert!((one.mean - other.mean).abs() < 4.5 * sigma + 1e-6, "{what}: {one:?} {other:?}");
    assert!(sigma < noise * other.mean.abs(), "{what} is too noisy: {one:?} {other:?}");
}

/// A room with a light on its ceiling, in the words of the scene language.
fn room(camera: &str, emitter: &str, things: &str) -> String {
    format!(
        "{camera} Background {{ color 0 0 0 }}
         Materials {{ Matte white {{ color 0.7 0.7 0.7 }}  Matte red {{ color 0.6 0.2 0.1 }}
            Metal gold {{ metal gold roughness 0.5 }}  Glass frosted {{ roughness 0.5 }}
            Material emitter {{ diffuseColor 0.2 0.2 0.2  emission 2 2 2 }} }}
         Group {{ MaterialIndex white  Box {{ min -1 -1 -1  max 1 1 1 }}  {emitter}  {things} }}"
    )
}

const WIDE: &str = "PerspectiveCamera { center 0 0 0.95  direction 0 -0.2 -1  up 0 1 0  angle 70 }";
const LENS: &str =
    "PerspectiveCamera { center 0 0 0.8  direction 0 -0.2 -1  up 0 1 0  angle 60  aperture 0.2  focus 1.2 }";
const PARALLEL: &str = "OrthographicCamera { center 0 0 0.9  direction 0 -0.3 -1  up 0 1 0  size 0.8 }";
const CORNER: &str =
    "Quad { corner -1 -1 -1  edge1 0 0 2  edge2 2 0 0 }  Quad { corner -1 -1 -1  edge1 2 0 0  edge2 0 2 0 }";
const CEILING: &str = "MaterialIndex emitter Quad { corner -0.6 0.95 -0.6  edge1 1.2 0 0  edge2 0 0 1.2 }";

#[track_caller]
fn check_ways(text: &str, bounces: u32, samples: u32) {
    check_ways_within(text, bounces, samples, 0.06);
}

/// * `noise`: the largest standard error of one way, as a share of the light
#[track_caller]
pub(super) fn check_ways_within(text: &str, bounces: u32, samples: u32, noise: f64) {
    let samples = samples * effort();
    let scene = scene(text);
    let settings = BidirectionalSettings { bounces, roulette: false, ..both() };
    let sums = ways(&scene, settings, samples);
    for points in 3..=bounces + 3 {
        let all = estimate(&sums.weighted[points as usize]);
        let expected = by_path(&scene, points, samples);
        assert_same(&all, &expected, &format!("{points} points, all ways"));
        for s in 0..points {
            let alone = estimate(&sums.alone[points as usize][s as usize]);
            // Two collisions near each other are joined by 1/d², whose variance has no bound: one sample of millions may decide it.
            let joins_collisions = scene.has_media() && (2..points - 1).contains(&s);
            let noise = if joins_collisions { 3.0 * noise } else { noise };
            assert_same_within(&alone, &all, noise, &format!("{points} points, {s} from the light"));
        }
    }
}

/// Merging at any point of a path finds all of its light alone, and all ways together do.
#[track_caller]
fn check_merging(text: &str, bounces: u32, (samples, paths, radius): (u32, u32, f32)) {
    let samples = samples * effort();
    let scene = scene(text);
    let settings = BidirectionalSettings { bounces, roulette: false, ..both() };
    let sums = ways_merging(&scene, settings, samples, Some((paths, radius)));
    let without = ways(&scene, settings, samples);
    for points in 3..=bounces + 3 {
        let all = estimate(&sums.weighted[points as usize]);
        let expected = estimate(&without.weighted[points as usize]);
        assert_same(&all, &expected, &format!("{points} points, all ways"));
        for s in 2..points {
            let alone = estimate(&sums.merged[points as usize][s as usize]);
            assert_same(&alone, &all, &format!("{points} points, merged after {s} from the light"));
        }
    }
}

/// All ways together find the same light with merging and without, where not all of it can be found by merging alone.
#[track_caller]
pub(super) fn check_merged_light(text: &str, bounces: u32, (samples, paths, radius): (u32, u32, f32)) {
    let (scene, samples) = (scene(text), samples * effort());
    let settings = BidirectionalSettings { bounces, roulette: false, ..both() };
    let with = ways_merging(&scene, settings, samples, Some((paths, radius)));
    let without = ways(&scene, settings, samples);
    let light = |points: usize| [&with, &without].map(|ways| estimate(&ways.weighted[points]));
    // Some lengths may have none.
    let is_lit = |&points: &usize| light(points).iter().any(|light| light.mean != 0.0);
    assert!(is_lit(&(bounces as usize + 3)));
    for points in (3..=bounces as usize + 3).filter(is_lit) {
        let [with, without] = light(points);
        assert_same_within(&with, &without, 0.04, &format!("{points} points"));
    }
}

#[test]
fn merging_finds_all_light_of_a_matt_room() {
    check_merging(&room(WIDE, CEILING, ""), 2, (400, 20_000, 0.03));
    let open = room(PARALLEL, CEILING, "").replace("Box { min -1 -1 -1  max 1 1 1 }", CORNER);
    check_merging(&open, 1, (400, 20_000, 0.03));
}

#[test]
fn merging_finds_all_light_of_gold_glass_and_shading_normals() {
    let mesh = "Transform { Translate 0 -0.2 -0.2 YRotate 20 UniformScale 0.6 TriangleMesh { file gem.obj smooth on } }";
    let things = format!(
        "MaterialIndex gold {mesh} MaterialIndex frosted Sphere {{ center 0.4 -0.6 -0.2  radius 0.35 }}"
    );
    check_merging(&room(WIDE, CEILING, &things), 1, (800, 20_000, 0.03));
}

/// Parts of mixtures are drawn anew at each end; what shows holes is not merged.
#[test]
fn merging_finds_all_light_of_mixtures_and_holes() {
    let materials =
        "Principled paint { color 0.5 0.6 0.3  coat 0.5 }  Matte gauze { color 0.5 0.3 0.2  opacity 0.4 }
                     Principled misty { color 0.9 0.6 0.3  transmission 0.6  roughness 0.5 }";
    let things = "MaterialIndex paint Quad { corner -1 -0.99 -1  edge1 0 0 2  edge2 2 0 0 }
                  MaterialIndex gauze Quad { corner -1 0.6 -1  edge1 0 0 2  edge2 2 0 0 }
                  MaterialIndex misty Sphere { center 0.4 -0.6 -0.2  radius 0.35 }";
    let text = room(WIDE, CEILING, things).replace("Materials {", &format!("Materials {{ {materials}"));
    check_merged_light(&text, 2, (1500, 20_000, 0.03));
}

/// Things that move are merged with light of their own moment.
#[test]
fn merging_finds_all_light_of_what_moves() {
    let ball = "MaterialIndex red Transform { Motion { key 0 { } key 1 { Translate 1 0 0 } } Sphere { center -0.5 -0.5 -0.2  radius 0.4 } }";
    let camera = WIDE.replace("angle 70", "angle 70  shutter 0 1");
    check_merging(&room(&camera, CEILING, ball), 1, (800, 40_000, 0.04));
}

#[test]
fn all_ways_through_a_matt_room_are_one() {
    check_ways(&room(WIDE, CEILING, ""), 2, 1500);
    check_ways(&room(LENS, CEILING, ""), 1, 3000);
    // Parallel rays begin behind the wall of a room.
    let open = room(PARALLEL, CEILING, "").replace("Box { min -1 -1 -1  max 1 1 1 }", CORNER);
    check_ways(&open, 1, 3000);
}

/// Emitters that a lens shows out of focus are met by rays of the camera, and joined with points of the lens.
#[test]
fn lights_seen_through_a_lens_are_found_both_ways() {
    let ball = "MaterialIndex emitter Sphere { center 0.1 0.2 -0.3  radius 0.15 }";
    let telecentric = "OrthographicCamera { center 0 0 0.9  direction 0 0.1 -1  up 0 1 0  size 0.6  aperture 0.3  focus 0.6 }";
    let blades = LENS.replace("focus 1.2", "focus 0.7  blades 5");
    let moving = LENS.replace("focus 1.2", "focus 1.2  Motion { key 0 { }  key 1 { Translate 0.1 0 0 } }");
    let amber = "Glass amber { indexOfRefraction 1  absorption 0.5 0.5 0.5 }";
    let immersed = room(LENS, ball, "MaterialIndex amber Box { min -0.9 -0.9 -0.9  max 0.9 0.9 0.99 }")
        .replace("Materials {", &format!("Materials {{ {amber}"));
    let upwards = room(&LENS.replace("0 -0.2 -1", "0 0.4 -1"), CEILING, "");
    // A sky of one colour is not drawn, so it has one way only.
    let sun = format!(
        "{LENS} Lights {{ DirectionalLight {{ direction 0 0.1 1  irradiance 1 1 1  angle 8 }} }}
         Background {{ color 0 0 0 }}"
    );
    let texts = [telecentric, &blades, &moving].map(|camera| room(camera, ball, ""));
    for text in texts.iter().chain([&upwards, &immersed, &sun]) {
        let scene = scene(text);
        let settings = BidirectionalSettings { bounces: 0, ..both() };
        let sums = ways(&scene, settings, 3000 * effort());
        let all = estimate(&sums.weighted[2]);
        for s in 0..2 {
            assert_same(&estimate(&sums.alone[2][s]), &all, &format!("{s} from the light\n{text}"));
        }
    }
}

#[test]
fn all_ways_of_an_emissive_ball_are_one() {
    let ball = "MaterialIndex emitter Sphere { center 0.2 0.3 -0.2  radius 0.4 }";
    check_ways(&room(WIDE, ball, ""), 1, 2000);
}

#[test]
fn all_ways_over_gold_and_frosted_glass_are_one() {
    let things = "MaterialIndex gold Sphere { center -0.5 -0.5 -0.3  radius 0.4 }
                  MaterialIndex frosted Sphere { center 0.4 -0.6 -0.2  radius 0.35 }";
    check_ways(&room(WIDE, CEILING, things), 1, 4000);
}

#[test]
fn all_ways_over_shading_normals_are_one() {
    let mesh = "Transform { Translate 0 -0.4 -0.2 YRotate 20 UniformScale 0.6 TriangleMesh { file gem.obj smooth on } }";
    check_ways(&room(WIDE, CEILING, &format!("MaterialIndex white {mesh}")), 1, 4000);
    check_ways(&room(WIDE, CEILING, &format!("MaterialIndex gold {mesh}")), 1, 8000);
}

/// Light passes one boundary on its way, where radiance is divided by the squared index and power is not.
#[test]
fn all_ways_out_of_frosted_glass_are_one() {
    let emitter = "MaterialIndex emitter Sphere { center 0.1 0.1 -0.2  radius 0.3 }
                MaterialIndex frosted Sphere { center 0.1 0.1 -0.2  radius 0.5 }";
    check_ways(&room(WIDE, emitter, ""), 0, 4000);
}

/// A technique evaluated alone finds the light, and has the weights, that it has among all.
#[test]
fn a_technique_alone_finds_what_it_finds_among_all() {
    let lens = "PerspectiveCamera { center 0 0 -0.9  direction 0 -0.1 1  up 0 1 0  angle 50  aperture 0.05  focus 1.5 }";
    let quad = "MaterialIndex emitter Quad { corner -0.3 0.95 -0.3 edge1 0.6 0 0 edge2 0 0 0.6 }";
    let glossy = room(lens, quad, "MaterialIndex gold Sphere { center 0.2 -0.5 0.3 radius 0.4 }");
    let fog = glossy
        .replace("Materials {", "Media { Medium air { sigma_s 0.3  sigma_a 0.1 } exterior air } Materials {");
    for text in [&glossy, &fog] {
        let scene = scene(text);
        match scene.has_media() {
            false => technique_alone::<NoMedia>(&scene),
            true => technique_alone::<WithMedia>(&scene),
        }
    }
}

fn technique_alone<'a, V: Volume<'a>>(scene: &'a Scene) {
    let settings = BidirectionalSettings { bounces: 2, ..both() };
    let it = Bidirectional::<V>::made(&scene.output.camera, scene, settings, [1, 1], LayerSet::of(&[]));
    let samples = 256;
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    let mut path = Vec::new();
    // By technique: among all, and alone.
    let mut sums = vec![[[0.0; BATCHES as usize]; 2]; 36];
    for batch in 0..BATCHES {
        let mut ctx = SampleContext::new(&sampler, 0);
        for k in 0..samples {
            let place = ctx.begin([0, batch], k);
            let mut rays = Counting::default();
            let mut take = |which: usize, expected: Option<VertexCounts>, found: &Contribution| {
                let VertexCounts { s, t } = found.technique;
                assert!(expected.is_none_or(|expected| expected == VertexCounts { s, t }));
                let outside = |raster: Vec2| raster.min_element() < 0.0 || raster.max_element() >= 1.0;
                if !found.raster.is_some_and(outside) {
                    let value = f64::from(found.light[0] * found.weight) / f64::from(samples);
                    sums[(6 * s + t) as usize][which][batch as usize] += value;
                }
            };
            let all = &mut |found: Contribution, _: &Wavelengths| take(0, None, &found);
            it.estimate(ctx.draws, &mut rays, place, &mut path, AllTechniques(None), all);
            for points in 2..=5 {
                for technique in (0..points).map(|s| VertexCounts { s, t: points - s }) {
                    let alone = &mut |found: Contribution, _: &Wavelengths| take(1, Some(technique), &found);
                    it.estimate(ctx.draws, &mut rays, place, &mut path, technique, alone);
                }
            }
        }
    }
    let mut compared = 0;
    for (technique, [all, alone]) in sums.iter().enumerate() {
        let [all, alone] = [all, alone].map(|sums| estimate(sums));
        if all.mean > 0.0 && all.standard_error.max(alone.standard_error) < 0.2 * all.mean {
            assert_same_within(&alone, &all, 0.3, &format!("s = {}, t = {}", technique / 6, technique % 6));
            compared += 1;
        }
    }
    assert!(compared >= 8, "{compared} techniques have light");
}
