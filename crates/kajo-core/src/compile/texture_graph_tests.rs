//! Textures that have names: what they are made of, and what is said where they cannot be.

use kajo_color::Wavelengths;
use kajo_math::pattern::{
    Brick, Clouds, Octaves, Onion, SolidPattern, TurbulentWarp, Wave, Worley, WorleyValue,
};
use kajo_math::{Affine3, Vec2, Vec3};
use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

use super::blocks::TEXTURES;
use super::{CompileOptions, compile};
use crate::material::Material;
use crate::scene::Scene;
use crate::texture::{
    AnyTexture, ColorTexture, FloatTexture, SurfaceUv, TextureContext, TextureFootprint, TextureSlope,
};

fn compiled(textures: &str, materials: &str) -> Result<Scene, Vec<String>> {
    let text = format!(
        "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
         Textures {{ {textures} }} Materials {{ {materials} }}
         Group {{ MaterialIndex 0 Sphere {{ center 0 0 0 radius 1 }} }}"
    );
    let mut parsed = SceneDesc::parse_str(&text);
    let (assets, mut said) = (MemoryAssets::new(), Diagnostics::default());
    let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut said);
    let lines = || {
        said.iter()
            .map(|d| format!("{} / {}", d.message, d.help.as_deref().unwrap_or("")))
            .collect::<Vec<_>>()
    };
    scene.filter(|_| said.iter().next().is_none()).ok_or_else(lines)
}

/// The scene of a texture `t`, which is the colour of its first material, and the bump of its second.
struct Shown {
    scene: Scene,
    color: ColorTexture,
    heights: FloatTexture,
}

fn shown(textures: &str) -> Shown {
    let materials = "Matte { color t } Matte { bump t { height 1 } }";
    let scene = compiled(textures, materials).unwrap_or_else(|said| panic!("{textures}: {said:?}"));
    let textures = scene.appearance.materials.mattes[0].textures();
    let color = textures.into_iter().find_map(|texture| match texture {
        AnyTexture::Color(color) => Some(color.clone()),
        AnyTexture::Float(_) => None,
    });
    let color = color.expect("a colour");
    let crate::material::Relief::Heights { heights, .. } = scene.appearance.materials.embossed[0].relief
    else {
        panic!("heights")
    };
    Shown { scene, color, heights }
}

impl Shown {
    fn at(&self, at: &TextureContext) -> f32 {
        self.heights.at(self.scene.appearance.textures.evaluator(at))
    }

    fn value(&self, p: Vec3) -> f32 {
        self.at(&context(p))
    }

    fn rgb(&self, p: Vec3) -> [f32; 3] {
        let at = context(p);
        let rgb = self.color.at(self.scene.appearance.textures.evaluator(&at), &Wavelengths::RGB);
        rgb.to_rgb()
    }

    fn slope(&self, at: &TextureContext) -> TextureSlope {
        self.heights.slope(self.scene.appearance.textures.evaluator(at), 1.0)
    }
}

fn context(p: Vec3) -> TextureContext {
    let uv = SurfaceUv::from(Vec2::new(0.31 * p.x + 0.2 * p.z, 0.23 * p.y - 0.11 * p.x));
    let n = Vec3::new(0.48, -0.6, 0.64);
    TextureContext { p, uv, n, ..TextureContext::default() }
}

fn points() -> impl Iterator<Item = Vec3> {
    (0..60).map(|i| {
        let s = kajo_math::rng::Stream::new(8, [i, 0], 0);
        6.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 3.0
    })
}

#[test]
fn patterns_are_placed_sized_and_warped() {
    let clouds = SolidPattern::new(Clouds(Octaves { count: 3, gain: 0.6, lacunarity: 2.5, seed: 4 }));
    let text = "Clouds t { octaves 3  gain 0.6  lacunarity 2.5  seed 4  size 0.5
                Transform { Translate 1 2 3  UniformScale 2 } }";
    let (placed, warped) = (shown(text), shown("Onion t { wave saw  warp 0.25  warpOctaves 3  size 2 }"));
    let onion = SolidPattern::new(Onion { wave: Wave::Saw, ..Onion::default() });
    let warp = TurbulentWarp { amount: Vec3::splat(0.25), octaves: 3, ..TurbulentWarp::default() };
    for p in points() {
        let own = (p - Vec3::new(1.0, 2.0, 3.0)) / 2.0 / 0.5;
        assert!((placed.value(p) - clouds.at(own, 0.0)).abs() < 1e-4, "{p}");
        let [r, g, b] = placed.rgb(p);
        assert!(r == g && g == b && (r - placed.value(p)).abs() < 1e-6, "a number is a grey");
        assert_eq!(warped.value(p), onion.at(warp.moved(p / 2.0, 0.0), 0.0));
    }
}

