//! The scene in the memory of the graphics card.

use std::ops::Range;

use kajo_edit::preview::{Atlas, Preview, PreviewInstance, PreviewMesh};
use wgpu::util::DeviceExt as _;

use super::is_within;
use super::pipelines::{COLOR, Pipelines};
use super::vertices::{AtlasPosition, InstanceTransform, Vertex};

/// Corners, triangles and places of everything.
#[derive(Default)]
pub(super) struct SceneBuffers {
    meshes: Vec<MeshBuffers>,
    places: Option<wgpu::Buffer>,
    textures: Option<Textures>,
    /// For each instance its mesh and what it adds to the object numbers of it; sorted by mesh.
    of_instances: Vec<(usize, u32)>,
}

/// The picture of all textures.
struct Textures {
    picture: wgpu::Texture,
    group: wgpu::BindGroup,
}

struct MeshBuffers {
    vertices: wgpu::Buffer,
    /// Where the vertices are in the picture of all textures, if they show any.
    texels: Option<wgpu::Buffer>,
    indices: wgpu::Buffer,
    /// Neighbouring triangles of one object: its number, and the corners' numbers.
    runs: Vec<(u32, Range<u32>)>,
    n_indices: u32,
    /// Whether no corner has a normal.
    is_flat: bool,
}

impl SceneBuffers {
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        preview: &Preview,
    ) -> SceneBuffers {
        let most_rows = device.limits().max_texture_dimension_2d;
        let atlas = preview.atlas.as_ref().filter(|atlas| atlas.size().iter().all(|&side| side <= most_rows));
        let textures = atlas.map(|atlas| Textures::new(device, queue, pipelines, atlas));
        let size = atlas.map(|atlas| atlas.size());
        let meshes: Vec<MeshBuffers> =
            preview.meshes.iter().map(|mesh| MeshBuffers::new(device, mesh, size)).collect();
        let most = device.limits().max_buffer_size as usize / size_of::<InstanceTransform>();
        let instances = &preview.instances[..preview.instances.len().min(most)];
        let rows: Vec<InstanceTransform> = instances.iter().map(transform_of).collect();
        let places = (!rows.is_empty())
            .then(|| buffer(device, "places", bytemuck::cast_slice(&rows), wgpu::BufferUsages::VERTEX));
        let of_instances =
            instances.iter().map(|instance| (instance.mesh as usize, instance.object)).collect();
        SceneBuffers { meshes, places, textures, of_instances }
    }

    /// Takes over other colours of the textures, those of the preview that this was made of.
    pub fn set_textures(&self, queue: &wgpu::Queue, atlas: &Atlas) {
        if let Some(textures) = &self.textures {
            textures.write(queue, atlas);
        }
    }

    pub fn triangles(&self) -> u64 {
        self.of_instances.iter().map(|&(mesh, _)| u64::from(self.meshes[mesh].n_indices / 3)).sum()
    }

    pub fn draw_all(&self, pass: &mut wgpu::RenderPass<'_>, pipelines: &Pipelines) {
        let mut first = 0;
        for run in self.of_instances.chunk_by(|a, b| a.0 == b.0) {
            let places = first..first + run.len() as u32;
            first = places.end;
            let mesh = &self.meshes[run[0].0];
            match (&mesh.texels, &self.textures) {
                (Some(texels), Some(textures)) => {
                    pass.set_pipeline(&pipelines.textured_surfaces);
                    pass.set_bind_group(1, &textures.group, &[]);
                    pass.set_vertex_buffer(2, texels.slice(..));
                }
                _ if mesh.is_flat => pass.set_pipeline(&pipelines.flat_surfaces),
                _ => pass.set_pipeline(&pipelines.surfaces),
            }
            self.draw(pass, mesh, 0..mesh.n_indices, places);
        }
    }

    /// Draws some objects; whether there are any of them.
    pub fn draw_some(&self, pass: &mut wgpu::RenderPass<'_>, objects: &[Range<u32>]) -> bool {
        let mut any = false;
        for (instance, &(mesh, base)) in (0..).zip(&self.of_instances) {
            let mesh = &self.meshes[mesh];
            for (object, corners) in &mesh.runs {
                if is_within(object + base, objects) {
                    self.draw(pass, mesh, corners.clone(), instance..instance + 1);
                    any = true;
                }
            }
        }
        any
    }

    fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        mesh: &MeshBuffers,
        corners: Range<u32>,
        places: Range<u32>,
    ) {
        let Some(rows) = self.places.as_ref().filter(|_| !corners.is_empty()) else { return };
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_vertex_buffer(1, rows.slice(..));
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(corners, 0, places);
    }
}

