//! Import of the patch's outline from a drawing.

use super::dialogs::{PathField, Purpose, problem_with};
use super::field::{Choices, rows};
use super::outbox::{Action, Outbox};
use super::theme::Tokens;
use super::ui_state::UiState;
use crate::geometry::DVec2;
use crate::io::outline::{LENGTH_UNITS, read};
use crate::project::{AntennaSpec, Edit, Project};
use crate::units::{from_mm, to_mm};
use egui::{ComboBox, DragValue, RichText, Ui};
use std::path::{Path, PathBuf};

/// How far chords may leave curves, mm.
const TOLERANCE_MM: (f64, f64) = (1e-4, 10.0);

/// The dialog.
#[derive(Debug)]
pub(super) struct OutlineDialog {
    field: PathField,
    /// Place among the units; `None` for the drawing's own.
    unit: Option<usize>,
    tolerance_mm: f64,
    antenna: AntennaSpec,
    project: Project,
    /// What was read last, and what came of it.
    seen: Option<(Asked, Result<AntennaSpec, String>)>,
}

/// What an outline is read from.
type Asked = (PathBuf, Option<usize>, f64);

impl OutlineDialog {
    /// Asks for a drawing in a folder.
    pub(super) fn new(project: &Project, folder: &Path) -> Self {
        Self {
            field: PathField::new(Purpose::Drawing, folder.join("").display().to_string()),
            unit: None,
            tolerance_mm: 0.02,
            antenna: project.antenna.clone(),
            project: project.clone(),
            seen: None,
        }
    }

    /// Draws the dialog; true when it is to be closed.
    pub(super) fn ui(&mut self, ui: &mut Ui, state: &mut UiState, out: &mut Outbox) -> bool {
        ui.heading("Import outline");
        ui.label(
            RichText::new("One closed line of a DXF or SVG drawing becomes the patch, centered in the ground.").weak(),
        );
        ui.add_space(6.0);
        let mut go = self.field.ui(ui, "Drawing");
        ui.add_space(4.0);
        rows(ui, "outline", |ui| self.choices(ui));
        ui.add_space(4.0);
        let path = self.field.path();
        let made = match problem_with(&path, false) {
            Some(problem) => {
                ui.label(RichText::new(problem).weak());
                None
            }
            None => self.preview(ui, &path),
        };
        ui.add_space(8.0);
        let mut close = false;
        ui.horizontal(|ui| {
            let tip = "Make this outline the patch";
            go |= ui.add_enabled(made.is_some(), egui::Button::new("Import")).on_hover_text(tip).clicked();
            close = ui.button("Cancel").clicked();
        });
        if let (true, Some(antenna)) = (go, made) {
            state.last_folder = path.parent().map(Path::to_owned);
            out.push(Action::Edit("outline", Edit::SetAntenna(antenna)));
            return true;
        }
        close
    }

    fn choices(&mut self, ui: &mut Ui) {
        let tip = "What a number in the drawing means";
        let label = ui.label("Unit").on_hover_text(tip);
        let name = self.unit.map_or("as the file says", |k| LENGTH_UNITS[k].0);
        let combo = ComboBox::from_id_salt("unit").width(150.0).selected_text(name).show_list(ui, |ui| {
            ui.selectable_value(&mut self.unit, None, "as the file says");
            for (k, (name, _)) in LENGTH_UNITS.iter().enumerate() {
                ui.selectable_value(&mut self.unit, Some(k), *name);
            }
        });
        combo.response.labelled_by(label.id).on_hover_text(tip);
        ui.end_row();
        let tip = "How far straight pieces may leave the drawing's curves; a smaller one makes more points and cells";
        let label = ui.label("Tolerance").on_hover_text(tip);
        let (lo, hi) = TOLERANCE_MM;
        let input = DragValue::new(&mut self.tolerance_mm).suffix(" mm").speed(0.001).max_decimals(4).range(lo..=hi);
        ui.add(input).labelled_by(label.id).on_hover_text(tip);
        ui.end_row();
    }

    /// What would be imported, in words; the antenna with it, or why not.
    fn preview(&mut self, ui: &mut Ui, path: &Path) -> Option<AntennaSpec> {
        let asked = (path.to_owned(), self.unit, self.tolerance_mm);
        if self.seen.as_ref().is_none_or(|(seen, _)| *seen != asked) {
            let made = self.make(path);
            self.seen = Some((asked, made));
        }
        match self.seen.as_ref().map(|(_, made)| made)? {
            Ok(antenna) => {
                let (n, width, length) = (antenna.outline_mm.len(), antenna.width_mm, antenna.length_mm);
                ui.label(format!("{n} points, {width:.3} x {length:.3} mm"));
                let (before, feed) = (self.antenna.to_params().feed(), antenna.to_params().feed());
                if before.distance(feed) > from_mm(1e-3) {
                    let moved = format!("The feed moves to ({:.3}, {:.3}) mm.", to_mm(feed.x), to_mm(feed.y));
                    ui.label(RichText::new(moved).weak());
                }
                if (antenna.ground_width_mm, antenna.ground_length_mm)
                    != (self.antenna.ground_width_mm, self.antenna.ground_length_mm)
                {
                    let grown =
                        format!("The ground grows to {} x {} mm.", antenna.ground_width_mm, antenna.ground_length_mm);
                    ui.label(RichText::new(grown).weak());
                }
                Some(antenna.clone())
            }
            Err(reason) => {
                ui.add(egui::Label::new(RichText::new(reason).color(Tokens::here(ui).error)).wrap());
                None
            }
        }
    }

    fn make(&self, path: &Path) -> Result<AntennaSpec, String> {
        let unit = self.unit.map(|k| LENGTH_UNITS[k].1);
        let outline: Vec<DVec2> = read(path, unit, from_mm(self.tolerance_mm)).map_err(|error| error.to_string())?;
        let antenna = self.antenna.with_outline(&outline);
        let mut project = self.project.clone();
        Edit::SetAntenna(antenna.clone()).apply(&mut project).map_err(|error| error.to_string())?;
        Ok(antenna)
    }
}