#[test]
fn textures_are_made_of_others_in_any_order() {
    let others = "Formula t { texture a texture b texture 0.5  function = x * y + z }
                  Crackle b { size 2 } Clouds a { octaves 2 }";
    let formula = shown(others);
    let a = SolidPattern::new(Clouds(Octaves { count: 2, ..Octaves::default() }));
    let b = SolidPattern::new(Worley { value: WorleyValue::Crackle, ..Worley::default() });
    let mut sums = 0;
    for p in points() {
        let (a, b) = (a.at(p, 0.0), b.at(p / 2.0, 0.0));
        let near =
            |found: f32, expected: f32| assert!((found - expected).abs() < 1e-6, "{p}: {found} {expected}");
        near(formula.value(p), (a * b + 0.5).min(1.0));
        sums += u32::from(a + b > 1.0);
    }
    assert!(sums > 0);
    let of = |block: &str| shown(&format!("{block} Crackle b {{ size 2 }} Clouds a {{ octaves 2 }}"));
    let [blend, product, sum] = [
        of("Blend t { texture a texture b  amount a }"),
        of("Multiply t { texture a texture b texture b }"),
        of("Add t { texture a texture b }"),
    ];
    let [curve, threshold] = [
        of("Curve t { texture a  stop 0 0.2  stop 0.5 1  stop 1 0 }"),
        of("Threshold t { texture a  edge 0.4 }"),
    ];
    for p in points() {
        let (a, b) = (a.at(p, 0.0), b.at(p / 2.0, 0.0));
        let near =
            |found: f32, expected: f32| assert!((found - expected).abs() < 1e-6, "{p}: {found} {expected}");
        near(blend.value(p), (1.0 - a) * a + a * b);
        near(product.value(p), a * b * b);
        near(sum.value(p), (a + b).min(1.0));
        near(curve.value(p), if a < 0.5 { 0.2 + 1.6 * a } else { 2.0 - 2.0 * a });
        near(threshold.value(p), f32::from(u8::from(a >= 0.4)));
    }
}

#[test]
fn ramps_have_their_colours() {
    let ramp = |rest: &str| shown(&format!("Ramp t {{ texture g {rest} }} Gradient g {{ wave once }}"));
    let two = "stop 0.25 1 0 0  stop 0.75 0 0 1";
    let near = |found: [f32; 3], expected: [f32; 3]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} {expected:?}");
    };
    let at = |shown: &Shown, x: f32| shown.rgb(Vec3::new(x, 0.3, 0.2));
    near(at(&ramp(two), 0.1), [1.0, 0.0, 0.0]);
    near(at(&ramp(two), 0.375), [0.75, 0.0, 0.25]);
    near(at(&ramp(&format!("interpolation smooth {two}")), 0.375), [0.84375, 0.0, 0.15625]);
    near(at(&ramp(&format!("interpolation step {two}")), 0.74), [1.0, 0.0, 0.0]);
    // Twice through, begun half way.
    near(at(&ramp(&format!("frequency 2  phase 0.5 {two}")), 0.5), [0.5, 0.0, 0.5]);
    let oklab = ramp(&format!("interpolation oklab {two}"));
    near(at(&oklab, 0.9), [0.0, 0.0, 1.0]);
    let [r, g, b] = at(&oklab, 0.5);
    let expected = kajo_color::oklab::to_rgb(std::array::from_fn(|i| {
        let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]].map(kajo_color::oklab::from_rgb);
        0.5 * (red[i] + blue[i])
    }));
    near([r, g, b], expected);
    let colours = shown(
        "Multiply t { texture r texture 0.5 1 0.25 } Ramp r { texture g stop 0 1 0.5 0.5 } Onion g { }",
    );
    near(colours.rgb(Vec3::ONE), [0.5, 0.5, 0.125]);
    let blend = shown("Blend t { texture 1 0 0  texture 0 1 0  amount g } Gradient g { wave once }");
    near(blend.rgb(Vec3::new(0.25, 5.0, 0.0)), [0.75, 0.25, 0.0]);
    // As a number a colour is as light as it is.
    assert!((blend.value(Vec3::new(1.5, 0.0, 0.0)) - 0.715_169).abs() < 1e-5);
}

