//! What integrators say of themselves is true.

use kajo_core::RayOffset;
use kajo_core::light::LightChoice;
use kajo_core::settings::{
    Caustics, Directions, Gradients, PhotonMapUse, Settings, SettingsKey, ShadowAttenuation, Shadows,
    Technique,
};
use kajo_scene::MemoryAssets;

use super::tests::scene_with;
use super::{Defaults, INTEGRATORS, IntegratorSpec, NAMES, Prepare, SettingsContext};

/// The settings of an integrator where this is said, as text.
fn settled(spec: &IntegratorSpec, said: &Settings, defaults: Defaults) -> String {
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 } Group { }";
    let scene = scene_with(camera, &MemoryAssets::new());
    format!(
        "{:?}",
        (spec.settings)(&SettingsContext { said, scene: &scene, size: [40, 30], defaults, uv: false })
    )
}

/// Settings that say a key, at least one of them other than any default.
fn saying(key: SettingsKey) -> Vec<Settings> {
    let none = Settings::default;
    match key {
        SettingsKey::Bounces => vec![Settings { bounces: Some(7), ..none() }],
        SettingsKey::Weight => vec![Settings { weight: Some(0.25), ..none() }],
        SettingsKey::Fresnel => vec![Settings { fresnel: Some(true), ..none() }],
        SettingsKey::TotalReflection => vec![Settings { total_reflection: Some(true), ..none() }],
        SettingsKey::RayOffset => vec![
            Settings { ray_offset: Some(RayOffset::Reference), ..none() },
            Settings { ray_offset: Some(RayOffset::Auto), ..none() },
        ],
        SettingsKey::Technique => vec![Settings { technique: Some(Technique::Lights), ..none() }],
        SettingsKey::Directions => vec![Settings { directions: Some(Directions::Cosine), ..none() }],
        SettingsKey::LightChoice => vec![Settings { light_choice: Some(LightChoice::Uniform), ..none() }],
        SettingsKey::Caustics => vec![Settings { caustics: Some(Caustics::Manifold), ..none() }],
        SettingsKey::Roulette => [true, false].map(|on| Settings { roulette: Some(on), ..none() }).to_vec(),
        SettingsKey::Spectral => vec![Settings { spectral: Some(true), ..none() }],
        SettingsKey::Branches => vec![Settings { branches: Some(5), ..none() }],
        SettingsKey::Guiding => vec![Settings { guiding: Some(true), ..none() }],
        SettingsKey::Training => vec![Settings { training: Some(77), ..none() }],
        SettingsKey::Photons => vec![Settings { photons: Some(77), ..none() }],
        SettingsKey::PhotonMap => vec![Settings { photon_map: Some(PhotonMapUse::Direct), ..none() }],
        SettingsKey::Merging => [true, false].map(|on| Settings { merging: Some(on), ..none() }).to_vec(),
        SettingsKey::MergeRadius => vec![Settings { merge_radius: Some(0.2), ..none() }],
        SettingsKey::MergeAlpha => vec![Settings { merge_alpha: Some(0.4), ..none() }],
        SettingsKey::Accuracy => vec![Settings { accuracy: Some(0.3), ..none() }],
        SettingsKey::Rays => vec![Settings { rays: Some(77), ..none() }],
        SettingsKey::Gradients => vec![Settings { gradients: Some(Gradients::Off), ..none() }],
        SettingsKey::ShowRecords => vec![Settings { show_records: Some(true), ..none() }],
        SettingsKey::Clamp => vec![Settings { clamp: Some(3.0), ..none() }],
        SettingsKey::Reach => vec![Settings { reach: Some(2.0), ..none() }],
        SettingsKey::Shadows => vec![Settings { shadows: Some(Shadows::Transparent), ..none() }],
        SettingsKey::ShadowAttenuation => {
            vec![Settings { shadow_attenuation: Some(ShadowAttenuation::Surface), ..none() }]
        }
        SettingsKey::ShadeBack => vec![Settings { shade_back: Some(true), ..none() }],
    }
}

#[test]
fn names_are_in_order_and_lead_to_their_integrators() {
    assert!(NAMES.is_sorted_by(|a, b| a < b), "{NAMES:?}");
    for (spec, name) in INTEGRATORS.into_iter().zip(NAMES) {
        assert_eq!(IntegratorSpec::named(spec.name).map(|found| found.name.0), Some(name));
    }
}

#[test]
fn integrators_listen_to_their_keys_and_to_no_others() {
    for spec in INTEGRATORS {
        for defaults in [Defaults::Classic, Defaults::Modern] {
            let silent = settled(spec, &Settings::default(), defaults);
            for key in SettingsKey::ALL {
                let variants = saying(key);
                assert!(variants.iter().any(|said| key.said(said).is_some()), "{key:?}");
                let is_heard = variants.iter().any(|said| settled(spec, said, defaults) != silent);
                let is_own = spec.keys.contains(&key) && !key.is_of_film();
                assert_eq!(is_heard, is_own, "{key:?} with {}", spec.name);
            }
        }
    }
}

/// What holds can be said, and then still holds.
#[test]
fn the_values_of_settings_make_the_same_settings() {
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 } Group { }";
    let scene = scene_with(camera, &MemoryAssets::new());
    for spec in INTEGRATORS {
        for said in SettingsKey::ALL.into_iter().flat_map(saying).chain([Settings::default()]) {
            let context = SettingsContext {
                said: &said,
                scene: &scene,
                size: [400, 300],
                defaults: Defaults::Modern,
                uv: false,
            };
            let settings = (spec.settings)(&context);
            let values = settings.values();
            assert_eq!(settled(spec, &values, Defaults::Classic), format!("{settings:?}"), "{}", spec.name);
            for key in SettingsKey::ALL {
                let is_plain = key == SettingsKey::Shadows || key.is_of_film();
                assert!(is_plain || !spec.keys.contains(&key) || key.said(&values).is_some(), "{key:?}");
            }
        }
    }
}

#[test]
fn paths_from_lights_follow_the_size_of_the_picture() {
    let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 } Group { }";
    let scene = scene_with(camera, &MemoryAssets::new());
    let said = Settings::default();
    let of = |size, each| {
        let context =
            SettingsContext { said: &said, scene: &scene, size, defaults: Defaults::Modern, uv: false };
        context.paths_for_pixels(each)
    };
    assert_eq!([of([400, 300], 1), of([400, 300], 2)], [120_000, 240_000]);
    assert_eq!([of([1, 1], 1), of([4000, 3000], 2), of([u32::MAX; 2], 2)], [10_000, 1_000_000, 1_000_000]);
}
