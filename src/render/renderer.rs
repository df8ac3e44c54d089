//! Draws a scene into textures of its own and hands the finished picture on.
//!
//! Order: opaque surfaces, grid, translucent surfaces, lines, handles, gizmo; four samples per texel, resolved into
//! the texture that [`Renderer::blit`] shows. The renderer keeps the scene and view of its last picture: as long as
//! both are the same it draws nothing.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the size in texels is clamped to what the device takes"
)]

use super::blit::BlitPass;
use super::camera::Projection;
use super::gizmo::GizmoPass;
use super::gpu::{Counts, Uploader};
use super::grid::GridPass;
use super::handles::HandlePass;
use super::lines::LinePass;
use super::passes::{COLOR_FORMAT, DEPTH_FORMAT, Records, SAMPLES, Shared};
use super::scene::Scene;
use super::surface::SurfacePass;
use super::uniforms::{Globals, unit};
use super::view::View;

/// Everything that lives on the graphics adapter for one viewport.
#[derive(Debug)]
pub struct Renderer {
    shared: Shared,
    surfaces: SurfacePass,
    grid: GridPass,
    lines: LinePass,
    handles: HandlePass,
    gizmo: GizmoPass,
    blit: BlitPass,
    targets: Option<Targets>,
    drawn: Option<(Scene, View)>,
    counts: Counts,
}

#[derive(Debug)]
struct Targets {
    size: [u32; 2],
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::Texture,
    resolved_view: wgpu::TextureView,
    blit_group: wgpu::BindGroup,
}

impl Renderer {
    /// Makes the pipelines; `format` is that of the pass that [`Self::blit`] will draw into.
    #[must_use]
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, format: wgpu::TextureFormat) -> Self {
        let shared = Shared::new(device, queue);
        Self {
            surfaces: SurfacePass::new(device, &shared),
            grid: GridPass::new(device, &shared),
            lines: LinePass::new(device, &shared),
            handles: HandlePass::new(device, &shared),
            gizmo: GizmoPass::new(device, &shared),
            blit: BlitPass::new(device, format),
            shared,
            targets: None,
            drawn: None,
            counts: Counts::default(),
        }
    }

    /// Uploads what changed and records the drawing of `scene`; false if the last picture still holds.
    ///
    /// The picture is there once `encoder` is submitted, after what was written to `queue` until then.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        scene: &Scene,
        view: &View,
    ) -> bool {
        if self.drawn.as_ref().is_some_and(|(s, v)| s == scene && v == view) {
            return false;
        }
        let limit = device.limits().max_texture_dimension_2d as f32;
        let size = (view.size * view.scale).round().clamp(glam::Vec2::ONE, glam::Vec2::splat(limit));
        let size = [size.x as u32, size.y as u32];
        if self.targets.as_ref().is_none_or(|t| t.size != size) {
            self.targets = Some(self.make_targets(device, size));
        }
        let mut gpu = Uploader { device, queue, counts: &mut self.counts };
        let mut records = Records::default();
        self.surfaces.update(&mut gpu, scene, &mut records);
        self.grid.update(scene, view, &mut records);
        self.lines.update(&mut gpu, scene, view.scale, &mut records);
        self.handles.update(&mut gpu, scene, view.scale, &mut records);
        self.gizmo.update(&mut gpu, scene, view);
        self.shared.update(&gpu, &globals(view, size), &records);
        self.counts.pictures += 1;
        self.record(encoder, scene);
        self.drawn = Some((scene.clone(), *view));
        true
    }

    /// What was uploaded and drawn so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Draws the last picture over the viewport of `pass`; nothing before the first [`Self::prepare`].
    pub fn blit(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(targets) = &self.targets {
            self.blit.draw(pass, &targets.blit_group);
        }
    }

    /// The finished picture, `Rgba8Unorm` with encoded colour; none before the first [`Self::prepare`].
    #[must_use]
    pub fn texture(&self) -> Option<&wgpu::Texture> {
        self.targets.as_ref().map(|t| &t.resolved)
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder, scene: &Scene) {
        let Some(targets) = &self.targets else { return };
        // Blending over a clear ground multiplies colours by their alpha, so the ground begins so, too.
        let [r, g, b, a] = unit(scene.background).map(f64::from);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &targets.color,
                depth_slice: None,
                resolve_target: Some(&targets.resolved_view),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r: r * a, g: g * a, b: b * a, a }),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        let shared = &self.shared;
        pass.set_bind_group(0, &shared.global_group, &[]);
        // The gizmo has no style of its own but the same layout as the others.
        pass.set_bind_group(1, &shared.style_group, &[0]);
        self.surfaces.draw_opaque(&mut pass, shared);
        self.grid.draw(&mut pass, shared);
        self.surfaces.draw_translucent(&mut pass, shared);
        self.lines.draw(&mut pass, shared);
        self.handles.draw(&mut pass, shared);
        self.gizmo.draw(&mut pass);
    }

    fn make_targets(&self, device: &wgpu::Device, size: [u32; 2]) -> Targets {
        let make = |label, format, sample_count, extra| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | extra,
                view_formats: &[],
            })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let none = wgpu::TextureUsages::empty();
        let color = make("scene samples", COLOR_FORMAT, SAMPLES, none);
        let depth = make("scene depth", DEPTH_FORMAT, SAMPLES, none);
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let resolved = make("scene", COLOR_FORMAT, 1, read);
        let resolved_view = view(&resolved);
        let blit_group = self.blit.bind(device, &resolved_view);
        Targets { size, color: view(&color), depth: view(&depth), resolved, resolved_view, blit_group }
    }
}

/// Uniforms of the view. One depth step is what one point of the screen spans, laid along the line of sight.
fn globals(view: &View, [width, height]: [u32; 2]) -> Globals {
    let camera = &view.camera;
    let (perspective, depth) = match camera.projection {
        Projection::Perspective => {
            let factor = 2.0 * (camera.fov / 2.0).tan() / view.size.y.max(1.0);
            (1.0, [factor, 0.0, camera.near(), 0.0])
        }
        Projection::Orthographic => {
            let summand = view.length_per_point(camera.target) / (2.0 * camera.half_depth());
            (0.0, [0.0, summand, 0.5, 0.0])
        }
    };
    Globals {
        clip_from_world: view.clip_from_world().to_cols_array_2d(),
        view_from_world: camera.view_from_world().to_cols_array_2d(),
        viewport: [width as f32, height as f32, view.scale, perspective],
        depth,
    }
}
