//! A number for what a mesh is made of.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::mesh::{CornerValues, MeshData};

impl MeshData {
    /// Numbers that differ for meshes of which anything differs, but for one in 2^64 or fewer. They hold within a run of
    /// the program.
    pub(crate) fn digest(&self) -> [u64; 2] {
        let mut hashers = [DefaultHasher::new(), DefaultHasher::new()];
        // Different beginnings make the two independent.
        hashers[1].write_u64(u64::MAX);
        for hasher in &mut hashers {
            let MeshData { positions, faces, normals, uvs, colors, attributes, material_slots } = self;
            floats(hasher, positions.iter().map(|p| p.to_array()));
            indices(hasher, faces);
            corners(hasher, normals.as_ref(), |n| n.to_array());
            corners(hasher, uvs.as_ref(), |uv| uv.to_array());
            corners(hasher, colors.as_ref(), |color| color.to_array());
            floats(hasher, attributes.second_uvs.iter().map(|uv| uv.to_array()));
            floats(hasher, attributes.tangents.iter().map(|t| t.to_array()));
            hasher.write_usize(material_slots.as_ref().map_or(usize::MAX, Vec::len));
            material_slots.iter().flatten().for_each(|slot| slot.hash(hasher));
        }
        hashers.map(|hasher| hasher.finish())
    }
}

fn floats<const N: usize>(hasher: &mut DefaultHasher, values: impl ExactSizeIterator<Item = [f32; N]>) {
    hasher.write_usize(values.len());
    values.flatten().for_each(|x| hasher.write_u32(x.to_bits()));
}

fn indices(hasher: &mut DefaultHasher, faces: &[[u32; 3]]) {
    hasher.write_usize(faces.len());
    faces.iter().flatten().for_each(|&i| hasher.write_u32(i));
}

fn corners<T: Copy, const N: usize>(
    hasher: &mut DefaultHasher,
    values: Option<&CornerValues<T>>,
    numbers: impl Fn(T) -> [f32; N],
) {
    let Some(CornerValues { values, faces }) = values else { return hasher.write_u8(0) };
    hasher.write_u8(1);
    floats(hasher, values.iter().map(|&value| numbers(value)));
    hasher.write_u8(u8::from(faces.is_some()));
    faces.iter().for_each(|faces| indices(hasher, faces));
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{Vec2, Vec3};

    #[test]
    fn anything_that_differs_makes_another_number() {
        let data = || MeshData {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            faces: vec![[0, 1, 2]],
            uvs: Some(CornerValues { values: vec![Vec2::ZERO; 3], faces: None }),
            ..MeshData::default()
        };
        assert_eq!(data().digest(), data().digest());
        let mut others = [data(), data(), data(), data(), data()];
        others[0].positions[1].x = 2.0;
        others[1].faces[0] = [0, 2, 1];
        others[2].uvs = None;
        others[3].normals = Some(CornerValues { values: vec![Vec3::Z; 3], faces: Some(vec![[0, 1, 2]]) });
        others[4].material_slots = Some(vec![crate::ids::MaterialSlot::NONE]);
        let mut seen = vec![data().digest()];
        for other in others {
            assert!(!seen.contains(&other.digest()));
            seen.push(other.digest());
        }
    }
}
