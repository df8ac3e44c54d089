//! Pass: lines. Drawn twice: dimmed where a surface hides them, then in full where nothing does.

use super::gpu::{Cached, Content, Uploader};
use super::passes::{Recipe, Record, Records, Shared, shader, shader_source};
use super::scene::{Lines, Scene};
use super::uniforms::{LineStyle, unit};
use wgpu::{CompareFunction, PrimitiveTopology};

/// Depth steps (see `renderer`) that lift a line off the surface it lies on.
const LIFT: f32 = 1.0;

#[derive(Debug)]
pub(super) struct LinePass {
    hidden: wgpu::RenderPipeline,
    visible: wgpu::RenderPipeline,
    buffers: Vec<Cached>,
    /// Index of the line set, its style where hidden if any of it shows, and where visible.
    draws: Vec<(usize, Option<Record>, Record)>,
}

impl LinePass {
    pub(super) fn new(device: &wgpu::Device, shared: &Shared) -> Self {
        let module = shader(device, "lines", shader_source!("lines"));
        let attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let step_mode = wgpu::VertexStepMode::Instance;
        let buffers = [Some(wgpu::VertexBufferLayout { array_stride: 24, step_mode, attributes: &attributes })];
        let make = |depth| {
            shared.pipeline(
                device,
                &Recipe {
                    label: "lines",
                    module: &module,
                    buffers: &buffers,
                    topology: PrimitiveTopology::TriangleStrip,
                    cull: None,
                    depth,
                    depth_write: false,
                },
            )
        };
        let (hidden, visible) = (make(CompareFunction::Less), make(CompareFunction::GreaterEqual));
        Self { hidden, visible, buffers: Vec::new(), draws: Vec::new() }
    }

    pub(super) fn update(&mut self, gpu: &mut Uploader<'_>, scene: &Scene, scale: f32, records: &mut Records) {
        self.buffers.resize_with(scene.lines.len(), Cached::default);
        self.draws.clear();
        for (index, (lines, buffer)) in scene.lines.iter().zip(&mut self.buffers).enumerate() {
            let key = [lines.positions.generation(), lines.edges.generation()];
            buffer.update(gpu, Content::Lines, key, || segments(lines));
            let [r, g, b, a] = unit(lines.color);
            let shape = [lines.width * scale, LIFT, 0.0, 0.0];
            let mut push = |alpha| records.push(&LineStyle { color: [r, g, b, alpha], shape });
            let hidden = (lines.hidden > 0.0).then(|| push(a * lines.hidden));
            self.draws.push((index, hidden, push(a)));
        }
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        for &(index, hidden, visible) in &self.draws {
            let Some(slice) = self.buffers[index].slice() else { continue };
            pass.set_vertex_buffer(0, slice);
            for (pipeline, style) in [(&self.hidden, hidden), (&self.visible, Some(visible))] {
                let Some(style) = style else { continue };
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, &shared.style_group, &[style]);
                pass.draw(0..4, 0..self.buffers[index].count);
            }
        }
    }
}

/// Both ends of each edge; edges that name no position are left out.
fn segments(lines: &Lines) -> Vec<[f32; 6]> {
    let at = |v: u32| lines.positions.get(v as usize);
    let ends = lines.edges.iter().filter_map(|&[a, b]| Some((at(a)?, at(b)?)));
    ends.map(|(a, b)| [a.x, a.y, a.z, b.x, b.y, b.z]).collect()
}
