//! The textures that a picture is drawn into.

use egui_wgpu::RenderState;

use super::pipelines::{COLOR, DEPTH, MASK, Pipelines};

/// Colour, depth and the mask of the selection, all of one size.
pub(super) struct Targets {
    pub size: [u32; 2],
    pub color: wgpu::TextureView,
    pub mask: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// What the pipeline of the outline reads.
    pub outline_group: wgpu::BindGroup,
    /// The name of the colour texture in the window.
    pub id: egui::TextureId,
}

impl Targets {
    /// Makes textures of `size`; the new colour texture takes over the name of the previous one.
    pub fn new(
        state: &RenderState,
        size: [u32; 2],
        previous: Option<Targets>,
        pipelines: &Pipelines,
        view: &wgpu::Buffer,
    ) -> Targets {
        let device = &state.device;
        let color = texture(device, "preview", size, COLOR);
        let mask = texture(device, "mask of the selection", size, MASK);
        let depth = texture(device, "depth", size, DEPTH);
        let mut renderer = state.renderer.write();
        let id = match previous {
            Some(previous) => {
                let filter = wgpu::FilterMode::Nearest;
                renderer.update_egui_texture_from_wgpu_texture(device, &color, filter, previous.id);
                previous.id
            }
            None => renderer.register_native_texture(device, &color, wgpu::FilterMode::Nearest),
        };
        let outline_group = pipelines.outline_group(device, view, &mask);
        Targets { size, color, mask, depth, outline_group, id }
    }

    /// Begins to draw into `target`, one of the two colour textures.
    pub fn pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        load: wgpu::LoadOp<wgpu::Color>,
        with_depth: bool,
    ) -> wgpu::RenderPass<'a> {
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(1.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("preview"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: with_depth.then_some(depth),
            ..Default::default()
        })
    }
}

fn texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
