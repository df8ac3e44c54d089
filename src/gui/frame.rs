//! The frame around the view: size of the interface, sides shown, and the way from panel to panel by key.

use super::app::App;
use super::bars;
use super::command::{Command, Facts};
use super::layout::Pane;
use super::outbox::Outbox;
use super::status::{self, Workers};
use super::ui_state::UiState;
use crate::render::Projection;
use egui::{CentralPanel, Context, Frame, Id, LayerId, Panel, Rect, Ui};

/// Width of a panel's edge, points.
const EDGE: f32 = 4.0;
/// Width of a notification, points.
const TOAST_WIDTH: f32 = 420.0;
/// Smallest and largest size of the interface, and the step between.
const SCALES: [f32; 2] = [0.7, 2.0];
const SCALE_STEP: f32 = 0.1;

impl App {
    /// Carries out the commands that change what is seen and nothing else; false if it is another one.
    pub(super) fn run_view(&mut self, ctx: &Context, command: Command) -> bool {
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
            Command::Paint(heat) => state.paint(heat),
            Command::SeeThrough => state.sees_through = !state.sees_through,
            Command::ShowHistory => {
                let is_shown = state.layout.is_in_front(Pane::History);
                state.show_pane(if is_shown { Pane::Cage } else { Pane::History });
            }
            Command::ShowResults if state.layout.is_in_front(Pane::Results) => state.solve.shows_results = false,
            Command::ShowResults => state.show_pane(Pane::Results),
            Command::ShowLog if state.layout.is_in_front(Pane::Messages) => state.shows_log = false,
            Command::ShowLog => state.show_pane(Pane::Messages),
            Command::Theme(theme) => {
                state.theme = theme;
                ctx.set_theme(theme);
            }
            Command::ShowLeft => state.shows_left = !state.shows_left,
            Command::ShowRight => state.shows_right = !state.shows_right,
            Command::ResetLayout => reset_layout(ctx, state),
            Command::ZoomIn => set_scale(ctx, state, state.scale + SCALE_STEP),
            Command::ZoomOut => set_scale(ctx, state, state.scale - SCALE_STEP),
            Command::ZoomReset => set_scale(ctx, state, 1.0),
            Command::NextPanel => self.focus_panel(ctx, true),
            Command::PreviousPanel => self.focus_panel(ctx, false),
            _ => return false,
        }
        true
    }

    /// Draws everything around the view and the view; returns how far notifications are raised over the status line.
    pub(super) fn panels(&mut self, ui: &mut Ui, facts: &Facts, out: &mut Outbox) -> f32 {
        let recent = &self.state.recent_files;
        let menus = Panel::top("menus").show(ui, |ui| bars::menus(ui, facts, recent, out)).response.rect;
        let tools = Panel::top("tools").show(ui, |ui| bars::toolbar(ui, facts, out)).response.rect;
        let status = Panel::bottom("status").show(ui, |ui| {
            let workers = Workers { session: &self.session, mesh: &self.mesh, solve: &self.solve };
            status::ui(ui, workers, &self.messages, facts.shows_log, out);
        });
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| self.panes(ui, facts, out));
        let panes = self.state.layout.areas().into_iter().map(|(_, rect)| rect);
        self.areas = [menus, tools].into_iter().chain(panes).chain([status.response.rect]).collect();
        self.state.layout.height_at_corner(TOAST_WIDTH)
    }

    /// Gives the keys to the first control of the next panel that has one.
    fn focus_panel(&self, ctx: &Context, is_forward: bool) {
        let count = self.areas.len();
        let focused = ctx.memory(|m| m.focused());
        let rect = focused.and_then(|id| ctx.viewport(|v| v.prev_pass.widgets.get(id).map(|w| w.rect)));
        let here = rect.and_then(|rect| self.areas.iter().position(|area| area.contains(rect.center())));
        let order = (1..=count).map(|step| match here {
            Some(here) if is_forward => (here + step) % count,
            Some(here) => (here + count - step) % count,
            None if is_forward => step - 1,
            None => count - step,
        });
        if let Some(id) = order.filter_map(|k| first_control(ctx, self.areas[k])).next() {
            ctx.memory_mut(|m| m.request_focus(id));
        }
    }
}

impl UiState {
    /// Shows a pane, in front of its tabs wherever it is.
    pub(super) fn show_pane(&mut self, pane: Pane) {
        match pane {
            Pane::View => {}
            Pane::Cage | Pane::Antenna | Pane::History => self.shows_left = true,
            Pane::Figures | Pane::Mesh | Pane::Solve => self.shows_right = true,
            Pane::Results => self.solve.shows_results = true,
            Pane::Messages => self.shows_log = true,
        }
        self.layout.show(&[pane], true);
        self.layout.bring_forward(pane);
    }
}

/// The first control within an area that the keys can reach.
fn first_control(ctx: &Context, area: Rect) -> Option<Id> {
    ctx.viewport(|viewport| {
        let widgets = &viewport.prev_pass.widgets;
        let mut all = widgets.get_layer(LayerId::background());
        // The edges by which panels are resized are in none.
        let area = area.shrink(EDGE);
        let control = all.find(|w| w.enabled && w.sense.is_focusable() && area.contains(w.rect.center()));
        control.map(|w| w.id)
    })
}

/// Sets the size of the interface as it is remembered; a size from elsewhere may be out of range.
pub(super) fn set_scale(ctx: &Context, state: &mut UiState, scale: f32) {
    let scale = if scale.is_finite() { scale } else { 1.0 };
    state.scale = ((scale * 10.0).round() / 10.0).clamp(SCALES[0], SCALES[1]);
    ctx.set_zoom_factor(state.scale);
}

/// Sides, tabs and sizes as at the first start.
fn reset_layout(ctx: &Context, state: &mut UiState) {
    let first = UiState::default();
    (state.shows_left, state.shows_right) = (first.shows_left, first.shows_right);
    (state.layout, state.tabs_seen) = (first.layout, None);
    (state.tab, state.right_tab, state.shows_log) = (first.tab, first.right_tab, first.shows_log);
    state.solve.shows_results = first.solve.shows_results;
    set_scale(ctx, state, first.scale);
}
