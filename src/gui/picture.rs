//! The view as a picture, where no window opens.

use super::heat::OnShow;
use super::scene::{Hot, SceneBuilder, Subject};
use super::session::Session;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::pipeline::Deformed;
use crate::project::Project;
use crate::render::{Gpu, GpuError, Vec3, View, picture as render_picture};
use egui::Theme;

/// Width and height, pixels.
const SIZE: [u32; 2] = [1600, 1000];

/// Draws the computed antenna in its cage as the window shows it first, as a PNG; `None` without a graphics adapter.
///
/// # Errors
/// If there is an adapter and it fails.
pub fn picture(project: &Project, deformed: &Deformed) -> anyhow::Result<Option<Vec<u8>>> {
    let gpu = match Gpu::headless() {
        Err(GpuError::NoAdapter { .. }) => return Ok(None),
        other => other?,
    };
    let mut session = Session::showing(project.clone(), deformed.clone());
    let state = UiState::default();
    let pose = session.pose().cloned();
    let on_show = session.shown().map(|s| OnShow { deformed: &s.deformed, serial: s.serial });
    let subject = Subject { on_show, drawn: Some(project), pose: pose.as_ref(), is_fixed: false };
    let scene = SceneBuilder::default().scene(subject, &state, Tokens::of(Theme::Light), Hot::default());
    let points = scene.lines.iter().flat_map(|l| l.positions.iter());
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (lo, hi) = points.fold(start, |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    let [width, height] = SIZE;
    let mut view = View::new(state.camera, width as f32, height as f32);
    view.fit(lo, hi);
    Ok(Some(render_picture(&gpu, &scene, &view)?.png()?))
}
