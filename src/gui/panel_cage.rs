//! The cage: padding, segments, the stack of presets, hand edits, and the selected vertices as numbers.

use super::field::{Number, Refused, rows, section, symbol_button};
use super::outbox::{Action, Outbox};
use super::preset_fields;
use super::session::{Pose, place_edit};
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::cage::build::MAX_SEGMENTS;
use crate::project::{CageSpec, Edit, PresetEntry, Project};
use crate::units::to_mm;
use egui::{DragValue, Grid, RichText, ScrollArea, Ui};

/// Most vertices listed as numbers: more are a scroll bar nobody reads, and are moved with the pointer.
const MAX_LISTED: usize = 40;

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, project: &Project, pose: Option<&Pose>, state: &mut UiState, out: &mut Outbox) {
    let refused = state.refused.clone();
    let refused = Refused(refused.as_ref());
    section(ui, "Presets", true, |ui| presets(ui, &project.presets, refused, out));
    section(ui, "Cage around the antenna", true, |ui| cage(ui, project.cage, state, refused, out));
    section(ui, "Hand edits", true, |ui| hand_edits(ui, project, state, refused, out));
    section(ui, "Selected vertices", true, |ui| selected(ui, project, pose, state, out));
}

fn cage(ui: &mut Ui, cage: CageSpec, state: &mut UiState, refused: Refused<'_>, out: &mut Outbox) {
    let [x, y, z] = cage.padding_mm;
    let are_equal = x.to_bits() == y.to_bits() && y.to_bits() == z.to_bits();
    let tip = "One number for the distance to the antenna along x, y and z, as in the paper";
    let mut equal = state.equal_padding && are_equal;
    if ui.checkbox(&mut equal, "Equal padding").on_hover_text(tip).changed() {
        state.equal_padding = equal;
        if equal && !are_equal {
            out.edit("padding", Edit::SetCage(CageSpec { padding_mm: [x; 3], ..cage }));
        }
    }
    rows(ui, "cage", |ui| {
        let tip = "Distance from the antenna to its cage; it must be more than 0";
        let padding = |place, label| Number::new(place, label, "mm", 0.02).tip(tip).slider(0.5..=8.0);
        if equal {
            let all = |v| Edit::SetCage(CageSpec { padding_mm: [v; 3], ..cage });
            padding("padding", "Padding").row(ui, x, refused, out, all);
        } else {
            let labels = [("padding x", "Padding x"), ("padding y", "Padding y"), ("padding z", "Padding z")];
            for (axis, (place, label)) in labels.into_iter().enumerate() {
                let mut padding_mm = cage.padding_mm;
                padding(place, label).row(ui, padding_mm[axis], refused, out, |v| {
                    padding_mm[axis] = v;
                    Edit::SetCage(CageSpec { padding_mm, ..cage })
                });
            }
        }
        let tip = "Cage quads along this direction; a change removes the hand edits";
        for (axis, (place, label)) in
            [("segments x", "Segments x"), ("segments y", "Segments y")].into_iter().enumerate()
        {
            let mut segments = cage.segments;
            let number = Number::new(place, label, "", 0.1).count().tip(tip).slider(1.0..=20.0);
            number.row(ui, segments[axis] as f64, refused, out, |v| {
                segments[axis] = v.round().clamp(1.0, MAX_SEGMENTS as f64) as usize;
                Edit::SetCage(CageSpec { segments, ..cage })
            });
        }
    });
}

fn presets(ui: &mut Ui, stack: &[PresetEntry], refused: Refused<'_>, out: &mut Outbox) {
    if stack.is_empty() {
        ui.label(RichText::new("No presets: the cage is flat but for the hand edits.").weak());
    }
    for (index, entry) in stack.iter().enumerate() {
        ui.push_id(index, |ui| {
            egui::Frame::group(ui.style()).inner_margin(6).show(ui, |ui| {
                ui.set_width(ui.available_width());
                preset_header(ui, index, stack.len(), *entry, out);
                ui.add_enabled_ui(entry.enabled, |ui| preset_fields::ui(ui, index, *entry, refused, out));
            });
        });
    }
    ui.menu_button("Add preset", |ui| {
        for (name, tip, preset) in preset_fields::choices() {
            if ui.button(name).on_hover_text(tip).clicked() {
                out.push(Action::AddPreset(preset));
            }
        }
    })
    .response
    .on_hover_text("Add a deformation; presets are applied from top to bottom");
    refused.show_alone(ui, "presets");
}

