//! `Background` and `Fog` blocks.

use std::sync::Arc;

use kajo_color::{Emission, srgb};
use kajo_image::{Decoded, Format, Image};
use kajo_math::Vec3;
use kajo_scene::{Diagnostic, Item, Params, read_limited};

use super::fields::{
    At, Direction, FileName, Keys, any_angle, at_least, between, classic_light, color, count, degrees,
    direction, file, flag, keys, number, report_beside, report_without,
};
use super::picture_files::read_picture;
use super::spectra::Written;
use super::{Compiler, fields};
use crate::background::{Background, CubeMap, FACE_NAMES};
use crate::daylight::{Sky, SkySettings};
use crate::environment::Environment;
use crate::ids::LightGroup;
use crate::medium::Fog;
use crate::schema::{Block, Kind};
use crate::star_field::{Star, StarDraw, StarField, parse_stars};

/// The colour of a background of which nothing is said.
const GREY: [f32; 3] = [0.5; 3];

keys! {
    BackgroundKeys<'t> {
        color: Written<Emission> = classic_light("color").or(GREY, "what rays see that hit nothing"),
        ambient: Vec3 =
            color("ambientLight").or([0.0; 3], "light from everywhere, of the classic integrator"),
        environment: Option<At<'t, FileName>> = file("environment")
            .not_beside(&["cubeMap"])
            .placed()
            .option("a picture of longitude and latitude"),
        rotate: f32 = any_angle("rotate").only_beside("environment").or(0.0, "turns the picture"),
        scale: f32 =
            at_least("scale", 0.0).only_beside("environment").or(1.0, "makes the picture brighter"),
        cube_map: Option<At<'t, FileName>> = file("cubeMap")
            .not_beside(&["environment"])
            .placed()
            .option("a folder of six pictures"),
        group: Option<LightGroup> = fields::GROUP,
    }
}

pub(super) const BLOCK: Block = Block {
    keyword: "Background",
    kind: Kind::Background,
    about: "what rays see that hit nothing",
    groups: &[BackgroundKeys::FIELDS],
    parts: &[&SKY, &STARS],
};

keys! {
    SkyKeys {
        turbidity: f32 = between("turbidity", 2.0, 10.0).or(3.0, "haze"),
        elevation: f32 = degrees("elevation", 0.0, 90.0).or(45.0, "of the sun over the horizon"),
        azimuth: f32 = any_angle("azimuth").or(135.0, "of the sun"),
        ground: f32 = between("ground", 0.0, 1.0).or(0.2, "reflectance of the ground"),
        scale: f32 = at_least("scale", 0.0).or(1.0, "makes it brighter"),
        sun: bool = flag("sun").or(true, "with the sun itself"),
    }
}

pub(super) const SKY: Block = Block {
    keyword: "sky",
    kind: Kind::Part,
    about: "a clear sky with its sun, within a `Background`",
    groups: &[SkyKeys::FIELDS],
    parts: &[],
};

keys! {
    FogKeys {
        color: Vec3 = color("color").required("its colour"),
        density: f32 = at_least("density", 0.0)
            .unit("1/length")
            .required("how much hides what lies a unit away"),
        falloff: f32 =
            at_least("heightFalloff", 0.0).unit("1/length").or(0.0, "how fast it thins with height"),
        height: f32 = number("height").unit("length").or(0.0, "where the density is the one given"),
    }
}

keys! {
    StarKeys<'t> {
        count: Option<At<'t, u32>> = count("count", 1, 10_000_000)
            .placed()
            .not_beside(&["catalog"])
            .unlike("9000", "9000", "how many are strewn over the sky"),
        seed: u32 = count("seed", 0, 999_999_999).or(0, "chooses one of many skies"),
        faintest: f32 = between("faintest", -5.0, 25.0).or(6.5, "magnitude of the faintest ones that are strewn"),
        galaxy: f32 = between("galaxy", 0.0, 1.0).or(0.4, "the share of those that lies in a band around the sky"),
        pole: Direction = direction("pole").or([0.5, 1.0, 0.25], "perpendicular to that band"),
        catalog: Option<At<'t, FileName>> = file("catalog")
            .placed()
            .not_beside(&["count"])
            .option("a table in their place: right ascension, declination, magnitude, temperature"),
        radius: f32 = degrees("radius", 1e-4, 5.0).or(0.04, "how large each is"),
        pixels: f32 = between("pixelRadius", 0.0, 8.0).unit("pixels")
            .or(1.5, "no star is seen smaller than that; 0 for stars of their own size"),
        scale: f32 = at_least("scale", 0.0).or(1.0, "makes them brighter; 1 for lux"),
    }
}

