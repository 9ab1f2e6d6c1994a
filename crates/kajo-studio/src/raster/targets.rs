//! The textures that a picture is drawn into.

use super::canvas::{Canvas, Sheet};
use super::pipelines::{DEPTH, MASK, Pipelines};

/// Colour, depth and the mask of the selection, all of one size.
pub(super) struct Targets {
    pub sheet: Sheet,
    /// What is drawn onto the sheet.
    pub color: wgpu::TextureView,
    pub mask: wgpu::TextureView,
    depth: wgpu::TextureView,
    /// What the pipeline of the outline reads.
    pub outline_group: wgpu::BindGroup,
}

impl Targets {
    /// Makes textures of `size`.
    pub fn new(
        device: &wgpu::Device,
        canvas: &Canvas,
        size: [u32; 2],
        pipelines: &Pipelines,
        view: &wgpu::Buffer,
    ) -> Targets {
        let sheet = canvas.sheet(size);
        let mask = texture(device, "mask of the selection", size, MASK);
        let depth = texture(device, "depth", size, DEPTH);
        let outline_group = pipelines.outline_group(device, view, &mask);
        Targets { color: sheet.view(), sheet, mask, depth, outline_group }
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
