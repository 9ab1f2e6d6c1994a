//! The `Lights` block.

use kajo_scene::{Args, Diagnostic, Item, Params};

use super::Compiler;
use crate::family::Pooled;
use crate::light::{DirectionalLight, PointLight};

const KEYWORDS: [&str; 2] = ["DirectionalLight", "PointLight"];
const LATER: [&str; 4] = ["AreaLight", "EnvironmentLight", "SpotLight", "SunSky"];

impl Compiler<'_> {
    pub(super) fn lights(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        params.later(&LATER);
        let count = params.block("numLights");
        let lights = params.take(&KEYWORDS);
        params.finish();
        // A misspelt light was meant to be one.
        let n_blocks = item.children().filter(Item::has_block).count();
        self.check_count("numLights", count, n_blocks, "light");
        for light in lights {
            let id = match light.keyword() {
                "DirectionalLight" => {
                    self.read(light, read_directional).and_then(|light| light.store(&mut self.lights))
                }
                _ => self.read(light, read_point).and_then(|light| light.store(&mut self.lights)),
            };
            self.light_list.extend(id);
        }
    }
}

fn read_directional(params: &mut Params<'_, '_>) -> Option<DirectionalLight> {
    params.name();
    let direction = params.required("direction", |args| {
        let direction = args.vec3()?;
        direction.try_normalize().ok_or_else(|| args.error("`direction` must not be zero"))
    });
    let color = params.required("color", Args::vec3);
    Some(DirectionalLight { to_light: -direction?, intensity: color?.into() })
}

fn read_point(params: &mut Params<'_, '_>) -> Option<PointLight> {
    params.name();
    let position = params.required("position", Args::vec3);
    let color = params.required("color", Args::vec3);
    let attenuation = params.optional("attenuation", Args::numbers::<3>);
    let falloff = params.optional("falloff", |args| Ok((args.number()?, args.item())));
    if let (Some(_), Some((_, item))) = (attenuation, falloff) {
        let error = Diagnostic::error("a light has either `attenuation` or `falloff`, not both");
        params.diagnostics().push(error.label(item.head_span(), "the other one is above or below"));
    }
    let attenuation = attenuation.or(falloff.map(|(f, _)| [0.0, 0.0, f])).unwrap_or([1.0, 0.0, 0.0]);
    Some(PointLight { position: position?, intensity: color?.into(), attenuation })
}
