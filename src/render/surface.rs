//! Pass: triangles. Opaque parts first; translucent ones later, back faces before front faces, without writing depth.

use super::gpu::{Cached, Content, Uploader};
use super::passes::{Recipe, Record, Records, Shared, shader, shader_source};
use super::scene::{Paint, Part, Scene, Surface};
use super::uniforms::{SurfaceStyle, unit};
use wgpu::{CompareFunction, Face, PrimitiveTopology};

/// Colour of a field that is not there.
const NO_FIELD: [u8; 4] = [150, 150, 150, 255];

#[derive(Debug, Default)]
struct Buffers {
    positions: Cached,
    values: Cached,
    parts: Vec<Cached>,
}

#[derive(Clone, Copy, Debug)]
struct Draw {
    surface: usize,
    part: usize,
    style: Record,
    cull_back: bool,
    opaque: bool,
}

#[derive(Debug)]
pub(super) struct SurfacePass {
    /// Both sides, and front faces only.
    opaque: [wgpu::RenderPipeline; 2],
    /// Back faces, then front faces.
    translucent: [wgpu::RenderPipeline; 2],
    surfaces: Vec<Buffers>,
    draws: Vec<Draw>,
}

impl SurfacePass {
    pub(super) fn new(device: &wgpu::Device, shared: &Shared) -> Self {
        let module = shader(device, "surface", shader_source!("surface"));
        let positions = wgpu::vertex_attr_array![0 => Float32x3];
        let values = wgpu::vertex_attr_array![1 => Float32];
        let step_mode = wgpu::VertexStepMode::Vertex;
        let buffers = [
            Some(wgpu::VertexBufferLayout { array_stride: 12, step_mode, attributes: &positions }),
            Some(wgpu::VertexBufferLayout { array_stride: 4, step_mode, attributes: &values }),
        ];
        let make = |cull, depth_write| {
            shared.pipeline(
                device,
                &Recipe {
                    label: "surface",
                    module: &module,
                    buffers: &buffers,
                    topology: PrimitiveTopology::TriangleList,
                    cull,
                    depth: CompareFunction::Greater,
                    depth_write,
                },
            )
        };
        Self {
            opaque: [make(None, true), make(Some(Face::Back), true)],
            translucent: [make(Some(Face::Front), false), make(Some(Face::Back), false)],
            surfaces: Vec::new(),
            draws: Vec::new(),
        }
    }

    pub(super) fn update(&mut self, gpu: &mut Uploader<'_>, scene: &Scene, records: &mut Records) {
        self.surfaces.resize_with(scene.surfaces.len(), Buffers::default);
        self.draws.clear();
        for (index, (surface, buffers)) in scene.surfaces.iter().zip(&mut self.surfaces).enumerate() {
            upload(gpu, surface, buffers);
            for (place, part) in surface.parts.iter().enumerate().filter(|(_, part)| part.opacity > 0.0) {
                self.draws.push(Draw {
                    surface: index,
                    part: place,
                    style: records.push(&style(surface, part)),
                    cull_back: part.cull_back,
                    opaque: part.opacity >= 1.0,
                });
            }
        }
    }

    pub(super) fn draw_opaque(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        for draw in self.draws.iter().filter(|d| d.opaque) {
            self.draw(pass, shared, draw, &self.opaque[usize::from(draw.cull_back)]);
        }
    }

    pub(super) fn draw_translucent(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        for draw in self.draws.iter().filter(|d| !d.opaque) {
            let skip = usize::from(draw.cull_back);
            for pipeline in &self.translucent[skip..] {
                self.draw(pass, shared, draw, pipeline);
            }
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared, draw: &Draw, pipeline: &wgpu::RenderPipeline) {
        let buffers = &self.surfaces[draw.surface];
        let indices = &buffers.parts[draw.part];
        if let (Some(p), Some(v), Some(i)) = (buffers.positions.slice(), buffers.values.slice(), indices.slice()) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &shared.style_group, &[draw.style]);
            pass.set_vertex_buffer(0, p);
            pass.set_vertex_buffer(1, v);
            pass.set_index_buffer(i, wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..3 * indices.count, 0, 0..1);
        }
    }
}

/// The field of a surface if it has one value per vertex.
fn field(surface: &Surface) -> Option<&super::Scalars> {
    surface.scalars.as_ref().filter(|s| s.values.len() == surface.positions.len())
}

fn upload(gpu: &mut Uploader<'_>, surface: &Surface, buffers: &mut Buffers) {
    let positions = &surface.positions;
    buffers.positions.update(gpu, Content::Positions, [positions.generation(), 0], || positions.to_vec());
    match field(surface) {
        Some(s) => buffers.values.update(gpu, Content::Values, [s.values.generation(), 0], || s.values.to_vec()),
        // The pipeline wants a buffer in any case; it changes only with the number of vertices.
        None => {
            buffers.values.update(gpu, Content::Values, [0, positions.len() as u64], || vec![0.0_f32; positions.len()])
        }
    }
    buffers.parts.resize_with(surface.parts.len(), Cached::default);
    for (part, indices) in surface.parts.iter().zip(&mut buffers.parts) {
        let triangles = &part.triangles;
        indices.update(gpu, Content::Triangles, [triangles.generation(), 0], || triangles.to_vec());
    }
}

fn style(surface: &Surface, part: &Part) -> SurfaceStyle {
    let (color, metal, shown) = match part.paint {
        Paint::Matt(color) => (color, 0.0, None),
        Paint::Metal(color) => (color, 1.0, None),
        Paint::Heat => (NO_FIELD, 0.0, field(surface)),
    };
    let [r, g, b, _] = unit(color);
    let field = shown.map_or([0.0; 4], |s| {
        let [lo, hi] = s.range;
        let per_unit = if hi > lo { 1.0 / (hi - lo) } else { 0.0 };
        [lo, per_unit, f32::from(s.map.row()), 1.0]
    });
    SurfaceStyle { color: [r, g, b, part.opacity], field, finish: [metal, 0.0, 0.0, 0.0] }
}
