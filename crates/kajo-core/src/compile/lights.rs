//! The `Lights` block.

use kajo_scene::{Diagnostic, Item, Params, Span};

use super::Compiler;
use super::blocks::{LIGHT_COUNT, LIGHT_LIST, LIGHTS as MEMBERS};
use super::fields::Sources;
use super::member::keywords;
use super::misplaced::misplaced;
use crate::ids::LightGroup;
use crate::light::AnyLight;

pub(super) const KEYWORDS: [&str; MEMBERS.len()] = keywords(&MEMBERS);

/// Words of other programs for lights that are written elsewhere here, and where that is.
const ELSEWHERE: [(&str, &str); 3] = [
    ("AreaLight", "any object gives light whose material has an emission: `Matte emitter { emission 5 }`"),
    ("EnvironmentLight", "write it around the scene: `Background { environment \"sky.exr\" }`"),
    ("SunSky", "write it around the scene: `Background { sky { } }`"),
];

impl Compiler<'_> {
    pub(super) fn lights(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        let count = params.block(LIGHT_COUNT.key);
        let lights = params.take(&KEYWORDS);
        params.elsewhere(written_elsewhere);
        params.elsewhere(|item| misplaced(item, Some(LIGHT_LIST.keyword)));
        params.finish();
        // A misspelt light was meant to be one.
        let n_blocks = item.children().filter(Item::has_block).count();
        self.check_count(count, n_blocks, "light");
        for light in lights {
            if let Some(member) = MEMBERS.iter().find(|member| member.block.keyword == light.keyword()) {
                (member.read)(self, light);
            }
        }
    }

    /// Adds the light that `read` makes of an item.
    pub(super) fn light<'t, L: Into<AnyLight>>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<(L, LightGroup)>,
    ) {
        if let Some((light, group)) = self.read_keys(item, read) {
            self.add_light(light, group, item.head_span());
        }
    }

    /// Puts a light that stands at `at` into its group.
    pub(super) fn add_light(&mut self, light: impl Into<AnyLight>, group: LightGroup, at: Span) {
        let added = self.scene.light_in(group, light);
        self.accepted(added, at);
    }
}

/// The error for a light of other programs.
fn written_elsewhere(item: Item<'_>) -> Option<Diagnostic> {
    let (word, help) = ELSEWHERE.iter().find(|(word, _)| *word == item.keyword())?;
    let error = Diagnostic::error(format!("`{word}` is no word of this language"));
    Some(error.label(item.keyword_span(), "not a light of its own").help(*help))
}

#[cfg(test)]
mod tests {
    use kajo_math::{Vec2, Vec3};
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use crate::compile::{CompileOptions, compile};
    use crate::light::tests::sample_li;
    use crate::scene::Scene;

    /// The scene with this light, or the errors.
    fn compiled(light: &str) -> Result<Scene, String> {
        let head = "TILT=NONE\n1 -1 1  2 3 1 2  0 0 0\n1 1 60\n0 180\n";
        let assets = MemoryAssets::new()
            .with("luminaire.ies", format!("{head}0 90 180\n100 100\n200 200\n300 300\n"))
            .with("bad.ies", format!("{head}0 90 180\n100 100\n"));
        let camera = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }";
        let mut parsed = SceneDesc::parse_str(&format!("{camera} Lights {{ {light} }}"));
        let mut diagnostics = Diagnostics::default();
        let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
        let said: Vec<_> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join("; "))
    }

    /// Irradiance at the point `p` from a luminaire at the origin.
    fn irradiance(keys: &str, p: Vec3) -> f32 {
        let scene = compiled(&format!("PointLight {{ position 0 0 0  ies luminaire.ies  {keys} }}")).unwrap();
        sample_li(&scene.lighting.lights.photometric[0], p, Vec2::ZERO).unwrap().radiance[0]
    }

    #[test]
    fn luminaires_are_turned_tinted_and_scaled() {
        let near =
            |found: f32, expected: f32| assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        // Straight down, the angle 0 is at the side of x, and 90 at that of -z.
        near(irradiance("", 2.0 * Vec3::X), 25.0);
        near(irradiance("", 2.0 * Vec3::NEG_Z), 50.0);
        near(irradiance("rotate 90", Vec3::NEG_Z), 100.0);
        near(irradiance("rotate 90", Vec3::NEG_X), 200.0);
        near(irradiance("direction 0 0 -2", Vec3::X), 100.0);
        near(irradiance("direction 0 0 -2", Vec3::Y), 200.0);
        near(irradiance("direction 1 0 0", Vec3::Z), 100.0);
        near(irradiance("scale 0.5  color 0.5 0.1 0.1", Vec3::X), 25.0);
        // The mean of all directions is 200 candela.
        near(irradiance("power 4", Vec3::NEG_Z), 4.0 / (4.0 * std::f32::consts::PI));
        near(irradiance("power 4", Vec3::X), 2.0 / (4.0 * std::f32::consts::PI));
    }

    #[test]
    fn mistakes_in_luminaires_are_named() {
        let error = |keys: &str| compiled(&format!("PointLight {{ position 0 0 0  {keys} }}")).unwrap_err();
        assert_eq!(error("ies none.ies"), "cannot read `none.ies`: there is no such file");
        assert!(error("ies bad.ies").starts_with("cannot read `bad.ies`: line 6: the file ends"));
        assert!(error("ies luminaire.ies  intensity 3").contains("`intensity` cannot stand beside `ies`"));
        assert!(error("color 1 1 1  rotate 20").contains("`rotate` cannot stand without `ies`"));
        assert!(error("ies luminaire.ies  scale -1").contains("at least 0"));
        assert!(error("ies luminaire.ies  power 3  color 1 1 1").contains("not both"));
    }
}
