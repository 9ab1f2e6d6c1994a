//! The raster preview: the scene as the graphics card (or its stand-in on the processor) draws it.
//!
//! Surfaces are lit by a light at the eye, `0.28 + 0.72 |n·v|`, which shows shape from every side and needs no
//! lights in the scene. Meshes are stored once and drawn per instance. Lines have a width in pixels of the window;
//! what surfaces hide of them shows faintly. What is selected has an outline, found in a mask of its pixels.
//!
//! Surfaces with textures are drawn with a picture of all of these, in which each triangle has its part.
//!
//! The picture is drawn onto a [`Sheet`] of its own, with a depth buffer, and the window's [`Canvas`] shows it. It is
//! drawn anew only when something in it has changed.

mod buffers;
mod canvas;
mod pipelines;
mod targets;
mod vertices;

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use egui_wgpu::RenderState;
use kajo_edit::preview::{Atlas, Preview};
use kajo_math::{DMat3, Mat4, Vec3};
use wgpu::util::DeviceExt as _;

use buffers::SceneBuffers;
use pipelines::Pipelines;
use targets::Targets;
use vertices::LineInstance;

pub use canvas::{Canvas, Sheet};

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
    /// Numbers of the objects with an outline; as [`is_within`] wants them.
    pub selected: &'a [Range<u32>],
    /// Colour behind everything.
    pub background: [f32; 3],
}

/// Draws scenes.
pub struct Raster {
    device: wgpu::Device,
    queue: wgpu::Queue,
    canvas: Canvas,
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
    selected: Vec<Range<u32>>,
}

/// The block `View` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ViewBlock {
    clip_from_world: [[f32; 4]; 4],
    right: [f32; 4],
    up: [f32; 4],
    ahead: [f32; 4],
    to_eye: [f32; 4],
    size: [f32; 2],
    scale: f32,
    unused: f32,
}

impl Raster {
    /// Prepares to draw with the card that draws the window.
    pub fn new(state: &RenderState) -> Raster {
        let device = &state.device;
        if state.adapter.get_info().device_type == wgpu::DeviceType::Cpu {
            keep_memory_of_frames();
        }
        let view = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<ViewBlock>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Raster {
            device: device.clone(),
            queue: state.queue.clone(),
            canvas: Canvas::new(state),
            pipelines: Pipelines::new(device, &view),
            view,
            scene: SceneBuffers::default(),
            targets: None,
            drawn: None,
        }
    }

    /// Takes over a scene.
    pub fn set_scene(&mut self, preview: &Preview) {
        self.scene = SceneBuffers::new(&self.device, &self.queue, &self.pipelines, preview);
        self.drawn = None;
    }

    /// Takes over finer textures of the same scene; see [`Atlas::refined`].
    pub fn set_textures(&mut self, atlas: &Atlas) {
        self.scene.set_textures(&self.queue, atlas);
        self.drawn = None;
    }

    /// Number of triangles on stage, every instance counted.
    pub fn triangles(&self) -> u64 {
        self.scene.triangles()
    }

    /// What paints into the window.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// Draws a picture, unless it is the one drawn last, and returns the sheet that it is on.
    pub fn draw(&mut self, shot: &Shot<'_>) -> Sheet {
        let size = shot.size.map(|pixels| pixels.clamp(1, self.canvas.largest_side()));
        let wanted = Drawn {
            size,
            scale: shot.scale,
            eye: shot.eye,
            lines: shot.lines.to_vec(),
            selected: shot.selected.to_vec(),
        };
        if let Some(targets) = self.targets.as_ref().filter(|_| self.drawn.as_ref() == Some(&wanted)) {
            return targets.sheet.clone();
        }
        let (device, canvas, pipelines, view) = (&self.device, &self.canvas, &self.pipelines, &self.view);
        let fitting = self.targets.take().filter(|targets| targets.sheet.size() == size);
        let targets = fitting.unwrap_or_else(|| Targets::new(device, canvas, size, pipelines, view));
        self.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view_block(shot, size)));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.draw_scene(&mut encoder, &targets, shot);
        if !shot.selected.is_empty() {
            self.draw_outline(&mut encoder, &targets, shot.selected);
        }
        self.queue.submit([encoder.finish()]);
        self.drawn = Some(wanted);
        let sheet = targets.sheet.clone();
        self.targets = Some(targets);
        sheet
    }

    /// Waits until everything that was asked for is drawn.
    pub fn finish(&self) {
        // The only error is a wait that timed out, and none was asked for.
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }

    fn draw_scene(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, shot: &Shot<'_>) {
        let [r, g, b] = shot.background.map(f64::from);
        let lines: Vec<LineInstance> = shot.lines.iter().map(LineInstance::from).collect();
        let line_buffer = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("lines"),
            contents: bytemuck::cast_slice(&lines),
            usage: wgpu::BufferUsages::VERTEX,
        });
        let clear = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
        let mut pass = targets.pass(encoder, &targets.color, clear, true);
        pass.set_bind_group(0, &self.pipelines.view_group, &[]);
        self.scene.draw_all(&mut pass, &self.pipelines);
        if !lines.is_empty() {
            pass.set_vertex_buffer(0, line_buffer.slice(..));
            for pipeline in [&self.pipelines.hidden_lines, &self.pipelines.lines] {
                pass.set_pipeline(pipeline);
                pass.draw(0..4, 0..lines.len() as u32);
            }
        }
    }

    fn draw_outline(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, selected: &[Range<u32>]) {
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

/// Keeps the system from taking back, after each frame, the memory that a driver on the processor needs for all
/// triangles of the next: to get it again, page by page, takes as long as the drawing.
///
/// The GNU C library returns what is free beyond twice the largest block that was freed so far, up to 32 MiB. Here is
/// one, which nothing is written to, so that it is never really there.
fn keep_memory_of_frames() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(31 << 20)));
}

