//! The `Settings` block.

use kajo_color::Tone;
use kajo_math::Vec2;
use kajo_scene::{Args, Diagnostic, Item};

use super::Compiler;
use super::fields::{
    Choice, Keys, Plain, Sources, Typed, at_least, between, choice, choices, count, flag, keys, pair,
    positive, words,
};
use crate::interaction::RayOffset;
use crate::light::LightChoice;
use crate::sampler::SamplerKind;
use crate::schema::{Around, Block, Constant, FieldKind, FieldSpec, FieldValue, Kind, NumberRange};
use crate::settings::{
    Caustics, Dialect, Directions, FilterChoice, Gradients, IntegratorName, PhotonMapUse, Settings,
    ShadowAttenuation, Shadows, Technique,
};
use crate::texture::TexelFilter;

choices! {
    Shadows {
        "off" => Shadows::Off,
        "on" => Shadows::Opaque,
        "transparent" => Shadows::Transparent,
    }
}

choices! {
    ShadowAttenuation {
        "length" => ShadowAttenuation::Length,
        "surface" => ShadowAttenuation::Surface,
    }
}

choices! {
    RayOffset {
        "auto" => RayOffset::Auto,
        "reference" => RayOffset::Reference,
    }
}

choices!(Directions: Directions::NAMES);
choices!(Gradients: Gradients::NAMES);
choices!(PhotonMapUse: PhotonMapUse::NAMES);
choices!(Caustics: Caustics::NAMES);
choices!(LightChoice: LightChoice::NAMES);
choices!(Technique: Technique::NAMES, or Technique::SYNONYMS);
choices!(Dialect: {
    let [handout, mit_2004, mit_a2] = Dialect::ALL;
    [(handout.name(), handout), (mit_2004.name(), mit_2004), (mit_a2.name(), mit_a2)]
});
choices!(Tone: {
    let [linear, srgb, aces, agx] = Tone::ALL;
    [(linear.name(), linear), (srgb.name(), srgb), (aces.name(), aces), (agx.name(), agx)]
});

/// The most rays from one surface.
const MAX_BRANCHES: u32 = 1 << 16;

/// The most photons of a map: more would not be numbered by 32 bits once they have been scattered.
const MAX_PHOTONS: u32 = 100_000_000;

/// Most samples by which a guide learns.
const MAX_TRAINING: u32 = 1 << 16;

/// The least and the largest number of rays for a record of irradiance.
const RECORD_RAYS: [u32; 2] = [16, 1 << 20];

/// The largest seed, up to which every whole number is a double.
const MAX_SEED: f64 = (1u64 << 53) as f64;

/// Columns or rows of a picture.
const SIDE: NumberRange = NumberRange { min: 1.0, max: 16_777_216.0 };

/// How many samples a pixel may have.
const SAMPLES: NumberRange = NumberRange { min: 1.0, max: Settings::MAX_SAMPLES as f64 };

/// Sizes of filters, in pixels.
const FILTER_SIZES: NumberRange =
    NumberRange { min: *FilterChoice::SIZES.start(), max: *FilterChoice::SIZES.end() };

/// Temperatures and tints of light that is to look white.
const KELVIN: NumberRange = NumberRange { min: 1000.0, max: 25_000.0 };
const TINT: NumberRange = NumberRange { min: -150.0, max: 150.0 };

const SAMPLERS: &[&str] = &words(&SamplerKind::NAMES);
const FILTER_WORDS: &[&str] = &words(&FilterChoice::NAMES);

/// Columns and rows.
struct Size([u32; 2]);

/// How samples are spread, and how many there are.
struct Samples(SamplerKind, u32);

/// A seed of random numbers.
struct Seed(u64);

/// A temperature in kelvin and a tint.
struct WhiteBalance([f64; 2]);

