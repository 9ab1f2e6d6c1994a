//! Settings that the integrator has no use for.

use kajo_core::settings::{Settings, SettingsKey, Shadows};
use kajo_render::integrator::{AUTO, DEFAULT, INTEGRATORS, Prepare};

use super::RenderSettings;

impl RenderSettings {
    /// What was said to no effect, a sentence each: keys that are for other integrators, ranges without an extent.
    ///
    /// A scene that was written for one integrator may be rendered by another: then only `asked` is looked at.
    ///
    /// * `asked`, `own`: as in [`RenderSettings::resolve`]
    pub fn without_effect(&self, asked: &Settings, own: &Settings) -> Vec<String> {
        let is_chosen = self.why.is_some() && own.integrator == Some(AUTO);
        let is_own = is_chosen || own.integrator.unwrap_or(DEFAULT.name) == self.integrator.name;
        let said = if is_own { &asked.or(own) } else { asked };
        let idle = SettingsKey::ALL.into_iter().filter(|key| !self.integrator.keys.contains(key));
        let mut notes: Vec<String> = idle
            .filter_map(|key| {
                let users = INTEGRATORS.iter().filter(|user| user.keys.contains(&key));
                let users: Vec<_> = users.map(|user| format!("`{}`", user.name)).collect();
                let (said, own, users) = (key.said(said)?, self.integrator.name, users.join(", "));
                Some(format!("`{said}` has no effect with `integrator {own}`; it is for {users}"))
            })
            .collect();
        let listens = self.integrator.keys.contains(&SettingsKey::ShadowAttenuation);
        let has_clear_shadows = self.integrator_settings.values().shadows == Some(Shadows::Transparent);
        if listens && said.shadow_attenuation.is_some() && !has_clear_shadows {
            notes.push("`transparentShadows` has no effect without `shadows transparent`".to_owned());
        }
        if let Some([near, far]) = self.depth_range.filter(|[near, far]| near == far) {
            notes.push(format!(
                "`depthRange` from {near} to {far} is no range, so the depth picture is black; write two distances"
            ));
        }
        notes
    }
}

#[cfg(test)]
mod tests {
    use kajo_core::settings::IntegratorName;
    use kajo_render::integrator;

    use super::*;
    use crate::{Defaults, LoadOptions, MemoryAssets, load_from};

    /// What is said when a scene has these settings and others are asked for.
    fn said(own: &str, asked: Settings) -> Vec<String> {
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
        let assets = MemoryAssets::new().with("scene.txt", format!("{camera} Settings {{ {own} }}"));
        let loaded = load_from("scene.txt", &assets, &LoadOptions::default());
        assert!(loaded.diagnostics.is_empty(), "{}", loaded.report(false));
        let scene = loaded.scene.unwrap();
        let settings = RenderSettings::resolve(&scene, &asked, Defaults::Modern, false).unwrap();
        settings.without_effect(&asked, &scene.output.settings)
    }

    #[test]
    fn keys_for_other_integrators_are_told() {
        let key = |text: &str| text.split_whitespace().next().unwrap().to_owned();
        for (text, users) in [
            (
                "bounces 3",
                "classic path direct distribution bidirectional irradiance light photon sppm mlt mmlt vcm",
            ),
            ("weight 0.1", "classic"),
            ("shadows off", "classic"),
            ("shadows transparent", "classic"),
            ("shadeBack on", "classic"),
            ("fresnel on", "classic"),
            ("totalReflection on", "classic"),
            ("rayOffset reference", "classic"),
            ("branches 4", "distribution"),
            ("guiding on", "path"),
            ("training 8", "path"),
            ("photons 1000", "photon sppm vcm"),
            ("photonMap direct", "photon"),
            ("merging off", "vcm"),
            ("mergeRadius 0.1", "vcm"),
            ("mergeAlpha 0.5", "vcm"),
            ("accuracy 0.2", "irradiance"),
            ("rays 500", "irradiance"),
            ("gradients off", "irradiance"),
            ("showRecords on", "irradiance"),
            ("directions cosine", "path direct distribution"),
            ("technique lights", "path direct distribution"),
            (
                "roulette off",
                "path direct distribution bidirectional irradiance light photon sppm mlt mmlt vcm",
            ),
            ("spectral on", "path direct distribution bidirectional light sppm mlt mmlt vcm"),
            ("caustics manifold", "path mlt"),
            (
                "lightChoice uniform",
                "path direct distribution bidirectional irradiance photon sppm mlt mmlt vcm",
            ),
            ("clamp 2", "path direct distribution bidirectional irradiance light photon sppm vcm"),
            ("reach 2", "occlusion"),
        ] {
            for name in integrator::NAMES {
                let notes = said(&format!("integrator {name}  {text}"), Settings::default());
                let is_used = users.split(' ').any(|user| user == name);
                assert_eq!(notes.is_empty(), is_used, "{text} with {name}: {notes:?}");
                let told = notes.iter().all(|note| note.contains(&format!("with `integrator {name}`")));
                assert!(told && notes.iter().all(|note| note.starts_with(&format!("`{}", key(text)))));
                // Another integrator on the command line is no mistake of the scene's.
                let other = if name == "classic" { "path" } else { "classic" };
                let asked = Settings { integrator: Some(IntegratorName(name)), ..Settings::default() };
                assert_eq!(said(&format!("integrator {other}  {text}"), asked), [""; 0]);
            }
        }
        let asked =
            Settings { integrator: Some(IntegratorName("path")), branches: Some(4), ..Settings::default() };
        assert_eq!(
            said("", asked),
            ["`branches` has no effect with `integrator path`; it is for `distribution`"]
        );
        assert_eq!(said("integrator path  shadows on", Settings::default()), [""; 0]);
    }

    #[test]
    fn ways_of_shadows_need_shadows() {
        let transparent = "shadows transparent  transparentShadows surface";
        assert_eq!(said(transparent, Settings::default()), [""; 0]);
        let notes = said("transparentShadows surface", Settings::default());
        assert!(notes.len() == 1 && notes[0].contains("without `shadows transparent`"), "{notes:?}");
    }

    #[test]
    fn depths_need_a_range() {
        assert_eq!(
            said("depthRange 9 3", Settings::default()),
            [""; 0],
            "the other way round it is inverted"
        );
        assert!(said("depthRange 9 9", Settings::default())[0].contains("is no range"));
    }
}
