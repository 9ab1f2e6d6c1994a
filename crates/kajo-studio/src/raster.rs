//! The raster preview: the scene as the graphics card (or its stand-in on the processor) draws it.
//!
//! Surfaces are lit by a lamp at the eye, `0.28 + 0.72 |n·v|`, which shows shape from every side and needs no
//! lights in the scene. Meshes are stored once and drawn per instance. Lines have a width in pixels of the window;
//! what surfaces hide of them shows faintly. What is selected has an outline, found in a mask of its pixels.
//!
//! The picture is drawn into a texture of its own, with a depth buffer, and the window shows that texture as it
//! shows any other. It is drawn anew only when something in it has changed.

mod buffers;
mod pipelines;
mod targets;

use bytemuck::{Pod, Zeroable};
use egui_wgpu::RenderState;
use kajo::preview::Preview;
use kajo_math::{Mat4, Vec3};
use wgpu::util::DeviceExt as _;

use buffers::{LineInstance, SceneBuffers};
use pipelines::Pipelines;
use targets::Targets;

/// A straight line to be drawn over the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// One end, in world space.
    pub from: Vec3,
    /// The other end.
    pub to: Vec3,
    /// Red, green, blue as shown, and opacity.
    pub color: [u8; 4],
    /// In points of the window.
    pub width: f32,
}

/// From where the scene is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Takes world space to the clip space of the graphics card, with depths 0 to 1.
    pub clip_from_world: Mat4,
    /// The place of the camera, or the direction towards it when it is infinitely far away.
    pub place: Vec3,
    /// Whether `place` is a direction.
    pub is_direction: bool,
}

/// What a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Shot<'a> {
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Pixels of the picture to a point of the window.
    pub scale: f32,
    /// From where.
    pub eye: Eye,
    /// Drawn over the surfaces.
    pub lines: &'a [Line],
    /// Numbers of the objects with an outline, in order.
    pub selected: &'a [u32],
    /// Colour behind everything.
    pub background: [f32; 3],
}

/// Draws scenes.
pub struct Raster {
    state: RenderState,
    pipelines: Pipelines,
    view: wgpu::Buffer,
    scene: SceneBuffers,
    targets: Option<Targets>,
    /// What the picture shows.
    drawn: Option<Drawn>,
}

/// A shot that was taken.
#[derive(PartialEq)]
struct Drawn {
    size: [u32; 2],
    scale: f32,
    eye: Eye,
    lines: Vec<Line>,
    selected: Vec<u32>,
}

/// The block `View` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ViewBlock {
    clip_from_world: [[f32; 4]; 4],
    eye: [f32; 4],
    size: [f32; 2],
    scale: f32,
    unused: f32,
}

impl Raster {
    /// Prepares to draw with the card that draws the window.
    pub fn new(state: &RenderState) -> Raster {
        let device = &state.device;
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<ViewBlock>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Raster {
            state: state.clone(),
            pipelines: Pipelines::new(device, &view),
            view,
            scene: SceneBuffers::default(),
            targets: None,
            drawn: None,
        }
    }

    /// Takes over a scene.
    pub fn set_scene(&mut self, preview: &Preview) {
        self.scene = SceneBuffers::new(&self.state.device, preview);
        self.drawn = None;
    }

    /// Number of triangles on stage, every instance counted.
    pub fn triangles(&self) -> u64 {
        self.scene.triangles()
    }

    /// Draws a picture, unless it is the one drawn last, and returns the texture that shows it.
    pub fn draw(&mut self, shot: &Shot<'_>) -> egui::TextureId {
        let size = shot.size.map(|pixels| pixels.clamp(1, self.largest_side()));
        let wanted = Drawn {
            size,
            scale: shot.scale,
            eye: shot.eye,
            lines: shot.lines.to_vec(),
            selected: shot.selected.to_vec(),
        };
        if let Some(targets) = self.targets.as_ref().filter(|_| self.drawn.as_ref() == Some(&wanted)) {
            return targets.id;
        }
        self.targets = Some(match self.targets.take() {
            Some(targets) if targets.size == size => targets,
            previous => Targets::new(&self.state, size, previous, &self.pipelines, &self.view),
        });
        let Some(targets) = &self.targets else { unreachable!("made just above") };
        self.state.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view_block(shot, size)));
        let device = &self.state.device;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.draw_scene(&mut encoder, targets, shot);
        if !shot.selected.is_empty() {
            self.draw_outline(&mut encoder, targets, shot.selected);
        }
        self.state.queue.submit([encoder.finish()]);
        self.drawn = Some(wanted);
        targets.id
    }

    /// Waits until everything that was asked for is drawn.
    pub fn finish(&self) {
        // The only error is a wait that timed out, and none was asked for.
        let _ = self.state.device.poll(wgpu::PollType::wait_indefinitely());
    }

    fn largest_side(&self) -> u32 {
        self.state.device.limits().max_texture_dimension_2d
    }

    fn draw_scene(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, shot: &Shot<'_>) {
        let [r, g, b] = shot.background.map(f64::from);
        let lines: Vec<LineInstance> = shot.lines.iter().map(LineInstance::from).collect();
        let line_buffer = self.state.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("lines"),
            contents: bytemuck::cast_slice(&lines),
            usage: wgpu::BufferUsages::VERTEX,
        });
        let clear = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
        let mut pass = targets.pass(encoder, &targets.color, clear, true);
        pass.set_bind_group(0, &self.pipelines.view_group, &[]);
        pass.set_pipeline(&self.pipelines.surfaces);
        self.scene.draw_all(&mut pass);
        if !lines.is_empty() {
            pass.set_vertex_buffer(0, line_buffer.slice(..));
            for pipeline in [&self.pipelines.hidden_lines, &self.pipelines.lines] {
                pass.set_pipeline(pipeline);
                pass.draw(0..4, 0..lines.len() as u32);
            }
        }
    }

    fn draw_outline(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, selected: &[u32]) {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::BLACK);
        let mut pass = targets.pass(encoder, &targets.mask, clear, false);
        pass.set_bind_group(0, &self.pipelines.view_group, &[]);
        pass.set_pipeline(&self.pipelines.marks);
        let any = self.scene.draw_some(&mut pass, selected);
        drop(pass);
        if !any {
            return;
        }
        let mut pass = targets.pass(encoder, &targets.color, wgpu::LoadOp::Load, false);
        pass.set_bind_group(0, &targets.outline_group, &[]);
        pass.set_pipeline(&self.pipelines.outline);
        pass.draw(0..3, 0..1);
    }
}

fn view_block(shot: &Shot<'_>, size: [u32; 2]) -> ViewBlock {
    let Eye { clip_from_world, place, is_direction } = shot.eye;
    let w = if is_direction { 0.0 } else { 1.0 };
    // A direction is towards the eye; a place is where the eye is: `eye.xyz - w p` serves both.
    ViewBlock {
        clip_from_world: clip_from_world.to_cols_array_2d(),
        eye: [place.x, place.y, place.z, w],
        size: size.map(|pixels| pixels as f32),
        scale: shot.scale,
        unused: 0.0,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_shader_is_valid() {
        let module = wgpu::naga::front::wgsl::parse_str(include_str!("raster/raster.wgsl"));
        assert!(module.is_ok(), "{:?}", module.err().map(|error| error.emit_to_string("")));
    }
}
