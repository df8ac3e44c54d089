//! The deformation as a stack: hand edits on top of presets, the lowest applied first; and how much of it is shown.

use super::command::Command;
use super::field::{Refused, symbol_button};
use super::outbox::{Action, Outbox};
use super::play::Play;
use super::preset_fields;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::project::{Edit, PresetEntry, Project};
use egui::{EventFilter, Key, Modifiers, Rect, Response, RichText, Role, Sense, Slider, Stroke, Ui, WidgetInfo, vec2};

/// Size of what a row is dragged by, points.
const GRIP: egui::Vec2 = vec2(14.0, 18.0);

/// Draws the stack.
pub(super) fn ui(ui: &mut Ui, project: &Project, state: &mut UiState, refused: Refused<'_>, out: &mut Outbox) {
    shown_part(ui, state, out);
    ui.add_space(2.0);
    ui.menu_button("Add preset", |ui| {
        for (name, tip, preset) in preset_fields::choices() {
            if ui.button(name).on_hover_text(tip).clicked() {
                out.push(Action::AddPreset(preset));
            }
        }
    })
    .response
    .on_hover_text("Add a deformation on top of the presets; the lowest one is applied first");
    row(ui, |ui| hand_edits(ui, project, state, refused, out));
    let stack = &project.presets;
    if stack.is_empty() {
        ui.label(RichText::new("No presets: the cage is flat but for the hand edits.").weak());
    }
    let mut rows = Vec::with_capacity(stack.len());
    let mut dragged = None;
    for (index, entry) in stack.iter().enumerate().rev() {
        let area = ui.push_id(index, |ui| {
            row(ui, |ui| {
                let grip = preset_header(ui, index, stack.len(), *entry, out);
                if grip.dragged() || grip.drag_stopped() {
                    dragged = Some((index, grip));
                }
                ui.add_enabled_ui(entry.enabled, |ui| preset_fields::ui(ui, index, *entry, refused, out));
            })
        });
        rows.push(area.inner);
    }
    if let Some((from, grip)) = dragged {
        reorder(ui, from, &grip, &rows, out);
    }
    refused.show_alone(ui, "presets");
}

/// A row of the stack; returns its place.
fn row(ui: &mut Ui, content: impl FnOnce(&mut Ui)) -> Rect {
    let frame = egui::Frame::group(ui.style()).inner_margin(6);
    let shown = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        content(ui);
    });
    shown.response.rect
}

/// The part of the deformation that the view shows, and a button that plays it.
fn shown_part(ui: &mut Ui, state: &UiState, out: &mut Outbox) {
    let is_on = state.play.is_on();
    ui.horizontal(|ui| {
        let (symbol, name) = if is_on { ("⏹", "Show the whole deformation") } else { ("▶", "Play deformation") };
        if symbol_button(ui, symbol, name, state.can_play) {
            out.push(Action::Run(Command::Play));
        }
        ui.add_enabled_ui(state.can_play, |ui| {
            let tip =
                "How much of the deformation the view shows, from flat to full. For looking only: the project stays";
            let label = ui.label("Shown").on_hover_text(tip);
            // Whole, as it is shown: a slider takes its own rounding for a change.
            let mut percent = (100.0 * state.play.amount).round();
            let slider = Slider::new(&mut percent, 0.0..=100.0).suffix(" %").fixed_decimals(0);
            if ui.add(slider).labelled_by(label.id).on_hover_text(tip).changed() {
                out.push(Action::Show(Play::held(percent / 100.0)));
            }
        });
    });
}

fn hand_edits(ui: &mut Ui, project: &Project, state: &mut UiState, refused: Refused<'_>, out: &mut Outbox) {
    let count = project.hand_edits.len();
    ui.horizontal(|ui| {
        ui.label(RichText::new("Hand edits").strong())
            .on_hover_text("Offsets of single vertices on top of the presets");
        ui.label(match count {
            0 => RichText::new("none").weak(),
            1 => RichText::new("1 vertex"),
            _ => RichText::new(format!("{count} vertices")),
        });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let clear = ui.add_enabled(count > 0, egui::Button::new("Clear").small());
            if clear.on_hover_text("Put all vertices back to where the presets have them").clicked() {
                out.push(Action::Run(Command::ResetAll));
            }
            let select = ui.add_enabled(count > 0, egui::Button::new("Select").small());
            if select.on_hover_text("Select the vertices moved by hand").clicked() {
                state.selection = project.hand_edits.keys().copied().collect();
            }
        });
    });
    refused.show_alone(ui, "hand edits");
}

