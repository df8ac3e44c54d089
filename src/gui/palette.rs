//! The command palette: any command by a few letters of what it is called or does.
//!
//! Letters may be left out (`undo`, `rsv` for "Reset selected vertices"); several words must all be found. Commands used
//! last come first; those that cannot be used now are shown with the reason.

use super::bars::menu_of;
use super::command::{Command, Facts};
use super::outbox::{Action, Outbox};
use super::theme::Tokens;
use egui::{Key, Modifiers, Response, Role, ScrollArea, Sense, TextEdit, TextStyle, TextWrapMode, Ui, WidgetInfo};
use egui::{WidgetText, vec2};

/// Size of the list, points.
const SIZE: [f32; 2] = [620.0, 330.0];
const ROW_HEIGHT: f32 = 24.0;
/// Rows that Page up and Page down go over.
const PAGE: usize = 10;
/// Commands remembered as used last.
const MAX_RECENT: usize = 8;

/// What a found letter is worth, and how much more at the beginning of a word or right after the letter before.
const LETTER: usize = 1;
const WORD_START: usize = 8;
const FOLLOWS: usize = 8;
/// Least worth per letter: below it, letters were found here and there by chance.
const LEAST_PER_LETTER: usize = 4;
/// What a word found in the description is worth: less than any in the name.
const IN_TIP: usize = 1;

/// The palette while it is open.
#[derive(Debug, Default)]
pub(super) struct Palette {
    query: String,
    /// Place in the list of what Enter runs.
    chosen: usize,
    has_focus: bool,
}

/// The name under which a command is found: its menu and its text.
pub(super) fn full_name(command: Command) -> String {
    format!("{}: {}", menu_of(command), command.text_and_tip().0)
}

/// Notes that a command was used.
pub(super) fn note(recent: &mut Vec<String>, command: Command) {
    if command != Command::Palette {
        let name = full_name(command);
        recent.retain(|other| *other != name);
        recent.insert(0, name);
        recent.truncate(MAX_RECENT);
    }
}

/// The commands that a query finds, best first.
pub(super) fn find(query: &str, recent: &[String]) -> Vec<Command> {
    let last_used = |name: &String| recent.iter().position(|r| r == name).unwrap_or(MAX_RECENT);
    let all = Command::ALL.iter().filter(|c| **c != Command::Palette);
    let mut found: Vec<_> = all
        .filter_map(|&command| {
            let name = full_name(command);
            let worth = worth(query, &name, command.text_and_tip().1)?;
            Some((std::cmp::Reverse(worth), last_used(&name), command))
        })
        .collect();
    // Stable: the order of the menus holds among equals.
    found.sort_by_key(|&(worth, last_used, _)| (worth, last_used));
    found.into_iter().map(|(_, _, command)| command).collect()
}

/// How well a query fits; `None` unless each of its words is found in the name or in the description.
fn worth(query: &str, name: &str, tip: &str) -> Option<usize> {
    let tip = tip.to_lowercase();
    let word_worth = |word: &str| {
        let in_name = fuzzy(word, name).filter(|&w| w >= LEAST_PER_LETTER * word.chars().count());
        in_name.or_else(|| tip.contains(&word.to_lowercase()).then_some(IN_TIP))
    };
    query.split_whitespace().map(word_worth).sum()
}

/// The best way to find the letters of a word in their order in a text; `None` if there is none.
fn fuzzy(word: &str, text: &str) -> Option<usize> {
    let text: Vec<char> = text.chars().collect();
    let is_start: Vec<bool> = (0..text.len()).map(|i| i == 0 || !text[i - 1].is_alphanumeric()).collect();
    // The best worth so far with the last letter found at each place.
    let mut best: Vec<Option<usize>> = Vec::new();
    for letter in word.chars().flat_map(char::to_lowercase) {
        let before = std::mem::take(&mut best);
        let mut furthest = if before.is_empty() { Some(0) } else { None };
        for (i, c) in text.iter().enumerate() {
            let previous = i.checked_sub(1).and_then(|k| *before.get(k)?);
            furthest = furthest.max(previous);
            let fits = c.to_lowercase().eq([letter]);
            let here = LETTER + if is_start[i] { WORD_START } else { 0 };
            best.push(furthest.max(previous.map(|p| p + FOLLOWS)).filter(|_| fits).map(|w| w + here));
        }
    }
    best.into_iter().flatten().max()
}

