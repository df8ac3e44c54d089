//! The frame around the view: what is shown of it.

use super::app::App;
use super::command::Command;
use super::ui_state::Tab;
use crate::render::Projection;
use egui::Context;

impl App {
    /// Carries out the commands that change what is seen and nothing else.
    pub(super) fn run_view(&mut self, ctx: &Context, command: Command) {
        let state = &mut self.state;
        match command {
            Command::Fit => state.fit = true,
            Command::LookFrom(view) => state.camera.look_from(view),
            Command::Orthographic => {
                state.camera.projection = match state.camera.projection {
                    Projection::Perspective => Projection::Orthographic,
                    Projection::Orthographic => Projection::Perspective,
                }
            }
            Command::ShowCage => state.shows_cage = !state.shows_cage,
            Command::ShowGhost => state.shows_ghost = !state.shows_ghost,
            Command::SeeThrough => state.sees_through = !state.sees_through,
            Command::ShowHistory => {
                state.tab = if state.tab == Tab::History { Tab::Cage } else { Tab::History };
            }
            Command::ShowLog => state.shows_log = !state.shows_log,
            Command::Theme(theme) => {
                state.theme = theme;
                ctx.set_theme(theme);
            }
            other => debug_assert!(false, "{other:?} is not carried out"),
        }
    }
}
