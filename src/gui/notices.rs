//! Dialogs about the user's work: what to begin with, what a crash left, and files changed from outside.

use super::command::Command;
use super::dialogs::Next;
use super::outbox::{Action, Outbox};
use super::recovery::Found;
use super::theme::Tokens;
use crate::project::Example;
use egui::{Button, RichText, Ui, vec2};
use std::path::{Path, PathBuf};

/// Height of a choice with a line below it, points.
const CHOICE_HEIGHT: f32 = 40.0;

/// A button over the whole width: what it is, and a line about it.
fn choice(ui: &mut Ui, name: &str, about: &str, tip: &str) -> bool {
    let text = |ui: &Ui| {
        let mut job = egui::text::LayoutJob::default();
        let style = ui.style();
        RichText::new(name).strong().append_to(&mut job, style, egui::FontSelection::Default, egui::Align::Center);
        let below = RichText::new(format!("\n{about}")).weak();
        below.append_to(&mut job, style, egui::FontSelection::Default, egui::Align::Center);
        job
    };
    let button = Button::new(text(ui)).min_size(vec2(ui.available_width(), CHOICE_HEIGHT));
    let response = ui.add(button);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
    response.on_hover_text(tip).clicked()
}

/// What to begin with.
pub(super) fn welcome(ui: &mut Ui, recent: &[PathBuf], out: &mut Outbox) -> bool {
    let before = out.actions.len();
    ui.heading("Welcome to Conformant");
    ui.add_space(4.0);
    ui.label("Draw a patch antenna flat, bend its cage, and the antenna follows without gaps. Begin with an example:");
    ui.add_space(8.0);
    for example in Example::ALL {
        let command = Command::Example(example);
        let (name, about) = command.text_and_tip();
        if choice(ui, name, about, "Open this example; it has no file until you save it") {
            out.push(Action::Run(command));
        }
    }
    ui.add_space(8.0);
    if !recent.is_empty() {
        ui.label("Or go on with a project:");
        for path in recent.iter().take(4) {
            if recent_item(ui, path) {
                out.push(Action::AskRecent(path.clone()));
            }
        }
        ui.add_space(8.0);
    }
    let mut close = false;
    ui.horizontal(|ui| {
        if ui.button("Open a file…").on_hover_text(Command::Open.text_and_tip().1).clicked() {
            out.push(Action::Run(Command::Open));
        }
        if ui.button("Keys and mouse").on_hover_text(Command::Keys.text_and_tip().1).clicked() {
            out.push(Action::Run(Command::Keys));
        }
        close = ui.button("Close").on_hover_text("Go on with what is open; this is under Help, too").clicked();
    });
    close || out.actions.len() > before
}

/// A recent file as a line to choose; greyed where it is gone.
pub(super) fn recent_item(ui: &mut Ui, path: &Path) -> bool {
    let name = path.file_name().map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned());
    let response = ui.add_enabled(path.is_file(), Button::new(name).truncate());
    let place = path.display().to_string();
    response.on_disabled_hover_text(format!("{place}\nThis file is not there any more")).on_hover_text(place).clicked()
}

/// What windows that are gone have left.
pub(super) fn recovery(ui: &mut Ui, found: &[Found], out: &mut Outbox) -> bool {
    ui.heading("Unsaved work was found");
    ui.add_space(4.0);
    ui.label("Conformant did not end in order, and these changes were not saved:");
    ui.add_space(8.0);
    for (index, found) in found.iter().enumerate() {
        ui.push_id(index, |ui| {
            egui::Frame::group(ui.style()).show(ui, |ui| {
                ui.set_width(ui.available_width());
                ui.label(RichText::new(found.name()).strong());
                if let Some(file) = &found.file {
                    ui.add(egui::Label::new(RichText::new(file.display().to_string()).weak()).truncate());
                }
                ui.label(format!("Kept {}", found.age()));
                if found.is_outdated() {
                    let text = "The file was saved after that and may hold newer work: compare before you save.";
                    ui.colored_label(Tokens::here(ui).warning, text);
                }
                ui.horizontal(|ui| {
                    let tip = "Open it with its unsaved changes; the file stays as it is until you save";
                    let recover = ui.button("Recover").on_hover_text(tip);
                    if index == 0 && ui.memory(|m| m.focused().is_none()) {
                        recover.request_focus();
                    }
                    if recover.clicked() {
                        out.push(Action::Recover(index));
                    }
                    let tip = "Delete these changes for good";
                    if ui.button("Discard").on_hover_text(tip).clicked() {
                        out.push(Action::DiscardFound(index));
                    }
                });
            });
        });
    }
    ui.add_space(8.0);
    found.is_empty() || ui.button("Decide later").on_hover_text("Ask again at the next start").clicked()
}

/// The open file was changed by another program.
pub(super) fn changed(ui: &mut Ui, name: &str, is_dirty: bool, out: &mut Outbox) -> bool {
    ui.heading("The file was changed");
    ui.add_space(4.0);
    let mine = if is_dirty { " You have changes of your own that are not saved." } else { "" };
    ui.label(format!("Another program has changed \"{name}\".{mine}"));
    ui.add_space(8.0);
    let mut close = false;
    ui.horizontal(|ui| {
        let tip = "Take over what is in the file now, as one step: Undo brings yours back";
        if ui.button("Reload").on_hover_text(tip).clicked() {
            out.push(Action::Reload);
            close = true;
        }
        let tip = "Go on with what is shown here; saving will ask before it replaces the file";
        close |= ui.button("Keep mine").on_hover_text(tip).clicked();
    });
    close
}

/// Saving would replace a file that another program has changed.
pub(super) fn overwrite(ui: &mut Ui, path: &Path, then: Option<&Next>, out: &mut Outbox) -> bool {
    ui.heading("The file was changed");
    ui.add_space(4.0);
    let text =
        format!("Another program has changed {} since it was opened. Saving would replace that.", path.display());
    ui.label(text);
    ui.add_space(8.0);
    let mut close = false;
    ui.horizontal(|ui| {
        if ui.button("Replace it").on_hover_text("Save; what the other program wrote is lost").clicked() {
            out.push(Action::SaveOver(path.to_owned(), then.cloned()));
            close = true;
        }
        if ui.button("Save as…").on_hover_text("Save under another name").clicked() {
            out.push(Action::AskSave(then.cloned()));
            close = true;
        }
        let tip = "Take over what is in the file now, as one step: Undo brings yours back";
        if ui.button("Reload").on_hover_text(tip).clicked() {
            out.push(Action::Reload);
            close = true;
        }
        close |= ui.button("Cancel").on_hover_text("Save nothing").clicked();
    });
    close
}