impl Textures {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue, pipelines: &Pipelines, atlas: &Atlas) -> Textures {
        let picture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("textures"),
            size: extent(atlas),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOR,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = picture.create_view(&wgpu::TextureViewDescriptor::default());
        let textures = Textures { group: pipelines.atlas_group(device, &view), picture };
        textures.write(queue, atlas);
        textures
    }

    fn write(&self, queue: &wgpu::Queue, atlas: &Atlas) {
        if self.picture.size() != extent(atlas) {
            return;
        }
        let [columns, rows] = atlas.size();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * columns),
            rows_per_image: Some(rows),
        };
        queue.write_texture(self.picture.as_image_copy(), atlas.rgba(), layout, extent(atlas));
    }
}

impl MeshBuffers {
    /// A mesh that is more than a card's buffer holds is left out: a warning of the card would end the program.
    ///
    /// * `atlas`: columns and rows of the picture of all textures, if there is any
    fn new(device: &wgpu::Device, mesh: &PreviewMesh, atlas: Option<[u32; 2]>) -> MeshBuffers {
        let vertices: Vec<Vertex> = mesh.vertices.iter().map(vertex).collect();
        let bytes = size_of_val(&vertices[..]).max(size_of_val(&mesh.indices[..])) as u64;
        let fits = bytes <= device.limits().max_buffer_size && u32::try_from(mesh.indices.len()).is_ok();
        let (vertices, indices) = if fits { (&vertices[..], &mesh.indices[..]) } else { (&[][..], &[][..]) };
        let texels = atlas.filter(|_| fits && !mesh.texels.is_empty()).map(|size| {
            let places: Vec<AtlasPosition> = mesh.texels.iter().map(|&texel| place_in(texel, size)).collect();
            buffer(device, "texels", bytemuck::cast_slice(&places), wgpu::BufferUsages::VERTEX)
        });
        MeshBuffers {
            texels,
            vertices: buffer(device, "corners", bytemuck::cast_slice(vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(device, "triangles", bytemuck::cast_slice(indices), wgpu::BufferUsages::INDEX),
            runs: runs(mesh, indices),
            n_indices: indices.len() as u32,
            is_flat: mesh.vertices.iter().all(|vertex| vertex.normal == [0.0; 3]),
        }
    }
}

/// Neighbouring triangles of the same object.
fn runs(mesh: &PreviewMesh, indices: &[u32]) -> Vec<(u32, Range<u32>)> {
    let mut runs: Vec<(u32, Range<u32>)> = Vec::new();
    for (first, face) in (0..).step_by(3).zip(indices.chunks_exact(3)) {
        let object = mesh.vertices[face[0] as usize].object;
        match runs.last_mut() {
            Some((of, corners)) if *of == object => corners.end = first + 3,
            _ => runs.push((object, first..first + 3)),
        }
    }
    runs
}

fn vertex(vertex: &kajo_edit::preview::Vertex) -> Vertex {
    let [x, y, z] = vertex.normal.map(|v| (127.0 * v) as i8);
    Vertex { p: vertex.position, n: [x, y, z, 0], color: vertex.color }
}

/// Where a texel is in a picture.
fn place_in(texel: [f32; 2], size: [u32; 2]) -> AtlasPosition {
    let share = |i: usize| (65535.0 * texel[i] / size[i] as f32).round() as u16;
    AtlasPosition { share: [share(0), share(1)] }
}

fn extent(atlas: &Atlas) -> wgpu::Extent3d {
    let [width, height] = atlas.size();
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

fn transform_of(instance: &PreviewInstance) -> InstanceTransform {
    let matrix = kajo_math::Mat4::from(instance.world_from_mesh);
    InstanceTransform { rows: [0, 1, 2].map(|row| matrix.row(row).to_array()), color: instance.color }
}

fn buffer(device: &wgpu::Device, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_of_an_object_are_drawn_together() {
        let corner = |object| kajo_edit::preview::Vertex {
            position: [0.0; 3],
            normal: [0.0, 0.0, -1.0],
            color: [255; 4],
            object,
        };
        let mesh = PreviewMesh {
            vertices: [1, 1, 1, 2, 2, 2].map(corner).to_vec(),
            indices: vec![0, 1, 2, 2, 1, 0, 3, 4, 5, 0, 1, 2],
            texels: Vec::new(),
        };
        assert_eq!(runs(&mesh, &mesh.indices), [(1, 0..6), (2, 6..9), (1, 9..12)]);
        assert_eq!(vertex(&mesh.vertices[0]).n, [0, 0, -127, 0]);
    }
}