impl Palette {
    /// Draws it; true when it is done with.
    pub(super) fn ui(&mut self, ui: &mut Ui, facts: &Facts, recent: &[String], out: &mut Outbox) -> bool {
        ui.set_width(SIZE[0]);
        let moved = self.keys(ui);
        let enter = ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Enter));
        let label = ui.label("Find a command");
        let field =
            TextEdit::singleline(&mut self.query).desired_width(f32::INFINITY).hint_text("undo, mesh, top view…");
        let field = ui.add(field).labelled_by(label.id);
        if !std::mem::replace(&mut self.has_focus, true) {
            field.request_focus();
        }
        if field.changed() {
            self.chosen = 0;
        }
        let found = find(&self.query, recent);
        self.chosen = self.chosen.min(found.len().saturating_sub(1));
        let mut run = found.get(self.chosen).copied().filter(|_| enter);
        ui.add_space(4.0);
        ScrollArea::vertical().auto_shrink(false).max_height(SIZE[1]).min_scrolled_height(SIZE[1]).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if found.is_empty() {
                ui.weak("No command is called like this or does this.");
            }
            for (place, &command) in found.iter().enumerate() {
                let response = row(ui, command, facts, place == self.chosen);
                if place == self.chosen && (moved || field.changed()) {
                    response.scroll_to_me(None);
                }
                if response.clicked() {
                    run = Some(command);
                }
            }
        });
        let Some(command) = run.filter(|c| c.is_enabled(facts)) else { return false };
        out.push(Action::Run(command));
        true
    }

    /// Moves the choice; true if a key did.
    fn keys(&mut self, ui: &Ui) -> bool {
        let before = self.chosen;
        let pressed = |key| ui.input_mut(|i| i.count_and_consume_key(Modifiers::NONE, key));
        self.chosen = self.chosen + pressed(Key::ArrowDown) + PAGE * pressed(Key::PageDown);
        self.chosen = self.chosen.saturating_sub(pressed(Key::ArrowUp) + PAGE * pressed(Key::PageUp));
        self.chosen != before
    }
}

/// One command: its name, what it does or why not, and its keys.
fn row(ui: &mut Ui, command: Command, facts: &Facts, is_chosen: bool) -> Response {
    let tokens = Tokens::here(ui);
    let name = full_name(command);
    let why_not = command.why_not(facts);
    let size = vec2(ui.available_width(), ROW_HEIGHT);
    let sense = if why_not.is_none() { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, why_not.is_none(), is_chosen, &name));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let ground = match (is_chosen, response.hovered()) {
        (true, _) => tokens.selected,
        (false, true) if why_not.is_none() => tokens.button[0],
        _ => egui::Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, 4.0, ground);
    let text = |text: String, width: f32| {
        WidgetText::from(text).into_galley(ui, Some(TextWrapMode::Truncate), width, TextStyle::Body)
    };
    let keys = command.keys(ui.ctx().os()).first().map(|k| ui.ctx().format_shortcut(k)).unwrap_or_default();
    let (name, keys) = (text(name, rect.width()), text(keys, rect.width()));
    let name_color = if why_not.is_none() { tokens.text } else { tokens.weak };
    let left = rect.left() + 8.0;
    let right = rect.right() - 8.0 - keys.size().x;
    let tip = why_not.map_or_else(|| command.text_and_tip().1.to_owned(), |why| format!("Not now: {why}"));
    let tip = text(tip, (right - left - name.size().x - 24.0).max(0.0));
    let tip_color = if is_chosen { tokens.text } else { tokens.weak };
    let places = [(left, name_color), (left + name.size().x + 12.0, tip_color), (right, tip_color)];
    for (galley, (x, color)) in [name, tip, keys].into_iter().zip(places) {
        let y = rect.center().y - galley.size().y / 2.0;
        ui.painter().galley_with_override_text_color(egui::pos2(x, y), galley, color);
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(query: &str) -> Option<Command> {
        find(query, &[]).first().copied()
    }

    #[test]
    fn letters_of_the_name_find_a_command() {
        for (query, command) in [
            ("undo", Command::Undo),
            ("rsv", Command::ResetSelected),
            ("top", Command::LookFrom(crate::render::StandardView::Top)),
            ("expo mesh", Command::ExportMesh),
            ("SAVE AS", Command::SaveAs),
            ("tetrahedra", Command::Mesh),
        ] {
            assert_eq!(first(query), Some(command), "{query}: {:?}", find(query, &[]));
        }
        assert_eq!(first("zzyzx"), None, "nothing is called so");
    }

    #[test]
    fn every_command_is_found_by_its_name() {
        for &command in Command::ALL.iter().filter(|c| **c != Command::Palette) {
            assert!(find(&full_name(command), &[]).contains(&command), "{command:?}");
            assert!(find("", &[]).contains(&command), "{command:?} without a query");
        }
    }

    #[test]
    fn what_was_used_last_comes_first() {
        let mut recent = Vec::new();
        for command in [Command::Mesh, Command::Fit, Command::Mesh, Command::Palette] {
            note(&mut recent, command);
        }
        assert_eq!(find("", &recent)[..2], [Command::Mesh, Command::Fit], "newest first");
        assert_eq!(recent.len(), 2, "each once, the palette not at all");
        for &command in Command::ALL {
            note(&mut recent, command);
        }
        assert_eq!(recent.len(), MAX_RECENT, "bounded");
    }
}
