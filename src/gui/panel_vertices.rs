//! The selected vertices as numbers: places or offsets, one by one or all at once.

use super::edit_ui::Columns;
use super::hand_edits::{offset_edit, place_edit};
use super::outbox::Outbox;
use super::session::Pose;
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::cage::Mirror;
use crate::project::{Edit, Project};
use crate::units::to_mm;
use egui::{DragValue, Response, RichText, ScrollArea, Ui, vec2};

/// Width of the column of numbers of vertices and of the others, and height of a row, points.
const NUMBER_WIDTH: f32 = 34.0;
const VALUE_WIDTH: f32 = 70.0;
const ROW_HEIGHT: f32 = 20.0;
/// Height of the list, points; it scrolls beyond.
const LIST_HEIGHT: f32 = 220.0;
const AXES: [char; 3] = ['x', 'y', 'z'];

/// What the table works with.
struct Table<'a> {
    project: &'a Project,
    pose: &'a Pose,
    mirror: Mirror,
    columns: Columns,
}

/// Draws the table.
pub(super) fn ui(ui: &mut Ui, project: &Project, pose: Option<&Pose>, state: &mut UiState, out: &mut Outbox) {
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
    ui.horizontal(|ui| {
        let columns = &mut state.editing.columns;
        ui.selectable_value(columns, Columns::Places, "Places").on_hover_text("Where the vertices are, mm");
        let tip = "How far the vertices were moved by hand from where the presets have them, mm";
        ui.selectable_value(columns, Columns::Offsets, "Offsets from presets").on_hover_text(tip);
    });
    let table = Table { project, pose, mirror: state.editing.mirror(), columns: state.editing.columns };
    let vertices: Vec<u32> = state.selection.iter().copied().collect();
    if state.play.is_on() {
        // The numbers are those of the part that is shown: no place to set anything to.
        ui.disable();
    }
    ui.spacing_mut().item_spacing = vec2(6.0, 3.0);
    ui.horizontal(|ui| {
        let tokens = Tokens::here(ui);
        for (heading, width) in
            [("No.", NUMBER_WIDTH), ("x (mm)", VALUE_WIDTH), ("y (mm)", VALUE_WIDTH), ("z (mm)", VALUE_WIDTH)]
        {
            ui.add_sized([width, ROW_HEIGHT], egui::Label::new(RichText::new(heading).color(tokens.weak)));
        }
    });
    table.row_of_all(ui, &vertices, out);
    ScrollArea::vertical().max_height(LIST_HEIGHT).id_salt("vertices").show_rows(
        ui,
        ROW_HEIGHT,
        vertices.len(),
        |ui, rows| {
            for &vertex in &vertices[rows] {
                ui.push_id(vertex, |ui| table.row(ui, vertex, out));
            }
        },
    );
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

impl Table<'_> {
    fn value(&self, vertex: u32, axis: usize) -> Option<f64> {
        match self.columns {
            Columns::Places => self.pose.vertices.get(vertex as usize).map(|p| to_mm(p[axis])),
            Columns::Offsets => Some(self.project.hand_edits.get(&vertex).map_or(0.0, |offset| offset[axis])),
        }
    }

    fn edit(&self, vertices: &[u32], axis: usize, target_mm: f64) -> Edit {
        let edit = match self.columns {
            Columns::Places => place_edit,
            Columns::Offsets => offset_edit,
        };
        edit(self.project, self.pose, self.mirror, vertices, (axis, target_mm))
    }

    fn row(&self, ui: &mut Ui, vertex: u32, out: &mut Outbox) {
        ui.horizontal(|ui| {
            ui.add_sized([NUMBER_WIDTH, ROW_HEIGHT], egui::Label::new(vertex.to_string()));
            for (axis, name) in AXES.into_iter().enumerate() {
                let Some(value) = self.value(vertex, axis) else { continue };
                let mut new = value;
                let response = field(ui, DragValue::new(&mut new), &format!("{name} of cage vertex {vertex}, mm"));
                let edit = response.changed().then(|| ("hand edits", self.edit(&[vertex], axis, new)));
                out.gesture(&response, edit);
            }
        });
    }

    /// Sets a coordinate of all selected vertices.
    fn row_of_all(&self, ui: &mut Ui, vertices: &[u32], out: &mut Outbox) {
        ui.horizontal(|ui| {
            ui.add_sized([NUMBER_WIDTH, ROW_HEIGHT], egui::Label::new(RichText::new("All").strong()));
            for (axis, name) in AXES.into_iter().enumerate() {
                let values: Vec<f64> = vertices.iter().filter_map(|&v| self.value(v, axis)).collect();
                let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
                let are_equal = values.iter().all(|v| (v - mean).abs() < 0.5e-3);
                let mut new = mean;
                let input = DragValue::new(&mut new);
                let input = if are_equal { input } else { input.custom_formatter(|_, _| "differ".to_owned()) };
                let response = field(ui, input, &format!("Set all {name} to, mm"));
                let edit = response.changed().then(|| ("hand edits", self.edit(vertices, axis, new)));
                out.gesture(&response, edit);
            }
        });
    }
}

fn field(ui: &mut Ui, input: DragValue<'_>, name: &str) -> Response {
    let input = input.speed(0.02).fixed_decimals(3).update_while_editing(false);
    let response = ui.add_sized([VALUE_WIDTH, ROW_HEIGHT], input);
    let label = name.to_owned();
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(label));
    response.on_hover_text(name)
}