keys! {
    SettingsKeys {
        size: Option<Size> = Typed::<Size>::new("size", FieldKind::Wholes(&[SIDE; 2]))
            .unit("pixels")
            .ruled(size, "800 600", "columns and rows of the picture"),
        integrator: Option<IntegratorName> = Typed::<IntegratorName>::new("integrator", FieldKind::Integrator)
            .ruled(integrator, "classic", "how light is followed"),
        samples: Option<Samples> = Typed::<Samples>::new(
            "samples",
            FieldKind::ChoiceAndWhole(SAMPLERS, SAMPLES),
        )
        .ruled(samples, "by the integrator", "rays of each pixel"),
        bounces: Option<u32> = count("bounces", 0, 1000)
            .ruled(bounces, "by the integrator", "surfaces that light is followed over"),
        shadows: Option<Shadows> =
            choice::<Shadows>("shadows").presumed(Constant::Word("on"), "what casts them"),
        shadow_attenuation: Option<ShadowAttenuation> = choice::<ShadowAttenuation>("transparentShadows")
            .ruled(transparent_shadows, "by the dialect", "how glass weakens light"),
        shade_back: Option<bool> =
            flag("shadeBack").presumed(Constant::Word("off"), "light reaches back sides"),
        fresnel: Option<bool> =
            flag("fresnel").presumed(Constant::Word("off"), "reflection grows towards grazing angles"),
        total_reflection: Option<bool> = flag("totalReflection")
            .presumed(Constant::Word("off"), "light that cannot leave is reflected"),
        weight: Option<f32> = at_least("weight", 0.0)
            .presumed(Constant::Number(0.0), "rays that count for less are not followed"),
        filter: Option<FilterChoice> =
            Typed::<FilterChoice>::new("filter", FieldKind::ChoiceAndNumber(FILTER_WORDS, FILTER_SIZES))
                .presumed(Constant::Word("none"), "how samples become pixels"),
        texture_filter: Option<TexelFilter> = choice::<TexelFilter>("textureFilter")
            .presumed(Constant::Word("bilinear"), "how pictures are filtered that do not say it themselves"),
        seed: Option<Seed> =
            Typed::<Seed>::new("seed", FieldKind::Whole { min: 0.0, max: MAX_SEED })
                .presumed(Constant::Number(0.0), "of the random numbers"),
        spectral: Option<bool> = flag("spectral")
            .presumed(Constant::Word("off"), "with wavelengths in place of red, green and blue"),
        branches: Option<u32> = count("branches", 1, MAX_BRANCHES)
            .ruled(branches, "by the integrator", "rays from one surface"),
        directions: Option<Directions> = choice::<Directions>("directions")
            .presumed(Constant::Word("scattering"), "how directions are drawn"),
        technique: Option<Technique> = choice::<Technique>("technique")
            .presumed(Constant::Word("combined"), "how light is found"),
        light_choice: Option<LightChoice> = choice::<LightChoice>("lightChoice")
            .presumed(Constant::Word("tree"), "how a light is drawn"),
        caustics: Option<Caustics> = choice::<Caustics>("caustics")
            .presumed(Constant::Word("scattering"), "how light through smooth glass is found"),
        roulette: Option<bool> =
            flag("roulette").ruled(roulette, "by the integrator", "faint paths end by chance"),
        guiding: Option<bool> = flag("guiding")
            .presumed(Constant::Word("off"), "directions by where light has come from"),
        training: Option<u32> = count("training", 1, MAX_TRAINING)
            .ruled(training, "a quarter of `samples`", "samples of each pixel by which a guide learns"),
        photons: Option<u32> = count("photons", 1, MAX_PHOTONS)
            .ruled(photons, "by the integrator", "paths from lights for a photon map"),
        photon_map: Option<PhotonMapUse> = choice::<PhotonMapUse>("photonMap")
            .presumed(Constant::Word("gather"), "what the photon map is used for"),
        merging: Option<bool> =
            flag("merging").presumed(Constant::Word("on"), "merges paths from lights with those from the camera"),
        merge_radius: Option<f32> = at_least("mergeRadius", 0.0)
            .unit("length")
            .unlike("by the picture", "0.01", "radius of the first disks in which paths are merged"),
        merge_alpha: Option<f32> = between("mergeAlpha", 0.0, 1.0)
            .presumed(Constant::Number(0.75), "how slowly these disks shrink from sample to sample"),
        accuracy: Option<f32> = positive("accuracy")
            .presumed(Constant::Number(0.1), "error that a record of irradiance may make, as a share"),
        rays: Option<u32> = count("rays", RECORD_RAYS[0], RECORD_RAYS[1])
            .presumed(Constant::Number(2048.0), "rays for a record of irradiance"),
        gradients: Option<Gradients> = choice::<Gradients>("gradients")
            .presumed(Constant::Word("occlusion"), "what is known around a record of irradiance"),
        show_records: Option<bool> = flag("showRecords")
            .presumed(Constant::Word("off"), "the irradiance and its records in place of the picture"),
        clamp: Option<f32> = at_least("clamp", 0.0)
            .presumed(Constant::Number(0.0), "the most that a sample brings of light that was scattered"),
        reach: Option<f32> = positive("reach")
            .unit("length")
            .unlike("any distance", "1", "distance beyond which nothing occludes"),
        ray_offset: Option<RayOffset> = choice::<RayOffset>("rayOffset")
            .presumed(Constant::Word("auto"), "how close to a surface rays start"),
        depth_range: Option<Vec2> = pair("depthRange")
            .unit("length")
            .unlike("by the picture", "0 10", "distances that are white and black"),
        exposure: Option<f32> = between("exposure", -100.0, 100.0)
            .unit("stops")
            .presumed(Constant::Number(0.0), "factors of two by which the picture is made brighter"),
        tone: Option<Tone> =
            choice::<Tone>("tone").ruled(tone, "by the integrator", "curve from light to pixels"),
        white_balance: Option<WhiteBalance> =
            Typed::<WhiteBalance>::new("whiteBalance", FieldKind::Numbers(&[KELVIN, TINT]))
                .unit("K")
                .unlike("as it is", "6500 0", "kelvin and tint of the light that is to look white"),
        dialect: Option<Dialect> =
            choice::<Dialect>("dialect").ruled(dialect, "handout", "conventions of the file"),
    }
}