#[test]
fn projections_lay_textures_on_sheets() {
    let flat = SolidPattern::new(Brick::default());
    let of = |projection: &str| shown(&format!("Brick t {{ size 0.25  projection {projection} }}"));
    let tau = std::f32::consts::TAU;
    let [uv, planar, spherical, cylindrical, cubic, camera, triplanar] =
        ["uv", "planar", "spherical", "cylindrical", "cubic", "camera angle 60", "triplanar"].map(of);
    for p in points() {
        let at = context(p);
        let on = |v: Vec2| flat.at((v / 0.25).extend(0.0), 0.0);
        let round = 0.5 + p.x.atan2(p.z) / tau;
        // Where an edge is so near that rounding decides, nothing is said.
        let agree = |shown: &Shown, v: Vec2| {
            let sure = [-1e-4, 1e-4]
                .iter()
                .all(|&e| on(v + Vec2::splat(e)) == on(v) && on(v + Vec2::new(e, -e)) == on(v));
            assert!(!sure || shown.at(&at) == on(v), "{p} {v}");
        };
        agree(&uv, at.uv.first);
        agree(&planar, p.truncate());
        agree(&spherical, Vec2::new(round, 0.5 + (p.y / p.length()).asin() / (0.5 * tau)));
        agree(&cylindrical, Vec2::new(round, p.y));
        // The normal of all of them is nearest to +z.
        agree(&cubic, Vec2::new(p.x, p.y));
        let tan_half = (tau / 12.0).tan();
        agree(&camera, Vec2::splat(0.5) - 0.5 * p.truncate() / (p.z * tan_half));
        let n = at.n;
        let weights = (n * n) * (n * n) / ((n * n) * (n * n)).element_sum();
        let sheets = [Vec2::new(-p.z, p.y), Vec2::new(p.x, p.z), Vec2::new(p.x, p.y)];
        let mean: f32 = (0..3).map(|i| weights[i] * on(sheets[i])).sum();
        assert!((triplanar.at(&at) - mean).abs() < 1e-4, "{p}");
    }
}

/// Slopes are what differences over the world and over surface coordinates say, for every operation and projection.
#[test]
fn slopes_are_derivatives() {
    let clouds = "Clouds c { octaves 2  size 1.5 } Onion o { wave sine  size 4 }";
    let mut graphs = vec![
        "Blend t { texture c texture o  amount c }".to_owned(),
        "Multiply t { texture c texture o texture c }".to_owned(),
        "Formula t { texture c texture o  function = 0.3 * x + sin(y) * 0.3 }".to_owned(),
        "Curve t { texture c  interpolation smooth  stop -1 0  stop 2 1 }".to_owned(),
        "Placed t { texture c  Transform { XRotate 30  Scale 1 3 0.7 } }".to_owned(),
        "Placed t { texture c  warp 0.2  warpOctaves 1 }".to_owned(),
        "Ramp t { texture c  stop 0 0 0 0.2  stop 1 1 0.7 0.1 }".to_owned(),
    ];
    for projection in ["uv", "planar", "cylindrical", "cubic", "triplanar"] {
        graphs.push(format!("Placed t {{ texture c  size 0.7  projection {projection} }}"));
        graphs.push(format!("Placed t {{ texture c  size 0.7  space object  projection {projection} }}"));
    }
    graphs.push("Placed t { texture c  space object  Transform { XRotate 30  Scale 1 3 0.7 } }".to_owned());
    for graph in graphs {
        let shown = shown(&format!("{graph} {clouds}"));
        for p in points() {
            let object_from_world =
                Affine3::from_rotation_z(0.6) * Affine3::from_scale(Vec3::new(0.5, 0.8, 1.2));
            let at = TextureContext { object_from_world, ..context(p) };
            let TextureSlope { uv, p: slope } = shown.slope(&at);
            let h = 2e-3;
            let by = |step: Vec3| {
                let moved = |s: f32| TextureContext { p: p + s * step, ..at };
                (shown.at(&moved(h)) - shown.at(&moved(-h))) / (2.0 * h)
            };
            let expected = Vec3::new(by(Vec3::X), by(Vec3::Y), by(Vec3::Z));
            assert!((slope - expected).length() < 0.02, "{graph} at {p}: {slope} {expected}");
            let by = |step: Vec2| {
                let moved = |s: f32| TextureContext { uv: at.uv.moved(s * step), ..at };
                (shown.at(&moved(h)) - shown.at(&moved(-h))) / (2.0 * h)
            };
            let expected = Vec2::new(by(Vec2::X), by(Vec2::Y));
            assert!((uv - expected).length() < 0.03, "{graph} at {p}: {uv} {expected}");
        }
    }
}