fn preset_header(ui: &mut Ui, index: usize, count: usize, entry: PresetEntry, out: &mut Outbox) {
    let number = index + 1;
    ui.horizontal(|ui| {
        let mut enabled = entry.enabled;
        let name = RichText::new(preset_fields::name(&entry.preset)).strong();
        if ui.checkbox(&mut enabled, name).on_hover_text("Apply this preset").changed() {
            out.edit("presets", Edit::SetPreset { index, entry: PresetEntry { enabled, ..entry } });
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if symbol_button(ui, "🗑", &format!("Delete preset {number}"), true) {
                out.edit("presets", Edit::RemovePreset { index });
            }
            if symbol_button(ui, "⏷", &format!("Apply preset {number} later"), number < count) {
                out.edit("presets", Edit::ReorderPreset { from: index, to: index + 1 });
            }
            if symbol_button(ui, "⏶", &format!("Apply preset {number} earlier"), index > 0) {
                out.edit("presets", Edit::ReorderPreset { from: index, to: index - 1 });
            }
        });
    });
}

fn hand_edits(ui: &mut Ui, project: &Project, state: &mut UiState, refused: Refused<'_>, out: &mut Outbox) {
    let count = project.hand_edits.len();
    ui.horizontal(|ui| {
        ui.label(match count {
            0 => "No vertex moved by hand".to_owned(),
            1 => "1 vertex moved by hand".to_owned(),
            _ => format!("{count} vertices moved by hand"),
        });
        if count > 0 {
            if ui.button("Select").on_hover_text("Select the vertices moved by hand").clicked() {
                state.selection = project.hand_edits.keys().copied().collect();
            }
            if ui.button("Clear").on_hover_text("Put them all back to where the presets have them").clicked() {
                out.edit("hand edits", Edit::ClearHandEdits);
            }
        }
    });
    refused.show_alone(ui, "hand edits");
}

fn selected(ui: &mut Ui, project: &Project, pose: Option<&Pose>, state: &mut UiState, out: &mut Outbox) {
    let Some(pose) = pose else {
        ui.label(RichText::new("There is no cage: correct the numbers marked above.").weak());
        return;
    };
    pick_by_number(ui, pose, state);
    if state.selection.is_empty() {
        let text = "None. Click a cage vertex in the view, drag a box with B, or choose one by its number.";
        ui.label(RichText::new(text).weak());
        return;
    }
    ScrollArea::vertical().max_height(220.0).id_salt("vertices").show(ui, |ui| {
        Grid::new("vertices").num_columns(4).striped(true).min_col_width(20.0).spacing([6.0, 3.0]).show(ui, |ui| {
            for heading in ["No.", "x (mm)", "y (mm)", "z (mm)"] {
                ui.label(RichText::new(heading).color(Tokens::here(ui).weak));
            }
            ui.end_row();
            for &vertex in state.selection.iter().take(MAX_LISTED) {
                vertex_row(ui, project, pose, vertex, out);
            }
        });
    });
    if state.selection.len() > MAX_LISTED {
        ui.label(RichText::new(format!("and {} more", state.selection.len() - MAX_LISTED)).weak());
    }
}

fn pick_by_number(ui: &mut Ui, pose: &Pose, state: &mut UiState) {
    let last = u32::try_from(pose.cage.n_handles().saturating_sub(1)).unwrap_or(u32::MAX);
    let mut vertex = state.selection.first().copied().unwrap_or(0);
    ui.horizontal(|ui| {
        let label = ui.label("Select number");
        let response = ui.add(DragValue::new(&mut vertex).range(0..=last).speed(0.2)).labelled_by(label.id);
        if response.on_hover_text("Select one cage vertex by its number").changed() {
            state.selection = [vertex].into();
        }
        ui.label(RichText::new(format!("of 0 to {last}; {} selected", state.selection.len())).weak());
    });
}

fn vertex_row(ui: &mut Ui, project: &Project, pose: &Pose, vertex: u32, out: &mut Outbox) {
    let Some(&at) = pose.vertices.get(vertex as usize) else { return };
    let label = ui.label(vertex.to_string());
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let mut value = to_mm(at[axis]);
        let input = DragValue::new(&mut value).speed(0.02).fixed_decimals(3).update_while_editing(false);
        let response = ui.add_sized([66.0, 20.0], input).labelled_by(label.id);
        let response = response.on_hover_text(format!("{name} of cage vertex {vertex}, mm"));
        let edit = response.changed().then(|| ("hand edits", place_edit(project, vertex, at, axis, value)));
        out.gesture(&response, edit);
    }
    ui.end_row();
}