pub(super) const STARS: Block = Block {
    keyword: "stars",
    kind: Kind::Part,
    about: "stars before whatever else a `Background` is",
    groups: &[StarKeys::FIELDS],
    parts: &[],
};

/// The most bytes of a catalogue of stars.
const LARGEST_CATALOG: u64 = 1 << 28;

pub(super) const FOG: Block = Block {
    keyword: "Fog",
    kind: Kind::Fog,
    about: "what fills the air, for the classic integrator",
    groups: &[FogKeys::FIELDS],
    parts: &[],
};

impl Compiler<'_> {
    /// Background and ambient light.
    pub(super) fn background(&mut self, item: Option<Item<'_>>) {
        let read = item.and_then(|item| {
            let keys = self.read_keys(item, |params, sources| {
                if !params.contains("environment") {
                    report_without(params, BackgroundKeys::FIELDS, "environment");
                }
                let keys = BackgroundKeys::read(params, sources)?;
                let sky = params.block(SKY.keyword);
                check_pictures(params, &keys, sky);
                Some((keys, sky, params.block(STARS.keyword)))
            });
            keys.map(|(keys, sky, stars)| (keys, [sky, stars], item.head_span()))
        });
        let Some((keys, [sky, stars], at)) = read else {
            return self.scene.surround(LightGroup::default(), Background::constant(GREY));
        };
        let BackgroundKeys { color, ambient, environment, rotate, scale, cube_map, group } = keys;
        let picture = match (sky, environment, cube_map) {
            (Some(item), ..) => self.sky(item).map(Background::Sky),
            (None, Some(file), _) => self.environment(&file, rotate, scale).map(Background::Environment),
            (None, None, Some(folder)) => {
                self.cube_map(folder.item, &folder.value.0).map(Background::CubeMap)
            }
            (None, None, None) => None,
        };
        let plain = || Background::Constant { color: color.rgb, emission: color.value };
        let behind = picture.unwrap_or_else(plain);
        let around = match stars.and_then(|item| self.stars(item)) {
            Some(stars) => Background::Starry { behind: Box::new(behind), stars },
            None => behind,
        };
        let set = self.scene.background_in(group.unwrap_or_default(), around);
        self.accepted(set, at);
        self.scene.ambient(ambient.into());
    }

    fn sky(&mut self, item: Item<'_>) -> Option<Box<Sky>> {
        let keys = self.read_keys(item, SkyKeys::read)?;
        let settings = SkySettings {
            turbidity: keys.turbidity,
            elevation_deg: keys.elevation,
            azimuth_deg: keys.azimuth,
            ground: keys.ground,
            scale: keys.scale,
            sun: keys.sun,
        };
        Some(Box::new(Sky::new(&settings)))
    }

    fn stars(&mut self, item: Item<'_>) -> Option<Arc<StarField>> {
        let keys = self.read_keys(item, |params, sources| {
            if params.contains("catalog") {
                report_beside(params, StarKeys::FIELDS, "catalog");
                params.idle(&["seed", "faintest", "galaxy", "pole"], "beside a `catalog`");
            }
            StarKeys::read(params, sources)
        })?;
        let StarKeys { count, seed, faintest, galaxy, pole, catalog, radius, pixels, scale } = keys;
        let count = count.map_or(9000, |count| count.value);
        let stars = match &catalog {
            Some(file) => self.star_catalog(file)?,
            None => {
                self.room_for_stars(item, u64::from(count))?;
                StarDraw { count, seed, faintest, galaxy, pole: pole.0 }.stars()
            }
        };
        Some(Arc::new(StarField::new(&stars, radius.to_radians(), scale).at_least(pixels)))
    }

    /// The stars of a table; why it has none is reported.
    fn star_catalog(&mut self, file: &At<'_, FileName>) -> Option<Vec<Star>> {
        let At { value: FileName(name), item } = file;
        let opened = self.assets.open(name, item.path());
        let bytes =
            opened.and_then(|file| read_limited(file, LARGEST_CATALOG)).map_err(|error| error.to_string());
        let text = bytes.and_then(|bytes| String::from_utf8(bytes).map_err(|_| "it is not text".to_owned()));
        let stars = text.and_then(|text| parse_stars(&text).map_err(|error| error.to_string()));
        let report = |reason| {
            let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
            self.diagnostics.push(error.label(item.head_span(), "named here"));
        };
        let stars = stars.map_err(report).ok()?;
        self.room_for_stars(*item, stars.len() as u64)?;
        Some(stars)
    }

    /// Takes memory for stars, and for the lists by which they are found; that there is none is reported.
    fn room_for_stars(&mut self, item: Item<'_>, count: u64) -> Option<()> {
        let bytes = 3 * count * size_of::<Star>() as u64;
        let room = self.options.limits.memory.take(bytes).map_err(|over| over.to_string());
        let report = |message: String| {
            self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "too many stars"));
        };
        room.map_err(report).ok()
    }

    /// * `rotate`: in degrees
    fn environment(&mut self, file: &At<'_, FileName>, rotate: f32, scale: f32) -> Option<Box<Environment>> {
        let At { value: FileName(name), item } = file;
        let mut picture = self.decoded(*item, name, None)?;
        // Whole numbers are for screens, and floats are light.
        if picture.depth.is_some() {
            picture.image.data_mut().iter_mut().for_each(|v| *v = srgb::decode(*v));
        }
        let (environment, unusable) = Environment::new(&picture.image, scale, rotate);
        if unusable > 0 {
            let message = format!("{unusable} pixels of `{name}` are negative or no numbers");
            let warning = Diagnostic::warning(message).label(item.head_span(), "they are black now");
            self.diagnostics.push(warning);
        }
        Some(Box::new(environment))
    }

    fn cube_map(&mut self, item: Item<'_>, folder: &str) -> Option<Box<CubeMap>> {
        let faces = FACE_NAMES
            .map(|face| self.picture(item, &format!("{}/{face}.png", folder.trim_end_matches('/'))));
        let [right, left, up, down, front, back] = faces;
        let back = if self.rules.mirrors_back_face { mirrored(&back?) } else { back? };
        Some(Box::new(CubeMap::new([right?, left?, up?, down?, front?, back])))
    }

    /// Reads a picture that the scene names.
    pub(super) fn picture(&mut self, item: Item<'_>, name: &str) -> Option<Image> {
        self.decoded(item, name, Some(Format::Png)).map(|decoded| decoded.image)
    }

    fn decoded(&mut self, item: Item<'_>, name: &str, hint: Option<Format>) -> Option<Decoded> {
        /// Memory for what is kept of a pixel: its colour, and how bright it is, for lights to be chosen by.
        const BYTES_PER_PIXEL: u64 = 3 * 4 + 4 * 4;
        let (limit, memory) = (self.options.limits.picture_bytes, &self.options.limits.memory);
        let file = self.assets.open(name, item.path()).map_err(|error| error.to_string());
        let kept = |picture: &Decoded| {
            let pixels = u64::from(picture.image.width()) * u64::from(picture.image.height());
            size_of_val(picture.image.data()) as u64 + pixels * BYTES_PER_PIXEL
        };
        let read = file.and_then(|file| read_picture(file, hint, limit, memory)).and_then(|picture| {
            memory.take(kept(&picture)).map_err(|over| over.to_string())?;
            Ok(picture)
        });
        match read {
            Ok(picture) => Some(picture),
            Err(reason) => {
                let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
                self.diagnostics.push(error.label(item.head_span(), "named here"));
                None
            }
        }
    }

    /// The fog of the scene.
    pub(super) fn fog(&mut self, item: Item<'_>) {
        if let Some(FogKeys { color, density, falloff, height }) = self.read_keys(item, FogKeys::read) {
            self.scene.fog(Fog { color: color.into(), density, falloff, height });
        }
    }
}

