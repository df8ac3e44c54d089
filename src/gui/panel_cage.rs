//! The cage: the stack of its deformation, padding and segments, how vertices move, and the selected ones as numbers.

use super::command::Command;
use super::edit_ui::{EditUi, RADII_MM, STEPS_DEG, STEPS_MM};
use super::field::{Number, Refused, rows, section};
use super::outbox::Outbox;
use super::session::Pose;
use super::ui_state::UiState;
use super::{panel_stack, panel_vertices};
use crate::cage::build::MAX_SEGMENTS;
use crate::project::{CageSpec, Edit, Project};
use egui::Ui;
use std::ops::RangeInclusive;

/// Draws the panel.
pub(super) fn ui(ui: &mut Ui, project: &Project, pose: Option<&Pose>, state: &mut UiState, out: &mut Outbox) {
    let refused = state.refused.clone();
    let refused = Refused(refused.as_ref());
    section(ui, "Deformation", true, |ui| panel_stack::ui(ui, project, state, refused, out));
    section(ui, "Selected vertices", true, |ui| panel_vertices::ui(ui, project, pose, state, out));
    section(ui, "Moving vertices", true, |ui| moving(ui, &mut state.editing));
    section(ui, "Cage around the antenna", true, |ui| cage(ui, project.cage, state, refused, out));
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

/// How moves of vertices go: mirrored, carrying neighbors, in steps.
fn moving(ui: &mut Ui, editing: &mut EditUi) {
    let switch = |ui: &mut Ui, is_on: &mut bool, command: Command, text: &str| {
        ui.checkbox(is_on, text).on_hover_text(command.tooltip(ui.ctx()));
    };
    ui.horizontal(|ui| {
        let [x, y] = &mut editing.mirrors;
        switch(ui, x, Command::Mirror(0), "Mirror in x");
        switch(ui, y, Command::Mirror(1), "Mirror in y");
    });
    switch(ui, &mut editing.is_proportional, Command::Proportional, "Proportional editing");
    switch(ui, &mut editing.snaps, Command::Snap, "Snap to steps");
    rows(ui, "moving", |ui| {
        let mut number = |label: &'static str, unit, tip, speed, value: &mut f64, range: RangeInclusive<f64>| {
            let input = Number::new(label, label, unit, speed).tip(tip);
            let (_, new) = input.show(ui, *value);
            ui.end_row();
            if let Some(new) = new {
                *value = new.clamp(*range.start(), *range.end());
            }
        };
        let tip = "Vertices nearer than this to the selection follow it; the wheel changes it while moving";
        number("Radius", "mm", tip, 0.05, &mut editing.radius_mm, RADII_MM);
        number("Step", "mm", "Moves are rounded to this", 0.01, &mut editing.step_mm, STEPS_MM);
        number("Step of angles", "°", "Turns are rounded to this", 0.1, &mut editing.step_deg, STEPS_DEG);
    });
}