/// Whether a number is in one of these ranges, which are in order and apart from each other.
pub fn is_within(number: u32, ranges: &[Range<u32>]) -> bool {
    let next = ranges.partition_point(|range| range.end <= number);
    ranges.get(next).is_some_and(|range| range.start <= number)
}

fn view_block(shot: &Shot<'_>, size: [u32; 2]) -> ViewBlock {
    let Eye { clip_from_world, place, is_direction } = shot.eye;
    // Seen from the eye `e`, clip space is a linear map of world space, whose inverse leads from there to a point:
    //
    //     (x, y, w) = M (p - e)     so     p - e = w M^-1 (x/w, y/w, 1)
    //
    // Without an eye w is 1, and z takes its place.
    let depth = clip_from_world.row(if is_direction { 2 } else { 3 });
    let rows = [clip_from_world.row(0), clip_from_world.row(1), depth].map(|row| row.truncate().as_dvec3());
    let inverse = DMat3::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose().inverse();
    let column = |i| inverse.col(i).as_vec3().extend(0.0).to_array();
    ViewBlock {
        clip_from_world: clip_from_world.to_cols_array_2d(),
        right: column(0),
        up: column(1),
        ahead: column(2),
        to_eye: if is_direction { place.extend(1.0).to_array() } else { [0.0; 4] },
        size: size.map(|pixels| pixels as f32),
        scale: shot.scale,
        unused: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::{DVec3, Vec4};

    /// What `way_to` of the shader makes of a point of the world.
    fn way_to(view: &ViewBlock, p: Vec3) -> Vec3 {
        let clip = Mat4::from_cols_array_2d(&view.clip_from_world) * p.extend(1.0);
        let depth = if view.to_eye[3] == 1.0 { clip.z / clip.w } else { 1.0 };
        let [right, up, ahead] = [view.right, view.up, view.ahead].map(|v| Vec4::from(v).truncate());
        clip.w * (clip.x / clip.w * right + clip.y / clip.w * up + depth * ahead)
    }

    #[test]
    fn numbers_are_found_in_ranges() {
        let ranges = [2..3, 5..9];
        let found: Vec<u32> = (0..12).filter(|&number| is_within(number, &ranges)).collect();
        assert_eq!(found, [2, 5, 6, 7, 8]);
        assert!(!is_within(0, &[]));
    }

    #[test]
    fn a_fragment_knows_the_way_that_leads_to_it() {
        let eye = DVec3::new(3.0, 2.0, 5.0);
        let (p, q) = (Vec3::new(0.2, -0.4, 0.7), Vec3::new(-0.5, 0.1, -2.0));
        for angle in [Some(0.7), None] {
            let camera = match angle {
                Some(angle) => kajo::CameraPose::perspective(eye, DVec3::ZERO, DVec3::Y, angle),
                None => kajo::CameraPose::orthographic(eye, DVec3::ZERO, DVec3::Y, 4.0),
            };
            let clip_from_world = camera.projection([300, 200], 0.01, 50.0).unwrap().as_mat4();
            let (place, is_direction) = match angle {
                Some(_) => (eye.as_vec3(), false),
                None => (-camera.forward().as_vec3(), true),
            };
            let eye = Eye { clip_from_world, place, is_direction };
            let shot =
                Shot { size: [300, 200], scale: 1.0, eye, lines: &[], selected: &[], background: [0.0; 3] };
            let view = view_block(&shot, [300, 200]);
            let [to_p, to_q] = [p, q].map(|p| way_to(&view, p));
            assert!((to_p - to_q - (p - q)).length() < 1e-4, "{to_p} {to_q}");
            if angle.is_some() {
                assert!((to_p - (p - place)).length() < 1e-4, "{to_p}");
            }
        }
    }

    #[test]
    fn the_shader_is_valid() {
        let module = wgpu::naga::front::wgsl::parse_str(include_str!("raster/raster.wgsl"));
        assert!(module.is_ok(), "{:?}", module.err().map(|error| error.emit_to_string("")));
    }
}
