//! Hands a scene to the renderer within the frame of egui: draw in `prepare`, show in `paint`.

use crate::render::{Renderer, Scene, View};
use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};

/// Makes the renderer and leaves it with egui's other resources.
pub(super) fn install(state: &RenderState) {
    let renderer = Renderer::new(&state.device, &state.queue, state.target_format);
    state.renderer.write().callback_resources.insert(renderer);
}

/// One viewport in one frame.
#[derive(Debug)]
pub(super) struct ScenePaint {
    pub(super) scene: Scene,
    pub(super) view: View,
}

impl CallbackTrait for ScenePaint {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(renderer) = resources.get_mut::<Renderer>() {
            renderer.prepare(device, queue, encoder, &self.scene, &self.view);
        }
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(renderer) = resources.get::<Renderer>() {
            renderer.blit(pass);
        }
    }
}