#[test]
fn filters_fade_what_is_too_fine() {
    let (sharp, faded) = (shown("Clouds t { size 0.01 }"), shown("Clouds t { size 0.01  filter on }"));
    assert!(!sharp.scene.appearance.has_filters && faded.scene.appearance.has_filters);
    let (x, y) = (0.02 * Vec3::X, 0.01 * Vec3::Y);
    let footprint = TextureFootprint { p: [x, y], ..TextureFootprint::POINT };
    let values = |shown: &Shown| {
        points().map(|p| shown.at(&TextureContext { footprint, ..context(p) })).collect::<Vec<_>>()
    };
    assert!(values(&faded).windows(2).all(|pair| pair[0] == pair[1]));
    assert!(values(&sharp).windows(2).any(|pair| (pair[0] - pair[1]).abs() > 0.1));
    assert_eq!(faded.value(Vec3::ONE), sharp.value(Vec3::ONE), "a point covers nothing");
}

/// With a footprint a number is a mean, whatever stands between the pattern and the threshold; at a point nothing is different.
#[test]
fn thresholds_average_over_footprints() {
    let graphs = [
        "Threshold t { texture s }  Gradient s { wave once  filter on }",
        "Threshold t { texture m  edge 0.3 }  Multiply m { texture s texture 0.6 }  Gradient s { wave once  filter on }",
        "Curve t { texture m  interpolation step  stop 0 1  stop 0.5 0 }  Blend m { texture 1 texture 0 amount s }
         Gradient s { wave once  filter on }",
        "Threshold t { texture f }  Formula f { texture s  function = x }  Placed s { texture p  size 0.5 }
         Gradient p { wave once  size 2  filter on }",
        "Threshold t { texture c }  Ramp c { texture s  stop 0 0 0 0  stop 1 1 1 1 }  Gradient s { wave once  filter on }",
        "Threshold t { texture h }  Threshold h { texture s  softness 1 }  Gradient s { wave once  filter on }",
    ];
    // The number s is x: from -w/2 to w/2 around it a share of (x - 1/2 + w/2) / w is more than 1/2.
    const W: f32 = 0.2;
    let footprint = TextureFootprint { p: [W * Vec3::X, 0.7 * Vec3::Y], ..TextureFootprint::POINT };
    for graph in graphs {
        let shown = shown(graph);
        let plain = self::shown(&graph.replace("filter on", "filter off"));
        for x in [0.1, 0.39, 0.42, 0.47, 0.5, 0.53, 0.59, 0.61, 0.9] {
            let at = context(Vec3::new(x, 0.2, 0.3));
            let found = shown.at(&TextureContext { footprint, ..at });
            let expected = ((x - 0.5) / W + 0.5).clamp(0.0, 1.0);
            assert!((found - expected).abs() < 0.05, "{graph} at {x}: {found} {expected}");
            assert_eq!(shown.at(&at).to_bits(), plain.at(&at).to_bits());
            let unfiltered = plain.at(&TextureContext { footprint, ..at });
            assert_eq!(unfiltered.to_bits(), plain.at(&at).to_bits(), "nothing is filtered");
        }
    }
    // Half of all cells are 1, seen from afar.
    let wide = TextureFootprint { p: [5.0 * Vec3::X, 5.0 * Vec3::Y], ..TextureFootprint::POINT };
    let checks = shown(
        "Ramp t { texture c  interpolation step  stop 0 0.2 0.2 0.2  stop 0.9 1 1 1 }  Checks c { filter on }",
    );
    let at = TextureContext { footprint: wide, ..context(Vec3::new(0.3, 0.4, 0.5)) };
    let rgb = checks.color.at(checks.scene.appearance.textures.evaluator(&at), &Wavelengths::RGB).to_rgb();
    assert!((rgb[0] - 0.6).abs() < 0.02, "{rgb:?}");
}

#[test]
fn every_texture_is_finite_everywhere() {
    for member in TEXTURES {
        let keyword = member.block.keyword;
        let made_of = member.block.fields().filter(|field| field.key == "texture").count().min(3);
        let rest = match keyword {
            "Ramp" => "stop 0 0 0 0  stop 1 1 0.5 0.25",
            "Curve" => "stop 0 0.25",
            "Formula" => "function = x / y + ln(z)",
            _ => "",
        };
        let text = format!("{keyword} t {{ {} {rest} }} Onion o {{ }}", "texture o ".repeat(made_of));
        let shown = shown(&text);
        let huge = [0.0, -0.0, 1e-40, 1e7, -1e20, f32::MAX, f32::INFINITY, f32::NAN];
        for p in huge.into_iter().flat_map(|v| [Vec3::splat(v), Vec3::new(v, 1.0, 0.5)]) {
            let (value, rgb) = (shown.value(p), shown.rgb(p));
            assert!((0.0..=1.0).contains(&value), "{keyword} at {p}: {value}");
            assert!(rgb.iter().all(|v| (0.0..=1.0).contains(v)), "{keyword} at {p}: {rgb:?}");
        }
    }
}