/// Reports more than one picture of all directions, and a colour that none of it is seen of.
fn check_pictures(params: &mut Params<'_, '_>, keys: &BackgroundKeys<'_>, sky: Option<Item<'_>>) {
    let [cube_map, environment] =
        [&keys.cube_map, &keys.environment].map(|file| file.as_ref().map(|at| at.item));
    let second = [cube_map, environment, sky].into_iter().flatten().nth(1);
    if let Some(second) = second {
        let error = Diagnostic::error("a background is one of `cubeMap`, `environment` and `sky`");
        params.diagnostics().push(error.label(second.head_span(), "one too many"));
    } else if environment.is_some() || sky.is_some() {
        // Scenes of the classic format have a colour beside their cube map.
        params.idle(&["color"], "beside an `environment` or a `sky`");
    }
}

/// A picture with left and right exchanged.
fn mirrored(image: &Image) -> Image {
    let mut result = image.clone();
    let channels = image.channels();
    for y in 0..image.height() {
        let turned = image.row(y).chunks_exact(channels).rev();
        result
            .row_mut(y)
            .chunks_exact_mut(channels)
            .zip(turned)
            .for_each(|(to, from)| to.copy_from_slice(from));
    }
    result
}

#[cfg(test)]
mod tests {
    use kajo_color::{Emission, Wavelengths};
    use kajo_image::{EncodeOptions, Format, Image, encode};
    use kajo_math::Vec3;
    use kajo_scene::{Diagnostics, Limits, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};
    use crate::scene::Scene;

