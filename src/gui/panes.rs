//! The panes of the window: what is drawn in each tile of the layout, and what its tabs look like.

use super::app::App;
use super::command::Facts;
use super::field::Refused;
use super::layout::{Pane, tabs_for_all};
use super::outbox::Outbox;
use super::theme::Tokens;
use super::ui_state::{RightTab, Tab};
use super::viewport::Sources;
use super::{
    panel_antenna, panel_cage, panel_compare, panel_compensation, panel_distortion, panel_heat, panel_history,
    panel_mesh, panel_results, panel_solve,
};
use egui::{
    Color32, Frame, Id, Margin, Response, ScrollArea, Stroke, Style, Ui, Visuals, WidgetRect, WidgetText, accesskit,
};
use egui_tiles::{Behavior, ResizeState, SimplificationOptions, TabState, Tabs, TileId, Tiles, UiResponse};

/// Width of the line between tiles and height of a row of tabs, points.
const GAP: f32 = 1.0;
const TAB_HEIGHT: f32 = 28.0;
/// Least width and height of a tile, points.
const LEAST_SIZE: f32 = 100.0;

/// Draws the tiles.
struct Panes<'a> {
    app: &'a mut App,
    facts: &'a Facts,
    out: &'a mut Outbox,
    /// The view's tile.
    view: Option<TileId>,
    tokens: &'static Tokens,
}

impl App {
    /// Draws all panes.
    pub(super) fn panes(&mut self, ui: &mut Ui, facts: &Facts, out: &mut Outbox) {
        let mut layout = std::mem::take(&mut self.state.layout);
        layout.show(&Pane::LEFT, self.state.shows_left);
        layout.show(&Pane::RIGHT, self.state.shows_right);
        layout.show(&[Pane::Results], self.state.solve.shows_results);
        layout.show(&[Pane::Messages], self.state.shows_log);
        // What was asked for since the last frame comes forward.
        let asked = (self.state.tab, self.state.right_tab);
        if self.state.tabs_seen != Some(asked) {
            layout.bring_forward(asked.0.into());
            layout.bring_forward(asked.1.into());
        }
        layout.keep_sizes(ui.available_size(), GAP);
        let view = layout.tile(Pane::View);
        let tokens = Tokens::here(ui);
        layout.tree.ui(&mut Panes { app: self, facts, out, view, tokens }, ui);
        tell_edges(ui);
        let state = &mut self.state;
        // Of the tabs that the user brought forward, those in front are told.
        if !layout.is_in_front(state.tab.into()) {
            let front = [Tab::Cage, Tab::Antenna, Tab::History].into_iter().find(|t| layout.is_in_front((*t).into()));
            state.tab = front.unwrap_or(state.tab);
        }
        if !layout.is_in_front(state.right_tab.into()) {
            let all = [RightTab::Figures, RightTab::Mesh, RightTab::Solve];
            let front = all.into_iter().find(|t| layout.is_in_front((*t).into()));
            state.right_tab = front.unwrap_or(state.right_tab);
        }
        state.tabs_seen = Some((state.tab, state.right_tab));
        state.layout = layout;
    }

    fn view(&mut self, ui: &mut Ui, out: &mut Outbox) {
        let own = self.session.pose().cloned();
        let mesh = self.mesh.shown().filter(|_| self.state.mesh.shows);
        let solve = Some(&self.solve).filter(|_| self.state.solve.shows_pattern);
        let preview = self.state.preview.filter(|_| mesh.is_none());
        let on_show = self.compare.on_show_or(&self.session, preview);
        let pose = preview.and_then(|mode| self.compare.pose(mode)).or(own.as_ref());
        let project = self.session.project();
        let refusals = [self.mesh.error(), self.solve.error()].into_iter().flatten();
        let places = refusals.flat_map(|refusal| refusal.places_mm(project)).chain(self.session.places_mm());
        let places_mm: Vec<[f64; 3]> = places.copied().collect();
        let (session, places_mm, draft) = (&self.session, &places_mm[..], self.dialog.draft());
        let mut sources = Sources { session, pose, mesh, solve, on_show, preview, places_mm, draft };
        if let Some(draft) = draft {
            // Alone, and not within the antenna whose place the bodies would take.
            (sources.pose, sources.mesh, sources.solve) = (None, None, None);
            (sources.on_show, sources.preview, sources.places_mm) = (None, None, &draft.places_mm);
        }
        self.viewport.ui(ui, sources, &mut self.state, out);
    }

    fn pane(&mut self, ui: &mut Ui, pane: Pane, facts: &Facts, out: &mut Outbox) {
        let pose = self.session.pose().cloned();
        let project = self.session.project();
        match pane {
            Pane::View => {}
            Pane::Antenna => panel_antenna::ui(ui, project, &mut self.state, out),
            Pane::History => panel_history::ui(ui, self.session.history(), self.session.path.is_some(), out),
            Pane::Cage => panel_cage::ui(ui, project, pose.as_ref(), &mut self.state, out),
            Pane::Figures => self.figures(ui, facts, out),
            Pane::Mesh => panel_mesh::ui(ui, project, &self.mesh, facts, &mut self.state, out),
            Pane::Solve => panel_solve::ui(ui, project, &mut self.solve, facts, &mut self.state, out),
            Pane::Results => panel_results::ui(ui, project, &self.solve, facts, &mut self.state.solve, out),
            Pane::Messages => self.messages.log(ui),
        }
    }

