//! Groups of lights: the light of each can be seen apart.

use kajo_scene::{Args, Diagnostic};

use crate::ids::LightGroup;
use crate::light::{LightGroupError, LightGroups, MAX_LIGHT_GROUPS, OTHER};

/// The group that a key names.
pub(super) fn read(args: &mut Args<'_>, groups: &mut LightGroups) -> Result<LightGroup, Diagnostic> {
    let name = args.text()?;
    groups.group(&name).map_err(|error| match error {
        LightGroupError::Name => args.error("the name of a group has letters, digits, `_` and `-` only"),
        LightGroupError::TooMany => {
            let most = MAX_LIGHT_GROUPS - 1;
            args.error(format!("a scene has at most {most} groups of lights, and `{OTHER}`"))
        }
    })
}

#[cfg(test)]
mod tests {
    use kajo_color::Wavelengths;
    use kajo_math::Vec3;
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};
    use crate::differential::SkyFootprint;
    use crate::ids::LightIndex;
    use crate::scene::Scene;

    /// The scene, or what is wrong with it.
    fn compiled(blocks: &str) -> Result<Scene, String> {
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
        let mut parsed = SceneDesc::parse_str(&format!("{camera} {blocks}"));
        let mut diagnostics = Diagnostics::default();
        let scene =
            compile(&mut parsed.desc, &MemoryAssets::new(), &CompileOptions::default(), &mut diagnostics);
        let said: Vec<_> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join("; "))
    }

    #[test]
    fn every_light_knows_its_group() {
        let scene = compiled(
            "Background { color 1 1 1  group sky }
             Lights { PointLight { position 0 1 0 color 1 1 1 group key }
                      SpotLight { position 0 1 0 direction 0 -1 0 angle 9 color 1 1 1 }
                      DirectionalLight { direction 0 -1 0 color 1 1 1 group \"key\" } }
             Materials { Matte emitter { emission 1 group rim } Material bright { emission 2 } }
             Group { MaterialIndex bright Sphere { center 0 0 0 radius 1 }
                     MaterialIndex emitter Sphere { center 3 0 0 radius 1 } }",
        )
        .unwrap();
        assert_eq!(&*scene.lighting.groups, ["other", "sky", "key", "rim"]);
        let groups: Vec<usize> =
            LightIndex::all(6).map(|light| scene.lighting.sampler.group(light).index()).collect();
        assert_eq!(groups, [2, 0, 2, 0, 3, 1]);
        let seen: Vec<_> =
            scene.lights_at_infinity(Vec3::Y, &SkyFootprint::POINT, &Wavelengths::RGB).collect();
        assert_eq!(seen.iter().map(|hit| hit.group.index()).collect::<Vec<_>>(), [1], "the background");
        let plain = compiled("Lights { PointLight { position 0 1 0 color 1 1 1 group other } }").unwrap();
        assert_eq!(&*plain.lighting.groups, ["other"]);
    }

    #[test]
    fn mistakes_in_groups_are_named() {
        let error = |lights: &str| compiled(&format!("Lights {{ {lights} }}")).unwrap_err();
        let emitter = |group: &str| format!("PointLight {{ position 0 1 0 color 1 1 1 group {group} }}\n");
        let many = |n: u32| (0..n).map(|i| emitter(&format!("g{i}"))).collect::<String>();
        assert!(compiled(&format!("Lights {{ {} }}", many(7))).is_ok());
        assert_eq!(error(&many(8)), "a scene has at most 7 groups of lights, and `other`");
        assert!(error(&emitter("\"a b\"")).contains("letters, digits"));
        let dark = compiled("Materials { Matte { group key } }").unwrap_err();
        assert_eq!(dark, "`group` says nothing without an `emission`");
    }
}
