//! Nodes moved in the world.
//!
//! The numbers of the node itself say the movement where they can. If not, the operations of the transform around
//! it do; and where there is none, the node is wrapped in one. Operations are kept in the order
//!
//! ```text
//! Translate  rotations  Scale
//! ```
//!
//! if that is what they are, and a movement changes their numbers or inserts those that are missing. Whatever cannot be
//! said so becomes a `Matrix`, which multiplies from the left wherever it stands.

use kajo_core::compile::BLOCK_OPERATIONS;
use kajo_math::{DAffine3, DMat3, DVec3};
use kajo_scene::Item;

use super::movement::{Linear, Movement, axis_and_angle, turn};
use super::reshape::{tidy, vector};
use super::tree::Tree;
use super::{EditRefused, FieldValue, Node, TextEdit, layout};
use kajo_core::schema::Kind;
use kajo_core::schema::number_text;

impl Tree {
    /// Moves a node.
    ///
    /// * `movement`: in world space
    pub(super) fn displace(&self, node: &Node, movement: &Movement) -> Result<Vec<TextEdit>, EditRefused> {
        let can_move = node.kind.is_object() || matches!(node.kind, Kind::Light | Kind::Camera);
        if !can_move || node.kind == Kind::Group && node.parent.is_none() {
            return Err(EditRefused::new(format!(
                "this `{}` cannot be moved: move what is in it",
                node.keyword
            )));
        }
        let node = self.sole_content_of(node);
        let local = movement.within(&self.placement(node));
        let flat = || EditRefused::new("what stands here is flattened to nothing");
        let local = local.filter(|local| local.map().is_finite()).ok_or_else(flat)?;
        if local.linear() == Linear::Mirrored && local.map().matrix3.determinant() == 0.0 {
            return Err(EditRefused::new("that would flatten it to nothing"));
        }
        if local.is_nothing() {
            return Ok(Vec::new());
        }
        if matches!(node.kind, Kind::Transform | Kind::Instance) {
            return self.operate(node, &local);
        }
        match self.reshaped(node, &local) {
            Some(values) => self.set_values(node, values),
            None => Ok(self.wrapped(node, &local)),
        }
    }

    /// Sets several values of a block. Those that are absent and stay at their defaults are not written.
    fn set_values(&self, node: &Node, values: super::reshape::Values) -> Result<Vec<TextEdit>, EditRefused> {
        let mut edits = Vec::new();
        for (key, value) in values {
            if self.value_item(node, key, None).is_some()
                || self.numbers_of(node, key) != Some(value.numbers.clone())
            {
                edits.extend(self.set_field(node, key, None, Some(&value))?);
            }
        }
        Ok(edits)
    }

    /// Puts a node into a transform of its own.
    fn wrapped(&self, node: &Node, movement: &Movement) -> Vec<TextEdit> {
        let placed = Placed::default();
        let operations = match placed.moved(movement) {
            Some(placed) => placed.text(),
            None => self.matrix(&movement.map()),
        };
        vec![
            TextEdit::insert(node.file, node.span.start, format!("Transform {{ {operations}  ")),
            TextEdit::insert(node.file, node.span.end, " }"),
        ]
    }

    /// The operations that make a map; none for the identity.
    pub(super) fn operations_of(&self, map: &DAffine3) -> String {
        let (scale, rotation, translation) = map.to_scale_rotation_translation();
        let again = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
        if !again.abs_diff_eq(map.matrix3, 1e-9 * scale.abs().max_element()) {
            return self.matrix(map);
        }
        let placed =
            Placed { translation, scale: scale.map(|factor| tidy(factor, 0.0)), ..Placed::default() };
        match axis_and_angle(rotation) {
            (_, degrees) if degrees < 1e-9 => placed.text(),
            (axis, degrees) => placed.turned(axis, degrees).text(),
        }
    }

    /// `Matrix` with its numbers.
    fn matrix(&self, map: &DAffine3) -> String {
        let numbers = self.matrix_numbers(map).into_iter().map(number_text).collect::<Vec<_>>();
        format!("Matrix {{ {} }}", numbers.join(" "))
    }