/// The block with which a scene says how it is to be rendered.
pub const BLOCK: Block = Block {
    keyword: "Settings",
    kind: Kind::Settings,
    about: "how the scene is to be rendered",
    groups: &[SettingsKeys::FIELDS],
    parts: &[],
};

// The defaults of a render.

fn size(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers((around.render)()?.size?.map(f64::from)))
}

fn integrator(around: &Around<'_>) -> Option<FieldValue> {
    word((around.render)()?.integrator?.0)
}

fn samples(around: &Around<'_>) -> Option<FieldValue> {
    let (kind, number) = (around.render)()?.samples?;
    Some(FieldValue { word: Some(kind.name().to_owned()), numbers: vec![number.into()] })
}

fn bounces(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers([(around.render)()?.bounces?.into()]))
}

fn transparent_shadows(around: &Around<'_>) -> Option<FieldValue> {
    let attenuation = (around.render)()?.shadow_attenuation?;
    ShadowAttenuation::NAMES.iter().find(|(_, of)| *of == attenuation).and_then(|(name, _)| word(name))
}

fn branches(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers([(around.render)()?.branches?.into()]))
}

fn training(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers([(around.render)()?.training?.into()]))
}

fn photons(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers([(around.render)()?.photons?.into()]))
}

fn roulette(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::flag((around.render)()?.roulette?))
}

fn tone(around: &Around<'_>) -> Option<FieldValue> {
    word((around.render)()?.tone?.name())
}

fn dialect(around: &Around<'_>) -> Option<FieldValue> {
    word(around.rules().dialect.name())
}

