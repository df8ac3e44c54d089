//! Pass: the ground grid, on one quad about the camera's target.

use super::passes::{Recipe, Record, Records, Shared, shader, shader_source};
use super::scene::{Grid, Scene};
use super::uniforms::{GridStyle, unit};
use super::view::View;
use wgpu::{CompareFunction, PrimitiveTopology};

/// Half the side of the quad over the height of the view: the fade ends well outside of what is being looked at.
const REACH: f32 = 2.0;
/// Depth steps that put the grid behind a surface lying in its plane.
const SINK: f32 = 2.0;

#[derive(Debug)]
pub(super) struct GridPass {
    pipeline: wgpu::RenderPipeline,
    style: Option<Record>,
}

impl GridPass {
    pub(super) fn new(device: &wgpu::Device, shared: &Shared) -> Self {
        let module = shader(device, "grid", shader_source!("grid"));
        let pipeline = shared.pipeline(
            device,
            &Recipe {
                label: "grid",
                module: &module,
                buffers: &[],
                topology: PrimitiveTopology::TriangleStrip,
                cull: None,
                depth: CompareFunction::Greater,
                depth_write: false,
            },
        );
        Self { pipeline, style: None }
    }

    pub(super) fn update(&mut self, scene: &Scene, view: &View, records: &mut Records) {
        self.style = scene.grid.as_ref().map(|grid| records.push(&style(grid, view)));
    }

    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        if let Some(style) = self.style {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(1, &shared.style_group, &[style]);
            pass.draw(0..4, 0..1);
        }
    }
}

fn style(grid: &Grid, view: &View) -> GridStyle {
    let target = view.camera.target;
    let half = REACH * 2.0 * view.camera.half_height() * view.aspect().max(1.0);
    GridStyle {
        color: unit(grid.color),
        x_axis: unit(grid.axes[0]),
        y_axis: unit(grid.axes[1]),
        place: [target.x, target.y, grid.z, half],
        shape: [grid.spacing, view.scale, SINK, 0.0],
    }
}
