//! Before and after: the figures without compensation, by WL and isometrically, and a switch that shows each of them.

use super::command::{Command, Facts};
use super::compare_session::{CompareSession, mode_text};
use super::outbox::{Action, Outbox};
use super::panel_distortion::{LINES, ROW_HEIGHT, mark};
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::pipeline::compare_job::MODES;
use crate::project::Project;
use egui::{Grid, RichText, Spinner, Ui};

/// Draws the panel.
pub(super) fn ui(
    ui: &mut Ui,
    project: &Project,
    compare: &CompareSession,
    facts: &Facts,
    state: &mut UiState,
    out: &mut Outbox,
) {
    let is_stale = compare.is_stale(project);
    ui.horizontal(|ui| {
        if compare.is_busy() {
            ui.add(Spinner::new().size(14.0));
            let phase = compare.progress().map_or("beginning", |p| p.phase);
            ui.label(RichText::new(format!("Comparing: {phase}…")).weak());
            if ui.small_button("Cancel").on_hover_text("Stop comparing; what was found stays").clicked() {
                out.push(Action::CancelCompare);
            }
        } else if Command::Compare.tool_button(ui, facts) {
            out.push(Action::Run(Command::Compare));
        }
    });
    let Some(compared) = compare.compared() else {
        let text = "The same shape without compensation, by WL and isometrically, side by side.";
        ui.label(RichText::new(text).weak());
        return;
    };
    if is_stale {
        let text = RichText::new("⚠ The project has changed since: compare again.").color(Tokens::here(ui).warning);
        ui.label(text);
    } else {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.label("View").on_hover_text("A look at each of them; the project stays as it is");
            let tip = "The project as it is";
            ui.selectable_value(&mut state.preview, None, "Project").on_hover_text(tip);
            for (mode, found) in MODES.into_iter().zip(compared) {
                let button = egui::Button::selectable(state.preview == Some(mode), mode_text(mode));
                let tip = format!("Look at it: {}; the project is not changed", mode_text(mode));
                let response = ui.add_enabled(found.is_ok(), button).on_hover_text(tip);
                if response.on_disabled_hover_text("There is no result: see below").clicked() {
                    state.preview = Some(mode);
                }
            }
        });
    }
    table(ui, compared);
}

fn table(ui: &mut Ui, compared: &crate::pipeline::compare_job::Compared) {
    let tokens = Tokens::here(ui);
    let grid = Grid::new("compared").num_columns(4).striped(true).spacing([5.0, 3.0]).min_row_height(ROW_HEIGHT);
    grid.show(ui, |ui| {
        ui.label("");
        for mode in MODES {
            ui.label(RichText::new(mode_text(mode)).color(tokens.weak));
        }
        ui.end_row();
        for line in &LINES {
            ui.label(line.name).on_hover_text(line.tip);
            for found in compared {
                let figures = found.as_ref().ok().and_then(|d| d.figures.as_ref());
                let text = figures.and_then(line.text).unwrap_or_else(|| "–".to_owned());
                ui.label(mark(RichText::new(text), figures.and_then(line.error), tokens));
            }
            ui.end_row();
        }
    });
    for (mode, found) in MODES.into_iter().zip(compared) {
        if let Err(error) = found {
            let text = format!("{}: {error}", mode_text(mode));
            ui.add(egui::Label::new(RichText::new(text).color(tokens.error).small()).wrap());
        }
    }
}
