//! `PointLight`: light from a point, alike to all sides or as a laboratory measured it.

use std::f32::consts::PI;
use std::sync::Arc;

use kajo_color::Emission;
use kajo_math::{Frame, Vec3, fmath};
use kajo_scene::{Args, Assets, Diagnostic, Item, Params, read_ies, read_limited};

use crate::compile::fields;
use crate::compile::fields::{
    At, Direction, Given, Keys, Plain, Required, Sources, Typed, any_angle, at_least, classic_light,
    direction, emission, keys, number, point, report_beside, report_without, triple,
};
use crate::compile::light_quantities::{classic, physical};
use crate::compile::member::{LightMember, Member};
use crate::compile::spectra::Written;
use crate::ids::LightGroup;
use crate::light::{PhotometricLight, Photometry, PointLight};
use crate::schema::{Around, Block, FieldKind, FieldSpec, FieldValue, Kind};

/// Where a light is.
pub const POSITION: Required<Vec3> = point("position").required("where it is");

keys! {
    PositionKeys {
        position: Vec3 = POSITION,
    }
}

keys! {
    /// How bright a light is that has a place.
    BrightnessKeys<'t> {
        color: Option<At<'t, Written<Emission>>> = classic_light("color")
            .not_beside(&["intensity", "power"])
            .placed()
            .ruled(tint, "none", "brightness by the classic formula"),
        intensity: Option<Emission> = emission("intensity")
            .not_beside(&["color", "power", "ies", "attenuation", "falloff"])
            .unit("W/sr")
            .unlike("none", "1 1 1", "power per solid angle"),
        power: Option<At<'t, Emission>> = emission("power")
            .not_beside(&["color", "intensity", "attenuation", "falloff"])
            .unit("W")
            .placed()
            .unlike("none", "10 10 10", "all the light it gives"),
        attenuation: Given<'t, [f32; 3]> = triple("attenuation")
            .not_beside(&["falloff", "intensity", "power", "ies"])
            .or([1.0, 0.0, 0.0], "divides the colour by c0 + c1 d + c2 d² at the distance d")
            .given(),
        falloff: Option<At<'t, f32>> = number("falloff")
            .not_beside(&["attenuation", "intensity", "power", "ies"])
            .placed()
            .unlike("by `attenuation`", "1", "divides the colour by f d² at the distance d"),
        group: Option<LightGroup> = fields::GROUP,
    }
}

keys! {
    /// Intensities that were measured.
    LuminaireKeys {
        ies: Option<Photometry> = Typed::<Photometry>::new("ies", FieldKind::File)
            .not_beside(&["intensity", "attenuation", "falloff"])
            .option("measured intensities, in place of all these"),
        direction: Direction = direction("direction")
            .only_beside("ies")
            .or([0.0, -1.0, 0.0], "where a measured luminaire points"),
        rotate: f32 = any_angle("rotate").only_beside("ies").or(0.0, "turns a measured luminaire about its axis"),
        scale: f32 = at_least("scale", 0.0).only_beside("ies").or(1.0, "makes a measured luminaire brighter"),
    }
}

