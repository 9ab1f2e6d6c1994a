//! How the graphics card draws surfaces, lines, the mask of the selection and its outline.

use super::vertices::{AtlasPosition, InstanceTransform, LineInstance, Vertex};

/// Format of the picture: values as shown, which is what the window expects.
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of the mask.
pub(super) const MASK: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
/// Format of depths.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Everything that is made once for a device.
pub(super) struct Pipelines {
    pub surfaces: wgpu::RenderPipeline,
    /// Surfaces whose triangles have no normals at their corners.
    pub flat_surfaces: wgpu::RenderPipeline,
    /// Surfaces that show a part of the picture of all textures.
    pub textured_surfaces: wgpu::RenderPipeline,
    pub marks: wgpu::RenderPipeline,
    pub lines: wgpu::RenderPipeline,
    /// Lines where a surface is in front of them.
    pub hidden_lines: wgpu::RenderPipeline,
    pub outline: wgpu::RenderPipeline,
    /// The view, for all but the outline.
    pub view_group: wgpu::BindGroup,
    outline_layout: wgpu::BindGroupLayout,
    atlas_layout: wgpu::BindGroupLayout,
    atlas_sampler: wgpu::Sampler,
}

const CORNERS: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4];
const TRANSFORMS: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Unorm8x4];
const TEXELS: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![7 => Unorm16x2];
const LINES: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Unorm8x4];

/// Values of type `T`, one after the other.
fn layout_of<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}

/// What tells one pipeline from another.
struct Plan<'a> {
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    strip: bool,
    target: wgpu::TextureFormat,
    blend: Option<wgpu::BlendState>,
    /// How depths are compared, and whether they are written; `None` for no depths at all.
    depth: Option<(wgpu::CompareFunction, bool)>,
}

impl<'a> Plan<'a> {
    fn of_surfaces(buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>]) -> Plan<'a> {
        Plan {
            vertex: "project_surface",
            fragment: "shade_surface",
            buffers,
            strip: false,
            target: COLOR,
            blend: None,
            depth: Some((wgpu::CompareFunction::Less, true)),
        }
    }

    fn of_lines(buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>]) -> Plan<'a> {
        Plan {
            vertex: "project_line",
            fragment: "shade_line",
            buffers,
            strip: true,
            target: COLOR,
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            depth: Some((wgpu::CompareFunction::LessEqual, false)),
        }
    }
}

fn linear_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, view: &wgpu::Buffer) -> Pipelines {
        let shader = device.create_shader_module(wgpu::include_wgsl!("raster.wgsl"));
        let view_layout = group_layout(device, &[view_entry()]);
        let outline_layout = group_layout(device, &[view_entry(), mask_entry()]);
        let atlas_layout = group_layout(device, &atlas_entries());
        let view_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &view_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }],
        });
        let of_textured = [
            Some(layout_of::<Vertex>(wgpu::VertexStepMode::Vertex, &CORNERS)),
            Some(layout_of::<InstanceTransform>(wgpu::VertexStepMode::Instance, &TRANSFORMS)),
            Some(layout_of::<AtlasPosition>(wgpu::VertexStepMode::Vertex, &TEXELS)),
        ];
        let of_surfaces = &of_textured[..2];
        let of_lines = [Some(layout_of::<LineInstance>(wgpu::VertexStepMode::Instance, &LINES))];
        let surfaces = Plan::of_surfaces(of_surfaces);
        let flat_surfaces = Plan { vertex: "project_flat", fragment: "shade_flat", ..surfaces };
        let textured_surfaces = Plan {
            vertex: "project_textured",
            fragment: "shade_textured",
            buffers: &of_textured,
            ..surfaces
        };
        let marks = Plan { fragment: "mark_surface", target: MASK, depth: None, ..flat_surfaces };
        let lines = Plan::of_lines(&of_lines);
        let hidden_lines = Plan {
            fragment: "shade_hidden_line",
            depth: Some((wgpu::CompareFunction::Greater, false)),
            ..lines
        };
        let outline = Plan {
            vertex: "project_outline",
            fragment: "shade_outline",
            buffers: &[],
            depth: None,
            ..surfaces
        };
        let build = |plan: &Plan<'_>, layouts: &[Option<&wgpu::BindGroupLayout>]| {
            plan.build(device, &shader, layouts)
        };
        let make = |plan, layout| build(plan, &[Some(layout)]);
        Pipelines {
            surfaces: make(&surfaces, &view_layout),
            flat_surfaces: make(&flat_surfaces, &view_layout),
            textured_surfaces: build(&textured_surfaces, &[Some(&view_layout), Some(&atlas_layout)]),
            marks: make(&marks, &view_layout),
            lines: make(&lines, &view_layout),
            hidden_lines: make(&hidden_lines, &view_layout),
            outline: make(&outline, &outline_layout),
            view_group,
            outline_layout,
            atlas_layout,
            atlas_sampler: linear_sampler(device),
        }
    }

    /// What textured surfaces read: the picture of all textures.
    pub fn atlas_group(&self, device: &wgpu::Device, atlas: &wgpu::TextureView) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("textures"),
            layout: &self.atlas_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(atlas) },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&self.atlas_sampler),
                },
            ],
        })
    }

    /// What the outline reads: the view and the mask.
    pub fn outline_group(
        &self,
        device: &wgpu::Device,
        view: &wgpu::Buffer,
        mask: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("outline"),
            layout: &self.outline_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(mask) },
            ],
        })
    }
}

impl Plan<'_> {
    fn build(
        &self,
        device: &wgpu::Device,
        shader: &wgpu::ShaderModule,
        groups: &[Option<&wgpu::BindGroupLayout>],
    ) -> wgpu::RenderPipeline {
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.vertex),
            bind_group_layouts: groups,
            immediate_size: 0,
        });
        let topology = match self.strip {
            true => wgpu::PrimitiveTopology::TriangleStrip,
            false => wgpu::PrimitiveTopology::TriangleList,
        };
        let depth = self.depth.map(|(compare, write)| wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        });
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.fragment),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: shader,
                entry_point: Some(self.vertex),
                buffers: self.buffers,
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: depth,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: shader,
                entry_point: Some(self.fragment),
                targets: &[Some(wgpu::ColorTargetState {
                    format: self.target,
                    blend: self.blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn group_layout(device: &wgpu::Device, entries: &[wgpu::BindGroupLayoutEntry]) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries })
}

fn atlas_entries() -> [wgpu::BindGroupLayoutEntry; 2] {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let picture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    [entry(0, picture), entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering))]
}

fn view_entry() -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

fn mask_entry() -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding: 1,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}