    fn matrix_numbers(&self, map: &DAffine3) -> Vec<f64> {
        let column = |v: DVec3, w: f64| {
            let scale = v.abs().max_element();
            [tidy(v.x, scale), tidy(v.y, scale), tidy(v.z, scale), w]
        };
        let m = map.matrix3;
        let columns = [
            column(m.x_axis, 0.0),
            column(m.y_axis, 0.0),
            column(m.z_axis, 0.0),
            column(map.translation, 1.0),
        ];
        let at = |i: usize| if self.matrix_by_rows() { columns[i % 4][i / 4] } else { columns[i / 4][i % 4] };
        (0..16).map(at).collect()
    }

    /// Changes the operations of a transform or an instance.
    fn operate(&self, node: &Node, movement: &Movement) -> Result<Vec<TextEdit>, EditRefused> {
        let operations: Vec<Item<'_>> = self.values_of(node).collect();
        let is_matrix = |item: &&Item<'_>| item.keyword().starts_with("Matrix");
        if let Some(last) = operations.iter().rev().find(is_matrix) {
            let old = self.operation_map(*last);
            let moved = self.matrix_numbers(&(movement.map() * old));
            return self.set_values_of(*last, &FieldValue::numbers(moved));
        }
        if let Some(placed) = self.placed(node, &operations)
            && let Some(moved) = placed.moved(movement)
        {
            return self.replaced(node, &operations, &placed, &moved);
        }
        let first = operations.first().copied();
        match (*movement, first.filter(|first| first.keyword() == "Translate")) {
            (Movement::Translate(by), Some(first)) => {
                let old = DVec3::from_array(FieldValue::of(first).vec3().unwrap_or_default());
                self.set_values_of(first, &vector(old + by))
            }
            (Movement::Translate(by), None) => {
                self.insert_operation(node, Where::First, &format!("Translate {}", vector(by).text()))
            }
            _ => self.insert_operation(node, Where::Last, &self.matrix(&movement.map())),
        }
    }

    fn operation_map(&self, item: Item<'_>) -> DAffine3 {
        kajo_core::compile::operations_matrix(std::iter::once(item), self.matrix_by_rows())
    }

