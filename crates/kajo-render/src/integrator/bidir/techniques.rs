//! Which techniques a sample evaluates: all of them, or one alone.
//!
//! A technique is named by the vertices `s` that come from the light and `t` that come from the camera, light and lens
//! counted. Paths of `k` vertices are sampled by `k` of them, `s = 0 .. k - 1`. For one alone the path from the light
//! has no more than `s` vertices and the one from the camera no more than `t`, and only their ends are connected. Its
//! contribution has the same weight as among all others.

/// Techniques that a sample evaluates, with what vertices are merged with.
pub trait Techniques<M>: Copy {
    /// Whether the technique is one of them.
    fn has(self, s: u32, t: u32) -> bool;

    /// Whether one of them has more than `s` vertices from the light.
    fn needs_light_vertex_after(self, s: u32) -> bool;

    /// Whether one of them has more than `t` vertices from the camera.
    fn needs_camera_vertex_after(self, t: u32) -> bool;

    /// What vertices are merged with, if they are.
    fn merging(&self) -> Option<&M>;
}

/// All techniques, and merging where there is something to merge with.
#[derive(Debug)]
pub struct AllTechniques<'a, M>(pub Option<&'a M>);

impl<M> Clone for AllTechniques<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for AllTechniques<'_, M> {}

impl<M> Techniques<M> for AllTechniques<'_, M> {
    #[inline(always)]
    fn has(self, _s: u32, _t: u32) -> bool {
        true
    }

    #[inline(always)]
    fn needs_light_vertex_after(self, _s: u32) -> bool {
        true
    }

    #[inline(always)]
    fn needs_camera_vertex_after(self, _t: u32) -> bool {
        true
    }

    #[inline(always)]
    fn merging(&self) -> Option<&M> {
        self.0
    }
}

/// A sampling technique: how many vertices of the path are drawn from either end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VertexCounts {
    /// From the light.
    pub s: u32,
    /// From the camera.
    pub t: u32,
}

impl VertexCounts {
    /// The technique that a number chooses for paths of `k` vertices, each with the probability `1/k`.
    ///
    /// * `u`: uniform in [0, 1)
    pub fn chosen(k: u32, u: f32) -> VertexCounts {
        let s = ((u * k as f32) as u32).min(k - 1);
        VertexCounts { s, t: k - s }
    }
}

impl<M> Techniques<M> for VertexCounts {
    fn has(self, s: u32, t: u32) -> bool {
        self == VertexCounts { s, t }
    }

    fn needs_light_vertex_after(self, s: u32) -> bool {
        self.s > s
    }

    fn needs_camera_vertex_after(self, t: u32) -> bool {
        self.t > t
    }

    fn merging(&self) -> Option<&M> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_technique_of_a_length_has_its_part_of_the_numbers() {
        for k in 2..9 {
            let mut counts = vec![0; k as usize];
            for i in 0..1000 * k {
                let VertexCounts { s, t } = VertexCounts::chosen(k, (i as f32 + 0.5) / (1000 * k) as f32);
                assert!(s + t == k && t >= 1);
                counts[s as usize] += 1;
            }
            assert!(counts.iter().all(|&n: &u32| n.abs_diff(1000) <= 1), "{counts:?}");
            assert_eq!(VertexCounts::chosen(k, 1.0 - f32::EPSILON / 2.0), VertexCounts { s: k - 1, t: 1 });
        }
    }
}
