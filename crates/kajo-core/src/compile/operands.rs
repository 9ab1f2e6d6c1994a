//! What textures are made of, as their blocks say it.

use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use super::fields::{COLORS, Sources};
use super::named_texture::{NamedTexture, is_spectrum};
use crate::schema::{FieldKind, FieldSpec};

/// What another texture is written by.
pub(super) const OPERAND: FieldSpec = FieldSpec {
    about: "what it is made of: the name of a texture, a picture, a number, or a colour",
    ..FieldSpec::new("texture", FieldKind::Text).or_texture(&COLORS)
};

impl Sources<'_> {
    /// A texture where any may stand: a name, a picture, a function, one number, or three of a colour.
    pub fn operand(&mut self, item: Item<'_>, diagnostics: &mut Diagnostics) -> Option<NamedTexture> {
        if let Some(named) = self.named_texture(item, diagnostics, is_spectrum) {
            Args::read(item, diagnostics, |args| args.text())?;
            return named;
        }
        let is_number = item.function().is_some() || (item.word().is_none() && item.numbers().count() == 1);
        if is_number {
            let spec = FieldSpec { kind: FieldKind::SHARE, ..OPERAND };
            return self.float(&spec, item, diagnostics).map(NamedTexture::Float);
        }
        self.color(item, diagnostics).map(NamedTexture::Color)
    }

    /// All items of a block that are its [`OPERAND`]s; fewer or more than it takes are reported.
    pub fn operands(
        &mut self,
        params: &mut Params<'_, '_>,
        [least, most]: [usize; 2],
    ) -> Option<Vec<NamedTexture>> {
        let items = params.take(&[OPERAND.key]);
        if items.len() < least || items.len() > most {
            let wanted = match (least, most) {
                (1, 1) => "one `texture`".to_owned(),
                (2, 2) => "two `texture`".to_owned(),
                (least, most) => format!("{least} to {most} `texture`"),
            };
            params.report(
                Diagnostic::error(format!("expected {wanted}, found {}", items.len())),
                "is made of these",
            );
            return None;
        }
        let found: Vec<_> = items.into_iter().map(|item| self.operand(item, params.diagnostics())).collect();
        found.into_iter().collect()
    }
}
