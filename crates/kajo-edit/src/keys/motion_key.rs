//! New keys of a `Motion`, as operations that lead to where things are at that moment.

use kajo_core::compile::operations_matrix;
use kajo_core::schema::number_text;
use kajo_math::{DAffine3, DMat3, DQuat, DVec3, Keyframes, fmath};

use super::KEY;
use super::edits::single;
use crate::tree::Tree;
use crate::{EditRefused, Node};

/// How far a map may be from one that is written by fewer operations.
const SAME_MAP: f64 = 1e-9;

impl Tree {
    /// The text of a key at a moment of a `Motion`, at which nothing moves otherwise for it.
    ///
    /// * `frame`: the moment
    pub(super) fn motion_key_text(&self, node: &Node, frame: f64) -> Result<String, EditRefused> {
        let time = self.time_text(frame);
        let by_rows = self.matrix_by_rows();
        let key = |item: kajo_scene::Item<'_>| {
            Some((item.numbers().next()?.0, operations_matrix(item.children(), by_rows)))
        };
        let keys: Vec<(f64, DAffine3)> = self.motion_keys(node).filter_map(key).collect();
        let motion = Keyframes::new(&keys).map_err(|_| {
            EditRefused::new("there is a mistake in the keys of this `Motion`: correct it in the text")
        })?;
        let seconds = time.parse().map_err(|_| EditRefused::new("this frame has no time"))?;
        let operations = operations_text(&motion.at(seconds), by_rows);
        let space = if operations.is_empty() { "" } else { " " };
        Ok(format!("{KEY} {time} {{{space}{operations} }}"))
    }
}

/// The operations that make a map: a turn, a size and a place, or where it shears a matrix.
///
/// * `by_rows`: how the numbers of a matrix are ordered
fn operations_text(map: &DAffine3, by_rows: bool) -> String {
    let numbers = |numbers: &[f64]| {
        let texts: Vec<String> = numbers.iter().map(|&n| number_text(single(n))).collect();
        texts.join(" ")
    };
    let (scale, turn, place) = map.to_scale_rotation_translation();
    let again = DMat3::from_quat(turn) * DMat3::from_diagonal(scale);
    let size = map.matrix3.x_axis.length().max(map.matrix3.y_axis.length()).max(map.matrix3.z_axis.length());
    if !again.abs_diff_eq(map.matrix3, SAME_MAP * size) {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = map.matrix3;
        let columns = [x.extend(0.0), y.extend(0.0), z.extend(0.0), place.extend(1.0)];
        let value = |i: usize, k: usize| if by_rows { columns[k][i] } else { columns[i][k] };
        let all: Vec<f64> = (0..16).map(|at| value(at / 4, at % 4)).collect();
        return format!("Matrix {{ {} }}", numbers(&all));
    }
    let mut parts = Vec::new();
    if place != DVec3::ZERO {
        parts.push(format!("Translate {}", numbers(&place.to_array())));
    }
    let (axis, degrees) = axis_and_degrees(turn);
    if degrees != 0.0 {
        let word = [DVec3::X, DVec3::Y, DVec3::Z].iter().position(|known| axis.abs_diff_eq(*known, SAME_MAP));
        match word {
            Some(i) => {
                parts.push(format!("{} {}", ["XRotate", "YRotate", "ZRotate"][i], numbers(&[degrees])))
            }
            None => parts.push(format!("Rotate {} {}", numbers(&axis.to_array()), numbers(&[degrees]))),
        }
    }
    if (scale - scale.x).abs().max_element() <= SAME_MAP * size {
        if (scale.x - 1.0).abs() > SAME_MAP {
            parts.push(format!("UniformScale {}", numbers(&[scale.x])));
        }
    } else {
        parts.push(format!("Scale {}", numbers(&scale.to_array())));
    }
    parts.join("  ")
}

/// The axis of a turn, with a positive first number that is not zero, and its angle.
fn axis_and_degrees(turn: DQuat) -> (DVec3, f64) {
    let v = DVec3::new(turn.x, turn.y, turn.z);
    let length = v.length();
    if length <= SAME_MAP {
        return (DVec3::Y, 0.0);
    }
    let half = fmath::atan2_64(length, turn.w);
    let axis = v / length;
    let first = axis.to_array().into_iter().find(|x| x.abs() > SAME_MAP).unwrap_or(1.0);
    let degrees = (2.0 * half).to_degrees();
    let degrees = if degrees > 180.0 { degrees - 360.0 } else { degrees };
    if first < 0.0 { (-axis, -degrees) } else { (axis, degrees) }
}
