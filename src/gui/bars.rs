//! Menus and toolbar.

use super::command::{Command, Facts};
use super::outbox::{Action, Outbox};
use egui::Ui;

/// Draws the menus.
pub(super) fn menus(ui: &mut Ui, facts: &Facts, out: &mut Outbox) {
    use Command as C;
    let all = |keep: fn(&Command) -> bool| C::ALL.into_iter().filter(keep);
    let menu = |ui: &mut Ui, title: &str, commands: Vec<Command>, out: &mut Outbox| {
        ui.menu_button(title, |ui| {
            for command in commands {
                if command.menu_item(ui, facts) {
                    out.push(Action::Run(command));
                }
            }
        });
    };
    egui::MenuBar::new().ui(ui, |ui| {
        menu(
            ui,
            "File",
            vec![C::New, C::Open, C::Save, C::SaveAs, C::Export, C::ExportMesh, C::ExportResults, C::SavePlot, C::Quit],
            out,
        );
        let edit = [C::Undo, C::Redo, C::SelectAll, C::SelectNone, C::BoxSelect, C::ResetSelected, C::ResetAll];
        menu(ui, "Edit", edit.to_vec(), out);
        menu(ui, "Antenna", vec![C::Compensate, C::CompensateNot, C::Mesh, C::Solve], out);
        let mut view: Vec<Command> = vec![C::Fit];
        view.extend(all(|c| matches!(c, C::LookFrom(_))));
        view.extend([
            C::Orthographic,
            C::ShowCage,
            C::SeeThrough,
            C::ShowMesh,
            C::ShowResults,
            C::ShowPattern,
            C::ShowLog,
        ]);
        menu(ui, "View", view, out);
        menu(ui, "Theme", all(|c| matches!(c, C::Theme(_))).collect(), out);
        menu(ui, "Help", vec![C::Keys], out);
    });
}

/// Draws the buttons below the menus.
pub(super) fn toolbar(ui: &mut Ui, facts: &Facts, out: &mut Outbox) {
    use Command as C;
    let groups: [&[Command]; 7] = [
        &[C::Open, C::Save, C::Export],
        &[C::Undo, C::Redo],
        &[C::Compensate, C::CompensateNot],
        &[C::Mesh, C::ShowMesh],
        &[C::Solve, C::ShowResults],
        &[C::BoxSelect, C::SelectNone],
        &[C::Fit, C::Orthographic, C::ShowCage],
    ];
    ui.horizontal_wrapped(|ui| {
        for (number, group) in groups.into_iter().enumerate() {
            if number > 0 {
                ui.separator();
            }
            for &command in group {
                if command.tool_button(ui, facts) {
                    out.push(Action::Run(command));
                }
            }
        }
    });
}
