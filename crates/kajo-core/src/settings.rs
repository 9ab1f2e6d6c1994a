//! What a scene file may say about how it is to be rendered, and the rules of its dialect.

use std::fmt;
use std::ops::RangeInclusive;

use kajo_color::Tone;

use crate::bsdf::Highlight;
use crate::interaction::RayOffset;
use crate::light::LightChoice;
use crate::sampler::SamplerKind;
use crate::texture::TexelFilter;

/// Which of the three lineages of the classic format a file belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// The course handout's, and kajo's own.
    #[default]
    Handout,
    /// MIT 6.837 of fall 2004, assignments 1 to 9.
    Mit2004,
    /// The later rewrite of that course.
    MitA2,
}

impl Dialect {
    /// Names on the command line and in `Settings`, in the order of the variants.
    pub const NAMES: [&'static str; 3] = ["handout", "mit-2004", "mit-a2"];

    /// All dialects, in the order of [`Dialect::NAMES`].
    pub const ALL: [Dialect; 3] = [Dialect::Handout, Dialect::Mit2004, Dialect::MitA2];

    /// The dialect of that name.
    pub fn from_name(name: &str) -> Option<Dialect> {
        Dialect::NAMES.iter().position(|&n| n == name).map(|i| Dialect::ALL[i])
    }

    /// The name of the dialect.
    pub const fn name(self) -> &'static str {
        Dialect::NAMES[self as usize]
    }

    /// What the dialect means for rendering.
    pub fn rules(self) -> Rules {
        let handout = Rules {
            dialect: self,
            highlight: Highlight::Mirror,
            corner_samples: false,
            raw_up: false,
            smooth_meshes: false,
            matrix_by_rows: false,
            spans_width: false,
            radial_tent: false,
            gaussian_of_whole_pixels: false,
            reflects_specular: false,
            texture_is_diffuse: false,
            mirrors_back_face: false,
            shadow_attenuation: ShadowAttenuation::Length,
            maps: MapRules::Inverted,
        };
        match self {
            Dialect::Handout => handout,
            Dialect::Mit2004 => Rules {
                highlight: Highlight::Half,
                matrix_by_rows: true,
                spans_width: true,
                radial_tent: true,
                gaussian_of_whole_pixels: true,
                shadow_attenuation: ShadowAttenuation::Surface,
                ..handout
            },
            Dialect::MitA2 => Rules {
                corner_samples: true,
                raw_up: true,
                smooth_meshes: true,
                reflects_specular: true,
                texture_is_diffuse: true,
                mirrors_back_face: true,
                maps: MapRules::Direct,
                ..handout
            },
        }
    }
}

/// The conventions in which the dialects differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// The dialect itself.
    pub dialect: Dialect,
    /// The vector of the highlight.
    pub highlight: Highlight,
    /// Samples lie on the picture's corners, `x = 2i/(w-1) - 1`, instead of at pixel centres.
    pub corner_samples: bool,
    /// The camera's up vector is used as it stands.
    pub raw_up: bool,
    /// Meshes are shaded smooth unless told otherwise.
    pub smooth_meshes: bool,
    /// `Matrix` is read row by row.
    pub matrix_by_rows: bool,
    /// The angle and the size of a camera are those of the picture's width instead of its height.
    pub spans_width: bool,
    /// A tent filter is a cone.
    pub radial_tent: bool,
    /// A Gaussian filter ends where pixels end instead of at two standard deviations.
    pub gaussian_of_whole_pixels: bool,
    /// Mirror rays are weighted by the specular colour.
    pub reflects_specular: bool,
    /// A `texture` stands in place of the diffuse colour instead of being a factor of it.
    pub texture_is_diffuse: bool,
    /// The back face of a cube map is mirrored.
    pub mirrors_back_face: bool,
    /// How transparent things weaken light unless the scene or the user says otherwise.
    pub shadow_attenuation: ShadowAttenuation,
    /// How depth and normals become pictures.
    pub maps: MapRules,
}

/// How depth, normals and 8-bit values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapRules {
    /// Near is white, normals are absolute values, 8-bit values are rounded.
    Inverted,
    /// Near is black, normals are `(n + 1)/2`, 8-bit values are cut off.
    Direct,
}

