//! Pass: handles. Like lines, dimmed where hidden and in full where not.

use super::gpu::{Cached, Content, Uploader};
use super::passes::{Recipe, Record, Records, Shared, shader, shader_source};
use super::scene::{HandleState, Handles, Scene};
use super::uniforms::{HandleStyle, unit};
use wgpu::{CompareFunction, PrimitiveTopology};

/// Depth steps that lift a handle over the lines and faces that meet in it.
const LIFT: f32 = 6.0;
/// Width of the rim, points.
const RIM: f32 = 1.25;

#[derive(Debug)]
pub(super) struct HandlePass {
    hidden: wgpu::RenderPipeline,
    visible: wgpu::RenderPipeline,
    positions: Cached,
    states: Cached,
    draws: Option<(Option<Record>, Record)>,
}

impl HandlePass {
    pub(super) fn new(device: &wgpu::Device, shared: &Shared) -> Self {
        let module = shader(device, "handles", shader_source!("handles"));
        let positions = wgpu::vertex_attr_array![0 => Float32x3];
        let states = wgpu::vertex_attr_array![1 => Uint32];
        let step_mode = wgpu::VertexStepMode::Instance;
        let buffers = [
            Some(wgpu::VertexBufferLayout { array_stride: 12, step_mode, attributes: &positions }),
            Some(wgpu::VertexBufferLayout { array_stride: 4, step_mode, attributes: &states }),
        ];
        let make = |depth| {
            shared.pipeline(
                device,
                &Recipe {
                    label: "handles",
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
        Self { hidden, visible, positions: Cached::default(), states: Cached::default(), draws: None }
    }

    pub(super) fn update(&mut self, gpu: &mut Uploader<'_>, scene: &Scene, scale: f32, records: &mut Records) {
        self.draws = scene.handles.as_ref().map(|handles| {
            let (positions, states) = (&handles.positions, &handles.states);
            self.positions.update(gpu, Content::Handles, [positions.generation(), 0], || positions.to_vec());
            let key = [states.generation(), positions.len() as u64];
            self.states.update(gpu, Content::Handles, key, || codes(handles));
            let mut push = |alpha| records.push(&style(handles, scale, alpha));
            ((handles.hidden > 0.0).then(|| push(handles.hidden)), push(1.0))
        });
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        let (Some((hidden, visible)), Some(p), Some(s)) = (self.draws, self.positions.slice(), self.states.slice())
        else {
            return;
        };
        pass.set_vertex_buffer(0, p);
        pass.set_vertex_buffer(1, s);
        for (pipeline, style) in [(&self.hidden, hidden), (&self.visible, Some(visible))] {
            let Some(style) = style else { continue };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &shared.style_group, &[style]);
            pass.draw(0..4, 0..self.positions.count);
        }
    }
}

fn style(handles: &Handles, scale: f32, alpha: f32) -> HandleStyle {
    let shape = [handles.radius * scale, RIM * scale, alpha, LIFT];
    HandleStyle { fills: handles.fills.map(unit), outline: unit(handles.outline), shape }
}

/// One number per handle, in the order of the fills.
fn codes(handles: &Handles) -> Vec<u32> {
    let given = handles.states.iter().copied();
    let states = given.chain(std::iter::repeat(HandleState::Normal)).take(handles.positions.len());
    let code = |state| match state {
        HandleState::Normal => 0,
        HandleState::Hovered => 1,
        HandleState::Selected => 2,
        HandleState::Locked => 3,
    };
    states.map(code).collect()
}