    /// The scene with this background, and everything said about it.
    fn compiled(background: &str) -> (Option<Scene>, Vec<String>) {
        let file = |value: f32, format| {
            let picture = Image::filled(4, 2, &[value, 0.5, 0.25]).unwrap();
            encode(&picture, format, &EncodeOptions::default()).unwrap()
        };
        let assets = MemoryAssets::new()
            .with("sky.exr", file(2.0, Format::Exr))
            .with("sky.png", file(1.0, Format::Png))
            .with("dark.pfm", file(-1.0, Format::Pfm))
            .with("text.exr", "no picture")
            .with("one.txt", "0 0 0 9600")
            .with("bad.txt", "0 0 0\n0 100 0");
        compiled_within(Limits::default(), background, &assets)
    }

    fn compiled_within(
        limits: Limits,
        background: &str,
        assets: &MemoryAssets,
    ) -> (Option<Scene>, Vec<String>) {
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
        let options = CompileOptions { limits, ..CompileOptions::default() };
        let mut parsed = SceneDesc::parse_str(&format!("{camera} Background {{ {background} }}"));
        let mut diagnostics = Diagnostics::default();
        let scene = compile(&mut parsed.desc, assets, &options, &mut diagnostics);
        (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
    }

    fn color(background: &str) -> [f32; 3] {
        let (scene, said) = compiled(background);
        let scene = scene.unwrap_or_else(|| panic!("{background}: {said:?}"));
        scene.lighting.background.color(Vec3::new(0.3, 0.2, -1.0)).to_rgb()
    }

    #[test]
    fn backgrounds_are_colours_lights_or_pictures() {
        let near = |a: [f32; 3], b: [f32; 3]| assert!(Vec3::from(a).distance(b.into()) < 1e-3, "{a:?} {b:?}");
        near(color(""), [0.5; 3]);
        near(color("color 0.1 0.2 0.3"), [0.1, 0.2, 0.3]);
        near(color("color blackbody 2500 0.3"), Emission::blackbody(2500.0).scaled(0.3).rgb());
        near(color("environment sky.exr"), [2.0, 0.5, 0.25]);
        near(color("environment sky.exr rotate 400 scale 2"), [4.0, 1.0, 0.5]);
        // Whole numbers are values of a screen.
        near(color("environment sky.png"), [1.0, 0.2159, 0.0513]);
    }

    #[test]
    fn pictures_have_the_same_colour_as_spectra() {
        let scene = compiled("environment sky.exr").0.unwrap();
        let (n, mut sum) = (20_000, Vec3::ZERO);
        for i in 0..n {
            let lambda = Wavelengths::sample((i as f32 + 0.5) / n as f32);
            let seen = scene.lighting.background.radiance(Vec3::X, &lambda);
            sum += Vec3::from(kajo_color::sensor::to_rgb(seen, &lambda)) / n as f32;
        }
        assert!(sum.distance(Vec3::new(2.0, 0.5, 0.25)) < 5e-3, "{sum}");
    }

    /// Stars are seen before everything else, and do not hide it.
    #[test]
    fn stars_are_before_what_else_there_is() {
        let toward = |background: &str, d: Vec3| {
            let (scene, said) = compiled(background);
            let scene = scene.unwrap_or_else(|| panic!("{background}: {said:?}"));
            scene.lighting.background.color(d).to_rgb()
        };
        let ahead = Vec3::NEG_Z;
        let vega = toward("color 0 0 0  stars { catalog one.txt  radius 1 }", ahead);
        // 3 E / (2 pi (1 - cos r)) of a star of magnitude 0, whose colour is nearly white.
        let peak = 3.0 * 2.54e-6 / (2.0 * std::f32::consts::PI * (1.0 - 1f32.to_radians().cos()));
        assert!((vega[1] / peak - 1.0).abs() < 0.1 && vega[2] > vega[0], "{vega:?} {peak}");
        let over = toward("environment sky.exr  stars { catalog one.txt  radius 1  scale 1000 }", ahead);
        assert!((over[0] - 2.0 - 1000.0 * vega[0]).abs() < 1e-3, "{over:?}");
        assert_eq!(toward("color 0.1 0.1 0.1  stars { catalog one.txt }", Vec3::Y)[0], 0.1);
        let many = compiled("color 0 0 0  stars { count 5000  galaxy 1 }").0.expect("a scene");
        assert!(!many.lighting.background.is_black());
    }

    #[test]
    fn mistakes_are_named() {
        let (scene, said) = compiled("environment dark.pfm");
        assert!(scene.is_some() && said == ["8 pixels of `dark.pfm` are negative or no numbers"], "{said:?}");
        let error = |background: &str| {
            let (scene, said) = compiled(background);
            assert!(scene.is_none(), "accepted: {background}");
            said.join("; ")
        };
        assert_eq!(error("environment none.exr"), "cannot read `none.exr`: there is no such file");
        assert!(error("environment text.exr").starts_with("cannot read `text.exr`: "));
        let assets = MemoryAssets::new().with("sky.exr", [0; 100]);
        let small = Limits { picture_bytes: 99, ..Limits::default() };
        let (scene, said) = compiled_within(small, "environment sky.exr", &assets);
        assert!(scene.is_none() && said[0].contains("more than 99 bytes"), "{said:?}");
        for two in ["environment sky.exr cubeMap sky", "sky { } environment sky.exr", "cubeMap sky sky { }"] {
            assert!(error(two).contains("one of `cubeMap`, `environment` and `sky`"), "{two}");
        }
        assert!(error("stars { catalog bad.txt }").contains("line 2: angles are in degrees"));
        assert!(error("stars { catalog none.txt }").contains("there is no such file"));
        assert!(error("stars { catalog one.txt  count 5 }").contains("count"));
        assert!(error("stars { count 0 }").contains("`count`"));
        assert!(error("stars { pole 0 0 0 }").contains("pole"));
        assert!(error("sky { turbidity 1 }").contains("at least 2 and at most 10"));
        assert!(error("rotate 30").contains("rotate"));
        assert!(error("environment sky.exr scale -1").contains("at least 0"));
    }
}