/// How shadows are cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadows {
    /// Not at all.
    #[default]
    Off,
    /// By everything, glass included.
    Opaque,
    /// Transparent things let light through.
    Transparent,
}

/// How light is weakened on its straight way through transparent things.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadowAttenuation {
    /// By `exp(-absorption * length inside)`.
    #[default]
    Length,
    /// By the transparent colour at every surface.
    Surface,
}

/// An integrator, by the name that it has in `Settings` and on the command line. The names are supplied through `CompileOptions`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntegratorName(pub &'static str);

impl fmt::Display for IntegratorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// Which estimates of direct light are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Technique {
    /// Both of the following, weighed against each other.
    #[default]
    Combined,
    /// Lights are found by sampling the BSDF only.
    Scattering,
    /// Lights are sampled; those that paths hit count only where they cannot be.
    Lights,
}

impl Technique {
    /// Names on the command line and in `Settings`, with the techniques.
    pub const NAMES: [(&'static str, Technique); 3] = [
        ("combined", Technique::Combined),
        ("lights", Technique::Lights),
        ("scattering", Technique::Scattering),
    ];

    /// Words that scenes and scripts may hold for one of these: understood, but listed nowhere.
    pub const SYNONYMS: [(&'static str, Technique); 1] = [("lamps", Technique::Lights)];
}

/// What a photon map is used for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotonMapUse {
    /// For light that is gathered at the second surface that is no mirror, and for caustics.
    #[default]
    Gather,
    /// For all light of the first surface that is no mirror, so that the map itself is seen.
    Direct,
    /// For caustics only; paths find all other light.
    Caustics,
    /// For a picture of its photons: a dot for each, on a dim view of the surfaces.
    Dots,
}

impl PhotonMapUse {
    /// Names on the command line and in `Settings`, with the uses.
    pub const NAMES: [(&'static str, PhotonMapUse); 4] = [
        ("caustics", PhotonMapUse::Caustics),
        ("direct", PhotonMapUse::Direct),
        ("dots", PhotonMapUse::Dots),
        ("gather", PhotonMapUse::Gather),
    ];
}

/// What an irradiance cache records of how irradiance changes around its records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gradients {
    /// First and second derivatives, by what hides what.
    #[default]
    Occlusion,
    /// First derivatives, by the differences of neighbouring directions.
    Strata,
    /// Nothing: each record has one irradiance.
    Off,
}

impl Gradients {
    /// Names on the command line and in `Settings`, with what they stand for.
    pub const NAMES: [(&'static str, Gradients); 3] =
        [("occlusion", Gradients::Occlusion), ("off", Gradients::Off), ("strata", Gradients::Strata)];
}

/// How the directions of indirect light are drawn at surfaces that are no mirrors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Directions {
    /// By the surface's own scattering.
    #[default]
    Scattering,
    /// By the cosine with the normal, on both sides if light passes.
    Cosine,
    /// All alike.
    Uniform,
}

impl Directions {
    /// Names on the command line and in `Settings`, with the rules.
    pub const NAMES: [(&'static str, Directions); 3] = [
        ("cosine", Directions::Cosine),
        ("scattering", Directions::Scattering),
        ("uniform", Directions::Uniform),
    ];
}

/// How lights are found whose light comes through smooth glass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Caustics {
    /// They are met by chance only.
    #[default]
    Scattering,
    /// They are drawn as well, and chains of refractions that lead there found by walks on the manifold of all chains.
    Manifold,
}

impl Caustics {
    /// Names on the command line and in `Settings`, with the ways.
    pub const NAMES: [(&'static str, Caustics); 2] =
        [("manifold", Caustics::Manifold), ("scattering", Caustics::Scattering)];
}

/// How samples become pixels; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterChoice {
    /// The plain average of a pixel's own samples.
    None,
    /// The average over a square of that half width.
    Box(f32),
    /// A pyramid of that half width.
    Tent(f32),
    /// A Gaussian of that standard deviation.
    Gaussian(f32),
    /// The cubic of Mitchell and Netravali over that half width.
    Mitchell(f32),
    /// A windowed sinc over that half width.
    Lanczos(f32),
}

/// The `Settings` block of a scene; what is absent is left to the command line and its defaults.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "the fields are the keys of the block, documented in the manual")]
pub struct Settings {
    pub size: Option<[u32; 2]>,
    pub bounces: Option<u32>,
    pub weight: Option<f32>,
    pub shadows: Option<Shadows>,
    pub shadow_attenuation: Option<ShadowAttenuation>,
    pub shade_back: Option<bool>,
    pub samples: Option<(SamplerKind, u32)>,
    pub filter: Option<FilterChoice>,
    pub seed: Option<u64>,
    pub fresnel: Option<bool>,
    pub total_reflection: Option<bool>,
    pub ray_offset: Option<RayOffset>,
    pub dialect: Option<Dialect>,
    pub depth_range: Option<[f32; 2]>,
    /// How light is followed.
    pub integrator: Option<IntegratorName>,
    /// Whether light is followed by wavelength.
    pub spectral: Option<bool>,
    /// Rays from the first surface that is no mirror, for distribution ray tracing.
    pub branches: Option<u32>,
    /// How directions of indirect light are drawn.
    pub directions: Option<Directions>,
    /// How direct light is estimated.
    pub technique: Option<Technique>,
    /// How lights are chosen.
    pub light_choice: Option<LightChoice>,
    /// How pictures are filtered that do not say it themselves.
    pub texture_filter: Option<TexelFilter>,
    /// How lights behind smooth glass are found.
    pub caustics: Option<Caustics>,
    /// Whether paths of little weight end at random.
    pub roulette: Option<bool>,
    /// Whether directions are drawn by where light has come from.
    pub guiding: Option<bool>,
    /// Samples of each pixel by which that is learned.
    pub training: Option<u32>,
    /// Paths from lights that photons are left by: for one map.
    pub photons: Option<u32>,
    /// What a photon map is used for.
    pub photon_map: Option<PhotonMapUse>,
    /// Whether vertices of paths from lights are merged with those of paths from the camera.
    pub merging: Option<bool>,
    /// Radius of the first disks in which they are, world units; 0 for one that suits the picture.
    pub merge_radius: Option<f32>,
    /// How the disks of pass `i` shrink, from 0 to 1: their area goes as `i^(alpha - 1)`.
    pub merge_alpha: Option<f32>,
    /// The error that a record of irradiance may make, as a share.
    pub accuracy: Option<f32>,
    /// Rays by which a record of irradiance is made.
    pub rays: Option<u32>,
    /// What is known of how irradiance changes around a record.
    pub gradients: Option<Gradients>,
    /// Whether the records of irradiance are shown in place of the picture.
    pub show_records: Option<bool>,
    /// The most that a sample brings of light that was scattered; 0 for any amount.
    pub clamp: Option<f32>,
    /// Distance beyond which nothing occludes.
    pub reach: Option<f32>,
    /// Factors of two by which the picture is made brighter.
    pub exposure: Option<f32>,
    /// The curve of pictures for a display.
    pub tone: Option<Tone>,
    /// Temperature in kelvin and tint of the light that is to look white.
    pub white_balance: Option<[f64; 2]>,
}

/// Makes a filter of a half width, or of a standard deviation where it is Gaussian.
pub type MakeFilter = fn(f32) -> FilterChoice;

impl FilterChoice {
    /// Names on the command line and in `Settings`, each with the filter that it makes and the size that this has unless one is said.
    pub const NAMES: [(&'static str, (MakeFilter, f32)); 6] = [
        ("box", (FilterChoice::Box, 0.5)),
        ("gaussian", (FilterChoice::Gaussian, 0.5)),
        ("lanczos", (FilterChoice::Lanczos, 3.0)),
        ("mitchell", (FilterChoice::Mitchell, 2.0)),
        ("none", (|_| FilterChoice::None, 0.0)),
        ("tent", (FilterChoice::Tent, 1.0)),
    ];

    /// The least and the largest size, in pixels.
    pub const SIZES: RangeInclusive<f64> = 1e-3..=64.0;

    /// Whether its size is finite.
    fn is_finite(self) -> bool {
        match self {
            FilterChoice::None => true,
            FilterChoice::Box(size)
            | FilterChoice::Tent(size)
            | FilterChoice::Gaussian(size)
            | FilterChoice::Mitchell(size)
            | FilterChoice::Lanczos(size) => size.is_finite(),
        }
    }
}

impl Settings {
    /// The most samples of a pixel.
    pub const MAX_SAMPLES: u32 = 1 << 20;

    /// Whether all its numbers are finite.
    pub fn is_finite(&self) -> bool {
        let numbers = [
            self.weight,
            self.accuracy,
            self.clamp,
            self.reach,
            self.exposure,
            self.merge_radius,
            self.merge_alpha,
        ];
        let mut all = numbers.into_iter().flatten().chain(self.depth_range.into_iter().flatten());
        all.all(f32::is_finite)
            && self.filter.is_none_or(FilterChoice::is_finite)
            && self.white_balance.is_none_or(|[kelvin, tint]| kelvin.is_finite() && tint.is_finite())
    }
}

impl Settings {
    /// What is said here, and where nothing is, what is said there.
    pub fn or(&self, there: &Settings) -> Settings {
        Settings {
            size: self.size.or(there.size),
            bounces: self.bounces.or(there.bounces),
            weight: self.weight.or(there.weight),
            shadows: self.shadows.or(there.shadows),
            shadow_attenuation: self.shadow_attenuation.or(there.shadow_attenuation),
            shade_back: self.shade_back.or(there.shade_back),
            samples: self.samples.or(there.samples),
            filter: self.filter.or(there.filter),
            seed: self.seed.or(there.seed),
            fresnel: self.fresnel.or(there.fresnel),
            total_reflection: self.total_reflection.or(there.total_reflection),
            ray_offset: self.ray_offset.or(there.ray_offset),
            dialect: self.dialect.or(there.dialect),
            depth_range: self.depth_range.or(there.depth_range),
            integrator: self.integrator.or(there.integrator),
            spectral: self.spectral.or(there.spectral),
            branches: self.branches.or(there.branches),
            directions: self.directions.or(there.directions),
            technique: self.technique.or(there.technique),
            light_choice: self.light_choice.or(there.light_choice),
            texture_filter: self.texture_filter.or(there.texture_filter),
            caustics: self.caustics.or(there.caustics),
            roulette: self.roulette.or(there.roulette),
            guiding: self.guiding.or(there.guiding),
            training: self.training.or(there.training),
            photons: self.photons.or(there.photons),
            photon_map: self.photon_map.or(there.photon_map),
            merging: self.merging.or(there.merging),
            merge_radius: self.merge_radius.or(there.merge_radius),
            merge_alpha: self.merge_alpha.or(there.merge_alpha),
            accuracy: self.accuracy.or(there.accuracy),
            rays: self.rays.or(there.rays),
            gradients: self.gradients.or(there.gradients),
            show_records: self.show_records.or(there.show_records),
            clamp: self.clamp.or(there.clamp),
            reach: self.reach.or(there.reach),
            exposure: self.exposure.or(there.exposure),
            tone: self.tone.or(there.tone),
            white_balance: self.white_balance.or(there.white_balance),
        }
    }
}

/// A key of [`Settings`] that some integrators have a use for and others have not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "these are fields of `Settings`")]
pub enum SettingsKey {
    Bounces,
    Weight,
    Fresnel,
    TotalReflection,
    RayOffset,
    Technique,
    Directions,
    LightChoice,
    Caustics,
    Roulette,
    Spectral,
    Branches,
    Guiding,
    Training,
    Photons,
    PhotonMap,
    Merging,
    MergeRadius,
    MergeAlpha,
    Accuracy,
    Rays,
    Gradients,
    ShowRecords,
    Clamp,
    Reach,
    Shadows,
    ShadowAttenuation,
    ShadeBack,
}

impl SettingsKey {
    /// All of them, in the order in which they are shown.
    pub const ALL: [SettingsKey; 28] = [
        SettingsKey::Bounces,
        SettingsKey::Weight,
        SettingsKey::Fresnel,
        SettingsKey::TotalReflection,
        SettingsKey::RayOffset,
        SettingsKey::Technique,
        SettingsKey::Directions,
        SettingsKey::LightChoice,
        SettingsKey::Caustics,
        SettingsKey::Roulette,
        SettingsKey::Spectral,
        SettingsKey::Branches,
        SettingsKey::Guiding,
        SettingsKey::Training,
        SettingsKey::Photons,
        SettingsKey::PhotonMap,
        SettingsKey::Merging,
        SettingsKey::MergeRadius,
        SettingsKey::MergeAlpha,
        SettingsKey::Accuracy,
        SettingsKey::Rays,
        SettingsKey::Gradients,
        SettingsKey::ShowRecords,
        SettingsKey::Clamp,
        SettingsKey::Reach,
        SettingsKey::Shadows,
        SettingsKey::ShadowAttenuation,
        SettingsKey::ShadeBack,
    ];

    /// Whether the film sees to it: then the settings of the integrator do not depend on it.
    pub const fn is_of_film(self) -> bool {
        matches!(self, SettingsKey::Clamp)
    }

    /// The key as a scene writes it, if it is set in `settings`: for the warning that it has no effect.
    ///
    /// Shadows are cast wherever light is followed, so to ask for them is no mistake anywhere.
    pub fn said(self, settings: &Settings) -> Option<&'static str> {
        let said = |is_said: bool, key: &'static str| is_said.then_some(key);
        match self {
            SettingsKey::Bounces => said(settings.bounces.is_some(), "bounces"),
            SettingsKey::Weight => said(settings.weight.is_some(), "weight"),
            SettingsKey::Fresnel => said(settings.fresnel.is_some(), "fresnel"),
            SettingsKey::TotalReflection => said(settings.total_reflection.is_some(), "totalReflection"),
            SettingsKey::RayOffset => said(settings.ray_offset.is_some(), "rayOffset"),
            SettingsKey::Technique => said(settings.technique.is_some(), "technique"),
            SettingsKey::Directions => said(settings.directions.is_some(), "directions"),
            SettingsKey::LightChoice => said(settings.light_choice.is_some(), "lightChoice"),
            SettingsKey::Caustics => said(settings.caustics.is_some(), "caustics"),
            SettingsKey::Roulette => said(settings.roulette.is_some(), "roulette"),
            SettingsKey::Spectral => said(settings.spectral.is_some(), "spectral"),
            SettingsKey::Branches => said(settings.branches.is_some(), "branches"),
            SettingsKey::Guiding => said(settings.guiding.is_some(), "guiding"),
            SettingsKey::Training => said(settings.training.is_some(), "training"),
            SettingsKey::Photons => said(settings.photons.is_some(), "photons"),
            SettingsKey::PhotonMap => said(settings.photon_map.is_some(), "photonMap"),
            SettingsKey::Merging => said(settings.merging.is_some(), "merging"),
            SettingsKey::MergeRadius => said(settings.merge_radius.is_some(), "mergeRadius"),
            SettingsKey::MergeAlpha => said(settings.merge_alpha.is_some(), "mergeAlpha"),
            SettingsKey::Accuracy => said(settings.accuracy.is_some(), "accuracy"),
            SettingsKey::Rays => said(settings.rays.is_some(), "rays"),
            SettingsKey::Gradients => said(settings.gradients.is_some(), "gradients"),
            SettingsKey::ShowRecords => said(settings.show_records.is_some(), "showRecords"),
            SettingsKey::Clamp => said(settings.clamp.is_some(), "clamp"),
            SettingsKey::Reach => said(settings.reach.is_some(), "reach"),
            SettingsKey::Shadows => match settings.shadows? {
                Shadows::Off => Some("shadows off"),
                Shadows::Opaque => None,
                Shadows::Transparent => Some("shadows transparent"),
            },
            SettingsKey::ShadowAttenuation => {
                said(settings.shadow_attenuation.is_some(), "transparentShadows")
            }
            SettingsKey::ShadeBack => said(settings.shade_back.is_some(), "shadeBack"),
        }
    }
}