    fn figures(&mut self, ui: &mut Ui, facts: &Facts, out: &mut Outbox) {
        ui.heading("Distortion");
        panel_distortion::ui(ui, &self.session, &mut self.state);
        ui.add_space(4.0);
        let on_show = self.compare.on_show_or(&self.session, self.state.preview);
        let has_cylinder = on_show.is_some_and(|s| !s.deformed.fields.on_cylinder.is_empty());
        let heated = self.viewport.heated(on_show, &self.state).cloned();
        panel_heat::ui(ui, heated.as_ref(), has_cylinder, &mut self.state, out);
        ui.add_space(6.0);
        ui.separator();
        ui.heading("Before and after");
        panel_compare::ui(ui, self.session.project(), &self.compare, facts, &mut self.state, out);
        ui.add_space(6.0);
        ui.separator();
        ui.heading("Compensation");
        panel_compensation::ui(ui, &self.session, Refused(self.state.refused.as_ref()), out);
    }
}

/// Tells screen readers of the edges between tiles, which come without role and name. They are known by their form.
fn tell_edges(ui: &Ui) {
    let width = 2.0 * ui.style().interaction.resize_grab_radius_side;
    let is_edge = |w: &&WidgetRect| {
        let size = w.rect.size();
        w.sense.senses_drag() && (size.min_elem() - width).abs() < 0.1 && size.max_elem() > LEAST_SIZE
    };
    let edges: Vec<Id> = ui.ctx().viewport(|viewport| {
        viewport.this_pass.widgets.get_layer(ui.layer_id()).filter(is_edge).map(|w| w.id).collect()
    });
    for id in edges {
        ui.ctx().accesskit_node_builder(id, |node| {
            node.set_role(accesskit::Role::Splitter);
            node.set_label("Edge between panes");
        });
    }
}

impl Behavior<Pane> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, pane: &mut Pane) -> UiResponse {
        if *pane == Pane::View {
            self.app.view(ui, self.out);
        } else {
            let frame = Frame::new().fill(self.tokens.panel).inner_margin(Margin::symmetric(8, 6));
            frame.show(ui, |ui| {
                let mut content = |ui: &mut Ui| self.app.pane(ui, *pane, self.facts, self.out);
                if Pane::BELOW.contains(pane) {
                    // They fill the room there is and scroll what needs it.
                    ui.set_min_size(ui.available_size());
                    content(ui);
                } else {
                    ScrollArea::vertical().auto_shrink(false).id_salt(*pane).show(ui, content);
                }
            });
        }
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        pane.text_and_tip().0.into()
    }

    fn on_tab_button(&mut self, tiles: &mut Tiles<Pane>, tile: TileId, response: Response) -> Response {
        let tip = tiles.get_pane(&tile).map_or("", |pane| pane.text_and_tip().1);
        response.on_hover_text(format!("{tip}\nDrag the tab to another place; View > Reset layout puts all back"))
    }

    fn is_tab_bar_visible(&self, _: TileId, tabs: &Tabs) -> bool {
        // The view alone needs no tab: nothing but the view is there.
        tabs.children.len() != 1 || tabs.children.first().copied() != self.view
    }

    fn simplification_options(&self) -> SimplificationOptions {
        tabs_for_all()
    }

    fn tab_bar_height(&self, _: &Style) -> f32 {
        TAB_HEIGHT
    }

    fn gap_width(&self, _: &Style) -> f32 {
        GAP
    }

    fn is_tile_draggable(&self, tiles: &Tiles<Pane>, tile: TileId) -> bool {
        tiles.get_pane(&tile).is_some()
    }

    fn min_size(&self) -> f32 {
        LEAST_SIZE
    }

    fn resize_stroke(&self, _: &Style, state: ResizeState) -> Stroke {
        match state {
            ResizeState::Idle => Stroke::new(GAP, self.tokens.line),
            ResizeState::Hovering => Stroke::new(2.0, self.tokens.weak),
            ResizeState::Dragging => Stroke::new(2.0, self.tokens.accent),
        }
    }

    fn drag_preview_stroke(&self, _: &Visuals) -> Stroke {
        Stroke::new(1.0, self.tokens.accent)
    }

    fn drag_preview_color(&self, _: &Visuals) -> Color32 {
        self.tokens.accent.gamma_multiply(0.25)
    }

    fn tab_bar_color(&self, _: &Visuals) -> Color32 {
        self.tokens.button[0]
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_text_color(&self, _: &Visuals, _: &Tiles<Pane>, _: TileId, state: &TabState) -> Color32 {
        if state.active { self.tokens.text } else { self.tokens.weak }
    }
}
