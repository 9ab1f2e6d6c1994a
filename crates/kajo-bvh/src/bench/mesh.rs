//! Mesh files.

use std::fs;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

use kajo_math::Vec3;

/// Triangles, and from where to look at them.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// The file's name without folder and ending.
    pub name: String,
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Triangles, as indices of vertices.
    pub triangles: Vec<[u32; 3]>,
    /// The camera's place.
    pub eye: Vec3,
    /// What the camera looks at.
    pub target: Vec3,
    /// Upward direction.
    pub up: Vec3,
    /// Vertical field of view in degrees.
    pub fov_degrees: f32,
    /// A point light.
    pub light: Vec3,
    /// How far secondary rays start from their surface.
    pub eps: f32,
}

const HEAD: usize = 72;

impl Mesh {
    /// Reads a `KMSH` file.
    pub fn read(path: &Path) -> Result<Mesh> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Mesh::parse(name, &fs::read(path)?)
    }

    fn parse(name: String, bytes: &[u8]) -> Result<Mesh> {
        let malformed = |what: &str| Error::new(ErrorKind::InvalidData, format!("{name}: {what}"));
        let (head, body) = bytes.split_at_checked(HEAD).ok_or_else(|| malformed("too short"))?;
        let (words, _) = head.as_chunks::<4>();
        if &words[0] != b"KMSH" || u32::from_le_bytes(words[1]) != 1 {
            return Err(malformed("not a mesh file of version 1"));
        }
        let float = |i: usize| f32::from_le_bytes(words[i]);
        let vector = |i: usize| Vec3::new(float(i), float(i + 1), float(i + 2));
        let count = |i: usize| u32::from_le_bytes(words[i]) as usize;
        let (n_vertices, n_triangles) = (count(2), count(3));
        let (rows, rest) = body.as_chunks::<12>();
        if !rest.is_empty() || n_vertices.checked_add(n_triangles) != Some(rows.len()) {
            return Err(malformed("its size is not what its head says"));
        }
        let (positions, triangles) = rows.split_at(n_vertices);
        let word = |row: &[u8; 12], i: usize| [row[4 * i], row[4 * i + 1], row[4 * i + 2], row[4 * i + 3]];
        let position = |row| Vec3::from_array([0, 1, 2].map(|i| f32::from_le_bytes(word(row, i))));
        let triangle = |row| [0, 1, 2].map(|i| u32::from_le_bytes(word(row, i)));
        Ok(Mesh {
            eye: vector(4),
            target: vector(7),
            up: vector(10),
            fov_degrees: float(13),
            light: vector(14),
            eps: float(17),
            positions: positions.iter().map(position).collect(),
            triangles: triangles.iter().map(triangle).collect(),
            name,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Vec<u8> {
        let mut bytes = b"KMSH".to_vec();
        bytes.extend([1u32, 3, 1].iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend((0..14).flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend((0..9).flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend([0u32, 1, 2].iter().flat_map(|x| x.to_le_bytes()));
        bytes
    }

    #[test]
    fn fields_come_from_their_places() {
        let mesh = Mesh::parse("m".into(), &file()).unwrap();
        assert_eq!((mesh.eye, mesh.up), (Vec3::new(0.0, 1.0, 2.0), Vec3::new(6.0, 7.0, 8.0)));
        assert_eq!((mesh.fov_degrees, mesh.light, mesh.eps), (9.0, Vec3::new(10.0, 11.0, 12.0), 13.0));
        assert_eq!((mesh.positions[2], mesh.triangles[0]), (Vec3::new(6.0, 7.0, 8.0), [0, 1, 2]));
    }

    #[test]
    fn every_truncation_is_refused() {
        let whole = file();
        for length in 0..whole.len() {
            assert!(Mesh::parse("m".into(), &whole[..length]).is_err(), "{length} bytes");
        }
        let mut lying = whole;
        lying[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(Mesh::parse("m".into(), &lying).is_err());
    }
}