fn word(word: &str) -> Option<FieldValue> {
    Some(FieldValue::word(word))
}

impl Compiler<'_> {
    /// The settings of the scene, whose dialect is not known before.
    pub(super) fn settings(&mut self, item: Item<'_>) -> Settings {
        let keys = self.read_keys(item, SettingsKeys::read);
        keys.map(Settings::from).unwrap_or_default()
    }
}

impl From<SettingsKeys> for Settings {
    fn from(keys: SettingsKeys) -> Settings {
        Settings {
            size: keys.size.map(|Size(size)| size),
            bounces: keys.bounces,
            weight: keys.weight,
            shadows: keys.shadows,
            shadow_attenuation: keys.shadow_attenuation,
            shade_back: keys.shade_back,
            samples: keys.samples.map(|Samples(kind, number)| (kind, number)),
            filter: keys.filter,
            seed: keys.seed.map(|Seed(seed)| seed),
            fresnel: keys.fresnel,
            total_reflection: keys.total_reflection,
            ray_offset: keys.ray_offset,
            dialect: keys.dialect,
            depth_range: keys.depth_range.map(|range| range.to_array()),
            integrator: keys.integrator,
            spectral: keys.spectral,
            branches: keys.branches,
            directions: keys.directions,
            technique: keys.technique,
            light_choice: keys.light_choice,
            texture_filter: keys.texture_filter,
            caustics: keys.caustics,
            roulette: keys.roulette,
            guiding: keys.guiding,
            training: keys.training,
            photons: keys.photons,
            photon_map: keys.photon_map,
            merging: keys.merging,
            merge_radius: keys.merge_radius,
            merge_alpha: keys.merge_alpha,
            accuracy: keys.accuracy,
            rays: keys.rays,
            gradients: keys.gradients,
            show_records: keys.show_records,
            clamp: keys.clamp,
            reach: keys.reach,
            exposure: keys.exposure,
            tone: keys.tone,
            white_balance: keys.white_balance.map(|WhiteBalance(balance)| balance),
        }
    }
}

impl Plain<'_> for Size {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Size, Diagnostic> {
        let range = spec.kind.range(0);
        let side = |n: f32| (range.contains(n.into()) && n == n.trunc()).then_some(n as u32);
        match args.numbers::<2>()?.map(side) {
            [Some(w), Some(h)] => Ok(Size([w, h])),
            _ => Err(args.error("`size` must be two whole numbers above zero")),
        }
    }
}

impl Plain<'_> for Samples {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Samples, Diagnostic> {
        let kind = args.choice(&SamplerKind::NAMES)?;
        Ok(Samples(kind, args.int_in(spec.kind.range(0).wholes())? as u32))
    }
}

impl Plain<'_> for IntegratorName {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<IntegratorName, Diagnostic> {
        args.word_of(sources.integrators).map(IntegratorName)
    }
}

impl Plain<'_> for Seed {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, sources: &mut Sources<'_>) -> Result<Seed, Diagnostic> {
        i64::parse(spec, args, sources).map(|seed| Seed(seed as u64))
    }
}

/// A temperature in kelvin, and a tint if there is one.
impl Plain<'_> for WhiteBalance {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<WhiteBalance, Diagnostic> {
        let [kelvin, tint] = [0, 1].map(|i| spec.kind.range(i).bounds());
        let kelvin = args.number_in(kelvin)?;
        let tint = if args.numbers_left() == 0 { 0.0 } else { args.number_in(tint)? };
        Ok(WhiteBalance([kelvin.into(), tint.into()]))
    }
}

impl Plain<'_> for FilterChoice {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<FilterChoice, Diagnostic> {
        let (make, default) = args.choice(&FilterChoice::NAMES)?;
        let size = if args.numbers_left() == 0 { default } else { args.number_in(spec.kind.bounds())? };
        Ok(make(size))
    }
}