/// Draws grip, eye, name and buttons of a preset; returns the grip.
fn preset_header(ui: &mut Ui, index: usize, count: usize, entry: PresetEntry, out: &mut Outbox) -> Response {
    let number = index + 1;
    ui.horizontal(|ui| {
        let grip = grip(ui, number);
        for (key, to) in [(Key::ArrowUp, index + 1), (Key::ArrowDown, index.wrapping_sub(1))] {
            if grip.has_focus() && to < count && ui.input_mut(|i| i.consume_key(Modifiers::NONE, key)) {
                out.edit("presets", Edit::ReorderPreset { from: index, to });
            }
        }
        eye(ui, index, entry, out);
        let name = RichText::new(preset_fields::name(&entry.preset));
        ui.label(if entry.enabled { name.strong() } else { name.weak() });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if symbol_button(ui, "🗑", &format!("Delete preset {number}"), true) {
                out.edit("presets", Edit::RemovePreset { index });
            }
            if symbol_button(ui, "🗐", &format!("Duplicate preset {number}"), true) {
                out.edit("presets", Edit::InsertPreset { index: number, entry });
            }
        });
        grip
    })
    .inner
}

/// What a row is dragged by.
fn grip(ui: &mut Ui, number: usize) -> Response {
    let response = ui.allocate_response(GRIP, Sense::click_and_drag());
    let name = format!("Move preset {number}");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name.clone()));
    let filter = EventFilter { vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
    if response.clicked() {
        response.request_focus();
    }
    let tokens = Tokens::here(ui);
    let color = if response.hovered() || response.has_focus() { tokens.accent } else { tokens.weak };
    for (column, line) in [(-1.0, -1.0), (-1.0, 0.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 0.0), (1.0, 1.0)] {
        ui.painter().circle_filled(response.rect.center() + vec2(2.5 * column, 5.0 * line), 1.4, color);
    }
    let tip = format!("{name}: drag, or click and press the arrow keys up and down; the lowest is applied first");
    response.on_hover_cursor(egui::CursorIcon::Grab).on_hover_text(tip)
}

fn eye(ui: &mut Ui, index: usize, entry: PresetEntry, out: &mut Outbox) {
    let tokens = Tokens::here(ui);
    let symbol = RichText::new("👁");
    let symbol = if entry.enabled { symbol.color(tokens.text) } else { symbol.color(tokens.weak).strikethrough() };
    let response = ui.add(egui::Button::new(symbol).small().frame(false));
    let name = format!("Apply preset {}", index + 1);
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, entry.enabled, name.clone()));
    let tip = if entry.enabled { "Leave this preset out" } else { "Apply this preset" };
    if response.on_hover_text(tip).clicked() {
        let entry = PresetEntry { enabled: !entry.enabled, ..entry };
        out.edit("presets", Edit::SetPreset { index, entry });
    }
}

/// Shows where the row that is dragged would go, and puts it there when it is let go. `rows` are from the top, which
/// is applied last.
fn reorder(ui: &Ui, from: usize, grip: &Response, rows: &[Rect], out: &mut Outbox) {
    let Some(pointer) = grip.interact_pointer_pos() else { return };
    let above = rows.iter().filter(|area| area.center().y < pointer.y).count();
    let to = place_in_stack(from, above, rows.len());
    if grip.drag_stopped() {
        if to != from {
            out.edit("presets", Edit::ReorderPreset { from, to });
        }
    } else if let Some(first) = rows.first() {
        let tokens = Tokens::here(ui);
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
        let y = above.checked_sub(1).map_or(first.top() - 2.0, |k| rows[k].bottom() + 2.0);
        ui.painter().hline(first.x_range(), y, Stroke::new(2.0, tokens.accent));
    }
}

/// The new place in the stack of the preset at `from`, dropped with `above` of `count` rows above the pointer.
fn place_in_stack(from: usize, above: usize, count: usize) -> usize {
    let line = count - 1 - from;
    let new_line = if above > line { above - 1 } else { above };
    count - 1 - new_line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_dropped_on_its_own_place_stays_and_others_make_room() {
        // Three presets; from the top the lines show 2, 1, 0.
        let go = |from, above| place_in_stack(from, above, 3);
        assert_eq!([go(2, 0), go(2, 1), go(1, 1), go(1, 2), go(0, 2), go(0, 3)], [2, 2, 1, 1, 0, 0], "where it was");
        assert_eq!([go(2, 2), go(2, 3)], [1, 0], "the top one down by one and two");
        assert_eq!([go(0, 1), go(0, 0)], [1, 2], "the lowest one up by one and two");
    }
}
