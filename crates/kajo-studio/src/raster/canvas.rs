//! Pictures and large areas of one colour in the window, at little cost for each pixel.
//!
//! The shader that paints the window's widgets knows two ways to filter a texture. Drivers that draw on the processor
//! work out both for each pixel, about 100 ns, whether it is one of a letter or of an empty panel. Most of the window
//! is ground and picture, and for these a shader will do that copies texels.

use egui::{Color32, Rect, Shape};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};

/// Paints into the window that a card draws.
#[derive(Clone)]
pub struct Canvas {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    /// The nearest texel, and between texels.
    samplers: [wgpu::Sampler; 2],
}

/// A picture on the card, values as shown.
#[derive(Clone)]
pub struct Sheet {
    texture: wgpu::Texture,
    /// For each of the samplers.
    groups: [wgpu::BindGroup; 2],
}

impl Sheet {
    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }

    /// To draw into it.
    pub(super) fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor::default())
    }
}

impl Canvas {
    /// Prepares to paint into the window of a card.
    pub fn new(state: &RenderState) -> Canvas {
        let device = &state.device;
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("picture"),
            entries: &[
                entry(
                    0,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
                entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        });
        let samplers = [wgpu::FilterMode::Nearest, wgpu::FilterMode::Linear].map(|filter| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter: filter,
                min_filter: filter,
                ..Default::default()
            })
        });
        Canvas {
            device: device.clone(),
            queue: state.queue.clone(),
            pipeline: pipeline(device, &layout, state.target_format),
            layout,
            samplers,
        }
    }

    /// Columns and rows that a sheet may have.
    pub fn largest_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// A sheet without a picture yet.
    pub fn sheet(&self, size: [u32; 2]) -> Sheet {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: super::pipelines::COLOR,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let groups = self.samplers.each_ref().map(|sampler| {
            self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("picture"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
                ],
            })
        });
        Sheet { texture, groups }
    }

    /// Puts a picture onto a sheet of its size.
    ///
    /// * `rgba`: height x width x 4, row 0 on top
    pub fn write(&self, sheet: &Sheet, rgba: &[u8]) {
        let [width, height] = sheet.size();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: Some(height),
        };
        self.queue.write_texture(sheet.texture.as_image_copy(), rgba, layout, extent([width, height]));
    }

    /// A sheet of one colour.
    pub fn plain(&self, color: Color32) -> Sheet {
        let sheet = self.sheet([1, 1]);
        self.write(&sheet, &color.to_array());
        sheet
    }

    /// A sheet to be painted over all of `rect`. Its pixels stay squares when it is enlarged, as one wants to see them,
    /// and are mixed when there are too many.
    ///
    /// * `rect`: in points of the window, on whole pixels
    pub fn show(&self, sheet: &Sheet, rect: Rect) -> Shape {
        let shown = Shown { pipeline: self.pipeline.clone(), sheet: sheet.clone() };
        Shape::Callback(Callback::new_paint_callback(rect, shown))
    }
}

/// A sheet that is painted into the window.
struct Shown {
    pipeline: wgpu::RenderPipeline,
    sheet: Sheet,
}

impl CallbackTrait for Shown {
    fn paint(
        &self,
        info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _: &CallbackResources,
    ) {
        let area = info.viewport_in_pixels();
        let [width, height] = self.sheet.size().map(i64::from);
        let is_reduced = width > i64::from(area.width_px) || height > i64::from(area.height_px);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.sheet.groups[usize::from(is_reduced)], &[]);
        pass.draw(0..3, 0..1);
    }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

fn entry(binding: u32, ty: wgpu::BindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: wgpu::ShaderStages::FRAGMENT, ty, count: None }
}

fn pipeline(
    device: &wgpu::Device,
    group: &wgpu::BindGroupLayout,
    target: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let module = &device.create_shader_module(wgpu::include_wgsl!("canvas.wgsl"));
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("picture"),
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("picture"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("project_picture"),
            buffers: &[],
            compilation_options: wgpu::PipelineCompilationOptions::default(),
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(if target.is_srgb() { "show_decoded" } else { "show_picture" }),
            targets: &[Some(target.into())],
            compilation_options: wgpu::PipelineCompilationOptions::default(),
        }),
        multiview_mask: None,
        cache: None,
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_shader_is_valid() {
        let module = wgpu::naga::front::wgsl::parse_str(include_str!("canvas.wgsl"));
        assert!(module.is_ok(), "{:?}", module.err().map(|error| error.emit_to_string("")));
    }
}