pub const MEMBER: LightMember = Member {
    block: Block {
        keyword: "PointLight",
        kind: Kind::Light,
        about: "light from a point to all sides",
        groups: &[PositionKeys::FIELDS, BrightnessKeys::FIELDS, LuminaireKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| match is_measured(item) {
        true => compiler.light(item, read_photometric),
        false => compiler.light(item, read_point),
    },
};

fn is_measured(item: Item<'_>) -> bool {
    item.children().any(|key| key.keyword() == "ies")
}

/// The tint of a measured luminaire; other lights have no colour unless one is written.
fn tint(around: &Around<'_>) -> Option<FieldValue> {
    (around.is_written)("ies").then(|| FieldValue::numbers([1.0; 3]))
}

fn read_point(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<(PointLight, LightGroup)> {
    params.name();
    let keys = PositionKeys::read(params, sources);
    let brightness = BrightnessKeys::read(params, sources);
    report_without(params, LuminaireKeys::FIELDS, "ies");
    LuminaireKeys::read(params, sources);
    brightness?.light(keys?.position, 1.0, params)
}

/// A point light whose intensities are in a file.
fn read_photometric(
    params: &mut Params<'_, '_>,
    sources: &mut Sources<'_>,
) -> Option<(PhotometricLight, LightGroup)> {
    params.name();
    report_beside(params, BrightnessKeys::FIELDS, "ies");
    let position = PositionKeys::read(params, sources);
    let brightness = BrightnessKeys::read(params, sources);
    let LuminaireKeys { ies, direction, rotate, scale } = LuminaireKeys::read(params, sources)?;
    let BrightnessKeys { color, power, group, .. } = brightness?;
    let tint = match color {
        Some(color) => Some(color.value.not_negative(color.item, params.diagnostics())?),
        None => None,
    };
    if let (Some(_), Some(power)) = (&tint, &power) {
        let error = Diagnostic::error("a luminaire has either `color` or `power`, not both");
        params.diagnostics().push(error.label(power.item.head_span(), "the other one is above or below"));
    }
    let photometry = ies?;
    let (intensity, emission) = physical(match power {
        Some(power) => power.value.scaled(scale * share_of_each(photometry.flux() as f32)),
        None => tint.unwrap_or_else(|| Emission::from_rgb([1.0; 3])).scaled(scale),
    });
    // Horizontal angles begin at the side of x, or of z where the axis is along x.
    let axis = direction.0;
    let side = if axis.x.abs() < 0.999 { Vec3::X } else { Vec3::Z };
    let frame = Frame::from_tangent(axis, side);
    let (sin, cos) = fmath::sin_cos(rotate.to_radians());
    let frame = Frame::from_tangent(axis, frame.s * cos - frame.t * sin);
    let position = position?.position;
    let light = PhotometricLight { position, frame, photometry: Arc::new(photometry), emission, intensity };
    Some((light, group.unwrap_or_default()))
}

/// Bytes of the largest file of intensities.
const LARGEST_IES_FILE: u64 = 16 << 20;

impl Plain<'_> for Photometry {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<Photometry, Diagnostic> {
        let assets: &dyn Assets = sources.textures.spectra.assets;
        let name = args.text()?;
        let bytes = assets.open(&name, args.item().path());
        let bytes = bytes.and_then(|file| read_limited(file, LARGEST_IES_FILE)).map_err(|e| e.to_string());
        let read = bytes.and_then(|bytes| read_ies(&bytes).map_err(|e| e.to_string()));
        read.map(Photometry::from).map_err(|reason| args.error(format!("cannot read `{name}`: {reason}")))
    }
}

/// What each of so many units of solid angle or flux has of a whole; nothing where there are none.
fn share_of_each(units: f32) -> f32 {
    if units > 0.0 { 1.0 / units } else { 0.0 }
}

impl BrightnessKeys<'_> {
    /// The light of this brightness.
    ///
    /// * `share`: the part of all directions that the light fills, for a light given by its power
    pub fn light(
        self,
        position: Vec3,
        share: f32,
        params: &mut Params<'_, '_>,
    ) -> Option<(PointLight, LightGroup)> {
        let BrightnessKeys { color, intensity, power, attenuation, falloff, group } = self;
        let group = group.unwrap_or_default();
        if let (Some(_), Some(falloff)) = (attenuation.item, &falloff) {
            let error = Diagnostic::error("a light has either `attenuation` or `falloff`, not both");
            params
                .diagnostics()
                .push(error.label(falloff.item.head_span(), "the other one is above or below"));
        }
        params.either(&["color", "intensity", "power"], "a light");
        let written = attenuation.item.or(falloff.as_ref().map(|falloff| falloff.item));
        let of_power = power.map(|power| power.value.scaled(share_of_each(4.0 * PI * share)));
        if let Some(intensity) = of_power.or(intensity) {
            if let Some(item) = written {
                let message = "a light with `intensity` or `power` falls off with the square of the distance";
                let error = Diagnostic::error(message).label(item.head_span(), "leave this out");
                let help = "a light with a `color` has the falloff that is written";
                params.diagnostics().push(error.help(help));
            }
            let (intensity, emission) = physical(intensity);
            let light = PointLight { position, intensity, emission, attenuation: [0.0, 0.0, 1.0] };
            return Some((light, group));
        }
        let Some(color) = color else {
            params.report_missing("color");
            return None;
        };
        let (intensity, emission) = classic(color.value);
        let attenuation = match falloff {
            Some(falloff) if attenuation.item.is_none() => [0.0, 0.0, falloff.value],
            _ => attenuation.value,
        };
        if let Some(key) = written.filter(|_| attenuation == [0.0; 3]) {
            let error =
                Diagnostic::error(format!("`{}` of zero would divide the light by zero", key.keyword()));
            let error = error.label(key.span(), "only zeros");
            params.diagnostics().push(error.help("leave it out for light that does not fall off"));
            return None;
        }
        Some((PointLight { position, intensity, emission, attenuation }, group))
    }
}