    /// The operations, if they are a translation, rotations and a scaling in this order.
    fn placed(&self, node: &Node, operations: &[Item<'_>]) -> Option<Placed> {
        if self.outline.children(Some(node.id)).any(|child| BLOCK_OPERATIONS.contains(&&*child.keyword)) {
            return None;
        }
        let mut placed = Placed::default();
        for (i, item) in operations.iter().enumerate() {
            let value = FieldValue::of(*item);
            let numbers = || value.vec3().map(DVec3::from_array);
            let rotation = rotation_of(item.keyword(), &value);
            match item.keyword() {
                "Translate" if i == 0 => placed.translation = numbers()?,
                "Scale" if placed.scale_at.is_none() => {
                    (placed.scale, placed.scale_at) = (numbers()?, Some(i));
                }
                "UniformScale" if placed.scale_at.is_none() => {
                    (placed.scale, placed.scale_at) = (DVec3::splat(*value.numbers.first()?), Some(i));
                }
                _ if placed.scale_at.is_some() => return None,
                _ => {
                    let (axis, degrees) = rotation?;
                    match placed.first_turn {
                        None => placed.first_turn = Some((axis, degrees)),
                        Some(_) => placed.other_turns *= DMat3::from_quat(turn(axis, degrees)),
                    }
                    placed.turn_at = placed.turn_at.or(Some(i));
                }
            }
        }
        placed.translate_at = operations.first().filter(|item| item.keyword() == "Translate").map(|_| 0);
        Some(placed)
    }

    /// Edits that lead from operations to others.
    fn replaced(
        &self,
        node: &Node,
        operations: &[Item<'_>],
        old: &Placed,
        new: &Placed,
    ) -> Result<Vec<TextEdit>, EditRefused> {
        if operations.is_empty() {
            let pieces: Vec<String> = new.changed(old).map(|(_, piece)| piece).collect();
            return self.insert_operation(node, Where::First, &pieces.join("  "));
        }
        let mut edits = Vec::new();
        for (part, piece) in new.changed(old) {
            let (present, place) = match part {
                Part::Translation => (old.translate_at, Where::First),
                Part::Turn => (old.turn_at.filter(|_| new.extends_turn), Where::AfterTranslation),
                Part::Scale => (old.scale_at, Where::Last),
            };
            match present.map(|i| operations[i]) {
                Some(item) => edits.extend(self.rewritten(item, &piece)?),
                None => edits.extend(self.insert_operation(node, place, &piece)?),
            }
        }
        Ok(edits)
    }

    /// Puts an operation in the place of another: only its numbers where the word stays.
    fn rewritten(&self, item: Item<'_>, piece: &str) -> Result<Vec<TextEdit>, EditRefused> {
        let (word, numbers) = piece.split_once(' ').unwrap_or((piece, ""));
        let value = FieldValue::parse(numbers);
        if item.keyword() == word {
            return self.set_values_of(item, &value);
        }
        if let ("Scale", [factor]) = (item.keyword(), &*value.numbers) {
            return self.set_values_of(item, &FieldValue::numbers([*factor; 3]));
        }
        if self.has_keys(item) {
            return Err(EditRefused::new(format!(
                "`{}` has keys, which that would take away",
                item.keyword()
            )));
        }
        let (file, range) = self.range(item);
        Ok(vec![TextEdit { file, range, new: piece.to_owned() }])
    }

    fn insert_operation(&self, node: &Node, place: Where, piece: &str) -> Result<Vec<TextEdit>, EditRefused> {
        let text = self.text(node.file);
        let here = |item: &Item<'_>| self.file_of(item.span().source) == node.file;
        let operations: Vec<Item<'_>> = self.values_of(node).filter(here).collect();
        let first_child = self.item(node).and_then(|item| item.children().find(here));
        let first = operations.first();
        let translate = first.filter(|first| first.keyword() == "Translate");
        let after = match place {
            Where::First => None,
            Where::AfterTranslation => translate,
            Where::Last => operations.last(),
        };
        let (at, new) = match (after, first_child) {
            (Some(after), _) => layout::after(text, &self.range(*after).1, piece),
            (None, Some(child)) => layout::before(text, self.range(child).1.start, piece),
            (None, None) => match layout::first_in(text, &node.span, piece) {
                Some(place) => place,
                None => (node.span.end, format!(" {{ {piece} }}")),
            },
        };
        Ok(vec![TextEdit::insert(node.file, at, new)])
    }
}

/// Where an operation goes.
#[derive(Clone, Copy)]
enum Where {
    First,
    AfterTranslation,
    Last,
}

/// A part of a [`Placed`].
#[derive(Clone, Copy)]
enum Part {
    Translation,
    Turn,
    Scale,
}

/// The unit axis and the degrees of a rotation; `None` for other operations, and for axes that are not of unit length.
fn rotation_of(keyword: &str, value: &FieldValue) -> Option<(DVec3, f64)> {
    let degrees = *value.numbers.last()?;
    let axis = match keyword {
        "XRotate" => DVec3::X,
        "YRotate" => DVec3::Y,
        "ZRotate" => DVec3::Z,
        "Rotate" => DVec3::from_array(value.vec3()?),
        _ => return None,
    };
    (value.numbers.len() == if keyword == "Rotate" { 4 } else { 1 } && (axis.length() - 1.0).abs() < 1e-6)
        .then_some((axis, degrees))
}

/// `T R S`, as operations in this order.
#[derive(Clone, Debug)]
struct Placed {
    translation: DVec3,
    translate_at: Option<usize>,
    /// The first rotation.
    first_turn: Option<(DVec3, f64)>,
    /// The product of the others.
    other_turns: DMat3,
    turn_at: Option<usize>,
    /// Whether `first_turn` takes the place of the one that was there, not a place before it.
    extends_turn: bool,
    scale: DVec3,
    scale_at: Option<usize>,
}

impl Default for Placed {
    fn default() -> Placed {
        Placed {
            translation: DVec3::ZERO,
            translate_at: None,
            first_turn: None,
            other_turns: DMat3::IDENTITY,
            turn_at: None,
            extends_turn: false,
            scale: DVec3::ONE,
            scale_at: None,
        }
    }
}

impl Placed {
    fn rotation(&self) -> DMat3 {
        let first =
            self.first_turn.map_or(DMat3::IDENTITY, |(axis, degrees)| DMat3::from_quat(turn(axis, degrees)));
        first * self.other_turns
    }

    /// The same after a movement of the outer space; `None` where it would be no longer `T R S`.
    fn moved(&self, movement: &Movement) -> Option<Placed> {
        let translation = movement.map().transform_point3(self.translation);
        let moved = Placed { translation, ..self.clone() };
        match *movement {
            Movement::Translate(_) => Some(moved),
            Movement::Rotate { axis, degrees, .. } => Some(moved.turned(axis, degrees)),
            Movement::Scale { axes, factors, .. } => {
                let own = self.rotation().transpose() * axes;
                let scaling = own * DMat3::from_diagonal(factors) * own.transpose();
                // Along the operations' own axes, whichever of these it names.
                let factors = scaling.diagonal();
                if !scaling.abs_diff_eq(DMat3::from_diagonal(factors), 1e-9) {
                    return None;
                }
                Some(Placed { scale: self.scale * factors, ..moved })
            }
            Movement::Map(_) => None,
        }
    }

    fn turned(self, axis: DVec3, degrees: f64) -> Placed {
        let (axis, degrees) = neat(axis, degrees);
        let Some((old_axis, old_degrees)) = self.first_turn else {
            return Placed { first_turn: Some((axis, degrees)), extends_turn: false, ..self };
        };
        let along = axis.dot(old_axis);
        if along.abs() > 1.0 - 1e-9 {
            let sum = wrapped(old_degrees + degrees * along.signum());
            return Placed { first_turn: Some((old_axis, sum)), extends_turn: true, ..self };
        }
        if is_coordinate_axis(old_axis) {
            let others = DMat3::from_quat(turn(old_axis, old_degrees)) * self.other_turns;
            return Placed {
                first_turn: Some((axis, degrees)),
                other_turns: others,
                extends_turn: false,
                ..self
            };
        }
        let both = axis_and_angle(turn(axis, degrees) * turn(old_axis, old_degrees));
        Placed { first_turn: Some(both), extends_turn: true, ..self }
    }

    /// All its operations, as they are written.
    fn text(&self) -> String {
        self.changed(&Placed::default()).map(|(_, piece)| piece).collect::<Vec<_>>().join("  ")
    }

    /// The operations that differ from those of `old`, as they are written.
    fn changed(&self, old: &Placed) -> impl Iterator<Item = (Part, String)> {
        let translation = (self.translation.distance(old.translation) > 1e-12 * self.translation.length())
            .then(|| (Part::Translation, format!("Translate {}", vector(self.translation).text())));
        let turn = self.first_turn.filter(|_| self.first_turn != old.first_turn).map(|(axis, degrees)| {
            let degrees = number_text(tidy(degrees, 1.0));
            let piece =
                match [("X", DVec3::X), ("Y", DVec3::Y), ("Z", DVec3::Z)].iter().find(|(_, a)| *a == axis) {
                    Some((name, _)) => format!("{name}Rotate {degrees}"),
                    None => format!("Rotate {} {degrees}", vector(axis).text()),
                };
            (Part::Turn, piece)
        });
        let scale = (self.scale != old.scale).then(|| {
            let [x, y, z] = self.scale.to_array().map(|factor| tidy(factor, 0.0));
            let is_equal = x == y && x == z;
            let piece = match is_equal {
                true => format!("UniformScale {}", number_text(x)),
                false => format!("Scale {}", FieldValue::numbers([x, y, z]).text()),
            };
            (Part::Scale, piece)
        });
        [translation, turn, scale].into_iter().flatten()
    }
}

/// The same turn, around a coordinate axis if that is meant.
fn neat(axis: DVec3, degrees: f64) -> (DVec3, f64) {
    for coordinate in [DVec3::X, DVec3::Y, DVec3::Z] {
        let along = axis.dot(coordinate);
        if along.abs() > 1.0 - 1e-12 {
            return (coordinate, degrees * along.signum());
        }
    }
    (axis, degrees)
}

fn is_coordinate_axis(axis: DVec3) -> bool {
    [DVec3::X, DVec3::Y, DVec3::Z].contains(&axis)
}

/// An angle in degrees within (-180, 180].
fn wrapped(degrees: f64) -> f64 {
    let turned = degrees.rem_euclid(360.0);
    if turned > 180.0 { turned - 360.0 } else { turned }
}

#[cfg(test)]
mod tests;
