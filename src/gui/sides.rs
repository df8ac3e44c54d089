//! The panels on the left and on the right of the view.

use super::app::App;
use super::command::{Command, Facts};
use super::field::Refused;
use super::outbox::Outbox;
use super::ui_state::{RightTab, Tab};
use super::{
    panel_antenna, panel_cage, panel_compare, panel_compensation, panel_distortion, panel_heat, panel_history,
    panel_mesh, panel_solve,
};
use egui::{Panel, Rect, ScrollArea, Ui};

/// Widths of the side panels, points: all inputs fit, and 1280 points leave the view the larger half.
const WIDTHS: [f32; 2] = [312.0, 316.0];

impl App {
    /// Draws both, each if it is shown; returns where they are.
    pub(super) fn side_panels(&mut self, ui: &mut Ui, facts: &Facts, out: &mut Outbox) -> [Option<Rect>; 2] {
        let pose = self.session.pose().cloned();
        let mut is_shown = self.state.shows_left;
        let left = Panel::left("left").default_size(WIDTHS[0]).size_range(260.0..=420.0).show_collapsible(
            ui,
            &mut is_shown,
            |ui| {
                ui.add_space(4.0);
                ui.horizontal(|ui| {
                    ui.selectable_value(&mut self.state.tab, Tab::Cage, "Cage")
                        .on_hover_text("Presets, cage and vertices");
                    let tip = "Dimensions and materials of the flat antenna";
                    ui.selectable_value(&mut self.state.tab, Tab::Antenna, "Antenna").on_hover_text(tip);
                    let tip = Command::ShowHistory.tooltip(ui.ctx());
                    ui.selectable_value(&mut self.state.tab, Tab::History, "History").on_hover_text(tip);
                });
                ui.separator();
                ScrollArea::vertical().auto_shrink(false).id_salt(self.state.tab as u8).show(ui, |ui| {
                    match self.state.tab {
                        Tab::Antenna => panel_antenna::ui(ui, self.session.project(), &mut self.state, out),
                        Tab::History => panel_history::ui(ui, self.session.history(), self.session.path.is_some(), out),
                        Tab::Cage => panel_cage::ui(ui, self.session.project(), pose.as_ref(), &mut self.state, out),
                    }
                });
            },
        );
        self.state.shows_left = is_shown;
        let mut is_shown = self.state.shows_right;
        let right = Panel::right("right").default_size(WIDTHS[1]).size_range(280.0..=440.0).show_collapsible(
            ui,
            &mut is_shown,
            |ui| {
                ui.add_space(4.0);
                ui.horizontal(|ui| {
                    let tip = "Distortion of the deformed antenna and its compensation";
                    ui.selectable_value(&mut self.state.right_tab, RightTab::Figures, "Deformation").on_hover_text(tip);
                    let tip = "The tetrahedral mesh of the antenna and the air around it";
                    ui.selectable_value(&mut self.state.right_tab, RightTab::Mesh, "Mesh").on_hover_text(tip);
                    let tip = "The field: reflection and radiation";
                    ui.selectable_value(&mut self.state.right_tab, RightTab::Solve, "Solve").on_hover_text(tip);
                });
                ui.separator();
                let tab = self.state.right_tab;
                ScrollArea::vertical().auto_shrink(false).id_salt(tab as u8).show(ui, |ui| match tab {
                    RightTab::Figures => {
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
                    RightTab::Mesh => {
                        panel_mesh::ui(ui, self.session.project(), &self.mesh, facts, &mut self.state, out);
                    }
                    RightTab::Solve => {
                        panel_solve::ui(ui, self.session.project(), &mut self.solve, facts, &mut self.state, out);
                    }
                });
            },
        );
        self.state.shows_right = is_shown;
        [left, right].map(|side| side.map(|side| side.response.rect))
    }
}
