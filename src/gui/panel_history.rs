//! The steps of the project's history; a click goes to any of them.

use super::outbox::{Action, Outbox};
use super::theme::Tokens;
use crate::project::History;
use crate::project::history::{Entry, Place};
use egui::{Align, Button, Id, Layout, RichText, Ui};

/// Indentation of a branch, points, and how many branches are told apart by it.
const INDENT: f32 = 14.0;
const MAX_INDENTS: usize = 6;

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, history: &History, has_file: bool, out: &mut Outbox) {
    let entries = history.entries();
    if entries.len() == 1 {
        ui.label(RichText::new("Nothing has been changed yet. Every change will be listed here.").weak());
        return;
    }
    ui.label(RichText::new("Click a step to go there. Branches left by an undo are indented.").weak());
    ui.add_space(4.0);
    ui.spacing_mut().item_spacing.y = 1.0;
    for entry in entries {
        row(ui, &entry, has_file, out);
    }
}

fn row(ui: &mut Ui, entry: &Entry<'_>, has_file: bool, out: &mut Outbox) {
    let tokens = Tokens::here(ui);
    let is_here = entry.place == Place::Here;
    let color = match entry.place {
        Place::Behind | Place::Here => tokens.text,
        Place::Ahead | Place::Aside => tokens.weak,
    };
    let tip = match entry.place {
        Place::Behind => "Undo back to here",
        Place::Here => "The project is here",
        Place::Ahead => "Redo up to here",
        Place::Aside => "Go to this step of another branch",
    };
    ui.horizontal(|ui| {
        ui.add_space(INDENT * entry.depth.min(MAX_INDENTS) as f32);
        let saved = if entry.is_saved && has_file { " (saved)" } else { "" };
        let text = RichText::new(format!("{}{saved}", entry.name)).color(color);
        let button = Button::selectable(is_here, text).truncate();
        ui.with_layout(Layout::top_down_justified(Align::LEFT), |ui| {
            let response = ui.add(button).on_hover_text(tip);
            if response.clicked() && !is_here {
                out.push(Action::GoTo(entry.number));
            }
            let seen = Id::unique("step in sight");
            if is_here && ui.data(|d| d.get_temp(seen)) != Some(entry.number) {
                ui.data_mut(|d| d.insert_temp(seen, entry.number));
                response.scroll_to_me(None);
            }
        });
    });
}