#[test]
fn named_textures_stand_in_place_of_light_and_classic_colours() {
    let scene = compiled(
        "Ramp red { texture o  stop 0 1 0 0 } Onion o { }",
        "Material { diffuseColor red  exponent o { range 5 80 } } Matte { emission red 5 } Matte { emission o { light D65 3 } }
         Metal { color red  roughness o  opacity o }",
    );
    let scene = scene.unwrap_or_else(|said| panic!("{said:?}"));
    let phong = scene.appearance.phong(scene.appearance.list[0].0, &context(Vec3::ZERO));
    assert_eq!((phong.diffuse.to_rgb(), phong.exponent), ([1.0, 0.0, 0.0], 5.0));
}

#[test]
fn mistakes_are_named() {
    let error = |textures: &str| match compiled(textures, "Matte { color t }") {
        Ok(_) => panic!("accepted: {textures}"),
        Err(said) => said.join("; "),
    };
    let circle = error("Placed t { texture b } Placed b { texture c } Blend c { texture t texture 1 }");
    assert_eq!(circle, "a texture is made of itself: t -> b -> c -> t / ");
    assert_eq!(error("Multiply t { texture t texture 1 }"), "a texture is made of itself: t -> t / ");
    assert_eq!(error("Blend t { texture 1 texture 0  amount t }"), "a texture is made of itself: t -> t / ");
    assert_eq!(
        error("Clouds veil { } Placed t { texture vail }"),
        "there is no texture named `vail` / did you mean `veil`?"
    );
    assert_eq!(error("Clouds veil { }"), "there is no texture named `t` / the scene has `veil`");
    assert_eq!(error("Clouds t { } Cells t { }"), "there are two textures named `t` / ");
    assert!(error("Clouds { }").contains("`Clouds` has no name"));
    assert!(error("Clouds t.png { }").contains("`t.png` is no name of a texture"));
    let said = error("Ramp t { texture o stop 0.5 1 1 1 stop 0.25 0 0 0 } Onion o { }");
    assert_eq!(
        said,
        "this `stop` is at 0.25, before the last one at 0.5 / stops are in the order of their places"
    );
    assert!(error("Ramp t { texture o } Onion o { }").contains("there is no `stop`"));
    assert!(error("Curve t { texture o } Onion o { }").contains("there is no `stop`"));
    assert!(error("Ramp t { texture o  stop 0 2 0 0 } Onion o { }").contains("at most 1"));
    assert!(error("Ramp t { stop 0 1 0 0 }").contains("expected one `texture`, found 0"));
    assert!(error("Blend t { texture 1 }").contains("expected two `texture`, found 1"));
    assert!(error("Add t { texture 1 }").contains("expected 2 to 16 `texture`, found 1"));
    assert!(error("Clouds t { Transform { Scale 1 0 1 } }").contains("leaves a texture no space"));
    assert!(error("Clouds t { size 0 }").contains("size"));
    assert!(error("Cluods t { }").contains("did you mean `Clouds`?"));
    assert!(error("Formula t { texture 1  function = x + y }").contains("takes `y`"));
    assert!(error("Onion t { octaves 3 }").contains("unknown word `octaves`"));
    let idle = compiled("Clouds t { angle 30 lambda 3 }", "Matte { color t }").unwrap_err();
    assert_eq!(idle.len(), 2, "{idle:?}");
    let index = compiled("Clouds t { }", "Principled { indexOfRefraction t }").unwrap_err();
    assert!(index[0].contains("a texture of `indexOfRefraction` needs a `range`"), "{index:?}");
    let mut tower = "Clouds t0 { } ".to_owned();
    for i in 1..12 {
        tower += &format!("Multiply t{i} {{ texture t{0} texture t{0} }} ", i - 1);
    }
    assert!(error(&format!("{tower} Placed t {{ texture t11 }}")).contains("more than 1024 others"));
    let chain: String = (1..70).map(|i| format!("Placed t{i} {{ texture t{} }} ", i - 1)).collect();
    assert!(
        error(&format!("Clouds t0 {{ }} {chain} Placed t {{ texture t69 }}")).contains("more than 64 others")
    );
    let misplaced = compiled("Sphere { }", "Matte { }").unwrap_err();
    assert!(misplaced[0].contains("`Sphere` cannot stand in `Textures`"), "{misplaced:?}");
}
